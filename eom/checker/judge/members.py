r"""Claims about what is derived of a system: members of its family, real numbers with many digits.

A member has random positive parameters. In it the particular motions are solved for that a claim speaks
of (`eom.checker.judge.particular`). What else stands in it has its value in that motion: ``\dot\phi``
beside ``\theta_0`` is the rate in the cone of that angle. Limits are values at 1e-36 from the goal.

Conditions may have several solutions. What holds in some of them alone is open: which one is meant is to
be said.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice, permutations
from typing import Any, ClassVar

import sympy as sp

from eom.checker.judge.coordinates import elements, equations, tells_time
from eom.checker.judge.models import ENOUGH, Cases, Drawn, Models, Search
from eom.checker.judge.particular import (
    EXACT,
    Point,
    Solver,
    drawn,
    eigenvalues,
    stiffness,
    struck,
    value_at,
)
from eom.checker.judge.systems import Pair, written_in
from eom.checker.mean.claims import Claim
from eom.checker.mean.model import DERIVED, FIRST, Model, Particular
from eom.errors import InputError
from eom.exact.numbers import MP, Number, met
from eom.fields import PRIME, RESIDUES, Singular, solve
from eom.system import Expr
from eom.terms.terms import Term
from eom.worlds.solutions import (
    Inconsistent,
    Motion,
    Placed,
    Restriction,
    approached,
    instant,
    rate,
    start,
)

NEAR, ROUGH = MP.mpf(10) ** -36, MP.mpf(10) ** -9
SEEDS, MOST = 12, 12


@dataclass
class AtInstants(Drawn, ABC):
    """Numbers for everything of a claim, at instants of motions."""

    models: Members

    def spelt(self, e: Expr) -> tuple[Expr, dict[Expr, Number]]:
        """Return an expression with symbols in the place of what is of an instant, and their values."""
        known: dict[Expr, Number] = {}

        def put(number: Number) -> Expr:
            symbol = sp.Dummy(real=True)
            known[symbol] = number
            return symbol

        def plain(e: Expr) -> Expr:
            if isinstance(e, approached):
                return put(self.approached(*e.args))
            if isinstance(e, start) and len(self.models.labels) == 1:
                return put(self.then(e.args[0], self.models.labels[0] + FIRST))
            if isinstance(e, instant):
                return put(self.then(e.args[0], str(e.args[1]).partition("@")[2]))
            if e.is_Symbol and "@" in e.name:
                return self.noted(put(self.derived(*e.name.split("@"))), *e.name.split("@"))
            return e.func(*map(plain, e.args)) if e.args else e

        return sp.sympify(plain(e), strict=True), known

    def derived(self, name: str, label: str) -> Number:
        """Return a quantity at an instant of a motion, or what is derived of the motion."""
        what, _, number = name.rpartition("_") if name[-1].isdigit() else (name, "", "")
        if what not in DERIVED or name in self.models.model.quantities:
            return self.then(self.models.model.symbol(name), label)
        return self.of_motion(what, int(number or 0), label)

    def noted(self, symbol: Expr, name: str, label: str) -> Expr:  # noqa: ARG002
        """Take down for which quantity at an instant a symbol stands, and return the symbol."""
        return symbol

    @abstractmethod
    def then(self, e: Expr, label: str) -> Number:
        """Return a value at an instant. Raises `InputError`, `Singular`."""

    @abstractmethod
    def of_motion(self, what: str, place: int, label: str) -> Number:
        """Return what is derived of a motion: the one of that number, 0 for the only one."""

    def approached(self, e: Expr, symbol: Expr, goal: Expr, side: Expr) -> Number:  # noqa: ARG002
        """Return a limit. Raises `InputError` where there is none."""
        raise InputError("no limit is known here", got=e)


@dataclass
class InField(AtInstants):
    """A member modulo a prime, in which repairs are looked for; ``here``: as of `Member`."""

    instants: Mapping[str, Motion]
    here: Motion
    impulses: tuple[int, ...] = ()
    turned: dict[Expr, int] = field(default_factory=dict)

    def noted(self, symbol: Expr, name: str, label: str) -> Expr:
        """Take down the tangent of the angle for which a symbol stands."""
        quantity = self.models.model.quantities.get(name)
        if quantity is not None and label in self.instants:
            motion = self.instants[label]
            motion.circle(quantity.symbol)
            self.turned[symbol] = motion.tangents[quantity.symbol]
        return symbol

    def agrees(self, said: Pair) -> bool:
        """Return whether two sides are the same number."""
        a, b = (self.value(e) for e in said)
        return a == b

    def values(self, term: Term) -> list[int] | None:
        """Return the values of a scalar, or of all elements."""
        models = self.models
        try:
            found = elements(term, models.scalars, models.model)
            return [self.value(e) for e in found]
        except (InputError, Singular, KeyError):
            return None

    def value(self, e: Expr) -> int:
        """Return the value of an expression. Raises `Singular`, `InputError`."""
        spelt, known = self.spelt(e)
        self.here.given |= {s: self.here.constant(v) for s, v in known.items()}
        self.here.tangents |= {s: t for s, t in self.turned.items() if s in known}
        return int(self.here.series(spelt).coefficients[0])

    def then(self, e: Expr, label: str) -> int:
        """Return a value at an instant."""
        if label not in self.instants:
            raise InputError("an instant that is not known here", got=label)
        return int(self.instants[label].series(e).coefficients[0])

    def of_motion(self, what: str, place: int, label: str) -> int:
        """Return an impulse, or the only frequency, as the root of its square."""
        if what == "impulse" and len(self.impulses) >= max(place, 1):
            return self.impulses[max(place - 1, 0)]
        if what not in {"frequency", "period", "cycles"} or place > 1:
            raise InputError("this has no value in a field", got=what)
        motion = self.instants[label]
        found = RESIDUES.root(stiffness(self.models.model.system, motion))
        turn = motion.series(2 * sp.pi).coefficients[0]
        if what == "cycles":
            return int(found * RESIDUES.inverse(turn) % PRIME)
        return int(found if what == "frequency" else turn * RESIDUES.inverse(found) % PRIME)


@dataclass
class Member(AtInstants):
    """Real numbers; ``here``: where all stands that is of no particular motion."""

    instants: Mapping[str, Point]
    here: Point
    numbered: int = 0

    def agrees(self, said: Pair) -> bool:
        """Return whether two sides are the same number."""
        a, b = (self.value(e) for e in said)
        return self.models.equal(a, b)

    def value(self, e: Expr) -> Number:
        """Return the value of an expression. Raises `Singular`, `InputError` where it has none."""
        spelt, known = self.spelt(e)
        point = replace(self.here, others={**self.here.others, **known})
        return value_at(point.motion(self.models.model.system, self.models.length), spelt)

    def case(self, e: Expr) -> tuple[Expr, int]:
        """Return an expression with the number of the case that applies. Raises `Singular` for none."""
        for k, (_, condition) in enumerate(e.args):
            if met(condition, self.value):
                return e, k
        raise Singular

    def _point(self, label: str) -> Point:
        if label not in self.instants:
            raise InputError("an instant that is not known here", got=label)
        return self.instants[label]

    def then(self, e: Expr, label: str) -> Number:
        """Return a value at an instant."""
        point = self._point(label)
        return value_at(point.motion(self.models.model.system, self.models.length), e)

    def of_motion(self, what: str, place: int, label: str) -> Number:
        """Return the time, an impulse, or one of the modes of a motion."""
        point = self._point(label)
        if what == "t":
            return point.others[self.models.model.system.time]
        found = point.impulses if what == "impulse" else self._modes(what, point)
        if len(found) > 1 and not place and what == "eigenvalue":
            return found[self.numbered % len(found)]
        if not found or place > len(found):
            raise Singular
        if len(found) > 1 and not place:
            wanted = f"{what} 1, slowest first"
            raise InputError(f"more than one {what} is there", got=len(found), expected=wanted)
        return found[max(place - 1, 0)]

    def _modes(self, what: str, point: Point) -> Sequence[Number]:
        known = self.models.model.drawn
        if id(point) not in known:
            known[id(point)] = point, eigenvalues(self.models.model.system, point)
        values = known[id(point)][1]
        if what == "eigenvalue":
            return sorted(values, key=lambda v: (abs(v), v.real, v.imag))
        turning = sorted(v.imag for v in values if v.imag > EXACT)
        if what == "cycles":
            return [w / (2 * MP.pi) for w in turning]
        return turning if what == "frequency" else [2 * MP.pi / w for w in turning]

    def approached(self, e: Expr, symbol: Expr, goal: Expr, side: Expr) -> Number:
        """Return the value near the goal of a limit. Raises `InputError` where there is none."""
        found = []
        for near in (NEAR, NEAR**2 * 100):
            value = 1 / near if goal == sp.oo else self.value(goal) + int(side) * near
            found.append(self.models.near(self, symbol, value).value(e))
        if abs(found[0] - found[1]) > ROUGH * max(1, abs(found[0])):
            raise InputError("this goes to no limit")
        return found[0]


@dataclass(frozen=True)
class Members(Models):
    """Members of the family of the system that a claim is about; names are those of special cases."""

    undefined: ClassVar[str] = "no such motion was found, or the claim has no value in it"

    @property
    def model(self) -> Model:
        """The system with its particular motions."""
        assert self.claim.model is not None
        return self.claim.model

    @cached_property
    def said(self) -> tuple[Pair, ...]:
        """The expressions that the claim says are equal."""
        return tuple(equations(self.claim, self.model))

    @property
    def order(self) -> Iterable[str]:
        """What may be assumed besides."""
        return tuple(self.possible)

    @cached_property
    def possible(self) -> Mapping[str, Restriction]:
        """Kinds of a blow, absent loads, angles at zero, by name: none that the claim writes."""
        named = {s for n in self.labels for s in self.model.particular[n].cases}
        found = (r for r in self.model.cases(named) if not r.symbols & self._named)
        return {r.name: r for r in found}

    @cached_property
    def length(self) -> int:
        """How many coefficients a solution needs."""
        rates = [
            sum(isinstance(n, rate) for n in sp.preorder_traversal(e)) for p in self.said for e in p
        ]
        return 3 + max(rates, default=0)

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """The motions that the claim speaks of, in the order in which they are solved for."""
        return tuple(n for n in self.model.particular if n in spoken(self.claim, self.model))

    @cached_property
    def slack(self) -> Number:
        """By how much two sides may differ."""
        rough = any(self.model.particular[n].until is not None for n in self.labels)
        limits = any(e.has(approached) for p in self.said for e in p)
        return ROUGH if rough or limits else EXACT

    def equal(self, a: Number, b: Number) -> bool:
        """Return whether two numbers are the same as far as they are known."""
        return bool(abs(a - b) <= self.slack * max(1, abs(a), abs(b)))

    def draw(self, names: frozenset[str]) -> Iterator[Member]:
        """Yield members, with all solutions for the motions that are spoken of."""
        return islice(self._drawn(names), MOST)

    def _drawn(self, names: frozenset[str]) -> Iterator[Member]:
        values = {s: MP.mpf(v) for n in names for s, v in self.possible[n].values.items()}
        for seed in range(SEEDS):
            key = (self.labels, seed, names)
            if key not in self.model.drawn:
                begun = self._solved(
                    drawn(self.model, seed).moved(values), self.labels, frozenset(values)
                )
                self.model.drawn[key] = list(islice(begun, ENOUGH))
            for number, (point, instants) in enumerate(self.model.drawn[key]):
                yield Member(
                    names, seed, self, instants, self._here(point, instants), seed + number
                )

    def _solved(
        self,
        point: Point,
        labels: Sequence[str],
        fixed: frozenset[Expr] = frozenset(),
        moved: Expr = None,
    ) -> Iterator[tuple[Point, dict[str, Point]]]:
        """Yield points with the instants of motions, one motion after the other."""
        if not labels:
            yield point, {}
            return
        name, *rest = labels
        for found in Solver(self.model, self.model.particular[name], fixed, moved).solutions(point):
            now = point.moved(found[FIRST].parameters)
            named = {f"{name}{end}": at for end, at in found.items()}
            for last, others in self._solved(now, rest, fixed | {*point.parameters}, moved):
                yield last, {**named, **others}

    def _here(self, point: Point, instants: Mapping[str, Point]) -> Point:
        """Return where everything stands that is of no instant: in the motion that is spoken of."""
        if len(self.labels) != 1:
            return point
        (name,) = self.labels
        motion, last = self.model.particular[name], instants[name]
        if self._changes:
            return last
        if motion.until is None:
            return instants[f"{name}{FIRST}"]
        part = float(last.others[self.model.system.time]) * 0.37
        return Solver(self.model, motion).until(instants[f"{name}{FIRST}"], None, part)

    def near(self, member: Member, symbol: Expr, value: Number) -> Member:
        """Return a member near another where a parameter, or a value in a motion, is given.

        All else stays that the claim names; what is derived of the motion moves with it.
        """
        name, _, label = str(symbol).partition("@")
        label = label or "".join(self.labels[:1])
        first = member.instants.get(label, member.here)
        own = self.model.symbol(name) if "@" in str(symbol) else symbol
        point = first.moved({own: value})
        if not self.labels:
            return replace(member, here=point)
        fixed = frozenset({own, *first.parameters, *(self._named & first.states.keys())})
        for moved, instants in self._solved(point, self.labels, fixed, own):
            return replace(member, instants=instants, here=self._here(moved, instants))
        raise Singular

    @cached_property
    def _named(self) -> frozenset[Expr]:
        """The symbols that stand in the claim, those at instants where no limit is taken."""
        outside = [_without_limits(e) for pair in self.said for e in pair]
        derived = (
            s.name.partition("@")[0] for e in outside for s in e.free_symbols if "@" in s.name
        )
        known = (n for n in derived if n in self.model.quantities)
        plain = (s for pair in self.said for e in pair for s in e.free_symbols)
        return frozenset({*plain, *map(self.model.symbol, known)})

    @cached_property
    def _by_cases(self) -> tuple[Expr, ...]:
        """The expressions by cases in the claim."""
        return tuple({p: None for pair in self.said for e in pair for p in e.atoms(sp.Piecewise)})

    def cases(self, names: frozenset[str]) -> Cases | None:
        """Return what is found of a claim by cases, which say which of several motions they mean."""
        if not self._by_cases:
            return None
        found: list[tuple[int, bool, Any]] = []
        for seed in range(SEEDS):
            with suppress(Singular, ZeroDivisionError):
                found += self._as_claimed(names, seed)
        if len(found) < ENOUGH:
            raise InputError(self.undefined)
        return tuple(found)

    def _as_claimed(self, names: frozenset[str], seed: int) -> Iterator[tuple[int, bool, Any]]:
        """Yield whether motions begin where the claim says, and which case applied."""
        values = {s: MP.mpf(v) for n in names for s, v in self.possible[n].values.items()}
        point = drawn(self.model, seed).moved(values)
        own = Member(names, seed, self, {}, point, seed)
        pairs = [pair for said in self.said for pair in permutations(said)]
        claimed = [(s.name.partition("@")[0], e) for s, e in pairs if s.is_Symbol and "@" in s.name]
        if len(self.labels) != 1 or len(claimed) != len(self.said):
            raise InputError("no values are known here of what its cases say")
        applied = tuple(map(own.case, self._by_cases))
        numbers = {self.model.symbol(name): own.value(e) for name, e in claimed}
        if any(MP.im(v) for v in numbers.values()):
            yield seed, False, applied
            return
        begun = self._solved(point.moved(numbers), self.labels, frozenset(point.parameters))
        members = [
            Member(names, seed, self, instants, self._here(at, instants), seed)
            for at, instants in islice(begun, ENOUGH)
        ]
        if members:
            yield seed, any(all(map(m.agrees, self.said)) for m in members), applied

    @property
    def _changes(self) -> bool:
        """Whether the claim has a change between the instants of its motion."""
        return any(e.has(start) for pair in self.said for e in pair)

    def _powers(self) -> Iterator[Expr]:
        """Yield powers with rational exponents, and magnitudes."""
        for e in (e for pair in self.said for e in pair):
            yield from e.atoms(sp.Abs)
            yield from (p for p in e.atoms(sp.Pow) if p.exp.is_Rational)

    def levels(self, terms: Sequence[Term]) -> Iterator[tuple[Drawn, Drawn]]:
        """Yield a member modulo a prime where terms have values, of one motion that is steady or a blow."""
        if len(self.labels) == 1:
            with suppress(InputError):
                fields = self._fields(self.labels[0])
                fit = (m for m in fields if all(m.number(t) is not None for t in terms))
                yield from ((m, m) for m in islice(fit, 1))

    def _fields(self, name: str) -> Iterator[InField]:
        """Yield members modulo a prime; none for motions that linear equations do not give there."""
        m, model = self.model.particular[name], self.model
        symbols = {q.symbol for q in model.system.states}
        if m.until is not None or (m.is_blow and m.zero) or not symbols.issuperset(m.zero):
            return
        own = Restriction(f"in {name}", zero=m.zero, held=m.constant)
        kept = (*model.given, own) if m.zero or m.constant else model.given
        with suppress(Inconsistent):
            for first in model.motions(kept, self.length, SEEDS):
                with suppress(Singular):
                    begun = _placed(
                        first, {s: int(first.series(e).coefficients[0]) for s, e in m.start.items()}
                    )
                    if any(begun.series(e).is_zero for e in m.nonzero):
                        continue
                    last, impulses = _behind(model, m, begun)
                    instants = {f"{name}{FIRST}": begun, name: last}
                    here = last if self._changes else begun
                    yield InField(frozenset(), first.seed, self, instants, here, impulses)

    def smallest(self, search: Search, base: frozenset[str]) -> Iterator[frozenset[str]]:
        """Yield special cases one by one."""
        yield from (base | {n} for n in self.possible if search.counts(base | {n}))

    def empties(self, names: frozenset[str]) -> bool:
        """Return whether something that the claim writes vanishes in a special case alone."""
        special, general = (next(self.draw(n), None) for n in (names, frozenset[str]()))
        if special is None or general is None:
            return True
        written = [p for pair in self.said for p in written_in(pair)]
        return any(self._zero(special, p) and not self._zero(general, p) for p in written)

    def _zero(self, member: Member, part: Expr) -> bool:
        try:
            return self.equal(member.value(part), MP.mpf(0))
        except (InputError, Singular):
            return False

    def doubt(self) -> str:
        """Say that the claim holds in some of the motions that fit what is said of it."""
        cases = self.cases(frozenset())
        if cases is not None:
            return self.branch(cases)
        verdicts, turned = set(), set()
        for member in islice(self.draw(frozenset()), 2 * ENOUGH):
            with suppress(Singular, InputError):
                sides = [(member.value(a), member.value(b)) for a, b in self.said]
                verdicts.add(all(self.equal(a, b) for a, b in sides))
                turned.add(all(self.equal(-a, b) for a, b in sides))
        rooted = any(isinstance(p, sp.Abs) or p.exp.q == 2 for p in self._powers())
        if verdicts == {False}:
            signs = (
                "this rests on the sign of a root"
                if rooted
                else "whether it grows or shrinks is open"
            )
            return signs if (rooted or self._changes) and turned == {True} else ""
        motions = ", ".join(self.labels)
        few = "too few such motions were found"
        return (
            f"it holds in some motions that {motions} may mean: say which"
            if len(verdicts) > 1
            else few
        )


def _placed(motion: Motion, values: Mapping[Expr, int]) -> Motion:
    """Return the solution through the point of another one with other values of some states."""
    start = {**motion.start, **values}
    known = {s: v for s, v in motion.given.items() if s not in start}
    system, length = motion.system, motion.length
    return Placed(
        system,
        length,
        motion.seed,
        (),
        known,
        start,
        tangents=motion.tangents,
        values=motion.values,
    )


def _behind(model: Model, m: Particular, first: Motion) -> tuple[Motion, tuple[int, ...]]:
    """Return the motion behind a blow modulo a prime, and its impulses."""
    if not m.is_blow:
        return first, ()

    def value(e: Expr, n: int = 0) -> int:
        return int(first.series(sp.sympify(e, strict=True)).coefficients[n])

    jumps, impulses = struck(model, m, value, lambda rows, wanted: solve(rows, wanted, RESIDUES))
    after = {s: (first.start[s] + d) % PRIME for s, d in jumps.items()}
    return _placed(first, after), impulses


def _without_limits(e: Expr) -> Expr:
    return (
        sp.S.Zero
        if isinstance(e, approached)
        else e.func(*map(_without_limits, e.args))
        if e.args
        else e
    )


def spoken(claim: Claim, model: Model) -> frozenset[str]:
    """Return the names of the particular motions that a claim speaks of."""
    found: set[str] = set()
    begun = [n for n, m in model.particular.items() if m.start and m.until is not None]
    if tells_time(claim, model) and len(begun) == 1:
        found |= {*begun}
    with suppress(InputError):
        pairs = equations(claim, model)
        for e in (e for pair in pairs for e in pair):
            labels = {s.name.partition("@")[2] for s in e.free_symbols if "@" in s.name}
            found |= {label.removesuffix(FIRST) for label in labels}
            found |= {model.starting[s] for s in e.free_symbols if s in model.starting}
    return frozenset(found)


def of_members(claim: Claim) -> bool:
    """Return whether a claim is about what is derived of a system: particular motions, limits."""
    model = claim.model
    if model is None:
        return False
    with suppress(InputError):
        limits = any(e.has(approached) for pair in equations(claim, model) for e in pair)
        return limits or bool(spoken(claim, model))
    return False
