"""Equations of a mechanism by Lagrange: from kinetic and potential energy, and virtual work.

Positions in the ground's axes are differentiated; forces and accelerations of bodies do not occur. Where
speeds are no rates of coordinates the equations are those of Boltzmann and Hamel, which are Lagrange's
where they are. X_s f is the sum over the coordinates of df/dq times how fast speed s moves q.
Source: Greenwood, Advanced Dynamics (2003), ch. 2 and 4.

Equations of a mechanism by Kane: partial velocities, generalised active and inertia forces.

Velocities are added from body to body, in the axes of each; accelerations are their derivatives in
time; every force counts by how much each speed moves the point where it acts. Neither energies nor
reactions occur. Source: Kane and Levinson, Dynamics: Theory and Applications (1985), sec. 2.14, 4.4,
4.11, 6.1: F_r + F_r* = 0.

Equations of a mechanism by Newton and Euler: balances of momentum, reactions eliminated.

Accelerations follow from body to body by the law of relative accelerations; each body's balance of
forces and of moments gives what its joint must carry beside what it hands on; along the directions that
a joint leaves free it carries nothing but what acts there, and these rows are the equations. Energies and
partial velocities do not occur. Source: Wittenburg, Dynamics of Multibody Systems (2008), ch. 5; the
law of accelerations: Kane and Levinson, Dynamics (1985), sec. 2.7, 2.8.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from eom.derivations.verification import DerivationError
from eom.multibody.algebra.scalars import is_zero, negative
from eom.multibody.algebra.spatial import (
    IDENTITY,
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
    transposed,
)
from eom.multibody.closed.mechanism import Link, Mechanism
from eom.multibody.closed.polynomials import Scalar
from eom.multibody.closed.readable import Contribution

HALF = Fraction(1, 2)


@dataclass(frozen=True)
class Lagrange:
    """The steps of the method, each made when it is asked for."""

    mechanism: Mechanism

    def moved(self, x: Scalar, s: int) -> Scalar:
        """Return X_s x: how fast a unit of one speed changes ``x``."""
        return self.mechanism.algebra.along(x, self.mechanism.basis[s])

    @cached_property
    def poses(self) -> list[tuple[Matrix, Vector]]:
        """Rotation from the ground and position of the origin in the ground's axes, of each link."""
        found: list[tuple[Matrix, Vector]] = []
        for link in self.mechanism.links:
            C, x = found[link.parent] if link.parent >= 0 else (IDENTITY, ZERO)
            step = times(transposed(C), link.position)
            found.append((product(link.rotation, C), plus(x, step)))
        return found

    def point(self, k: int, position: Vector) -> Vector:
        """Return a point of a link (from its origin, in its axes) in the ground's axes."""
        C, x = self.poses[k]
        return plus(x, times(transposed(C), position))

    @cached_property
    def centres(self) -> list[Vector]:
        """Positions of the centres of mass."""
        return [self.point(k, link.centre) for k, link in enumerate(self.mechanism.links)]

    def velocity(self, x: Vector, s: int) -> Vector:
        """Return what one speed adds to the velocity of a point: X_s x."""
        return [self.moved(c, s) for c in x]

    def turning(self, k: int, s: int) -> Vector:
        """Return what one speed adds to the angular velocity, in the link's axes: tilde = -(X_s C) C^T."""
        C = self.poses[k][0]
        rates = [[self.moved(c, s) for c in row] for row in C]
        tilde = product(rates, transposed(C))
        return [tilde[1][2], tilde[2][0], tilde[0][1]]

    @cached_property
    def motions(self) -> list[SpatialVector]:
        """Angular velocity (in the link's axes) and velocity of the centre of mass (in the ground's)."""
        found = []
        for k, x in enumerate(self.centres):
            w, v = ZERO, ZERO
            for s, u in enumerate(self.mechanism.speeds):
                speed = self.mechanism.algebra.atom(u.symbol)
                w = plus(w, scaled(speed, self.turning(k, s)))
                v = plus(v, scaled(speed, self.velocity(x, s)))
            found.append(SpatialVector(w, v))
        return found

    def _energy(self, link: Link, motion: SpatialVector) -> Scalar:
        w, v = motion
        return (link.mass * dot(v, v) + dot(w, times(link.inertia, w))) * HALF

    @cached_property
    def energies(self) -> list[Scalar]:
        """Kinetic energies of the bodies."""
        return [
            self._energy(link, motion)
            for link, motion in zip(self.mechanism.links, self.motions, strict=True)
        ]

    @cached_property
    def kinetic(self) -> Scalar:
        """Kinetic energy of bodies and rotors."""
        found: Scalar = 0
        for energy in self.energies:
            found = found + energy
        for _, J, u in self.mechanism.rotors():
            found = found + J * u * u * HALF
        return found

    @cached_property
    def gravity(self) -> Scalar:
        """Potential energy of gravity, zero at the ground's origin."""
        found: Scalar = 0
        for link, x in zip(self.mechanism.links, self.centres, strict=True):
            found = found - link.mass * dot(self.mechanism.gravity, x)
        return found

    @cached_property
    def springs(self) -> Scalar:
        """Potential energy of the springs of joints."""
        algebra, found, start = self.mechanism.algebra, 0, 0
        for link in self.mechanism.links:
            joint = link.joint
            for k, c in enumerate(joint.row.paired(joint.attitude)):
                if c is not None and not is_zero(joint.stiffness[k]):
                    q = self.mechanism.coordinates[start + c]
                    stretch = q - algebra.lift(joint.rest[k])
                    found = found + algebra.lift(joint.stiffness[k]) * stretch * stretch * HALF
            start += len(joint.coordinates)
        return found

    @cached_property
    def dissipation(self) -> Scalar:
        """Rayleigh's function: half the power that dampers take."""
        found: Scalar = 0
        for _, k, source, drag in self.mechanism.in_joints():
            if source == "damper":
                found = found + drag * self.mechanism.joint_speeds[k] * HALF
        return found

    @cached_property
    def momenta(self) -> dict[int, Scalar]:
        """dT/du of every speed."""
        speeds = range(len(self.mechanism.speeds))
        return {s: self.mechanism.part(self.kinetic, s) for s in speeds}

    def brackets(self, s: int) -> Scalar:
        """Return the sum over i, r of c u_i dT/du_r, where X_s X_i - X_i X_s = sum of c X_r."""
        found: Scalar = 0
        for (a, i), coefficients in self._structure.items():
            speed = self.mechanism.algebra.atom(self.mechanism.speeds[i].symbol)
            for r, c in coefficients.items() if a == s else ():
                found = found + c * speed * self.momenta[r]
        return found

    @cached_property
    def _structure(self) -> dict[tuple[int, int], dict[int, Scalar]]:
        """The coefficients c of two speeds of one joint; those of rates of coordinates are zero.

        They are those of the motions that the speeds stand for; that the brackets of the coordinates'
        rates are the same combinations is tested for each pair, in exact arithmetic.
        """
        found = {}
        for link in self.mechanism.links:
            joint = link.joint
            first = self._first(link)
            if (
                joint.motion is not None
                or None not in joint.row.paired(joint.attitude)
                or first < 0
            ):
                continue
            for i in range(len(joint.speeds)):
                for j in range(len(joint.speeds)):
                    c = _combination(_bracket(link.subspace[i], link.subspace[j]), link.subspace)
                    shifted = {first + r: x for r, x in c.items()}
                    self._test(first + i, first + j, shifted)
                    found[first + i, first + j] = shifted
        return found

    def _first(self, link: Link) -> int:
        """Return the number, among all speeds, of the first of a joint's own; -1 where rates are chosen."""
        own = [self.mechanism.algebra.named(u.symbol) for u in link.joint.speeds[:1]]
        found = (k for k, u in enumerate(self.mechanism.speeds) if u.symbol in own)
        return next(found, -1)

    def _test(self, i: int, j: int, coefficients: dict[int, Scalar]) -> None:
        basis = self.mechanism.basis
        for q in basis[i].keys() | basis[j].keys():
            bracket = self.moved(basis[j].get(q, 0), i) - self.moved(basis[i].get(q, 0), j)
            for r, c in coefficients.items():
                bracket = bracket - c * basis[r].get(q, 0)
            if not is_zero(bracket):
                raise DerivationError("the speeds of a joint do not fit its coordinates", got=q)

    # -- the equations -----------------------------------------------------------------------

    def contributions(self) -> list[Contribution]:
        """Return d/dt(dT/du) - X T + brackets + X V + dR/du = Q, by parts."""
        found = []
        for row, s in enumerate(self.mechanism.free):
            p = self.momenta[s]
            found += [
                Contribution(row, "motion", "d/dt(dT/du)", self.mechanism.rate(p)),
                Contribution(row, "motion", "-dT/dq", negative(self.moved(self.kinetic, s))),
                Contribution(row, "motion", "brackets", self.brackets(s)),
                Contribution(row, "gravity", "dV/dq", self.moved(self.gravity, s)),
                Contribution(row, "spring", "dV/dq", self.moved(self.springs, s)),
                Contribution(row, "damper", "dR/du", self.mechanism.part(self.dissipation, s)),
                *self._work(row, s),
            ]
        return found

    def _work(self, row: int, s: int) -> list[Contribution]:
        """Return the virtual work of motors, applied forces and loads, for a unit of one speed."""
        found = []
        for joint, k, source, force in self.mechanism.in_joints():
            if source == "applied":
                value = force * self.mechanism.part(self.mechanism.joint_speeds[k], s)
                found.append(Contribution(row, source, f"work at {joint.name}", value))
        for pull in self.mechanism.pulls:
            C = self.poses[pull.link][0]
            v = self.velocity(self.point(pull.link, pull.point), s)
            w = self.turning(pull.link, s)
            if pull.grounded:
                w = times(transposed(C), w)
            else:
                v = times(C, v)
            value = dot(pull.force, v) + dot(pull.torque, w)
            label = f"work on {self.mechanism.links[pull.link].name}"
            found.append(Contribution(row, "applied", label, value))
        return found


def _bracket(a: SpatialVector, b: SpatialVector) -> SpatialVector:
    """Return the bracket of two constant motions in the moving frame."""
    linear = minus(cross(a.angular, b.linear), cross(b.angular, a.linear))
    return SpatialVector(cross(a.angular, b.angular), linear)


def _combination(motion: SpatialVector, subspace: tuple[SpatialVector, ...]) -> dict[int, Scalar]:
    """Return a motion over the unit motions of a joint."""
    six = motion.six
    return {
        r: six[column.six.index(1)]
        for r, column in enumerate(subspace)
        if not is_zero(six[column.six.index(1)])
    }


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
                g = times(self.mechanism.rotations[k], self.mechanism.gravity)
                weight = negative(link.mass * dot(v, g))
                yield Contribution(row, "gravity", f"-F of {link.name}", weight)
        for link, J, u in self.mechanism.rotors():
            part = self.mechanism.part(u, s) * J * self.mechanism.rate(u)
            yield Contribution(row, "motion", f"-F* of the rotor of {link.joint.name}", part)

    def _joints(self, row: int, s: int) -> Iterator[Contribution]:
        for joint, k, source, value in self.mechanism.in_joints():
            part = self.mechanism.part(self.mechanism.joint_speeds[k], s)
            label = f"{'F' if source == 'applied' else '-F'} of {joint.name}"
            yield Contribution(row, source, label, value * part)

    def _pulls(self, row: int, s: int) -> Iterator[Contribution]:
        for pull in self.mechanism.pulls:
            force, torque = self.mechanism.pull_of(pull)
            part = self.mechanism.part_of
            v = part(self.velocity(pull.link, pull.point), s)
            w = part(self.origins[pull.link].angular, s)
            label = f"F of the load on {self.mechanism.links[pull.link].name}"
            yield Contribution(row, "applied", label, dot(force, v) + dot(torque, w))


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
                g = times(self.mechanism.rotations[k], self.mechanism.gravity)
                weight = negative_vector(scaled(link.mass, g))
                yield Wrench(
                    k, "gravity", f"weight of {link.name}", cross(link.centre, weight), weight
                )
        for pull in self.mechanism.pulls:
            k, (force, torque) = pull.link, self.mechanism.pull_of(pull)
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
        names = {"spring": "spring", "damper": "damper", "applied": "force"}
        for link in self.mechanism.links:
            for s, armature in zip(link.speeds, link.joint.armature, strict=True):
                rate = self.mechanism.rate(self.mechanism.joint_speeds[s])
                value = self.mechanism.algebra.lift(armature) * rate
                yield s, "motion", f"rotor in {link.joint.name}", value
        for joint, s, source, value in self.mechanism.in_joints():
            yield s, source, f"{names[source]} in {joint.name}", value

    def contributions(self) -> list[Contribution]:
        """Return the free rows of the joints' balances, over the chosen speeds."""
        found = []
        for s, source, label, value in self.joint_rows():
            for row, chosen in enumerate(self.mechanism.free):
                part = self.mechanism.part(self.mechanism.joint_speeds[s], chosen)
                if not is_zero(part) and not is_zero(value):
                    found.append(Contribution(row, source, label, part * value))
        return found
