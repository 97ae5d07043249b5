"""Shipped derivations with frames, bodies or laws of their own: what is true of them, by other means.

Highest rates are those of published equations of motion; SymPy's vector package evaluates the lines
(`own_oracle`). What such a chapter says of any system is true by numerics on smooth motions (`oracle`).
"""

from functools import cache

import sympy as sp

from eom.derivations.deciding import Deciding
from eom.derivations.derivation import SIGNS
from eom.derivations.verification import DerivationError
from eom.errors import InputError
from eom.terms.terms import nodes
from tests.eom import configured_oracle, oracle, own_derivations
from tests.eom.own_oracle import Mechanics


def symbols(names):
    return sp.symbols(names, real=True)


def top():
    """Goldstein, Poole, Safko, Classical Mechanics (2002), 5.7: Lagrange's equations, solved."""
    m, g, length, I1, I3 = symbols("m g l I_1 I_3")
    theta, th, ph, ps = symbols("theta theta_dot phi_dot psi_dot")
    s, c = sp.sin(theta), sp.cos(theta)
    spin = ps + ph * c
    phi = (I3 * spin * th - 2 * I1 * ph * th * c) / (I1 * s)
    return {
        ("theta", 2): (I1 * ph**2 * c - I3 * spin * ph + m * g * length) * s / I1,
        ("phi", 2): phi,
        ("psi", 2): ph * th * s - phi * c,
    }


def craft():
    """Hughes, Spacecraft Attitude Dynamics (1986), ch. 9: exact equations, and those of small angles."""
    n, I1, I2, I3 = symbols("n I_1 I_2 I_3")
    phi, theta, psi, ph, th, ps = symbols("phi theta psi phi_dot theta_dot psi_dot")
    second = symbols("phi_ddot theta_ddot psi_ddot")
    cos, sin = sp.cos, sp.sin
    # [omega] = [phi', 0, 0] + C_1 [0, theta', 0] + C_1 C_2 [0, 0, psi'] + C (0, -n, 0)
    c1 = sp.Matrix([[1, 0, 0], [0, cos(phi), sin(phi)], [0, -sin(phi), cos(phi)]])
    c2 = sp.Matrix([[cos(theta), 0, -sin(theta)], [0, 1, 0], [sin(theta), 0, cos(theta)]])
    c3 = sp.Matrix([[cos(psi), sin(psi), 0], [-sin(psi), cos(psi), 0], [0, 0, 1]])
    w = sp.Matrix([ph, 0, 0]) + c1 * sp.Matrix([0, th, 0]) + c1 * c2 * sp.Matrix([0, 0, ps])
    w += c1 * c2 * c3 * sp.Matrix([0, -n, 0])
    down = (c1 * c2 * c3)[:, 2]
    angles, first = sp.Matrix([phi, theta, psi]), sp.Matrix([ph, th, ps])
    rate = w.jacobian(angles) * first + w.jacobian(first) * sp.Matrix(second)
    J = sp.diag(I1, I2, I3)
    rest = J * rate + w.cross(J * w) - 3 * n**2 * down.cross(J * down)
    found = sp.solve(list(rest), second, dict=True)[0]
    a1, a2, a3, v1, v3 = symbols("alpha_1 alpha_2 alpha_3 alpha_1_dot alpha_3_dot")
    names = ("phi", "theta", "psi")
    return {
        ("eta", 1): n,
        **{(q, 2): found[s] for q, s in zip(names, second, strict=True)},
        ("alpha_1", 2): (-4 * n**2 * (I2 - I3) * a1 + n * (I1 - I2 + I3) * v3) / I1,
        ("alpha_2", 2): -3 * n**2 * (I1 - I3) * a2 / I2,
        ("alpha_3", 2): (-(n**2) * (I2 - I1) * a3 - n * (I1 - I2 + I3) * v1) / I3,
    }


def blows():
    """Greenwood, Principles of Dynamics (1988), 4.4 and 8.2."""
    m1, m2, v1, v2, e = symbols("m_1 m_2 v_1 v_2 e")
    m, length, P, a, h = symbols("m l P a h")
    centre = (m1 * v1 + m2 * v2) / (m1 + m2)
    return {
        ("u_1", 0): centre - e * m2 * (v1 - v2) / (m1 + m2),
        ("u_2", 0): centre + e * m1 * (v1 - v2) / (m1 + m2),
        ("v", 0): P / m,
        ("omega", 0): 12 * P * a / (m * length**2),
        ("Omega", 0): 3 * P * h / (m * length**2),
        ("R", 0): P * (3 * h / (2 * length) - 1),
    }


def burn():
    """Goldstein, ch. 1, exercise 13, integrated."""
    c, g, m, m_0, v_0, w_0, t, t_0 = symbols("c g m m_0 v_0 w_0 t t_0")
    gained = c * sp.log(m_0 / m)
    return {
        ("t", 1): sp.Integer(1),
        ("v", 0): v_0 + gained,
        ("w", 0): w_0 + gained - g * (t - t_0),
    }


MOTIONS = {
    "heavy-symmetric-top": top,
    "gravity-gradient-stability": craft,
    "collisions": blows,
    "rocket-equation": burn,
}
"""Rates by name and order, of the chapters with laws of their own."""

SUPPOSED = "supposed"
"""The evidence of a condition."""

GENERAL = {"gravity_torque", "linear_momentum", "external_force", "angular_momentum", "torque"}


@cache
def mechanics(name, d):
    """What the lines of a chapter, or of a derivation of one's own, are evaluated by."""
    return Mechanics(d, MOTIONS[name]() if name in MOTIONS else own_derivations.MOTIONS[name])


def is_general(d, equation):
    """Whether a line is of any system, not of a body of the chapter."""
    parts = (*nodes(equation.left), *nodes(equation.right))
    named = [n.data for n in parts if n.head == "atom" and n.data[0] in GENERAL]
    return any(not set(labels) & set(d.own.bodies) for _, *labels in named)


def is_true(d, equation, assumptions):
    """Whether a line of a derivation is true. Raises `oracle.Undefined` where that is not known."""
    if d.own.configured:
        return configured_oracle.is_true(Held(d), equation, assumptions)
    if d.name not in {*MOTIONS, *own_derivations.MOTIONS}:
        try:
            return oracle.is_true(equation, assumptions, d.scalars)
        except (
            oracle.Absent
        ):  # it needs no assumption, but what it is of is there under that one alone
            return oracle.is_true(equation, d.assumptions, d.scalars)
    try:
        if is_general(d, equation):
            return oracle.is_true(equation, assumptions, d.scalars)
        known = mechanics(d.name, Held(d))
        if equation.relation == ">=":
            return _is_sign(known, equation)
        return known.is_true(equation)
    except (AttributeError, KeyError, NotImplementedError) as error:
        raise oracle.Undefined(f"not known elsewhere: {error}") from None


def _is_sign(known, equation):
    """Whether a sign needs no condition."""
    found = known.is_never_negative(equation)
    if found is None:
        raise oracle.Undefined("no state with a real value was drawn")
    return found


def is_conditional(step):
    """Whether a line is a condition, or a sign that follows from conditions: no line alone can tell."""
    return step.evidence in {SIGNS, SUPPOSED}


class Held:
    """A derivation as a key: itself and nothing else."""

    def __init__(self, d):
        self.d, self.scalars, self.own = d, d.scalars, d.own

    def __hash__(self):
        return id(self.d)

    def __eq__(self, other):
        return self.d is other.d


@cache
def _lines(held):
    return Deciding(held.own, held.scalars)


def verified(d, equation, assumptions):
    """What the derivation itself says of a line: how it was verified. Raises `DerivationError`."""
    return _lines(Held(d)).decided(equation, assumptions)


def judge(d, equation, assumptions):
    """What the checker says: accepted, rejected, undecided (a sign that shows no form), ill-formed."""
    try:
        verified(d, equation, assumptions)
    except DerivationError as error:
        return "undecided" if "decided" in error.what else "rejected"
    except InputError:
        return "ill-formed"
    return "accepted"
