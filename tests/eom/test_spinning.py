"""The 3-1-2 spinning symmetric body against lecture 001 and against SymPy's mechanics module."""

from __future__ import annotations

import random

import mpmath
import pytest
import sympy as sp
from sympy.physics import mechanics as me

import eom
from eom.exact.identity import equal
from eom.kinematics.frames import vector
from eom.mechanics import spinning
from eom.mechanics.spinning import SpinningSymmetricBody, lecture_torque
from eom.quantities import TIME, Quantity

psi, theta, phi, psi_dot, theta_dot, Omega, C = (
    sp.Symbol(n, real=True) for n in ("psi", "theta", "phi", "psi_dot", "theta_dot", "Omega", "C")
)
psi_ddot, theta_ddot, Omega_dot, M1, M2, M3 = (
    sp.Symbol(n, real=True) for n in ("psi_ddot", "theta_ddot", "Omega_dot", "M1", "M2", "M3")
)
I1, I2 = (sp.Symbol(n, positive=True) for n in ("I1", "I2"))
sin, cos, tan = sp.sin, sp.cos, sp.tan

# Lecture 001, "Spinning Symmetric Rigid Body": (The Setup), (The Dynamics), (The Solution).
EXPECTED_C_BA = sp.Matrix([[1, 0, 0], [0, cos(theta), sin(theta)], [0, -sin(theta), cos(theta)]])
EXPECTED_OMEGA_BI = (theta_dot, psi_dot * sin(theta), psi_dot * cos(theta))
EXPECTED_H_G = (I1 * theta_dot, I2 * (Omega + psi_dot * sin(theta)), I1 * psi_dot * cos(theta))
EXPECTED_ROWS = (
    I1 * psi_dot**2 * sin(theta) * cos(theta)
    + I1 * theta_ddot
    - I2 * psi_dot * (Omega + psi_dot * sin(theta)) * cos(theta),
    I2 * (psi_ddot * sin(theta) + psi_dot * theta_dot * cos(theta)),
    I1 * psi_ddot * cos(theta)
    - 2 * I1 * psi_dot * theta_dot * sin(theta)
    + I2 * theta_dot * (Omega + psi_dot * sin(theta)),
)
EXPECTED_THETA_DDOT = (
    C * I2 * psi_dot * cos(theta) - I1 * psi_dot**2 / 2 * sin(2 * theta) - M1
) / I1
EXPECTED_PSI_DDOT = theta_dot / I1 * (-C * I2 / cos(theta) + 2 * I1 * psi_dot * tan(theta))


def same(left, right):
    """Two independent judges: the random points of the package and SymPy's simplify."""
    return equal(left, right) and sp.simplify(left - right) == 0


@pytest.fixture(scope="module")
def body():
    return lecture_torque()


def general():
    names = [Quantity(m) for m in (M1, M2, M3)]
    return SpinningSymmetricBody((M1, M2, M3), inputs=tuple(names))


def test_rotation_and_angular_velocities_of_the_lecture(body):
    assert sp.Matrix(body.C_BA.matrix) == EXPECTED_C_BA
    assert body.omega_BI.components == EXPECTED_OMEGA_BI
    assert body.omega_CB.components == (0, Omega, 0)
    total = [a + b for a, b in zip(EXPECTED_OMEGA_BI, (0, Omega, 0), strict=True)]
    assert all(same(a, b) for a, b in zip(body.omega_CI.components, total, strict=True))
    assert (body.C_BA.to_frame, body.C_BA.from_frame, body.omega_CI.frame) == ("B", "A", "B")


def test_angular_momentum_of_the_lecture(body):
    assert body.h_G.frame == "B"
    assert all(same(a, b) for a, b in zip(body.h_G.components, EXPECTED_H_G, strict=True))


def test_momentum_rate_rows_one_and_three_are_the_lecture_s(body):
    rows = body.momentum_rate.total.components
    assert same(rows[0], EXPECTED_ROWS[0])
    assert same(rows[2], EXPECTED_ROWS[2])


def test_momentum_rate_row_two_differs_from_the_lecture_by_the_spin_acceleration(body):
    """The lecture holds Omega constant in row 2; its own solution needs the term it leaves out."""
    row = body.momentum_rate.total.components[1]
    assert same(row - EXPECTED_ROWS[1], I2 * Omega_dot)
    assert not equal(row, EXPECTED_ROWS[1])


def test_transport_term_has_no_component_along_the_axle(body):
    assert equal(body.momentum_rate.rotation.components[1], sp.Integer(0))


def test_first_integral_of_the_lecture(body):
    assert same(body.first_integral, Omega + psi_dot * sin(theta))
    assert body.spin_rate == 0


def test_accelerations_are_the_printed_solution(body):
    theta_acceleration, psi_acceleration = body.accelerations
    assert same(theta_acceleration, EXPECTED_THETA_DDOT)
    assert same(psi_acceleration, EXPECTED_PSI_DDOT)


@pytest.mark.parametrize(
    ("mutant", "which"),
    [
        (EXPECTED_THETA_DDOT + 2 * M1 / I1, 0),
        (EXPECTED_THETA_DDOT.subs(sin(2 * theta), sin(theta)), 0),
        (EXPECTED_THETA_DDOT.subs(cos(theta), sin(theta)), 0),
        (EXPECTED_PSI_DDOT.subs(tan(theta), sin(theta)), 1),
        (-EXPECTED_PSI_DDOT, 1),
        (EXPECTED_PSI_DDOT - theta_dot * psi_dot * tan(theta), 1),
    ],
)
def test_mutants_of_the_solution_are_refused(body, mutant, which):
    assert not equal(body.accelerations[which], mutant)


def test_torque_about_the_axle_breaks_the_first_integral():
    body = general()
    assert body.first_integral is None
    assert same(body.spin_rate, M2 / I2)


def test_general_torque_adds_its_components_over_the_inertia(body):
    with_torque = general().accelerations
    free = SpinningSymmetricBody((sp.Integer(0),) * 3).accelerations
    assert same(with_torque[0] - free[0], M1 / I1)
    assert same(with_torque[1] - free[1], M3 / (I1 * cos(theta)))


def test_solution_satisfies_the_momentum_balance_at_every_point():
    """Put the accelerations back into the lecture's rows, with the spin acceleration in row 2."""
    body = general()
    theta_acc, psi_acc = body.accelerations
    spin = Omega + psi_dot * sin(theta)
    Omega_acc = body.spin_rate - psi_acc * sin(theta) - psi_dot * theta_dot * cos(theta)
    back = {theta_ddot: theta_acc, psi_ddot: psi_acc}
    rows = [EXPECTED_ROWS[0], EXPECTED_ROWS[1] + I2 * Omega_acc, EXPECTED_ROWS[2]]
    for row, moment in zip(rows, (M1, M2, M3), strict=True):
        assert equal(row.xreplace(back).xreplace({C: spin}), moment.xreplace({C: spin}))


def lagrange_accelerations():
    """The same body by Lagrange's equations in sympy.physics.mechanics: psi'', theta'', phi''."""
    q = me.dynamicsymbols("q1:4")  # psi, theta, phi
    u = [sp.diff(x, me.dynamicsymbols._t) for x in q]
    N, B = me.ReferenceFrame("N"), me.ReferenceFrame("B")
    A = N.orientnew("A", "Axis", (q[0], N.z))
    B = A.orientnew("B", "Axis", (q[1], A.x))
    D = B.orientnew("D", "Axis", (q[2], B.y))
    point = me.Point("G")
    point.set_vel(N, 0)
    rigid = me.RigidBody("body", point, D, sp.Integer(1), (me.inertia(D, I1, I2, I1), point))
    load = (D, M1 * B.x + M2 * B.y + M3 * B.z)
    lagrangian = me.Lagrangian(N, rigid)
    method = me.LagrangesMethod(lagrangian, q, forcelist=[load], frame=N)
    method.form_lagranges_equations()
    plain = dict(zip([*u, *q], [psi_dot, theta_dot, Omega, psi, theta, phi], strict=True))
    mass = method.mass_matrix.subs(plain)
    forcing = method.forcing.subs(plain)
    return mass, forcing


def test_accelerations_against_lagrange_s_equations_at_forty_digits():
    mass, forcing = lagrange_accelerations()
    body = general()
    theta_acc, psi_acc = body.accelerations
    generator = random.Random(1)
    symbols = (psi, theta, phi, psi_dot, theta_dot, Omega, M1, M2, M3, I1, I2)
    with mpmath.workdps(50):
        for _ in range(5):
            point = {s: sp.Rational(generator.randint(1, 999), 700) for s in symbols}
            spin = (Omega + psi_dot * sin(theta)).subs(point).evalf(50)
            A = mpmath.matrix(mass.subs(point).evalf(50).tolist())
            b = mpmath.matrix(forcing.subs(point).evalf(50).tolist())
            expected = mpmath.lu_solve(A, b)
            found = [e.subs({**point, C: spin}).evalf(50) for e in (psi_acc, theta_acc)]
            for k, value in enumerate(found):
                error = abs(mpmath.mpf(value) - expected[k])
                assert error < mpmath.mpf(10) ** -38 * (1 + abs(expected[k]))


def test_axle_components_are_the_second_row_of_the_rotation(body):
    """By hand: b2 = cos(theta) a2 + sin(theta) a3, and a2 = -sin(psi) i1 + cos(psi) i2."""
    system = body.system()
    outputs = {d.name: d.expression for d in system.outputs}
    assert equal(outputs["axle_1"], -sin(psi) * cos(theta))
    assert equal(outputs["axle_2"], cos(psi) * cos(theta))
    assert equal(outputs["axle_3"], sin(theta))


def test_outputs_are_the_energy_and_momentum_of_the_lecture_s_vectors(body):
    outputs = {d.name: d.expression for d in body.system().outputs}
    spin = {C: Omega + psi_dot * sin(theta)}
    omega = [theta_dot, Omega + psi_dot * sin(theta), psi_dot * cos(theta)]
    kinetic = sp.Rational(1, 2) * sum(w * h for w, h in zip(omega, EXPECTED_H_G, strict=True))
    assert equal(outputs["T"].xreplace(spin), kinetic)
    assert equal(outputs["Omega"].xreplace(spin), Omega)
    assert equal(outputs["E"], outputs["T"] + M1 * theta)
    for k in range(3):
        assert equal(outputs[f"h_{k + 1}"].xreplace(spin), EXPECTED_H_G[k])
    assert equal(outputs["torque_1"], -M1)


def test_constants_of_the_motion_of_the_lecture_s_torque(body):
    """The torque -M1 b1 is horizontal and does work in theta alone: E and H_3 stay, T does not."""
    system = body.system()
    assert set(system.invariant_names) == {"E", "H_3", "h_2"}
    for definition in system.invariants:
        assert sp.simplify(system.rate_of(definition.expression)) == 0
    kinetic = next(d.expression for d in system.outputs if d.name == "T")
    assert sp.simplify(system.rate_of(kinetic)) == sp.simplify(-M1 * theta_dot)


def test_free_body_keeps_its_whole_angular_momentum():
    system = SpinningSymmetricBody((sp.Integer(0),) * 3).system()
    assert {"T", "H", "H_1", "H_2", "H_3"} <= set(system.invariant_names)
    assert "E" not in system.output_names


def test_singular_where_the_axle_is_vertical(body):
    (singularity,) = body.system().singularities
    assert singularity.coordinate == theta
    roots = [a for a in (sp.pi / 2, -sp.pi / 2) if singularity.expression.subs(theta, a) == 0]
    assert len(roots) == 2
    assert all(singularity.expression.subs(theta, a) != 0 for a in (0, 1, sp.pi))


def test_states_units_and_assumptions(body):
    system = body.system()
    assert system.state_names == ("theta", "psi", "phi", "theta_dot", "psi_dot", "C")
    assert [q.unit for q in system.states] == ["rad"] * 3 + ["rad/s"] * 3
    assert system.parameter_names == ("I1", "I2", "M1")
    physical = next(a for a in system.assumptions if a.name == "physical_inertia")
    assert physical.nonnegative == (2 * I1 - I2,)
    symmetric = next(a for a in system.assumptions if a.name == "symmetric")
    assert symmetric.vanish[0].subs(sp.Symbol("I3", positive=True), I1) == 0


SCENE = {"model": "spinner", "body": {"moments": [0.06, 0.12]}}


def rates_of(system):
    return dict(zip(system.state_names, system.rates, strict=True))


@pytest.mark.parametrize("kind", ["parameters", "inputs"])
def test_torque_as_constant_or_input_of_a_scene(kind):
    scene = eom.Scene(**SCENE, torque={"components": ["-M1", 0, 0]}, **{kind: {"M1": 0.5}})
    system = scene.derive()
    assert same(rates_of(system)["theta_dot"], EXPECTED_THETA_DDOT)
    assert same(rates_of(system)["psi_dot"], EXPECTED_PSI_DDOT)
    assert ("M1" in system.input_names) == (kind == "inputs")
    assert ("M1" in system.parameter_names) == (kind == "parameters")


def test_torque_as_a_number_of_a_scene():
    system = eom.Scene(**SCENE, torque={"components": [-0.5, 0, 0]}).derive()
    expected = EXPECTED_THETA_DDOT.subs(M1, sp.Rational(1, 2))
    assert same(rates_of(system)["theta_dot"], expected)


WEIGHT = sp.Mul(*sp.symbols("m g d", real=True))


@pytest.mark.parametrize(
    ("text", "expression"),
    [
        ("-m*g*d*cos(theta)", -WEIGHT * cos(theta)),
        ("-m*g*d*(1 + t)^2", -WEIGHT * (1 + TIME) ** 2),
        ("-m*g*d*Omega/C", -WEIGHT * (C - psi_dot * sin(theta)) / C),
    ],
)
def test_torque_as_an_expression_of_a_scene(text, expression):
    parameters = {"m": 1.2, "g": 9.81, "d": 0.1}
    scene = eom.Scene(**SCENE, torque={"components": [text, 0, 0]}, parameters=parameters)
    expected = EXPECTED_THETA_DDOT.subs(M1, -expression)
    assert equal(rates_of(scene.derive())["theta_dot"], expected)


def test_torque_as_an_expression_of_the_body():
    k = sp.Symbol("k", real=True)
    body = SpinningSymmetricBody((-k * theta_dot, -k * Omega, sp.Integer(0)), (Quantity(k),))
    assert same(body.accelerations[0], EXPECTED_THETA_DDOT.subs(M1, k * theta_dot))
    assert same(body.spin_rate, -k * (C - psi_dot * sin(theta)) / I2)
    assert body.system().parameter_names == ("I1", "I2", "k")


def test_torque_with_unknown_symbols_is_refused():
    body = SpinningSymmetricBody((sp.Symbol("nobody"), sp.Integer(0), sp.Integer(0)))
    with pytest.raises(eom.InputError, match="nobody"):
        body.system()


def test_frames_cannot_be_mixed(body):
    with pytest.raises(eom.InputError, match="components in I"):
        body.C_BA.apply(vector("I", (1, 0, 0)))


def test_scene_and_body_give_the_same_equations(body):
    scene = eom.Scene(**SCENE, torque={"components": ["-M1", 0, 0]}, parameters={"M1": 0.5})
    direct = rates_of(body.system())
    for name, rate in rates_of(scene.derive()).items():
        assert equal(rate, direct[name])
    assert spinning.lecture_torque().system().rates == body.system().rates


@pytest.mark.parametrize("torque", [(1, 0, 0), (sp.Rational(1, 3), 0, 2), (0.5, 0, 0)])
def test_a_torque_may_be_numbers(torque):
    """They may be values with units; where none stands alone, formulas have one dimension."""
    assert SpinningSymmetricBody(torque).system().numbers == "values"
    M = sp.Symbol("M", real=True)
    assert SpinningSymmetricBody((2 * M, 0, 0), (Quantity(M, "N m"),)).system().numbers == "counts"
