"""New symbols by their first equation: where the words around a formula say so, within its heading."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from eom.checker.mean.claims import Claim, defined
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.roles import DEFINITION
from eom.checker.mean.values import Value
from eom.checker.read.documents import Piece
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import Sign
from eom.terms.terms import nodes

_LET = re.compile(r"\b(?:let|with (?:the|an?) [A-Za-z -]{2,40})\s*\$*$", re.IGNORECASE)
_AND = re.compile(r"^\s*\$*\s*,?\s*(?:and)?\s*\$*\s*$")


def brings(pieces: tuple[Piece, ...], number: int, role: str, last: bool) -> bool:
    """Tell whether words bring in the left side of a formula: where, let, with the mass m = ...

    ``last``: whether they do so for the formula before, which "and" goes on with.
    """
    before = pieces[number - 1] if number else None
    if role == DEFINITION or before is None or before.kind != "prose":
        return role == DEFINITION
    text = " ".join(before.body.split())
    return bool(_LET.search(text)) or (last and bool(_AND.match(text)))


def first(statement: Statement, lexicon: Lexicon) -> Statement | None:
    """Return an equation as a definition of its left side; None if the lexicon knows that."""
    if not statement.members or [s.name for s in statement.signs] != ["="]:
        return None
    given = seen(statement.members[0])
    if given is None or given.raised or given.dots or lexicon.find(given.look) is not None:
        return None
    sign: Sign = replace(statement.signs[0], name=":=")
    return replace(statement, signs=(sign,))


def says(found: Iterable[Claim]) -> bool:
    """Tell whether claims define something by quantities, not by numbers alone."""
    new = [c for c in found if c.defines is not None and c.members]
    atoms = (n for c in new for t in (c.members[0].term, *c.scalars.values()) for n in nodes(t))
    return any(n.head == "atom" for n in atoms)


@dataclass
class Named:
    """What words have brought in, each within its heading."""

    found: list[tuple[tuple[str, ...], Look, Value]] = field(default_factory=list)

    def at(self, headings: tuple[str, ...]) -> dict[Look, Value]:
        """Return what holds under some headings."""
        return {k: v for place, k, v in self.found if headings[: len(place)] == place}

    def add(self, headings: tuple[str, ...], claims: Iterable[Claim]) -> None:
        """Take in what claims define."""
        self.found += [(headings, look, value) for look, value in defined(claims).items()]
