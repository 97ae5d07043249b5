"""How four formats write a table whose cells hold formulas with words in front."""

from __future__ import annotations

import html
from collections.abc import Callable

from eom.typeset.blocks import Cell, Table
from eom.typeset.boxes import Box, Row
from eom.typeset.markup import escape_latex, render

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

