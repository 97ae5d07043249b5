"""Expressions are written in the order of the field, in sums and in products."""

import pytest
import sympy as sp

from eom.typeset.boxes import Row
from eom.typeset.expressions import expression_box, in_order
from eom.typeset.markup import render
from eom.typeset.writing import expression_pieces

A, B, C = sp.symbols("a b c", positive=True)
SIZES = {s.name: s for s in sp.symbols("I1 I2 I3 m m_r g l R R_b R_t nu", positive=True)}
LETTERS = {
    s.name: s
    for s in sp.symbols(
        "omega_1 omega_2 omega_3 h_1 h_2 h_3 k_1 k_3 lambda n b c x p q e v v_1 v_2 mu t Omega "
        "psi psi_dot theta theta_ddot alpha_1 alpha_1_ddot omega_1_dot sigma_2",
        real=True,
    )
}


def of(words: str):
    return sp.parse_expr(
        words.replace("lambda", "lam"), {**SIZES, **LETTERS, "lam": LETTERS["lambda"]}
    )


ORDERED = [
    ("omega_2*h_3 - omega_3*h_2", "ω₂ h₃ − ω₃ h₂"),
    ("omega_3*h_1 - omega_1*h_3", "ω₃ h₁ − ω₁ h₃"),
    ("I3*omega_3**2 + I1*omega_1**2 + I2*omega_2**2", "I₁ ω₁² + I₂ ω₂² + I₃ ω₃²"),
    ("(I1 - I3)*omega_1*omega_3/I2", "(I₁ − I₃) ω₃ ω₁/I₂"),
    ("4*k_1*k_3", "4 k₁ k₃"),
    ("b*lambda**2 + c + lambda**4", "λ⁴ + b λ² + c"),
    ("c + lambda**2*n + lambda**4", "λ⁴ + n λ² + c"),
    ("1 - x**2", "1 − x²"),
    ("k_1*k_3 + 3*k_1 + 1", "1 + 3 k₁ + k₁ k₃"),
    ("-I1 + I3", "I₃ − I₁"),
    ("b - omega_1*c", "b − c ω₁"),
    ("4*p - q**2 + (q + 2*x)**2", "(q + 2 x)² + 4 p − q²"),
    ("(v_1 - v_2)*e", "e (v₁ − v₂)"),
    ("(v_1 - v_2)**2*m_r*(1 - e**2)", "mᵣ (1 − e²) (v₁ − v₂)²"),
    ("(R + x*cos(t))*x", "(R + x cos(t)) x"),
    ("sin(lambda*t)", "sin(λ t)"),
    ("alpha_1*k_1*n**2", "n² k₁ α₁"),
    ("4*n**2*alpha_1 + I1*alpha_1_ddot", "I₁ α̈₁ + 4 n² α₁"),
    ("m*omega_2*x + I1*omega_1_dot", "I₁ ω̇₁ + m x ω₂"),
    ("Omega + psi_dot*sin(theta)", "Ω + ψ̇ sin(θ)"),
    ("(I3 - m)*omega_3**2 + I1*omega_1**2 + I2*omega_2**2", "I₁ ω₁² + I₂ ω₂² + (I₃ − m) ω₃²"),
    ("b*x - c*x*mu", "b x − c μ x"),
    ("p/(2*I1 + 2*I2)", "p/(2 (I₁ + I₂))"),
    ("(2*k_1 - 2*k_3)*x/3", "2 (k₁ − k₃) x/3"),
    ("(R_t*x - R_b*x - R_t)**3", "(Rₜ x − R_b x − Rₜ)³"),
    ("(R_t*x - R_b*x - R_t)**2", "(R_b x − Rₜ x + Rₜ)²"),
]


@pytest.mark.parametrize(("words", "wanted"), ORDERED)
def test_sums_and_products_are_in_the_order_of_the_field(words, wanted):
    assert render(expression_box(of(words)), "text") == wanted
    assert render(Row(expression_pieces(of(words))), "text") == wanted


@pytest.mark.parametrize("words", [words for words, _ in ORDERED])
def test_the_terms_are_those_of_the_sum(words):
    value = of(words)
    assert sp.Add(*in_order(value)) == value


def test_numbers_beside_decimals_stay_where_they_are():
    value = sp.Mul(sp.Float(1.5), of("x"), of("2*p - 2*q"), evaluate=False)
    assert render(expression_box(value), "text") == "1.5 (2 p − 2 q) x"


def test_signs_between_terms_have_their_room_in_mathml():
    assert 'form="infix">+' in render(expression_box(of("p + q")), "mathml")


def test_a_determinant_of_one_entry_is_no_magnitude():
    b, c = LETTERS["b"], LETTERS["c"]
    one, two = (sp.Determinant(sp.ImmutableMatrix(m)) for m in ([[b - c]], [[b, c], [c, b]]))
    assert render(expression_box(one), "text") == "det(b \u2212 c)"
    assert render(expression_box(one), "latex") == r"\det\left( b - c \right)"
    assert render(expression_box(two), "text").startswith("|")


@pytest.mark.parametrize(
    ("power", "wanted"),
    [
        ((A - B) / C, "(a - b)/c"),
        (-A / B, "-a/b"),
        (-A * C / (B + C), r"-a c/\left( b + c \right)"),
        (A / (2 * B), r"a/\left( 2 b \right)"),
        (sp.pi / 2, r"\pi/2"),
        (-A, "-a"),
    ],
)
def test_quotients_in_exponents_stand_on_one_line(power, wanted):
    assert render(expression_box(sp.exp(power)), "latex") == f"e^{{{wanted}}}"
    if not power.could_extract_minus_sign():
        assert render(expression_box(sp.Symbol("x") ** power), "latex") == f"x^{{{wanted}}}"


BESIDE = [
    ("(2*p - q**2/I3)/I1", r"\frac{1}{I_{1}} \, \left(2 p - \frac{q^{2}}{I_{3}}\right)"),
    ("x*(p + q/I3)/(I1*b)", r"\frac{x}{I_{1} b} \, \left(p + \frac{q}{I_{3}}\right)"),
    ("x/(I1*(1 + p/q))", r"\frac{x}{I_{1}} \, \left(\frac{p}{q} + 1\right)^{-1}"),
    ("x/(1 + p/q)", r"x \, \left(\frac{p}{q} + 1\right)^{-1}"),
    ("1/(1 + p/q)", r"\left(\frac{p}{q} + 1\right)^{-1}"),
    ("(p + 1/x)/(q + 1/x)", r"\left(p + \frac{1}{x}\right) \, \left(q + \frac{1}{x}\right)^{-1}"),
    ("(p + exp(-x/b))/q", r"\frac{p + e^{-x/b}}{q}"),
]


@pytest.mark.parametrize(("words", "wanted"), BESIDE)
def test_no_quotient_stands_in_a_quotient_on_pages(words, wanted):
    box = expression_box(of(words))
    assert render(box, "latex").replace(" ", "") == wanted.replace(" ", "")
    assert "<mfrac><mrow><mfrac" not in render(box, "mathml")


def test_in_text_a_quotient_stays_in_one_piece():
    assert render(expression_box(of("(2*p - q**2/I3)/I1")), "text") == "(2 p − q²/I₃)/I₁"


def test_limits_of_integrals_are_as_quotients_in_exponents():
    x = of("x")
    value = sp.Integral(x**2, (x, -sp.Rational(1, 2), sp.pi / 2))
    assert r"\int_{-1/2}^{\pi/2}" in render(expression_box(value), "latex")
    assert "<mfrac>" not in render(expression_box(value), "mathml")
