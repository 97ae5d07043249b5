"""Many rotations of a tumbling body: how errors grow with the steps (Brouwer's law).

Rounding errors without a bias add up to a random walk: those of constants of the motion grow like
steps^(1/2), those of phases like steps^(3/2) (Brouwer, Astron. J. 46 (1937) 149). A systematic error a
step, of rounding or of the method, shows as an exponent of 1 and 2. Exponents are slopes of straight
lines through the logarithms of the root mean square over several starts; their error bar is three
standard deviations over resampled starts (Efron and Tibshirani, An Introduction to the Bootstrap, 1993).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from codegen.closed.exact import FreeMotion, free_motion
from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.program import INVARIANTS
from codegen.measure.stress.record import EPSILON, Figure, Findings, Material, Plan
from codegen.measure.stress.workers import HELD, Collector, Run
from codegen.native.trajectory import Array
from codegen.runs.result import Result

MOMENTS = {"I1": 1.5e-4, "I2": 4.0e-4, "I3": 5.2e-4}
OMEGA = (0.05, 10.0, 0.05)
SPREAD = 0.01
"""By which part the starts differ."""
FLIP = 0.25
"""Part of a period, from the start, at which the body turns over fastest. Errors are compared there, period
by period: what an error of phase makes of the state depends on where in its period that is."""
FIRST_PERIOD = 4
"""Periods after which errors are compared: before, errors of phase are not yet sums over many flips."""
DECADES = 3.0
TIMES_A_DECADE = 10
RESAMPLED = 400
COMPARED_RTOL = 1e-13
COMPARED_STARTS = 2
IN_C = 30
"""Methods whose loop is generated C are given so many times the limit: they get somewhere."""
CONSTANTS = ("T", "H", "H_1", "H_2", "H_3")
PHASES = ("omega", "attitude")
WALK = {**dict.fromkeys(CONSTANTS, 0.5), **dict.fromkeys(PHASES, 1.5)}
HIDDEN = 2 * EPSILON
"""Errors that the rounding of the stored states hides; a fit begins where the error is larger."""
BAR = 3.0
"""Standard deviations of an error bar: there are many exponents, and none is to fail by chance."""
LARGEST_BAR = 0.4
"""An exponent that is known to less shows nothing."""


@dataclass(frozen=True)
class Fit:
    """An exponent with its error bar, over so many decades of steps."""

    exponent: float
    bar: float
    decades: float


def long_run(material: Material, plan: Plan) -> Findings:
    """Fit the growth of errors of constants and phases for the methods that are held to a random walk."""
    compiled = compile_system(material.free_body, parameters=MOMENTS)
    found = Collector()
    for method in plan.applicable(HELD):
        errors = _errors(compiled, plan, method, found)
        found.figures += _verdicts(method, *errors, plan) if errors else []
    for method in plan.methods:
        if method not in HELD:
            errors = _errors(compiled, plan, method, found)
            found.figures += _comparison(method, *errors) if errors else []
    return found.findings()


def _starts(plan: Plan, count: int) -> Array:
    """Return angular velocities (count, 3) near that of the ready scene."""
    draw = np.random.default_rng(plan.seed)
    return np.array(OMEGA) * (1 + SPREAD * draw.uniform(-1, 1, (count, 3)))


def _errors(
    compiled: Compiled, plan: Plan, method: str, found: Collector
) -> tuple[Array, Array] | None:
    """Return numbers of steps (N,) and errors (starts, quantities, N), or None."""
    held = method in HELD
    longer = 1 if ":" in method else IN_C
    rtol, limit = (EPSILON, np.inf) if held else (COMPARED_RTOL, longer * plan.size.limit)
    starts = _starts(plan, plan.size.starts if held else COMPARED_STARTS)
    rows, steps, periods = [], 0.0, _periods(plan)
    for k, omega in enumerate(starts):
        motion = free_motion([*MOMENTS.values()], omega)
        times = np.concatenate([[0.0], (periods + FLIP) * motion.period])
        start = np.array([*omega, 1.0, 0.0, 0.0, 0.0])
        result = found.result(Run(compiled, start, times, limit=limit), method, rtol, f"start {k}")
        if result is None:
            return None
        if result.status != 0 and held:
            found.figures.append(Figure(f"{method}: start {k}", math.inf, 0.0, result.message))
        elif result.status != 0:
            found.refused.setdefault((method, result.message), []).append(f"start {k}")
        if result.status != 0:
            return None
        rows.append(_deviations(compiled, result, motion))
        steps += result.steps / len(starts)
        plan.progress((0.8 * (k + 1) / len(starts)) if held else 0.9)
    return np.maximum(steps * (periods + FLIP) / periods[-1], 1.0), np.array(rows)


def _periods(plan: Plan) -> Array:
    """Return numbers of whole periods over up to `DECADES`, evenly in the logarithm; each once."""
    motion = free_motion([*MOMENTS.values()], OMEGA)
    turn = 2 * math.pi / float(np.linalg.norm(OMEGA))
    last = plan.size.rotations * turn / motion.period
    decades = min(DECADES, math.log10(last / FIRST_PERIOD))
    count = round(decades * TIMES_A_DECADE) + 1
    return np.unique(np.round(last * np.logspace(-decades, 0, count)))


def _deviations(compiled: Compiled, result: Result, motion: FreeMotion) -> Array:
    """Return relative errors of the constants, of omega and of the attitude (rad), a row each."""
    names = compiled.layout.results[INVARIANTS]
    exact = [
        interpret_exactly(compiled.program, Point(0.0, [float(v) for v in x]))[INVARIANTS]
        for x in result.y.T
    ]
    size = exact[0][names.index("H")]
    scales = {n: exact[0][names.index(n)] if n in {"T", "H"} else size for n in CONSTANTS}
    rows = [
        [float((v[names.index(n)] - exact[0][names.index(n)]) / scales[n]) for v in exact[1:]]
        for n in CONSTANTS
    ]
    w, q = motion(result.t[1:])
    rates = np.linalg.norm(result.y[:3, 1:] - w, axis=0) / np.linalg.norm(result.y[:3, 0])
    return np.array([*rows, rates, turn_between(result.y[3:, 1:], q)])


def turn_between(a: Array, b: Array) -> Array:
    """Return the angle (rad) between attitudes given by quaternions (4, N), of any length."""
    a = a / np.linalg.norm(a, axis=0)
    least = np.minimum(np.linalg.norm(a - b, axis=0), np.linalg.norm(a + b, axis=0))
    angle: Array = 4 * np.arcsin(np.minimum(1.0, least / 2))
    return angle


def _verdicts(method: str, steps: Array, errors: Array, plan: Plan) -> list[Figure]:
    figures = []
    for k, name in enumerate((*CONSTANTS, *PHASES)):
        fit = fitted(steps, errors[:, k], plan.seed)
        last = _rms(errors[:, k])[-1]
        end = f"{last:.1e} after {steps[-1]:.2g} steps"
        if fit is None:
            note = f"no growth above rounding of the states; {end}"
            figures.append(Figure(f"{method}: exponent of {name}", 0.0, WALK[name], note))
            continue
        note = f"+- {fit.bar:.2f} over {fit.decades:.1f} decades; {end}"
        bound = WALK[name] + fit.bar
        figures.append(Figure(f"{method}: exponent of {name}", fit.exponent, bound, note))
        if name in CONSTANTS:
            figures.append(Figure(f"{method}: its error bar, {name}", fit.bar, LARGEST_BAR))
    return figures


def _comparison(method: str, steps: Array, errors: Array) -> list[Figure]:
    worst = {n: _rms(errors[:, k])[-1] for k, n in enumerate((*CONSTANTS, *PHASES))}
    text = ", ".join(f"{n} {v:.1e}" for n, v in worst.items())
    largest = max(worst[n] for n in CONSTANTS)
    note = f"at rtol {COMPARED_RTOL:.0e} after {steps[-1]:.2g} steps: {text}; no verdict"
    return [Figure(f"{method}: largest error of a constant", largest, None, note)]


def _rms(errors: Array) -> Array:
    root: Array = np.sqrt(np.mean(errors**2, axis=0))
    return root


def fitted(steps: Array, errors: Array, seed: int) -> Fit | None:
    """Return the exponent of errors (starts, N) over steps (N,); None where rounding hides all growth.

    >>> n = np.logspace(2, 5, 31)
    >>> round(fitted(n, 1e-15 * np.outer([1.0, 1.1, 0.9, 1.05], n), 0).exponent, 6)
    1.0
    """
    first = _first_seen(steps, _rms(errors))
    if first is None:
        return None
    n, seen = steps[first:], errors[:, first:]
    draw = np.random.default_rng(seed)
    samples = draw.integers(0, len(errors), (RESAMPLED, len(errors)))
    slopes = [_slope(n, _rms(seen[s])) for s in samples]
    decades = math.log10(n[-1] / n[0])
    return Fit(_slope(n, _rms(seen)), BAR * float(np.std(slopes)), decades)


def _first_seen(steps: Array, size: Array) -> int | None:
    """Return from where on errors are larger than what is hidden, if that is a decade at least."""
    hidden = np.flatnonzero(size < HIDDEN)
    first = int(hidden[-1]) + 1 if hidden.size else 0
    return first if 10 * steps[min(first, len(size) - 1)] <= steps[-1] else None


def _slope(n: Array, size: Sequence[float] | Array) -> float:
    return float(np.polyfit(np.log(n), np.log(np.maximum(size, EPSILON**2)), 1)[0])
