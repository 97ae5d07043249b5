r"""Worked examples: arithmetic, units, rounding; true lines hold, slips are found."""

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.note.checking import check
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


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        (r"m\tan\theta = 2\cdot0.577 = 1.15", "holds"),
        (r"m\tan\theta = 2\cdot0.577 = 1.155", "holds"),
        (r"m\tan\theta = 2\cdot0.577 = 1.54", "wrong"),
        (r"m\tan\theta = 2\cdot0.57 = 1.14", "wrong"),
        (r"m\sin\theta = 2\cdot0.577 = 1.15", "wrong"),
        (r"\frac{m\tan\theta}{r} = \frac{2\cdot0.577}{0.3} = 3.85", "holds"),
        (r"\frac{m\tan\theta}{r} = \frac{2\cdot0.577}{0.31} = 3.72", "wrong"),
        (r"\frac{m\tan\theta}{r} = \frac{2\cdot0.577}{0.3} = 3.85 = 22.1^\circ", "wrong"),
    ],
)
def test_decimals_that_nobody_has_given_are_known_to_their_digits(line, wanted):
    given = (*GIVEN, r"\theta = 30^\circ")
    *_, last = judged(parse_lexicon(LEXICON), *given, line)
    assert last.verdict == wanted


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


UNITS = r"""
[symbols]
'v' = {is = "scalar v", unit = "m/s"}
's' = {is = "scalar s", unit = "m"}
'E' = {is = "scalar E", unit = "J"}
'm' = {is = "scalar m", unit = "kg"}
'n' = {is = "scalar n", unit = "1/s"}
'\Omega' = {is = "scalar Omega", unit = "rad/s"}
't' = {is = "scalar t", unit = "s"}
'\mu' = {is = "scalar mu", unit = "1"}
'\alpha' = {is = "scalar alpha", unit = "rad"}
"""


def verdicts(*lines):
    return [f.verdict for f in judged(parse_lexicon(UNITS), *lines)]


def test_a_wrong_number_defines_nothing():
    found = verdicts(
        r"m=2\,\mathrm{kg}",
        r"v = 36\,\mathrm{km/h} = 36\,\mathrm{m/s}",
        r"E=\frac12 m v^2 = 100\,\mathrm{J}",
        r"v = 10\,\mathrm{m/s}",
        r"mv = 72\,\mathrm{kg\,m/s}",
    )
    assert found[1:] == ["wrong", "holds", "holds", "wrong"]
    found = verdicts(r"m=4\,\mathrm{kg}", r"v=3\,\mathrm{m/s}", r"E=\frac12mv^2=36", r"2E = 36")
    assert found[2:] == ["wrong", "holds"]
    # a unit that cannot be that of the quantity gives no number
    assert verdicts(r"v = 36\,\mathrm{km}=36000\,\mathrm{m}", r"2v=20\,\mathrm{m/s}") == [
        "wrong", "undecided",
    ]  # fmt: skip


@pytest.mark.parametrize(
    "lines",
    [
        (r"n = 600\,\mathrm{rpm}", r"\Omega=2\pi n = 62.8\,\mathrm{rad/s}"),
        (r"n = 600\,\mathrm{rpm}", r"\Omega=2\pi n = 2\pi\cdot 10 = 62.8\,\mathrm{s^{-1}}"),
        (r"n = 10\,\mathrm{rev/s}", r"\Omega=2\pi n = 62.8\,\mathrm{rad/s}"),
        (r"n = 600\,\mathrm{rpm}", r"n = 10\,\mathrm{1/s}"),
        (r"\Omega = 600\,\mathrm{rpm}", r"\frac{\Omega}{2\pi} = 10\,\mathrm{Hz}"),
        (r"n = 10\,\mathrm{Hz}", r"\Omega = 2\pi n = 600\,\mathrm{rpm}"),
    ],
)
def test_turns_are_cycles_or_radians_by_what_they_are_of(lines):
    assert verdicts(*lines)[-1] == "holds"
    wrong = lines[1].replace("62.8", "395").replace("10\\,", "63\\,").replace("= 600", "= 95")
    assert verdicts(lines[0], wrong)[-1] == "wrong"


FURTHER = {
    r"0.2\,\mathrm{m} + 5\,\mathrm{s} = 5.2\,\mathrm{m}": "ill-formed",
    r"s = 2\,\mathrm{kg} - 5\,\mathrm{cm} = 1.95\,\mathrm{m}": "ill-formed",
    r"s = 0.2\,\mathrm{m} + 30\,\mathrm{cm} = 0.5\,\mathrm{m}": "holds",
    r"\tan^{-1}(1) = 45^\circ": "holds",
    r"\sin^{-1} 0.5 = 30°": "holds",
    r"\cos^{-1}(0.5) = 30^\circ": "wrong",
    r"\arctan 0.75 = 36.9^\circ": "holds",
    r"\arctan 0.75 = 36.8^\circ": "wrong",
    r"\alpha = 30° = 0.524\,\mathrm{rad}": "holds",
    r"E = 2\,\mathrm{kWh} = 7.2\,\mathrm{MJ}": "holds",
    r"E = 2\,\text{kWh} = 72\,\text{MJ}": "wrong",
    r"t = 2\,\mathrm{day} = 48\,\mathrm{h}": "holds",
    r"s = 5\,\mathrm{µm} = 0.005\,\mathrm{mm}": "holds",
    r"s = 5\,\mu\mathrm{m} = 5\times10^{-6}\,\mathrm{m}": "holds",
    r"s = 5\,\text{µm} = 0.05\,\text{mm}": "wrong",
    r"v = 54\,\text{km/h} = 15\,\text{m/s}": "holds",
}


@pytest.mark.parametrize("line", FURTHER)
def test_units_and_inverse_functions(line):
    assert verdicts(line) == [FURTHER[line]]


def test_a_letter_is_no_prefix_where_no_unit_follows():
    assert verdicts(r"\mu = 0.3", r"2\mu = 0.6", r"2\mu = 0.8") == ["undecided", "holds", "wrong"]


def test_the_argument_of_an_inverse_function_is_a_ratio():
    lines = (r"s=3\,\mathrm{m}", r"t=4\,\mathrm{s}", r"v=5\,\mathrm{m/s}")
    assert verdicts(*lines, r"\arctan v/s = 59.0^\circ")[-1] == "holds"
    assert verdicts(*lines, r"\tan^{-1} s/v = 31.0^\circ")[-1] == "holds"


EXAMPLES = r"""+++
[check.symbols]
'm' = {is = "scalar m", unit = "kg"}
'v' = {is = "scalar v", unit = "m/s"}
'p' = {is = "scalar p", unit = "kg m/s"}
'E' = {is = "scalar E", unit = "J"}
+++
# One
Let $m = 2\,\mathrm{kg}$ and $v = 3\,\mathrm{m/s}$.
$$p = mv = 6\,\mathrm{kg\,m/s}$$
$$E = \frac12 pv = 9\,\mathrm{J}$$
# Two
Let $m = 5\,\mathrm{kg}$ and $v = 3\,\mathrm{m/s}$.
"""


@pytest.mark.parametrize(
    ("lines", "wanted"),
    [
        ((r"p = mv = 15\,\mathrm{kg\,m/s}", r"E = \frac12 pv = 22.5\,\mathrm{J}"), "holds holds"),
        ((r"p = mv = 6\,\mathrm{kg\,m/s}", r"E = \frac12 pv = 9\,\mathrm{J}"), "wrong wrong"),
        ((r"E = \frac12 mv^2 = 22.5\,\mathrm{J}",), "holds"),  # p is not worked out again
        ((r"E = \frac12 mv^2 = 9\,\mathrm{J}",), "wrong"),
        ((r"m = 5\,\mathrm{kg}", r"v = 4\,\mathrm{m/s}"), "holds wrong"),  # given, not worked out
    ],
)
def test_a_number_is_forgotten_when_what_it_was_worked_out_from_is_given_anew(lines, wanted):
    found = check(EXAMPLES + "".join(f"$${line}$$\n" for line in lines)).findings
    shown = [f.verdict for f in found if f.kind == "display"]
    assert shown == ["holds", "holds", *wanted.split()]


def test_a_number_outlives_the_section_of_its_data():
    text = EXAMPLES.partition("# Two")[0] + "# Two\n$$2p = %s\\,\\mathrm{kg\\,m/s}$$\n"
    found = [check(text % number).findings[-1].verdict for number in ("12", "14")]
    assert found == ["holds", "wrong"]


@pytest.mark.parametrize(
    ("line", "repaired"),
    [
        (r"\sqrt{2\cdot 9.81}\approx 0.43", r"\sqrt{2\cdot 9.81}\approx 4.43"),
        (r"\frac{1}{120} = 0.1", r"\frac{1}{120} = 0.0083"),
        (
            r"30\cdot 1.50\ \mathrm{cm} = 46.8\ \mathrm{cm}",
            r"30\cdot 1.50\ \mathrm{cm} = 45.0\ \mathrm{cm}",
        ),
        (
            r"\frac{1.20}{7}\ \mathrm{m} = 1.2\cdot 10^{-2}\ \mathrm{m}",
            r"\frac{1.20}{7}\ \mathrm{m} = 17.1\cdot 10^{-2}\ \mathrm{m}",
        ),
        (r"2\cdot 3.1 = 6.3 = 6.4", ""),  # what is right for the one leaves the other wrong
        (r"1.5 - 2.5 = 1.0", "1.5 - 2.5 = -1.0"),
    ],
)
def test_a_wrong_number_is_exchanged_for_the_right_one(line, repaired):
    (found,) = check(f"$${line}$$").findings
    assert found.verdict == "wrong"
    assert [c.latex for c in found.explanation.corrections] == [repaired] * bool(repaired)
