"""The reference of linear systems: exact solutions, singular matrices, the bound."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen.ir import linsolve
from codegen.ir.interpret import Point, interpret, interpret_with_bound
from codegen.ir.linsolve import Shape
from codegen.ir.ops import OPS
from codegen.ir.program import Builder

sizes = st.integers(1, 6)


def numbers(seed, *shape):
    return np.random.default_rng(seed).uniform(-3, 3, shape)


def exactly(matrix, right):
    with mpmath.workdps(50):
        return linsolve.back_exact(mpmath.mp, mpmath.matrix(matrix), *map(mpmath.mpf, right))


def program_of(shape):
    """Entries are parameters, right-hand sides are states, the solution is the results."""
    b = Builder()
    entries = [b.leaf("parameter", k) for k in range(shape.entries)]
    factor = b.add("factor", *entries, value=shape)
    back = b.add("back", factor, *(b.leaf("state", k) for k in range(shape.size)))
    return b.program({"x": [b.add("item", back, value=k) for k in range(shape.size)]})


@given(sizes, st.integers(0, 10**6))
def test_exact_solutions_fulfil_the_equations(n, seed):
    matrix, right = numbers(seed, n, n), numbers(seed + 1, n)
    matrix *= 10.0 ** np.random.default_rng(seed).integers(-40, 40, (n, 1))
    with mpmath.workdps(50):
        A, x = mpmath.matrix(matrix.tolist()), mpmath.matrix(exactly(matrix.tolist(), right))
        for i, rest in enumerate(A * x - mpmath.matrix(right.tolist())):
            assert abs(rest) < 1e-35 * sum(abs(A[i, j] * x[j]) for j in range(n))


@pytest.mark.parametrize(
    "matrix",
    [
        [[0]],
        [[1, 2], [2, 4]],
        [[0, 1], [0, 2]],
        [[1, 2, 3], [4, 0, 0], [6, 0, 0]],
        [[0] * 3] * 3,
        [[1, mpmath.inf], [0, 1]],
        [[mpmath.nan]],
    ],
)
def test_a_singular_matrix_has_no_solution_and_no_bound(matrix):
    right = [1.0] * len(matrix)
    assert all(map(mpmath.isnan, exactly(matrix, right)))
    if np.all(np.isfinite(np.array(matrix, dtype=float))):
        nothing = np.zeros((len(matrix), len(matrix)))
        given_errors = mpmath.matrix(matrix), nothing, [mpmath.mpf(v) for v in right], [0.0] * 3
        assert np.all(np.isinf(linsolve.bound(mpmath.mp, *given_errors)))


@settings(max_examples=40)
@given(sizes, st.booleans(), st.integers(0, 10**6))
def test_doubles_are_within_the_bound_and_the_bound_is_of_their_size(n, symmetric, seed):
    shape = Shape(n, symmetric)
    program = program_of(shape)
    point = Point(x=numbers(seed, n), p=numbers(seed + 1, shape.entries))
    whole = np.array(linsolve.whole(shape, point.p))
    got, bounds = interpret(program, point)["x"], interpret_with_bound(program, point)["x"]
    for value, bounded in zip(got, bounds, strict=True):
        assert abs(value - bounded.value) <= bounded.error
        scale = max(abs(b.value) for b in bounds)
        assert bounded.error <= 1e-12 * n**2 * np.linalg.cond(whole) * scale


def test_errors_of_the_operands_are_carried_to_the_solution():
    m = mpmath.mp
    matrix, right = m.matrix([[4, 1], [2, 3]]), [m.mpf(1), m.mpf(2)]
    errors = np.array([[1e-6, 0.0], [0.0, 2e-6]])
    bound = linsolve.bound(m, matrix, errors, right, [0.0, 1e-6])
    exact = exactly([[4, 1], [2, 3]], [1, 2])
    for signs in np.ndindex(2, 2, 2):
        a, d, r = (1 - 2 * s for s in signs)
        moved = exactly([[4 + a * 1e-6, 1], [2, 3 + d * 2e-6]], [1, 2 + r * 1e-6])
        shift = [float(abs(one - other)) for one, other in zip(moved, exact, strict=True)]
        assert all(s <= b * (1 + 1e-5) for s, b in zip(shift, bound, strict=True))
    assert max(bound) < 3e-6


def test_the_bound_of_a_matrix_that_is_not_symmetric_is_that_of_exchanges():
    """Without exchanges its second pivot is zero: -2 - (2)(-1)/1; it is regular nevertheless."""
    m = mpmath.mp
    matrix = m.matrix([[1, 2, 0], [-1, -2, 1], [1, 1, 1]])
    right = [m.mpf(v) for v in (1, 2, 3)]
    bound = linsolve.bound(m, matrix, np.zeros((3, 3)), right, [0.0] * 3)
    assert all(0 < b < 1e-13 for b in bound)


def test_entries_are_items_of_the_solution():
    back, item = OPS["back"], OPS["item"]
    solution = back.double(np.array([[2.0, 0.0], [0.0, 4.0]]), 1.0, 1.0)
    assert [item.double(k, solution) for k in range(2)] == [0.5, 0.25]
