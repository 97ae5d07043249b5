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
    scene = eom.load_scene(WALKER)
    reported = "\n".join(scene.notes)
    for words in (
        "root link world-plate fixed to the ground; gravity (0.0, 0.0, -9.81)",
        "<link/visual>, 1 of them", "<link/collision>, 1 of them",
        "<transmission>, 1 of them", "<gazebo>, 1 of them", "<material>, 1 of them",
        "links without <inertial>, of mass 0: world-plate, sensor",
    ):  # fmt: skip
        assert words in reported
    assert reported in str(scene.explain()).replace("- ", "")
    assert reasons(scene) == [
        *(("limit", f"joint {n!r}") for n in ("hip", "ankle", "mast-pin")), ("friction", "joint 'hip'")
    ]  # fmt: skip


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


# -- lenient reading, and a base that floats -----------------------------------------------------------

LINK = (
    '<link name="{}"><inertial><mass value="{}"/>'
    '<inertia ixx="{}" ixy="0" ixz="0" iyy="{}" iyz="0" izz="{}"/></inertial></link>'
)
MIMIC = f"""{pin("revolute")}</joint><joint name="bend" {
    pin(
        "revolute",
        '<mimic joint="pin" multiplier="-2" offset="0.5"/>',
        '<parent link="arm"/><child link="tip"/>',
    )
}"""


def mended(tmp_path, *arguments, floating=False, **keys):
    file = robot(tmp_path, *arguments, **keys)
    with pytest.raises(InputError):
        eom.load_scene(file, floating=floating)
    return eom.load_scene(file, strict=False, floating=floating)


def reasons(scene):
    return [(r.reason, r.part) for r in scene.repairs]


def second_moments(J):
    return np.trace(J) / 2 * np.eye(3) - J


@pytest.mark.parametrize("seed", range(20))
def test_the_nearest_inertia_is_possible_and_no_possible_one_is_nearer(seed):
    """Against random possible inertias near it: the projection on a cone beats them all."""
    draw = np.random.default_rng(seed)
    J = draw.normal(size=(3, 3)) * 10.0 ** draw.uniform(-9, 3)
    J += J.T
    near, share = urdf.nearest_inertia(J.tolist())
    S, N = second_moments(J), second_moments(np.array(near))
    assert np.linalg.eigvalsh(N).min() >= -1e-15 * np.abs(N).max()
    distance = np.linalg.norm(S - N)
    assert share == pytest.approx(distance / np.linalg.norm(S), rel=1e-9)
    for _ in range(50):
        step = draw.normal(size=(3, 3)) * np.linalg.norm(S) * 10.0 ** draw.uniform(-6, 0)
        root = np.linalg.cholesky(N + 1e-12 * np.linalg.norm(S) * np.eye(3)) + step
        assert np.linalg.norm(S - root @ root.T) >= distance * (1 - 1e-6)
    again, moved = urdf.nearest_inertia(near)
    assert moved <= 1e-15
    np.testing.assert_allclose(again, near, rtol=1e-14, atol=1e-15 * np.abs(near).max())


def test_an_impossible_inertia_becomes_the_nearest(tmp_path):
    scene = mended(tmp_path, pin("revolute"), body=BODY.replace('izz="1"', 'izz="4"'))
    assert reasons(scene) == [("inertia", "link 'arm'")]
    assert scene.tree.body["arm"].central_inertia == ((2, 0, 0), (0, 2, 0), (0, 0, 4))
    assert "0.33 of its size away" in scene.repairs[0].done
    assert "nearest: Frobenius norm of second moments" in str(scene.explain())


def test_a_mimicking_joint_is_coupled(tmp_path):
    scene = mended(tmp_path, MIMIC, more=LINK.format("tip", 1, 1, 1, 1))
    assert reasons(scene) == [("mimic", "joint 'bend'")]
    (coupling,) = scene.tree.constraints
    assert dict(coupling.ratios) == {"bend": 1, "pin": 2}
    assert coupling.follower == "bend"
    start = scene.initial_values()
    assert start["q_bend"] + 2 * start["q_pin"] == 0.5
    assert scene.derive().input_names == ("tau_pin",)


@pytest.mark.parametrize(
    ("mimic", "done"),
    [
        ('joint="other"', "moves by itself"),
        ('joint="bend"', "moves by itself"),
        ('joint="weld" offset="0.25"', "held at 0.25"),
        ('joint="weld"', "held at 0"),
        ('joint="pin" multiplier="0" offset="1"', "held at 1"),
    ],
)
def test_mimics_of_what_does_not_move(tmp_path, mimic, done):
    ends = '<parent link="arm"/><child link="tip"/>', '<parent link="tip"/><child link="end"/>'
    bend, weld = pin("revolute", f"<mimic {mimic}/>", ends[0]), pin("fixed", "", ends[1])
    joints = f'{pin("revolute")}</joint><joint name="bend" {bend}</joint><joint name="weld" {weld}'
    more = LINK.format("tip", 1, 1, 1, 1) + LINK.format("end", 1, 1, 1, 1)
    scene = mended(tmp_path, joints, more=more)
    (repair,) = scene.repairs
    assert done in repair.done
    assert ("q_bend" in scene.derive().state_names) == (done == "moves by itself")
    if "held at 1" in done or "0.25" in done:
        assert float(scene.joints["bend"].motion.position[0]) == float(done.split()[-1])


@pytest.mark.parametrize("multiplier", ["1", "-1", "0.1", "50", "1000"])
def test_the_speed_of_the_joint_that_mimics_is_no_state(tmp_path, multiplier):
    """Whichever of the two would keep the equations farther from singular."""
    joints = MIMIC.replace('multiplier="-2"', f'multiplier="{multiplier}"')
    scene = mended(tmp_path, joints, more=LINK.format("tip", 1, 1, 1, 1))
    speeds = [n for n in scene.derive().state_names if n.startswith("u_")]
    assert speeds == ["u_pin"]


def test_a_chain_of_mimics_ends_at_what_moves(tmp_path):
    joints = MIMIC + '</joint><joint name="curl" ' + pin(
        "revolute", '<mimic joint="bend" multiplier="3" offset="1"/>',
        '<parent link="tip"/><child link="end"/>',
    )  # fmt: skip
    more = LINK.format("tip", 1, 1, 1, 1) + LINK.format("end", 1, 1, 1, 1)
    scene = mended(tmp_path, joints, more=more)
    rows = {c.name: dict(c.ratios) for c in scene.tree.constraints}
    assert rows["mimic_curl"] == {"curl": 1, "pin": 6}
    assert scene.initial_values()["q_curl"] == 2.5
    assert sum(n.startswith("u_") for n in scene.derive().state_names) == 1


def test_a_joint_that_moves_no_mass_is_fixed(tmp_path):
    joints = pin("revolute") + '</joint><joint name="bend" ' + pin(
        "revolute", "", '<parent link="arm"/><child link="tip"/>'
    )  # fmt: skip
    scene = mended(tmp_path, joints, more='<link name="tip"/>')
    assert reasons(scene) == [("idle", "joint 'bend'")]
    assert scene.derive().state_names == ("q_pin", "u_pin")


POINT = """<inertial><origin xyz="{}"/><mass value="2"/>
  <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>"""


@pytest.mark.parametrize(
    ("kind", "centre", "fixed"),
    [
        ("revolute", "0 0 0", True), ("continuous", "0.3 0 0", True), ("revolute", "0 0.1 0", False),
        ("prismatic", "0 0 0", False),
    ],
)  # fmt: skip
def test_a_joint_that_turns_a_point_on_its_axis_is_fixed(kind, centre, fixed, tmp_path):
    """The axis is x unless it is given."""
    bend = "</joint>" + '<joint name="bend" ' + pin(
        kind, '<origin xyz="0 0 0.5"/>', '<parent link="arm"/><child link="tip"/>'
    )  # fmt: skip
    tip = f'<link name="tip">{POINT.format(centre)}</link>'
    scene = eom.load_scene(robot(tmp_path, pin("revolute") + bend, more=tip), strict=False)
    assert reasons(scene) == [("idle", "joint 'bend'")] * fixed
    assert ("q_bend" in scene.derive().state_names) is not fixed


def test_inertia_without_mass_is_lumped_where_it_is_fixed(tmp_path):
    """The sum of both, in the axes of the one with mass."""
    joints = pin("revolute") + '</joint><joint name="weld" ' + pin(
        "fixed", '<origin rpy="0 1.5707963267948966 0"/>', '<parent link="arm"/><child link="tip"/>'
    )  # fmt: skip
    scene = mended(tmp_path, joints, more=LINK.format("tip", 0, 0.1, 0.2, 0.3))
    assert reasons(scene) == [("massless", "link 'tip'")]
    J = np.array(scene.tree.body["arm"].central_inertia, float)
    np.testing.assert_allclose(J, np.diag([1.3, 1.2, 1.1]), rtol=1e-15)
    assert not any(x for row in scene.tree.body["tip"].central_inertia for x in row)


@pytest.mark.parametrize("floating", [False, True])
def test_inertia_without_mass_at_the_root(tmp_path, floating):
    base = LINK.format("base", 0, 0.1, 0.2, 0.3)
    text = robot(tmp_path, pin("fixed")).read_text(encoding="utf-8")
    file = tmp_path / "robot.urdf"
    file.write_text(text.replace('<link name="base"/>', base), encoding="utf-8")
    scene = eom.load_scene(file, strict=False, floating=floating)
    (repair,) = scene.repairs
    assert ("lumped" in repair.done) == floating
    assert ("moves nothing" in repair.done) != floating


def test_names_that_no_symbol_has_are_mapped(tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(
        '\n<?xml version="1.0"?><robot><link name="ground"/>' + LINK.format("8", 1, 1, 1, 1)
        + '<joint name="a-b" type="revolute"><parent link="ground"/><child link="8"/></joint>'
        + LINK.format("9", 1, 1, 1, 1)
        + '<joint name="a_b" type="revolute"><parent link="8"/><child link="9"/></joint></robot>',
        encoding="utf-8",
    )  # fmt: skip
    with pytest.raises(InputError, match="not valid XML"):
        eom.load_scene(file)
    scene = eom.load_scene(file, strict=False)
    assert set(scene.bodies) == {"link_ground", "link_8", "link_9"}
    assert scene.derive().state_names == ("q_a_b", "q_a_b_0", "u_a_b", "u_a_b_0")
    assert [r.part for r in scene.repairs] == [
        "robot", "link 'ground'", "link '8'", "link '9'", "joint 'a_b'",
    ]  # fmt: skip


def test_damping_of_fixed_joints_and_ball_joints(tmp_path):
    scene = mended(tmp_path, pin("fixed", '<dynamics damping="1"/>'))
    assert reasons(scene) == [("damping", "joint 'pin'")]
    scene = mended(tmp_path, pin("spherical"))
    assert reasons(scene) == [("type", "joint 'pin'")]
    assert scene.joints["pin"].kind == "spherical"


@pytest.mark.parametrize(
    ("arguments", "keys", "what"),
    [
        ((pin("screw"),), {}, "unknown type"),
        ((pin("revolute"),), {"body": BODY.replace('"2"', '"-2"')}, "mass is negative"),
        ((pin("revolute"),), {"body": BODY.replace('ixx="1"', 'ixx="nan"')}, "unusable value"),
        ((pin("revolute", '<axis xyz="0 0 0"/>'),), {}, "axis is zero"),
        ((pin("fixed"),), {"more": '<link name="arm"/>'}, "repeated name|one root"),
        ((pin("fixed"),), {"more": '<link name="c"/>'}, "one root link"),
        ((pin("fixed"),), {"start": BILLION}, "no document type"),
        (
            (pin("fixed", mid='<parent link="bse"/><child link="arm"/>'),),
            {},
            "unknown link|one root",
        ),
    ],
)
def test_lenient_reading_refuses_what_nobody_can_mend(tmp_path, arguments, keys, what):
    with pytest.raises(InputError, match=what):
        eom.load_scene(robot(tmp_path, *arguments, **keys), strict=False).derive()


def test_nothing_is_mended_where_nothing_is_wrong():
    strict, lenient = eom.load_scene(WALKER), eom.load_scene(WALKER, strict=False)
    assert lenient.repairs == strict.repairs  # what is left out alone
    for part in ("bodies", "joints", "constraints", "initial", "notes"):
        assert getattr(lenient, part) == getattr(strict, part)


def test_a_floating_base_falls_with_all_it_carries():
    """Free of the ground, the robot's centre of mass falls with gravity, whatever its joints do."""
    scene = eom.load_scene(WALKER, floating=True)
    system = scene.full_system
    assert [n for n in system.state_names if "root" in n][:3] == ["x_root", "y_root", "z_root"]
    assert "root link world-plate floats" in "\n".join(scene.notes)
    values = {**scene.initial_values(), "q_hip": 0.4, "u_knee": 2.0}
    x = [values[n] for n in system.state_names]
    names = system.state_names
    groups = interpret(lower_system(system), Point(x=x, u=[0.3] * len(system.inputs)))
    rates = dict(zip(names, groups["rates"], strict=True))
    tree = scene.tree
    centre = momentum_rate(tree, values, rates)
    np.testing.assert_allclose(centre, [0, 0, -9.81], atol=1e-9)


def momentum_rate(tree, values, rates):
    """The acceleration of the centre of mass, by the difference of momenta of two states close in time."""
    from eom.multibody import derive

    system = derive(tree, ["momentum"])
    names = system.state_names
    program = lower_system(system)
    mass = sum(float(b.mass) for b in tree.bodies)
    h = 1e-6

    def momentum(sign):
        x = [values[n] + sign * h * rates[n] for n in names]
        found = interpret(program, Point(x=x, u=[0.3] * len(system.inputs)))["outputs"]
        return np.array(found[:3])

    return (momentum(1) - momentum(-1)) / (2 * h) / mass


def test_a_floating_base_without_mass_is_refused(tmp_path):
    with pytest.raises(InputError, match="a base that floats has no mass"):
        eom.load_scene(robot(tmp_path, pin("revolute")), floating=True)


def test_other_scenes_are_not_read_so():
    for words in ({"strict": False}, {"floating": True}):
        with pytest.raises(InputError, match="only robots"):
            eom.load_scene("double-pendulum", **words)


def test_the_ready_leg_says_what_its_urdf_says():
    """Of the scene the drives are left out; the same masses, placements and axes to the last digit."""
    robot = eom.load_scene(Path(__file__).parent / "robots" / "solo12-leg.urdf").tree
    scene = eom.load_scene("walking-leg").tree
    assert [j.name for j in robot.ordered[1:]] == [f"FL_{j.name}" for j in scene.ordered]
    for one, other in zip(robot.ordered[1:], scene.ordered, strict=True):
        assert (one.kind, one.axis, one.on_parent) == (other.kind, other.axis, other.on_parent)
        a, b = robot.body[one.child], scene.body[other.child]
        assert (float(a.mass), *map(float, a.centre)) == (float(b.mass), *map(float, b.centre))
        assert np.array(a.central_inertia, float) == pytest.approx(
            np.array(b.central_inertia, float)
        )
