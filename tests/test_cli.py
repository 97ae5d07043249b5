"""The command line, as a user meets it."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import codegen
from eom import derivations
from eom.__main__ import main
from eom.scenes import catalogue


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(main, [str(w) for w in words], catch_exceptions=False)


@pytest.fixture
def scene_file(tmp_path):
    def write(text):
        file = tmp_path / "scene.toml"
        file.write_text(text, encoding="utf-8")
        return file

    return write


FREE = """
outputs = ["omega_1", "omega_2"]
[body]
moments = [1.0, 2.0, 2.5]
[initial]
omega_1 = 1
omega_2 = 0.1
omega_3 = 0
"""


def test_list_names_every_scene_and_loads_nothing_heavy():
    code = """
import sys
from eom.__main__ import main
main(["list"], standalone_mode=False)
print(sorted({"sympy", "numpy", "scipy", "matplotlib"} & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert all(name in done.stdout for name in [*catalogue.names(), *derivations.names()])
    assert all(group in done.stdout for group in ["Scenes", *derivations.titles()])
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.sparse(4)
@pytest.mark.parametrize("name", catalogue.names())
@pytest.mark.parametrize("style", ["text", "latex", "markdown"])
def test_derive_prints_every_state_and_output(run, name, style):
    from eom import load_scene

    done = run("derive", name, "--as", style)
    assert done.exit_code == 0
    system = load_scene(name).derive()
    assert system.title in done.output
    if style == "text":
        for state in system.state_names:
            assert f"{state}' " in done.output or f"{state}'  " in done.output
        assert "operations an evaluation" in done.output


@pytest.mark.slow
def test_derived_latex_has_balanced_braces_and_environments(run):
    for name in catalogue.names():
        text = run("derive", name, "--as", "latex").output
        assert text.count("{") == text.count("}")
        assert text.count("\\begin{align*}") == text.count("\\end{align*}") > 0


@pytest.mark.sparse(1)
@pytest.mark.parametrize("style", ["text", "latex", "markdown", "html"])
def test_derive_prints_a_derivation_in_every_format(run, style):
    words = ["derive", "point-mass", "--as", style, "--notation", "underline"]
    done = run(*words)
    assert done.exit_code == 0
    assert "Dynamics of a point mass" in done.output
    assert "002:E1" in done.output
    assert len(run(*words, "--no-steps").output) < len(done.output)


def test_notations_differ(run):
    names = ["arrow", "superscript", "underline", "kane"]
    shown = {run("derive", "point-mass", "--notation", n).output for n in names}
    assert len(shown) == len(names)
    assert run("derive", "point-mass").output in shown


@pytest.mark.parametrize(("target", "files"), [("c", 9), ("numpy", 1)])
def test_generate_writes_the_same_bytes_twice(run, tmp_path, target, files):
    folders = [tmp_path / "a", tmp_path / "b"]
    for folder in folders:
        done = run("generate", "heavy-top", "--target", target, "--out", folder)
        assert done.exit_code == 0, done.output
    first, second = ({f.name: f.read_bytes() for f in folder.iterdir()} for folder in folders)
    assert first == second
    assert len(first) == files


def test_generated_numpy_module_imports_numpy_alone(run, tmp_path):
    run("generate", "heavy-top", "--target", "numpy", "--out", tmp_path)
    code = """
import sys
import heavy_top
print(heavy_top.STATES, [m for m in sys.modules if m in ("sympy", "eom", "codegen")])
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert done.stdout.strip().endswith("[]")


def test_fixed_parameters_leave_none(run, tmp_path):
    run("generate", "t-handle", "--fixed", "--target", "numpy", "--out", tmp_path)
    assert "PARAMETERS = ()" in (tmp_path / "t_handle.py").read_text()


@pytest.mark.sparse(
    only=("t-handle", "double-pendulum"), slow=("rolling-disc", "gravity-gradient-satellite")
)
@pytest.mark.parametrize("name", catalogue.names())
def test_simulate_reports_and_saves(run, tmp_path, name):
    done = run(
        "simulate",
        name,
        "--out",
        tmp_path / "run.npz",
        "--plot",
        tmp_path / "run.png",
        "--points",
        50,
    )
    assert done.exit_code == 0, done.output
    assert "drift of" in done.output or name in {
        "seven-joint-arm",
        "foucault-pendulum",
        "rotary-pendulum",
        "walking-leg",
    }  # damped, driven
    assert "steps" in done.output
    with np.load(tmp_path / "run.npz") as saved:
        assert saved["t"].shape == (50,)
        assert all(np.isfinite(saved[k]).all() for k in saved.files if k != "eom.about")
    assert codegen.Result.load(tmp_path / "run.npz").units["t"] == "s"
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


def test_csv_holds_the_numbers_exactly(run, tmp_path):
    run("simulate", "t-handle", "--points", 20, "--out", tmp_path / "run.csv")
    run("simulate", "t-handle", "--points", 20, "--out", tmp_path / "run.npz")
    table = np.genfromtxt(tmp_path / "run.csv", delimiter=",", names=True)
    with np.load(tmp_path / "run.npz") as saved:
        own = tuple(n for n in saved.files if not n.startswith("eom."))
        assert table.dtype.names == own
        for name in own:
            np.testing.assert_array_equal(table[name], saved[name])


def test_run_does_the_whole_job(run, tmp_path):
    done = run("run", "bicycle-wheel", "--out", tmp_path / "wheel")
    assert done.exit_code == 0, done.output
    names = {f.name for f in (tmp_path / "wheel").iterdir()}
    assert {"trajectory.npz", "trajectory.png"} <= names
    assert any(n.startswith("bicycle_wheel") for n in names)
    assert "theta_dot' = " in done.output


def test_run_without_compiler_says_so(run, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", str(tmp_path / "no-such-compiler"))
    done = run("run", "t-handle", "--out", tmp_path / "handle")
    assert done.exit_code == 0
    assert "no C compiler found" in done.output
    assert "for C pip install 'eom-toolkit[compiler]'" in " ".join(done.output.split())
    assert (tmp_path / "handle" / "t_handle.py").is_file()
    assert "closed form: free body" in done.output


def test_a_unit_without_a_library_is_said_to_be_so(run, tmp_path, monkeypatch):
    target = ("generate", "t-handle", "--target", "fmu", "--out", tmp_path)
    assert "sources alone" not in run(*target, "--platform", "x86_64-linux").output
    monkeypatch.setenv("CC", str(tmp_path / "no-such-compiler"))
    done = run(*target)
    assert done.exit_code == 0
    assert "sources alone are in it" in done.output
    assert "pip install 'eom-toolkit[compiler]'" in done.output


def test_unknown_targets_are_told_those_that_there_are(run, tmp_path):
    done = run("generate", "t-handle", "--target", "fortran", "--out", tmp_path / "f")
    assert done.exit_code == 2
    assert ", fmu, " in done.output


def test_options_change_the_integration(run, tmp_path):
    done = run(
        "simulate",
        "t-handle",
        "--t-end",
        1,
        "--method",
        "scipy:RK45",
        "--rtol",
        1e-6,
        "--out",
        tmp_path / "r.npz",
    )
    assert "RK45 of SciPy" in done.output
    with np.load(tmp_path / "r.npz") as saved:
        assert saved["t"][-1] == 1.0


def test_stop_at_a_singular_angle_is_reported_with_status_1(run, scene_file, tmp_path):
    text = Path(catalogue.path_of("lecture-wheel")).read_text(encoding="utf-8")
    text = (
        text.replace("theta = 0.1", "theta = 1.5")
        .replace("theta_dot = 0.0", "theta_dot = 3.0")
        .replace("C = 6.0", "C = 0.0")
    )
    file = tmp_path / "out.npz"
    done = run("simulate", scene_file(text), "--out", file)
    assert done.exit_code == 1
    assert "theta = 1.57" in done.output
    assert "deg) is singular" in done.output
    with np.load(file) as saved:
        assert 0 < len(saved["t"]) < 1001


BAD = {
    "no such scene": (["derive", "bycicle-wheel"], "did you mean bicycle-wheel"),
    "no such file": (["derive", "missing.toml"], "no such scene file"),
    "no such format": (["derive", "t-handle", "--as", "html"], "html is for derivations"),
    "misspelt derivation": (
        ["derive", "euler-equation"],
        "did you mean euler-equations or rocket-equation?",
    ),
    "no such notation": (
        ["derive", "point-mass", "--notation", "underlined"],
        "did you mean underline?",
    ),
    "no such format of a derivation": (
        ["derive", "point-mass", "--as", "markdwon"],
        "did you mean markdown?",
    ),
    "notation of a scene": (
        ["derive", "t-handle", "--notation", "kane"],
        "--notation is for derivations",
    ),
    "steps of a scene": (["derive", "t-handle", "--no-steps"], "--steps is for derivations"),
    "explained derivation": (["derive", "point-mass", "--explain"], "--explain is for scenes"),
    "no such target": (["simulate", "t-handle", "--target", "fortran"], "unknown target 'fortran'"),
    "no such generated target": (
        ["generate", "t-handle", "--target", "rust", "--out", "x"],
        "unknown target 'rust'",
    ),
    "no such method": (["simulate", "t-handle", "--method", "DOP583"], "did you mean DOP853"),
    "negative tolerance": (["simulate", "t-handle", "--rtol", "-1"], "rtol"),
    "end time zero": (["simulate", "t-handle", "--t-end", "0"], "end time is zero"),
    "kind of table": (["simulate", "t-handle", "--out", "run.xlsx"], "ends in .npz or .csv"),
    "kind of picture": (
        ["simulate", "t-handle", "--plot", "run.gif"],
        "ends in .png, .svg, .pdf or .html",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_clear_error_with_status_2(run, case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words, expected = BAD[case]
    done = run(*words)
    assert done.exit_code == 2
    assert [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    assert expected in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", [["generate", "t-handle", "--out"], ["run", "t-handle", "--out"]])
def test_unwritable_folder(run, words, tmp_path):
    blocker = tmp_path / "file"
    blocker.write_text("in the way")
    done = run(*words, blocker / "below")
    assert done.exit_code == 2
    assert "a folder is needed, and this is a file" in done.stderr
    assert blocker.read_text() == "in the way"


def test_failing_compiler_is_reported(run, tmp_path, monkeypatch):
    broken = tmp_path / "cc"
    broken.write_text("#!/bin/sh\necho 'cc: out of order' >&2\nexit 3\n")
    broken.chmod(0o755)
    monkeypatch.setenv("CC", str(broken))
    monkeypatch.setenv("EOM_CACHE_DIR", str(tmp_path / "cache"))
    done = run("simulate", "t-handle", "--target", "c")
    assert done.exit_code == 2
    assert "the C compiler failed" in done.stderr
    assert "out of order" in done.stderr
    assert list((tmp_path / "cache").iterdir()) == []
    assert run("simulate", "t-handle").exit_code == 0


def test_scene_file_errors_name_the_file_and_the_key(run, scene_file):
    file = scene_file(FREE.replace("moments", "momants"))
    done = run("derive", file)
    assert done.exit_code == 2
    assert str(file) in done.stderr
    assert "did you mean moments?" in done.stderr


def test_missing_initial_value_is_named(run, scene_file):
    done = run("simulate", scene_file(FREE.replace("omega_3 = 0\n", "")))
    assert done.exit_code == 2
    assert "missing initial value: omega_3" in done.stderr


def test_help_names_every_command(run):
    text = run("--help").output
    assert all(
        word in text for word in ("list", "derive", "generate", "accuracy", "simulate", "run")
    )


def test_generate_reports_operations_before_compiling(run, tmp_path):
    done = run("generate", "heavy-top", "--report")
    assert done.exit_code == 0
    assert "as written" in done.output
    assert "heavy_top.c: " in done.output
    both = run("generate", "heavy-top", "--report", "--fixed", "--out", tmp_path / "top")
    assert "compiled in" in both.output
    written = (tmp_path / "top" / "heavy_top.c").stat().st_size
    assert f"heavy_top.c: {written:,} bytes" in both.output


def test_generate_needs_a_folder_or_a_report(run):
    done = run("generate", "heavy-top")
    assert done.exit_code == 2
    assert "--out FOLDER" in done.stderr


@pytest.mark.sparse(
    only=("t-handle", "bicycle-wheel", "double-pendulum"), slow=("rolling-disc", "heavy-top")
)
@pytest.mark.parametrize("name", catalogue.names())
def test_accuracy_reports_every_result(run, name):
    from eom import load_scene

    done = run("accuracy", name, "--target", "numpy", "--samples", 3)
    assert done.exit_code == 0, done.output
    system = load_scene(name).derive()
    for result in (*(f"{n}'" for n in system.state_names), *system.output_names):
        assert any(line.startswith(f"{result} ") for line in done.output.splitlines())
    assert "3 samples, seed 0" in done.output
    drawn = [s for s in system.singularities if s.coordinate.name in system.state_names]
    assert "near singular" in done.output or not drawn


UNSTABLE = """
model = "spinner"
outputs = ["theta"]
[body]
moments = [0.06, 0.12]
[torque]
components = ["-M1*(1 - cos(theta))", 0, 0]
[parameters]
M1 = { value = 0.5, unit = "N m", meaning = "size of the torque" }
[initial]
theta = 0.1
psi = 0
theta_dot = 0
psi_dot = 0
C = 0
"""


def test_accuracy_names_the_cancellation_and_its_cure(run, scene_file):
    file = scene_file(UNSTABLE)
    words = ["accuracy", file, "--samples", 20, "--range", "theta=1e-8:1e-4", "--range", "C=0"]
    words += ["--range", "psi_dot=0"]
    plain, stable = run(*words), run(*words, "--stable")
    assert plain.exit_code == stable.exit_code == 0
    assert "unstable" in plain.output
    assert "cos(theta) - 1 loses" in plain.output
    assert "--stable" in plain.output
    assert "unstable" not in stable.output
    assert "rewritten: " in stable.output


def test_stable_forms_are_generated(run, scene_file, tmp_path):
    file = scene_file(UNSTABLE)
    for folder, flags in {"plain": [], "stable": ["--stable"]}.items():
        run("generate", file, "--target", "numpy", "--out", tmp_path / folder, *flags)
    plain, stable = (next((tmp_path / f).iterdir()).read_text() for f in ("plain", "stable"))
    assert plain != stable
    assert " - 1.0" in plain
    assert " - 1.0" not in stable


def test_accuracy_as_json(run):
    words = ["accuracy", "t-handle", "--samples", 2, "--json", "--jacobian", "states"]
    first, second = run(*words), run(*words)
    data = json.loads(first.stdout)
    assert first.stdout == second.stdout
    assert data["samples"] == 2
    assert {r["group"] for r in data["rows"]} == {"rates", "invariants", "jacobian by states"}


BAD_RANGES = {
    "theta=2:1": "range is reversed",
    "theta=1:1": "range is empty",
    "theta=nan": "range is not finite",
    "thetta=0:1": "did you mean theta",
    "theta": "expected: NAME=LOW:HIGH",
    "theta=0:x": "expected: NAME=LOW:HIGH",
    "I1=0:1": "parameter I1 is not positive",
}


@pytest.mark.sparse(2)
@pytest.mark.parametrize("words", BAD_RANGES)
def test_bad_ranges_are_one_clear_error(run, words):
    done = run("accuracy", "bicycle-wheel", "--samples", 1, "--range", words)
    assert done.exit_code == 2
    assert [line.split(": ")[0] for line in done.stderr.splitlines()].count("error") == 1
    assert BAD_RANGES[words] in done.stderr
    assert done.stdout == ""
