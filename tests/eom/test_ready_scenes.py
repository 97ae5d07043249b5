"""Ready scenes against Lagrange's equations by SymPy, written from positions alone, and published values.

Each system is taken whole from its scene and evaluated at random states: no state is special.
"""

import random

import pytest
import sympy as sp
from sympy.physics import mechanics as me

import eom
from eom.mass import solids

t = me.dynamicsymbols._t


def accelerations(q, kinetic, potential, forces=None):
    """Return the second rates of the coordinates ``q``, functions of time, from Lagrange's equations."""
    forces = forces or [0] * len(q)
    L = kinetic - potential
    rows = [L.diff(x.diff(t)).diff(t) - L.diff(x) - f for x, f in zip(q, forces, strict=True)]
    seconds = [x.diff(t, 2) for x in q]
    A, b = sp.linear_eq_to_matrix(rows, seconds)
    return A, b


def at_random(q, rows, values, seed):
    """Return coordinates, speeds and the second rates there, which solve ``rows``, in 30 digits."""
    draw = random.Random(seed)
    A, b = rows
    here = {x: sp.Float(draw.uniform(-0.7, 0.7), 30) for x in q}
    speeds = {x.diff(t): sp.Float(draw.uniform(-2, 2), 30) for x in q}
    numbers = {s: sp.Float(values[s.name], 30) for s in (A.free_symbols | b.free_symbols) - {t}}
    A, b = (m.subs(speeds).subs(here).subs(numbers) for m in (A, b))
    return list(here.values()), list(speeds.values()), list(A.LUsolve(b))


def rates(scene, states):
    """Return the rates of a scene's whole system by name of the state, at states by name."""
    system = scene.full_system
    numbers = {**scene.parameter_values(), **scene.numbers, **states}
    known = {q.symbol: sp.Float(numbers[q.name], 30) for q in (*system.states, *system.parameters)}
    return {
        q.name: float(system.expand(r).xreplace(known).evalf(30))
        for q, r in zip(system.states, system.rates, strict=True)
    }


def moved(place):
    """Return the velocity of a place."""
    return place.diff(t)


def test_the_wheel_held_by_one_end_is_that_of_lagrange():
    """Kinetic energy by the velocity of the centre of mass and the central inertia: Steiner follows."""
    scene = eom.load_scene("bicycle-wheel")
    psi, theta, phi = q = me.dynamicsymbols("psi theta phi")
    m, l, g, I1, I2 = sp.symbols("m l g I1 I2")
    axle = sp.Matrix([-sp.sin(psi) * sp.cos(theta), sp.cos(psi) * sp.cos(theta), sp.sin(theta)])
    spin = phi.diff(t) + psi.diff(t) * sp.sin(theta)
    across = theta.diff(t) ** 2 + (psi.diff(t) * sp.cos(theta)) ** 2
    v = moved(l * axle)
    kinetic = m * v.dot(v) / 2 + I1 * across / 2 + I2 * spin**2 / 2
    sizes = scene.body.size
    central = solids.principal_moments("torus")
    of = {
        s: {**sizes, "mass": 1.4}[s.name] for s in set().union(*(c.free_symbols for c in central))
    }
    values = {
        "m": 1.4,
        "l": 0.18,
        "g": 9.81,
        "I1": float(central[0].subs(of)),
        "I2": float(central[2].subs(of)),
    }
    assert scene.parameter_values()["I1"] == pytest.approx(values["I1"] + 1.4 * 0.18**2, rel=1e-14)
    found = at_random(q, accelerations(q, kinetic, m * g * l * axle[2]), values, 1)
    (ps, th, ph), (dps, dth, dph), (ddps, ddth, _) = found
    spun = dph + dps * sp.sin(th)
    here = {"psi": ps, "theta": th, "phi": ph, "psi_dot": dps, "theta_dot": dth, "C": spun}
    rate = rates(scene, here)
    assert rate["theta_dot"] == pytest.approx(float(ddth), rel=1e-12)
    assert rate["psi_dot"] == pytest.approx(float(ddps), rel=1e-12)
    assert rate["C"] == 0
    system = scene.full_system
    assert {"E", "H_3", "h_2"} <= set(system.invariant_names)
    assert "fixed_point" in {a.name for a in system.assumptions}


def test_the_slider_crank_is_that_of_lagrange():
    """One coordinate, the rest put in: position of the piston and angle of the rod are functions of it."""
    scene = eom.load_scene("slider-crank")
    (crank,) = q = [me.dynamicsymbols("q_crank")]
    r, l, m2, m3, J, g = sp.symbols("r l m2 m3 J g")
    rod = -sp.asin(r * sp.sin(crank) / l)  # from the line of the piston
    piston = r * sp.cos(crank) + l * sp.cos(rod)
    middle = sp.Matrix([r * sp.cos(crank) + l * sp.cos(rod) / 2, r * sp.sin(crank) / 2])
    v = moved(middle)
    kinetic = J * crank.diff(t) ** 2 / 2 + m2 * v.dot(v) / 2
    kinetic += m2 * l**2 * rod.diff(t) ** 2 / 24 + m3 * piston.diff(t) ** 2 / 2
    rows = accelerations(q, kinetic, m2 * g * middle[1])
    (a,), (da,), (dda,) = at_random(q, rows, scene.numbers, 2)
    at = {crank.diff(t): da, crank: a, r: 0.2, l: 0.6}
    b, x = (e.subs({crank: a, r: 0.2, l: 0.6}) for e in (rod, piston))
    db, dx = (e.diff(t).subs(at) for e in (rod, piston))
    here = {
        "q_crank": a,
        "q_pin": b - a,
        "q_piston": x,
        "u_crank": da,
        "u_pin": db - da,
        "u_piston": dx,
    }
    rate = rates(scene, {n: float(e) for n, e in here.items()})
    assert rate["u_crank"] == pytest.approx(float(dda), rel=1e-12)
