"""Equilibria and steady motions found by search, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

import codegen
import eom
from codegen.linearisation import equilibria as nearby
from codegen.linearisation.equilibria import equilibria, equilibrium
from eom.errors import InputError
from eom.multibody import Body, Joint, Load, Tree, derive
from eom.quantities import TIME, Quantity
from eom.system import System

q, u, tau = sp.symbols("q u tau", real=True)
g, c, m, l = sp.symbols("g c m l", positive=True)
P = {"g": 9.81, "c": 0.1}


def pendulum(target="numpy"):
    system = System(
        "pendulum", (Quantity(q, "rad"), Quantity(u)), (u, tau - g * sp.sin(q) - c * u),
        (Quantity(g), Quantity(c)), (Quantity(tau),),
    )  # fmt: skip
    return codegen.compile(system, target)


def of(rates, **more):
    return codegen.compile(System.from_rates("s", rates, **more), "numpy")


def test_both_rests_of_a_pendulum_are_found_once_each():
    found = equilibria(pendulum(), {"q": 0.3}, P)
    assert sorted(abs(e.states["q"]) for e in found) == pytest.approx([0, math.pi], abs=1e-12)
    assert found[0].states["q"] == pytest.approx(0, abs=1e-12)  # nearest to the guess
    assert all(e.isolated and e.rank == e.unknowns == 2 for e in found)
    assert all(e.residual < 1e-13 and e.relative < 1e-14 for e in found)


@pytest.mark.parametrize("torque", [0.0, 3.0, -9.5])
def test_a_torque_turns_the_rest(torque):
    found = equilibrium(pendulum(), {"q": 0.1}, P, inputs={"tau": torque})
    assert math.sin(found.states["q"]) == pytest.approx(torque / 9.81, abs=1e-14)
    assert found.inputs == {"tau": torque}


def test_a_free_input_makes_a_family_and_trim_ends_it():
    family = equilibrium(pendulum(), {"q": 0.3}, P, free=["tau"])
    assert (family.kind, family.rank, family.unknowns) == ("family", 2, 3)
    (direction,) = family.directions
    slope = 9.81 * math.cos(family.states["q"])  # d tau / d q along the family
    assert direction["tau"] / direction["q"] == pytest.approx(slope, rel=1e-9)
    trimmed = equilibrium(pendulum(), {}, P, free=["tau"], hold={"q": 1.0})
    assert trimmed.isolated
    assert trimmed.inputs["tau"] == pytest.approx(9.81 * math.sin(1.0), rel=1e-14)
    assert trimmed.states["q"] == 1.0


def test_outputs_can_be_held():
    x, y = sp.symbols("x y", real=True)
    compiled = of({x: y, y: tau - x**3}, inputs=[tau], outputs={"cube": x**3})
    found = equilibrium(compiled, {"x": 1.0}, free=["tau"], hold={"cube": 8.0})
    assert found.states["x"] == pytest.approx(2.0, rel=1e-13)
    assert found.inputs["tau"] == pytest.approx(8.0, rel=1e-13)


def test_where_two_rests_meet_the_place_is_not_certain():
    """At the largest torque the two rests are one: a double root."""
    found = equilibrium(pendulum(), {"q": 1.3}, P, inputs={"tau": 9.81})
    assert found.states["q"] == pytest.approx(math.pi / 2, abs=1e-5)
    assert found.kind == "degenerate"
    x = sp.Symbol("x", real=True)
    assert equilibrium(of({x: x**2}), {"x": 1.0}).kind == "degenerate"


def test_where_there_is_none_that_is_reported():
    with pytest.raises(InputError, match="no equilibrium was found") as reported:
        equilibrium(pendulum(), {}, P, inputs={"tau": 9.82})
    assert "24 starts" in str(reported.value)
    x = sp.Symbol("x", real=True)
    with pytest.raises(InputError, match="no equilibrium"):
        equilibria(of({x: sp.exp(-x)}), {})  # the rate vanishes at infinity alone


def test_the_same_arguments_give_the_same_bytes():
    one, other = (equilibria(pendulum(), {"q": 2.0}, P, seed=3) for _ in range(2))
    assert repr(one) == repr(other)


def test_rest_at_once_and_after_many_turns():
    x = sp.Symbol("x", real=True)
    assert equilibrium(of({x: sp.sin(x)}), {"x": 0.0}, starts=1).states["x"] == 0.0
    far = equilibrium(of({x: x - sp.Integer(10) ** 7}), {}, starts=1)
    assert far.states["x"] == pytest.approx(1e7, rel=1e-15)


def cone():
    """A point mass on a rod, on a fork that turns about the vertical."""
    bodies = [Body("fork", inertia=(0, 0, 0)), Body("bob", m, (0, 0, -l))]
    joints = [Joint("azimuth", "revolute", "ground", "fork", "z"),
              Joint("lift", "revolute", "fork", "bob", "y", damping=c)]  # fmt: skip
    return codegen.compile(derive(Tree("cone", bodies, joints, gravity=(0, 0, -g))), "numpy")


def test_a_conical_pendulum():
    """cos(theta) = g / (l nu^2)."""
    values = {**P, "m": 2.0, "l": 0.5}
    found = equilibrium(
        cone(), {"q_lift": 1.0}, values, cyclic=["q_azimuth"], hold={"u_azimuth": 6.0}
    )
    assert math.cos(found.states["q_lift"]) == pytest.approx(9.81 / (0.5 * 36), rel=1e-12)
    assert found.rates == {"q_azimuth": 6.0}
    assert found.cyclic == ("q_azimuth",)
    assert found.isolated


def test_steady_motions_of_free_rates_are_families():
    values = {**P, "m": 2.0, "l": 0.5}
    found = equilibrium(cone(), {"q_lift": 1.0, "u_azimuth": 6.0}, values, cyclic=["q_azimuth"])
    assert found.kind == "family"
    (direction,) = found.directions
    nu, theta = found.states["u_azimuth"], found.states["q_lift"]
    assert math.cos(theta) == pytest.approx(9.81 / (0.5 * nu**2), rel=1e-10)
    slope = 2 / (nu * math.tan(theta))  # d theta / d nu
    assert direction["q_lift"] / direction["u_azimuth"] == pytest.approx(slope, rel=1e-8)


def test_quaternions_stay_of_unit_length():
    """A weight below its ball joint, from a quaternion that is not of length 1."""
    joint = Joint("ball", "spherical", "ground", "bob", damping=0.1)
    given = Tree("ball", [Body("bob", 2, (0, 0, -1), (1, 1, 0.5))], [joint], gravity=(0, 0, -10))
    compiled = codegen.compile(derive(given), "numpy")
    start = {"e_ball_0": 0.9, "e_ball_1": 0.3, "e_ball_2": -0.2, "e_ball_3": 0.5}
    found = equilibrium(compiled, start)
    e = [found.states[f"e_ball_{k}"] for k in range(4)]
    assert sum(x * x for x in e) == pytest.approx(1, rel=1e-14)
    assert abs(e[1]) + abs(e[2]) < 1e-9 or abs(e[0]) + abs(e[3]) < 1e-9
    assert found.kind == "family"
    (direction,) = found.directions  # it may be turned about the vertical
    axial = {n: direction.get(n, 0.0) for n in ("e_ball_0", "e_ball_3")}
    assert found.rank == 6
    assert sum(v * v for v in axial.values()) == pytest.approx(1, rel=1e-6) or abs(e[0]) < 1e-9


def test_a_quaternion_without_a_guess_starts_unturned():
    given = Tree("ball", [Body("bob", 2, (0, 0, -1), (1, 1, 0.5))],
                 [Joint("ball", "spherical", "ground", "bob")], gravity=(0, 0, -10))  # fmt: skip
    compiled = codegen.compile(derive(given), "numpy")
    assert equilibrium(compiled).states["e_ball_0"] == 1.0


def test_thrust_that_carries_a_weight():
    """Trim of a planar body with two thrusters: the sum carries it, the difference is zero."""
    left, right = sp.symbols("left right", real=True)
    loads = [
        Load("craft", (0, f, 0), point=(x, 0, 0), axes="body") for f, x in ((left, -1), (right, 1))
    ]
    joint = Joint("base", "planar", "ground", "craft")
    given = Tree("craft", [Body("craft", m, inertia=(1, 1, 1))], [joint],
                 gravity=(0, -g, 0), loads=loads, inputs=(left, right))  # fmt: skip
    compiled = codegen.compile(derive(given), "numpy")
    states = compiled.layout.results["rates"]
    held = {n: 0.0 for n in states if n.startswith(("x_", "y_"))}
    found = equilibrium(compiled, {}, {"m": 3.0, "g": 10.0}, free=["left", "right"], hold=held)
    assert found.inputs == pytest.approx({"left": 15.0, "right": 15.0}, rel=1e-12)
    assert found.isolated


@pytest.mark.parametrize("target", ["c", "python"])
def test_every_target_will_do(target):
    try:
        compiled = pendulum(target)
    except InputError:
        pytest.skip("no C compiler")
    assert equilibrium(compiled, {"q": 3.0}, P).states["q"] == pytest.approx(math.pi, abs=1e-12)


def test_equations_that_are_more_than_the_unknowns():
    x = sp.Symbol("x", real=True)
    compiled = of({x: x**2 - 4}, outputs={"y": x})
    assert equilibrium(compiled, {"x": 1.0}, hold={"y": 2.0}).states["x"] == pytest.approx(2)
    with pytest.raises(InputError, match="no equilibrium"):
        equilibrium(compiled, {"x": 1.0}, hold={"y": 3.0})


def test_newton_gives_up_where_numbers_end():
    problem = nearby.Problem(lambda z: z * np.nan, lambda z: (z * np.nan, np.eye(1)), np.ones(1))
    assert nearby.solve(problem, np.array([1.0])) is None


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"guess": {"p": 1.0}}, "'p'"),
        ({"guess": {"q": math.nan}}, "not finite"),
        ({"parameters": {"g": 1.0}}, "missing parameter"),
        ({"inputs": {"force": 1.0}}, "'force'"),
        ({"free": ["force"]}, "'force'"),
        ({"cyclic": ["p"]}, "'p'"),
        ({"cyclic": ["q"], "hold": {"q": 1.0}}, "not held"),
        ({"cyclic": ["q"], "inputs": {"tau": 1.0}, "guess": {"q": 0.1}}, "q is not cyclic"),
        ({"hold": {"p": 1.0}}, "cannot be held"),
        ({"hold": {"u": math.inf}}, "finite"),
        ({"hold": {"u": 0.0, "q": 0.0}}, "nothing is left"),
        ({"starts": 0}, "starts"),
        ({"spread": 0.0}, "starts"),
    ],
)
def test_wrong_arguments_are_refused(more, message):
    given = {"guess": {}, "parameters": P, **more}
    with pytest.raises(InputError, match=message):
        equilibrium(pendulum(), given.pop("guess"), given.pop("parameters"), **given)


def test_what_depends_on_time_is_refused():
    system = System.from_rates("s", {q: u, u: sp.sin(TIME) - q})
    with pytest.raises(InputError, match="depend on time"):
        equilibrium(codegen.compile(system, "numpy"))
    assert replace(system, rates=(u, -q)).time == TIME


def satellite():
    scene = eom.load_scene("gravity-gradient-satellite")
    return codegen.compile(scene.derive(), "numpy"), scene.parameter_values()


@pytest.mark.sparse(1)
@pytest.mark.parametrize("degrees", [3.0, 10.0])
def test_a_satellite_finds_the_equilibrium_beside_it(degrees):
    """The 24 attitudes with axes along those of the orbit, each from some degrees beside it."""
    compiled, values = satellite()
    draw, n = np.random.default_rng(1), values["n"]
    for rest in Rotation.create_group("O")[::3]:
        axis = draw.normal(size=3)
        turned = rest * Rotation.from_rotvec(np.radians(degrees) * axis / np.linalg.norm(axis))
        omega = turned.inv().apply([0, 0, n]) * (1 + 0.02 * draw.normal(size=3))
        x, y, z, w = turned.as_quat()
        guess = dict(zip(compiled.layout.results["rates"], (*omega, w, x, y, z), strict=True))
        found = equilibrium(compiled, guess, values).states
        there = Rotation.from_quat([found[k] for k in ("q1", "q2", "q3", "q0")])
        assert np.degrees((turned.inv() * there).magnitude()) < 1.01 * degrees
        assert found["q0"] * w + found["q1"] * x + found["q2"] * y + found["q3"] * z > 0


def test_values_that_rounding_hides_are_zero():
    compiled, values = satellite()
    scene = eom.load_scene("gravity-gradient-satellite")
    found = equilibrium(compiled, scene.initial_values(), values)
    still = {k: v for k, v in found.states.items() if k not in {"omega_3", "q0"}}
    assert still == dict.fromkeys(still, 0.0)
    assert found.isolated
    tiny = of({q: u, u: -q + sp.Rational(1, 10**12) - u})  # small, and not hidden
    assert equilibrium(tiny, {"q": 0.5}).states == {"q": pytest.approx(1e-12, rel=1e-12), "u": 0.0}


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_near_does_not_depend_on_units(unit):
    """Wells 1 apart, whose speeds are fast or slow: the one in whose neighbourhood the search begins."""
    w = sp.Float(unit, 60)
    compiled = of({q: u, u: -(w**2) * sp.sin(2 * sp.pi * q) - w * u})
    for start in (-2.1, 0.2, 3.15):
        found = equilibrium(compiled, {"q": start, "u": 0.1 * unit})
        assert found.states["q"] == pytest.approx(round(start), abs=1e-9)


def test_a_balanced_matrix_has_equal_sums_and_no_units():
    draw = np.random.default_rng(3)
    A = draw.normal(size=(5, 5))
    units = 10.0 ** np.array([-9, 0, 4, 7, -3])
    d, other = nearby.balanced(A), nearby.balanced(units[:, None] * A / units)
    assert other / units / (other[0] / units[0]) == pytest.approx(d / d[0], rel=1e-2)
    size = np.abs(A) * d / d[:, None]
    np.fill_diagonal(size, 0)
    assert size.sum(axis=0) == pytest.approx(size.sum(axis=1), rel=1e-2)


def test_where_a_cyclic_state_must_run_that_is_said():
    spin = sp.Symbol("spin", real=True)
    compiled = of({q: 3 + u, u: -u, spin: sp.Integer(2)}, outputs={"o": q})
    with pytest.raises(InputError, match="no equilibrium") as reported:
        equilibrium(compiled)
    assert "--cyclic q --cyclic spin" in reported.value.hint
    with pytest.raises(InputError) as reported:
        equilibrium(of({q: u, u: 1 + u**2}))  # no state that runs would help
    assert "--cyclic" not in reported.value.hint
