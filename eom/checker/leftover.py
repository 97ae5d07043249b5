"""What is wrong with a scalar equation of a system, in named terms.

The left side less the right side, with all rates written out by the system's equations, is what is left
over. If that is a multiple of a term that the writer has, the term has a wrong sign or factor, or does not
belong; else it is what is missing. Where definitions of the system have names, the form with fewer terms is
told.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from eom.errors import InputError
from eom.numerals import without_rates
from eom.solutions import Restriction, rate
from eom.system import Expr, System

MAX_OPERATIONS = 1500
MAX_TERMS = 6

Pair = tuple[Expr, Expr]


@dataclass(frozen=True)
class Leftover:
    """Left side less right side on the solutions, the slip in words, and the term it is about.

    ``words`` holds a place {} for the term; both are in the symbols of the system.
    """

    residual: Expr
    words: str
    term: Expr


def leftover(system: System, pair: Pair, given: tuple[Restriction, ...] = ()) -> Leftover | None:
    """Return what is wrong with an equation; None where it would be long or is not explicit."""
    if system.mass_matrix is not None or sum(map(_size, pair)) > MAX_OPERATIONS:
        return None
    equal = {b: a for r in given for a, b in r.equal} | {
        s: sp.S.Zero for r in given for s in r.zero
    }
    left, right = (e.xreplace(equal) for e in pair)
    forms = [_expanded(f(system, left) - f(system, right)) for f in (_named, _plain)]
    forms = [f.xreplace(equal) for f in forms]
    residual = min(forms, key=lambda f: len(sp.Add.make_args(f)))
    if residual == 0 or len(sp.Add.make_args(residual)) > MAX_TERMS:
        return None
    if right == 0 and isinstance(left, rate):
        return Leftover(residual, "its rate is {}", _short(residual))
    return _blamed(system, left, right, residual) or Leftover(
        residual, "missing on the right side: {}", _short(residual)
    )


def _size(expression: Expr) -> int:
    return int(expression.count_ops())


def _plain(system: System, expression: Expr) -> Expr:
    """Return an expression over states, parameters and inputs."""
    found = without_rates(system, expression)
    if _size(found) > MAX_OPERATIONS:
        raise InputError("too long")
    return found


def _named(system: System, expression: Expr) -> Expr:
    """Write out rates of states alone, and keep the names of definitions."""
    rates = {q.symbol: r for q, r in zip(system.states, system.rates, strict=True)}

    def plain(e: Expr) -> Expr:
        if isinstance(e, rate):
            return rates.get(e.args[0], None) or without_rates(system, e)
        return e.func(*(plain(a) for a in e.args)) if e.args else e

    return plain(expression)


@lru_cache(maxsize=256)
def _expanded(expression: Expr) -> Expr:
    """Return a sum of monomials in sines, cosines and symbols, without squares of cosines."""
    found = sp.expand(sp.expand_trig(expression))
    cosines = sorted(found.atoms(sp.cos), key=sp.default_sort_key)
    return sp.expand(_reduced(found, cosines))


def _reduced(expression: Expr, cosines: list[Expr]) -> Expr:
    """Replace cos^2 by 1 - sin^2 where that cancels something."""
    for c in cosines:
        other = 1 - sp.sin(c.args[0]) ** 2
        tried = sp.expand(
            expression.replace(
                lambda e, c=c: e.is_Pow and e.base == c and e.exp.is_Integer and e.exp > 1,
                lambda e, c=c, other=other: other ** (e.exp // 2) * c ** (e.exp % 2),
            )
        )
        if len(sp.Add.make_args(tried)) < len(sp.Add.make_args(expression)):
            expression = tried
    return expression


def _short(residual: Expr) -> Expr:
    """Return a residual with common factors in front."""
    return sp.factor_terms(residual) if residual.is_Add else residual


def _blamed(system: System, left: Expr, right: Expr, residual: Expr) -> Leftover | None:
    """Return the term of the writer of which the residual is a multiple."""
    found = []
    for side, sign in ((right, -1), (left, 1)):
        for term in sp.Add.make_args(sp.expand_mul(side)):
            ratio = _ratio(system, residual, term)
            if ratio is not None and term != 0:
                found.append((1 - sign * ratio, term))
    if not found:
        return None
    ranked = sorted(found, key=lambda f: _RANK.get(f[0], 3))
    factor, term = ranked[0]
    words = _WORDS.get(factor, f"the factor should be {factor} times as large: {{}}")
    return Leftover(residual, words, term)


_WORDS = {sp.S.NegativeOne: "wrong sign: {}", sp.S.Zero: "does not belong here: {}"}
_RANK = {sp.S.NegativeOne: 0, sp.S.Zero: 2}


def _ratio(system: System, residual: Expr, term: Expr) -> Expr | None:
    """Return the number by which a term makes the residual."""
    for form in (_named, _plain):
        own = _expanded(form(system, term))
        if own == 0:
            continue
        whole = residual if form is _named else _expanded(form(system, residual))
        ratio = sp.cancel(_lead(whole) / _lead(own))
        if ratio.is_Rational and sp.expand(whole - ratio * own) == 0:
            return ratio
    return None


def _lead(expression: Expr) -> Expr:
    return min(sp.Add.make_args(expression), key=sp.default_sort_key)
