"""The rocket: Tsiolkovsky's logarithm, from Meshchersky's equation, by integration of a total derivative.

Source: Greenwood, Principles of Dynamics (1988), ch. 4; Goldstein, Poole, Safko (2002), ch. 1, exercise 13.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from eom.derivations.derivation import Chain, Derivation
from eom.derivations.derived import Derived
from eom.terms.rules import Rule, chain, entrywise, initial_values, put_in
from eom.terms.rules.inferences import integrated, solved
from eom.terms.terms import Equation, der, expr, number, start

Expr = Any


def rocket_equation() -> Derived:
    """Derive what speed a rocket gains, in free space and against gravity."""
    d = Derivation("rocket-equation", "The rocket: Tsiolkovsky's logarithm", "Particles")
    (c,) = d.constants(c="speed of the exhaust, relative to the rocket")
    m, m_dot = d.coordinate("m", "mass of the rocket with its fuel", 1)
    m_0 = d.let("m_0", start(expr(m)), "mass at the start")
    thrust = -c * m_dot
    v, v_dot = d.coordinate("v", "speed in free space", 1)
    v_0 = d.let("v_0", start(expr(v)), "speed at the start")
    d.determine(
        Equation(expr(m * v_dot), expr(thrust)),
        v,
        reason="Meshchersky's equation along the path: the exhaust goes backwards, no other force acts",
        label="law",
    )
    d.start(der(sp.log(m))).then(
        "the rate of the mass over the mass is that of its logarithm",
        chain(d.scalars),
        label="logarithm",
    )
    free = _gain(d, v, v_dot, v + c * sp.log(m), "")
    free.then("Tsiolkovsky's equation", _quotient(m, m_0), label="tsiolkovsky")
    _burn(d, (v - v_0) / c, m, m_0)
    _against_gravity(d, thrust, m, m_0)
    return d.finish()


def _against_gravity(d: Derivation, thrust: Expr, m: Expr, m_0: Expr) -> None:
    """Derive what a rocket gains that rises straight up."""
    c = next(s for s in d.scalars if s.name == "c")
    (g,) = d.constants(g="acceleration of gravity, downwards")
    t, t_dot = d.coordinate("t", "time", 1)
    d.determine(Equation(expr(t_dot), number(1)), t, reason="time goes on", label="time")
    w, w_dot = d.coordinate("w", "speed upwards against gravity", 1)
    d.let("t_0", start(expr(t)), "time at the start")
    d.let("w_0", start(expr(w)), "speed upwards at the start")
    d.determine(
        Equation(expr(m * w_dot), expr(thrust - m * g)),
        w,
        reason="the same with the weight of the rocket, straight up",
        label="law-up",
    )
    _gain(d, w, w_dot, w + c * sp.log(m) + g * t, "-up").then(
        "gravity takes g from the speed for each second: what burns fast gains most",
        _quotient(m, m_0),
        label="tsiolkovsky-up",
    )


def _quotient(m: Expr, m_0: Expr) -> Rule:
    """Return the rule log m_0 - log m = log(m_0/m)."""
    whole = {sp.log(m_0): sp.log(m_0 / m) + sp.log(m)}
    return entrywise(lambda e: sp.expand(e.xreplace(whole), log=False), "logarithm of a quotient")


def _gain(d: Derivation, speed: Expr, rate: Expr, constant: Expr, tail: str) -> Chain:
    """Derive the speed from a law, by a sum whose rate is zero."""
    solution = d.recall(f"law{tail}").infer(
        "divided by the mass", solved(expr(rate)), label=f"rate{tail}"
    )
    times = [d.recall("time").equation] if tail else []
    kept = "speed, logarithm and the part of gravity" if tail else "speed and logarithm"
    return (
        d.show(
            Equation(der(expr(constant)), number(0)),
            f"a total derivative: {kept} together do not change",
            chain(d.scalars),
            put_in(solution.equation, *times),
            label=f"total{tail}",
        )
        .infer("integrated from the start", integrated(initial_values(d.scalars)))
        .infer("solved for the speed", solved(expr(speed)))
    )


def _burn(d: Derivation, gain: Expr, m: Expr, m_0: Expr) -> None:
    """Derive the mass that is left after a gain of speed."""
    d.show(
        Equation(expr(m), expr(m_0 * sp.exp(-gain))),
        "so mass falls as the exponential of the speed that was gained: for twice the speed of the "
        "exhaust 86 percent of the mass has to be fuel",
        put_in(d.recall("tsiolkovsky").equation),
        entrywise(sp.simplify),
        label="mass-left",
    )
