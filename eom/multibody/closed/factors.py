"""What terms share, and linear equations solved group by group, as formulas."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import reduce
from typing import Any

import sympy as sp

Expr = Any


def shared_factor(terms: Iterable[Expr], moving: Collection[Expr]) -> Expr:
    """Return what all terms share: numbers, and factors without symbols that move.

    Terms are taken as they are written: a sum as its parts, a product as its factors. Those of the
    factors that are parameters are taken to be other than zero, as masses and lengths are.

    >>> m, l, g, q = sp.symbols("m l g q")
    >>> shared_factor([m * l**2 / 2, m * g * l * sp.sin(q)], {q})
    l*m/2
    """
    parts = [p for t in terms for p in sp.Add.make_args(t)]
    if not parts:
        return sp.S.One
    numbers = [p.as_coeff_Mul()[0] for p in parts]
    number = reduce(sp.gcd, map(abs, numbers)) if all(n.is_Rational for n in numbers) else sp.S.One
    powers = [dict(_powers(p.as_coeff_Mul()[1], moving)) for p in parts]
    shared = {b: min(p.get(b, 0) for p in powers) for b in powers[0]}
    return sp.Mul(number, *(b**n for b, n in shared.items() if n > 0))


def _powers(product: Expr, moving: Collection[Expr]) -> Iterator[tuple[Expr, int]]:
    """Yield the constant factors of a product with their whole positive powers."""
    for f in sp.Mul.make_args(product):
        base, power = f.as_base_exp()
        if power.is_Integer and power > 0 and not base.free_symbols & set(moving):
            yield base, int(power)


def quotient(x: Expr, by: Expr) -> Expr:
    """Return x over what each of its terms has as a factor, as it is written."""
    return sp.Add(*(part / by for part in sp.Add.make_args(x)))


def solved_by_groups(matrix: Expr, right: Expr) -> dict[int, Expr]:
    """Return x with ``matrix`` x = ``right``, symmetric: by Cramer's rule, each group by itself."""
    found: dict[int, Expr] = {}
    for group in _groups(matrix):
        A = sp.Matrix([[matrix[i, j] for j in group] for i in group])
        whole = A.det(method="berkowitz")
        for n, k in enumerate(group):
            changed = A.copy()
            changed[:, n] = sp.Matrix([right[i] for i in group])
            found[k] = changed.det(method="berkowitz") / whole
    return found


def _groups(matrix: Expr) -> list[Sequence[int]]:
    """Return the rows that hang together."""
    groups: list[set[int]] = []
    for i in range(matrix.rows):
        mine = {i, *(j for j in range(matrix.cols) if matrix[i, j] != 0)}
        apart = [g for g in groups if not g & mine]
        groups = [*apart, mine.union(*(g for g in groups if g & mine))]
    return [sorted(g) for g in groups]
