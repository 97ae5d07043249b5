"""The gyrostat against Kane's method, lecture 001 and integrated motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp
from sympy.physics import mechanics as me

import eom
from eom import InputError
from eom.exact.identity import equal
from eom.kinematics.coordinates import attitude
from eom.mechanics import gyrostat
from eom.mechanics.rigidbody import full_inertia, is_invariant
from eom.mechanics.spinning import SpinningSymmetricBody
from eom.mechanics.steady import SPIN_RATE, linearised
from eom.quantities import Quantity
from eom.scenes import reduce
from tests.eom.rows import every, only

I1, I2, I3, Js_1, Js_2 = sp.symbols("I1:4 Js_1:3", positive=True)
w = sp.symbols("omega_1:4", real=True)
p = sp.symbols("p_1:4", real=True)
u = sp.symbols("u_1:4", real=True)
OBLIQUE = (sp.Rational(3, 5), sp.Rational(4, 5), 0)
SPACE = (sp.Rational(2, 7), sp.Rational(3, 7), sp.Rational(-6, 7))


def outputs_of(system):
    return {d.name: d.expression for d in system.outputs}


def derivatives(system, numbers):
    """Rates at exact numbers; the mass matrix is solved, not inverted."""
    rates = sp.Matrix([system.expand(r) for r in system.rates]).subs(numbers)
    if system.mass_matrix is None:
        return rates
    return sp.Matrix(system.mass_matrix.subs(numbers)).LUsolve(rates)


# --- the momentum balance of one rotor --------------------------------------------------------


def test_axial_row_of_a_symmetric_rotor_has_no_transport_term():
    axial, rate, *turning = sp.symbols("p p_dot a1:4", real=True)
    found = gyrostat.rotor_momentum_rate(axial, turning, rate)
    assert found.total.components[0] == rate
    assert all(c != 0 for c in found.rotation.components[1:])


# --- Kane's method as the judge ---------------------------------------------------------------


def kane_accelerations(axes, carrier, rotors, numbers):
    """d(omega) and d(Omega) by KanesMethod: carrier and rotors as separate rigid bodies."""
    t = me.dynamicsymbols._t
    q, v = me.dynamicsymbols("q1:4"), me.dynamicsymbols("v1:4")
    n = len(axes)
    turns, speeds = me.dynamicsymbols(f"r1:{n + 1}"), me.dynamicsymbols(f"s1:{n + 1}")
    N, B = me.ReferenceFrame("N"), me.ReferenceFrame("B")
    B.orient_body_fixed(N, q, "313")
    kinematics = [a - b for a, b in zip(v, B.ang_vel_in(N).to_matrix(B), strict=True)]
    kinematics += [s - r.diff(t) for s, r in zip(speeds, turns, strict=True)]
    B.set_ang_vel(N, sum((x * e for x, e in zip(v, B, strict=True)), me.Vector(0)))
    point = me.Point("G")
    point.set_vel(N, 0)
    bodies = [me.RigidBody("carrier", point, B, sp.Integer(1), (me.inertia(B, *carrier), point))]
    loads = []
    for k, (axis, (axial, transverse)) in enumerate(zip(axes, rotors, strict=True)):
        a = sum((x * e for x, e in zip(axis, B, strict=True)), me.Vector(0))
        R = me.ReferenceFrame(f"R{k}")
        R.orient_axis(B, a, turns[k])
        R.set_ang_vel(B, speeds[k] * a)
        # (Js - Jt) a a + Jt 1, with a fixed in the rotor as well
        a_rotor = sum((x * e for x, e in zip(axis, R, strict=True)), me.Vector(0))
        dyadic = (axial - transverse) * me.outer(a_rotor, a_rotor)
        dyadic += me.inertia(R, transverse, transverse, transverse)
        bodies.append(me.RigidBody(f"rotor{k}", point, R, sp.Integer(1), (dyadic, point)))
        loads += [(R, u[k] * a), (B, -u[k] * a)]
    method = me.KanesMethod(N, [*q, *turns], [*v, *speeds], kinematics)
    fr, frstar = method.kanes_equations(bodies, loads)
    slopes = sp.symbols(f"d1:{4 + n}")
    plain = dict(zip([x.diff(t) for x in (*v, *speeds)], slopes, strict=True))
    states = {x: numbers[y] for x, y in zip(v, w, strict=True)}
    states |= {x: numbers[f"Omega_{k}"] for k, x in enumerate(speeds, 1)}
    angles = {**dict.fromkeys(q, 0), **dict.fromkeys(turns, 0)}
    rows = (
        (fr + frstar)
        .subs(plain)
        .subs(states)
        .subs(angles)
        .subs(dict(zip(u, numbers["u"], strict=True)))
    )
    (found,) = sp.linsolve([sp.nsimplify(r) for r in rows], slopes)
    return found


KANE = {
    "one on b2": [(0, 1, 0)],
    "one oblique": [OBLIQUE],
    "two on b1, b3": [(1, 0, 0), (0, 0, 1)],
    "two oblique": [SPACE, OBLIQUE],
}


@pytest.mark.parametrize("name", only(KANE, "one on b2"))
def test_equations_are_those_of_kane_s_method(name):
    axes = KANE[name]
    n = len(axes)
    carrier = (5, 6, 7, sp.Rational(1, 5), sp.Rational(-1, 3), sp.Rational(1, 7))
    rotors = [(sp.Rational(1, 2), sp.Rational(1, 3)), (sp.Rational(2, 3), sp.Rational(2, 5))][:n]
    omega = (sp.Rational(1, 2), sp.Rational(-2, 3), sp.Rational(3, 4))
    Omega = (sp.Rational(7, 3), sp.Rational(-5, 2))[:n]
    torque = (sp.Rational(1, 9), sp.Rational(2, 9), 0)
    a, b, c, d, e, f = carrier
    J = sp.Matrix([[a, d, f], [d, b, e], [f, e, c]])
    momenta = []
    for axis, (axial, across), speed in zip(axes, rotors, Omega, strict=True):
        column = sp.Matrix(axis)
        J += across * sp.eye(3) + (axial - across) * column * column.T
        momenta.append(axial * (column.dot(sp.Matrix(omega)) + speed))
    system = gyrostat.gyrostat(n, axes=axes, inertia=full_inertia())
    entries, _ = full_inertia()
    numbers = {entries[i, j]: J[i, j] for i in range(3) for j in range(3)}
    numbers |= {Js_1: rotors[0][0], Js_2: rotors[-1][0]}
    numbers |= dict(zip(w, omega, strict=True)) | dict(zip(p, (*momenta, 0, 0), strict=False))
    numbers |= dict(zip(u, torque, strict=True))
    found = derivatives(system, numbers)
    relative = [
        found[3 + k] / rotors[k][0] - sp.Matrix(axes[k]).dot(found[:3, 0]) for k in range(n)
    ]
    given_numbers = dict(zip(w, omega, strict=True)) | {"u": torque}
    given_numbers |= {f"Omega_{k}": x for k, x in enumerate(Omega, 1)}
    expected = kane_accelerations(axes, carrier, rotors, given_numbers)
    assert [*found[:3, 0], *relative] == list(expected)
    rate = outputs_of(system)["Omega_1"].subs(numbers)
    assert rate == Omega[0]


def test_lecture_s_spinner_is_one_rotor_in_a_carrier_without_mass():
    """b2 carries the body as rotor: J = diag(I1, I2, I1), Js = I2; rows 1 and 3 are lecture 001's.

    Row 2 of a carrier without inertia is 0 = 0: the lecture turns B at psi' sin(theta) about b2.
    """
    system = gyrostat.gyrostat(1, axes=[(0, 1, 0)], drives="free")
    body = SpinningSymmetricBody((sp.Integer(0),) * 3)
    psi_dot, theta_dot, theta, C = sp.symbols("psi_dot theta_dot theta C", real=True)
    theta_ddot, psi_ddot = body.accelerations
    massless = {I3: I1, Js_1: I2}
    motion = {
        w[0]: theta_dot,
        w[1]: psi_dot * sp.sin(theta),
        w[2]: psi_dot * sp.cos(theta),
        p[0]: I2 * C,
    }
    rows = [system.expand(r) for r in system.rates]
    first, third = (rows[k].subs(massless).subs(motion) for k in (0, 2))
    assert equal(first, theta_ddot)
    assert equal(third, psi_ddot * sp.cos(theta) - psi_dot * theta_dot * sp.sin(theta))
    second = sp.expand(rows[1] * (I2 - Js_1))
    assert sp.cancel(second.subs(massless)) == 0
    assert rows[3] == 0


# --- energy, momentum, constants --------------------------------------------------------------


def test_energy_and_momentum_are_those_of_the_parts():
    """Carrier plus rotors, each with its own angular velocity; J is the sum with rotors held."""
    axial, across = sp.symbols("Js_1 Jt", positive=True)
    a = sp.Matrix(OBLIQUE)
    omega, speed = sp.Matrix(w), sp.Symbol("Omega", real=True)
    carrier = sp.diag(I1, I2, I3)
    rotor = across * sp.eye(3) + (axial - across) * a * a.T
    spun = omega + speed * a
    energy = (omega.dot(carrier * omega) + spun.dot(rotor * spun)) / 2
    h = carrier * omega + rotor * spun
    system = gyrostat.gyrostat(1, axes=[OBLIQUE], inertia=full_inertia())
    entries, _ = full_inertia()
    total = carrier + rotor
    values = {entries[i, j]: total[i, j] for i in range(3) for j in range(i, 3)}
    values[p[0]] = axial * (a.dot(omega) + speed)
    found = {name: e.subs(values, simultaneous=True) for name, e in outputs_of(system).items()}
    assert equal(found["T"], energy)
    assert all(equal(found[f"h_{k}"], h[k - 1]) for k in (1, 2, 3))
    assert equal(found["Omega_1"], speed)


@pytest.mark.parametrize(
    ("drives", "constants"),
    every(
        2,
        [
            (["motor", "motor"], {"H"}),
            (["free", "motor"], {"H", "rotor_rate_1"}),
            (["free", "free"], {"H", "T", "T_omega", "rotor_rate_1", "rotor_rate_2"}),
            (["constant", "constant"], {"H", "T_omega"}),
            (["constant", "free"], {"H", "T_omega", "rotor_rate_2"}),
            (["locked", "locked"], {"H", "T", "T_omega"}),
        ],
    ),
)
def test_constants_of_the_motion(drives, constants):
    assert set(gyrostat.gyrostat(2, drives=drives).invariant_names) == constants
    oblique = gyrostat.gyrostat(2, axes=[SPACE, OBLIQUE], drives=drives, inertia=full_inertia())
    assert set(oblique.invariant_names) == constants


@pytest.mark.parametrize("drive", ["motor", "constant"])
def test_motors_do_the_work(drive):
    """dT/dt = sum of u_k Omega_k; the motor of a constant speed is an output."""
    system = gyrostat.gyrostat(2, drives=drive)
    outputs = outputs_of(system)
    power = 0
    for k in (1, 2):
        torque = u[k - 1] if drive == "motor" else outputs[f"u_{k}"]
        speed = outputs[f"Omega_{k}"] if drive == "motor" else sp.Symbol(f"Omega_{k}", real=True)
        power += torque * speed
    assert equal(system.rate_of(outputs["T"]), system.expand(power))


def test_constant_speed_is_what_its_motor_torque_gives():
    """The same accelerations as with a motor whose torque is the output u_1."""
    constant = gyrostat.gyrostat(1, drives="constant")
    driven = gyrostat.gyrostat(1)
    Omega_1 = sp.Symbol("Omega_1", real=True)
    back = {p[0]: Js_1 * (w[0] + Omega_1), u[0]: outputs_of(constant)["u_1"]}
    for a, b in zip(driven.rates[:3], constant.rates, strict=True):
        assert equal(driven.expand(a).subs(back), constant.expand(b))


@pytest.mark.parametrize("options", [{"n": 0}, {"n": 2, "drives": "locked"}])
def test_without_turning_rotors_it_is_the_rigid_body(options):
    found, free = gyrostat.gyrostat(**options), eom.free_rigid_body()
    assert found.state_names == free.state_names
    assert found.parameter_names == free.parameter_names
    for a, b in zip(found.rates, free.rates, strict=True):
        assert equal(found.expand(a), b)


@pytest.mark.parametrize("name", ["quaternion", "dcm", "3-2-1"])
def test_momentum_in_space_is_constant_whatever_the_motors_do(name):
    system = gyrostat.gyrostat(3, attitude=attitude(name))
    assert {"H", "H_1", "H_2", "H_3"} <= set(system.invariant_names)
    assert system.input_names == ("u_1", "u_2", "u_3")
    assert ("rotation" in {a.name for a in system.assumptions}) == (name != "3-2-1")


def test_shapes_and_assumptions():
    system = gyrostat.gyrostat(1, axes=[OBLIQUE], attitude=attitude("quaternion"))
    assert system.mass_matrix.shape == (8, 8)
    assert sp.Matrix(system.mass_matrix).is_symmetric()
    assert system.mass_matrix[3:, 3:] == sp.eye(5)
    principal = gyrostat.gyrostat(1)
    assert principal.mass_matrix is None
    inside = next(a for a in principal.assumptions if a.name == "rotors_in_inertia")
    assert inside.nonnegative[0] == I1 - Js_1
    assert "principal_axes" in {a.name for a in principal.assumptions}


def test_rotors_that_are_more_than_the_inertia_break_an_assumption():
    """J = diag(2, 2, 3) less Js a a^T with a = (3/5, 4/5, 0) is positive definite for Js < 2."""
    system = gyrostat.gyrostat(1, axes=[OBLIQUE])
    inside = next(a for a in system.assumptions if a.name == "rotors_in_inertia")
    for axial, holds in ((sp.Rational(19, 10), True), (sp.Rational(21, 10), False)):
        point = {I1: 2, I2: 2, I3: 3, Js_1: axial}
        assert all(e.subs(point) > 0 for e in inside.nonnegative) == holds


def test_axis_by_an_angle_as_parameter():
    beta = sp.Symbol("beta", real=True)
    quantity = Quantity(beta, "rad", "cant of the axis", "\\beta")
    axes = [(sp.cos(beta), 0, sp.sin(beta))]
    system = gyrostat.gyrostat(1, axes=axes, parameters=(quantity,), drives="free")
    assert system.parameter_names == ("I1", "I2", "I3", "Js_1", "beta")
    assert {"T", "H"} <= set(system.invariant_names)
    straight = reduce.substitute(system, {beta: sp.Integer(0)})
    along = gyrostat.gyrostat(1, drives="free")
    numbers = {I1: 2, I2: 3, I3: 4, Js_1: sp.Rational(1, 2), p[0]: 5, w[0]: 1, w[1]: 2, w[2]: 3}
    assert derivatives(straight, numbers) == derivatives(along, numbers)


def test_axes_as_floats():
    for axis in ((0.6, 0.8, 0.0), (math.sqrt(1 / 3),) * 3, (math.cos(0.3), 0, math.sin(0.3))):
        system = gyrostat.gyrostat(1, axes=[axis])
        assert system.mass_matrix is not None
    exact = gyrostat.gyrostat(1, axes=[(1 / sp.sqrt(2), 1 / sp.sqrt(2), 0)])
    assert sp.Matrix(exact.mass_matrix)[0, 0] == I1 - Js_1 / 2


AXIS = [(1, 0, 0)]
BAD = {
    "negative": ({"n": -1}, "number of rotors"),
    "fraction": ({"n": 1.5}, "number of rotors"),
    "truth": ({"n": True}, "number of rotors"),
    "four without axes": ({"n": 4}, "number of rotors"),
    "too few axes": ({"n": 2, "axes": AXIS}, "2 rotors need 2 axes"),
    "too many axes": ({"n": 0, "axes": AXIS}, "0 rotors need 0 axes"),
    "too few drives": ({"n": 2, "drives": ["motor"]}, "2 rotors need 2 axes"),
    "unknown drive": ({"n": 1, "drives": "moter"}, "did you mean motor"),
    "no drive": ({"n": 1, "drives": [None]}, "unknown drive"),
    "not a unit": ({"n": 1, "axes": [(1, 1, 0)]}, "no unit vector"),
    "zero": ({"n": 1, "axes": [(0, 0, 0)]}, "no unit vector"),
    "two components": ({"n": 1, "axes": [(1, 0)]}, "no unit vector"),
    "nan": ({"n": 1, "axes": [(math.nan, 0, 1)]}, "no unit vector"),
    "infinite": ({"n": 1, "axes": [(math.inf, 0, 1)]}, "no unit vector"),
    "text": ({"n": 1, "axes": [("1", 0, 0)]}, "not a number"),
    "symbols": ({"n": 1, "axes": [sp.symbols("a1:4")]}, "no unit vector"),
    "unknown symbol": (
        {"n": 1, "axes": [(sp.cos(sp.Symbol("beta")), sp.sin(sp.Symbol("beta")), 0)]},
        "without a meaning",
    ),
    "name taken": ({"n": 1, "parameters": (Quantity(I1),)}, "repeated"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused(name):
    options, message = BAD[name]
    with pytest.raises(InputError, match=message):
        gyrostat.gyrostat(**options)


def test_four_rotors_on_a_pyramid_keep_momentum_while_motors_work():
    """Integrated with the mass matrix solved in floats; h fixed in space, energy is the work."""
    third = 1 / sp.sqrt(3)
    axes = [(x * third, y * third, third) for x in (1, -1) for y in (1, -1)]
    system = gyrostat.gyrostat(4, axes=axes, attitude=attitude("quaternion"))
    numbers = dict(zip((I1, I2, I3), (3.0, 4.0, 5.0), strict=True))
    numbers |= {q.symbol: 0.3 for q in system.parameters if q.name.startswith("Js")}
    states = [q.symbol for q in system.states]
    inputs = [q.symbol for q in system.inputs]
    f = sp.lambdify(
        [states, inputs], [system.expand(r).subs(numbers) for r in system.rates], "math"
    )
    mass = np.array(sp.Matrix(system.mass_matrix).subs(numbers).evalf().tolist(), dtype=float)

    def torques(t):
        return [0.1 * math.sin(t + k) for k in range(4)]

    speeds = [outputs_of(system)[f"Omega_{k}"].subs(numbers) for k in (1, 2, 3, 4)]
    speed = sp.lambdify([states], speeds, "math")

    def rates(t, x):
        slopes = np.linalg.solve(mass, f(x[:-1], torques(t)))
        return [*slopes, float(np.dot(torques(t), speed(x[:-1])))]

    start = [0.3, -0.2, 0.5, 0.1, 0.2, -0.3, 0.4, 1.0, 0.0, 0.0, 0.0, 0.0]
    run = solve_ivp(rates, (0, 20), start, "DOP853", rtol=1e-11, atol=1e-13)
    for k in ("H", "H_1", "H_2", "H_3"):
        h = sp.lambdify([states], outputs_of(system)[k].subs(numbers), "math")
        assert np.ptp([h(x) for x in run.y[:-1].T]) < 1e-9
    T = sp.lambdify([states], outputs_of(system)["T"].subs(numbers), "math")
    energies = np.array([T(x) for x in run.y[:-1].T])
    assert np.ptp(energies) > 0.1
    assert np.allclose(energies - energies[0], run.y[-1], atol=1e-9)


def test_rotor_on_the_intermediate_axis_makes_its_spin_stable():
    """Hughes (1986), ch. 6: stable where (I2 nu + h)/nu exceeds both other moments."""
    system = gyrostat.gyrostat(1, axes=[(0, 1, 0)], drives="constant")
    A = linearised(system, 2)
    numbers = {I1: 1, I2: 2, I3: 2.5, Js_1: 0.1, SPIN_RATE: 1.0}
    speed = sp.Symbol("Omega_1", real=True)
    for stored, stable in ((0.0, False), (0.4, False), (0.6, True), (-0.9, False), (-1.1, True)):
        matrix = A.subs(numbers).subs(speed, stored / 0.1)
        roots = np.linalg.eigvals(np.array(matrix.tolist(), dtype=float))
        assert (max(roots.real) < 1e-7) == stable


def test_momentum_of_free_rotors_is_constant_one_by_one():
    system = gyrostat.gyrostat(2, drives=["free", "motor"])
    assert is_invariant(system, p[0])
    assert not is_invariant(system, p[1])
