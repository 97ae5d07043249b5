"""Small, bounded rearrangements of expressions, and the count of their operations."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sympy as sp

Expr = Any


def gather_above(expression: Expr, variables: Iterable[Expr]) -> Expr:
    """Return one fraction, with its numerator gathered as by `gather`.

    >>> a, b, c, x = sp.symbols("a b c x")
    >>> gather_above(a * x / c - b * x / c, (x,))
    x*(a - b)/c
    """
    above, below = sp.fraction(sp.together(expression))
    return gather(above, variables) / below


def gather(expression: Expr, variables: Iterable[Expr]) -> Expr:
    """Collect the constant coefficients of each distinct product of ``variables``.

    Everything free of ``variables`` counts as constant. Terms keep the order of their first
    appearance; no identity but distributivity is used.

    >>> a, b, x, y = sp.symbols("a b x y")
    >>> gather(a * x * y - b * x * y + x, (x, y))
    x*y*(a - b) + x
    """
    variables = tuple(variables)
    coefficients: dict[Expr, list[Expr]] = {}
    for term in sp.Add.make_args(sp.expand_mul(expression)):
        constant, product = term.as_independent(*variables, as_Add=False)
        coefficients.setdefault(product, []).append(constant)
    return sp.Add(
        *(
            sp.Mul(sp.factor_terms(sp.Add(*parts)), product)
            for product, parts in coefficients.items()
        )
    )


def explicit_rates(mass: Expr, forces: Iterable[Expr]) -> tuple[Expr | None, tuple[Expr, ...]]:
    """Divide by a diagonal mass matrix; keep any other one. Return (mass matrix or None, rates)."""
    forces = tuple(forces)
    if not mass.is_diagonal():
        return sp.ImmutableMatrix(mass), forces
    return None, tuple(f / mass[k, k] for k, f in enumerate(forces))


def operations(expressions: Iterable[Expr]) -> int:
    """Count arithmetic operations and function calls, each distinct subexpression once.

    >>> x, y = sp.symbols("x y")
    >>> operations([sp.sin(x) * y, sp.sin(x) + y])
    3
    """
    seen: set[Expr] = set()
    stack = list(expressions)
    count = 0
    while stack:
        node = stack.pop()
        if node in seen or not node.args:
            continue
        seen.add(node)
        stack.extend(node.args)
        count += len(node.args) - 1 if isinstance(node, sp.Add | sp.Mul) else 1
    return count
