r"""Cases, magnitudes and signs in lines about a system, judged in real numbers."""

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from tests.eom.checker.system_lines import judged

HOOP = parse_lexicon(
    r"""
    [system]
    coordinates = { q = "rad" }
    given = { phi = "rad" }
    assume = ["phi_dot constant"]
    parameters = { m = "kg", R = "m", g = "m/s^2" }
    gravity = [0, 0, "-g"]
    [system.bodies]
    bead = { mass = "m", at = ["R*sin(q)*cos(phi)", "R*sin(q)*sin(phi)", "-R*cos(q)"] }
    [system.motions]
    rest = { constant = ["q"] }
    [system.symbols]
    '\Omega' = "phi_dot"
    '\theta' = "q"
    '\theta_e' = "q at rest"
    """
)
EQUILIBRIUM = (
    r"\theta_e=\begin{cases}0&\Omega^2%s g/R\\\arccos\frac{%s}{%s}&\Omega^2%s g/R\end{cases}"
)
LINES = {
    EQUILIBRIUM % ("<", "g", r"R\Omega^2", ">"): "holds",
    r"|\theta|=\begin{cases}\theta&\theta>0\\-\theta&\theta\le0\end{cases}": "holds",
    r"T=\begin{cases}\tfrac12mR^2\dot\theta^2&\theta>0\\0&\theta<0\end{cases}": "wrong",
    r"|\dot\theta|=\dot\theta": "undecided",
}
OTHERS = {
    EQUILIBRIUM % ("<", r"R\Omega^2", "g", ">"): "wrong",
    EQUILIBRIUM % (">", "g", r"R\Omega^2", "<"): "wrong",
    r"|\dot\theta|=\sqrt{\dot\theta^2}": "holds",
    r"\operatorname{sgn}(\dot\theta)|\dot\theta|=\dot\theta": "holds",
    r"\frac{d}{dt}|\theta|=2\dot\theta": "wrong",
}


@pytest.mark.parametrize("line", LINES)
def test_cases(line):
    assert [v.verdict for v in judged(HOOP, line)] == [LINES[line]]


@pytest.mark.slow
@pytest.mark.parametrize("line", OTHERS)
def test_other_cases(line):
    assert [v.verdict for v in judged(HOOP, line)] == [OTHERS[line]]
