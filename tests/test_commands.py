"""The command line where it reads tables: methods and integrators; what `eom generate` writes."""

import json
import shutil
import subprocess

import pytest
from click.testing import CliRunner

from codegen.integrate import methods
from codegen.loops import written
from codegen.native import native
from eom.__main__ import main
from eom.scenes import catalogue

needs_compiler = pytest.mark.skipif(not native.compiler(), reason="methods in C")
needs_make = pytest.mark.skipif(
    not (native.compiler() and shutil.which("make")), reason="compiles C by make"
)


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(main, [str(w) for w in words], catch_exceptions=False)


@pytest.mark.parametrize(
    ("command", "title", "rows"),
    [
        ("simulate", "Methods", methods.ROWS),
        ("generate", "Integrators", written.ROWS),
    ],
)
def test_help_lists_every_row(run, command, title, rows):
    text = run(command, "--help").output
    listed = text.partition(f"{title}:\n")[2].splitlines()
    assert [line.split()[0] for line in listed if line[2:3].strip()] == [row.name for row in rows]
    assert all(" ".join(row.meaning.split())[:30] in text for row in rows)


@pytest.mark.sparse(1)
@pytest.mark.parametrize("name", [row.name for row in written.ROWS])
def test_each_integrator_is_written_and_no_other(run, tmp_path, name):
    done = run("generate", "heavy-top", "--integrator", name, "--out", tmp_path)
    assert done.exit_code == 0, done.output
    others = [row.name for row in written.ROWS if row.name != name]
    files = {f.name for f in tmp_path.iterdir()}
    assert (f"heavy_top_{name}.c" in files) == (name != "none")
    assert not any(f"heavy_top_{other}.c" in files for other in others)
    assert (f"heavy_top_{name}.o" in (tmp_path / "Makefile").read_text()) == (name != "none")


@pytest.mark.sparse(only=("taylor", "none"))
@needs_make
@pytest.mark.parametrize("name", [row.name for row in written.ROWS])
def test_each_integrator_builds_with_strict_options(run, tmp_path, name):
    run("generate", "lecture-wheel", "--integrator", name, "--out", tmp_path)
    done = subprocess.run(
        ["make", "CFLAGS=-O1", "check"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr


def test_the_order_of_taylor_suits_the_tolerance(run, tmp_path):
    def order(folder, *words):
        run("generate", "t-handle", "--integrator", "taylor", "--out", tmp_path / folder, *words)
        text = (tmp_path / folder / "t_handle_taylor.h").read_text()
        return int(text.partition("series of order ")[2].split()[0])

    fine, scenes, coarse = order("a", "--rtol", 1e-12), order("b"), order("c", "--rtol", 1e-3)
    assert fine > scenes > coarse


def test_report_counts_the_chosen_integrator(run, tmp_path):
    words = ["generate", "t-handle", "--report", "--integrator", "taylor", "--out", tmp_path]
    done = run(*words)
    size = (tmp_path / "t_handle_taylor.c").stat().st_size
    assert f"t_handle_taylor.c: {size:,} bytes" in done.output
    assert "dop853" not in done.output


BAD = {
    "no such integrator": (["--integrator", "taylr"], "did you mean taylor?"),
    "integrator of a module": (
        ["--integrator", "taylor", "--target", "numpy"],
        "written for the targets c and javascript alone",
    ),
    "tolerance": (["--integrator", "taylor", "--rtol", "0"], "rtol"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_integrators_are_one_clear_error(run, case, tmp_path):
    words, expected = BAD[case]
    done = run("generate", "t-handle", "--out", tmp_path / "x", *words)
    assert done.exit_code == 2
    assert done.stderr.count("error: ") == 1
    assert expected in done.stderr
    assert list(tmp_path.iterdir()) == []


# --- the closing table ----------------------------------------------------------------------------


def rows_of(done):
    """The closing table by its first column."""
    lines = [line for line in done.output.splitlines() if "  " in line]
    return {key.strip(): value.strip() for key, _, value in (w.partition("  ") for w in lines)}


def test_the_closing_table_says_why_and_what_was_left_out(run):
    """Without angles the free body has a closed form; phi of the wheel is cyclic and not asked for."""
    wheel, handle = rows_of(run("simulate", "lecture-wheel")), rows_of(run("simulate", "t-handle"))
    assert (
        handle["chosen because"]
        == "angular velocity without torque, by Jacobi's elliptic functions"
    )
    assert handle["method"] == "closed form: free body"
    assert wheel["left out"] == "phi: no output needs them"
    assert "left out" not in handle
    named = rows_of(run("simulate", "t-handle", "--method", "scipy:DOP853"))
    assert "chosen because" not in named


@needs_compiler
def test_the_closing_table_says_how_good_the_run_is(run):
    done = run("simulate", "t-handle", "--method", "DOP853", "--points", 40)
    reported = rows_of(done)
    assert reported["accuracy"].startswith("good to about ")
    assert "by a second run with taylor" in " ".join(done.output.split())
    assert reported["errors grow"].endswith(" 1/s")
    assert "notice" not in reported
    without = rows_of(run("simulate", "t-handle", "--method", "DOP853", "--no-accuracy"))
    assert not {"accuracy", "errors grow", "notice"} & set(without)


@needs_compiler
def test_a_run_without_a_digit_says_so_in_colour_and_in_json(run, tmp_path, monkeypatch):
    scene = tmp_path / "wild.toml"
    text = catalogue.path_of("double-pendulum").read_text()
    scene.write_text(text.replace("shoulder = 1.2", "shoulder = 2.0").replace("= -0.5", "= 2.5"))
    words = ["simulate", scene, "--t-end", 60, "--points", 200]
    plain = run(*words)
    assert plain.exit_code == 0
    reported = rows_of(plain)
    assert reported["accuracy"].startswith("no digit is left after t = ")
    assert reported["notice"].startswith("after t = ")
    assert "hardly drift proves nothing" in " ".join(plain.output.split())
    assert float(reported["drift of energy"].split()[0]) < 1e-8
    whole = json.loads(run(*words, "--json").stdout)
    assert whole["notice"].startswith("after t = ")
    data = whole["accuracy"]
    assert 10 < data["horizon"] < 40
    assert data["rate"] > 0.5
    assert set(data["at_end"]) == {"q_shoulder", "q_elbow", "u_shoulder", "u_elbow"}
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "\x1b[1;31m" in run(*words).stdout


@needs_compiler
def test_the_notice_of_a_run_is_reported_without_an_estimate_too(run, tmp_path):
    """What rkmk cannot resolve: rates of 1e-7 rad/s beside a spin of 10."""
    scene = tmp_path / "steady.toml"
    lines = catalogue.path_of("t-handle").read_text().replace("0.05", "1e-7").splitlines()
    kept = "\n".join(line for line in lines if not line.startswith("outputs"))
    kept = kept.replace("[initial]", "[initial]\nq0 = 1\nq1 = 0\nq2 = 0\nq3 = 0")
    scene.write_text(f'attitude = "quaternion"\n{kept}')
    words = ["simulate", scene, "--method", "rkmk", "--rtol", 1e-13, "--t-end", 0.1]
    words += ["--no-accuracy"]
    assert rows_of(run(*words))["notice"].startswith("rounding of the momentum is ")
    assert json.loads(run(*words, "--json").stdout)["notice"].startswith("rounding of")


def test_a_run_that_took_long_is_not_run_again(run, monkeypatch):
    from eom.commands import simulating

    monkeypatch.setattr(simulating, "LONGEST", -1.0)
    reported = rows_of(run("simulate", "t-handle"))
    assert reported["accuracy"].startswith("not estimated: the run took ")
    data = json.loads(run("simulate", "t-handle", "--json").output)
    assert set(data["accuracy"]) == {"text"}
    assert (
        json.loads(run("simulate", "t-handle", "--json", "--no-accuracy").output)["accuracy"]
        is None
    )


def drift_in(done, name):
    return float(rows_of(done)[f"drift of {name}"].split()[0])


@pytest.mark.slow
def test_projection_keeps_what_is_named(run, tmp_path):
    words = ["simulate", "gravity-gradient-satellite", "--rtol", 1e-6, "--points", 20, "--method"]
    off = run(*words, "DOP853")
    kept = run(*words, "DOP853", "--project", "E", "--project", "q_norm")
    every = run(*words, "DOP853", "--project", "all")
    for name in ("E", "q_norm"):
        assert drift_in(off, name) > 1e-10
        assert drift_in(kept, name) < 1e-13
        assert drift_in(every, name) < 1e-13
    done = run("run", "t-handle", "--out", tmp_path, "--project", "T")
    assert done.exit_code == 0
    assert "chosen because" in done.output


@pytest.mark.parametrize(
    ("words", "expected"),
    [(["--project", "qnorm"], "did you mean q_norm?"),
     (["--project", "E", "--method", "scipy:LSODA"], "cannot project")],
)  # fmt: skip
def test_bad_projections_are_one_clear_error(run, words, expected):
    done = run("simulate", "heavy-top", *words)
    assert (done.exit_code, done.stderr.count("error: ")) == (2, 1)
    assert expected in done.stderr
