r"""Proportions: the quotient of both sides is constant while letters of the right one vary, or in time."""

import pytest

import eom
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import single_statements, split
from tests.eom.checker.system_lines import judged

ORBIT = r"""
[system]
coordinates = { r = "m", theta = "rad" }
parameters = { m = "kg", mu = "m^3/s^2" }
potential = "-m*mu/r"
[system.bodies]
planet = { mass = "m", at = ["r*cos(theta)", "r*sin(theta)", 0] }
[system.values]
h = { is = "r**2*theta_dot", unit = "m^2/s" }
v = { is = "(r_dot**2+r**2*theta_dot**2)**(1/2)", unit = "m/s" }
[system.symbols]
'C' = "h"
'v' = "v"
'\varphi' = "theta"
'\mu' = "mu"
"""
OF_A_SYSTEM = {
    r"\dot\varphi\propto\frac1{r^2}": ("holds", "as time goes on"),
    r"\dot\varphi\propto\frac1{mr^2}": ("holds", "as time goes on"),
    r"V\propto\frac1r": ("holds", "r may vary; held constant: m, mu"),
    r"V\propto\frac1{r^2}": ("wrong", ""),
    r"V\propto\frac mr": ("holds", "m, r may vary; held constant: mu"),
    r"V\quad\text{is proportional to}\quad m": ("holds", ""),
    r"V\;\text{varies as}\;m^2": ("wrong", ""),
    r"T\propto mv^2": ("holds", ""),
    r"T\propto m^2v^2": ("wrong", ""),
    r"T\propto v": ("wrong", ""),
    r"C^2\propto r": ("holds under", ""),  # on circles
    r"C^3\propto r": ("wrong", ""),
    r"\dot\varphi^2\propto r^{-3}": ("holds under", ""),
    r"r^2\ddot\varphi+2r\dot r\dot\varphi\propto r": ("holds", ""),
    r"V=-\frac{m\mu}{r}\propto\frac1{r^2}": ("wrong", ""),
}


@pytest.mark.parametrize("line", OF_A_SYSTEM)
def test_quantities_of_a_system(line):
    (found,) = judged(parse_lexicon(ORBIT), line)
    wanted, why = OF_A_SYSTEM[line]
    assert found.verdict == wanted
    assert why in [c.judgement.reason for c in found.claims] or not why
    sets = [c.judgement.sets for c in found.claims]
    assert sets == [(("r constant",),)] or wanted != "holds under"


CYLINDER = r"""A cylinder has radius $R$, length $\ell$ and density $\rho$. Its mass is
$$m_{\text{cyl}} = \rho\pi R^2\ell$$
$$I_{\text{cyl}} = \frac12 m_{\text{cyl}}R^2$$
"""
OF_LETTERS = {
    r"I_{\text{cyl}}\propto R^4": "holds",
    r"I_{\text{cyl}}\propto R^2": "holds",  # at the same mass
    r"I_{\text{cyl}}\propto R^3": "wrong",
    r"I_{\text{cyl}}\propto m_{\text{cyl}}R^2": "holds",
    r"I_{\text{cyl}}\propto\rho\ell": "holds",
    r"I_{\text{cyl}}\propto\rho^2": "wrong",
    r"I_{\text{cyl}}\propto b": "undecided",
}


@pytest.mark.parametrize("notation", ["physics-bold", "kane"])
def test_letters_of_a_note(notation):
    note = CYLINDER + "\n".join(f"$${line}$$" for line in OF_LETTERS)
    found = [f.verdict for f in eom.check(note, notation=notation).findings]
    assert found[-len(OF_LETTERS) :] == list(OF_LETTERS.values())


def test_what_is_held_is_said():
    report = eom.check(CYLINDER + r"$$I_{\text{cyl}}\propto R^4$$", notation="physics-bold")
    assert "R may vary; held constant: ell, rho" in str(report)


def test_quantities_of_a_lexicon():
    lexicon = parse_lexicon(
        r"""
        [symbols]
        'x' = "coordinate x"
        'c' = {is = "scalar c", unit = "N/m"}
        'F' = '= -c x'
        'W' = '= \tfrac12 c x^2'
        """
    )
    lines = {
        r"F\propto x": "holds",
        r"\dot F\propto\dot x": "holds",
        r"F\propto\dot x": "undecided",
        r"W\propto x^2": "holds",
        r"W\propto c": "holds",
    }
    assert [v.verdict for v in judged(lexicon, *lines)] == list(lines.values())


def test_a_chain_is_read_sign_by_sign():
    (chain,) = split(read_formula(r"a=b=c\propto d\propto e=f").tree)
    found = [[g.name for g in s.signs] for s in single_statements(chain)]
    assert found == [["=", "="], ["propto"], ["propto"], ["="]]
