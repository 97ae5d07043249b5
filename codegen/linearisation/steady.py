"""A steady state as it is told, and which states may run together in a steady motion."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Equilibrium:
    """A state with zero rates, or a steady motion.

    ``states``, ``inputs``, ``parameters``: values by name. ``residual``: the largest rate that should be
    zero, in its unit, that of the state ``worst``; ``relative``: the same by the terms that it is made of.
    ``unknowns``, ``rank``: of the equations. ``kind``: ``isolated`` if the rank is full; ``family`` if
    other solutions lie beside it, along ``directions`` (by name, one mapping a dimension); else
    ``degenerate``: it stands alone as far as was seen, but few of its digits are certain.
    ``rates``: of the cyclic states, which may run, by name.
    Units are those of the system.
    """

    states: Mapping[str, float]
    inputs: Mapping[str, float]
    parameters: Mapping[str, float]
    residual: float
    relative: float
    worst: str
    unknowns: int
    rank: int
    kind: str
    directions: tuple[Mapping[str, float], ...] = ()
    rates: Mapping[str, float] | None = None

    @property
    def isolated(self) -> bool:
        """Whether no other solution is near."""
        return self.kind == "isolated"

    @property
    def cyclic(self) -> tuple[str, ...]:
        """The states that may run."""
        return tuple(self.rates or ())


def together(reads: Collection[tuple[int, int]], own: set[int]) -> Iterator[tuple[int, ...]]:
    """Yield states that may run together, few first: no rate of another state depends on them.

    ``reads``: (row, state) wherever a rate depends on a state; ``own``: those that are looked for. Not all
    of these are yielded at once.
    """
    sets = [c for c in (_closure(k, reads) for k in sorted(own)) if c <= own]
    for most in sorted({len(c) for c in sets}):
        running = set[int]().union(*(c for c in sets if len(c) <= most))
        if len(running) < len(own):
            yield tuple(sorted(running))


def _closure(state: int, reads: Collection[tuple[int, int]]) -> set[int]:
    """Return a state and those whose rates it has to do with, directly or by others."""
    found, stack = set[int](), [state]
    while stack:
        k = stack.pop()
        if k not in found:
            found.add(k)
            stack += [row for row, slot in reads if slot == k]
    return found
