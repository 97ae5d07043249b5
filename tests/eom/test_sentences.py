"""Letters that sentences spell out are set as letters; words stay words."""

import pytest

from eom.typeset.boxes import Accent, Fence, Scripts, Symbol, symbol
from eom.typeset.markup import render
from eom.typeset.sentences import names_in, phrases, sentence

KNOWN = {name: symbol(name) for name in "a b c h r x J T D".split()}


def latex(words, known=None):
    return sentence(words, lambda b: f"${render(b, 'latex')}$", str, known)


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("the spin omega_1 about b3", r"the spin $\omega_{1}$ about $b_{3}$"),
        (
            "the integral of x^2 dm by r_i x r_j",
            r"the integral of $x^{2} \, \mathrm{d}m$ by $r_{i} \times r_{j}$",
        ),
        ("f(t) is F_2' and r^-1", "f(t) is $\\dot{F}_{2}$ and $r^{-1}$"),
        ("where I_2 >= I_1 >= sqrt(I_3)", "where $I_{2} \\ge I_{1}$ \u2265 \u221a($I_{3}$)"),
        ("at mu = -1 and at nu - 4", "at $\\mu$ = \u22121 and at $\\nu$ \u2212 4"),
        ("theta' grows if I_a < I_t", r"$\dot{\theta}$ grows if $I_{a} < I_{t}$"),
        ("as lambda^2 and H^2", r"as $\lambda^{2}$ and $H^{2}$"),
        ("omega x h is zero", r"$\omega \times h$ is zero"),
        (
            "no row 2 lacks dOmega/dt; a body, I say",
            r"no row 2 lacks $\mathrm{d}\Omega/\mathrm{d}t$; a body, I say",
        ),
        ("momentum along a1, b2", "momentum along $a_{1}$, $b_{2}$"),
        ("in 002:E16 the mean_value(x) of phase", "in 002:E16 the mean_value(x) of phase"),
        ("", ""),
    ],
)
def test_letters_are_set_and_words_kept(words, wanted):
    assert latex(words) == wanted


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("omega x h is zero", r"$\omega \times h$ is zero"),
        ("r x (x x r) = x (r.r)", r"$r \times (x \times r) = x \, (r \cdot r)$"),
        ("with h = J.omega", r"with $h = J \cdot \omega$"),
        ("the integral of x dm", r"the integral of $x \, \mathrm{d}m$"),
        ("(a x q).x is zero", r"$(a \times q) \cdot x$ is zero"),
        ("(a x b).c is zero", r"$(a \times b) \cdot c$ is zero"),
        ("T' is -D, as r r^T - r", "$\\dot{T}$ is \u2212$D$, as $r \\, r^{\\mathrm{T}} - r$"),
        ("a body by a line b. A line", "a body by a line $b$. A line"),
        ("Newton's laws, r' of it", "Newton's laws, $\\dot{r}$ of it"),
    ],
)
def test_known_letters_and_the_signs_between_them_are_set(words, wanted):
    assert latex(words, KNOWN) == wanted


def test_all_else_goes_through_the_second_function():
    shouted = sentence("so omega & all", lambda b: render(b, "text"), str.upper)
    assert shouted == "SO \u03c9 & ALL"


def test_no_dot_stands_behind_a_dyadic_in_brackets():
    known = {"J": Fence(Symbol("I"), "["), "x": Symbol("x")}
    wanted = r"as $x \cdot \left[ I \right] \, x$ is"
    assert latex("as x.J.x is", known) == wanted


def test_a_name_with_primes_may_be_known():
    known = {"r": Symbol("r"), "r'": Symbol("v")}
    assert latex("r' and r''", known) == r"$v$ and $\ddot{r}$"


def test_a_letter_with_a_superscript_can_have_a_prime():
    known = {"r": Scripts(Symbol("p"), sup=Symbol("P"))}
    assert latex("as r' is", known) == "as ${p^{P}}'$ is"


def test_a_letter_that_ends_the_words_is_no_article():
    assert latex("any vector a", KNOWN) == "any vector $a$"
    assert latex("any vector a body has", KNOWN) == "any vector a body has"


def test_axes_are_letters_in_any_sentence():
    assert (
        latex("the axle b2 is parallel to a3 or i1")
        == "the axle $b_{2}$ is parallel to $a_{3}$ or $i_{1}$"
    )


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("as (a x b).(c x r) is", r"as $(a \times b) \cdot (c \times r)$ is"),
        (
            "the rate (r x r').h/(T (r.r))",
            r"the rate $(r \times \dot{r}) \cdot h/(T \, (r \cdot r))$",
        ),
        ("x is (a) or (b x c", "$x$ is ($a$) or ($b \\times c$"),
        ("h, J and r", "$h$, $J$ and $r$"),
        ("near h/(J cos theta)", r"near $h/(J \, \cos \, \theta)$"),
        ("a x b = -(b x a)", r"$a \times b = -(b \times a)$"),
        ("two of them (r) and c) = x", "two of them ($r$) and $c$) = $x$"),
    ],
)
def test_letters_and_signs_are_one_formula_where_its_brackets_are_there(words, wanted):
    assert latex(words, KNOWN) == wanted


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("a x b = 0", r"$a \times b = \vec{0}$"),
        ("for b = 0: c", r"for $b = \vec{0}$: $c$"),
        ("a.b = 0", r"$a \cdot b$ = 0"),
        ("c.(a x b) = 0", r"$c \cdot (a \times b)$ = 0"),
        ("a.c x b = 0", r"$a \cdot c \times b$ = 0"),
        ("b = 0.5", "$b$ = 0.5"),
        ("J b = 1", "$J \\, b = U$"),
        ("c = 0", "$c$ = 0"),
    ],
)
def test_zero_and_one_are_those_of_what_is_equal_to_them(words, wanted):
    own = {"b = 0": Accent("vec", Symbol("0")), "b = 1": Symbol("U")}
    assert latex(words, {**KNOWN, **own}) == wanted


def test_a_column_of_components_is_a_letter_where_it_is_known():
    known = {"[h_C]_B": Symbol("h", "bold")}
    assert latex("the [h_C]_B^T of it", known) == r"the $\mathbf{h}^{\mathrm{T}}$ of it"
    assert latex("in [m]_B or [kg m^2]", known) == r"in [m]_B or [kg $\mathrm{m}^{2}$]"


def test_names_are_told_without_marks_and_powers():
    assert list(names_in("h' and omega_1^2 by a body; J.c", KNOWN)) == ["h", "omega_1", "J", "c"]


def test_letters_can_be_kept_apart():
    parts = phrases("by a x a", {"a": Symbol("a")}, apart=True)
    assert [p if isinstance(p, str) else p.name for p in parts] == ["by ", "a", " \u00d7 ", "a"]


def test_an_article_behind_a_bracket_is_no_letter():
    assert latex("(a matrix of vectors)", KNOWN) == "(a matrix of vectors)"
    assert latex("(a is any vector)", KNOWN) == "($a$ is any vector)"
