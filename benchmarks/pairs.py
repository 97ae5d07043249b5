"""Times side by side: the two are taken in turn, and the ratio is the median over neighbours.

Neighbours share the machine's mood (clock frequency, other jobs), so their ratio is steady where
their times are not. Where a target is missed, more pairs are taken; the verdict is over all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from statistics import median
from time import perf_counter

ATTEMPTS = 4

Sample = Callable[[], float]
"""Measure once; return seconds."""


@dataclass(frozen=True)
class Pairs:
    """Seconds of the first and of the second, in pairs that were taken one after the other."""

    first: tuple[float, ...]
    second: tuple[float, ...]

    @property
    def ratio(self) -> float:
        """The median of first over second."""
        return median(a / b for a, b in zip(self.first, self.second, strict=True))

    @property
    def typical(self) -> tuple[float, float]:
        """The medians."""
        return median(self.first), median(self.second)

    @property
    def best(self) -> tuple[float, float]:
        """The least times: what was measured with least disturbance."""
        return min(self.first), min(self.second)


def paired(first: Sample, second: Sample, count: int) -> Pairs:
    """Return ``count`` pairs; every other pair starts with the second.

    One more pair is taken first, to warm up, and dropped.
    """
    a: list[float] = []
    b: list[float] = []
    for k in range(count + 1):
        for sample, times in ((first, a), (second, b))[:: 1 if k % 2 else -1]:
            times.append(sample())
    return Pairs(tuple(a[1:]), tuple(b[1:]))


def joined(groups: Iterable[Pairs]) -> Pairs:
    """Return all pairs of several groups."""
    kept = list(groups)
    return Pairs(
        tuple(s for pairs in kept for s in pairs.first),
        tuple(s for pairs in kept for s in pairs.second),
    )


def settled(measure: Callable[[], Pairs], value: Callable[[Pairs], float], limit: float) -> Pairs:
    """Measure until ``value`` of all pairs together is at most ``limit``, `ATTEMPTS` times at most."""
    pairs = measure()
    for _ in range(ATTEMPTS - 1):
        if value(pairs) <= limit:
            break
        pairs = joined((pairs, measure()))
    return pairs


def seconds(action: Callable[[], object]) -> float:
    """Return the wall time of one call."""
    start = perf_counter()
    action()
    return perf_counter() - start
