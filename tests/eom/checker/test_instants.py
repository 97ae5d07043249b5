r"""Integrals over time and values at two instants: work, impulse, changes, in two notations."""

import pytest

from eom.checker.mean.lexicon_files import parse_lexicon
from tests.eom.checker.system_lines import judged

ARROWS = r"""
preset = "arrow-tilde"
[points]
'G' = "C"
'O' = "O"
[symbols]
'm' = "total_mass system"
'\vec{r}_{<i>}' = "position <i> OI"
'\vec{v}_{<i>}' = '= \dot{\vec{r}}_{<i>}'
'\vec{F}_{<i>}' = "force <i>"
'\vec{F}' = "external_force system"
'\vec{r}_{<P>}' = "position <P> OI"
'\vec{v}_{<P>}' = '= \dot{\vec{r}}_{<P>}'
'\vec{p}' = "linear_momentum system"
'\vec{h}_{<P>}' = "angular_momentum system <P>"
'\vec{\tau}_{<P>}' = "torque system <P>"
'T' = "kinetic_energy system"
"""
IMPULSE = {
    r"\int_{t_1}^{t_2}\vec F\,\mathrm dt=m\vec v_G(t_2)-m\vec v_G(t_1)": True,
    r"\int_{t_2}^{t_1}\vec F\,\mathrm dt=m\vec v_G(t_1)-m\vec v_G(t_2)": True,
    r"\int_{t_1}^{t_2}\vec F\,\mathrm dt=m\vec v_G(t_1)-m\vec v_G(t_2)": False,
    r"\Delta\vec p=\int_{t_1}^{t_2}\vec F\,dt": True,
    r"\Delta\vec p=2\int_{t_1}^{t_2}\vec F\,dt": False,
    r"\vec h_G(t)-\vec h_G(0)=\int_0^t\vec\tau_G(t')\,dt'": True,
    r"\vec h_G(t)+\vec h_G(0)=\int_0^t\vec\tau_G\,d\tau": False,
    r"T_2-T_1=\sum_{i=1}^{N}\int_{t_1}^{t_2}\vec F_i\cdot\vec v_i\;\mathrm dt": True,
    r"T_1-T_2=\sum_{i=1}^{N}\int_{t_1}^{t_2}\vec F_i\cdot\vec v_i\;\mathrm dt": False,
    r"\left. T\right|_{t_1}^{t_2}=\sum_i\int_1^2\vec F_i\cdot d\vec r_i": True,
    r"\left. T\right|_{t_1}^{t_2}=\tfrac12\sum_i\int_1^2\vec F_i\cdot d\vec r_i": False,
    r"\vec r_G(t_2)=\vec r_G(t_1)+\vec v_G(t_1)(t_2-t_1)"
    r"+\frac1m\int_{t_1}^{t_2}\int_{t_1}^{t}\vec F\,dt'\,dt": True,
    r"\vec r_G(t_2)=\vec r_G(t_1)+\vec v_G(t_2)(t_2-t_1)"
    r"+\frac1m\int_{t_1}^{t_2}\int_{t_1}^{t}\vec F\,dt'\,dt": False,
    r"\vec r_G(t_2)=\vec r_G(t_1)+\vec v_G(t_1)t_2"
    r"+\frac1m\int_{t_1}^{t_2}\int_{t_1}^{t}\vec F\,dt'\,dt": False,
    r"\vec p(t_1)+\vec p(t_2)=\vec p(t_3)": None,  # three instants
    r"\int_{t_1}^{t_2}(t_2-t)\vec F\,dt=0": None,  # one that does not run with the others
}


def found(lexicon, line):
    (one,) = judged(parse_lexicon(lexicon), line)
    return {"wrong": False, "undecided": None}.get(one.verdict, True)


@pytest.mark.parametrize("line", IMPULSE)
def test_impulse_and_work(line):
    assert found(ARROWS, line) is IMPULSE[line]


BOLD = r"""
preset = "physics-bold"
[symbols]
'\mathbf{v}_C' = '= \dot{\mathbf r}_C'
'\mathbf{r}_C' = "position C OI"
'\mathbf{N}' = "torque body O"
'\mathbf{L}' = "angular_momentum body O"
'\mathbf{F}' = "external_force body"
'M' = "total_mass body"
"""
ANGULAR = {
    r"\int_{t_a}^{t_b}\mathbf N\,dt = \mathbf L(t_b)-\mathbf L(t_a)": True,
    r"\int_{t_a}^{t_b}\mathbf N\,dt = \mathbf L(t_b)": False,
    r"\Delta\mathbf L = \int_0^{t}\mathbf N\,d\tau": True,
    r"\mathbf v_C(t) = \mathbf v_C(0) + \frac1M\int_0^t\mathbf F(\tau)\,d\tau": True,
    r"\mathbf v_C(t) = \mathbf v_C(0) - \frac1M\int_0^t\mathbf F(\tau)\,d\tau": False,
}


@pytest.mark.parametrize("line", ANGULAR)
def test_angular_impulse(line):
    assert found(BOLD, line) is ANGULAR[line]


@pytest.mark.parametrize("line", ["q(0) = 0", r"\dot q(0) = 2", "q(t_0) = q_0", "0.5 = q(0)"])
def test_what_a_motion_starts_from_is_given(line):
    lexicon = "[system]\nis = 'double-pendulum'\n[system.symbols]\n'q' = 'q_elbow'"
    assert found(lexicon, line) is None
    assert found("[symbols]\n'q' = 'coordinate q'", line) is None


def test_of_a_system():
    lexicon = """
    [system]
    is = "double-pendulum"
    [system.symbols]
    'T' = "kinetic_energy"
    'V' = "potential_energy"
    'q' = "q_elbow"
    """
    assert found(lexicon, "T(t_2)-T(t_1) = V(t_1)-V(t_2)")
    assert found(lexicon, r"q(t) = q(0) + \int_0^t\dot q\,dt'")
    assert found(lexicon, r"q(t) = q(0) - \int_0^t\dot q\,dt'") is False
    assert found(lexicon, r"\Delta T = \Delta V") is False


ROOTS = {
    r"\frac{\boldsymbol\omega\cdot\mathbf L}{|\mathbf L|}=\frac{2T}{|\mathbf L|}": True,
    r"\frac{\boldsymbol\omega\cdot\mathbf L}{|\mathbf L|}=\frac{T}{|\mathbf L|}": False,
    r"\sqrt{\mathbf L\cdot\mathbf L}\,|\boldsymbol\omega| = \|\mathbf L\|\sqrt{\boldsymbol\omega^2}": True,
    r"\frac{d}{dt}|\mathbf L| = \frac{\mathbf L\cdot\dot{\mathbf L}}{|\mathbf L|}": True,
    r"\frac{d}{dt}|\mathbf L| = \frac{2\,\mathbf L\cdot\dot{\mathbf L}}{|\mathbf L|}": False,
}


@pytest.mark.parametrize("line", ROOTS)
def test_roots_of_squares(line):
    energy = "'T' = \"kinetic_energy body\"\n'\\boldsymbol{\\omega}' = \"angular_velocity B I\"\n"
    assert found(BOLD + energy, line) is ROOTS[line]


def test_the_sign_of_a_root_is_not_guessed():
    lexicon = "[symbols]\n'a' = \"coordinate a\"\n'\\vec b' = \"vector b\""
    assert found(lexicon, r"\sqrt{a^2\vec b\cdot\vec b} = a|\vec b|") is None
    assert found(lexicon, r"|a\vec b| = a|\vec b|") is None
    assert found(lexicon, r"|a\vec b| = |a||\vec b|")
    assert found(lexicon, r"|2\vec b| = 2|\vec b|")
