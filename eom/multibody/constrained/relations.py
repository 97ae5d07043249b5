"""Scalar equations between points and directions of bodies: value, row of the Jacobian, drift.

A relation phi = 0 over coordinates and time has the rate ``row`` u + ``offset`` and the second rate
``row`` u' + ``drift``; a relation between speeds alone has no value. The multiplier of a relation is
the generalised force ``row``^T lambda. Vectors are in the ground's axes; see
`eom.multibody.constrained.relations`.

Points of bodies as constraints see them: place, motion and Jacobian columns, in the ground's axes.

Accelerations are those by velocities alone, every u' zero, without gravity; they are what is left of the
second derivative of a constraint beside J u'. Conventions and scalars: see
`eom.multibody.recursion.motion`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, NamedTuple

from eom.multibody.algebra.scalars import Scalar, Work, add, mul, negative, sub, total
from eom.multibody.algebra.spatial import (
    IDENTITY,
    ZERO,
    Matrix,
    SpatialVector,
    Vector,
    cross,
    dot,
    keep_matrix,
    keep_vector,
    matrix_of,
    minus,
    plus,
    product,
    scaled,
    times,
    transposed,
)
from eom.multibody.model.bodies import GROUND
from eom.multibody.recursion.lumped_tree import BodyPlacement, LumpedTree
from eom.multibody.recursion.motion import Place, Scalars, combined, places


@dataclass(frozen=True)
class AngularMotion:
    """Angular velocity and acceleration, velocity and acceleration of a point; see the module."""

    omega: Vector = ZERO
    alpha: Vector = ZERO
    velocity: Vector = ZERO
    acceleration: Vector = ZERO


@dataclass(frozen=True)
class PointKinematics:
    """A point of a body.

    ``position`` from the ground's origin. ``rotation``: from the ground's axes to the body's.
    ``columns``: by speed, angular velocity and velocity of the point that a unit of it gives.
    ``motion``: None while speeds are not known.
    """

    position: Vector
    rotation: Matrix
    columns: dict[int, SpatialVector]
    motion: AngularMotion | None

    @property
    def moving(self) -> AngularMotion:
        """The motion, which is known."""
        assert self.motion is not None
        return self.motion

    def direction(self, axis: Vector) -> Vector:
        """Return a direction that is fixed in the body, in the ground's axes."""
        return times(transposed(self.rotation), axis)


class Arithmetic(NamedTuple):
    """The kind of scalars: what makes them of a description's values, functions, square root."""

    lift: Callable[[Any], Scalar]
    work: Work
    sqrt: Callable[[Scalar], Scalar]


@dataclass(frozen=True)
class Scene:
    """All parts of a tree for given coordinates; with speeds, their motion too."""

    lumped: LumpedTree
    arithmetic: Arithmetic
    q: Scalars
    u: Scalars | None
    placed: Sequence[Place]
    poses: Sequence[tuple[Matrix, Vector]]
    motions: Sequence[AngularMotion]

    def vector(self, given: Any) -> Vector:
        """Return components of a description as scalars."""
        return [self.arithmetic.lift(x) for x in given]

    @property
    def work(self) -> Work:
        """What gives names."""
        return self.arithmetic.work

    def spot(self, body: str, point: Any = ZERO) -> PointKinematics:
        """Return a point of a body, given from its origin in its axes."""
        seat = self.lumped.seats[body]
        still = AngularMotion() if self.u is not None else None
        if seat.part < 0:
            return PointKinematics(seat.point(self.vector(point)), seat.rotation, {}, still)
        R, x = self.poses[seat.part]
        arm = times(transposed(R), seat.point(self.vector(point)))
        position = keep_vector(self.work, "spot", body, plus(x, arm))
        moved = None
        if self.u is not None:
            moved = _named(self.work, body, _at(self.motions[seat.part], arm))
        columns = self._columns(seat, position)
        return PointKinematics(position, product(seat.rotation, R), columns, moved)

    def ground(self) -> PointKinematics:
        """Return the ground's origin."""
        return self.spot(GROUND)

    def _columns(self, seat: BodyPlacement, position: Vector) -> dict[int, SpatialVector]:
        """Walk from a part to the ground: a turn moves the point by the arm from the joint."""
        found: dict[int, SpatialVector] = {}
        k = seat.part
        while k >= 0:
            place, (R, x) = self.placed[k], self.poses[k]
            arm = minus(position, x)
            for n, column in enumerate(place.subspace):
                angular, linear = (times(transposed(R), v) for v in column)
                name = place.part.name
                angular = keep_vector(self.work, "ground_axis", name, angular)
                found[place.part.speeds.start + n] = SpatialVector(
                    angular, plus(linear, cross(angular, arm))
                )
            k = place.part.parent
        return dict(sorted(found.items()))


def scene(
    lumped: LumpedTree,
    q: Scalars,
    u: Scalars | None,
    arithmetic: Arithmetic,
) -> Scene:
    """Return the parts for coordinates, and speeds if they are known."""
    work = arithmetic.work
    placed = places(lumped, q, work)
    found: list[tuple[Matrix, Vector]] = []
    motions: list[AngularMotion] = []
    for place in placed:
        name, parent = place.part.name, place.part.parent
        C, x = found[parent] if parent >= 0 else (IDENTITY, ZERO)
        R = keep_matrix(work, "pose", name, product(matrix_of(place.rotation), C))
        arm = times(transposed(C), place.position)
        found.append((R, keep_vector(work, "position", name, plus(x, arm))))
        if u is not None:
            carrier = motions[parent] if parent >= 0 else AngularMotion()
            motions.append(_moved(place, R, arm, carrier, u, work))
    return Scene(lumped, arithmetic, q, u, placed, found, motions)


@dataclass(frozen=True)
class _Loose(Scene):
    """A tree whose parts all move by themselves: six unit motions each, in the ground's axes."""

    def _columns(self, seat: BodyPlacement, position: Vector) -> dict[int, SpatialVector]:
        k = seat.part
        arm = minus(position, self.poses[k][1])
        turns = [SpatialVector(e, cross(e, arm)) for e in IDENTITY]
        return dict(enumerate([*turns, *(SpatialVector(ZERO, e) for e in IDENTITY)], 6 * k))


def loose(still: Scene) -> Scene:
    """Return a scene of the same places whose parts move by themselves.

    A row of coefficients is then the wrench of a unit multiplier on each part, by the principle of virtual
    power: of part k the moment about its origin at 6k, the force at 6k + 3, in the ground's axes.
    """
    return _Loose(still.lumped, still.arithmetic, still.q, None, still.placed, still.poses, ())


def _moved(
    place: Place, R: Matrix, arm: Vector, carrier: AngularMotion, u: Scalars, work: Work
) -> AngularMotion:
    """Return the motion of a part's origin, from that of its parent."""
    part = place.part
    own = u[part.speeds]
    back = transposed(R)
    w, v = (times(back, x) for x in combined(place.subspace, own))
    drift = [times(back, x) for x in part.kind.drift(place.subspace, own)]
    before = _at(carrier, arm)
    omega = keep_vector(work, "ground_omega", part.name, plus(carrier.omega, w))
    alpha = plus(plus(carrier.alpha, cross(carrier.omega, w)), drift[0])
    sideways = plus(cross(plus(carrier.omega, omega), v), drift[1])
    return AngularMotion(
        omega,
        keep_vector(work, "ground_alpha", part.name, alpha),
        keep_vector(work, "ground_v", part.name, plus(before.velocity, v)),
        keep_vector(work, "ground_a", part.name, plus(before.acceleration, sideways)),
    )


def _named(work: Work, name: str, moved: AngularMotion) -> AngularMotion:
    """Return the motion of a point under names."""
    return replace(
        moved,
        velocity=keep_vector(work, "spot_v", name, moved.velocity),
        acceleration=keep_vector(work, "spot_a", name, moved.acceleration),
    )


def _at(carrier: AngularMotion, arm: Vector) -> AngularMotion:
    """Return the motion of another point of the same body."""
    turned = cross(carrier.omega, arm)
    fall = plus(cross(carrier.alpha, arm), cross(carrier.omega, turned))
    return AngularMotion(
        carrier.omega,
        carrier.alpha,
        plus(carrier.velocity, turned),
        plus(carrier.acceleration, fall),
    )


Row = Mapping[int, Scalar]
"""Coefficients by speed; what is left out is zero by structure."""


class Relation:
    """What all relations have."""

    def value(self) -> Scalar | None:
        """Return phi, or None."""
        return None

    def row(self) -> Row:
        """Return the coefficients of the speeds in the rate of phi."""
        raise NotImplementedError

    def offset(self) -> Scalar:
        """Return what is left of that rate without speeds."""
        return 0

    def drift(self) -> Scalar:
        """Return what is left of the second rate without u'."""
        raise NotImplementedError

    def side(self) -> Scalar | None:
        """Return what is positive on the right side where the equation holds on two; or None."""
        return None

    def places(self) -> tuple[Vector, ...]:
        """Return where its force acts on each body of the constraint, in order; none within joints."""
        return ()


def difference(first: Row, second: Row) -> Row:
    """Return second less first."""
    found = {k: sub(second.get(k, 0), first.get(k, 0)) for k in {**second, **first}}
    return dict(sorted(found.items()))


def velocity_row(spot: PointKinematics, direction: Vector) -> Row:
    """Return the coefficients of the velocity of a point along a direction."""
    return {k: dot(direction, column.linear) for k, column in spot.columns.items()}


def turning_row(spot: PointKinematics, direction: Vector) -> Row:
    """Return the coefficients of the angular velocity about a direction."""
    return {k: dot(direction, column.angular) for k, column in spot.columns.items()}


def summed(*rows: Row) -> Row:
    """Return the sum of rows."""
    found = {k: total(row.get(k, 0) for row in rows) for row in rows for k in row}
    return dict(sorted(found.items()))


@dataclass(frozen=True)
class Apart(Relation):
    """The distance from one point to another along a direction that a body carries is zero."""

    direction: Vector
    carrier: PointKinematics
    first: PointKinematics
    second: PointKinematics

    @property
    def _d(self) -> Vector:
        return minus(self.second.position, self.first.position)

    def value(self) -> Scalar:
        """Return e . d."""
        return dot(self.direction, self._d)

    def row(self) -> Row:
        """The rate is e . d' + omega . (e x d)."""
        apart = difference(
            velocity_row(self.first, self.direction), velocity_row(self.second, self.direction)
        )
        return summed(apart, turning_row(self.carrier, cross(self.direction, self._d)))

    def drift(self) -> Scalar:
        """Return e . d'' + 2 e' . d' + (alpha x e + omega x e') . d."""
        one, two, carrier = self.first.moving, self.second.moving, self.carrier.moving
        turning = cross(carrier.omega, self.direction)
        bend = plus(cross(carrier.alpha, self.direction), cross(carrier.omega, turning))
        apart = dot(self.direction, minus(two.acceleration, one.acceleration))
        sideways = mul(2, dot(turning, minus(two.velocity, one.velocity)))
        return add(add(apart, sideways), dot(bend, self._d))

    def places(self) -> tuple[Vector, ...]:
        """Return both points."""
        return self.first.position, self.second.position


@dataclass(frozen=True)
class Square(Relation):
    """The cosine between a direction of one body and one of another is constant."""

    g: Vector
    first: PointKinematics
    h: Vector
    second: PointKinematics
    cosine: Scalar = 0
    alike: tuple[Vector, Vector] | None = None
    """Two directions that coincide where the joint is as it should be, and not turned round."""

    def side(self) -> Scalar | None:
        """Return the cosine between the directions that coincide."""
        return None if self.alike is None else dot(*self.alike)

    def value(self) -> Scalar:
        """Return g . h less its value."""
        return sub(dot(self.g, self.h), self.cosine)

    def row(self) -> Row:
        """The rate is (h x g) . (omega_2 - omega_1)."""
        about = cross(self.h, self.g)
        return difference(turning_row(self.first, about), turning_row(self.second, about))

    def drift(self) -> Scalar:
        """Return (h x g) . (alpha_2 - alpha_1) + (h x g)' . (omega_2 - omega_1)."""
        one, two = self.first.moving, self.second.moving
        turned = plus(
            cross(cross(two.omega, self.h), self.g), cross(self.h, cross(one.omega, self.g))
        )
        return add(
            dot(cross(self.h, self.g), minus(two.alpha, one.alpha)),
            dot(turned, minus(two.omega, one.omega)),
        )

    def places(self) -> tuple[Vector, ...]:
        """Return the origins of the joint's frames."""
        return self.first.position, self.second.position


@dataclass(frozen=True)
class Rod(Relation):
    """Two points keep their distance: (d . d - length^2) / (2 length) is zero."""

    first: PointKinematics
    second: PointKinematics
    length: Scalar
    inverse: Scalar

    @property
    def _d(self) -> Vector:
        return minus(self.second.position, self.first.position)

    def value(self) -> Scalar:
        """Return half the square of the distance over the length, less half the length."""
        half = Fraction(1, 2)
        square = mul(mul(half, self.inverse), dot(self._d, self._d))
        return sub(square, mul(half, self.length))

    def row(self) -> Row:
        """The rate is d . d' / length."""
        along = scaled(self.inverse, self._d)
        return difference(velocity_row(self.first, along), velocity_row(self.second, along))

    def drift(self) -> Scalar:
        """Return (d . d'' + d' . d') / length."""
        one, two = self.first.moving, self.second.moving
        v = minus(two.velocity, one.velocity)
        along = dot(self._d, minus(two.acceleration, one.acceleration))
        return mul(self.inverse, add(along, dot(v, v)))

    def places(self) -> tuple[Vector, ...]:
        """Return both points."""
        return self.first.position, self.second.position


@dataclass(frozen=True)
class Edge(Relation):
    """A point of a body has no velocity along a direction of the body."""

    direction: Vector
    spot: PointKinematics

    def row(self) -> Row:
        """Return the coefficients of the velocity along the direction."""
        return velocity_row(self.spot, self.direction)

    def drift(self) -> Scalar:
        """Return e . v' + (omega x e) . v."""
        moving = self.spot.moving
        turned = cross(moving.omega, self.direction)
        return add(dot(self.direction, moving.acceleration), dot(turned, moving.velocity))

    def places(self) -> tuple[Vector, ...]:
        """Return the point."""
        return (self.spot.position,)


@dataclass(frozen=True)
class Contact:
    """Where a wheel, ellipsoid of revolution or ball touches a plane: the arm to there from its centre.

    An ellipsoid with axis a on a plane of normal n: the arm is -radius e with e = (n - w m a) / s,
    m = n . a, s^2 = 1 - w m^2, the gradient of its height over the plane. ``oblate``:
    w = 1 - (half axis / radius)^2, 1 for a wheel. ``inverse``: 1 / s; None for a ball, whose arm is
    -radius n.
    """

    centre: PointKinematics
    radius: Scalar
    normal: Vector
    axis: Vector
    inverse: Scalar | None
    oblate: Scalar = 1

    @property
    def up(self) -> Vector:
        """The direction from the point of contact to the centre."""
        if self.inverse is None:
            return self.normal
        along = mul(self.oblate, dot(self.normal, self.axis))
        level = minus(self.normal, scaled(along, self.axis))
        return scaled(self.inverse, level)

    @property
    def arm(self) -> Vector:
        """From the centre to the point of contact."""
        return scaled(negative(self.radius), self.up)

    def arm_rate(self) -> Vector:
        """Return -radius e', e' = -w (m' a + m a') / s + w e m m' / s^2."""
        if self.inverse is None:
            return [0, 0, 0]
        turned = cross(self.centre.moving.omega, self.axis)
        m, rate = (mul(self.oblate, dot(self.normal, x)) for x in (self.axis, turned))
        sideways = plus(scaled(rate, self.axis), scaled(m, turned))
        along = mul(mul(self.inverse, self.inverse), mul(dot(self.normal, self.axis), rate))
        found = minus(scaled(along, self.up), scaled(self.inverse, sideways))
        return scaled(negative(self.radius), found)


@dataclass(frozen=True)
class Roll(Relation):
    """The point of a body that touches a plane has no velocity along a direction of the ground.

    ``height``: of the plane, along its normal, where the direction is the normal; None otherwise.
    """

    contact: Contact
    direction: Vector
    height: Scalar | None

    def value(self) -> Scalar | None:
        """Return the height of the lowest point of the body over the plane."""
        if self.height is None:
            return None
        touching = plus(self.contact.centre.position, self.contact.arm)
        return sub(dot(self.direction, touching), self.height)

    def row(self) -> Row:
        """The rate is t . (v + omega x arm)."""
        spot, t = self.contact.centre, self.direction
        return summed(velocity_row(spot, t), turning_row(spot, cross(self.contact.arm, t)))

    def drift(self) -> Scalar:
        """Return t . (v' + alpha x arm + omega x arm')."""
        moving: AngularMotion = self.contact.centre.moving
        turned = plus(
            cross(moving.alpha, self.contact.arm), cross(moving.omega, self.contact.arm_rate())
        )
        return dot(self.direction, plus(moving.acceleration, turned))

    def places(self) -> tuple[Vector, ...]:
        """Return the point of contact."""
        return (plus(self.contact.centre.position, self.contact.arm),)


@dataclass(frozen=True)
class Sum(Relation):
    """A sum of given coefficients, as equations of the user have them.

    ``phi``: None between speeds alone. ``bend``: the drift, None while speeds are not known.
    """

    phi: Scalar | None
    coefficients: Row
    rest: Scalar
    bend: Scalar | None

    def value(self) -> Scalar | None:
        """Return phi."""
        return self.phi

    def row(self) -> Row:
        """Return the coefficients."""
        return self.coefficients

    def offset(self) -> Scalar:
        """Return what has no speed."""
        return self.rest

    def drift(self) -> Scalar:
        """Return the drift, which is known."""
        assert self.bend is not None
        return self.bend
