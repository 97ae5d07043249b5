"""Bodies and the joints between them, as frozen values.

Every number may be a SymPy expression instead; units are SI, angles are in radians.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import sympy as sp

from eom.errors import InputError, entries, typed_fields, unknown_name
from eom.kinematics.coordinates import SEQUENCES
from eom.multibody.algebra import values
from eom.multibody.algebra.spatial import IDENTITY, ZERO, Matrix
from eom.multibody.algebra.values import Value
from eom.multibody.model import checks
from eom.multibody.model.joints import ALONE, KINDS, QUATERNION
from eom.multibody.model.joints import Kind as JointKind
from eom.multibody.model.parts import (
    ACTING,
    CENTRE,
    MOVING,
    ORIGIN,
    PLAIN,
    Axis,
    Kind,
    Length,
    Part,
    Position,
    kinds,
)
from eom.quantities import TIME, Quantity

GROUND = "ground"
"""What does not move: the parent of the first joints, with the axes that are inertial."""


@typed_fields
@dataclass(frozen=True)
class Body(Part):
    """A rigid body with axes of its own.

    Parameters
    ----------
    name : str
        Of the body, and its symbols.
    mass : number or expression, default 0
        In kg; a body of mass 0 has no inertia.
    centre : numbers or expressions, optional
        Of mass, from the body's origin, in its axes (m), (3,).
    inertia : numbers or expressions, optional
        Three principal moments or a symmetric matrix (kg m^2), (3,) or (3, 3), J12 = -integral of
        r1 r2 dm.
    about : numbers or expressions, default "centre"
        What the inertia is about: the ``centre`` of mass, the ``origin``, or a point (m).
    axes : numbers or expressions, optional
        C, (3, 3), takes components in the body's axes to those in the axes in which the inertia is
        given.

    Raises
    ------
    InputError
        For a mass below zero, and an inertia in numbers that no body has.

    Notes
    -----
    All may change in time, by a `Jet` through which mass leaves.

    Examples
    --------
    >>> Body("rod", mass=3, centre=(0, 0, -1), inertia=(4, 4, 0), about="origin").central_inertia[0]
    (1, 0, 0)
    """

    noun = "body"

    name: str
    mass: Annotated[Value, Kind("number", PLAIN, unit="kg")] = 0
    centre: Annotated[Any, Kind("vector", PLAIN, unit="m")] = ZERO
    inertia: Annotated[Any, Kind("inertia", PLAIN, unit="kg m^2")] = ZERO
    about: Annotated[Any, Kind("place", PLAIN, unit="m")] = CENTRE
    axes: Annotated[Any, Kind("rotation", unit="1")] = IDENTITY

    def complete(self) -> None:
        """Raise `InputError` for an inertia that no body has."""
        checks.body(self.mass, self.central_inertia, self.where)

    @property
    def point(self) -> tuple[Value, ...]:
        """The point (m) that the inertia is about, from the origin, in the body's axes, (3,)."""
        known = {CENTRE: self.centre, ORIGIN: ZERO}
        return tuple(known[self.about] if isinstance(self.about, str) else self.about)

    @cached_property
    def central_inertia(self) -> Matrix:
        """The inertia (kg m^2) about the centre of mass, in the body's axes: by Huygens and Steiner.

        Shape (3, 3), as rows.
        """
        return checks.central(self.inertia, self.axes, self.mass, self.centre, self.point)

    @property
    def turned_inertia(self) -> Matrix:
        """The inertia (kg m^2) about the point that it is given about, in the body's axes, (3, 3)."""
        return checks.central(self.inertia, self.axes, 0, self.centre, self.point)

    @property
    def values(self) -> Iterator[Value]:
        """Mass, centre of mass and inertia about it."""
        yield from (self.mass, *self.centre, *(x for row in self.central_inertia for x in row))


@typed_fields
@dataclass(frozen=True)
class Placement(Part):
    """Where a joint's frame is on a body.

    Parameters
    ----------
    position : vector, optional
        Of its origin (m), in the body's axes, (3,).
    rotation : numbers or expressions, optional
        C, (3, 3), takes components in the body's axes to components in the joint's.

    Raises
    ------
    InputError
        For a matrix that is no rotation.
    """

    noun = "placement of a joint"

    position: Position = ZERO
    rotation: Annotated[Any, Kind("rotation", unit="1")] = IDENTITY


HERE = Placement()


@dataclass(frozen=True)
class Motion(Part):
    """A prescribed motion: coordinates as expressions of time, and their two derivatives.

    Parameters
    ----------
    position : tuple of numbers or expressions
        One expression of time a coordinate of the joint (rad, m); a constant locks the joint.
    rate : tuple of numbers or expressions, optional
        Its derivative (rad/s, m/s), which follows by differentiation where it is left out; give it
        where it is an input.
    acceleration : tuple of numbers or expressions, optional
        The derivative of that, in the same way.

    Raises
    ------
    InputError
        For what is no number or expression.
    """

    noun = "prescribed motion"

    position: Annotated[tuple[Value, ...], Kind("each", MOVING, each=("rad", "m"))]
    rate: Annotated[
        tuple[Value, ...] | None, Kind("each", MOVING, optional=True, each=("rad/s", "m/s"))
    ] = None
    acceleration: Annotated[
        tuple[Value, ...] | None, Kind("each", MOVING, optional=True, each=("rad/s^2", "m/s^2"))
    ] = None

    def complete(self) -> None:
        """Derive the rates that are left out, and raise `InputError` for what is no expression."""
        for name in ("position", "rate", "acceleration"):
            given = getattr(self, name)
            if given is not None or name == "position":
                is_list = isinstance(given, Sequence) and not isinstance(given, str | bytes)
                parts = entries(given, f"{name} of a motion") if is_list else (given,)
                self._keep(name, tuple(values.value(p, self.where) for p in parts))
        if self.rate is None:
            self._keep("rate", _derivatives(self.position))
        if self.acceleration is None:
            self._keep("acceleration", _derivatives(self.rate or ()))


def _derivatives(expressions: Iterable[Value]) -> tuple[Value, ...]:
    found = (0 if values.is_number(e) else sp.diff(e, TIME) for e in expressions)
    return tuple(values.value(e, "prescribed motion") for e in found)


@typed_fields
@dataclass(frozen=True)
class Joint(Part):
    """A joint from a ``parent`` (a body, or the ground) to its ``child``.

    Parameters
    ----------
    name : str
        Of the joint, and its coordinates and speeds.
    kind : str
        A row of `eom.multibody.model.joints.KINDS`.
    parent : str
        A body, or the ground.
    child : str
        The body that hangs on it.
    axis : str or vector, default "z"
        ``x``, ``-y``, ... or three components, in the joint's frame; of a universal joint the first
        axis.
    second_axis : str or vector, default "x"
        Of a universal joint the other axis.
    pitch : number or expression, default 0
        Of a helical joint (m/rad).
    attitude : str, default "quaternion"
        Of a spherical or free joint, ``quaternion`` or a sequence.
    on_parent, on_child : Placement, optional
        Where the joint's two frames are; they coincide at zero coordinates.
    stiffness : numbers or expressions, default 0
        N m/rad or N/m at each speed that is the rate of a coordinate.
    rest : numbers or expressions, default 0
        Where the spring has no force (rad or m).
    damping : numbers or expressions, default 0
        N m s/rad or N s/m at each speed.
    armature : numbers or expressions, default 0
        The inertia of a motor's rotor seen through its gear (kg m^2 or kg).
    force : numbers or expressions, default 0
        An applied force or torque (N or N m) on the child in the direction of the speed, its
        opposite on the parent.
    motor : bool, default False
        Whether there is an input ``tau_<joint>`` (of several speeds ``tau_<joint>_<letter>``).
    motion : Motion, optional
        Prescribed motion, in place of coordinates.
    alone : bool, default False
        Whether an attitude has the names of that of a body by itself, q0 to q3 or psi, theta, phi,
        and, on the ground, the angular velocity omega_1 to omega_3.

    Raises
    ------
    InputError
        For unknown kinds and attitudes, a zero axis, two axes along one line, springs where no
        coordinate is, and a motion that does not fit.

    Notes
    -----
    Coordinates (rad, m) are those of the child's frame in the parent's: positive turns are
    right-handed about the axis. Speeds of a planar, spherical or free joint are components in the
    child's frame (rad/s, m/s). One value of stiffness and its like serves all speeds.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), table 4.1, in the child's axes.

    Examples
    --------
    >>> [q.name for q in Joint("hip", "spherical", GROUND, "thigh").coordinates]
    ['e_hip_0', 'e_hip_1', 'e_hip_2', 'e_hip_3']
    """

    noun = "joint"

    name: str
    kind: str
    parent: str
    child: str
    axis: Axis = "z"
    second_axis: Axis = "x"
    pitch: Length = 0
    attitude: str = QUATERNION
    on_parent: Annotated[Placement, Kind(Placement)] = HERE
    on_child: Annotated[Placement, Kind(Placement)] = HERE
    stiffness: Annotated[Any, Kind("each", each=("N m/rad", "N/m"))] = 0
    rest: Annotated[Any, Kind("each", each=("rad", "m"))] = 0
    damping: Annotated[Any, Kind("each", each=("N m s/rad", "N s/m"))] = 0
    armature: Annotated[Any, Kind("each", each=("kg m^2", "kg"))] = 0
    force: Annotated[Any, Kind("each", ACTING, each=("N m", "N"))] = 0
    motor: bool = False
    motion: Annotated[Any, Kind(Motion, optional=True)] = None
    alone: bool = False

    def complete(self) -> None:
        """Give each speed its values, and raise `InputError` for what the kind of joint does not take."""
        if self.kind not in KINDS:
            raise unknown_name("kind of joint", self.kind, KINDS, self.where)
        if self.attitude != QUATERNION and self.attitude not in SEQUENCES:
            raise InputError(
                "unknown attitude", where=self.where, got=self.attitude,
                expected=f"{QUATERNION} or one of {', '.join(SEQUENCES)}",
            )  # fmt: skip
        size = len(self.row.speeds(self.attitude))
        for name in (n for n, kind in kinds(Joint).items() if kind.shape == "each"):
            self._keep(name, _each(getattr(self, name), size, f"{self.where}: {name}"))
        if self.motion is not None and not isinstance(self.motion, Motion):
            self._keep("motion", Motion(self.motion))
        checks.joint(self)

    @property
    def row(self) -> JointKind:
        """The row of the table of joints."""
        return KINDS[self.kind]

    @property
    def axes(self) -> tuple[Any, ...]:
        """The axes that its kind uses."""
        return (self.axis, self.second_axis)[: self.row.axes]

    @cached_property
    def coordinates(self) -> tuple[Quantity, ...]:
        """The coordinates: symbols named by the joint, ``q_<joint>`` where there is one."""
        return self._named(self.row.coordinates(self.attitude), self.alone)

    @cached_property
    def speeds(self) -> tuple[Quantity, ...]:
        """The speeds: symbols named by the joint, ``u_<joint>`` where there is one."""
        return self._named(self.row.speeds(self.attitude), self.alone and self.parent == GROUND)

    @cached_property
    def motors(self) -> tuple[Quantity, ...]:
        """The inputs of a motor, one a speed."""
        if not self.motor:
            return ()
        letters = self.row.speeds(self.attitude)
        several = len(letters) > 1
        return tuple(
            Quantity(
                sp.Symbol(f"tau_{self.name}" + f"_{letter}{suffix}" * several, real=True),
                "N m" if unit == "rad/s" else "N",
                f"motor of {self.name}, on its {meaning}",
            )
            for letter, suffix, unit, meaning in letters
        )

    def _named(self, letters: Iterable[Any], alone: bool) -> tuple[Quantity, ...]:
        own = ALONE if alone and self.row.attitude else {}
        found = []
        for letter, suffix, unit, meaning in letters:
            usual = f"{letter}_{self.name}{'_' * bool(suffix)}{suffix}"
            symbol = sp.Symbol(own.get(letter + suffix, usual), real=True)
            found.append(Quantity(symbol, unit, f"{meaning}, joint {self.name}"))
        return tuple(found)


def _each(given: Any, size: int, where: str) -> tuple[Value, ...]:
    """Return one value a speed; a single one serves all."""
    parts = list(given) if isinstance(given, tuple | list) else [given] * size
    if len(parts) != size:
        raise InputError("one value a speed is needed", where=where, got=len(parts), expected=size)
    return tuple(values.value(p, where) for p in parts)
