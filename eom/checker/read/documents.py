r"""Documents as pieces: headings, prose, formulas, each with its place in the source.

Markdown, LaTeX, the Markdown cells of a notebook, or a single formula. Nothing that a document names
is opened: commands that read or write files are findings.
"""

from __future__ import annotations

import json
import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from eom.checker.read import latex, masks
from eom.checker.read.macros import Defined, before, blank, collect
from eom.checker.read.places import ReadingError, Source, Span, printable, reading_error
from eom.checker.read.tokens import Macro
from eom.errors import InputError

MAX_BYTES = 4_000_000
MAX_FORMULAS = 20_000
MAX_INLINE = 4000
KINDS = {
    ".md": "markdown",
    ".markdown": "markdown",
    ".qmd": "markdown",
    ".txt": "markdown",
    ".tex": "latex",
    ".ltx": "latex",
    ".ipynb": "notebook",
}
"""The kind of a file by its suffix."""


@dataclass(frozen=True)
class Piece:
    r"""A part of a document.

    ``kind``: "heading", "prose", "display", "inline". ``body`` is the text of the span in its source
    without code, comments and delimiters, of the same length. ``level`` of a heading counts from 1;
    ``how`` tells how a formula is set: "$$", "align", ...; ``macros`` are the commands that hold here.
    """

    kind: str
    source: Source
    span: Span
    body: str
    level: int = 0
    how: str = ""
    macros: Mapping[str, Macro] = field(default_factory=dict, compare=False, repr=False)

    @property
    def is_formula(self) -> bool:
        """Whether this is a formula."""
        return self.kind in {"display", "inline"}

    @property
    def line(self) -> int:
        """The line where the piece begins, counted from 1; of a formula where its text begins."""
        lead = len(self.body) - len(self.body.lstrip())
        return self.source.line_column(self.span.start + lead)[0]


@dataclass(frozen=True)
class Document:
    """A document in pieces; ``front``: the text of its front matter; ``findings``: what was refused.

    ``kind``: "markdown", "latex", "notebook", "formula".
    """

    name: str
    pieces: tuple[Piece, ...]
    front: str = ""
    findings: tuple[ReadingError, ...] = ()
    kind: str = "markdown"

    @property
    def formulas(self) -> tuple[Piece, ...]:
        """The formulas, in order."""
        return tuple(p for p in self.pieces if p.is_formula)


# -- files ---------------------------------------------------------------------------------------


def load(path: Path | str) -> Document:
    """Read a file. Raises `InputError` for what is no text, too long, or of no known kind."""
    path = Path(path)
    name = printable(str(path))
    kind = KINDS.get(path.suffix.lower())
    if kind is None:
        expected = ", ".join(sorted(KINDS))
        raise InputError("unknown kind of document", where=name, expected=expected)
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise InputError("the file cannot be read", where=name, got=error.strerror) from error
    return read_document(decoded(data, name), kind, name)


def decoded(data: bytes, name: str = "") -> str:
    """Return the text of a file. Raises `InputError` for binary, too long or wrongly encoded data."""
    if len(data) > MAX_BYTES:
        raise InputError("the file is too long", where=name, expected=f"at most {MAX_BYTES} bytes")
    encoding = "utf-16" if data[:2] in {b"\xff\xfe", b"\xfe\xff"} else "utf-8-sig"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        hint = "save it as UTF-8" if b"\0" not in data else ""
        what = "the file is not encoded in UTF-8" if hint else "the file is binary"
        raise InputError(what, where=name, got=f"byte {error.start + 1}", hint=hint) from error
    if "\0" in text:
        raise InputError("the file is binary", where=name)
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_document(text: str, kind: str = "markdown", name: str = "") -> Document:
    """Return the pieces of a text of a kind: "markdown", "latex", "notebook", "formula"."""
    if len(text) > MAX_BYTES:
        raise InputError("the text is too long", where=name, expected=f"at most {MAX_BYTES}")
    if kind == "notebook":
        return _notebook(text, name)
    if kind == "formula":
        return _formula(text, name)
    return _scanned(Source(text, name), kind, ())[0]


def _formula(text: str, name: str) -> Document:
    """Return one formula; delimiters around it are taken off."""
    match = re.fullmatch(r"\s*(\$\$?|\\\[|\\\()?(.*?)(\$\$?|\\\]|\\\))?\s*", text, re.DOTALL)
    assert match is not None
    span = Span(match.start(2), match.end(2))
    source = Source(text, name)
    definitions = collect(source, text)
    body = definitions.text[span.start : span.stop]
    macros = before(definitions.macros, len(text))
    piece = Piece("display", source, span, body, how="formula", macros=macros)
    return Document(name, (piece,), "", definitions.errors, "formula")


def _notebook(text: str, name: str) -> Document:
    """Return the pieces of all Markdown cells, each with its own source."""
    try:
        cells = json.loads(text)["cells"]
        texts = [(k, c["source"]) for k, c in enumerate(cells, 1) if c["cell_type"] == "markdown"]
        joined = [(k, "".join(t)) for k, t in texts]
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise InputError("this is no notebook", where=name, expected="JSON with cells") from error
    pieces: list[Piece] = []
    findings: list[ReadingError] = []
    known: tuple[Defined, ...] = ()
    front = ""
    for k, cell in joined:
        label = f"{name}, cell {k}" if name else f"cell {k}"
        document, known = _scanned(Source(cell, label), "markdown", known)
        pieces += document.pieces
        findings += document.findings
        front = front or document.front
    return Document(name, tuple(pieces), front, tuple(findings), "notebook")


# -- scanning ------------------------------------------------------------------------------------

_FILES = re.compile(
    r"\\(?:input|include|subfile|import|openin|openout|read|immediate|write(?:18)?|InputIfFileExists"
    r"|lstinputlisting|verbatiminput|includegraphics@|catcode|csname|newread|newwrite|ShellEscape)"
    r"(?![A-Za-z])(?:\s*\{[^{}\n]*\})?"
)
_ENVIRONMENTS = "|".join(sorted(latex.DISPLAYS | {"math"}, key=len, reverse=True))
_OPENING = re.compile(
    rf"(?P<escape>\\\\|\\\$)|(?P<dollars>\$\$)|(?P<ticked>\$`)|(?P<dollar>\$)|(?P<square>\\\[)"
    rf"|(?P<round>\\\()|\\begin\{{(?P<environment>{_ENVIRONMENTS})(?P<star>\*?)\}}"
)
_ATX = re.compile(r"^[ ]{0,3}(#{1,6})[ \t]+(.*)$", re.MULTILINE)
_SETEXT = re.compile(r"^(?=[^\s>#|$-])([^\n]*\S)[ \t]*\n[ ]{0,3}(=+|-{3,})[ \t]*$", re.MULTILINE)
_SECTION = re.compile(
    r"\\(part|chapter|section|subsection|subsubsection|paragraph|frametitle)\*?\s*(?:\[[^\]]*\])?\{([^{}]*)\}"
)
_LEVELS = {"part": 1, "chapter": 1, "section": 2, "subsection": 3, "subsubsection": 4}
_PARAGRAPH = re.compile(r"\n[ \t]*\n")


def _scanned(
    source: Source, kind: str, known: tuple[Defined, ...]
) -> tuple[Document, tuple[Defined, ...]]:
    """Return the document of one source, and all definitions up to its end."""
    masked = masks.latex(source.text) if kind == "latex" else masks.markdown(source.text)
    definitions = collect(source, masked.text)
    head = collect(source, source.text[: masked.front.stop]).macros if masked.front else ()
    known = (*known, *head)
    text, findings = definitions.text, [*definitions.errors]
    for match in _FILES.finditer(text):
        what = "commands that read or write files are not followed"
        findings.append(reading_error(source, Span(match.start(), match.end()), what))
    text = _FILES.sub(lambda m: blank(m[0]), text)
    scanner = _Scan(source, text, kind, (*known, *definitions.macros), masked.fenced)
    pieces = tuple(scanner.pieces())
    front = source.text[slice(*masked.front)] if masked.front else ""
    later = tuple(Defined(d.macro, 0) for d in definitions.macros)
    document = Document(source.name, pieces, front, (*findings, *scanner.findings), kind)
    return document, (*known, *later)


@dataclass
class _Scan:
    source: Source
    text: str
    kind: str
    macros: tuple[Defined, ...]
    fenced: tuple[Span, ...]
    findings: list[ReadingError] = field(default_factory=list)
    absent: set[str] = field(default_factory=set)
    held: tuple[int, Mapping[str, Macro]] = field(default_factory=lambda: (-1, {}))

    def pieces(self) -> Iterator[Piece]:
        """Yield all pieces in order: formulas, and what stands between them."""
        place = self.begin()
        for formula, outer in self.formulas(place):
            yield from self.between(place, outer.start)
            yield formula
            place = outer.stop
        yield from self.between(place, len(self.text))

    def begin(self) -> int:
        match = re.search(r"\\begin\{document\}", self.text) if self.kind == "latex" else None
        return match.end() if match else 0

    def holding(self, offset: int) -> Mapping[str, Macro]:
        """Return the commands that hold at an offset; the same object between two definitions."""
        count = bisect_right(self.macros, offset, key=lambda d: d.stop)
        if self.held[0] != count:
            self.held = (count, before(self.macros, offset))
        return self.held[1]

    def piece(self, kind: str, start: int, stop: int, how: str) -> Piece:
        body = self.text[start:stop]
        macros = self.holding(stop)
        return Piece(kind, self.source, Span(start, stop), body, how=how, macros=macros)

    def formulas(self, place: int) -> Iterator[tuple[Piece, Span]]:
        """Yield every formula with the span of its delimiters."""
        count = 0
        while True:
            k = bisect_left(self.fenced, (place, place))
            fence = self.fenced[k] if k < len(self.fenced) else None
            match = _OPENING.search(self.text, place)
            if fence is not None and (match is None or fence.start <= match.start()):
                yield self.piece("display", fence.start, fence.stop, "fence"), fence
                place = fence.stop
                continue
            if match is None:
                return
            found = self.closed(match)
            place = match.end() if found is None else found[1].stop
            if found is not None:
                count += 1
                if count > MAX_FORMULAS:
                    raise InputError("too many formulas", where=self.source.name)
                yield found

    def closed(self, match: re.Match[str]) -> tuple[Piece, Span] | None:
        """Return the formula that an opening delimiter begins, or None where it is none."""
        group = str(match.lastgroup)
        if group == "escape":
            return None
        if match["environment"]:
            name = match["environment"] + match["star"]
            return self.until(match, rf"\end{{{name}}}", "display", match["environment"])
        if group == "dollar":
            return self.inline(match)
        end, kind = {
            "dollars": ("$$", "display"),
            "ticked": ("`$", "inline"),
            "square": (r"\]", "display"),
            "round": (r"\)", "inline"),
        }[group]
        return self.until(match, end, kind, match[0])

    def until(
        self, match: re.Match[str], end: str, kind: str, how: str
    ) -> tuple[Piece, Span] | None:
        start = match.end()
        if end in self.absent:
            return None
        stop = self.text.find(end, start)
        if end == r"\]" and stop > 0 and self.text[stop - 1] == "\\":
            stop = self._behind_row(start)
        if stop < 0:
            self.absent.add(end)
            span = Span(match.start(), match.end())
            if match[0] not in {r"\[", r"\("}:
                self.findings.append(reading_error(self.source, span, f"{end} is missing for this"))
            return None
        piece = self.piece(kind, start, stop, how)
        return piece, Span(match.start(), stop + len(end))

    def _behind_row(self, start: int) -> int:
        r"""Return the place of ``\]`` that is not the end of ``\\]``."""
        found = re.compile(r"(?<!\\)(?:\\\\)*(\\\])").search(self.text, start)
        return found.start(1) if found else -1

    def inline(self, match: re.Match[str]) -> tuple[Piece, Span] | None:
        """Return what stands between two dollars of one paragraph; amounts of money are left alone."""
        start = match.end()
        limit = min(len(self.text), start + MAX_INLINE)
        blank_line = _PARAGRAPH.search(self.text, start, limit)
        limit = blank_line.start() if blank_line else limit
        close = re.compile(r"(?<!\\)(?:\\\\)*(\$)").search(self.text, start, limit)
        if close is None:
            return None
        body = self.text[start : close.start(1)]
        tight = (
            body[:1].strip() and body[-1:].strip() and not self.text[close.end() :][:1].isdigit()
        )
        if not body.strip() or not (tight or re.search(r"[\\=^_]", body)):
            return None
        return self.piece("inline", start, close.start(1), "$"), Span(match.start(), close.end())

    # between formulas

    def between(self, start: int, stop: int) -> Iterator[Piece]:
        """Yield headings and prose."""
        patterns = [_SECTION] if self.kind == "latex" else [_ATX, _SETEXT]
        matches = [m for p in patterns for m in p.finditer(self.text, start, stop)]
        for match in sorted(matches, key=re.Match.start):
            if match.start() < start:
                continue
            yield from self.prose(start, match.start())
            yield self.heading(match)
            start = match.end()
        yield from self.prose(start, stop)

    def heading(self, match: re.Match[str]) -> Piece:
        if match.re is _SECTION:
            level, group = _LEVELS.get(match[1], 5), 2
        elif match.re is _ATX:
            level, group = len(match[1]), 2
        else:
            level, group = 1 if match[2].startswith("=") else 2, 1
        span = Span(match.start(group), match.end(group))
        body = match[group].rstrip("# \t") if match.re is _ATX else match[group]
        return Piece("heading", self.source, span, body, level)

    def prose(self, start: int, stop: int) -> Iterator[Piece]:
        text = self.text[start:stop]
        if text.strip():
            yield Piece("prose", self.source, Span(start, stop), text)
