"""Which inertia matrices a body can have: against clouds of point masses and their eigenvalues."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.mass import inertia
from eom.mass.inertia import (
    check_matrix,
    check_principal_moments,
    inertia_of_second_moments,
    integrate_over_mass,
    matrix_conditions,
    physical,
    principal_conditions,
    second_moments_of_inertia,
)
from tests.draws import examples

whole = st.integers(-9, 9)
points = st.lists(st.tuples(whole, whole, whole, st.integers(1, 5)), min_size=1, max_size=6)


def cloud(masses):
    """Exact second moments and inertia matrix of point masses (x, y, z, m) about the origin."""
    S, J = sp.zeros(3), sp.zeros(3)
    for x, y, z, m in masses:
        S += m * sp.Matrix([x, y, z]) * sp.Matrix([[x, y, z]])
        # Lecture 000, the printed matrix under [I_C].
        J += m * sp.Matrix(
            [
                [y * y + z * z, -x * y, -x * z],
                [-x * y, x * x + z * z, -y * z],
                [-x * z, -y * z, x * x + y * y],
            ]
        )
    return S, J


@examples(40)
@given(masses=points)
def test_inertia_of_point_masses_is_the_printed_matrix(masses):
    S, J = cloud(masses)
    assert sp.Matrix(inertia_of_second_moments(S)) == J
    assert sp.Matrix(second_moments_of_inertia(J)) == S


def test_inverse_of_the_second_moments_in_symbols():
    J = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"J{min(i, j)}{max(i, j)}"))
    assert sp.Matrix(inertia_of_second_moments(second_moments_of_inertia(J))).expand() == J
    S = sp.Matrix(second_moments_of_inertia(J))
    expected = J.trace() / 2 * sp.eye(3) - J
    assert (S - expected).expand() == sp.zeros(3)


@examples(40)
@given(masses=points)
def test_every_cloud_meets_the_conditions_of_a_body(masses):
    _, J = cloud(masses)
    assert all(c >= 0 for c in matrix_conditions(J))
    assert all(c >= 0 for c in principal_conditions([J[k, k] for k in range(3)]))
    if J.is_positive_definite:
        check_matrix([[float(e) for e in J.row(i)] for i in range(3)], "here")


entries = st.integers(-20, 20)


@examples(60)
@given(diagonal=st.tuples(*[st.integers(1, 20)] * 3), off=st.tuples(entries, entries, entries))
def test_matrix_is_accepted_exactly_if_its_principal_moments_are_possible(diagonal, off):
    """The oracle is the eigenvalues by LAPACK; cases on the boundary are left out."""
    a, b, c = diagonal
    d, e, f = off
    J = [[a, d, e], [d, b, f], [e, f, c]]
    lowest, middle, highest = np.linalg.eigvalsh(np.array(J, dtype=float))
    slack = lowest + middle - highest
    assume(abs(slack) > 1e-6)
    assume(abs(lowest) > 1e-6)
    possible = lowest > 0 and slack > 0
    if possible:
        check_matrix(J, "here")
    else:
        with pytest.raises(InputError):
            check_matrix(J, "here")


@examples(60)
@given(moments=st.tuples(*[st.floats(1e-3, 1e3)] * 3))
def test_moments_are_accepted_exactly_if_no_one_exceeds_the_other_two(moments):
    largest = max(moments)
    slack = sum(moments) - 2 * largest
    assume(abs(slack) > 1e-9 * largest)
    if slack > 0:
        check_principal_moments(moments, "here")
    else:
        with pytest.raises(InputError, match="exceeds the sum"):
            check_principal_moments(moments, "here")


@pytest.mark.parametrize(
    ("moments", "what"),
    [
        ((-1.0, 2.0, 2.0), "I1 is not positive"),
        ((1.0, -2.0, 2.0), "I2 is not positive"),
        ((1.0, 2.0, 0.0), "I3 is not positive"),
        ((math.nan, 1.0, 1.0), "I1 is not positive"),
        ((5.0, 2.0, 2.0), "I1 exceeds"),
        ((2.0, 5.0, 2.0), "I2 exceeds"),
        ((2.0, 2.0, 5.0), "I3 exceeds"),
    ],
)
def test_impossible_moments_are_named(moments, what):
    with pytest.raises(InputError, match=what) as caught:
        check_principal_moments(moments, "[body]")
    assert caught.value.where == "[body]"
    assert "I1 = " in caught.value.got


@pytest.mark.parametrize("moments", [(1.0, 1.0, 2.0), (0.1, 0.2, 0.1 + 0.2), (1e-9, 1.0, 1.0)])
def test_flat_and_thin_bodies_are_possible(moments):
    """A disc has I3 = I1 + I2, in floating point too; a rod has one small moment."""
    check_principal_moments(moments, "here")
    check_matrix(np.diag(moments).tolist(), "here")


@pytest.mark.parametrize(
    ("matrix", "what"),
    [
        ([[1, 0.1, 0], [0, 1, 0], [0, 0, 1]], "not symmetric"),
        ([[1, 2, 0], [2, 1, 0], [0, 0, 1]], "not positive definite"),
        ([[-1, 0, 0], [0, 1, 0], [0, 0, 1]], "not positive definite"),
        ([[0, 0, 0], [0, 1, 0], [0, 0, 1]], "not positive definite"),
        ([[1, 0, 0], [0, 1, 0], [0, 0, 2.1]], "triangle inequality"),
        ([[2, 1.5, 1.5], [1.5, 2, 1.5], [1.5, 1.5, 2]], "triangle inequality"),
    ],
)
def test_impossible_matrices_are_refused(matrix, what):
    with pytest.raises(InputError, match=what) as caught:
        check_matrix(matrix, "[body] matrix")
    assert caught.value.where == "[body] matrix"


def test_principal_conditions_are_the_triangle_inequalities():
    a, b, c = sp.symbols("a b c")
    assert set(principal_conditions((a, b, c))) == {-a + b + c, a - b + c, a + b - c}


def test_physical_assumption_of_a_matrix_is_about_its_minors():
    J = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"J{min(i, j)}{max(i, j)}"))
    assumption = physical(J)
    assert len(assumption.nonnegative) == 7
    values = dict(zip(sorted(J.free_symbols, key=str), (2, 0, 0, 2, 0, 5), strict=True))
    assert min(e.subs(values) for e in assumption.nonnegative) < 0
    assert physical(sp.diag(*sp.symbols("a b c"))).name == "physical_inertia"
    assert len(physical(sp.diag(*sp.symbols("a b c"))).nonnegative) == 3


def test_integral_of_a_quadratic_form():
    r = inertia._R
    S = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"S{min(i, j)}{max(i, j)}"))
    k = sp.Symbol("k")
    form = k * r[0] ** 2 + 3 * r[1] * r[2]
    assert sp.expand(integrate_over_mass(form, S) - (k * S[0, 0] + 3 * S[1, 2])) == 0
