"""A system, a solid or loads for each part of a note; solids in words; what a file says wrong."""

import pytest

import eom
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.errors import InputError
from tests.eom.checker.system_lines import judged
from tests.eom.rows import every


def found(note, lexicon="", **settings):
    """The verdicts on the displayed formulas of a note with a lexicon in its front matter."""
    front = f"+++\n[check]\n{lexicon}\n+++\n" if lexicon else ""
    report = eom.check(front + note, **settings)
    return [f.verdict for f in report.findings if f.kind == "display"]


TWO = r"""
preset = "physics-bold"
[[check.scope]]
heading = "The pendulum"
[check.scope.system]
coordinates = { theta = "rad" }
parameters = { m = "kg", l = "m", g = "m/s^2" }
gravity = [0, 0, "-g"]
bodies.bob = { mass = "m", at = ["l*sin(theta)", 0, "-l*cos(theta)"] }
[[check.scope]]
heading = "The top"
[check.scope.system]
is = "heavy-body"
attitude = "3-1-3"
assume = ["I1 = I2"]
symbols.'A' = "I1"
symbols.'C' = "I3"
[[check.scope]]
heading = "The flywheel"
assume = ["rigid"]
system = "disc"
"""
NOTE = r"""
# The pendulum

$$ m l^2\ddot\theta + m g l\sin\theta = 0 $$
$$ E = \tfrac12 m l^2\dot\theta^2 + m g l\cos\theta $$

# The top

$$ A\dot\omega_1 = (A - C)\omega_2\omega_3 + \tau_1 $$
$$ \dot\omega_3 = \omega_1\omega_2 $$

# The flywheel

$$ I_z = \tfrac12 m R^2 $$
$$ I_x = \tfrac12 m R^2 $$
"""


@pytest.mark.slow
def test_a_pendulum_a_top_and_a_solid_in_one_note():
    verdicts = found(NOTE.replace(r" + \tau_1", ""), TWO)
    assert verdicts[:2] == ["holds", "wrong"]
    assert verdicts[3:] == ["wrong", "holds", "wrong"]


SYSTEMS = {
    "a bead on a turning hoop": (
        r"""
coordinates = { theta = "rad" }
given = { phi = "rad" }
assume = ["phi_dot constant"]
parameters = { m = "kg", R = "m", g = "m/s^2" }
gravity = [0, 0, "-g"]
bodies.bead = { mass = "m", at = ["R*sin(theta)*cos(phi)", "R*sin(theta)*sin(phi)", "-R*cos(theta)"] }
symbols.'\Omega' = "phi_dot"
""",
        [r"\ddot\theta = \Omega^2\sin\theta\cos\theta - \frac gR\sin\theta", r"V = -mgR\cos\theta"],
        [r"\ddot\theta = \Omega^2\sin\theta - \frac gR\sin\theta", r"V = mgR\cos\theta"],
    ),
    "a spherical pendulum": (
        r"""
coordinates = { theta = "rad", phi = "rad" }
parameters = { m = "kg", l = "m", g = "m/s^2" }
gravity = [0, 0, "-g"]
bodies.bob = { mass = "m", at = ["l*sin(theta)*cos(phi)", "l*sin(theta)*sin(phi)", "-l*cos(theta)"] }
""",
        [
            r"p_\phi = m l^2\dot\phi\sin^2\theta = \text{const}",
            r"L = \tfrac12 m l^2(\dot\theta^2 + \dot\phi^2\sin^2\theta) + mgl\cos\theta",
        ],
        [r"p_\phi = m l^2\dot\phi\sin\theta", r"\ddot\theta + \frac gl\sin\theta = 0"],
    ),
    "a planet": (
        r"""
coordinates = { r = "m", phi = "rad" }
parameters = { m = "kg", mu = "m^3/s^2" }
potential = "-mu*m/r"
bodies.planet = { mass = "m", at = ["r*cos(phi)", "r*sin(phi)", 0] }
""",
        [r"\ddot r - r\dot\varphi^2 = -\frac{\mu}{r^2}", r"r^2\dot\varphi = \text{const}"],
        [r"\ddot r + r\dot\varphi^2 = -\frac{\mu}{r^2}", r"\dot r = 2 r\dot\varphi"],
    ),
    "masses on a pulley": (
        r"""
coordinates = { x = "m" }
parameters = { m_1 = "kg", m_2 = "kg", g = "m/s^2", J = "kg m^2", R = "m" }
gravity = ["g", 0, 0]
bodies.a = { mass = "m_1", at = ["x", 0, 0] }
bodies.b = { mass = "m_2", at = ["-x", 0, 0] }
bodies.pulley = { moments = "J", omega = "x_dot/R" }
reactions.S = { on = "a", along = [-1, 0, 0] }
""",
        [r"(m_1 + m_2 + J/R^2)\ddot x = (m_1 - m_2) g", r"S = m_1(g - \ddot x)"],
        [r"(m_1 + m_2)\ddot x = (m_1 - m_2) g", r"S = m_1(g + \ddot x)"],
    ),
    "masses and springs": (
        r"""
coordinates = { x_1 = "m", x_2 = "m" }
parameters = { m = "kg", k = "N/m", c = "kg/s" }
bodies.one = { mass = "m", at = ["x_1", 0, 0] }
bodies.two = { mass = "m", at = ["x_2", 0, 0] }
springs.a = { between = [[0, 0, 0], "one"], stiffness = "k" }
springs.b = { between = ["one", "two"], stiffness = "k" }
reactions.N = { on = "one", along = [0, 1, 0] }
forces.x_2 = "-c*x_2_dot"
""",
        [r"m\ddot x_1 = -k x_1 + k(x_2 - x_1)", r"m\ddot x_2 = -k(x_2 - x_1) - c\dot x_2", "N = 0"],
        [r"m\ddot x_1 = -k x_1 - k(x_2 - x_1)", r"m\ddot x_2 = -k(x_2 - x_1) + c\dot x_2"],
    ),
    "a cylinder that rolls down": (
        r"""
coordinates = { s = "m" }
parameters = { m = "kg", R = "m", g = "m/s^2", alpha = "rad" }
gravity = ["g*sin(alpha)", "-g*cos(alpha)", 0]
bodies.roll = { mass = "m", at = ["s", "R", 0], moments = "m*R^2/2", omega = "s_dot/R" }
reactions.N = { on = "roll", along = [0, 1, 0] }
reactions.F = { on = "roll", along = [-1, 0, 0] }
""",
        [r"\ddot s = \frac23 g\sin\alpha", r"F = \frac13 m g\sin\alpha,\quad N = m g\cos\alpha"],
        [r"\ddot s = \frac12 g\sin\alpha", r"F = \frac23 m g\sin\alpha"],
    ),
    "a ball in a pipe that is turned": (
        r"""
coordinates = { u = "m" }
given = { phi = "rad" }
parameters = { m = "kg" }
bodies.ball = { mass = "m", at = ["u*cos(phi)", "u*sin(phi)", 0] }
reactions.Q = { on = "ball", along = ["-sin(phi)", "cos(phi)", 0] }
symbols.'w' = "phi_dot"
""",
        [r"Q = m(2\dot u w + u\dot w)", r"\ddot u = u w^2"],
        [r"Q = 2 m\dot u w", r"\ddot u = -u w^2"],
    ),
    "a pendulum on a cart, as a tree": (
        r"""
parameters = { M = "kg", m = "kg", l = "m", g = "m/s^2" }
gravity = [0, 0, "-g"]
bodies.cart = { mass = "M", slide = "x" }
bodies.bob = { mass = "m", centre = [0, 0, "-l"], on = "cart", hinge = "-y" }
symbols.'x' = "q_cart"
symbols.'\theta' = "q_bob"
""",
        [
            r"(M+m)\ddot x + m l\ddot\theta\cos\theta - m l\dot\theta^2\sin\theta = 0",
            r"l\ddot\theta + \ddot x\cos\theta + g\sin\theta = 0",
        ],
        [r"(M+m)\ddot x + m l\ddot\theta\cos\theta + m l\dot\theta^2\sin\theta = 0"],
    ),
}


@pytest.mark.parametrize("case", every(3, SYSTEMS))
def test_systems_of_a_few_lines(case):
    table, right, wrong = SYSTEMS[case]
    lexicon = parse_lexicon(f'preset = "physics-bold"\n[system]\n{table}')
    verdicts = [v.verdict for v in judged(lexicon, *right, *wrong)]
    assert verdicts == ["holds"] * len(right) + ["wrong"] * len(wrong)


CATALOGUE = {
    r"A solid sphere of radius $R$ and mass $m$ has about any diameter $$I = \frac25 m R^2$$": "holds",
    r"A solid sphere of radius $R$ and mass $m$ has about any diameter $$I = \frac23 m R^2$$": "wrong",
    r"A thin hoop of radius $b$, its axis along $x$: $$J_{xx} = m b^2,\quad J_{yy} = \tfrac12 m b^2$$":
        "holds",
    r"A thin hoop of radius $b$, its axis along $x$: $$J_{zz} = m b^2$$": "wrong",
    r"A bar of mass $M$ and length $L$ lies along the $x$ axis. About its end $E$ "
    r"$$I_{yy}^E = I_{yy}^C + \frac{M L^2}{4} = \frac{M L^2}{3}$$": "holds",
    r"A bar of mass $M$ and length $L$ lies along the $x$ axis. About its end $E$ "
    r"$$I_{yy}^E = I_{yy}^C + M L^2$$": "wrong",
    r"A cube of edge $a$ has about its centre $$I_x = I_y = I_z = \frac16 m a^2$$": "holds",
    r"A disc of diameter $d$ has about a diameter $$I = \frac1{16} m d^2$$": "holds",
    r"A disc of diameter $d$ has about a diameter $$I = \frac18 m d^2$$": "wrong",
    r"A hollow cylinder with inner and outer radii $r_1$ and $r_2$ has about its axis "
    r"$$I = \frac12 m(r_1^2 + r_2^2)$$": "holds",
    r"A hollow cylinder with inner and outer radii $r_1$ and $r_2$ has about its axis "
    r"$$I = \frac12 m(r_2^2 - r_1^2)$$": "wrong",
    r"A box has edges $a$, $b$, $c$ along $x$, $y$, $z$ and the density $\rho$. At a corner "
    r"$$I_{11} = \int_0^a\!\int_0^b\!\int_0^c\rho(y^2+z^2)\,dz\,dy\,dx = \frac m3(b^2+c^2)$$": "holds",
    r"A box has edges $a$, $b$, $c$ along $x$, $y$, $z$. At a corner $$I_{12} = \frac14 m a b$$": "wrong",
    r"A hemisphere of radius $a$ has its base in the plane $z=0$. About its centre of mass "
    r"$$I_{xx}=\frac25 m a^2 - m\left(\frac{3a}8\right)^2$$": "holds",
    r"A rod of mass $m$ and length $2l$ is inclined at $\theta$ to the $z$ axis in the $yz$ plane: "
    r"$$I_{xx} = \frac13 m l^2$$": "holds",
    r"A rod of mass $m$ and length $2l$ lies along $x$. Then $$I_{yy} = \frac1{12} m l^2$$": "wrong",
    r"A rod of mass $m$ and length $s$ is tilted by $\theta$ from the $x$ axis towards the $y$ axis: "
    r"$$I_{xx} = \frac1{12} m s^2\sin^2\theta,\ I_{xy} = -\frac1{12} m s^2\sin\theta\cos\theta$$":
        "holds",
    r"A rod of mass $m$ and length $s$ is tilted by $\theta$ from the $x$ axis towards the $y$ axis: "
    r"$$I_{xx} = \frac1{12} m s^2\cos^2\theta$$": "wrong",
    r"A disc has the mass $m_1$ and the radius $r_1$. $$I_1 = \frac12 m_1 r_1^2$$": "holds",
    r"A pyramid of height $H$ has a square base of side $a$. About its axis $$I_{zz} = \frac1{10} m a^2$$":
        "holds",
    r"A spheroid has the semi-axes $a$ and $c$ along $x$ and $z$: $$I_3 = \frac25 m a^2$$": "holds",
    r"A wheel is a disc of mass $m_w$, radius $r_w$: $$I_s = \frac12 m_w r_w^2,\ I_t = \frac14 m_w r_w^2$$":
        "holds",
    r"A bar $OA$ of length $2a$ and mass $m$ is pinned at $O$. $$I_O = \frac43 m a^2$$": "holds",
    r"A bar $OA$ of length $2a$ and mass $m$ is held at $Q$. $$I_Q = \frac23 m a^2$$": "undecided",
    r"A semicircular disc of radius $R$ has about its centre of mass "
    r"$$I_{zz} = m R^2\left(\frac12 - \frac{16}{9\pi^2}\right)$$": "holds",
    r"A ball of radius $R$ and density $\rho$ has $$I = \int_0^{2\pi}\int_0^\pi\int_0^R \rho r^4\sin^3 u"
    r"\,dr\,du\,dv = \frac{8}{15}\pi\rho R^5$$": "holds",
    r"A rod of mass $m$ and length $l$ carries a disc of mass $M$ and radius $R$. $$I = M R^2$$":
        "undecided",
    # a rule for any body, and a letter that the words do not explain
    r"A disc of radius $a$ is flat. A rule for plates: $$I_{zz} = I_{xx} + q$$": "undecided",
}  # fmt: skip


@pytest.mark.parametrize("note", every(6, CATALOGUE))
def test_solids_that_the_words_name(note):
    assert found(note, notation="physics-bold") == [CATALOGUE[note]]


@pytest.mark.slow
def test_a_table_of_solids_and_other_notations():
    note = r"""
| body | moment |
| --- | --- |
| Disc of radius $r$, about its axis | $I = \frac12 m r^2$ |
| Rod of length $l$, about one end | $I = \frac13 m l^2$ |
| Cylinder, radius $r$, height $h$, about its axis | $I = \frac1{12} m (3 r^2 + h^2)$ |
"""
    for notation in ("arrow-tilde", "schaub-junkins", "hughes", "kane"):
        report = eom.check(note, notation=notation)
        assert [f.verdict for f in report.findings] == ["holds", "holds", "wrong"]


CYLINDER = "A solid cylinder has mass $m$, radius $R$ and height $h$.\n\n"
ROUND, ACROSS = r"\frac12 m R^2", r"\frac1{12} m (3R^2 + h^2)"
READ = {
    (("zz", ROUND), ("xx", ACROSS), ("yy", ROUND)): ["holds", "holds", "wrong"],
    (("xx", ROUND), ("yy", ACROSS), ("zz", ACROSS)): ["holds"] * 3,
    (("xx", ROUND), ("yy", ROUND)): ["holds"] * 2,
    (("xx", ROUND), ("zz", ACROSS), ("xx", ACROSS), ("zz", ROUND)): ["holds"] * 4,
}


@pytest.mark.parametrize("lines", READ)
def test_a_section_is_read_in_one_way(lines):
    """What holds only in a reading that most others refute is wrong; two against two say nothing."""
    note = CYLINDER + "\n\n".join(f"$$I_{{{axes}}} = {value}$$" for axes, value in lines)
    assert found(note, notation="physics-bold") == READ[lines]


def test_the_report_says_how_words_were_read():
    note = f"{CYLINDER}$$I_{{xx}} = {ROUND}$$\n\n$$I_{{yy}} = {ACROSS}$$"
    report = eom.check(note, notation="physics-bold")
    assert (
        str(report).count("read as: of a cylinder, its axis along x, about its centre of mass") == 2
    )


def test_what_a_lexicon_names_goes_before_words():
    note = "# A\n\nA disc of radius $R$ has $$I_z = \\frac25 m R^2$$"
    named = 'preset = "physics-bold"\n[[check.scope]]\nheading = "A"\nsystem = "sphere"'
    assert (found(note, notation="physics-bold"), found(note, named)) == (["wrong"], ["holds"])


LOADS = r"""
preset = "arrow-tilde"
[check.symbols]
'm' = "total_mass body"
'\vec x' = "position C OI"
'\vec g' = "gravity"
'\vec N' = "reaction body"
'\vec M_A' = "reaction_torque body O"
'\vec r_C' = "position C O"
'\vec H_O' = "angular_momentum body O"
'V' = "weight_energy body O"
'\tau_w' = "rotor_torque k"
'I_s' = "rotor_inertia k"
'\hat a' = "rotor_axis k"
'\Omega' = "rotor_speed k"
'\vec\omega' = "angular_velocity B I"
"""


def test_loads_in_vector_lines():
    lines = [
        r"m\ddot{\vec x} = m\vec g + \vec N",
        r"m\ddot{\vec x} = m\vec g - \vec N",
        r"\dot{\vec H}_O = \vec r_C\times m\vec g + \vec M_A",
        r"\dot{\vec H}_O = m\vec g\times\vec r_C + \vec M_A",
        r"V = -m\vec g\cdot\vec r_C",
        r"V = m\vec g\cdot\vec r_C",
        r"\tau_w = I_s(\dot\Omega + \hat a\cdot\dot{\vec\omega})",
        r"\tau_w = I_s\dot\Omega",
    ]
    verdicts = found("\n\n".join(f"$${line}$$" for line in lines), LOADS)
    right = ["holds under", "holds under", "holds", "holds"]
    assert (verdicts[::2], verdicts[1::2]) == (right, ["wrong"] * 4)


def test_the_words_of_a_note_explain_a_load_to_any_lexicon():
    lexicon = LOADS.replace("'\\tau_w' = \"rotor_torque k\"\n", "")
    note = (
        r"Let $\tau_w$ be the torque that the hull exerts on the wheel. "
        r"$$\tau_w = I_s(\dot\Omega + \hat a\cdot\dot{\vec\omega})$$"
    )
    report = eom.check(f"+++\n[check]\n{lexicon}\n+++\n{note}")
    assert report.findings[-1].verdict == "holds"
    assert "rotor_torque k" in report.lexicon


@pytest.mark.slow
def test_what_is_worked_out_behind_an_assumption_is_judged():
    lead = "Let the weight be the only load. Assume\n\n"
    lexicon = LOADS + '\'h\' = { is = "scalar h", unit = "m" }\n\'\\hat b_1\' = "unit B 1"\n'
    lines = {
        r"\vec M_A = h\hat b_1\times(-m\vec g) = h m\,\vec g\times\hat b_1": "holds",
        r"\vec M_A = h\hat b_1\times(-m\vec g) = h m\,\hat b_1\times\vec g": "wrong",
        r"\vec M_A = h m\,\vec g = 0": "assumption",
    }
    for line, verdict in lines.items():
        assert found(f"{lead}$${line}$$", lexicon) == [verdict]


HEAD = 'preset = "kane"\n\n[[scope]]\nheading = "A"\n'
BAD = {
    'system = "dics"': ("line 5", "did you mean disc"),
    '[scope.system]\nis = "disc"\npoint = "apex"': ("scope 1 > system", "centre of mass, rim"),
    '[scope.system]\nis = "disc"\ncoordinates = {x = "m"}': ("given twice", "line 5"),
    '[scope.system]\nisa = "disc"': ("unknown key 'isa'", "line 5"),
    '[scope.system]\ncoordinates = {x = "m"}': ("no bodies", "line 5"),
    '[scope.system]\ncoordinates = {x = "m"}\n[scope.system.bodies]\nb = { att = [0, 0, 0] }':
        ("unknown key 'att'", "line 8"),
    '[scope.system]\ncoordinates = {x = "m"}\n[scope.system.bodies]\nb = { mass = "mm" }':
        ("unknown name 'mm'", "line 8"),
    '[scope.system.bodies]\nb = { mass = 1, slide = "w" }': ("unusable value", "'w'"),
    'assume = ["rigit"]': ("did you mean rigid", "line 5"),
    'sistem = "disc"': ("did you mean system", "scope 1"),
}  # fmt: skip


@pytest.mark.parametrize("text", every(4, BAD))
def test_one_clear_error_at_the_line_of_the_lexicon(text):
    with pytest.raises(InputError) as told:
        parse_lexicon(HEAD + text, "note.lexicon.toml")
    message = str(told.value)
    assert all(part in message for part in BAD[text])
    assert message.count("where:") == 1
