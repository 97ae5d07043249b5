"""The regressor against inverse dynamics; base parameters against exact sums and published numbers."""

import math
import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import codegen
from eom.errors import InputError
from eom.multibody import Body, Joint, Load, Placement, Tree, base_parameters, regressor
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.algebra.spatial import IDENTITY, product, transposed
from eom.multibody.identify.base_parameters import (
    PRIME,
    Residue,
    orthonormal,
    residue,
    rotation,
    unit,
)
from eom.multibody.identify.regressor import bones_of, entries, parameters_of, values_of
from eom.multibody.model.joints import KINDS
from eom.multibody.recursion.lumped_tree import lumped_tree
from eom.multibody.recursion.recursions import inverse_dynamics
from tests.draws import examples
from tests.eom.multibody.trees import EXACT, number, state, tree
from tests.eom.rows import only

seeds = st.integers(0, 10**6)
l, g = sp.symbols("l g", positive=True)
QUARTER = ((1, 0, 0), (0, 0, 1), (0, -1, 0))
BACK = ((1, 0, 0), (0, 0, -1), (0, 1, 0))


def times(Y, pi):
    return [sum(column[r] * x for column, x in zip(Y, pi, strict=True)) for r in range(len(Y[0]))]


@examples(20)
@given(seeds, st.integers(1, 4))
def test_the_regressor_times_the_parameters_is_inverse_dynamics_exactly(seed, count):
    given = tree(seed, count, kinds=tuple(KINDS), loads=False)
    lumped = lumped_tree(given, lambda x: x, EXACT)
    if not lumped.speeds:
        return
    (q, u), draw = state(given, seed), random.Random(seed)
    udot = [number(draw) for _ in u]
    columns = parameters_of(given, armature=True)
    Y = entries(given, bones_of(given, lambda x: x, EXACT), (q, u, udot), columns, EXACT)
    assert times(Y, values_of(given, columns)) == inverse_dynamics(lumped, q, u, udot, EXACT)


@pytest.mark.parametrize("seed", only(range(2), 0))
def test_the_compiled_regressor(seed):
    given = tree(
        seed, 3, kinds=("revolute", "universal", "planar", "helical", "spherical"), loads=False
    )
    given = replace(given, joints=tuple(replace(j, damping=2) for j in given.joints))
    found = regressor(given, armature=True, damping=True, coulomb=True)
    q, u = ([float(x) for x in group] for group in state(given, seed))
    udot = [random.Random(seed + k).uniform(-2, 2) for k in range(len(u))]
    compiled = codegen.compile(found.system, "numpy")
    Y = np.zeros((len(found.rows), len(found.columns)))
    values = compiled.outputs(0.0, np.array([*q, *u]), np.zeros(0), np.array(udot))
    for (row, column), y in zip(found.places, values, strict=True):
        Y[row, column] = y
    work = Numbers(math.sin, math.cos)
    lumped = lumped_tree(given, lambda x: x if x in {0, 1, -1} else float(x), work)
    expected = [
        t + 2 * v for t, v in zip(inverse_dynamics(lumped, q, u, udot, work), u, strict=True)
    ]
    pi = np.array([float(x) for x in values_of(given, found.columns)])
    assert np.allclose(Y @ pi, expected, rtol=1e-11, atol=1e-9)
    dry = np.array([c.letter == "coulomb" for c in found.columns])
    assert np.array_equal(Y @ np.where(dry, 3.0, 0.0), 3 * np.sign(u))
    assert compiled.rhs(0.0, np.array([*q, *u]), np.zeros(0), np.array(udot))[
        -len(u) :
    ] == pytest.approx(udot)


def test_dry_friction_is_a_column_of_signs():
    """tau = J u' + m g l sin(q) + c sign(u), in symbols and in C."""
    c, J, h = sp.symbols("c J h", positive=True)
    pendulum = Tree(
        "pendulum",
        [Body("bob", 1)],
        [Joint("pin", "revolute", "ground", "bob", axis="x")],
        gravity=(0, 0, -g),
    )
    Y = regressor(pendulum, coulomb=True)
    q, u, rate = sp.symbols("q_pin u_pin dot_u_pin", real=True)
    pi = {"J_bob_11": J, "h_bob_3": -h, "coulomb_u_pin": c}
    tau = Y.expressions * sp.Matrix([pi.get(x.name, 0) for x in Y.columns])
    assert sp.expand(tau[0] - (J * rate + g * h * sp.sin(q) + c * sp.sign(u))) == 0
    assert Y.parameters(pendulum)[-1] == 0
    compiled = codegen.compile(Y.system)
    for speed in (-2.0, 0.0, 0.5):
        found = Y.array(compiled.outputs(0.0, [0.3, speed], [9.81], [1.0]))
        assert found[0][-1] == np.sign(speed)


def test_zeros_by_structure_are_no_outputs():
    """A body on a joint about z shows one moment; what hangs on another branch nothing."""
    bodies = [Body("a", 1), Body("b", 1)]
    joints = [Joint("one", "revolute", "ground", "a"), Joint("two", "revolute", "ground", "b")]
    found = regressor(Tree("t", bodies, joints))
    assert found.system.output_names == ("Y_u_one_J_a_33", "Y_u_two_J_b_33")
    assert found.places == ((0, 5), (1, 15))
    assert [c.unit for c in found.columns[:10]] == ["kg m^2"] * 6 + ["kg m"] * 3 + ["kg"]


@examples(12)
@given(seeds, st.integers(1, 3))
def test_base_parameters_give_the_same_forces_exactly(seed, count):
    given = tree(seed, count, kinds=tuple(KINDS), loads=False)
    if not any(j.speeds for j in given.joints):
        return
    found = base_parameters(given, armature=True)
    (q, u), draw = state(given, seed + 1), random.Random(seed)
    udot = [number(draw) for _ in u]
    Y = entries(given, bones_of(given, lambda x: x, EXACT), (q, u, udot), found.columns, EXACT)
    names = [c.name for c in found.columns]
    kept = [Y[names.index(n)] for n in found.combinations]
    pi = values_of(given, found.columns)
    beta = found.values([sp.Rational(Fraction(x).numerator, Fraction(x).denominator) for x in pi])
    beta = [Fraction(int(x.p), int(x.q)) for x in beta]
    assert times(kept, beta) == times(Y, pi)
    assert all(not any(Y[names.index(n)]) for n in found.dropped)


def rank(given, **options):
    """The rank of the regressor at random states in doubles, by singular values."""
    columns = parameters_of(given, **options)
    work, draw = Numbers(math.sin, math.cos), random.Random(1)
    lumped = bones_of(given, lambda x: x if x in {0, 1, -1} else float(x), work)
    rows = []
    for _ in range(2 * len(columns) // lumped.speeds):
        q, u, udot = ([draw.uniform(-2, 2) for _ in range(n)]
                      for n in (lumped.coordinates, lumped.speeds, lumped.speeds))  # fmt: skip
        Y = entries(given, lumped, (q, u, udot), columns, work)
        rows += np.array([[float(x) for x in c] for c in Y]).T.tolist()
    return np.linalg.matrix_rank(np.array(rows), rtol=1e-9)


def serial(turns, places, kinds=None, gravity=(0, 0, -10)):
    n = len(turns)
    kinds = kinds or ["revolute"] * n
    names = ["ground", *(f"b{k + 1}" for k in range(n))]
    joints = [
        Joint(
            f"j{k + 1}", kinds[k], names[k], names[k + 1], on_parent=Placement(places[k], turns[k])
        )
        for k in range(n)
    ]
    return Tree("arm", [Body(name, 1) for name in names[1:]], joints, gravity=gravity)


def puma():
    """Axes and offsets of the Puma 560: the first axis along gravity."""
    places = [(0, 0, 0), (0, 0, 0), (0.4318, 0, 0.15005), (0.0203, 0.4318, 0), (0, 0, 0), (0, 0, 0)]
    return serial([IDENTITY, QUARTER, IDENTITY, QUARTER, BACK, QUARTER], places)


def seven_joints():
    """Axes of the KUKA LWR: each at a right angle to the one before."""
    places = [
        (0, 0, 0.3105),
        (0, 0, 0),
        (0, 0.4, 0),
        (0, 0, 0),
        (0, -0.39, 0),
        (0, 0, 0),
        (0, 0, 0),
    ]
    return serial([IDENTITY, QUARTER, BACK, BACK, QUARTER, QUARTER, BACK], places)


def floating(count):
    """A free body with a chain of revolute joints in general position on it."""
    given = tree(5, count, kinds=("revolute",), loads=False)
    free = Joint("base", "free", "ground", "b0", attitude="3-2-1")
    chain = tuple(replace(j, parent=f"b{k}") for k, j in enumerate(given.joints[1:]))
    return replace(given, joints=(free, *chain))


@pytest.mark.parametrize(
    ("given", "count"),
    [
        (puma(), 36),  # Gautier and Khalil 1990; Mayeda, Yoshida and Osuka 1990
        pytest.param(seven_joints(), 43, marks=pytest.mark.slow),  # Jubien, Gautier and Janot 2014
        (floating(1), 10),  # Ayusawa, Venture and Nakamura 2014: 10 + 7 n
        (floating(3), 24),
    ],
    ids=["Puma 560", "KUKA LWR", "free body", "two joints on a free body"],
)
def test_published_numbers_of_base_parameters(given, count):
    assert base_parameters(given).count == count == rank(given)


def planar(gravity):
    bodies = [Body("a", 1), Body("b", 1)]
    joints = [Joint("one", "revolute", "ground", "a"),
              Joint("two", "revolute", "a", "b", on_parent=Placement((l, 0, 0)))]  # fmt: skip
    return Tree("planar", bodies, joints, gravity=gravity)


def test_a_planar_arm_of_two_links():
    """As in any textbook: J1 + m2 l^2, J2, and the first moments; gravity shows those of link 1."""
    J1, m2, J2, h1, h2 = (
        sp.Symbol(n, real=True) for n in ("J_a_33", "m_b", "J_b_33", "h_a_1", "h_a_2")
    )
    x, y = sp.symbols("h_b_1 h_b_2", real=True)
    still = {"J_a_33": J1 + m2 * l**2, "J_b_33": J2, "h_b_1": x, "h_b_2": y}
    assert base_parameters(planar((0, 0, 0))).combinations == still
    pulled = {**still, "h_a_1": h1 + m2 * l, "h_a_2": h2}
    found = base_parameters(planar((0, -g, 0)))
    assert found.combinations == pulled
    assert found.count == 6
    assert "m_a" in found.dropped


def test_grouping_of_a_revolute_joint_is_that_of_gautier_and_khalil():
    """Of a link on a revolute joint about z, J22, h3 and m go to others: J11 - J22 stays, and J22 joins."""
    found = base_parameters(serial([IDENTITY, QUARTER], [(0, 0, 0), (l, 0, 0)]))
    J11, J22, h3, m2 = (sp.Symbol(n, real=True) for n in ("J_b2_11", "J_b2_22", "h_b2_3", "m_b2"))
    assert found.combinations["J_b2_11"] == J11 - J22
    assert found.combinations["J_b1_33"] == sp.Symbol("J_b1_33", real=True) + J22 + l**2 * m2
    assert {"J_b2_22", "h_b2_3", "m_b2"}.isdisjoint(found.combinations)
    assert h3 not in found.combinations["J_b2_11"].free_symbols


def test_a_prismatic_joint_shows_no_inertia_of_its_link():
    found = base_parameters(
        serial([IDENTITY, QUARTER], [(0, 0, 0), (1, 2, 3)], ["revolute", "prismatic"])
    )
    assert {n for n in found.combinations if "b2" in n} == {
        "h_b2_1",
        "h_b2_2",
        "h_b2_3",
        "m_b2",
    } - {n for n in ("h_b2_2",) if n not in found.combinations}
    assert not any(n.startswith("J_b2") for n in found.combinations)


def test_armatures_join_moments_at_right_angles_and_dampings_stay():
    """As in Gautier and Khalil: those of the first two joints, at a right angle, not that of the third."""
    given = serial([IDENTITY, QUARTER, IDENTITY], [(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    found = base_parameters(given, armature=True, damping=True, coulomb=True)
    for k in (1, 2):
        assert f"armature_u_j{k}" not in found.combinations
        joined = found.combinations[f"J_b{k}_33"]
        assert sp.Symbol(f"armature_u_j{k}", real=True) in joined.free_symbols
    own = {f"{letter}_u_j{k}" for letter in ("damping", "coulomb") for k in (1, 2, 3)}
    assert {"armature_u_j3", *own} <= set(found.combinations)
    assert all(found.combinations[n] == sp.Symbol(n, real=True) for n in own)


def test_rounded_rotations_do_not_raise_the_rank():
    """An arm whose parallel axes are turned by cosines and sines in doubles."""
    turn = [[math.cos(0.3), math.sin(0.3), 0], [-math.sin(0.3), math.cos(0.3), 0], [0, 0, 1]]
    given = serial([turn, turn, turn], [(0, 0, 0), (1, 0, 0), (0.5, 0.25, 0)], gravity=(0, 0, 0))
    assert base_parameters(given).count == 7 == rank(given)


def test_symbols_of_masses_and_forces_do_not_matter():
    m, k, f = sp.symbols("m k f", real=True)
    given = planar((0, -g, 0))
    reported = replace(
        given,
        bodies=tuple(Body(b.name, m, (l, 0, 0), (m * l**2, m, m)) for b in given.bodies),
        joints=tuple(
            replace(j, stiffness=k, damping=k, armature=m, force=f * sp.sin(f))
            for j in given.joints
        ),
        loads=(Load(given.bodies[-1].name, force=(f, 0, 0)),),
    )
    assert base_parameters(reported) == base_parameters(given)


def test_values_of_base_parameters_need_a_value_a_column():
    found = base_parameters(planar((0, -g, 0)))
    with pytest.raises(InputError, match="one value a column"):
        found.values([1, 2])


def test_nothing_moves_nothing():
    given = Tree("still", [Body("a", 1)], [Joint("j", "fixed", "ground", "a")])
    found = base_parameters(given)
    assert found.count == 0
    assert len(found.dropped) == 10


def test_the_same_tree_gives_the_same_bytes():
    assert repr(base_parameters(puma())) == repr(base_parameters(puma(), seed=1))


def test_what_cannot_be_done_is_reported():
    angle = sp.Symbol("a", real=True)
    turn = [[sp.cos(angle), sp.sin(angle), 0], [-sp.sin(angle), sp.cos(angle), 0], [0, 0, 1]]
    with pytest.raises(InputError, match="rational"):
        base_parameters(serial([turn], [(0, 0, 0)]))
    driven = Tree("t", [Body("a", 1)], [Joint("j", "revolute", "ground", "a", motion=1)])
    with pytest.raises(InputError, match="prescribed motion"):
        regressor(driven)
    root = serial([IDENTITY, QUARTER], [(0, 0, 0), (1 / l**5, 0, 0)])
    with pytest.raises(InputError, match="polynomials"):
        base_parameters(root)


@given(st.fractions(), st.fractions().filter(bool))
def test_residues_are_a_field(a, b):
    x, y = Residue(residue(a)), Residue(residue(b))
    for found, value in ((x + y, a + b), (x - y, a - b), (x * y, a * b), (x / y, a / b),
                         (1 / y, 1 / b), (2 - x, 2 - a), (-x, -a), (x + 1, a + 1)):  # fmt: skip
        assert residue(found) == residue(value) % PRIME


@examples(25)
@given(st.lists(st.floats(-3, 3), min_size=4, max_size=4))
def test_rounded_rotations_become_exact_ones_nearby(parts):
    q = np.array([4.0 + parts[0], *parts[1:]])
    a, b, c, d = q / np.linalg.norm(q)
    C = [[1 - 2 * (c * c + d * d), 2 * (b * c + a * d), 2 * (b * d - a * c)],
         [2 * (b * c - a * d), 1 - 2 * (b * b + d * d), 2 * (c * d + a * b)],
         [2 * (b * d + a * c), 2 * (c * d - a * b), 1 - 2 * (b * b + c * c)]]  # fmt: skip
    exact = rotation(Placement(rotation=C).rotation)
    assert [list(row) for row in product(exact, transposed(exact))] == [
        list(row) for row in IDENTITY
    ]
    assert np.allclose(np.array(exact, float), C, atol=1e-6)
    near = unit(Joint("j", "revolute", "ground", "b", axis=[float(x) for x in C[0]]).axis)
    assert sum(x * x for x in near) == 1
    assert np.allclose([float(x) for x in near], C[0], atol=1e-6)


def test_exact_geometry_stays():
    given = puma()
    assert orthonormal(given) == given
