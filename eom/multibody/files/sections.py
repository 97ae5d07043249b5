"""From the sections of a scene to a `Tree`: formulas over parameters, time, inputs and states as values."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import sympy as sp

from eom.errors import InputError, unknown_name
from eom.kinematics.coordinates import SEQUENCES, rotation_sequence
from eom.mass import solids
from eom.mechanics.sequence_angles import with_angles
from eom.multibody.algebra.spatial import IDENTITY, ZERO, ZEROS
from eom.multibody.algebra.values import Value, is_number, value
from eom.multibody.files.description import (
    CONSTRAINTS,
    BodyPart,
    ConstraintPart,
    JointPart,
    RotorPart,
    TreeDescription,
    Turned,
)
from eom.multibody.model.attachments import Load, Rotor, Spring
from eom.multibody.model.bodies import GROUND, Body, Joint
from eom.multibody.model.jets import Jet
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Tree
from eom.multibody.model.parts import Kind, kinds
from eom.multibody.recursion.quantities import Point
from eom.quantities import TIME, Quantity
from eom.rotations import angles_of_matrix, matrix_of_quaternion
from eom.scenes import parse
from eom.scenes.description import one_of
from eom.scenes.naming import check_names, spelling
from eom.scenes.stated import Stated
from eom.system import System
from eom.units import has_unit

Names = Mapping[str, Any]


class Formulas:
    """Reads formulas over names, and keeps which names were used."""

    def __init__(self, names: Names, stated: Stated) -> None:
        self.names, self.stated = names, stated
        self.used: set[str] = set()

    def value(self, given: Any, where: str, unit: str = "") -> Value:
        """Return a number or formula as a value. Raises `InputError` with its place."""
        if not isinstance(given, str):
            return value(given, where)
        found = parse.parse(given, self.names, where, unit=unit)
        self.stated.check(given, where, unit, read=found)
        self.used |= {str(s.name) for s in found.free_symbols}
        return rounded(found, where)

    def values(self, given: Any, where: str, unit: str = "") -> Any:
        """Return a value, those of a list, of rows, or of a table."""
        if isinstance(given, tuple | list):
            return tuple(self.values(g, where, unit) for g in given)
        if isinstance(given, Mapping):
            return {n: self.value(g, f"{where} of {n}", unit) for n, g in given.items()}
        return self.value(given, where, unit)

    def rotation(self, given: Turned | None, where: str) -> Any:
        """Return the matrix of a rotation. Raises `InputError` unless it is given in one way."""
        if given is None:
            return IDENTITY
        one_of(given, ("matrix", "radians", "degrees"), "a rotation", where)
        if given.matrix is not None:
            return self.values(given.matrix, where, "1")
        factor = sp.pi / 180 if given.degrees is not None else sp.Integer(1)
        if given.degrees is not None and any(map(has_unit, given.degrees)):
            raise InputError(
                "degrees have no other unit", where=where, got=given.degrees,
                expected="numbers, or radians = with values in any unit",
            )  # fmt: skip
        angles = self.values(given.degrees or given.radians or (), where, "rad")
        return turned(
            given.sequence, [right(sp.sympify(a, strict=True) * factor) for a in angles], where
        )


def turned(sequence: str, angles: Iterable[Any], where: str) -> tuple[tuple[Value, ...], ...]:
    """Return the matrix of a rotation sequence (`eom.kinematics.coordinates`) for angles in radians."""
    if sequence not in SEQUENCES:
        raise unknown_name("rotation sequence", sequence, SEQUENCES, where)
    C = rotation_sequence(sequence, list(angles)).matrix
    return tuple(tuple(rounded(C[i, j], where) for j in range(3)) for i in range(3))


def rounded(expression: Any, where: str) -> Value:
    """Return a number that is no fraction as the nearest double, everything else as it is."""
    rounds = expression.is_number and not expression.is_Rational
    return value(float(expression) if rounds else expression, where)


RIGHT = 4
"""Spacings of doubles by which a right angle may be off and still have sines of exactly 0 and 1."""


def right(angle: Any) -> Any:
    """Return an angle that is a rounded multiple of a right angle as that multiple of pi."""
    if not (angle.is_Float or angle.is_Rational):
        return angle
    turns = round(float(angle) / float(sp.pi / 2))
    near = turns * sp.pi / 2
    close = abs(float(angle) - float(near)) <= RIGHT * 2.0**-52 * abs(float(near))
    return near if close else angle


@dataclass(frozen=True)
class Reading:
    """What formulas of a scene may speak of.

    ``plain``: parameters and time, for bodies; ``constants``: parameters, and what bodies define that does
    not change; ``moving``: time, and what changes, too;
    ``acting``: inputs, coordinates and speeds too.
    """

    scene: TreeDescription

    @cached_property
    def parameters(self) -> tuple[Quantity, ...]:
        """The scene's own parameters."""
        return _quantities(self.scene.parameters)

    @cached_property
    def motors(self) -> dict[str, Quantity]:
        """The inputs that motors bring."""
        of_joints = (m for joint in self.joints for m in joint.motors)
        return {m.name: m for m in (*of_joints, *(m for r in self.rotors for m in r.motors))}

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The joints, as far as names go."""
        return tuple(_bare(name, part) for name, part in self.scene.joints.items())

    @cached_property
    def rotors(self) -> tuple[Rotor, ...]:
        """The rotors, as far as names go."""
        return tuple(_bare_rotor(name, part) for name, part in self.scene.rotors.items())

    @cached_property
    def states(self) -> tuple[Quantity, ...]:
        """Coordinates and speeds of joints, also of those that are driven, and of rotors."""
        own = (q for joint in self.joints for q in (*joint.coordinates, *joint.speeds))
        return (*own, *(q for rotor in self.rotors for q in rotor.states))

    @cached_property
    def inputs(self) -> tuple[Quantity, ...]:
        """The scene's own inputs; for those of motors it has values alone."""
        own = {n: v for n, v in self.scene.inputs.items() if n not in self.motors}
        return _quantities(own)

    @cached_property
    def plain(self) -> Formulas:
        """Over parameters and time."""
        own = {q.name: q.symbol for q in self.parameters}
        return Formulas({"t": TIME, **own}, self.stated)

    @cached_property
    def defined(self) -> dict[str, Any]:
        """Masses, moments and sizes of bodies that the scene states, under KEY_BODY, as I1_hub."""
        return {
            f"{key}_{name}": sp.sympify(
                self.plain.value(given, f"body {name!r}: {key}", _UNITS.get(key, "m")), strict=True
            )
            for name, part in self.scene.bodies.items()
            for key, given in _stated(part)
        }

    @cached_property
    def constants(self) -> Formulas:
        """Over parameters, and masses, moments and sizes of bodies."""
        constant = {n: x for n, x in self.defined.items() if TIME not in x.free_symbols}
        own = {q.name: q.symbol for q in self.parameters}
        return Formulas({**constant, **own}, self.stated)

    @cached_property
    def moving(self) -> Formulas:
        """Over parameters and time."""
        return Formulas({**self.defined, **self.plain.names}, self.stated)

    @cached_property
    def acting(self) -> Formulas:
        """Over parameters, time, inputs, coordinates and speeds."""
        driven = {
            q
            for joint in self.joints
            if self.scene.joints[joint.name].motion is not None
            for q in (*joint.coordinates, *joint.speeds)
        }
        states = (q for q in self.states if q not in driven)
        known = (*states, *self.motors.values(), *self.inputs)
        return Formulas({**{q.name: q.symbol for q in known}, **self.moving.names}, self.stated)

    @cached_property
    def stated(self) -> Stated:
        """The units of all that formulas may speak of."""
        units = {q.name: q.unit for q in (*self.states, *self.motors.values())}
        for name, part in self.scene.bodies.items():
            units |= {f"{key}_{name}": _UNITS.get(key, "m") for key, _ in _stated(part)}
        given = {q.name: q.unit for q in (*self.parameters, *self.inputs)}
        implied = getattr(self.scene, "implied", ())
        own = {n: unit for n, unit in given.items() if n not in implied}
        return Stated({**given, **units, "t": "s"}, own)

    def speeds_of(self, part: type, name: str) -> tuple[Quantity, ...]:
        """Return the speeds of a joint, of other parts none."""
        found = (j.speeds for j in self.joints if part is Joint and j.name == name)
        return next(found, ())

    @property
    def used(self) -> set[str]:
        """The names that formulas used so far."""
        return self.plain.used | self.constants.used | self.moving.used | self.acting.used


_UNITS = {"mass": "kg", **{f"I{k}": "kg m^2" for k in (1, 2, 3)}}
"""Units of what bodies state; of sizes m."""


def _stated(part: BodyPart) -> Iterator[tuple[str, Any]]:
    """Yield the mass, moments and sizes that a body states, by the names that formulas begin with."""
    if "mass" in part.model_fields_set:
        yield "mass", part.mass
    yield from ((f"I{k}", given) for k, given in enumerate(part.moments or (), 1))
    yield from part.size.items()


def _quantities(group: Mapping[str, Any]) -> tuple[Quantity, ...]:
    return tuple(Quantity(sp.Symbol(n, real=True), v.unit, v.meaning) for n, v in group.items())


def _bare(name: str, part: JointPart) -> Joint:
    """Return a joint of the kind, for the names of its coordinates, speeds and motors."""
    known = ("kind", "parent", "child", "attitude", "motor", "alone")
    return Joint(name, **{key: getattr(part, key) for key in known})


def _bare_rotor(name: str, part: RotorPart) -> Rotor:
    """Return a rotor that has the states and motors of one of a scene, and no more."""
    given = None if part.speed is None else 0
    return Rotor(name, part.body, inertia=1, motor=part.motor, angle=part.angle, speed=given)


def made(
    part: Any,
    given: Any,
    reading: Reading,
    name: str = "",
    where: str = "",
    speeds: Sequence[Quantity] = (),
    **own: Any,
) -> Any:
    """Return a part of a tree from what a file says of it; ``own``: fields that are known.

    ``where``: its place, if it has no name; ``speeds``: of the joint that it is part of. Raises
    `InputError` for formulas that say what they may not.
    """
    where = where or f"{part.noun} {name!r}"
    held, speeds = kinds(part), speeds or reading.speeds_of(part, name)
    for field in (f.name for f in dataclasses.fields(part) if f.name not in own):
        kind = held.get(field, Kind("word"))
        keys = kind.keys or (field,)
        found = [
            name
            if key == "name"
            else _read(kind, getattr(given, key), reading, f"{where}: {key}", speeds)
            for key in keys
        ]
        own[field] = tuple(found) if len(keys) > 1 else found[0]
    return part(**own)


def _read(held: Kind, given: Any, reading: Reading, where: str, speeds: Sequence[Quantity]) -> Any:
    known = (*reading.scene.bodies, GROUND)
    if held.shape == "body" and given not in known:
        raise unknown_name("body", given, known, where.rpartition(":")[0])
    if held.shape == "rotation":
        return reading.constants.rotation(given, where)
    if given is None or held.shape in {"body", "axes", "word"}:
        return given
    if isinstance(held.shape, type):
        return made(held.shape, given, reading, where=where, speeds=speeds)
    if held.shape in {"axis", "place"} and isinstance(given, str):
        return given
    read = getattr(reading, held.scope)
    if held.shape != "each":
        return read.values(given, where, held.unit)
    units = held.units(speeds)
    if isinstance(given, tuple | list):
        rows = zip(given, (*units, *[""] * len(given)), strict=False)
        return tuple(read.value(g, where, u) for g, u in rows)
    return read.value(given, where, units[0] if len({*units}) == 1 else "")


def _body(part: BodyPart, reading: Reading, name: str) -> Any:
    where, read = f"body {name!r}", reading.plain
    J = _inertia(part, read.value(part.mass, f"{where}: mass", "kg"), read, where)
    axes = read.rotation(part.rotation, f"{where}: rotation")
    return made(Body, part, reading, name, inertia=J, axes=axes)


def _inertia(part: BodyPart, mass: Any, read: Formulas, where: str) -> Any:
    """Return moments, a matrix, or the inertia of a solid; nothing is no inertia."""
    given = [k for k in ("moments", "matrix", "solid") if getattr(part, k) is not None]
    if len(given) > 1:
        raise InputError("more than one inertia", where=where, got=", ".join(given), expected="one")
    if part.solid is not None:
        return _solid(part, mass, read, where)
    if part.size:
        raise InputError("size belongs to a solid", where=where, hint="name a solid, or drop it")
    if part.matrix is not None:
        return read.values(part.matrix, f"{where}: matrix", "kg m^2")
    if part.moments is None:
        return ZERO
    return read.values(part.moments, f"{where}: moments", "kg m^2")


def _solid(part: BodyPart, mass: Any, read: Formulas, where: str) -> Any:
    if part.about != "centre":
        raise InputError(
            "the inertia of a solid is about its centre", where=where, got=f"about {part.about}"
        )
    size = {n: read.value(v, f"{where}: size {n}", "m") for n, v in part.size.items()}
    name = str(part.solid)
    if name not in solids.SOLIDS:
        raise unknown_name("solid", name, solids.SOLIDS, f"{where}: solid")
    if all(map(is_number, size.values())):
        solids.check_sizes(name, {n: float(v) for n, v in size.items()}, f"{where}: size")
    elif set(size) != set(solids.SOLIDS[name].sizes):
        expected = ", ".join(solids.SOLIDS[name].sizes)
        raise InputError(f"sizes of a {name}", where=where, got=", ".join(size), expected=expected)
    values = {
        sp.Symbol(n, positive=True): sp.sympify(v, strict=True)
        for n, v in (*size.items(), ("mass", mass))
    }
    return solids.central_inertia(name).xreplace(values).tolist()


def _constraint(part: ConstraintPart, reading: Reading, name: str) -> Any:
    own: dict[str, Any] = {"axis": None} if getattr(part, "ball", False) else {}
    return made(CONSTRAINTS[part.kind], part, reading, name, **own)


SECTIONS: Mapping[str, Callable[[Any, Reading, str], Any]] = {
    "bodies": _body,
    "joints": partial(made, Joint),
    "loads": partial(made, Load),
    "constraints": _constraint,
    "rotors": partial(made, Rotor),
    "springs": partial(made, Spring),
    "jets": partial(made, Jet),
}
"""What makes the parts of each section, a field of `TreeDescription` and of `Tree`, of data and name."""


def tree_of(reading: Reading) -> Tree:
    """Return the tree that a scene describes. Raises `InputError` that names the part at fault."""
    scene = reading.scene
    check_names([*scene.parameters], "[parameters]")
    check_names([q.name for q in reading.inputs], "[inputs]")
    check_names([*scene.control.states, *scene.control.definitions], "[control]")
    _check_clash(reading)
    parts: dict[str, Any] = {
        key: tuple(make(part, reading, name) for name, part in getattr(scene, key).items())
        for key, make in SECTIONS.items()
    }
    return Tree(
        spelling(scene.name),
        gravity=reading.constants.values(scene.gravity, "gravity", "m/s^2"),
        gravity_gradient=reading.moving.values(
            scene.gravity_gradient or ZEROS, "gravity_gradient", "1/s^2"
        ),
        numbers="decimals" if _has_decimals(scene) else "values",
        inputs=reading.inputs,
        parameters=reading.parameters,
        **parts,
    )


def _has_decimals(scene: TreeDescription) -> bool:
    """Return whether any number of a scene's bodies, joints and what acts has decimals."""
    keys = (*SECTIONS, "points", "gravity", "gravity_gradient")
    return any(parse.has_decimals(getattr(scene, key)) for key in keys)


def points_of(reading: Reading) -> tuple[Point, ...]:
    """Return the points of a scene. Raises `InputError` that names the one at fault."""
    points = tuple(made(Point, part, reading, name) for name, part in reading.scene.points.items())
    taken = {q.name for q in (*reading.states, *reading.parameters, *reading.inputs)}
    for point in points:
        for output in {*point.names} & taken:
            raise InputError(
                "something else has the name of this output", where=point.where, got=output
            )
    return points


def _check_clash(reading: Reading) -> None:
    """Refuse names of states and motors as those of parameters and inputs, and what has two names alike."""
    for name in reading.scene.rotors:
        if name in reading.scene.joints:
            raise InputError("a joint has this name", where=f"rotor {name!r}", got=name)
    for name in sorted({q.name for q in reading.inputs} & {*reading.scene.parameters}):
        raise InputError("a parameter has this name", where="[inputs]", got=name)
    own = {q.name for q in reading.states}
    groups = (("[parameters]", {*own, *reading.motors}, reading.parameters),
              ("[inputs]", own, reading.inputs))  # fmt: skip
    for where, taken, quantities in groups:
        for quantity in quantities:
            if quantity.name in taken:
                raise InputError("a joint or rotor has this name", where=where, got=quantity.name)
            if reading.defined.get(quantity.name, quantity.symbol) != quantity.symbol:
                raise InputError("a body defines this name", where=where, got=quantity.name)


@dataclass(frozen=True)
class JointAngles:
    """The angles of a ``sequence`` (rad) of a joint that has a quaternion, child on parent."""

    joint: Joint
    sequence: str

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What they would be called if the joint had them in the place of the quaternion."""
        return replace(self.joint, attitude=self.sequence).coordinates[-3:]

    def at(self, values: Mapping[str, float]) -> tuple[float, ...]:
        """Return the angles (rad) where the joint's quaternion has ``values``, by name."""
        q = [values[c.name] for c in self.joint.coordinates[-4:]]
        return tuple(angles_of_matrix(matrix_of_quaternion(q), self.sequence))

    def of(self, system: System) -> System:
        """Return a system that has them as outputs; ``system`` has the joint's quaternion."""
        q = [c.symbol for c in self.joint.coordinates[-4:]]
        return with_angles(system, rotation_sequence(self.sequence), q, self.quantities)


def angles_of(parts: Mapping[str, JointPart], tree: Tree) -> tuple[JointAngles, ...]:
    """Return the angles that joints are shown in.

    Raises `InputError` for other words than sequences, and for joints that have no quaternion.
    """
    joints = {j.name: j for j in tree.ordered}
    return tuple(_checked(joints[name], part.angles) for name, part in parts.items() if part.angles)


def _checked(joint: Joint, sequence: str) -> JointAngles:
    where = f"joint {joint.name!r}: angles"
    if sequence not in SEQUENCES:
        raise unknown_name("rotation sequence", sequence, SEQUENCES, where)
    if not joint.row.attitude or joint.attitude != QUATERNION or joint.motion is not None:
        raise InputError(
            "only a joint that moves in a quaternion has such outputs",
            where=where,
            got=f"kind {joint.kind}, attitude {joint.attitude}"
            + (", a prescribed motion" if joint.motion is not None else ""),
        )
    return JointAngles(joint, sequence)
