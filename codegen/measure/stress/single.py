"""The C target in single precision beside that in double, and both beside 50 digits.

The bound of the interpreter for double precision (`codegen.ir.interpret`) times 2^29, the ratio of the two
units of rounding, holds for single precision, as the operations are the same.
"""

from __future__ import annotations

import ctypes
import math

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.ir.interpret import Bounded, Point, interpret_with_bound
from codegen.measure.stress.record import Figure, Findings, Material, Plan
from codegen.measure.stress.running import Collector, Run
from codegen.measure.workprecision.case import Case
from codegen.native import native
from codegen.native.trajectory import Array
from codegen.passes.stages import by_parameters
from codegen.targets.c_float import prefix, single_text

RATIO = 2.0**29
"""Unit of rounding of single precision over that of double."""
POINTS = 8
NEAR = 1e-2
"""A bound of first order says nothing where it is a larger part of the value."""
LEAST_TOLD = 0.5
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
        note = f"{len(shares)} of {total} values told by the bound"
        found.figures.append(
            Figure(f"{what}: error over bound", max(shares, default=0.0), 1.0, note)
        )
        told = 1.0 - len(shares) / max(1, total)
        found.figures.append(Figure(f"{what}: not told by the bound", told, 1 - LEAST_TOLD, note))


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
        text = single_text(compiled.program, compiled.layout)
        self.library = native.load(native.compile_library(text), text)
        self.name = prefix(compiled.layout)
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
