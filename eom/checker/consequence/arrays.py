"""Terms by components: a vector is a column of three expressions in letters, a matrix rows of such.

All components are in one frame, in which the note differentiates: what it differentiates in another one
is a letter of its own where it is a letter, and nothing where it is more.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import Any

import sympy as sp

from eom.checker.mean.values import inverse_of
from eom.errors import InputError
from eom.terms.terms import COLUMN, DYADIC, MATRIX, SCALAR, TABLE, VECTOR, Term
from eom.terms.vocabulary import described

Expr = Any
Array = tuple[tuple[Expr, ...], ...]
AXES = (0, 1, 2)


def scalar(e: Expr) -> Array:
    """Return an expression as an array of one."""
    return ((e,),)


def column(parts: Any) -> Array:
    """Return expressions one below the other."""
    return tuple((p,) for p in parts)


def size(a: Array) -> tuple[int, int]:
    """Return the numbers of rows and columns."""
    return len(a), len(a[0])


def turned(a: Array) -> Array:
    """Return rows as columns."""
    return tuple(zip(*a, strict=True))


def cells(a: Array) -> tuple[Expr, ...]:
    """Return all expressions, row by row."""
    return tuple(chain.from_iterable(a))


def each(rule: Callable[..., Expr], *arrays: Array) -> Array:
    """Return what a rule makes of the expressions in each place. Raises `InputError` for other sizes."""
    if len({size(a) for a in arrays}) != 1:
        raise InputError("arrays of different sizes", got=[size(a) for a in arrays])
    return tuple(tuple(map(rule, *rows)) for rows in zip(*arrays, strict=True))


def times(a: Array, b: Array) -> Array:
    """Return the product of two matrices. Raises `InputError` where they do not fit."""
    if size(a)[1] != size(b)[0]:
        raise InputError("arrays that do not fit", got=[size(a), size(b)])
    down = turned(b)
    return tuple(
        tuple(sp.Add(*(x * y for x, y in zip(row, c, strict=True))) for c in down) for row in a
    )


def scaled(*factors: Array) -> Array:
    """Return a product of scalars with at most one array of any size."""
    whole = sp.Mul(*(f[0][0] for f in factors if size(f) == (1, 1)))
    others = [f for f in factors if size(f) != (1, 1)]
    if len(others) > 1:
        raise InputError("a product of several arrays", got=len(others))
    return each(lambda c: whole * c, others[0]) if others else scalar(whole)


def added(*terms: Array) -> Array:
    """Return a sum."""
    return each(sp.Add, *terms)


def crossed(a: Array, b: Array) -> Array:
    """Return the cross product of two columns, right-handed."""
    return times(skew(a), b)


def skew(a: Array) -> Array:
    """Return the matrix of the cross product with a column of three."""
    if size(a) != (3, 1):
        raise InputError("this has no skew matrix", got=size(a))
    ((x,), (y,), (z,)) = a
    return ((sp.S.Zero, -z, y), (z, sp.S.Zero, -x), (-y, x, sp.S.Zero))


def dotted(a: Array, b: Array) -> Array:
    """Return the product of columns, and of matrices with them, that is written with a point."""
    if size(a)[1] != 1:
        return times(a, b)
    found = times(turned(a), b)
    return turned(found) if size(b)[1] != 1 else found


def stacked(*rows: Array) -> Array:
    """Return columns lying one above the other as rows."""
    return tuple(cells(r) for r in rows)


NOUGHT = {VECTOR: (3, 1), COLUMN: (3, 1), DYADIC: (3, 3), MATRIX: (3, 3)}
"""Sizes of the zero of a kind."""
UNIT: Array = tuple(tuple(sp.Integer(r == c) for c in AXES) for r in AXES)

RULES: Mapping[str, Callable[..., Array]] = {
    "add": added,
    "mul": scaled,
    "dot": dotted,
    "inner": dotted,
    "cross": crossed,
    "outer": lambda a, b: times(a, turned(b)),
    "outer_column": lambda a, b: times(a, turned(b)),
    "matmul": times,
    "transpose": turned,
    "tilde": skew,
    "rows": stacked,
    "inverse": lambda a: tuple(map(tuple, inverse_of(a))),
}
"""One rule a head, from the arrays of its arguments."""


@dataclass(frozen=True)
class Components:
    """How terms become arrays: what scalars and letters are, rates, the frames of components and of dots.

    ``expression``: of a scalar; ``letter``: of an atom that is no scalar, with the frame of a derivative
    other than that of dots behind it, None for what is no letter; ``turn``: the angular velocity of the
    axes of the components, where these turn.
    """

    expression: Callable[[Term], Expr]
    letter: Callable[[Term, str], Array | None]
    rate: Callable[[Expr], Expr]
    partial: Callable[[Expr, Expr], Expr]
    frame: str
    dot: str
    turn: Array | None = None

    def of(self, term: Term) -> Array:
        """Return a term by components. Raises `InputError` for what is nothing in letters."""
        if term.head == "expr" or (term.head == "atom" and term.kind == "scalar"):
            return scalar(self.expression(term))
        if term.head == "zero":
            rows, columns = NOUGHT[term.kind]
            return ((sp.S.Zero,) * columns,) * rows
        if term.head == "der":
            return self._rate(term)
        if term.head in {"entries", "table"}:
            return self._listed(term)
        if term.head == "atom":
            return self._atom(term, "")
        inside = [self.of(a) for a in term.args]
        if term.head == "partial":
            variable = inside[1][0][0]
            return each(lambda f: self.partial(f, variable), inside[0])
        if term.head == "column" and term.data == (self.frame,):
            return inside[0]
        if term.head not in RULES or term.data:
            raise InputError("this is no relation between letters", got=described(term))
        return RULES[term.head](*inside)

    def _listed(self, term: Term) -> Array:
        inside = [self.of(a)[0][0] for a in term.args]
        count = term.data[1] if term.data else 3 if len(inside) == len(UNIT) ** 2 else 1
        return tuple(tuple(inside[k : k + count]) for k in range(0, len(inside), count))

    def _rate(self, term: Term) -> Array:
        inside, (frame,) = term.args[0], term.data or ("",)
        if frame in {"", self.dot}:
            plain = each(self.rate, self.of(inside))
            return plain if self.turn is None else self._turned(inside, plain, self.turn)
        if inside.head == "atom":
            return self._atom(inside, frame)
        raise InputError("a derivative in another frame", got=frame)

    def _turned(self, inside: Term, plain: Array, turn: Array) -> Array:
        """Return a derivative with what the turning of the axes adds: of vectors, and of dyadics."""
        if inside.kind in {SCALAR, TABLE} or inside.head == "entries":
            return plain
        if inside.kind == VECTOR:
            return added(plain, crossed(turn, self.of(inside)))
        if inside.kind != DYADIC:
            raise InputError("a derivative of components in axes that turn")
        left, right = times(skew(turn), self.of(inside)), times(self.of(inside), skew(turn))
        return added(plain, left, each(lambda c: -c, right))

    def _atom(self, term: Term, frame: str) -> Array:
        found = self.letter(term, frame)
        if found is None:
            raise InputError("this is no letter", got=described(term))
        return found
