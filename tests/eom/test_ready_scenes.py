"""Ready scenes against Lagrange's equations by SymPy, written from positions alone, and published values.

Each system is taken whole from its scene and evaluated at random states: no state is special.
"""

import random
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import sympy as sp
from sympy.physics import mechanics as me

import eom
from eom.mass import solids
from eom.quantities import TIME

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
    found = (r.evalf(30) for r in at(scene, states, system.rates))
    return {q.name: float(x) for q, x in zip(system.states, found, strict=True)}


def at(scene, states, expressions, digits=30):
    """Return expressions of a scene's whole system at states, inputs and time by name."""
    system = scene.full_system
    numbers = {**scene.numbers, **scene.start, **scene.parameter_values(), **states}
    given = (*system.states, *system.parameters, *system.inputs)
    known = {q.symbol: sp.Float(numbers[q.name], digits) for q in given}
    known[TIME] = sp.Float(states.get("t", 0), digits)
    for d in system.definitions:
        known[d.symbol] = sp.sympify(d.expression).xreplace(known).evalf(digits)
    return [sp.sympify(e).xreplace(known).evalf(digits) for e in expressions]


def outputs(scene, states, names):
    """Return outputs and invariants of a scene's whole system at states by name, as numbers."""
    system = scene.full_system
    of = {d.name: d.expression for d in (*system.outputs, *system.invariants)}
    return [float(x) for x in at(scene, states, [of[n] for n in names])]


def slopes(scene, states, names):
    """Return how fast outputs grow in the motion, by differences in 60 digits."""
    system, h = scene.full_system, sp.Float("1e-20", 60)
    moved = dict(zip(system.state_names, at(scene, states, system.rates, 60), strict=True))
    here = {**scene.start, **states}
    of = {d.name: d.expression for d in (*system.outputs, *system.invariants)}
    ends = [
        at(
            scene,
            {
                **states,
                "t": states.get("t", 0) + s * h,
                **{n: sp.Float(here[n], 60) + s * h * v for n, v in moved.items()},
            },
            [of[n] for n in names],
            60,
        )
        for s in (-1, 1)
    ]
    return [float((b - a) / (2 * h)) for a, b in zip(*ends, strict=True)]


def anywhere(scene, seed, size=1.0):
    """Return random states and inputs of a scene by name, its quaternions of norm 1."""
    draw = random.Random(seed)
    system = scene.full_system
    found = {n: draw.uniform(-size, size) for n in (*system.state_names, *system.input_names)}
    for names in scene.attitudes:
        norm = sum(found[n] ** 2 for n in names) ** 0.5
        found |= {n: found[n] / norm for n in names}
    return found


def three(values, name):
    """Return the values of NAME_1 to NAME_3."""
    return np.array([values[f"{name}_{k}"] for k in (1, 2, 3)])


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


# -- a motor, wheels, gyroscopes, propellers --


def test_the_rotary_pendulum_is_that_of_lagrange_and_newton():
    """Two uniform rods; the force of the ground by Newton, from the accelerations of both centres."""
    scene = eom.load_scene("rotary-pendulum")
    arm, pin = q = me.dynamicsymbols("q_arm q_pin")
    r, l, M, m, J, b, c, g, tau = sp.symbols("r l M m J b c g tau")
    out = sp.Matrix([sp.cos(arm), sp.sin(arm), 0])
    side, up = sp.Matrix([-sp.sin(arm), sp.cos(arm), 0]), sp.Matrix([0, 0, 1])
    rod = sp.cos(pin) * up - sp.sin(pin) * side
    centres = r / 2 * out, r * out + l / 2 * rod
    v, turn = moved(centres[1]), arm.diff(t)
    kinetic = (J + M * r**2 / 3) * turn**2 / 2 + m * v.dot(v) / 2
    kinetic += m * l**2 / 24 * moved(rod).dot(moved(rod))
    forces = [tau - b * turn, -c * pin.diff(t)]
    values = {**scene.numbers, "tau": 0.3}
    rows = accelerations(q, kinetic, m * g * centres[1][2], forces)
    x, u, a = at_random(q, rows, values, 6)
    here = dict(zip(("q_arm", "q_pin", "u_arm", "u_pin"), (*x, *u), strict=True)) | {"tau_arm": 0.3}
    rate = rates(scene, here)
    assert [rate["u_arm"], rate["u_pin"]] == pytest.approx([float(e) for e in a], rel=1e-12)
    second = {s.diff(t, 2): e for s, e in zip(q, a, strict=True)}
    first = {s.diff(t): e for s, e in zip(q, u, strict=True)}
    needed = M * centres[0].diff(t, 2) + m * centres[1].diff(t, 2) + (M + m) * g * up
    force = needed.subs(second).subs(first).subs(dict(zip(q, x, strict=True))).subs(values)
    found = outputs(scene, here, ["F_arm_1", "F_arm_2", "F_arm_3"])
    assert found == pytest.approx([float(e) for e in force], rel=1e-12)


def test_the_gyroscope_in_gimbals_is_that_of_lagrange():
    """Rings count: their moments from the printed ones of a torus. Weight does nothing."""
    scene = eom.load_scene("gyroscope-in-gimbals")
    outer, inner, spin = q = me.dynamicsymbols("q_outer q_inner q_axle")
    k = {n: sp.Rational(str(x)) for n, x in scene.numbers.items()}
    along, across = (
        lambda m, R: m * (R**2 + sp.Rational(3, 4) * k["a"] ** 2),
        lambda m, R: m * (4 * R**2 + 5 * k["a"] ** 2) / 8,
    )
    m1, m2, m3 = (sp.Rational(x, 10) for x in (3, 2, 6))
    A, B, B3 = across(m1, k["R"]), across(m2, k["S"]), along(m2, k["S"])
    C, D = m3 * k["r"] ** 2 / 2, m3 * (3 * k["r"] ** 2 + k["h"] ** 2) / 12
    turn, nod, s, c = outer.diff(t), inner.diff(t), sp.sin(inner), sp.cos(inner)
    twice = A * turn**2 + (B + D) * nod**2 + (B * s**2 + (B3 + D) * c**2) * turn**2
    twice += C * (spin.diff(t) + turn * s) ** 2
    x, u, a = at_random(q, accelerations(q, twice / 2, sp.S.Zero), {}, 7)
    names = "outer", "inner", "axle"
    here = {f"q_{n}": y for n, y in zip(names, x, strict=True)}
    rate = rates(scene, here | {f"u_{n}": y for n, y in zip(names, u, strict=True)})
    found = [rate[f"u_{n}"] for n in names]
    assert found == pytest.approx([float(e) for e in a], rel=1e-12)
    assert "energy" in scene.full_system.invariant_names


def test_reaction_wheels_turn_the_hub_as_a_gyrostat():
    """Hughes, Spacecraft Attitude Dynamics (1986), section 6.2: motors on wheels, opposite on the hub."""
    scene = eom.load_scene("reaction-wheels")
    x, k = anywhere(scene, 8), scene.numbers
    J, axes = k["J"], _pyramid(k["beta"])
    spins = np.array([x[f"Omega_wheel{i}"] for i in (1, 2, 3, 4)])
    torques = np.array([x[f"tau_wheel{i}"] for i in (1, 2, 3, 4)])
    omega, hub = three(x, "w_hub"), np.diag([3.5, 4.5, 3.2]).astype(float)
    across, aside = 0.55 * J, k["m"] * k["r"] ** 2  # the wheels, less what spins about their axles
    hub = hub + 4 * (across + aside) * np.eye(3) - (across + aside) * axes.T @ axes
    below = 4 * k["m"] * k["r"] * np.sin(k["beta"]) / k["M"]
    hub = hub + k["M"] * below**2 * np.diag([1, 1, 0])
    h = hub @ omega + J * spins @ axes
    expected = np.linalg.solve(hub, -np.cross(omega, h) - torques @ axes)
    rate = rates(scene, x)
    assert three(rate, "w_hub") == pytest.approx(expected, rel=1e-12)
    assert [rate[f"Omega_wheel{i}"] for i in (1, 2, 3, 4)] == pytest.approx(torques / J, rel=1e-12)
    assert axes.T @ axes == pytest.approx(4 / 3 * np.eye(3), rel=1e-12, abs=1e-12)


def cylinder(m, r, l):
    """Return the principal moments of a solid cylinder, its axis last."""
    return m * (3 * r**2 + l**2) / 12, m * (3 * r**2 + l**2) / 12, m * r**2 / 2


def test_the_dual_spin_satellite_obeys_newton_and_euler():
    """Force and moment on all, the damper along its guide, the rotor on its axle; platform's axes."""
    scene = eom.load_scene("dual-spin-satellite")
    x, k = anywhere(scene, 9), scene.numbers
    w, e, z, m = three(x, "w_platform"), np.array([0, 0, 1.0]), x["q_damper"], k["m"]
    M, N, b, h = k["M"], k["N"], k["b"], k["h"]
    bodies = [(M, [-m * b / M, 0, h], cylinder(M, k["R"], k["L"]), 0, 0),
              (N, [0, 0, -h * (M + m) / N], cylinder(N, k["r"], k["l"]), x["u_axle"], 0),
              (m, [b, 0, h + z], (0, 0, 0), 0, x["u_damper"])]  # fmt: skip

    def needed(unknown):
        """Return force and moment, force on the bob along its guide, torque on the rotor on its axle."""
        a, alpha, (slide, spin) = unknown[:3], unknown[3:6], unknown[6:]
        forces, moments = [], []
        for (mass, r, moment, own, speed), gains in zip(bodies, np.eye(3)[[2, 1, 0]], strict=True):
            here = a + np.cross(alpha, r) + np.cross(w, np.cross(w, r))
            here = here + gains[0] * slide * e + 2 * np.cross(w, speed * e)
            turned = (
                np.array(moment) * (w + own * e),
                np.array(moment) * (alpha + gains[1] * spin * e),
            )
            forces.append(mass * here)
            moments.append(turned[1] + np.cross(w, turned[0]))
        arms = sum(np.cross(r, f) for (_, r, *_), f in zip(bodies, forces, strict=True))
        return np.array([*sum(forces), *(sum(moments) + arms), forces[2][2], moments[1][2]])

    still = needed(np.zeros(8))
    acting = np.array([0] * 6 + [-k["k"] * z - k["c"] * x["u_damper"], x["tau_axle"]])
    columns = np.array([needed(unit) - still for unit in np.eye(8)]).T
    found = np.linalg.solve(columns, acting - still)
    rate = rates(scene, x)
    assert three(rate, "w_platform") == pytest.approx(found[3:6], rel=1e-12)
    assert [rate["u_damper"], rate["u_axle"]] == pytest.approx(found[6:], rel=1e-12)


def test_the_control_moment_gyroscope_is_that_of_schaub_and_junkins():
    """Their equations of hub, gimbal and wheel (Analytical Mechanics of Space Systems, section 4.4).

    Written about the centre of mass of all; wheel and gimbal have their centre on the gimbal's axis.
    """
    scene = eom.load_scene("control-moment-gyroscope")
    x, k = anywhere(scene, 10), scene.numbers
    R, a, r, h = (k[n] for n in "Rarh")
    J_ws, J_wt = 5 * r**2 / 2, 5 * (3 * r**2 + h**2) / 12
    across, along = (4 * R**2 + 5 * a**2) / 8, R**2 + 3 * a**2 / 4
    J_s, J_t, J_g = J_ws + across, J_wt + along, J_wt + across
    gamma, rate_g, spin = x["q_gimbal"], x["u_gimbal"], x["u_axle"]
    g = np.array([0, 0, 1.0])
    s = np.array([np.cos(gamma), np.sin(gamma), 0])
    t_ = np.cross(g, s)
    hub = np.diag([9.0, 11.0, 8.0]) + 60 * 6 / 66 * 0.7**2 * np.diag([1, 1, 0])
    whole = hub + sum(J * np.outer(n, n) for J, n in ((J_s, s), (J_t, t_), (J_g, g)))
    omega = three(x, "w_hub")
    w_s, w_t, w_g = omega @ s, omega @ t_, omega @ g
    right = -np.cross(omega, whole @ omega)
    right = right - s * (J_s * rate_g * w_t - (J_t - J_g) * w_t * rate_g)
    right = right - t_ * (
        (J_s * w_s + J_ws * spin) * rate_g - (J_t + J_g) * w_s * rate_g + J_ws * spin * w_g
    )
    right = right + g * J_ws * spin * w_t
    gimbal = x["tau_gimbal"] + (J_s - J_t) * w_s * w_t + J_ws * spin * w_t
    wheel = x["tau_axle"] - J_ws * rate_g * w_t
    A = np.block([[whole, J_g * g[:, None], J_ws * s[:, None]],
                  [J_g * g, J_g, 0], [J_ws * s, 0, J_ws]])  # fmt: skip
    expected = np.linalg.solve(A, [*right, gimbal, wheel])
    rate = rates(scene, x)
    found = [*three(rate, "w_hub"), rate["u_gimbal"], rate["u_axle"]]
    assert found == pytest.approx(expected, rel=1e-12)


def test_the_quadrotor_obeys_newton_and_euler():
    """Mahony, Kumar and Corke, IEEE Robotics & Automation Magazine 19(3) (2012) 20."""
    scene = eom.load_scene("quadrotor")
    x, k = anywhere(scene, 11), scene.numbers
    thrust, drag = ([x[f"{n}{i}"] for i in (1, 2, 3, 4)] for n in "TQ")
    torque = [k["d"] * (thrust[1] - thrust[3]), k["d"] * (thrust[2] - thrust[0]),
              -drag[0] + drag[1] - drag[2] + drag[3]]  # fmt: skip
    omega, v = three(x, "w_frame"), three(x, "v_frame")
    box, arms = (
        k["M"] / 12 * np.array([k["a"] ** 2 + k["c"] ** 2] * 2 + [2 * k["a"] ** 2]),
        k["m"] * k["d"] ** 2,
    )
    J, m = box + arms * np.array([2, 2, 4]), k["M"] + 4 * k["m"]
    e0, e1, e2, e3 = (x[f"e_frame_{i}"] for i in range(4))
    up = np.array([2 * (e1 * e3 - e0 * e2), 2 * (e2 * e3 + e0 * e1), 1 - 2 * (e1**2 + e2**2)])
    rate = rates(scene, x)
    expected = (torque - np.cross(omega, J * omega)) / J
    assert three(rate, "w_frame") == pytest.approx(expected, rel=1e-12)
    pushed = np.array([0, 0, sum(thrust) / m]) - k["g"] * up - np.cross(omega, v)
    assert three(rate, "v_frame") == pytest.approx(pushed, rel=1e-12)


def test_the_rocket_is_that_of_meshchersky_and_thomson():
    """Force by thrust; rates about the centre of mass by Thomson: the jet damps pitch.

    A w1' + (C - A) w2 w3 + (A' + mu e^2) w1 = 0 and C w3' + C' w3 = 0, with the distance e of the nozzle
    from the centre of mass; Introduction to Space Dynamics (1961).
    """
    scene = eom.load_scene("rocket")
    x, k = anywhere(scene, 14) | {"t": 7.3}, scene.numbers
    M, mu, v, d, t = k["M"], k["mu"], k["v"], k["d"], sp.Symbol("t")
    grain = k["m"] - mu * t
    squares = 2 * k["a"] ** 2 - grain / (
        sp.pi * k["rho"] * k["l"]
    )  # of the radii of the hollow cylinder
    centre = M * k["h"] / (M + grain)
    casing = M * (k["a"] ** 2 + k["b"] ** 2) / 2
    C = casing + grain * squares / 2
    A = casing / 2 + M * k["L"] ** 2 / 12 + grain * (3 * squares + k["l"] ** 2) / 12
    A = A + M * (k["h"] - centre) ** 2 + grain * centre**2
    A, C, dA, dC, m, e, c = (
        float(f.subs(t, x["t"]))
        for f in (A, C, A.diff(t), C.diff(t), M + grain, centre + d, centre)
    )
    w, u = three(x, "w_rocket"), three(x, "v_rocket")
    turned = np.array([
        -(C - A) * w[1] * w[2] - (dA + mu * e**2) * w[0],
        (C - A) * w[0] * w[2] - (dA + mu * e**2) * w[1],
        -dC / C * A * w[2],
    ]) / A  # fmt: skip
    rate = rates(scene, x)
    assert three(rate, "w_rocket") == pytest.approx(turned, rel=1e-12)
    e0, e1, e2, e3 = (x[f"e_rocket_{i}"] for i in range(4))
    up = np.array([2 * (e1 * e3 - e0 * e2), 2 * (e2 * e3 + e0 * e1), 1 - 2 * (e1**2 + e2**2)])
    first = np.array([0, 0, m * c])
    taken = m * np.cross(w, u) + np.cross(turned, first) + np.cross(w, np.cross(w, first))
    taken = taken + 2 * np.cross(w, [0, 0, -mu * d])
    pushed = ([0, 0, mu * v] - taken) / m - k["g"] * up
    assert three(rate, "v_rocket") == pytest.approx(pushed, rel=1e-12)


LEG = Path(__file__).parent / "multibody" / "robots" / "solo12-leg.urdf"


def _links():
    """Return mass, centre, inertia, place and axis of the links of the leg's URDF, in order."""
    root = ElementTree.parse(LEG).getroot()

    def numbers(element, key):
        return np.array([float(x) for x in element.get(key).split()])

    for joint in root.iter("joint"):
        name, axis = joint.find("child").get("link"), joint.find("axis")
        own = next(x for x in root.iter("link") if x.get("name") == name).find("inertial")
        rows = [["xx", "xy", "xz"], ["xy", "yy", "yz"], ["xz", "yz", "zz"]]
        inertia = np.array([[float(own.find("inertia").get(f"i{k}")) for k in row] for row in rows])
        place, centre = numbers(joint.find("origin"), "xyz"), numbers(own.find("origin"), "xyz")
        mass = float(own.find("mass").get("value"))
        yield mass, centre, inertia, place, None if axis is None else numbers(axis, "xyz")


def _torques(q, u, a, g):
    """Return what motors give by Newton and Euler, in the ground's axes, for the links of the URDF."""
    turn, w, dw, place, moved = np.eye(3), *np.zeros((4, 3))
    hinges, taken, k = [], [], 0
    for mass, centre, inertia, origin, axis in _links():
        arm = turn @ origin
        place, moved = place + arm, moved + np.cross(dw, arm) + np.cross(w, np.cross(w, arm))
        if axis is not None:
            z, skew = turn @ axis, np.cross(np.eye(3), axis)
            dw, w = dw + z * a[k] + np.cross(w, z * u[k]), w + z * u[k]
            turn = turn @ (np.eye(3) + np.sin(q[k]) * skew + (1 - np.cos(q[k])) * skew @ skew)
            hinges.append((z, place, len(taken)))
            k += 1
        arm, J = turn @ centre, turn @ inertia @ turn.T
        lifted = moved + np.cross(dw, arm) + np.cross(w, np.cross(w, arm)) + [0, 0, g]
        taken.append((mass * lifted, J @ dw + np.cross(w, J @ w), place + arm))
    return np.array([
        sum(z @ (N + np.cross(x - p, F)) for F, N, x in taken[first:]) for z, p, first in hinges
    ])  # fmt: skip


def test_the_walking_leg_obeys_newton_and_euler_by_its_urdf():
    """Numbers from the file, which is read here by itself."""
    scene = eom.load_scene("walking-leg")
    names = ("HAA", "HFE", "KFE")
    x, n = anywhere(scene, 15) | {"t": 0.3}, scene.numbers
    q, u, tau = ([x[f"{letter}_{name}"] for name in names] for letter in ("q", "u", "tau"))
    wanted = [0, 0.7 + n["A"] * np.sin(0.3 * n["w"]), -1.4 - n["B"] * np.cos(0.3 * n["w"])]
    given = np.array(tau) + n["k"] * (np.array(wanted) - q) - n["d"] * np.array(u)
    still = _torques(q, u, np.zeros(3), n["g"])
    M = np.array([_torques(q, u, unit, n["g"]) - still for unit in np.eye(3)]).T
    rate = rates(scene, x)
    found = [rate[f"u_{name}"] for name in names]
    assert found == pytest.approx(np.linalg.solve(M, given - still), rel=1e-12)


POWERS = {
    "rotary-pendulum": lambda x, k: (
        x["tau_arm"] * x["u_arm"] - k["b"] * x["u_arm"] ** 2 - k["c"] * x["u_pin"] ** 2
    ),
    "reaction-wheels": lambda x, k: sum(
        x[f"tau_wheel{i}"] * (x[f"Omega_wheel{i}"] - axis @ three(x, "w_hub"))
        for i, axis in enumerate(_pyramid(k["beta"]), 1)
    ),
    "dual-spin-satellite": lambda x, k: x["tau_axle"] * x["u_axle"] - k["c"] * x["u_damper"] ** 2,
    "control-moment-gyroscope": lambda x, _: (
        x["tau_gimbal"] * x["u_gimbal"] + x["tau_axle"] * x["u_axle"]
    ),
    "gyroscope-in-gimbals": lambda *_: 0.0,
    "quadrotor": lambda x, k: (
        sum(x[f"T{i}"] for i in range(1, 5)) * x["v_frame_3"]
        + k["d"] * (x["T2"] - x["T4"]) * x["w_frame_1"]
        + k["d"] * (x["T3"] - x["T1"]) * x["w_frame_2"]
        + (x["Q2"] + x["Q4"] - x["Q1"] - x["Q3"]) * x["w_frame_3"]
    ),
}
"""What motors, dampers and air give to each scene (W)."""


def _pyramid(beta):
    c, s = np.cos(beta), np.sin(beta)
    return np.array([[c, 0, s], [0, c, s], [-c, 0, s], [0, -c, s]])


@pytest.mark.parametrize("name", POWERS)
def test_energy_grows_by_what_is_given_to_it(name):
    scene = eom.load_scene(name)
    x = anywhere(scene, 12)
    kinetic, potential = slopes(scene, x, ["kinetic_energy", "potential_energy"])
    given = POWERS[name](x, scene.numbers)
    assert kinetic + potential == pytest.approx(given, rel=1e-12, abs=1e-12 * abs(kinetic))


@pytest.mark.parametrize(
    "name", ["reaction-wheels", "dual-spin-satellite", "control-moment-gyroscope"]
)
def test_momenta_of_what_floats_stay(name):
    """Whatever motors and dampers do inside."""
    scene = eom.load_scene(name)
    names = [f"{letter}_{k}" for letter in "pL" for k in (1, 2, 3)]
    assert set(names) <= set(scene.full_system.invariant_names)
    x = anywhere(scene, 13)
    assert slopes(scene, x, names) == pytest.approx([0] * 6, abs=1e-15)
