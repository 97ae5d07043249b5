"""Attitude kinematics: the 12 rotation sequences, the unit quaternion, the direction cosine matrix.

Every description gives the rotation ``C_BA`` from a reference frame A to the body frame B and the
rates of its coordinates from the components in B of the angular velocity of B in A. Sources:
Hughes, Spacecraft Attitude Dynamics (1986), ch. 2; Shuster, J. Astronaut. Sci. 41 (1993) 439.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import sympy as sp

from eom.errors import InputError, near_matches, typed
from eom.kinematics.frames import Vector, tilde, unit_vector, vector
from eom.quantities import Quantity, Singularity
from eom.rotations import cosines, quaternion_product

Expr = Any
Pair = tuple[Any, Any]  # real and imaginary part

TINY = sp.Rational(1, 2**120)
"""Less than the rounding of what is not zero in a unit quaternion, and more than the least float."""

SEQUENCES = (
    "1-2-1", "1-2-3", "1-3-1", "1-3-2", "2-1-2", "2-1-3",
    "2-3-1", "2-3-2", "3-1-2", "3-1-3", "3-2-1", "3-2-3",
)  # fmt: skip
GREEK_ANGLES = ("psi", "theta", "phi")  # first, second, third rotation


def elementary(axis: int, angle: Expr) -> Expr:
    """Return ``C_BA`` for a frame B got from A by turning through ``angle`` about ``axis``.

    Parameters
    ----------
    axis : int
        1, 2 or 3, of A and of B alike.
    angle : expression
        By which B is turned (rad), right-handed about the axis.

    Returns
    -------
    matrix
        3 x 3; it takes components in A to components in B.

    Notes
    -----
    Euler's theorem: C = cos 1 + (1 - cos) a a^T - sin tilde(a).

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), sect. 2.2.

    Examples
    --------
    >>> elementary(3, sp.Symbol("psi")).row(0)
    Matrix([[cos(psi), sin(psi), 0]])
    """
    a = unit_vector("A", axis).column
    c, s = sp.cos(angle), sp.sin(angle)
    return sp.ImmutableMatrix(c * sp.eye(3) + (1 - c) * a * a.T - s * tilde(a))


def poisson(C: Expr, omega: Vector) -> Expr:
    """Return d(C_BA)/dt = -tilde(omega) C_BA, with omega of B in A, components in B."""
    return sp.ImmutableMatrix(-tilde(omega.components) * C)


class Attitude(Protocol):
    """A choice of attitude coordinates of a body frame B in a reference frame A.

    Made by `eom.kinematics.coordinates.attitude` of a name: ``quaternion``, ``dcm``, or a sequence such as
    ``3-1-2``.
    """

    @property
    def name(self) -> str:
        """How users ask for it."""

    @property
    def coordinates(self) -> tuple[Quantity, ...]:
        """The coordinates, in order."""

    @property
    def matrix(self) -> Expr:
        """``C_BA`` over the coordinates, 3 x 3: it takes components in A to components in B."""

    def rates(self, omega: Vector) -> tuple[Expr, ...]:
        """Return the rates of the coordinates.

        Parameters
        ----------
        omega : Vector
            Of B in A (rad/s), components in B.

        Returns
        -------
        tuple of expressions
            One a coordinate, in 1/s or rad/s.
        """

    @property
    def singularities(self) -> tuple[Singularity, ...]:
        """Where the rates fail."""

    @property
    def constraints(self) -> tuple[tuple[str, str, Expr], ...]:
        """What stays constant for every motion, as (name, meaning, expression)."""


@dataclass(frozen=True)
class RotationSequence:
    """Three successive turns about body axes, for example 3-1-2 by psi, theta, phi."""

    axes: tuple[int, int, int]
    angles: tuple[Expr, Expr, Expr]

    @property
    def name(self) -> str:
        """For example ``3-1-2``."""
        return "-".join(map(str, self.axes))

    @property
    def coordinates(self) -> tuple[Quantity, ...]:
        """The three angles, in the order of the turns."""
        places = ("first", "second", "third")
        return tuple(
            Quantity(a, "rad", f"{place} angle, about axis {axis}", "\\" + str(a))
            for a, axis, place in zip(self.angles, self.axes, places, strict=True)
        )

    @property
    def matrix(self) -> Expr:
        """``C_BA``: the product of the three elementary rotations, the last one leftmost."""
        first, second, third = (
            elementary(*pair) for pair in zip(self.axes, self.angles, strict=True)
        )
        return sp.ImmutableMatrix(third * second * first)

    def angular_velocity(self, rates: Sequence[Expr]) -> Vector:
        """Components in B of the angular velocity of B in A, by addition of the three turns."""
        second, third = (elementary(self.axes[k], self.angles[k]) for k in (1, 2))
        e1, e2, e3 = (unit_vector("B", axis).column for axis in self.axes)
        return vector("B", rates[0] * third * second * e1 + rates[1] * third * e2 + rates[2] * e3)

    def rates(self, omega: Vector) -> tuple[Expr, ...]:
        """Solve ``angular_velocity(rates) = omega`` by the reciprocal basis of the turn axes.

        Components are taken before the third turn, where the determinant of the three axes is
        plus or minus the sine or cosine of the second angle without any simplification.
        """
        w = vector("M", elementary(self.axes[2], self.angles[2]).T * omega.column)
        a1, a2, a3 = self._turn_axes()
        determinant = a1.dot(a2.cross(a3))
        reciprocal = (a2.cross(a3), a3.cross(a1), a1.cross(a2))
        return tuple(
            sp.Add(
                *(
                    wi * (ri / determinant)
                    for wi, ri in zip(w.components, r.components, strict=True)
                )
            )
            for r in reciprocal
        )

    def _turn_axes(self) -> tuple[Vector, Vector, Vector]:
        a1 = vector(
            "M", elementary(self.axes[1], self.angles[1]) * unit_vector("M", self.axes[0]).column
        )
        return a1, unit_vector("M", self.axes[1]), unit_vector("M", self.axes[2])

    @property
    def sense(self) -> int:
        """1 where the second axis follows the first in the order 1, 2, 3, 1; -1 where it precedes it."""
        return 1 if (self.axes[1] - self.axes[0]) % 3 == 1 else -1

    def of_quaternion(self, q: Sequence[Expr]) -> tuple[Expr, Expr, Expr]:
        """Return the three angles (rad) over a quaternion ``q``, scalar first, of any norm but zero.

        The first and the third are known up to whole turns. The second is between -pi/2 and pi/2, of a
        sequence whose first and third axes are the same between 0 and pi. With e_i, e_j, e_k the axes and
        e_m = e_i x e_j, the product of the three turns is, for k = i,

            q_0 + i q_i = cos(theta/2) exp(i (psi + phi)/2),
            q_j + i q_m = sin(theta/2) exp(i (psi - phi)/2);

        else the third turn is one about e_i between quarter turns about e_j, so that q (1, e_j) takes the
        place of q, and theta + pi/2 that of theta. Where either number is zero, the configuration is
        singular: it gets the argument 0, and the angles are those of the attitude all the same.
        Source: Hughes, Spacecraft Attitude Dynamics (1986), sect. 2.3, by `quaternion_product`.
        """
        first, second, sign = self._halves(q)
        one, other = (sp.atan2(y, x) for x, y in (first, second))
        large, small = (sp.sqrt(x**2 + y**2) for x, y in (first, second))
        theta = 2 * sp.atan2(small, large) - (0 if self.axes[0] == self.axes[2] else sp.pi / 2)
        return one + other, theta, sign * (one - other)

    def principal_of_quaternion(self, q: Sequence[Expr]) -> tuple[Expr, Expr, Expr]:
        """Return the three angles (rad) of a unit quaternion as `of_quaternion`, all between -pi and pi.

        They lose no digits that the quaternion has, also where two arguments nearly cancel: the sum of
        arguments is that of a product, and twice an argument less a quarter turn that of a square. To the
        real parts a number is added that is nothing beside what is not zero, so that the argument of zero
        is 0 here, too.
        """
        first, second, sign = self._halves(q)
        large, small = (x**2 + y**2 for x, y in (first, second))
        theta = 2 * sp.atan2(sp.sqrt(small), sp.sqrt(large))
        if self.axes[0] != self.axes[2]:
            theta = sp.atan2(sp.expand(small - large) / 2, sp.sqrt(small) * sp.sqrt(large))
        (a, b), (c, d) = ((x + TINY, y) for x, y in (first, second))
        sum_, difference = (
            sp.atan2(b * c + a * d, a * c - b * d),
            sp.atan2(b * c - a * d, a * c + b * d),
        )
        return sum_, theta, sign * difference

    def _halves(self, q: Sequence[Expr]) -> tuple[Pair, Pair, int]:
        """Return real and imaginary parts of the two numbers of `of_quaternion`, and the sign of phi."""
        i, j, k = self.axes
        m = 6 - i - j
        quarter = [sp.Integer(int(n in {0, j})) for n in range(4)]
        p, sign = (tuple(q), 1) if k == i else (quaternion_product(q, quarter), -self.sense)
        return (p[0], p[i]), (p[j], self.sense * p[m]), sign

    @property
    def singularities(self) -> tuple[Singularity, ...]:
        """The second angle at which the first and the third axis are parallel."""
        a1, a2, a3 = self._turn_axes()
        determinant = a1.dot(a2.cross(a3))
        meaning = f"the first and third axes of the {self.name} sequence are parallel"
        return (Singularity(determinant.as_coeff_Mul()[1], self.angles[1], meaning),)

    @property
    def constraints(self) -> tuple[tuple[str, str, Expr], ...]:
        """Angles are free."""
        return ()


@dataclass(frozen=True)
class UnitQuaternion:
    """Euler's parameters q0 = cos(angle/2), (q1, q2, q3) = axis sin(angle/2), scalar first."""

    symbols: tuple[Expr, Expr, Expr, Expr]

    @property
    def name(self) -> str:
        """``quaternion``."""
        return "quaternion"

    @property
    def coordinates(self) -> tuple[Quantity, ...]:
        """q0 to q3."""
        return tuple(
            Quantity(q, "1", f"{kind} part of the unit quaternion", f"q_{k}")
            for k, (q, kind) in enumerate(
                zip(self.symbols, ("scalar", "first", "second", "third"), strict=True)
            )
        )

    @property
    def matrix(self) -> Expr:
        """``C_BA = (q0^2 - q.q) 1 + 2 q q^T - 2 q0 tilde(q)`` (Hughes, sect. 2.2)."""
        return sp.ImmutableMatrix(cosines(self.symbols))

    def rates(self, omega: Vector) -> tuple[Expr, ...]:
        """Return half the quaternion product of q with (0, omega): an infinitesimal further turn."""
        return tuple(r / 2 for r in quaternion_product(self.symbols, (0, *omega.components)))

    @property
    def singularities(self) -> tuple[Singularity, ...]:
        """None."""
        return ()

    @property
    def constraints(self) -> tuple[tuple[str, str, Expr], ...]:
        """The norm."""
        return (
            ("q_norm", "norm of the quaternion", sp.sqrt(sp.Add(*(q**2 for q in self.symbols)))),
        )


@dataclass(frozen=True)
class DirectionCosines:
    """The nine entries of ``C_BA``, row by row, moved by Poisson's equation."""

    symbols: tuple[Expr, ...]

    @property
    def name(self) -> str:
        """``dcm``."""
        return "dcm"

    @property
    def coordinates(self) -> tuple[Quantity, ...]:
        """C11, C12, ..., C33."""
        return tuple(
            Quantity(
                c,
                "1",
                f"direction cosine of b{k // 3 + 1} and a{k % 3 + 1}",
                f"C_{{{k // 3 + 1}{k % 3 + 1}}}",
            )
            for k, c in enumerate(self.symbols)
        )

    @property
    def matrix(self) -> Expr:
        """``C_BA`` itself."""
        return sp.ImmutableMatrix(3, 3, self.symbols)

    def rates(self, omega: Vector) -> tuple[Expr, ...]:
        """Poisson's equation, row by row."""
        return tuple(poisson(self.matrix, omega))

    @property
    def singularities(self) -> tuple[Singularity, ...]:
        """None."""
        return ()

    @property
    def constraints(self) -> tuple[tuple[str, str, Expr], ...]:
        """Scalar products of the columns."""
        product = self.matrix.T * self.matrix
        return tuple(
            (
                f"C_column_{i + 1}{j + 1}",
                f"scalar product of columns {i + 1} and {j + 1} of C",
                product[i, j],
            )
            for i in range(3)
            for j in range(i, 3)
        )


def constraint_value(name: str) -> int:
    """Return what a constraint of that name equals: 1 for norms, 0 for products of two columns."""
    return int(not name.startswith("C_column") or name[-1] == name[-2])


def rotation_sequence(name: str, angles: Iterable[Expr] | None = None) -> RotationSequence:
    """Return the rotation sequence of that name, with angles psi, theta, phi unless given.

    Raises `InputError` for a name that is not one of the 12 sequences.

    >>> rotation_sequence("3-1-2").matrix[1, 2]
    sin(theta)
    """
    if name not in SEQUENCES:
        raise InputError(
            f"unknown rotation sequence {name!r}",
            expected="one of " + ", ".join(SEQUENCES),
            hint=near_matches(name, SEQUENCES),
        )
    symbols = angles or (sp.Symbol(n, real=True) for n in GREEK_ANGLES)
    a, b, c = symbols
    i, j, k = map(int, name.split("-"))
    return RotationSequence((i, j, k), (a, b, c))


def quaternion() -> UnitQuaternion:
    """Return the unit quaternion with symbols q0, q1, q2, q3."""
    q0, q1, q2, q3 = (sp.Symbol(f"q{k}", real=True) for k in range(4))
    return UnitQuaternion((q0, q1, q2, q3))


def direction_cosines() -> DirectionCosines:
    """Return the direction cosine matrix with symbols C11 to C33."""
    return DirectionCosines(
        tuple(sp.Symbol(f"C{i}{j}", real=True) for i in (1, 2, 3) for j in (1, 2, 3))
    )


@typed
def attitude(name: str) -> Attitude:
    """Return attitude coordinates by ``name``: ``quaternion``, ``dcm`` or one of the 12 sequences.

    Parameters
    ----------
    name : str
        ``quaternion``, ``dcm`` or one of the 12 sequences of turns, such as ``3-1-2``.

    Returns
    -------
    Attitude
        Coordinates of B in A: angles psi, theta, phi (rad) about axes of the body as turned so far;
        q0 to q3, scalar first; C11 to C33, row by row, of C_BA, which takes components in A to
        components in B.

    Raises
    ------
    InputError
        For other names.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), ch. 2; Shuster, J. Astronaut. Sci. 41 (1993) 439.

    Examples
    --------
    >>> attitude("3-1-2").matrix[1, 2]
    sin(theta)
    """
    by_name: dict[str, Callable[[], Attitude]] = {
        "quaternion": quaternion,
        "dcm": direction_cosines,
    }
    known = (*by_name, *SEQUENCES)
    if name not in known:
        raise InputError(
            f"unknown attitude {name!r}",
            expected="one of " + ", ".join(known),
            hint=near_matches(name, known),
        )
    return by_name[name]() if name in by_name else rotation_sequence(name)


def quaternion_of_sequence(name: str, angles: Sequence[float]) -> tuple[float, ...]:
    """Return the unit quaternion of a rotation sequence by ``angles`` in radians.

    >>> [round(q, 6) for q in quaternion_of_sequence("3-1-2", (0.0, 0.6, 0.0))]
    [0.955336, 0.29552, 0.0, 0.0]
    """
    q: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)
    for axis, angle in zip(rotation_sequence(name).axes, angles, strict=True):
        turn = [math.cos(angle / 2), 0.0, 0.0, 0.0]
        turn[axis] = math.sin(angle / 2)
        q = quaternion_product(q, turn)
    return q
