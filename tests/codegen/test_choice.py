"""The method auto: what it takes for which problem, when it changes its mind, closed forms in its place."""

import itertools

import numpy as np
import pytest
import sympy as sp

import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.closed import closed_forms
from codegen.closed.closed_forms import Closed
from codegen.compiling.events import Event
from codegen.derivatives.taylor import prepare
from codegen.integrate import choice
from codegen.integrate import choice as stiffness
from codegen.ir.interpret import Point
from codegen.loops import taylor
from codegen.native import native
from codegen.native.trajectory import Problem
from codegen.watch.trust import is_analytic
from eom.mechanics.dissipation import viscous_slug
from eom.problems import PROBLEMS
from eom.quantities import TIME
from eom.system import System

x, v, k, mu = sp.symbols("x v k mu", real=True)
y1, y2, y3 = sp.symbols("y1 y2 y3", real=True)

ROBERTSON = System.from_rates(
    "robertson",
    {
        y1: -sp.Rational(4, 100) * y1 + 10**4 * y2 * y3,
        y2: sp.Rational(4, 100) * y1 - 10**4 * y2 * y3 - 3 * 10**7 * y2**2,
        y3: 3 * 10**7 * y2**2,
    },
    invariants={"mass": y1 + y2 + y3},
)
VAN_DER_POL = System.from_rates("van_der_pol", {x: v, v: mu * (1 - x**2) * v - x})
SPRING = System.from_rates("spring", {x: v, v: -k * x}, invariants={"E": v**2 + k * x**2})
CURVE = eom.Table("curve", [-2.0, 0.0, 2.0], [-2.5, 0.0, 2.5], kind="pchip")
KINKS = {
    "sign": {x: v, v: -x - sp.sign(v) / 10},
    "abs": {x: v, v: -x * sp.Abs(x)},
    "piecewise": {x: v, v: sp.Piecewise((-x, x > 0), (-4 * x, True))},
    "table": {x: v, v: -CURVE(x)},
}

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")


@pytest.fixture(scope="module")
def in_c():
    known = {}

    def get(system):
        return known.setdefault(id(system), (system, compile_system(system, "c")))[1]

    return get


@pytest.fixture
def none_closed(monkeypatch):
    monkeypatch.setattr(closed_forms, "find", lambda compiled, problem: None)


# --- what is taken --------------------------------------------------------------------------------


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("name", ["heavy-top", "lecture-wheel", "gravity-gradient-satellite"])
@pytest.mark.usefixtures("none_closed")
def test_ready_scenes_without_a_closed_form_go_to_taylor_series(name):
    scene = eom.load_scene(name)
    plan = scene.initial_values(), (0.0, 5.0), scene.parameter_values()
    result = simulate(compile_system(scene.derive(), "c"), *plan)
    assert result.method.startswith("Taylor series of order")
    assert "smooth" in result.why


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("kind", KINKS)
def test_kinks_and_tables_go_to_runge_kutta(kind):
    result = simulate(System.from_rates(kind, KINKS[kind]), (1.0, 0.2), (0, 5))
    assert result.method == "DOP853 in generated C"
    assert ("branches" in result.why) or ("no Taylor series" in result.why)


@pytest.mark.usefixtures("none_closed")
def test_python_inputs_and_targets_without_c_go_to_runge_kutta():
    u = sp.Symbol("u", real=True)
    driven = System.from_rates("driven", {x: v, v: u - x}, inputs=[u])
    result = simulate(driven, (0.0, 0.0), (0, 1), inputs={"u": np.cos})
    assert "DOP853" in result.method
    assert "Python functions" in result.why
    numpy = simulate(compile_system(SPRING, "numpy"), (1.0, 0.0), (0, 1), [4.0])
    assert "DOP853" in numpy.method
    assert "numpy" in numpy.why


@needs_compiler
@pytest.mark.usefixtures("none_closed")
def test_a_system_of_too_many_operations_goes_to_runge_kutta(in_c, monkeypatch):
    monkeypatch.setattr(choice, "LONGEST", 10)
    choice._against_series.cache_clear()
    result = simulate(in_c(SPRING), (1.0, 0.0), (0, 1), [4.0])
    choice._against_series.cache_clear()
    assert result.method == "DOP853 in generated C"
    assert "operations in a row" in result.why


def test_a_method_that_is_given_needs_no_reason():
    result = simulate(SPRING, (1.0, 0.0), (0, 1), [4.0], "DOP853")
    assert result.why == ""


# --- stiffness ------------------------------------------------------------------------------------


def test_the_reach_of_taylor_series_is_where_the_truncated_exponential_leaves_the_unit_disc():
    """Order 4 has that of the classical Runge-Kutta method, 2.785: Hairer and Wanner II, fig. IV.2.1."""
    assert stiffness.taylor_reach(4) == pytest.approx(2.785, abs=0.02)
    orders = [stiffness.taylor_reach(p) for p in range(4, 28)]
    assert all(b > a for a, b in itertools.pairwise(orders))


@pytest.mark.sparse(3)
@needs_compiler
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("method", ["taylor", "DOP853"])
def test_accuracy_alone_keeps_steps_away_from_what_counts_as_limited(in_c, method, rtol):
    """Bounds of `stiffness.NEAR`: h |lambda| of an oscillator, lambda = i."""
    run = simulate(in_c(SPRING), (1.0, 0.0), (0, 200), [1.0], method, rtol)
    reach = stiffness.taylor_reach(taylor.order_of(rtol)) if method == "taylor" else 6.1
    assert np.median(np.diff(run.t)) < 0.8 * stiffness.NEAR * reach


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize(
    ("damping", "stiff"), [(1e-6, False), (1.0, False), (1e7, True), (1e10, True)]
)
def test_a_damper_from_weak_to_huge_is_stiff_where_it_pays(in_c, damping, stiff):
    """Momentum is kept whatever is chosen; the damper's own rate is c (1/J + 1/I)."""
    parameters = {"I1": 1.0, "I2": 2.0, "I3": 3.0, "J_s": 0.1, "c": damping}
    start = {
        "omega_1": 0.1,
        "omega_2": 1.0,
        "omega_3": 0.1,
        "sigma_1": 0.0,
        "sigma_2": 0.0,
        "sigma_3": 0.0,
    }
    result = simulate(in_c(viscous_slug()), start, (0, 50), parameters, rtol=1e-7)
    assert result.status == 0
    assert result.why.startswith("stiff: in a trial") == stiff
    assert result.drift["H"].relative < 1e-5
    assert result.steps < 100_000


@needs_compiler
def test_stiffness_that_comes_later_is_met_on_the_way(in_c):
    """Robertson's problem starts with slow rates. y(400) and y(4e10): Hairer and Wanner II, sect. IV.10,
    and the test set of Mazzia and Magherini (2008)."""
    grid = np.array([0.0, 1e-3, 400.0, 4000.0])
    result = simulate(
        in_c(ROBERTSON), (1.0, 0.0, 0.0), (0, 4e5), rtol=1e-10, t_eval=grid, dense_output=True
    )
    assert result.status == 0
    assert result.method.startswith("Taylor series")
    assert "then LSODA" in result.method
    assert "stiff from t = " in result.why
    assert result.t.tolist() == grid.tolist()
    other = simulate(
        in_c(ROBERTSON), (1.0, 0.0, 0.0), (0, 4000), method="scipy:Radau", rtol=1e-9, t_eval=grid
    )
    np.testing.assert_allclose(result.y, other.y, rtol=2e-7, atol=1e-12)
    np.testing.assert_allclose(result.sol(grid), result.y, rtol=1e-9, atol=1e-14)
    assert result.drift["mass"].relative < 1e-7
    assert result.steps < 30_000


@needs_compiler
def test_a_run_in_two_parts_stores_every_step_once(in_c):
    result = simulate(in_c(ROBERTSON), (1.0, 0.0, 0.0), (0, 4e5), rtol=1e-6)
    assert "then" in result.method
    assert np.all(np.diff(result.t) > 0)
    assert result.y.shape == (3, len(result.t))
    assert len(result.t) == result.steps + 1


@needs_compiler
def test_stiffness_at_the_start_is_found_by_a_trial(in_c):
    result = simulate(in_c(VAN_DER_POL), (2.0, 0.0), (0, 2e4), {"mu": 1e4}, rtol=1e-7)
    assert result.method.startswith("LSODA")
    assert result.why.startswith("stiff: in a trial")
    other = simulate(in_c(VAN_DER_POL), (2.0, 0.0), (0, 2e4), {"mu": 1e4}, "scipy:Radau", 1e-8)
    assert result.y[0, -1] == pytest.approx(other.y[0, -1], rel=1e-4)


def test_stiff_modes_that_oscillate_go_to_radau():
    assert not stiffness.Stiff(-1e6 + 1e6j, 6.0, 1e9).oscillates
    assert stiffness.Stiff(-1e5 + 1e6j, 6.0, 1e9).oscillates


@needs_compiler
def test_growth_is_not_stiff_forwards_and_decay_not_backwards(in_c):
    growth = System.from_rates("growth", {x: k * x})
    compiled = compile_system(growth, "c")
    for rate, span in ((1.0, (0, 30)), (-1e7, (0, -2e-6)), (0.0, (0, 1e9))):
        result = simulate(compiled, (1e-9,), span, {"k": rate})
        assert result.method.startswith("Taylor"), result.why
        assert result.y[0, -1] == pytest.approx(1e-9 * np.exp(rate * span[1]), rel=1e-6)


@needs_compiler
def test_watching_changes_no_number(in_c, monkeypatch):
    plain = simulate(in_c(VAN_DER_POL), (2.0, 0.0), (0, 200), {"mu": 5.0}, "taylor")
    monkeypatch.setattr(choice, "WATCH", {True: 7, False: 7})
    watched = simulate(in_c(VAN_DER_POL), (2.0, 0.0), (0, 200), {"mu": 5.0})
    assert np.array_equal(plain.y, watched.y)


@needs_compiler
def test_progress_and_max_steps_count_over_both_parts(in_c):
    reported = []
    run = in_c(ROBERTSON), (1.0, 0.0, 0.0), (0, 4e5)
    assert simulate(*run, rtol=1e-6, progress=reported.append).status == 0
    assert reported == sorted(reported)
    assert reported[-1] == 1.0
    result = simulate(*run, rtol=1e-6, max_steps=20_010)
    assert result.status == -1
    assert result.steps + result.rejected == 20_010


# --- closed forms ---------------------------------------------------------------------------------


def turning(compiled, problem):
    """x' = v, v' = -k x: x0 cos(w t) + v0/w sin(w t)."""
    w = np.sqrt(problem.parameters[0])
    a, b = problem.x0

    def states(t):
        c, s = np.cos(w * t), np.sin(w * t)
        return np.array([a * c + b / w * s, b * c - a * w * s])

    return Closed("harmonic", "linear spring", states, None, ("x", "v"))


@pytest.fixture
def closed(monkeypatch):
    monkeypatch.setattr(closed_forms, "find", turning)


@pytest.mark.usefixtures("closed")
def test_a_closed_form_takes_the_place_of_steps():
    result = simulate(SPRING, (1.0, 0.5), (1, 21), [4.0], dense_output=True)
    assert result.method == "closed form: harmonic"
    assert result.why == "linear spring"
    assert (result.steps, result.nfev, result.status) == (0, 0, 0)
    assert len(result.t) == 1001
    assert (result.t[0], result.t[-1]) == (1.0, 21.0)
    assert result.drift["E"].relative < 1e-14
    exact = np.cos(2 * 0.7) + 0.25 * np.sin(2 * 0.7)
    assert result.sol(1.7)[0] == pytest.approx(exact, rel=1e-15)
    assert result.sol([1.7, 2.0]).shape == (2, 2)
    grid = [21.0, 3.5, 1.5]
    back = simulate(SPRING, (1.0, 0.5), (21, 1), [4.0], t_eval=grid)
    assert back.t.tolist() == grid
    other = simulate(SPRING, (1.0, 0.5), (21, 1), [4.0], "DOP853", 1e-12, t_eval=grid)
    np.testing.assert_allclose(back.y, other.y, rtol=0, atol=1e-9)


@pytest.mark.usefixtures("closed")
@pytest.mark.parametrize("margin", [1e-9, 1e-6, 1e-2])
@pytest.mark.parametrize("amplitude", [1.0, 0.5 * (1 + 1e-10), 0.25])
@pytest.mark.parametrize("sense", [1, -1])
def test_a_closed_form_stops_at_a_singular_configuration(margin, amplitude, sense):
    """Singular at x = 1/2: passed at a speed, all but touched within an interval, not reached."""
    singular = eom.quantities.Singularity(x - sp.Rational(1, 2), x, "half way")
    system = System(
        "stopping", SPRING.states, SPRING.rates, SPRING.parameters, singularities=(singular,)
    )
    result = simulate(system, (0.0, sense * amplitude * 3), (0, sense * 1.5), [9.0], margin=margin)
    distance = 0.5 - margin
    if amplitude > distance:
        assert result.status == 1
        assert result.t_stop == pytest.approx(
            sense * np.arcsin(min(1, distance / amplitude)) / 3, rel=1e-5
        )
        assert abs(result.margin["x - 1/2"]) <= margin * (1 + 1e-6)
        assert abs(result.t[-1]) <= abs(result.t_stop)
    else:
        assert result.status == 0
        assert result.margin["x - 1/2"] == pytest.approx(0.25, rel=1e-4)


@pytest.mark.usefixtures("closed")
def test_a_search_for_singularities_ends_with_max_steps():
    singular = eom.quantities.Singularity(x - 5, x, "never")
    system = System(
        "endless", SPRING.states, SPRING.rates, SPRING.parameters, singularities=(singular,)
    )
    result = simulate(system, (1.0, 0.0), (0, 1e6), [4.0], max_steps=10_000)
    assert result.status == -1
    assert 0 < result.t_stop < 1e6


def test_the_form_is_asked_with_the_problem(monkeypatch):
    asked = []
    monkeypatch.setattr(closed_forms, "find", lambda c, p: asked.append((c, p)))
    simulate(SPRING, (1.0, 0.5), (0, 1), [4.0])
    ((compiled, problem),) = asked
    assert isinstance(problem, Problem)
    assert compiled.layout.name == "spring"
    assert problem.parameters.tolist() == [4.0]
    assert TIME not in compiled.system.parameters


# --- what goes on where a series cannot -----------------------------------------------------------

PULSE = System.from_rates("pulse", {x: v, v: -x + 5 / sp.cosh(1000 * (TIME - 4)) ** 2})
BUMP = System.from_rates("bump", {x: v, v: -x + 3 / sp.cosh(400 * x) ** 2})


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("rtol", [1e-6, 1e-12])
def test_a_series_that_overflows_at_the_start_is_continued_by_runge_kutta(in_c, rtol):
    grid = np.linspace(0, 8, 33)
    found = simulate(in_c(PULSE), (1.0, 0.0), (0, 8), None, "auto", rtol, t_eval=grid)
    other = simulate(in_c(PULSE), (1.0, 0.0), (0, 8), None, "DOP853", rtol, t_eval=grid)
    assert "to t = 0 s, then DOP853" in found.method
    assert "Taylor coefficients are not finite at t = 0 s" in found.why
    assert found.notice == ""
    assert (found.steps, found.rejected) == (other.steps, other.rejected)
    assert found.nfev - other.nfev == taylor.order_of(rtol) + 1
    assert found.t.tolist() == grid.tolist()
    np.testing.assert_array_equal(found.y, other.y)
    kick = 2 * 5 / 1000 * np.array([np.sin(4.0), np.cos(4.0)])
    exact = np.array([np.cos(8.0), -np.sin(8.0)]) + kick
    assert np.abs(found.y[:, -1] - exact).max() < 1e3 * rtol + 1e-7


@needs_compiler
def test_a_series_that_is_asked_for_stops_where_it_overflows(in_c):
    found = simulate(in_c(PULSE), (1.0, 0.0), (0, 8), None, "taylor")
    assert (found.status, found.t_stop, found.steps) == (-1, 0.0, 0)
    assert found.message.startswith("stopped at t = 0 s")


@pytest.mark.sparse(1)
@needs_compiler
@pytest.mark.parametrize("backwards", [False, True])
def test_a_run_that_is_continued_on_the_way_has_events_points_and_dense_output(in_c, backwards):
    """Far from the bump its series overflows; what is found of the motion is that of one method alone."""
    span, start = (0, -12.0) if backwards else (0, 12.0), (-0.1, -2.0 if backwards else 2.0)
    grid = np.linspace(*span, 49)
    plan = in_c(BUMP), start, span
    watched = {"middle": x, "turn": v}
    found = simulate(*plan, t_eval=grid, dense_output=True, events=watched)
    other = simulate(*plan, None, "DOP853", t_eval=grid, dense_output=True, events=watched)
    assert found.status == other.status == 0
    assert found.method.count("then") == 1
    assert found.t.tolist() == grid.tolist()
    for name in watched:
        assert len(found.events[name]) == len(other.events[name]) > 2
        np.testing.assert_allclose(found.events[name].t, other.events[name].t, atol=1e-6)
    np.testing.assert_allclose(found.y, other.y, atol=1e-5)
    np.testing.assert_allclose(found.sol(grid), found.y, atol=1e-9)
    steps = simulate(*plan)
    assert len(steps.t) == steps.steps + 1
    assert np.all(np.diff(steps.t) * span[1] > 0)


@needs_compiler
def test_events_of_both_parts_count_towards_the_last(in_c):
    plan = in_c(BUMP), (-0.1, 2.0), (0, 40.0)
    for number in (1, 3, 4):
        event = Event(x, terminal=number, name="middle")
        found, other = (simulate(*plan, None, m, events=event) for m in ("auto", "DOP853"))
        assert (found.status, len(found.events["middle"])) == (2, number)
        assert found.t_stop == pytest.approx(other.t_stop, abs=1e-6)


@needs_compiler
def test_how_good_a_continued_run_is_is_known_by_a_third_method(in_c):
    estimate = simulate(in_c(PULSE), (1.0, 0.0), (0, 8)).accuracy(limit=60)
    assert estimate.second not in {"taylor", "DOP853", ""}


@needs_compiler
def test_at_a_pole_nothing_goes_on_and_the_first_message_stays(in_c):
    pole = System.from_rates("pole", {x: x**2})
    found, other = (simulate(in_c(pole), (1.0,), (0, 3), None, m) for m in ("auto", "taylor"))
    assert (found.status, found.message, found.steps) == (-1, other.message, other.steps)
    assert "DOP853 does not get to the end either" in found.why


@needs_compiler
def test_what_may_be_a_singularity_is_not_passed_in_silence(in_c):
    """x' = sqrt(x) from zero has many solutions; a branch point is no overflow."""
    root = System.from_rates("root", {x: sp.sqrt(x)})
    found = simulate(in_c(root), (0.0,), (0, 3), atol=1e-9)
    assert found.status == 0
    assert "if the rates are singular there" in found.notice


def test_what_is_analytic_is_known_at_each_point():
    compiled = compile_system(
        System.from_rates("s", {x: sp.sqrt(x) + 1 / sp.cosh(x) ** 2}), "numpy"
    )
    series = prepare(compiled.program, "rates", compiled.layout)
    for at, expected in ((0.0, False), (1e-300, True), (1e4, True)):
        assert is_analytic(series, 16, Point(0.0, [at])) == expected


@needs_compiler
@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
def test_the_bound_of_stiffness_is_that_of_the_jacobian_by_differences(problem, monkeypatch):
    """In one call or by NumPy, to rounding: and so whether it is looked at closely."""
    compiled = compile_system(problem.system, "c")
    layout = compiled.layout
    x, p, u = (np.array([float(of[q.name]) for q in qs]) for of, qs in
               ((problem.start, layout.states), (problem.parameters, layout.parameters),
                (problem.inputs, layout.inputs)))  # fmt: skip
    asked = Problem(x, (0.0, problem.end), p, u, 1e-9, np.full(len(x), 1e-12), 1e-6, 0)
    changes, slopes = choice._differences(compiled, asked, 0.0, x, lambda t, x: u)
    bound = float((np.abs(slopes).T @ (1.0 / changes)).max())
    found = choice._steepest(compiled, asked, lambda t, x: u)
    assert native.python_headers() is None or found == pytest.approx(bound, rel=1e-12)
    known = [choice.promising(compiled, asked, lambda t, x: u, 5 * 10**k) for k in range(7)]
    monkeypatch.setattr(native, "_extension", lambda: None)
    assert [choice.promising(compiled, asked, lambda t, x: u, 5 * 10**k) for k in range(7)] == known
