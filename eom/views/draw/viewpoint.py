"""From where a sketch in space is seen best: arcs not from their edge, names of axes apart."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from eom.views.draw.picture import Arrow, Floats, Item

USUAL = (22.0, 35.0)
"""Elevation and azimuth (degrees) of pictures that do not ask for others."""
ELEVATIONS, AZIMUTHS = range(14, 36, 4), [a for a in range(-60, 121, 5) if 15 <= a % 90 <= 75]
"""What is tried: no axis of the reference frame points at the eye, or is upright on paper but the third."""
OPEN, APART, CROWDED = 0.45, 0.25, 0.1
"""Enough: cosine between an arc's axis and the line of sight, distance of names over the largest,
and that distance where axes may be nearly parallel."""
FAR = 0.15
"""What a view loses by being as far as can be from the usual one."""


def best_view(
    arcs: Sequence[Floats], items: Iterable[Item], apart: float = APART
) -> tuple[float, float]:
    """Return elevation and azimuth (degrees) for arcs about some axes and arrows with words.

    ``apart``: which distance of names is enough, over the largest. The usual view is taken where it is
    as good as any.
    """
    tips = np.array([i.end for i in items if isinstance(i, Arrow) and i.words])
    views = list(_views())
    worth = _worth(
        np.array(views), arcs, np.concatenate([tips.reshape(-1, 3), np.zeros((1, 3))]), apart
    )
    return views[int(np.argmax(np.round(worth, 9)))]


def _views() -> Iterator[tuple[float, float]]:
    yield USUAL
    for elevation in ELEVATIONS:
        for azimuth in AZIMUTHS:
            yield float(elevation), float(azimuth)


def line_of_sight(view: tuple[float, float]) -> Floats:
    """Return the unit vector towards the eye."""
    up, around = (math.radians(x) for x in view)
    way = (math.cos(up) * math.cos(around), math.cos(up) * math.sin(around), math.sin(up))
    return np.array(way)


def _worth(views: Floats, arcs: Sequence[Floats], places: Floats, enough: float) -> Floats:
    """Return how good each view is; ``places``: of names, shape (N, 3), which are seen apart or not."""
    sights = np.array([line_of_sight((up, around)) for up, around in views.tolist()])
    seen = np.abs(np.array(arcs).reshape(-1, 3) @ sights.T).min(axis=0, initial=1.0)
    first, second = np.triu_indices(len(places), 1)
    between = places[first] - places[second]
    along = between @ sights.T
    across = np.maximum(np.sum(between**2, axis=1)[:, None] - along**2, 0.0)
    apart = np.sqrt(across.min(axis=0, initial=np.inf))
    largest = max(float(np.abs(places).max()), 1e-300)
    far = np.abs(views - USUAL).sum(axis=1) / 180
    worth: Floats = (
        np.minimum(seen / OPEN, 1.0) + np.minimum(apart / (enough * largest), 1.0) - FAR * far
    )
    return worth
