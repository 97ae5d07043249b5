"""What is near a guess: distances in the scales of the unknowns, points around it, whole turns.

Scales of states and inputs, what is a small change of each, come from the equations themselves. The matrix
of derivatives of rates by states is balanced by a diagonal matrix D: row and column k of D^-1 A D get equal
sums (Osborne, J. ACM 7 (1960) 338; Parlett and Reinsch, Numer. Math. 13 (1969) 293). For x' = v, v' = -w^2
x a change of v has w times the size of one of x; it does not depend on units. Each set of states that have
to do with each other keeps one factor free, which angles, else the values of a state, settle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from codegen.linearisation.unknowns import Equations

Array = NDArray[np.float64]

NEAR, NEAR_POINTS = 0.3, 6
"""How far from the guess, in scales, derivatives are looked at for their size, and at how many points."""
WIDEST = 2
"""Deviation of the farthest points around a guess, in scales."""


def scales_of(equations: Equations, x: Array, u: Array, turning: Sequence[bool]) -> Array:
    """Return the scale of each state and input (see `state_scales`), from the rates around a guess.

    ``turning``: whether each is an angle, or part of a quaternion. How far around depends on the scales:
    they are made twice, first of points that are as far as the guess is from zero.
    """
    guess, n = np.concatenate([x, u]), x.size
    scale = np.where(turning, 1.0, np.abs(guess))
    for _ in range(2):
        size = np.median(np.abs(_derivatives(equations, guess, scale, n)), axis=0)
        states = state_scales(size[:, :n], x, turning[:n])
        terms = np.linalg.norm(size[:, :n] * states, axis=1)
        scale = np.concatenate([states, input_scales(size[:, n:], terms, u)])
    return scale


def _derivatives(equations: Equations, guess: Array, scale: Array, n: int) -> Array:
    """Return derivatives of the rates by states and inputs at points around a guess, (points, n, m)."""
    draw = np.random.default_rng(0).normal(size=(NEAR_POINTS, guess.size))
    points = [guess, *(guess + NEAR * draw * scale)]
    with np.errstate(all="ignore"):
        found = [equations.rates(z[:n], z[n:]) for z in points]
    finite = [J for J in found if np.all(np.isfinite(J))]
    return np.array(finite or [np.zeros_like(found[0])])


@dataclass(frozen=True)
class Near:
    """The unknowns of a guess with their scales; ``fours``: places of unit quaternions among them."""

    first: Array
    scales: Array
    angles: Sequence[bool]
    fours: Sequence[Sequence[int]]

    def distance(self, z: Array) -> float:
        """Return how far a point is from the guess, in the scales of the unknowns."""
        return float(np.linalg.norm((self._same_side(z) - self.first) / self.scales))

    def turned(self, z: Array) -> Array:
        """Return angles within half a turn of the guess, quaternions on its side."""
        turns = np.ceil((z - self.first) / (2 * np.pi) - 0.5)
        return self._same_side(z - 2 * np.pi * np.where(self.angles, turns, 0.0))

    def _same_side(self, z: Array) -> Array:
        z = z.copy()
        for four in self.fours:
            places = list(four)
            if z[places] @ self.first[places] < 0:
                z[places] *= -1
        return z

    def starts(self, still: Array, count: int, seed: int, spread: float) -> list[Array]:
        """Return the guess, ``still``, and points around that, farther and farther; the nearest first."""
        draw = np.random.default_rng(seed)
        around = [
            still + spread * WIDEST * (k + 1) / count * draw.normal(size=still.size) * self.scales
            for k in range(count - 2)
        ]
        return sorted([self.first, *[still] * (count > 1), *around], key=self.distance)


TURNS = 100
SETTLED = 1e-3
"""Change of all factors, relative, at which they are taken."""


def balanced(A: Array) -> Array:
    """Return d such that |A_kl| d_l / d_k has equal sums by rows and columns.

    ``A``: (n, n); signs and the diagonal do not matter. A state that only drives, or is only driven, gets
    what its own row or column asks for.
    """
    size = np.abs(A)
    np.fill_diagonal(size, 0.0)
    d = np.ones(len(A))
    for _ in range(TURNS):
        before = d.copy()
        for k in range(len(A)):
            row, column = size[k] @ d / d[k], np.sum(size[:, k] / d) * d[k]
            if row > 0 and column > 0:
                d[k] *= np.sqrt(row / column)
        if np.max(np.abs(d / before - 1), initial=0.0) < SETTLED:
            break
    return d


def parts(A: Array) -> list[list[int]]:
    """Return the sets of states that an entry of A, either way, connects, in order."""
    left, found = set(range(len(A))), []
    linked = (A != 0) | (A.T != 0)
    while left:
        stack, part = [min(left)], set()
        while stack:
            k = stack.pop()
            if k in left:
                left.discard(k)
                part.add(k)
                stack += [int(j) for j in np.flatnonzero(linked[k]) if j in left]
        found.append(sorted(part))
    return found


def state_scales(A: Array, x: Array, angles: Sequence[bool]) -> Array:
    """Return the scale of each state (n,): 1 for angles, others by what they do beside them.

    ``A``: sizes of the derivatives of rates by states, around ``x``. Without angles: by the values, and so
    that the scales have the geometric mean 1 at least.
    """
    d = balanced(A)
    for part in parts(A):
        own, turns = d[part], [k for k in part if angles[k]]
        if turns:
            factor = float(np.exp(-np.mean(np.log(d[turns]))))
        else:
            mean = float(np.exp(-np.mean(np.log(own))))
            factor = max(mean, float(np.max(np.abs(x[part]) / own)))
        d[part] = own * factor
    return np.where(np.asarray(angles), 1.0, d)


def input_scales(B: Array, rates: Array, u: Array) -> Array:
    """Return the scale of each input (m,): what changes some rate by the size of its terms, or its value.

    ``B``: (n, m), sizes of derivatives by inputs; ``rates``: (n,), sizes of the terms of each rate.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        change = np.where(B > 0, rates[:, None] / B, np.inf)
    least = np.min(change, axis=0, initial=np.inf)
    found: Array = np.maximum(np.abs(u), np.where(np.isfinite(least) & (least > 0), least, 1.0))
    return found
