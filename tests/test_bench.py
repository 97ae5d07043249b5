"""``eom bench``, as a user meets it."""

import importlib.util
import json

import pytest
from click.testing import CliRunner

from eom import problems
from eom.__main__ import main
from eom.commands import benching, first
from eom.views.draw import saving

METHODS = "DOP853,solve_ivp:LSODA"


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(main, [str(w) for w in words], catch_exceptions=False)


@pytest.fixture
def no_first_results(monkeypatch):
    monkeypatch.setattr(benching, "_first_results", lambda *_: {})


@pytest.mark.slow
def test_table_picture_and_data(run, tmp_path):
    pytest.importorskip("matplotlib")
    words = ["bench", "forced-rigid-body", "--quick", "--methods", METHODS, "--seed", 5]
    done = run(*words, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    for word in ("DOP853", "solve_ivp:LSODA", "error", "reference: Taylor", "first result, cached"):
        assert word in done.stdout
    files = {f.name for f in (tmp_path / "out").iterdir()}
    assert files == {f"forced-rigid-body.{kind}" for kind in ("json", "txt", "png")}
    assert (tmp_path / "out" / "forced-rigid-body.txt").read_text().strip() in done.stdout
    data = json.loads((tmp_path / "out" / "forced-rigid-body.json").read_text())
    assert set(data) == {
        "schema", "problem", "reference", "plan", "points", "absent", "comparisons",
        "machine", "date", "source", "closed", "first_result",
    }  # fmt: skip
    assert data["plan"]["seed"] == 5
    assert data["machine"]["compiler"]
    assert data["machine"]["numpy"][0].isdigit()
    assert {p["program"] for p in data["points"]} == set(METHODS.split(","))
    for p in data["points"]:
        assert set(p) == {"program", "rtol", "error", "known", "seconds", "median", "runs", "steps"}
    timed = data["first_result"]
    assert set(timed) == {"uncached", "cached"}
    assert {"import", "derive", "generate and compile", "integrate"} <= set(timed["cached"])
    assert "heyoka: compile" not in timed["cached"], "it was not asked for"


def test_a_first_result_is_timed_by_its_stages():
    laps = first.stages("forced-rigid-body", "none")
    names = ("import", "derive", "generate and compile", "the method's code", "integrate")
    assert tuple(laps) == names
    assert all(0 <= seconds < 100 for seconds in laps.values())


def test_scenes_and_scene_files_are_problems(run, tmp_path, no_first_results):
    file = tmp_path / "mine.toml"
    file.write_text(
        'outputs = ["omega_1"]\n[body]\nmoments = [1.0, 2.0, 2.5]\n'
        "[initial]\nomega_1 = 1\nomega_2 = 0.1\nomega_3 = 0\n[integration]\nt_end = 2.0\n"
    )
    done = run("bench", file, "t-handle", "t-handle", "--quick", "--methods", "DOP853")
    assert done.exit_code == 0, done.output
    assert done.stdout.count("reference: ") == 2
    assert "mine: " in done.stdout


@pytest.mark.parametrize("name", ["forced-rigid-body", "t-handle"])
def test_other_values_and_another_end_are_measured(run, no_first_results, name):
    state = {"forced-rigid-body": "y2", "t-handle": "omega_2"}[name]
    words = ["bench", name, "--quick", "--methods", "dop853", "--json"]
    done = run(*words, "--set", f"{state}=0.25", "--t-end", "0.001 min")
    assert done.exit_code == 0, done.output
    problem = json.loads(done.stdout)["problems"][0]["problem"]
    assert problem["start"][state] == 0.25
    assert problem["end"] == 0.06


def test_a_first_result_is_that_of_the_changed_problem(monkeypatch):
    asked = []
    monkeypatch.setattr(problems, "ready", lambda *given: asked.append(given) or READY)
    first.stages("forced-rigid-body", "none", '[{"y1": "0.5"}, 0.1]')
    assert asked == [("forced-rigid-body", {"y1": "0.5"}, 0.1)]


READY = problems.ready("forced-rigid-body", {"y1": 0.5}, 0.1)


def test_help_lists_the_problems(run):
    text = run("bench", "--help").output
    assert all(name in text for name in problems.names())
    assert "bench" in run("--help").output


def without(monkeypatch, module):
    find = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda n, *a: None if n == module else find(n, *a)
    )


def test_absent_matplotlib_leaves_table_and_data(run, tmp_path, monkeypatch, no_first_results):
    without(monkeypatch, "matplotlib")
    assert not saving.can_write("picture.png")
    words = ["bench", "t-handle", "--quick", "--methods", "DOP853", "--out", tmp_path]
    done = run(*words)
    assert done.exit_code == 0
    assert "no picture" in done.stderr
    assert {f.suffix for f in tmp_path.iterdir()} == {".json", ".txt"}


def test_absent_heyoka_is_said(run, monkeypatch, no_first_results):
    without(monkeypatch, "heyoka")
    done = run("bench", "t-handle", "--quick", "--methods", "DOP853,heyoka")
    assert done.exit_code == 0
    assert "heyoka: not from rtol 1e-04: heyoka is not installed" in done.stdout


BAD = {
    "no problem": (["bench"], "--all"),
    "unknown problem": (["bench", "detest-b6"], "did you mean detest-b5?"),
    "unknown file": (["bench", "missing.toml"], "no such scene file"),
    "unknown method": (["bench", "t-handle", "--methods", "DOP583"], "did you mean DOP853"),
    "unknown value": (["bench", "detest-b5", "--set", "y4=1"], "known names: y1, y2, y3"),
    "no number": (["bench", "detest-b5", "--set", "y1=much"], "unknown name 'much'"),
    "no time": (["bench", "detest-b5", "--t-end", "-1"], "the end time is not positive"),
    "no words of a time": (["bench", "detest-b5", "--t-end", "soon"], "'soon' is no time"),
    "value of a scene": (["bench", "t-handle", "--set", "I9=1"], "t-handle: --set: I9"),
    "second problem unknown": (["bench", "t-handle", "heavy-tap"], "did you mean heavy-top"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_clear_error_before_anything_runs(run, case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words, expected = BAD[case]
    done = run(*words)
    assert done.exit_code == 2
    assert done.stderr.casefold().count("error: ") == 1
    assert expected in done.stderr
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_found_before_anything_runs(run, tmp_path):
    (tmp_path / "file").write_text("in the way")
    done = run("bench", "t-handle", "--quick", "--out", tmp_path / "file" / "below")
    assert done.exit_code == 2
    assert "a folder is needed, and this is a file" in done.stderr
    assert done.stdout == ""


def test_a_first_result_that_fails_is_said(run, tmp_path, monkeypatch):
    broken = tmp_path / "python"
    broken.write_text("#!/bin/sh\necho 'out of order' >&2\nexit 3\n")
    broken.chmod(0o755)
    monkeypatch.setattr(benching.sys, "executable", str(broken))
    done = run("bench", "t-handle", "--quick", "--methods", "DOP853")
    assert done.exit_code == 0
    assert "no time to a first result: out of order" in done.stderr
    assert "first result" not in done.stdout
