"""Where a tree starts: coordinates and speeds at t = 0."""

from __future__ import annotations

import math
from collections.abc import Iterator

from eom.errors import InputError, unknown_name
from eom.kinematics.coordinates import quaternion_of_sequence
from eom.multibody.constrained.consistent import assemble
from eom.multibody.files.formulas import numbered
from eom.multibody.files.sections import Reading
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Joint, Tree
from eom.scenes.description import InitialAttitude, check_initial_attitude

NORM = 1e-9
"""How far from 1 the norm of a given quaternion may be; what is left is divided out."""


def start_values(tree: Tree, reading: Reading) -> dict[str, float]:
    """Return the value of every state at t = 0: zero, and no turn, unless the scene says otherwise.

    Quaternions have norm 1 to rounding. Raises `InputError` for names of no state, joints without an
    attitude, and quaternions that are none.
    """
    free = [j for j in tree.ordered if j.motion is None]
    found = {q.name: 0.0 for j in free for q in (*j.coordinates, *j.speeds)}
    found |= {q.name: 0.0 for rotor in tree.rotors for q in rotor.states}
    for names in quaternions(tree):
        found[names[0]] = 1.0
    parameters = {n: v.value for n, v in reading.scene.parameters.items()}
    for name, given in reading.scene.initial.items():
        if name not in found:
            raise unknown_name("state", name, found, "[initial]")
        found[name] = numbered(reading.constants.value(given, f"[initial] {name}"), parameters)
    for name, value in _attitudes(reading, free):
        if name in reading.scene.initial:
            where = "[initial] and [initial_attitude]"
            raise InputError(f"{name} is given twice", where=where, got=name)
        found[name] = value
    for names in quaternions(tree):
        found |= _normalised({n: found[n] for n in names})
    return _assembled(tree, reading, found, parameters) if tree.constraints else found


def _assembled(
    tree: Tree, reading: Reading, found: dict[str, float], parameters: dict[str, float]
) -> dict[str, float]:
    """Return the nearest values that meet the constraints; rotors are as they are."""
    free = {q.name: found[q.name] for rotor in tree.rotors for q in rotor.states}
    bound = {name: x for name, x in found.items() if name not in free}
    inputs = {q.name: reading.scene.inputs[q.name].value for q in reading.inputs}
    given = {**parameters, **inputs, **bound}
    values = assemble(tree, given, keep=reading.scene.keep).values
    return {name: values[name] for name in bound} | free


def quaternions(tree: Tree) -> list[tuple[str, ...]]:
    """Return the names of the parts of each quaternion among the states."""
    turning = (j for j in tree.ordered if j.row.attitude and j.attitude == QUATERNION)
    return [tuple(c.name for c in j.coordinates[-4:]) for j in turning if j.motion is None]


def _attitudes(reading: Reading, free: list[Joint]) -> Iterator[tuple[str, float]]:
    """Yield the attitude coordinates of joints that are given by angles or a quaternion."""
    joints = {j.name: j for j in free if j.row.attitude}
    for name, given in reading.scene.initial_attitude.items():
        where = f"[initial_attitude.{name}]"
        if name not in joints:
            raise unknown_name("joint with an attitude", name, joints, where)
        check_initial_attitude(given, where)
        joint = joints[name]
        values = _coordinates(given, joint.attitude, where)
        names = [c.name for c in joint.coordinates[-len(values) :]]
        yield from zip(names, values, strict=True)


def _coordinates(given: InitialAttitude, attitude: str, where: str) -> tuple[float, ...]:
    """Return an attitude in the coordinates of a joint."""
    angles = given.radians or tuple(math.radians(a) for a in given.degrees or ())
    if attitude == QUATERNION:
        return given.quaternion or quaternion_of_sequence(given.sequence, angles)
    if not angles or given.sequence != attitude:
        got = f"sequence {given.sequence}" if angles else "quaternion"
        raise InputError(
            "attitude at the start in other coordinates than the joint's",
            where=where, got=got, expected=f"angles of the sequence {attitude}",
        )  # fmt: skip
    return angles


def _normalised(parts: dict[str, float]) -> dict[str, float]:
    norm = math.hypot(*parts.values())
    if not abs(norm - 1) <= NORM:
        raise InputError(
            "quaternion at the start does not have unit norm",
            where=f"[initial] {', '.join(parts)}",
            got=f"norm {norm!r}",
            expected=f"1 to within {NORM:g}",
            hint="[initial_attitude] takes angles and makes them exact",
        )
    return {n: v / norm for n, v in parts.items()}
