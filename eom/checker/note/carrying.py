"""What wrong lines have to do with others: carried forward from a slip, or resting on a premise.

A wrong line that follows from an earlier wrong one repeats its slip and has none of its own. One that
follows from what the note assumes by a formula is not wrong at all.

Lines about a system that carry a slip forward: they hold in the system that the wrong line describes.

A line that is wrong gives, solved for the one rate or the one named quantity that it gives, a system
with the slip in it. Later lines that are wrong of the system itself and hold on the solutions of that
one follow from the slip, however they are derived from it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import sympy as sp

from eom.checker.judge.consequences import follows
from eom.checker.judge.coordinates import equations, on_solutions
from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER, WRONG, Judgement, judge_within, row_of
from eom.checker.judge.laws import (
    APART,
    FITS,
    NEARLY,
    STILL,
    own,
    put_in,
    refuted,
    settled,
    slipped,
    variants,
)
from eom.checker.judge.models import terms_of
from eom.checker.judge.verdicts import GRAVE, Judged, Verdict
from eom.checker.judge.worlds import Worlds, filled
from eom.checker.mean.claims import CONSTANT, STATEMENT, Claim
from eom.checker.mean.model import Model
from eom.checker.prose_claims.assumptions import Context
from eom.errors import InputError
from eom.fields import Singular
from eom.system import Expr, System
from eom.terms.terms import nodes
from eom.worlds.solutions import rate
from eom.worlds.worlds import ASSUMPTIONS, closure

MAX_EARLIER = 4
"""Wrong lines that a later one is compared with, the last ones first."""
MAX_CLAIMS = 3
"""Claims of a formula that are compared with earlier lines."""
USUAL = ("newton_2", "third_law_strong", "body_frame", "principal_axes")
"""What is assumed beyond what is stated, where consequences of a line are looked for."""


def worlds_of(stated: Iterable[str], context: Iterable[str]) -> frozenset[str]:
    """Return a large set that can stand together: the context, then what is stated, then the usual."""
    chosen = set(stated)
    return filled(closure(context), [*(n for n in ASSUMPTIONS if n in chosen), *USUAL])


@dataclass(frozen=True)
class Carried:
    """The number of the formula whose slip a formula carries on, and whether it has one of its own."""

    number: int
    adds: bool = False


@dataclass(frozen=True)
class _Slip:
    """What a formula claims wrongly, and which one slipped first.

    On a system: with the slip in its model; ``others``: whether with those before it as well.
    """

    number: int
    claim: Claim
    others: bool = False


def carried(
    verdicts: Sequence[Verdict], context: Context, given: Iterable[str] = ()
) -> Mapping[int, Carried]:
    """Return for numbers of formulas that carry a slip on what they carry; the others are absent.

    A wrong claim carries an earlier one exactly if it holds with what that one says in place of what is
    true. If it holds but for one term then, it carries the slip and has one of its own.
    """
    given = tuple(given)
    before: dict[bool, list[_Slip]] = {False: [], True: []}
    found: dict[int, Carried] = {}
    for number, verdict in enumerate(verdicts):
        on_system = any(row_of(j.claim) is not Worlds for j in verdict.claims)
        slips, stated = before[on_system], context.names(number)
        wrong = [j for j in verdict.claims if _refuted(j)]
        grave = any(_otherwise_wrong(j, on_system) for j in verdict.claims)
        last = sorted(slips[: -MAX_EARLIER - 1 : -1], key=lambda s: s.others)
        sources = [_source(j, last, stated, given) for j in wrong[:MAX_CLAIMS]]
        known = [s for s in sources if s is not None]
        if known:
            own = grave or len(known) < len(sources) or any(s.adds for s in known)
            found[number] = Carried(min(s.number for s in known), own)
        root = found[number].number if number in found and not found[number].adds else number
        if not on_system:
            slips += [_Slip(root, j.claim) for j in wrong]
        elif not grave and number not in found:
            alone = [_Slip(number, j.claim) for j in wrong]
            both = [
                _Slip(number, replace(j.claim, model=s.claim.model), others=True)
                for s in slips[-1:]
                for j in wrong
            ]
            made = ((s, m) for s in (*alone, *both) for m in _slipped(s.claim))
            slips += [replace(s, claim=replace(s.claim, model=m)) for s, m in made]
    return found


def _refuted(judged: Judged) -> bool:
    """Whether a claim was found wrong in its models, not by its form."""
    return (
        judged.verdict == WRONG and judged.judgement.verdict == WRONG and not judged.claim.verdict
    )


def _otherwise_wrong(judged: Judged, on_system: bool) -> bool:
    """Whether a claim is wrong, but not in the models that its formula is judged in."""
    if not on_system:
        return judged.claim.verdict in GRAVE
    return judged.verdict == WRONG and not (_refuted(judged) and on_solutions(judged.claim))


def _source(
    judged: Judged, slips: Sequence[_Slip], stated: frozenset[str], given: tuple[str, ...]
) -> Carried | None:
    """Return what a wrong claim carries on, or None."""
    fits = _in_system if on_solutions(judged.claim) else _in_worlds
    assumed = worlds_of(stated, (*given, *judged.judgement.context))

    def source(link: Claim) -> Carried | None:
        found: dict[int, int] = {}
        for slip in slips:
            with suppress(InputError, Singular, ValueError):
                others = [s.claim for s in slips if s is not slip]
                found.setdefault(fits(link, slip.claim, others, assumed), slip.number)
            if FITS in found:
                return Carried(found[FITS])
        own = NEARLY in found and not slipped(link, given)
        return Carried(found[NEARLY], adds=True) if own else None

    links = [source(link) for link in _links(judged)]
    known = [f for f in links if f is not None]
    own = len(known) < len(links) or any(f.adds for f in known)
    return Carried(min(f.number for f in known), own) if known else None


def _in_worlds(claim: Claim, slip: Claim, others: Sequence[Claim], assumed: frozenset[str]) -> int:
    related = [o for o in others if _related(claim, o)]
    return put_in(claim, slip, related, assumed) if _related(claim, slip) else APART


def _in_system(claim: Claim, slip: Claim, _: Sequence[Claim], __: frozenset[str]) -> int:
    """Return whether a claim holds in the system that a slip describes."""
    made = replace(claim, model=slip.model)
    if judge_within(made, ()).verdict == HOLDS:
        return FITS
    return NEARLY if any(judge_within(v, ()).verdict == HOLDS for v in variants(made)) else APART


def _links(judged: Judged) -> list[Claim]:
    """Return what is wrong in a claim: the links of a chain that fail, else all of it."""
    claim, chain = judged.claim, judged.chain
    failed = [(a, b) for a, b, found in chain.links if found.verdict == WRONG] if chain else []
    pairs = [(claim.members[a], claim.members[b]) for a, b in failed]
    return [replace(claim, members=p, relations=("=",), kind=STATEMENT) for p in pairs] or [claim]


def _related(a: Claim, b: Claim) -> bool:
    """Whether two claims speak of one quantity; an angle counts where both speak of nothing else."""
    first, second = _quantities(a), _quantities(b)
    both = first & second
    return bool(both - STILL) or (bool(both) and first | second <= STILL)


def _quantities(claim: Claim) -> frozenset[str]:
    atoms = (n for t in terms_of(claim) for n in nodes(t) if n.head == "atom")
    return frozenset(str(n.data[0]) for n in atoms if n.data[0] not in {"unit", "identity"})


_STAGES = (16, 80)
"""Multiples of premises that are tried: first a few."""

# -- premises -----------------------------------------------------------------------------------------


def resting(
    judged: Judged, premises: Iterable[Claim], names: frozenset[str], given: tuple[str, ...]
) -> Judgement | None:
    """Return the judgement on a claim that follows from premises of the note, or None.

    Its sets are what has to be assumed besides; a claim that is refuted and does not follow is wrong.
    """
    near = [p for p in premises if _related(p, judged.claim)]
    stated, where = _stated(near, names), judged.judgement.context
    return rested(judged.claim, near, stated, given, where) if near else None


def rested(
    claim: Claim,
    premises: Sequence[Claim],
    names: Iterable[str],
    given: Iterable[str] = (),
    context: tuple[str, ...] = (),
) -> Judgement | None:
    """Return the judgement on a claim that follows from premises under what is assumed, or None."""
    base = closure([*given, *context])
    assumed = worlds_of(names, base)
    most = next((n for n in _STAGES if follows(claim, premises, assumed, n)), 0)
    if not most:
        return None
    models = Worlds(claim, claim.scalars)
    needed = models.shrunk(assumed, base, lambda names: follows(claim, premises, names, most))
    return Judgement(UNDER, (models.shown(needed - base),), context)


def _stated(premises: Iterable[Claim], names: frozenset[str]) -> frozenset[str]:
    """Return what is stated: with laws for the motion, none that makes it a special one."""
    return names - SPECIAL_MOTION if any(map(own, premises)) else names


def by_laws(
    judged: Judged, premises: Iterable[Claim], names: frozenset[str], given: tuple[str, ...]
) -> Judgement | None:
    """Return the judgement on a claim that no world obeys by laws of the writer's own.

    Undecided where it may follow from them; None where there are none, or it is wrong by them too.
    """
    laws = [p for p in premises if own(p) & own(judged.claim)]
    if not laws:
        return None
    known = settled(judged.claim, laws, given)
    if known is not None and known.verdict in {HOLDS, UNDER}:
        return replace(known, verdict=UNDER, sets=known.sets or ((),))
    base = closure([*given, *judged.judgement.context])
    assumed = worlds_of(_stated(laws, names), base)
    wrong = known.verdict == WRONG if known else refuted(judged.claim, laws, assumed)
    return None if wrong else Judgement(UNDECIDED, context=judged.judgement.context)


SPECIAL_MOTION = frozenset(
    {"symmetric", "torque_free", "thin_rod", "C_at_rest", "no_torque_2", "no_torque_3"}
)
"""Assumptions about special bodies and motions, under which terms of equations vanish."""


# -- systems with a slip -------------------------------------------------------------------------------


def _slipped(claim: Claim) -> Iterator[Model]:
    """Yield the models that a wrong claim describes: with another rate, or another definition."""
    model = claim.model
    if model is None or claim.kind == CONSTANT or model.system.mass_matrix is not None:
        return
    try:
        pairs = equations(claim, model)
    except InputError:
        return
    for left, right in pairs:
        for system in (
            *_other_rate(model.system, left, right),
            *_renamed(model.system, left, right),
        ):
            yield replace(model, system=system, drawn={})


def _other_rate(system: System, left: Expr, right: Expr) -> Iterator[System]:
    """Yield the system in which an equation holds that is linear in the rate of one state."""
    known = {rate(q.symbol): r for q, r in zip(system.states, system.rates, strict=True)}
    speeds = {e: r for e, r in known.items() if r.is_Symbol}
    difference = _named(left - right, speeds)
    for place, q in enumerate(system.states):
        unknown = rate(q.symbol)
        if unknown in speeds or not difference.has(unknown):
            continue
        mark = sp.Dummy("rate")
        plain = difference.xreplace({unknown: mark})
        slope = plain.diff(mark)
        if slope.has(mark) or slope == 0 or plain.has(rate):
            continue
        value = sp.together(-plain.xreplace({mark: sp.Integer(0)}) / slope)
        with suppress(InputError):  # a value in quantities that are defined by states
            yield replace(
                system,
                rates=(*system.rates[:place], value, *system.rates[place + 1 :]),
                invariants=(),
                attitudes=(),  # what holds of the bodies need not with the writer's rate
            )


def _named(expression: Expr, speeds: Mapping[Expr, Expr]) -> Expr:
    """Replace rates that are states themselves, from inside out."""
    if not expression.args:
        return expression
    inner = expression.func(*(_named(a, speeds) for a in expression.args))
    return speeds.get(inner, inner)


def _renamed(system: System, left: Expr, right: Expr) -> Iterator[System]:
    """Yield the system in which a named quantity is what an equation says that it is."""
    for name, value in ((left, right), (right, left)):
        if not name.is_Symbol or value.has(rate) or name in value.free_symbols:
            continue
        named = (system.definitions, system.outputs, system.invariants)
        if any(d.symbol == name for rows in named for d in rows):
            own = [
                tuple(replace(d, expression=value) if d.symbol == name else d for d in rows)
                for rows in named
            ]
            with suppress(InputError):  # a value in quantities that are defined behind it
                definitions, outputs, invariants = own
                yield replace(
                    system,
                    definitions=definitions,
                    outputs=outputs,
                    invariants=invariants,
                    attitudes=(),
                )
