"""Vectors of a tree in motion, over any scalars: what acts on its bodies, momentum, angular velocities.

Forces and torques are those that the equations of motion are made of: weights and the gradient of gravity,
loads, thrusts of jets, what springs, dampers, motors and applied forces do in joints, springs between
points, motors and bearings of rotors, and constraints by their multipliers. Where accelerations are asked
for, there are the forces that go through joints, too.

All components are in the ground's axes. What acts between two bodies is given as it acts on the second one,
the child of a joint; of what acts between two points, both ends are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import sympy as sp

from eom.multibody.algebra.lazy_sums import plain
from eom.multibody.algebra.scalars import Scalar, add, is_zero, mul, negative, reciprocal, sub
from eom.multibody.algebra.spatial import (
    ZERO,
    SpatialVector,
    Vector,
    cross,
    minus,
    negative_vector,
    plus,
    product,
    scaled,
    times,
    transposed,
)
from eom.multibody.constrained.constraint_plan import BETWEEN_POINTS
from eom.multibody.constrained.equations import Component, components
from eom.multibody.constrained.relations import Arithmetic, loose, scene
from eom.multibody.model.attachments import Load, Rotor, Spring
from eom.multibody.model.bodies import GROUND, Body, Joint
from eom.multibody.model.constraints import Distance
from eom.multibody.model.jets import rates
from eom.multibody.model.model import Constraint, Tree
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.motion import Scalars, motion, velocities
from eom.multibody.recursion.quantities import (
    Flow,
    first_moments,
    flow,
    mass,
    momentum,
)
from eom.multibody.recursion.recursions import End, end, forward_dynamics, pull, transmitted
from eom.quantities import Definition, Quantity
from eom.system import System

FORCE, TORQUE, OMEGA, MOMENTUM = "force", "torque", "omega", "momentum"
UNITS = {FORCE: "N", TORQUE: "N m", OMEGA: "rad/s", MOMENTUM: "N m s"}
"""Kinds of vectors, and their units."""
WEIGHT, GRADIENT, LOAD, JET = "weight", "gradient of gravity", "load", "jet"
JOINT, SPRING, ROTOR, CONSTRAINT, MOTION = "joint", "spring", "rotor", "constraint", "motion"
REACTION = "reaction of"
"""What a vector comes from."""

Arrow = tuple[Vector, Vector]
"""A vector, and the point (m) that it acts at or belongs to."""


@dataclass(frozen=True)
class VectorOf:
    """A vector of a tree: its ``kind``, a key of `UNITS`, and what it comes from.

    ``source``: a force or torque by such a part of the tree, of this ``name``; `MOTION` of what moves.
    ``body``: that it acts on, or that turns; empty of all. ``at``: the vector in a state, and its place.
    """

    kind: str
    source: str
    name: str
    body: str
    at: Callable[[Moment], Arrow | None]


@dataclass(frozen=True)
class Moment:
    """A tree in a state, over scalars of one kind.

    ``q``, ``u``: all coordinates and speeds; ``tau``: forces in the joints, one a speed; ``multipliers``:
    those of constraints, by their names as in outputs, those that are left out zero. ``prescribed``: the
    accelerations of speeds whose motion is given; None where no accelerations are asked for.
    """

    tree: Tree
    arithmetic: Arithmetic
    q: Scalars
    u: Scalars
    tau: Scalars
    multipliers: Mapping[str, Scalar]
    prescribed: Mapping[int, Scalar] | None = None

    @cached_property
    def lumped(self) -> LumpedTree:
        """The parts, whose frames all turn with them."""
        lift, work = self.arithmetic.lift, self.arithmetic.work
        return lumped_tree(self.tree, lift, work, [b.name for b in self.tree.bodies])

    @cached_property
    def flow(self) -> Flow:
        """The motion of all parts."""
        return flow(self.lumped, self.q, self.u, self.arithmetic.work)

    @cached_property
    def number(self) -> dict[str, int]:
        """The parts by the joints that lead to them."""
        return {p.joint: k for k, p in enumerate(self.lumped.parts)}

    def part(self, body: str) -> int:
        """Return the number of the part that a body belongs to, -1 of the ground."""
        return self.lumped.seats[body].part

    def vector(self, given: Iterable[object]) -> Vector:
        """Return components of the description as scalars."""
        return [self.arithmetic.lift(x) for x in given]

    def turned(self, part: int, v: Vector) -> Vector:
        """Return components in the axes of a part in the ground's."""
        return v if part < 0 else times(transposed(self.flow.poses[part][0]), v)

    def of_body(self, body: str, v: Vector) -> Vector:
        """Return components in the axes of a body in the ground's."""
        seat = self.lumped.seats[body]
        return self.turned(seat.part, times(transposed(seat.rotation), v))

    def point(self, body: str, position: Iterable[object]) -> Vector:
        """Return where a point of a body is, given from its origin in its axes."""
        seat = self.lumped.seats[body]
        there = seat.point(self.vector(position))
        return there if seat.part < 0 else plus(self.flow.poses[seat.part][1],
                                                self.turned(seat.part, there))  # fmt: skip

    @cached_property
    def ends(self) -> dict[str, tuple[End, End, Vector]]:
        """The ends of springs between points, and the force on the first one, by name."""
        work = self.arithmetic.work
        moved = motion(self.flow.placed, self.u, work)
        speeds = velocities(self.flow.placed, moved, work)
        found = {}
        for link in self.lumped.links:
            first, second = (end(link, n, self.flow.poses, speeds, work) for n in (0, 1))
            found[link.name] = first, second, pull(link, first, second, work)
        return found

    @cached_property
    def through(self) -> list[SpatialVector]:
        """Moment about its origin and force that each part takes through its joint, in its axes.

        Forward dynamics under the forces of the constraints, then Newton's and Euler's laws.
        """
        tau, work = list(self.tau), self.arithmetic.work
        six: list[Scalar] = [0] * (6 * len(self.lumped.parts))
        for bound, free, x in (row for rows in self.held.values() for row in rows):
            for s, a in bound.relation.row().items():
                tau[s] = add(tau[s], mul(a, x))
            for place, a in free.relation.row().items() if free.relation.places() else ():
                six[place] = add(six[place], mul(a, x))
        udot = forward_dynamics(self.lumped, self.q, self.u, tau, work, self.prescribed)
        further = [
            SpatialVector(times(R, six[6 * k : 6 * k + 3]), times(R, six[6 * k + 3 : 6 * k + 6]))
            for k, (R, _) in enumerate(self.flow.poses)
        ]
        return transmitted(self.lumped, self.flow.placed, self.u, udot, work, further)

    @cached_property
    def held(self) -> dict[str, list[tuple[Component, Component, Scalar]]]:
        """The equations of each constraint that acts, for speeds and for loose parts, and multipliers."""
        still = scene(self.lumped, self.q, None, self.arithmetic)
        found: dict[str, list[tuple[Component, Component, Scalar]]] = {}
        pairs = zip(components(self.tree, still), components(self.tree, loose(still)), strict=True)
        for bound, free in pairs:
            x = self.multipliers.get(f"{bound.constraint}{'_' * bool(bound.letter)}{bound.letter}")
            if x is not None:
                found.setdefault(bound.constraint, []).append((bound, free, x))
        return found


@dataclass(frozen=True)
class Drawn:
    """All vectors of a tree, to ask `eom.multibody.derive` for as outputs.

    Vector number k of `vectors_of` has the outputs ``<prefix>k_1`` to 6: components, then place (m), in the
    ground's axes. Those that are zero by structure have none.
    """

    prefix: str

    def name(self, number: int, component: int) -> str:
        """Return the name of an output."""
        return f"{self.prefix}{number}_{component}"

    def definitions(self, tree: Tree, moment: Moment) -> Iterator[Definition]:
        """Yield the outputs of a tree over named scalars."""
        for k, vector in enumerate(vectors_of(tree)):
            found = vector.at(moment)
            if found is None or all(map(is_zero, found[0])):
                continue
            for n, x in enumerate((*found[0], *found[1]), 1):
                unit = UNITS[vector.kind] if n <= 3 else "m"
                symbol = sp.Symbol(self.name(k, n), real=True)
                yield Definition(Quantity(symbol, unit), plain(x))

    def of(self, system: System, tree: Tree) -> tuple[VectorOf, ...]:
        """Return the vectors of a tree that a system has outputs of."""
        names = set(system.output_names)
        return tuple(v for k, v in enumerate(vectors_of(tree)) if self.name(k, 1) in names)


def vectors_of(tree: Tree) -> tuple[VectorOf, ...]:
    """Return all vectors that a tree can have, loads first and weights last; some are zero at all times."""
    return tuple(v for row in _ROWS for v in row(tree))


def _loads(tree: Tree) -> Iterator[VectorOf]:
    for load in tree.loads:
        for kind in (FORCE, TORQUE):
            yield VectorOf(kind, LOAD, load.body, load.body, partial(_load, load, kind))


def _load(load: Load, kind: str, here: Moment) -> Arrow | None:
    given = here.vector(load.force if kind == FORCE else load.torque)
    if here.part(load.body) < 0:
        return None
    value = here.of_body(load.body, given) if load.axes == "body" else given
    return value, here.point(load.body, load.point)


def _jets(tree: Tree) -> Iterator[VectorOf]:
    for body in tree.bodies:
        own = [jet for jet in tree.jets if jet.body == body.name]
        for jet, rate in zip(own, rates(body, own), strict=True):
            thrust = partial(_jet, jet.body, rate, jet.velocity, jet.point)
            yield VectorOf(FORCE, JET, jet.name, jet.body, thrust)


def _jet(body: str, rate: object, velocity: Vector, point: Vector, here: Moment) -> Arrow | None:
    """Return the thrust: the rate of the mass that leaves times the opposite of its velocity."""
    away = here.of_body(body, here.vector(velocity))
    return scaled(negative(here.arithmetic.lift(rate)), away), here.point(body, point)


def _joints(tree: Tree) -> Iterator[VectorOf]:
    for joint in tree.ordered:
        for kind, unit in ((TORQUE, "rad/s"), (FORCE, "m/s")):
            speeds = tuple(k for k, s in enumerate(joint.speeds) if s.unit == unit)
            if speeds and joint.motion is None:
                act = partial(_joint, joint, kind, speeds)
                yield VectorOf(kind, JOINT, joint.name, joint.child, act)


def _joint(joint: Joint, kind: str, speeds: Sequence[int], here: Moment) -> Arrow | None:
    """Return the sum of what acts in a joint along its axes, on its child."""
    first = here.lumped.parts[here.number[joint.name]].speeds.start
    return _along(here, joint, kind, {k: here.tau[first + k] for k in speeds})


def _along(here: Moment, joint: Joint, kind: str, forces: Mapping[int, Scalar]) -> Arrow:
    """Return a sum along the axes of a joint, by the numbers of its speeds."""
    k = here.number[joint.name]
    found: Vector = ZERO
    for n, force in forces.items():
        column = here.flow.placed[k].subspace[n]
        found = plus(found, scaled(force, column.angular if kind == TORQUE else column.linear))
    return here.turned(k, found), here.flow.poses[k][1]


def _springs(tree: Tree) -> Iterator[VectorOf]:
    for spring in tree.springs:
        for n, body in enumerate(spring.bodies):
            if body != GROUND:
                yield VectorOf(FORCE, SPRING, spring.name, body, partial(_spring, spring, n))


def _spring(spring: Spring, n: int, here: Moment) -> Arrow | None:
    *ends, force = here.ends[spring.name]
    place = ends[n].position
    return (negative_vector(force) if n else force), place


def _rotors(tree: Tree) -> Iterator[VectorOf]:
    for number, rotor in enumerate(tree.rotors):
        if rotor.speed is None:
            act = partial(_rotor, rotor, number, tree.body[rotor.body])
            yield VectorOf(TORQUE, ROTOR, rotor.name, rotor.body, act)


def _rotor(rotor: Rotor, number: int, body: Body, here: Moment) -> Arrow | None:
    """Return what motor and bearing do to the body: the opposite of what they do to the rotor."""
    part, spin = here.lumped.rotors[number]
    driving = spin.driving(here.flow.velocities[part].angular)
    there = here.turned(part, scaled(negative(driving), spin.axis))
    return there, here.point(rotor.body, body.centre)


def _constraints(tree: Tree) -> Iterator[VectorOf]:
    for c in tree.constraints:
        if isinstance(c, BETWEEN_POINTS):
            bodies = [(n, b) for n, b in enumerate(c.bodies) if b != GROUND]
            for n, body in bodies if isinstance(c, Distance) else bodies[-1:]:
                for kind in (FORCE, TORQUE):
                    yield VectorOf(kind, CONSTRAINT, c.name, body, partial(_held, c, n, body, kind))
            continue
        for joint in tree.ordered:
            for kind, unit in ((TORQUE, "rad/s"), (FORCE, "m/s")):
                act = partial(_geared, c, joint, kind, unit)
                yield VectorOf(kind, CONSTRAINT, c.name, joint.child, act)


def _held(c: Constraint, n: int, body: str, kind: str, here: Moment) -> Arrow | None:
    """Return force or torque of a constraint on a body.

    A row for the six unit motions of the body alone is the wrench of a unit multiplier on it, about the
    origin of its part; the torques of equations with a force are those of the arm to where it acts.
    """
    found, place, part = ZERO, None, here.part(body)
    for _, free, x in here.held.get(c.name, ()):
        if UNITS[kind] == free.unit:
            row, first = free.relation.row(), 6 * part + 3 * (kind == FORCE)
            found = plus(found, scaled(x, [row.get(first + k, 0) for k in range(3)]))
            place = free.relation.places()[min(n, len(free.relation.places()) - 1)]
    return None if place is None else (found, place)


def _geared(c: Constraint, joint: Joint, kind: str, unit: str, here: Moment) -> Arrow | None:
    """Return what a constraint between speeds does in a joint."""
    if joint.name not in here.number:
        return None
    speeds = here.lumped.parts[here.number[joint.name]].speeds
    own = [k for k, s in enumerate(joint.speeds) if s.unit == unit]
    forces: dict[int, Scalar] = {}
    for bound, _, x in here.held.get(c.name, ()):
        row = bound.relation.row()
        for k in (k for k in own if speeds.start + k in row):
            forces[k] = add(forces.get(k, 0), mul(x, row[speeds.start + k]))
    return _along(here, joint, kind, forces) if forces else None


def _reactions(tree: Tree) -> Iterator[VectorOf]:
    for joint in tree.ordered:
        if joint.kind != "free":
            yield VectorOf(FORCE, REACTION, joint.name, joint.child, partial(_reaction, joint))


def _reaction(joint: Joint, here: Moment) -> Arrow | None:
    """Return the force of the parent on the child; of a fixed joint, whose bodies are one part, none."""
    if here.prescribed is None or joint.name not in here.number:
        return None
    k = here.number[joint.name]
    return here.turned(k, here.through[k].linear), here.flow.poses[k][1]


def _weights(tree: Tree) -> Iterator[VectorOf]:
    for body in tree.bodies:
        yield VectorOf(FORCE, WEIGHT, body.name, body.name, partial(_weight, body))
    for body in tree.bodies:
        yield VectorOf(TORQUE, GRADIENT, body.name, body.name, partial(_gradient, body))


def _weight(body: Body, here: Moment) -> Arrow | None:
    """Return the weight at the centre of mass, of an uneven field that at this point.

    Where the field is linear in the position that is the whole force.
    """
    place = here.point(body.name, body.centre)
    field = here.lumped.gravity
    if here.lumped.gradient is not None:
        field = plus(field, times(here.lumped.gradient, place))
    return scaled(here.arithmetic.lift(body.mass), field), place


def _gradient(body: Body, here: Moment) -> Arrow | None:
    """Return the torque of the gradient of gravity about the centre of mass: see `attracted`."""
    gradient, seat = here.lumped.gradient, here.lumped.seats[body.name]
    if gradient is None:
        return None
    J = [here.vector(row) for row in body.central_inertia]
    C = seat.rotation if seat.part < 0 else product(seat.rotation, here.flow.poses[seat.part][0])
    A = product(gradient, product(transposed(C), product(J, C)))
    spread = [sub(A[i][j], A[j][i]) for i, j in ((1, 2), (2, 0), (0, 1))]
    return spread, here.point(body.name, body.centre)


def _motions(tree: Tree) -> Iterator[VectorOf]:
    for body in tree.bodies:
        yield VectorOf(OMEGA, MOTION, body.name, body.name, partial(_omega, body.name))
    yield VectorOf(MOMENTUM, MOTION, "", "", _momentum)


def _omega(body: str, here: Moment) -> Arrow | None:
    part = here.part(body)
    if part < 0:
        return None
    return here.turned(part, here.flow.velocities[part].angular), here.point(body, ZERO)


def _momentum(here: Moment) -> Arrow | None:
    """Return the angular momentum of all bodies about their centre of mass."""
    heavy = mass(here.flow)
    if is_zero(heavy):
        return None
    centre = scaled(reciprocal(heavy), first_moments(here.flow))
    whole: SpatialVector = momentum(here.flow)
    return minus(whole.angular, cross(centre, whole.linear)), centre


_ROWS: tuple[Callable[[Tree], Iterator[VectorOf]], ...] = (
    _loads, _jets, _joints, _springs, _rotors, _constraints, _reactions, _weights, _motions,
)  # fmt: skip
