"""Texts of printed pictures overlap nowhere: boxes as Matplotlib draws them."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure

from eom import load_scene
from eom.multibody import Body, Joint, Tree
from eom.scenes import catalogue
from eom.views import gallery
from eom.views.draw.picture import COLOURS, Arrow, Axis, Panel, Picture, Words
from eom.views.draw.placing import Box, boxes, overlap, overlaps, place
from eom.views.draw.printed import figure
from eom.views.time.histories import histories_of
from eom.views.tree.joint_trees import joint_tree

PLANE, SPACE = (Axis("$x$ [m]"), Axis("$y$ [m]")), (Axis("a"), Axis("b"), Axis("c"))


def drawn(name, scene):
    return figure(gallery.picture(name, gallery.Ask(scene)))


@pytest.mark.parametrize(
    "name", ["heavy-top", "seven-joint-arm", "whipple-bicycle", "bicycle-wheel"]
)
def test_no_texts_overlap_in_sketches(name):
    scene = load_scene(name)
    for picture in {"sketch", "frames", "joints"} & {*gallery.available(scene)}:
        made = drawn(picture, scene)
        assert len(boxes(made)) > 5
        assert overlaps(made) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", catalogue.names())
def test_no_texts_overlap_in_any_picture_of_any_ready_scene(name):
    scene = load_scene(name)
    for picture in gallery.available(scene):
        if picture != "work-precision":
            assert overlaps(drawn(picture, scene)) == [], picture


def robot(folder, links, branching):
    """Write a robot of so many links, a parent with so many children each, with long names."""
    parts, inertia = [], '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.015"/>'
    for k in range(links):
        body = f'<inertial><origin xyz="0 0 0.1"/><mass value="1"/>{inertia}</inertial>'
        parts.append(f'<link name="left_shoulder_link_{k}">{body}</link>')
    for k in range(1, links):
        parent, axis = (k - 1) // branching, ("1 0 0", "0 1 0", "0 0 1")[k % 3]
        place = f"{0.1 * ((k - 1) % branching)} {0.02 * k} 0.2"
        parts.append(
            f'<joint name="joint_{k}" type="continuous"><parent link="left_shoulder_link_{parent}"/>'
            f'<child link="left_shoulder_link_{k}"/><origin xyz="{place}"/><axis xyz="{axis}"/></joint>'
        )
    file = folder / "robot.urdf"
    file.write_text(f'<robot name="robot">{"".join(parts)}</robot>', encoding="utf-8")
    return load_scene(file)


LARGE = [pytest.param(30, k, marks=pytest.mark.slow) for k in (1, 2, 3, 29)]


@pytest.mark.parametrize(("links", "branching"), [(8, 1), (12, 3), *LARGE])
def test_no_texts_overlap_in_sketches_of_robots(tmp_path, links, branching):
    pytest.importorskip("yourdfpy")
    scene = robot(tmp_path, links, branching)
    for picture in ("sketch", "frames", "joints"):
        assert overlaps(drawn(picture, scene)) == [], picture


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 14))
def test_labels_on_one_point_are_parted(seed, count):
    draw = np.random.default_rng(seed)
    items = tuple(Words(0.02 * draw.normal(size=2), f"label {k}", "blue") for k in range(count))
    corners = tuple(Arrow(np.zeros(2), np.array(e), "black") for e in ((3.0, 2.0), (-3.0, -2.0)))
    made = figure(Picture(((Panel((*corners, *items), PLANE),),), "Crowd"))
    assert overlaps(made) == []
    words = {t.get_text() for axes in made.axes for t in axes.texts if t.get_text()}
    assert words == {f"label {k}" for k in range(count)}


def test_a_label_that_goes_far_has_a_line_to_its_point():
    items = tuple(
        Arrow(np.zeros(3), np.array([0, 0, 1.0]), "red", 2.0, f"arrow {k}") for k in range(6)
    )
    (axes,) = figure(Picture(((Panel(items, SPACE, bare=True),),))).axes
    leaders = [t for t in axes.texts if not t.get_text() and t.arrow_patch is not None]
    assert leaders
    assert {t.xy for t in leaders} <= {t.xy for t in axes.texts if t.get_text()}


def test_labels_that_have_room_stay():
    ends = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0))
    items = tuple(Arrow(np.zeros(2), np.array(e), "red", 2.0, f"F{k}") for k, e in enumerate(ends))
    (axes,) = figure(Picture(((Panel(items, PLANE),),))).axes
    assert [t.xyann for t in axes.texts if t.get_text()] == [(6, 0), (-6, 0), (0, 6)]


@given(*[st.floats(-50, 50)] * 4, *[st.floats(1, 30)] * 4, *[st.floats(0, 6.3)] * 2)
def test_boxes_overlap_where_points_say_so(x1, y1, x2, y2, a1, b1, a2, b2, turn1, turn2):
    a = Box("a", np.array([x1, y1]), np.array([a1, b1]), turn1)
    b = Box("b", np.array([x2, y2]), np.array([a2, b2]), turn2)
    grid = np.stack(np.meshgrid(np.linspace(-1, 1, 25), np.linspace(-1, 1, 25)), -1).reshape(-1, 2)
    inside = (a.middle + (grid * a.size) @ a.axes - b.middle) @ b.axes.T
    met = bool(np.any(np.all(np.abs(inside) < b.size - 1e-9, axis=1)))
    assert overlap(a, b) == overlap(b, a)
    assert overlap(a, b) or not met
    assert overlap(a, b, 1.0) or not overlap(a, b)


def test_rotors_stand_above_their_bodies():
    names = ["a_long_name_of_a_body", "b"]
    bodies = [Body(n, 1.0, inertia=(1, 1, 1)) for n in names]
    joints = [Joint(f"j{k}", "revolute", "ground", n, axis="z") for k, n in enumerate(names)]
    assert overlaps(figure(joint_tree(Tree("two", bodies=bodies, joints=joints)))) == []


# -- colours ---------------------------------------------------------------------------------------------

# Machado, Oliveira and Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291, table 1, severity 1.0
SEEN = {
    "normal": np.eye(3),
    "protan": (0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998),
    "deutan": (0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881),
    "tritan": (1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900),
}  # fmt: skip
TO_XYZ = np.array([
    [0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041],
])  # fmt: skip


def lab(code, seen):
    """Return CIELAB of an sRGB colour as it is seen (IEC 61966-2-1, CIE 15)."""
    c = np.array([int(code[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ np.clip(np.reshape(seen, (3, 3)) @ linear, 0, 1) / (0.95047, 1.0, 1.08883)
    f = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("eyes", SEEN)
def test_each_two_colours_are_told_apart(eyes):
    found = {n: lab(code, SEEN[eyes]) for n, code in COLOURS.items()}
    for a, b in itertools.combinations(COLOURS, 2):
        assert math.dist(found[a], found[b]) > 15, (a, b)


def test_no_two_series_of_a_panel_look_the_same():
    for name in ("heavy-top", "quadrotor"):
        for (panel,) in histories_of(load_scene(name), points=101).rows:
            looks = [(item.colour, item.dash) for item in panel.items]
            assert len({*looks}) == len(looks)
            assert len({colour for colour, _ in looks}) == len(looks)


# -- sizes, points ---------------------------------------------------------------------------------------


def test_unlike_sizes_have_panels_of_their_own_and_noise_has_none():
    made = histories_of(load_scene("control-moment-gyroscope"), seconds=2.0)
    for (panel,) in made.rows[:-1]:
        tops = [float(np.nanmax(np.abs(item.points[:, 1]))) for item in panel.items]
        large = [t for t in tops if t > 1e-6 * max(tops)]
        assert max(large) <= 20 * min(large)


def test_points_follow_the_fastest_motion_and_too_few_are_told():
    scene = load_scene("heavy-top").with_values({"omega_3": 2000.0})
    assert "points are too few" in histories_of(scene, seconds=20.0, points=300).notice
    made = histories_of(load_scene("heavy-top"))
    assert made.notice == ""
    q = made.rows[1][0].items[0].points[:, 1]
    assert np.max(np.abs(np.diff(q))) < 0.2 * np.ptp(q)


def crowd(turn):
    """A figure with names at the ends of arrows that turn at different rates about one point."""
    made = Figure(figsize=(4, 3), dpi=100)
    axes = made.add_axes((0, 0, 1, 1))
    axes.set(xlim=(-2, 2), ylim=(-1.5, 1.5))
    for k in range(8):
        angle = 0.15 * k + turn * (1 + 0.4 * (-1) ** k)
        end = (0.6 * np.cos(angle), 0.6 * np.sin(angle))
        axes.annotate(
            f"name {k}", end, (0, 0), textcoords="offset points", ha="center", va="center"
        )
    return made


def test_labels_are_steady_in_a_film():
    def jumps(before):
        found, last = 0, {}
        for k in range(12):
            made = crowd(0.03 * k)
            place(made, covering=True, before=before)
            assert overlaps(made) == []
            (axes,) = made.axes
            now = {t.get_text(): np.array(t.xyann) for t in axes.texts if t.get_text()}
            found += sum(np.abs(now[n] - last[n]).max() > 8 for n in last)
            last = now
            if before is not None:
                assert set(before) <= set(now)
        return found

    assert 2 * jumps({}) <= jumps(None)
