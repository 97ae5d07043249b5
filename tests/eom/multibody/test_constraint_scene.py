"""Constraints in scene files: every kind, start values, outputs, mistakes."""

import math

import pytest
import sympy as sp

from eom.errors import InputError
from eom.multibody import (
    Coupling,
    Distance,
    Equation,
    KnifeEdge,
    Loop,
    Placement,
    Rolling,
    SpeedEquation,
)
from eom.multibody.files.scene import TreeScene

R = sp.Symbol("r", real=True)


def data(constraints, **changes):
    body = {"mass": 1.0, "moments": [1, 1, 1]}
    return {
        "model": "tree",
        "parameters": {"r": 0.5},
        "bodies": {"one": body, "two": body, "three": body},
        "joints": {
            "a": {"kind": "revolute", "parent": "ground", "child": "one"},
            "b": {"kind": "revolute", "parent": "one", "child": "two",
                  "on_parent": {"position": ["r", 0, 0]}},
            "c": {"kind": "free", "parent": "ground", "child": "three"},
        },
        "constraints": constraints,
        **changes,
    }  # fmt: skip


KINDS = {
    "loop": (
        {"kind": "loop", "joint": "universal", "first": "two", "second": "three", "axis": "x",
         "second_axis": [0, 3, 4], "on_first": {"position": ["2*r", 0, 0]}},
        Loop("c1", "universal", "two", "three", "x", (0, 3, 4), Placement((2 * R, 0, 0))),
    ),
    "distance": (
        {"kind": "distance", "first": "two", "second": "three", "length": "r",
         "second_point": [0, 1, 0]},
        Distance("c1", "two", "three", R, second_point=(0, 1, 0)),
    ),
    "wheel": (
        {"kind": "rolling", "body": "three", "radius": "r", "axis": "y", "origin": [0, 0, -1]},
        Rolling("c1", "three", R, "y", origin=(0, 0, -1)),
    ),
    "ball": (
        {"kind": "rolling", "body": "three", "radius": "r", "ball": True},
        Rolling("c1", "three", R, None),
    ),
    "knife_edge": (
        {"kind": "knife_edge", "body": "three", "point": ["r", 0, 0]},
        KnifeEdge("c1", "three", point=(R, 0, 0)),
    ),
    "equation": (
        {"kind": "equation", "expression": "x_c - r*cos(t)"},
        Equation("c1", sp.Symbol("x_c", real=True) - R * sp.cos(sp.Symbol("t", real=True))),
    ),
    "speeds": (
        {"kind": "speed_equation", "expression": "u_a - r*u_b"},
        SpeedEquation("c1", sp.Symbol("u_a", real=True) - R * sp.Symbol("u_b", real=True)),
    ),
    "coupling": (
        {"kind": "coupling", "ratios": {"a": "r", "b": -2}},
        Coupling("c1", {"a": R, "b": -2}),
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_the_one_of_python(kind):
    given, expected = KINDS[kind]
    scene = TreeScene(**data({"c1": given}, initial={"z_c": 1.0}))
    assert scene.tree.constraints == (expected,)


MISTAKES = {
    "unknown body 'four'": {"kind": "knife_edge", "body": "four"},
    "no joint of kind 'free'": {"kind": "loop", "joint": "free", "first": "one", "second": "two"},
    "unknown name": {"kind": "equation", "expression": "x_q - r"},
    "the equation has speeds": {"kind": "equation", "expression": "x_c - r*u_a"},
    "welded": {"kind": "welded", "body": "one"},
    "radius": {"kind": "rolling", "body": "one"},
}


@pytest.mark.parametrize("message", MISTAKES)
def test_a_mistake_is_one_error(message):
    with pytest.raises(InputError) as error:
        TreeScene(**data({"c1": MISTAKES[message]}))
    assert message in str(error.value)
    assert "c1" in str(error.value)


def test_keep_needs_constraints_and_known_names():
    with pytest.raises(InputError, match="keep belongs to constraints"):
        TreeScene(**data({}, keep=["q_a"], parameters={"r": 1}))
    with pytest.raises(InputError, match="unknown speed or coordinate"):
        TreeScene(**data({"c1": KINDS["coupling"][0]}, keep=["q_x"]))


def test_the_ready_linkage_starts_assembled_with_its_crank_as_given():
    scene = TreeScene.ready("four-bar-linkage")
    start = scene.initial_values()
    assert (start["q_crank"], start["u_crank"]) == (0.3, 20.0)
    a, b, c = start["q_crank"], start["q_crank"] + start["q_knee"], start["q_rocker"]
    left = (0.4 * math.cos(a) + 1.1 * math.cos(b) - 1.2 - 0.9 * math.cos(c),
            0.4 * math.sin(a) + 1.1 * math.sin(b) - 0.9 * math.sin(c))  # fmt: skip
    assert left == pytest.approx((0, 0), abs=1e-14)


def test_forces_of_constraints_can_be_asked_for():
    ready = TreeScene.ready("four-bar-linkage").model_dump(exclude_unset=True)
    both = TreeScene(**{**ready, "outputs": ["constraint_forces", "q_crank"]})
    assert both.derive().output_names == ("lambda_pin_x", "lambda_pin_y")
    one = TreeScene(**{**ready, "outputs": ["lambda_pin_y"]})
    assert one.derive().output_names == ("lambda_pin_y",)


def test_a_coupler_without_mass_is_explained():
    ready = TreeScene.ready("four-bar-linkage").model_dump(exclude_unset=True)
    parameters = {n: v for n, v in ready["parameters"].items() if n != "m2"}
    bodies = {**ready["bodies"], "coupler": {}}
    light = TreeScene(**{**ready, "bodies": bodies, "parameters": parameters})
    assert "joint knee moves no mass" in str(light.explain())
    assert len(light.derive().state_names) == 4


def test_the_ready_disc_has_three_speeds_and_names_the_others():
    system = TreeScene.ready("rolling-disc").derive()
    assert len(system.state_names) == 10
    assert system.output_names == ("v_disc_1", "v_disc_2", "v_disc_3")
    assert system.maintained == ("closure_floor_z",)
