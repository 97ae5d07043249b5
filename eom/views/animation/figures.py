"""What the bodies of a scene look like: the shapes it names, or uniform bodies of equal inertia.

Lengths in m, in the axes of the body, from its origin; of one body from its centre of mass, or the fixed
point of its weight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eom.opening import AnyScene
from eom.scenes.description import inertia_values, principal_values
from eom.scenes.scene import Scene
from eom.views.animation.equivalents import FLAT, Shape, central, equivalent, wheel
from eom.views.draw.solid_meshes import of_solid

Floats = NDArray[np.float64]

BODY_AXES = ("b₁", "b₂", "b₃")
SPUN_AXES = ("c₁", "b₂", "c₃")
"""Names of the axes fixed in a spinner, beside B, which does not spin with it."""


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
    """The bodies in the order of `eom.views.animation.tracks.Tracks`, what stands on the ground, lines
    between."""

    bodies: tuple[Figure, ...]
    ground: tuple[Shape, ...] = ()
    links: tuple[Line, ...] = ()


def figures_of(scene: AnyScene, robot: dict[str, tuple[Shape, ...]] | None = None) -> Figures:
    """Return what the bodies of a scene look like; ``robot``: shapes of links that a file names."""
    if isinstance(scene, Scene):
        return Figures((_one(scene),))
    from eom.views.animation.tree_figures import figures_of_tree

    return figures_of_tree(scene, robot or {})


def _one(scene: Scene) -> Figure:
    spinner, name = scene.model == "spinner", scene.title or scene.name
    axis = 1 if spinner else 2
    axes = SPUN_AXES if spinner else BODY_AXES
    if scene.body.solid is not None:
        solid, sizes = scene.body.solid, scene.body.size
        mesh = of_solid(solid, sizes).moved((0, 0, 0), np.roll(np.eye(3), axis - 2, axis=0))
        told = ", ".join(f"{n} {v:g} m" for n, v in sizes.items())
        return _tipped(Figure(name, (Shape(mesh),), f"{solid} of the scene ({told})", axes), axis)
    J = inertia_values(scene)
    inertia = np.array(J) if J is not None else np.diag(principal_values(scene))
    if scene.torque.weight is not None:
        return _tipped(_held(name, inertia, scene), axis)
    found = equivalent(inertia)
    unknown = "; its size is not known, as the scene says no mass"
    if spinner and found.sizes.get("length", 1) < FLAT * found.sizes.get("radius", 1):
        words = f"wheel{unknown}"
        return _tipped(Figure(name, wheel(found.sizes["radius"], axis), words, axes), axis)
    return _tipped(Figure(name, (Shape(found.mesh),), found.words + unknown, axes), axis)


def _held(name: str, inertia: Floats, scene: Scene) -> Figure:
    """Return a body with weight about its fixed point, and a stalk from there to its centre of mass."""
    weight = scene.torque.weight
    assert weight is not None
    r = np.array(weight.centre_of_mass)
    found = central(inertia, weight.mass, r)
    if found is None:
        body = equivalent(inertia, weight.mass)
        return Figure(name, (Shape(body.mesh),), f"about the fixed point: {body.words}")
    body = equivalent(found, weight.mass)
    stalk = rod((0, 0, 0), r, 0.02 * body.mesh.extent)
    return Figure(name, (Shape(body.mesh.moved(r)), *stalk), body.words)


def _tipped(figure: Figure, axis: int) -> Figure:
    """Return a figure with its tip on an axis of the body, a little outside of it."""
    return replace(figure, tip=1.15 * figure.extent * np.eye(3)[axis])


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
