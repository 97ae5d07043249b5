"""Integrals over solids and closed forms of their inertia, against the catalogue of solids and books."""

import pytest
import sympy as sp

from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.mean.model import load_model, printed
from eom.errors import InputError
from eom.mass.solids import MASS, central_inertia
from tests.eom.checker.system_lines import judged
from tests.eom.rows import every

SIMPLE = [
    "box",
    "cylinder",
    "hollow cylinder",
    "sphere",
    "hollow sphere",
    "ellipsoid",
    "rod",
    "ring",
    "disc",
]


def verdicts(text, *lines):
    return [v.verdict for v in judged(parse_lexicon(text), *lines)]


@pytest.mark.parametrize("name", every(3, SIMPLE))
def test_integrals_of_every_solid(name):
    names = {q.symbol: printed(q) for q in load_model(name).quantities.values()}
    J = central_inertia(name)
    integrands = ("y^2 + z^2", "x^2 + z^2", "x^2 + y^2")
    right = [
        rf"I_{k + 1} = \int ({e})\,dm = {sp.latex(J[k, k], symbol_names=names)}"
        for k, e in enumerate(integrands)
    ]
    wrong = [
        rf"\int ({e})\,dm = {sp.latex(J[k, k] + MASS * size**2 / 7, symbol_names=names)}"
        for k, e in enumerate(integrands)
        for size in sorted(J.free_symbols - {MASS}, key=str)[:1]
    ]
    found = verdicts(f'system = "{name}"', *right, *wrong)
    assert found == ["holds"] * 3 + ["wrong"] * len(wrong)


ROD = r"""
[system]
is = "rod"
point = "end"
[system.symbols]
'x' = "z"
'I_A' = "I1_end"
'I_G' = "I1"
"""


def test_the_theorem_of_parallel_axes():
    lines = [
        r"I_A = \int x^2\,dm = \frac13 m L^2",
        r"I_A = I_G + m\left(\frac L2\right)^2",
        r"I_G = \frac1{12} m L^2",
        r"I_G = I_A + \frac14 m L^2",
        r"I_A = I_G + m L^2",
        r"\int x\,dm = \frac12 m L",
        r"\int x\,dm = 0",
    ]
    expected = ["holds"] * 3 + ["wrong", "wrong", "holds", "wrong"]
    assert verdicts(ROD, *lines) == expected
    found = judged(parse_lexicon(ROD), lines[3])[0]
    assert found.reason == "wrong sign: length^2*mass/4"


def test_books_and_what_is_no_integral():
    lines = [
        r"I_x = I_y = \frac{m}{12}(3R^2 + h^2)",
        r"I_x = \frac{m}{12}(3R^2 + h)",
        r"I_x = \frac{m h^2}{12}",
        r"I_{zz} = m R^2",
        r"\int x y\,dm = 0",
        r"x = 0",
        r"\int x^6\,dm = 0",
    ]
    expected = ["holds", "wrong", "wrong", "wrong", "holds", "undecided", "undecided"]
    assert verdicts('system = "cylinder"', *lines) == expected


def test_an_unknown_point():
    with pytest.raises(InputError, match="end"):
        parse_lexicon('system = {is = "rod", point = "edge"}')
