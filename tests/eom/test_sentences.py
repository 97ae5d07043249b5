"""Letters that sentences spell out are set as letters; words stay words."""

import pytest

from eom.typeset.boxes import Scripts, Symbol, symbol
from eom.typeset.markup import render
from eom.typeset.sentences import sentence

KNOWN = {name: symbol(name) for name in "a b c h r x J T D".split()}


def latex(words, known=None):
    return sentence(words, lambda b: f"${render(b, 'latex')}$", str, known)


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("the spin omega_1 about b3", r"the spin $\omega_{1}$ about $b_{3}$"),
        ("theta' grows if I_a < I_t", r"$\theta'$ grows if $I_{a}$ < $I_{t}$"),
        ("as lambda^2 and H^2", r"as $\lambda^{2}$ and $H^{2}$"),
        ("omega x h is zero", "$\\omega$ x h is zero"),
        (
            "no row 2 lacks dOmega/dt; a body, I say",
            r"no row 2 lacks $\mathrm{d}\Omega/\mathrm{d}t$; a body, I say",
        ),
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
        ("(a x b).c is zero", "($a$ \u00d7 $b$) \u00b7 $c$ is zero"),
        ("T' is -D, as r r^T - r", "$T'$ is \u2212$D$, as $r$ $r^{\\mathrm{T}}$ \u2212 $r$"),
        ("a body by a line b. A line", "a body by a line $b$. A line"),
        ("Newton's laws, r' of it", "Newton's laws, $r'$ of it"),
    ],
)
def test_known_letters_and_the_signs_between_them_are_set(words, wanted):
    assert latex(words, KNOWN) == wanted


def test_all_else_goes_through_the_second_function():
    shouted = sentence("so omega & all", lambda b: render(b, "text"), str.upper)
    assert shouted == "SO \u03c9 & ALL"


def test_a_letter_with_a_superscript_can_have_a_prime():
    known = {"r": Scripts(Symbol("p"), sup=Symbol("P"))}
    assert latex("as r' is", known) == "as ${p^{P}}'$ is"
