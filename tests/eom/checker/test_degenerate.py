"""What holds by chance alone is wrong; what a claim says of a term that vanishes is not."""

import pytest

from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import verdict
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document

LEXICON = parse_lexicon(r"""
preset = "arrow-tilde"
[points]
'O' = "OI"
'Q' = "O"
'P' = "P"
'C' = "C"
[symbols]
'\vec{r}_{<P>/<Q>}' = "position <P> <Q>"
'\vec{v}_{<P>}' = '= \dot{\vec{r}}_{<P>/O}'
'\vec{u}' = "vector u"
'\vec{\tau}_{<P>}' = "torque body <P>"
'\vec{h}_{<P>}' = "angular_momentum body <P>"
'\vec{M}' = "torque body C"
""")


def judged(formula):
    (understood,) = understand(read_document(f"$${formula}$$"), LEXICON)
    return verdict(understood, ("constant_mass",))


B = r"\frac{^B d\vec{r}_{P/Q}}{dt}"


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        # right for a particle at the origin of the moving frame alone
        (
            rf"\dot{{\vec r}}_{{P/O}} = \dot{{\vec r}}_{{Q/O}} + 2{B} + \vec\omega\times\vec r_{{P/Q}}",
            "wrong",
        ),
        (
            rf"\dot{{\vec r}}_{{P/O}} = \dot{{\vec r}}_{{Q/O}} + {B} + \vec\omega\times\vec r_{{P/Q}}",
            "holds",
        ),
        (r"\vec\tau_Q = \vec\tau_C + \vec F\times\vec r_{C/Q}", "wrong"),
        (r"\vec\tau_Q = \vec\tau_C - \vec F\times\vec r_{C/Q}", "holds"),
        # these say that a term vanishes
        (r"\vec r_{P/O} = \vec r_{Q/O} + \vec r_{P/Q} = \vec r_{Q/O}", "holds under"),
        (r"\vec r_{C/Q} = 0", "holds under"),
        (r"\dot{\vec h}_Q = \vec\tau_Q", "holds under"),
    ],
)
def test_terms_that_vanish(formula, expected):
    assert judged(formula).verdict == expected


def test_a_model_that_the_note_does_not_have_is_no_assumption():
    wrong = r"I_2\dot\omega_2 = L_2 + (I_1 - I_3)\,\omega_3\omega_1"
    assert judged(wrong).verdict == "wrong"


def test_a_line_with_a_condition_that_no_world_knows_is_undecided():
    claim = r"\dot{\vec r}_{P/O} = \dot{\vec r}_{Q/O} + \vec\omega\times\vec r_{P/Q}"
    found = judged(rf"\text{{if }} {B} = 0:\quad {claim}")
    assert found.verdict == "undecided"
    assert "condition" in found.reason
    assert judged(claim).verdict in {"wrong", "holds under"}


def test_labels_of_the_house_are_not_those_of_the_note():
    # O is the inertial origin of the note; the point that the checker calls O is Q
    assert judged(r"\vec v_Q = \dot{\vec r}_{Q/O}").verdict in {"holds", "definition"}
    assert judged(r"\vec v_Q = 0").verdict == "holds under"
