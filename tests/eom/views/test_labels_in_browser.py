"""Words of pages in space at many viewpoints: no two boxes overlap, none leaves the picture."""

import itertools
import shutil

import pytest

from eom import load_scene
from eom.commands.simulating import job_of
from eom.views import gallery
from eom.views.animation.animation import animation_of
from eom.views.animation.animation_page import page
from eom.views.draw import turned
from tests.eom.views.live_pages import text_of

sync_api = pytest.importorskip("playwright.sync_api")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")

FLAGS = "--no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader".split()
VIEWS = [(0.7, 0.0), (0.7, 0.9), (0.7, -1.3), (0.7, -0.6), (0.7, 1.4), (2.0, -0.4), (0.3, 0.2)]
"""Turns of the camera from one viewpoint to the next: about what is up, and above."""


def animated(name):
    scene = load_scene(name)
    return page(
        animation_of(scene, lambda s: job_of(s, "auto", ()).integrate(lambda _: None), seconds=1.0)
    )


def drawn(name):
    return turned.page(gallery.picture("sketch", gallery.Ask(load_scene(name))))


def polhodes(name):
    return turned.page(gallery.picture("polhodes", gallery.Ask(load_scene(name))))


HIDDEN = "#show input:not(:checked), [data-show]:not(:checked)"
ALL_SHOWN = f"document.querySelectorAll({HIDDEN!r}).forEach((input) => input.click())"
"""Show all vectors and frames."""
PAGES = {
    "animation": (animated, "animation.viewer"),
    "live": (text_of, "eomLive.viewer"),
    "sketch": (drawn, "picture[0].viewer"),
    "polhodes": (polhodes, "picture[0].viewer"),
}


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield found
        found.close()


def boxes(words):
    """Text, middle and half size of each word: the room round letters is no part of it."""
    return [(w["text"], w["x"], w["y"], (w["size"][0] - 8) / 2, w["size"][1] / 3.4) for w in words]


def overlapping(found):
    return [
        (a[0], b[0])
        for a, b in itertools.combinations(found, 2)
        if abs(a[1] - b[1]) < a[3] + b[3] - 0.5 and abs(a[2] - b[2]) < a[4] + b[4] - 0.5
    ]


slow = pytest.mark.slow


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        ("animation", "heavy-top"),
        ("sketch", "quadrotor"),
        pytest.param("animation", "walking-leg", marks=slow),
        pytest.param("animation", "whipple-bicycle", marks=slow),
        pytest.param("sketch", "satellite-with-panels", marks=slow),
        pytest.param("polhodes", "t-handle", marks=slow),
        pytest.param("live", "t-handle", marks=slow),
        pytest.param("live", "floating-tree", marks=slow),
        pytest.param("live", "seven-joint-arm", marks=slow),
    ],
)
def test_words_overlap_at_no_viewpoint(browser, tmp_path, kind, name):
    make, viewer = PAGES[kind]
    file = tmp_path / "page.html"
    file.write_text(make(name), encoding="utf-8")
    tab = browser.new_page(viewport={"width": 900, "height": 600}, reduced_motion="reduce")
    tab.set_default_timeout(120_000)  # software draws, on a busy machine slowly
    heard = []
    tab.on("pageerror", lambda e: heard.append(str(e)))
    tab.goto(file.as_uri())
    tab.evaluate(ALL_SHOWN)
    wide, high = (tab.evaluate(f"{viewer}.canvas.client{side}") for side in ("Width", "Height"))
    moved, counts = 0, set()
    for azimuth, elevation in VIEWS:
        tab.evaluate(f"{viewer}.orbit({azimuth}, {elevation})")
        words = tab.evaluate(f"{viewer}.words()")
        found = boxes(words)
        assert overlapping(found) == []
        free = [b for b, w in zip(found, words, strict=True) if w["rank"] > 1]
        assert all(b[3] <= b[1] <= wide - b[3] and b[4] <= b[2] <= high - b[4] for b in free)
        moved += sum(w["moved"] for w in words)
        counts.add(len(words))
    assert max(counts) > 3
    assert moved  # without moving them they would overlap
    assert heard == []
    tab.close()


def test_a_label_stays_while_the_view_turns_by_little(browser, tmp_path):
    file = tmp_path / "page.html"
    file.write_text(drawn("quadrotor"), encoding="utf-8")
    tab = browser.new_page(viewport={"width": 900, "height": 600})
    tab.goto(file.as_uri())
    before = {w["text"]: (w["x"], w["y"]) for w in tab.evaluate("picture[0].viewer.words()")}
    jumps = 0
    for _ in range(20):
        tab.evaluate("picture[0].viewer.orbit(0.01, 0)")
        after = {w["text"]: (w["x"], w["y"]) for w in tab.evaluate("picture[0].viewer.words()")}
        jumps += sum(
            abs(after[t][0] - x) + abs(after[t][1] - y) > 20
            for t, (x, y) in before.items()
            if t in after
        )
        before = after
    assert jumps <= len(before)  # in 0.2 radians about one a label at most; each frame would be 20
    tab.close()
