"""What several derivations share: names for components, and explicit columns."""

from __future__ import annotations

import sympy as sp

from eom.derivations.derivation import Maker
from eom.terms.terms import Equation, Term, column, dot, entries, expr
from eom.terms.vocabulary import unit


def name_components(
    d: Maker, vector: Term, letter: str, frame: str, meaning: str
) -> tuple[Term, Term, Term]:
    """Let letter_1, letter_2, letter_3 stand for the components of a vector."""
    named = []
    for k in (1, 2, 3):
        symbol = sp.Symbol(f"{letter}_{k}", real=True)
        d.name_scalar(symbol, dot(unit(frame, k), vector), meaning.format(k=k))
        named.append(expr(symbol))
    return (named[0], named[1], named[2])


def explicit(d: Maker, vector: Term, letter: str, frame: str, meaning: str) -> Equation:
    """Name the components of a vector and state its column."""
    named = name_components(d, vector, letter, frame, meaning)
    column_of = entries([[c] for c in named])
    return d.state(Equation(column(vector, frame), column_of), f"components in {frame}").equation
