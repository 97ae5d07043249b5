"""Runs that are prepared once: the same numbers as ever, the same refusals, and what is read alone."""

import copy
import inspect
import pickle
import re
import threading

import numpy as np
import pytest
import sympy as sp

import codegen
from codegen import compile as compile_system
from codegen import integrator, simulate
from codegen.native import native
from codegen.runs import prepared, result, simulation
from eom.errors import AssumptionError, InputError
from eom.opening import load_scene
from eom.problems import PROBLEMS, from_scene
from eom.quantities import TIME
from eom.system import System

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="runs in generated C")
BODY = next(p for p in PROBLEMS if p.name == "free-body-attitude")
Y, V, K, M = sp.symbols("y v k M", real=True)


def same(a, b):
    assert a.t.tobytes() == b.t.tobytes()
    assert a.y.tobytes() == b.y.tobytes()
    assert {n: v.tobytes() for n, v in a.outputs.items()} == {
        n: v.tobytes() for n, v in b.outputs.items()
    }
    assert (a.status, a.message, a.steps, a.rejected, a.nfev, a.notice, a.method, a.why) == (
        b.status, b.message, b.steps, b.rejected, b.nfev, b.notice, b.method, b.why
    )  # fmt: skip
    assert (a.margin, a.names, a.left_out, a.t_stop) == (b.margin, b.names, b.left_out, b.t_stop)
    assert {n: d.relative for n, d in a.drift.items()} == {
        n: d.relative for n, d in b.drift.items()
    }


@pytest.fixture(scope="module")
def body():
    return compile_system(BODY.system, "c")


@needs_compiler
@pytest.mark.sparse(4)
@pytest.mark.parametrize("method", ["taylor", "DOP853", "Tsit5", "auto", "rkmk", "scipy:DOP853"])
@pytest.mark.parametrize("options", [
    {"t_span": (0, 20)}, {"t_eval": [0, 1, 20.0]}, {"t_span": (0, -3), "dense_output": True},
    {"t_span": (0, 20), "max_steps": 7}, {"t_span": (1e7, 1e7 + 2)}, {"t_span": (0, 400)},
])  # fmt: skip
def test_the_quick_way_gives_the_numbers_of_the_long_one(body, monkeypatch, method, options):
    """To the last bit, and every word: without the module of quick calls all goes the long way."""
    runs = integrator(body, method=method, **options)
    quick = [runs.run(BODY.start, BODY.parameters) for _ in range(2)]
    with monkeypatch.context() as without:
        without.setattr(native, "_extension", lambda: None)
        plain = compile_system(BODY.system, "c")
        long = integrator(plain, method=method, **options).run(BODY.start, BODY.parameters)
    for run in quick:
        same(run, long)
    if "t_span" in options:
        same(simulate(body, BODY.start, parameters=BODY.parameters, method=method, **options), long)


@needs_compiler
def test_what_auto_decided_once_holds_for_the_values_that_it_was_decided_for(monkeypatch):
    """Stiff or not by the parameter and by the initial state, closed by the parameter, back again."""
    rates = {Y: V, V: M * (1 - Y**2) * V - K * Y}
    system = System.from_rates("relaxation", rates)
    compiled = compile_system(system, "c")
    runs = integrator(compiled, (0, 2000), rtol=1e-6, t_eval=[0, 2000.0])
    cases = [((2.0, 0.0), (k, m)) for k, m in ((1.0, 1.0), (1.0, 1e3), (1.0, 0.0), (1.0, 1.0))]
    cases += [((1e5, 0.0), (1.0, 1.0)), ((2.0, 0.1), (1.0, 1.0))]
    names = [q.name for q in compiled.layout.parameters]
    found = [runs.run(x, dict(zip(("k", "M"), p, strict=True))) for x, p in cases]
    assert sorted(names) == ["M", "k"]
    assert [f.method.split()[0] for f in found[:4]] == ["Taylor", "LSODA", "closed", "Taylor"]
    monkeypatch.setattr(prepared, "decided", lambda task: None)
    for (x, p), quick in zip(cases, found, strict=True):
        values = dict(zip(("k", "M"), p, strict=True))
        same(quick, simulate(compiled, x, (0, 2000), values, rtol=1e-6, t_eval=[0, 2000.0]))


@needs_compiler
@pytest.mark.parametrize("name", ["bicycle-wheel", "rolling-disc", "quadrotor", "four-bar-linkage"])
def test_scenes_run_alike_in_any_order_of_values(name):
    """Projection, unknown scales, defaults and inputs among them; values by name, in order, as arrays."""
    p = from_scene(load_scene(name))
    compiled = compile_system(p.system, "c")
    layout = compiled.layout
    rows = (p.start, layout.states), (p.parameters, layout.parameters)
    orders = [[float(of[q.name]) for q in quantities] for of, quantities in rows]
    runs = integrator(compiled, t_eval=np.linspace(0, 0.1, 5), inputs=p.inputs)
    one = runs.run(p.start, p.parameters)
    same(one, runs.run(dict(reversed(p.start.items())), p.parameters, p.inputs))
    same(one, runs.run(np.array(orders[0]), tuple(orders[1])))
    same(one, simulate(p.system, p.start, (0, 0.1), p.parameters, t_eval=np.linspace(0, 0.1, 5),
                       inputs=p.inputs))  # fmt: skip


def test_what_is_said_of_arguments_is_written_once():
    """Of all that an integrator takes as `simulate` does its page says the same; of the rest its own."""
    own, other = (inspect.getdoc(f) for f in (integrator, simulate))
    named = re.findall(r"^(\w+) : .*\n(?:    .*\n)*", own, re.MULTILINE)
    texts = dict(
        zip(named, re.findall(r"^\w+ : .*\n(?:    .*\n)*", own, re.MULTILINE), strict=True)
    )
    assert named == list(inspect.signature(integrator).parameters)
    assert {n for n, text in texts.items() if text not in other} == {
        "system", "t_span", "method", "inputs",
    }  # fmt: skip
    assert (
        own.index("Parameters")
        < own.index("epoch :")
        < own.index("Returns")
        < own.index("Examples")
    )


@needs_compiler
def test_values_that_contradict_are_refused_at_every_run(body):
    """Also behind a run that passed, with the same parameters and others."""
    runs = integrator(body, (0, 1), "taylor")
    runs.run(BODY.start, BODY.parameters)
    for start, parameters, words in (
        ({**BODY.start, "q0": 0.9}, BODY.parameters, "q0"),
        (BODY.start, {"I1": 1.0, "I2": 1.0, "I3": 3.0}, "I3"),
        (BODY.start, {"I1": -1.0, "I2": 2.0, "I3": 3.0}, "I1"),
    ):
        for _ in range(2):
            with pytest.raises((AssumptionError, InputError), match=words):
                runs.run(start, parameters)
            runs.run(BODY.start, BODY.parameters)


@needs_compiler
@pytest.mark.parametrize(("start", "parameters", "words"), [
    ({**BODY.start, "q0": np.nan}, BODY.parameters, "q0 is not finite"),
    ({**BODY.start, "q9": 1.0}, BODY.parameters, "unknown initial value 'q9'"),
    ({"q0": 1.0}, BODY.parameters, "missing initial values"),
    (BODY.start, {}, "missing parameters"),
    (BODY.start, None, "wrong number of parameters"),
    ([1.0], BODY.parameters, "wrong number of initial values"),
    ({**BODY.start, "q0": "1 kg"}, BODY.parameters, "q0"),
    ({**BODY.start, "q0": [1.0]}, BODY.parameters, "of the wrong type"),
    ("abc", BODY.parameters, "initial is of the wrong type"),
    (BODY.start, {**BODY.parameters, "I1": 10**400}, "parameters"),
])  # fmt: skip
def test_what_is_no_value_is_told_as_by_simulate(body, start, parameters, words):
    runs = integrator(body, (0, 1), "taylor")
    for call in (
        lambda: runs.run(start, parameters),
        lambda: simulate(body, start, (0, 1), parameters),
    ):
        with pytest.raises(InputError, match=words):
            call()


@needs_compiler
def test_units_in_texts_and_defaults_go_the_long_way(body):
    runs = integrator(body, (0, 1), "taylor")
    same(
        runs.run({**BODY.start, "omega_1": "0.3 rad/s"}, BODY.parameters),
        runs.run(BODY.start, BODY.parameters),
    )


def test_what_no_value_can_mend_is_refused_when_prepared():
    system = System.from_rates("oscillator", {Y: V, V: -Y})
    for options, words in (
        ({}, "no interval of time"),
        ({"t_eval": [1.0]}, "no interval of time"),
        ({"t_span": (0, 1), "rtol": 0.0}, "rtol"),
        ({"t_span": (0, 1), "method": "euler"}, "unknown method"),
        ({"t_span": (0, 1), "outputs": ["z"]}, "unknown state or output"),
        ({"t_span": (1, 1)}, "t_span"),
        ({"t_span": (0, 1), "method": "scipy:LSODA", "events": Y}, "finds no events"),
    ):
        with pytest.raises(InputError, match=words):
            integrator(system, **options)


@needs_compiler
def test_nothing_is_evaluated_that_is_not_read(body, monkeypatch):
    asked = []
    whole = result.Found._evaluated

    def noted(found, group):
        asked.append(group)
        return whole(found, group)

    monkeypatch.setattr(result.Found, "_evaluated", noted)
    run = integrator(body, (0, 20), "taylor").run(BODY.start, BODY.parameters)
    assert (run.status, run.success, len(run.t), run.y_stop.shape, run.steps > 9) == (
        0,
        True,
        len(run.t),
        (7,),
        True,
    )
    assert asked == []
    run.drift["T"], run.drift["T"]
    assert asked == ["invariants"]
    run["H_1"], run["H_1"]
    assert asked == ["invariants", "outputs"]


@needs_compiler
def test_what_is_read_late_does_not_see_what_was_done_to_the_arrays(body):
    runs = integrator(body, (0, 20), "taylor")
    start = np.array([float(BODY.start[q.name]) for q in body.layout.states])
    one, other = runs.run(start, BODY.parameters), runs.run(start, BODY.parameters)
    assert one.outputs
    assert one.drift
    other.y[:], other.t[:], start[:] = 0.0, -1.0, 7.0
    assert {n: v.tobytes() for n, v in other.outputs.items()} == {
        n: v.tobytes() for n, v in one.outputs.items()
    }
    assert other.drift["T"].relative == one.drift["T"].relative
    assert other.accuracy().known


@needs_compiler
def test_a_result_that_was_not_read_is_pickled_and_copied_whole(body):
    runs = integrator(body, (0, 20), "taylor")
    one = runs.run(BODY.start, BODY.parameters)
    for made in (pickle.loads(pickle.dumps(runs.run(BODY.start, BODY.parameters))),
                 copy.copy(runs.run(BODY.start, BODY.parameters)),
                 copy.deepcopy(runs.run(BODY.start, BODY.parameters))):  # fmt: skip
        same(made, one)
        with pytest.raises(AttributeError, match="no attribute 'outpts'"):
            _ = made.outpts


@needs_compiler
def test_a_warning_is_there_whenever_it_is_read():
    """A jump that the resolution of time makes count; and a state whose scale nobody knows."""
    late = sp.Heaviside(TIME - 7 + sp.Rational(1, 10**6))
    jump = System.from_rates("jump", {Y: V, V: -Y + K * late}, time=TIME)
    run = integrator(jump, (0, 7), "DOP853", 1e-11).run([1.0, 0.0], {"k": 1e6})
    assert "the resolution of time" in run.notice
    rest = System.from_rates("rest", {Y: V, V: -Y})
    run = integrator(rest, (0, 1), "taylor").run([0.0, 0.0])
    assert "no scale is known" in run.notice
    assert "notice: no scale is known" in repr(run)


@needs_compiler
def test_functions_are_asked_during_the_run_and_not_afterwards():
    """What a function returns may change: outputs that need it are found at once."""
    system = System.from_rates("pushed", {Y: V, V: M}, inputs=[M], outputs={"force": M})
    calls = []
    runs = integrator(system, (0, 1), "DOP853")
    run = runs.run([0.0, 0.0], None, {"M": lambda t: calls.append(t) or 1.0})
    made = len(calls)
    assert run["force"].tolist() == [1.0] * len(run.t)
    assert len(calls) == made
    assert runs.run([0.0, 0.0], None, {"M": 2.0})["y"][-1] == pytest.approx(1.0)


@needs_compiler
def test_threads_may_share_one(body):
    runs = integrator(body, (0, 50), "taylor")
    starts = [{**BODY.start, "omega_1": 0.1 * k} for k in range(1, 9)]
    alone = [runs.run(s, BODY.parameters).y.tobytes() for s in starts]
    wrong = []

    def work(k):
        made = [runs.run(starts[k], BODY.parameters).y.tobytes() for _ in range(30)]
        wrong.extend(k for found in made if found != alone[k])

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_simulate_keeps_integrators_by_what_arguments_say(monkeypatch):
    made = []

    def asked_of(*arguments):
        made.append(arguments)
        return prepared.asked_of(*arguments)

    monkeypatch.setattr(simulation, "asked_of", asked_of)
    system = System.from_rates("oscillator", {Y: V, V: -Y})
    compiled = compile_system(system, "numpy")
    for times in ([0.5, 1], (0.5, 1), np.array([0.5, 1.0]), [0.5, 0.75], None):
        run = simulate(compiled, [1, 0], (0, 1), method="scipy:RK45", t_eval=times)
        assert times is None or run.t.tolist() == list(times)
    assert len(made) == 4
    assert len(simulation._kept) <= simulation.KEPT
    long = np.linspace(0, 1, simulation.MOST_KEPT + 1)
    for _ in range(2):  # too many times to be compared: prepared anew
        simulate(compiled, [1, 0], (0, 1), method="scipy:RK45", t_eval=long)
    assert len(made) == 6
    assert "Integrator('oscillator', scipy:RK45" in repr(integrator(compiled, (0, 1), "scipy:RK45"))
    assert prepared.AUTO in codegen.METHODS


def test_integrators_that_are_kept_are_few_and_the_latest():
    compiled = compile_system(System.from_rates("oscillator", {Y: V, V: -Y}), "numpy")

    def run(end):
        return simulate(compiled, [1, 0], (0, end), method="scipy:RK45", t_eval=[end]).t_stop

    ends = [1.0 + k / 64 for k in range(simulation.KEPT + 3)]
    for end in ends:
        assert run(ends[0]) == ends[0]
        assert run(end) == end
    assert len(simulation._kept) == simulation.KEPT
    spans = {key[1:3] for key in simulation._kept}
    assert (0, ends[0]) in spans
    assert (0, ends[-1]) in spans
    assert (0, ends[1]) not in spans


def test_a_closed_form_is_made_once_for_an_initial_state(monkeypatch):
    from codegen.closed import closed_forms

    y = sp.symbols("y_1 y_2 y_3", real=True)
    rates = {y[0]: y[1] * y[2], y[1]: -2 * y[2] * y[0], y[2]: y[0] * y[1]}
    compiled = compile_system(System.from_rates("triad", rates), "numpy")
    made, moved = [], closed_forms.triad
    monkeypatch.setattr(closed_forms, "triad", lambda *a: made.append(a) or moved(*a))
    run = integrator(compiled, (0, 3), t_eval=[1.0, 3.0]).run
    first, again, other = (run(x) for x in ([1, 0.5, 2], [1.0, 0.5, 2.0], [1, 0.5, 2.5]))
    assert first.method == "closed form: free body"
    assert len(made) == 2
    assert first.y.tobytes() == again.y.tobytes() != other.y.tobytes()
    assert first.y is not again.y
    assert first.y_stop.tolist() == first.y[:, -1].tolist()
