"""Points of bodies as constraints see them: place, motion and Jacobian columns, in the ground's axes.

Accelerations are those by velocities alone, every u' zero, without gravity; they are what is left of the
second derivative of a constraint beside J u'. Conventions and scalars: see
`eom.multibody.recursion.motion`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from eom.multibody.algebra.scalars import Scalar, Work
from eom.multibody.algebra.spatial import (
    IDENTITY,
    ZERO,
    Matrix,
    SpatialVector,
    Vector,
    cross,
    keep_matrix,
    keep_vector,
    matrix_of,
    minus,
    plus,
    product,
    times,
    transposed,
)
from eom.multibody.model.model import GROUND
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

    bones: LumpedTree
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
        seat = self.bones.seats[body]
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
    bones: LumpedTree,
    q: Scalars,
    u: Scalars | None,
    arithmetic: Arithmetic,
) -> Scene:
    """Return the parts for coordinates, and speeds if they are known."""
    work = arithmetic.work
    placed = places(bones, q, work)
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
    return Scene(bones, arithmetic, q, u, placed, found, motions)


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
