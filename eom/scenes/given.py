"""Other values of what a scene names: parameters, inputs, numbers of its body, values at the start.

They go to the places where the scene's file says them, so that whatever follows from them follows anew.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

from eom.errors import InputError, unknown_name
from eom.scenes import parse
from eom.units import nearest

if TYPE_CHECKING:
    from eom.scenes.description import Request

Key = str | int


class Place(NamedTuple):
    """Where numbers of a body are said: keys on the way, of each entry that is the same number.

    ``unit``: of SI. ``because``: nothing, or why the number is not stated but follows.
    """

    unit: str
    keys: tuple[tuple[Key, ...], ...] = ()
    because: str = ""


def placed(
    scene: Request, data: Mapping[str, Any], values: Mapping[str, Any], places: Mapping[str, Place]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the data of a scene with other numbers, and which ``values`` are none of its numbers.

    ``places``: of numbers of its body, by name. Raises `InputError` for what is no number, or of another
    dimension, for numbers that follow from others, and for inputs that follow a law.
    """
    changed, rest = dict(data), {}
    for name, value in values.items():
        for group, known in (("parameters", scene.parameters), ("inputs", scene.inputs)):
            if name in known:
                _check_free(scene, name)
                number = number_of(value, known[name].unit, name)
                said = {**known[name].model_dump(exclude_unset=True), "value": number}
                changed[group] = {**changed[group], name: said}
                break
        else:
            if name not in places:
                rest[name] = value
                continue
            changed = _in_place(changed, places[name], name, value)
    return changed, rest


def _check_free(scene: Request, name: str) -> None:
    if name in scene.control.laws:
        raise InputError(
            f"input {name} follows a law of control", where=name,
            hint="give values of the law's parameters, or leave [control] out",
        )  # fmt: skip


def _in_place(data: Mapping[str, Any], place: Place, name: str, value: Any) -> dict[str, Any]:
    if place.because:
        raise InputError(f"{name} follows from others", where=name, hint=place.because)
    number, changed = number_of(value, place.unit, name), dict(data)
    for keys in place.keys:
        changed = _put(changed, keys, number)
    return changed


def _put(data: Any, keys: tuple[Key, ...], value: Any) -> Any:
    """Return nested tables and lists with another entry."""
    if not keys:
        return value
    key, *rest = keys
    if isinstance(key, int):
        return [_put(v, tuple(rest), value) if k == key else v for k, v in enumerate(data)]
    return {**(data or {}), key: _put((data or {}).get(key), tuple(rest), value)}


def number_of(value: Any, unit: str, where: str) -> float:
    """Return a number, a number with a unit, or a formula of numbers, such as pi/2, in SI.

    ``unit``: that it is to be in, nothing where that is not known. Raises `InputError` for all else.
    """
    found = parse.parse(value, {}, where, unit=unit) if isinstance(value, str) else value
    if isinstance(value, str):
        if not found.is_real or not found.is_finite:
            raise InputError("no finite number", where=where, got=value)
        return nearest(found)
    return float(found)


def unknown(name: str, scene: Request, places: Mapping[str, Place], start: Any) -> InputError:
    """Build the error for what a scene has no value of; ``start``: names of what it starts at."""
    known = [*scene.parameters, *scene.inputs, *places, *start]
    plan = type(scene.integration).model_fields
    error = unknown_name("parameter, input or initial value", name, known, name)
    if name in plan:
        option = "--" + name.replace("_", "-")
        return InputError(error.what, where=name, hint=f"of how a scene is integrated: {option}")
    return error
