"""Drift: how far constants of the motion wandered, relative to the terms that they are made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.signals import Inputs
from codegen.native.trajectory import Array, Problem, Trajectory
from codegen.precision import magnitude


@dataclass(frozen=True)
class Drift:
    """How far a constant of the motion wandered from its first value, over the stored points.

    ``start``: the first value; ``largest``: the largest change from it, both in the unit of the invariant.
    It is relative to the terms that the constant is made of, by `codegen.precision.magnitude`: a kinetic
    energy to itself, a closure of 4e-16 m, or an energy near zero, to what cancels in it.
    Source: Higham, Accuracy and Stability of Numerical Algorithms (2002), sect. 4.2.
    """

    start: float
    largest: float
    over_time: Array = field(compare=False, repr=False)
    """Value less first value at each stored point, (N,)."""
    terms: Callable[[], float] | None = field(default=None, compare=False, repr=False)
    """Finds the size of the terms, when it is asked for; without it that of the first value counts."""

    @cached_property
    def size(self) -> float:
        """The size of the terms, in the unit of the invariant; zero where all of them are."""
        return abs(self.start) if self.terms is None else self.terms()

    @property
    def scale(self) -> float:
        """What the change is compared with: the size of the terms, or 1 in the unit of the invariant."""
        return self.size if self.size > 0 else 1.0

    @property
    def kind(self) -> str:
        """Whether the drift is relative, to the size of the terms, or absolute, where that is zero."""
        return "relative" if self.size > 0 else "absolute"

    @property
    def relative(self) -> float:
        """The largest change over the scale."""
        return self.largest / self.scale

    def __getstate__(self) -> dict[str, Any]:
        """Pickle and copy the size in the place of what finds it."""
        return {**self.__dict__, "size": self.size, "terms": None}


def drift_of(values: Array, terms: Callable[[], float] | None) -> Drift:
    """Return the drift of a constant of the motion from its values at the stored points."""
    if not values.size:
        return Drift(0.0, 0.0, values)
    change = values - values[0]
    return Drift(float(values[0]), float(np.max(np.abs(change))), change, terms)


@dataclass(frozen=True)
class Terms:
    """What the constants of a run are compared with; found once, when it is first asked for."""

    compiled: Compiled
    problem: Problem
    trajectory: Trajectory
    values: Array
    signals: Inputs | None

    def scale(self, k: int) -> float:
        """Return that of one constant, by its number."""
        return float(self.scales[k])

    @cached_property
    def scales(self) -> Array:
        """One a constant of the motion, in its unit."""
        t, y = self.trajectory.t, self.trajectory.y
        chosen = np.unique(np.linspace(0, len(t) - 1, magnitude.POINTS).round().astype(int))
        u = self.problem.inputs
        if self.signals is not None:
            u = np.array([self.signals(at) for at in t[chosen]]).reshape(len(chosen), len(u)).T
        sizes, p = magnitude.Sizes(self.compiled), self.problem.parameters
        at = t[chosen], y[:, chosen], p, u
        with np.errstate(all="ignore"):
            terms, reach = sizes.terms(*at), sizes.reach(*at)
        return magnitude.scale_of(terms, self.values[:, chosen] - self.values[:, :1], reach)
