"""Precession of symmetric bodies against printed formulas, rolling cones and integrated motion."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from eom import InputError
from eom.exact.identity import equal
from eom.kinematics.coordinates import attitude
from eom.mechanics import gyrostat
from eom.mechanics.freebody import precession
from tests.draws import examples, nonzero

I1, I2, I3, Js_1 = sp.symbols("I1:4 Js_1", positive=True)
It, Ia = sp.symbols("It Ia", positive=True)
w = sp.symbols("omega_1:4", real=True)


def test_precession_is_the_printed_one():
    """H/It about h, (It - Ia)/It omega_3 about b3; tan of the angles (Hughes, 1986, ch. 4)."""
    found = precession()
    H2 = It**2 * (w[0] ** 2 + w[1] ** 2) + Ia**2 * w[2] ** 2
    assert equal(found.rate**2 * It**2, H2)
    assert equal(found.spin, (It - Ia) / It * w[2])
    assert equal(found.body_cone_rate, (Ia - It) / It * w[2])
    across = sp.sqrt(w[0] ** 2 + w[1] ** 2)
    assert equal(sp.tan(found.nutation) * Ia * w[2], It * across)
    assert equal(sp.tan(found.body_cone) * sp.Abs(w[2]), across)


@pytest.mark.parametrize(
    ("It_", "Ia_", "omega", "sense"),
    [
        (2, 1, (1, 0, 3), "direct"),
        (2, 1, (1, 0, -3), "direct"),
        (2, 3, (1, 0, 3), "retrograde"),
        (2, 3, (0, 1, -3), "retrograde"),
        (2, 2, (1, 0, 3), "none"),
        (2, 3, (1, 1, 0), "none"),
        (2.0, 3.0, (0.1, 0.0, 1.0), "retrograde"),
    ],
)
def test_sense_of_precession(It_, Ia_, omega, sense):
    assert precession(It_, Ia_, omega).sense == sense


positive = st.floats(0.1, 5)
ratios = st.floats(0.05, 0.999) | st.floats(1.001, 1.95)


@examples(60)
@given(positive, ratios, st.tuples(*[nonzero(0.05, 3)] * 3))
def test_cones_roll_on_each_other(transverse, ratio, omega):
    """The space cone's angle is the difference of the two others; inside for oblate bodies."""
    found = precession(transverse, ratio * transverse, omega)
    nutation = float(found.nutation)
    acute = min(nutation, math.pi - nutation)
    difference = acute - float(found.body_cone)
    assert float(found.space_cone) == pytest.approx(abs(difference), abs=1e-9)
    assert (difference < 0) == (ratio > 1) == (found.sense == "retrograde")
    # without slip: the line of contact is at rest in both cones
    rolling = float(found.rate) * math.sin(float(found.space_cone))
    assert rolling == pytest.approx(
        abs(float(found.spin)) * math.sin(float(found.body_cone)), abs=1e-9
    )


@pytest.mark.parametrize(
    ("transverse", "axial", "stored"),
    [(2.0, 1.0, 0.0), (2.0, 3.0, 0.0), (2.0, 3.0, -2.5), (1.0, 1.5, 0.7)],
)
def test_cone_rates_against_integrated_quaternion_motion(transverse, axial, stored):
    omega = (0.6, 0.2, 1.1)
    found = precession(transverse, axial, omega, stored)
    chosen = attitude("quaternion")
    system = gyrostat.gyrostat(1, axes=[(0, 0, 1)], drives="constant", attitude=chosen)
    speed = sp.Symbol("Omega_1", real=True)
    numbers = {I1: transverse, I2: transverse, I3: axial, Js_1: 0.1, speed: stored / 0.1}
    states = [q.symbol for q in system.states]
    f = sp.lambdify([states], [system.expand(r).subs(numbers) for r in system.rates], "math")
    grid = np.linspace(0, 12, 2001)
    start = [*omega, 1.0, 0.0, 0.0, 0.0]
    run = solve_ivp(lambda t, x: f(x), (0, 12), start, "DOP853", grid, rtol=1e-12, atol=1e-13)
    matrix = sp.lambdify([states[3:]], sp.Matrix(chosen.matrix), "numpy")
    C = np.array([matrix(x) for x in run.y[3:].T])
    h = np.array([transverse * omega[0], transverse * omega[1], axial * omega[2] + stored])
    normal = h / np.linalg.norm(h)
    side = np.cross(normal, [1.0, 0, 0])
    side /= np.linalg.norm(side)
    axle, turn = C[:, 2], np.einsum("tji,jt->ti", C, run.y[:3])
    azimuth = np.unwrap(np.arctan2(axle @ np.cross(normal, side), axle @ side))
    assert np.polyfit(grid, azimuth, 1)[0] == pytest.approx(float(found.rate), rel=1e-8)
    assert np.allclose(np.arccos(axle @ normal), float(found.nutation), atol=1e-8)
    in_body = np.unwrap(np.arctan2(run.y[1], run.y[0]))
    assert np.polyfit(grid, in_body, 1)[0] == pytest.approx(float(found.body_cone_rate), rel=1e-8)
    between = turn @ normal / np.linalg.norm(turn, axis=1)
    assert np.allclose(np.arccos(between), float(found.space_cone), atol=1e-8)
    assert np.allclose(
        np.arctan2(np.hypot(run.y[0], run.y[1]), np.abs(run.y[2])),
        float(found.body_cone),
        atol=1e-8,
    )


def test_pure_spin_and_flat_spin():
    spin = precession(2, 1, (0, 0, 3))
    assert (spin.nutation, spin.body_cone, spin.space_cone) == (0, 0, 0)
    assert spin.rate + spin.spin == 3
    assert precession(2, 1, (0, 0, -3)).nutation == sp.pi
    flat = precession(2, 3, (3, 4, 0))
    assert (flat.rate, flat.spin, flat.nutation) == (5, 0, sp.pi / 2)
    assert (flat.body_cone, flat.space_cone) == (sp.pi / 2, 0)


@pytest.mark.parametrize(
    ("It_", "Ia_", "omega", "message"),
    [
        (1, 3, (1, 0, 1), "exceeds the sum"),
        (0, 1, (1, 0, 1), "not positive"),
        (1, -1, (1, 0, 1), "not positive"),
        (1, 1, (0, 0, 0), "without angular momentum"),
        (1.0, 1.0, (0.0, 0.0, 0.0), "without angular momentum"),
        (1, 1, ("1", 0, 0), "not a number"),
        (math.nan, 1, (1, 0, 0), "finite"),
        (1, 1, (math.nan, 0, 1), "finite"),
        (1, 1, (math.inf, 0, 1), "finite"),
        (1, 1, (1, 0), "three rates"),
    ],
)
def test_bad_precession_is_refused(It_, Ia_, omega, message):
    with pytest.raises(InputError, match=message):
        precession(It_, Ia_, omega)


def test_sense_needs_numbers():
    with pytest.raises(InputError, match="needs numbers"):
        _ = precession().sense
