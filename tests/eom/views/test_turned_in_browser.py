"""The page with a picture to turn by hand in Chromium: it draws, turns, asks for nothing, by themes."""

from __future__ import annotations

import shutil

import pytest

from eom.views.body.free import FreeBody
from eom.views.body.polhodes import ellipsoids
from eom.views.draw.saving import save

sync_api = pytest.importorskip("playwright.sync_api")
axe = pytest.importorskip("axe_playwright_python.sync_playwright")
pytest.importorskip("plotly")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")]
SOFTWARE = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
DRAWN = "document.querySelectorAll('#picture .main-svg').length > 0"


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
    found.wait_for_function("document.querySelector('#picture canvas') !== null")
    yield found
    found.close()


def test_it_draws_turns_and_asks_for_nothing(tab, path):
    eye = "JSON.stringify(document.getElementById('picture')._fullLayout.scene._scene.getCamera().eye)"
    tab.wait_for_function("!!document.getElementById('picture')._fullLayout.scene._scene")
    before = tab.evaluate(eye)
    box = tab.locator("#picture").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    tab.mouse.move(x, y)
    tab.mouse.down()
    tab.mouse.move(x + 120, y + 20, steps=6)
    tab.mouse.up()
    tab.wait_for_function(f"{eye} !== '{before}'")
    assert tab.heard == [path.as_uri()]
    assert tab.title() == "<b>Own</b> & $x"
    assert "<b>Own</b> & $x" in tab.locator("#picture .gtitle").first.text_content()


def test_it_follows_the_theme_and_can_be_read_aloud(tab):
    colour = "document.getElementById('picture')._fullLayout.paper_bgcolor"
    assert tab.evaluate(colour) == {"light": "#ffffff", "dark": "#14171c"}[tab.scheme]
    found = axe.Axe().run(tab).response["violations"]
    assert [(v["id"], v["nodes"][0]["html"]) for v in found] == []
