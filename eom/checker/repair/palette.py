"""What a note writes with: symbols, labels and marks that may have been meant at a place of it.

What rules of slips take and give: what a note writes with, and what may have been meant.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from eom.checker.judge.notes import Understood
from eom.checker.mean.lexicon import AXES, Lexicon
from eom.checker.read.grammar import read_formula
from eom.checker.read.paths import at, operands
from eom.checker.read.symbol_shape import Labels, labels, seen
from eom.checker.read.syntax import (
    BigOperator,
    Call,
    Derivative,
    Differential,
    Group,
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
from eom.checker.repair.lines import Line, valued
from eom.errors import InputError
from eom.terms.terms import COLUMN, INDICES, VECTOR

SYMBOLS = 40
"""Symbols of the note that are tried at most."""
NEAR, VECTORS = 10, 5
"""Factors around a line, and vectors, that are tried as lost ones at most."""


def palette(understood: Understood, line: Line) -> Palette:
    """Return what may have been meant in a line."""
    lexicon = understood.lexicon
    trees = list(around(understood))
    known = list(dict.fromkeys(n for t in trees for n in symbols(t)))
    own = [at(line.tree, m.path) for m in line.members if m.path is not None]
    factors = list(dict.fromkeys(f for t in own for f in _factors(t)))
    quantities = tuple(n for n in known if _is_quantity(n))[:SYMBOLS]
    return Palette(
        symbols=quantities,
        factors=tuple(factors)[:12],
        near=tuple(n for n in quantities if n not in factors)[:NEAR],
        vectors=tuple(n for n in quantities if _shape(line, n) in {VECTOR, COLUMN})[:VECTORS],
        omegas=tuple(n for n in known if _is_omega(lexicon, n))[:3],
        labels=tuple(_rows(lexicon, trees)),
        frames=tuple(_frames(lexicon, trees)),
        marks=_marks(lexicon, trees),
        skew=lexicon.notation.skew,
    )


def around(understood: Understood) -> Iterator[Node]:
    """Yield the trees of a note, the closest first, the line's own before all."""
    around = understood.around
    if understood.formula.reading is not None:
        yield understood.formula.reading.tree
    numbered = sorted(enumerate(around.trees), key=lambda kt: (abs(kt[0] - around.number), kt[0]))
    yield from (t for _, t in numbered[:40])
    for layer in understood.lexicon.layers:
        for entry in layer:
            if not entry.slots:
                try:
                    yield read_formula(entry.latex).tree
                except InputError:
                    continue


def symbols(tree: Node) -> Iterator[Node]:
    """Yield symbols with their accents and scripts, the outermost alone."""
    stack = [tree]
    while stack:
        node = stack.pop()
        if seen(node) is not None:
            yield node
        else:
            bound = isinstance(node, Scripts | Derivative | Integral | BigOperator | Differential)
            below = _inside(node) if bound else children(node)
            stack += reversed(below)


def _inside(node: Node) -> tuple[Node, ...]:
    return tuple(n for _, n in operands(node))


def _is_quantity(node: Node) -> bool:
    given = seen(node)
    return given is not None and given.look.name.isalpha() and not isinstance(node, Group)


def _shape(line: Line, node: Node) -> str:
    """Return the shape of a symbol, "" where it has no value."""
    value = valued(line.elaborator, node)
    return "" if value is None else value.shape


def _is_omega(lexicon: Lexicon, node: Node) -> bool:
    """Tell whether a symbol is an angular velocity as a vector, without dots."""
    given = seen(node)
    if given is None or given.dots:
        return False
    for look in (given.with_label(), given.look):
        found = lexicon.find(look) if look is not None else None
        if found is not None:
            whole = not found.meaning.component
            return found.meaning.quantity == "angular_velocity" and whole
    return False


def _factors(tree: Node) -> Iterator[Node]:
    """Yield what stands as a factor: symbols, numbers apart, functions, derivatives, brackets."""
    for node in walk(tree):
        if isinstance(node, Product | Quotient):
            parts = node.factors if isinstance(node, Product) else (node.left, node.right)
            yield from (p for p in parts if _is_factor(p))
    yield from (n for n in symbols(tree) if _is_quantity(n))


def _is_factor(node: Node) -> bool:
    return (_is_quantity(node) or isinstance(node, Call | Group | Derivative)) and not isinstance(
        node, Number
    )


def _marks(lexicon: Lexicon, trees: Iterable[Node]) -> tuple[str, ...]:
    """Return the raised marks of derivatives that the note uses."""
    used = {m for t in trees for n in walk(t) if isinstance(n, Marks) for m in n.names}
    return tuple(m for m in lexicon.notation.marks if m in used)


# -- labels --------------------------------------------------------------------------------------


def _rows(lexicon: Lexicon, trees: Iterable[Node]) -> Iterator[tuple[Node, ...]]:
    """Yield the labels of scripts that the note uses, those of one kind together."""
    leaves = dict.fromkeys(n for t in trees for n in _leaves(t))
    indices = {(name,): name for name in INDICES - {"dm"}}
    axes = {(name,): name for name in set(AXES) - {"1", "2", "3"}}
    for names in (lexicon.points, lexicon.frames, indices, axes):
        row = tuple(n for n in leaves if labels(n) in names)
        if len(row) > 1:
            yield row


def _leaves(tree: Node) -> Iterator[Node]:
    for node in walk(tree):
        if isinstance(node, Scripts):
            scripts = (node.sub, node.sup, node.presub, node.presup)
            for script in (s for s in scripts if s is not None):
                yield script
                yield from (n for n in walk(script) if isinstance(n, Symbol))


def _frames(lexicon: Lexicon, trees: list[Node]) -> list[Node]:
    """Return a label for each frame, as the note writes it: of derivatives first."""
    written = [n.frame for t in trees for n in walk(t) if isinstance(n, Derivative) and n.frame]
    written += [n for t in trees for n in _leaves(t)]
    return list(_named(lexicon.frames, written).values())[:4]


def _named(frames: Mapping[Labels, str], written: Iterable[Node]) -> dict[str, Node]:
    found: dict[str, Node] = {}
    for node in written:
        name = frames.get(labels(node))
        if name is not None:
            found.setdefault(name, node)
    for given, name in frames.items():
        if name not in found and len(given) == 1 and given[0].isalpha():
            found[name] = Symbol(given[0])
    return found


Offer = tuple[Node, float]
"""What may have been meant, and what is added to the weight of the slip."""


@dataclass(frozen=True)
class Palette:
    """What a note writes with: symbols and labels that may have been meant, the closest first.

    ``marks``: raised marks that are derivatives; ``skew``: accents of skew matrices; ``labels``: rows of
    labels that may stand for each other (points, frames, axes, indices); ``frames``: of derivatives;
    ``factors``: of the line itself; ``near``: others that stand around it; ``vectors``: of the line and
    around it; ``omegas``: angular velocities.
    """

    symbols: tuple[Node, ...] = ()
    factors: tuple[Node, ...] = ()
    near: tuple[Node, ...] = ()
    vectors: tuple[Node, ...] = ()
    omegas: tuple[Node, ...] = ()
    labels: tuple[tuple[Node, ...], ...] = ()
    frames: tuple[Node, ...] = ()
    marks: tuple[str, ...] = ()
    skew: tuple[str, ...] = ()
