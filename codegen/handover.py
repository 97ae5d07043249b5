"""Integrate in angles, near their singularity in coordinates without one, and report in angles.

`simulate` runs the first of `eom.system.Charts` until its singular function is as small as
``charts.enter``, takes the states over to the second, runs that until the function is large again, and
goes back. Both stops are located as any singular configuration is, by every method, forwards and
backwards. The transfers are closed expressions, right to rounding divided by the singular function.

Angles are reported as continuous functions of time: whole turns are counted, and the sign of the
singular function (see `eom.handover`) stays while the motion passes the singular configuration at a
distance. Where the singular function is smaller than ``margin`` the first angle has no meaning; it keeps
the value that it had before, and the third angle is what the attitude then requires. Behind such a
passage the sign is the one with which the first angle is nearest to its value before: a body that turns
straight through the configuration keeps its first and third angle, and the second goes on.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from codegen.charts import Between, CompiledCharts, Followed, compile_charts
from codegen.compiled import Compiled
from codegen.identity import SameObject
from codegen.integrate.trajectory import MAX_STEPS, Array
from codegen.layout import names_of, to_array
from codegen.lower import INVARIANTS, OUTPUTS
from codegen.simulation import DEFAULT_MARGIN, Result, drift_of
from codegen.simulation import simulate as simulate_one
from eom.system import Charts

Span = tuple[float, float]
NEARLY = 1e-12
"""Margin of the run in the second chart: its stop is a crossing."""


@lru_cache(maxsize=16)
def _compiled_once(key: SameObject[Charts]) -> CompiledCharts:
    return compile_charts(key.value)


def simulate(
    charts: Charts | CompiledCharts,
    initial: Mapping[str, float] | Sequence[float] | Array,
    t_span: tuple[float, float],
    parameters: Mapping[str, float] | None = None,
    method: str = "auto",
    rtol: float = 1e-9,
    atol: float | None = None,
    t_eval: ArrayLike | None = None,
    *,
    inputs: Mapping[str, Any] | None = None,
    dense_output: bool = False,
    max_steps: int = MAX_STEPS,
    margin: float = DEFAULT_MARGIN,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Integrate over ``t_span`` as `codegen.simulate` does; states are those of the first chart.

    ``margin``: where the singular function is smaller the first angle has no meaning, see the module.
    ``notice`` of the result tells how often and when coordinates changed.
    """
    made = charts if isinstance(charts, CompiledCharts) else _compiled_once(SameObject(charts))
    options = {"method": method, "rtol": rtol, "atol": atol, "inputs": inputs}
    run = _Run(made, dict(parameters or {}), options, margin, (t_span, progress))
    grid = None if t_eval is None else np.asarray(t_eval, dtype=np.float64)
    began = time.perf_counter()
    result = run.whole(initial, grid, max_steps, dense_output)
    return replace(result, seconds=time.perf_counter() - began)


@dataclass(frozen=True)
class _Part:
    """One run in one chart: its result, and states, outputs and dense output in angles."""

    result: Result
    y: Array
    y_stop: Array
    outputs: Mapping[str, Array]
    solution: Any
    closest: float


class _Run:
    """A whole run: charts in turn, and the transfers between them."""

    def __init__(
        self,
        made: CompiledCharts,
        parameters: dict[str, float],
        options: dict[str, Any],
        margin: float,
        plan: tuple[tuple[float, float], Callable[[float], None] | None],
    ) -> None:
        self.made, self.options, self.margin = made, options, margin
        self.between = Between(made, parameters, margin)
        self.span, self.progress = plan
        self.names = self.between.names

    def whole(self, initial: Any, grid: Array | None, max_steps: int, dense_output: bool) -> Result:
        """Run chart after chart until something else than a singularity stops the motion."""
        start, end = self.span
        x = to_array(initial, self.names, "initial value")
        parts: list[_Part] = []
        t, left = start, max_steps
        second = self.between.is_near(x)
        while True:
            own = None if grid is None else grid[np.sign(end - start) * (grid - t) >= 0]
            if own is not None and parts:
                own = own[np.sign(end - start) * (own - t) > 0]
            job = self._in_second if second else self._in_first
            part = job(x, (t, end), own, left)
            parts.append(part)
            x, t = part.y_stop, part.result.t_stop
            left -= part.result.steps + part.result.rejected
            goes_on = part.result.status == 1 and self._is_transfer(part, second) and t != end
            if not goes_on or left <= 0:
                return self._together(parts, grid is not None, dense_output)
            second = not second

    def _is_transfer(self, part: _Part, second: bool) -> bool:
        """Tell a stop at the border of a chart from one that nothing can be done about."""
        if not second:
            return True
        least = list(part.result.margin.values())
        return part.result.t_stop != self.span[0] and least[0] <= 2 * NEARLY

    def _told(self, part: float) -> None:
        if self.progress is not None:
            self.progress(part)

    def _run(
        self,
        compiled: Compiled,
        values: Array,
        x: Array,
        span: Span,
        grid: Array | None,
        left: int,
        margin: float,
    ) -> Result:
        start, end = self.span
        done, share = (span[0] - start) / (end - start), (span[1] - span[0]) / (end - start)
        inputs = self.options["inputs"] or {}
        known = names_of(compiled.layout.inputs)
        options = {**self.options, "inputs": {n: v for n, v in inputs.items() if n in known}}
        return simulate_one(
            compiled,
            x,
            span,
            values,
            t_eval=grid,
            dense_output=True,
            max_steps=left,
            margin=margin,
            progress=lambda part: self._told(done + share * part),
            **options,
        )

    def _in_first(self, x: Array, span: Span, grid: Array | None, left: int) -> _Part:
        margin = self.made.charts.enter
        result = self._run(
            self.made.first, self.between.values(self.made.first), x, span, grid, left, margin
        )
        outputs = {**result.outputs, **{n: d.start + d.over_time for n, d in result.drift.items()}}
        closest = min(result.margin.values(), default=math.inf)
        return _Part(result, result.y, result.y_stop, outputs, result.sol, closest)

    def _in_second(self, x: Array, span: Span, grid: Array | None, left: int) -> _Part:
        result, followed = self._followed(x, span, grid, left)
        if followed is None:
            nothing = np.repeat(x[:, None], len(result.t), axis=1)
            return _Part(result, nothing, x, {}, None, self.made.charts.enter)
        lost = next((k for k, a in enumerate(followed.path) if k and a.inside), 0)
        if lost and len(self.made.charts.second.singularities) > 1:
            result, followed = self._without_direction(
                x, span, grid, left, followed.path[lost - 1].t
            )
        y = followed(result.t) if len(result.t) else np.empty((len(self.names), 0))
        last = self.between.states(result.y_stop, followed.path[-1])
        return _Part(result, y, last, result.outputs, followed, followed.closest)

    def _followed(
        self, x: Array, span: Span, grid: Array | None, left: int
    ) -> tuple[Result, Followed | None]:
        """Run in the second chart from a state of the first, and follow the angles."""
        between, second = self.between, self.made.second
        start, angles = between.forth(span[0], x)
        values = between.values(second, branch=angles.branch)
        result = self._run(second, values, start, span, grid, left, NEARLY)
        if result.sol is None:
            return result, None
        return result, Followed(between, result.sol, angles, result.t_stop)

    def _without_direction(
        self, x: Array, span: Span, grid: Array | None, left: int, end: float
    ) -> tuple[Result, Followed]:
        """Return a run in the second chart up to where the torque has no direction."""
        direction = np.sign(end - span[0])
        kept = None if grid is None else grid[direction * (end - grid) >= 0]
        result, followed = self._followed(x, (span[0], end), kept, left)
        assert followed is not None
        place = self.made.charts.second.singularities[-1]
        message = f"stopped at t = {end:.9g} s: {place.expression} = 0 is singular: {place.meaning}"
        return replace(result, status=1, message=message), followed

    def _together(self, parts: list[_Part], on_grid: bool, dense_output: bool) -> Result:
        """Return all parts as one result; a point that two parts share stands once."""
        first, last = parts[0].result, parts[-1].result
        cuts = [int(k > 0 and not on_grid) for k in range(len(parts))]
        t = np.concatenate([p.result.t[c:] for p, c in zip(parts, cuts, strict=True)])
        y = np.concatenate([p.y[:, c:] for p, c in zip(parts, cuts, strict=True)], axis=1)
        values = {
            name: np.concatenate(
                [self._named(p, name)[c:] for p, c in zip(parts, cuts, strict=True)]
            )
            for group in (OUTPUTS, INVARIANTS)
            for name in self.made.first.layout.results[group]
        }
        layout = self.made.first.layout
        changes = [p.result.t_stop for p in parts[:-1]]
        drift = {n: drift_of(values[n], self._floor(first, n)) for n in layout.results[INVARIANTS]}
        expressions = layout.results["singularities"]
        return replace(
            last,
            t=t,
            y=np.ascontiguousarray(y),
            sol=_Joined(parts) if dense_output else None,
            nfev=sum(p.result.nfev for p in parts),
            outputs={n: values[n] for n in layout.results[OUTPUTS]},
            drift=drift,
            margin=dict.fromkeys(expressions, min(p.closest for p in parts)),
            y_stop=parts[-1].y_stop,
            method=" and ".join(dict.fromkeys(p.result.method for p in parts)),
            why=parts[0].result.why,
            steps=sum(p.result.steps for p in parts),
            rejected=sum(p.result.rejected for p in parts),
            notice=_notice(changes) or last.notice,
            names=self.names,
        )

    def _floor(self, first: Result, name: str) -> float:
        return first.drift[name].floor if name in first.drift else 0.0

    def _named(self, part: _Part, name: str) -> Array:
        """Return an output or constant of the motion at the points of a part."""
        if name in part.outputs:
            return part.outputs[name]
        layout = self.made.first.layout
        group = OUTPUTS if name in layout.results[OUTPUTS] else INVARIANTS
        if not len(part.result.t):
            return np.empty(0)
        inputs = to_array(
            {n: float((self.options["inputs"] or {}).get(n, 0.0)) for n in names_of(layout.inputs)},
            names_of(layout.inputs),
            "input",
        )
        function = self.made.first.functions[group]
        found = function(part.result.t, part.y, self.between.values(self.made.first), inputs)
        return np.asarray(found[layout.results[group].index(name)])


def _notice(changes: Sequence[float]) -> str:
    if not changes:
        return ""
    times = ", ".join(f"{t:.6g}" for t in changes[:6]) + (", ..." if len(changes) > 6 else "")
    return f"coordinates were changed {len(changes)} times near singular angles, at t = {times} s"


class _Joined:
    """Dense output of all parts in angles; ``sol(t)`` has shape (n,) or (n, len(t))."""

    def __init__(self, parts: Sequence[_Part]) -> None:
        used = [p for p in parts if p.solution is not None]
        self.parts = [p.solution for p in used]
        self.ends = np.array([p.result.t_stop for p in used])
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
