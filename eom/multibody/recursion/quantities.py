"""Energy, momentum, centre of mass, velocities and Jacobians of a tree.

Featherstone, Rigid Body Dynamics Algorithms (2008), sec. 2.7, 4.4; conventions:
`eom.multibody.recursion.motion`.

Points of bodies: position, velocity and acceleration in the ground's axes, as outputs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from eom.errors import InputError, near_matches, typed_fields
from eom.multibody.algebra.scalars import Scalar, Work, add, mul, negative, sub, total
from eom.multibody.algebra.spatial import (
    ZERO,
    Matrix,
    SpatialVector,
    Vector,
    cross,
    dot,
    minus,
    negative_vector,
    plus,
    product,
    scaled,
    times,
    trace,
    transposed,
)
from eom.multibody.model.bodies import Joint
from eom.multibody.model.parts import BodyName, Part, Position
from eom.multibody.recursion.lumped_tree import LumpedTree
from eom.multibody.recursion.motion import (
    Place,
    Scalars,
    keep_pair,
    motion,
    places,
    poses,
    velocities,
)
from eom.multibody.recursion.recursions import accelerated

HALF = Fraction(1, 2)


@dataclass(frozen=True)
class Flow:
    """The motion of all parts: places, poses from the ground, velocities, momenta of single parts.

    ``velocities``: (angular velocity, velocity of the origin), ``momenta``: (angular momentum about the
    origin, momentum), all in the axes of the parts.
    """

    placed: Sequence[Place]
    poses: Sequence[tuple[Matrix, Vector]]
    velocities: Sequence[SpatialVector]
    momenta: Sequence[SpatialVector]


def flow(tree: LumpedTree, q: Scalars, u: Scalars, work: Work) -> Flow:
    """Return the motion of all parts for coordinates and speeds."""
    placed = places(tree, q, work)
    moved = motion(placed, u, work)
    speeds = velocities(placed, moved, work)
    momenta = []
    for place, (w, v) in zip(placed, speeds, strict=True):
        part = place.part
        L = plus(times(part.inertia.I, w), cross(part.first_moment, v))
        for spin in part.rotors:
            L = plus(L, scaled(spin.momentum, spin.axis))
        p = plus(scaled(part.mass, v), cross(w, part.first_moment))
        momenta.append(keep_pair(work, ("L", "p"), part.name, SpatialVector(L, p)))
    return Flow(placed, poses(placed, work), speeds, momenta)


def joint_forces(
    joint: Joint, q: Scalars, u: Scalars, lift: Callable[[Any], Scalar], work: Work
) -> list[Scalar]:
    """Return the generalised forces of a joint, one a speed: motor, applied force, damper, spring.

    ``q``, ``u``: its coordinates and speeds.
    """
    motors = [lift(m.symbol) for m in joint.motors if joint.motion is None] or [0] * len(u)
    found = []
    for k, coordinate in enumerate(joint.row.paired(joint.attitude)):
        force = add(motors[k], lift(joint.force[k]))
        force = sub(force, mul(lift(joint.damping[k]), u[k]))
        if coordinate is not None:
            stretch = sub(q[coordinate], lift(joint.rest[k]))
            force = sub(force, mul(lift(joint.stiffness[k]), stretch))
        suffix = joint.row.speeds(joint.attitude)[k].suffix
        found.append(work.keep("tau", joint.name, suffix, force))
    return found


def kinetic_energy(flow: Flow, u: Scalars) -> Scalar:
    """Return half the sum of momenta times velocities, with that of rotors in joints and bodies.

    What flows in bodies counts as if it did not: of its velocities nothing is known.
    """
    twice = total(dot(p.six, v.six) for p, v in zip(flow.momenta, flow.velocities, strict=True))
    for place, velocity in zip(flow.placed, flow.velocities, strict=True):
        for spin in place.part.rotors:
            twice = add(twice, spin.twice_energy(velocity.angular))
        for J, speed in zip(place.part.armature, u[place.part.speeds], strict=True):
            twice = add(twice, mul(J, mul(speed, speed)))
    return mul(HALF, twice)


def first_moments(flow: Flow) -> Vector:
    """Return mass times position of the centre of mass, in the ground's axes."""
    found: Vector = ZERO
    for place, (R, x) in zip(flow.placed, flow.poses, strict=True):
        part = place.part
        found = plus(found, plus(scaled(part.mass, x), times(transposed(R), part.first_moment)))
    return found


def mass(flow: Flow) -> Scalar:
    """Return the mass of everything that moves."""
    return total(place.part.mass for place in flow.placed)


def gravity_potential(tree: LumpedTree, flow: Flow) -> Scalar:
    """Return the potential energy in gravity, zero for a point mass at the ground's origin.

    A gradient G adds -x.G x/2 dm, with second moments tr(J)/2 - J.
    """
    found = negative(dot(tree.gravity, first_moments(flow)))
    if tree.gradient is None:
        return found
    G, spread = tree.gradient, trace(tree.gradient)
    for place, (R, x) in zip(flow.placed, flow.poses, strict=True):
        part, back = place.part, transposed(R)
        J = part.whole_inertia
        field, h = times(G, x), times(back, part.first_moment)
        turned = product(back, product(J, R))
        own = sub(mul(HALF, mul(trace(J), spread)), trace(product(G, turned)))
        twice = add(dot(field, plus(scaled(part.mass, x), plus(h, h))), own)
        found = sub(found, mul(HALF, twice))
    return found


def momentum(flow: Flow) -> SpatialVector:
    """Return angular momentum about the ground's origin and momentum, in the ground's axes.

    What flows in bodies relative to them is in both.
    """
    L: Vector = ZERO
    p: Vector = ZERO
    for place, (R, x), own in zip(flow.placed, flow.poses, flow.momenta, strict=True):
        back, (angular, linear) = transposed(R), own
        for stream in place.part.streams:
            spin, along = stream.relative
            angular, linear = plus(angular, spin), plus(linear, along)
        linear = times(back, linear)
        L = plus(L, plus(times(back, angular), cross(x, linear)))
        p = plus(p, linear)
    return SpatialVector(L, p)


def about_centre(flow: Flow, whole: SpatialVector) -> Vector:
    """Return the angular momentum about the centre of mass."""
    c = scaled(1 / mass(flow), first_moments(flow))
    return minus(whole.angular, cross(c, whole.linear))


def jacobian(
    tree: LumpedTree, q: Scalars, body: str, point: Vector, work: Work
) -> tuple[list[Vector], list[Vector]]:
    """Return the columns, one a speed, of angular velocity and of a point's velocity by the speeds.

    ``point``: of the body, from its origin, in its axes. Columns are in the ground's axes; those of
    speeds that do not move the body are zero by structure. The lumped_tree must turn with its parts.
    """
    placed = places(tree, q, work)
    posed = poses(placed, work)
    seat = tree.seats[body]
    angular: list[Vector] = [ZERO] * tree.speeds
    linear: list[Vector] = [ZERO] * tree.speeds
    k = seat.part
    end = ZERO if k < 0 else plus(posed[k][1], times(transposed(posed[k][0]), seat.point(point)))
    while k >= 0:
        back = transposed(posed[k][0])
        arm = plus(end, negative_vector(posed[k][1]))
        for n, column in enumerate(placed[k].subspace):
            s = placed[k].part.speeds.start + n
            angular[s] = times(back, column.angular)
            linear[s] = plus(times(back, column.linear), cross(angular[s], arm))
        k = placed[k].part.parent
    return angular, linear


QUANTITIES = {
    "position": ("x", "m"),
    "velocity": ("v", "m/s"),
    "acceleration": ("a", "m/s^2"),
}
"""What can be an output of a point: letter and unit."""


@typed_fields
@dataclass(frozen=True)
class Point(Part):
    """A point of a body with outputs ``x_<name>_1`` to 3, ``v_...`` and ``a_...``.

    Parameters
    ----------
    name : str
        Of the outputs.
    body : str
        Its name, or the ground.
    position : vector, optional
        In the body's axes, from its origin (m).
    quantities : tuple of str, optional
        Keys of `QUANTITIES`.

    Raises
    ------
    InputError
        For others.

    Notes
    -----
    Position (m), velocity (m/s) and acceleration (m/s^2) from the ground's origin, in the ground's
    axes.

    Examples
    --------
    >>> Point("tip", "rod", (0, 0, -1), ("velocity",)).names
    ('v_tip_1', 'v_tip_2', 'v_tip_3')
    """

    noun = "point"

    name: str
    body: BodyName
    position: Position = ZERO
    quantities: tuple[str, ...] = tuple(QUANTITIES)

    def complete(self) -> None:
        """Raise `InputError` for unknown quantities."""
        self._keep("quantities", tuple(self.quantities))
        for name in self.quantities:
            if name not in QUANTITIES:
                raise InputError(
                    f"unknown quantity {name!r}", where=self.where, expected=", ".join(QUANTITIES)
                )

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the outputs."""
        letters = (QUANTITIES[q][0] for q in self.quantities)
        return tuple(f"{letter}_{self.name}_{k}" for letter in letters for k in (1, 2, 3))


def point(
    given: Point,
    tree: LumpedTree,
    flow: Flow,
    speeds: tuple[Scalars, Scalars],
    lift: Callable[[Any], Scalar],
    work: Work,
) -> dict[str, Vector]:
    """Return the outputs of a point, by quantity.

    ``speeds``: those of the joints, and their rates. On the ground a point is at rest. Raises
    `InputError` for an unknown body.
    """
    if given.body not in tree.seats:
        raise InputError(
            f"unknown body {given.body!r}",
            where=f"point {given.name!r}",
            hint=near_matches(given.body, tree.seats),
        )
    seat = tree.seats[given.body]
    r = seat.point([lift(x) for x in given.position])
    if seat.part < 0:
        known = {"position": r, "velocity": ZERO, "acceleration": ZERO}
        return {name: known[name] for name in given.quantities}
    (R, x), (w, v) = flow.poses[seat.part], flow.velocities[seat.part]
    back = transposed(R)
    found: dict[str, Vector] = {
        "position": plus(x, times(back, r)),
        "velocity": times(back, plus(v, cross(w, r))),
    }
    if "acceleration" in given.quantities:
        u, udot = speeds
        moved = motion(flow.placed, u, work)
        alpha, a = accelerated(tree, flow.placed, moved, udot, work)[seat.part]
        turning = plus(cross(alpha, r), moved[seat.part].square.times(r))
        found["acceleration"] = plus(times(back, plus(a, turning)), tree.gravity)
    return {name: found[name] for name in given.quantities}
