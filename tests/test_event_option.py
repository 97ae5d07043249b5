"""The option --event of `eom simulate`: what it prints, writes and refuses."""

import numpy as np
import pytest
from click.testing import CliRunner

from codegen.native import native
from eom.__main__ import main

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="events are found in generated C")


def run(*words):
    return CliRunner().invoke(main, ["simulate", *map(str, words)], catch_exceptions=False)


@needs_compiler
def test_events_are_reported_and_saved(tmp_path):
    file = tmp_path / "run.csv"
    done = run("t-handle", "--event", "omega_2 rising", "--event", "omega_2", "--out", file)
    assert done.exit_code == 0, done.output
    text = " ".join(done.output.split())
    assert "event omega_2 rising 2, at t = 3.464" in text
    found = np.genfromtxt(tmp_path / "run.events.csv", delimiter=",", names=True)
    assert found.dtype.names[:4] == ("event", "direction", "t", "omega_1")
    assert (found["direction"][found["event"] == 1] == 1).all()
    assert (found["event"] == 1).sum() == 2
    assert set(found["t"][found["event"] == 1]) < set(found["t"][found["event"] == 2])
    assert (np.diff(found["t"]) >= 0).all()
    assert np.abs(found["omega_2"]).max() < 1e-14


@needs_compiler
def test_a_run_that_an_event_ends_has_status_0(tmp_path):
    file = tmp_path / "run.npz"
    done = run("t-handle", "--event", "omega_2 - 0.1 falling stop 2", "--out", file)
    assert done.exit_code == 0, done.output
    assert "stopped at t = 5.66" in done.output
    with np.load(file) as saved:
        assert saved["t"][-1] < 5.67
    time = run("t-handle", "--event", "t - 2.5 stop")
    assert "stopped at t = 2.5 s" in time.output
    assert "never" in run("t-handle", "--event", "omega_2 - 1e3").output


@needs_compiler
def test_without_events_no_table_of_them_is_written(tmp_path):
    run("t-handle", "--out", tmp_path / "run.csv")
    assert [f.name for f in tmp_path.iterdir()] == ["run.csv"]


BAD = {
    "unknown name": (["omega_9"], "unknown name 'omega_9'"),
    "no expression": ([" "], "no expression"),
    "direction alone": ([" rising stop"], "no expression"),
    "zero times": (["omega_1 stop 0"], "stop 0"),
    "no number": (["omega_1 stop soon"], "stop soon"),
    "no such word": (["omega_1 upwards"], "unexpected text after the formula"),
    "no such order": (["omega_1 stop rising"], "stop rising"),
    "half a formula": (["omega_1 - rising"], "a number, a name"),
    "twice": (["omega_1", "omega_1"], "two events have one name"),
    "branch": (["abs(omega_1) - 1"], "has a branch"),
    "constant": (["I1 - 2"], "does not vary"),
    "an equation": (["omega_1 = 2"], "cannot be read"),
}


@pytest.mark.parametrize("what", BAD)
def test_bad_events_give_one_clear_error(what, tmp_path):
    if what in {"branch", "constant"} and not native.compiler():
        pytest.skip("events are found in generated C")
    events, message = BAD[what]
    words = [word for text in events for word in ("--event", text)]
    done = run("t-handle", *words, "--out", tmp_path / "run.csv")
    assert done.exit_code == 2, done.output
    assert message in done.output
    assert done.output.count("error:") == 1
    assert not list(tmp_path.iterdir())


def test_methods_that_find_no_events_say_so():
    done = run("t-handle", "--event", "omega_1", "--method", "scipy:RK45")
    assert done.exit_code == 2
    assert "finds no events" in done.output


def test_help_says_how_events_are_spelt():
    text = " ".join(run("--help").output.split())
    assert "[rising|falling] [stop [N]]" in text
    assert "theta - 0.5 rising stop" in text
