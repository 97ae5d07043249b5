"""What all commands share: values by --set, places to write, names in any case, errors as JSON."""

import ast
import json
import math
import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

import eom
from eom.__main__ import COMMANDS, main
from eom.commands import options
from eom.commands.options import ROWS
from eom.scenes.description import of_norm_one


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(main, [str(w) for w in words], catch_exceptions=False)


def test_alone_it_shows_three_commands_that_work(run):
    done = run()
    assert done.exit_code == 0
    shown = re.findall(r"^  eom (\w+)", done.output, re.MULTILINE)
    assert len(shown) == 3
    assert {*shown} <= {c.name for c in COMMANDS}


OTHERS = {
    ("checking", "--seconds"): "processor time",
    ("checking", "--as"): "what a text is",
    ("deriving", "--method"): "of a closed form",
    ("deriving", "--out"): "a page, whose form its ending names",
    ("stressing", "--method"): "several",
    ("ensembling", "--out"): "a store that a broken run goes on with",
    ("ensembling", "--seed"): "by default the file's",
}
"""Options by words of the table that mean something else, by module."""


def test_options_of_the_table_are_written_nowhere_else():
    flags = {flag.split("/")[0] for given, _ in ROWS.values() for flag in given if flag[:2] == "--"}
    found = set()
    for file in Path(options.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "click.option":
                words = (a.value for a in node.args if isinstance(a, ast.Constant))
                found |= {(file.stem, w) for w in words if w.split("/")[0] in flags}
    assert found == {*OTHERS}


@pytest.mark.parametrize("name", ["simulate", "run", "ensemble", "animate", "plot", "accuracy"])
def test_every_command_that_takes_time_has_t_end_and_its_alias(name):
    command = next(c for c in COMMANDS if c.name == name)
    flags = next(p.opts for p in command.params if p.name == "t_end")
    assert flags == ["--t-end", "--seconds"]


def test_every_command_that_runs_a_scene_sets_values():
    having = {c.name for c in COMMANDS if any("--set" in p.opts for p in c.params)}
    assert having >= {
        "simulate", "run", "ensemble", "animate", "live", "plot", "accuracy", "generate", "linearise",
        "analyse", "convert",
    }  # fmt: skip


# -- values ----------------------------------------------------------------------------------------------

SET = {
    "weight": ("heavy-top", {"m": "2 kg"}, {"m": 2.0}),
    "gravity": ("heavy-top", {"g": "5"}, {"g": 5.0}),
    "arm": ("heavy-top", {"r3": "3 cm"}, {"r3": 0.03}),
    "moment": ("heavy-top", {"I3": 0.5}, {"I3": 0.5}),
    "rate": ("heavy-top", {"omega_3": "100 rpm"}, {"omega_3": 10 * math.pi / 3}),
    "quaternion": ("heavy-top", {"q0": 1, "q1": 0, "q2": 0, "q3": 0}, {"q0": 1.0, "q1": 0.0}),
    "angle over a quaternion": ("lecture-wheel", {"theta": "30 deg"}, {"theta": math.pi / 6}),
    "size of a solid": ("bicycle-wheel", {"ring_radius": "40 cm"}, {}),
    "orbit": ("gravity-gradient-satellite", {"n": "1 mrad/s"}, {"n": 1e-3}),
    "parameter of a tree": ("double-pendulum", {"q_elbow": "pi/3"}, {"q_elbow": math.pi / 3}),
    "input": ("rotary-pendulum", {"tau_arm": "2 N mm"}, {"tau_arm": 0.002}),
    "unlisted input": ("reaction-wheels", {"tau_wheel2": "1 mN m"}, {"tau_wheel2": 0.001}),
}


@pytest.mark.parametrize(("scene", "given", "expected"), SET.values(), ids=SET)
def test_values_are_those_of_the_systems(scene, given, expected):
    before = eom.load_scene(scene)
    after = before.with_values(given)
    found = after.initial_values() | after.parameter_values() | after.input_values()
    others = before.initial_values() | before.parameter_values() | before.input_values()
    assert {n: found[n] for n in expected} == pytest.approx(expected, rel=1e-15)
    assert found != others
    assert after.derive().state_names == before.derive().state_names


def test_another_angle_leaves_the_others():
    scene = eom.load_scene("t-handle-in-angles")
    before = scene.initial_values()
    after = scene.with_values({"psi": "20 deg"})
    back = after.with_values({"psi": 0.0})
    assert after.initial_values() != before
    groups = scene.full_system.angles[0].names
    stated = {n: after.initial[n] for n in groups}
    assert float(stated["theta"]) == pytest.approx(float(back.initial["theta"]), abs=1e-12)
    assert float(stated["phi"]) == pytest.approx(float(back.initial["phi"]), abs=1e-12)


def test_an_angle_of_a_joint_in_a_quaternion_is_set():
    scene = eom.load_scene("reaction-wheels")
    q = scene.with_values({"q_hub_2": "30 deg"}).initial_values()
    assert q["e_hub_2"] == pytest.approx(math.sin(math.pi / 12), rel=1e-14)


def test_what_is_set_under_constraints_is_kept_and_the_rest_follows():
    scene = eom.load_scene("four-bar-linkage").with_values({"q_crank": "20 deg"})
    values = scene.initial_values()
    assert values["q_crank"] == pytest.approx(math.radians(20), abs=1e-15)
    assert values["q_rocker"] != eom.load_scene("four-bar-linkage").initial_values()["q_rocker"]


def test_a_body_that_is_set_is_what_its_file_would_say(tmp_path):
    text = "[body]\nmatrix = [[2, -0.1, 0], [-0.1, 3, 0], [0, 0, 4]]\n"
    (tmp_path / "body.toml").write_text(text, encoding="utf-8")
    scene = eom.load_scene(tmp_path / "body.toml")
    assert scene.with_values({"J12": -0.2}).body.matrix == ((2, -0.2, 0), (-0.2, 3, 0), (0, 0, 4))


WRONG = {
    "no value": (["heavy-top", "--set", "m"], "NAME=VALUE"),
    "twice": (["heavy-top", "--set", "m=1", "--set", "m=2"], "m is set twice"),
    "unknown": (["heavy-top", "--set", "mm=1"], "did you mean m?"),
    "of the plan": (["heavy-top", "--set", "t_end=1"], "--t-end"),
    "dimension": (["heavy-top", "--set", "m=3 s"], "a value in kg"),
    "no number": (["heavy-top", "--set", "m=x"], "unknown name 'x'"),
    "infinite": (["heavy-top", "--set", "m=1/0"], "m"),
    "negative": (["heavy-top", "--set", "m=-1"], "greater than 0"),
    "no rotation": (["heavy-top", "--set", "q0=0.5"], "divide by the norm: "),
    "follows": (["bicycle-wheel", "--set", "I1=3"], "set mass, ring_radius"),
    "code": (["heavy-top", "--set", "m=__import__('os').getcwd()"], "error: "),
}


@pytest.mark.parametrize(("words", "expected"), WRONG.values(), ids=WRONG)
def test_wrong_values_are_refused_in_words(run, words, expected):
    done = run("simulate", *words)
    assert done.exit_code == 2
    assert expected in done.output
    assert "Traceback" not in done.output


def test_a_value_is_not_set_and_varied(run):
    words = ["ensemble", "heavy-top", "--set", "m=2", "--vary", "m=uniform(1,2)", "--count", 2]
    done = run(*words)
    assert done.exit_code == 2
    assert "m is set, and varied" in done.output


def test_a_run_starts_from_what_is_set(run):
    words = ["--t-end", "50 ms", "--method", "dop853", "--json", "--no-accuracy"]
    done = run("simulate", "heavy-top", "--set", "omega_1=10", *words)
    found = json.loads(done.output)
    assert found["states"]["omega_1"][0] == 10
    assert found["t"][-1] == 0.05
    assert found["method"].startswith("DOP853")


OWN = """outputs = ["omega_1"]
[body]
moments = [1.0, 2.0, 3.0]
[initial]
omega_1 = 0.1
omega_2 = 2.0
omega_3 = 0.1
[integration]
t_end = 0.1
method = "{}"
"""


def test_methods_of_scene_files_are_in_any_case_and_refused_before_any_work(run, tmp_path):
    file = tmp_path / "own.toml"
    file.write_text(OWN.format("dOP853"))
    done = run("simulate", file, "--json", "--no-accuracy")
    assert json.loads(done.output)["method"].startswith("DOP853")
    file.write_text(OWN.format("DOP854"))
    done = run("run", file, "--out", tmp_path / "out")
    assert done.exit_code == 2
    assert "own.toml: [integration] method" in done.output
    assert "did you mean DOP853" in done.output
    assert [f.name for f in tmp_path.iterdir()] == ["own.toml"]


@pytest.mark.parametrize("command", ["simulate", "run"])
def test_a_target_is_in_any_case(run, tmp_path, command):
    words = ["--target", "NumPy", "--t-end", "0.1", "--method", "DOP853", "--no-accuracy"]
    done = run(
        command, "t-handle", *words, *(["--out", tmp_path / "o"] if command == "run" else [])
    )
    assert done.exit_code == 0
    assert "over numpy functions" in " ".join(done.output.split())


def test_what_is_written_is_the_same_in_any_case(run, tmp_path):
    for name in ("c", "C"):
        assert (
            run("generate", "t-handle", "--target", name, "--out", tmp_path / name).exit_code == 0
        )
    texts = [{f.name: f.read_text() for f in (tmp_path / n).iterdir()} for n in ("c", "C")]
    assert texts[0] == texts[1] != {}
    done = run("generate", "t-handle", "--target", "FMU", "--out", tmp_path / "unit", "--fixed")
    assert done.exit_code == 2
    assert "does not go with --target fmu" in done.output


def test_a_target_that_is_written_alone_is_not_run(run):
    for name in ("fmu", "Javascript"):
        done = run("simulate", "t-handle", "--target", name)
        assert done.exit_code == 2
        assert f"the target {name.lower()} is written, and not run from Python" in done.output
        assert "auto, c, numpy, python, jax" in done.output


@pytest.mark.parametrize(("scene", "name"), [("t-handle", "omega_1"), ("rotary-pendulum", "q_arm")])
def test_a_value_of_another_dimension_is_that_of_the_option(run, scene, name):
    done = run("simulate", scene, "--set", f"{name}=1 kg")
    assert done.exit_code == 2
    assert re.search(rf"where: +--set {name}=1 kg\n", done.output)
    assert ".toml" not in done.output


def test_a_folder_that_is_needed_is_asked_for(run):
    done = run("run", "t-handle")
    assert done.exit_code == 2
    assert "Missing option '--out'" in done.output


# -- where things are written ----------------------------------------------------------------------------

FOLDERS = {
    "run": ["run", "heavy-top", "--out"],
    "generate": ["generate", "heavy-top", "--out"],
    "ensemble": ["ensemble", "heavy-top", "--vary", "m=uniform(1,2)", "--count", "2", "--out"],
    "bench": ["bench", "heavy-top", "--out"],
    "stress": ["stress", "--out"],
    "exercise": ["exercise", "euler-equations", "--out"],
}
FILES = {
    "simulate": ["simulate", "heavy-top", "--out"],
    "simulate --plot": ["simulate", "heavy-top", "--plot"],
    "animate": ["animate", "heavy-top", "--out"],
    "live": ["live", "heavy-top", "--out"],
    "plot": ["plot", "heavy-top", "--out"],
    "check --table": ["check", r"\dot{x} = 1", "--table"],
    "check --html": ["check", r"\dot{x} = 1", "--html"],
}


@pytest.mark.parametrize("words", FOLDERS.values(), ids=FOLDERS)
def test_a_file_where_a_folder_is_needed_is_told_the_same_before_any_work(
    run, tmp_path, monkeypatch, words
):
    monkeypatch.setattr("eom.opening.load_scene", None)
    file = tmp_path / "file"
    file.touch()
    said = set()
    for place in (file, file / "deeper"):
        done = run(*words, place)
        assert done.exit_code == 2
        said.add(done.output.split("\n")[0])
    assert said == {"error: a folder is needed, and this is a file"}
    assert file.read_bytes() == b""


@pytest.mark.parametrize("words", FILES.values(), ids=FILES)
def test_a_folder_where_a_file_is_needed_is_told_the_same_before_any_work(
    run, tmp_path, monkeypatch, words
):
    monkeypatch.setattr("eom.opening.load_scene", None)
    done = run(*words, tmp_path)
    assert done.exit_code == 2
    assert done.output.startswith("error: a file is needed, and this is a folder")
    assert not [*tmp_path.iterdir()]


def test_pages_of_checks_appear_whole_or_not_at_all(run, tmp_path, monkeypatch):
    import pathlib

    def broken(self, text, **_):
        with self.open("w", encoding="utf-8") as stream:
            stream.write(text[: len(text) // 2])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pathlib.Path, "write_text", broken)
    for option, name in (("--html", "page.html"), ("--table", "table.csv")):
        done = run("check", r"\dot{\vec{H}}_C = \vec{L}_C", "--notation", "arrow-tilde",
                   option, tmp_path / name)  # fmt: skip
        assert done.exit_code == 2
        assert "No space left" in done.output
        assert not [*tmp_path.iterdir()]


# -- errors ----------------------------------------------------------------------------------------------


def test_linearise_prints_json_whatever_happens(run, tmp_path):
    done = CliRunner().invoke(main, ["linearise", "heavy-top", "--json", "--starts", "1"])
    assert done.exit_code == 2
    assert json.loads(done.stdout)["error"]["what"] == "no equilibrium was found"
    corner = (
        '[body]\nmoments = [1, 2, 3]\n[torque]\ncomponents = ["-sqrt(abs(omega_1))", "-omega_2", '
        '"-omega_3"]\n[initial]\nomega_1 = 0\nomega_2 = 0\nomega_3 = 0\n'
    )
    (tmp_path / "corner.toml").write_text(corner, encoding="utf-8")
    done = CliRunner().invoke(main, ["linearise", str(tmp_path / "corner.toml"), "--json"])
    assert {*json.loads(done.stdout)} & {"error", "A"}


def test_a_missing_value_is_told_with_file_section_and_what_to_write(tmp_path):
    file = tmp_path / "top.toml"
    file.write_text('attitude = "quaternion"\n[body]\nmoments = [1, 1, 2]\n[torque.weight]\n'
                    "mass = 1\ncentre_of_mass = [0, 0, 0.1]\n[initial]\nomega_1 = 0\nomega_2 = 0\n"
                    "omega_3 = 9\n", encoding="utf-8")  # fmt: skip
    with pytest.raises(eom.InputError) as caught:
        eom.load_scene(file).initial_values()
    assert caught.value.where == f"{file}: [initial]"
    assert "missing initial value: q0" in caught.value.what
    assert "[initial_attitude]" in caught.value.hint
    file.write_text(
        "[body]\nmoments = [1, 2, 2.5]\n[initial]\nomega_1 = 0\nomega_2 = 0\n", encoding="utf-8"
    )
    with pytest.raises(eom.InputError) as caught:
        eom.load_scene(file).changed(title="other").initial_values()
    assert caught.value.where == f"{file}: [initial]"
    assert "omega_3 = " in caught.value.expected


def test_a_section_that_is_no_table_is_told_in_words():
    with pytest.raises(eom.InputError, match="a table: keys with values") as caught:
        eom.Scene(body=3)
    assert "dictionary" not in str(caught.value)


def test_sizes_that_do_not_fit_are_named():
    with pytest.raises(eom.InputError, match=r"sizes of a box do not fit: .* is missing"):
        eom.Scene(body={"solid": "box", "mass": 1, "size": {"length": 1}})


def test_no_format_of_a_scene_is_told_with_those_that_are(run):
    done = run("derive", "heavy-top", "--as", "html")
    assert done.exit_code == 2
    assert "text, latex, markdown" in done.output
    assert "html is for derivations" in done.output


# -- quaternions -----------------------------------------------------------------------------------------

unit = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: math.hypot(*q) > 0.1)


@given(unit, st.integers(3, 15))
def test_a_unit_quaternion_that_is_rounded_is_normalised(q, decimals):
    norm = math.hypot(*q)
    written = [round(x / norm, decimals) for x in q]
    found = of_norm_one(written, "q")
    assert math.hypot(*found) == pytest.approx(1, abs=1e-15)
    assert found == pytest.approx([x / norm for x in q], abs=2 * 10.0**-decimals)


@pytest.mark.parametrize(
    "q", [(1, 1, 0, 0), (0.7, 0, 0.7, 0), (0.72, 0, 0.7, 0), (0, 0, 0, 0), (0.7071, 0, 0.71, 0.1)]
)
def test_other_quaternions_are_refused_with_what_they_are_over_their_norm(q):
    with pytest.raises(eom.InputError, match="unit norm") as caught:
        of_norm_one(q, "q")
    if any(q):
        assert caught.value.hint.startswith("divide by the norm: ")
