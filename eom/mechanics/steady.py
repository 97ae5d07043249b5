"""Steady spin: when rates are constant, and which spins of the rigid body are stable.

Principal axes throughout (Hughes, Spacecraft Attitude Dynamics, 1986, ch. 4). What dissipation
does to steady spins is in `eom.mechanics.dissipation`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.numbers import number, sign
from eom.kinematics.frames import Vector, vector
from eom.mass.inertia import check_principal_moments
from eom.mechanics.freebody import MOMENTS
from eom.mechanics.rigidbody import OMEGA, angular_momentum, free_rigid_body
from eom.system import System

Expr = Any

SPIN_RATE = sp.Symbol("nu", positive=True)
ROOT = sp.Symbol("lambda")


@dataclass(frozen=True)
class ConstantRate:
    """A motion with constant rates: the torque (N m, in B) that goes with it, and the proof.

    ``forces``: torque - omega x h, which is J d(omega)/dt; all zero.
    """

    inertia: Expr
    omega: Vector
    torque: Vector
    forces: tuple[Expr, ...]


def constant_rate(inertia: Expr, omega: Vector, torque: Vector | None = None) -> ConstantRate:
    """Return what Euler's equations say of ``omega`` under ``torque``, omega x h if None.

    With omega x h any rates stay constant, about any axis of any body: a wheel that is out of
    balance turns at a constant rate and loads its bearings.
    """
    needed = omega.cross(angular_momentum(inertia, omega))
    applied = needed if torque is None else torque
    return ConstantRate(inertia, omega, applied, (applied - needed).map(sp.expand).components)


def constant_rate_counterexamples() -> dict[str, ConstantRate]:
    """Return motions against "rates are constant only without torque and about one given axis".

    Without torque they are where omega x J omega = 0: omega is along some principal axis, which
    need not be b1, b2 or b3. With a torque they may be about any axis.

    >>> constant_rate_counterexamples()["any body, with torque"].torque.components[0]
    -I2*omega_2*omega_3 + I3*omega_2*omega_3
    """
    free = vector("B", (0, 0, 0))
    I1, _, I3 = MOMENTS
    equator = vector("B", (*OMEGA.components[:2], 0))
    return {
        "spherical body, free": constant_rate(sp.diag(I1, I1, I1), OMEGA, free),
        "symmetric body, free": constant_rate(sp.diag(I1, I1, I3), equator, free),
        "any body, with torque": constant_rate(sp.diag(*MOMENTS), OMEGA),
    }


def linearised(system: System, axis: int) -> Expr:
    """Return the Jacobian of the rates at spin ``nu`` about ``axis``, all other states zero.

    Raises `InputError` where that is no steady motion of the system.
    """
    states = [q.symbol for q in system.states]
    if axis not in (1, 2, 3):
        raise InputError("no such axis", got=axis, expected="1, 2 or 3")
    steady = dict.fromkeys(states, sp.Integer(0)) | {OMEGA.components[axis - 1]: SPIN_RATE}
    rates = sp.Matrix([system.expand(r) for r in system.rates])
    if any(sp.expand(r) != 0 for r in rates.xreplace(steady)):
        raise InputError("not a steady motion", where=system.name, got=f"spin about b{axis}")
    return sp.ImmutableMatrix(rates.jacobian(states).xreplace(steady))


@dataclass(frozen=True)
class SteadySpin:
    """Small deviations from a steady spin of the rigid body about b_k, k = ``axis``.

    ``characteristic``: polynomial in the exponent lambda (1/s). ``squared_growth_rate``: lambda^2
    of the transverse motion (1/s^2); negative where it is stable. Both over nu and the moments.
    """

    axis: int
    characteristic: Expr
    squared_growth_rate: Expr


@lru_cache
def steady_spin(axis: int) -> SteadySpin:
    """Linearise Euler's equations at a spin about ``axis`` (Hughes, 1986, ch. 4).

    >>> steady_spin(2).squared_growth_rate
    nu**2*(I1 - I2)*(I2 - I3)/(I1*I3)
    """
    A = linearised(free_rigid_body(), axis)
    polynomial = A.charpoly(ROOT)
    growth = -polynomial.coeff_monomial(ROOT)
    return SteadySpin(axis, polynomial.as_expr(), sp.factor(growth))


@dataclass(frozen=True)
class Verdict:
    """``kind``: stable, unstable or neutral. ``rate``: nutation frequency or growth rate (rad/s).

    Neutral is a sphere, or a symmetric body about an axis in its equator: a deviation grows no
    faster than in proportion to time.
    """

    kind: str
    rate: Expr


VERDICTS = {-1: "stable", 0: "neutral", 1: "unstable"}
"""Stability by the sign of what a stable motion has negative."""


def spin_stability(moments: Sequence[Expr], axis: int, rate: Expr = 1) -> Verdict:
    """Return whether the free rigid body's spin about ``axis`` at ``rate`` (rad/s) is stable.

    A stable one is so in the sense of Lyapunov too: T and H confine the polhode. Numbers are
    compared exactly. Raises `InputError` for moments that no body has and a rate of zero.

    >>> spin_stability((1, 2, 3), 2, 3)
    Verdict(kind='unstable', rate=sqrt(3))
    """
    values = steady_values(moments, rate)
    squared = steady_spin(axis).squared_growth_rate.subs(values)
    return Verdict(VERDICTS[sign(squared)], sp.sqrt(abs(squared)))


def steady_values(moments: Sequence[Expr], rate: Expr) -> dict[Expr, Expr]:
    """Return the values of I1, I2, I3 and nu = abs(rate); raise as `spin_stability` does."""
    exact = [number(m) for m in moments]
    if len(exact) != 3 or number(rate) == 0:
        got = f"{len(exact)} moments, rate {rate}"
        raise InputError("three moments and a rate other than zero are needed", got=got)
    check_principal_moments([float(m) for m in exact], "steady spin")
    return dict(zip(MOMENTS, exact, strict=True)) | {SPIN_RATE: abs(number(rate))}


def hurwitz_determinants(coefficients: Sequence[Expr]) -> tuple[Expr, ...]:
    """Return what must be positive for every root to have a negative real part.

    ``coefficients``: of the polynomial, highest power first, the first one positive. They are the
    leading principal minors of Hurwitz's matrix (Hughes, 1986, app. A).
    """
    n = len(coefficients) - 1

    def entry(i: int, j: int) -> Expr:
        power = 2 * (j + 1) - (i + 1)
        return coefficients[power] if 0 <= power <= n else sp.Integer(0)

    matrix = sp.Matrix(n, n, entry)
    return tuple(sp.factor(matrix[:k, :k].det(method="berkowitz")) for k in range(1, n + 1))
