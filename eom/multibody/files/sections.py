"""From the sections of a scene to a `Tree`: one row of `SECTIONS` a section of the file.

Of constraints there is one row of `ROWS` a kind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError, unknown_name
from eom.mass import solids
from eom.multibody.algebra.spatial import ZERO
from eom.multibody.algebra.values import is_number
from eom.multibody.files.description import (
    BodyPart,
    CouplingPart,
    DistancePart,
    EquationPart,
    JointPart,
    KnifeEdgePart,
    LoadPart,
    LoopPart,
    PointPart,
    RollingPart,
    RotorPart,
    SpringPart,
    TreeDescription,
)
from eom.multibody.files.formulas import Formulas
from eom.multibody.files.places import Place
from eom.multibody.model.attachments import Rotor, Spring
from eom.multibody.model.constraints import (
    Coupling,
    Distance,
    Equation,
    KnifeEdge,
    Loop,
    Rolling,
    SpeedEquation,
)
from eom.multibody.model.joints import KINDS
from eom.multibody.model.model import GROUND, Body, Constraint, Joint, Load, Motion, Placement, Tree
from eom.multibody.recursion.quantities import Point
from eom.quantities import TIME, Quantity
from eom.scenes.naming import check_names, spelling


def placement(part: Place, read: Formulas, where: str) -> Placement:
    """Return where a joint's frame is."""
    return Placement(
        read.values(part.position, f"{where}: position"),
        read.rotation(part.rotation, f"{where}: rotation"),
    )


def axis_of(given: Any, read: Formulas, where: str) -> Any:
    """Return the name of an axis as it is, or its components."""
    return given if isinstance(given, str) else read.values(given, where)


def _loop(name: str, part: LoopPart, reading: Reading) -> Loop:
    where, read = f"constraint {name!r}", reading.constants
    return Loop(
        name,
        part.joint,
        part.first,
        part.second,
        axis_of(part.axis, read, f"{where}: axis"),
        axis_of(part.second_axis, read, f"{where}: second_axis"),
        placement(part.on_first, read, f"{where}: on_first"),
        placement(part.on_second, read, f"{where}: on_second"),
    )


def _distance(name: str, part: DistancePart, reading: Reading) -> Distance:
    where, read = f"constraint {name!r}", reading.constants
    return Distance(
        name,
        part.first,
        part.second,
        read.value(part.length, f"{where}: length"),
        read.values(part.first_point, f"{where}: first_point"),
        read.values(part.second_point, f"{where}: second_point"),
    )


def _equation(name: str, part: EquationPart, reading: Reading) -> Constraint:
    found = reading.acting.value(part.expression, f"constraint {name!r}: expression")
    return Equation(name, found) if part.kind == "equation" else SpeedEquation(name, found)


def _coupling(name: str, part: CouplingPart, reading: Reading) -> Coupling:
    where, read = f"constraint {name!r}", reading.constants
    ratios = {j: read.value(x, f"{where}: ratio of {j}") for j, x in part.ratios.items()}
    return Coupling(name, ratios)


def _rolling(name: str, part: RollingPart, reading: Reading) -> Rolling:
    where, read = f"constraint {name!r}", reading.constants
    return Rolling(
        name,
        part.body,
        read.value(part.radius, f"{where}: radius"),
        None if part.ball else axis_of(part.axis, read, f"{where}: axis"),
        read.values(part.centre, f"{where}: centre"),
        axis_of(part.normal, read, f"{where}: normal"),
        read.values(part.origin, f"{where}: origin"),
    )


def _knife_edge(name: str, part: KnifeEdgePart, reading: Reading) -> KnifeEdge:
    where, read = f"constraint {name!r}", reading.constants
    return KnifeEdge(
        name,
        part.body,
        axis_of(part.direction, read, f"{where}: direction"),
        read.values(part.point, f"{where}: point"),
    )


ROWS: dict[str, Callable[[str, Any, Reading], Constraint]] = {
    "loop": _loop,
    "distance": _distance,
    "equation": _equation,
    "speed_equation": _equation,
    "coupling": _coupling,
    "rolling": _rolling,
    "knife_edge": _knife_edge,
}
"""What makes a constraint, by the word for its kind."""


def constraint(name: str, part: Any, reading: Reading) -> Constraint:
    """Return a constraint of a scene. Raises `InputError` that names it."""
    return ROWS[part.kind](name, part, reading)


def bare_rotor(name: str, part: RotorPart) -> Rotor:
    """Return a rotor that has the states and motors of one of a scene, and no more."""
    given = None if part.speed is None else 0
    return Rotor(name, part.body, inertia=1, motor=part.motor, angle=part.angle, speed=given)


def rotor(name: str, part: RotorPart, reading: Reading) -> Rotor:
    """Return a rotor of a scene. Raises `InputError` that names it."""
    where, read = f"rotor {name!r}", reading.constants
    speed = part.speed
    return Rotor(
        name,
        part.body,
        axis_of(part.axis, read, f"{where}: axis"),
        read.value(part.inertia, f"{where}: inertia"),
        read.value(part.damping, f"{where}: damping"),
        reading.acting.value(part.torque, f"{where}: torque"),
        motor=part.motor,
        angle=part.angle,
        speed=None if speed is None else reading.moving.value(speed, f"{where}: speed"),
    )


def spring(name: str, part: SpringPart, reading: Reading) -> Spring:
    """Return a spring of a scene. Raises `InputError` that names it."""
    where, read = f"spring {name!r}", reading.constants
    points = (
        read.values(part.first_point, f"{where}: first_point"),
        read.values(part.second_point, f"{where}: second_point"),
    )
    stiffness, length, damping = (
        read.value(getattr(part, key), f"{where}: {key}")
        for key in ("stiffness", "length", "damping")
    )
    return Spring(name, (part.first, part.second), points, stiffness, length, damping)


def point(name: str, part: PointPart, reading: Reading) -> Point:
    """Return a point of a scene. Raises `InputError` that names it."""
    where = f"point {name!r}"
    known = (*reading.scene.bodies, GROUND)
    if part.body not in known:
        raise unknown_name("body", part.body, known, where)
    found = Point(name, part.body, reading.constants.values(part.position, f"{where}: position"))
    taken = {q.name for q in (*reading.states, *reading.parameters, *reading.inputs)}
    for output in found.names:
        if output in taken:
            raise InputError("something else has the name of this output", where=where, got=output)
    return found


@dataclass(frozen=True)
class Reading:
    """What formulas of a scene may speak of.

    ``plain``: parameters, for bodies; ``constants``: also what bodies define; ``moving``: time too;
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
        return tuple(bare_rotor(name, part) for name, part in self.scene.rotors.items())

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
        """Over parameters."""
        return Formulas({q.name: q.symbol for q in self.parameters})

    @cached_property
    def defined(self) -> dict[str, Any]:
        """Masses, moments and sizes of bodies that the scene states, under KEY_BODY, as I1_hub."""
        return {
            f"{key}_{name}": sp.sympify(
                self.plain.value(given, f"body {name!r}: {key}"), strict=True
            )
            for name, part in self.scene.bodies.items()
            for key, given in _stated(part)
        }

    @cached_property
    def constants(self) -> Formulas:
        """Over parameters, and masses, moments and sizes of bodies."""
        return Formulas({**self.defined, **self.plain.names})

    @cached_property
    def moving(self) -> Formulas:
        """Over parameters and time."""
        return Formulas({"t": TIME, **self.constants.names})

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
        return Formulas({**{q.name: q.symbol for q in known}, **self.moving.names})

    @property
    def used(self) -> set[str]:
        """The names that formulas used so far."""
        return self.plain.used | self.constants.used | self.moving.used | self.acting.used


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
    if part.kind not in KINDS:
        raise unknown_name("kind of joint", part.kind, KINDS, f"joint {name!r}")
    return Joint(name, part.kind, part.parent, part.child, attitude=part.attitude, motor=part.motor)


def _body(name: str, part: BodyPart, reading: Reading) -> Body:
    where, read = f"body {name!r}", reading.plain
    mass = read.value(part.mass, f"{where}: mass")
    about = part.about
    return Body(
        name,
        mass,
        read.values(part.centre, f"{where}: centre"),
        _inertia(part, mass, read, where),
        about if isinstance(about, str) else read.values(about, f"{where}: about"),
        read.rotation(part.rotation, f"{where}: rotation"),
    )


def _inertia(part: BodyPart, mass: Any, read: Formulas, where: str) -> Any:
    """Return moments, a matrix, or the inertia of a solid; nothing is no inertia."""
    told = [k for k in ("moments", "matrix", "solid") if getattr(part, k) is not None]
    if len(told) > 1:
        raise InputError("more than one inertia", where=where, got=", ".join(told), expected="one")
    if part.solid is not None:
        return _solid(part, mass, read, where)
    if part.size:
        raise InputError("size belongs to a solid", where=where, hint="name a solid, or drop it")
    if part.matrix is not None:
        return read.matrix(part.matrix, f"{where}: matrix")
    return ZERO if part.moments is None else read.values(part.moments, f"{where}: moments")


def _solid(part: BodyPart, mass: Any, read: Formulas, where: str) -> Any:
    if part.about != "centre":
        raise InputError(
            "the inertia of a solid is about its centre", where=where, got=f"about {part.about}"
        )
    size = {n: read.value(v, f"{where}: size {n}") for n, v in part.size.items()}
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


def _joint(name: str, part: JointPart, reading: Reading) -> Joint:
    where, read = f"joint {name!r}", reading.constants
    _bare(name, part)
    settings = {
        key: read.each(getattr(part, key), f"{where}: {key}")
        for key in ("stiffness", "rest", "damping", "armature")
    }
    return Joint(
        name,
        part.kind,
        part.parent,
        part.child,
        axis=axis_of(part.axis, read, f"{where}: axis"),
        second_axis=axis_of(part.second_axis, read, f"{where}: second_axis"),
        pitch=read.value(part.pitch, f"{where}: pitch"),
        attitude=part.attitude,
        on_parent=placement(part.on_parent, read, f"{where}: on_parent"),
        on_child=placement(part.on_child, read, f"{where}: on_child"),
        force=reading.acting.each(part.force, f"{where}: force"),
        motor=part.motor,
        motion=_motion(part, reading.moving, f"{where}: motion"),
        **settings,
    )


def _motion(part: JointPart, read: Formulas, where: str) -> Motion | None:
    if part.motion is None:
        return None

    def listed(key: str) -> tuple[Any, ...] | None:
        given = getattr(part.motion, key)
        if given is None:
            return None
        found = read.each(given, f"{where}: {key}")
        return found if isinstance(found, tuple) else (found,)

    return Motion(listed("position") or (), listed("rate"), listed("acceleration"))


def _load(name: str, part: LoadPart, reading: Reading) -> Load:
    where, read = f"load {name!r}", reading.acting
    if part.body not in reading.scene.bodies:
        raise unknown_name("body", part.body, reading.scene.bodies, where)
    force, torque, point = (
        read.values(getattr(part, key), f"{where}: {key}") for key in ("force", "torque", "point")
    )
    return Load(part.body, force, torque, point, part.axes)


@dataclass(frozen=True)
class Section:
    """A section of the file, which is a field of `TreeDescription` and of `Tree`.

    ``make``: name, part and what formulas may speak of, to a part of the tree.
    """

    key: str
    make: Callable[[str, Any, Reading], Any]


SECTIONS: tuple[Section, ...] = (
    Section("bodies", _body),
    Section("joints", _joint),
    Section("loads", _load),
    Section("constraints", constraint),
    Section("rotors", rotor),
    Section("springs", spring),
)


def tree_of(reading: Reading) -> Tree:
    """Return the tree that a scene describes. Raises `InputError` that names the part at fault."""
    scene = reading.scene
    check_names([*scene.parameters], "[parameters]")
    check_names([q.name for q in reading.inputs], "[inputs]")
    _check_clash(reading)
    parts: dict[str, Any] = {
        section.key: tuple(
            section.make(name, part, reading) for name, part in getattr(scene, section.key).items()
        )
        for section in SECTIONS
    }
    return Tree(
        spelling(scene.name),
        gravity=reading.constants.values(scene.gravity, "gravity"),
        inputs=reading.inputs,
        parameters=reading.parameters,
        **parts,
    )


def points_of(reading: Reading) -> tuple[Point, ...]:
    """Return the points that a scene tells of. Raises `InputError` that names the one at fault."""
    return tuple(point(name, part, reading) for name, part in reading.scene.points.items())


def _check_clash(reading: Reading) -> None:
    """Refuse names of states and motors as names of parameters and inputs, and of joints as rotors."""
    for name in reading.scene.rotors:
        if name in reading.scene.joints:
            raise InputError("a joint has this name", where=f"rotor {name!r}", got=name)
    own = {q.name for q in reading.states}
    groups = (("[parameters]", {*own, *reading.motors}, reading.parameters),
              ("[inputs]", own, reading.inputs))  # fmt: skip
    for where, taken, quantities in groups:
        for quantity in quantities:
            if quantity.name in taken:
                raise InputError("a joint or rotor has this name", where=where, got=quantity.name)
            if reading.defined.get(quantity.name, quantity.symbol) != quantity.symbol:
                raise InputError("a body defines this name", where=where, got=quantity.name)


def check_used(reading: Reading) -> None:
    """Raise `InputError` for a parameter or input that no formula uses."""
    for quantity in (*reading.parameters, *reading.inputs):
        if quantity.name not in reading.used:
            raise InputError(
                f"no formula uses {quantity.name!r}",
                where="[parameters] or [inputs]",
                hint="use it in a formula of a body, joint, load or the like, or remove it",
            )
