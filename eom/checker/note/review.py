"""The verdicts on a note in the light of all that it says: context, remarks, slips carried forward.

Claims under conditions that are formulas: "A if B", judged where B holds.

A condition that gives a free quantity, or ties a free vector to others, is put into the claim, which is
then judged in worlds like any other. Else the claim has to follow from its conditions, or a special
motion that fulfils them refutes it; nothing is decided where neither is found.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER, WRONG, Judgement, equations, judge
from eom.checker.judge.laws import slipped
from eom.checker.judge.notes import Understood
from eom.checker.judge.systems import on_solutions
from eom.checker.judge.verdicts import ORDER, UNMET, Judged, Verdict, verdict
from eom.checker.mean.claims import EQUALITIES, Claim
from eom.checker.note.carrying import (
    SPECIAL_MOTION,
    by_laws,
    carried,
    carried_on_solutions,
    rested,
    resting,
)
from eom.checker.note.remarks import ranked, remark, remarks
from eom.checker.prose_claims.assumptions import (
    PARAGRAPH,
    Context,
    Said,
    approximate,
    assumed,
    implied,
)
from eom.checker.prose_claims.propositions import Plain, Reading, Test, truth
from eom.checker.read.documents import Document
from eom.checker.report.findings import Remark
from eom.errors import InputError
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
    then it is undecided.
    """
    given = tuple(given)
    first = verdicts if verdicts is not None else [verdict(u, given) for u in understood]
    apart = {k for k, u in enumerate(understood) if any(map(_apart, u.claims))}
    worldly = [replace(u, claims=()) if k in apart else u for k, u in enumerate(understood)]
    alone = [replace(v, claims=()) if k in apart else v for k, v in enumerate(first)]
    found = _in_worlds(document, worldly, given, alone)
    about = [v if k in apart else Verdict(v.verdict) for k, v in enumerate(first)]
    slips = carried_on_solutions(about, given)
    return tuple(
        _on_solutions(replace(r, understood=u, verdict=v), k, understood, slips)
        if k in apart
        else r
        for k, (r, u, v) in enumerate(zip(found, understood, first, strict=True))
    )


def _on_solutions(
    one: Reviewed, number: int, understood: Sequence[Understood], slips: Mapping[int, int]
) -> Reviewed:
    """Return a formula about a system with the line of the slip that it carries forward."""
    if number not in slips:
        return one
    line = understood[slips[number]].formula.piece.line
    return replace(one, remarks=(*one.remarks, remark("carried", line)), carried=line)


def _apart(claim: Claim) -> bool:
    """Whether no world has the values of a claim: it is about a system, or about free scalars."""
    return claim.parameters is not None or on_solutions(claim)


def _in_worlds(
    document: Document,
    understood: Sequence[Understood],
    given: tuple[str, ...],
    alone: Sequence[Verdict],
) -> Iterator[Reviewed]:
    """Yield formulas whose claims have values in worlds, as they stand in the note."""
    context = assumed(document, understood, alone)
    loose = approximate(document.pieces)
    placed = [_placed(v, k, context, loose, given) for k, v in enumerate(alone)]
    settled = [v for v, _ in placed]
    lines = [u.formula.piece.line for u in understood]
    slips = carried(settled, context, given)
    about = remarks(settled, lines, context, given)
    for k, (one, (final, own)) in enumerate(zip(understood, placed, strict=True)):
        line = lines[slips[k]] if k in slips else 0
        more = (remark("carried", line),) if line else ()
        yield Reviewed(one, final, (*own, *more, *about[k]), line, context.names(k))


def _placed(
    alone: Verdict, number: int, context: Context, loose: Sequence[Said], given: tuple[str, ...]
) -> tuple[Verdict, tuple[Remark, ...]]:
    """Return the verdict on a formula in its place, and why it differs."""
    found: list[Remark] = []
    claims = tuple(_claim(j, number, context, loose, given, found) for j in alone.claims)
    known = context.names(number)
    claims = tuple(
        replace(j, judgement=replace(j.judgement, sets=ranked(j.judgement.sets, known)))
        for j in claims
    )
    if not found:
        return replace(alone, claims=claims), ()
    reasons = {j.verdict: j.reason for j in reversed(claims)}
    gravest = next(v for v in ORDER if v in reasons)
    return Verdict(gravest, reasons[gravest], claims), tuple(dict.fromkeys(found))


def _claim(
    judged: Judged,
    number: int,
    context: Context,
    loose: Sequence[Said],
    given: tuple[str, ...],
    found: list[Remark],
) -> Judged:
    """Return a claim with its verdict in its place; ``found`` takes why it differs."""
    unmet = judged.reason == UNMET and judged.verdict == UNDECIDED
    if not (unmet or judged.verdict in {WRONG, UNDER}) or judged.claim.verdict:
        return judged
    if unmet or judged.verdict == WRONG:
        placed = _conditioned(judged, number, context, given, found)
        if placed is not None:
            return placed
    known = context.names(number) | implied(given)
    best = [len(implied(s) - known) for s in ranked(judged.judgement.sets, known)[:1]]
    if judged.verdict == UNDER and 0 in best:
        return judged
    rested = _rested(judged, number, context, given)
    if rested is not None and not (best and len(implied(rested.sets[0]) - known) >= best[0]):
        found.append(remark("rests on", max(s.line for s in context.premises(number))))
        alone = not any(rested.sets)
        sets = () if alone else (*rested.sets, *judged.judgement.sets)
        judgement = replace(rested, sets=sets)
        return replace(judged, judgement=judgement, verdict=UNDER, reason="", chain=None)
    if judged.verdict == UNDER:
        return judged
    lawful = _of_special_body(judged, number, context, given, found) or _by_laws(
        judged, number, context, given, found
    )
    return lawful or _approximate(judged, number, context, loose, given, found) or judged


SPECIAL_BODIES = frozenset({"thin_rod", "spin_312", "rotors", "viscous_slug"})
"""Assumptions that are not tried unless the note states them."""


def _of_special_body(
    judged: Judged, number: int, context: Context, given: tuple[str, ...], found: list[Remark]
) -> Judged | None:
    """Return a claim that holds for the special body that the note speaks of, None for others."""
    stated = [s for s in context.at(number) if SPECIAL_BODIES & set(s.names)]
    names = tuple(n for s in stated for n in s.names if n in SPECIAL_BODIES)
    if not names:
        return None
    judgement = judge(judged.claim, (*given, *names))
    plain = [s for s in judgement.sets if not SPECIAL_MOTION & set(s) - {*names}]
    if judgement.verdict != HOLDS and not plain:
        return None
    found.append(remark("rests on", max(s.line for s in stated)))
    sets = tuple((*names, *some) for some in plain or ((),))
    judgement = replace(judgement, verdict=UNDER, sets=sets)
    return replace(judged, judgement=judgement, verdict=UNDER, reason="", chain=None)


def _by_laws(
    judged: Judged, number: int, context: Context, given: tuple[str, ...], found: list[Remark]
) -> Judged | None:
    """Return a claim as laws of the writer's own decide it, None where they do not help."""
    lawful = by_laws(judged, number, context, given)
    if lawful is None:
        return None
    kind = "rests on" if lawful.verdict == UNDER else "open by laws"
    found.append(remark(kind, max(s.line for s in context.premises(number))))
    why = "" if lawful.verdict == UNDER else "it may follow from the laws that the note assumes"
    return replace(judged, judgement=lawful, verdict=lawful.verdict, reason=why, chain=None)


def _approximate(
    judged: Judged,
    number: int,
    context: Context,
    loose: Sequence[Said],
    given: tuple[str, ...],
    found: list[Remark],
) -> Judged | None:
    """Return a claim beside words of an approximation as undecided, None where there are none."""
    place = context.places[number]
    near = [s for s in loose if s.start <= place and place[0] < s.stop]
    if not near or slipped(judged.claim, given):
        return None
    found.append(remark("approximate", near[-1].line))
    reason = "not exactly true; the note speaks of an approximation"
    return replace(judged, verdict=UNDECIDED, reason=reason, chain=None)


def _conditioned(
    judged: Judged, number: int, context: Context, given: tuple[str, ...], found: list[Remark]
) -> Judged | None:
    """Return a claim that fails by itself where its conditions hold; None where it has none.

    Those of its line and its paragraph count. What is no equation makes no equation true.
    """
    place = context.places[number]
    near = [s for s in context.premises(number) if s.scope == PARAGRAPH or s.start[0] == place[0]]
    told = [(s, p) for s in near for p in s.premises if not BOUNDS & set(p.relations)]
    if not told:
        return None
    names = context.names(number)
    judgement = conditioned(judged.claim, [p for _, p in told], names, given)
    if judgement.verdict == judged.verdict == WRONG:
        return None
    line = max(s.line for s, _ in told)
    found.append(remark("rests on", line) if under(judgement) else remark("condition", line))
    verdict = judgement.verdict
    return replace(
        judged, judgement=judgement, verdict=verdict, reason=judgement.reason, chain=None
    )


def _rested(
    judged: Judged, number: int, context: Context, given: tuple[str, ...]
) -> Judgement | None:
    try:
        return resting(judged, number, context, given)
    except InputError:
        return None


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
