"""Frames turned about an axis or by a sequence of turns, as power series with exact coefficients.

A turn about a coordinate axis is one in its plane; every other rotation is made of such turns. An
angle is given by a series and by the tangent of a quarter of its first coefficient, so that sine and
cosine of the angle and of its half are in the field; the first coefficient itself is a number on its
own, as nothing algebraic ties it to them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any, NamedTuple

from eom.exact import series
from eom.exact.series import Matrix, Series, Vector
from eom.rotations import quaternion_product

Quaternion = tuple[Series, Series, Series, Series]
"""Euler parameters: cosine of half the angle, then the axis times its sine."""


class Angle(NamedTuple):
    """An angle, its sine and cosine, and those of its half."""

    value: Series
    sine: Series
    cosine: Series
    half_sine: Series
    half_cosine: Series


@dataclass(frozen=True)
class Turned:
    """A frame after a rotation: matrix from components before to those after, Euler parameters.

    ``axis`` (the same components before and after) and ``angle``: of a rotation that was drawn by
    them; ``axes`` and
    ``turns``: axes and angles of a sequence.
    """

    matrix: Matrix
    quaternion: Quaternion
    axis: Vector | None = None
    angle: Angle | None = None
    axes: str = ""
    turns: tuple[Angle, ...] = ()


Build = Callable[[Sequence[Angle]], Turned]
"""A rotation from three angles."""


def angle(value: Series, quarter: Any) -> Angle:
    """Return an angle from its series and the tangent of a quarter of it at t = 0, if not its own."""
    field = value.field
    c, s = field.circle(field.quarter(value.coefficients[0], quarter))
    sine, cosine = series.sine_cosine(value.scaled(field.of(1, 2)), s, c)
    return Angle(value, (sine * cosine).scaled(2), cosine * cosine - sine * sine, sine, cosine)


def elementary(axis: int, sine: Series, cosine: Series) -> Matrix:
    """Return the passive rotation about one axis (from 0)."""
    zero = cosine.scaled(0)
    one = Series(zero.field, (1, *zero.coefficients[1:]))
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    rows = [[zero, zero, zero] for _ in range(3)]
    rows[axis][axis] = one
    rows[i][i] = rows[j][j] = cosine
    rows[i][j], rows[j][i] = sine, -sine
    return tuple(tuple(row) for row in rows)


def turned(axis: int, by: Angle) -> Turned:
    """Return a turn about one axis (from 0)."""
    zero = by.sine.scaled(0)
    parts = [by.half_sine if k == axis else zero for k in range(3)]
    matrix = elementary(axis, by.sine, by.cosine)
    return Turned(matrix, (by.half_cosine, parts[0], parts[1], parts[2]))


def _turned_rows(axis: int, by: Angle, rows: Matrix) -> Matrix:
    """Return the product of an elementary rotation and a matrix."""
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    s, c = by.sine, by.cosine
    found = list(rows)
    found[i] = tuple(c * x + s * y for x, y in zip(rows[i], rows[j], strict=True))
    found[j] = tuple(c * y - s * x for x, y in zip(rows[i], rows[j], strict=True))
    return tuple(found)


def composed(first: Turned, second: Turned) -> Turned:
    """Return two rotations one after the other.

    The product of their Euler parameters is Hamilton's, the first one left: q = q1 q2 (Shuster,
    J. Astronaut. Sci. 41 (1993) 439, whose own product has the factors in the other order).
    """
    matrix = series.product(second.matrix, first.matrix)
    return Turned(matrix, quaternion_product(first.quaternion, second.quaternion))


def reversed_(turn: Turned) -> Turned:
    """Return the rotation back."""
    a, x, y, z = turn.quaternion
    return Turned(series.transpose(turn.matrix), (a, -x, -y, -z))


def in_turn(turns: Iterable[Turned]) -> Turned:
    """Return rotations one after the other."""
    return reduce(composed, turns)


def sequence(axes: str) -> Build:
    """Return the rotation by turns about axes such as "321", each of the frame turned so far.

    It takes as many of the angles as there are axes.
    """

    def build(angles: Sequence[Angle]) -> Turned:
        turns = tuple(angles[: len(axes)])
        made = in_turn(turned(int(k) - 1, a) for k, a in zip(axes, turns, strict=True))
        return replace(made, axes=axes, turns=turns)

    return build


def about_axis(angles: Sequence[Angle]) -> Turned:
    """Return the rotation through the third angle about an axis that the first two direct.

    The axis is the third one of a frame turned by them: there the rotation is one in its plane.
    """
    first, second, by = angles
    aim = _turned_rows(1, second, elementary(0, first.sine, first.cosine))
    row = aim[2]
    axis = (row[0], row[1], row[2])
    inside = _turned_rows(2, by, aim)
    x, y, z = series.scale(by.half_sine, axis)
    matrix = series.product(series.transpose(aim), inside)
    return Turned(matrix, (by.half_cosine, x, y, z), axis, by)
