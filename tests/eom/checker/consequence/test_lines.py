"""What follows from the lines of a note, whatever their letters mean, and what does but for a slip."""

import pytest

from eom.checker.consequence.letters import letters_of
from eom.checker.consequence.lines import followed
from eom.checker.infer.draft import meanings
from eom.checker.infer.sayings import prose
from eom.checker.judge.judge import UNDECIDED
from eom.checker.judge.notes import understand
from eom.checker.note.following import words_before
from eom.checker.read.documents import Text, document_of


def shown(note):
    """Return, by the number of a display, what is found of it with its slip in LaTeX, and its sources."""
    document = document_of(Text(note), "markdown")
    lexicon = meanings(document, None, "", "").lexicon
    understood = understand(document, lexicon)
    letters = letters_of([u.formula for u in understood], prose(document), lexicon)
    displays = [k for k, u in enumerate(understood) if u.formula.piece.kind == "display"]
    verdicts, words = [UNDECIDED] * len(understood), words_before(document, understood)
    known = followed(letters, understood, verdicts, displays, words)
    return {displays.index(n) + 1: word(f, letters) for n, f in known.items()}


def word(f, letters):
    if f.slip is not None:
        return "wrong" if f.sure else "unsure", letters.latex(f.slip.factor)
    return ("under" if f.under or f.held else "follows"), ""


def note(*parts):
    """Return displays, sentences between them as they are."""
    return "\n\n".join(p[1:] if p.startswith("#") else f"$$\n{p}\n$$" for p in parts)


def found(*parts):
    return {n: what for n, (what, _) in shown(note(*parts)).items()}


def test_what_is_put_in_follows():
    assert found(r"Q = n\dot w", "B = Q^2", r"B = n^2\dot w^2") == {3: "follows"}


def test_an_identity_follows_from_nothing():
    assert found(r"(A+B)^2 = A^2 + 2AB + B^2") == {1: "follows"}


def test_equations_are_solved_for_what_is_eliminated():
    rolling = [
        "#The radius is $r$, the mass $m$, the moment of inertia $I$.",
        r"v = r w",
        r"\begin{aligned} m\dot v &= G\sin\alpha - F \\ I\dot w &= F r \end{aligned}",
    ]
    assert found(*rolling, r"\dot v = \frac{G\sin\alpha}{m + I/r^2}") == {3: "under"}
    assert found(*rolling, r"\dot v = \frac{G\cos\alpha}{m + I/r^2}") == {3: "unsure"}
    assert found(*rolling, r"\dot v = \frac{G\sin\alpha}{2m + I/r^2}") == {3: "unsure"}


def test_a_slip_is_certain_where_other_lines_confirm_what_it_rests_on():
    lines = [r"Q = n\dot w + b", "B = Q^2", r"B = (n\dot w + b)^2", r"\sqrt{B} = n\dot w + b"]
    assert found(*lines, r"Q^2 - B = 0", r"B = Q(n\dot w - b)")[6] == "wrong"
    assert shown(note(*lines, "Q^2 = B", r"Q = n\dot w - b"))[6] == ("wrong", "-1")
    assert found(r"Q = n\dot w + b", r"Q = n\dot w - b") == {2: "unsure"}


def test_what_rests_on_an_open_line_says_so():
    """The second line brings no letter in: it may be a slip, or a special case."""
    assert found("Q = a + b, \\quad P = a - b", "Q = 3P", "a = 2b") == {3: "under"}


def test_a_case_in_which_all_vanishes_proves_nothing():
    lines = ["A = B\\omega - C\\eta", r"#With $\omega = 0$ and $\eta = 0$:"]
    assert found(*lines, "5C\\eta = 7B\\omega") == {}


def test_conditions_in_sentences_hold_around_them():
    lines = [r"Q = \frac{J_1}{J_3}w + \frac{J_2}{J_3}u", "#If $J_1 = J_2 = J$ this is"]
    assert found(*lines, r"Q = \frac{J}{J_3}(w + u)")[2] in {"follows", "under"}


def test_letters_without_words_may_change_with_time():
    assert found(r"E = J w^2", r"\frac{dE}{dt} = 0") == {}
    assert found(r"E = J w^2", r"\dot E = 2Jw\dot w") == {2: "follows"}
    words = "#The moment of inertia is $q$."
    assert found(r"E = q w^2", r"\dot E = 2qw\dot w") == {2: "under"}
    assert found(r"E = q w^2", r"\dot q = 3, \dot E = 2qw\dot w") == {}
    assert found(words, r"E = q w^2", r"\dot E = 2qw\dot w") == {2: "follows"}


LAGRANGIAN = [
    "#Its mass is $m$, its radius $R$, the gravity $g$.",
    r"T = \frac12 m R^2(\dot\theta^2 + \dot\phi^2\sin^2\theta)",
    r"L = T + m g R\cos\theta",
]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        (r"p = \frac{\partial L}{\partial\dot\phi} = mR^2\dot\phi\sin^2\theta", "follows"),
        (r"p = \frac{\partial L}{\partial\dot\phi} = mR^2\dot\phi\sin\theta", "unsure"),
        (r"\ddot\theta = \dot\phi^2\sin\theta\cos\theta - \frac gR\sin\theta", "under"),
        (r"\ddot\theta = \dot\phi^2\sin\theta\cos\theta + \frac gR\sin\theta", "unsure"),
        (r"\frac{d}{dt}(\dot\phi\sin^2\theta) = 0", "under"),
        (r"\frac{d}{dt}(\dot\phi\sin\theta) = 0", "unsure"),
    ],
)
def test_lines_follow_from_a_lagrangian(line, expected):
    assert found(*LAGRANGIAN, line).get(3) == expected


def test_two_real_equations_become_a_complex_one():
    real = r"\ddot x = 2\Omega\dot y - kx, \quad \ddot y = -2\Omega\dot x - ky"
    complex_ = r"\ddot\zeta + 2i\Omega\dot\zeta + k\zeta = 0"
    assert found(real, "#With $\\zeta = x + iy$", complex_) == {2: "under"}
    wrong = complex_.replace("+ 2i", "- 2i")
    assert found(real, "#With $\\zeta = x + iy$", wrong).get(2) in {"unsure", None}


def test_the_root_of_a_square_may_have_either_sign():
    square = r"\lambda^2 = \frac{((J - K)\Omega + h)^2}{K^2}"
    assert found(square, r"\lambda = \frac{J - K}{K}\Omega + \frac hK") == {2: "under"}
    assert found(square, r"\lambda = \frac{K - J}{K}\Omega - \frac hK") == {2: "under"}


def test_a_line_that_is_read_in_part_is_not_said_to_follow():
    assert found("Q = a + b", "R = \\vec Q", "a = Q - b, \\quad \\vec F = a\\vec b") == {}


def test_special_cases_are_no_slips():
    """The general line holds with other letters: what is special is not wrong."""
    general = [r"Q = \frac{G}{m + J}", "#A hoop has"]
    assert found(*general, "Q = \\frac{G}{2m}") in ({}, {2: "unsure"})


DRIVEN = [r"m\ddot x = -kx", r"\ddot y = -a y", r"#With the constant $x_0$:"]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        (r"x(t) = x_0\cos\left(\sqrt{k/m}\,t\right)", "under"),
        (r"x(t) = x_0\cos\left(\sqrt{m/k}\,t\right)", None),
        (r"\frac12 m\dot x^2 + \frac12 kx^2 = \mathrm{const}", "under"),
        (r"\frac12 m\dot x^2 + kx^2 = \mathrm{const}", "unsure"),
        (r"\frac12 m\dot x^2 - \frac12 kx^2 = \frac12 kx_0^2", "unsure"),
    ],
)
def test_integrals_follow_but_for_a_constant(line, expected):
    assert found(*DRIVEN, line).get(3) == expected


def test_a_law_whose_terms_all_vanish_proves_nothing():
    """Letters without dots do not change by themselves: that their sum is constant is no finding."""
    assert found("E = b w^2 + u", r"\frac{dE}{dt} = 0") == {}


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        (r"\omega_0^2 = \frac{k}{m}", "under"),
        (r"\omega_0 = \sqrt{\frac{k}{m}}", "under"),
        (r"\omega_0 = \sqrt{\frac{2k}{m}}", "unsure"),
        (r"T_0 = 2\pi\sqrt{\frac{m}{k}}", "under"),
        (r"T_0 = \pi\sqrt{\frac{m}{k}}", "unsure"),
    ],
)
def test_frequencies_are_those_of_what_moves(line, expected):
    words = "#The frequency, and the period, follow:"
    known = found(r"m\ddot x = -kx", words, line)
    assert known.get(2) == expected


def test_frequencies_of_coupled_letters():
    coupled = [
        r"a\ddot x + cx + s(x - y) = 0, \quad a\ddot y + cy + s(y - x) = 0",
        "#Both swing together or against one another.",
    ]
    assert found(*coupled, r"\lambda^2 = \frac{c + 2s}{a}") == {2: "under"}
    assert found(*coupled, r"\lambda^2 = \frac{c + s}{a}") == {}


def test_a_number_that_is_no_frequency_is_one_only_where_words_say_so():
    assert found(r"m\ddot x = -kx", r"u = \sqrt{\frac{2k}{m}}") == {}


ARM = [
    "#Here $c_1 = \\cos q_1$, $s_{12} = \\sin(q_1 + q_2)$ and so on.",
    "#The lengths are $l$, $h$.",
]
PLACE = r"x_2 = lc_1 + hc_{12}, \quad y_2 = ls_1 + hs_{12}"


def test_shorthands_are_used_by_their_pattern():
    rates = r"\dot x_2 = -ls_1\dot q_1 - hs_{12}(\dot q_1 + \dot q_2)"
    assert found(*ARM, PLACE, rates) == {2: "under"}
    assert found(*ARM, PLACE, rates.replace("-ls_1", "-lc_1")) == {2: "unsure"}


def test_a_speed_is_that_of_the_coordinates_with_its_label():
    square = r"v_2^2 = l^2\dot q_1^2 + h^2(\dot q_1+\dot q_2)^2 + 2lhc_2\dot q_1(\dot q_1+\dot q_2)"
    assert found(*ARM, PLACE, square) == {2: "under"}
    false = square.replace("c_2", "c_{12}") + ", \\quad b = c_2"
    assert found(*ARM, PLACE, false).get(2) not in {"follows", "under"}


def test_primes_make_other_letters():
    assert found("mv_1' = mv_1 - J", "J = m(v_1 - v_1')") == {2: "under"}
    assert found("mv_1' = mv_1 - J", "J = m(v_1 + v_1')") == {2: "unsure"}


def test_a_value_at_an_instant_is_no_function():
    assert found(r"\dot v = -b", "v(t_1) = c - b t_1") == {}


def test_a_later_condition_on_the_same_letters_takes_the_place_of_the_earlier_one():
    lines = [
        "Q = a\\ddot x + b\\ddot y",
        "#For $x = y$",
        "Q = (a + b)\\ddot y",
        "#and for $x = -y$",
    ]
    assert found(*lines, "Q = (b - a)\\ddot y").get(3) in {"follows", "under"}
    assert found(*lines, "Q = (b + a)\\ddot y").get(3) in {"unsure", "wrong", None}


def test_what_moves_in_one_part_says_nothing_of_another():
    first = "# One\n\n$$\n\\dot v = -b\n$$\n\n# Two\n\n$$\n\\dot v = c\\sin w\n$$\n\n$$\nv\\dot v = -bv\n$$"
    assert 3 not in shown(first)


def test_lagrange_equations_follow_from_two_energies():
    energies = [
        "#The mass is $m$, the length $l$.",
        r"T = \frac12 ml^2(\dot\theta^2 + \Omega^2\sin^2\theta)",
        r"V = -mgl\cos\theta",
    ]
    motion = r"\ddot\theta - \Omega^2\sin\theta\cos\theta + \frac gl\sin\theta = 0"
    assert found(*energies, motion) == {3: "under"}
    assert found(*energies, motion.replace("- ", "+ ")) == {3: "unsure"}


def test_what_holds_at_the_start_is_no_rule():
    lines = [r"m\ddot x = -kx", "#It starts with $x = b$.", r"Q = \ddot x + \frac km x"]
    assert found(*lines, r"\ddot x = 0") == {}


HOOP = r"\ddot\theta = (\Omega^2\cos\theta - \frac gR)\sin\theta"


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        (r"\nu^2 = \frac gR - \Omega^2", "under"),
        (r"\nu^2 = \frac gR + \Omega^2", "unsure"),
        (r"\nu = \Omega\sin\theta_0", "under"),
        (r"\nu = \Omega\cos\theta_0", "unsure"),
    ],
)
def test_frequencies_of_small_motions_about_a_state_of_rest(line, expected):
    words = [
        "#It rests where",
        r"\cos\theta_0 = \frac{g}{R\Omega^2}",
        "#and swings at the frequency",
    ]
    assert found(HOOP, *words, line).get(3) == expected


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        (r"\ddot\theta \approx -\frac gR\theta + \Omega^2\theta", "under"),
        (r"\ddot\theta \approx -\frac gR\theta - \Omega^2\theta", None),
        (r"\ddot\theta = (\Omega^2 - \frac gR)\theta", "under"),
        (r"\ddot\theta = (\Omega^2 - \frac gR)\theta^2", None),
        (r"\cos\theta \approx 1 + \theta", None),
    ],
)
def test_lines_for_small_motions(line, expected):
    assert found(HOOP, "#For small angles", line).get(2) == expected


def test_a_power_of_the_time_is_read_as_it_stands():
    assert found(
        r"\dot v = b", r"v = bt + v_0", r"\dot x = v", r"x = \frac12bt^2 + v_0t + x_0"
    ) == {
        2: "under",
        4: "under",
    }
    assert found(r"\dot v = bt", r"v = \frac12bt^2 + v_0") == {2: "under"}
    assert found(r"\dot v = bt", r"v = bt + v_0").get(2) in {None, "unsure"}


def test_a_letter_given_anew_in_another_part_is_no_slip():
    parts = "# One\n\n$$\nJ = 2sa\n$$\n\n# Two\n\n$$\nJ = 3sa\n$$"
    assert shown(parts) == {}
