"""Spans of a source text, with lines and columns, and the error that shows its span by a caret."""

from __future__ import annotations

import bisect
from dataclasses import dataclass, field
from typing import NamedTuple

from eom.errors import InputError

SHOWN = 60
"""Most characters that are shown on either side of a place."""
_LABEL = 12
"""Width of what `InputError` writes before the first line of a part."""


class Span(NamedTuple):
    """Offsets of the first character and of the one after the last."""

    start: int
    stop: int

    def join(self, other: Span) -> Span:
        """Return the smallest span that holds both.

        Parameters
        ----------
        other : Span
            The other one; `NOWHERE` adds nothing.

        Returns
        -------
        Span
            From the smaller start to the larger end.
        """
        if other == NOWHERE:
            return self
        if self == NOWHERE:
            return other
        return Span(min(self.start, other.start), max(self.stop, other.stop))


NOWHERE = Span(-1, -1)


@dataclass(frozen=True)
class Source:
    """A decoded ``text`` with a name for messages: a file, a cell of a notebook, the command line."""

    text: str
    name: str = ""
    _starts: tuple[int, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        starts = [0, *(k + 1 for k, c in enumerate(self.text) if c == "\n")]
        object.__setattr__(self, "_starts", tuple(starts))

    def line_column(self, offset: int) -> tuple[int, int]:
        """Return line and column of a place.

        Parameters
        ----------
        offset : int
            In characters, from the beginning.

        Returns
        -------
        tuple of int, int
            Both counted from 1.
        """
        offset = min(max(offset, 0), len(self.text))
        line = bisect.bisect_right(self._starts, offset)
        return line, offset - self._starts[line - 1] + 1

    def place(self, span: Span) -> str:
        """Return a place in words.

        Parameters
        ----------
        span : Span
            Of the source.

        Returns
        -------
        str
            Name, line and column.
        """
        line, column = self.line_column(span.start)
        return ", ".join(p for p in (self.name, f"line {line}, column {column}") if p)

    def shown(self, span: Span) -> tuple[str, int, int]:
        """Return the line around a place, cut to what can be shown, and where carets go in it.

        Parameters
        ----------
        span : Span
            Of the source.

        Returns
        -------
        tuple of str, int, int
            The line, cut to what can be shown, and where carets begin and end in it.
        """
        start = min(max(span.start, 0), len(self.text))
        first = self.text.rfind("\n", 0, start) + 1
        last = self.text.find("\n", start)
        last = len(self.text) if last < 0 else last
        left, right = max(first, start - SHOWN), min(last, start + SHOWN)
        width = max(1, min(span.stop, right) - start)
        return printable(self.text[left:right]), start - left, width

    def caret(self, span: Span, indent: int = 0) -> str:
        """Return two lines: the text around a place, and carets under it.

        Parameters
        ----------
        span : Span
            Of the source.
        indent : int, default 0
            So many spaces in.

        Returns
        -------
        str
            Without a line's end behind the second.
        """
        text, column, width = self.shown(span)
        return f"{text}\n{' ' * (indent + column)}{'^' * width}"


def printable(text: str) -> str:
    """Replace what a terminal would act on, or cannot be encoded; the length stays."""
    return "".join(c if c.isprintable() else " " for c in text)


class ReadingError(InputError):
    """Say what of a text cannot be read, and where; ``span`` is the place in its source, on ``line``."""

    span: Span = NOWHERE
    line: int = 0


def reading_error(
    source: Source, span: Span, what: str, *, expected: object = "", hint: str = ""
) -> ReadingError:
    """Return the error at a place: line and column, and the line itself with a caret."""
    error = ReadingError(
        what,
        where=source.place(span),
        got=source.caret(span, _LABEL),
        expected=expected,
        hint=hint,
    )
    error.span = span
    error.line = source.line_column(span.start)[0]
    return error
