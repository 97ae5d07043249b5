"""Simulate a system: integrate, evaluate outputs, and measure the drift of every invariant."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from codegen import arguments, requested
from codegen import events as looked_for
from codegen.compiled import Compiled
from codegen.compiled import compile as compile_system
from codegen.events import Event, Given, Occurrences
from codegen.identity import SameObject
from codegen.integrate import scipy_
from codegen.integrate.methods import Task, can_project, integrator_of
from codegen.integrate.projection import chosen
from codegen.integrate.trajectory import MAX_STEPS, Array, Problem, Trajectory
from codegen.layout import names_of, to_array
from codegen.lower import INVARIANTS, OUTPUTS, SINGULARITIES
from eom.errors import unknown_name
from eom.system import System

DEFAULT_MARGIN = 1e-6
RELATIVE_FLOOR = 1e-8
"""A constant that starts below its change under so small a change of the states counts as zero."""

Values = Mapping[str, float] | Sequence[float] | Array | None
Signal = float | Callable[[float], float]


@dataclass(frozen=True)
class Drift:
    """How far a constant of the motion wandered from its first value, over the stored points.

    ``start``: the first value; ``largest``: the largest change from it, both in the unit of the invariant.
    """

    start: float
    largest: float
    floor: float = field(compare=False)
    """Change of the first value if every state changes by `RELATIVE_FLOOR` of itself."""
    over_time: Array = field(compare=False, repr=False)
    """Value less first value at each stored point, (N,)."""

    @property
    def scale(self) -> float:
        """What the change is compared with: the first value, or 1 if that is zero but for rounding."""
        return abs(self.start) if abs(self.start) > self.floor else 1.0

    @property
    def relative(self) -> float:
        """The largest change over the scale."""
        return self.largest / self.scale


@dataclass(frozen=True)
class Result:
    """A trajectory, with SciPy's field names and what belongs to mechanics.

    ``t`` (N,), ``y`` (n, N), ``sol`` (dense output or None), ``nfev``, ``status`` (0: end reached;
    1: stopped at a singular configuration; 2: at a terminal event; -1: stopped because numbers
    failed), ``message``, ``success`` (status >= 0). ``events``: what was found, by name;
    ``t_events`` and ``y_events``: the same in order, as SciPy has them. ``names``: of the states, in the
    order of ``y``; ``result[name]`` gives one of them, or an output.
    ``outputs``: arrays (N,) by name. ``drift``: by name of the invariant.
    ``margin``: least distance from each singularity, by its expression. ``t_stop`` and ``y_stop`` (n,):
    where the run stopped. ``method``: what integrated, in ``seconds``; ``why``: the reason, where
    the method was chosen and not given. ``steps`` were made, ``rejected`` tried in vain. ``notice``: what
    the user should know. Units are those of the system.
    """

    t: Array
    y: Array
    sol: Any
    nfev: int
    status: int
    message: str
    outputs: Mapping[str, Array]
    drift: Mapping[str, Drift]
    margin: Mapping[str, float]
    t_stop: float
    y_stop: Array
    method: str
    steps: int
    rejected: int
    seconds: float = 0.0
    notice: str = ""
    why: str = ""
    names: tuple[str, ...] = field(default=())
    left_out: tuple[str, ...] = ()
    """States and constants of the motion that the requested outputs do not need."""
    changes: tuple[float, ...] = field(default=(), repr=False)
    """Times at which angles were handed over and taken back (`codegen.handover`)."""
    events: Mapping[str, Occurrences] = field(default_factory=dict, repr=False)

    def __repr__(self) -> str:
        """Say how the run ended and what it holds."""
        names = ", ".join((*self.names, *self.outputs))
        drift = ", ".join(f"{n} {d.relative:.1e}" for n, d in self.drift.items())
        drifts = f"; drift {drift}" if drift else ""
        return (
            f"Result({self.message}; {len(self.t)} points of {names}; {self.steps} steps{drifts})"
        )

    @property
    def success(self) -> bool:
        """True if the end, a singular configuration or a terminal event was reached."""
        return self.status >= 0

    @property
    def t_events(self) -> list[Array]:
        """Times (K,) of each event, in order."""
        return [found.t for found in self.events.values()]

    @property
    def y_events(self) -> list[Array]:
        """States (K, n) at each event, in order."""
        return [found.y.T for found in self.events.values()]

    def __getitem__(self, name: str) -> Array:
        """Return the values (N,) of a state or output by ``name``. Raises `InputError` for others."""
        if name in self.outputs:
            return self.outputs[name]
        if name in self.names:
            row: Array = self.y[self.names.index(name)]
            return row
        raise unknown_name("state or output", name, [*self.names, *self.outputs])


def simulate(
    system: System | Compiled,
    initial: Values,
    t_span: tuple[float, float],
    parameters: Values = None,
    method: str = "auto",
    rtol: float = 1e-9,
    atol: ArrayLike | None = None,
    t_eval: ArrayLike | None = None,
    *,
    inputs: Mapping[str, Signal] | None = None,
    outputs: Sequence[str] | None = None,
    dense_output: bool = False,
    first_step: float | None = None,
    max_step: float = math.inf,
    max_steps: int = MAX_STEPS,
    margin: float = DEFAULT_MARGIN,
    project: bool | str | Sequence[str] | None = None,
    events: Given = None,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Integrate ``system`` from ``initial`` over ``t_span`` (s); backwards if the end is earlier.

    ``initial``, ``parameters``: numbers by name or in order. ``inputs``: a number or a function of
    time for each input; functions are called from Python. ``method``: one of `METHODS`.
    ``outputs``: names of outputs and states; only states that these need are integrated. ``rtol``,
    ``atol``: steps meet the local error atol + rtol |x| (``atol``, a number or (n,): rtol / 1000 unless
    given). ``t_eval``: times to store; without it every step, of a closed form 1001 times.
    ``dense_output``: whether ``sol`` is made, a function of time. ``first_step``, ``max_step``: limits of
    steps (s); ``max_steps``: of their number. ``margin``: the run stops where a singularity's expression
    gets below it. ``progress``: called with the share that is done, 0 to 1.

    ``project``: invariants, by name or True for all, onto which the state is brought back after each
    step, by the least change (`codegen.integrate.projection`); all stored points lie on them. Without
    it, those that the system maintains: what constraints leave, if the method can project. The
    dense output goes through the points of the steps, and off the invariants between them by its own
    error. Methods that carry values of earlier steps along cannot project. ``events``: zeros of
    expressions to find, `codegen.events.Event` or expressions, in order or by name; of the methods
    that run in generated C, taylor, DOP853, DP5 and Tsit5 find them. The states that they read are
    integrated with those that ``outputs`` need.

    Never raises for what happens on the way: it keeps what it has and says in ``status`` and
    ``message`` which quantity failed and when. Raises `InputError` for unusable arguments, and
    `AssumptionError` for values that contradict the system's assumptions. Units are those of the system.
    Sources: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), sect. II.5 and
    II.6; Jorba and Zou, Experimental Mathematics 14 (2005); others in the modules of `codegen.integrate`.

    >>> import sympy as sp
    >>> y, v, k = sp.symbols("y v k", real=True)
    >>> energy = {"energy": (v**2 + k * y**2) / 2}
    >>> oscillator = System.from_rates("oscillator", {y: v, v: -k * y}, invariants=energy)
    >>> compiled = compile_system(oscillator, "numpy")
    >>> run = simulate(compiled, {"y": 1, "v": 0}, (0, sp.pi), {"k": 4}, "scipy:DOP853")
    >>> run.status, round(float(run["y"][-1]), 6), run.drift["energy"].relative < 1e-8
    (0, 1.0, True)
    """
    found, span = looked_for.checked(events), arguments.span(t_span)
    part = _part(_compiled(system), outputs, found)
    x0, values, held, signals = _numbers(part, initial, parameters, inputs or {})
    problem = Problem(
        x0=x0,
        t_span=span,
        parameters=values,
        inputs=held,
        rtol=arguments.relative(rtol),
        atol=arguments.tolerances(atol, rtol, len(x0)),
        margin=arguments.positive(margin, "margin"),
        singularities=len(part.compiled.layout.results[SINGULARITIES]),
        t_eval=None if t_eval is None else arguments.grid(t_eval, span),
        dense_output=dense_output, first_step=arguments.optional(first_step, "first_step"),
        max_step=arguments.positive(max_step, "max_step"), max_steps=arguments.count(max_steps),
        project=_projected(part.compiled, project, method),
        progress=progress, events=looked_for.filters(found),
    )  # fmt: skip
    return _run(part, problem, method, signals, found)


def _projected(
    compiled: Compiled, project: bool | str | Sequence[str] | None, method: str
) -> tuple[str, ...]:
    """Return the invariants to project onto: by default those maintained, where the method can."""
    if project is not None:
        return chosen(compiled.layout, project)
    known = compiled.layout.results[INVARIANTS]
    maintained = tuple(n for n in compiled.system.maintained if n in known)
    return maintained if can_project(method) else ()


def _part(
    compiled: Compiled, outputs: Sequence[str] | None, events: Sequence[Event]
) -> requested.Part:
    """Return what the outputs, and the expressions of events, need of a system."""
    if outputs is None:
        return requested.part(compiled, None)
    return requested.part(compiled, [*outputs, *looked_for.states_of(compiled, events)])


def _numbers(
    part: requested.Part, initial: Values, parameters: Values, inputs: Mapping[str, Signal]
) -> tuple[Array, Array, Array, scipy_.Inputs | None]:
    """Return initial state, parameters, held inputs, and the function of all if one is a function."""
    held, signals = _inputs(part.compiled, inputs)
    x0 = _start(part.compiled, part.start(initial))
    return x0, _parameters(part.compiled, parameters, x0, held), held, signals


def _run(
    part: requested.Part,
    problem: Problem,
    method: str,
    signals: scipy_.Inputs | None,
    events: tuple[Event, ...],
) -> Result:
    compiled = part.compiled
    integrator, used = integrator_of(Task(compiled, problem, signals, events), method)
    began = time.perf_counter()
    trajectory = integrator(problem)
    seconds = time.perf_counter() - began if trajectory.seconds is None else trajectory.seconds
    problem.report(trajectory.stop.t)
    result = _result(compiled, problem, trajectory, signals)
    if trajectory.stop.kind == "event":
        at, label = f"t = {trajectory.stop.t:.9g} s", events[trajectory.stop.which].label
        result = replace(result, message=f"stopped at {at}: event {label}")
    return replace(
        result,
        events=looked_for.occurrences(events, trajectory.found),
        method=trajectory.method or used,
        why=trajectory.why,
        left_out=part.left_out,
        seconds=seconds,
    )


def _compiled(system: System | Compiled) -> Compiled:
    return system if isinstance(system, Compiled) else _compile_once(SameObject(system))


@lru_cache(maxsize=64)
def _compile_once(key: SameObject[System]) -> Compiled:
    return compile_system(key.value)


def _start(compiled: Compiled, initial: Values) -> Array:
    free = compiled.structure.without("state", initial)
    return to_array(free, names_of(compiled.layout.states), "initial value")


def _inputs(compiled: Compiled, given: Mapping[str, Signal]) -> tuple[Array, scipy_.Inputs | None]:
    """Return held values and, if any input is a function, the function of all inputs."""
    names = names_of(compiled.layout.inputs)
    inputs = compiled.structure.without("input", given)
    functions = {n: v for n, v in inputs.items() if callable(v)}
    values = {n: (0.0 if callable(v) else v) for n, v in inputs.items()}
    held = to_array(values, names, "input")
    if not functions:
        return held, None

    def at(t: float) -> Array:
        now = held.copy()
        for name, function in functions.items():
            now[names.index(name)] = function(t)
        return now

    return held, at


def _parameters(compiled: Compiled, parameters: Values, x0: Array, held: Array) -> Array:
    """Return the parameters in order; test all values against what the system assumes."""
    layout = compiled.layout
    names = names_of(layout.parameters)
    given = compiled.structure.without("parameter", parameters)
    spoken = given if isinstance(parameters, Mapping) else {}
    kept = {n: v for n, v in spoken.items() if n in names}
    known = dict(zip(names_of(layout.states), x0, strict=True))
    known |= dict(zip(names_of(layout.inputs), held, strict=True))
    if spoken != kept:
        compiled.guard.check(compiled.structure.completed({**known, **spoken}))
    values = to_array(kept if isinstance(parameters, Mapping) else parameters, names, "parameter")
    everything = {**known, **spoken, **dict(zip(names, values, strict=True))}
    compiled.guard.check(compiled.structure.completed(everything))
    return values


def _result(
    compiled: Compiled, problem: Problem, trajectory: Trajectory, signals: scipy_.Inputs | None
) -> Result:
    layout = compiled.layout
    values = {
        g: _evaluate(compiled, problem, trajectory, g, signals) for g in (OUTPUTS, INVARIANTS)
    }
    outputs = dict(zip(layout.results[OUTPUTS], values[OUTPUTS], strict=True))
    floors = _floors(compiled, problem)
    rows = zip(layout.results[INVARIANTS], values[INVARIANTS], floors, strict=True)
    drift = {n: drift_of(v, float(f)) for n, v, f in rows}
    stop = trajectory.stop
    return Result(
        t=trajectory.t,
        y=trajectory.y,
        sol=trajectory.solution,
        nfev=trajectory.evaluations,
        status={"end": 0, "singular": 1, "event": 2}.get(stop.kind, -1),
        message=_message(compiled, trajectory, problem.max_steps),
        outputs=outputs,
        drift=drift,
        margin=dict(zip(layout.results[SINGULARITIES], trajectory.closest, strict=True)),
        t_stop=stop.t,
        y_stop=trajectory.state_at_stop,
        method="",
        steps=trajectory.steps,
        rejected=trajectory.rejected,
        notice=compiled.notice,
        names=names_of(layout.states),
    )


def _evaluate(
    compiled: Compiled,
    problem: Problem,
    trajectory: Trajectory,
    group: str,
    signals: scipy_.Inputs | None,
) -> Array:
    """Evaluate a group of results at the stored points."""
    function = compiled.functions.get(group)
    count = len(trajectory.t)
    if function is None:
        return np.empty((0, count))
    u = problem.inputs
    if signals is not None:
        u = np.array([signals(t) for t in trajectory.t]).reshape(count, len(problem.inputs)).T
    return function(trajectory.t, trajectory.y, problem.parameters, u)


def drift_of(values: Array, floor: float) -> Drift:
    """Return the drift of a constant of the motion from its values at the stored points."""
    if not values.size:
        return Drift(0.0, 0.0, floor, values)
    change = values - values[0]
    return Drift(float(values[0]), float(np.max(np.abs(change))), floor, change)


def _floors(compiled: Compiled, problem: Problem) -> Array:
    """Return for each invariant by how much it changes if the first states change a little."""
    function = compiled.functions.get(INVARIANTS)
    if function is None:
        return np.empty(0)
    x = problem.x0
    points = np.column_stack([x, x[:, None] + np.diag(RELATIVE_FLOOR * x)])
    values = function(problem.t_span[0], points, problem.parameters, problem.inputs)
    return np.asarray(np.sum(np.abs(values[:, 1:] - values[:, :1]), axis=1))


def _message(compiled: Compiled, trajectory: Trajectory, max_steps: int) -> str:
    stop, names = trajectory.stop, names_of(compiled.layout.states)
    at = f"stopped at t = {stop.t:.9g} s"
    if stop.kind == "end":
        return f"reached t = {stop.t:.9g} s"
    if stop.kind == "singular":
        singularity = compiled.system.singularities[stop.which]
        if singularity.coordinate.name not in names:
            return f"{at}: {singularity.expression} = 0 is singular: {singularity.meaning}"
        angle = trajectory.state_at_stop[names.index(singularity.coordinate.name)]
        return (
            f"{at}: {singularity.coordinate} = {angle:.9g} rad ({math.degrees(angle):.6f} deg) "
            f"is singular, {singularity.expression} = 0: {singularity.meaning}"
        )
    if stop.kind == "not finite":
        return f"{at}: {names[stop.which]} or its rate is not finite (NaN or infinity) beyond it"
    if stop.kind == "step":
        return (
            f"{at}: the step fell below the resolution of time; the tolerance cannot be met there, "
            "or the rates on both sides of a jump lead back to it (friction at rest)"
        )
    if stop.kind == "memory":
        return f"{at}: no memory for more steps; give t_eval to store less"
    return (
        f"{at}: all of max_steps = {max_steps:,} were tried; look for a jump in the rates "
        "(friction, sign) or stiffness, or raise max_steps"
    )
