"""Polhodes against printed formulas, exact facts and integrated motion."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from eom import InputError
from eom.exact.identity import equal
from eom.mechanics import freebody
from eom.mechanics.freebody import H, T, classify, projection
from tests.draws import examples
from tests.eom.rows import every

I1, I2, I3 = sp.symbols("I1:4", positive=True)
w = sp.symbols("omega_1:4", real=True)


def integrate(moments, omega, t_end, points=2000):
    """Rates by Euler's equations as printed, and the momentum's direction, by SciPy."""
    a, b, c = (float(m) for m in moments)

    def rates(t, x):
        return [
            (b - c) / a * x[1] * x[2],
            (c - a) / b * x[2] * x[0],
            (a - b) / c * x[0] * x[1],
        ]

    grid = np.linspace(0, t_end, points)
    start = [float(x) for x in omega]
    run = solve_ivp(rates, (0, t_end), start, "DOP853", grid, rtol=1e-12, atol=1e-13)
    assert run.success
    return grid, run.y


def test_constants_are_the_printed_ones():
    energy, squared = freebody.constants()
    assert equal(2 * energy, I1 * w[0] ** 2 + I2 * w[1] ** 2 + I3 * w[2] ** 2)
    assert equal(squared, (I1 * w[0]) ** 2 + (I2 * w[1]) ** 2 + (I3 * w[2]) ** 2)


def test_ellipsoids_meet_the_axes_where_the_constants_say():
    for ellipsoid, value, level in (
        (freebody.energy_ellipsoid(), 2 * freebody.constants()[0], 2 * T),
        (freebody.momentum_ellipsoid(), freebody.constants()[1], H**2),
    ):
        column = sp.Matrix(w)
        assert equal((column.T * ellipsoid.form * column)[0], value)
        for k, length in enumerate(ellipsoid.semi_axes):
            point = {x: length if n == k else 0 for n, x in enumerate(w)}
            assert sp.expand(value.subs(point) - level) == 0


def test_energy_ellipsoid_is_flatter_than_the_momentum_s_by_roots():
    """Semi-axes go with 1/sqrt(I) and 1/I (Goldstein, Poole, Safko, 2002, sect. 5.6)."""
    energy = freebody.energy_ellipsoid().semi_axes
    momentum = freebody.momentum_ellipsoid().semi_axes
    assert [sp.expand(e**2 * i - 2 * T) for e, i in zip(energy, (I1, I2, I3), strict=True)] == [
        0
    ] * 3
    assert [sp.expand(m * i - H) for m, i in zip(momentum, (I1, I2, I3), strict=True)] == [0] * 3


@pytest.mark.parametrize("k", [1, 2, 3])
def test_projections_are_the_printed_conics(k):
    """Sum of I_i (I_i - I_k) omega_i^2 = H^2 - 2 T I_k (Hughes, 1986, ch. 4)."""
    moments = (I1, I2, I3)
    conic = projection(k)
    expected = [moments[i - 1] * (moments[i - 1] - moments[k - 1]) for i in conic.axes]
    assert all(equal(a, b) for a, b in zip(conic.coefficients, expected, strict=True))
    assert equal(conic.level, H**2 - 2 * T * moments[k - 1])
    energy, squared = freebody.constants()
    value = sum(c * w[i - 1] ** 2 for c, i in zip(conic.coefficients, conic.axes, strict=True))
    assert equal(value, conic.level.subs({H: sp.sqrt(squared), T: energy}))


ABOVE, BELOW = (1 + sign * sp.Rational(1, 10**40) for sign in (1, -1))

# moments, rates; kind, axis, role, worked by hand
CASES = {
    "major spin": ((1, 2, 3), (0, 0, 5), "spin about an axis", 3, "major"),
    "minor spin": ((1, 2, 3), (-4, 0, 0), "spin about an axis", 1, "minor"),
    "intermediate spin": ((1, 2, 3), (0, 1, 0), "spin about an axis", 2, "intermediate"),
    "unsorted spin": ((3, 1, 2), (0, 0, 1), "spin about an axis", 3, "intermediate"),
    "about major": ((1, 2, 3), (1, 7, 5), "about the major axis", 3, "major"),
    "about minor": ((1, 2, 3), (7, 1, 2), "about the minor axis", 1, "minor"),
    "about major, unsorted": ((5, 3, 4), (2, 1, 1), "about the major axis", 1, "major"),
    "separatrix": ((1, 2, 3), (sp.sqrt(3), 5, 1), "separatrix", None, ""),
    "just inside": ((1, 2, 3), (sp.sqrt(3), 5, ABOVE), "about the major axis", 3, "major"),
    "just outside": ((1, 2, 3), (sp.sqrt(3), 5, BELOW), "about the minor axis", 1, "minor"),
    "oblate": ((2, 2, 3), (1, 0, 1), "axisymmetric (oblate)", 3, "major"),
    "prolate": ((1, 3, 3), (1, 0, 1), "axisymmetric (prolate)", 1, "minor"),
    "prolate about b2": ((3, 2, 3), (1, 1, 0), "axisymmetric (prolate)", 2, "minor"),
    "oblate spin": ((2, 2, 3), (0, 0, 1), "spin about an axis", 3, "major"),
    "flat spin": ((1, 3, 3), (0, 1, 4), "spin about an axis", None, "transverse"),
    "flat spin on an axis": ((1, 3, 3), (0, 0, 4), "spin about an axis", 3, "transverse"),
    "sphere": ((2, 2, 2), (1, 2, 3), "spherical (omega constant)", None, ""),
    "sphere on an axis": ((2, 2, 2), (0, 0, 3), "spherical (omega constant)", None, ""),
    "flat body": ((1, 2, 3), (0, Fraction(1, 3), 1), "about the major axis", 3, "major"),
    "rod": ((Fraction(1, 10**9), 1, 1), (1, 1, 0), "axisymmetric (prolate)", 1, "minor"),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_kinds_of_polhode(name):
    moments, omega, kind, axis, role = CASES[name]
    found = classify(moments, omega)
    assert (found.kind, found.axis, found.role) == (kind, axis, role)


def test_table_of_kinds_is_covered():
    assert {case[2] for case in CASES.values()} == set(freebody.KINDS)


def test_conics_of_the_projections():
    assert classify((1, 2, 3), (1, 7, 5)).projections == ("ellipse", "hyperbola", "ellipse")
    assert classify((3, 1, 2), (1, 1, 1)).projections == ("ellipse", "ellipse", "hyperbola")
    assert classify((1, 2, 3), (sp.sqrt(3), 5, 1)).projections[1] == "two lines that cross"
    assert classify((1, 2, 3), (0, 0, 5)).projections == ("ellipse", "hyperbola", "point")
    assert classify((2, 2, 3), (1, 0, 1)).projections == (
        "two parallel lines",
        "two parallel lines",
        "ellipse",
    )
    assert set(classify((2, 2, 2), (1, 2, 3)).projections) == {"plane"}
    assert classify((2, 2, 3), (1, 0, 0)).projections[0] == "line"


def test_every_row_of_conics_is_reached():
    seen = {p for case in CASES.values() for p in classify(case[0], case[1]).projections}
    assert seen == set(freebody.CONICS.values())


def test_floats_are_compared_with_the_stated_tolerance_and_fractions_exactly():
    root = math.sqrt(3)
    assert classify((1.0, 2.0, 3.0), (root, 5.0, 1.0)).kind == "separatrix"
    assert classify((1.0, 2.0, 3.0), (root, 5.0, 1.0 + 1e-9)).kind == "about the major axis"
    assert classify((1.0, 2.0, 3.0), (root, 5.0, 1.0 - 1e-9)).kind == "about the minor axis"
    assert classify((0.1 + 0.2, 0.3, 0.5), (1, 0, 1)).kind == "axisymmetric (oblate)"
    exact = (Fraction(3, 10) + Fraction(1, 10**20), Fraction(3, 10), Fraction(1, 2))
    assert classify(exact, (1, 0, 1)).kind == "about the major axis"
    assert classify((1.0, 2.0, 3.0), (0.0, 1e-14, 1.0)).kind == "spin about an axis"
    assert classify((1, 2, 3), (0, Fraction(1, 10**14), 1)).kind == "about the major axis"
    assert isinstance(classify((1.0, 2, 3), (1, 2, 3)).energy, float)
    assert classify((1, 2, 3), (1, 2, 3)).energy == 18


def test_scale_of_moments_and_rates_does_not_matter():
    for scale, speed in itertools.product((1e-90, 1.0, 1e90), repeat=2):
        moments = [scale * m for m in (1.0, 2.0, 2.5)]
        found = classify(moments, [speed * x for x in (0.1, 1.0, 1.0)])
        assert found.kind == "about the major axis"
        assert found.extremes[1][1] == pytest.approx(
            speed * classify((1.0, 2.0, 2.5), (0.1, 1.0, 1.0)).extremes[1][1], rel=1e-12
        )


def test_smallest_floats_are_rates_too():
    assert classify((1, 2, 3), (5e-324, 0, 0)).kind == "spin about an axis"
    assert classify((1.0, 2.0, 3.0), (5e-324, 5e-324, 0)).kind == "about the minor axis"


moment = st.fractions(Fraction(1, 20), 20, max_denominator=30)
rate = st.fractions(-5, 5, max_denominator=20)


@st.composite
def bodies(draw):
    """Moments of a body that can exist: sums of second moments of mass."""
    a, b, c = draw(st.tuples(moment, moment, moment))
    return (b + c, a + c, a + b)


@examples(60)
@given(bodies(), st.tuples(rate, rate, rate), st.permutations([0, 1, 2]))
def test_kind_does_not_depend_on_the_order_or_signs_of_axes(moments, omega, order):
    assume(any(omega))
    first = classify(moments, omega)
    second = classify([moments[k] for k in order], [-omega[k] for k in order])
    assert (first.kind, first.role) == (second.kind, second.role)
    assert [first.extremes[k] for k in order] == list(second.extremes)
    assert [first.projections[k] for k in order] == list(second.projections)
    if first.axis is not None and first.role != "transverse":
        assert order[second.axis - 1] == first.axis - 1


@examples(60)
@given(bodies(), st.tuples(rate, rate, rate))
def test_extremes_bracket_the_start_and_lie_on_the_polhode(moments, omega):
    """The least value of one is reached with others that give the same T and H."""
    assume(any(omega))
    found = classify(moments, omega)
    for (low, high), x in zip(found.extremes, omega, strict=True):
        assert low**2 <= x**2 <= high**2
    if found.kind.startswith("about"):
        k = found.axis - 1
        assert found.extremes[k][0] > 0
        others = [e[0] for n, e in enumerate(found.extremes) if n != k]
        assert others == [0, 0]


@pytest.mark.parametrize("name", every(3, [n for n in CASES if not n.startswith("just")]))
def test_kind_and_extremes_against_integrated_motion(name):
    """Which component keeps its sign, how far each goes, what is constant."""
    moments, omega, kind, axis, _ = CASES[name]
    found = classify(moments, omega)
    _, history = integrate(moments, omega, 10.0 if kind == "separatrix" else 60.0, 20001)
    sizes = np.abs(history)
    if kind.startswith("about"):
        keeps = [bool((row > 0).all() or (row < 0).all()) for row in history]
        assert keeps == [k + 1 == axis for k in range(3)]
    if kind.startswith(("spin", "spherical")):
        assert np.ptp(history, axis=1).max() < 1e-10
    if kind.startswith("axisymmetric"):
        assert np.ptp(history[axis - 1]) < 1e-10
    fast = name != "rod"
    for k, (low, high) in enumerate(found.extremes):
        assert sizes[k].min() >= float(low) - 1e-5
        assert sizes[k].max() <= float(high) + 1e-5
        if fast and kind != "separatrix":
            assert sizes[k].min() == pytest.approx(float(low), abs=0.02)
            assert sizes[k].max() == pytest.approx(float(high), abs=0.02)


def test_separatrix_ends_at_the_intermediate_axis():
    found = classify((1, 2, 3), (sp.sqrt(3), 5, 1))
    _, history = integrate((1, 2, 3), (math.sqrt(3), 5, 1), 6.0)
    assert [e[0] for e in found.extremes] == [0, 0, 0]
    assert np.abs(history[1]).max() == pytest.approx(float(found.extremes[1][1]), rel=1e-6)
    assert np.abs(history[[0, 2], -1]).max() < 1e-3


BAD = {
    "triangle": ((1, 2, 4), (1, 0, 0), "exceeds the sum"),
    "zero moment": ((0, 1, 1), (1, 0, 0), "not positive"),
    "negative moment": ((-1, 1, 1), (1, 0, 0), "not positive"),
    "no rate": ((1, 2, 3), (0, 0, 0), "does not turn"),
    "no float rate": ((1, 2, 3), (0.0, -0.0, 0.0), "does not turn"),
    "nan": ((1, 2, 3), (math.nan, 0, 1), "not a finite real"),
    "infinite": ((1, 2, 3), (math.inf, 0, 1), "not a finite real"),
    "infinite moment": ((1, 2, math.inf), (1, 0, 1), "not a finite real"),
    "zoo": ((1, 2, 3), (sp.zoo, 0, 1), "not a finite real"),
    "complex": ((1, 2, 3), (1j, 0, 1), "not a finite real"),
    "symbol": ((1, 2, I3), (1, 0, 1), "not a finite real"),
    "text": ((1, 2, 3), ("1", 0, 1), "not a number"),
    "truth": ((1, 2, 3), (True, 0, 1), "not a finite real"),
    "none": ((1, 2, 3), (None, 0, 1), "not a"),
    "two moments": ((1, 2), (1, 0, 1), "three moments"),
    "four rates": ((1, 2, 3), (1, 0, 1, 1), "three moments"),
    "huge": ((1, 2, 3), (sp.Integer(10) ** 400, 0, 1), "out of range"),
    "large": ((1, 2, 3), (1e100, 0, 1), "out of range"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused(name):
    moments, omega, message = BAD[name]
    with pytest.raises(InputError, match=message):
        classify(moments, omega)
