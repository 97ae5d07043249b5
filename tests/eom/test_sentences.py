"""Letters that sentences spell out are set as letters; words stay words."""

import pytest

from eom.typeset.boxes import Fence, Scripts, Symbol, symbol
from eom.typeset.markup import render
from eom.typeset.sentences import sentence

KNOWN = {name: symbol(name) for name in "a b c h r x J T D".split()}


def latex(words, known=None):
    return sentence(words, lambda b: f"${render(b, 'latex')}$", str, known)


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("the spin omega_1 about b3", r"the spin $\omega_{1}$ about $b_{3}$"),
        (
            "the integral of x^2 dm by r_i x r_j",
            "the integral of $x^{2}$ $\\mathrm{d}m$ by $r_{i}$ \u00d7 $r_{j}$",
        ),
        ("f(t) is F_2' and r^-1", "f(t) is $\\dot{F}_{2}$ and $r^{-1}$"),
        ("where I_2 >= I_1 >= sqrt(I_3)", "where $I_{2}$ \u2265 $I_{1}$ \u2265 \u221a($I_{3}$)"),
        ("at mu = -1 and at nu - 4", "at $\\mu$ = \u22121 and at $\\nu$ \u2212 4"),
        ("theta' grows if I_a < I_t", r"$\dot{\theta}$ grows if $I_{a}$ < $I_{t}$"),
        ("as lambda^2 and H^2", r"as $\lambda^{2}$ and $H^{2}$"),
        ("omega x h is zero", "$\\omega$ \u00d7 $h$ is zero"),
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
        ("omega x h is zero", "$\\omega$ \u00d7 $h$ is zero"),
        ("r x (x x r) = x (r.r)", "$r$ \u00d7 ($x$ \u00d7 $r$) = $x$ ($r$ \u00b7 $r$)"),
        ("with h = J.omega", "with $h$ = $J$ \u00b7 $\\omega$"),
        ("the integral of x dm", "the integral of $x$ $\\mathrm{d}m$"),
        ("(a x q).x is zero", "($a$ \u00d7 $q$) \u00b7 $x$ is zero"),
        ("(a x b).c is zero", "($a$ \u00d7 $b$) \u00b7 $c$ is zero"),
        ("T' is -D, as r r^T - r", "$\\dot{T}$ is \u2212$D$, as $r$ $r^{\\mathrm{T}}$ \u2212 $r$"),
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
    wanted = r"as $x$ \u00b7 $\left[ I \right]$ $x$ is".replace(r"\u00b7", "\u00b7")
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
