"""Bodies, joints, loads, rotors and springs as frozen values, and the tree that they make.

Every number may be a SymPy expression instead; units are SI, angles are in radians.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any

import sympy as sp

from eom.errors import InputError, entries, near_matches, shown, typed_fields, unknown_name
from eom.kinematics.coordinates import SEQUENCES
from eom.multibody.algebra import values
from eom.multibody.algebra.scalars import is_zero
from eom.multibody.algebra.spatial import IDENTITY, ZERO, ZEROS, Matrix
from eom.multibody.algebra.values import Value, is_number
from eom.multibody.model import checks, jets, measures
from eom.multibody.model.jets import Jet
from eom.multibody.model.joints import ALONE, KINDS, QUATERNION
from eom.multibody.model.joints import Kind as JointKind
from eom.multibody.model.parts import (
    ACTING,
    CENTRE,
    MOVING,
    ORIGIN,
    PLAIN,
    Axis,
    BodyName,
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


class Constraint(Part):
    """What all rows of `eom.multibody.model.constraints` have: a name, bodies, and multipliers.

    Units are SI. Multiplier number k of a constraint is ``lambda_<constraint>_<letter>``: a force (N) or
    torque (N m) on the second body, its opposite on the first; each row says along what.
    """

    noun = "constraint"

    name: str

    @property
    def bodies(self) -> tuple[str, ...]:
        """The bodies that it binds, or the ground."""
        held = (name for name, kind in self._kinds.items() if kind.shape == "body")
        return tuple(getattr(self, name) for name in held)

    def check(self, tree: Tree) -> None:
        """Refuse what does not fit into a tree.

        Parameters
        ----------
        tree : Tree
            In which the constraint shall be.

        Raises
        ------
        InputError
            For unknown bodies, one that is bound to itself, and sizes that change.
        """
        known = {GROUND, *(b.name for b in tree.bodies)}
        for name in self.bodies:
            if name not in known:
                raise unknown_name("body", name, known, self.where)
        if len(set(self.bodies)) < len(self.bodies):
            raise InputError("a body is bound to itself", where=self.where, got=self.bodies[0])
        moving = {q.symbol for j in tree.joints for q in (*j.coordinates, *j.speeds)} | {TIME}
        for given in self.values:
            found = set() if is_number(given) else given.free_symbols & moving
            if found:
                raise InputError("a length or direction of a constraint is not constant",
                                 where=self.where, got=", ".join(sorted(map(str, found))),
                                 hint="write an Equation over coordinates and time")  # fmt: skip


@typed_fields
@dataclass(frozen=True)
class Tree:
    """Bodies joined to the ground without loops, and constraints on them, which may close loops.

    Parameters
    ----------
    name : str
        What the tree is called, also in generated code.
    bodies : tuple of Body
        One joint leads to each.
    joints : tuple of Joint
        In any order.
    gravity : number, expression or several, optional
        Its acceleration in the ground's axes (m/s^2), (3,), at the ground's origin.
    loads : tuple of Load, optional
        Forces and torques.
    inputs : tuple of symbols or Quantity, optional
        Symbols, or quantities, that are inputs.
    parameters : tuple of Quantity, optional
        Quantities that describe parameters (every other symbol is one too).
    constraints : tuple of Constraint, optional
        Rows of `eom.multibody.model.constraints`, which may close loops.
    rotors : tuple of Rotor, optional
        What spins in bodies.
    springs : tuple of Spring, optional
        Between points.
    gravity_gradient : number, expression or several, optional
        By how much gravity grows with the position, symmetric, (3, 3) or its diagonal (1/s^2).
    jets : tuple of Jet, optional
        By which mass leaves.
    numbers : str, optional
        What numbers in the equations are, a row of `eom.system.NUMBERS`; nothing where that is to
        be seen from the values, whose dimensions are then checked.

    Raises
    ------
    InputError
        That names the body or joint at fault: repeated or unknown names, a body that hangs on
        nothing or on two joints, a loop, a joint that moves no mass, an expression of another
        dimension than its place has, where it is over parameters or inputs with units.

    Notes
    -----
    Every number may be a SymPy expression; SI units, angles in radians.

    Examples
    --------
    >>> bob = Body("bob", mass=2, centre=(0, 0, -1))
    >>> hinge = Joint("hinge", "revolute", GROUND, "bob", axis="x")
    >>> Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -9.81)).joint_of["bob"].name
    'hinge'
    """

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    gravity: Any = ZERO
    loads: tuple[Load, ...] = ()
    inputs: tuple[Any, ...] = ()
    parameters: tuple[Quantity, ...] = field(default=(), compare=False)
    constraints: tuple[Constraint, ...] = ()
    rotors: tuple[Rotor, ...] = ()
    springs: tuple[Spring, ...] = ()
    gravity_gradient: Any = ZEROS
    jets: tuple[Jet, ...] = ()
    numbers: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        keep = object.__setattr__
        for name in "bodies joints loads parameters constraints rotors springs jets".split():
            keep(self, name, tuple(getattr(self, name)))
        keep(self, "gravity", values.triple(self.gravity, f"tree {self.name!r}: gravity"))
        place = f"tree {self.name!r}: gravity_gradient"
        keep(self, "gravity_gradient", values.symmetric(self.gravity_gradient, place))
        described = (i if isinstance(i, Quantity) else Quantity(i) for i in self.inputs)
        keep(self, "inputs", tuple(described))
        _check_tree(self)
        keep(self, "numbers", measures.checked(self))

    @cached_property
    def ordered(self) -> tuple[Joint, ...]:
        """The joints, each after the joint of its parent. Raises `InputError` for a loop."""
        return ordered(self)

    @cached_property
    def body(self) -> dict[str, Body]:
        """Bodies by name."""
        return {b.name: b for b in self.bodies}

    @cached_property
    def joint_of(self) -> dict[str, Joint]:
        """The joint that leads to each body."""
        return {j.child: j for j in self.joints}


# -- what they must be --


def _check_tree(given: Tree) -> None:
    """Raise `InputError` for what is no tree, naming the body or joint."""
    where = f"tree {given.name!r}"
    checks.name(given.name, where)
    named = (given.bodies, given.joints, given.rotors, given.springs, given.constraints, given.jets)
    for parts in named:
        _once(parts, where)
    known = {b.name for b in given.bodies}
    if GROUND in known:
        raise InputError(
            "a body is called ground", where=where, hint="ground is what does not move"
        )
    for what, place, name, allowed in _held(given, known, where):
        if name not in allowed:
            hint = near_matches(name, allowed)
            raise InputError(f"{what} {name!r}", where=place, hint=hint)
    for s in given.springs:
        if s.bodies[0] == s.bodies[1]:
            raise InputError("both ends are on one body", where=s.where, got=s.bodies[0])
    _single_parents(given, where)
    ordered(given)
    moving = {q.symbol for j in given.joints for q in (*j.coordinates, *j.speeds)}
    moving |= {q.symbol for r in given.rotors for q in r.states}
    jets.check(given.bodies, given.jets, moving, {i.symbol for i in given.inputs})
    for constraint in given.constraints:
        constraint.check(given)
    _massless(given)


def _held(given: Tree, known: set[str], where: str) -> Iterator[tuple[str, str, str, set[str]]]:
    """Yield the bodies that parts name: what an unknown one is, where it is named, which there are."""
    for j in given.joints:
        yield "unknown parent", j.where, j.parent, known | {GROUND}
        yield "unknown child", j.where, j.child, known
    for load in given.loads:
        yield "load on unknown body", where, load.body, known
    for rotor in given.rotors:
        yield "rotor on unknown body", rotor.where, rotor.body, known
    for jet in given.jets:
        yield "jet of unknown body", jet.where, jet.body, known
    for s in given.springs:
        for name in s.bodies:
            yield "spring on unknown body", s.where, name, known | {GROUND}


def _once(parts: Sequence[Any], where: str) -> None:
    repeated = sorted(n for n, count in Counter(p.name for p in parts).items() if count > 1)
    if repeated:
        what = f"repeated name of a {parts[0].noun}"
        raise InputError(what, where=where, got=", ".join(repeated))


def _single_parents(given: Tree, where: str) -> None:
    """Every body hangs on one joint."""
    leading: dict[str, list[str]] = {b.name: [] for b in given.bodies}
    for j in given.joints:
        leading[j.child].append(j.name)
    for child, names in leading.items():
        if not names:
            raise InputError(f"body {child!r} hangs on nothing", where=where,
                             hint="a body that floats has a free joint to the ground")  # fmt: skip
        if len(names) > 1:
            raise InputError(
                f"two joints lead to body {child!r}",
                where=where,
                got=", ".join(names),
                hint="a tree has no loops: cut one of them, and close it by a constraint (Loop)",
            )


def ordered(given: Tree) -> tuple[Joint, ...]:
    """Return the joints, each after that of its parent; raise `InputError` for a loop."""
    children: dict[str, list[Joint]] = {}
    for j in given.joints:
        children.setdefault(j.parent, []).append(j)
    found: list[Joint] = []
    stack = children.get("ground", [])[::-1]
    while stack:
        j = stack.pop()
        found.append(j)
        stack += children.get(j.child, [])[::-1]
    if len(found) < len(given.joints):
        reached = {j.name for j in found}
        lost = [j.name for j in given.joints if j.name not in reached]
        raise InputError(
            "joints that the ground does not lead to: they form a loop",
            where=f"tree {given.name!r}",
            got=", ".join(lost),
        )
    return tuple(found)


def _massless(given: Tree) -> None:
    """Raise `InputError` for a joint that moves freely and moves no mass, and is not bound to any."""
    found = moves_nothing(given, {b for c in given.constraints for b in c.bodies})
    if found is not None:
        raise InputError(
            "the joint moves no mass",
            where=f"joint {found.name!r}",
            got=f"body {found.child!r} of mass 0, and nothing heavy on it",
            hint="give it mass, or fix the joint",
        )


def moves_nothing(given: Tree, bound: Collection[str]) -> Joint | None:
    """Return a free joint that moves neither mass nor a body of ``bound``, if there is one."""
    heavy: dict[str, bool] = {}
    bodies = {b.name: b for b in given.bodies}
    children: dict[str, list[Joint]] = {}
    for j in given.joints:
        children.setdefault(j.parent, []).append(j)
    for j in reversed(ordered(given)):
        own = j.child in bound or not is_zero(bodies[j.child].mass)
        below = any(heavy[k.child] or _armed(k) for k in children.get(j.child, ()))
        heavy[j.child] = own or below
        if not heavy[j.child] and j.speeds and j.motion is None and not _armed(j):
            return j
    return None


def _armed(j: Joint) -> bool:
    return any(not is_zero(x) for x in j.armature)
