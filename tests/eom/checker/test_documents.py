"""Documents as pieces with exact places; what is left alone; what is refused."""

import json

import pytest

from eom.checker.read.documents import MAX_BYTES, decoded, load, read_document
from eom.checker.read.statements import read
from eom.errors import InputError

NOTE = r"""---
notation: arrow
---
# Euler's equations

Let $\vec H$ be the momentum, and $5 or $6 a price. `$not math$`

> Then
> $$ \vec H = I
> \vec\omega $$

```python
x = "$a = b$"
```

```math
T = \frac12 m v^2
```

<!-- $$ hidden = 1 $$ -->
Second
------

With \( a = b \), \[ c = d \] and [a link](http://x) and

\begin{align*}
  x &= 1 \\
  y &= 2
\end{align*}
"""


def pieces(document, kind):
    return [(p.line, " ".join(p.body.split())) for p in document.pieces if p.kind == kind]


def test_markdown():
    document = read_document(NOTE)
    assert pieces(document, "heading") == [(4, "Euler's equations"), (21, "Second")]
    assert [p.level for p in document.pieces if p.kind == "heading"] == [1, 2]
    assert pieces(document, "inline") == [(6, r"\vec H"), (24, "a = b")]
    assert pieces(document, "display") == [
        (9, r"\vec H = I \vec\omega"),
        (17, r"T = \frac12 m v^2"),
        (24, "c = d"),
        (27, r"x &= 1 \\ y &= 2"),
    ]
    assert document.front == "notation: arrow\n"
    assert "not math" not in "".join(p.body for p in document.pieces)


def test_places_are_those_of_the_source():
    document = read_document(NOTE)
    for piece in document.pieces:
        assert len(piece.body) == piece.span.stop - piece.span.start or piece.kind == "heading"
    for formula in read(document):
        span = formula.reading.tree.span
        assert NOTE[span.start] == formula.piece.body.strip()[0]
    broken = read_document("# One\n\ntext\n\n$$ a = \\foo + 1 $$\n")
    (formula,) = read(broken)
    assert "line 5, column 8" in str(formula.error)


LATEX = r"""\documentclass{article}
\newcommand{\w}{\boldsymbol{\omega}} % $x$
\begin{document}
\section{Momentum} \input{secret.tex}
It is $\w = 0$ and 50\% of \verb|$no$|. % $$ c = 1 $$
\begin{equation}\label{e} \mathbf{H} = \mathbf{I} \cdot \w \tag{4} \end{equation}
\begin{verbatim} $$ a = b $$ \end{verbatim}
\write18{rm}
\end{document} $$ after = 1 $$
"""


def test_latex():
    document = read_document(LATEX, "latex", "n.tex")
    assert pieces(document, "heading") == [(4, "Momentum")]
    assert pieces(document, "inline") == [(5, r"\w = 0")]
    (display,) = (f for f in read(document) if f.piece.kind == "display")
    assert display.statements[0].tag == "4"
    assert [f.where for f in document.findings] == [
        "n.tex, line 4, column 20",
        "n.tex, line 8, column 1",
    ]
    assert all("not followed" in f.what for f in document.findings)


def test_notebook():
    cells = [
        {"cell_type": "markdown", "source": ["\\newcommand{\\q}{x}\n", "$$a = \\q$$"]},
        {"cell_type": "code", "source": "y = '$$1 = 2$$'"},
        {"cell_type": "markdown", "source": "then $b = \\foo$ and $\\q = 1$"},
    ]
    document = read_document(json.dumps({"cells": cells}), "notebook", "n.ipynb")
    first, second, third = read(document)
    assert first.piece.source.name == "n.ipynb, cell 1"
    assert "n.ipynb, cell 3, line 1, column 11" in str(second.error)
    assert third.error is None


def test_a_single_formula():
    for text in ("a = b", "$a = b$", "$$a = b$$", r"\[a = b\]"):
        (formula,) = read(read_document(text, "formula"))
        assert formula.relational
        assert formula.piece.body == "a = b"


@pytest.mark.parametrize(
    ("data", "what"),
    [
        (b"\x89PNG\r\n\x1a\n\0\0\0", "binary"),
        (b"a\0b", "binary"),
        ("caf\xe9".encode("latin-1"), "UTF-8"),
        (b"a" * (MAX_BYTES + 1), "too long"),
    ],
)
def test_unusable_data(data, what):
    with pytest.raises(InputError, match=what):
        decoded(data, "x.md")


def test_encodings_and_line_ends():
    assert decoded("\ufeffa\r\nb\rc".encode()) == "a\nb\nc"
    assert decoded("ω".encode("utf-16")) == "ω"


def test_unusable_files(tmp_path):
    for name, what in (("x.pdf", "unknown kind"), ("missing.md", "cannot be read")):
        with pytest.raises(InputError, match=what):
            load(tmp_path / name)
    for text in ("{", "[1]", '{"cells": 3}', "[" * 100_000):
        with pytest.raises(InputError, match="no notebook"):
            read_document(text, "notebook")


def test_unclosed_formulas_are_findings():
    document = read_document("a $$ b = 1\n\n\\begin{align} c")
    assert ["missing" in f.what for f in document.findings] == [True, True]
    assert document.formulas == ()


def test_hostile_documents_take_little_time():
    for unit in (
        "$",
        "$$",
        "\\[",
        "\\(",
        "`",
        "> ",
        "# #",
        "\\verb|",
        "<!--",
        "\\begin{align}",
        "$a",
        "[ ",
        "- \n",
    ):
        read(read_document(unit * 4_000, "markdown"))
        read(read_document(unit * 4_000, "latex"))
