r"""Symbols of a note's formulas: each with its line, what it looks like, and whether a lexicon knows it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

from eom.checker.infer.places import as_label
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.elaborator import FUNCTIONS, TRANSPOSED
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.values import Refusal
from eom.checker.read.damage import variants
from eom.checker.read.statements import Formula, Statement, split
from eom.checker.read.symbol_shape import Look, labels, seen
from eom.checker.read.syntax import (
    Derivative,
    Differential,
    Integral,
    Marks,
    Node,
    Number,
    Product,
    Quotient,
    Scripts,
    Symbol,
    children,
    walk,
)
from eom.checker.read.tokens import tokenize


def symbols(formulas: tuple[Formula, ...]) -> Iterator[tuple[Node, int]]:
    """Yield every symbol with its line, whole ones only."""
    for formula in formulas:
        for node in symbols_of(m for s in formula.statements for m in _members(s)):
            yield node, formula.piece.source.line_column(node.span.start)[0]


def symbols_of(nodes: Iterable[Node]) -> Iterator[Node]:
    """Yield the symbols of nodes, whole ones; the last node first."""
    stack = list(nodes)
    while stack:
        node = stack.pop()
        if seen(node) is not None:
            yield node
        elif not isinstance(node, Number):
            stack += reversed(operands(node))


def mended(formula: Formula) -> tuple[Statement, ...]:
    """Return the statements of a formula in the reading in which most that a scan damaged is mended."""
    if formula.reading is None:
        return ()
    piece = formula.piece
    tokens = tokenize(piece.source, piece.body, piece.span.start, piece.macros)
    found = variants(piece.source, tokens)
    return split(found[0].reading.tree) if found else ()


def symbols_in(formula: Formula) -> Iterator[Node]:
    """Yield the symbols of a formula, whole ones."""
    return (n for n, _ in symbols((formula,)))


def operands_of(formula: Formula, lexicon: Lexicon | None = None) -> Iterator[Look]:
    """Yield what the symbols of a formula look like, each as often as it stands.

    ``lexicon``: what is raised is a label of symbols that it knows with that.
    """
    return (k for n in symbols_in(formula) if (k := bare(n, lexicon)) is not None)


def _members(statement: Statement) -> list[Node]:
    """Return the members of a statement and of its conditions; a lone symbol of the text is none."""
    own = list(statement.members) if statement.relational else []
    return own + [m for _, c in statement.conditions for m in _members(c)]


def operands(node: Node) -> tuple[Node, ...]:
    """Return what of a node has a value: no variables and bounds of integrals, no labels."""
    if isinstance(node, Integral):
        return (node.integrand,) if node.integrand is not None else ()
    if isinstance(node, Derivative):
        return (node.operand,) if node.operand is not None else ()
    if isinstance(node, Differential):
        return ()
    out = [getattr(node, name, None) for name in ("lower", "upper", "sub")]
    above = getattr(node, "sup", None)
    out += [above] if isinstance(above, Symbol) and above.name in TRANSPOSED else []
    return tuple(c for c in children(node) if c not in out)


def bare(node: Node, lexicon: Lexicon | None = None) -> Look | None:
    """Return the look without dots and with a raised label only if it is one letter, or known as one."""
    found = seen(node)
    if found is None:
        return None
    raised = found.raised[0] if found.raised else None
    whole = found.with_label() if lexicon is not None and raised is not None else None
    if whole is not None and lexicon is not None:
        marked = raised is not None and lexicon.notation.marks.keys() >= set(labels(raised))
        if lexicon.find(whole) is not None or (primed(node) is not None and not marked):
            return whole
    labelled = isinstance(raised, Symbol) and raised.name not in {"T", "top", "t", "intercal"}
    vector = bool(found.look.accents or found.look.style)
    labelled |= vector and isinstance(raised, Quotient | Scripts) and not _numbers(raised)
    return found.with_label() if labelled else found.look


def has_dyads(formula: Formula) -> bool:
    """Return whether a vector stands beside itself in a formula, as in the dyadic of an inertia."""
    nodes = (n for s in formula.statements for m in s.members for n in walk(m))
    products = (n.factors for n in nodes if isinstance(n, Product) and not n.operator)
    pairs = (p for factors in products for p in pairwise(map(seen, factors)))
    return any(
        a is not None and b is not None and a == b and bool(a.look.accents or a.look.style)
        for a, b in pairs
    )


def _numbers(node: Node) -> bool:
    """Return whether numbers stand in what is raised: a power."""
    return any(isinstance(n, Number) for n in walk(node))


def primed(node: Node) -> Look | None:
    """Return the look of a symbol with primes as its label; None for one without."""
    found = seen(node)
    first = found.raised[0] if found is not None and found.raised else None
    prime = isinstance(first, Marks) and set(first.names) == {"prime"}
    return found.with_label() if found is not None and prime else None


def known(lexicon: Lexicon, node: Node) -> bool:
    """Return whether a lexicon gives a symbol a meaning, or it names a frame or a point."""
    look = bare(node, lexicon)
    names = {**lexicon.frames, **lexicon.points}
    marked = look is not None and bool(look.accents or look.style in {"bold", "sans"})
    if look is not None and (
        (not marked and as_label(look) in names) or look.name in {"infty", "bullet"}
    ):
        return True
    found = None if look is None else lexicon.find(look)
    if found is not None and found.meaning.quantity in FUNCTIONS:
        return True
    try:
        elaborator(lexicon).value(node)
    except Refusal:
        return False
    return True
