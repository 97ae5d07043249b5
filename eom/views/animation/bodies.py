"""What is to be drawn of a scene, of one body or of a tree of them: a body is a tree of one.

`bodies_of` alone asks which scene it has. What it returns says what the bodies look like, where they are at
the start or over a simulation, what is down, and how the axes of A are called: the frame of the ground, or
the one that attitude is measured in.

Of a tree, bones, thin rods in a body, lead from its joint to those that hang on it, and a body that others
are inside of is drawn so that one sees through it. Where its bodies are, the recursions give, over arrays
of all times at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from eom.errors import InputError
from eom.expressions import free_symbols
from eom.kinematics.coordinates import quaternion_of_sequence
from eom.multibody.files.scene import FORCES, TreeScene, start_values
from eom.multibody.files.sections import Reading
from eom.multibody.model.attachments import Rotor
from eom.multibody.model.bodies import GROUND, Body, Joint, Placement
from eom.multibody.model.constraints import Distance, Loop, Rolling
from eom.multibody.model.jets import changes
from eom.multibody.model.names import inputs_of
from eom.multibody.recursion.quantities import about_centre, first_moments, mass, momentum
from eom.opening import AnyScene
from eom.quantities import TIME
from eom.scenes import start
from eom.scenes.description import inertia_values, principal_values
from eom.scenes.scene import Scene
from eom.structure import DCM, NONE, QUATERNION
from eom.views.animation.acting import acting
from eom.views.animation.figures import (
    BODY_AXES,
    FLAT,
    Figure,
    Figures,
    Line,
    Shape,
    along,
    equivalent,
    held,
    rod,
    rolling,
    stalk,
    wheel,
)
from eom.views.animation.posture import Motion, Posture, filled, numbers
from eom.views.animation.tracks import (
    Acting,
    Floats,
    Track,
    Tracks,
    continuous,
    of_matrices,
    turned,
)
from eom.views.draw.meshes import Mesh, of_solid

if TYPE_CHECKING:
    from codegen import Result

LEAST_POINTS = 2
SPUN_AXES = (r"$\mathbf{c}_1$", r"$\mathbf{b}_2$", r"$\mathbf{c}_3$")
"""Names of the axes fixed in a spinner, beside B, which does not spin with it."""
Robot = Mapping[str, tuple[Shape, ...]]
"""Shapes of bodies that a file names."""


@dataclass(frozen=True)
class OneBody:
    """A scene of one body, whose origin is its centre of mass or the fixed point of its weight."""

    scene: Scene
    floor = None

    @property
    def gravity(self) -> Floats | None:
        """What is down, None without weight."""
        return None if self.scene.torque.weight is None else np.array([0.0, 0.0, -1.0])

    @property
    def orbit(self) -> bool:
        """Whether attitude is measured in a frame that turns with an orbit."""
        return self.scene.torque.gravity_gradient is not None

    @property
    def known(self) -> dict[str, float]:
        """Parameters and inputs by name."""
        given = {n: v.value for n, v in self.scene.inputs.items()}
        return {**start.constants(self.scene), **given}

    @property
    def start(self) -> dict[str, float]:
        """The states at the start."""
        return start.states(self.scene, self.scene.full_system)

    @property
    def inertia(self) -> Floats:
        """About the origin (kg m^2), shape (3, 3)."""
        matrix = inertia_values(self.scene)
        return np.diag(principal_values(self.scene)) if matrix is None else np.array(matrix)

    def moving(self, data: dict[str, Any]) -> Scene:
        """Return a scene of these data whose states and outputs say how the body turns, and why.

        A body without attitude coordinates gets a quaternion, with B on A at the start; a spinner without
        its angle of spin starts at zero.
        """
        if self.scene.model == "spinner":
            data["initial"] = {"phi": 0.0, "psi": 0.0, **data.get("initial", {})}
            if "initial_attitude" in data:
                kept = {n: v for n, v in data["initial"].items() if n not in {"phi", "psi"}}
                data["initial"] = kept
        elif self.scene.attitude == "none":
            data["attitude"] = "quaternion"
            data["initial_attitude"] = {"quaternion": (1.0, 0.0, 0.0, 0.0)}
        full = Scene(**data).full_system
        loads = [f"{letter}_{k}" for letter in ("h", "torque") for k in (1, 2, 3)]
        wanted = dict.fromkeys([*full.state_names, *loads, *self.scene.outputs])
        return Scene(**{**data, "outputs": tuple(wanted)})

    def tracks(self, motion: Motion) -> Tracks:
        """Return the motion of the body; h and torque of a spinner are in the frame before the spin."""
        whole, frame = self.turns(motion)
        still = np.zeros((len(motion.t), 3))
        spun = self.scene.full_system.attitudes[0].unspun
        omega = motion.triple("h") / self.inertia.diagonal() if spun else motion.triple("omega")
        h, torque, omega = (
            turned(frame, v) for v in (motion.triple("h"), motion.triple("torque"), omega)
        )
        body = Track(self.scene.title or self.scene.name, still, whole, omega)
        return Tracks(motion.t, (body,), h, still, torque, tuple(self._held(motion, frame)))

    def _held(self, motion: Motion, frame: Floats) -> Iterator[Acting]:
        """Yield the weight and the reaction of the fixed point: m times acceleration less gravity's.

        With J alpha = M - omega x h about that point, in axes in which J is constant; those of a spinner's
        frame, too. ``frame``: their quaternions.
        """
        weight = self.scene.torque.weight
        if weight is None:
            return
        r, h = np.array(weight.centre_of_mass), motion.triple("h")
        omega = np.linalg.solve(self.inertia, h.T).T
        alpha = np.linalg.solve(self.inertia, (motion.triple("torque") - np.cross(omega, h)).T).T
        moved = np.cross(alpha, r) + np.cross(omega, np.cross(omega, r))
        down = np.broadcast_to([0.0, 0.0, -weight.mass * weight.gravity], h.shape)
        reaction = weight.mass * turned(frame, moved) - down
        centre = turned(frame, np.broadcast_to(r, h.shape))
        yield Acting("weight", r"$m\,g$", "weight", down, centre)
        yield Acting("reaction", "$R$", "reaction of the fixed point", reaction, np.zeros_like(h))

    def turns(self, motion: Motion) -> tuple[Floats, Floats]:
        """Return the quaternions of the body, and of the frame that h and torque have components in."""
        (stated,) = self.scene.full_system.attitudes
        names = [c.name for c in stated.coordinates if c is not None]
        whole = _quaternions(stated.kind, names, motion)
        if not stated.unspun:
            return whole, whole
        return whole, _quaternions(stated.kind, [*names[:-1], None], motion)

    @property
    def centre(self) -> Floats:
        """Where the centre of mass is (m), from the fixed point of a weight, in the body's axes."""
        weight = self.scene.torque.weight
        return np.zeros(3) if weight is None else np.array(weight.centre_of_mass)

    def figures(self, robot: Robot) -> Figures:  # noqa: ARG002
        """Return what the body looks like, and what holds the fixed point of its weight."""
        figure = _one(self)
        away = figure.shapes[0].mesh.vertices @ self.centre
        room = 1e-9 * figure.extent * float(np.linalg.norm(self.centre))
        return Figures((figure,), _support(figure.extent) if np.all(away >= -room) and room else ())


def _quaternions(kind: str, names: Sequence[str | None], motion: Motion) -> Floats:
    """Return the quaternions of an attitude in coordinates of these names; an angle without one is zero."""
    if kind == NONE:
        return np.tile((1.0, 0.0, 0.0, 0.0), (len(motion.t), 1))
    still = np.zeros(len(motion.t))
    rows = np.stack([motion.series(n) if n else still for n in names], axis=-1)
    if kind == QUATERNION:
        return continuous(rows)
    if kind == DCM:
        return of_matrices(rows.reshape(-1, 3, 3))
    return continuous([quaternion_of_sequence(kind, row) for row in rows.tolist()])


def _one(body: OneBody) -> Figure:
    scene, inertia = body.scene, body.inertia
    spinner, name = scene.model == "spinner", scene.title or scene.name
    axis = 1 if spinner else 2
    axes = SPUN_AXES if spinner else BODY_AXES
    if scene.body.solid is not None:
        solid, sizes = scene.body.solid, scene.body.size
        dimensions = ", ".join(f"{n} {v:g} m" for n, v in sizes.items())
        words = f"{solid} of the scene ({dimensions})"
        return _tipped(Figure(name, tuple(_solid(body, axis)), words, axes), axis)
    if scene.torque.weight is not None:
        return _tipped(held(name, inertia, scene.torque.weight), axis)
    found = equivalent(inertia)
    unknown = "; its size is not known, as the scene says no mass"
    if spinner and found.sizes.get("length", 1) < FLAT * found.sizes.get("radius", 1):
        words = f"wheel{unknown}"
        return _tipped(Figure(name, wheel(found.sizes["radius"], axis), words, axes), axis)
    return _tipped(Figure(name, (Shape(found.mesh),), found.words + unknown, axes), axis)


def _solid(body: OneBody, axis: int) -> Iterator[Shape]:
    """Yield the solid of a scene about its centre of mass; of a spinner a torus has spokes."""
    solid, sizes = str(body.scene.body.solid), body.scene.body.size
    mesh = of_solid(solid, sizes).moved((0, 0, 0), np.roll(np.eye(3), axis - 2, axis=0))
    shapes: tuple[Shape, ...] = (Shape(mesh),)
    if solid == "torus" and body.scene.model == "spinner":
        shapes = wheel(sizes["ring_radius"], axis, sizes["tube_radius"])
    for shape in shapes:
        yield replace(shape, mesh=shape.mesh.moved(body.centre))
    yield from stalk(body.centre, mesh)


STAND = 0.7
"""Height of a stand, as a share of the size of the body on it."""


def _support(size: float) -> tuple[Shape, ...]:
    """Return a stand whose top is the fixed point, beside the body: a post with a foot and a ball."""
    foot = np.array([0.0, 0.0, -STAND * size])
    plate = of_solid("cylinder", {"radius": 0.2 * size, "length": 0.03 * size}).moved(foot)
    ball = of_solid("sphere", {"radius": 0.035 * size})
    parts = (Shape(replace(m, round=False), "grey") for m in (plate, ball))
    return (*rod((0, 0, 0), foot, 0.018 * size), *parts)


def _tipped(figure: Figure, axis: int) -> Figure:
    """Return a figure with its tip on an axis of the body, a little outside of it."""
    return replace(figure, tip=1.15 * figure.extent * np.eye(3)[axis])


PLATE = 0.09
"""Radius of the plate that a joint stands on, as a share of the tree's reach."""
BONE, PIN, HINGE, POINT, ROTOR = 0.008, 0.016, 0.05, 0.12, 0.1
"""Radius of bones and joints, length of a hinge, side of a body without inertia, radius of a rotor: as
shares of the tree's reach."""
GLASS = 0.3
"""Opacity of a body that others are inside of."""


@dataclass(frozen=True)
class ManyBodies:
    """A tree of bodies."""

    scene: TreeScene
    orbit = False

    @property
    def gravity(self) -> Floats | None:
        """What is down, None without weight."""
        found = numbers(self.scene.tree.gravity, self.known)
        return found if np.any(found) else None

    @property
    def floor(self) -> float | None:
        """The height (m) of a plane on which a body rolls."""
        for c in self.scene.tree.constraints:
            if isinstance(c, Rolling):
                return float(numbers(c.origin, self.known) @ numbers(c.normal, self.known))
        return None

    @property
    def known(self) -> dict[str, float]:
        """Parameters and inputs by name."""
        given = {n: v.value for n, v in self.scene.inputs.items()}
        return {**self.scene.numbers, **given}

    @property
    def start(self) -> dict[str, float]:
        """The states at the start."""
        return start_values(self.scene.tree, Reading(self.scene))

    def moving(self, data: dict[str, Any]) -> TreeScene:
        """Return a scene of these data, the angles of rotors among the states where their speed is one."""
        rotors = {
            name: {**part, "angle": True} if part.get("speed") is None else part
            for name, part in data.get("rotors", {}).items()
        }
        made = TreeScene(**{**data, **({"rotors": rotors} if rotors else {})})
        forces = (FORCES,) if made.tree.constraints else ()
        return made.asking((*made.control.laws, *forces, *self.scene.outputs))

    @cached_property
    def wheels(self) -> tuple[Joint, ...]:
        """Hinges at the origin of bodies that carry no other, whose angle no equation reads."""
        tree, system = self.scene.tree, self.scene.full_system
        read = set[Any](free_symbols(system.right_sides))
        read |= set() if system.mass_matrix is None else system.mass_matrix.free_symbols
        for d in reversed(system.definitions):
            read |= free_symbols((d.expression,)) if d.symbol in read else set()
        carrying = {j.parent for j in tree.joints}
        unread = {q.name for q in system.states if q.symbol not in read}
        return tuple(
            j
            for j in tree.joints
            if j.kind == "revolute" and not j.motion and j.child not in carrying
            and j.on_child == Placement() and j.coordinates[0].symbol.name in unread
        )  # fmt: skip

    def tracks(self, motion: Motion) -> Tracks:
        """Return the motion of all bodies, and of rotors with a name of their own, after their bodies."""
        posture = Posture(self.scene.tree, motion)
        wheels = {j.child: j for j in self.wheels}
        bodies = tuple(
            posture.wheel(wheels[b.name]) if b.name in wheels else posture.track(b.name)
            for b in self.scene.tree.bodies
        )
        rotors = tuple(posture.rotor(k) for k in range(len(self.scene.tree.rotors)))
        whole, N = posture.flow, len(motion.t)
        heavy = mass(whole)
        centre = [x / heavy for x in first_moments(whole)]
        H = about_centre(whole, momentum(whole))
        loads = acting(self.scene.tree, posture.moment, N)
        return Tracks(motion.t, (*bodies, *rotors), filled(H, N), filled(centre, N), acting=loads)

    def figures(self, robot: Robot) -> Figures:
        """Return the bodies, then the rotors; ``robot``: shapes of bodies by name, which come first."""
        drawing = Drawing(self.scene, robot)
        bodies = tuple(drawing.body(b) for b in self.scene.tree.bodies)
        rotors = tuple(drawing.rotor(r) for r in self.scene.tree.rotors)
        shown = (*map(drawing.seen_through, bodies), *rotors)
        return Figures(shown, drawing.ground(), tuple(drawing.lines()))


@dataclass(frozen=True)
class Drawing:
    """A tree in numbers, those of t = 0 of what changes in time."""

    scene: TreeScene
    robot: Robot
    spokes: bool = True
    """Whether wheels have spokes, or are discs."""

    def array(self, given: Any) -> Floats:
        """Return the values of a vector or matrix."""
        return numbers(given, {**self.scene.numbers, TIME.name: 0.0})

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
            words = f"{part.solid} of the scene" + (
                ", as it is at the start" if changes(body) else ""
            )
            return (Shape(mesh.moved(centre, axes)),), words
        J, m = self.array(body.central_inertia), float(self.array(body.mass))
        rolls = (c for c in self.scene.tree.constraints if isinstance(c, Rolling))
        touching = next((c for c in rolls if c.body == body.name), None)
        if touching is not None:
            return self._rolling(touching, J, m)
        if m <= 0 or not np.any(J):
            return (), ""
        found = equivalent(J, m)
        return (Shape(found.mesh.moved(centre)),), found.words

    def _rolling(self, c: Rolling, J: Floats, m: float) -> tuple[tuple[Shape, ...], str]:
        axis = np.zeros(3) if c.axis is None else self.array(c.axis)
        about = float(axis @ J @ axis) / (float(axis @ axis) or 1.0) / (m or 1.0)
        radius, half = float(self.array(c.radius)), float(self.array(c.half_axis))
        shapes, words = rolling(radius, half, axis, about, spokes=self.spokes)
        centre = self.array(c.centre)
        return tuple(replace(s, mesh=s.mesh.moved(centre)) for s in shapes), words

    def _sizes(self, sizes: Mapping[str, Any]) -> dict[str, float]:
        read = Reading(self.scene).plain
        return {n: float(self.array(read.value(v, n))) for n, v in sizes.items()}

    def body(self, body: Body) -> Figure:
        """Return a body with its bones and its joint."""
        shapes, words = self.own(body)
        if not shapes and float(self.array(body.mass)) > 0:
            a = POINT * self.reach / (2 if np.any(self.array(body.centre)) else 1)
            box = of_solid("box", {"a": 2 * a, "b": a, "c": a})
            shapes, words = (Shape(box.moved(self.array(body.centre))),), "point mass, as a box"
        joint = self.scene.tree.joint_of[body.name]
        start = self.array(joint.on_child.position)
        ends = [
            *self.places[body.name],
            *([self.array(body.centre)] if words.startswith("point") else []),
        ]
        bones = [s for end in ends
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
        if joint.kind in {"revolute", "cylindrical", "helical"}:
            half = turn @ self.array(joint.axis) * HINGE * self.reach / 2
            return rod(place - half, place + half, PIN * self.reach, "black")
        if joint.kind in {"spherical", "universal"}:
            return (self.ball(place, 1.5, "black"),)
        return ()

    def ground(self) -> tuple[Shape, ...]:
        """Return what is drawn on the ground: rails of sliding joints, stands of the others."""
        found: list[Shape] = []
        for joint in (j for j in self.scene.tree.joints if j.parent == GROUND):
            place, turn = (
                self.array(joint.on_parent.position),
                self.array(joint.on_parent.rotation).T,
            )
            if joint.kind == "prismatic":
                axis = turn @ self.array(joint.axis) * 3 * self.reach
                found += rod(place - axis, place + axis, BONE * self.reach)
            elif joint.kind not in {"free", "fixed", "planar"}:
                found += [self.ball(place, 2.2, "grey"), *self._base(place)]
        return tuple(found)

    def _base(self, place: Floats) -> Iterator[Shape]:
        """Yield what a joint stands on under gravity: a plate, at the height of the ground's origin."""
        g = self.array(self.scene.tree.gravity)
        if not np.any(g):
            return
        up = -g / np.linalg.norm(g)
        foot = place - max(0.0, float(place @ up)) * up
        plate = {"radius": PLATE * self.reach, "length": BONE * self.reach}
        mesh = of_solid("cylinder", plate).moved(foot - BONE * self.reach / 2 * up, along(up))
        yield Shape(replace(mesh, round=False), "grey")
        yield from rod(foot, place, PIN * self.reach)

    def ball(self, place: Floats, size: float, colour: str) -> Shape:
        """Return a ball at a place, of a radius in those of joints."""
        mesh = of_solid("sphere", {"radius": size * PIN * self.reach})
        return Shape(replace(mesh.moved(place), round=False), colour)

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


Bodies = OneBody | ManyBodies


def single(scene: AnyScene) -> Scene | None:
    """Return a scene if it is of one body, for pictures of one."""
    return scene if isinstance(scene, Scene) else None


def bodies_of(scene: AnyScene) -> Bodies:
    """Return what is to be drawn of a scene of any model."""
    return OneBody(scene) if isinstance(scene, Scene) else ManyBodies(scene)


def at_start(bodies: Bodies) -> Motion:
    """Return the numbers of a scene at t = 0; states that it leaves open are zero, and inputs of control.

    Raises `InputError` as the scene does.
    """
    still = dict.fromkeys(bodies.scene.full_system.state_names, 0.0)
    if isinstance(bodies, ManyBodies):  # what laws of control set
        still |= {q.name: 0.0 for q in inputs_of(bodies.scene.tree)}
    return Motion(np.zeros(1), {**still, **bodies.known, **bodies.start})


def with_attitude(scene: AnyScene, points: int, t_end: float | None = None) -> AnyScene:
    """Return a scene whose simulation says where its bodies are, at ``points`` equally spaced times.

    All states are asked for, and momentum and torque of one body. Coordinates that say so are added where
    the scene has none (`OneBody.moving`, `ManyBodies.moving`).
    """
    data = scene.model_dump(exclude_unset=True)
    plan = {**data.get("integration", {}), "points": max(points, LEAST_POINTS)}
    data["integration"] = plan if t_end is None else {**plan, "t_end": t_end}
    data["outputs"] = ()
    return bodies_of(scene).moving(data)


def tracks_of(scene: AnyScene, result: Result) -> Tracks:
    """Return the motion of the bodies of a scene of `with_attitude` from its simulation.

    Raises `InputError` for fewer than two times.
    """
    if len(result.t) < LEAST_POINTS:
        raise InputError("the motion has no duration", where=scene.name, got=result.message)
    bodies = bodies_of(scene)
    fixed = {**bodies.known, **scene.parameter_values(), **scene.input_values()}
    found = {n: np.asarray(result[n]) for n in (*result.names, *result.outputs)}
    return bodies.tracks(Motion(result.t, {**fixed, **found}))
