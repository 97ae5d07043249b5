"""Damaged formulas read in a second way; healthy ones have no other reading."""

import pytest

from eom.checker.read.damage import apply, cross_before_column, variants
from eom.checker.read.grammar import read_formula
from eom.checker.read.spans import Source
from eom.checker.read.tokens import tokenize
from tests.eom.checker.formulas import GOLDSTEIN, KANE, SCHAUB
from tests.eom.checker.shape import shape


def best(text):
    found = variants(Source(text), tokenize(Source(text), text))
    return (
        (shape(found[0].reading.tree), [r.name for r in found[0].repairs]) if found else (None, [])
    )


@pytest.mark.parametrize(
    ("text", "expected", "name"),
    [
        (
            r"\left[\mathcal I \boldsymbol\omega^{\mathcal B}\right]_{\mathcal B}",
            "[*omega{^cal:B <cal:I}]{_cal:B}",
            "left script on the line",
        ),
        (
            r"\mathcal{N}_{\boldsymbol\omega}^{\mathcal B} = 0",
            "*omega{^cal:B <cal:N} = 0",
            "base in the subscript",
        ),
        (r"[J] \frac{B}{dt} \vec\omega", "[[J] D(vec(omega))/t@B]", "derivative without d"),
        (r"\frac{N}{dt}(m \vec v) x", "[D(([m vec(v)]))/t@N x]", "derivative without d"),
        (r"c_O \times r_O \ddot{\bullet}", "[c{_O} x r{_O ^!bullet!bullet}]", "raised dots"),
        (r"(\rho \overset{0}{\cdot} + x)", "([rho{^!circ} + x])", "circle over an operator"),
        (
            r"- \int \rho \times \rho \times dm",
            "[-int([rho{^!times} rho{^!times}]; m)]",
            "cross as a script",
        ),
        (
            r"m \rho \times C \times \omega",
            "[m rho{^!times} C{^!times} omega]",
            "cross as a script",
        ),
        ("a = b\nc = d + e", "a = b // c = [d + e]", "glued lines"),
    ],
)
def test_damage_is_read_through(text, expected, name):
    tree, names = best(text)
    assert tree == expected
    assert set(names) == {name}


def test_healthy_formulas_have_one_reading():
    texts = [t for book in (KANE, SCHAUB, GOLDSTEIN) for t, _ in book]
    assert [t for t in texts if best(t) != (None, [])] == []


@pytest.mark.parametrize("text", ["a = b\n+ c = d", "a =\nb = c", "a = (b\nc = d)", "a\n= b"])
def test_lines_that_go_on_are_not_parted(text):
    assert best(text) == (None, [])


def test_cross_before_a_column_on_request():
    tree = read_formula(r"\dot C = -\omega^{BI} \times C").tree
    new, _ = apply(tree, (("columns", "cross", cross_before_column),))
    assert shape(new) == "dot(C) = [-[omega{^[B I]}{^!times} C]]"
