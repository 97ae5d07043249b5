"""Triangles that several pictures draw: tips of arrows, ellipsoids, cones, and how light falls on them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eom.views.draw.picture import Floats, Surface

Faces = NDArray[np.int64]
LIGHT = np.array([0.35, -0.5, 0.8]) / np.linalg.norm([0.35, -0.5, 0.8])
AMBIENT = 0.72
"""Brightness of a triangle that is seen by its edge from where the light is; 1 is full light."""

ELLIPSOID = 31, 61
"""Circles of latitude, both poles among them, and meridians, of which the first is the last."""


def grid_faces(rows: int, columns: int) -> Faces:
    """Return the triangles between ``rows`` x ``columns`` vertices that are listed row by row."""
    k = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = k[:-1, :-1].ravel(), k[:-1, 1:].ravel(), k[1:, 1:].ravel(), k[1:, :-1].ravel()
    return np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def ellipsoid(semi_axes: ArrayLike, colour: str, opacity: float, label: str = "") -> Surface:
    """Return the ellipsoid about the origin with three ``semi_axes`` along the axes of the panel."""
    rows, columns = ELLIPSOID
    polar = np.linspace(0.0, np.pi, rows)[:, None]
    around = np.linspace(0.0, 2 * np.pi, columns)[None, :]
    unit = np.stack([
        np.sin(polar) * np.cos(around),
        np.sin(polar) * np.sin(around),
        np.cos(polar) * np.ones_like(around),
    ], axis=-1).reshape(-1, 3)  # fmt: skip
    vertices = unit * np.asarray(semi_axes, float)
    return Surface(vertices, grid_faces(rows, columns), colour, opacity, label)


def tip(start: Floats, end: Floats, length: float, around: int = 16) -> tuple[Floats, Faces]:
    """Return the cone at the end of an arrow, ``length`` long: vertices (N, 3) and faces (M, 3).

    An arrow without length has no tip: no vertices, no faces.
    """
    way = np.asarray(end, float) - np.asarray(start, float)
    size = float(np.linalg.norm(way))
    if not size > 0:
        return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
    way = way / size
    first = np.cross(way, np.eye(3)[int(np.argmin(np.abs(way)))])
    first /= np.linalg.norm(first)
    second = np.cross(way, first)
    angle = np.linspace(0.0, 2 * np.pi, around, endpoint=False)[:, None]
    length = min(length, size)
    ring = end - length * way + 0.32 * length * (np.cos(angle) * first + np.sin(angle) * second)
    k = np.arange(around)
    after = (k + 1) % around
    sides = np.stack([k, after, np.full(around, around)], 1)
    bottom = np.stack([after, k, np.full(around, around + 1)], 1)
    vertices = np.concatenate([ring, [end], [end - length * way]])
    return vertices, np.concatenate([sides, bottom])


def brightness(vertices: Floats, faces: Faces) -> Floats:
    """Return the light on each face, in [`AMBIENT`, 1], the same on both of its sides."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    cosine = np.abs(np.divide(normal, size, out=np.zeros_like(normal), where=size > 0) @ LIGHT)
    return np.asarray(AMBIENT + (1 - AMBIENT) * cosine)
