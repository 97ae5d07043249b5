r"""Claims about what is derived of a system: members of its family, real numbers with many digits.

A member has random positive parameters. In it the particular motions are solved for that a claim speaks
of (`eom.checker.mean.model.Particular`): a steady one by Newton's steps from random starts onto its
conditions, the end of another by integration from its start, speeds behind a blow from momenta and gaps.
What else stands in the claim has its value in that motion: ``\dot\phi`` beside ``\theta_0`` is the rate in
the cone of that angle. Frequencies are those of the linearised rates, limits values at 1e-36 from the goal.

Conditions may have several solutions. What holds in some of them alone is open: which one is meant is to
be said.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice
from typing import Any, ClassVar

import sympy as sp
from mpmath import MPContext, fp

from eom.checker.judge.coordinates import PLACES
from eom.checker.judge.models import ENOUGH, Drawn, Models, Search
from eom.checker.judge.systems import Pair, equations, tells_time
from eom.checker.mean.claims import Claim
from eom.checker.mean.model import DERIVED, FIRST, Model, Particular
from eom.errors import InputError
from eom.exact.rings import Row, arguments
from eom.exact.series import Series
from eom.fields import Field, Singular
from eom.system import Expr, System
from eom.worlds.solutions import INVERSES, Motion, approached, instant, integrated, rate, start

DIGITS = 120
MP = MPContext()
MP.dps = DIGITS
STEP, DONE = MP.mpf(10) ** -40, MP.mpf(10) ** -70
NEAR, EXACT, ROUGH = MP.mpf(10) ** -36, MP.mpf(10) ** -25, MP.mpf(10) ** -9
SEEDS, MOST = 12, 12
LEAST = MP.mpf(10) ** -3
"""What parameters are at least, and expressions that do not vanish."""
ORDER, STEPS, SLACK = 12, 400, 1e-13

Number = Any
Values = Mapping[Expr, Number]


@dataclass(frozen=True)
class Reals(Field):
    """Numbers of mpmath to the digits of a context, as a field."""

    prime: int = 0
    context: Any = MP

    @property
    def is_rational(self) -> bool:
        """Whether elements are fractions."""
        return False

    def of(self, numerator: Any, denominator: int = 1) -> Number:
        """Return a fraction."""
        return self.context.mpf(numerator) / denominator

    def inverse(self, value: Number) -> Number:
        """Return the reciprocal; raises `Singular` for zero."""
        if not value:
            raise Singular
        return 1 / self.context.convert(value)

    def root(self, value: Number) -> Number:
        """Return the square root, imaginary of what is negative; raises `Singular` for zero."""
        if not value:
            raise Singular
        return self.context.sqrt(value)


_FUNCTIONS = (*INVERSES, sp.exp, sp.sinh, sp.cosh, sp.tanh)


@dataclass
class Real(Motion):
    """A solution through a point: states, parameters and inputs are ``start`` and ``given``."""

    numbers: ClassVar[Reals] = Reals()

    def begin(self) -> None:
        """Find the solution; inputs and parameters are constant."""
        number = self.numbers.context.convert
        self.given = {s: self.constant(number(v)) for s, v in self.given.items()}
        self.start = {s: number(v) for s, v in self.start.items()}
        time = self.given[self.system.time].coefficients[0]
        self.given[self.system.time] = Series(
            self.numbers, (time, 1, *[0] * self.length)[: self.length]
        )
        self.solve()

    def circle(self, half: Expr) -> tuple[Number, Number]:
        """Return cosine and sine at t = 0 of half an angle."""
        value = self.series(half).coefficients[0] / 2
        return self.numbers.context.cos(value), self.numbers.context.sin(value)

    def value_of(self, key: Expr) -> Number:
        """Return the value at t = 0 of a function or a constant."""
        if not key.args:
            return self.numbers.context.mpf(str(key.evalf(DIGITS)))
        function = getattr(self.numbers.context, type(key).__name__)
        return function(*(self.series(a).coefficients[0] for a in key.args))

    def root(self, node: Expr) -> Series:
        """Return any power of a positive number; the square root of any."""
        base, exponent = node.as_base_exp()
        if exponent.is_Rational and exponent.q == 2:
            return super().root(node)
        return self.series(sp.exp(exponent * sp.log(base)))


def _size(_: Motion, __: Expr, values: list[Series]) -> Series:
    return values[0] if values[0].coefficients[0] >= 0 else -values[0]


_ROWS = dict.fromkeys(_FUNCTIONS, Row(arguments, integrated)) | {sp.Abs: Row(arguments, _size)}
Real.rows = {**Motion.rows, **_ROWS}


class Double(Real):
    """A solution in double precision, for steps in time."""

    numbers: ClassVar[Reals] = Reals(context=fp)


# -- points of particular motions ----------------------------------------------------------------------


@dataclass(frozen=True)
class Point:
    """Values of states, inputs and time, and of parameters; ``impulses``: of gaps, in a blow."""

    states: Values
    others: Values
    parameters: Values
    impulses: tuple[Number, ...] = ()

    def motion(self, system: System, length: int = 3, kind: type[Real] = Real) -> Real:
        """Return the solution through the point. Raises `Singular`."""
        try:
            return kind(
                system, length, 0, (), {**self.parameters, **self.others}, dict(self.states)
            )
        except ZeroDivisionError:
            raise Singular from None

    def moved(self, values: Values) -> Point:
        """Return the point with other values of some symbols."""

        def new(group: Values) -> Values:
            return {s: values.get(s, v) for s, v in group.items()}

        return Point(new(self.states), new(self.others), new(self.parameters))


def drawn(model: Model, seed: int) -> Point:
    """Return a random point: parameters positive, states of any sign, no second rates of given motions."""
    s, generator = model.system, random.Random(seed)  # noqa: S311 - reproducible, no secret

    def number(low: float, high: float) -> Number:
        return MP.mpf(generator.randint(int(low * 10**6), int(high * 10**6))) / 10**6

    wide = {q.symbol: 3 if q.unit == "rad" else 1.5 for q in s.states}
    held = {q.symbol: MP.mpf(0) for q in s.inputs if q.name.endswith("_ddot")}
    point = Point(
        {q: number(-w, w) for q, w in wide.items()},
        {**{q.symbol: number(0.4, 2.4) for q in s.inputs}, **held, s.time: MP.mpf(0)},
        {q.symbol: number(0.4, 2.4) for q in s.parameters},
    )
    zero = {z: MP.mpf(0) for r in model.given for z in r.zero}
    zero |= {model.symbol(f"{name}_dot"): MP.mpf(0) for name in _loads(s)}
    equal = {b: point.parameters[a] for r in model.given for a, b in r.equal}
    return point.moved({**zero, **equal})


def _loads(system: System) -> list[str]:
    """Return the names of states that are loads which are given as functions of time, no motions."""
    given = {name.removesuffix("_ddot") for name in system.input_names if name.endswith("_ddot")}
    return [q.name for q in system.states if q.name in given and q.unit not in PLACES]


def _value(motion: Real, e: Expr, order: int = 0) -> Number:
    return motion.series(e).coefficients[order] if e.args or e.is_Symbol else motion.numbers.of(e)


Rule = Callable[[Point, type[Real]], Sequence[Number]]


@dataclass(frozen=True)
class Phase:
    """Newton's steps with one kind of numbers: how many, differences, residuals where they end."""

    kind: type[Real]
    steps: int
    apart: Number
    done: Number


PHASES = (Phase(Double, 16, 1e-6, 1e-9), Phase(Real, 10, STEP, DONE))


def onto(point: Point, rule: Rule, free: Sequence[Expr]) -> Point | None:
    """Move some values of a point by Newton's steps of least size until a rule gives zeros; None if not."""
    for phase in PHASES:
        try:
            found = _newton(point, rule, free, phase)
        except (Singular, ZeroDivisionError, OverflowError):
            return None
        if found is None:
            return None
        point = found
    return point


def _newton(point: Point, rule: Rule, free: Sequence[Expr], phase: Phase) -> Point | None:
    for _ in range(phase.steps):
        values = {**point.states, **point.parameters}
        now = list(rule(point, phase.kind))
        columns = []
        for s in free:
            there = rule(point.moved({s: values[s] + phase.apart}), phase.kind)
            columns.append([(b - a) / phase.apart for a, b in zip(now, there, strict=True)])
        sizes = [max((abs(c[k]) for c in columns), default=0) for k in range(len(now))]
        if all(abs(v) <= phase.done * (size or 1) for v, size in zip(now, sizes, strict=True)):
            return point
        step = _least(columns, now, sizes)
        longest = max(map(abs, step), default=0)
        if not longest or not MP.isfinite(longest):
            return None
        scale = min(1, 1 / longest)
        point = point.moved({s: values[s] - scale * d for s, d in zip(free, step, strict=True)})
    return None


def _least(columns: list[list[Number]], wanted: list[Number], sizes: list[Number]) -> list[Number]:
    """Return the smallest step that a Jacobian, by columns, maps to what is wanted; sizes of its rows."""
    if not columns:
        return []
    rows = [[c[k] / (size or 1) for c in columns] for k, size in enumerate(sizes)]
    J = MP.matrix(rows)
    square = J * J.T
    for k in range(square.rows):
        square[k, k] += STEP
    scaled = [w / (size or 1) for w, size in zip(wanted, sizes, strict=True)]
    return list(J.T * MP.lu_solve(square, MP.matrix(scaled)))


@dataclass(frozen=True)
class Solver:
    """A particular motion of a system; ``fixed``: symbols whose values stay; ``moved``: near a limit."""

    model: Model
    motion: Particular
    fixed: frozenset[Expr] = frozenset()
    moved: Expr = None

    def solutions(self, point: Point) -> Iterator[dict[str, Point]]:
        """Yield the instants of such motions near a point: "" the last, `FIRST` the first one."""
        tried: list[Values] = []
        for free in self._choices(point):
            with suppress(Singular, ZeroDivisionError):
                first = onto(self._begun(point), self._apart, free)
                if first is None or not self._is_proper(first):
                    continue
                first = self._upright(first)
                values = {**first.states, **first.parameters}
                if any(all(abs(values[s] - t[s]) < EXACT for s in values) for t in tried):
                    continue
                tried.append(values)
                yield {FIRST: first, "": self._last(first)}

    def _choices(self, point: Point) -> Iterator[list[Expr]]:
        """Yield what moves: what is not said to be constant, that and parameters, all states."""
        said = {*self.motion.constant, *self.motion.start} | self.fixed
        states, parameters = list(point.states), list(point.parameters)
        yield [s for s in states if s not in said]
        if not parameters or parameters[0] not in self.fixed:
            yield [s for s in (*states, *parameters) if s not in said]
        yield [s for s in states if s not in {*self.motion.start} | self.fixed]

    def _begun(self, point: Point) -> Point:
        """Return a point with the values that the motion starts with."""
        if not self.motion.start:
            return point
        here = point.motion(self.model.system, 1)
        return point.moved({s: _value(here, e) for s, e in self.motion.start.items()})

    def _apart(self, point: Point, kind: type[Real] = Real) -> list[Number]:
        """Return what is zero in such a motion."""
        m, system = self.motion, self.model.system
        begun = self._begun(point)
        off = [begun.states[s] - point.states[s] for s in m.start if s in point.states]
        here = begun.motion(system, 3, kind)
        places = {q.symbol for q, r in zip(system.states, system.rates, strict=True) if r.is_Symbol}
        steady = [_value(here, c, n) for c in m.constant for n in (1, 2)[: 1 + (c in places)]]
        elsewhere = m.zero and (m.is_blow or m.until is not None)
        last = self._last(begun).motion(system, 1, kind) if elsewhere else here
        return [*off, *steady, *(_value(last, z) for z in m.zero)]

    def _is_proper(self, point: Point) -> bool:
        last = self._last(point).motion(self.model.system)
        positive = all(v > LEAST for s, v in point.parameters.items() if s != self.moved)
        apart = (e for e in self.motion.nonzero if self.moved not in e.free_symbols)
        return positive and all(abs(_value(last, e)) > LEAST for e in apart)

    def _upright(self, point: Point) -> Point:
        """Return the motion with positive values in the place of those that may have either sign."""
        for s, v in point.states.items():
            if v < 0 and s not in self.fixed:
                other = point.moved({s: -v})
                with suppress(Singular, ZeroDivisionError):
                    if max(map(abs, self._apart(other)), default=0) < EXACT and self._is_proper(
                        other
                    ):
                        point = other
        return point

    def _last(self, first: Point) -> Point:
        if self.motion.is_blow:
            return self._struck(first)
        return first if self.motion.until is None else self.until(first, self.motion.until)

    def until(self, point: Point, end: Expr | None, seconds: float = 0) -> Point:
        """Return where an expression vanishes for the first time after the start, or after some seconds.

        Raises `Singular` where it does not.
        """
        system, time, before = self.model.system, 0.0, None
        now = {s: float(v) for s, v in point.states.items()}
        for _ in range(STEPS):
            given = {**point.parameters, **point.others, system.time: time}
            motion = Double(system, ORDER, 0, (), given, dict(now))
            series = {s: motion.given[s].coefficients for s in now}
            step = _step(series.values())
            if end is None:
                step = min(step, seconds - time)
            else:
                watched = motion.series(end).coefficients
                before = _at(watched, step / 16) if before is None else before
                if _at(watched, step) * before <= 0:
                    step, end, seconds = _crossing(watched, step, before), None, 0
            now = {s: _at(c, step) for s, c in series.items()}
            time += step
            if end is None and time >= seconds:
                reached = {s: MP.mpf(v) for s, v in now.items()}
                return point.moved({**reached, system.time: MP.mpf(time)})
        raise Singular

    def _struck(self, first: Point) -> Point:
        """Return the point behind a blow: momenta jump by impulses, gaps open as restitution says."""
        m, model, here = self.motion, self.model, first.motion(self.model.system)
        places = [model.symbol(q) for q in model.coordinates]
        speeds = [model.symbol(f"{q}_dot") for q in model.coordinates]
        outputs = {d.quantity.name: d.expression for d in model.system.outputs}
        n, k = len(places), len(m.closing)
        rows = MP.zeros(n + k)
        for i, q in enumerate(model.coordinates):
            for j, v in enumerate(speeds):
                rows[i, j] = _value(here, outputs[f"p_{q}"].diff(v))
        for i, gap in enumerate(m.closing):
            for j, q in enumerate(places):
                slope = _value(here, gap.diff(q))
                rows[n + i, j], rows[j, n + i] = slope, -slope
        bounce = 1 + _value(here, m.restitution)
        blows = [_value(here, m.blows.get(q, sp.S.Zero)) for q in places]
        wanted = [*blows, *(-bounce * _value(here, gap, 1) for gap in m.closing)]
        found = list(MP.lu_solve(rows, MP.matrix(wanted)))
        after = {s: first.states[s] + d for s, d in zip(speeds, found, strict=False)}
        return replace(first.moved(after), impulses=tuple(found[n:]))


def _at(coefficients: Sequence[Number], t: Number) -> Number:
    return sum(c * t**k for k, c in enumerate(coefficients))


def _step(series: Iterable[Sequence[float]]) -> float:
    """Return how far the last terms of series stay small."""
    ends = (ORDER - 2, ORDER - 1)
    last: list[float] = [(abs(c[n]) / SLACK) ** (1 / n) for c in series for n in ends]
    return min(0.5, 1 / max([*last, 1e-3]))


def _crossing(coefficients: Sequence[float], step: float, before: float) -> float:
    low, high = 0.0, step
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if _at(coefficients, middle) * before > 0 else (low, middle)
    return high


# -- members -------------------------------------------------------------------------------------------


@dataclass
class Member(Drawn):
    """Numbers for everything of a claim; ``here``: where all stands that is of no particular motion."""

    models: Members
    instants: Mapping[str, Point]
    here: Point
    numbered: int = 0

    def agrees(self, said: Pair) -> bool:
        """Return whether two sides are the same number."""
        a, b = (self.value(e) for e in said)
        return bool(abs(a - b) <= self.models.slack * max(1, abs(a), abs(b)))

    def value(self, e: Expr) -> Number:
        """Return the value of an expression. Raises `Singular`, `InputError` where it has none."""
        known: dict[Expr, Number] = {}

        def put(number: Number) -> Expr:
            symbol = sp.Dummy(real=True)
            known[symbol] = number
            return symbol

        def plain(e: Expr) -> Expr:
            if isinstance(e, approached):
                return put(self._approached(*e.args))
            if isinstance(e, start) and len(self.models.labels) == 1:
                return put(self._then(e.args[0], self.models.labels[0] + FIRST))
            if isinstance(e, instant):
                return put(self._then(e.args[0], str(e.args[1]).partition("@")[2]))
            if e.is_Symbol and "@" in e.name:
                return put(self._derived(*e.name.split("@")))
            return e.func(*map(plain, e.args)) if e.args else e

        spelt = plain(e)
        point = replace(self.here, others={**self.here.others, **known})
        return _value(point.motion(self.models.model.system, self.models.length), sp.sympify(spelt))

    def _point(self, label: str) -> Point:
        if label not in self.instants:
            raise InputError("an instant that is not known here", got=label)
        return self.instants[label]

    def _then(self, e: Expr, label: str) -> Number:
        point = self._point(label)
        return _value(point.motion(self.models.model.system, self.models.length), e)

    def _derived(self, name: str, label: str) -> Number:
        """Return a quantity at an instant of a motion, or what is derived of the motion."""
        what, _, number = name.rpartition("_") if name[-1].isdigit() else (name, "", "")
        if what not in DERIVED or name in self.models.model.quantities:
            return self._then(self.models.model.symbol(name), label)
        point, place = self._point(label), int(number or 0)
        if what == "t":
            return point.others[self.models.model.system.time]
        found = point.impulses if what == "impulse" else self._modes(what, point)
        if len(found) > 1 and not place and what == "eigenvalue":
            return found[self.numbered % len(found)]
        if not found or place > len(found):
            raise Singular
        if len(found) > 1 and not place:
            wanted = f"{what} 1, slowest first"
            raise InputError(f"which {what} is not said", got=len(found), expected=wanted)
        return found[max(place - 1, 0)]

    def _modes(self, what: str, point: Point) -> Sequence[Number]:
        known = self.models.model.drawn
        if id(point) not in known:
            known[id(point)] = point, eigenvalues(self.models.model.system, point)
        values = known[id(point)][1]
        if what == "eigenvalue":
            return sorted(values, key=lambda v: (abs(v), v.real, v.imag))
        turning = sorted(v.imag for v in values if v.imag > EXACT)
        return turning if what == "frequency" else [2 * MP.pi / w for w in turning]

    def _approached(self, e: Expr, symbol: Expr, goal: Expr, side: Expr) -> Number:
        """Return the value near the goal of a limit. Raises `InputError` where there is none."""
        found = []
        for near in (NEAR, NEAR**2 * 100):
            value = 1 / near if goal == sp.oo else self.value(goal) + int(side) * near
            found.append(self.models.near(self, symbol, value).value(e))
        if abs(found[0] - found[1]) > ROUGH * max(1, abs(found[0])):
            raise InputError("this goes to no limit")
        return found[0]


def eigenvalues(system: System, point: Point) -> list[Number]:
    """Return the eigenvalues that are not zero of the rates linearised about a steady motion.

    Raises `Singular` where the motion is not steady.
    """
    states = list(point.states)
    base = [point.motion(system, 2).given[s].coefficients[1] for s in states]
    A = MP.zeros(len(states))
    for j, s in enumerate(states):
        ends = [point.moved({s: point.states[s] + d}).motion(system, 2) for d in (STEP, -STEP)]
        for i, r in enumerate(states):
            upper, lower = (m.given[r].coefficients[1] for m in ends)
            A[i, j] = (upper - lower) / (2 * STEP)
        if abs(base[j]) > EXACT and max(abs(A[i, j]) for i in range(len(states))) > EXACT:
            raise Singular
    found = MP.eig(A, left=False, right=False)
    return [MP.mpc(v) for v in found if abs(v) > EXACT]


@dataclass(frozen=True)
class Members(Models):
    """Members of the family of the system that a claim is about; nothing is assumed besides."""

    undefined: ClassVar[str] = "no such motion was found, or the claim has no value in it"
    order: ClassVar[Iterable[str]] = ()

    @property
    def model(self) -> Model:
        """The system with its particular motions."""
        assert self.claim.model is not None
        return self.claim.model

    @cached_property
    def said(self) -> tuple[Pair, ...]:
        """The expressions that the claim says are equal."""
        return tuple(equations(self.claim, self.model))

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

    def draw(self, names: frozenset[str]) -> Iterator[Member]:
        """Yield members, with all solutions for the motions that are spoken of."""
        return islice(self._drawn(names), MOST)

    def _drawn(self, names: frozenset[str]) -> Iterator[Member]:
        for seed in range(SEEDS):
            key = (self.labels, seed)
            if key not in self.model.drawn:
                self.model.drawn[key] = list(
                    islice(self._solved(drawn(self.model, seed), self.labels), ENOUGH)
                )
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

    @property
    def _changes(self) -> bool:
        """Whether the claim has a change between the instants of its motion."""
        return any(e.has(start) for pair in self.said for e in pair)

    def _powers(self) -> Iterator[Expr]:
        """Yield powers with rational exponents, and magnitudes."""
        for e in (e for pair in self.said for e in pair):
            yield from e.atoms(sp.Abs)
            yield from (p for p in e.atoms(sp.Pow) if p.exp.is_Rational)

    def smallest(self, search: Search, base: frozenset[str]) -> Iterator[frozenset[str]]:  # noqa: ARG002
        """Yield nothing: what is derived of a system holds or does not."""
        yield from ()

    def doubt(self) -> str:
        """Say that the claim holds in some of the motions that fit what is said of it."""
        verdicts, turned = set(), set()
        for member in islice(self.draw(frozenset()), 2 * ENOUGH):
            with suppress(Singular, InputError):
                verdicts.add(all(map(member.agrees, self.said)))
                turned.add(all(member.agrees((-a, b)) for a, b in self.said))
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
