"""A note with its lexicon: every formula with its claims, each read where it stands."""

from __future__ import annotations

import re
from dataclasses import dataclass

from eom.check.claims import Claim, claims, defined
from eom.check.documents import Document
from eom.check.lexicon import Lexicon
from eom.check.looks import Look
from eom.check.places import Source
from eom.check.reading import Formula, read_piece
from eom.check.statements import Statement
from eom.check.values import Value


@dataclass(frozen=True)
class Understood:
    """A formula with its claims, the lexicon that holds there, and the headings above it."""

    formula: Formula
    claims: tuple[Claim, ...]
    lexicon: Lexicon
    headings: tuple[str, ...]


def understand(document: Document, lexicon: Lexicon) -> tuple[Understood, ...]:
    """Return every formula of a document with its claims, in order.

    A display may continue the display before; what the note defines holds from there on.
    """
    found: list[Understood] = []
    headings: list[tuple[int, str]] = []
    scoped = _Scoped(lexicon)
    definitions: dict[Look, Value] = {}
    previous: tuple[Statement, ...] = ()
    before: tuple[Claim, ...] = ()
    for piece in document.pieces:
        if piece.kind == "heading":
            headings = [h for h in headings if h[0] < piece.level]
            headings.append((piece.level, piece.body.strip("# \n\t")))
        if not piece.is_formula:
            continue
        display = piece.kind == "display"
        formula = read_piece(piece, previous if display else ())
        titles = tuple(h[1] for h in headings)
        here = scoped.at(titles, piece.source, piece.span.start)
        new: list[Claim] = []
        for statement in formula.statements:
            made = claims(statement, here, definitions, (*(before if display else ()), *new))
            definitions |= defined(made)
            new += made
        if display:
            previous, before = formula.statements, tuple(new)
        found.append(Understood(formula, tuple(new), here, titles))
    return tuple(found)


class _Scoped:
    """A lexicon at every place; places with the same parts of the note share one."""

    def __init__(self, lexicon: Lexicon) -> None:
        self.lexicon = lexicon
        self.known: dict[tuple[tuple[str, ...], frozenset[str]], Lexicon] = {}
        self.begins: dict[tuple[int, str], int] = {}
        self.passed: set[str] = set()

    def at(self, headings: tuple[str, ...], source: Source, place: int) -> Lexicon:
        for scope in self.lexicon.scopes:
            if scope.after and self._begin(scope.after, source) <= place:
                self.passed.add(scope.after)
        key = (headings, frozenset(self.passed))
        if key not in self.known:
            self.known[key] = self.lexicon.at(headings, key[1])
        return self.known[key]

    def _begin(self, phrase: str, source: Source) -> int:
        key = (id(source), phrase)
        if key not in self.begins:
            pattern = r"\s+".join(re.escape(w) for w in phrase.split())
            match = re.search(pattern, source.text, re.IGNORECASE)
            self.begins[key] = match.end() if match else len(source.text) + 1
        return self.begins[key]
