"""`eom analyse`: what is cyclic, steady, stable and conserved, from a scene file."""

import pytest
from click.testing import CliRunner

from eom.__main__ import main

HOOP = """
model = "tree"
title = "Bead on a hoop that turns"
gravity = [0, 0, "-g"]

[parameters]
m = { value = 0.1, unit = "kg" }
R = { value = 0.5, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
Omega = { value = 6.0, unit = "rad/s" }

[bodies.hoop]

[bodies.bead]
mass = "m"
centre = [0, 0, "-R"]

[joints.hoop]
kind = "revolute"
parent = "ground"
child = "hoop"
motion = { position = "Omega*t" }

[joints.swing]
kind = "revolute"
parent = "hoop"
child = "bead"
axis = "y"

[initial]
q_swing = 0.1
"""


@pytest.fixture
def analyse(tmp_path):
    file = tmp_path / "hoop.toml"
    file.write_text(HOOP, encoding="utf-8")
    runner = CliRunner()
    return lambda *words: runner.invoke(
        main, ["analyse", str(file), *words], catch_exceptions=False
    )


def test_the_lowest_place_is_stable_where_the_hoop_is_slow(analyse):
    done = analyse("--name", "q_swing=theta", "--at", "theta=0")
    assert done.exit_code == 0
    assert "Taken to be positive: Ω, R, g, m." in done.output
    assert "g − Ω² R > 0" in done.output
    assert "C₁ = R θ̇² + Ω² R cos²(θ) − 2 g cos(θ)" in done.output


def test_values_are_formulas_and_conditions_are_solved(analyse):
    assert "Never stable" in analyse("--at", "q_swing=pi", "--small", "0").output
    solved = analyse("--solve", "g", "--small", "0", "--rates", "0", "--as", "latex")
    assert solved.exit_code == 0
    assert r"\Omega^{2} R" in solved.output


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--at", "q_swing"], "NAME=VALUE"),
        (["--at", "q_what=1"], "no such coordinate or speed"),
        (["--at", "q_swing=__import__"], "error"),
        (["--solve", "m"], "no condition is linear"),
        (["--small", "-1"], "below zero"),
        (["--rates", "99"], "from 0 to 12"),
        (["--as", "paper"], "unknown format"),
        (["--name", "q_swing"], "OLD=NEW"),
        (["--attitude", "3-1-3"], "no joint has an attitude"),
    ],
)
def test_a_mistake_is_one_message(analyse, words, told):
    done = analyse(*words)
    assert done.exit_code == 2
    assert told in done.stderr


def analysed(*words):
    return CliRunner().invoke(main, ["analyse", *words, "--small", "0"], catch_exceptions=False)


def test_scenes_of_one_body_are_analysed():
    done = analysed("bicycle-wheel", "--solve", "phi_dot", "--rates", "0")
    assert done.exit_code == 0
    assert "V_eff  = m g r₂ sin(θ) + pᵩ²/(2 I₂) + (p_ψ − pᵩ sin(θ))²/(2 I₁ cos²(θ))" in done.output
    assert "p = s² + (I₁² ψ̇⁴ − 2 m I₁ g r₂ ψ̇² sin(θ) + m² g² r₂²)/(I₁² ψ̇²)" in done.output


def test_a_disc_rolls_upright_where_it_is_fast():
    """v^2 > g r / 3: Greenwood, Advanced Dynamics (2003), ch. 4; the scene has a quaternion."""
    names = [f"--name=q_disc_{k}={n}" for k, n in enumerate(("psi", "theta", "phi"), 1)]
    done = analysed("rolling-disc", *names, "--at=theta=0", "--at=psi_dot=0", "--rates", "0")
    assert done.exit_code == 0
    assert "Attitude by angles instead of a quaternion: 3-1-2." in done.output
    assert "3 r φ̇² − g > 0" in done.output
    turns = analysed("rolling-disc", *names, "--solve", "phi_dot", "--rates", "0").output
    assert "φ̇ = −(5 r ψ̇² cos(θ) + 4 g) sin(θ)/(6 r ψ̇ cos(θ))" in turns


def test_a_slider_crank_swings_about_its_lowest_place():
    """The rod and the piston move as one with the pin: J + (m2 + m3) r^2; the rod's middle rises half."""
    done = analysed("slider-crank", "--at=q_crank=-pi/2", "--rates", "0", "--harmonics", "0")
    assert done.exit_code == 0
    assert "What is left closes the chain" in done.output
    assert "p = s² + m₂ g r/(2 (J + (m₂ + m₃) r²))" in done.output


def test_laws_of_control_are_no_part_of_it(tmp_path):
    done = CliRunner().invoke(main, ["analyse", "reaction-wheels"])
    assert done.exit_code == 2
    assert done.stderr.startswith("error: ")
