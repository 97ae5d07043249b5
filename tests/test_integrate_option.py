"""Scenes in angles that are integrated in a quaternion, at the command line."""

import json

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
points = 40
"""
WITH = TUMBLING.replace('attitude = "3-2-1"', 'attitude = "3-2-1"\nintegrate = "quaternion"', 1)
needs_compiler = pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(main, [str(w) for w in words], catch_exceptions=False)


@pytest.fixture
def scene(tmp_path):
    """A scene that is integrated in a quaternion, and one that is not."""
    files = {True: tmp_path / "tumbling.toml", False: tmp_path / "angles.toml"}
    files[True].write_text(WITH)
    files[False].write_text(TUMBLING)
    return files


def columns(file):
    rows = np.genfromtxt(file, delimiter=",", names=True)
    return {name: rows[name] for name in rows.dtype.names}


@needs_compiler
def test_files_hold_continuous_angles_where_the_scene_or_the_option_says_so(run, scene, tmp_path):
    file = tmp_path / "run.csv"
    words = ["--out", file, "--no-accuracy"]
    found = []
    for more in ([scene[True]], [scene[False], "--integrate", "quaternion"], [scene[False]]):
        done = run("simulate", *more, *words)
        assert done.exit_code == 0, done.output
        found.append(columns(file))
    asked, by_option, own = found
    names = [n for n in own if n.split("_")[0] in {"psi", "theta", "phi"}]
    assert len(names) == 3
    for n in names:
        np.testing.assert_array_equal(by_option[n], asked[n])
        np.testing.assert_allclose(asked[n], own[n], rtol=0, atol=1e-6)
    assert np.ptp(asked[names[0]]) > 3


@needs_compiler
def test_projection_events_and_pictures_go_with_it(run, scene, tmp_path):
    picture = tmp_path / "run.png"
    words = ["--project", "all", "--event", "theta - 1", "--event", "sin(psi - 1)", "--json"]
    done = run("simulate", scene[True], "--method", "taylor", *words, "--plot", picture)
    assert done.exit_code == 0, done.output
    reported = json.loads(done.stdout)
    assert len(reported["events"]["theta - 1"]) == 4
    assert reported["drift"]["q_norm"]["relative"] < 1e-14
    assert picture.read_bytes().startswith(b"\x89PNG")
    refused = run("simulate", scene[True], "--method", "taylor", "--event", "psi - 1")
    assert refused.exit_code == 2
    assert "sin(psi - 1)" in refused.output


@needs_compiler
def test_starts_of_an_ensemble_vary_by_angles(run, scene):
    words = ["--vary", "theta=grid(0.1, 0.3, 2)", "--t-end", 0.01, "--json"]
    done = run("ensemble", scene[True], *words)
    assert done.exit_code == 0, done.output
    reported = json.loads(done.stdout)
    assert "psi, phi: from -pi to pi" in done.stderr
    assert reported["statistics"]["theta"]["least"][0] == pytest.approx(0.2, abs=2e-3)
    assert reported["statistics"]["theta"]["greatest"][0] == pytest.approx(0.4, abs=2e-3)


def test_the_old_key_is_refused_in_one_clear_error(run, scene):
    scene[False].write_text(f"{TUMBLING}handover = true\n")
    done = run("derive", scene[False])
    assert (done.exit_code, done.stderr.count("error: ")) == (2, 1)
    assert "[integration] handover" in done.stderr
    assert 'integrate = "quaternion"' in done.stderr


BAD = {
    "what": (["SCENE", "--integrate", "foo"], "unusable value"),
    "no angles": (["t-handle", "--integrate", "quaternion"], "only the angles"),
    "a quaternion": (["heavy-top", "--integrate", "quaternion"], "only the angles"),
    "a tree": (["double-pendulum", "--integrate", "quaternion"], "unknown key 'integrate'"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_is_one_clear_error(run, scene, case):
    words, expected = BAD[case]
    done = run("simulate", *(scene[False] if w == "SCENE" else w for w in words))
    assert (done.exit_code, done.stderr.count("error: ")) == (2, 1)
    assert expected in done.stderr
