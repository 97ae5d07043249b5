"""Dissipation of energy at constant angular momentum: an exact model, and the energy sink (001)."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations.derivation import Derivation
from eom.derivations.derived import Derived
from eom.kinematics.frames import first_derivative, time_derivative, vector
from eom.mechanics import dissipation as model
from eom.mechanics import steady
from eom.mechanics.freebody import MOMENTS, H, T
from eom.mechanics.rigidbody import OMEGA, angular_momentum
from eom.system import System
from eom.terms.rules import (
    combine,
    differentiate,
    differentiate_terms,
    distribute,
    parallel,
    transport,
    use,
    vanish,
)
from eom.terms.terms import Equation, add, der, dot, entries, expr, mul, number, zero
from eom.terms.vocabulary import omega, quantity

Expr = Any
W, SIGMA = omega("B"), omega("S", "B")
H_C, H_SLUG = quantity("angular_momentum", "body", "C"), quantity("slug_momentum")
J, J_S, DAMPING = (quantity("inertia", "C"), quantity("slug_inertia"), quantity("slug_damping"))
J_BODY = add(J, -mul(J_S, quantity("identity")))
T_ROT = quantity("rotational_energy", "body", "C")


def energy_dissipation() -> Derived:
    """Derive that H stays while T falls in a body with a viscous slug, and the major-axis rule."""
    d = Derivation(
        "energy-dissipation", "Energy dissipation and the major-axis rule", "Torque-free motion"
    )
    _balance(d)
    _energy(d)
    rule = _major_axis(d)
    _stability(d)
    _energy_sink(d)
    system = model.viscous_slug()
    _check_equations(d, system)
    return d.finish(equations=system, excess_energy=rule, nutation_rate=model.nutation_rate())


def _check_equations(d: Derivation, system: System) -> None:
    """The equations in principal axes obey the laws of the steps: momentum, slug, energy."""
    rates = dict(zip((q.symbol for q in system.states), system.rates, strict=True))
    slug = model.slug_momentum()
    whole = angular_momentum(sp.diag(*MOMENTS), OMEGA) + slug
    viscous = model.SIGMA.scaled(-model.DAMPING)
    for h, torque in ((whole, vector("B", (0, 0, 0))), (slug, viscous)):
        rate = first_derivative(h, OMEGA, rates).total
        d.check(Equation(entries(rate.column), entries(torque.column)), "momentum of the system")
    power = viscous.dot(model.SIGMA)
    d.check(Equation(expr(time_derivative(model.slug_energy(), rates)), expr(power)), "its energy")
    d.check(Equation(expr(model.energy_rate()), expr(power)), "its rate of energy")


def _balance(d: Derivation) -> None:
    d.only("viscous_slug")
    d.law(Equation(der(H_C), zero("vector")), "no torque from outside", label="H-constant")
    d.law(Equation(der(H_SLUG), -(DAMPING * SIGMA)), "the viscous torque on the slug", label="slug")
    slug = d.state(
        Equation(H_SLUG, J_S * add(W, SIGMA)),
        "the slug turns with omega + sigma; its inertia is that of a sphere",
        label="slug-momentum",
    )
    d.state(
        Equation(H_C, add(dot(J_BODY, W), slug.equation.right)),
        "momentum of body and slug, with the inertia of the body alone",
        label="momentum",
    )
    d.state(Equation(der(dot(H_C, H_C)), number(0)), "its magnitude is constant", label="magnitude")
    d.law(Equation(der(J, "B"), zero("dyadic")), "the inertia of the whole is constant in B")
    slug.both(
        "the slug as seen from B",
        der,
        differentiate,
        transport("B"),
        vanish(der(J_S)),
        parallel,
        distribute,
        label="slug-rate",
    )


def _energy(d: Derivation) -> None:
    energy = d.state(
        Equation(
            T_ROT,
            add(
                number(1, 2) * dot(W, dot(J_BODY, W)),
                number(1, 2) * J_S * dot(add(W, SIGMA), add(W, SIGMA)),
            ),
        ),
        "energy of the body and of the slug",
        label="energy",
    )
    body = d.state(
        Equation(der(energy.equation.right.args[0]), DAMPING * dot(W, SIGMA)),
        "the body feels the torque +c sigma, whose power is c sigma.omega",
        label="body-power",
    )
    slug = d.state(
        Equation(der(energy.equation.right.args[1]), -(DAMPING * dot(add(W, SIGMA), SIGMA))),
        "the slug the opposite one: -c sigma.(omega + sigma)",
        label="slug-power",
    )
    both = energy.both(
        "both together",
        der,
        differentiate_terms,
        use(body.equation),
        use(slug.equation),
        label="both-powers",
    )
    both.then(
        "energy falls as long as the slug slips, whatever the motion",
        distribute,
        combine,
        label="energy-rate",
    )


def _major_axis(d: Derivation) -> tuple[tuple[Expr, Expr], ...]:
    h = angular_momentum(sp.diag(*MOMENTS), OMEGA) + model.slug_momentum()
    energy = model.slug_energy()
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


def _stability(d: Derivation) -> None:
    for axis in (1, 2, 3):
        spin = model.damped_spin(axis)
        n = len(spin.coefficients) - 1
        polynomial = sum(c * steady.ROOT ** (n - k) for k, c in enumerate(spin.coefficients))
        characteristic = sp.Determinant(steady.ROOT * sp.eye(4) - spin.block)
        d.state(
            Equation(expr(spin.coefficients[0] * characteristic), expr(polynomial)),
            f"deviations across the axis from spin about b{axis}: characteristic polynomial",
            label=f"characteristic-{axis}",
        )


def _energy_sink(d: Derivation) -> None:
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
