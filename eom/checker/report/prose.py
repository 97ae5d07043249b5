r"""The words of a note as HTML, with its formulas in their places.

Markdown is rendered by markdown-it with HTML switched off; LaTeX is first brought into Markdown, as far
as headings, lists, emphasis and paragraphs go. A formula is a mark while this is done.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from itertools import groupby
from typing import TYPE_CHECKING

from eom.checker.read import masks
from eom.checker.read.documents import Document, Piece
from eom.checker.read.places import Source

if TYPE_CHECKING:
    from markdown_it.token import Token

_MARK = "\ue020{}\ue021"
_MARKED = re.compile("\ue020(\\d+)\ue021")
_OPEN = re.compile(
    r"(?:\$\$|\$`|\$|\\\[|\\\(|\\begin\{[a-z]+\*?\}|^[ ]*(?:`{3,}|~{3,})[^\n]*\n?)\Z", re.MULTILINE
)
_CLOSE = r"(?:\$\$|`\$|\$|\\\]|\\\)|\\end\{[a-z]+\*?\}|(?:`{3,}|~{3,})[^\n]*)"
_HARMLESS = re.compile(r"&lt;(su[bp]|em|strong|[bi])&gt;([^&<>]*)&lt;/\1&gt;")
"""Elements of HTML that a note may use."""
_DROPPED = re.compile("[\ue020\ue021]|<!--.*?-->", re.DOTALL)

_SPECIAL = re.compile(r"([*_`#<>|~])")
_LEVELS = {"part": "#", "chapter": "#", "section": "##", "subsection": "###"}
_LATEX: tuple[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]], ...] = (
    (re.compile(r"(?<!\\)%[^\n]*"), ""),
    (
        re.compile(r"\\(part|chapter|section|subsection|subsubsection)\*?\s*\{([^{}]*)\}"),
        lambda m: f"\n\n{_LEVELS.get(m[1], '####')} {m[2]}\n\n",
    ),
    (re.compile(r"\\(?:emph|textit|textsl)\s*\{([^{}]*)\}"), r"*\1*"),
    (re.compile(r"\\textbf\s*\{([^{}]*)\}"), r"**\1**"),
    (re.compile(r"\\texttt\s*\{([^{}]*)\}"), r"`\1`"),
    (re.compile(r"\\item\s*(?:\[([^\]]*)\])?"), r"\n- \1 "),
    (re.compile(r"\\(?:begin|end)\s*\{[^{}]*\}(?:\[[^\]]*\])?"), "\n\n"),
    (re.compile(r"\\(?:label|index|vspace|hspace|documentclass|usepackage)\*?\s*\{[^{}]*\}"), ""),
    (re.compile(r"\\(?:eqref|ref|cite)\s*\{([^{}]*)\}"), r"(\1)"),
    (re.compile(r"\\([%&$#_{}])"), r"\1"),
    (re.compile(r"\\\\|\\(?:par|newline)(?![A-Za-z])"), "\n\n"),
    (re.compile(r"(?<!\\)~"), " "),
    (re.compile(r"``|''"), '"'),
    (re.compile(r"\\[A-Za-z]+\*?\s*"), ""),
    (re.compile(r"[{}]"), ""),
)
"""How LaTeX around formulas becomes Markdown, in this order."""


def prose(
    document: Document, shown: Callable[[Piece], str], below: Callable[[Piece], str]
) -> Iterator[str]:
    """Yield the blocks of a note as HTML.

    ``shown``: HTML of a formula in its line; ``below``: what follows the block that holds it.
    """
    number = 0
    for _, group in groupby(document.pieces, lambda p: id(p.source)):
        pieces = list(group)
        formulas = {number + k: p for k, p in enumerate(p for p in pieces if p.is_formula)}
        text = _text(pieces[0].source, formulas, document)
        for block in _blocks(text):
            held = [formulas[int(n)] for n in _MARKED.findall(block) if int(n) in formulas]
            yield _MARKED.sub(lambda m, f=formulas: shown(f[int(m[1])]), block)  # type: ignore[misc]
            yield from filter(None, map(below, held))
        number += len(formulas)


def _text(source: Source, formulas: Mapping[int, Piece], document: Document) -> str:
    """Return Markdown with marks for the formulas of a source."""
    is_latex = document.kind == "latex"
    place = _start(source, is_latex)
    parts: list[str] = []
    for number, piece in formulas.items():
        gap = source.text[place : piece.span.start]
        parts += [_gap(gap, first=not parts), _mark(number, piece)]
        place = piece.span.stop
    gaps = [*parts, _gap(source.text[place:], first=not parts, last=True)]
    return "".join(_markdown(g) if is_latex and k % 2 == 0 else g for k, g in enumerate(gaps))


def _start(source: Source, is_latex: bool) -> int:
    """Return where the note begins, behind its front matter or preamble."""
    if is_latex:
        match = re.search(r"\\begin\{document\}", source.text)
        return match.end() if match else 0
    front = masks.markdown(source.text).front
    return source.text.find("\n", front[1] + 1) + 1 if front else 0


def _gap(text: str, *, first: bool, last: bool = False) -> str:
    """Return what stands between two formulas, without the delimiters and characters of marks."""
    text = text if first else re.sub(rf"\A\s*{_CLOSE}", "", text)
    text = text if last else _OPEN.sub("", text)
    return _DROPPED.sub("", text)


def _mark(number: int, piece: Piece) -> str:
    mark = _MARK.format(number)
    return mark if piece.kind == "inline" else f"\n\n{mark}\n\n"


def _markdown(text: str) -> str:
    """Return LaTeX as Markdown."""
    text = _SPECIAL.sub(r"\\\1", text)
    for pattern, replacement in _LATEX:
        text = pattern.sub(replacement, text)
    return text


def _blocks(text: str) -> Iterator[str]:
    """Yield the HTML of every block of Markdown that is in no other."""
    from markdown_it import MarkdownIt

    reader = MarkdownIt("commonmark", {"html": False, "linkify": False}).enable(["table"])
    reader.disable(["image", "link", "autolink", "reference"])
    tokens = _stepped(reader.parse(text))
    depth, begin = 0, 0
    for k, token in enumerate(tokens):
        depth += token.nesting
        if depth == 0:
            block = reader.renderer.render(tokens[begin : k + 1], reader.options, {})
            yield block if block.startswith("<pre") else _HARMLESS.sub(r"<\1>\2</\1>", block)
            begin = k + 1


def _stepped(tokens: list[Token]) -> list[Token]:
    """Number the levels of headings from 2, each at most one below the one before."""
    last, wanted = 1, {}
    for token in tokens:
        if token.type == "heading_open":
            wanted = {"tag": f"h{min(int(token.tag[1]) + 1, last + 1, 6)}"}
            last = int(wanted["tag"][1])
        if token.type in {"heading_open", "heading_close"}:
            token.tag = wanted["tag"]
    return tokens
