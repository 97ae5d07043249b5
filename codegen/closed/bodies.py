"""A body that a system states, with the values of a problem: that it moves as is stated, and its numbers.

What is proved here is proved of the program that is run, with the parameters and inputs of the run.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from codegen.closed.held import DIGITS, Held, fraction, states_of
from codegen.closed.polhode import context, number
from codegen.frontend.attitude import FRAME, INERTIA, OMEGA, QUATERNION, Stated
from codegen.ir.passes import needed, symmetric
from codegen.ir.program import Program
from codegen.ir.residues import FIELD, PRIME, RandomPoint
from eom.fields import RATIONALS
from eom.rotations import quaternion_product

Matrix = tuple[tuple[Fraction, ...], ...]
Vector = Sequence[int]
ZERO, ONE = Fraction(0), Fraction(1)
Torque = Callable[[RandomPoint, Sequence[int], Sequence[int]], Sequence[int]]
"""From a point, residues of the states, and omega, to the torque over the same J."""


@dataclass(frozen=True)
class Spinning:
    """A stated body that all states belong to: to omega, of states and constants, attitude, directions."""

    stated: Stated
    omega: tuple[int, ...]
    """For each component the number of its state, -1 for a constant."""
    constants: tuple[Fraction, ...]
    """The components that are constant; zero for others."""

    @property
    def quaternion(self) -> tuple[int, ...]:
        """Its states, if the attitude is one."""
        return self.stated.coordinates if self.stated.kind == QUATERNION else ()

    @property
    def angles(self) -> tuple[int, ...]:
        """The states that are angles, if the attitude is a sequence of them."""
        return self.stated.coordinates if self.stated.sequence else ()

    def omega_at(self, x: Sequence[Fraction]) -> list[Fraction]:
        """Return the angular velocity at states."""
        return [x[k] if k >= 0 else v for k, v in zip(self.omega, self.constants, strict=True)]


def bodies(held: Held) -> tuple[Spinning, ...]:
    """Return the stated bodies that all states belong to, with axes that are the body's own."""
    whole = set(range(held.count))
    found = (a for a in held.attitudes if a.states == whole and not a.unspun)
    return tuple(body for a in found if (body := _spinning(held, a)) is not None)


def _spinning(held: Held, a: Stated) -> Spinning | None:
    values, omega = a.values, a.omega
    steady = [k for k, s in zip(values.results[OMEGA], omega, strict=True) if s < 0]
    if moving(values, steady) or (a.sequence and min(a.coordinates) < 0):
        return None
    known = held.numbers(values, OMEGA)
    constants = tuple(ZERO if s >= 0 else v for s, v in zip(omega, known, strict=True))
    return Spinning(a, omega, constants)


def moving(values: Program, results: Sequence[int]) -> bool:
    """Tell whether instructions depend on states or time."""
    part = replace(values, results={OMEGA: tuple(results)})
    return not {"state", "time"}.isdisjoint(
        values.instructions[k].op for k in needed(part, [OMEGA])
    )


def inertia(held: Held, a: Stated) -> Matrix:
    """Return J, one if none is stated, as numbers."""
    if not a.values.results[INERTIA]:
        return ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))
    entries = held.constants(a.values, INERTIA)
    return tuple(tuple(entries[k] for k in row) for row in symmetric(range(6)))


def moves(held: Held, body: Spinning, torque: Torque | None = None) -> bool:
    """Tell whether all rates are those of the body under a torque, none if None; J is the stated one."""
    return held.proved(lambda point: residuals(held, body, point, torque))


def residuals(held: Held, body: Spinning, point: RandomPoint, torque: Torque | None) -> list[int]:
    """Return what is zero at a point if all rates are those of the body."""
    x = states_at(held, body, point)
    rates = held.residues(point, x)
    w = held.values(point, body.stated.values, OMEGA, x)
    slope = [rates[k] if k >= 0 else 0 for k in body.omega]
    J = residues_of_inertia(held, body.stated, point, x)
    turning = cross(w, times(J, w))
    load = [0, 0, 0] if torque is None else torque(point, x, w)
    found = [a + b - c for a, b, c in zip(times(J, slope), turning, load, strict=True)]
    found += [
        *held.values(point, body.stated.values, FRAME, x),
        *_kinematics(body, point, x, rates, w),
    ]
    for direction in body.stated.directions:
        v = [x[k] for k in direction]
        found += [rates[k] - c for k, c in zip(direction, cross(v, w), strict=True)]
    return [v % PRIME for v in found]


def states_at(held: Held, body: Spinning, point: RandomPoint) -> list[int]:
    """Return random states, a quaternion among them of unit length: a square over its norm."""
    x = states_of(point, held.count)
    if body.quaternion:
        p = [x[k] for k in body.quaternion]
        below = FIELD.inverse(sum(v * v for v in p))
        for k, v in zip(body.quaternion, quaternion_product(p, p), strict=True):
            x[k] = v * below % PRIME
    return x


def residues_of_inertia(
    held: Held, a: Stated, point: RandomPoint, x: Sequence[int]
) -> list[list[int]]:
    """Return J, one if none is stated, modulo the prime."""
    entries = held.values(point, a.values, INERTIA, x) or [1, 0, 0, 1, 0, 1]
    return symmetric(entries)


def _kinematics(
    body: Spinning, point: RandomPoint, x: Sequence[int], rates: Sequence[int], w: Sequence[int]
) -> list[int]:
    if body.quaternion:
        turned = quaternion_product([x[k] for k in body.quaternion], [0, *w])
        return [2 * rates[k] - v for k, v in zip(body.quaternion, turned, strict=True)]
    if body.angles:
        waves = [point.circle(x[k])[::-1] for k in body.angles]
        turns = [rates[k] for k in body.angles]
        found = angular_velocity(body.stated.sequence, waves, turns)
        return [a - b for a, b in zip(found, w, strict=True)]
    return []


def angular_velocity(
    axes: Sequence[int], waves: Sequence[tuple[Any, Any]], rates: Sequence[Any]
) -> list[Any]:
    """Return the angular velocity in the body: each turn's, seen after those that follow.

    ``waves``: sine and cosine of each angle.
    """
    w: list[Any] = [0, 0, 0]
    for axis, (s, c), rate in zip(axes, waves, rates, strict=True):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        w[i], w[j] = c * w[i] + s * w[j], c * w[j] - s * w[i]
        w[axis] += rate
    return w


def matrix_of_turns(axes: Sequence[int], waves: Sequence[tuple[Any, Any]]) -> list[list[Any]]:
    """Return the rows of C, which takes components in A to the body, of sines and cosines of turns."""
    C: list[list[Any]] = [[int(i == j) for j in range(3)] for i in range(3)]
    for axis, (s, c) in zip(axes, waves, strict=True):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        C[i], C[j] = (
            [c * a + s * b for a, b in zip(C[i], C[j], strict=True)],
            [c * b - s * a for a, b in zip(C[i], C[j], strict=True)],
        )
    return C


def attitude_at(body: Spinning, x: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """Return the quaternion at states: its own states, or of angles, then a unit to the last digit."""
    if not body.angles:
        return tuple(x[k] for k in body.quaternion)
    q: Sequence[Fraction] = (ONE, ZERO, ZERO, ZERO)
    for k, axis in zip(body.angles, body.stated.sequence, strict=True):
        own = context()
        own.dps = DIGITS
        quarter = fraction(own.tan(number(own, x[k]) / 4)) if x[k] else ZERO
        turn = [ZERO] * 4
        turn[0], turn[1 + axis] = RATIONALS.circle(quarter)
        q = quaternion_product(q, turn)
    return tuple(q)


def cross(x: Sequence[Any], y: Sequence[Any]) -> list[Any]:
    """Return the cross product."""
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def times(matrix: Sequence[Sequence[Any]], vector: Sequence[Any]) -> list[Any]:
    """Return a matrix times a column."""
    return [sum(a * b for a, b in zip(row, vector, strict=True)) for row in matrix]


def sine_and_cosine(x: Fraction) -> tuple[Fraction, Fraction]:
    """Return both to `DIGITS` digits."""
    own = context()
    own.dps = DIGITS
    angle = number(own, x)
    return fraction(own.sin(angle)), fraction(own.cos(angle))


def positive_definite(J: Matrix) -> bool:
    """Return whether the leading minors are positive."""
    (a, b, c), (_, d, e), (_, _, f) = J
    two = a * d - b * b
    return a > 0 and two > 0 and a * (d * f - e * e) - b * (b * f - e * c) + c * (b * e - d * c) > 0
