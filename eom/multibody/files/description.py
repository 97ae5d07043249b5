"""The data of a scene with many bodies: what a scene file may say of bodies, joints and loads.

Wherever a number is wanted a formula in quotes may stand, over the scene's parameters; but for those of
bodies also over masses, moments and sizes that bodies state: mass_BODY, I1_BODY, radius_BODY.

Rotors, springs between points, points that are asked for, and constraints, of these a kind a row of
`eom.multibody.files.sections.ROWS`.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StrictBool

from eom.multibody.files.places import Axis, Each, Formulas, Place, Point, Turned
from eom.scenes.description import Formula, InitialAttitude, Part, Request


class BodyPart(Part):
    """A body: see `eom.multibody.model.model.Body`.

    The inertia by principal ``moments``, by a ``matrix``, or of a uniform ``solid`` with its ``size`` about
    its centre; of the solid with its axis along the third axis. ``rotation``: from the body's axes to
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


class MotionPart(Part):
    """A prescribed motion over parameters and t; ``rate`` and ``acceleration`` follow if left out.

    ``position``: the coordinates, one formula or a list (rad, m). See `eom.multibody.model.model.Motion`.
    """

    position: Each
    rate: Each | None = None
    acceleration: Each | None = None


class JointPart(Part):
    """A joint: see `eom.multibody.model.model.Joint`.

    ``force`` is over parameters, inputs, states and t. ``angles``: of a joint with a quaternion the
    sequence whose angles, q_JOINT_1 to 3, are outputs and count whole turns (`codegen.runs.turns`).
    """

    kind: str
    parent: str
    child: str
    axis: Axis = "z"
    second_axis: Axis = "x"
    pitch: Formula = 0
    attitude: str = "quaternion"
    angles: str = ""
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
    """A force and a torque on a body: see `eom.multibody.model.model.Load`."""

    body: str
    force: Formulas = (0, 0, 0)
    torque: Formulas = (0, 0, 0)
    point: Formulas = (0, 0, 0)
    axes: Literal["body", "ground"] = "ground"


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
    """A point of a ``body``, or of the ground: see `eom.multibody.recursion.quantities.Point`."""

    body: str
    position: Formulas = (0, 0, 0)


class LoopPart(Part):
    """A ``joint`` that closes a loop, of ``kind`` loop: see `eom.multibody.model.constraints.Loop`."""

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


class KnifeEdgePart(Part):
    """A ``body`` on a knife edge, of ``kind`` knife_edge: see `eom.multibody.KnifeEdge`."""

    kind: Literal["knife_edge"]
    body: str
    direction: Axis = "y"
    point: Formulas = (0, 0, 0)


ConstraintPart = Annotated[
    LoopPart | DistancePart | EquationPart | CouplingPart | RollingPart | KnifeEdgePart,
    Field(discriminator="kind"),
]


class TreeDescription(Request):
    """Bodies joined to the ground, loads, numbers, and what is asked for.

    ``model``: ``tree``. ``gravity``: its acceleration (m/s^2) in the ground's axes. ``bodies``,
    ``joints``, ``loads``, ``constraints``, ``rotors``, ``springs``, ``points``: by name. ``initial``:
    coordinates and speeds (rad, m, rad/s, m/s) at t = 0, formulas over parameters, and over masses,
    moments and sizes of bodies, as mass_BODY, I1_BODY; what is not given is zero, the attitude of a joint
    no turn. ``initial_attitude``: by joint. Under constraints the start is the nearest that meets them;
    ``keep``: names of speeds, and of coordinates whose rate is a speed, that it does not change.
    ``outputs``: names of states, of outputs, or of groups of outputs
    (`eom.multibody.files.scene.Choice`); all states and points where none are named.
    """

    model: Literal["tree"] = "tree"
    gravity: Formulas = (0, 0, 0)
    bodies: dict[str, BodyPart]
    joints: dict[str, JointPart]
    loads: dict[str, LoadPart] = Field(default_factory=dict)
    constraints: dict[str, ConstraintPart] = Field(default_factory=dict)
    rotors: dict[str, RotorPart] = Field(default_factory=dict)
    springs: dict[str, SpringPart] = Field(default_factory=dict)
    points: dict[str, PointPart] = Field(default_factory=dict)
    keep: tuple[str, ...] = ()
    initial: dict[str, Formula] = Field(default_factory=dict)
    initial_attitude: dict[str, InitialAttitude] = Field(default_factory=dict)
