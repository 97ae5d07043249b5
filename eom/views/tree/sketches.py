"""Sketches of a scene at its start: its bodies, its frames, and the forces and torques that act.

Bodies are those of animations, most of them uniform ones of the same inertia; forces and torques are
arrows, with the numbers and formulas that they come from. A torque's arrow is along it, by the right-hand
rule, with a ring that turns the way that it turns. Lengths of arrows say nothing of sizes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial, singledispatch
from typing import Any

import numpy as np
import sympy as sp

from eom.mechanics.torques import Torque
from eom.multibody.algebra.scalars import is_zero
from eom.multibody.files.scene import TreeScene
from eom.multibody.model.bodies import GROUND, Joint
from eom.multibody.model.constraints import Distance, KnifeEdge, Loop, Rolling
from eom.multibody.model.jets import rates
from eom.multibody.model.model import Constraint, Tree
from eom.multibody.recursion.motion import places
from eom.multibody.system.vectors import GRADIENT, WEIGHT, vectors_of
from eom.opening import AnyScene
from eom.scenes.assembly import torques_of
from eom.views.animation.bodies import Bodies, Drawing, ManyBodies, OneBody, at_start, bodies_of
from eom.views.animation.figures import central, equivalent, on_its_tip
from eom.views.animation.posture import ARRAYS, Posture, filled, number, numbers
from eom.views.animation.tracks import from_third, matrices
from eom.views.body.frame_sketches import SPACE, Frame, arc_points, triads
from eom.views.draw.formulas import formula, name, short
from eom.views.draw.meshes import Mesh
from eom.views.draw.picture import (
    Arrow,
    Curve,
    Floats,
    Item,
    Marks,
    Panel,
    Picture,
    Surface,
    Words,
    check,
    placed,
)
from eom.views.draw.printed import solid
from eom.views.draw.viewpoint import CROWDED, best_view, names, paper

MOST_NAMED, MOST_WEIGHED = 16, 6
"""Bodies with names, and bodies whose weights have names."""


@dataclass(frozen=True, eq=False)
class Sketch:
    """What a sketch of a scene shows, in words, its ``caption``, too.

    ``axles``: axes that it is best not seen from the side of. ``points``: places by the names that are put
    where there is room, ``away`` from them. ``corner``: the axes of the ground as they are drawn at the
    lower left of all else, rows of (3, 3), None where they are not; ``down``: the way of gravity there.
    """

    items: Sequence[Item]
    caption: str
    axles: Sequence[Floats] = ()
    points: Mapping[str, Floats] = field(default_factory=dict)
    away: float = 0.0
    corner: Floats | None = None
    down: Floats | None = None
    height: float = 1.4


def sketch(scene: AnyScene) -> Picture:
    """Return the sketch of a scene at its start: bodies, centres of mass, joints, and what acts on them.

    Parameters
    ----------
    scene : Scene or TreeScene
        Of any model.

    Returns
    -------
    Picture
        Bodies are drawn as uniform solids of the same mass and inertia; lengths of arrows say
        nothing.

    Raises
    ------
    InputError
        As the scene does whose numbers make no body or tree.

    Notes
    -----
    Of one body nothing is to scale. The reference frame has the axes a, the body (a spinner's frame
    that does not spin) the axes b. Weight acts at the centre of mass G along -a3, with the reaction
    of the fixed point O; torque by components has an arrow along each of them, its sense that at
    the start; a gravity gradient one along its torque at the start. What acts together is drawn
    together.

    A tree is drawn to scale (m). Weights act at centres of mass; at joints stand torques and forces
    on the child by springs, dampers and motors, with their sense at the start; reactions of the
    ground at joints and contacts are drawn against gravity, as their direction is not known.
    Springs between points are dotted, rods dashed.

    Examples
    --------
    >>> import eom
    >>> sketch(eom.load_scene("heavy-top")).caption.split(". ")[1]
    'Its weight acts at the centre of mass G, a reaction at the fixed point O.'
    >>> sketch(eom.load_scene("double-pendulum")).caption.split(", ")[0]
    'Forces and torques on 2 bodies at the start'
    """
    return _picture(scene, _of(bodies_of(scene)))


def _picture(scene: AnyScene, s: Sketch) -> Picture:
    items = list(s.items)
    view = best_view(s.axles, items, CROWDED)
    items += names(s.points, items, view, s.away)
    if s.corner is not None:
        items += [*_corner(s.corner, s.down, items, view)]
    panel = Panel(tuple(items), SPACE, equal=True, bare=True, height=s.height, view=view)
    return check(Picture(((panel,),), short(scene.title or scene.name), s.caption))


def _corner(
    axes: Floats, down: Floats | None, items: Sequence[Item], view: tuple[float, float]
) -> Iterator[Item]:
    """Yield axes, rows of (3, 3), and gravity, at the lower left of all else, words of arrows included."""
    across, up = paper(view)
    points = np.concatenate([np.reshape(a, (-1, 3)) for item in items for a in placed(item)])
    size = float(np.linalg.norm(axes[0])) / 0.35
    worded = [float(i.end @ across) - 0.3 * size for i in items if isinstance(i, Arrow) and i.words]
    left, low = min([float(np.nanmin(points @ across)), *worded]), float(np.nanmin(points @ up))
    start = (left - 0.45 * size) * across + (low + 0.1 * size) * up
    for axis, letter in zip(axes, "xyz", strict=True):
        yield Arrow(start, start + axis, "black", 1.6, f"${letter}$")
    if down is not None:
        beside = start - 0.3 * size * across + 0.35 * size * up
        yield Arrow(beside, beside + 0.35 * size * down, FORCE, 1.6, r"$\mathbf{g}$")


@singledispatch
def _of(bodies: Bodies) -> Sketch:
    """Return what is sketched of bodies."""
    raise NotImplementedError(bodies)


REACH = 1.0
"""Where one body ends in its sketch; other lengths are in proportion."""
LARGEST = 1.7
"""Size of a body that its fixed point is far away from the surface of."""
FIELD = "gravity_gradient"


@_of.register
def _of_one(bodies: OneBody) -> Sketch:
    s = BodyAtStart(bodies)
    frames = [Frame("b", s.C, "blue", 1.4)]
    if bodies.scene.attitude != "none" or s.spinner:
        frames.insert(0, Frame("a", np.eye(3), "black", 1.9))
    items = [
        *solid(s.mesh.moved(s.centre), s.C, np.zeros(3)),
        *s.stalk,
        *triads(frames),
        *_points(s),
        *_acting(s),
    ]
    return Sketch(items, _caption_of_one(s), s.axles, height=1.3)


@dataclass(frozen=True)
class BodyAtStart:
    """A scene of one body in numbers, at its start."""

    bodies: OneBody

    @cached_property
    def known(self) -> Mapping[str, float]:
        """The values of parameters, inputs and states by name."""
        return {**self.bodies.known, **self.bodies.start, "t": 0.0}

    @cached_property
    def C(self) -> Floats:
        """From the reference frame to the one that torque has its components in."""
        return matrices(self.bodies.turns(at_start(self.bodies))[1][0])

    @property
    def spinner(self) -> bool:
        """Whether the body spins in the frame that is drawn."""
        return self.bodies.scene.model == "spinner"

    @property
    def weight(self) -> Any:
        """The weight of the scene, None without one."""
        return self.bodies.scene.torque.weight

    @cached_property
    def centre(self) -> Floats:
        """The centre of mass in the sketch, from the fixed point, in the body's axes."""
        if self.weight is None:
            return np.zeros(3)
        r = np.array(self.weight.centre_of_mass)
        return REACH * r / (float(np.linalg.norm(r)) or 1.0)

    @cached_property
    def mesh(self) -> Mesh:
        """The body about its centre of mass, its surface through the fixed point if there is one.

        A flat body, which would be too large then, is on a stalk; one that would reach below is a cone.
        """
        J, mass = self.bodies.inertia, self.bodies.scene.body.mass
        if self.weight is not None:
            r, mass = np.array(self.weight.centre_of_mass), self.weight.mass
            about = central(J, mass, r)
            J = J if about is None else about
            cone = None if about is None else on_its_tip(about, mass, r)
            if cone is not None:
                size = REACH / float(np.linalg.norm(r))
                return Mesh(size * (cone.vertices - r), cone.faces, cone.round)
        mesh = equivalent(J, mass).mesh
        way = -self.centre
        reach = float(np.max(mesh.vertices @ way)) / REACH if np.any(way) else mesh.extent
        return Mesh(REACH * mesh.vertices / max(reach, mesh.extent / LARGEST), mesh.faces)

    @property
    def stalk(self) -> list[Item]:
        """A line from the fixed point of a weight to the centre of mass."""
        ends = np.stack([np.zeros(3), self.centre @ self.C])
        return [Curve(ends, "grey", 3.0)] if np.any(self.centre) else []

    @property
    def axles(self) -> list[Floats]:
        """The axis that the body is best not seen from the side of: a spinner's, or a top's."""
        if self.spinner:
            return [self.C[1]]
        return [self.centre @ self.C] if self.weight is not None else []

    @cached_property
    def torques(self) -> dict[str, tuple[Any, ...]]:
        """The components of each torque in the body's axes, by the field that states it."""
        return {n: _expanded(torque) for n, torque in torques_of(self.bodies.scene).items()}

    @property
    def applied(self) -> list[tuple[int, Any]]:
        """The components that are stated and not zero, with the numbers of their axes."""
        return [(k, c) for k, c in enumerate(self.torques["components"]) if c != 0]


def _expanded(torque: Torque) -> tuple[Any, ...]:
    directions = {d.symbol: d.expression for d in torque.directions}
    return tuple(
        sp.sympify(c, strict=True).xreplace(directions) for c in torque.components.components
    )


def _caption_of_one(s: BodyAtStart) -> str:
    acts = []
    if s.weight is not None:
        acts.append("Its weight acts at the centre of mass G, a reaction at the fixed point O.")
    if FIELD in s.torques:
        acts.append("The torque of the gravity gradient acts on it, at the start along the arrow.")
    if s.applied or not acts:
        acts.append(f"{len(s.applied) or 'No'} components of torque act on it.")
    return f"Free-body sketch at the start, not to scale. {' '.join(acts)}"


def _points(s: BodyAtStart) -> Iterator[Item]:
    away = np.array([0.0, 0.0, -0.14])
    yield from marked(s.centre @ s.C, "$G$", away)
    if s.weight is not None:
        yield from support(np.zeros(3), np.array([0.0, 0.0, 1.0]), 0.5)
        yield from marked(np.zeros(3), "$O$", np.array([0.1, -0.1, 0.05]))


def _acting(s: BodyAtStart) -> Iterator[Item]:
    if s.weight is not None:
        down = np.array([0.0, 0.0, -1.0])
        yield from force(s.centre @ s.C, down, 0.8, "$m g$")
        yield from push(np.zeros(3), -down, 0.8, "$R$")
    if FIELD in s.torques:
        way = numbers(s.torques[FIELD], s.known)
        yield from torque(np.zeros(3), way @ s.C, 1.25, r"$\mathbf{M}$")
        yield Arrow(
            np.zeros(3), np.array([-1.75, 0.0, 0.0]), "grey", 1.6, "to the attracting centre"
        )
    for k, component in s.applied:
        yield from _component(s, k, component)


def _component(s: BodyAtStart, k: int, component: Any) -> Iterator[Item]:
    """Yield one component of the torque along its axis; its sense is that at the start."""
    sense = -1.0 if number(component, s.known) < 0 else 1.0
    shown = formula(component, f"$M_{k + 1}$").strip("$")
    bracketed = f"({shown})" if component.is_Add else shown
    yield from torque(np.zeros(3), sense * s.C[k], 1.2, rf"${bracketed}\,\mathbf{{b}}_{k + 1}$")


FORCE, TORQUE, REACTION = "red", "purple", "green"
LEGEND = {FORCE: "force", TORQUE: "torque", REACTION: "reaction"}
HATCHES = 7
"""Lines under the plate of a support."""
RING = 1.6 * math.pi
"""Angle of the ring round a torque."""


def unit(way: Floats) -> Floats | None:
    """Return the unit vector along a vector, None if it is zero."""
    size = float(np.linalg.norm(way))
    return way / size if size > 0 else None


def force(
    point: Floats, way: Floats, length: float, words: str, colour: str = FORCE
) -> Iterator[Item]:
    """Yield the arrow of a force that acts at a point, along a vector of any length."""
    along = unit(way)
    if along is not None:
        yield Arrow(point, point + length * along, colour, 2.4, words, LEGEND[colour])


def push(point: Floats, way: Floats, length: float, words: str) -> Iterator[Item]:
    """Yield the arrow of a reaction whose tip is at the point that it acts on."""
    along = unit(way)
    if along is not None:
        yield from force(point - length * along, along, length, "", REACTION)
        yield Words(point - 1.12 * length * along, words, REACTION)


def torque(point: Floats, way: Floats, length: float, words: str) -> Iterator[Item]:
    """Yield the arrow of a torque along a vector of any length, and its ring."""
    along = unit(way)
    if along is None:
        return
    yield Arrow(point, point + length * along, TORQUE, 2.4, words, LEGEND[TORQUE])
    across = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    radius = 0.16 * length / float(np.linalg.norm(across))
    ring = point + 0.6 * length * along + arc_points(along, radius * across, RING)
    yield Curve(ring, TORQUE, 1.8)
    yield Arrow(ring[-5], ring[-1], TORQUE, 1.8)


def support(point: Floats, up: Floats, size: float) -> Iterator[Item]:
    """Yield what holds a point: a plate of the ground under it, across what is up, hatched below."""
    normal = unit(up)
    if normal is None:
        return
    across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    across /= np.linalg.norm(across)
    sides = 0.5 * size * np.stack([across, np.cross(normal, across)])
    corners = point + np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ sides
    yield Surface(corners, np.array([[0, 1, 2], [0, 2, 3]]), "grey", 0.35)
    places = np.linspace(-0.8, 1.0, HATCHES)[:, None] * sides[0] + point - sides[1]
    feet = places - 0.18 * size * normal - 0.15 * sides[0]
    gaps = np.full_like(places, np.nan)
    yield Curve(np.stack([places, feet, gaps], axis=1).reshape(-1, 3), "grey", 1.0)
    yield Curve(np.concatenate([corners, corners[:1]]), "grey", 1.0)


def marked(point: Floats, words: str, away: Floats, colour: str = "black") -> Iterator[Item]:
    """Yield a dot and its name, which stands ``away`` from it."""
    yield Marks(point[None], colour, 6.0)
    yield Words(point + away, words, colour)


@dataclass(frozen=True, eq=False)
class Place:
    """Where a frame is: C of shape (3, 3) from the ground's axes to its own; its origin (m), shape (3,)."""

    C: Floats
    origin: Floats

    def point(self, position: Floats) -> Floats:
        """Return a point of the body, given in its axes, in the ground's."""
        return np.asarray(self.origin + position @ self.C)


@dataclass(frozen=True)
class TreeAtStart:
    """A tree in numbers, at its start."""

    drawn: ManyBodies

    @property
    def tree(self) -> Tree:
        """Bodies and joints."""
        return self.drawn.scene.tree

    @cached_property
    def known(self) -> Mapping[str, float]:
        """The values of parameters, inputs and states by name."""
        return {**self.drawn.known, **self.drawn.start, "t": 0.0}

    @cached_property
    def bodies(self) -> dict[str, Place]:
        """The frame of each body, and that of the ground."""
        found = {GROUND: Place(np.eye(3), np.zeros(3))}
        for body in self.tree.bodies:
            C, origin = self.posture.pose(body.name)
            found[body.name] = Place(C[0], origin[0])
        return found

    def vector(self, source: str, body: str) -> Floats:
        """Return a vector that acts on a body by a source; zero where none does."""
        own = (v for v in vectors_of(self.tree) if (v.source, v.body) == (source, body))
        found = [v.at(self.posture.moment) for v in own]
        return sum((filled(list(f[0]), 1)[0] for f in found if f is not None), np.zeros(3))

    @cached_property
    def posture(self) -> Posture:
        """Where everything is."""
        return Posture(self.tree, at_start(self.drawn))

    @cached_property
    def joints(self) -> dict[str, tuple[Place, tuple[Floats, ...]]]:
        """For each joint its frame on the child, and what each speed adds to the child's motion.

        Of shape (2, 3) in the ground's axes: angular velocity, velocity of the frame's origin.
        """
        moving = places(self.posture.bones, self.posture.coordinates, ARRAYS)
        subspaces = {place.part.joint: place.subspace for place in moving}
        found = {}
        for joint in self.tree.ordered:
            child, seat = self.bodies[joint.child], joint.on_child
            C = numbers(seat.rotation, self.known) @ child.C
            columns = tuple(
                np.array([list(c.angular), list(c.linear)], dtype=np.float64) @ C
                for c in subspaces.get(joint.name, ())
            )
            found[joint.name] = Place(C, self.on_body(joint.child, seat.position)), columns
        return found

    def centre(self, body: str) -> Floats:
        """Return the centre of mass of a body in the ground's axes (m)."""
        own = numbers(self.tree.body[body].centre, self.known)
        return self.bodies[body].point(own)

    def on_body(self, body: str, position: Any) -> Floats:
        """Return a point of a body, given as the tree gives it, in the ground's axes (m)."""
        return self.bodies[body].point(numbers(position, self.known))

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
    def drawing(self) -> Drawing:
        """What its bodies look like."""
        return Drawing(self.drawn.scene, {}, spokes=False)

    @cached_property
    def shapes(self) -> list[Item]:
        """The bodies as in animations: solids of the scene, what rolls, ones of equal inertia."""
        return [
            item
            for body in self.tree.bodies
            for shape in self.drawing.own(body)[0]
            for item in solid(shape.mesh, self.bodies[body.name].C, self.bodies[body.name].origin)
        ]

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


@_of.register
def _of_many(bodies: ManyBodies) -> Sketch:
    s = TreeAtStart(bodies)
    items: list[Item] = [*s.shapes]
    for body in s.tree.bodies:
        items += _body(s, body.name)
    for joint in s.tree.ordered:
        items += _joint(s, joint)
    for constraint in s.tree.constraints:
        items += _constraint(s, constraint)
    items += [*_springs(s), *_loads(s), *_jets(s), *_rotors(s)]
    centres = {short(b.name): s.upright @ s.centre(b.name) for b in s.tree.bodies}
    return Sketch(
        [upright(item, s.upright) for item in items],
        _caption(s),
        points=centres if len(centres) <= MOST_NAMED else {},
        away=0.17 * s.size,
        corner=0.35 * s.size * s.upright.T,
        down=s.upright @ s.down if np.any(s.down) else None,
    )


def upright(item: Item, R: Floats) -> Item:
    """Return an item of a sketch, turned."""
    if isinstance(item, Curve | Marks):
        return replace(item, points=item.points @ R.T)
    if isinstance(item, Arrow):
        return replace(item, start=R @ item.start, end=R @ item.end)
    if isinstance(item, Surface):
        return replace(item, vertices=item.vertices @ R.T)
    return replace(item, place=R @ item.place)


def _caption(s: TreeAtStart) -> str:
    count = len(s.tree.bodies)
    held = ", ".join(c.name for c in s.tree.constraints)
    told = [s.drawing.own(b)[1] for b in s.tree.bodies]
    alike = all("equal inertia" in t for t in told if t)
    solids = "uniform solids" if alike else "solids of the scene, or uniform ones"
    things = "bodies" if count > 1 else "body"
    drawn = f"drawn as {solids} of the same inertia"
    words = f"Forces and torques on {count} {things} at the start, {drawn}."
    if any(not is_zero(x) for row in s.tree.gravity_gradient for x in row):
        words += " Gravity varies with the position; the torques of its gradient act, too."
    return words + (f" Bound by {held}." if held else "")


def _body(s: TreeAtStart, body: str) -> Iterator[Item]:
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
        yield from force(centre, s.vector(WEIGHT, body), 0.4 * s.size, weight)
        turning = s.vector(GRADIENT, body)
        yield from torque(centre, turning, 0.55 * s.size, f"$M_{{{name(body).strip('$')}}}$")


def _joint(s: TreeAtStart, joint: Joint) -> Iterator[Item]:
    """Yield a joint's point, what acts through it on the child, and the reaction of the ground."""
    frame, columns = s.joints[joint.name]
    if joint.kind == "free":
        return
    yield Marks(frame.origin[None], "blue", 5.0)
    if joint.parent == GROUND:
        yield from support(frame.origin, -s.down if np.any(s.down) else s.upright[2], 0.28 * s.size)
    if joint.parent == GROUND and np.any(s.down):
        words = f"$R_{{{name(joint.name).strip('$')}}}$"
        standing = float((s.centre(joint.child) - frame.origin) @ s.down) < -0.01 * s.size
        draw = push if standing else partial(force, colour=REACTION)
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
    law = sp.S.Zero
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


def _constraint(s: TreeAtStart, c: Constraint) -> Iterator[Item]:
    away = 0.1 * s.size * np.array([0.6, 0.6, 0.6])
    if isinstance(c, Loop):
        yield from marked(s.on_body(c.first, c.on_first.position), short(c.name), away, "green")
    elif isinstance(c, Distance):
        ends = s.on_body(c.first, c.first_point), s.on_body(c.second, c.second_point)
        yield Curve(np.stack(ends), "green", 1.8, "dashed", short(c.name))
    elif isinstance(c, Rolling):
        yield from _contact(s, c)
    elif isinstance(c, KnifeEdge):
        point, across = s.on_body(c.body, c.point), numbers(c.direction, s.known)
        way = across @ s.bodies[c.body].C
        yield from push(point, way, 0.4 * s.size, f"$R_{{{name(c.name).strip('$')}}}$")


def _contact(s: TreeAtStart, c: Rolling) -> Iterator[Item]:
    """Yield the point of contact of a wheel or ball, the plane round it, and the plane's reaction."""
    normal, radius = numbers(c.normal, s.known), float(numbers(c.radius, s.known))
    towards = -normal
    if c.axis is not None:
        axis = numbers(c.axis, s.known) @ s.bodies[c.body].C
        share = float(numbers(c.half_axis, s.known)) / radius
        towards = towards - (1 - share**2) * axis * (axis @ towards)
    size = math.sqrt(max(float(-normal @ towards), 0.0))  # of an ellipsoid, that of a ball is 1
    point = s.on_body(c.body, c.centre) + radius * (towards / size if size > 0 else -normal)
    across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    sides = 0.7 * s.size * np.stack([across, np.cross(normal, across)]) / np.linalg.norm(across)
    corners = point + np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ sides
    yield Surface(corners, np.array([[0, 1, 2], [0, 2, 3]]), "grey", 0.15)
    yield Marks(point[None], "green", 6.0)
    yield from push(point, normal, 0.45 * s.size, f"$R_{{{name(c.name).strip('$')}}}$")


def _springs(s: TreeAtStart) -> Iterator[Item]:
    for spring in s.tree.springs:
        ends = np.stack(
            [s.on_body(b, p) for b, p in zip(spring.bodies, spring.points, strict=True)]
        )
        yield Curve(ends, FORCE, 2.0, "dotted")
        yield from marked(ends.mean(axis=0), short(spring.name), np.zeros(3), FORCE)


def _loads(s: TreeAtStart) -> Iterator[Item]:
    for load in s.tree.loads:
        C = s.bodies[load.body].C if load.axes == "body" else np.eye(3)
        point, length = s.on_body(load.body, load.point), 0.4 * s.size
        label = name(load.body).strip("$")
        yield from force(point, numbers(load.force, s.known) @ C, length, f"$F_{{{label}}}$")
        couple = (
            numbers(load.torque, s.known) @ C
        )  # longer, so that words are not on those of a force
        yield from torque(point, couple, 1.5 * length, f"$M_{{{label}}}$")


def _jets(s: TreeAtStart) -> Iterator[Item]:
    """Yield the thrusts: the rate of each jet times the opposite of its velocity."""
    for body in s.tree.bodies:
        own = [jet for jet in s.tree.jets if jet.body == body.name]
        for jet, rate in zip(own, rates(body, own), strict=True):
            thrust = -float(numbers(rate, s.known)) * numbers(jet.velocity, s.known)
            point = s.on_body(jet.body, jet.point)
            words = f"$F_{{{name(jet.name).strip('$')}}}$"
            yield from force(point, thrust @ s.bodies[jet.body].C, 0.4 * s.size, words)


def _rotors(s: TreeAtStart) -> Iterator[Item]:
    for rotor in s.tree.rotors:
        centre, axis = s.centre(rotor.body), numbers(rotor.axis, s.known) @ s.bodies[rotor.body].C
        words = short(rotor.name)
        yield Arrow(centre, centre + 0.4 * s.size * axis, "blue", 1.8, words, "axis of a rotor")


COLOURS = ("blue", "red", "green", "purple", "orange", "sky", "grey")
BY_LETTER = ("red", "green", "blue")
"""Colours of the axes x, y, z where there are more bodies than colours."""
MOST_INDEXED = 6
"""Bodies whose axes have the body's name as an index; of more, the names stand at the origins alone."""


def tree_frames(scene: TreeScene) -> Picture:
    """Return the axes x, y, z of the ground (black) and of all bodies at the start, at their origins.

    Parameters
    ----------
    scene : TreeScene
        Its tree, numbers and start.

    Returns
    -------
    Picture
        The axes x, y, z of the ground and of all bodies. Grey lines lead along the bodies from
        joint to joint. What is up by gravity is drawn upwards; lengths of axes say nothing.

    Raises
    ------
    InputError
        As the scene does.

    Examples
    --------
    >>> import eom
    >>> tree_frames(eom.load_scene("double-pendulum")).caption
    'The frames of the ground and of 2 bodies at the start.'
    """
    s = TreeAtStart(ManyBodies(scene))
    items: list[Item] = [*_bones(s), *_axes(s, GROUND, ("black",) * 3, "")]
    few = len(s.tree.bodies) <= MOST_INDEXED
    for k, body in enumerate(s.tree.bodies):
        colours = (COLOURS[k],) * 3 if few else BY_LETTER
        items += _axes(s, body.name, colours, body.name if few else "")
    origins = {short(b.name): s.upright @ s.bodies[b.name].origin for b in s.tree.bodies}
    found = Sketch(
        [upright(item, s.upright) for item in items],
        f"The frames of the ground and of {len(s.tree.bodies)} bodies at the start.",
        points=origins if len(origins) > MOST_INDEXED else {},
        away=0.15 * s.size,
    )
    return _picture(scene, found)


def _bones(s: TreeAtStart) -> Iterator[Item]:
    for joint in s.tree.ordered:
        frame, _ = s.joints[joint.name]
        if joint.kind != "free":
            for body in (joint.parent, joint.child):
                yield Curve(np.stack([s.bodies[body].origin, frame.origin]), "grey", 1.5)
            yield Marks(frame.origin[None], "grey", 5.0)


def _axes(s: TreeAtStart, body: str, colours: Sequence[str], index: str) -> Iterator[Item]:
    """Yield the three axes of a body, those without names for the legend; a longer set is the ground's."""
    place, length = s.bodies[body], (0.55 if body == GROUND else 0.4) * s.size
    below = f"_{{{name(index).strip('$')}}}" if index else ""
    for axis, letter, colour in zip(place.C, "xyz", colours, strict=True):
        words = f"${letter}{below}$" if index or body == GROUND else ""
        label = "" if words else f"${letter}$"
        yield Arrow(place.origin, place.origin + length * axis, colour, 1.8, words, label)
