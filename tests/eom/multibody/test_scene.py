"""Scenes of trees: every key of the file, every mistake, start values, repeats, what is left out."""

import math
import re

import numpy as np
import pytest
import sympy as sp

import codegen
import eom
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point, interpret
from eom.errors import InputError
from eom.kinematics.coordinates import rotation_sequence
from eom.multibody import Body, Joint, Load, Motion, Placement, Tree, derive
from eom.multibody.files.scene import MOST, Choice, TreeScene, written_out
from eom.multibody.system.derive import OUTPUTS
from eom.scenes import catalogue
from tests.eom.rows import every, only

TREES = [n for n in catalogue.names() if n not in catalogue.single()]
WHOLE = [n for n in TREES if n != "rocket"]
"""Scenes of which nothing flows off: what flows has momentum beyond that of the centre (`test_jets`)."""


def arm(**changes):
    data = {
        "model": "tree",
        "parameters": {"m": 2.0, "l": {"value": 0.5, "unit": "m", "meaning": "length"}, "g": 9.81},
        "gravity": [0, 0, "-g"],
        "bodies": {
            "upper": {"mass": "m", "centre": [0, 0, "-l/2"], "moments": ["m*l^2/12", 0.05, 0.02]},
            "lower": {"mass": 1.0, "centre": [0, 0, -0.25], "moments": [0.02, 0.02, 0.001]},
        },
        "joints": {
            "hip": {"kind": "spherical", "parent": "ground", "child": "upper"},
            "knee": {
                "kind": "revolute",
                "parent": "upper",
                "child": "lower",
                "axis": "y",
                "on_parent": {"position": [0, 0, "-l"]},
            },
        },
    }
    for path, value in changes.items():
        *way, last = path.split("__")
        table = data
        for step in way:
            table = table.setdefault(step, {})
        if value is None:
            del table[last]
        else:
            table[last] = value
    return data


def scene(**changes):
    return TreeScene(**arm(**changes))


# --- what a file says is what Python says ---------------------------------------------------------


def test_a_scene_is_the_tree_of_python():
    m, l, g, c = sp.symbols("m l g c", real=True)
    t = sp.Symbol("t", real=True)
    u = sp.Symbol("u_knee", real=True)
    thrust = sp.Symbol("thrust", real=True)
    found = scene(
        parameters__c=0.3,
        inputs__thrust=0.0,
        bodies__lower__about=[0, 0, 0.1],
        bodies__lower__moments=[0.5, 0.5, 0.01],
        bodies__lower__rotation={"sequence": "3-2-1", "degrees": [90, 0, 0]},
        joints__hip__attitude="3-1-3",
        joints__hip__damping=[0.1, 0.2, "c"],
        joints__knee__stiffness=3,
        joints__knee__rest="0.1*l",
        joints__knee__armature=0.25,
        joints__knee__motor=True,
        joints__knee__force="-c*abs(u_knee)*u_knee",
        joints__knee__on_child={"rotation": {"matrix": [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]}},
        bodies__toe={"mass": 0.1},
        joints__ankle={
            "kind": "prismatic", "parent": "lower", "child": "toe", "axis": [0, 0.6, 0.8],
            "motion": {"position": "1.0*sin(2*t)/l"},
        },
        loads__jet={"body": "lower", "force": ["thrust", 0, "c*t"], "point": [0, 0, -1], "axes": "body"},
    )  # fmt: skip
    turn = ((0, 1, 0), (-1, 0, 0), (0, 0, 1))
    tree = Tree(
        "scene",
        (
            Body("upper", m, (0, 0, -l / 2), (m * l**2 / 12, 0.05, 0.02)),
            Body("lower", 1, (0, 0, -0.25), (0.5, 0.5, 0.01), (0, 0, 0.1), turn),
            Body("toe", 0.1),
        ),
        (
            Joint("hip", "spherical", "ground", "upper", attitude="3-1-3", damping=(0.1, 0.2, c)),
            Joint(
                "knee", "revolute", "upper", "lower", "y",
                on_parent=Placement((0, 0, -l)), on_child=Placement(rotation=turn),
                stiffness=3, rest=0.1 * l, armature=0.25, motor=True, force=-c * u * sp.Abs(u),
            ),
            Joint(
                "ankle", "prismatic", "lower", "toe", (0, 0.6, 0.8), motion=Motion((sp.sin(2 * t) / l,))
            ),
        ),
        (0, 0, -g),
        (Load("lower", (thrust, 0, c * t), (0, 0, 0), (0, 0, -1), "body"),),
        inputs=(thrust,),
    )  # fmt: skip
    made, expected = found.derive(), derive(tree)
    assert made.state_names == expected.state_names
    assert made.input_names == expected.input_names
    assert sorted(made.parameter_names) == sorted(expected.parameter_names)
    values = {"m": 2.0, "l": 0.5, "g": 9.81, "c": 0.3}
    x = np.linspace(0.1, 0.9, len(made.states))
    rates = [
        codegen.compile(s, "numpy").rhs(0.4, x, np.array([values[n] for n in s.parameter_names]),
                                        np.array([0.7, 0.2]))
        for s in (made, expected)
    ]  # fmt: skip
    np.testing.assert_allclose(*rates, rtol=1e-12)
    assert [q.unit for q in made.parameters if q.name == "l"] == ["m"]


def test_kinds_of_joints_are_distinguished_by_their_keys():
    found = scene(
        joints__knee__kind="universal",
        joints__knee__axis="x",
        joints__knee__second_axis=[0, 1, 0],
        joints__hip__kind="helical",
        joints__hip__pitch="l/5",
    )
    assert found.tree.joint_of["upper"].pitch == sp.Symbol("l", real=True) / 5
    assert found.derive().state_names == (
        *("q_hip", "q_knee_1", "q_knee_2"),
        *("u_hip", "u_knee_1", "u_knee_2"),
    )


@pytest.mark.parametrize("sequence", ["3-2-1", "3-1-3", "1-2-3"])
def test_rotations_by_angles_are_those_of_the_sequence(sequence):
    angles = (0.3, -1.1, 2.0)
    C = rotation_sequence(sequence, [sp.Float(a) for a in angles]).matrix
    expected = np.array(C.evalf().tolist(), float)
    for key, given_angles in (("radians", angles), ("degrees", [math.degrees(a) for a in angles])):
        turned = {"sequence": sequence, key: list(given_angles)}
        found = scene(joints__knee__on_parent={"rotation": turned}).tree.joint_of["lower"]
        np.testing.assert_allclose(np.array(found.on_parent.rotation, float), expected, atol=1e-15)


@pytest.mark.parametrize(
    ("key", "angle"),
    [("degrees", 90), ("degrees", 90.0), ("degrees", "360/4"),
     ("radians", math.pi / 2), ("radians", 1.570796326794897), ("radians", "pi/2")],
)  # fmt: skip
def test_right_angles_are_exact(key, angle):
    place = {"rotation": {"sequence": "1-2-3", key: [angle, 0, 0]}}
    found = scene(joints__knee__on_parent=place).tree.joint_of["lower"]
    assert found.on_parent.rotation == ((1, 0, 0), (0, 0, 1), (0, -1, 0))


def test_an_angle_near_a_right_one_stays_as_it_is():
    place = {"rotation": {"sequence": "1-2-3", "radians": [1.5708, 0, 0]}}
    C = scene(joints__knee__on_parent=place).tree.joint_of["lower"].on_parent.rotation
    assert 3e-6 < abs(C[1][1]) < 4e-6


def test_a_solid_has_the_inertia_of_its_formula():
    found = scene(
        parameters__r=0.1,
        bodies__lower={"mass": "m", "solid": "cylinder", "size": {"radius": "r", "length": 0.6}},
    )
    body = found.tree.body["lower"]
    numbers = {"m": 2.0, "r": 0.1}
    J = [[float(sp.sympify(x).xreplace({s: numbers[s.name] for s in sp.sympify(x).free_symbols}))
          for x in row] for row in body.central_inertia]  # fmt: skip
    across = 2.0 * (3 * 0.1**2 + 0.6**2) / 12
    np.testing.assert_allclose(J, np.diag([across, across, 0.01]), rtol=1e-14)


# --- start values -----------------------------------------------------------------------------------


def test_what_is_not_given_starts_at_zero_and_without_a_turn():
    values = scene().initial_values()
    assert values.pop("e_hip_0") == 1.0
    assert set(values.values()) == {0.0}


def test_start_values_are_formulas_over_parameters():
    values = scene(initial={"q_knee": "pi/6 + 1.0*l", "u_knee": -2}).initial_values()
    assert values["q_knee"] == pytest.approx(math.pi / 6 + 0.5, rel=1e-15)
    assert values["u_knee"] == -2


@pytest.mark.parametrize(
    "turns", [(0, 0, 0), (0.1, -2.0, 3.0), (2.9, 1.5, -1e-9), (-3.0, 0.2, 1.1)]
)
def test_attitudes_at_the_start_are_normalised(turns):
    start = {"hip": {"sequence": "3-2-1", "radians": list(turns)}}
    values = scene(initial_attitude=start).initial_values()
    q = [values[f"e_hip_{k}"] for k in range(4)]
    assert math.hypot(*q) == pytest.approx(1, abs=3e-16)
    w, x, y, z = q
    C = rotation_sequence("3-2-1", [sp.Float(a) for a in turns]).matrix
    assert w * w + x * x - y * y - z * z == pytest.approx(float(C[0, 0]), abs=1e-14)
    assert 2 * (x * y + w * z) == pytest.approx(float(C[0, 1]), abs=1e-14)


def test_attitudes_of_a_sequence_are_its_angles():
    changes = {"joints__hip__attitude": "3-1-3"}
    start = {"hip": {"sequence": "3-1-3", "degrees": [90, 60, 0]}}
    values = scene(**changes, initial_attitude=start).initial_values()
    assert [values[f"q_hip_{k}"] for k in (1, 2, 3)] == pytest.approx([math.pi / 2, math.pi / 3, 0])


# --- repeats ----------------------------------------------------------------------------------------


def test_repeated_parts_are_written_out():
    data = {
        "repeat": {"i": 3},
        "bodies": {"rod{i}": {"mass": "m{i}", "centre": [0, 0, "-l*{i}/2"]}, "cart": {"mass": 1}},
        "joints": {"pin1": {"parent": "cart"}, "pin{i}": {"parent": "rod{i-1}", "child": "rod{ i + 1 }"}},
        "outputs": ["q_pin{i}", "u_cart"],
    }  # fmt: skip
    assert written_out(data) == {
        "bodies": {
            "cart": {"mass": 1},
            **{f"rod{k}": {"mass": f"m{k}", "centre": [0, 0, f"-l*{k}/2"]} for k in (1, 2, 3)},
        },
        "joints": {
            "pin1": {"parent": "cart"},
            **{f"pin{k}": {"parent": f"rod{k - 1}", "child": f"rod{k + 1}"} for k in (2, 3)},
        },
        "outputs": ["q_pin1", "q_pin2", "q_pin3", "u_cart"],
    }


@pytest.mark.parametrize("count", [1, 2, 9])
def test_the_pendulum_on_a_cart_has_as_many_rods_as_are_asked_for(count, tmp_path):
    text = catalogue.path_of("pendulum-on-cart").read_text(encoding="utf-8")
    file = tmp_path / "more.toml"
    file.write_text(text.replace("links = 5", f"links = {count}"), encoding="utf-8")
    system = eom.load_scene(file).derive()
    assert system.state_names[: count + 1] == (
        "q_track",
        *(f"q_hinge{k + 1}" for k in range(count)),
    )
    assert len(system.states) == 2 * count + 2


# --- every mistake is one clear error -----------------------------------------------------------

MISTAKES = {
    "unknown key": ({"bodies__upper__mas": 1}, r"unknown key 'mas'", "bodies.upper.mas", "mass"),
    "key of a joint": ({"joints__knee__axes": "x"}, "unknown key 'axes'", "joints.knee", "axis"),
    "key of a scene": ({"boddies": {}}, "unknown key 'boddies'", "boddies", "bodies"),
    "key of a place": (
        {"joints__knee__on_parent__positon": [0, 0, 0]},
        "unknown key",
        "on_parent.positon",
        "position",
    ),
    "no bodies": ({"bodies": None}, "missing key 'bodies'", "bodies", ""),
    "no parent": ({"joints__knee__parent": None}, "missing key 'parent'", "joints.knee.parent", ""),
    "kind": (
        {"joints__knee__kind": "revolut"},
        "unknown kind of joint",
        "joint 'knee'",
        "revolute",
    ),
    "unknown body": (
        {"joints__knee__parent": "uper"},
        "unknown parent 'uper'",
        "joint 'knee'",
        "upper",
    ),
    "unknown child": ({"joints__knee__child": "lowr"}, "unknown child", "joint 'knee'", "lower"),
    "axis": ({"joints__knee__axis": "w"}, "unusable value", "joints.knee.axis", ""),
    "zero axis": ({"joints__knee__axis": [0, 0, 0]}, "axis is zero", "joint 'knee': axis", ""),
    "two components": (
        {"bodies__upper__centre": [0, 1]},
        "too few values",
        "bodies.upper.centre",
        "",
    ),
    "attitude": ({"joints__hip__attitude": "3-2-2"}, "unknown attitude", "joint 'hip'", ""),
    "formula": ({"bodies__upper__mass": "m*"}, "a number, a name", "body 'upper': mass", ""),
    "name in a formula": (
        {"bodies__upper__mass": "n"},
        "unknown name 'n'",
        "body 'upper': mass",
        "",
    ),
    "time in a mass": (
        {"bodies__upper__mass": "m*t"},
        "no jet says with what velocity mass leaves",
        "body 'upper'",
        "prescribed motion",
    ),
    "state in a placement": (
        {"joints__knee__on_parent": {"position": ["q_knee", 0, 0]}},
        "unknown name 'q_knee'",
        "joint 'knee': on_parent: position",
        "",
    ),
    "state in a motion": (
        {"joints__knee__motion": {"position": "u_knee"}},
        "unknown name",
        "joint 'knee': motion",
        "",
    ),
    "state that is driven": (
        {"joints__knee__motion": {"position": "t"}, "joints__hip__force": "q_knee"},
        "unknown name 'q_knee'",
        "joint 'hip': force",
        "",
    ),
    "code in a formula": (
        {"bodies__upper__mass": "__import__('os')"},
        "cannot be read",
        "mass",
        "",
    ),
    "true as a mass": ({"bodies__upper__mass": True}, "unusable value", "bodies.upper.mass", ""),
    "infinite mass": ({"bodies__upper__mass": math.inf}, "unusable value", "bodies.upper.mass", ""),
    "negative mass": ({"bodies__upper__mass": -1}, "mass is negative", "body 'upper'", ""),
    "motor by a number": ({"joints__knee__motor": 1}, "unusable value", "joints.knee.motor", ""),
    "impossible inertia": (
        {"bodies__lower__moments": [1, 1, 3]},
        "no body has this inertia",
        "body 'lower'",
        "signs",
    ),
    "two inertias": (
        {"bodies__lower__solid": "cylinder"},
        "more than one inertia",
        "body 'lower'",
        "",
    ),
    "unknown solid": (
        {"bodies__lower": {"mass": 1, "solid": "cylnder"}},
        "unknown solid",
        "body 'lower': solid",
        "cylinder",
    ),
    "size without a solid": (
        {"bodies__lower__size": {"radius": 1}},
        "size belongs to a solid",
        "body 'lower'",
        "",
    ),
    "sizes of a solid": (
        {"bodies__lower": {"mass": 1, "solid": "cylinder", "size": {"radius": "l"}}},
        "sizes of a cylinder",
        "body 'lower'",
        "",
    ),
    "rotation in two ways": (
        {"joints__knee__on_child": {"rotation": {"degrees": [0, 0, 0], "radians": [0, 0, 0]}}},
        "exactly one description",
        "joint 'knee': on_child: rotation",
        "",
    ),
    "rotation in no way": (
        {"joints__knee__on_child": {"rotation": {}}},
        "exactly one",
        "on_child: rotation",
        "",
    ),
    "no rotation matrix": (
        {"joints__knee__on_child": {"rotation": {"matrix": [[1, 0, 0], [0, 1, 0], [0, 1, 1]]}}},
        "not a rotation",
        "rotation",
        "",
    ),
    "sequence": (
        {"joints__knee__on_child": {"rotation": {"sequence": "3-3-1", "degrees": [0, 0, 0]}}},
        "unknown rotation sequence",
        "joint 'knee'",
        "",
    ),
    "values a speed": (
        {"joints__hip__damping": [1, 2]},
        "one value a speed",
        "joint 'hip': damping",
        "",
    ),
    "spring of a ball joint": (
        {"joints__hip__stiffness": 1},
        "a spring needs a coordinate",
        "joint 'hip'",
        "",
    ),
    "load on nothing": (
        {"loads__jet": {"body": "uper"}},
        "unknown body 'uper'",
        "load 'jet'",
        "upper",
    ),
    "axes of a load": (
        {"loads__jet": {"body": "upper", "axes": "earth"}},
        "unusable value",
        "loads.jet.axes",
        "",
    ),
    "unused parameter": ({"parameters__mm": 1}, "no formula uses 'mm'", "[parameters]", ""),
    "unused input": ({"inputs__tau_knee": 1}, "no formula uses 'tau_knee'", "[inputs]", ""),
    "reserved name": ({"parameters__lambda": 1}, "reserved", "[parameters]", ""),
    "name of a state": (
        {"parameters__q_knee": 1, "gravity": ["q_knee", 0, "-g"]},
        "a joint or rotor has this name",
        "[parameters]",
        "",
    ),
    "name of a body": ({"bodies__a-b": {"mass": 1}}, "not a name", "body 'a-b'", ""),
    "two joints to a body": (
        {"joints__other": {"kind": "fixed", "parent": "ground", "child": "lower"}},
        "two joints lead to body 'lower'",
        "",
        "loops",
    ),
    "a body on nothing": ({"bodies__loose": {"mass": 1}}, "hangs on nothing", "", "free joint"),
    "nothing to move": ({"bodies__lower": {}}, "moves no mass", "joint 'knee'", ""),
    "state at the start": (
        {"initial": {"q_kne": 1}},
        "unknown state 'q_kne'",
        "[initial]",
        "q_knee",
    ),
    "quaternion": (
        {"initial": {"e_hip_1": 1}},
        "unit norm",
        "[initial] e_hip_0",
        "initial_attitude",
    ),
    "zero quaternion": ({"initial": {"e_hip_0": 0}}, "unit norm", "[initial] e_hip_0", ""),
    "attitude of a hinge": (
        {"initial_attitude": {"knee": {"degrees": [1, 2, 3]}}},
        "unknown joint with an attitude 'knee'",
        "[initial_attitude.knee]",
        "hip",
    ),
    "attitude in two ways": (
        {"initial_attitude": {"hip": {"degrees": [1, 2, 3], "radians": [1, 2, 3]}}},
        "exactly one",
        "[initial_attitude.hip]",
        "",
    ),
    "attitude twice": (
        {"initial_attitude": {"hip": {"degrees": [1, 2, 3]}}, "initial": {"e_hip_1": 0}},
        "e_hip_1 is given twice",
        "[initial] and",
        "",
    ),
    "attitude in others": (
        {"joints__hip__attitude": "3-1-3", "initial_attitude": {"hip": {"degrees": [1, 2, 3]}}},
        "other coordinates",
        "[initial_attitude.hip]",
        "",
    ),
    "output": ({"outputs": ["energie"]}, "unknown output 'energie'", "outputs", "energies"),
    "no time": ({"integration__t_end": 0}, "end time is zero", "t_end", ""),
    "index": ({"bodies__rod{i}": {"mass": 1}}, "unknown index 'i'", "bodies", ""),
    "step of an index": (
        {"repeat": {"i": 2}, "bodies__rod{2*i}": {}},
        "not an index",
        "bodies",
        "",
    ),
    "index inside": (
        {"repeat": {"i": 2}, "bodies__rod{i}": {"mass": "{k}"}},
        "unknown index 'k'",
        "rod{i}",
        "",
    ),
    "two indices": (
        {"repeat": {"i": 2, "k": 2}, "bodies__rod{i}{k}": {}},
        "two indices",
        "bodies",
        "",
    ),
    "no repetitions": ({"repeat": {"i": 0}}, "not a number of repetitions", "[repeat] i", ""),
    "too many repetitions": (
        {"repeat": {"i": MOST + 1}},
        "not a number of repetitions",
        "[repeat] i",
        "",
    ),
    "repeated by a flag": (
        {"repeat": {"i": True}},
        "not a number of repetitions",
        "[repeat] i",
        "",
    ),
    "repeat": ({"repeat": 3}, "not a table", "[repeat]", ""),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_one_error_that_names_the_place(name):
    changes, what, where, hint = MISTAKES[name]
    with pytest.raises(InputError, match=re.escape(what) if "'" in what else what) as caught:
        scene(**changes).derive()
    assert where in caught.value.where
    assert hint in caught.value.hint


def test_three_components_are_a_placement_without_a_turn():
    alone = scene(joints__knee__on_parent=(0, 0, "-l"))
    assert alone.tree == scene(joints__knee__on_parent={"position": (0, 0, "-l")}).tree


def test_mistakes_say_what_belongs_there_and_name_the_others():
    with pytest.raises(InputError) as short:
        scene(joints__knee__axis=[0, 1])
    assert (short.value.where, short.value.got) == ("joints.knee.axis", "[0, 1]")
    assert short.value.expected == "3 values"
    with pytest.raises(InputError) as keyed:
        scene(joints__knee__on_parent=3)
    assert keyed.value.hint == "its keys: position, rotation"
    with pytest.raises(InputError, match=r"unknown key 'at' \(and 1 more: joints.knee.to\)"):
        scene(joints__knee__at=1, joints__knee__to=2)


def test_errors_of_a_file_name_the_file(tmp_path):
    file = tmp_path / "bad.toml"
    file.write_text('model = "tree"\n[bodies.a]\nmas = 1\n[joints]\n', encoding="utf-8")
    with pytest.raises(InputError, match="unknown key 'mas'") as caught:
        eom.load_scene(file)
    assert caught.value.where == f"{file}: bodies.a.mas"


def test_a_scene_of_one_body_says_that_it_is_given_a_tree():
    with pytest.raises(InputError, match="tree of bodies") as caught:
        eom.Scene.ready("double-pendulum")
    assert "load_scene" in caught.value.hint
    with pytest.raises(InputError, match="one body, not a tree") as caught:
        TreeScene.ready("heavy-top")
    assert "load_scene" in caught.value.hint


def evaluated(system, values, parameters, inputs=()):
    """Rates and outputs by name, by the interpreter."""
    point = Point(
        x=[values[n] for n in system.state_names],
        p=[parameters[n] for n in system.parameter_names],
        u=inputs or [0.0] * len(system.inputs),
    )
    found = interpret(lower_system(system), point)
    return dict(zip(system.state_names, found["rates"], strict=True)) | dict(
        zip(system.output_names, found.get("outputs", ()), strict=True)
    )


# --- what is asked for ------------------------------------------------------------------------------


def driven():
    return scene(joints__knee__motion={"position": "sin(t)"})


def test_groups_of_outputs_are_those_of_the_derivation():
    for tree in (scene().tree, driven().tree):
        found = {name: derive(tree, [name]).output_names for name in OUTPUTS}
        assert found == {name: Choice(tree).groups[name] for name in OUTPUTS}


def test_reactions_and_drives_are_named_by_their_joints():
    names = Choice(driven().tree).groups
    assert names["drives"] == ("tau_knee",)
    assert names["reactions"] == tuple(
        f"{letter}_{joint}_{k}" for joint in ("hip", "knee") for letter in "FT" for k in (1, 2, 3)
    )
    part = scene(joints__knee__motion={"position": "sin(t)"}, outputs=["tau_knee", "T_hip_3"])
    assert part.derive().output_names == ("tau_knee", "T_hip_3")


def test_a_single_reaction_costs_its_joint_alone():
    joint = {
        "kind": "fixed",
        "parent": "lower",
        "child": "toe",
        "on_parent": {"position": [0, 0, -1]},
    }
    welded = {"bodies__toe": {"mass": 1}, "joints__weld": joint}
    one = scene(**welded, outputs=["F_hip_1"]).derive()
    whole = scene(**welded, outputs=["reactions"]).derive()
    assert one.output_names == ("F_hip_1",)
    assert {"F_hip_1", "T_weld_3"} <= set(whole.output_names)
    assert len(one.definitions) < len(whole.definitions)


@pytest.mark.parametrize(
    "name", every(2, [*OUTPUTS, "potential_energy", "L_3", "u_knee", "T_hip_3"])
)
def test_an_output_has_the_value_that_the_whole_system_gives(name):
    whole, part = scene(), scene(outputs=[name])
    assert part.derive().output_names == tuple(
        n for n in part.requested if n not in whole.derive().state_names
    )
    values = dict.fromkeys(whole.derive().state_names, 0.3)
    full, made = (evaluated(s, values, whole.numbers) for s in (whole.full_system, part.derive()))
    for output in part.derive().output_names:
        assert made[output] == pytest.approx(full[output], rel=1e-14)


def test_states_that_nothing_needs_are_left_out_and_reported():
    cart = TreeScene.ready("pendulum-on-cart")
    data = cart.model_dump(exclude_unset=True)
    gone = ("rod3", "rod4", "rod5", "hinge3", "hinge4", "hinge5")
    for table in ("bodies", "joints"):
        data[table] = {n: part for n, part in data[table].items() if n not in gone}
    part = TreeScene(**{**data, "outputs": ("q_hinge2",)})
    cart = TreeScene(**data)
    assert set(cart.derive().state_names) - set(part.derive().state_names) == {"q_track", "u_track"}
    assert "q_track, u_track: neither the requested outputs" in str(part.explain())
    ends = []
    for s in (cart, part):
        run = codegen.simulate(
            codegen.compile(s.derive(), "python"), s.initial_values(), (0, 0.5),
            s.parameter_values(), "DOP853", 1e-11,
        )  # fmt: skip
        ends.append(run["q_hinge2"][-1])
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)


def test_nothing_that_is_needed_is_left_out():
    part = scene(outputs=["q_knee"])
    assert set(part.derive().state_names) == set(scene().derive().state_names)
    assert part.derive().output_names == ()


def test_scenes_are_equal_if_they_say_the_same():
    one, two, other = scene(), scene(), scene(title="another")
    one.derive()  # what was worked out is no part of what a scene says
    assert one == two
    assert hash(one) == hash(two)
    assert repr(one) == repr(two)
    assert one != other
    assert one != arm()
    assert {one: "found"}[two] == "found"


# --- the ready scenes -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", every(3, TREES))
def test_zero_states_and_straight_configurations_are_finite(name):
    ready = TreeScene.ready(name)
    system = ready.derive()
    values = dict.fromkeys(system.state_names, 0.0)
    for parts in ready.attitudes:
        values[parts[0]] = 1.0
    if ready.tree.constraints:  # at rest where they are met
        speeds = {u.name for j in ready.tree.joints for u in j.speeds}
        values = {n: 0.0 if n in speeds else v for n, v in ready.initial_values().items()}
    assert np.all(np.isfinite([*evaluated(system, values, ready.numbers).values()]))


@pytest.mark.parametrize("name", ["double-pendulum", "pendulum-on-cart"])
def test_hanging_straight_down_is_an_equilibrium(name):
    ready = TreeScene.ready(name)
    values = dict.fromkeys(ready.derive().state_names, 0.0)
    assert not any(evaluated(ready.derive(), values, ready.numbers).values())


def test_a_satellite_at_rest_stays_so_and_a_wheel_turns_it_the_other_way():
    ready = TreeScene.ready("satellite-with-panels")
    system = ready.derive()
    values = dict.fromkeys(system.state_names, 0.0) | {"e_base_0": 1.0}
    assert not any(evaluated(system, values, ready.numbers).values())
    found = evaluated(system, values, ready.numbers, [0.01, 0.0, 0.0])
    assert found["u_wheel_x"] > 0 > found["w_base_1"]
    J, around = 0.004, found["w_base_1"] + found["u_wheel_x"]
    assert J * around == pytest.approx(0.01, rel=1e-12)  # Euler's law of the wheel alone


def test_momentum_stays_whatever_joints_do_inside():
    ready = TreeScene.ready("satellite-with-panels")
    assert {"p_1", "L_3"} <= set(ready.derive().invariant_names)
    held = TreeScene(**{**ready.model_dump(exclude_unset=True), "gravity": (0, 0, -1)})
    assert "p_1" not in held.derive().invariant_names
    data = ready.model_dump(exclude_unset=True)
    data["joints"]["base"] = {**data["joints"]["base"], "damping": 0.1}
    assert "p_1" not in TreeScene(**data).derive().invariant_names


TURNING = {"foucault-pendulum": ("0", "n*cos(lat)", "n*sin(lat)")}
"""Ready scenes whose axes turn, and their angular velocity in these axes."""


@pytest.mark.parametrize("name", only(WHOLE, "double-pendulum", "floating-tree"))
def test_the_centre_of_mass_moves_as_the_momentum_says(name):
    """Numbers alone, or parameters among them: momentum is mass times the rate of the centre.

    Where the axes turn, what their turning adds belongs to that rate (transport theorem).
    """
    ready = TreeScene.ready(name)
    turn = [evaluated_value(w, ready.numbers) for w in TURNING.get(name, ("0", "0", "0"))]
    system = ready.full_system
    mass = float(sum(evaluated_value(b.mass, ready.numbers) for b in ready.tree.bodies))
    x = {n: 0.1 * k for k, n in enumerate(system.state_names, 1)}
    for parts in ready.attitudes:
        norm = math.hypot(*(x[n] for n in parts))
        x |= {n: x[n] / norm for n in parts}
    rates = evaluated(system, x, ready.numbers)
    step = 1e-6
    ends = [
        evaluated(system, {n: v + h * rates[n] for n, v in x.items()}, ready.numbers)
        for h in (-step, step)
    ]
    for k in (1, 2, 3):
        speed = (ends[1][f"centre_{k}"] - ends[0][f"centre_{k}"]) / (2 * step)
        i, j = k % 3, (k + 1) % 3
        speed += turn[i] * rates[f"centre_{j + 1}"] - turn[j] * rates[f"centre_{i + 1}"]
        assert mass * speed == pytest.approx(rates[f"p_{k}"], rel=1e-7, abs=1e-6)


def evaluated_value(value, numbers):
    value = sp.sympify(value)
    return value.xreplace({s: sp.Float(numbers[s.name]) for s in value.free_symbols})
