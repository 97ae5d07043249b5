"""Sentences of a note that may claim something, with marks for their formulas.

Sentences run over inline formulas and end at displays, headings and paragraphs; what stands in brackets
is left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from eom.checker.prose_claims.pointing import opened
from eom.checker.read.documents import Piece
from eom.checker.read.places import Source, Span

MAX_SENTENCE = 600
MAX_SENTENCES = 5000


@dataclass(frozen=True)
class Sentence:
    """Small letters with marks for formulas, its place, and the numbers of its pieces and formulas.

    ``first``: number of the piece where it begins; ``formulas``: numbers of the pieces of its marks.
    """

    text: str
    source: Source
    span: Span
    first: int
    formulas: tuple[int, ...]


_END = re.compile(
    r"[.!?;:](?=\s|\Z)(?<!\be\.g\.)(?<!\bi\.e\.)(?<!\beg\.)(?<!\bie\.)(?<!\bc\.m\.)|"
    r"\n[ \t]*\n|\n[ \t]*[-*+] "
)
_MARKUP = re.compile(r"<[^<>\n]*>|[*_`{}\\~#$←→↑↓—–]|^[ \t]*(?:[-*+]|\d+\.) ", re.MULTILINE)
_BRACKETS = re.compile(r"\([^()]*\)")
_MARK = "\x02{}\x03"


def sentences(pieces: Sequence[Piece]) -> Iterator[Sentence]:
    """Yield the sentences of a note that may claim something.

    One that begins with a small letter goes on with the one before: its full stop is a slip.
    """
    count = 0
    for run in _runs(pieces):
        parts = [p for p in _parts(pieces, run) if p.text]
        for one in _joined(parts):
            count += 1
            if len(one.text) <= MAX_SENTENCE and count <= MAX_SENTENCES:
                yield one
    for k, piece in enumerate(pieces):
        if piece.kind == "display":
            yield from _beside(piece, k)


_VALID = re.compile(
    r"\\text\s*\{\s*\(?((?:this )?(?:is )?(?:only )?(?:valid|true|holds|correct)\b[^{}$()]*)\)?\.?\s*\}",
    re.IGNORECASE,
)


def _beside(piece: Piece, number: int) -> Iterator[Sentence]:
    """Yield what words beside a display say of where it holds."""
    match = _VALID.search(piece.body)
    if match is not None:
        start = piece.span.start + match.start(1)
        text = f"{_MARK.format(number)} {_plain(match[1]).lower()}"
        yield Sentence(text, piece.source, Span(start, start + len(match[1])), number, (number,))


def _runs(pieces: Sequence[Piece]) -> Iterator[list[int]]:
    """Yield the numbers of pieces of prose and inline formulas that stand together."""
    run: list[int] = []
    for k, piece in enumerate(pieces):
        apart = bool(run) and piece.source is not pieces[run[-1]].source
        if apart or piece.kind not in {"prose", "inline"}:
            yield from [run] if run else []
            run = []
        if piece.kind in {"prose", "inline"}:
            run.append(k)
    yield from [run] if run else []


def _parts(pieces: Sequence[Piece], run: Sequence[int]) -> Iterator[Sentence]:
    """Yield the sentences of a run, cut at every full stop."""
    text, places, owners = "", list[int](), list[int]()
    for k in run:
        piece = pieces[k]
        inline = piece.kind == "inline"
        body = f" {_MARK.format(k)} " if inline else _MARKUP.sub(_blank, opened(piece.body))
        text += body
        wide = 0 if inline else 1
        places += [piece.span.start + wide * n for n in range(len(body))]
        owners += [k] * len(body)
    cuts = [0, *(m.end() for m in _END.finditer(text)), len(text)]
    for start, stop in pairwise(cuts):
        inside = text[start:stop]
        lead = len(inside) - len(inside.lstrip())
        tail = len(inside.rstrip()) - 1
        if tail >= lead:
            first, last = start + lead, start + tail
            end = pieces[owners[last]].span.stop if text[last] == "\x03" else places[last] + 1
            yield Sentence(
                _plain(inside),
                pieces[run[0]].source,
                Span(places[first], end),
                owners[first],
                tuple(int(n) for n in re.findall("\x02(\\d+)\x03", inside)),
            )


def _blank(match: re.Match[str]) -> str:
    return " " * len(match[0])


def _plain(text: str) -> str:
    """Return a sentence without what stands in brackets and without its full stop."""
    bare = _BRACKETS.sub(" ", text)
    return re.sub(r"\s+", " ", bare).strip(" .!?;:,\n\t")


def _joined(parts: Sequence[Sentence]) -> Iterator[Sentence]:
    """Yield sentences; what begins with a small letter behind a full stop is a part of the one before.

    The first letter alone is made small here; others stay, as they may name points.
    """
    kept: Sentence | None = None
    for one in parts:
        goes_on = kept is not None and one.text[0].islower() and _stopped(kept, one)
        goes_on = goes_on or (kept is not None and _listing(kept, one))
        if kept is not None and goes_on:
            span = Span(kept.span.start, one.span.stop)
            formulas = (*kept.formulas, *one.formulas)
            kept = replace(kept, text=f"{kept.text} {one.text}", span=span, formulas=formulas)
            continue
        if kept is not None:
            yield replace(kept, text=kept.text.lower())
        kept = one
    if kept is not None:
        yield replace(kept, text=kept.text.lower())


_CONDITION = re.compile(r"(?:if|when|whenever) ")


def _listing(before: Sentence, behind: Sentence) -> bool:
    """Tell whether a colon parts a claim from its conditions: "it vanishes in two cases: if ..."."""
    colon = before.source.text[before.span.stop - 1] == ":"
    return colon and _CONDITION.match(behind.text) is not None


def _stopped(before: Sentence, behind: Sentence) -> bool:
    """Tell whether nothing but a full stop stands between two sentences."""
    text = before.source.text
    between = text[before.span.stop - 1 : behind.span.start]
    return (
        re.fullmatch(r".?\s*\.?[ \t]*\n?[ \t]*", between) is not None
        and text[before.span.stop - 1] in ".,"
    )
