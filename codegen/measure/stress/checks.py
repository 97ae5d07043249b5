"""The table of checks: what each states, its bound, how it is measured, where the bound comes from.

Findings as a table, as lines of text, and as JSON data.

Whether `codegen.Result.accuracy` is right: its estimates against errors that are known.

Each trial is run as it says and asked how good it is. Its true error is the difference from expressions in
elementary functions at 50 digits, or from a Taylor series of many digits whose own error a second one with
fewer says. Errors are relative to the sizes that the estimate has, the largest over the states. No
true error counts as less than the rounding of the states that are stored.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from rich.table import Table

from codegen.compiling.compiled import Compiled
from codegen.frontend.layout import names_of
from codegen.measure.stress.angles import near_singular_angles
from codegen.measure.stress.extremes import extreme_bodies, single_precision
from codegen.measure.stress.forms import perturbed_forms
from codegen.measure.stress.growth import long_run
from codegen.measure.stress.hostile import hostile
from codegen.measure.stress.record import FAIL, PASS, Check, Figure, Findings, Material, Plan, Trial
from codegen.measure.stress.scenes import random_scenes
from codegen.measure.stress.sweeps import memory, there_and_back, tolerances
from codegen.measure.stress.workers import Collector, Run
from codegen.measure.workprecision.case import Case
from codegen.native.trajectory import Array
from codegen.precision import extended
from codegen.runs.result import Result
from codegen.runs.run_accuracy import Accuracy
from eom.errors import InputError, unknown_name

PARTS = 16
"""Parts of a run at whose ends it is compared."""
DIGITS = (36, 30)
WORKING = 50
MAX_STEPS = 20_000
UNIT_ROUNDOFF = 2.0**-53
WITHIN = 10.0
"""Factor within which an estimate is right."""
SHARE = 0.1
"""Part of the trials in which it may be larger."""
CONFIRMED = 0.01
"""Own error of a reference over the error that it reports, at most."""

States = Sequence[Sequence[Fraction]]


@dataclass(frozen=True)
class Measured:
    """Estimated and true errors of a trial, relative, at the end and the largest."""

    name: str
    end: tuple[float, float]
    largest: tuple[float, float]
    text: str

    @property
    def too_small(self) -> float:
        """By which factor the estimate is too small, at the worse of both places."""
        return max(_over(true, estimate) for estimate, true in (self.end, self.largest))

    @property
    def off(self) -> float:
        """By which factor it is off, to either side."""
        large = max(_over(estimate, true) for estimate, true in (self.end, self.largest))
        return max(large, self.too_small)


def _over(a: float, b: float) -> float:
    return a / b if b > 0 else math.inf


def accuracy_estimate(material: Material, plan: Plan) -> Findings:
    """Compare estimates with true errors; a trial without an estimate counts as ten times off."""
    found = Collector()
    measured: list[Measured] = []
    trials = [t for t in material.trials() if t.method in plan.methods]
    chosen = trials[: plan.size.trials]
    for k, trial in enumerate(chosen):
        one = _measured(trial, found)
        if one is not None:
            measured.append(one)
            note = (
                f"end {one.end[0]:.1e}, true {one.end[1]:.1e}; largest {one.largest[0]:.1e}, "
                f"true {one.largest[1]:.1e}; {one.text}"
            )
            what = f"{one.name}: estimate too small by"
            found.figures.append(Figure(what, one.too_small, WITHIN, note, shown=True))
        plan.progress((k + 1) / len(chosen))
    wrong = [m.name for m in measured if not m.off <= WITHIN]
    most = math.floor(SHARE * len(chosen))
    off = len(wrong) + len(chosen) - len(measured)
    found.figures.append(
        Figure("trials off by more than ten", off, most, "; ".join(wrong), shown=True)
    )
    return found.findings()


def _measured(trial: Trial, found: Collector) -> Measured | None:
    """Run a trial, estimate its error, and find the true one; None where it cannot be had."""
    case = trial.case
    compiled = case.compiled()
    times = np.linspace(0.0, case.end, PARTS + 1)
    name = f"{case.name}, {trial.method} at {trial.rtol:.0e}"
    run = Run(compiled, {n: case.start[n] for n in compiled.system.state_names}, times, case.inputs)
    result = found.result(run, trial.method, trial.rtol, name)
    if result is None:
        return None
    accuracy = result.accuracy()
    try:
        true = _true_errors(trial, compiled, result, accuracy)
    except InputError as error:
        found.refused.setdefault((trial.method, error.what), []).append(name)
        return None
    if not accuracy.known:
        return Measured(name, (math.nan, true[-1]), (math.nan, true.max()), str(accuracy))
    relative = accuracy.relative
    ends = float(relative[-1]), float(true[-1])
    return Measured(name, ends, (float(relative.max()), float(true.max())), str(accuracy))


def _true_errors(trial: Trial, compiled: Compiled, result: Result, accuracy: Accuracy) -> Array:
    """Return the true relative error of a run at each stored time but the first."""
    times = result.t[1:].tolist()
    fine, own = _known(trial, compiled, times)
    y = result.y[:, 1:]
    off = np.array(
        [[_apart(a, b) for a, b in zip(x, c, strict=True)] for x, c in zip(fine, y.T, strict=True)]
    )
    relative = np.max(off / accuracy.size, axis=1)
    if not np.all(own <= CONFIRMED * np.max(off, axis=1) + UNIT_ROUNDOFF * accuracy.size.max()):
        raise InputError("the reference is not accurate enough", where=trial.case.name)
    return np.asarray(np.maximum(relative, UNIT_ROUNDOFF))


def _apart(exact: Fraction, value: float) -> float:
    return float(abs(exact - Fraction(float(value)))) if math.isfinite(value) else math.inf


def _known(trial: Trial, compiled: Compiled, times: Sequence[float]) -> tuple[States, Array]:
    """Return states at times as exact as they are known, and by how much they may be off themselves."""
    if trial.solution:
        return _by_expressions(trial, compiled, times), np.zeros(len(times))
    case = trial.case
    fine, coarse = (_by_series(case, compiled, times, digits) for digits in DIGITS)
    own = [
        max(float(abs(a - b)) for a, b in zip(x, c, strict=True))
        for x, c in zip(fine, coarse, strict=True)
    ]
    return fine, np.array(own)


def _by_expressions(trial: Trial, compiled: Compiled, times: Sequence[float]) -> States:
    symbol = trial.case.system.time
    rows = []
    for t in times:
        exact = sp.Rational(*t.as_integer_ratio())
        values = [
            trial.solution[n].subs(symbol, exact).evalf(WORKING)
            for n in names_of(compiled.layout.states)
        ]
        rows.append([Fraction(str(v)) for v in values])
    return rows


def _by_series(case: Case, compiled: Compiled, times: Sequence[float], digits: int) -> States:
    layout = compiled.layout
    values = extended.Values(
        [case.start[n] for n in names_of(layout.states)],
        [case.parameters[n] for n in names_of(layout.parameters)],
        [case.inputs[n] for n in names_of(layout.inputs)],
    )
    span = 0.0, times[-1]
    found = extended.integrate(
        compiled.program, layout, values, span, digits, MAX_STEPS, stops=times[:-1]
    )
    return (*found.stops, found.end)


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
