"""Robots from URDF: against Pinocchio, every type of joint, what is left out, hostile and broken files."""

import math
from pathlib import Path

import numpy as np
import pytest

import eom
from codegen.frontend.lower import lower_system
from codegen.ir.interpret import Point, interpret
from eom.errors import InputError
from eom.multibody.files import urdf

pytest.importorskip("yourdfpy")

WALKER = Path(__file__).parent / "robots" / "walker.urdf"
BODY = '<inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def robot(tmp_path, joint, body=BODY, more="", start=""):
    """A file of two links and a joint."""
    file = tmp_path / "robot.urdf"
    file.write_text(
        f'{start}<robot name="r"><link name="base"/><link name="arm">{body}</link>'
        f'<joint name="pin" {joint}</joint>{more}</robot>',
        encoding="utf-8",
    )
    return file


def pin(kind, inner="", mid='<parent link="base"/><child link="arm"/>'):
    return f'type="{kind}">{mid}{inner}'


def accelerations(scene, q, u, tau):
    """Rates of the speeds by joint; q, u, tau by joint."""
    system = scene.derive()
    names = {**{f"q_{n}": v for n, v in q.items()}, **{f"u_{n}": v for n, v in u.items()}}
    found = interpret(
        lower_system(system),
        Point(
            x=[names[n] for n in system.state_names],
            u=[tau[n.removeprefix("tau_")] for n in system.input_names],
        ),
    )["rates"]
    rates = dict(zip(system.state_names, found, strict=True))
    return {n: rates[f"u_{n}"] for n in q}


@pytest.mark.parametrize("seed", range(5))
def test_accelerations_are_those_of_pinocchio(seed):
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.buildModelFromUrdf(str(WALKER))
    scene = eom.load_scene(WALKER)
    draw = np.random.default_rng(seed)
    joints = [n for n in model.names if n != "universe"]
    q, u, tau = ({n: draw.normal() for n in joints} for _ in range(3))
    x = pinocchio.neutral(model)
    v, force = np.zeros(model.nv), np.zeros(model.nv)
    for n in joints:
        j = model.joints[model.getJointId(n)]
        x[j.idx_q : j.idx_q + j.nq] = (
            [q[n]] if j.nq == 1 else [math.cos(q[n]), math.sin(q[n])]
        )  # a joint without limits has a unit complex number there
        v[j.idx_v] = u[n]
        damping = {"hip": 0.7, "knee": 0.2}.get(n, 0.0)
        force[j.idx_v] = tau[n] - damping * u[n]
    expected = pinocchio.aba(model, model.createData(), x, v, force)
    own = {n: n.replace("-", "_") for n in joints}
    got = accelerations(
        scene,
        *({own[n]: values[n] for n in joints} for values in (q, u, tau)),
    )
    found = [got[own[n]] for n in joints]
    places = [model.joints[model.getJointId(n)].idx_v for n in joints]
    np.testing.assert_allclose(found, expected[places], rtol=1e-12)


def test_everything_that_is_not_used_is_reported():
    reported = "\n".join(eom.load_scene(WALKER).notes)
    for words in (
        "root link world-plate fixed to the ground; gravity (0.0, 0.0, -9.81)",
        "<link/visual>, 1 of them", "<link/collision>, 1 of them", "<joint/limit>, 3 of them",
        "<transmission>, 1 of them", "<gazebo>, 1 of them", "<material>, 1 of them",
        "friction not used: hip", "links without <inertial>, of mass 0: world-plate, sensor",
    ):  # fmt: skip
        assert words in reported
    assert reported in str(eom.load_scene(WALKER).explain()).replace("- ", "")


def test_meshes_are_not_opened(monkeypatch):
    opened = []
    plain = Path.open
    monkeypatch.setattr(
        Path, "open", lambda self, *a, **k: opened.append(str(self)) or plain(self, *a, **k)
    )
    built_in = open

    def watched(file, *args, **keys):
        opened.append(str(file))
        return built_in(file, *args, **keys)

    monkeypatch.setattr("builtins.open", watched)
    eom.load_scene(WALKER)
    assert not [f for f in opened if "passwd" in f or ".dae" in f]


@pytest.mark.parametrize(
    ("kind", "states"),
    [
        ("revolute", ["q_pin"]),
        ("continuous", ["q_pin"]),
        ("prismatic", ["q_pin"]),
        ("planar", ["x_pin", "y_pin", "q_pin"]),
        ("floating", ["x_pin", "y_pin", "z_pin", *(f"e_pin_{k}" for k in range(4))]),
    ],
)
def test_every_type_of_joint_has_its_coordinates(tmp_path, kind, states):
    scene = eom.load_scene(robot(tmp_path, pin(kind)))
    assert list(scene.derive().state_names[: len(states)]) == states


@pytest.mark.parametrize("axis", ["1 0 0", "0 -3 0", "0 0 1", "1 2 2", "1e-3 0 -1"])
def test_a_planar_joint_moves_across_its_axis(tmp_path, axis):
    """Weight along the axis is held; across it the body falls with all of it."""
    joint = pin("planar", f'<origin rpy="0.3 -0.5 1" xyz="1 2 3"/><axis xyz="{axis}"/>')
    file = robot(tmp_path, joint)
    normal = np.array([float(x) for x in axis.split()])
    normal /= np.linalg.norm(normal)
    joint = eom.load_scene(file).tree.joint_of["arm"]
    R = np.array(joint.on_parent.rotation, float)
    across = np.array(joint.on_child.rotation, float)
    np.testing.assert_allclose(across @ normal, [0, 0, 1], atol=1e-15)
    for matrix in (R, across):
        np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-15)
    scene = urdf.load_urdf(file, gravity=(0.3, -9, 2))
    system = scene.derive()
    rates = interpret(lower_system(system), Point(x=[0.0] * len(system.states)))["rates"]
    n = system.state_names.index
    fall = np.array([rates[n("v_pin_1")], rates[n("v_pin_2")]])
    np.testing.assert_allclose(fall, (R @ [0.3, -9, 2])[:2], atol=1e-14)


def test_gravity_can_be_another():
    scene = urdf.load_urdf(WALKER, gravity=(0, 0, 0))
    assert scene.tree.gravity == (0, 0, 0)


BILLION = """<!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>"""
OUTSIDE = '<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/passwd">]>'

BROKEN = {
    "entities": ((pin("fixed"),), {"start": BILLION}, "no document type", "line 1"),
    "entity outside": ((pin("fixed"),), {"start": OUTSIDE}, "no document type", "line 1"),
    "document type": (
        (pin("fixed"),),
        {"start": '<!DOCTYPE robot SYSTEM "x.dtd">'},
        "no document type",
        "",
    ),
    "encoding": (
        (pin("fixed"),),
        {"start": '<?xml version="1.0" encoding="utf-7"?>'},
        "encoding",
        "",
    ),
    "not XML": ((pin("fixed"),), {"more": "<link"}, "not valid XML", ""),
    "deep": ((pin("fixed"),), {"more": "<a>" * 30 + "</a>" * 30}, "too many elements", ""),
    "type of joint": ((pin("screw"),), {}, "unknown type of joint", "joint 'pin'"),
    "no type": (
        ('><parent link="base"/><child link="arm"/>',),
        {},
        "missing attribute 'type'",
        "joint 'pin'",
    ),
    "no parent": ((pin("fixed", mid='<child link="arm"/>'),), {}, "not a readable", ""),
    "no link": (
        (pin("fixed", mid='<parent link="base"/><child/>'),),
        {},
        "missing attribute 'link'",
        "'pin'",
    ),
    "unknown link": (
        (pin("fixed", mid='<parent link="bse"/><child link="arm"/>'),),
        {},
        "unknown link 'bse'",
        "joint 'pin'",
    ),
    "mimic": ((pin("revolute", '<mimic joint="other"/>'),), {}, "mimic others", "joint 'pin'"),
    "mass": ((pin("revolute"),), {"body": BODY.replace('"2"', '"heavy"')}, "not a readable", ""),
    "infinite mass": (
        (pin("revolute"),),
        {"body": BODY.replace('"2"', '"inf"')},
        "unusable value",
        "arm.mass",
    ),
    "negative mass": (
        (pin("revolute"),),
        {"body": BODY.replace('"2"', '"-2"')},
        "mass is negative",
        "'arm'",
    ),
    "inertia": (
        (pin("revolute"),),
        {"body": BODY.replace('izz="1"', 'izz="5"')},
        "no body has this",
        "'arm'",
    ),
    "part of inertia": (
        (pin("revolute"),),
        {"body": BODY.replace(' iyz="0"', "")},
        "'iyz'",
        "link 'arm'",
    ),
    "no inertia": (
        (pin("revolute"),),
        {"body": '<inertial><mass value="1"/></inertial>'},
        "without <inertia>",
        "'arm'",
    ),
    "no mass": ((pin("revolute"),), {"body": ""}, "moves no mass", "joint 'pin'"),
    "zero axis": ((pin("revolute", '<axis xyz="0 0 0"/>'),), {}, "axis is zero", "joint 'pin'"),
    "zero normal": ((pin("planar", '<axis xyz="0 0 0"/>'),), {}, "axis is zero", "joint 'pin'"),
    "two components": ((pin("revolute", '<axis xyz="0 1"/>'),), {}, "too few values", "pin.axis"),
    "damping": (
        (pin("revolute", '<dynamics damping="much"/>'),),
        {},
        "not a number",
        "joint 'pin'",
    ),
    "damping of none": (
        (pin("fixed", '<dynamics damping="1"/>'),),
        {},
        "damping at a joint",
        "joint 'pin'",
    ),
    "loop": (
        (pin("fixed"),),
        {"more": '<joint name="b" type="fixed"><parent link="base"/><child link="arm"/></joint>'},
        "two joints lead",
        "",
    ),
    "two roots": ((pin("fixed"),), {"more": '<link name="c"/>'}, "one root link", ""),
    "same names": ((pin("fixed"),), {"more": '<link name="arm"/>'}, "repeated name", ""),
    "names alike": (
        (pin("fixed"),),
        {
            "more": '<link name="arm-1"/><link name="arm_1"/>'
            '<joint name="p" type="fixed"><parent link="arm"/><child link="arm-1"/></joint>'
            '<joint name="q" type="fixed"><parent link="arm"/><child link="arm_1"/></joint>'
        },
        "repeated name of a link",
        "",
    ),
    "prefix": ((pin("fixed"),), {"more": "<x:y/>"}, "unbound prefix", ""),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_or_hostile_file_is_one_error(tmp_path, name):
    arguments, keys, what, where = BROKEN[name]
    file = robot(tmp_path, *arguments, **keys)
    with pytest.raises(InputError, match=what) as caught:
        eom.load_scene(file).derive()
    assert str(file) in caught.value.where
    assert where in caught.value.where


@pytest.mark.parametrize(
    ("data", "what"),
    [
        (b"", "not valid XML"),
        (b"<sdf/>", "not a URDF file"),
        ("<robot name='r'/>".encode("utf-16"), "cannot be read"),
        (b"<robot name='r'/>", "one root link"),
        (b"<robot/>", "missing attribute 'name'"),
        (b"<robot name='r'>" + b" " * 1_000_001 + b"</robot>", "too large"),
        (b"\0", "not valid XML"),
    ],
)
def test_files_that_are_no_robot(tmp_path, data, what):
    file = tmp_path / "robot.urdf"
    file.write_bytes(data)
    with pytest.raises(InputError, match=what):
        eom.load_scene(file)
    with pytest.raises(InputError, match="no such scene file") as caught:
        eom.load_scene(tmp_path / "robt.urdf")
    assert "robot.urdf" in caught.value.hint


def test_without_the_parser_one_message_says_what_to_install(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "yourdfpy", None)
    with pytest.raises(InputError, match="need the package yourdfpy") as caught:
        eom.load_scene(WALKER)
    assert "eom-toolkit[urdf]" in caught.value.hint
