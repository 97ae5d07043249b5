"""From where a sketch in space is seen best: arcs not from their edge, names of axes apart."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from eom.views.picture import Arrow, Floats, Item

USUAL = (22.0, 35.0)
"""Elevation and azimuth (degrees) of pictures that do not ask for others."""
ELEVATIONS, AZIMUTHS = range(14, 36, 4), range(-60, 121, 5)
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
    return max(_views(), key=lambda view: _worth(view, arcs, tips, apart))


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


def _worth(view: tuple[float, float], arcs: Sequence[Floats], tips: Floats, enough: float) -> float:
    sight = line_of_sight(view)
    seen = min((abs(float(axis @ sight)) for axis in arcs), default=1.0)
    places = np.concatenate([tips - np.outer(tips @ sight, sight), np.zeros((1, 3))])
    distances = np.linalg.norm(places[:, None] - places[None], axis=-1)
    apart = float(np.min(distances + 1e9 * np.eye(len(places))))
    largest = max(float(np.max(np.abs(tips), initial=0.0)), 1e-300)
    far = (abs(view[0] - USUAL[0]) + abs(view[1] - USUAL[1])) / 180
    return min(seen / OPEN, 1.0) + min(apart / (enough * largest), 1.0) - FAR * far
