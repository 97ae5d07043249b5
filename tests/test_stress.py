"""``eom stress``: each check in short form through the command line, and checks that are made to fail."""

import json
import math
import os
import time
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from codegen.closed.exact import free_motion
from codegen.integrate import methods
from codegen.measure.stress import checks, extremes, record, scenes
from codegen.measure.stress import extremes as single
from codegen.measure.stress import sweeps as memory
from codegen.measure.stress.angles import SEQUENCES, passage
from codegen.measure.stress.growth import fitted, turn_between
from codegen.measure.stress.record import ABSENT, FAIL, PASS, Figure, Findings, Plan, Size
from codegen.measure.stress.workers import Worker
from codegen.native import native
from codegen.runs import simulation
from eom import problems
from eom.__main__ import main
from eom.commands import stressing as random_scenes
from eom.mechanics.rigidbody import free_rigid_body
from eom.rotations import cosines

pytestmark = pytest.mark.shipped_flags("slow")
needs_compiler = pytest.mark.skipif(not native.compiler(), reason="methods in C")
SHORT = Size(
    "quick", 100, 4, (1e-4, 1e-8, 2.0**-52), 0.05, 0.5, 4, 2, 10_000, trials=10, apart=20, forms=40
)
BOTH = ("--method", "taylor", "--method", "DOP853")
FEW = ("forced-rigid-body", "damped-body")


@pytest.fixture
def run(monkeypatch):
    """The command line with all that is swept, but less of it."""
    names = problems.names
    monkeypatch.setattr(record, "SIZES", {**record.SIZES, "quick": SHORT})
    monkeypatch.setattr(problems, "names", lambda: [n for n in names() if n in (*FEW, "t-handle")])
    monkeypatch.setattr(extremes, "BODIES", extremes.BODIES[::3])
    runner = CliRunner()
    return lambda *words: runner.invoke(main, [str(w) for w in words], catch_exceptions=False)


def spoilt(monkeypatch, name, change):
    """Replace a method by one that changes its problem or its trajectory."""

    def prepare(task):
        integrator, used = row.prepare(task)
        return change(integrator), used

    row = next(r for r in methods.ROWS if r.name == name)
    changed = [replace(r, prepare=prepare) if r.name == name else r for r in methods.ROWS]
    monkeypatch.setattr(methods, "ROWS", tuple(changed))
    monkeypatch.setattr(simulation, "_kept", {})  # integrators, also those that were not changed
    monkeypatch.setattr(simulation, "KEPT", 0)


def wrong_step(integrator):
    """Ends a little off, as if a coefficient were wrong."""

    def integrate(problem):
        found = integrator(problem)
        growing = 1 + 1e-3 * np.linspace(0, 1, len(found.t))
        return replace(found, y=found.y * growing, state_at_stop=found.state_at_stop * (1 + 1e-3))

    return integrate


def deaf(integrator):
    """Takes no notice of the tolerance."""
    return lambda problem: integrator(replace(problem, rtol=1e-2, atol=1e-2 + 0 * problem.atol))


# --- the table --------------------------------------------------------------------------------------


@pytest.mark.sparse(only=("closed-forms",))
@needs_compiler
@pytest.mark.parametrize("name", [n for n in checks.NAMES if n != "long-run"])
def test_every_check_passes(run, tmp_path, name):
    methods = () if name == "accuracy-estimate" else BOTH  # each trial has a method of its own
    done = run("stress", name, "--quick", *methods, "--out", tmp_path, "--seed", 3)
    assert done.exit_code == 0, done.output
    assert {f.name for f in tmp_path.iterdir()} == {"stress.json", "stress.txt"}
    assert (tmp_path / "stress.txt").read_text().strip() in done.stdout
    data = json.loads((tmp_path / "stress.json").read_text())
    assert data["passed"] is True
    assert data["plan"]["seed"] == 3
    assert not methods or data["plan"]["methods"] == ["DOP853", "taylor"]
    assert data["machine"]["compiler"]
    (found,) = data["checks"]
    words = (
        "name",
        "states",
        "bound",
        "measured",
        "source",
        "verdict",
        "seconds",
        "figures",
        "absent",
    )
    assert set(found) == set(words)
    assert found["verdict"] == PASS
    assert all(f["passed"] for f in found["figures"])
    assert any(f["bound"] is not None for f in found["figures"])


@pytest.mark.slow
@needs_compiler
def test_rounding_errors_of_taylor_are_a_random_walk(monkeypatch):
    size = replace(record.SIZES["quick"], limit=0.01)
    monkeypatch.setattr(record, "SIZES", {"quick": size})
    done = CliRunner().invoke(main, ["stress", "long-run", "--quick", "--method", "taylor"])
    assert done.exit_code == 0, done.output


@pytest.mark.slow
@needs_compiler
def test_long_run_reports_exponents_with_error_bars(run):
    done = run("stress", "long-run", "--quick", *BOTH)
    assert "long-run" in done.stdout
    assert "DOP853: largest error of a constant" in done.stdout
    assert "no verdict" in done.stdout


def test_help_and_list_of_checks(run):
    text = run("stress", "--help").output
    assert all(name in text for name in checks.NAMES)
    assert "stress" in run("--help").output
    for check in checks.CHECKS:
        assert all((check.states, check.bound, check.measured, check.source))


@pytest.mark.slow
def test_lost_accuracy_is_reported(run):
    done = run("stress", "extreme-bodies", "--quick", "--method", "taylor")
    if native.compiler():
        assert "may cost" in done.stdout


def test_nothing_measured_is_no_pass():
    assert Findings(()).verdict == ABSENT
    assert Findings((Figure("reported", 1.0),)).verdict == ABSENT
    assert Findings((Figure("held", 1.0, 2.0), Figure("nan", math.nan, 2.0))).verdict == FAIL


# --- checks that are made to fail ------------------------------------------------------------------


@pytest.mark.sparse(only=("near-singular-angles",))
@needs_compiler
@pytest.mark.parametrize(
    "name", ["extreme-bodies", "near-singular-angles", "tolerances", "there-and-back"]
)
def test_a_wrong_step_is_found(run, monkeypatch, name):
    spoilt(monkeypatch, "taylor", wrong_step)
    done = run("stress", name, "--quick", "--method", "taylor")
    assert done.exit_code == 1
    assert f"{name}: FAIL: " in done.stdout


@pytest.mark.sparse(only=("tolerances",))
@needs_compiler
@pytest.mark.parametrize("name", ["extreme-bodies", "tolerances"])
def test_a_tolerance_that_is_not_kept_is_found(run, monkeypatch, name):
    spoilt(monkeypatch, "DOP853", deaf)
    done = run("stress", name, "--quick", "--method", "DOP853")
    assert done.exit_code == 1
    assert "FAIL" in done.stdout


@pytest.mark.slow
@needs_compiler
def test_too_large_errors_of_single_precision_are_found(run, monkeypatch):
    call = single._Single.__call__
    monkeypatch.setattr(single._Single, "__call__", lambda *a: call(*a) * (1 + 2.0**-16))
    assert run("stress", "single-precision", "--quick").exit_code == 1


def job(number, *names):
    return scenes.Job(random_scenes.draw_scene, 0, number, 3, names)


@needs_compiler
def test_methods_that_disagree_and_hidden_failures_are_found(monkeypatch):
    spoilt(monkeypatch, "taylor", wrong_step)
    verdict = scenes.examine(job(0, "DOP853", "taylor"))
    assert verdict.apart > 1
    assert verdict.drift > 1
    spoilt(monkeypatch, "DOP853", lambda f: lambda p: replace(f(p), y=f(p).y * math.nan))
    assert scenes.examine(job(0, "DOP853", "taylor")).silent == ["DOP853: NaN without a message"]


def leaky(asked):
    """Measure a method that keeps every step; called in another process."""
    (row,) = (r for r in methods.ROWS if r.name == "DOP853")

    def prepare(task):
        integrator, used = row.prepare(task)
        return lambda p: integrator(replace(p, t_eval=None)), used

    methods.ROWS = (replace(row, prepare=prepare),)
    return memory.use(asked)


@pytest.mark.slow
@needs_compiler
def test_memory_that_grows_with_the_steps_is_found():
    body = free_rigid_body("quaternion")
    with Worker(leaky) as worker:
        answer = worker.ask(memory.Job(body, "DOP853", 200_000), 120)
    growth, stored = memory._figures("DOP853", answer.value)
    assert not growth.passed
    assert growth.value > 10
    assert not stored.passed


@needs_compiler
def test_a_short_run_stores_what_is_asked_for_alone():
    body = free_rigid_body("quaternion")
    found = memory.use(memory.Job(body, "DOP853", 2000))
    assert found.steps >= 2000
    assert all(figure.passed for figure in memory._figures("DOP853", found))


def stubborn(asked):
    """What a piece of work may do."""
    if asked == "hang":
        time.sleep(600)
    if asked == "crash":
        os._exit(3)
    if asked == "raise":
        raise ValueError(asked)
    return asked


@pytest.mark.slow
def test_hangs_crashes_and_exceptions_are_reported_and_the_next_one_is_answered():
    with Worker(stubborn) as worker:
        assert worker.ask("fine", 60).value == "fine"
        assert worker.ask("raise", 60).trouble == "ValueError: raise"
        assert worker.ask("crash", 60).trouble == "the process died (exit code 3)"
        assert worker.ask("hang", 0.2).trouble == "no answer within 0.2 s"
        assert worker.ask("again", 60).value == "again"


# --- what the checks stand on -----------------------------------------------------------------------


@pytest.mark.parametrize("law", [0.5, 1.0, 1.5])
def test_exponents_of_known_growth(law):
    draw = np.random.default_rng(1)
    n = np.logspace(2, 6, 41)
    walks = np.cumsum(draw.standard_normal((24, 41)) * np.sqrt(np.diff(n, prepend=0.0)), axis=1)
    errors = 1e-15 * (walks if law == 0.5 else np.outer(1 + 0.1 * draw.standard_normal(24), n**law))
    fit = fitted(n, errors, 0)
    assert abs(fit.exponent - law) <= fit.bar + 1e-9
    assert fit.bar < 0.2
    assert fitted(n, np.full_like(errors, 1e-17), 0) is None


@pytest.mark.parametrize("name", SEQUENCES)
@pytest.mark.parametrize("distance", [1e-1, 1e-10])
def test_passages_come_as_near_as_they_say(name, distance):
    sequence = SEQUENCES[name]
    way = passage(sequence, distance)
    q = sequence.quaternion(way.start[3:])
    assert np.allclose(sequence.angles(np.array(cosines(q))), way.start[3:], atol=1e-15)
    close = free_motion((1, 2, 3), way.start[:3], q)(np.linspace(0.9, 1.1, 2001))[1]
    second = np.array([sequence.angles(np.array(cosines(c)))[1] for c in close.T])
    near = np.abs(second - sequence.singular).min()
    assert near == pytest.approx(distance, rel=1e-2, abs=1e-14)
    assert float(turn_between(-close, close).max()) < 1e-14


def test_random_scenes_are_the_same_each_time_and_of_many_kinds():
    first, again = (random_scenes.description(5, 17, 10) for _ in range(2))
    assert first == again
    assert first != random_scenes.description(6, 17, 10)
    kinds = [random_scenes.kind(0, k) for k in range(30)]
    assert {k.attitude for k in kinds} == set(random_scenes.ATTITUDES)
    assert {k.torque for k in kinds} == set(random_scenes.SPECIAL)
    assert {t for k in kinds for row in k.terms for t in row} == set(random_scenes.TERMS)
    omegas = [random_scenes.description(0, n, 30)["initial"] for n in range(60)]
    assert any(not any(w.values()) for w in omegas)


def test_the_closed_form_shows_what_a_step_costs():
    """On the separatrix errors grow exponentially, about a stable axis they do not."""
    rows = {b.name: b for b in extremes.BODIES}
    tame = extremes.reference(rows["1e-14 from a stable axis"]).per_step(1e-12)
    wild = extremes.reference(rows["on the separatrix, 20 turns"]).per_step(1e-12)
    assert tame < 1e-9
    assert wild > 1e-2


BAD = {
    "unknown check": (["long-rum"], "did you mean long-run?"),
    "unknown method": (["memory", "--method", "DOP583"], "did you mean DOP853"),
    "both sizes": (["memory", "--quick", "--full"], "exclude each other"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_clear_error_before_anything_runs(run, case, tmp_path):
    words, expected = BAD[case]
    done = run("stress", *words, "--out", tmp_path / "x")
    assert done.exit_code == 2
    assert done.stderr.count("error: ") == 1
    assert expected in done.stderr
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_found_before_anything_runs(run, tmp_path):
    (tmp_path / "file").write_text("in the way")
    done = run("stress", "--quick", "--out", tmp_path / "file" / "below")
    assert done.exit_code == 2
    assert "a folder is needed, and this is a file" in done.stderr
    assert done.stdout == ""


def test_plans_name_their_methods_in_the_order_of_the_table():
    assert record.methods_of(("taylor", "DOP853")) == ("DOP853", "taylor")
    assert record.methods_of(()) == methods.METHODS
    assert Plan(SHORT).applicable(("taylor", "nothing")) == ["taylor"]
