"""``simulate`` beside SciPy's DOP853 on a lambdified function, at the same tolerances and error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import ellipj

from benchmarks.pairs import Pairs, paired, seconds, settled
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen import Compiled, simulate
from codegen import compile as compile_system
from eom.system import System

MODULUS = 0.51
START = (0.0, 1.0, 1.0)
LEAST_SPEEDUP = 200.0
LARGEST_ERROR_RATIO = 1.05
LARGEST_FINE_ERROR = 1e-12
RUNS_A_SAMPLE = 10

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Task:
    """An end time and tolerances."""

    end: float
    rtol: float
    atol: float

    def __str__(self) -> str:
        """Return what the table says."""
        return f"t = {self.end:.0f}, rtol {self.rtol:.0e}"


JUDGED = Task(1000.0, 1e-12, 1e-12)
DEFAULT = Task(1000.0, 1e-9, 1e-12)
FINE = Task(20.0, 1e-13, 1e-16)


@dataclass(frozen=True)
class Run:
    """Times (N,) and states (3, N) at the steps of an integration."""

    t: Array
    y: Array

    @property
    def error(self) -> float:
        """The largest difference from sn, cn, dn over all steps."""
        return float(np.abs(self.y - np.array(ellipj(self.t, MODULUS)[:3])).max())


@dataclass(frozen=True)
class Contest:
    """The same equations compiled by us, and as a lambdified function for SciPy."""

    compiled: Compiled
    rates: Callable[..., Any]

    def ours(self, task: Task) -> Run:
        """Integrate by `codegen.simulate`."""
        span = (0.0, task.end)
        result = simulate(self.compiled, START, span, None, "DOP853", task.rtol, task.atol)
        assert result.success, result.message
        return Run(result.t, result.y)

    def theirs(self, task: Task) -> Run:
        """Integrate by SciPy."""
        span = (0.0, task.end)
        result = solve_ivp(self.rates, span, START, "DOP853", rtol=task.rtol, atol=task.atol)
        assert result.success, result.message
        return Run(result.t, result.y)

    def times(self, task: Task, count: int) -> Pairs:
        """Return seconds a run, in turn; ours is the mean of a few."""
        return paired(
            lambda: (
                seconds(lambda: [self.ours(task) for _ in range(RUNS_A_SAMPLE)]) / RUNS_A_SAMPLE
            ),
            lambda: seconds(lambda: self.theirs(task)),
            count,
        )


def torque_free() -> Contest:
    """Return Euler's torque-free equations whose solution is sn, cn, dn."""
    y = sp.symbols("y1:4")
    rates = (y[1] * y[2], -y[0] * y[2], sp.Float(-MODULUS) * y[0] * y[1])
    system = System.from_rates("torque_free", dict(zip(y, rates, strict=True)))
    function = sp.lambdify((sp.Symbol("t"), y), rates, modules="math")
    return Contest(compile_system(system, "c"), function)


def measure(settings: Settings) -> Section:
    """Return the rows of the judged task, of the default tolerances, and of a fine short run."""
    contest = torque_free()
    rows = [_time(contest, JUDGED, settings, LEAST_SPEEDUP), _error(contest, JUDGED, True)]
    if not settings.quick:
        rows += [_time(contest, DEFAULT, settings, None), _error(contest, DEFAULT, False)]
    title = "torque-free: simulate | SciPy DOP853"
    return Section(title, (*rows, _fine(contest)))


def _time(contest: Contest, task: Task, settings: Settings, least: float | None) -> Row:
    count = 3 if settings.quick else 7
    limit = np.inf if least is None else 1 / least
    pairs = settled(lambda: contest.times(task, count), lambda p: p.ratio, limit)
    mine, other = (time_text(s) for s in pairs.best)
    speedup = 1 / pairs.ratio
    row = Row(f"{task}: time", mine, other, f"{speedup:.0f} times")
    if least is None:
        return row
    return Row(row.what, mine, other, row.ratio, f">= {least:.0f} times", speedup >= least)


def _error(contest: Contest, task: Task, judged: bool) -> Row:
    ours, theirs = contest.ours(task).error, contest.theirs(task).error
    texts = (f"{ours:.2e}", f"{theirs:.2e}", f"{ours / theirs:.3f}")
    if not judged:
        return Row(f"{task}: error", *texts)
    met = ours <= LARGEST_ERROR_RATIO * theirs
    return Row(f"{task}: error", *texts, f"<= {LARGEST_ERROR_RATIO}", met)


def _fine(contest: Contest) -> Row:
    ours, theirs = contest.ours(FINE).error, contest.theirs(FINE).error
    texts = (f"{ours:.2e}", f"{theirs:.2e}", f"{ours / theirs:.3f}")
    target = f"ours <= {LARGEST_FINE_ERROR:.0e}"
    return Row(f"{FINE}: error", *texts, target, ours <= LARGEST_FINE_ERROR)
