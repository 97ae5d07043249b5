"""Hostile systems: no method may be far off and not say so.

A method with the tolerance rtol promises local errors of about rtol in each state, relative to its
size. What the problem makes of such errors is its growth, stored with the reference
(`benchmarks.hostile_references` says how both were made, without this package). An error of more than
`LEVEL` times rtol times growth is a wrong result: it must come with a negative status or with a
notice of the run. What a method refuses, and what takes too long, is no wrong result.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.compiled import compile as compile_system
from codegen.measure.stress.hostile_cases import FAMILIES, Hostile, cases
from codegen.measure.stress.record import Figure, Findings, Material, Plan
from codegen.measure.stress.workers import Collector, Run
from codegen.native.trajectory import Array
from codegen.runs.result import Result

STORE = Path(__file__).with_name("hostile_references.json")
LEVEL = 1e3
RTOLS = (1e-6, 1e-9, 1e-12)
LONGER = 10
"""Runs are given so many times the limit of the plan."""
MAX_STEPS = 2_000_000


@dataclass(frozen=True)
class Known:
    """A reference: ``states`` (K, n) at ``times`` (K,), ``sizes`` (n,) of the states, ``growth`` (K,)."""

    times: Array
    states: Array
    sizes: Array
    growth: Array

    def share(self, states: Array, rtol: float) -> float:
        """Return the largest error of ``states`` (n, K) over what is allowed; NaN counts as infinite."""
        error = np.max(np.abs(states.T - self.states) / self.sizes, axis=1)
        share = float(np.max(error / (LEVEL * rtol * self.growth)))
        return math.inf if math.isnan(share) else share

    def error(self, states: Array) -> float:
        """Return the largest error relative to the sizes."""
        return float(np.max(np.abs(states.T - self.states) / self.sizes))


def digest(case: Hostile) -> str:
    """Return what changes when the problem is another one, so that its reference is made anew."""
    parts = list(case.rates.items()), tuple(map(float, case.start)), tuple(map(float, case.span))
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]


@cache
def references() -> Mapping[str, Known]:
    """Return the references that are stored, by the key of the case, of cases that are unchanged."""
    stored = json.loads(STORE.read_text(encoding="ascii"))
    rows = {c.key: stored[c.key] for c in cases() if c.key in stored}
    return {
        c.key: Known(*(np.array(rows[c.key][k]) for k in ("times", "states", "sizes", "growth")))
        for c in cases()
        if c.key in rows and rows[c.key]["digest"] == digest(c)
    }


def sample(apart: int) -> list[Hostile]:
    """Return every so-many-th case of each family, the first among them."""
    return [case for family in FAMILIES for case in cases(family)[::apart]]


def hostile(_: Material, plan: Plan) -> Findings:
    """Run methods on hostile systems; return each wrong result, and what is nearest to one otherwise."""
    found = Collector()
    chosen = sample(plan.size.apart)
    near: dict[tuple[str, str], Figure] = {}
    for k, case in enumerate(chosen):
        known = references().get(case.key)
        if known is None:
            found.refused.setdefault(("reference", "two solutions agree on none"), []).append(
                case.key
            )
            continue
        found.late.clear()
        compiled = compile_system(case.system)
        for method in plan.methods:
            _keep(near, found, _tried(case, compiled, known, method, plan, found), method)
        plan.progress((k + 1) / len(chosen))
    found.figures += near.values()
    return found.findings()


def _keep(
    near: dict[tuple[str, str], Figure], found: Collector, tried: Sequence[Figure], method: str
) -> None:
    """Keep every figure that fails, and of the others the largest of a family and method."""
    for figure in tried:
        key = figure.what.partition(":")[0], method
        if not figure.passed:
            found.figures.append(figure)
        elif key not in near or figure.value > near[key].value:
            near[key] = figure


def _tried(
    case: Hostile, compiled: Compiled, known: Known, method: str, plan: Plan, found: Collector
) -> list[Figure]:
    """Return a figure a tolerance: the error over what is allowed, where nothing was said of it."""
    figures = []
    for rtol in RTOLS:
        times = np.array([case.span[0], *known.times])
        limit = LONGER * plan.size.limit
        run = Run(compiled, np.array(case.start), times, limit=limit, max_steps=MAX_STEPS)
        result = found.result(run, method, rtol, case.key)
        if result is not None and trusted(result, compiled):
            figures.append(_judged(case, known, result, method, rtol))
    return figures


def trusted(result: Result, compiled: Compiled) -> bool:
    """Return whether nothing warns of a result: it was reached, and the run has no notice of its own."""
    return result.status >= 0 and result.notice in {"", compiled.notice}


def _judged(case: Hostile, known: Known, result: Result, method: str, rtol: float) -> Figure:
    states = result.y[:, 1:]
    what = f"{case.key}: {method} at {rtol:.0e}"
    if states.shape[1] != len(known.times):
        return Figure(what, math.inf, 1.0, f"{states.shape[1]} of {len(known.times)} times stored")
    error, growth = known.error(states), float(np.max(known.growth))
    note = f"error {error:.1e}, growth {growth:.1e}, {result.steps} steps, {result.method}"
    return Figure(what, known.share(states, rtol), 1.0, note)
