"""Projection in Python, for methods whose loop is SciPy's, and what generated loops need from Python.

The rules are those of `codegen.loops.projection` and of `projection.c`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.ir.program import INVARIANTS
from codegen.loops.projection import units
from codegen.native.trajectory import Array, Problem

EPSILON = float(np.finfo(np.float64).eps)
SHARE, LEAST_TOLERANCE, TURNS, FARTHEST = 16, 1024 * EPSILON, 4, 0.25
"""What `projection.c` has, too. Changes of more than the last, of scaled states, are not made."""


def with_values(compiled: Compiled, problem: Problem) -> Problem:
    """Return the problem with the further parameters of `projection.extended`, from its start."""
    kept = _kept(compiled, problem, problem.inputs)
    return replace(problem, parameters=np.append(problem.parameters, kept))


def _kept(compiled: Compiled, problem: Problem, u: Array) -> Array:
    values = compiled.invariants(problem.t_span[0], problem.x0, problem.parameters, u)
    return values[_places(compiled, problem)]


def _places(compiled: Compiled, problem: Problem) -> list[int]:
    return [compiled.layout.results[INVARIANTS].index(name) for name in problem.project]


class Projector:
    """Projection over the compiled functions, as `projection.c` does it."""

    def __init__(
        self, compiled: Compiled, problem: Problem, inputs: Callable[[float], Array] | None = None
    ) -> None:
        self.problem, self.inputs = problem, inputs
        self.places = _places(compiled, problem)
        self.jacobian = compiled.jacobian("states", INVARIANTS)
        self.kept = _kept(compiled, problem, self._u(problem.t_span[0]))
        self.units = np.array(units(compiled.layout))
        self.allowed = max(problem.rtol, LEAST_TOLERANCE) / SHARE

    def _u(self, t: float) -> Array:
        return self.problem.inputs if self.inputs is None else self.inputs(t)

    def __call__(self, t: float, x: Array) -> Array:
        """Return the state ``x``, of shape (n,), on the invariants: itself if it is there."""
        u = self._u(t)
        for _ in range(TURNS):
            scale = self._scale(x)
            whole, entries = self.jacobian.with_value(t, x, self.problem.parameters, u)
            value = whole[self.places]
            slopes = np.zeros(self.jacobian.shape)
            slopes[list(self.jacobian.rows), list(self.jacobian.columns)] = entries
            slopes = slopes[self.places]
            noise = 2 * EPSILON * (np.abs(value) + np.abs(slopes * x).sum(axis=1))
            change = least_change(slopes * scale, self.kept - value, noise, self.allowed)
            if change is None:
                return x
            x = x + scale * change
        return x

    def _scale(self, x: Array) -> Array:
        sizes = np.maximum(np.abs(x), self.problem.atol / self.problem.rtol)
        largest = np.zeros(self.units.max() + 1)
        np.maximum.at(largest, self.units, sizes)
        return np.asarray(largest[self.units])

    def points(self, t: Array, y: Array) -> Array:
        """Return the states ``y`` of shape (n, N) at times ``t``, each on the invariants."""
        found = [self(float(at), x) for at, x in zip(t, y.T, strict=True)]
        return np.array(found).T.reshape(y.shape)


def least_change(a: Array, left: Array, noise: Array, allowed: float) -> Array | None:
    """Return the least vector z with ``a`` z = ``left`` in the rows that count; None for none.

    ``a``: one gradient a row. ``noise``: what rounding does to each invariant. A row counts while
    noise, with its part of that of the rows before, over what is left of the row is less than
    ``allowed``; it moves where ``left`` is more than ``noise``.
    """
    if not np.any(np.abs(left) > noise):
        return None
    a, left, spread = a.copy(), left.copy(), noise.copy()
    with np.errstate(all="ignore"):
        whole = np.linalg.norm(a, axis=1)
        change, moved = np.zeros(a.shape[1]), False
        free = np.ones(len(a), dtype=bool)
        while True:
            rest = np.linalg.norm(a, axis=1)
            counts = free & (rest * allowed > spread)
            if not counts.any():
                break
            best = int(np.argmax(np.where(counts, rest / whole, -1.0)))
            free[best], square = False, rest[best] ** 2
            step = left[best] / square if abs(left[best]) > noise[best] else 0.0
            moved |= step != 0.0
            change += step * a[best]
            part = np.where(free, a @ a[best] / square, 0.0)
            left -= step * part * square
            spread += np.abs(part) * spread[best]
            a -= part[:, None] * a[best]
    small = bool(np.linalg.norm(change) < FARTHEST)
    return change if moved and small else None
