"""The method taylor at equal error: beside heyoka, which LLVM compiles, and SciPy on a Python function.

The other program runs at a tolerance; ours at the coarsest tolerance of a grid from which on its error is
not larger, so that both reach the same accuracy. Errors are those of `codegen.measure.workprecision`: of
each state, over its largest size on the way, against Taylor series with 24 digits.
"""

from __future__ import annotations

import numpy as np

from benchmarks.pairs import Pairs, paired, settled
from benchmarks.peers import absent, missing
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen.compiling.compiled import Compiled
from codegen.measure.workprecision.case import Case, Reference, reference
from codegen.measure.workprecision.programs import Run, programs
from eom.problems import PROBLEMS, Problem

TOLERANCES = (1e-6, 1e-9, 1e-12, 2.0**-52)
LARGEST_RATIO = 0.7
LEAST_GAIN = 300
"""Over SciPy's DOP853 on a lambdified function."""
ROUNDING = 1e-14
"""Smaller errors are rounding, in either program."""
COARSEST = 1e4
"""Ours is tried from so many times the other's tolerance on, each half a decade."""
RUNS_A_SAMPLE = 10


def measure(settings: Settings) -> Section:
    """Return time of the integration alone, and error, of each smooth problem at each tolerance."""
    chosen = [p for p in PROBLEMS if not p.stiff][: 1 if settings.quick else None]
    tolerances = TOLERANCES[:2] if settings.quick else TOLERANCES
    without = missing("heyoka")
    rows = [] if not without else [absent("Taylor series", without)]
    for problem in chosen:
        contest = _Contest(problem)
        for rtol in () if without else tolerances:
            rows += contest.rows("heyoka", rtol, settings)
        rows += contest.rows("solve_ivp:DOP853", 1e-9, settings)
    return Section("simulate, method taylor | heyoka or SciPy, at equal error", tuple(rows))


class _Contest:
    """A problem, its solution, and our runs at the tolerances that were tried."""

    def __init__(self, problem: Problem) -> None:
        self.case = case_of(problem)
        self.compiled: Compiled = self.case.compiled()
        self.reference: Reference = reference(self.case, self.compiled)
        self.ours: dict[float, tuple[Run, float]] = {}

    def rows(self, other: str, rtol: float, settings: Settings) -> tuple[Row, Row]:
        """Return time and error beside those of another program at a tolerance."""
        theirs, wanted = self._tried(other, rtol)
        own, (run, error) = self._matched(rtol, max(wanted, ROUNDING))
        heyoka = other == "heyoka"
        limit = LARGEST_RATIO if heyoka else 1 / LEAST_GAIN
        runs = RUNS_A_SAMPLE if heyoka else 1
        pairs = settled(
            lambda: paired(
                lambda: min(run(np.inf).seconds for _ in range(RUNS_A_SAMPLE)),
                lambda: min(theirs(np.inf).seconds for _ in range(runs)),
                3 if settings.quick or not heyoka else 7,
            ),
            lambda p: p.ratio,
            limit,
        )
        return self._printed(
            f"{self.case.name}, {other} at {rtol:.0e}", own, (error, wanted), pairs, heyoka
        )

    def _printed(
        self, what: str, own: float, errors: tuple[float, float], pairs: Pairs, heyoka: bool
    ) -> tuple[Row, Row]:
        times = [time_text(s) for s in pairs.best]
        times[0] += f" at {own:.0e}"
        ratio = f"{pairs.ratio:.2f}" if heyoka else f"{1 / pairs.ratio:.0f} times"
        target = f"<= {LARGEST_RATIO}" if heyoka else f">= {LEAST_GAIN} times"
        quick = pairs.ratio <= (LARGEST_RATIO if heyoka else 1 / LEAST_GAIN)
        met = errors[0] <= max(errors[1], ROUNDING)
        target_error = f"<= the other's, or {ROUNDING:.0e}"
        return (
            Row(f"{what}: time", times[0], times[1], ratio, target, quick),
            Row(f"{what}: error", *(f"{e:.1e}" for e in errors), "", target_error, met),
        )

    def _matched(self, rtol: float, error: float) -> tuple[float, tuple[Run, float]]:
        """Return our coarsest tolerance whose error, and that of the next finer one, is small enough."""
        finest = 2.0**-52
        grid = [max(finest, COARSEST * rtol * 10 ** (-k / 2)) for k in range(2 * 6)]
        tried = list(dict.fromkeys(min(r, 1e-2) for r in grid))
        for coarse, fine in zip(tried, [*tried[1:], finest], strict=True):
            if max(self._own(coarse)[1], self._own(fine)[1]) <= error:
                return coarse, self._own(coarse)
        return finest, self._own(finest)

    def _own(self, rtol: float) -> tuple[Run, float]:
        if rtol not in self.ours:
            self.ours[rtol] = self._tried("taylor", rtol)
        return self.ours[rtol]

    def _tried(self, name: str, rtol: float) -> tuple[Run, float]:
        run = programs([name])[0].prepare(self.case, self.compiled, rtol)
        return run, self.reference.distance(run(np.inf).y)


def case_of(problem: Problem) -> Case:
    """Return a problem as what is measured."""
    numbers = (problem.start, problem.parameters, problem.inputs)
    return Case(problem.name, problem.title, problem.system, *numbers, problem.end)
