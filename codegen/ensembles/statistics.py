"""Statistics that merge: count, mean, variance, extremes, histograms and quantiles of many values.

Means and sums of squares are merged pairwise (Chan, Golub and LeVeque, Algorithms for computing the
sample variance, Am. Stat. 37 (1983) 242), along one fixed binary tree over blocks of `BLOCK`
trajectories: results are the same to the last bit however the trajectories were divided, and in
whatever order the parts arrive. Histograms are counts, which merge exactly. Quantiles come from a
histogram whose bins are the first bits of the numbers themselves, 512 to each power of two.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from codegen.native.trajectory import Array
from eom.errors import InputError, typed_fields

BLOCK = 256
"""Trajectories of a leaf of the tree; parts of ensembles begin at whole multiples of it."""
KEPT_BITS = 20
"""Exponent and the first 9 bits of the fraction: bins are 0.2 % wide, quantiles right to 0.1 %."""
Counts = NDArray[np.int64]


@dataclass(frozen=True)
class Moments:
    """Of each row: how many values, their mean, sum of squared differences from it, and extremes."""

    count: Counts
    mean: Array
    squares: Array
    low: Array
    high: Array


def of_blocks(values: Array) -> list[Moments]:
    """Return the moments of each block of columns of ``values`` (rows, N).

    What is not finite does not count. Sums that overflow make a mean or a variance that is not finite.
    """
    rows, columns = values.shape
    blocks = -(-columns // BLOCK)
    padded = np.full((rows, blocks * BLOCK), np.nan)
    padded[:, :columns] = values
    cells = padded.reshape(rows, blocks, BLOCK)
    there = np.isfinite(cells)
    count = there.sum(axis=2)
    divisor = np.maximum(count, 1)
    with np.errstate(over="ignore", invalid="ignore"):
        mean = _total(np.where(there, cells, 0.0)) / divisor
        rest = np.where(there, cells - mean[:, :, None], 0.0)
        squares = _total(rest * rest) - _total(rest) ** 2 / divisor
    low = np.where(there, cells, np.inf).min(axis=2)
    high = np.where(there, cells, -np.inf).max(axis=2)
    columns_of = (count, mean, np.maximum(squares, 0.0), low, high)
    return [Moments(*(a[:, k] for a in columns_of)) for k in range(blocks)]


def _total(cells: Array) -> Array:
    """Add up the last axis by halves, in an order that no library decides."""
    while cells.shape[-1] > 1:
        half = cells.shape[-1] // 2
        cells = cells[..., :half] + cells[..., half:]
    return cells[..., 0]


def merge(a: Moments, b: Moments) -> Moments:
    """Return the moments of both."""
    count = a.count + b.count
    divisor = np.maximum(count, 1)
    share = b.count / divisor
    with np.errstate(over="ignore", invalid="ignore"):
        delta = np.where((a.count > 0) & (b.count > 0), b.mean - a.mean, 0.0)
        return Moments(
            count,
            np.where(a.count == 0, b.mean, a.mean + delta * share),
            a.squares + b.squares + delta * delta * a.count * share,
            np.minimum(a.low, b.low),
            np.maximum(a.high, b.high),
        )


@dataclass
class Tree:
    """Moments of whole subtrees by (level, number); parts may be added in any order."""

    nodes: dict[tuple[int, int], Moments] = field(default_factory=dict)

    def add(self, level: int, number: int, value: Moments) -> None:
        """Add a subtree, and join it with its neighbours as far as they are there."""
        while (level, number ^ 1) in self.nodes:
            other = self.nodes.pop((level, number ^ 1))
            value = merge(other, value) if number % 2 else merge(value, other)
            level, number = level + 1, number // 2
        self.nodes[level, number] = value

    def total(self) -> Moments:
        """Return the moments of all that was added."""
        order = sorted(self.nodes, key=lambda n: n[1] << n[0])
        found = self.nodes[order[-1]]
        for key in order[-2::-1]:
            found = merge(self.nodes[key], found)
        return found


@dataclass(frozen=True)
class Bins:
    """Counts of values by whole numbers: ``keys`` ascending."""

    keys: Counts
    counts: Counts

    @classmethod
    def joined(cls, parts: Sequence[Bins]) -> Bins:
        """Return all together."""
        keys, place = np.unique(np.concatenate([p.keys for p in parts]), return_inverse=True)
        counts = np.zeros(len(keys), dtype=np.int64)
        np.add.at(counts, place, np.concatenate([p.counts for p in parts]))
        return cls(keys, counts)


_OFFSET = 1 << KEPT_BITS
_SHIFT = 63 - KEPT_BITS


def bins_of(values: Array) -> Bins:
    """Return the bins of ``values`` (rows, N), that of row r at keys from 2 r 2^20 on."""
    rows = np.broadcast_to(np.arange(len(values))[:, None], values.shape)
    there = np.isfinite(values)
    size = np.abs(values[there]).view(np.int64) >> _SHIFT
    place = np.where(np.signbit(values[there]), -size - 1, size) + _OFFSET
    keys, counts = np.unique(rows[there] * (2 * _OFFSET) + place, return_counts=True)
    return Bins(keys, counts.astype(np.int64))


def _middles(places: Counts) -> Array:
    """Return the middle of each bin of one row."""
    signed = places - _OFFSET
    size = np.where(signed < 0, -signed - 1, signed)
    found = ((size << _SHIFT) + (1 << (_SHIFT - 1))).view(np.float64)
    return np.where(size == 0, 0.0, np.where(signed < 0, -found, found))


def quantile(bins: Bins, row: int, share: float, moments: Moments) -> float:
    """Return the value below which a share of a row lies, to 0.1 % of itself."""
    first, last = np.searchsorted(bins.keys, [row * 2 * _OFFSET, (row + 1) * 2 * _OFFSET])
    if first == last:
        return float("nan")
    if share <= 0.0 or share >= 1.0:
        return float((moments.low if share <= 0.0 else moments.high)[row])
    running = np.cumsum(bins.counts[first:last])
    at = int(np.searchsorted(running, share * running[-1]))
    middle = _middles(bins.keys[first:last] - row * 2 * _OFFSET)[at]
    return float(np.clip(middle, moments.low[row], moments.high[row]))


@typed_fields
@dataclass(frozen=True)
class Statistics:
    """What to count of states and outputs ``names`` at each stored time.

    Parameters
    ----------
    names : tuple of str
        Of states and outputs.
    quantiles : bool, default False
        Whether what they need is kept.
    edges : mapping of str to sequence of floats, optional
        By name the ascending edges of a histogram, in the unit of the quantity.

    Raises
    ------
    InputError
        For edges that do not ascend, or of other names.
    """

    names: tuple[str, ...]
    quantiles: bool = False
    edges: Mapping[str, Sequence[float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuse edges that are not in order, or of other names."""
        for name, edges in self.edges.items():
            if name not in self.names:
                raise InputError(
                    f"edges of {name!r}, of which nothing is counted", expected=self.names
                )
            if len(edges) < 2 or not bool(np.all(np.diff(edges) > 0)):
                raise InputError(f"edges of {name} are not ascending", got=edges)


@dataclass(frozen=True)
class Summary:
    """Statistics of one quantity at the times ``t`` (K,), all arrays (K,): of trajectories that got there.

    Parameters
    ----------
    name : str
        Of the quantity.
    t : array
        Times, (K,).
    count : array of int
        Of trajectories that got there, (K,).
    mean : array
        (K,).
    variance : array
        (K,); it divides by count - 1.
    minimum : array
        (K,).
    maximum : array
        (K,).
    edges : array, optional
        (bins + 1,).
    histogram : array of int, optional
        (K, bins); the last bin has both its edges, values outside are in none.
    rows, moments, bins : tuple of int, int, optional
        What quantiles are computed from.

    Notes
    -----
    In the unit of the quantity.

    References
    ----------
    Chan, Golub and LeVeque, Am. Stat. 37 (1983) 242.
    """

    name: str
    t: Array
    count: Counts
    mean: Array
    variance: Array
    minimum: Array
    maximum: Array
    edges: Array | None = None
    histogram: Counts | None = None
    rows: tuple[int, int] = field(default=(0, 0), repr=False)
    moments: Moments | None = field(default=None, repr=False)
    bins: Bins | None = field(default=None, repr=False)

    @property
    def deviation(self) -> Array:
        """The standard deviation, (K,)."""
        return np.sqrt(self.variance)

    def quantile(self, share: ArrayLike) -> Array:
        """Return the values below which a share of the trajectories lies.

        Parameters
        ----------
        share : array
            A number or several, in [0, 1].

        Returns
        -------
        array
            (K,) or (K, shares), right to 0.1 %.

        Raises
        ------
        InputError
            Where quantiles were not asked for, and for shares outside [0, 1].
        """
        if self.bins is None or self.moments is None:
            raise InputError(
                f"no quantiles of {self.name} were kept", hint="Statistics(names, quantiles=True)"
            )
        shares = np.asarray(share, dtype=np.float64)
        if not bool(np.all((shares >= 0) & (shares <= 1))):
            raise InputError("shares are not between 0 and 1", got=share)
        found = [[quantile(self.bins, r, float(s), self.moments) for s in shares.reshape(-1)]
                 for r in range(*self.rows)]  # fmt: skip
        return np.array(found).reshape(-1, *shares.shape)


def summary(
    name: str,
    t: Array,
    moments: Moments,
    rows: tuple[int, int],
    bins: Bins | None = None,
    edges: Array | None = None,
    histogram: Counts | None = None,
) -> Summary:
    """Return the statistics of some rows, one a time."""
    some = slice(*rows)
    count = moments.count[some]
    variance = np.where(count > 1, moments.squares[some] / np.maximum(count - 1, 1), np.nan)
    columns = (moments.mean, moments.low, moments.high)
    mean, low, high = (np.where(count == 0, np.nan, a[some]) for a in columns)
    return Summary(name, t, count, mean, variance, low, high, edges, histogram, rows, moments, bins)
