"""Verdicts and smallest sets of assumptions of typical claims."""

import pytest

from eom.checker.judge.judge import DEFINITION, HOLDS, UNDECIDED, UNDER, WRONG, judge
from eom.checker.judge.models import equations
from eom.checker.mean.lexicon_files import parse_lexicon, preset
from eom.worlds.evaluate import Evaluator
from eom.worlds.generators import world
from eom.worlds.worlds import closure
from tests.eom.checker.test_claims import claimed

LEXICON = parse_lexicon(
    r"""
preset = 'arrow-tilde'
[points]
'Q' = 'O'
[symbols]
'\vec a' = 'vector a'
'\vec b' = 'vector b'
'x' = 'scalar x'
'y' = 'scalar y'
'\vec\rho' = 'position dm O'
'\vec H_Q' = 'angular_momentum body O'
'\vec p_{<i>}' = 'linear_momentum <i>'
'\vec f_{<i>}' = 'force <i>'
'\vec p' = 'linear_momentum system'
"""
)
STEADY = ("constant_mass",)

VERDICTS = {
    r"\vec a\times\vec b = -\vec b\times\vec a": (HOLDS, set()),
    r"\vec a\times\vec b = \vec b\times\vec a": (WRONG, set()),
    r"\dot{\vec H}_C = \vec\tau_C": (UNDER, {("newton_2", "third_law_strong")}),
    r"\dot{\vec p} = \sum_{i=1}^N\vec f_i": (UNDER, {("newton_2", "third_law_weak")}),
    r"\vec H_C = [I]\vec\omega": (UNDER, {("body_frame",)}),
    r"\int_B\vec\rho\,dm = 0": (UNDER, {("about_centre",)}),
    r"\vec H_Q = \int_B\vec\rho\times(\vec\omega\times\vec\rho)\,dm": (
        UNDER,
        {("about_centre", "body_frame"), ("body_frame", "O_fixed_in_body")},
    ),
    r"I_{11}\dot\omega_1 = (I_{22} - I_{33})\omega_2\omega_3 + L_1": (
        UNDER,
        {("newton_2", "third_law_strong", "principal_axes")},
    ),
    r"I_{11}\dot\omega_1 = (I_{33} - I_{22})\omega_2\omega_3 + L_1": (WRONG, None),
    r"x^2 + y^2 = 1": (DEFINITION, set()),
    r"x > 0": (UNDECIDED, set()),
    r"|\vec a + \vec b| = |\vec a|": (WRONG, set()),
    r"|\vec a + \vec b| = x|\vec a|": (UNDECIDED, set()),
    r"|x\vec a| = x|\vec a|": (UNDECIDED, set()),
}


@pytest.mark.parametrize("text", VERDICTS)
def test_verdicts_and_smallest_sets(text):
    verdict, sets = VERDICTS[text]
    (claim,) = claimed(text, LEXICON)
    found = judge(claim, STEADY)
    if sets is None:
        special = {"symmetric", "symmetric_1", "symmetric_2", "torque_free"}
        assert found.verdict in {WRONG, UNDER}
        assert all(special & set(s) for s in found.sets)
        return
    assert found.verdict == verdict, found
    assert {tuple(sorted(s)) for s in found.sets} >= {tuple(sorted(s)) for s in sets}


@pytest.mark.parametrize("text", [t for t, (v, _) in VERDICTS.items() if v == UNDER])
def test_every_set_is_enough_and_no_smaller_one_is(text):
    (claim,) = claimed(text, LEXICON)
    found = judge(claim, STEADY)
    for names in found.sets:
        assert judge(claim, (*STEADY, *names)).verdict == HOLDS
        for name in names:
            fewer = [n for n in closure(names) if name not in closure([n])]
            assert judge(claim, (*STEADY, *fewer)).verdict != HOLDS


FREE = parse_lexicon(
    r"""
preset = 'arrow-tilde'
[symbols]
'\vec a' = 'vector a'
'\vec b' = 'vector b'
'\vec c' = 'vector c'
'q' = 'scalar q'
'x' = 'coordinate x'
'y' = 'coordinate y'
'X' = '= x y'
"""
)
RATES = {
    r"\dot{\vec a} = q\vec b\times\vec c": UNDECIDED,
    r"\dot{\vec a} = -\dot{\vec b}": UNDECIDED,
    r"\dot{\vec a} = q\ddot{\vec a} + \vec b": UNDECIDED,
    r"\ddot{\vec a} = \dot{\vec a}\times\vec a + \dot{\vec b}\times\vec b": UNDECIDED,
    r"\ddot{\vec a} = -\vec a": UNDECIDED,
    r"\ddot x y = x\ddot y": UNDECIDED,
    r"\frac{^Id\vec a}{dt} = \frac{^Bd\vec a}{dt} + \dot{\vec c}\times\vec a": UNDECIDED,
    r"\dot{\vec a} = \dot{\vec b}\times\vec a + \vec b\times\dot{\vec a}": WRONG,
    r"\frac{d}{dt}(\vec a\times\vec b) = \dot{\vec b} + \dot{\vec a}\times\vec b": WRONG,
    r"\frac{^Id\vec a}{dt} = \frac{^Bd\vec a}{dt} + \vec b\times\frac{^Bd\vec b}{dt} + \dot{\vec b}": WRONG,
    r"\dot X = \dot x y - x\dot y": WRONG,
    r"\dot X = \dot x y + x\dot y": HOLDS,
}


@pytest.mark.parametrize("text", RATES)
def test_a_law_may_give_what_is_free_but_makes_no_other_kinematics(text):
    (claim,) = claimed(text, FREE)
    assert judge(claim).verdict == RATES[text]


def test_what_is_refuted_is_false_in_that_world():
    (claim,) = claimed(r"\vec a\times\vec b = \vec b\times\vec a", LEXICON)
    names, seed = judge(claim).refuted
    evaluator = Evaluator(world(frozenset(names), seed), claim.scalars)
    assert not all(evaluator.holds(q) for q in equations(claim))


def test_that_points_are_the_same_is_said_not_claimed():
    (claim,) = claimed(r"O \equiv \bullet", preset("underline-bullet"))
    assert judge(claim).verdict == DEFINITION
    assert ("about_centre",) in judge(claim).sets


def test_angles_exist_in_their_own_worlds():
    lexicon = preset("left-superscript")
    text = (
        r"{}^{\mathcal B}C^{\mathcal A} = \begin{bmatrix}1&0&0\\0&\cos\theta&\sin\theta\\"
        r"0&-\sin\theta&\cos\theta\end{bmatrix}"
    )
    (claim,) = claimed(text, lexicon)
    assert (judge(claim).verdict, judge(claim).context) == (HOLDS, ("spin_312",))
    (slip,) = claimed(text.replace("-", ""), lexicon)
    assert judge(slip).verdict == WRONG


def test_a_claim_about_points_of_two_frames():
    lexicon = parse_lexicon(
        r"""
preset = 'underline-bullet'
[symbols]
'\underline{J}_{<F>}' = "inertia O<F> in B"
'\underline{I}' = "inertia C in B"
'\underline{r}_{<F><G>}' = "position O<F> O<G> in B"
'm' = "total_mass body"
"""
    )
    (claim,) = claimed(
        r"\underline{J}_B = \underline{I} - m\underline{r}_{BA}^\times\underline{r}_{BA}^\times",
        lexicon,
    )
    assert judge(claim).sets == (("OA_at_centre",),)
