"""A scene: body, attitude, torque, numbers and what is asked for, in Python or as a TOML file.

`Scene.derive` returns the smallest system that the requested outputs need; `Scene.explain` says
what was skipped and why. Every formula in a scene is read by the restricted parser of `eom.parse`.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import pydantic
from pydantic import ConfigDict, Field, FiniteFloat, PositiveFloat

from eom import assembly, catalogue, inertia, solids
from eom.errors import InputError, near_matches, unknown_name
from eom.kinematics import SEQUENCES
from eom.reduce import Explanation
from eom.system import System

MAX_FILE_BYTES = 1_000_000

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
_GREEK = dict(
    zip(
        "αβγδεζηθικλμνξοπρστυφχψωΓΔΘΛΞΠΣΦΨΩ",
        [
            "alpha",
            "beta",
            "gamma",
            "delta",
            "epsilon",
            "zeta",
            "eta",
            "theta",
            "iota",
            "kappa",
            "lamda",
            "mu",
            "nu",
            "xi",
            "omicron",
            "pi",
            "rho",
            "sigma",
            "tau",
            "upsilon",
            "phi",
            "chi",
            "psi",
            "omega",
            "Gamma",
            "Delta",
            "Theta",
            "Lamda",
            "Xi",
            "Pi",
            "Sigma",
            "Phi",
            "Psi",
            "Omega",
        ],
        strict=True,
    )
)
RESERVED = frozenset(
    [
        "auto",
        "break",
        "case",
        "char",
        "const",
        "continue",
        "default",
        "do",
        "double",
        "else",
        "enum",
        "extern",
        "float",
        "for",
        "goto",
        "if",
        "inline",
        "int",
        "long",
        "register",
        "restrict",
        "return",
        "short",
        "signed",
        "sizeof",
        "static",
        "struct",
        "switch",
        "typedef",
        "union",
        "unsigned",
        "void",
        "volatile",
        "while",
        "and",
        "as",
        "assert",
        "async",
        "await",
        "class",
        "def",
        "del",
        "elif",
        "except",
        "finally",
        "from",
        "global",
        "import",
        "in",
        "is",
        "lambda",
        "nonlocal",
        "not",
        "or",
        "pass",
        "raise",
        "try",
        "with",
        "yield",
        "None",
        "True",
        "False",
    ]
)

Triple = tuple[FiniteFloat, FiniteFloat, FiniteFloat]
Formula = str | FiniteFloat


class _Part(pydantic.BaseModel):
    """What all parts of a scene share: frozen, and no key without a meaning."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=False)


class Body(_Part):
    """The body by principal moments, by its inertia matrix, or as a named uniform solid.

    ``moments``: I1, I2, I3 (kg m^2); for a spinner I1 (transverse) and I2 (about the axle).
    ``matrix``: 3 by 3, off-diagonal entries minus the products of inertia.
    ``solid`` with ``mass`` (kg) and ``size`` (m): see `eom.solids`; symmetric solids have their
    axis along b3, for a spinner along b2.
    """

    moments: tuple[FiniteFloat, ...] | None = None
    matrix: tuple[Triple, Triple, Triple] | None = None
    solid: str | None = None
    mass: PositiveFloat | None = None
    size: dict[str, PositiveFloat] = Field(default_factory=dict)


class Weight(_Part):
    """Weight about a fixed point: gravity along -a3."""

    mass: PositiveFloat
    gravity: PositiveFloat = 9.81
    centre_of_mass: Triple


class GravityGradient(_Part):
    """Gravity gradient on a circular orbit; attitude is measured in the orbit frame."""

    orbital_rate: PositiveFloat


class Torque(_Part):
    """At most one of: components in B (numbers or formulas), weight, gravity gradient."""

    components: tuple[Formula, Formula, Formula] | None = None
    weight: Weight | None = None
    gravity_gradient: GravityGradient | None = None


class Value(_Part):
    """A number with its unit and meaning."""

    value: FiniteFloat
    unit: str = ""
    meaning: str = ""


class InitialAttitude(_Part):
    """The attitude at the start, by a rotation sequence (one of the two units) or a quaternion."""

    sequence: str = "3-1-2"
    radians: Triple | None = None
    degrees: Triple | None = None
    quaternion: tuple[FiniteFloat, FiniteFloat, FiniteFloat, FiniteFloat] | None = None


class Integration(_Part):
    """End time (s), method, tolerances and the number of output times."""

    t_end: FiniteFloat = 10.0
    method: str = "auto"
    rtol: Annotated[float, Field(gt=0, lt=1)] = 1e-9
    atol: Annotated[float, Field(gt=0)] | None = None
    points: Annotated[int, Field(ge=2, le=10_000_000)] = 1001


def _as_value(value: Any) -> Any:
    return {"value": value} if isinstance(value, int | float) else value


Values = dict[str, Annotated[Value, pydantic.BeforeValidator(_as_value)]]


class Scene(_Part):
    """One body, its attitude coordinates and torque, numbers, and what is asked for.

    ``model``: ``rigid body``, or ``spinner`` (the 3-1-2 spinning symmetric body of lecture 001).
    ``attitude``: ``none``, ``quaternion``, ``dcm`` or one of the 12 rotation sequences.
    ``outputs``: names of states and outputs; nothing else is derived. Empty means all states.
    ``initial``: values of states at t = 0, or of outputs that determine a missing state.

    Raises `InputError` for anything that is misspelt, missing or impossible.
    """

    name: str = "scene"
    title: str = ""
    description: str = ""
    model: Literal["rigid body", "spinner"] = "rigid body"
    body: Body
    attitude: str = "none"
    torque: Torque = Torque()
    parameters: Values = Field(default_factory=dict)
    inputs: Values = Field(default_factory=dict)
    initial: dict[str, FiniteFloat] = Field(default_factory=dict)
    initial_attitude: InitialAttitude | None = None
    outputs: tuple[str, ...] = ()
    integration: Integration = Integration()

    def __init__(self, /, **data: Any) -> None:
        try:
            super().__init__(**data)
        except pydantic.ValidationError as error:
            raise _readable(error, "scene") from None

    def __hash__(self) -> int:
        """Scenes are values; hash by content that matters for lookup only."""
        return hash((self.title, self.model, self.attitude, self.outputs))

    @pydantic.model_validator(mode="after")
    def _check(self) -> Self:
        """Check everything that one field alone cannot tell."""
        check_names([*self.parameters], "[parameters]")
        check_names([*self.inputs], "[inputs]")
        _check_attitude(self)
        _check_body(self)
        _check_torque(self)
        _check_initial_attitude(self.initial_attitude)
        if self.integration.t_end == 0:
            raise InputError(
                "end time is zero", where="[integration] t_end", hint="give the time in seconds"
            )
        known = [*self.full_system.state_names, *self.full_system.output_names]
        for name in self.outputs:
            if name not in known:
                raise unknown_name("output", name, known, "outputs")
        for name in self.initial:
            if name not in known:
                raise unknown_name("state", name, known, "[initial]")
        return self

    @classmethod
    def from_toml(cls, path: str | Path) -> Scene:
        """Read a scene file. Raises `InputError` with the file's name for whatever is wrong in it."""
        file = Path(path)
        text = _read(file)
        try:
            data = tomllib.loads(text)
        except (ValueError, RecursionError) as error:  # a huge integer, deep nesting
            raise InputError("not a valid TOML file", where=str(file), got=str(error)) from None
        data.setdefault("name", file.stem)
        try:
            return cls(**data)
        except InputError as error:
            where = f"{file}: {error.where}" if error.where else str(file)
            raise type(error)(
                error.what, where=where, got=error.got, expected=error.expected, hint=error.hint
            ) from None

    @classmethod
    def ready(cls, name: str) -> Scene:
        """Return one of the scenes that ship with the package. Raises `InputError` for other names.

        >>> Scene.ready("bicycle-wheel").derive().state_names
        ('theta', 'psi', 'theta_dot', 'psi_dot')
        """
        return cls.from_toml(catalogue.path_of(name))

    @cached_property
    def full_system(self) -> System:
        """The general system of this scene: every state and output that can be asked for."""
        return assembly.full_system(self)

    @cached_property
    def _derived(self) -> tuple[System, Explanation]:
        return assembly.derive(self)

    @property
    def requested(self) -> tuple[str, ...]:
        """What is asked for: the outputs, or all states where none are named."""
        return self.outputs or self.full_system.state_names

    def requested_names(self) -> tuple[str, ...]:
        """Return what is asked for that varies: frozen states are constants of the motion."""
        system = self.derive()
        return tuple(n for n in self.requested if n in (*system.state_names, *system.output_names))

    def derive(self) -> System:
        """Return the smallest system that the requested outputs need."""
        return self._derived[0]

    def explain(self) -> Explanation:
        """Return what was skipped, why, and the operations saved; print it to read it."""
        return self._derived[1]

    def initial_values(self) -> dict[str, float]:
        """Return the initial value of each state of `derive`. Raises `InputError` for missing ones."""
        values = assembly.start(self)
        return assembly.pick(values, self.derive().state_names, "initial value", "[initial]")

    def parameter_values(self) -> dict[str, float]:
        """Return the value of each parameter of `derive`, constants of the motion included."""
        values = assembly.start(self) | assembly.constants(self)
        return assembly.pick(
            values, self.derive().parameter_names, "parameter", "[parameters] or [initial]"
        )

    def input_values(self) -> dict[str, float]:
        """Return the value at which each input of `derive` is held."""
        return {n: v.value for n, v in self.inputs.items() if n in self.derive().input_names}


def check_names(names: Iterable[str], where: str) -> None:
    """Raise `InputError` for names that cannot be used in formulas and every generated language."""
    for name in names:
        spelt = "".join(_GREEK.get(c, c) for c in name)
        spelt = re.sub(r"['′]+$", lambda m: "_" + "d" * len(m[0]) + "ot", spelt).replace(
            "_dot", "_dot"
        )
        spelt = re.sub(r"[^A-Za-z0-9_]", "_", spelt)
        if not _NAME.fullmatch(name):
            raise InputError(
                f"name {name!r} cannot be used",
                where=where,
                expected="a letter, then letters, digits and underscores; 64 characters at most",
                hint=f"write {spelt}" if _NAME.fullmatch(spelt) else "spell it in letters",
            )
        if name in RESERVED or name in assembly.RESERVED_NAMES:
            raise InputError(
                f"name {name!r} is reserved",
                where=where,
                expected="a name that is no keyword of C or Python and no function of formulas",
                hint=f"write {name}_0",
            )


def _read(file: Path) -> str:
    if not file.is_file():
        known = [p.name for p in file.parent.glob("*.toml")] if file.parent.is_dir() else []
        raise InputError("no such scene file", where=str(file), hint=near_matches(file.name, known))
    if file.stat().st_size > MAX_FILE_BYTES:
        raise InputError(
            "scene file is too large", where=str(file), expected=f"at most {MAX_FILE_BYTES} bytes"
        )
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("scene file cannot be read", where=str(file), got=str(error)) from None


def _readable(error: pydantic.ValidationError, where: str) -> InputError:
    """Turn the first finding into one error; count the others."""
    findings = error.errors(include_url=False)
    ours = [f["ctx"]["error"] for f in findings if "error" in f.get("ctx", {})]
    if ours and isinstance(ours[0], InputError):
        return ours[0]
    first, *others = sorted(findings, key=lambda f: f["type"] != "extra_forbidden")
    place = ".".join(str(part) for part in first["loc"] if not str(part).startswith("function-"))
    more = f" (and {len(others)} more)" if others else ""
    if first["type"] == "extra_forbidden":
        key = str(first["loc"][-1])
        return InputError(
            f"unknown key {key!r}{more}",
            where=place,
            hint=near_matches(key, _keys_at(Scene, first["loc"][:-1])),
        )
    got = "" if first["type"] == "missing" else repr(first["input"])
    return InputError(f"{first['msg']}{more}", where=place or where, got=got[:200])


def _keys_at(model: type[pydantic.BaseModel], place: tuple[int | str, ...]) -> list[str]:
    """Field names of the part at ``place``."""
    for step in place:
        field = model.model_fields.get(str(step))
        if field is None:
            return list(Value.model_fields) if model is Scene else []
        parts = [
            a
            for a in (field.annotation, *getattr(field.annotation, "__args__", ()))
            if isinstance(a, type)
        ]
        model = next((p for p in parts if issubclass(p, pydantic.BaseModel)), model)
    return list(model.model_fields)


def _check_attitude(scene: Scene) -> None:
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


def _check_body(scene: Scene) -> None:
    body = scene.body
    given = [k for k in ("moments", "matrix", "solid") if getattr(body, k) is not None]
    if len(given) != 1:
        raise InputError(
            "the body needs exactly one description",
            where="[body]",
            got=", ".join(given) or "none",
            expected="moments, matrix or solid",
        )
    if body.matrix is not None:
        if scene.model == "spinner":
            raise InputError(
                "a spinner is symmetric",
                where="[body] matrix",
                hint="give moments = [I1, I2] or a solid",
            )
        inertia.check_matrix(body.matrix, "[body] matrix")
    if body.solid is not None:
        _check_solid(body)
    elif body.mass is not None or body.size:
        raise InputError(
            "mass and size belong to a solid",
            where="[body]",
            got=given[0],
            hint="name a solid, or drop them",
        )
    if body.matrix is None:
        inertia.check_principal_moments(assembly.principal_values(scene), "[body]")


def _check_solid(body: Body) -> None:
    if body.solid not in solids.SOLIDS:
        raise unknown_name("solid", str(body.solid), solids.SOLIDS, "[body] solid")
    if body.mass is None:
        raise InputError("a solid needs its mass", where="[body] mass", expected="kilograms")
    sizes = solids.SOLIDS[body.solid].sizes
    if set(body.size) != set(sizes):
        raise InputError(
            f"sizes of a {body.solid}",
            where="[body] size",
            got=", ".join(body.size) or "none",
            expected=", ".join(sizes),
        )
    if "inner_radius" in body.size and body.size["inner_radius"] >= body.size["outer_radius"]:
        raise InputError(
            "inner radius is not less than outer radius", where="[body] size", got=body.size
        )


def _check_torque(scene: Scene) -> None:
    torque = scene.torque
    given = [
        k for k in ("components", "weight", "gravity_gradient") if getattr(torque, k) is not None
    ]
    if len(given) > 1:
        raise InputError(
            "more than one torque", where="[torque]", got=", ".join(given), expected="at most one"
        )
    if given and given[0] != "components":
        if scene.model == "spinner":
            raise InputError("a spinner takes torque components", where="[torque]", got=given[0])
        if scene.attitude == "none":
            raise InputError(
                f"torque by {given[0]} depends on attitude",
                where="attitude",
                got="none",
                hint='for example attitude = "quaternion"',
            )


def _check_initial_attitude(initial: InitialAttitude | None) -> None:
    if initial is None:
        return
    where = "[initial_attitude]"
    given = [k for k in ("radians", "degrees", "quaternion") if getattr(initial, k) is not None]
    if len(given) != 1:
        raise InputError(
            "the initial attitude needs exactly one description",
            where=where,
            got=", ".join(given) or "none",
            expected="radians, degrees or quaternion",
        )
    if initial.sequence not in SEQUENCES:
        raise unknown_name("rotation sequence", initial.sequence, SEQUENCES, where)
    if initial.quaternion is not None:
        norm = math.hypot(*initial.quaternion)
        if abs(norm - 1) > 1e-9:
            raise InputError(
                "quaternion does not have unit norm",
                where=where,
                got=f"norm {norm!r}",
                expected="1 to within 1e-9",
            )
