"""The herpolhode: the curve of omega on the invariable plane of the torque-free body.

Source: Goldstein, Poole, Safko, Classical Mechanics, 2002, sect. 5.6 (Poinsot's construction).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.kinematics.frames import vector
from eom.kinematics.transport import first_derivative
from eom.mechanics.freebody import (
    MOMENTS,
    SQUARES,
    H,
    T,
    ends_of,
    kind_of,
    linear_constants,
    motion_of,
)
from eom.mechanics.rigidbody import OMEGA, angular_momentum, euler_equations, principal_inertia

Expr = Any


@dataclass(frozen=True)
class Herpolhode:
    """The curve of omega on the invariable plane, which stands normal to h (Poinsot).

    ``distance``: of the plane from the fixed point, 2 T/H; ``inner`` and ``outer``: least and
    greatest distance of the curve from the foot of h. All in rad/s.
    """

    distance: Expr
    inner: Expr
    outer: Expr


def herpolhode(moments: Sequence[Expr], omega: Sequence[Expr]) -> Herpolhode:
    """Return plane and radii of the herpolhode.

    Arguments, numbers and errors as in `eom.mechanics.freebody.classify`.

    >>> herpolhode((2, 2, 1), (3, 0, 4))
    Herpolhode(distance=17*sqrt(13)/13, inner=6*sqrt(13)/13, outer=6*sqrt(13)/13)
    """
    motion = motion_of(moments, omega)
    energy, squared = motion.constants
    foot = (2 * energy) ** 2 / squared
    ends = ends_of(motion, kind_of(motion))
    inner, outer = motion.root_range([sp.Add(*end) - foot for end in ends])
    return Herpolhode(motion.root(foot), inner, outer)


def turning_point(k: int, moments: Sequence[Expr] = MOMENTS) -> tuple[Expr, ...]:
    """Return the squares of omega_1..3 where the polhode crosses omega_k = 0, over T and H.

    They are points of the motion where none of them is negative.
    """
    equations = linear_constants(moments) * sp.Matrix(SQUARES) - sp.Matrix([2 * T, H**2])
    (solution,) = sp.linsolve([*equations, SQUARES[k - 1]], SQUARES)
    return tuple(solution)


def herpolhode_radius(k: int) -> Expr:
    """Return the radius where omega_k = 0; for I1 < I2 < I3 the extremes have k = 2 and 1 or 3.

    It is the length of omega less its part along h, 2 T/H.
    """
    return sp.sqrt(sp.Add(*turning_point(k)) - (2 * T / H) ** 2)


def herpolhode_rate() -> Expr:
    """Return the rate (rad/s) at which the herpolhode turns about h, over omega and the moments.

    rho = omega - (omega . h) h/H^2 has the inertial derivative of omega, since h and T are
    constant; the rate is (rho x rho') . h/(H rho^2). It is 0/0 in steady spin, where rho = 0.
    """
    J, _ = principal_inertia()
    _, rates = euler_equations(J, vector("B", (0, 0, 0)))
    h = angular_momentum(J, OMEGA)
    squared = h.dot(h)
    rho = OMEGA - h.scaled(OMEGA.dot(h) / squared)
    moving = dict(zip(OMEGA.components, rates, strict=True))
    rho_dot = first_derivative(OMEGA, OMEGA, moving).total
    return rho.cross(rho_dot).dot(h) / (sp.sqrt(squared) * rho.dot(rho))
