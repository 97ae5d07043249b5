"""The data of a scene: what a scene file may say, and every check that needs no derivation."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from decimal import Decimal
from typing import Annotated, Any, Literal

import pydantic
import sympy as sp
from pydantic import ConfigDict, Field, FiniteFloat, PositiveFloat

from eom.errors import InputError, unknown_name
from eom.kinematics.coordinates import SEQUENCES
from eom.kinematics.frames import tilde
from eom.mass import inertia, solids
from eom.scenes import parse
from eom.scenes.naming import check_names
from eom.units import coherent, in_unit, measure, nearest, read


def _number(value: Any) -> Any:
    if isinstance(value, bool | str):
        raise ValueError("expected a number, without quotes or unit")
    return value


def _in(unit: str) -> pydantic.BeforeValidator:
    """Return what reads a number, or a value with a unit in quotes, of the dimension of ``unit``."""

    def read(value: Any) -> Any:
        found = in_unit(value, unit) if isinstance(value, str) else None
        if isinstance(value, bool | str) and found is None:
            raise ValueError(f'expected a number in {unit}, or one with a unit, as "2 {unit}"')
        return value if found is None else nearest(found)

    return pydantic.BeforeValidator(read)


Number = Annotated[FiniteFloat, pydantic.BeforeValidator(_number)]
Inertia = Annotated[FiniteFloat, _in("kg m^2")]
Angle = Annotated[FiniteFloat, _in("rad")]
Seconds = Annotated[FiniteFloat, _in("s")]
Metres = Annotated[FiniteFloat, _in("m")]
Size = Annotated[PositiveFloat, _in("m")]
Mass = Annotated[PositiveFloat, _in("kg")]
Acceleration = Annotated[PositiveFloat, _in("m/s^2")]
Rate = Annotated[PositiveFloat, _in("rad/s")]
Step = Annotated[PositiveFloat, _in("s")]
Delay = Annotated[FiniteFloat, Field(ge=0), _in("s")]
Triple = tuple[Number, Number, Number]
Row = tuple[Inertia, Inertia, Inertia]
MEASURED: tuple[tuple[Any, str, str], ...] = (
    (Inertia, "number", "kg m^2"),
    (Angle, "number", "rad"),
    (Seconds, "number", "s"),
    (Metres, "number", "m"),
    (Size, "positive number", "m"),
    (Mass, "positive number", "kg"),
    (Acceleration, "positive number", "m/s^2"),
    (Rate, "positive number", "rad/s"),
    (Step, "positive number", "s"),
    (Delay, "number", "s"),
)
"""Numbers that may be written with units: what they are, and the unit where none is written."""


def _formula(value: Any) -> Any:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not (isinstance(value, str) or (number and math.isfinite(value))):
        raise ValueError("expected a finite number or a formula in quotes")
    return value


Formula = Annotated[str | float, pydantic.BeforeValidator(_formula)]


class Part(pydantic.BaseModel):
    """What all parts of a scene share: frozen, and no key without a meaning."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=False)


def one_of(part: Part, keys: Sequence[str], what: str, where: str) -> str:
    """Return which of some keys is given. Raises `InputError` unless it is one alone."""
    given = [k for k in keys if getattr(part, k) is not None]
    if len(given) != 1:
        raise InputError(
            f"{what} needs exactly one description",
            where=where,
            got=", ".join(given) or "none",
            expected=f"{', '.join(keys[:-1])} or {keys[-1]}",
        )
    return given[0]


class Body(Part):
    """The body by principal moments, by its inertia matrix, or as a named uniform solid.

    All are in the body's axes b1, b2, b3, about the centre of mass; with a weight about the fixed point,
    where those of a solid are moved.
    ``moments``: I1, I2, I3 (kg m^2); for a spinner I1 (transverse) and I2 (about the axle).
    ``matrix``: 3 x 3 (kg m^2), off-diagonal entries minus the products of inertia.
    ``solid`` with ``mass`` (kg) and ``size`` (m): see `eom.mass.solids`; symmetric solids have their
    axis along b3, for a spinner along b2.
    """

    moments: tuple[Inertia, ...] | None = None
    matrix: tuple[Row, Row, Row] | None = None
    solid: str | None = None
    mass: Mass | None = None
    size: dict[str, Size] = Field(default_factory=dict)


class Weight(Part):
    """Weight about a fixed point: gravity along -a3.

    ``mass`` (kg), ``gravity`` (m/s^2), ``centre_of_mass``: from the fixed point, along b1, b2, b3 (m); of
    a spinner along its axle b2 alone.
    """

    mass: Mass
    gravity: Acceleration = 9.81
    centre_of_mass: tuple[Metres, Metres, Metres]


class GravityGradient(Part):
    """Gravity gradient on a circular orbit; attitude is measured in the orbit frame.

    ``orbital_rate`` (rad/s). The orbit frame: a1 radially out, a2 along the velocity, a3 the normal.
    """

    orbital_rate: Rate


class Torque(Part):
    """Components in B, weight, gravity gradient; what is given adds up, torque-free if nothing is.

    ``components``: along b1, b2, b3 (N m), numbers, or formulas over parameters, inputs, states, t and
    what the scene defines: I1, I2, I3 (or J11 to J33), a weight's m, g and r1, r2, r3 where they are not
    zero, the orbital rate n, a solid's mass and sizes.
    ``weight``, ``gravity_gradient``: see their types; about different points, and never both. Beside a
    weight, the scene's own ``gravity_gradient`` (3 x 3) is about the fixed point.
    """

    components: tuple[Formula, Formula, Formula] | None = None
    weight: Weight | None = None
    gravity_gradient: GravityGradient | None = None


class Value(Part):
    """A number ``value`` with its ``unit`` and ``meaning``, a text for pages.

    In any unit of `eom.units`, also in the value, as ``value = "30 deg"``: it is kept in SI.
    """

    value: Number
    unit: str = ""
    meaning: str = ""

    @pydantic.model_validator(mode="before")
    @classmethod
    def _converted(cls, data: Any) -> Any:
        """Put the value into SI."""
        if not isinstance(data, Mapping) or not isinstance(data.get("unit", ""), str):
            return data
        unit, value = read(data.get("unit", "")), data.get("value")
        if isinstance(value, str):
            found = measure(value)
            if found is None:
                raise ValueError('expected a number, or one with a unit, as "30 deg"')
            if data.get("unit") and found.unit.dimension != unit.dimension:
                in_unit(value, data["unit"])
            own = data["unit"] if data.get("unit") and unit.is_coherent else found.unit.text
            return {**data, "value": nearest(found.value), "unit": own}
        if unit.is_coherent or not isinstance(value, int | float) or isinstance(value, bool):
            return data
        exact = sp.Rational(str(value)) if math.isfinite(value) else value
        return {**data, "value": nearest(exact * unit.factor), "unit": unit.text}


class InitialAttitude(Part):
    """The attitude at the start, by a rotation sequence (one of the two units) or a quaternion.

    ``sequence``: one of the 12, for ``radians`` or ``degrees``: three angles in the order of the turns,
    each about an axis of the body as it then is; in ``radians`` also with units, as "30 deg".
    ``quaternion``: four numbers of unit norm, scalar first, of B in A: C_BA = (q0^2 - q.q) 1 + 2 q q^T -
    2 q0 tilde(q).
    """

    sequence: str = "3-1-2"
    radians: tuple[Angle, Angle, Angle] | None = None
    degrees: Triple | None = None
    quaternion: tuple[Number, Number, Number, Number] | None = None


class Integration(Part):
    """End time (s), method, tolerances, number of output times, longest step, steps to try at most.

    ``t_end``: from 0; negative runs backwards. ``method``: one of `codegen.METHODS`. ``rtol``, ``atol``:
    steps meet atol + rtol |x| (``atol``: rtol / 1000 of the scale of each state unless given, see
    `codegen.integrate.scales`). ``points``: output times at equal distances, ends included. ``max_step``:
    no step is longer (s), lest one goes over a feature of the rates that is narrower. ``max_steps``: when a
    run is given up.
    """

    t_end: Seconds = 10.0
    method: str = "auto"
    rtol: Annotated[float, Field(gt=0, lt=1)] = 1e-9
    atol: Annotated[float, Field(gt=0)] | None = None
    points: Annotated[int, Field(ge=2, le=10_000_000)] = 1001
    max_step: Step | None = None
    max_steps: Annotated[int, Field(ge=1)] = 10_000_000

    @pydantic.model_validator(mode="before")
    @classmethod
    def _check(cls, data: Any) -> Any:
        """Refuse the key of older scene files, and name what took its place."""
        if isinstance(data, dict) and "handover" in data:
            raise InputError(
                "angles are no longer handed over to a quaternion near their singularity",
                where="[integration] handover",
                got=data["handover"],
                hint='leave it out, and say integrate = "quaternion" beside attitude',
            )
        return data


def _as_value(value: Any) -> Any:
    if isinstance(value, int | float | str):
        return {"value": value}
    if not isinstance(value, dict | Value):
        raise ValueError("expected a number, or { value = ..., unit = ..., meaning = ... }")
    return value


Values = dict[str, Annotated[Value, pydantic.BeforeValidator(_as_value)]]


def _coherent(unit: str) -> str:
    """Refuse unknown units, and those with a factor."""
    coherent(unit)
    return unit


Coherent = Annotated[str, pydantic.AfterValidator(_coherent)]


def _as_rate(value: Any) -> Any:
    return value if isinstance(value, dict | StateOfControl) else {"rate": value}


class StateOfControl(Part):
    """A state of a control, a formula each, with ``unit`` of SI and ``meaning``, a text for pages.

    ``rate``: of one that is continuous; ``next``: the next value of one that changes at samples.
    """

    rate: Formula | None = None
    next: Formula | None = None
    unit: Coherent = ""
    meaning: str = ""


def _as_formula(value: Any) -> Any:
    return value if isinstance(value, dict | DefinitionOfControl) else {"formula": value}


class DefinitionOfControl(Part):
    """A ``formula`` that others share, with ``unit`` of SI and ``meaning``, a text for pages."""

    formula: Formula
    unit: Coherent = ""
    meaning: str = ""


Rates = dict[str, Annotated[StateOfControl, pydantic.BeforeValidator(_as_rate)]]


Shared = dict[str, Annotated[DefinitionOfControl, pydantic.BeforeValidator(_as_formula)]]


class Control(Part):
    """Laws by which inputs follow states and outputs: the scene is then a closed loop.

    ``laws``: a formula for each input that is controlled, in its unit; such an input need not stand in
    ``inputs``. ``states``: of the control itself (an integrator, observer or filter), each by the formula
    of its rate; they start at zero unless ``initial`` says otherwise. ``definitions``: formulas that others
    share, by name, or tables with a unit and a meaning. All are over parameters, inputs, states, outputs,
    t, what the scene defines, and each other, in any order. Laws and definitions can be asked for as
    outputs.

    With a ``period`` (s) the laws are sampled, the first time at t = 0, and their inputs held in between;
    values take effect ``delay`` (s) later. States with a ``next`` value then change at the samples.
    """

    period: Step | None = None
    delay: Delay = 0.0
    laws: dict[str, Formula] = Field(default_factory=dict)
    states: Rates = Field(default_factory=dict)
    definitions: Shared = Field(default_factory=dict)

    @pydantic.model_validator(mode="after")
    def _check(self) -> Control:
        """Check what one field alone cannot show."""
        if self.delay and self.period is None:
            raise InputError("a delay of laws that are not sampled", where="[control] delay",
                             got=self.delay, hint="give the period of the samples, too")  # fmt: skip
        if self.period is not None and not self.laws:
            raise InputError("samples of no law", where="[control] period", got=self.period,
                             expected="a law in [control.laws]")  # fmt: skip
        for name, state in self.states.items():
            where = f"[control.states] {name}"
            one_of(state, ("rate", "next"), "a state of the control", where)
            if state.next is not None and self.period is None:
                raise InputError("a next value without samples", where=where, got=state.next,
                                 hint="give a rate, or a period in [control]")  # fmt: skip
        return self

    @property
    def stepped(self) -> tuple[str, ...]:
        """Names of the states that change at samples."""
        return tuple(n for n, s in self.states.items() if s.next is not None)

    @property
    def formulas(self) -> dict[str, dict[str, str | float]]:
        """All formulas, by section and name."""
        states = {n: s.rate if s.next is None else s.next for n, s in self.states.items()}
        known = {n: e for n, e in states.items() if e is not None}
        shared = {n: d.formula for n, d in self.definitions.items()}
        return {"laws": self.laws, "states": known, "definitions": shared}

    @property
    def words(self) -> set[str]:
        """The names that its formulas speak of."""
        texts = (f for group in self.formulas.values() for f in group.values())
        return set().union(*(parse.words(f) for f in texts if isinstance(f, str)))


class Request(Part):
    """What scenes of every model have: names, numbers of formulas, and what is asked for.

    ``name``: for files, by default the scene file's. ``title``, ``description``: for pages.
    ``parameters``: numbers, or numbers with unit and meaning, by the names that formulas use, which must be
    of the dimensions that these have, where any is given;
    ``inputs``: the same, for what may vary with time, at the value that it is held at. ``outputs``:
    names of states and outputs; nothing else is derived. Empty means all states. ``integration``: how
    the scene is simulated. ``control``: laws for inputs.
    """

    name: str = "scene"
    title: str = ""
    description: str = ""
    parameters: Values = Field(default_factory=dict)
    inputs: Values = Field(default_factory=dict)
    outputs: tuple[str, ...] = ()
    integration: Integration = Integration()
    control: Control = Control()


class Description(Request):
    """One body, its attitude coordinates and torque, numbers, and what is asked for.

    ``model``: ``rigid body``, or ``spinner`` (the 3-1-2 spinning symmetric body of lecture 001).
    ``attitude``: ``none``, ``quaternion``, ``dcm`` or one of the 12 rotation sequences. ``angles``: of a
    scene in quaternions the sequence whose angles psi, theta, phi are outputs. ``integrate``: where it is
    ``quaternion``, a scene in angles is integrated in one, which is nowhere singular, and shown in its
    angles. Both count whole turns of angles (`codegen.runs.turns`). ``initial``: values of states at
    t = 0 (rad, rad/s), or of outputs that determine a missing state; numbers, or formulas over parameters
    and what the scene defines (see ``torque``). ``initial_attitude``: in place of the coordinates' values.
    ``body``, ``torque``: see their types. SI units.

    What trees have (`eom.multibody.files.description.TreeDescription`), ``gravity``, ``gravity_gradient``,
    ``loads``, ``rotors``, ``springs``, ``constraints``, ``points``, and one ``joint``, may stand beside it:
    the scene is then a tree of one body (`eom.multibody.files.scene.of_one`).
    """

    model: Literal["rigid body", "spinner"] = "rigid body"
    body: Body
    attitude: str = "none"
    angles: str = ""
    integrate: Literal["quaternion"] | None = None
    torque: Torque = Torque()
    initial: dict[str, Formula] = Field(default_factory=dict)
    initial_attitude: InitialAttitude | None = None

    @property
    def coordinates(self) -> str:
        """What is integrated: the attitude, or the quaternion in its place."""
        return self.integrate or self.attitude

    @property
    def sequence(self) -> str:
        """The sequence whose angles are outputs over the quaternion; nothing where there is none."""
        return self.attitude if self.integrate else self.angles


def check(scene: Description) -> None:
    """Raise `InputError` for what one field alone cannot show."""
    check_names([*scene.parameters], "[parameters]")
    check_names([*scene.inputs], "[inputs]")
    check_names([*scene.control.states, *scene.control.definitions], "[control]")
    _check_attitude(scene)
    _check_body(scene)
    _check_torque(scene)
    if scene.initial_attitude is not None:
        check_initial_attitude(scene.initial_attitude, "[initial_attitude]")
    check_end(scene)


def check_end(scene: Request) -> None:
    """Raise `InputError` for an integration that takes no time."""
    if scene.integration.t_end == 0:
        raise InputError(
            "end time is zero", where="[integration] t_end", hint="give the time in seconds"
        )


def inertia_values(scene: Description) -> tuple[Triple, Triple, Triple] | None:
    """Return the inertia matrix (kg m^2) of a body that principal moments do not describe.

    About the point that the equations are about: that of a solid under its weight is moved there.
    """
    if scene.body.solid is None:
        return scene.body.matrix
    J = _of_solid(scene)
    rows: Any = tuple(tuple(map(float, row)) for row in J.tolist())
    return None if J.is_diagonal() else rows


def _of_solid(scene: Description) -> Any:
    """Return the inertia (kg m^2) of a solid about the point that the equations are about.

    Moved to the fixed point of its weight by Huygens and Steiner's theorem: m (r.r 1 - r r^T).
    """
    body, weight = scene.body, scene.torque.weight
    r1, r2, r3 = weight.centre_of_mass if weight else (0, 0, 0)
    numbers = {
        sp.Symbol(n, positive=True): sp.Float(v)
        for n, v in (*body.size.items(), ("mass", body.mass))
    }
    across = tilde((r1, r3, r2) if scene.model == "spinner" else (r1, r2, r3))  # the solid's axes
    central = solids.central_inertia(str(body.solid)).xreplace(numbers)
    return central + sp.Float(body.mass) * (across.T * across)


def principal_values(scene: Description) -> tuple[float, float, float]:
    """Return I1, I2, I3 (kg m^2) of a body that is given by moments or as a solid."""
    body, spinner = scene.body, scene.model == "spinner"
    if body.moments is not None:
        expected = {2} if spinner else {3}
        if len(body.moments) not in expected:
            raise InputError(
                "wrong number of moments",
                where="[body] moments",
                got=len(body.moments),
                expected="I1 (transverse) and I2 (about the axle)" if spinner else "I1, I2, I3",
            )
        first, second, *third = body.moments
        return (first, second, first) if spinner else (first, second, third[0])
    a, b, c = map(float, _of_solid(scene).diagonal())
    if not spinner:
        return a, b, c
    if a != b:
        raise InputError(
            "a spinner is symmetric about its axle", where="[body] solid", got=body.solid
        )
    return a, c, a


def _check_attitude(scene: Description) -> None:
    known = ("none", "quaternion", "dcm", *SEQUENCES)
    if scene.attitude not in known:
        raise unknown_name("attitude", scene.attitude, known, "attitude")
    if scene.model == "spinner" and scene.attitude not in {"none", "3-1-2"}:
        raise InputError(
            "a spinner has the 3-1-2 angles psi, theta, phi",
            where="attitude",
            got=scene.attitude,
            hint="leave attitude out",
        )
    _check_angles(scene)


def _check_angles(scene: Description) -> None:
    if scene.integrate and (scene.attitude not in SEQUENCES or scene.model == "spinner"):
        raise InputError(
            "only the angles of a rigid body are integrated in a quaternion",
            where="integrate",
            got=f"model = {scene.model!r}, attitude = {scene.attitude!r}",
            expected="attitude = one of the 12 rotation sequences",
            hint="leave integrate out",
        )
    if not scene.angles:
        return
    if scene.angles not in SEQUENCES:
        raise unknown_name("rotation sequence", scene.angles, SEQUENCES, "angles")
    if scene.attitude != "quaternion":
        raise InputError(
            "angles are outputs where the attitude is a quaternion",
            where="angles",
            got=f"attitude = {scene.attitude!r}",
            hint='attitude = "quaternion"',
        )


def _check_body(scene: Description) -> None:
    body = scene.body
    given = one_of(body, ("moments", "matrix", "solid"), "the body", "[body]")
    if body.matrix is not None:
        if scene.model == "spinner":
            raise InputError(
                "a spinner is symmetric",
                where="[body] matrix",
                hint="give moments = [I1, I2] or a solid",
            )
        inertia.check_matrix(body.matrix, "[body] matrix")
    if body.solid is not None:
        _check_solid(scene)
    elif body.mass is not None or body.size:
        raise InputError(
            "mass and size belong to a solid",
            where="[body]",
            got=given,
            hint="name a solid, or drop them",
        )
    if body.matrix is None and inertia_values(scene) is None:
        inertia.check_principal_moments(principal_values(scene), "[body]")


def _check_solid(scene: Description) -> None:
    body, name = scene.body, str(scene.body.solid)
    if name not in solids.SOLIDS:
        raise unknown_name("solid", name, solids.SOLIDS, "[body] solid")
    if body.mass is None:
        raise InputError("a solid needs its mass", where="[body] mass", expected="kilograms")
    weight = scene.torque.weight
    if weight is not None and weight.mass != body.mass:
        raise InputError(
            "the solid and its weight have different masses",
            where="[body] mass and [torque] weight",
            got=f"{body.mass!r} and {weight.mass!r}",
        )
    solids.check_sizes(name, body.size, "[body] size")
    J = solids.central_inertia(name)
    if scene.model == "spinner" and not J.is_diagonal():
        raise InputError("a spinner is symmetric about its axle", where="[body] solid", got=name)
    if 0 in J.diagonal():
        raise InputError(
            f"a {name} has no moment of inertia about its own axis",
            where="[body] solid",
            got=name,
            hint="give it a thickness: a cylinder with a small radius",
        )


def _check_torque(scene: Description) -> None:
    torque = scene.torque
    for name in ("weight", "gravity_gradient"):
        if getattr(torque, name) is None:
            continue
        if scene.model == "spinner":
            _check_spinner(torque, name)
        elif scene.attitude == "none":
            raise InputError(
                f"torque by {name} depends on attitude",
                where="attitude",
                got="none",
                hint='for example attitude = "quaternion"',
            )


def _check_spinner(torque: Torque, name: str) -> None:
    """Raise `InputError` for a torque of a law that turns with the spin of a spinner."""
    if torque.weight is None:
        raise InputError("a spinner takes torque components and weight", where="[torque]", got=name)
    across = torque.weight.centre_of_mass[::2]
    if any(across):
        raise InputError(
            "the centre of mass of a spinner is on its axle b2",
            where="[torque] weight: centre_of_mass",
            got=torque.weight.centre_of_mass,
            expected="0 along b1 and b3",
        )


def check_initial_attitude(initial: InitialAttitude, where: str) -> None:
    """Raise `InputError` unless an attitude is given in one way, and is one."""
    one_of(initial, ("radians", "degrees", "quaternion"), "the initial attitude", where)
    if initial.sequence not in SEQUENCES:
        raise unknown_name("rotation sequence", initial.sequence, SEQUENCES, where)
    if initial.quaternion is not None:
        of_norm_one(initial.quaternion, where)


ALMOST = 1e-9
"""How far from 1 the norm of a quaternion may be that is computed."""
FEWEST = 3
"""Decimals from which on a quaternion is taken as rounded."""


def of_norm_one(q: Sequence[float], where: str) -> tuple[float, ...]:
    """Return a quaternion that is off by the rounding of its numbers, normalised.

    Of numbers with so many decimals, three or more, the norm is off by half a unit of the last one at
    most, times the square root of four. Raises `InputError` for other norms, with the quaternion divided by
    its norm.
    """
    norm = math.hypot(*q)
    decimals = max(_decimals(x) for x in q)
    rounding = 10.0**-decimals if decimals >= FEWEST else 0.0
    if not abs(norm - 1) <= max(ALMOST, 1.001 * rounding):
        divided = ", ".join(f"{x / norm:.10g}" for x in q) if 0 < norm < math.inf else ""
        raise InputError(
            "a quaternion without unit norm is no rotation",
            where=where,
            got=f"norm {norm!r}",
            expected=f"1 to within {ALMOST:g}, or to the rounding of three decimals or more",
            hint=(f"divide by the norm: {divided}; or" if divided else "give")
            + " angles in [initial_attitude]",
        )
    return tuple(x / norm for x in q) if norm != 1 else tuple(q)


def _decimals(x: float) -> int:
    """Return how many decimals a number has that is written with as few digits as name it."""
    exponent = Decimal(repr(float(x))).normalize().as_tuple().exponent
    return max(0, -exponent) if isinstance(exponent, int) else 0
