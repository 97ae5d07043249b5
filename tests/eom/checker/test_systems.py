"""Scalar lines of particular systems: true ones hold, slips are wrong and named by their terms."""

import random

import pytest
import sympy as sp

from eom.checker.mean.lexicon_files import about, lexicon_for, parse_lexicon
from eom.checker.mean.model import BUILTIN, load_model
from eom.errors import InputError
from eom.scenes import catalogue
from eom.system import System
from tests.eom.checker.system_lines import is_same, judged, left_side, names_of, slips
from tests.eom.rows import only
from tests.eom.test_solutions import cart

UNDER = "holds under"
NAMED = {
    "sign": "wrong sign",
    "factor": "should be 1/2 times",
    "half": "should be 2 times",
    "dropped": "missing on the right side",
}
SYSTEMS = [*catalogue.single(), *BUILTIN]
SHORT = ("t-handle", "lecture-wheel", "spinner", "gyrostat")
"""Quaternions, angles, a forced and a coupled body."""


def lexicon(name):
    return parse_lexicon(f'[system]\nis = "{name}"')


def latex(expression, names):
    return sp.latex(expression, symbol_names=names)


def rates(model):
    """States with their rates, where these are explicit."""
    s = model.system
    return [] if s.mass_matrix is not None else list(zip(s.states, s.rates, strict=True))


@pytest.mark.parametrize("name", only(SYSTEMS, *SHORT))
def test_all_equations_of_a_system_hold(name):
    model = load_model(name)
    names = names_of(model)
    lines = [f"{left_side(q, names)} = {latex(r, names)}" for q, r in rates(model)]
    lines += [
        rf"{latex(d.expression, names)} = \text{{const}}"
        for d in model.system.invariants
        if d.expression.is_polynomial(*d.expression.free_symbols)
    ]
    found = judged(lexicon(name), *lines)
    assert [v.verdict for v in found] == ["holds"] * len(lines), lines


def test_a_tree_of_bodies_is_a_system_too():
    model = load_model("double-pendulum")
    names = names_of(model)
    (energy,) = (d.expression for d in model.system.invariants)
    half = energy.xreplace({model.symbol("g"): 2 * model.symbol("g")})
    lines = [rf"{latex(e, names)} = \text{{const}}" for e in (energy, half)]
    lines += [
        r"\dot{q_{\mathrm{elbow}}} = u_{\mathrm{elbow}}",
        r"\dot{q_{\mathrm{elbow}}} = 2 u_{\mathrm{elbow}}",
    ]
    found = [v.verdict for v in judged(lexicon("double-pendulum"), *lines)]
    assert found[0] == found[2] == "holds"
    assert "holds" not in {found[1], found[3]}
    with pytest.raises(InputError, match="belong to its joints"):
        load_model("double-pendulum", attitude="3-2-1")


def mutants(name, count):
    """Lines with a slip: the kind, the term, the line, whether it is true all the same."""
    model = load_model(name)
    names = names_of(model)
    generator = random.Random(name)
    for q, r in rates(model):
        if r == 0:
            continue
        for kind, term, changed in slips(r, generator, count):
            line = f"{left_side(q, names)} = {latex(changed, names)}"
            yield kind, term, line, is_same(model, r, changed)


@pytest.mark.parametrize("name", only(SYSTEMS, *SHORT))
def test_slips_are_wrong_and_what_is_true_is_not(name):
    made = list(mutants(name, 4))
    found = judged(lexicon(name), *(line for _, _, line, _ in made))
    missed, unnamed = [], []
    for (kind, _, line, true), v in zip(made, found, strict=True):
        if v.verdict == "wrong" and NAMED.get(kind, "") not in v.reason:
            unnamed.append((kind, line, v.reason))
        right = {"holds"} if true else {"wrong"} if name in catalogue.names() else {"wrong", UNDER}
        if v.verdict not in right:
            missed.append((kind, line, v.verdict, v.claims[0].judgement.sets))
    assert not missed
    assert len(unnamed) <= max(1, len(made) / 25), unnamed
    assert sum(v.verdict == "wrong" for v in found) > len(made) / 2 or not made


TOP = r"""
preset = "arrow-tilde"
[system]
is = "heavy-top"
[system.symbols]
'A' = "I1"
'C' = "I3"
'\ell' = "r3"
"""


def verdicts(text, *lines):
    return [v.verdict for v in judged(parse_lexicon(text), *lines)]


def test_a_writers_own_letters_and_forms():
    lines = [
        r"A\dot\omega_1 = (A-C)\omega_2\omega_3 + M_1",
        r"A \dot\omega_2 - (C - A)\,\omega_3\omega_1 + m g \ell\, (2q_1q_3 - 2q_0q_2) = 0",
        r"\omega_3 = \text{const}",
        r"\ddot\omega_1 = \frac{A-C}{A}\omega_3\dot\omega_2 + \frac{\dot M_1}{A}",
        r"E = \frac12 A(\omega_1^2+\omega_2^2) + \frac12 C\omega_3^2 + mg\ell(1 - 2(q_1^2 + q_2^2))",
        r"q_0^2 + q_1^2 + q_2^2 + q_3^2 = 1",
        r"\dot E = \frac{d}{dt}(A\omega_1 (2q_1q_3-2q_0q_2))",
        r"A\dot\omega_1 = (A-C)\omega_2\omega_3 - M_1",
        r"A\dot\omega_1 = (A-C)\omega_2\omega_3 + \mu",
        r"\vec v\cdot\vec v = v^2",
    ]
    expected = ["holds"] * 6 + ["wrong", "wrong", "undecided", "undecided"]
    assert verdicts(TOP, *lines) == expected


def test_terms_are_named_in_the_writers_letters():
    (found,) = judged(parse_lexicon(TOP), r"A\dot\omega_1 = (A+C)\omega_2\omega_3 + M_1")
    assert found.reason == "wrong sign: C*omega_2*omega_3"
    line = r"\frac12 A(\omega_1^2+\omega_2^2) - mg\ell(1 - 2(q_1^2 + q_2^2)) = \text{const}"
    (found,) = judged(parse_lexicon(TOP), line)
    assert found.verdict == "wrong"
    assert found.reason.startswith("wrong sign: ")


def test_special_motions_and_bodies_are_assumptions():
    wheel = 'system = "lecture-wheel"'
    steady = r"I_2 C\dot\psi - I_1\dot\psi^2\sin\theta = \frac{M_1}{\cos\theta}"
    (found,) = judged(parse_lexicon(wheel), steady)
    assert found.claims[0].judgement.sets == (("theta constant",),)
    free = 'system = "free-rigid-body"'
    lines = [r"\dot\omega_3 = 0", r"I_1\dot\omega_1 = (I_1 - I_3)\omega_2\omega_3"]
    found = judged(parse_lexicon(free), *lines)
    assert [v.claims[0].judgement.sets for v in found] == [(("I1 = I2",),)] * 2
    assert verdicts('system = "t-handle"', *lines) == ["wrong", "wrong"]
    assert verdicts('[system]\nis = "free-rigid-body"\nassume = ["I1 = I2"]', *lines) == [
        "holds",
        "holds",
    ]


def test_a_set_that_empties_the_line_is_no_licence():
    free = 'system = "free-rigid-body"'
    assert verdicts(free, r"I_3\dot\omega_3 = 2(I_1 - I_2)\omega_1\omega_2") == ["wrong"]
    line = r"\frac{d}{dt}(I_1\dot\psi\cos^2\theta - I_2 C\sin\theta) = 0"
    assert verdicts('system = "lecture-wheel"', line) == ["wrong"]


@pytest.mark.parametrize("sequence", only(["3-1-3", "3-2-1", "1-2-3"], "3-1-3"))
def test_other_attitude_coordinates(sequence):
    text = f'system = {{is = "heavy-top", attitude = "{sequence}"}}'
    model = load_model("heavy-top", attitude=sequence)
    names = names_of(model)
    lines = [f"{left_side(q, names)} = {latex(r, names)}" for q, r in rates(model)]
    assert verdicts(text, *lines) == ["holds"] * len(lines)
    if sequence == "3-1-3":
        euler = (
            r"I_1\ddot\theta = I_1\dot\psi^2\sin\theta\cos\theta {} I_3\omega_3\dot\psi\sin\theta"
        )
        weight = r" + m g r_3\sin\theta"
        assert verdicts(text, euler.format("-") + weight, euler.format("+") + weight) == [
            "holds",
            "wrong",
        ]


def test_vectors_of_the_note_keep_their_meaning():
    lexicon = 'preset = "kane"\nsystem = "t-handle"'
    lines = [
        r"\mathbf{b}_1\times\mathbf{b}_2 = \mathbf{b}_3",
        r"{}^N\boldsymbol\omega^B = \omega_1\mathbf{b}_1 + \omega_2\mathbf{b}_2 + \omega_3\mathbf{b}_3",
        r"I_1\dot\omega_1 = (I_2 - I_3)\omega_2\omega_3",
        r"I_1\dot\omega_1 = (I_3 - I_2)\omega_2\omega_3",
    ]
    assert verdicts(lexicon, *lines) == ["holds", "holds", "holds", "wrong"]


def test_a_system_of_ones_own():
    x, v, k, m = sp.symbols("x v k m")
    spring = System.from_rates("spring", {x: v, v: -k * x / m})
    own = about(parse_lexicon(""), spring, {r"\xi": "x"})
    lines = [
        r"m\ddot\xi + k\xi = 0",
        r"m\ddot\xi - k\xi = 0",
        r"\frac12 m v^2 + \frac12 k x^2 = \text{const}",
        r"\dot\xi = v",
    ]
    assert [f.verdict for f in judged(own, *lines)] == ["holds", "wrong", "holds", "holds"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('system = "heavy-tip"', "heavy-top"),
        ("system = 3", "not a system"),
        ('[system]\nis = "heavy-top"\nassume = ["I1 = I3"]', "assumption"),
        ('[system]\nis = "heavy-top"\n[system.symbols]\n\'A\' = "I4"', "I1"),
        ('system = "../scene.toml"', "outside"),
        ('[system]\nscene = "heavy-top"', "scene"),
    ],
)
def test_a_bad_system_is_one_clear_error(text, message):
    with pytest.raises(InputError, match=message):
        parse_lexicon(text)


def test_a_scene_file_beside_the_note(tmp_path):
    (tmp_path / "own.toml").write_text(catalogue.path_of("t-handle").read_text())
    note = tmp_path / "note.md"
    text = '+++\n[check]\nsystem = "own.toml"\n+++\n$$I_1\\dot\\omega_1=(I_2-I_3)\\omega_2\\omega_3$$\n'
    lexicon = lexicon_for(text, note)
    assert lexicon.system.name == "own"


@pytest.mark.parametrize("name", ["heavy-top", "lecture-wheel", "viscous-slug"])
def test_rearranged_equations_hold(name):
    """Terms on other sides, all multiplied by something, definitions written out."""
    model = load_model(name)
    names = names_of(model)
    generator = random.Random(name)
    lines = []
    for q, r in rates(model):
        factor = generator.choice(model.system.parameters).symbol
        terms = sp.Add.make_args(sp.expand(model.system.expand(r) * factor))
        moved = [t for t in terms if generator.random() < 0.5]
        rest = [t for t in terms if t not in moved]
        left = f"{latex(factor, names)} {left_side(q, names)} + {latex(-sp.Add(*moved), names)}"
        lines.append(f"{left} = {latex(sp.Add(*rest), names)}".replace("+ -", "-"))
    assert [v.verdict for v in judged(lexicon(name), *lines)] == ["holds"] * len(lines), lines


def test_a_system_with_a_mass_matrix():
    system, *_ = cart()
    cart_lexicon = about(parse_lexicon(""), system)
    lines = [
        r"(M+m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = 0",
        r"l\ddot\theta + \ddot x\cos\theta + g\sin\theta = 0",
        r"l\ddot\theta - \ddot x\cos\theta + g\sin\theta = 0",
        r"\frac{d}{dt}\left((M+m)\dot x + m l\dot\theta\cos\theta\right) = 0",
        r"(M+m)\dot x = \text{const}",
    ]
    expected = ["holds", "holds", "wrong", "holds", "wrong"]
    assert [v.verdict for v in judged(cart_lexicon, *lines)] == expected


@pytest.mark.parametrize(
    "line",
    [
        r"\dot\omega_1 = (\omega_1+\omega_2+\omega_3+q_0+q_1+q_2+q_3)^{60}",
        r"\dot\omega_1 = ((\omega_1+q_1)^{50}+1)^{50}",
        r"\frac{d^4}{dt^4}E = \omega_1",
        r"\dot\omega_1 = " + "".join(rf"(\omega_1+{k})" for k in range(40)),
        r"\dot\omega_1 = \frac{1}{\sin^2 q_0+\cos^2 q_0-1}",
    ],
)
def test_large_lines_end_soon(line):
    (found,) = judged(lexicon("heavy-top"), line)
    assert found.verdict in {"wrong", "undecided"}
