"""From the rotors, springs and points of a scene file to those of a tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eom.errors import InputError, unknown_name
from eom.multibody.files.attachment_parts import PointPart, RotorPart, SpringPart
from eom.multibody.files.constraint_sections import axis_of
from eom.multibody.model.attachments import Rotor, Spring
from eom.multibody.model.model import GROUND
from eom.multibody.recursion.points import Point

if TYPE_CHECKING:
    from eom.multibody.files.sections import Reading


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
