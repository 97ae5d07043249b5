"""How good a run is: errors that are known, runs that are wrong, horizons, growth, what cannot be said."""

import copy
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen.compiling.compiled import compile as compile_system
from codegen.integrate import methods
from codegen.integrate.methods import METHODS
from codegen.native import native
from codegen.runs import simulation
from codegen.runs.run_accuracy import LOST, growth
from codegen.runs.second_run import CANDIDATES, FAMILIES
from eom.errors import InputError
from eom.mechanics.rigidbody import free_rigid_body
from eom.quantities import TIME
from eom.system import System

pytestmark = pytest.mark.skipif(not native.compiler(), reason="methods in C")
x, y, v, w, z = sp.symbols("x y v w z", real=True)
BODY = ({"omega_1": 0.3, "omega_2": 1.0, "omega_3": 0.8}, {"I1": 1.0, "I2": 2.0, "I3": 3.0})


def system(**rates):
    return System.from_rates(
        "some", {sp.Symbol(n, real=True): sp.sympify(r) for n, r in rates.items()}
    )


@pytest.fixture(scope="module")
def oscillator():
    return compile_system(system(x=v, v=-4 * x))


@pytest.fixture(scope="module")
def lorenz():
    return compile_system(
        system(x=10 * (y - x), y=x * (28 - z) - y, z=x * y - sp.Rational(8, 3) * z)
    )


def off(estimate, true):
    return max(estimate / true, true / estimate)


# --- errors that are known --------------------------------------------------------------------------


@pytest.mark.sparse(1)
@pytest.mark.parametrize("method", ["DP5", "DOP853", "taylor", "scipy:LSODA", "scipy:RK23"])
@pytest.mark.parametrize("end", [20.0, -20.0])
def test_the_estimate_is_the_error(oscillator, method, end):
    run = codegen.simulate(oscillator, [1, 0], (0, end), method=method, rtol=1e-6)
    found = run.accuracy()
    true = abs(run.y[:, -1] - np.array([np.cos(2 * end), -2 * np.sin(2 * end)]))
    assert off(max(found.at_end.values()), true.max()) < 2
    assert found.known
    assert found.horizon is None
    assert FAMILIES.get(found.second, found.second) != FAMILIES.get(method, method)
    assert found.warning == ""
    assert str(found).startswith("good to about ")


@pytest.mark.parametrize("stored", [[20.0], [0.0, 10.0], np.linspace(0, 20, 300)])
def test_what_is_stored_does_not_change_the_end(oscillator, stored):
    every = codegen.simulate(oscillator, [1, 0], (0, 20), method="DP5", rtol=1e-6)
    few = codegen.simulate(oscillator, [1, 0], (0, 20), method="DP5", rtol=1e-6, t_eval=stored)
    one, other = every.accuracy(), few.accuracy()
    assert other.t[-1] == 20.0
    assert len(other.t) >= 65
    assert other.at_end == pytest.approx(one.at_end, rel=1e-3)
    assert other.relative.max() == pytest.approx(one.relative.max(), rel=0.5)


def test_a_run_that_sums_rounding_is_not_called_better_than_that():
    """A saddle: a rounding error of the start grows by e^25, whatever two runs may agree on."""
    found = codegen.simulate(
        system(x=v, v=x), [1, 0.5], (0, 25), method="taylor", rtol=2**-52
    ).accuracy()
    assert min(found.at_end.values()) > 2.0**-53 * np.exp(25.0)
    assert found.growth[-1] == pytest.approx(np.exp(25.0), rel=0.5)


def test_a_closed_form_is_good_to_rounding_if_another_method_confirms_it():
    compiled = compile_system(free_rigid_body())
    run = codegen.simulate(compiled, BODY[0], (0, 50), BODY[1])
    assert run.method.startswith("closed form")
    found = run.accuracy()
    assert found.relative[-1] < 2e-15
    assert found.second == "taylor"
    wrong = replace(run, y=run.y + 1e-8, y_stop=run.y_stop + 1e-8)
    assert off(wrong.accuracy().relative[-1], 1e-8) < 2


# --- runs that are wrong ----------------------------------------------------------------------------


def spoilt(monkeypatch, name, change):
    def prepare(task):
        integrator, used = row.prepare(task)
        return (lambda problem: change(integrator(problem))), used

    row = next(r for r in methods.ROWS if r.name == name)
    rows = [replace(r, prepare=prepare) if r.name == name else r for r in methods.ROWS]
    monkeypatch.setattr(methods, "ROWS", tuple(rows))
    monkeypatch.setattr(simulation, "_kept", {})  # integrators, also those that were not changed
    monkeypatch.setattr(simulation, "KEPT", 0)


@pytest.mark.parametrize("factor", [1e-3, 1e-9])
def test_a_method_that_is_wrong_is_found_out(oscillator, monkeypatch, factor):
    def change(found):
        growing = 1 + factor * np.linspace(0, 1, len(found.t))
        return replace(found, y=found.y * growing, state_at_stop=found.state_at_stop * (1 + factor))

    spoilt(monkeypatch, "taylor", change)
    run = codegen.simulate(oscillator, [1, 0], (0, 20), method="taylor", rtol=1e-12)
    assert run.status == 0
    true = factor * max(abs(np.cos(40)), abs(2 * np.sin(40)))
    assert off(max(run.accuracy().at_end.values()), true) < 3


def test_steps_over_a_pulse_are_seen_by_shorter_ones(monkeypatch):
    """The method is blind to a torque; the second run, whose steps are short, meets it."""
    kick = system(x=v, v=20 * sp.exp(-(((TIME - 2) * 10) ** 2)))
    blind = codegen.simulate(kick, [0, 0], (0, 1.5), method="DOP853")
    run = codegen.simulate(kick, [0, 0], (0, 5), method="DOP853")
    missed = replace(run, t=np.array([0.0, 5.0]), y=np.zeros((2, 2)), y_stop=np.zeros(2))
    assert abs(blind.y_stop).max() < 0.1
    found = missed.accuracy()
    assert found.horizon is not None
    assert 1.5 < found.horizon <= 5


@pytest.mark.slow
def test_the_horizon_of_a_chaotic_motion(lorenz):
    run = codegen.simulate(lorenz, [1, 1, 1], (0, 60), rtol=1e-9, t_eval=np.linspace(0, 60, 601))
    assert run.status == 0
    found = run.accuracy()
    assert 20 < found.horizon < 35
    assert found.rate == pytest.approx(0.76, rel=0.05)
    assert found.growth[-1] > 1e18
    assert f"no digit is left after t = {found.horizon:.1f} s" in str(found)
    assert "drift" in found.warning
    kept = run.with_accuracy()
    assert run.notice == ""
    assert kept.notice == kept.with_accuracy().notice == found.warning
    assert kept.accuracy() is kept.with_accuracy().accuracy()
    assert pickle.loads(pickle.dumps(kept)).accuracy().horizon == found.horizon
    k = np.searchsorted(found.t, found.horizon)
    assert found.relative[k - 1] < LOST <= found.relative[k]
    finer = codegen.simulate(lorenz, [1, 1, 1], (0, 60), rtol=1e-12, t_eval=run.t).accuracy()
    assert finer.horizon > found.horizon + 4


def test_a_run_may_be_asked_for_with_its_accuracy(lorenz, oscillator):
    asked = {"rtol": 1e-9, "accuracy": True}
    assert "hardly drift proves" in codegen.simulate(lorenz, [1, 1, 1], (0, 60), **asked).notice
    good = codegen.simulate(oscillator, [1, 0], (0, 1), **asked)
    assert good.notice == ""
    assert good.accuracy() is good.estimate


@pytest.mark.slow
def test_a_spin_about_the_intermediate_axis_over_a_thousand_seconds():
    """The energy drifts by parts in 1e10, the attitude is wrong by a thousand times that and more."""
    body = compile_system(free_rigid_body("quaternion"))
    start = {"omega_1": 1e-3, "omega_2": 10.0, "omega_3": 1e-3, "q0": 1, "q1": 0, "q2": 0, "q3": 0}
    times = np.linspace(0, 1000, 401)
    exact, steps = (
        codegen.simulate(body, start, (0, 1000), BODY[1], m, t_eval=times)
        for m in ("auto", "taylor")
    )
    found = exact.accuracy()
    assert found.horizon is None
    assert found.relative[-1] < 1e-14
    judged = steps.accuracy()
    true = abs(steps.y - exact.y).max(axis=1) / judged.size
    assert steps.drift["T"].relative < 1e-8
    assert true.max() / 10 < judged.relative.max() < 10 * true.max()


def test_small_states_are_reported_by_name_if_they_are_not_rounding():
    """Beside an oscillation of size one: a small one without error control, and one that is zero."""
    rates = {"x": v, "v": -x, "y": w, "w": -(10**6) * y, "z": x - sp.cos(TIME)}
    start = {"x": 1.0, "v": 0.0, "y": 1e-15, "w": 0.0, "z": 0.0}
    run = codegen.simulate(system(**rates), start, (0, 1), method="DOP853", rtol=1e-6, atol=1e-9)
    found = run.accuracy()
    assert set(found.lost) == {"y", "w"} or set(found.lost) == {"y"}
    assert "no digit of y" in str(found)
    assert found.warning.startswith("no digit of y")


# --- where runs stop --------------------------------------------------------------------------------


def test_a_run_that_fails_is_judged_up_to_where_it_failed():
    run = codegen.simulate(system(x=1 + x**2), [0], (0, 2), method="DOP853", rtol=1e-9)
    assert run.status < 0
    found = run.accuracy()
    assert found.t[-1] == pytest.approx(run.t_stop, rel=1e-6)
    assert run.t_stop < 1.6
    near = np.searchsorted(found.t, 1.4)
    assert found.error[0, near] < 1e-6


def test_a_run_that_stops_at_a_singular_configuration_is_compared_before():
    start = {"omega_1": 0.1, "omega_2": 2.0, "omega_3": 0.1, "psi": 0, "theta": 0, "phi": 0}
    compiled = compile_system(free_rigid_body("3-2-1"))
    run = codegen.simulate(compiled, start, (0, 50), BODY[1], method="DOP853", margin=0.05)
    assert run.status == 1
    found = run.accuracy()
    assert found.known
    assert found.t[-1] == run.t_stop
    assert found.relative[-1] < 1e-4


def test_a_run_that_ends_at_an_event_is_compared_up_to_it(oscillator):
    run = codegen.simulate(
        oscillator, [1, 0], (0, 20), method="taylor", events=[codegen.Event(x, terminal=True)]
    )
    assert run.status == 2
    found = run.accuracy()
    assert found.t[-1] == run.t_stop == pytest.approx(np.pi / 4)
    assert found.relative[-1] < 1e-8


def test_a_run_that_made_no_step(oscillator):
    poles = system(x=1 / x)
    run = codegen.simulate(poles, [0.0], (0, 1), method="DOP853")
    assert run.status < 0
    assert str(run.accuracy()) == "the run did not leave its start"


# --- other runs -------------------------------------------------------------------------------------


def test_inputs_that_are_python_functions():
    force = sp.Symbol("force", real=True)
    forced = System.from_rates("forced", {x: v, v: -x + force}, inputs=[force])
    inputs = {"force": lambda t: math.sin(2 * t)}
    run = codegen.simulate(forced, [0, 0], (0, 10), inputs=inputs, rtol=1e-6)
    true = abs(2 * np.sin(10) / 3 - np.sin(20) / 3 - run["x"][-1])
    assert off(run.accuracy().at_end["x"], true) < 3


def test_the_numpy_target(oscillator):
    plain = compile_system(oscillator.system, "numpy")
    run = codegen.simulate(plain, [1, 0], (0, 5), method="DOP853", rtol=1e-6)
    true = abs(run["x"][-1] - np.cos(10))
    found = run.accuracy()
    assert off(found.at_end["x"], true) < 3
    assert found.second == "scipy:LSODA"


def test_stiff_motion():
    run = codegen.simulate(
        system(x=-1000 * (x - sp.cos(TIME))), [1.0], (0, 5), method="scipy:Radau", rtol=1e-6
    )
    found = run.accuracy()
    t = run.t_stop
    exact = (1e6 * np.cos(t) + 1e3 * np.sin(t)) / (1e6 + 1)
    assert off(found.at_end["x"], abs(run.y_stop[0] - exact)) < 3
    assert found.rate < -500


def test_an_implicit_second_run_is_compared_at_ends_of_its_steps(monkeypatch):
    from codegen.runs import second_run

    only = tuple(c for c in CANDIDATES if c.method == "scipy:Radau")
    monkeypatch.setattr(second_run, "CANDIDATES", only)
    stiff = system(x=-1000 * (x - sp.cos(TIME)))
    run = codegen.simulate(stiff, [1.0], (0, 2), method="scipy:BDF", rtol=1e-6)
    found = run.accuracy()
    assert found.second == "scipy:Radau"
    exact = (1e6 * np.cos(2.0) + 1e3 * np.sin(2.0)) / (1e6 + 1)
    assert off(found.at_end["x"], abs(run.y_stop[0] - exact)) < 3


def test_a_second_run_that_takes_too_long_is_reported(lorenz):
    run = codegen.simulate(lorenz, [1, 1, 1], (0, 2000), method="taylor", t_eval=[2000])
    found = run.accuracy(limit=0.0)
    assert not found.known
    assert str(found).startswith("not known: ")
    assert "takes more than" in found.trouble
    assert math.isnan(found.at_end["x"])
    assert found.warning == ""


@pytest.mark.parametrize("method", METHODS)
def test_every_method_has_another_to_be_compared_with(method):
    own = FAMILIES.get(method, method)
    assert [c for c in CANDIDATES if FAMILIES.get(c.method, c.method) != own]


# --- growth -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [12, 5000])
def test_growth_of_a_linear_system_is_that_of_its_exponential(count):
    import scipy.linalg

    A = np.array([[0.0, 1.0, 0.2], [-4.0, 0.3, 0.0], [0.1, 0.0, -1.0]])
    states = sp.symbols("x y z", real=True)
    rates = sp.Matrix(A.tolist()) * sp.Matrix(states)
    compiled = compile_system(
        System.from_rates("linear", dict(zip(states, rates, strict=True))), "numpy"
    )
    t = np.linspace(0, 6, count)
    none = np.empty(0)
    found = growth(compiled, none, lambda _: none, t, np.ones((3, count)), np.ones(3), count)
    expected = np.abs(scipy.linalg.expm(6 * A)).sum(axis=1).max()
    assert np.exp(found.logarithm[-1]) == pytest.approx(expected, rel=0.2 if count == 12 else 1e-6)
    assert found.logarithm[0] == 0
    assert not found.rounding.any()


def test_growth_along_a_motion_is_that_of_its_variational_equations(lorenz):
    extended = codegen.sensitivities(lorenz, [], ["x", "y", "z"])
    start = extended.initial({"x": 1.0, "y": 1.0, "z": 1.0})
    whole = codegen.simulate(extended.compiled, start, (0, 20), method="DOP853", rtol=1e-12)
    expected = np.abs(extended.matrix(whole.y[:, -1])).sum(axis=1).max()
    for method in ("taylor", "DOP853"):
        found = codegen.simulate(lorenz, [1, 1, 1], (0, 20), method=method).accuracy()
        assert found.growth[-1] == pytest.approx(expected, rel=0.05)
        assert found.rate == pytest.approx(np.log(expected) / 20, rel=0.01)


def test_growth_beyond_the_range_of_doubles():
    compiled = compile_system(system(x=2000 * x, y=-y), "numpy")
    t, none = np.linspace(0, 1, 4001), np.empty(0)
    found = growth(compiled, none, lambda _: none, t, np.ones((2, 4001)), np.ones(2), 1)
    assert found.logarithm[-1] == pytest.approx(2000, rel=1e-3)
    assert np.isfinite(found.logarithm).all()


# --- what a result keeps ----------------------------------------------------------------------------


def test_copies_know_what_they_came_from_and_pickles_do_not(oscillator):
    run = codegen.simulate(oscillator, [1, 0], (0, 1), method="DP5")
    assert copy.copy(run).accuracy().at_end == run.accuracy().at_end
    back = pickle.loads(pickle.dumps(run))
    assert back.t.tolist() == run.t.tolist()
    assert "origin" not in repr(run)
    with pytest.raises(InputError, match="does not know what it came from"):
        back.accuracy()


def test_a_progress_that_cannot_be_pickled_is_not_kept(oscillator):
    run = codegen.simulate(oscillator, [1, 0], (0, 1), progress=lambda part: None)
    assert run.origin.problem.progress is None
