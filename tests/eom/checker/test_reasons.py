"""Repairs of lines with other points, tables and two slips, and what is said of them in a sentence."""

import pytest

from benchmarks.checking import GIVEN, same
from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import GRAVE, verdict
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document
from eom.checker.repair.explaining import explain
from eom.checker.repair.reasons import SENTENCES
from eom.checker.repair.slips import SLIPS
from tests.eom.checker.true_lines import ARROWS, SUPERSCRIPTS

TURNS = parse_lexicon(
    r"""
preset = 'arrow-tilde'
[symbols]
'p' = 'angular_velocity B I in B component 1'
'q' = 'angular_velocity B I in B component 2'
'r' = 'angular_velocity B I in B component 3'
'a' = 'turn_angle 1 321 B I'
'b' = 'turn_angle 2 321 B I'
'c' = 'turn_angle 3 321 B I'
'u' = 'turn_angle 1 313 B I'
'v' = 'turn_angle 2 313 B I'
'w' = 'turn_angle 3 313 B I'
"""
)
POINTS = parse_lexicon(
    r"""
preset = 'arrow-tilde'
[points]
'P' = 'O'
[symbols]
'\vec h' = 'absolute_angular_momentum system O'
'\vec n' = 'torque system O'
'\vec x' = 'position O OI'
'\vec y' = 'position C OI'
'm' = 'total_mass system'
"""
)
TABLE = (
    r"{{}}^{{\mathcal B}}C^{{\mathcal A}} = \begin{{bmatrix}}1&0&0\\0&\cos\theta&{}\\"
    r"0&{}&\cos\theta\end{{bmatrix}}"
)
SEQUENCE = parse_lexicon(
    r"""
[symbols]
'C' = "rotation B I"
'R_1' = "turn 1"
'R_2' = "turn 2"
'R_3' = "turn 3"
'a' = "turn_angle 1 321 B I"
'b' = "turn_angle 2 321 B I"
'c' = "turn_angle 3 321 B I"
"""
)
SCALARS = parse_lexicon(
    r"""
[symbols]
'x' = "scalar x"
'y' = "scalar y"
'z' = "= 1 - x^2 y"
'w' = "= (x + y)^2"
"""
)
LINES = {
    "a power of a sum for the sum of powers": (
        SCALARS,
        "z = (1 - x)^2 y + 1 - y",
        "z = (1 - x^2) y + 1 - y",
        "the power of a sum",
    ),
    "a sum of powers for the power of the sum": (
        SCALARS,
        "3 w = 3 (x^2 + y^2)",
        "3 w = 3 (x + y)^2",
        "the power of a sum",
    ),
    "a product the other way round": (
        SEQUENCE,
        "C = R_3(a) R_2(b) R_1(c)",
        "C = R_1(c) R_2(b) R_3(a)",
        "the wrong order",
    ),
    "two slips in a term, two sequences in the lexicon": (
        TURNS,
        r"\dot a = (q\cos c + r\sin c)\frac{1}{\cos b}",
        r"\dot a = (q\sin c + r\cos c)\frac{1}{\cos b}",
        "are exchanged",
    ),
    "a point that moves freely": (
        POINTS,
        r"\vec n = \dot{\vec h} - \dot{\vec x}\times m\dot{\vec y}",
        r"\vec n = \dot{\vec h} + \dot{\vec x}\times m\dot{\vec y}",
        "the sign of",
    ),
    "a table turned over": (
        SUPERSCRIPTS,
        TABLE.format(r"-\sin\theta", r"\sin\theta"),
        TABLE.format(r"\sin\theta", r"-\sin\theta"),
        "the table is transposed",
    ),
    "the term of a turning frame": (
        ARROWS,
        r"\dot{\vec H}_C = \frac{^B d\vec H_C}{dt}",
        r"\dot{\vec H}_C = \frac{^B d\vec H_C}{dt} + \vec\omega\times\vec H_C",
        r"the derivative was taken in $B$: $\vec{\omega} \times \vec{H}_{C}$ is missing",
    ),
    "another number": (
        ARROWS,
        r"T_{rot} = \frac{3}{4}\vec\omega\cdot\vec H_C",
        r"T_{rot} = \frac{1}{2}\vec\omega\cdot\vec H_C",
        "the number is wrong",
    ),
    "a component that stands nowhere": (
        ARROWS,
        r"I_{1}\dot\omega_1 = (I_{2} - I_{3})\omega_2 + L_1",
        r"I_{1}\dot\omega_1 = (I_{2} - I_{3})\omega_2\omega_3 + L_1",
        r"the factor $\omega_{3}$ was forgotten",
    ),
}


@pytest.mark.sparse(6)
@pytest.mark.parametrize("name", LINES)
def test_what_was_meant_is_offered_and_said(name):
    lexicon, text, meant, words = LINES[name]
    understood = understand(read_document(f"$${text}$$"), lexicon)[0]
    judged = next(j for j in verdict(understood, GIVEN).claims if j.verdict in GRAVE)
    found = explain(understood, judged, GIVEN)
    assert any(same(understood, c.latex, meant) for c in found.corrections)
    assert words in found.reason


def test_every_slip_has_a_sentence():
    assert {s.name for s in SLIPS} <= set(SENTENCES)
    assert len(SENTENCES) >= 25
