"""Scalar expressions in the language of Maxima, which STACK takes: from the tree, by a table.

Operations that the table does not know have no spelling, and neither have expressions that hold them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import sympy as sp

Expr = Any

SUM, PRODUCT, POWER, ATOM = 1, 2, 3, 4
"""How firmly a text holds together."""

Spelt = tuple[str, int]
Names = Mapping[Any, str]

RESERVED = frozenset(
    "and array beta break catch cons define delta diff do e else elseif enhance error eval exp false "
    "first float for from gamma i if ind inf infinity int integrate j kronecker lambda last length "
    "limit list lhs log map matrix minf mod next not noun op or params part phi pi plus prime psi "
    "rand ratio rest return rhs second signum simp solve step subst sum tans tau then thru total true "
    "und unit units unless while zero zeta zeroa zerob".split()
)
"""Words that Maxima or STACK keep for themselves, or read as a number or a function."""

FUNCTIONS: dict[Any, str] = {
    sp.sin: "sin",
    sp.cos: "cos",
    sp.tan: "tan",
    sp.atan: "atan",
    sp.asin: "asin",
    sp.acos: "acos",
    sp.exp: "exp",
    sp.Abs: "abs",
}


def names_for(symbols: Iterable[Any]) -> dict[Any, str]:
    """Return a name for each symbol that Maxima reads as one, all different; letters stay if they can.

    >>> names_for(sp.symbols("I_1 lambda"))
    {I_1: 'I_1', lambda: 'lambda0'}
    """
    found: dict[Any, str] = {}
    for symbol in sorted(symbols, key=str):
        name = "".join(c if c.isascii() and c.isalnum() else "_" for c in symbol.name)
        name = name if name[:1].isalpha() else f"x{name}"
        while name in RESERVED or name in found.values():
            name += "0"
        found[symbol] = name
    return found


def maxima(expression: Expr, names: Names) -> str | None:
    """Return an expression as Maxima reads it, None where it holds what the table does not know."""
    try:
        return _spelt(expression, names)[0]
    except LookupError:
        return None


def _spelt(value: Expr, names: Names) -> Spelt:
    if value.is_Symbol:
        return names[value], ATOM
    rule = _RULES.get(value.func) or (_number if value.is_Rational else None)
    if rule is None:
        raise LookupError(value.func)
    return rule(value, names)


def _inside(value: Expr, names: Names, least: int) -> str:
    text, firm = _spelt(value, names)
    return text if firm >= least else f"({text})"


def _number(value: Expr, _: Names) -> Spelt:
    if value.is_Integer:
        return str(value.p), ATOM if value.p >= 0 else SUM
    return f"{value.p}/{value.q}", PRODUCT if value.p > 0 else SUM


def _sum(value: Expr, names: Names) -> Spelt:
    first, *others = value.as_ordered_terms()
    text = _inside(first, names, SUM)
    for term in others:
        negative = term.could_extract_minus_sign()
        text += (
            f"-{_inside(-term, names, PRODUCT)}"
            if negative
            else f"+{_inside(term, names, PRODUCT)}"
        )
    return text, SUM


def _product(value: Expr, names: Names) -> Spelt:
    number = value.as_coeff_Mul()[0]
    if number.is_Rational and number < 0:
        return f"-{_inside(-value, names, PRODUCT)}", SUM
    above, below = value.as_numer_denom()
    if below != 1:
        return f"{_inside(above, names, PRODUCT)}/{_inside(below, names, POWER)}", PRODUCT
    return "*".join(_inside(f, names, POWER) for f in value.as_ordered_factors()), PRODUCT


def _power(value: Expr, names: Names) -> Spelt:
    base, exponent = value.as_base_exp()
    if value.exp.could_extract_minus_sign():
        return f"1/{_inside(1 / value, names, POWER)}", PRODUCT
    if exponent == sp.Rational(1, 2):
        return f"sqrt({_spelt(base, names)[0]})", ATOM
    return f"{_inside(base, names, ATOM)}^{_inside(exponent, names, ATOM)}", POWER


def _called(word: str) -> Callable[[Expr, Names], Spelt]:
    return lambda value, names: (f"{word}({_spelt(value.args[0], names)[0]})", ATOM)


_RULES: dict[Any, Callable[[Expr, Names], Spelt]] = {
    sp.Add: _sum,
    sp.Mul: _product,
    sp.Pow: _power,
    type(sp.pi): lambda *_: ("%pi", ATOM),
    **{function: _called(word) for function, word in FUNCTIONS.items()},
}
