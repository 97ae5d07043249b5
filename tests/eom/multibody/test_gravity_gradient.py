"""Gravity that varies with the position: tides on the bodies of trees, beside all else that acts."""

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from eom.errors import InputError
from eom.mechanics.rigidbody import is_invariant
from eom.multibody import (
    Body,
    Equation,
    Joint,
    Placement,
    Reaction,
    Rotor,
    Spring,
    Tree,
    closed_form,
    derive,
    regressor,
)
from eom.multibody.files.scene import TreeScene
from eom.multibody.recursion.operation_count import savings
from eom.quantities import TIME
from eom.views.live.trees import EDITS, GRAVITY

n = sp.Symbol("n", positive=True)
STRETCHED = ((2, 0.3, -0.1), (0.3, -1.5, 0.2), (-0.1, 0.2, -0.5))


def orbiting():
    """The gradient on a circular orbit, in axes that do not turn: n^2 (3 r r - 1)."""
    r = sp.Matrix([sp.cos(n * TIME), sp.sin(n * TIME), 0])
    return n**2 * (3 * r * r.T - sp.eye(3))


def satellite(**more):
    body = Body("hub", mass=100, inertia=(7, 10, 12))
    return Tree("satellite", (body,), (Joint("root", "free", "ground", "hub"),), **more)


def chain(**more):
    """Two bodies off the ground's origin, with a rotor and a spring."""
    J = ((2, 0.1, 0.2), (0.1, 3, -0.3), (0.2, -0.3, 2.5))
    bodies = (Body("a", 2, (0.1, 0.2, -0.3), J), Body("b", 1.5, (0.4, 0, 0.1), (0.2, 0.3, 0.4)))
    joints = (
        Joint("root", "free", "ground", "a"),
        Joint("elbow", "revolute", "a", "b", axis="y"),
    )
    wheel = Rotor("wheel", "b", inertia=0.05, axis="y")
    spring = Spring("cable", ("ground", "b"), ((1, 0, 0), (0, 0.5, 0)), stiffness=3)
    return Tree("chain", bodies, joints, rotors=(wheel,), springs=(spring,), **more)


@pytest.mark.slow
def test_a_body_on_an_orbit_librates_as_the_body_scene_does():
    """Angular velocities are inertial in both; the scene measures its attitude in the orbit frame."""
    scene = eom.load_scene("gravity-gradient-satellite")
    end, start = 10_000.0, scene.start
    reference = codegen.compile(scene.derive(), "numpy")
    options = {"method": "DOP853", "rtol": 1e-12}
    expected = codegen.simulate(reference, list(start.values()), (0, end), scene.numbers, **options)
    system = derive(satellite(gravity_gradient=orbiting()))
    names = {f"w_root_{k}": start[f"omega_{k}"] for k in (1, 2, 3)}
    names |= {f"e_root_{k}": start[f"q{k}"] for k in range(4)}
    x0 = [names.get(s, 0.0) for s in system.state_names]
    tree = codegen.compile(system, "numpy")
    found = codegen.simulate(tree, x0, (0, end), {"n": scene.numbers["n"]}, **options)
    at_end = dict(zip(system.state_names, found.y_stop, strict=True))
    wanted = dict(zip(scene.derive().state_names, expected.y_stop, strict=True))
    for k in (1, 2, 3):
        assert at_end[f"w_root_{k}"] == pytest.approx(wanted[f"omega_{k}"], rel=1e-8, abs=1e-13)
        assert at_end[f"v_root_{k}"] == 0
    assert abs(wanted["omega_1"] - start["omega_1"]) > 1e-5


@pytest.mark.slow
@pytest.mark.sparse(only=("with weight",))
@pytest.mark.parametrize("gravity", [(0, 0, 0), (0.5, 0, -9.81)], ids=["alone", "with weight"])
def test_energy_is_constant_in_a_field_that_does_not_change(gravity):
    system = derive(chain(gravity=gravity, gravity_gradient=STRETCHED))
    (energy,) = (i for i in system.invariants if i.name == "energy")
    assert is_invariant(system, energy.expression)


def test_a_point_mass_feels_the_field_at_its_place():
    bob, x = Body("bob", 3, inertia=(1, 1, 1)), sp.Matrix([0.3, -0.2, 0.7])
    tree = Tree("p", (bob,), (Joint("j", "free", "ground", "bob"),),
                gravity=(1, 2, 3), gravity_gradient=STRETCHED)  # fmt: skip
    f = codegen.compile(derive(tree), "numpy")
    rates = f.rhs(0, [*map(float, x), 1, *[0.0] * 9], [], [])
    wanted = sp.Matrix([1, 2, 3]) + sp.Matrix(STRETCHED) * x
    np.testing.assert_allclose(rates[-3:], [float(w) for w in wanted], rtol=1e-14)


def test_fixed_bodies_feel_what_the_body_that_they_make_feels():
    """A plate as one body, and as four that are fixed to each other."""
    whole = [
        Body("hub", 4, (0, 0, 0), (4 * 0.25, 4 * 0.25, 4 * 0.5)),
    ]
    corners = [Body(f"c{k}", 1, (0.5 * a, 0.5 * b, 0)) for k, (a, b) in
               enumerate([(1, 1), (1, -1), (-1, 1), (-1, -1)])]  # fmt: skip
    root = Joint("root", "free", "ground", "hub")
    one = Tree("one", tuple(whole), (root,), gravity_gradient=STRETCHED)
    more = (Joint("root", "free", "ground", "c0"),
            *(Joint(f"j{k}", "fixed", "c0", f"c{k}") for k in (1, 2, 3)))  # fmt: skip
    four = Tree("four", tuple(corners), more, gravity_gradient=STRETCHED)
    draw = np.random.default_rng(3)
    x = draw.standard_normal(13)
    x[3:7] /= np.linalg.norm(x[3:7])
    rates = [codegen.compile(derive(t), "numpy").rhs(0, x, [], []) for t in (one, four)]
    np.testing.assert_allclose(rates[0], rates[1], rtol=1e-12, atol=1e-12)


def test_momentum_is_no_constant_and_what_cannot_take_it_says_so():
    tree = satellite(gravity_gradient=STRETCHED)
    assert {i.name for i in derive(tree).invariants} == {"norm_root", "energy"}
    assert not [
        i for i in derive(satellite(gravity_gradient=orbiting())).invariants if i.name == "energy"
    ]
    for refuse in (closed_form, regressor):
        with pytest.raises(InputError, match="gradient"):
            refuse(tree)
    with pytest.raises(InputError, match="not symmetric"):
        satellite(gravity_gradient=((0, 1, 0), (0, 0, 0), (0, 0, 0)))


def test_scene_files_say_it_over_parameters_and_time():
    words = {
        "bodies": {"hub": {"mass": 1, "moments": (7, 10, 12)}},
        "joints": {"root": {"kind": "free", "parent": "ground", "child": "hub"}},
        "parameters": {"n": 1e-3},
    }
    rows = (("2*n^2*cos(t)", 0, 0), (0, "-n^2", 0), (0, 0, "-n^2"))
    tree = TreeScene(**words, gravity_gradient=rows).tree
    assert tree.gravity_gradient[1][1] == -(sp.Symbol("n", real=True) ** 2)
    with pytest.raises(InputError, match="gravity_gradient"):
        TreeScene(**words, gravity_gradient=(("w_root_1", 0, 0), (0, 0, 0), (0, 0, 0)))


def test_what_holds_two_masses_together_takes_the_difference_of_the_field():
    inertia = (1, 1, 1)
    ends = (Body("a", 3, inertia=inertia), Body("b", 3, inertia=inertia))
    joints = (
        Joint("root", "free", "ground", "a"),
        Joint("rod", "fixed", "a", "b", on_parent=Placement((2, 0, 0))),
    )
    tree = Tree("dumbbell", ends, joints, gravity_gradient=(2, -1, -1))
    system = derive(tree, outputs=[Reaction("rod")])
    x = [-1.0, 0, 0, 1, *[0.0] * 9]
    outputs = codegen.compile(system, "numpy").outputs(0, x, [], [])
    at = dict(zip(system.output_names, outputs, strict=True))
    assert [at[f"F_rod_{k}"] for k in (1, 2, 3)] == pytest.approx([-6, 0, 0])
    assert savings(tree).skipped > 0


@pytest.mark.parametrize("multipliers", [True, False], ids=["multipliers", "elimination"])
def test_energy_is_constant_under_constraints(multipliers):
    J = ((0.2, 0.01, 0), (0.01, 0.3, 0), (0, 0, 0.4))
    bodies = (Body("a", 2, (0.3, 0, 0), J), Body("b", 1, (0.2, 0.1, 0), J))
    joints = (
        Joint("one", "revolute", "ground", "a"),
        Joint("two", "revolute", "a", "b", on_parent=Placement((1, 0, 0))),
    )
    q = sp.symbols("q_one q_two", real=True)
    gears = Equation("gears", q[0] + 2 * q[1] - sp.Rational(1, 2))
    tree = Tree("geared", bodies, joints, gravity_gradient=STRETCHED, constraints=(gears,))
    system = derive(tree, multipliers=multipliers)
    start = {"q_one": 0.1, "q_two": 0.2, "u_one": 0.6, "u_two": -0.3}
    x0 = {s: start[s] for s in system.state_names}
    result = codegen.simulate(system, x0, (0.0, 2.0), rtol=1e-12)
    assert result.drift["energy"].relative < 1e-10


def test_a_live_page_without_gravity_has_no_gradient_either():
    tree = chain(gravity=(0, 0, -9.81), gravity_gradient=STRETCHED)
    assert EDITS[GRAVITY](tree) == chain()
    assert EDITS[GRAVITY](chain(gravity_gradient=STRETCHED)) == chain()
