"""The state of the parser: a cursor over tokens, the depth of nesting, notes, errors with places."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from eom.checker.read import latex
from eom.checker.read.spans import ReadingError, Source, Span, reading_error
from eom.checker.read.syntax import Node
from eom.checker.read.tokens import Token, spelling
from eom.errors import near_matches

MAX_DEPTH = 30
"""Deepest nesting of brackets, scripts and prefixes; a level takes up to a dozen calls."""


@dataclass(frozen=True)
class Note:
    """A place that could be meant otherwise, or is not usual: name of the kind, and what was read."""

    name: str
    text: str
    span: Span


class Stream(ABC):
    """Tokens with a cursor; the grammar fills in the abstract parts."""

    def __init__(self, source: Source, tokens: list[Token]) -> None:
        self.source = source
        self.tokens = tokens
        self.place = 0
        self.depth = 0
        self.notes: list[Note] = []
        self.integrals = 0
        """Open integrals whose differential may follow at this level of brackets."""
        self.bars: list[str] = []
        """Open bars at this level of brackets."""
        self.script = False
        """Whether this level is a script."""

    # what the grammar does

    @abstractmethod
    def statements(self) -> Node:
        """Read all that may stand within brackets or a cell."""

    @abstractmethod
    def addition(self) -> Node:
        """Read a sum of terms."""

    @abstractmethod
    def term(self) -> Node:
        """Read a product with all its operators."""

    @abstractmethod
    def run(self) -> Node:
        """Read factors side by side."""

    @abstractmethod
    def factor(self) -> Node:
        """Read one factor, prefix forms included."""

    @abstractmethod
    def scripted(self) -> Node:
        """Read an atom with its scripts."""

    @abstractmethod
    def atom(self) -> Node:
        """Read an atom without scripts."""

    @abstractmethod
    def starts_atom(self) -> bool:
        """Whether the token at the cursor can begin a factor."""

    @abstractmethod
    def argument(self) -> Node:
        """Read an argument: a group in braces, or a single atom."""

    @abstractmethod
    def script_argument(self) -> Node:
        """Read what stands in a script."""

    # the cursor

    @property
    def token(self) -> Token:
        """The token at the cursor."""
        return self.tokens[self.place]

    def ahead(self, count: int = 1) -> Token:
        """Return a token further on; the last one is "stop"."""
        return self.tokens[min(self.place + count, len(self.tokens) - 1)]

    def take(self) -> Token:
        """Pass over the token at the cursor and return it."""
        token = self.token
        if token.kind == "stop":
            raise self.error("the formula ends where something is missing", token)
        self.place += 1
        return token

    def accept(self, text: str) -> bool:
        """Pass over a character if it stands here."""
        found = self.token.is_char(text)
        self.place += found
        return found

    def expect(self, text: str, opened: Token | None = None) -> Token:
        """Pass over a character that must stand here; ``opened`` is what it closes."""
        if not self.token.is_char(text):
            where = f", opened in {self.source.place(opened.span)}" if opened else ""
            raise self.error(f"'{text}' is missing here{where}")
        return self.take()

    def closes(self) -> bool:
        """Whether a level of brackets, a cell or the formula ends here."""
        token = self.token
        return (
            token.kind in {"stop", "row", "end"}
            or (token.kind == "char" and token.text in ")]}&")
            or token.is_command("right", "middle", "rangle", "}", "rvert", "rVert", "rbrace")
            or (bool(self.bars) and self.bar(token) == self.bars[-1])
        )

    def bar(self, token: Token) -> str:
        """Return "|" or "||" for a vertical bar, else ""."""
        if token.is_char("|") or token.is_command("vert"):
            return "|"
        return "||" if token.is_command("|", "Vert") else ""

    def since(self, start: Span) -> Span:
        """Return the span from a place to the token before the cursor."""
        return start.join(self.tokens[max(self.place - 1, 0)].span)

    def digit(self) -> Token:
        """Take a token as LaTeX takes an argument without braces: of a number its first digit."""
        token = self.token
        if token.kind != "number" or len(token.text) == 1 or token.text[0] == ".":
            return self.take()
        whole = token.span.stop - token.span.start == len(token.text)
        cut = token.span.start + 1 if whole else token.span.stop
        rest = Span(cut, token.span.stop) if whole else token.span
        self.tokens[self.place] = replace(token, text=token.text[1:], span=rest, spaced=False)
        return replace(token, text=token.text[0], span=Span(token.span.start, cut))

    def matching(self, place: int) -> int:
        """Return the place behind the argument that begins at ``place``: a group or one token."""
        if not self.tokens[place].is_char("{"):
            return min(place + 1, len(self.tokens) - 1)
        depth = 0
        for k in range(place, len(self.tokens)):
            token = self.tokens[k]
            if token.kind == "char":
                depth += (token.text == "{") - (token.text == "}")
                if depth == 0:
                    return min(k + 1, len(self.tokens) - 1)
        return len(self.tokens) - 1

    # nesting

    @contextmanager
    def nested(self, *, fresh: bool = True, script: bool = False) -> Iterator[None]:
        """Go one level deeper; ``fresh``: within brackets of its own."""
        if self.depth >= MAX_DEPTH:
            raise self.error(f"the formula is nested more than {MAX_DEPTH} deep")
        saved = self.integrals, self.bars, self.script
        self.depth += 1
        if fresh:
            self.integrals, self.bars, self.script = 0, [], script
        try:
            yield
        finally:
            self.depth -= 1
            self.integrals, self.bars, self.script = saved

    # messages

    def note(self, name: str, text: str, span: Span) -> None:
        """Remember something about a place."""
        self.notes.append(Note(name, text, span))

    def error(
        self, what: str, token: Token | None = None, *, hint: str = "", expected: str = ""
    ) -> ReadingError:
        """Return the error at a token, by default the next one."""
        at = token or self.token
        return reading_error(self.source, at.span, what, hint=hint, expected=expected)

    def unread(self) -> ReadingError:
        """Return the error for a token that nothing reads."""
        token = self.token
        if token.kind == "stop":
            return self.error("the formula ends where something is missing")
        if token.kind == "command" and token.text not in latex.KNOWN:
            hint = near_matches(token.text, latex.KNOWN) or "define it, or write it out"
            return self.error(rf"unknown command \{token.text}", hint=hint)
        shown = spelling([token]) or token.kind
        return self.error(f"{shown!r} cannot be read here")
