r"""Derivatives by coordinates, rates, speeds and momenta: true lines hold, slips are found."""

import pytest
import sympy as sp

from eom.checker.judge.coordinates import derivative
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.mean.model import load_model
from eom.errors import InputError
from eom.worlds.solutions import rate
from tests.eom.checker.system_lines import judged

TOP = r"""
[system]
is = "heavy-body"
attitude = "3-1-3"
assume = ["I1 = I2"]
[system.symbols]
'M' = "m"
'l' = "r3"
'I_1' = "I1"
'I_3' = "I3"
'\omega_3' = "omega_3"
'\phi' = "psi"
'\psi' = "phi"
'T' = "T"
'E' = "E"
'V' = '= M g l \cos\theta'
'L' = '= T - V'
'p_\theta' = '= \frac{\partial L}{\partial\dot\theta}'
'p_\phi' = '= \frac{\partial L}{\partial\dot\phi}'
'p_\psi' = '= \frac{\partial L}{\partial\dot\psi}'
'U' = '= \frac{(p_\phi-p_\psi\cos\theta)^2}{2I_1\sin^2\theta}+\frac{p_\psi^2}{2I_3}+V'
'H' = '= \frac{p_\theta^2}{2I_1}+U'
'R' = '= \frac12 I_1\dot\theta^2-U'
"""
OF_TOP = {
    r"\frac{d}{dt}\frac{\partial L}{\partial\dot\theta}-\frac{\partial L}{\partial\theta}=0": "holds",
    r"\dv{t}\pdv{L}{\dot\theta} + \pdv{L}{\theta} = 0": "wrong",
    r"\frac{\mathrm d}{\mathrm dt}\left(\frac{\partial T}{\partial\dot\theta}\right)"
    r"=\frac{\partial T}{\partial\theta}+Mgl\sin\theta": "holds",
    r"\frac{d}{dt}\frac{\partial T}{\partial\dot\theta}=Mgl\sin\theta": "wrong",
    r"p_\psi = \partial T/\partial\dot\psi = I_3\omega_3 = \text{const}": "holds",
    r"p_\phi = I_1\dot\phi\sin^2\theta + p_\psi\cos\theta": "holds",
    r"p_\phi = I_1\dot\phi\sin^2\theta + p_\psi\sin\theta": "wrong",
    r"\dot p_\theta = -\frac{\partial H}{\partial\theta}": "holds",
    r"\dot p_\theta = \frac{\partial H}{\partial\theta}": "wrong",
    r"\dot\phi = \pdv{H}{p_\phi} = \frac{p_\phi-p_\psi\cos\theta}{I_1\sin^2\theta}": "holds",
    r"\dot\psi = -\frac{\partial H}{\partial p_\psi}": "wrong",
    r"\frac{d}{dt}\frac{\partial R}{\partial\dot\theta}=\frac{\partial R}{\partial\theta}": "holds",
    r"H = p_\theta\dot\theta+p_\phi\dot\phi+p_\psi\dot\psi-L = E": "holds",
    r"\frac{\partial^2 T}{\partial\dot\phi\,\partial\dot\psi}=I_3\cos\theta": "holds",
    r"\frac{\partial^2 T}{\partial\dot\theta^2}=2I_1": "wrong",
    r"\frac{\partial T}{\partial\omega_3}=I_3\omega_3": "holds",
    r"\frac{\partial L}{\partial\theta}=\frac{\partial T}{\partial\dot\theta}": "wrong",  # dimensions
    r"\dot p_\theta = -\frac{\partial E}{\partial\theta}": "undecided",  # rates or momenta held?
    r"\frac{\partial E}{\partial p_\phi}=\dot\phi": "undecided",  # E is not written in it
}


@pytest.mark.sparse(1)
@pytest.mark.parametrize("line", OF_TOP)
def test_energies_of_a_top(line):
    assert [v.verdict for v in judged(parse_lexicon(TOP), line)] == [OF_TOP[line]]


def test_energies_of_a_tree():
    lexicon = parse_lexicon(
        """
        [system]
        is = "double-pendulum"
        [system.symbols]
        'q_1' = "q_shoulder"
        'q_2' = "q_elbow"
        'm_2' = "m2"
        'l_2' = "l2"
        'T' = "kinetic_energy"
        'V' = "potential_energy"
        """
    )
    lines = {
        r"\dv{t}\pdv{T}{\dot q_2}-\pdv{T}{q_2}=-\pdv{V}{q_2}": "holds",
        r"\frac{d}{dt}\frac{\partial T}{\partial\dot q_1}=-\frac{\partial V}{\partial q_1}": "holds",
        r"\frac{d}{dt}\frac{\partial T}{\partial\dot q_2}=-\frac{\partial V}{\partial q_2}": "wrong",
        r"\frac{\partial^2T}{\partial\dot q_2^2}=\tfrac13m_2l_2^2": "holds",
    }
    assert [v.verdict for v in judged(lexicon, *lines)] == list(lines.values())


FREE = r"""
[frames]
'N' = "I"
[symbols]
'm' = {is = "scalar m", unit = "kg"}
'k' = {is = "scalar k", unit = "N/m"}
'x' = {is = "coordinate x", unit = "m"}
'l_0' = {is = "scalar l", unit = "m"}
'\theta' = "free_angle theta"
'L' = '= \frac12 m(\dot x^2+x^2\dot\theta^2)-\frac12kx^2'
'V' = '= \frac12kx^2'
'\mathbf n_{<k>}' = "unit I <k>"
'\mathbf v' = '= \dot x\cos\theta\,\mathbf n_1+\dot x\sin\theta\,\mathbf n_2+x\dot\theta\mathbf n_3'
"""
FREELY = {
    r"\frac{\partial L}{\partial\dot x}=m\dot x": "holds",
    r"\frac{\partial L}{\partial x}=mx\dot\theta^2-kx": "holds",
    r"\frac{\partial L}{\partial x}=mx\dot\theta^2+kx": "wrong",
    r"\frac{d}{dt}\frac{\partial L}{\partial\dot\theta}=m x^2\ddot\theta+2mx\dot x\dot\theta": "holds",
    r"\frac{d}{dt}\frac{\partial L}{\partial\dot\theta}=m x^2\ddot\theta+mx\dot x\dot\theta": "wrong",
    r"\frac{\partial\mathbf v}{\partial\dot x}=\cos\theta\,\mathbf n_1+\sin\theta\,\mathbf n_2": "holds",
    r"\frac{\partial\mathbf v}{\partial\dot\theta}=x\,\mathbf n_2": "wrong",
    r"\frac{dV}{dx}=kx": "holds",
    r"\left.\frac{\partial L}{\partial x}\right|_{\dot\theta=0}=-kx": "holds",
    r"\Bigl.\frac{\partial L}{\partial x}\Bigr|_{\dot\theta=0,\,x=0}=0": "holds",
    r"\left.\frac{\partial L}{\partial x}\right|_{\dot\theta=0}=kx+kx": "wrong",
    r"x = l_0\sin\theta": "undecided",  # a constraint of the writer's
    r"\left.\mathbf v\right|_{x=0}=0": "undecided",
    r"m\ddot x - mx\dot\theta^2 + kx = 0": "undecided",  # nothing says how they move
    r"\frac{\partial L}{\partial\dot\theta}=\text{const}": "undecided",
    r"\dot x = 0": "undecided",
}


@pytest.mark.parametrize("line", FREELY)
def test_formulas_of_free_coordinates(line):
    assert [v.verdict for v in judged(parse_lexicon(FREE), line)] == [FREELY[line]]


def test_what_is_held_beside_the_variable():
    system = load_model("heavy-body", attitude="3-1-3").system
    named = {q.name: q.symbol for q in (*system.states, *(d.quantity for d in system.outputs))}
    theta, psi, h3 = (named[n] for n in ("theta", "psi", "H_3"))
    rates_held = derivative(system, rate(psi) * sp.sin(theta), theta)
    assert rates_held == rate(psi) * sp.cos(theta)
    assert derivative(system, h3**2 * sp.sin(theta), theta) == h3**2 * sp.cos(theta)
    assert derivative(system, h3**2 * sp.sin(theta), h3) == 2 * h3 * sp.sin(theta)
    for function, variable in ((sp.sin(theta), rate(rate(theta))), (sp.sin(theta), h3)):
        with pytest.raises(InputError):
            derivative(system, function, variable)


def test_coordinates_that_depend_on_each_other_have_no_partial_derivatives():
    system = load_model("heavy-top").system
    with pytest.raises(InputError, match="independent"):
        derivative(system, system.outputs[0].symbol, system.states[3].symbol)
