"""Motion under constraints against closed forms, printed solutions, other derivations, and itself."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.native import native
from eom.errors import InputError
from eom.multibody import (
    GROUND,
    Body,
    Coupling,
    Distance,
    Equation,
    Joint,
    Loop,
    Motion,
    Placement,
    Rolling,
    SpeedEquation,
    Tree,
    assemble,
    derive,
)
from tests.eom.multibody.bound import (
    LENGTHS,
    NEAR,
    ROTATION,
    SQUEEZED,
    SQUEEZER,
    disc,
    four_bar,
    g,
    r,
    rod_instead_of_coupler,
    sleigh,
    squeezer,
)
from tests.eom.rows import but

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="no C compiler")
x, y = (sp.Symbol(f"q_{n}", real=True) for n in "xy")


def arrays(system, values, parameters):
    point = np.array([values[n] for n in system.state_names], float)
    return point, np.array([parameters[n] for n in system.parameter_names], float)


def rates(system, values, parameters, t=0.0):
    point, p = arrays(system, values, parameters)
    found = codegen.compile(system, "numpy").rhs(t, point, p, np.empty(0))
    return dict(zip(system.state_names, found, strict=True))


def outputs(system, values, parameters, t=0.0):
    point, p = arrays(system, values, parameters)
    found = codegen.compile(system, "numpy").outputs(t, point, p, np.empty(0))
    return dict(zip(system.output_names, found, strict=True))


WAYS = {"multipliers": {"multipliers": True}, "elimination": {"independent": ("u_a",)}}


def linkage(angle):
    """Angles of coupler and rocker over the crank's: two circles meet (Freudenstein's equation)."""
    l1, l2, l3, d = (mpmath.mpf(LENGTHS[n]) for n in ("L1", "L2", "L3", "d"))
    ex, ey = d - l1 * mpmath.cos(angle), -l1 * mpmath.sin(angle)
    far = mpmath.sqrt(ex**2 + ey**2)
    turn = mpmath.acos((l2**2 + far**2 - l3**2) / (2 * l2 * far))
    coupler = mpmath.atan2(ey, ex) + turn
    px = l1 * mpmath.cos(angle) + l2 * mpmath.cos(coupler) - d
    py = l1 * mpmath.sin(angle) + l2 * mpmath.sin(coupler)
    return coupler, mpmath.atan2(py, px)


def started(given, q_a=0.3, u_a=2.0):
    """Consistent values from some a tenth of a radian off."""
    coupler, rocker = (float(x) for x in linkage(q_a))
    near = {"q_a": q_a, "q_b": coupler - q_a + 0.1, "q_c": rocker - 0.1, "u_a": u_a}
    return assemble(given, {**LENGTHS, **near}, keep=("q_a", "u_a")).values


def reduced_acceleration(angle, rate):
    """Lagrange's equation of the one angle: (I u^2 / 2)' by it, all by numerical derivatives."""
    l1, l2, l3 = (mpmath.mpf(LENGTHS[n]) for n in ("L1", "L2", "L3"))

    def inertia(a):
        db = mpmath.diff(lambda s: linkage(s)[0], a)
        dc = mpmath.diff(lambda s: linkage(s)[1], a)
        bx = -l1 * mpmath.sin(a) - l2 / 2 * mpmath.sin(linkage(a)[0]) * db
        by = l1 * mpmath.cos(a) + l2 / 2 * mpmath.cos(linkage(a)[0]) * db
        own = l1**2 / 3 + 2 * l2**2 / 12 * db**2 + 3 * l3**2 / 3 * dc**2
        return own + 2 * (bx**2 + by**2)

    def potential(a):
        coupler, rocker = linkage(a)
        height = 1 * l1 / 2 * mpmath.sin(a)
        height += 2 * (l1 * mpmath.sin(a) + l2 / 2 * mpmath.sin(coupler))
        return mpmath.mpf(LENGTHS["g"]) * (height + 3 * l3 / 2 * mpmath.sin(rocker))

    half = mpmath.diff(inertia, angle) / 2 * rate**2
    return (-half - mpmath.diff(potential, angle)) / inertia(angle)


PLANE = Placement().rotation
TURNED = [(way, rotation) for way in WAYS for rotation in (PLANE, ROTATION)]


@pytest.mark.parametrize(("way", "rotation"), but(TURNED, *TURNED[1:3]))
def test_a_four_bar_linkage_moves_as_its_one_angle(way, rotation):
    given = four_bar(rotation=rotation)
    system = derive(given, **WAYS[way])
    for angle, rate in ((0.3, 2.0), (1.9, -3.0), (-2.5, 0.0)):
        values = started(given, angle, rate)
        coupler, rocker = linkage(angle)
        assert values["q_a"] + values["q_b"] == pytest.approx(float(coupler), abs=1e-13)
        assert values["q_c"] == pytest.approx(float(rocker), abs=1e-13)
        expected = float(reduced_acceleration(angle, rate))
        assert rates(system, values, LENGTHS)["u_a"] == pytest.approx(expected, rel=1e-9)


def test_both_ways_give_the_same_forces():
    given = four_bar()
    values = started(given)
    found = [outputs(derive(given, ["constraint_forces"], **way), values, LENGTHS)
             for way in WAYS.values()]  # fmt: skip
    assert set(found[0]) == {"lambda_pin_x", "lambda_pin_y"}
    assert all(found[1][n] == pytest.approx(value, rel=1e-12) for n, value in found[0].items())
    assert found[1]["u_c"] == pytest.approx(values["u_c"], rel=1e-13)


def test_a_coupler_without_mass_is_a_rod():
    """It is a leaf of the tree that moves no mass; its angle follows from the others."""
    light, rod = four_bar(coupler=0), rod_instead_of_coupler()
    values = started(light)
    expected = rates(derive(rod), values, LENGTHS)
    for options in ({}, {"independent": ("u_a",)}):
        found = rates(derive(light, **options), values, LENGTHS)
        assert all(
            found[n] == pytest.approx(expected[n], rel=1e-11) for n in found if n in expected
        )
    with pytest.raises(InputError, match="joint 'b'"):
        derive(light, multipliers=True)


def point_mass(*constraints):
    """A mass on two slides, by which it moves in the plane x, y; y is up."""
    joints = [Joint("x", "prismatic", GROUND, "slide", "x"),
              Joint("y", "prismatic", "slide", "mass", "y")]  # fmt: skip
    bodies = [Body("slide"), Body("mass", 2)]
    return Tree("point", bodies, joints, gravity=(0, -g, 0), constraints=constraints)


PENDULA = {
    "rod": Distance("c", GROUND, "mass", 5),
    "equation": Equation("c", x**2 + y**2 - 25),
    "moving frame": Equation("c", sp.sqrt((x + y) ** 2 + (x - y) ** 2) - 5 * sp.sqrt(2)),
}


@pytest.mark.parametrize("constraint", PENDULA.values(), ids=PENDULA)
@pytest.mark.parametrize("way", [{"multipliers": True}, {"independent": ("u_x",)}], ids=str)
def test_a_mass_on_a_rod_is_a_pendulum(constraint, way):
    """At (3, -4) with speed v along (4, 3) / 5: accelerations and pull in closed form."""
    system = derive(point_mass(constraint), ["constraint_forces"], **way)
    v, fall = 2.0, 9.81
    values = {"q_x": 3.0, "q_y": -4.0, "u_x": 0.8 * v, "u_y": 0.6 * v}
    along, inwards = -0.6 * fall, v**2 / 5
    found = rates(system, values, {"g": fall})
    assert found["u_x"] == pytest.approx(0.8 * along - 0.6 * inwards, rel=1e-13)
    if constraint.name == "c" and isinstance(constraint, Distance):
        pull = outputs(system, values, {"g": fall})["lambda_c"]
        assert pull == pytest.approx(-2 * (inwards + 0.8 * fall), rel=1e-13)


def test_a_bead_on_a_turning_wire():
    """y = tan(t) x, a constraint that depends on time: gravity acts along it, 2 s' across."""
    t = sp.Symbol("t", real=True)
    wire = Equation("wire", y * sp.cos(t) - x * sp.sin(t))
    system = derive(point_mass(wire))
    at, s, v, fall = 0.4, 1.3, 0.7, 9.81
    c, n = math.cos(at), math.sin(at)
    values = {"q_x": s * c, "q_y": s * n, "u_x": v * c - s * n, "u_y": v * n + s * c}
    a, w = -fall * n, 2 * v
    found = rates(system, values, {"g": fall}, at)
    assert found["u_x"] == pytest.approx(a * c - w * n, rel=1e-13)
    assert found["u_y"] == pytest.approx(a * n + w * c, rel=1e-13)
    assert "energy" not in system.invariant_names


# --- knife edge, wheels, gears -------------------------------------------------------------------------


def test_chaplygins_sleigh():
    """v' = b w^2, (J + m b^2) w' = -m b v w: Neimark and Fufaev (1972), ch. III, sec. 4."""
    system = derive(sleigh(), ["constraint_forces"])
    assert len(system.states) == 5
    v, w = 1.7, -0.6
    p = {"b": 0.3, "m": 2.0, "J": 0.5}
    speeds = {"v_j_1": v, "v_j_2": 0.0, "u_j": w}
    values = {"x_j": 1.0, "y_j": 2.0, "q_j": 0.9, **speeds}
    names = [n for n in system.state_names if n in speeds]
    assert names == ["v_j_1", "u_j"]
    found = rates(system, values, p)
    turning = -2.0 * 0.3 * v * w / (0.5 + 2.0 * 0.09)
    expected = {"v_j_1": 0.3 * w**2, "u_j": turning}
    for name in names:
        assert found[name] == pytest.approx(expected[name], rel=1e-13)
    force = outputs(system, values, p)["lambda_edge"]
    assert force == pytest.approx(2.0 * (0.3 * turning + v * w), rel=1e-12)


@needs_compiler
def test_a_sleigh_ends_straight_as_its_closed_form_says():
    """v = A tanh(k t), w = W / cosh(k t) with k = b A m / (J + m b^2) and W^2 = k A / b."""
    p = {"b": 0.3, "m": 2.0, "J": 0.5}
    whole = 0.5 + 2.0 * 0.09
    A = 1.2
    k = 0.3 * A * 2.0 / whole
    W = math.sqrt(k * A / 0.3)
    system = derive(sleigh())
    speeds = {"v_j_1": 0.0, "v_j_2": 0.0, "u_j": W}
    start = {n: speeds.get(n, 0.0) for n in system.state_names}
    found = codegen.simulate(system, start, (0, 3), p, rtol=1e-12, method="DOP853")
    assert found["v_j_1"][-1] == pytest.approx(A * math.tanh(3 * k), rel=1e-10)
    assert found["u_j"][-1] == pytest.approx(W / math.cosh(3 * k), rel=1e-9)
    assert found.drift["energy"].relative < 1e-11


def disc_start(attitude, lean, u1, u2, u3, radius):
    """States of the disc at yaw 0 and spin 0, from speeds along the axes of its lean."""
    c, s = math.cos(lean), math.sin(lean)
    half = math.cos(lean / 2), math.sin(lean / 2), 0.0, 0.0
    angles = {"q_j_1": 0.0, "q_j_2": lean, "q_j_3": 0.0}
    turn = dict(zip(("e_j_0", "e_j_1", "e_j_2", "e_j_3"), half, strict=True))
    place = {"x_j": 0.1, "y_j": -radius * s, "z_j": radius * c}
    speeds = {"w_j_1": u1, "w_j_2": u2, "w_j_3": u3}
    return {**place, **(turn if attitude == "quaternion" else angles), **speeds}


ROLLED = [(a, way) for a in ("quaternion", "3-1-2") for way in ({}, {"multipliers": True})]


@pytest.mark.parametrize(("attitude", "way"), but(ROLLED, *ROLLED[1:3]))
def test_a_rolling_disc_obeys_its_classical_equations(attitude, way):
    """Kane and Levinson, Dynamics (1985), as in SymPy's documentation of its rolling disc.

    u1' = (4 g sin q2 + 6 r u2 u3 - r u3^2 tan q2) / (5 r), u2' = -2 u1 u3 / 3,
    u3' = (-2 u2 + u3 tan q2) u1, along axes that lean but do not spin.
    """
    radius, fall = 0.4, 9.81
    p = {"r": radius, "m": 2.0, "g": fall}
    system = derive(disc(attitude), **way)
    for lean, u1, u2, u3 in ((0.3, 0.5, -2.0, 0.7), (-0.8, 1.5, 3.0, -2.0), (0.0, 0.0, 0.0, 0.0)):
        values = {**disc_start(attitude, lean, u1, u2, u3, radius)}
        values = assemble(disc(attitude), {**p, **values}, keep=("w_j_1", "w_j_2", "w_j_3")).values
        found = rates(system, values, p)
        slope = math.tan(lean)
        spin = u2 - u3 * slope
        expected = (
            (4 * fall * math.sin(lean) + 6 * radius * u2 * u3 - radius * u3**2 * slope)
            / (5 * radius) - spin * u3,
            -2 * u1 * u3 / 3,
            (-2 * u2 + u3 * slope) * u1 + spin * u1,
        )  # fmt: skip
        for name, value in zip(("w_j_1", "w_j_2", "w_j_3"), expected, strict=True):
            assert found[name] == pytest.approx(value, rel=1e-12, abs=1e-13)


@pytest.mark.slow
@needs_compiler
def test_a_rolling_disc_stays_on_its_circle():
    """Steady rolling at a constant lean: u3 solves 4 g sin q2 + 6 r u2 u3 = r u3^2 tan q2."""
    radius, fall, lean, u3 = 0.4, 9.81, 0.3, -3.0
    p = {"r": radius, "m": 2.0, "g": fall}
    slope = math.tan(lean)
    u2 = (radius * u3**2 * slope - 4 * fall * math.sin(lean)) / (6 * radius * u3)
    given = disc("3-1-2")
    system = derive(given)
    values = disc_start("3-1-2", lean, 0.0, u2, u3, radius)
    start = assemble(given, {**p, **values}, keep=("w_j_1", "w_j_2", "w_j_3")).start(system)
    found = codegen.simulate(system, start, (0, 5), p, rtol=1e-11, method="DOP853")
    assert np.allclose(found["q_j_2"], lean, atol=1e-8)
    period = 2 * math.pi * math.cos(lean) / abs(u3)
    whole = codegen.simulate(system, start, (0, period), p, rtol=1e-11, method="DOP853")
    assert whole["x_j"][-1] == pytest.approx(start["x_j"], abs=1e-9)
    assert whole["y_j"][-1] == pytest.approx(start["y_j"], abs=1e-9)
    assert found.drift["energy"].relative < 1e-10
    assert found.drift["closure_floor_z"].largest < 1e-13


def test_a_ball_down_an_incline_by_forces_and_by_gravity():
    """Five sevenths of g sin(slope); the normal force is m g cos(slope)."""
    slope = 0.3
    c, s = math.cos(slope), math.sin(slope)
    normal = (-s, 0, c)
    ball = Tree(
        "ball",
        [Body("ball", 3, (0, 0, 0), (sp.Rational(6, 5) * r**2,) * 3)],
        [Joint("j", "free", GROUND, "ball")],
        gravity=(0, 0, -g),
        constraints=[Rolling("floor", "ball", r, axis=None, normal=normal)],
    )
    system = derive(ball, ["constraint_forces"])
    p = {"r": 0.2, "g": 9.81}
    values = assemble(ball, {**p, "z_j": 0.3}).values
    found = rates(system, values, p)
    forces = outputs(system, values, p)
    assert forces["lambda_floor_n"] == pytest.approx(3 * 9.81 * c, rel=1e-12)
    down = 5 / 7 * 9.81 * s
    assert math.hypot(found["w_j_1"], found["w_j_2"]) * 0.2 == pytest.approx(down, rel=1e-12)
    grip = math.hypot(forces["lambda_floor_t1"], forces["lambda_floor_t2"])
    assert grip == pytest.approx(2 / 7 * 3 * 9.81 * s, rel=1e-12)


@pytest.mark.parametrize("way", [{}, {"multipliers": True}], ids=["elimination", "multipliers"])
def test_gears_add_inertias_by_squares_of_ratios(way):
    wheels = Tree(
        "gears",
        [Body(n, 1, (0, 0, 0), (i, i, i)) for n, i in (("one", 2), ("two", 3))],
        [Joint("a", "revolute", GROUND, "one", force=5), Joint("b", "revolute", GROUND, "two")],
        constraints=[Coupling("mesh", {"a": 4, "b": 1})],
    )
    system = derive(wheels, ["constraint_forces"], **way)
    values = {"q_a": 0.1, "q_b": 0.2, "u_a": 1.0, "u_b": -4.0}
    found = rates(system, values, {})
    expected = 5 / (2 + 16 * 3)
    assert found.get("u_a", expected) == pytest.approx(expected, rel=1e-14)
    assert found.get("u_b", -4 * expected) == pytest.approx(-4 * expected, rel=1e-14)
    assert outputs(system, values, {})["lambda_mesh"] == pytest.approx(-12 * expected, rel=1e-13)
    assert "sum_mesh" in system.invariant_names


@pytest.mark.parametrize("follower", ["a", "b"])
def test_the_follower_of_gears_is_no_state_whatever_the_ratio(follower):
    wheels = Tree(
        "gears",
        [Body(n, 1, (0, 0, 0), (2, 2, 2)) for n in ("one", "two")],
        [Joint("a", "revolute", GROUND, "one"), Joint("b", "revolute", GROUND, "two")],
        constraints=[Coupling("mesh", {"a": 100, "b": 1}, follower)],
    )
    assert f"u_{follower}" not in derive(wheels).state_names
    assert f"u_{follower}" in derive(wheels, independent=[f"u_{follower}"]).state_names
    with pytest.raises(InputError, match="the follower is not coupled"):
        Coupling("mesh", {"a": 4, "b": 1}, "c")


def test_a_crank_that_is_turned_by_an_equation():
    """No speed is left; the coordinates follow, and the force is what the motion takes."""
    t = sp.Symbol("t", real=True)
    pace = SpeedEquation("pace", sp.Symbol("u_a", real=True) - 3 - sp.sin(t))
    by_equation = four_bar(extra=(pace,))
    system = derive(by_equation, ["constraint_forces"], independent=())
    assert system.state_names == ("q_a", "q_b", "q_c")
    turn = 0.3 + 3 * t + 1 - sp.cos(t)
    driven = four_bar(motion=Motion(turn))
    other = derive(driven, ["constraint_forces"])
    at = 0.7
    angle = float(turn.subs(t, at))
    values = started(four_bar(), angle, 3 + math.sin(at))
    first, second = (outputs(s, values, LENGTHS, at) for s in (system, other))
    for name in ("lambda_pin_x", "lambda_pin_y"):
        assert first[name] == pytest.approx(second[name], rel=1e-11)
    assert first["u_c"] == pytest.approx(values["u_c"], rel=1e-13)
    with pytest.raises(InputError, match="wrong number"):
        derive(by_equation, independent=("u_a",))


# --- long runs, printed solutions --------------------------------------------------------------------


@pytest.mark.slow
@needs_compiler
def test_a_four_bar_linkage_stays_assembled():
    """Some 600 revolutions at 1e-6, to the resolution of the crank's angle; without projection not."""
    given = four_bar()
    system = derive(given)
    start = assemble(given, {**LENGTHS, **NEAR, "u_a": 200.0}, keep=("q_a", "u_a")).start(system)
    options = {"rtol": 1e-6, "method": "DOP853", "t_eval": np.linspace(0, 20, 40)}
    held = codegen.simulate(system, start, (0, 20), LENGTHS, **options)
    turns = held["q_a"][-1] / (2 * math.pi)
    assert turns > 500
    resolution = np.finfo(float).eps * abs(held["q_a"][-1])
    assert held.drift["closure_pin_x"].largest < 10 * resolution
    assert held.drift["closure_pin_y"].largest < 10 * resolution
    loose = codegen.simulate(system, start, (0, 20), LENGTHS, project=False, **options)
    assert loose.drift["closure_pin_x"].largest > 1e5 * resolution


@pytest.mark.slow
@needs_compiler
def test_andrews_squeezing_mechanism_agrees_with_its_printed_solution():
    given = squeezer()
    system = derive(given)
    start = assemble(given, SQUEEZER)
    assert not start.changes
    found = codegen.simulate(system, start.start(system), (0, 0.03), rtol=1e-11, method="DOP853")
    for name, value in SQUEEZED.items():
        assert found[name][-1] == pytest.approx(value, rel=1e-9)


@needs_compiler
def test_start_values_that_do_not_meet_the_constraints_are_refused():
    system = derive(four_bar())
    values = {**started(four_bar()), "q_b": 0.9}
    start = {n: values[n] for n in system.state_names}
    with pytest.raises(InputError, match="start values meet the constraints"):
        codegen.simulate(system, start, (0, 1), LENGTHS)


def test_speeds_that_stop_to_determine_the_others_stop_a_run():
    """The rocker turns back where crank and coupler are in line; there its speed says nothing."""
    given = four_bar()
    values = started(given, 0.3, 30.0)
    system = derive(given, independent=("u_c",))
    start = {n: values[n] for n in system.state_names}
    compiled = codegen.compile(system, "numpy")
    run = codegen.simulate(compiled, start, (0, 1), LENGTHS, "scipy:DOP853", 1e-6)
    assert run.status == 1
    assert "no longer determine the others" in run.message
    assert abs(math.sin(run.y_stop[1])) < 0.05


def test_a_helper_without_constraints_has_none_to_eliminate():
    free = replace(four_bar(), constraints=())
    with pytest.raises(InputError, match="without constraints"):
        derive(free, independent=("u_a",))
    assert derive(free).maintained == ()


def test_a_slider_is_a_prismatic_loop():
    """Crank and rod with a block that slides: the block's place by the cosine rule."""
    bodies = [Body("crank", 1, (0.5, 0, 0), (0, 0.1, 0.1)), Body("rod", 1, (1, 0, 0), (0, 0.3, 0.3)),
              Body("block", 2, (0, 0, 0), (1, 1, 1))]  # fmt: skip
    joints = [Joint("a", "revolute", GROUND, "crank"),
              Joint("b", "revolute", "crank", "rod", on_parent=Placement((1, 0, 0))),
              Joint("p", "revolute", "rod", "block", on_parent=Placement((2, 0, 0)))]  # fmt: skip
    given = Tree("slider", bodies, joints,
                 constraints=[Loop("rail", "prismatic", GROUND, "block", axis="x")])  # fmt: skip
    values = assemble(given, {"q_a": 0.8, "q_b": -1.0, "q_p": 0.2, "u_a": 1.5},
                      keep=("q_a", "u_a")).values  # fmt: skip
    lean = math.asin(math.sin(0.8) / 2)
    assert values["q_a"] + values["q_b"] == pytest.approx(-lean, abs=1e-13)
    assert values["q_a"] + values["q_b"] + values["q_p"] == pytest.approx(0, abs=1e-13)
    found = [rates(derive(given, **w), values, {})["u_a"] for w in WAYS.values()]
    assert found[0] == pytest.approx(found[1], rel=1e-12)
