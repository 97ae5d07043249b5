"""Ensembles beside heyoka's batch mode, a trajectory and core; two threads beside one.

heyoka runs as a user would write it for speed: one integrator whose batches are loaded one after the
other, with 4 and with 8 lanes; the quicker of these is compared. Its own `ensemble_propagate` copies
the integrator for each batch and is slower. Both sides are whole calls from Python.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.pairs import paired, seconds, settled
from benchmarks.peers import absent, missing
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from benchmarks.taylor import TOLERANCES, case_of
from codegen import Compiled, ensemble
from codegen.measure.workprecision.case import Case
from codegen.measure.workprecision.programs import numbered
from eom.problems import ready

Array = NDArray[np.float64]
COUNT = 4096
CHECKED = 256
"""Trajectories whose ends are compared with extended precision."""
MANY = 32_768
END = 20.0
SEED = 7
LARGEST_RATIO = 0.7
LEAST_GAIN = 1.8
ROUNDING = 2e-12
"""Errors below this, relative to the largest state, are rounding in either program."""


@dataclass(frozen=True)
class Task:
    """A problem, and scattered starts (n, COUNT)."""

    case: Case
    start: Array


def tasks() -> list[Task]:
    """Return the torque-free body in rates and quaternion, and the heavy top."""
    draw = np.random.default_rng(SEED)
    half = draw.uniform(0.1, 1.0, COUNT)
    omega = [f"omega_{k}" for k in (1, 2, 3)]
    spins = dict(zip(omega, draw.normal(size=(3, COUNT)), strict=True))
    scatter = draw.normal(size=(3, COUNT)) * np.array([[1.0], [1.0], [5.0]])
    tilted = {"q0": np.cos(half), "q1": np.sin(half)}
    top = case_of(ready("heavy-top-quaternion"))
    tops = {w: top.start[w] + s for w, s in zip(omega, scatter, strict=True)}
    return [
        _scattered(case_of(ready("free-body-attitude")), spins),
        _scattered(top, {**tops, **tilted}),
    ]


def _scattered(case: Case, drawn: Mapping[str, Array]) -> Task:
    names = case.system.state_names
    return Task(case, np.array([drawn.get(n, np.full(COUNT, case.start[n])) for n in names]))


@dataclass(frozen=True)
class Contest:
    """A task in both programs, and the first ends as heyoka has them in extended precision."""

    task: Task
    compiled: Compiled
    rates: list[tuple[Any, Any]]
    reference: Array

    def ours(self, rtol: float, threads: int = 1, start: Array | None = None) -> Array:
        """Return the ends."""
        given = self.task.start if start is None else start
        found = ensemble(self.compiled, given, (0.0, END), rtol=rtol, threads=threads)
        assert found.success, found
        return found.y_stop

    def theirs(self, rtol: float, lanes: int) -> Callable[[], Array]:
        """Return what integrates by heyoka; the compilation is done."""
        heyoka: Any = importlib.import_module("heyoka")
        n = len(self.rates)
        integrator = heyoka.taylor_adaptive_batch(self.rates, np.zeros((n, lanes)), tol=rtol)
        ends = np.empty((n, COUNT))
        zero, last = np.zeros(lanes), np.full(lanes, END)

        def run() -> Array:
            for k in range(0, COUNT, lanes):
                integrator.set_time(zero)
                integrator.state[:] = self.task.start[:, k : k + lanes]
                integrator.propagate_until(last)
                ends[:, k : k + lanes] = integrator.state
            return ends

        return run

    def error(self, ends: Array) -> float:
        """Return the largest difference from the reference, relative to the largest state."""
        difference = np.abs(ends[:, :CHECKED] - self.reference).max()
        return float(difference / np.abs(self.reference).max())


def contest(task: Task) -> Contest:
    """Return a task in both programs."""
    heyoka: Any = importlib.import_module("heyoka")
    states, values, _ = numbered(task.case)
    pairs = zip(states, values, strict=True)
    rates = [(heyoka.expression(str(s)), heyoka.from_sympy(r)) for s, r in pairs]
    start = np.zeros(len(rates), dtype=np.longdouble)
    fine = heyoka.taylor_adaptive(rates, start, fp_type=np.longdouble)
    reference = np.empty((len(rates), CHECKED))
    for k in range(CHECKED):
        fine.time = np.longdouble(0)
        fine.state[:] = task.start[:, k]
        fine.propagate_until(np.longdouble(END))
        reference[:, k] = fine.state
    return Contest(task, task.case.compiled(), rates, reference)


def measure(settings: Settings) -> Section:
    """Return time a trajectory on one core, and error, of each task at each tolerance; threads."""
    title = "ensemble on one core | heyoka, the quicker of 4 and 8 lanes"
    without = missing("heyoka")
    if without:
        return Section(title, (absent("ensembles", without),))
    contests = [contest(task) for task in (tasks()[:1] if settings.quick else tasks())]
    rows = [row for c in contests for rtol in TOLERANCES for row in _rows(c, rtol, settings)]
    return Section(title, (*rows, *(_threads(c, settings) for c in contests)))


def _rows(contest: Contest, rtol: float, settings: Settings) -> tuple[Row, Row]:
    runs = [contest.theirs(rtol, lanes) for lanes in (4, 8)]
    first = [min(seconds(run) for _ in range(3)) for run in runs]
    run = runs[int(np.argmin(first))]
    ours, theirs = contest.error(contest.ours(rtol)), contest.error(run())
    pairs = settled(
        lambda: paired(
            lambda: seconds(lambda: contest.ours(rtol)),
            lambda: seconds(run),
            5 if settings.quick else 9,
        ),
        lambda p: p.ratio,
        LARGEST_RATIO,
    )
    times = (time_text(s / COUNT) for s in pairs.best)
    what, quick = f"{contest.task.case.name}, {rtol:.0e}", pairs.ratio <= LARGEST_RATIO
    met = ours <= max(theirs, ROUNDING)
    return (
        Row(f"{what}: a trajectory", *times, f"{pairs.ratio:.2f}", f"<= {LARGEST_RATIO}", quick),
        Row(f"{what}: error", f"{ours:.1e}", f"{theirs:.1e}", "", f"<= heyoka's, or {ROUNDING:.0e}", met),
    )  # fmt: skip


def _threads(contest: Contest, settings: Settings) -> Row:
    """Two threads beside one, over more trajectories."""
    many = np.tile(contest.task.start, MANY // COUNT)
    pairs = settled(
        lambda: paired(
            lambda: seconds(lambda: contest.ours(1e-9, 2, many)),
            lambda: seconds(lambda: contest.ours(1e-9, 1, many)),
            3 if settings.quick else 7,
        ),
        lambda p: p.ratio,
        1 / LEAST_GAIN,
    )
    times = (time_text(s / MANY) for s in pairs.best)
    gain = 1 / pairs.ratio
    what = f"{contest.task.case.name}, 1e-9, {MANY} trajectories: 2 threads | 1"
    return Row(what, *times, f"{gain:.2f}", f">= {LEAST_GAIN}", gain >= LEAST_GAIN)


if __name__ == "__main__":
    from rich.console import Console

    from benchmarks import machine
    from benchmarks.table import table

    console = Console(width=140)
    console.print(machine.header())
    console.print(table([measure(Settings())]))
