"""From where a sketch in space is seen best: arcs not from their edge, names of axes apart.

Names of points in space, put where other words leave room in the picture.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from eom.views.draw.picture import Arrow, Curve, Floats, Item, Words

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


DIRECTIONS = 12
ALONG = np.array([0.25, 0.5, 0.75, 1.0])
WORDED = 1.2
"""Where the words of an arrow are, by its length."""
WIDE = 0.45
"""What a distance across the paper counts beside one up or down: words are wide."""


def names(
    points: Mapping[str, Floats], items: Iterable[Item], view: tuple[float, float], distance: float
) -> Iterator[Words]:
    """Yield the words of points, each ``distance`` away on the side where most room is left.

    ``points``: places by their words. ``items``: what is drawn already; its words, arrows and straight
    lines, and the points themselves, are kept clear of. Of sides that are as good the upper right one is
    taken.
    """
    across, up = paper(view)
    frame = np.stack([WIDE * across, up])
    taken = [frame @ p for p in (*points.values(), *_crowded(items))]
    for text, point in points.items():
        angles = np.pi / 4 + 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
        sides = distance * (np.outer(np.cos(angles), across) + np.outer(np.sin(angles), up))
        places = point + sides
        room = [_room(frame @ place, taken) for place in places]
        chosen = places[int(np.argmax(np.round(room, 9)))]
        taken.append(frame @ chosen)
        yield Words(chosen, text)


def _crowded(items: Iterable[Item]) -> Iterator[Floats]:
    """Yield points that words keep clear of: words, and points along arrows and straight lines."""
    for item in items:
        if isinstance(item, Words):
            yield item.place
        elif isinstance(item, Arrow):
            places = ALONG if not item.words else np.array([*ALONG, WORDED])
            yield from item.start + np.outer(places, item.end - item.start)
        elif isinstance(item, Curve) and len(item.points) == 2:
            yield from item.points[0] + np.outer(ALONG, item.points[1] - item.points[0])


def paper(view: tuple[float, float]) -> tuple[Floats, Floats]:
    """Return the unit vectors to the right and upwards on paper, of a view by `viewpoint`."""
    sight = line_of_sight(view)
    across = np.cross(np.eye(3)[2], sight)
    across = across / np.linalg.norm(across)
    return across, np.cross(sight, across)


def _room(place: Floats, taken: Iterable[Floats]) -> float:
    return min(float(np.linalg.norm(place - other)) for other in taken)
