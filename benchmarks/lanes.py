"""Batches in vector lanes beside the plain batch and the function of one point, on one core; threads.

The arrays of 500 points stay in the nearest caches: the t-handle's three products a point are otherwise
nothing but the copying of 48 bytes.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from timeit import Timer
from typing import Any

import numpy as np

from benchmarks.native_rates import HERE, SEED, Array, Points, Rates, aligned, sampler
from benchmarks.pairs import Pairs, Sample, paired, settled
from benchmarks.settings import Settings
from benchmarks.table import Row, Section
from codegen import Compiled
from codegen import compile as compile_system
from codegen.ir.names import identifier
from codegen.native import native
from codegen.targets import c, lanes
from eom.scenes import catalogue
from eom.scenes.scene import Scene

POINTS = 500
CALLS = 40
MANY_POINTS = 400_000
LEAST_GAIN = 3.0
QUICK_GAIN = 1.5
"""Any processor's bound for the short form; two lanes are the least that there are."""
LARGEST_DIFFERENCE = 1e-12


@dataclass(frozen=True)
class Batches:
    """A C function of many points, and the arrays it is called with."""

    function: Any
    x: Array
    p: Array
    u: Array
    y: Array

    @classmethod
    def of(cls, compiled: Compiled, text: str, form: str) -> Batches:
        """Compile C text, and draw points: states in (-1, 1), parameters in (1/2, 3/2)."""
        library = native.load(native.compile_library(text), text)
        function = getattr(library, f"{identifier(compiled.layout.name)}_rates_{form}")
        points = Points.of(compiled)
        draw = np.random.default_rng(SEED).uniform
        x = aligned(draw(-1.0, 1.0, (points.x.shape[1], POINTS)))
        return cls(function, x, points.p, points.u, aligned(np.zeros_like(x)))

    def sample(self) -> float:
        """Return the seconds a point."""
        address = ctypes.cast(self.function, ctypes.c_void_p).value
        arrays = (self.x, self.p, self.u, self.y)
        return 1e-9 * float(_clock()(address, CALLS, POINTS, *(a.ctypes.data for a in arrays)))


@cache
def _clock() -> Any:
    text = (HERE / "batch_timer.c").read_text("utf-8")
    function = native.load(native.compile_library(text), text).nanoseconds_a_point
    function.restype = ctypes.c_double
    function.argtypes = [ctypes.c_void_p, ctypes.c_long, ctypes.c_size_t, *[ctypes.c_void_p] * 4]
    return function


def measure(settings: Settings) -> Section:
    """Return the rows of each ready scene; threads in the long form alone."""
    rows = [row for name in catalogue.single() for row in _rows(name, settings)]
    return Section("points a second and core: in lanes | without", tuple(rows))


def _rows(name: str, settings: Settings) -> Iterator[Row]:
    compiled = compile_system(Scene.ready(name).derive(), "c")
    program = compiled.program, compiled.layout
    ours = Batches.of(compiled, lanes.single_text(*program), "lanes")
    plain = Batches.of(compiled, c.single_text(*program), "batch")
    count = 30 if settings.quick else 300
    gain = QUICK_GAIN if settings.quick else LEAST_GAIN
    ours.sample(), plain.sample()
    difference = np.abs(ours.y - plain.y).max() / np.abs(plain.y).max()
    if not difference <= LARGEST_DIFFERENCE:
        yield Row(name, f"differs by {difference:.1e}", target="the same numbers", met=False)
        return
    yield _judged(f"{name} | plain batch", ours.sample, plain.sample, count, gain)
    one = sampler(Rates.generated(compiled), Points.of(compiled))
    yield _judged(f"{name} | one point a call", ours.sample, one, count, gain)
    if not settings.quick:
        yield _threads(name, compiled)


def _judged(what: str, ours: Sample, theirs: Sample, count: int, gain: float) -> Row:
    pairs = settled(lambda: paired(ours, theirs, count), lambda p: p.ratio, 1 / gain)
    return _row(what, pairs, f">= {gain:g}", pairs.ratio <= 1 / gain)


def _row(what: str, pairs: Pairs, target: str = "", met: bool | None = None) -> Row:
    mine, other = (f"{1e-6 / s:.0f} million" for s in pairs.typical)
    return Row(what, mine, other, f"{1 / pairs.ratio:.2f}", target, met)


def _threads(name: str, compiled: Compiled) -> Row:
    """Two threads beside one, called from Python: larger arrays than the caches hold."""
    points = Points.of(compiled)
    x = np.random.default_rng(SEED).uniform(-1.0, 1.0, (points.x.shape[1], MANY_POINTS))
    out = np.empty_like(x)

    def seconds(threads: int) -> Sample:
        batch = compiled.batch(threads=threads)
        timer = Timer(lambda: batch(0.0, x, points.p, points.u, out=out))
        return lambda: timer.timeit(3) / 3 / MANY_POINTS

    pairs = paired(seconds(2), seconds(1), 30)
    return _row(f"{name}, {MANY_POINTS} points: 2 threads | 1 thread", pairs)
