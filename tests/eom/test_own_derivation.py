"""Derivations of one's own: own frames, points and laws; false lines are refused."""

import pytest
import sympy as sp

import eom
from eom.derivations.verification import DerivationError
from eom.terms.terms import Equation, add, der, dot, expr, mul, partial
from eom.terms.vocabulary import quantity, unit, velocity

q, qd, qdd, m, g, R, w, L = sp.symbols("q q_d q_dd m g R w L", real=True)


def hoop():
    """A bead on a hoop that turns about its vertical diameter, by Lagrange."""
    d = eom.Derivation("hoop", "A bead on a hoop", "Own")
    for s, name in ((m, "m"), (g, "g"), (R, "R"), (w, "w")):
        d.name_scalar(s, quantity("scalar", name), name)
    d.name_scalar(q, quantity("coordinate", "q"), "angle from the lowest point")
    d.name_scalar(qd, der(expr(q)), "its rate")
    d.name_scalar(qdd, der(expr(qd)), "its second rate")
    turn = sp.Symbol("turn", real=True)
    d.name_scalar(turn, quantity("coordinate", "turn"), "angle of the hoop")
    d.determine(Equation(der(expr(turn)), expr(w)), turn)
    d.frame("H", turn)
    side, up = (expr(R * f) for f in (sp.sin(q), -sp.cos(q)))
    d.point("Q", add(mul(side, unit("H", 1)), mul(up, unit("H", 3))))
    return d


T = m * R**2 * (qd**2 + w**2 * sp.sin(q) ** 2) / 2
V = -m * g * R * sp.cos(q)


def test_a_bead_on_a_hoop_by_lagrange():
    d = hoop()
    v = velocity("Q")
    d.state(Equation(mul(expr(m / 2), dot(v, v)), expr(T)), "kinetic energy")
    d.state(Equation(partial(expr(T - V), expr(qd)), expr(m * R**2 * qd)), "momentum")
    law = Equation(der(partial(expr(T - V), expr(qd))), partial(expr(T - V), expr(q)))
    d.determine(law, q)
    motion = w**2 * sp.sin(q) * sp.cos(q) - g / R * sp.sin(q)
    d.state(Equation(expr(qdd), expr(motion)), "equation of motion", label="motion")
    count = len(d.steps)
    for false in (-motion, motion.subs(w, 0), motion + 2 * g / R * sp.sin(q),
                  w**2 * sp.sin(q) * sp.cos(q) - g / R * sp.cos(q)):  # fmt: skip
        with pytest.raises(DerivationError, match="false"):
            d.state(Equation(expr(qdd), expr(false)), "mutant")
    assert len(d.steps) == count
    assert d.finish()["motion"].evidence == "held in 3 random worlds"
