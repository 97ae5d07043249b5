r"""What is derived of a system: motions, frequencies, events, blows, running indices, brackets, limits."""

import pytest

from eom.checker.judge.judge import models_of
from eom.checker.judge.notes import understand
from eom.checker.judge.verdicts import verdict
from eom.checker.mean.lexicon_files import lexicon_for, parse_lexicon
from eom.checker.note.checking import check
from eom.checker.read.documents import read_document
from eom.checker.repair.explaining import explain
from eom.errors import InputError
from tests.eom.checker.system_lines import judged

HOOP = r"""
[system]
coordinates = { theta = "rad" }
given = { phi = "rad" }
assume = ["phi_dot constant"]
parameters = { m = "kg", a = "m", g = "m/s^2" }
gravity = [0, 0, "-g"]
[system.motions]
rest = { constant = ["theta"], nonzero = ["sin(theta)"] }
any = { constant = ["theta"] }
bottom = { zero = ["theta"], constant = ["theta"] }
top = { zero = ["theta - pi"], constant = ["theta"] }
[system.symbols]
'\Omega' = "phi_dot"
'\theta_*' = "theta at rest"
'\theta_a' = "theta at any"
'\omega' = "frequency at rest"
'\omega_b' = "frequency at bottom"
'\tau' = "period at bottom"
'\lambda' = "eigenvalue at top"
[system.bodies]
bead = { mass = "m", at = ["a*sin(theta)*cos(phi)", "a*sin(theta)*sin(phi)", "-a*cos(theta)"] }
"""
OF_HOOP = {
    r"\cos\theta_*=\frac{g}{a\Omega^2}": "holds",
    r"\cos\theta_*=\frac{2g}{a\Omega^2}": "wrong",
    r"\cos\theta_a=\frac{g}{a\Omega^2}": "undecided",  # or the lowest point
    r"\omega = \Omega\sin\theta_*": "holds",
    r"\omega = \Omega\cos\theta_*": "wrong",
    r"\omega_b = \sqrt{\frac{g}{a} - \Omega^2}": "holds",
    r"\omega_b = \sqrt{\frac{g}{a} + \Omega^2}": "wrong",
    r"\tau = \frac{2\pi}{\omega_b}": "holds",
    r"\lambda^2 = \frac{g}{a} + \Omega^2": "holds",
    r"\lambda^2 = \frac{g}{a} - \Omega^2": "wrong",
    r"\lim_{g\to0}\cos\theta_* = 0": "holds",
    r"\lim_{g\to0}\omega = \frac12\Omega": "wrong",
}

PENDULUM = r"""
[symbols]
'\mathbf i' = "unit I 1"
'\mathbf j' = "unit I 2"
[system]
coordinates = { alpha = "rad", beta = "rad" }
parameters = { m = "kg", l = "m", g = "m/s^2" }
gravity = [0, "-g", 0]
functions = { f = "q p t", h = "q p" }
[system.values]
e = { is = ["sin(beta)", "-cos(beta)", 0] }
[system.motions]
hang = { constant = ["alpha", "beta"], zero = ["alpha", "beta"] }
[system.symbols]
'\alpha' = "alpha"
'\beta' = "beta"
'H' = "H"
'f' = "f"
'h' = "h"
'\omega_1' = "frequency 1 at hang"
'\omega_2' = "frequency 2 at hang"
'\omega' = "frequency at hang"
'\lambda' = "eigenvalue at hang"
'\mathbf r_1' = "position of one"
'\mathbf r_2' = "position of two"
'\mathbf v_2' = "velocity of two"
'\mathbf e' = "vector e"
[system.bodies]
one = { mass = "m", at = ["l*sin(alpha)", "-l*cos(alpha)", 0] }
two = { mass = "m", at = ["l*sin(alpha)+l*sin(beta)", "-l*cos(alpha)-l*cos(beta)", 0] }
"""
OF_PENDULUM = {
    r"\omega_1^2 = (2-\sqrt2)\frac gl": "holds",
    r"\omega_2^2 = (2-\sqrt2)\frac gl": "wrong",
    r"\omega^2=(2+\sqrt2)\frac gl": "undecided",  # which one?
    r"\lambda^4 + 4\frac gl\lambda^2 + 2\frac{g^2}{l^2} = 0": "holds",
    r"\lambda^4 + 3\frac gl\lambda^2 + 2\frac{g^2}{l^2} = 0": "wrong",
    r"\mathbf r_2 = \mathbf r_1 + l\,\mathbf e": "holds",
    r"\mathbf v_2 = l(\dot\alpha\cos\alpha+\dot\beta\cos\beta)\mathbf i"
    r" + l(\dot\alpha\sin\alpha+\dot\beta\sin\beta)\mathbf j": "holds",
    r"\mathbf v_2 = l(\dot\alpha\cos\alpha+\dot\beta\cos\beta)\mathbf i"
    r" - l(\dot\alpha\sin\alpha+\dot\beta\sin\beta)\mathbf j": "wrong",
    r"|\mathbf v_2|^2 = l^2(\dot\alpha^2+\dot\beta^2+2\dot\alpha\dot\beta\cos(\alpha-\beta))": "holds",
    r"(\mathbf r_2\times\mathbf v_2)\cdot(\mathbf i\times\mathbf j)"
    r"=l^2(\dot\alpha+\dot\beta)(1+\cos(\alpha-\beta))": "holds",
    r"\frac{d}{dt}\frac{\partial L}{\partial\dot q_i}-\frac{\partial L}{\partial q_i}=Q_i": "holds",
    r"p_i\equiv\frac{\partial L}{\partial\dot q_i}": "definition",
    r"\sum_i p_i\dot q_i = 2T": "holds",
    r"\sum_i p_i\dot q_i = T": "wrong",
    r"\dot q_i=\frac{\partial H}{\partial p_i},\qquad\dot p_i=-\frac{\partial H}{\partial q_i}": "holds",
    r"\dot q_i=\frac{\partial H}{\partial p_i},\qquad\dot p_i=\frac{\partial H}{\partial q_i}": "wrong",
    r"H=\sum_i p_i\dot q_i-L": "holds",
    r"\{q_i,p_j\}=\delta_{ij}": "definition",  # of the sign
    r"\dot f=\{f,H\}+\frac{\partial f}{\partial t}": "holds",
    r"\dot f=\{f,H\}": "wrong",
    r"\dot h=\{h,H\}": "holds",
    r"\dot h=\{H,h\}": "wrong",
}

SLIDE = r"""
[symbols]
't' = "time"
[system]
coordinates = { x = "m", phi = "rad" }
parameters = { m = "kg", a = "m", g = "m/s^2", mu = "1", v_0 = "m/s" }
gravity = [0, 0, "-g"]
forces = { x = "-mu*m*g", phi = "mu*m*g*a" }
[system.motions]
slide = { start = { x_dot = "v_0", phi_dot = 0 }, until = "x_dot - a*phi_dot" }
[system.symbols]
'v' = "x_dot"
'\omega' = "phi_dot"
'\mu' = "mu"
't_1' = "t at end of slide"
'v_1' = "x_dot at end of slide"
[system.bodies]
disc = { mass = "m", at = ["x", 0, "a"], moments = ["1/2*m*a^2"], omega = ["phi_dot"] }
"""
OF_SLIDE = {
    r"t_1=\frac{v_0}{3\mu g},\qquad v(t_1)=v_0-\mu g t_1=\tfrac23v_0": "holds",
    r"t_1=\frac{v_0}{3\mu g},\qquad v(t_1)=v_0-\mu g t_1=\tfrac13v_0": "wrong",
    r"v_1=\tfrac23v_0": "holds",
    r"v=v_0-\mu g t": "holds",
    r"v=v_0+\mu g t": "wrong",
    r"a\omega=2\mu g t": "holds",
    r"a\omega=\mu g t": "wrong",
    r"\dot v=-\mu g": "holds",
    r"\sqrt{v_1^2}=-v_1": "undecided",  # the sign of a root
}

IMPACT = r"""
[system]
coordinates = { x = "m", y = "m" }
parameters = { m = "kg", M = "kg", e = "1" }
[system.motions]
hit = { closing = ["y - x"], restitution = "e" }
[system.bodies]
one = { mass = "m", at = ["x", 0, 0] }
two = { mass = "M", at = ["y", 0, 0] }
[system.symbols]
'u' = "x_dot before hit"
'w' = "y_dot before hit"
"u'" = "x_dot after hit"
"w'" = "y_dot after hit"
"T'" = "T after hit"
'J' = "impulse of hit"
"""
OF_IMPACT = {
    r"u'=\frac{mu+Mw-eM(u-w)}{m+M}": "holds",
    r"u'=\frac{mu+Mw-em(u-w)}{m+M}": "wrong",
    r"T-T'=\frac{1-e^2}{2}\frac{mM}{m+M}(u-w)^2": "holds",
    r"T-T'=\frac{(1-e)^2}{2}\frac{mM}{m+M}(u-w)^2": "wrong",
    r"\Delta T=\frac{1-e^2}{2}\frac{mM}{m+M}(u-w)^2": "undecided",  # what is lost or gained?
    r"\Delta T=-\frac{1-e^2}{2}\frac{mM}{m+M}(u-w)^2": "holds",
    r"M(w'-w)=J": "holds",
    r"m(u'-u)=J": "wrong",
}

BLOW = r"""
[system]
coordinates = { x = "m", phi = "rad" }
parameters = { m = "kg", a = "m", B = "N*s", H = "m", Theta = "kg*m^2" }
[system.motions.blow]
start = { x_dot = 0, phi_dot = 0 }
impulse = { x = "B", phi = "B*H" }
zero = ["x_dot - a*phi_dot"]
[system.bodies]
ball = { mass = "m", at = ["x", 0, 0], moments = ["Theta"], omega = ["phi_dot"] }
[system.symbols]
'\Theta' = "Theta"
"v'" = "x_dot after blow"
"""
OF_BLOW = {
    r"B=m v'\Rightarrow H=\frac{\Theta}{m a}": "holds",
    r"BH=\Theta\frac{v'}{a}": "holds",
    r"BH=2\Theta\frac{v'}{a}": "wrong",
}

SYSTEMS = (
    (HOOP, OF_HOOP), (PENDULUM, OF_PENDULUM), (SLIDE, OF_SLIDE), (IMPACT, OF_IMPACT), (BLOW, OF_BLOW),
)  # fmt: skip


@pytest.mark.sparse(2)
@pytest.mark.parametrize("system", range(len(SYSTEMS)))
def test_what_is_derived_of_a_system(system):
    text, lines = SYSTEMS[system]
    found = judged(parse_lexicon(text), *lines)
    assert dict(zip(lines, (v.verdict for v in found), strict=True)) == lines


def test_brackets_and_routhians_are_what_the_note_says():
    lines = {
        r"\{f,h\}\equiv\sum_i\left(\frac{\partial f}{\partial p_i}\frac{\partial h}{\partial q_i}"
        r"-\frac{\partial f}{\partial q_i}\frac{\partial h}{\partial p_i}\right)": "definition",
        r"\{q_i,p_j\}=-\delta_{ij}": "holds",
        r"\{q_i,p_j\}=\delta_{ij}": "wrong",
        r"R(\alpha,\dot\alpha,\beta;p_\beta)\equiv p_\beta\dot\beta-L": "definition",
        r"\frac{d}{dt}\frac{\partial R}{\partial\dot\alpha}=\frac{\partial R}{\partial\alpha}": "holds",
        r"\dot p_\beta=\frac{\partial R}{\partial\beta}": "wrong",
        r"\dot\beta=\frac{\partial R}{\partial p_\beta}": "holds",
    }
    own = parse_lexicon(PENDULUM.replace("[symbols]", '[symbols]\nR = "defined"', 1))
    assert [v.verdict for v in judged(own, *lines)] == list(lines.values())


@pytest.mark.parametrize(
    ("setting", "lines"),
    [
        (
            "",
            {
                r"\dot h=\{h,H\}": "undecided",
                r"\dot h=2\{h,H\}": "wrong",
                r"\{\alpha,\beta\}=0": "holds",
                r"\{h,h\}=0": "holds",
                r"\{f,h\}=-\{h,f\}": "holds",
                r"\{f,h\}=\{h,f\}": "wrong",
            },
        ),
        ("", {r"\{p_\beta,\beta\}=1": "definition", r"\dot h=\{H,h\}": "holds"}),
        ("", {r"\{\beta,p_\beta\}=2": "wrong", r"\dot h=\{H,h\}": "undecided"}),
        ("p q", {r"\{\beta,p_\beta\}=1": "wrong", r"\dot h=\{H,h\}": "holds"}),
        ("q p", {r"\dot h=\{h,H\}": "holds", r"\{p_\beta,\beta\}=1": "wrong"}),
    ],
)
def test_brackets_have_the_sign_that_something_says(setting, lines):
    own = f'[notation]\nbrackets = "{setting}"\n' if setting else ""
    found = judged(parse_lexicon(own + PENDULUM), *lines)
    assert [v.verdict for v in found] == list(lines.values())


ROD = r"""
[system]
coordinates = { theta = "rad" }
parameters = { m = "kg", l = "m", g = "m/s^2", k = "N/m" }
gravity = [0, "-g", 0]
[system.bodies]
bob = { mass = "m", at = ["l*sin(theta)", "-l*cos(theta)", 0] }
[system.reactions]
T = { on = "bob", along = ["-sin(theta)", "cos(theta)", 0] }
"""
PLANE = r"""
[symbols]
'A' = "defined"
[system]
coordinates = { x = "m", y = "m" }
parameters = { m = "kg", k = "N/m" }
[system.bodies]
ball = { mass = "m", at = ["x", "y", 0] }
[system.springs]
s = { between = ["ball", [0, 0, 0]], stiffness = "k" }
"""


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        (
            ROD,  # potential energy is zero where the first line has it
            {
                r"V=mgl(1-\cos\theta)": "holds",
                r"L=\frac12 ml^2\dot\theta^2-mgl(1-\cos\theta)": "holds",
                r"E=\frac12 ml^2\dot\theta^2+V": "holds",
                r"V=-mgl\cos\theta": "wrong",
            },
        ),
        (ROD, {r"V=mgl(1+\cos\theta)": "wrong", r"E=V+mgl(1-\cos\theta)": "wrong"}),
        (
            ROD,  # T is no energy where the lexicon has the letter
            {
                r"T=ml\dot\theta^2+mg\cos\theta": "holds",
                r"T=ml\dot\theta^2-mg\cos\theta": "wrong",
                r"E-V=\frac12 ml^2\dot\theta^2": "holds",
            },
        ),
        (
            PLANE,  # parameters have no variables in brackets behind them
            {
                r"V(x,y)=\frac12k(x^2+y^2)": "holds",
                r"A(x,y)=x^2-y^2": "definition",
                r"\dot A(x,y)=2x\dot x-2y\dot y": "holds",
                r"m(\ddot x,\ddot y)=-k(x,y)": "holds",
                r"m(\ddot x,\ddot y)=-k(x,-y)": "wrong",
            },
        ),
    ],
)
def test_letters_are_what_lines_and_lexicon_make_of_them(text, lines):
    found = judged(parse_lexicon(text), *lines)
    assert [v.verdict for v in found] == list(lines.values())


STRING = r"""+++
[check.symbols]
'\Omega_T' = "defined"
[check.system]
coordinates = { theta = "rad" }
parameters = { m = "kg", l = "m", g = "m/s^2" }
gravity = [0, "-g", 0]
[check.system.bodies]
bob = { mass = "m", at = ["l*sin(theta)", "-l*cos(theta)", 0] }
+++
# Energy

The kinetic energy is
$$T=\frac12ml\dot\theta^2$$

# String

The tension $T$ follows.
$$T=ml\dot\theta^2+mg\cos\theta$$
With an index it is another letter:
$$\Omega_T:=\sqrt{g/l}$$
$$\ddot\theta=\Omega_T^2\sin\theta$$
The moment of momentum about the hinge is
$$L=ml^2\dot\theta$$
and the energy
$$E=\frac12ml^2\dot\theta^2-mgl\sin\theta$$

# Small swings

$$T=ml^2\dot\theta^2$$
"""


def test_letters_of_energies_are_theirs_unless_the_words_say_otherwise():
    found = [f.verdict for f in check(STRING).findings if f.kind == "display"]
    assert found == ["wrong", "undecided", "definition", "wrong", "undecided", "wrong", "wrong"]


SWING = r"""+++
[check.symbols]
'\varphi' = "defined"
't' = "time"
[check.system]
coordinates = { theta = "rad" }
parameters = { m = "kg", g = "m/s^2", l = "m" }
gravity = [0, "-g", 0]
[check.system.bodies]
bob = { mass = "m", at = ["l*sin(theta)", "-l*cos(theta)", 0] }
+++
# Pendulum

For small $\theta$ the equation becomes
$$\ddot\theta+\frac{g}{l}\theta=0$$
and not, to first order,
$$\ddot\theta+\frac{2g}{l}\theta=0$$
From the top, where
$$\varphi:=\theta-\pi$$
$$\ddot\varphi\approx\frac{g}{l}\varphi$$
$$\ddot\varphi\approx-\frac{g}{l}\varphi$$
# Fall
$$\dot\theta = -\frac gl\,t$$
"""


def test_what_is_small_is_judged_to_first_order():
    found = [f.verdict for f in check(SWING).findings if f.kind == "display"]
    assert found == ["holds under", "wrong", "definition", "holds", "wrong", "undecided"]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"theta at rest"', '"theta at rst"', "unknown quantity of the system"),
        ('"theta at rest"', '"thta at rest"', "unknown quantity of the system"),
        ("nonzero", "nonzer", "unknown key"),
        ('"sin(theta)"', '"sin(thta)"', "thta"),
    ],
)
def test_bad_motions_are_told(old, new, message):
    with pytest.raises(InputError, match=message):
        parse_lexicon(HOOP.replace(old, new))


@pytest.mark.sparse(1)
@pytest.mark.parametrize(
    ("text", "line", "repaired"),
    [
        (HOOP, r"\cos\theta_*=\frac{2g}{a\Omega^2}", r"\cos\theta_*=\frac{g}{a\Omega^2}"),
        (HOOP, r"\omega_b^2=\frac{g}{a}+\Omega^2", r"\omega_b^2=\frac{g}{a}-\Omega^2"),
        (IMPACT, r"u'=\frac{mu+Mw-em(u-w)}{m+M}", r"u'=\frac{mu+Mw-eM(u-w)}{m+M}"),
    ],
)
def test_slips_are_repaired_in_a_motion(text, line, repaired):
    (understood,) = understand(read_document(f"$${line}$$"), parse_lexicon(text))
    (judged_,) = verdict(understood).claims
    offered = [c.latex.replace(" ", "") for c in explain(understood, judged_).corrections]
    assert repaired in offered


def test_kinds_of_a_blow_that_a_line_leaves_out_are_meant():
    lines = {
        r"\frac12mu^2+\frac12Mw^2=\frac12mu'^2+\frac12Mw'^2": (("e = 1",),),
        r"u-w=w'-u'": (("e = 1",),),
        r"u'=w'": (("e = 0",),),
        r"u'=\frac{mu+Mw}{m+M}": (("e = 0",),),
        r"J=\frac{2mM}{m+M}(u-w)": (("e = 1",),),
        r"J=\frac{mM}{m+M}(1-e)(u-w)": (),  # writes e, so it is of any blow
        r"\frac12mu^2+\frac12Mw^2=\frac12mu'^2-\frac12Mw'^2": (),
        r"u-w=2w'-u'": (),
    }
    found = judged(parse_lexicon(IMPACT), *lines)
    verdicts = ["holds under" if sets else "wrong" for sets in lines.values()]
    assert [v.verdict for v in found] == verdicts
    assert [v.claims[0].judgement.sets for v in found] == list(lines.values())


LEVEL = r"""+++
[check.system]
coordinates = { chi = "rad" }
parameters = { m = "kg", c = "m", g = "m/s^2", lam = "rad", kap = "rad" }
gravity = [0, 0, "-g"]
[check.system.bodies]
car = { mass = "m", at = ["c*cos(kap)*cos(chi)", "c*cos(kap)*sin(chi)", 0] }
[check.system.reactions]
R = { on = "car", along = ["-cos(chi)*sin(lam)", "-sin(chi)*sin(lam)", "cos(lam)"] }
S = { on = "car", along = ["cos(chi)*cos(lam)", "sin(chi)*cos(lam)", "sin(lam)"] }
[check.system.motions]
bend = { constant = ["chi_dot"], zero = ["S"], nonzero = ["chi_dot"] }
[check.system.symbols]
'R' = "R at bend"
'\chi' = "chi"
'\lambda' = "lam"
'\kappa' = "kap"
+++
# Bend

The car goes round at a steady rate.
$$R\cos\lambda=mg$$
$$R\sin\lambda=mc\,\dot\chi^2\cos\kappa$$
$$R\sin\lambda=2mc\,\dot\chi^2$$
$$R\sin\lambda=mc\,\dot\chi^2$$
"""


@pytest.mark.parametrize(
    ("said", "wanted"),
    [
        ("", ["holds", "holds", "wrong", "wrong"]),
        (r"From here on $\kappa=0$.", ["holds", "holds", "wrong", "holds under"]),
    ],
)
def test_an_angle_at_zero_is_meant_where_the_section_says_so(said, wanted):
    found = [f.verdict for f in check(LEVEL + said).findings if f.kind == "display"]
    assert found == wanted


def test_a_parameter_that_is_said_to_be_zero_is_no_slip():
    found = [f.verdict for f in check(LEVEL + r"From here on $\kappa=0$.").findings]
    assert found[-1] == "holds under"


def test_what_may_be_assumed_is_known_where_a_claim_has_too_many_derivatives():
    line = r"$$\frac{d^4}{dt^4}\frac{d^4\chi}{dt^4}=0$$"
    (understood,) = understand(read_document(line), lexicon_for(LEVEL))
    (claim,) = understood.claims
    assert set(models_of(claim).possible) == {r.name for r in claim.model.possible}
    assert verdict(understood).verdict == "undecided"


@pytest.mark.parametrize("unit", ["N m", "N*m"])
def test_loads_are_absent_in_either_spelling_of_their_unit(unit):
    text = (
        LEVEL.partition("# Bend")[0]
        .replace('kap = "rad" }', f'kap = "rad", D = "{unit}", k = "{unit}" }}')
        .replace("gravity =", 'forces = { chi = "k*sin(chi) - D" }\ngravity =')
        .replace("'R' = ", "'D' = \"D\"\n'k' = \"k\"\n'R' = ")
    )
    lines = r"""
$$mc^2\cos^2\kappa\,\ddot\chi=k\sin\chi-D$$
From here on $D=0$.
$$mc^2\cos^2\kappa\,\ddot\chi=k\sin\chi$$
$$mc^2\cos^2\kappa\,\ddot\chi=2k\sin\chi$$
"""
    found = [(f.kind, f.verdict) for f in check(text + lines).findings]
    assert sorted(found) == [
        ("display", "holds"),
        ("display", "holds under"),
        ("display", "wrong"),
        ("inline", "holds under"),
    ]


def test_angles_by_a_formula_turn_with_those_that_they_are_made_of():
    named = PENDULUM.replace(
        "[system.values]",
        '[system.values]\nsig = { is = "alpha + beta", unit = "rad" }\n'
        'dif = { is = "(alpha - beta)/2", unit = "rad" }',
    ).replace("[system.symbols]", "[system.symbols]\n'\\sigma' = \"sig\"\n'\\delta' = \"dif\"")
    lines = {
        r"\sin\sigma = \sin\alpha\cos\beta + \cos\alpha\sin\beta": "holds",
        r"\sin\sigma = \sin\alpha\cos\beta - \cos\alpha\sin\beta": "wrong",
        r"\begin{bmatrix}\cos\alpha&-\sin\alpha\\ \sin\alpha&\cos\alpha\end{bmatrix}"
        r"\begin{bmatrix}\cos\beta&-\sin\beta\\ \sin\beta&\cos\beta\end{bmatrix}"
        r"=\begin{bmatrix}\cos\sigma&-\sin\sigma\\ \sin\sigma&\cos\sigma\end{bmatrix}": "holds",
        r"2\sin^2\delta = 1-\cos(\alpha-\beta)": "holds",
        r"2\sin^2\delta = 1+\cos(\alpha-\beta)": "wrong",
        r"\cos(\sigma-\beta) = \cos\alpha": "holds",
    }
    found = judged(parse_lexicon(named), *lines)
    assert [v.verdict for v in found] == list(lines.values())


FREE = r"""+++
[check.system]
coordinates = { theta = "rad" }
parameters = { m = "kg", l = "m", a = "m", g = "m/s^2", P = "s" }
gravity = [0, "-g", 0]
[check.system.bodies]
bob = { mass = "m", at = ["l*sin(theta)", "-l*cos(theta)", 0] }
[check.system.values]
I = { is = "m*l^2", unit = "kg*m^2" }
+++
"""


@pytest.mark.parametrize(
    ("line", "said"),
    [
        (r"P=2\pi\sqrt{\frac lg}", "undecided"),
        (r"P^2=4\pi^2\frac lg", "undecided"),
        (r"l=2a", "undecided"),
        (r"P=2\pi\sqrt{\frac lg}=3\pi\sqrt{\frac lg}", "wrong"),
        (r"l=\frac l2+\frac l3", "wrong"),
        (r"mgl=mga", "wrong"),
        (r"I=2ml^2", "wrong"),
        (r"l\ddot\theta=-2g\sin\theta", "wrong"),
    ],
)
def test_a_parameter_given_by_others_is_not_decided_by_motions(line, said):
    found = check(f"{FREE}$${line}$$").findings[-1]
    assert found.verdict == said
    assert ("parameter of the system" in found.reason) == (said == "undecided")
