"""Reactions against Newton's law for each single body, textbooks and SymPy's auxiliary speeds."""

import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from sympy.physics.mechanics import (
    KanesMethod,
    Point,
    ReferenceFrame,
    RigidBody,
    dynamicsymbols,
    inertia,
)

import codegen
from codegen.frontend.lower import lower_system
from codegen.ir.passes import prune
from eom.errors import InputError
from eom.exact.identity import equal, vanishes
from eom.multibody import Body, Joint, Load, Motion, Placement, Reaction, Tree, derive, reaction
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.algebra.spatial import cross, minus, plus, scaled, times, transposed
from eom.multibody.model.joints import KINDS
from eom.multibody.recursion.lumped_tree import lumped_tree
from eom.multibody.recursion.motion import coordinate_rates
from eom.multibody.recursion.quantities import flow
from eom.multibody.recursion.recursions import forward_dynamics
from eom.multibody.system.reactions import Wrenches
from eom.quantities import TIME
from tests.draws import examples
from tests.eom.multibody.trees import EXACT, number, state, tree
from tests.eom.rows import only

seeds = st.integers(0, 10**6)
m, l, J, g, k, c, M = sp.symbols("m l J g k c M", positive=True)


class Rate:
    """A value and its rate: numbers a + b e with e^2 = 0, exact."""

    def __init__(self, a, b=0):
        self.a, self.b = a, b

    def __add__(self, other):
        other = rate(other)
        return Rate(self.a + other.a, self.b + other.b)

    __radd__ = __add__

    def __neg__(self):
        return Rate(-self.a, -self.b)

    def __sub__(self, other):
        return self + -rate(other)

    def __rsub__(self, other):
        return rate(other) + -self

    def __mul__(self, other):
        other = rate(other)
        return Rate(self.a * other.a, self.a * other.b + self.b * other.a)

    __rmul__ = __mul__


def names(tree):
    return [b.name for b in tree.bodies]


def rate(x):
    return x if isinstance(x, Rate) else Rate(x)


RATES = Numbers(
    lambda x: Rate(EXACT.sin(x.a), EXACT.cos(x.a) * x.b),
    lambda x: Rate(EXACT.cos(x.a), -EXACT.sin(x.a) * x.b),
)


def moving(given, seed):
    """Coordinates, speeds and accelerations under random forces, exact."""
    lumped = lumped_tree(given, lambda x: x, EXACT)
    draw = random.Random(seed)
    q, u = state(given, seed)
    tau = [number(draw) for _ in u]
    return q, u, forward_dynamics(lumped, q, u, tau, EXACT), tau


def wrenches(given, q, u, udot):
    return Wrenches(given, lambda x: x, EXACT, (q, u, udot), [j.name for j in given.joints])


def momenta(given, q, u, udot):
    """Rates of momentum, and of angular momentum about the ground's origin, of the single bodies."""
    every = [j.name for j in given.joints]
    lumped = lumped_tree(given, lambda x: x, RATES, names(given), apart=every)
    rates = coordinate_rates(lumped_tree(given, lambda x: x, EXACT), q, u, EXACT)
    moved = flow(lumped, [*map(Rate, q, rates)], [*map(Rate, u, udot)], RATES)
    found = {}
    for part, (R, x), own in zip(lumped.parts, moved.poses, moved.momenta, strict=True):
        p, L = (times(transposed(R), v) for v in (own.linear, own.angular))
        both = (p, plus(L, cross(x, p)))
        found[part.name] = [[rate(e).b for e in v] for v in both]
    return found


def acting(given, q, body):
    """Gravity and loads on a body, and where its origin is: force, moment about the ground's origin."""
    every = [j.name for j in given.joints]
    lumped = lumped_tree(given, lambda x: x, EXACT, names(given), apart=every)
    poses = flow(lumped, q, [0] * lumped.speeds, EXACT).poses
    seat = lumped.seats[body.name]
    R, x = poses[seat.part]

    def turn(v, axes):
        return v if axes == "ground" else times(transposed(R), times(transposed(seat.rotation), v))

    pulls = [(scaled(body.mass, given.gravity), (0, 0, 0), body.centre)]
    pulls += [
        (turn(load.force, load.axes), turn(load.torque, load.axes), load.point)
        for load in given.loads
        if load.body == body.name
    ]
    force, moment = (0, 0, 0), (0, 0, 0)
    for f, n, point in pulls:
        at = plus(x, times(transposed(R), seat.point(point)))
        force, moment = plus(force, f), plus(moment, plus(n, cross(at, f)))
    return force, moment, x


@examples(25)
@given(seeds, st.integers(1, 4))
def test_newton_and_euler_hold_for_every_single_body_exactly(seed, count):
    """The reactions on a body, its loads and its weight are its rates of momentum."""
    given = tree(seed, count, kinds=tuple(KINDS))
    q, u, udot, _ = moving(given, seed)
    through, rates = wrenches(given, q, u, udot), momenta(given, q, u, udot)
    for body in given.bodies:
        force, moment, x = acting(given, q, body)
        for joint in given.joints:
            if body.name in {joint.child, joint.parent}:
                about = reaction(joint, "origin", body=body.name)
                torque, push = through.of(about)
                if joint.parent == body.name:
                    torque, push = scaled(-1, torque), scaled(-1, push)
                at = plus(x, times(transposed(pose(given, q, body.name)), origin(given, body.name)))
                force = plus(force, push)
                moment = plus(moment, plus(torque, cross(at, push)))
        assert [list(force), list(moment)] == rates[body.name]


def bones_of(given):
    return lumped_tree(
        given, lambda x: x, EXACT, names(given), apart=[j.name for j in given.joints]
    )


def pose(given, q, name):
    lumped = bones_of(given)
    return flow(lumped, q, [0] * lumped.speeds, EXACT).poses[lumped.seats[name].part][0]


def origin(given, name):
    return bones_of(given).seats[name].origin


@given(seeds, st.integers(1, 5))
def test_work_of_a_reaction_is_that_of_the_generalised_forces(seed, count):
    """Only what acts in a joint does work at its speeds: S^T of the reaction, and the rotors."""
    given = tree(seed, count, kinds=tuple(KINDS))
    q, u, udot, tau = moving(given, seed)
    assert wrenches(given, q, u, udot).along() == tau


@examples(25)
@given(seeds, st.integers(2, 4))
def test_points_and_axes(seed, count):
    """T_P = T_O + (O - P) x F, and components by the attitude of the bodies."""
    given = tree(seed, count, kinds=tuple(KINDS))
    q, u, udot, _ = moving(given, seed)
    draw = random.Random(seed)
    through, joint = wrenches(given, q, u, udot), draw.choice(given.joints)
    body, point = draw.choice(given.bodies).name, [number(draw) for _ in range(3)]
    lumped = bones_of(given)
    poses = flow(lumped, q, u, EXACT).poses

    def place(name, at):
        if name == "ground":
            return at, ((1, 0, 0), (0, 1, 0), (0, 0, 1))
        seat = lumped.seats[name]
        R, x = poses[seat.part]
        C = [times(transposed(R), row) for row in seat.rotation]
        return plus(x, times(transposed(R), seat.point(at))), C

    torque, force = through.of(Reaction(joint.name))
    O, (P, _) = poses[through.number[joint.name]][1], place(body, point)
    expected = plus(torque, cross(minus(O, P), force))
    for axes, frame in (("ground", "ground"), ("parent", joint.parent), ("child", joint.child)):
        C = place(frame, (0, 0, 0))[1]
        found = through.of(Reaction(joint.name, point, body, axes))
        assert list(found.angular) == times(C, expected)
        assert list(found.linear) == times(C, force)
    C = poses[through.number[joint.name]][0]
    assert list(through.of(Reaction(joint.name, axes="joint")).linear) == times(C, force)
    about = Reaction(joint.name, "centre", body)
    assert through.of(about) == through.of(replace(about, point=given.body[body].centre))


def expanded(system):
    return {d.name: system.expand(d.expression) for d in system.outputs}


def pendulum(**joint):
    return Tree("pendulum", [Body("bob", m, (0, 0, -l), (J, J, 0))],
                [Joint("pin", "revolute", "ground", "bob", "y", **joint)], gravity=(0, 0, -g))  # fmt: skip


def test_pin_of_a_pendulum():
    """Along the rod m (g cos q + l u^2); across it m g sin q J / (J + m l^2): any textbook."""
    found = expanded(derive(pendulum(), [reaction("pin", axes="child")]))
    q, u = sp.symbols("q_pin u_pin", real=True)
    across = m * g * sp.sin(q) * J / (J + m * l**2)
    expected = {"F_pin_1": -across, "F_pin_2": 0, "F_pin_3": m * (g * sp.cos(q) + l * u**2)}
    for name, value in expected.items():
        assert equal(found[name], sp.sympify(value)), name
    assert all(found[f"T_pin_{n}"] == 0 for n in (1, 2, 3))


def test_moment_at_the_root_of_a_beam_with_a_weight():
    """A fixed joint carries a weight at an arm: F = m g upwards, T = m g l about it."""
    given = Tree("beam", [Body("beam", M, (l / 2, 0, 0)), Body("weight", m)],
                 [Joint("root", "fixed", "ground", "beam"),
                  Joint("tip", "fixed", "beam", "weight", on_parent=Placement((l, 0, 0)))],
                 gravity=(0, 0, -g))  # fmt: skip
    found = expanded(derive(given, ["reactions"]))
    assert equal(found["F_root_3"], (m + M) * g)
    assert equal(found["T_root_2"], -(m + M / 2) * g * l)
    assert equal(found["F_tip_3"], m * g)
    assert [found[n] for n in ("F_root_1", "F_root_2", "T_root_1", "T_root_3", "T_tip_2")] == [
        0
    ] * 5


def test_torque_of_a_drive():
    """A pendulum that is turned as w t^2: J' q'' + m g l sin q; springs and dampers do their share."""
    w = sp.Symbol("w", positive=True)
    angle = w * TIME**2
    given = pendulum(motion=Motion((angle,)), stiffness=k, damping=c, armature=M)
    (drive,) = derive(given, ["drives"]).outputs
    expected = (J + m * l**2 + M) * 2 * w + m * g * l * sp.sin(angle) + k * angle + c * 2 * w * TIME
    assert drive.name == "tau_pin"
    assert equal(derive(given, ["drives"]).expand(drive.expression), expected)


def test_drives_of_joints_of_several_speeds_and_motors_of_driven_ones():
    motion = Motion((TIME, TIME**2))
    joint = Joint("screw", "cylindrical", "ground", "nut", motor=True, motion=motion)
    given = Tree("screw", [Body("nut", m, inertia=(J, J, J))], [joint], gravity=(0, 0, -g))
    system = derive(given, ["drives"])
    found = expanded(system)
    assert list(found) == ["tau_screw_u1", "tau_screw_u2"]
    assert found["tau_screw_u1"] == 0
    assert equal(found["tau_screw_u2"], m * (2 + g))
    assert system.inputs == ()


def test_sympy_s_auxiliary_speeds_give_the_same_pin_force():
    """The elbow of a double pendulum: two auxiliary speeds of its pin, in the ground's axes."""
    links = [Body(f"link{n}", m, (0, 0, -l), (J, J, J / 3)) for n in (1, 2)]
    elbow = {"on_parent": Placement((0, 0, -2 * l)), "damping": c}
    joints = [Joint("one", "revolute", "ground", "link1", "y"),
              Joint("two", "revolute", "link1", "link2", "y", **elbow)]  # fmt: skip
    system = derive(Tree("double", links, joints, gravity=(0, 0, -g)), [reaction("two")])
    q, u = dynamicsymbols("q1:3"), dynamicsymbols("u1:3")
    aux, push = dynamicsymbols("a1 a3"), dynamicsymbols("f1 f3")
    N, O = ReferenceFrame("N"), Point("O")
    O.set_vel(N, 0)
    A, B = N.orientnew("A", "Axis", (q[0], N.y)), N.orientnew("B", "Axis", (q[0] + q[1], N.y))
    A.set_ang_vel(N, u[0] * N.y)
    B.set_ang_vel(N, (u[0] + u[1]) * N.y)
    G1, E = O.locatenew("G1", -l * A.z), O.locatenew("E", -2 * l * A.z)
    G1.v2pt_theory(O, N, A)
    E.v2pt_theory(O, N, A)
    P, pushed = E.locatenew("P", 0), push[0] * N.x + push[1] * N.z
    P.set_vel(N, E.vel(N) + aux[0] * N.x + aux[1] * N.z)
    G2 = P.locatenew("G2", -l * B.z)
    G2.v2pt_theory(P, N, B)
    bodies = [RigidBody("1", G1, A, m, (inertia(A, J, J, J / 3), G1)),
              RigidBody("2", G2, B, m, (inertia(B, J, J, J / 3), G2))]  # fmt: skip
    brake = -c * u[1] * N.y
    loads = [
        (G1, -m * g * N.z),
        (G2, -m * g * N.z),
        (B, brake),
        (A, -brake),
        (P, pushed),
        (E, -pushed),
    ]
    kane = KanesMethod(N, q, u, [a.diff() - b for a, b in zip(q, u, strict=True)], u_auxiliary=aux)
    kane.kanes_equations(bodies, loads)
    rates = {a.diff(): system.expand(r) for a, r in zip(u, system.rates[2:], strict=True)}
    names = dict(zip([*q, *u], [s.symbol for s in system.states], strict=True))
    found = expanded(system)
    pushes = {push[0]: found["F_two_1"], push[1]: found["F_two_3"]}
    for equation in kane.auxiliary_eqs:
        assert vanishes(equation.xreplace(rates).xreplace(pushes).xreplace(names))
    assert found["F_two_2"] == 0
    assert equal(found["T_two_2"], -c * names[u[1]])


@pytest.mark.parametrize("seed", only(range(4), 2))
def test_systems_compute_what_the_recursion_on_fractions_does(seed):
    kinds = tuple(k for k in KINDS if k != "helical")  # its angle is a length too
    given = tree(seed, 4, kinds)
    q, u = state(given, seed)
    angles = [x.unit == "rad" for j in given.ordered for x in j.coordinates]
    lumped = lumped_tree(given, lambda x: x, EXACT)
    udot = forward_dynamics(lumped, q, u, [0] * len(u), EXACT)
    through = wrenches(given, q, u, udot)
    asked = [
        Reaction(j.name, (1, 2, -1), "b0", axes) for j in given.ordered for axes in ("parent",)
    ]
    system = derive(given, asked)
    x = [2 * np.arctan(float(v)) if a else float(v) for v, a in zip(q, angles, strict=True)]
    found = codegen.compile(system, "numpy").outputs(0.0, np.array([*x, *map(float, u)]))
    expected = [float(v) for r in asked for v in (*through.of(r).linear, *through.of(r).angular)]
    assert np.allclose(found, expected, rtol=1e-11, atol=1e-9 * max(map(abs, expected)))


def test_reactions_that_are_not_asked_for_cost_nothing():
    given = tree(3, 6, loads=False)
    plain, asked = derive(given), derive(given, ["reactions", "drives"])
    assert plain.rates == asked.rates
    costs = [prune(lower_system(s), ["rates"]).cost() for s in (plain, asked)]
    assert costs[0] == costs[1]


def test_loads_that_are_added_from_outside_are_carried():
    """Loads beside those of the tree, as those that close a loop: the same as loads of the tree."""
    given = tree(11, 4)
    q, u, udot, _ = moving(given, 11)
    bare = replace(given, loads=())
    every = [j.name for j in given.joints]

    def further(lumped):
        from eom.multibody.recursion.motion import loads, places

        whole = lumped_tree(given, lambda x: x, EXACT, names(given), apart=every)
        assert [p.name for p in whole.parts] == [p.name for p in lumped.parts]
        return loads(places(whole, q, EXACT), EXACT)

    other = Wrenches(bare, lambda x: x, EXACT, (q, u, udot), every, further)
    assert other.through == wrenches(given, q, u, udot).through


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: derive(pendulum(), [reaction("pim")]), "pim"),
        (lambda: reaction("pin", axes="world"), "axes"),
        (lambda: reaction("pin", "center"), "point"),
        (lambda: reaction("pin", (1, 2)), "three components"),
        (lambda: reaction("pin", body="bob"), "no point"),
        (lambda: reaction("pin", name="1x"), "name"),
        (lambda: derive(pendulum(), [reaction("pin", "origin", body="bib")]), "bib"),
        (lambda: derive(pendulum(), [reaction("pin", "centre", body="ground")]), "ground"),
        (lambda: derive(pendulum(), [reaction("pin"), reaction("pin", axes="child")]), "repeated"),
        (lambda: derive(pendulum(), ["reaction"]), "reaction"),
    ],
)
def test_wrong_requests_are_refused(wrong, message):
    with pytest.raises(InputError, match=message):
        wrong()


def test_a_joint_names_its_own_reaction_and_a_point_of_the_ground_will_do():
    given = pendulum()
    asked = reaction(given.joints[0], (0, 0, l), body="ground", name="hook")
    found = expanded(derive(given, [asked]))
    assert list(found) == [f"{x}_hook_{n}" for x in "FT" for n in (1, 2, 3)]
    assert equal(found["T_hook_2"], -l * found["F_hook_1"])
    meanings = [d.quantity.meaning for d in derive(given, [asked]).outputs]
    assert meanings[3] == (
        "torque by the parent on the child of pin about (0, 0, l) on ground, along axis 1 of the ground"
    )


def test_a_wheel_whose_frame_stays_behind_has_its_reaction_in_its_own_axes():
    bodies = [Body("hub", 2, (1, 2, 3), (3, 4, 5)), Body("wheel", 1, (0, 0, 2), (2, 2, 3))]
    joints = [Joint("first", "universal", "ground", "hub"),
              Joint("second", "revolute", "hub", "wheel", on_parent=Placement((0, 3, 1)))]  # fmt: skip
    given = Tree("t", bodies, joints, gravity=(0, 0, -9), loads=[Load("hub", (1, 0, 0))])
    system = derive(given, [reaction("second", axes=a, name=a) for a in ("parent", "child")])
    x = [0.3, -0.2, 0.7, 1.0, 2.0, -3.0]
    values = codegen.compile(system, "numpy").outputs(0.0, np.array(x))
    F = dict(zip(system.output_names, values, strict=True))
    s, co = np.sin(x[2]), np.cos(x[2])
    assert np.isclose(F["F_child_1"], co * F["F_parent_1"] + s * F["F_parent_2"], rtol=1e-13)
    assert np.isclose(F["F_child_2"], -s * F["F_parent_1"] + co * F["F_parent_2"], rtol=1e-13)


def test_exactness_of_the_rates_of_this_test():
    """(a + b e)^2 = a^2 + 2 a b e."""
    x = Rate(Fraction(2, 3), 5)
    assert ((x * x).a, (x * x).b) == (Fraction(4, 9), Fraction(20, 3))
    assert ((1 - x).a, (1 - x).b) == (Fraction(1, 3), -5)
