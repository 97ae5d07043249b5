"""The command line where angles are handed over, and where a motion is written in closed form."""

import subprocess

import numpy as np
import pytest
from click.testing import CliRunner

from codegen.native import native
from eom.__main__ import main

TUMBLING = """
title = "T-handle in 3-2-1 angles"
attitude = "3-2-1"
outputs = ["psi", "theta", "phi", "H"]

[body]
moments = [1.5e-4, 4.0e-4, 5.2e-4]

[initial]
omega_1 = 0.05
omega_2 = 10.0
omega_3 = 0.05

[initial_attitude]
sequence = "3-2-1"
degrees = [0.0, 0.0, 0.0]

[integration]
t_end = 1.0
points = 20
"""
needs_compiler = pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(main, [str(w) for w in words], catch_exceptions=False)


@pytest.fixture
def scene(tmp_path):
    """A scene that asks for hand-over, and one that does not."""
    with_it, without = tmp_path / "tumbling.toml", tmp_path / "angles.toml"
    with_it.write_text(f"{TUMBLING}handover = true\n")
    without.write_text(TUMBLING)
    return {True: with_it, False: without}


def rows_of(done):
    """The closing table by its first column."""
    lines = [line for line in done.output.splitlines() if "  " in line]
    return {key.strip(): value.strip() for key, _, value in (w.partition("  ") for w in lines)}


def columns(file):
    with np.load(file) as saved:
        return {name: saved[name] for name in saved.files}


@pytest.mark.slow
def test_simulate_hands_over_where_the_scene_or_the_option_says_so(run, scene, tmp_path):
    words = ["--target", "python", "--method", "DOP853", "--out", tmp_path / "run.npz"]
    picture = tmp_path / "run.png"
    done = run("simulate", scene[True], *words, "--plot", picture)
    asked = columns(tmp_path / "run.npz")
    assert done.exit_code == 0, done.output
    assert rows_of(done)["changes of chart"].startswith("6, at t = 0.147081, 0.177201, ")
    assert {"drift of T", "drift of H_3", "singularity margin"} <= set(rows_of(done))
    assert set(asked) == {"t", "omega_1", "omega_2", "omega_3", "psi", "theta", "phi", "H"}
    assert picture.read_bytes().startswith(b"\x89PNG")
    by_option = run("simulate", scene[False], *words, "--handover")
    assert rows_of(by_option)["changes of chart"] == rows_of(done)["changes of chart"]
    given = columns(tmp_path / "run.npz")
    assert all(np.array_equal(given[n], asked[n]) for n in asked)
    alone = run("simulate", scene[True], *words, "--no-handover")
    assert "changes of chart" not in rows_of(alone)
    angles = columns(tmp_path / "run.npz")
    for name in ("theta", "psi", "phi"):
        np.testing.assert_allclose(angles[name], asked[name], rtol=0, atol=1e-4)


def test_a_run_far_from_singular_angles_says_that_nothing_changed(run, scene):
    done = run("simulate", scene[True], "--target", "python", "--t-end", 0.1)
    assert rows_of(done)["changes of chart"] == "none"


@pytest.mark.slow
def test_the_ready_scene_turns_through_singular_angles(run, tmp_path):
    """The same angles as without hand-over, where they turn as fast as the body is near."""
    found = {}
    for word in ("--handover", "--no-handover"):
        done = run("simulate", "t-handle-in-angles", word, "--out", tmp_path / "run.npz")
        assert done.exit_code == 0, done.output
        found[word] = columns(tmp_path / "run.npz"), rows_of(done)
    by_default = run("simulate", "t-handle-in-angles")
    assert rows_of(by_default)["changes of chart"].startswith("18, at t = ")
    assert "changes of chart" not in found["--no-handover"][1]
    one, other = (columns for columns, _ in found.values())
    assert np.ptp(one["psi"]) > 12
    for name in ("psi", "theta", "phi"):
        np.testing.assert_allclose(one[name], other[name], rtol=0, atol=1e-5)


@pytest.mark.slow
def test_run_writes_both_charts(run, scene, tmp_path):
    done = run("run", scene[True], "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    names = {f.name for f in (tmp_path / "out").iterdir()}
    assert {"trajectory.npz", "trajectory.png"} <= names
    code = (
        {"tumbling_handover.c", "tumbling_quaternion.c"} if native.compiler() else {"tumbling.py"}
    )
    assert code <= names
    assert "changes of chart" in rows_of(done)
    modules = run("run", scene[False], "--handover", "--target", "numpy", "--out", tmp_path / "np")
    assert modules.exit_code == 0, modules.output
    written = {f.name for f in (tmp_path / "np").iterdir()}
    assert {"angles.py", "angles_quaternion.py", "angles_forth.py"} <= written


def test_generate_writes_the_same_files_with_hand_over_each_time(run, scene, tmp_path):
    for folder, words in {"a": [scene[True]], "b": [scene[True], "--target", "c"]}.items():
        assert run("generate", *words, "--out", tmp_path / folder).exit_code == 0
    first, second = ({f.name: f.read_bytes() for f in (tmp_path / n).iterdir()} for n in "ab")
    assert first == second
    assert {"tumbling_handover.h", "tumbling_handover.c", "tumbling_dop853.c"} <= set(first)
    run("generate", scene[True], "--no-handover", "--out", tmp_path / "one")
    assert not (tmp_path / "one" / "tumbling_handover.c").exists()


def test_generate_writes_hand_over_with_the_integrator_that_is_asked_for(run, scene, tmp_path):
    order = {}
    for rtol in (1e-6, 1e-12):
        words = ["--integrator", "taylor", "--rtol", rtol, "--out", tmp_path / str(rtol)]
        done = run("generate", scene[True], *words)
        assert done.exit_code == 0, done.output
        texts = {f.name: f.read_text() for f in (tmp_path / str(rtol)).iterdir()}
        assert {"tumbling_taylor.c", "tumbling_quaternion_taylor.c"} <= set(texts)
        assert '#include "tumbling_taylor.h"' in texts["tumbling_handover.h"]
        assert not any("dop853" in name for name in texts)
        order[rtol] = texts["tumbling_taylor.h"].partition("of order ")[2].split()[0]
    assert int(order[1e-6]) + 5 < int(order[1e-12])


BAD = {
    "no angles": (["simulate", "t-handle", "--handover"], "only Euler angles are handed over"),
    "a quaternion": (["run", "heavy-top", "--handover", "--out", "x"], "only Euler angles"),
    "code of a quaternion": (["generate", "heavy-top", "--handover", "--out", "x"], "Euler angles"),
    "an angle is missing": (["simulate", "bicycle-wheel", "--handover"], "initial value: phi"),
    "projection": (["simulate", "SCENE", "--project", "T"], "not projected where angles"),
    "module": (["generate", "SCENE", "--target", "numpy", "--out", "x"], "--target does not go"),
    "derivatives": (["generate", "SCENE", "--jacobian", "states", "--out", "x"], "--jacobian does"),
    "no integrator": (["generate", "SCENE", "--integrator", "none", "--out", "x"], "needs an integrator"),
    "no closed form": (["generate", "bicycle-wheel", "--closed-form", "--out", "x"], "no closed form"),
    "closed form, fixed": (["generate", "t-handle", "--closed-form", "--fixed", "--out", "x"], "--fixed"),
    "closed form, nowhere": (["generate", "t-handle", "--closed-form"], "--out FOLDER"),
}  # fmt: skip


@pytest.mark.sparse(3)
@pytest.mark.parametrize("case", BAD)
def test_what_does_not_go_together_is_one_clear_error(run, scene, case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    before = set(tmp_path.iterdir())
    words, expected = BAD[case]
    done = run(*(scene[True] if w == "SCENE" else w for w in words))
    assert (done.exit_code, done.stderr.count("error: ")) == (2, 1)
    assert expected in done.stderr
    assert set(tmp_path.iterdir()) == before


MAIN = """
#include "heavy_top_closed.h"
#include <stdio.h>
int main(void) {
    double t[3] = {0.0, 10.0, 20.0}, x[8 * 3];
    heavy_top_closed_at(3, t, x);
    for (int i = 0; i < @N@ * 3; ++i) printf("%.17g\\n", x[i]);
    return 0;
}
"""


@needs_compiler
def test_the_closed_form_of_a_scene_is_its_motion(run, tmp_path):
    """Beside DOP853 with a tenth of the error that is allowed."""
    done = run("generate", "heavy-top", "--closed-form", "--out", tmp_path)
    assert "Lagrange's top" in done.output
    words = ["--points", 3, "--method", "DOP853", "--rtol", 1e-13, "--out", tmp_path / "run.npz"]
    run("simulate", "heavy-top", *words)
    expected = columns(tmp_path / "run.npz")
    header = (tmp_path / "heavy_top_closed.h").read_text()
    names = [line.split()[-1] for line in header.splitlines() if line.startswith(" *   ")]
    (tmp_path / "main.c").write_text(MAIN.replace("@N@", str(len(names))))
    sources = [str(f) for f in sorted(tmp_path.glob("*.c"))]
    flags = ["-std=c99", "-O1", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror"]
    program = str(tmp_path / "main")
    subprocess.run([*native.compiler(), *flags, *sources, "-o", program, "-lm"], check=True)
    printed = subprocess.run([program], check=True, capture_output=True, text=True, timeout=60)
    found = np.array([float(line) for line in printed.stdout.split()]).reshape(len(names), 3)
    assert {"q0", "omega_1"} <= set(names)
    for name, row in zip(names, found, strict=True):
        np.testing.assert_allclose(row, expected[name], rtol=0, atol=1e-10)
