"""Small deviations that keep constraints: which of them are free, and what the others are by these.

A deviation of the states that keeps functions G constant satisfies dG dx = 0, and what follows from it
along the motion, dG A dx = 0 and so on: for a constraint of places its rate is found by itself. All of
dG counts, also its part by the coordinates of a constraint on speeds: without that, terms in proportion
to the speed of the steady motion would be lost (Meijaard, Papadopoulos, Ruina, Schwab, Proc. R. Soc. A
463, 2007, p. 1955). Unit quaternions may deviate by three small angles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eom.errors import InputError

Array = NDArray[np.float64]

SPAN = 1e-9
"""Rows that differ relatively less than this from combinations of others are combinations of them."""
NOISE = 1e-12
"""What follows along the motion counts from this on, relative to the matrix of the motion."""


@dataclass(frozen=True)
class Deviations:
    """Deviations dx = T dz of the states, dz = S dx; ``names`` of dz. S T = 1."""

    T: Array
    S: Array
    names: tuple[str, ...]

    def dynamics(self, A: Array) -> Array:
        """Return the matrix of dz by that of dx."""
        return np.asarray(self.S @ A @ self.T)


def free_states(
    x: Array, names: Sequence[str], dropped: Sequence[str], fours: Sequence[Sequence[int]] = ()
) -> Deviations:
    """Return deviations of the states but those that are dropped.

    Each of the unit quaternions ``fours`` (at rest, scalar first) has three small angles about the body's
    axes instead: dq = q (0, theta) / 2, theta = 2 vec(q* dq).
    """
    inside = {k for four in fours for k in four}
    plain = [k for k, n in enumerate(names) if n not in dropped and k not in inside]
    columns, rows = [np.eye(len(names))[:, plain]], [np.eye(len(names))[plain]]
    labels = [names[k] for k in plain]
    for four in fours:
        block = np.zeros((len(names), 3))
        block[list(four)] = _products(x[list(four)])
        columns.append(block / 2)
        rows.append(2 * block.T)
        labels += [f"angle_{names[k]}" for k in four[1:]]
    return Deviations(np.hstack(columns), np.vstack(rows), tuple(labels))


def _products(q: Array) -> Array:
    """Return the columns of q (0, e_k)."""
    a, b, c, d = q
    return np.array([[-b, -c, -d], [a, -d, c], [d, a, -b], [-c, b, a]])


def closed(G: Array, A: Array) -> tuple[Array, list[int]]:
    """Return an orthonormal basis of the rows G, G A, G A^2, ..., and the rows of G that add nothing."""
    basis = np.zeros((0, A.shape[0]))
    redundant = []
    for k, row in enumerate(G):
        longer = _with(basis, row, SPAN * float(np.linalg.norm(row)))
        if longer is None:
            redundant.append(k)
        else:
            basis = longer
    done = 0
    while done < len(basis):
        longer = _with(basis, basis[done] @ A, NOISE * float(np.linalg.norm(A)))
        basis = basis if longer is None else longer
        done += 1
    return basis, redundant


def _with(basis: Array, row: Array, least: float) -> Array | None:
    """Return a basis with what a row adds to it; None if that is no longer than ``least``."""
    rest = row - basis.T @ (basis @ row)
    rest = rest - basis.T @ (basis @ rest)
    if np.linalg.norm(rest) <= least:
        return None
    return np.vstack([basis, rest / np.linalg.norm(rest)])


def independent(
    before: Deviations, basis: Array, preferred: Sequence[str] = ()
) -> tuple[Deviations, dict[str, dict[str, float]]]:
    """Return deviations that keep the rows of a basis, by some of the names before; and the others.

    Which become dependent is chosen by the largest pivots, not among ``preferred``. They are told
    as {dependent: {independent: factor}}. Raises `InputError` where the preferred ones are not independent.
    """
    rows, places = basis.copy(), []
    for k in range(len(rows)):
        open_ = [j for j in range(rows.shape[1]) if before.names[j] not in preferred]
        sizes = np.abs(rows[k:][:, open_])
        if not open_ or np.max(sizes) <= SPAN:
            raise InputError(
                "these states are not independent", got=", ".join(preferred),
                expected=f"{rows.shape[1] - len(rows)} that the constraints leave free",
            )  # fmt: skip
        i, j = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
        place = open_[int(j)]
        rows[[k, k + int(i)]] = rows[[k + int(i), k]]
        rows[k] /= rows[k, place]
        for other in range(len(rows)):
            if other != k:
                rows[other] -= rows[other, place] * rows[k]
        places.append(place)
    kept = [j for j in range(rows.shape[1]) if j not in places]
    T = np.zeros((rows.shape[1], len(kept)))
    T[kept, range(len(kept))] = 1.0
    for row, place in zip(rows, places, strict=True):
        T[place] = -row[kept]
    S = np.eye(rows.shape[1])[kept]
    names = tuple(before.names[j] for j in kept)
    told = {before.names[p]: {n: float(f) for n, f in zip(names, T[p], strict=True) if abs(f) > SPAN}
            for p in sorted(places)}  # fmt: skip
    return Deviations(before.T @ T, S @ before.S, names), told
