"""What a note has assumed where a formula stands: by words, and by formulas.

A formula that plays the part of an assumption, or from which an arrow leads on, is matched with the
assumptions of `eom.worlds.worlds`: the smallest set under which it holds is what it amounts to, if its own
equation follows back from it. What matches none is a premise that claims may rest on.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from eom.checker.assume.phrases import (
    MAX_BEFORE,
    NOTE,
    PARAGRAPH,
    Limits,
    Place,
    letters,
    said,
    scope_of,
    sentences,
)
from eom.checker.judge.consequences import follows
from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.judge.notes import Understood
from eom.checker.judge.verdicts import LAWS, Judged, Verdict
from eom.checker.mean.claims import CONSTANT, SAME_POINT, Claim
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.operations import overdot
from eom.checker.mean.roles import ASSUMPTION, RECALLED
from eom.checker.mean.values import ANY, Refusal, Value
from eom.checker.read.documents import Document, Piece
from eom.checker.read.places import Source
from eom.errors import InputError
from eom.terms.terms import Term, der, dot, zero
from eom.terms.vocabulary import omega, position, quantity, unit
from eom.worlds.worlds import closure


@dataclass(frozen=True)
class Stated:
    """An assumption that a note states.

    ``names``: rows of the table of assumptions that it amounts to, none where it matches none;
    ``text``: as it stands; ``start``: where it holds from; ``stop``: the number of the first piece
    where it holds no more; ``scope``: how far it reaches, in a word; ``premises``: what a formula says;
    ``pointed``: a condition, or said of something, not only mentioned.
    """

    names: tuple[str, ...]
    text: str
    source: Source
    start: Place
    stop: int
    scope: str = NOTE
    premises: tuple[Claim, ...] = ()
    pointed: bool = True

    @property
    def line(self) -> int:
        """Line of the assumption, from 1."""
        return self.source.line_column(self.start[1])[0]

    def holds_at(self, place: Place) -> bool:
        """Whether this has been stated where a place is, and still holds there."""
        return self.start <= place and place[0] < self.stop


@dataclass(frozen=True)
class Context:
    """What a note states, and where each of its formulas stands: place and source."""

    stated: tuple[Stated, ...]
    places: tuple[Place, ...]
    sources: tuple[Source, ...]

    def at(self, number: int) -> tuple[Stated, ...]:
        """Return what has been stated where a formula stands, in order; itself left out."""
        place = self.places[number]
        return tuple(s for s in self.stated if s.holds_at(place) and s.start != place)

    def later(self, number: int) -> tuple[Stated, ...]:
        """Return what is stated behind a formula."""
        return tuple(s for s in self.stated if s.start > self.places[number])

    def names(self, number: int) -> frozenset[str]:
        """Return the assumptions that have been stated where a formula stands, and what they need."""
        return implied(n for s in self.at(number) for n in s.names)

    def premises(self, number: int) -> tuple[Stated, ...]:
        """Return the formulas among what has been stated that match no assumption of the table."""
        return tuple(s for s in self.at(number) if s.premises and not s.names)


def implied(names: Iterable[str]) -> frozenset[str]:
    """Return assumptions with what each of them needs; they need not stand together."""
    return frozenset().union(*(_closed(n) for n in set(names)))


@cache
def _closed(name: str) -> frozenset[str]:
    return closure([name])


def assumed(
    document: Document, understood: Sequence[Understood], verdicts: Sequence[Verdict]
) -> Context:
    """Return what a note states; ``verdicts``: of all its formulas, in order."""
    limits = Limits(document.pieces)
    numbers = [k for k, p in enumerate(document.pieces) if p.is_formula]
    places = tuple((k, document.pieces[k].span.start) for k in numbers)
    leads = _leads(document.pieces)
    found = [
        Stated(s.names, s.text, s.source, s.start, s.stop, s.scope, (), s.pointed)
        for s in said(document.pieces)
    ]
    for place, one, verdict in zip(places, understood, verdicts, strict=True):
        found += _formulas(place, one, verdict, leads.get(place[0], ""), limits)
        found += _steady(document.pieces, place, one, leads.get(place[0], ""), limits)
    sources = tuple(document.pieces[k].source for k in numbers)
    return Context(tuple(sorted(found, key=lambda s: s.start)), places, sources)


def _leads(pieces: Sequence[Piece]) -> Mapping[int, str]:
    """Return the words of the sentence in front of every formula, by its number."""
    found: dict[int, str] = {}
    for sentence in sentences(pieces):
        for n, (k, _) in enumerate(sentence.places):
            if n and k != sentence.places[n - 1][0]:
                found[k] = sentence.text[max(0, n - MAX_BEFORE) : n]
        behind = sentence.places[-1][0] + 1
        if behind < len(pieces) and pieces[behind].kind == "display":
            found[behind] = sentence.text[-MAX_BEFORE:]
    return found


def _formulas(
    place: Place, one: Understood, verdict: Verdict, lead: str, limits: Limits
) -> Iterator[Stated]:
    """Yield what a formula states: conditions of its own hold for it alone."""
    piece = one.formula.piece
    arrow = [j.claim.joined == "implies" for j in verdict.claims[1:]]
    for k, judged in enumerate(verdict.claims):
        if not (_assumes(judged, one.role) or (any(arrow[k:]) and _antecedent(judged))):
            continue
        scope = scope_of(lead)
        scope = PARAGRAPH if scope == NOTE and judged.verdict != ASSUMPTION else scope
        stop = place[0] + 1 if judged.claim.role else limits.stop(place[0], scope)
        start = (place[0], piece.span.start - 1) if judged.claim.role else place
        names = amounts(judged)
        premises = (judged.claim,) if judged.judgement.verdict != HOLDS else ()
        text = letters(piece.body)
        yield Stated(names, text, piece.source, start, stop, scope, premises)


_STEADY = re.compile(r"\s*,?\s*(?:is|are|remains?|stays?|being|is held|is kept) constant\b")


def _steady(
    pieces: Sequence[Piece], place: Place, one: Understood, lead: str, limits: Limits
) -> Iterator[Stated]:
    """Yield what "when x is constant" states: that the rate of x is zero."""
    behind = pieces[place[0] + 1] if place[0] + 1 < len(pieces) else None
    reading, scope = one.formula.reading, scope_of(lead)
    said = behind is not None and behind.kind == "prose" and _STEADY.match(behind.body)
    if not said or scope == NOTE or reading is None or one.formula.relational:
        return
    e = elaborator(one.lexicon, dict(one.around.definitions))
    piece = one.formula.piece
    try:
        rate = overdot(one.lexicon.notation, e.value(reading.tree), 1, piece.span)
    except Refusal:
        return
    claim = Claim((rate,), (), CONSTANT, scalars=e.scalars, span=piece.span)
    text = f"{letters(piece.body)} is constant"
    yield Stated((), text, piece.source, place, limits.stop(place[0], scope), scope, (claim,))


def _assumes(judged: Judged, role: str) -> bool:
    """Whether a claim is assumed: by the words around it, or recalled with what it needs."""
    if judged.verdict == ASSUMPTION or judged.claim.kind == SAME_POINT:
        return True
    return role == RECALLED and judged.verdict == UNDER


def _antecedent(judged: Judged) -> bool:
    """Whether an arrow leads on from a claim that needs more than laws."""
    sets = judged.judgement.sets
    return judged.verdict == UNDER and not any(set(s) <= {n for w in LAWS for n in w} for s in sets)


# -- what a formula amounts to ------------------------------------------------------------------------


def amounts(judged: Judged) -> tuple[str, ...]:
    """Return the assumptions that a formula amounts to, of a smallest set under which it holds.

    Those follow back from it, in worlds where the others of the set hold; one that is known by no
    equation has to stand alone in its set.
    """
    for names in sorted(judged.judgement.sets, key=len):
        found = tuple(n for n in names if _back(judged.claim, n, [m for m in names if m != n]))
        if found:
            return found
    return ()


def _back(claim: Claim, name: str, others: Sequence[str]) -> bool:
    """Whether the equation of an assumption follows from a claim; one without equations does."""
    if name not in EQUATIONS:
        return not others and name not in MODELLED
    try:
        base = closure([*_BASES.get(name, ()), *others])
    except InputError:
        return False
    if name in base:
        return False
    return all(follows(_equation(t, claim), (claim,), base, _SIMPLE) for t in EQUATIONS[name])


_SIMPLE = 24
"""Multiples of a formula among which the equation of an assumption is looked for."""


def _equation(term: Term, claim: Claim) -> Claim:
    """Return the claim that a term is zero; its dimension is open."""
    values = (Value(term, term.kind, None, ANY), Value(zero(term.kind), term.kind, None, ANY))
    return Claim(values, ("=",), scalars=claim.scalars)


_I = quantity("inertia", "C")
_M = quantity("torque", "body", "C")


def _entry(a: int, b: int) -> Term:
    return dot(unit("B", a), dot(_I, unit("B", b)))


EQUATIONS: Mapping[str, tuple[Term, ...]] = {
    "about_centre": (position("C", "O"),),
    "OA_at_centre": (position("C", "OA"),),
    "O_at_origin": (position("O", "OI"),),
    "O_fixed_in_space": (der(position("O", "OI")),),
    "C_at_rest": (der(position("C", "OI")),),
    "principal_axes": (_entry(1, 2), _entry(1, 3), _entry(2, 3)),
    "symmetric": (_entry(1, 1) - _entry(2, 2),),
    "torque_free": (_M,),
    "no_torque_2": (dot(unit("B", 2), _M),),
    "no_torque_3": (dot(unit("B", 3), _M),),
    "A_fixed_in_body": (omega("A", "B"),),
}
"""What is zero by an assumption, where that is one equation."""
_BASES: Mapping[str, tuple[str, ...]] = {
    "OA_at_centre": ("rigid",),
    "torque_free": ("body_frame",),
    "symmetric": ("principal_axes",),
    "principal_axes": ("body_frame",),
    "no_torque_2": ("spin_312",),
    "no_torque_3": ("spin_312",),
    "A_fixed_in_body": ("body_frame",),
}
"""Worlds in which the equations have a meaning."""
MODELLED = frozenset({"spin_312", "rotors", "viscous_slug", "one_particle", "thin_rod"})
"""Models that no formula amounts to."""
