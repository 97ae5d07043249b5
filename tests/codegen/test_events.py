"""Events along runs: closed forms, thousands of zeros, touches, ends of runs, SciPy, C files, refusals."""

import itertools
import subprocess

import numpy as np
import pytest
import sympy as sp
from scipy import integrate, special

import codegen
import eom
from codegen import Event
from codegen.compiling.compiled import generate
from codegen.compiling.events import checked, extended
from codegen.loops import written
from codegen.native import native
from eom.errors import InputError
from eom.system import System

pytestmark = pytest.mark.sparse

runs_c = pytest.mark.skipif(not native.compiler(), reason="runs C")
METHODS = ("taylor", "DOP853")
ALL = (*METHODS, "DP5", "Tsit5")
EPSILON = np.finfo(np.float64).eps
x, v, a, w = sp.symbols("x v a w", real=True)
OSCILLATOR = System.from_rates("oscillator", {x: v, v: -x})
TURN = System.from_rates("turn", {a: w, w: sp.Integer(0)})
PENDULUM = System.from_rates("pendulum", {x: v, v: -sp.sin(x)}, outputs={"height": 1 - sp.cos(x)})


@pytest.fixture(params=METHODS)
def method(request):
    return request.param


@pytest.fixture(scope="module")
def oscillator():
    return codegen.compile(OSCILLATOR)


@pytest.fixture(scope="module")
def turn():
    return codegen.compile(TURN)


def times(system, start, span, event, method="taylor", rtol=1e-12, **options):
    return codegen.simulate(
        system, start, span, None, method, rtol, events=event, **options
    ).t_events[0]


# --- closed forms ---------------------------------------------------------------------------------


@pytest.mark.sparse(only=("taylor", "Tsit5"))
@runs_c
@pytest.mark.parametrize("method", ALL)
def test_zeros_of_the_pendulum_are_at_multiples_of_the_complete_integral(method):
    k = 0.9
    start = {"x": 0.0, "v": 2 * k}
    events = {"bottom": x, "turned": v, "up": Event(v, direction=1)}
    run = codegen.simulate(PENDULUM, start, (0, 100), None, method, 1e-12, events=events)
    quarter = special.ellipk(k * k)
    bottom, turned, up = run.t_events
    assert np.allclose(bottom, 2 * quarter * np.arange(len(bottom)), rtol=0, atol=1e-8)
    assert np.allclose(turned, quarter * (2 * np.arange(len(turned)) + 1), rtol=0, atol=1e-8)
    assert np.array_equal(up, turned[1::2])
    assert len(bottom) + len(turned) == 1 + int(100 / quarter)
    assert list(run.events["turned"].direction[:4]) == [-1, 1, -1, 1]


@pytest.mark.sparse(1)
@runs_c
def test_rates_of_the_free_body_are_zero_where_sn_and_cn_are(method):
    """I = (1, 2, 3): omega = (a cn, -b sn, c dn) of n t; dn has no zero."""
    one, two, three = 1.0, 2.0, 3.0
    energy, momentum = 1.0, 2 * 1.0 * 2.2
    system = eom.free_rigid_body(None)
    b = np.sqrt((2 * energy * three - momentum) / (two * (three - two)))
    first = np.sqrt((2 * energy * three - momentum) / (one * (three - one)))
    third = np.sqrt((momentum - 2 * energy * one) / (three * (three - one)))
    n = np.sqrt((three - two) * (momentum - 2 * energy * one) / (one * two * three))
    m = (
        (two - one)
        * (2 * energy * three - momentum)
        / ((three - two) * (momentum - 2 * energy * one))
    )
    assert b > 0
    quarter = special.ellipk(m) / n
    start = dict(zip(system.state_names, (first, 0.0, third), strict=True))
    values = dict(zip(system.parameter_names, (one, two, three), strict=True))
    rates = [q.symbol for q in system.states]
    run = codegen.simulate(system, start, (0, 60), values, method, 1e-12, events=rates)
    cn, sn, dn = run.t_events
    assert np.allclose(cn, quarter * (2 * np.arange(len(cn)) + 1), rtol=0, atol=2e-10)
    assert np.allclose(sn, quarter * 2 * np.arange(len(sn)), rtol=0, atol=2e-10)
    assert len(cn) + len(sn) == 1 + int(60 / quarter)
    assert len(dn) == 0


@pytest.mark.sparse(1)
@runs_c
@pytest.mark.parametrize("end", [20000.0, -20000.0])
def test_thousands_of_crossings_none_lost_none_twice(oscillator, end):
    """Zeros, counted without the start: 6366, forwards and backwards."""
    found = codegen.simulate(
        oscillator, [0.0, 1.0], (0, end), None, "taylor", 2.0**-52, events=[x, v]
    )
    zeros, extrema = found.t_events
    assert len(zeros) == 1 + 6366
    assert len(extrema) == 6366
    assert np.max(np.abs(zeros - np.sign(end) * np.pi * np.arange(6367))) < 1e-9
    both = np.sort(np.abs(np.concatenate(found.t_events)))
    assert np.max(np.abs(np.diff(both) - np.pi / 2)) < 1e-11
    assert np.max(np.abs(found.events["x"].y[0])) < 4 * EPSILON


@pytest.mark.sparse(1)
@runs_c
def test_many_zeros_in_one_step(oscillator, method):
    """sin(20 x) varies much more quickly than the states: up to 13 zeros between two turns."""
    found = times(oscillator, [0.0, 1.0], (0, 200), [sp.sin(20 * x)], method, 1e-10)
    k, j = np.meshgrid(np.arange(-6, 7), np.arange(-1, 40))
    up = np.arcsin(k * np.pi / 20) + 2 * np.pi * j
    exact = np.sort(np.concatenate([up, np.pi - np.arcsin(k * np.pi / 20) + 2 * np.pi * j]).ravel())
    exact = exact[(exact >= 0) & (exact <= 200)]
    assert len(found) == len(exact)
    assert np.max(np.abs(found - exact)) < 1e-7


# --- touches ---------------------------------------------------------------------------------------


@pytest.mark.sparse(1)
@runs_c
@pytest.mark.parametrize("method", ALL)
@pytest.mark.parametrize("longest", [0.01, 0.37, 3.0])
def test_every_touch_is_found_once(turn, method, longest):
    """1 - sin touches zero once a turn; with other lengths of the steps at other places of them."""
    run = codegen.simulate(turn, [0.0, 1.0], (0, 400), None, method, events=[1 - sp.sin(a), sp.sin(a)],
                           max_step=longest)  # fmt: skip
    touched, crossed = run.t_events
    assert len(touched) == 64
    assert np.max(np.abs(touched - np.pi * (2 * np.arange(64) + 0.5))) < 1e-6
    assert set(run.events["1 - sin(a)"].direction) == {0}
    assert len(crossed) == 128


@pytest.mark.sparse(1)
@runs_c
def test_a_touch_at_the_end_of_a_step_is_found_once(turn, method):
    """(a - 3)^2 with a step to 3 at most: steps of 1 end at it, or beside it by rounding."""
    for step in (1.0, 0.1, 0.3, 0.6):
        run = codegen.simulate(turn, [0.0, 1.0], (0, 7), None, method, events=(a - 3) ** 2,
                               first_step=step, max_step=step)  # fmt: skip
        assert len(run.t_events[0]) == 1, step
        assert run.t_events[0][0] == pytest.approx(3, abs=1e-6)


@pytest.mark.sparse(1)
@runs_c
def test_directions_leave_touches_out_and_a_triple_zero_is_a_crossing(turn, method):
    events = [
        Event((a - 2) ** 2, direction=1),
        Event((a - 2) ** 3),
        Event((2 - a) ** 3, direction=1),
    ]
    run = codegen.simulate(turn, [0.0, 1.0], (0, 5), None, method, events=events)
    assert [len(t) for t in run.t_events] == [0, 1, 0]
    assert run.t_events[1][0] == pytest.approx(2, abs=1e-4)
    assert run.events[events[1].label].direction[0] == 1


@pytest.mark.sparse(1)
@runs_c
def test_a_pair_that_nearly_touches_is_a_pair(turn, method):
    """1 - 1e-9 - sin has two zeros 9e-5 apart in each turn; 1 + 1e-9 - sin has none."""
    run = codegen.simulate(turn, [0.0, 1.0], (0, 100), None, method, events=[
        1 - sp.Rational(1, 10**9) - sp.sin(a), 1 + sp.Rational(1, 10**9) - sp.sin(a)])  # fmt: skip
    pairs, none = run.t_events
    assert len(pairs) == 32
    assert np.allclose(np.diff(pairs)[::2], 2 * np.arccos(1 - 1e-9), rtol=1e-3)
    assert len(none) == 0


# --- ends of runs, order, several at a time --------------------------------------------------------


@pytest.mark.sparse(1)
@runs_c
def test_zeros_at_both_ends_of_a_run(turn, method):
    t = TURN.time
    run = codegen.simulate(turn, [0.0, 1.0], (0, 2), None, method, events=[t * (t - 2), a, 2 - t])
    assert [list(t) for t in run.t_events] == [[0.0, 2.0], [0.0], [2.0]]
    assert [list(e.direction) for e in run.events.values()] == [[-1, 1], [1], [-1]]
    again = codegen.simulate(turn, [0.0, 1.0], (0, -2), None, method, events=[a, t + 2])
    assert [list(t) for t in again.t_events] == [[0.0], [-2.0]]
    assert [list(e.direction) for e in again.events.values()] == [[-1], [-1]]


@pytest.mark.sparse(1)
@runs_c
def test_a_run_in_two_finds_what_one_finds(oscillator, method):
    """Cut at every place, also at a zero: what is at the cut is at most twice there, once a run."""
    whole = times(oscillator, [0.0, 1.0], (0, 20), [x], method)
    for cut in (3.0, np.pi, np.pi + 1e-12, np.pi - 1e-12):
        first = codegen.simulate(oscillator, [0.0, 1.0], (0, cut), None, method, 1e-12, events=x)
        rest = times(oscillator, first.y_stop, (cut, 20), [x], method)
        both = np.concatenate([first.t_events[0], rest])
        assert len(both) == len(whole)
        assert np.max(np.abs(both - whole)) < 1e-10


@pytest.mark.sparse(1)
@runs_c
def test_terminal_events_end_the_run_there(oscillator, method):
    events = [
        Event(x, terminal=3, name="third"),
        Event(v, direction=-1),
        Event(x - 10, terminal=True),
    ]
    run = codegen.simulate(oscillator, [0.0, 1.0], (0, 100), None, method, 1e-12, events=events,
                           dense_output=True)  # fmt: skip
    assert (run.status, run.success) == (2, True)
    assert run.message == "stopped at t = 9.42477796 s: event third"
    assert run.t_stop == run.t[-1] == run.t_events[0][-1] == pytest.approx(3 * np.pi, abs=1e-10)
    assert np.array_equal(run.y_stop, run.y[:, -1])
    assert np.array_equal(run.y_stop, run.y_events[0][-1])
    assert abs(run.y_stop[0]) < 8 * EPSILON
    assert len(run.t_events[0]) == 4  # that of the start does not count
    assert np.allclose(run.t_events[1], np.pi * np.array([0.5, 2.5]), atol=1e-10)
    assert np.allclose(run.sol(run.t_events[0]), run.events["third"].y, atol=1e-14)


@pytest.mark.sparse(1)
@runs_c
def test_simultaneous_events_are_all_reported_also_where_the_run_ends(turn, method):
    events = {
        "one": Event(a - 1, terminal=True),
        "two": 2 * a - 2,
        "square": a**2 - 1,
        "later": a - 1.5,
    }
    run = codegen.simulate(turn, [0.0, 1.0], (0, 5), None, method, events=events)
    assert [len(t) for t in run.t_events] == [1, 1, 1, 0]
    assert run.t_stop == pytest.approx(1, abs=1e-14)
    grid = codegen.simulate(turn, [0.0, 1.0], (0, 5), None, method, events=events,
                            t_eval=np.linspace(0, 5, 51))  # fmt: skip
    assert grid.t[-1] <= 1 < grid.t[-1] + 0.11
    assert grid.t_stop == run.t_stop


@pytest.mark.sparse(1)
@runs_c
def test_trajectories_do_not_depend_on_events(oscillator, method):
    """DOP853 makes the same steps with any; taylor with those whose series is seen as far as the motion."""
    events = [x, x * v, sp.sin(v)] + [sp.sin(9 * v)] * (method != "taylor")
    without = codegen.simulate(oscillator, [0.0, 1.0], (0, 50), None, method)
    with_some = codegen.simulate(oscillator, [0.0, 1.0], (0, 50), None, method, events=events)
    assert np.array_equal(without.t, with_some.t)
    assert np.max(np.abs(without.y - with_some.y)) < 1e-13


@runs_c
def test_events_that_vary_more_quickly_than_the_motion_shorten_steps_of_taylor_alone(oscillator):
    grid, rtol = np.linspace(0, 50, 101), 2.0**-52
    without, with_some = (
        codegen.simulate(oscillator, [0.0, 1.0], (0, 50), None, "taylor", rtol, t_eval=grid, **more)
        for more in ({}, {"events": [sp.sin(9 * v)]})
    )
    assert with_some.steps > without.steps
    assert np.max(np.abs(without.y - with_some.y)) < 1e-13


@runs_c
def test_events_on_a_pulse_that_is_over_within_a_plain_step(oscillator):
    """exp(-1e6 (x - 0.3)^2) = 1/2 at two places of every passage; a plain step has some 4000 widths."""
    level = sp.Rational(3, 10)
    pulse = sp.exp(-((1000 * (x - level)) ** 2)) - sp.Rational(1, 2)
    found = times(oscillator, [0.0, 1.0], (0, 100), [pulse])
    width = np.sqrt(np.log(2)) / 1000
    up = np.arcsin([0.3 - width, 0.3 + width])
    turns = 2 * np.pi * np.arange(16)[:, None]
    exact = np.sort(np.concatenate([turns + up, turns + np.pi - up]).ravel())
    assert len(found) == len(exact)
    assert np.max(np.abs(found - exact)) < 1e-9


@runs_c
def test_more_events_than_the_room_for_them(turn):
    assert len(times(turn, [0.0, 1.0], (0, 1000), [sp.sin(100 * a)], max_step=1.0)) == 31831


@pytest.mark.sparse(1)
@runs_c
def test_bouncing_ball(method):
    """Each run ends at the ground, the next begins there; a direction keeps the start from counting."""
    ball = codegen.compile(System.from_rates("ball", {x: v, v: -sp.Integer(10)}))
    t, state, hits = 0.0, np.array([5.0, 0.0]), []
    for _ in range(6):
        run = codegen.simulate(ball, state, (t, 100), None, method,
                               events=Event(x, direction=-1, terminal=True))  # fmt: skip
        t, state = run.t_stop, run.y_stop * [1, -0.5]
        hits.append(t)
    assert np.allclose(hits, 1 + 2 * (1 - 0.5 ** np.arange(6)), atol=1e-12)


# --- SciPy, singular configurations, what is compiled in -------------------------------------------


@pytest.mark.sparse(1)
@runs_c
def test_scipy_finds_the_same(method):
    def rates(t, y):
        return [y[1], -np.sin(y[0])]

    functions = [lambda t, y: y[0] - 0.3, lambda t, y: y[0] * y[1] - 0.2 * np.cos(t)]
    functions[0].direction = -1
    oracle = integrate.solve_ivp(rates, (0, 60), [1.0, 0.5], "DOP853", rtol=1e-12, atol=1e-14,
                                 events=functions, max_step=0.05)  # fmt: skip
    t = PENDULUM.time
    events = [Event(x - sp.Rational(3, 10), direction=-1), x * v - sp.cos(t) / 5]
    run = codegen.simulate(PENDULUM, [1.0, 0.5], (0, 60), None, method, 1e-12, events=events)
    for own, other, y, z in zip(
        run.t_events, oracle.t_events, run.y_events, oracle.y_events, strict=True
    ):
        assert len(own) == len(other) > 5
        assert np.max(np.abs(own - other)) < 1e-9
        assert np.max(np.abs(y - z)) < 1e-9


@pytest.mark.sparse(1)
@runs_c
def test_a_singular_configuration_is_reached_before_a_later_event(method):
    system = eom.free_rigid_body("3-2-1")
    start = dict.fromkeys(system.state_names, 0.0) | {"omega_2": 1.0}
    values = dict(zip(system.parameter_names, (1.0, 2.0, 3.0), strict=True))
    theta = next(q.symbol for q in system.states if q.name == "theta")
    events = {"before": theta - 1, "after": theta - sp.Rational(8, 5)}
    run = codegen.simulate(system, start, (0, 5), values, method, events=events)
    assert run.status == 1
    assert [len(t) for t in run.t_events] == [1, 0]
    stopped = codegen.simulate(system, start, (0, 5), values, method,
                               events=Event(theta - 1, terminal=True))  # fmt: skip
    assert (stopped.status, stopped.t_stop) == (2, pytest.approx(1.0, abs=1e-9))


@pytest.mark.sparse(1)
@runs_c
def test_parameters_outputs_and_what_is_compiled_in(method):
    g, level = sp.symbols("g level", real=True)
    system = System.from_rates("swing", {x: v, v: -g * sp.sin(x), a: x * 0 + 1 + level * 0},
                               outputs={"height": 1 - sp.cos(x), "rise": level * x})  # fmt: skip
    height = system.outputs[0].symbol
    start, span = {"x": 1.0, "v": 0.0, "a": 0.0}, (0, 10)
    events = {"level": height - level, "third": x - g / 30}
    plain = codegen.simulate(system, start, span, {"g": 9.0, "level": 0.2}, method, events=events)
    fixed = codegen.compile(system, parameters={"level": 0.2})
    held = codegen.simulate(fixed, start, span, {"g": 9.0}, method, events=events)
    part = codegen.simulate(fixed, start, span, {"g": 9.0}, method, events=events, outputs=["a"])
    assert min(map(len, plain.t_events)) > 5
    for other in (held, part):
        for one, two in zip(plain.t_events, other.t_events, strict=True):
            assert np.allclose(one, two, atol=1e-7)


@pytest.mark.sparse(1)
@runs_c
def test_events_of_projected_runs_are_on_the_invariants(method):
    energy = {"E": v**2 / 2 - sp.cos(x)}
    system = System.from_rates("kept", {x: v, v: -sp.sin(x)}, invariants=energy)
    run = codegen.simulate(system, [0.0, 1.8], (0, 50), None, method, 1e-6, project=True,
                           events=[x, Event(x - 1, terminal=4)])  # fmt: skip
    y = np.concatenate([e.y for e in run.events.values()], axis=1)
    assert np.max(np.abs(y[1] ** 2 / 2 - np.cos(y[0]) - (1.8**2 / 2 - 1))) < 1e-13
    assert run.status == 2
    assert np.max(np.abs(run.events["x"].y[0])) < 1e-13


@runs_c
def test_auto_takes_a_method_that_finds_events():
    run = codegen.simulate(PENDULUM, [0.0, 1.0], (0, 10), events=x)
    assert "Taylor" in run.method
    assert "events" in run.why
    height = PENDULUM.outputs[0].symbol
    assert (
        len(codegen.simulate(PENDULUM, [0.0, 1.0], (0, 10), events=[height - 0.1]).t_events[0]) > 3
    )


# --- generated files -------------------------------------------------------------------------------

MAIN = """
#include <stdio.h>
#include "pendulum_{0}.h"
int main(void) {{
    static pendulum_{0} s;
    static pendulum_{0}_event found[PENDULUM_{1}_EVENTS_A_STEP + 100];
    double t[64], y[128];
    pendulum_{0}_output o = {{0}};
    o.t = t, o.x = y, o.capacity = 64;
    s.t_end = 60.0, s.rtol = 1e-12, s.atol[0] = s.atol[1] = 1e-15, s.h_max = HUGE_VAL, s.margin = 1e-6;
    s.x[1] = 1.0;
    s.found = found, s.found_room = sizeof found / sizeof *found;
    s.event_stop[1] = 7, s.event_direction[1] = 1;
    int status = pendulum_{0}_start(&s, NULL, NULL);
    while (status == PENDULUM_{1}_PAUSED || status == PENDULUM_{1}_FULL) {{
        status = pendulum_{0}_run(&s, NULL, &o, 1000000);
        for (size_t k = 0; k < s.found_count; ++k)
            printf("%d %d %.17g %.17g\\n", found[k].which, found[k].direction, found[k].t, found[k].x[0]);
        s.found_count = o.count = 0;
    }}
    printf("%d %d %.17g %.17g\\n", s.which, status, s.t, s.x[0]);
    return 0;
}}
"""


@pytest.mark.sparse(1)
@runs_c
@pytest.mark.parametrize("name", ["taylor", "dop853"])
def test_generated_files_find_events_by_themselves(tmp_path, name):
    compiled = codegen.compile(PENDULUM)
    events = checked([x, v])
    program, layout = extended(compiled.program, compiled.layout, compiled, events)
    texts = generate(program, layout, "c", written.Choice(name, 1e-12))
    for file, text in texts.items():
        (tmp_path / file).write_text(text)
    (tmp_path / "main.c").write_text("#include <math.h>\n" + MAIN.format(name, name.upper()))
    sources = [str(tmp_path / f) for f in ("main.c", "pendulum.c", f"pendulum_{name}.c")]
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1"]
    checks = [] if name == "taylor" else ["-fsanitize=address,undefined"]
    command = [*native.compiler(), *strict, *checks, *sources, "-o", str(tmp_path / "main"), "-lm"]
    subprocess.run(command, check=True)
    out = subprocess.run(
        [str(tmp_path / "main")], check=True, capture_output=True, text=True
    ).stdout
    *rows, last = ([float(n) for n in line.split()] for line in out.splitlines())
    period = 4 * special.ellipk(0.25)
    assert last[:2] == [1.0, 5.0]
    assert last[2] == pytest.approx(6.75 * period, abs=1e-9)
    assert [row[0] for row in rows[:4]] == [0, 1, 0, 0] or [row[0] for row in rows[:4]] == [
        0,
        0,
        1,
        0,
    ]
    assert sum(row[0] == 1 for row in rows) == 7
    assert np.allclose(
        [row[2] for row in rows if row[0] == 0], period / 2 * np.arange(14), atol=1e-9
    )


@pytest.mark.parametrize("name", ["taylor", "dop853", "dp5", "tsit5"])
def test_files_without_events_say_nothing_of_them(name):
    compiled = codegen.compile(PENDULUM, "numpy")
    texts = generate(compiled.program, compiled.layout, "c", written.Choice(name))
    code = "".join(text for file, text in texts.items() if file.endswith((".c", ".h")))
    assert len(code) > 1000
    assert not any(word in code for word in ("event", "EVENT", "crossing", "@"))


def test_files_with_events_are_the_same_bytes_again():
    compiled = codegen.compile(PENDULUM, "numpy")
    made = [
        generate(*extended(compiled.program, compiled.layout, compiled, checked([x * v, sp.sin(x)])), "c",
                 written.Choice(name))
        for name in ("taylor", "dop853") for _ in range(2)
    ]  # fmt: skip
    assert made[0] == made[1]
    assert made[2] == made[3]
    assert not any(
        "@" in text for texts in made for file, text in texts.items() if file[-2:] in {".c", ".h"}
    )


# --- refusals --------------------------------------------------------------------------------------

BAD = [
    ("x", "not a number or a SymPy expression"),
    ([x, x], "two events have one name"),
    (sp.Symbol("nobody"), "symbol without a meaning"),
    (sp.Symbol("x"), "symbol without a meaning"),
    (sp.Integer(3), "does not vary"),
    (sp.Abs(x) - 1, "branch"),
    (sp.Min(x, v), "branch"),
    (sp.Eq(x, 1), "not an expression"),
]


@pytest.mark.parametrize(("events", "what"), BAD)
def test_bad_events_are_refused_by_one_message(events, what):
    compiled = codegen.compile(PENDULUM, "numpy")
    with pytest.raises(InputError, match=what):
        extended(compiled.program, compiled.layout, compiled, checked(events))


@pytest.mark.parametrize(
    ("more", "reported"),
    [
        ({"direction": 2}, "an event has no such direction"),
        ({"terminal": -1}, "an event cannot end a run so"),
        ({"terminal": 0.5}, "terminal is of the wrong type"),
    ],
)
def test_bad_filters_are_refused(more, reported):
    with pytest.raises(InputError, match=reported):
        Event(x, **more)


@pytest.mark.parametrize("method", ["scipy:LSODA", "rkmk", "splitting"])
def test_methods_that_find_none_say_so(method):
    with pytest.raises(InputError, match="finds no events") as error:
        codegen.simulate(PENDULUM, [0.0, 1.0], (0, 1), None, method, events=x)
    assert "taylor, DOP853" in error.value.expected or "taylor" in error.value.expected


def test_other_targets_say_so():
    compiled = codegen.compile(PENDULUM, "numpy")
    with pytest.raises(InputError, match="generated C alone"):
        codegen.simulate(compiled, [0.0, 1.0], (0, 1), None, "DOP853", events=x)


@runs_c
def test_order_of_all_events_is_that_of_time(oscillator):
    events = [x, v, x - v, sp.sin(7 * x)]
    run = codegen.simulate(oscillator, [0.1, 1.0], (0, 100), None, "taylor", events=events)
    assert all(one < other for t in run.t_events for one, other in itertools.pairwise(t))


@pytest.mark.sparse(1)
@runs_c
def test_runs_in_which_nothing_happens_and_one_state(method):
    decay = System.from_rates("decay", {x: -x})
    run = codegen.simulate(
        decay, [1.0], (0, 5), None, method, events=[x - 2, x - sp.Rational(1, 2)]
    )
    assert [y.shape for y in run.y_events] == [(0, 1), (1, 1)]
    assert run.t_events[1][0] == pytest.approx(np.log(2), abs=1e-9)
    none = codegen.simulate(decay, [1.0], (0, 5), None, method, events=x - 2)
    assert none.status == 0
    assert [len(t) for t in none.t_events] == [0]
    assert codegen.simulate(decay, [1.0], (0, 5), None, method).events == {}
