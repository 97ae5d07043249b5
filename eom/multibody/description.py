"""The data of a scene with many bodies: what a scene file may say of bodies, joints and loads.

Wherever a number is wanted a formula in quotes may stand, over the scene's parameters.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import pydantic
from pydantic import Field, StrictBool

from eom.description import Formula, InitialAttitude, Part, Request
from eom.multibody.values import NAMED_AXES

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

    ``matrix``: C. Or angles of a ``sequence``: the body's axes are turned about the first named axis,
    what results about the second named axis as it then is, and so on, as in `eom.kinematics`.
    """

    matrix: tuple[Formulas, Formulas, Formulas] | None = None
    sequence: str = "3-2-1"
    radians: Formulas | None = None
    degrees: Formulas | None = None


class BodyPart(Part):
    """A body: see `eom.multibody.model.Body`.

    The inertia by principal ``moments``, by a ``matrix``, or of a uniform ``solid`` with its ``size`` about
    its centre; of the solid with its axis along the third axis. ``rotation``: from the body's axes to
    those in which the inertia is given.
    """

    mass: Formula = 0
    centre: Formulas = (0, 0, 0)
    moments: Formulas | None = None
    matrix: tuple[Formulas, Formulas, Formulas] | None = None
    solid: str | None = None
    size: dict[str, Formula] = Field(default_factory=dict)
    about: Point = "centre"
    rotation: Turned | None = None


class Place(Part):
    """Where a joint's frame is on a body; ``rotation``: from the body's axes to the joint's."""

    position: Formulas = (0, 0, 0)
    rotation: Turned | None = None


class MotionPart(Part):
    """A prescribed motion over parameters and t; ``rate`` and ``acceleration`` follow if left out."""

    position: Each
    rate: Each | None = None
    acceleration: Each | None = None


class JointPart(Part):
    """A joint: see `eom.multibody.model.Joint`. ``force`` is over parameters, inputs, states and t."""

    kind: str
    parent: str
    child: str
    axis: Axis = "z"
    second_axis: Axis = "x"
    pitch: Formula = 0
    attitude: str = "quaternion"
    on_parent: Place = Place()
    on_child: Place = Place()
    stiffness: Each = 0
    rest: Each = 0
    damping: Each = 0
    armature: Each = 0
    force: Each = 0
    motor: StrictBool = False
    motion: MotionPart | None = None


class LoadPart(Part):
    """A force and a torque on a body: see `eom.multibody.model.Load`."""

    body: str
    force: Formulas = (0, 0, 0)
    torque: Formulas = (0, 0, 0)
    point: Formulas = (0, 0, 0)
    axes: Literal["body", "ground"] = "ground"


class TreeDescription(Request):
    """Bodies joined to the ground, loads, numbers, and what is asked for.

    ``bodies``, ``joints``, ``loads``: by name. ``initial``: coordinates and speeds at t = 0, formulas over
    parameters; what is not given is zero, the attitude of a joint no turn. ``initial_attitude``: by joint.
    ``outputs``: names of states, of outputs, or of groups of outputs (`eom.multibody.outputs.GROUPS`).
    """

    model: Literal["tree"] = "tree"
    gravity: Formulas = (0, 0, 0)
    bodies: dict[str, BodyPart]
    joints: dict[str, JointPart]
    loads: dict[str, LoadPart] = Field(default_factory=dict)
    initial: dict[str, Formula] = Field(default_factory=dict)
    initial_attitude: dict[str, InitialAttitude] = Field(default_factory=dict)
