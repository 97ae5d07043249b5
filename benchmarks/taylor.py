"""The method taylor beside heyoka, which integrates by Taylor series that LLVM compiles.

The problems are the smooth ones of `eom.problems`, errors are against solutions with many digits:
what ``eom bench`` measures, held to targets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from benchmarks.pairs import paired, settled
from benchmarks.peers import absent, missing
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen.compiled import Compiled
from codegen.workprecision.case import Case, Reference, reference
from codegen.workprecision.programs import End, programs
from eom import problems

TOLERANCES = (1e-6, 1e-9, 1e-12, 2.0**-52)
LARGEST_RATIO = 0.7
RUNS_A_SAMPLE = 10
ROUNDING = 2e-12
"""Errors below this, relative to the largest size of a state, are rounding in either program."""


@dataclass(frozen=True)
class Contest:
    """One problem for both programs, and its end with many digits."""

    case: Case
    compiled: Compiled
    reference: Reference

    def run(self, program: str, rtol: float) -> Callable[[], End]:
        """Return what integrates by a program of `codegen.workprecision`; all is compiled."""
        (row,) = programs([program])
        run = row.prepare(self.case, self.compiled, rtol)
        run(float("inf"))
        return lambda: run(float("inf"))


def contest(problem: problems.Problem) -> Contest:
    """Return a problem compiled, and its reference."""
    numbers = (problem.start, problem.parameters, problem.inputs)
    case = Case(problem.name, problem.title, problem.system, *numbers, problem.end)
    compiled = case.compiled()
    return Contest(case, compiled, reference(case, compiled))


def measure(settings: Settings) -> Section:
    """Return time of the integration alone, and error, of each problem at each tolerance."""
    title = "simulate, method taylor | heyoka"
    without = missing("heyoka")
    if without:
        return Section(title, (absent("Taylor series", without),))
    smooth = [p for p in problems.PROBLEMS if not p.stiff]
    contests = [contest(problem) for problem in (smooth[:1] if settings.quick else smooth)]
    return Section(
        title, tuple(r for c in contests for t in TOLERANCES for r in _rows(c, t, settings))
    )


def _rows(contest: Contest, rtol: float, settings: Settings) -> tuple[Row, Row]:
    run, other = contest.run("taylor", rtol), contest.run("heyoka", rtol)
    ours, theirs = (contest.reference.measured(r().y)[0] for r in (run, other))
    count = 3 if settings.quick else 7
    pairs = settled(
        lambda: paired(
            lambda: min(run().seconds for _ in range(RUNS_A_SAMPLE)),
            lambda: min(other().seconds for _ in range(RUNS_A_SAMPLE)),
            count,
        ),
        lambda p: p.ratio,
        LARGEST_RATIO,
    )
    what = f"{contest.case.name}, {rtol:.0e}"
    times = (time_text(s) for s in pairs.best)
    quick = pairs.ratio <= LARGEST_RATIO
    met = ours <= max(theirs, ROUNDING)
    return (
        Row(f"{what}: time", *times, f"{pairs.ratio:.2f}", f"<= {LARGEST_RATIO}", quick),
        Row(f"{what}: error", f"{ours:.1e}", f"{theirs:.1e}", "", f"<= heyoka's, or {ROUNDING:.0e}", met),
    )  # fmt: skip
