"""Triangles: tips of arrows, ellipsoids and the light on them; the catalogue's solids as meshes.

The mesh of a solid is made from the region that its inertia is integrated over: a map from parameters to
positions, whose boundary is where a parameter is at one of its bounds. Lengths of solids in m, in their
axes: an axis of symmetry is b3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from eom.mass import regions, solids
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


AROUND = 40
"""Pieces that a full turn is drawn in."""
THIN = 0.02
"""Radius of what has none, a rod or ring, as a share of its size."""
_NOTHING = 1e-9
"""Share of the size below which an area is none."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles: ``vertices`` of shape (N, 3) in m, ``faces`` of shape (M, 3), indices of vertices.

    Vertices are shared within a smooth piece of the surface and apart at its edges. ``round``: whether
    turns of it are not seen unless its octants have two tones. ``closed``: whether faces are
    anticlockwise seen from outside and bound it, so that those that are turned away are not seen.
    ``flat``: whether vertices are shared at edges, too.
    """

    vertices: Floats
    faces: Faces
    round: bool = False
    closed: bool = False
    flat: bool = False

    def moved(self, position: ArrayLike, rotation: ArrayLike | None = None) -> Mesh:
        """Return the mesh at another place.

        Parameters
        ----------
        position : array
            Where its origin goes, (3,) in metres.
        rotation : array, optional
            (3, 3); it takes components in the mesh's axes to those there.

        Returns
        -------
        Mesh
            The same faces.
        """
        R = np.eye(3) if rotation is None else np.asarray(rotation, dtype=np.float64)
        return replace(self, vertices=self.vertices @ R.T + np.asarray(position))

    @property
    def extent(self) -> float:
        """The largest distance of a vertex from the origin."""
        return float(np.max(np.linalg.norm(self.vertices, axis=1), initial=0.0))

    @property
    def volume(self) -> float:
        """What it bounds (m^3), positive where faces are anticlockwise from outside: Gauss's theorem."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    @property
    def octants(self) -> NDArray[np.bool_]:
        """Whether each face lies in an octant of the second tone, shape (M,)."""
        centres = self.vertices[self.faces].mean(axis=1)
        size = _NOTHING * self.extent
        return np.asarray(np.count_nonzero(centres < -size, axis=1) % 2 == 1)


def joined(*meshes: Mesh) -> Mesh:
    """Return several meshes as one."""
    starts = np.cumsum([0, *(len(m.vertices) for m in meshes)])
    faces = [m.faces + start for m, start in zip(meshes, starts, strict=False)]
    vertices = np.concatenate([m.vertices for m in meshes])
    return Mesh(vertices, np.concatenate(faces), any(m.round for m in meshes))


def of_solid(name: str, sizes: Mapping[str, float]) -> Mesh:
    """Return the surface of a solid of `eom.mass.solids` with its centre of mass at the origin.

    ``sizes`` (m) by name. Rods and rings get a thickness. Raises `InputError` for a solid that is not
    known, or other sizes.

    >>> of_solid("box", {"a": 2.0, "b": 1.0, "c": 1.0}).vertices.max(axis=0).tolist()
    [1.0, 0.5, 0.5]
    """
    solids.check_sizes(name, sizes)
    thick = _THICKENED.get(name)
    if thick is not None:
        name, sizes = thick(sizes)
    known = {sp.Symbol(n, positive=True): v for n, v in sizes.items()}
    centre = [float(value(c, known)) for c in _centre(name)]
    return _surface(solids.SOLIDS[name].region, known).moved([-c for c in centre])


Sizes = Mapping[str, float]
_THICKENED: dict[str, Callable[[Sizes], tuple[str, Sizes]]] = {
    "rod": lambda s: ("cylinder", {"radius": THIN * s["length"], "length": s["length"]}),
    "ring": lambda s: ("torus", {"ring_radius": s["radius"], "tube_radius": THIN * s["radius"]}),
}
"""Solids that are lines: what is drawn in their place."""


@lru_cache
def _centre(name: str) -> tuple[Any, ...]:
    return tuple(regions.properties(solids.SOLIDS[name].region).centre)


_FUNCTIONS: dict[Any, Callable[[Any], Any]] = {sp.sin: np.sin, sp.cos: np.cos}


def value(expression: Any, known: Mapping[Any, Any]) -> Any:
    """Return a sum of products of powers, sines and cosines over numbers or arrays by symbol."""
    if expression in known:
        return known[expression]
    if expression.is_number:
        return float(expression)
    parts = [value(a, known) for a in expression.args]
    if expression.is_Pow:
        return parts[0] ** parts[1]
    if expression.func in _FUNCTIONS:
        return _FUNCTIONS[expression.func](parts[0])
    result = parts[0]
    for part in parts[1:]:
        result = result + part if expression.is_Add else result * part
    return result


def _surface(region: regions.Region, known: Mapping[Any, float]) -> Mesh:
    """Return the boundary of a solid region, or all of a surface."""
    curved = [any(_turns(p, s) for p in region.position) for s in region.parameters]
    round_ = any(curved)
    counts = [_pieces(bound, c, round_) for bound, c in zip(region.bounds, curved, strict=True)]
    pieces = [_patch(region, known, counts, fixed) for fixed in _sides(region.dimension)]
    size = max(float(np.abs(vertices).max()) for vertices, _ in pieces)
    kept = [m for pair in _paired(pieces, size) if (m := _mesh(pair, size, round_)) is not None]
    whole = replace(joined(*kept), closed=region.dimension == 3)
    return whole if whole.volume >= 0 else replace(whole, faces=whole.faces[:, ::-1])


def _turns(expression: Any, parameter: Any) -> bool:
    return any(a.has(parameter) for a in expression.atoms(sp.sin, sp.cos))


def _pieces(bound: Any, curved: bool, round_: bool) -> int:
    """Return into how many pieces a parameter's range is cut: even, so that octants fit."""
    if not curved:
        return 2 if round_ else 1
    _, start, end = bound
    return 4 * math.ceil(AROUND / 4 * float(end - start) / (2 * math.pi))


def _sides(dimension: int) -> Iterator[dict[int, float]]:
    """Yield which parameter is fixed at which end of its range, in pairs; none of a surface."""
    if dimension == 2:
        yield {}
        return
    for k, end in product(range(dimension), (0.0, 1.0)):
        yield {k: end}


Patch = tuple[Floats, Faces]


def _patch(
    region: regions.Region, known: Mapping[Any, float], counts: list[int], fixed: dict[int, float]
) -> Patch:
    """Return vertices and faces of one side as a grid."""
    free = [k for k in range(region.dimension) if k not in fixed]
    steps = [np.linspace(0.0, 1.0, counts[k] + 1) for k in free]
    grid = dict(zip(free, np.meshgrid(*steps, indexing="ij"), strict=True))
    values: dict[Any, Any] = dict(known)
    for k in reversed(range(region.dimension)):
        parameter, start, end = region.bounds[k]
        low, high = value(start, values), value(end, values)
        values[parameter] = low + (high - low) * grid.get(k, fixed.get(k, 0.0))
    shape = (len(steps[0]), len(steps[1]))
    places = [np.broadcast_to(value(p, values), shape).ravel() for p in region.position]
    return np.stack(places, axis=-1), _grid_faces(*shape)


def _grid_faces(rows: int, columns: int) -> Faces:
    """Return two triangles for each cell of a grid of vertices."""
    at = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (x.ravel() for x in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    return np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])


def _paired(patches: list[Patch], size: float) -> Iterator[Patch]:
    """Yield the sides; two that lie on each other, as the ends of a full turn, are inside."""
    if len(patches) == 1:
        yield patches[0]
        return
    for k, (first, second) in enumerate(zip(patches[::2], patches[1::2], strict=True)):
        if not np.allclose(first[0], second[0], atol=_NOTHING * size):
            yield first[0], first[1][:, :: (-1) ** k]
            yield second[0], second[1][:, :: -((-1) ** k)]


def _mesh(patch: Patch, size: float, round_: bool) -> Mesh | None:
    """Return a side with equal vertices joined and without empty triangles, or None if nothing is left."""
    rounded = np.round(patch[0] / (_NOTHING * size)).astype(np.int64)
    _, kept, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    vertices, faces = patch[0][kept], inverse.reshape(-1)[patch[1]]
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    faces = faces[areas > _NOTHING * size * size]
    return Mesh(vertices, faces, round_) if len(faces) else None
