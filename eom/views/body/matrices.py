"""Rotation matrices of many attitudes at once; C takes inertial components to the body."""

from __future__ import annotations

import numpy as np

from eom.views.draw.picture import Floats


def quaternion_matrices(q: Floats) -> Floats:
    """Return C_BI, (N, 3, 3), of unit quaternions (4, N), scalar first (Hughes, 1986, eq. 2.2-27)."""
    s, x, y, z = q
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y + s * z), 2 * (x * z - s * y)],
        [2 * (x * y - s * z), 1 - 2 * (x * x + z * z), 2 * (y * z + s * x)],
        [2 * (x * z + s * y), 2 * (y * z - s * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def sequence_matrices(sequence: str, angles: Floats) -> Floats:
    """Return C_BI, (N, 3, 3), of angles (3, N) in radians about body axes, the first angle first."""
    made = np.broadcast_to(np.eye(3), (angles.shape[1], 3, 3))
    for axis, angle in zip(sequence.split("-"), angles, strict=True):
        k = int(axis) - 1
        i, j = (k + 1) % 3, (k + 2) % 3
        turn = np.zeros((len(angle), 3, 3))
        turn[:, k, k] = 1.0
        turn[:, i, i] = turn[:, j, j] = np.cos(angle)
        turn[:, i, j], turn[:, j, i] = np.sin(angle), -np.sin(angle)
        made = turn @ made
    return np.asarray(made)
