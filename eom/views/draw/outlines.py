"""Solids in sketches: a translucent surface and its sharp edges."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from eom.views.draw.meshes import Faces
from eom.views.draw.picture import Curve, Floats, Item, Surface
from eom.views.draw.solid_meshes import Mesh

OPACITY = 0.3


def solid(mesh: Mesh, C: Floats, origin: Floats, colour: str = "sky") -> Iterator[Item]:
    """Yield the surface of a mesh in its body's axes, and its edges; C from space to the body."""
    vertices = mesh.vertices @ C + origin
    yield Surface(vertices, mesh.faces, colour, OPACITY)
    edges = sharp_edges(mesh)
    if len(edges):
        gaps = np.full((len(edges), 1, 3), np.nan)
        lines = np.concatenate([vertices[edges], gaps], axis=1)
        yield Curve(lines.reshape(-1, 3), colour, 0.8)


def sharp_edges(mesh: Mesh) -> Faces:
    """Return the edges that one triangle alone has, pairs of vertices of shape (N, 2).

    A mesh shares vertices within its smooth pieces, so that these bound them.
    """
    pairs = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, counts = np.unique(pairs, axis=0, return_counts=True)
    return np.asarray(edges[counts == 1])
