"""Slips in signs, numbers and powers, in terms, factors and their order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from eom.checker.read.looks import seen
from eom.checker.read.paths import NOTHING
from eom.checker.read.syntax import (
    Addition,
    Braced,
    Call,
    Derivative,
    Fraction,
    Group,
    Integral,
    Matrix,
    Node,
    Number,
    Product,
    Quotient,
    Root,
    Scripts,
    Section,
)
from eom.checker.repair.offers import Offer, Palette
from eom.checker.repair.slips_marks import without_sup

# -- signs, numbers, powers ------------------------------------------------------------------------


def signs(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer another sign of a term or of an entry."""
    if isinstance(node, Addition):
        for k, sign in enumerate(node.signs):
            new = "-" if sign in {"", "+"} else "+" if k else ""
            yield replace(node, signs=(*node.signs[:k], new, *node.signs[k + 1 :])), 0.0
    if isinstance(node, Matrix):
        for r, row in enumerate(node.rows):
            for c, cell in enumerate(row):
                if not isinstance(cell, Addition) and cell != Number("0"):
                    minus = Addition((cell,), ("-",), span=cell.span)
                    new_row = (*row[:c], minus, *row[c + 1 :])
                    yield replace(node, rows=(*node.rows[:r], new_row, *node.rows[r + 1 :])), 0.0


HALF = Fraction(Number("1"), Number("2"))
_FACTORS: tuple[tuple[Node, float], ...] = ((HALF, 0.0), (Number("2"), 0.0), (Number("3"), 0.5))


def missing_number(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a half, two or three as a factor."""
    plain = isinstance(node, Product) and not isinstance(node.factors[0], Number | Fraction)
    other = isinstance(node, Integral | Derivative) or seen(node) is not None
    if plain or (other and not isinstance(node, Number)):
        for factor, extra in _FACTORS:
            loose = isinstance(node, Product) and node.operator
            body = (factor, node) if not loose else (factor, *_first_of(node))
            if loose and isinstance(node, Product):
                yield replace(node, factors=(Product(body[:2]), *node.factors[1:])), extra
            else:
                yield Product(body, span=node.span), extra


def _first_of(node: Node) -> tuple[Node, ...]:
    return node.factors[:1] if isinstance(node, Product) else (node,)


_SWAPPED = {"1": ("2", "0"), "2": ("1", "3"), "3": ("1", "2"), "4": ("2",), "0": ("1",)}


def other_number(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer another number."""
    if isinstance(node, Number):
        for text in _SWAPPED.get(node.text, ()):
            yield replace(node, text=text), 0.2
    below = node.below if isinstance(node, Fraction) and isinstance(node.above, Number) else None
    if isinstance(below, Number):
        yield Number(below.text, span=node.span), 0.1


_POWERS = {"2": ("3", "4"), "3": ("2", "4", "5"), "4": ("2", "3"), "5": ("3", "4")}


def exponent(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer another exponent, one more or none."""
    if isinstance(node, Scripts) and isinstance(node.sup, Number):
        for text in _POWERS.get(node.sup.text, ()):
            yield replace(node, sup=Number(text, span=node.sup.span)), 0.0
        yield without_sup(node), 0.0
        return
    bare = seen(node) is not None and not (isinstance(node, Scripts) and node.sup is not None)
    if (bare or (isinstance(node, Group) and node.open == "(")) and not isinstance(node, Number):
        base = node if isinstance(node, Scripts) else Scripts(node, span=node.span)
        yield replace(base, sup=Number("2")), 0.0
    if isinstance(node, Call):
        if node.sup is None:
            yield replace(node, sup=Number("2")), 0.0
        elif node.sup == Number("2"):
            yield replace(node, sup=None), 0.0
    if isinstance(node, Root):
        yield node.body, 0.2


_TRIG = {"sin": ("cos",), "cos": ("sin",), "tan": ("sin", "cos", "cot")}


def functions(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer sine for cosine, and so on."""
    if isinstance(node, Call):
        for name in _TRIG.get(node.function, ()):
            yield replace(node, function=name), 0.0


# -- terms and factors -----------------------------------------------------------------------------


def superfluous_term(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a sum without one of its terms."""
    if isinstance(node, Addition) and len(node.terms) > 1:
        for k in range(len(node.terms)):
            yield replace(node, terms=(*node.terms[:k], NOTHING, *node.terms[k + 1 :])), 0.0


_PLAIN = -0.35
"""What it weighs less to leave out a number than any other factor."""


def _is_number(node: Node) -> bool:
    if isinstance(node, Fraction):
        return isinstance(node.above, Number) and isinstance(node.below, Number)
    return isinstance(node, Number)


def superfluous_factor(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a product without one of its factors."""
    if isinstance(node, Product):
        for k, factor in enumerate(node.factors):
            extra = _PLAIN if _is_number(factor) else 0.0
            rest = (*node.factors[:k], NOTHING, *node.factors[k + 1 :])
            yield replace(node, factors=rest), extra
    if isinstance(node, Fraction):
        yield node.above, 0.3
    if isinstance(node, Call) and isinstance(node.argument, Node):
        yield NOTHING, 0.4


def missing_factor(node: Node, palette: Palette) -> Iterator[Offer]:
    """Put a factor of the line before, between or behind those of a product."""
    if isinstance(node, Number | Addition | Matrix):
        return
    juxtaposed = isinstance(node, Product) and not node.operator
    if not juxtaposed and (isinstance(node, Product) or not _factor_like(node)):
        return
    factors = node.factors if isinstance(node, Product) else (node,)
    for new in palette.factors:
        for k in range(len(factors) + 1):
            yield Product((*factors[:k], new, *factors[k:]), span=node.span), 0.0
    for new in palette.near:
        for k in sorted({0, len(factors)}):
            yield Product((*factors[:k], new, *factors[k:]), span=node.span), 0.3


def _factor_like(node: Node) -> bool:
    return seen(node) is not None or isinstance(node, Group | Call | Derivative | Integral)


def missing_cross(node: Node, palette: Palette) -> Iterator[Offer]:
    """Put ``omega x`` of the line before a vector."""
    whole = isinstance(node, Product) and not node.operator
    if seen(node) is not None or isinstance(node, Group) or whole:
        for new in palette.omegas:
            if new != node:
                yield Product((new, node), "cross", span=node.span), 0.0
                yield Group(Product((new, node), "cross"), span=node.span), 0.1


_VECTOR_LIKE = (Group, Derivative, Integral, Braced)


def missing_vector(node: Node, palette: Palette) -> Iterator[Offer]:
    """Put a vector of the line before another one or behind it, with a cross or a dot between."""
    whole = isinstance(node, Product) and node.operator in {"", "cross"}
    if not whole and not (seen(node) is not None or isinstance(node, _VECTOR_LIKE)):
        return
    body = Group(node, span=node.span) if isinstance(node, Product) and node.operator else node
    alone = seen(node) is not None or isinstance(node, Group)
    for rank, new in enumerate(n for n in palette.vectors if n != node):
        for pair in ((new, body), (body, new)):
            crossed = Product(pair, "cross", span=node.span)
            yield Group(crossed) if alone else crossed, 0.01 * rank
            yield Product(pair, "dot", span=node.span), 0.1 + 0.01 * rank
        yield Product((Product((HALF, new)), body), "dot", span=node.span), 0.3 + 0.01 * rank


def order(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer two neighbours of a product exchanged."""
    if isinstance(node, Product) and node.operator in {"", "cross", "tensor"}:
        for k in range(len(node.factors) - 1):
            a, b = node.factors[k : k + 2]
            yield replace(node, factors=(*node.factors[:k], b, a, *node.factors[k + 2 :])), 0.0


def operator(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer another product."""
    swapped = {"dot": ("cross", ""), "cross": ("dot", ""), "": ()}
    if isinstance(node, Product):
        for other in swapped.get(node.operator, ()):
            yield replace(node, operator=other), 0.2 if not other else 0.0
        if not node.operator and len(node.factors) >= 2:
            for k in range(1, len(node.factors)):
                left, right = (_joined(p) for p in (node.factors[:k], node.factors[k:]))
                for operator in ("cross", "dot"):
                    yield Product((left, right), operator, span=node.span), 0.1
    if isinstance(node, Section):
        yield node.operand, 0.0
    if isinstance(node, Group) and node.open == "[" and not isinstance(node.body, Section):
        yield replace(node, body=Section(node.body, "cross", span=node.body.span)), 0.0


def _joined(factors: tuple[Node, ...]) -> Node:
    return factors[0] if len(factors) == 1 else Product(factors)


def upside_down(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a fraction upside down."""
    if isinstance(node, Fraction):
        yield replace(node, above=node.below, below=node.above), 0.0
    if isinstance(node, Quotient):
        yield replace(node, left=node.right, right=node.left), 0.0
