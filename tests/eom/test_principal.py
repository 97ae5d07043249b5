"""Which inertia matrices have principal axes, and what shows that no body has one."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom import InputError
from eom.mass.inertia import check_matrix
from eom.mass.principal import KINDS, TRIANGLE, definiteness, principal_axes
from tests.draws import examples, nonzero

x = sp.Symbol("x", real=True)
m, L = sp.symbols("m L", positive=True)


def rod(direction, mass=1):
    """Inertia matrix about the end of a thin rod of length sqrt(3): m (1 - u u^T)."""
    u = np.array(direction) / np.linalg.norm(direction)
    return mass * (np.eye(3) - np.outer(u, u))


component = st.floats(-1, 1)
directions = st.tuples(nonzero(0.1, 1), component, component).flatmap(st.permutations)


@examples(60)
@given(direction=directions, mass=st.floats(1e-3, 1e3))
def test_thin_rods_in_any_direction(direction, mass):
    J = rod(direction, mass)
    found, verdict = principal_axes(J), definiteness(J)
    assert found.moments[0] == pytest.approx(0, abs=1e-14 * mass)
    assert found.moments[0] >= 0
    assert found.moments[1:] == pytest.approx((mass, mass), rel=1e-14)
    assert verdict.kind == "positive semi-definite"
    along = np.dot(verdict.axis, direction) / np.linalg.norm(direction)
    assert abs(along) == pytest.approx(1, abs=1e-14)


@pytest.mark.parametrize("zero", [0, 0.0])
def test_a_point_mass_at_the_reference_point(zero):
    J = [[zero] * 3] * 3
    assert principal_axes(J).moments == (0, 0, 0)
    assert np.array(principal_axes(J).C, dtype=float).tolist() == np.eye(3).tolist()
    assert definiteness(J).kind == "positive semi-definite"


def test_exact_rod():
    u = sp.Matrix([1, 2, 2]) / 3
    found = principal_axes(sp.eye(3) - u * u.T)
    assert found.moments == (0, 1, 1)
    assert found.C.row(0) == sp.ImmutableMatrix([[1, 2, 2]]) / 3
    assert definiteness(sp.eye(3) - u * u.T).axis == tuple(u)


def test_rod_in_symbols():
    J = m * L**2 / 12 * sp.diag(0, 1, 1)
    found = principal_axes(J)
    assert (found.moments, found.C) == ((0, J[1, 1], J[2, 2]), sp.eye(3))


# matrix; kind, value and witness worked by hand
CASES = {
    "definite": ([[2, 0, 0], [0, 3, 0], [0, 0, 4]], "positive definite", 2, (1, 0, 0)),
    "definite, off axis": ([[3, 1, 0], [1, 3, 0], [0, 0, 4]], "positive definite", 2, (1, -1, 0)),
    "lamina": ([[1, 0, 0], [0, 3, 0], [0, 0, 2]], "positive definite", 1, (1, 0, 0)),
    "float lamina": ([[0.1, 0, 0], [0, 0.3, 0], [0, 0, 0.2]], "positive definite", 0.1, (1, 0, 0)),
    "rod": ([[2, 0, 0], [0, 0, 0], [0, 0, 2]], "positive semi-definite", 0, (0, 1, 0)),
    "negative": ([[1, 2, 0], [2, 1, 0], [0, 0, 1]], "impossible", -1, (1, -1, 0)),
    "negative moment": ([[1, 0, 0], [0, 1, 0], [0, 0, -1.0]], "impossible", -1, (0, 0, 1)),
    "triangle": ([[1, 0, 0], [0, 1, 0], [0, 0, 3]], "impossible", -1, (0, 0, 1)),
    "no rod": ([[0, 0, 0], [0, 1, 0], [0, 0, 2]], "impossible", -1, (0, 0, 1)),
    "hidden triangle": ([[4, 3, 3], [3, 4, 3], [3, 3, 4]], "impossible", -8, (1, 1, 1)),
    "irrational": ([[2, 1, 1], [1, 3, 0], [1, 0, 4]], "impossible", None, None),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_definiteness_and_its_witness(name):
    J, kind, value, axis = CASES[name]
    found = definiteness(J)
    assert found.kind == kind
    w = np.array(found.axis, dtype=float)
    assert w @ w == pytest.approx(1)
    if axis is None:
        return
    assert float(found.value) == pytest.approx(value, abs=1e-15)
    assert np.abs(w @ np.array(axis)) == pytest.approx(np.linalg.norm(axis))
    moment = w @ np.array(J, dtype=float) @ w
    seen = np.trace(np.array(J, dtype=float)) - 2 * moment if found.reason == TRIANGLE else moment
    assert seen == pytest.approx(value, abs=1e-14)


def test_every_kind_is_reached():
    assert {(f.kind, f.reason) for f in (definiteness(c[0]) for c in CASES.values())} == {
        (k.kind, k.reason) for k in KINDS
    }


@pytest.mark.parametrize("name", [n for n in CASES if CASES[n][1] == "impossible"])
def test_impossible_matrices_are_refused_with_the_violated_condition(name):
    J = CASES[name][0]
    with pytest.raises(InputError, match="no body has this inertia matrix") as caught:
        principal_axes(J)
    assert definiteness(J).reason in caught.value.what
    assert caught.value.where == "inertia matrix"
    assert "about the axis" in caught.value.got


entries = st.integers(-20, 20)


@examples(100)
@given(diagonal=st.tuples(*[st.integers(0, 20)] * 3), off=st.tuples(entries, entries, entries))
def test_exactly_the_matrices_that_check_matrix_accepts_and_the_rods(diagonal, off):
    a, b, c = diagonal
    d, e, f = off
    J = [[a, d, e], [d, b, f], [e, f, c]]
    kind = definiteness(J).kind
    if kind == "positive definite":
        check_matrix(J, "here")
    else:
        with pytest.raises(InputError):
            check_matrix(J, "here")
    if kind == "positive semi-definite":
        values = np.linalg.eigvalsh(np.array(J, dtype=float))
        assert values == pytest.approx([0, values[2], values[2]], abs=1e-12)


BAD = {
    "asymmetric": ([[1, 1, 0], [0, 1, 0], [0, 0, 1]], "not symmetric"),
    "asymmetric fractions": ([[1, Fraction(1, 10**20), 0], [0, 1, 0], [0, 0, 1]], "not symmetric"),
    "asymmetric floats": ([[1.0, 1e-11, 0], [0, 1, 0], [0, 0, 1]], "not symmetric"),
    "asymmetric symbols": ([[1, x, 0], [-x, 1, 0], [0, 0, 1]], "not symmetric"),
    "two by two": ([[1, 0], [0, 1]], "3 by 3"),
    "ragged": ([[1, 0, 0], [0, 1], [0, 0, 1]], "3 by 3"),
    "four rows": (sp.eye(4), "3 by 3"),
    "empty": ([], "3 by 3"),
    "number": (5, "not a matrix"),
    "vector": ([1, 2, 3], "not a matrix"),
    "none": (None, "not a matrix"),
    "text": ([["1", 0, 0], [0, 1, 0], [0, 0, 1]], "not a number"),
    "nan": ([[math.nan, 0, 0], [0, 1, 0], [0, 0, 1]], "not a finite real"),
    "infinite": ([[math.inf, 0, 0], [0, 1, 0], [0, 0, 1]], "not a finite real"),
    "zoo": ([[1, 0, 0], [0, 1, sp.zoo], [0, sp.zoo, 1]], "not a finite real"),
    "complex": ([[1, 0, 0], [0, 1, 1j], [0, 1j, 1]], "not a finite real"),
    "imaginary symbol": ([[1, 0, 0], [0, 1, sp.I * L], [0, sp.I * L, 1]], "not a finite real"),
    "truth": ([[True, 0, 0], [0, 1, 0], [0, 0, 1]], "not a finite real"),
    "large": ([[1e100, 0, 0], [0, 1e100, 0], [0, 0, 1]], "out of range"),
}


@pytest.mark.parametrize("name", BAD)
@pytest.mark.parametrize("function", [principal_axes, definiteness])
def test_bad_input_is_refused(function, name):
    J, message = BAD[name]
    with pytest.raises(InputError, match=message):
        function(J)


@pytest.mark.parametrize("J", [sp.diag(L, L, 3 * L), sp.diag(x, x, -L), sp.diag(-L, 1, 1)])
def test_symbols_that_no_values_make_a_body_are_refused(J):
    with pytest.raises(InputError, match="whatever its symbols are"):
        principal_axes(J)


def test_definiteness_needs_numbers():
    with pytest.raises(InputError, match="needs numbers"):
        definiteness(sp.diag(L, L, L))


@pytest.mark.parametrize("digits", [0, 14, 1001, 20.0, True, "30"])
def test_bad_digits_are_refused(digits):
    with pytest.raises(InputError, match="digits"):
        principal_axes(sp.eye(3), digits)


def test_kinds_of_input():
    expected = principal_axes([[3, 1, 0], [1, 3, 0], [0, 0, 3]])
    for given_matrix in (
        sp.Matrix([[3, 1, 0], [1, 3, 0], [0, 0, 3]]),
        np.array([[3, 1, 0], [1, 3, 0], [0, 0, 3]]),
        (iter(row) for row in ((3, 1, 0), (1, 3, 0), (0, 0, 3))),
    ):
        assert principal_axes(given_matrix) == expected
    floats = principal_axes(np.array([[3, 1, 0], [1, 3, 0], [0, 0, 3.0]]))
    assert floats.moments == (2.0, 3.0, 4.0)
    assert isinstance(floats.moments[0], float)


def test_asymmetry_of_rounding_is_taken_as_symmetric():
    J = [[3.0, 1.0 + 4e-16, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 3.0]]
    assert principal_axes(J).moments == pytest.approx((2, 3, 4), rel=1e-15)
