"""The table of checks: what each states, its bound, how it is measured, where the bound comes from.

Findings as a table, as lines of text, and as JSON data.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from rich.table import Table

from codegen.measure.stress.angles import near_singular_angles
from codegen.measure.stress.estimates import accuracy_estimate
from codegen.measure.stress.extremes import extreme_bodies, single_precision
from codegen.measure.stress.forms import perturbed_forms
from codegen.measure.stress.growth import long_run
from codegen.measure.stress.hostile import hostile
from codegen.measure.stress.record import FAIL, PASS, Check, Figure, Findings, Plan
from codegen.measure.stress.scenes import random_scenes
from codegen.measure.stress.sweeps import memory, there_and_back, tolerances
from eom.errors import unknown_name

CHECKS = (
    Check(
        "long-run",
        "over many rotations of a tumbling T-handle, rounding errors add up to a random walk",
        "exponent of growth at most 1/2 for H, its components in space, and T; 3/2 for rates and "
        "attitude; plus the error bar, which is itself at most 0.4",
        "errors over three decades of steps (--quick: 1.5) from many starts at rtol 2^-52, "
        "constants in 50 digits, "
        "phases by the closed form; straight lines through logarithms, bars by resampled starts",
        "Brouwer, Astron. J. 46 (1937) 149; for methods with compensated sums, others are shown beside it",
        long_run,
    ),
    Check(
        "extreme-bodies",
        "inertia ratios of 1e+-12, moments equal to 1e-15, spins of 1e+-9, the separatrix, unstable axis, "
        "rest",
        "what errors of rtol in each step and state become, by the closed form; three times the root of "
        "the number of steps in place of the number where they are a random walk",
        "rates and attitude against the closed form, at seven times of up to 20 turns",
        "the closed form from states that are changed by one step's error, at times on the way",
        extreme_bodies,
    ),
    Check(
        "near-singular-angles",
        "Euler angles pass their singular configuration at 1e-1 to 1e-10, or stop as documented",
        "attitude: rtol (steps + 1/cos theta); reported margin: a tenth of it, and rtol a step",
        "attitude at the end against the closed form; margin, status, message at two margins to stop at",
        "the rates are divided by cos theta (sin theta), which is the condition of the angles",
        near_singular_angles,
    ),
    Check(
        "tolerances",
        "errors go down with the tolerance from 1e-3 to 2^-52, and no method promises too much",
        "no error above 3 times that at the coarser tolerance; none above steps x amplification x rtol",
        "ends of all methods on all reference problems against ends of 20 digits",
        "local errors of rtol (|x| + 1e-3), carried on by the problem's propagator; rounding of 8 units",
        tolerances,
    ),
    Check(
        "single-precision",
        "C in single precision keeps to its bound on all ready scenes",
        "the bound of the 50-digit interpreter for doubles, times 2^29",
        "all rates, outputs, invariants, singularities along the motion, against 50 digits and double",
        "running error analysis, Higham (2002), sect. 3.3; the operations are the same",
        single_precision,
    ),
    Check(
        "there-and-back",
        "a run to the end and back comes back to the start",
        "steps x amplification on the way back x rtol",
        "all methods on all reference problems at rtol 1e-9",
        "as for tolerances; where errors grow too much on the way back, that is reported",
        there_and_back,
    ),
    Check(
        "random-scenes",
        "random scenes end in time, hide no failure, keep their invariants, two methods agree",
        "no hang, crash or NaN without a message; drift, difference at most steps x amplification x rtol",
        "every scene in a process that is watched: derived, compiled once a kind, all methods in C",
        "as for tolerances",
        random_scenes,
    ),
    Check(
        "accuracy-estimate",
        "the estimate of a run's error is right within a factor of ten, and never ten times too small",
        "nine trials in ten within a factor of 10, at the end and at its largest; none below a tenth",
        "errors of thirty runs by all kinds of methods against solutions of 30 digits, over the estimates",
        "expressions in elementary functions, or Taylor series whose last digits a second one confirms",
        accuracy_estimate,
    ),
    Check(
        "hostile",
        "no method is far off a hostile system without saying so: friction, contacts, pulses, walls, tops",
        "1,000 x rtol x growth of the problem, where the status is at least 0 and the run has no notice",
        "references in quadruple precision, confirmed by SciPy, by `benchmarks.hostile_references`; "
        "rtol 1e-6, 1e-9, 1e-12",
        "growth: derivatives of the end by states on the way, along the reference",
        hostile,
    ),
    Check(
        "memory",
        "memory of a long run is bounded by the times that are asked for",
        "2 MB of growth of the peak; three stored times",
        "peak of a process before and after a run with so many steps that storing them would show",
        "nothing else is asked for; pages of the allocator",
        memory,
    ),
    Check(
        "closed-forms",
        "closed forms are found where they were, and none is taken of a system with a term more",
        "none lost, none taken wrongly",
        "2,000 terms (--quick: 200) of 1e-300 to 1e300 in any rate: powers, pulses, windows, exponentials, "
        "stops, of time, states and parameters; all of them state the body that they are not",
        "no term is one that a closed form has room for",
        perturbed_forms,
    ),
)
NAMES = tuple(check.name for check in CHECKS)


def chosen(names: tuple[str, ...]) -> tuple[Check, ...]:
    """Return the checks by name, in the order of the table; all of them without names."""
    for name in names:
        if name not in NAMES:
            raise unknown_name("check", name, NAMES)
    return tuple(c for c in CHECKS if not names or c.name in names)


SCHEMA = 1
PRINTED = 20
"""Failing figures of one check that are printed; the data hold all."""


@dataclass(frozen=True)
class Outcome:
    """A check, what it found, and how many seconds it took."""

    check: Check
    findings: Findings
    seconds: float


def all_passed(outcomes: Sequence[Outcome]) -> bool:
    """Whether every check passed; one that could not be measured has not."""
    return all(o.findings.verdict == PASS for o in outcomes)


def table(outcomes: Sequence[Outcome], plan: Plan) -> Table:
    """Return a row a check: verdict, figures that hold, the one nearest to its bound."""
    result = Table(
        box=None, pad_edge=False, title=f"eom stress, {plan.size.name}, seed {plan.seed}"
    )
    for column in ("check", "result", "within bound"):
        result.add_column(column, no_wrap=True)
    for column in ("nearest to its bound", "states", "bound"):
        result.add_column(column)
    for o in outcomes:
        held = [f for f in o.findings.figures if f.bound is not None]
        count = f"{sum(f.passed for f in held)} of {len(held)}"
        worst = o.findings.worst
        text = "-" if worst is None else _against(worst)
        result.add_row(o.check.name, o.findings.verdict, count, text, o.check.states, o.check.bound)
    return result


def _against(figure: Figure) -> str:
    bound = "" if figure.bound is None else f", bound {figure.bound:.3g}"
    return f"{figure.what}: {figure.value:.3g}{bound}"


def lines(outcomes: Sequence[Outcome]) -> list[str]:
    """Return what failed, what is printed without a bound, and what was not measured, a line each."""
    found = []
    for o in outcomes:
        name, failing = o.check.name, [f for f in o.findings.figures if not f.passed]
        found += [f"{name}: {FAIL}: {_line(f)}" for f in failing[:PRINTED]]
        if len(failing) > PRINTED:
            found.append(f"{name}: {FAIL}: {len(failing) - PRINTED} more")
        found += [f"{name}: {_line(f)}" for f in _notable(o.findings)]
        found += [f"{name}: not measured: {reason}" for reason in o.findings.absent]
    return found


def _notable(findings: Findings) -> list[Figure]:
    """Return figures without a bound, and those that are printed in any case."""
    return [f for f in findings.figures if f.passed and (f.bound is None or f.shown)]


def _line(figure: Figure) -> str:
    return _against(figure) + (f"; {figure.note}" if figure.note else "")


def data(outcomes: Sequence[Outcome], plan: Plan, about: Mapping[str, Any]) -> str:
    """Return all figures as JSON; ``about``: what stands beside them (machine, date)."""
    found = {
        "schema": SCHEMA,
        "plan": {"size": asdict(plan.size), "methods": plan.methods, "seed": plan.seed},
        "passed": all_passed(outcomes),
        "checks": [_check(o) for o in outcomes],
        **about,
    }
    return json.dumps(found, indent=1) + "\n"


def _check(o: Outcome) -> dict[str, Any]:
    words = {k: v for k, v in vars(o.check).items() if isinstance(v, str)}
    figures = [_figure(f) for f in o.findings.figures]
    rest = {"seconds": round(o.seconds, 3), "figures": figures, "absent": o.findings.absent}
    return {**words, "verdict": o.findings.verdict, **rest}


def _figure(f: Figure) -> dict[str, Any]:
    numbers = {"value": _number(f.value), "bound": _number(f.bound)}
    return {"what": f.what, **numbers, "passed": f.passed, "note": f.note}


def _number(value: float | None) -> float | str | None:
    """Return a number as JSON has it; infinity and NaN, which it has not, as text."""
    if value is None or math.isfinite(value):
        return None if value is None else float(value)
    return str(value)
