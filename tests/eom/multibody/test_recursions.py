"""Recursions against each other with exact fractions, and against other derivations."""

import math
import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.ir import scalars
from codegen.ir.program import Builder
from eom.kinematics.coordinates import SEQUENCES, quaternion, rotation_sequence
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.algebra.spatial import cross, matrix_of, plus, times, transposed
from eom.multibody.model.bodies import Body, Joint, Placement
from eom.multibody.model.joints import KINDS, QUATERNION
from eom.multibody.model.model import Tree
from eom.multibody.recursion.lumped_tree import lumped_tree
from eom.multibody.recursion.motion import coordinate_rates, places, poses
from eom.multibody.recursion.quantities import flow, jacobian, kinetic_energy, momentum
from eom.multibody.recursion.recursions import forward_dynamics, inverse_dynamics, mass_matrix
from tests.eom.multibody import trees
from tests.eom.multibody.trees import EXACT, MOVING, state, tree

seeds = st.integers(0, 10**6)


def exact(given):
    return lumped_tree(given, lambda x: x, EXACT)


def forces(given, seed):
    draw = random.Random(seed)
    return [Fraction(draw.randint(-9, 9), 2) for j in given.ordered for _ in j.speeds]


@given(seeds, st.integers(1, 5))
def test_forward_dynamics_undoes_inverse_dynamics_exactly(seed, count):
    given = tree(seed, count)
    lumped, (q, u), tau = exact(given), state(given, seed), forces(given, seed)
    udot = forward_dynamics(lumped, q, u, tau, EXACT)
    assert inverse_dynamics(lumped, q, u, udot, EXACT) == tau


@given(seeds, st.integers(1, 5))
def test_mass_matrix_times_accelerations_and_bias_are_the_forces(seed, count):
    given = tree(seed, count)
    lumped, (q, u), tau = exact(given), state(given, seed), forces(given, seed)
    M = mass_matrix(lumped, q, EXACT)
    h = inverse_dynamics(lumped, q, u, [0] * len(u), EXACT)
    udot = forward_dynamics(lumped, q, u, tau, EXACT)
    assert [row[k] for k, row in enumerate(M)] != []
    assert [list(column) for column in zip(*M, strict=True)] == M
    assert [sum(map(lambda a, b: a * b, row, udot)) + b for row, b in zip(M, h, strict=True)] == tau


@given(seeds, st.integers(1, 4))
def test_kinetic_energy_is_half_the_mass_matrix_between_the_speeds(seed, count):
    given = tree(seed, count)
    lumped, (q, u) = exact(given), state(given, seed)
    M = mass_matrix(lumped, q, EXACT)
    twice = sum(a * m * b for a, row in zip(u, M, strict=True) for m, b in zip(row, u, strict=True))
    assert kinetic_energy(flow(lumped, q, u, EXACT), u) == Fraction(twice) / 2


@given(seeds, st.integers(1, 4))
def test_jacobians_give_velocities_of_points(seed, count):
    given = tree(seed, count)
    lumped, (q, u) = exact(given), state(given, seed)
    moving = flow(lumped, q, u, EXACT)
    for name, seat in lumped.seats.items():
        if seat.part < 0:
            continue
        angular, linear = jacobian(lumped, q, name, (1, -2, 3), EXACT)
        (R, _), (w, v) = moving.poses[seat.part], moving.velocities[seat.part]
        here = plus(v, cross(w, seat.point((1, -2, 3))))
        for columns, expected in ((angular, w), (linear, here)):
            found = [sum(c[k] * x for c, x in zip(columns, u, strict=True)) for k in range(3)]
            assert found == list(times(transposed(R), expected))


def test_kinds_of_joints_are_all_drawn():
    drawn = {j.kind for seed in range(30) for j in tree(seed, 5).ordered}
    assert drawn == set(MOVING)


@pytest.mark.parametrize("kind", MOVING)
@pytest.mark.parametrize("attitude", [QUATERNION, "3-1-2", "3-1-3"])
def test_velocities_are_derivatives_of_places(kind, attitude):
    """The pose of a body, moved by q', against S u: by the limit in 50 digits."""
    if attitude != QUATERNION and not KINDS[kind].attitude:
        pytest.skip("no attitude")
    import mpmath

    work = Numbers(mpmath.sin, mpmath.cos)
    joint = Joint("j", kind, "ground", "b", axis=(1, 2, 2), second_axis=(2, 1, -2), pitch=Fraction(1, 3),
                  attitude=attitude)  # fmt: skip
    with mpmath.workdps(50):
        lumped = lumped_tree(Tree("t", [Body("b", 1, (0, 0, 0), (1, 2, 2.5))], [joint]),
                         lambda x: mpmath.mpf(x.numerator) / x.denominator if x not in (0, 1, -1) else x,
                         work)  # fmt: skip
        q = [mpmath.mpf(n) / 10 for n in (3, -5, 7, 2, 8, 4, 1)[: lumped.coordinates]]
        if kind in {"spherical", "free"} and attitude == QUATERNION:
            norm = mpmath.sqrt(sum(x * x for x in q[-4:]))
            q[-4:] = [x / norm for x in q[-4:]]
        u = [mpmath.mpf(n) / 3 for n in (2, -1, 4, 3, -2, 1)[: lumped.speeds]]
        rates = coordinate_rates(lumped, q, u, work)
        h = mpmath.mpf(10) ** -15
        before, after = (
            poses(places(lumped, [x + s * r for x, r in zip(q, rates, strict=True)], work), work)[0]
            for s in (-h, h)
        )
        R, _ = poses(places(lumped, q, work), work)[0]
        (velocity,) = flow(lumped, q, u, work).velocities
        dR = [
            [(b - a) / (2 * h) for a, b in zip(x, y, strict=True)]
            for x, y in zip(before[0], after[0], strict=True)
        ]
        for k in range(3):
            column = [row[k] for row in dR]  # dR/dt = -omega x R
            expected = [-x for x in cross(velocity.angular, [row[k] for row in R])]
            assert all(abs(a - b) < 1e-25 for a, b in zip(column, expected, strict=True))
        dx = [(b - a) / (2 * h) for a, b in zip(before[1], after[1], strict=True)]
        expected = times(transposed(R), velocity.linear)
        assert all(abs(a - b) < 1e-25 for a, b in zip(dx, expected, strict=True))


@pytest.mark.parametrize("attitude", [QUATERNION, *SEQUENCES])
def test_attitudes_are_those_of_kinematics(attitude):
    given = Tree("t", [Body("b", 1, (0, 0, 0), (1, 1, 1))],
                 [Joint("j", "spherical", "ground", "b", attitude=attitude)])  # fmt: skip
    lumped, (q, _) = exact(given), state(given, 3)
    (place,) = places(lumped, q, EXACT)
    chosen = quaternion() if attitude == QUATERNION else rotation_sequence(attitude)
    known = dict(zip([c.symbol for c in chosen.coordinates], q, strict=True))
    if attitude != QUATERNION:
        known = {f(a): sp.Rational(str(g(t))) for a, t in known.items()
                 for f, g in ((sp.sin, EXACT.sin), (sp.cos, EXACT.cos))}  # fmt: skip
    expected = chosen.matrix.xreplace({k: sp.Rational(str(v)) for k, v in known.items()})
    assert sp.Matrix(matrix_of(place.rotation)) == sp.Matrix(expected)


def test_a_body_of_revolution_stays_behind_its_last_turn():
    def wheel(moments):
        bodies = [Body("hub", 2, (1, 2, 3), (3, 4, 5)), Body("wheel", 1, (0, 0, 2), moments)]
        joints = [
            Joint("first", "universal", "ground", "hub", on_parent=Placement((1, 0, 2))),
            Joint("second", "revolute", "hub", "wheel", on_parent=Placement((0, 3, 1))),
        ]
        return Tree("t", bodies, joints, gravity=(0, 0, -9))

    symmetric = exact(wheel((2, 2, 3)))
    assert [p.spins for p in symmetric.parts] == [False, True]
    assert not exact(wheel((2, 1, 3))).parts[1].spins
    q, u = (
        [Fraction(1, 3), Fraction(2, 5), Fraction(1, 2)],
        [Fraction(3), Fraction(-2), Fraction(5)],
    )
    tau = [Fraction(1), Fraction(4), Fraction(-1)]
    whole = lumped_tree(wheel((2, 2, 3)), lambda x: x, EXACT)
    turning = type(whole)(
        tuple(trees.unspun(p) for p in whole.parts), whole.seats, whole.gravity,
        whole.coordinates, whole.speeds,
    )  # fmt: skip
    assert forward_dynamics(symmetric, q, u, tau, EXACT) == forward_dynamics(
        turning, q, u, tau, EXACT
    )
    assert flow(symmetric, q, u, EXACT).poses != flow(turning, q, u, EXACT).poses
    assert momentum(flow(symmetric, q, u, EXACT)) == momentum(flow(turning, q, u, EXACT))


def operations(given):
    b = Builder()
    work = Numbers(scalars.sin, scalars.cos)
    lumped = lumped_tree(given, lambda x: x, work)
    x = scalars.scalars(b, "state", lumped.coordinates + lumped.speeds)
    q, u = x[: lumped.coordinates], x[lumped.coordinates :]
    tau = scalars.scalars(b, "input", lumped.speeds)
    found = scalars.program(b, {"f": forward_dynamics(lumped, q, u, tau, work)})
    return sum(found.counts().values())


def pendulum(count, axis, tilt=((1, 0, 0), (0, 1, 0), (0, 0, 1))):
    bodies = [Body(f"b{k}", 1 + k, (0, 0, -1), (2, 3, 4)) for k in range(count)]
    joints = [
        Joint(f"j{k}", "revolute", f"b{k - 1}" if k else "ground", f"b{k}", axis,
              on_parent=Placement((0, 0, -2 * min(k, 1)), tilt))
        for k in range(count)
    ]  # fmt: skip
    return Tree("pendulum", bodies, joints, gravity=(0, 0, -9))


def test_a_plane_chain_costs_half_of_one_in_space():
    crooked = ((1, 0, 0), (0, 0, 1), (0, -1, 0))
    assert operations(pendulum(6, "y")) * 2 < operations(pendulum(6, "y", crooked))


def arm(last, extra=()):
    """Two links, the second on a joint that is given, and what is fixed to the first."""
    bodies = [Body("a", 1, (0, 0, -1), (2, 3, 4)), Body("b", 2, (1, 0, 0), (1, 1, 1))]
    joints = [Joint("j", "revolute", "ground", "a", "y"), last]
    joints += [
        Joint(f"to_{b.name}", "fixed", "a", b.name, on_parent=Placement((1, 2, 3))) for b in extra
    ]
    return Tree("t", [*bodies, *extra], joints, gravity=(0, 0, -9))


def test_what_is_fixed_costs_nothing():
    joint = Joint("k", "revolute", "a", "b", "x")
    lump = Body("lump", 1, (1, 1, 1), (3, 1, 3))
    heavier = arm(joint, (lump,))
    assert len(exact(heavier).parts) == 2
    both = heavier.body["a"]
    assert operations(heavier) <= operations(replace(arm(joint), bodies=(
        replace(both, mass=2, centre=(1, 3, 5), inertia=((20, 1, 2), (1, 20, 3), (2, 3, 20))),
        heavier.body["b"],
    )))  # fmt: skip


def test_a_locked_joint_is_a_fixed_one():
    locked = exact(arm(Joint("k", "revolute", "a", "b", "x", motion=0)))
    fixed = exact(arm(Joint("k", "fixed", "a", "b")))
    q, u, tau = [Fraction(1, 2)], [Fraction(3)], [Fraction(1)]
    found = forward_dynamics(locked, [*q, 0], [*u, 0], [*tau, 0], EXACT, {1: 0})
    assert found[:1] == forward_dynamics(fixed, q, u, tau, EXACT)


def test_prescribed_accelerations_take_the_forces_of_inverse_dynamics():
    given = tree(7, 4)
    lumped, (q, u), tau = exact(given), state(given, 7), forces(given, 7)
    udot = forward_dynamics(lumped, q, u, tau, EXACT)
    part = lumped.parts[1]
    driven = type(lumped)(
        tuple(trees.driven(p) if p is part else p for p in lumped.parts), lumped.seats, lumped.gravity,
        lumped.coordinates, lumped.speeds,
    )  # fmt: skip
    given_speeds = {k: udot[k] for k in range(part.speeds.start, part.speeds.stop)}
    free = [0 if k in given_speeds else t for k, t in enumerate(tau)]
    assert forward_dynamics(driven, q, u, free, EXACT, given_speeds) == udot


def test_massless_links_between_heavy_ones():
    bodies = [Body("cross"), Body("bob", 2, (0, 0, -1), (1, 1, Fraction(1, 2)))]
    joints = [
        Joint("a", "revolute", "ground", "cross", "x"),
        Joint("b", "revolute", "cross", "bob", "y"),
    ]
    two = exact(Tree("t", bodies, joints, gravity=(0, 0, -9)))
    one = exact(
        Tree(
            "t",
            bodies[1:],
            [Joint("a", "universal", "ground", "bob", "x", second_axis="y")],
            gravity=(0, 0, -9),
        )
    )
    q, u, tau = (
        [Fraction(1, 3), Fraction(-1, 4)],
        [Fraction(2), Fraction(3)],
        [Fraction(1), Fraction(0)],
    )
    assert forward_dynamics(two, q, u, tau, EXACT) == forward_dynamics(one, q, u, tau, EXACT)


@pytest.mark.parametrize("seed", range(12))
def test_zero_state_and_straight_configuration(seed):
    given = tree(seed, 4, attitudes=(QUATERNION, "3-2-1"))
    work = Numbers(math.sin, math.cos)
    lumped = lumped_tree(given, lambda x: x if x in {0, 1, -1} else float(x), work)
    names = [c.name for j in given.ordered for c in j.coordinates]
    q = [float(n.startswith("e_") and n.endswith("_0")) for n in names]
    u = [0.0] * lumped.speeds
    assert np.all(np.isfinite(forward_dynamics(lumped, q, u, u, work)))
