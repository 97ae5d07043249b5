r"""A statement with vectors as a whole: what it says with one of its parts changed.

Its components have slips that are none of it, a sign in one of three: what a slip may be in is what is
written, a term, a factor, a letter.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import Any, Protocol

from eom.checker.consequence.jets import Equal
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import (
    Addition,
    Derivative,
    Fraction,
    Group,
    Matrix,
    Node,
    Number,
    Product,
    Quotient,
    Root,
    Symbol,
    children,
    transform,
)
from eom.checker.read.writing import latex


class Reader(Protocol):
    """How a statement is read."""

    def linked(self, statement: Statement, claim: int, link: int) -> tuple[Equal, ...]:
        """Return the components of one of the links of one of the claims of a statement."""

    def is_entry(self, name: str) -> bool:
        """Return whether a letter is an entry of a column or matrix of any size."""


FACTOR = Look("slipfactor")
"""A letter that no note has, by which a part is multiplied."""
MAX_PARTS = 40
_OPEN = (Addition, Product, Fraction, Group, Root, Matrix, Quotient, Derivative)


@dataclass(frozen=True)
class Whole:
    """A claim of a statement, one of its links, one of its components; ``letters``: how it is read."""

    letters: Reader
    statement: Statement
    claim: int
    link: int = 0
    cell: int = 0
    memo: dict[Any, Any] = field(default_factory=dict, compare=False, repr=False)

    @property
    def equations(self) -> tuple[Equal, ...]:
        """All components of the link."""
        if self.link not in self.memo:
            self.memo[self.link] = self._read(self.statement)
        found: tuple[Equal, ...] = self.memo[self.link]
        return found

    def is_entry(self, name: str) -> bool:
        """Return whether a letter is an entry of a column or matrix of any size."""
        return self.letters.is_entry(name)

    def scaled(self) -> Iterator[tuple[str, tuple[Equal, ...]]]:
        """Yield parts in LaTeX, and the components with a factor at them."""
        key = ("scaled", self.link)
        if key not in self.memo:
            self.memo[key] = list(self._scaled())
        yield from self.memo[key]

    def _scaled(self) -> Iterator[tuple[str, tuple[Equal, ...]]]:
        for member, part in islice(self._parts(), MAX_PARTS):
            factor = Symbol(FACTOR.name, span=part.span)
            new = Product((factor, Group(part, "", "", span=part.span)), span=part.span)
            found = self._read(self._put(member, part, new))
            if found:
                yield latex(part), found

    def _put(self, member: int, part: Node, new: Node) -> Statement:
        members = list(self.statement.members)
        members[member] = transform(members[member], lambda n: new if n is part else n)
        return replace(self.statement, members=tuple(members))

    def _parts(self) -> Iterator[tuple[int, Node]]:
        """Yield the parts of the two sides with the numbers of these, no numbers."""
        for member in (self.link, self.link + 1):
            if member >= len(self.statement.members):
                continue
            todo: list[Node] = [self.statement.members[member]]
            while todo:
                node = todo.pop(0)
                if isinstance(node, Number):
                    continue
                if not isinstance(node, Group):
                    yield member, node
                if isinstance(node, _OPEN) and seen(node) is None:
                    inner = node.operand if isinstance(node, Derivative) else node
                    todo += children(inner) if inner is not None else ()

    def _read(self, statement: Statement) -> tuple[Equal, ...]:
        return self.letters.linked(statement, self.claim, self.link)
