"""MJCF files: MuJoCo's own accelerations, what is left out, and what is refused."""

import sys

import pytest

import eom
from eom.errors import InputError

pytest.importorskip("mujoco")
from benchmarks.mjcf import difference

HEAD = "<mujoco><compiler angle='radian'/><option gravity='0.5 0 -9.81' viscosity='{medium}'/>"
BALL = (
    "<body name='{name}' pos='0.3 0.1 -0.2' quat='0.5 0.1 -0.3 0.2'>{joints}"
    "<geom size='.1 .2 .3' type='box' pos='.1 0 .05'/>{inner}</body>"
)


def model(*bodies, medium="0", more=""):
    inside = "".join(bodies)
    return HEAD.format(medium=medium) + f"<worldbody>{inside}</worldbody>{more}</mujoco>"


def body(name, *joints, inner=""):
    return BALL.format(name=name, joints="".join(joints), inner=inner)


@pytest.fixture
def written(tmp_path):
    def write(text, name="model.xml"):
        file = tmp_path / name
        file.write_text(text, encoding="utf-8")
        return file

    return write


HINGE = (
    "<joint name='hinge' type='hinge' axis='1 2 0' pos='.1 .2 -.1' ref='.4' stiffness='3' "
    "springref='.7' damping='.2' armature='.05'/>"
)
SLIDE = "<joint name='slide' type='slide' axis='0 1 1' pos='.4 0 .1' stiffness='2' ref='-.1'/>"
JOINT = "<joint name='ball' type='ball' pos='0 .3 .1' damping='.3' armature='.02'/>"
FREE = "<freejoint name='free'/>"


@pytest.mark.parametrize(
    ("text", "speeds"),
    [
        (model(body("a", HINGE)), 1),
        (model(body("a", SLIDE, HINGE, JOINT)), 5),
        (model(body("a", FREE, inner=body("b", JOINT, inner=body("c", HINGE, SLIDE)))), 11),
        (model(body("a", inner=body("b", HINGE, inner=body("c", inner=body("d", JOINT))))), 4),
        (model(body("a", FREE), body("b", HINGE)), 7),
    ],
    ids=["hinge", "three in one body", "free", "on what is fixed", "two trees"],
)
def test_accelerations_are_those_of_mujoco(written, text, speeds):
    off, _, found = difference(written(text))
    assert found == speeds
    assert off <= 1e-13


def test_a_joint_starts_where_the_file_is_written(written):
    scene = eom.load_scene(written(model(body("a", FREE), body("b", HINGE))))
    assert scene.start["q_hinge"] == 0
    assert [scene.start[f"{x}_free"] for x in "xyz"] == [0.3, 0.1, -0.2]
    size = (0.5**2 + 0.1**2 + 0.3**2 + 0.2**2) ** 0.5
    found = [scene.start[f"e_free_{k}"] for k in range(4)]
    assert found == pytest.approx([0.5 / size, 0.1 / size, -0.3 / size, 0.2 / size], rel=1e-15)
    hinge = scene.joints["hinge"]
    assert (hinge.stiffness, hinge.rest) == (3, pytest.approx(0.3, rel=1e-15))


def test_what_is_no_part_of_a_tree_is_said_as_data_and_in_words(written):
    limited = "<joint name='b' type='ball' range='0 1' limited='true' stiffness='4'/>"
    more = (
        "<tendon><fixed name='cord'><joint joint='hinge' coef='1'/></fixed></tendon>"
        "<actuator><motor name='m' joint='hinge'/><muscle name='biceps' joint='hinge' "
        "lengthrange='0.1 1'/></actuator>"
        "<equality><joint name='tie' joint1='hinge' joint2='slide'/></equality>"
    )
    rubbing = "<joint name='slide' type='slide' frictionloss='1'/>"
    text = model(body("x", limited), body("y", HINGE, rubbing), medium="0.1", more=more)
    scene = eom.load_scene(written(text))
    found = {(r.reason, r.part) for r in scene.repairs}
    assert found == {
        ("contact", "2 geoms that can touch"), ("limit", "joint 'b'"), ("friction", "joint 'slide'"),
        ("tendon", "tendon 'cord'"), ("actuator", "actuator 'm'"), ("actuator", "muscle 'biceps'"),
        ("equality", "equality 'tie'"), ("spring", "joint 'b'"), ("surroundings", "option 'viscosity'"),
    }  # fmt: skip
    words = str(scene.explain())
    for part in ("joint 'b': left out", "muscle 'biceps': left out", "cord", "viscosity"):
        assert part in words


def test_nothing_is_said_of_what_is_switched_off(written):
    flags = " ".join(f"{x}='disable'" for x in ("contact", "gravity", "spring", "damper"))
    off = HEAD.format(medium="0") + f"<option><flag {flags}/></option>"
    text = off + f"<worldbody>{body('a', HINGE)}{body('b', SLIDE)}</worldbody></mujoco>"
    scene = eom.load_scene(written(text))
    assert scene.repairs == ()
    assert scene.gravity == (0, 0, 0)
    assert (scene.joints["hinge"].stiffness, scene.joints["hinge"].damping) == (0, 0)
    assert difference(written(text))[0] <= 1e-13


@pytest.mark.parametrize(
    ("inside", "reasons"),
    [
        ("<body mocap='true'><geom size='.1'/></body>", ["surroundings"]),
        ("<body><joint type='free' armature='1' stiffness='1'/><geom size='.1'/></body>",
         ["spring", "armature"]),
        ("<body gravcomp='1'><joint/><geom size='.1'/></body>", ["surroundings"]),
        ("<flexcomp name='f' type='grid' count='2 2 1' spacing='.1 .1 .1' radius='.01' dim='2' mass='1'/>",
         ["flex"]),
    ],
)  # fmt: skip
def test_what_else_is_left_out(written, inside, reasons):
    assert [r.reason for r in eom.load_scene(written(model(inside))).repairs] == reasons


def test_a_model_without_bodies_moves_nothing(written):
    assert eom.load_scene(written("<mujoco/>")).derive().states == ()


HOSTILE = ["__import__('os')", "a;b", "9", "ground", "ä/ö", "x y", "x_y", "\\\\n"]


def test_names_are_mapped_to_those_of_symbols(written):
    spelt = [n.replace("'", "&apos;") for n in HOSTILE]
    bodies = [body(n, f"<joint name='{n}' axis='0 0 1'/>") for n in spelt]
    unnamed = body("", "<joint/>").replace("name=''", "")
    scene = eom.load_scene(written(model(*bodies, unnamed)))
    assert len(scene.bodies) == len(HOSTILE) + 1
    assert all(n.isidentifier() for n in (*scene.bodies, *scene.joints))
    assert len(set(scene.derive().state_names)) == 2 * (len(HOSTILE) + 1)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<mujoco><worldbody>", "not valid XML"),
        ("", "not valid XML"),
        ("<robot name='r'/>", r"name a URDF file \.urdf"),
        ("<html/>", "expected: mujoco"),
        ("<!DOCTYPE mujoco [<!ENTITY a 'b'>]><mujoco/>", "document type"),
        (model(body("a", inner=body("b", FREE))), "MuJoCo refuses"),
        (model("<body><joint/></body>"), "MuJoCo refuses"),
        (
            (
                "<mujoco><asset><mesh name='m' file='no.stl'/></asset><worldbody><body>"
                "<geom type='mesh' mesh='m'/></body></worldbody></mujoco>"
            ),
            r"no\.stl",
        ),
        ("<mujoco><worldbody><body euler='1 2 x'/></worldbody></mujoco>", "MuJoCo refuses"),
    ],
)
def test_what_is_no_model_is_refused_with_the_file(written, text, words):
    with pytest.raises(InputError, match=words) as caught:
        eom.load_scene(written(text))
    assert "model.xml" in str(caught.value)


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such scene file"):
        eom.load_scene(tmp_path / "none.xml")


def test_without_mujoco_it_says_what_to_install(written, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(InputError, match=r"eom-toolkit\[mujoco\]"):
        eom.load_scene(written(model(body("a", HINGE))))


def test_the_one_body_on_the_ground_can_be_freed(written):
    file = written(model(body("a", inner=body("b", HINGE))))
    assert eom.load_scene(file).derive().state_names == ("q_hinge", "u_hinge")
    freed = eom.load_scene(file, floating=True)
    assert freed.joints["root_a"].kind == "free"
    assert freed.start["e_root_a_0"] == 1
    assert len(freed.derive().states) == 2 + 13
    two = written(model(body("a"), body("b")))
    with pytest.raises(InputError, match="one body that is fixed"):
        eom.load_scene(two, floating=True)
