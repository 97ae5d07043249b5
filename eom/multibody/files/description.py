"""The data of a scene with many bodies: what a scene file may say of bodies, joints and loads.

Wherever a number is wanted a formula in quotes may stand, over the scene's parameters; but for those of
bodies also over masses, moments and sizes that bodies state: mass_BODY, I1_BODY, radius_BODY.

The keys of a part are the fields of the part of the tree that it becomes (`eom.multibody.model.parts`).
"""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import fields
from functools import cache, reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_type_hints

import pydantic
from pydantic import Field, StrictBool

from eom.multibody.algebra.values import NAMED_AXES
from eom.multibody.model import attachments, bodies, model
from eom.multibody.model.constraints import (
    Coupling,
    Distance,
    Equation,
    KnifeEdge,
    Loop,
    Rolling,
    SpeedEquation,
)
from eom.multibody.model.jets import Jet
from eom.multibody.model.parts import ACTING, CENTRE, MOVING, ORIGIN, Kind, kinds
from eom.multibody.recursion.quantities import Point as TreePoint
from eom.scenes.description import Formula, InitialAttitude, Part, Request

Formulas = tuple[Formula, Formula, Formula]
_formula = pydantic.TypeAdapter(Formula)
_formulas = pydantic.TypeAdapter(Formulas)
_each = pydantic.TypeAdapter(tuple[Formula, ...])


def _named_or(names: Collection[str]) -> pydantic.PlainValidator:
    """Return what reads one of some names, or three components."""

    def read(given: Any) -> Any:
        if isinstance(given, str) and given not in names:
            raise ValueError(f"expected {', '.join(names)} or three components")
        return given if isinstance(given, str) else _formulas.validate_python(given)

    return pydantic.PlainValidator(read)


def _one_or_each(given: Any) -> Any:
    """Return a formula, or several in a list."""
    listed = isinstance(given, list | tuple)
    return _each.validate_python(given) if listed else _formula.validate_python(given)


Point = Annotated[Any, _named_or((CENTRE, ORIGIN))]


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


class BodyPart(Part):
    """A body: see `eom.multibody.model.bodies.Body`.

    The inertia by principal ``moments``, by a ``matrix``, or of a uniform ``solid`` with its ``size`` about
    its centre; of the solid with its axis along the third axis. All may be over t, too, if mass leaves or
    enters by ``jets`` (`eom.multibody.model.jets.Jet`). ``rotation``: from the body's axes to
    those in which the inertia is given. ``mass`` (kg), ``centre`` of mass (m), ``about`` as there.
    """

    mass: Formula = 0
    centre: Formulas = (0, 0, 0)
    moments: Formulas | None = None
    matrix: tuple[Formulas, Formulas, Formulas] | None = None
    solid: str | None = None
    size: dict[str, Formula] = Field(default_factory=dict)
    about: Point = "centre"
    rotation: Turned | None = None


_FORMS: Mapping[Any, Any] = {
    "number": Formula,
    "vector": Formulas,
    "axis": Annotated[Any, _named_or(NAMED_AXES)],
    "each": Annotated[Any, pydantic.PlainValidator(_one_or_each)],
    "rotation": Turned | None,
    "ratios": dict[str, Formula],
    "body": str,
    "axes": Literal["body", "ground"],
    "word": str,
    bool: StrictBool,
}
"""What a file may say of a field: by its shape (`eom.multibody.model.parts.Kind`), or by its type."""
_SCOPES = {MOVING: "parameters and t", ACTING: "parameters, inputs, states and t"}


@cache
def _described(part: type, kind: str = "", words: str = "", **more: Any) -> type[Part]:
    """Return what a file may say of a part of a tree: its fields, with their forms and defaults.

    ``kind``: the word for its kind, where the file has one; ``more``: other keys, and ``words`` on them.
    """
    keys: dict[str, Any] = {"kind": (Literal[kind], ...)} if kind else {}
    keys |= {key: row for field in fields(part) for key, row in _keys(part, field)}
    about = re.split(r"\s+(?:Raises|Source|>>>)", inspect.getdoc(part) or "")[0]
    over = [
        f"``{name}``: over {_SCOPES[held.scope]}."
        for name, held in kinds(part).items()
        if held.scope in _SCOPES
    ]
    named = [f"Of ``kind`` {kind}."] if kind else []
    doc = "\n\n".join([about, " ".join([*named, *over, words])]).strip()
    made: type[Part] = pydantic.create_model(
        f"{part.__name__}Part", __base__=Part, __doc__=doc, **keys, **more
    )
    return made


def _placed(value: Any) -> Any:
    """Return a placement; three components alone are its position."""
    return {"position": value} if isinstance(value, list | tuple) else value


def _keys(part: type, field: dataclasses.Field[Any]) -> Iterator[tuple[str, tuple[Any, Any]]]:
    """Yield the keys of a field in a file, each with its form and default."""
    if field.name == "name":
        return
    own = get_type_hints(part)[field.name]
    held = kinds(part).get(field.name)
    if held is None:
        form, held = _FORMS.get(own, own), Kind("word")
    else:
        form = _described(held.shape) if isinstance(held.shape, type) else _FORMS[held.shape]
    default = ... if held.needed or field.default is dataclasses.MISSING else field.default
    if held.shape == "rotation":
        default = None
    elif held.shape is bodies.Placement:
        default, form = form(), Annotated[form, pydantic.BeforeValidator(_placed)]
    for k, key in enumerate(held.keys or (field.name,)):
        given = default[k] if len(held.keys) > 1 and default is not ... else default
        yield key, (form | None if held.optional else form, given)


CONSTRAINTS: Mapping[str, type[model.Constraint]] = {
    "loop": Loop,
    "distance": Distance,
    "equation": Equation,
    "speed_equation": SpeedEquation,
    "coupling": Coupling,
    "rolling": Rolling,
    "knife_edge": KnifeEdge,
}
"""Constraints by the words for their kinds."""

if TYPE_CHECKING:
    JointPart = Any
    JetPart = Any
    LoadPart = Any
    RotorPart = Any
    SpringPart = Any
    PointPart = Any
    ConstraintPart = Any
else:
    JointPart = _described(
        bodies.Joint,
        words="``on_parent``, ``on_child``: three components alone are a position. ``angles``: of a "
        "joint with a quaternion the sequence whose angles, q_JOINT_1 to 3, are outputs and count whole "
        "turns (`codegen.runs.turns`).",
        angles=(str, ""),
    )
    JetPart = _described(Jet)
    LoadPart = _described(attachments.Load)
    RotorPart = _described(attachments.Rotor)
    SpringPart = _described(
        attachments.Spring,
        words="``first``, ``second``: the bodies; ``first_point``, ``second_point``: the points.",
    )
    PointPart = _described(TreePoint)
    _more: dict[str, dict[str, Any]] = {
        "loop": {"words": "``joint``: the kind of the joint."},
        "rolling": {"words": "``ball``: whether it is one.", "ball": (bool, False)},
    }
    _constraints = (_described(c, kind, **_more.get(kind, {})) for kind, c in CONSTRAINTS.items())
    ConstraintPart = Annotated[reduce(or_, _constraints), Field(discriminator="kind")]


class TreeDescription(Request):
    """Bodies joined to the ground, loads, numbers, and what is asked for.

    ``model``: ``tree``. ``gravity``: its acceleration (m/s^2) in the ground's axes, at its origin;
    ``gravity_gradient``: by how much it grows with the position (1/s^2), over parameters and t. ``bodies``,
    ``joints``, ``loads``, ``constraints``, ``rotors``, ``springs``, ``jets``, ``points``: by name.
    ``initial``: coordinates and speeds (rad, m, rad/s, m/s) at t = 0, formulas over parameters, and over
    masses, moments and sizes of bodies, as mass_BODY, I1_BODY; what is not given is zero, the attitude of a
    joint no turn. ``initial_attitude``: by joint. Under constraints the start is the nearest that meets
    them;
    ``keep``: names of speeds, and of coordinates whose rate is a speed, that it does not change.
    ``outputs``: names of states, of outputs, or of groups of outputs
    (`eom.multibody.files.scene.Choice`); all states and points where none are named.
    """

    model: Literal["tree"] = "tree"
    gravity: Formulas = (0, 0, 0)
    gravity_gradient: tuple[Formulas, Formulas, Formulas] | None = None
    bodies: dict[str, BodyPart]
    joints: dict[str, JointPart]
    loads: dict[str, LoadPart] = Field(default_factory=dict)
    constraints: dict[str, ConstraintPart] = Field(default_factory=dict)
    rotors: dict[str, RotorPart] = Field(default_factory=dict)
    springs: dict[str, SpringPart] = Field(default_factory=dict)
    jets: dict[str, JetPart] = Field(default_factory=dict)
    points: dict[str, PointPart] = Field(default_factory=dict)
    keep: tuple[str, ...] = ()
    initial: dict[str, Formula] = Field(default_factory=dict)
    initial_attitude: dict[str, InitialAttitude] = Field(default_factory=dict)
