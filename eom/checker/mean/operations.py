"""Operations on one typed value: skew matrices, transposes, time derivatives, traces, determinants."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import combinations, permutations

from eom.checker.mean.dimensions import RATE
from eom.checker.mean.lexicon import Notation
from eom.checker.mean.values import (
    COVECTRIX,
    GEOMETRIC,
    ILL_FORMED,
    ROW,
    UNDECIDED,
    VECTRIX,
    Cells,
    Value,
    cells,
    mixed,
    refuse,
    transposed,
    turner,
)
from eom.checker.read.places import Span
from eom.terms.terms import (
    COLUMN,
    DYADIC,
    MATRIX,
    SCALAR,
    TABLE,
    VECTOR,
    add,
    column,
    der,
    matmul,
    mul,
    number,
    tilde,
    transpose,
)
from eom.terms.vocabulary import omega


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
    dimension = None if value.dimension is None else value.dimension.times(RATE.power(times))
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
    """Return the determinant of a square matrix, written out by Leibniz' formula."""
    rows = _square(value, "determinant", span)
    size = len(rows)
    if size > MAX_SQUARE:
        raise refuse(UNDECIDED, "a determinant that is too large to be written out", span)
    parts = (
        mul(number(sign), *(row[c] for row, c in zip(rows, p, strict=True)))
        for p, sign in _permutations(size)
    )
    dimension = None if value.dimension is None else value.dimension.power(Fraction(size))
    return Value(add(*parts), SCALAR, dimension, density=size * value.density, span=span)


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
