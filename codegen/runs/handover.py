"""Integrate in angles, near their singularity in coordinates without one, and report in angles.

`simulate` runs the first of `eom.system.Charts` until its singular function is as small as
``charts.enter``, takes the states over to the second, runs that until the function is large again, and
goes back. Both stops are located as any singular configuration is, by every method, forwards and
backwards. The transfers are closed expressions, right to rounding divided by the singular function.

Angles are reported as continuous functions of time: whole turns are counted, and the sign of the
singular function (see `eom.scenes.handover`) stays while the motion passes the singular configuration at a
distance. Where the singular function is smaller than ``margin`` the first angle has no meaning; it keeps
the value that it had before, and the third angle is what the attitude then requires. Behind such a
passage the sign is the one with which the first angle is nearest to its value before: a body that turns
straight through the configuration keeps its first and third angle, and the second goes on.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from codegen.compiling.compiled import Compiled
from codegen.compiling.signals import Inputs
from codegen.frontend.layout import names_of, to_array
from codegen.integrate.scales import PART
from codegen.ir.groups import INVARIANTS, OUTPUTS
from codegen.ir.identity import SameObject
from codegen.native.trajectory import MAX_STEPS, Array, Problem, Stop, Trajectory
from codegen.runs import arguments
from codegen.runs.charts import (
    Angles,
    Between,
    CompiledCharts,
    Followed,
    FollowedSolution,
    compile_charts,
    followed,
)
from codegen.runs.clock import Late, is_late, span_since, times_told
from codegen.runs.parts import Part, Parts, Place
from codegen.runs.second_run import Origin
from codegen.runs.simulation import DEFAULT_MARGIN, InputValue, Result, Values
from codegen.runs.simulation import simulate as simulate_one
from eom.errors import typed, unknown_name
from eom.system import Charts

NEARLY = 1e-12
"""Margin of the run in the second chart: its stop is a crossing."""
PIECE = 2000
"""Steps in the second chart whose dense output is kept at a time, to follow the angles by."""


@lru_cache(maxsize=16)
def _compiled_once(key: SameObject[Charts]) -> CompiledCharts:
    return compile_charts(key.value)


@typed
def simulate(
    charts: Charts | CompiledCharts,
    initial: Values,
    t_span: tuple[float, float],
    parameters: Mapping[str, float] | None = None,
    method: str = "auto",
    rtol: float = 1e-9,
    atol: ArrayLike | None = None,
    t_eval: ArrayLike | None = None,
    *,
    inputs: Mapping[str, InputValue] | None = None,
    outputs: Sequence[str] | None = None,
    dense_output: bool = False,
    first_step: float | None = None,
    max_step: float = math.inf,
    max_steps: int = MAX_STEPS,
    margin: float = DEFAULT_MARGIN,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Integrate over ``t_span`` as `codegen.simulate` does; states are those of the first chart.

    ``atol``: a number, or one a state of the first chart; near the singular angle the quaternion
    takes the least of the angles; by default each part has its own scales. ``outputs``: names of outputs
    to evaluate; all angles and rates are integrated in any case, as the transfers need them.
    ``first_step``: of the whole run, not after each change. ``margin``: where the singular function is
    smaller the first angle has no meaning, see the module. With ``t_eval`` and without ``dense_output``
    nothing but the times of changes grows with the steps. ``changes`` and ``notice`` of the result tell
    when coordinates changed.
    Raises as `codegen.simulate` does.
    """
    made = charts if isinstance(charts, CompiledCharts) else _compiled_once(SameObject(charts))
    asked, values = arguments.span(t_span), dict(parameters or {})
    grid = None if t_eval is None else arguments.grid(t_eval, asked)
    start = asked[0] if is_late(asked) else 0.0
    _check_names(made, values, inputs or {})
    states = names_of(made.first.layout.states)
    plan = _Plan(
        span_since(asked, start),
        None if grid is None else grid - start,
        None if atol is None else arguments.tolerances(atol, len(states)),
        arguments.optional(first_step, "first_step"),
        arguments.positive(margin, "margin"),
        dense_output,
        dict(inputs or {}),
        {"method": method, "rtol": rtol, "max_step": max_step, "epoch": start},
        start,
        progress,
    )
    run = _Run(made, values, plan, _wanted(made, outputs))
    found = _whole(run, to_array(initial, states, "initial value"), arguments.count(max_steps))
    return _told(found, start, grid, asked[1]) if start else found


def _whole(run: _Run, x0: Array, max_steps: int) -> Result:
    """Return the run with what it came from, where it is over the time of its systems."""
    found = run.whole(x0, max_steps)
    return replace(found, origin=None if run.plan.start else _origin(run, x0, max_steps))


def _told(result: Result, start: float, grid: Array | None, end: float) -> Result:
    """Return a result over times since ``start`` in the times of the user."""
    since, ended = f"counted from t = {start!r} s", result.status == 0
    return replace(
        result,
        t=times_told(result.t, start, grid, end if ended else None),
        t_stop=end if ended else start + result.t_stop,
        changes=tuple(start + t for t in result.changes),
        sol=None if not result.sol else Late(result.sol, start),
        message=f"reached t = {end!r} s" if ended else f"{since}: {result.message}",
        notice=f"{since}: {result.notice}" if result.changes else result.notice,
    )


@dataclass(frozen=True, eq=False)
class HandedOver(Origin):
    """What a result in two charts came from. ``made``, ``given``, ``plan``: of its run."""

    made: CompiledCharts | None = None
    given: Mapping[str, float] = field(default_factory=dict)
    plan: _Plan | None = None

    def again(self, problem: Problem, method: str) -> Trajectory:
        """Integrate a changed problem by a method; where angles have no meaning stays as it was."""
        assert self.made is not None
        assert self.plan is not None
        result = simulate(
            self.made, problem.x0, problem.t_span, self.given, method, problem.rtol, problem.atol,
            problem.t_eval, inputs=self.plan.inputs, outputs=(), dense_output=problem.dense_output,
            first_step=problem.first_step, max_step=problem.max_step, max_steps=problem.max_steps,
            margin=self.plan.margin, progress=problem.progress,
        )  # fmt: skip
        kind = {0: "end", 1: "singular"}.get(result.status, "failed")
        return Trajectory(
            t=result.t, y=result.y, stop=Stop(kind, result.t_stop), state_at_stop=result.y_stop,
            closest=(), evaluations=result.nfev, steps=result.steps, rejected=result.rejected,
            solution=result.sol,
        )  # fmt: skip


def _origin(run: _Run, x0: Array, max_steps: int) -> HandedOver:
    """Return what a run came from, for the estimate of its error."""
    made, plan = run.made, run.plan
    signals = [n for n, v in plan.inputs.items() if callable(v)]  # the runs have them by name
    unknown = np.full(len(x0), PART * plan.options["rtol"])  # each part measured its states itself
    problem = Problem(
        x0, plan.span, np.empty(0), np.empty(0), plan.options["rtol"],
        unknown if plan.atol is None else plan.atol, plan.margin, 0,
        first_step=plan.first_step, max_step=plan.options["max_step"], max_steps=max_steps,
    )  # fmt: skip
    return HandedOver(
        made.first, problem, Inputs(np.empty(0), signals, {}) if signals else None, plan.options["method"],
        tuple(run.parts.integrated), False, made, run.between.parameters, replace(plan, progress=None),
    )  # fmt: skip


def _check_names(
    made: CompiledCharts, parameters: Mapping[str, float], inputs: Mapping[str, InputValue]
) -> None:
    """Raise `InputError` for names that the charts do not have, and for inputs that are missing."""
    systems = (made.first, made.second, made.forth, made.back)
    known = dict.fromkeys(n for s in systems for n in names_of(s.layout.parameters))
    for kind, given, names in (
        ("parameter", parameters, list(known)),
        ("input", inputs, names_of(made.first.layout.inputs)),
    ):
        for name in given:
            if name not in names:
                raise unknown_name(kind, name, names)
    to_array(dict.fromkeys(inputs, 0.0), names_of(made.first.layout.inputs), "input")


def _wanted(made: CompiledCharts, names: Sequence[str] | None) -> tuple[str, ...]:
    """Return the names of the outputs to evaluate. Raises `InputError` for unknown names."""
    layout = made.first.layout
    if names is None:
        return tuple(layout.results[OUTPUTS])
    known = (*names_of(layout.states), *layout.results[OUTPUTS])
    for name in names:
        if name not in known:
            raise unknown_name("state or output", name, known)
    return tuple(n for n in layout.results[OUTPUTS] if n in names)


@dataclass(frozen=True)
class _Plan:
    """What a run shall do; ``options`` are those of `codegen.simulate` for every part."""

    span: tuple[float, float]
    grid: Array | None
    atol: Array | None
    first_step: float | None
    margin: float
    dense_output: bool
    inputs: Mapping[str, InputValue]
    options: Mapping[str, Any]
    start: float
    """Time that is zero in the run."""
    progress: Callable[[float], None] | None


class _Run:
    """A whole run: charts in turn, and the transfers between them."""

    def __init__(
        self,
        made: CompiledCharts,
        parameters: dict[str, float],
        plan: _Plan,
        wanted: tuple[str, ...],
    ) -> None:
        self.made, self.plan = made, plan
        self.between = Between(made, parameters, plan.margin)
        on_grid = plan.grid is not None
        self.parts = Parts(made.first.layout, wanted, self._named, on_grid=on_grid)

    def whole(self, x: Array, max_steps: int) -> Result:
        """Run chart after chart until something else than a singularity stops the motion."""
        parts, left = self.parts, max_steps
        place = Place(self.plan.span[0], x)
        if self.between.is_near(x):
            place = self._in_other_chart(place)
        while True:
            part = (self._in_first if place.angles is None else self._in_second)(place, left)
            parts.add(part)
            left -= part.result.steps + part.result.rejected
            if part.after is None or part.after.t == self.plan.span[1] or left <= 0:
                names = self.between.names
                return parts.result(names, dense_output=self.plan.dense_output)
            place = part.after
            if part.changes:
                parts.changes.append(place.t)

    def _in_other_chart(self, place: Place) -> Place:
        return Place(place.t, *self.between.forth(place.t, place.x))

    def _simulate(
        self, compiled: Compiled, values: Array, place: Place, end: float, **more: Any
    ) -> Result:
        start, last = self.plan.span
        done, share = (place.t - start) / (last - start), (end - place.t) / (last - start)
        known = names_of(compiled.layout.inputs)
        grid, direction = self.plan.grid, math.copysign(1.0, last - start)
        own = None if grid is None else grid[self.parts.stored :]
        if own is not None and end != last:
            own = own[direction * (end - own) >= 0]
        return simulate_one(
            compiled,
            place.x,
            (place.t, end),
            values,
            t_eval=own,
            inputs={n: v for n, v in self.plan.inputs.items() if n in known},
            first_step=self.plan.first_step if place.t == start else None,
            progress=lambda part: self._told(done + share * part),
            **self.plan.options,
            **more,
        )

    def _told(self, part: float) -> None:
        if self.plan.progress is not None:
            self.plan.progress(part)

    def _in_first(self, place: Place, left: int) -> Part:
        plan, made = self.plan, self.made
        result = self._simulate(
            made.first, self.between.values(made.first), place, plan.span[1], atol=plan.atol,
            max_steps=left, margin=made.charts.enter, dense_output=plan.dense_output,
        )  # fmt: skip
        outputs = {**result.outputs, **{n: d.start + d.over_time for n, d in result.drift.items()}}
        closest = min(result.margin.values(), default=math.inf)
        part = Part(result, result.y, result.y_stop, outputs, result.sol, closest)
        if result.status != 1:
            return part
        there = self._in_other_chart(Place(result.t_stop, result.y_stop))
        return replace(part, after=there, changes=True)

    def _in_second(self, place: Place, left: int) -> Part:
        assert place.angles is not None
        result, found = self._followed(place, place.angles, self.plan.span[1], left)
        if found is None:
            x = self.between.states(place.x, place.angles)
            y = np.repeat(x[:, None], len(result.t), axis=1)
            return Part(result, y, x, result.outputs, None, self.made.charts.enter)
        if found.lost is not None and len(self.made.charts.second.singularities) > 1:
            return self._without_direction(place, result, found.lost, left)
        last = self.between.states(result.y_stop, found.last)
        part = self._part(result, found, last)
        if result.status == 1 and self._is_transfer(result):
            return replace(part, after=Place(result.t_stop, last), changes=True)
        if self._was_cut_short(result, place.t, left):
            return replace(part, after=Place(result.t_stop, result.y_stop, found.last))
        return part

    def _part(self, result: Result, found: Followed, last: Array) -> Part:
        keep = self.plan.dense_output
        dense = FollowedSolution(self.between, result.sol, found.path) if keep else None
        return Part(result, found.y, last, result.outputs, dense, found.closest)

    def _is_transfer(self, result: Result) -> bool:
        """Tell a stop at the border of a chart from one that nothing can be done about."""
        least = list(result.margin.values())
        return result.t_stop != self.plan.span[0] and least[0] <= 2 * NEARLY

    def _was_cut_short(self, result: Result, start: float, left: int) -> bool:
        """Tell a run that used up `PIECE` from one that failed; closed forms count no steps."""
        used = result.steps + result.rejected
        ended = result.status == -1 and result.t_stop != start
        return ended and left > PIECE and (used >= PIECE or used == 0)

    def _followed(
        self, place: Place, angles: Angles, end: float, left: int
    ) -> tuple[Result, Followed | None]:
        """Run in the second chart, at most `PIECE` steps, and follow the angles."""
        between, second = self.between, self.made.second
        values = between.values(second, branch=angles.branch)
        own = None if self.plan.atol is None else between.tolerances(self.plan.atol)
        result = self._simulate(
            second, values, place, end, atol=own,
            max_steps=min(left, PIECE), margin=NEARLY, dense_output=True,
        )  # fmt: skip
        if not result.sol:
            return result, None
        plan = result.t, self.plan.dense_output
        began = time.perf_counter()
        found = followed(between, result.sol, angles, result.t_stop, plan)
        seconds = result.seconds + time.perf_counter() - began
        return replace(result, seconds=seconds), found

    def _without_direction(self, place: Place, result: Result, end: float, left: int) -> Part:
        """Return a run in the second chart up to where the torque has no direction."""
        assert place.angles is not None
        singular = self.made.charts.second.singularities[-1]
        message = (
            f"stopped at t = {end:.9g} s: {singular.expression} = 0 is singular: {singular.meaning}"
        )
        if end == place.t:
            x = self.between.states(place.x, place.angles)
            kept = int(len(result.t) > 0 and result.t[0] == end)
            few = {n: v[:kept] for n, v in result.outputs.items()}
            stopped = replace(result, t=result.t[:kept], t_stop=end, status=1, message=message)
            distance = self.between.distance(place.x)
            return Part(stopped, np.repeat(x[:, None], kept, axis=1), x, few, None, distance)
        result, found = self._followed(place, place.angles, end, left)
        assert found is not None
        last = self.between.states(result.y_stop, found.last)
        return self._part(replace(result, status=1, message=message), found, last)

    def _named(self, part: Part, name: str) -> Array:
        """Return an output or constant of the motion at the points of a part."""
        if name in part.outputs:
            return part.outputs[name]
        layout, t = self.made.first.layout, self.plan.start + part.result.t
        group = OUTPUTS if name in layout.results[OUTPUTS] else INVARIANTS
        if not len(t):
            return np.empty(0)
        rows = [_at(self.plan.inputs[n], t) for n in names_of(layout.inputs)]
        u = np.array(rows).reshape(len(rows), len(t))
        function = self.made.first.functions[group]
        found = function(t, part.y, self.between.values(self.made.first), u)
        return np.asarray(found[layout.results[group].index(name)])


def _at(signal: InputValue, times: Array) -> Array:
    """Return an input over time."""
    return np.array([signal(t) if callable(signal) else signal for t in times.tolist()])
