"""Values of attitude coordinates in a world: angles of turns, principal axes, Euler parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from eom.errors import InputError, unknown_name
from eom.exact import series
from eom.exact.series import LENGTH, Series, Vector
from eom.worlds.turning import Angle, Quaternion, angle

if TYPE_CHECKING:
    from eom.worlds.worlds import World


def _named_angle(world: World, name: str) -> Angle:
    if name not in world.angles:
        raise unknown_name("angle", name, world.angles, "worlds without a rotation sequence")
    return world.angles[name]


def _free_angle(world: World, name: str) -> Angle:
    generator = world.free("angle", name)
    value = Series(world.field, tuple(world.field.draw(generator) for _ in range(LENGTH)))
    return angle(value, world.field.draw(generator))


def _principal_angle(world: World, frame: str, base: str) -> Angle:
    found = world.turn(frame, base).angle
    if found is None:
        raise InputError("this rotation was not drawn by its axis", got=f"from {base} to {frame}")
    return found


def axes_of(axes: str) -> str:
    """Return the axes of turns in the order about moving ones: of "space123" they are "321"."""
    digits = axes.removeprefix("space").removeprefix("body")
    return digits[::-1] if axes.startswith("space") else digits


def sequence_of(axes: str) -> str:
    """Return the assumption of worlds by which the angles of a sequence exist."""
    return f"sequence_{axes_of(axes)}"


def _turn_angle(world: World, place: str, axes: str, frame: str, base: str) -> Angle:
    """Return an angle of a sequence; turns about fixed axes are those about moving ones backwards."""
    fixed = axes.startswith("space")
    turns = world.turn(frame, base).turns
    if not turns or world.axes != axes_of(axes) or place not in {"1", "2", "3"}:
        got = f"angle {place} of {axes} from {base} to {frame}"
        raise InputError("there is no such angle in this world", got=got)
    return turns[3 - int(place) if fixed else int(place) - 1]


ANGLES: dict[str, Callable[..., Angle]] = {
    "angle": _named_angle,
    "free_angle": _free_angle,
    "principal_angle": _principal_angle,
    "turn_angle": _turn_angle,
}
"""Quantities that have a sine and a cosine."""


def _in_inertial(world: World, frame: str, parts: Sequence[Series]) -> Vector:
    return series.apply(world.rotation("I", frame), (parts[0], parts[1], parts[2]))


def _principal_axis(world: World, frame: str, base: str) -> Vector:
    axis = world.turn(frame, base).axis
    if axis is None:
        raise InputError("this rotation was not drawn by its axis", got=f"from {base} to {frame}")
    return _in_inertial(world, frame, axis)


def _parameters(below: Callable[[Quaternion], Series]) -> Callable[[World, str, str], Vector]:
    """Return the vector part of the Euler parameters over a divisor."""

    def vector(world: World, frame: str, base: str) -> Vector:
        q = world.turn(frame, base).quaternion
        scale = below(q).reciprocal()
        return _in_inertial(world, frame, series.scale(scale, (q[1], q[2], q[3])))

    return vector


def _one(q: Quaternion) -> Series:
    return series.constant(q[0].field, 1, len(q[0].coefficients))


PRIMITIVES: Mapping[str, Callable[..., Any]] = {
    **{kind: lambda w, *labels, kind=kind: w.angle(kind, *labels).value for kind in ANGLES},
    "principal_axis": _principal_axis,
    "euler_parameter": lambda w, k, frame, base: w.turn(frame, base).quaternion[int(k)],
    "euler_vector": _parameters(_one),
    "rodrigues": _parameters(lambda q: q[0]),
    "modified_rodrigues": _parameters(lambda q: _one(q) + q[0]),
    "shadow_rodrigues": _parameters(lambda q: q[0] - _one(q)),
}
"""Quantities without a definition in terms of others."""
