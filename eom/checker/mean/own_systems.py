r"""Systems that a lexicon describes itself: by coordinates and places, or as a tree of bodies.

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

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from eom.errors import InputError, unknown_name
from eom.mechanics.lagrange import Mechanism, Placed, Spring, lagrange_system, speed
from eom.quantities import TIME, Quantity
from eom.scenes.parse import parse
from eom.system import Expr, System

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
    bodies, joints = {}, dict(_table(table, "joints", where))
    for name, given in _table(table, "bodies", where).items():
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
        for n, u in _table(table, "parameters", where).items()
    }
    data = {**table, "bodies": bodies, "joints": joints, "parameters": parameters}
    try:
        return TreeScene(**data).full_system
    except InputError as error:
        raise _placed(error, where) from error


def _placed(error: InputError, where: str) -> InputError:
    """Return an error with the place in the lexicon in front of its own."""
    inside = ", ".join(p for p in (where, error.where) if p)
    return InputError(
        error.what, where=inside, got=error.got, expected=error.expected, hint=error.hint
    )


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
        forces = _table(self.table, "forces", self.where)
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
        for name, unit in _table(self.table, key, self.where).items():
            place = f"{self.where} > {key} > {name}"
            found[sp.Symbol(name, real=True)] = _of_type(unit, str, place)
        return found

    def _each(self, key: str, read: Callable[[Any, str], Any]) -> dict[str, Any]:
        rows = _table(self.table, key, self.where).items()
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


def _table(data: Mapping[str, Any], key: str, where: str) -> Mapping[str, Any]:
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
