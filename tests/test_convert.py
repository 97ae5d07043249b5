"""``eom convert``, as a user meets it."""

import json

import pytest
from click.testing import CliRunner

from eom.__main__ import main


def convert(*words):
    return CliRunner().invoke(main, ["convert", *words], catch_exceptions=False)


def test_an_attitude_from_one_book_to_another():
    done = convert("--angles", "30, 10, 0", "--from", "aircraft", "--to", "ros")
    assert done.exit_code == 0
    assert "angles 1-2-3    0, -10, 60 deg" in done.stdout
    assert "quaternions have the scalar part last" in done.stdout


def test_a_scene_with_single_choices():
    done = convert("gravity-gradient-satellite", "--scalar", "last", "--body", "frd", "--json")
    data = json.loads(done.stdout)
    assert data["convention"]["scalar"] == "last"
    assert data["omega"] == [1e-4, -2e-4, -1.13e-3]
    assert data["inertia"][0] == [7.0, 0.0, 0.0]


@pytest.mark.parametrize(
    "given", [("--matrix", "0,1,0; 0,0,1; 1,0,0"), ("--quaternion", "1/2,1/2,1/2,1/2")]
)
def test_matrix_and_quaternion_are_one_attitude(given):
    done = convert(*given)
    assert "quaternion      0.5, 0.5, 0.5, 0.5" in done.stdout
    assert "angles 3-2-1    90, 0, 90 deg" in done.stdout


def test_radians():
    assert "angles 3-2-1    90, 0, 0 deg" in convert("--angles", "pi/2,0,0", "--radians").stdout


def test_what_a_matrix_is():
    done = convert("--recognise", "cos(psi), -sin(psi), 0; sin(psi), cos(psi), 0; 0, 0, 1")
    assert done.stdout.splitlines()[0] == "the transpose of a turn about axis 3 by psi"
    done = convert(
        "--recognise", "cos(psi), -sin(psi), 0; sin(psi), cos(psi), 0; 0, 0, 1", "--json"
    )
    assert json.loads(done.stdout)["readings"][0].startswith("the transpose")


BAD = {
    "nothing": ((), "one attitude is needed"),
    "two": (("--angles", "1,2,3", "--quaternion", "1,0,0,0"), "one attitude is needed"),
    "no convention": (("--angles", "1,2,3", "--to", "hugh"), "did you mean hughes"),
    "a name": (("--angles", "1,2,x"), "unknown name 'x'"),
    "code": (("--recognise", "__import__('os'),0,0;0,1,0;0,0,1"), "--recognise"),
    "a letter twice": (("--angles", "1,2,3", "--body", "ffu"), "right-handed"),
    "no scene": (("no-such",), "no-such"),
    "a tree": (("double-pendulum",), "a tree has no one attitude"),
    "ragged": (("--matrix", "1,0;0,1"), "three rows"),
}


@pytest.mark.parametrize(("words", "message"), BAD.values(), ids=BAD)
def test_bad_input_is_one_message(words, message):
    done = convert(*words)
    assert done.exit_code == 2
    assert message in done.stderr
    assert done.stderr.startswith("error: ")
