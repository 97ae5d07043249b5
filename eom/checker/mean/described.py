r"""What a lexicon says of the system of a note: its table, what symbols stand for, systems described.

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

Any system may have quantities of its own, any functions of coordinates, momenta and time (those by
Lagrange), and particular motions, of which derived quantities are meant (`Particular`):

    functions = { f = "q p t", h = "q p" }
    [system.values]
    v = { is = "R*theta_dot", unit = "m/s" }
    e_r = { is = ["sin(theta)", 0, "-cos(theta)"] }
    M = { is = "-V_by_theta", unit = "N*m" } # how the potential energy changes with a coordinate
    [system.motions]
    cone = { constant = ["theta"], nonzero = ["sin(theta)"] }
    slide = { start = { x_dot = "v_0", phi_dot = 0 }, until = "x_dot - R*phi_dot" }
    hit = { closing = ["x_2 - x_1"], restitution = "e" }
    [system.symbols]
    '\theta_0' = "theta at cone"
    '\omega_n' = "frequency at cone"            # of small oscillations; period, eigenvalue
    't_1' = "t at end of slide"
    "v_1'" = "x_1_dot after hit"
    '\vec r' = "position of bead"              # velocity, acceleration; vector e_r

As a tree, with the keys of a scene file (`eom.multibody.files.description`); a body may say in one line
how it hangs on another, its joint has its name:

    parameters = { M = "kg", m = "kg", l = "m", g = "m/s^2" }
    gravity = [0, 0, "-g"]
    [system.bodies]
    cart = { mass = "M", slide = "x" }
    bob = { mass = "m", centre = [0, 0, "-l"], on = "cart", hinge = "y" }
"""

from __future__ import annotations

import random
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import sympy as sp

from eom.checker.mean.lexicon import MATRICES
from eom.checker.mean.model import Model, Particular, load_model, model_of
from eom.errors import InputError, unknown_name
from eom.expressions import as_expression
from eom.mass.solids import CENTRE
from eom.mechanics.lagrange import LONG, Mechanism, Placed, Spring, lagrange_system, speed
from eom.quantities import TIME, Definition, Quantity
from eom.scenes.parse import parse
from eom.system import Expr, System
from eom.worlds.solutions import rate

_OWN: dict[str, type] = {
    "assume": list, "symbols": dict, "values": dict, "motions": dict, "functions": dict,
    "usual": bool, "first": bool,
}  # fmt: skip
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
        plain = {k: v for k, v in table.items() if k not in _OWN}
        return _with_own(_described(plain, where), table, where, assume)
    if "is" not in table:
        raise InputError(
            "a system has no name",
            where=where,
            expected='is = "heavy-top", or coordinates and bodies',
        )
    point = table.get("point", CENTRE)
    found = load_model(table["is"], folder, table.get("attitude", ""), (), point)
    return _with_own(found, table, where, assume)


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
        known = model.quantities.get(name)
        yield latex, _spelt(name, "" if known is None else known.unit), where


def _meaning(value: Any, model: Model, where: str) -> Any:
    """Return a formula, or a matrix, as it is; the name of a quantity as a meaning."""
    if isinstance(value, Mapping) or str(value).lstrip().startswith("=") or value in MATRICES:
        return value
    return _spelt(*model.meaning(str(value), where))


def _spelt(name: str, unit: str) -> Mapping[str, str]:
    return {"is": f"system {name}", "unit": unit}


_MOTION = frozenset("constant zero nonzero start until impulse closing restitution".split())
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
    return _described(table, where).system


def _described(table: Mapping[str, Any], where: str) -> Model:
    if "coordinates" not in table:
        return model_of(_tree(table, where))
    mechanism = _Read(table, where).mechanism
    lagrange = lagrange_system(mechanism)
    return replace(
        model_of(lagrange),
        coordinates=tuple(str(q.name) for q in mechanism.coordinates),
        vectors={n: b.at for n, b in mechanism.bodies.items()},
        canonical=frozenset({"H"} & {d.name for d in lagrange.outputs}),
    )


# -- quantities of its own and particular motions --------------------------------------------------------


def _with_own(model: Model, table: Mapping[str, Any], where: str, assume: Iterable[str]) -> Model:
    """Return a model with values, functions and motions that the lexicon adds. Raises `InputError`."""
    own_names = _own_table(table, "values", where)
    outputs = [_aside(d, own_names) for d in model.system.outputs]
    vectors = dict(model.vectors)
    read = _Read(table, where, {n: q.symbol for n, q in model.quantities.items()})
    read.names["t"] = model.system.time
    read.names.update({f"{q}_ddot": rate(rate(model.symbol(q))) for q in model.coordinates})
    read.names.update(_slopes(model))
    for name, given in own_names.items():
        place = f"{where} > values > {name}"
        row = _of_type(given, Mapping, place)
        _known(row, {"is", "unit"}, place)
        if isinstance(row.get("is"), list):
            vectors[name] = read.vector(row["is"], place)
        else:
            own = Quantity(sp.Symbol(name, real=True), row.get("unit", ""))
            outputs.append(Definition(own, as_expression(read.formula(row.get("is"), place))))
            read.names[name] = own.symbol
    functions = _own_table(table, "functions", where)
    outputs += [_any_function(model, n, str(of), where) for n, of in functions.items()]
    made = replace(
        model,
        system=replace(model.system, outputs=tuple(outputs)),
        vectors=vectors,
        particular=read.each("motions", read.motion),
        canonical=model.canonical | frozenset(functions),
    )
    return model_of(made, assume)


def _slopes(model: Model) -> Mapping[str, Expr]:
    """Return how the potential energy changes with each coordinate, ``V_by_theta``."""
    energy = next((d.expression for d in model.system.outputs if d.name == "V"), None)
    if energy is None:
        return {}
    return {f"V_by_{q}": energy.diff(model.symbol(q)) for q in model.coordinates}


def _aside(d: Definition, taken: Container[str]) -> Definition:
    """Return an energy by its long name where the lexicon has its letter for something else."""
    if d.name not in taken or d.name not in LONG:
        return d
    return Definition(replace(d.quantity, symbol=sp.Symbol(LONG[d.name], real=True)), d.expression)


def _any_function(model: Model, name: str, of: str, where: str) -> Definition:
    """Return a random polynomial of the second degree in coordinates, momenta and time, as it says."""
    groups = {
        "q": [model.symbol(q) for q in model.coordinates],
        "p": [model.symbol(f"p_{q}") for q in model.coordinates],
        "t": [model.system.time],
    }
    _known(of.split(), groups, f"{where} > functions > {name}")
    variables = [v for group in of.split() for v in groups[group]]
    values = {d.symbol: d.expression for d in model.system.outputs}
    generator = random.Random(name)  # noqa: S311 - reproducible, no secret
    monomials = (
        x * y for k, x in enumerate((sp.S.One, *variables)) for y in variables[max(k - 1, 0) :]
    )
    found = sp.Add(*(generator.randint(1, 99) * m for m in monomials))
    return Definition(Quantity(sp.Symbol(name, real=True)), found.xreplace(values))


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
        bodies = self.each("bodies", self._body)
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
            self.vector(self.table.get("gravity", (0, 0, 0)), f"{self.where} > gravity"),
            self.formula(self.table.get("potential", 0), f"{self.where} > potential"),
            tuple(self.each("springs", lambda g, w: self._spring(g, w, bodies)).values()),
            {
                self.names[n]: self.formula(f, f"{self.where} > forces > {n}")
                for n, f in forces.items()
            },
            self.each("reactions", lambda g, w: self._reaction(g, w, bodies)),
        )

    def _units(self, key: str) -> dict[Expr, str]:
        found = {}
        for name, unit in _own_table(self.table, key, self.where).items():
            place = f"{self.where} > {key} > {name}"
            found[sp.Symbol(name, real=True)] = _of_type(unit, str, place)
        return found

    def motion(self, given: Any, where: str) -> Particular:
        """Return a particular motion."""
        row = _of_type(given, Mapping, where)
        _known(row, _MOTION, where)
        constant, zero, nonzero, closing = (
            tuple(map(as_expression, self._listed(row.get(k, []), where)))
            for k in ("constant", "zero", "nonzero", "closing")
        )
        start, blows = (self._by_name(row, k, where) for k in ("start", "impulse"))
        until = self.formula(row["until"], where) if "until" in row else None
        restitution = as_expression(self.formula(row.get("restitution", 0), where))
        return Particular(constant, zero, nonzero, start, until, blows, closing, restitution)

    def _by_name(self, row: Mapping[str, Any], key: str, where: str) -> dict[Expr, Expr]:
        found = _own_table(row, key, where)
        _known(found, self.names, f"{where} > {key}")
        return {self.names[n]: as_expression(self.formula(f, where)) for n, f in found.items()}

    def each(self, key: str, read: Callable[[Any, str], Any]) -> dict[str, Any]:
        """Return what the rows of a table are read as."""
        rows = _own_table(self.table, key, self.where).items()
        return {n: read(given, f"{self.where} > {key} > {n}") for n, given in rows}

    def formula(self, given: Any, where: str) -> Expr:
        """Return a text or number as an expression. Raises `InputError`."""
        if isinstance(given, str):
            return parse(given, self.names, where)
        if isinstance(given, bool) or not isinstance(given, int | float):
            raise InputError("not a formula", where=where, got=given)
        return sp.nsimplify(given)

    def vector(self, given: Any, where: str) -> tuple[Expr, ...]:
        """Return three components. Raises `InputError`."""
        if not isinstance(given, list | tuple) or len(given) != 3:
            raise InputError("not three components", where=where, got=given)
        return tuple(self.formula(g, where) for g in given)

    def _listed(self, given: Any, where: str) -> tuple[Expr, ...]:
        return tuple(
            self.formula(g, where) for g in (given if isinstance(given, list) else [given])
        )

    def _body(self, given: Any, where: str) -> Placed:
        row = _of_type(given, Mapping, where)
        _known(row, {"mass", "at", "moments", "omega", "force"}, where)
        moments = self._listed(row.get("moments", []), where)
        omega = self._listed(row.get("omega", []), where)
        if len(moments) != len(omega):
            raise InputError("as many moments as components of omega", where=where, got=len(omega))
        return Placed(
            self.formula(row.get("mass", 0), f"{where} > mass"),
            self.vector(row.get("at", (0, 0, 0)), f"{where} > at"),
            moments,
            omega,
            self.vector(row.get("force", (0, 0, 0)), f"{where} > force"),
        )

    def _spring(self, given: Any, where: str, bodies: Mapping[str, Placed]) -> Spring:
        row = _of_type(given, Mapping, where)
        _known(row, {"between", "stiffness", "length"}, where)
        ends = row.get("between", [])
        if not isinstance(ends, list) or len(ends) != 2 or "stiffness" not in row:
            raise InputError("a spring is between two ends", where=where,
                             expected="between, stiffness")  # fmt: skip
        names = [e if isinstance(e, str) else "" for e in ends]
        _known([n for n in names if n], bodies, where)
        places = [bodies[e].at if isinstance(e, str) else self.vector(e, where) for e in ends]
        return Spring(
            (places[0], places[1]),
            self.formula(row["stiffness"], where),
            self.formula(row.get("length", 0), where),
            (names[0], names[1]),
        )

    def _reaction(
        self, given: Any, where: str, bodies: Mapping[str, Placed]
    ) -> tuple[str, tuple[Expr, ...]]:
        row = _of_type(given, Mapping, where)
        _known(row, {"on", "along"}, where)
        if row.get("on") not in bodies:
            raise unknown_name("body", str(row.get("on")), bodies, where)
        return str(row["on"]), self.vector(row.get("along"), f"{where} > along")


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
