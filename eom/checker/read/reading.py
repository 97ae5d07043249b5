"""All formulas of a document, read and split; what cannot be read carries its error."""

from __future__ import annotations

from dataclasses import dataclass

from eom.checker.read.documents import Document, Piece
from eom.checker.read.grammar import Reading, read_tokens
from eom.checker.read.places import ReadingError
from eom.checker.read.statements import Statement, split
from eom.checker.read.tokens import tokenize


@dataclass(frozen=True)
class Formula:
    """A formula of a document: its piece, and either its reading and statements or an error."""

    piece: Piece
    reading: Reading | None
    statements: tuple[Statement, ...] = ()
    error: ReadingError | None = None

    @property
    def relational(self) -> bool:
        """Whether it claims anything; what cannot be read counts if it shows a relation."""
        if self.reading is None:
            return any(sign in self.piece.body for sign in ("=", "<", ">", "\\eq", "\\to"))
        return any(s.relational for s in self.statements)


def read(document: Document) -> tuple[Formula, ...]:
    """Read all formulas of a document in order; a display may continue the one before."""
    found: list[Formula] = []
    previous: tuple[Statement, ...] = ()
    for piece in document.formulas:
        display = piece.kind == "display"
        formula = read_piece(piece, previous if display else ())
        found.append(formula)
        if display and formula.statements:
            previous = formula.statements
    return tuple(found)


def read_piece(piece: Piece, previous: tuple[Statement, ...] = ()) -> Formula:
    """Read one formula."""
    try:
        tokens = tokenize(piece.source, piece.body, piece.span.start, piece.macros)
        reading = read_tokens(piece.source, tokens)
    except ReadingError as error:
        return Formula(piece, None, (), error)
    tags = [text for text, _ in reading.tags]
    return Formula(piece, reading, split(reading.tree, previous, tags))
