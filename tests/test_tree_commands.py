"""The command line on trees: ready scenes, TOML files and robots from URDF."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from eom.__main__ import main
from eom.multibody import absolute_angles, tree_page
from eom.multibody.files.scene import TreeScene

WALKER = Path(__file__).parent / "eom" / "multibody" / "robots" / "walker.urdf"
SPRING = """
model = "tree"
outputs = ["q_slide", "energies"]
[parameters]
k = { value = 4.0, unit = "N/m", meaning = "stiffness" }
[bodies.block]
mass = 1.0
[bodies.ball]
mass = 2.0
moments = [1, 1, 1]
[joints.slide]
kind = "prismatic"
parent = "ground"
child = "block"
stiffness = "k"
[joints.float]
kind = "free"
parent = "ground"
child = "ball"
[initial]
q_slide = 1.0
[integration]
t_end = 3.0
points = 4
"""


@pytest.fixture
def run():
    runner = CliRunner()
    return lambda *words: runner.invoke(main, [str(w) for w in words], catch_exceptions=False)


@pytest.fixture
def spring(tmp_path):
    file = tmp_path / "spring.toml"
    file.write_text(SPRING, encoding="utf-8")
    return file


def test_a_file_goes_all_the_way(run, spring, tmp_path):
    done = run("derive", spring)
    assert done.exit_code == 0, done.output
    assert "k  stiffness [N/m]" in done.output
    assert "kinetic_energy" in done.output
    saved = tmp_path / "run.npz"
    done = run("simulate", spring, "--method", "DOP853", "--target", "numpy", "--out", saved)
    assert done.exit_code == 0, done.output
    with np.load(saved) as data:
        np.testing.assert_allclose(data["q_slide"], np.cos(2 * data["t"]), atol=1e-8)
    assert "drift of energy" in done.output


def test_states_that_no_output_needs_are_reported(run, spring):
    spring.write_text(SPRING.replace(', "energies"', ""), encoding="utf-8")
    done = run("simulate", spring, "--target", "numpy")
    assert "w_float_1" in done.output
    assert "no output needs them" in done.output


@pytest.mark.parametrize("target", ["c", "numpy", "python", "javascript"])
def test_generate(run, spring, tmp_path, target):
    done = run("generate", spring, "--target", target, "--out", tmp_path / "code")
    assert done.exit_code == 0, done.output
    assert "wrote" in done.output


def test_a_robot_goes_all_the_way(run, tmp_path):
    pytest.importorskip("yourdfpy")
    done = run("derive", WALKER)
    assert "tau_hip" in done.output
    assert "not used: <link/visual>" in done.output
    done = run("simulate", WALKER, "--t-end", "0.1", "--target", "numpy", "--method", "DOP853")
    assert done.exit_code == 0, done.output
    assert "reached t = 0.1 s" in done.output
    done = run("accuracy", WALKER, "--target", "python", "--samples", 2)
    assert done.exit_code == 0, done.output
    assert "u_mast_pin'" in done.output
    done = run("generate", WALKER, "--target", "python", "--out", tmp_path)
    assert [f.name for f in tmp_path.iterdir()] == ["walker.py"]


def test_a_robot_is_read_leniently_and_freed_of_the_ground(run, tmp_path):
    pytest.importorskip("yourdfpy")
    file = tmp_path / "odd.urdf"
    file.write_text(
        '<robot name="odd"><link name="trunk"><inertial><mass value="2"/>'
        '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="4"/></inertial></link></robot>',
        encoding="utf-8",
    )
    assert "no body has this inertia" in run("derive", file).output
    for words in (("derive", file), ("plot", file, "--list")):
        done = run(*words, "--lenient", "--floating")
        assert "note: inertias that no body has" in done.output
        assert "link 'trunk': nearest possible inertia taken" in done.output
    done = run("derive", file, "--lenient", "--floating")
    assert "w_root" in done.output or "ω" in done.output
    for name in ("double-pendulum", "heavy-top"):
        done = run("derive", name, "--floating")
        assert done.exit_code == 2
        assert "only robots" in done.output
    done = run("derive", "euler-equations", "--lenient")
    assert "--lenient is for robots" in done.output


def test_a_model_of_mujoco_goes_all_the_way(run, tmp_path):
    pytest.importorskip("mujoco")
    file = tmp_path / "swing.xml"
    file.write_text(
        "<mujoco><worldbody><body name='a'><joint name='hinge' axis='0 1 0' limited='true' "
        "range='-1 1'/><geom size='.1' pos='.5 0 0'/></body></worldbody></mujoco>",
        encoding="utf-8",
    )
    done = run("derive", file)
    assert done.exit_code == 0, done.output
    assert "note: limits: joint 'hinge': left out" in done.output
    assert run("plot", file, "--list").exit_code == 0
    done = run("derive", file, "--floating")
    assert done.exit_code == 2
    assert "one body that is fixed" in done.output


def test_an_ensemble_varies_starts_and_parameters(run, spring):
    words = (
        "ensemble",
        spring,
        "--vary",
        "k=uniform(3, 5)",
        "--count",
        4,
        "--t-end",
        "0.5",
        "--json",
    )
    done = run(*words)
    assert done.exit_code == 0, done.output
    assert set(json.loads(done.stdout)["statistics"]) == {
        "q_slide", "kinetic_energy", "potential_energy",
    }  # fmt: skip
    done = run("ensemble", "satellite-with-panels", "--vary", "e_base_1=0.1", "--count", 2)
    assert done.exit_code == 2
    assert "one component of an attitude" in done.stderr
    assert "e_base_0,e_base_1,e_base_2,e_base_3=attitude()" in done.stderr


MISTAKES = {
    "closed form": (["generate", "double-pendulum", "--closed-form", "--out", "x"], "closed form"),
    "near name": (["derive", "doubl-pendulum"], "double-pendulum"),
    "near name to run": (["simulate", "doubl-pendulum"], "double-pendulum"),
    "no robot": (["simulate", "no/robot.urdf"], "no such scene file"),
    "no state": (
        ["ensemble", "double-pendulum", "--vary", "q_shouldr=1", "--count", "2"],
        "q_shoulder",
    ),
    "explained": (
        ["derive", "double-pendulum", "--notation", "arrow"],
        "--notation is for derivations",
    ),
    "method of one body": (
        ["derive", "heavy-top", "--method", "kane"],
        "--method is for scenes of many bodies",
    ),
    "method of a derivation": (
        ["derive", "gyrostat", "--method", "kane"],
        "--method is for scenes of many bodies",
    ),
    "angles of a derivation": (
        ["derive", "gyrostat", "--absolute"],
        "--absolute is for scenes of many bodies",
    ),
    "unknown method": (["derive", "double-pendulum", "--method", "lagrang"], "lagrange"),
    "unknown format": (["derive", "double-pendulum", "--method", "all", "--as", "pdf"], "latex"),
    "angles without a method": (
        ["derive", "double-pendulum", "--absolute"],
        "--absolute is for closed forms, by --method",
    ),
    "no angles to add up": (
        ["derive", "satellite-with-panels", "--method", "kane", "--absolute"],
        "no angles that hang on others",
    ),
    "explained method": (
        ["derive", "double-pendulum", "--method", "kane", "--explain"],
        "--explain is for equations without --method",
    ),
    "bound": (["derive", "rolling-disc", "--method", "all"], "--attitude"),
    "name": (["derive", "double-pendulum", "--method", "kane", "--name", "q"], "OLD=NEW"),
    "name without": (["derive", "double-pendulum", "--name", "a=b"], "by --method"),
    "attitude": (
        ["derive", "double-pendulum", "--method", "kane", "--attitude", "3-1-2"],
        "no joint has",
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_one_message(run, name):
    words, expected = MISTAKES[name]
    done = run(*words)
    assert done.exit_code == 2
    assert done.stderr.startswith("error: ")
    assert expected in done.stderr


PAGES = {
    "text": ("lagrange", "double pendulum by Lagrange"),
    "latex": ("kane", r"\section"),
    "markdown": ("newton-euler", "# "),
    "html": ("all", "<"),
}


@pytest.mark.sparse(1)
@pytest.mark.parametrize("style", PAGES)
def test_closed_forms_are_the_pages_of_the_tree(run, style):
    method, begin = PAGES[style]
    done = run("derive", "double-pendulum", "--method", method, "--as", style)
    assert done.exit_code == 0, done.output
    assert begin in done.output[:1000]
    tree = TreeScene.ready("double-pendulum").tree
    assert done.output == tree_page(tree, method, style) + "\n"


def test_angles_against_the_ground(run):
    done = run("derive", "double-pendulum", "--method", "lagrange", "--absolute")
    tree = TreeScene.ready("double-pendulum").tree
    assert done.output == tree_page(tree, "lagrange", coordinates=absolute_angles(tree)) + "\n"
    assert "θ_elbow" in done.output


def test_speeds_may_be_the_rates_of_coordinates(run):
    """The disc in angles: Greenwood, Advanced Dynamics (2003), ch. 4."""
    names = [f"--name=q_disc_{k}={n}" for k, n in enumerate(("psi", "theta", "phi"), 1)]
    done = run(
        "derive", "rolling-disc", "--method", "kane", "--attitude", "3-1-2", "--rates", *names
    )
    assert done.exit_code == 0
    assert "(1 + 5 sin²(θ)) ψ̈ + 6 sin(θ) φ̈" in done.output
    assert "3 sin(θ) ψ̈ + 3 φ̈ + 5 cos(θ) ψ̇ θ̇" in done.output
    refused = run("derive", "double-pendulum", "--rates")
    assert "--rates is for closed forms" in refused.stderr


def test_constrained_scenes_have_closed_forms(run):
    """The disc by angles; the crank under another name, its piston kept."""
    words = ["derive", "rolling-disc", "--method", "all", "--attitude", "3-1-2"]
    done = run(*words)
    assert done.exit_code == 0
    assert "v_(disc,1) = r q̇_(disc,3) cos(q_(disc,3))" in done.output
    words = ["derive", "slider-crank", "--method", "kane", "--absolute"]
    done = run(*words, "--independent", "u_piston", "--name", "u_piston=v")
    assert done.exit_code == 0
    assert "cos(θ_crank)/" in done.output
    assert "v̇" in done.output


@pytest.mark.sparse(only=("pendulum-on-cart-kane",))
@pytest.mark.parametrize("method", ["kane", "all"])
@pytest.mark.parametrize("name", ["pendulum-on-cart", "seven-joint-arm", "floating-tree"])
def test_large_scenes_have_no_closed_form(run, name, method):
    done = run("derive", name, "--method", method)
    assert done.exit_code == 2
    assert done.stderr.startswith("error: ")
    assert "too large to be read" in done.stderr or "too many speeds" in done.stderr
    assert "no such limit" in done.stderr


def test_a_long_pendulum_is_short_in_angles_against_the_ground(run):
    done = run("derive", "pendulum-on-cart", "--method", "kane", "--absolute")
    assert done.exit_code == 0, done.output
    assert "θ_hinge5" in done.output
