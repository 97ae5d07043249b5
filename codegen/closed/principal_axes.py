"""Principal axes of an inertia matrix of fractions, and vectors and quaternions along them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from codegen.closed.held import fraction
from codegen.closed.polhode import Frame, context, number

EQUAL = Fraction(1, 10**40)
"""Moments that differ by less of their size are equal; they are known to 50 digits."""
Triple = tuple[Fraction, Fraction, Fraction]


@dataclass(frozen=True)
class Axes:
    """``columns``: unit vectors of the principal axes in the body; none where these are its own."""

    columns: tuple[Triple, ...] = ()

    @classmethod
    def own(cls) -> Axes:
        """Return the axes of the body themselves."""
        return cls()

    def to_body(self, v: Sequence[Any]) -> list[Any]:
        """Return components in the body of a vector along the principal axes."""
        if not self.columns:
            return list(v)
        c1, c2, c3 = self.columns
        rows = zip(c1, c2, c3, strict=True)
        return [float(a) * v[0] + float(b) * v[1] + float(c) * v[2] for a, b, c in rows]

    def turn_of(self, frame: Frame) -> tuple[float, float, float, float]:
        """Return the quaternion S of S v S^-1 = the components in the body of v given in ``frame``."""
        units = [[float(i == k) for i in range(3)] for k in range(3)]
        columns = [self.to_body(frame.listed(u)) for u in units]
        C = [[columns[k][i] for k in range(3)] for i in range(3)]
        trace = C[0][0] + C[1][1] + C[2][2]
        squares = [1 + trace, *(1 - trace + 2 * C[k][k] for k in range(3))]
        odd = [C[2][1] - C[1][2], C[0][2] - C[2][0], C[1][0] - C[0][1]]
        k = max(range(4), key=lambda n: squares[n])
        rows = [squares[0], *odd]
        if k:
            even = [C[k - 1][i] + C[i][k - 1] for i in range(3)]
            even[k - 1] = squares[k]
            rows = [odd[k - 1], *even]
        a, b, c, d = (v / (2 * math.sqrt(squares[k])) for v in rows)
        return a, b, c, d

    def from_body(self, v: Sequence[Fraction]) -> list[Fraction]:
        """Return components along the principal axes, exactly."""
        if not self.columns:
            return list(v)
        return [
            sum((a * b for a, b in zip(column, v, strict=True)), Fraction(0))
            for column in self.columns
        ]


def principal_axes(J: Sequence[Sequence[Fraction]]) -> tuple[Axes, Triple]:
    """Return principal axes, right-handed, and moments about them, of a symmetric matrix."""
    if not (J[0][1] or J[0][2] or J[1][2]):
        return Axes.own(), (J[0][0], J[1][1], J[2][2])
    own = context()
    own.dps += 20
    values, vectors = own.eigsy(own.matrix([[number(own, v) for v in row] for row in J]))
    if own.det(vectors) < 0:
        vectors = -vectors
    columns = [tuple(fraction(vectors[i, k]) for i in range(3)) for k in range(3)]
    a, b, c = (fraction(v) for v in values)
    b = a if abs(b - a) <= EQUAL * a else b
    c = b if abs(c - b) <= EQUAL * b else c
    x, y, z = ((u[0], u[1], u[2]) for u in columns)
    return Axes((x, y, z)), (a, b, c)
