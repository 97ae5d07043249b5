"""The data of constraints in a scene file: one kind a row of
`eom.multibody.files.constraint_sections.ROWS`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from eom.multibody.files.places import Axis, Formulas, Place
from eom.scenes.description import Formula, Part


class LoopPart(Part):
    """A loop closed by a ``joint`` of that kind, of ``kind`` loop: see
    `eom.multibody.model.constraints.Loop`."""

    kind: Literal["loop"]
    joint: str
    first: str
    second: str
    axis: Axis = "z"
    second_axis: Axis = "x"
    on_first: Place = Place()
    on_second: Place = Place()


class DistancePart(Part):
    """A rod without mass, of ``kind`` distance: see `eom.multibody.model.constraints.Distance`."""

    kind: Literal["distance"]
    first: str
    second: str
    length: Formula
    first_point: Formulas = (0, 0, 0)
    second_point: Formulas = (0, 0, 0)


class EquationPart(Part):
    """An equation between coordinates, or with ``kind`` speed_equation between speeds.

    See `eom.multibody.model.constraints.Equation` and `SpeedEquation`; ``expression`` is a formula in
    quotes.
    """

    kind: Literal["equation", "speed_equation"]
    expression: Formula


class CouplingPart(Part):
    """Gears, of ``kind`` coupling: see `eom.multibody.model.constraints.Coupling`; ``ratios`` by joint."""

    kind: Literal["coupling"]
    ratios: dict[str, Formula]


class RollingPart(Part):
    """A wheel (``axis``) or ``ball`` on a plane, of ``kind`` rolling.

    See `eom.multibody.model.constraints.Rolling`.
    """

    kind: Literal["rolling"]
    body: str
    radius: Formula
    axis: Axis = "z"
    ball: bool = False
    centre: Formulas = (0, 0, 0)
    normal: Axis = "z"
    origin: Formulas = (0, 0, 0)


class SkatePart(Part):
    """A knife edge under a ``body``, of ``kind`` skate: see `eom.multibody.model.constraints.Skate`."""

    kind: Literal["skate"]
    body: str
    direction: Axis = "y"
    point: Formulas = (0, 0, 0)


ConstraintPart = Annotated[
    LoopPart | DistancePart | EquationPart | CouplingPart | RollingPart | SkatePart,
    Field(discriminator="kind"),
]
