"""From a term to boxes: precedence, brackets, signs and fractions, the same in every notation.

What a quantity, a derivative or a column looks like is the notation's business (`eom.typeset.notation`).
Every head is written together with how firmly it holds together; a part that holds less firmly than its
place demands is bracketed. Juxtaposition binds tighter than the dot and cross product; a sum sign
spans products and ends at the next plus; an integral ends at its own dm.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from decimal import Decimal, Inexact, localcontext
from typing import Any

import sympy as sp

from eom.terms.terms import DYADIC, INERTIAL, SCALAR, VECTOR, Equation, Term, nodes
from eom.typeset import expressions
from eom.typeset.boxes import (
    Box,
    Fence,
    Formula,
    Fraction,
    Grid,
    Operator,
    Row,
    Scripts,
    Symbol,
    raised,
    row,
    symbol,
)
from eom.typeset.expressions import with_signs
from eom.typeset.letters import Notation, Written, letter_box, quantity_box
from eom.typeset.markup import render

ADD, OPEN, PRODUCT, SCALED, JUXTAPOSED, ATOM = range(6)
"""How firmly a box holds together. OPEN: a sum, integral or d/dt reaches to the right."""


@dataclass(frozen=True)
class Writer:
    """A notation at work on one statement; ``frames``: all in which it takes components."""

    notation: Notation
    frames: frozenset[str] = field(default_factory=frozenset)

    def write(self, term: Term) -> Written:
        """Return the box of a term and how firmly it holds together."""
        return RULES[term.head](self, term)

    def box(self, term: Term, least: int = ADD, last: bool = False) -> Box:
        """Return a box that holds as firmly as ``least``; the last of a product may stay open."""
        box, level = self.write(term)
        return box if level >= least or (last and level == OPEN) else Fence(box)


def writer_for(notation: Notation, terms: Iterable[Term]) -> Writer:
    """Return the writer of a statement."""
    found = (n for t in terms for n in nodes(t))
    frames = {f for n in found for f in _component_frames(n)}
    return Writer(notation, frozenset(frames))


def _component_frames(node: Term) -> tuple[Any, ...]:
    if node.head == "column":
        return node.data
    return node.data[1:] if node.head == "atom" and node.data[0] == "rotation" else ()


def term_box(term: Term, notation: Notation) -> Box:
    """Return a term as a box."""
    return writer_for(notation, [term]).box(term)


def write(term: Term, notation: Notation, markup: str = "") -> str:
    """Return a term in a notation; markup: a row of `markup.RENDERERS`, or the notation's own."""
    return render(term_box(term, notation), markup or notation.markup)


def equation_parts(
    equation: Equation, notation: Notation
) -> tuple[tuple[Box, ...], Box, tuple[Box, ...]]:
    """Return left side, relation and right side; a line may break between the pieces of a side."""
    writer = writer_for(notation, [equation.left, equation.right])
    left, right = (pieces(writer, t) for t in (equation.left, equation.right))
    return left, Operator(equation.relation), right


def write_equation(equation: Equation, notation: Notation, markup: str = "") -> str:
    """Return an equation in a notation, on one line."""
    left, relation, right = equation_parts(equation, notation)
    return render(Row((*left, relation, *right)), markup or notation.markup)


# -- sums: signs between terms -----------------------------------------------------------------


def pieces(writer: Writer, term: Term) -> tuple[Box, ...]:
    """Return the terms of a sum with their signs, or the one box."""
    if term.head == "expr":
        return expression_pieces(term.data[0])
    parts = by_axes(term.args) if term.head == "add" else (term,)
    return with_signs([s for a in parts for s in _signed(writer, a)])


def by_axes(parts: tuple[Term, ...]) -> tuple[Term, ...]:
    """Return terms along different axes of one frame in the order of the axes, others as they are."""
    ends = [p.args[-1] if p.head == "mul" else p for p in parts]
    units = [e.data for e in ends if e.head == "atom" and e.data[0] == "unit"]
    if len({*units}) < len(parts) or len({frame for _, frame, _ in units}) > 1:
        return parts
    return tuple(part for _, part in sorted(zip(units, parts, strict=True), key=lambda p: p[0]))


def expression_pieces(value: Any, names: Mapping[Any, str | Box] | None = None) -> tuple[Box, ...]:
    """Return the terms of a SymPy sum with their signs."""
    return with_signs(_signed_expression(value, names or {}))


class Names(dict[Any, Any]):
    """How symbols are shown, by others; ``decimals``: whether fractions are shown as decimal numbers."""

    decimals = False

    def of(self, value: Any) -> Any:
        """Return an expression, or a matrix, as it is shown."""
        found = value.xreplace(self)
        return in_decimals(found) if self.decimals else found


def in_decimals(value: Any) -> Any:
    """Return an expression, or a matrix, whose fractions are written as decimal numbers, but for exponents.

    One without an end, or of more than `DIGITS` digits, stays a fraction where that is short, else it is
    rounded. For eyes alone: such numbers are no longer exact.

    >>> x = sp.Symbol("x")
    >>> in_decimals(x / 20 + 3 * sp.sqrt(x) / 2 + x**2 / 3)
    1.5*sqrt(x) + x**2/3 + 0.05*x
    """
    if isinstance(value, sp.MatrixBase):
        return value.applyfunc(in_decimals)
    if value.is_Rational:
        return value if value.is_Integer else _in_decimals(value)
    if not value.args:
        return value
    if value.is_Pow and value.exp.is_Rational:
        return value.func(in_decimals(value.base), value.exp)
    return value.func(*map(in_decimals, value.args))


DIGITS = 17
"""Digits of a decimal number at most: as many as tell doubles apart."""
_SHORT = 1000
"""Beyond which numbers in a fraction are long."""


def _in_decimals(number: Any) -> Any:
    """Return a fraction as a decimal number."""
    with localcontext(prec=DIGITS) as context:
        found = Decimal(int(number.p)) / Decimal(int(number.q))
        is_exact = not context.flags[Inexact]
    if is_exact:
        return sp.Float(str(found), max(15, len(found.as_tuple().digits)))
    return number if max(abs(number.p), number.q) < _SHORT else sp.Float(number, 15)


def _signed(writer: Writer, term: Term) -> list[tuple[bool, Box]]:
    """Return the terms within ``term``, each with whether it is subtracted."""
    if term.head == "expr":
        return _signed_expression(term.data[0], {})
    if term.head == "mul" and _is_negative(term.args[0]):
        return [(True, _product(writer, term, -1)[0])]
    return [(False, writer.box(term, OPEN))]


def _is_negative(term: Term) -> bool:
    return term.head == "expr" and bool(term.data[0].as_coeff_Mul()[0].is_negative)


def _signed_expression(value: Any, names: Mapping[Any, str | Box]) -> list[tuple[bool, Box]]:
    return [(minus, _plain(rest, names)) for minus, rest in expressions.signed(value)]


def _plain(value: Any, names: Mapping[Any, str | Box] | None = None) -> Box:
    """Return a SymPy expression without a sign as a box."""
    if value.is_Symbol:
        return expressions.expression_box(value, names)
    if value.is_Rational and not value.is_Integer:
        return Fraction(Symbol(str(value.p)), Symbol(str(value.q)))
    if value.is_Float and "e" not in str(value):
        return Symbol(str(value).rstrip("0").rstrip("."))
    return Symbol(str(value)) if value.is_Integer else Formula(value, names or {})


def _expression(_: Writer, term: Term) -> Written:
    value = term.data[0]
    signed = _signed_expression(value, {})
    if len(signed) > 1 or signed[0][0]:
        return row(*with_signs(signed)), ADD
    if isinstance(value, sp.Integral):
        return signed[0][1], OPEN
    return signed[0][1], ATOM if value.is_Symbol or value.is_Rational else SCALED


def _sum_of_terms(writer: Writer, term: Term) -> Written:
    return row(*pieces(writer, term)), ADD


# -- products ----------------------------------------------------------------------------------


def _mul(writer: Writer, term: Term) -> Written:
    if not _is_negative(term.args[0]):
        return _product(writer, term, 1)
    return row(Operator("negative"), _product(writer, term, -1)[0]), ADD


def _product(writer: Writer, term: Term, sign: int) -> Written:
    """Return scalar factors, repeated ones as powers, and the last factor."""
    coefficient, factors = sp.S.One, list(term.args)
    if factors[0].head == "expr":
        coefficient = sign * factors.pop(0).data[0]
    powers = _powers(factors)
    boxes: list[Box] = [] if coefficient == 1 else [_coefficient(coefficient)]
    boxes += [_power(writer, f, n) for f, n in powers[:-1]]
    last, count = powers[-1]
    if count > 1:
        return _juxtapose([*boxes, _power(writer, last, count)]), SCALED
    box, level = writer.write(last)
    bracketed = level < OPEN or (level == PRODUCT and any(isinstance(b, Fence) for b in boxes))
    if bracketed and last.head != "cross":
        box, level = Fence(box), ATOM
    if not boxes:
        return box, level
    return _juxtapose([*boxes, box]), min(level, SCALED)


def _powers(factors: list[Term]) -> list[tuple[Term, int]]:
    """Count equal scalar factors that stand side by side."""
    found: list[tuple[Term, int]] = []
    for f in factors:
        if found and found[-1][0] == f and f.kind == SCALAR:
            found[-1] = (f, found[-1][1] + 1)
        else:
            found.append((f, 1))
    return found


def _power(writer: Writer, factor: Term, count: int) -> Box:
    if count == 1:
        return writer.box(factor, JUXTAPOSED)
    return raised(writer.box(factor, ATOM), Symbol(str(count)))


def _coefficient(value: Any) -> Box:
    box = _plain(value)
    return Fence(box) if isinstance(value, sp.Add | sp.Integral) else box


def _juxtapose(boxes: list[Box]) -> Box:
    """Return boxes side by side, with a little room before what begins with a script."""
    parts: list[Box] = []
    for b in boxes:
        scripted = isinstance(b, Scripts) and b.left is not None
        parts += [Operator("thin" if scripted else "times"), b]
    return row(*parts[1:])


def _binary(operator: str) -> Callable[[Writer, Term], Written]:
    def rule(writer: Writer, term: Term) -> Written:
        a, b = term.args
        left, right = writer.box(a, SCALED), writer.box(b, SCALED, last=True)
        return Row((left, Operator(operator), right)), PRODUCT

    return rule


def _dot(writer: Writer, term: Term) -> Written:
    """In some notations a dyadic stands beside its vector like a matrix."""
    kinds = {a.kind for a in term.args}
    if writer.notation.juxtaposed and kinds == {VECTOR, DYADIC}:
        a, b = term.args
        if (a if a.kind == DYADIC else b).head in {"atom", "add", "mul", "integral", "der"}:
            return _beside(writer, term)
    return _binary("dot")(writer, term)


def _beside(writer: Writer, term: Term) -> Written:
    """Return two factors side by side, as of matrices."""
    a, b = term.args
    right, level = writer.write(b)
    if level not in {OPEN, JUXTAPOSED, ATOM}:
        right, level = Fence(right), ATOM
    box = _juxtapose([writer.box(a, JUXTAPOSED), right])
    return box, OPEN if level == OPEN else JUXTAPOSED


def _outer(writer: Writer, term: Term) -> Written:
    return _binary(writer.notation.outer)(writer, term)


def _inner(writer: Writer, term: Term) -> Written:
    """a^T b."""
    a, b = term.args
    return _juxtapose([_transposed(writer, a), writer.box(b, JUXTAPOSED, last=True)]), JUXTAPOSED


def _outer_column(writer: Writer, term: Term) -> Written:
    """A column times a row: a b^T."""
    a, b = term.args
    return _juxtapose([writer.box(a, JUXTAPOSED), _transposed(writer, b)]), JUXTAPOSED


def _transposed(writer: Writer, term: Term) -> Box:
    return raised(writer.box(term, ATOM), Symbol("T", "roman"))


def _inverse(writer: Writer, term: Term) -> Written:
    minus_one = Row((Operator("negative"), Symbol("1")))
    return raised(writer.box(term.args[0], ATOM), minus_one), ATOM


# -- sums over parts, derivatives, matrices ----------------------------------------------------

_COUNTS = {"particles": "N", "rotors": "n"}


def _sum(writer: Writer, term: Term) -> Written:
    """A sum over elements of mass is an integral whose element the summand holds."""
    index, over = term.data
    if over == "elements":
        return _integrated(writer, writer.box(term.args[0], OPEN)), OPEN
    lower = Row((Symbol(index), Operator("="), Symbol("1")))
    sign = Scripts(Operator("sum"), lower, Symbol(_COUNTS.get(over, "N")), stacked=True)
    return Row((sign, writer.box(term.args[0], OPEN)), " "), OPEN


def _integrated(writer: Writer, box: Box) -> Box:
    return Row((Scripts(Operator("integral"), writer.notation.domain), box), " ")


def _integral(writer: Writer, term: Term) -> Written:
    (inside,) = term.args
    one = inside.head == "expr" and inside.data[0] == 1
    body = None if one else row(writer.box(inside, OPEN), Operator("thin"))
    element = Row((Operator("d"), Symbol("m")))
    return _integrated(writer, row(body, element)), OPEN


def _grid(writer: Writer, term: Term) -> Written:
    boxes = [writer.box(a) for a in term.args]
    count = term.data[0] if term.head == "table" else 3
    size = len(boxes) // count
    return Grid(tuple(tuple(boxes[size * k : size * (k + 1)]) for k in range(count))), ATOM


def _rows(writer: Writer, term: Term) -> Written:
    return Grid(tuple((_transposed(writer, a),) for a in term.args)), ATOM


def peel(term: Term) -> tuple[Term, str, int]:
    """Return what is differentiated, in which frame ("": none), and how many times."""
    inner, times = term.args[0], 1
    while inner.head == "der" and inner.data == term.data:
        inner, times = inner.args[0], times + 1
    return inner, term.data[0], times


def rate(writer: Writer, inner: Term, frame: str, times: int) -> Written:
    """Return d/dt of a term; the frame stands to the upper left."""
    d, t = Operator("d"), Symbol("t")
    power = Symbol(str(times)) if times > 1 else None
    left = writer.notation.frame(frame) if frame else None
    below = row(d, Scripts(t, sup=power) if power else t)
    if writer.notation.frames_outside:
        fraction: Box = Fraction(Scripts(d, sup=power) if power else d, below)
        fraction = Scripts(fraction, left=left) if left else fraction
    else:
        fraction = Fraction(Scripts(d, sup=power, left=left) if left or power else d, below)
    return Row((fraction, Operator("times"), writer.box(inner, ATOM))), OPEN


def _since(writer: Writer, term: Term) -> Written:
    """Return an integral over time, from t0 to t."""
    t = Symbol("t")
    sign = Scripts(Operator("integral"), Scripts(t, Symbol("0")), t)
    inside = row(writer.box(term.args[0], OPEN), Operator("thin"), Operator("d"), t)
    return Row((sign, inside), " "), OPEN


def _start(writer: Writer, term: Term) -> Written:
    """Return the value at t0, that of time by its own letter."""
    (inside,) = term.args
    if inside.head == "expr" and inside.data[0].is_Symbol and inside.data[0].name == "t":
        return symbol("t_0"), ATOM
    place = Row((Operator("open"), Scripts(Symbol("t"), Symbol("0")), Operator("close")))
    return Row((writer.box(term.args[0], ATOM), place)), ATOM


def _at(writer: Writer, term: Term) -> Written:
    """Return the value at an instant, by its name."""
    place = Row((Operator("open"), symbol(term.data[0]), Operator("close")))
    return Row((writer.box(term.args[0], ATOM), place)), ATOM


def _partial(writer: Writer, term: Term) -> Written:
    """Return a quotient; a sum stands beside it, as what is within a fraction is small."""
    sign = Operator("partial")
    inner, variable = (writer.box(a, ATOM) for a in term.args)
    below = row(sign, variable)
    if isinstance(inner, Fence):
        return Row((Fraction(sign, below), Operator("times"), inner)), OPEN
    return Fraction(row(sign, inner), below), ATOM


def is_inertial(frame: str) -> bool:
    """Return whether a derivative is the plain one: of scalars and columns, or in the frame I."""
    return frame in {"", INERTIAL}


def _atom(writer: Writer, term: Term) -> Written:
    name, *labels = term.data
    special = writer.notation.atoms.get(name)
    if special:
        return special(writer.notation, *labels), ATOM
    own = labels[:1] if name == "function" else labels  # of what it is one stands nowhere
    return quantity_box(writer.notation, name, own, term.kind), ATOM


def _zero(writer: Writer, term: Term) -> Written:
    return letter_box(writer.notation, "0", term.kind), ATOM


RULES: dict[str, Callable[[Writer, Term], Written]] = {
    "expr": _expression,
    "zero": _zero,
    "atom": _atom,
    "add": _sum_of_terms,
    "mul": _mul,
    "dot": _dot,
    "cross": _binary("cross"),
    "outer": _outer,
    "der": lambda w, t: w.notation.derivative(w, t),
    "start": _start,
    "since": _since,
    "at": _at,
    "partial": _partial,
    "sum": _sum,
    "integral": _integral,
    "column": lambda w, t: w.notation.column(w, t),
    "matmul": _beside,
    "transpose": lambda w, t: (_transposed(w, t.args[0]), ATOM),
    "inverse": _inverse,
    "tilde": lambda w, t: w.notation.tilde(w, t),
    "inner": _inner,
    "outer_column": _outer_column,
    "entries": _grid,
    "table": _grid,
    "rows": _rows,
}
"""How each head is written."""
