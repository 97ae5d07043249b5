r"""Lines that only give a number: ``I_1 = 3``, ``\\theta = 30^\\circ``, ``M = 5\\,\\text{kg}``.

No motion tells whether they are right; a zero is no such number, as it says something of motions.
"""

from __future__ import annotations

from eom.checker.mean.dimensions import NONE
from eom.checker.mean.elaborator import Elaborator
from eom.checker.mean.values import ANY, Refusal
from eom.checker.read.looks import seen
from eom.checker.read.statements import Statement
from eom.checker.read.syntax import (
    Addition,
    Fraction,
    Group,
    Marks,
    Node,
    Number,
    Product,
    Quotient,
    Scripts,
    Symbol,
)


def given_number(s: Statement, e: Elaborator) -> bool:
    """Tell whether a statement gives a quantity with a dimension, or in degrees, by a number."""
    if len(s.members) != 2 or s.continues or s.signs[0].name not in {"=", "equiv", "approx"}:
        return False
    symbol, number = s.members
    if _is_number(symbol):
        symbol, number = number, symbol
    found = seen(symbol)
    if found is None or found.raised or not _is_number(number) or _is_zero(number):
        return False
    if _in_degrees(number) or any(w.startswith("[") for w in s.words):
        return True
    try:
        value = e.value(symbol)
    except Refusal:
        return False
    return value.dimension not in {None, NONE, ANY}


def _is_number(node: Node) -> bool:
    if isinstance(node, Number):
        return True
    if isinstance(node, Symbol):
        return node.name == "pi"
    if isinstance(node, Group):
        return _is_number(node.body)
    if isinstance(node, Addition):
        return all(map(_is_number, node.terms))
    if isinstance(node, Fraction | Quotient):
        return all(map(_is_number, _both(node)))
    if isinstance(node, Product):
        return all(map(_is_number, node.factors))
    if isinstance(node, Scripts) and node.sub is None:
        return _is_number(node.base) and (_degrees(node.sup) or _power(node.sup))
    return False


def _both(node: Fraction | Quotient) -> tuple[Node, Node]:
    return (node.above, node.below) if isinstance(node, Fraction) else (node.left, node.right)


def _power(node: Node | None) -> bool:
    return node is not None and _is_number(node)


def _degrees(node: Node | None) -> bool:
    return isinstance(node, Marks) and node.names == ("circ",)


def _in_degrees(node: Node) -> bool:
    return isinstance(node, Scripts) and _degrees(node.sup)


def _is_zero(node: Node) -> bool:
    return isinstance(node, Number) and float(node.text) == 0
