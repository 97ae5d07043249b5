"""Springs and dampers between points: forces by hand, conservation, coincident points, errors."""

import numpy as np
import pytest
import sympy as sp

import codegen
from eom.errors import InputError
from eom.mechanics.rigidbody import is_invariant
from eom.multibody import GROUND, Body, Joint, Load, Placement, Spring, Tree, derive
from tests.eom.rows import only

k, l, c, m = sp.symbols("k l c m", positive=True)
HUB = Body("hub", 3, (0, 0, 0.1), (2, 3, 4))
ARM = Body("arm", 1, (0, 1, 0), (1, 0.5, 1.1))
BASE = Joint("base", "free", GROUND, "hub", attitude="3-1-2")
HINGE = Joint("hinge", "revolute", "hub", "arm", "x", on_parent=Placement((0, 0.5, 0)))
POINTS = ((0.1, -0.2, 0.3), (0.2, 0.7, -0.1))


def rates(tree, values, t=0.0):
    system = derive(tree, invariants=False)
    x = np.array([values[n] for n in system.state_names])
    return codegen.compile(system, "numpy").rhs(t, x, [], [])


def spring_of(**given):
    return Spring("strut", ("hub", "arm"), POINTS, **given)


def test_one_mass_on_a_spring_to_the_ground():
    """A bead on a rail, its spring across: m x'' = -(k (d - l) + c d') x/d, d^2 = x^2 + h^2."""
    rail = Joint("rail", "prismatic", GROUND, "bead", "x")
    spring = Spring("s", (GROUND, "bead"), ((0, 0.4, 0), (0, 0, 0)), k, l, c)
    system = derive(Tree("bead", [Body("bead", m)], [rail], springs=[spring]))
    x, v = sp.symbols("q_rail u_rail", real=True)
    d = sp.sqrt(x**2 + sp.Rational(0.4) ** 2)
    expected = -(k * (d - l) + c * x * v / d) * x / d / m
    values = {k: 3.0, l: 0.7, c: 0.2, m: 2.0, x: -0.5, v: 0.3}
    assert system.invariant_names == ()
    found = system.expand(system.rates[1])
    assert float(found.subs(values)) == pytest.approx(float(expected.subs(values)), rel=1e-14)


@pytest.mark.parametrize("length", only([0, sp.Rational(3, 5)], sp.Rational(3, 5)))
def test_a_spring_is_a_pair_of_loads(length):
    """Of forces in the ground's axes that NumPy computes from poses and velocities by differences."""
    tree = Tree(
        "t", [HUB, ARM], [BASE, HINGE], springs=[spring_of(stiffness=7, length=length, damping=2)]
    )
    names = derive(tree, invariants=False).state_names
    values = dict(zip(names, np.random.default_rng(2).uniform(-1, 1, len(names)), strict=True))
    first, second = (ends(values, *end) for end in (("hub", POINTS[0]), ("arm", POINTS[1])))
    d, v = second[0] - first[0], second[1] - first[1]
    distance = np.linalg.norm(d)
    pull = (7 * (distance - float(length)) + 2 * d @ v / distance) * d / distance
    loads = [Load("hub", pull, point=POINTS[0]), Load("arm", -pull, point=POINTS[1])]
    expected = rates(Tree("t", [HUB, ARM], [BASE, HINGE], loads=loads), values)
    assert rates(tree, values) == pytest.approx(expected, rel=1e-7, abs=1e-7)


def ends(values, body, point):
    """Position of a point and its velocity, by complex steps along the motion."""

    def turn(axis, q):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        C = np.eye(3, dtype=complex)
        C[i, i] = C[j, j] = np.cos(q)
        C[i, j], C[j, i] = np.sin(q), -np.sin(q)
        return C

    system = derive(Tree("t", [HUB, ARM], [BASE, HINGE]), invariants=False)
    x = np.array([values[n] for n in system.state_names])
    dx = codegen.compile(system, "numpy").rhs(0.0, x, [], [])
    q = dict(zip(system.state_names, x + 1e-40j * dx, strict=True))
    C = turn(1, q["q_base_3"]) @ turn(0, q["q_base_2"]) @ turn(2, q["q_base_1"])
    local = np.array(point, dtype=complex)
    if body == "arm":
        local = np.array((0, 0.5, 0)) + turn(0, q["q_hinge"]).T @ local
    where = np.array([q["x_base"], q["y_base"], q["z_base"]]) + C.T @ local
    return where.real, where.imag / 1e-40


@pytest.mark.parametrize("length", only([0, 1], 1))
def test_energy_is_conserved_and_momentum_where_nothing_holds_the_ground(length):
    tree = Tree("t", [HUB, ARM], [BASE, HINGE], springs=[spring_of(stiffness=7, length=length)])
    system = derive(tree)
    assert {"energy", "p_1", "L_3"} <= set(system.invariant_names)
    start = dict.fromkeys(system.state_names, 0.2)
    result = codegen.simulate(system, start, (0.0, 1.0), rtol=1e-12)
    assert max(d.relative for d in result.drift.values()) < 1e-9
    held = Spring("tether", (GROUND, "arm"), ((0, 0, 0), (0, 1, 0)), 2, 1)
    names = derive(Tree("t", [HUB, ARM], [BASE, HINGE], springs=[held])).invariant_names
    assert names == ("energy",)


def test_the_energy_of_a_spring_without_length_is_conserved_exactly():
    rail = Joint("rail", "planar", GROUND, "bead")
    spring = Spring("s", (GROUND, "bead"), ((0, 0.4, 0), (0.3, 0, 0)), k)
    system = derive(
        Tree("bead", [Body("bead", m, (0.1, 0, 0), (1, 1, 1))], [rail], springs=[spring])
    )
    (energy,) = system.invariants
    assert is_invariant(system, energy.expression)


def test_points_may_coincide_where_the_force_has_no_direction_to_lose():
    rail = Joint("rail", "prismatic", GROUND, "bead", "x")
    spring = Spring("s", (GROUND, "bead"), stiffness=3)
    tree = Tree("bead", [Body("bead", 2)], [rail], springs=[spring])
    assert rates(tree, {"q_rail": 0.0, "u_rail": 0.0}).tolist() == [0.0, 0.0]


def test_errors_name_the_spring():
    for made, what in (
        (lambda: Spring("s", ("hub",)), "bodies is of the wrong type"),
        (lambda: Spring("s", ("hub", "arm"), [(0, 0, 0)]), "not two points"),
        (lambda: Tree("t", [HUB], [BASE], springs=[Spring("s", ("hub", "arn"))]), "unknown body"),
        (lambda: Tree("t", [HUB], [BASE], springs=[Spring("s", ("hub", "hub"))]), "on one body"),
    ):
        with pytest.raises(InputError, match=what) as caught:
            made()
        assert "spring 's'" in str(caught.value).lower()
