"""Bodies, joints and loads as frozen values, and the tree that they make.

Every number may be a SymPy expression instead; units are SI, angles are in radians.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError, entries, near_matches, typed_fields
from eom.kinematics.coordinates import SEQUENCES
from eom.multibody.algebra import values
from eom.multibody.algebra.scalars import is_zero
from eom.multibody.algebra.spatial import IDENTITY, ZERO, Matrix
from eom.multibody.algebra.values import Value
from eom.multibody.model import checks
from eom.multibody.model.attachments import Rotor, Spring
from eom.multibody.model.joints import KINDS, QUATERNION, Kind
from eom.quantities import TIME, Quantity

GROUND = "ground"
"""What does not move: the parent of the first joints, with the axes that are inertial."""

CENTRE, ORIGIN = "centre", "origin"


@typed_fields
@dataclass(frozen=True)
class Body:
    """A rigid body with axes of its own.

    ``mass`` (kg). ``centre``: of mass, from the body's origin, in its axes (m). ``inertia`` (kg m^2):
    three principal moments or a symmetric matrix, J12 = -integral of r1 r2 dm; ``about`` the ``centre``
    of mass, the ``origin``, or a point (m). ``axes``: C takes components in the body's axes to those
    in the axes in which the inertia is given. A body of mass 0 has no inertia.

    Shapes: ``centre`` (3,), ``inertia`` (3,) or (3, 3), ``axes`` (3, 3).
    Raises `InputError` for a mass below zero, and an inertia in numbers that no body has.

    >>> Body("rod", mass=3, centre=(0, 0, -1), inertia=(4, 4, 0), about="origin").central_inertia[0]
    (1, 0, 0)
    """

    name: str
    mass: Value = 0
    centre: Any = ZERO
    inertia: Any = ZERO
    about: Any = CENTRE
    axes: Any = IDENTITY

    def __post_init__(self) -> None:
        where = f"body {self.name!r}"
        checks.name(self.name, where)
        keep = object.__setattr__
        keep(self, "mass", values.value(self.mass, f"{where}: mass"))
        keep(self, "centre", values.triple(self.centre, f"{where}: centre"))
        keep(self, "inertia", values.symmetric(self.inertia, f"{where}: inertia"))
        keep(self, "axes", values.rotation(self.axes, f"{where}: axes"))
        if not (isinstance(self.about, str) and self.about in {CENTRE, ORIGIN}):
            keep(self, "about", values.triple(self.about, f"{where}: about"))
        checks.body(self.mass, self.central_inertia, where)

    @property
    def _point(self) -> tuple[Value, ...]:
        """The point that the inertia is about, from the origin."""
        known = {CENTRE: self.centre, ORIGIN: ZERO}
        return tuple(known[self.about] if isinstance(self.about, str) else self.about)

    @cached_property
    def central_inertia(self) -> Matrix:
        """The inertia (kg m^2) about the centre of mass, in the body's axes: by Huygens and Steiner.

        Shape (3, 3), as rows.
        """
        return checks.central(self.inertia, self.axes, self.mass, self.centre, self._point)


@typed_fields
@dataclass(frozen=True)
class Placement:
    """Where a joint's frame is on a body.

    ``position``: of its origin (m), in the body's axes, (3,). ``rotation``: C, (3, 3), takes components in
    the body's axes to components in the joint's. Raises `InputError` for a matrix that is no rotation.
    """

    position: Any = ZERO
    rotation: Any = IDENTITY

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", values.triple(self.position, "position of a joint"))
        object.__setattr__(self, "rotation", values.rotation(self.rotation, "rotation of a joint"))


HERE = Placement()


@dataclass(frozen=True)
class Motion:
    """A prescribed motion: coordinates as expressions of time, and their two derivatives.

    ``position``: one expression a coordinate of the joint (rad, m); ``rate`` and ``acceleration``: what is
    left out follows by differentiation; give all three where they are inputs. A constant locks the joint.
    Raises `InputError` for what is no number or expression.
    """

    position: tuple[Value, ...]
    rate: tuple[Value, ...] | None = None
    acceleration: tuple[Value, ...] | None = None

    def __post_init__(self) -> None:
        keep = object.__setattr__
        for name in ("position", "rate", "acceleration"):
            given = getattr(self, name)
            if given is not None or name == "position":
                is_list = isinstance(given, Sequence) and not isinstance(given, str | bytes)
                parts = entries(given, f"{name} of a motion") if is_list else (given,)
                keep(self, name, tuple(values.value(p, "prescribed motion") for p in parts))
        if self.rate is None:
            keep(self, "rate", _derivatives(self.position))
        if self.acceleration is None:
            keep(self, "acceleration", _derivatives(self.rate or ()))


def _derivatives(expressions: Iterable[Value]) -> tuple[Value, ...]:
    found = (0 if values.is_number(e) else sp.diff(e, TIME) for e in expressions)
    return tuple(values.value(e, "prescribed motion") for e in found)


@typed_fields
@dataclass(frozen=True)
class Joint:
    """A joint from a ``parent`` (a body, or the ground) to its ``child``.

    ``kind``: a row of `eom.multibody.model.joints.KINDS`. ``axis``: ``x``, ``-y``, ... or three
    components, in the joint's frame; of a universal joint the first axis, ``second_axis`` the other.
    ``pitch``: of a helical joint (m/rad). ``attitude``: of a spherical or free joint, ``quaternion`` or a
    sequence. ``on_parent``, ``on_child``: where the joint's two frames are; they coincide at zero
    coordinates.

    Coordinates (rad, m) are those of the child's frame in the parent's: positive turns are right-handed
    about the axis. Speeds of a planar, spherical or free joint are components in the child's frame
    (rad/s, m/s).

    At each speed: ``stiffness`` (N m/rad or N/m) about ``rest``, where the speed is the rate of a
    coordinate; ``damping`` (N m s/rad or N s/m); ``armature``, the inertia of a motor's rotor seen through
    its gear (kg m^2 or kg); ``force``, an applied force or torque (N or N m) on the child in the direction
    of the speed, its opposite on the parent; ``motor``: whether there is an input ``tau_<joint>`` (of
    several speeds ``tau_<joint>_<letter>``). One value serves all speeds. ``motion``: prescribed motion, in
    place of coordinates.

    Raises `InputError` for unknown kinds and attitudes, a zero axis, two axes along one line, springs where
    no coordinate is, and a motion that does not fit.
    Source: Featherstone, Rigid Body Dynamics Algorithms (2008), table 4.1, in the child's axes.

    >>> [q.name for q in Joint("hip", "spherical", GROUND, "thigh").coordinates]
    ['e_hip_0', 'e_hip_1', 'e_hip_2', 'e_hip_3']
    """

    name: str
    kind: str
    parent: str
    child: str
    axis: Any = (0, 0, 1)
    second_axis: Any = (1, 0, 0)
    pitch: Value = 0
    attitude: str = QUATERNION
    on_parent: Placement = HERE
    on_child: Placement = HERE
    stiffness: Any = 0
    rest: Any = 0
    damping: Any = 0
    armature: Any = 0
    force: Any = 0
    motor: bool = False
    motion: Any = None

    def __post_init__(self) -> None:
        where = f"joint {self.name!r}"
        checks.name(self.name, where)
        if self.kind not in KINDS:
            raise InputError(
                f"unknown kind of joint {self.kind!r}",
                where=where,
                expected=", ".join(KINDS),
                hint=near_matches(self.kind, KINDS),
            )
        if self.attitude != QUATERNION and self.attitude not in SEQUENCES:
            raise InputError(
                "unknown attitude", where=where, got=self.attitude,
                expected=f"{QUATERNION} or one of {', '.join(SEQUENCES)}",
            )  # fmt: skip
        keep = object.__setattr__
        keep(self, "axis", values.unit(self.axis, f"{where}: axis"))
        keep(self, "second_axis", values.unit(self.second_axis, f"{where}: second axis"))
        keep(self, "pitch", values.value(self.pitch, f"{where}: pitch"))
        size = len(self.row.speeds(self.attitude))
        for name in ("stiffness", "rest", "damping", "armature", "force"):
            keep(self, name, _each(getattr(self, name), size, f"{where}: {name}"))
        if self.motion is not None and not isinstance(self.motion, Motion):
            keep(self, "motion", Motion(self.motion))
        _check_joint(self)

    @property
    def row(self) -> Kind:
        """The row of the table of joints."""
        return KINDS[self.kind]

    @property
    def axes(self) -> tuple[Any, ...]:
        """The axes that its kind uses."""
        return (self.axis, self.second_axis)[: self.row.axes]

    @cached_property
    def coordinates(self) -> tuple[Quantity, ...]:
        """The coordinates: symbols named by the joint, ``q_<joint>`` where there is one."""
        return self._named(self.row.coordinates(self.attitude))

    @cached_property
    def speeds(self) -> tuple[Quantity, ...]:
        """The speeds: symbols named by the joint, ``u_<joint>`` where there is one."""
        return self._named(self.row.speeds(self.attitude))

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

    def _named(self, letters: Iterable[Any]) -> tuple[Quantity, ...]:
        return tuple(
            Quantity(
                sp.Symbol(f"{letter}_{self.name}{'_' * bool(suffix)}{suffix}", real=True),
                unit,
                f"{meaning}, joint {self.name}",
            )
            for letter, suffix, unit, meaning in letters
        )


def _each(given: Any, size: int, where: str) -> tuple[Value, ...]:
    """Return one value a speed; a single one serves all."""
    parts = list(given) if isinstance(given, tuple | list) else [given] * size
    if len(parts) != size:
        raise InputError("one value a speed is needed", where=where, got=len(parts), expected=size)
    return tuple(values.value(p, where) for p in parts)


@typed_fields
@dataclass(frozen=True)
class Load:
    """A force (N) that acts at a ``point`` of a body, and a torque (N m) on it.

    ``body``: its name. ``point``: in the body's axes, from its origin (m). ``axes``: those of ``force`` and
    ``torque``, ``body`` or ``ground``. All three are (3,); components may be numbers or expressions over
    parameters, inputs, time and states. Raises `InputError` for other axes and for text.
    """

    body: str
    force: Any = ZERO
    torque: Any = ZERO
    point: Any = ZERO
    axes: str = GROUND

    def __post_init__(self) -> None:
        where = f"load on {self.body!r}"
        for name in ("force", "torque", "point"):
            object.__setattr__(self, name, values.triple(getattr(self, name), f"{where}: {name}"))
        if self.axes not in {"body", GROUND}:
            raise InputError("unknown axes", where=where, got=self.axes, expected="body or ground")


class Constraint:
    """What all rows of `eom.multibody.model.constraints` have: a name, bodies, and multipliers.

    Units are SI. Multiplier number k of a constraint is ``lambda_<constraint>_<letter>``: a force (N) or
    torque (N m) on the second body, its opposite on the first; each row says along what.
    """

    name: str

    @property
    def where(self) -> str:
        """How errors name it."""
        return f"constraint {self.name!r}"

    @property
    def bodies(self) -> tuple[str, ...]:
        """The bodies that it binds, or the ground."""
        return ()

    @property
    def values(self) -> Iterable[Value]:
        """All numbers and expressions that it holds."""
        raise NotImplementedError

    def check(self, tree: Tree) -> None:
        """Raise `InputError` for what does not fit to the tree."""
        raise NotImplementedError


@typed_fields
@dataclass(frozen=True)
class Tree:
    """Bodies joined to the ground without loops, and constraints on them, which may close loops.

    ``bodies``, ``joints``: one joint leads to each body. ``gravity``: its acceleration in the ground's axes
    (m/s^2), (3,). ``loads``, ``rotors``, ``springs``: what else acts and spins. ``inputs``: symbols, or
    quantities, that are inputs; ``parameters``: quantities that describe parameters (every other symbol is
    one too). ``constraints``: rows of `eom.multibody.model.constraints`. Every number may be a SymPy
    expression; SI units, angles in radians.

    Raises `InputError` that names the body or joint at fault: repeated or unknown names, a body that
    hangs on nothing or on two joints, a loop, a joint that moves no mass.

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

    def __post_init__(self) -> None:
        keep = object.__setattr__
        for name in ("bodies", "joints", "loads", "parameters", "constraints", "rotors", "springs"):
            keep(self, name, tuple(getattr(self, name)))
        keep(self, "gravity", values.triple(self.gravity, f"tree {self.name!r}: gravity"))
        described = (i if isinstance(i, Quantity) else Quantity(i) for i in self.inputs)
        keep(self, "inputs", tuple(described))
        _check_tree(self)

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


def _check_joint(given: Joint) -> None:
    """Raise `InputError` for springs where no coordinate is, and motion that does not fit."""
    where = f"joint {given.name!r}"
    paired = given.row.paired(given.attitude)
    for k, (stiffness, coordinate) in enumerate(zip(given.stiffness, paired, strict=True)):
        if coordinate is None and not is_zero(stiffness):
            raise InputError(
                "a spring needs a coordinate whose rate is the speed",
                where=f"{where}: speed {given.speeds[k].name}",
                hint="use a load or an applied force",
            )
    if given.row.axes == 2:
        checks.not_parallel(given.axis, given.second_axis, where)
    if given.motion is not None:
        _motion(given, where, paired)


def _motion(given: Joint, where: str, paired: Sequence[int | None]) -> None:
    counts = [len(m) for m in (given.motion.position, given.motion.rate, given.motion.acceleration)]
    if None in paired or any(n != len(paired) for n in counts):
        raise InputError(
            "prescribed motion needs one expression a coordinate, each the integral of a speed",
            where=where,
            got=f"{counts[0]} for {given.kind}",
            expected=len(paired) if None not in paired else "a joint of one or two coordinates",
        )


def _check_tree(given: Tree) -> None:
    """Raise `InputError` for what is no tree, naming the body or joint."""
    where = f"tree {given.name!r}"
    checks.name(given.name, where)
    _once("body", [b.name for b in given.bodies], where)
    _once("joint", [j.name for j in given.joints], where)
    known = {b.name for b in given.bodies}
    if "ground" in known:
        raise InputError(
            "a body is called ground", where=where, hint="ground is what does not move"
        )
    for j in given.joints:
        for role, body_name, allowed in (
            ("parent", j.parent, known | {"ground"}),
            ("child", j.child, known),
        ):
            if body_name not in allowed:
                raise InputError(
                    f"unknown {role} {body_name!r}",
                    where=f"joint {j.name!r}",
                    hint=near_matches(body_name, allowed),
                )
    for load in given.loads:
        if load.body not in known:
            raise InputError(
                f"load on unknown body {load.body!r}",
                where=where,
                hint=near_matches(load.body, known),
            )
    _attached(given, known, where)
    _single_parents(given, where)
    ordered(given)
    _once("constraint", [c.name for c in given.constraints], where)
    for constraint in given.constraints:
        constraint.check(given)
    _massless(given)


def _attached(given: Tree, known: set[str], where: str) -> None:
    """Rotors and springs are on bodies that there are."""
    _once("rotor", [r.name for r in given.rotors], where)
    _once("spring", [s.name for s in given.springs], where)
    held = [("rotor", r.name, r.body, known) for r in given.rotors]
    held += [("spring", s.name, b, known | {"ground"}) for s in given.springs for b in s.bodies]
    for kind, own, body_name, allowed in held:
        if body_name not in allowed:
            raise InputError(
                f"{kind} on unknown body {body_name!r}",
                where=f"{kind} {own!r}",
                hint=near_matches(body_name, allowed),
            )
    for s in given.springs:
        if s.bodies[0] == s.bodies[1]:
            raise InputError(
                "both ends are on one body", where=f"spring {s.name!r}", got=s.bodies[0]
            )


def _once(kind: str, names: Sequence[str], where: str) -> None:
    repeated = sorted(n for n, count in Counter(names).items() if count > 1)
    if repeated:
        raise InputError(f"repeated name of a {kind}", where=where, got=", ".join(repeated))


def _single_parents(given: Tree, where: str) -> None:
    """Every body hangs on one joint."""
    leading: dict[str, list[str]] = {b.name: [] for b in given.bodies}
    for j in given.joints:
        leading[j.child].append(j.name)
    for child, names in leading.items():
        if not names:
            raise InputError(
                f"body {child!r} hangs on nothing",
                where=where,
                hint="a body that floats has a free joint to the ground",
            )
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
