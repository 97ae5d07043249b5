"""The command line where a motion is written in closed form."""

import subprocess

import numpy as np
import pytest
from click.testing import CliRunner

from codegen.native import native
from eom.__main__ import main

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="needs a C compiler")


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(main, [str(w) for w in words], catch_exceptions=False)


def columns(file):
    with np.load(file) as saved:
        return {name: saved[name] for name in saved.files}


BAD = {
    "none is known": (["lecture-wheel", "--closed-form", "--out", "x"], "no closed form"),
    "fixed": (["t-handle", "--closed-form", "--fixed", "--out", "x"], "--fixed"),
    "nowhere": (["t-handle", "--closed-form"], "--out FOLDER"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_does_not_go_together_is_one_clear_error(run, case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words, expected = BAD[case]
    done = run("generate", *words)
    assert (done.exit_code, done.stderr.count("error: ")) == (2, 1)
    assert expected in done.stderr
    assert not list(tmp_path.iterdir())


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
