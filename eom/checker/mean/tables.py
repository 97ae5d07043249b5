"""Columns and matrices that are no vectors: of a system, any ones, quaternions, spatial vectors.

A system has those of its coordinates (mass matrix, Christoffel's symbols, slopes of energies and places).

What they mean is for the notation to say: where the scalar stands and in which order quaternions are
multiplied, which half of a spatial vector is the angular one. Where it says nothing, there are none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from eom.checker.mean import values
from eom.checker.mean.dimensions import LENGTH, NONE, TIME, Dimension, dimension
from eom.checker.mean.lexicon import (
    AXES,
    FREE,
    MATRICES,
    Found,
    Lexicon,
    Meaning,
    Notation,
)
from eom.checker.mean.values import (
    ILL_FORMED,
    UNDECIDED,
    Value,
    basis,
    cells,
    made,
    mixed,
    product_like,
    refuse,
    size,
    unfit,
)
from eom.checker.read.spans import NOWHERE, Span
from eom.checker.read.symbol_shape import Look
from eom.checker.read.syntax import (
    Marks,
    Node,
    Product,
    Scripts,
)
from eom.rotations import quaternion_product
from eom.terms.terms import (
    COLUMN,
    SCALAR,
    TABLE,
    Term,
    add,
    atom,
    der,
    entries,
    inner,
    matmul,
    mul,
    number,
    partial,
    tilde,
)
from eom.terms.vocabulary import quantity

if TYPE_CHECKING:
    from eom.checker.mean.model import Model

QUATERNION = (4, 1)
"""Rows and columns of quaternions."""


def is_quaternion(notation: Notation, value: Value) -> bool:
    """Return whether a value is a quaternion, where the notation says how these are multiplied."""
    return bool(notation.quaternions) and value.shape == TABLE and size(value) == QUATERNION


def _scalar_first(notation: Notation, value: Value) -> list[Term]:
    """Return the parts of a quaternion, of a column as of one without a scalar. Raises `Refusal`."""
    value = mixed(notation, value)
    if value.shape == COLUMN:
        return [number(0), *(c for (c,) in cells(value))]
    if value.shape == SCALAR:
        return [value.term, *[number(0)] * 3]
    if not is_quaternion(notation, value):
        raise refuse(ILL_FORMED, "this is no quaternion", value.span, value.words)
    parts = [c for (c,) in cells(value)]
    return parts if notation.quaternions.endswith("first") else [parts[3], *parts[:3]]


def _as_quaternion(notation: Notation, parts: Sequence[Term], like: Value) -> Value:
    """Return parts, the scalar first, as the notation places it."""
    w, *v = parts
    rows = [w, *v] if notation.quaternions.endswith("first") else [*v, w]
    return made([[x] for x in rows], like)


def quaternion_times(notation: Notation, a: Value, b: Value) -> Value:
    """Return the product of two quaternions, or of one and a column, as the notation says."""
    first, second = (a, b) if notation.quaternions.startswith("hamilton") else (b, a)
    p, q = (_scalar_first(notation, v) for v in (first, second))
    return _as_quaternion(notation, quaternion_product(p, q), product_like(a.term, a.shape, a, b))


def conjugate(notation: Notation, value: Value, span: Span) -> Value:
    """Return the conjugate of a quaternion."""
    w, *v = _scalar_first(notation, value)
    return replace(_as_quaternion(notation, [w, *(-x for x in v)], value), span=span)


def quaternion_matrix(notation: Notation, value: Value, what: str) -> Value:
    """Return the matrix by which a quaternion or a column multiplies from the left or the right.

    ``what``: "quaternion_left", "quaternion_right", and those of the rates, which rest on no convention:
    "omega_matrix", Hamilton's from the right, "xi_matrix", that from the left without the scalar's column.
    """
    plain = what in {"omega_matrix", "xi_matrix"}
    place = notation.quaternions.split(" ")[-1]
    own = replace(notation, quaternions=f"hamilton {place}") if plain else notation
    left = what in {"quaternion_left", "xi_matrix"}

    def times(other: Value) -> Value:
        return quaternion_times(own, *((value, other) if left else (other, value)))

    whole = columns_of(value, times, 4)
    if what != "xi_matrix":
        return whole
    kept = slice(1, None) if place == "first" else slice(3)
    return made([row[kept] for row in cells(whole)], value)


# -- spatial vectors ----------------------------------------------------------------------------

SPATIAL = (6, 1)
"""Rows and columns of spatial vectors."""


def is_spatial(notation: Notation, value: Value) -> bool:
    """Return whether a value is a spatial vector, where the notation says which half is angular."""
    return bool(notation.spatial) and value.shape == TABLE and size(value) == SPATIAL


def spatial_cross(notation: Notation, a: Value, b: Value, *, dual: bool = False) -> Value:
    """Return v x m of two spatial motions, or v x* f of a motion and a force (``dual``).

    With w and u the halves of v, w the angular one: (w x m_a, w x m_l + u x m_a), and
    (w x n + u x f, w x f). Source: Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 2.
    """
    if not (is_spatial(notation, a) and is_spatial(notation, b)):
        raise unfit("these have no cross product of spatial vectors", a, b, " x ")
    (w, u), (top, low) = (_halves(notation, v) for v in (a, b))
    first, second = matmul(tilde(w), top), matmul(tilde(w), low)
    across = matmul(tilde(u), low if dual else top)
    halves = [add(first, across), second] if dual else [first, add(second, across)]
    ordered = halves if notation.spatial == "angular first" else halves[::-1]
    rows = [[inner(basis(k), h)] for h in ordered for k in (1, 2, 3)]
    return made(rows, product_like(a.term, a.shape, a, b))


def _halves(notation: Notation, value: Value) -> list[Term]:
    """Return the angular and the linear half of a spatial vector; of a force its moment, and itself."""
    parts = [c for (c,) in cells(value)]
    halves = [entries([[c] for c in parts[k : k + 3]]) for k in (0, 3)]
    return halves if notation.spatial == "angular first" else halves[::-1]


def columns_of(value: Value, rule: Callable[[Value], Value], count: int) -> Value:
    """Return the matrix of a linear function by what it makes of the unit columns."""
    units = ([[number(int(r == c))] for r in range(count)] for c in range(count))
    found = [cells(rule(made(one, replace(value, dimension=NONE)))) for one in units]
    return made([[column[r][0] for column in found] for r in range(count)], value)


# -- operations, also on all else -----------------------------------------------------------------


def same(notation: Notation, a: Value, b: Value) -> tuple[Value, Value]:
    """Return two values that may be equated; a column beside a quaternion is one. Raises `Refusal`."""
    unlike = a.shape != b.shape and not (a.is_zero or b.is_zero)
    if unlike and (is_quaternion(notation, a) or is_quaternion(notation, b)):
        a, b = (_as_quaternion(notation, _scalar_first(notation, v), v) for v in (a, b))
    return values.same(notation, a, b)


def tensored(notation: Notation, a: Value, b: Value) -> Value:
    """Return the product of quaternions, of all else the dyadic or the matrix."""
    if is_quaternion(notation, a) or is_quaternion(notation, b):
        return quaternion_times(notation, a, b)
    return values.tensored(a, b)


def crossed(notation: Notation, a: Value, b: Value) -> Value:
    """Return the cross product."""
    if is_spatial(notation, a) and is_spatial(notation, b):
        return spatial_cross(notation, a, b)
    return values.crossed(notation, a, b)


def skew(notation: Notation, value: Value, span: Span) -> Value:
    """Return the matrix of a cross product: of a spatial vector that of motions."""
    if is_spatial(notation, value):
        return replace(columns_of(value, lambda m: spatial_cross(notation, value, m), 6), span=span)
    return values.skew(notation, value, span)


DUAL = "cross*"


def unstarred(node: Product) -> Product:
    """Return a cross product with a star, which is read with what follows, as one of motion and force."""
    first, second = (node.factors[0], node.factors[-1])
    joined = isinstance(second, Product) and not second.operator
    lead = second.factors[0] if isinstance(second, Product) and joined else second
    if node.operator != "cross" or len(node.factors) != 2 or not isinstance(lead, Scripts):
        return node
    if not isinstance(lead.presup, Marks) or lead.presup.names != ("ast",):
        return node
    bare: Node = replace(lead, presup=None)
    bare = lead.base if lead.sub is lead.sup is lead.presub is None else bare
    if isinstance(second, Product) and joined:
        bare = replace(second, factors=(bare, *second.factors[1:]))
    return replace(node, factors=(first, bare), operator=DUAL)


# -- matrices of a system, and any ones ----------------------------------------------------------

COUNTS = ("1", "2", "3")


def sized(lexicon: Lexicon, meaning: Meaning) -> tuple[int, int]:
    """Return how many rows and columns a matrix of the lexicon has; none of no matrix."""
    if meaning.quantity in FREE:
        count = FREE[meaning.quantity][0]
        rows, columns = (*map(int, meaning.labels[1:count]), 1, 1)[:2]
        return rows, columns
    if meaning.quantity not in MATRICES or lexicon.system is None:
        return 0, 0
    n, axes = len(lexicon.system.free_coordinates), len(meaning.component) or 3
    column = meaning.quantity.endswith("_column") or meaning.quantity == "coordinates"
    by_place = {"place": (axes, 1), "jacobian": (axes, n)}
    return by_place.get(meaning.quantity, (n, 1 if column else n))


def cell(lexicon: Lexicon, look: Look) -> tuple[Found, tuple[int, int]] | None:
    """Return the matrix whose entry has numbers below its letter, with row and column from 0."""
    for count in (1, 2):
        numbers = [int(w) for w in look.sub[-count:] if w.isdecimal() and len(w) == 1]
        found = (
            lexicon.find(replace(look, sub=look.sub[:-count])) if len(numbers) == count else None
        )
        rows, columns = sized(lexicon, found.meaning) if found is not None else (0, 0)
        row, column = (*numbers, 1)[:2] if numbers else (0, 0)
        if found and 0 < row <= rows and 0 < column <= columns and (columns == 1) == (count == 1):
            return found, (row - 1, column - 1)
    return None


def system_rows(lexicon: Lexicon, meaning: Meaning, span: Span) -> list[list[Term]]:
    """Return the scalars of a matrix of the note's system. Raises `Refusal` where there is no such."""
    model = lexicon.system
    if model is None:
        raise refuse(UNDECIDED, "a matrix of a system, and no system is known here", span)
    q = [_of_system(model, n, span) for n in model.free_coordinates]
    kind = meaning.quantity
    if kind == "coordinates":
        return [[x] for x in q]
    if kind == "force_column":
        return [[_of_system(model, f"Q_{x.data[1]}", span)] for x in q]
    if kind == "gravity_column":
        stored = _energy(model, ("potential_energy", "V"), span)
        return [[partial(stored, x)] for x in q]
    if kind in {"place", "jacobian"}:
        axes = [AXES[c] for c in meaning.component] or COUNTS
        places = [_of_system(model, f"{meaning.labels[0]}_{'xyz'[int(k) - 1]}", span) for k in axes]
        return [[p] if kind == "place" else [partial(p, x) for x in q] for p in places]
    moved = _energy(model, ("kinetic_energy", "T"), span)
    speeds = [der(x) for x in q]
    mass = [[partial(partial(moved, a), b) for b in speeds] for a in speeds]
    return mass if kind == "mass_matrix" else _coriolis(mass, q, speeds)


def _coriolis(mass: list[list[Term]], q: list[Term], speeds: list[Term]) -> list[list[Term]]:
    """Return C(q, q') by Christoffel's symbols of the first kind; its product with q' has no other."""

    def symbol(i: int, j: int, k: int) -> Term:
        turns = ((i, j, k, 1), (i, k, j, 1), (j, k, i, -1))
        return add(*(mul(number(s, 2), partial(mass[a][b], q[c])) for a, b, c, s in turns))

    places = range(len(q))
    return [
        [add(*(mul(symbol(i, j, k), speeds[k]) for k in places)) for j in places] for i in places
    ]


def _of_system(model: Model, name: str, span: Span) -> Term:
    if name not in model.quantities:
        raise refuse(UNDECIDED, "no quantity of the system", span, name)
    return atom("system", name, kind=SCALAR)


def _energy(model: Model, names: Iterable[str], span: Span) -> Term:
    known = [n for n in names if n in model.quantities]
    return _of_system(model, (*known, "energy")[0], span)


def measure_of(lexicon: Lexicon, meaning: Meaning) -> Dimension | None:
    """Return the dimension of a matrix of the system, None where its entries have several."""
    model, kind = lexicon.system, meaning.quantity
    assert model is not None
    units = [dimension(model.quantities[n].unit) for n in model.free_coordinates]
    if len(set(units)) > 1 and kind != "place":
        return None
    per = units[0].power(-1)
    energy = dimension("J")
    return {
        "coordinates": units[0],
        "place": LENGTH,
        "jacobian": LENGTH.times(per),
        "mass_matrix": energy.times(per).times(per).times(TIME.power(2)),
        "coriolis_matrix": energy.times(per).times(per).times(TIME),
    }.get(kind, energy.times(per))


def any_rows(lexicon: Lexicon, meaning: Meaning, span: Span) -> list[list[Term]]:
    """Return the scalars of a matrix that is any: constant, changing with time, or functions."""
    rows, columns = sized(lexicon, meaning)
    traits = set(meaning.labels[FREE[meaning.quantity][0] :])
    name, of = meaning.labels[0], tuple(_variables(lexicon, meaning))
    if traits - {"constant"} and rows != columns:
        raise refuse(UNDECIDED, "a matrix with other rows than columns", span, " ".join(traits))
    moving = "free_angle" if meaning.unit in {"rad", "deg"} else "coordinate"

    def entry(r: int, c: int) -> Term:
        if "identity" in traits:
            return number(int(r == c))
        if (r != c and "diagonal" in traits) or (r == c and "skew" in traits):
            return number(0)
        if r > c and traits & {"symmetric", "skew"}:
            return entry(c, r) if "symmetric" in traits else -entry(c, r)
        numbers = "" if rows == columns == 1 else f"_{r}" if columns == 1 else f"_{r}{c}"
        label = f"{name}{numbers}"
        if of:
            return atom("function", label, *of, kind=SCALAR)
        return quantity("scalar" if "constant" in traits else moving, label)

    return [[entry(r, c) for c in range(1, columns + 1)] for r in range(1, rows + 1)]


def _variables(lexicon: Lexicon, meaning: Meaning) -> Iterator[str]:
    """Yield the coordinates of which a matrix is a function: kind and name of each."""
    known = {
        m.labels[0]: m for layer in lexicon.layers for m in (x.meaning for x in layer) if m.labels
    }
    for name in meaning.of:
        other = known.get(name)
        column = other is not None and other.quantity in FREE
        rows = [] if other is None or other.of or not column else any_rows(lexicon, other, NOWHERE)
        yield from (f"{t.data[0]} {t.data[1]}" for row in rows for t in row if t.head == "atom")
        if not rows:
            yield f"{other.quantity if other and other.quantity in _MOVING else 'coordinate'} {name}"


_MOVING = frozenset({"coordinate", "free_angle"})


QUATERNION_MATRICES = frozenset(
    {"quaternion_left", "quaternion_right", "omega_matrix", "xi_matrix"}
)
"""Matrices of a quaternion or a column, see `eom.checker.mean.tables.quaternion_matrix`."""


SPATIAL_MATRICES = frozenset({"spatial_cross", "spatial_cross_dual"})


def of_columns(notation: Notation, what: str, value: Value, span: Span) -> Value:
    """Return a matrix of a column, a quaternion or a spatial vector, by what the notation says of these."""
    if what == "skew":
        return skew(notation, value, span)
    if what in SPATIAL_MATRICES:
        if not is_spatial(notation, value):
            expected = "six numbers, and spatial in [notation], such as angular first"
            raise refuse(UNDECIDED, "no spatial vector", span, value.words, expected)
        dual = what == "spatial_cross_dual"
        return columns_of(value, lambda m: spatial_cross(notation, value, m, dual=dual), 6)
    if not notation.quaternions:
        expected = "quaternions in [notation], such as hamilton first"
        raise refuse(UNDECIDED, "what a product of quaternions is", span, expected=expected)
    return replace(quaternion_matrix(notation, value, what), span=span)
