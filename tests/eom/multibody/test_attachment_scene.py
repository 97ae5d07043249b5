"""Rotors, springs and points in scene files: what Python says, outputs, starts, mistakes."""

import pytest
import sympy as sp

import codegen
from eom.errors import InputError
from eom.multibody import Point, Reaction, Rotor, Spring, derive
from eom.multibody.files.scene import TreeScene

R, G = (sp.Symbol(n, real=True) for n in "rg")
TIME = sp.Symbol("t", real=True)


def data(**changes):
    body = {"mass": 1.0, "moments": [1, 1, 1]}
    return {
        "model": "tree",
        "parameters": {"r": 0.5, "g": 9.81},
        "gravity": [0, 0, "-g"],
        "bodies": {"one": {**body, "centre": ["r", 0, 0]}, "two": {**body, "centre": [0, 0.3, 0]}},
        "joints": {
            "a": {"kind": "spherical", "parent": "ground", "child": "one", "attitude": "3-1-2"},
            "b": {"kind": "revolute", "parent": "one", "child": "two", "axis": "y",
                  "on_parent": {"position": ["2*r", 0, 0]}},
        },
        **changes,
    }  # fmt: skip


def rotor(**keys):
    return {"rotors": {"w": {"body": "two", "inertia": 0.1, **keys}}}


def spring(**keys):
    return {"springs": {"s": {"first": "ground", "second": "two", **keys}}}


def point(**keys):
    return {"points": {"tip": {"body": "two", **keys}}}


W = sp.Symbol("Omega_w", real=True)
ROTORS = {
    "driven": (
        {"axis": [0, 3, 4], "inertia": "r/10", "damping": 0.01, "motor": True, "angle": True,
         "torque": "-r*Omega_w + q_b*cos(t)"},
        Rotor("w", "two", (0, 3, 4), R / 10, 0.01,
              -R * W + sp.Symbol("q_b", real=True) * sp.cos(TIME), motor=True, angle=True),
    ),
    "given": (
        {"axis": "x", "speed": "r*sin(3*t)"},
        Rotor("w", "two", (1, 0, 0), 0.1, speed=R * sp.sin(3 * TIME)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", ROTORS)
def test_a_rotor_is_the_one_of_python(kind):
    given, expected = ROTORS[kind]
    scene = TreeScene(**data(**rotor(**given)))
    assert scene.tree.rotors == (expected,)
    assert scene.derive().state_names[4:] == (
        *("w_a_1", "w_a_2", "w_a_3", "u_b"),
        *(q.name for q in expected.states),
    )
    assert scene.derive().input_names == tuple(m.name for m in expected.motors)


def test_a_spring_is_the_one_of_python():
    given = spring(first_point=["r", 0, 1], second_point=[0, 0, "-r"], stiffness="4*g",
                   length=0.2, damping=0.5)  # fmt: skip
    scene = TreeScene(**data(**given))
    expected = Spring("s", ("ground", "two"), ((R, 0, 1), (0, 0, -R)), 4 * G, 0.2, 0.5)
    assert scene.tree.springs == (expected,)


def test_points_are_reported_where_no_output_is_named():
    scene = TreeScene(**data(**point(position=[0, "r", 0])))
    names = tuple(f"{letter}_tip_{k}" for letter in "xva" for k in (1, 2, 3))
    system = scene.derive()
    assert system.output_names == names
    assert sorted(scene.requested) == sorted((*system.state_names, *names))
    expected = derive(scene.tree, [Point("tip", "two", (0, R, 0))])
    assert [d.quantity.unit for d in system.outputs] == ["m"] * 3 + ["m/s"] * 3 + ["m/s^2"] * 3
    assert system.outputs == expected.outputs


def test_what_is_asked_for_of_points_joints_and_rotors_comes_together():
    given = data(
        **rotor(motor=True), **point(), outputs=["a_tip_3", "Omega_w", "F_b_2", "energies"]
    )
    made = TreeScene(**given)
    outputs = ("kinetic_energy", "potential_energy", "F_b_2", "a_tip_3")
    assert sorted(made.derive().output_names) == sorted(outputs)
    assert set(made.requested) == {*outputs, "Omega_w"}
    every = TreeScene(**data(**rotor(motor=True), **point(), outputs=["points", "reactions"]))
    assert set(every.derive().output_names) == {
        *Point("tip", "two").names, *Reaction("a").names, *Reaction("b").names,
    }  # fmt: skip


def test_a_position_costs_no_reaction():
    one = TreeScene(**data(**point(), outputs=["x_tip_1"])).derive()
    more = TreeScene(**data(**point(), outputs=["x_tip_1", "F_b_2"])).derive()
    assert one.output_names == ("x_tip_1",)
    assert len(one.definitions) < len(more.definitions)


def test_rotors_start_as_they_are_given():
    scene = TreeScene(**data(**rotor(angle=True), initial={"Omega_w": "200*r", "q_b": 1}))
    start = scene.initial_values()
    assert (start["Omega_w"], start["q_w"], start["q_b"]) == (100.0, 0.0, 1.0)


def test_rotors_and_springs_under_constraints_keep_the_energy():
    rod = {
        "kind": "distance",
        "first": "ground",
        "second": "two",
        "length": 1.5,
        "first_point": [0, 0, 1],
    }
    given = data(**rotor(axis="x"), **spring(first_point=[0, 0, 2], stiffness=20, length=0.5),
                 constraints={"rod": rod}, initial={"Omega_w": 80, "q_b": 0.4, "u_b": 0.5})  # fmt: skip
    scene = TreeScene(**given)
    assert scene.initial_values()["Omega_w"] == 80
    run = codegen.simulate(
        codegen.compile(scene.derive(), "python"), scene.initial_values(), (0.0, 0.3),
        scene.parameter_values(), "DOP853", 1e-10,
    )  # fmt: skip
    assert run.drift["energy"].relative < 1e-8
    assert max(run["u_b"]) - min(run["u_b"]) > 0.1


MISTAKES = {
    "rotor on unknown body": (rotor(body="tow"), "unknown body 'tow'", "rotor 'w'", "two"),
    "key of a rotor": (rotor(inertai=1), "unknown key 'inertai'", "rotors.w", "inertia"),
    "no moment": ({"rotors": {"w": {"body": "two"}}}, "missing key", "rotors.w.inertia", ""),
    "no body": ({"rotors": {"w": {"inertia": 1}}}, "missing key", "rotors.w.body", ""),
    "moment zero": (rotor(inertia=0), "inertia is not positive", "rotor 'w'", ""),
    "axis of a rotor": (rotor(axis="w"), "unusable value", "rotors.w.axis", ""),
    "no axis": (rotor(axis=[0, 0, 0]), "axis is zero", "rotor 'w': axis", ""),
    "motor by a number": (rotor(motor=1), "unusable value", "rotors.w.motor", ""),
    "two drives": (rotor(speed=3, motor=True), "leaves no room", "rotor 'w'", ""),
    "state in a moment": (rotor(inertia="q_b"), "unknown name 'q_b'", "rotor 'w': inertia", ""),
    "time in damping": (rotor(damping="t"), "unknown name 't'", "rotor 'w': damping", ""),
    "state in a speed": (rotor(speed="u_b"), "unknown name 'u_b'", "rotor 'w': speed", ""),
    "unknown in a torque": (rotor(torque="Omega_x"), "unknown name", "rotor 'w': torque", "Omega_w"),
    "code in a torque": (rotor(torque="open('x')"), "", "rotor 'w': torque", ""),
    "state of a given speed": (
        {**rotor(speed=1), "initial": {"Omega_w": 1}},
        "unknown state 'Omega_w'",
        "[initial]",
        "",
    ),
    "parameter of this name": (
        {**rotor(), "parameters": {"r": 1, "g": 1, "Omega_w": 1}},
        "a joint or rotor has this name",
        "[parameters]",
        "",
    ),
    "rotor named as a joint": (
        {"rotors": {"b": {"body": "two", "inertia": 1}}},
        "a joint has this name",
        "rotor 'b'",
        "",
    ),
    "name of a rotor": (
        {"rotors": {"a b": {"body": "two", "inertia": 1}}},
        "not a name",
        "rotor 'a b'",
        "",
    ),
    "spring on unknown body": (spring(second="tow"), "unknown body 'tow'", "spring 's'", "two"),
    "spring on one body": (spring(first="two"), "both ends are on one body", "spring 's'", ""),
    "no second body": ({"springs": {"s": {"first": "one"}}}, "missing key", "springs.s.second", ""),
    "key of a spring": (spring(stifness=1), "unknown key", "springs.s", "stiffness"),
    "state in a stiffness": (spring(stiffness="q_b"), "unknown name", "spring 's': stiffness", ""),
    "name in a length": (spring(length="l0"), "unknown name 'l0'", "spring 's': length", ""),
    "name in a point": (
        spring(first_point=["x", 0, 0]),
        "unknown name 'x'",
        "spring 's': first_point",
        "",
    ),
    "two components": (
        spring(second_point=[0, 1]),
        "too few values",
        "springs.s.second_point",
        "",
    ),
    "point on unknown body": (point(body="tow"), "unknown body 'tow'", "point 'tip'", "two"),
    "point on nothing": ({"points": {"tip": {}}}, "missing key", "points.tip.body", ""),
    "key of a point": (point(positon=[0, 0, 0]), "unknown key", "points.tip", "position"),
    "state in a position": (
        point(position=["q_b", 0, 0]),
        "unknown name 'q_b'",
        "point 'tip': position",
        "",
    ),
    "name of a point": ({"points": {"a b": {"body": "two"}}}, "not a name", "point 'a b'", ""),
    "point named as a state": (
        {"joints": {"a": {"kind": "free", "parent": "ground", "child": "one"},
                    "b": {"kind": "revolute", "parent": "one", "child": "two"}},
         "points": {"a": {"body": "two"}}},
        "something else has the name of this output",
        "point 'a'",
        "",
    ),
    "unknown output of a point": (
        {**point(), "outputs": ["x_tp_1"]},
        "unknown output 'x_tp_1'",
        "outputs",
        "x_tip_1",
    ),
    "unknown reaction": ({"outputs": ["F_c_1"]}, "unknown output 'F_c_1'", "outputs", "F_b_1"),
    "drive of a free joint": ({"outputs": ["tau_b"]}, "unknown output 'tau_b'", "outputs", ""),
    "force of no constraint": (
        {"outputs": ["lambda_pin_x"]},
        "unknown output 'lambda_pin_x'",
        "outputs",
        "",
    ),
    "unused parameter": (
        {**point(position=[0, "r", 0]), "parameters": {"r": 1, "g": 1, "h": 1}},
        "no formula uses 'h'",
        "[parameters]",
        "",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_one_error_that_names_the_place(name):
    changes, what, where, hint = MISTAKES[name]
    with pytest.raises(InputError) as caught:
        TreeScene(**data(**changes)).derive()
    assert what in str(caught.value)
    assert where in caught.value.where
    assert hint in caught.value.hint
