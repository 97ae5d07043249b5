"""Generated right-hand sides beside hand-written C of the same equations, timed inside C."""

from __future__ import annotations

import numpy as np

from benchmarks import instructions
from benchmarks.native_rates import HANDWRITTEN, Points, Rates, sampler
from benchmarks.pairs import Pairs, joined, paired, settled
from benchmarks.settings import Settings
from benchmarks.table import Row, Section, time_text
from codegen import compile as compile_system
from eom.scenes.scene import Scene

LARGEST_RATIO = 1.1
QUICK_RATIO = 1.25
"""Of the short form, any processor's bound, where instructions cannot be counted. Where they can,
`benchmarks.counts` is the guard and the time is shown alone: where a loop begins in memory changes
the time of 22 instructions by a quarter."""
LARGEST_DIFFERENCE = 1e-12
COPIES = 5


def measure(settings: Settings) -> Section:
    """Return one row a ready scene that is written by hand, too."""
    rows = tuple(_row(name, settings) for name in HANDWRITTEN)
    return Section("in C: generated | hand-written", rows)


def _row(name: str, settings: Settings) -> Row:
    compiled = compile_system(Scene.ready(name).derive(), "c")
    ours, theirs = Rates.generated(compiled), Rates.handwritten(name)
    points = Points.of(compiled)
    difference = largest_difference(ours, theirs, points)
    if not difference <= LARGEST_DIFFERENCE:
        return Row(name, f"differs by {difference:.1e}", target="the same numbers", met=False)
    count, limit = (60, QUICK_RATIO) if settings.quick else (600, LARGEST_RATIO)
    pairs = settled(lambda: _timed(ours, theirs, points, count), lambda p: p.ratio, limit)
    mine, other = (time_text(s) for s in pairs.typical)
    if settings.instructions:
        mine += f", {instructions.text(ours)}"
        other += f", {instructions.text(theirs)}"
    row = name, mine, other, f"{pairs.ratio:.3f}"
    if settings.quick and instructions.available():
        return Row(*row, "see the counts")
    return Row(*row, f"<= {limit}", pairs.ratio <= limit)


def _timed(ours: Rates, theirs: Rates, points: Points, count: int) -> Pairs:
    """Return pairs over several copies of both functions, all of equal weight."""
    copies = zip(ours.copies(COPIES), theirs.copies(COPIES), strict=True)
    return joined(paired(sampler(a, points), sampler(b, points), count) for a, b in copies)


def largest_difference(ours: Rates, theirs: Rates, points: Points) -> float:
    """Return the largest difference of a component, relative to its largest value."""
    a, b = (np.array([f(x, points.p, points.u) for x in points.x]) for f in (ours, theirs))
    scale = np.maximum(np.abs(b).max(axis=0), np.finfo(np.float64).tiny)
    return float((np.abs(a - b).max(axis=0) / scale).max())
