r"""A system that a note is about: its quantities by name, their usual spellings, what may be assumed of it.

A scene is one particular system: what its numbers say of the parameters (equal moments of inertia,
values that are zero) holds, and the contrary cannot be assumed. Of a bare system anything of the table
may be assumed.
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
from eom.worlds.solutions import Inconsistent, Motion, Restriction, rate, without_rates

if TYPE_CHECKING:
    from eom.opening import AnyScene

import sympy as sp

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
"""Units of the parameters and inputs that may be assumed to be zero; a blank stands for any product."""
LOADS = frozenset({"N", "N m"})
"""Units of what may be absent."""
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
class Particular:
    """A particular motion of a system, by expressions over its symbols.

    ``constant``: what does not change; ``zero``, ``nonzero``: what vanishes, or does not, at its last
    instant. ``start``: values at its first one; ``until``: vanishes at the last one, None where there is
    one instant. A blow between both: ``blows``, generalised impulses by coordinate, and ``closing``, gaps
    that open ``restitution`` times as fast as they closed.
    """

    constant: tuple[Expr, ...] = ()
    zero: tuple[Expr, ...] = ()
    nonzero: tuple[Expr, ...] = ()
    start: Mapping[Expr, Expr] = field(default_factory=dict)
    until: Expr | None = None
    blows: Mapping[Expr, Expr] = field(default_factory=dict)
    closing: tuple[Expr, ...] = ()
    restitution: Expr = sp.S.Zero

    @property
    def is_blow(self) -> bool:
        """Whether speeds jump."""
        return bool(self.blows or self.closing)

    @property
    def cases(self) -> frozenset[Expr]:
        """The letter that says of which kind a blow is."""
        return self.restitution.free_symbols if self.is_blow else frozenset()

    @property
    def symbols(self) -> frozenset[Expr]:
        """All symbols in it."""
        parts = (*self.constant, *self.zero, *self.start.values(), *self.blows.values())
        found = (*parts, *self.closing, self.restitution, self.until or sp.S.Zero)
        return frozenset().union(*(e.free_symbols for e in found))


@dataclass(frozen=True)
class Model:
    """A system, what is given of its parameters, what may be assumed besides, and where it is from.

    ``values``: the scene's numbers of parameters and inputs. ``letters``: how a note writes
    quantities, by their names, where it writes them its own way. ``drawn``: what was drawn, for later.
    ``body``: of a solid, about the point from which its elements are measured. ``coordinates``: of a
    system by Lagrange, their names; ``vectors``: places of bodies and vectors of its own, in inertial axes;
    ``particular``: motions by name; ``canonical``: names of functions of coordinates, momenta and time.
    """

    system: System
    given: tuple[Restriction, ...] = ()
    possible: tuple[Restriction, ...] = ()
    name: str = ""
    letters: Mapping[str, str] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)
    body: MassProperties | None = None
    coordinates: tuple[str, ...] = ()
    vectors: Mapping[str, tuple[Expr, ...]] = field(default_factory=dict)
    particular: Mapping[str, Particular] = field(default_factory=dict)
    canonical: frozenset[str] = frozenset()
    drawn: dict[Any, Any] = field(default_factory=dict, repr=False, compare=False)

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
    def free_coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates that are not imposed, in their order, of any system."""
        given = imposed(self.system)
        return tuple(q.name for q in self.system.states if q.unit in PLACES and q.name not in given)

    def constant(self, name: str, order: int = 0) -> Expr | None:
        """Return a quantity's derivative by time where parameters alone give it; None for all else."""
        of = self.quantities.get(name)
        if of is None or of in self.system.parameters or self.given:
            return None
        key = ("constant", name, order, id(self.system))
        if key not in self.drawn:
            self.drawn[key] = _constant(self.system, of.symbol, order)
        return self.drawn[key]

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
        """Return the symbol of a quantity; ``@`` stands before the motion that it is derived of.

        Raises `InputError` for unknown names.
        """
        numbered = _NUMBERED.fullmatch(name)
        if numbered and int(numbered[2]) <= len(self.coordinates):
            name = RUNNING[numbered[1]].format(self.coordinates[int(numbered[2]) - 1])
        if "@" in name:
            return sp.Symbol(name)
        if name not in self.quantities:
            raise unknown_name("quantity of the system", name, self.quantities)
        return self.quantities[name].symbol

    def vector(self, name: str) -> tuple[Expr, ...]:
        """Return the components of a vector in inertial axes: ``velocity:bob``. Raises `InputError`."""
        kind, _, of = name.partition(":")
        if kind not in VECTORS or of not in self.vectors:
            raise unknown_name("vector of the system", of, self.vectors)
        found = self.vectors[of]
        for _ in range(VECTORS[kind][1]):
            found = tuple(map(rate, found))
        return found

    def meaning(self, text: str, where: str = "") -> tuple[str, str]:
        """Return label and unit of what words mean: a quantity, one at an instant of a motion, a vector.

        Raises `InputError` for all else.
        """
        words = text.split()
        if text in self.quantities:
            return text, self.quantities[text].unit
        if words and words[0] in VECTORS and words[-1] in self.vectors and len(words) < 4:
            kind = words[0]
            return f"{kind}:{words[-1]}", VECTORS[kind][0]
        for at, label in INSTANTS.items():
            what, found, motion = text.partition(f" {at} ")
            if found and motion in self.particular:
                return f"{'_'.join(what.split())}@{motion}{label}", self._unit(what, where)
        known = [*self.quantities, *(f"{k} of {v}" for k in VECTORS for v in self.vectors)]
        known += [f"frequency at {m}" for m in self.particular]
        raise unknown_name("quantity of the system", text, known, where)

    def _unit(self, what: str, where: str) -> str:
        name = what.split(maxsplit=1)[0]
        if name in DERIVED:
            return DERIVED[name]
        if what not in self.quantities:
            raise unknown_name("quantity of the system", what, [*self.quantities, *DERIVED], where)
        return self.quantities[what].unit

    def cases(self, blows: Iterable[Expr]) -> Iterator[Restriction]:
        """Yield special cases of particular motions: elastic and plastic blows, no load, an angle at zero.

        ``blows``: what says how fast gaps open.
        """
        for e in sorted(blows, key=str):
            yield from (Restriction(f"{e} = {n}", equal=((sp.Integer(n), e),)) for n in (1, 0))
        for q in (*self.system.inputs, *self.system.parameters):
            if is_load(q) or q.unit == "rad":
                yield Restriction(f"{q.name} = 0", zero=(q.symbol,))

    @cached_property
    def starting(self) -> Mapping[Expr, str]:
        """The parameters that stand in particular motions alone, with the motion of each."""
        s = self.system
        named = (*s.rates, *(d.expression for d in (*s.definitions, *s.outputs)))
        used = frozenset().union(*(e.free_symbols for e in named))
        own = {q.symbol for q in s.parameters} - used
        return {p: n for n, m in self.particular.items() for p in m.symbols & own}

    def spellings(self) -> Iterator[tuple[str, str]]:
        """Yield LaTeX and name: how each quantity is printed, then its usual spellings."""
        for name, q in self.quantities.items():
            if name not in self.canonical:
                yield printed(q), name
        if self.coordinates:
            yield from ((f"{w}_{{<c>}}", f"{w}_<c>") for w in RUNNING)
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


RUNNING: Mapping[str, str] = {"q": "{}", "p": "p_{}", "Q": "Q_{}"}
"""Letters with a running index: coordinates, momenta, generalised forces, by names of coordinates."""
_NUMBERED = re.compile(r"([qpQ])_(\d+)")
VECTORS: Mapping[str, tuple[str, int]] = {
    "position": ("m", 0), "velocity": ("m/s", 1), "acceleration": ("m/s^2", 2), "vector": ("", 0),
}  # fmt: skip
"""Vectors of a system: their units, and how often what is stated is differentiated."""
DERIVED: Mapping[str, str] = {
    "t": "s", "frequency": "rad/s", "cycles": "1/s", "period": "s", "eigenvalue": "rad/s", "impulse": "",
}  # fmt: skip
"""Quantities of particular motions alone, and their units."""
FIRST = ".start"
INSTANTS: Mapping[str, str] = {
    "at start of": FIRST, "before": FIRST, "at end of": "", "after": "", "at": "", "of": "",
}  # fmt: skip
"""Words for the first and the last instant of a motion."""


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


def _constant(system: System, term: Expr, order: int) -> Expr | None:
    """Return a derivative by time where parameters alone give it; None for all else."""
    for _ in range(order):
        term = rate(term)
    try:
        found = sp.cancel(sp.together(without_rates(system, term)))
    except InputError:
        return None
    return found if found.free_symbols <= {p.symbol for p in system.parameters} else None


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
    inertia = {q for q in system.parameters if _spaced(q.unit) == "kg m^2"}
    moments = [q.symbol for q in system.parameters if q in inertia and _MOMENT.fullmatch(q.name)]
    for a, b in combinations(moments, 2):
        yield Restriction(f"{a.name} = {b.name}", equal=((a, b),))
    for q in (*system.parameters, *(q for q in system.inputs if not q.name.endswith("_ddot"))):
        if _spaced(q.unit) in ZERO_UNITS or (q in inertia and _PRODUCT.fullmatch(q.name)):
            yield Restriction(f"{q.name} = 0", zero=(q.symbol,))
    names = {q.name for q in system.states}
    yield from _absent(system)
    for q in system.states:
        if q.unit in HELD_UNITS:
            yield Restriction(f"{q.name} constant", held=(q.symbol,))
    for q in system.states:
        if q.unit == "rad/s" and q.name.removesuffix("_dot") not in names - {q.name}:
            yield Restriction(f"{q.name} = 0", zero=(q.symbol,), rest=True)
    for q in system.inputs:
        if q.name.removesuffix("_ddot") in names:
            steady = q.name.replace("_ddot", "_dot constant")
            yield Restriction(steady, zero=(q.symbol,), rest=True)


def is_load(q: Quantity) -> bool:
    """Return whether a quantity is a force or a moment, which may be absent."""
    return _spaced(q.unit) in LOADS


def _spaced(unit: str) -> str:
    """Return a unit with blanks for products."""
    return unit.replace("*", " ")


def _absent(system: System) -> Iterator[Restriction]:
    """Yield that loads which are given as functions of time are zero throughout."""
    known = {q.name: q.symbol for q in (*system.states, *system.inputs)}
    for q in system.states:
        if is_load(q) and q.name in imposed(system):
            rates = (f"{q.name}_dot", f"{q.name}_ddot")
            zero = (q.symbol, *(known[r] for r in rates if r in known))
            yield Restriction(f"{q.name} = 0", zero=zero)


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
