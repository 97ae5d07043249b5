"""Reactions under constraints: joints carry what constraints and loads leave, and no more."""

import numpy as np
import pytest

import codegen
from eom.multibody import Body, Distance, Joint, KnifeEdge, Tree, derive, reaction
from tests.eom.multibody.test_bicycle import SCENE


def outputs(system, values):
    compiled = codegen.compile(system, "numpy")
    given = [values[n] for n in system.parameter_names]
    x = [values.get(n, 0.0) for n in system.state_names]
    return dict(
        zip(system.output_names, compiled.outputs(0.0, np.array(x), np.array(given)), strict=True)
    )


@pytest.mark.slow
def test_a_free_joint_carries_nothing_though_the_wheels_of_a_bicycle_roll():
    start = {**SCENE.numbers, "z_frame": -0.3}
    system = derive(SCENE.tree, [reaction("frame"), reaction("steer")], start=start,
                    independent=["w_frame_1", "v_frame_1", "u_steer"])  # fmt: skip
    at = {
        **SCENE.parameter_values(),
        "z_frame": -0.3,
        "v_frame_1": 4.0,
        "w_frame_1": 0.2,
        "u_steer": 0.3,
        "q_steer": 0.1,
        "q_frame_2": 0.1,
    }
    found = outputs(system, at)
    carried = [found[f"{x}_frame_{k}"] for x in "FT" for k in (1, 2, 3)]
    assert np.max(np.abs(carried)) < 1e-9
    assert abs(found["F_steer_3"]) > 10


def test_a_rod_takes_what_a_pin_takes():
    """A beam at rest, one end on a cart, the other on a vertical rod: half its weight each."""
    bodies = [Body("cart", 3), Body("beam", 2, (1, 0, 0), (1, 1, 1))]
    joints = [Joint("rail", "prismatic", "ground", "cart", "x"),
              Joint("pin", "revolute", "cart", "beam", "y")]  # fmt: skip
    rod = Distance("rod", "ground", "beam", 3, (2, 0, 3), (2, 0, 0))
    given = Tree("beam", bodies, joints, gravity=(0, 0, -10), constraints=[rod])
    found = outputs(derive(given, [reaction("pin"), reaction("rail")], multipliers=True), {})
    assert [found[f"F_pin_{k}"] for k in (1, 2, 3)] == pytest.approx([0, 0, 10], abs=1e-12)
    assert [found[f"F_rail_{k}"] for k in (1, 2, 3)] == pytest.approx([0, 0, 40], abs=1e-12)


def test_a_sleigh_on_its_knife():
    joint = Joint("base", "planar", "ground", "sleigh")
    body = Body("sleigh", 2, (0.25, 0, 0), (1, 1, 0.5))
    given = Tree("sleigh", [body], [joint], constraints=[KnifeEdge("knife", "sleigh")])
    system = derive(given, [reaction("base", axes="child")])
    names = [n for n in system.state_names if n.startswith(("u_", "v_"))]
    found = outputs(system, dict.fromkeys(names, 2.0))
    assert [found[n] for n in ("F_base_1", "F_base_2", "T_base_3")] == pytest.approx(
        [0, 0, 0], abs=1e-12
    )
