"""What a report says of the meanings that were taken from a note: what each is, and what speaks for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from eom.checker.infer.draft import Proposal
from eom.checker.infer.evidence import Doubt
from eom.checker.infer.plain import (
    in_words,
    is_guess,
    names_of,
    pattern_in_words,
    row_in_words,
    source_in_words,
)
from eom.checker.infer.shown import bare, symbols_of
from eom.checker.infer.systems import Guess
from eom.checker.judge.notes import Understood
from eom.checker.mean.lexicon import Lexicon
from eom.checker.read.symbol_shape import labels
from eom.checker.read.syntax import Integral, walk
from eom.checker.read.writing import latex_of
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
    tied = {t.latex for one in draft.systems for t in one.ties}
    whole = {t.latex for one in draft.systems for t in one.ties if one.whole_note}
    for d in draft.drafts:
        if d.latex in (tied if is_guess(d.words) else whole):
            continue
        why = source_in_words(d.words, d.line)
        if d.table == "symbols":
            why = _why(d.words, d.line, held.get(d.latex, ()))
        mark = d.table in {"marks", "notation"}
        words = row_in_words(d, names)
        name = "" if mark else pattern_in_words(d.latex)
        yield Taken(name, f"{d.latex} as a mark: {words}" if mark else words, why)


def doubt_in_words(doubt: Doubt, draft: Proposal, no: str = "") -> str:
    """Return what a symbol was taken for, and why; ``no``: " not", where it is not to be that."""
    means = in_words(doubt.meaning, names_of(draft.systems, draft.drafts))
    means = means if means.startswith("the ") or means == doubt.meaning else f"the {means}"
    return f"${doubt.latex}$ is{no} {means} ({_custom(doubt.why)})"


def system_in_words(one: Guess) -> str:
    """Return that a note is about a system; one that its sentences compose is told by them."""
    read = f"the system is as read from line {min(one.lines)} ({one.name})" if one.lines else ""
    return read or f"the note is about {one.name}"


def _custom(why: str) -> str:
    """Return why a meaning was taken; a preset is a notation of books."""
    name = why.removeprefix("preset ")
    return why if name == why else f"as in the notation {name}"


def _about(one: Guess) -> Taken:
    """Return which system a note, or a part of it, is about, and where it says so."""
    where = f", under {' and '.join(one.headings)}" if one.headings else ""
    where = f", from line {one.begins} on" if one.after else where
    if one.lines:
        where = "" if one.after else where
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


def passage(here: Lexicon, draft: Proposal) -> int:
    """Return the line from which on a passage is about a system of its own, 0 where none is.

    ``here``: the lexicon that holds in the place that is asked about.
    """
    return next((s.begins for s in draft.systems if s.after and s.holds_in(here)), 0)


def sliced(one: Understood) -> list[str]:
    """Return that letters below an integral over the mass which have no meaning are as they were taken."""
    reading, lexicon = one.formula.reading, one.lexicon
    for node in walk(reading.tree) if reading is not None else ():
        if not isinstance(node, Integral) or node.integrand is None:
            continue
        over_mass = ("m",) in {labels(v) for v in node.variables}
        for symbol in symbols_of([node.integrand]) if over_mass else ():
            look = bare(symbol, lexicon)
            if look is not None and lexicon.find(look) is None:
                return [f"${latex_of(look)}$ is of the element of mass"]
    return []
