"""Names of points in space, put where other words leave room in the picture."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from eom.views.draw.picture import Arrow, Curve, Floats, Item, Words
from eom.views.draw.viewpoint import line_of_sight

DIRECTIONS = 12
ALONG = np.array([0.25, 0.5, 0.75, 1.0])
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
            yield from item.start + np.outer(ALONG, item.end - item.start)
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
