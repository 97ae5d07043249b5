"""Trajectories: exact solutions, stops, singular configurations, stored times, and refusals."""

import math
import warnings

import mpmath
import numpy as np
import pytest
import scipy.integrate as si
import scipy.special
import sympy as sp

import eom
from codegen import METHODS, Compiled, simulate
from codegen import compile as compile_system
from codegen.integrate import sundials
from codegen.integrate.methods import OF_ATTITUDE
from codegen.native import native
from eom.errors import AssumptionError, InputError
from eom.kinematics.coordinates import SEQUENCES
from eom.mechanics.rigidbody import free_rigid_body
from eom.quantities import TIME
from eom.scenes import catalogue
from eom.system import System

pytestmark = pytest.mark.sparse

x, v, k, u, w = sp.symbols("x v k u w", real=True)
y1, y2, y3 = sp.symbols("y1 y2 y3", real=True)

OSCILLATOR = System.from_rates(
    "oscillator",
    {x: v, v: -k * x},
    outputs={"energy": v**2 / 2 + k * x**2 / 2},
    invariants={"E": v**2 / 2 + k * x**2 / 2},
)
BLOW_UP = System.from_rates("blow_up", {w: sp.Integer(0), x: x**2})
RUNNING_OUT = System.from_rates("running_out", {w: sp.Integer(0), x: -sp.sqrt(x) - 1})
DRIVEN = System.from_rates("driven", {x: v, v: -x + u}, inputs=[u], outputs={"push": 2 * u})
RIGID = System.from_rates("rigid", {y1: y2 * y3, y2: -y1 * y3, y3: -sp.Rational(51, 100) * y1 * y2})
HERE = [
    m for m in METHODS
    if m not in OF_ATTITUDE
    and (native.compiler() or m != "taylor")
    and (sundials.available() or not m.startswith("sundials:"))
]  # fmt: skip
"""Methods that this installation has, for any system."""
ACCURACY = {"scipy:RK23": (1e-6, 1e-3), "scipy:Radau": (1e-8, 1e-5), "scipy:BDF": (1e-8, 1e-4),
            "scipy:LSODA": (1e-9, 1e-5), "sundials:BDF": (1e-8, 1e-5),
            "sundials:Adams": (1e-9, 1e-6)}  # fmt: skip


of_functions = pytest.mark.parametrize("method", [m for m in HERE if m != "taylor"])
"""Methods that take inputs that are Python functions."""


@pytest.fixture(params=HERE)
def method(request):
    return request.param


@pytest.fixture(params=[m for m in HERE if m != "auto"])
def stepping(request):
    """Methods that make steps; ``auto`` takes closed forms."""
    return request.param


@pytest.fixture(scope="session")
def built(target):
    """Compile once a target and system."""
    known = {}

    def get(system) -> Compiled:
        if id(system) not in known:
            known[id(system)] = (system, compile_system(system, target))
        return known[id(system)][1]

    return get


def tolerance(method):
    return ACCURACY.get(method, (1e-10, 1e-7))


# --- accuracy -------------------------------------------------------------------------------------


def test_the_published_reference_of_a_rigid_body_is_met(built):
    """Problem of Krogh, in Shampine and Gordon (1975): y(20) to 1e-12, from (0, 1, 1)."""
    result = simulate(built(RIGID), (0.0, 1.0, 1.0), (0, 20), rtol=1e-13)
    expected = (-0.9396570798729192, -0.3421177754000779, 0.7414126596199957)
    np.testing.assert_allclose(result.y[:, -1], expected, rtol=0, atol=1e-12)
    assert result.success
    assert result.status == 0


def test_the_published_reference_is_the_value_of_elliptic_functions():
    """y1 = sn, y2 = cn, y3 = dn of parameter 0.51 and argument t: Abramowitz and Stegun, 16.16."""
    sn, cn, dn, _ = scipy.special.ellipj(20.0, 0.51)
    expected = (-0.9396570798729192, -0.3421177754000779, 0.7414126596199957)
    np.testing.assert_allclose((sn, cn, dn), expected, rtol=0, atol=1e-13)


def test_every_method_follows_the_exact_solution(built, method):
    rtol, allowed = tolerance(method)
    result = simulate(built(OSCILLATOR), {"x": 1.0, "v": 0.0}, (0, 7), {"k": 4.0}, method, rtol)
    np.testing.assert_allclose(result["x"], np.cos(2 * result.t), atol=allowed)
    np.testing.assert_allclose(result["v"], -2 * np.sin(2 * result.t), atol=2 * allowed)
    np.testing.assert_allclose(result["energy"], 2, rtol=10 * allowed)
    assert result.drift["E"].start == 2.0
    assert result.drift["E"].largest == np.max(np.abs(result["energy"] - result["energy"][0]))
    assert result.drift["E"].relative == result.drift["E"].largest / 2
    assert result.t_stop == 7
    np.testing.assert_array_equal(result.y_stop, result.y[:, -1])
    assert result.message == "reached t = 7 s"
    assert result.nfev > result.steps > 0 or result.method.startswith("closed form")


def test_every_method_comes_back_when_it_runs_backwards(built, method):
    rtol, allowed = tolerance(method)
    compiled = built(OSCILLATOR)
    there = simulate(compiled, (1.0, 0.5), (1, 4), [2.0], method, rtol)
    back = simulate(compiled, there.y_stop, (4, 1), [2.0], method, rtol)
    np.testing.assert_allclose(back.y_stop, (1.0, 0.5), atol=3 * allowed)
    assert back.t[0] == 4
    assert back.t[-1] == 1
    assert np.all(np.diff(back.t) < 0)


@pytest.mark.slow
@pytest.mark.shipped_flags
def test_ready_scenes_keep_their_constants(built, target):
    for name in catalogue.names()[:: 1 if target == "c" else 4]:
        scene = eom.load_scene(name)
        compiled = built(scene.derive())
        end = min(scene.integration.t_end, 5000.0)
        result = simulate(
            compiled, scene.initial_values(), (0, end), scene.parameter_values(), rtol=1e-12,
            inputs=scene.input_values(),
        )  # fmt: skip
        assert result.status == 0
        assert result.drift or not scene.derive().invariants
        for invariant, drift in result.drift.items():
            assert drift.relative < 1e-8, (name, invariant)


# --- stored times and dense output ------------------------------------------------------------------


@pytest.mark.parametrize("span", [(0.0, 6.0), (6.0, 0.0), (-2.0, 1.0)])
@pytest.mark.parametrize("ends", ["both", "none", "first", "last", "one time"])
def test_t_eval_is_kept_exactly(built, method, span, ends):
    rtol, allowed = tolerance(method)
    inside = np.linspace(*span, 23)
    choices = {"both": inside, "none": inside[1:-1], "first": inside[:-1], "last": inside[1:],
               "one time": inside[7:8]}  # fmt: skip
    grid = choices[ends]
    x0 = (math.cos(span[0]), -math.sin(span[0]))
    result = simulate(built(OSCILLATOR), x0, span, [1.0], method, rtol, t_eval=grid)
    np.testing.assert_array_equal(result.t, grid)
    np.testing.assert_allclose(result.y, [np.cos(grid), -np.sin(grid)], atol=3 * allowed)
    assert result["energy"].shape == grid.shape
    if ends in {"both", "first"}:
        np.testing.assert_array_equal(result.y[:, 0], x0)
    if ends in {"both", "last"}:
        np.testing.assert_allclose(result.y[:, -1], result.y_stop, rtol=1e-14, atol=1e-15)


def test_t_eval_may_be_empty_or_a_list(built, method):
    result = simulate(built(OSCILLATOR), (1.0, 0.0), (0, 1), [1.0], method, t_eval=[])
    assert result.t.shape == (0,)
    assert result.y.shape == (2, 0)
    assert result.status == 0
    assert result.t_stop == 1
    result = simulate(built(OSCILLATOR), (1.0, 0.0), (0, 1), [1.0], method, t_eval=[0, 1])
    assert result.t.tolist() == [0, 1]


@pytest.mark.parametrize("span", [(0.0, 6.0), (6.0, 0.0)])
def test_dense_output_follows_the_solution(built, method, span):
    rtol, allowed = tolerance(method)
    x0 = (math.cos(span[0]), -math.sin(span[0]))
    result = simulate(built(OSCILLATOR), x0, span, [1.0], method, rtol, dense_output=True)
    times = np.linspace(*span, 301)
    np.testing.assert_allclose(result.sol(times), [np.cos(times), -np.sin(times)], atol=5 * allowed)
    np.testing.assert_allclose(result.sol(1.5), [math.cos(1.5), -math.sin(1.5)], atol=5 * allowed)
    shuffled = np.random.default_rng(0).permutation(times)
    order = np.argsort(shuffled)[:: 1 if span[0] < span[1] else -1]
    found = result.sol(shuffled)[:, order]
    np.testing.assert_allclose(found, result.sol(times), rtol=1e-13, atol=1e-14)


def test_dense_output_and_t_eval_together_give_both(built, method):
    grid = np.linspace(0, 6, 13)
    rtol, allowed = tolerance(method)
    result = simulate(
        built(OSCILLATOR), (1.0, 0.0), (0, 6), [1.0], method, rtol, t_eval=grid, dense_output=True
    )
    np.testing.assert_array_equal(result.t, grid)
    assert result.y.shape == (2, 13)
    np.testing.assert_allclose(result.y, [np.cos(grid), -np.sin(grid)], atol=5 * allowed)
    between = np.linspace(0, 6, 100)
    np.testing.assert_allclose(result.sol(between)[0], np.cos(between), atol=5 * allowed)


# --- stops ------------------------------------------------------------------------------------------


@pytest.mark.sparse(4)
def test_a_pole_stops_the_run_and_keeps_what_it_has(built, method):
    """x' = x^2 from 1 is 1 / (1 - t)."""
    rtol = tolerance(method)[0]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = simulate(built(BLOW_UP), (0.5, 1.0), (0, 3), method=method, rtol=rtol)
    assert result.status == -1
    assert not result.success
    assert 0.9 < result.t_stop < 1.1
    assert f"t = {result.t_stop:.9g} s" in result.message
    assert result.t[-1] == result.t_stop
    assert np.all(np.isfinite(result.y))
    early = result.t < 0.9
    assert early.sum() > 3
    np.testing.assert_allclose(
        result.y[1, early], 1 / (1 - result.t[early]), rtol=100 * rtol + 1e-3
    )


def test_a_pole_names_the_state_that_goes_to_infinity(built):
    for method in ("auto", "scipy:DOP853", "scipy:RK45"):
        result = simulate(built(BLOW_UP), (0.5, 1.0), (0, 3), method=method)
        assert "x or its rate" in result.message or "step fell below" in result.message
        assert "w or its rate" not in result.message


def test_a_square_root_that_runs_negative_names_state_and_time(built, method):
    """x' = -sqrt(x) - 1 from 1 reaches 0 at t = 2 - 2 ln 2 and has no real rate beyond."""
    result = simulate(built(RUNNING_OUT), (0.5, 1.0), (0, 3), method=method, rtol=1e-7)
    assert result.status == -1
    assert result.t_stop == pytest.approx(2 - 2 * math.log(2), abs=2e-4)
    assert result.t_stop <= 2 - 2 * math.log(2) + 2e-4
    assert "x or its rate is not finite" in result.message
    assert f"t = {result.t_stop:.9g} s" in result.message
    assert np.all(np.isfinite(result.y))


def test_a_start_without_a_finite_rate_stops_at_once(built, method):
    result = simulate(built(RUNNING_OUT), (0.5, -1.0), (2, 3), method=method)
    assert result.status == -1
    assert result.t_stop == 2
    assert "x or its rate is not finite" in result.message
    assert result.steps == 0
    np.testing.assert_array_equal(result.y_stop, (0.5, -1.0))


@pytest.mark.parametrize("options", [{}, {"t_eval": [2.0, 2.5]}, {"dense_output": True}])
def test_a_start_that_stops_at_once_has_the_same_points_with_every_method(built, method, options):
    result = simulate(built(RUNNING_OUT), (0.5, -1.0), (2, 3), method=method, **options)
    assert result.y.shape == (2, len(result.t))
    assert len(result.t) == (0 if "t_eval" in options else 1)


@pytest.mark.sparse(4)
def test_t_eval_before_a_stop_is_kept(built, method):
    grid = np.linspace(0, 3, 31)
    result = simulate(
        built(BLOW_UP), (0.5, 1.0), (0, 3), method=method, rtol=tolerance(method)[0], t_eval=grid
    )
    assert result.status == -1
    kept = len(result.t)
    assert 9 <= kept <= 11
    np.testing.assert_array_equal(result.t, grid[:kept])
    np.testing.assert_allclose(result.y[1, :9], 1 / (1 - grid[:9]), rtol=1e-3)


@pytest.mark.parametrize("limit", [1, 2, 7])
def test_max_steps_stops_with_what_there_is(built, stepping, limit):
    result = simulate(built(OSCILLATOR), (1.0, 0.0), (0, 1000), [1.0], stepping, max_steps=limit)
    assert result.status == -1
    assert "max_steps" in result.message
    assert 0 < result.steps + result.rejected <= limit
    assert len(result.t) == result.steps + 1
    assert result.t_stop == result.t[-1] < 1000


def test_enough_max_steps_change_nothing(built, stepping):
    free = simulate(built(OSCILLATOR), (1.0, 0.0), (0, 5), [1.0], stepping, 1e-6)
    limited = simulate(
        built(OSCILLATOR), (1.0, 0.0), (0, 5), [1.0], stepping, 1e-6,
        max_steps=free.steps + free.rejected,
    )  # fmt: skip
    assert limited.status == 0
    np.testing.assert_array_equal(limited.t, free.t)


def test_max_step_and_first_step_are_kept(built, method):
    options = {"first_step": 0.01, "max_step": 0.125}
    result = simulate(built(OSCILLATOR), (1.0, 0.0), (0, 5), [1.0], method, 1e-4, **options)
    steps = np.diff(result.t)
    assert steps.max() <= 0.125 * (1 + 1e-12)
    assert steps[0] <= 0.01 * (1 + 1e-12)


def test_a_first_step_beyond_the_end_is_cut(built, method):
    result = simulate(built(OSCILLATOR), (1.0, 0.0), (0, 0.1), [1.0], method, first_step=5.0)
    assert result.status == 0
    assert result["x"][-1] == pytest.approx(math.cos(0.1), abs=1e-5)


@of_functions
def test_errors_of_the_users_own_functions_are_not_hidden(built, method):
    def broken(t):
        if t > 0.5:
            raise ValueError("my own")
        return 1.0

    with pytest.raises(ValueError, match="my own"):
        simulate(built(DRIVEN), (0.0, 0.0), (0, 5), method=method, inputs={"u": broken})


def test_a_short_span_and_one_far_from_zero_are_reached(built, method):
    for span in ((0.0, 1e-12), (1e6, 1e6 + 1e-3), (-1e6, -1e6 + 1e-3)):
        result = simulate(built(OSCILLATOR), (1.0, 0.0), span, [1.0], method, 1e-6)
        assert result.status == 0, result.message
        assert result.t[-1] == span[1]
        assert result.y[1, -1] == pytest.approx(-math.sin(span[1] - span[0]), rel=1e-5, abs=1e-9)


def test_progress_is_reported_up_to_the_end(built, method):
    shares = []
    simulate(built(OSCILLATOR), (1.0, 0.0), (0, 50), [1.0], method, 1e-6, progress=shares.append)
    assert shares[-1] == 1.0
    assert shares == sorted(shares)
    assert all(0 <= f <= 1 for f in shares)


# --- singular configurations --------------------------------------------------------------------------

LINEAR = eom.free_rigid_body("3-2-1")
"""With equal moments omega is constant; omega_2 alone turns theta at a constant rate."""
EQUAL = {"I1": 1.0, "I2": 1.0, "I3": 1.0}
SPINNER = eom.lecture_torque().system()
SPINNER_START = {
    "theta": 0.3, "psi": 0.0, "phi": 0.0, "theta_dot": 1.5, "psi_dot": 0.02, "C": 0.1,
}  # fmt: skip
SPINNER_VALUES = {"I1": 1.0, "I2": 0.4, "M1": -2.0}


def linear(**more):
    start = dict.fromkeys(LINEAR.state_names, 0.0)
    return {**start, "omega_2": 0.5, "theta": 0.2, **more}


@pytest.mark.sparse(4)
def test_a_singular_configuration_is_located_to_rounding(built, method):
    """theta = 0.2 + t/2, so that |cos theta| falls to the margin at an exactly known time."""
    margin = 1e-6
    result = simulate(built(LINEAR), linear(), (0, 10), EQUAL, method, margin=margin, max_step=2)
    expected = 2 * (math.acos(margin) - 0.2)
    assert result.status == 1
    assert result.success
    assert result.t_stop == pytest.approx(expected, abs=1e-8)
    assert result.t[-1] == result.t_stop
    assert abs(math.cos(result["theta"][-1])) <= margin * (1 + 1e-6)
    assert "theta = 1.57079" in result.message
    assert f"t = {result.t_stop:.9g} s" in result.message
    assert "cos(theta) = 0" in result.message
    (closest,) = result.margin.values()
    assert closest <= margin * (1 + 1e-6)


def test_a_singular_configuration_is_located_backwards(built, method):
    result = simulate(built(LINEAR), linear(), (0, -10), EQUAL, method, margin=1e-4, max_step=2)
    assert result.status == 1
    assert result.t_stop == pytest.approx(-2 * (math.acos(1e-4) + 0.2), abs=1e-7)


@pytest.mark.parametrize("margin", [1e-8, 1e-3, 0.3])
def test_a_spinner_that_falls_over_stops_at_the_exact_time(built, method, margin):
    """Without spin theta'' = -M1 / I1, so that theta = 0.3 + 1.5 t + t^2 exactly."""
    start = {**SPINNER_START, "psi_dot": 0.0, "C": 0.0}
    result = simulate(
        built(SPINNER), start, (0, 20), SPINNER_VALUES, method, margin=margin, max_step=0.2
    )
    expected = (-1.5 + math.sqrt(1.5**2 + 4 * (math.acos(margin) - 0.3))) / 2
    assert result.status == 1
    assert result.t_stop == pytest.approx(expected, abs=3 * tolerance(method)[1])
    assert result.message.startswith(f"stopped at t = {result.t_stop:.9g} s: theta = ")


def test_a_singular_configuration_inside_one_very_long_step_is_seen(built):
    result = simulate(built(LINEAR), linear(), (0, 1000), EQUAL, first_step=200.0)
    assert result.t_stop == pytest.approx(2 * (math.pi / 2 - 0.2), abs=1e-3)


@pytest.mark.parametrize("margin", [0.15, 0.3])
def test_a_spinner_with_spin_stops_where_an_independent_solver_says(built, margin):
    """The same equations, the margin as an event of SciPy's LSODA over functions that SymPy wrote."""
    result = simulate(
        built(SPINNER), SPINNER_START, (0, 20), SPINNER_VALUES, rtol=1e-12, margin=margin
    )
    symbols = {s.name: s for s in (q.symbol for q in (*SPINNER.states, *SPINNER.parameters))}
    names = SPINNER.state_names
    f = sp.lambdify([symbols[n] for n in names], [
        SPINNER.expand(r).xreplace({symbols[n]: v for n, v in SPINNER_VALUES.items()})
        for r in SPINNER.rates
    ], "math")  # fmt: skip

    def event(t, y):
        return abs(math.cos(y[names.index("theta")])) - margin

    event.terminal = True
    start = [SPINNER_START[n] for n in names]
    other = si.solve_ivp(
        lambda t, y: f(*y), (0, 20), start, method="LSODA", rtol=1e-11, atol=1e-13, events=event
    )
    assert result.status == 1
    assert result.t_stop == pytest.approx(other.t_events[0][0], rel=1e-6)
    assert "theta" in result.message


def test_crossing_between_two_steps_is_seen(built, method):
    """A loose tolerance and steps of 1 rad: no step ends near the singularity, the sign shows it."""
    result = simulate(
        built(LINEAR), linear(), (0, 40), EQUAL, method, 1e-2, max_step=2, margin=1e-9
    )
    assert result.status == 1
    assert result.t_stop == pytest.approx(2 * (math.pi / 2 - 0.2), abs=1e-2)


@pytest.mark.sparse(4)
def test_passing_outside_the_margin_does_not_stop(built, method):
    """A pendulum-like theta that turns round before pi/2: the least distance is reported."""
    quiet = System.from_rates("quiet", {x: v, v: -x})
    singular = System(
        "near", quiet.states, quiet.rates,
        singularities=(eom.Singularity(sp.cos(x), x, "test"),),
    )  # fmt: skip
    rtol = tolerance(method)[0]
    result = simulate(built(singular), (1.5, 0.0), (0, 20), method=method, rtol=rtol, margin=1e-3)
    assert result.status == 0
    (closest,) = result.margin.values()
    assert closest == pytest.approx(math.cos(1.5), rel=0.02)


@pytest.mark.parametrize("theta", [math.pi / 2, -math.pi / 2, math.pi / 2 + 1e-8])
def test_a_start_on_a_singularity_stops_at_once(built, method, theta):
    result = simulate(built(LINEAR), linear(theta=theta), (1, 10), EQUAL, method)
    assert result.t_stop == 1
    assert result.steps == 0
    assert result.status == 1
    assert "theta" in result.message
    assert f"{theta:.9g} rad" in result.message


def test_t_eval_ends_where_a_singularity_stops_the_run(built, method):
    grid = np.linspace(0, 10, 101)
    result = simulate(built(LINEAR), linear(), (0, 10), EQUAL, method, t_eval=grid, max_step=2)
    stop = 2 * (math.pi / 2 - 0.2)
    np.testing.assert_array_equal(result.t, grid[grid < stop - 1e-3])
    np.testing.assert_allclose(result["theta"], 0.2 + result.t / 2, atol=1e-6)
    assert result.status == 1


def test_dense_output_ends_where_a_singularity_stops_the_run(built, method):
    result = simulate(
        built(LINEAR), linear(), (0, 10), EQUAL, method, dense_output=True, max_step=2
    )
    times = np.linspace(0, result.t_stop, 50)
    index = LINEAR.state_names.index("theta")
    np.testing.assert_allclose(result.sol(times)[index], 0.2 + times / 2, atol=1e-6)


# --- inputs ------------------------------------------------------------------------------------------


def test_held_inputs_act_all_the_time(built, method):
    rtol, allowed = tolerance(method)
    result = simulate(
        built(DRIVEN), (0.0, 0.0), (0, 5), method=method, rtol=rtol, inputs={"u": 3.0}
    )
    np.testing.assert_allclose(result["x"], 3 - 3 * np.cos(result.t), atol=20 * allowed)
    np.testing.assert_array_equal(result["push"], 6.0)


@pytest.mark.sparse(4)
@of_functions
def test_inputs_may_be_functions_of_time(built, method):
    """x'' + x = cos 3t from rest is (cos t - cos 3t) / 8."""
    rtol, allowed = tolerance(method)
    result = simulate(
        built(DRIVEN), (0.0, 0.0), (0, 5), method=method, rtol=rtol,
        inputs={"u": lambda t: math.cos(3 * t)},
    )  # fmt: skip
    exact = (np.cos(result.t) - np.cos(3 * result.t)) / 8
    np.testing.assert_allclose(result["x"], exact, atol=20 * allowed)
    np.testing.assert_allclose(result["push"], 2 * np.cos(3 * result.t), rtol=1e-14, atol=1e-15)


def test_inputs_that_are_functions_work_with_t_eval_and_dense_output(built):
    grid = np.linspace(0, 5, 11)
    result = simulate(
        built(DRIVEN), (0.0, 0.0), (0, 5), inputs={"u": lambda t: math.cos(3 * t)}, t_eval=grid,
        dense_output=True, rtol=1e-10,
    )  # fmt: skip
    np.testing.assert_allclose(
        result.sol(grid)[0], (np.cos(grid) - np.cos(3 * grid)) / 8, atol=1e-8
    )
    np.testing.assert_allclose(result["push"], 2 * np.cos(3 * grid), rtol=1e-14, atol=1e-15)
    assert "inputs are Python functions" in result.method


def test_time_in_the_rates_is_the_time_of_the_run(built, method):
    system = System.from_rates("clock", {x: sp.cos(TIME)})
    rtol, allowed = tolerance(method)
    result = simulate(built(system), [math.sin(2)], (2, 6), method=method, rtol=rtol)
    np.testing.assert_allclose(result["x"], np.sin(result.t), atol=20 * allowed)


# --- refusals ------------------------------------------------------------------------------------------

BODY = eom.free_rigid_body()
START = {"omega_1": 1.0, "omega_2": 2.0, "omega_3": 3.0}
MOMENTS = {"I1": 1.0, "I2": 1.2, "I3": 1.5}


@pytest.mark.parametrize(
    ("start", "moments", "kind", "words"),
    [
        ({"omega_1": 1.0}, MOMENTS, InputError, ["missing", "omega_2, omega_3"]),
        ({**START, "omega_4": 1.0}, MOMENTS, InputError, ["omega_4", "did you mean omega_"]),
        ({**START, "omega_1": math.nan}, MOMENTS, InputError, ["omega_1 is not finite", "nan"]),
        ({**START, "omega_1": math.inf}, MOMENTS, InputError, ["omega_1 is not finite"]),
        (
            {**START, "omega_1": "fast"},
            MOMENTS,
            InputError,
            ["not a number", "value of omega_1", "'fast'"],
        ),
        ([1.0, 2.0], MOMENTS, InputError, ["wrong number", "omega_1, omega_2, omega_3"]),
        ([[1.0, 2.0, 3.0]], MOMENTS, InputError, ["initial is", "[[1.0", "Sequence[float]"]),
        (None, MOMENTS, InputError, ["omega_1"]),
        (START, {"I1": 1.0, "I2": 1.2}, InputError, ["missing", "I3"]),
        (START, None, InputError, ["I1, I2, I3"]),
        (START, {**MOMENTS, "I_3": 1.0}, InputError, ["I_3", "did you mean"]),
        (START, {**MOMENTS, "I3": math.nan}, InputError, ["I3"]),
        (START, {**MOMENTS, "I1": 0.0}, InputError, ["I1 is not positive"]),
        (START, {**MOMENTS, "I1": -1.0}, InputError, ["I1 is not positive"]),
        (START, [1.0, 1.2, -1.5], InputError, ["I3 is not positive"]),
        (START, {**MOMENTS, "I3": 2.3}, AssumptionError, ["I1 + I2 - I3 >= 0", "I3 = 2.3"]),
        (START, [1.0, 1.2, 2.3], AssumptionError, ["I1 + I2 - I3 >= 0"]),
        (START, {**MOMENTS, "J12": 0.1}, AssumptionError, ["principal_axes", "J12 = 0.1"]),
    ],
)
def test_values_that_cannot_be_are_refused(built, start, moments, kind, words):
    with pytest.raises(InputError) as error:
        simulate(built(BODY), start, (0, 1), moments)
    assert type(error.value) is kind
    assert all(word in str(error.value) for word in words), str(error.value)


def test_moments_on_the_edge_of_the_triangle_inequality_are_a_flat_body(built):
    result = simulate(built(BODY), START, (0, 1), {"I1": 0.1, "I2": 0.2, "I3": 0.1 + 0.2})
    assert result.success


def test_zero_products_of_inertia_agree_with_principal_axes(built):
    assert simulate(built(BODY), START, (0, 1), {**MOMENTS, "J12": 0.0}).success


def scene(moments=(1.0, 1.0, 0.4)):
    return eom.Scene(body={"moments": moments}, attitude="3-1-3")


def test_a_torque_for_a_torque_free_system_is_a_contradiction(built):
    system = scene().derive()
    start = dict.fromkeys(system.state_names, 0.3)
    values = dict.fromkeys(system.parameter_names, 1.0)
    assert simulate(built(system), start, (0, 1), {**values, "tau_1": 0.0}).success
    with pytest.raises(AssumptionError) as error:
        simulate(built(system), start, (0, 1), {**values, "tau_1": 0.5})
    assert "torque" in str(error.value)
    assert "tau_1 = 0.5" in str(error.value)


def test_another_moment_for_a_symmetric_system_is_a_contradiction(built):
    system = scene().derive()
    assert "I2" not in system.parameter_names
    start = dict.fromkeys(system.state_names, 0.3)
    values = dict.fromkeys(system.parameter_names, 1.0)
    assert simulate(built(system), start, (0, 1), {**values, "I2": values["I1"]}).success
    with pytest.raises(AssumptionError) as error:
        simulate(built(system), start, (0, 1), {**values, "I2": 1.3})
    assert "I1 == I2" in str(error.value)
    assert "I2 = 1.3" in str(error.value)


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"t_span": (0, 0)}, "t_span"),
        ({"t_span": (0, math.inf)}, "t_span"),
        ({"t_span": (math.nan, 1)}, "t_span"),
        ({"method": "RK45"}, "unknown method 'RK45'"),
        ({"method": "dop835"}, "unknown method 'dop835'"),
        ({"rtol": 0.0}, "rtol"),
        ({"rtol": -1e-6}, "rtol"),
        ({"rtol": math.nan}, "rtol"),
        ({"rtol": 2.0**-53}, "rtol does not fit"),
        ({"rtol": math.inf}, "rtol does not fit"),
        ({"atol": -1.0}, "atol"),
        ({"atol": [1.0, 1.0, 1.0]}, "atol"),
        ({"atol": math.nan}, "atol"),
        ({"t_eval": [0.0, 2.0]}, "t_eval"),
        ({"t_eval": [0.5, 0.2]}, "t_eval"),
        ({"t_eval": [0.5, 0.5]}, "t_eval"),
        ({"t_eval": [[0.5]]}, "t_eval"),
        ({"t_eval": [math.nan]}, "t_eval"),
        ({"first_step": 0.0}, "first_step"),
        ({"first_step": math.nan}, "first_step"),
        ({"max_step": -1.0}, "max_step"),
        ({"margin": 0.0}, "margin"),
        ({"inputs": {"u": 1.0}}, "unknown input 'u'"),
    ],
)
def test_options_that_cannot_be_are_refused(built, options, word):
    arguments = {"t_span": (0, 1), **options}
    with pytest.raises(InputError, match=word):
        simulate(built(OSCILLATOR), (1.0, 0.0), parameters=[1.0], **arguments)


def test_inputs_that_cannot_be_are_refused(built):
    for inputs, word in (
        (None, "missing input"),
        ({}, "missing input"),
        ({"v": 1.0}, "unknown input 'v'"),
        ({"u": math.nan}, "u is not finite"),
    ):
        with pytest.raises(InputError, match=word):
            simulate(built(DRIVEN), (1.0, 0.0), (0, 1), inputs=inputs)


def test_parameters_that_were_compiled_in_cannot_be_given_again(target):
    fixed = compile_system(OSCILLATOR, target, {"k": 1.0})
    result = simulate(fixed, (1.0, 0.0), (0, 1))
    assert result["x"][-1] == pytest.approx(math.cos(1), abs=1e-8)
    with pytest.raises(InputError, match="k was compiled in"):
        simulate(fixed, (1.0, 0.0), (0, 1), {"k": 1.0})


def test_results_are_read_by_name_and_misspelt_names_are_refused(built):
    result = simulate(built(OSCILLATOR), (1.0, 0.0), (0, 1), [1.0])
    np.testing.assert_array_equal(result["v"], result.y[1])
    assert result.names == ("x", "v")
    with pytest.raises(InputError, match="energi") as error:
        result["energi"]
    assert "energy" in error.value.hint


def test_a_system_is_compiled_by_itself_and_once():
    first = simulate(OSCILLATOR, (1.0, 0.0), (0, 1), [1.0])
    second = simulate(OSCILLATOR, (1.0, 0.0), (0, 1), [1.0])
    np.testing.assert_array_equal(first.y, second.y)


def test_arguments_are_not_changed(built):
    start, values = np.array([1.0, 0.0]), np.array([1.0])
    grid, atol = np.linspace(0, 1, 5), np.array([1e-9, 1e-9])
    copies = [a.copy() for a in (start, values, grid, atol)]
    result = simulate(built(OSCILLATOR), start, (0, 1), values, t_eval=grid, atol=atol)
    for a, b in zip((start, values, grid, atol), copies, strict=True):
        np.testing.assert_array_equal(a, b)
    result.t[:] = 0
    np.testing.assert_array_equal(grid, copies[2])


def test_a_tolerance_for_each_state_is_used(built):
    loose = simulate(built(OSCILLATOR), (1.0, 0.0), (0, 5), [1.0], "DOP853", 1e-12, [1e-3, 1e-3])
    tight = simulate(built(OSCILLATOR), (1.0, 0.0), (0, 5), [1.0], "DOP853", 1e-12, [1e-3, 1e-13])
    assert tight.nfev > loose.nfev


def test_the_motion_near_a_pole_agrees_with_high_precision(built):
    """x' = x^2 at t = 0.999: 1000; errors grow with x^2, so that 1e-12 becomes some 1e-9."""
    result = simulate(built(BLOW_UP), (0.5, 1.0), (0, 0.999), rtol=1e-13)
    with mpmath.workdps(30):
        exact = 1 / (1 - mpmath.mpf(0.999))
        assert abs(result.y[1, -1] - exact) / exact < 1e-8


@pytest.mark.sparse(2)
@pytest.mark.parametrize("method", ["auto", "scipy:DOP853"])
@pytest.mark.parametrize("name", SEQUENCES)
def test_no_step_jumps_over_a_singular_angle(name, method):
    """Spins about the second axis have constant rates, so that steps would grow without end."""
    compiled = compile_system(free_rigid_body(name))
    singular = math.pi if name[0] == name[-1] else math.pi / 2
    for start, rate, end, rtol in (
        (0.3, 1.0, 1e3, 1e-3),
        (0.3, 0.01, 1e6, 1e-9),
        (1.1, 1.0, 1e3, 1e-6),
    ):
        initial = {f"omega_{k}": rate * (k == int(name[2])) for k in (1, 2, 3)}
        initial |= {"psi": 0.0, "theta": start, "phi": 0.0}
        moments = {"I1": 1.0, "I2": 1.5, "I3": 2.0}
        result = simulate(compiled, initial, (0, end), moments, rtol=rtol, method=method)
        assert result.status == 1
        assert result.t_stop == pytest.approx((singular - start) / rate, rel=1e-5)


@pytest.mark.sparse(only=("c",))
def test_a_run_that_chatters_ends_with_a_reason(built):
    """Coulomb friction without a model of rest: the sign changes at every step."""
    x = sp.Symbol("x", real=True)
    system = System.from_rates("friction", {x: -sp.sign(x)})
    result = simulate(built(system), [1.0], (0, 2), max_steps=2_000)
    assert result.status == -1
    assert result.t_stop == pytest.approx(1.0, abs=1e-2)
    assert "all of max_steps = 2,000 were tried" in result.message
    assert "friction" in result.message


@pytest.mark.parametrize("limit", [1, 999, 3000, 10_000, 70_000])
def test_max_steps_counts_rejected_steps_too(limit):
    x = sp.Symbol("x", real=True)
    compiled = compile_system(System.from_rates("friction", {x: -sp.sign(x)}))
    if compiled.target == "c":
        result = simulate(compiled, [1.0], (0, 2), max_steps=limit)
        assert result.steps + result.rejected == limit


@pytest.mark.parametrize("limit", [0, -1, 2.5, math.inf])
def test_max_steps_is_a_positive_whole_number(limit):
    with pytest.raises(InputError, match="max_steps"):
        simulate(free_rigid_body(), [1, 0, 0], (0, 1), [1, 2, 2.5], max_steps=limit)


def test_an_invariant_that_is_lost_shows_a_drift_beyond_one():
    """At a hopeless tolerance the energy grows many times over; the report must not hide it."""
    initial, moments = [0.1, 2.0, 0.3], [1e-9, 1.5e-9, 2e-9]
    result = simulate(free_rigid_body(), initial, (0, 300), moments, "DOP853", rtol=0.1, atol=0.1)
    energy = 0.5 * np.array(moments) @ result.y**2
    lost = np.max(np.abs(energy - energy[0])) / energy[0]
    assert lost > 10
    assert result.drift["T"].relative == pytest.approx(lost)


def test_a_constant_that_is_a_small_difference_is_measured_by_its_terms():
    a, b = sp.symbols("a b", real=True)
    radius = {"zero": a**2 + b**2 - sp.Rational(1, 4)}
    system = System.from_rates("circle", {a: b, b: -a}, invariants=radius)
    result = simulate(system, [0.3, 0.4], (0, 10))
    drift = result.drift["zero"]
    assert abs(drift.start) < 1e-16
    assert drift.scale == pytest.approx(0.5, rel=1e-7)
    assert drift.relative == drift.largest / drift.scale < 1e-7


@pytest.mark.parametrize("options", [{}, {"first_step": 1e-7}])
def test_a_run_may_start_late(built, options):
    """The first step that the rates suggest is below the resolution of so large a time."""
    x, y = sp.symbols("x y", real=True)
    rest = System.from_rates("rest", {x: -x, y: 0 * y})
    assert simulate(built(rest), [0.0, 0.0], (1e9, 1e9 + 10), **options).status == 0
    swing = System.from_rates("swing", {x: y, y: -x})
    result = simulate(built(swing), [1.0, 0.0], (1e9, 1e9 + 10), **options)
    assert result.status == 0
    assert result.y[0, -1] == pytest.approx(math.cos(10), abs=1e-6)


@pytest.mark.parametrize("attitude", ["quaternion", "dcm"])
def test_a_start_that_is_no_rotation_is_refused(attitude):
    system = free_rigid_body(attitude)
    start = dict.fromkeys(system.state_names, 0.0) | {"omega_1": 1.0}
    unit = {"q0": 1.0} if attitude == "quaternion" else {"C11": 1.0, "C22": 1.0, "C33": 1.0}
    moments = {"I1": 1.0, "I2": 1.5, "I3": 2.0}
    end = simulate(system, start | unit, (0, 100), moments).y_stop
    assert simulate(system, end, (0, 1), moments).success
    with pytest.raises(AssumptionError, match="is that of a rotation"):
        simulate(system, start | unit | {next(iter(unit)): 2.0}, (0, 1), moments)


def test_a_scene_is_no_system():
    with pytest.raises(
        InputError, match=r"system is of the wrong type[\s\S]*derive\(\) of a scene"
    ):
        simulate(eom.Scene.ready("t-handle"), [1, 0, 0], (0, 1))


def test_a_state_that_is_held_starts_where_the_initial_values_say():
    """Other than its parameter says; it stands in the result as any state does."""
    scene = eom.Scene(
        body={"moments": [2, 2, 1]},
        outputs=["omega_1", "omega_3"],
        initial={"omega_1": 1, "omega_2": 0, "omega_3": 0.5},
    )
    system, values = scene.derive(), scene.parameter_values()
    assert (system.state_names, values["omega_3"]) == (("omega_1", "omega_2"), 0.5)
    start = {"omega_1": 1, "omega_2": 0, "omega_3": "3 rad/s"}
    run = simulate(system, start, (0, 2), values, t_eval=[0, 1, 2])
    np.testing.assert_array_equal(run["omega_3"], 3.0)
    np.testing.assert_allclose(run["omega_1"], np.cos(1.5 * run.t), atol=1e-9)
    in_order = simulate(system, start, (0, 2), [values[n] for n in system.parameter_names])
    assert in_order.held == {"omega_3": 3.0}
    with pytest.raises(InputError, match="omega_4"):
        simulate(system, {**start, "omega_4": 1}, (0, 2), values)
