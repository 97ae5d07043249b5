"""A closed form in the place of an integrator: the same `Trajectory`, without steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from codegen.closed.closed_forms import Closed
from codegen.compiling.compiled import Compiled
from codegen.ir.program import SINGULARITIES
from codegen.native.trajectory import Array, Problem, Stop, Trajectory

POINTS = 1001
"""Times that are stored where none are asked for, evenly over the run."""
PART = 0.1
"""Radians that the coordinate of a singularity turns between two times at which it is looked for."""
CHUNK = 4096
"""Times of one search."""
ZOOM, FINE = 16, 14
"""Parts of an interval, and how often it is divided: to rounding."""


@dataclass(frozen=True)
class Moved:
    """A closed form over the times of a problem; the initial state stands as it is given."""

    closed: Closed
    problem: Problem

    def __call__(self, t: Array) -> Array:
        """Return states (n, N) at times (N,)."""
        since = t - self.problem.t_span[0]
        states = self.closed.states(since)
        states[:, since == 0] = self.problem.x0[:, None]
        return states


@dataclass(frozen=True)
class ClosedSolution:
    """Dense output that is the closed form itself: ``sol(t)`` has shape (n,) or (n, len(t))."""

    moved: Moved
    ts: Array

    @property
    def t_min(self) -> float:
        """The earliest time of the run."""
        return float(min(self.ts[0], self.ts[-1]))

    @property
    def t_max(self) -> float:
        """The latest time of the run."""
        return float(max(self.ts[0], self.ts[-1]))

    def __call__(self, t: Any) -> Array:
        """Evaluate at any time."""
        values = self.moved(np.atleast_1d(np.asarray(t, dtype=np.float64)))
        return values[:, 0] if np.ndim(t) == 0 else values


def integrate(compiled: Compiled, closed: Closed, problem: Problem) -> Trajectory:
    """Evaluate a closed form where a run is asked for, up to the first singular configuration.

    Without ``t_eval`` at `POINTS` times. Where there are singularities they are looked for between
    times so close that no coordinate turns by more than `PART`; beyond ``max_steps`` such times the
    run stops, as others do.
    """
    (start, end), moved = problem.t_span, Moved(closed, problem)
    stop, closest = Stop("end", end), np.empty(0)
    if problem.singularities:
        stop, closest = _Search(compiled, moved, problem).run()
    times = np.linspace(start, stop.t, POINTS) if problem.t_eval is None else problem.t_eval
    direction = math.copysign(1.0, end - start)
    times = times[direction * (times - stop.t) <= 0]
    y = moved(times)
    ends = times.size and times[-1] == stop.t
    return Trajectory(
        t=times.copy(),
        y=y,
        stop=stop,
        state_at_stop=y[:, -1].copy() if ends else moved(np.array([stop.t]))[:, 0],
        closest=tuple(closest.tolist()),
        evaluations=0,
        steps=0,
        rejected=0,
        solution=ClosedSolution(moved, np.array([start, stop.t])) if problem.dense_output else None,
    )


class _Search:
    """The first time at which a singularity is nearer than the margin."""

    def __init__(self, compiled: Compiled, moved: Moved, problem: Problem) -> None:
        self.compiled, self.moved, self.problem = compiled, moved, problem

    def values(self, t: Array) -> Array:
        x = self.moved(t)
        f = self.compiled.functions[SINGULARITIES]
        return f(t, x, self.problem.parameters, self.problem.inputs)

    def run(self) -> tuple[Stop, Array]:
        """Return why and when to stop, and the least distance from each singularity."""
        (start, end), margin = self.problem.t_span, self.problem.margin
        before = self.values(np.array([start]))
        closest = np.abs(before[:, 0])
        if np.any(closest <= margin):
            return Stop("singular", start, int(np.argmin(closest))), closest
        count = self._count()
        done = 0
        while done < count:
            if done >= self.problem.max_steps:
                return Stop("max_steps", start + (end - start) * (done / count)), closest
            last = min(count, done + CHUNK, self.problem.max_steps)
            t = start + (end - start) * (np.arange(done, last + 1) / count)
            t[-1] = end if last == count else t[-1]
            found, nearest = self._within(t)
            closest = np.minimum(closest, nearest)
            if found is not None:
                return found, closest
            done = last
            self.problem.report(float(t[-1]))
        return Stop("end", end), closest

    def _count(self) -> int:
        """Return in how many intervals to search, by the fastest rate at some times."""
        start, end = self.problem.t_span
        t = np.linspace(start, end, POINTS)
        x = self.moved(t)
        slopes = np.abs(self.compiled.rhs(t, x, self.problem.parameters, self.problem.inputs))
        rows = [k for k in self.compiled.layout.coordinates if k >= 0] or list(range(len(x)))
        fastest = float(np.nanmax(np.where(np.isfinite(slopes[rows]), slopes[rows], 0.0)))
        return max(POINTS, math.ceil(2 * fastest * abs(end - start) / PART))

    def _within(self, t: Array) -> tuple[Stop | None, Array]:
        s = self.values(t)
        size, margin = np.abs(s), self.problem.margin
        nearest = size.min(axis=1)
        found: list[Stop] = []
        for k in range(len(s)):
            crossed = (s[k, 1:] > 0) != (s[k, :-1] > 0)
            hits = np.flatnonzero(crossed | (size[k, 1:] <= margin))
            last = int(hits[0]) if hits.size else len(t) - 1
            places = [(int(hits[0]), int(hits[0]) + 1)] if hits.size else []
            dips = _dips(size[k, : last + 1])
            for low, high in [(d - 1, d + 1) for d in dips] + places:
                stop, least = self._zoom(float(t[low]), float(t[high]), k)
                nearest[k] = min(nearest[k], least)
                if stop is not None:
                    found.append(stop)
                    break
        first = min(found, key=lambda f: abs(f.t - t[0])) if found else None
        return first, nearest

    def _zoom(self, low: float, high: float, k: int) -> tuple[Stop | None, float]:
        """Divide an interval about its first crossing, or else about its least value."""
        margin, least = self.problem.margin, math.inf
        inside = False
        for _ in range(FINE):
            t = np.linspace(low, high, ZOOM + 1)
            s = self.values(t)[k]
            least = min(least, float(np.abs(s).min()))
            hits = np.flatnonzero(((s > 0) != (s[0] > 0)) | (np.abs(s) <= margin))
            inside = inside or hits.size > 0
            if hits.size and hits[0] == 0:
                return Stop("singular", low, k), least
            place = int(hits[0]) if hits.size else int(np.argmin(np.abs(s)))
            low, high = (
                float(t[max(0, place - 1)]),
                float(t[place if hits.size else min(ZOOM, place + 1)]),
            )
        return (Stop("singular", high, k) if inside else None), least


def _dips(size: Array) -> list[int]:
    """Return the places of least distance that lie between larger ones and are near."""
    middle = size[1:-1]
    return [
        int(k) + 1
        for k in np.flatnonzero((middle <= size[:-2]) & (middle <= size[2:]) & (middle < 2 * PART))
    ]
