"""A tree over scalars of one kind: parts with a joint each, in an order in which parents come first.

What is fixed to a part belongs to it: fixed joints, and what they carry, cost nothing afterwards. The
frame of a part is the joint's frame F on it; mass properties are about its origin, in its axes.

Rotors: bodies of revolution that spin in bearings of a body, as momentum along an axis.

A rotor of axial moment J, whose axis a is fixed in a body, adds momentum along a alone; mass and inertia
of the body include those of the rotor at rest in it. Of a rotor with a speed of its own the state is
Omega, its whole angular velocity along a: with the torque tau of motor and bearing, J Omega' = tau, the
body feels -tau, and it turns without the moment J about a. A rotor of given speed sigma in the body adds
the momentum J sigma. Either momentum h adds omega x (h a) to the moment that the body takes.
Source: Hughes, Spacecraft Attitude Dynamics (1986), sec. 3.3 (the gyrostat) and 6.2.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from eom.errors import InputError
from eom.multibody.algebra.scalars import (
    Scalar,
    Work,
    add,
    is_zero,
    mul,
    negative,
    reciprocal,
    sub,
    total,
)
from eom.multibody.algebra.spatial import (
    IDENTITY,
    NOTHING,
    ZERO,
    General,
    Inertia,
    Matrix,
    Rotation,
    Turn,
    Vector,
    cross,
    dot,
    joined,
    keep_symmetric,
    keep_vector,
    plus,
    product,
    scaled,
    skew,
    times,
    transposed,
)
from eom.multibody.model.attachments import Load, Rotor, Spring
from eom.multibody.model.bodies import GROUND, Body, Joint
from eom.multibody.model.jets import Jet, flow
from eom.multibody.model.joints import Kind, Setting
from eom.multibody.model.model import Tree

Lift = Callable[[Any], Scalar]
"""Turns a value of a description into a scalar; 0, 1 and -1 had best stay what they are."""


@dataclass(frozen=True)
class BodyPlacement:
    """Where a body is on the part that it belongs to.

    ``part``: its number, -1 for the ground. ``rotation``: C takes components in the part's axes to
    those in the body's. ``origin``: of the body, in the part's axes, from the part's origin.
    """

    part: int
    rotation: Matrix = IDENTITY
    origin: Vector = ZERO

    def point(self, position: Vector) -> Vector:
        """Return a point of the body (from its origin, in its axes) on the part."""
        return plus(self.origin, times(transposed(self.rotation), position))


@dataclass(frozen=True)
class AppliedLoad:
    """A load on a part: force and torque, either in the part's axes or in the ground's, and a point."""

    force: Vector
    torque: Vector
    point: Vector
    grounded: bool


@dataclass(frozen=True)
class SpringDamper:
    """A spring and damper between two points: parts (-1 for the ground), points from their origins."""

    name: str
    parts: tuple[int, int]
    points: tuple[Vector, Vector]
    stiffness: Scalar
    length: Scalar
    damping: Scalar

    @property
    def plain(self) -> bool:
        """Whether the force is the stiffness times the line from point to point."""
        return is_zero(self.length) and is_zero(self.damping)


@dataclass(frozen=True)
class Stream:
    """What flows in a body of a part, over scalars: see `eom.multibody.model.jets.Flow`.

    ``rotation``: C takes components in the part's axes to those in the body's; ``origin``: of the body, in
    the part's axes. The rest is about that origin, in the body's axes.
    """

    rotation: Matrix
    origin: Vector
    momentum: Vector
    spin: Vector
    force: Vector
    moment: Vector
    damping: Matrix

    def needed(self, omega: Vector) -> tuple[Vector, Vector]:
        """Return moment about the part's origin and force that the part takes for it, in its axes."""
        w = times(self.rotation, omega)
        force = plus(self.force, scaled(2, cross(w, self.momentum)))
        turning = plus(times(self.damping, w), cross(w, self.spin))
        return self.carried(plus(self.moment, turning), force)

    @property
    def relative(self) -> tuple[Vector, Vector]:
        """Angular momentum about the part's origin and momentum of the flow, relative to the part."""
        return self.carried(self.spin, self.momentum)

    def carried(self, moment: Vector, force: Vector) -> tuple[Vector, Vector]:
        """Return a moment about the body's origin and a force, in its axes, as those of the part."""
        back = transposed(self.rotation)
        force = times(back, force)
        return plus(times(back, moment), cross(self.origin, force)), force


@dataclass(frozen=True)
class Part:
    """A body with what is fixed to it, and the joint that leads to it.

    ``parent``: number of the part that carries it, or -1. ``position``, ``rotation``: of the joint's
    frame P on that part. ``inertia``: rigid, about the origin of F. ``coordinates``, ``speeds``: where
    they are among those of the whole tree. ``driven``: whether its motion is prescribed. ``spins``:
    whether its frame stays behind its last turn, as it is a body of revolution about that axis.
    """

    name: str
    joint: str
    parent: int
    kind: Kind
    setting: Setting
    position: Vector
    rotation: Rotation
    coordinates: slice
    speeds: slice
    armature: Vector
    driven: bool
    inertia: Inertia = NOTHING
    pulls: tuple[AppliedLoad, ...] = ()
    spins: bool = False
    rotors: tuple[RotorSpin, ...] = ()
    streams: tuple[Stream, ...] = ()

    @property
    def mass(self) -> Scalar:
        """The mass."""
        return self.inertia.M[0][0]

    @property
    def whole_inertia(self) -> Matrix:
        """Moments and products of inertia about the origin, with those of rotors about their axes."""
        return with_axial(self.inertia.I, self.rotors)

    @property
    def first_moment(self) -> Vector:
        """Mass times the position of the centre of mass."""
        H = self.inertia.H
        return [H[2][1], H[0][2], H[1][0]]


@dataclass(frozen=True)
class LumpedTree:
    """The parts of a tree, where its bodies are on them, and gravity's acceleration in the ground.

    ``gradient``: of that acceleration, by the position; None where it is the same everywhere.
    """

    parts: tuple[Part, ...]
    seats: dict[str, BodyPlacement]
    gravity: Vector
    coordinates: int = 0
    speeds: int = 0
    rotors: tuple[tuple[int, RotorSpin], ...] = ()
    """All rotors, with the numbers of their parts."""
    links: tuple[SpringDamper, ...] = ()
    gradient: Matrix | None = None

    @property
    def driven(self) -> tuple[int, ...]:
        """The numbers of the speeds that are prescribed."""
        return tuple(
            k for p in self.parts if p.driven for k in range(p.speeds.start, p.speeds.stop)
        )


def lumped_tree(
    tree: Tree,
    lift: Lift,
    work: Work,
    turning: Iterable[str] = (),
    *,
    apart: Collection[str] = (),
) -> LumpedTree:
    """Return a tree over the scalars that ``lift`` makes of its values.

    ``turning``: bodies whose frames turn with them, even if they are bodies of revolution; those that
    springs and constraints hold always do. ``apart``: fixed joints that lead to parts of their own,
    without speeds.
    """
    builder = _Growing(tree, lift, work, apart)
    for joint in tree.ordered:
        builder.joint(joint)
    for load in tree.loads:
        builder.load(load)
    for rotor in tree.rotors:
        builder.rotor(rotor)
    for name in dict.fromkeys(jet.body for jet in tree.jets):
        builder.stream(tree.body[name], [jet for jet in tree.jets if jet.body == name])
    held = {*turning, *(name for spring in tree.springs for name in spring.bodies)}
    held |= {name for constraint in tree.constraints for name in constraint.bodies}
    fast = {builder.seats[name].part for name in held if name in builder.seats}
    parts = tuple(_spinning(k, builder.parts, fast) for k in range(len(builder.parts)))
    gravity = builder.vector(tree.gravity)
    varies = any(not is_zero(x) for row in tree.gravity_gradient for x in row)
    gradient = builder.matrix(tree.gravity_gradient) if varies else None
    sizes = builder.coordinates, builder.speeds
    links = tuple(builder.link(spring) for spring in tree.springs)
    return LumpedTree(parts, builder.seats, gravity, *sizes, tuple(builder.rotors), links, gradient)


@dataclass
class _Growing:
    tree: Tree
    lift: Lift
    work: Work
    apart: Collection[str] = ()
    parts: list[Part] = field(default_factory=list)
    seats: dict[str, BodyPlacement] = field(default_factory=lambda: {GROUND: BodyPlacement(-1)})
    coordinates: int = 0
    speeds: int = 0
    rotors: list[tuple[int, RotorSpin]] = field(default_factory=list)

    def vector(self, v: Vector) -> Vector:
        return [self.lift(x) for x in v]

    def matrix(self, A: Matrix) -> Matrix:
        return [self.vector(row) for row in A]

    def joint(self, joint: Joint) -> None:
        """Add a part, or for a fixed joint a body to the part of its parent."""
        before = self.seats[joint.parent]
        C = product(self.matrix(joint.on_parent.rotation), before.rotation)
        position = before.point(self.vector(joint.on_parent.position))
        F = self.matrix(joint.on_child.rotation)
        origin = [negative(x) for x in times(F, self.vector(joint.on_child.position))]
        here = BodyPlacement(len(self.parts), transposed(F), origin)
        if joint.kind == "fixed" and joint.name not in self.apart:
            where = plus(position, times(transposed(C), origin))
            here = BodyPlacement(before.part, product(transposed(F), C), where)
        else:
            self.parts.append(self._part(joint, before.part, position, C))
        self.seats[joint.child] = here
        self._weigh(self.tree.body[joint.child], here)

    def _part(self, joint: Joint, parent: int, position: Vector, C: Matrix) -> Part:
        first, start = self.coordinates, self.speeds
        self.coordinates += len(joint.coordinates)
        self.speeds += len(joint.speeds)
        axes = tuple(tuple(self.vector(a)) for a in joint.axes)
        return Part(
            name=joint.child,
            joint=joint.name,
            parent=parent,
            kind=joint.row,
            setting=Setting(joint.name, axes, self.lift(joint.pitch), joint.attitude),
            position=keep_vector(self.work, "r", joint.child, position),
            rotation=() if _is_identity(C) else (General(C),),
            coordinates=slice(first, self.coordinates),
            speeds=slice(start, self.speeds),
            armature=self.vector(joint.armature),
            driven=joint.motion is not None,
        )

    def _weigh(self, body: Body, seat: BodyPlacement) -> None:
        """Add the mass of a body to its part; what is fixed to the ground does not matter."""
        if seat.part < 0:
            return
        part = self.parts[seat.part]
        rigid = self._inertia(body, seat)
        whole = joined(part.inertia, rigid) if part.inertia is not NOTHING else rigid
        self.parts[seat.part] = replace(part, inertia=self._kept(part.name, whole))

    def _inertia(self, body: Body, seat: BodyPlacement) -> Inertia:
        m, C = self.lift(body.mass), seat.rotation
        x = seat.point(self.vector(body.centre))
        about_origin = all(map(is_zero, (*seat.origin, *body.point)))
        given = body.turned_inertia if about_origin else body.central_inertia
        turned = product(transposed(C), product(self.matrix(given), C))
        away = ZERO if about_origin else x
        square = dot(away, away)

        def entry(i: int, j: int) -> Scalar:
            i, j = min(i, j), max(i, j)
            return add(turned[i][j], mul(m, sub(square if i == j else 0, mul(away[i], away[j]))))

        J = [[entry(i, j) for j in range(3)] for i in range(3)]
        return Inertia(J, skew(scaled(m, x)), [[m, 0, 0], [0, m, 0], [0, 0, m]])

    def _kept(self, name: str, A: Inertia) -> Inertia:
        m = self.work.keep("mass", name, "", A.M[0][0])
        h = keep_vector(self.work, "h", name, [A.H[2][1], A.H[0][2], A.H[1][0]])
        J = keep_symmetric(self.work, "J", name, A.I)
        return Inertia(J, skew(h), [[m, 0, 0], [0, m, 0], [0, 0, m]])

    def load(self, load: Load) -> None:
        """Add a load to its part; on the ground it moves nothing."""
        seat = self.seats[load.body]
        if seat.part < 0:
            return
        force, torque = self.vector(load.force), self.vector(load.torque)
        grounded = load.axes == GROUND
        if not grounded:
            back = transposed(seat.rotation)
            force, torque = times(back, force), times(back, torque)
        pull = AppliedLoad(force, torque, seat.point(self.vector(load.point)), grounded)
        part = self.parts[seat.part]
        self.parts[seat.part] = replace(part, pulls=(*part.pulls, pull))

    def stream(self, body: Body, jets: Sequence[Jet]) -> None:
        """Add what flows in a body to its part; what is fixed to the ground does not matter."""
        seat = self.seats[body.name]
        if seat.part < 0:
            return
        found, part = flow(body, jets), self.parts[seat.part]
        own = Stream(
            rotation=seat.rotation,
            origin=seat.origin,
            momentum=self.vector(found.momentum),
            spin=self.vector(found.spin),
            force=self.vector(found.force),
            moment=self.vector(found.moment),
            damping=self.matrix(found.damping),
        )
        self.parts[seat.part] = replace(part, streams=(*part.streams, own))

    def link(self, spring: Spring) -> SpringDamper:
        """Return a spring on its parts."""
        seats = [self.seats[name] for name in spring.bodies]
        points = [s.point(self.vector(p)) for s, p in zip(seats, spring.points, strict=True)]
        values = map(self.lift, (spring.stiffness, spring.length, spring.damping))
        return SpringDamper(
            spring.name, (seats[0].part, seats[1].part), (points[0], points[1]), *values
        )

    def rotor(self, rotor: Rotor) -> None:
        """Add a rotor to its part, whose inertia keeps its axial moment if its speed is given."""
        seat = self.seats[rotor.body]
        if seat.part < 0:
            raise InputError(
                "a rotor on a body that is fixed to the ground moves nothing",
                where=f"rotor {rotor.name!r}",
            )
        free = rotor.speed is None
        motors = [self.lift(m.symbol) for m in rotor.motors]
        spin = RotorSpin(
            axis=times(transposed(seat.rotation), self.vector(rotor.axis)),
            inertia=self.lift(rotor.inertia),
            speed=self.lift(rotor.states[-1].symbol if free else rotor.speed),
            free=free,
            torque=total([self.lift(rotor.torque), *motors]),
            damping=self.lift(rotor.damping),
            acceleration=0 if free else self.lift(rotor.acceleration),
        )
        part = self.parts[seat.part]
        left = Inertia(without_axial(part.inertia.I, [spin]), part.inertia.H, part.inertia.M)
        self.parts[seat.part] = replace(
            part, inertia=self._kept(part.name, left), rotors=(*part.rotors, spin)
        )
        self.rotors.append((seat.part, spin))


def _is_identity(C: Matrix) -> bool:
    entries = zip((x for row in C for x in row), (x for row in IDENTITY for x in row), strict=True)
    return all(is_zero(x) if e == 0 else type(x) is int and x == 1 for x, e in entries)


def _spinning(k: int, parts: list[Part], held: set[int]) -> Part:
    """Mark a part at an end of the tree that is a body of revolution about its joint's axis."""
    part = parts[k]
    if (
        k in held
        or not part.kind.spins
        or part.pulls
        or part.rotors
        or part.streams
        or any(p.parent == k for p in parts[k + 1 :])
    ):
        return part
    (axis,) = part.setting.axes
    along = [n for n in range(3) if not is_zero(axis[n])]
    if len(along) > 1:
        return part
    return replace(part, spins=_of_revolution(part.inertia.I, part.first_moment, along[0]))


def _of_revolution(J: Matrix, h: Vector, axis: int) -> bool:
    i, j = (axis + 1) % 3, (axis + 2) % 3
    off = (J[i][j], J[i][axis], J[j][axis], h[i], h[j], sub(J[i][i], J[j][j]))
    return all(map(is_zero, off))


def last_turn_left_out(rotation: Rotation) -> Rotation:
    """Return the rotations without the last, which is a turn."""
    assert isinstance(rotation[-1], Turn)
    return rotation[:-1]


@dataclass(frozen=True)
class RotorSpin:
    """A rotor over scalars: axis in its part's axes, axial moment, speed and what drives it.

    ``free``: whether ``speed`` is Omega; ``torque`` is then that of the motor, and ``damping`` brakes the
    speed in the body. Otherwise ``speed`` is sigma, and ``acceleration`` its rate.
    """

    axis: Vector
    inertia: Scalar
    speed: Scalar
    free: bool
    torque: Scalar = 0
    damping: Scalar = 0
    acceleration: Scalar = 0

    @property
    def momentum(self) -> Scalar:
        """J times the speed: what the rotor adds to the angular momentum along its axis."""
        return mul(self.inertia, self.speed)

    def relative(self, omega: Vector) -> Scalar:
        """Return the speed of the rotor in its body."""
        return sub(self.speed, dot(self.axis, omega)) if self.free else self.speed

    def driving(self, omega: Vector) -> Scalar:
        """Return the torque on the rotor along its axis."""
        if not self.free:
            return mul(self.inertia, self.acceleration)
        return sub(self.torque, mul(self.damping, self.relative(omega)))

    def rate(self, omega: Vector) -> Scalar:
        """Return Omega'."""
        return mul(reciprocal(self.inertia), self.driving(omega))

    def moment(self, omega: Vector) -> Vector:
        """Return the moment that the body takes beyond its own."""
        gyroscopic = cross(omega, scaled(self.momentum, self.axis))
        return plus(gyroscopic, scaled(self.driving(omega), self.axis))

    def twice_energy(self, omega: Vector) -> Scalar:
        """Return twice the kinetic energy less what momentum times angular velocity counts of it."""
        carried = dot(self.axis, omega)
        beyond = sub(self.speed, carried) if self.free else add(self.speed, carried)
        return mul(self.momentum, beyond)


def without_axial(J: Matrix, spins: Sequence[RotorSpin]) -> Matrix:
    """Return an inertia without the axial moments of the rotors that have speeds of their own."""
    return _axial(J, spins, sub)


def with_axial(J: Matrix, spins: Sequence[RotorSpin]) -> Matrix:
    """Return an inertia with the axial moments of the rotors that have speeds of their own."""
    return _axial(J, spins, add)


def _axial(
    J: Matrix, spins: Sequence[RotorSpin], combined: Callable[[Scalar, Scalar], Scalar]
) -> Matrix:
    for spin in (s for s in spins if s.free):
        a = [scaled(spin.inertia, [mul(x, y) for y in spin.axis]) for x in spin.axis]
        J = [[combined(J[i][j], a[min(i, j)][max(i, j)]) for j in range(3)] for i in range(3)]
    return J
