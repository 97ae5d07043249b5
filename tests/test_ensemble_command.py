"""The command line for many trajectories: the library's numbers, files, errors that help."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner

import codegen
import eom
from codegen import Normal, Sampler, Statistics, Uniform
from codegen.ensembles import ensemble as memory
from codegen.ensembles.ensemble import size_of_one
from codegen.native import native
from eom.__main__ import main
from eom.scenes import catalogue

pytestmark = pytest.mark.skipif(not native.compiler(), reason="runs C")
VARY = ["--vary", "omega_1=normal(0.05, 0.01)", "--vary", "I2=uniform(3.9e-4, 4.1e-4)"]
SOME = ["t-handle", *VARY, "--count", 700, "--seed", 5, "--t-end", 2, "--rtol", 1e-7]


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(
        main, ["ensemble", *map(str, words)], catch_exceptions=False
    )


def test_numbers_are_those_of_the_library(run):
    """The same distributions written in Python; each number of the statistics to the last bit."""
    shares = [0.1, 0.5]
    done = run(*SOME, "--points", 4, "--quantiles", "0.1,0.5", "--json", "--threads", 1)
    assert done.exit_code == 0, done.output
    reported = json.loads(done.stdout)
    scene = eom.Scene.ready("t-handle")
    varied = {"omega_1": Normal(0.05, 0.01), "I2": Uniform(3.9e-4, 4.1e-4)}
    sampler = Sampler({**varied, "omega_2": 10.0, "omega_3": 0.05}, 700, 5)
    parameters = {k: v for k, v in scene.parameter_values().items() if k != "I2"}
    names = ("omega_1", "omega_2", "omega_3")
    found = codegen.ensemble(
        scene.derive(), sampler, (0, 2), parameters, rtol=1e-7, t_eval=[0.5, 1.0, 1.5, 2.0],
        statistics=Statistics(names, quantiles=True), keep=False,
    )  # fmt: skip
    assert (reported["count"], reported["seed"], reported["ends"]) == (700, 5, {"end": 700})
    assert (reported["t"], reported["steps"]) == (found.t.tolist(), found.steps)
    assert set(reported["statistics"]) == set(names)
    for name, summary in found.statistics.items():
        columns = reported["statistics"][name]
        assert columns["mean"] == summary.mean.tolist()
        assert columns["deviation"] == summary.deviation.tolist()
        assert (columns["least"], columns["greatest"]) == (
            summary.minimum.tolist(),
            summary.maximum.tolist(),
        )
        for k, share in enumerate(shares):
            assert columns[f"{share:g}"] == summary.quantile(shares)[:, k].tolist()
    assert reported["drift"]["H"] == found.drift["H"].maximum[0] < 1e-6


def test_a_file_of_distributions_says_the_same_and_options_come_first(run, tmp_path):
    file = tmp_path / "samples.toml"
    file.write_text(
        'count = 700\nseed = 1\n[vary]\nomega_1 = "normal(0.05, 0.01)"\n'
        'I2 = "uniform(3.9e-4, 4.1e-4)"\nomega_3 = 0.05\n'
    )
    words = ["--t-end", 2, "--rtol", 1e-7, "--json"]
    by_file = json.loads(run("t-handle", "--samples", file, "--seed", 5, *words).stdout)
    by_options = json.loads(run(*SOME, "--json").stdout)
    assert by_file["statistics"] == by_options["statistics"]
    less = run("t-handle", "--samples", file, "--count", 3, "--vary", "omega_1=0.1", *words)
    reported = json.loads(less.stdout)
    assert (reported["count"], reported["seed"], reported["vary"]["omega_1"]) == (3, 1, "0.1")


def test_the_table_says_how_trajectories_ended_and_grids_are_crossed(run):
    words = ["--vary", "g=grid(5, 10, 3)", "--vary", "omega_3=grid(10, 20, 4)"]
    done = run("heavy-top", *words, "--statistics", "tilt,q0", "--t-end", 1, "--points", 2)
    assert done.exit_code == 0, done.output
    assert "12: 12 end" in done.output
    assert "drift of H_3" in done.output
    rows = [line.split() for line in done.output.splitlines() if line.startswith(("tilt", "q0"))]
    assert [row[:3] for row in rows] == [
        [name, t, "12"] for name in ("tilt", "q0") for t in ("0.5", "1")
    ]
    assert all(math.isfinite(float(v)) for row in rows for v in row[3:])


def test_attitudes_are_drawn_as_rotations(run):
    done = run(
        "heavy-top", "--vary", "q0,q1,q2,q3=attitude()", "--count", 300, "--json", "--t-end", 0.1
    )
    reported = json.loads(done.stdout)
    assert reported["drift"]["q_norm"] < 1e-9
    assert reported["statistics"]["q1"]["deviation"][0] == pytest.approx(0.5, abs=0.05)


@pytest.mark.slow
def test_a_trajectory_that_stops_early_is_counted_and_reported(run, tmp_path):
    """At a singular angle from the start."""
    words = ["--vary", "theta=grid(1.0, 1.5707963267948966, 2)", "--t-end", 0.01]
    ready = catalogue.path_of("t-handle-in-angles").read_text()
    file = tmp_path / "angles.toml"
    file.write_text(ready.replace('integrate = "quaternion"', ""))
    done = run(file, *words, "--json")
    assert done.exit_code == 1
    reported = json.loads(done.stdout)
    assert reported["ends"] == {"end": 1, "singular": 1}
    assert reported["stopped"] == [[1, 1]]
    assert reported["statistics"]["theta"]["count"] == [1]
    assert reported["statistics"]["theta"]["deviation"] == [None]


def test_a_store_is_read_again_and_holds_the_trajectories(run, tmp_path):
    zarr = pytest.importorskip("zarr")
    words = [*SOME, "--chunk", 256, "--out", tmp_path / "runs", "--json"]
    first, again = (json.loads(run(*words).stdout) for _ in range(2))
    assert first == again
    assert first["store"] == str(tmp_path / "runs")
    y = zarr.open_group(tmp_path / "runs" / "data.zarr", mode="r")["y"][:]
    assert y.shape == (3, 1, 700)
    mean = first["statistics"]["omega_1"]["mean"][0]
    assert np.mean(y[0, 0]) == pytest.approx(mean, rel=1e-12)
    assert json.loads(run(*SOME, "--json").stdout)["statistics"] == first["statistics"]
    other = run(*SOME[:-2], "--rtol", 1e-8, "--chunk", 256, "--out", tmp_path / "runs")
    assert other.exit_code == 2
    assert "another ensemble" in other.stderr


def test_what_is_stored_is_reported_before_the_run_and_what_does_not_fit_is_refused(
    run, tmp_path, monkeypatch
):
    words = ["t-handle", *VARY, "--t-end", 2, "--count"]
    monkeypatch.setattr(memory, "available", lambda: 1e7)
    done = run(*words, 300, "--out", tmp_path / "runs")
    each = size_of_one(codegen.compile(eom.Scene.ready("t-handle").derive()), 1)
    assert f"note: 300 trajectories, {300 * each:,} bytes, go to {tmp_path}" in done.stderr
    assert "bytes" not in run(*words, 300).stderr
    for further in (["--chunk", 10**6], ["--points", 10**5], ["--threads", 10**4]):
        done = run(*words, 10**9, *further)
        assert (done.exit_code, done.stderr.count("error: ")) == (2, 1)
        assert "do not fit into memory" in done.stderr


def test_a_cluster_gives_the_same_numbers(run):
    distributed = pytest.importorskip("distributed")
    quiet = {"dashboard_address": None, "silence_logs": 50}
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, protocol="tcp", **quiet
    ) as cluster:
        done = run(*SOME, "--chunk", 256, "--cluster", cluster.scheduler_address, "--json")
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout) == json.loads(run(*SOME, "--json").stdout)


BAD = {
    "nothing varies": ([], "nothing varies"),
    "no count": (["--vary", "omega_1=normal(0,1)"], "how many trajectories?"),
    "no equals": (["--vary", "omega_1"], "nothing to vary by"),
    "twice": (["--vary", "omega_1=1", "--vary", "omega_1=2"], "omega_1 is varied twice"),
    "word": (["--vary", "omega_1=gauss(0,1)", "--count", "3"], "unknown distribution 'gauss'"),
    "numbers": (["--vary", "omega_1=normal(0)", "--count", "3"], "normal(MEAN, DEVIATION)"),
    "name": (["--vary", "omega_4=normal(0,1)", "--count", "3"], "unknown state or parameter 'omega_4'"),
    "count": (["--vary", "omega_1=normal(0,1)", "--count", "-3"], "count is not a whole number"),
    "shares": (["--vary", "omega_1=1", "--count", "3", "--quantiles", "5"], "numbers from 0 to 1"),
    "no shares": (["--vary", "omega_1=1", "--count", "3", "--quantiles", "a,b"], "numbers from 0 to 1"),
    "points": (["--vary", "omega_1=1", "--count", "3", "--points", "0"], "number of times does not fit"),
    "statistics": (["--vary", "omega_1=1", "--count", "3", "--statistics", "x"], "unknown state"),
    "method": (["--vary", "omega_1=1", "--count", "3", "--method", "x"], "method"),
    "threads": (["--vary", "omega_1=1", "--count", "3", "--threads", "0"], "threads is not a positive"),
    "file": (["--samples", "BROKEN"], "not a TOML file"),
    "entry": (["--samples", "ENTRY"], "unknown entry 'vry'"),
    "table": (["--samples", "TABLE"], "not a table"),
}  # fmt: skip
FILES = {"BROKEN": "count = \n", "ENTRY": "[vry]\nomega_1 = 1\n", "TABLE": "vary = 3\n"}


@pytest.mark.parametrize("case", BAD)
def test_what_does_not_go_is_one_clear_error(run, case, tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    words, expected = BAD[case]
    out = tmp_path / "out"
    done = run("t-handle", *(tmp_path / w if w in FILES else w for w in words), "--out", out)
    assert (done.exit_code, done.stderr.count("error: ")) == (2, 1)
    assert expected in done.stderr
    assert not out.exists()


def test_samples_that_no_body_has_are_refused(run):
    done = run("t-handle", "--vary", "I1=uniform(-2, -1)", "--count", 3)
    assert (done.exit_code, done.stderr.count("error: ")) == (2, 1)
    assert "I1" in done.stderr


def test_one_component_of_an_attitude_does_not_vary_alone(run):
    done = run("heavy-top", "--vary", "q0=normal(0,1)", "--count", 3)
    assert done.exit_code == 2
    assert "q0,q1,q2,q3=attitude()" in done.stderr


def test_a_cluster_that_is_not_there_is_one_clear_error(run):
    pytest.importorskip("distributed")
    done = run(*SOME, "--cluster", "nowhere")
    assert (done.exit_code, done.stderr.count("error: ")) == (2, 1)
    assert "tcp://HOST:PORT" in done.stderr


TREE = """\
model = "tree"
gravity = [0, 0, -9.81]
[bodies.arm]
mass = 2.0
centre = [0, 0, -0.4]
moments = [0.1, 0.1, 0.004]
[joints.ball]
kind = "spherical"
parent = "ground"
child = "arm"
angles = "3-2-1"
[initial_attitude.ball]
sequence = "3-2-1"
radians = [0.3, 0.2, 0.1]
"""


def test_angles_of_a_joint_vary_in_the_place_of_its_quaternion(run, tmp_path):
    """Of a tree as of one body: those that do not vary keep their start."""
    file = tmp_path / "ball.toml"
    file.write_text(TREE, encoding="utf-8")
    angles = [f"q_ball_{k}" for k in (1, 2, 3)]
    reported = run(file, "--vary", "q_ball_2=grid(0.1, 0.3, 3)", "--t-end", 1e-9, "--json",
               "--statistics", ",".join(angles))  # fmt: skip
    assert reported.exit_code == 0, reported.output
    found = json.loads(reported.stdout)["statistics"]
    means = [found[n]["mean"][-1] for n in angles]
    assert means == pytest.approx([0.3, 0.2, 0.1], abs=1e-7)
