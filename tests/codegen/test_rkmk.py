"""Runge-Kutta-Munthe-Kaas: order, the group to rounding, momentum that does not change."""

from itertools import pairwise

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import eom
from codegen import compile as compile_system
from codegen import free_motion, simulate
from codegen.integrate import rkmk
from codegen.loops import running
from codegen.native import native
from eom.errors import InputError
from eom.mechanics.rigidbody import heavy_top
from eom.quantities import TIME
from eom.rotations import quaternion_product
from eom.system import BodyAttitude, System

pytestmark = [
    pytest.mark.sparse,
    pytest.mark.skipif(not native.compiler(), reason="tests C itself"),
]

START = (0.5, 0.5, -0.5, 0.5)
TOP = (1.0, 1.5, 0.8, 1.0, 10.0, 0.2)
FAST = (0.1, 0.2, 5.0, np.cos(0.3), np.sin(0.3), 0.0, 0.0)
w, q, z = sp.symbols("a b c", real=True), sp.symbols("q0:4", real=True), sp.Symbol("z", real=True)
D, k = sp.symbols("D1:4", positive=True), sp.Symbol("k", real=True)


def body(torque, extra=None, name="body"):
    gyroscopic = sp.Matrix(w).cross(sp.diag(*D) * sp.Matrix(w))
    turn = quaternion_product(q, (0, *w))
    rates = {w[i]: (torque[i] - gyroscopic[i]) / D[i] for i in range(3)}
    rates |= {q[i]: turn[i] / 2 for i in range(4)} | (extra or {})
    stated = BodyAttitude(w, "quaternion", q, inertia=sp.diag(*D), torque=torque)
    return System.from_rates(name, rates, attitudes=[stated])


DAMPED = body(
    (-k * w[0] + z, sp.sin(3 * TIME) * q[1], -k * w[2] * sp.Abs(w[2])), {z: w[0] - z}, "damped"
)
"""With quadratic drag, and a wheel-like state z that goes along."""
LINEAR = body((-k * w[0] + z, k * q[1], sp.cos(TIME)), {z: w[0] - z}, "linear")
"""With a body whose torque depends on its rates, on time and on another state."""


@pytest.fixture(scope="module")
def free():
    return compile_system(eom.free_rigid_body("quaternion"), "c")


@pytest.fixture(scope="module")
def top():
    return compile_system(heavy_top(), "c")


def run(compiled, x0, span, p, rtol=1e-9, **options):
    return simulate(compiled, x0, span, p, "rkmk", rtol, **options)


def fixed(compiled, x0, span, p, h, **options):
    return run(compiled, x0, span, p, 1e3, first_step=h, max_step=h, **options)


def test_the_observed_order_is_8_and_7_between_steps(top):
    """Of fixed steps, beside the Taylor series; the interpolant is a rotation at every time."""
    times = np.linspace(0.03, 3.97, 31)
    exact = simulate(top, FAST, (0, 4), TOP, "taylor", 1e-15, t_eval=[*times, 4.0]).y
    ends, inner = [], []
    for n in (20, 40, 80):
        ours = fixed(top, FAST, (0, 4), TOP, 4 / n, dense_output=True)
        assert ours.steps == n
        between = ours.sol(times)
        np.testing.assert_allclose(np.sum(between[3:] ** 2, axis=0), 1, rtol=0, atol=1e-15)
        ends.append(np.max(np.abs(ours.y[:, -1] - exact[:, -1])))
        inner.append(np.max(np.abs(between - exact[:, :-1])))
    assert all(7.4 < np.log2(a / b) < 9.6 for a, b in pairwise(ends)), ends
    assert all(6.4 < np.log2(a / b) < 9.6 for a, b in pairwise(inner)), inner


CASES = {
    "three moments": ((1, 2, 3), (1, 2, 0.3)),
    "next to the separatrix": ((1, 2, 3), (1.0, 0.5, 3**-0.5 * (1 + 1e-14))),
    "symmetric": ((1, 1, 2), (0.3, 0.2, 5)),
    "spherical": ((2, 2, 2), (1, 2, 3)),
    "plate": ((1, 2, 3), (0.1, -2, 0.7)),
    "large": ((1e12, 2e12, 2.5e12), (1e9, 2e9, 3e9)),
    "small": ((1e-12, 2e-12, 2.5e-12), (1e-9, 2e-9, 3e-9)),
    "tiny": ((1, 2, 3), (1e-150, 1e-150, 0)),
    "about one axis": ((1, 2, 3), (0, 0, 7)),
    "at rest": ((1, 2, 3), (0, 0, 0)),
}


@pytest.mark.parametrize("case", CASES)
def test_it_follows_the_closed_form_and_keeps_momentum_to_rounding(free, case):
    moments, omega = CASES[case]
    fastest = max(map(abs, omega)) or 1.0
    ours = run(free, [*omega, *START], (0, 6 / fastest), moments, 1e-12)
    rates, quaternion = free_motion(moments, omega, START)(ours.t)
    np.testing.assert_allclose(ours.y[:3] / fastest, rates / fastest, rtol=0, atol=2e-10)
    np.testing.assert_allclose(ours.y[3:], quaternion, rtol=0, atol=2e-10)
    for name in ("H", "H_1", "H_2", "H_3"):
        assert ours.drift[name].largest <= 2e-15 * ours.drift["H"].start
    assert ours.drift["q_norm"].largest < 5e-16


def test_length_and_momentum_stay_to_rounding_over_1e5_steps(free):
    """They do not grow at all, not only not with the number of steps."""
    n, h = 100_000, 0.25
    ours = fixed(free, [1, 2, 0.3, *START], (0, n * h), (1, 2, 3), h)
    assert ours.steps == n
    assert ours.drift["q_norm"].largest < 5e-16
    for name in ("H", "H_1", "H_2", "H_3"):
        assert ours.drift[name].largest < 3e-15 * ours.drift["H"].start
    other = simulate(
        free, [1, 2, 0.3, *START], (0, n * h), (1, 2, 3), "DOP853", 1e3, first_step=h, max_step=h
    )
    assert other.drift["H"].relative > 1e6 * ours.drift["H"].relative


@pytest.mark.sparse(1)
@pytest.mark.parametrize("span", [(0, 5), (2, 0.5)])
@pytest.mark.parametrize("system", [DAMPED, LINEAR], ids=["drag", "linear"])
def test_other_states_and_torques_of_the_rates_go_along(system, span):
    """Beside DOP853 at tight tolerance, on a grid, forwards and backwards."""
    compiled = compile_system(system, "c")
    x0, p = [0.1, 0.2, 0.3, 1, 0, 0, 0, 0.4], {"D1": 1.0, "D2": 1.4, "D3": 2.0, "k": 0.3}
    grid = np.linspace(*span, 9)
    other = simulate(compiled, x0, span, p, "DOP853", 1e-13, t_eval=grid)
    ours = run(compiled, x0, span, p, 1e-12, t_eval=grid)
    np.testing.assert_allclose(ours.y, other.y, rtol=0, atol=2e-10)
    np.testing.assert_allclose(np.sum(ours.y[3:7] ** 2, axis=0), 1, rtol=0, atol=1e-15)


def test_prescribed_rates_need_no_body():
    turn = quaternion_product(q, (0, sp.cos(TIME), 1, sp.sin(2 * TIME)))
    stated = BodyAttitude((sp.cos(TIME), 1, sp.sin(2 * TIME)), "quaternion", q)
    rates = {q[i]: turn[i] / 2 for i in range(4)}
    compiled = compile_system(System.from_rates("led", rates, attitudes=[stated]), "c")
    other = simulate(compiled, [1, 0, 0, 0], (0, 20), method="DOP853", rtol=1e-13)
    ours = run(compiled, [1, 0, 0, 0], (0, 20), None, 1e-12)
    np.testing.assert_allclose(ours.y[:, -1], other.y[:, -1], rtol=0, atol=1e-11)


def test_going_back_returns(top):
    there = run(top, FAST, (0, 10), TOP, 1e-13)
    back = run(top, there.y[:, -1], (10, 0), TOP, 1e-13)
    np.testing.assert_allclose(back.y[:, -1], FAST, rtol=0, atol=1e-10)


def test_smaller_tolerances_give_smaller_errors(top):
    exact = simulate(top, FAST, (0, 20), TOP, "taylor", 1e-15).y[:, -1]
    runs = [run(top, FAST, (0, 20), TOP, rtol) for rtol in (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)]
    errors = [np.max(np.abs(r.y[:, -1] - exact)) for r in runs]
    assert all(b < a / 10 for a, b in pairwise(errors)), errors
    assert errors[-1] < 1e-9
    for r in runs:
        assert r.drift["q_norm"].largest < 5e-16
        assert r.nfev == 2 + 12 * (r.steps + r.rejected)


@given(st.tuples(*[st.floats(-3, 3)] * 3), st.tuples(*[st.floats(-1, 1)] * 3))
def test_states_of_a_grid_are_those_of_the_interpolant(top, omega, vector):
    turn = np.array([1.5, *vector])
    x0 = [*omega, *(turn / np.linalg.norm(turn))]
    times = np.linspace(0, 2, 17)
    grid = run(top, x0, (0, 2), TOP, 1e-8, t_eval=times)
    dense = run(top, x0, (0, 2), TOP, 1e-8, dense_output=True)
    np.testing.assert_allclose(dense.sol(times), grid.y, rtol=0, atol=1e-14)
    np.testing.assert_allclose(dense.sol(dense.t), dense.y, rtol=0, atol=1e-14)


def test_a_paused_run_goes_on_as_if_it_had_not_paused(top, monkeypatch):
    whole = run(top, FAST, (0, 5), TOP)
    monkeypatch.setattr(running, "STEPS_A_CALL", 3)
    monkeypatch.setattr(running, "FIRST_CAPACITY", 2)
    parts = run(top, FAST, (0, 5), TOP, dense_output=True)
    np.testing.assert_array_equal(parts.t, whole.t)
    np.testing.assert_array_equal(parts.y, whole.y)
    np.testing.assert_allclose(parts.sol(whole.t), whole.y, rtol=0, atol=1e-14)


def test_a_needle_that_momentum_cannot_resolve_is_refused_not_lost(free):
    """H/I3 has the rounding error 1e-4 of its rate: the run says so at its start, and keeps it."""
    end = run(free, [1, 2, 3, *START], (0, 1), (1, 1, 1e-12))
    assert end.status == -1
    assert "axis of small moment" in end.message
    assert end.steps == end.rejected == 0
    np.testing.assert_allclose(end.y_stop, [1, 2, 3, *START], rtol=1e-15)
    assert run(free, [1, 2, 3, *START], (0, 1), (1, 1, 1e-5)).status == 0


def test_a_body_rate_that_is_no_state_counts_as_one():
    """A symmetric top spins at 20 rad/s, which is a parameter: it was taken for at rest, and stopped."""
    compiled = compile_system(eom.load_scene("heavy-top").derive(), "c")
    parameters = {"I1": 1.0, "I3": 0.3, "m": 1.0, "g": 10.0, "r3": 0.2, "omega_3": 20.0}
    x0 = [0, 0, np.cos(0.3), np.sin(0.3), 0, 0]
    exact = simulate(compiled, x0, (0, 2), parameters, "taylor", 1e-15).y_stop
    for rtol in (1e-3, 1e-6, 1e-9, 1e-12, 1e-13, 1e-14):
        end = run(compiled, x0, (0, 2), parameters, rtol=rtol)
        assert end.status == 0, end.message
        assert np.abs(end.y_stop - exact).max() < 100 * rtol


@pytest.mark.parametrize("thickness", [1e-2, 1e-4])
def test_rods_are_moved_at_the_finest_tolerances(free, thickness):
    """Rounding of H/I3, 1e4 units in the last place, is below 1000 times the tolerance."""
    moments = (1, 1 + thickness / 2, thickness)
    exact = simulate(free, [1, 2, 3, *START], (0, 1), moments, "taylor", 1e-15).y_stop
    for rtol in (1e-9, 1e-12, 1e-14):
        end = run(free, [1, 2, 3, *START], (0, 1), moments, rtol=rtol)
        assert end.status == 0, end.message
        assert np.abs(end.y_stop - exact).max() < 3e3 * max(rtol, 1e-14)


NEARLY_UPRIGHT = (1e-6, 0, 20, np.cos(5e-7), np.sin(5e-7), 0, 0)
WIDE = (1.0, 1.0, 0.8, 1.0, 10.0, 0.2)


def test_small_components_are_held_as_well_as_large_ones(top):
    """Of a top that is tilted by 1e-6 and spins at 20 rad/s: each state relative to its own size."""
    exact = simulate(
        top, NEARLY_UPRIGHT, (0, 5), WIDE, "taylor", 1e-15, t_eval=np.linspace(0, 5, 41)
    ).y
    size = np.abs(exact).max(axis=1)
    for rtol in (1e-3, 1e-5, 1e-7):
        ours = run(top, NEARLY_UPRIGHT, (0, 5), WIDE, rtol, t_eval=np.linspace(0, 5, 41))
        assert np.max(np.abs(ours.y - exact).max(axis=1) / size) < 30 * rtol
        assert ours.notice == ""


def test_what_rounding_of_the_momentum_hides_is_reported(top):
    """A rate of 1e-6 rad/s beside one of 20 has no more than nine digits: asked for or not."""
    ends = [run(top, NEARLY_UPRIGHT, (0, 2), WIDE, rtol) for rtol in (1e-12, 1e-14)]
    assert all(e.status == 0 and e.notice.startswith("rounding of the momentum is") for e in ends)
    assert all("omega_1, omega_2, more than" in e.notice for e in ends)
    assert ends[1].steps < 1.1 * ends[0].steps
    for rtol in (1e-6, 1e-12):
        assert run(top, FAST, (0, 2), TOP, rtol).notice == ""


def test_rates_that_fail_on_the_way_are_reported():
    """A torque with a pole at t = 1."""
    compiled = compile_system(body((1 / (1 - TIME), 0, 0), name="pole"), "c")
    end = run(compiled, [0.1, 0.2, 0.3, 1, 0, 0, 0], (0, 2), (1, 1.4, 2))
    assert end.status == -1
    assert end.t_stop <= 1


@pytest.mark.parametrize("attitude", [None, "3-1-2", "dcm"])
def test_systems_without_a_quaternion_are_refused(attitude):
    compiled = compile_system(eom.free_rigid_body(attitude), "numpy")
    with pytest.raises(InputError, match="method rkmk needs one unit quaternion") as refusal:
        rkmk.files(compiled.program, compiled.layout)
    assert "quaternion" in refusal.value.hint


def test_the_same_system_gives_the_same_bytes(top):
    first = rkmk.files(top.program, top.layout)
    assert first == rkmk.files(top.program, compile_system(heavy_top(), "c").layout)
    assert set(first) == {"heavy_top_rkmk.h", "heavy_top_rkmk.c"}
    assert all(text.isascii() and "@" not in text for text in first.values())
