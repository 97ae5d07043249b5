"""The page with a picture to turn by hand in Chromium: it draws, turns, asks for nothing, by themes."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from eom.views.body.free import FreeBody
from eom.views.body.polhodes import ellipsoids
from eom.views.draw.picture import Axis, Curve, Panel, Picture
from eom.views.draw.saving import save

sync_api = pytest.importorskip("playwright.sync_api")
axe = pytest.importorskip("axe_playwright_python.sync_playwright")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")]
SOFTWARE = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
DRAWN = "window.picture !== undefined && document.querySelector('#picture canvas') !== null"


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as driver:
        found = driver.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu", *SOFTWARE]
        )
        yield found
        found.close()


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    body = FreeBody((1.0, 2.0, 2.5), (0.3, 1.0, 0.5), title="<b>Own</b> & $x")
    return save(ellipsoids(body), tmp_path_factory.mktemp("turned") / "page.html")


@pytest.fixture(scope="module", params=["light", "dark"])
def tab(request, browser, path):
    found = browser.new_page(color_scheme=request.param, viewport={"width": 700, "height": 600})
    found.scheme, found.heard = request.param, []
    found.on("console", lambda m: found.heard.append(m.text) if m.type == "error" else None)
    found.on("pageerror", lambda e: found.heard.append(str(e)))
    found.on("request", lambda r: found.heard.append(r.url))
    found.goto(path.as_uri())
    found.wait_for_function(DRAWN)
    yield found
    found.close()


def test_it_draws_turns_and_asks_for_nothing(tab, path):
    canvas = tab.locator("#picture canvas").first
    before = canvas.screenshot()
    box = canvas.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    tab.mouse.move(x, y)
    tab.mouse.down()
    tab.mouse.move(x + 120, y + 20, steps=6)
    tab.mouse.up()
    dragged = canvas.screenshot()
    assert dragged != before
    canvas.focus()
    tab.keyboard.press("ArrowLeft")
    assert canvas.screenshot() != dragged
    assert tab.heard == [path.as_uri()]
    assert tab.title() == "<b>Own</b> & $x"
    assert "<b>Own</b> & $x" in tab.locator("h1").text_content()


def test_it_fills_the_window_and_names_of_axes_are_clear_of_numbers(tab):
    tab.locator("#picture canvas").first.focus()
    tab.keyboard.press("0")
    tab.evaluate("new Promise(requestAnimationFrame)")
    assert 560 < tab.evaluate("document.querySelector('main').offsetHeight") <= 600
    words = tab.evaluate("picture[0].viewer.words()")
    assert sum("rad/s" in word["text"] for word in words) == 3
    wide, high = (tab.evaluate(f"picture[0].element.client{side}") for side in ("Width", "Height"))
    boxes = [(w["text"], w["x"], w["y"], w["size"][0] - 8, w["size"][1] / 1.7) for w in words]
    assert [
        b[0] for b in boxes if not (b[3] / 2 < b[1] < wide - b[3] / 2 and b[4] / 2 < b[2] < high)
    ] == []
    names = [b for b in boxes if "rad/s" in b[0]]
    assert [
        (name[0], other[0])
        for name in names
        for other in boxes
        if other is not name
        and abs(name[1] - other[1]) < (name[3] + other[3]) / 2
        and abs(name[2] - other[2]) < (name[4] + other[4]) / 2
    ] == []


def test_a_click_in_the_legend_hides_and_shows(tab):
    button = tab.locator(".legend button").first
    canvas = tab.locator("#picture canvas").first
    before = canvas.screenshot()
    button.click()
    assert button.get_attribute("aria-pressed") == "false"
    assert canvas.screenshot() != before
    button.click()
    assert button.get_attribute("aria-pressed") == "true"


def test_it_follows_the_theme_and_can_be_read_aloud(tab):
    colour = tab.evaluate("getComputedStyle(document.body).backgroundColor")
    assert colour == {"light": "rgb(255, 255, 255)", "dark": "rgb(20, 23, 28)"}[tab.scheme]
    found = axe.Axe().run(tab).response["violations"]
    assert [(v["id"], v["nodes"][0]["html"]) for v in found] == []


def test_a_plane_gives_values_under_the_pointer_and_zooms_into_a_box(browser, tmp_path):
    t = np.linspace(0.0, 4.0, 401)
    curve = Curve(np.column_stack([t, t * t]), label="square")
    panel = Panel((curve,), (Axis("t [s]", limits=(0.0, 4.0)), Axis("x [m]", limits=(0.0, 16.0))))
    path = save(Picture(((panel,),), "Square"), tmp_path / "square.html")
    tab = browser.new_page(viewport={"width": 700, "height": 500})
    tab.goto(path.as_uri())
    svg = tab.locator("#picture svg").first.bounding_box()
    frame = {
        k: float(tab.locator(".frame").get_attribute(k)) for k in ("x", "y", "width", "height")
    }

    def pointer(t, x):
        return (
            svg["x"] + frame["x"] + frame["width"] * t / 4,
            svg["y"] + frame["y"] + frame["height"] * (1 - x / 16),
        )

    tab.mouse.move(*pointer(2.0, 4.0))
    assert "t [s]: 2" in tab.locator(".tip").text_content()
    assert "x [m]: 4" in tab.locator(".tip").text_content()
    tab.mouse.move(*pointer(1.0, 9.0))
    tab.mouse.down()
    tab.mouse.move(*pointer(3.0, 1.0), steps=3)
    tab.mouse.up()
    across, upwards = tab.evaluate("picture[0].ranges()")
    assert across == pytest.approx([1.0, 3.0], abs=0.02)
    assert upwards == pytest.approx([1.0, 9.0], abs=0.1)
    tab.mouse.dblclick(*pointer(2.0, 4.0))
    assert tab.evaluate("picture[0].ranges()") == [[0, 4], [0, 16]]
    tab.close()
