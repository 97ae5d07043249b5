"""Measure run time and error of many programs on one case: repeated, interleaved, in shuffled order."""

from __future__ import annotations

import itertools
import math
import random
import statistics
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.measure.workprecision.case import Case, Reference, reference
from codegen.measure.workprecision.programs import Program, Run
from codegen.native.patience import TooLongError
from eom.errors import InputError

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13, 2.0**-52)
QUICK_TOLERANCES = (1e-4, 1e-8, 1e-12)
REPEATED = 0.02
"""Seconds that the runs of one point take in one round, at most; a single one may take longer."""
MOST_REPEATS = 20


@dataclass(frozen=True)
class Plan:
    """What is measured: ``tolerances``, relative, in ``rounds`` of timing.

    ``limit``: seconds after which a run is given up; its method is not tried at finer tolerances.
    ``seed``: shuffles the order of the runs in each round.
    """

    tolerances: tuple[float, ...] = TOLERANCES
    rounds: int = 5
    limit: float = 1.0
    seed: int = 0


QUICK = Plan(QUICK_TOLERANCES, 2, 0.2)


@dataclass(frozen=True)
class Point:
    """One ``program`` at one relative tolerance, ``rtol``.

    ``error``: see `Reference.distance`; ``known``: false where it is below the reference's own,
    which then stands there. ``seconds``: the least of ``runs``; ``median``: of them. ``steps``: -1
    where the program does not tell.
    """

    program: str
    rtol: float
    error: float
    known: bool
    seconds: float
    median: float
    runs: int
    steps: int


@dataclass(frozen=True)
class Absence:
    """A ``program`` that was not measured from the tolerance ``rtol`` on, and the ``reason``."""

    program: str
    rtol: float
    reason: str


@dataclass(frozen=True)
class Diagram:
    """All that was measured on one case: ``points``, and the programs that are ``absent``."""

    case: Case
    reference: Reference
    points: tuple[Point, ...]
    absent: tuple[Absence, ...]
    plan: Plan


@dataclass
class _Trial:
    """A point while its times are collected."""

    program: str
    rtol: float
    run: Run
    error: float
    known: bool
    steps: int
    repeats: int
    seconds: list[float] = field(default_factory=list)

    def collect(self) -> None:
        self.seconds += [self.run(np.inf).seconds for _ in range(self.repeats)]

    def point(self) -> Point:
        return Point(
            self.program,
            self.rtol,
            self.error,
            self.known,
            min(self.seconds),
            statistics.median(self.seconds),
            len(self.seconds),
            self.steps,
        )


def measure(
    case: Case,
    programs: Sequence[Program],
    plan: Plan,
    progress: Callable[[float], None] = lambda fraction: None,
) -> Diagram:
    """Return run time against error of ``programs`` on a case.

    Each point is run once for its error, then in ``plan.rounds`` rounds over all points for its time.
    Raises `InputError` where there is no reference solution.
    """
    compiled = case.compiled()
    known = reference(case, compiled, lambda f: progress(0.2 * f))
    trials: list[_Trial] = []
    absent: list[Absence] = []
    for k, program in enumerate(programs):
        absence = _try(program, case, compiled, known, plan, trials)
        absent += [absence] if absence else []
        progress(0.2 + 0.3 * (k + 1) / len(programs))
    draw = random.Random(plan.seed)  # noqa: S311 - an order, not a secret
    for k in range(plan.rounds):
        for trial in draw.sample(trials, len(trials)):
            trial.collect()
        progress(0.5 + 0.5 * (k + 1) / plan.rounds)
    return Diagram(case, known, tuple(t.point() for t in trials), tuple(absent), plan)


def _try(
    program: Program,
    case: Case,
    compiled: Compiled,
    known: Reference,
    plan: Plan,
    trials: list[_Trial],
) -> Absence | None:
    """Append a trial for each tolerance, from coarse to fine; return why that ended early."""
    for rtol in plan.tolerances:
        try:
            trials.append(_trial(program, case, compiled, known, rtol, plan.limit))
        except TooLongError:
            return Absence(
                program.name, rtol, f"takes more than {plan.limit:g} s, or too many steps"
            )
        except (InputError, UserWarning) as error:
            return Absence(program.name, rtol, _reason(error))
    return None


def _reason(error: Exception) -> str:
    """Return the first sentence of an error, or of a warning that a tolerance is not kept."""
    return str(error).splitlines()[0].partition(". ")[0]


def _trial(
    program: Program, case: Case, compiled: Compiled, known: Reference, rtol: float, limit: float
) -> _Trial:
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        run = program.prepare(case, compiled, rtol)
        first = run(limit)
    error, is_known = known.measured(first.y)
    if not np.isfinite(error):
        raise InputError("the end is not finite")
    repeats = max(1, min(MOST_REPEATS, int(REPEATED / max(first.seconds, 1e-9))))
    return _Trial(program.name, rtol, run, error, is_known, first.steps, repeats)


def fastest(points: Sequence[Point], error: float) -> Point | None:
    """Return the fastest of some points whose error is at most ``error``."""
    enough = [p for p in points if p.error <= error]
    return min(enough, key=lambda p: p.seconds, default=None)


def time_at(points: Sequence[Point], error: float) -> float:
    """Return the time of one program at an error, between its points by straight lines in the diagram.

    The least where its curve passes the error more than once; infinite where it never gets there.
    """
    found = [p.seconds for p in points if p.error == error]
    for a, b in itertools.pairwise(points):
        if min(a.error, b.error) < error < max(a.error, b.error):
            share = math.log(error / a.error) / math.log(b.error / a.error)
            found.append(a.seconds * (b.seconds / a.seconds) ** share)
    if found:
        return min(found)
    return min((p.seconds for p in points if p.error < error), default=math.inf)
