r"""What of a document is not read: code, comments, verbatim text, marks of quotations.

It is blanked, character by character, so that every place stays where it is.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from eom.checker.read.macros import blank
from eom.checker.read.places import Span

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


def markdown(text: str) -> Masked:
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


def latex(text: str) -> Masked:
    r"""Blank comments, verbatim text, and what stands behind ``\end{document}``."""
    text = _VERBATIM.sub(lambda m: blank(m[0]), text)
    text = _TEX_COMMENT.sub(lambda m: m[1] + blank(m[0][len(m[1]) :]), text)
    end = text.find(r"\end{document}")
    return Masked(text if end < 0 else text[:end] + blank(text[end:]))
