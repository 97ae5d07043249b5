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
    """Return the rates of a scene's whole system by name of the state, at states by name, in 30 digits."""
    system = scene.full_system
    numbers = {**scene.numbers, **scene.parameter_values(), **states}
    given = (*system.states, *system.parameters, *system.inputs)
    known = {q.symbol: sp.Float(numbers[q.name], 30) for q in given}
    for d in system.definitions:
        known[d.symbol] = sp.sympify(d.expression).xreplace(known).evalf(30)
    found = (sp.sympify(r).xreplace(known).evalf(30) for r in system.rates)
    return {q.name: float(x) for q, x in zip(system.states, found, strict=True)}


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


def test_the_rolling_ellipsoid_obeys_newton_and_euler():
    """Forces at the lowest point of the ellipsoid, by its support function; all in the body's axes."""
    scene = eom.load_scene("rolling-ellipsoid")
    k, draw = scene.numbers, random.Random(3)
    m, r, h, g = (sp.Float(k[n], 30) for n in ("m", "r", "h", "g"))
    omega = sp.Matrix([sp.Float(draw.uniform(-9, 9), 30) for _ in range(3)])
    e = sp.Matrix([sp.Float(draw.uniform(-1, 1), 30) for _ in range(4)]).normalized()
    nu = sp.Matrix(sp.symbols("nu1:4"))  # the upward normal in the body's axes
    support = sp.sqrt(r**2 * (nu[0] ** 2 + nu[1] ** 2) + h**2 * nu[2] ** 2)
    arm = -sp.Matrix([support.diff(x) for x in nu])
    up = [
        2 * (e[1] * e[3] - e[0] * e[2]),
        2 * (e[2] * e[3] + e[0] * e[1]),
        1 - 2 * (e[1] ** 2 + e[2] ** 2),
    ]
    n = sp.Matrix(up)
    at = dict(zip(nu, n, strict=True))
    rho, slope = arm.subs(at), arm.jacobian(nu).subs(at)
    inertia = sp.diag(*[m * (r**2 + h**2) / 5] * 2, 2 * m * r**2 / 5)
    alpha, drift = sp.Matrix(sp.symbols("alpha1:4")), slope * (-omega.cross(n))
    inertial = drift + omega.cross(rho)  # the rate of the arm as seen from the ground
    force = m * (-alpha.cross(rho) - omega.cross(inertial) + g * n)
    rows = inertia * alpha + omega.cross(inertia * omega) - rho.cross(force)
    found = sp.solve(list(rows), list(alpha))
    here = {f"w_egg_{i + 1}": omega[i] for i in range(3)} | {f"e_egg_{i}": e[i] for i in range(4)}
    rate = rates(scene, {**here, "x_egg": 0, "y_egg": 0, "z_egg": support.subs(at)})
    for i in range(3):
        assert rate[f"w_egg_{i + 1}"] == pytest.approx(float(found[alpha[i]]), rel=1e-12)


@pytest.mark.parametrize("half", ["r", 0])
def test_an_ellipsoid_becomes_a_ball_or_a_wheel(half):
    """With a half axis of its radius it rolls as a ball does, with none as a thin disc."""
    data = eom.load_scene("rolling-ellipsoid").model_dump(exclude_unset=True)
    body = {"mass": "m", "moments": ["m*r^2/4", "m*r^2/4", "m*r^2/2"]}
    numbers = {n: v for n, v in data["parameters"].items() if n != "h"}
    table = {"kind": "rolling", "body": "egg", "radius": "r"}
    other = {**table, "ball": True} if half else {**table, "axis": "z"}
    both = [
        eom.load_scene("rolling-ellipsoid").__class__(
            **{**data, "bodies": {"egg": body}, "parameters": numbers, "constraints": {"table": c}}
        )
        for c in ({**table, "axis": "z", "half_axis": half}, other)
    ]
    draw = random.Random(4)
    states = {q: draw.uniform(-1, 1) for q in both[0].full_system.state_names}
    one, two = (rates(scene, states) for scene in both)
    assert one == pytest.approx(two, rel=1e-12)


def test_foucaults_pendulum_is_that_of_lagrange_in_inertial_space():
    """The place of the bob is turned with the Earth before it is differentiated."""
    scene = eom.load_scene("foucault-pendulum")
    a, b = q = me.dynamicsymbols("a b")
    lat, n, l, m, g = sp.symbols("lat n l m g")
    local = sp.Matrix([-l * sp.sin(a) * sp.cos(b), l * sp.sin(b), -l * sp.cos(a) * sp.cos(b)])
    turn = sp.Matrix([0, n * sp.cos(lat), n * sp.sin(lat)])
    v = moved(local) + turn.cross(local)
    found = at_random(q, accelerations(q, m * v.dot(v) / 2, m * g * local[2]), scene.numbers, 5)
    names = [f"q_wire_{k}" for k in (1, 2)], [f"u_wire_{k}" for k in (1, 2)]
    here = {
        x: y
        for group, values in zip(names, found, strict=False)
        for x, y in zip(group, values, strict=True)
    }
    rate = rates(scene, here)
    assert [rate[u] for u in names[1]] == pytest.approx([float(x) for x in found[2]], rel=1e-12)
