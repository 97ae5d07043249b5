"""Equations of a mechanism by Lagrange: from kinetic and potential energy, and virtual work.

Positions in the ground's axes are differentiated; forces and accelerations of bodies do not occur. Where
speeds are no rates of coordinates the equations are those of Boltzmann and Hamel, which are Lagrange's
where they are. X_s f is the sum over the coordinates of df/dq times how fast speed s moves q.
Source: Greenwood, Advanced Dynamics (2003), ch. 2 and 4.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

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
    plus,
    product,
    scaled,
    times,
    transposed,
)
from eom.multibody.closed.mechanism import Link, Mechanism
from eom.multibody.closed.polynomials import Scalar
from eom.multibody.closed.terms import Contribution

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
        for link in self.mechanism.links:
            for c, u in zip(link.joint.damping, self.mechanism.own(link), strict=True):
                found = found + self.mechanism.algebra.lift(c) * u * u * HALF
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
            if joint.motion is not None or None not in joint.row.paired(joint.attitude):
                continue
            first = self._first(link)
            for i in range(len(joint.speeds)):
                for j in range(len(joint.speeds)):
                    c = _combination(_bracket(link.subspace[i], link.subspace[j]), link.subspace)
                    shifted = {first + r: x for r, x in c.items()}
                    self._test(first + i, first + j, shifted)
                    found[first + i, first + j] = shifted
        return found

    def _first(self, link: Link) -> int:
        """Return the number, among all speeds, of the first of a joint."""
        names = [u.symbol for u in self.mechanism.speeds]
        return names.index(link.joint.speeds[0].symbol)

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
        found, algebra = [], self.mechanism.algebra
        for link in self.mechanism.links:
            for k, u in enumerate(self.mechanism.own(link)):
                joint = link.joint
                force = algebra.lift(joint.force[k])
                if joint.motors:
                    force = force + algebra.atom(joint.motors[k].symbol)
                value = force * self.mechanism.part(u, s)
                found.append(Contribution(row, "applied", f"work at {joint.name}", value))
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
