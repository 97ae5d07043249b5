"""What bodies carry beside their joints: rotors, and springs between points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.errors import InputError, entries, shown, typed_fields
from eom.multibody.algebra import values
from eom.multibody.algebra.scalars import is_zero
from eom.multibody.algebra.spatial import ZERO
from eom.multibody.algebra.values import Value, is_number
from eom.multibody.model import checks
from eom.quantities import TIME, Quantity


@typed_fields
@dataclass(frozen=True)
class Rotor:
    """A body of revolution that spins in bearings of a ``body``: a reaction wheel, a gyroscope, a motor.

    ``axis``: in the body's axes. ``inertia``: its moment about the axis (kg m^2), which the body's
    inertia includes. With a speed of its own there is a state ``Omega_<name>``, the rotor's whole angular
    velocity along the axis (rad/s), driven by ``torque`` (N m), if ``motor`` by an input ``tau_<name>``,
    and braked by ``damping`` (N m s) of its speed in the body; ``angle``: whether the angle in the body,
    ``q_<name>``, is a state too. ``speed``: instead, its speed in the body as an expression of time.

    ``torque`` and ``tau_<name>`` act on the rotor, their opposites on the body. Raises `InputError` for a
    moment that is not positive, and a given speed together with what drives it.
    Source: Hughes, Spacecraft Attitude Dynamics (1986), sect. 3.3 and 6.2.
    """

    name: str
    body: str
    axis: Any = (0, 0, 1)
    inertia: Value = 0
    damping: Value = 0
    torque: Value = 0
    motor: bool = False
    angle: bool = False
    speed: Any = None

    def __post_init__(self) -> None:
        where = f"rotor {self.name!r}"
        checks.name(self.name, where)
        keep = object.__setattr__
        keep(self, "axis", values.unit(self.axis, f"{where}: axis"))
        for name in ("inertia", "damping", "torque"):
            keep(self, name, values.value(getattr(self, name), f"{where}: {name}"))
        if self.speed is not None:
            keep(self, "speed", values.value(self.speed, f"{where}: speed"))
        _consistent(self)

    @property
    def states(self) -> tuple[Quantity, ...]:
        """The angle, if it is a state, and the angular velocity."""
        if self.speed is not None:
            return ()
        angle = Quantity(sp.Symbol(f"q_{self.name}", real=True), "rad", f"angle of {self.name}")
        meaning = f"angular velocity of {self.name} along its axis, its body's included"
        omega = Quantity(sp.Symbol(f"Omega_{self.name}", real=True), "rad/s", meaning)
        return (angle, omega) if self.angle else (omega,)

    @property
    def motors(self) -> tuple[Quantity, ...]:
        """The input of the motor, if there is one."""
        symbol = sp.Symbol(f"tau_{self.name}", real=True)
        return (Quantity(symbol, "N m", f"motor of {self.name}"),) if self.motor else ()

    @property
    def acceleration(self) -> Value:
        """The rate of a given speed (rad/s^2). Raises `InputError` where it is no real expression."""
        return (
            0
            if values.is_number(self.speed)
            else values.value(sp.diff(self.speed, TIME), f"rotor {self.name!r}: rate of the speed")
        )


@typed_fields
@dataclass(frozen=True)
class Spring:
    """A spring and damper between a point of one body and one of another, or of the ground.

    ``bodies``: two names. ``points``: one of each, in its axes, from its origin (m). The tension is
    ``stiffness`` (N/m) times the distance less the free ``length`` (m), and ``damping`` (N s/m) times
    the rate of the distance. Its direction is lost where the points coincide, unless length and damping
    are zero. Raises `InputError` for other than two bodies and two points.
    """

    name: str
    bodies: tuple[str, str]
    points: Any = (ZERO, ZERO)
    stiffness: Value = 0
    length: Value = 0
    damping: Value = 0

    def __post_init__(self) -> None:
        where = f"spring {self.name!r}"
        checks.name(self.name, where)
        keep = object.__setattr__
        points = entries(self.points, f"{where}: points")
        if len(points) != 2:
            raise InputError("not two points", where=where, got=shown(self.points))
        keep(self, "bodies", tuple(self.bodies))
        keep(self, "points", tuple(values.triple(p, f"{where}: point") for p in points))
        for name in ("stiffness", "length", "damping"):
            keep(self, name, values.value(getattr(self, name), f"{where}: {name}"))


def _consistent(given: Rotor) -> None:
    """Raise `InputError` for a moment that is not positive, and for two ways to say how it spins."""
    where = f"rotor {given.name!r}"
    J = given.inertia
    if (is_number(J) and J <= 0) or getattr(J, "is_positive", None) is False:
        raise InputError("inertia is not positive", where=where, got=J, expected="kg m^2")
    driven = given.motor or given.angle or not (is_zero(given.torque) and is_zero(given.damping))
    if given.speed is not None and driven:
        raise InputError(
            "a given speed leaves no room for torque, damping, motor and angle", where=where
        )
