"""Equations of a mechanism by Kane: partial velocities, generalised active and inertia forces.

Velocities are added from body to body, in the axes of each; accelerations are their derivatives in
time; every force counts by how much each speed moves the point where it acts. Neither energies nor
reactions occur. Source: Kane and Levinson, Dynamics: Theory and Applications (1985), sec. 2.14, 4.4,
4.11, 6.1: F_r + F_r* = 0.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from eom.multibody.algebra.scalars import is_zero, negative
from eom.multibody.algebra.spatial import (
    IDENTITY,
    ZERO,
    Matrix,
    SpatialVector,
    Vector,
    cross,
    dot,
    plus,
    product,
    scaled,
    times,
)
from eom.multibody.closed.mechanism import Mechanism
from eom.multibody.closed.polynomials import Scalar
from eom.multibody.closed.terms import Contribution


@dataclass(frozen=True)
class Kane:
    """The steps of the method, each made when it is asked for; vectors are in the links' axes."""

    mechanism: Mechanism

    @cached_property
    def origins(self) -> list[SpatialVector]:
        """Angular velocities and velocities of the origins."""
        found: list[SpatialVector] = []
        for link in self.mechanism.links:
            w, v = found[link.parent] if link.parent >= 0 else SpatialVector(ZERO, ZERO)
            w, v = (
                times(link.rotation, w),
                times(link.rotation, plus(v, cross(w, link.position))),
            )
            for column, u in zip(link.subspace, self.mechanism.own(link), strict=True):
                w = plus(w, scaled(u, column.angular))
                v = plus(v, scaled(u, column.linear))
            found.append(SpatialVector(w, v))
        return found

    def velocity(self, k: int, point: Vector) -> Vector:
        """Return the velocity of a point of a link."""
        w, v = self.origins[k]
        return plus(v, cross(w, point))

    @cached_property
    def centres(self) -> list[Vector]:
        """Velocities of the centres of mass."""
        return [self.velocity(k, link.centre) for k, link in enumerate(self.mechanism.links)]

    @cached_property
    def accelerations(self) -> list[SpatialVector]:
        """Angular accelerations and accelerations of the centres of mass, by differentiation."""
        found = []
        for (w, _), v in zip(self.origins, self.centres, strict=True):
            rate = self.mechanism.rate_of
            found.append(SpatialVector(rate(w), plus(rate(v), cross(w, v))))
        return found

    def partial(self, k: int, s: int) -> SpatialVector:
        """Return partial angular velocity, and partial velocity of the centre of mass."""
        part = self.mechanism.part_of
        return SpatialVector(part(self.origins[k].angular, s), part(self.centres[k], s))

    def inertia_torque(self, k: int) -> Vector:
        """Return J alpha + omega x J omega about the centre of mass: less the inertia torque."""
        J, w = self.mechanism.links[k].inertia, self.origins[k].angular
        return plus(times(J, self.accelerations[k].angular), cross(w, times(J, w)))

    def inertia_force(self, k: int) -> Vector:
        """Return m a of the centre of mass: less the inertia force."""
        return scaled(self.mechanism.links[k].mass, self.accelerations[k].linear)

    @cached_property
    def rotations(self) -> list[Matrix]:
        """From the ground's axes to those of each link."""
        found: list[Matrix] = []
        for link in self.mechanism.links:
            before = found[link.parent] if link.parent >= 0 else IDENTITY
            found.append(product(link.rotation, before))
        return found

    # -- the equations -----------------------------------------------------------------------

    def contributions(self) -> list[Contribution]:
        """Return -F_r* of every body, and F_r, by parts."""
        found = []
        for row, s in enumerate(self.mechanism.free):
            found += [*self._bodies(row, s), *self._joints(row, s), *self._pulls(row, s)]
        return found

    def _bodies(self, row: int, s: int) -> Iterator[Contribution]:
        for k, link in enumerate(self.mechanism.links):
            w, v = self.partial(k, s)
            inertia = dot(v, self.inertia_force(k)) + dot(w, self.inertia_torque(k))
            yield Contribution(row, "motion", f"-F* of {link.name}", inertia)
            if not is_zero(link.mass):
                g = times(self.rotations[k], self.mechanism.gravity)
                weight = negative(link.mass * dot(v, g))
                yield Contribution(row, "gravity", f"-F of {link.name}", weight)
        for link, J, u in self.mechanism.rotors():
            part = self.mechanism.part(u, s) * J * self.mechanism.rate(u)
            yield Contribution(row, "motion", f"-F* of the rotor of {link.joint.name}", part)

    def _joints(self, row: int, s: int) -> Iterator[Contribution]:
        start, algebra = 0, self.mechanism.algebra
        for link in self.mechanism.links:
            joint = link.joint
            paired = joint.row.paired(joint.attitude)
            for k, u in enumerate(self.mechanism.own(link)):
                part = self.mechanism.part(u, s)
                c = paired[k]
                if c is not None:
                    stretch = self.mechanism.coordinates[start + c] - algebra.lift(joint.rest[k])
                    pull = algebra.lift(joint.stiffness[k]) * stretch * part
                    yield Contribution(row, "spring", f"-F of {joint.name}", pull)
                drag = algebra.lift(joint.damping[k]) * u * part
                yield Contribution(row, "damper", f"-F of {joint.name}", drag)
                force = algebra.lift(joint.force[k])
                if joint.motors:
                    force = force + algebra.atom(joint.motors[k].symbol)
                yield Contribution(row, "applied", f"F of {joint.name}", force * part)
            start += len(joint.coordinates)

    def _pulls(self, row: int, s: int) -> Iterator[Contribution]:
        for pull in self.mechanism.pulls:
            k = pull.link
            force, torque = pull.force, pull.torque
            if pull.grounded:
                force, torque = (times(self.rotations[k], x) for x in (force, torque))
            part = self.mechanism.part_of
            v = part(self.velocity(k, pull.point), s)
            w = part(self.origins[k].angular, s)
            value: Scalar = dot(force, v) + dot(torque, w)
            yield Contribution(
                row, "applied", f"F of the load on {self.mechanism.links[k].name}", value
            )
