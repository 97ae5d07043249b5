"""Values and axes of symmetric matrices against LAPACK, known rotations and 50-digit substitution."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given
from hypothesis import strategies as st

from eom.exact.identity import equal
from eom.exact.numbers import sign
from eom.kinematics.coordinates import attitude
from eom.mass.principal import PrincipalAxes, exact_axes, principal_axes
from tests.draws import examples
from tests.eom.rows import every

a, b, c, d, e, f = sp.symbols("a b c d e f", real=True)
whole = st.integers(-9, 9)
quaternions = st.tuples(whole, whole, whole, whole).filter(any)


def rotation(q):
    """Exact rotation matrix of integers that are not normalised (Euler and Rodrigues)."""
    w, x, y, z = (sp.Integer(n) for n in q)
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)],
        [2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)],
        [2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z],
    ]
    return sp.Matrix(rows) / (w * w + x * x + y * y + z * z)


def array(matrix):
    return np.array(sp.Matrix(matrix).evalf(30).tolist(), dtype=float)


def error(J, found, digits=50):
    """Greatest entry of C J C^T - diag and of C C^T - 1, and the determinant's distance from 1."""
    C, J = sp.Matrix(found.C).evalf(digits), sp.Matrix(J).evalf(digits)
    parts = [*(C * J * C.T - sp.diag(*found.moments).evalf(digits)), *(C * C.T - sp.eye(3))]
    return max(abs(float(x)) for x in (*parts, C.det(method="berkowitz") - 1))


def at(found, point, digits=60):
    """Values of closed forms at ``point``; common parts once, as evalf takes them one by one."""
    symbols = list(point)
    function = sp.lambdify(symbols, [*found.moments, *found.C], "mpmath", cse=True)
    with mpmath.workdps(digits):
        values = function(*(mpmath.mpf(v.p) / v.q for v in map(sp.Rational, point.values())))
        numbers = [sp.Float(mpmath.mpf(v), digits) for v in values]
    return PrincipalAxes(tuple(numbers[:3]), sp.Matrix(3, 3, numbers[3:]))


def follows_the_sign_rule(C):
    for row in np.array(C, dtype=float)[:2]:
        size = np.abs(row).max()
        assert row[next(k for k in range(3) if abs(row[k]) > size * (1 - 1e-9))] > 0


# --- floats -----------------------------------------------------------------------------------

second_moment = st.floats(0.01, 10)
gap = st.integers(1, 17).map(lambda n: 10.0**-n) | st.just(0.0)


@examples(100)
@given(q=quaternions, masses=st.tuples(second_moment, second_moment, second_moment))
def test_floats_against_lapack(q, masses):
    x, y, z = masses
    C = array(rotation(q))
    J = C.T @ np.diag([y + z, x + z, x + y]) @ C
    J = (J + J.T) / 2
    values = np.linalg.eigvalsh(J)
    assume(np.diff(values).min() > 1e-9 * values[2])
    found = principal_axes(J)
    assert all(isinstance(m, float) for m in found.moments)
    assert np.allclose(found.moments, values, rtol=0, atol=4e-15 * values[2])
    assert error(J, found) < 2e-15 * max(1, values[2])
    follows_the_sign_rule(found.C)
    _, vectors = np.linalg.eigh(J)
    overlap = np.abs(array(found.C) @ vectors)
    assert np.allclose(overlap, np.eye(3), atol=1e-14 * values[2] / np.diff(values).min())


@examples(100)
@given(q=quaternions, size=st.floats(0.5, 5), near=gap, ratio=st.floats(0.3, 1.9))
def test_nearly_equal_floats_are_diagonal_within_the_tolerance(q, size, near, ratio):
    C = array(rotation(q))
    J = C.T @ np.diag([size, size * (1 + near), size * ratio]) @ C
    J = (J + J.T) / 2
    found = principal_axes(J)
    values = np.linalg.eigvalsh(J)
    assert np.allclose(found.moments, values, rtol=0, atol=4e-15 * values[2])
    assert list(found.moments) == sorted(found.moments)
    clear = np.diff(values).min() > 2e-12 * values[2]
    assert error(J, found) < (3e-15 if clear else 1.1e-12) * max(1, values[2])


@examples(60)
@given(q=quaternions, size=st.floats(0.5, 5), ratio=st.sampled_from([0.4, 0.7, 1.5, 1.9]))
def test_axes_of_equal_moments_are_nearest_to_the_given_ones(q, size, ratio):
    """No other pair in the plane, turned in steps of a degree, lies nearer to two axes of B."""
    C = array(rotation(q))
    J = C.T @ np.diag([size, size, size * ratio]) @ C
    found = principal_axes((J + J.T) / 2)
    rows = array(found.C)
    axis, pair = (rows[2], rows[:2]) if ratio > 1 else (rows[0], rows[1:])
    assert np.allclose(np.abs(axis @ C[2]), 1, atol=1e-12)
    size = np.abs(axis)
    k = int((size > size.max() * (1 - 1e-9)).argmax())
    goals = np.eye(3)[[(k + 1) % 3, (k + 2) % 3]]
    best = (pair * goals).sum()
    for angle in np.radians(np.arange(1, 360)):
        turn = [[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]]
        assert (turn @ pair * goals).sum() < best
    assert axis[k] > 0


def test_a_sphere_keeps_the_given_axes():
    wobble = np.diag([2.0, 2.0, 2.0]) + 1e-14 * np.array([[0, 1, 2], [1, 0, 3], [2, 3, 1]])
    assert array(principal_axes(wobble).C).tolist() == np.eye(3).tolist()
    assert principal_axes(sp.diag(2, 2, 2)) == exact_axes(sp.diag(2, 2, 2))


def test_a_chain_of_near_equals_pairs_the_nearer_two():
    J = np.diag([1.0, 1.0 + 0.8e-12, 1.0 + 1.5e-12])
    found = principal_axes(J)
    assert array(found.C).tolist() == np.eye(3).tolist()
    turned = principal_axes(np.diag([1.0 + 1.5e-12, 1.0, 1.0 + 0.8e-12]))
    assert error(np.diag([1.0 + 1.5e-12, 1.0, 1.0 + 0.8e-12]), turned) < 1e-12


@pytest.mark.parametrize("scale", [1e-90, 1e-9, 1e9, 1e90])
def test_scale_does_not_matter(scale):
    J = [[3.0, -0.5, 0.2], [-0.5, 4.0, 0.3], [0.2, 0.3, 5.0]]
    one, other = principal_axes(J), principal_axes((np.array(J) * scale).tolist())
    assert np.allclose(array(one.C), array(other.C), rtol=0, atol=3e-16)
    assert np.allclose(np.array(other.moments) / scale, one.moments, rtol=4e-15)


# --- exact numbers ----------------------------------------------------------------------------

fraction = st.fractions(Fraction(1, 9), 9, max_denominator=9).map(sp.Rational)


@examples(60)
@given(q=quaternions, masses=st.tuples(fraction, fraction, fraction), shape=st.integers(0, 3))
def test_rational_moments_come_back_exactly(q, masses, shape):
    """General, symmetric, spherical and thin bodies, turned by an exact rotation."""
    x, y, z = masses
    x, y, z = [(x, y, z), (x, x, z), (x, x, x), (0, 0, z)][shape]
    C = rotation(q)
    J = C.T * sp.diag(y + z, x + z, x + y) * C
    found = principal_axes(J)
    assert list(found.moments) == sorted([y + z, x + z, x + y])
    assert error(J, found) < 1e-40
    assert all(entry.is_algebraic and not entry.has(sp.Float) for entry in found.C)
    if len(set(found.moments)) == 3:
        follows_the_sign_rule(found.C)


@pytest.mark.parametrize(
    ("J", "moments"),
    [
        ([[2, 1, 0], [1, 3, 0], [0, 0, 4]], ((5 - sp.sqrt(5)) / 2, (5 + sp.sqrt(5)) / 2, 4)),
        ([[4, 0, 1], [0, 3, 0], [1, 0, 5]], (3, (9 - sp.sqrt(5)) / 2, (9 + sp.sqrt(5)) / 2)),
        ([[4, 1, 1], [1, 4, 1], [1, 1, 4]], (3, 3, 6)),
        ([[4, -1, -1], [-1, 4, -1], [-1, -1, 4]], (2, 5, 5)),
        (sp.diag(sp.sqrt(3), sp.sqrt(2), 2), (sp.sqrt(2), sp.sqrt(3), 2)),
        ([[3, 1, 0], [1, 3, 1], [0, 1, 3]], (3 - sp.sqrt(2), 3, 3 + sp.sqrt(2))),
        (sp.diag(sp.pi, sp.pi, 4), (sp.pi, sp.pi, 4)),
    ],
)
def test_closed_forms_of_exact_matrices(J, moments):
    found = principal_axes(J)
    assert all(sign(x - y) == 0 for x, y in zip(found.moments, moments, strict=True))
    assert error(J, found) < 1e-40


def test_moments_that_differ_in_the_fortieth_digit_are_not_equal():
    step = sp.Rational(1, 10**40)
    C = rotation((1, 2, 3, 4))
    J = C.T * sp.diag(2, 2 + step, 3) * C
    found = principal_axes(J)
    assert found.moments == (2, 2 + step, 3)
    assert error(J, found, 120) < 1e-60


@pytest.mark.parametrize("digits", [15, 30, 80])
def test_irrational_cubics_to_the_digits_asked_for(digits):
    J = sp.Matrix([[5, 1, 1], [1, 6, 0], [1, 0, 8]])
    found = principal_axes(J, digits)
    assert exact_axes(J) is None
    cubic = J.charpoly().as_expr()
    (x,) = cubic.free_symbols
    exact = [r.evalf(digits + 20) for r in sp.Poly(cubic, x).nroots(digits + 20)]
    for got, value in zip(found.moments, sorted(exact), strict=True):
        assert abs(got - value) < 10 * sp.Float(10) ** -digits
    C = sp.Matrix(found.C)
    assert (
        max(abs(v) for v in C * J * C.T - sp.diag(*found.moments)) < 100 * sp.Float(10) ** -digits
    )
    follows_the_sign_rule(found.C)


# --- symbols ----------------------------------------------------------------------------------

FULL = sp.Matrix([[a, d, e], [d, b, f], [e, f, c]])
SYMBOLIC = {
    "full": FULL,
    "one product zero": FULL.subs(d, 0),
    "mirrored": sp.Matrix([[a, d, e], [d, a, e], [e, e, c]]),
    "mirrored about another plane": sp.Matrix([[c, e, e], [e, a, d], [e, d, a]]),
    "numbers among symbols": sp.Matrix([[8, d, 1], [d, 9, f], [1, f, 10]]),
}


def numbers(generator, J):
    """Fractions for the symbols, with a diagonal that stands above the products of inertia."""
    large = {s: sp.Rational(generator.randrange(800, 1200), 100) for s in (a, b, c)}
    small = {s: sp.Rational(generator.randrange(-200, 200) * 2 + 1, 200) for s in (d, e, f)}
    return {s: v for s, v in (large | small).items() if s in J.free_symbols}


@pytest.mark.parametrize("name", every(2, SYMBOLIC))
def test_closed_forms_in_symbols_by_substitution(name):
    J, generator = SYMBOLIC[name], random.Random(name)
    found = principal_axes(J)
    for _ in range(4):
        point = numbers(generator, J)
        values = at(found, point)
        assert list(values.moments) == sorted(values.moments)
        assert error(J.subs(point), values) < 1e-40


@pytest.mark.parametrize("k", [0, 1, 2])
def test_block_in_symbols_keeps_its_axis(k):
    i, j = (n for n in range(3) if n != k)
    J = sp.diag(a, b, c)
    J[i, j] = J[j, i] = d
    found = principal_axes(J)
    assert found.C[k, k] == 1
    assert found.moments[k] == J[k, k]
    assert equal(found.moments[i] + found.moments[j], J[i, i] + J[j, j])
    for point in ({a: 3, b: 4, c: 5, d: 1}, {a: 5, b: 4, c: 3, d: -2}, {a: 3, b: 3, c: 3, d: -1}):
        values = at(found, point)
        assert error(J.subs(point), values) < 1e-40
        assert values.moments[i] < values.moments[j]


def test_diagonal_symbols_stay_where_they_are():
    found = principal_axes(sp.diag(c, a, b))
    assert found.moments == (c, a, b)
    assert found.C.is_Identity


@pytest.mark.parametrize("axis", [(1, 1, 1), (1, -2, 2), (sp.sin(e), sp.cos(e), 1), (d, e, d)])
def test_two_moments_identically_equal(axis):
    """J = a 1 + b u u^T has the moments a, a, a + b u^2, and u as an axis."""
    u = sp.Matrix(axis)
    J = (a * sp.eye(3) + b * u * u.T).applyfunc(sp.expand)
    found = principal_axes(J)
    assert equal(found.moments[0], a)
    assert equal(found.moments[1], a)
    assert equal(found.moments[2], a + b * u.dot(u))
    point = {a: 3, b: sp.Rational(1, 2), d: 1, e: sp.Rational(3, 5)}
    values = at(found, point)
    assert error(J.subs(point), values) < 1e-40


def test_prolate_symbols_have_their_axis_first():
    size, less = sp.symbols("size less", positive=True)
    J = (size + less) * sp.eye(3) - less * sp.ones(3) / 3
    found = principal_axes(J)
    assert found.moments == (size, size + less, size + less)
    point = {size: 3, less: 1}
    assert error(J.subs(point), at(found, point)) < 1e-40


def test_angle_as_a_symbol():
    """A body with known moments, turned by an angle about an oblique axis."""
    turn = sp.Matrix(attitude("3-1-3").matrix)
    angles = [q.symbol for q in attitude("3-1-3").coordinates]
    turn = turn.subs({angles[0]: 0, angles[2]: sp.pi / 4})
    J = turn.T * sp.diag(2, 3, 4) * turn
    found = principal_axes(J)
    point = {angles[1]: sp.Rational(7, 10)}
    values = at(found, point)
    assert np.allclose([float(m) for m in values.moments], [2, 3, 4], rtol=1e-15)
    assert error(J.subs(point), values) < 1e-40
