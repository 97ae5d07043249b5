"""Default absolute tolerances: each state by its own size, in every method, in any unit."""

import math

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from codegen import compile as compile_system
from codegen import simulate
from codegen.integrate import scales, sundials
from codegen.native import native
from codegen.runs import prepared
from eom.problems import PROBLEMS
from eom.quantities import TIME, Quantity
from eom.system import System

pytestmark = pytest.mark.sparse

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="compares methods in C")
X, V, Y, Z = sp.symbols("x v y z", real=True)
A, B = sp.symbols("a b", positive=True)


def scales_of(rates, units, start, span=(0.0, 10.0)):
    column = np.array(start, dtype=float)[:, None]
    return scales.scales(lambda t, x: np.array(rates(t, x)) + 0 * x, units, column, span)


def start_at(states):
    """Where a run starts, in one column, without parameters."""
    none = np.zeros(0)
    return scales.Point(np.array(states, dtype=float)[:, None], none, none, 0.0)


# --- the scale of one state ------------------------------------------------------------------------


def test_a_state_that_starts_somewhere_has_its_first_size_and_costs_no_call():
    def never(t, x):
        raise AssertionError

    found = scales.scales(never, ["", ""], np.array([[-1e-12], [3.0]]), (0.0, 1.0))
    np.testing.assert_array_equal(found.values[:, 0], [1e-12, 3.0])
    np.testing.assert_allclose(found.tolerances(1e-9)[:, 0], [1e-24, 3e-12], rtol=1e-15)


@pytest.mark.parametrize("frequency", [1e-6, 1.0, 1e6])
def test_a_pendulum_let_go_has_the_speed_of_its_fall(frequency):
    """Up to a factor of ten: the time scale is found, whatever the span; the fastest speed is 0.96 w."""
    found = scales_of(
        lambda t, x: [x[1], -(frequency**2) * np.sin(x[0])],
        ["rad", "rad/s"],
        [1.0, 0.0],
        (0.0, 100 / frequency),
    )
    assert 0.1 < found.values[1, 0] / (0.96 * frequency) < 10


@pytest.mark.parametrize("span", [1e-3, 1.0, 1e6])
def test_an_oscillator_that_is_driven_from_rest_is_not_measured_by_the_span(span):
    found = scales_of(lambda t, x: [x[1], 1.0 - x[0]], ["m", "m/s"], [0.0, 0.0], (0.0, span))
    assert np.all(found.grows)
    assert np.all(found.values <= 1.0)
    assert found.values[1, 0] >= 0.1 * min(1.0, span)
    assert found.values[0, 0] >= 0.01 * min(1.0, span) ** 2


def test_a_fast_state_of_a_stiff_problem_has_the_size_that_it_comes_to_rest_at():
    """Robertson's problem: y2 goes to 3.65e-5 within a millisecond."""

    def rates(t, y):
        first, second = 0.04 * y[0] - 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
        return [-first, first - second, second]

    found = scales_of(rates, ["", "", ""], [1.0, 0.0, 0.0], (0.0, 1e5))
    assert 0.1 < found.values[1, 0] / 3.65e-5 < 10
    assert np.all(found.grows)


def test_a_small_state_that_starts_at_zero_is_not_held_to_the_large_one_of_its_unit():
    found = scales_of(lambda t, x: [-x[0], 1e-12 * x[0]], ["m", "m"], [1.0, 0.0])
    assert 1e-13 < found.values[1, 0] < 1e-11


def test_a_chain_from_zero_grows_link_by_link():
    """v, then x, then the integral of x: each has a scale though all start at zero, with no rate yet."""
    found = scales_of(lambda t, x: [x[1], x[2], 1 + 0 * x[0]], ["", "m", "m/s"], [0, 0, 0])
    assert np.all(found.grows)
    assert np.all(np.isfinite(found.values))


def test_what_rounding_leaves_of_zero_is_no_growth():
    """sin^2 + cos^2 - 1 is 0 or 1e-16; the scale is that of the others of its unit, to rounding."""

    def rates(t, x):
        return [-x[0], np.sin(x[0]) ** 2 + np.cos(x[0]) ** 2 - 1]

    places = [x for x in np.linspace(0.1, 1.5, 60) if rates(0, [x])[1] != 0]
    assert len(places) > 5
    for x in places:
        found = scales_of(rates, ["m", "m"], [x, 0.0])
        assert not found.grows[1, 0]
        assert found.values[1, 0] == x
        assert found.tolerances(1e-9)[1, 0] == pytest.approx(2.0**-48 * x)
        assert found.tolerances(1e-14)[1, 0] == pytest.approx(1e-17 * x)


def test_a_first_value_that_rounding_left_counts_as_zero():
    """cos(pi/2) = 6e-17 beside 1, in a state that a rate of 1/2 moves, and in one that nothing moves."""
    residue = math.cos(math.pi / 2)
    moved = scales_of(lambda t, x: [0 * x[0], 0.5 * x[0]], ["1", "1"], [1.0, residue])
    assert moved.values[1, 0] > 0.1
    still = scales_of(lambda t, x: [-x[0], 0 * x[0]], ["1", "1"], [1.0, residue])
    assert still.values[1, 0] == 1.0


def test_rates_that_fail_give_no_growth_and_no_warning():
    found = scales_of(lambda t, x: [np.log(x[1]), np.sqrt(-1 - x[0])], ["m", "m"], [1.0, 0.0])
    assert found.values[1, 0] == 1.0
    assert np.isnan(scales_of(lambda t, x: [np.nan + x[0]], ["m"], [0.0]).values[0, 0])


def test_no_column_depends_on_another():
    def rates(t, x):
        return np.array([x[1], -np.sin(x[0]) + 1e-9 * np.cos(t)])

    start = np.array([[1.0, 0.0, 1e-9, 1e6], [0.0, 0.0, 0.0, 1e-300]])
    units, span = ["rad", "rad/s"], (0.0, 20.0)
    together = scales.scales(rates, units, start, span).tolerances(1e-9)
    for j in range(start.shape[1]):
        alone = scales.scales(rates, units, start[:, [j]], span).tolerances(1e-9)
        np.testing.assert_array_equal(together[:, [j]], alone)
    assert np.all(together >= 1e-150)


# --- runs -----------------------------------------------------------------------------------------

METHODS = ["DOP853", "DP5", "Tsit5", "taylor", "scipy:RK45", "scipy:DOP853", "scipy:LSODA",
           "scipy:BDF", "scipy:Radau", "sundials:Adams", "sundials:BDF"]  # fmt: skip
BESIDE = {X: V, V: -X}
"""An oscillator of size one, of which small states beside it know nothing but the time."""
SMALL = {
    "grows": ({**BESIDE, Y: 4 * Y}, (1, 0, 1e-30), lambda t: 1e-30 * np.exp(4 * t)),
    "decays": ({**BESIDE, Y: -4 * Y}, (1, 0, 1e-12), lambda t: 1e-12 * np.exp(-4 * t)),
    "swings": ({**BESIDE, Y: Z, Z: -25 * Y}, (1, 0, 1e-12, 0), lambda t: 1e-12 * np.cos(5 * t)),
    "is driven from zero": (
        {**BESIDE, Y: Z, Z: -25 * Y + sp.Float("24e-12") * X},
        (1, 0, 0, 0),
        lambda t: 1e-12 * (np.cos(t) - np.cos(5 * t)),
    ),
}


@pytest.fixture(scope="module")
def small():
    return {n: compile_system(System.from_rates("small", rates), "c")
            for n, (rates, _, _) in SMALL.items()}  # fmt: skip


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("case", SMALL)
def test_a_small_state_beside_a_large_one_keeps_its_digits(small, case, method):
    """Every state from 1e-12 down is held to 1000 rtol of the largest it becomes; unaware, to nothing."""
    if method.startswith("sundials") and not sundials.available():
        pytest.skip("no scikit-sundae")
    _, start, exact = SMALL[case]
    rtol, t = 1e-6, np.linspace(0, 6, 61)
    run = simulate(small[case], start, (0, 6), None, method, rtol, t_eval=t)
    assert run.status == 0
    assert not run.notice
    expected = exact(t)
    assert np.abs(run["y"] - expected).max() < 1000 * rtol * np.abs(expected).max()


@pytest.fixture(scope="module")
def in_units():
    """A pendulum and x v, the integral of which starts at zero; ``a``, ``b``: units of x and v."""
    rates = {X: V * A / B, V: -B * sp.sin(X / A), Y: X * V / B}
    return compile_system(System.from_rates("pendulum", rates), "c")


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("method", ["taylor", "DOP853", "DP5", "scipy:BDF"])
def test_steps_do_not_depend_on_the_unit_of_a_state(in_units, method):
    """The same motion in units a factor of 1e15 apart, each state in its own."""
    counts = []
    for a, b in ((1.0, 1.0), (1e-15, 1e3), (1e12, 1e-6)):
        run = simulate(in_units, (a, 0.0, 0.0), (0, 20), (a, b), method, 1e-8)
        assert run.status == 0
        counts.append(run.steps + run.rejected)
    assert max(counts) < 1.1 * min(counts), counts


@pytest.mark.sparse(2)
@needs_compiler
@pytest.mark.parametrize("method", ["taylor", "DOP853", "DP5", "scipy:LSODA", "scipy:BDF"])
def test_passing_through_zero_forces_no_steps(method):
    """A swing from 1e-9 up to 1 that passes zero 30 times, as many steps as with a tolerance of its own."""
    rates = {X: V, V: -X + X * (1 - X**2 - V**2) / 2 + V * (1 - X**2 - V**2) / 2}
    compiled = compile_system(System.from_rates("limit_cycle", rates), "c")
    own, given = (
        simulate(compiled, (1e-9, 0.0), (0, 120), None, method, 1e-7, atol)
        for atol in (None, 1e-10)
    )
    late = [int(np.sum(run.t > 60)) for run in (own, given)]
    assert late[0] < 1.15 * late[1], late


@needs_compiler
def test_a_given_tolerance_is_taken_as_it_is(small, monkeypatch):
    seen = []
    whole = prepared._Ready.run

    def noted(ready, given, atol, progress):
        seen.append(atol[0])
        return whole(ready, given, atol, progress)

    monkeypatch.setattr(prepared._Ready, "run", noted)
    for atol in (1e-5, [1e-5, 1e-300, 7.0]):
        simulate(small["grows"], (0, 0, 0), (0, 1), atol=atol, method="DOP853")
    np.testing.assert_array_equal(seen, [[1e-5] * 3, [1e-5, 1e-300, 7.0]])


@needs_compiler
def test_each_trajectory_of_an_ensemble_has_its_own_scales():
    """Amplitudes from 1e-20 to 1e20 side by side, in lanes and one after the other, in any division."""
    rates = {X: V, V: -X}
    compiled = compile_system(System.from_rates("oscillator", rates), "c")
    size, t = np.logspace(-20, 20, 300), [1.0, 7.0]
    exact = np.cos(t)[:, None] * size
    for method in ("taylor", "DOP853"):
        found = codegen.ensemble(
            compiled, {"x": size, "v": 0.0}, (0, 7), None, method, 1e-8, t_eval=t
        )
        assert np.abs(found["x"] / exact - 1).max() < 1e-6
        part = codegen.ensemble(
            compiled, {"x": size[:40], "v": 0.0}, (0, 7), None, method, 1e-8, t_eval=t
        )
        np.testing.assert_array_equal(part["x"], found["x"][:, :40])


# --- what is reported ---------------------------------------------------------------------------------


def test_a_start_without_any_scale_is_reported_where_steps_are_made():
    """A pulse at t = 5 moves what rests at zero; a tolerance that is given says enough."""
    pulse = {X: V, V: -X + sp.exp(-((TIME - 5) ** 2) * 1000)}
    system = System.from_rates("struck", pulse)
    compiled = compile_system(system, "numpy")
    run = simulate(compiled, (0, 0), (0, 1), method="scipy:RK45", max_step=0.1)
    assert "no scale is known for x, v, which start at zero and at rest" in run.notice
    assert "1.0e-12" in run.notice
    assert not simulate(compiled, (0, 0), (0, 1), method="scipy:RK45", atol=1e-12).notice
    assert not simulate(compiled, (1, 0), (0, 1), method="scipy:RK45").notice


def test_one_state_is_reported_in_the_singular():
    units = [Quantity(X, "m", "place"), Quantity(Y, "kg", "mass")]
    assert [q.name for q in units] == ["x", "y"]
    system = System.from_rates("rest", {X: -X, Y: Y})
    layout = codegen.frontend.layout.Layout.of(system)
    layout = codegen.frontend.layout.replace(layout, states=tuple(units))
    _, reported = scales.defaults(
        lambda t, x: np.array([-x[0], x[1]]), layout, start_at([1.0, 0.0]), (0.0, 1.0), 1e-6
    )
    assert reported.startswith(
        "no scale is known for y, which starts at zero and at rest: its absolute"
    )


@pytest.mark.sparse(3)
@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
def test_ordinary_problems_report_nothing(problem):
    compiled = compile_system(problem.system, "numpy")
    start = [problem.start[n] for n in compiled.system.state_names]
    run = simulate(compiled, start, (0, problem.end), problem.parameters, "scipy:RK23", 1e-2,
                   inputs=problem.inputs, max_steps=3)  # fmt: skip
    assert run.steps == 3
    assert not run.notice


def test_ready_scenes_start_with_scales():
    for name in ("heavy-top", "double-pendulum", "pendulum-on-cart", "seven-joint-arm"):
        scene = eom.load_scene(name)
        compiled = compile_system(scene.derive(), "numpy")
        layout = compiled.layout
        values = {**scene.parameter_values(), **scene.input_values(), **scene.initial_values()}
        p, u, x = (
            np.array([float(values[q.name]) for q in group])
            for group in (layout.parameters, layout.inputs, layout.states)
        )

        def rates(t, y, p=p, u=u, compiled=compiled):
            return compiled.rhs(t, y, p, u)

        found, reported = scales.defaults(rates, layout, start_at(x), (0.0, 10.0), 1e-9)
        assert not reported, name
        assert np.all(found > 0)


@needs_compiler
@pytest.mark.parametrize("problem", [p for p in PROBLEMS if not p.stiff], ids=lambda p: p.name)
def test_the_form_in_c_gives_the_same_to_the_last_bit(problem, monkeypatch):
    """Starts of all sizes, zeros and what rounding leaves of zero among them; spans of both directions."""
    compiled = compile_system(problem.system, "c")
    layout, draw = compiled.layout, np.random.default_rng(0)
    p = np.array([float(problem.parameters[q.name]) for q in layout.parameters])
    u = np.array([float(problem.inputs[q.name]) for q in layout.inputs])
    own = np.array([float(problem.start[q.name]) for q in layout.states])
    starts = [own, np.zeros_like(own)]
    for _ in range(60):
        size = draw.choice([0.0, 1.0, 1e-17, 1e-9, 1e200, -3.0], len(own))
        starts.append(size * np.where(draw.random(len(own)) < 0.5, own, draw.normal(size=len(own))))
    quick = 0
    for k, start in enumerate(starts):
        span = [(0.0, 20.0), (3.0, -1e5), (1e3, 1e3 + 1e-7)][k % 3]
        point = scales.Point(start, p, u, 0.25 * (k % 2))
        found = scales.of_run(compiled, point, span, 1e-9, None)
        of_many = scales.quickly(compiled, span, 1e-9, point.epoch)
        quick += of_many is not None and of_many(start, p, u) is not None
        with monkeypatch.context() as without:
            without.setattr(native, "_extension", lambda: None)
            plain = scales.of_run(compiled, point, span, 1e-9, None)
        assert found[0].tobytes() == plain[0].tobytes()
        assert found[1] == plain[1]
    assert native.python_headers() is None or quick == len(starts)
