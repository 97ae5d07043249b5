"""The method `auto`: what fits a problem best, by rules that are measured, and what was decided why.

In order: the closed form where the system with these values has one; a stiff method where explicit
steps are limited by stability for so long that implicit ones cost less; the Taylor series where the
rates are smooth, every operation has a rule, all is in generated C, and straight-line code of
reasonable size does it; else DOP853.

Stiffness is looked for three times. At the start the norm of the Jacobian, from one call of the rates
a state, excludes it for most problems (10 us for four states; all in all `auto` costs 30 us a run, see
`benchmarks/auto.py`). Where it does not, DOP853 makes `TRIAL` steps, and what limits the last of them
decides. A run that goes on looks again every
`WATCH` steps, and is continued by a stiff method from where it is.

A Taylor series that stops early since its coefficients overflow (those of 1/cosh(a)^2 far from its
pulse), or since its steps vanish, is continued by DOP853 from there (`NEXT`), events and all.

Rates with branches (sign, abs, select) go to DOP853, which finds a kink by rejecting steps of 12
evaluations, where a series makes a new one or halves it many times: dry friction to 1e-9 takes 0.12 ms,
and 0.21 ms by Taylor; a spring with |x| takes 0.10 and 0.18 ms with 4e-8 and 6e-7 of error.

Steps limited by stability: the step h of an explicit method on y' = lambda y is bounded by h |lambda| <=
S, the length of its stability region along the negative axis: where h |lambda| is near S, for lambda an
eigenvalue of the Jacobian with negative real part, stability and not accuracy decides the step (Hairer and
Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996), sect. IV.2, where |lambda| is estimated
by the last stages). Here the eigenvalues are those of a Jacobian by differences, one call of the rates a
column: that needs nothing compiled and sees every eigenvalue, not the largest alone.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache, partial
from typing import Any

import numpy as np

from codegen.closed import closed_forms
from codegen.compiling import events
from codegen.compiling.compiled import Compiled
from codegen.compiling.signals import Inputs
from codegen.derivatives.taylor import operations, prepare
from codegen.frontend.layout import Layout
from codegen.integrate import closed
from codegen.integrate.scales import PART, units_of
from codegen.ir.interpret import Point
from codegen.ir.program import RATES, Program, SameObject
from codegen.loops import taylor
from codegen.loops.projection import units
from codegen.native import native
from codegen.native.trajectory import Array, Found, Problem, Trajectory, varied
from codegen.watch.trust import is_analytic
from eom.errors import InputError


@dataclass(frozen=True)
class Task:
    """What is to be integrated: ``signals`` give the inputs over time where they are functions."""

    compiled: Compiled
    problem: Problem
    signals: Inputs | None
    events: tuple[events.Event, ...] = ()


InputsAt = Callable[[float, Array], Array]
DOP853_REACH = 6.1
"""S of DOP853: Hairer and Wanner II, sect. IV.2."""
NEAR = 0.6
"""Part of S from which on a step counts as limited. Accuracy keeps h |lambda| of Taylor series below
0.2 S at all tolerances, and of DOP853 below 0.4 S up to 1e-3 (linear oscillator)."""
DAMPED = 0.05
"""Least -Re lambda/|lambda|: implicit methods must follow what hardly decays as well."""
WORTH = {True: 200_000, False: 5_000}
"""Explicit steps, in generated C or in Python, that cost as much as a whole implicit run. Van der Pol's
oscillator, mu = 1000, to t = 2000 at 1e-9: 584,000 steps in C take 0.07 s (Taylor) to 0.17 s (DOP853),
LSODA 0.08 s, Radau 1.6 s; Robertson's problem to t = 400: 285,000 in 0.04 to 0.1 s, 0.02 s, 0.17 s."""
ROOT = math.sqrt(np.finfo(float).eps)
BDF_ANGLE = math.tan(math.radians(51.8))
"""|Im lambda|/|Re lambda| up to which BDF of order 5 is stable: Hairer and Wanner II, sect. V.2."""


@dataclass(frozen=True)
class Stiff:
    """The eigenvalue (1/s) that limits explicit steps, h |lambda|, and the steps that would be left."""

    eigenvalue: complex
    reach: float
    left: float

    @property
    def oscillates(self) -> bool:
        """Whether methods that are stable along the negative axis alone would be limited as well."""
        return abs(self.eigenvalue.imag) > BDF_ANGLE * abs(self.eigenvalue.real)

    def __str__(self) -> str:
        return (
            f"explicit steps were limited by stability, h |lambda| = {self.reach:.2g}, "
            f"with {self.left:.1e} of them to go"
        )


@cache
def taylor_reach(order: int) -> float:
    """Return S of a Taylor series: the first z > 0 with |1 - z + ... + (-z)^p/p!| > 1."""
    z, step = 1.0, 1.0 / 64
    while abs(math.fsum((-z) ** k / math.factorial(k) for k in range(order + 1))) <= 1.0:
        z += step
    return z


def promising(compiled: Compiled, problem: Problem, u: InputsAt, worth: int) -> bool:
    """Return whether stability may cost more than ``worth`` steps of DOP853, judged by the start alone.

    Costs as many calls of the rates as there are states where the norm of the Jacobian excludes it.
    """
    if _is_calm(compiled, problem, u, worth):
        return False
    start, end = problem.t_span
    span = abs(end - start)
    changes, slopes = _differences(compiled, problem, start, problem.x0, u)
    bound = float((np.abs(slopes).T @ (1.0 / changes)).max())
    if not math.isfinite(bound) or bound * span < worth * DOP853_REACH:
        return False
    J = slopes.T / changes
    worst = _worst(J, math.copysign(1.0, end - start))
    return worst is not None and abs(worst) * span >= worth * DOP853_REACH


def _is_calm(compiled: Compiled, problem: Problem, u: InputsAt, worth: int) -> bool:
    """Return whether the norm of the Jacobian alone excludes stiffness, in one call of C."""
    start, end = problem.t_span
    found = _steepest(compiled, problem, u)
    return found is not None and found * abs(end - start) * ROUNDING < worth * DOP853_REACH


ROUNDING = 1 + 1e-9
"""More than two sums of the same terms in another order differ by, relative to them."""


def _steepest(compiled: Compiled, problem: Problem, u: InputsAt) -> float | None:
    """Return the bound of the norm, but for rounding, by `codegen/native/runs.c`; None without C."""
    extension = native.extension() if compiled.target == "c" else None
    if extension is None:
        return None
    start, x = problem.t_span[0], problem.x0
    found: float | None = extension.steepest(
        compiled.rhs, x, problem.parameters, u(start, x), units_of(compiled)[0], start, problem.atol,
        problem.rtol,
    )  # fmt: skip
    return found


def limited(
    compiled: Compiled,
    problem: Problem,
    at: tuple[float, Array, float],
    u: InputsAt,
    reach: float,
    worth: int,
) -> Stiff | None:
    """Return what limits a run whose last step was h at t and x, ``at`` = (t, x, h), or None.

    ``reach``: S of the method. None also where less than ``worth`` steps are left.
    """
    t, x, h = at
    left = abs((problem.t_span[1] - t) / h) if h else 0.0
    if left < worth:
        return None
    changes, slopes = _differences(compiled, problem, t, x, u)
    J = slopes.T / changes
    worst = _worst(J, math.copysign(1.0, h)) if np.all(np.isfinite(J)) else None
    if worst is None or abs(h * worst) < NEAR * reach:
        return None
    return Stiff(worst, abs(h * worst), left)


def _differences(
    compiled: Compiled, problem: Problem, t: float, x: Array, u: InputsAt
) -> tuple[Array, Array]:
    """Return by how much each state is moved, about 1e-8 of its size, and in rows how the rates change."""
    rates, p, n = compiled.rhs, problem.parameters, len(x)
    moved = x + ROOT * np.maximum(np.abs(x), _least(compiled, problem, x))
    point, slopes, here = x.copy(), np.empty((n, n)), rates(t, x, p, u(t, x))
    for j in range(n):
        point[j] = moved[j]
        rates(t, point, p, u(t, point), slopes[j])
        point[j] = x[j]
    with np.errstate(invalid="ignore"):  # rates that overflow; the caller looks for them
        slopes -= here
    return moved - x, slopes


def _least(compiled: Compiled, problem: Problem, x: Array) -> Array:
    """Return for each state the size below which it is moved as one of that size.

    What counts as zero by the tolerances, or a part of the largest state of its unit: beside that a
    change of 1e-8 of a much smaller state is lost in rounding.
    """
    known = np.array(units(compiled.layout))
    largest = np.zeros(known.max(initial=0) + 1)
    np.maximum.at(largest, known, np.abs(x))
    return np.asarray(np.maximum(problem.atol / problem.rtol, PART * largest[known]))


def _worst(J: Array, direction: float) -> complex | None:
    """Return the largest eigenvalue among those of motions that decay."""
    values = np.linalg.eigvals(J)
    decaying = values[-direction * values.real > DAMPED * np.abs(values)]
    return complex(decaying[np.argmax(np.abs(decaying))]) if decaying.size else None


Integrator = Callable[[Problem], Trajectory]
Prepare = Callable[["Task"], tuple[Integrator, str]]

TRIAL = 256
WATCH = {True: 20_000, False: 500}
"""Steps between two looks, in generated C and in Python: a look costs 0.1 ms, so many steps 3 ms."""
CLOSED_FORM = "closed form"
"""What stands among the names of methods for a closed form."""
LEFT = "left"
"""Kind of stop of a run that another method goes on with."""


@dataclass(frozen=True)
class Explicit:
    """An explicit method, why it was taken, and the length of its stability region."""

    method: str
    why: str
    reach: float


def prepared(task: Task, methods: Mapping[str, Prepare]) -> tuple[Integrator, str]:
    """Return the integrator of the best method and its name; its trajectory says why.

    ``methods``: what prepares each by name.
    """
    if task.events:
        return _with_events(task, methods)
    open_loop = task.signals is None and not task.problem.laws
    found = closed_forms.find(task.compiled, task.problem) if open_loop else None
    if found is not None:
        name = f"closed form: {found.name}"
        evaluate = partial(closed.integrate, task.compiled, found)
        return _reported(evaluate, name, found.meaning, CLOSED_FORM), name
    stiff = _stiff_from_the_start(task, methods)
    if stiff is not None:
        implicit = _implicit(stiff, task)
        run, name = methods[implicit](task)
        return _reported(run, name, f"stiff: in a trial of {TRIAL} steps {stiff}", implicit), name
    chosen = _explicit(task)
    try:
        ready = methods[chosen.method](task)
    except native.CompilerError as error:
        chosen = Explicit("DOP853", f"{chosen.method}: {error.what}", DOP853_REACH)
        ready = methods[chosen.method](task)
    return _going_on(task, methods, chosen, ready), ready[1]


Decided = tuple[Callable[[Array, Array], Trajectory | None], str]
"""What makes a run of initial states and absolute tolerances, and its name."""


def decided(task: Task, methods: Mapping[str, Prepare]) -> Decided | None:
    """Return what integrates problems with the values of a task from any initial state, and its name.

    It gives what `prepared` gives, or None from an initial state where more is to be decided. None at once
    where a closed form is known, or not all of a run is made in generated C.
    """
    if task.events or task.problem.laws or not _is_native(task):
        return None
    if closed_forms.is_known(task.compiled, task.problem):
        return None
    chosen = _explicit(task)
    try:
        ready = methods[chosen.method](task)
    except native.CompilerError:
        return None
    going = _Going(task, methods, chosen, ready)
    u, worth, whole, quick = _inputs(task), WORTH[True], task.problem, going.quick()

    def integrator(x0: Array, atol: Array) -> Trajectory | None:
        problem = varied(whole, x0=x0, atol=atol)
        if not _is_calm(task.compiled, problem, u, worth):
            return None
        return going.on(problem) if quick is None else going.quickly(quick, problem)

    return integrator, ready[1]


def _with_events(task: Task, methods: Mapping[str, Prepare]) -> tuple[Integrator, str]:
    """Return an explicit method: it finds events, which the closed forms and stiff methods do not."""
    chosen = _explicit(task)
    why = f"events are looked for, by explicit methods alone; {chosen.why}"
    ready = methods[chosen.method](task)
    return _going_on(task, methods, replace(chosen, why=why), ready), ready[1]


def _reported(run: Integrator, name: str, why: str, method: str) -> Integrator:
    return lambda problem: replace(run(problem), method=name, why=why, methods=(method,))


def _implicit(stiff: Stiff, task: Task) -> str:
    """LSODA costs a twentieth of the others, but like all BDF fails where stiff modes oscillate.

    Neither can project its states onto invariants.
    """
    if stiff.oscillates or task.problem.project:
        return "scipy:Radau"
    return "scipy:BDF" if len(task.compiled.layout.states) >= MANY else "scipy:LSODA"


MANY = 100
"""States from which on LSODA's full matrices cost more than sparse ones of BDF."""


def _inputs(task: Task) -> InputsAt:
    """Return the inputs (m,) as a function of time and state (n,)."""
    return task.signals or (lambda t, x: task.problem.inputs)


def _stiff_from_the_start(task: Task, methods: Mapping[str, Prepare]) -> Stiff | None:
    compiled, problem = task.compiled, task.problem
    u, worth = _inputs(task), WORTH[_is_native(task)]
    if not promising(compiled, problem, u, worth):
        return None
    trial = replace(
        problem,
        t_eval=None,
        dense_output=False,
        max_steps=min(TRIAL, problem.max_steps),
        progress=None,
    )
    made = methods["DOP853"](replace(task, problem=trial))[0](trial)
    if made.stop.kind != "max_steps" or made.steps < TRIAL // 2:
        return None
    h = float(np.median(np.diff(made.t[-TRIAL // 4 :])))
    at = made.stop.t, made.state_at_stop, h
    return limited(compiled, problem, at, u, DOP853_REACH, worth)


def _is_native(task: Task) -> bool:
    return task.compiled.target == "c" and task.signals is None


def _explicit(task: Task) -> Explicit:
    """Return Taylor or DOP853, and why."""
    if task.signals is not None:
        against = "inputs are Python functions"
    elif task.compiled.target != "c":
        against = f"the functions are of the target {task.compiled.target}, not in C"
    else:
        order = taylor.order_of(task.problem.rtol)
        against = _against_series(SameObject(task.compiled), order)
        if not against:
            why = "smooth rates, not stiff, a Taylor series for every operation"
            return Explicit("taylor", why, taylor_reach(order))
    return Explicit("DOP853", f"not stiff; no Taylor series: {against}", DOP853_REACH)


@lru_cache(maxsize=256)
def _against_series(key: SameObject[Compiled], order: int) -> str:
    return against_series(key.value.program, key.value.layout, order)


def against_series(program: Program, layout: Layout, order: int) -> str:
    """Return what speaks against Taylor series of an order, or nothing."""
    try:
        series = prepare(program, RATES, layout)
    except InputError as error:
        return error.what
    if series.has_branches:
        return "the rates have branches"
    count = operations(series, order)
    return f"{count:,} operations in a row" if count > LONGEST else ""


@lru_cache(maxsize=256)
def series_cost(key: SameObject[Compiled], order: int) -> float:
    """Return the operations of all coefficients of a series, infinity where there is none."""
    try:
        series = prepare(key.value.program, RATES, key.value.layout)
    except InputError:
        return math.inf
    return operations(series, order)


LONGEST = 64_000
"""Operations of all coefficients of a series."""


NEXT: Mapping[str, tuple[str, float]] = {"taylor": ("DOP853", DOP853_REACH)}
"""What goes on where an explicit method cannot, and the length of its stability region."""


def _going_on(
    task: Task, methods: Mapping[str, Prepare], chosen: Explicit, ready: tuple[Integrator, str]
) -> Integrator:
    """Run an explicit method; go on with another one from where stability limits it, or it is stuck."""
    return _Going(task, methods, chosen, ready).on


class _Going:
    """Runs by an explicit method, which others go on with where stability limits it, or it is stuck."""

    def __init__(
        self,
        task: Task,
        methods: Mapping[str, Prepare],
        chosen: Explicit,
        ready: tuple[Integrator, str],
    ) -> None:
        self.task, self.methods, self.chosen, (self.run, name) = task, methods, chosen, ready
        self.said = {"method": name, "why": chosen.why, "methods": (chosen.method,)}

    def on(self, problem: Problem) -> Trajectory:
        """Make a run of a problem."""
        look = _Look(self.task, problem, self.chosen)
        made = self.run(problem if self.task.events else look.watching())
        return self._whole(problem, varied(made, **self.said), look)

    def quick(self) -> Any:
        """Return what makes runs that differ in their values, if there is such a way."""
        way = getattr(self.run, "quick", None)
        problem = _Look(self.task, self.task.problem, self.chosen).watching()
        return None if way is None else way(problem, **self.said)

    def quickly(self, quick: Any, problem: Problem) -> Trajectory:
        """Make the same run as `on`; what a run needs behind its first call is made there."""
        look = _Look(self.task, problem, self.chosen)
        first = quick.integrate(
            problem.x0, problem.parameters, problem.inputs, problem.atol, look.onward
        )
        return first if first.stop.kind == "end" else self._whole(problem, first, look)

    def _whole(self, problem: Problem, first: Trajectory, look: _Look) -> Trajectory:
        if problem.laws:
            return _anew(self.task, self.methods, problem, first, look.stiff)
        if look.stiff is not None and first.stop.kind == LEFT:
            return _implicitly(self.task, self.methods, problem, first, look.stiff)
        return _onward(self.task, self.methods, problem, first)


def _anew(
    task: Task,
    methods: Mapping[str, Prepare],
    problem: Problem,
    first: Trajectory,
    stiff: Stiff | None,
) -> Trajectory:
    """Make a whole run by another method where the first is stuck, or limited by stability.

    Where laws are sampled the rest of a run does not know what they have held, and what is on its way.
    """
    if stiff is not None and first.stop.kind == LEFT:
        method, why = _implicit(stiff, task), f"stiff from {_when(problem, first)} on: {stiff}"
    elif first.stop.kind == "step" or first.stop.overflows:
        method, why = NEXT.get(first.methods[-1], ("", 0.0))[0], _stuck(problem, first)
    else:
        return first
    if not method:
        return first
    run, name = methods[method](task)
    whole = run(replace(problem, watch=None))
    if first.stop.kind != LEFT and whole.stop.kind not in ENDS:
        return first
    said = f"{why}; {method} made all of the run"
    return replace(whole, method=name, why=_both_notices(first.why, said), methods=(method,))


def _onward(
    task: Task, methods: Mapping[str, Prepare], problem: Problem, first: Trajectory
) -> Trajectory:
    """Go on where a method is stuck but not the solution, as far as that can be said."""
    if first.stop.kind == "step" or first.stop.overflows:
        return _beyond(task, methods, problem, first)
    return first


class _Look:
    """Whether stability limits a run, looked for now and then on the way."""

    def __init__(self, task: Task, problem: Problem, chosen: Explicit) -> None:
        self.task, self.problem, self.chosen = task, problem, chosen
        self.native = _is_native(task)
        self.stiff: Stiff | None = None

    def watching(self) -> Problem:
        """Return the problem, watched."""
        return self.onward(self.problem)

    def onward(self, problem: Problem) -> Problem:
        """Return a problem with the values of this one, watched."""
        return varied(problem, watch=self._limited, watch_every=WATCH[self.native])

    def _limited(self, t: float, x: Array, h: float) -> bool:
        at, u = (t, x, h), _inputs(self.task)
        reach, worth = self.chosen.reach, WORTH[self.native]
        self.stiff = limited(self.task.compiled, self.problem, at, u, reach, worth)
        return self.stiff is not None


def _implicitly(
    task: Task,
    methods: Mapping[str, Prepare],
    problem: Problem,
    first: Trajectory,
    stiff: Stiff,
) -> Trajectory:
    """Go on with a stiff method."""
    rest, implicit = _rest(problem, first), _implicit(stiff, task)
    run, name = methods[implicit](replace(task, problem=rest))
    second = replace(run(rest), method=name, methods=(implicit,))
    return joined(first, second, problem, f"stiff from {_when(problem, first)} on: {stiff}")


def _beyond(
    task: Task, methods: Mapping[str, Prepare], problem: Problem, first: Trajectory
) -> Trajectory:
    """Go on with the next method where one is stuck; the first part alone where that does not help.

    Where the rates are analytic and only numbers overflow nothing is wrong with the solution: as far as the
    next method gets counts. Else a singularity may be the reason, so that the next method must get to an
    end of the run, and a notice says what it passed.
    """
    method, reach = NEXT.get(first.methods[-1], ("", 0.0))
    if not method:
        return first
    rest = _rest(problem, first)
    further = replace(task, problem=rest)
    ready = methods[method](further)
    second = _going_on(further, methods, Explicit(method, "", reach), ready)(rest)
    sure, why = _overflow(task, first), _stuck(problem, first)
    if not second.steps or not (sure or second.stop.kind in ENDS):
        return replace(
            first, why=f"{first.why}; {why}, and {method} does not get to the end either"
        )
    both = joined(first, second, problem, why)
    passed = f"{why}, and {method} went on: if the rates are singular there, the rest says nothing"
    return both if sure else replace(both, notice=_both_notices(both.notice, passed), passed=True)


def resumed(task: Task, methods: Mapping[str, Prepare], first: Trajectory) -> Trajectory:
    """Go on where a Taylor series of many trajectories stopped, by the rule of one run.

    Whether coefficients overflow there, which these do not say, is found by a step of one series.
    """
    rest = _rest(task.problem, first)
    series, _ = methods[first.methods[-1]](replace(task, problem=rest))
    stop = replace(first.stop, overflows=series(replace(rest, max_steps=1)).stop.overflows)
    return _onward(task, methods, task.problem, replace(first, stop=stop))


def _overflow(task: Task, first: Trajectory) -> bool:
    """Return whether Taylor coefficients overflow where the rates are analytic."""
    if not first.stop.overflows:
        return False
    problem, compiled = task.problem, task.compiled
    values = (first.state_at_stop, problem.parameters, problem.inputs)
    point = Point(first.stop.t, *(v.tolist() for v in values))
    series = prepare(compiled.program, RATES, compiled.layout)
    return is_analytic(series, taylor.order_of(problem.rtol), point)


def _stuck(problem: Problem, first: Trajectory) -> str:
    """Return what kept a method from going on, and when."""
    what = (
        "Taylor coefficients are not finite"
        if first.stop.overflows
        else "steps fall below the resolution of time"
    )
    return f"{what} at {_when(problem, first)}"


def _both_notices(*notices: str) -> str:
    """Return texts as one."""
    return "; ".join(n for n in notices if n)


ENDS = frozenset({"end", "singular", "event"})
"""Kinds of stops that are no failure."""


def _when(problem: Problem, first: Trajectory) -> str:
    return f"t = {problem.time_text(first.stop.t, 6)}"


def _rest(problem: Problem, first: Trajectory) -> Problem:
    """Return what is left of a problem after a first part."""
    grid, t = problem.t_eval, first.stop.t
    counted = Counter(() if first.found is None else _counted(problem, first, first.found))
    return replace(
        problem,
        x0=first.state_at_stop,
        t_span=(t, problem.t_span[1]),
        t_eval=None if grid is None else grid[len(first.t) :],
        first_step=None,
        max_steps=max(1, problem.max_steps - first.steps - first.rejected),
        progress=lambda part: problem.report(t + part * (problem.t_span[1] - t)),
        events=tuple(
            replace(e, terminal=e.terminal and e.terminal - counted[k])
            for k, e in enumerate(problem.events)
        ),
    )


def _counted(problem: Problem, first: Trajectory, found: Found) -> list[int]:
    """Return the numbers of the events that a first part has found; at the start they do not count."""
    counts = (found.t != problem.t_span[0]) | (first.steps == 0)
    return [int(k) for k in found.which[counts]]


def joined(first: Trajectory, second: Trajectory, problem: Problem, why: str) -> Trajectory:
    """Return two trajectories, of which the second starts where the first stops, as one.

    Where every step is stored the point that both have stands once. ``why``: why the first was left.
    """
    again = int(problem.t_eval is None)
    solution = None
    if problem.dense_output:
        solution = second.solution if first.solution is None else first.solution
        if first.solution is not None and second.solution is not None:
            solution = JoinedSolution((first.solution, second.solution), first.stop.t)
    return replace(
        second,
        t=np.concatenate([first.t, second.t[again:]]),
        y=np.ascontiguousarray(np.concatenate([first.y, second.y[:, again:]], axis=1)),
        closest=tuple(map(min, first.closest, second.closest)),
        evaluations=first.evaluations + second.evaluations,
        steps=first.steps + second.steps,
        rejected=first.rejected + second.rejected,
        solution=solution,
        seconds=None if None in {first.seconds, second.seconds} else _sum(first, second),
        method=f"{first.method} to {_when(problem, first)}, then {second.method}",
        why=_both_notices(first.why, why, second.why),
        methods=(*first.methods, *second.methods),
        notice=_both_notices(first.notice, second.notice),
        found=_all_found(first, second),
        passed=first.passed or second.passed,
    )


def _sum(first: Trajectory, second: Trajectory) -> float:
    return (first.seconds or 0.0) + (second.seconds or 0.0)


def _all_found(first: Trajectory, second: Trajectory) -> Found | None:
    """Return the events of both parts; those where the second starts are the last of the first, if any.

    A first part without a step has looked for none.
    """
    one, other = first.found, second.found
    if one is None or other is None:
        return one or other
    new = (other.t != first.stop.t) | (first.steps == 0)
    return Found(
        np.concatenate([one.t, other.t[new]]),
        np.concatenate([one.x, other.x[new]]),
        np.concatenate([one.which, other.which[new]]),
        np.concatenate([one.direction, other.direction[new]]),
    )


class JoinedSolution:
    """Dense output of two parts; ``sol(t)`` has shape (n,) or (n, len(t))."""

    def __init__(self, parts: tuple[Any, Any], at: float) -> None:
        first, second = parts
        self.parts, self.at = parts, at
        self.ts = np.concatenate([first.ts, second.ts[1:]])
        self.t_min, self.t_max = min(self.ts[0], self.ts[-1]), max(self.ts[0], self.ts[-1])

    def __call__(self, t: Any) -> Array:
        """Evaluate; each time by the part that it lies in."""
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        forward = self.ts[-1] >= self.ts[0]
        early = times <= self.at if forward else times >= self.at
        first, second = (
            np.asarray(part(times[chosen] if chosen.any() else self.at)).reshape(
                len(part(self.at)), -1
            )
            for part, chosen in zip(self.parts, (early, ~early), strict=True)
        )
        values = np.empty((len(first), len(times)))
        values[:, early], values[:, ~early] = first[:, : early.sum()], second[:, : (~early).sum()]
        return values[:, 0] if np.ndim(t) == 0 else values
