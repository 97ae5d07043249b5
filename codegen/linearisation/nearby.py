"""What is near a guess: distances in the scales of the unknowns, points around it, whole turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from codegen.linearisation import balance
from codegen.linearisation.unknowns import Equations

Array = NDArray[np.float64]

NEAR, NEAR_POINTS = 0.3, 6
"""How far from the guess, in scales, derivatives are looked at for their size, and at how many points."""
WIDEST = 2
"""Deviation of the farthest points around a guess, in scales."""


def scales_of(equations: Equations, x: Array, u: Array, turning: Sequence[bool]) -> Array:
    """Return the scale of each state and input (see `balance`), from the rates around a guess.

    ``turning``: whether each is an angle, or part of a quaternion. How far around depends on the scales:
    they are made twice, first of points that are as far as the guess is from zero.
    """
    guess, n = np.concatenate([x, u]), x.size
    scale = np.where(turning, 1.0, np.abs(guess))
    for _ in range(2):
        size = np.median(np.abs(_derivatives(equations, guess, scale, n)), axis=0)
        states = balance.of_states(size[:, :n], x, turning[:n])
        terms = np.linalg.norm(size[:, :n] * states, axis=1)
        scale = np.concatenate([states, balance.of_inputs(size[:, n:], terms, u)])
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
