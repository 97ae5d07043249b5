"""Equilibria and steady motions found by search, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen import newton
from codegen.equilibria import equilibria, equilibrium
from eom.errors import InputError
from eom.multibody import Body, Joint, Load, Tree, derive
from eom.system import TIME, Quantity, System

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


def test_where_there_is_none_that_is_told():
    with pytest.raises(InputError, match="no equilibrium was found") as told:
        equilibrium(pendulum(), {}, P, inputs={"tau": 9.82})
    assert "24 starts" in str(told.value)
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
    problem = newton.Problem(lambda z: z * np.nan, lambda z: (z * np.nan, np.eye(1)), np.ones(1))
    assert newton.solve(problem, np.array([1.0])) is None


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
