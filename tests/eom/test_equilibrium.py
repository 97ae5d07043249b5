"""Exact tests of stated equilibria and steady motions."""

import doctest

import pytest
import sympy as sp

import eom.mechanics.equilibrium
from eom.errors import InputError
from eom.exact.identity import vanishes
from eom.mechanics.equilibrium import is_equilibrium, remainders
from eom.mechanics.rigidbody import free_rigid_body
from eom.multibody import Body, Joint, Placement, Tree, derive
from eom.quantities import Quantity
from eom.system import System

m, l, g, k, J = sp.symbols("m l g k J", positive=True)


def test_example():
    assert doctest.testmod(eom.mechanics.equilibrium).failed == 0


def double_pendulum():
    links = [Body(f"link{n}", m, (0, 0, -l), (J, J, J)) for n in (1, 2)]
    end = Placement((0, 0, -2 * l))
    joints = [Joint("one", "revolute", "ground", "link1", "y", motor=True),
              Joint("two", "revolute", "link1", "link2", "y", on_parent=end)]  # fmt: skip
    return derive(Tree("double", links, joints, gravity=(0, 0, -g)))


@pytest.mark.parametrize("one", [0, sp.pi])
@pytest.mark.parametrize("two", [0, sp.pi])
def test_four_equilibria_of_a_double_pendulum(one, two):
    point = {"q_one": one, "q_two": two, "u_one": 0, "u_two": 0, "tau_one": 0}
    assert is_equilibrium(double_pendulum(), point)


def test_what_is_left_is_what_must_hold():
    """Both links in line at an angle a need a torque 4 m g l sin a, and the second one more."""
    a, tau = sp.symbols("a tau_one", real=True)
    point = {"q_one": a, "q_two": -a, "u_one": 0, "u_two": 0}
    left = remainders(double_pendulum(), point)
    assert set(left) == {"u_one", "u_two"}
    needed = 3 * m * g * l * sp.sin(a)
    assert all(vanishes(e.subs(tau, needed)) for e in left.values())
    assert is_equilibrium(double_pendulum(), {**point, "tau_one": needed})


def test_a_steady_precession_runs_in_one_angle():
    """A conical pendulum of a point mass: cos(theta) = g / (l nu^2); the azimuth is cyclic."""
    theta, nu = sp.symbols("theta nu", positive=True)
    bodies = [Body("fork"), Body("bob", m, (0, 0, -l))]
    joints = [Joint("azimuth", "revolute", "ground", "fork", "z"),
              Joint("lift", "revolute", "fork", "bob", "y")]  # fmt: skip
    system = derive(Tree("cone", bodies, joints, gravity=(0, 0, -g)))
    point = {"q_lift": theta, "u_lift": 0, "u_azimuth": nu}
    (left,) = remainders(system, point, ["q_azimuth"]).values()
    assert vanishes(left.subs(g, l * nu**2 * sp.cos(theta)))
    assert not vanishes(left)
    assert not is_equilibrium(system, {**point, "q_azimuth": 0})


def test_a_state_that_others_depend_on_is_not_cyclic():
    assert "u_one" in remainders(double_pendulum(), {"u_one": 0, "u_two": 0}, ["q_one", "q_two"])


def test_floats_are_what_they_are():
    spins = {"omega_1": 0.1, "omega_2": 0.0, "omega_3": 0.0}
    assert is_equilibrium(free_rigid_body(), spins)
    assert not is_equilibrium(free_rigid_body(), {**spins, "omega_2": 1e-300})


def massive():
    x, v = sp.symbols("x v")
    M = sp.ImmutableMatrix([[1, 0], [0, m]])
    return System(
        "s", (Quantity(x), Quantity(v)), (v, -k * x), (Quantity(k), Quantity(m)), mass_matrix=M
    )


def test_mass_matrices_do_not_matter_at_rest():
    assert is_equilibrium(massive(), {"x": 0, "v": 0})
    assert list(remainders(massive(), {"x": 1, "v": 0})) == ["v"]


@pytest.mark.parametrize(
    ("values", "cyclic", "message"),
    [
        ({"y": 0}, (), "'y'"),
        ({"x": "0"}, (), "not a number"),
        ({}, ("z",), "'z'"),
        ({"x": 0}, ("x",), "cyclic"),
        ({"v": 0}, ("x",), "mass matrix"),
    ],
)
def test_wrong_points_are_refused(values, cyclic, message):
    with pytest.raises(InputError, match=message):
        remainders(massive(), values, cyclic)
