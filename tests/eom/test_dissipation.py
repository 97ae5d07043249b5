"""The viscous slug and the energy sink against printed formulas and integrated motion."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.linalg import expm

from eom import InputError
from eom.exact.identity import equal
from eom.kinematics.coordinates import attitude
from eom.mechanics import dissipation
from eom.mechanics.dissipation import damped_spin, damped_stability, excess_energy, viscous_slug
from eom.mechanics.rigidbody import is_invariant
from eom.mechanics.steady import linearised, spin_stability
from tests.draws import examples
from tests.eom.motion import run

I1, I2, I3, J_s, c = sp.symbols("I1 I2 I3 J_s c", positive=True)
nu = sp.Symbol("nu", positive=True)
w = sp.symbols("omega_1:4", real=True)
s = sp.symbols("sigma_1:4", real=True)
MOMENTS = (I1, I2, I3)


def along(system, expression, history, states, numbers):
    f = sp.lambdify([states], system.expand(expression).subs(numbers), "math")
    return np.array([f(x) for x in history.T])


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
        damped_stability(moments, axis, 1, 1, rate)


@pytest.mark.parametrize(("slug", "damping"), [(0, 1), (1, 0), (-1, 1), (1, -0.5)])
def test_slug_without_inertia_or_damping_is_refused(slug, damping):
    with pytest.raises(InputError, match="must be positive"):
        damped_stability((1, 2, 3), 3, slug, damping)


# --- the slug ---------------------------------------------------------------------------------


def test_slug_equations_are_the_printed_balances():
    """J w' + w x J w = c s; J_s (w + s)' + w x J_s (w + s) = -c s, in B, by hand."""
    system = viscous_slug()
    rates = sp.Matrix(system.rates)
    omega, sigma = sp.Matrix(w), sp.Matrix(s)
    J = sp.diag(*MOMENTS)
    assert equal(sp.Matrix(J * rates[:3, 0] + omega.cross(J * omega)), c * sigma)
    slug = J_s * (rates[:3, 0] + rates[3:, 0]) + omega.cross(J_s * (omega + sigma))
    assert equal(sp.Matrix(slug), -c * sigma)


def test_energy_falls_by_the_dissipation():
    rate = dissipation.energy_rate()
    assert equal(rate, -c * (s[0] ** 2 + s[1] ** 2 + s[2] ** 2))
    outputs = {d.name: d.expression for d in viscous_slug().outputs}
    assert equal(rate, -outputs["dissipation"])


def test_momentum_alone_is_constant():
    system = viscous_slug()
    assert system.invariant_names == ("H",)
    outputs = {d.name: d.expression for d in system.outputs}
    assert not is_invariant(system, outputs["T"])
    assert not any(is_invariant(system, outputs[f"h_{k}"]) for k in (1, 2, 3))


@pytest.mark.parametrize("name", ["quaternion", "3-1-3"])
def test_momentum_in_space_is_constant_with_attitude(name):
    system = viscous_slug(attitude(name))
    assert {"H", "H_1", "H_2", "H_3"} <= set(system.invariant_names)
    assert "T" not in system.invariant_names
    assert ("rotation" in {a.name for a in system.assumptions}) == (name == "quaternion")
    assert bool(system.singularities) == (name == "3-1-3")


@pytest.mark.parametrize("major", [1, 2, 3])
def test_excess_energy_is_the_sum_of_its_squares(major):
    J = sp.diag(*MOMENTS)
    omega, sigma = sp.Matrix(w), sp.Matrix(s)
    h = J * omega + J_s * (omega + sigma)
    energy = (omega.dot(J * omega) + J_s * (omega + sigma).dot(omega + sigma)) / 2
    total = sum(a * b**2 for a, b in excess_energy(major))
    assert equal(total, energy - h.dot(h) / (2 * (MOMENTS[major - 1] + J_s)))


@pytest.mark.parametrize("major", [1, 2, 3])
def test_excess_energy_vanishes_in_major_axis_spin_alone(major):
    terms = excess_energy(major)
    assert len(terms) == 5
    others = [m for k, m in enumerate(MOMENTS, 1) if k != major]
    b = sp.Symbol("b", positive=True)
    greatest = {MOMENTS[major - 1]: sum(others) - b}
    for coefficient, _ in terms:
        for values in itertools.product((1, 2, 3), repeat=2):
            point = dict(zip(others, values, strict=True)) | {J_s: sp.Rational(1, 3)}
            number = coefficient.subs(greatest).subs(point).subs(b, sp.Rational(1, 10))
            assert number > 0
    still = {x: 0 for k, x in enumerate(w, 1) if k != major} | dict.fromkeys(s, 0)
    assert all(base.subs(still) == 0 for _, base in terms)


def test_slug_motion_keeps_h_loses_t_and_ends_about_the_major_axis():
    """From near the minor axis, by integration; the quaternion shows h fixed in space."""
    system = viscous_slug(attitude("quaternion"))
    values = {"I1": 1.0, "I2": 1.5, "I3": 2.0, "J_s": 0.5, "c": 0.6}
    start = [2.0, 0.05, 0.1, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    _, y, states, numbers = run(system, values, start, 200.0, 2000)
    outputs = {d.name: d.expression for d in system.outputs}
    for name in ("H", "H_1", "H_2", "H_3"):
        samples = along(system, outputs[name], y, states, numbers)
        assert np.ptp(samples) < 1e-8
    energy = along(system, outputs["T"], y, states, numbers)
    assert np.diff(energy).max() < 1e-11
    H = along(system, outputs["H"], y, states, numbers)[0]
    assert energy[-1] == pytest.approx(H**2 / (2 * 2.5), rel=1e-3)
    assert abs(y[2, -1]) == pytest.approx(H / 2.5, rel=1e-2)
    lost = along(system, outputs["dissipation"], y, states, numbers)
    t = np.linspace(0, 200.0, 2000)
    work = float(np.sum((lost[1:] + lost[:-1]) / 2 * np.diff(t)))
    assert energy[0] - energy[-1] == pytest.approx(work, rel=2e-3)


positive = st.floats(0.05, 20)


@examples(80)
@given(st.tuples(positive, positive, positive), positive, positive, st.sampled_from([1, 2, 3]))
def test_slug_spin_is_stable_if_and_only_if_about_the_major_axis(
    second_moments, slug, damping, axis
):
    """Moments of the body alone decide, whatever the slug, the damping and the rate."""
    a, b, d = second_moments
    moments = (b + d, a + d, a + b)
    others = [m for k, m in enumerate(moments, 1) if k != axis]
    gap = min(abs(moments[axis - 1] - m) for m in others)
    assume(gap > 1e-6)
    expected = "stable" if moments[axis - 1] > max(others) else "unstable"
    assert damped_stability(moments, axis, slug, damping, 1.7) == expected


@pytest.mark.parametrize("axis", [1, 2, 3])
def test_quartic_has_the_roots_of_the_integrated_matrix(axis):
    """Its roots are eigenvalues of a Jacobian by finite differences of the rates."""
    system = viscous_slug()
    values = {"I1": 1.0, "I2": 1.5, "I3": 2.1, "J_s": 0.5, "c": 0.6}
    numbers = {q.symbol: values[q.name] for q in system.parameters}
    f = sp.lambdify([[*w, *s]], [r.subs(numbers) for r in system.rates], "math")
    centre = np.zeros(6)
    centre[axis - 1] = 1.3
    step = 1e-5
    matrix = np.array(
        [(np.array(f(centre + step * e)) - f(centre - step * e)) / (2 * step) for e in np.eye(6)]
    ).T
    spectrum = np.linalg.eigvals(matrix)
    point = numbers | {nu: 1.3}
    roots = np.roots([float(a.subs(point)) for a in damped_spin(axis).coefficients])
    assert all(np.abs(spectrum - r).min() < 1e-6 for r in roots)
    left = [x for x in spectrum if np.abs(roots - x).min() > 1e-6]
    axial = -0.6 * (1 / 0.5 + 1 / values[f"I{axis}"])
    assert sorted(x.real for x in left) == pytest.approx([axial, 0.0], abs=1e-6)


def test_growth_of_a_spin_about_the_minor_axis_against_integration():
    """A rigid body is stable there, the damped one leaves it at the rate of the quartic's root."""
    values = {"I1": 1.0, "I2": 1.5, "I3": 2.1, "J_s": 0.5, "c": 0.6}
    system = viscous_slug()
    A = linearised(system, 1).subs({I1: 1, I2: 1.5, I3: 2.1, J_s: 0.5, c: 0.6, nu: 1.3})
    A = np.array(A.tolist(), dtype=float)
    assert max(np.linalg.eigvals(A).real) > 0.01
    small = np.array([0, 1e-6, 2e-6, 0, 1e-6, 0])
    start = small + np.array([1.3, 0, 0, 0, 0, 0])
    t, y, *_ = run(system, values, start, 20.0, 50)
    linear = np.array([expm(A * x) @ small for x in t]).T
    deviation = y - np.array([1.3, 0, 0, 0, 0, 0])[:, None]
    assert (
        np.abs(deviation[[1, 2, 4, 5]] - linear[[1, 2, 4, 5]]).max() < 1e-3 * np.abs(linear).max()
    )
    assert spin_stability((1.0, 1.5, 2.1), 1).kind == "stable"
    assert damped_stability((1.0, 1.5, 2.1), 1) == "unstable"


@pytest.mark.parametrize(
    ("moments", "verdicts"),
    [
        ((1, 1, 1), ("neutral", "neutral", "neutral")),
        ((2, 2, 3), ("unstable", "unstable", "stable")),
        ((1, 3, 3), ("unstable", "neutral", "neutral")),
        ((1, 2, 3), ("unstable", "unstable", "stable")),
    ],
)
def test_damped_verdicts_of_degenerate_bodies(moments, verdicts):
    assert tuple(damped_stability(moments, k) for k in (1, 2, 3)) == verdicts


# --- the energy sink --------------------------------------------------------------------------

It, Ia, H, T = sp.symbols("It Ia H T", positive=True)
D = sp.Symbol("D", nonnegative=True)
theta = sp.Symbol("theta", real=True)


def test_nutation_rate_is_the_printed_one():
    """theta' = -D It Ia/(H^2 (Ia - It) sin cos) (Hughes, 1986, ch. 5)."""
    expected = -D * It * Ia / (H**2 * (Ia - It) * sp.sin(theta) * sp.cos(theta))
    assert equal(dissipation.nutation_rate(), expected)
    energy = H**2 * (sp.sin(theta) ** 2 / It + sp.cos(theta) ** 2 / Ia) / 2
    assert equal(dissipation.energy_at_nutation(), energy)
    assert equal(energy.diff(theta) * dissipation.nutation_rate(), -D)


@pytest.mark.parametrize(
    ("transverse", "axial", "trend"), [(2, 3, "stable"), (3, 2, "unstable"), (2, 2, "neutral")]
)
def test_trend_by_the_shape_of_the_body(transverse, axial, trend):
    assert dissipation.nutation_trend(transverse, axial) == trend
    if trend != "neutral":
        point = {It: transverse, Ia: axial, H: 1, D: 1, theta: 1}
        assert (dissipation.nutation_rate().subs(point) < 0) == (trend == "stable")
        slug = damped_stability((transverse, transverse, axial), 3)
        assert slug == trend


@pytest.mark.parametrize(("transverse", "axial"), [(1, 3), (0, 1), (1, 0), (-1, 1), (1, math.nan)])
def test_trend_of_no_body_is_refused(transverse, axial):
    with pytest.raises(InputError):
        dissipation.nutation_trend(transverse, axial)


def test_effective_inertia_never_falls():
    rate = dissipation.effective_inertia_rate()
    assert equal(rate, D * H**2 / (2 * T**2))
    assert rate.is_nonnegative


def test_energy_sink_is_the_limit_of_a_light_slug():
    """Quasi-rigid: with small J_s the nutation of the exact model follows the sink's law."""
    a, b, slug, damping = 2.0, 3.0, 0.01, 0.02
    system = viscous_slug()
    values = {"I1": a, "I2": a, "I3": b, "J_s": slug, "c": damping}
    t, y, states, numbers = run(system, values, [0.8, 0, 1.0, 0, 0, 0], 60.0, 6001)
    outputs = {d.name: d.expression for d in system.outputs}
    h3, total, power = (
        along(system, outputs[k], y, states, numbers) for k in ("h_3", "H", "dissipation")
    )
    angle = np.arccos(h3 / total)
    law = sp.lambdify(
        [theta, D], dissipation.nutation_rate().subs({It: a + slug, Ia: b + slug, H: total[0]})
    )
    late = t > 10
    slope = np.gradient(angle, t)[late]
    expected = law(angle, power)[late]
    assert np.mean(slope) == pytest.approx(np.mean(expected), rel=0.02)
    assert np.mean(slope) < 0
