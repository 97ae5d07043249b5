"""Sketches of one body and of trees: what acts points the way it acts, at the place where it acts."""

import math

import numpy as np
import pytest
import sympy as sp

from eom.errors import InputError
from eom.multibody.files.scene import TreeScene
from eom.multibody.model.constraints import Loop
from eom.opening import load_scene
from eom.scenes import catalogue
from eom.scenes.scene import Scene
from eom.views.animation.bodies import ManyBodies
from eom.views.animation.posture import number
from eom.views.draw.picture import Arrow, Curve, Marks, Surface, Words
from eom.views.draw.viewpoint import names, paper
from eom.views.tree.sketches import FORCE, REACTION, TORQUE, TreeAtStart, sketch, tree_frames
from tests.eom.rows import only

TREES = [n for n in catalogue.names() if n not in catalogue.single()]


def items(picture):
    return picture.rows[0][0].items


def arrows(picture, colour):
    """Arrows of loads: those that the legend lists."""
    return [i for i in items(picture) if isinstance(i, Arrow) and i.colour == colour and i.label]


def way(arrow):
    return (arrow.end - arrow.start) / np.linalg.norm(arrow.end - arrow.start)


def body(**changes):
    data = {
        "title": "body",
        "attitude": "3-2-1",
        "body": {"moments": [1.0, 2.0, 2.5]},
        "initial": {"omega_1": 0.0, "omega_2": 0.0, "omega_3": 2.0},
        "initial_attitude": {"sequence": "3-2-1", "degrees": [20, 30, 40]},
    }
    return Scene(**{**data, **changes})


def axes_of(picture):
    """The body's axes by their numbers, those that are lines with the reference axes among them."""
    found = {
        name: way(i)
        for i in items(picture)
        if isinstance(i, Arrow) and i.colour in {"black", "blue"}
        for name in i.words.strip("$").split(" = ")
    }
    return [found[rf"\mathbf{{b}}_{k}"] for k in (1, 2, 3)]


def test_a_component_of_torque_has_its_sense_at_the_start():
    torque = {"components": ["M*cos(t)", 0, "-k*omega_3"]}
    picture = sketch(body(torque=torque, parameters={"M": 1.5, "k": 0.5}))
    b = axes_of(picture)
    first, third = arrows(picture, TORQUE)
    np.testing.assert_allclose(way(first), b[0], atol=1e-12)
    np.testing.assert_allclose(way(third), -b[2], atol=1e-12)
    assert first.words == r"$M \cos t\,\mathbf{b}_1$"
    assert third.words == r"$-k \omega_{3}\,\mathbf{b}_3$"


def test_the_ring_turns_the_way_the_torque_does():
    picture = sketch(body(torque={"components": [0, "-M", 0]}, parameters={"M": 1.0}))
    (torque,) = arrows(picture, TORQUE)
    (ring,) = (i.points for i in items(picture) if isinstance(i, Curve) and i.colour == TORQUE)
    middle = torque.start + way(torque) * ((ring[0] - torque.start) @ way(torque))
    r = ring - middle
    assert np.all(np.cross(r[:-1], r[1:]) @ way(torque) > 0)
    np.testing.assert_allclose(r @ way(torque), 0, atol=1e-14)


def test_weight_and_reaction_of_a_top():
    scene = Scene.ready("heavy-top")
    picture = sketch(scene)
    (weight,), (reaction,) = arrows(picture, FORCE), arrows(picture, REACTION)
    np.testing.assert_allclose(way(weight), [0, 0, -1])
    np.testing.assert_allclose(way(reaction), [0, 0, 1])
    np.testing.assert_allclose(reaction.end, 0, atol=1e-15)
    tilt = 0.6
    assert way(Arrow(np.zeros(3), weight.start))[2] == pytest.approx(math.cos(tilt))
    surface = next(i for i in items(picture) if isinstance(i, Surface))
    along = surface.vertices @ axes_of(picture)[2]
    assert along.min() == pytest.approx(0, abs=1e-12)
    assert {"$G$", "$O$"} <= {i.text for i in items(picture) if isinstance(i, Words)}


def test_gravity_gradient_turns_as_the_cross_product_says():
    """3 n^2 a1 x (J a1): Hughes, Spacecraft Attitude Dynamics (1986), sect. 8.1."""
    scene = Scene.ready("gravity-gradient-satellite")
    picture = sketch(scene)
    (torque,) = arrows(picture, TORQUE)
    b = np.array(axes_of(picture))
    a1 = b @ [1, 0, 0]
    expected = np.cross(a1, np.array(scene.body.moments) * a1) @ b
    np.testing.assert_allclose(way(torque), expected / np.linalg.norm(expected), atol=1e-9)


@pytest.mark.parametrize("name", catalogue.single())
def test_every_scene_of_one_body_has_its_frames_and_centre(name):
    picture = sketch(Scene.ready(name))
    np.testing.assert_allclose(np.linalg.det(axes_of(picture)), 1)
    assert "$G$" in {i.text for i in items(picture) if isinstance(i, Words)}


@pytest.mark.parametrize("name", only(TREES, "double-pendulum", "four-bar-linkage"))
def test_bodies_hang_together_and_weights_act_at_their_centres(name):
    scene = TreeScene.ready(name)
    tree, here = scene.tree, TreeAtStart(ManyBodies(scene))
    for joint in tree.ordered:
        frame, columns = here.joints[joint.name]
        np.testing.assert_allclose(
            frame.origin, here.on_body(joint.child, joint.on_child.position), atol=1e-12
        )
        if joint.kind in {"revolute", "universal", "spherical", "fixed"}:
            hinge = here.on_body(joint.parent, joint.on_parent.position)
            np.testing.assert_allclose(frame.origin, hinge, atol=1e-12)
        assert len(columns) == len(joint.speeds)
    for place in here.bodies.values():
        np.testing.assert_allclose(place.C @ place.C.T, np.eye(3), atol=1e-12)
    for constraint in tree.constraints:
        if isinstance(constraint, Loop):
            first = here.on_body(constraint.first, constraint.on_first.position)
            second = here.on_body(constraint.second, constraint.on_second.position)
            np.testing.assert_allclose(first, second, atol=1e-9)
    picture = sketch(scene)
    texts = {i.text for i in items(picture) if isinstance(i, Words)}
    assert {b.name for b in tree.bodies} <= texts
    gravity = any(tree.gravity)
    weights = [a for a in arrows(picture, FORCE) if a.words.endswith(r"\,g$")]
    assert len(weights) == (
        sum(b.mass != 0 for b in tree.bodies) if gravity and len(tree.bodies) < 7 else 0
    )
    for weight in weights:
        np.testing.assert_allclose(way(weight), [0, 0, -1], atol=1e-12)


def test_a_double_pendulum_stands_where_its_angles_say():
    here = TreeAtStart(ManyBodies(TreeScene.ready("double-pendulum")))
    a, b = 1.2, 1.2 - 0.5
    elbow = np.array([-math.sin(a), 0, -math.cos(a)])
    lower = elbow + 0.4 * np.array([-math.sin(b), 0, -math.cos(b)])
    np.testing.assert_allclose(here.bodies["lower"].origin, elbow, atol=1e-14)
    np.testing.assert_allclose(here.centre("lower"), lower, atol=1e-14)
    np.testing.assert_allclose(here.centre("upper"), elbow / 2, atol=1e-14)


def test_a_spring_acts_against_what_it_is_turned_by():
    """The panel is turned by 0.05 rad about x, so that its spring pulls back about -x."""
    scene = TreeScene.ready("satellite-with-panels")
    found = {a.words: way(a) for a in arrows(sketch(scene), TORQUE)}
    (left,) = (v for words, v in found.items() if "left" in words)
    (wheel,) = (v for words, v in found.items() if "wheel" in words and ",x" in words)
    np.testing.assert_allclose(left, [-1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(wheel, [1, 0, 0], atol=1e-12)


def test_a_disc_touches_its_plane():
    picture = sketch(TreeScene.ready("rolling-disc"))
    (reaction,) = arrows(picture, REACTION)
    assert reaction.end[2] == pytest.approx(0, abs=1e-12)
    np.testing.assert_allclose(way(reaction), [0, 0, 1])
    disc = next(i for i in items(picture) if isinstance(i, Surface) and len(i.vertices) > 4)
    nearest = disc.vertices[np.argmin(disc.vertices[:, 2])]
    assert np.linalg.norm(nearest - reaction.end) < 0.1  # of a disc that is drawn a little thick


def test_a_tree_is_drawn_with_what_is_up_upwards():
    picture = sketch(TreeScene.ready("four-bar-linkage"))
    y = next(i for i in items(picture) if isinstance(i, Arrow) and i.words == "$y$")
    np.testing.assert_allclose(way(y), [0, 0, 1], atol=1e-12)


def test_names_keep_clear_of_arrows_and_of_each_other():
    view = (22.0, 35.0)
    across, _ = paper(view)
    points = {"a": np.zeros(3), "b": 0.05 * across, "c": 0.1 * across}
    arrow = Arrow(np.zeros(3), np.array([0.0, 0.0, 1.0]))
    found = list(names(points, [arrow], view, 0.2))
    assert [w.text for w in found] == ["a", "b", "c"]
    for k, words in enumerate(found):
        assert np.linalg.norm(words.place - points[words.text]) == pytest.approx(0.2)
        assert all(np.linalg.norm(words.place - other.place) > 0.1 for other in found[:k])


def test_values_that_are_no_numbers_are_refused():
    x = sp.Symbol("x", real=True)
    assert number(x, {}) == 0
    assert number(2 * x + 1, {"x": 1.5}) == 4
    for bad in (1 / x, sp.sqrt(x - 1), sp.log(x)):
        with pytest.raises(InputError, match="not a number"):
            number(bad, {"x": 0.0})


def test_hostile_titles_are_plain_text():
    pytest.importorskip("matplotlib")
    from eom.views.draw.printed import figure

    picture = sketch(body(title="$\\frac{<script>$ \\input{x} $"))
    assert picture.title.replace("\\$", "").count("$") == 0
    figure(picture)
    marks = [i for i in items(picture) if isinstance(i, Marks)]
    assert len(marks) == 1


def test_a_robot_of_a_file_is_drawn():
    pytest.importorskip("yourdfpy")
    from pathlib import Path

    file = Path(__file__).parents[1] / "multibody" / "robots" / "walker.urdf"
    scene = load_scene(file)
    texts = {i.text for i in items(sketch(scene)) if isinstance(i, Words)}
    assert {b.name for b in scene.tree.bodies} <= texts


@pytest.mark.parametrize("name", only(TREES, "double-pendulum", "floating-tree"))
def test_the_frames_of_a_tree_stand_at_the_origins_of_its_bodies(name):
    scene = TreeScene.ready(name)
    here, picture = TreeAtStart(ManyBodies(scene)), tree_frames(scene)
    drawn = [i for i in items(picture) if isinstance(i, Arrow)]
    assert len(drawn) == 3 * (1 + len(scene.tree.bodies))
    assert [i.words for i in drawn[:3]] == ["$x$", "$y$", "$z$"]
    R = np.array([way(i) for i in drawn[:3]]).T  # what turns the ground's axes upright
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    for k, body in enumerate(scene.tree.bodies, 1):
        three, place = drawn[3 * k : 3 * k + 3], here.bodies[body.name]
        np.testing.assert_allclose([way(i) for i in three], place.C @ R.T, atol=1e-12)
        np.testing.assert_allclose([i.start for i in three], [R @ place.origin] * 3, atol=1e-12)
    words = [i.words for i in drawn] + [i.text for i in items(picture) if isinstance(i, Words)]
    assert all(any(b.name.split("_")[0][:3] in w for w in words) for b in scene.tree.bodies)
