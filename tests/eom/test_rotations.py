"""Quaternions and matrices over exact scalars: laws that hold to the last digit, and any kind of scalar."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.fields import RATIONALS, RESIDUES
from eom.rotations import (
    cosines,
    matrix_of_quaternion,
    parameters,
    quaternion_of_matrix,
    quaternion_product,
    unit_quaternion,
)

numbers = st.fractions(-9, 9, max_denominator=9)
quaternions = st.tuples(numbers, numbers, numbers, numbers)
units = st.tuples(numbers, numbers, numbers).map(unit_quaternion)


def norm(q):
    return sum(x * x for x in q)


def times(A, B):
    return [
        [sum(a * b for a, b in zip(r, c, strict=True)) for c in zip(*B, strict=True)] for r in A
    ]


@given(quaternions, quaternions, quaternions)
def test_the_product_is_sympy_s_associative_and_keeps_norms(p, q, r):
    expected = sp.Quaternion(*map(sp.Rational, p)) * sp.Quaternion(*map(sp.Rational, q))
    assert [sp.Rational(x) for x in quaternion_product(p, q)] == list(expected.args[:4])
    left = quaternion_product(quaternion_product(p, q), r)
    assert left == quaternion_product(p, quaternion_product(q, r))
    assert norm(quaternion_product(p, q)) == norm(p) * norm(q)
    conjugate = (q[0], *(-x for x in q[1:]))
    assert quaternion_product(q, conjugate) == (norm(q), 0, 0, 0)


@given(quaternions, quaternions)
def test_the_turn_p_is_followed_by_the_turn_q(p, q):
    assert cosines(quaternion_product(p, q)) == times(cosines(q), cosines(p))


@given(quaternions)
def test_matrices_are_rotations_times_the_squared_norm(q):
    C, square = cosines(q), norm(q)
    turned = [list(row) for row in zip(*C, strict=True)]
    assert times(C, turned) == [[square**2 * (i == k) for k in range(3)] for i in range(3)]
    assert sp.Matrix(3, 3, [sp.Rational(x) for row in C for x in row]).det() == square**3


@given(units)
def test_a_quaternion_comes_back_from_its_matrix(q):
    assert norm(q) == 1
    found = parameters(cosines(q))
    size = max(range(4), key=lambda n: abs(found[n]))
    assert found[size] > 0
    assert found == [x * found[size] / q[size] for x in q]
    assert cosines(found) == [[norm(found) * x for x in row] for row in cosines(q)]


@given(units)
def test_in_floats_the_quaternion_has_norm_1_and_a_scalar_that_is_not_negative(q):
    found = quaternion_of_matrix(matrix_of_quaternion([float(x) for x in q]))
    sign = next((1 if x > 0 else -1 for x in q if x), 1)
    assert found[0] >= 0
    assert math.isclose(norm(found), 1, abs_tol=1e-15)
    expected = [float(sign * x) for x in q]
    assert any(found == pytest.approx([s * x for x in expected], abs=1e-14) for s in (1, -1))


def test_a_turn_about_the_third_axis_takes_components_into_the_turned_frame():
    angle = sp.Symbol("angle", real=True)
    q = (sp.cos(angle / 2), 0, 0, sp.sin(angle / 2))
    expected = [[sp.cos(angle), sp.sin(angle), 0], [-sp.sin(angle), sp.cos(angle), 0], [0, 0, 1]]
    assert sp.simplify(sp.Matrix(cosines(q)) - sp.Matrix(expected)) == sp.zeros(3, 3)


def test_all_scalars_give_the_same():
    draw = random.Random(0)
    p, q = ([RATIONALS.draw(draw) for _ in range(4)] for _ in range(2))
    exact, C = quaternion_product(p, q), cosines(p)
    a, b = ([RESIDUES.of(x) for x in given] for given in (p, q))
    assert [RESIDUES.reduce(x) for x in quaternion_product(a, b)] == [RESIDUES.of(x) for x in exact]
    rows = [[RESIDUES.reduce(x) for x in row] for row in cosines(a)]
    assert rows == [[RESIDUES.of(x) for x in row] for row in C]
    many = np.array([[float(Fraction(x))] * 3 for x in p])
    assert np.allclose(np.array(cosines(many))[..., 2], np.array(C, dtype=float), rtol=1e-14)
