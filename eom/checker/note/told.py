"""What a report says of the meanings that were taken from a note: what each is, and what speaks for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from eom.checker.infer.draft import Proposal
from eom.checker.infer.plain import (
    is_guess,
    names_of,
    pattern_in_words,
    row_in_words,
    source_in_words,
)
from eom.checker.infer.systems import Guess
from eom.checker.report.questions import Taken

SHOWN = 3
"""Lines that hold with a meaning and are told."""


def taken(draft: Proposal, held: Mapping[str, Sequence[int]]) -> Iterator[Taken]:
    """Yield the meanings that were taken, with the words or the custom that they come from.

    ``held``: lines that hold with a meaning, by the pattern of its symbol.
    """
    names = names_of(draft.systems, draft.drafts)
    for one in draft.systems:
        yield _about(one)
        for t in one.ties:
            yield Taken(t.latex, one.noun(t.means), _why(t.words, t.line, held.get(t.latex, ())))
    tied = {t.latex for one in draft.systems for t in one.ties if not one.headings}
    for d in (d for d in draft.drafts if d.latex not in tied):
        why = source_in_words(d.words, d.line)
        if d.table == "symbols":
            why = _why(d.words, d.line, held.get(d.latex, ()))
        yield Taken(pattern_in_words(d.latex), row_in_words(d, names), why)


def _about(one: Guess) -> Taken:
    """Return which system a note, or a part of it, is about, and where it says so."""
    where = f", under {' and '.join(one.headings)}" if one.headings else ""
    if one.lines:
        first, last = min(one.lines), max(one.lines)
        read = f"lines {first} to {last}" if last > first else f"line {first}"
        return Taken("", f"system read from {read}{where}: {one.name}", one.words)
    why = f"the note says '{one.words}'" if one.words else "by its letters"
    return Taken("", f"the note is about {one.name}{where}", why)


def _why(words: str, line: int, held: Sequence[int]) -> str:
    """Return what speaks for a meaning: the note's words, or lines that hold with what is only a guess."""
    said = source_in_words(words, line)
    if not is_guess(words):
        return said
    few = ", ".join(map(str, held[:SHOWN])) + ", ..." * (len(held) > SHOWN)
    some = f"line{'s' * (len(held) > 1)} {few} hold{'s' * (len(held) == 1)} with it"
    return f"{said}; {some if held else 'no line holds with it'}"
