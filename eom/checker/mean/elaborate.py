r"""From a syntax tree to typed values, by the lexicon of the note: sums, products, brackets, scripts.

One rule a kind of node; `eom.checker.mean.calculus` has those for sums over particles, body integrals,
derivatives, functions and tables, `eom.checker.mean.elaborator` that for symbols.

Attitude in formulas: elementary rotations ``C_3(\psi)``, and ``c\theta`` for cosines.

Sums over the coordinates of a system.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.checker.mean import calculus, instants, integrals
from eom.checker.mean.dimensions import NONE
from eom.checker.mean.elaborator import (
    FUNCTIONS,
    TRANSPOSED,
    Elaborator,
    Rule,
    dressed,
    marked,
    number,
    of_meaning,
    pure,
    quotient,
    raised,
    symbol_value,
    without_meaning,
)
from eom.checker.mean.indices import (
    LETTERS,
    indexed,
    indices_of,
    is_known,
    knows,
    numbered,
    numberings,
    summed,
)
from eom.checker.mean.lexicon import MATRICES, Lexicon, Meaning
from eom.checker.mean.tables import (
    DUAL,
    crossed,
    is_quaternion,
    of_columns,
    skew,
    spatial_cross,
    tensored,
    unstarred,
)
from eom.checker.mean.values import (
    AMBIGUOUS,
    ANY,
    ILL_FORMED,
    UNDECIDED,
    Refusal,
    Value,
    atoms_in,
    beside,
    components,
    determinant,
    dotted,
    is_square,
    negative,
    overdot,
    refuse,
    square,
    total,
)
from eom.checker.read.spans import Span
from eom.checker.read.symbol_shape import DOTS, Look, grown, labels, named_in, seen
from eom.checker.read.syntax import (
    Accent,
    Addition,
    BigOperator,
    Boxed,
    Braced,
    Call,
    Cases,
    Derivative,
    Differential,
    Evaluated,
    Fraction,
    Group,
    Integral,
    Marks,
    Matrix,
    Missing,
    Node,
    Number,
    Over,
    Product,
    Quotient,
    Root,
    Scripts,
    Section,
    Sequence,
    Struck,
    Symbol,
    Words,
    walk,
)
from eom.kinematics.coordinates import elementary
from eom.terms.terms import MATRIX, SCALAR, TABLE, VECTOR, entries, expr, inner
from eom.terms.terms import dot as dot_product
from eom.terms.vocabulary import quantity
from eom.worlds.worlds import ANGLES

TURNS: dict[str, int] = {"turn": 1, "active_turn": -1}
"""Functions of an angle: the rotation about an axis that turns the frame, or the vector (inverse)."""


def turn(e: Elaborator, meaning: Meaning, argument: Value, span: Span) -> Value:
    """Return the rotation about an axis by an angle, of components in two frames that have no name."""
    pure(argument, argument.span)
    by = TURNS[meaning.quantity] * e.expression(argument.term)
    matrix = elementary(int(meaning.labels[0]), by)
    return Value(entries(matrix), MATRIX, NONE, span=span)


def between_frames(e: Elaborator, node: Group) -> Value | None:
    """Return the rotation that two frames in square brackets stand for: [BN], from N to B."""
    body = node.body
    if not (e.lexicon.notation.bracketed and node.open == "[" and isinstance(body, Product)):
        return None
    frames = [e.lexicon.frame(labels(f)) for f in body.factors]
    if body.operator or len(frames) != 2 or None in frames:
        return None
    to, start = str(frames[0]), str(frames[1])
    return Value(quantity("rotation", to, start), MATRIX, NONE, (to, start), span=node.span)


# -- abbreviations -------------------------------------------------------------------------------

_FUNCTIONS = {"s": "sin", "c": "cos", "t": "tan", "S": "sin", "C": "cos"}


def abbreviated(e: Elaborator, node: Node, argument: Node | None) -> Call | None:
    r"""Read ``c\theta``, ``c^2\theta`` as a cosine where c means nothing else and an angle follows."""
    power, letter = None, node
    if isinstance(node, Scripts) and node.sub is node.presub is node.presup is None:
        power, letter = node.sup, node.base
    name = _function(e, letter)
    if not name or argument is None or not _is_angle(e.lexicon, argument):
        return None
    return Call(name, argument, sup=power, span=node.span.join(argument.span))


def subscripted(e: Elaborator, node: Scripts) -> Call | None:
    r"""Read ``c_\theta``, ``s_{\theta/2}``, and ``c_2`` for the cosine of an angle with that number."""
    name = _function(e, node.base)
    if not name or node.sub is None or node.presub is not None or node.presup is not None:
        return None
    found = seen(node)
    if found is not None and is_known(e, found.look):
        return None
    argument = _numbered(e.lexicon, node.sub) if isinstance(node.sub, Number) else node.sub
    if argument is None or not _is_angle(e.lexicon, argument):
        return None
    return Call(name, argument, sup=node.sup, span=node.span)


def _function(e: Elaborator, node: Node) -> str:
    if not isinstance(node, Symbol) or node.style not in {"", "roman"}:
        return ""
    return "" if is_known(e, Look(node.name)) else _FUNCTIONS.get(node.name, "")


def _is_angle(lexicon: Lexicon, node: Node) -> bool:
    """Return whether the lexicon says that this is an angle, or half of one."""
    if isinstance(node, Group) and node.open == "":
        return _is_angle(lexicon, node.body)
    if isinstance(node, Fraction | Quotient):
        above, below = (
            (node.above, node.below) if isinstance(node, Fraction) else (node.left, node.right)
        )
        return isinstance(below, Number) and _is_angle(lexicon, above)
    given = seen(node)
    found = None if given is None or given.dots or given.raised else lexicon.find(given.look)
    return found is not None and found.meaning.quantity in ANGLES


def _numbered(lexicon: Lexicon, node: Number) -> Node | None:
    """Return the one angle that carries a number below."""
    known = {
        entry.look.name
        for layer in lexicon.layers
        for entry in layer
        if entry.look.sub in {(node.text,), ("<k>",)} and entry.meaning.quantity in ANGLES
    }
    if len(known) != 1:
        return None
    return Scripts(Symbol(known.pop(), span=node.span), node, span=node.span)


MAX_DIGITS = 40


def elaborator(lexicon: Lexicon, definitions: Mapping[Look, Value] | None = None) -> Elaborator:
    """Return an elaborator for a place of a note: ``lexicon`` is what holds there."""
    return Elaborator(lexicon, RULES, definitions or {})


# -- leaves --------------------------------------------------------------------------------------


def _number(_: Elaborator, node: Number) -> Value:
    if len(node.text) > MAX_DIGITS:
        raise refuse(UNDECIDED, "a number is too long", node.span, f"{len(node.text)} digits")
    value = number(sp.Rational(node.text), node.span)
    return replace(value, dimension=None) if value.is_zero else value


def _symbol(e: Elaborator, node: Node) -> Value:
    """Return what a symbol means; one without a meaning may be an instant, or have one below it."""
    instant = instants.time(e, node) if e.lexicon.system is None else None
    if instant is not None:
        return instant
    try:
        return symbol_value(e, node)
    except Refusal:
        found = instants.time(e, node) or instants.below(e, node) or _indexed(e, node)
        if found is None:
            raise
        return found


def _indexed(e: Elaborator, node: Node) -> Value | None:
    """Return Kronecker's or Levi-Civita's symbol, or the sum over an index that stands twice below."""
    given = seen(node)
    value = None if given is None or given.dots else numbered(given.look, e.indices)
    if value is not None and given is not None:
        found = number(value, node.span)
        return replace(found, dimension=None) if found.is_zero else found
    values = [e.bound(**axes).value(node) for axes in summed(node, e)]
    return total(e.lexicon.notation, values) if values else None


def _evaluated(e: Elaborator, node: Evaluated) -> Value:
    """Return what stands before a bar with two instants, or with values of its variables."""
    found = None
    if node.sub is not None and node.sup is not None:
        found = instants.between(e, e.value(node.base), node.sub, node.sup, node.span)
    elif node.sub is not None:
        items = node.sub.items if isinstance(node.sub, Sequence) else (node.sub,)
        found = calculus.at_values(e, e.value(node.base), items, node.span)
    if found is None:
        raise refuse(UNDECIDED, "what stands at this bar has no meaning", node.span)
    return found


def _missing(_: Elaborator, node: Missing) -> Value:
    raise refuse(UNDECIDED, "something is left out here", node.span)


def _words(_: Elaborator, node: Words) -> Value:
    raise refuse(UNDECIDED, "words within a formula", node.span, node.text.strip())


# -- sums and products ---------------------------------------------------------------------------


def _addition(e: Elaborator, node: Addition) -> Value:
    values = []
    for sign, term in zip(node.signs, node.terms, strict=True):
        if sign not in {"", "+", "-"}:
            raise refuse(AMBIGUOUS, "a sign that stands for two", node.span, sign)
        value = e.value(term)
        values.append(negative(value, term.span) if sign == "-" else value)
    return total(e.lexicon.notation, values)


def _big_operator(e: Elaborator, node: BigOperator) -> Value:
    """Return a sum over the coordinates of a system, or over what else it may be."""
    letters = indices_of(node)[0] if not isinstance(node.upper, Number) else ()
    known = knows(e)
    inside = {w for _, words in indexed(node.body, known) for w in words}
    if node.sign != "sum" or not letters or not inside.issuperset(letters):
        return integrals.big_operator(e, node)
    values = [e.bound(**axes).value(node.body) for axes in numberings(letters, (node.body,), known)]
    return total(e.lexicon.notation, values)


def _product(e: Elaborator, node: Product) -> Value:
    repeated = list(summed(node, e))
    if repeated:
        values = [e.bound(**axes).value(node) for axes in repeated]
        return total(e.lexicon.notation, values)
    rule, node = _OPERATORS.get(node.operator), unstarred(node)
    if rule is None:
        raise refuse(UNDECIDED, "an operator without a meaning", node.span, node.operator)
    if node.operator:
        values = [e.value(f) for f in node.factors]
        if node.operator == DUAL:
            return spatial_cross(e.lexicon.notation, *values, dual=True)
        if rule is crossed and len(values) > 2 and any(v.shape != SCALAR for v in values):
            raise refuse(
                AMBIGUOUS,
                "a cross product of more than two factors",
                node.span,
                expected="brackets: a x (b x c) is not (a x b) x c",
            )
    elif isinstance(unit := node.factors[-1], Number) and unit.text == "1":
        values = [*_factors(e, node.factors[:-1]), _identity(e, unit.span)]
    else:
        values = _factors(e, node.factors)
    result = values[0]
    for value in values[1:]:
        result = rule(e.lexicon.notation, result, value)
    return result


def _factors(e: Elaborator, nodes: tuple[Node, ...]) -> list[Value]:
    """Return factors side by side; arguments of functions go with their functions."""
    values: list[Value] = []
    k = 0
    while k < len(nodes):
        following = nodes[k + 1] if k + 1 < len(nodes) else None
        argument, above = _argument(following)
        if argument is not None:
            one = nodes[k]
            if isinstance(one, Call) and not isinstance(one.argument, Group):
                within = _applied(e, one.argument, argument, above)
                applied = None if within is None else calculus.called_on(e, one, within)
            else:
                applied = _applied(e, one, argument, above)
            if applied is not None:
                values.append(
                    applied if above is None else raised(e, applied, above, argument.span)
                )
                k += 2
                continue
        if following is not None and _is_change(e, nodes[k]):
            values.append(_change(e, following, nodes[k].span.join(following.span)))
            k += 2
            continue
        short = abbreviated(e, nodes[k], following)
        if short is not None:
            values.append(e.value(short))
            k += 2
            continue
        values.append(e.value(nodes[k]))
        k += 1
    return values


def _is_change(e: Elaborator, node: Node) -> bool:
    r"""Return whether a factor is the \Delta before what changes."""
    plain = isinstance(node, Symbol) and node.name == "Delta" and not node.style
    return plain and not is_known(e, Look("Delta"))


def _change(e: Elaborator, node: Node, span: Span) -> Value:
    """Return a change that the lexicon names, else how much something grows between two instants."""
    given = seen(node)
    found = e.lexicon.find(grown(given), e.indices) if given is not None else None
    if found is None or given is None:
        return instants.change(e, node, span)
    return of_meaning(e, found, given, span)


def _argument(node: Node | None) -> tuple[Group | None, Node | None]:
    """Return round brackets and what stands above them; no brackets in case of anything else."""
    raised_only = isinstance(node, Scripts) and (node.sub or node.presub or node.presup) is None
    inside, above = (
        (node.base, node.sup) if isinstance(node, Scripts) and raised_only else (node, None)
    )
    return (inside, above) if isinstance(inside, Group) and inside.open == "(" else (None, None)


def _applied(e: Elaborator, node: Node, argument: Group, above: Node | None) -> Value | None:
    """Return a function of an argument: a skew matrix, or what depends on a place or on time.

    ``above``: what stands above the brackets; a row or column that is transposed there is a factor.
    """
    given = seen(node)
    if given is None:
        return None
    named = named_in(argument)
    if named:
        look = replace(given.look, sub=(*given.look.sub, *named))
        found = e.lexicon.find(look, e.indices)
        if found is not None:
            return of_meaning(e, found, given, node.span.join(argument.span))
        if e.lexicon.names_behind(look) or e.lexicon.find(given.look, e.indices) is None:
            raise without_meaning(e, look, node.span.join(argument.span))
    called = e.lexicon.find(replace(given.look, called=True), e.indices)
    if called is not None:
        return of_meaning(e, called, given, node.span)
    entry = e.lexicon.find(given.look, e.indices)
    if entry is not None and entry.meaning.quantity in FUNCTIONS:
        span = node.span.join(argument.span)
        return dressed(
            e, _function_value(e, entry.meaning, e.value(argument.body), span), given, span
        )
    if instants.key(e, argument.body):
        return instants.at(e, e.value(node), argument.body)
    if entry is None:
        return None
    body = argument.body
    listed = above is None and isinstance(body, Sequence) and all(map(seen, body.items))
    listed = listed and entry.meaning.quantity in _OF_VARIABLES and not _multiplies(e, node, body)
    function = entry.meaning.function or listed
    return e.value(node) if function or _of_coordinates(entry.meaning, body) else None


def _call(e: Elaborator, node: Call) -> Value:
    """Return a function of the lexicon, else one that is known."""
    entry = e.lexicon.find(Look(node.function))
    if entry is None or entry.meaning.quantity not in FUNCTIONS or (node.sub or node.sup):
        return calculus.call(e, node)
    return _function_value(e, entry.meaning, e.value(node.argument), node.span)


def _function_value(e: Elaborator, meaning: Meaning, argument: Value, span: Span) -> Value:
    if meaning.quantity in TURNS:
        return turn(e, meaning, argument, span)
    return of_columns(e.lexicon.notation, meaning.quantity, argument, span)


def _of_coordinates(meaning: Meaning, body: Node) -> bool:
    """Return whether what stands in brackets are the variables of a matrix, letters alone."""
    inside = [seen(n) for n in (body.items if isinstance(body, Sequence) else (body,))]
    plain = all(i is not None and not i.raised for i in inside)
    return plain and (bool(meaning.of) or meaning.quantity in MATRICES)


_OF_VARIABLES = frozenset({"equals", "defined", "system"})
"""What letters behind a symbol in brackets, with commas between them, are the variables of."""


def _multiplies(e: Elaborator, node: Node, body: Any) -> bool:
    """Return whether a symbol is made of parameters alone, of others than those in brackets behind it."""
    model = e.lexicon.system
    still = () if model is None else tuple(q.name for q in model.system.parameters)
    try:
        atoms = atoms_in(e.value(node).term, e.scalars)
        listed = [atoms_in(e.value(item).term, e.scalars) for item in body.items]
    except Refusal:
        return False
    return (
        bool(atoms)
        and not all(a <= atoms for a in listed)
        and all(
            a.data[0] in _STILL or (a.data[0] == "system" and a.data[1] in still) for a in atoms
        )
    )


_STILL = frozenset({"scalar", "mass", "total_mass"})
"""Quantities that do not change."""


_OPERATORS: dict[str, Callable[..., Value]] = {
    "": beside,
    "dot": dotted,
    "cross": crossed,
    "wedge": crossed,
    "tensor": tensored,
    "circle": tensored,
    "circledot": tensored,
    "asterisk": lambda n, a, b: (tensored if is_quaternion(n, a) else beside)(n, a, b),
}


def _quotient(e: Elaborator, node: Quotient) -> Value:
    return quotient(e, e.value(node.left), e.value(node.right), node.span)


def _fraction(e: Elaborator, node: Fraction) -> Value:
    if isinstance(node.below, Differential):
        raise refuse(ILL_FORMED, "a derivative lacks its d above", node.span)
    return quotient(e, e.value(node.above), e.value(node.below), node.span)


# -- brackets and scripts ------------------------------------------------------------------------


def _group(e: Elaborator, node: Group) -> Value:
    if isinstance(node.body, Sequence):
        return calculus.bracket(e, node, node.body) or calculus.tuple_value(e, node, node.body)
    found = between_frames(e, node) or _tabled(e, node)
    if found is not None:
        return found
    if node.open == "[" and isinstance(node.body, Number) and node.body.text == "1":
        return _identity(e, node.span)
    value = _crossing(e, node.body) if isinstance(node.body, Section) else e.value(node.body)
    if node.open in {"|", "||"}:
        return _size(e, value, node.span)
    if node.open == "<":
        raise refuse(UNDECIDED, "angle brackets without a meaning", node.span)
    return value


def _tabled(e: Elaborator, node: Group) -> Value | None:
    """Return the matrix, or column, that a symbol with free indices in brackets stands for: (I_ij)."""
    found = seen(node.body) if node.open in {"(", "["} else None
    known = knows(e)
    if found is None or found.raised or is_known(e, found.look):
        return None
    letters = [w for w in found.look.sub if w in LETTERS and w not in e.indices]
    if not 0 < len(letters) == len(set(letters)) <= 2:
        return None
    if not known(found.look, dict.fromkeys(letters, "1")):
        return None
    rows = list(numberings(letters[:1], (node.body,), known))
    columns = list(numberings(letters[1:], (node.body,), known))
    cells = [[e.bound(**r, **c).value(node.body) for c in columns] for r in rows]
    return calculus.table_of(e, cells, node.span)


def _matrix(e: Elaborator, node: Matrix) -> Value:
    """Return a matrix, or what bars around it make of it."""
    value = calculus.matrix(e, node)
    return _size(e, value, node.span) if node.environment in {"vmatrix", "Vmatrix"} else value


def _identity(e: Elaborator, span: Span) -> Value:
    """Return what a 1 in square brackets is: the unit matrix, the unit dyadic where vectors stay such."""
    term = quantity("identity_matrix" if e.lexicon.notation.mixed else "identity")
    return Value(term, term.kind, NONE, ANY, span=span)


def _size(e: Elaborator, value: Value, span: Span) -> Value:
    """Return a magnitude, an absolute value, a determinant."""
    if value.shape == MATRIX:
        return determinant(value, span)
    if value.shape == SCALAR:
        return replace(value, term=expr(sp.Abs(e.expression(value.term))), span=span)
    if value.shape == TABLE and is_square(value):
        return determinant(value, span)
    if value.shape == TABLE:
        squared = square(value)
    elif value.shape not in {VECTOR, "column", "row"}:
        raise refuse(ILL_FORMED, "this has no magnitude", span, value.words)
    else:
        squared = (dot_product if value.shape == VECTOR else inner)(value.term, value.term)
    return Value(expr(sp.sqrt(e.name("size^2", squared))), SCALAR, value.dimension, span=span)


def _section(_: Elaborator, node: Section) -> Value:
    raise refuse(ILL_FORMED, "an operator without its second operand", node.span)


def _crossing(e: Elaborator, node: Section) -> Value:
    """Return the skew matrix that a cross in brackets makes: [a x]."""
    if node.operator != "cross" or not node.left:
        raise refuse(UNDECIDED, "an operator without an operand", node.span)
    return skew(e.lexicon.notation, e.value(node.operand), node.span)


def _upright(e: Elaborator, node: Scripts) -> Value | None:
    """Return the column of a transposed list, parted by commas, or numbers parted by space alone.

    Whatever the brackets, what lies on the line is a row, and its transpose a column.
    """
    group, above = node.base, node.sup
    if not isinstance(group, Group) or group.open not in {"(", "["} or node.sub is not None:
        return None
    if not isinstance(above, Symbol) or above.name not in TRANSPOSED:
        return None
    body = group.body
    values: list[Value] = []
    if isinstance(body, Sequence) and (group.open == "[" or len(body.items) <= calculus.ANY_VECTOR):
        values = [e.value(i) for i in body.items]
    elif isinstance(body, Product) and not body.operator and between_frames(e, group) is None:
        values = [v for v in _factors(e, body.factors) if v.shape == SCALAR]
        values = values if len(values) == len(body.factors) else []
    if len(values) < 2:
        return None
    return calculus.column_of(e, values, node.span)


def _scripts(e: Elaborator, node: Scripts) -> Value:
    short = subscripted(e, node)
    if short is not None:
        return e.value(short)
    power = _exponential(e, node)
    if power is not None:
        return power
    if seen(node) is not None:
        return _symbol(e, node)
    upright = _upright(e, node)
    if upright is not None:
        return upright
    inside = node.base.body if isinstance(node.base, Group) else None
    if isinstance(inside, Derivative) and inside.frame is None and node.presup is not None:
        return e.value(replace(node, base=replace(inside, frame=node.presup), presup=None))
    value = _lowered(e, node)
    if node.presub is not None or node.presup is not None:
        if node.presup is None or node.presub is not None:
            raise refuse(UNDECIDED, "a script on the left without a meaning", node.span)
        value = components(value, e.frame(node.presup))
    return value if node.sup is None else raised(e, value, node.sup, node.span)


def _exponential(e: Elaborator, node: Scripts) -> Value | None:
    """Return a power of the letter e where that means nothing else; None for marks and other letters."""
    plain = isinstance(node.base, Symbol) and node.base.name == "e" and not is_known(e, Look("e"))
    alone = node.sub is node.presub is node.presup is None
    if not plain or not alone or node.sup is None or isinstance(node.sup, Marks):
        return None
    found = seen(node)
    if found is not None and is_known(e, found.look):
        return None
    return e.value(Call("exp", node.sup, span=node.span))


def _lowered(e: Elaborator, node: Scripts) -> Value:
    """Return a bracket with what stands below it: a frame of components, or a cross."""
    if node.sub is None:
        return e.value(node.base)
    if labels(node.sub) == ("times",):
        return skew(e.lexicon.notation, e.value(node.base), node.span)
    frame = e.frame(node.sub)
    e = e.resolved(frame)
    body = _bracketed(node.base)
    if isinstance(body, Section) and body.operator == "cross" and body.left:
        return skew(e.lexicon.notation, components(e.value(body.operand), frame), node.span)
    return components(e.value(node.base), frame)


def _bracketed(node: Node) -> Node | None:
    """Return what stands in a bracket, or in a table of one cell."""
    if isinstance(node, Matrix) and len(node.rows) == len(node.rows[0]) == 1:
        return node.rows[0][0]
    return node.body if isinstance(node, Group) else None


def _accent(e: Elaborator, node: Accent) -> Value:
    if seen(node) is not None:
        return _symbol(e, node)
    notation = e.lexicon.notation
    if node.mark in DOTS:
        return overdot(notation, e.value(node.base), DOTS[node.mark], node.span)
    if node.mark in notation.skew:
        return skew(notation, e.value(node.base), node.span)
    if node.mark in notation.marks:
        return marked(e, e.value(node.base), node.mark, node.span)
    raise refuse(UNDECIDED, "an accent without a meaning", node.span, node.mark)


def _over(e: Elaborator, node: Over) -> Value:
    """Read a mark over a vector as one that is raised."""
    names = node.above.names if isinstance(node.above, Marks) else labels(node.above)
    if node.below is not None or any(n not in e.lexicon.notation.marks for n in names):
        raise refuse(UNDECIDED, "what stands above has no meaning", node.span, " ".join(names))
    value = e.value(node.base)
    for name in names:
        value = marked(e, value, name, node.span)
    return value


def _body(e: Elaborator, node: Any) -> Value:
    return e.value(node.body)


RULES: dict[type, Rule] = {
    Number: _number,
    Symbol: _symbol,
    Evaluated: _evaluated,
    Words: _words,
    Missing: _missing,
    Accent: _accent,
    Scripts: _scripts,
    Over: _over,
    Group: _group,
    Section: _section,
    Addition: _addition,
    Product: _product,
    Quotient: _quotient,
    Fraction: _fraction,
    Braced: _body,
    Boxed: _body,
    Struck: _body,
    Root: calculus.root,
    Call: _call,
    BigOperator: _big_operator,
    Integral: integrals.integral_value,
    Differential: calculus.differential,
    Cases: calculus.cases,
    Derivative: calculus.derivative,
    Matrix: _matrix,
}
"""One rule a kind of node; what is not here has no value."""


def in_brackets(members: Iterable[Node], e: Elaborator) -> list[Node]:
    """Return members with symbols that have free indices in brackets, where they are equated to tables."""
    members = list(members)
    tables = any(isinstance(n, Matrix) for m in members for n in walk(m))

    def bracketed(node: Node) -> Node:
        group = Group(node, "(", ")", span=node.span)
        return group if tables and seen(node) is not None and _tabled(e, group) else node

    return [bracketed(m) for m in members]
