r"""Whether a claim holds in its models, and the smallest sets of assumptions that it needs.

`row_of` is where it is decided in which models: random worlds, solutions of the system of the note, numbers
for free scalars.

Equations that hold nearly: where something is small, both sides agree to the order that is written.

``\sin\theta\approx\theta`` leaves out anything, ``1+\theta+O(\theta^2)`` says what. A side that is a
polynomial in what is small is written to its degree, of two such the shorter one; the difference has to be
of a higher order. What is small is what the note says, else an angle or a coordinate with its rates, or
all of them. Orders are found by the size of the difference for two small values, to many digits.

Sides that are proportional: their quotient stays the same while the letters of the right side take other
values and all others are held, or while time goes on.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import islice, pairwise
from typing import Any

import sympy as sp

from eom.checker.judge.coordinates import on_solutions, tells_time, written
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
from eom.checker.judge.members import Members, of_members
from eom.checker.judge.models import ENOUGH, NO_BODY, Models, Search
from eom.checker.judge.scalars import Proportion, Scalars, numbers
from eom.checker.judge.systems import LENGTH, TRIES, Solutions
from eom.checker.judge.worlds import MAX_TESTS, Worlds
from eom.checker.mean.claims import (
    CONSTANT,
    DEFINITION,
    EQUALITIES,
    PROPORTIONAL,
    SAME_POINT,
    STATEMENT,
    Claim,
)
from eom.checker.mean.moving import OPEN
from eom.checker.mean.parameters import expressions
from eom.checker.mean.values import Value
from eom.errors import InputError
from eom.fields import RESIDUES, Singular, reduced
from eom.limits import Overdue
from eom.terms.terms import SCALAR, Term, der, expr, nodes
from eom.terms.vocabulary import described
from eom.worlds.solutions import Inconsistent, rate, real_point, without_rates

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
    if not on_solutions(claim):
        return Worlds
    return Members if of_members(claim) else Solutions


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
    if claim.otherwise is not None:
        return _by_both(claim, lambda c: judge(c, given))
    if claim.moving is not None and not EQUALITIES.issuperset(claim.relations):
        return Judgement(UNDECIDED, reason=OPEN)
    if claim.relations == (PROPORTIONAL,):
        return _proportional(claim, tuple(given))
    if claim.parameters is None and is_nearly(claim):
        return _of_derived(claim, given) if of_members(claim) else _nearly(claim)
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


def _by_both(claim: Claim, rule: Callable[[Claim], Judgement]) -> Judgement:
    """Return the judgement with Poisson brackets of either sign, undecided where those differ."""
    assert claim.otherwise is not None
    found, other = rule(replace(claim, otherwise=None)), rule(claim.otherwise)
    same = (found.verdict, found.sets) == (other.verdict, other.sets)
    return found if same else Judgement(UNDECIDED, reason=EITHER)


EITHER = "it rests on the sign of Poisson brackets, which nothing before it says"


def judge_within(claim: Claim, names: Iterable[str], given: Iterable[str] = ()) -> Judgement:
    """Return whether a claim holds where much is assumed, with one smallest set of what it needs of that.

    ``names``: all that is assumed; a claim that fails under them is wrong here.
    """
    if claim.otherwise is not None:
        return _by_both(claim, lambda c: judge_within(c, names, given))
    search = Search(models_of(claim, given))
    try:
        chosen = search.models.closed(names)
        context, base = search.base
        if not search.models.said:
            return Judgement(UNDECIDED, reason=NO_BODY)
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
    return Judgement(verdict, sets, context, refuted, complete, why)


def _of_derived(claim: Claim, given: Iterable[str]) -> Judgement:
    """Return whether something nearly equal that is derived of a system is equal, else it is open."""
    exact = replace(claim, relations=("=",) * len(claim.relations), order=None)
    found = judge(exact, given)
    return found if found.verdict != WRONG else Judgement(UNDECIDED, reason=LOOSE)


def loosely(claim: Claim) -> Judgement:
    """Return the judgement on equations of which words say that something in them is small.

    They hold nearly, to the order to which they are written, if they are polynomials in what is small.
    """
    plain = (
        claim.kind == STATEMENT and EQUALITIES.issuperset(claim.relations) and not claim.findings
    )
    if of_members(claim):
        timed = claim.model is not None and tells_time(claim, claim.model)
        return Judgement(UNDECIDED, reason=LOOSE) if timed else Judgement(UNDECIDED)
    if not plain or claim.parameters is not None or len(claim.members) < 2:
        return Judgement(UNDECIDED, reason=LOOSE)
    signs = tuple(next(iter(NEARLY)) for _ in claim.relations)
    try:
        holds, reason = nearly(replace(claim, relations=signs), polynomial=True)
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))
    return Judgement(UNDER if holds else WRONG, reason=reason)


LOOSE = "not exactly true; the note speaks of an approximation"


def _nearly(claim: Claim) -> Judgement:
    try:
        holds, reason = nearly(claim)
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))
    return Judgement(HOLDS if holds else WRONG, reason=reason)


# -- proportions -----------------------------------------------------------------------------------------


def _proportional(claim: Claim, given: tuple[str, ...]) -> Judgement:
    """Return whether the quotient of two sides is constant over what varies; what is held is the reason."""
    try:
        if claim.parameters is not None:
            return _of_letters(claim)
        if len(claim.members) != 2 or {m.shape for m in claim.members} != {SCALAR}:
            raise InputError("in this proportion only scalars are compared")
        return (_of_states if on_solutions(claim) else _of_worlds)(claim, given)
    except InputError as error:
        return Judgement(UNDECIDED, reason=str(error))


def _of_letters(claim: Claim) -> Judgement:
    """Return whether free scalars are proportional, by what the note says of them."""
    assert claim.parameters is not None
    known = {r.symbol: r.value for r in claim.parameters.relations}
    stated = {r.symbol: r.written for r in claim.parameters.relations}
    above, below = expressions(claim)
    stages = [(above, below), (above.xreplace(known), below.xreplace(known))]
    while above.free_symbols & stated.keys() and len(stages) < MAX_STAGES:
        above = above.xreplace(stated)
        stages.append((above, below))
    rows = [Proportion(a, b, numbers({*a.free_symbols, *b.free_symbols})) for a, b in stages]
    held = next((r for r in rows if r.constant()), None)
    if held is not None:
        return Judgement(HOLDS, reason=held.words)
    last = rows[-1]
    if last.below.free_symbols & known.keys() or not (
        last.below.free_symbols <= last.above.free_symbols
    ):
        raise InputError("in this proportion nothing says how the sides depend on each other")
    return Judgement(WRONG, reason=f"the quotient of both sides is not constant where {last.words}")


MAX_STAGES = 8


def _of_worlds(claim: Claim, given: tuple[str, ...]) -> Judgement:
    """Return whether two scalars are proportional as time goes on, or as free ones that are any."""
    atoms: dict[Term, Expr] = {}
    with suppress(InputError):
        above, below = (_expression(m.term, claim.scalars, atoms) for m in claim.members)
        found = Proportion(above, below, numbers(atoms.values()))
        if found.constant():
            return Judgement(HOLDS, reason=found.words)
        tied = below.free_symbols <= above.free_symbols
        if tied and all(_still(t).data[0] == "scalar" for t in atoms):
            why = f"the quotient of both sides is not constant where {found.words}"
            return Judgement(WRONG, reason=why)
    by_time = _in_time(claim, given)
    if by_time.verdict == WRONG:
        raise InputError("in this proportion it is open whether all else is constant")
    return by_time


def _in_time(claim: Claim, given: tuple[str, ...]) -> Judgement:
    """Return whether the quotient of both sides is constant while the right one is not."""
    quotient = judge(_steady(claim, _squared_quotient), given)
    if quotient.verdict == HOLDS:
        if not _moves(claim, given):
            raise InputError("in this proportion nothing varies")
        return replace(quotient, reason="as time goes on")
    alone = tuple(s for s in quotient.sets if _moves(claim, (*given, *s)))
    if quotient.verdict == UNDER:
        return replace(quotient, verdict=UNDER if alone else WRONG, sets=alone)
    return quotient


def _moves(claim: Claim, given: tuple[str, ...]) -> bool:
    return judge(_steady(claim, lambda _, below: below), given).verdict != HOLDS


def _squared_quotient(above: Expr, below: Expr) -> Expr:
    return (above / below) ** 2


def _steady(claim: Claim, rule: Callable[[Expr, Expr], Expr]) -> Claim:
    """Return the claim that something made of both sides is constant."""
    names = tuple(sp.Dummy(f"side_{k}", real=True) for k in (1, 2))
    own = {s: m.term for s, m in zip(names, claim.members, strict=True)}
    inside = {s: t.data[0] for s, t in own.items() if t.head == "expr"}
    made = rule(*(inside.get(s, s) for s in names))
    scalars = {**claim.scalars, **{s: t for s, t in own.items() if made.has(s)}}
    value = Value(der(expr(made)), SCALAR, span=claim.span)
    return replace(claim, members=(value,), relations=(), kind=CONSTANT, scalars=scalars)


def _of_states(claim: Claim, given: tuple[str, ...]) -> Judgement:
    """Return whether quantities of the note's system are proportional, at any state or as time goes on."""
    model = claim.model
    assert model is not None
    if of_members(replace(claim, relations=("=",))):
        raise InputError("in this proportion what is derived of a system is not compared")
    models, found = Solutions(claim, claim.scalars, given), None
    with suppress(InputError):
        found = _over_states(claim, models)
        if found.constant():
            return Judgement(HOLDS, reason=found.words)
    if found is None or _rests_on_states(found, models):
        by_time = _in_time(claim, given)
        if by_time.verdict != WRONG:
            return by_time
    if found is None:
        raise InputError("in this proportion the state of the system is not explicit")
    names = [n for n, r in models.possible.items() if (r.held or r.zero) and not r.rest]
    special = next((n for n in names if _in_special(found, models, n)), "")
    if special:
        return Judgement(UNDER, ((special,),))
    return Judgement(
        WRONG, reason=f"the quotient of both sides is not constant where {found.words}"
    )


def _over_states(claim: Claim, models: Solutions) -> Proportion:
    """Return both sides over the states of the system. Raises `InputError` where they are not explicit."""
    model = models.model
    equal = {b: a for r in models.held for a, b in r.equal} | {
        s: sp.S.Zero for r in models.held for s in r.zero
    }
    above, below = (
        without_rates(model.system, written(m.term, claim.scalars, model)).xreplace(equal)
        for m in claim.members
    )
    if above.count_ops() + below.count_ops() > MAX_SIZE:
        raise InputError("too long")
    points = tuple(real_point(model.system, k) for k in range(3))
    letters = {q.symbol: model.letter(n) for n, q in model.quantities.items()}
    return Proportion(above, below, points, lambda s: letters.get(s, str(s)))


def _rests_on_states(found: Proportion, models: Solutions) -> bool:
    """Return whether the quotient is not one of parameters alone, which no motion changes; or zero."""
    states = {q.symbol for q in models.model.system.states}
    quotient = sp.cancel(found.above / found.below)
    return quotient == 0 or any(
        sp.simplify(quotient.diff(s)) != 0 for s in quotient.free_symbols & states
    )


def _in_special(found: Proportion, models: Solutions, name: str) -> bool:
    """Return whether the quotient is the same in all motions of a kind that have the other parameters.

    What keeps motions of that kind is zero; so the slope of the quotient has to be a sum of its slopes, and
    that of the right side must not be.
    """
    system, kind = models.model.system, models.possible[name]
    zeros = [*kind.zero]
    for e in kind.held:
        zeros += (first := without_rates(system, rate(e)), without_rates(system, rate(first)))
    variables = [q.symbol for q in system.states] + [
        q.symbol for q in system.parameters if found.below.has(q.symbol)
    ]
    a, b = found.above, found.below
    slopes = [[e.diff(v) for v in variables] for e in (*zeros, b)]
    slopes.append([a.diff(v) * b - a * b.diff(v) for v in variables])
    drawn = islice(models.model.motions((*models.held, kind), LENGTH, TRIES), ENOUGH)
    with suppress(Inconsistent, Singular):
        rows = [
            [[m.series(e).coefficients[0] for e in row] for row in (*slopes, [a])] for m in drawn
        ]
        fine = (
            _within(slope, own) and not _within(below, own) and any(above)
            for *own, below, slope, above in rows
        )
        return len(rows) == ENOUGH and all(fine)
    return False


def _within(row: list[int], rows: Iterable[list[int]]) -> bool:
    """Return whether a row is a sum of multiples of others."""
    return len(reduced([*rows, row], RESIDUES)[1]) == len(reduced([*rows], RESIDUES)[1])


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
        reason = f"a condition: it does not hold for all bodies and motions{special}"
        return Judgement(UNDECIDED, (), context, found.where, True, reason)
    if found.found == BARELY and found.proved:
        return Judgement(UNDER, (), context, found.where, True, f"zero in special cases{special}")
    if found.found == ALWAYS and found.proved:
        return Judgement(HOLDS, (), context)
    reason = f"no counterexample among {found.tried} bodies and motions" + (
        f", but equality{special}" if found.found == BARELY else ""
    )
    return Judgement(UNDECIDED, (), context, None, True, reason)


Expr = Any

NEARLY = frozenset({"approx", "simeq"})
DIGITS, FAR, NEAR = 150, -8, -12
EXACT = 99
"""Order of a difference that vanishes."""
FREELY = frozenset({"scalar", "coordinate", "free_angle", "angle", "turn_angle", "principal_angle"})
MAX_SIZE = 2000


@dataclass(frozen=True)
class Sides:
    """Two sides as they are written, and with all rates written out; symbols by what may be small."""

    shown: tuple[Expr, Expr]
    full: tuple[Expr, Expr]
    small: tuple[tuple[Expr, ...], ...]
    point: Mapping[Expr, Expr]


def is_nearly(claim: Claim) -> bool:
    """Return whether a claim has a sign of approximation, or says what it leaves out."""
    signs = set(claim.relations)
    plain = (
        bool(signs)
        and signs <= EQUALITIES | NEARLY
        and len(claim.members) == len(claim.relations) + 1
    )
    return plain and (bool(signs & NEARLY) or claim.order is not None)


def nearly(claim: Claim, *, polynomial: bool = False) -> tuple[bool, str]:
    """Return whether the links of a chain hold nearly, with the reason.

    ``polynomial``: whether both sides have to be polynomials in what is small.

    Raises `InputError` where that is open: not all that may be small need be what the writer means.
    """
    reasons = []
    for (a, b), relation in zip(pairwise(claim.members), claim.relations, strict=True):
        if {a.shape, b.shape} != {SCALAR}:
            raise InputError("only scalars are compared nearly", got=f"{a.shape}, {b.shape}")
        exact = relation in EQUALITIES and claim.order is None
        sides = _sides(claim, a.term, b.term)
        if polynomial and any(_degree(s, g) is None for g in sides.small for s in sides.shown):
            raise InputError("what is small here is not known")
        found = [_orders(claim, sides, small) for small in ((),) if exact] or [
            _orders(claim, sides, small) for small in sides.small
        ]
        best = next((f for f in found if f.apart > f.wanted), None)
        if best is None:
            return False, _differs(found)
        reasons.append(
            f"to order {best.wanted} in small {_names(best.small)}" if best.small else ""
        )
    return True, "; ".join(dict.fromkeys(filter(None, reasons)))


@dataclass(frozen=True)
class Orders:
    """The order at which sides differ, that up to which they have to agree, and their own lowest ones."""

    small: tuple[Expr, ...]
    apart: int
    wanted: int
    own: tuple[int, int]

    @property
    def meant(self) -> bool:
        """Whether the writer means this to be small: both sides begin at one order, or with one term."""
        return self.own[0] == self.own[1] and (self.own[0] > 0 or self.apart > self.own[0])


def _differs(found: list[Orders]) -> str:
    """Return why two sides differ. Raises `InputError` where something else may be meant to be small."""
    meant = [f for f in found if f.meant or not f.small]
    if not meant:
        raise InputError("what is small here is not known")
    best = max(meant, key=lambda f: f.apart)
    return (
        f"the sides differ at order {best.apart} in small {_names(best.small)}"
        if best.small
        else ""
    )


def _names(small: tuple[Expr, ...]) -> str:
    return ", ".join(sorted({f"${sp.latex(s)}$" for s in small if not isinstance(s, sp.Dummy)}))


def _orders(claim: Claim, sides: Sides, small: tuple[Expr, ...]) -> Orders:
    left, right = sides.full
    first, second = (_vanishing(sides, (side, sp.Integer(0)), small) for side in (left, right))
    degrees = [_degree(s, small) for s in sides.shown if s != 0]
    known = [d for d in degrees if d is not None] or [first]
    agreed = max(min(known), first if first == second else 0)
    if 0 in (left, right):
        first = second = min(first, second)
    wanted = agreed if claim.order is None else claim.order[1] - 1
    return Orders(
        small, _vanishing(sides, (left, right), small), wanted if small else 0, (first, second)
    )


def _degree(side: Expr, small: tuple[Expr, ...]) -> int | None:
    """Return the degree of a polynomial in what is small, None for anything else."""
    e = sp.Dummy("e")
    scaled = sp.expand(side.xreplace({s: e * s for s in small}))
    if not scaled.is_polynomial(e):
        return None
    return int(sp.degree(scaled, e)) if scaled.has(e) else 0


def _vanishing(sides: Sides, pair: tuple[Expr, Expr], small: tuple[Expr, ...]) -> int:
    """Return the order at which two expressions differ where something is small."""
    values = []
    for exponent in (FAR, NEAR):
        scale = sp.Integer(10) ** exponent
        at = {k: v * scale if k in small else v for k, v in sides.point.items()}
        a, b = (s.xreplace(at).evalf(DIGITS) for s in pair)
        if not (a.is_number and b.is_number and a.is_finite and b.is_finite):
            raise InputError("this has no value where something is small")
        values.append(abs(a - b))
    if max(values) < sp.Float(10, DIGITS) ** (-DIGITS + 20):
        return EXACT
    if not all(values):
        raise InputError("the order of the difference is not clear")
    return round(float(sp.log(values[0] / values[1], 10) / (FAR - NEAR)))


# -- sides ---------------------------------------------------------------------------------------------


def _sides(claim: Claim, a: Term, b: Term) -> Sides:
    made = _of_system if on_solutions(claim) else _of_scalars
    return made(claim, a, b)


def _of_system(claim: Claim, a: Term, b: Term) -> Sides:
    """Return sides over the states of the note's system."""
    model = claim.model
    assert model is not None
    system = model.system
    left, right = (written(t, claim.scalars, model) for t in (a, b))
    full = tuple(without_rates(system, s) for s in (left, right))
    if sum(int(s.count_ops()) for s in full) > MAX_SIZE:
        raise InputError("too long")
    states = [q.symbol for q in system.states]
    own = tuple(s for s in states if any(f.has(s) for f in (*full, left, right)))
    names: dict[Expr, Expr] = {}
    opaque = {d.symbol for d in (*system.outputs, *system.invariants)}
    pairs = zip((left, right), full, strict=True)
    shown = tuple(_flat(f if s.free_symbols & opaque else s, names) for s, f in pairs)
    rates = tuple(names.values())
    each = [(s, *(d for r, d in names.items() if _inner(r) == s)) for s in own]
    point = {**real_point(system, 0), **{d: sp.Integer(1) for d in rates}}
    every = (*own, *rates)
    shift = {s: s + c for s in own for c in _centre(s, shown, every)}
    shown, full = (tuple(e.xreplace(shift) for e in sides) for sides in (shown, full))
    return Sides(shown, full, tuple(dict.fromkeys([*each, every])), point)


def _centre(state: Expr, shown: Iterable[Expr], every: Iterable[Expr]) -> list[Expr]:
    """Return the number about which a linear side is written, where it vanishes with all else at zero."""
    others = {s: sp.S.Zero for s in every if s != state}
    for side in shown:
        alone = sp.expand(side.xreplace(others))
        if alone.is_polynomial(state) and sp.degree(alone, state) == 1:
            root = sp.cancel(-alone.coeff(state, 0) / alone.coeff(state, 1))
            if root.is_number and root != 0:
                return [root]
    return []


def _flat(side: Expr, names: dict[Expr, Expr]) -> Expr:
    """Return a side with a symbol for every rate of a quantity."""

    def plain(e: Expr) -> Expr:
        if isinstance(e, rate) and _inner(e).is_Symbol:
            return names.setdefault(e, sp.Dummy(str(e), real=True))
        return e.func(*map(plain, e.args)) if e.args else e

    return plain(side)


def _inner(e: Expr) -> Expr:
    while isinstance(e, rate):
        e = e.args[0]
    return e


def _of_scalars(claim: Claim, a: Term, b: Term) -> Sides:
    """Return sides over free scalars, coordinates and their rates."""
    found: dict[Term, Expr] = {}
    full = tuple(_expression(t, claim.scalars, found) for t in (a, b))
    generator = random.Random("approximations")  # noqa: S311 - reproducible, no secret
    point = {s: sp.Rational(generator.randint(20, 90), 61) for s in found.values()}
    if claim.order is not None:
        small = [(_expression(claim.order[0].term, claim.scalars, found),)]
    else:
        groups: dict[Term, list[Expr]] = {}
        for term, symbol in found.items():
            groups.setdefault(_still(term), []).append(symbol)
        kinds = {t: t.data[0] for t in groups}
        angles = tuple(s for t, own in groups.items() if kinds[t] != "scalar" for s in own)
        small = [tuple(own) for own in groups.values()] + ([angles] if angles else [])
    return Sides(full, full, tuple(dict.fromkeys(small)), point)


def _still(term: Term) -> Term:
    while term.head == "der":
        term = term.args[0]
    return term


def _expression(term: Term, scalars: Mapping[Any, Term], found: dict[Term, Expr]) -> Expr:
    """Return a term over one symbol for each quantity and each of its rates."""
    if term.head in {"add", "mul"}:
        join = sp.Add if term.head == "add" else sp.Mul
        return join(*(_expression(t, scalars, found) for t in term.args))
    if term.head == "expr":
        inside = {
            s: _expression(scalars[s], scalars, found)
            for s in term.data[0].free_symbols
            if s in scalars
        }
        return term.data[0].xreplace(inside)
    inner = _still(term)
    if inner.head == "expr" and inner.data[0].is_Symbol and inner.data[0] in scalars:
        times = sum(1 for n in nodes(term) if n.head == "der")
        inner = scalars[inner.data[0]]
        term = inner
        for _ in range(times):
            term = Term("der", (term,), ("",))
    if inner.head != "atom" or inner.data[0] not in FREELY:
        raise InputError("this is nothing that may be small or fixed", got=described(term))
    written = (str(s) for s, t in scalars.items() if t == inner)
    name = next(written, "_".join(map(str, inner.data[1:2])))
    rates = "'" * sum(n.head == "der" for n in nodes(term))
    return found.setdefault(term, sp.Symbol(name + rates, positive=True))
