"""Mass matrices of every kind: straight-line code, factorisations in loops, singular ones."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy.physics.mechanics.models import n_link_pendulum_on_cart

from codegen import compile as compile_system
from codegen.derivatives.derivative import JACOBIAN, ORDERS, jacobian
from codegen.frontend import lower as massmatrix
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point, interpret, interpret_exactly, interpret_with_bound
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Builder
from codegen.targets import c
from eom.quantities import Quantity
from eom.system import System
from tests.codegen.test_targets import COMPILERS, files_of, needs_compiler, strictly_compile

pytestmark = pytest.mark.sparse

x, y, z, p, q, r = sp.symbols("x y z p q r", real=True)
whole = st.integers(-3, 3)


def built(matrix, right):
    """The program that solves a system whose entries are parameters; zeros are left out."""
    b = Builder()
    n = len(right)
    numbers = [
        [b.leaf("parameter", i * n + j) if matrix[i][j] else b.const(0) for j in range(n)]
        for i in range(n)
    ]
    for i in range(n):
        for j in range(i):
            if matrix[i][j] == matrix[j][i]:
                numbers[i][j] = numbers[j][i]
    return b.program({RATES: massmatrix.solve(b, numbers, [b.leaf("state", i) for i in range(n)])})


def at(matrix, right):
    return Point(x=[float(v) for v in right], p=[float(v) for row in matrix for v in row])


@st.composite
def systems(draw):
    """Regular matrices of small whole numbers: symmetric or not, many zeros, and a right-hand side."""
    n = draw(st.integers(1, 5))
    entries = [[draw(whole) if draw(st.booleans()) else 0 for _ in range(n)] for _ in range(n)]
    M = sp.Matrix(entries)
    if draw(st.booleans()):
        M = M + M.T
    while M.det() == 0:
        M += sp.eye(n)
    return M, sp.Matrix([draw(whole) for _ in range(n)])


@settings(max_examples=100)
@given(systems())
def test_solutions_against_rational_arithmetic(system):
    M, right = system
    program = built(M.tolist(), list(right))
    point = at(M.tolist(), right)
    exact = interpret_exactly(program, point)[RATES]
    bounded = interpret_with_bound(program, point)[RATES]
    rounded = interpret(program, point)[RATES]
    for k, e in enumerate(M.LUsolve(right)):
        with mpmath.workdps(50):
            true = mpmath.mpf(e.p) / e.q
            if mpmath.isnan(exact[k]):  # a pivot that is zero, without exchanges
                assert "factor" not in program.counts()
                continue
            assert abs(exact[k] - true) < 1e-44
            assert abs(rounded[k] - true) <= bounded[k].error


@settings(max_examples=60)
@given(st.integers(1, 5), st.data())
def test_positive_definite_blocks_are_unrolled(n, data):
    """L L^T + 1 with zeros in L, entries given as expressions of the entries of L."""
    L = sp.Matrix(n, n, lambda i, j: data.draw(whole) if j <= i else 0)
    b = Builder()
    lower = [
        [b.leaf("parameter", i * n + j) if L[i, j] else b.const(0) for j in range(n)]
        for i in range(n)
    ]
    numbers = [[_entry(b, lower, i, j) for j in range(n)] for i in range(n)]
    right = [data.draw(whole) for _ in range(n)]
    loads = [b.leaf("state", i) for i in range(n)]
    program = prune(b.program({RATES: massmatrix.solve(b, numbers, loads)}))
    assert "factor" not in program.counts()
    found = interpret_exactly(program, at(L.tolist(), right))[RATES]
    for value, e in zip(found, (L * L.T + sp.eye(n)).LUsolve(sp.Matrix(right)), strict=True):
        with mpmath.workdps(50):
            assert abs(value - mpmath.mpf(e.p) / e.q) < 1e-40


def _entry(b, lower, i, j):
    total = b.const(int(i == j))
    for k in range(min(i, j) + 1):
        total = b.add("add", total, b.add("mul", lower[i][k], lower[j][k]))
    return total


def of_matrix(entries, name="made"):
    """x, y, z with M (x, y, z)' = (y, z, x + 1); M over p, q, r."""
    parameters = (Quantity(p), Quantity(q), Quantity(r))
    states = (x, y, z)[: len(entries)]
    rates = (y, -x, x + 1)[: len(entries)]
    return System(
        name, tuple(map(Quantity, states)), rates, parameters,
        mass_matrix=sp.ImmutableMatrix(entries),
    )  # fmt: skip


KINDS = {
    "positive definite": [[2 + p, q / 4, 0], [q / 4, 2, r / 4], [0, r / 4, 3]],
    "indefinite": [[0, 1 + p, 0], [1 + p, 0, r], [0, r, q]],
    "saddle point": [[p, 0, 1], [0, q, r], [1, r, 0]],
    "not symmetric": [[p, q, 0], [-q, p, 0], [1, 0, r]],
    "apart": [[p, 0, q], [0, r, 0], [q, 0, 4 + p]],
    "a permutation": [[0, p, 0], [0, 0, q], [r, 0, 0]],
}
VALUES = (1.3, 0.7, 1.1)


@pytest.mark.parametrize("unrolled", [0, 8])
@pytest.mark.parametrize("kind", KINDS)
def test_targets_solve_every_kind(kind, unrolled, target, monkeypatch):
    monkeypatch.setattr(massmatrix, "UNROLLED", unrolled)
    system = of_matrix(KINDS[kind])
    f = compile_system(system, target).rhs
    states = np.array([[0.3, -1.2], [0.9, 0.1], [-0.4, 2.0]])
    found = f(0.0, states, VALUES)
    M = np.array(system.mass_matrix.subs(dict(zip((p, q, r), VALUES, strict=True))), dtype=float)
    right = np.array([states[1], -states[0], states[0] + 1])
    np.testing.assert_allclose(found, np.linalg.solve(M, right), rtol=1e-13)
    for k in range(2):
        np.testing.assert_array_equal(f(0.0, states[:, k].copy(), VALUES), found[:, k])


@pytest.mark.parametrize("unrolled", [0, 8])
def test_a_singular_matrix_gives_nan_at_its_points_alone(unrolled, target, monkeypatch):
    monkeypatch.setattr(massmatrix, "UNROLLED", unrolled)
    mass = [[2 + x, 1 + x], [1 + x, 2 + x - p]]
    f = compile_system(of_matrix(mass), target).rhs
    at_p_3 = [1.5, 0.0, 0.0]
    states = np.array([[0.0, -0.5], [1.0, 1.0]])
    at_p_3[0] = 2 - 0.5  # 2 (2 - p) = 1: singular at x = 0
    found = f(0.0, states, at_p_3)
    assert not np.isfinite(found[:, 0]).any()
    assert np.isfinite(found[:, 1]).all()


def test_uncoupled_states_cost_one_division_each():
    mass = [[p, 0, 0], [0, q, 0], [0, 0, r]]
    assert prune(lower_system(of_matrix(mass)), [RATES]).counts() == {"add": 1, "div": 3, "neg": 1}


@pytest.mark.parametrize("slip", [0, sp.Rational(1, 10**20)])
def test_entries_that_are_written_differently_are_compared_by_value(slip):
    one, other = sp.sin(2 * x) + p * (q + 1), 2 * sp.sin(x) * sp.cos(x) + p * q + p + slip
    program = lower_system(of_matrix([[9, one], [other, 5 + p * q]]))
    assert ("factor" in program.counts()) == bool(slip)


PENDULUM = n_link_pendulum_on_cart(3)


def test_larger_matrices_against_straight_line_code(target, monkeypatch):
    """Both within the bound of the interpreter, one state and many, and to a few units."""
    straight = compile_system(PENDULUM, target)
    monkeypatch.setattr(massmatrix, "UNROLLED", 2)
    looped = compile_system(PENDULUM, target)
    assert "factor" in looped.program.counts()
    draw = np.random.default_rng(2).uniform
    layout = looped.layout
    states = draw(-1, 1, (len(layout.states), 7))
    values, push = draw(0.5, 1.5, len(layout.parameters)), draw(-1, 1, len(layout.inputs))
    found = looped.rhs(0.0, states, values, push)
    np.testing.assert_allclose(found, straight.rhs(0.0, states, values, push), rtol=1e-11)
    for k in range(7):
        point = Point(0.0, states[:, k].tolist(), values.tolist(), push.tolist())
        for got, known in zip(
            found[:, k], interpret_with_bound(looped.program, point)[RATES], strict=True
        ):
            assert abs(got - known.value) <= known.error


def _somewhere(layout):
    states = np.linspace(-1, 1, len(layout.states))
    return 0.0, states, np.linspace(0.5, 1.5, len(layout.parameters)), [0.3]


@needs_compiler
@pytest.mark.parametrize("most", [1, 7, 400])
def test_factorisations_pass_from_part_to_part(most, monkeypatch):
    monkeypatch.setattr(massmatrix, "UNROLLED", 0)
    whole_text = compile_system(PENDULUM, "c")
    monkeypatch.setattr(c, "PART_LINES", most)
    split_text = compile_system(PENDULUM, "c")
    layout = whole_text.layout
    arguments = (
        0.0,
        np.linspace(-1, 1, len(layout.states)),
        np.linspace(0.5, 1.5, len(layout.parameters)),
        [0.3],
    )
    np.testing.assert_array_equal(split_text.rhs(*arguments), whole_text.rhs(*arguments))


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("most", [3, 400])
def test_factorisations_pass_strict_compilers(compiler, most, tmp_path, monkeypatch):
    monkeypatch.setattr(massmatrix, "UNROLLED", 0)
    monkeypatch.setattr(c, "PART_LINES", most)
    strictly_compile(files_of(of_matrix(KINDS["saddle point"])), tmp_path, compiler)


@pytest.mark.parametrize("kind", KINDS)
def test_jacobians_of_solutions_against_straight_line_code(kind, monkeypatch):
    """By states and by parameters, in every order of elimination; and against differences."""
    system = of_matrix(KINDS[kind])
    monkeypatch.setattr(massmatrix, "UNROLLED", 0)
    program = prune(lower_system(system), [RATES])
    states, values = [0.3, -1.2, 0.8], list(VALUES)
    for slot in ("state", "parameter"):
        matrices = [
            _dense(jacobian(program, RATES, slot, [mode]), Point(0.0, states, values))
            for mode in ORDERS
        ]
        for k in range(3):
            sides = []
            for shift in (2.0**-20, -(2.0**-20)):
                moved = [list(states), list(values)]
                moved[slot == "parameter"][k] += shift
                sides.append(interpret_exactly(program, Point(0.0, *moved))[RATES])
            for row in range(3):
                slope = (sides[0][row] - sides[1][row]) * 2**19
                for matrix in matrices:
                    assert abs(matrix.get((row, k), 0) - slope) < 1e-9 * (1 + abs(slope))


def _dense(derived, point):
    entries = interpret_exactly(derived.program, point)[JACOBIAN]
    return dict(zip(derived.pattern, entries, strict=True))


@pytest.mark.slow
def test_jacobians_of_a_pendulum_do_not_depend_on_how_it_is_solved(target, monkeypatch):
    straight = compile_system(PENDULUM, target)
    monkeypatch.setattr(massmatrix, "UNROLLED", 2)
    looped = compile_system(PENDULUM, target)
    arguments = _somewhere(looped.layout)
    for by in ("states", "parameters", "inputs"):
        found, known = (c.jacobian(by).dense(*arguments) for c in (looped, straight))
        np.testing.assert_allclose(found, known, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (sp.floor(x / 2), sp.Integer(0)),
        (sp.Abs(x), x),
        (sp.sqrt(x**2 + 2 * x * y + y**2), x + y),
        (sp.Piecewise((x, x > -2), (1, True)), x),
        (sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1, sp.Integer(0)),
    ],
)
def test_entries_that_are_the_same_only_at_some_points_are_no_symmetry(one, other):
    """floor(x/2) is zero, and |x| is x, wherever the samples are."""
    matrix = sp.Matrix([[2, one], [other, 5]])
    system = System(
        "pieces",
        (Quantity(x), Quantity(y)),
        (sp.Integer(1), y),
        mass_matrix=sp.ImmutableMatrix(matrix),
    )
    program = lower_system(system)
    for at_x in (-3.0, 0.7, 5.5):
        values = matrix.subs({x: at_x, y: 0.25})
        expected = values.LUsolve(sp.Matrix([1, 0.25]))
        got = interpret_exactly(program, Point(x=[at_x, 0.25]))[RATES]
        assert all(abs(float(a) - float(b)) < 1e-12 for a, b in zip(got, expected, strict=True))
