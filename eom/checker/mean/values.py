"""Typed values: terms with shape, dimension and frames of components, and what may be done to them.

Shapes are the kinds of `eom.terms.terms`, and some of the checker's own: ``row`` (a column that lies down),
``vectrix`` (unit vectors of a frame in a column) and ``covectrix`` (lying down). A zero fits every
shape. Whatever cannot be done raises `Refusal` with a finding: a type error is ill-formed, an error of
dimensions is wrong.

Tables of other sizes than 3 x 3 and 3 x 1, cell by cell: quaternions, 4 x 4 and 4 x 3 matrices.

A value of shape ``table`` holds scalars in rows and columns. Products with columns, rows and matrices
are carried out; what comes out with three rows or columns is a column, a row or a matrix again.

Operations on one typed value: skew matrices, transposes, time derivatives, traces, determinants.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, permutations
from typing import Any

import sympy as sp

from eom.checker.mean import dimensions
from eom.checker.mean.dimensions import NONE, RATE, Dimension
from eom.checker.mean.lexicon import Notation
from eom.checker.read.spans import NOWHERE, Span
from eom.terms.terms import (
    COLUMN,
    DYADIC,
    MATRIX,
    SCALAR,
    TABLE,
    VECTOR,
    Equation,
    Term,
    add,
    column,
    cross,
    der,
    dot,
    entries,
    expr,
    inner,
    matmul,
    mul,
    nodes,
    number,
    outer,
    outer_column,
    table,
    tilde,
    transpose,
)
from eom.terms.vocabulary import omega, quantity, unit
from eom.worlds.evaluate import half_powers

ROW, VECTRIX, COVECTRIX = "row", "vectrix", "covectrix"
ANY = ("", "")

UNDECIDED, ILL_FORMED, WRONG, AMBIGUOUS = "undecided", "ill-formed", "wrong", "ambiguous"


@dataclass(frozen=True)
class Finding:
    """What is the matter with a place: verdict, what, got, expected, span; what to write in which place."""

    verdict: str
    what: str
    span: Span = NOWHERE
    got: str = ""
    expected: str = ""
    instead: tuple[Span, str] | None = None


class Refusal(Exception):
    """Ends the elaboration of a formula."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(finding.what)
        self.finding = finding


@dataclass(frozen=True)
class Value:
    """A term with shape, dimension (None: any), frames of its rows and columns ("": any), density.

    ``density``: how many factors of it are for each unit of volume; ``scalars``: of what a note has
    defined, the meanings of the symbols of SymPy in it.
    """

    term: Term
    shape: str
    dimension: Dimension | None = None
    frames: tuple[str, str] = ANY
    density: int = 0
    span: Span = NOWHERE
    scalars: Mapping[Any, Term] = field(default_factory=dict, compare=False, repr=False)

    @property
    def is_zero(self) -> bool:
        """Whether this is a zero, which has every shape and dimension."""
        return self.term.is_zero

    @property
    def words(self) -> str:
        """Shape and frame in words."""
        frames = "" if self.frames == ANY else " in " + "/".join(dict.fromkeys(self.frames))
        return self.shape + frames


def refuse(verdict: str, what: str, span: Span, got: str = "", expected: str = "") -> Refusal:
    """Return the refusal with a finding."""
    return Refusal(Finding(verdict, what, span, got, expected))


def unfit(what: str, a: Value, b: Value, sign: str) -> Refusal:
    """Return the refusal of a product of two."""
    return refuse(ILL_FORMED, what, a.span.join(b.span), f"{a.words}{sign}{b.words}")


def scalar(term: Term, dimension: Dimension | None = NONE, span: Span = NOWHERE) -> Value:
    """Return a scalar."""
    return Value(term, SCALAR, dimension, span=span)


def product_like(
    term: Term, shape: str, a: Value, b: Value, frames: tuple[str, str] = ANY
) -> Value:
    """Return the value of a product of two."""
    return Value(
        term,
        shape,
        dimensions.product(a.dimension, b.dimension),
        frames,
        a.density + b.density,
        a.span.join(b.span),
    )


def components(value: Value, frame: str) -> Value:
    """Return the components in a frame, also of what another frame gives; columns of none get it."""
    if value.is_zero:
        return value
    if value.term.head == "column":
        value = replace(value, term=value.term.args[0], shape=value.term.args[0].kind)
    if value.shape in {VECTOR, DYADIC}:
        shape = COLUMN if value.shape == VECTOR else MATRIX
        frames = (frame, frame if shape == MATRIX else "")
        return replace(value, term=column(value.term, frame), shape=shape, frames=frames)
    if value.shape in {COLUMN, MATRIX, ROW}:
        wanted = (frame, "" if value.shape != MATRIX else frame)
        _agree(value, replace(value, frames=wanted))
        return replace(value, frames=wanted)
    raise refuse(ILL_FORMED, "this has no components in a frame", value.span, value.shape)


def mixed(notation: Notation, value: Value) -> Value:
    """Return a vector or dyadic as components where the notation lets them stand for each other."""
    if notation.mixed and value.shape in {VECTOR, DYADIC}:
        return components(value, notation.mixed)
    return value


GEOMETRIC = frozenset({VECTOR, DYADIC})
_UNITS = {MATRIX: "identity_matrix", DYADIC: "identity"}


def alike(notation: Notation, values: Iterable[Value]) -> list[Value]:
    """Return values with vectors as columns if there are columns beside them, 1 as a unit beside tables."""
    values = list(values)
    shapes = {v.shape for v in values if not v.is_zero}
    if shapes & GEOMETRIC and shapes & {COLUMN, MATRIX, ROW}:
        values = [mixed(notation, v) for v in values]
    table = next((v.shape for v in values if v.shape in _UNITS and not v.is_zero), "")
    unit = Value(quantity(_UNITS.get(table, "identity")), table, NONE)
    return [replace(unit, span=v.span) if table and v.term == number(1) else v for v in values]


def _agree(a: Value, b: Value) -> tuple[str, str]:
    """Return the frames that two values share."""
    for x, y in zip(a.frames, b.frames, strict=True):
        if x and y and x != y:
            raise refuse(
                ILL_FORMED, "components in different frames", b.span, b.words, f"as {a.words}"
            )
    rows, columns = ((x or y) for x, y in zip(a.frames, b.frames, strict=True))
    return rows, columns


def same(notation: Notation, a: Value, b: Value) -> tuple[Value, Value]:
    """Return two values that may be added or equated. Raises `Refusal` where they may not."""
    a, b = alike(notation, (a, b))
    if a.is_zero or b.is_zero:
        return _zero_like(a, b), _zero_like(b, a)
    if a.shape != b.shape:
        raise refuse(ILL_FORMED, "these are of different kinds", b.span, b.words, a.words)
    if a.shape == TABLE and size(a) != size(b):
        sizes = ("{} x {}".format(*size(v)) for v in (b, a))
        raise refuse(ILL_FORMED, "tables of different sizes", b.span, *sizes)
    frames = _agree(a, b)
    if a.density != b.density:
        raise refuse(ILL_FORMED, "one of these is for each unit of volume", b.span)
    if a.dimension is not None and b.dimension is not None and a.dimension != b.dimension:
        raise refuse(WRONG, "the dimensions differ", b.span, b.dimension.words, a.dimension.words)
    known = a.dimension if a.dimension is not None else b.dimension
    return replace(a, frames=frames, dimension=known), replace(b, frames=frames, dimension=known)


def _zero_like(a: Value, other: Value) -> Value:
    """Return a zero in the shape of another value; what is no zero stays."""
    if not a.is_zero or other.is_zero:
        return a
    if other.shape == TABLE:
        return replace(other, term=nought(other), span=a.span)
    kind = COLUMN if other.shape == ROW else other.shape
    term = Term("zero", (), (kind,), kind) if kind != SCALAR else number(0)
    return replace(other, term=term, span=a.span)


def total(notation: Notation, values: Iterable[Value]) -> Value:
    """Return the sum of values with the same shape, frames and dimension."""
    values = alike(notation, values)
    kept = [v for v in values if not v.is_zero] or values[:1]
    result = kept[0]
    for value in kept[1:]:
        result, _ = same(notation, *_turned(result, value))
    span = values[0].span.join(values[-1].span)
    return replace(result, term=add(*(v.term for v in kept)), span=span)


def _turned(a: Value, b: Value) -> tuple[Value, Value]:
    """Return two terms; a rotation beside its transpose, as in C + C^T, is between no two frames."""
    if a.shape == b.shape == MATRIX and a.frames == b.frames[::-1] != b.frames:
        return replace(a, frames=ANY), replace(b, frames=ANY)
    return a, b


def negative(value: Value, span: Span) -> Value:
    """Return minus a value."""
    return replace(value, term=mul(number(-1), value.term), span=span.join(value.span))


# -- products ------------------------------------------------------------------------------------


def beside(notation: Notation, a: Value, b: Value) -> Value:
    """Return the product of two factors side by side."""
    if SCALAR in (a.shape, b.shape):
        return _scaled(a, b)
    if (a.shape, b.shape) == (DYADIC, VECTOR) and notation.juxtaposed:
        return product_like(dot(a.term, b.term), VECTOR, a, b)
    if (a.shape, b.shape) == (VECTOR, VECTOR) and notation.dyads:
        return product_like(outer(a.term, b.term), DYADIC, a, b)
    if {a.shape, b.shape} != {VECTOR}:
        a, b = mixed(notation, a), mixed(notation, b)
    if TABLE in (a.shape, b.shape) and {a.shape, b.shape} <= TABLES:
        return _table_product(a, b)
    rule = _BESIDE.get((a.shape, b.shape))
    if rule is None:
        raise unfit("these do not multiply side by side", a, b, " beside ")
    return rule(a, b)


def _scaled(a: Value, b: Value) -> Value:
    rest = b if a.shape == SCALAR else a
    term = mul(a.term, b.term)
    term = nought(rest) if term.is_zero and rest.shape == TABLE else term
    return product_like(term, rest.shape, a, b, rest.frames)


def _table_product(a: Value, b: Value) -> Value:
    found = product(a, b, product_like(a.term, a.shape, a, b))
    if found is None:
        sizes = "{} x {} beside {} x {}".format(*size(a), *size(b))
        raise refuse(ILL_FORMED, "sizes of tables do not fit", a.span.join(b.span), sizes)
    return found


TABLES = frozenset({TABLE, COLUMN, ROW, MATRIX})


def _inner_frames(a: Value, b: Value) -> None:
    """Require that the columns of ``a`` and the rows of ``b`` are of one frame."""
    left = a.frames[1] if a.shape == MATRIX else a.frames[0]
    if left and b.frames[0] and left != b.frames[0]:
        raise refuse(
            ILL_FORMED,
            "components in different frames meet",
            b.span,
            f"{b.words} after {a.words}",
            f"components in {left}",
        )


def _matrix_product(a: Value, b: Value) -> Value:
    _inner_frames(a, b)
    last = b.frames[1] if b.shape == MATRIX else ""
    return product_like(matmul(a.term, b.term), b.shape, a, b, (a.frames[0], last))


def _row_matrix(a: Value, b: Value) -> Value:
    _inner_frames(a, b)
    turned = transpose(b.term)
    return product_like(matmul(turned, a.term), ROW, a, b, (b.frames[1], ""))


def _row_column(a: Value, b: Value) -> Value:
    _inner_frames(a, b)
    return product_like(inner(a.term, b.term), SCALAR, a, b)


def _column_row(a: Value, b: Value) -> Value:
    return product_like(outer_column(a.term, b.term), MATRIX, a, b, (a.frames[0], b.frames[0]))


def _vectrix_column(a: Value, b: Value) -> Value:
    """Return the vector whose components stand in a column."""
    _inner_frames(a, b)
    frame = a.frames[0]
    factors = a.term.args if a.term.head == "mul" else (a.term,)
    if factors[-1] != unit(frame, 1):
        raise refuse(UNDECIDED, "a sum of unit vectors in a column", a.span)
    scale = factors[:-1]
    parts = (mul(*scale, inner(b.term, basis(k)), unit(frame, k)) for k in (1, 2, 3))
    return product_like(add(*parts), VECTOR, a, b)


def basis(k: int) -> Term:
    """Return the column with a one in place ``k`` and zeros else."""
    return entries([[number(int(j == k))] for j in (1, 2, 3)])


Rule = Callable[[Value, Value], Value]

_BESIDE: dict[tuple[str, str], Rule] = {
    (MATRIX, MATRIX): _matrix_product,
    (MATRIX, COLUMN): _matrix_product,
    (ROW, MATRIX): _row_matrix,
    (ROW, COLUMN): _row_column,
    (COLUMN, ROW): _column_row,
    (COVECTRIX, COLUMN): _vectrix_column,
    (COVECTRIX, VECTOR): lambda a, b: _vectrix_column(a, components(b, a.frames[0])),
}
"""Products of components that stand side by side, beyond those with scalars."""


def dotted(notation: Notation, a: Value, b: Value) -> Value:
    """Return the dot product; between scalars, and of a scalar and a vector, it is the plain one."""
    if SCALAR in (a.shape, b.shape):
        return _scaled(a, b)
    a, b = alike(notation, (a, b))
    geometric = {
        (VECTOR, VECTOR): SCALAR,
        (DYADIC, VECTOR): VECTOR,
        (VECTOR, DYADIC): VECTOR,
        (DYADIC, DYADIC): DYADIC,
    }.get((a.shape, b.shape))
    if geometric is not None:
        return product_like(dot(a.term, b.term), geometric, a, b)
    if (a.shape, b.shape) in {(COLUMN, COLUMN), (ROW, ROW)}:
        _agree(a, b)
        return product_like(inner(a.term, b.term), SCALAR, a, b)
    rule = _DOTTED.get((a.shape, b.shape)) or _BESIDE.get((a.shape, b.shape))
    if rule is None:
        raise unfit("these have no dot product", a, b, " . ")
    return rule(a, b)


def _triads(a: Value, b: Value) -> Value:
    """Return the rotation matrix that the dot products of two frames' unit vectors make."""
    to, start = (_whole_triad(v) for v in (a, b))
    return product_like(quantity("rotation", to, start), MATRIX, a, b, (to, start))


def _along_triad(triad: Value, vector: Value, shape: str) -> Value:
    """Return the dot products of a frame's unit vectors with a vector: its components."""
    frame = _whole_triad(triad)
    return product_like(column(vector.term, frame), shape, triad, vector, (frame, ""))


def _whole_triad(triad: Value) -> str:
    frame = triad.frames[0]
    if triad.term != unit(frame, 1):
        raise refuse(UNDECIDED, "a multiple of unit vectors in a column", triad.span)
    return frame


_DOTTED: dict[tuple[str, str], Rule] = {
    (VECTRIX, COVECTRIX): _triads,
    (VECTRIX, VECTOR): lambda a, b: _along_triad(a, b, COLUMN),
    (VECTOR, VECTRIX): lambda a, b: _along_triad(b, a, COLUMN),
    (VECTOR, COVECTRIX): lambda a, b: _along_triad(b, a, ROW),
}
"""Dot products with the unit vectors of a frame in a column or a row."""


def crossed(notation: Notation, a: Value, b: Value) -> Value:
    """Return the cross product; of numbers it is the plain one, as in 2 x 10^3."""
    if _is_number(a) and _is_number(b):
        return _scaled(a, b)
    a, b = alike(notation, (a, b))
    shapes = (a.shape, b.shape)
    if shapes == (VECTOR, VECTOR):
        return product_like(cross(a.term, b.term), VECTOR, a, b)
    if shapes == (COLUMN, COLUMN):
        frames = _agree(a, b)
        return product_like(matmul(tilde(a.term), b.term), COLUMN, a, b, frames)
    if shapes == (VECTOR, DYADIC):
        return product_like(dot(turner(a.term), b.term), DYADIC, a, b)
    if shapes == (DYADIC, VECTOR):
        return product_like(dot(a.term, turner(b.term)), DYADIC, a, b)
    if a.is_zero or b.is_zero:
        return _scaled(a, b)
    raise unfit("these have no cross product", a, b, " x ")


def _is_number(value: Value) -> bool:
    return value.term.head == "expr" and bool(value.term.data[0].is_number)


def turner(term: Term) -> Term:
    """Return the dyadic a x 1."""
    units = (unit("I", k) for k in (1, 2, 3))
    return add(*(outer(cross(term, e), e) for e in units))


def tensored(a: Value, b: Value) -> Value:
    """Return the dyadic or matrix of two vectors or columns."""
    if (a.shape, b.shape) == (VECTOR, VECTOR):
        return product_like(outer(a.term, b.term), DYADIC, a, b)
    if (a.shape, b.shape) == (COLUMN, COLUMN):
        return _column_row(a, b)
    raise unfit("these have no dyadic product", a, b, ", ")


Cells = tuple[tuple[Term, ...], ...]


def cells_of(term: Term) -> Cells:
    """Return the cells of a term of kind ``table``."""
    if term.head == "table":
        rows, columns = term.data
        return tuple(term.args[columns * r : columns * (r + 1)] for r in range(rows))
    inside = [cells_of(a) for a in term.args if a.kind == TABLE]
    if term.head == "add":
        return tuple(
            tuple(add(*parts) for parts in zip(*rows, strict=True))
            for rows in zip(*inside, strict=True)
        )
    if term.head == "der":
        return tuple(tuple(der(c) for c in row) for row in inside[0])
    factors = [a for a in term.args if a.kind != TABLE]
    return tuple(tuple(mul(*factors, c) for c in row) for row in inside[0])


def cells(value: Value) -> Cells:
    """Return the cells of a scalar, column, row, matrix or table."""
    term = value.term
    if value.shape == SCALAR:
        return ((term,),)
    if value.shape == TABLE:
        return cells_of(term)
    if value.shape == MATRIX:
        return tuple(
            tuple(inner(basis(r), matmul(term, basis(c))) for c in (1, 2, 3)) for r in (1, 2, 3)
        )
    line = term.args if term.head == "entries" else tuple(inner(basis(k), term) for k in (1, 2, 3))
    return tuple((c,) for c in line) if value.shape == COLUMN else (line,)


def size(value: Value) -> tuple[int, int]:
    """Return how many rows and columns a value has."""
    found = cells(value)
    return len(found), len(found[0])


def made(rows: Sequence[Sequence[Term]], like: Value) -> Value:
    """Return cells as a value of the shape that their number makes them, in no frame."""
    count = (len(rows), len(rows[0]))
    value = replace(like, frames=("", ""))
    if count == (1, 1):
        return replace(value, term=rows[0][0], shape=SCALAR)
    if count in {(3, 1), (1, 3)}:
        line = [[c] for row in rows for c in row]
        return replace(value, term=entries(line), shape=COLUMN if count == (3, 1) else ROW)
    if count == (3, 3):
        return replace(value, term=entries(rows), shape=MATRIX)
    return replace(value, term=table(rows), shape=TABLE)


def product(a: Value, b: Value, like: Value) -> Value | None:
    """Return a product of two tables, or None where their sizes do not fit; ``like``: its dimension."""
    left, right = cells(a), cells(b)
    if len(left[0]) != len(right):
        return None
    columns = list(zip(*right, strict=True))
    rows = [
        [add(*(mul(x, y) for x, y in zip(row, column, strict=True))) for column in columns]
        for row in left
    ]
    return made(rows, like)


def transposed(value: Value) -> Value:
    """Return rows as columns."""
    return made(list(zip(*cells(value), strict=True)), value)


def square(value: Value) -> Term:
    """Return the sum of the squares of all cells."""
    return add(*(mul(c, c) for row in cells(value) for c in row))


def is_square(value: Value) -> bool:
    """Return whether a value has as many rows as columns, more than one."""
    rows, columns = size(value)
    return rows == columns > 1


def nought(like: Value) -> Term:
    """Return the table of zeros of a value's size."""
    rows, columns = size(like)
    return table([[number(0)] * columns] * rows)


def assembled(blocks: Sequence[Sequence[Value]], like: Value) -> Value | None:
    """Return a table of blocks; a zero among them fills its place. None where sizes do not fit."""
    sizes = [[None if b.is_zero and b.shape == SCALAR else size(b) for b in row] for row in blocks]
    heights = [next((s[0] for s in row if s), 1) for row in sizes]
    widths = [next((s[1] for s in column if s), 1) for column in zip(*sizes, strict=True)]
    rows: list[list[Term]] = []
    for r, row in enumerate(blocks):
        parts = []
        for c, block in enumerate(row):
            wanted = (heights[r], widths[c])
            if sizes[r][c] not in {None, wanted}:
                return None
            parts.append(cells(block) if sizes[r][c] else ((number(0),) * wanted[1],) * wanted[0])
        rows += [[cell for part in parts for cell in part[k]] for k in range(heights[r])]
    return made(rows, like)


def skew(notation: Notation, value: Value, span: Span) -> Value:
    """Return the skew matrix of a column, or the dyadic a x 1 of a vector."""
    value = mixed(notation, value)
    if value.shape == COLUMN:
        frames = (value.frames[0], value.frames[0])
        return replace(value, term=tilde(value.term), shape=MATRIX, frames=frames, span=span)
    if value.shape == VECTOR:
        return replace(value, term=turner(value.term), shape=DYADIC, span=span)
    raise refuse(ILL_FORMED, "this has no skew matrix", span, value.words, "a vector")


def transpose_of(notation: Notation, value: Value, span: Span) -> Value:
    """Return the transpose; a scalar is its own."""
    value = mixed(notation, value)
    if value.shape == SCALAR:
        return replace(value, span=span)
    if value.shape == TABLE:
        return replace(transposed(value), span=span)
    if value.shape == MATRIX:
        frames = (value.frames[1], value.frames[0])
        return replace(value, term=transpose(value.term), frames=frames, span=span)
    turned = {COLUMN: ROW, ROW: COLUMN, VECTRIX: COVECTRIX, COVECTRIX: VECTRIX}.get(value.shape)
    if turned is None:
        verdict = UNDECIDED if value.shape == DYADIC else ILL_FORMED
        raise refuse(verdict, "this has no transpose here", span, value.words)
    return replace(value, shape=turned, span=span)


def rate(value: Value, frame: str, times: int, span: Span) -> Value:
    """Return the time derivative; ``frame``: that in which a vector is differentiated.

    Columns are differentiated number by number, unless the frame is another than theirs.
    """
    dimension = dimensions.product(value.dimension, RATE.power(times))
    if value.shape in {VECTRIX, COVECTRIX}:
        raise refuse(UNDECIDED, "derivatives of unit vectors in a column", span)
    term = value.term
    own = value.frames[0]
    if frame and own and frame != own and value.shape in {COLUMN, ROW}:
        for _ in range(times):
            term = add(der(term, ""), matmul(tilde(column(omega(own, frame), own)), term))
    elif frame and own and frame != own:
        raise refuse(UNDECIDED, "the derivative of a matrix in another frame", span)
    else:
        term = der(term, frame, times)
    return replace(value, term=term, dimension=dimension, span=span)


def overdot(notation: Notation, value: Value, times: int, span: Span) -> Value:
    """Return what overdots say: of columns and matrices number by number, of vectors in one frame."""
    return rate(value, notation.dot if value.shape in GEOMETRIC else "", times, span)


MAX_SQUARE = 6
"""Rows of the largest matrix whose determinant is written out."""


def trace(value: Value, span: Span) -> Value:
    """Return the trace of a square matrix."""
    rows = _square(value, "trace", span)
    term = add(*(row[k] for k, row in enumerate(rows)))
    return Value(term, SCALAR, value.dimension, density=value.density, span=span)


def determinant(value: Value, span: Span) -> Value:
    """Return the determinant of a square matrix, written out by Leibniz' formula; of a scalar, itself."""
    if value.shape == SCALAR:
        return value
    rows = _square(value, "determinant", span)
    size = len(rows)
    if size > MAX_SQUARE:
        raise refuse(UNDECIDED, "a determinant that is too large to be written out", span)
    parts = (
        mul(number(sign), *(row[c] for row, c in zip(rows, p, strict=True)))
        for p, sign in _permutations(size)
    )
    dimension = dimensions.power(value.dimension, size)
    return Value(add(*parts), SCALAR, dimension, density=size * value.density, span=span)


def inverse_of(rows: Sequence[Sequence[Any]]) -> list[list[Any]]:
    """Return the inverse of rows of SymPy expressions by cofactors, as it is written out."""
    places = range(len(rows))

    def minor(r: int, c: int) -> Any:
        left = [[e for j, e in enumerate(row) if j != c] for i, row in enumerate(rows) if i != r]
        return (-1) ** (r + c) * _leibniz(left)

    whole = sp.Add(*(rows[0][c] * minor(0, c) for c in places))
    return [[minor(r, c) / whole for r in places] for c in places]


def _leibniz(rows: Sequence[Sequence[Any]]) -> Any:
    parts = _permutations(len(rows))
    return sp.Add(*(s * sp.Mul(*(r[c] for r, c in zip(rows, p, strict=True))) for p, s in parts))


def _square(value: Value, what: str, span: Span) -> Cells:
    """Return the cells of a square matrix. Raises `Refusal` for anything else."""
    rows = cells(value) if value.shape in {MATRIX, TABLE} else ()
    if not rows or len(rows) != len(rows[0]):
        raise refuse(ILL_FORMED, f"a {what} of what is no square matrix", span, value.words)
    return rows


def _permutations(size: int) -> Iterator[tuple[tuple[int, ...], int]]:
    """Yield the permutations of the first numbers with their signs."""
    for p in permutations(range(size)):
        swaps = sum(a > b for a, b in combinations(p, 2))
        yield p, -1 if swaps % 2 else 1


def atoms_in(term: Term, scalars: Mapping[Any, Term]) -> frozenset[Term]:
    """Return the quantities of a term, and of what its symbols stand for."""
    found: set[Term] = set()
    for node in nodes(term):
        if node.head == "atom":
            found.add(node)
        elif node.head == "expr":
            inside = (scalars.get(s) for s in node.data[0].free_symbols)
            found.update(a for t in inside if t is not None for a in atoms_in(t, scalars))
    return frozenset(found)


def squared(equation: Equation) -> Equation:
    """Return the equation of the squares if both sides are numbers or products of roots, else itself.

    What is squared is not negative, so that neither equation says more than the other.
    """
    sides = (equation.left, equation.right)
    if any(s.kind != SCALAR or s.head not in {"expr", "zero"} for s in sides):
        return equation
    found = [_square_of(_expression(s)) for s in sides]
    if None in found or not any(True for s in sides for _ in half_powers(_expression(s))):
        return equation
    return Equation(expr(found[0]), expr(found[1]), equation.relation)


def _expression(term: Term) -> Any:
    return term.data[0] if term.head == "expr" else sp.Integer(0)


def _square_of(expression: Any) -> Any:
    """Return the square of a product of numbers that are not negative and roots; None for others."""
    result = sp.Integer(1)
    for factor in sp.Mul.make_args(expression):
        if factor.is_Rational and factor >= 0:
            result *= factor**2
        elif factor.is_Pow and factor.exp.is_Rational and factor.exp.q == 2:
            result *= factor.base ** (2 * factor.exp)
        elif isinstance(factor, sp.Abs):
            result *= factor.args[0] ** 2
        else:
            return None
    return result
