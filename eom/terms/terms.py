"""Typed terms of vector mechanics: what a statement about frames, vectors and sums is made of.

A term is a row of `HEADS`, its arguments and its data (frames, points, indices). Vectors and dyadics
are geometric, free of any frame; ``column(v, "B")`` takes components, and every derivative carries
the frame in which it is taken. Scalars may hold SymPy expressions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError, shown
from eom.expressions import as_expression

Expr = Any

SCALAR, VECTOR, DYADIC, COLUMN, MATRIX = "scalar", "vector", "dyadic", "column", "matrix"
TABLE = "table"
"""Rows and columns of scalars in any other number than three."""
INDICES = frozenset({"i", "j", "k", "l", "n", "dm"})
"""Labels that stand for any particle, rotor or element of mass; all others name one thing."""
INERTIAL = "I"


@dataclass(frozen=True)
class Term:
    """One node: head, arguments, data; ``kind`` follows from them. Build it by the functions below."""

    head: str
    args: tuple[Term, ...] = ()
    data: tuple[Any, ...] = ()
    kind: str = field(default=SCALAR, compare=False)

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.head, self.args, self.data))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by the fields alone: another process has other hashes."""
        return (Term, (self.head, self.args, self.data, self.kind))

    @cached_property
    def labels(self) -> frozenset[str]:
        """The free labels: bound indices and names left out."""
        if self.head == "atom":
            return frozenset(self.data[1 + (self.data[0] in NAMED) :])
        inside = frozenset().union(*(a.labels for a in self.args))
        return inside - {self.data[0]} if self.head in {"sum", "integral"} else inside

    @cached_property
    def indices(self) -> tuple[str, ...]:
        """The free labels that are indices, in order."""
        return tuple(sorted(self.labels & INDICES))

    @cached_property
    def is_plain(self) -> bool:
        """Whether no SymPy symbol stands in it."""
        if self.head == "expr":
            return not self.data[0].free_symbols
        return all(a.is_plain for a in self.args)

    def __add__(self, other: Term | Expr) -> Term:
        return add(self, as_term(other))

    def __radd__(self, other: Expr) -> Term:
        return add(as_term(other), self)

    def __sub__(self, other: Term | Expr) -> Term:
        return add(self, -as_term(other))

    def __rsub__(self, other: Expr) -> Term:
        return add(as_term(other), -self)

    def __neg__(self) -> Term:
        return mul(number(-1), self)

    def __mul__(self, other: Term | Expr) -> Term:
        return mul(self, as_term(other))

    def __rmul__(self, other: Expr) -> Term:
        return mul(as_term(other), self)

    def __truediv__(self, other: Expr) -> Term:
        return mul(expr(1 / as_term(other).expression), self)

    def __matmul__(self, other: Term) -> Term:
        return matmul(self, other)

    @property
    def expression(self) -> Expr:
        """The SymPy expression that this is. Raises `InputError` for all else."""
        if self.head != "expr":
            raise InputError("this is no SymPy expression", got=self.head)
        return self.data[0]

    @property
    def is_zero(self) -> bool:
        """Whether this is the zero of its kind."""
        return self.head == "zero" or (self.head == "expr" and self.data[0] == 0)


@dataclass(frozen=True)
class Equation:
    """A statement: ``left relation right``; ``:=`` defines, ``>=`` says not negative.

    Either side may be given as a number or a SymPy expression.
    """

    left: Term
    right: Term
    relation: str = "="

    def __post_init__(self) -> None:
        for side in ("left", "right"):
            if not isinstance(getattr(self, side), Term):
                object.__setattr__(self, side, as_term(getattr(self, side)))


def _product_kind(a: str, b: str) -> str | None:
    """The kind of a dot product."""
    pairs = {
        (VECTOR, VECTOR): SCALAR,
        (DYADIC, VECTOR): VECTOR,
        (VECTOR, DYADIC): VECTOR,
        (DYADIC, DYADIC): DYADIC,
    }
    return pairs.get((a, b))


def _exactly(result: str, *wanted: str) -> Callable[[tuple[str, ...]], str | None]:
    return lambda kinds: result if kinds == wanted else None


def _same(kinds: tuple[str, ...]) -> str | None:
    return kinds[0] if kinds and len(set(kinds)) == 1 else None


def _scaled(kinds: tuple[str, ...]) -> str | None:
    """Any number of scalars and at most one other factor."""
    others = [k for k in kinds if k != SCALAR]
    return (others or [SCALAR])[0] if len(others) <= 1 else None


def _one_of(table: Mapping[str, str]) -> Callable[[tuple[str, ...]], str | None]:
    return lambda kinds: table.get(kinds[0]) if len(kinds) == 1 else None


def _matrix_kind(kinds: tuple[str, ...]) -> str | None:
    if len(kinds) == 2 and kinds[0] == MATRIX and kinds[1] in {MATRIX, COLUMN}:
        return kinds[1]
    return None


HEADS: dict[str, Callable[[tuple[str, ...]], str | None]] = {
    "add": _same,
    "mul": _scaled,
    "dot": lambda kinds: _product_kind(*kinds) if len(kinds) == 2 else None,
    "cross": _exactly(VECTOR, VECTOR, VECTOR),
    "outer": _exactly(DYADIC, VECTOR, VECTOR),
    "der": _same,
    "start": _same,
    "at": _same,
    "since": _same,
    "partial": lambda kinds: kinds[0] if len(kinds) == 2 and kinds[1] == SCALAR else None,
    "sum": _same,
    "integral": _same,
    "column": _one_of({VECTOR: COLUMN, DYADIC: MATRIX}),
    "matmul": _matrix_kind,
    "transpose": _exactly(MATRIX, MATRIX),
    "inverse": _exactly(MATRIX, MATRIX),
    "tilde": _exactly(MATRIX, COLUMN),
    "inner": _exactly(SCALAR, COLUMN, COLUMN),
    "outer_column": _exactly(MATRIX, COLUMN, COLUMN),
    "entries": lambda kinds: (
        {3: COLUMN, 9: MATRIX}.get(len(kinds)) if set(kinds) == {SCALAR} else None
    ),
    "rows": _exactly(MATRIX, COLUMN, COLUMN, COLUMN),
    "table": lambda kinds: TABLE if set(kinds) == {SCALAR} else None,
}
"""Heads with arguments: from the kinds of the arguments to the kind of the term, or None."""


def make(head: str, args: Iterable[Term], data: tuple[Any, ...] = ()) -> Term:
    """Build a node as it stands. Raises `InputError` for arguments of the wrong kinds."""
    args = tuple(args)
    kind = HEADS[head](tuple(a.kind for a in args))
    if kind is None:
        raise InputError(
            f"{head} does not take these arguments", got=", ".join(a.kind for a in args)
        )
    return Term(head, args, data, kind)


def rebuild(term: Term, args: Iterable[Term]) -> Term:
    """Return ``term`` with other arguments, tidied by the head's own constructor."""
    args = tuple(args)
    if not term.args or args == term.args:
        return term
    tidy = _TIDY.get(term.head)
    return tidy(term, args) if tidy else make(term.head, args, term.data)


def replace(term: Term, rule: Callable[[Term], Term]) -> Term:
    """Apply ``rule`` to every node, children first."""
    return rule(rebuild(term, (replace(a, rule) for a in term.args)))


def nodes(term: Term) -> Iterator[Term]:
    """Yield every node, parents first."""
    yield term
    for a in term.args:
        yield from nodes(a)


def zero(kind: str) -> Term:
    """Return the zero of a kind."""
    return number(0) if kind == SCALAR else Term("zero", (), (kind,), kind)


def number(numerator: int, denominator: int = 1) -> Term:
    """Return a rational number."""
    return Term("expr", (), (sp.Rational(numerator, denominator),))


def expr(value: Expr) -> Term:
    """Return a SymPy expression as a scalar."""
    return Term("expr", (), (value,))


def as_term(value: Term | Expr) -> Term:
    """Return a term as it is, a number or SymPy expression as a scalar. Raises `InputError` for others."""
    if isinstance(value, Term):
        return value
    found = as_expression(value)
    if not isinstance(found, sp.Expr):
        raise InputError("neither a term nor an expression", got=shown(value))
    return expr(found)


def atom(name: str, *labels: str, kind: str) -> Term:
    """Return a quantity; `eom.terms.vocabulary` knows the names and their kinds."""
    return Term("atom", (), (name, *labels), kind)


def add(*terms: Term | Expr) -> Term:
    """Return a sum: flat, without zeros, SymPy parts gathered in one."""
    flat = [u for t in map(as_term, terms) for u in (t.args if t.head == "add" else (t,))]
    made = make("add", flat)
    kept = [t for t in flat if not t.is_zero and t.head != "expr"]
    plain = [t.data[0] for t in flat if t.head == "expr"]
    if plain and sp.Add(*plain) != 0:
        kept.append(expr(sp.Add(*plain)))
    if not kept:
        return zero(made.kind)
    return kept[0] if len(kept) == 1 else make("add", kept)


def _place_in_product(factor: Term) -> int:
    """Masses and other quantities first, then products of vectors, last what is no scalar."""
    if factor.kind != SCALAR:
        return 2
    return int(factor.head in {"dot", "inner"})


def mul(*factors: Term | Expr) -> Term:
    """Return a product: flat, SymPy factors gathered in front."""
    flat = [u for f in map(as_term, factors) for u in (f.args if f.head == "mul" else (f,))]
    made = make("mul", flat)
    coefficient = sp.Mul(*(f.data[0] for f in flat if f.head == "expr"))
    rest = [f for f in flat if f.head != "expr"]
    rest.sort(key=_place_in_product)
    if coefficient == 0 or any(f.is_zero for f in rest):
        return zero(made.kind)
    if coefficient != 1 or not rest:
        rest.insert(0, expr(coefficient))
    return rest[0] if len(rest) == 1 else make("mul", rest)


def _strict(head: str) -> Callable[[Term, Term], Term]:
    """A product that is zero when a factor is."""

    def build(a: Term, b: Term) -> Term:
        made = make(head, (a, b))
        return zero(made.kind) if a.is_zero or b.is_zero else made

    return build


def dot(a: Term, b: Term) -> Term:
    """Return the product of vectors and dyadics ``a`` and ``b`` that is written with a point.

    Parameters
    ----------
    a, b : Term
        Vectors or dyadics.

    Returns
    -------
    Term
        Of two vectors a scalar, with a dyadic a vector or a dyadic.

    Raises
    ------
    InputError
        For terms of other kinds.

    Examples
    --------
    >>> dot(atom("unit", "I", "1", kind=VECTOR), zero(VECTOR)).is_zero
    True
    """
    return _dot(a, b)


def cross(a: Term, b: Term) -> Term:
    """Return the right-handed vector product of ``a`` and ``b``. Raises `InputError` for other kinds.

    Parameters
    ----------
    a, b : Term
        Vectors, or a vector and a dyadic.

    Returns
    -------
    Term
        A vector, or a dyadic; zero where a factor is.

    Raises
    ------
    InputError
        For terms of other kinds.

    Examples
    --------
    >>> cross(atom("unit", "I", "1", kind=VECTOR), zero(VECTOR)).is_zero
    True
    """
    return _cross(a, b)


_dot = _strict("dot")
_cross = _strict("cross")
outer = _strict("outer")
matmul = _strict("matmul")
inner = _strict("inner")
outer_column = _strict("outer_column")


def _linear(head: str, term: Term, data: tuple[Any, ...] = ()) -> Term:
    made = make(head, (term,), data)
    return zero(made.kind) if term.is_zero else made


def der(term: Term | Expr, frame: str = INERTIAL, times: int = 1) -> Term:
    """Return the time derivative of ``term``, a term or SymPy expression, ``times`` over (in SI units).

    Parameters
    ----------
    term : Term or expression
        A term or SymPy expression, in SI units.
    frame : str, default "I"
        From which it is seen, the inertial one unless another is given; of scalars, columns and
        matrices it is the plain one.
    times : int, default 1
        So many times over.

    Returns
    -------
    Term
        The ``frame`` derivative, not worked out: rules do that.

    Raises
    ------
    InputError
        For what is no term.

    Examples
    --------
    >>> der(sp.Symbol("q")).head
    'der'
    """
    term = as_term(term)
    for _ in range(times):
        term = _linear("der", term, (frame if term.kind in {VECTOR, DYADIC} else "",))
    return term


def start(term: Term) -> Term:
    """Return the value of ``term`` at the time from which `since` integrates; it does not change."""
    return term if term.head == "expr" and term.data[0].is_number else _linear("start", term)


def at(term: Term, when: str) -> Term:
    """Return the value of ``term`` at an instant of a particular motion; it does not change."""
    return _linear("at", term, (when,))


def since(term: Term) -> Term:
    """Return the integral of ``term`` over time, from the time of `start` until now; of vectors, in I."""
    return _linear("since", term)


def partial(term: Term | Expr, variable: Term | Expr) -> Term:
    """Return the partial derivative of ``term``, a function of coordinates and rates, by one of them.

    Parameters
    ----------
    term : Term or expression
        A scalar that is a function of coordinates and rates, in SI units.
    variable : Term or expression
        One of them, a symbol.

    Returns
    -------
    Term
        The derivative, not worked out: rules do that.

    Raises
    ------
    InputError
        For what is no scalar.

    Examples
    --------
    >>> partial(sp.Symbol("L"), sp.Symbol("q")).head
    'partial'
    """
    return make("partial", (as_term(term), as_term(variable)))


def total(term: Term, index: str = "i", over: str = "particles") -> Term:
    """Return the sum over all particles (or rotors, ``over``) of a ``term`` with the label ``index``.

    Parameters
    ----------
    term : Term
        What is summed up, with the label ``index`` for the one of which it is.
    index : str, default "i"
        The label that is bound by the sum.
    over : str, default "particles"
        What the label runs over: ``particles`` or ``rotors``.

    Returns
    -------
    Term
        The sum, zero where the term is.

    Examples
    --------
    >>> total(atom("mass", "i", kind=SCALAR)).head
    'sum'
    """
    return _linear("sum", term, (index, over))


def integral(term: Term) -> Term:
    """Return the integral over the body of ``term`` dm; elements carry the label ``dm``."""
    return _linear("integral", term, ("dm",))


def column(term: Term, frame: str) -> Term:
    """Return the components of a vector or dyadic in ``frame``."""
    return _linear("column", term, (frame,))


def tilde(term: Term) -> Term:
    """Return the skew matrix of a column, whose product with a column is that of the cross product."""
    return _linear("tilde", term)


def transpose(term: Term) -> Term:
    """Return the transpose of a matrix."""
    return _linear("transpose", term)


def inverse(term: Term) -> Term:
    """Return the inverse of a matrix."""
    return make("inverse", (term,))


def entries(rows: Expr) -> Term:
    """Return a SymPy column or 3 x 3 matrix, or rows of terms, as a term."""
    if isinstance(rows, sp.MatrixBase):
        rows = [[expr(e) for e in row] for row in rows.tolist()]
    return make("entries", (e for row in rows for e in row))


def table(rows: Sequence[Sequence[Term]]) -> Term:
    """Return rows of scalars as a table of any size."""
    return make("table", (e for row in rows for e in row), (len(rows), len(rows[0])))


def _tidy_product(build: Callable[[Term, Term], Term]) -> Callable[..., Term]:
    return lambda _, args: build(*args)


_TIDY: dict[str, Callable[[Term, tuple[Term, ...]], Term]] = {
    "add": lambda _, args: add(*args),
    "mul": lambda _, args: mul(*args),
    "dot": _tidy_product(dot),
    "cross": _tidy_product(cross),
    "outer": _tidy_product(outer),
    "matmul": _tidy_product(matmul),
    "inner": _tidy_product(inner),
    "outer_column": _tidy_product(outer_column),
    **{
        head: lambda term, args: _linear(term.head, args[0], term.data)
        for head in ("der", "start", "since", "sum", "integral", "column", "tilde", "transpose")
    },
}


NAMED = frozenset({"scalar", "coordinate", "function", "vector", "fixed_vector", "dyadic", "angle"})
"""Quantities whose first label is a name of their own, even where it looks like an index."""


def relabel(term: Term, names: Mapping[str, str]) -> Term:
    """Exchange free labels of atoms; a sum whose index would catch a new label takes another one."""
    if term.head == "atom":
        kept = 1 + (term.data[0] in NAMED)
        data = (*term.data[:kept], *(names.get(label, label) for label in term.data[kept:]))
        return Term("atom", (), data, term.kind)
    if term.head not in {"sum", "integral"}:
        return rebuild(term, (relabel(a, names) for a in term.args))
    index, (body,) = term.data[0], term.args
    free = {old: new for old, new in names.items() if old in body.labels - {index}}
    if index in free.values():
        used = {*free.values(), *body.labels, *names}
        index = min(INDICES - used)
        body = relabel(body, {term.data[0]: index})
    return make(term.head, (relabel(body, free),), (index, *term.data[1:]))
