"""Operations on one typed value: skew matrices, transposes, time derivatives, traces, determinants."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from eom.checker import arrays
from eom.checker.dimensions import RATE
from eom.checker.lexicon import Notation
from eom.checker.places import Span
from eom.checker.values import (
    COVECTRIX,
    GEOMETRIC,
    ILL_FORMED,
    ROW,
    UNDECIDED,
    VECTRIX,
    Value,
    basis,
    mixed,
    refuse,
    turner,
)
from eom.terms import (
    COLUMN,
    DYADIC,
    MATRIX,
    SCALAR,
    TABLE,
    VECTOR,
    Term,
    add,
    column,
    der,
    inner,
    matmul,
    tilde,
    transpose,
)
from eom.vocabulary import omega

MOST_ROWS = 5
"""Of determinants, which are written out."""


def skew(notation: Notation, value: Value, span: Span) -> Value:
    """Return the skew matrix of a column, or the dyadic a x 1 of a vector."""
    value = mixed(notation, value)
    if value.shape == COLUMN:
        frames = (value.frames[0], value.frames[0])
        return replace(value, term=tilde(value.term), shape=MATRIX, frames=frames, span=span)
    if value.shape == VECTOR:
        return replace(value, term=turner(value.term), shape=DYADIC, span=span)
    raise refuse(ILL_FORMED, "this has no skew matrix", span, value.words, "a vector")


def transposed(notation: Notation, value: Value, span: Span) -> Value:
    """Return the transpose; a scalar is its own."""
    value = mixed(notation, value)
    if value.shape == SCALAR:
        return replace(value, span=span)
    if value.shape == TABLE:
        return replace(arrays.transposed(value), span=span)
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


def element(value: Value, row: int, place: int) -> Term:
    """Return an element of a matrix."""
    return inner(basis(row), matmul(value.term, basis(place)))


def trace(value: Value, span: Span) -> Value:
    """Return the trace of a matrix."""
    if value.shape != MATRIX:
        raise refuse(ILL_FORMED, "a trace of what is no matrix", span, value.words)
    term = add(*(element(value, k, k) for k in (1, 2, 3)))
    return Value(term, SCALAR, value.dimension, density=value.density, span=span)


def determinant(value: Value, span: Span) -> Value:
    """Return the determinant of a matrix, or of a square table, written out."""
    square = value.shape == MATRIX or (value.shape == TABLE and arrays.is_square(value))
    if not square:
        raise refuse(ILL_FORMED, "a determinant of what is no matrix", span, value.words)
    rows = arrays.cells(value)
    count = len(rows)
    if count > MOST_ROWS:
        raise refuse(UNDECIDED, "a determinant of too many rows", span, f"{count} rows")
    dimension = None if value.dimension is None else value.dimension.power(Fraction(count))
    return Value(
        arrays.determinant(rows), SCALAR, dimension, density=count * value.density, span=span
    )
