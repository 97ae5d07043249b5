"""Functions of a tree: closed forms of the two-link arm, each other, energies; symbolic, compiled."""

import random
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import codegen
from eom.errors import InputError
from eom.multibody import (
    Body,
    Coupling,
    Joint,
    Placement,
    Tree,
    centre_of_mass,
    energies,
    forward_dynamics,
    inverse_dynamics,
    jacobian,
    mass_matrix,
    regressor,
)
from tests.eom.multibody.trees import state, tree

m1, m2, l1, r1, r2, J1, J2, g = sp.symbols("m1 m2 l1 r1 r2 J1 J2 g", positive=True)
q1, q2, u1, u2, a1, a2 = sp.symbols("q_one q_two u_one u_two dot_u_one dot_u_two", real=True)
ARM = Tree(
    "arm",
    (
        Body("upper", m1, (r1, 0, 0), (J1, J1, J1)),
        Body("fore", m2, (r2, 0, 0), (J2, J2, J2)),
    ),
    (
        Joint("one", "revolute", "ground", "upper", axis="z"),
        Joint("two", "revolute", "upper", "fore", axis="z", on_parent=Placement((l1, 0, 0))),
    ),
    gravity=(0, -g, 0),
)  # fmt: skip
MORE = [pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 6)]
SLOW = [
    pytest.param(seed, target, marks=pytest.mark.slow)
    for seed, target in enumerate(("numpy", "python", "c", "numpy"), 1)
]
KINDS = ("revolute", "prismatic", "universal", "planar", "helical", "spherical", "free")


def same(found, expected):
    squares = {sp.sin(q) ** 2: 1 - sp.cos(q) ** 2 for q in (q1, q2)}
    gaps = sp.expand_trig(sp.Matrix(found) - sp.Matrix(expected)).expand()
    return all(gap.subs(squares).expand() == 0 for gap in gaps)


def test_the_two_link_arm_of_the_books():
    """Spong, Hutchinson and Vidyasagar, Robot Modeling and Control (2006), sec. 7.4: planar elbow."""
    h = m2 * l1 * r2
    d12 = m2 * r2**2 + h * sp.cos(q2) + J2
    d11 = m1 * r1**2 + m2 * l1**2 + 2 * h * sp.cos(q2) + m2 * r2**2 + J1 + J2
    M = sp.Matrix([[d11, d12], [d12, m2 * r2**2 + J2]])
    assert same(mass_matrix(ARM).expressions, M)
    c = sp.Matrix([-h * sp.sin(q2) * (2 * u1 * u2 + u2**2), h * sp.sin(q2) * u1**2])
    w2 = m2 * r2 * g * sp.cos(q1 + q2)
    weight = sp.Matrix([(m1 * r1 + m2 * l1) * g * sp.cos(q1) + w2, w2])
    tau = M * sp.Matrix([a1, a2]) + c + weight
    assert same(inverse_dynamics(ARM).expressions, tau)
    end = sp.Matrix([l1 * sp.cos(q1), l1 * sp.sin(q1)])
    tip = end + r2 * sp.Matrix([sp.cos(q1 + q2), sp.sin(q1 + q2)])
    J = jacobian(ARM, "fore", (r2, 0, 0)).expressions
    assert same(J[3:5, :], tip.jacobian([q1, q2]))
    assert J[:3, :] == sp.Matrix([[0, 0], [0, 0], [1, 1]])
    first = r1 * sp.Matrix([sp.cos(q1), sp.sin(q1)])
    assert same(centre_of_mass(ARM).expressions[:2, :], (m1 * first + m2 * tip) / (m1 + m2))
    T, V = energies(ARM).expressions
    speeds = sp.Matrix([u1, u2])
    assert same([T], [(speeds.T * M * speeds)[0] / 2])
    assert same([V], [g * (m1 * first[1] + m2 * tip[1])])


def valued(function, target, q, u, inputs=()):
    compiled = codegen.compile(function.system, target)
    values = compiled.outputs(0.0, np.array([*q, *u]), np.zeros(0), np.array([*inputs], float))
    return np.array(function.array(values), float)


def drawn(seed, count=2):
    given = tree(seed, count, kinds=KINDS)
    q, u = ([float(x) for x in group] for group in state(given, seed))
    draw = random.Random(seed)
    return given, q, u, [draw.uniform(-2, 2) for _ in u]


@pytest.mark.parametrize(("seed", "target"), [(0, "c"), *SLOW])
def test_inverse_and_forward_dynamics_undo_each_other(seed, target):
    given, q, u, udot = drawn(seed)
    tau = valued(inverse_dynamics(given), target, q, u, udot)
    found = valued(forward_dynamics(given), target, q, u, tau)
    np.testing.assert_allclose(found, udot, rtol=1e-9, atol=1e-9)
    M = valued(mass_matrix(given), target, q, u)
    still = valued(inverse_dynamics(given), target, q, u, np.zeros(len(u)))
    np.testing.assert_allclose(M @ udot + still, tau, rtol=1e-12, atol=1e-12 * np.abs(tau).max())


@pytest.mark.parametrize("seed", [0, *MORE])
def test_the_mass_matrix_is_the_hessian_of_the_kinetic_energy(seed):
    """T is quadratic in the speeds: its second differences are exact but for rounding."""
    given, q, u, _ = drawn(seed)
    function = energies(given)
    compiled = codegen.compile(function.system, "numpy")

    def kinetic(speeds):
        return compiled.outputs(0.0, np.array([*q, *speeds]), np.zeros(0), np.zeros(0))[0]

    M, n = valued(mass_matrix(given), "numpy", q, u), len(u)
    unit = np.eye(n)
    H = [[kinetic(unit[i] + unit[j]) - kinetic(unit[i]) - kinetic(unit[j]) for j in range(n)]
         for i in range(n)]  # fmt: skip
    np.testing.assert_allclose(M, H, rtol=1e-12, atol=1e-12 * np.abs(M).max())
    np.testing.assert_allclose(M, M.T, rtol=0, atol=0)


@pytest.mark.parametrize("seed", [0, *MORE])
def test_regressor_times_parameters_is_inverse_dynamics(seed):
    given, q, u, udot = drawn(seed)
    bare = replace(
        given, loads=(), springs=(), rotors=(),
        joints=tuple(replace(j, stiffness=0, force=0, motor=False) for j in given.joints),
    )  # fmt: skip
    Y = regressor(bare, armature=True, damping=True)
    tau = valued(inverse_dynamics(bare), "numpy", q, u, udot)
    found = valued(Y, "numpy", q, u, udot) @ [float(x) for x in Y.parameters(bare)]
    np.testing.assert_allclose(found, tau, rtol=1e-12, atol=1e-12 * np.abs(tau).max())


def test_constraints_and_prescribed_motions():
    bound = replace(ARM, constraints=(Coupling("gear", {"one": 1, "two": 2}),))
    assert mass_matrix(bound).expressions == mass_matrix(ARM).expressions
    with pytest.raises(InputError, match="with constraints"):
        forward_dynamics(bound)
    first, second = ARM.joints
    driven = replace(ARM, joints=(replace(first, motion=(0,)), second))
    for function in (mass_matrix, inverse_dynamics, forward_dynamics, centre_of_mass, energies):
        with pytest.raises(InputError, match="all coordinates and speeds"):
            function(driven)
    with pytest.raises(InputError, match="unknown body"):
        jacobian(ARM, "hand")
