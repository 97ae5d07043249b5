"""Whether an implication between propositions is proved: premise and opposite conclusion contradict.

Equations that are said to hold must give one that is said to fail, by sums of multiples
(`consequences.follows`); nothing else counts as a proof.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from eom.checker.assume.context import EQUATIONS
from eom.checker.judge.consequences import follows
from eom.checker.mean.claims import Claim
from eom.checker.mean.values import ANY, Value
from eom.checker.prose_claims.propositions import ZERO, All, Literal, Proposition, alternatives
from eom.errors import InputError
from eom.terms.terms import Term, der, dot, zero
from eom.terms.vocabulary import omega, position, quantity
from eom.worlds.worlds import ASSUMPTIONS, closure

BASES: tuple[tuple[str, ...], ...] = (
    (),
    ("body_frame",),
    ("newton_2", "third_law_strong"),
    ("body_frame", "newton_2", "third_law_strong"),
    ("body_frame", "newton_2", "third_law_strong", "about_centre"),
    ("body_frame", "newton_2", "third_law_strong", "O_fixed_in_space"),
)
"""Assumptions under which a proof is looked for, the fewest first."""


def proved_under(
    premise: Proposition, conclusion: Proposition, given: tuple[str, ...]
) -> tuple[str, ...] | None:
    """Return what an implication needs besides where it is proved: assumptions and readings; or None.

    What cannot be proved where much is assumed is not tried with less. A conclusion that needs no premise
    about a certain point is not proved by it.
    """
    if all(_assuming(premise, conclusion, given, base) is None for base in BASES[-2:]):
        return None
    for base in BASES:
        found = _assuming(premise, conclusion, given, base)
        idle = base in BASES[-2:] and _assuming(All(()), conclusion, given, base) is not None
        if found is not None and not idle:
            return found
    return None


def _assuming(
    premise: Proposition, conclusion: Proposition, given: tuple[str, ...], base: tuple[str, ...]
) -> tuple[str, ...] | None:
    """Return what a proof under some assumptions needs: those beyond what is given, and readings."""
    try:
        assumed = closure([*given, *base])
        needed = closure(base) - closure(given)
    except InputError:
        return None
    words = _under(premise, conclusion, assumed)
    spare = {m for n in needed for m in closure((n,)) - {n}}
    return None if words is None else (*(n for n in ASSUMPTIONS if n in needed - spare), *words)


def _under(
    premise: Proposition, conclusion: Proposition, assumed: frozenset[str]
) -> tuple[str, ...] | None:
    """Return the readings in which premise and opposite conclusion contradict each other, or None."""
    words: dict[str, None] = {}
    for held in alternatives(premise, True):
        for denied in alternatives(conclusion, False):
            ways = sorted(((*p, *q) for p in held for q in denied), key=_told)
            chosen = next((w for w in ways if _contradictory(w, assumed)), None)
            if chosen is None:
                return None
            words.update(dict.fromkeys(x.words for x in chosen if x.words))
    return tuple(words)


def _told(literals: Sequence[Literal]) -> int:
    """Return how many literals have to be read in a way of their own."""
    return sum(bool(x.words) for x in literals)


def _contradictory(literals: Sequence[Literal], assumed: frozenset[str]) -> bool:
    """Tell whether the equations that are said to hold give one that is said to fail."""
    held = [x for x in literals if x.positive]
    assumed = _drawn(held, assumed)
    premises = [
        _equation(term, x.scalars)
        for x in held
        for t in x.row
        if t.relation == ZERO
        for term in _forms(t.term)
    ]
    for x in literals:
        if not x.positive and all(t.relation == ZERO for t in x.row):
            goals = [[_equation(f, x.scalars) for f in _forms(t.term)] for t in x.row]
            if all(any(follows(g, premises, assumed) for g in forms) for forms in goals):
                return True
    return False


def _drawn(held: Sequence[Literal], assumed: frozenset[str]) -> frozenset[str]:
    """Return what is assumed, with what literals say in the words of worlds and that needs no more."""
    for x in held:
        said = {_unsigned(t.term) for t in x.row if t.relation == ZERO}
        for name, terms in EQUATIONS.items():
            if said == set(map(_unsigned, terms)):
                try:
                    wider = closure([*assumed, name])
                except InputError:
                    continue
                assumed = wider if wider - assumed == {name} else assumed
    return assumed


def _unsigned(term: Term) -> Term:
    """Return the vector from one point to another as that between them in order of names."""
    between = term.head == "atom" and term.data[0] == "position"
    return position(*sorted(map(str, term.data[1:]))) if between else term


def _forms(term: Term) -> tuple[Term, ...]:
    """Return a term, and what is zero exactly when it is: a body has an inverse inertia."""
    if term in {der(omega()), der(omega(), "B")}:
        return (term, dot(quantity("inertia", "C"), term))
    return (term,)


def _equation(term: Term, scalars: Mapping[Any, Term]) -> Claim:
    """Return the claim that a term is zero; its dimension is open."""
    values = (Value(term, term.kind, None, ANY), Value(zero(term.kind), term.kind, None, ANY))
    return Claim(values, ("=",), scalars=scalars)
