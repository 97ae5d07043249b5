"""What a formula has to do with the rest of the note: what it needs, repeats, or contradicts.

Every remark is a row of `KINDS`. What a note does not state is said once, where it is needed first.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from eom.checker.judge.consequences import parts
from eom.checker.judge.judge import HOLDS, UNDER, WRONG
from eom.checker.judge.models import terms_of
from eom.checker.judge.verdicts import LAWS, Judged, Verdict
from eom.checker.judge.worlds import MENTIONS, MODELS, SPECIAL, labels_in
from eom.checker.mean.claims import DEFINITION, EQUALITIES, STATEMENT, Claim
from eom.checker.mean.roles import ASSUMPTION
from eom.checker.prose_claims.assumptions import PARAGRAPH, Context, Stated, implied
from eom.checker.report.findings import CARRIED, CARRIED_AND_OWN, Remark
from eom.errors import InputError
from eom.fields import Singular
from eom.worlds.worlds import ASSUMPTIONS, closure

KINDS: dict[str, str] = {
    "stated later": "needs {what}, stated {distance} later",
    "stated elsewhere": "needs {what}, stated only later, in {distance}",
    "not stated": "needs {what}, which the note does not state",
    "not needed": "{what}, stated in line {line}, is not needed here",
    "rests on": "rests on the assumption of line {line}",
    "condition": "is judged under the condition of line {line}",
    "open by laws": "may follow from the assumption of line {line}, which no motion in general obeys",
    "contradicts": "contradicts line {line}",
    "contradicts assumption": "cannot stand together with the assumption of line {line}",
    "repeats": "repeats line {line}",
    CARRIED: "carries the slip of line {line} forward",
    CARRIED_AND_OWN: "carries the slip of line {line} forward, and has one of its own",
    "approximate": "does not hold exactly; line {line} speaks of an approximation",
}
"""Kinds of remarks, and their words."""

NOUNS: dict[str, str] = {
    "one_particle": "a single particle",
    "constant_mass": "constant masses",
    "newton_2": "Newton's second law",
    "third_law_weak": "Newton's third law",
    "third_law_strong": "the strong form of Newton's third law",
    "rigid": "a rigid body",
    "body_frame": "a frame fixed in the body",
    "about_centre": "the centre of mass as reference point",
    "O_fixed_in_body": "a reference point fixed in the body",
    "O_fixed_in_space": "a reference point fixed in space",
    "O_at_origin": "the origin as reference point",
    "C_at_rest": "a centre of mass at rest",
    "principal_axes": "principal axes",
    "principal_at_O": "principal axes at the reference point",
    "symmetric": "inertial symmetry (I1 = I2)",
    "symmetric_1": "inertial symmetry (I2 = I3)",
    "symmetric_2": "inertial symmetry (I3 = I1)",
    "torque_free": "no torque about the centre of mass",
    "unit_eigenvectors": "eigenvectors of unit length, right-handed",
    "A_fixed_in_body": "that frame A is fixed in the body",
    "OA_fixed_in_space": "the point OA fixed in space",
    "OB_fixed_in_space": "the point OB fixed in space",
    "OA_at_centre": "the centre of mass as the point OA",
    "thin_rod": "a thin rod",
    "plane_body": "a plane body",
    "O_uniform": "a reference point that moves uniformly",
    "fixed_axis": "an axis of rotation that is constant",
    "steady_turn": "a constant angular velocity",
    "first_turn": "that only the first angle of the turns changes",
    "one_rotor": "a single rotor",
    "steady_rotors": "constant speeds of the rotors",
    "spin_312": "the spinning symmetric body with angles 3-1-2",
    "no_torque_2": "no torque about b2",
    "no_torque_3": "no torque about b3",
    "viscous_slug": "a viscous slug",
    "rotors": "symmetric rotors",
    "exhaust_at_rest": "that the mass which is taken in or lost is at rest",
    "exhaust_with_body": "that the mass which is taken in or lost has the body's velocity",
}
"""Assumptions as nouns."""

POINTED = frozenset(NOUNS) - {
    *("newton_2", "constant_mass", "body_frame", "one_particle", "rotors"),
    *("spin_312", "viscous_slug", "A_fixed_in_body", "unit_eigenvectors"),
}
"""Assumptions of which it is worth saying that they are not needed."""


def noun(name: str) -> str:
    """Return an assumption as a noun."""
    return NOUNS.get(name, ASSUMPTIONS[name].meaning)


def ranked(sets: Iterable[tuple[str, ...]], names: frozenset[str]) -> tuple[tuple[str, ...], ...]:
    """Return sets of assumptions, those first of which the least is missing in ``names``.

    Models of special bodies come last, unless they are stated.
    """

    def order(chosen: tuple[str, ...]) -> tuple[Any, ...]:
        missing = implied(chosen) - names
        return (bool(missing & SPECIAL), len(missing), len(chosen), chosen)

    return tuple(sorted(sets, key=order))


def remark(kind: str, line: int = 0, what: str = "", distance: str = "") -> Remark:
    """Return a remark of a kind in its words."""
    return Remark(kind, KINDS[kind].format(what=what, line=line, distance=distance), line)


def remarks(
    verdicts: Sequence[Verdict], lines: Sequence[int], context: Context, given: Iterable[str] = ()
) -> tuple[tuple[Remark, ...], ...]:
    """Return the remarks on every formula; ``lines``: where the formulas stand, from 1."""
    given = tuple(given)
    named: set[str] = set()
    before = _Before(given, lines, context)
    found = []
    for number, verdict in enumerate(verdicts):
        known = context.names(number) | implied(given)
        new = [*_needs(verdict, number, lines[number], context, known, named)]
        new += _spare(verdict, verdicts, number, context)
        new += before.take(verdict, number)
        found.append(tuple(dict.fromkeys(new)))
    return tuple(found)


def _needs(
    verdict: Verdict,
    number: int,
    line: int,
    context: Context,
    known: frozenset[str],
    named: set[str],
) -> Iterator[Remark]:
    """Yield what is needed and has not been stated; ``named`` grows."""
    missing: dict[str, None] = {}
    for judged in verdict.claims:
        if judged.verdict == UNDER and judged.judgement.sets:
            best = ranked(judged.judgement.sets, known)[0]
            missing.update(dict.fromkeys(n for n in best if n not in known))
    new = [n for n in missing if n not in named]
    named.update(new)
    later = [(n, _first(n, number, context)) for n in new]
    for name, stated in later:
        if stated is not None and stated.source is context.sources[number]:
            yield remark("stated later", stated.line, noun(name), _lines(stated.line - line))
        elif stated is not None:
            where = stated.source.name or "another part"
            yield remark("stated elsewhere", stated.line, noun(name), where)
    absent = [noun(n) for n, stated in later if stated is None]
    if absent:
        yield remark("not stated", what=_listed(absent))


def _first(name: str, number: int, context: Context) -> Stated | None:
    """Return where an assumption is stated behind a formula."""
    later = (s for s in context.later(number) if s.scope != PARAGRAPH)
    return next((s for s in later if name in s.names or name in implied(s.names) - _LAWS), None)


_LAWS = frozenset(n for w in LAWS for n in w)
"""Assumptions that are stated only where they are named."""


def _lines(count: int) -> str:
    return "in the same line, but" if count <= 0 else f"{count} line{'s' * (count > 1)}"


def _listed(words: Sequence[str]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _spare(
    verdict: Verdict, verdicts: Sequence[Verdict], number: int, context: Context
) -> Iterator[Remark]:
    """Yield what was assumed for this formula and is not needed.

    For this formula: under a condition, or said of something right in front of it.
    """
    modelled = any(j.judgement.context in MODELS for j in verdict.claims)
    if verdict.verdict not in {HOLDS, UNDER} or not verdict.claims or modelled:
        return
    used = implied(n for j in verdict.claims for s in j.judgement.sets for n in s)
    about = frozenset().union(*(labels_in(terms_of(j.claim)) for j in verdict.claims))
    start = max((context.places[k] for k in range(number) if verdicts[k].claims), default=(0, 0))
    for s in context.at(number):
        near = s.start > start or (bool(s.premises) and s.start == start)
        for name in s.names:
            pointed = s.pointed and name in POINTED and MENTIONS.get(name, about) & about
            if near and pointed and not _matters(name, used):
                yield remark("not needed", s.line, noun(name))


def _matters(name: str, used: frozenset[str]) -> bool:
    """Whether an assumption, or one that says more, is among those used."""
    return name in used or bool(implied([name]) - {"constant_mass"} & used)


@dataclass
class _Before:
    """What earlier claims said, link by link, and the values of their members.

    ``links``: the formula that said each first; ``members``: to each the formula's number, and the
    number in the other member of an assumption.
    """

    given: tuple[str, ...]
    lines: Sequence[int]
    context: Context
    links: dict[Any, int] = field(default_factory=dict)
    members: dict[Any, tuple[int, Any]] = field(default_factory=dict)

    def take(self, verdict: Verdict, number: int) -> Iterator[Remark]:
        """Yield what claims repeat or contradict, and keep them."""
        plain = [j for j in verdict.claims if _plain(j)]
        links = [link for j in plain for link in _links(j.claim)]
        earlier = [self.links.get(link) for link in links]
        for link in links:
            self.links.setdefault(link, number)
        if links and None not in earlier:
            if verdict.verdict in {HOLDS, UNDER, WRONG}:
                yield remark("repeats", self.lines[max(n for n in earlier if n is not None)])
            return
        for judged in plain:
            yield from self._against(judged, number)

    def _against(self, judged: Judged, number: int) -> Iterator[Remark]:
        """Yield what a claim contradicts, and keep its members if it is not wrong."""
        members = _members(judged.claim, closure([*self.given, *judged.judgement.context]))
        value = _value(judged)
        known = (self.members.get(m, (number, None)) for m in members)
        earlier = [(n, v) for n, v in known if n != number]
        if judged.verdict == WRONG and len(judged.claim.members) == 2 and earlier:
            yield remark("contradicts", self.lines[max(n for n, _ in earlier)])
        other = [n for n, v in earlier if None not in {v, value} and v != value]
        if other and self._still(other[-1], number):
            yield remark("contradicts assumption", self.lines[other[-1]])
        if judged.verdict != WRONG:
            self.members.update(dict.fromkeys(members, (number, value)))

    def _still(self, earlier: int, number: int) -> bool:
        """Whether what an earlier formula assumed still holds where another stands."""
        place = self.context.places[earlier]
        return any(s.start == place for s in self.context.at(number))


def _plain(judged: Judged) -> bool:
    claim = judged.claim
    equal = len(claim.members) > 1 and EQUALITIES.issuperset(claim.relations)
    return claim.kind in {STATEMENT, DEFINITION} and not claim.verdict and equal


def _links(claim: Claim) -> list[Any]:
    """Return what sets each link apart: its two sides with the meanings of their symbols."""
    meanings = frozenset(claim.scalars.items())
    terms = [m.term for m in claim.members]
    start = int(claim.kind == DEFINITION)
    first = [(claim.defines, terms[1])] if start and len(terms) > 1 else []
    return [*first, *((frozenset(p), meanings) for p in pairwise(terms[start:]))]


def _value(judged: Judged) -> Any:
    """Return the number that an assumption says its first member is, or None."""
    return _number(judged.claim) if judged.verdict == ASSUMPTION else None


def _number(claim: Claim) -> Any:
    """Return the number that the last member of a claim is, or None."""
    term = claim.members[-1].term
    if term.is_zero:
        return 0
    return term.data[0] if term.head == "expr" and term.data[0].is_number else None


def _members(claim: Claim, context: frozenset[str]) -> list[Any]:
    """Return the values of members in worlds, but for zeros; none where they have no value."""
    try:
        return [(context, p) for p in parts(claim, context) if any(p)]
    except (InputError, Singular):
        return []
