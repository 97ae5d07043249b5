"""Scales of states and inputs, from the equations themselves: what is a small change of each.

The matrix of derivatives of rates by states is balanced by a diagonal matrix D: row and column k of
D^-1 A D get equal sums (Osborne, J. ACM 7 (1960) 338; Parlett and Reinsch, Numer. Math. 13 (1969) 293).
For x' = v, v' = -w^2 x a change of v has w times the size of one of x; it does not depend on units.
Each set of states that have to do with each other keeps one factor free, which angles, else the
values of a state, settle.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
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


def of_states(A: Array, x: Array, angles: Sequence[bool]) -> Array:
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


def of_inputs(B: Array, rates: Array, u: Array) -> Array:
    """Return the scale of each input (m,): what changes some rate by the size of its terms, or its value.

    ``B``: (n, m), sizes of derivatives by inputs; ``rates``: (n,), sizes of the terms of each rate.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        change = np.where(B > 0, rates[:, None] / B, np.inf)
    least = np.min(change, axis=0, initial=np.inf)
    found: Array = np.maximum(np.abs(u), np.where(np.isfinite(least) & (least > 0), least, 1.0))
    return found
