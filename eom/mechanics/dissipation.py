"""What dissipation does to a steady spin: the exact model of a slug, and the energy sink.

The exact model of dissipation is a body with a spherical slug in a cavity full of viscous fluid
at the centre of mass; beside it stands the energy sink, in which energy falls at a prescribed rate
while H stays (Hughes, Spacecraft Attitude Dynamics, 1986, ch. 5). Principal axes throughout.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.algebra import gather
from eom.exact.numbers import number, sign
from eom.kinematics.coordinates import Attitude
from eom.kinematics.frames import Vector, first_derivative, time_derivative, vector
from eom.mass.inertia import check_principal_moments, physical
from eom.mechanics.freebody import AXIAL, TRANSVERSE, H, T
from eom.mechanics.rigidbody import (
    OMEGA,
    angular_momentum,
    euler_equations,
    momentum_outputs,
    principal_inertia,
    rotation,
    scalar,
    with_body,
    with_outputs,
)
from eom.mechanics.steady import ROOT, VERDICTS, hurwitz_determinants, linearised, steady_values
from eom.quantities import Assumption, Definition, Quantity
from eom.system import System

Expr = Any

SIGMA = vector("B", (sp.Symbol(f"sigma_{k}", real=True) for k in (1, 2, 3)))
SLUG, DAMPING = sp.Symbol("J_s", positive=True), sp.Symbol("c", positive=True)
POWER, NUTATION = sp.Symbol("D", nonnegative=True), sp.Symbol("theta", real=True)


def slug_momentum() -> Vector:
    """Return the slug's angular momentum J_s (omega + sigma) about the centre of mass, in B."""
    return (OMEGA + SIGMA).scaled(SLUG)


def slug_energy() -> Expr:
    """Return the kinetic energy (J) of rotation of body and slug together."""
    J, _ = principal_inertia()
    body = OMEGA.dot(angular_momentum(J, OMEGA))
    return (body + (OMEGA + SIGMA).dot(slug_momentum())) / 2


def _slug_rates() -> tuple[Expr, ...]:
    """Rates of omega and sigma: first the body alone, then the slug with the body's rates known.

    The slug's balance is d(h_slug)/dt = -c sigma; that of the whole, d(h + h_slug)/dt = 0, less
    the slug's, is d(h)/dt = c sigma. The sphere has the same inertia J_s in every frame, so that
    its momentum is differentiated in B.
    """
    J, _ = principal_inertia()
    viscous = SIGMA.scaled(DAMPING)
    _, body = euler_equations(J, viscous)
    sigma_dot = sp.symbols("sigma_dot_1:4", real=True)
    moving = dict(zip((*OMEGA.components, *SIGMA.components), (*body, *sigma_dot), strict=True))
    balance = first_derivative(slug_momentum(), OMEGA, moving).total + viscous
    rows = zip(balance.components, sigma_dot, strict=True)
    variables = (*OMEGA.components, *SIGMA.components)
    slug = [gather(-row.xreplace({d: sp.Integer(0)}) / row.diff(d), variables) for row, d in rows]
    return (*body, *slug)


def viscous_slug(attitude: Attitude | None = None) -> System:
    """Derive a torque-free body with a viscous spherical slug at the common centre of mass.

    ``I1``, ``I2``, ``I3``: moments of the body without the slug; ``J_s``: moment of the slug about
    any diameter (kg m^2); ``c``: the slug's torque on the body is c sigma (N m s). States: omega of
    the body and sigma, the slug's rate less the body's (rad/s, in B); then those of ``attitude``.

    >>> viscous_slug().invariant_names
    ('H',)
    """
    J, moments = principal_inertia()
    states = [
        Quantity(w, "rad/s", f"{meaning} about b{k}", f"\\{letter}_{k}")
        for letter, meaning, v in (
            ("omega", "angular velocity", OMEGA),
            ("sigma", "angular velocity of the slug in the body", SIGMA),
        )
        for k, w in enumerate(v.components, 1)
    ]
    slug = Quantity(SLUG, "kg m^2", "moment of inertia of the slug about its diameters", "J_s")
    damping = Quantity(DAMPING, "N m s", "torque between body and slug per relative rate", "c")
    system = System(
        name="viscous_slug",
        title="Torque-free body with a viscous spherical slug",
        states=(*states, *(attitude.coordinates if attitude else ())),
        rates=(*_slug_rates(), *(attitude.rates(OMEGA) if attitude else ())),
        parameters=(*moments, slug, damping),
        singularities=attitude.singularities if attitude else (),
        assumptions=(*_slug_assumptions(J), *rotation(attitude)),
    )
    torque = SIGMA.scaled(DAMPING).components
    return with_outputs(with_body(system, J, torque, attitude), _slug_outputs(J, attitude))


def _slug_assumptions(J: Expr) -> tuple[Assumption, ...]:
    products = tuple(sp.Symbol(f"J{i}{j}", real=True) for i, j in ((1, 2), (1, 3), (2, 3)))
    return (
        Assumption("torque_free", "no torque acts from outside"),
        Assumption("rigid", "body and slug are rigid"),
        Assumption("centre_of_mass", "the slug's centre is the centre of mass of body and whole"),
        Assumption("spherical_slug", "the slug's moment of inertia is J_s about every diameter"),
        Assumption("viscous", "the torque between slug and body is in proportion to sigma"),
        Assumption("massless_film", "the fluid between them has no momentum of its own"),
        Assumption("principal_axes", "b1, b2, b3 are principal axes of inertia", vanish=products),
        physical(J),
    )


def _slug_outputs(J: Expr, attitude: Attitude | None) -> list[Definition]:
    h = angular_momentum(J, OMEGA) + slug_momentum()
    dissipation = SIGMA.dot(SIGMA.scaled(DAMPING))
    outputs = [
        scalar("T", slug_energy(), "J", "kinetic energy of rotation of body and slug"),
        scalar("dissipation", dissipation, "W", "power lost in the fluid", "D"),
        *momentum_outputs(h, attitude.matrix if attitude else None),
    ]
    if attitude:
        outputs += [scalar(name, e, "1", meaning) for name, meaning, e in attitude.constraints]
    return outputs


def energy_rate() -> Expr:
    """Return dT/dt (W) of the slug model, by the chain rule along its motion.

    >>> energy_rate()
    -c*sigma_1**2 - c*sigma_2**2 - c*sigma_3**2
    """
    return sp.expand(viscous_slug().rate_of(slug_energy()))


def excess_energy(major: int) -> tuple[tuple[Expr, Expr], ...]:
    """Return T - H^2/(2 I_m) of body and slug as pairs (coefficient, base) of a sum of squares.

    I_m is the moment of the whole, slug included, about b_m, m = ``major``. No coefficient is
    negative where it is the greatest: at given H the least energy is in spin about b_m with
    sigma = 0 (major-axis rule; Hughes, 1986, ch. 5). Bases are h_k (N m s) and sigma_k.
    """
    J, _ = principal_inertia()
    h = angular_momentum(J, OMEGA) + slug_momentum()
    names = sp.symbols("h_1:4", real=True)
    (omega,) = sp.linsolve(
        [a - b for a, b in zip(h.components, names, strict=True)], OMEGA.components
    )
    whole = (h.components[major - 1]).diff(OMEGA.components[major - 1])
    excess = slug_energy() - vector("B", names).dot(vector("B", names)) / (2 * whole)
    over_momentum = excess.subs(dict(zip(OMEGA.components, omega, strict=True)))
    variables = (*names, *SIGMA.components)
    form = (sp.hessian(over_momentum, variables) / 2).applyfunc(lambda e: sp.factor(sp.cancel(e)))
    assert form.is_diagonal(), "cross terms in the excess energy"
    bases = (*h.components, *SIGMA.components)
    return tuple((form[k, k], base) for k, base in enumerate(bases) if form[k, k] != 0)


@dataclass(frozen=True)
class DampedSpin:
    """Small deviations from a steady spin about b_k, k = ``axis``, of the body with its slug.

    ``block``: Jacobian of the motion across the axis. ``coefficients``: of its characteristic
    quartic in lambda, highest power first. Over the moments of the body, J_s, c and the rate nu.
    """

    axis: int
    block: Expr
    coefficients: tuple[Expr, ...]

    @cached_property
    def conditions(self) -> tuple[Expr, ...]:
        """Hurwitz's determinants; the spin is stable where all are positive."""
        return hurwitz_determinants(self.coefficients)


@lru_cache
def damped_spin(axis: int) -> DampedSpin:
    """Linearise the slug model at a spin about ``axis``, sigma = 0; conditions by Routh-Hurwitz.

    The axial pair decouples: its roots are zero (the choice of nu) and one negative. The conditions
    hold if and only if I_k of the body exceeds both other moments, for every J_s, c and nu.
    """
    A = linearised(viscous_slug(), axis)
    across = [k for k in range(6) if k % 3 != axis - 1]
    along = [k for k in range(6) if k % 3 == axis - 1]
    assert A.extract(across, along).is_zero_matrix
    assert A.extract(along, across).is_zero_matrix
    block = sp.ImmutableMatrix(A.extract(across, across))
    polynomial = block.charpoly(ROOT)
    scaled = sp.Poly(sp.numer(sp.together(polynomial.as_expr())), ROOT).all_coeffs()
    return DampedSpin(axis, block, tuple(scaled))


def damped_stability(
    moments: Sequence[Expr], axis: int, slug: Expr = 1, damping: Expr = 1, rate: Expr = 1
) -> str:
    """Return whether the body with its slug is stable, unstable or neutral in spin about ``axis``.

    ``moments`` of the body without the slug and ``slug`` J_s in kg m^2, ``damping`` c in N m s,
    ``rate`` in rad/s. Neutral: a root at zero, none to the right of the imaginary axis. Raises
    `InputError` for moments that no body has, a rate of zero, J_s or c that are not positive.

    >>> [damped_stability((1, 2, 3), k) for k in (1, 2, 3)]
    ['unstable', 'unstable', 'stable']
    """
    if not (number(slug) > 0 and number(damping) > 0):
        got = f"J_s = {slug}, c = {damping}"
        raise InputError("slug and damping must be positive", where="viscous_slug", got=got)
    values = steady_values(moments, rate) | {SLUG: number(slug), DAMPING: number(damping)}
    return VERDICTS[max(-sign(c.subs(values)) for c in damped_spin(axis).conditions)]


def energy_at_nutation() -> Expr:
    """Return T(H, theta) of a symmetric body; theta is the angle between h and the axis b3.

    >>> energy_at_nutation()
    H**2*sin(theta)**2/(2*It) + H**2*cos(theta)**2/(2*Ia)
    """
    h = vector("B", (H * sp.sin(NUTATION), 0, H * sp.cos(NUTATION)))
    inertia = sp.diag(TRANSVERSE, TRANSVERSE, AXIAL)
    balance = angular_momentum(inertia, OMEGA) - h
    (omega,) = sp.linsolve(balance.components, OMEGA.components)
    return vector("B", omega).dot(h) / 2


def nutation_rate() -> Expr:
    """Return d(theta)/dt (rad/s) of a quasi-rigid symmetric body that loses the power D, H constant.

    From dT/dt = -D with T(H, theta) (energy sink; Hughes, 1986, ch. 5). Not defined at theta =
    0 and 90 degrees, nor for a sphere, where T does not depend on theta to first order.
    """
    return -POWER / sp.factor(energy_at_nutation().diff(NUTATION))


def nutation_trend(transverse: Expr, axial: Expr) -> str:
    """Return whether spin about the axis of symmetry is stable under an energy sink.

    The sign of d(theta)/dt for 0 < theta < 90 degrees: oblate bodies are stable, prolate ones end
    in flat spin. Arguments: moments of inertia (kg m^2). Raises as `eom.mechanics.freebody.classify` does.
    """
    exact = [number(transverse), number(axial)]
    check_principal_moments([float(exact[0]), *map(float, exact)], "energy sink")
    point = {TRANSVERSE: exact[0], AXIAL: exact[1], NUTATION: sp.pi / 4, H: sp.Integer(1)}
    return VERDICTS[-sign(energy_at_nutation().diff(NUTATION).subs(point))]


def effective_inertia_rate() -> Expr:
    """Return d(H^2/(2 T))/dt (kg m^2/s) of any quasi-rigid body that loses the power D.

    H^2/(2 T) lies between the least and the greatest moment and never falls; it passes the
    intermediate one at the separatrix, and ends at the greatest one (major-axis rule).
    """
    return time_derivative(H**2 / (2 * T), {T: -POWER})
