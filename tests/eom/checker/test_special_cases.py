"""What a line that holds in special cases alone is: meant, or wrong in general."""

import json

import pytest

import eom
from eom.checker.read.documents import load
from eom.checker.report.findings import Graded, to_json
from eom.checker.report.page import page

BODY = r"""
preset = "kane"
[frames]
'A' = "I"
'D' = "A"
[points]
'P' = "OA"
'Q' = "OB"
'S' = "O"
'G' = "C"
[symbols]
'm' = "total_mass body"
'\bar r_{<P><Q>}' = "position <P> <Q>"
'\bar x_S' = "position O OI"
'\bar v_S' = '= \dot{\bar x}_S'
'\mathbb J_{<P>}' = "inertia <P>"
'J_{<k>}' = "inertia C in B component <k> <k>"
'Q_{<k>}' = "inertia O in B component <k> <k>"
'L_{<k>}' = "torque body O in B component <k>"
'\mathbb 1' = "identity"
'\bar\omega' = "angular_velocity B I"
'\bar\omega_D' = "angular_velocity A I"
'\bar\rho' = "position dm O"
'p_{<k>}' = "angular_velocity B I in B component <k>"
'\bar h_{<P>}' = "angular_momentum body <P>"
'\bar h' = "absolute_angular_momentum body O"
'\bar q' = "linear_momentum body"
'\bar M_{<P>}' = "torque body <P>"
'N_{<k>}' = "torque body C in B component <k>"
'K' = "kinetic_energy body"
"""
LAWS = "Newton's laws hold, also in the strong form; the body is rigid and carries the body frame $B$.\n\n"
NAMES = r"""The mass centre is $G$:

$$\mathbb J_S = \mathbb J_G
+ m\left[\left(\bar r_{SG}\cdot\bar r_{SG}\right)\mathbb 1 - \bar r_{SG}\bar r_{SG}\right]$$

"""


@pytest.fixture
def found(tmp_path):
    """The findings on displays of a note with a lexicon."""

    def judged(note, lexicon=BODY):
        file, path = tmp_path / "note.toml", tmp_path / "note.md"
        file.write_text(lexicon, encoding="utf-8")
        path.write_text(note, encoding="utf-8")
        report = eom.check(path, lexicon=file)
        return [f for f in report.findings if f.kind == "display"], report

    return judged


TRANSFER = (
    r"$$\mathbb J_Q = \mathbb J_P + m\left[\left(\bar r_{QP}\cdot\bar r_{QP}\right)\mathbb 1"
    r" - \bar r_{QP}\bar r_{QP}\right]$$"
)
EULER = r"$$J_3\dot p_3 = (J_2 - J_1)p_1p_2 + N_3$$"
AXES = "The axes are principal axes at $G$. "


@pytest.mark.sparse(1)
@pytest.mark.parametrize(
    ("text", "case"),
    [
        (NAMES + TRANSFER, "$P = G$"),
        (AXES + EULER, "$J_1 = J_2$"),
        (
            NAMES + r"$$K = \tfrac12 m\,\dot{\bar r}_{SG}\cdot\dot{\bar r}_{SG} "
            r"+ \tfrac12\bar\omega\cdot\mathbb J_S\cdot\bar\omega$$",
            "",
        ),
    ],
)
def test_a_coincidence_excuses_no_slip(found, text, case, tmp_path):
    displays, report = found(LAWS + text)
    last = displays[-1]
    assert (last.verdict, last.special) == ("wrong", case)
    if case:
        assert f"or state: {case}" in str(report)
        assert "wrong in general" in str(report)
        (data,) = json.loads(to_json([Graded("", report)]))["notes"]
        assert data["status"] == "wrong"
        assert case in [f["special"] for f in data["findings"]]
        assert "Or state" in page(load(tmp_path / "note.md"), report)


@pytest.mark.parametrize(
    "text",
    [
        r"Let $J_1 = J_2$. " + EULER,
        "The body is axisymmetric. " + EULER,
        r"$$J_1 = J_2$$",
        r"$$\bar h_S = \mathbb J_S\cdot\bar\omega$$",
    ],
)
def test_what_a_note_states_or_says_is_meant(found, text):
    displays, _ = found(LAWS + AXES + text)
    assert displays[-1].verdict == "holds under"


def test_what_vanishes_by_two_coincidences_is_no_licence_for_a_slip(found):
    named = BODY + "'s_{<k>}' = \"position C O in B component <k>\"\n"
    lines = (f"$$Q_3 = J_3 {sign} m\\left(s_1^2 + s_2^2\\right)$$" for sign in "-+")
    displays, _ = found(LAWS + " ".join(lines), named)
    assert [f.verdict for f in displays] == ["wrong", "holds"]


def test_a_written_term_does_not_vanish(found):
    slip = r"$$\dot{\bar h} = \bar M_S + \bar v_S\times\bar q$$"
    right = r"$$\dot{\bar h} = \bar M_S - \bar v_S\times\bar q$$"
    assert [f.verdict for f in found(LAWS + slip + right)[0]] == ["wrong", "holds under"]


MEANT = {
    r"J_3 = J_1 + J_2": "plane_body",
    r"\bar M_G = \bar\omega\times(\mathbb J_G\cdot\bar\omega)": "steady_turn",
    r"J_1\dot p_1 = N_1": "symmetric_1",
    r"Q_1\dot p_1 + (Q_3 - Q_2)p_2p_3 = L_1": "principal_at_O",
    r"\dot{\bar h}_S = \bar M_S + 0\,\bar v_S": "O_fixed_in_space",
}


@pytest.mark.parametrize("line", MEANT)
def test_special_cases_that_are_meant(found, line):
    ((last,), _) = found(f"{LAWS}$${line}$$")
    assert last.verdict == "holds under"
    assert any(MEANT[line] in s for s in last.sets)


def test_any_motion_is_no_special_one(found):
    line = r"$$\bar M_G = \bar\omega\times(\mathbb J_G\cdot\bar\omega)$$"
    ((last,), _) = found(f"{LAWS}A motor may change the rate, which is arbitrary. Then {line}")
    assert (last.verdict, last.special) == ("wrong", "the angular velocity of B is constant")


TOP = r"""
preset = "physics-bold"
[system]
is = "heavy-body"
attitude = "3-1-3"
assume = ["I1 = I2"]
[system.symbols]
'P' = "m"
'h' = "r3"
'g' = "g"
'A' = "I1"
'C' = "I3"
'p_1' = "omega_1"
'p_2' = "omega_2"
's' = "omega_3"
'\psi' = "psi"
'\theta' = "theta"
'\chi' = "phi"
'L_z' = "H_3"
"""
MOMENTUM = r"$$L_z = A\dot\psi\sin^2\theta + A\,s\cos\theta$$"


def test_parameters_of_a_system_that_coincide(found):
    displays, report = found(MOMENTUM, TOP)
    assert (displays[0].verdict, displays[0].special) == ("wrong", "$A = C$")
    assert "or state: $A = C$" in str(report)
    displays, _ = found(r"For a spherical top $A = C$. " + MOMENTUM, TOP)
    assert displays[0].verdict == "holds under"


@pytest.mark.slow
def test_a_steady_motion_in_a_system_of_angular_velocities(found):
    line = r"P g h = \dot\psi\left(C s - A\dot\psi\cos\theta\right)"
    displays, _ = found(f"$${line}$$", TOP)
    assert (displays[0].verdict, displays[0].sets) == ("holds under", (("theta constant",),))
    slip = line.replace("- A", "+ A")
    assert [f.verdict for f in found(f"$${slip}$$", TOP)[0]] == ["wrong"]
    free = f"The nutation is arbitrary, $\\theta$ may change. Then $${line}$$"
    assert [f.verdict for f in found(free, TOP)[0]] == ["wrong"]


ROTORS = r"""
preset = "hughes"
[points]
'c' = "C"
[symbols]
'\mathbf s' = "rotor_axis k in B"
'j' = "rotor_inertia k"
'\nu' = "rotor_speed k"
'\nu_0' = { is = "scalar nu0", unit = "rad/s" }
'\mathbf J' = "inertia C in B"
'\boldsymbol{\omega}' = "angular_velocity B I in B"
'\mathbf{M}' = "torque body C in B"
"""
WHEEL = (
    r"\mathbf J\dot{\boldsymbol\omega} + \boldsymbol\omega^\times(\mathbf J\boldsymbol\omega"
    r" + j\nu\mathbf s) = \mathbf M"
)


@pytest.mark.slow
def test_one_wheel_at_constant_speed(found):
    displays, _ = found(f"$${WHEEL}$$", ROTORS)
    assert displays[0].verdict == "holds under"
    assert {"one_rotor", "steady_rotors"} <= set(displays[0].sets[0])
    assert found(f"$${WHEEL.replace('+ j', '- j')}$$", ROTORS)[0][0].verdict == "wrong"


@pytest.mark.slow
def test_a_slip_in_a_line_on_one_wheel_is_repaired_for_one(found):
    """Inertia with the wheel in it, and its speed relative to the body: nothing is counted twice."""
    own = "'\\mathbf h' = \"angular_momentum system C in B\"\n"
    twice = (
        r"\mathbf h = \mathbf J\boldsymbol\omega"
        r" + j(\nu + \mathbf s^{\mathsf T}\boldsymbol\omega)\mathbf s"
    )
    ((line,), _) = found(f"$${twice}$$", ROTORS + own)
    assert line.verdict == "wrong"
    first = line.explanation.corrections[0]
    assert r"+ j\nu \mathbf s" in first.latex
    assert first.sets == (("one_rotor",),)


def test_free_scalars_swallow_no_claim(found):
    ((line,), _) = found(r"$$\nu = \nu_0 = \text{const}$$", ROTORS)
    assert line.verdict == "holds under"
    assert "steady_rotors" in line.sets[0]


@pytest.mark.slow
def test_a_line_that_lacks_a_speed_means_no_steady_motion(found):
    lines = [
        r"T = \tfrac12 A\dot\psi^2\sin^2\theta + \tfrac12 C s^2",
        r"p_1 = \dot\psi\sin\theta\sin\chi",
    ]
    displays, _ = found("\n\n".join(f"$${line}$$" for line in lines), TOP)
    assert [f.verdict for f in displays] == ["wrong"] * 2


@pytest.mark.slow
def test_a_factor_that_vanishes_is_the_special_case(found):
    slip = r"$$A\dot p_1 = (A - C)p_2 s + P g h\sin\theta\sin\chi$$"
    ((line,), _) = found(slip, TOP)
    assert (line.verdict, line.special) == (
        "wrong",
        r"$\cos{\left(\chi \right)} = \sin{\left(\chi \right)}$",
    )


BOB = r"""
[system]
coordinates = { theta = "rad", psi = "rad" }
parameters = { m = "kg", l = "m", g = "m/s^2" }
gravity = [0, 0, "-g"]
[system.bodies]
bob = { mass = "m", at = ["l*sin(theta)*cos(psi)", "l*sin(theta)*sin(psi)", "-l*cos(theta)"] }
"""
STATED = {
    r"$$l\ddot\theta = -g\sin\theta$$": r"$\dot{\psi} = 0$",
    r"$$l\ddot\theta + l\dot\psi^2\sin\theta\cos\theta = -g\sin\theta$$": r"$\dot{\psi} = 0$",
    r"$$\ddot\psi\sin\theta = -\dot\psi\dot\theta\cos\theta$$": "",
}


@pytest.mark.sparse(1)
@pytest.mark.parametrize("line", STATED)
def test_the_lowest_condition_on_the_quantities_of_a_line(found, line):
    ((last,), report) = found(line, BOB)
    assert (last.verdict, last.special) == ("wrong", STATED[line])
    assert ("or state: " in str(report)) is bool(STATED[line])


def test_a_condition_of_a_line_between_components(found):
    line = r"$$J_1\dot p_1 = (J_2 + J_3)p_2p_3 + N_1$$"
    ((last,), _) = found(LAWS + AXES + line)
    assert (last.verdict, last.special) == ("wrong", "$p_{2} = 0$")


PLANE = BOB.replace('theta = "rad", psi = "rad"', 'theta = "rad"').replace(
    '["l*sin(theta)*cos(psi)", "l*sin(theta)*sin(psi)", "-l*cos(theta)"]',
    '["l*sin(theta)", 0, "-l*cos(theta)"]',
)
SMALL = {
    r"For small $\theta$ $$\ddot\theta = -\frac{g}{l}\theta$$": "holds under",
    r"The motion is small: $$\ddot\theta + \frac{g}{l}\theta = 0$$": "holds under",
    r"To first order in $\theta$ $$\ddot\theta = -2\frac{g}{l}\theta$$": "wrong",
    r"Linearised, $$\ddot\theta - \frac{g}{l}\theta = 0$$": "wrong",
    r"For small $\theta$ $$\ddot\theta = \frac{g}{l}\sin\theta$$": "wrong",
    r"$$\ddot\theta = -\frac{g}{l}\theta$$": "wrong",
}


@pytest.mark.parametrize("text", SMALL)
def test_small_angles_in_words(found, text):
    ((last,), _) = found(text, PLANE)
    assert last.verdict == SMALL[text]


CASE_AND_DISC = r"""
[system]
coordinates = { psi = "rad", chi = "rad" }
given = { M_1 = "N*m", M_2 = "N*m" }
parameters = { A = "kg*m^2", B = "kg*m^2" }
forces = { psi = "M_1", chi = "M_2" }
[system.bodies]
case = { moments = ["A"], omega = ["psi_dot"] }
disc = { moments = ["B"], omega = ["psi_dot + chi_dot"] }
[system.symbols]
'\psi' = "psi"
'\chi' = "chi"
"""


@pytest.mark.parametrize(
    ("line", "verdict", "sets"),
    [
        (r"$$A\dot\psi + B(\dot\psi+\dot\chi) = \text{const}$$", "holds under", ["M_1 = 0"]),
        (r"$$B(\dot\psi+\dot\chi) = \text{const}$$", "holds under", ["M_2 = 0"]),
        (r"$$\tfrac12A\dot\psi^2 = M_1\psi$$", "wrong", []),
        (r"$$A\ddot\psi + B(\ddot\psi+\ddot\chi) = 2M_1$$", "wrong", []),
    ],
)
def test_loads_that_a_line_leaves_out_may_be_absent(found, line, verdict, sets):
    ((one,), _) = found(line, CASE_AND_DISC)
    assert (one.verdict, [n for s in one.sets[:1] for n in s]) == (verdict, sets)
