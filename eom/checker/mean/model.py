r"""A system that a note is about: its quantities by name, their usual spellings, what may be assumed of it.

A scene is one particular system: what its numbers say of the parameters (equal moments of inertia,
values that are zero) holds, and the contrary cannot be assumed. Of a bare system anything of the table
may be assumed.

The system that a lexicon names: its table, and what the note's symbols stand for in it.

Systems that a lexicon describes itself: by coordinates and places, or as a tree of bodies.

By coordinates, with places in inertial axes, over coordinates, their rates (``theta_dot``), parameters
and ``t``:

    [system]
    coordinates = { theta = "rad" }
    given = { phi = "rad" }                  # motions that are imposed; any functions of time
    parameters = { m = "kg", R = "m", g = "m/s^2" }
    gravity = [0, 0, "-g"]
    potential = "..."                        # J, besides weights and springs
    forces = { theta = "-c*theta_dot" }      # generalised, besides those at bodies
    [system.bodies]
    bead = { mass = "m", at = ["R*sin(theta)*cos(phi)", "R*sin(theta)*sin(phi)", "-R*cos(theta)"] }
    wheel = { mass = "M", at = ["R*phi", 0, 0], moments = "J", omega = "phi_dot", force = ["F", 0, 0] }
    [system.springs]
    s = { between = ["bead", [0, 0, 0]], stiffness = "k", length = "l" }
    [system.reactions]                       # what keeps a body on its way, counted in a direction
    S = { on = "bead", along = ["-sin(phi)", "cos(phi)", 0] }

As a tree, with the keys of a scene file (`eom.multibody.files.description`); a body may say in one line
how it hangs on another, its joint has its name:

    parameters = { M = "kg", m = "kg", l = "m", g = "m/s^2" }
    gravity = [0, 0, "-g"]
    [system.bodies]
    cart = { mass = "M", slide = "x" }
    bob = { mass = "m", centre = [0, 0, "-l"], on = "cart", hinge = "y" }
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eom.checker.mean.solid_models import SPELLINGS, body_about, solid_system
from eom.errors import InputError, typed, unknown_name
from eom.fields import Singular
from eom.kinematics.coordinates import attitude as attitude_of
from eom.mass.properties import MassProperties
from eom.mass.solids import CENTRE, SOLIDS
from eom.mechanics.dissipation import viscous_slug
from eom.mechanics.gyrostat import gyrostat
from eom.mechanics.rigidbody import free_rigid_body, gravity_gradient_satellite, heavy_top
from eom.mechanics.spinning import lecture_torque
from eom.quantities import Quantity
from eom.scenes import catalogue
from eom.system import Expr, System
from eom.typeset.markup import symbol_latex
from eom.worlds.solutions import Inconsistent, Motion, Restriction

if TYPE_CHECKING:
    from eom.opening import AnyScene

import sympy as sp

from eom.mechanics.lagrange import Mechanism, Placed, Spring, lagrange_system, speed
from eom.quantities import TIME
from eom.scenes.parse import parse

BUILTIN: dict[str, Callable[[str], System]] = {
    "free-rigid-body": lambda attitude: free_rigid_body(attitude or None),
    "heavy-body": lambda attitude: heavy_top(attitude or "quaternion"),
    "gravity-gradient-body": lambda attitude: gravity_gradient_satellite(attitude or "quaternion"),
    "spinner": lambda _: lecture_torque().system(),
    "viscous-slug": lambda a: viscous_slug(attitude_of(a) if a else None),
    "gyrostat": lambda a: gyrostat(1, attitude=attitude_of(a) if a else None),
}
"""Systems without numbers, from the name of attitude coordinates ("" for the usual ones)."""

PLACES = ("rad", "m", "1")
"""Units of coordinates."""
ZERO_UNITS = frozenset({"N m", "N", "m/s^2", "m", "kg m^2/s", "N m s", "rad/s"})
"""Units of the parameters and inputs that may be assumed to be zero."""
HELD_UNITS = frozenset({"rad", "m", "rad/s", "m/s"})
"""Units of the states that may be assumed to be constant."""

_MOMENT = re.compile(r"[A-Z]([1-3])\1?")
_PRODUCT = re.compile(r"[A-Z]([1-3])(?!\1)[1-3]")

LETTERS: tuple[tuple[str, tuple[str, ...]], ...] = (
    (r"omega_([1-3])", (r"\omega_{@}", r"\omega_{#}")),
    (r"[IJ]([1-3])(?:\1)?", ("I_{@}", "I_{#}", "I_{@@}", "I_{##}", "J_{@}", "J_{#}", "J_{@@}")),
    (r"[IJ]([1-3][1-3])", ("I_{@}", "J_{@}", "I_{#}", "J_{#}")),
    (r"torque_([1-3])", (r"\tau_{@}", "M_{@}", r"\tau_{#}", "M_{#}")),
    (r"q([0-3])", ("q_{@}", r"\beta_{@}")),
    (r"phi", (r"\phi", r"\varphi")),
    (r"theta", (r"\theta", r"\vartheta")),
)
"""Usual spellings of quantities by their names; @: the indices, #: the same as letters x, y, z."""


@dataclass(frozen=True)
class Model:
    """A system, what is given of its parameters, what may be assumed besides, and where it is from.

    ``values``: the scene's numbers of parameters and inputs. ``letters``: how a note writes
    quantities, by their names, where it writes them its own way. ``drawn``: solutions, kept for later.
    ``body``: of a solid, about the point from which its elements are measured.
    """

    system: System
    given: tuple[Restriction, ...] = ()
    possible: tuple[Restriction, ...] = ()
    name: str = ""
    letters: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)
    body: MassProperties | None = None
    drawn: dict[Any, Motion | Inconsistent | None] = field(
        default_factory=dict, repr=False, compare=False
    )

    @cached_property
    def quantities(self) -> Mapping[str, Quantity]:
        """Quantities by name; states go before parameters, inputs, definitions, outputs, constants."""
        s = self.system
        defined = (d.quantity for d in (*s.definitions, *s.outputs, *s.invariants))
        found: dict[str, Quantity] = {}
        for q in (*s.states, *s.parameters, *s.inputs, *defined):
            found.setdefault(q.name, q)
        return found

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates that are free, in their order."""
        given = imposed(self.system)
        return tuple(q.name for q in self.system.states if q.unit in PLACES and q.name not in given)

    def motions(
        self, restrictions: tuple[Restriction, ...], length: int, tries: int
    ) -> Iterator[Motion]:
        """Yield solutions that keep restrictions, by seed; those that were drawn before are kept.

        Raises `Inconsistent` where no solution keeps them.
        """
        names = tuple(r.name for r in restrictions)
        for seed in range(tries):
            key = (names, length, seed)
            if key not in self.drawn:
                self.drawn[key] = _solution(self.system, length, seed, restrictions)
            found = self.drawn[key]
            if isinstance(found, Inconsistent):
                raise found
            if found is not None:
                yield found

    def letter(self, name: str) -> str:
        """Return how a quantity is written in messages."""
        return self.letters.get(name, name)

    def symbol(self, name: str) -> Expr:
        """Return the symbol of a quantity. Raises `InputError` for unknown names."""
        if name not in self.quantities:
            raise unknown_name("quantity of the system", name, self.quantities)
        return self.quantities[name].symbol

    def spellings(self) -> Iterator[tuple[str, str]]:
        """Yield LaTeX and name: how each quantity is printed, then its usual spellings."""
        for name, q in self.quantities.items():
            yield printed(q), name
        if self.body is not None:
            yield from ((w, n) for n, ws in SPELLINGS.items() if n in self.quantities for w in ws)
        for name in self.quantities:
            for pattern, letters in LETTERS:
                match = re.fullmatch(pattern, name)
                if match is not None:
                    index = "".join(match.groups())
                    axes = index.translate(str.maketrans("123", "xyz"))
                    yield from ((w.replace("@", index).replace("#", axes), name) for w in letters)

    def restriction(self, name: str) -> Restriction:
        """Return what a name restricts. Raises `InputError` for unknown names."""
        known = {r.name: r for r in (*self.given, *self.possible)}
        if name not in known:
            raise unknown_name("assumption on the system", name, known)
        return known[name]


def imposed(system: System) -> frozenset[str]:
    """Return the names of the states whose second rates are inputs."""
    given = {q.name.removesuffix("_ddot") for q in system.inputs if q.name.endswith("_ddot")}
    return frozenset(given & {q.name for q in system.states})


def model_of(system: System | AnyScene | Model, assume: Iterable[str] = ()) -> Model:
    """Return a system or scene with what may be assumed of it; ``assume``: names that are given."""
    if isinstance(system, Model):
        made = system
    elif isinstance(system, System):
        made = Model(system, (), tuple(restrictions(system)), system.name)
    else:
        made = _of_scene(system)
    assumed = tuple(made.restriction(n) for n in assume)
    return replace(made, given=(*made.given, *assumed))


def _solution(
    system: System, length: int, seed: int, restrictions: tuple[Restriction, ...]
) -> Motion | Inconsistent | None:
    """Return a solution, why there can be none, or None where this point is singular."""
    try:
        return Motion(system, length, seed, restrictions)
    except Singular:
        return None
    except Inconsistent as error:
        return error


def _of_scene(scene: AnyScene) -> Model:
    """Sort the restrictions of parameters by what the scene's numbers say."""
    system = scene.full_system
    values = {**scene.numbers, **{n: v.value for n, v in scene.inputs.items()}}
    given, possible = [], []
    for r in restrictions(system):
        names = {str(s.name) for s in (*r.zero, *(s for pair in r.equal for s in pair))}
        if r.held or not names <= values.keys():
            possible.append(r)
        elif all(values[a.name] == values[b.name] for a, b in r.equal) and not any(
            values[s.name] for s in r.zero
        ):
            given.append(r)
    kept = {n: values[n] for n in (*system.parameter_names, *system.input_names) if n in values}
    return Model(system, tuple(given), tuple(possible), scene.name, values=kept)


def restrictions(system: System) -> Iterator[Restriction]:
    """Yield what may be assumed of a system: equal moments, zero torques or products, steady angles, rest.

    Rest (a rate that is zero at all times), and an imposed motion that is steady, come with ``rest`` set:
    they are never assumed unasked.
    """
    inertia = [q for q in system.parameters if q.unit == "kg m^2"]
    moments = [q.symbol for q in inertia if _MOMENT.fullmatch(q.name)]
    for a, b in combinations(moments, 2):
        yield Restriction(f"{a.name} = {b.name}", equal=((a, b),))
    for q in (*system.parameters, *(q for q in system.inputs if not q.name.endswith("_ddot"))):
        if q.unit in ZERO_UNITS or (q.unit == "kg m^2" and _PRODUCT.fullmatch(q.name)):
            yield Restriction(f"{q.name} = 0", zero=(q.symbol,))
    for q in system.states:
        if q.unit in HELD_UNITS:
            yield Restriction(f"{q.name} constant", held=(q.symbol,))
    names = {q.name for q in system.states}
    for q in system.states:
        if q.unit == "rad/s" and q.name.removesuffix("_dot") not in names - {q.name}:
            yield Restriction(f"{q.name} = 0", zero=(q.symbol,), rest=True)
    for q in system.inputs:
        if q.name.removesuffix("_ddot") in names:
            steady = q.name.replace("_ddot", "_dot constant")
            yield Restriction(steady, zero=(q.symbol,), rest=True)


_OWN_LATEX = re.compile(r"[A-Za-z](_([A-Za-z0-9]|\{\w+\}))?|.*\\.*")


def printed(q: Quantity) -> str:
    """Return the LaTeX of a quantity as its system is printed: its own, or that of its name."""
    return q.latex if _OWN_LATEX.fullmatch(q.latex) else symbol_latex(q.name)


# -- by name -----------------------------------------------------------------------------------------


@typed
def model_from(system: str | System | AnyScene | Model) -> Model:
    """Return the model of a system, a scene, the name of one, or a scene file (it ends in .toml)."""
    if not isinstance(system, str):
        return model_of(system)
    path = Path(system)
    return load_model(path.name, path.parent) if path.suffix == ".toml" else load_model(system)


def load_model(
    name: str,
    folder: Path | None = None,
    attitude: str = "",
    assume: Iterable[str] = (),
    point: str = CENTRE,
) -> Model:
    """Return a ready scene, a scene file beside the note (``folder``), a system of `BUILTIN`, a solid.

    ``attitude``: other attitude coordinates than the scene's; ``point``: of a solid, from which its
    elements are measured. Raises `InputError` for unknown names, and
    for files outside of the folder.
    """
    from eom.opening import load_scene  # many bodies are loaded where a scene is

    if name.endswith(".toml") or name in catalogue.names():
        scene = load_scene(_beside(name, folder) if name.endswith(".toml") else name)
        return model_of(scene.in_attitude(attitude) if attitude else scene, assume)
    if name in BUILTIN:
        return model_of(BUILTIN[name](attitude), assume)
    if name in SOLIDS:
        return Model(solid_system(name), name=name, body=body_about(name, point))
    raise unknown_name("system", name, [*catalogue.names(), *BUILTIN, *SOLIDS])


def _beside(name: str, folder: Path | None) -> Path:
    root = (folder or Path()).resolve()
    file = (root / name).resolve()
    if not file.is_relative_to(root):
        raise InputError("a scene file lies outside of the note's folder", got=name)
    return file


_OWN: dict[str, type] = {"assume": list, "symbols": dict}
_KEYS: dict[str, type] = {"is": str, "attitude": str, "point": str, **_OWN}

Row = tuple[str, Any, str]
"""LaTeX, meaning, and where it stands."""


def model_in(given: Any, folder: Path | None, where: str) -> Model:
    """Return the system that a text or table names. Raises `InputError` for what is neither."""
    table = _table(given, where)
    assume = table.get("assume", [])
    if not all(isinstance(a, str) for a in assume):
        raise InputError("not a list of assumptions", where=where, got=assume)
    if is_described(table) and "is" in table:
        raise InputError(
            "a system is given twice", where=where, got="is, and a description", expected="one"
        )
    if is_described(table):
        return model_of(described({k: v for k, v in table.items() if k not in _OWN}, where), assume)
    if "is" not in table:
        raise InputError(
            "a system has no name",
            where=where,
            expected='is = "heavy-top", or coordinates and bodies',
        )
    point = table.get("point", CENTRE)
    return load_model(table["is"], folder, table.get("attitude", ""), assume, point)


def _table(given: Any, where: str) -> Mapping[str, Any]:
    if isinstance(given, str):
        return {"is": given}
    if not isinstance(given, Mapping):
        raise InputError("not a system", where=where, got=given, expected="a name or a table")
    for key, value in given.items():
        if key not in _KEYS and key not in KEYS:
            raise unknown_name("key", str(key), [*_KEYS, *sorted(KEYS)], where)
        if key in _KEYS and not isinstance(value, _KEYS[key]):
            expected = _KEYS[key].__name__
            raise InputError("wrong type", where=f"{where} > {key}", got=value, expected=expected)
    return given


def symbols_in(given: Any, model: Model, where: str) -> tuple[list[Row], list[Row]]:
    """Return the rows of the note, and those of the usual spellings. Raises `InputError`."""
    own = [
        (latex, _meaning(value, model, f"{where} > {latex}"), f"{where} > {latex}")
        for latex, value in _table(given, where).get("symbols", {}).items()
    ]
    return own, list(_usual(model, where))


def _usual(model: Model, where: str) -> Iterator[Row]:
    for latex, name in model.spellings():
        yield latex, _spelt(model, name), where


def _meaning(value: Any, model: Model, where: str) -> Any:
    """Return a formula as it is; the name of a quantity as a meaning."""
    if isinstance(value, Mapping) or (isinstance(value, str) and value.lstrip().startswith("=")):
        return value
    if not isinstance(value, str) or value not in model.quantities:
        raise unknown_name("quantity of the system", str(value), model.quantities, where)
    return _spelt(model, value)


def _spelt(model: Model, name: str) -> Mapping[str, str]:
    return {"is": f"system {name}", "unit": model.quantities[name].unit}


HANGING: Mapping[str, str] = {"hinge": "revolute", "slide": "prismatic"}
"""Keys of a body in a tree that name the axis of its joint, and the kind of that."""
_TREE = frozenset("model gravity gravity_gradient bodies joints loads constraints rotors springs points "
                  "parameters inputs".split())  # fmt: skip
_PLACED = frozenset(
    "coordinates given parameters gravity potential forces bodies springs reactions".split()
)
KEYS = _TREE | _PLACED
"""Keys of a table that describes a system."""


def is_described(table: Mapping[str, Any]) -> bool:
    """Tell whether a table describes a system."""
    return bool(KEYS & set(table))


def described(table: Mapping[str, Any], where: str) -> System:
    """Return the system that a table describes. Raises `InputError` with the place of what is wrong."""
    if "coordinates" in table:
        return lagrange_system(_Read(table, where).mechanism)
    return _tree(table, where)


# -- trees ---------------------------------------------------------------------------------------------


def _tree(table: Mapping[str, Any], where: str) -> System:
    from eom.multibody.files.scene import TreeScene  # many bodies are loaded where a scene is

    _known(table, _TREE, where)
    bodies, joints = {}, dict(_own_table(table, "joints", where))
    for name, given in _own_table(table, "bodies", where).items():
        place = f"{where} > bodies > {name}"
        body = dict(_of_type(given, Mapping, place))
        axes = [k for k in HANGING if k in body]
        if len(axes) > 1 or (axes and name in joints):
            raise InputError("a body hangs on one joint", where=place, got=", ".join(axes))
        parent, at = body.pop("on", "ground"), body.pop("at", (0, 0, 0))
        for key in axes:
            joints[name] = {
                "kind": HANGING[key],
                "parent": parent,
                "child": name,
                "axis": body.pop(key),
                "on_parent": {"position": at},
            }
        bodies[name] = body
    parameters = {
        n: {"value": 1, "unit": u} if isinstance(u, str) else u
        for n, u in _own_table(table, "parameters", where).items()
    }
    data = {**table, "bodies": bodies, "joints": joints, "parameters": parameters}
    try:
        return TreeScene(**data).full_system
    except InputError as error:
        raise error.at(", ".join(p for p in (where, error.where) if p)) from error


# -- coordinates and places ----------------------------------------------------------------------------


@dataclass(frozen=True)
class _Read:
    """A table of coordinates and places; ``where``: its place in the lexicon."""

    table: Mapping[str, Any]
    where: str
    names: dict[str, Expr] = field(default_factory=dict)

    @property
    def mechanism(self) -> Mechanism:
        """What the table describes."""
        _known(self.table, _PLACED, self.where)
        coordinates, given = (self._units(k) for k in ("coordinates", "given"))
        parameters = self._units("parameters")
        self.names.update({str(s.name): s for s in (*coordinates, *given, *parameters)})
        self.names.update({f"{s.name}_dot": speed(s) for s in (*coordinates, *given)})
        self.names["t"] = TIME
        bodies = self._each("bodies", self._body)
        if not bodies:
            raise InputError("a system has no bodies", where=self.where, expected="[system.bodies]")
        forces = _own_table(self.table, "forces", self.where)
        _known(forces, {str(q.name) for q in coordinates}, f"{self.where} > forces")
        return Mechanism(
            "system",
            coordinates,
            given,
            tuple(Quantity(s, unit) for s, unit in parameters.items()),
            bodies,
            self._vector(self.table.get("gravity", (0, 0, 0)), f"{self.where} > gravity"),
            self._formula(self.table.get("potential", 0), f"{self.where} > potential"),
            tuple(self._each("springs", lambda g, w: self._spring(g, w, bodies)).values()),
            {
                self.names[n]: self._formula(f, f"{self.where} > forces > {n}")
                for n, f in forces.items()
            },
            self._each("reactions", lambda g, w: self._reaction(g, w, bodies)),
        )

    def _units(self, key: str) -> dict[Expr, str]:
        found = {}
        for name, unit in _own_table(self.table, key, self.where).items():
            place = f"{self.where} > {key} > {name}"
            found[sp.Symbol(name, real=True)] = _of_type(unit, str, place)
        return found

    def _each(self, key: str, read: Callable[[Any, str], Any]) -> dict[str, Any]:
        rows = _own_table(self.table, key, self.where).items()
        return {n: read(given, f"{self.where} > {key} > {n}") for n, given in rows}

    def _formula(self, given: Any, where: str) -> Expr:
        if isinstance(given, str):
            return parse(given, self.names, where)
        if isinstance(given, bool) or not isinstance(given, int | float):
            raise InputError("not a formula", where=where, got=given)
        return sp.nsimplify(given)

    def _vector(self, given: Any, where: str) -> tuple[Expr, ...]:
        if not isinstance(given, list | tuple) or len(given) != 3:
            raise InputError("not three components", where=where, got=given)
        return tuple(self._formula(g, where) for g in given)

    def _listed(self, given: Any, where: str) -> tuple[Expr, ...]:
        return tuple(
            self._formula(g, where) for g in (given if isinstance(given, list) else [given])
        )

    def _body(self, given: Any, where: str) -> Placed:
        row = _of_type(given, Mapping, where)
        _known(row, {"mass", "at", "moments", "omega", "force"}, where)
        moments = self._listed(row.get("moments", []), where)
        omega = self._listed(row.get("omega", []), where)
        if len(moments) != len(omega):
            raise InputError("as many moments as components of omega", where=where, got=len(omega))
        return Placed(
            self._formula(row.get("mass", 0), f"{where} > mass"),
            self._vector(row.get("at", (0, 0, 0)), f"{where} > at"),
            moments,
            omega,
            self._vector(row.get("force", (0, 0, 0)), f"{where} > force"),
        )

    def _spring(self, given: Any, where: str, bodies: Mapping[str, Placed]) -> Spring:
        row = _of_type(given, Mapping, where)
        _known(row, {"between", "stiffness", "length"}, where)
        ends = row.get("between", [])
        if not isinstance(ends, list) or len(ends) != 2 or "stiffness" not in row:
            raise InputError(
                "a spring is between two ends", where=where, expected="between, stiffness"
            )
        names = [e if isinstance(e, str) else "" for e in ends]
        _known([n for n in names if n], bodies, where)
        places = [bodies[e].at if isinstance(e, str) else self._vector(e, where) for e in ends]
        return Spring(
            (places[0], places[1]),
            self._formula(row["stiffness"], where),
            self._formula(row.get("length", 0), where),
            (names[0], names[1]),
        )

    def _reaction(
        self, given: Any, where: str, bodies: Mapping[str, Placed]
    ) -> tuple[str, tuple[Expr, ...]]:
        row = _of_type(given, Mapping, where)
        _known(row, {"on", "along"}, where)
        if row.get("on") not in bodies:
            raise unknown_name("body", str(row.get("on")), bodies, where)
        return str(row["on"]), self._vector(row.get("along"), f"{where} > along")


def _own_table(data: Mapping[str, Any], key: str, where: str) -> Mapping[str, Any]:
    return dict(_of_type(data.get(key, {}), Mapping, f"{where} > {key}"))


def _of_type(given: Any, kind: type, where: str) -> Any:
    if not isinstance(given, kind):
        expected = "a table" if kind is Mapping else "a text"
        raise InputError("wrong type", where=where, got=given, expected=expected)
    return given


def _known(given: Iterable[str], known: Iterable[str], where: str) -> None:
    known = sorted(known)
    for key in given:
        if key not in known:
            raise unknown_name("key", str(key), known, where)
