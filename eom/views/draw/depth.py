"""What hides what in space: everything in a panel as small pieces that are painted from the back.

Lines are cut into pieces, so that one that runs around a body is hidden by it where it is behind.
Without perspective a shift towards the eye does not move a piece on paper; it lifts lines that lie
on a surface above its triangles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eom.views.draw.meshes import Faces, brightness, tip
from eom.views.draw.picture import (
    COLOURS,
    Arrow,
    Curve,
    Floats,
    Item,
    Marks,
    Panel,
    Surface,
    placed,
)

LIFT = 0.012
"""By which part of the diagonal lines are moved towards the eye; wide ones by some more."""
LONGEST = 0.024
"""Length of the pieces of a line, as a part of the diagonal."""
LOOSE = 1.2
"""Length of the vector to the eye in a cube with edges of length 1."""
TIP = 0.033
"""Length of the tip of an arrow, as a part of the diagonal."""
DASHES = {"solid": (1.0, 0.0), "dashed": (0.02, 0.012), "dotted": (0.003, 0.01)}
"""Length of dashes and of the gaps between them, as parts of the diagonal."""

RGBA = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class Drawn:
    """A piece: a line through ``points`` where ``width`` (printer's points) is not 0, or a face."""

    points: Floats
    colour: RGBA
    width: float


@dataclass(frozen=True, eq=False)
class View:
    """A projection, ``matrix`` (4, 4) of homogeneous coordinates of the data; its third row is the depth.

    ``towards``: a vector in the data that points to the eye; without perspective it is seen as a point, and
    has the length that the box around ``low`` and ``high`` gives it.
    """

    matrix: Floats
    towards: Floats

    @classmethod
    def of(cls, matrix: Floats, low: Floats, high: Floats) -> View:
        """Return the view of a projection as Matplotlib makes it, with depth growing away from the eye."""
        matrix = matrix / matrix[3, 3]
        way = np.cross(matrix[0, :3], matrix[1, :3])
        way = way / np.linalg.norm(way / (high - low)) * LOOSE
        way = way if matrix[2, :3] @ way < 0 else -way
        return cls(matrix, way)

    @classmethod
    def pinhole(cls, place: Floats, axes: Floats, field: float) -> View:
        """Return the view from a place; ``axes``, by rows: right, up, to the eye; ``field``: an angle."""
        rows = np.stack([*(axes[:2] / np.tan(field / 2)), -axes[2], -axes[2]])
        return cls(np.column_stack([rows, -rows @ place]), axes[2])

    def flat(self, points: Floats) -> Floats:
        """Return where points (..., 3) are seen, (..., 2)."""
        x, y, _, w = np.moveaxis(points @ self.matrix[:, :3].T + self.matrix[:, 3], -1, 0)
        return np.stack([x / w, y / w], axis=-1)

    def depth(self, points: Floats) -> Floats:
        """Return how far points (..., 3) are from the eye, but for a constant without perspective."""
        return np.asarray(points @ self.matrix[2, :3] + self.matrix[2, 3])

    def sorted(self, drawn: list[Drawn]) -> list[Drawn]:
        """Return pieces from the back to the front."""
        depth = [float(np.mean(self.depth(d.points))) for d in drawn]
        order = np.argsort(np.negative(depth), kind="stable")
        return [drawn[k] for k in order]


def bounds(panel: Panel) -> tuple[Floats, Floats]:
    """Return the least and the greatest coordinates of a panel, (2,) or (3,); powers of ten on log axes."""
    size = len(panel.axes)
    arrays = [np.reshape(a, (-1, size)) for item in panel.items for a in placed(item)]
    points = np.concatenate([*arrays, np.zeros((0, size))])
    log = np.array([axis.scale == "log" for axis in panel.axes])
    points = _powers(points, log)
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        points = np.array([[-1.0] * size, [1.0] * size])
    low, high = points.min(axis=0), points.max(axis=0)
    room = np.maximum(0.04 * (high - low), 0.02 * max(float((high - low).max()), 1e-300))
    low, high = low - room, high + room
    for k, axis in enumerate(panel.axes):
        if axis.limits is not None:
            low[k], high[k] = _powers(np.array(axis.limits, float)[:, None], log[k : k + 1])[:, 0]
    return low, high


def _powers(points: Floats, log: NDArray[np.bool_]) -> Floats:
    """Return coordinates with those on logarithmic axes as powers of ten; what has none is no number."""
    made = points.copy()
    positive = np.where(points > 0, points, np.nan)
    made[:, log] = np.log10(positive[:, log])
    return made


def diagonal(low: Floats, high: Floats) -> float:
    """Return the length of the diagonal of a box."""
    return float(np.linalg.norm(np.subtract(high, low)))


def rgba(name: str, light: float = 1.0, opacity: float = 1.0) -> RGBA:
    """Return a colour of `COLOURS` with ``light`` on it, as numbers in [0, 1]."""
    code = COLOURS[name]
    r, g, b = (light * int(code[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return r, g, b, opacity


def in_space(panel: Panel, towards: Floats, size: float) -> list[Drawn]:
    """Return all pieces of a panel; ``towards``: see `View`; ``size``: the diagonal."""
    lift = LIFT * towards
    return [piece for item in panel.items for piece in _pieces(item, lift, size)]


def _pieces(item: Item, lift: Floats, size: float) -> list[Drawn]:
    if isinstance(item, Surface):
        return _faces(item.vertices, item.faces, item.colour, item.opacity)
    if isinstance(item, Curve):
        colour = rgba(item.colour)
        over = (1 + item.width) * lift
        return [Drawn(p + over, colour, item.width) for p in cut(item.points, item.dash, size)]
    if isinstance(item, Marks):
        dot = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 3e-3 * size]])
        places = item.points[np.isfinite(item.points).all(axis=1)]
        return [Drawn(p + dot + 5 * lift, rgba(item.colour), item.size) for p in places]
    return _arrow(item, lift, size) if isinstance(item, Arrow) else []


def _arrow(item: Arrow, lift: Floats, size: float) -> list[Drawn]:
    way = np.subtract(item.end, item.start)
    length = float(np.linalg.norm(way))
    if not length > 0:
        return []
    end = item.end - min(TIP * size, length) * 0.9 * way / length
    line = Curve(np.stack([item.start, end]), item.colour, item.width)
    vertices, faces = tip(item.start, item.end, TIP * size)
    return [*_pieces(line, lift, size), *_faces(vertices + 4 * lift, faces, item.colour, 1.0)]


def _faces(vertices: Floats, faces: Faces, colour: str, opacity: float) -> list[Drawn]:
    lights = brightness(vertices, faces)
    corners = vertices[faces[:, [0, 1, 2, 0]]]
    return [
        Drawn(c, rgba(colour, float(light), opacity), 0.0)
        for c, light in zip(corners, lights, strict=True)
    ]


def runs(points: Floats) -> list[Floats]:
    """Return the unbroken parts of a line, of two points or more each."""
    whole = np.isfinite(points).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], whole.astype(int), [0]])))
    return [points[a:b] for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > 1]


def cut(points: Floats, dash: str, size: float) -> list[Floats]:
    """Return a line as pieces no longer than `LONGEST`, those in the gaps of its dashes left out."""
    return [piece for run in runs(points) for piece in _cut(run, dash, size)]


def _cut(run: Floats, dash: str, size: float) -> list[Floats]:
    """Cut one unbroken line at multiples of the lengths of dashes and gaps."""
    steps = np.linalg.norm(np.diff(run, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    total = float(along[-1])
    if not total > 0:
        return []
    on, off = DASHES[dash] if dash != "solid" else (LONGEST, 0.0)
    count = max(1, round(total / ((on + off) * size)))
    period = total / count
    starts = period * np.arange(count)
    ends = starts + period * on / (on + off)
    return [_between(run, along, float(a), float(b)) for a, b in zip(starts, ends, strict=True)]


def _between(run: Floats, along: Floats, start: float, end: float) -> Floats:
    """Return the part of a line between two lengths along it."""
    inner = run[(along > start) & (along < end)]
    first, last = (np.array([np.interp(s, along, c) for c in run.T]) for s in (start, end))
    return np.concatenate([[first], inner, [last]])
