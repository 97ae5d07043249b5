"""From the constraints of a scene file to those of a tree: one row of `ROWS` a kind."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from eom.multibody.files.constraint_parts import (
    CouplingPart,
    DistancePart,
    EquationPart,
    LoopPart,
    RollingPart,
    SkatePart,
)
from eom.multibody.files.formulas import Formulas
from eom.multibody.files.places import Place
from eom.multibody.model.constraints import (
    Coupling,
    Distance,
    Equation,
    Loop,
    Rolling,
    Skate,
    SpeedEquation,
)
from eom.multibody.model.model import Constraint, Placement

if TYPE_CHECKING:
    from eom.multibody.files.sections import Reading


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


def _skate(name: str, part: SkatePart, reading: Reading) -> Skate:
    where, read = f"constraint {name!r}", reading.constants
    return Skate(
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
    "skate": _skate,
}
"""What makes a constraint, by the word for its kind."""


def constraint(name: str, part: Any, reading: Reading) -> Constraint:
    """Return a constraint of a scene. Raises `InputError` that names it."""
    return ROWS[part.kind](name, part, reading)
