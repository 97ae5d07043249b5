"""Whether one quantity is never below another: proved by form, or searched for counterexamples.

What lies between is a form in the place of one mass element where it is linear in the masses; such a
form is never negative if all principal minors of its matrix are sums of even powers with coefficients
that are not negative (Sylvester's criterion, term by term). All else is tried in rational worlds, whose
masses are positive, among them rods, plane bodies, axes of symmetry and vectors that vanish.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import combinations
from typing import Any

import sympy as sp

from eom.checker.mean.claims import Claim
from eom.checker.mean.elaborator import ALIKE
from eom.derivations.verification import not_negative
from eom.errors import InputError
from eom.exact import series
from eom.exact.series import LENGTH, Series, Vector
from eom.fields import RATIONALS, Field, Singular
from eom.terms import rules
from eom.terms.terms import SCALAR, VECTOR, Term, add, nodes, number, replace, zero
from eom.terms.vocabulary import definition, quantity, unit
from eom.worlds.evaluate import Evaluator
from eom.worlds.generators import worlds
from eom.worlds.worlds import ANGLES, World, closure

STRICT = frozenset({"<", ">"})
LESS = frozenset({"<", "<="})
ORDERS = STRICT | {"<=", ">="}
"""Relations that are judged here."""

COUNT = 8
"""Worlds of the general family; the special ones have a quarter as many."""

FAMILIES: tuple[tuple[str, ...], ...] = (
    (),
    ("thin_rod",),
    ("principal_axes",),
    ("symmetric",),
    ("O_fixed_in_body", "about_centre"),
)
"""What may be assumed beside, where it can stand with the rest; the first is the general one."""

ALWAYS, NEVER, SOMETIMES, BARELY = "always", "never", "sometimes", "barely"


@dataclasses.dataclass(frozen=True)
class Sign:
    """What was found of ``term > 0`` or ``>= 0``.

    ``found``: "always" (as far as was tried), "never" (the opposite is proved), "sometimes" or "barely"
    (never below zero, but zero in special cases, against a strict sign); ``proved``: by its form;
    ``tried``: how many worlds;
    ``where``: assumptions and seed of a world against it, and in words what is special there.
    """

    found: str
    proved: bool
    tried: int
    where: tuple[tuple[str, ...], int] | None = None
    special: str = ""


def difference(link: Claim) -> tuple[Term, bool]:
    """Return what a link of two members says to be positive or not negative, and whether strictly.

    Raises `InputError` where the sides are no scalars.
    """
    (relation,), (a, b) = link.relations, link.members
    if a.shape != SCALAR or b.shape != SCALAR:
        raise InputError("only scalars are greater or less", got=f"{a.shape}, {b.shape}")
    more, less = (b, a) if relation in LESS else (a, b)
    return add(more.term, -less.term), relation in STRICT


def sign(term: Term, strict: bool, scalars: Mapping[Any, Term], base: Iterable[str]) -> Sign:
    """Return what is found of a difference in worlds under ``base``. Raises `InputError`: no value."""
    assumed = tuple(base)
    proved = _proved(term, scalars)
    if proved and (not strict or _positive(term, scalars)):
        return Sign(ALWAYS, True, 0)
    values = list(_values(term, scalars, assumed))
    general = [v for v, _, special in values if not special]
    if not general:
        raise InputError("it has no value for any body and motion that was tried")
    against = next(((w, s) for v, w, s in values if v < 0), None)
    if against is not None:
        never = not any(v > 0 for v in general) and _proved(-term, scalars)
        return Sign(NEVER if never else SOMETIMES, False, len(values), *against)
    naught = next(((w, s) for v, w, s in values if v == 0), None)
    if strict and naught is not None:
        found = BARELY if any(v > 0 for v in general) else NEVER
        return Sign(found, proved, len(values), *naught)
    return Sign(ALWAYS, proved and not strict, len(values))


# -- worlds --------------------------------------------------------------------------------------

Found = tuple[Any, tuple[tuple[str, ...], int], str]
"""A value, the world, and what is special in it."""


def _values(term: Term, scalars: Mapping[Any, Term], base: tuple[str, ...]) -> Iterator[Found]:
    names = {n.data[0] for n in _parts(term, scalars) if n.head == "atom"}
    given = closure(base)
    fixed = names & FORCED or given & SOLVED or ("rigid" in given and "body_frame" not in given)
    changed = {} if fixed else _CHANGED
    length = _length(term, scalars)
    for family in FAMILIES:
        try:
            assumed = closure([*base, *family])
        except InputError:
            continue
        for world in worlds(assumed, COUNT // 4 if family else COUNT, field=RATIONALS):
            place = (tuple(sorted(assumed)), world.seed)
            short = _cut(world, length)
            yield from _in(short, term, scalars, place, ", ".join(family))
            for special, change in changed.items() if not family else ():
                yield from _in(change(short), term, scalars, place, special)
    where = (tuple(sorted(given)), 0)
    (world,) = worlds(given, 1, field=RATIONALS)
    for special, rule in _specials(term, scalars):
        other = {s: replace(m, rule) for s, m in scalars.items()}
        yield from _in(_cut(world, length), replace(term, rule), other, where, special)


FORCED = frozenset({"force", "internal_force", "turn_angle", *ALIKE, *ANGLES, "euler_parameter"})
"""Quantities of a world that do not follow where places and frames alone are changed."""

SOLVED = frozenset(
    {"torque_free", "no_torque_2", "no_torque_3", "viscous_slug", "rotors", "spin_312"}
)
"""Assumptions that a change of places and frames would break."""


def _parts(term: Term, scalars: Mapping[Any, Term]) -> list[Term]:
    """Return every node of a term and of what its symbols stand for, definitions written out."""
    return [n for t in (term, *scalars.values()) for n in nodes(replace(t, _defined))]


def _length(term: Term, scalars: Mapping[Any, Term]) -> int:
    """Return how many orders of motion a value at t = 0 needs."""
    return 2 + max(_depth(t) for t in (term, *scalars.values()))


def _depth(term: Term) -> int:
    """Return how many derivatives are nested in a term."""
    inside = max((_depth(a) for a in replace(term, _defined).args), default=0)
    return inside + (term.head == "der")


def _cut(world: World, length: int) -> World:
    """Return a world whose motion is known to fewer orders; the least values need no more."""

    def short(vector: Vector) -> Vector:
        x, y, z = (Series(s.field, s.coefficients[:length]) for s in vector)
        return (x, y, z)

    return _moved(world, short)


def _still(world: World) -> World:
    """Return a world at rest, as it is at t = 0."""

    def fixed(vector: Vector) -> Vector:
        x, y, z = (series.constant(s.field, s.coefficients[0], len(s.coefficients)) for s in vector)
        return (x, y, z)

    return _moved(world, fixed)


def _moved(world: World, rule: Callable[[Vector], Vector]) -> World:
    frames = {
        name: tuple(rule((r[0], r[1], r[2])) for r in matrix)
        for name, matrix in world.frames.items()
    }
    points = {name: rule(p) for name, p in world.points.items()}
    places = tuple(rule(p) for p in world.places)
    return dataclasses.replace(world, frames=frames, points=points, places=places, memo={})


def _in(
    world: World,
    term: Term,
    scalars: Mapping[Any, Term],
    place: tuple[tuple[str, ...], int],
    special: str,
) -> Iterator[Found]:
    try:
        yield Evaluator(world, scalars).lowest(term), place, special
    except Singular:
        return


def _flat(world: World) -> World:
    """Return a world with all masses moved along b3 into a plane through the centre of mass."""
    if "C" not in world.points:
        return world
    b3 = world.primitive("unit", ("B", "3"))
    centre = world.points["C"]
    places = []
    for p in world.places:
        height = series.dot(series.subtract(p, centre), b3)
        places.append(series.subtract(p, series.scale(height, b3)))
    return dataclasses.replace(world, places=tuple(places), memo={})


_CHANGED: dict[str, Callable[[World], World]] = {"all mass in one plane": _flat, "at rest": _still}
"""Special worlds that are made of general ones."""


def _specials(term: Term, scalars: Mapping[Any, Term]) -> Iterator[tuple[str, Any]]:
    """Yield rules that make free vectors and numbers zero, or vectors lie along the axes."""
    parts = _parts(term, scalars)
    free = {n.data[0] for n in parts if n.head == "atom"} & {"vector", "scalar", "fixed_vector"}
    if not free:
        return
    yield "with zero for what is free", lambda t: _free(t, zero(VECTOR))
    for k in (1, 2, 3):
        yield f"with vectors along b{k}", lambda t, k=k: _free(t, unit("B", k))


def _free(term: Term, vector: Term) -> Term:
    if term.head != "atom":
        return term
    if term.data[0] in {"vector", "fixed_vector"}:
        return vector
    return number(0) if term.data[0] == "scalar" and vector.is_zero else term


# -- proofs --------------------------------------------------------------------------------------


def _proved(term: Term, scalars: Mapping[Any, Term]) -> bool:
    """Return whether the form shows that a term is never negative."""
    plain = replace(_resolved(term, scalars), _defined)
    if not_negative(rules.ordered(plain), {}) or _bounded(term):
        return True
    known = {s: replace(m, _turning) for s, m in scalars.items()}
    return _form(replace(term, _turning), known)


def _positive(term: Term, scalars: Mapping[Any, Term]) -> bool:
    """Return whether the form shows that a term is greater than zero."""
    known = _resolved(term, scalars)
    if known.head == "atom":
        return known.data[0] in {"mass", "total_mass"}
    return term.head == "expr" and bool(term.data[0].is_positive)


def _bounded(term: Term) -> bool:
    """Return whether sines and cosines between -1 and 1 leave nothing below zero."""
    if term.head != "expr":
        return False
    try:
        return bool(_range(term.data[0])[0] >= 0)
    except InputError:
        return False


def _range(expression: Any) -> tuple[Any, Any]:
    """Return bounds of a polynomial in sines and cosines. Raises `InputError` for others."""
    if expression.is_Rational:
        return expression, expression
    if isinstance(expression, sp.sin | sp.cos):
        return sp.Integer(-1), sp.Integer(1)
    if expression.is_Pow and expression.exp.is_Integer and expression.exp > 0:
        low, high = _range(expression.base)
        ends = sorted((low**expression.exp, high**expression.exp))
        return (
            (sp.Integer(0), ends[1]) if expression.exp % 2 == 0 and low < 0 < high else tuple(ends)
        )
    if expression.is_Add:
        lows, highs = zip(*(_range(a) for a in expression.args), strict=True)
        return sp.Add(*lows), sp.Add(*highs)
    if expression.is_Mul:
        low = high = sp.Integer(1)
        for a, b in (_range(a) for a in expression.args):
            products = (low * a, low * b, high * a, high * b)
            low, high = min(products), max(products)
        return low, high
    raise InputError("no bounds are known", got=expression)


def _turning(term: Term) -> Term:
    """Read an angular velocity as any vector."""
    if term.head == "atom" and term.data[0] == "angular_velocity":
        return quantity("vector", "_".join(term.data))
    return term


def _resolved(term: Term, scalars: Mapping[Any, Term]) -> Term:
    """Return a term with what single symbols stand for."""

    def rule(t: Term) -> Term:
        symbol = t.data[0] if t.head == "expr" else None
        return scalars.get(symbol, t)

    return replace(term, rule)


def _defined(term: Term) -> Term:
    meaning = definition(term) if term.head == "atom" else None
    return term if meaning is None else replace(meaning, _defined)


STATIC = frozenset(
    {"vector", "fixed_vector", "scalar", "inertia", "unit", "total_mass", "first_moment"}
)
"""Quantities that have a value in a world of one mass element that does not move."""


def _form(term: Term, scalars: Mapping[Any, Term]) -> bool:
    """Return whether a term, linear in the masses, is a form in places that is never negative."""
    parts = [n for t in (term, *scalars.values()) for n in nodes(t)]
    atoms = {n.data for n in parts if n.head == "atom"}
    about = {n[1] for n in atoms if n[0] == "inertia"}
    frames = {n.data[0] for n in parts if n.head == "column"}
    static = all(n[0] in STATIC for n in atoms) and not any(n.head == "der" for n in parts)
    if not static or len(about) != 1 or len(frames | {"B"}) > 1:
        return False
    try:
        value = Evaluator(_element(), scalars).value(term).coefficients[0]
    except (InputError, Singular, TypeError):
        return False
    polynomial = sp.Poly(sp.expand(value), *_PLACE, _MASS)
    if any(sum(m[:3]) != 2 or m[3] != 1 for m in polynomial.monoms()):
        return False
    matrix = sp.hessian(polynomial.as_expr().subs(_MASS, 1), _PLACE)
    chosen = [c for n in (1, 2, 3) for c in combinations(range(3), n)]
    return all(_even(matrix.extract(list(c), list(c)).det(method="berkowitz")) for c in chosen)


def _even(expression: Any) -> bool:
    """Return whether every term is a positive number times even powers."""
    expanded = sp.expand(expression)
    unknown = sorted(expanded.free_symbols, key=str)
    if not unknown:
        return bool(expanded >= 0)
    return all(
        c > 0 and all(e % 2 == 0 for e in powers)
        for powers, c in sp.Poly(expanded, *unknown).terms()
    )


_PLACE = sp.symbols("r1:4", real=True)
_MASS = sp.Symbol("dm", positive=True)


class _Symbols(Field):
    """Polynomials in symbols, which have no reciprocals."""

    is_rational = False

    def reduce(self, value: Any) -> Any:
        """Return the value itself."""
        return value

    def of(self, numerator: Any, denominator: int = 1) -> Any:
        return sp.Rational(numerator, denominator)

    def inverse(self, value: Any) -> Any:
        """Return the reciprocal of a number; raises `Singular` for all else."""
        if not sp.sympify(value, strict=True).is_Rational or value == 0:
            raise Singular
        return 1 / sp.Rational(value)

    def draw(self, generator: Any) -> Any:
        return sp.Symbol(f"free{generator.randrange(2**64)}", real=True)


def _element() -> World:
    """Return a world of one mass element at any place, with every point at the origin."""
    field = _Symbols(0)

    def fixed(values: Iterable[Any]) -> Vector:
        x, y, z = (series.constant(field, v, LENGTH) for v in values)
        return (x, y, z)

    axes = tuple(fixed(int(i == j) for j in range(3)) for i in range(3))
    origin, place = fixed((0, 0, 0)), fixed(_PLACE)
    points = dict.fromkeys(("O", "C", "OI", "OA", "OB"), origin)
    masses = (series.constant(field, _MASS, LENGTH),)
    frames = {"I": axes, "B": axes}
    return World(field, 0, frames, points, masses, (place,), (origin,), ((origin,),), {})
