"""What the rules of elaboration share: lexicon, definitions of the note, names of scalars."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from eom import limits
from eom.checker.mean.dimensions import NONE, power, product
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.values import ILL_FORMED, UNDECIDED, Value, refuse, scalar
from eom.checker.read.spans import Span
from eom.checker.read.symbol_shape import Look, labels
from eom.checker.read.syntax import Node
from eom.terms.terms import SCALAR, Term, expr

MAX_DEPTH = 12
"""How far meanings may refer to other formulas."""

MAX_SIZE = 20_000
"""Most nodes of a term."""

Rule = Callable[["Elaborator", Any], Value]


@dataclass(frozen=True)
class Elaborator:
    """The state of one elaboration; ``scalars`` collects what the symbols of SymPy stand for.

    ``definitions``: what the note itself has defined so far; ``indices``: numbers and labels that
    stand for bound indices; ``rules``: one a kind of node.
    """

    lexicon: Lexicon
    rules: Mapping[type, Rule]
    definitions: Mapping[Look, Value] = field(default_factory=dict)
    indices: Mapping[str, str] = field(default_factory=dict)
    scalars: dict[Any, Term] = field(default_factory=dict)
    depth: int = 0
    sizes: dict[int, tuple[Term, int]] = field(default_factory=dict, repr=False)

    def value(self, node: Node) -> Value:
        """Return the typed value of a node. Raises `Refusal`."""
        limits.check()
        rule = self.rules.get(type(node))
        if rule is None:
            kind = type(node).__name__.lower()
            raise refuse(UNDECIDED, f"no meaning is known for this {kind}", node.span)
        found = rule(self, node)
        if self.size(found.term) > MAX_SIZE:
            raise refuse(UNDECIDED, "this is too large when it is written out", node.span)
        return found if found.span == node.span else replace(found, span=node.span)

    def size(self, term: Term) -> int:
        """Return how many nodes a term has when it is written out; shared parts are measured once."""
        known = self.sizes.get(id(term))
        if known is None:
            known = (term, 1 + sum(self.size(a) for a in term.args))
            self.sizes[id(term)] = known
        return known[1]

    def bound(self, **indices: str) -> Elaborator:
        """Return the elaborator where some indices stand for something else."""
        return replace(self, indices={**self.indices, **indices})

    def resolved(self, frame: str) -> Elaborator:
        """Return the elaborator inside a bracket of components: vectors beside columns are in its frame."""
        notation = self.lexicon.notation
        if notation.mixed in {"", frame}:
            return self
        return replace(self, lexicon=replace(self.lexicon, notation=replace(notation, mixed=frame)))

    def frame(self, node: Node) -> str:
        """Return the frame that a script names. Raises `Refusal` for unknown ones."""
        name = self.lexicon.frame(labels(node))
        if name is None:
            raise refuse(UNDECIDED, "unknown frame", node.span, "".join(labels(node)))
        return name

    def name(self, text: str, term: Term) -> Any:
        """Return the SymPy symbol that stands for a scalar term, named ``text`` where that is free."""
        symbol, count = sp.Symbol(text, real=True), 1
        while self.scalars.get(symbol, term) != term:
            count += 1
            symbol = sp.Symbol(f"{text}'{count}", real=True)
        self.scalars[symbol] = term
        return symbol

    def expression(self, term: Term) -> Any:
        """Return a scalar term as a SymPy expression; parts that are none get names."""
        if term.head == "expr":
            return term.data[0]
        if term.head == "zero":
            return sp.Integer(0)
        if term.head in {"mul", "add"} and all(a.kind == SCALAR for a in term.args):
            join = sp.Mul if term.head == "mul" else sp.Add
            return join(*(self.expression(a) for a in term.args))
        known = next((s for s, t in self.scalars.items() if t == term), None)
        return known or self.name(self._text(term), term)

    def _text(self, term: Term) -> str:
        inside = term.args[0] if term.head == "der" else None
        if inside is not None and inside.kind == SCALAR:
            rest = self.expression(inside)
            return f"{rest}_dot" if rest.is_Symbol else "rate"
        return "_".join(term.data) if term.head == "atom" else "s"


def quotient(e: Elaborator, above: Value, below: Value, span: Span) -> Value:
    """Return a value divided by a scalar."""
    if below.shape != SCALAR:
        raise refuse(ILL_FORMED, "a divisor is a scalar", below.span, below.words)
    divisor = e.expression(below.term)
    if divisor == 0:
        raise refuse(ILL_FORMED, "a division by zero", below.span)
    dimension = product(above.dimension, power(below.dimension, -1))
    return replace(
        above,
        term=expr(1 / divisor) * above.term,
        dimension=dimension,
        density=above.density - below.density,
        span=span,
    )


def number(value: Any, span: Span) -> Value:
    """Return a pure number."""
    return scalar(expr(value), NONE, span)
