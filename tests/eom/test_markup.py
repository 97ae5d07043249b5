"""Boxes in LaTeX, Unicode, ASCII and MathML."""

from importlib.resources import files
from xml.etree import ElementTree

import pytest
import sympy as sp

from eom.errors import InputError
from eom.typeset.boxes import (
    GREEK,
    STYLES,
    Accent,
    Fence,
    Form,
    Formula,
    Fraction,
    Grid,
    Operator,
    Row,
    Scripts,
    Symbol,
    Unseen,
    Words,
    accented,
    raised,
    symbol,
)
from eom.typeset.expressions import expression_box
from eom.typeset.markup import (
    ACCENTS,
    FORMS,
    OPERATORS,
    RENDERERS,
    escape_latex,
    render,
    symbol_latex,
    width,
)
from eom.typeset.pages import html_page

R = Symbol("r", "bold")

NAMES = {
    "theta_dot": (r"\dot{\theta}", "θ̇"),
    "psi_ddot": (r"\ddot{\psi}", "ψ̈"),
    "omega_1": (r"\omega_{1}", "ω₁"),
    "omega_1_dot": (r"\dot{\omega}_{1}", "ω̇₁"),
    "I1": ("I_{1}", "I₁"),
    "J12": ("J_{12}", "J₁₂"),
    "Js_1": ("J_{s,1}", "J_(s,1)"),
    "Jt": ("J_{t}", "Jₜ"),
    "h_G_2": ("h_{G,2}", "h_(G,2)"),
    "radial_2": (r"\mathrm{radial}_{2}", "radial₂"),
    "ring_radius": (r"\mathrm{ring\_radius}", "ring_radius"),
    "Omega": (r"\Omega", "Ω"),
    "lambda_1": (r"\lambda_{1}", "λ₁"),
    "Alpha": ("A", "Α"),
    "q_norm": (r"q_{\mathrm{norm}}", "qₙₒᵣₘ"),
    "m": ("m", "m"),
}

BOXES = {
    "left superscript": (
        Scripts(Symbol("omega", "bold"), sup=Symbol("B"), left=Symbol("I")),
        r"{}^{I}\boldsymbol{\omega}^{B}",
        "ᴵωᴮ",
    ),
    "calligraphic": (Symbol("I", "calligraphic"), r"\mathcal{I}", "I"),
    "blackboard": (Symbol("I", "blackboard"), r"\mathbb{I}", "𝕀"),
    "bold Greek": (Symbol("rho", "bold"), r"\boldsymbol{\rho}", "ρ"),
    "arrow": (Accent("vec", Symbol("r")), r"\vec{r}", "r⃗"),
    "dotted arrow": (accented("dot", Accent("vec", Symbol("r"))), r"\dot{\vec{r}}", "r⃗̇"),
    "underline": (Accent("underline", Symbol("omega")), r"\underline{\omega}", "ω̲"),
    "fraction": (Fraction(Symbol("1"), Symbol("2")), r"\frac{1}{2}", "1/2"),
    "bracket": (Fence(R, "["), r"\left[ \mathbf{r} \right]", "[r]"),
    "matrix": (
        Grid(((Symbol("1"), Symbol("0")), (Symbol("0"), Symbol("1")))),
        r"\begin{bmatrix} 1 & 0 \\ 0 & 1 \end{bmatrix}",
        "[[1, 0], [0, 1]]",
    ),
    "integral": (Scripts(Operator("integral"), Symbol("B")), r"\int_{B}", "∫_B"),
    "sum": (
        Scripts(
            Operator("sum"),
            Row((Symbol("i"), Operator("="), Symbol("1"))),
            Symbol("N"),
            stacked=True,
        ),
        r"\sum_{i = 1}^{N}",
        "Σᵢ ",
    ),
    "cross": (Row((R, Operator("cross"), R)), r"\mathbf{r} \times \mathbf{r}", "r × r"),
    "formula": (
        Formula(sp.Symbol("I1") * sp.Symbol("psi_dot") ** 2),
        r"I_{1} \dot{\psi}^{2}",
        "I₁ ψ̇²",
    ),
    "words": (Words("a & b"), r"\text{a \& b}", "a & b"),
    "room": (Unseen(Symbol("h")), r"\hphantom{h}", " "),
}


@pytest.mark.parametrize("name", NAMES)
def test_names_become_symbols(name):
    latex, text = NAMES[name]
    assert symbol_latex(name) == latex
    assert render(symbol(name), "text") == text
    ElementTree.fromstring(render(symbol(name), "mathml"))


@pytest.mark.parametrize("name", BOXES)
def test_boxes_in_every_language(name):
    box, latex, text = BOXES[name]
    assert render(box, "latex") == latex
    assert render(box, "text").rstrip() == text.rstrip()
    ElementTree.fromstring(render(box, "mathml"))
    assert render(box, "ascii").isascii()


def test_every_renderer_has_every_kind_of_box():
    kinds = set(RENDERERS["latex"])
    assert len(kinds) == 13
    assert all(set(table) == kinds for table in RENDERERS.values())


@pytest.mark.parametrize("markup", RENDERERS)
def test_every_row_of_the_tables_renders(markup):
    boxes = [Accent(mark, R) for mark in ACCENTS]
    boxes += [Operator(name) for name in OPERATORS]
    boxes += [Form(name, (R, R)) for name in FORMS]
    boxes += [Symbol(letter, style) for style in STYLES for letter in (*GREEK, "Omega", "B", "1")]
    for box in boxes:
        written = render(box, markup)
        if markup == "mathml":
            ElementTree.fromstring(written)
        if markup == "ascii":
            assert written.isascii()
        if markup != "latex":
            assert "\\" not in written


def test_mathml_of_expressions_has_no_named_entities():
    x, y = sp.symbols("theta_dot I_1")
    integral = sp.Integral(sp.sin(x) ** 2 / y, (x, 0, sp.pi))
    written = render(Formula(integral), "mathml")
    ElementTree.fromstring(written)
    assert "θ" in written or "&#952;" in written


def test_a_third_dot_is_left_to_fractions():
    twice = accented("dot", accented("dot", Symbol("x")))
    assert twice == Accent("ddot", Symbol("x"))
    assert accented("dot", twice) is None
    assert accented("dot", Fence(R)) is None


def test_words_are_escaped_for_latex():
    assert escape_latex("100% of I_1 & ω ≤ \\x²") == (
        r"100\% of I\_1 \& $\omega$ $\le$ \textbackslash{}x2"
    )


def test_width_counts_letters_not_commands():
    assert width(Accent("vec", Symbol("r"))) == 1
    assert width(Fraction(Symbol("1"), Symbol("m"))) == 1
    assert width(Formula(sp.Symbol("a") / sp.Symbol("b"))) == 1


def test_unknown_markup_is_refused():
    with pytest.raises(InputError, match="did you mean mathml"):
        render(R, "mathlm")


@pytest.mark.parametrize(("sign", "grows"), [("integral", True), ("sum", True), ("times", False)])
def test_brackets_of_mathml_grow_about_signs_that_are_tall(sign, grows):
    under = Accent("underline", Symbol("r"))
    written = render(Fence(Row((Operator(sign), under))), "mathml")
    assert ('stretchy="false"' not in written) == grows


def test_a_function_with_its_bracket_stands_a_little_apart_in_mathml():
    m, n, c = sp.symbols("m n c")
    assert "mspace" in render(expression_box(c * sp.log(m / n)), "mathml")
    assert "mspace" not in render(expression_box(c * (m + n)), "mathml")


@pytest.mark.parametrize("mark", ["dot", "ddot", "vec", "hat", "bar"])
def test_marks_have_room_by_the_style_of_every_page_and_none_of_their_own(mark):
    root = ElementTree.fromstring(render(Accent(mark, Symbol("x")), "mathml"))
    assert root.tag == "mover"
    assert root.attrib == {"accent": "true"}
    assert [e.tag for e in root] == ["mi", "mo"]
    folder = files("eom")
    sheets = [
        html_page([], "marks"),
        (folder / "checker/report/page.css").read_text(),
        (folder / "views/web/live.css").read_text(),
    ]
    for sheet in sheets:
        assert 'mover[accent="true"] > mo { padding-bottom: .1em; }' in sheet


def test_digits_in_bold_are_so_in_mathml():
    assert render(Symbol("10", "bold"), "mathml") == "<mn>\U0001d7cf\U0001d7ce</mn>"
    assert render(Symbol("10"), "mathml") == "<mn>10</mn>"


def test_fractions_in_a_matrix_are_as_large_as_beside_it_in_mathml():
    x, half = Symbol("x"), Fraction(Symbol("x"), Symbol("2"))
    assert 'displaystyle="true"' in render(Grid(((x, half),)), "mathml")
    assert "displaystyle" not in render(Grid(((x, x),)), "mathml")


def test_a_fraction_is_bracketed_before_something_is_raised():
    fraction = Fraction(Symbol("x"), Symbol("t"))
    assert render(raised(fraction, Operator("bullet")), "text") == "(x/t)^•"


def test_a_wide_tilde_stands_behind_what_it_is_on_in_mathml():
    letters = Row((Symbol("a"), Symbol("b")))
    written = render(Accent("widetilde", letters), "mathml")
    assert written.startswith("<msup><mrow><mo stretchy")
    assert written.endswith("<mo>\u223c</mo></msup>")
    assert "mover" in render(Accent("widetilde", Symbol("a")), "mathml")
