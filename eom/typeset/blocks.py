"""What a page consists of: headings, words, lists, equations, steps; and where a long equation breaks.

`eom.typeset.pages` writes blocks in each format.

What objects show of themselves: each kind is registered by the module that writes or draws it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from typing import Any

from eom.typeset.boxes import Box, Operator, Row
from eom.typeset.breaking import Measure, chunks
from eom.typeset.markup import width
from eom.typeset.sentences import Prose


@dataclass(frozen=True)
class Heading:
    """A heading; level 1 is the title of a page."""

    words: str
    level: int = 2


@dataclass(frozen=True)
class Paragraph:
    """Words."""

    words: Prose


@dataclass(frozen=True)
class Bullets:
    """A list of a name or formula (or none) and words."""

    items: tuple[tuple[Box | str | None, Prose], ...]


@dataclass(frozen=True)
class Line:
    """An equation: left side (None: that of the line before), relation, pieces, what it means.

    ``broken_left``: the left side in pieces, where it is long.
    """

    left: Box | None
    relation: Box
    right: tuple[Box, ...]
    words: Prose = ""
    broken_left: tuple[Box, ...] = ()


@dataclass(frozen=True)
class Display:
    """Equations one under the other."""

    lines: tuple[Line, ...]


@dataclass(frozen=True)
class Note:
    """Why a step holds: its number, the reason, what else there is to say, what is assumed anew."""

    number: int
    reason: Prose
    remarks: Prose = ""
    assumed: Prose = ""


@dataclass(frozen=True)
class Steps:
    """Notes, each with its lines; all lines have the same left side."""

    notes: tuple[Note, ...]
    lines: tuple[tuple[Line, ...], ...]

    @property
    def indent(self) -> Box:
        """What stands to the left of every relation."""
        left = self.lines[0][0].left
        return Row(()) if left is None or is_wide(left) else left


@dataclass(frozen=True)
class Cell:
    """Formulas one under the other, each with words in front."""

    lines: tuple[tuple[str, tuple[Box, ...]], ...]


@dataclass(frozen=True)
class Table:
    """Rows of cells side by side; each row is about a formula."""

    header: tuple[str, ...]
    rows: tuple[tuple[tuple[Box, ...], tuple[Cell, ...]], ...]


@dataclass(frozen=True)
class Drawing:
    """A picture: as an element of SVG, as LaTeX, and what it shows in words."""

    svg: str
    latex: str
    words: Prose


Block = Heading | Paragraph | Bullets | Display | Steps | Table | Drawing

WIDTH = 78
"""Letters that fit on a line of a formula."""
EQUALS = Operator("=")


def is_wide(left: Box, limit: int = WIDTH, measure: Measure = width) -> bool:
    """Return whether a left side stands on lines of its own."""
    return width(left) > WIDTH // 2 or measure(left) > 6 * limit // 10


def broken(line: Line, limit: int = WIDTH, measure: Measure = width, indent: int = 0) -> list[Line]:
    """Return a line as lines of at most ``limit`` letters, broken between pieces, then within them.

    ``measure``: how long a box is; ``indent``: letters that left sides take at least.
    """
    if line.left is None:
        return _lines(line, chunks(line.right, limit - indent, measure))
    length = measure(line.left)
    seen = max(indent, min(width(line.left) * limit // WIDTH, length))
    right = chunks(line.right, limit - seen, measure, used=max(0, length - seen))
    fits = length + sum(map(measure, right[0])) <= limit
    if fits and (len(right) == 1 or not is_wide(line.left, limit, measure)):
        return _lines(line, right)
    left = chunks(line.broken_left or (line.left,), limit - indent, measure)
    begins = [Line(Row(()), Row(()), chunk) for chunk in left[:1]]
    rest = chunks(line.right, limit - indent, measure)
    return [
        *begins,
        *(Line(None, Row(()), chunk) for chunk in left[1:]),
        *_lines(Line(None, line.relation, line.right), rest),
    ]


def _lines(line: Line, right: list[tuple[Box, ...]]) -> list[Line]:
    first, *others = right
    start = Line(line.left, line.relation, first, line.words)
    return [start, *(Line(None, Row(()), more) for more in others)]


@singledispatch
def shown(given: object, style: str) -> Any:
    """Return what stands for an object in a style: a page, a formula, or what a notebook displays.

    Raises `TypeError` for kinds that no module has registered.
    """
    raise TypeError(f"nothing shows a {type(given).__name__} as {style}")
