"""The verdicts on a note in the light of all that it says: context, remarks, slips carried forward.

Claims under conditions that are formulas: "A if B", judged where B holds.

A condition that gives a free quantity, or ties a free vector to others, is put into the claim, which is
then judged in worlds like any other. Else the claim has to follow from its conditions, or a special
motion that fulfils them refutes it; nothing is decided where neither is found.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from eom.checker.judge.coordinates import on_solutions
from eom.checker.judge.judge import (
    HOLDS,
    LOOSE,
    UNDECIDED,
    UNDER,
    WRONG,
    Judgement,
    judge,
    loosely,
    row_of,
)
from eom.checker.judge.laws import exchanged, slipped
from eom.checker.judge.models import equations
from eom.checker.judge.notes import Understood
from eom.checker.judge.special import Name, at_conditions, excused, in_letters, named, says, zeros
from eom.checker.judge.systems import Solutions
from eom.checker.judge.verdicts import ORDER, UNMET, Judged, Verdict, meant, verdict
from eom.checker.judge.worlds import Worlds
from eom.checker.mean.claims import EQUALITIES, Claim
from eom.checker.mean.lexicon import Lexicon
from eom.checker.note.carrying import (
    SPECIAL_MOTION,
    Carried,
    by_laws,
    carried,
    rested,
    resting,
)
from eom.checker.note.remarks import ranked, remark, remarks
from eom.checker.prose_claims.assumptions import (
    ANY_MOTION,
    APPROXIMATE,
    PARAGRAPH,
    Context,
    Place,
    Said,
    Stated,
    amounts,
    assumed,
    implied,
    of_systems,
    spoken,
)
from eom.checker.prose_claims.propositions import Plain, Reading, Test, truth
from eom.checker.read.documents import Document
from eom.checker.report.findings import CARRIED, CARRIED_AND_OWN, Remark
from eom.errors import InputError
from eom.fields import Singular
from eom.terms.terms import VECTOR, Term, add, cross, dot, nodes
from eom.terms.terms import replace as rewritten
from eom.terms.vocabulary import unit
from eom.worlds.special import specials

BOUNDS = frozenset({"<", ">", "<=", ">=", "!="})
"""Relations that leave open sets of motions, in which an equation fails that fails at all."""


@dataclass(frozen=True)
class Reviewed:
    """A formula with its verdict in the note.

    Sets of assumptions of each claim are in order: first those of which the note has stated most.
    ``carried``: line of the slip that it carries forward, 0 for none; ``stated``: assumptions that the
    note has stated there.
    """

    understood: Understood
    verdict: Verdict
    remarks: tuple[Remark, ...] = ()
    carried: int = 0
    stated: frozenset[str] = frozenset()


def review(
    document: Document,
    understood: Sequence[Understood],
    given: Iterable[str] = (),
    verdicts: Sequence[Verdict] | None = None,
) -> tuple[Reviewed, ...]:
    """Return every formula of a note as it stands in the note; ``verdicts``: if they are known already.

    A verdict differs from that on the formula alone where a claim rests on what the note assumes by a
    formula: then it holds under that; and where a wrong claim stands beside words of an approximation:
    then it may hold nearly, or is undecided.
    """
    given = tuple(given)
    first = verdicts if verdicts is not None else [verdict(u, given) for u in understood]
    alone = [
        replace(v, claims=()) if _is_apart(u) else v for u, v in zip(understood, first, strict=True)
    ]
    worldly = [replace(u, claims=()) if _is_apart(u) else u for u in understood]
    context = assumed(document, worldly, alone)
    loose, free = (spoken(document.pieces, table) for table in (APPROXIMATE, ANY_MOTION))
    names = _named(understood)
    placed = [
        _Placed(
            k, context, loose, free, (*given, *u.lexicon.assume), names[u.headings], u.lexicon
        ).verdict(v)
        for k, (u, v) in enumerate(zip(understood, alone, strict=True))
    ]
    settled = [v for v, _ in placed]
    lines = [u.formula.piece.line for u in understood]
    valued = of_systems(document, understood, first)
    there = [_at_values(v, valued, p) for v, p in zip(first, context.places, strict=True)]
    about = remarks(settled, lines, context, given)
    final = [
        _apart(understood[: k + 1], there[k], names[u.headings], context.places[k], (loose, free))
        if _is_apart(u)
        else settled[k]
        for k, u in enumerate(understood)
    ]
    slips = carried(final, context, given)
    return tuple(
        _reviewed(u, final[k], (own, about[k]), slips.get(k), lines, context.names(k))
        for k, (u, (_, own)) in enumerate(zip(understood, placed, strict=True))
    )


def _named(understood: Sequence[Understood]) -> Mapping[tuple[str, ...], frozenset[Name]]:
    """Return what the formulas under each heading name."""
    sections = {u.headings: [v for v in understood if v.headings == u.headings] for u in understood}
    return {
        h: named(c for u in us for c in u.claims) | zeros(u.formula for u in us)
        for h, us in sections.items()
    }


def _reviewed(
    one: Understood,
    final: Verdict,
    beside: tuple[tuple[Remark, ...], tuple[Remark, ...]],
    slip: Carried | None,
    lines: Sequence[int],
    names: frozenset[str],
) -> Reviewed:
    """Return a formula with its verdict and the remarks on its place and on what it carries."""
    own, about = beside
    line = lines[slip.number] if slip is not None else 0
    return Reviewed(one, final, (*own, *_carrying(slip, lines), *about), line, names)


def _carrying(slip: Carried | None, lines: Sequence[int]) -> tuple[Remark, ...]:
    """Return the remark on a slip that is carried forward."""
    kind = CARRIED_AND_OWN if slip is not None and slip.adds else CARRIED
    return () if slip is None else (remark(kind, lines[slip.number]),)


def _is_apart(understood: Understood) -> bool:
    """Whether a formula is judged by itself: it has claims that no world has the values of."""
    return any(row_of(c) is not Worlds for c in understood.claims)


def _apart(
    understood: Sequence[Understood],
    found: Verdict,
    names: frozenset[Name],
    place: Place,
    said: tuple[Sequence[Said], Sequence[Said]],
) -> Verdict:
    """Return the verdict on the last of some formulas, which is about a system, in its place."""
    loose, free = said
    alone = _small(found) if _near(loose, place) else found
    return _of_system(understood[:-1], understood[-1], alone, names, _near(free, place))


def _of_system(
    before: Sequence[Understood],
    one: Understood,
    found: Verdict,
    names: frozenset[Name],
    anyhow: bool,
) -> Verdict:
    """Return the verdict on a formula about a system without what parameters excuse that coincide."""
    earlier = (u for u in before if one.headings[: len(u.headings)] == u.headings)
    stated = frozenset().union(*(says(c) for u in earlier for c in u.claims))
    claims = tuple(
        j
        if j.verdict != UNDER or says(j.claim)
        else _in_general(j, names, stated, one.lexicon, anyhow)
        for j in found.claims
    )
    return _gravest(claims) if claims != found.claims else found


def _in_general(
    judged: Judged,
    names: frozenset[Name],
    stated: frozenset[str],
    lexicon: Lexicon,
    anyhow: bool,
) -> Judged:
    """Return a claim as wrong in general where only a special case excuses it that is not stated."""
    unsaid = excused(judged.judgement, judged.claim, names, stated, anyhow)
    if not unsaid:
        return judged
    case = " and ".join(in_letters(n, judged.claim, lexicon) for n in unsaid)
    plain = case.replace("$", "")
    why = f"it is wrong in general: it holds only if {plain}, which the note does not state"
    found = replace(judged.judgement, verdict=WRONG, sets=(), reason=why, special=case)
    return _replaced(judged, found)


def _at_values(found: Verdict, stated: Iterable[Stated], place: Place) -> Verdict:
    """Return the verdict on a formula about a system where conditions near it give quantities values."""
    conditions = [c for s in stated if s.holds_at(place) for c in s.premises]
    claims = tuple(_at_value(j, conditions) for j in found.claims) if conditions else found.claims
    return _gravest(claims) if claims != found.claims else found


def _at_value(judged: Judged, conditions: Sequence[Claim]) -> Judged:
    claim, unmet = judged.claim, judged.reason == UNMET
    plain = not claim.role and not claim.findings and row_of(claim) is Solutions
    if not plain or not (unmet or judged.verdict in {WRONG, UNDER}):
        return judged
    holds = None
    with suppress(Singular, InputError):
        holds = at_conditions(claim, conditions)
    if holds is None or not (holds or unmet):
        return judged
    why = "where its conditions hold" if holds else "it fails where its conditions hold"
    return _replaced(judged, Judgement(HOLDS if holds else WRONG, reason=why))


def _near(found: Iterable[Said], place: Place) -> bool:
    """Return whether something that is said holds in a place."""
    return bool(_said_near(found, place))


def _said_near(found: Iterable[Said], place: Place) -> list[Said]:
    return [s for s in found if s.start <= place and place[0] < s.stop]


def _small(found: Verdict) -> Verdict:
    """Return the verdict on a formula about a system where words say that something is small."""
    wrong = [j for j in found.claims if j.verdict == WRONG and on_solutions(j.claim)]
    better = {id(j): loosely(j.claim) for j in wrong}
    claims = tuple(
        _replaced(j, better[id(j)])
        if id(j) in better and (better[id(j)].verdict != UNDECIDED or better[id(j)].reason == LOOSE)
        else j
        for j in found.claims
    )
    return _gravest(claims) if claims != found.claims else found


def _gravest(claims: tuple[Judged, ...]) -> Verdict:
    """Return the verdict on a formula from what was found of its claims."""
    reasons = {j.verdict: j.reason for j in reversed(claims)}
    gravest = next(v for v in ORDER if v in reasons)
    return Verdict(gravest, reasons[gravest], claims)


SPECIAL_BODIES = frozenset({"thin_rod", "spin_312", "rotors", "viscous_slug"})
"""Assumptions that are not tried unless the note states them."""

_Other = tuple[Judgement, str, int]
"""What a claim is judged to be in its place; why that is another verdict: kind of remark, line."""


@dataclass(frozen=True)
class _Placed:
    """A formula in its place: its number, what the note assumes, what is said of approximations.

    ``free``: what is said of any motion; ``named``: what its section names (`eom.checker.judge.special`).
    """

    number: int
    context: Context
    loose: Sequence[Said]
    free: Sequence[Said]
    given: tuple[str, ...]
    named: frozenset[Name]
    lexicon: Lexicon

    def verdict(self, alone: Verdict) -> tuple[Verdict, tuple[Remark, ...]]:
        """Return the verdict on the formula in its place, and why it differs."""
        found = [(j, self._other(j)) for j in alone.claims]
        claims = tuple(
            self._ranked(self._general(j) if o is None else _replaced(j, o[0])) for j, o in found
        )
        differs = (remark(o[1], o[2]) for _, o in found if o is not None)
        why = tuple(dict.fromkeys(differs))
        if not why and all(
            a.verdict == b.verdict for a, b in zip(claims, alone.claims, strict=True)
        ):
            return replace(alone, claims=claims), ()
        return _gravest(claims), why

    def _general(self, judged: Judged) -> Judged:
        """Return a claim as wrong in general where a coincidence excuses it, unless it says so itself."""
        if judged.verdict != UNDER:
            return judged
        stated = self.names | implied(self.given)
        found = _in_general(judged, self.named, stated, self.lexicon, self.anyhow)
        return judged if found is judged or amounts(judged) else found

    @property
    def anyhow(self) -> bool:
        """Whether the note speaks of any motion here."""
        return _near(self.free, self.context.places[self.number])

    @property
    def names(self) -> frozenset[str]:
        """What the note has stated here."""
        return self.context.names(self.number)

    @property
    def premises(self) -> tuple[Stated, ...]:
        """What the note assumes by formulas."""
        return self.context.premises(self.number)

    def _ranked(self, judged: Judged) -> Judged:
        sets = ranked(judged.judgement.sets, self.names)
        return replace(judged, judgement=replace(judged.judgement, sets=sets))

    def _other(self, judged: Judged) -> _Other | None:
        """Return what else is found of a claim in its place, None where nothing is."""
        unmet = judged.reason == UNMET and judged.verdict == UNDECIDED
        if not (unmet or judged.verdict in {WRONG, UNDER}) or judged.claim.verdict:
            return None
        rules = (self._conditioned, self._rested, self._special, self._lawful, self._approximate)
        tried = (self._rested,) if judged.verdict == UNDER else rules
        return next(filter(None, (rule(judged) for rule in tried)), None)

    def _conditioned(self, judged: Judged) -> _Other | None:
        """Judge a claim that fails by itself where its conditions hold.

        Those of its line and its paragraph count. What is no equation makes no equation true.
        """
        place = self.context.places[self.number]
        near = (s for s in self.premises if s.scope == PARAGRAPH or s.start[0] == place[0])
        premises = [(s, p) for s in near for p in s.premises if not BOUNDS & set(p.relations)]
        if not premises:
            return None
        found = conditioned(judged.claim, [p for _, p in premises], self.names, self.given)
        if found.verdict == judged.verdict == WRONG:
            return None
        return found, "rests on" if under(found) else "condition", max(s.line for s, _ in premises)

    def _rested(self, judged: Judged) -> _Other | None:
        """Judge a claim that rests on what the note assumes by a formula, if it needs less then."""
        known = self.names | implied(self.given)
        best = [len(implied(s) - known) for s in ranked(judged.judgement.sets, known)[:1]]
        if judged.verdict == UNDER and 0 in best:
            return None
        try:
            found = resting(judged, self._formulas, self.names, self.given)
        except InputError:
            return None
        if found is None or (best and len(implied(found.sets[0]) - known) >= best[0]):
            return None
        sets = (*found.sets, *judged.judgement.sets) if any(found.sets) else ()
        return replace(found, sets=sets), "rests on", self._line

    @property
    def _formulas(self) -> list[Claim]:
        return [p for s in self.premises for p in s.premises]

    @property
    def _line(self) -> int:
        return max(s.line for s in self.premises)

    def _special(self, judged: Judged) -> _Other | None:
        """Judge a claim that holds for the special body that the note speaks of."""
        stated = [s for s in self.context.at(self.number) if SPECIAL_BODIES & set(s.names)]
        names = tuple(n for s in stated for n in s.names if n in SPECIAL_BODIES)
        given = (*self.given, *names)
        found = judge(judged.claim, given) if names else judged.judgement
        found = meant(found, judged.claim, self.lexicon, given)
        plain = [s for s in found.sets if not SPECIAL_MOTION & set(s) - {*names}]
        if not names or (found.verdict != HOLDS and not plain):
            return None
        sets = tuple((*names, *some) for some in plain or ((),))
        found = replace(found, verdict=UNDER, sets=sets, reason="")
        return found, "rests on", max(s.line for s in stated)

    def _lawful(self, judged: Judged) -> _Other | None:
        """Judge a claim by laws of the writer's own."""
        found = by_laws(judged, self._formulas, self.names, self.given)
        if found is None:
            return None
        if found.verdict == UNDER:
            return found, "rests on", self._line
        why = "it may follow from the laws that the note assumes"
        return replace(found, reason=why), "open by laws", self._line

    def _approximate(self, judged: Judged) -> _Other | None:
        """Leave a claim beside words of an approximation open, unless another factor makes it true."""
        near = _said_near(self.loose, self.context.places[self.number])
        found = loosely(judged.claim) if near else judged.judgement
        if found.verdict == UNDER and near:
            return found, "approximate", near[-1].line
        if not near or slipped(judged.claim, self.given):
            return None
        found = replace(judged.judgement, verdict=UNDECIDED, reason=LOOSE)
        return found, "approximate", near[-1].line


def _replaced(judged: Judged, found: Judgement) -> Judged:
    return replace(judged, judgement=found, verdict=found.verdict, reason=found.reason, chain=None)


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
        claim = exchanged(claim, old, new)
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
    """Return whether a claim holds where its conditions do."""
    return found.verdict in {HOLDS, UNDER}
