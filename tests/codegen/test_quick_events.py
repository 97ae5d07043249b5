"""Events that vary much more quickly than the motion: every zero, or a notice that some may be missing."""

import subprocess

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from codegen.compiling.compiled import generate
from codegen.compiling.events import checked, extended
from codegen.ir.interpret import Point, interpret
from codegen.loops import crossings, written
from codegen.native import native
from codegen.watch.narrow import steady
from eom.quantities import TIME
from eom.system import System

pytestmark = pytest.mark.skipif(not native.compiler(), reason="runs C")
METHODS = ("DOP853", "DP5", "Tsit5", "taylor")
x, v = sp.symbols("x v", real=True)
OSCILLATOR = System.from_rates("oscillator", {x: v, v: -x})
STRAIGHT = System.from_rates("straight", {x: sp.Integer(1), v: x})
"""Its first step is its last, whatever the method."""


@pytest.fixture(scope="module")
def compiled():
    return {s.name: codegen.compile(s) for s in (OSCILLATOR, STRAIGHT)}


def zeros_of(system, start, span, event, method, rtol=1e-6, **more):
    return codegen.simulate(system, start, span, None, method, rtol, events={"e": event}, **more)


# --- every zero -----------------------------------------------------------------------------------


@pytest.mark.sparse(1)
@pytest.mark.parametrize("method", METHODS)
def test_all_64_zeros_of_a_wave_in_time_and_in_state(compiled, method):
    """sin(64 t) over pi, forwards and backwards, also in one step; sin(40 x) on its way."""
    waves = {"time": sp.sin(64 * TIME + sp.Rational(1, 10)), "state": sp.sin(40 * x)}
    for name, start in (("oscillator", (1.0, 0.0)), ("straight", (0.0, 0.0))):
        for end in (np.pi, -np.pi):
            plan = compiled[name], start, (0, end), None, method, 1e-9
            run = codegen.simulate(*plan, events=waves)
            exact = (np.pi * np.arange(-64, 65) - 0.1) / 64
            exact = exact[(exact * end > 0) & (np.abs(exact) < np.pi)][:: int(np.sign(end))]
            assert run.notice == ""
            assert len(run.events["time"]) == len(exact) == 64
            assert np.max(np.abs(run.events["time"].t - exact)) < 1e-9
            assert np.all(np.diff(run.events["time"].direction) != 0)
            if name == "oscillator":
                level = np.sort(np.cos(run.events["state"].t))
                assert np.max(np.abs(level - np.pi * np.arange(-12, 13) / 40)) < 1e-7


@pytest.mark.sparse(only=("taylor",))
@pytest.mark.parametrize("method", METHODS)
def test_thousands_of_zeros_in_what_would_be_one_step(compiled, method):
    plan = compiled["straight"], (0.0, 0.0), (0, 30.0)
    run = zeros_of(*plan, sp.cos(640 * x), method)
    exact = (np.arange(int(30 * 640 / np.pi + 0.5)) + 0.5) * np.pi / 640
    assert len(run.events["e"]) == len(exact)
    assert np.max(np.abs(run.events["e"].t - exact)) < 1e-9
    assert run.notice == ""
    bare = codegen.simulate(*plan, None, method, 1e-6)
    if method != "taylor":  # whose series has the event's own coefficients
        assert run.nfev - bare.nfev < len(exact)


NARROW = {
    "pulse in time": sp.exp(-((1000 * (TIME - 77)) ** 2)) - sp.Rational(1, 2),
    "pulse in state": sp.exp(-((1000 * (x - 77)) ** 2)) - sp.Rational(1, 2),
    "resonance": 1 / (1 + (1000 * (x - 77)) ** 2) - sp.Rational(1, 2),
    "window": sp.tanh(1000 * (x - 77)) - sp.tanh(1000 * (x - 77) - 1) - sp.Rational(1, 2),
    "high power": ((x - 50) / 27) ** 900 - 1,
}


@pytest.mark.sparse(only=("DOP853", "taylor"))
@pytest.mark.parametrize("method", METHODS)
def test_pairs_of_zeros_that_no_value_of_a_long_step_shows(compiled, method):
    run = codegen.simulate(
        compiled["straight"], (0.0, 0.0), (0, 100.0), None, method, 1e-6, events=NARROW
    )
    for case in NARROW:
        near = (23.0, 77.0) if case == "high power" else (77.0, 77.0)
        assert len(run.events[case]) == 2, case
        assert np.max(np.abs(run.events[case].t - near)) < 1e-2
    assert run.notice == ""


# --- what it costs, and what is said ----------------------------------------------------------------


@pytest.mark.sparse(1)
@pytest.mark.parametrize("method", ["DOP853", "taylor"])
def test_smooth_events_cost_no_further_rates(compiled, method):
    """A polynomial, of which nothing is looked at, takes the same."""
    plan = compiled["oscillator"], (1.0, 0.0), (0, 50.0)
    plain, wavy = (zeros_of(*plan, e, method) for e in (x - v / 3, sp.sin(x) - sp.exp(v) / 9))
    assert (plain.nfev, plain.steps, plain.rejected) == (wavy.nfev, wavy.steps, wavy.rejected)


@pytest.mark.sparse(1)
@pytest.mark.parametrize("method", ["DOP853", "taylor"])
def test_a_pole_is_reported(compiled, method):
    run = zeros_of(compiled["straight"], (0.0, 0.0), (0, 100.0), 1 / (x - 77) + 1, method)
    assert run.status == 0
    assert "events vary too quickly, or are not finite, at t = 77 s" in run.notice
    assert np.min(np.abs(run.events["e"].t - 76)) < 1e-9


def test_what_has_no_bounds_is_reported(compiled):
    curve = eom.Table("curve", [-2.0, 0.0, 2.0], [-2.5, 0.0, 2.5], kind="pchip")
    run = zeros_of(compiled["oscillator"], (1.0, 0.0), (0, 6.0), curve(x) - 1, "DOP853")
    assert "event e has no bounds between values" in run.notice
    assert len(run.events["e"]) == 2


@pytest.mark.sparse(1)
@pytest.mark.parametrize("method", ["Tsit5", "taylor"])
def test_roots_and_low_powers_hide_nothing(compiled, method):
    events = {"root": sp.sqrt(x) - 2, "power": x ** sp.Rational(3, 2) - 8}
    plan = compiled["straight"], (0.0, 0.0), (0, 100.0), None, method, 1e-6
    run = codegen.simulate(*plan, events=events)
    assert run.notice == ""
    assert [e.t.tolist() for e in run.events.values()] == [
        pytest.approx([4.0], abs=1e-9),
        pytest.approx([4.0], abs=1e-9),
    ]


# --- the law ----------------------------------------------------------------------------------------


def test_whether_operations_keep_their_character_over_a_box(compiled):
    """An argument of sin may move by half the degree about its middle, one of exp where that is nothing."""
    one = compiled["oscillator"]
    for event, (low, high), expected in (
        (sp.sin(3 * x), (0.0, 3.3), True),
        (sp.sin(3 * x), (0.0, 3.4), False),
        (sp.exp(-(x**2)), (12.0, 1e4), True),
        (sp.exp(-(x**2)), (0.0, 1e4), False),
        (1 / x, (1.0, 6.9), True),
        (1 / x, (-1.0, 6.9), False),
        (x**3 - v * x, (-1e9, 1e9), True),
    ):
        program, _ = extended(one.program, one.layout, one, checked([event]))
        found = steady(program, program.results[crossings.GROUP][:1], 2, 10, crossings.FLAT)
        assert found.unbounded == ()
        if found.program is None:
            assert expected
            continue
        box = Point(x=[low, high, -1.0, 1.0, 0.0, 0.0])
        assert bool(interpret(found.program, box)["verdict"][0]) == expected, event


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", ["taylor", "dop853"])
def test_generated_files_with_such_events_compile_strictly(tmp_path, name, compiled):
    one = compiled["oscillator"]
    made = extended(one.program, one.layout, one, checked([sp.sin(40 * x), x]))
    for file, text in generate(*made, "c", written.Choice(name, 1e-9)).items():
        (tmp_path / file).write_text(text)
    sources = [str(tmp_path / f) for f in ("oscillator.c", f"oscillator_{name}.c")]
    strict = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1", "-c"]
    subprocess.run([*native.compiler(), *strict, *sources], check=True, cwd=tmp_path)
