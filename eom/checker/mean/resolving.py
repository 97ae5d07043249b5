r"""New symbols as the components of a known vector: ``\vec\omega = p \hat b_1 + q \hat b_2 + r \hat b_3``.

All three of them are new; a column or a list of three does as well.
"""

from __future__ import annotations

from dataclasses import dataclass

from eom.checker.mean.elaborator import Elaborator
from eom.checker.mean.symbols import TRANSPOSED
from eom.checker.mean.values import Refusal, Value, basis
from eom.checker.read.looks import Look, labels, seen
from eom.checker.read.places import Span
from eom.checker.read.statements import Statement
from eom.checker.read.syntax import Addition, Group, Matrix, Node, Product, Scripts, Sequence
from eom.terms.terms import COLUMN, SCALAR, VECTOR, Term, dot, inner
from eom.terms.vocabulary import unit


@dataclass(frozen=True)
class Component:
    """A new symbol, what it stands for, and its place."""

    look: Look
    value: Value
    span: Span


def resolved(s: Statement, e: Elaborator) -> tuple[Component, ...]:
    """Return the three symbols that a statement brings in as components; none if it does not."""
    if len(s.members) != 2 or s.continues or s.signs[0].name not in {"=", ":=", "=:", "equiv"}:
        return ()
    left, right = s.members
    return _resolved(left, right, e) or _resolved(right, left, e)


def _resolved(known: Node, spelt: Node, e: Elaborator) -> tuple[Component, ...]:
    symbols, frame = _listed(spelt), ""
    if not symbols:
        symbols, frame = _summed(spelt, e)
    looks = [_unknown(n, e) for n in symbols]
    if len(looks) != 3 or None in looks or len(set(looks)) != 3:
        return ()
    try:
        value = e.value(known)
    except Refusal:
        return ()
    frame = frame or e.lexicon.notation.mixed
    terms = _terms(value, frame)
    return tuple(
        Component(look, Value(term, SCALAR, value.dimension, span=n.span), n.span)
        for look, term, n in zip(looks, terms, symbols, strict=False)
        if look is not None
    )


def _terms(value: Value, frame: str) -> tuple[Term, ...]:
    """Return the components of a vector in a frame, or of a column; none of anything else."""
    if value.shape == VECTOR and frame:
        return tuple(dot(unit(frame, k), value.term) for k in (1, 2, 3))
    return tuple(inner(value.term, basis(k)) for k in (1, 2, 3)) if value.shape == COLUMN else ()


def _unknown(node: Node, e: Elaborator) -> Look | None:
    """Return the look of a symbol without a meaning."""
    found = seen(node)
    if found is None or found.dots or found.raised:
        return None
    look = e.lexicon.notation.plain(found.look)
    known = e.lexicon.find(look, e.indices) is not None or look in e.definitions
    return None if known else look


def _listed(node: Node) -> tuple[Node, ...]:
    """Return the entries of a column or a list of three."""
    if isinstance(node, Scripts) and labels(node.sup) and set(labels(node.sup)) <= TRANSPOSED:
        node = node.base
    if isinstance(node, Group) and node.open in {"(", "[", "{"}:
        node = node.body
    if isinstance(node, Sequence):
        return node.items if len(node.items) == 3 else ()
    if isinstance(node, Matrix):
        cells = tuple(c for row in node.rows for c in row)
        return cells if len(cells) == 3 and 1 in {len(node.rows), len(node.rows[0])} else ()
    return ()


def _summed(node: Node, e: Elaborator) -> tuple[tuple[Node, ...], str]:
    """Return the symbols before the unit vectors of a frame, in their order, and the frame."""
    if not isinstance(node, Addition) or len(node.terms) != 3 or set(node.signs) - {"", "+"}:
        return (), ""
    found: dict[str, Node] = {}
    frames = set()
    for term in node.terms:
        pair = _term(term, e)
        if pair is None:
            return (), ""
        symbol, (frame, axis) = pair
        found[axis] = symbol
        frames.add(frame)
    whole = sorted(found) == ["1", "2", "3"] and len(frames) == 1
    return (tuple(found[k] for k in sorted(found)), frames.pop()) if whole else ((), "")


def _term(node: Node, e: Elaborator) -> tuple[Node, tuple[str, str]] | None:
    """Return the symbol of a term, and frame and axis of its unit vector."""
    if not isinstance(node, Product) or node.operator or len(node.factors) != 2:
        return None
    for symbol, vector in (node.factors, node.factors[::-1]):
        try:
            term = e.value(vector).term
        except Refusal:
            continue
        if term.head == "atom" and term.data[0] == "unit":
            return symbol, (term.data[1], term.data[2])
    return None
