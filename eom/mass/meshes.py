"""Mass properties of bodies that closed triangle meshes bound, exactly as sums of tetrahedra.

Faces are triples of vertex numbers from 0, anticlockwise seen from outside; inner surfaces
(cavities) are anticlockwise seen from the cavity. Units: m, kg/m^3.
"""

from __future__ import annotations

import importlib
import math
import operator
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

import sympy as sp

from eom.errors import InputError, near_matches
from eom.mass.properties import MassProperties

Vertices = Sequence[Sequence[float]]
Faces = Sequence[Sequence[int]]
_Number = TypeVar("_Number", int, float)
_Point = tuple[float, float, float]

FORMATS = ("obj", "off", "ply", "stl")
"""File formats that `read_mesh` takes."""
_DIGITS = 40
_MOMENTS = [(i, j) for i in range(3) for j in range(i, 3)]


def mesh_properties(vertices: Vertices, faces: Faces, density: float = 1.0) -> MassProperties:
    """Return mass and moments of the body that a closed mesh bounds, about the origin.

    The sums are those of the tetrahedra that the faces span with the middle of the vertices, so
    that nothing cancels far from the origin; the results are numbers of 40 digits, so that moving
    the reference point back loses nothing. Raises `InputError` for a mesh that is not closed, is
    inside out or has unusable vertices. Source: Tonon, Journal of Mathematics and Statistics 1
    (2005) 8-11; Mirtich, Journal of Graphics Tools 1 (1996) 31-50.
    """
    if not (math.isfinite(density) and density > 0):
        raise InputError("density is not positive", where="density", got=density)
    points = _checked_vertices(vertices)
    triangles = _checked_faces(faces, points)
    _check_closed(triangles)
    middle = _middle(points)
    local = [tuple(p - o for p, o in zip(point, middle, strict=True)) for point in points]
    rows = list(_tetrahedra(local, triangles))
    volume, *moments = (math.fsum(column) for column in zip(*rows, strict=True))
    _check_volume(volume, local)
    m, *rest = (sp.Float(density, _DIGITS) * sp.Float(v, _DIGITS) for v in (volume, *moments))
    second = dict(zip(_MOMENTS, rest[3:], strict=True))
    S = sp.Matrix(3, 3, lambda i, j: second[min(i, j), max(i, j)])
    return MassProperties(m, rest[:3], S).shifted([-sp.Float(o, _DIGITS) for o in middle])


def read_mesh(path: str | Path, unit: float = 1.0) -> tuple[list[_Point], list[tuple[int, ...]]]:
    """Read vertices (m) and faces of an STL, OBJ, PLY or OFF file; equal vertices are joined.

    ``unit``: metres a unit of the file, for example 0.001 for millimetres. Needs the package
    trimesh. Raises `InputError` for a file that is missing, of another format or unreadable.
    """
    file = Path(path)
    kind = file.suffix.removeprefix(".").lower()
    if kind not in FORMATS:
        expected = ", ".join(f".{k}" for k in FORMATS)
        raise InputError("unknown mesh format", where=str(file), got=kind, expected=expected)
    if not file.is_file():
        known = [p.name for p in file.parent.glob("*.*")] if file.parent.is_dir() else []
        raise InputError("no such mesh file", where=str(file), hint=near_matches(file.name, known))
    if not (math.isfinite(unit) and unit > 0):
        raise InputError("unit of length is not positive", where="unit", got=unit)
    trimesh = _trimesh()
    try:
        mesh = trimesh.load(str(file), file_type=kind, force="mesh", process=False)
        vertices, faces = mesh.vertices.tolist(), mesh.faces.tolist()
    except Exception as error:
        raise InputError("mesh file cannot be read", where=str(file), got=repr(error)) from None
    if not faces:
        raise InputError("mesh file has no triangles", where=str(file))
    return _joined(vertices, faces, unit)


def _trimesh() -> Any:
    try:
        return importlib.import_module("trimesh")
    except ImportError:
        raise InputError(
            "mesh files need the package trimesh",
            hint="python -m pip install 'eom-toolkit[mesh]'",
        ) from None


def _joined(
    vertices: Vertices, faces: Faces, unit: float
) -> tuple[list[_Point], list[tuple[int, ...]]]:
    """Give vertices at the same place one number; STL files repeat them for each face."""
    numbers: dict[_Point, int] = {}
    new = []
    for x, y, z in vertices:
        new.append(
            numbers.setdefault((x * unit + 0.0, y * unit + 0.0, z * unit + 0.0), len(numbers))
        )
    return list(numbers), [tuple(new[v] for v in face) for face in faces]


def _checked_vertices(vertices: Vertices) -> list[_Point]:
    points = []
    for k, vertex in enumerate(vertices):
        numbers = _read_as(float, vertex)
        if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
            raise InputError("vertex is not three finite numbers", where=f"vertex {k}", got=vertex)
        x, y, z = numbers
        points.append((x, y, z))
    return points


def _read_as(kind: Callable[[Any], _Number], row: Any) -> list[_Number]:
    """Return the row as numbers of one kind; nothing where one is none."""
    try:
        return [kind(entry) for entry in row]
    except (TypeError, ValueError):
        return []


def _checked_faces(faces: Faces, points: list[_Point]) -> list[tuple[int, int, int]]:
    triangles = []
    for k, face in enumerate(faces):
        numbers = _read_as(operator.index, face)
        if len(numbers) != 3 or not all(0 <= v < len(points) for v in numbers):
            raise InputError(
                "face is not three numbers of vertices",
                where=f"face {k}",
                got=face,
                expected=f"three of 0 to {len(points) - 1}",
            )
        a, b, c = numbers
        if len({points[a], points[b], points[c]}) < 3:
            raise InputError(
                "face is degenerate: two corners are at the same place",
                where=f"face {k}",
                got=[a, b, c],
                hint="remove the face and join its two corners",
            )
        triangles.append((a, b, c))
    if not triangles:
        raise InputError("mesh has no faces")
    return triangles


def _check_closed(triangles: list[tuple[int, int, int]]) -> None:
    """Every edge must be passed once each way: by the two faces that meet in it."""
    owner: dict[tuple[int, int], int] = {}
    for k, (a, b, c) in enumerate(triangles):
        for edge in ((a, b), (b, c), (c, a)):
            if edge in owner:
                raise InputError(
                    "mesh is not closed: an edge is passed twice in the same direction",
                    where=f"edge {edge[0]} to {edge[1]}, faces {owner[edge]} and {k}",
                    expected="once each way, by two faces",
                    hint="a face is doubled, turned the wrong way round, or a third one meets there",
                )
            owner[edge] = k
    for (a, b), k in owner.items():
        if (b, a) not in owner:
            raise InputError(
                "mesh is not closed: an edge belongs to one face only",
                where=f"edge {a} to {b}, face {k}",
                expected="once each way, by two faces",
            )


def _middle(points: list[_Point]) -> _Point:
    x, y, z = (math.fsum(column) / len(points) for column in zip(*points, strict=True))
    return x, y, z


def _tetrahedra(
    points: Sequence[tuple[float, ...]], triangles: list[tuple[int, int, int]]
) -> Iterator[tuple[float, ...]]:
    """Yield volume, first and second moments of the tetrahedron of the origin and each face."""
    for triangle in triangles:
        a, b, c = (points[k] for k in triangle)
        six_volumes = (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )
        s = [a[k] + b[k] + c[k] for k in range(3)]
        yield (
            six_volumes / 6,
            *(six_volumes / 24 * s[k] for k in range(3)),
            *(
                six_volumes / 120 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j])
                for i, j in _MOMENTS
            ),
        )


def _check_volume(volume: float, points: Sequence[tuple[float, ...]]) -> None:
    extent = max(abs(x) for point in points for x in point)
    if abs(volume) <= 1e-14 * extent**3:
        raise InputError("mesh encloses no volume", got=f"{volume:g} m^3")
    if volume < 0:
        raise InputError(
            "mesh is inside out",
            got=f"volume {volume:g} m^3",
            expected="faces anticlockwise seen from outside",
            hint="reverse the order of the corners of every face",
        )
