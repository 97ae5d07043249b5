"""Formulas, axes, rotations and places in scene files of trees."""

from __future__ import annotations

from typing import Annotated, Any

import pydantic

from eom.multibody.algebra.values import NAMED_AXES
from eom.scenes.description import Formula, Part

Formulas = tuple[Formula, Formula, Formula]
_formula = pydantic.TypeAdapter(Formula)
_formulas = pydantic.TypeAdapter(Formulas)
_each = pydantic.TypeAdapter(tuple[Formula, ...])


def _axis(given: Any) -> Any:
    """Return the name of an axis, or three components."""
    if isinstance(given, str) and given not in NAMED_AXES:
        raise ValueError(f"expected {', '.join(NAMED_AXES)} or three components")
    return given if isinstance(given, str) else _formulas.validate_python(given)


def _point(given: Any) -> Any:
    """Return centre, origin, or three components."""
    if isinstance(given, str) and given not in {"centre", "origin"}:
        raise ValueError("expected centre, origin or three components")
    return given if isinstance(given, str) else _formulas.validate_python(given)


def _one_or_each(given: Any) -> Any:
    """Return a formula, or several in a list."""
    listed = isinstance(given, list | tuple)
    return _each.validate_python(given) if listed else _formula.validate_python(given)


Axis = Annotated[Any, pydantic.PlainValidator(_axis)]
Point = Annotated[Any, pydantic.PlainValidator(_point)]
Each = Annotated[Any, pydantic.PlainValidator(_one_or_each)]


class Turned(Part):
    """A rotation from the body's axes to others: C takes components in the first to the second.

    ``matrix``: C, 3 x 3. Or angles in ``radians`` or ``degrees`` of a ``sequence``: the body's axes are
    turned about the first named axis, what results about the second named axis as it then is, and so on,
    as in `eom.kinematics.coordinates`.
    """

    matrix: tuple[Formulas, Formulas, Formulas] | None = None
    sequence: str = "3-2-1"
    radians: Formulas | None = None
    degrees: Formulas | None = None


class Place(Part):
    """Where a joint's frame is on a body: see `eom.multibody.model.model.Placement`.

    ``position``: of its origin, in the body's axes (m). ``rotation``: from the body's axes to the joint's.
    """

    position: Formulas = (0, 0, 0)
    rotation: Turned | None = None
