"""Constant rates and the stability of steady spin against printed formulas and integrated motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom import InputError
from eom.exact.identity import equal
from eom.kinematics.frames import vector
from eom.mechanics.rigidbody import OMEGA, free_rigid_body, full_inertia
from eom.mechanics.steady import (
    constant_rate,
    constant_rate_counterexamples,
    hurwitz_determinants,
    linearised,
    spin_stability,
    steady_spin,
)
from eom.system import System
from tests.draws import examples, nonzero
from tests.eom.motion import run

I1, I2, I3 = sp.symbols("I1:4", positive=True)
nu = sp.Symbol("nu", positive=True)
w = sp.symbols("omega_1:4", real=True)
MOMENTS = (I1, I2, I3)


def test_counterexamples_have_constant_rates():
    found = constant_rate_counterexamples()
    assert all(case.forces == (0, 0, 0) for case in found.values())


def test_free_counterexamples_are_free_and_off_the_given_axes():
    found = constant_rate_counterexamples()
    for name in ("spherical body, free", "symmetric body, free"):
        assert found[name].torque.components == (0, 0, 0)
        assert sum(x != 0 for x in found[name].omega.components) >= 2


def test_torque_of_the_other_counterexample_is_not_zero():
    torque = constant_rate_counterexamples()["any body, with torque"].torque
    expected = [(I3 - I2) * w[1] * w[2], (I1 - I3) * w[2] * w[0], (I2 - I1) * w[0] * w[1]]
    assert all(equal(a, b) and a != 0 for a, b in zip(torque.components, expected, strict=True))


def test_any_constant_rate_of_a_full_inertia_with_its_torque():
    J, _ = full_inertia()
    found = constant_rate(J, OMEGA)
    assert found.forces == (0, 0, 0)
    assert all(t != 0 for t in found.torque.components)


def test_a_general_free_body_is_no_counterexample():
    found = constant_rate(sp.diag(I1, I2, I3), OMEGA, vector("B", (0, 0, 0)))
    assert all(f != 0 for f in found.forces)
    along_axis = constant_rate(
        sp.diag(I1, I2, I3), vector("B", (0, w[1], 0)), vector("B", (0,) * 3)
    )
    assert along_axis.forces == (0, 0, 0)


@pytest.mark.parametrize("axis", [1, 2, 3])
def test_growth_rate_is_the_printed_one(axis):
    """lambda^2 = -(I_k - I_i)(I_k - I_j) nu^2/(I_i I_j) (Goldstein, Poole, Safko, sect. 5.6)."""
    k, i, j = (MOMENTS[(axis - 1 + n) % 3] for n in range(3))
    found = steady_spin(axis)
    expected = -(k - i) * (k - j) * nu**2 / (i * j)
    assert equal(found.squared_growth_rate, expected)
    root = sp.Symbol("lambda")
    assert equal(found.characteristic, root * (root**2 - expected))


@pytest.mark.parametrize(
    ("moments", "verdicts"),
    [
        ((1, 2, 3), ("stable", "unstable", "stable")),
        ((2, 3, 1), ("unstable", "stable", "stable")),
        ((1, 1, 1), ("neutral",) * 3),
        ((2, 2, 3), ("neutral", "neutral", "stable")),
        ((1, 3, 3), ("stable", "neutral", "neutral")),
        ((0.1 + 0.2, 0.3, 0.5), ("unstable", "stable", "stable")),
    ],
)
def test_verdicts(moments, verdicts):
    assert tuple(spin_stability(moments, k).kind for k in (1, 2, 3)) == verdicts


def test_sense_of_the_spin_does_not_matter():
    assert spin_stability((1, 2, 3), 2, -3) == spin_stability((1, 2, 3), 2, 3)
    assert spin_stability((1, 2, 3), 3, 2).rate == 2


@pytest.mark.parametrize("axis", [1, 2, 3])
def test_rates_against_an_integrated_perturbation(axis):
    moments, spin, small = (1.0, 2.0, 2.5), 1.3, 1e-7
    verdict = spin_stability(moments, axis, spin)
    rate = float(verdict.rate)
    i, j = (k for k in range(3) if k != axis - 1)
    t_end = 6 / rate if verdict.kind == "unstable" else 4 * math.pi / rate
    start = [0.0] * 3
    start[axis - 1], start[i] = spin, small
    system = free_rigid_body()
    t, y, *_ = run(system, dict(zip(("I1", "I2", "I3"), moments, strict=True)), start, t_end)
    shape = np.cosh if verdict.kind == "unstable" else np.cos
    assert np.allclose(y[i] / small, shape(rate * t), rtol=2e-4, atol=2e-4)
    assert np.abs(y[j]).max() > small / 10


@pytest.mark.parametrize(
    ("moments", "axis", "rate", "message"),
    [
        ((1, 2, 4), 1, 1, "exceeds the sum"),
        ((1, 2, 0), 1, 1, "not positive"),
        ((1, 2), 1, 1, "three moments"),
        ((1, 2, 3), 1, 0, "other than zero"),
        ((1, 2, 3), 4, 1, "no such axis"),
        ((1, 2, 3), 0, 1, "no such axis"),
        ((1, 2, math.nan), 1, 1, "not a finite"),
        ((1, 2, 3), 1, math.inf, "not a finite"),
        ((1, 2, 3), 1, "fast", "not a number"),
    ],
)
def test_bad_input_is_refused(moments, axis, rate, message):
    with pytest.raises(InputError, match=message):
        spin_stability(moments, axis, rate)


def test_what_is_no_steady_motion_is_refused():
    x = OMEGA.components
    pushed = System.from_rates("pushed", {x[0]: sp.Integer(1), x[1]: x[0], x[2]: x[0]})
    with pytest.raises(InputError, match="not a steady motion"):
        linearised(pushed, 1)


def test_hurwitz_determinants_of_the_cubic_are_the_printed_ones():
    """a1 > 0, a1 a2 - a0 a3 > 0, a3 (a1 a2 - a0 a3) > 0 (Hughes, 1986, app. A)."""
    a = sp.symbols("a0:4", positive=True)
    found = hurwitz_determinants(a)
    inner = a[1] * a[2] - a[0] * a[3]
    assert all(equal(x, y) for x, y in zip(found, (a[1], inner, a[3] * inner), strict=True))


@examples(60)
@given(st.tuples(*[nonzero(0.05, 3)] * 4))
def test_hurwitz_determinants_show_the_side_of_the_roots(roots):
    coefficients = [sp.Rational(x) for x in np.poly([roots[0], roots[1], *_pair(*roots[2:])]).real]
    positive = all(d > 0 for d in hurwitz_determinants(coefficients))
    assert positive == (max(roots[:3]) < 0)


def _pair(real, imaginary):
    return complex(real, imaginary), complex(real, -imaginary)
