"""Fewer points of a long curve, none of its extremes lost."""

from __future__ import annotations

import itertools

import numpy as np

from eom.views.draw.picture import Floats

MOST = 4000
"""Points of one curve that are drawn: more than a picture has columns of dots."""


def thinned(x: Floats, y: Floats, most: int = MOST) -> tuple[Floats, Floats]:
    """Return a curve with at most ``most`` points: the least and largest y of each stretch of it.

    ``x``, ``y``: shape (N,). The points are some of those given, in their order, the first and the last
    among them; a stretch without numbers keeps one that is none, so that gaps stay gaps.
    """
    size = len(x)
    if size <= most:
        return x, y
    edges = np.linspace(0, size, most // 2).astype(np.int64)
    kept = {0, size - 1}
    for first, last in itertools.pairwise(edges):
        kept |= _extremes(y[first:last], int(first))
    chosen = np.array(sorted(kept))
    return x[chosen], y[chosen]


def _extremes(y: Floats, first: int) -> set[int]:
    """Return the places of the least and the largest number, or of one that is none."""
    known = np.flatnonzero(np.isfinite(y))
    if len(known) == 0:
        return {first}
    return {first + int(known[np.argmin(y[known])]), first + int(known[np.argmax(y[known])])}
