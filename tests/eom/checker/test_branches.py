r"""Cases, logarithms, exponentials, inverse functions: where signs and ranges of numbers matter."""

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from tests.eom.checker.system_lines import judged

LEXICON = r"""
[symbols]
't' = "time"
'M' = {is = "coordinate M", unit = "kg"}
'M_0' = {is = "scalar M_0", unit = "kg"}
'M_1' = {is = "scalar M_1", unit = "kg"}
'u' = {is = "coordinate u", unit = "m/s"}
'c' = {is = "scalar c", unit = "m/s"}
's' = {is = "coordinate s", unit = "m"}
'z' = {is = "coordinate z", unit = "m"}
'b' = {is = "scalar b", unit = "m"}
'k' = {is = "scalar k", unit = "N/m"}
'\lambda' = {is = "scalar lambda", unit = "1/s"}
'\theta' = "free_angle theta"
'\beta' = "defined"
'U' = "defined"
'F' = "defined"
"""
HOLDS, WRONG, OPEN, NAMED = "holds", "wrong", "undecided", "definition"
LINES = {
    r"\frac{d}{dt}\ln M = \frac{\dot M}{M}": HOLDS,
    r"\frac{d}{dt}\left(c\ln\frac{M_0}{M}\right) = -c\frac{\dot M}{M}": HOLDS,
    r"c\ln M_0 - c\ln M_1 = c\ln\frac{M_0}{M_1}": HOLDS,
    r"c\ln M_0 - c\ln M_1 = c\ln\frac{M_1}{M_0}": WRONG,
    r"u = c\ln M": WRONG,  # a unit is left in the logarithm
    r"\int_{M_1}^{M_0}\frac{dM}{M} = \ln\frac{M_0}{M_1}": HOLDS,
    r"\int_{M_1}^{M_0}\frac{dM}{M} = \ln\frac{M_1}{M_0}": WRONG,
    r"\frac{d}{dt}\left(s e^{-\lambda t}\right) = (\dot s - \lambda s)e^{-\lambda t}": HOLDS,
    r"\frac{d}{dt}\left(s e^{-\lambda t}\right) = (\dot s + \lambda s)e^{-\lambda t}": WRONG,
    r"\cosh^2\theta - \sinh^2\theta = 1": HOLDS,
    r"\frac{d}{dt}\arctan\frac{z}{s} = \frac{s\dot z - z\dot s}{s^2+z^2}": HOLDS,
    r"\frac{d}{dt}\arctan\frac{z}{s} = \frac{s\dot z + z\dot s}{s^2+z^2}": WRONG,
    r"\arctan(\tan\theta) = \theta": OPEN,
    r"\arcsin(\sin\theta) = \theta": OPEN,
    r"|u| = \begin{cases} u & u\ge 0\\ -u & u<0\end{cases}": HOLDS,
    r"|u| = \begin{cases} u, & \text{if } u > 0,\\ u, & \text{otherwise.}\end{cases}": WRONG,
    r"|s - b| = \begin{dcases} b - s & \text{for } s \le b \\ s - b & \text{for } s > b\end{dcases}": HOLDS,
    r"|s - b| = \begin{cases} s - b, & s<b\\ b - s, & s>b\end{cases}": WRONG,
    r"|u| = \begin{cases} u & \text{on dry days}\\ -u & u<0\end{cases}": OPEN,
    r"|u| = u": OPEN,
    r"u\,\operatorname{sgn} u = |u|": HOLDS,
}  # fmt: skip


@pytest.mark.parametrize("line", LINES)
def test_branches(line):
    (found,) = judged(parse_lexicon(LEXICON), line)
    assert found.verdict == LINES[line]


def test_an_angle_in_the_plane_has_its_branch():
    lines = {
        r"\beta = \operatorname{atan2}(z, s)": NAMED,
        r"\dot\beta = \frac{s\dot z - z\dot s}{s^2+z^2}": HOLDS,
        r"\dot\beta = \frac{z\dot s - s\dot z}{s^2+z^2}": WRONG,
        r"\tan\beta = \frac{z}{s}": HOLDS,
        r"\cos\beta = \frac{s}{\sqrt{s^2+z^2}}": HOLDS,
        r"\beta = \arctan\frac{z}{s}": OPEN,
        r"\beta = \operatorname{atan2}(s, z)": WRONG,
    }
    found = judged(parse_lexicon(LEXICON), *lines)
    assert [f.verdict for f in found] == list(lines.values())
    assert "sign or a range" in found[5].reason


def test_a_law_in_pieces_is_the_slope_of_an_energy_in_pieces():
    lines = {
        r"U = \begin{cases} \tfrac12 k(s-b)^2, & s > b \\ 0, & s\le b \end{cases}": NAMED,
        r"F = \begin{cases} -k(s-b), & s > b \\ 0, & s\le b \end{cases}": NAMED,
        r"F = -\frac{\partial U}{\partial s}": HOLDS,
        r"F = \frac{\partial U}{\partial s}": WRONG,
        r"\dot U = -F\dot s": HOLDS,
    }
    found = judged(parse_lexicon(LEXICON), *lines)
    assert [f.verdict for f in found] == list(lines.values())
