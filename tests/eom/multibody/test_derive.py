"""Systems of trees against other derivations: SymPy's Kane, one body, Pinocchio, conservation."""

import cmath
import math

import numpy as np
import pytest
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod,
    Point,
    ReferenceFrame,
    RigidBody,
    dynamicsymbols,
    inertia,
)

import codegen
import eom
from benchmarks.trees import LARGEST, derivatives, differences
from codegen.frontend.lower import lower_system
from codegen.ir.passes import prune
from eom.errors import InputError
from eom.exact.identity import equal
from eom.mechanics.rigidbody import is_invariant
from eom.multibody import Body, Joint, Load, Motion, Placement, Spring, Tree, derive
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.model.joints import KINDS
from eom.multibody.recursion.lumped_tree import lumped_tree
from eom.multibody.recursion.motion import coordinate_rates
from eom.multibody.recursion.recursions import forward_dynamics, inverse_dynamics
from tests.clock import growth_in_calls
from tests.eom.multibody import peer
from tests.eom.multibody.trees import state, tree
from tests.eom.rows import every, only

FLOATS = Numbers(math.sin, math.cos)
m, l, J, g, k, c, M = sp.symbols("m l J g k c M", positive=True)


def floats(x):
    return x if x in {0, 1, -1} else float(x)


def evaluated(system, x, p=(), u=(), t=0.0):
    return codegen.compile(system, "numpy").rhs(
        t, np.array(x, float), np.array(p, float), np.array(u, float)
    )


@pytest.mark.parametrize("seed", every(4, range(8)))
def test_a_system_is_the_recursion_on_numbers(seed):
    given = tree(seed, 4)
    q, u = ([float(x) for x in group] for group in state(given, seed))
    lumped = lumped_tree(given, floats, FLOATS)
    expected = [
        *coordinate_rates(lumped, q, u, FLOATS),
        *forward_dynamics(lumped, q, u, [0.0] * len(u), FLOATS),
    ]
    assert np.allclose(evaluated(derive(given), [*q, *u]), expected, rtol=1e-12, atol=1e-12)


def double_pendulum():
    links = [Body(f"link{n}", m, (0, 0, -l), (J, J, J / 3)) for n in (1, 2)]
    joints = [
        Joint("one", "revolute", "ground", "link1", "y", damping=c, motor=True),
        Joint(
            "two",
            "revolute",
            "link1",
            "link2",
            "y",
            on_parent=Placement((0, 0, -2 * l)),
            stiffness=k,
        ),
    ]
    return Tree("double_pendulum", links, joints, gravity=(0, 0, -g))


def kane_double_pendulum(q, u, tau):
    N, O = ReferenceFrame("N"), Point("O")
    O.set_vel(N, 0)
    A, B = N.orientnew("A", "Axis", (q[0], N.y)), N.orientnew("B", "Axis", (q[0] + q[1], N.y))
    A.set_ang_vel(N, u[0] * N.y)
    B.set_ang_vel(N, (u[0] + u[1]) * N.y)
    bodies, loads, end = [], [], O
    for name, frame in (("A", A), ("B", B)):
        G = end.locatenew("G" + name, -l * frame.z)
        G.v2pt_theory(end, N, frame)
        bodies.append(RigidBody(name, G, frame, m, (inertia(frame, J, J, J / 3), G)))
        loads.append((G, -m * g * N.z))
        end = end.locatenew("E" + name, -2 * l * frame.z)
        end.v2pt_theory(O if name == "A" else G, N, frame)
    torque = (tau - c * u[0]) * N.y
    loads += [(A, torque), (B, -k * q[1] * N.y), (A, k * q[1] * N.y)]
    return N, bodies, loads


def cart_pendulum():
    bodies = [Body("cart", M), Body("bob", m, (0, 0, -l), (J, J, 0))]
    joints = [
        Joint("rail", "prismatic", "ground", "cart", "x", motor=True, stiffness=k),
        Joint("pivot", "revolute", "cart", "bob", "y"),
    ]
    return Tree("cart_pendulum", bodies, joints, gravity=(0, 0, -g))


def kane_cart_pendulum(q, u, tau):
    N, O = ReferenceFrame("N"), Point("O")
    O.set_vel(N, 0)
    C = O.locatenew("C", q[0] * N.x)
    C.set_vel(N, u[0] * N.x)
    A = N.orientnew("A", "Axis", (q[1], N.y))
    A.set_ang_vel(N, u[1] * N.y)
    G = C.locatenew("G", -l * A.z)
    G.v2pt_theory(C, N, A)
    bodies = [
        RigidBody("cart", C, N, M, (inertia(N, 1, 1, 1), C)),
        RigidBody("bob", G, A, m, (inertia(A, J, J, 0), G)),
    ]
    return N, bodies, [(C, (tau - k * q[0]) * N.x), (G, -m * g * N.z)]


@pytest.mark.parametrize(
    ("given", "other"),
    [(double_pendulum(), kane_double_pendulum), (cart_pendulum(), kane_cart_pendulum)],
    ids=["double pendulum", "cart and pendulum"],
)
def test_accelerations_are_those_of_kane(given, other):
    """Exactly, in randomised arithmetic: M u' - f of SymPy's Kane vanishes for our u'."""
    system = derive(given)
    q, u = dynamicsymbols("q1:3"), dynamicsymbols("u1:3")
    (tau,) = (i.symbol for i in system.inputs)
    N, bodies, loads = other(q, u, tau)
    kane = KanesMethod(N, q, u, [a.diff() - b for a, b in zip(q, u, strict=True)])
    kane.kanes_equations(bodies, loads)
    states = [s.symbol for s in system.states]
    names = dict(zip([*q, *u], states, strict=True))
    accelerations = sp.Matrix([system.expand(r) for r in system.rates[2:]])
    residual = kane.mass_matrix.xreplace(names) * accelerations - kane.forcing.xreplace(names)
    assert equal(residual, sp.zeros(2, 1))


def test_a_free_body_is_kane_s():
    given = Tree("free", [Body("body", m, (0, 0, l), (J, 2 * J, 2 * J))],
                 [Joint("base", "free", "ground", "body", attitude="3-1-2")],
                 gravity=(0, 0, -g))  # fmt: skip
    system = derive(given, invariants=False)
    q, u = dynamicsymbols("q1:7"), dynamicsymbols("u1:7")
    N, O = ReferenceFrame("N"), Point("O")
    O.set_vel(N, 0)
    B = N.orientnew("B", "Body", q[3:], "312")
    omega = B.ang_vel_in(N)
    B.set_ang_vel(N, u[0] * B.x + u[1] * B.y + u[2] * B.z)
    P = O.locatenew("P", q[0] * N.x + q[1] * N.y + q[2] * N.z)
    velocity = u[3] * B.x + u[4] * B.y + u[5] * B.z
    P.set_vel(N, velocity)
    G = P.locatenew("G", l * B.z)
    G.v2pt_theory(P, N, B)
    turn = [(omega - B.ang_vel_in(N)).dot(e) for e in B]
    move = [
        (sum((x.diff() * e for x, e in zip(q[:3], N, strict=True)), 0 * N.x) - velocity).dot(e)
        for e in N
    ]
    kane = KanesMethod(N, q, u, [*turn, *move])
    kane.kanes_equations(
        [RigidBody("B", G, B, m, (inertia(B, J, 2 * J, 2 * J), G))], [(G, -m * g * N.z)]
    )
    names = dict(zip([*q, *u], [s.symbol for s in system.states], strict=True))
    for size, mass, right, ours in (
        (6, kane.mass_matrix, kane.forcing, system.rates[6:]),
        (6, kane.mass_matrix_kin, kane.forcing_kin, system.rates[:6]),
    ):
        found = sp.Matrix([system.expand(r) for r in ours])
        assert equal(mass.xreplace(names) * found - right.xreplace(names), sp.zeros(size, 1))


def test_one_free_body_turns_as_eom_rigidbody_says():
    I1, I2, I3 = sp.symbols("I_1 I_2 I_3", positive=True)
    ours = derive(Tree("t", [Body("b", m, (0, 0, 0), (I1, I2, I3))],
                       [Joint("base", "free", "ground", "b")]))  # fmt: skip
    other = eom.free_rigid_body("quaternion")
    parameters = dict(zip(sorted(other.parameter_names), (I1, I2, I3), strict=True))
    names = {"omega_1": "w_base_1", "omega_2": "w_base_2", "omega_3": "w_base_3"}
    names |= {f"q{n}": f"e_base_{n}" for n in range(4)}
    renamed = {s.symbol: sp.Symbol(names[s.name], real=True) for s in other.states}
    renamed |= {p.symbol: parameters[p.name] for p in other.parameters}
    rates = dict(zip(ours.state_names, ours.rates, strict=True))
    for quantity, rate in zip(other.states, other.rates, strict=True):
        assert equal(ours.expand(rates[names[quantity.name]]), other.expand(rate).xreplace(renamed))


@pytest.mark.parametrize("seed", only(range(6), 0, 5))
def test_energy_is_invariant_exactly(seed):
    """Of random trees of numbers; angles and speeds are random numbers modulo a prime."""
    system = derive(tree(seed, 2, loads=False, attitudes=("3-1-2", "3-1-3")))
    (energy,) = system.invariants
    assert energy.name == "energy"
    assert is_invariant(system, energy.expression, points=1)


def test_norms_of_quaternions_are_invariant_exactly():
    system = derive(floating())
    (norm,) = [d for d in system.invariants if d.name == "norm_base"]
    assert is_invariant(system, norm.expression)


def floating():
    bodies = [Body("hub", 3, (0, 0, 0.1), (2, 3, 4)), Body("panel", 1, (0, 1, 0), (1, 0.2, 1.1)),
              Body("wheel", 0.5, (0, 0, 0), (0.1, 0.1, 0.2))]  # fmt: skip
    joints = [
        Joint("base", "free", "ground", "hub"),
        Joint(
            "hinge",
            "revolute",
            "hub",
            "panel",
            "x",
            on_parent=Placement((0, 0.5, 0)),
            stiffness=2,
            rest=0.3,
        ),
        Joint("spin", "revolute", "hub", "wheel", "z", on_parent=Placement((0.2, 0, 0))),
    ]
    return Tree("satellite", bodies, joints)


def test_a_floating_tree_keeps_energy_and_momentum_when_integrated():
    system = derive(floating())
    assert {"energy", "p_1", "L_3", "norm_base"} <= set(system.invariant_names)
    start = dict.fromkeys(system.state_names, 0.1) | {"u_spin": 20.0, "w_base_1": 0.4}
    start |= {"e_base_0": 1.0, "e_base_1": 0.0, "e_base_2": 0.0, "e_base_3": 0.0}
    result = codegen.simulate(system, start, (0.0, 2.0), rtol=1e-12)
    assert set(result.drift) == set(system.invariant_names)
    assert max(d.relative for d in result.drift.values()) < 1e-9


def test_inputs_loads_and_prescribed_motion_reach_the_system():
    t, drag, thrust = (
        sp.Symbol("t", real=True),
        sp.Symbol("drag", positive=True),
        sp.Symbol("thrust", real=True),
    )
    speed = sp.Symbol("u_rail", real=True)
    bodies = [Body("cart", M), Body("bob", m, (0, 0, -l), (J, J, J))]
    joints = [
        Joint("rail", "prismatic", "ground", "cart", "x"),
        Joint("pivot", "revolute", "cart", "bob", "y", motion=Motion(sp.sin(3 * t))),
    ]
    given = Tree("t", bodies, joints, gravity=(0, 0, -g), inputs=(thrust,),
                 loads=[Load("cart", (thrust - drag * speed, 0, 0))])  # fmt: skip
    system = derive(given)
    assert system.state_names == ("q_rail", "u_rail")
    assert (system.input_names, system.invariant_names) == (("thrust",), ())
    assert set(system.parameter_names) == {"M", "m", "l", "drag"} | set(system.parameter_names) & {
        "g",
        "J",
    }
    angle = sp.sin(3 * t)
    x = -l * sp.sin(angle)  # of the bob, beside the cart
    expected = (thrust - drag * speed - m * sp.diff(x, t, 2)) / (M + m)
    found = system.expand(system.rates[1])
    values = {M: 2, m: 3, l: 0.7, drag: 0.4, thrust: 5, speed: 1.5, t: 0.3, g: 9.8, J: 0.1}
    assert float(found.subs(values)) == pytest.approx(float(expected.subs(values)), rel=1e-12)


def test_a_plane_pendulum_needs_no_sine_of_more_than_gravity():
    """The first link of a double pendulum: what the recursion leaves is short enough to read."""
    system = derive(double_pendulum(), invariants=False)
    assert len(system.definitions) < 60
    assert all(d.quantity.meaning for d in system.definitions)
    assert {"s_one", "c_two"} <= {d.name for d in system.definitions}


def long_chain(count):
    bodies = [Body(f"b{n}", 1 + n % 3, (0.1, 0.2, 0.3), (3, 4, 5)) for n in range(count)]
    joints = [
        Joint(f"j{n}", "revolute", f"b{n - 1}" if n else "ground", f"b{n}", "xyz"[n % 3],
              on_parent=Placement((0.1, -0.2, 1)), motor=True)
        for n in range(count)
    ]  # fmt: skip
    return Tree("chain", bodies, joints, gravity=(0, 0, -9.81))


@pytest.mark.slow
@pytest.mark.parametrize("links", [10, 20])
def test_derivation_grows_linearly(links):
    def work(count):
        prune(lower_system(derive(long_chain(count), invariants=False)))

    assert growth_in_calls(2.2, work, links, 2 * links)


def test_the_same_tree_gives_the_same_system():
    one, other = (derive(double_pendulum(), ["energies", "centre_of_mass"]) for _ in range(2))
    assert one == other
    assert str(lower_system(one)) == str(lower_system(other))


@pytest.mark.parametrize("seed", range(6))
def test_pinocchio_agrees_on_random_trees(seed):
    """The short form of ``python -m benchmarks.trees``, which takes 200 and says what is relative."""
    pytest.importorskip("pinocchio")
    found = differences(seed, 3 + seed % 4)
    assert max(found.values()) <= LARGEST, found


@pytest.mark.parametrize("recursion", [forward_dynamics, inverse_dynamics])
def test_derivatives_of_trees_with_universal_joints_by_complex_steps(recursion):
    """Pinocchio has no right derivatives of these: see ``benchmarks.trees``."""
    given, q, u = peer.shared_tree(5, 3, ["universal", "revolute", "planar"])
    assert "universal" in {j.kind for j in given.joints}
    last = np.linspace(-1.0, 2.0, len(u))
    step, state = 1e-40, [*q, *u]
    work = Numbers(cmath.sin, cmath.cos)
    lumped = lumped_tree(given, floats, work)
    columns = []
    for k in range(len(state)):
        x = [complex(v, step * (n == k)) for n, v in enumerate(state)]
        columns.append(
            np.imag(recursion(lumped, x[: len(q)], x[len(q) :], list(last), work)) / step
        )
    found = np.hstack(derivatives(recursion, given, q, u, last))
    assert np.allclose(found, np.array(columns).T, rtol=1e-12, atol=1e-12 * np.abs(found).max())


def test_what_pinocchio_shares():
    assert set(peer.SHARED) | {"cylindrical", "fixed"} == set(KINDS)


def test_repeated_names_are_one_error():
    with pytest.raises(InputError, match="repeated variable"):
        derive(Tree("t", [Body("b", sp.Symbol("q_j", positive=True), (0, 0, 1))],
                    [Joint("j", "revolute", "ground", "b", "x")], gravity=(0, 0, -1)))  # fmt: skip


# --- a body that turns about a point: what is stated of it -----------------------------------------

QUARTER = ((0, -1, 0), (1, 0, 0), (0, 0, 1))
PIVOT = {"m": 1.5, "l": 0.3, "J": 0.4, "M": 0.25, "g": 9.81, "c": 0.0, "k": 0.0}
THERE = {"quaternion": [0.9, 0.1, -0.3, 0.3], "3-1-3": [0.2, 0.7, -0.4]}


def pivoted(attitude, centre, *, loads=(), springs=(), **more):
    """A body on a ball joint: its moments about the joint are J + m l^2 (twice) and M."""
    body = Body("b", m, centre, (J, J, M))
    joint = Joint("j", "spherical", "ground", "b", attitude=attitude, **more)
    return derive(Tree("t", (body,), (joint,), (0, 0, -g), tuple(loads), springs=tuple(springs)))


@pytest.mark.parametrize("attitude", only(THERE, "3-1-3"))
def test_a_body_on_a_ball_joint_has_the_closed_forms_of_one_body(attitude):
    """Lagrange's top, beside its Taylor series; the tree knew it, and it is proved."""
    top = pivoted(attitude, (0, 0, l))
    assert top.attitudes[0].inertia is not None
    compiled = codegen.compile(top)
    start, p = [*THERE[attitude], 0.1, 2.0, 7.0], {n: PIVOT[n] for n in top.parameter_names}
    q = np.array(start[:4]) / np.linalg.norm(start[:4])
    start[:4] = list(q) if attitude == "quaternion" else start[:4]
    found, other = (
        codegen.simulate(compiled, start, (0, 5), p, n, 1e-13) for n in ("auto", "taylor")
    )
    assert found.method.startswith("closed form: heavy symmetric top")
    np.testing.assert_allclose(found.y_stop, other.y_stop, rtol=0, atol=1e-11)


def test_a_body_on_a_ball_joint_at_its_centre_is_a_free_body():
    free = pivoted("quaternion", (0, 0, 0))
    assert free.attitudes[0].torque == (0, 0, 0)
    p = {n: PIVOT[n] for n in free.parameter_names}
    run = codegen.simulate(free, [1, 0, 0, 0, 0.1, 2, 7], (0, 5), p)
    assert run.method.startswith("closed form: free body")


def test_what_acts_on_a_body_on_a_ball_joint_is_in_its_torque():
    """Motor, damper, a load off the joint, a spring to the ground: proved where the system is made."""
    spring = Spring("s", ("ground", "b"), ((0.1, 0.2, 0.5), (0, 0, 1)), k, 0.2, c)
    load = Load("b", (0, 1, 0), (M, 0, 0), (0, 0.5, 1), "body")
    system = pivoted("quaternion", (l, 0, l), loads=[load], springs=[spring], motor=True, damping=c)
    stated = system.attitudes[0]
    assert stated.inertia is not None
    p = PIVOT | {"c": 0.2, "k": 3.0}
    p = {n: p[n] for n in system.parameter_names}
    inputs = dict(zip(system.input_names, (0.1, 0.2, -0.3), strict=True))
    runs = [
        codegen.simulate(system, [1, 0, 0, 0, 0.1, 0.4, 1], (0, 2), p, n, 1e-12, inputs=inputs)
        for n in ("rkmk", "DOP853")
    ]
    np.testing.assert_allclose(runs[0].y_stop, runs[1].y_stop, rtol=0, atol=1e-10)


@pytest.mark.parametrize(
    "placed",
    [
        {"on_parent": Placement((l, 0, 0), QUARTER)},
        {"on_child": Placement((l, 0, l / 2), QUARTER)},
        {"force": (M, 0, k)},
    ],
)
def test_where_the_joint_lies_and_what_it_exerts_is_in_what_is_stated(placed):
    """A wrong inertia or torque is refused where the system is made, whose rates are the recursion's."""
    stated = pivoted("quaternion", (0, 0, l), **placed).attitudes[0]
    assert stated.inertia is not None
    assert any(stated.torque)


def test_inertia_of_others_is_not_stated():
    """Of several parts, of a rotor's armature, of a body that also moves along: kinematics alone."""
    assert pivoted("quaternion", (0, 0, l), armature=J).attitudes[0].inertia is None
    floating = Tree(
        "t", (Body("b", m, (0, 0, l), (J, J, M)),), (Joint("j", "free", "ground", "b"),)
    )
    assert derive(floating).attitudes[0].inertia is None
    arm = (Body("b", m, (0, 0, l), (J, J, M)), Body("c", m, (0, 0, l), (J, J, M)))
    joints = (Joint("j", "spherical", "ground", "b"), Joint("i", "revolute", "b", "c", "x"))
    assert derive(Tree("t", arm, joints)).attitudes[0].inertia is None
