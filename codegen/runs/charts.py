"""The two charts of a motion, compiled, and the way between them: states, angles, whole turns."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.frontend.layout import names_of, to_array
from codegen.native.trajectory import Array
from eom.system import Charts

TURN = 0.5
"""Radians that no angle turns by between two points at which whole turns are counted."""


@dataclass(frozen=True)
class CompiledCharts:
    """Both systems of `Charts` and the two transfers, compiled."""

    charts: Charts
    first: Compiled
    second: Compiled
    forth: Compiled
    back: Compiled


def compile_charts(charts: Charts, target: str = "auto") -> CompiledCharts:
    """Compile charts; the transfers, which are used some dozen times a passage, as plain Python.

    Raises as `codegen.compile` does.
    """
    systems = [compile_system(s, target) for s in (charts.first, charts.second)]
    transfers = [compile_system(s, "python") for s in (charts.forth, charts.back)]
    return CompiledCharts(charts, *systems, *transfers)


@dataclass(frozen=True)
class Angles:
    """Where the angles are: first, second and third, continuous in time, at a time and on a branch."""

    t: float
    values: tuple[float, float, float]
    branch: float
    inside: bool
    """Whether the first angle has no meaning there."""


class Between:
    """Transfers between the charts of one motion with its parameters."""

    def __init__(self, made: CompiledCharts, parameters: dict[str, float], margin: float) -> None:
        self.made, self.parameters, self.margin = made, parameters, margin
        self.names = names_of(made.first.layout.states)

    def values(self, compiled: Compiled, **further: float) -> Array:
        """Return the parameters of one of the four systems, ``branch`` and ``first_angle`` given."""
        known = {**self.parameters, **further}
        names = names_of(compiled.layout.parameters)
        return to_array({n: known[n] for n in names if n in known}, names, "parameter")

    def forth(self, t: float, x: Array) -> tuple[Array, Angles]:
        """Return the state of the second chart, and the angles of one of the first."""
        found = np.asarray(self.made.forth.outputs(0.0, x, self.values(self.made.forth)))
        first, second, third = (float(x[k]) for k in self.made.charts.angles)
        inside = self.distance(found) <= self.margin
        return found, Angles(t, (first, second, third), self.sign(x), inside)

    def distance(self, x: Array) -> float:
        """Return |singular function| at a state of the second chart."""
        p = self.values(self.made.back, branch=1.0, first_angle=0.0)
        return float(self.made.back.outputs(0.0, x, p)[-1])

    def piece(self, x: Array) -> float:
        """Return a time in which no angle turns by more than `TURN`: they turn as fast as w/|s|."""
        w = float(np.abs(x[:3]).sum()) or 1e-300
        return TURN * max(self.distance(x), 0.5 * self.margin) / w

    def angles(self, t: float, x: Array, before: Angles) -> Angles:
        """Return the angles that follow those of ``before``."""
        inside = self.distance(x) <= self.margin
        if inside:
            found = self._back(x, before.branch, before.values[0])
            first, second, third = before.values[0], found[1], found[3]
            return Angles(t, _near((first, second, third), before.values), before.branch, True)
        branch = before.branch
        if before.inside:
            branch = min(
                (branch, -branch),
                key=lambda b: abs(
                    math.remainder(self._back(x, b)[0] - before.values[0], 2 * math.pi)
                ),
            )
        found = self._back(x, branch)
        return Angles(t, _near(found[:3], before.values), branch, False)

    def _back(self, x: Array, branch: float, first: float = 0.0) -> tuple[float, ...]:
        """Return the three angles, and the third one that fits ``first``."""
        p = self.values(self.made.back, branch=branch, first_angle=first)
        found = self.made.back.outputs(0.0, x, p)
        return (*(float(found[k]) for k in self.made.charts.angles), float(found[-2]))

    def states(self, x: Array, angles: Angles) -> Array:
        """Return the states of the first chart."""
        p = self.values(self.made.back, branch=angles.branch, first_angle=angles.values[0])
        found = np.asarray(self.made.back.outputs(0.0, x, p)[:-2])
        found[list(self.made.charts.angles)] = angles.values
        return found

    def tolerances(self, atol: Array) -> Array:
        """Return absolute tolerances of the second chart's states from those of the first.

        A state of the same name has the same one; the quaternion the least of the angles, other
        rates the least of the rates.
        """
        own = dict(zip(self.names, atol.tolist(), strict=True))
        turns = [self.names[k] for k in self.made.charts.angles]
        angle = min(own[n] for n in turns)
        rate = min((v for n, v in own.items() if n not in turns), default=angle)
        names = names_of(self.made.second.layout.states)
        rest = dict(zip(names, [rate] * (len(names) - 4) + [angle] * 4, strict=True))
        return np.array([own.get(n, v) for n, v in rest.items()])

    def sign(self, x: Array) -> float:
        """Return the branch of a state of the first chart: the sign of cos or sin of its second angle."""
        theta = float(x[self.made.charts.angles[1]])
        return math.copysign(
            1.0, math.sin(theta) if self.made.charts.symmetric else math.cos(theta)
        )

    def is_near(self, x: Array) -> bool:
        """Tell whether a state of the first chart belongs to the second."""
        theta = float(x[self.made.charts.angles[1]])
        s = math.sin(theta) if self.made.charts.symmetric else math.cos(theta)
        return abs(s) <= self.made.charts.enter


@dataclass(frozen=True)
class Followed:
    """A run in the second chart with the angles that were followed through it."""

    y: Array
    """States of the first chart at the times that were asked for, shape (n, N)."""
    last: Angles
    closest: float
    """The least |singular function| at the points that were followed."""
    lost: float | None
    """The last of these times before the first angle first had no meaning, if ever."""
    path: tuple[Angles, ...]
    """All points, if they were to be kept."""


def followed(
    between: Between,
    solution: Any,
    start: Angles,
    end: float,
    plan: tuple[Array, bool],
) -> Followed:
    """Go through a run in pieces in which no angle turns much; keep what ``plan`` asks for.

    ``plan``: times in the run, in its direction, at which to return states, and whether to keep all
    points. Without that nothing grows with the length of the run.
    """
    times, keep = plan
    direction = math.copysign(1.0, end - start.t)
    columns: list[Array] = []
    path = [start]
    closest, lost = between.distance(solution(start.t)), None
    for angles in _pieces(between, solution, start, end):
        before = path[-1]
        if angles.inside and lost is None:
            lost = before.t
        while len(columns) < len(times) and direction * (times[len(columns)] - angles.t) < 0:
            columns.append(_states(between, solution, float(times[len(columns)]), before))
        closest = min(closest, between.distance(solution(angles.t)))
        path = path if keep else []
        path.append(angles)
    columns += [_states(between, solution, float(t), path[-1]) for t in times[len(columns) :]]
    y = np.array(columns).reshape(len(columns), len(between.names)).T
    return Followed(y, path[-1], closest, lost, tuple(path) if keep else ())


def _pieces(between: Between, solution: Any, here: Angles, end: float) -> Iterator[Angles]:
    """Yield the angles at the ends of pieces in which none turns much, up to ``end``."""
    direction = math.copysign(1.0, end - here.t)
    while direction * (end - here.t) > 0:
        step = max(between.piece(solution(here.t)), 4 * math.ulp(here.t))
        t = here.t + direction * step
        t = end if direction * (end - t) <= 0.01 * step else t
        here = between.angles(t, solution(t), here)
        yield here


def _states(between: Between, solution: Any, t: float, before: Angles) -> Array:
    x = solution(t)
    return between.states(x, between.angles(t, x, before))


class FollowedSolution:
    """Dense output in angles of a run in the second chart; ``sol(t)`` as that of other runs."""

    def __init__(self, between: Between, solution: Any, path: Sequence[Angles]) -> None:
        self.between, self.solution, self.path = between, solution, path
        self.ts, self.times = solution.ts, np.array([a.t for a in path])

    def __call__(self, t: Any) -> Array:
        """Return the states at times inside the run, shape (n,) or (n, len(t))."""
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        forward = self.times[-1] >= self.times[0]
        nodes, wanted = (self.times, times) if forward else (-self.times, -times)
        places = np.clip(np.searchsorted(nodes, wanted, side="right") - 1, 0, len(nodes) - 1)
        columns = [
            _states(self.between, self.solution, float(at), self.path[k])
            for at, k in zip(times, places, strict=True)
        ]
        values = np.array(columns).T.reshape(len(self.between.names), len(times))
        return values[:, 0] if np.ndim(t) == 0 else values


def _near(found: Sequence[float], before: Sequence[float]) -> tuple[float, float, float]:
    """Return angles with the whole turns that bring them nearest to those before."""
    a, b, c = (w + math.remainder(v - w, 2 * math.pi) for v, w in zip(found, before, strict=True))
    return a, b, c
