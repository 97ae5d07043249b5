"""Corrections of a wrong line: looked for in worlds, read again as a whole, judged, ranked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from eom.checker.candidates import Candidate, Workshop, repaired
from eom.checker.claims import Claim
from eom.checker.explanation import UNEXPLAINED, Correction, Explanation
from eom.checker.judge import HOLDS, UNDER, Judgement, judge_within
from eom.checker.levels import penalty, places
from eom.checker.lines import Line, Place, line, valued
from eom.checker.lost import Pools
from eom.checker.notes import Understood, reread
from eom.checker.options import Option, options
from eom.checker.palette import palette
from eom.checker.paths import at
from eom.checker.slips import DROPPED
from eom.checker.syntax import Node
from eom.checker.values import ILL_FORMED, WRONG
from eom.checker.verdicts import Judged
from eom.checker.writing import latex
from eom.series import PRIME

SHOWN = 3
"""Corrections that are shown at most."""
JUDGED = 6
"""Repairs of a line that are judged in full at most."""
ENOUGH = 1.0
"""A repair found is enough if a special level could only add some that weigh this much more."""


@dataclass(frozen=True)
class Ranked:
    """A repair with its tree, what it weighs so far as is known, and where it was found to hold."""

    candidate: Candidate
    tree: Node
    cost: float
    names: frozenset[str]


@dataclass(frozen=True)
class Verified:
    """A repair that was read again and judged: its claim and judgement."""

    ranked: Ranked
    claim: Claim
    judgement: Judgement
    cost: float


def corrections(
    understood: Understood, wrong: Line, given: Iterable[str] = (), stated: Iterable[str] = ()
) -> list[Verified]:
    """Return verified repairs of a wrong line, the most plausible first."""
    given, stated = tuple(given), frozenset(stated) | frozenset(given)
    ranked = _ranked(understood, wrong, given)
    found: list[Verified] = []
    for one in ranked[:JUDGED]:
        made = verified(understood, wrong, one, given, stated)
        if made is not None:
            found.append(made)
        if len(found) == SHOWN:
            break
    return sorted(found, key=lambda v: v.cost)


def _ranked(understood: Understood, wrong: Line, given: tuple[str, ...]) -> list[Ranked]:
    """Return what holds in some world, by weight and by whether it holds without assumptions."""
    shop = workshop(understood, wrong)
    terms = [v.term for v in shop.values.values() if v is not None]
    terms += [m.value.term for m in wrong.members if m.value is not None]
    found: dict[Node, Ranked] = {}
    for number, (free, there) in enumerate(places(given, wrong.elaborator.scalars, terms)):
        if found and min(r.cost for r in found.values()) < 1.0 + number * ENOUGH:
            break
        for candidate in shop.candidates(there):
            tree = repaired(wrong, candidate)
            extra = 0.0 if _holds_in(shop, free, candidate) else 0.6 + 0.5 * number
            if tree not in found and not trivial(wrong, tree, shop, free, candidate):
                found[tree] = Ranked(candidate, tree, candidate.weight + extra, there.names)
    return sorted(found.values(), key=lambda r: r.cost)


def workshop(understood: Understood, wrong: Line) -> Workshop:
    """Return a line with what may stand for each of its terms."""
    have = palette(understood, wrong)
    addends = [a for m in wrong.members for a in m.addends if m.path is not None]
    values = {a: valued(wrong.elaborator, a.node) for a in addends}
    offers = {a: options(wrong, a, have) for a in addends}
    return Workshop(wrong, offers, values, Pools(wrong, values))


def _totals(shop: Workshop, place: Place, candidate: Candidate) -> list[int | None]:
    """Return the numbers of all members with a repair put in; None where one has none."""
    put: dict[object, Option] = {o.addend: o for o in candidate.options}
    totals: list[int | None] = []
    for member in shop.line.members:
        parts = [] if member.value is None else [place.number(member.value.term)]
        lost = [o for o in candidate.options if o.addend.member == member.number]
        lost = [o for o in lost if o.addend not in member.addends and o.term is not None]
        for option in lost:
            number = None if option.term is None else place.number(option.term)
            parts.append(None if number is None else option.sign * number)
        for addend in member.addends:
            option = put.get(addend)
            value = shop.values.get(addend)
            if option is not None:
                number = 0 if option.term is None else place.number(option.term)
                parts.append(None if number is None else option.sign * number)
            elif value is not None:
                number = place.number(value.term)
                parts.append(None if number is None else addend.sign * number)
            else:
                parts.append(None)
        totals.append(None if None in parts else sum(p for p in parts if p is not None) % PRIME)
    return totals


def _holds_in(shop: Workshop, place: Place, candidate: Candidate) -> bool:
    totals = _totals(shop, place, candidate)
    return None not in totals and len(set(totals)) == 1


def trivial(wrong: Line, tree: Node, shop: Workshop, free: Place, candidate: Candidate) -> bool:
    """Tell whether a repair says nothing: two members alike, or all of them zero anyway."""
    nodes = [at(tree, m.path) for m in wrong.members if m.path is not None]
    if len(set(nodes)) < len(nodes):
        return True
    return all(t == 0 for t in _totals(shop, free, candidate))


def verified(
    understood: Understood,
    wrong: Line,
    ranked: Ranked,
    given: tuple[str, ...],
    stated: frozenset[str],
) -> Verified | None:
    """Return a repair that holds when it is read again as a whole, or None."""
    claims = reread(understood, ranked.tree)
    if len(claims) != len(understood.claims):
        return None
    claim = claims[wrong.number]
    if claim.verdict or claim.kind != wrong.claim.kind:
        return None
    found = judge_within(claim, ranked.names, given)
    if found.verdict not in {HOLDS, UNDER}:
        return None
    needed = min((penalty(s, stated) for s in found.sets), default=0.0)
    cost = ranked.candidate.weight + needed + (0.5 if needed else 0.0)
    return Verified(ranked, claim, found, cost)
