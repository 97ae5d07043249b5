"""Tokens, characters beyond ASCII, and macros."""

import pytest

from eom.checker.read.documents import read_document
from eom.checker.read.spans import ReadingError, Source
from eom.checker.read.statements import read
from eom.checker.read.tokens import tokenize
from tests.eom.checker.shape import shape


def kinds(text):
    return [(t.kind, t.text) for t in tokenize(Source(text), text)[:-1]]


def only(text, kind="markdown"):
    """The tree of the last formula of a document."""
    formula = read(read_document(text, kind))[-1]
    if formula.error is not None:
        raise formula.error
    return shape(formula.reading.tree)


def test_spans_cover_the_text():
    text = r"\frac{a}{12.5} % note" + "\n" + r"+ \text{if $x$} \\[2pt] b"
    tokens = tokenize(Source(text), text)[:-1]
    assert [text[slice(*t.span)] for t in tokens] == [
        *[r"\frac", "{", "a", "}", "{", "12.5", "}", "+", r"\text{if $x$}", r"\\[2pt]", "b"]
    ]
    assert [t.lined for t in tokens].index(True) == 7


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("ω̇ = α", r"\dot\omega = \alpha"),
        ("ẍ − 2·y ≤ ∞", r"\ddot x - 2\cdot y \le \infty"),
        ("I₁₂² ⇒ 𝐫", r"I_{12}^{2} \Rightarrow \mathbf{r}"),
        ("∫ρ dV ≠ ∑m", r"\int \rho\,dV \neq \sum m"),
        ("r⃗ × n̂", r"\vec r \times \hat n"),
    ],
)
def test_unicode_is_read_as_latex(text, same):
    assert only(f"$${text}$$") == only(f"$${same}$$")


def test_macros_are_expanded_with_the_place_of_the_call():
    text = r"""\newcommand{\vect}[1]{\boldsymbol{#1}} \def\fr#1#2{{}^{#1}#2}
\DeclareMathOperator{\trace}{tr}
\newcommand{\dd}[2][t]{\frac{\mathrm{d} #2}{\mathrm{d} #1}} \let\w\omega
\[ \dd{\fr{N}{\vect{H}}} = \trace(A) \w + \dd[s]{x} \]"""
    document = read_document(text, "latex")
    (formula,) = read(document)
    assert shape(formula.reading.tree) == "D(*H{<N})/t = [[tr (A) omega] + D(x)/s]"
    left = formula.reading.tree.members[0]
    assert text[slice(*left.span)].startswith(r"\dd{")
    assert document.findings == ()


def test_macros_hold_behind_their_definition():
    text = "$\\newcommand{\\q}{x}\\q$ $\\q$ $\\renewcommand{\\q}{y}\\q$ $\\q$"
    trees = [shape(f.reading.tree) for f in read(read_document(text))]
    assert trees == ["x", "x", "y", "y"]


def test_renewed_command_may_use_the_old_one():
    text = r"\let\old\vec \renewcommand{\vec}[1]{\old{\mathbf{#1}}} $\vec r$"
    assert only(text) == "vec(*r)"


@pytest.mark.parametrize(
    "text",
    [
        r"\def\a{\a} $\a$",
        r"\def\a{\b}\def\b{\a\a} $\a$",
        r"\def\a{xx}"
        + "".join(
            rf"\def\{c}{{\{b}\{b}\{b}\{b}}}"
            for b, c in zip("abcdefghijklm", "bcdefghijklmn", strict=False)
        )
        + r" $\n$",
        r"\newcommand{\a}[1]{\a{#1#1}} $\a{x}$",
        r"\newcommand{\a}[2]{#1} $\a$",
    ],
)
def test_macro_bombs_are_clear_errors(text):
    (formula,) = read(read_document(text))
    assert isinstance(formula.error, ReadingError)


def test_control_characters_are_refused():
    with pytest.raises(ReadingError, match="character"):
        tokenize(Source("a\x07b"), "a\x07b")
    with pytest.raises(ReadingError, match="character"):
        tokenize(Source("a 漢字"), "a \u2603")
