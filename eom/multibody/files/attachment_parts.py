"""The data of rotors, springs between points, and points that are told, in a scene file."""

from __future__ import annotations

from pydantic import StrictBool

from eom.multibody.files.places import Axis, Formulas
from eom.scenes.description import Formula, Part


class RotorPart(Part):
    """A rotor in a body: see `eom.multibody.model.attachments.Rotor`.

    ``torque`` is over parameters, inputs, states and t; ``speed`` over parameters and t.
    """

    body: str
    inertia: Formula
    axis: Axis = "z"
    damping: Formula = 0
    torque: Formula = 0
    motor: StrictBool = False
    angle: StrictBool = False
    speed: Formula | None = None


class SpringPart(Part):
    """A spring and damper between two points: see `eom.multibody.model.attachments.Spring`.

    ``first``, ``second``: bodies, or the ground. ``first_point``, ``second_point``: on these, from their
    origins, in their axes (m).
    """

    first: str
    second: str
    first_point: Formulas = (0, 0, 0)
    second_point: Formulas = (0, 0, 0)
    stiffness: Formula = 0
    length: Formula = 0
    damping: Formula = 0


class PointPart(Part):
    """A point of a ``body``, or of the ground: see `eom.multibody.recursion.points.Point`."""

    body: str
    position: Formulas = (0, 0, 0)
