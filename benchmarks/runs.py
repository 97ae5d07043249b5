"""``python -m benchmarks.runs``: a run as Python calls it, prepared or by `simulate`, beside heyoka's.

Both start anew from the same state, in one process, in turn; heyoka has its parameters compiled in,
ours takes them at each run. Both have the tolerance that is named, not the same error
(`benchmarks.taylor` has that). What a run costs beside its loop stands beside the cheapest call of
NumPy.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.pairs import Sample, paired, settled
from benchmarks.peers import absent, missing
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, alone, time_text
from benchmarks.taylor import case_of
from codegen import Result, integrator, simulate
from codegen import compile as compile_system
from codegen.measure.workprecision.programs import heyoka_builder
from eom.opening import load_scene
from eom.problems import PROBLEMS, Problem, from_scene

JUDGED = "free-body-attitude"
SCENES = ("bicycle-wheel", "heavy-top", "t-handle", "rotary-pendulum")
TOLERANCES = (1e-9, 1e-12)
LARGEST_RATIO, LARGEST_WHOLE = 1.3, 4.0
"""Of a prepared run, and of `simulate`, to heyoka's `propagate_until`."""
LONGEST, LONGEST_WHOLE = 8e-6, 25e-6
"""Seconds beside the loop of a prepared run, and of `simulate`."""
MOST, MOST_WHOLE = 60.0, 120.0
"""The same over the time of ``np.add(x, x, out=out)``, which takes about a third of a microsecond."""
RUNS_A_SAMPLE = 200


def problems() -> tuple[Problem, ...]:
    """Return what is run: the torque-free body, then scenes."""
    judged = next(p for p in PROBLEMS if p.name == JUDGED)
    return (judged, *(from_scene(load_scene(name)) for name in SCENES))


def measure(settings: Settings) -> Section:
    """Return what a run costs beside its loop and, if not quick, times beside heyoka's."""
    found = problems()[: 1 if settings.quick else None]
    rows = list(_beside_the_loop(found[0], settings))
    without = missing("heyoka")
    if without:
        rows.append(absent("runs from Python", without))
    elif not settings.quick:
        rows += [row for p in found for rtol in TOLERANCES for row in _beside_heyoka(p, rtol)]
    return Section("a run from Python: ours | the other", tuple(rows))


Run = Callable[[], Result]


def _runs(problem: Problem, rtol: float) -> tuple[Run, Run]:
    """Return a prepared run by Taylor series, and the same by `simulate`, to the end alone."""
    compiled, values = compile_system(problem.system, "c"), (problem.start, problem.parameters)
    span, inputs = (0.0, problem.end), problem.inputs
    prepared = integrator(compiled, span, "taylor", rtol, t_eval=[problem.end], inputs=inputs)
    start, parameters = values

    def whole() -> Result:
        return simulate(
            compiled, start, span, parameters, "taylor", rtol, None, [problem.end], inputs=inputs
        )

    return lambda: prepared.run(start, parameters), whole


def _beside_the_loop(problem: Problem, settings: Settings) -> tuple[Row, ...]:
    prepared, whole = _runs(problem, 1e-9)
    x = np.ones(8)
    out = x.copy()

    def add() -> float:
        began = perf_counter()
        for _ in range(RUNS_A_SAMPLE):
            np.add(x, x, out=out)
        return (perf_counter() - began) / RUNS_A_SAMPLE

    rows = []
    for what, run, longest, most in (
        ("a prepared run beside its loop", prepared, LONGEST, MOST),
        ("simulate beside its loop", whole, LONGEST_WHOLE, MOST_WHOLE),
    ):
        pairs = settled(
            lambda: paired(_overhead(run), add, 20),  # noqa: B023 - called at once
            lambda p: p.best[0] / (p.best[1] if settings.quick else 1.0),
            most if settings.quick else longest,
        )
        own, other = (time_text(s) for s in pairs.best)
        ratio = pairs.best[0] / pairs.best[1]
        target, met = f"<= {time_text(longest)}", pairs.best[0] <= longest
        if settings.quick:
            target, met = f"ratio <= {most:g}", ratio <= most
        rows.append(
            Row(f"{problem.name}: {what} | np.add", own, other, f"{ratio:.0f}", target, met)
        )
    return tuple(rows)


def _overhead(run: Run) -> Sample:
    def sample() -> float:
        total = 0.0
        for _ in range(RUNS_A_SAMPLE):
            began = perf_counter()
            made = run()
            total += perf_counter() - began - made.seconds
        return total / RUNS_A_SAMPLE

    return sample


def _beside_heyoka(problem: Problem, rtol: float) -> tuple[Row, ...]:
    case = case_of(problem)
    try:
        other: Any = heyoka_builder(case)(rtol)
    except ValueError as error:  # a mass matrix, or a function that it does not know
        return (Row(f"{problem.name} at {rtol:.0e}", "not measured", str(error).splitlines()[0]),)
    start = [case.start[n] for n in case.system.state_names]

    def theirs() -> None:
        other.time = 0.0
        other.state[:] = start
        other.propagate_until(problem.end)

    rows = []
    judged = problem.name == JUDGED
    for what, run, limit in zip(
        ("prepared", "simulate"), _runs(problem, rtol), (LARGEST_RATIO, LARGEST_WHOLE), strict=True
    ):
        pairs = settled(
            lambda: paired(_timed(run), _timed(theirs), 15),  # noqa: B023 - called at once
            lambda p: p.ratio,
            limit if judged else np.inf,
        )
        own, their = (time_text(s) for s in pairs.best)
        name = f"{problem.name} to t = {problem.end:g} at {rtol:.0e}, {what}"
        if judged:
            rows.append(
                Row(name, own, their, f"{pairs.ratio:.2f}", f"<= {limit}", pairs.ratio <= limit)
            )
        else:
            rows.append(Row(name, own, their, f"{pairs.ratio:.2f}"))
    return tuple(rows)


def _timed(run: Callable[[], object]) -> Sample:
    def sample() -> float:
        began = perf_counter()
        for _ in range(RUNS_A_SAMPLE):
            run()
        return (perf_counter() - began) / RUNS_A_SAMPLE

    return sample


if __name__ == "__main__":
    alone(measure)
