"""Whether `codegen.Result.accuracy` is right: its estimates against errors that are known.

Each trial is run as it says and asked how good it is. Its true error is the difference from expressions in
elementary functions at 50 digits, or from a Taylor series of many digits whose own error a second one with
fewer says. Errors are relative to the sizes that the estimate has, the largest over the states. No
true error counts as less than the rounding of the states that are stored.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import sympy as sp

from codegen.compiling.compiled import Compiled
from codegen.frontend.layout import names_of
from codegen.measure.stress.record import Figure, Findings, Material, Plan, Trial
from codegen.measure.stress.workers import Collector, Run
from codegen.measure.workprecision.case import Case
from codegen.native.trajectory import Array
from codegen.precision import extended
from codegen.runs.run_accuracy import Accuracy
from codegen.runs.simulation import Result
from eom.errors import InputError

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
