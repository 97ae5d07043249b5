"""What acts on bodies or spins in them, as frozen values: loads, rotors and springs.

Every number may be a SymPy expression instead; units are SI, angles are in radians.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import sympy as sp

from eom.errors import InputError, entries, shown, typed_fields
from eom.multibody.algebra import values
from eom.multibody.algebra.scalars import is_zero
from eom.multibody.algebra.spatial import ZERO
from eom.multibody.algebra.values import Value, is_number
from eom.multibody.model.bodies import GROUND
from eom.multibody.model.parts import ACTING, MOVING, Axis, BodyName, Kind, Length, Part
from eom.quantities import TIME, Quantity


@typed_fields
@dataclass(frozen=True)
class Load(Part):
    """A force (N) that acts at a ``point`` of a body, and a torque (N m) on it.

    Parameters
    ----------
    body : str
        Its name.
    force : numbers or expressions, optional
        In N, (3,).
    torque : numbers or expressions, optional
        In N m, (3,).
    point : numbers or expressions, optional
        Where the force acts, in the body's axes, from its origin (m), (3,).
    axes : str, default "ground"
        The axes of force and torque: ``body`` or ``ground``.

    Raises
    ------
    InputError
        For other axes and for text.

    Notes
    -----
    Components may be numbers or expressions over parameters, inputs, time and states.
    """

    noun = "load"

    body: BodyName
    force: Annotated[Any, Kind("vector", ACTING, unit="N")] = ZERO
    torque: Annotated[Any, Kind("vector", ACTING, unit="N m")] = ZERO
    point: Annotated[Any, Kind("vector", ACTING, unit="m")] = ZERO
    axes: Annotated[str, Kind("axes")] = GROUND

    @property
    def where(self) -> str:
        """How errors name it."""
        return f"load on {self.body!r}"

    def complete(self) -> None:
        """Raise `InputError` for other axes."""
        if self.axes not in {"body", GROUND}:
            expected = f"body or {GROUND}"
            raise InputError("unknown axes", where=self.where, got=self.axes, expected=expected)


@typed_fields
@dataclass(frozen=True)
class Rotor(Part):
    """A body of revolution that spins in bearings of a ``body``: a reaction wheel, a gyroscope, a motor.

    Parameters
    ----------
    name : str
        Of the rotor, and its symbols.
    body : str
        Whose bearings hold it.
    axis : str or vector, default "z"
        In the body's axes.
    inertia : number or expression, default 0
        Its moment about the axis (kg m^2), which the body's inertia includes.
    damping : number or expression, default 0
        Of its speed in the body (N m s).
    torque : number or expression, default 0
        That drives it (N m); it acts on the rotor, its opposite on the body.
    motor : bool, default False
        Whether an input ``tau_<name>`` drives it, too.
    angle : bool, default False
        Whether the angle in the body, ``q_<name>``, is a state too.
    speed : numbers or expressions, optional
        Its speed in the body as an expression of time (rad/s), in place of a state.

    Raises
    ------
    InputError
        For a moment that is not positive, and a given speed together with what drives it.

    Notes
    -----
    With a speed of its own there is a state ``Omega_<name>``, the rotor's whole angular velocity
    along the axis (rad/s).

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), sect. 3.3 and 6.2.
    """

    noun = "rotor"

    name: str
    body: BodyName
    axis: Axis = "z"
    inertia: Annotated[Value, Kind("number", needed=True, unit="kg m^2")] = 0
    damping: Annotated[Value, Kind("number", unit="N m s")] = 0
    torque: Annotated[Value, Kind("number", ACTING, unit="N m")] = 0
    motor: bool = False
    angle: bool = False
    speed: Annotated[Any, Kind("number", MOVING, optional=True, unit="rad/s")] = None

    def complete(self) -> None:
        """Raise `InputError` for a moment that is not positive, and for two ways to say how it spins."""
        J = self.inertia
        if (is_number(J) and J <= 0) or getattr(J, "is_positive", None) is False:
            raise InputError("inertia is not positive", where=self.where, got=J, expected="kg m^2")
        driven = self.motor or self.angle or not (is_zero(self.torque) and is_zero(self.damping))
        if self.speed is not None and driven:
            raise InputError(
                "a given speed leaves no room for torque, damping, motor and angle",
                where=self.where,
            )

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
        if values.is_number(self.speed):
            return 0
        return values.value(sp.diff(self.speed, TIME), f"{self.where}: rate of the speed")


@typed_fields
@dataclass(frozen=True)
class Spring(Part):
    """A spring and damper between a point of one body and one of another, or of the ground.

    Parameters
    ----------
    name : str
        Of the spring, and its symbols.
    bodies : tuple of str, str
        Two names.
    points : numbers or expressions, optional
        One of each, in its axes, from its origin (m).
    stiffness : number or expression, default 0
        In N/m; the tension is this times the distance less the length.
    length : number or expression, default 0
        The free length (m).
    damping : number or expression, default 0
        In N s/m; the tension grows by this times the rate of the distance.

    Raises
    ------
    InputError
        For other than two bodies and two points.

    Notes
    -----
    Its direction is lost where the points coincide, unless length and damping are zero.
    """

    noun = "spring"

    name: str
    bodies: Annotated[tuple[str, str], Kind("body", keys=("first", "second"))]
    points: Annotated[Any, Kind("vector", keys=("first_point", "second_point"), unit="m")] = (
        ZERO,
        ZERO,
    )
    stiffness: Annotated[Value, Kind("number", unit="N/m")] = 0
    length: Length = 0
    damping: Annotated[Value, Kind("number", unit="N s/m")] = 0

    def complete(self) -> None:
        """Raise `InputError` for other than two points."""
        points = entries(self.points, f"{self.where}: points")
        if len(points) != 2:
            raise InputError("not two points", where=self.where, got=shown(self.points))
        self._keep("bodies", tuple(self.bodies))
        self._keep("points", tuple(values.triple(p, f"{self.where}: point") for p in points))
