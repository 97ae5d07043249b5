"""Tables of other sizes than 3 x 3 and 3 x 1, cell by cell: quaternions, 4 x 4 and 4 x 3 matrices.

A value of shape ``table`` holds scalars in rows and columns. Products with columns, rows and matrices
are carried out; what comes out with three rows or columns is a column, a row or a matrix again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from eom.checker.mean.values import ROW
from eom.terms.terms import (
    COLUMN,
    MATRIX,
    SCALAR,
    TABLE,
    Term,
    add,
    der,
    entries,
    inner,
    matmul,
    mul,
    number,
    table,
)

if TYPE_CHECKING:
    from eom.checker.mean.values import Value

Cells = tuple[tuple[Term, ...], ...]


def _basis(k: int) -> Term:
    return entries([[number(int(j == k))] for j in range(3)])


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
            tuple(inner(_basis(r), matmul(term, _basis(c))) for c in range(3)) for r in range(3)
        )
    line = term.args if term.head == "entries" else tuple(inner(_basis(k), term) for k in range(3))
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
    """Tell whether a value has as many rows as columns, more than one."""
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
