"""Every picture of the gallery in both renderers, and why a scene cannot have one."""

from __future__ import annotations

import numpy as np
import pytest

from codegen.measure.workprecision import measuring, programs
from eom import InputError, load_scene
from eom.views import gallery
from eom.views.draw import printed, turned
from eom.views.draw.picture import check
from eom.views.gallery import PICTURES, Ask
from tests.eom.rows import every

pytest.importorskip("matplotlib")

SCENES = dict.fromkeys(PICTURES, "t-handle") | {
    "sphere": "lecture-wheel",
    "sketch": "double-pendulum",
    "joints": "four-bar-linkage",
    "frames": "t-handle-in-angles",
    "wheel": "lecture-wheel",
}


@pytest.fixture
def few_measurements(monkeypatch):
    """Measure two programs at two tolerances once, in place of all."""
    every = programs.programs
    monkeypatch.setattr(programs, "programs", lambda names: every(names or ["taylor", "DOP853"]))
    plan = measuring.Plan(tolerances=(1e-5, 1e-8), rounds=1)
    monkeypatch.setattr(measuring, "QUICK", plan)


@pytest.mark.usefixtures("few_measurements")
@pytest.mark.parametrize("name", every(3, PICTURES))
def test_every_picture_is_drawn_by_both_renderers(name):
    scene = load_scene(SCENES[name])
    picture = gallery.picture(name, Ask(scene, 0.5, 60))
    check(picture)
    assert picture.title
    assert picture.caption
    figure = printed.figure(picture, (4.0, 3.0))
    assert len(figure.axes) == sum(map(len, picture.rows))
    described = turned.described(picture)
    drawn = [panel for row in described["rows"] for panel in row]
    assert len(drawn) == sum(map(len, picture.rows))
    assert all(panel["items"] for panel in drawn)


@pytest.mark.parametrize("name", ["t-handle", "heavy-top", "lecture-wheel", "double-pendulum"])
def test_the_default_is_among_those_that_a_scene_can_have(name):
    scene = load_scene(name)
    assert gallery.default(scene) in gallery.available(scene)
    assert gallery.FIRST[-1] in gallery.available(scene)


@pytest.mark.parametrize(
    ("scene", "name", "reason"),
    [
        ("heavy-top", "polhodes", "weight"),
        ("double-pendulum", "sphere", "many bodies"),
        ("gravity-gradient-satellite", "cones", "turns with an orbit"),
        ("t-handle", "joints", "without joints"),
        ("t-handle", "wheel", "spinner"),
        ("t-handle", "frames", "no angles"),
    ],
)
def test_a_picture_that_a_scene_cannot_have_says_why(scene, name, reason):
    opened = load_scene(scene)
    assert name not in gallery.available(opened)
    with pytest.raises(InputError, match=reason) as caught:
        gallery.picture(name, Ask(opened))
    assert caught.value.expected == PICTURES[name].needs
    assert all(other in caught.value.hint for other in gallery.available(opened))


def test_unknown_names_have_near_matches():
    with pytest.raises(InputError, match="unknown picture") as caught:
        gallery.picture("polhode", Ask(load_scene("t-handle")))
    assert "polhodes" in caught.value.hint


def test_several_pictures_stand_below_each_other():
    ask = Ask(load_scene("t-handle"), 0.5, 40)
    parts = [gallery.picture(name, ask) for name in ("ellipsoids", "herpolhode")]
    both = gallery.pictures(("ellipsoids", "herpolhode"), ask)
    assert len(both.rows) == sum(len(part.rows) for part in parts)
    assert both.title == parts[0].title
    assert all(part.caption in both.caption for part in parts)
    assert gallery.pictures(("ellipsoids",), ask).caption == parts[0].caption
    placed = [p for row in both.rows for p in row]
    assert np.array([p.axes[0].words != "" for p in placed]).all()
