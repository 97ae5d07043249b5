"""Dissipation of energy at constant angular momentum: an exact model, and the energy sink (001)."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom import dissipation as model
from eom import steady
from eom.derivation import Derivation, Maker
from eom.frames import Vector
from eom.freebody import MOMENTS, H, T
from eom.rigidbody import OMEGA, angular_momentum
from eom.terms import Equation, entries, expr
from eom.transport import first_derivative, time_derivative

Expr = Any
SIGMA = model.SIGMA


def energy_dissipation() -> Derivation:
    """Derive that H stays while T falls in a body with a viscous slug, and the major-axis rule."""
    d = Maker(
        "energy-dissipation", "Energy dissipation and the major-axis rule", "Torque-free motion"
    )
    system = model.viscous_slug()
    rates = dict(zip((q.symbol for q in system.states), system.rates, strict=True))
    _balance(d, rates)
    _energy(d, rates)
    rule = _major_axis(d)
    _stability(d)
    _energy_sink(d)
    return d.finish(equations=system, excess_energy=rule, nutation_rate=model.nutation_rate())


def _whole() -> Vector:
    """Return the momentum of the body and of its slug."""
    return angular_momentum(sp.diag(*MOMENTS), OMEGA) + model.slug_momentum()


def _balance(d: Maker, rates: dict[Expr, Expr]) -> None:
    slug, h = model.slug_momentum(), _whole()
    turning = (OMEGA + SIGMA).scaled(model.SLUG)
    d.state(
        Equation(entries(slug.column), entries(turning.column)),
        "momentum of the spherical slug, which turns with omega + sigma",
        label="slug-momentum",
    )
    d.state(
        Equation(entries(first_derivative(h, OMEGA, rates).total.column), entries(sp.zeros(3, 1))),
        "h = I.omega + J_s (omega + sigma); no torque from outside: dh/dt is zero",
        label="momentum-rate",
    )
    d.state(
        Equation(
            entries(first_derivative(slug, OMEGA, rates).total.column),
            entries(SIGMA.scaled(-model.DAMPING).column),
        ),
        "the slug feels the viscous torque -c sigma alone",
        label="slug",
    )
    d.state(
        Equation(expr(time_derivative(h.dot(h), rates)), expr(sp.Integer(0))),
        "so the magnitude of h is constant",
        label="H-constant",
    )


def _energy(d: Maker, rates: dict[Expr, Expr]) -> None:
    energy = model.slug_energy()
    d.state(
        Equation(expr(time_derivative(energy, rates)), expr(-model.DAMPING * SIGMA.dot(SIGMA))),
        "while the energy falls as long as the slug slips: dT/dt = -c sigma.sigma",
        label="energy-rate",
    )
    d.check(
        Equation(expr(model.energy_rate()), expr(-model.DAMPING * SIGMA.dot(SIGMA))), "as given"
    )


def _major_axis(d: Maker) -> tuple[tuple[Expr, Expr], ...]:
    h, energy = _whole(), model.slug_energy()
    squares = model.excess_energy(3)
    greatest = MOMENTS[2] + model.SLUG
    d.state(
        Equation(
            expr(energy - h.dot(h) / (2 * greatest)),
            expr(sp.Add(*(c * base**2 for c, base in squares))),
        ),
        "energy above that of spin about b3 with the same h: squares, whose factors are positive if "
        "I3 is the greatest moment",
        label="excess",
    )
    return squares


def _stability(d: Maker) -> None:
    for axis in (1, 2, 3):
        spin = model.damped_spin(axis)
        n = len(spin.coefficients) - 1
        polynomial = sum(c * steady.ROOT ** (n - k) for k, c in enumerate(spin.coefficients))
        A = steady.linearised(model.viscous_slug(), axis)
        across = [k for k in range(6) if k % 3 != axis - 1]
        block = A.extract(across, across)
        characteristic = (steady.ROOT * sp.eye(4) - block).det(method="berkowitz")
        scale = sp.Poly(polynomial, steady.ROOT).LC()
        d.state(
            Equation(expr(polynomial), expr(scale * characteristic)),
            f"small deviations from spin about b{axis}: characteristic polynomial across the axis",
            label=f"characteristic-{axis}",
        )


def _energy_sink(d: Maker) -> None:
    energy = model.energy_at_nutation()
    d.state(
        Equation(expr(energy.diff(model.NUTATION) * model.nutation_rate()), expr(-model.POWER)),
        "the energy sink: a symmetric quasi-rigid body with dT/dt = -D and h constant",
        label="sink-nutation",
    )
    d.state(
        Equation(expr(model.effective_inertia_rate()), expr(H**2 * model.POWER / (2 * T**2))),
        "for any body h^2/2T, an effective moment, only grows: towards the greatest",
        label="sink-effective",
    )
