"""Rotors: bodies of revolution that spin in bearings of a body, as momentum along an axis.

A rotor of axial moment J, whose axis a is fixed in a body, adds momentum along a alone; mass and inertia
of the body include those of the rotor at rest in it. Of a rotor with a speed of its own the state is
Omega, its whole angular velocity along a: with the torque tau of motor and bearing, J Omega' = tau, the
body feels -tau, and it turns without the moment J about a. A rotor of given speed sigma in the body adds
the momentum J sigma. Either momentum h adds omega x (h a) to the moment that the body takes.
Source: Hughes, Spacecraft Attitude Dynamics (1986), sec. 3.3 (the gyrostat) and 6.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from eom.multibody.algebra.scalars import Scalar, add, mul, reciprocal, sub
from eom.multibody.algebra.spatial import Matrix, Vector, cross, dot, plus, scaled


@dataclass(frozen=True)
class Spin:
    """A rotor over scalars: axis in its part's axes, axial moment, speed and what drives it.

    ``free``: whether ``speed`` is Omega; ``torque`` is then that of the motor, and ``damping`` brakes the
    speed in the body. Otherwise ``speed`` is sigma, and ``acceleration`` its rate.
    """

    axis: Vector
    inertia: Scalar
    speed: Scalar
    free: bool
    torque: Scalar = 0
    damping: Scalar = 0
    acceleration: Scalar = 0

    @property
    def momentum(self) -> Scalar:
        """J times the speed: what the rotor adds to the angular momentum along its axis."""
        return mul(self.inertia, self.speed)

    def relative(self, omega: Vector) -> Scalar:
        """Return the speed of the rotor in its body."""
        return sub(self.speed, dot(self.axis, omega)) if self.free else self.speed

    def driving(self, omega: Vector) -> Scalar:
        """Return the torque on the rotor along its axis."""
        if not self.free:
            return mul(self.inertia, self.acceleration)
        return sub(self.torque, mul(self.damping, self.relative(omega)))

    def rate(self, omega: Vector) -> Scalar:
        """Return Omega'."""
        return mul(reciprocal(self.inertia), self.driving(omega))

    def moment(self, omega: Vector) -> Vector:
        """Return the moment that the body takes beyond its own."""
        gyroscopic = cross(omega, scaled(self.momentum, self.axis))
        return plus(gyroscopic, scaled(self.driving(omega), self.axis))

    def twice_energy(self, omega: Vector) -> Scalar:
        """Return twice the kinetic energy less what momentum times angular velocity counts of it."""
        carried = dot(self.axis, omega)
        beyond = sub(self.speed, carried) if self.free else add(self.speed, carried)
        return mul(self.momentum, beyond)


def without_axial(J: Matrix, spins: Sequence[Spin]) -> Matrix:
    """Return an inertia without the axial moments of the rotors that have speeds of their own."""
    for spin in (s for s in spins if s.free):
        a = spin.axis
        J = [
            [sub(J[i][j], mul(spin.inertia, mul(a[min(i, j)], a[max(i, j)]))) for j in range(3)]
            for i in range(3)
        ]
    return J
