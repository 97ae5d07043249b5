"""The equations of steady states: rates that vanish, values that are held, quaternions of length 1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import Compiled
from codegen.frontend.layout import names_of
from codegen.ir.groups import INVARIANTS, OUTPUTS, RATES
from codegen.ir.interpret import UNIT_ROUNDOFF, Point, interpret_with_bound
from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import Program
from codegen.linearisation.tangents import tangents

Array = NDArray[np.float64]


class Equations:
    """What should be zero, over all states and inputs, with derivatives.

    ``rows``: the states whose rates vanish. ``conditions``: values of outputs and invariants.
    ``units``: places of quaternions among the states.
    """

    def __init__(
        self,
        compiled: Compiled,
        p: Array,
        rows: Sequence[int],
        conditions: Mapping[str, float],
        units: Sequence[Sequence[int]],
    ) -> None:
        self.compiled, self.p, self.rows, self.units = compiled, p, list(rows), units
        states = names_of(compiled.layout.states)
        groups = {g: compiled.layout.results[g] for g in (OUTPUTS, INVARIANTS)}
        self.held = [
            (g, [n for n in names if n in conditions], [names.index(n) for n in names if n in conditions])
            for g, names in groups.items()
        ]  # fmt: skip
        self.held = [h for h in self.held if h[1]]
        self.targets = [np.array([conditions[n] for n in names]) for _, names, _ in self.held]
        self.labels = [
            *(states[k] for k in self.rows),
            *(n for _, names, _ in self.held for n in names),
            *(f"norm of {', '.join(states[k] for k in four)}" for four in units),
        ]

    def value(self, x: Array, u: Array) -> Array:
        """Return what should be zero."""
        parts = [self.compiled.rhs(0.0, x, self.p, u)[self.rows]]
        for (group, _, places), target in zip(self.held, self.targets, strict=True):
            parts.append(self.compiled.functions[group](0.0, x, self.p, u)[places] - target)
        parts.append(np.array([(x[list(four)] ** 2).sum() - 1 for four in self.units]))
        return np.concatenate(parts)

    def rates(self, x: Array, u: Array) -> Array:
        """Return the derivatives of all rates by states, then inputs."""
        point = Point(0.0, list(x), list(self.p), list(u))
        found: Array = tangents(self.compiled.program, [RATES], leaves_of(x.size, u.size), point)[1]
        return found

    def rounding(self, x: Array, u: Array) -> Array:
        """Return how much rounding may make of each equation, by a running error analysis.

        States and inputs are taken to be rounded, but for zeros. See `codegen.ir.interpret`.
        """
        point = Point(0.0, list(x), list(self.p), list(u))
        found = interpret_with_bound(self._program, point)
        own = [found[RATES][k].error for k in self.rows]
        own += [found[group][k].error for group, _, places in self.held for k in places]
        own += [4 * UNIT_ROUNDOFF] * len(self.units)
        given = np.abs(self(x, u)[1]) @ np.abs(np.concatenate([x, u]))
        return np.asarray(np.array(own) + UNIT_ROUNDOFF * given)

    @cached_property
    def _program(self) -> Program:
        return prune(self.compiled.program, [RATES, *(group for group, _, _ in self.held)])

    def __call__(self, x: Array, u: Array) -> tuple[Array, Array]:
        """Return what should be zero, and its derivatives by states, then inputs."""
        leaves = leaves_of(x.size, u.size)
        groups = [RATES, *(group for group, _, _ in self.held)]
        found, J = tangents(
            self.compiled.program, groups, leaves, Point(0.0, list(x), list(self.p), list(u))
        )
        rows, start = list(self.rows), x.size
        for group, _, places in self.held:
            rows += [start + k for k in places]
            start += len(self.compiled.program.results[group])
        norms = np.zeros((len(self.units), x.size + u.size))
        for k, four in enumerate(self.units):
            norms[k, list(four)] = 2 * x[list(four)]
        targets = [np.zeros(len(self.rows)), *self.targets]
        lengths = [(x[list(four)] ** 2).sum() - 1 for four in self.units]
        return np.append(found[rows] - np.concatenate(targets), lengths), np.vstack(
            [J[rows], norms]
        )


def maintained(compiled: Compiled) -> tuple[str, ...]:
    """Return the invariants that constraints keep at zero."""
    known = compiled.layout.results[INVARIANTS]
    return tuple(n for n in compiled.system.maintained if n in known)


def leaves_of(states: int, inputs: int) -> list[Instruction]:
    """Return the leaves of all states, then all inputs."""
    return [
        Instruction(kind, (), k)
        for kind, n in (("state", states), ("input", inputs))
        for k in range(n)
    ]
