"""Newton's method for equations that may be fewer or more than the unknowns.

Each step is the shortest one that solves the linear equations (Ben-Israel, J. Math. Anal. Appl. 15, 1966,
p. 243), no longer than a radius within which the linear equations held so far, and halved until the
equations get smaller: so a search goes to a solution near its start. Unknowns are in their scales
(`codegen.linearisation.equilibria`); rows are scaled by the size that their derivatives have around the
start.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TOLERANCE = 1e-11
"""Of a residual, relative to the terms that it is made of."""
NEAR = 1e-4
"""How far the next step goes at most from a solution, relative to its size."""
TURNS, HALVINGS = 80, 30
FARTHEST = 1e9
"""A search that gets so far beyond its start, relative to its size, is given up."""
RADIUS = 0.2
"""Longest first step, in the scales of the unknowns."""
HELD = 0.5
"""Part of what a step was to make equations smaller by, with which its radius is doubled."""
RANK = 1e-9
"""Singular values below this, relative to the largest, count as zero."""


@dataclass(frozen=True)
class Problem:
    """Equations: ``value(z)`` is zero at a solution; ``derived(z)``: that, and its derivatives.

    ``size``: of the derivatives of each equation, as they are around the start: at a solution all
    derivatives of one may vanish.
    """

    value: Callable[[Array], Array]
    derived: Callable[[Array], tuple[Array, Array]]
    size: Array


def solve(problem: Problem, z: Array) -> Array | None:
    """Return a solution from a start; None where none is found."""
    limit = FARTHEST * (1 + np.max(np.abs(z), initial=0.0))
    radius = RADIUS
    for _ in range(TURNS):
        f, J = problem.derived(z)
        if not (np.all(np.isfinite(f)) and np.all(np.isfinite(J))):
            return None
        forward = step(problem, f, J)
        near = np.max(np.abs(forward), initial=0.0) <= NEAR * (1 + np.max(np.abs(z), initial=0.0))
        if near and np.all(np.abs(f) <= TOLERANCE * scale(problem, z)):
            return _polished(problem, z, f, forward)
        moved, radius = _shortened(problem, z, f, forward, radius)
        if moved is None or np.max(np.abs(moved)) > limit:
            return None
        z = moved
    return None


def step(problem: Problem, f: Array, J: Array) -> Array:
    """Return the shortest step that solves the linear equations, or comes nearest to it."""
    size = problem.size
    return np.asarray(np.linalg.lstsq(J / size[:, None], -f / size, rcond=RANK)[0])


def scale(problem: Problem, z: Array) -> Array:
    """Return the size of each equation's terms."""
    return np.asarray(problem.size * (1 + np.max(np.abs(z), initial=0.0)))


def _shortened(
    problem: Problem, z: Array, f: Array, step: Array, radius: float
) -> tuple[Array | None, float]:
    """Return the point by the longest halving of a step that makes the equations smaller.

    The step is at most ``radius`` long; it comes back twice as long where the equations got smaller as the
    linear ones said, else as long as the step that was made.
    """
    size, length = problem.size, float(np.linalg.norm(step))
    here, part = np.linalg.norm(f / size), min(1.0, radius / length) if length > 0 else 1.0
    for _ in range(HALVINGS):
        there = z + part * step
        with np.errstate(all="ignore"):
            value = np.linalg.norm(problem.value(there) / size)
        if value <= (1 - HELD * part) * here:
            return there, max(radius, 2 * part * length)
        if value <= (1 - part / 4) * here:
            return there, min(radius, part * length)
        part /= 2
    return None, radius


def _polished(problem: Problem, z: Array, f: Array, step: Array) -> Array:
    """Take one step more where that makes the residual smaller."""
    better = problem.value(z + step)
    return z + step if np.linalg.norm(better) < np.linalg.norm(f) else z


def sizes(matrices: Sequence[Array], rounding: Sequence[Array]) -> Array:
    """Return the median of the norms of each row, of those that are finite; 1 for rows of zeros.

    ``rounding``: of each equation at the same points; a row that is nothing but that counts as so large
    that its rounding is `TOLERANCE` of it: a residual of that size is zero.
    """
    norms = np.array([np.linalg.norm(J, axis=1) for J in matrices if np.all(np.isfinite(J))])
    if not norms.size:
        return np.ones(len(matrices[0]))
    found = np.median(norms, axis=0)
    found = np.where(found > 0, found, np.where(norms.max(axis=0) > 0, norms.max(axis=0), 1.0))
    known = [r for r in rounding if np.all(np.isfinite(r))]
    return np.maximum(found, np.median(known, axis=0) / TOLERANCE) if known else found


def null_space(J: Array, size: Array) -> tuple[int, Array]:
    """Return the rank of J with rows scaled by ``size``, and its null space as columns."""
    _, singular, rows = np.linalg.svd(J / size[:, None])
    rank = int(np.sum(singular > RANK * max(1.0, float(np.max(singular, initial=0.0)))))
    return rank, np.asarray(rows[rank:].T)
