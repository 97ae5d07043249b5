"""The command that linearises scenes."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from eom.commands.linearising import linearise
from eom.errors import InputError

PLATE = """
title = "Plate on a spring about its third axis"
attitude = "none"
[body]
moments = [1.0, 2.0, 2.5]
[torque]
components = ["-k*omega_1", "-k*omega_2", "M - k*omega_3"]
[parameters]
k = 0.5
M = 1.0
[initial]
omega_1 = 0.1
omega_2 = 0.0
omega_3 = 0.3
[integration]
t_end = 20.0
"""


@pytest.fixture
def plate(tmp_path):
    file = tmp_path / "plate.toml"
    file.write_text(PLATE)
    return str(file)


def run(*arguments):
    return CliRunner().invoke(linearise, [*arguments, "--target", "numpy"], catch_exceptions=True)


def test_matrices_are_printed_with_names(plate):
    result = run(plate)
    assert result.exit_code == 0, result.output
    lines = result.output.splitlines()
    assert "  omega_3 = 2" in lines  # M / k
    head = next(k for k, line in enumerate(lines) if line.startswith("A "))
    assert lines[head].split() == ["A", "omega_1", "omega_2", "omega_3"]
    rows = {line.split()[0]: line.split()[1:] for line in lines[head + 1 : head + 4]}
    assert rows["omega_1"][:2] == ["-0.5", "-1"]  # (I2 - I3) omega_3 / I1
    assert rows["omega_3"][2] == "-0.2"
    assert any(line.startswith("asymptotically stable") for line in lines)
    assert "agreement" in lines[-1]


def test_a_defective_eigenvalue_is_printed_to_its_digits(tmp_path):
    """x'' = -x' / 2 - x / 16, critically damped: -1/4 twice, and no zero."""
    plate = PLATE.replace('["-k*omega_1", "-k*omega_2"', '["u_1", "-omega_2"')
    plate = plate.replace("[1.0, 2.0, 2.5]", "[1, 1, 1]").replace("M = 1.0", "M = 0.0")
    law = 'laws = { u_1 = "-k*omega_1 - z/16" }\nstates = { z = { rate = "omega_1" } }\n'
    file = tmp_path / "critical.toml"
    file.write_text(f"{plate}[control]\n{law}")
    lines = run(str(file)).output.splitlines()
    first = lines.index("eigenvalues (1/s)")
    assert lines[first + 1 : first + 5] == ["  -0.25", "  -0.25", "  -0.5", "  -1"]
    assert lines[first + 5].startswith("asymptotically stable: largest real part -0.25 1/s")


def test_json_holds_the_same(plate):
    found = json.loads(run(plate, "--json").output)
    assert found["states"] == ["omega_1", "omega_2", "omega_3"]
    assert np.array(found["A"]) == pytest.approx(
        np.array([[-0.5, -1, 0], [1.5, -0.25, 0], [0, 0, -0.2]])
    )
    assert found["point"]["kind"] == "isolated"
    assert found["stability"]["kind"] == "asymptotically stable"
    assert found["agreement"] < 1e-14
    assert found["B"] == [[], [], []]
    assert len(found["eigenvalues"]) == 3


def test_a_ready_scene_with_a_quaternion():
    found = json.loads(run("gravity-gradient-satellite", "--attitude", "angles", "--json").output)
    assert len(found["states"]) == 6
    assert found["point"]["rank"] == 7
    assert found["doubtful"] == ["tilt"]  # an angle by its cosine, zero there
    assert run("gravity-gradient-satellite", "--attitude", "angles").output.count("angle_q1") >= 2


def test_a_steady_motion_of_a_handle():
    """Spin about the middle axis: growth at nu sqrt((I1 - I2)(I2 - I3) / (I1 I3))."""
    angles = [x for n in ("psi", "theta", "phi") for x in ("--cyclic", n)]
    found = json.loads(run("t-handle-in-angles", *angles, "--at", "omega_2=10", "--json").output)
    I1, I2, I3 = (found["point"]["parameters"][f"I{k}"] for k in (1, 2, 3))
    growth = 10 * np.sqrt((I1 - I2) * (I2 - I3) / (I1 * I3))
    assert found["stability"]["kind"] == "unstable"
    assert found["stability"]["growth"] == pytest.approx(growth, rel=1e-12)
    assert set(found["cyclic"]) == {"psi", "theta", "phi"}
    assert "steady motion" in run("t-handle-in-angles", *angles, "--at", "omega_2=10").output


def test_held_values(plate):
    held = run(plate, "--at", "omega_3=2")
    assert held.exit_code == 0
    assert "rank 2 of 2" in held.output


def test_held_values_are_formulas(plate):
    assert "  omega_3 = 2" in run(plate, "--at", "omega_3 = M/k").output
    found = json.loads(run("double-pendulum", "--at", "q_shoulder=-pi", "--json").output)
    assert found["point"]["states"]["q_shoulder"] == -np.pi


def test_a_state_that_has_to_run_is_named():
    result = run("t-handle-in-angles", "--at", "omega_2=10")
    assert isinstance(result.exception, InputError)
    assert result.exception.hint.endswith("--cyclic psi")
    assert run("t-handle-in-angles", "--at", "omega_2=10", "--cyclic", "psi").exit_code == 0


def test_noise_is_printed_as_zero():
    lines = run("gravity-gradient-satellite").output.splitlines()
    assert {"  omega_1 = 0", "  omega_2 = 0", "  q1 = 0", "  q2 = 0", "  q3 = 0"} <= {*lines}
    assert not [line for line in lines if "e-2" in line and "agreement" not in line]


@pytest.mark.sparse(4)
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--at", "omega_3"], "not a value"),
        (["--at", "omega_3=fast"], "'fast'"),
        (["--at", "omega_3=1/0"], "omega_3=1/0"),
        (["--at", "omega_3=sqrt(-1)"], "not real"),
        (["--at", "omega_3=__import__('os')"], "cannot be read"),
        (["--at", "=1"], "not a value"),
        (["--at", "omega_9=1"], "cannot be held"),
        (["--at", "omega_3=1"], "no equilibrium"),
        (["--cyclic", "phi"], "phi"),
        (["--cyclic", "omega_1"], "not cyclic"),
        (["--free", "thrust"], "thrust"),
        (["--keep", "weight"], "unknown constraint"),
        (["--attitude", "euler"], "attitude"),
        (["--starts", "0"], "starts"),
    ],
)
def test_wrong_options_are_one_message(plate, arguments, message):
    result = run(plate, *arguments)
    assert isinstance(result.exception, InputError)
    assert message in str(result.exception)
    assert result.output == ""
