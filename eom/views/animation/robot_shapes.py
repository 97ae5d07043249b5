"""Shapes of links as a URDF file names them: what is to be seen, else what touches.

Boxes, cylinders, spheres and mesh files beside the robot's (extra ``mesh``); a mesh that is not there, or
in a format that is not read, is left out, and the link is drawn by its inertia. Axes are those of the link.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from eom.errors import InputError
from eom.mass.meshes import read_mesh
from eom.multibody.files import robot_xml
from eom.multibody.files.urdf import parsed
from eom.scenes import catalogue
from eom.scenes.naming import spelling
from eom.views.animation.equivalents import Shape
from eom.views.draw.solid_meshes import Mesh, of_solid

MOST_TRIANGLES = 20_000
"""Of all links: links beyond that would not fit into a page of 3 MB, and are drawn by their inertia."""
_SCHEMES = ("package://", "file://")


def shapes_of_file(name: str | Path) -> dict[str, tuple[Shape, ...]]:
    """Return the shapes of the links of a URDF file by the names of their bodies; none for other scenes."""
    left = MOST_TRIANGLES
    if not catalogue.is_file(str(name)) or Path(name).suffix != catalogue.URDF:
        return {}
    file = Path(name)
    robot = parsed(robot_xml.checked(file)[0])
    found = {}
    for link in robot.links:
        shapes = tuple(_shapes(link.visuals, file)) or tuple(_shapes(link.collisions, file))
        size = sum(len(s.mesh.faces) for s in shapes)
        if size <= left:
            found[spelling(link.name)] = shapes
            left -= size
    return found


def _shapes(elements: Sequence[Any], file: Path) -> Iterator[Shape]:
    for element in elements:
        mesh = _mesh(element.geometry, file)
        if mesh is not None:
            origin = np.eye(4) if element.origin is None else np.asarray(element.origin)
            yield Shape(mesh.moved(origin[:3, 3], origin[:3, :3]))


def _mesh(geometry: Any, file: Path) -> Mesh | None:
    if geometry is None:
        return None
    if geometry.box is not None:
        a, b, c = (float(x) for x in geometry.box.size)
        return of_solid("box", {"a": a, "b": b, "c": c})
    if geometry.cylinder is not None:
        shape = geometry.cylinder
        sizes = {"radius": float(shape.radius), "length": float(shape.length)}
        return replace(of_solid("cylinder", sizes), round=False)
    if geometry.sphere is not None:
        return replace(of_solid("sphere", {"radius": float(geometry.sphere.radius)}), round=False)
    return None if geometry.mesh is None else _from_file(geometry.mesh, file)


def _from_file(mesh: Any, file: Path) -> Mesh | None:
    """Return a mesh that lies in the robot's folder or below one above it, None if it cannot be used."""
    text = str(mesh.filename)
    for scheme in _SCHEMES:
        text = text.removeprefix(scheme)
    for folder in (file.absolute().parent, *file.absolute().parents[1:3]):
        place = (folder / text).resolve()
        if place.is_relative_to(folder.resolve()) and place.is_file():
            return _read(place, mesh.scale)
    return None


def _read(place: Path, scale: Any) -> Mesh | None:
    try:
        vertices, faces = read_mesh(place)
    except InputError:
        return None
    factor = np.ones(3) if scale is None else np.broadcast_to(np.asarray(scale, dtype=float), (3,))
    return Mesh(np.array(vertices) * factor, np.array(faces, dtype=np.int64), flat=True)
