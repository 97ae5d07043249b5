r"""Typed values of sums over particles, body integrals, derivatives, functions and tables.

Poisson brackets, as a note defines them or with the sign that is known.

Integrals with limits over a coordinate, and the coordinates of an element of a body.

A definite integral is taken by rule, term by term: powers of the variable times sines, cosines and
exponentials of what is linear in it, after products of sines and cosines have become sums. Whatever
else stands below the integral is refused, so that no search is ever started.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

import sympy as sp

from eom.checker.mean import dimensions
from eom.checker.mean.dimensions import LENGTH, MASS, NONE, TIME, product
from eom.checker.mean.elaborator import Elaborator, number, powered, pure, quotient
from eom.checker.mean.lexicon import BRACKETS
from eom.checker.mean.tables import skew
from eom.checker.mean.values import (
    ANY,
    ILL_FORMED,
    ROW,
    TABLES,
    UNDECIDED,
    Refusal,
    Value,
    assembled,
    beside,
    cells,
    determinant,
    made,
    mixed,
    negative,
    overdot,
    rate,
    refuse,
    total,
    trace,
    transpose_of,
)
from eom.checker.read.spans import Span
from eom.checker.read.symbol_shape import Look, approached_from, labels, seen
from eom.checker.read.syntax import (
    Addition,
    Call,
    Cases,
    Derivative,
    Differential,
    Group,
    Integral,
    Matrix,
    Missing,
    Node,
    Number,
    Relation,
    Root,
    Sequence,
    Symbol,
    Words,
    walk,
)
from eom.terms import terms
from eom.terms.terms import COLUMN, INERTIAL, MATRIX, SCALAR, Term, atom, expr, nodes
from eom.terms.terms import replace as rewritten
from eom.terms.vocabulary import mass
from eom.worlds.solutions import approached
from eom.worlds.worlds import SLOPE

Expr = Any

ANY_VECTOR = 3
"""Components of vectors."""


# -- rules -----------------------------------------------------------------------------------------


# -- elements of a body ----------------------------------------------------------------------------


VOLUME = LENGTH.power(3)

# -- sums and integrals --------------------------------------------------------------------------


def differential(_: Elaborator, node: Differential) -> Value:
    """Return an element of mass or of volume that stands alone."""
    what = labels(node.variable)
    if what == ("m",) and node.order is None:
        return Value(mass("dm"), SCALAR, MASS, span=node.span)
    if what == ("V",) and node.order is None:
        return Value(expr(sp.Integer(1)), SCALAR, VOLUME, density=-1, span=node.span)
    raise refuse(UNDECIDED, "a differential without a meaning", node.span, "".join(what))


def derivative(e: Elaborator, node: Derivative) -> Value:
    """Return a time derivative; a vector's without a frame is in that of overdots."""
    if node.operand is None:
        raise refuse(ILL_FORMED, "a derivative of nothing", node.span)
    explicit = node.sign == "partial" and e.lexicon.system is not None and node.frame is None
    if tuple(labels(v) for v in node.variables) != (("t",),) or explicit:
        return by_variables(e, node)
    order = 1 if node.order is None else _order(node.order)
    value = e.value(node.operand)
    given = "" if node.frame is None else e.frame(node.frame)
    if given:
        return rate(value, given, order, node.span)
    return overdot(e.lexicon.notation, value, order, node.span)


def by_variables(e: Elaborator, node: Derivative) -> Value:
    """Return a derivative by scalars: a partial one, else the ratio of rates along the motion."""
    assert node.operand is not None
    order = 1 if node.order is None else _order(node.order)
    variables = [v for v in node.variables for _ in range(order if len(node.variables) == 1 else 1)]
    if len(variables) != order:
        raise refuse(UNDECIDED, "the order of a derivative", node.span)
    value = e.value(node.operand)
    for variable in (_by(e, v) for v in reversed(variables)):
        if node.sign == "partial" and variable.shape in TABLES and len(cells(variable)[0]) == 1:
            value = _slopes(e, value, variable, node.span)
            continue
        if variable.shape != SCALAR:
            raise refuse(UNDECIDED, "a derivative by what is no scalar", node.span, variable.words)
        if node.sign == "partial":
            value = partially(e, value, variable, node.span)
        else:
            above, below = (overdot(e.lexicon.notation, v, 1, node.span) for v in (value, variable))
            value = quotient(e, above, below, node.span)
    return value


def _by(e: Elaborator, node: Node) -> Value:
    """Return what is differentiated by; t is the time without an entry."""
    if labels(node) == ("t",) and e.lexicon.find(Look("t")) is None:
        return Value(expr(sp.Symbol("t", real=True)), SCALAR, TIME, span=node.span)
    return e.value(node)


def _slopes(e: Elaborator, value: Value, column: Value, span: Span) -> Value:
    """Return the slopes along the entries of a column: of a scalar a column, of a column a row for each."""
    along = [replace(column, term=c, shape=SCALAR) for (c,) in cells(column)]
    if value.shape != SCALAR and (value.shape not in TABLES or len(cells(value)[0]) > 1):
        raise refuse(UNDECIDED, "the slopes of what is no column", span, value.words)
    parts = [replace(value, term=c, shape=SCALAR) for (c,) in cells(value)]
    rows = [[partially(e, p, x, span) for x in along] for p in parts]
    turned = [[x] for x in rows[0]] if value.shape == SCALAR else rows
    return made([[x.term for x in row] for row in turned], rows[0][0])


def partially(e: Elaborator, value: Value, variable: Value, span: Span) -> Value:
    """Return the partial derivative by a scalar: of what the system knows, or by the formula itself."""
    dimension = product(value.dimension, dimensions.power(variable.dimension, -1))
    if e.lexicon.system is not None and value.shape == SCALAR:
        term = terms.partial(value.term, variable.term)
    else:
        x = e.expression(variable.term)
        if e.lexicon.system is not None and value.shape in TABLES:
            each = [[terms.partial(c, variable.term) for c in row] for row in cells(value)]
            return made(each, replace(value, dimension=dimension, span=span))
        if not x.is_Symbol:
            raise refuse(UNDECIDED, "a derivative by what is no variable", span)
        own = e.lexicon.moving is not None
        term = terms.partial(value.term, expr(x)) if own else _slope(e, value.term, x, span)
    return replace(value, term=term, dimension=dimension, span=span)


def _slope(e: Elaborator, term: Term, x: Expr, span: Span) -> Term:
    """Return the derivative of a formula by one of its symbols."""
    if term.kind == SCALAR and term.head not in _MULTILINEAR - {"add", "mul"}:
        found = e.expression(term)
        own = {s: _symbol_slope(e, e.scalars.get(s), x, span) for s in found.free_symbols - {x}}
        return expr(found.diff(x) + sp.Add(*(found.diff(s) * d for s, d in own.items())))
    if term.head in _MULTILINEAR:
        each = [_slope(e, a, x, span) for a in term.args]
        if term.head in {"add", "entries", "table", "rows"}:
            return terms.rebuild(term, each)
        one_each = (
            terms.rebuild(term, (*term.args[:k], d, *term.args[k + 1 :]))
            for k, d in enumerate(each)
        )
        return terms.add(*one_each)
    if _stays(e, term, x):
        return terms.zero(term.kind)
    raise refuse(UNDECIDED, "it is not known how this depends on the variable", span)


def _symbol_slope(e: Elaborator, meaning: Term | None, x: Expr, span: Span) -> Expr:
    """Return the slope of what a symbol stands for."""
    if meaning is not None and meaning.data[:1] == ("function",):
        return _function_slope(e, meaning, x)
    if meaning is None or _independent(e, meaning):
        return sp.Integer(0)
    inside = meaning.head == "expr" or meaning.head in _MULTILINEAR
    if not inside:
        raise refuse(UNDECIDED, "it is not known how this depends on the variable", span)
    return e.expression(_slope(e, meaning, x, span))


def _function_slope(e: Elaborator, function: Term, x: Expr) -> Expr:
    """Return the slope of a function of coordinates along one of them; none along anything else."""
    variable = e.scalars.get(x)
    _, name, *of = function.data
    along = " ".join(map(str, variable.data)) if variable is not None else ""
    if along not in of:
        return sp.Integer(0)
    whole, *by = name.split(SLOPE)
    label = SLOPE.join((whole, *sorted([*by, along])))
    return e.name(label, terms.atom("function", label, *of, kind=SCALAR))


_MULTILINEAR = frozenset(
    "add mul dot cross outer column tilde transpose matmul inner outer_column entries rows table".split()
)
_FREE = frozenset(
    "scalar coordinate free_angle angle turn_angle principal_angle mass total_mass inertia unit".split()
)


def _independent(e: Elaborator, meaning: Term | None) -> bool:
    """Tell whether a scalar depends on no variable but itself: a parameter, a coordinate or its rate."""
    if meaning is None:
        return True
    inner = meaning
    while inner.head == "der":
        inner = inner.args[0]
    found = [n for n in nodes(inner) if n.head == "atom"]
    symbols = {s for n in nodes(inner) if n.head == "expr" for s in n.data[0].free_symbols}
    plain = not any(n.head in {"der", "sum", "since"} for n in nodes(inner))
    alone = inner == meaning or len(found) + len(symbols) == 1
    named = all(n.data[0] in _FREE for n in found)
    return plain and alone and named and all(_independent(e, e.scalars.get(s)) for s in symbols)


def at_values(e: Elaborator, value: Value, items: Iterable[Node], span: Span) -> Value | None:
    """Return a formula with numbers in the place of its variables: x = 0, y = a; None for no such list."""
    chosen: dict[Expr, Expr] = {}
    for item in items:
        if not isinstance(item, Relation) or [s.name for s in item.signs] != ["="]:
            return None
        variable, other = (e.value(m) for m in item.members)
        x = e.expression(variable.term)
        if not x.is_Symbol or other.shape != SCALAR:
            return None
        chosen[x] = e.expression(other.term)
    found = e.expression(value.term) if value.shape == SCALAR else None
    if found is None or not all(_independent(e, e.scalars.get(s)) for s in found.free_symbols):
        return None
    return replace(value, term=expr(found.xreplace(chosen)), span=span)


def _stays(e: Elaborator, term: Term, x: Expr) -> bool:
    """Tell whether a vector does not change with a variable: a unit vector with a rate, or one of I."""
    meaning = e.scalars.get(x)
    by_rate = meaning is not None and meaning.head == "der"
    return term.is_zero or (term.data[:1] == ("unit",) and (by_rate or term.data[1] == INERTIAL))


def _order(node: Node) -> int:
    if isinstance(node, Number) and node.text in {"1", "2", "3", "4"}:
        return int(node.text)
    raise refuse(UNDECIDED, "the order of a derivative", node.span)


# -- functions -----------------------------------------------------------------------------------

_FUNCTIONS: dict[str, Callable[..., Any]] = {
    **{
        name: getattr(sp, name)
        for name in ("sin", "cos", "tan", "cot", "sec", "csc", "sinh", "cosh", "tanh", "exp")
    },
    **{a: getattr(sp, b) for a, b in (("arcsin", "asin"), ("arccos", "acos"), ("arctan", "atan"))},
    **{name: getattr(sp, name) for name in ("asin", "acos", "atan")},
    "ln": sp.log,
    "log": sp.log,
}
_OF_ANY = {"sgn": sp.sign, "sign": sp.sign}
"""Functions of a scalar with any dimension."""
_LOGARITHMS = frozenset({"ln", "log"})
_INVERSES = {"sin": sp.asin, "cos": sp.acos, "tan": sp.atan}


def call(e: Elaborator, node: Call) -> Value:
    """Return a function of a scalar without dimension, or of a matrix."""
    if node.function == "diag":
        return _diagonal(e, node)
    if node.function == "lim":
        return limit(e, node)
    if node.function == "atan2":
        return direction(e, node)
    return called_on(e, node, e.value(node.argument))


def direction(e: Elaborator, node: Call) -> Value:
    """Return the angle of a direction in the plane, of its second and its first coordinate."""
    body = node.argument.body if isinstance(node.argument, Group) else None
    items = body.items if isinstance(body, Sequence) else ()
    if len(items) != len("yx"):
        raise refuse(UNDECIDED, "an angle of other than two coordinates", node.span)
    values = [e.value(item) for item in items]
    if total(e.lexicon.notation, values).shape != SCALAR:
        raise refuse(ILL_FORMED, "the argument of a function is a scalar", node.span)
    return number(sp.atan2(*(e.expression(v.term) for v in values)), node.span)


def called_on(e: Elaborator, node: Call, argument: Value) -> Value:
    """Return what a function makes of a value."""
    if node.sub is not None:
        raise refuse(UNDECIDED, "what stands below this function has no meaning", node.span)
    if node.function in _MATRIX_FUNCTIONS:
        return _MATRIX_FUNCTIONS[node.function](e, argument, node.span)
    if node.function in _OF_ANY and argument.shape == SCALAR and node.sup is None:
        return number(_OF_ANY[node.function](e.expression(argument.term)), node.span)
    function = _FUNCTIONS.get(node.function)
    if function is None:
        raise refuse(UNDECIDED, "a function without a meaning", node.span, node.function)
    pointed = node.function in _LOGARITHMS and argument.dimension not in {None, NONE}
    pure(replace(argument, dimension=None) if pointed else argument, node.argument.span)
    power = None if node.sup is None else "".join(labels(node.sup))
    if power == "-1" and node.function in _INVERSES:
        function, power = _INVERSES[node.function], None
    value = number(function(e.expression(argument.term)), node.span)
    value = replace(value, dimension=None) if pointed else value
    if power is None:
        return value
    if not power.isdigit():
        raise refuse(UNDECIDED, "a power of a function", node.span, power)
    return powered(e, value, Fraction(power), node.span)


def lone_logarithm(e: Elaborator, nodes: Iterable[Node]) -> Span | None:
    """Return where the one logarithm of something with a dimension stands that nothing makes good for.

    Its rate has no unit left in it, and the difference of two is that of a quotient.
    """
    found = []
    for node in (n for tree in nodes for n in walk(tree)):
        if isinstance(node, Derivative | Integral | Differential):
            return None
        if isinstance(node, Call) and node.function in _LOGARITHMS:
            try:
                value = e.value(node.argument)
            except Refusal:
                return None
            found += [node.argument.span] if value.dimension not in {None, NONE} else []
    return found[0] if len(found) == 1 else None


def cases(e: Elaborator, node: Cases) -> Value:
    """Return scalars with conditions, of which the first applies that is met."""
    rows = [_case(row) for row in node.rows]
    values = [e.value(value) for value, _ in rows]
    whole = total(e.lexicon.notation, values)
    if whole.shape != SCALAR:
        raise refuse(UNDECIDED, "cases of what is no scalar", node.span, whole.words)
    met = [condition(e, said) for _, said in rows]
    pairs = zip((e.expression(v.term) for v in values), met, strict=True)
    return replace(whole, term=expr(sp.Piecewise(*pairs, evaluate=False)), span=node.span)


def _case(row: tuple[Node, ...]) -> tuple[Node, tuple[Node, ...]]:
    """Return the value of a case, and what is said of when it applies."""
    cells = [n for cell in row for n in (cell.items if isinstance(cell, Sequence) else (cell,))]
    return cells[0], tuple(cells[1:])


_WHEN = frozenset("if for when where as long provided that".split())
_ELSE = frozenset({"otherwise", "else", "elsewhere"})
_COMPARED = {"<": sp.Lt, ">": sp.Gt, "<=": sp.Le, ">=": sp.Ge, "=": sp.Eq, "!=": sp.Ne}


def condition(e: Elaborator, said: Iterable[Node]) -> Expr:
    """Return a condition of comparisons, which words join. Raises `Refusal` for other words."""
    met: list[Expr] = []
    join = sp.And
    for node in said:
        if isinstance(node, Words):
            words = node.text.casefold().replace(",", " ").strip(" .;:").split()
            join = sp.Or if "or" in words else join
            if set(words) - _WHEN - _ELSE - {"and", "or", "in", "all", "other", "cases"}:
                raise refuse(UNDECIDED, "a condition in words", node.span, node.text.strip())
        elif isinstance(node, Relation) and all(s.name in _COMPARED for s in node.signs):
            met += _comparisons(e, node)
        elif not isinstance(node, Missing):
            raise refuse(UNDECIDED, "a condition that compares nothing", node.span)
    return join(*met) if met else sp.true


def _comparisons(e: Elaborator, node: Relation) -> Iterator[Expr]:
    """Yield the comparisons of a chain; what is compared has one dimension."""
    values = [e.value(m) for m in node.members]
    for (a, b), sign in zip(pairwise(values), node.signs, strict=True):
        apart = total(e.lexicon.notation, [a, negative(b, node.span)])
        if apart.shape != SCALAR:
            raise refuse(UNDECIDED, "a condition on what is no scalar", node.span)
        yield _COMPARED[sign.name](e.expression(apart.term), 0, evaluate=False)


def limit(e: Elaborator, node: Call) -> Value:
    """Return what a scalar goes to where a letter goes to a value, from one side or to infinity."""
    below = node.sub
    if not isinstance(below, Relation) or [s.name for s in below.signs] != ["to"]:
        raise refuse(UNDECIDED, "a limit of what goes nowhere", node.span, expected="a \\to b")
    what, (target, side) = e.value(node.argument), approached_from(below.members[1])
    x = e.expression(e.value(below.members[0]).term)
    if what.shape != SCALAR or not x.is_Symbol:
        raise refuse(
            UNDECIDED, "a limit of what is no scalar, or over what is no letter", node.span
        )
    infinite = isinstance(target, Symbol) and target.name == "infty"
    goal = sp.oo if infinite else e.expression(e.value(target).term)
    return replace(what, term=expr(approached(e.expression(what.term), x, goal, side)))


_MATRIX_FUNCTIONS: dict[str, Callable[[Elaborator, Value, Span], Value]] = {
    "tr": lambda _, value, span: trace(value, span),
    "Tr": lambda _, value, span: trace(value, span),
    "det": lambda _, value, span: determinant(value, span),
    "skew": lambda e, value, span: skew(e.lexicon.notation, value, span),
    "Skew": lambda e, value, span: skew(e.lexicon.notation, value, span),
}


def root(e: Elaborator, node: Root) -> Value:
    """Return a square root."""
    if node.degree is not None:
        raise refuse(UNDECIDED, "a root of higher degree", node.span)
    return powered(e, e.value(node.body), Fraction(1, 2), node.span)


# -- tables --------------------------------------------------------------------------------------


def tuple_value(e: Elaborator, node: Group, body: Sequence) -> Value:
    """Return numbers in brackets, or vectors and numbers: round ones are a column, square ones a row.

    Two numbers are one in round brackets alone, as square ones have ranges and commutators in them.
    """
    values = [e.value(item) for item in body.items]
    blocks = len(values) > ANY_VECTOR or any(v.shape != SCALAR for v in values)
    if node.open in {"(", "["} and (blocks or (node.open, len(values)) == ("(", 2)):
        upright = _blocks(e, [[v] for v in values], node.span)
        return upright if node.open == "(" else transpose_of(e.lexicon.notation, upright, node.span)
    if (
        node.open not in {"(", "["}
        or len(values) != ANY_VECTOR
        or any(v.shape != SCALAR for v in values)
    ):
        raise refuse(UNDECIDED, "a list without a meaning", node.span)
    return line(e, values, node.span, COLUMN if node.open == "(" else ROW)


def column_of(e: Elaborator, values: list[Value], span: Span) -> Value:
    """Return numbers or columns one below the other."""
    if len(values) == ANY_VECTOR and all(v.shape == SCALAR for v in values):
        return line(e, values, span, COLUMN)
    return _blocks(e, [[v] for v in values], span)


def line(e: Elaborator, values: list[Value], span: Span, shape: str) -> Value:
    """Return scalars as a column or row."""
    common = _common(e, values)
    term = terms.entries([[v.term] for v in values])
    return Value(term, shape, common.dimension, ANY, common.density, span)


def _common(e: Elaborator, values: list[Value]) -> Value:
    """Return the sum of all, which has their dimension; zeros have any.

    In the coordinates of a system lengths may stand beside angles: their column has none.
    """
    known = [v for v in values if not v.is_zero] or values[:1]
    mixed = e.lexicon.system is not None and len({v.dimension for v in known}) > 1
    return total(
        e.lexicon.notation, [replace(v, dimension=None) for v in known] if mixed else known
    )


def _diagonal(e: Elaborator, node: Call) -> Value:
    group = node.argument
    body = group.body if isinstance(group, Group) else None
    if not isinstance(body, Sequence) or len(body.items) != 3:
        raise refuse(UNDECIDED, "a diagonal of other than three", node.span)
    values = [e.value(item) for item in body.items]
    nought = number(sp.Integer(0), node.span)
    cells = [[values[r] if r == c else nought for c in range(3)] for r in range(3)]
    return _square(e, cells, node.span)


def matrix(e: Elaborator, node: Matrix) -> Value:
    """Return a column, a row, a square of scalars, rows above each other, or columns side by side."""
    if len(node.rows) == len(node.rows[0]) == 1:
        return e.value(node.rows[0][0])
    return table_of(e, [[e.value(c) for c in row] for row in node.rows], node.span)


def table_of(e: Elaborator, cells: list[list[Value]], span: Span) -> Value:
    """Return what cells make: as `matrix` does."""
    size = (len(cells), *{len(row) for row in cells})
    flat = [v for row in cells for v in row]
    scalars = all(v.shape == SCALAR for v in flat)
    if scalars and size in {(3, 1), (1, 3)}:
        return line(e, flat, span, COLUMN if size == (3, 1) else ROW)
    if scalars and size == (3, 3):
        return _square(e, cells, span)
    if size == (3, 1) and all(v.shape == ROW for v in flat):
        return _stacked(e, flat, span)
    if size == (1, 3) and all(v.shape == COLUMN for v in flat):
        stacked = _stacked(e, flat, span)
        frames = (stacked.frames[1], stacked.frames[0])
        return replace(stacked, term=terms.transpose(stacked.term), frames=frames)
    return _blocks(e, cells, span)


def _blocks(e: Elaborator, given: list[list[Value]], span: Span) -> Value:
    """Return a table of blocks: of numbers, columns, rows, matrices and tables.

    Its dimension is that of all entries, or unknown where they differ, as those of a state may.
    """
    blocks = [[mixed(e.lexicon.notation, v) for v in row] for row in given]
    known = [v.dimension for row in blocks for v in row if not v.is_zero]
    shapes = {v.shape for row in blocks for v in row}
    if not shapes <= {SCALAR, *TABLES}:
        raise refuse(UNDECIDED, "a table without a meaning", span, ", ".join(sorted(shapes)))
    one = known[0] if len(set(known)) == 1 else None
    like = Value(blocks[0][0].term, SCALAR, one)
    found = assembled(blocks, like) if len({len(row) for row in blocks}) == 1 else None
    if found is None:
        raise refuse(ILL_FORMED, "the parts of a table do not fit together", span)
    return replace(found, span=span)


def _square(e: Elaborator, cells: list[list[Value]], span: Span) -> Value:
    """Return a square of scalars; rows and columns of coefficients may have dimensions of their own."""
    grid = [[None if v.is_zero else v.dimension for v in row] for row in cells]
    known = {d for row in grid for d in row if d is not None}
    if len(known) > 1 and dimensions.by_rows_and_columns(grid):
        cells = [[replace(v, dimension=None) for v in row] for row in cells]
    common = _common(e, [v for row in cells for v in row])
    if common.shape != SCALAR:
        raise refuse(UNDECIDED, "a table without a meaning", span)
    term = terms.entries([[v.term for v in row] for row in cells])
    return Value(term, MATRIX, common.dimension, ANY, common.density, span)


def _stacked(e: Elaborator, values: list[Value], span: Span) -> Value:
    common = _common(e, values)
    term = terms.make("rows", (v.term for v in values))
    frames = ("", common.frames[0])
    return Value(term, MATRIX, common.dimension, frames, common.density, span)


# -- Poisson brackets ---------------------------------------------------------------------------


def bracket(e: Elaborator, node: Group, body: Sequence) -> Value | None:
    """Return a Poisson bracket of two scalars: as the note defines it, in braces else by its sign."""
    known = next((k for k in e.definitions if k.name == node.open and len(k.sub) == 2), None)
    system = e.lexicon.system
    if len(body.items) != 2 or not (known or _is_poisson(e, node)):
        return None
    values = [e.value(item) for item in body.items]
    if any(v.shape != SCALAR for v in values):
        return None
    if known is None:
        assert system is not None
        terms = list(_canonical(e, values, len(system.coordinates), node.span))
        usual = total(e.lexicon.notation, terms)
        said = e.definitions.get(POISSON)
        positive = (
            BRACKETS.get(e.lexicon.notation.brackets, 1) > 0 if said is None else said == PLUS
        )
        return usual if positive else negative(usual, node.span)
    found = e.definitions[known]
    letters = (sp.Symbol(text, real=True) for text in known.sub)
    put = {s: e.name(s.name, t) for s, t in found.scalars.items()}
    put |= {s: e.expression(v.term) for s, v in zip(letters, values, strict=True)}

    def rule(term: Term) -> Term:
        return expr(term.data[0].xreplace(put)) if term.head == "expr" else term

    return replace(found, term=rewritten(found.term, rule), dimension=None, span=node.span)


POISSON = Look("{")
"""By what the sign of Poisson brackets is known, once a note has shown it."""
PLUS, MINUS = (Value(expr(sp.Integer(s)), SCALAR) for s in (1, -1))
"""Signs of Poisson brackets: {q, p} = 1 or {p, q} = 1."""


def _is_poisson(e: Elaborator, node: Node) -> bool:
    """Return whether braces around two things are a Poisson bracket in the canonical coordinates."""
    pair = isinstance(node, Group) and node.open == "{" and isinstance(node.body, Sequence)
    system = e.lexicon.system
    return pair and system is not None and bool(system.coordinates)


def leaves_sign(e: Elaborator, members: Iterable[Node]) -> bool:
    """Return whether Poisson brackets stand in members whose sign nothing before has said."""
    said = any(k == POISSON or (k.name == "{" and len(k.sub) == 2) for k in e.definitions)
    if said or e.lexicon.notation.brackets:
        return False
    return any(_is_poisson(e, n) for m in members for n in walk(m))


def is_fundamental(e: Elaborator, members: Iterable[Node]) -> bool:
    """Return whether an equation gives one bracket of a coordinate and a momentum as a number or delta."""
    plain = [_without_sign(n) for n in members]
    braces = [n for n in plain if _is_poisson(e, n)]
    others = [n for n in plain if not _is_poisson(e, n)]
    if len(braces) != 1 or len(others) != 1:
        return False
    found = seen(others[0])
    delta = found is not None and found.look.name == "delta"
    items = braces[0].body.items
    return (isinstance(others[0], Number) or delta) and {_half(e, i) for i in items} == {"q", "p"}


def _without_sign(node: Node) -> Any:
    return node.terms[0] if isinstance(node, Addition) and len(node.terms) == 1 else node


def _half(e: Elaborator, node: Node) -> str:
    """Return "q" for a coordinate of the system, "p" for a momentum, "" for all else."""
    system = e.lexicon.system
    assert system is not None
    try:
        term = e.value(node).term
    except Refusal:
        return ""
    plain = term.head == "expr" and term.data[0].is_Symbol
    meaning = e.scalars.get(term.data[0]) if plain else None
    if meaning is None or meaning.head != "atom" or meaning.data[0] != "system":
        return ""
    name = str(meaning.data[1])
    numbers = [str(k) for k, _ in enumerate(system.coordinates, 1)]
    if name in {*system.coordinates, *(f"q_{k}" for k in numbers)}:
        return "q"
    return "p" if name in {f"p_{k}" for k in (*system.coordinates, *numbers)} else ""


def _canonical(e: Elaborator, values: list[Value], count: int, span: Span) -> Iterator[Value]:
    """Yield the terms of a Poisson bracket."""
    f, h = values
    for k in range(1, count + 1):
        q, p = (
            Value(expr(e.name(n, atom("system", n, kind=SCALAR))), SCALAR)
            for n in (f"q_{k}", f"p_{k}")
        )
        for a, b, sign in ((q, p, 1), (p, q, -1)):
            above, below = partially(e, f, a, span), partially(e, h, b, span)
            yield beside(
                e.lexicon.notation,
                number(sp.Integer(sign), span),
                beside(e.lexicon.notation, above, below),
            )
