"""Propositions about a motion, true, false or open in an exact world.

What words leave open is kept as readings: a proposition is true where every reading holds for all
time, false where every reading fails at t = 0 (and so for a while), and open elsewhere. Nothing follows
from what is open.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from eom import limits
from eom.errors import InputError
from eom.exact.series import Series
from eom.fields import Singular
from eom.terms.terms import Term
from eom.worlds.evaluate import Evaluator
from eom.worlds.worlds import World

Truth = bool | None
"""None: open."""

ZERO, POSITIVE, NOT_NEGATIVE, NOT_ZERO = "= 0", "> 0", ">= 0", "!= 0"
OPPOSITE = {">": "<", "<": ">"}


@dataclass(frozen=True)
class Test:
    """What is said of a term: a relation to zero."""

    term: Term
    relation: str = ZERO

    def __iter__(self) -> Iterator[Any]:
        yield from (self.term, self.relation)


Row = tuple[Test, ...]
"""Tests that hold together."""


@dataclass(frozen=True)
class Reading:
    """One of these rows holds; ``words``: what is meant, "" for what everybody means."""

    rows: tuple[Row, ...]
    words: str = ""


@dataclass(frozen=True)
class Plain:
    """A proposition by its readings; ``scalars``: what the symbols of SymPy stand for."""

    text: str
    readings: tuple[Reading, ...]
    scalars: Mapping[Any, Term] = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class Not:
    """The opposite of a proposition."""

    part: Proposition


@dataclass(frozen=True)
class All:
    """Propositions that hold together."""

    parts: tuple[Proposition, ...]


@dataclass(frozen=True)
class AnyOf:
    """Propositions one of which holds at least."""

    parts: tuple[Proposition, ...]


Proposition = Plain | Not | All | AnyOf


def equal(text: str, *terms: Term, words: str = "") -> Plain:
    """Return the proposition that some terms are zero."""
    return Plain(text, (Reading((tuple(map(Test, terms)),), words),))


def text(one: Proposition) -> str:
    """Return a proposition in words."""
    match one:
        case Plain():
            return one.text
        case Not():
            return f"not: {text(one.part)}"
        case All():
            return " and ".join(map(text, one.parts))
        case AnyOf():
            return " or ".join(map(text, one.parts))


def plains(one: Proposition) -> Iterator[Plain]:
    """Yield the propositions that a proposition is made of."""
    if isinstance(one, Plain):
        yield one
    elif isinstance(one, Not):
        yield from plains(one.part)
    else:
        for part in one.parts:
            yield from plains(part)


# -- in worlds ------------------------------------------------------------------------------------


def truth(one: Proposition, world: World) -> Truth:
    """Return whether a proposition is true in a rational world; open where it has no value."""
    match one:
        case Plain():
            return _plain(one, world)
        case Not():
            found = truth(one.part, world)
            return None if found is None else not found
        case All():
            return _least(truth(p, world) for p in one.parts)
        case AnyOf():
            found = _least(_turned(truth(p, world)) for p in one.parts)
            return _turned(found)


def _turned(found: Truth) -> Truth:
    return None if found is None else not found


def _least(found: Iterable[Truth]) -> Truth:
    """Return the truth of all together."""
    values = list(found)
    return False if False in values else None if None in values else True


def _plain(one: Plain, world: World) -> Truth:
    evaluator = Evaluator(world, one.scalars)
    try:
        readings = [_reading(r, evaluator) for r in one.readings]
    except (InputError, Singular):
        return None
    return readings[0] if len(set(readings)) == 1 else None


def _reading(one: Reading, e: Evaluator) -> Truth:
    rows = [_least(_test(t, e) for t in row) for row in one.rows]
    return True if True in rows else None if None in rows else False


def _test(test: Test, e: Evaluator) -> Truth:
    """Return True where a test holds for all time, False where it fails at t = 0."""
    limits.check()
    relation = test.relation
    found = [s for env in e.numberings(e.labels(test.term)) for s in _flat(e.value(test.term, env))]
    start = [s.coefficients[0] for s in found]
    if relation == ZERO:
        return False if any(start) else True if all(s.is_zero for s in found) else None
    if relation == NOT_ZERO:
        return True if any(start) else False if all(s.is_zero for s in found) else None
    if relation == POSITIVE:
        return True if min(start) > 0 else False if _settled(found) else None
    return False if min(start) < 0 else True if min(start) > 0 or _settled(found) else None


def _settled(found: list[Series]) -> bool:
    """Return whether what is zero at t = 0 stays so; what is below zero is."""
    return all(s.coefficients[0] or s.is_zero for s in found)


def _flat(value: Any) -> Iterator[Series]:
    if isinstance(value, Series):
        yield value
    else:
        for part in value:
            yield from _flat(part)


# -- by form --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Literal:
    """Tests that all hold, or the opposite of that; ``words``: the reading."""

    row: Row
    positive: bool
    words: str
    scalars: Mapping[Any, Term]


def cases(one: Proposition, positive: bool = True) -> Iterator[tuple[Literal, ...]]:
    """Yield ways to read a proposition as literals that hold together, one way a case and reading.

    Cases of one "or" come one after the other; see `alternatives`.
    """
    for alternative in alternatives(one, positive):
        yield from alternative


def alternatives(one: Proposition, positive: bool = True) -> list[list[tuple[Literal, ...]]]:
    """Return the cases of a proposition, and to each the ways to read it as literals."""
    match one:
        case Not():
            return alternatives(one.part, not positive)
        case Plain():
            return [[(Literal(r, positive, w, one.scalars),) for r, w in _rows(one)]]
        case All() | AnyOf():
            parts = [alternatives(p, positive) for p in one.parts]
    if isinstance(one, All) == positive:
        found = []
        for chosen in product(*parts):
            readings = product(*chosen)
            found.append([tuple(x for part in r for x in part) for r in readings])
        return found
    return [case for part in parts for case in part]


def _rows(one: Plain) -> Iterator[tuple[Row, str]]:
    """Yield the rows of readings that have one row."""
    for reading in one.readings:
        if len(reading.rows) == 1:
            yield reading.rows[0], reading.words
