"""Quaternions and rigid bodies that systems state, in programs, and the change to momentum."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import eom
from codegen.compiling.compiled import compile as compile_system
from codegen.frontend.attitude import FRAME, INERTIA, attitude_of
from codegen.integrate.group import (
    CONSTANTS,
    ERRORS,
    FIXED,
    KICK,
    ROUNDING,
    SLOPES,
    START,
    STATES,
    Variables,
    kicks,
    local,
    start,
)
from codegen.ir.interpret import Point, interpret, random_point
from codegen.ir.program import Builder
from codegen.ir.residues import FIELD, LARGEST, PRIME, RandomPoint, degree
from eom import BodyAttitude, InputError
from eom.fields import Singular
from eom.kinematics.coordinates import attitude
from eom.mechanics import torques
from eom.mechanics.rigidbody import full_inertia, gravity_gradient_satellite, heavy_top, rigid_body
from eom.quantities import TIME
from eom.rotations import quaternion_product
from eom.system import System


def compiled(system, **options):
    return compile_system(system, "numpy", **options)


def attitude_in(system, **options):
    c = compiled(system, **options)
    return attitude_of(c.layout.attitudes, len(c.layout.states)), c


def inertia_of(body, p):
    return interpret(body.values, Point(p=p))[INERTIA]


def full_body(torque=lambda C, J: torques.weight(C, (True, True, True))):
    return rigid_body(full_inertia(), torque, attitude("quaternion"), name="full")


# --- residues ------------------------------------------------------------------------------------


def test_no_number_that_people_write_is_zero_in_the_field():
    """Doubles of every size, and one less or more than powers of two and ten."""
    exponents = range(-1074, 1024)
    powers = [Fraction(2) ** k for k in exponents] + [Fraction(10) ** k for k in range(-320, 320)]
    residues = {FIELD.of(v) for v in powers}
    assert len(residues) == len(set(powers))
    assert 0 not in {FIELD.of(v + s) for v in powers for s in (0, 1, -1) if v + s}


def test_sines_and_cosines_lie_on_the_circle_and_double():
    point = RandomPoint(5)
    angle = FIELD.of(Fraction(3, 7))
    order = [2, 1, Fraction(1, 2), 4, -1, Fraction(1, 4)]
    found = {f: point.circle(angle * FIELD.of(Fraction(f)) % PRIME) for f in order}
    assert all((c * c + s * s - 1) % PRIME == 0 for c, s in found.values())
    for half, double in ((1, 2), (2, 4), (Fraction(1, 2), 1), (Fraction(1, 4), Fraction(1, 2))):
        (c, s), (d, t) = found[half], found[double]
        assert (d - c * c + s * s) % PRIME == (t - 2 * c * s) % PRIME == 0
    (c, s), (d, t) = found[1], found[-1]
    assert (c - d) % PRIME == (s + t) % PRIME == 0
    assert point.circle(0) == (1, 0)


def test_the_degree_of_a_program_is_bounded():
    """x^401 is of degree 401; squares of squares soon are of a degree that nothing is proved of."""
    b = Builder()
    x = b.leaf("state", 0)
    value = x
    for _ in range(400):
        value = b.add("mul", value, x)
    assert 401 <= degree(b.program({"f": [value]})) <= LARGEST
    for _ in range(200):
        value = b.add("mul", value, value)
    assert degree(b.program({"f": [value]})) > LARGEST


def test_unknown_functions_depend_on_their_arguments_alone():
    b = Builder()
    x, y = b.leaf("state", 0), b.leaf("state", 1)
    sines = [b.add("sin", x), b.add("sin", y), b.add("sin", b.add("add", x, b.const(0)))]
    orders = [b.add("max", x, y), b.add("max", y, x), b.add("atan2", x, y), b.add("atan2", y, x)]
    program = b.program({"f": [*sines, *orders]})
    values = RandomPoint(3).values(program, {})
    one, other, same, high, again, turn, back = (values[k] for k in program.results["f"])
    assert one == same != other
    assert high == again
    assert turn != back


def test_nan_in_one_branch_leaves_the_other():
    b = Builder()
    zero = b.unfolded("div", b.const(0), b.const(0))
    x = b.leaf("state", 0)
    chosen = b.unfolded("select", b.leaf("state", 1), x, zero)
    values = RandomPoint(0).values(b.program({"f": [chosen]}), {})
    assert values[chosen] == values[x]
    without = b.program({"f": [b.unfolded("div", x, b.const(0))]})
    with pytest.raises(Singular):
        RandomPoint(0).values(without, {})


# --- what is found -------------------------------------------------------------------------------


def test_the_heavy_top_is_found_with_a_rate_that_became_a_parameter():
    found, c = attitude_in(eom.Scene.ready("heavy-top").derive())
    assert c.layout.results["rates"] == ("omega_1", "omega_2", "q0", "q1", "q2", "q3")
    assert found.quaternion == (2, 3, 4, 5)
    body = found.body
    assert body.rates == (0, 1, -1)
    assert body.of_rates == (False, False, False)
    assert body.zero == (False, False, True)
    p = {"I1": 2.0, "I3": 0.7, "m": 3.0, "g": 9.0, "r3": 0.4, "omega_3": 11.0}
    values = interpret(body.values, Point(p=list(p.values())))
    assert values[INERTIA] == [2.0, 0.0, 0.0, 2.0, 0.0, 0.7]
    assert values["constant rates"] == [0.0, 0.0, 11.0]


def test_the_orbit_frame_is_found():
    found, c = attitude_in(gravity_gradient_satellite())
    p = [1.0, 1.5, 2.0, 0.25]
    assert [q.name for q in c.layout.parameters] == ["I1", "I2", "I3", "n"]
    assert interpret(found.body.values, Point(p=p))[FRAME] == [0.0, 0.0, 0.25]
    assert inertia_of(found.body, p) == [1.0, 0.0, 0.0, 1.5, 0.0, 2.0]


def test_a_full_inertia_matrix_is_found_up_to_nothing():
    found, _ = attitude_in(full_body(lambda C, J: torques.applied((0, 0, 0))))
    assert found.body.zero == (True, True, True)
    assert inertia_of(found.body, [3.0, 0.1, 0.2, 4.0, -0.3, 5.0]) == [
        3.0,
        0.1,
        0.2,
        4.0,
        -0.3,
        5.0,
    ]


@pytest.mark.parametrize(
    "fixed", [{"I1": 2.5}, {"I1": 2.5, "I3": 0.7}, {"I1": 2.5, "I2": 2.0, "I3": 0.7}]
)
def test_moments_that_are_compiled_in_are_found_up_to_a_factor(fixed):
    found, c = attitude_in(heavy_top(), parameters=fixed)
    every = {"I1": 2.5, "I2": 2.0, "I3": 0.7, "m": 1.0, "g": 1.0, "r3": 1.0}
    J = inertia_of(found.body, [every[q.name] for q in c.layout.parameters])
    np.testing.assert_allclose(
        np.array(J) / J[0], np.array([2.5, 0, 0, 2.0, 0, 0.7]) / 2.5, rtol=1e-15
    )


w = sp.symbols("alpha beta gamma", real=True)
q = sp.symbols("e f1 g1 h1", real=True)
A, B, C, k, f = sp.symbols("A B C k f", positive=True)
wheel = sp.Symbol("wheel", real=True)


def equations(torque=(0, 0, 0), extra=None, rate=w, moments=(A, B, C)):
    J = sp.diag(*moments)
    gyroscopic = sp.Matrix(w).cross(J * sp.Matrix(w))
    turn = quaternion_product(q, (0, *rate))
    rates = {w[i]: (torque[i] - gyroscopic[i]) / moments[i] for i in range(3)}
    rates = {**rates, **{q[i]: turn[i] / 2 for i in range(4)}, **(extra or {})}
    return rates, BodyAttitude(w, "quaternion", q, inertia=J, torque=torque)


def system(given, order=None, attitudes=None):
    rates, stated = given
    names = list(rates) if order is None else [list(rates)[i] for i in order]
    attitudes = [stated] if attitudes is None else attitudes
    return System.from_rates("body", {n: rates[n] for n in names}, attitudes=attitudes)


@settings(max_examples=12)
@given(st.permutations(range(8)))
def test_no_name_and_no_order_matters(order):
    extra = {wheel: -wheel + w[0]}
    found, c = attitude_in(system(equations((k * q[1], 0, 0), extra), order))
    names = [c.layout.states[s].name for s in found.quaternion]
    assert names == ["e", "f1", "g1", "h1"]
    assert [c.layout.states[s].name for s in found.body.rates] == ["alpha", "beta", "gamma"]
    assert [c.layout.states[s].name for s in found.others] == ["wheel"]


def test_damping_and_a_wheel_leave_the_body_and_are_reported():
    torque = (-k * w[0], f * q[1], wheel)
    found, _ = attitude_in(system(equations(torque, {wheel: -wheel})))
    assert found.body.of_rates == (True, False, False)
    assert found.body.zero == (False, False, False)
    assert found.others == (7,)


def test_drag_quadratic_in_the_rates_is_reported():
    found, _ = attitude_in(system(equations((-k * w[0] * sp.Abs(w[0]), 0, 0))))
    assert found.quaternion == (3, 4, 5, 6)
    assert found.body.of_rates == (True, False, False)
    assert found.body.zero == (False, True, True)


def test_moments_that_change_with_time_are_no_body():
    """The statement holds; what is kept with the parameters does not."""
    found, _ = attitude_in(system(equations(moments=(A * (2 + sp.sin(TIME)), B, C))))
    assert found.quaternion == (3, 4, 5, 6)
    assert found.body is None


def test_moments_may_be_expressions_of_parameters():
    moments = (A * k**2 / 4, A * k**2 / 4, A * k**2 / 2 + f)
    found, c = attitude_in(system(equations(moments=moments)))
    p = dict.fromkeys([s.name for s in c.layout.parameters], 0.0) | {"A": 2.0, "k": 3.0, "f": 0.5}
    J = np.array(inertia_of(found.body, list(p.values())))
    np.testing.assert_allclose(J / J[0], np.array([4.5, 0, 0, 4.5, 0, 9.5]) / 4.5, rtol=1e-15)


def opposite(torque=(0, 0, 0)):
    """dq/dt = -(0, omega) q/2, of the inverse turn: the conjugate is the body's."""
    turn = quaternion_product((0, *w), q)
    rates, stated = equations(torque)
    return {**rates, **{q[i]: -turn[i] / 2 for i in range(4)}}, stated


def test_the_opposite_convention_is_refused():
    with pytest.raises(InputError, match=r"stated, but not so: d\(e\)/dt by the kinematics"):
        system(opposite())


def test_other_attitudes_and_two_quaternions_are_not_taken():
    for name in (None, "3-1-2", "dcm"):
        assert attitude_in(eom.free_rigid_body(name))[0] is None
    more = sp.symbols("z0:4", real=True)
    turn = quaternion_product(more, (0, *w))
    rates, stated = equations(extra={more[i]: turn[i] / 2 for i in range(4)})
    both = [stated, BodyAttitude(w, "quaternion", more)]
    assert attitude_in(system((rates, stated), attitudes=both))[0] is None
    assert attitude_in(system((rates, stated)))[0].others == (7, 8, 9, 10)
    assert attitude_in(system((rates, stated), attitudes=[]))[0] is None


def test_a_rate_that_became_a_number_is_found():
    scene = eom.Scene.ready("heavy-top")
    found, c = attitude_in(scene.derive(), parameters=scene.parameter_values())
    assert not c.layout.parameters
    values = interpret(found.body.values, Point())
    np.testing.assert_allclose(np.array(values[INERTIA]) / values[INERTIA][0], [1, 0, 0, 1, 0, 0.3])
    assert values["constant rates"] == [0.0, 0.0, 20.0]
    assert found.body.of_rates == (False, False, False)


def led(*rate):
    turn = quaternion_product(q, (0, *rate))
    rates = {q[i]: turn[i] / 2 for i in range(4)}
    return {s: sp.Integer(0) for s in w if s in rate} | rates, BodyAttitude(rate, "quaternion", q)


def test_a_rate_that_is_led_is_of_no_body():
    """A sphere, for which every inertia would do, turned about b3 by a clock."""
    found, _ = attitude_in(system(led(w[0], w[1], sp.cos(TIME))))
    assert found.body is None
    assert found.others == (0, 1)


def test_prescribed_rates_are_a_quaternion_alone():
    found, _ = attitude_in(system(led(sp.cos(TIME), k, sp.sin(2 * TIME))))
    assert found.quaternion == (0, 1, 2, 3)
    assert found.body is None


# --- the change of variables ---------------------------------------------------------------------

SYSTEMS = {
    "heavy top": heavy_top,
    "heavy top of the scene": lambda: eom.Scene.ready("heavy-top").derive(),
    "numbers compiled in": lambda: eom.Scene.ready("heavy-top").derive(),
    "satellite": gravity_gradient_satellite,
    "full inertia": full_body,
    "free": lambda: eom.free_rigid_body("quaternion"),
    "damped, with a wheel": lambda: system(
        equations((-k * w[0], f * q[1], wheel), {wheel: -wheel + w[0]})
    ),
    "drag": lambda: system(equations((-k * w[0] * sp.Abs(w[0]), 0, 0))),
    "without a body": lambda: system(
        (equations((f * q[1], 0, 0))[0], None), attitudes=[BodyAttitude(w, "quaternion", q)]
    ),
}  # fmt: skip


@pytest.mark.sparse(6)
@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("seed", [1, 2])
def test_the_new_variables_move_as_the_system_says(name, seed):
    """The states come back, and the rates of q and v are those of the system, by differences."""
    fixed = (
        eom.Scene.ready("heavy-top").parameter_values() if name == "numbers compiled in" else None
    )
    c = compiled(SYSTEMS[name](), parameters=fixed)
    n = len(c.layout.states)
    variables = Variables(attitude_of(c.layout.attitudes, n), n)
    changed, begin = local(c.program, variables), start(c.program, variables)
    point = random_point(c.program, seed)
    x, quaternion = np.array(point.x), list(variables.attitude.quaternion)
    p = np.array(point.p)
    if name == "full inertia":
        p[:6] = 3, 0.1, 0.2, 4, -0.3, 5
    x[quaternion] /= np.linalg.norm(x[quaternion])

    def moved(t, state):
        return np.array(interpret(begin, Point(t, state, p))[START])

    t, f = point.t, c.rhs(point.t, x, p)
    v = moved(t, x)
    off = np.linspace(0.7, -0.4, 3 + len(v))
    values = interpret(changed, Point(t, [*x[quaternion], *v, *off], p))
    np.testing.assert_allclose(values[STATES], x, rtol=0, atol=1e-14)
    h = 1e-6
    slope = (moved(t + h, x + h * f) - moved(t - h, x - h * f)) / (2 * h)
    np.testing.assert_allclose(values[SLOPES][3:], slope, rtol=0, atol=2e-8)
    (a, *b), turn = x[quaternion], np.array(values[SLOPES][:3])
    rate = np.array([-np.dot(b, turn), *(a * turn + np.cross(b, turn))]) / 2
    np.testing.assert_allclose(rate, f[quaternion], rtol=0, atol=1e-14)
    ahead = [b + 1e-5 * e for b, e in zip(v, off[3:], strict=True)]
    tilted = sp.Quaternion(*x[quaternion]) * sp.Quaternion(1, *(5e-6 * off[:3]))
    there = interpret(changed, Point(t, [*tilted.to_Matrix(), *ahead, *off], p))[STATES]
    which = [(k, s) for k, s in enumerate(variables.compared) if s >= 0]
    errors = [values[ERRORS][k] for k, _ in which]
    moves = [(there[s] - x[s]) / 1e-5 for _, s in which]
    np.testing.assert_allclose(errors, np.array(moves, float), rtol=1e-4, atol=1e-4)
    assert len(values[ERRORS]) == len(variables.compared) == 4 + variables.number


def test_rounding_of_the_momentum_in_body_rates_is_bounded():
    """By what an error of |pi| in each of its components in the body makes of them; a rate may be fixed."""
    J, pi = np.array([[3, 0.1, 0.2], [0.1, 4, -0.3], [0.2, -0.3, 5]]), np.array([1.0, -2, 2])
    c = compiled(SYSTEMS["full inertia"]())
    variables = Variables(
        attitude_of(c.layout.attitudes, len(c.layout.states)), len(c.layout.states)
    )
    p = [
        {"J11": 3, "J12": 0.1, "J13": 0.2, "J22": 4, "J23": -0.3, "J33": 5}.get(s.name, 1.0)
        for s in c.layout.parameters
    ]
    found = interpret(local(c.program, variables), Point(0.0, [1, 0, 0, 0, *pi, *np.zeros(20)], p))
    expected = 3 * np.abs(np.linalg.inv(J)).sum(axis=1)
    np.testing.assert_allclose(found[ROUNDING], expected, rtol=1e-14)
    top = compiled(SYSTEMS["heavy top of the scene"]())
    n = len(top.layout.states)
    variables = Variables(attitude_of(top.layout.attitudes, n), n)
    names = [s.name for s in top.layout.parameters]
    fixed = interpret(start(top.program, variables), random_point(top.program, 1))[FIXED]
    assert variables.compared[4:7].count(-1) == 1
    assert fixed[2] == random_point(top.program, 1).p[names.index("omega_3")]
    assert fixed[:2] == [0, 0]


def test_without_torque_the_momentum_does_not_move_at_all():
    c = compiled(SYSTEMS["free"]())
    variables = Variables(attitude_of(c.layout.attitudes, 7), 7)
    changed = local(c.program, variables)
    rates = [changed.instructions[r] for r in changed.results[SLOPES][3:]]
    assert [(i.op, i.value) for i in rates] == [("const", 0)] * 3


def test_kicks_are_the_torque_in_both_frames():
    c = compiled(heavy_top())
    variables = Variables(attitude_of(c.layout.attitudes, 7), 7)
    program = kicks(c.program, variables)
    p = [1.0, 1.5, 2.0, 3.0, 9.81, 0.2]
    assert [s.name for s in c.layout.parameters] == ["I1", "I2", "I3", "m", "g", "r3"]
    turn = np.array([0.5, 0.1, -0.7, 0.5]) / np.linalg.norm([0.5, 0.1, -0.7, 0.5])
    values = interpret(program, Point(x=turn, p=p))
    matrix = np.array(
        attitude("quaternion").matrix.subs(
            dict(zip(attitude("quaternion").symbols, turn, strict=True))
        ),
        float,
    )
    weight = np.cross([0, 0, 0.2], matrix @ [0, 0, -3 * 9.81])
    np.testing.assert_allclose(values[KICK], [*weight, *(matrix.T @ weight)], atol=1e-14)
    assert values[CONSTANTS] == [1.0, 0.0, 0.0, 1.5, 0.0, 2.0, 0, 0, 0, 0, 0, 0]
