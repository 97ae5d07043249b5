"""Random scenes: each derived, compiled and integrated by several methods, in a process that is watched.

What is held: an answer in time; numbers that are finite, or a status and a message; invariants that
drift, and ends of two methods that differ, by no more than errors of rtol a step and state become.
"""

from __future__ import annotations

import math
import random
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.ir.program import INVARIANTS
from codegen.measure.stress.record import Figure, Findings, Material, Plan
from codegen.measure.stress.sweeps import ROUNDING, Amplification, amplification
from codegen.measure.stress.workers import Refusal, Run, Worker, attempt
from codegen.measure.workprecision.case import Case
from codegen.native.trajectory import Array
from codegen.runs.result import Result
from eom.system import System

SECONDS = 120.0
"""Time for all that is done with one scene, compilation included."""
RUN_SECONDS = 5.0
MOST_STEPS = 100_000
"""Steps of a run at most: dry friction that holds is chattering, which has to end with a message."""
LOST = 0.1
"""Relative error beyond which ends are not compared: the message is then that all may be lost."""
OTHER = "scipy:LSODA"
NAMED = 5


@dataclass(frozen=True)
class Job:
    """One scene, by what makes it."""

    draw: Callable[[int, int, int], Case]
    seed: int
    number: int
    kinds: int
    methods: tuple[str, ...]


@dataclass
class Verdict:
    """What was found in one scene. Shares are errors over bounds; ``ends``: how the runs ended."""

    title: str
    silent: list[str] = field(default_factory=list)
    drift: float = 0.0
    apart: float = 0.0
    compared: int = 0
    lost: bool = False
    ends: list[str] = field(default_factory=list)


def random_scenes(material: Material, plan: Plan) -> Findings:
    """Go through the scenes; a scene without an answer is counted, and the next one gets a new process."""
    methods = tuple(m for m in plan.methods if ":" not in m)
    verdicts: list[Verdict] = []
    trouble: list[str] = []
    with Worker(examine) as worker:
        for number in range(plan.size.scenes):
            job = Job(material.draw, plan.seed, number, plan.size.kinds, methods)
            answer = worker.ask(job, SECONDS)
            if answer.trouble:
                trouble.append(f"number {number}: {answer.trouble}")
            else:
                verdicts.append(answer.value)
            plan.progress((number + 1) / plan.size.scenes)
    return Findings(tuple(_figures(verdicts, trouble, plan)))


def _figures(verdicts: Sequence[Verdict], trouble: Sequence[str], plan: Plan) -> list[Figure]:
    silent = [f"{v.title}: {s}" for v in verdicts for s in v.silent]
    ends = Counter(e for v in verdicts for e in v.ends)
    counts = ", ".join(f"{n} {e}" for e, n in sorted(ends.items()))
    compared = sum(v.compared for v in verdicts)
    lost = sum(v.lost for v in verdicts)
    drifting = max(verdicts, key=lambda v: _order(v.drift), default=Verdict("none"))
    apart = max(verdicts, key=lambda v: _order(v.apart), default=Verdict("none"))
    few = float(compared < len(verdicts) / 2)
    return [
        Figure("scenes without an answer", len(trouble), 0.0, "; ".join(trouble[:NAMED])),
        Figure("runs that hide a failure", len(silent), 0.0, "; ".join(silent[:NAMED])),
        Figure("largest drift of an invariant over its bound", drifting.drift, 1.0, drifting.title),
        Figure("largest difference of two methods over its bound", apart.apart, 1.0, apart.title),
        Figure("fewer than half of the scenes compared", few, 0.0, f"{compared} pairs of runs compared"),
        Figure("scenes whose end may lose all digits", lost, None, f"of {plan.size.scenes}; not compared"),
        Figure("runs", sum(ends.values()), None, counts),
    ]  # fmt: skip


def _order(value: float) -> float:
    return math.inf if math.isnan(value) else value


@lru_cache(maxsize=64)
def _compiled(system: System) -> Compiled:
    return compile_system(system)


def examine(job: Job) -> Verdict:
    """Integrate one scene by its methods and compare; called in another process."""
    case = job.draw(job.seed, job.number, job.kinds)
    draw = random.Random(f"tolerance {job.seed} {job.number}")  # noqa: S311 - reproducible scenes
    rtol = 10 ** draw.uniform(-11, -3)
    compiled = _compiled(case.system)
    verdict = Verdict(case.title)
    results = {m: _run(compiled, case, m, rtol, verdict) for m in job.methods}
    if sum(r is not None for r in results.values()) < 2:
        results[OTHER] = _run(compiled, case, OTHER, rtol, verdict)
    ended = {m: r for m, r in results.items() if r is not None and r.status == 0}
    if ended:
        _compare(compiled, case, ended, rtol, verdict)
    return verdict


def _run(
    compiled: Compiled, case: Case, method: str, rtol: float, verdict: Verdict
) -> Result | None:
    """Integrate; note how it ended, and whether a failure is hidden."""
    start = {n: case.start[n] for n in compiled.system.state_names}
    times = np.linspace(0.0, case.end, 9)
    run = Run(
        compiled,
        start,
        times,
        case.inputs,
        case.parameters,
        limit=RUN_SECONDS,
        max_steps=MOST_STEPS,
    )
    result = attempt(run, method, rtol)
    if isinstance(result, Refusal):
        if result.late:
            verdict.silent.append(f"{method}: {result.reason}")
        verdict.ends.append("refused")
        return None
    verdict.ends.append(_ending(result))
    finite = np.isfinite(result.y).all() and all(
        np.isfinite(v).all() for v in result.outputs.values()
    )
    if not finite and result.status == 0:
        verdict.silent.append(f"{method}: NaN without a message")
    if result.status != 0 and not result.message.startswith("stopped at t = "):
        verdict.silent.append(f"{method}: status {result.status} without a message")
    if result.status == 0 and result.t_stop != case.end:
        verdict.silent.append(f"{method}: ended early without a message")
    return result


ENDINGS = ("reached", "singular", "finite", "resolution", "max_steps", "memory")


def _ending(result: Result) -> str:
    return next((word for word in ENDINGS if word in result.message), result.message)


def _compare(
    compiled: Compiled, case: Case, ended: dict[str, Result], rtol: float, verdict: Verdict
) -> None:
    """Hold drifts and differences against what errors of the steps become."""
    gain = amplification(case, compiled, case.end, RUN_SECONDS, MOST_STEPS)
    if isinstance(gain, str):
        return
    errors = {m: max(1, r.steps) * gain.forward * (rtol + ROUNDING) for m, r in ended.items()}
    if not sum(errors.values()) < LOST:
        verdict.lost = True
        return
    for method, result in ended.items():
        verdict.drift = max(verdict.drift, _drift(compiled, case, result, gain, errors[method]))
    (first, a), *others = ended.items()
    for other, b in others:
        difference = float(np.max(np.abs(a.y_stop - b.y_stop) / gain.sizes))
        verdict.apart = max(verdict.apart, _order(difference / (errors[first] + errors[other])))
        verdict.compared += 1


def _drift(
    compiled: Compiled, case: Case, result: Result, gain: Amplification, error: float
) -> float:
    """Return the largest drift over what an error of each state, of its size, makes of the invariant."""
    if not result.drift:
        return 0.0
    x = result.y[:, [0, -1]]
    p = np.array([case.parameters[q.name] for q in compiled.layout.parameters])
    u = np.array([case.inputs[q.name] for q in compiled.layout.inputs])
    allowed = _effect(compiled, x[:, 0], p, u, error * gain.sizes) + _effect(
        compiled, x[:, 1], p, u, error * gain.sizes
    )
    drift = np.array([result.drift[n].largest for n in compiled.layout.results[INVARIANTS]])
    scale = np.array([result.drift[n].size for n in compiled.layout.results[INVARIANTS]])
    share = drift / (allowed + 2 * ROUNDING * scale + 1e-300)
    return float(np.max(share))


def _effect(compiled: Compiled, x: Array, p: Array, u: Array, change: Array) -> Array:
    """Return the sum of what a change of each state makes of every invariant."""
    points = np.column_stack([x, x[:, None] + np.diag(change), x[:, None] - np.diag(change)])
    values = compiled.invariants(0.0, points, p, u)
    moved = np.abs(values[:, 1:] - values[:, :1])
    n = len(x)
    effect: Array = np.maximum(moved[:, :n], moved[:, n:]).sum(axis=1)
    return effect
