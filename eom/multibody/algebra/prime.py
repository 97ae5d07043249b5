"""Numbers modulo a large prime as scalars of the recursions: exact ranks, and exact fractions back.

What holds for random residues holds identically but for a chance of its degree over the prime (Schwartz and
Zippel). A fraction with numerator and denominator below the root of half the prime comes back from its
residue (Wang, Guy and Davenport, SIGSAM Bulletin 16(2), 1982, p. 2).
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from math import isqrt
from typing import Any

from eom.errors import InputError

PRIME = 2**1279 - 1
"""Large enough for products of many doubles as fractions."""
_BOUND = isqrt(PRIME // 2)


class Residue:
    """A number modulo `PRIME`, with the operators of a field; plain numbers may stand beside it."""

    __slots__ = ("value",)

    def __init__(self, value: int) -> None:
        self.value = value % PRIME

    def __add__(self, other: Any) -> Residue:
        return Residue(self.value + residue(other))

    __radd__ = __add__

    def __neg__(self) -> Residue:
        return Residue(-self.value)

    def __sub__(self, other: Any) -> Residue:
        return Residue(self.value - residue(other))

    def __rsub__(self, other: Any) -> Residue:
        return Residue(residue(other) - self.value)

    def __mul__(self, other: Any) -> Residue:
        return Residue(self.value * residue(other))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Residue:
        return Residue(self.value * pow(residue(other), -1, PRIME))

    def __rtruediv__(self, other: Any) -> Residue:
        return Residue(residue(other) * pow(self.value, -1, PRIME))


def residue(x: Any) -> int:
    """Return a scalar or an exact number as a residue."""
    if type(x) is Residue:
        return x.value
    if type(x) is int:
        return x
    return int(x.numerator) * pow(int(x.denominator), -1, PRIME)


def fraction(value: int) -> Fraction | None:
    """Return the one small fraction with this residue; None if there is none."""
    above, below, s, t = PRIME, value % PRIME, 0, 1
    while below > _BOUND:
        quotient = above // below
        above, below = below, above - quotient * below
        s, t = t, s - quotient * t
    if t == 0 or abs(t) > _BOUND:
        return None
    return Fraction(below, t)


class Angles:
    """Sines and cosines of residues: those of a random point of the circle, the same for the same angle."""

    def __init__(self, draw: random.Random) -> None:
        self._draw = draw
        self._known: dict[int, int] = {}

    def _half(self, x: Any) -> Residue:
        key = residue(x)
        if key not in self._known:
            self._known[key] = self._draw.randrange(2, PRIME)
        return Residue(self._known[key])

    def sin(self, x: Any) -> Residue:
        """Return 2 t / (1 + t^2)."""
        t = self._half(x)
        return 2 * t / (1 + t * t)

    def cos(self, x: Any) -> Residue:
        """Return (1 - t^2) / (1 + t^2)."""
        t = self._half(x)
        return (1 - t * t) / (1 + t * t)

    def sqrt(self, x: Any) -> Residue:
        """Refuse: residues have no roots of their own."""
        raise InputError("lengths of springs have no exact values", got=repr(x))

    def keep(self, letter: str, part: str, suffix: str, value: Any) -> Any:  # noqa: ARG002
        """Return the value."""
        return value


def reduced(rows: Sequence[Sequence[int]]) -> tuple[list[list[int]], list[int]]:
    """Return the reduced row echelon form modulo `PRIME`, without rows of zeros, and the pivot columns."""
    matrix = [[x % PRIME for x in row] for row in rows]
    pivots: list[int] = []
    for column in range(len(matrix[0]) if matrix else 0):
        k = len(pivots)
        found = next((i for i in range(k, len(matrix)) if matrix[i][column]), None)
        if found is None:
            continue
        matrix[k], matrix[found] = matrix[found], matrix[k]
        inverse = pow(matrix[k][column], -1, PRIME)
        pivot = matrix[k] = [x * inverse % PRIME for x in matrix[k]]
        for i, row in enumerate(matrix):
            factor = row[column]
            if i != k and factor:
                matrix[i] = [(x - factor * y) % PRIME for x, y in zip(row, pivot, strict=True)]
        pivots.append(column)
    return matrix[: len(pivots)], pivots
