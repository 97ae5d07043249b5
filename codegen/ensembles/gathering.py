"""What an ensemble comes to: pieces put together as they arrive, in any order."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.ensembles.chunks import DRIFT, MOST_LISTED, VALUES, Piece, Plan
from codegen.ensembles.tallies import Bins, Counts, Summary, Tree, summary
from codegen.ir.groups import INVARIANTS
from eom.errors import InputError

BINS_TOGETHER = 64
"""Bins are joined when so many parts have come."""


@dataclass
class Gathered:
    """Columns of all trajectories, if they are wanted, and everything that is counted."""

    plan: Plan
    total: int
    columns: dict[str, NDArray[Any]] = field(default_factory=dict)
    trees: dict[str, Tree] = field(default_factory=dict)
    bins: list[Bins] = field(default_factory=list)
    histograms: dict[str, Counts] = field(default_factory=dict)
    reasons: Counter[int] = field(default_factory=Counter)
    continued: Counter[int] = field(default_factory=Counter)
    stopped: list[NDArray[np.int64]] = field(default_factory=list)
    steps: int = 0
    done: int = 0
    computed: int = 0

    def take(self, piece: Piece) -> None:
        """Add a piece."""
        for name, values in piece.columns.items():
            self._column(name, values)[..., piece.first : piece.first + values.shape[-1]] = values
        tallies = piece.tallies
        for name, nodes in tallies.nodes.items():
            tree = self.trees.setdefault(name, Tree())
            for (level, number), value in nodes.items():
                tree.add(level, number, value)
        for name, counts in tallies.histograms.items():
            self.histograms[name] = self.histograms.get(name, np.zeros_like(counts)) + counts
        if tallies.bins is not None:
            self.bins.append(tallies.bins)
            if len(self.bins) >= BINS_TOGETHER:
                self.bins = [Bins.joined(self.bins)]
        self._stop(tallies.stopped)
        self.reasons.update(tallies.reasons)
        self.continued.update(tallies.continued)
        self.steps += tallies.steps
        self.done += tallies.count
        self.computed += piece.computed

    def _column(self, name: str, values: NDArray[Any]) -> NDArray[Any]:
        if name not in self.columns:
            shape = (*values.shape[:-1], self.total)
            try:
                self.columns[name] = np.empty(shape, dtype=values.dtype)
            except MemoryError:
                raise InputError(
                    "the trajectories do not fit into memory",
                    got=f"{self.total:,} trajectories, {name} of shape {shape}",
                    hint="keep=False, with statistics or a store",
                ) from None
        return self.columns[name]

    def _stop(self, rows: NDArray[np.int64]) -> None:
        """Keep the first trajectories that did not reach the end."""
        if rows.shape[1]:
            joined = np.concatenate([*self.stopped, rows], axis=1)
            self.stopped = [joined[:, np.argsort(joined[0])[:MOST_LISTED]]]

    def statistics(self) -> dict[str, Summary]:
        """Return the statistics of states and outputs by name."""
        asked, times = self.plan.statistics, self.plan.shared.t_eval
        if VALUES not in self.trees:
            return {}
        moments = self.trees[VALUES].total()
        bins = Bins.joined(self.bins) if self.bins else None
        found = {}
        for k, name in enumerate(asked.names):
            rows = (k * len(times), (k + 1) * len(times))
            edges = np.array(asked.edges[name], dtype=float) if name in asked.edges else None
            counts = self.histograms.get(name)
            found[name] = summary(name, times, moments, rows, bins, edges, counts)
        return found

    def drift(self) -> Mapping[str, Summary]:
        """Return the statistics of the relative drift of each constant of the motion."""
        if DRIFT not in self.trees:
            return {}
        moments = self.trees[DRIFT].total()
        end = np.array(self.plan.shared.t_span[1:])
        names = self.plan.compiled.layout.results[INVARIANTS]
        return {n: summary(n, end, moments, (k, k + 1)) for k, n in enumerate(names)}
