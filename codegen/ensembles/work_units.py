"""One chunk of an ensemble: draw, integrate, evaluate, count. The same wherever it is done.

A chunk is a pure function of the plan and its number, so that it can be done anywhere, again after a
failure, and by several workers without harm.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled, batch
from codegen.ensembles.sampler import Population, check
from codegen.ensembles.statistics import (
    BLOCK,
    Bins,
    Counts,
    Moments,
    Statistics,
    Tree,
    bins_of,
    of_blocks,
)
from codegen.frontend.layout import names_of
from codegen.integrate import fleet, scales
from codegen.integrate.fleet import Runs, Shared
from codegen.ir.program import INVARIANTS, OUTPUTS, RATES, SameObject
from codegen.native import children
from codegen.native.trajectory import Array
from codegen.precision.conditioning import GENEROUS, Sizes, measured
from codegen.runs.clock import Clock, clock_of, span_since

Columns = Mapping[str, NDArray[Any]]

MOST_LISTED = 10_000
"""Trajectories that did not reach the end are listed up to this number, and always counted."""


@dataclass(frozen=True)
class Plan:
    """What every chunk needs: ``columns`` says whether the trajectories themselves are wanted."""

    compiled: Compiled
    method: str
    shared: Shared
    statistics: Statistics
    chunk: int
    columns: bool


@dataclass(frozen=True)
class Tallies:
    """What is counted over trajectories: nodes of trees, bins, histograms, reasons of stopping."""

    nodes: Mapping[str, Mapping[tuple[int, int], Moments]]
    bins: Bins | None
    histograms: Mapping[str, Counts]
    reasons: Mapping[int, int]
    continued: Mapping[int, int]
    """How many another method went on with, by what `codegen.integrate.fleet` says of that."""
    stopped: NDArray[np.int64]
    """Rows (number, status) of trajectories that did not reach the end."""
    steps: int
    count: int


@dataclass(frozen=True)
class Piece:
    """What is known of one chunk; ``columns`` have the trajectories as their last axis."""

    number: int
    first: int
    columns: Columns
    tallies: Tallies
    computed: bool = True
    """False where it was read from a store."""


DRIFT, VALUES = "drift", "values"


@lru_cache(maxsize=16)
def built(key: SameObject[Compiled], method: str, rtol: float) -> fleet.Built:
    """Return what integrates; compiled once a process."""
    return fleet.build_onward(key.value, method, rtol)


def run(plan: Plan, some: Population, number: int) -> Piece:
    """Integrate the chunk ``number``; ``some`` holds at least its trajectories.

    Raises `InputError` for samples that are not finite or contradict the system's assumptions, and `Halt`
    where the thread is asked to end on the way.
    """
    first = number * plan.chunk
    last = min(first + plan.chunk, some.count)
    x, p = some.draw(first, last)
    check(plan.compiled, x, p, plan.shared.inputs, first, plan.shared.t_span[0])
    plan = _held(plan, x, p)
    clock = clock_of_plan(plan)
    moved, p = (plan, p) if clock is None else _since_start(plan, clock, p)
    runs = integrator(plan).run(moved.shared, x, p)
    columns: Columns = {
        "y": np.ascontiguousarray(runs.y.transpose(1, 0, 2)),
        "outputs": _outputs(moved, runs, p),
        "y_stop": runs.y_stop,
        "t_stop": runs.t_stop if clock is None else _stop_times(runs, clock),
        "drift": _drift(moved, runs, x, p),
        "status": runs.status,
        "which": runs.which,
        "steps": runs.steps,
        "rejected": runs.rejected,
        "continued": runs.continued,
    }
    tallies = counted(plan, columns, first)
    return Piece(number, first, columns if plan.columns else {}, tallies)


def _held(plan: Plan, x: Array, p: Array) -> Plan:
    """Return a plan with the absolute tolerances of each trajectory, where they were not given."""
    shared = plan.shared
    if shared.atol is not None:
        return plan
    function = batch(plan.compiled, RATES, 1)

    def rates(t: Array, states: Array) -> Array:
        return function(t, states, p, shared.inputs)

    start = scales.Point(x, p, shared.inputs, 0.0)
    found, _ = scales.defaults(rates, plan.compiled.layout, start, shared.t_span, shared.rtol)
    return replace(plan, shared=replace(shared, atol=found))


def clock_of_plan(plan: Plan) -> Clock | None:
    """Return how the runs of a plan keep time, or None over the time of the system."""
    return clock_of(plan.compiled, plan.shared.t_span, 0.0, ())


def integrator(plan: Plan) -> fleet.Built:
    """Return what integrates a plan: a system over the time since its start where that is late."""
    clock = clock_of_plan(plan)
    compiled = plan.compiled if clock is None else clock.relative.compiled
    return built(SameObject(compiled), plan.method, plan.shared.rtol)


def _since_start(plan: Plan, clock: Clock, p: Array) -> tuple[Plan, Array]:
    """Return a plan, and parameters, over the time since its start."""
    clock.doubt(p, plan.shared.rtol)
    shared = replace(
        plan.shared,
        t_span=span_since(plan.shared.t_span, clock.start),
        t_eval=plan.shared.t_eval - clock.start,
    )
    moved = replace(plan, compiled=clock.relative.compiled, shared=shared)
    return moved, clock.relative.completed(p, clock.zero)


def _stop_times(runs: Runs, clock: Clock) -> Array:
    """Return the times at which runs stopped as the user has them."""
    return np.where(runs.status == 0, clock.t_span[1], clock.start + runs.t_stop)


def counted(plan: Plan, columns: Columns, first: int) -> Tallies:
    """Return what is counted, from the columns of a chunk that begins at trajectory ``first``."""
    names = plan.statistics.names
    values = _values(plan, columns)
    flat = values.reshape(-1, values.shape[-1])
    nodes = {k: _nodes(v, first) for k, v in ((VALUES, flat), (DRIFT, columns["drift"])) if len(v)}
    histograms = {
        n: np.stack(
            [np.histogram(row[np.isfinite(row)], edges)[0] for row in values[names.index(n)]]
        )
        for n, edges in plan.statistics.edges.items()
    }
    status = columns["status"]
    bad = np.flatnonzero(status != 0)
    return Tallies(
        nodes,
        bins_of(flat) if plan.statistics.quantiles and len(flat) else None,
        histograms,
        Counter(status.tolist()),
        Counter(columns["continued"][columns["continued"] != 0].tolist()),
        np.stack([bad + first, status[bad]]).astype(np.int64)[:, :MOST_LISTED],
        int(columns["steps"].sum(dtype=np.int64)),
        len(status),
    )


def _nodes(values: Array, first: int) -> Mapping[tuple[int, int], Moments]:
    tree = Tree()
    for k, moments in enumerate(of_blocks(values), first // BLOCK):
        tree.add(0, k, moments)
    return tree.nodes


def _values(plan: Plan, columns: Columns) -> Array:
    """Return what statistics are about, (names, K, N)."""
    states = names_of(plan.compiled.layout.states)
    outputs = plan.compiled.layout.results[OUTPUTS]
    y = columns["y"]
    rows = [
        y[states.index(n)] if n in states else columns["outputs"][outputs.index(n)]
        for n in plan.statistics.names
    ]
    return np.stack(rows) if rows else np.empty((0, *y.shape[1:]))


def _outputs(plan: Plan, runs: Runs, p: Array) -> Array:
    """Return all outputs at the stored times, (outputs, K, N)."""
    count = len(plan.compiled.layout.results[OUTPUTS])
    times, _, trajectories = runs.y.shape
    found = np.empty((count, times, trajectories))
    if count:
        function = batch(plan.compiled, OUTPUTS, 1)
        for k, t in enumerate(plan.shared.t_eval):
            children.check()
            found[:, k] = function(t, runs.y[k], p, runs.inputs(plan.shared, k))
    return found


def _drift(plan: Plan, runs: Runs, x: Array, p: Array) -> Array:
    """Return the largest change of each constant of the motion, relative to the terms that it is made of.

    It is looked at where states are stored and where the trajectory stopped; see
    `codegen.precision.conditioning`.
    """
    if INVARIANTS not in plan.compiled.functions:
        return np.empty((0, x.shape[1]))
    constants, u = batch(plan.compiled, INVARIANTS, 1), plan.shared.inputs
    sizes, t0 = Sizes(plan.compiled), plan.shared.t_span[0]
    start = constants(t0, x, p, u)
    change, terms = np.zeros_like(start), sizes.terms(t0, x, p, u)
    for t, y in (*zip(plan.shared.t_eval, runs.y, strict=True), (runs.t_stop, runs.y_stop)):
        children.check()
        off = np.abs(constants(t, y, p, u) - start)
        change = np.fmax(change, off)
        terms = np.fmax(terms, sizes.terms(t, y, p, u) - GENEROUS * off)
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = measured(terms, sizes.reach(t0, x, p, u))
        relative: Array = change / np.where(scale > 0, scale, 1.0)
    return relative
