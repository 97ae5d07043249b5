"""A run in several parts, put together as it goes on: only what was asked for is kept."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from codegen.frontend.layout import Layout
from codegen.ir.groups import INVARIANTS, SINGULARITIES
from codegen.native.trajectory import Array
from codegen.runs.charts import Angles
from codegen.runs.drift import drift_of
from codegen.runs.second_run import Origin
from codegen.runs.simulation import Result


@dataclass(frozen=True)
class Place:
    """Where a run stands: states of the first chart or, with angles, of the second."""

    t: float
    x: Array
    angles: Angles | None = None


@dataclass(frozen=True)
class Part:
    """One run in one chart: its result, and states, outputs and dense output in angles.

    ``after``: where the run goes on, or None; ``changes``: whether it does so in the other chart.
    """

    result: Result
    y: Array
    y_stop: Array
    outputs: Mapping[str, Array]
    solution: Any
    closest: float
    after: Place | None = None
    changes: bool = False


Named = Callable[[Part, str], Array]


class Parts:
    """The parts of a run so far; a point that two of them share stands once."""

    def __init__(
        self, layout: Layout, wanted: Sequence[str], named: Named, *, on_grid: bool
    ) -> None:
        """``wanted``: names of outputs; ``named``: values of one, or of a constant, in a part."""
        self.layout, self.wanted, self.named, self.on_grid = layout, wanted, named, on_grid
        self.first: Result | None = None
        self.last: Part | None = None
        self.stored, self.nfev, self.steps, self.rejected = 0, 0, 0, 0
        self.seconds, self.closest = 0.0, math.inf
        self.changes: list[float] = []
        self.methods: dict[str, None] = {}
        self.integrated: dict[str, None] = {}
        """Names of the methods, as `codegen.runs.second_run` compares them."""
        self.solutions: list[tuple[Any, float]] = []
        names = [*wanted, *layout.results[INVARIANTS]]
        self.rows: dict[str, list[Array]] = {n: [] for n in names}
        self.t: list[Array] = []
        self.y: list[Array] = []

    def add(self, part: Part) -> None:
        """Take what is kept of a part."""
        cut = int(self.first is not None and not self.on_grid)
        if len(part.result.t) > cut or self.first is None:
            self.t.append(part.result.t[cut:])
            self.y.append(part.y[:, cut:])
            for name, rows in self.rows.items():
                rows.append(self.named(part, name)[cut:])
        self.first = self.first or part.result
        self.last = part
        self.stored += len(part.result.t)
        self.nfev += part.result.nfev
        self.steps += part.result.steps
        self.rejected += part.result.rejected
        self.seconds += part.result.seconds
        self.closest = min(self.closest, part.closest)
        self.methods[part.result.method] = None
        if isinstance(part.result.origin, Origin):
            self.integrated |= dict.fromkeys(part.result.origin.methods)
        if part.solution is not None:
            self.solutions.append((part.solution, part.result.t_stop))

    def result(self, names: tuple[str, ...], *, dense_output: bool) -> Result:
        """Return all parts as one result, with states ``names``."""
        first, last = self.first, self.last
        assert first is not None
        assert last is not None
        results = self.layout.results
        values = {n: np.concatenate(rows) for n, rows in self.rows.items()}
        return replace(
            last.result,
            t=np.concatenate(self.t),
            y=np.ascontiguousarray(np.concatenate(self.y, axis=1)),
            sol=Joined(self.solutions) if dense_output and self.solutions else None,
            nfev=self.nfev,
            outputs={n: values[n] for n in self.wanted},
            drift={n: drift_of(values[n], _terms(first, n)) for n in results[INVARIANTS]},
            margin=dict.fromkeys(results[SINGULARITIES], self.closest),
            y_stop=last.y_stop,
            method=" and ".join(self.methods),
            why=first.why,
            steps=self.steps,
            rejected=self.rejected,
            seconds=self.seconds,
            notice=_notice(self.changes) or last.result.notice,
            names=names,
            changes=tuple(self.changes),
        )


def _terms(first: Result, name: str) -> Callable[[], float] | None:
    """Return what finds the size of a constant's terms: those of the first part."""
    return first.drift[name].terms if name in first.drift else None


def _notice(changes: Sequence[float]) -> str:
    if not changes:
        return ""
    times = ", ".join(f"{t:.6g}" for t in changes[:6]) + (", ..." if len(changes) > 6 else "")
    return f"coordinates were changed {len(changes)} times near singular angles, at t = {times} s"


class Joined:
    """Dense output of parts, each up to its end; ``sol(t)`` has shape (n,) or (n, len(t))."""

    def __init__(self, parts: Sequence[tuple[Any, float]]) -> None:
        self.parts = [solution for solution, _ in parts]
        self.ends = np.array([end for _, end in parts])
        self.ts = np.concatenate([self.parts[0].ts[:1], *(p.ts[1:] for p in self.parts)])
        self.t_min, self.t_max = min(self.ts[0], self.ts[-1]), max(self.ts[0], self.ts[-1])

    def __call__(self, t: Any) -> Array:
        """Evaluate each time by the part that it lies in."""
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        direction = 1.0 if self.ts[-1] >= self.ts[0] else -1.0
        places = np.searchsorted(direction * self.ends[:-1], direction * times, side="left")
        columns = [self.parts[k](float(at)) for at, k in zip(times, places, strict=True)]
        values = np.array(columns).T
        return values[:, 0] if np.ndim(t) == 0 else values
