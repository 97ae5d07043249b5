r"""Particular motions of a system: solved for near random points, in real numbers and modulo a prime.

A steady one is found by Newton's steps from a random start onto its conditions, the end of another by
integration from its start, speeds behind a blow from momenta and gaps. Frequencies are those of the
linearised rates.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import sympy as sp

from eom.checker.mean.model import FIRST, PLACES, Model, Particular
from eom.errors import InputError
from eom.exact.numbers import MP, Number
from eom.fields import PRIME, RESIDUES, Singular
from eom.system import Expr, System
from eom.worlds.solutions import (
    Double,
    Motion,
    Real,
)

STEP, DONE = MP.mpf(10) ** -40, MP.mpf(10) ** -70
EXACT = MP.mpf(10) ** -25
LEAST = MP.mpf(10) ** -3
"""What parameters are at least, and expressions that do not vanish."""
ORDER, STEPS, SLACK = 12, 400, 1e-13

Values = Mapping[Expr, Number]


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


def value_at(motion: Real, e: Expr, order: int = 0) -> Number:
    """Return the value of an expression in a motion, or of one of its coefficients in time."""
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
        if not parameters or not self.fixed.issuperset(parameters):
            yield [s for s in (*states, *parameters) if s not in said]
        yield [s for s in states if s not in {*self.motion.start} | self.fixed]

    def _begun(self, point: Point) -> Point:
        """Return a point with the values that the motion starts with."""
        if not self.motion.start:
            return point
        here = point.motion(self.model.system, 1)
        return point.moved({s: value_at(here, e) for s, e in self.motion.start.items()})

    def _apart(self, point: Point, kind: type[Real] = Real) -> list[Number]:
        """Return what is zero in such a motion."""
        m, system = self.motion, self.model.system
        begun = self._begun(point)
        off = [begun.states[s] - point.states[s] for s in m.start if s in point.states]
        here = begun.motion(system, 3, kind)
        places = {q.symbol for q, r in zip(system.states, system.rates, strict=True) if r.is_Symbol}
        steady = [value_at(here, c, n) for c in m.constant for n in (1, 2)[: 1 + (c in places)]]
        elsewhere = m.zero and (m.is_blow or m.until is not None)
        last = self._last(begun).motion(system, 1, kind) if elsewhere else here
        return [*off, *steady, *(value_at(last, z) for z in m.zero)]

    def _is_proper(self, point: Point) -> bool:
        last = self._last(point).motion(self.model.system)
        drawn = point.parameters.keys() - self.fixed - {self.moved}
        positive = all(point.parameters[s] > LEAST for s in drawn)
        apart = (e for e in self.motion.nonzero if self.moved not in e.free_symbols)
        return positive and all(abs(value_at(last, e)) > LEAST for e in apart)

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
        """Return the point behind a blow."""
        here = first.motion(self.model.system)

        def solved(rows: Rows, wanted: list[Number]) -> list[Number]:
            return list(MP.lu_solve(MP.matrix(rows), MP.matrix(wanted)))

        jumps, impulses = struck(
            self.model, self.motion, lambda e, n=0: value_at(here, e, n), solved
        )
        after = {s: first.states[s] + d for s, d in jumps.items()}
        return replace(first.moved(after), impulses=impulses)


Rows = list[list[Number]]


def struck(
    model: Model,
    m: Particular,
    value: Callable[..., Number],
    solved: Callable[[Rows, list[Number]], list[Number]],
) -> tuple[dict[Expr, Number], tuple[Number, ...]]:
    """Return the jumps of speeds in a blow, and the impulses of its gaps.

    Momenta jump by impulses, gaps open as restitution says; ``value``: of an expression before, or of its
    rate; ``solved``: of linear equations.
    """
    places = [model.symbol(q) for q in model.coordinates]
    speeds = [model.symbol(f"{q}_dot") for q in model.coordinates]
    momenta = {d.quantity.name: d.expression for d in model.system.outputs}
    slopes = [[value(gap.diff(q)) for q in places] for gap in m.closing]
    rows = [
        [value(momenta[f"p_{q}"].diff(v)) for v in speeds] + [-g[k] for g in slopes]
        for k, q in enumerate(model.coordinates)
    ]
    rows += [[*g, *(0 for _ in slopes)] for g in slopes]
    bounce = 1 + value(m.restitution)
    wanted = [value(m.blows.get(q, sp.S.Zero)) for q in places]
    found = solved(rows, [*wanted, *(-bounce * value(gap, 1) for gap in m.closing)])
    return dict(zip(speeds, found, strict=False)), tuple(found[len(speeds) :])


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


def stiffness(system: System, motion: Motion) -> int:
    """Return the square of the only frequency, from the characteristic polynomial (Faddeev, Leverrier)."""
    states = [q.symbol for q in system.states]
    if system.mass_matrix is not None:
        raise InputError("rates that are not explicit")
    rates = [system.expand(r) for r in system.rates]
    A = [[int(motion.series(r.diff(s)).coefficients[0]) for s in states] for r in rates]
    n, found = len(A), [1]
    B = [[int(i == j) for j in range(n)] for i in range(n)]
    for k in range(1, n + 1):
        product = [
            [sum(a * b[j] for a, b in zip(row, B, strict=True)) % PRIME for j in range(n)]
            for row in A
        ]
        found.append(-sum(product[i][i] for i in range(n)) * RESIDUES.inverse(k) % PRIME)
        B = [
            [(v + found[k] * (i == j)) % PRIME for j, v in enumerate(row)]
            for i, row in enumerate(product)
        ]
    while len(found) > 1 and not found[-1]:
        found.pop()
    if len(found) != 3 or found[1]:
        raise InputError("more than one frequency, or a damped one")
    return found[2]
