"""What is wrong with a scalar equation of a system, in named terms.

The left side less the right side, with all rates written out by the system's equations, is what is left
over. If that is a multiple of a term that the writer has, the term has a wrong sign or factor, or does not
belong; else it is what is missing. Where definitions of the system have names, the form with fewer terms is
told.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import sympy as sp

from eom.errors import InputError
from eom.fields import RESIDUES
from eom.system import Expr, System
from eom.worlds.numerals import without_rates
from eom.worlds.solutions import Motion, Restriction, order, rate, spread

MAX_OPERATIONS = 1500
MAX_TERMS = 6
MAX_SPREAD = 3000
MAX_ORDER = 2
MAX_NUMBER = 100
FAR = 14
"""Rank from which on a factor is no slip: the difference is told as what is missing."""

Pair = tuple[Expr, Expr]


@dataclass(frozen=True)
class Leftover:
    """A slip in words with a place {} for a term, and that term, in the symbols of the system."""

    words: str
    term: Expr


def leftover(
    system: System, pair: Pair, motions: Sequence[Motion], given: tuple[Restriction, ...] = ()
) -> Leftover | None:
    """Return what is wrong with an equation; None where it would be long or is not explicit.

    ``motions``: solutions at which both sides have values that differ.
    """
    left, right = pair
    constant = right == 0 and isinstance(left, rate)
    blamed = _blamed(motions, left, right)
    if blamed is not None:
        return blamed
    found = residual(system, pair, given)
    if found is None:
        return None
    return Leftover("its rate is {}" if constant else "missing on the right side: {}", found)


def residual(system: System, pair: Pair, given: tuple[Restriction, ...] = ()) -> Expr | None:
    """Return the left side less the right side on the solutions; None if it is long or not explicit."""
    if system.mass_matrix is not None or sum(map(_size, pair)) > MAX_OPERATIONS:
        return None
    equal = {b: a for r in given for a, b in r.equal} | {
        s: sp.S.Zero for r in given for s in r.zero
    }
    left, right = pair
    if max(order(left), order(right)) > MAX_ORDER:
        return None
    forms = [_expanded(f(system, left - right).xreplace(equal)) for f in (_named, _plain)]
    found = min(forms, key=lambda f: len(sp.Add.make_args(f)))
    if found == 0 or len(sp.Add.make_args(found)) > MAX_TERMS:
        return None
    return sp.factor_terms(found) if found.is_Add else found


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
            return rates.get(e.args[0]) or without_rates(system, e)
        return e.func(*(plain(a) for a in e.args)) if e.args else e

    return plain(expression)


@lru_cache(maxsize=256)
def _expanded(expression: Expr) -> Expr:
    """Return a sum of monomials in sines, cosines and symbols, with as few squares of cosines.

    Raises `InputError` where it would be endless.
    """
    if spread(expression) > MAX_SPREAD:
        raise InputError("too long when it is multiplied out")
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


def _blamed(motions: Sequence[Motion], left: Expr, right: Expr) -> Leftover | None:
    """Return the term of the writer of which the residual is a multiple; those on the right go first."""
    found = []
    for place, (side, sign) in enumerate(((right, -1), (left, 1))):
        for term, counted in _terms(side):
            ratio = _ratio(motions, left - right, counted)
            if ratio is not None:
                factor = 1 - sign * ratio
                found.append((_rank(factor), place, factor, term))
    if not found or min(f[0] for f in found) > FAR:
        return None
    _, _, factor, term = min(found, key=lambda f: f[:2])
    words = _WORDS.get(factor, f"this should be {factor} times as large: {{}}")
    return Leftover(words, term)


def _terms(side: Expr) -> Iterator[tuple[Expr, Expr]]:
    """Yield the terms of a side, and what each adds to it; the rate of a sum has those of the sum."""
    summed = isinstance(side, rate)
    inner = side.args[0] if summed else side
    terms = [*sp.Add.make_args(inner)]
    if spread(inner) <= MAX_SPREAD:
        terms += sp.Add.make_args(sp.expand_mul(inner))
    for term in dict.fromkeys(terms):
        if not (summed and term == inner):
            yield term, rate(term) if summed else term


_WORDS = {Fraction(-1): "wrong sign: {}", Fraction(0): "does not belong here: {}"}


def _rank(factor: Fraction) -> int:
    """Return how far from plausible a slip is: a sign, then a small factor, a term too much, others."""
    size = abs(factor.numerator) + factor.denominator
    if factor == -1:
        return 0
    return size if factor > 0 else 5 if factor == 0 else 10 + size


def _ratio(motions: Sequence[Motion], residual: Expr, term: Expr) -> Fraction | None:
    """Return the small fraction by which a term makes the residual at all points."""
    found: set[Fraction | None] = set()
    for motion in motions:
        above, below = (motion.series(e).coefficients[0] for e in (residual, term))
        if not below:
            return None
        found.add(_small(above * RESIDUES.inverse(below)))
    return found.pop() if len(found) == 1 else None


def _small(value: int) -> Fraction | None:
    """Return the fraction that an element of the field is; it and its denominator at most `MAX_NUMBER`."""
    found = RESIDUES.fraction(value, MAX_NUMBER)
    return None if found is None or abs(found) > MAX_NUMBER else found
