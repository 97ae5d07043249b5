"""The two charts of a motion, compiled, and the way between them: states, angles, whole turns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from codegen.compiled import Compiled
from codegen.compiled import compile as compile_system
from codegen.integrate.trajectory import Array
from codegen.layout import names_of, to_array
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


class Followed:
    """States of the first chart from a run in the second, by angles that were followed."""

    def __init__(self, between: Between, solution: Any, start: Angles, end: float) -> None:
        self.between, self.solution = between, solution
        self.path = [start]
        self.ts, self.end = solution.ts, end
        self._follow()
        self.times = np.array([a.t for a in self.path])

    @property
    def closest(self) -> float:
        """The least |singular function| at the points that were followed."""
        return min(self.between.distance(self.solution(a.t)) for a in self.path)

    def _follow(self) -> None:
        """Go through the run in pieces in which no angle turns much."""
        direction = math.copysign(1.0, self.end - self.path[0].t)
        while direction * (self.end - (here := self.path[-1]).t) > 0:
            x = self.solution(here.t)
            step = max(self.between.piece(x), 4 * math.ulp(here.t))
            t = here.t + direction * step
            t = self.end if direction * (self.end - t) <= 0.01 * step else t
            self.path.append(self.between.angles(t, self.solution(t), here))

    def __call__(self, t: Any) -> Array:
        """Return the states at times inside the run, shape (n,) or (n, len(t))."""
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        forward = self.times[-1] >= self.times[0]
        nodes, wanted = (self.times, times) if forward else (-self.times, -times)
        places = np.clip(np.searchsorted(nodes, wanted, side="right") - 1, 0, len(nodes) - 1)
        columns = [
            self.between.states(
                x := self.solution(float(at)), self.between.angles(float(at), x, self.path[k])
            )
            for at, k in zip(times, places, strict=True)
        ]
        values = np.array(columns).T.reshape(len(self.between.names), len(times))
        return values[:, 0] if np.ndim(t) == 0 else values


def _near(found: Sequence[float], before: Sequence[float]) -> tuple[float, float, float]:
    """Return angles with the whole turns that bring them nearest to those before."""
    a, b, c = (w + math.remainder(v - w, 2 * math.pi) for v, w in zip(found, before, strict=True))
    return a, b, c
