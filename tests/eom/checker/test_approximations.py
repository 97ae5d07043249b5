r"""Equations that hold nearly: to the order that is written, in what may be small."""

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from tests.eom.checker.system_lines import judged

LEXICON = r"""
[symbols]
'x' = "scalar x"
'\epsilon' = "scalar epsilon"
'\theta' = "free_angle theta"
'l' = {is = "scalar l", unit = "m"}
"""
LINES = {
    r"\sin\theta\approx\theta": "holds",
    r"\sin\theta\approx2\theta": "wrong",
    r"\sin\theta\simeq\theta-\frac{\theta^3}{6}": "holds",
    r"\sin\theta\simeq\theta+\frac{\theta^3}{6}": "wrong",
    r"\cos\theta\approx1-\tfrac12\theta^2": "holds",
    r"\cos\theta\approx1-\theta^2": "wrong",
    r"\cos\theta\approx 1": "holds",
    r"\tan\theta\approx\sin\theta\approx\theta": "holds",
    r"\tan\theta\approx2\sin\theta": "wrong",
    r"l\cos\theta\,\dot\theta\approx l\dot\theta": "holds",
    r"(1+\epsilon)^2\approx1+2\epsilon": "holds",
    r"(1+\epsilon)^2\approx1+\epsilon": "wrong",
    r"\frac{1}{1+x}\approx1-x": "holds",
    r"\frac{1}{1+x}\approx1+x": "wrong",
    r"\frac1{1+\epsilon}=1-\epsilon+O(\epsilon^2)": "holds",
    r"\frac1{1+\epsilon}=1-\epsilon+O(\epsilon^3)": "wrong",
    r"\sqrt{1+\epsilon}=1+\tfrac12\epsilon-\tfrac18\epsilon^2+\mathcal O(\epsilon^3)": "holds",
    r"\sqrt{1+\epsilon}=1+\tfrac12\epsilon+\tfrac18\epsilon^2+\mathcal O(\epsilon^3)": "wrong",
    r"\sinh x\approx\cosh x": "undecided",  # where x is large
    r"\frac{1}{x}\approx x": "undecided",
}


@pytest.mark.parametrize("line", LINES)
def test_formulas(line):
    assert [v.verdict for v in judged(parse_lexicon(LEXICON), line)] == [LINES[line]]


@pytest.mark.slow
def test_a_system():
    lexicon = parse_lexicon(
        """
        [system]
        is = "double-pendulum"
        [system.symbols]
        'q_1' = "q_shoulder"
        'q_2' = "q_elbow"
        'V' = "potential_energy"
        'a' = '= m_1l_1/2+m_2l_1'
        'm_1' = "m1"
        'm_2' = "m2"
        'l_1' = "l1"
        'l_2' = "l2"
        """
    )
    lines = {
        r"V\approx-ga(1-\tfrac12q_1^2)-\tfrac12gl_2m_2(1-\tfrac12(q_1+q_2)^2)": "holds",
        r"V\approx-ga(1-\tfrac12q_1^2)-\tfrac12gl_2m_2(1-\tfrac12(q_1-q_2)^2)": "wrong",
        r"\frac{\partial V}{\partial q_2}\approx\tfrac12gl_2m_2(q_1+q_2)": "holds",
        r"\frac{\partial V}{\partial q_2}\approx\tfrac12gl_2m_2q_2": "wrong",
        r"\dot q_1\approx2\dot q_1": "wrong",
    }
    assert [v.verdict for v in judged(lexicon, *lines)] == list(lines.values())
