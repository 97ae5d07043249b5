"""Whether a scalar claim holds on the solutions of the system that a note is about.

Every symbol of the claim is a quantity of the system; time derivatives are those along its solutions.
Both sides are compared as exact series at random points (`eom.worlds.solutions`), so that an equation may
be multiplied by any factor and written in any form. What does not hold is tried under what may be assumed
of the system, the smallest sets first. A set is refused that makes something vanish which the claim itself
writes: a slip in a term is no licence to assume the term away.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations, islice
from typing import TYPE_CHECKING, Any

import sympy as sp

from eom.checker.judge.leftover import MAX_SPREAD, Leftover, leftover
from eom.checker.mean.claims import CONSTANT, DEFINITION, EQUALITIES, SAME_POINT, Claim
from eom.checker.mean.solid_models import COORDINATES, integrated
from eom.errors import InputError
from eom.exact.series import Series
from eom.fields import Singular
from eom.system import Expr
from eom.terms.terms import Term, nodes
from eom.worlds.numerals import differs, inexact
from eom.worlds.solutions import Inconsistent, Motion, Restriction, order, rate, spread

if TYPE_CHECKING:
    from eom.checker.mean.model import Model

POINTS = 3
TRIES = 30
LENGTH = 3
"""Coefficients of every series at least, so that claims share them."""
MAX_TESTS = 200
MAX_SET = 3
MAX_ORDER = 6

HOLDS, UNDER, WRONG, UNDECIDED = "holds", "holds under", "wrong", "undecided"


@dataclass(frozen=True)
class Decision:
    """A verdict, the smallest sets of assumptions, why it is undecided or what is wrong."""

    verdict: str
    sets: tuple[tuple[str, ...], ...] = ()
    reason: str = ""


def of_system(term: Term) -> bool:
    """Whether a term is a quantity of the system."""
    return term.head == "atom" and term.data[:1] == ("system",)


def _atoms(claim: Claim) -> Iterator[Term]:
    terms = [m.term for m in claim.members]
    used = {s for t in terms for n in nodes(t) if n.head == "expr" for s in n.data[0].free_symbols}
    todo = [*terms, *(t for s, t in claim.scalars.items() if s in used)]
    seen: set[Any] = set(used)
    while todo:
        for n in nodes(todo.pop()):
            if n.head == "expr":
                fresh = {s for s in n.data[0].free_symbols if s not in seen}
                seen |= fresh
                todo += [claim.scalars[s] for s in fresh if s in claim.scalars]
            elif n.head == "atom":
                yield n


def mentions(claim: Claim) -> bool:
    """Whether a claim speaks of a quantity of the system."""
    return any(of_system(a) for a in _atoms(claim))


def on_solutions(claim: Claim) -> bool:
    """Whether a claim is judged on the solutions of the system of its note; no world has its values."""
    return claim.model is not None and mentions(claim)


def covered(claim: Claim) -> bool:
    """Whether a claim is a relation between scalars of the system alone."""
    atoms = list(_atoms(claim))
    return bool(atoms) and all(of_system(a) for a in atoms) and not _vectors(claim)


def _vectors(claim: Claim) -> bool:
    return any(m.term.kind != "scalar" for m in claim.members)


# -- claims as expressions ----------------------------------------------------------------------------


def written(term: Term, scalars: Mapping[Any, Term], model: Model) -> Expr:
    """Return a scalar term as an expression over the system's symbols, with `rate` for derivatives.

    Raises `InputError` for what is no scalar of the system.
    """
    inside = tuple(written(a, scalars, model) for a in term.args)
    if term.head == "integral" and model.point is not None:
        return integrated(model.system.name, model.point, inside[0])
    if term.head in _JOINED:
        return _JOINED[term.head](*inside)
    if term.head == "zero":
        return sp.Integer(0)
    if term.head == "der" and term.kind == "scalar":
        return inside[0] if inside[0] == 0 else rate(inside[0])
    if term.head == "expr":
        free = term.data[0].free_symbols
        own = {s: written(scalars[s], scalars, model) for s in free if s in scalars}
        time = {s: model.system.time for s in free if s not in scalars}
        return term.data[0].xreplace(own | time)
    if of_system(term):
        return model.symbol(term.data[1])
    raise InputError("this is no quantity of the system", got=term.head)


_JOINED = {"add": sp.Add, "mul": sp.Mul}


def equations(claim: Claim, model: Model) -> list[tuple[Expr, Expr]]:
    """Return the pairs of expressions that a claim says are equal. Raises `InputError` for others."""
    others = [r for r in claim.relations if r not in EQUALITIES]
    if others or claim.kind == SAME_POINT:
        raise InputError("only equations are judged on solutions", got=others[0] if others else "")
    members = [written(m.term, claim.scalars, model) for m in claim.members]
    if model.point is not None and any(m.free_symbols & set(COORDINATES) for m in members):
        raise InputError("the place of an element outside of an integral")
    if claim.kind == CONSTANT:
        return [(members[0], sp.Integer(0))]
    start = int(claim.kind == DEFINITION)
    return list(zip(members[start:], members[start + 1 :], strict=False))


# -- judging ------------------------------------------------------------------------------------------


def decide(claim: Claim, model: Model, given: Iterable[str] = ()) -> Decision:
    """Return whether a claim holds on the solutions of a system, and under what else.

    ``given``: names of restrictions that hold; other names are passed over.
    """
    try:
        pairs = equations(claim, model)
        search = _Search(model, pairs, given_in(model, given), claim.kind == CONSTANT)
        if search.holds(()):
            return Decision(HOLDS)
        return search.weakest()
    except InputError as error:
        return Decision(UNDECIDED, reason=str(error))


def decide_within(
    claim: Claim, model: Model, names: Iterable[str], given: Iterable[str] = ()
) -> Decision:
    """Return whether a claim holds on the solutions of a system, at most under what ``names`` assume."""
    try:
        pairs = equations(claim, model)
        search = _Search(model, pairs, given_in(model, given), claim.kind == CONSTANT)
        if search.holds(()):
            return Decision(HOLDS)
        wanted = set(names)
        chosen = tuple(r for r in model.possible if r.name in wanted and r not in search.given)
        if chosen and search.holds(chosen) and not search.emptied(chosen):
            return Decision(UNDER, (tuple(r.name for r in chosen),))
        return Decision(WRONG)
    except InputError as error:
        return Decision(UNDECIDED, reason=str(error))


def given_in(model: Model, names: Iterable[str]) -> tuple[Restriction, ...]:
    """Return what is given of a system, with the restrictions that some names mean."""
    wanted = set(names)
    return (*model.given, *(r for r in model.possible if r.name in wanted))


@dataclass
class _Search:
    """What is tried for one claim; ``tests`` counts the sets."""

    model: Model
    pairs: list[tuple[Expr, Expr]]
    given: tuple[Restriction, ...]
    constant: bool
    tests: int = 0

    def weakest(self) -> Decision:
        """Return the verdict on what does not hold as it stands."""
        if not self._certain():
            why = "the functions in this are not decided exactly"
            return Decision(UNDECIDED, reason=why)
        possible = [r for r in self.model.possible if r not in self.given]
        sets = self._sets([r for r in possible if not r.rest])
        if sets:
            return Decision(UNDER, sets)
        rest = self._sets(possible, 2)
        told = [self._why(), *(f"it holds if {' and '.join(names)}" for names in rest[:1])]
        return Decision(WRONG, reason="; ".join(filter(None, told)))

    def _why(self) -> str:
        """Say what is wrong with the first equation that does not hold."""
        for pair in self.pairs:
            failing = (m for m in self._motions(()) if self._apart(m, *pair))
            apart = list(islice(failing, POINTS))
            if apart:
                with suppress(Singular, InputError):
                    found = leftover(self.model.system, pair, apart, self.given)
                    return "" if found is None else self._told(found)
                return ""
        return ""

    def _apart(self, motion: Motion, a: Expr, b: Expr) -> bool:
        try:
            return not _agree(motion, a, b)
        except Singular:
            return False

    def _told(self, found: Leftover) -> str:
        letters = {
            q.symbol: sp.Symbol(self.model.letter(n)) for n, q in self.model.quantities.items()
        }
        return found.words.format(str(found.term.xreplace(letters)).replace("**", "^"))

    def _sets(
        self, possible: list[Restriction], size: int = MAX_SET
    ) -> tuple[tuple[str, ...], ...]:
        found: list[tuple[str, ...]] = []
        for count in range(1, size + 1):
            for chosen in combinations(possible, count):
                names = tuple(r.name for r in chosen)
                if any(set(f) <= set(names) for f in found) or self.tests >= MAX_TESTS:
                    continue
                self.tests += 1
                if self.holds(chosen) and not self.emptied(chosen):
                    found.append(names)
        return tuple(found)

    def holds(self, chosen: tuple[Restriction, ...]) -> bool:
        """Tell whether all equations hold at some points that keep the restrictions."""
        count = 0
        try:
            for motion in self._motions(chosen):
                try:
                    agree = all(_agree(motion, a, b) for a, b in self.pairs)
                except Singular:
                    continue
                if not agree:
                    return False
                count += 1
                if count == POINTS:
                    return True
        except Inconsistent:
            return False
        if not chosen:
            raise InputError("the claim is undefined at every point that was drawn")
        return False

    def _motions(self, chosen: tuple[Restriction, ...]) -> Iterator[Motion]:
        orders = max((order(e) for pair in self.pairs for e in pair), default=0)
        if orders > MAX_ORDER:
            raise InputError("too many time derivatives", got=orders, expected=f"{MAX_ORDER}")
        return self.model.motions((*self.given, *chosen), max(orders + 1, LENGTH), TRIES)

    def _certain(self) -> bool:
        """Tell whether what differs in the field differs for real numbers."""
        system = self.model.system
        if not any(inexact(system, e) for pair in self.pairs for e in pair):
            return True
        return any(differs(system, a, b, self.given) for a, b in self.pairs)

    def emptied(self, chosen: tuple[Restriction, ...]) -> bool:
        """Tell whether something that the claim writes vanishes under a set alone."""
        parts = [p for pair in self.pairs for p in _parts(pair)]
        special = next(self._motions(chosen), None)
        general = next(self._motions(()), None)
        if special is None or general is None:
            return True
        return any(_zero(special, p) and not _zero(general, p) for p in parts)


def _agree(motion: Motion, a: Expr, b: Expr) -> bool:
    return (motion.series(a) - motion.series(b)).is_zero


def _zero(motion: Motion, part: Expr) -> bool:
    try:
        found: Series = motion.series(part)
    except Singular:
        return False
    return found.is_zero


def _parts(pair: tuple[Expr, Expr]) -> Iterator[Expr]:
    """Yield all that a pair writes; of an expression that is to be zero, not itself and its factors."""
    for this, other in (pair, pair[::-1]):
        if other == 0:
            for factor in sp.Mul.make_args(this):
                yield from _proper(factor)
        else:
            yield from _inside(this)


def _proper(factor: Expr) -> Iterator[Expr]:
    """Yield what a factor that is to be zero is made of; of the rate of a sum the rates of its terms."""
    inner = factor.args[0] if isinstance(factor, rate) else factor
    yield from (p for a in inner.args for p in _inside(a))
    summed = isinstance(factor, rate) and spread(inner) <= MAX_SPREAD
    terms = sp.Add.make_args(sp.expand_mul(inner)) if summed else ()
    yield from (rate(t) for t in terms if len(terms) > 1)


def _inside(expression: Expr) -> Iterator[Expr]:
    yield from (n for n in sp.preorder_traversal(expression) if not n.is_number)
