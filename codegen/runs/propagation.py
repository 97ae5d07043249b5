"""What becomes of small errors along a trajectory: growth, and rounding that adds up.

Small changes d of the states obey d' = J d with the Jacobian J of the rates along the trajectory. From
node to node they are carried by the (2, 3) Pade approximation of exp(h J), of order 5 and L-stable: stiff
changes die out as they do in truth (Hairer and Wanner, Solving Ordinary Differential Equations II (1996),
sect. IV.3). Changes are in units of the size of each state. Growth is the largest factor of any change made
at the start; its logarithm over the time is the finite-time Lyapunov exponent (Benettin, Galgani, Giorgilli
and Strelcyn, Meccanica 15 (1980) 9).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from codegen.compiling.compiled import Compiled
from codegen.compiling.linear import compiled_jacobian
from codegen.native.trajectory import Array

UNIT_ROUNDOFF = 2.0**-53
MOST_STATES = 48
"""States from which on whole matrices cost more than they tell."""
GROUPS = 1500
"""Propagators that are applied one after the other; those of more nodes are multiplied beforehand."""
HUGE = 1e100
"""Size at which numbers are scaled back."""


@dataclass(frozen=True)
class Growth:
    """At nodes ``t`` (M,): the logarithm of the growth, and rounding so far (n, M) in units of the sizes.

    ``rounding``: standard deviation of what the errors of one unit roundoff of each change of a state make.
    """

    t: Array
    logarithm: Array
    rounding: Array


Inputs = Callable[[Array], Array]


def growth(
    compiled: Compiled,
    parameters: Array,
    inputs: Inputs,
    nodes: Array,
    path: Array,
    sizes: Array,
    steps: int,
) -> Growth | None:
    """Return what becomes of errors along states ``path`` (n, M) at ``nodes`` (M,); None if not known.

    ``sizes`` (n,): what errors are relative to. ``steps``: how many steps the run made that is judged:
    so often its states were rounded.
    """
    n, count = path.shape
    if count < 2 or n > MOST_STATES:
        return None
    J = compiled_jacobian(compiled, target="numpy").dense(nodes, path, parameters, inputs(nodes))
    M = _propagators(np.diff(nodes), J * sizes[None, :, None] / sizes[:, None, None])
    if not np.isfinite(M).all():
        return None
    changes = np.abs(np.diff(path, axis=1)) / sizes[:, None] * math.sqrt(count / max(1, steps))
    every = 1
    while len(M) > GROUPS:
        M, changes, every = _halved(M), _paired(changes), 2 * every
    t = np.append(nodes[: count - 1 : every], nodes[-1])
    return Growth(t, _logarithms(M), _deviations(M, UNIT_ROUNDOFF * changes))


def _halved(M: Array) -> Array:
    """Return propagators (K, n, n) over two nodes each."""
    if len(M) % 2:
        M = np.concatenate([M, np.eye(M.shape[1])[None]])
    return np.asarray(M[1::2] @ M[::2])


def _paired(changes: Array) -> Array:
    """Return roots of sums of two squares (n, K) each."""
    if changes.shape[1] % 2:
        changes = np.append(changes, np.zeros((len(changes), 1)), axis=1)
    return np.hypot(changes[:, ::2], changes[:, 1::2])


def _logarithms(M: Array) -> Array:
    """Return the logarithm of the largest sum of a row of M_k ... M_1, from the empty product on."""
    carried, scaled, found = np.eye(M.shape[1]), 0.0, [0.0]
    for m in M:
        carried = m @ carried
        size = float(np.abs(carried).sum(axis=1).max())
        found.append(scaled + math.log(size) if size > 0 else -math.inf)
        if size > HUGE or 0 < size < 1 / HUGE:
            carried, scaled = carried / size, scaled + math.log(size)
    return np.array(found)


def _deviations(M: Array, changes: Array) -> Array:
    """Return standard deviations (n, K + 1) of errors ``changes`` (n, K), all independent; at most 1.

    A root of the covariance is carried, by QR factorisation: differences of squares would lose all digits.
    """
    n = M.shape[1]
    root, found = np.zeros((n, n)), [np.zeros(n)]
    for m, change in zip(M, changes.T, strict=True):
        both = np.concatenate([(m @ root).T, np.diag(change)])
        upper: Array = np.asarray(np.linalg.qr(both, mode="r"))
        root = upper.T
        deviation = np.linalg.norm(root, axis=1)
        if deviation.max() > 1:
            root = root / np.maximum(deviation, 1.0)[:, None]
        found.append(np.minimum(deviation, 1.0))
    return np.array(found).T


def _propagators(h: Array, J: Array) -> Array:
    """Return exp(h J) from node to node, (M - 1, n, n), by J at both ends (n, n, M)."""
    Z = np.moveaxis(0.5 * (J[:, :, 1:] + J[:, :, :-1]) * h, 2, 0)
    one = np.eye(Z.shape[1])
    square = Z @ Z
    below = one - 0.6 * Z + 0.15 * square - Z @ square / 60
    try:
        return np.asarray(np.linalg.solve(below, one + 0.4 * Z + 0.05 * square))
    except np.linalg.LinAlgError:
        return np.full_like(Z, np.nan)
