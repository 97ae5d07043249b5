"""Equations of a mechanism by Newton and Euler: balances of momentum, reactions eliminated.

Accelerations follow from body to body by the law of relative accelerations; each body's balance of
forces and of moments gives what its joint must carry beside what it hands on; along the directions that
a joint leaves free it carries nothing but what acts there, and these rows are the equations. Energies and
partial velocities do not occur. Source: Wittenburg, Dynamics of Multibody Systems (2008), ch. 5; the
law of accelerations: Kane and Levinson, Dynamics (1985), sec. 2.7, 2.8.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from eom.multibody.algebra.scalars import is_zero
from eom.multibody.algebra.spatial import (
    IDENTITY,
    ZERO,
    Matrix,
    SpatialVector,
    Vector,
    cross,
    dot,
    negative_vector,
    plus,
    product,
    scaled,
    times,
    transposed,
)
from eom.multibody.closed.mechanism import Mechanism
from eom.multibody.closed.polynomials import Scalar
from eom.multibody.closed.terms import Contribution


class Moved(NamedTuple):
    """The motion of a link, in its axes: of its origin, and angular."""

    omega: Vector
    alpha: Vector
    acceleration: Vector


class Wrench(NamedTuple):
    """What a body takes or what acts on it: moment about the origin and force, and what it stems from."""

    link: int
    source: str
    label: str
    moment: Vector
    force: Vector


@dataclass(frozen=True)
class NewtonEuler:
    """The steps of the method, each made when it is asked for; vectors are in the links' axes."""

    mechanism: Mechanism

    @cached_property
    def motions(self) -> list[Moved]:
        """Angular velocities, angular accelerations, accelerations of the origins."""
        found: list[Moved] = []
        for link in self.mechanism.links:
            w, alpha, a = found[link.parent] if link.parent >= 0 else Moved(ZERO, ZERO, ZERO)
            r, C = link.position, link.rotation
            carried = plus(a, plus(cross(alpha, r), cross(w, cross(w, r))))
            w, alpha, a = times(C, w), times(C, alpha), times(C, carried)
            speed, rate = self._relative(link.start, link.subspace)
            found.append(
                Moved(
                    plus(w, speed.angular),
                    plus(plus(alpha, cross(w, speed.angular)), rate.angular),
                    plus(
                        plus(a, scaled(2, cross(w, speed.linear))),
                        plus(rate.linear, cross(speed.angular, speed.linear)),
                    ),
                )
            )
        return found

    def _relative(
        self, start: int, subspace: Iterable[SpatialVector]
    ) -> tuple[SpatialVector, SpatialVector]:
        """Return the motion of a joint and its rate, component by component in F."""
        w, v = ZERO, ZERO
        for k, column in enumerate(subspace):
            u = self.mechanism.joint_speeds[start + k]
            w = plus(w, scaled(u, column.angular))
            v = plus(v, scaled(u, column.linear))
        rate = self.mechanism.rate_of
        return SpatialVector(w, v), SpatialVector(rate(w), rate(v))

    def acceleration(self, k: int, point: Vector) -> Vector:
        """Return the acceleration of a point of a link."""
        w, alpha, a = self.motions[k]
        return plus(a, plus(cross(alpha, point), cross(w, cross(w, point))))

    @cached_property
    def rotations(self) -> list[Matrix]:
        """From the ground's axes to those of each link."""
        found: list[Matrix] = []
        for link in self.mechanism.links:
            before = found[link.parent] if link.parent >= 0 else IDENTITY
            found.append(product(link.rotation, before))
        return found

    # -- balances of single bodies -------------------------------------------------------------

    def momentum_rate(self, k: int) -> SpatialVector:
        """Return the rates of angular momentum about the centre of mass, and of momentum."""
        link = self.mechanism.links[k]
        w, alpha, _ = self.motions[k]
        spin = plus(times(link.inertia, alpha), cross(w, times(link.inertia, w)))
        return SpatialVector(spin, scaled(link.mass, self.acceleration(k, link.centre)))

    def wrenches(self) -> Iterator[Wrench]:
        """Yield what the joints must carry for each body: rates of momentum less forces on it."""
        for k, link in enumerate(self.mechanism.links):
            spin, force = self.momentum_rate(k)
            moment = plus(spin, cross(link.centre, force))
            yield Wrench(k, "motion", f"momentum of {link.name}", moment, force)
            if not is_zero(link.mass):
                g = times(self.rotations[k], self.mechanism.gravity)
                weight = negative_vector(scaled(link.mass, g))
                yield Wrench(
                    k, "gravity", f"weight of {link.name}", cross(link.centre, weight), weight
                )
        for pull in self.mechanism.pulls:
            k, force, torque = pull.link, pull.force, pull.torque
            if pull.grounded:
                force, torque = (times(self.rotations[k], x) for x in (force, torque))
            label = f"load on {self.mechanism.links[k].name}"
            yield Wrench(k, "applied", label, plus(torque, cross(pull.point, force)), force)

    # -- the equations -----------------------------------------------------------------------

    def along_joints(self, wrench: Wrench) -> dict[int, Scalar]:
        """Return what a wrench on a link asks of every joint on the way to the ground, where it is free."""
        found: dict[int, Scalar] = {}
        k, n, f = wrench.link, wrench.moment, wrench.force
        while k >= 0:
            link = self.mechanism.links[k]
            for s, column in zip(link.speeds, link.subspace, strict=True):
                found[s] = dot(column.angular, n) + dot(column.linear, f)
            f = times(transposed(link.rotation), f)
            n = plus(times(transposed(link.rotation), n), cross(link.position, f))
            k = link.parent
        return found

    def joint_rows(self) -> Iterator[tuple[int, str, str, Scalar]]:
        """Yield (number of the joint's speed, source, label, value)."""
        for wrench in self.wrenches():
            for s, value in self.along_joints(wrench).items():
                yield s, wrench.source, wrench.label, value
        yield from self._in_joints()

    def _in_joints(self) -> Iterator[tuple[int, str, str, Scalar]]:
        """Yield what acts in the joints themselves: rotors, springs, dampers, motors."""
        start, algebra = 0, self.mechanism.algebra
        for link in self.mechanism.links:
            joint = link.joint
            paired = joint.row.paired(joint.attitude)
            for k, s in enumerate(link.speeds):
                u, at = self.mechanism.joint_speeds[s], f"in {joint.name}"
                rotor = algebra.lift(joint.armature[k]) * self.mechanism.rate(u)
                yield s, "motion", f"rotor {at}", rotor
                c = paired[k]
                if c is not None:
                    stretch = self.mechanism.coordinates[start + c] - algebra.lift(joint.rest[k])
                    yield s, "spring", f"spring {at}", algebra.lift(joint.stiffness[k]) * stretch
                yield s, "damper", f"damper {at}", algebra.lift(joint.damping[k]) * u
                motor = algebra.atom(joint.motors[k].symbol) if joint.motors else 0
                yield s, "applied", f"force {at}", motor + algebra.lift(joint.force[k])
            start += len(joint.coordinates)

    def contributions(self) -> list[Contribution]:
        """Return the free rows of the joints' balances, over the chosen speeds."""
        found = []
        for s, source, label, value in self.joint_rows():
            for row, chosen in enumerate(self.mechanism.free):
                part = self.mechanism.part(self.mechanism.joint_speeds[s], chosen)
                if not is_zero(part) and not is_zero(value):
                    found.append(Contribution(row, source, label, part * value))
        return found
