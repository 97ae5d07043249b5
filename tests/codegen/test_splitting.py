"""Splitting with exact free turns: order, free motion to rounding, energy that does not drift."""

import shutil
import subprocess
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import eom
from codegen import compile as compile_system
from codegen import free_motion, simulate
from codegen.integrate import group, rkmk, splitting
from codegen.integrate.splitting import DRIFTS, KICKS, ORDER
from codegen.loops import running
from codegen.native import native
from codegen.native.trajectory import Problem
from codegen.targets import c
from eom.errors import InputError
from eom.kinematics.coordinates import attitude
from eom.mechanics import torques
from eom.mechanics.rigidbody import full_inertia, gravity_gradient_satellite, heavy_top, rigid_body
from eom.quantities import TIME, Singularity
from eom.rotations import quaternion_product
from eom.system import BodyAttitude, System

pytestmark = [
    pytest.mark.sparse,
    pytest.mark.skipif(not native.compiler(), reason="tests C itself"),
]

START = (0.5, 0.5, -0.5, 0.5)
TOP = (1.0, 1.5, 0.8, 1.0, 10.0, 0.2)
FAST = (0.1, 0.2, 5.0, np.cos(0.3), np.sin(0.3), 0.0, 0.0)


@pytest.fixture(scope="module")
def free():
    return compile_system(eom.free_rigid_body("quaternion"), "c")


@pytest.fixture(scope="module")
def top():
    return compile_system(heavy_top(), "c")


def full_body(torque):
    return rigid_body(full_inertia(), torque, attitude("quaternion"), name="full")


def run(compiled, x0, span, p, h=None, **options):
    return simulate(compiled, x0, span, p, method="splitting", first_step=h, **options)


# --- the compositions ----------------------------------------------------------------------------


def test_the_composition_is_symmetric_and_whole():
    assert KICKS[::-1] == KICKS
    assert DRIFTS[::-1] == DRIFTS
    assert len(KICKS) == len(DRIFTS) + 1
    assert sum(KICKS) == pytest.approx(1, abs=1e-15)
    assert sum(DRIFTS) == pytest.approx(1, abs=1e-15)


def test_the_observed_order_is_the_stated_one(top):
    """Without symmetry, so that no two terms cancel by chance; error beside the Taylor series."""
    exact = simulate(top, FAST, (0, 4), TOP, method="taylor", rtol=1e-15).y[:, -1]
    native_method, between = splitting.build(top.program, top.layout)
    errors = []
    for step in (0.2, 0.1, 0.05):
        problem = Problem(
            np.array(FAST), (0.0, 4.0), np.array(TOP), np.empty(0), 1e-9, np.full(7, 1e-12), 1e-6, 0,
            first_step=step,
        )  # fmt: skip
        ours = group.integrate(native_method, between, problem)
        assert ours.steps == round(4 / step)
        errors.append(np.max(np.abs(ours.y[:, -1] - exact)))
    orders = [np.log2(a / b) for a, b in pairwise(errors)]
    assert all(ORDER - 0.4 < order < ORDER + 1 for order in orders), orders


# --- the torque-free motion ----------------------------------------------------------------------

CASES = {
    "three moments": ((1, 2, 3), (1, 2, 0.3)),
    "separatrix": ((1, 2, 3), (1.0, 0.5, 3**-0.5)),
    "next to the separatrix": ((1, 2, 3), (1.0, 0.5, 3**-0.5 * (1 + 1e-14))),
    "unstable axis": ((1, 2, 3), (1e-14, 1, 1e-14)),
    "intermediate axis": ((1, 2, 3), (0, 1, 0)),
    "symmetric": ((1, 1, 2), (0.3, 0.2, 5)),
    "symmetric about b1": ((0.3, 1, 1), (3, 0.2, 0.5)),
    "spherical": ((2, 2, 2), (1, 2, 3)),
    "nearly symmetric": ((1, 1 - 1e-15, 1.5), (1, 2, 3)),
    "plate": ((1, 2, 3), (0.1, -2, 0.7)),
    "needle": ((1, 1, 1e-12), (1, 2, 3)),
    "needle that spins": ((1e-12, 1, 1), (1e3, 0.2, 0.3)),
    "thin needle of three moments": ((1.0, 1.0 + 0.4e-12, 1e-12), (1, 2, 3)),
    "large": ((1e12, 2e12, 2.5e12), (1e9, 2e9, 3e9)),
    "small": ((1e-12, 2e-12, 2.5e-12), (1e-9, 2e-9, 3e-9)),
    "at rest": ((1, 2, 3), (0, 0, 0)),
}


@pytest.mark.sparse
@pytest.mark.parametrize("turn", [1e-9, 1e-3, 0.3, 0.5, 1.0])
@pytest.mark.parametrize("case", CASES)
def test_one_drift_is_the_closed_form_to_a_few_units_of_the_last_place(free, case, turn):
    """Eleven drifts and no torque; the greatest body rate turns the body by ``turn`` radians."""
    moments, omega = CASES[case]
    fastest = max(map(abs, omega)) or 1.0
    end = run(free, [*omega, *START], (0, turn / fastest), moments, turn / fastest)
    assert end.steps == 1
    rates, quaternion = free_motion(moments, omega, START)(end.t[-1])
    np.testing.assert_allclose(end.y[:3, -1] / fastest, rates / fastest, rtol=0, atol=1e-15)
    np.testing.assert_allclose(end.y[3:, -1], quaternion, rtol=0, atol=1e-15)


components = st.floats(-3, 3)


@settings(max_examples=40)
@given(
    st.floats(1, 2), st.floats(1, 2), st.floats(0, 1), st.tuples(*[components] * 3),
    st.floats(0.01, 8),
)  # fmt: skip
def test_a_long_step_loses_no_more_than_its_length_explains(free, a, b, part, omega, turn):
    """Moments of a body: the third between |a - b| and a + b. Steps of up to a turn and more."""
    moments = (a, b, abs(a - b) + part * (a + b - abs(a - b)) or 1e-3)
    fastest = max(map(abs, omega)) or 1.0
    end = run(free, [*omega, *START], (0, turn / fastest), moments, turn / fastest)
    rates, quaternion = free_motion(moments, omega, START)(end.t[-1])
    bound = 2e-15 * (1 + turn)
    np.testing.assert_allclose(end.y[:3, -1] / fastest, rates / fastest, rtol=0, atol=2 * bound)
    np.testing.assert_allclose(end.y[3:, -1], quaternion, rtol=0, atol=bound)


def test_a_step_of_a_thousand_turns(free):
    """Next to no separatrix; the phase itself is 1e4 rad, of which 1e-16 is 1e-12."""
    moments, omega = (1.0, 2.0, 3.0), (0.2, 0.1, 3.0)
    end = run(free, [*omega, *START], (0, 2000 * np.pi / 3), moments, 1e9)
    assert end.steps == 1
    rates, quaternion = free_motion(moments, omega, START)(end.t[-1])
    np.testing.assert_allclose(end.y[:3, -1], rates, rtol=0, atol=1e-10)
    np.testing.assert_allclose(end.y[3:, -1], quaternion, rtol=0, atol=1e-10)


def test_a_full_inertia_matrix_is_turned_to_its_axes():
    """The same body in other axes: J = P diag P^T moves as the closed form does, seen from there."""
    compiled = compile_system(full_body(lambda C, J: torques.applied((0, 0, 0))), "c")
    a, b, c, d = 0.8, 0.4, -0.2, 0.4
    C = np.array([
        [a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)],
        [2 * (b * c - a * d), a * a - b * b + c * c - d * d, 2 * (c * d + a * b)],
        [2 * (b * d + a * c), 2 * (c * d - a * b), a * a - b * b - c * c + d * d],
    ])  # fmt: skip
    moments, omega = (1.0, 2.0, 2.5), np.array([1.0, 2.0, 0.3])
    J = C.T @ np.diag(moments) @ C
    entries = [J[0, 0], J[0, 1], J[0, 2], J[1, 1], J[1, 2], J[2, 2]]
    end = run(compiled, [*(C.T @ omega), *START], (0, 3), entries, 0.5)
    rates, _ = free_motion(moments, omega, START)(end.t)
    np.testing.assert_allclose(end.y[:3], C.T @ rates, rtol=0, atol=3e-14)
    for name in ("T", "H", "H_1", "H_2", "H_3"):
        assert end.drift[name].relative < 1e-14


# --- what is kept --------------------------------------------------------------------------------


@pytest.mark.slow
def test_length_and_momentum_stay_to_rounding_over_1e5_steps(free):
    """Not only no linear growth: none at all beyond some units in the last place; energy as a walk."""
    n, h = 100_000, 0.25
    end = run(free, [1, 2, 0.3, *START], (0, n * h), (1, 2, 3), h)
    assert end.steps == n
    assert end.drift["q_norm"].largest < 5e-16
    for name in ("H", "H_1", "H_2", "H_3"):
        assert end.drift[name].largest < 3e-15 * end.drift["H"].start
    energy = np.abs(end.drift["T"].over_time) / end.drift["T"].start
    assert energy.max() < 1e-16 * np.sqrt(11 * n)


def test_energy_stays_bounded_where_an_ordinary_method_drifts(top):
    """The heavy top for 20,000 steps of 1 rad; DOP853 makes the same steps."""
    n, h = 20_000, 0.2
    ours = run(top, FAST, (0, n * h), TOP, h)
    other = simulate(top, FAST, (0, n * h), TOP, "DOP853", 1e3, first_step=h, max_step=h)
    assert ours.steps == other.steps == n
    error = np.abs(ours.drift["E"].over_time)
    assert ours.drift["E"].relative < 1e-9
    assert error[-n // 10 :].max() < 1.5 * error[: n // 10].max()
    drift = np.abs(other.drift["E"].over_time)
    assert drift[-1] > 5 * drift[n // 10]
    assert drift[-1] > 1e3 * error.max()
    assert ours.drift["H_3"].relative < 2e-15
    assert ours.drift["q_norm"].largest < 5e-16


def test_the_satellite_keeps_its_integral_in_the_orbit_frame():
    compiled = compile_system(gravity_gradient_satellite(), "c")
    rate = 1e-3
    x0 = [1e-4, 2e-4, 1.1e-3, *START]
    end = run(compiled, x0, (0, 1.5e6), (7.0, 10.0, 12.0, rate), 150.0)
    error = np.abs(end.drift["E"].over_time)
    n = len(error)
    assert end.drift["E"].relative < 1e-6
    assert error[-n // 10 :].max() < 2 * error[: n // 10].max()
    assert end.drift["q_norm"].largest < 5e-16


@pytest.mark.parametrize("span", [(0, 10), (7, -3)])
def test_it_agrees_with_dop853_at_tight_tolerance(span):
    """A torque of attitude, time, parameters and an input, about all axes; forwards and backwards."""
    compiled = compile_system(DRIVEN, "c")
    x0, p = [0.1, 0.2, 0.3, 1, 0, 0, 0], {"D1": 1.0, "D2": 1.4, "D3": 2.0, "f": 0.3, "g": 0.5}
    grid = np.linspace(*span, 7)
    options = {"t_eval": grid, "inputs": {"u": 0.2}}
    other = simulate(compiled, x0, span, p, "DOP853", 1e-13, **options)
    ours = run(compiled, x0, span, p, 0.05, **options)
    np.testing.assert_allclose(ours.y, other.y, rtol=0, atol=2e-11)
    back = run(compiled, ours.y[:, -1], span[::-1], p, 0.05, inputs={"u": 0.2})
    np.testing.assert_allclose(back.y[:, -1], x0, rtol=0, atol=2e-14)


w, q, u = sp.symbols("a b c", real=True), sp.symbols("q0:4", real=True), sp.Symbol("u", real=True)
D, f, g = sp.symbols("D1:4", positive=True), sp.Symbol("f", real=True), sp.Symbol("g", real=True)
MATRIX = attitude("quaternion").matrix


def driven(torque, name="driven", D=D):
    gyroscopic = sp.Matrix(w).cross(sp.diag(*D) * sp.Matrix(w))
    turn = quaternion_product(q, (0, *w))
    rates = {w[i]: (torque[i] - gyroscopic[i]) / D[i] for i in range(3)}
    rates |= {q[i]: turn[i] / 2 for i in range(4)}
    stated = BodyAttitude(w, "quaternion", q, inertia=sp.diag(*D), torque=torque)
    inputs = [u] if u in sp.Matrix(torque).free_symbols else []
    return System.from_rates(name, rates, inputs=inputs, attitudes=[stated])


TORQUE = (f * MATRIX[0, 2] + sp.sin(3 * TIME), g * MATRIX[1, 0] + u, -g * MATRIX[2, 1])
DRIVEN = driven(TORQUE)


def test_states_between_steps_are_on_the_group_and_those_of_the_grid(top):
    times = np.linspace(0, 3, 29)
    dense = run(top, FAST, (0, 3), TOP, 0.1, dense_output=True)
    grid = run(top, FAST, (0, 3), TOP, 0.1, t_eval=times)
    np.testing.assert_allclose(dense.sol(times), grid.y, rtol=0, atol=2e-14)
    np.testing.assert_allclose(np.sum(dense.sol(times)[3:] ** 2, axis=0), 1, rtol=0, atol=1e-15)
    exact = simulate(top, FAST, (0, 3), TOP, "taylor", 1e-15, t_eval=times)
    np.testing.assert_allclose(grid.y, exact.y, rtol=0, atol=2e-8)
    np.testing.assert_allclose(dense.sol(dense.t), dense.y, rtol=0, atol=5e-15)
    np.testing.assert_array_equal(dense.sol(times[5]), dense.sol(times)[:, 5])


def test_a_paused_run_goes_on_as_if_it_had_not_paused(top, monkeypatch):
    whole = run(top, FAST, (0, 5), TOP, 0.1)
    monkeypatch.setattr(running, "STEPS_A_CALL", 3)
    monkeypatch.setattr(running, "FIRST_CAPACITY", 2)
    seen = []
    parts = run(top, FAST, (0, 5), TOP, 0.1, progress=seen.append)
    np.testing.assert_array_equal(parts.t, whole.t)
    np.testing.assert_array_equal(parts.y, whole.y)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


# --- the step, and where a run ends ----------------------------------------------------------------


def test_the_step_follows_the_tolerance_and_stays(top):
    """The local error at the start is rtol: of order h^7, so that steps are as its root."""
    steps = []
    for rtol in (1e-7, 1e-9, 1e-11):
        end = run(top, FAST, (0, 20), TOP, rtol=rtol)
        assert np.ptp(np.diff(end.t)) < 1e-13
        steps.append(end.steps)
    ratio = np.array(steps[1:]) / steps[:-1]
    assert np.all(np.abs(ratio / 100 ** (1 / 7) - 1) < 0.25), steps
    assert run(top, FAST, (0, 20), TOP, rtol=1e-7, max_step=0.01).steps == 2000


UPRIGHT = [0, 0, 1e-3, np.cos(5e-4), np.sin(5e-4), 0, 0]
"""A top that spins too slowly to stay up: nothing happens at first, and then it falls."""


def test_the_tolerance_is_looked_at_all_the_way(top):
    """Errors at the start alone, which are none, gave 15 steps at every tolerance, and errors of 0.9."""
    exact = simulate(top, UPRIGHT, (0, 8), TOP, "taylor", 1e-15).y_stop
    growth, steps = 2e3, []
    for rtol in (1e-3, 1e-6, 1e-9, 1e-12):
        end = run(top, UPRIGHT, (0, 8), TOP, rtol=rtol)
        assert end.status == 0
        assert not end.notice
        assert np.ptp(np.diff(end.t)) < 1e-13
        assert np.abs(end.y_stop - exact).max() < 100 * growth * rtol
        steps.append(end.steps)
    assert all(after > 1.5 * before for before, after in pairwise(steps[1:])), steps


def test_what_was_begun_with_too_long_steps_leaves_nothing_behind(top, monkeypatch):
    """The run that is handed out is that of its step, on a grid and off it, in any number of calls."""
    grid = np.linspace(0, 8, 33)
    found = run(top, UPRIGHT, (0, 8), TOP, rtol=1e-9)
    assert found.rejected > 0
    h = 8 / found.steps
    alone = run(top, UPRIGHT, (0, 8), TOP, h, rtol=1e-9)
    np.testing.assert_array_equal(found.y, alone.y)
    np.testing.assert_array_equal(found.t, alone.t)
    monkeypatch.setattr(running, "STEPS_A_CALL", 3)
    monkeypatch.setattr(running, "FIRST_CAPACITY", 2)
    on_grid = run(top, UPRIGHT, (0, 8), TOP, rtol=1e-9, t_eval=grid)
    np.testing.assert_array_equal(on_grid.t, grid)
    np.testing.assert_array_equal(on_grid.y_stop, alone.y_stop)
    dense = run(top, UPRIGHT, (0, 8), TOP, rtol=1e-9, dense_output=True)
    np.testing.assert_array_equal(dense.y, alone.y)
    np.testing.assert_allclose(dense.sol(grid), on_grid.y, rtol=0, atol=1e-13)


def test_a_tolerance_that_takes_too_many_steps_is_refused(top):
    for most in (5, 60):
        end = run(top, UPRIGHT, (0, 8), TOP, rtol=1e-12, max_steps=most)
        assert end.status == -1
        assert end.steps + end.rejected <= most + 1
    assert (
        "equal steps that keep the relative tolerance are more than max_steps = 60" in end.message
    )
    assert end.t_stop == 0
    np.testing.assert_array_equal(end.y_stop, UPRIGHT)


def test_a_given_step_stays_and_its_error_is_reported(top):
    end = run(top, FAST, (0, 4), TOP, 0.2, rtol=1e-12)
    assert end.steps == 20
    assert "steps of 0.2 s, as given, have local errors of up to" in end.notice
    exact = simulate(top, FAST, (0, 4), TOP, "taylor", 1e-15)
    local = float(end.notice.split("up to ")[1].split(",")[0])
    error = np.abs(end.y_stop - exact.y_stop).max()
    assert 0.02 < error / (end.steps * local) < 50
    assert not run(top, FAST, (0, 4), TOP, 0.01, rtol=1e-12).notice


@pytest.mark.slow
def test_pulses_and_kinks_of_the_torque_shorten_the_steps_and_poles_end_the_run():
    x0, p = [0.1, 0.2, 0.3, 1, 0, 0, 0], {"D1": 1.0, "D2": 1.4, "D3": 2.0}
    torques = {
        "pulse": 10 * sp.exp(-(((TIME - 1) / sp.Rational(1, 20)) ** 2)),
        "kink": sp.Abs(TIME - sp.Rational(11, 10)),
        "pole": 1 / (1 - TIME),
    }
    for name, torque in torques.items():
        compiled = compile_system(driven((torque, 0, 0), name), "c")
        end = run(compiled, x0, (0, 2), p, rtol=1e-6, max_steps=100_000)
        if name == "pole":
            assert end.status == -1
            assert end.t_stop <= 1
            continue
        exact = simulate(compiled, x0, (0, 2), p, "DOP853", 1e-12, max_step=0.01).y_stop
        assert end.status == 0
        assert np.abs(end.y_stop - exact).max() < 1e-4


@pytest.mark.slow
def test_no_step_passes_over_a_pulse_or_a_window_in_time():
    """A pulse makes all steps short; two of them end at the edges of a window, and the others stay."""
    x0, p = [0.1, 0.2, 0.3, 1, 0, 0, 0], {"D1": 1.0, "D2": 1.4, "D3": 2.0}
    window = sp.Gt(TIME, 4) & sp.Lt(TIME, sp.Rational(401, 100))
    torques = {
        "pulse": 50 * sp.exp(-((100 * (TIME - 4)) ** 2)),
        "window": sp.Piecewise((50, window), (0, True)),
    }
    steps = {}
    for name, torque in torques.items():
        compiled = compile_system(driven((torque, 0, 0), name), "c")
        end = run(compiled, x0, (0, 6), p, rtol=1e-8)
        exact = simulate(compiled, x0, (0, 6), p, "DOP853", 1e-12).y_stop
        assert end.status == 0
        assert np.abs(end.y_stop - exact).max() < 1e-6
        steps[name] = end.steps
        if name == "pulse":
            given = simulate(compiled, x0, (0, 6), p, "splitting", 1e-8, first_step=1.5)
            assert "pass over something narrow" in given.notice
    assert steps["window"] < 50 < steps["pulse"]


def test_what_is_narrow_in_the_attitude_is_refused():
    sharp = driven((sp.exp(-((100 * (q[1] - sp.Rational(1, 4))) ** 2)), 0, 0), "sharp")
    with pytest.raises(InputError, match="what is narrow in the torque"):
        run(compile_system(sharp, "c"), [0.1, 0.2, 0.3, *START], (0, 1), (1, 1.4, 2))


def test_a_top_at_rest_falls(top):
    x0 = [0, 0, 0, np.cos(0.3), np.sin(0.3), 0, 0]
    end = run(top, x0, (0, 2), TOP, rtol=1e-10)
    other = simulate(top, x0, (0, 2), TOP, "DOP853", 1e-13)
    np.testing.assert_allclose(end.y[:, -1], other.y[:, -1], rtol=0, atol=1e-7)
    assert abs(end.drift["E"].largest) < 1e-8


@pytest.mark.slow
def test_a_singularity_stops_the_run(top):
    """The top passes the horizontal: where its tilt is 90 degrees is called singular here."""
    up = 1 - 2 * (sp.Symbol("q1", real=True) ** 2 + sp.Symbol("q2", real=True) ** 2)
    system = heavy_top()
    singular = Singularity(up, sp.Symbol("q1", real=True), "b3 is horizontal")
    compiled = compile_system(replace(system, singularities=(singular,)), "c")
    x0 = [0, 0, 0, np.cos(0.3), np.sin(0.3), 0, 0]
    end = run(compiled, x0, (0, 5), TOP, 0.1)
    other = simulate(compiled, x0, (0, 5), TOP, "DOP853", 1e-12)
    assert end.status == other.status == 1
    assert end.t_stop == pytest.approx(other.t_stop, abs=1e-6)
    q1, q2 = end.y_stop[4:6]
    assert abs(1 - 2 * (q1 * q1 + q2 * q2)) <= 1.01e-6
    np.testing.assert_array_equal(end.y[:, -1], end.y_stop)


def test_numbers_that_fail_are_reported(free):
    moments = sp.symbols("D1:4", real=True)
    loose = compile_system(driven((0, 0, 0), "loose", moments), "c")
    assert run(loose, [1, 2, 0.3, *START], (0, 1), (1, 2, 3), 0.1).status == 0
    assert run(loose, [1, 2, 0.3, *START], (0, 1), (1, -2, 3), 0.1).status == -1
    assert run(loose, [1, 2, 0.3, 0, 0, 0, 0], (0, 1), (1, 2, 3), 0.1).status == -1
    assert run(free, [1, 2, 0.3, *START], (0, 1e12), (1, 2, 3), 1e12).status == -1
    short = run(free, [1, 2, 0.3, *START], (1e6, 2e6), (1, 2, 3), 1e-11)
    assert short.status == -1
    assert "resolution of time" in short.message


PRESCRIBED = quaternion_product(q, (0, sp.cos(TIME), 1, g))
REFUSED = {
    "a torque of the rates": (driven((-g * w[0], 0, f), "damped"), "the torque about b1 does"),
    "no quaternion": (eom.free_rigid_body("dcm"), "unit quaternion"),
    "no attitude": (eom.free_rigid_body(), "unit quaternion"),
    "prescribed rates": (
        System.from_rates(
            "led",
            {a: r / 2 for a, r in zip(q, PRESCRIBED, strict=True)},
            attitudes=[BodyAttitude((sp.cos(TIME), 1, g), "quaternion", q)],
        ),
        "no rigid body",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_fit_is_refused_and_named(case):
    system, words = REFUSED[case]
    compiled = compile_system(system, "numpy")
    with pytest.raises(InputError, match="method splitting") as refusal:
        splitting.files(compiled.program, compiled.layout)
    assert words in str(refusal.value)
    assert refusal.value.hint


def test_inputs_that_are_functions_are_refused():
    with pytest.raises(InputError, match="Python functions"):
        simulate(
            DRIVEN,
            [0] * 3 + [1, 0, 0, 0],
            (0, 1),
            [1, 1, 1, 0, 0],
            "splitting",
            inputs={"u": lambda t: t},
        )


def test_the_same_system_gives_the_same_bytes(top):
    first = splitting.files(top.program, top.layout)
    again = splitting.files(top.program, compile_system(heavy_top(), "c").layout)
    assert first == again
    assert set(first) == {"heavy_top_splitting.h", "heavy_top_splitting.c"}
    assert all(text.isascii() and "@" not in text for text in first.values())


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_generated_files_pass_strict_compilers_without_a_warning(compiler, top, tmp_path):
    """Both methods on the group, and their headers as C++."""
    if shutil.which(compiler) is None:
        pytest.skip(f"no {compiler}")
    files = {
        **splitting.files(top.program, top.layout), **rkmk.files(top.program, top.layout),
        **c.files(top.program, top.layout),
    }  # fmt: skip
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="ascii")
    strict = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Werror"]
    sources = [str(tmp_path / name) for name in files if name.endswith(".c")]
    run = [compiler, "-std=c99", "-O1", *strict, "-fsyntax-only", *sources]
    done = subprocess.run(run, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    headers = "".join(f'#include "{name}"\n' for name in files if name.endswith(".h"))
    (tmp_path / "all.cc").write_text(headers)
    run = [compiler, "-x", "c++", *strict, "-fsyntax-only", str(tmp_path / "all.cc")]
    done = subprocess.run(run, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.sparse(only=("algebraic",))
@pytest.mark.parametrize("rules", ["algebraic", "exact"])
def test_laws_of_folding_do_not_matter(rules):
    compiled = compile_system(heavy_top(), "c", rules=rules)
    exact = simulate(compiled, FAST, (0, 2), TOP, "taylor", 1e-15).y[:, -1]
    for method in ("splitting", "rkmk"):
        end = simulate(compiled, FAST, (0, 2), TOP, method, 1e-11)
        np.testing.assert_allclose(end.y[:, -1], exact, rtol=0, atol=1e-8)
        assert end.drift["H_3"].relative < 3e-15
