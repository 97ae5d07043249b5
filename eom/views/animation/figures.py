"""What the bodies of a scene look like: the shapes it names, or uniform bodies of equal inertia.

Lengths in m, in the axes of the body, from its origin; of one body from its centre of mass, or the fixed
point of its weight.

What the bodies of a tree look like: solids and shapes that are named, else of equal inertia; joints.

Bones, thin rods in a body, lead from its joint to those that hang on it. A body that others are inside of
is drawn so that one sees through it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eom.multibody.algebra.values import is_number
from eom.multibody.files.scene import TreeScene
from eom.multibody.files.sections import Reading
from eom.multibody.model.constraints import Distance, Loop
from eom.multibody.model.model import GROUND, Body, Joint, Rotor
from eom.opening import AnyScene
from eom.scenes.description import inertia_values, principal_values
from eom.scenes.scene import Scene
from eom.views.animation.equivalents import FLAT, Shape, central, equivalent, wheel
from eom.views.draw.solid_meshes import Mesh, of_solid

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
    """The bodies in the order of `tracks.Tracks`, what stands on the ground, lines between."""

    bodies: tuple[Figure, ...]
    ground: tuple[Shape, ...] = ()
    links: tuple[Line, ...] = ()


def figures_of(scene: AnyScene, robot: dict[str, tuple[Shape, ...]] | None = None) -> Figures:
    """Return what the bodies of a scene look like; ``robot``: shapes of links that a file names."""
    if isinstance(scene, Scene):
        return Figures((_one(scene),))

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


BONE, PIN, HINGE, POINT, ROTOR = 0.008, 0.016, 0.05, 0.12, 0.1
"""Radius of bones and joints, length of a hinge, side of a body without inertia, radius of a rotor: as
shares of the tree's reach."""
GLASS = 0.3
"""Opacity of a body that others are inside of."""


def figures_of_tree(scene: TreeScene, robot: Mapping[str, tuple[Shape, ...]]) -> Figures:
    """Return the bodies, then the rotors; ``robot``: shapes of bodies by name, which come first."""
    drawing = Drawing(scene, robot)
    bodies = tuple(drawing.body(b) for b in scene.tree.bodies)
    rotors = tuple(drawing.rotor(r) for r in scene.tree.rotors)
    shown = (*map(drawing.seen_through, bodies), *rotors)
    return Figures(shown, drawing.held_by(GROUND), tuple(drawing.lines()))


@dataclass(frozen=True)
class Drawing:
    """A tree in numbers."""

    scene: TreeScene
    robot: Mapping[str, tuple[Shape, ...]]

    @cached_property
    def known(self) -> dict[Any, float]:
        """The values of parameters by symbol."""
        symbols = {q.name: q.symbol for q in self.scene.tree.parameters}
        return {symbols[n]: v for n, v in self.scene.numbers.items() if n in symbols}

    def number(self, given: Any) -> float:
        """Return the value of a number or expression over parameters."""
        return float(given) if is_number(given) else float(given.subs(self.known))

    def array(self, given: Any) -> Floats:
        """Return the values of a vector or matrix."""
        nested = [[self.number(x) for x in row] if isinstance(row, list | tuple) else
                  self.number(row) for row in given]  # fmt: skip
        return np.array(nested, dtype=np.float64)

    @cached_property
    def places(self) -> dict[str, list[Floats]]:
        """For each body and the ground: where other joints are on it, from its origin."""
        found: dict[str, list[Floats]] = {
            GROUND: [],
            **{b.name: [] for b in self.scene.tree.bodies},
        }
        for joint in self.scene.tree.joints:
            found[joint.parent].append(self.array(joint.on_parent.position))
        for loop in (c for c in self.scene.tree.constraints if isinstance(c, Loop)):
            found[loop.first].append(self.array(loop.on_first.position))
            found[loop.second].append(self.array(loop.on_second.position))
        return found

    @cached_property
    def reach(self) -> float:
        """The largest length (m) in a body, which sizes of joints follow."""
        lengths = [float(np.linalg.norm(p)) for places in self.places.values() for p in places]
        lengths += [float(np.linalg.norm(self.array(b.centre))) for b in self.scene.tree.bodies]
        lengths += [0.5 * s.mesh.extent for b in self.scene.tree.bodies for s in self.own(b)[0]]
        return float(max([x for x in lengths if x > 0], default=1.0))

    def own(self, body: Body) -> tuple[tuple[Shape, ...], str]:
        """Return the shapes of a body that the scene, or its inertia, gives, and how they were found."""
        if self.robot.get(body.name):
            return self.robot[body.name], "shapes of the file"
        part = self.scene.bodies.get(body.name)
        centre, axes = self.array(body.centre), self.array(body.axes).T
        if part is not None and part.solid is not None:
            mesh = of_solid(part.solid, self._sizes(part.size))
            return (Shape(mesh.moved(centre, axes)),), f"{part.solid} of the scene"
        J, m = self.array(body.central_inertia), self.number(body.mass)
        if m <= 0 or not np.any(J):
            return (), ""
        found = equivalent(J, m)
        return (Shape(found.mesh.moved(centre)),), found.words

    def _sizes(self, sizes: Mapping[str, Any]) -> dict[str, float]:
        read = Reading(self.scene).constants
        return {n: self.number(read.value(v, n)) for n, v in sizes.items()}

    def body(self, body: Body) -> Figure:
        """Return a body with its bones and its joint."""
        shapes, words = self.own(body)
        if not shapes and self.number(body.mass) > 0:
            a = POINT * self.reach
            box = of_solid("box", {"a": 2 * a, "b": a, "c": a})
            shapes, words = (Shape(box.moved(self.array(body.centre))),), "point mass, as a box"
        joint = self.scene.tree.joint_of[body.name]
        start = self.array(joint.on_child.position)
        bones = [s for end in self.places[body.name]
                 for s in rod(start, end, BONE * self.reach)]  # fmt: skip
        figure = Figure(body.name, (*shapes, *bones, *self.pin(joint)), words)
        return replace(figure, tip=self._tip(body))

    def _tip(self, body: Body) -> Floats:
        """Return the end of a body: the joint on it, or twice its centre of mass, that is farthest."""
        start = self.array(self.scene.tree.joint_of[body.name].on_child.position)
        ends = [*self.places[body.name], 2 * self.array(body.centre) - start]
        return max(ends, key=lambda p: float(np.linalg.norm(p - start)))

    def pin(self, joint: Joint) -> tuple[Shape, ...]:
        """Return what is drawn of a joint, on its child: a hinge along its axis, a ball; or nothing."""
        place, turn = self.array(joint.on_child.position), self.array(joint.on_child.rotation).T
        radius = PIN * self.reach
        if joint.kind in {"revolute", "cylindrical", "helical"}:
            half = turn @ self.array(joint.axis) * HINGE * self.reach / 2
            return rod(place - half, place + half, radius, "black")
        if joint.kind in {"spherical", "universal"}:
            ball = of_solid("sphere", {"radius": 1.5 * radius})
            return (Shape(replace(ball.moved(place), round=False), "black"),)
        return ()

    def held_by(self, name: str) -> tuple[Shape, ...]:
        """Return what is drawn on the ground: rails of sliding joints, stands of the others."""
        found: list[Shape] = []
        for joint in self.scene.tree.joints:
            place, turn = (
                self.array(joint.on_parent.position),
                self.array(joint.on_parent.rotation).T,
            )
            if joint.parent != name:
                continue
            if joint.kind == "prismatic":
                axis = turn @ self.array(joint.axis) * 3 * self.reach
                found += rod(place - axis, place + axis, BONE * self.reach)
            elif joint.kind not in {"free", "fixed", "planar"}:
                ball = of_solid("sphere", {"radius": 2.2 * PIN * self.reach})
                found.append(Shape(replace(ball.moved(place), round=False), "grey"))
        return tuple(found)

    def lines(self) -> Iterator[Line]:
        """Yield springs, and rods without mass that keep a distance."""
        number = {GROUND: -1, **{b.name: k for k, b in enumerate(self.scene.tree.bodies)}}
        ends = [(s.bodies, s.points) for s in self.scene.tree.springs]
        ends += [((c.first, c.second), (c.first_point, c.second_point))
                 for c in self.scene.tree.constraints if isinstance(c, Distance)]  # fmt: skip
        for (first, second), (p, q) in ends:
            yield Line((number[first], number[second]), (self.array(p), self.array(q)))

    def rotor(self, rotor: Rotor) -> Figure:
        """Return a flat cylinder about its axis, which is the third of its own axes."""
        radius = ROTOR * self.reach
        mesh = of_solid("cylinder", {"radius": radius, "length": radius / 2})
        return Figure(rotor.name, (Shape(mesh),), "rotor; its size is not known")

    def seen_through(self, figure: Figure) -> Figure:
        """Return a body that one sees through if others, or rotors, are wholly inside of a shape of it."""
        count = len(self.own(self.scene.tree.body[figure.name])[0])
        inner = list(self._inside(figure.name))

        def hides(mesh: Mesh) -> bool:
            low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
            return any(bool(np.all((p - e > low) & (p + e < high))) for p, e in inner)

        glass = [replace(s, opacity=GLASS) if k < count and hides(s.mesh) else s
                 for k, s in enumerate(figure.shapes)]  # fmt: skip
        return replace(figure, shapes=tuple(glass))

    def _inside(self, name: str) -> Iterator[tuple[Floats, float]]:
        """Yield where bodies and rotors are on a body, and how large they are."""
        tree = self.scene.tree
        for joint in (j for j in tree.joints if j.parent == name):
            shapes = self.own(tree.body[joint.child])[0]
            if shapes:
                yield self.array(joint.on_parent.position), max(s.mesh.extent for s in shapes)
        if any(rotor.body == name for rotor in tree.rotors):
            yield self.array(tree.body[name].centre), ROTOR * self.reach
