"""The report page: what it says of each finding, and that nothing of a note gets in unescaped."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

import eom
from eom.checker.read.documents import read_document
from eom.checker.read.spans import Span
from eom.checker.report.findings import (
    ORDER,
    Correction,
    Counterexample,
    Explanation,
    Finding,
    Remark,
    Report,
)
from eom.checker.report.page import MAX_LENGTH, SIGNS, mathml, page, prose

NOTE = r"""# A note with $x$

Words **in bold**, <script>alert(1)</script>, [a link](javascript:alert(1)), and $\vec a = \vec b$.

$$\vec H = I \vec\omega + \vec c \tag{1}$$

- an item with $y < z$

$$
\begin{bmatrix} a & b \\ c & d \end{bmatrix}_B = \text{<img src=x onerror=alert(1)>}
$$
"""
VOID = {"meta", "br", "hr", "img", "input", "link"}


class Nesting(HTMLParser):
    """Collects elements and anchors; raises where the nesting is broken."""

    def __init__(self):
        super().__init__()
        self.open, self.seen, self.ids, self.links = [], [], [], []

    def handle_starttag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))
        self.ids += [v for k, v in attrs if k == "id"]
        self.links += [v for k, v in attrs if k == "href"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.seen.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def parsed(text):
    reader = Nesting()
    reader.feed(text)
    assert reader.open == []
    assert len(set(reader.ids)) == len(reader.ids)
    assert {link[1:] for link in reader.links if link.startswith("#")} <= set(reader.ids)
    return reader


def report_on(document, **changes):
    """Return a report that calls displays wrong and relational inline formulas true."""
    findings, numbers = [], {"display": 0, "inline": 0}
    for p in document.formulas:
        numbers[p.kind] += 1
        verdict = "wrong" if p.kind == "display" else "holds under" if "=" in p.body else "no claim"
        f = Finding(numbers[p.kind], p.kind, p.source, p.span, p.body, verdict)
        findings.append(replace(f, **changes) if verdict == "wrong" else f)
    given = ("constant_mass",)
    return Report("note.md", tuple(findings), "preset kane", unplaced=(r"\vec q",), given=given)


def term(document, text):
    """Return the place of a term in the first display."""
    display = next(p for p in document.formulas if p.kind == "display")
    start = display.source.text.index(text, display.span.start)
    return Span(start, start + len(text))


def test_the_page_is_well_formed_and_holds_every_word():
    document = read_document(NOTE)
    found = parsed(page(document, report_on(document)))
    tags = {tag for tag, _ in found.seen}
    assert not tags & {"script", "img", "iframe", "object", "embed", "form", "base"}
    assert not any(k.startswith("on") for _, attributes in found.seen for k in attributes)
    assert not any(link.startswith("javascript") for link in found.links)
    assert "strong" in tags
    assert "li" in tags


def test_everything_that_is_known_of_a_wrong_line_is_on_the_page():
    document = read_document(NOTE)
    explanation = Explanation(
        r"-\vec c",
        (term(document, r"\vec c"),),
        (Correction(r"\vec H = I\vec\omega", "a term dropped", "added term", sets=(("rigid",),)),),
        Counterexample(((r"\vec c", "(1, 0, 2)"),), ((r"\vec H", "3"),), ("rigid",)),
        "right in the other convention: passive",
    )
    remark = Remark("contradicts", "contradicts line 3", 3)
    text = page(
        document,
        report_on(
            document,
            explanation=explanation,
            reason="why <b>",
            remarks=(remark,),
            read_as=("x as y",),
        ),
    )
    for words in (
        "a term dropped",
        "the distance of any two points of the body is constant",
        "right in the other convention: passive",
        "contradicts line 3",
        "why &lt;b&gt;",
        "x as y",
        "preset kane",
        "each mass is constant",
        "2 wrong",
    ):
        assert words in text
    assert 'class="blamed"' in text
    parsed(text)


def test_a_line_that_carries_a_slip_says_whose():
    document = read_document(NOTE)
    assert "carries on the slip of line 5" in page(document, report_on(document, carried=5))


def test_every_verdict_has_a_sign():
    assert tuple(SIGNS) == tuple(v for v in ORDER if v != "no claim")


def test_a_line_that_is_wrong_by_a_guess_is_on_the_page():
    note = "$$ F = 2 m a $$\n"
    report = eom.check(note)
    assert [f.verdict for f in report.findings if f.kind == "display"] == ["unsure"]
    assert "✗? unsure" in page(read_document(note), report)


def test_the_same_note_gives_the_same_bytes():
    first, second = read_document(NOTE), read_document(NOTE)
    assert page(first, report_on(first)) == page(second, report_on(second))


# -- words -----------------------------------------------------------------------------------------


def words(text, kind="markdown"):
    document = read_document(text, kind)
    return "".join(prose(document, lambda p: f"[{p.body.strip()}]", lambda _: ""))


def test_markdown_keeps_its_lists_tables_code_and_places_of_formulas():
    text = words("# T $x$\n\n- a $y$\n\n```py\nz = '$w$'\n```\n\n|a|b|\n|-|-|\n|$q$|2|\n")
    assert "<h2>T [x]</h2>" in text
    assert "<li>a [y]</li>" in text
    assert "'$w$'" in text
    assert "<td>[q]</td>" in text


def test_headings_go_down_one_step_at_a_time():
    text = words("# A\n\n### B\n\n# C\n\n##### D\n")
    assert re.findall(r"<h(\d)>", text) == ["2", "3", "2", "3"]


def test_raised_words_are_let_through_and_nothing_else_is():
    text = words("2<sup>nd</sup> <sup onclick=x>y</sup> <sup>a<b>c</b></sup> `<sup>q</sup>`")
    assert "2<sup>nd</sup>" in text
    assert "&lt;sup onclick=x&gt;" in text
    parsed(text)


@pytest.mark.parametrize("front", ["---\nnotation: kane\n---\n", '+++\npreset = "kane"\n+++\n'])
def test_front_matter_is_no_part_of_the_page(front):
    assert words(front + "Words $x$.") == "<p>Words [x].</p>\n"


@pytest.mark.parametrize(
    ("how", "text"),
    [
        ("dollars", "a $$x$$ b"),
        ("square", r"a \[x\] b"),
        ("environment", r"a \begin{align*}x\end{align*} b"),
        ("fence", "a\n\n```math\nx\n```\n\nb"),
    ],
)
def test_no_delimiter_is_left(how, text):
    found = re.sub(r"\s+", "", words(text))
    assert found == "<p>a</p><p>[x]</p><p>b</p>", how


def test_latex_becomes_headings_lists_and_emphasis():
    text = words(
        r"\documentclass{article}\begin{document}\section{Top} Some \emph{words}, 5\% of $x$ % no"
        "\n" + r"\begin{itemize}\item one \item two\end{itemize} <b>& \end{document}",
        "latex",
    )
    assert "<h2>Top</h2>" in text
    assert "<em>words</em>, 5% of [x]" in text
    assert text.count("<li>") == 2
    assert "&lt;b&gt;&amp;" in text
    assert "\\" not in text


# -- formulas --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("latex", "wanted"),
    [
        ("a < b", "<mo>&lt;</mo>"),
        (r"\text{<script>}", "&lt;script&gt;"),
        (r"\prescript{A}{B}{\omega}", "<mprescripts/>"),
        (r"a &= b \\ c &= d", "<mtable"),
        (r"\begin{bmatrix}a\end{bmatrix}_B", "<msub><mrow>"),
        (r"a = b \tag{3.1}", "(3.1)"),
    ],
)
def test_spellings_of_formulas(latex, wanted):
    assert wanted in mathml(latex)


@pytest.mark.parametrize("latex", ["{" * 5000, "x" * (MAX_LENGTH + 1), r"\frac{a", r"\unknown{x}"])
def test_what_cannot_be_set_is_shown_as_code(latex):
    assert mathml(latex).startswith("<code>")


@pytest.mark.parametrize(
    "latex",
    [
        r"\href{javascript:alert(1)}{x}",
        r"\style{color:red}{x}",
        r"\class{page}{x}",
        r"\cssId{note}{x}",
    ],
)
def test_no_attribute_of_a_note_gets_in(latex):
    text = mathml(latex)
    assert "<math" in text
    assert not re.search(r"href|style|class|id=", text)


def test_rows_stand_below_one_another_at_their_relations():
    text = mathml(r"a &= b + c \\ &= d", display=True)
    assert text.count("<mtr>") == 2
    assert text.count("<mtd>") == 4
    assert "<mtd><mrow></mrow></mtd><mtd><mrow><mo>=</mo><mi>d</mi></mrow></mtd>" in text


def test_commands_that_a_note_defines_are_shown_as_what_they_stand_for():
    text = r"\newcommand{\vct}[1]{\mathbf{#1}} Velocity $\vct{v} = \dot{\vct{r}}$."
    shown = page(read_document(text, "latex"), Report("", ()))
    assert "<mi>𝐯</mi>" in shown
    assert "<code>" not in shown


def test_a_term_is_marked_where_it_stands():
    text = mathml(r"a + \dot b = c", blamed=[Span(4, 10)])
    assert '<mrow class="blamed"><mover accent="true">' in text
    assert 'class="blamed"' not in mathml(r"\frac{a}{b}", blamed=[Span(5, 9)])


ELEMENTS = {
    **dict.fromkeys(
        "mfrac msqrt mroot msub msup msubsup munderover mmultiscripts mprescripts mtr mtd mn mtext".split(),
        (),
    ),
    "math": ("display",),
    "mi": ("mathvariant",),
    "mo": ("form", "stretchy", "style"),
    "mover": ("accent",),
    "munder": (),
    "mtable": ("columnalign", "displaystyle"),
    "menclose": ("notation",),
    "mrow": ("class",),
}
"""Elements of MathML that a page may hold, and their attributes."""
PARTS = (
    r"a < > & ' ^ _ { } \text{ \frac \\ \class \href \begin{bmatrix} \end{bmatrix} <script> ]]> <!-- &lt;"
).split()
PARTS += [" ", '"', "\ue010"]


@given(st.lists(st.sampled_from(PARTS), max_size=12).map("".join))
def test_whatever_stands_in_a_formula_only_elements_of_mathml_come_out(latex):
    found = parsed(mathml(latex))
    assert {tag for tag, _ in found.seen} <= {*ELEMENTS, "code"}
    for tag, attributes in found.seen:
        assert set(attributes) <= {*ELEMENTS.get(tag, ())}


def test_headings_of_latex_may_have_a_star():
    text = (
        "\\documentclass{article}\\begin{document}\\section*{Problem 1: a ball}\nWords.\n"
        "\\subsection{Part}\n$$ F = m a $$\n\\end{document}\n"
    )
    document = read_document(text, "latex")
    shown = page(document, eom.check(text, kind="latex"))
    assert "<h2>Problem 1: a ball</h2>" in shown
    assert "<h3>Part</h3>" in shown


def test_open_meanings_are_questions_with_an_answer():
    text = "A pendulum of length $l$ swings by $\\theta$.\n\n$$ q = l\\dot\\theta $$\n\n$$ Z = 3 q $$\n"
    shown = page(read_document(text), eom.check(text))
    assert "What is <math" in shown
    assert "eom check NOTE --ask" in shown
    assert "system v" not in shown, "no words of a lexicon"
