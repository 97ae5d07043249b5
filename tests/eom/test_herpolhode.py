"""Herpolhodes against symbolic turning points and integrated motion in inertial space."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from eom import InputError
from eom.exact.identity import equal, vanishes
from eom.kinematics.coordinates import quaternion
from eom.mechanics.freebody import (
    OMEGA,
    H,
    Herpolhode,
    T,
    classify,
    herpolhode,
    herpolhode_radius,
    herpolhode_rate,
    turning_point,
)
from tests.draws import examples

I1, I2, I3 = sp.symbols("I1:4", positive=True)
w = sp.symbols("omega_1:4", real=True)

moment = st.fractions(Fraction(1, 20), 20, max_denominator=30)
rate = st.fractions(-5, 5, max_denominator=20)


@st.composite
def bodies(draw):
    """Moments of a body that can exist: sums of second moments of mass."""
    a, b, c = draw(st.tuples(moment, moment, moment))
    return (b + c, a + c, a + b)


@pytest.mark.parametrize(
    ("moments", "omega", "message"),
    [
        ((1, 2, 4), (1, 0, 0), "exceeds the sum"),
        ((0, 1, 1), (1, 0, 0), "not positive"),
        ((1, 2, 3), (0, 0, 0), "does not turn"),
        ((1, 2, 3), (math.nan, 0, 1), "not a finite real"),
        ((1, 2, I3), (1, 0, 1), "not a finite real"),
        ((1, 2), (1, 0, 1), "three moments"),
    ],
)
def test_bad_input_is_refused(moments, omega, message):
    with pytest.raises(InputError, match=message):
        herpolhode(moments, omega)


@pytest.mark.parametrize("k", [1, 2, 3])
def test_turning_points_have_the_energy_and_momentum(k):
    squares = turning_point(k)
    moments = (I1, I2, I3)
    assert squares[k - 1] == 0
    assert equal(sum(i * s for i, s in zip(moments, squares, strict=True)), 2 * T)
    assert equal(sum(i**2 * s for i, s in zip(moments, squares, strict=True)), H**2)


@pytest.mark.parametrize(
    ("moments", "omega", "ends"),
    [
        ((1, 2, 3), (1, 7, 5), (1, 2)),
        ((1, 2, 3), (7, 1, 2), (2, 3)),
        ((2, 3, 4), (1, 1, 1), (1, 2)),
    ],
)
def test_radii_are_those_of_the_symbolic_turning_points(moments, omega, ends):
    energy = classify(moments, omega).energy
    momentum = classify(moments, omega).momentum
    point = {T: energy, H: momentum, **dict(zip((I1, I2, I3), moments, strict=True))}
    found = herpolhode(moments, omega)
    expected = sorted(herpolhode_radius(k).subs(point).evalf(30) for k in ends)
    assert abs(found.inner.evalf(30) - expected[0]) < 1e-25
    assert abs(found.outer.evalf(30) - expected[1]) < 1e-25
    assert found.distance == 2 * energy / momentum


def herpolhode_of_motion(moments, omega, t_end):
    """Radius and unwrapped angle of omega about h in inertial space, by integrating quaternions."""
    chosen = quaternion()
    q = [s.symbol for s in chosen.coordinates]
    turn = sp.lambdify([q, w], chosen.rates(OMEGA), "math")
    matrix = sp.lambdify([q], sp.Matrix(chosen.matrix), "numpy")
    a, b, c = map(float, moments)

    def rates(t, x):
        p, r, s = x[:3]
        return [(b - c) / a * r * s, (c - a) / b * s * p, (a - b) / c * p * r, *turn(x[3:], x[:3])]

    grid = np.linspace(0, t_end, 8001)
    start = [*map(float, omega), 1.0, 0.0, 0.0, 0.0]
    run = solve_ivp(rates, (0, t_end), start, "DOP853", grid, rtol=1e-12, atol=1e-13)
    spins = run.y[:3].T
    inertial = np.array([matrix(x).T @ y for x, y in zip(run.y[3:].T, spins, strict=True)])
    h = np.diag([a, b, c]) @ spins[0]
    h = matrix(run.y[3:, 0]).T @ h
    normal = h / np.linalg.norm(h)
    side = np.cross(normal, [0.3, 0.5, 0.8])
    side /= np.linalg.norm(side)
    x, y = inertial @ side, inertial @ np.cross(normal, side)
    return grid, spins, inertial @ normal, np.hypot(x, y), np.unwrap(np.arctan2(y, x))


@pytest.mark.parametrize(
    ("moments", "omega"),
    [((1, 2, 2.5), (0.4, 0.5, 2.0)), ((2.5, 1.0, 2.0), (0.3, 1.5, -0.4)), ((2, 2, 3), (1, 0, 2))],
)
def test_herpolhode_against_integrated_motion(moments, omega):
    t, spins, height, radius, angle = herpolhode_of_motion(moments, omega, 30.0)
    found = herpolhode(moments, omega)
    assert np.allclose(height, float(found.distance), atol=1e-9)
    assert radius.min() == pytest.approx(float(found.inner), abs=2e-5)
    assert radius.max() == pytest.approx(float(found.outer), abs=2e-5)
    values = dict(zip((I1, I2, I3), moments, strict=True))
    rate_of = sp.lambdify([w], herpolhode_rate().subs(values), "math")
    expected = np.array([rate_of(x) for x in spins])
    measured = np.gradient(angle, t)
    assert np.abs(measured - expected)[2:-2].max() < 1e-3 * np.abs(expected).max()


def test_herpolhode_of_the_symmetric_body_turns_at_the_precession_rate():
    """H/It, for every omega off the axis (Hughes, 1986, ch. 4)."""
    symmetric = herpolhode_rate().subs(I2, I1)
    H2 = (I1 * w[0]) ** 2 + (I1 * w[1]) ** 2 + (I3 * w[2]) ** 2
    assert vanishes(sp.cancel(symmetric * sp.sqrt(H2)) - H2 / I1)


@examples(40)
@given(bodies(), st.tuples(rate, rate, rate))
def test_herpolhode_radii_are_real_ordered_and_bracket_the_start(moments, omega):
    assume(any(omega))
    found = herpolhode(moments, omega)
    values = [
        m * x for m, x in zip(map(sp.Rational, moments), map(sp.Rational, omega), strict=True)
    ]
    squared = sum(v**2 for v in values)
    energy2 = sum(v * x for v, x in zip(values, map(sp.Rational, omega), strict=True))
    radius2 = sum(sp.Rational(x) ** 2 for x in omega) - energy2**2 / squared
    assert 0 <= found.inner**2 <= radius2 <= found.outer**2
    assert sp.expand(found.distance**2 - energy2**2 / squared) == 0


def test_steady_spin_has_a_point_for_herpolhode_and_the_separatrix_spirals_in():
    assert herpolhode((1, 2, 3), (0, 4, 0)) == Herpolhode(4, 0, 0)
    spiral = herpolhode((1, 2, 3), (sp.sqrt(3), 5, 1))
    assert spiral.inner == 0
    assert spiral.outer.evalf() > 0
