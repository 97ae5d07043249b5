"""Sets of assumptions that make a claim hold by chance: they are not what the writer means.

A slip in a term is no slip where the term vanishes: with the wrong sign before the Coriolis term an
acceleration is right for a particle at the origin. So a set of assumptions does not count under which
written terms vanish because a point is a special one or something rests, while others stay that are not
equal by themselves ("h = a + b = a" says that b vanishes, and counts). Nor does a set under which all
sides vanish, unless the line says that something is zero: then any factor may be lost. Nor one that
brings the model of another note with it, as the 3-1-2 angles do, of which the lexicon knows nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import islice

import sympy as sp

from eom.checker.judge.judge import UNDER, WRONG, Judgement, equations
from eom.checker.judge.systems import on_solutions
from eom.checker.mean.claims import EQUALITIES, Claim
from eom.checker.mean.lexicon import Lexicon
from eom.errors import InputError
from eom.exact.series import Series
from eom.fields import Singular
from eom.terms.terms import Equation, Term, add, expr, mul, zero
from eom.worlds.evaluate import Evaluator
from eom.worlds.generators import worlds
from eom.worlds.worlds import closure

WORLDS, TRIALS = 2, 8

MODELS: dict[str, str] = {
    "spin_312": "angle",
    "rotors": "rotor_",
    "viscous_slug": "slug_",
}
"""Models of a body, and how the quantities begin that a note has where it is about one."""


CHANCE = frozenset(
    "about_centre O_fixed_in_space O_at_origin C_at_rest OA_at_centre A_fixed_in_body torque_free "
    "thin_rod no_torque_2 no_torque_3".split()
)
"""Assumptions under which something is zero; the others say of what kind a body, a frame, a law is."""


def meant(found: Judgement, claim: Claim, lexicon: Lexicon, given: Iterable[str] = ()) -> Judgement:
    """Return a judgement without the sets under which the claim holds by chance; wrong without any."""
    equation = EQUALITIES.issuperset(claim.relations) and not on_solutions(claim)
    if found.verdict != UNDER or not found.sets or not equation:
        return found
    base = closure([*given, *found.context])
    strange = {m for m in MODELS if m not in base and not _named(lexicon, MODELS[m])}
    kept = tuple(
        s
        for s in found.sets
        if not strange & closure(s)
        and not any(_empties(claim, q, base, s) for q in equations(claim))
        and not _silences(claim, base, s)
    )
    if kept:
        return replace(found, sets=kept)
    return replace(found, verdict=WRONG, sets=())


def _named(lexicon: Lexicon, begins: str) -> bool:
    """Tell whether a lexicon has a quantity of a model."""
    layers = (*lexicon.layers, *(s.entries for s in lexicon.scopes))
    return any(e.meaning.quantity.startswith(begins) for layer in layers for e in layer)


def _empties(claim: Claim, equation: Equation, base: frozenset[str], names: Iterable[str]) -> bool:
    """Tell whether terms of an equation vanish under a set alone, and two or more others do not."""
    signed = [*_addends(equation.left), *(-t for t in _addends(equation.right))]
    if len(signed) < 3 or not CHANCE.intersection(names):
        return False
    try:
        before = _zeros(claim, signed, closure([*base, *(n for n in names if n not in CHANCE)]))
        after = _zeros(claim, signed, closure([*base, *names]))
        if after <= before or len(signed) - len(after) < 2:
            return False
        if _holds(claim, equation, base):
            return False
        kept = [t for k, t in enumerate(signed) if k not in after]
        return not _holds(claim, Equation(add(*kept), zero(equation.left.kind)), base)
    except InputError:
        return False


def _silences(claim: Claim, base: frozenset[str], names: Iterable[str]) -> bool:
    """Tell whether all sides of a claim vanish under a set alone, though it says so of none."""
    sides = [t for q in equations(claim) for t in (q.left, q.right)]
    if any(t.is_zero for t in sides):
        return False
    try:
        if len(_zeros(claim, sides, closure([*base, *names]))) < len(sides):
            return False
        return len(_zeros(claim, sides, base)) < len(sides)
    except InputError:
        return False


def _holds(claim: Claim, equation: Equation, names: frozenset[str]) -> bool:
    found = [
        Evaluator(world, claim.scalars).holds(equation)
        for world in islice(worlds(names, TRIALS), WORLDS)
    ]
    return all(found)


def _addends(term: Term) -> Iterator[Term]:
    """Yield the terms of a sum; factors before brackets go to each."""
    if term.head == "add":
        for a in term.args:
            yield from _addends(a)
    elif term.head == "mul" and term.args[-1].head == "add":
        yield from (mul(*term.args[:-1], a) for a in _addends(term.args[-1]))
    elif term.head == "expr":
        yield from (expr(a) for a in sp.Add.make_args(term.data[0]) if a != 0)
    elif not term.is_zero:
        yield term


def _zeros(claim: Claim, terms: list[Term], names: frozenset[str]) -> frozenset[int]:
    """Return the numbers of the terms that are zero in every world drawn. Raises `InputError`."""
    found = frozenset(range(len(terms)))
    for values in islice(_values(claim, terms, names), WORLDS):
        found &= {k for k, zero in enumerate(values) if zero}
    return found


def _values(claim: Claim, terms: list[Term], names: frozenset[str]) -> Iterator[list[bool]]:
    for world in worlds(names, TRIALS):
        evaluator = Evaluator(world, claim.scalars)
        try:
            yield [_is_zero(evaluator, term) for term in terms]
        except Singular:
            continue


def _is_zero(e: Evaluator, term: Term) -> bool:
    """Tell whether a term is zero for all free indices."""
    return all(_nought(e.value(term, env)) for env in e.numberings(e.labels(term)))


def _nought(value: object) -> bool:
    if isinstance(value, Series):
        return bool(value.is_zero)
    assert isinstance(value, tuple)
    return all(_nought(part) for part in value)
