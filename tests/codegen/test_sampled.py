"""Laws that are sampled: against chains of runs by hand, each other, and what must be refused."""

import itertools
import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import codegen
import eom
from codegen.native.trajectory import Law
from eom.errors import InputError
from eom.quantities import TIME
from eom.typeset import printing

X, V, U, K, D, Z = sp.symbols("x v u k d z", real=True)
PENDULUM = eom.System.from_rates("pendulum", {X: V, V: U - sp.sin(X)}, inputs=[U])
OPEN = codegen.compile(PENDULUM)
SLOW = codegen.compile(PENDULUM, "numpy")
GAINS = {"k": 4.0, "d": 3.0}
START = {"x": 1.0, "v": 0.0}
TIGHT = {"rtol": 1e-12, "atol": 1e-13}
LAW = -K * X - D * V


def called(t, x):
    return -4 * x["x"] - 3 * x["v"]


def chain(end, period, delay=0.0, law=None, method="DOP853"):
    """The state at the end by single runs with held inputs, one between any two changes."""
    law = law or (lambda t, x, u: -4 * x[0] - 3 * x[1])
    count = math.ceil(end / period) + 1
    samples = [k * period for k in range(count)]
    due = {Law.of(period, delay, [0]).effect(0.0, k): k for k in range(count)}
    times = [*sorted({t for t in (*samples, *due) if t < end}), end]
    x, u, values = np.array([1.0, 0.0]), 0.0, {}
    for one, other in itertools.pairwise(times):
        if one in samples:
            values[samples.index(one)] = law(one, x, u)
        if one in due:
            u = values[due[one]]
        run = codegen.simulate(OPEN, x, (one, other), method=method, inputs={"u": u}, **TIGHT)
        x = run.y[:, -1]
    return x


METHODS = [m for m in codegen.METHODS if m not in {"rkmk", "splitting"}]


@pytest.mark.parametrize("method", METHODS)
def test_every_method_ends_its_steps_at_the_samples(method):
    if "sundials" in method:
        pytest.importorskip("sksundae")
    period, delay = 0.13, 0.05  # the period does not divide the span
    expected = chain(1.0, period, delay)
    for law, gains in ((LAW, GAINS), (called, {})):
        inputs = {"u": codegen.Sampled(law, period, delay)}
        run = codegen.simulate(OPEN, START, (0, 1), gains, method, inputs=inputs, **TIGHT)
        assert run.success, run.message
        assert run.y[:, -1] == pytest.approx(expected, rel=1e-9, abs=1e-9)
        if "LSODA" not in method and "BDF" not in method and "Adams" not in method:
            assert run.y[:, -1] == pytest.approx(expected, rel=3e-12, abs=3e-12)
        for k in range(8):
            assert k * period in run.t
            assert k * period + delay in run.t or k * period + delay > 1


@pytest.mark.parametrize("late", [0.0, 1e-7])
def test_series_that_end_by_chance_where_inputs_change_are_not_believed(late):
    """y' = u ((t - 1)^12 + (t - 1)^16): about t = 1 series of order 12 vanish, or nearly."""
    y = sp.Symbol("y", real=True)
    rates = {y: U * ((TIME - 1) ** 12 + (TIME - 1) ** 16), X: V, V: -X / 16}
    system = eom.System.from_rates("flat", rates, inputs=[U])
    law = sp.Piecewise((0, TIME < 1), (1, True))
    inputs = {"u": codegen.Sampled(law, 1 + late)}
    run = codegen.simulate(
        system, {"y": 0.0, "x": 0.01, "v": 0.0}, (0, 2.2), method="taylor", inputs=inputs, rtol=1e-6
    )
    whole = sum((1.2**n - late**n) / n for n in (13, 17))
    assert run.y[0, -1] == pytest.approx(whole, rel=1e-6)


@given(
    st.floats(0.02, 3.0), st.floats(0.0, 4.0), st.sampled_from(["taylor", "DOP853"]), st.booleans()
)
def test_a_run_is_the_chain_of_runs_by_hand(period, delay, method, symbolic):
    law = codegen.Sampled(LAW if symbolic else called, period, delay)
    gains = GAINS if symbolic else {}
    run = codegen.simulate(OPEN, START, (0, 2), gains, method, inputs={"u": law}, **TIGHT)
    assert run.y[:, -1] == pytest.approx(chain(2.0, period, delay, method=method), abs=2e-12)


def test_one_step_between_samples_is_that_of_the_chain_to_the_last_bit():
    law = {"u": codegen.Sampled(LAW, 0.03125)}
    run = codegen.simulate(OPEN, START, (0, 1), GAINS, "taylor", rtol=1e-6, inputs=law)
    assert run.steps == 32
    x = np.array([1.0, 0.0])
    for k in range(32):
        held = {"u": -4 * x[0] - 3 * x[1]}
        one = (k * 0.03125, (k + 1) * 0.03125)
        x = codegen.simulate(OPEN, x, one, method="taylor", rtol=1e-6, inputs=held).y[:, -1]
    assert run.y[:, -1] == pytest.approx(x, rel=4e-16, abs=4e-16)


@pytest.mark.parametrize("period", [0.1, 0.3, 1 / 3, 0.7])
@pytest.mark.parametrize("periods", [1, 2, 7])
def test_a_delay_of_whole_periods_ends_at_samples(period, periods):
    law = Law.of(period, periods * period, [0])
    assert (law.whole, law.rest) == (periods, 0.0)
    inputs = {"u": codegen.Sampled(called, period, periods * period)}
    run = codegen.simulate(OPEN, START, (0, 3), {}, "taylor", inputs=inputs, **TIGHT)
    assert np.diff(run.t).min() > 1e-3  # no step between two roundings of one time
    assert run.y[:, -1] == pytest.approx(chain(3.0, period, periods * period), abs=1e-11)


def test_what_is_held_is_shown_from_the_sample_on():
    law = {"u": codegen.Sampled(LAW, 0.5)}
    for dense in (False, True):
        run = codegen.simulate(OPEN, START, (0, 2), GAINS, inputs=law, dense_output=dense,
                               t_eval=[0, 0.25, 0.5, 0.75, 1.0, 2.0])  # fmt: skip
        u = -4 * run["x"] - 3 * run["v"]
        assert run["u"] == pytest.approx([u[0], u[0], u[2], u[2], u[4], run["u"][5]], abs=1e-8)
    steps = codegen.simulate(OPEN, START, (0, 2), GAINS, inputs=law)
    assert steps["u"][-1] == pytest.approx(
        (-4 * steps["x"] - 3 * steps["v"])[steps.t == 1.5][0], abs=1e-12
    )


# -- states, memory, several laws --------------------------------------------------------------------

INTEGRAL = PENDULUM.with_control({"u": LAW - Z}, {"z": Z + X / 10}, period=0.1)


def integrating():
    z = 0.0

    def law(t, x, u):
        nonlocal z
        now = -4 * x[0] - 3 * x[1] - z
        z += x[0] / 10
        return now

    return law


@pytest.mark.parametrize("target", ["c", "numpy", "python"])
def test_states_of_a_law_step_at_samples(target):
    run = codegen.simulate(codegen.compile(INTEGRAL, target), START, (0, 2), GAINS, **TIGHT)
    assert run.y[:, -1] == pytest.approx(chain(2.0, 0.1, law=integrating()), abs=1e-11)
    assert run["z"][-1] == pytest.approx(sum(run["x"][np.isin(run.t, np.arange(20) * 0.1)]) / 10)


def test_a_memory_is_a_state_of_a_law_in_python_and_every_run_has_its_own():
    def law(t, x, z):
        return -4 * x["x"] - 3 * x["v"] - z[0], [z[0] + x["x"] / 10]

    start = [0.0]
    inputs = {"u": codegen.Sampled(law, 0.1, memory=start)}
    expected = codegen.simulate(INTEGRAL, START, (0, 2), GAINS, **TIGHT).y[:, -1]
    for method in ("taylor", "scipy:DOP853", "taylor"):
        run = codegen.simulate(OPEN, START, (0, 2), {}, method, inputs=inputs, **TIGHT)
        assert run.y[:, -1] == pytest.approx(expected, abs=1e-11)
    assert start == [0.0]
    assert run.accuracy().relative[-1] < 1e-9


def test_states_start_where_the_user_says():
    a = codegen.simulate(INTEGRAL, {**START, "z": 0.5}, (0, 1), GAINS)
    b = codegen.simulate(INTEGRAL, START, (0, 1), GAINS, inputs={"z": 0.5})
    c = codegen.simulate(INTEGRAL, START, (0, 1), GAINS)
    assert a.y[:, -1] == pytest.approx(b.y[:, -1], abs=0)
    assert a["z"][0] == pytest.approx(0.6)
    assert abs(a["x"][-1] - c["x"][-1]) > 1e-3


def test_an_input_may_be_read_by_its_own_law():
    """A limit of the rate: no loop, since what is read is what was held before."""
    slow = PENDULUM.with_control({"u": U + eom.saturate(-10 * X - U, -0.05, 0.05)}, period=0.1)
    run = codegen.simulate(slow, START, (0, 1), inputs={"u": 0.2}, **TIGHT)
    at = run["u"][np.isin(run.t, np.arange(10) * 0.1)]
    assert at == pytest.approx(0.2 - 0.05 * np.arange(1, 11), abs=1e-14)


def test_two_laws_have_two_periods_and_see_what_was_before():
    a, b = sp.symbols("a b", real=True)
    two = eom.System.from_rates("two", {X: a, V: b}, inputs=[a, b])
    closed = two.with_control({"a": 1 + b}, period=0.2).with_control({"b": 10 * a}, period=0.3)
    expected_a, expected_b, u = {}, {}, [0.0, 0.0]
    for k in range(13):
        before = list(u)
        u[0] = 1 + before[1] if k % 2 == 0 else u[0]
        u[1] = 10 * before[0] if k % 3 == 0 else u[1]
        expected_a[k], expected_b[k] = u
    for method in ("taylor", "DOP853", "scipy:RK45"):
        run = codegen.simulate(
            closed, [0, 0], (0, 1.25), method=method, t_eval=np.arange(13) * 0.1 + 0.01
        )
        assert run["a"] == pytest.approx(list(expected_a.values()))
        assert run["b"] == pytest.approx(list(expected_b.values()))


def test_a_sampled_function_beside_a_continuous_one_and_one_for_all():
    a, b = sp.symbols("a b", real=True)
    two = eom.System.from_rates("two", {X: a, V: b - V}, inputs=[a, b])
    mixed = {"a": codegen.Sampled(lambda t, x: -x["x"], 0.1), "b": lambda t, x: math.sin(t)}
    one = codegen.simulate(two, [1, 0], (0, 1), inputs=mixed, **TIGHT)
    assert one["x"][-1] == pytest.approx(0.9**10, abs=1e-12)
    assert one["v"][-1] == pytest.approx((math.sin(1) - math.cos(1) + math.exp(-1)) / 2, abs=1e-10)
    assert one["a"][:-1][np.isin(one.t[:-1], np.arange(10) * 0.1)] == pytest.approx(
        -(0.9 ** np.arange(10))
    )
    for both in (lambda t, x: (-x["x"], 0.0), lambda t: {"b": 0.0, "a": -1.0}):
        run = codegen.simulate(two, [1, 0], (0, 0.1), inputs=codegen.Sampled(both, 0.1))
        assert run["x"][-1] == pytest.approx(0.9)
    by_name = codegen.Sampled({"a": -X, "b": -K * V}, 0.1)
    run = codegen.simulate(two, [1, 1], (0, 1), {"k": 0.0}, inputs=by_name, **TIGHT)
    assert run.y[:, -1] == pytest.approx([0.9**10, math.exp(-1)])


def test_a_delay_beyond_the_end_has_no_effect_and_takes_no_room():
    law = {"u": codegen.Sampled(called, 1e-3, 1e9)}
    run = codegen.simulate(OPEN, START, (0, 1), inputs=law, **TIGHT)
    free = codegen.simulate(OPEN, START, (0, 1), inputs={"u": 0.0}, **TIGHT)
    assert np.all(run["u"] == 0)
    assert run.y[:, -1] == pytest.approx(free.y[:, -1], abs=1e-11)


# -- events, late starts, attitudes ----------------------------------------------------------------


@pytest.mark.parametrize("method", ["taylor", "DOP853", "DP5"])
def test_events_see_inputs_that_jump(method):
    law = codegen.Sampled(LAW, 0.25)
    events = {"down": eom_event(U + 1, 0), "zero": codegen.Event(X), "stop": eom_event(V + 0.2, 1)}
    run = codegen.simulate(OPEN, START, (0, 3), GAINS, method, inputs={"u": law}, events=events)
    free = codegen.simulate(OPEN, START, (0, 3), GAINS, method, inputs={"u": law}, dense_output=True,
                            **TIGHT)  # fmt: skip
    at = np.arange(12) * 0.25
    u = free["u"][np.isin(free.t, at)]
    jumps = at[1:][(u[1:] + 1) * (u[:-1] + 1) < 0]
    assert run.events["down"].t == pytest.approx(jumps[jumps <= run.t_stop])
    assert len(run.events["down"]) > 0
    assert (run.events["down"].direction == np.sign(np.diff(u)[(u[1:] + 1) * (u[:-1] + 1) < 0])[
        : len(run.events["down"])]).all()  # fmt: skip
    assert free.sol(run.t_stop)[1] == pytest.approx(-0.2, abs=1e-8)


def eom_event(expression, terminal):
    return codegen.Event(expression, terminal=bool(terminal), direction=terminal)


def test_a_jump_over_zero_may_end_the_run():
    law = codegen.Sampled(LAW, 0.25)
    end = codegen.Event(U + 1, terminal=True, name="end")
    run = codegen.simulate(OPEN, START, (0, 3), GAINS, inputs={"u": law}, events=[end])
    assert run.status == 1 + 1
    assert run.t_stop in np.arange(12) * 0.25
    assert run.t[-1] == run.t_stop


def test_samples_of_a_run_that_starts_late_keep_their_times():
    law = PENDULUM.with_control({"u": sp.sin(PENDULUM.time) - X}, period=0.1)
    seen = []

    def same(t, x):
        seen.append(t)
        return math.sin(t) - x["x"]

    near = codegen.simulate(law, START, (1000, 1001), **TIGHT)
    python = codegen.simulate(OPEN, START, (1000, 1001), inputs={"u": codegen.Sampled(same, 0.1)},
                              **TIGHT)  # fmt: skip
    moved = codegen.simulate(law, START, (0, 1), epoch=1000, **TIGHT)
    assert seen[:10] == pytest.approx(1000 + np.arange(10) * 0.1)
    assert near.y[:, -1] == pytest.approx(python.y[:, -1], abs=1e-12)
    assert near.y[:, -1] == pytest.approx(moved.y[:, -1], abs=1e-12)


def satellite():
    torque = {"components": ["u_1", "u_2", "u_3"]}
    scene = eom.Scene(
        attitude="quaternion", body={"moments": [12, 14, 8]}, torque=torque,
        inputs=dict.fromkeys(("u_1", "u_2", "u_3"), 0.0),
        initial={"omega_1": 0.1, "omega_2": -0.1, "omega_3": 0.0},
        initial_attitude={"sequence": "3-2-1", "degrees": [0, 20, 50]},
    )  # fmt: skip
    return scene.derive(), scene


@pytest.mark.parametrize("method", ["rkmk", "splitting"])
@pytest.mark.parametrize("delay", [0.0, 0.7])
def test_methods_on_the_group_are_exact_at_samples_and_between(method, delay):
    system, scene = satellite()
    w, q = (
        [sp.Symbol(f"{n}{k}") for k in range(first, 4)] for n, first in (("omega_", 1), ("q", 0))
    )
    law = {f"u_{k}": -q[0] * q[k] - 5 * w[k - 1] for k in (1, 2, 3)}
    closed = codegen.compile(system.with_control(law, period=0.5, delay=delay))
    plan = closed, scene.initial_values(), (0, 10), scene.parameter_values()
    grid = np.linspace(0, 10, 23)
    exact = codegen.simulate(*plan, "taylor", 1e-13, t_eval=grid)
    for dense in (False, True):
        run = codegen.simulate(*plan, method, 1e-11, t_eval=grid, dense_output=dense)
        assert run.success, run.message
        assert np.abs(run.y - exact.y).max() < 1e-9
    assert np.abs(run.sol(grid) - exact.y).max() < 1e-9


def test_the_invariants_that_any_input_keeps_stay():
    system, scene = satellite()
    closed = system.with_control({"u_1": -sp.Symbol("omega_1")}, period=0.5)
    assert "q_norm" in closed.invariant_names
    inputs = {"u_2": 0.01, "u_3": 0.0}
    run = codegen.simulate(closed, scene.initial_values(), (0, 5), scene.parameter_values(),
                           inputs=inputs, project=True)  # fmt: skip
    assert run.drift["q_norm"].relative < 1e-14


@pytest.mark.parametrize("target", ["c", "numpy"])
def test_a_run_that_becomes_stiff_is_made_anew_by_an_implicit_method(target):
    """Van der Pol's oscillator: stiff only after a while, with an input that is held."""
    mu = 3000
    system = eom.System.from_rates("oscillator", {X: V, V: mu * (1 - X**2) * V - X + U}, inputs=[U])
    system = codegen.compile(system.with_control({"u": -X / 100}, period=400.0), target)
    auto = codegen.simulate(system, [2, 0], (0, 2000), rtol=1e-6)
    radau = codegen.simulate(system, [2, 0], (0, 2000), method="scipy:Radau", rtol=1e-8)
    assert auto.success
    assert "explicit" not in auto.method
    assert auto.steps < 3000
    assert "stiff" in auto.why
    assert auto.y[:, -1] == pytest.approx(radau.y[:, -1], rel=1e-4)


# -- what is refused ---------------------------------------------------------------------------------


@pytest.mark.parametrize("period", [0, -1, math.nan, math.inf, 1j, "1", None, [1]])
def test_a_period_that_is_none_is_refused(period):
    for make in (
        lambda: codegen.Sampled(LAW, period),
        lambda: PENDULUM.with_control({"u": LAW}, period=period) if period is not None else 1 / 0,
    ):
        with pytest.raises((InputError, ZeroDivisionError)) as caught:
            make()
        assert isinstance(caught.value, InputError) or period is None


@pytest.mark.parametrize("delay", [-0.1, math.nan, math.inf])
def test_a_delay_that_is_none_is_refused(delay):
    with pytest.raises(InputError, match="delay"):
        codegen.Sampled(LAW, 1, delay)
    with pytest.raises(InputError, match="delay"):
        PENDULUM.with_control({"u": LAW}, period=1, delay=delay)


WRONG = {
    "two values": (lambda t, x: (1.0, 2.0), "number"),
    "no value": (lambda t, x: None, "number"),
    "a text": (lambda t, x: "1", "number"),
    "a state that is not there": (lambda t, x: x["w"], "unknown state"),
}


@pytest.mark.parametrize("which", WRONG)
@pytest.mark.parametrize("method", ["DOP853", "taylor", "scipy:RK45"])
def test_what_a_law_returns_is_checked_in_every_loop(which, method):
    law, said = WRONG[which]
    with pytest.raises(InputError, match=said):
        codegen.simulate(
            OPEN, START, (0, 1), method=method, inputs={"u": codegen.Sampled(law, 0.1)}
        )


def test_one_law_of_all_inputs_returns_all():
    a, b = sp.symbols("a b", real=True)
    two = eom.System.from_rates("two", {X: a, V: b}, inputs=[a, b])
    for wrong in (lambda t: 1.0, lambda t: (1, 2, 3), lambda t: {"c": 1.0}):
        with pytest.raises(InputError, match=r"a value for each input|unknown input"):
            codegen.simulate(two, [0, 0], (0, 1), inputs=codegen.Sampled(wrong, 0.1))


def test_an_exception_of_a_law_arrives_as_it_is():
    def law(t, x):
        if t > 0.25:
            raise ZeroDivisionError("of the law")
        return 0.0

    for method in ("DOP853", "scipy:Radau"):
        with pytest.raises(ZeroDivisionError, match="of the law"):
            codegen.simulate(OPEN, START, (0, 1), method=method,
                             inputs={"u": codegen.Sampled(law, 0.1)})  # fmt: skip


def test_a_value_that_is_not_finite_ends_the_run_there():
    law = codegen.Sampled(lambda t, x: math.nan if t > 0.25 else 0.0, 0.1)
    for method in ("DOP853", "taylor", "scipy:RK45"):
        run = codegen.simulate(OPEN, START, (0, 1), method=method, inputs={"u": law})
        assert run.status == -1
        assert run.t_stop == pytest.approx(0.3)
        assert "not finite" in run.message


REFUSED = {
    "backwards": ({"u": codegen.Sampled(called, 0.1)}, (1, 0), "backwards"),
    "too close": ({"u": codegen.Sampled(called, 1e-20)}, (0, 1), "resolution"),
    "unknown": ({"w": codegen.Sampled(called, 0.1)}, (0, 1), "unknown input"),
    "unknown symbolic": ({"w": codegen.Sampled(LAW, 0.1)}, (0, 1), "unknown input"),
    "expression for all": (codegen.Sampled(LAW, 0.1), (0, 1), "by the names"),
    "several for one": ({"u": codegen.Sampled({"u": LAW}, 0.1)}, (0, 1), "several"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_laws_that_do_not_fit_a_run_are_refused(case):
    inputs, span, said = REFUSED[case]
    with pytest.raises(InputError, match=said):
        codegen.simulate(OPEN, START, span, GAINS if "symbolic" in case else {}, inputs=inputs)


def test_laws_that_are_none_are_refused():
    for law, more, said in (
        ("x", {}, "text"),
        (lambda: 1, {}, "neither"),
        (lambda t, x: 1, {"memory": 0}, r"f\(t, x, memory\)"),
        (LAW, {"memory": 0}, "memory"),
        (called, {"states": {"z": X}}, "memory"),
        (codegen.Signal(math.sin), {}, "Signal"),
    ):
        with pytest.raises(InputError, match=said):
            codegen.Sampled(law, 0.1, **more)
    with pytest.raises(InputError, match="period"):
        PENDULUM.with_control({"u": LAW}, delay=0.1)
    with pytest.raises(InputError, match="unknown input"):
        INTEGRAL.with_control({"u": LAW})
    with pytest.raises(InputError, match="unknown input"):
        INTEGRAL.with_control({"z": LAW})
    with pytest.raises(InputError, match="pair"):
        codegen.simulate(OPEN, START, (0, 1), inputs={
            "u": codegen.Sampled(lambda t, x, z: 1.0, 0.1, memory=0)})  # fmt: skip
    with pytest.raises(InputError, match="set by a sampled law"):
        codegen.simulate(INTEGRAL, START, (0, 1), GAINS, inputs={"u": math.sin})


# -- many trajectories -------------------------------------------------------------------------------


@pytest.mark.parametrize(("target", "method"), [("c", "auto"), ("c", "DOP853"), ("numpy", "auto")])
@pytest.mark.parametrize("delay", [0.0, 0.25])
def test_an_ensemble_is_its_single_runs(target, method, delay):
    closed = PENDULUM.with_control({"u": LAW - Z}, {"z": Z + X / 10}, period=0.1, delay=delay)
    system = codegen.compile(closed, target)
    k, grid = np.array([1.0, 4.0, 9.0]), np.linspace(0, 9, 31)
    whole = codegen.ensemble(system, START, (0, 9), {**GAINS, "k": k}, method, t_eval=grid,
                             inputs={"z": 0.1}, **TIGHT)  # fmt: skip
    assert whole.success
    assert target == "numpy" or "lanes" not in whole.method
    for n, gain in enumerate(k):
        one = codegen.simulate(system, START, (0, 9), {**GAINS, "k": gain}, t_eval=grid,
                               inputs={"z": 0.1}, **TIGHT)  # fmt: skip
        assert whole.y[:, :, n] == pytest.approx(one.y, abs=1e-9)
        for name in ("u", "z"):
            assert whole[name][:, n] == pytest.approx(one[name], abs=1e-8)


def test_an_ensemble_takes_symbolic_sampled_inputs_and_refuses_functions():
    law = {"u": codegen.Sampled(LAW, 0.1)}
    found = codegen.ensemble(OPEN, {"x": [0.5, 1.0], "v": 0.0}, (0, 2), GAINS, inputs=law, **TIGHT)
    one = codegen.simulate(OPEN, START, (0, 2), GAINS, inputs=law, **TIGHT)
    assert found.y[:, 0, 1] == pytest.approx(one.y[:, -1], abs=1e-10)
    assert "laws are sampled" in found.notice
    for wrong in (
        {"u": codegen.Sampled(called, 0.1)},
        {"u": math.sin},
        codegen.Sampled(called, 0.1),
    ):
        with pytest.raises(InputError, match="a function in Python") as caught:
            codegen.ensemble(OPEN, START, (0, 2), inputs=wrong)
        assert "with_control" in str(caught.value)


# -- scenes ------------------------------------------------------------------------------------------

SCENE = {
    "body": {"moments": (12, 14, 8)}, "attitude": "quaternion", "outputs": ("q1", "u_1", "raw", "z"),
    "torque": {"components": ("u_1", "-d*omega_2", "-d*omega_3")},
    "parameters": {"k": 1, "d": {"value": 4, "unit": "N m s"}, "M": 0.3},
    "control": {"period": 0.1, "delay": 0.05, "laws": {"u_1": "saturate(raw, -M, M)"},
                "definitions": {"raw": "-k*q0*q1 - d*w - 0.1*z"},
                "states": {"z": {"next": "z + 0.1*q0*q1", "unit": "s"}, "w": "5*(omega_1 - w)"}},
    "initial": {"omega_1": 0.1, "omega_2": 0, "omega_3": 0, "z": 0.2},
    "initial_attitude": {"sequence": "3-2-1", "degrees": (0, 0, 60)},
}  # fmt: skip


def test_a_scene_with_a_sampled_law_a_state_and_a_filter_is_that_of_python():
    scene = eom.Scene(**SCENE)
    system = scene.derive()
    assert "w" in system.state_names
    assert system.held == ("u_1", "z")
    assert scene.initial_values()["w"] == 0.0
    assert scene.input_values() == {"u_1": 0.0, "z": 0.2}
    run = codegen.simulate(system, scene.initial_values(), (0, 20), scene.parameter_values(),
                           inputs=scene.input_values(), **TIGHT)  # fmt: skip
    limit, z = 0.3, 0.2

    def law(t, x, z):
        raw = -x["q0"] * x["q1"] - 4 * x["w"] - 0.1 * z
        return min(limit, max(-limit, raw)), z + 0.1 * x["q0"] * x["q1"]

    start = {n: v for n, v in SCENE["initial"].items() if n != "z"}
    bare = {"control": {}, "parameters": {"d": 4}, "outputs": ("q1",), "initial": start}
    plain = scene.changed(**bare, inputs={"u_1": 0}).full_system
    plain = plain.with_control({}, {"w": 5 * (sp.Symbol("omega_1") - sp.Symbol("w"))})
    values = {**scene.parameter_values(), **scene.initial_values()}
    by_hand = codegen.simulate(
        plain, {n: values.get(n, 0.0) for n in plain.state_names}, (0, 20),
        {n: values[n] for n in plain.parameter_names},
        inputs={"u_1": codegen.Sampled(law, 0.1, 0.05, memory=z)}, **TIGHT,
    )  # fmt: skip
    assert run["q1"][-1] == pytest.approx(by_hand["q1"][-1], abs=1e-10)
    assert run["u_1"][-1] == pytest.approx(by_hand["u_1"][-1], abs=1e-10)
    assert np.abs(run["u_1"]).max() == 0.3


def test_times_of_samples_may_be_written_with_units():
    control = {**SCENE["control"], "period": "100 ms", "delay": "0.05 s"}
    (sampling,) = eom.Scene(**{**SCENE, "control": control}).derive().sampled
    assert (sampling.period, sampling.delay) == (0.1, 0.05)
    with pytest.raises(InputError, match="period"):
        eom.Scene(**{**SCENE, "control": {**control, "period": "100 mm"}})


def test_what_a_sampled_law_reads_is_kept_and_one_that_nobody_needs_is_left_out():
    scene = eom.Scene(**SCENE)
    assert scene.changed(outputs=("q1",)).derive().held == ("u_1", "z")
    body = {"body": {"moments": (1, 2, 3)}, "torque": {"components": ("u", "0", "v")}}
    two = {"laws": {"u": "-omega_3", "v": "-omega_1"}, "period": 0.1}
    whole = eom.Scene(**body, control=two, outputs=("omega_1",)).derive()
    assert whole.held == ("u", "v")


@pytest.mark.parametrize(("control", "message"), [
    ({"period": 0}, "period"),
    ({"period": -0.1}, "period"),
    ({"period": "0.1"}, "period"),
    ({"period": None, "delay": 0.1}, "delay of laws that are not sampled"),
    ({"delay": -0.1}, "delay"),
    ({"period": None, "delay": 0}, "next value without samples"),
    ({"laws": {}}, "no law"),
    ({"states": {"z": {"unit": "s"}, "w": "1"}}, "exactly one"),
    ({"states": {"z": {"next": "z", "rate": "z"}, "w": "1"}}, "exactly one"),
])  # fmt: skip
def test_what_a_file_may_not_say_of_samples_is_refused(control, message):
    with pytest.raises(InputError, match=message):
        eom.Scene(**{**SCENE, "control": {**SCENE["control"], **control}})


def test_what_takes_inputs_for_held_refuses_sampled_laws():
    system = codegen.compile(INTEGRAL, "numpy")
    point = codegen.equilibrium(SLOW, START, inputs={"u": 0.0})
    for call in (
        lambda: codegen.linearise(system, [0, 0], GAINS, [0, 0]),
        lambda: codegen.linearise_about(system, point),
        lambda: codegen.equilibrium(system, START, GAINS),
        lambda: codegen.equilibria(system, START, GAINS),
        lambda: codegen.sensitivities(system, ["k"]),
    ):
        with pytest.raises(InputError, match="sampled laws change"):
            call()
    with pytest.raises(InputError, match="set by a sampled law"):
        codegen.compile(INTEGRAL, "numpy", inputs={"u": 0.0})


def test_exported_code_says_when_its_inputs_change():
    files = codegen.compile(PENDULUM.with_control({"u": LAW}, period=0.1, delay=0.02)).files
    assert "evaluated every 0.1 s, in effect 0.02 s later" in files["pendulum.h"]
    assert "void pendulum_samples(" in files["pendulum.h"]


def test_a_system_with_samples_is_checked_and_pickled():
    import pickle

    again = pickle.loads(pickle.dumps(codegen.compile(INTEGRAL, "numpy")))
    assert again.system == INTEGRAL
    law = eom.system.Definition(INTEGRAL.inputs[0], X)
    sampling = eom.system.Sampling((law,), (), 0.1)
    for wrong in (
        {"sampled": (sampling, sampling)},
        {"sampled": (sampling,), "inputs": ()},
        {"sampled": (sampling,), "invariants": {"e": U}},
        {"sampled": (1,)},
    ):
        with pytest.raises(InputError):
            eom.System(**{**vars_of(PENDULUM), **wrong})


def vars_of(system):
    return {"name": system.name, "states": system.states, "rates": system.rates,
            "inputs": system.inputs}  # fmt: skip


def test_a_system_that_is_shown_says_what_is_held_and_when():
    text = printing.text(
        PENDULUM.with_control({"u": LAW - Z}, {"z": Z + X}, period=0.1, delay=0.02)
    )
    assert "Held between samples; every 0.1 s they become" in text
    assert "u = -d*v - k*x - z  # in effect 0.02 s later" in text
    assert "z = x + z" in text
    assert "u = u" not in text
