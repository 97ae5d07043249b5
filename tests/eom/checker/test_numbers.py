r"""Worked examples: arithmetic, units, rounding; true lines hold, slips are found."""

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from tests.eom.checker.system_lines import judged

LEXICON = r"""
[symbols]
'm' = {is = "scalar m", unit = "kg"}
'r' = {is = "scalar r", unit = "m"}
'\omega' = {is = "scalar omega", unit = "rad/s"}
'\theta' = "free_angle theta"
'I' = '= \frac12 m r^2'
'L' = '= I\omega'
'T' = '= \frac12 I\omega^2'
'F' = {is = "scalar F", unit = "N"}
"""
GIVEN = (r"m=2\,\text{kg}", r"r=30\,\mathrm{cm}", r"\omega = 50\,\mathrm{rad/s}")
LINES = {
    r"I=\tfrac12mr^2=\tfrac12(2)(0.3)^2=0.09\,\mathrm{kg\,m^2}": "holds",
    r"I=\tfrac12mr^2=\tfrac12(2)(0.3)^2=0.9\,\mathrm{kg\,m^2}": "wrong",
    r"I=\tfrac12mr^2=\tfrac12(3)(0.3)^2=0.135": "wrong",
    r"I=(2)(0.3)^2=0.18": "wrong",  # not that of a disc
    r"I = 0.09\,\text{kg}\,\text{m}^2": "holds",
    r"L=I\omega=0.09\cdot 50=4.5": "holds",
    r"L=I\omega=0.09\cdot 50=4.05": "wrong",
    r"T=\tfrac12I\omega^2\approx113\,\mathrm J": "holds",
    r"T=\tfrac12I\omega^2=112.5\,\text{J}": "holds",
    r"T=\tfrac12I\omega^2=1.125\times10^{2}\,\text{N m}": "holds",
    r"T=\tfrac12I\omega^2=0.1125\,\mathrm{kJ}": "holds",
    r"T=\tfrac12I\omega^2=112.4\,\text{J}": "wrong",
    r"T=\tfrac12I\omega^2=112.5\,\text{W}": "wrong",  # the unit of a power
    r"r\omega = 15\,\mathrm{m/s}": "holds",
    r"r\omega = 15\,\mathrm{m/s^2}": "wrong",
    r"\frac{\omega}{2\pi}\approx 7.96\,\mathrm{Hz}": "holds",
    r"\frac{\omega}{2\pi}\approx 8.96\,\mathrm{Hz}": "wrong",
    r"\sin 30^\circ = 0.5": "holds",
    r"\sin 30^\circ = 0.866": "wrong",
    r"\sqrt{2}\approx1.414": "holds",
    r"F = 3\,\mathrm{N}": "undecided",  # given
}


@pytest.mark.parametrize("line", LINES)
def test_arithmetic_units_and_rounding(line):
    *_, last = judged(parse_lexicon(LEXICON), *GIVEN, line)
    assert last.verdict == LINES[line]


def test_a_rounded_result_may_be_used_again():
    lines = (r"I = \tfrac12mr^2 = 0.0903", r"L = I\omega = 4.5", r"L = 4.515")
    given = (r"m=2.005\,\text{kg}", r"r=0.3001\,\mathrm{m}", r"\omega = 50")
    found = judged(parse_lexicon(LEXICON), *given, *lines)
    assert [f.verdict for f in found[3:5]] == ["holds", "holds"]


def test_numbers_of_a_system():
    lexicon = parse_lexicon(
        """
        [system]
        is = "heavy-body"
        attitude = "3-1-3"
        [system.symbols]
        'M' = "m"
        'l' = "r3"
        """
    )
    lines = [r"M = 0.5\,\text{kg}", r"l = 4\,\text{cm}", "g = 9.81"]
    lines += [
        r"Mgl = 0.5\cdot9.81\cdot0.04 = 0.196\,\mathrm{N\,m}",
        r"Mgl = 0.5\cdot9.81\cdot0.04=0.208",
    ]
    assert [f.verdict for f in judged(lexicon, *lines)][3:] == ["holds", "wrong"]


def test_exact_numbers_stay_claims():
    lexicon = parse_lexicon("preset = 'arrow-tilde'")
    assert [f.verdict for f in judged(lexicon, "2+2=4", "2+2=5", r"\cos^2 0 = 1")] == [
        "holds", "wrong", "holds",
    ]  # fmt: skip
