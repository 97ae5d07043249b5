"""What bodies look like: meshes that a file names, or uniform bodies of the same mass and inertia.

The integral of x_k^2 over the mass is P_k = (J11 + J22 + J33)/2 - J_kk; a box has sides a_k^2 = 12 P_k/m,
a cylinder 4 P/m = r^2 across and 12 P/m = l^2 along its axis, a sphere 5 P/m = r^2. Lengths in m, in the
axes of the body, from its origin.

Links of a URDF file have boxes, cylinders, spheres and mesh files beside the robot's (extra ``mesh``), to
be seen, else to touch; a mesh that is not there, or in a format that is not read, is left out, and the
link is drawn by its inertia. Bodies of an MJCF file have its geoms.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eom.errors import InputError
from eom.mass.meshes import read_mesh
from eom.multibody.files.mjcf import geoms_of
from eom.multibody.files.urdf import checked, names_of, parsed
from eom.scenes import catalogue
from eom.scenes.description import Weight
from eom.views.draw.meshes import Mesh, of_solid

Floats = NDArray[np.float64]

BODY_AXES = (r"$\mathbf{b}_1$", r"$\mathbf{b}_2$", r"$\mathbf{b}_3$")
EQUAL = 1e-6
"""Moments of inertia that differ by less than this share are drawn as equal."""
THINNEST = 0.05
"""The least thickness that is drawn, as a share of the largest."""
FLAT = 0.3
"""A cylinder whose length is less than this share of its radius is a wheel, if it shall be one."""
UNKNOWN_SIZE = 0.5
"""Half the largest extent (m) of a body whose mass is not known."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A mesh in the axes of its body.

    ``colour``: a name, or the body's where it is empty; ``opacity``: from 0, not seen, to 1.
    """

    mesh: Mesh
    colour: str = ""
    opacity: float = 1.0


@dataclass(frozen=True, eq=False)
class Figure:
    """A body as it is drawn: shapes in its axes, and in words how they were found."""

    name: str
    shapes: tuple[Shape, ...]
    words: str = ""
    axes: tuple[str, str, str] = BODY_AXES
    tip: Floats = field(default_factory=lambda: np.zeros(3))
    """The point whose path is drawn."""

    @property
    def extent(self) -> float:
        """The largest distance of a point of it from its origin (m)."""
        return max((s.mesh.extent for s in self.shapes), default=0.0)


@dataclass(frozen=True, eq=False)
class Line:
    """A spring or a rod without mass: numbers of two bodies, -1 for the ground, and a point of each (m)."""

    bodies: tuple[int, int]
    points: tuple[Floats, Floats]


@dataclass(frozen=True, eq=False)
class Figures:
    """The bodies in the order of `tracks.Tracks`, what stands on the ground, lines between."""

    bodies: tuple[Figure, ...]
    ground: tuple[Shape, ...] = ()
    links: tuple[Line, ...] = ()


@dataclass(frozen=True, eq=False)
class Equivalent:
    """A uniform body: the name of a solid, its sizes (m), and ``axes``: from the solid's to the body's.

    ``thickened``: whether it is drawn thicker than it is.
    """

    solid: str
    sizes: dict[str, float]
    axes: Floats
    thickened: bool = False

    @property
    def mesh(self) -> Mesh:
        """Its surface, its centre of mass at the origin."""
        return of_solid(self.solid, self.sizes).moved((0, 0, 0), self.axes)

    @property
    def words(self) -> str:
        """How it is called, with its sizes."""
        sizes = ", ".join(f"{n} {v:.3g} m" for n, v in self.sizes.items())
        return f"{self.solid} of equal inertia ({sizes}{', thickened' if self.thickened else ''})"


def equivalent(inertia: ArrayLike, mass: float | None = None) -> Equivalent:
    """Return the uniform body with a central ``inertia`` (kg m^2, shape (3, 3)) and a mass (kg).

    A sphere where all principal moments are equal, a cylinder where two are, otherwise a box; extents
    that are too thin to be seen get `THINNEST`. Without a mass the size is not known, and is chosen.
    """
    moments, axes = _principal(np.asarray(inertia, dtype=np.float64))
    spread = np.maximum(moments.sum() / 2 - moments, 0.0)
    m = mass or 3 * float(spread.max()) / UNKNOWN_SIZE**2
    largest = float(moments.max())
    equal = [abs(moments[k - 2] - moments[k - 1]) <= EQUAL * largest for k in range(3)]
    if all(equal):
        return Equivalent("sphere", {"radius": math.sqrt(5 * spread[0] / m)}, axes)
    if any(equal):
        k = equal.index(True)
        return _cylinder(float(spread[k - 1]) / m, float(spread[k]) / m, axes @ _to_third(k))
    (a, b, c), thickened = _thick([math.sqrt(12 * p / m) for p in spread])
    return Equivalent("box", {"a": a, "b": b, "c": c}, axes, thickened)


def _cylinder(across: float, along: float, axes: Floats) -> Equivalent:
    (radius, half), thickened = _thick([math.sqrt(4 * across), math.sqrt(3 * along)])
    return Equivalent("cylinder", {"radius": radius, "length": 2 * half}, axes, thickened)


def _thick(sizes: list[float]) -> tuple[list[float], bool]:
    least = THINNEST * max(sizes)
    return [max(s, least) for s in sizes], min(sizes) < least


def _to_third(axis: int) -> Floats:
    """Return the rotation that takes the third axis to axis 0, 1 or 2, by a cyclic exchange."""
    return np.roll(np.eye(3), axis - 2, axis=0)


def _principal(J: Floats) -> tuple[Floats, Floats]:
    """Return principal moments, and the rotation from principal axes to the body's."""
    if np.count_nonzero(J - np.diag(np.diag(J))) == 0:
        return np.diag(J).copy(), np.eye(3)
    moments, axes = np.linalg.eigh((J + J.T) / 2)
    return moments, axes * np.sign(np.linalg.det(axes))


def central(inertia: ArrayLike, mass: float, centre: ArrayLike) -> Floats | None:
    """Return an inertia about the centre of mass from one about the origin, by Huygens and Steiner.

    None where no body has it: the mass would have to lie nearer to the centre than the inertia says.
    """
    r = np.asarray(centre, dtype=np.float64)
    J = np.asarray(inertia, dtype=np.float64) - mass * (r @ r * np.eye(3) - np.outer(r, r))
    moments = np.linalg.eigvalsh(J)
    return J if moments[0] > 0 and moments[0] + moments[1] >= moments[2] * (1 - EQUAL) else None


def held(name: str, inertia: Floats, weight: Weight) -> Figure:
    """Return a body with weight about its fixed point, and a stalk from there to its centre of mass.

    ``inertia``: about the fixed point (kg m^2), shape (3, 3). Where a uniform body of the same mass and
    inertia would reach beyond the fixed point, it is a cone on its tip.
    """
    r = np.array(weight.centre_of_mass)
    found = central(inertia, weight.mass, r)
    if found is None:
        body = equivalent(inertia, weight.mass)
        return Figure(name, (Shape(body.mesh),), f"about the fixed point: {body.words}")
    cone = on_its_tip(found, weight.mass, r)
    if cone is not None:
        return Figure(name, (Shape(cone),), ON_ITS_TIP)
    body = equivalent(found, weight.mass)
    return Figure(name, (Shape(body.mesh.moved(r)), *stalk(r, body.mesh)), body.words)


SLIM = 0.3
"""Radius of a cone on its tip, at least, as a share of its height, which is the most."""


ON_ITS_TIP = (
    "cone on its tip, with the body's centre of mass: one of equal inertia would reach below"
)


def on_its_tip(inertia: Floats, mass: float, centre: Floats) -> Mesh | None:
    """Return a cone whose tip is the fixed point, and whose centre of mass is the body's.

    None where the uniform body of the same central ``inertia`` does not reach beyond the fixed point. The
    centre is at 3/4 of its height; its moment about the line to it, 3 m r^2 / 10, is the body's as far as
    the radius stays within bounds.
    """
    if not np.any(centre):
        return None
    reached = equivalent(inertia, mass).mesh.moved(centre).vertices @ centre
    if float(np.min(reached)) >= 0:
        return None
    height = 4 * float(np.linalg.norm(centre)) / 3
    way = centre / np.linalg.norm(centre)
    radius = math.sqrt(10 * float(way @ inertia @ way) / (3 * mass))
    radius = min(max(radius, SLIM * height), height)
    return of_solid("cone", {"radius": radius, "height": height}).moved(centre, along(way))


EDGE = 0.04
"""Length of a disc that rolls, as a share of its radius."""


def rolling(
    radius: float, half: float, axis: Floats, gyration: float, *, spokes: bool = True
) -> tuple[tuple[Shape, ...], str]:
    """Return what rolls as it touches, its centre at the origin, and in words.

    ``axis``: zero of a ball; ``half``: half of the axis of an ellipsoid (m), 0 with a thin edge. That is a
    wheel with ``spokes`` where the mass is farther out than a disc's: ``gyration``, the moment about the
    axis by the mass (m^2), is above radius^2 / 2.
    """
    if not np.any(axis):
        return (Shape(of_solid("sphere", {"radius": radius})),), "ball that rolls"
    turn = along(axis / np.linalg.norm(axis))
    if half:
        egg = of_solid("ellipsoid", {"a": radius, "b": radius, "c": half})
        return (Shape(egg.moved((0, 0, 0), turn)),), "ellipsoid that rolls"
    if spokes and gyration > 0.5 * radius**2 * (1 + EQUAL):
        tube = 0.03 * radius
        parts = wheel(radius - tube, 2, tube)
        turned = tuple(replace(p, mesh=p.mesh.moved((0, 0, 0), turn)) for p in parts)
        return turned, "wheel of the radius that rolls"
    disc = of_solid("cylinder", {"radius": radius, "length": EDGE * radius})
    return (Shape(disc.moved((0, 0, 0), turn)),), "disc of the radius that rolls"


def stalk(centre: Floats, mesh: Mesh) -> tuple[Shape, ...]:
    """Return a rod from the fixed point to the centre of mass, none where they coincide."""
    return rod((0, 0, 0), centre, 0.02 * mesh.extent)


def wheel(radius: float, axis: int = 2, tube: float | None = None) -> tuple[Shape, ...]:
    """Return rim, spokes, one in another colour, hub and axle.

    ``axis``: 0, 1 or 2, the axle's; ``tube``: radius of the rim's cross-section (m), else a share of it.
    """
    rim = of_solid("torus", {"ring_radius": radius, "tube_radius": tube or 0.055 * radius})
    hub = of_solid("cylinder", {"radius": 0.07 * radius, "length": 0.22 * radius})
    axle = of_solid("cylinder", {"radius": 0.025 * radius, "length": 1.1 * radius})
    spoke = of_solid("cylinder", {"radius": 0.012 * radius, "length": radius})
    first = of_solid("cylinder", {"radius": 0.03 * radius, "length": radius})
    parts = [Shape(replace(rim, round=False)), Shape(hub, "grey"), Shape(axle, "grey")]
    for k in range(8):
        turn = _turned_about_third(math.pi * k / 4) @ _to_third(0)
        out = turn @ np.array([0.0, 0.0, radius / 2])
        mesh = (spoke if k else first).moved(out, turn)
        parts.append(Shape(replace(mesh, round=False), "grey" if k else "red"))
    return tuple(replace(p, mesh=p.mesh.moved((0, 0, 0), _to_third(axis))) for p in parts)


def _turned_about_third(angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rod(start: ArrayLike, end: ArrayLike, radius: float, colour: str = "grey") -> tuple[Shape, ...]:
    """Return a thin cylinder between two points (m), none where they coincide."""
    a, b = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    length = float(np.linalg.norm(b - a))
    if length < 1e-9 or radius <= 0:
        return ()
    mesh = of_solid("cylinder", {"radius": radius, "length": length})
    return (Shape(replace(mesh.moved((a + b) / 2, along((b - a) / length)), round=False), colour),)


def along(direction: Sequence[float] | Floats) -> Floats:
    """Return a rotation that takes the third axis to a unit vector."""
    d = np.asarray(direction, dtype=np.float64)
    across = np.eye(3)[int(np.argmin(np.abs(d)))]
    first = np.cross(across, d)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(d, first), d], axis=1)


MOST_TRIANGLES = 20_000
"""Of all links: links beyond that would not fit into a page of 2 MB, and are drawn by their inertia."""
_SCHEMES = ("package://", "file://")


def shapes_of_file(name: str | Path) -> dict[str, tuple[Shape, ...]]:
    """Return the shapes of the bodies of a robot's file by their names; none for other scenes."""
    file = Path(name)
    read = _READERS.get(file.suffix) if catalogue.is_file(str(name)) else None
    try:
        every = {} if read is None else read(file)
    except InputError:
        return {}  # its motion is known, but not all of its shapes are
    left, found = MOST_TRIANGLES, {}
    for body, shapes in every.items():
        size = sum(len(s.mesh.faces) for s in shapes)
        if size <= left:
            found[body] = shapes
            left -= size
    return found


def _of_urdf(file: Path) -> dict[str, tuple[Shape, ...]]:
    robot = parsed(checked(file, strict=False)[0])
    names = names_of("link", [link.name for link in robot.links], strict=False)
    return {
        names[link.name]: tuple(_shapes(link.visuals, file))
        or tuple(_shapes(link.collisions, file))
        for link in robot.links
    }


def _of_mjcf(file: Path) -> dict[str, tuple[Shape, ...]]:
    found: dict[str, tuple[Shape, ...]] = {}
    for geom in geoms_of(file):
        if geom.solid:
            mesh = replace(of_solid(geom.solid, geom.sizes), round=False)
        else:
            mesh = Mesh(np.array(geom.vertices), np.array(geom.faces, dtype=np.int64), flat=True)
        shape = Shape(mesh.moved(geom.position, np.array(geom.rotation).T))
        found[geom.body] = (*found.get(geom.body, ()), shape)
    return found


_READERS = {catalogue.URDF: _of_urdf, catalogue.MJCF: _of_mjcf}
"""What reads the shapes of a file, by how its name ends."""


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
