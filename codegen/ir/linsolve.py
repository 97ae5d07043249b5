"""Linear systems inside programs: three operations, their exact values and their error bounds.

``factor`` takes the entries of a matrix and stands for its factorisation; ``back`` takes a
factorisation and a right-hand side and stands for the solution; ``item`` is one entry of a solution.
The value of a ``factor`` instruction is its `Shape`, that of an ``item`` the number of the entry.

Targets factor a symmetric matrix as L D L^T without exchanges as long as each pivot is at least
`PIVOT_GUARD` of the diagonal entry that it came from, which a positive definite matrix of any
reasonable condition fulfils; any other matrix as P A = L U with partial pivoting (Golub and Van Loan,
Matrix Computations, 4th ed., sect. 4.1 and 3.4).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

PIVOT_GUARD = 2.0**-40
"""Smallest pivot without exchanges, relative to the diagonal entry of the matrix."""


class Shape(NamedTuple):
    """``size`` rows; ``symmetric``: the entries of the upper triangle are given, by rows."""

    size: int
    symmetric: bool

    @property
    def entries(self) -> int:
        """Number of entries that are given."""
        n = self.size
        return n * (n + 1) // 2 if self.symmetric else n * n

    @property
    def places(self) -> list[tuple[int, int]]:
        """Row and column of each entry."""
        n = self.size
        return [(i, j) for i in range(n) for j in range(i if self.symmetric else 0, n)]

    @property
    def cost(self) -> int:
        """Multiplications and additions of a factorisation."""
        return self.size**3 // (3 if self.symmetric else 2) + 4 * self.size


def whole(shape: Shape, entries: Sequence[Any]) -> list[list[Any]]:
    """Return the matrix as rows."""
    rows: list[list[Any]] = [[None] * shape.size for _ in range(shape.size)]
    for (i, j), entry in zip(shape.places, entries, strict=True):
        rows[i][j] = entry
        if shape.symmetric:
            rows[j][i] = entry
    return rows


def factor_double(shape: Shape, *entries: Any) -> Any:
    """Return the matrix, in double precision."""
    return np.array(whole(shape, entries), dtype=np.float64)


def back_double(matrix: Any, *right: Any) -> Any:
    """Return the solution in double precision, NaN for a singular matrix."""
    try:
        return np.linalg.solve(matrix, np.array(right, dtype=np.float64))
    except np.linalg.LinAlgError:
        return np.full(len(right), np.nan)


def factor_exact(m: Any, shape: Shape, *entries: Any) -> Any:
    """Return the matrix in the mpmath context ``m``."""
    return m.matrix(whole(shape, entries))


def back_exact(m: Any, matrix: Any, *right: Any) -> list[Any]:
    """Return the solution, NaN for a singular matrix or one that is not finite."""
    if not all(m.isfinite(x) for x in (*matrix, *right)):
        return [m.nan] * len(right)
    factors = _pivoted(m, matrix)
    if any(row[k] == 0 for k, row in enumerate(factors[2])):
        return [m.nan] * len(right)
    return _substituted(factors, right)


def bound(m: Any, matrix: Any, errors: Any, right: Sequence[Any], right_errors: Any) -> list[float]:
    """Bound the errors of the solution from those of matrix and right-hand side, to first order.

    |dx| <= |A^-1| ((dA + g |L||U|) |x| + db) with g = 3 n u / (1 - 3 n u) (Higham, Accuracy and
    Stability of Numerical Algorithms, 2nd ed., theorem 9.4 and sect. 7.2; |L||U| of a factorisation
    with partial pivoting, or |L||D||L^T| where that is larger).
    """
    n = len(right)
    inverse = sizes_of_inverse(m, matrix)
    if inverse is None:
        return [float("inf")] * n
    solution = back_exact(m, matrix, *right)
    growth = _growth(m, matrix)
    unit = 3 * n * 2.0**-53
    size = [abs(float(x)) for x in solution]
    spread = [
        float(right_errors[i])
        + _sum_of_products(
            [float(errors[i][j]) + unit / (1 - unit) * growth[i][j] for j in range(n)], size
        )
        for i in range(n)
    ]
    return [_sum_of_products(row, spread) for row in inverse]


def sizes_of_inverse(m: Any, matrix: Any) -> list[list[float]] | None:
    """Return the moduli of the entries of the inverse; None for a singular matrix."""
    n = matrix.rows
    factors = _pivoted(m, matrix)
    if any(row[k] == 0 for k, row in enumerate(factors[2])):
        return None
    columns = [_substituted(factors, [m.mpf(int(i == j)) for i in range(n)]) for j in range(n)]
    return [[float(abs(columns[j][i])) for j in range(n)] for i in range(n)]


def _sum_of_products(one: Sequence[float], other: Sequence[float]) -> float:
    """Return the sum, where nothing times infinity is nothing."""
    return sum(a * b for a, b in zip(one, other, strict=True) if a and b)


def _growth(m: Any, matrix: Any) -> list[list[float]]:
    """Return |L||U| in the order of the rows of the matrix, the larger of both factorisations."""
    n = matrix.rows
    order, lower, upper = _pivoted(m, matrix)
    found = [[0.0] * n for _ in range(n)]
    for i in range(n):
        for j in range(n):
            terms = (abs(lower[i][k] * upper[k][j]) for k in range(min(i, j) + 1))
            found[order[i]][j] = float(sum(terms))
    plain = _plain(matrix)
    if plain is None:
        return found
    return [
        [max(a, b) for a, b in zip(p, q, strict=True)] for p, q in zip(found, plain, strict=True)
    ]


def _pivoted(m: Any, matrix: Any) -> tuple[list[int], list[list[Any]], list[list[Any]]]:
    n = matrix.rows
    rows = [[matrix[i, j] for j in range(n)] for i in range(n)]
    order = list(range(n))
    lower = [[m.mpf(int(i == j)) for j in range(n)] for i in range(n)]
    for k in range(n):
        best = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[best] = rows[best], rows[k]
        order[k], order[best] = order[best], order[k]
        lower[k][:k], lower[best][:k] = lower[best][:k], lower[k][:k]
        for i in range(k + 1, n):
            if rows[i][k] and rows[k][k]:
                factor = lower[i][k] = rows[i][k] / rows[k][k]
                changed = [a - factor * b for a, b in zip(rows[i][k:], rows[k][k:], strict=True)]
                rows[i][k:] = changed
    return order, lower, rows


def _substituted(
    factors: tuple[list[int], list[list[Any]], list[list[Any]]], right: Sequence[Any]
) -> list[Any]:
    """Solve by the factors that `_pivoted` found, all of whose pivots are other than zero."""
    order, lower, upper = factors
    n = len(right)
    x = [right[i] for i in order]
    for i in range(n):
        x[i] -= sum(lower[i][k] * x[k] for k in range(i))
    for i in range(n - 1, -1, -1):
        x[i] = (x[i] - sum(upper[i][k] * x[k] for k in range(i + 1, n))) / upper[i][i]
    return x


def _plain(matrix: Any) -> list[list[float]] | None:
    """Return |L||D||L^T|, or None for a matrix that is not symmetric or has a pivot refused."""
    n = matrix.rows
    if any(matrix[i, j] != matrix[j, i] for i in range(n) for j in range(i)):
        return None
    rows = [[matrix[i, j] for j in range(n)] for i in range(n)]
    total = [[0.0] * n for _ in range(n)]
    for k in range(n):
        pivot = rows[k][k]
        if not pivot > PIVOT_GUARD * matrix[k, k]:
            return None
        for i in range(k, n):
            for j in range(k, n):
                change = rows[i][k] * rows[k][j] / pivot
                total[i][j] += abs(float(change))
        for i in range(k + 1, n):
            factor = rows[i][k] / pivot
            rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k], strict=True)]
    return total


C_HELPERS = {
    "factor_": """\
/* Factor an n x n matrix that comes by rows, a symmetric one as its upper triangle: L D L^T unless a
 * pivot is too small. Then f[0] says how, f[1..n] are exchanges, and the factors stand from f[1 + n]. */
static void factor_(int n, int symmetric, double *f) {
    double *const a = f + 1 + n;
    int place = symmetric ? n * (n + 1) / 2 : n * n;
    for (int i = n - 1; i >= 0; --i)
        for (int j = n - 1; j >= (symmetric ? i : 0); --j) a[i * n + j] = f[--place];
    f[0] = 1.0;
    if (symmetric) {
        int done = 1;
        for (int i = 0; i < n; ++i) {
            f[1 + i] = a[i * n + i];
            for (int j = 0; j < i; ++j) a[i * n + j] = a[j * n + i];
        }
        for (int k = 0; k < n && done; ++k) {
            double *const row = a + k * n;
            const double pivot = row[k], inverse = 1.0 / pivot;
            done = pivot > GUARD * f[1 + k];
            for (int i = k + 1; i < n && done; ++i) {
                const double factor = row[i] * inverse;
                double *const other = a + i * n;
                for (int j = i; j < n; ++j) other[j] -= factor * row[j];
            }
        }
        if (done) return;
        for (int i = 0; i < n; ++i) {
            a[i * n + i] = f[1 + i];
            for (int j = i + 1; j < n; ++j) a[i * n + j] = a[j * n + i];
        }
    }
    f[0] = 2.0;
    for (int k = 0; k < n; ++k) {
        int best = k;
        for (int i = k + 1; i < n; ++i)
            if (fabs(a[i * n + k]) > fabs(a[best * n + k])) best = i;
        f[1 + k] = (double)best;
        for (int j = 0; j < n && best != k; ++j) {
            const double kept = a[k * n + j];
            a[k * n + j] = a[best * n + j];
            a[best * n + j] = kept;
        }
        for (int i = k + 1; i < n; ++i) {
            const double factor = a[i * n + k] /= a[k * n + k];
            for (int j = k + 1; j < n; ++j) a[i * n + j] -= factor * a[k * n + j];
        }
    }
}""".replace("GUARD", repr(PIVOT_GUARD)),
    "back_": """\
/* Solve for the right-hand side x, in place, by what factor_ made. */
static void back_(int n, const double *f, double *x) {
    const double *const a = f + 1 + n;
    const int symmetric = f[0] == 1.0;
    for (int k = 0; k < n; ++k) {
        if (symmetric) {
            const double scaled = x[k] / a[k * n + k];
            for (int i = k + 1; i < n; ++i) x[i] -= a[k * n + i] * scaled;
        } else {
            const int other = (int)f[1 + k];
            const double kept = x[k];
            x[k] = x[other];
            x[other] = kept;
        }
    }
    for (int i = 1; i < n && !symmetric; ++i)
        for (int j = 0; j < i; ++j) x[i] -= a[i * n + j] * x[j];
    for (int i = n - 1; i >= 0; --i) {
        double sum = x[i];
        for (int j = i + 1; j < n; ++j) sum -= a[i * n + j] * x[j];
        x[i] = sum / a[i * n + i];
    }
}""",
}
"""C helpers; ``f`` has room for 1 + n + n^2 doubles."""
