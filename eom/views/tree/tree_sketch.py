"""Sketch of a tree of bodies at its start, with the forces and torques that act on the bodies.

A tree at its start in numbers: where its bodies and the frames of its joints are.

The frames of a tree at its start: the ground's and those of the bodies, with labelled axes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import sympy as sp

from eom.multibody.algebra.scalars import Numbers, is_zero
from eom.multibody.algebra.values import is_number
from eom.multibody.files.scene import TreeScene, start_values
from eom.multibody.files.sections import Reading
from eom.multibody.model.constraints import Distance, KnifeEdge, Loop, Rolling
from eom.multibody.model.model import GROUND, Constraint, Joint, Tree
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.motion import places, poses
from eom.views.animation.equivalents import equivalent
from eom.views.animation.tracks import STRUCTURE, from_third, matrices, without_forces
from eom.views.body.body_sketch import (
    FORCE,
    force,
    hang,
    marked,
    number,
    numbers,
    push,
    torque,
    unit,
)
from eom.views.body.frame_sketches import SPACE
from eom.views.draw.lettering import formula, name, plain
from eom.views.draw.picture import (
    Arrow,
    Curve,
    Floats,
    Item,
    Marks,
    Panel,
    Picture,
    Surface,
    check,
    placed,
)
from eom.views.draw.printed import solid
from eom.views.draw.viewpoint import CROWDED, best_view, names, paper

FLOATS = Numbers(math.sin, math.cos)


@dataclass(frozen=True, eq=False)
class Place:
    """Where a frame is: C of shape (3, 3) from the ground's axes to its own; its origin (m), shape (3,)."""

    C: Floats
    origin: Floats

    def point(self, position: Floats) -> Floats:
        """Return a point of the body, given in its axes, in the ground's."""
        return np.asarray(self.origin + position @ self.C)


@dataclass(frozen=True)
class Posture:
    """A tree and the value of every symbol at the start, by name."""

    tree: Tree
    known: Mapping[str, float]

    @classmethod
    def of(cls, scene: TreeScene) -> Self:
        """Return the posture of a scene at its start. Raises `InputError` as the scene does."""
        states = start_values(scene.tree, Reading(scene))
        inputs = {n: v.value for n, v in scene.inputs.items()}
        return cls(scene.tree, {**scene.numbers, **inputs, **states, "t": 0.0})

    def lift(self, given: Any) -> Any:
        """Return a number; 0, 1 and -1 stay what they are."""
        if is_number(given) and given in STRUCTURE:
            return int(given)
        return number(given, self.known)

    @cached_property
    def bones(self) -> LumpedTree:
        """The parts, whose frames all turn with them; every joint leads to one."""
        bare, names = without_forces(self.tree), [b.name for b in self.tree.bodies]
        fixed = [j.name for j in self.tree.joints if j.kind == "fixed"]
        return lumped_tree(bare, self.lift, FLOATS, names, apart=fixed)

    @cached_property
    def joints(self) -> dict[str, tuple[Place, tuple[Floats, ...]]]:
        """For each joint its frame on the child, and what each speed adds to the child's motion.

        Of shape (2, 3) in the ground's axes: angular velocity, velocity of the frame's origin.
        """
        q: list[Any] = []
        for joint in self.tree.ordered:
            given = joint.motion.position if joint.motion else [c.symbol for c in joint.coordinates]
            q += [self.lift(x) for x in given]
        placed = places(self.bones, q, FLOATS)
        found = {}
        for place, (C, origin) in zip(placed, poses(placed, FLOATS), strict=True):
            here = Place(np.array(C, dtype=np.float64), np.array(origin, dtype=np.float64))
            columns = tuple(
                np.array([list(column.angular), list(column.linear)], dtype=np.float64) @ here.C
                for column in place.subspace
            )
            found[place.part.joint] = here, columns
        return found

    @cached_property
    def bodies(self) -> dict[str, Place]:
        """The frame of each body, and that of the ground."""
        found = {GROUND: Place(np.eye(3), np.zeros(3))}
        for joint in self.tree.ordered:
            found[joint.child] = self._body(joint)
        return found

    def _body(self, joint: Joint) -> Place:
        frame, _ = self.joints[joint.name]
        F = numbers(joint.on_child.rotation, self.known)
        C = F.T @ frame.C
        return Place(C, frame.origin - numbers(joint.on_child.position, self.known) @ C)

    def centre(self, body: str) -> Floats:
        """Return the centre of mass of a body in the ground's axes (m)."""
        own = numbers(self.tree.body[body].centre, self.known)
        return self.bodies[body].point(own)

    def on_body(self, body: str, position: Any) -> Floats:
        """Return a point of a body, given as the tree gives it, in the ground's axes (m)."""
        return self.bodies[body].point(numbers(position, self.known))


MOST_NAMED, MOST_WEIGHED = 16, 6
"""Bodies with names, and bodies whose weights have names."""


class TreeSketch(Posture):
    """A posture with its size."""

    @cached_property
    def places(self) -> Floats:
        """All points that matter: origins, joints, centres of mass."""
        found = [self.centre(b.name) for b in self.tree.bodies]
        found += [p.origin for p in self.bodies.values()]
        found += [frame.origin for frame, _ in self.joints.values()]
        return np.array(found)

    @cached_property
    def size(self) -> float:
        """The largest distance from the middle of the places, or the size of the bodies (m)."""
        low, high = self.places.min(axis=0), self.places.max(axis=0)
        solids = (v.vertices for v in self.shapes if isinstance(v, Surface))
        spans = [high - low, *(np.ptp(v, axis=0) for v in solids)]
        return max(0.5 * float(np.linalg.norm(span)) for span in spans) or 1.0

    @cached_property
    def shapes(self) -> list[Item]:
        """The bodies as uniform solids of the same mass and inertia, about their centres of mass."""
        found: list[Item] = []
        for body in self.tree.bodies:
            J, m = numbers(body.central_inertia, self.known), float(numbers(body.mass, self.known))
            if m > 0 and np.any(J):
                mesh = equivalent(J, m).mesh
                found += solid(mesh, self.bodies[body.name].C, self.centre(body.name))
        return found

    @cached_property
    def upright(self) -> Floats:
        """The rotation of the sketch that takes what is up to the third axis, by whole axes if it can."""
        up = -self.down
        for k in range(3):
            if up[k] > 1 - 1e-9:
                return np.roll(np.eye(3), 2 - k, axis=0)
        return matrices(from_third(up)) if np.any(up) else np.eye(3)

    @cached_property
    def down(self) -> Floats:
        """The direction of gravity, zero without."""
        g = unit(numbers(self.tree.gravity, self.known))
        return np.zeros(3) if g is None else g


def tree_sketch(scene: TreeScene) -> Picture:
    """Return the sketch of a tree at its start: bodies, centres of mass, joints, and what acts on them.

    ``scene``: its tree, numbers and start. Bodies are drawn to scale (m) as uniform solids of the same
    mass and inertia; lengths of arrows say nothing. Weights act at centres of mass; at joints stand
    torques and forces on the child by springs, dampers and motors, with their sense at the start;
    reactions of the ground at joints and contacts are drawn against gravity, as their direction is not
    known. Springs between points are dotted, rods dashed. Raises `InputError` as the scene does whose
    numbers make no tree.

    >>> import eom
    >>> tree_sketch(eom.load_scene("double-pendulum")).caption.split(", ")[0]
    'Forces and torques on 2 bodies at the start'
    """
    s = TreeSketch.of(scene)
    items: list[Item] = [*s.shapes]
    for body in s.tree.bodies:
        items += _body(s, body.name)
    for joint in s.tree.ordered:
        items += _joint(s, joint)
    for constraint in s.tree.constraints:
        items += _constraint(s, constraint)
    items += [*_springs(s), *_loads(s), *_rotors(s)]
    items = [upright(item, s.upright) for item in items]
    view = best_view((), items, CROWDED)
    if len(s.tree.bodies) <= MOST_NAMED:
        centres = {plain(b.name): s.upright @ s.centre(b.name) for b in s.tree.bodies}
        items += names(centres, items, view, 0.17 * s.size)
    items += [*_ground(s, items, view)]
    panel = Panel(tuple(items), SPACE, equal=True, bare=True, height=1.4, view=view)
    return check(Picture(((panel,),), plain(scene.title or scene.name), _told(s)))


def upright(item: Item, R: Floats) -> Item:
    """Return an item of a sketch, turned."""
    if isinstance(item, Curve | Marks):
        return replace(item, points=item.points @ R.T)
    if isinstance(item, Arrow):
        return replace(item, start=R @ item.start, end=R @ item.end)
    if isinstance(item, Surface):
        return replace(item, vertices=item.vertices @ R.T)
    return replace(item, place=R @ item.place)


def _told(s: TreeSketch) -> str:
    count = len(s.tree.bodies)
    held = ", ".join(c.name for c in s.tree.constraints)
    words = (
        f"Forces and torques on {count} {'bodies' if count > 1 else 'body'} at the start, drawn as "
        "uniform solids of the same inertia."
    )
    return words + (f" Bound by {held}." if held else "")


def _ground(s: TreeSketch, items: list[Item], view: tuple[float, float]) -> Iterator[Item]:
    """Yield the directions of the ground's axes, at the lower left of all else."""
    across, up = paper(view)
    points = np.concatenate([np.reshape(a, (-1, 3)) for item in items for a in placed(item)])
    left, low = float(np.nanmin(points @ across)), float(np.nanmin(points @ up))
    corner = (left - 0.45 * s.size) * across + (low + 0.1 * s.size) * up
    for k, letter in enumerate("xyz"):
        end = corner + 0.35 * s.size * s.upright[:, k]
        yield Arrow(corner, end, "black", 1.6, f"${letter}$")


def _body(s: TreeSketch, body: str) -> Iterator[Item]:
    """Yield the bones of a body, its centre of mass with its name, and its weight."""
    centre, origin = s.centre(body), s.bodies[body].origin
    ends = [s.joints[j.name][0].origin for j in s.tree.ordered if j.parent == body]
    for end in (*ends, origin):
        yield Curve(np.stack([centre, end]), "grey", 2.0)
    yield Marks(centre[None], size=6.0)
    m = s.tree.body[body].mass
    if not is_zero(m):
        letter = name(str(m)) if isinstance(m, sp.Symbol) else name(f"m_{body}")
        named = len(s.tree.bodies) <= MOST_WEIGHED
        weight = f"${letter.strip('$')}\\,g$" if named else ""
        yield from force(centre, s.down, 0.4 * s.size, weight)


def _joint(s: TreeSketch, joint: Joint) -> Iterator[Item]:
    """Yield a joint's point, what acts through it on the child, and the reaction of the ground."""
    frame, columns = s.joints[joint.name]
    if joint.kind == "free":
        return
    yield Marks(frame.origin[None], "blue", 5.0)
    if joint.parent == GROUND and np.any(s.down):
        words = f"$R_{{{name(joint.name).strip('$')}}}$"
        standing = float((s.centre(joint.child) - frame.origin) @ s.down) < -0.01 * s.size
        draw = push if standing else hang
        yield from draw(frame.origin, -s.down, 0.45 * s.size, words)
    for k, (angular, linear) in enumerate(columns):
        law = _law(joint, k)
        if is_zero(law):
            continue
        sense = -1.0 if float(numbers(law, s.known)) < 0 else 1.0
        words = formula(sp.sympify(law, strict=True), _kind_of_law(joint, k))
        draw, way = (torque, angular) if np.any(angular) else (force, linear)
        yield from draw(frame.origin, sense * way, 0.4 * s.size, words)


def _law(joint: Joint, k: int) -> sp.Expr | int:
    """Return what springs, dampers, motors and applied forces do along speed k, on the child."""
    coordinate = joint.row.paired(joint.attitude)[k] if joint.motion is None else None
    law = sp.sympify(0)
    if coordinate is not None:
        law -= joint.stiffness[k] * (joint.coordinates[coordinate].symbol - joint.rest[k])
    if joint.motion is None:
        law -= joint.damping[k] * joint.speeds[k].symbol
    law += joint.force[k] + (joint.motors[k].symbol if joint.motors else 0)
    return 0 if law == 0 else law


def _kind_of_law(joint: Joint, k: int) -> str:
    given = (("spring", joint.stiffness), ("damper", joint.damping), ("load", joint.force))
    words = [word for word, values in given if not is_zero(values[k])]
    return ", ".join(words + ["motor"] * bool(joint.motors))


def _constraint(s: TreeSketch, c: Constraint) -> Iterator[Item]:
    away = 0.1 * s.size * np.array([0.6, 0.6, 0.6])
    if isinstance(c, Loop):
        yield from marked(s.on_body(c.first, c.on_first.position), plain(c.name), away, "green")
    elif isinstance(c, Distance):
        ends = s.on_body(c.first, c.first_point), s.on_body(c.second, c.second_point)
        yield Curve(np.stack(ends), "green", 1.8, "dashed", plain(c.name))
    elif isinstance(c, Rolling):
        yield from _contact(s, c)
    elif isinstance(c, KnifeEdge):
        point, across = s.on_body(c.body, c.point), numbers(c.direction, s.known)
        way = across @ s.bodies[c.body].C
        yield from push(point, way, 0.4 * s.size, f"$R_{{{name(c.name).strip('$')}}}$")


def _contact(s: TreeSketch, c: Rolling) -> Iterator[Item]:
    """Yield the point of contact of a wheel or ball, the plane round it, and the plane's reaction."""
    normal = numbers(c.normal, s.known)
    towards = -normal
    if c.axis is not None:
        axis = numbers(c.axis, s.known) @ s.bodies[c.body].C
        towards = towards - axis * (axis @ towards)
    way = unit(towards)
    point = s.on_body(c.body, c.centre) + float(numbers(c.radius, s.known)) * (
        -normal if way is None else way
    )
    across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    sides = 0.7 * s.size * np.stack([across, np.cross(normal, across)]) / np.linalg.norm(across)
    corners = point + np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ sides
    yield Surface(corners, np.array([[0, 1, 2], [0, 2, 3]]), "grey", 0.15)
    yield Marks(point[None], "green", 6.0)
    yield from push(point, normal, 0.45 * s.size, f"$R_{{{name(c.name).strip('$')}}}$")


def _springs(s: TreeSketch) -> Iterator[Item]:
    for spring in s.tree.springs:
        ends = np.stack(
            [s.on_body(b, p) for b, p in zip(spring.bodies, spring.points, strict=True)]
        )
        yield Curve(ends, FORCE, 2.0, "dotted")
        yield from marked(ends.mean(axis=0), plain(spring.name), np.zeros(3), FORCE)


def _loads(s: TreeSketch) -> Iterator[Item]:
    for load in s.tree.loads:
        C = s.bodies[load.body].C if load.axes == "body" else np.eye(3)
        point, length = s.on_body(load.body, load.point), 0.4 * s.size
        label = name(load.body).strip("$")
        yield from force(point, numbers(load.force, s.known) @ C, length, f"$F_{{{label}}}$")
        yield from torque(point, numbers(load.torque, s.known) @ C, length, f"$M_{{{label}}}$")


def _rotors(s: TreeSketch) -> Iterator[Item]:
    for rotor in s.tree.rotors:
        centre, axis = s.centre(rotor.body), numbers(rotor.axis, s.known) @ s.bodies[rotor.body].C
        words = plain(rotor.name)
        yield Arrow(centre, centre + 0.4 * s.size * axis, "blue", 1.8, words, "axis of a rotor")


COLOURS = ("blue", "red", "green", "purple", "orange", "sky", "grey")
MOST_INDEXED = 6
"""Bodies whose axes have the body's name as an index; of more, the names stand at the origins alone."""


def tree_frames(scene: TreeScene) -> Picture:
    """Return the axes x, y, z of the ground (black) and of all bodies at the start, at their origins.

    ``scene``: its tree, numbers and start. Grey lines lead along the bodies from joint to joint. What is up
    by gravity is drawn upwards; lengths of axes say nothing. Raises `InputError` as the scene does.

    >>> import eom
    >>> tree_frames(eom.load_scene("double-pendulum")).caption
    'The frames of the ground and of 2 bodies at the start.'
    """
    s = TreeSketch.of(scene)
    items: list[Item] = [*_bones(s), *_axes(s, GROUND, "black", "")]
    for k, body in enumerate(s.tree.bodies):
        index = body.name if len(s.tree.bodies) <= MOST_INDEXED else ""
        items += _axes(s, body.name, COLOURS[k % len(COLOURS)], index)
    items = [upright(item, s.upright) for item in items]
    view = best_view((), items, CROWDED)
    if len(s.tree.bodies) > MOST_INDEXED:
        origins = {plain(b.name): s.upright @ s.bodies[b.name].origin for b in s.tree.bodies}
        items += names(origins, items, view, 0.15 * s.size)
    panel = Panel(tuple(items), SPACE, equal=True, bare=True, height=1.4, view=view)
    told = f"The frames of the ground and of {len(s.tree.bodies)} bodies at the start."
    return check(Picture(((panel,),), plain(scene.title or scene.name), told))


def _bones(s: TreeSketch) -> Iterator[Item]:
    for joint in s.tree.ordered:
        frame, _ = s.joints[joint.name]
        if joint.kind != "free":
            for body in (joint.parent, joint.child):
                yield Curve(np.stack([s.bodies[body].origin, frame.origin]), "grey", 1.5)
            yield Marks(frame.origin[None], "grey", 5.0)


def _axes(s: TreeSketch, body: str, colour: str, index: str) -> Iterator[Item]:
    """Yield the three axes of a body; a longer set is the ground's."""
    place, length = s.bodies[body], (0.55 if body == GROUND else 0.4) * s.size
    below = f"_{{{name(index).strip('$')}}}" if index else ""
    for axis, letter in zip(place.C, "xyz", strict=True):
        words = f"${letter}{below}$" if index or body == GROUND else ""
        yield Arrow(place.origin, place.origin + length * axis, colour, 1.8, words)
