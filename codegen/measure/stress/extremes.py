"""Torque-free bodies at the edges: thin, nearly symmetric, fast, slow, next to the separatrix, at rest.

Every run is compared with the closed form. What it may lose is found by the closed form alone: at
times on the way the state is changed by as much as one step may err, delta = rtol (size + floor), in
each component by itself, and the closed form goes on from there. The largest sum of the changes, over the
times on the way, is what one step may cost at the end; all steps may cost so much times their number,
or times its root where their errors are a random walk.
At full precision delta is a change in the last place. Where the result is larger than the motion itself,
nothing can be known, by no method, and the report says so.

The C target in single precision beside that in double, and both beside 50 digits.

The bound of the interpreter for double precision (`codegen.ir.interpret`) times 2^29, the ratio of the two
units of rounding, holds for single precision, as the operations are the same.
"""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass

import numpy as np

from codegen.closed.exact import free_motion
from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.ir.interpret import Bounded, Point, interpret_with_bound
from codegen.measure.stress.growth import turn_between
from codegen.measure.stress.record import ABSOLUTE, EPSILON, Figure, Findings, Material, Plan
from codegen.measure.stress.workers import HELD, Collector, Run, tolerance_of
from codegen.measure.workprecision.case import Case
from codegen.native import native
from codegen.native.trajectory import Array
from codegen.passes.pipeline import by_parameters
from codegen.runs.result import Result
from codegen.targets.c import float_prefix, float_single_text

STOPS = 7
"""Times on the way at which the state is changed."""
TURNS = 20.0
WALK = 3.0
"""Errors of steps at full precision with compensated sums are a random walk: three standard deviations."""
NOTABLE = 2.0
"""Digits that a change of one step may cost, from which on that is printed."""
LOST = 0.1
"""Relative error at which a result shows nothing; beyond it figures are not compared."""
NOISE = 8 * EPSILON
"""Rounding of the two closed forms themselves."""


@dataclass(frozen=True)
class Body:
    """Moments (kg m^2) and angular velocity at the start (rad/s), followed for some turns."""

    name: str
    moments: tuple[float, float, float]
    omega: tuple[float, float, float]
    turns: float = TURNS


_S = 1e-14
BODIES = (
    Body("moments 1e-12 : 1 : 1", (1e-12, 1.0, 1.0 - 2.0**-41), (3.0, 0.5, 0.4)),
    Body("moments 1 : 1e12 : 1e12", (1.0, 1e12, 1e12 + 0.5), (30.0, 0.2, 0.1)),
    Body("moments 1e12 (1, 2, 2.5)", (1e12, 2e12, 2.5e12), (0.3, 1.0, 0.8)),
    Body("moments 1e-12 (1, 2, 2.5)", (1e-12, 2e-12, 2.5e-12), (0.3, 1.0, 0.8)),
    Body("I1 = I2 to a part in 1e15", (1.0, 1.0 + 1e-15, 1.5), (0.3, 0.4, 1.0)),
    Body("I2 = I3 to a part in 1e15", (1.0, 1.5, 1.5 * (1 + 1e-15)), (0.8, 0.4, 0.5)),
    Body("all equal to some parts in 1e15", (1.0, 1.0 + 1e-15, 1.0 + 2e-15), (0.3, 0.4, 1.0)),
    Body("spin of 1e9 rad/s", (1.0, 2.0, 3.0), (3e8, 1e9, 8e8)),
    Body("spin of 1e-9 rad/s", (1.0, 2.0, 3.0), (3e-10, 1e-9, 8e-10)),
    Body("on the separatrix", (1.0, 2.0, 2.25), (0.75, 0.5, 1.0), 4.0),
    Body("on the separatrix, 20 turns", (1.0, 2.0, 2.25), (0.75, 0.5, 1.0)),
    Body("1e-14 above the separatrix", (1.0, 2.0, 2.25), (0.75, 0.5, 1.0 + _S), 4.0),
    Body("1e-14 above the separatrix, 20 turns", (1.0, 2.0, 2.25), (0.75, 0.5, 1.0 + _S)),
    Body("1e-14 below the separatrix", (1.0, 2.0, 2.25), (0.75, 0.5, 1.0 - _S), 4.0),
    Body("on the unstable axis", (1.0, 2.0, 3.0), (0.0, 1.0, 0.0), 2.0),
    Body("on the unstable axis, 20 turns", (1.0, 2.0, 3.0), (0.0, 1.0, 0.0)),
    Body("1e-14 from the unstable axis", (1.0, 2.0, 3.0), (_S, 1.0, 0.0), 2.0),
    Body("1e-14 from the unstable axis, 20 turns", (1.0, 2.0, 3.0), (_S, 1.0, 0.0)),
    Body("1e-14 from it in both directions", (1.0, 2.0, 3.0), (_S, 1.0, -_S), 2.0),
    Body("1e-14 from a stable axis", (1.0, 2.0, 3.0), (_S, 0.0, 1.0)),
    Body("at rest", (1.0, 2.0, 3.0), (0.0, 0.0, 0.0)),
)
REST = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Reference:
    """The closed form of a body at ``times``; ``cost``: of one step, for a relative change of 1.

    ``per_step(rtol)`` is taken with the change itself, as it is not linear next to the separatrix.
    """

    body: Body
    times: Array
    omega: Array
    attitude: Array

    @property
    def speed(self) -> float:
        """What rates are compared with."""
        return float(np.linalg.norm(self.body.omega)) or 1.0

    def errors(self, omega: Array, attitude: Array) -> Array:
        """Return at each time the larger of the relative error of the rates and that of the attitude."""
        rates = np.linalg.norm(omega - self.omega, axis=0) / self.speed
        larger: Array = np.maximum(rates, turn_between(attitude, self.attitude))
        return larger

    def per_step(self, rtol: float) -> float:
        """Return the most that an error of one step, at any of the times, makes of any later state."""
        worst = np.zeros(len(self.times))
        largest = np.zeros(3)
        for k in range(len(self.times) - 1):
            largest = np.maximum(largest, np.abs(self.omega[:, k]))
            change = rtol * (largest + ABSOLUTE * self.speed)
            worst[k:] = np.maximum(worst[k:], self._changed(k, change, rtol))
        return float(worst.max())

    def _changed(self, k: int, change: Array, rtol: float) -> Array:
        """Return the sum of the consequences of each change at time number k, from there on."""
        later = self.times[k:] - self.times[k]
        omega, attitude = self.omega[:, k], _unit(self.attitude[:, k])
        plain = free_motion(self.body.moments, omega, attitude)(later)
        total = np.full(
            len(later), 4 * rtol * (1 + ABSOLUTE)
        )  # a quaternion that errs turns twice as far
        for axis in range(3):
            moved = omega.copy()
            moved[axis] += change[axis]
            w, q = free_motion(self.body.moments, moved, attitude)(later)
            rates = np.linalg.norm(w - plain[0], axis=0) / self.speed
            total += np.maximum(rates, turn_between(q, plain[1]))
        return total


def _unit(q: Array) -> Array:
    unit: Array = q / np.linalg.norm(q)
    return unit


def reference(body: Body) -> Reference:
    """Return the closed form of a body at `STOPS` times after the start."""
    speed = float(np.linalg.norm(body.omega)) or 1.0
    times = np.linspace(0.0, 2 * math.pi * body.turns / speed, STOPS + 1)
    return Reference(body, times, *free_motion(body.moments, body.omega, REST)(times))


def extreme_bodies(material: Material, plan: Plan) -> Findings:
    """Compare every method with the closed form on every body."""
    compiled = compile_system(material.free_body)
    found = Collector()
    for k, body in enumerate(BODIES):
        known = reference(body)
        costs: dict[float, float] = {}
        for method in plan.methods:
            rtol = tolerance_of(method)
            run = _run(compiled, known, rtol, plan.size.limit)
            result = found.result(run, method, rtol, body.name)
            if result is None:
                continue
            if result.status != 0 and result.t_stop == known.times[0]:  # it says so at the start
                found.refused.setdefault((method, result.message), []).append(body.name)
                continue
            if rtol not in costs:
                costs[rtol] = known.per_step(rtol)
            found.figures.append(_figure(known, method, result, costs[rtol], rtol))
        plan.progress((k + 1) / len(BODIES))
    return found.findings()


def _run(compiled: Compiled, known: Reference, rtol: float, limit: float) -> Run:
    """Absolute tolerances belong to the size of the states."""
    body = known.body
    start = dict(zip(compiled.system.state_names, (*body.omega, *REST), strict=True))
    moments = dict(zip(("I1", "I2", "I3"), body.moments, strict=True))
    sizes = np.array([known.speed] * 3 + [1.0] * 4)
    return Run(compiled, start, known.times, {}, moments, ABSOLUTE * rtol * sizes, limit)


def _figure(known: Reference, method: str, result: Result, cost: float, rtol: float) -> Figure:
    what = f"{known.body.name}: {method}"
    if result.status != 0 or result.y.shape[1] != len(known.times):
        return Figure(what, math.inf, cost, result.message)
    error = float(np.max(known.errors(result.y[:3], result.y[3:])))
    steps = max(1, result.steps)
    bound = (WALK * math.sqrt(steps) if method in HELD else steps) * cost + NOISE
    digits = math.log10(max(1.0, cost / (4 * rtol)))
    note = f"{result.steps} steps; a change of {rtol:.1e} may cost {digits:.1f} digits"
    if bound > LOST:
        finite = bool(np.isfinite(result.y).all())
        text = f"all may be lost; error {error:.1e}; {note}"
        return Figure(
            f"{what}: finite", 0.0 if finite else math.inf, 0.0, text, shown=method in HELD
        )
    return Figure(what, error, bound, note, shown=method in HELD and digits > NOTABLE)


RATIO = 2.0**29
"""Unit of rounding of single precision over that of double."""
POINTS = 8
NEAR = 1e-2
"""A bound of first order says nothing where it is a larger part of the value."""
LEAST_DECIDED = 0.5
"""Share of the values at least for which the bound has to say something."""
TINY = 1e-30


def single_precision(material: Material, plan: Plan) -> Findings:
    """Evaluate every group of every scene at points of its motion, in both precisions."""
    found = Collector()
    if not native.compiler():
        return Findings((), ("every scene: there is no C compiler",))
    for k, case in enumerate(material.scenes):
        _scene(case, found)
        plan.progress((k + 1) / len(material.scenes))
    return found.findings()


def _scene(case: Case, found: Collector) -> None:
    compiled = case.compiled()
    times = np.linspace(0.0, case.end, POINTS)
    start = {n: case.start[n] for n in compiled.system.state_names}
    result = found.result(Run(compiled, start, times, case.inputs), "DOP853", 1e-9, case.name)
    if result is None:
        return
    inputs = _rounded(np.array([case.inputs[q.name] for q in compiled.layout.inputs]))
    single = _Single(compiled)
    for group, count in compiled.layout.sizes.items():
        shares: list[float] = []
        for t, x in zip(result.t, result.y.T, strict=True):
            point = Point(float(np.float32(t)), _rounded(x), [], inputs)
            shares += _shares(compiled, group, point, single)
        what = f"{case.name}: {group}"
        total = count * len(result.t)
        note = f"{len(shares)} of {total} values decided by the bound"
        found.figures.append(
            Figure(f"{what}: error over bound", max(shares, default=0.0), 1.0, note)
        )
        unbound = 1.0 - len(shares) / max(1, total)
        found.figures.append(
            Figure(f"{what}: not decided by the bound", unbound, 1 - LEAST_DECIDED, note)
        )


def _rounded(values: Array) -> list[float]:
    return [float(v) for v in np.asarray(values).astype(np.float32)]


def _shares(compiled: Compiled, group: str, point: Point, single: _Single) -> list[float]:
    """Return error over bound of each value of single precision that the bound says something about.

    The error is the larger of that against 50 digits and that against double precision.
    """
    bounds = interpret_with_bound(compiled.program, point)[group]
    function = compiled.functions[group]
    doubles = function(point.t, np.array(point.x), np.empty(0), np.array(point.u))
    shares = []
    for value, double, bounded in zip(single(group, point), doubles, bounds, strict=True):
        allowed = _allowed(bounded)
        if allowed is not None:
            exact = abs(float(bounded.value - float(value)))
            beside = abs(float(value) - float(double)) - bounded.error
            error = max(exact, beside)
            shares.append(0.0 if error == 0.0 else error / allowed if allowed else math.inf)
    return shares


def _allowed(bounded: Bounded) -> float | None:
    """Return the bound in single precision, or None where it says nothing."""
    size, error = abs(float(bounded.value)), bounded.error * RATIO
    if not math.isfinite(error) or (size > 0 and (size < TINY or error > NEAR * size)):
        return None
    return float(error)


class _Single:
    """A program compiled in single precision."""

    def __init__(self, compiled: Compiled) -> None:
        self.sizes = compiled.layout.sizes
        text = float_single_text(compiled.program, compiled.layout)
        self.library = native.load(native.compile_library(text), text)
        self.name = float_prefix(compiled.layout)
        count = len(by_parameters(compiled.program, self.sizes).values)
        self.constants = np.zeros(max(1, count), np.float32)
        prepare = getattr(self.library, f"{self.name}_prepare")
        prepare.argtypes = [ctypes.c_void_p] * 2
        prepare(np.zeros(1, np.float32).ctypes.data, self.constants.ctypes.data)

    def __call__(self, group: str, point: Point) -> Array:
        """Return a group of results, as floats."""
        x, u = np.array(point.x, np.float32), np.array([*point.u, 0.0], np.float32)
        out = np.full(self.sizes[group], np.nan, np.float32)
        function = getattr(self.library, f"{self.name}_{group}")
        function.argtypes = [ctypes.c_float, *[ctypes.c_void_p] * 4]
        function.restype = None
        function(point.t, *(a.ctypes.data for a in (x, self.constants, u, out)))
        return out.astype(np.float64)
