r"""Documents as pieces: headings, prose, formulas, each with its place in the source.

Markdown, LaTeX, the Markdown cells of a notebook, or a single formula. Nothing that a document names
is opened: commands that read or write files are findings.

Files, the notes of a folder, texts and single formulas become documents here. Code, comments,
verbatim text and marks of quotations are blanked, character by character, so that places stay.

The writer's own commands (``\newcommand``, ``\def``, ``\DeclareMathOperator``, ``\let``) are taken out in
the same way and kept with where they stand; a formula sees those before it. Delimited parameters of
``\def`` are not read.
"""

from __future__ import annotations

import json
import os
import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from eom.checker.read import latex
from eom.checker.read.spans import ReadingError, Source, Span, printable, reading_error
from eom.checker.read.tokens import Macro, Token, tokenize
from eom.errors import InputError

_FENCE = re.compile(
    r"^(?P<quote>(?:[ ]{0,3}>)*)[ ]*(?P<fence>`{3,}|~{3,})[ ]*(?P<info>[^\n`]*)$", re.MULTILINE
)
_QUOTE = re.compile(r"^[ ]{0,3}>(?:[ ]?>)*[ ]?", re.MULTILINE)
_CODE = re.compile(r"(?<![`$\\])(`+)(?!`)((?:[^`\n]|\n(?!\s*\n))+?)(?<!`)\1(?!`)")
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_FRONT = re.compile(
    r"\A(?P<mark>---|\+\+\+)[ ]*\n(?P<text>.*?)^(?P=mark)[ ]*$", re.DOTALL | re.MULTILINE
)
_TEX_COMMENT = re.compile(r"(?<!\\)((?:\\\\)*)%[^\n]*")
_VERBATIM = re.compile(
    r"\\begin\{(?P<name>verbatim|lstlisting|minted|comment|Verbatim|tikzpicture|filecontents)\*?\}"
    r".*?(?:\\end\{(?P=name)\*?\}|\Z)|\\verb\*?(?P<mark>[^A-Za-z\s*])[^\n]*?(?P=mark)",
    re.DOTALL,
)
_MATHS = frozenset({"math", "latex", "tex", "katex", "mathjax", "$$"})


@dataclass(frozen=True)
class Masked:
    """A text of the same length as its source; fenced formulas; the front matter."""

    text: str
    fenced: tuple[Span, ...] = ()
    front: Span | None = None


def masked_markdown(text: str) -> Masked:
    """Blank code, comments, front matter and marks of quotations; fenced math is kept and listed."""
    front = _FRONT.match(text)
    span = None
    if front is not None:
        span = Span(front.start("text"), front.end("text"))
        text = blank(text[: front.end()]) + text[front.end() :]
    text = _COMMENT.sub(lambda m: blank(m[0]), text)
    text, fenced = _fences(text)
    text = _CODE.sub(lambda m: blank(m[0]), text)
    text = _QUOTE.sub(lambda m: blank(m[0]), text)
    return Masked(text, fenced, span)


def _fences(text: str) -> tuple[str, tuple[Span, ...]]:
    """Blank fenced code; of fenced formulas the fences alone."""
    pieces: list[str] = []
    fenced: list[Span] = []
    place, opened = 0, None
    for match in _FENCE.finditer(text):
        if opened is None:
            opened = match
        elif match["fence"].startswith(opened["fence"]) and not match["info"].strip():
            inside = Span(opened.end(), match.start())
            maths = opened["info"].strip().lower() in _MATHS
            body = text[inside.start : inside.stop]
            pieces += [text[place : opened.start()], blank(opened[0])]
            pieces += [body if maths else blank(body), blank(match[0])]
            fenced += [inside] if maths else []
            place, opened = match.end(), None
    if opened is not None:
        pieces += [text[place : opened.start()], blank(text[opened.start() :])]
        place = len(text)
    return "".join([*pieces, text[place:]]), tuple(fenced)


def masked_latex(text: str) -> Masked:
    r"""Blank comments, verbatim text, and what stands behind ``\end{document}``."""
    text = _VERBATIM.sub(lambda m: blank(m[0]), text)
    text = _TEX_COMMENT.sub(lambda m: m[1] + blank(m[0][len(m[1]) :]), text)
    end = text.find(r"\end{document}")
    return Masked(text if end < 0 else text[:end] + blank(text[end:]))


MAX_MACROS = 2000
_DEFINITION = re.compile(
    r"\\(?P<how>(?:re|provide|New|Renew|Provide|Declare)?(?:new)?"
    r"(?:command|DocumentCommand|RobustCommand|MathOperator)|[gex]?def|let)(?P<star>\*?)(?![A-Za-z])\s*"
    r"(?:\{\s*\\(?P<braced>[A-Za-z]+|.)\s*\}|\\(?P<bare>[A-Za-z]+|.))\s*"
)
_ARITY = re.compile(r"\s*\[\s*([0-9])\s*\]\s*")
_PARAMETERS = re.compile(r"\s*((?:#[1-9])*)\s*")
_TARGET = re.compile(r"=?\s*(?:\\([A-Za-z]+|.)|([^\s\\]))")


@dataclass(frozen=True)
class Defined:
    """A definition, and the offset behind which it holds."""

    macro: Macro
    stop: int


@dataclass(frozen=True)
class Definitions:
    """The text without its definitions, the definitions, and what is wrong with some."""

    text: str
    macros: tuple[Defined, ...]
    errors: tuple[ReadingError, ...]


def collect(source: Source, text: str) -> Definitions:
    """Return the definitions of ``text``, which has the places of its source."""
    found: list[Defined] = []
    errors: list[ReadingError] = []
    pieces: list[str] = []
    place = 0
    while (match := _DEFINITION.search(text, place)) is not None:
        span = Span(match.start(), match.end())
        try:
            if len(found) >= MAX_MACROS:
                raise reading_error(source, span, "too many definitions")
            defined = _defined(source, text, match)
            found.append(defined)
            stop = defined.stop
        except ReadingError as error:
            errors.append(error)
            stop = match.end()
        pieces += [text[place : match.start()], blank(text[match.start() : stop])]
        place = stop
    return Definitions("".join([*pieces, text[place:]]), tuple(found), tuple(errors))


def blank(text: str) -> str:
    """Return spaces for all characters but line ends."""
    return re.sub(r"[^\n]", " ", text)


def before(defined: tuple[Defined, ...], offset: int) -> Mapping[str, Macro]:
    """Return what holds at an offset; the last definition of a name counts."""
    return {d.macro.name: d.macro for d in defined if d.stop <= offset}


def _defined(source: Source, text: str, match: re.Match[str]) -> Defined:
    name, how = match["braced"] or match["bare"], match["how"]
    if how == "let":
        return _alias(source, text, match, name)
    place = match.end()
    arity, default = 0, None
    if how.endswith("def"):
        parameters = _PARAMETERS.match(text, place)
        assert parameters is not None
        arity, place = len(parameters[1]) // 2, parameters.end()
    elif how.endswith("DocumentCommand"):
        signature, place = _braced(source, text, place, match)
        arity = len(re.findall(r"[mo]", text[signature.start : signature.stop]))
    elif (count := _ARITY.match(text, place)) is not None:
        arity, place = int(count[1]), count.end()
        if text.startswith("[", place):
            close = text.find("]", place)
            close = place if close < 0 else close
            default = tuple(tokenize(source, text[place + 1 : close], place + 1)[:-1])
            place = close + 1
    inside, stop = _braced(source, text, place, match)
    body = text[inside.start : inside.stop]
    if how == "DeclareMathOperator":
        tokens = [Token("operator", re.sub(r"\\[A-Za-z]+|[\\{}\s,]", "", body), inside)]
    else:
        tokens = tokenize(source, body, inside.start)[:-1]
    return Defined(Macro(name, arity, tuple(tokens), default), stop)


def _alias(source: Source, text: str, match: re.Match[str], name: str) -> Defined:
    r"""Read ``\let\a\b``: what the target means now is kept."""
    target = _TARGET.match(text, match.end())
    span = Span(match.start(), match.end())
    if target is None:
        raise reading_error(source, span, rf"\let\{name} has no target")
    kind, word = ("command", target[1]) if target[1] else ("letter", target[2])
    token = Token(kind, word, Span(target.start(), target.end()), extra="primitive")
    return Defined(Macro(name, 0, (token,)), target.end())


def _braced(source: Source, text: str, place: int, match: re.Match[str]) -> tuple[Span, int]:
    """Return the span within the braces at a place, and what is behind them."""
    while place < len(text) and text[place].isspace():
        place += 1
    depth, start = 0, place
    while place < min(len(text), start + 20_000):
        c = text[place]
        depth += (c == "{") - (c == "}")
        if depth == 0:
            break
        place += 2 if c == "\\" else 1
    if depth or not text.startswith("{", start):
        span = Span(match.start(), match.end())
        raise reading_error(source, span, "this definition has no body in braces")
    return Span(start + 1, place), place + 1


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
    ``how`` says how a formula is set: "$$", "align", ...; ``macros`` are the commands that hold here.
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
    masked = masked_latex(source.text) if kind == "latex" else masked_markdown(source.text)
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


TEXT_KINDS = ("markdown", "latex", "notebook", "formula")
"""What a text that is no file may be."""
MAX_FILES = 100_000
MAX_NAME = 4096


@dataclass(frozen=True)
class Text:
    """A text that is no file, with a name for messages."""

    text: str
    name: str = ""


Note = Path | Text

_SIGNS = re.compile(r"[=<>\\$]")
_DOLLARS = re.compile(r"\$|\\\(|\\\[|\\begin\{(?:equation|align|gather|multline|eqnarray|math)|\n")
_LATEX = re.compile(r"\\documentclass|\\begin\s*\{document\}")
_NOTEBOOK = re.compile(r'\s*\{.*"cells"\s*:', re.DOTALL)


def is_file(word: str) -> bool:
    """Return whether a word names a file or folder rather than a formula.

    It does if there is one of this name, if it ends in a suffix of `KINDS`, and if it has none of the
    signs = < > $ and backslash.
    """
    if "\n" in word or "\0" in word or len(word) > MAX_NAME:
        return False
    path = Path(word)
    try:
        there = path.exists()
    except OSError:
        there = False
    return there or path.suffix.lower() in KINDS or not _SIGNS.search(word)


def note_of(note: str | Path) -> Note:
    """Return the note that a word, a text or a path stands for."""
    return Path(note) if isinstance(note, Path) or is_file(note) else Text(note)


def notes_of(notes: Iterable[Note]) -> list[Note]:
    """Return notes with the files of folders in place of the folders, in order."""
    return [n for note in notes for n in (_files(note) if isinstance(note, Path) else [note])]


def _files(path: Path) -> list[Note]:
    """Return a file itself, or the notes of a folder and its folders.

    Hidden ones and links that lead out of the folder are left out. Raises `InputError` for a folder
    with too many.
    """
    if not path.is_dir():
        return [path]
    found: list[Note] = []
    root = path.resolve()
    for folder, folders, names in os.walk(path):
        folders[:] = sorted(f for f in folders if not f.startswith("."))
        own = (Path(folder) / n for n in sorted(names) if not n.startswith("."))
        found += [p for p in own if p.suffix.lower() in KINDS and _inside(p, root)]
        if len(found) > MAX_FILES:
            raise InputError("too many files", where=str(path), expected=f"at most {MAX_FILES}")
    return found


def _inside(path: Path, root: Path) -> bool:
    return path.is_file() and (not path.is_symlink() or path.resolve().is_relative_to(root))


def document_of(note: Note, kind: str = "") -> Document:
    """Return a note in pieces; ``kind``: of a text, "" for what it looks like. Raises `InputError`."""
    if isinstance(note, Path):
        if not note.is_file():
            raise _no_file(note)
        return load(note)
    kind = kind or looks_like(note.text)
    text = note.text.strip("\n") if kind == "formula" else note.text
    return read_document(text, kind, name_of(note))


def _no_file(path: Path) -> InputError:
    if path.exists():
        return InputError("this is not a file", where=printable(str(path)))
    hint = "a formula has one of the signs = < > $ and backslash"
    return InputError("no such file or folder", where=printable(str(path)), hint=hint)


def name_of(note: Note) -> str:
    """Return the name of a note for messages."""
    return str(note) if isinstance(note, Path) else note.name or _called(note.text)


def _called(text: str) -> str:
    return "formula" if looks_like(text) == "formula" else "text"


def looks_like(text: str) -> str:
    """Return the kind of a text: a notebook, a LaTeX document, a note with formulas, one formula."""
    text = text.strip("\n")
    for pattern, kind in ((_NOTEBOOK, "notebook"), (_LATEX, "latex"), (_DOLLARS, "markdown")):
        if (pattern.match if kind == "notebook" else pattern.search)(text):
            return kind
    return "formula"
