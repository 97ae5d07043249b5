"""Measure run time and error of many programs on one case: repeated, interleaved, in shuffled order.

A diagram as a table and as JSON data.
"""

from __future__ import annotations

import itertools
import json
import math
import random
import statistics
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from rich.table import Table

from codegen.compiling.compiled import Compiled
from codegen.integrate.methods import METHODS
from codegen.measure.workprecision.case import Case, Reference, reference
from codegen.measure.workprecision.programs import Program, Run
from codegen.native.children import TooLongError
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
    where the program does not say.
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


SCHEMA = 1
ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)
"""Errors that the columns of the table are about."""
COMPARED = ("heyoka", "solve_ivp:DOP853", "solve_ivp:LSODA")
"""Programs that this project's fastest method is compared with."""
SPREAD = 0.25
"""Medians that exceed the least time by more are reported."""


def names(points: Sequence[Point]) -> list[str]:
    """Return the programs in the order in which they were measured."""
    return list(dict.fromkeys(p.program for p in points))


def table(diagram: Diagram) -> Table:
    """Return a row a program: least time for each error, then the least error and its time."""
    reference = diagram.reference
    result = Table(box=None, pad_edge=False, title=f"{diagram.case.name}: {diagram.case.title}")
    result.caption = f"reference: {reference.how}, itself within {reference.error:.1e}"
    errors = [f"{e:.0e}" for e in ERRORS]
    for column in ("time for error <=", *errors, "least error", "in"):
        result.add_column(column, no_wrap=True)
    for name in names(diagram.points):
        own = [p for p in diagram.points if p.program == name]
        best = min(own, key=lambda p: p.error)
        cells = [time_text(fastest(own, e)) for e in ERRORS]
        least = f"{'' if best.known else '< '}{best.error:.1e}"
        result.add_row(name, *cells, least, time_text(best))
    return result


def comparisons(diagram: Diagram) -> dict[str, dict[str, tuple[str, float]]]:
    """Return, by peer and error, this project's fastest method and its time over the peer's.

    Times are those of the curves at that error; errors that either does not reach are left out.
    """
    found: dict[str, dict[str, tuple[str, float]]] = {}
    by_name = {n: [p for p in diagram.points if p.program == n] for n in names(diagram.points)}
    own = [n for n in by_name if n in METHODS and n != "auto" and not n.startswith("scipy:")]
    for peer in (n for n in COMPARED if n in by_name):
        for error in ERRORS:
            theirs = time_at(by_name[peer], error)
            times = {n: time_at(by_name[n], error) for n in own}
            best = min(times, key=lambda n: times[n], default="")
            if best and max(theirs, times[best]) < math.inf:
                found.setdefault(peer, {})[f"{error:.0e}"] = (best, times[best] / theirs)
    return found


def comparison_lines(diagram: Diagram) -> list[str]:
    """Return `comparisons` as text, a line a peer."""
    return [
        f"fastest here over {peer}: "
        + ", ".join(f"{ratio:.2g} at {e} ({name})" for e, (name, ratio) in rows.items())
        for peer, rows in comparisons(diagram).items()
    ]


def time_text(point: Point | None) -> str:
    """Return the least time of a point, and by how much its median exceeds it where that is much."""
    if point is None:
        return "-"
    more = point.median / point.seconds - 1
    return _seconds(point.seconds) + (f" +{100 * more:.0f}%" if more > SPREAD else "")


def _seconds(seconds: float) -> str:
    units = ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"))
    size, unit = next(((s, u) for s, u in units if seconds >= s), (1e-9, "ns"))
    return f"{seconds / size:.3g} {unit}"


def notes(diagram: Diagram) -> list[str]:
    """Return a line a program that was not measured at all, or not to the finest tolerance."""
    return [f"{a.program}: not from rtol {a.rtol:.0e}: {a.reason}" for a in diagram.absent]


def data(diagram: Diagram, about: Mapping[str, Any]) -> str:
    """Return all that was measured as JSON; ``about``: what stands beside it (machine, date, ...)."""
    case, reference = diagram.case, diagram.reference
    found = {
        "schema": SCHEMA,
        "problem": {
            "name": case.name,
            "title": case.title,
            "start": dict(case.start),
            "parameters": dict(case.parameters),
            "inputs": dict(case.inputs),
            "end": case.end,
            "stiff": case.stiff,
        },
        "reference": {
            "how": reference.how,
            "error": reference.error,
            "end": [repr(float(x)) for x in reference.high],
            "scale": [float(x) for x in reference.scale],
        },
        "plan": asdict(diagram.plan),
        "points": [asdict(p) for p in diagram.points],
        "absent": [asdict(a) for a in diagram.absent],
        "comparisons": comparisons(diagram),
        **about,
    }
    return json.dumps(found, indent=1) + "\n"
