"""Scalar equations between points and directions of bodies: value, row of the Jacobian, drift.

A relation phi = 0 over coordinates and time has the rate ``row`` u + ``offset`` and the second rate
``row`` u' + ``drift``; a relation between speeds alone has no value. The multiplier of a relation is
the generalised force ``row``^T lambda. Vectors are in the ground's axes; see
`eom.multibody.constrained.point_kinematics`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from eom.multibody.algebra.scalars import Scalar, add, mul, negative, sub, total
from eom.multibody.algebra.spatial import Vector, cross, dot, minus, plus, scaled
from eom.multibody.constrained.point_kinematics import AngularMotion, PointKinematics

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


@dataclass(frozen=True)
class Contact:
    """Where a wheel or ball touches a plane: the arm to that point from its centre.

    A wheel with axis a on a plane of normal n: the arm is -radius e with e = (n - (n . a) a) / s,
    s = |n x a|. ``inverse``: 1 / s; None for a ball, whose arm is -radius n.
    """

    centre: PointKinematics
    radius: Scalar
    normal: Vector
    axis: Vector
    inverse: Scalar | None

    @property
    def up(self) -> Vector:
        """The direction from the point of contact to the centre."""
        if self.inverse is None:
            return self.normal
        level = minus(self.normal, scaled(dot(self.normal, self.axis), self.axis))
        return scaled(self.inverse, level)

    @property
    def arm(self) -> Vector:
        """From the centre to the point of contact."""
        return scaled(negative(self.radius), self.up)

    def arm_rate(self) -> Vector:
        """Return -radius e', e' = -(m' a + m a') / s + e m m' / s^2 with m = n . a."""
        if self.inverse is None:
            return [0, 0, 0]
        turned = cross(self.centre.moving.omega, self.axis)
        m, rate = dot(self.normal, self.axis), dot(self.normal, turned)
        sideways = plus(scaled(rate, self.axis), scaled(m, turned))
        along = mul(mul(self.inverse, self.inverse), mul(m, rate))
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
