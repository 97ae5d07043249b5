r"""Sentences of a note that may claim something, with marks for formulas and for what words point to.

Sentences run over inline formulas and end at displays, headings and paragraphs; what stands in brackets
is left out. A mark ``\x02n\x03`` stands for the piece n; also for displays that are pointed to ("Eq.
(3.13)", "this relation"), and, with a number beyond all pieces, for a term of one ("the second term on the
right").
What cannot be found is left as it stands, and the sentence unread.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from eom.checker.judge.notes import Understood
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.values import Refusal, negative
from eom.checker.prose_claims.assumptions import runs, written
from eom.checker.prose_claims.phrases import Subject
from eom.checker.read.documents import Piece
from eom.checker.read.spans import Source, Span
from eom.checker.read.syntax import Addition, Group, Node, Relation

TERMS = 1_000_000
"""Marks of terms begin here: ``TERMS * number of the term + number of the piece``."""

_TAG = r"\d+(?:[.\-]\d+)*[a-z]?['′*]?"
_WORD = r"(?:eqs?\.?|eqns?\.?|equations?|relations?|formulas?|expressions?|identity|identities)"
_REFERENCE = re.compile(
    rf"(?:\b(?P<word>{_WORD})(?P<gap>[ ~]?\n?[ ~]?))?"
    rf"(?:\((?P<tag>{_TAG})\)|\\(?:eq|auto|c|C|v)?ref\s*\{{(?P<label>[^{{}}\s]+)\}})",
    re.IGNORECASE,
)
_STARTS = re.compile(r"(?:^|[.;:!?]\s+|\n[ \t]*)$")
_LABEL = re.compile(r"\\label\s*\{([^{}\s]+)\}")


def opened(text: str) -> str:
    r"""Return prose with references in square brackets, every character where it was.

    A number in round brackets is a reference behind a word like "Eq.", and where a sentence begins.

    >>> opened("see Eq. (3.13) (or not)")
    'see Eq  [3.13] (or not)'
    """
    return _REFERENCE.sub(_opened, text)


def _opened(match: re.Match[str]) -> str:
    begins = _STARTS.search(match.string[max(0, match.start() - 20) : match.start()])
    if match["word"] is None and match["label"] is None and not begins:
        return match[0]
    word = (match["word"] or "").replace(".", " ") + " " * len(match["gap"] or "")
    name = match["tag"] or match["label"]
    return f"{word}[{name}]".ljust(len(match[0]))


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
    for run in runs(pieces):
        if pieces[run[0]].kind not in {"prose", "inline"}:
            continue
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


def _parts(pieces: Sequence[Piece], run: Sequence[int]) -> Iterator[Sentence]:
    """Yield the sentences of a run, cut at every full stop."""
    text, places = written(
        pieces, run, lambda body: _MARKUP.sub(_blank, opened(body)), _MARK.format
    )
    cuts = [0, *(m.end() for m in _END.finditer(text)), len(text)]
    for start, stop in pairwise(cuts):
        inside = text[start:stop]
        lead = len(inside) - len(inside.lstrip())
        tail = len(inside.rstrip()) - 1
        if tail >= lead:
            (first, begin), (last, end) = places[start + lead], places[start + tail]
            end = pieces[last].span.stop if text[start + tail] == "\x03" else end + 1
            yield Sentence(
                _plain(inside),
                pieces[run[0]].source,
                Span(begin, end),
                first,
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
    """Return whether a colon parts a claim from its conditions: "it vanishes in two cases: if ..."."""
    colon = before.source.text[before.span.stop - 1] == ":"
    return colon and _CONDITION.match(behind.text) is not None


def _stopped(before: Sentence, behind: Sentence) -> bool:
    """Return whether nothing but a full stop stands between two sentences."""
    text = before.source.text
    between = text[before.span.stop - 1 : behind.span.start]
    return (
        re.fullmatch(r".?\s*\.?[ \t]*\n?[ \t]*", between) is not None
        and text[before.span.stop - 1] in ".,"
    )


# -- what words point to --------------------------------------------------------------------------


@dataclass
class Displays:
    """The displays of a note by number of piece; those with a tag or label by that."""

    pieces: Sequence[Piece]
    understood: Mapping[int, Understood]
    tagged: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for k, one in self.understood.items():
            if self.pieces[k].kind == "display":
                for name in _names(one):
                    self.tagged.setdefault(name, k)

    def before(self, number: int) -> int | None:
        """Return the display in front of a piece of the same source and heading, or None."""
        for k in range(number - 1, -1, -1):
            piece = self.pieces[k]
            if piece.source is not self.pieces[number].source or piece.kind == "heading":
                return None
            if piece.kind == "display":
                return k
        return None


def _names(one: Understood) -> Iterator[str]:
    """Yield the tags and labels of a display, small letters."""
    reading, piece = one.formula.reading, one.formula.piece
    if reading is not None:
        yield from (text.strip("() ").lower() for text, _ in reading.tags)
    yield from (s.tag.lower() for s in one.formula.statements if s.tag)
    text = piece.source.text[piece.span.start : piece.span.stop]
    yield from (m[1].lower() for m in _LABEL.finditer(text))


# -- phrases --------------------------------------------------------------------------------------

_NAMED = re.compile(rf"(?:the )?(?:{_WORD} )?\[([^\[\]\s]+)\]")
_THIS = re.compile(
    r"^(?:this|it|which|the (?:above|last|previous)|this (?:equation|relation(?:ship)?|result|formula)|"
    r"the (?:equation|relation(?:ship)?|result|formula) above|"
    r"the (?:above|last|previous|preceding) (?:equation|relation(?:ship)?|result|formula)) "
    r"(?=(?:only )?(?:holds?|is (?:only )?(?:valid|true|correct)|applies|shows|proves|demonstrates)\b)"
)
_HOLDS = re.compile(
    r"(?P<only>only )?(?:is )?(?P<also>only )?(?:valid|true|correct|applies|holds?)\b"
)
_RANKS = {"first": 1, "second": 2, "third": 3, "fourth": 4, "fifth": 5, "last": -1, "final": -1}
_TERM = re.compile(
    rf"(?:the )?(?P<rank>{'|'.join(_RANKS)}|middle) term"
    r"(?: on the (?P<side>right|left)(?:[- ]hand)?(?: side)?)?"
    rf"(?: (?:of|in) (?:the )?(?:{_WORD} )?\[(?P<name>[^\[\]\s]+)\])?"
)
_CASES = re.compile(
    r" (?:for|in) (?:the )?(?:\w+ )?(?:special |two |three )*cases?:? (?=if |when |where )"
)


def pointed(text: str, number: int, displays: Displays) -> tuple[str, dict[int, Subject]]:
    """Return a sentence with marks for what it points to, and the terms among that.

    ``number``: of the piece where it begins.
    """
    subjects: dict[int, Subject] = {}
    before = displays.before(number)

    def term(match: re.Match[str]) -> str:
        k = before if match["name"] is None else displays.tagged.get(match["name"].lower())
        found = None if k is None else _term_of(displays.understood.get(k), match)
        if k is None or found is None:
            return match[0]
        rank, subject = found
        mark = TERMS * rank + k
        subjects[mark] = subject
        return f"\x02{mark}\x03"

    def named(match: re.Match[str]) -> str:
        k = displays.tagged.get(match[1].lower())
        return match[0] if k is None else f"\x02{k}\x03"

    text = _NAMED.sub(named, _TERM.sub(term, _CASES.sub(" ", text)))
    if before is not None:
        text = _THIS.sub(f"\x02{before}\x03 ", text)
    return _holding(text), subjects


def _holding(text: str) -> str:
    """Return "(5) is only valid if" as "(5) holds only if"."""
    match = re.match(r"(\x02\d+\x03) ", text)
    said = _HOLDS.match(text, match.end()) if match else None
    if match is None or said is None:
        return text
    only = "only " if said["only"] or said["also"] else ""
    rest = text[said.end() :].strip()
    lead = only if re.match(r"(?:if|when|for|about)\b", rest) else ""
    return f"{match[1]} holds {lead}{rest}".strip()


def _term_of(one: Understood | None, match: re.Match[str]) -> tuple[int, Subject] | None:
    """Return the number of a term in a side of a display, from 1, and what it stands for."""
    relations = [s for s in one.formula.statements if s.relational] if one is not None else []
    if one is None or len(relations) != 1:
        return None
    members = relations[0].members
    side = _terms(members[0] if match["side"] == "left" else members[-1])
    count = len(side)
    rank = _RANKS.get(match["rank"], (count + 1) // 2 if count % 2 else 0)
    rank = count if rank < 0 else rank
    if count < 2 or not 1 <= rank <= count:
        return None
    sign, node = side[rank - 1]
    e = elaborator(one.lexicon, dict(one.around.definitions))
    try:
        value = e.value(node)
    except Refusal:
        return None
    value = negative(value, node.span) if sign == "-" else value
    return rank, Subject(_text(one, node.span), ((value.term, ""),), dict(e.scalars))


def _terms(node: Node) -> list[tuple[str, Node]]:
    if isinstance(node, Group) and node.open == "":
        return _terms(node.body)
    if isinstance(node, Relation):
        return _terms(node.members[-1])
    if isinstance(node, Addition):
        return list(zip(node.signs, node.terms, strict=True))
    return []


def _text(one: Understood, span: Span) -> str:
    return one.formula.piece.source.text[span.start : span.stop].strip()
