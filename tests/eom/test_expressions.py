"""Expressions as boxes: the order of the field, one kind of minus, and where a long one breaks."""

from xml.etree import ElementTree

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from eom.typeset.boxes import Formula, Row
from eom.typeset.breaking import chunks, opened
from eom.typeset.expressions import expression_box, signed
from eom.typeset.markup import render, width

I1, I2, I3, R, m, g = sp.symbols("I1 I2 I3 R m g", positive=True)
W1, W2, W3, S, T, PHI, X = sp.symbols("omega_1 omega_2 omega_3 s t phi x", real=True)

WRITTEN = {
    "Euler's term": ((I3 - I2) * W2 * W3, r"(I_{3} - I_{2}) \, \omega_{2} \omega_{3}"),
    "a minus is taken up": (-(I1 - I3) * W3 * W1, r"(I_{3} - I_{1}) \, \omega_{3} \omega_{1}"),
    "torus": (S * (R + S * sp.cos(T)), r"(R + s \cos t) \, s"),
    "masses first": (g * m * R * sp.sin(PHI), r"m R g \sin \phi"),
    "fraction": (3 * m * R**2 / 10, r"\frac{3 m R^{2}}{10}"),
    "minus": (-W1 / 2, r"-\frac{\omega_{1}}{2}"),
    "root": (1 / sp.sqrt(I1), r"\frac{1}{\sqrt{I_{1}}}"),
    "power": ((I1 + I2) ** 2, "(I_{1} + I_{2})^{2}"),
    "tall brackets": ((I1 / I2 + 1) * W1, r"\left( \frac{I_{1}}{I_{2}} + 1 \right) \, \omega_{1}"),
    "sine squared": (sp.sin(2 * T) ** 2, r"\sin^{2}(2 t)"),
    "decimal": (sp.Float(1.5) * W1, r"1.5 \omega_{1}"),
    "integral": (
        m * sp.Integral(S**2, (S, 0, R)) / R,
        r"\frac{m}{R} \, \int_{0}^{R} s^{2} \, \mathrm{d}s",
    ),
    "derivative": (
        sp.Derivative(sp.sin(T), T),
        r"\frac{\mathrm{d}}{\mathrm{d}t} (\sin t)",
    ),
    "matrix": (sp.Matrix([[W1, 0]]), r"\begin{bmatrix} \omega_{1} & 0 \end{bmatrix}"),
    "determinant": (
        sp.Determinant(sp.ImmutableMatrix([[X, 1], [0, X]])),
        r"\left| \begin{matrix} x & 1 \\ 0 & x \end{matrix} \right|",
    ),
}


@pytest.mark.parametrize("name", WRITTEN)
def test_products_stand_in_the_order_of_the_field(name):
    value, latex = WRITTEN[name]
    assert render(Formula(value), "latex") == latex
    ElementTree.fromstring(render(Formula(value), "mathml"))


def test_an_added_term_begins_brackets_and_names_are_kept():
    value = I1 * (W2 - W1 - 1)
    assert render(Formula(value), "text") == "I₁ (ω₂ − ω₁ − 1)"
    assert render(Formula(W1**2, {W1: r"\Omega"}), "latex") == r"\Omega^{2}"


@pytest.mark.parametrize(
    ("value", "wanted"),
    [
        (W1 / (I1 - I2), "ω₁/(I₁ − I₂)"),
        ((W1 + W2) / I1, "(ω₁ + ω₂)/I₁"),
        (W1 * sp.sin(T) / I1, "ω₁ sin(t)/I₁"),
        (sp.exp(-T), "e^(−t)"),
    ],
)
def test_text_has_the_brackets_that_it_needs(value, wanted):
    assert render(Formula(value), "text") == wanted


ATOMS = st.sampled_from([I1, I2, I3, R, m, W1, W2, W3, S, sp.Integer(2), sp.Rational(-1, 2)])
VALUES = st.recursive(
    ATOMS,
    lambda inner: st.one_of(
        st.lists(inner, min_size=2, max_size=4).map(lambda found: sp.Add(*found)),
        st.lists(inner, min_size=2, max_size=4).map(lambda found: sp.Mul(*found)),
        inner.map(lambda e: e**2),
        inner.map(sp.sin),
    ),
    max_leaves=12,
)


@settings(max_examples=60, deadline=None)
@given(VALUES)
def test_terms_with_their_signs_sum_up_to_the_expression(value):
    total = sp.Add(*(-rest if minus else rest for minus, rest in signed(value)))
    assert sp.expand(total - value) == 0


def plain(box):
    return render(box, "latex").replace(r"\left(", "(").replace(r"\right)", ")").replace(" ", "")


@settings(max_examples=60, deadline=None)
@given(VALUES)
def test_pieces_side_by_side_are_the_formula(value):
    whole = expression_box(value)
    if not isinstance(whole, Formula) and r"\frac" not in render(whole, "latex"):
        parts = plain(Row(opened(whole))).replace(r"\bigl(", "(").replace(r"\bigr)", ")")
        assert parts == plain(whole)


@settings(max_examples=40, deadline=None)
@given(VALUES, st.integers(20, 60))
def test_lines_are_no_longer_than_asked_unless_nothing_can_be_broken(value, limit):
    for line in chunks([Formula(value)], limit, width):
        assert len(line) == 1 or sum(map(width, line)) <= limit
