"""Pages of headings, words and displayed equations, and how four formats write them.

A page is a list of blocks; a format is a table with one row a kind of block: text, LaTeX, Markdown with
formulas between dollar signs, HTML with MathML. Lines that are too wide break between the terms of
a sum.

How four formats write a table whose cells hold formulas with words in front.
"""

from __future__ import annotations

import base64
import html
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from eom.typeset.blocks import (
    EQUALS,
    WIDTH,
    Block,
    Bullets,
    Cell,
    Display,
    Drawing,
    Heading,
    Line,
    Note,
    Paragraph,
    Steps,
    Table,
    broken,
    is_wide,
)
from eom.typeset.boxes import Box, Row, Unseen
from eom.typeset.markup import escape_latex, render, width
from eom.typeset.sentences import Prose, sentence

Part = Callable[[str, tuple[Box, ...]], str]
"""Writes words and the formula after them."""


def text(table: Table, letters: str) -> list[str]:
    """Return each row as a group of lines, the formula that it is about first."""
    size = max((len(h) for h in table.header), default=0)
    lines: list[str] = []
    for about, cells in table.rows:
        lines += ["", f"  {render(Row(about), letters).strip()}"]
        for title, cell in zip(table.header, cells, strict=True):
            shown = [_worded(w, render(Row(b), letters).strip(), ": ") for w, b in cell.lines]
            names = [title] + [""] * (len(shown) - 1)
            lines += [f"    {n:<{size}}  {s}" for n, s in zip(names, shown or ["0"], strict=False)]
    return lines


def latex(table: Table) -> list[str]:
    """Return a tabular with columns of equal width; formulas break between terms."""
    width = 0.92 / (len(table.header) + 1)
    columns = f"p{{{width:.3f}\\textwidth}}" * (len(table.header) + 1)
    rows = [" & ".join(["", *map(escape_latex, table.header)])]
    for about, cells in table.rows:
        written = [_stacked(cell, _latex_part, " \\newline ") for cell in cells]
        rows.append(" & ".join([f"${render(Row(about), 'latex')}$", *written]))
    body = " \\\\ \\hline\n".join(rows)
    return [
        "{\\footnotesize\\raggedright\\noindent",
        f"\\begin{{tabular}}{{{columns}}}",
        body,
        "\\end{tabular}\\par}",
    ]


def markdown(table: Table) -> list[str]:
    """Return a table with pipes."""
    lines = ["", f"| | {' | '.join(table.header)} |", "|---" * (len(table.header) + 1) + "|"]
    for about, cells in table.rows:
        written = [_stacked(cell, _markdown_part, "<br/>") for cell in cells]
        lines.append(f"| ${_piped(render(Row(about), 'latex'))}$ | {' | '.join(written)} |")
    return [*lines, ""]


def html_table(table: Table) -> list[str]:
    """Return a table with MathML."""
    head = "".join(f"<th>{html.escape(h)}</th>" for h in table.header)
    lines = [f'<table class="aligned"><tr><th></th>{head}</tr>']
    for about, cells in table.rows:
        written = (f"<td>{_stacked(cell, _html_part, '<br/>')}</td>" for cell in cells)
        lines.append(f"<tr><th>{_math(*about)}</th>{''.join(written)}</tr>")
    return [*lines, "</table>"]


def _stacked(cell: Cell, part: Part, between: str) -> str:
    return between.join(part(words, boxes) for words, boxes in cell.lines)


def _worded(words: str, formula: str, between: str) -> str:
    return f"{words}{between}{formula}" if words else formula


def _latex_part(words: str, boxes: tuple[Box, ...]) -> str:
    return _worded(escape_latex(words), f"${render(Row(boxes), 'latex')}$", ": ")


def _markdown_part(words: str, boxes: tuple[Box, ...]) -> str:
    return _worded(words.replace("|", "\\|"), f"${_piped(render(Row(boxes), 'latex'))}$", ": ")


def _html_part(words: str, boxes: tuple[Box, ...]) -> str:
    return _worded(f"<small>{html.escape(words)}</small>" if words else "", _math(*boxes), " ")


def _piped(formula: str) -> str:
    """Return a formula that may stand between pipes."""
    return formula.replace("|", "\\vert ")


# -- text ------------------------------------------------------------------------------------


def _text_side(value: Box | str | None, letters: str) -> str:
    if value is None or isinstance(value, str):
        return value or ""
    return render(value, letters).strip()


def _text_bullets(block: Bullets, letters: str) -> list[str]:
    names = [_text_side(name, letters) for name, _ in block.items]
    lengths = [n for n in map(_length, names) if letters != "text" or n <= WIDTH // 2]
    size = max(lengths, default=0)
    gap = "  " if size else ""
    lines = []
    for name, (_, words) in zip(names, block.items, strict=True):
        line = f"  {_padded(name, size)}{gap}{_text_words(words, letters)}".rstrip()
        lines += _wrapped(line, " " * (2 + size + len(gap))) if letters == "text" else [line]
    return lines


def _length(words: str) -> int:
    """Return the number of columns: marks on letters take none."""
    return sum(not 0x300 <= ord(c) < 0x370 and not 0x20D0 <= ord(c) < 0x2100 for c in words)


def _padded(words: str, size: int) -> str:
    return words + " " * (size - _length(words))


COLUMNS = 100
"""Letters on a line of a page of Unicode text."""


def _text_display(block: Display, letters: str) -> list[str]:
    lefts = [_text_side(line.left, letters) for line in block.lines]
    if letters != "text":
        size = max(map(_length, lefts))
        return [
            _text_line(line, letters, size)
            + (f"  # {_text_words(line.words, letters)}" if line.words else "")
            for line in block.lines
        ]
    size = max((n for n in map(_length, lefts) if n <= WIDTH // 2), default=0)
    return [row for line in block.lines for row in _text_rows(line, size)]


def _text_rows(line: Line, size: int) -> list[str]:
    """Return the lines of an equation, what it means behind or under it."""
    parts = broken(line, COLUMNS - 6, _text_measure, size)
    rows = [row for p in parts for row in _wrapped(_text_line(p, "text", size), "      ")]
    if not line.words:
        return rows
    words = f"# {_text_words(line.words, 'text')}"
    if _length(rows[-1]) + 2 + _length(words) <= COLUMNS:
        return [*rows[:-1], f"{rows[-1]}  {words}"]
    return [*rows, *_wrapped(f"      {words}", "      # ")]


def _text_measure(box: Box) -> int:
    return _length(render(box, "text"))


def _wrapped(words: str, indent: str) -> list[str]:
    """Return words, or what cannot be broken elsewhere, on lines of `COLUMNS` letters."""
    if _length(words) <= COLUMNS:
        return [words]
    start = words[: len(words) - len(words.lstrip())]
    if stacked := _stacked_rows(words.strip(), start, indent):
        return stacked
    return textwrap.wrap(
        words.strip(),
        COLUMNS,
        initial_indent=start,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _stacked_rows(words: str, start: str, indent: str) -> list[str]:
    """Return the rows of a matrix below each other, or nothing where they do not fit."""
    rows = words.split("], [")
    below = len(rows[0]) - rows[0].rfind("[[") - 1
    for first, before in (
        (start, " " * (len(start) + len(rows[0]) - below)),
        (start, indent),
        (indent, indent),
    ):
        found = [f"{before if k else first}{'[' * bool(k)}{row}" for k, row in enumerate(rows)]
        found = [f"{row}]," for row in found[:-1]] + found[-1:]
        if len(rows) > 1 and max(map(_length, found)) <= COLUMNS:
            return found
    return []


def _text_line(line: Line, letters: str, size: int) -> str:
    left = _padded(_text_side(line.left, letters), size)
    relation = render(line.relation, letters).strip() or "  "
    return f"  {left} {relation} {render(Row(line.right), letters).strip()}".rstrip()


def _text_words(words: Prose, letters: str) -> str:
    """Set letters that are spelt out as letters; ASCII leaves words as they are."""
    if letters != "text" and isinstance(words, str):
        return words
    return sentence(words, lambda b: render(b, letters).strip())


def _text_paragraph(block: Paragraph, letters: str) -> list[str]:
    words = _text_words(block.words, letters)
    return _wrapped(words, "") if letters == "text" else [words]


def _text_steps(block: Steps, letters: str) -> list[str]:
    first = block.lines[0][0]
    left = first.left
    wide = left is None or is_wide(left, COLUMNS - 9, _text_measure)
    wide = wide or broken(first, COLUMNS - 9, _text_measure)[0].left != left  # it stands alone
    size = 0 if wide else _length(_text_side(left, letters))
    lines = []
    for note, group in zip(block.notes, block.lines, strict=True):
        assumed, remarks = (_text_words(w, letters) for w in (note.assumed, note.remarks))
        lines += _wrapped(f"     {assumed}", "     ") if assumed else []
        remarks = f"  [{remarks}]" if remarks else ""
        why = f"{note.number:>3}. {_text_words(note.reason, letters)}{remarks}"
        lines += _wrapped(why, "     ")
        for line in group:
            parts = broken(line, COLUMNS - 9, _text_measure, size)
            rows = [f"   {_text_line(p, letters, size)}" for p in parts]
            lines += [w for row in rows for w in _wrapped(row, "         ")]
    return [*lines, ""]


def _text_table(letters: str) -> dict[type, Callable[[Any], list[str]]]:
    return {
        Heading: lambda b: [b.words] if b.level == 1 else ["", b.words],
        Paragraph: lambda b: _text_paragraph(b, letters),
        Bullets: lambda b: _text_bullets(b, letters),
        Display: lambda b: _text_display(b, letters),
        Steps: lambda b: _text_steps(b, letters),
        Table: lambda b: text(b, letters),
        Drawing: lambda b: ["", *_wrapped(f"[Figure: {_text_words(b.words, letters)}]", " "), ""],
    }


# -- LaTeX -----------------------------------------------------------------------------------

_SIZES = (r"\tiny", r"\scriptsize", r"\footnotesize")
"""Sizes for what cannot be broken and is wider than so many letters, those of `_Paper`."""


LATEX_LINE = 180
"""Letters of LaTeX on a line of a formula, but for what cannot be broken."""


def _latex_measure(box: Box) -> int:
    """Return the length of a box in letters of LaTeX, of a matrix as it is seen; more if it is wide."""
    latex = render(box, "latex")
    return max(width(box) * LATEX_LINE // WIDTH, 0 if "matrix}" in latex else len(latex))


def latex_lines(line: Line) -> list[Line]:
    """Return a line as the lines that it takes on paper."""
    return broken(line, LATEX_LINE, _latex_measure)


def _latex_relation(part: Line) -> str:
    """Return the relation of a line; what continues one stands to its right."""
    begins = part.left is not None
    return render(part.relation, "latex") or ("" if begins else r"\quad{}")


HANDOUT_LINE = 108
"""Letters, as they are seen, on a line of a formula of a handout."""


def handout_lines(line: Line) -> list[Line]:
    """Return a line as the lines that it takes on the paper of a handout."""
    return broken(line, HANDOUT_LINE)


@dataclass(frozen=True)
class _Paper:
    """How a line is broken, and the letters that are too many on one for each of `_SIZES`."""

    breaking: Callable[[Line], list[Line]]
    limits: tuple[int, ...]


_WHOLE = _Paper(latex_lines, (115, 98, 82))
_SHORT = _Paper(handout_lines, (156, 134, HANDOUT_LINE))


def _latex_line(line: Line, paper: _Paper) -> str:
    rows = []
    for part in paper.breaking(line):
        left = render(part.left, "latex") if part.left else ""
        relation = _latex_relation(part)
        rows.append(f"{left} &{relation} {_latex_fitted(part, paper)}")
    return " \\\\\n".join(rows)


def _latex_fitted(part: Line, paper: _Paper) -> str:
    size = sum(width(p) for p in part.right) + (width(part.left) if part.left else 0)
    formula = render(Row(part.right), "latex")
    for limit, command in zip(paper.limits, _SIZES, strict=True):
        if size > limit:
            return f"\\text{{{command}$\\displaystyle {formula}$}}"
    return formula


def _latex_aligned(lines: Iterable[tuple[str, Line]], paper: _Paper) -> list[str]:
    """Return an aligned display with words before its lines."""
    rows = []
    first, *others = lines
    before = [first[0]] if first[0] else []
    rows.append(_latex_line(first[1], paper))
    rows += [
        (f"\\intertext{{{words}}}\n" if words else "") + _latex_line(line, paper)
        for words, line in others
    ]
    return [*before, "\\begin{align*}", " \\\\\n".join(rows), "\\end{align*}"]


def _latex_display(block: Display, paper: _Paper) -> list[str]:
    described = [
        (f"\\noindent {_latex_words(line.words)}:" if line.words else "", line)
        for line in block.lines
    ]
    return _latex_aligned(described, paper)


def _latex_note(note: Note) -> str:
    assumed, remarks = map(_latex_words, (note.assumed, note.remarks))
    remarks = f" {{\\small [{remarks}]}}" if remarks else ""
    assumed = f"\\emph{{{assumed}}}\\endgraf\\nobreak\\noindent\n" if assumed else ""
    return f"\\noindent {assumed}\\textbf{{{note.number}.}} {_latex_words(note.reason)}{remarks}"


def _latex_words(words: Prose) -> str:
    return sentence(words, _in_dollars, escape_latex)


def _in_dollars(box: Box) -> str:
    return f"${render(box, 'latex')}$"


def _latex_noted(block: Steps) -> Iterator[tuple[str, Line]]:
    for note, group in zip(block.notes, block.lines, strict=True):
        yield _latex_note(note), group[0]
        yield from (("", line) for line in group[1:])


def _latex_bullets(block: Bullets) -> list[str]:
    items = [f"\\item {_named(name, words, _latex_name)}" for name, words in block.items]
    return ["\\begin{itemize}\\itemsep0pt\\parskip0pt", *items, "\\end{itemize}"]


def _latex_name(value: Box | str) -> str:
    return escape_latex(value) if isinstance(value, str) else f"${render(value, 'latex')}$"


def _named(name: Box | str | None, words: Prose, show: Callable[[Box | str], str]) -> str:
    """Return a name and what it means, as an item of a list."""
    escaped = _latex_words(words) if show is _latex_name else sentence(words, _in_dollars)
    if name is None:
        return escaped
    return f"{show(name)}: {escaped}" if words else show(name)


_SECTIONS = {1: "section*", 2: "subsection*", 3: "subsubsection*", 4: "paragraph*"}

_LATEX: dict[type, Callable[[Any], list[str]]] = {
    Heading: lambda b: [f"\\{_SECTIONS[b.level]}{{{escape_latex(b.words)}}}"],
    Paragraph: lambda b: [f"\\noindent {_latex_words(b.words)}", ""],
    Bullets: _latex_bullets,
    Display: lambda b: _latex_display(b, _WHOLE),
    Steps: lambda b: _latex_aligned(_latex_noted(b), _WHOLE),
    Table: latex,
    Drawing: lambda b: [
        "\\begin{center}",
        f"{b.latex}\\\\[1ex]",
        f"{{\\small {_latex_words(b.words)}}}",
        "\\end{center}",
    ],
}

_HANDOUT: dict[type, Callable[[Any], list[str]]] = {
    **_LATEX,
    Display: lambda b: _latex_display(b, _SHORT),
    Steps: lambda b: _latex_aligned(_latex_noted(b), _SHORT),
}

LATEX_DOCUMENT = r"""\documentclass[fleqn]{article}
\usepackage{amsmath,amssymb}
\usepackage[margin=25mm]{geometry}
\allowdisplaybreaks
\setlength{\parindent}{0pt}
\begin{document}
%s
\end{document}
"""

_HANDOUT_DOCUMENT = r"""\documentclass[10pt,fleqn]{article}
\usepackage{amsmath,amssymb}
\usepackage[a4paper,margin=15mm]{geometry}
\pagestyle{empty}
\setlength{\parindent}{0pt}
\setlength{\mathindent}{8mm}
\allowdisplaybreaks
\AtBeginDocument{\small
  \abovedisplayskip=2pt plus 2pt \belowdisplayskip=3pt plus 2pt
  \abovedisplayshortskip=1pt plus 2pt \belowdisplayshortskip=3pt plus 2pt}
\begin{document}
%s
\end{document}
"""
"""A page that is to hold much."""

# -- Markdown --------------------------------------------------------------------------------


def _markdown_name(value: Box | str) -> str:
    return f"`{value}`" if isinstance(value, str) else f"${render(value, 'latex')}$"


def _markdown_formula(lines: Iterable[tuple[Line, str]]) -> str:
    """Return one display; several lines are aligned."""
    return f"$${display_latex(lines)}$$"


def display_latex(lines: Iterable[tuple[Line, str]]) -> str:
    """Return the LaTeX of lines, each with a number or "", for inside a display; several are aligned."""
    rows = [numbered for line, number in lines for numbered in _numbered(line, number)]
    if len(rows) == 1:
        return " ".join(_markdown_sides(rows[0][0]))
    written = [" &".join(_markdown_sides(part)) + number for part, number in rows]
    inside = " \\\\\n".join(written)
    return f"\\begin{{aligned}}\n{inside}\n\\end{{aligned}}"


def _markdown_sides(line: Line) -> tuple[str, str]:
    left = render(line.left, "latex") if line.left else ""
    relation = _latex_relation(line)
    return left, f"{relation} {render(Row(line.right), 'latex')}"


def _numbered(line: Line, number: str) -> list[tuple[Line, str]]:
    parts = latex_lines(line)
    return [(p, number if p is parts[-1] else "") for p in parts]


def _markdown_display(block: Display) -> list[str]:
    found = []
    for line in block.lines:
        found += [f"{sentence(line.words, _in_dollars)}:", ""] if line.words else []
        found += [_markdown_formula([(line, "")]), ""]
    return found


def _markdown_steps(block: Steps) -> list[str]:
    found = []
    for note in block.notes:
        assumed, remarks = (sentence(w, _in_dollars) for w in (note.assumed, note.remarks))
        found += [f"*{assumed}*", ""] if assumed else []
        remarks = f" — <small>{remarks}</small>" if remarks else ""
        found += [f"**{note.number}.** {sentence(note.reason, _in_dollars)}{remarks}", ""]
    lines = []
    for note, group in zip(block.notes, block.lines, strict=True):
        number = f" && ({note.number})" if len(block.notes) > 1 else ""
        lines += [(line, number if line is group[-1] else "") for line in group]
    return [*found, _markdown_formula(lines), ""]


def _markdown_drawing(block: Drawing) -> list[str]:
    """Return a picture that stands in the page itself."""
    held = base64.b64encode(block.svg.encode()).decode("ascii")
    words = sentence(block.words, lambda b: render(b, "text").strip())
    shown = f"![{words}](data:image/svg+xml;base64,{held})"
    return ["", shown, "", f"*{sentence(block.words, _in_dollars)}*", ""]


_MARKDOWN: dict[type, Callable[[Any], list[str]]] = {
    Heading: lambda b: ["", f"{'#' * b.level} {b.words}", ""],
    Paragraph: lambda b: [sentence(b.words, _in_dollars), ""],
    Bullets: lambda b: [*(f"- {_named(n, w, _markdown_name)}" for n, w in b.items), ""],
    Display: _markdown_display,
    Steps: _markdown_steps,
    Table: markdown,
    Drawing: _markdown_drawing,
}

# -- HTML ------------------------------------------------------------------------------------


def _math(*boxes: Box) -> str:
    inside = render(Row(boxes), "mathml")
    return f'<math><mstyle displaystyle="true">{inside}</mstyle></math>'


def _html_name(value: Box | str) -> str:
    return f"<code>{html.escape(value)}</code>" if isinstance(value, str) else _math(value)


def _html_bullets(block: Bullets) -> list[str]:
    rows = []
    for name, words in block.items:
        cell = f"<th>{_html_name(name)}</th>" if name is not None else ""
        rows.append(f"<tr>{cell}<td>{_html_words(words)}</td></tr>")
    return ["<table>", *rows, "</table>"]


def _html_line(line: Line, indent: Box) -> str:
    """Return the lines of a formula; those without a left side keep its room."""
    parts = [
        _math(
            p.left or Unseen(indent if p.relation != Row(()) else Row((indent, EQUALS))),
            p.relation,
            *p.right,
        )
        for p in broken(line, WIDTH + 20)
    ]
    return f'<div class="formula">{"<br/>".join(parts)}</div>'


def _html_display(block: Display) -> list[str]:
    found = []
    for line in block.lines:
        words = f'<p class="why">{_html_words(line.words)}:</p>' if line.words else ""
        indent = Row(()) if line.left is None or is_wide(line.left) else line.left
        found.append(words + _html_line(line, indent))
    return found


def _html_words(words: Prose) -> str:
    return sentence(words, _inline, html.escape)


def _inline(box: Box) -> str:
    return f"<math>{render(box, 'mathml')}</math>"


def _html_steps(block: Steps) -> list[str]:
    found = ['<div class="chain">']
    for note, group in zip(block.notes, block.lines, strict=True):
        assumed, remarks, reason = map(_html_words, (note.assumed, note.remarks, note.reason))
        found += [f'<p class="assumed">{assumed}</p>'] if assumed else []
        remarks = f" <small>{remarks}</small>" if remarks else ""
        found.append(f'<p class="why"><b>{note.number}.</b> {reason}{remarks}</p>')
        found += [_html_line(line, block.indent) for line in group]
    return [*found, "</div>"]


_HTML: dict[type, Callable[[Any], list[str]]] = {
    Heading: lambda b: [f"<h{b.level}>{html.escape(b.words)}</h{b.level}>"],
    Paragraph: lambda b: [f"<p>{_html_words(b.words)}</p>"],
    Bullets: _html_bullets,
    Display: _html_display,
    Steps: _html_steps,
    Table: html_table,
    Drawing: lambda b: [f"<figure>{b.svg}<figcaption>{_html_words(b.words)}</figcaption></figure>"],
}

HTML_DOCUMENT = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<title>{title}</title>
<style>
:root {{ color-scheme: light dark; --soft: #666; --line: #ddd; --mark: #8a4b00; }}
@media (prefers-color-scheme: dark) {{ :root {{ --soft: #aaa; --line: #444; --mark: #f0b060; }} }}
body {{ max-width: 60rem; margin: 2rem auto; padding: 0 1rem; font: 1rem/1.5 Georgia, serif; }}
h1, h2, h3 {{ line-height: 1.2; }}
table {{ border-collapse: collapse; }}
th, td {{ padding: .2rem .8rem .2rem 0; text-align: left; font-weight: normal; }}
.aligned {{ display: block; overflow-x: auto; overflow-y: hidden; }}
.aligned th, .aligned td {{ border-top: 1px solid var(--line); vertical-align: top; }}
.chain {{ border-top: 1px solid var(--line); padding: .3rem 0; }}
.why {{ margin: .5rem 0 .2rem; }}
.assumed {{ margin: .5rem 0 0; color: var(--mark); font-style: italic; }}
.formula {{ margin: .3rem 0 .3rem 2rem; overflow-x: auto; overflow-y: hidden; padding: .3rem 0; }}
math {{ font-size: 1.1em; }}
mover[accent="true"] > mo {{ padding-bottom: .1em; }} /* browsers set marks too low */
.formula math {{ margin: .25rem 0; }}
small, figcaption {{ color: var(--soft); }}
figure {{ margin: 1rem 0; }}
</style>
</head>
<body>
{body}
</body>
</html>
"""


def text_page(blocks: Iterable[Block], letters: str = "text") -> str:
    """Return a page as plain text; letters: Unicode ("text") or "ascii"."""
    return _page(_text_table(letters), blocks).strip("\n")


def latex_page(blocks: Iterable[Block]) -> str:
    """Return a page as LaTeX that a document with amsmath and amssymb can include."""
    return _page(_LATEX, blocks)


def latex_handout(blocks: Iterable[Block]) -> str:
    """Return a document of LaTeX that holds much on a page."""
    return _HANDOUT_DOCUMENT % _page(_HANDOUT, blocks)


def markdown_page(blocks: Iterable[Block]) -> str:
    """Return a page as Markdown."""
    lines = _page(_MARKDOWN, blocks).split("\n")
    kept = [n for n, line in enumerate(lines) if line or (n and lines[n - 1])]
    return "\n".join(lines[n] for n in kept).strip("\n") + "\n"


def html_page(blocks: Iterable[Block], title: str) -> str:
    """Return one self-contained HTML page."""
    return HTML_DOCUMENT.format(title=html.escape(title), body=_page(_HTML, blocks))


def html_body(blocks: Iterable[Block]) -> str:
    """Return blocks as HTML, to stand in a page of another's."""
    return _page(_HTML, blocks)


def _page(table: Mapping[type, Callable[[Any], list[str]]], blocks: Iterable[Block]) -> str:
    return "\n".join(line for b in blocks for line in table[type(b)](b))
