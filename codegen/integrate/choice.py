"""The method `auto`: what fits a problem best, by rules that are measured, and what was decided why.

In order: the closed form where the system with these values has one; a stiff method where explicit
steps are limited by stability for so long that implicit ones cost less; the Taylor series where the
rates are smooth, every operation has a rule, all is in generated C, and straight-line code of
reasonable size does it; else DOP853.

Stiffness is looked for three times. At the start the norm of the Jacobian, from one call of the rates
a state, excludes it for most problems (10 us for four states; all in all `auto` costs 30 us a run, see
`benchmarks/auto.py`). Where it does not, DOP853 makes `TRIAL` steps, and what limits the last of them
decides. A run that goes on looks again every
`WATCH` steps, and is continued by a stiff method from where it is. See `codegen.integrate.stiffness`.

Rates with branches (sign, abs, select) go to DOP853, which finds a kink by rejecting steps of 12
evaluations, where a series makes a new one or halves it many times: dry friction to 1e-9 takes 0.12 ms,
and 0.21 ms by Taylor; a spring with |x| takes 0.10 and 0.18 ms with 4e-8 and 6e-7 of error.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from codegen import closed_forms, native
from codegen.compiled import Compiled
from codegen.identity import SameObject
from codegen.integrate import closed, stiffness, taylor
from codegen.integrate.trajectory import Array, Problem, Trajectory
from codegen.lower import RATES
from codegen.taylor import prepare
from codegen.taylor_cost import operations
from eom.errors import InputError

if TYPE_CHECKING:
    from codegen.integrate.methods import Task

Integrator = Callable[[Problem], Trajectory]
Prepare = Callable[["Task"], tuple[Integrator, str]]

TRIAL = 256
WATCH = {True: 20_000, False: 500}
"""Steps between two looks, in generated C and in Python: a look costs 0.1 ms, so many steps 3 ms."""
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
    found = None if task.signals is not None else closed_forms.find(task.compiled, task.problem)
    if found is not None:
        name = f"closed form: {found.name}"
        return _told(lambda p: closed.integrate(task.compiled, found, p), name, found.meaning), name
    stiff = _stiff_from_the_start(task, methods)
    if stiff is not None:
        run, name = methods[_implicit(stiff, task)](task)
        return _told(run, name, f"stiff: in a trial of {TRIAL} steps {stiff}"), name
    chosen = _explicit(task)
    try:
        run, name = methods[chosen.method](task)
    except native.CompilerError as error:
        chosen = Explicit("DOP853", f"{chosen.method}: {error.what}", stiffness.DOP853_REACH)
        run, name = methods[chosen.method](task)
    return _watched(task, methods, chosen, run, name), name


def _with_events(task: Task, methods: Mapping[str, Prepare]) -> tuple[Integrator, str]:
    """Return an explicit method: it finds events, which the closed forms and stiff methods do not."""
    chosen = _explicit(task)
    run, name = methods[chosen.method](task)
    return _told(run, name, f"events are looked for, by explicit methods alone; {chosen.why}"), name


def _told(run: Integrator, name: str, why: str) -> Integrator:
    return lambda problem: replace(run(problem), method=name, why=why)


def _implicit(stiff: stiffness.Stiff, task: Task) -> str:
    """LSODA costs a twentieth of the others, but like all BDF fails where stiff modes oscillate.

    Neither can project its states onto invariants.
    """
    if stiff.oscillates or task.problem.project:
        return "scipy:Radau"
    return "scipy:BDF" if len(task.compiled.layout.states) >= MANY else "scipy:LSODA"


MANY = 100
"""States from which on LSODA's full matrices cost more than sparse ones of BDF."""


def _inputs(task: Task, t: float) -> Array:
    return task.problem.inputs if task.signals is None else task.signals(t)


def _stiff_from_the_start(task: Task, methods: Mapping[str, Prepare]) -> stiffness.Stiff | None:
    compiled, problem = task.compiled, task.problem
    u, worth = _inputs(task, problem.t_span[0]), stiffness.WORTH[_is_native(task)]
    if not stiffness.promising(compiled, problem, u, worth):
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
    u = _inputs(task, made.stop.t)
    return stiffness.limited(compiled, problem, at, u, stiffness.DOP853_REACH, worth)


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
            return Explicit("taylor", why, stiffness.taylor_reach(order))
    return Explicit("DOP853", f"not stiff; no Taylor series: {against}", stiffness.DOP853_REACH)


@lru_cache(maxsize=256)
def _against_series(key: SameObject[Compiled], order: int) -> str:
    """Return what speaks against Taylor series of an order, or nothing."""
    compiled = key.value
    try:
        series = prepare(compiled.program, RATES, compiled.layout)
    except InputError as error:
        return error.what
    if series.has_branches:
        return "the rates have branches"
    count = operations(series, order)
    return f"{count:,} operations in a row" if count > LONGEST else ""


LONGEST = 64_000
"""Operations of all coefficients of a series."""


def _watched(
    task: Task, methods: Mapping[str, Prepare], chosen: Explicit, run: Integrator, name: str
) -> Integrator:
    """Run an explicit method; go on with a stiff one from where it turns out to be limited."""

    def integrator(problem: Problem) -> Trajectory:
        found: list[stiffness.Stiff] = []
        worth = stiffness.WORTH[_is_native(task)]

        def limited(t: float, x: Array, h: float) -> bool:
            at, u = (t, x, h), _inputs(task, t)
            stiff = stiffness.limited(task.compiled, problem, at, u, chosen.reach, worth)
            found.extend([stiff] if stiff else [])
            return stiff is not None

        every = WATCH[_is_native(task)]
        first = run(replace(problem, watch=limited, watch_every=every))
        if not found or first.stop.kind != LEFT:
            return replace(first, method=name, why=chosen.why)
        rest = _rest(problem, first)
        further, other = methods[_implicit(found[0], task)](replace(task, problem=rest))
        both = joined(first, further(rest), problem)
        t = f"t = {first.stop.t:.6g} s"
        why = f"{chosen.why}; stiff from {t} on: {found[0]}"
        return replace(both, method=f"{name} to {t}, then {other}", why=why)

    return integrator


def _rest(problem: Problem, first: Trajectory) -> Problem:
    """Return what is left of a problem after a first part."""
    grid, t = problem.t_eval, first.stop.t
    return replace(
        problem,
        x0=first.state_at_stop,
        t_span=(t, problem.t_span[1]),
        t_eval=None if grid is None else grid[len(first.t) :],
        first_step=None,
        max_steps=max(1, problem.max_steps - first.steps - first.rejected),
        progress=lambda part: problem.report(t + part * (problem.t_span[1] - t)),
    )


def joined(first: Trajectory, second: Trajectory, problem: Problem) -> Trajectory:
    """Return two trajectories, of which the second starts where the first stops, as one.

    Where every step is stored the point that both have stands once.
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
