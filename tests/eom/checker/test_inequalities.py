"""Signs of order in notes: what is proved, what is refuted, what is a condition, what is left open."""

import pytest
import sympy as sp

from eom.checker.judge.inequalities import sign
from eom.checker.judge.judge import judge
from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import verdict
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document
from eom.fields import RATIONALS
from eom.terms.terms import number
from eom.terms.vocabulary import quantity
from eom.worlds.generators import world
from tests.eom.rows import every

LEXICON = parse_lexicon(
    r"""
preset = "schaub-junkins"
[symbols]
'J' = "inertia O in B"
'J_{<k>}' = "inertia O in B component <k> <k>"
'\mathbf{x}' = "vector x in B"
'\mathbf{y}' = "vector y in B"
'x' = "scalar x"
'\theta' = "turn_angle 2 321 B I"
"""
)


def judged(latex, given=("constant_mass",)):
    (found,) = understand(read_document(f"$${latex}$$\n"), LEXICON)
    return verdict(found, given)


HOLDS = [
    r"\mathbf{x}^T J\mathbf{x} \ge 0",
    r"0 \le \mathbf{x}^T J\mathbf{x}",
    r"I_1 + I_2 \ge I_3",
    r"I_2 + I_3 \ge I_1",
    r"I_3 \le I_1 + I_2",
    r"2I_{12} \le I_{33}",
    r"-2I_{23} \le I_{11}",
    r"I_1 \ge 0",
    r"T \ge 0",
    r"T_{rot} \ge 0",
    r"I_1\omega_1^2 + I_2\omega_2^2 + I_3\omega_3^2 \ge 0",
    r"\boldsymbol\omega^T[I]\boldsymbol\omega \ge 0",
    r"m > 0",
    r"x^2 + 1 > 0",
    r"\cos\theta \le 1",
    r"3 - \sin\theta\cos\theta \ge 2",
]
WITH_EXCEPTIONS = {
    r"\mathbf{x}^T J\mathbf{x} > 0": "free",
    r"I_1 + I_2 > I_3": "plane",
    r"T > 0": "at rest",
    r"J_1 > 0": None,
}
WRONG = [
    r"\mathbf{x}^T J\mathbf{x} < 0",
    r"\mathbf{x}^T J\mathbf{x} \le 0",
    r"I_1 + I_2 \le I_3",
    r"I_1 + I_2 < I_3",
    r"I_1 \ge I_2 + I_3",
    r"T < 0",
    r"T_{rot} \le 0",
    r"I_3 < 0",
    r"m < 0",
    r"\cos\theta > 1",
    r"x^2 + 1 < 0",
    r"T > T",
]
OPEN = {
    r"I_1 > I_2": "a condition",
    r"I_1 > I_2 > I_3": "a condition",
    r"I_1 \ge 10 I_2": "a condition",
    r"\mathbf{x}^T J\mathbf{y} \ge 0": "a condition",
    r"2I_{12} \le I_{11}": "a condition",
    r"x > 0": "a condition",
    r"x > 1000": "a condition",
    r"J_1 \ge I_1": "no counterexample",
    r"I_1 I_2 \ge I_{12}^2": "no counterexample",
    r"\mathbf H > 0": "only scalars",
}


@pytest.mark.parametrize("latex", HOLDS)
def test_what_is_proved_by_its_form(latex):
    assert judged(latex).verdict == "holds"


@pytest.mark.parametrize("latex", WITH_EXCEPTIONS)
def test_a_strict_sign_that_special_cases_break(latex):
    found = judged(latex)
    special = WITH_EXCEPTIONS[latex]
    assert found.verdict == ("holds under" if special else "undecided")
    assert not special or special in found.reason


@pytest.mark.parametrize("latex", every(3, WRONG))
def test_what_is_never_so_is_wrong_with_a_world_against_it(latex):
    found = judged(latex)
    assert found.verdict == "wrong"
    names, seed = found.claims[0].judgement.refuted
    assert world(frozenset(names), seed, RATIONALS).masses


@pytest.mark.parametrize("latex", every(3, OPEN))
def test_what_is_neither_is_left_open(latex):
    found = judged(latex)
    assert found.verdict == "undecided"
    assert OPEN[latex] in found.reason, found.reason


def test_links_of_a_chain_are_judged_each():
    chain = r"2T_{rot} = \boldsymbol\omega^T[I]\boldsymbol\omega \ge 0"
    assert judged(chain).claims[0].judgement.sets == (("body_frame",),)
    assert judged(chain, ("constant_mass", "body_frame")).verdict == "holds"
    assert judged(chain.replace("2T", "3T")).verdict == "wrong"
    assert judged(chain.replace("ge", "le")).verdict == "wrong"
    assert judged(r"I_1 + I_2 \ge I_3 > 2I_3").verdict == "wrong"


def test_signs_of_squares_and_numbers():
    x = quantity("scalar", "x")
    assert sign(x * x, True, {}, ()).found == "barely"
    assert sign(number(1), True, {}, ()).proved


def test_bodies_that_are_given_as_rigid_are_not_flattened():
    """Moving masses into a plane of B, which turns apart from the body, would make it no body."""
    (found,) = understand(read_document(r"$$I_1 + I_2 > I_3$$"), LEXICON)
    assert judge(found.claims[0], ("rigid",)).verdict == "undecided"
    assert judge(found.claims[0], ("body_frame",)).verdict == "holds under"


def test_symbols_count_by_what_they_stand_for():
    symbol = sp.Symbol("a", real=True)
    (claim,) = understand(read_document(r"$$x^2 \ge 0$$"), LEXICON)[0].claims
    assert symbol not in claim.scalars
    assert judge(claim).verdict == "holds"
