"""Many trajectories of one system by one call of C, without a Python step between them.

Three kinds of generated text take the same job: Taylor series in vector lanes, and the scalar
integrators (Taylor, Runge-Kutta) in a loop.

Trajectories of an ensemble that a Taylor series left go on, each by the rule of one run.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled
from codegen.derivatives.taylor import Prepared, operations, prepare
from codegen.frontend.layout import Layout
from codegen.integrate import scipy_
from codegen.integrate.choice import NEXT, Task
from codegen.integrate.methods import resumed
from codegen.ir.names import identifier
from codegen.ir.program import RATES, SAMPLES, SINGULARITIES, Program
from codegen.loops import runge_kutta, running, samples, taylor, taylor_lanes
from codegen.loops.tableaux import DOP853
from codegen.native import children, native
from codegen.native.trajectory import Array, Law, Problem, Stop, Trajectory
from eom.errors import InputError, spelt, unknown_name
from eom.tables import Table

STATUS = {
    running.DONE: "end",
    running.SINGULAR: "singular",
    running.NOT_FINITE: "not finite",
    running.STEP_TOO_SMALL: "step",
    running.PAUSED: "max_steps",
}
"""Why a trajectory stopped, by the number in `Runs.status`."""
NUMBERS = {kind: number for number, kind in STATUS.items()}
Integers = NDArray[np.int32]


@dataclass(frozen=True)
class Shared:
    """What all trajectories have in common: times in s, tolerances, and where to stop.

    ``atol``: absolute tolerances, (n,), or (n, N) where each trajectory has its own; None where they
    follow from the scales of each trajectory, which only `codegen.ensembles.work_units` knows.
    """

    t_span: tuple[float, float]
    inputs: Array
    rtol: float
    atol: Array | None
    margin: float
    t_eval: Array
    max_step: float
    max_steps: int
    laws: tuple[Law, ...] = ()


@dataclass(frozen=True)
class Runs:
    """Trajectories side by side: ``y`` (times, n, N), ``t_stop`` (N,), ``y_stop`` (n, N).

    ``status`` (N,): numbers of `STATUS`; ``which``: of the singularity, or of the state that is not
    finite, else -1. ``y`` is NaN at times that a trajectory did not reach. ``continued`` (N,): 0, or what
    `codegen.integrate.fleet` says where another method went on. ``held`` (times, m, N): the inputs at
    these times, where laws are sampled.
    """

    y: Array
    t_stop: Array
    y_stop: Array
    status: Integers
    which: Integers
    steps: Integers
    rejected: Integers
    continued: Integers
    held: Array | None = None

    def inputs(self, shared: Shared, k: int) -> Array:
        """Return the inputs at stored time ``k``, (m,), or (m, N) where trajectories have their own."""
        return shared.inputs if self.held is None else self.held[k]


Runner = Callable[[Shared, Array, Array], Runs]
"""(shared, states (n, N), parameters (m,) or (m, N)); the lock of Python is released meanwhile.

Raises `Halt` where the thread is asked to end on the way."""


class _Job(ctypes.Structure):
    """Mirror of job.c."""

    _fields_ = [
        *((f, ctypes.c_double) for f in ("t", "t_end", "h_max", "rtol", "margin")),
        *((f, ctypes.c_void_p) for f in ("atol", "u", "grid", "x", "p", "y", "t_stop", "x_stop")),
        *((f, ctypes.c_void_p) for f in ("room", "status", "which", "steps", "rejected")),
        *((f, ctypes.c_ssize_t) for f in ("x_row", "x_column", "p_row", "p_column")),
        *((f, ctypes.c_ssize_t) for f in ("atol_row", "atol_column")),
        *((f, ctypes.c_ssize_t) for f in ("y_row", "y_time", "stop_row")),
        *((f, ctypes.c_size_t) for f in ("count", "grid_count")),
        ("max_steps", ctypes.c_longlong),
        ("halt", ctypes.c_void_p),
        ("laws", ctypes.c_void_p),
        ("law_count", ctypes.c_size_t),
        ("law_values", ctypes.c_void_p),
        ("held_at", ctypes.c_void_p),
    ]


def runner(function: Any) -> Runner:
    """Return what calls a C function of a job."""
    function.argtypes = [ctypes.c_void_p]
    function.restype = None

    def run(shared: Shared, x: Array, p: Array) -> Runs:
        n, count = x.shape
        times = len(shared.t_eval)
        x, p = np.ascontiguousarray(x), np.ascontiguousarray(p)
        shared = replace(shared, atol=_held(shared))
        runs = _empty(shared, times, n, count)
        laws = samples.laws_of(shared.laws, shared.t_span[1] - shared.t_span[0])
        room = np.empty(times * (n + 1) + 1)
        job, flag = _job(shared, x, p, runs, room), children.flag()
        job.halt = flag.address
        if shared.laws and runs.held is not None:
            job.laws, job.law_count = ctypes.addressof(laws.array), len(shared.laws)
            job.law_values, job.held_at = laws.values.ctypes.data, runs.held.ctypes.data
        function(ctypes.addressof(job))
        children.check()
        return runs

    return run


def _column(a: Array, j: int) -> Array:
    """Return a trajectory's own column of an array of all, or what all share."""
    return np.ascontiguousarray(a[:, j]) if a.ndim == 2 else a


def _held(shared: Shared) -> Array:
    """Return the absolute tolerances, as C reads them."""
    assert shared.atol is not None
    return np.ascontiguousarray(shared.atol)


def _job(shared: Shared, x: Array, p: Array, runs: Runs, room: Array) -> _Job:
    """Return the job as C reads it; the arrays must live as long as it runs."""
    n, count = x.shape
    atol = _held(shared)
    (start, end), times = shared.t_span, len(shared.t_eval)
    job = _Job(t=start, t_end=end, h_max=shared.max_step, rtol=shared.rtol, margin=shared.margin)
    job.max_steps, job.count, job.grid_count = shared.max_steps, count, times
    arrays: dict[str, NDArray[Any]] = {
        "atol": atol, "u": shared.inputs, "grid": shared.t_eval, "x": x, "p": p,
        "y": runs.y, "t_stop": runs.t_stop, "x_stop": runs.y_stop, "room": room,
        "status": runs.status, "which": runs.which, "steps": runs.steps,
        "rejected": runs.rejected,
    }  # fmt: skip
    for name, array in arrays.items():
        setattr(job, name, (array if array.size else room).ctypes.data)
    job.x_row, job.x_column = count, 1
    job.p_row, job.p_column = (count, 1) if p.ndim == 2 else (1, 0)
    job.atol_row, job.atol_column = (count, 1) if atol.ndim == 2 else (1, 0)
    job.y_row, job.y_time, job.stop_row = count, n * count, count
    return job


MOST_IN_LANES = 16_000
"""Operations of straight-line code in lanes, which take a compiler about 5 s; without lanes a
trajectory takes about six times as long."""


@dataclass(frozen=True)
class Built:
    """What integrates many trajectories, what it is called, and why it is not something faster.

    ``text``: the generated source that does it. ``series``: whether that is a Taylor series.
    """

    run: Runner
    method: str
    text: str
    notice: str = ""
    series: bool = False


def build(compiled: Compiled, method: str, rtol: float) -> Built:
    """Prepare the integration of many trajectories by ``method``: auto, taylor or DOP853.

    ``auto``: Taylor series where every operation has a rule, else DOP853. Raises `InputError` for
    another method, and for ``taylor`` where an operation has no rule.
    """
    row = METHODS.get(spelt(method, METHODS))
    if row is None:
        raise unknown_name("method", method, METHODS, "ensemble")
    if compiled.target != "c":
        reason = f"target {compiled.target}: one trajectory after the other"
        used = f"DOP853 of SciPy over {compiled.target} functions"
        return Built(_by_scipy(compiled), used, compiled.source, reason)
    return row(compiled, rtol)


def _auto(compiled: Compiled, rtol: float) -> Built:
    try:
        return _taylor(compiled, rtol)
    except native.CompilerError:
        raise
    except InputError as error:
        return replace(_dop853(compiled, rtol), notice=error.what)


def _taylor(compiled: Compiled, rtol: float) -> Built:
    program, layout, order = compiled.program, compiled.layout, taylor_lanes.order_of(rtol)
    prepared = prepare(program, RATES, layout)
    reason = _against_lanes(program, prepared, order)
    if not reason:
        try:
            text = taylor_lanes.single_text(prepared, program, layout, order)
            function, lanes = taylor_lanes.build(text, layout)
        except native.CompilerError as error:
            reason = error.brief
        else:
            name = f"Taylor series of order {order} in {lanes} vector lanes, generated C"
            return Built(runner(function), name, text, series=True)
    order = taylor.order_of(rtol)
    text = taylor.single_text(program, layout, order, SAMPLES in layout.results)
    run = _many(text, layout, "taylor", taylor.FLAGS)
    name = f"Taylor series of order {order} in generated C"
    return Built(run, name, text, f"no lanes: {reason}", series=True)


def _against_lanes(program: Program, prepared: Prepared, order: int) -> str:
    """Return why there is no code in lanes, or an empty text."""
    count = operations(prepared, order)
    if count > MOST_IN_LANES:
        return f"{count:,} operations of straight-line code at order {order}"
    if any(isinstance(i.value, Table) for i in program.instructions):
        return "tables have no form in lanes"
    if SAMPLES in program.results:
        return "laws are sampled"
    return ""


def _dop853(compiled: Compiled, rtol: float) -> Built:  # noqa: ARG001 - the signature of a row
    program, layout = compiled.program, compiled.layout
    text = runge_kutta.single_text(DOP853, program, layout, SAMPLES in layout.results)
    flags = native.flags_for_steps(len(program.instructions))
    return Built(_many(text, layout, DOP853.name, flags), "DOP853 in generated C", text)


METHODS: dict[str, Callable[[Compiled, float], Built]] = {
    "auto": _auto,
    "taylor": _taylor,
    "DOP853": _dop853,
}
"""The methods of ensembles by name."""


def _many(text: str, layout: Layout, suffix: str, flags: tuple[str, ...]) -> Runner:
    """Compile a scalar integrator with a loop over the trajectories of a job."""
    prefix = f"{identifier(layout.name)}_{suffix}"
    parts = samples.MANY_SAMPLED if SAMPLES in layout.results else samples.MANY_PLAIN
    values = {
        "JOB": runge_kutta.fill("job.c", {}),
        **parts,
        "INPUTS": str(len(layout.inputs)),
        "PREFIX": prefix,
        "UPPER": prefix.upper(),
        "PARAMETERS": str(len(layout.parameters)),
    }
    whole = text + runge_kutta.fill("many.c", values)
    library = native.load(native.compile_library(whole, flags), whole, flags)
    return runner(getattr(library, f"{prefix}_many"))


def _by_scipy(compiled: Compiled) -> Runner:
    """Return what integrates without a compiler, one trajectory after the other."""
    singularities = len(compiled.layout.results[SINGULARITIES])

    def run(shared: Shared, x: Array, p: Array) -> Runs:
        runs = _empty(shared, len(shared.t_eval), *x.shape)
        for j in range(x.shape[1]):
            children.check()
            found = scipy_.integrate(
                compiled, problem_of(shared, x, p, j, singularities), "DOP853", None
            )
            runs.y[: len(found.t), :, j] = found.y.T
            runs.t_stop[j], runs.y_stop[:, j] = found.stop.t, found.state_at_stop
            runs.status[j], runs.which[j] = NUMBERS[found.stop.kind], found.stop.which
            runs.steps[j], runs.rejected[j] = found.steps, found.rejected
            if runs.held is not None and found.held is not None:
                runs.held[: len(found.t), :, j] = found.held.at(found.t).T
        return runs

    return run


def problem_of(shared: Shared, x: Array, p: Array, j: int, singularities: int) -> Problem:
    """Return what a trajectory is by itself, asked to end as the thread is."""
    return Problem(
        x0=np.ascontiguousarray(x[:, j]),
        t_span=shared.t_span,
        parameters=_column(p, j),
        inputs=shared.inputs,
        rtol=shared.rtol,
        atol=_column(_held(shared), j),
        margin=shared.margin,
        singularities=singularities,
        t_eval=shared.t_eval,
        max_step=shared.max_step,
        max_steps=shared.max_steps,
        laws=shared.laws,
        progress=lambda _: children.check(),
    )


def _empty(shared: Shared, times: int, n: int, count: int) -> Runs:
    status, which, steps, rejected, continued = np.zeros((5, count), dtype=np.int32)
    held = np.full((times, len(shared.inputs), count), math.nan) if shared.laws else None
    y = np.full((times, n, count), math.nan)
    ends = np.empty(count), np.empty((n, count))
    return Runs(y, *ends, status, which, steps, rejected, continued, held)


STUCK = ("not finite", "step")
"""Where a Taylor series may be stuck, and another method not."""
WENT_ON, PASSED = 1, 2
"""In `Runs.continued`: another method went on; it may have passed where the rates are singular."""


def build_onward(compiled: Compiled, method: str, rtol: float) -> Built:
    """Return what integrates many trajectories, as `fleet.build`; ``auto`` goes on where stuck."""
    found = build(compiled, method, rtol)
    if method != "auto" or not found.series or SAMPLES in compiled.layout.results:
        return found
    return replace(found, run=_going_on(found.run, compiled), text=f"{found.text}{dict(NEXT)}")


def _going_on(run: Runner, compiled: Compiled) -> Runner:
    """Return what runs Taylor series, and goes on with those trajectories where these are stuck.

    A trajectory is gone on with from where it stopped, by itself: neither its neighbours nor the division
    into chunks change a bit of it.
    """
    singularities = len(compiled.layout.results[SINGULARITIES])

    def further(shared: Shared, x: Array, p: Array) -> Runs:
        runs = run(shared, x, p)
        for j in np.flatnonzero(np.isin(runs.status, [NUMBERS[kind] for kind in STUCK])).tolist():
            children.check()
            problem = problem_of(shared, x, p, j, singularities)
            first = _stopped(runs, problem, j)
            found = resumed(Task(compiled, problem, None), first)
            if len(found.methods) > len(first.methods):
                _put(runs, j, found, len(first.t))
        return runs

    return further


def _stopped(runs: Runs, problem: Problem, j: int) -> Trajectory:
    """Return a trajectory that stopped as a run of its own."""
    assert problem.t_eval is not None
    y = runs.y[:, :, j].T
    count = int(np.isfinite(y).all(axis=0).sum())
    stop = Stop(STATUS[int(runs.status[j])], float(runs.t_stop[j]), int(runs.which[j]))
    return Trajectory(
        t=problem.t_eval[:count],
        y=y[:, :count],
        stop=stop,
        state_at_stop=np.ascontiguousarray(runs.y_stop[:, j]),
        closest=(),
        evaluations=0,
        steps=int(runs.steps[j]),
        rejected=int(runs.rejected[j]),
        methods=("taylor",),
    )


def _put(runs: Runs, j: int, found: Trajectory, known: int) -> None:
    """Write a whole trajectory in place of its first part, of which so many times are stored."""
    runs.y[known : len(found.t), :, j] = found.y[:, known:].T
    runs.t_stop[j], runs.y_stop[:, j] = found.stop.t, found.state_at_stop
    runs.status[j], runs.which[j] = NUMBERS[found.stop.kind], found.stop.which
    runs.steps[j], runs.rejected[j] = found.steps, found.rejected
    runs.continued[j] = PASSED if found.passed else WENT_ON


def continued_notice(continued: Mapping[int, int]) -> str:
    """Return what a user should know of trajectories that were gone on with, by the number of each kind."""
    count, passed = sum(continued.values()), continued.get(PASSED, 0)
    if not count:
        return ""
    what = f"where the Taylor series was stuck another method went on (trajectories: {count:,})"
    doubt = f"; if the rates are singular there, the rest says nothing (trajectories: {passed:,})"
    return what + (doubt if passed else "")
