"""Angles of a ball joint's quaternion, beside a tree whose joint has the angles themselves."""

import numpy as np
import pytest

import codegen
from eom.errors import InputError
from eom.multibody.files.scene import TreeScene

NAMES = ("q_ball_1", "q_ball_2", "q_ball_3")


STATES = {"w_ball_1": 1.0, "w_ball_2": 0.2, "w_ball_3": 3.0}
START = {"ball": {"sequence": "3-1-3", "degrees": (20, 30, 10)}}


def tree(outputs=(), initial=STATES, initial_attitude=START, **joint):
    return TreeScene(
        bodies={"arm": {"mass": 2.0, "centre": (0, 0, -0.4), "moments": (0.1, 0.1, 0.004)}},
        joints={"ball": {"kind": "spherical", "parent": "ground", "child": "arm", **joint}},
        gravity=(0, 0, -9.81),
        initial=initial,
        initial_attitude=initial_attitude,
        outputs=outputs,
    )


def run_of(scene):
    made = codegen.compile(scene.derive(), "python")
    known = scene.initial_values(), (0, 2), scene.parameter_values()
    return codegen.simulate(made, *known, "DOP853", 1e-12, t_eval=np.linspace(0, 2, 41))


def test_angles_of_a_joint_are_those_of_a_run_in_angles():
    own = run_of(tree(attitude="3-1-3"))
    scene = tree(angles="3-1-3")
    assert scene.requested[-3:] == NAMES
    over = run_of(scene)
    assert np.ptp(own["q_ball_1"]) > 2 * np.pi
    for name in NAMES:
        np.testing.assert_allclose(over[name], own[name], rtol=0, atol=1e-9)


def test_angles_can_be_asked_for_alone():
    scene = tree(angles="3-2-1", outputs=("q_ball_2",))
    assert scene.requested == ("q_ball_2",)
    assert scene.derive().output_names == ("q_ball_2",)


def test_a_joint_in_angles_that_stops_names_the_way_out():
    still = {"w_ball_2": 9.0}
    level = {"ball": {"sequence": "3-2-1", "degrees": (0, 0, 0)}}
    run = run_of(tree(attitude="3-2-1", initial=still, initial_attitude=level))
    assert run.status == 1
    assert 'attitude = "quaternion" and angles = "3-2-1" of joint ball' in run.message
    assert run_of(tree(angles="3-2-1", initial=still, initial_attitude=level)).status == 0


BAD = {
    "a sequence": ({"angles": "3-3-1"}, "unknown rotation sequence"),
    "angles of angles": ({"angles": "3-2-1", "attitude": "3-1-3"}, "moves in a quaternion"),
    "a hinge": (
        {"angles": "3-2-1", "kind": "revolute", "initial": {}, "initial_attitude": {}},
        "moves in a quaternion",
    ),
    "an output without it": ({"outputs": NAMES}, "unknown output"),
}


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_is_one_clear_error(case):
    data, words = BAD[case]
    with pytest.raises(InputError, match=words):
        tree(**data)
