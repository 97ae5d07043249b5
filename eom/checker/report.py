"""The report on a note: what was found of every formula, in order."""

from __future__ import annotations

from dataclasses import dataclass

from eom.checker.explanation import UNEXPLAINED, Explanation
from eom.checker.places import NOWHERE, Source, Span


@dataclass(frozen=True)
class Remark:
    """What a formula has to do with the rest of the note: a kind (row of a table), words, a line."""

    kind: str
    text: str
    line: int = 0


@dataclass(frozen=True)
class Finding:
    """A formula of a note with its verdict.

    ``number``: from 1, displays and inline formulas apart; ``kind``: "display" or "inline"; ``line`` and
    ``column`` from 1; ``span``: place in ``source``; ``latex``: as it stands; ``sets``: smallest sets of
    assumptions under which it holds; ``reason``: of a verdict that needs one; ``place``: of the reason;
    ``read_as``: what was read otherwise than it stands; ``carried``: the line whose slip it carries
    forward, 0 for none.
    """

    number: int
    kind: str
    source: Source
    span: Span
    latex: str
    verdict: str
    sets: tuple[tuple[str, ...], ...] = ()
    reason: str = ""
    place: Span = NOWHERE
    read_as: tuple[str, ...] = ()
    remarks: tuple[Remark, ...] = ()
    explanation: Explanation = UNEXPLAINED
    carried: int = 0

    @property
    def line(self) -> int:
        """Line of the formula, from 1."""
        return self.source.line_column(self.span.start)[0]

    @property
    def column(self) -> int:
        """Column of the formula, from 1."""
        return self.source.line_column(self.span.start)[1]


@dataclass(frozen=True)
class Report:
    """What was found in a note.

    ``name``: of the note; ``lexicon``: where the meanings of its symbols come from; ``unplaced``:
    symbols without a meaning; ``given``: what was assumed without being said.
    """

    name: str
    findings: tuple[Finding, ...]
    lexicon: str = ""
    unplaced: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
