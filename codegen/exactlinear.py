"""Linear equations in fractions, and symmetric matrices of fractions: small, exact."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

Row = Sequence[Fraction]


def nullspace(rows: Sequence[Row], zero: Fraction) -> list[list[Fraction]]:
    """Return a basis of the vectors that all ``rows`` take to zero.

    Pivots below ``zero`` times the greatest entry count as zero, for data that are rounded. Gauss and
    Jordan's elimination with complete pivoting.
    """
    matrix = [list(r) for r in rows]
    width = len(matrix[0])
    limit = zero * max((abs(v) for r in matrix for v in r), default=Fraction(0))
    free = list(range(width))
    pivots: list[int] = []
    while free and (pivot := _largest(matrix, len(pivots), free, limit)):
        row, column = pivot
        top = len(pivots)
        matrix[top], matrix[row] = matrix[row], matrix[top]
        head = matrix[top][column]
        matrix[top] = [v / head for v in matrix[top]]
        for k, other in enumerate(matrix):
            factor = other[column]
            if k != top and factor:
                matrix[k] = [a - factor * b for a, b in zip(other, matrix[top], strict=True)]
        free.remove(column)
        pivots.append(column)
    return [_vector(matrix, pivots, column, width) for column in free]


def _largest(
    matrix: Sequence[Row], top: int, free: Sequence[int], limit: Fraction
) -> tuple[int, int] | None:
    places = [(k, c) for k in range(top, len(matrix)) for c in free]
    best = max(places, key=lambda p: abs(matrix[p[0]][p[1]]), default=None)
    return best if best and abs(matrix[best[0]][best[1]]) > limit else None


def _vector(
    matrix: Sequence[Row], pivots: Sequence[int], column: int, width: int
) -> list[Fraction]:
    vector = [Fraction(0)] * width
    vector[column] = Fraction(1)
    for k, pivot in enumerate(pivots):
        vector[pivot] = -matrix[k][column]
    return vector
