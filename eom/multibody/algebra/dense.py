"""Small symmetric linear systems over scalars of any kind, straight-line.

A = L D L^T without square roots and without pivoting (Golub and Van Loan, Matrix Computations, 4th ed.
(2013), sec. 4.1.2): stable for definite matrices. Zeros by structure cost nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from eom.multibody.algebra.scalars import Scalar, Work, is_zero, mul, reciprocal, sub

Matrix = Sequence[Sequence[Scalar]]


@dataclass(frozen=True)
class Factor:
    """The factors: L below the diagonal, the pivots and their reciprocals."""

    lower: tuple[tuple[Scalar, ...], ...]
    pivots: tuple[Scalar, ...]
    inverses: tuple[Scalar, ...]


def factor(A: Matrix, work: Work, names: Sequence[str]) -> Factor:
    """Return the factors of a symmetric matrix; ``names``: of its rows, for what is kept.

    Raises `ZeroDivisionError` for a pivot that is zero by structure.
    """
    lower: list[tuple[Scalar, ...]] = []
    pivots: list[Scalar] = []
    inverses: list[Scalar] = []
    for i, name in enumerate(names):
        row: list[Scalar] = []
        scaled: list[Scalar] = []  # L times D
        for j in range(i):
            rest = A[i][j]
            for k in range(j):
                rest = sub(rest, mul(scaled[k], lower[j][k]))
            rest = work.keep("solved", name, "", rest)
            scaled.append(rest)
            row.append(work.keep("factor", name, "", mul(rest, inverses[j])))
        pivot = A[i][i]
        for s, entry in zip(scaled, row, strict=True):
            pivot = sub(pivot, mul(s, entry))
        if is_zero(pivot):
            raise ZeroDivisionError(name)
        pivot = work.keep("pivot", name, "", pivot)
        lower.append(tuple(row))
        pivots.append(pivot)
        inverses.append(work.keep("pivot_inverse", name, "", reciprocal(pivot)))
    return Factor(tuple(lower), tuple(pivots), tuple(inverses))


def solve(
    found: Factor, b: Sequence[Scalar], work: Work, names: Sequence[str], letter: str = "solved"
) -> list[Scalar]:
    """Return x with A x = b; its entries are kept under ``letter``."""
    x = list(b)
    for i, row in enumerate(found.lower):
        for k, entry in enumerate(row):
            x[i] = sub(x[i], mul(entry, x[k]))
        x[i] = work.keep("solved", names[i], "", x[i])
    x = [mul(inverse, value) for inverse, value in zip(found.inverses, x, strict=True)]
    for i in range(len(x) - 1, -1, -1):
        for k in range(i + 1, len(x)):
            x[i] = sub(x[i], mul(found.lower[k][i], x[k]))
        x[i] = work.keep(letter, names[i], "", x[i])
    return x
