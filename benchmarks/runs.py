"""``python -m benchmarks.runs``: a run as Python calls it, prepared or by `simulate`, beside heyoka's.

Both start anew from the same state, in one process, in turn; heyoka has its parameters compiled in,
ours takes them at each run. Both have the tolerance that is named, not the same error
(`benchmarks.taylor` has that). What a run costs beside its loop stands beside the cheapest call of
NumPy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import cycle
from time import perf_counter, process_time
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
from codegen.runs.prepared import AUTO
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
MOST_PREPARED = {"taylor": (LONGEST, MOST), AUTO: (LONGEST_WHOLE, MOST_WHOLE)}
RUNS_A_SAMPLE = 200
AGAIN, ANEW = 1200.0, 24000.0
"""Times np.add of a run in closed form, from the state of the one before, and from another one."""


def problems() -> tuple[Problem, ...]:
    """Return what is run: the torque-free body, then scenes."""
    judged = next(p for p in PROBLEMS if p.name == JUDGED)
    return (judged, *(from_scene(load_scene(name)) for name in SCENES))


def measure(settings: Settings) -> Section:
    """Return what a run costs beside its loop and, if not quick, times beside heyoka's."""
    every = problems()
    found = every[: 1 if settings.quick else None]
    rows = list(_beside_the_loop(every[0], settings))
    rows += _beside_the_loop(every[1], settings, AUTO)
    rows += _closed(every[0], settings)
    without = missing("heyoka")
    if without:
        rows.append(absent("runs from Python", without))
    elif not settings.quick:
        rows += [row for p in found for rtol in TOLERANCES for row in _beside_heyoka(p, rtol)]
    return Section("a run from Python: ours | the other", tuple(rows))


Run = Callable[[], Result]


def _runs(problem: Problem, rtol: float, method: str = "taylor") -> tuple[Run, Run]:
    """Return a prepared run by a method, and the same by `simulate`, to the end alone."""
    compiled, values = compile_system(problem.system, "c"), (problem.start, problem.parameters)
    span, inputs = (0.0, problem.end), problem.inputs
    prepared = integrator(compiled, span, method, rtol, t_eval=[problem.end], inputs=inputs)
    start, parameters = values

    def whole() -> Result:
        return simulate(
            compiled, start, span, parameters, method, rtol, None, [problem.end], inputs=inputs
        )

    return lambda: prepared.run(start, parameters), whole


def _add() -> float:
    """Return what the cheapest call of NumPy takes."""
    x = np.ones(8)
    out = x.copy()
    began = perf_counter()
    for _ in range(RUNS_A_SAMPLE):
        np.add(x, x, out=out)
    return (perf_counter() - began) / RUNS_A_SAMPLE


def _beside_the_loop(
    problem: Problem, settings: Settings, method: str = "taylor"
) -> tuple[Row, ...]:
    prepared, whole = _runs(problem, 1e-9, method)
    rows = []
    for what, run, longest, most in (
        ("a prepared run beside its loop", prepared, *MOST_PREPARED[method]),
        ("simulate beside its loop", whole, LONGEST_WHOLE, MOST_WHOLE),
    ):
        pairs = settled(
            lambda: paired(_overhead(run), _add, 20),  # noqa: B023 - called at once
            lambda p: p.best[0] / (p.best[1] if settings.quick else 1.0),
            most if settings.quick else longest,
        )
        own, other = (time_text(s) for s in pairs.best)
        ratio = pairs.best[0] / pairs.best[1]
        target, met = f"<= {time_text(longest)}", pairs.best[0] <= longest
        if settings.quick:
            target, met = f"ratio <= {most:g}", ratio <= most
        rows.append(
            Row(
                f"{problem.name}, {method}: {what} | np.add",
                own,
                other,
                f"{ratio:.0f}",
                target,
                met,
            )
        )
    return tuple(rows)


def _closed(problem: Problem, settings: Settings) -> tuple[Row, ...]:
    """Return what runs take that `auto` finds to be a closed form: a state again, and other ones."""
    compiled, name = compile_system(problem.system, "c"), next(iter(problem.start))
    span, values = (0.0, problem.end), problem.parameters
    run = integrator(compiled, span, AUTO, t_eval=[problem.end], inputs=problem.inputs).run
    states = [{**problem.start, name: problem.start[name] + k / 1024} for k in range(1, 400)]
    rows = []
    for what, starts, most in (("the same state", states[:1], AGAIN), ("others", states, ANEW)):
        turn = cycle(starts)

        def sample(turn: Iterator[dict[str, float]] = turn) -> float:
            began = process_time()  # runs of milliseconds: other jobs count little
            for _ in range(FEW):
                run(next(turn), values)
            return (process_time() - began) / FEW

        pairs = settled(lambda: paired(sample, _add, 8), lambda p: p.best[0] / p.best[1], most)
        ratio = pairs.best[0] / pairs.best[1]
        own, other = (time_text(s) for s in pairs.best)
        judged = (f"ratio <= {most:g}", ratio <= most) if settings.quick else ()
        rows.append(
            Row(
                f"{problem.name}, closed form, {what} | np.add", own, other, f"{ratio:.0f}", *judged
            )
        )
    return tuple(rows)


FEW = 10


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
