"""The scenes that ship with the package."""

from __future__ import annotations

import subprocess
import sys

import pytest

import codegen
import eom
from eom.errors import InputError
from eom.scenes import catalogue
from eom.typeset import printing
from eom.typeset.blocks import Display, Heading
from eom.views import gallery
from eom.views.animation.animation import animation_of
from eom.views.animation.animation_page import page as animation_page
from eom.views.draw import turned
from eom.views.live.page import page as live_page
from tests.eom.rows import only

MODELLED = {
    "reaction wheels on a free hub": "reaction-wheels",
    "dual-spin satellite": "dual-spin-satellite",
    "control-moment gyroscope": "control-moment-gyroscope",
    "rotary pendulum": "rotary-pendulum",
    "quadrotor": "quadrotor",
    "gyroscope in gimbals": "gyroscope-in-gimbals",
    "rocket with varying mass": "rocket",
    "Foucault pendulum": "foucault-pendulum",
    "Whipple bicycle": "whipple-bicycle",
    "rolling ellipsoid": "rolling-ellipsoid",
    "rolling disc": "rolling-disc",
    "slider-crank": "slider-crank",
    "leg of a walking robot": "walking-leg",
    "bicycle wheel held by one end": "bicycle-wheel",
    "the lecture's wheel": "lecture-wheel",
}
"""What people model, and the scene that has it."""


def simulated(scene):
    """Return the simulation that an animation is made of."""
    plan, compiled = scene.integration, codegen.compile(scene.derive(), "numpy")
    given = scene.initial_values(), (0, plan.t_end), scene.parameter_values()
    times = [k * plan.t_end / (plan.points - 1) for k in range(plan.points)]
    held = scene.input_values()
    return codegen.simulate(compiled, *given, inputs=held, method="DOP853", t_eval=times)


def test_what_people_model_is_among_the_scenes():
    assert set(MODELLED.values()) <= set(catalogue.names())


@pytest.mark.parametrize("name", only(catalogue.names(), "lecture-wheel"))
def test_every_ready_scene_has_equations_a_picture_an_animation_and_a_live_page(name):
    """No scene is left out: what one of the four refuses fails here."""
    scene = eom.load_scene(name)
    blocks = printing.blocks(scene.derive())
    headings = [b.words for b in blocks if isinstance(b, Heading)]
    assert any(words.startswith("Equations of motion") for words in headings)
    assert any(isinstance(b, Display) and b.lines for b in blocks)
    assert "sketch" in gallery.available(scene)
    picture = turned.page(gallery.picture("sketch", gallery.Ask(scene)))
    seconds = min(1.0, scene.integration.t_end)
    animation = animation_page(animation_of(scene, simulated, seconds=seconds))
    live = live_page(scene)
    for text in (picture, animation, live):
        assert text.startswith("<!DOCTYPE html>")
        assert len(text.encode()) < 2e6


def test_every_ready_scene_has_a_file_and_a_title():
    names = catalogue.names()
    assert names == sorted(names)
    assert len(names) >= 4
    assert set(catalogue.titles()) == set(names)
    assert all(title.strip() for title in catalogue.titles().values())
    assert all(catalogue.path_of(n).is_file() for n in names)


def test_titles_are_read_without_sympy():
    code = "import sys; from eom.scenes import catalogue; catalogue.titles(); print('sympy' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"


@pytest.mark.parametrize("name", ["heavy-tops", "", "../scenes/heavy-top", "heavy-top.toml", "a\0"])
def test_other_names_are_refused(name):
    with pytest.raises(InputError, match="unknown scene") as caught:
        catalogue.path_of(name)
    assert "heavy-top" in caught.value.hint
