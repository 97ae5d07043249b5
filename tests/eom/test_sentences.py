"""Letters that sentences spell out are set as letters; words stay words."""

import pytest

from eom.typeset.markup import render
from eom.typeset.sentences import sentence


def latex(words):
    return sentence(words, lambda b, marks, n: f"${render(b, 'latex')}{marks}{'^' * bool(n)}{n}$")


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("the spin omega_1 about b3", r"the spin $\omega_{1}$ about $b_{3}$"),
        ("theta' grows if I_a < I_t", r"$\theta'$ grows if $I_{a}$ < $I_{t}$"),
        ("as lambda^2 and H^2", r"as $\lambda^2$ and $H^2$"),
        ("omega x h is zero", "$\\omega$ \u00d7 h is zero"),
        ("no row 2 lacks dOmega/dt; a body, I say", "no row 2 lacks dOmega/dt; a body, I say"),
        ("in 002:E16 the mean_value(x) of phase", "in 002:E16 the mean_value(x) of phase"),
        ("", ""),
    ],
)
def test_letters_are_set_and_words_kept(words, wanted):
    assert latex(words) == wanted


def test_all_else_goes_through_the_second_function():
    shouted = sentence("so omega & all", lambda b, *_: render(b, "text"), str.upper)
    assert shouted == "SO \u03c9 & ALL"
