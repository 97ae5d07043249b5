"""Simulate a system: integrate, evaluate outputs, and measure the drift of every invariant.

A run that stops says in words when, which quantity failed, and what to do about it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from codegen.compiling import events as looked_for
from codegen.compiling import sampled
from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.compiling.events import Event, Given, Occurrences
from codegen.compiling.sampled import Along, Sampled
from codegen.compiling.signals import Followed, Inputs, reads_state
from codegen.frontend.layout import completed, in_si, names_of, settled, to_array
from codegen.integrate import scales as sizes_of
from codegen.integrate.choice import Task
from codegen.integrate.methods import can_project, integrator_of
from codegen.ir.program import INVARIANTS, OUTPUTS, SINGULARITIES, SameObject
from codegen.loops.projection import chosen
from codegen.native.trajectory import MAX_STEPS, Array, Law, Problem, Trajectory
from codegen.runs import arguments, pruning
from codegen.runs.clock import Clock, Late, clock_of
from codegen.runs.pruning import Drift, Terms, drift_of
from codegen.runs.run_accuracy import Accuracy, Run, accuracy_of
from codegen.runs.second_run import Origin
from codegen.runs.turns import Sampled as AtSamples
from codegen.runs.turns import counted
from eom.errors import InputError, typed, unknown_name
from eom.system import Singularity, System

DEFAULT_MARGIN = 1e-6

Values = Mapping[str, float | str] | Sequence[float] | Array | None
InputValue = float | str | Callable[..., float] | Sampled
InputsGiven = Mapping[str, InputValue] | Callable[..., Any] | Sampled


@dataclass(frozen=True)
class NotKept:
    """What stands for a dense output that was not made: it is false, and says so when it is called.

    Raises `InputError` when it is called.
    """

    def __bool__(self) -> bool:
        """Return False."""
        return False

    def __call__(self, *_: ArrayLike) -> Array:
        """Raise `InputError`: there are no values at any time (s)."""
        raise InputError(
            "the run has no dense output",
            hint="simulate with dense_output=True, or ask for times by t_eval",
        )


@dataclass(frozen=True)
class Result:
    """A trajectory, with SciPy's field names and what belongs to mechanics.

    ``t`` (N,), ``y`` (n, N), ``sol`` (dense output, or `NotKept`, which is false), ``nfev``,
    ``status`` (0: end reached;
    1: stopped at a singular configuration; 2: at a terminal event; -1: stopped because numbers
    failed), ``message``, ``success`` (status >= 0). ``events``: what was found, by name;
    ``t_events`` and ``y_events``: the same in order, as SciPy has them. ``names``: of the states, in the
    order of ``y``; ``result[name]`` gives one of them, an output, or what kept its initial value: ``held``,
    by name the states that became parameters.
    ``outputs``: arrays (N,) by name, angles of a quaternion with their whole turns (`codegen.runs.turns`).
    ``drift``: by name of the invariant.
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
    events: Mapping[str, Occurrences] = field(default_factory=dict, repr=False)
    held: Mapping[str, float] = field(default_factory=dict, repr=False)
    origin: object = field(default=None, repr=False, compare=False)
    """What it came from, for `accuracy`; it stays behind when a result is pickled."""
    estimate: Accuracy | None = field(default=None, repr=False, compare=False)
    """What `with_accuracy` found."""

    @typed
    def accuracy(self, limit: float | None = None) -> Accuracy:
        """Return an estimate of the error of every state, and of how errors grow.

        A second run, by another kind of method at a thousandth of the tolerance or less, gives the error;
        the derivative along it shows how errors grow. ``limit``: seconds of processor time for that, by
        default five times what the run took, 2 s at least; where they do not do, the estimate says so.
        Units are those of the system. Raises `InputError` for a result that was pickled, read or put
        together, and so does not know what it came from. See `codegen.Accuracy`.
        """
        if self.estimate is not None:
            return self.estimate
        run = Run(
            self.t, self.y, self.t_stop, self.y_stop,
            self.status, self.steps, self.seconds, self.origin,
        )  # fmt: skip
        return accuracy_of(run, limit)

    @typed
    def with_accuracy(self, limit: float | None = None) -> Result:
        """Return the same with the estimate of `accuracy`, whose warning then is in ``notice``.

        ``limit`` and what is raised: as for `accuracy`.
        """
        found = self.accuracy(limit)
        warning = "" if self.estimate else found.warning
        return replace(self, estimate=found, notice=_joined(self.notice, warning))

    def __getstate__(self) -> dict[str, Any]:
        """Pickle and copy what was found, not what it came from."""
        return {**self.__dict__, "origin": None}

    def __copy__(self) -> Result:
        """Copy with what it came from."""
        return replace(self)

    def __post_init__(self) -> None:
        """Put in place of a dense output that was not made what says so."""
        if self.sol is None:
            object.__setattr__(self, "sol", NotKept())

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
        if name in self.held:
            return np.full(len(self.t), self.held[name])
        raise unknown_name("state or output", name, [*self.names, *self.outputs, *self.held])


@typed
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
    inputs: InputsGiven | None = None,
    outputs: Sequence[str] | None = None,
    dense_output: bool = False,
    first_step: float | None = None,
    max_step: float = math.inf,
    max_steps: int = MAX_STEPS,
    margin: float = DEFAULT_MARGIN,
    project: bool | str | Sequence[str] | None = None,
    events: Given = None,
    epoch: float = 0.0,
    accuracy: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Result:
    """Integrate ``system`` from ``initial`` over ``t_span`` (s); backwards if the end is earlier.

    ``initial``, ``parameters``: numbers by name or in order; by name also texts with units, as "30 deg"
    (`eom.units`), which are put into SI. A state whose rate is zero, and which became a parameter of a
    scene's system, may stand among either; the initial value counts. ``inputs``: a number or a function for each input, or one
    function of all that returns them by name or in order. Functions are of time, f(t), or of time and
    states, f(t, x) with ``x["theta"]``, by what they take: what can be called with the time alone is
    f(t). They are called from Python, and may state their knots and longest step (`codegen.Signal`).
    ``method``: one of `METHODS`. ``outputs``: names of outputs and states; only states that these need
    are integrated. ``rtol``, ``atol``: steps meet the local error atol + rtol |x| (``atol``, a number or
    (n,): rtol / 1000 of the scale of each state unless given, see `codegen.integrate.scales`).
    ``t_eval``: times to store; without it every step, with a closed form 1001 times at equal distances.
    ``dense_output``: whether ``sol`` is made, a function of time. ``first_step``, ``max_step``: limits of
    steps (s); a feature of the rates that is narrower than a step may be stepped over, unless
    ``max_step`` is shorter. ``max_steps``: of their number. ``margin``: the run stops where a
    singularity's expression gets below it. ``progress``: called with the share that is done, 0 to 1.

    ``project``: invariants, by name or True for all, onto which the state is brought back after each
    step, by the least change (`codegen.loops.projection`); all stored points lie on them. Without
    it, those that the system maintains: what constraints leave, if the method can project. The
    dense output goes through the points of the steps, and off the invariants between them by its own
    error. Methods that carry values of earlier steps along cannot project. ``events``: zeros of
    expressions to find, `codegen.compiling.events.Event` or expressions, in order or by name; of the
    methods that run in generated C, taylor, DOP853, DP5 and Tsit5 find them. The states that they read are
    integrated with those that ``outputs`` need.

    ``epoch``: time (s) of the system at which t is zero: its rates read epoch + t, all times that are
    given or returned are since then, with digits of their own. A run that starts late without one keeps
    its digits too (`codegen.runs.clock`), but its times are then rounded where they are stored.
    ``accuracy``: whether the error is estimated by a second run, so that ``notice`` says where no digit
    is left (`Result.accuracy`, which by itself says the same afterwards).

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
    rtol, since = arguments.relative(rtol), arguments.finite(epoch, "epoch")
    values = initial, parameters, inputs or {}
    given = _given(_compiled(system), values, outputs, found, span, since)
    compiled = given.part.compiled
    smallest, unknown = _smallest(given, atol, since, span, rtol)
    problem = Problem(
        given.x0, span, given.values, given.held, rtol, smallest, arguments.positive(margin, "margin"),
        singularities=len(compiled.layout.results[SINGULARITIES]), progress=progress,
        t_eval=None if t_eval is None else arguments.grid(t_eval, span), dense_output=dense_output,
        first_step=arguments.optional(first_step, "first_step"), max_steps=arguments.count(max_steps),
        max_step=arguments.positive(max_step, "max_step"), project=_projected(compiled, project, method),
        events=looked_for.filters(found), laws=given.laws,
    )  # fmt: skip
    run = given.part, problem, method, given.signals, found, clock_of(compiled, span, since, found)
    return _finished(_run(*run), unknown, accuracy)


def _in_si(compiled: Compiled, *values: Any) -> tuple[Any, ...]:
    """Return values by name in SI: those that are texts with units are converted."""
    return tuple(in_si(v, compiled.layout.known) for v in values)


def _finished(run: Result, unknown: str, accuracy: bool) -> Result:
    """Return a result that says which scales are not known, with its error if that is asked for."""
    result = replace(run, notice=_joined(run.notice, unknown if run.steps else ""))
    return result.with_accuracy() if accuracy else result


def _smallest(
    given: _Given, atol: ArrayLike | None, since: float, span: tuple[float, float], rtol: float
) -> tuple[Array, str]:
    """Return absolute tolerances, given or by the scales of the states, and which scales are not known."""
    if atol is None:
        point = given.point(since, span[0])
        return sizes_of.of_run(given.part.compiled, point, span, rtol, given.signals)
    return arguments.tolerances(atol, len(given.x0)), ""


def _joined(*notices: str) -> str:
    return "; ".join(n for n in notices if n)


def _projected(
    compiled: Compiled, project: bool | str | Sequence[str] | None, method: str
) -> tuple[str, ...]:
    """Return the invariants to project onto: by default those maintained, where the method can."""
    if project is not None:
        return chosen(compiled.layout, project)
    known = compiled.layout.results[INVARIANTS]
    maintained = tuple(n for n in compiled.system.maintained if n in known)
    return maintained if can_project(method) else ()


@dataclass(frozen=True)
class _Given:
    """What a user gives of a run, in order: states, parameters, held inputs, and what changes these."""

    part: pruning.Part
    laws: tuple[Law, ...]
    x0: Array
    values: Array
    held: Array
    signals: Inputs | None

    def point(self, since: float, start: float) -> sizes_of.Point:
        """Return where the run begins, behind the first samples."""
        at = (since + start, self.x0, self.values)
        first = sampled.first_inputs(self.part.compiled, self.laws, at, self.held)
        return sizes_of.Point(self.x0, self.values, first, since)


def _given(
    compiled: Compiled,
    values: tuple[Values, Values, InputsGiven],
    outputs: Sequence[str] | None,
    events: Sequence[Event],
    span: tuple[float, float],
    since: float,
) -> _Given:
    """Return what is given of a run: of ``values`` the initial ones, parameters and inputs.

    Symbolic laws among inputs are compiled with the system. ``since``: the time at which its own is zero.
    """
    compiled, rest, functions = sampled.split(compiled, values[2])
    initial, parameters = settled(*values[:2], compiled.layout.parameters)
    initial, parameters, rest = _in_si(compiled, initial, parameters, rest)
    part = _part(compiled, outputs, events, rest, bool(functions))
    laws = sampled.laws_of(part.compiled, functions)
    sampled.check_laws(laws, span)
    initial, rest = sampled.start_values(part.compiled, initial, rest)
    if functions:
        names = names_of(part.compiled.layout.inputs)
        rest = {**{names[k]: 0.0 for law in laws if law.called for k in law.applied}, **rest}
    return _Given(part, laws, *_numbers(part, initial, parameters, rest, span[0] + since))


def _part(
    compiled: Compiled,
    outputs: Sequence[str] | None,
    events: Sequence[Event],
    inputs: Mapping[str, InputValue] | Callable[..., Any],
    called: bool,
) -> pruning.Part:
    """Return what the outputs, and the expressions of events, need of a system.

    That is all of it where a Python function reads states, ``called`` at samples or always: nobody knows
    which; and where laws are sampled.
    """
    if outputs is not None and (called or compiled.system.sampled):
        pruning.part(compiled, outputs)  # the names are known
        outputs = None
    functions = [inputs] if callable(inputs) else inputs.values()
    if outputs is None or any(reads_state(f, "an input") for f in functions if callable(f)):
        return pruning.part(compiled, None)
    return pruning.part(compiled, [*outputs, *looked_for.states_of(compiled, events)])


def _numbers(
    part: pruning.Part, initial: Values, parameters: Values, inputs: InputsGiven, time: float
) -> tuple[Array, Array, Array, Inputs | None]:
    """Return initial state, parameters, held inputs, and the function of all if one is a function."""
    held, signals = _inputs(part.compiled, inputs)
    x0 = _start(part.compiled, part.start(initial))
    return x0, _parameters(part.compiled, parameters, x0, held, time), held, signals


def _run(
    part: pruning.Part,
    problem: Problem,
    method: str,
    signals: Inputs | None,
    events: tuple[Event, ...],
    clock: Clock | None,
) -> Result:
    if clock is None:
        return _result_of(Task(part.compiled, problem, signals, events), method, part.left_out)
    doubt = clock.doubt(problem.parameters, problem.rtol, signals)
    moved, inputs = clock.problem(problem), clock.signals(signals)
    task = Task(clock.relative.compiled, moved, inputs, events)
    return _in_users_time(_result_of(task, method, part.left_out), clock, problem, doubt)


def _in_users_time(result: Result, clock: Clock, problem: Problem, doubt: str) -> Result:
    """Return a result over the time of a run in the times of the user, who gave ``problem``."""
    start, ended = clock.start, result.status == 0
    t = clock.times(result.t, problem, ended=ended)
    again = len(t) - len(np.unique(t))
    coarse = f"{again} of {len(t)} times are stored like others: give t_span since an epoch"
    return replace(
        result,
        t=t,
        t_stop=problem.t_span[1] if ended else start + result.t_stop,
        sol=result.sol if not result.sol or not start else Late(result.sol, start),
        events={n: replace(e, t=start + e.t) for n, e in result.events.items()},
        notice="; ".join(n for n in (result.notice, doubt, coarse if again else "") if n),
    )


def _result_of(task: Task, method: str, left_out: tuple[str, ...]) -> Result:
    """Integrate, over the time of a task's problem."""
    problem, events = task.problem, task.events
    integrator, used = integrator_of(task, method)
    began = time.perf_counter()
    winding = any(a.winding for a in task.compiled.system.angles)
    trajectory = integrator(replace(problem, dense_output=problem.dense_output or winding))
    seconds = time.perf_counter() - began if trajectory.seconds is None else trajectory.seconds
    problem.report(trajectory.stop.t)
    return replace(
        _result(task, trajectory),
        events=looked_for.occurrences(events, trajectory.found),
        method=trajectory.method or used,
        why=trajectory.why,
        left_out=left_out,
        seconds=seconds,
        sol=trajectory.solution if problem.dense_output else NotKept(),
        origin=Origin(
            task.compiled,
            replace(problem, progress=None),
            task.signals,
            method,
            trajectory.methods or (method,),
            None if trajectory.held is None else _inputs_along(task, trajectory),
        ),
    )


def _compiled(system: System | Compiled) -> Compiled:
    return system if isinstance(system, Compiled) else compile_once(SameObject(system))


@lru_cache(maxsize=64)
def compile_once(key: SameObject[System]) -> Compiled:
    """Return a system compiled, the same again for the same object."""
    return compile_system(key.value)


def _start(compiled: Compiled, initial: Values) -> Array:
    states = compiled.layout.states
    free = completed(compiled.structure.without("state", initial), states)
    return to_array(free, names_of(states), "initial value")


def _inputs(compiled: Compiled, given: InputsGiven) -> tuple[Array, Inputs | None]:
    """Return held values and, if any input is a function, the function of all inputs."""
    names, states = names_of(compiled.layout.inputs), names_of(compiled.layout.states)
    if callable(given):
        if not names:
            raise InputError("the system has no inputs", got="a function of all inputs")
        held = np.zeros(len(names))
        return held, Inputs(held, names, given, states)
    inputs = compiled.structure.without("input", given)
    functions = {n: v for n, v in inputs.items() if callable(v)}
    values = {n: (0.0 if callable(v) else v) for n, v in inputs.items()}
    held = to_array(values, names, "input")
    return held, Inputs(held, names, functions, states) if functions else None


def _parameters(
    compiled: Compiled, parameters: Values, x0: Array, held: Array, time: float
) -> Array:
    """Return the parameters in order; test all values, and the time, against what the system assumes."""
    layout = compiled.layout
    names = names_of(layout.parameters)
    given = completed(
        compiled.structure.without("parameter", parameters), compiled.layout.parameters
    )
    spoken = given if isinstance(given, Mapping) else {}
    kept = {n: v for n, v in spoken.items() if n in names}
    known = dict(zip(names_of(layout.states), x0, strict=True))
    known |= dict(zip(names_of(layout.inputs), held, strict=True))
    if spoken != kept:
        compiled.guard.check(compiled.structure.completed({**known, **spoken}))
    values = to_array(kept if isinstance(given, Mapping) else given, names, "parameter")
    everything = {**known, **spoken, **dict(zip(names, values, strict=True))}
    compiled.guard.check(compiled.structure.completed(everything), time)
    return values


def _result(task: Task, trajectory: Trajectory) -> Result:
    compiled, problem, layout = task.compiled, task.problem, task.compiled.layout
    inputs = _inputs_along(task, trajectory)
    values = {g: _evaluate(compiled, problem, trajectory, g, inputs) for g in (OUTPUTS, INVARIANTS)}
    named = {
        **_held(task, trajectory),
        **dict(zip(layout.results[OUTPUTS], values[OUTPUTS], strict=True)),
    }
    outputs, winding = counted(AtSamples(compiled, problem, trajectory, inputs), named)
    terms = Terms(compiled, problem, trajectory, values[INVARIANTS], inputs)
    rows = enumerate(zip(layout.results[INVARIANTS], values[INVARIANTS], strict=True))
    drift = {n: drift_of(v, partial(terms.scale, k)) for k, (n, v) in rows}
    stop, blind = trajectory.stop, task.signals.notice if task.signals else ""
    return Result(
        t=trajectory.t,
        y=trajectory.y,
        sol=trajectory.solution,
        nfev=trajectory.evaluations,
        status={"end": 0, "singular": 1, "event": 2}.get(stop.kind, -1),
        message=message(compiled, trajectory, problem, [e.label for e in task.events]),
        outputs=outputs,
        drift=drift,
        margin=dict(zip(layout.results[SINGULARITIES], trajectory.closest, strict=True)),
        t_stop=stop.t,
        y_stop=trajectory.state_at_stop,
        method="",
        steps=trajectory.steps,
        rejected=trajectory.rejected,
        notice=_joined(compiled.notice, trajectory.notice, blind, winding),
        names=names_of(layout.states),
        held={
            q.name: p for q, p in zip(layout.parameters, problem.parameters, strict=True) if q.held
        },
    )


def _inputs_along(task: Task, trajectory: Trajectory) -> Followed | None:
    """Return the inputs along a run, None where they were held all the way."""
    if trajectory.held is None:
        return task.signals
    return Along(trajectory.held, task.problem.laws, task.signals)


def _held(task: Task, trajectory: Trajectory) -> dict[str, Array]:
    """Return the inputs that laws held, by name, at the stored points."""
    if trajectory.held is None:
        return {}
    names, values = names_of(task.compiled.layout.inputs), trajectory.held.at(trajectory.t)
    return {names[k]: values[k] for law in task.problem.laws for k in (*law.applied, *law.stepped)}


def _evaluate(
    compiled: Compiled,
    problem: Problem,
    trajectory: Trajectory,
    group: str,
    signals: Followed | None,
) -> Array:
    """Evaluate a group of results at the stored points."""
    function = compiled.functions.get(group)
    count = len(trajectory.t)
    if function is None:
        return np.empty((0, count))
    u = problem.inputs if signals is None else signals.along(trajectory.t, trajectory.y)
    return function(trajectory.t, trajectory.y, problem.parameters, u)


def message(
    compiled: Compiled, trajectory: Trajectory, problem: Problem, events: Sequence[str]
) -> str:
    """Return when a run ended, why, and what to do about it; ``events``: what they are called."""
    stop, names = trajectory.stop, names_of(compiled.layout.states)
    at = f"stopped at t = {problem.time_text(stop.t)}"
    if stop.kind == "end":
        return f"reached t = {problem.time_text(problem.t_span[1])}"
    if stop.kind == "event":
        return f"{at}: event {events[stop.which]}"
    if stop.kind == "singular":
        return f"{at}: {_singular(compiled.system.singularities[stop.which], names, trajectory)}"
    if stop.kind == "not finite":
        where = f"{at}: {names[stop.which]} or its rate is not finite (NaN or infinity) beyond it"
        if stop.t != problem.t_span[0]:
            return where
        return f"{where} (a division by zero at the start: parts without mass?)"
    if stop.kind in _WORDS:
        return f"{at}: {_WORDS[stop.kind].format(max_steps=f'{problem.max_steps:,}')}"
    return (
        f"{at}: all of max_steps = {problem.max_steps:,} were tried; look for a jump in the rates "
        "(friction, sign) or stiffness, or raise max_steps"
    )


def _singular(found: Singularity, names: Sequence[str], trajectory: Trajectory) -> str:
    """Return at which coordinate a run stopped, what is zero there, and the way out if one is known."""
    meaning = "; ".join(w for w in (found.meaning, found.hint) if w)
    if found.coordinate.name not in names:
        return f"{found.expression} = 0 is singular: {meaning}"
    angle = trajectory.state_at_stop[names.index(found.coordinate.name)]
    return (
        f"{found.coordinate} = {angle:.9g} rad ({math.degrees(angle):.6f} deg) "
        f"is singular, {found.expression} = 0: {meaning}"
    )


_WORDS = {
    "step": (
        "the step fell below the resolution of time; the tolerance cannot be met there, "
        "or the rates on both sides of a jump lead back to it (friction at rest)"
    ),
    "coarse": (
        "equal steps that keep the relative tolerance are more than max_steps = {max_steps}; "
        "raise rtol or max_steps, or choose a method whose steps change"
    ),
    "thin": (
        "about an axis of small moment the rate follows from the momentum with a rounding error "
        "above its tolerance; give atol for it, or choose splitting or taylor"
    ),
    "memory": "no memory for more steps; give t_eval to store less",
}
"""What is said of kinds of stops that need nothing from the system."""
