"""Trials of the estimate of a run's error: thirty problems whose solutions are known, and how each is run.

Problems, methods and tolerances were chosen before any result was seen: linear, resonant, unstable, damped,
stiff, chaotic, near a separatrix, near a singularity, forwards and backwards; methods of every kind. The
first ones are quick. `codegen.measure.stress.checks` measures on them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import pi

import sympy as sp

from eom.problems import Problem, ready
from eom.quantities import TIME
from eom.system import System


@dataclass(frozen=True)
class Trial:
    """A problem, the method and the relative tolerance by which it is run.

    ``solution``: every state as an expression in the time (s), where that is known; else the reference is a
    Taylor series of many digits.
    """

    problem: Problem
    method: str
    rtol: float
    solution: Mapping[str, sp.Expr] = field(default_factory=dict)


def _equations(
    name: str, rates: Callable[..., tuple[sp.Expr, ...]], states: str
) -> Callable[[], System]:
    """Return what makes a system from rates over its states, named in one string."""

    def derive() -> System:
        x = [sp.Symbol(n, real=True) for n in states.split()]
        return System.from_rates(name, dict(zip(x, rates(*x), strict=True)))

    return derive


def _given(
    title: str,
    source: str,
    rates: Callable[..., tuple[sp.Expr, ...]],
    start: Mapping[str, float],
    end: float,
    *,
    stiff: bool = False,
) -> Problem:
    """Return a problem that is given as equations; its states are the names in ``start``."""
    name = title.lower().replace(" ", "-")
    derive = _equations(name.replace("-", "_"), rates, " ".join(start))
    return Problem(name, title, source, derive, start, {}, end, {}, stiff=stiff)


def _known(name: str, start: Mapping[str, float] | None = None, end: float = 0.0) -> Problem:
    """Return a reference problem or ready scene, with another start or end if that is given."""
    found = ready(name)
    used = {**found.start, **(start or {})}
    return Problem(
        found.name, found.title, found.source, lambda: found.system, used, found.parameters,
        end or found.end, found.inputs, stiff=found.stiff,
    )  # fmt: skip


def _kepler(x: sp.Expr, y: sp.Expr, u: sp.Expr, v: sp.Expr) -> tuple[sp.Expr, ...]:
    r3 = (x**2 + y**2) ** sp.Rational(3, 2)
    return u, v, -x / r3, -y / r3


def _from_periapsis(e: float) -> dict[str, float]:
    """Return the start of an ellipse of semi-axis 1 and eccentricity ``e`` at its periapsis."""
    return {"x": 1 - e, "y": 0.0, "u": 0.0, "v": float(sp.sqrt((1 + sp.Float(e)) / (1 - e)))}


def _lorenz(x: sp.Expr, y: sp.Expr, z: sp.Expr) -> tuple[sp.Expr, ...]:
    return 10 * (y - x), x * (28 - z) - y, x * y - sp.Rational(8, 3) * z


def _henon(x: sp.Expr, y: sp.Expr, u: sp.Expr, v: sp.Expr) -> tuple[sp.Expr, ...]:
    return u, v, -x - 2 * x * y, -y - x**2 + y**2


def _arenstorf(x: sp.Expr, y: sp.Expr, u: sp.Expr, v: sp.Expr) -> tuple[sp.Expr, ...]:
    mu = sp.Rational("0.012277471")
    near, far = x + mu, x - (1 - mu)
    d1 = (near**2 + y**2) ** sp.Rational(3, 2)
    d2 = (far**2 + y**2) ** sp.Rational(3, 2)
    return (
        u,
        v,
        x + 2 * v - (1 - mu) * near / d1 - mu * far / d2,
        y - 2 * u - (1 - mu) * y / d1 - mu * y / d2,
    )


def _pleiades(*states: sp.Expr) -> tuple[sp.Expr, ...]:
    """Return the rates of seven bodies of masses 1 to 7 in a plane: x, y, x', y' of each."""
    x, y, u, v = (states[k * 7 : (k + 1) * 7] for k in range(4))
    forces = []
    for place in (x, y):
        for i in range(7):
            total = sp.Integer(0)
            for j in (j for j in range(7) if j != i):
                r3 = ((x[i] - x[j]) ** 2 + (y[i] - y[j]) ** 2) ** sp.Rational(3, 2)
                total += (j + 1) * (place[j] - place[i]) / r3
            forces.append(total)
    return (*u, *v, *forces)


_PLEIADES = {
    "x": (3, 3, -1, -3, 2, -2, 2),
    "y": (3, -3, 2, 0, 0, -4, 4),
    "u": (0, 0, 0, 0, 0, 1.75, -1.5),
    "v": (0, 0, 0, -1.25, 1, 0, 0),
}
_SEVEN = {f"{n}{k + 1}": float(v) for n, row in _PLEIADES.items() for k, v in enumerate(row)}
_HAIRER = "Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), "
_STIFF = "Hairer and Wanner, Solving Ordinary Differential Equations II (1996), "
_OWN = "its solution is known in elementary functions"
_t = TIME

TRIALS: tuple[Trial, ...] = (
    Trial(
        _given("Oscillator", _OWN, lambda x, v: (v, -4 * x), {"x": 1.0, "v": 0.0}, 100.0),
        "auto", 1e-9, {"x": sp.cos(2 * _t), "v": -2 * sp.sin(2 * _t)},
    ),
    Trial(
        _given("Decay", _OWN, lambda x: (-x,), {"x": 1.0}, 10.0),
        "DOP853", 1e-6, {"x": sp.exp(-_t)},
    ),
    Trial(
        _given("Damped oscillator backwards", _OWN,
               lambda x, v: (v, -sp.Rational(101, 100) * x - v / 5),
               {"x": 1.0, "v": -0.1}, -20.0),
        "taylor", 1e-9,
        {"x": sp.exp(-_t / 10) * sp.cos(_t), "v": -sp.exp(-_t / 10) * (sp.cos(_t) / 10 + sp.sin(_t))},
    ),
    Trial(
        _given("Resonance", _OWN, lambda x, v: (v, -x + sp.cos(_t)), {"x": 0.0, "v": 0.0}, 50.0),
        "DOP853", 1e-9,
        {"x": _t * sp.sin(_t) / 2, "v": (sp.sin(_t) + _t * sp.cos(_t)) / 2},
    ),
    Trial(
        _given("Saddle", _OWN, lambda x, v: (v, x), {"x": 1.0, "v": -1.0}, 15.0),
        "taylor", 1e-9, {"x": sp.exp(-_t), "v": -sp.exp(-_t)},
    ),
    Trial(
        _given("Prothero and Robinson", _STIFF + "sect. IV.15",
               lambda x: (-10000 * (x - sp.cos(_t)) - sp.sin(_t),), {"x": 1.0}, 10.0, stiff=True),
        "scipy:Radau", 1e-6, {"x": sp.cos(_t)},
    ),
    Trial(
        _given("Two scales", _OWN, lambda x, v, y, w: (v, -x, w, -900 * y),
               {"x": 1.0, "v": 0.0, "y": 1e-6, "w": 0.0}, 20.0),
        "DOP853", 1e-6,
        {"x": sp.cos(_t), "v": -sp.sin(_t), "y": sp.Float("1e-6") * sp.cos(30 * _t),
         "w": -30 * sp.Float("1e-6") * sp.sin(30 * _t)},
    ),
    Trial(
        _given("Logistic", _OWN, lambda x: (x * (1 - x),), {"x": 0.125}, 10.0),
        "DP5", 1e-6, {"x": 1 / (1 + 7 * sp.exp(-_t))},
    ),
    Trial(
        _given("Tangent", _OWN, lambda x: (1 + x**2,), {"x": 0.0}, 1.5),
        "DOP853", 1e-9, {"x": sp.tan(_t)},
    ),
    Trial(_known("forced-rigid-body"), "DP5", 1e-9),
    Trial(_known("free-body-attitude", end=100.0), "auto", 1e-9),
    Trial(
        _given("Kepler 0.6", _HAIRER + "sect. II.17", _kepler, _from_periapsis(0.6), 6 * pi),
        "scipy:DOP853", 1e-9,
    ),
    Trial(
        _given("Kepler 0.99", _HAIRER + "sect. II.17", _kepler, _from_periapsis(0.99), 4 * pi),
        "taylor", 1e-9,
    ),
    Trial(
        _given("Pendulum near its separatrix", "derived", lambda q, w: (w, -sp.sin(q)),
               {"q": 0.0, "w": 2 - 1e-6}, 30.0),
        "auto", 1e-9,
    ),
    Trial(_known("t-handle"), "taylor", 1e-12),
    Trial(_known("heavy-top-quaternion", end=10.0), "rkmk", 1e-9),
    Trial(_known("heavy-top-quaternion", end=5.0), "splitting", 1e-6),
    Trial(_known("damped-body"), "taylor", 1e-12),
    Trial(
        _given("Van der Pol", _HAIRER + "sect. I.16",
               lambda x, v: (v, (1 - x**2) * v - x), {"x": 2.0, "v": 0.0}, 20.0),
        "taylor", 1e-6,
    ),
    Trial(
        _given("Stiff Van der Pol", _STIFF + "sect. IV.10",
               lambda x, v: (v, 100 * (1 - x**2) * v - x), {"x": 2.0, "v": 0.0}, 2.0, stiff=True),
        "scipy:LSODA", 1e-6,
    ),
    Trial(
        _given("Robertson", _STIFF + "sect. IV.1",
               lambda x, y, z: (
                   -x / 25 + 10**4 * y * z,
                   x / 25 - 10**4 * y * z - 3 * 10**7 * y**2,
                   3 * 10**7 * y**2,
               ),
               {"x": 1.0, "y": 0.0, "z": 0.0}, 1.0, stiff=True),
        "scipy:Radau", 1e-6,
    ),
    Trial(
        _given("Brusselator", _HAIRER + "sect. I.16",
               lambda x, y: (1 + x**2 * y - 4 * x, 3 * x - x**2 * y), {"x": 1.5, "y": 3.0}, 20.0),
        "DOP853", 1e-6,
    ),
    Trial(
        _given("Arenstorf", _HAIRER + "sect. II.0", _arenstorf,
               {"x": 0.994, "y": 0.0, "u": 0.0, "v": -2.00158510637908252240537862224},
               17.0652165601579625588917206249),
        "DOP853", 1e-9,
    ),
    Trial(
        _given("Pleiades", _HAIRER + "sect. II.10", _pleiades, _SEVEN, 3.0), "taylor", 1e-9
    ),
    Trial(
        _given("Henon and Heiles", "Henon, Heiles, Astron. J. 69 (1964) 73", _henon,
               {"x": 0.0, "y": 0.1, "u": 0.5, "v": 0.0}, 50.0),
        "DP5", 1e-6,
    ),
    Trial(
        _given("Lorenz", _HAIRER + "sect. I.16", _lorenz, {"x": 1.0, "y": 1.0, "z": 1.0}, 20.0),
        "auto", 1e-9,
    ),
    Trial(
        _given("Lorenz beyond its horizon", _HAIRER + "sect. I.16", _lorenz,
               {"x": 1.0, "y": 1.0, "z": 1.0}, 40.0),
        "DOP853", 1e-6,
    ),
    Trial(
        _given("Duffing", "Guckenheimer, Holmes, Nonlinear Oscillations (1983), sect. 2.2",
               lambda x, v: (v, x - x**3 - v / 4 + 3 * sp.cos(_t) / 10), {"x": 1.0, "v": 0.0}, 30.0),
        "scipy:LSODA", 1e-9,
    ),
    Trial(
        _known("double-pendulum", {"q_shoulder": 2.0, "q_elbow": 2.5}, 20.0), "auto", 1e-9
    ),
    Trial(
        _known("damped-body-stiff", end=1e-4), "auto", 1e-9
    ),
)  # fmt: skip


def names() -> tuple[str, ...]:
    """Return the names of the trials: problem, method and tolerance."""
    return tuple(f"{t.problem.name}, {t.method} at {t.rtol:.0e}" for t in TRIALS)
