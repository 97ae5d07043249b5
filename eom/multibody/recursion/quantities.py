"""Energy, momentum, centre of mass, velocities and Jacobians of a tree.

Featherstone, Rigid Body Dynamics Algorithms (2008), sec. 2.7, 4.4; conventions:
`eom.multibody.recursion.motion`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from eom.multibody.algebra.scalars import Scalar, Work, add, mul, negative, total
from eom.multibody.algebra.spatial import (
    ZERO,
    Matrix,
    Pair,
    Vector,
    cross,
    dot,
    minus,
    negative_vector,
    plus,
    scaled,
    times,
    transposed,
)
from eom.multibody.recursion.motion import (
    Place,
    Scalars,
    keep_pair,
    motion,
    places,
    poses,
    velocities,
)
from eom.multibody.recursion.skeleton import Skeleton

HALF = Fraction(1, 2)


@dataclass(frozen=True)
class Flow:
    """The motion of all parts: places, poses from the ground, velocities, momenta of single parts.

    ``velocities``: (angular velocity, velocity of the origin), ``momenta``: (angular momentum about the
    origin, momentum), all in the axes of the parts.
    """

    placed: Sequence[Place]
    poses: Sequence[tuple[Matrix, Vector]]
    velocities: Sequence[Pair]
    momenta: Sequence[Pair]


def flow(tree: Skeleton, q: Scalars, u: Scalars, work: Work) -> Flow:
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
        momenta.append(keep_pair(work, ("L", "p"), part.name, Pair(L, p)))
    return Flow(placed, poses(placed, work), speeds, momenta)


def kinetic_energy(flow: Flow, u: Scalars) -> Scalar:
    """Return half the sum of momenta times velocities, with that of rotors in joints and bodies."""
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


def gravity_potential(tree: Skeleton, flow: Flow) -> Scalar:
    """Return the potential energy in gravity, zero at the ground's origin."""
    return negative(dot(tree.gravity, first_moments(flow)))


def momentum(flow: Flow) -> Pair:
    """Return angular momentum about the ground's origin and momentum, in the ground's axes."""
    L: Vector = ZERO
    p: Vector = ZERO
    for (R, x), own in zip(flow.poses, flow.momenta, strict=True):
        back = transposed(R)
        linear = times(back, own.linear)
        L = plus(L, plus(times(back, own.angular), cross(x, linear)))
        p = plus(p, linear)
    return Pair(L, p)


def about_centre(flow: Flow, whole: Pair) -> Vector:
    """Return the angular momentum about the centre of mass."""
    c = scaled(1 / mass(flow), first_moments(flow))
    return minus(whole.angular, cross(c, whole.linear))


def jacobian(
    tree: Skeleton, q: Scalars, body: str, point: Vector, work: Work
) -> tuple[list[Vector], list[Vector]]:
    """Return the columns, one a speed, of angular velocity and of a point's velocity by the speeds.

    ``point``: of the body, from its origin, in its axes. Columns are in the ground's axes; those of
    speeds that do not move the body are zero by structure. The skeleton must turn with its parts.
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
