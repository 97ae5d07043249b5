"""Conditions of a chapter, such as which moment of inertia is the greatest, and signs that follow."""

from __future__ import annotations

from typing import Any

from eom.derivations.derivation import Chain, Derivation
from eom.terms.rules.inferences import signs
from eom.terms.terms import Equation, Term, expr, number

Expr = Any


def let(d: Derivation, *rows: tuple[Expr, str, str]) -> list[Chain]:
    """State conditions: of each what is not negative, as a SymPy expression, words and a label."""
    return [
        d.suppose(Equation(expr(e), number(0), ">="), words, label=label)
        for e, words, label in rows
    ]


def so(
    known: list[Chain], value: Expr, products: tuple[tuple[Expr, ...], ...], words: str, label: str
) -> Chain:
    """State that a value is not negative: a sum of ``products`` of squares and of what is known not to be.

    ``known``: equations that it rests on, and conditions, of which those that stand in it are cited.
    """
    factors = {f for product in products for f in product}
    cited = [c for c in known if c.equation.relation == "=" or _stands(c.equation.left, factors)]
    first, *others = cited
    made = (tuple(map(expr, product)) for product in products)
    return first.infer(words, signs(expr(value), *made), *others, label=label)


def _stands(term: Term, factors: set[Expr]) -> bool:
    return any(f in {term.expression, term.expression ** f.as_base_exp()[1]} for f in factors)
