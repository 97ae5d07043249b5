"""Precession of a torque-free body with an axis of symmetry, which may carry a rotor about it.

Source: Hughes, Spacecraft Attitude Dynamics, 1986, ch. 4; with a rotor ch. 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.numbers import number, sign
from eom.kinematics.frames import unit_vector, vector
from eom.mass.inertia import check_principal_moments
from eom.mechanics.rigidbody import OMEGA, angular_momentum
from eom.system import as_expression

Expr = Any

TRANSVERSE, AXIAL = sp.Symbol("It", positive=True), sp.Symbol("Ia", positive=True)


@dataclass(frozen=True)
class Precession:
    """Steady precession of a torque-free body with I1 = I2, which may carry a rotor about b3.

    omega = ``rate`` h/H + ``spin`` b3 (rad/s): the body precesses about h and spins about its axis
    in the frame that precesses. ``body_cone_rate``: rate of omega about b3 as seen in the body,
    minus the spin. ``nutation``: angle between h and b3; ``body_cone``: half-angle of the cone of
    omega about b3, at most a right angle; ``space_cone``: angle between omega and h. In radians.
    """

    rate: Expr
    spin: Expr
    body_cone_rate: Expr
    nutation: Expr
    body_cone: Expr
    space_cone: Expr

    @property
    def sense(self) -> str:
        """Direct, retrograde, or none without spin or across the axis; numbers only."""
        about_axis = self.spin * self.rate * sp.cos(self.nutation)
        if not about_axis.is_number:
            raise InputError("the sense of precession needs numbers", got=about_axis)
        return SENSES[sign(about_axis)]


SENSES = {1: "direct", -1: "retrograde", 0: "none"}
"""By the sign of the spin about the axis times the axial part of the precession."""


def precession(
    transverse: Expr = TRANSVERSE,
    axial: Expr = AXIAL,
    omega: Sequence[Expr] = OMEGA.components,
    rotor_momentum: Expr = 0,
) -> Precession:
    """Return the precession of a symmetric body from its rates (Hughes, 1986, ch. 4; gyrostat ch. 6).

    ``transverse``, ``axial``: moments It = I1 = I2 and Ia = I3 (kg m^2), a rotor held fast;
    ``rotor_momentum``: Js Omega about b3 (N m s), constant. Without it the precession is direct if
    the body is prolate, retrograde if oblate. Raises `InputError` for h = 0 and impossible moments.

    >>> precession().spin
    omega_3*(-Ia + It)/It
    >>> precession(1, 2, (3, 0, 2)).sense
    'retrograde'
    """
    if len(omega) != 3:
        raise InputError("three rates are needed", where="precession", got=len(omega))
    values = [as_expression(v) for v in (transverse, axial, rotor_momentum, *omega)]
    for value in filter(lambda v: v.is_number, values):
        number(value)
    It, Ia, stored, w1, w2, w3 = values
    if It.is_number and Ia.is_number:
        check_principal_moments([float(It), float(It), float(Ia)], "precession")
    across = sp.sqrt(w1**2 + w2**2)
    turn = vector("P", (across, 0, w3))
    h = vector("P", (It * across, 0, Ia * w3 + stored))
    H = sp.sqrt(h.dot(h))
    if H == 0:
        raise InputError("no precession without angular momentum", where="precession", got="h = 0")
    given = dict(zip(_SYMMETRIC, (It, Ia, across, w3, stored, H), strict=True))
    rate, spin = (e.xreplace(given) for e in _along_h_and_axis())
    return Precession(
        rate=rate,
        spin=spin,
        body_cone_rate=-spin,
        nutation=sp.atan2(h.components[0], h.components[2]),
        body_cone=sp.atan2(across, sp.Abs(w3)),
        space_cone=sp.atan2(sp.Abs(turn.cross(h).components[1]), turn.dot(h)),
    )


_SYMMETRIC = (TRANSVERSE, AXIAL, *sp.symbols("omega_t omega_a p H", real=True))


@lru_cache
def _along_h_and_axis() -> tuple[Expr, Expr]:
    """Solve omega = rate h/H + spin b3 in the plane of omega, h and b3."""
    It, Ia, across, along, stored, H = _SYMMETRIC
    omega, axis = vector("P", (across, 0, along)), unit_vector("P", 3)
    h = angular_momentum(sp.diag(It, It, Ia), omega) + axis.scaled(stored)
    rate, spin = sp.symbols("rate spin", real=True)
    rest = omega - h.scaled(rate / H) - axis.scaled(spin)
    (found,) = sp.linsolve([rest.components[0], rest.components[2]], [rate, spin])
    return found[0], sp.factor_terms(sp.collect(found[1], along))
