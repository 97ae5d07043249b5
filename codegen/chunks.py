"""One chunk of an ensemble: draw, integrate, evaluate, count. The same wherever it is done.

A chunk is a pure function of the plan and its number, so that it can be done anywhere, again after a
failure, and by several workers without harm.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.batches import batch
from codegen.compiled import Compiled
from codegen.identity import SameObject
from codegen.integrate import fleet
from codegen.integrate.fleet import Runs, Shared
from codegen.integrate.trajectory import Array
from codegen.layout import names_of
from codegen.lower import INVARIANTS, OUTPUTS
from codegen.samples import Population, check
from codegen.tallies import BLOCK, Bins, Counts, Moments, Statistics, Tree, bins_of, of_blocks

Columns = Mapping[str, NDArray[Any]]

RELATIVE_FLOOR = 1e-8
"""A constant that starts below its change under so small a change of the states counts as zero."""
MOST_LISTED = 10_000
"""Trajectories that did not reach the end are listed up to this number, and always counted."""


@dataclass(frozen=True)
class Plan:
    """What every chunk needs: ``columns`` tells whether the trajectories themselves are wanted."""

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
    return fleet.build(key.value, method, rtol)


def run(plan: Plan, some: Population, number: int) -> Piece:
    """Integrate the chunk ``number``; ``some`` holds at least its trajectories.

    Raises `InputError` for samples that are not finite or contradict the system's assumptions.
    """
    first = number * plan.chunk
    last = min(first + plan.chunk, some.count)
    x, p = some.draw(first, last)
    check(plan.compiled, x, p, plan.shared.inputs, first)
    runs = built(SameObject(plan.compiled), plan.method, plan.shared.rtol).run(plan.shared, x, p)
    columns: Columns = {
        "y": np.ascontiguousarray(runs.y.transpose(1, 0, 2)),
        "outputs": _outputs(plan, runs, p),
        "y_stop": runs.y_stop,
        "t_stop": runs.t_stop,
        "drift": _drift(plan, runs, x, p),
        "status": runs.status,
        "which": runs.which,
        "steps": runs.steps,
        "rejected": runs.rejected,
    }
    tallies = counted(plan, columns, first)
    return Piece(number, first, columns if plan.columns else {}, tallies)


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
    reasons, counts = np.unique(status, return_counts=True)
    bad = np.flatnonzero(status != 0)
    return Tallies(
        nodes,
        bins_of(flat) if plan.statistics.quantiles and len(flat) else None,
        histograms,
        dict(zip(reasons.tolist(), counts.tolist(), strict=True)),
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
            found[:, k] = function(t, runs.y[k], p, plan.shared.inputs)
    return found


def _drift(plan: Plan, runs: Runs, x: Array, p: Array) -> Array:
    """Return the largest change of each constant of the motion, relative to its first value.

    It is looked at where states are stored and where the trajectory stopped. A first value that a
    change of every state by `RELATIVE_FLOOR` exceeds counts as zero; the change is then absolute.
    """
    if INVARIANTS not in plan.compiled.functions:
        return np.empty((0, x.shape[1]))
    constants, u = batch(plan.compiled, INVARIANTS, 1), plan.shared.inputs
    t0 = plan.shared.t_span[0]
    start = constants(t0, x, p, u)
    floor = np.zeros_like(start)
    for i in range(len(x)):
        moved = x.copy()
        moved[i] *= 1.0 + RELATIVE_FLOOR
        floor += np.abs(constants(t0, moved, p, u) - start)
    change = np.abs(constants(runs.t_stop, runs.y_stop, p, u) - start)
    for t, y in zip(plan.shared.t_eval, runs.y, strict=True):
        change = np.fmax(change, np.abs(constants(t, y, p, u) - start))
    with np.errstate(invalid="ignore"):
        relative: Array = change / np.where(np.abs(start) > floor, np.abs(start), 1.0)
    return relative
