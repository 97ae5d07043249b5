"""Narrow features in loops that Python drives: what `codegen.watch.narrow` watches, over a library's steps.

The methods of SciPy and SUNDIALS are asked for one step after the other. Before each, time alone is looked
ahead of; after each, watched values are looked at along its own polynomial, and where they moved too far
the step is not taken, but begun again with a shorter one. Inputs that are Python functions are sampled at
the same places: what shows there and nowhere in the method's own calls makes the step shorter, too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from codegen.compiling.compiled import TARGETS, Compiled
from codegen.compiling.signals import Inputs
from codegen.frontend.layout import Layout
from codegen.ir.program import Program, SameObject
from codegen.loops.lookout import CROWDED
from codegen.native.trajectory import Array, Problem
from codegen.watch.narrow import AHEAD, MARGIN, VERDICT, WATCHED, Narrow, narrow
from eom.quantities import Quantity

PLACES = np.array([0.0, 0.079, 0.173, 0.286, 0.419, 0.547, 0.668, 0.791, 0.902, 1.0])
"""Where in a step watched values and inputs are looked at: apart by no simple ratio."""
WIDEST = 1 + np.diff(PLACES).max() / np.diff(PLACES).min()
"""How far bounds between places may be from the first value, over how far the values there are."""
LARGE = 200
"""Instructions from which watched values are compiled for the target of the rates, and not for NumPy."""
GROWTH = 20.0
"""How many times as long as the last one a step may be, as far as is looked ahead at first."""
FINEST = 2.0**-60
Dense = Callable[[Any], Array]


@dataclass(frozen=True)
class _Functions:
    """The programs of `Narrow` as functions of NumPy; ``f(t, x, p, u)``."""

    found: Narrow
    ahead: Any
    watched: Any
    verdict: Any
    shares: Array
    lengths: Array


@lru_cache(maxsize=64)
def _functions(key: SameObject[Compiled], moving: bool) -> _Functions:
    compiled = key.value
    found, layout = narrow(compiled.program, moving), compiled.layout
    rates, soon = len(layout.states), np.array(found.soon).reshape(-1, 2)
    return _Functions(
        found,
        _function(found.ahead, AHEAD, layout, 4, 2),
        _function(found.watched, WATCHED, layout, rates, rates + found.columns, compiled.target),
        _function(
            found.verdict, VERDICT, layout, 3 * found.columns + 1, found.guards + found.pieces
        ),
        soon[:, 0],
        soon[:, 1],
    )


def _function(
    program: Program | None,
    group: str,
    layout: Layout,
    states: int,
    count: int,
    target: str = "numpy",
) -> Any:
    if program is None:
        return None
    slots = tuple(Quantity(sp.Symbol(f"slot_{k}", real=True), "", "") for k in range(states))
    results = {**dict.fromkeys(layout.results, ()), group: tuple(f"r{k}" for k in range(count))}
    own = Layout(group, group, slots, layout.parameters, layout.inputs, results)
    fits = target if len(program.instructions) >= LARGE and group == WATCHED else "numpy"
    return TARGETS[fits](program, own)[1][group]


@dataclass(frozen=True)
class Cut:
    """A step that is not taken: its length instead, and whether a piece changes at the end of that."""

    length: float
    passage: bool = False


class Watcher:
    """What is watched in one run."""

    def __init__(self, compiled: Compiled, problem: Problem, inputs: Inputs | None) -> None:
        functions = _functions(SameObject(compiled), inputs is not None)
        self.f, self.problem, self.inputs = functions, problem, inputs
        self.knots = [] if inputs is None else inputs.knots
        if inputs is not None:
            inputs.forget()
        self.depth = MARGIN - math.log(problem.rtol)
        start, end = problem.t_span
        self.direction, self.span = (1.0 if end > start else -1.0), abs(end - start)
        self.crowded, self.passed = 0, -math.inf

    @property
    def is_idle(self) -> bool:
        """Whether there is nothing to watch."""
        found = self.f.found
        return found.ahead is None and found.watched is None and self.inputs is None

    def unit(self, t: float) -> float:
        """Return what times are distinguished by: the last place, about zero 2^-60 of the run."""
        return max(math.ulp(t), self.span * FINEST)

    def near(self, t: float, h: float) -> float:
        """Return how close to a change of piece a step ends before it is passed."""
        return max(32 * self.unit(t), 1e-3 * self.problem.rtol * abs(h))

    # -- ahead ------------------------------------------------------------------------------------

    def clear(self, t: float, last: float) -> tuple[float, float]:
        """Return how far a step from ``t`` may go, and how far it is to where a piece changes, or 0.

        ``last``: the length of the step before, 0 for the first.
        """
        rest = abs(self.problem.t_span[1] - t)
        length, knot = self._to_knot(t, rest)
        if self.f.ahead is None:
            return length, knot
        opened, stays = self._look(t, length)
        if opened and stays:
            return length, knot
        low, high = 0.0, length
        if last and GROWTH * last < length:
            opened, stays = self._look(t, GROWTH * last)
            if opened and stays:
                return GROWTH * last, 0.0
            high = GROWTH * last
        low, high, jumps = self._halved(t, low, high, not stays)
        finest = 2 * self.unit(t + self.direction * high)
        shorter, edge = (finest, 0.5 * (low + high)) if jumps else (0.0, 0.0)
        return max(low - shorter, 10 * self.unit(t)), edge

    def _to_knot(self, t: float, rest: float) -> tuple[float, float]:
        ahead = [self.direction * (k - t) for k in self.knots]
        nearest = min((a for a in ahead if a > 4 * self.unit(t)), default=math.inf)
        length = nearest - 2 * self.unit(t + self.direction * nearest) if nearest < rest else rest
        return length, nearest if nearest < rest else 0.0

    def _halved(self, t: float, low: float, high: float, jumps: bool) -> tuple[float, float, bool]:
        smallest = 10 * self.unit(t)
        while high > smallest:
            finest = 2 * self.unit(t + self.direction * high)
            if high - low <= (finest if jumps else 0.1 * high):
                break
            middle = 0.5 * (low + high)
            if middle in {low, high}:
                break
            opened, stays = self._look(t, middle)
            if opened and stays:
                low = middle
            else:
                high, jumps = middle, not stays
        return low, high, jumps

    def _look(self, t: float, length: float) -> tuple[bool, bool]:
        there = t + self.direction * length
        slots = np.array([t, min(t, there), max(t, there), self.depth])
        opened, stays = self.f.ahead(0.0, slots, self.problem.parameters, self.problem.inputs)
        return bool(opened != 0), bool(stays != 0)

    # -- behind -----------------------------------------------------------------------------------

    def cut(self, t_old: float, t: float, ends: Sequence[Array], dense: Dense) -> Cut | None:
        """Return what is to be done instead of the step from ``t_old`` to ``t``, None to take it.

        ``ends``: the states there; ``dense``: the polynomial between them.
        """
        h = t - t_old
        if self.f.watched is None and self.inputs is None:
            return None
        if abs(h) <= max(64 * self.unit(t), 1e-13 * self.span):
            return None
        times = t_old + PLACES * h
        times[-1] = t
        u = self.problem.inputs
        if self.inputs is not None:
            if self.inputs.hides(t_old, t, self.span, dense):
                return Cut(0.25 * abs(h))
            if self.f.watched is None:
                return None
        x = np.column_stack([ends[0], dense(times[1:-1]), ends[1]])
        return self._cut(times, x, u if self.inputs is None else self.inputs.along(times, x))

    def _cut(self, times: Array, x: Array, u: Array) -> Cut | None:
        p = self.problem.parameters
        values = self.f.watched(times, np.ascontiguousarray(x), p, u)[len(x) :]
        if not np.all(np.isfinite(values)) or self._is_quiet(values):
            return None
        low, high = _bounds(values)
        verdict = self._judge(values[:, 0], *self._guarded(values, low.min(1), high.max(1)))
        guards, h = self.f.found.guards, abs(times[-1] - times[0])
        share = float(np.min(verdict[:guards], initial=1.0))
        if share < 1:
            return Cut(h * max(0.1, 0.9 * share))
        if np.all(verdict[guards:] != 0):
            return None
        return self._passage(times, values, low, high)

    def _is_quiet(self, values: Array) -> bool:
        """Return whether guarded values move so little that bounds are within what is always allowed."""
        if self.f.found.pieces:
            return False
        moves = WIDEST * np.max(np.abs(values - values[:, :1]), axis=1)
        soon = np.maximum(self.f.shares * np.abs(values[:, 0]), self.f.lengths)
        return bool(np.all(moves <= soon))

    def _guarded(self, values: Array, low: Array, high: Array) -> tuple[Array, Array]:
        """Let bounds of what has one sign wherever it was seen keep it."""
        k = self.f.found.guarded
        least, most = values[:k].min(1), values[:k].max(1)
        signed = np.array(self.f.found.to_zero, dtype=bool)
        low[:k] = np.where(signed & (least > 0), np.maximum(low[:k], 1e-3 * least), low[:k])
        high[:k] = np.where(signed & (most < 0), np.minimum(high[:k], 1e-3 * most), high[:k])
        return low, high

    def _judge(self, now: Array, low: Array, high: Array) -> Array:
        slots = np.append(np.column_stack([now, low, high]).ravel(), self.depth)
        found: Array = self.f.verdict(0.0, slots, self.problem.parameters, self.problem.inputs)
        return found

    def _stays(self, now: Array, low: Array, high: Array) -> bool:
        return bool(np.all(self._judge(now, low, high)[self.f.found.guards :] != 0))

    def _passage(self, times: Array, v: Array, low: Array, high: Array) -> Cut | None:
        """Return the step that ends shortly before a piece changes, straight between the places."""
        t_old, h = float(times[0]), abs(float(times[-1] - times[0]))
        near = self.near(t_old, h)
        if self.crowded > CROWDED and h <= 64 * near:
            return None
        for k in range(len(times) - 1):
            if self._stays(v[:, k], low[:, k], high[:, k]):
                continue
            first, length = v[:, k], h * (PLACES[k + 1] - PLACES[k])
            if self._stays(first, np.minimum(first, v[:, k + 1]), np.maximum(first, v[:, k + 1])):
                return Cut(max(h * PLACES[k] + 0.25 * length, near))
            a, b = 0.0, 1.0
            for _ in range(54):
                middle = 0.5 * (a + b)
                there = first + middle * (v[:, k + 1] - first)
                if self._stays(first, np.minimum(first, there), np.maximum(first, there)):
                    a = middle
                else:
                    b = middle
            return self._before(t_old, h * PLACES[k] + b * length, near)
        return None

    def _before(self, t_old: float, at: float, near: float) -> Cut:
        if at > 1.75 * near:
            return Cut(at - 0.75 * near)
        self.crowded = self.crowded + 1 if abs(t_old - self.passed) <= 8 * near else 0
        self.passed = t_old
        return Cut(at + near, passage=True)


def _bounds(v: Array) -> tuple[Array, Array]:
    """Return bounds between neighbouring places: values move no faster than beside them.

    Beyond a place where they turn round they go no further than a parabola does within half the distance.
    """
    apart = np.diff(PLACES)
    signed = np.diff(v, axis=1) / apart
    slopes = np.abs(signed)
    turns = signed[:, :-1] * signed[:, 1:] < 0
    bend = np.where(turns, np.diff(signed, axis=1) / (apart[1:] + apart[:-1]), 0.0)
    bend = np.pad(bend, ((0, 0), (1, 1)))
    summits = [
        v[:, k : k + len(apart)] - bend[:, k : k + len(apart)] * apart**2 / 4 for k in (0, 1)
    ]
    beside = np.pad(slopes, ((0, 0), (1, 1)))
    reach = 0.5 * apart * np.maximum(np.maximum(beside[:, :-2], beside[:, 1:-1]), beside[:, 2:])
    middle = 0.5 * (v[:, 1:] + v[:, :-1])
    places = [v[:, 1:], v[:, :-1], *summits]
    return np.minimum.reduce([*places, middle - reach]), np.maximum.reduce(
        [*places, middle + reach]
    )
