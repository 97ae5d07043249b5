"""Claims under conditions that are formulas: "A if B", judged where B holds.

A condition that gives a free quantity, or ties a free vector to others, is put into the claim, which is
then judged in worlds like any other. Else the claim has to follow from its conditions, or a special
motion that fulfils them refutes it; nothing is decided where neither is found.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER, WRONG, Judgement, equations, judge
from eom.checker.mean.claims import EQUALITIES, Claim
from eom.checker.note.carrying import rested
from eom.checker.prose_claims.propositions import Plain, Reading, Test, truth
from eom.errors import InputError
from eom.terms.terms import VECTOR, Term, add, cross, dot, nodes
from eom.terms.terms import replace as rewritten
from eom.terms.vocabulary import unit
from eom.worlds.special import specials

FREE = frozenset({"vector", "scalar"})
"""Quantities that nothing restricts."""
OPEN = "no motion is known here that fulfils its conditions and refutes it"


def conditioned(
    claim: Claim, conditions: Sequence[Claim], names: Iterable[str], given: Iterable[str] = ()
) -> Judgement:
    """Return the judgement on a claim that fails without its conditions; ``names``: what is assumed.

    The sets are what has to be assumed besides the conditions.
    """
    given, names = tuple(given), frozenset(names)
    try:
        tied = _tied(claim, conditions)
        if tied is not None:
            return judge(tied, given)
        found = rested(claim, conditions, names, given)
        if found is not None:
            return replace(found, sets=tuple(s for s in found.sets if s))
        return _in_motions(claim, conditions, names | set(given))
    except InputError as error:
        return Judgement(UNDECIDED, reason=error.what)


# -- conditions that are put in ---------------------------------------------------------------------

Rule = Callable[[Term, Term, Term], "tuple[Term, Term] | None"]


def _tied(claim: Claim, conditions: Sequence[Claim]) -> Claim | None:
    """Return a claim with all conditions put in, None where one of them cannot be."""
    waiting = [(c.scalars, q.left, q.right) for c in conditions for q in _equalities(c)]
    while waiting:
        scalars, left, right = waiting.pop(0)
        found = _by_number(scalars, left, right)
        found = found or _by_vector(_meant(scalars, left), _meant(scalars, right))
        if found is None:
            return None
        old, new = found
        claim = _put(claim, old, new)
        waiting = [(s, _swap(a, old, new), _swap(b, old, new)) for s, a, b in waiting]
    return claim


def _meant(scalars: Mapping[Any, Term], term: Term) -> Term:
    """Return what a symbol alone stands for."""
    return scalars.get(term.data[0], term) if term.head == "expr" else term


def _equalities(claim: Claim) -> Iterator[Any]:
    """Yield the equations of a condition. Raises `InputError` for other claims."""
    plain = claim.model is None and claim.parameters is None and not claim.findings
    if not plain or not EQUALITIES.issuperset(claim.relations):
        raise InputError("a condition that is no equation")
    yield from equations(claim)


def _put(claim: Claim, old: Term, new: Term) -> Claim:
    members = tuple(replace(m, term=_swap(m.term, old, new)) for m in claim.members)
    scalars = {s: _swap(t, old, new) for s, t in claim.scalars.items()}
    return replace(claim, members=members, scalars=scalars)


def _swap(term: Term, old: Term, new: Term) -> Term:
    return rewritten(term, lambda node: new if node == old else node)


def _is_free(term: Term) -> bool:
    return term.head == "atom" and term.data[0] in FREE


def _by_number(scalars: Mapping[Any, Term], left: Term, right: Term) -> tuple[Term, Term] | None:
    """Return a free scalar and what an equation between scalars that are constant makes of it."""
    if left.head != "expr" or right.head not in {"expr", "zero"}:
        return None
    value = left.data[0] - (right.data[0] if right.head == "expr" else 0)
    symbols = sorted(value.free_symbols, key=str)
    if not all(_is_free(scalars[s]) for s in symbols if s in scalars):
        return None
    for s in symbols:
        rate = sp.diff(value, s)
        if s in scalars and rate != 0 and s not in rate.free_symbols:
            rest = sp.cancel((rate * s - value) / rate)
            named = {t: Term("expr", (), (t,)) for t in rest.free_symbols}
            if all(t in scalars for t in named):
                return scalars[s], Term("expr", (), (rest,))
    return None


def _by_vector(left: Term, right: Term) -> tuple[Term, Term] | None:
    """Return a free vector and what an equation makes of it."""
    for a, b in ((left, right), (right, left)):
        if _is_free(a) and a.kind == VECTOR and a not in set(nodes(b)):
            return a, b
    if right.is_zero:
        return _across(left) or _along(left)
    return _sized(left, right)


def _pair(term: Term, head: str) -> tuple[Term, Term] | None:
    """Return a free factor of a product of two vectors, and the other factor."""
    if term.head != head or len(term.args) != 2:
        return None
    for a, b in (term.args, term.args[::-1]):
        if _is_free(a) and a.kind == b.kind == VECTOR and a not in set(nodes(b)):
            return a, b
    return None


def _across(term: Term) -> tuple[Term, Term] | None:
    found = _pair(term, "dot")
    return None if found is None else (found[0], cross(found[1], found[0]))


def _along(term: Term) -> tuple[Term, Term] | None:
    found = _pair(term, "cross")
    return None if found is None else (found[0], dot(found[0], found[1]) * found[1])


def _sized(left: Term, right: Term) -> tuple[Term, Term] | None:
    """Return a free vector of unit length as an axis of a frame that turns in any way."""
    one = right.head == "expr" and right.data[0] == 1
    same = left.head == "dot" and left.args[0] == left.args[1] and _is_free(left.args[0])
    return (left.args[0], unit("A", 1)) if one and same else None


# -- conditions that special motions fulfil ------------------------------------------------------------


def _plain(claim: Claim) -> Plain:
    tests = tuple(Test(add(q.left, -q.right)) for q in _equalities(claim))
    return Plain("", (Reading((tests,)),), claim.scalars)


def _in_motions(claim: Claim, conditions: Sequence[Claim], names: frozenset[str]) -> Judgement:
    """Return that a claim is wrong where motions that fulfil its conditions refute it.

    To each motion in which it holds there has to be one that refutes it and of which no less is assumed.
    """
    said, held = _plain(claim), [_plain(c) for c in conditions]
    holding, failing = set[frozenset[str]](), set[frozenset[str]]()
    for special in specials():
        if names <= special.assumed and all(truth(h, special.world) is True for h in held):
            fails = truth(said, special.world) is False
            (failing if fails else holding).add(special.assumed)
    if not failing:
        return Judgement(UNDECIDED, reason=OPEN)
    if any(not any(h <= f for f in failing) for h in holding):
        return Judgement(
            UNDECIDED, reason="under its conditions it holds in some motions, not in others"
        )
    return Judgement(WRONG, reason="it fails in motions that fulfil its conditions")


def under(found: Judgement) -> bool:
    """Tell whether a claim holds where its conditions do."""
    return found.verdict in {HOLDS, UNDER}
