"""Whether a claim holds in its models, and the smallest sets of assumptions that it needs.

`row_of` is where it is decided in which models: random worlds, solutions of the system of the note, numbers
for free scalars.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from eom.checker.judge.approximations import is_nearly, nearly
from eom.checker.judge.inequalities import (
    ALWAYS,
    BARELY,
    NEVER,
    ORDERS,
    SOMETIMES,
    Sign,
    difference,
    sign,
)
from eom.checker.judge.models import MAX_TESTS, Models, Search, Worlds
from eom.checker.judge.scalars import Scalars
from eom.checker.judge.systems import Solutions, on_solutions
from eom.checker.mean.claims import DEFINITION, SAME_POINT, STATEMENT, Claim
from eom.errors import InputError
from eom.limits import Overdue
from eom.terms.terms import Term

HOLDS, UNDER, WRONG, UNDECIDED = "holds", "holds under", "wrong", "undecided"


@dataclass(frozen=True)
class Judgement:
    """A verdict, smallest sets of assumptions, the context of the models, a model that refutes.

    ``verdict``: "holds", "holds under", "wrong", "definition", "undecided".
    ``sets`` are without what others need; ``complete``: whether there can be no other sets;
    ``refuted``: assumptions and seed of a model where the claim is false, none if it holds in all.
    ``special``: of a claim that is wrong in general, the special case in which it holds, in words.
    """

    verdict: str
    sets: tuple[tuple[str, ...], ...] = ()
    context: tuple[str, ...] = ()
    refuted: tuple[tuple[str, ...], int] | None = None
    complete: bool = True
    reason: str = ""
    special: str = ""


def row_of(claim: Claim) -> type[Models]:
    """Return the kind of the models of a claim."""
    if claim.parameters is not None:
        return Scalars
    return Solutions if on_solutions(claim) else Worlds


def models_of(
    claim: Claim, given: Iterable[str] = (), scalars: Mapping[Any, Term] | None = None
) -> Models:
    """Return the models of a claim; ``scalars``: what its symbols stand for, if other than it says."""
    return row_of(claim)(claim, claim.scalars if scalars is None else scalars, tuple(given))


def judge(claim: Claim, given: Iterable[str] = ()) -> Judgement:
    """Return whether a claim holds beyond what is ``given``, and under what else.

    A claim with findings is judged by what is left of it; without members it is undecided.
    Raises `eom.limits.Overdue` where time is up before anything is found.
    """
    if claim.parameters is None and is_nearly(claim):
        return _nearly(claim)
    given, ordered = tuple(given), ORDERS & set(claim.relations) and row_of(claim) is Worlds
    if ordered and len(claim.relations) == len(claim.members) - 1:
        return _ordered(claim, given)
    search = Search(models_of(claim, given))
    try:
        found = _at_base(search)
        if found and claim.relations[:1] == (":=",) and len(search.models.said) == 1:
            return Judgement(DEFINITION, context=found.context)
        return found or _beyond(search)
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))


def judge_within(claim: Claim, names: Iterable[str], given: Iterable[str] = ()) -> Judgement:
    """Return whether a claim holds where much is assumed, with one smallest set of what it needs of that.

    ``names``: all that is assumed; a claim that fails under them is wrong here.
    """
    search = Search(models_of(claim, given))
    try:
        chosen = search.models.closed(names)
        context, base = search.base
        if not search.models.said:
            return Judgement(UNDECIDED, reason="no world has these quantities")
        found = _at_base(search)
        if found is not None:
            return found
        if not base <= chosen or not search.counts(chosen):
            return Judgement(WRONG, context=context, complete=False)
        needed = search.models.shrunk(chosen, base, search.counts) - base
        shown = search.models.shown(needed | search.models.own(context))
        return Judgement(UNDER, (shown,), context, complete=False)
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))


def rarely(claim: Claim, given: Iterable[str] = ()) -> tuple[tuple[str, ...], ...]:
    """Return the smallest sets with assumptions that are tried last, of a claim judged in worlds."""
    models = Worlds(claim, claim.scalars, tuple(given))
    search = Search(models)
    try:
        context, base = search.base
        found = [s - base for s in models.rarest(search, base)]
    except (InputError, Overdue):
        return ()
    smallest = (s for s in found if not any(t < s for t in found))
    return tuple(sorted((models.shown(s | models.own(context)) for s in smallest), key=models.rank))


def _at_base(search: Search) -> Judgement | None:
    """Return the judgement on what holds without more than is given; None for all else."""
    context, base = search.base
    if search.models.said and not search.holds(base):
        return None
    own = search.models.own(context) if search.models.said else frozenset()
    return Judgement(UNDER if own else HOLDS, (search.models.shown(own),) if own else (), context)


def _beyond(search: Search) -> Judgement:
    """Return the judgement on what does not hold by what is given alone."""
    models, claim, (context, base) = search.models, search.models.claim, search.base
    doubt = models.doubt()
    if doubt:
        return Judgement(UNDECIDED, reason=doubt)
    shown = [models.shown(s | models.own(context)) for s in search.sets()]
    sets = tuple(sorted(filter(None, shown), key=models.rank))
    refuted = (tuple(sorted(base)), search.seeds[base]) if base in search.seeds else None
    names = claim.kind == SAME_POINT or (not shown and models.names_scalars)
    verdict = DEFINITION if names else UNDER if shown else WRONG
    if verdict == WRONG and models.is_open():
        return Judgement(UNDECIDED, reason="its roots leave open under what it holds")
    complete = search.tests < MAX_TESTS and not search.stopped
    why = "" if sets else models.why(search)
    case = models.case() if verdict == WRONG else ""
    return Judgement(verdict, sets, context, refuted, complete, why, case)


def _nearly(claim: Claim) -> Judgement:
    try:
        holds, reason = nearly(claim)
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))
    return Judgement(HOLDS if holds else WRONG, reason=reason)


def _ordered(claim: Claim, given: tuple[str, ...]) -> Judgement:
    """Return whether a chain with signs of order holds: the worst of its links decides."""
    links = [
        replace(claim, members=claim.members[k : k + 2], relations=(relation,))
        for k, relation in enumerate(claim.relations)
    ]
    judged = [_signed(c, given) if c.relations[0] in ORDERS else judge(c, given) for c in links]
    return min(judged, key=lambda j: _WORST.index(j.verdict))


_WORST = (WRONG, UNDECIDED, UNDER, HOLDS, DEFINITION)


def _signed(link: Claim, given: tuple[str, ...]) -> Judgement:
    """Return whether one side is greater than the other in the worlds where both have a value."""
    try:
        term, strict = difference(link)
        both = replace(link, kind=STATEMENT, relations=("=",))
        context, base = Search(Worlds(both, link.scalars, given)).base
        found = sign(term, strict, link.scalars, base)
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))
    return _of_sign(found, context)


def _of_sign(found: Sign, context: tuple[str, ...]) -> Judgement:
    special = f" ({found.special})" if found.special else ""
    if found.found == NEVER:
        return Judgement(WRONG, (), context, found.where, True, "the opposite holds")
    if found.found == SOMETIMES:
        reason = f"a condition: it does not hold in all worlds{special}"
        return Judgement(UNDECIDED, (), context, found.where, True, reason)
    if found.found == BARELY and found.proved:
        return Judgement(UNDER, (), context, found.where, True, f"zero in special cases{special}")
    if found.found == ALWAYS and found.proved:
        return Judgement(HOLDS, (), context)
    reason = f"no counterexample in {found.tried} worlds" + (
        f", but equality{special}" if found.found == BARELY else ""
    )
    return Judgement(UNDECIDED, (), context, None, True, reason)
