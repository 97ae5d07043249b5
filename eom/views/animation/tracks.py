"""Where bodies are over time: positions, quaternions and vectors at the stored times.

A is the frame of the ground, or the one that attitude is measured in; B that of a body. Quaternions have
the scalar first; of the two that are one attitude, that nearer to the one before is taken, so that they can
be interpolated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eom.rotations import cosines, quaternion_of_matrix, quaternion_product

Floats = NDArray[np.float64]
STEP, LARGEST_STEP = 0.2, 2.0
"""Radians that a body turns from one time to the next: aimed at, and the most that can be shown."""


@dataclass(frozen=True, eq=False)
class Track:
    """The motion of one body over N instants.

    ``positions``: of its origin, components in A (m), shape (N, 3). ``quaternions``: of C_BA, shape
    (N, 4). ``omega``: its angular velocity in inertial space, components in A (rad/s), shape (N, 3).
    ``slower``: of a rotor, by how much less than it turns on its body the quaternions turn there; 0 of a
    body.
    """

    name: str
    positions: Floats
    quaternions: Floats
    omega: Floats
    slower: float = 0.0


@dataclass(frozen=True, eq=False)
class Acting:
    """A force (N) or torque (N m), the ``kind``, of a part by ``name``: ``values`` at ``places`` (m).

    ``letter``: what it is called. Components are in A, shape (N, 3).
    """

    kind: str
    letter: str
    name: str
    values: Floats
    places: Floats


@dataclass(frozen=True, eq=False)
class Tracks:
    """The motion of all ``bodies`` at ``times`` (s), shape (N,), equally far apart.

    ``momentum``: angular momentum of all bodies (N m s), about the point of ``centre`` (m), and ``torque``
    (N m) on one body, or None of several; components in A, shape (N, 3). ``acting``: on bodies of a tree.
    """

    times: Floats
    bodies: tuple[Track, ...]
    momentum: Floats
    centre: Floats
    torque: Floats | None = None
    acting: tuple[Acting, ...] = ()


def continuous(quaternions: ArrayLike) -> Floats:
    """Return quaternions of unit norm, shape (N, 4), each of the sign that is nearer to the one before."""
    q = np.array(quaternions, dtype=np.float64)
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    turns = np.einsum("ij,ij->i", q[1:], q[:-1]) < 0
    q[1:][np.cumsum(turns) % 2 == 1] *= -1
    return q


def of_matrices(C: ArrayLike) -> Floats:
    """Return the quaternions of rotations C_BA, shape (N, 3, 3), continuous."""
    return continuous([quaternion_of_matrix(matrix) for matrix in np.asarray(C).tolist()])


def matrices(quaternions: ArrayLike) -> Floats:
    """Return C_BA of unit quaternions, shape (..., 4), as shape (..., 3, 3)."""
    rows = cosines(np.moveaxis(np.asarray(quaternions, dtype=np.float64), -1, 0))
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def turned(quaternions: ArrayLike, components: ArrayLike) -> Floats:
    """Return components in A of vectors with components in B: C_AB times them, shapes (N, 4), (N, 3)."""
    return np.asarray(np.einsum("nij,ni->nj", matrices(quaternions), np.asarray(components)))


def multiplied(p: Floats, q: Floats) -> Floats:
    """Return the quaternion products p q, shape (N, 4)."""
    return np.stack(quaternion_product(p.T, q.T), axis=-1)


def from_third(axis: Floats) -> Floats:
    """Return the quaternion of axes whose third is a unit vector, by the shortest turn."""
    if axis[2] < -1 + 1e-12:
        return np.array([0.0, 1.0, 0.0, 0.0])
    q = np.array([1 + axis[2], -axis[1], axis[0], 0.0])
    return np.asarray(q / np.linalg.norm(q))
