r"""A system that a note is about: its quantities by name, their usual spellings, what may be assumed of it.

A scene is one particular system: what its numbers say of the parameters (equal moments of inertia,
values that are zero) holds, and the contrary cannot be assumed. Of a bare system anything of the table
may be assumed.

The system that a lexicon names: its table, and what the note's symbols stand for in it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eom.checker.mean.own_systems import KEYS, described, is_described
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


BUILTIN: dict[str, Callable[[str], System]] = {
    "free-rigid-body": lambda attitude: free_rigid_body(attitude or None),
    "heavy-body": lambda attitude: heavy_top(attitude or "quaternion"),
    "gravity-gradient-body": lambda attitude: gravity_gradient_satellite(attitude or "quaternion"),
    "spinner": lambda _: lecture_torque().system(),
    "viscous-slug": lambda a: viscous_slug(attitude_of(a) if a else None),
    "gyrostat": lambda a: gyrostat(1, attitude=attitude_of(a) if a else None),
}
"""Systems without numbers, from the name of attitude coordinates ("" for the usual ones)."""

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
