"""Every method on every problem: finer tolerances, and there and back.

A method promises local errors of at most rtol (|x| + 1e-3) in each state and step. What so many steps may
make at the end, all errors in the worst sense, is their number times the amplification of the
problem (`codegen.measure.stress.sweeps`) times rtol. Rounding is a local error of a few units in the
last place.

Peak memory of a run of many steps that is asked for little, in a process of its own.

What a small error of a state becomes later: the propagator of a case, by differences.

M(t) = d x(t)/d x(0) in units of the size of each state, from runs whose starts differ by a part in 1e6.
An error made at s is M(t) M(s)^-1 times as large at t, and M(s)^-1 times if it is carried back to 0.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.measure.stress.growth import MOMENTS, OMEGA
from codegen.measure.stress.record import ABSOLUTE, EPSILON, Figure, Findings, Material, Plan
from codegen.measure.stress.workers import MAX_STEPS, Collector, Refusal, Run, Worker, attempt
from codegen.measure.workprecision.case import Case, Reference, reference
from codegen.native.trajectory import Array
from codegen.runs.result import Result
from eom.errors import InputError
from eom.system import System

CHANGE = 1e-6
FINE = 1e-12
NODES = 8
UNKNOWN = 1e5
"""Amplification beyond which differences show nothing more."""


@dataclass(frozen=True)
class Amplification:
    """Sizes of the states (n,), and what an error of one step of 1 rtol, anywhere, costs at most.

    ``forward``: at the end; ``back``: at the start, after the way back. Both are in units of rtol and
    of the sizes, for a local error of at most rtol (|x| + 1e-3).
    """

    sizes: Array
    forward: float
    back: float


def amplification(
    case: Case, compiled: Compiled, end: float, limit: float, max_steps: int = MAX_STEPS
) -> Amplification | str:
    """Return the amplification of a case until ``end``; or why it cannot be had."""
    method = "scipy:Radau" if case.stiff else "DOP853"
    nodes = np.linspace(0.0, end, NODES + 1)
    x0 = np.array([case.start[q.name] for q in compiled.system.states])
    free = {q.name: case.parameters[q.name] for q in compiled.layout.parameters}

    def run(start: Array, times: Array) -> Array | str:
        settings = Run(compiled, start, times, case.inputs, free, limit=limit, max_steps=max_steps)
        found = attempt(settings, method, FINE)
        if isinstance(found, Refusal):
            return found.reason
        return found.y if found.status == 0 else found.message

    plain = run(x0, nodes)
    if isinstance(plain, str):
        return plain
    sizes = sizes_of(plain)
    M = _propagator(run, plain, nodes, sizes)
    if isinstance(M, str):
        return M
    found = _bounds(M, sizes)
    if found.back < UNKNOWN:
        return found
    return _without_inverses(run, plain, nodes, sizes)


Runner = Callable[[Array, Array], Array | str]


def sizes_of(states: Array) -> Array:
    """Return the largest size of each state (n, N); states that are always zero have that of all."""
    largest = np.abs(states).max(axis=1)
    return np.where(largest > 0, largest, largest.max() or 1.0)


def _propagator(run: Runner, plain: Array, times: Array, sizes: Array) -> Array | str:
    """Return M (nodes, n, n) from the first of some times on; ``plain``: states at these."""
    columns = []
    for i, size in enumerate(sizes):
        moved = plain[:, 0].copy()
        moved[i] += CHANGE * size
        states = run(moved, times)
        if isinstance(states, str):
            return states
        columns.append((states - plain) / (CHANGE * sizes[:, None]))
    return np.array(columns).transpose(2, 1, 0)


def _without_inverses(run: Runner, plain: Array, nodes: Array, sizes: Array) -> Amplification | str:
    """Start at every node anew, where errors die out so far that M has no inverse; nothing comes back."""
    allowed = 1 + ABSOLUTE / sizes
    forward = float(allowed.max())
    for k in range(len(nodes) - 1):
        M = _propagator(run, plain[:, [k, -1]], nodes[[k, -1]], sizes)
        if isinstance(M, str):
            return M
        forward = max(forward, float((np.abs(M[-1]) @ allowed).max()))
    return Amplification(sizes, forward, np.inf)


def _bounds(M: Array, sizes: Array) -> Amplification:
    """Take the largest sum of a row: an error in each state, all in the worst sense."""
    allowed = 1 + ABSOLUTE / sizes
    with np.errstate(all="ignore"):
        inverses = [_inverse(m) for m in M]
        forward = max(float((np.abs(M[-1] @ v) @ allowed).max()) for v in inverses)
        back = max(float((np.abs(v) @ allowed).max()) for v in inverses)
    return Amplification(sizes, forward, back)


def _inverse(m: Array) -> Array:
    try:
        inverse: Array = np.asarray(np.linalg.inv(m), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.full_like(m, np.inf)
    return inverse


ROUNDING = 8 * EPSILON
"""Local error of a step by rounding, of the size of a state."""
PROMISED = 1.0
"""By which factor an error may exceed the promise: methods measure local errors in their own norm."""
RISE = 3.0
"""By which factor an error may exceed that at the coarser tolerance before."""
RETURN_RTOL = 1e-9


@dataclass(frozen=True)
class Track:
    """A case with its compiled functions, its end, and what its errors are amplified by."""

    case: Case
    compiled: Compiled
    end: float
    gain: Amplification


def _tracks(material: Material, plan: Plan, found: Collector) -> list[Track]:
    """Return the problems that can be judged; the others are named in the findings."""
    tracks = []
    for case in material.problems:
        compiled, end = case.compiled(), case.end * plan.size.share
        gain = amplification(case, compiled, end, 20 * plan.size.limit)
        if isinstance(gain, str):
            found.refused.setdefault(("amplification", gain), []).append(case.name)
        else:
            tracks.append(Track(case, compiled, end, gain))
    return tracks


def tolerances(material: Material, plan: Plan) -> Findings:
    """Compare the ends of all methods at all tolerances with ends of many digits."""
    found = Collector()
    tracks = _tracks(material, plan, found)
    for k, track in enumerate(tracks):
        try:
            known = reference(_shortened(track), track.compiled)
        except InputError as error:
            found.refused.setdefault(("reference", error.what), []).append(track.case.name)
            continue
        for method in plan.methods:
            _sweep(track, known, method, plan, found)
        found.late.clear()
        plan.progress((k + 1) / len(tracks))
    return found.findings()


def _shortened(track: Track) -> Case:
    return replace(track.case, end=track.end)


def _sweep(track: Track, known: Reference, method: str, plan: Plan, found: Collector) -> None:
    """Append what one method does on one problem: worst share of the promise, worst rise."""
    times = np.array([0.0, track.end])
    start = {n: track.case.start[n] for n in track.compiled.system.state_names}
    promises: list[Figure] = []
    rises: list[Figure] = []
    before = math.inf
    for rtol in plan.size.tolerances:
        where = f"{track.case.name} at {rtol:.0e}"
        run = Run(track.compiled, start, times, track.case.inputs, limit=plan.size.limit)
        result = found.result(run, method, rtol, where)
        if result is None:
            break
        what = f"{track.case.name}: {method}"
        if result.status != 0 or not np.isfinite(result.y_stop).all():
            promises.append(Figure(what, math.inf, 0.0, f"at {rtol:.0e}: {result.message}"))
            break
        error = known.distance(result.y_stop)
        floor = known.error + _summed(track.gain.forward, result.steps, ROUNDING)
        promise = PROMISED * (_summed(track.gain.forward, result.steps, rtol) + floor)
        note = f"at {rtol:.0e}: error {error:.1e}, {result.steps} steps"
        promises.append(Figure(f"{what}: error over promise", error / promise, 1.0, note))
        rise = error / (RISE * max(before, PROMISED * floor))
        rises.append(Figure(f"{what}: rise with a finer tolerance", rise, 1.0, note))
        before = error
    found.figures += [*_worst(promises), *_worst(rises)]


def _worst(figures: Sequence[Figure]) -> list[Figure]:
    """Return the figure that is the largest, if there is one; NaN counts as larger than all."""
    return (
        [max(figures, key=lambda f: math.inf if math.isnan(f.value) else f.value)]
        if figures
        else []
    )


def _summed(gain: float, steps: int, local: float) -> float:
    return max(1, steps) * gain * local


def there_and_back(material: Material, plan: Plan) -> Findings:
    """Integrate to the end and back; compare with the start, where errors do not grow beyond use."""
    found = Collector()
    tracks = _tracks(material, plan, found)
    for k, track in enumerate(tracks):
        if not track.gain.back < UNKNOWN:
            text = f"errors may grow more than {UNKNOWN:.0e} times on the way back: all may be lost"
            found.refused.setdefault(("any method", text), []).append(track.case.name)
            continue
        for method in plan.methods:
            _return(track, method, plan, found)
        plan.progress((k + 1) / len(tracks))
    return found.findings()


def _return(track: Track, method: str, plan: Plan, found: Collector) -> None:
    case, compiled, name = track.case, track.compiled, track.case.name
    start = np.array([case.start[n] for n in compiled.system.state_names])
    steps, state, what = 0, start, f"{name}: {method}"
    for times in (np.array([0.0, track.end]), np.array([track.end, 0.0])):
        run = Run(compiled, state, times, case.inputs, limit=plan.size.limit)
        result = found.result(run, method, RETURN_RTOL, name)
        if result is None:
            return
        if result.status != 0:
            found.figures.append(Figure(what, math.inf, 0.0, result.message))
            return
        state, steps = result.y_stop, steps + result.steps
    error = float(np.max(np.abs(state - start) / track.gain.sizes))
    bound = PROMISED * _summed(track.gain.back, steps, RETURN_RTOL + ROUNDING)
    note = f"{steps} steps, an error grows up to {track.gain.back:.1e} times"
    found.figures.append(Figure(what, error, bound, note))


ASKED = 3
"""Stored times."""
SHORT = 200
"""Steps of the run that comes before, so that everything is loaded."""
SLACK = 2.0
"""Megabytes beside the stored numbers: pages that the allocator keeps."""
SECONDS = 300.0
IN_C = 20
"""Methods whose loop is generated C take so many times the steps."""


@dataclass(frozen=True)
class Job:
    """A method, and the number of its steps at least."""

    system: System
    method: str
    steps: int


@dataclass(frozen=True)
class Use:
    """Growth of the peak (MB), steps made, numbers stored, and how the run ended."""

    growth: float
    steps: int
    stored: int
    message: str


def memory(material: Material, plan: Plan) -> Findings:
    """Run every method over so many steps that storing them would be seen."""
    figures, absent = [], []
    for k, method in enumerate(plan.methods):
        with Worker(use) as worker:
            steps = plan.size.steps * (1 if ":" in method else IN_C)
            answer = worker.ask(Job(material.free_body, method, steps), SECONDS)
        if answer.trouble:
            figures.append(Figure(f"{method}: peak growth, MB", math.inf, 0.0, answer.trouble))
        elif isinstance(answer.value, str):
            absent.append(f"{method}: {answer.value}")
        else:
            figures += _figures(method, answer.value)
        plan.progress((k + 1) / len(plan.methods))
    return Findings(tuple(figures), tuple(absent))


def _figures(method: str, found: Use) -> list[Figure]:
    asked = 8e-6 * ASKED * 8
    every = 8e-6 * found.steps * 8
    note = f"{found.steps} steps, {every:.1f} MB if all were stored; {found.message}"
    return [
        Figure(f"{method}: peak growth, MB", found.growth, SLACK + asked, note),
        Figure(f"{method}: numbers stored", float(found.stored), 8.0 * ASKED, note),
    ]


def use(job: Job) -> Use | str:
    """Measure a long run in this process; or say why there is none."""
    compiled = compile_system(job.system, parameters=MOMENTS)
    start = np.array([*OMEGA, 1.0, 0.0, 0.0, 0.0])
    step = 1e-3
    short = _run(compiled, start, step, SHORT, job.method)
    if isinstance(short, Refusal):
        return short.reason
    before = peak()
    found = _run(compiled, start, step, job.steps, job.method)
    if isinstance(found, Refusal):
        return found.reason
    stored = found.t.size + found.y.size
    return Use(peak() - before, found.steps, stored, found.message)


def _run(
    compiled: Compiled, start: Array, step: float, steps: int, method: str
) -> Result | Refusal:
    times = np.linspace(0.0, step * steps, ASKED)
    return attempt(Run(compiled, start, times, max_step=step), method, 1e-6)


def peak() -> float:
    """Return the peak of this process's memory in megabytes."""
    status = Path("/proc/self/status")
    if status.is_file():
        lines = status.read_text("ascii", "replace").splitlines()
        found = [line.split()[1] for line in lines if line.startswith("VmHWM")]
        if found:
            return int(found[0]) / 1024
    import resource

    size = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return size / (2**20 if sys.platform == "darwin" else 1024)
