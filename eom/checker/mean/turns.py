r"""Attitude in formulas: elementary rotations ``C_3(\psi)``, and ``c\theta`` for cosines."""

from __future__ import annotations

from eom.checker.mean.dimensions import NONE
from eom.checker.mean.elaborator import Elaborator
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.meanings import Meaning
from eom.checker.mean.symbols import pure
from eom.checker.mean.values import Value
from eom.checker.read.places import Span
from eom.checker.read.symbol_shape import Look, labels, seen
from eom.checker.read.syntax import (
    Call,
    Fraction,
    Group,
    Node,
    Number,
    Product,
    Quotient,
    Scripts,
    Symbol,
)
from eom.kinematics.coordinates import elementary
from eom.terms.terms import MATRIX, entries
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
    if found is not None and _known(e, found.look):
        return None
    argument = _numbered(e.lexicon, node.sub) if isinstance(node.sub, Number) else node.sub
    if argument is None or not _is_angle(e.lexicon, argument):
        return None
    return Call(name, argument, sup=node.sup, span=node.span)


def _function(e: Elaborator, node: Node) -> str:
    if not isinstance(node, Symbol) or node.style not in {"", "roman"}:
        return ""
    return "" if _known(e, Look(node.name)) else _FUNCTIONS.get(node.name, "")


def _known(e: Elaborator, look: Look) -> bool:
    return e.lexicon.find(look, e.indices) is not None or look in e.definitions


def _is_angle(lexicon: Lexicon, node: Node) -> bool:
    """Tell whether the lexicon says that this is an angle, or half of one."""
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
