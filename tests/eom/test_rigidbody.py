"""Euler's equations and the ready bodies against sympy.physics.mechanics and published formulas."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp
from sympy.physics import mechanics as me

import eom
from eom.exact.identity import equal
from eom.kinematics.coordinates import attitude
from eom.kinematics.frames import vector
from eom.mechanics import rigidbody, torques
from eom.mechanics.rigidbody import euler_equations, full_inertia, is_invariant, principal_inertia
from eom.scenes import reduce
from tests.eom.rows import every

w = sp.symbols("omega_1:4", real=True)
wd = sp.symbols("wd_1:4", real=True)
tau = sp.symbols("tau_1:4", real=True)
I1, I2, I3 = sp.symbols("I1:4", positive=True)


def mechanics_balance(J):
    """d(J omega)/dt - tau in a body frame, by sympy.physics.mechanics; over plain symbols."""
    t = me.dynamicsymbols._t
    u = me.dynamicsymbols("u1:4")
    q = me.dynamicsymbols("q1:4")
    N, B = me.ReferenceFrame("N"), me.ReferenceFrame("B")
    B.orient_body_fixed(N, q, "123")
    B.set_ang_vel(N, sum((x * e for x, e in zip(u, B, strict=True)), me.Vector(0)))
    point = me.Point("G")
    point.set_vel(N, 0)
    dyadic = me.inertia(B, J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[1, 2], J[0, 2])
    body = me.RigidBody("body", point, B, sp.Integer(1), (dyadic, point))
    rate = body.angular_momentum(point, N).dt(N).to_matrix(B)
    plain = {x.diff(t): d for x, d in zip(u, wd, strict=True)}
    return (rate.subs(plain).subs(dict(zip(u, w, strict=True)))) - sp.Matrix(tau)


@pytest.mark.parametrize("inertia", [principal_inertia, full_inertia])
def test_euler_equations_are_those_of_sympy_mechanics(inertia):
    J, _ = inertia()
    mass, rates = euler_equations(J, vector("B", tau))
    expected = mechanics_balance(J)
    left = sp.diag(*wd) * sp.ones(3, 1) if mass is None else mass * sp.Matrix(wd)
    scale = sp.diag(*J.diagonal()) if mass is None else sp.eye(3)
    assert equal(sp.Matrix(scale * (left - sp.Matrix(rates))), expected)
    assert (mass is None) == (inertia is principal_inertia)


def test_full_inertia_equations_against_kane_s_method_in_rational_numbers():
    """Accelerations of KanesMethod and of the mass matrix, at rational points."""
    J, _ = full_inertia()
    t = me.dynamicsymbols._t
    q, u = me.dynamicsymbols("q1:4"), me.dynamicsymbols("u1:4")
    N, B = me.ReferenceFrame("N"), me.ReferenceFrame("B")
    B.orient_body_fixed(N, q, "313")
    kinematics = [a - b for a, b in zip(u, B.ang_vel_in(N).to_matrix(B), strict=True)]
    B.set_ang_vel(N, sum((x * e for x, e in zip(u, B, strict=True)), me.Vector(0)))
    point = me.Point("G")
    point.set_vel(N, 0)
    dyadic = me.inertia(B, J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[1, 2], J[0, 2])
    body = me.RigidBody("body", point, B, sp.Integer(1), (dyadic, point))
    load = (B, sum((x * e for x, e in zip(tau, B, strict=True)), me.Vector(0)))
    kane = me.KanesMethod(N, q, u, kinematics)
    plain = dict(zip(u, w, strict=True))
    numbers = {s: sp.Rational(k + 2, 7) for k, s in enumerate((*w, *tau))}
    values = [5, sp.Rational(1, 3), sp.Rational(-2, 7), 6, sp.Rational(1, 5), 7]
    names = [J[0, 0], J[0, 1], J[0, 2], J[1, 1], J[1, 2], J[2, 2]]
    numbers |= dict(zip(names, values, strict=True))
    # Kane's rows are linear in the accelerations; read off their matrix and right-hand side.
    fr, frstar = kane.kanes_equations([body], [load])
    rows = (fr + frstar).subs({x.diff(t): d for x, d in zip(u, wd, strict=True)}).subs(plain)
    expected = sp.solve(list(rows.subs(numbers)), wd, dict=True)[0]
    mass, rates = euler_equations(J, vector("B", tau))
    found = mass.subs(numbers).LUsolve(sp.Matrix(rates).subs(numbers))
    for a, b in zip(found, wd, strict=True):
        assert a.is_Rational
        assert a == expected[b]


def test_euler_equations_as_printed_in_the_lecture():
    """Lecture 001: I1 w1' + (I3 - I2) w2 w3 = M1, and cyclic."""
    J, _ = principal_inertia()
    _, rates = euler_equations(J, vector("B", tau))
    assert equal(I1 * rates[0] + (I3 - I2) * w[1] * w[2], tau[0])
    assert equal(I2 * rates[1] + (I1 - I3) * w[0] * w[2], tau[1])
    assert equal(I3 * rates[2] + (I2 - I1) * w[0] * w[1], tau[2])


def test_momentum_rate_terms_are_named_right():
    J, _ = full_inertia()
    rate = rigidbody.momentum_rate(J, vector("B", w), wd)
    h = sp.Matrix(J) * sp.Matrix(w)
    assert equal(sp.Matrix(rate.local.components), sp.Matrix(J) * sp.Matrix(wd))
    assert equal(sp.Matrix(rate.rotation.components), sp.Matrix(w).cross(h))


def test_full_inertia_is_symmetric_with_positive_diagonal():
    J, quantities = full_inertia()
    assert sp.Matrix(J) == sp.Matrix(J).T
    assert [q.name for q in quantities] == ["J11", "J12", "J13", "J22", "J23", "J33"]
    assert [bool(q.symbol.is_positive) for q in quantities] == [
        True,
        False,
        False,
        True,
        False,
        True,
    ]


def numbers_of(system, values):
    return {q.symbol: values[q.name] for q in system.parameters}


def trajectory(system, values, start, t_end, points=40):
    """Integrate by SciPy with functions that SymPy prints, not the project's own code."""
    states = [q.symbol for q in system.states]
    rates = [system.expand(r).subs(numbers_of(system, values)) for r in system.rates]
    function = sp.lambdify([states], rates, "math")
    grid = np.linspace(0, t_end, points)
    run = solve_ivp(
        lambda t, x: function(x), (0, t_end), start, "DOP853", grid, rtol=1e-12, atol=1e-14
    )
    assert run.success
    return states, run.y


def spread(system, values, states, history, expression):
    """Relative change of an expression along a trajectory."""
    full = system.expand(expression).subs(numbers_of(system, values))
    f = sp.lambdify([states], full, "math")
    samples = np.array([f(x) for x in history.T])
    return np.ptp(samples) / max(1e-300, np.abs(samples).max())


CASES = {
    "free": (
        eom.free_rigid_body,
        {"attitude": "3-2-1"},
        {"I1": 1.0, "I2": 2.0, "I3": 2.5},
        [0.3, 1.0, 0.2, 0.1, 0.2, 0.3],
        3.0,
        {"T", "H", "H_1", "H_2", "H_3"},
    ),
    "heavy top": (
        eom.heavy_top,
        {"attitude": "quaternion"},
        {"I1": 1.0, "I2": 1.3, "I3": 0.9, "m": 2.0, "g": 9.81, "r3": 0.2},
        [0.3, 1.0, 4.2, 0.8, 0.6, 0.0, 0.0],
        3.0,
        {"E", "H_3", "q_norm"},
    ),
    "satellite": (
        eom.gravity_gradient_satellite,
        {"attitude": "3-2-1"},
        {"I1": 7.0, "I2": 10.0, "I3": 12.0, "n": 0.9},
        [0.1, 0.2, 0.9, 0.1, 0.2, 0.3],
        4.0,
        {"E"},
    ),
}


@pytest.mark.parametrize("name", every(3, CASES))
def test_declared_constants_are_constant_along_the_motion(name):
    build, options, values, start, t_end, expected = CASES[name]
    system = build(**options)
    assert set(system.invariant_names) == expected
    states, history = trajectory(system, values, start, t_end)
    assert np.ptp(history, axis=1).min() > 1e-3 or name == "satellite"
    for definition in system.invariants:
        assert spread(system, values, states, history, definition.expression) < 1e-10


def test_undeclared_outputs_do_change():
    """Kinetic energy and |h| of the heavy top, inertial momentum of the satellite."""
    for name, moving in (("heavy top", ["T", "H", "H_1"]), ("satellite", ["T", "H", "H_3"])):
        build, options, values, start, t_end, _ = CASES[name]
        system = build(**options)
        states, history = trajectory(system, values, start, t_end)
        outputs = {d.name: d.expression for d in system.outputs}
        for output in moving:
            assert spread(system, values, states, history, outputs[output]) > 1e-3


@pytest.mark.parametrize("name", ["quaternion", "dcm", "3-1-3", "1-2-3"])
def test_free_body_in_every_kind_of_attitude_keeps_momentum_in_space(name):
    system = eom.free_rigid_body(name)
    assert {"T", "H"} <= set(system.invariant_names)
    by_name = {d.name: d.expression for d in system.outputs}
    for k in (1, 2, 3):
        assert is_invariant(system, by_name[f"H_{k}"])


def test_free_symmetric_body_precesses_at_the_published_rate():
    """Hughes (1986) sect. 4.3: omega_1, omega_2 turn at (I3 - I1)/I1 * omega_3 in the body."""
    system = eom.free_rigid_body()
    a, c, spin, b = 2.0, 3.0, 1.7, 0.4
    states, history = trajectory(system, {"I1": a, "I2": a, "I3": c}, [b, 0.0, spin], 5.0)
    t = np.linspace(0, 5.0, history.shape[1])
    rate = (c - a) / a * spin
    assert np.allclose(
        history, [b * np.cos(rate * t), b * np.sin(rate * t), spin + 0 * t], atol=1e-10
    )
    assert [s.name for s in states] == ["omega_1", "omega_2", "omega_3"]


def test_symmetric_heavy_top_keeps_its_spin():
    """Goldstein, Poole, Safko (2002) sect. 5.7: p_psi = I3 omega_3 is constant if I1 = I2."""
    system = eom.heavy_top("3-1-3")
    symmetric = reduce.substitute(system, {I2: I1})
    assert is_invariant(symmetric, w[2])
    assert not is_invariant(system, w[2])


def test_heavy_top_equations_are_lagrange_s():
    """Goldstein, Poole, Safko (2002), sect. 5.7: T and V of the symmetric top in Euler's angles."""
    t = me.dynamicsymbols._t
    phi, theta, psi = me.dynamicsymbols("phi theta psi")
    m, g, r3 = sp.symbols("m g r3", positive=True)
    T = (
        I1 / 2 * (theta.diff(t) ** 2 + phi.diff(t) ** 2 * sp.sin(theta) ** 2)
        + I3 / 2 * (psi.diff(t) + phi.diff(t) * sp.cos(theta)) ** 2
    )
    V = m * g * r3 * sp.cos(theta)
    method = me.LagrangesMethod(T - V, [phi, theta, psi])
    residuals = method.form_lagranges_equations()
    system = reduce.substitute(eom.heavy_top("3-1-3"), {I2: I1})
    # Goldstein's phi, theta, psi are the first, second and third angle of 3-1-3.
    first, second, third = sp.symbols("psi theta phi", real=True)
    rates = {q.symbol: system.expand(r) for q, r in zip(system.states, system.rates, strict=True)}
    real_r3 = sp.Symbol("r3", real=True)
    plain = {phi: first, theta: second, psi: third, r3: real_r3}
    for old, new in ((phi, first), (theta, second), (psi, third)):
        velocity = rates[new]
        acceleration = sum(velocity.diff(s) * r for s, r in rates.items())
        residuals = residuals.subs(old.diff(t, 2), acceleration).subs(old.diff(t), velocity)
    assert all(equal(r.subs(plain), sp.Integer(0)) for r in residuals)


def test_satellite_at_rest_in_the_orbit_frame_is_an_equilibrium():
    """Hughes (1986) ch. 9: principal axes along the orbit frame, turning with it."""
    system = eom.gravity_gradient_satellite("3-2-1")
    n = sp.Symbol("n", positive=True)
    still = {**dict(zip(w, (0, 0, n), strict=True))} | dict.fromkeys(
        sp.symbols("psi theta phi", real=True), 0
    )
    assert all(system.expand(r).subs(still) == 0 for r in system.rates)


def test_pitch_libration_frequency_is_the_published_one():
    """Hughes (1986) sect. 9.1: about the orbit normal, psi'' = -3 n^2 (I2 - I1)/I3 psi."""
    system = eom.gravity_gradient_satellite("3-2-1")
    psi = sp.Symbol("psi", real=True)
    n = sp.Symbol("n", positive=True)
    angles = sp.symbols("psi theta phi", real=True)
    still = {**dict(zip(w, (0, 0, n), strict=True)), angles[1]: 0, angles[2]: 0}
    slope = system.expand(system.rates[2]).subs(still).diff(psi).subs(psi, 0)
    assert sp.simplify(slope + 3 * n**2 * (I2 - I1) / I3) == 0


def test_energy_of_the_satellite_is_jacobi_s_integral():
    """Kinetic energy relative to the orbit frame, plus the two effective potentials.

    Hughes (1986) sect. 9.1, up to a constant: 1/2 wr.J wr - n^2/2 a3.J a3 + 3 n^2/2 a1.J a1.
    """
    chosen = attitude("quaternion")
    system = eom.gravity_gradient_satellite("quaternion")
    J, _ = principal_inertia()
    n = sp.Symbol("n", positive=True)
    C = sp.Matrix(chosen.matrix)
    a1, a3 = C[:, 0], C[:, 2]
    relative = sp.Matrix(w) - n * a3
    q = sp.Matrix([s.symbol for s in chosen.coordinates])
    expected = (
        (relative.T * J * relative)[0] / 2
        - n**2 / 2 * (a3.T * J * a3)[0]
        + 3 * n**2 / 2 * (a1.T * J * a1)[0]
    )
    energy = next(d.expression for d in system.invariants if d.name == "E")
    difference = sp.expand(system.expand(energy) - expected)
    numerator = sp.rem(difference, q.dot(q) - 1, q[0])
    assert sp.expand(numerator).free_symbols <= {I1, I2, I3, n}


@pytest.mark.parametrize("attitude_name", ["quaternion", "3-2-1", "dcm"])
def test_body_with_full_inertia_and_attitude_has_a_block_mass_matrix(attitude_name):
    system = eom.rigid_body(
        full_inertia(), lambda C, J: torques.applied((0, 0, 0)), attitude(attitude_name)
    )
    n = len(system.states)
    assert system.mass_matrix.shape == (n, n)
    assert sp.Matrix(system.mass_matrix[3:, 3:]) == sp.eye(n - 3)
    assert system.mass_matrix[:3, 3:] == sp.zeros(3, n - 3)
    assert {"T", "H", "H_1", "H_2", "H_3"} <= set(system.invariant_names)


def test_principal_body_assumes_principal_axes_and_full_body_does_not():
    def law(C, J):
        return torques.applied((0, 0, 0))

    principal = eom.rigid_body(principal_inertia(), law)
    full = eom.rigid_body(full_inertia(), law)
    assert "principal_axes" in {a.name for a in principal.assumptions}
    assert "principal_axes" not in {a.name for a in full.assumptions}
    (axes,) = [a for a in principal.assumptions if a.name == "principal_axes"]
    assert [str(s) for s in axes.vanish] == ["J12", "J13", "J23"]


def test_outputs_of_the_free_body_are_the_printed_ones():
    """Lecture 000: T = 1/2 omega.J omega, H^2 = sum (I_k omega_k)^2."""
    outputs = {d.name: d.expression for d in eom.free_rigid_body().outputs}
    moments = (I1, I2, I3)
    assert equal(2 * outputs["T"], sum(i * x**2 for i, x in zip(moments, w, strict=True)))
    assert equal(outputs["H"] ** 2, sum(i**2 * x**2 for i, x in zip(moments, w, strict=True)))


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-3, 0.7, 2.0, 3.1, 3.141592653589793])
def test_tilt_is_the_angle_of_the_third_axes(angle):
    """It is accurate near zero as well, where the arc cosine is not."""
    outputs = {d.name: d.expression for d in eom.free_rigid_body("3-1-3").outputs}
    psi, theta, phi = sp.symbols("psi theta phi", real=True)
    tilt = sp.lambdify([psi, theta, phi], outputs["tilt"], "math")
    assert tilt(0.4, angle, -1.3) == pytest.approx(angle, rel=1e-9, abs=1e-15)
