"""Peak memory of a run of many steps that is asked for little, in a process of its own."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.measure.stress.growth import MOMENTS, OMEGA
from codegen.measure.stress.record import Figure, Findings, Material, Plan
from codegen.measure.stress.running import Refusal, Run, attempt
from codegen.measure.stress.workers import Worker
from codegen.native.trajectory import Array
from codegen.runs.simulation import Result
from eom.system import System

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
