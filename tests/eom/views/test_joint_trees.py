"""Diagrams of trees: where bodies stand, what lines cross, which names are there."""

import importlib.util
import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from eom.errors import InputError
from eom.multibody import Body, Distance, Joint, Tree
from eom.opening import load_scene
from eom.scenes import catalogue
from eom.views.draw.picture import Curve, Words
from eom.views.tree.joint_trees import BOX, LETTERS, cells, joint_tree
from tests.draws import examples

TREES = [n for n in catalogue.names() if n not in catalogue.single()]
WALKER = Path(__file__).parents[1] / "multibody" / "robots" / "walker.urdf"


@st.composite
def parents(draw, most=35):
    """For each body the number of its parent, -1 for the ground."""
    count = draw(st.integers(1, most))
    near = draw(st.integers(1, most))
    return [draw(st.integers(max(-1, k - near), k - 1)) for k in range(count)]


def tree_of(numbers, kind="revolute", constraints=(), name=lambda k: f"body{k}"):
    names = [name(k) for k in range(len(numbers))]
    bodies = [Body(n, 1, inertia=(1, 1, 1)) for n in names]
    joints = [
        Joint(f"joint{k}", kind, names[p] if p >= 0 else "ground", names[k])
        for k, p in enumerate(numbers)
    ]
    return Tree("drawn", bodies, joints, constraints=constraints)


def panel(tree, title=""):
    return joint_tree(tree, title).rows[0][0]


def texts(shown):
    return [i.text for i in shown.items if isinstance(i, Words)]


def boxes(shown):
    """Left, right, bottom and top of each box: closed lines of five corners."""
    closed = [i.points for i in shown.items if isinstance(i, Curve) and len(i.points) == 5]
    return [(*p[:, 0][[0, 1]], *p[:, 1][[0, 2]]) for p in closed if np.array_equal(p[0], p[-1])]


@given(parents(), st.integers(2, 9))
def test_no_two_bodies_share_a_cell(numbers, columns):
    children = {}
    for k, p in enumerate(numbers):
        children.setdefault(str(p), []).append(str(k))
    found = cells("-1", children, columns)
    assert set(found) == {"-1", *map(str, range(len(numbers)))}
    assert len({(c.row, c.column) for c in found.values()}) == len(found)
    for k, p in enumerate(numbers):
        parent, child = found[str(p)], found[str(k)]
        assert child.column < columns
        assert (
            child.band == parent.band and child.column > parent.column
        ) or child.band > parent.band
        assert child.band == parent.band or parent.column == columns - 1


@examples(40)
@example([-1, *[0] * 24])
@example([-1, *[0] * 25])
@example([-1, *[0] * 14, 1, 1])
@given(parents())
def test_boxes_are_apart_and_no_line_of_a_joint_crosses_one(numbers):
    shown = panel(tree_of(numbers))
    rectangles = boxes(shown)
    assert len(rectangles) == len(numbers) + 1
    for k, (a, b, c, d) in enumerate(rectangles):
        assert d - c == pytest.approx(BOX)
        for e, f, g, h in rectangles[:k]:
            assert b < e or f < a or d < g or h < c
    lines = [i.points for i in shown.items if isinstance(i, Curve) and i.width == 1.0]
    assert len(lines) == 2 * len(numbers)
    for line in lines:
        for (x1, y1), (x2, y2) in itertools.pairwise(line):
            assert x1 == pytest.approx(x2) or y1 == pytest.approx(y2)
            for a, b, c, d in rectangles:
                outside = max(x1, x2) <= a + 1e-9 or min(x1, x2) >= b - 1e-9
                assert outside or max(y1, y2) < c or min(y1, y2) > d


@pytest.mark.parametrize("numbers", [range(-1, 49), [-1] + [0] * 49], ids=["chain", "star"])
def test_fifty_bodies_fit_a_page_and_stay_within_its_limits(numbers):
    picture = joint_tree(tree_of(list(numbers)))
    width, height = picture.size
    assert width < 16
    assert height < 16
    (low, high), (bottom, top) = (axis.limits for axis in picture.rows[0][0].axes)
    for item in picture.rows[0][0].items:
        places = item.place[None] if isinstance(item, Words) else item.points
        assert (places >= (low, bottom)).all()
        assert (places <= (high, top)).all()


@pytest.mark.parametrize("name", [*TREES, pytest.param(WALKER, id="walker")])
def test_every_body_joint_and_constraint_of_a_scene_is_named(name):
    if name is WALKER and importlib.util.find_spec("yourdfpy") is None:
        pytest.skip("needs the extra urdf")
    scene = load_scene(name)
    shown, tree = panel(scene.tree, scene.title), scene.tree
    words = texts(shown)
    for named in ("ground", *(b.name for b in tree.bodies), *(j.name for j in tree.joints)):
        assert named in words
    for joint in tree.joints:
        assert f"$\\mathbf{{{LETTERS[joint.kind]}}}$" in words
    dashed = [i for i in shown.items if isinstance(i, Curve) and i.dash == "dashed"]
    assert len(dashed) == len(tree.constraints) + len(tree.springs)
    assert all(any(w.startswith(c.name) for w in words) for c in tree.constraints)


def test_a_constraint_leads_from_one_of_its_bodies_to_the_other():
    rod = Distance("rod", "body1", "body2", 1)
    shown = panel(tree_of([-1, 0, 0], constraints=[rod]))
    (dashed,) = (i for i in shown.items if isinstance(i, Curve) and i.dash == "dashed")
    around = dict(zip(["ground", "body0", "body1", "body2"], boxes(shown), strict=True))
    ends = {tuple(dashed.points[0]), tuple(dashed.points[-1])}
    for body in rod.bodies:
        a, b, c, d = around[body]
        assert any(a <= x <= b and c <= y <= d for x, y in ends)


def test_long_names_are_cut_and_hostile_titles_are_plain_text():
    long = tree_of([-1], name=lambda k: "b" * 60)
    title = "<script>alert(1)</script> $\\frac{ 5 \\input{x} $$$"
    picture = joint_tree(long, title)
    assert "b" * 17 + "…" in texts(picture.rows[0][0])
    assert picture.title.replace("\\$", "").count("$") == 0
    pytest.importorskip("matplotlib")
    from eom.views.draw.printed import figure

    figure(picture)


def test_a_tree_without_bodies_is_refused():
    with pytest.raises(InputError, match="without bodies"):
        joint_tree(Tree("nothing", [], []))
