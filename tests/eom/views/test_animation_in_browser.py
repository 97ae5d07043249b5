"""The page of an animation in Chromium: it plays, obeys, asks for nothing, and can be used by key."""

import shutil

import pytest

from eom.commands.simulating import job_of
from eom.scenes.scene import Scene
from eom.views.animation.animation import animation_of
from eom.views.animation.animation_page import page

sync_api = pytest.importorskip("playwright.sync_api")
axe = pytest.importorskip("axe_playwright_python.sync_playwright")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")

ARGUMENTS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]
SCENE = Scene(
    name="tumbling",
    title="Tumbling <b>plate</b> & $x$",
    description="A plate that tumbles.",
    body={"moments": (1.0, 2.0, 2.5)},
    torque={"components": (0.1, 0, 0)},
    initial={"omega_1": 0.4, "omega_2": 1.0, "omega_3": 0.5},
    integration={"t_end": 4.0},
)
STOPPED = "document.getElementById('play').textContent === 'Play'"
TIME = "Number(document.getElementById('time').value)"
FRAMES = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield found
        found.close()


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    def integrate(scene):
        return job_of(scene, "numpy", ()).integrate(lambda _: None)

    file = tmp_path_factory.mktemp("page") / "tumbling.html"
    file.write_text(page(animation_of(SCENE, integrate)), encoding="utf-8")
    return file


def opened(browser, path, **settings):
    tab = browser.new_page(**{"viewport": {"width": 640, "height": 420}, **settings})
    tab.heard = []
    tab.on("console", lambda m: m.type in {"error", "warning"} and tab.heard.append(m.text))
    tab.on("pageerror", lambda e: tab.heard.append(str(e)))
    tab.on("request", lambda r: tab.heard.append(r.url))
    tab.goto(path.as_uri())
    return tab


def said(tab):
    """What the page has said, but for the driver's remark that a screenshot takes time."""
    return [text for text in tab.heard if "GPU stall" not in text]


def seen(tab):
    """The view after what was asked for has been drawn."""
    tab.evaluate(FRAMES)
    return tab.locator("#view").screenshot()


def played_to(tab, place):
    """Wait until the slider is beyond a place; scripts in text are forbidden by the page."""
    for _ in range(1000):
        if tab.evaluate(TIME) > place:
            return
        tab.evaluate(FRAMES)
    pytest.fail("it does not play")


@pytest.fixture(scope="module")
def still(browser, path):
    """For a reader who wants little motion: dark, narrow."""
    size = {"width": 380, "height": 640}
    tab = opened(browser, path, viewport=size, color_scheme="dark", reduced_motion="reduce")
    yield tab
    tab.close()


@pytest.mark.slow
def test_it_plays_by_itself_asks_for_nothing_and_says_nothing(browser, path):
    tab = opened(browser, path)
    first = seen(tab)
    played_to(tab, 20)
    assert seen(tab) != first
    tab.locator("#play").click()
    assert tab.evaluate(STOPPED)
    assert seen(tab) == seen(tab)
    assert said(tab) == [path.as_uri()]
    assert tab.title() == SCENE.title
    assert tab.evaluate("document.documentElement.scrollWidth") <= 640
    tab.close()


@pytest.mark.slow
def test_with_reduced_motion_it_waits(still):
    assert still.evaluate(STOPPED)
    assert still.evaluate(TIME) == 0
    assert still.evaluate("document.documentElement.scrollWidth") <= 380
    assert said(still) == [still.url]


@pytest.mark.slow
def test_the_slider_acts_and_values_follow(still):
    before, value = seen(still), still.locator("#readouts tr:nth-child(5) td").first
    shown = value.text_content()
    still.locator("#time").focus()
    still.keyboard.press("End")
    assert seen(still) != before
    assert value.text_content() != shown
    assert still.locator("#time").get_attribute("aria-valuetext") == "4.000 seconds"
    assert "4.000" in still.locator("#status").text_content()
    still.keyboard.press("Home")
    assert seen(still) == before


@pytest.mark.slow
def test_keys_step_show_and_turn(still):
    still.locator("#view").focus()
    before = seen(still)
    still.keyboard.press(".")
    assert 0 < still.evaluate(TIME) < 10
    assert seen(still) != before
    still.keyboard.press(",")
    assert seen(still) == before
    for key in ("v", "t", "b", "s"):
        shown = seen(still)
        still.keyboard.press(key)
        assert (seen(still) != shown) or key == "t"  # there is no path at the start
        still.keyboard.press(key)
    assert seen(still) == before
    still.keyboard.press("ArrowLeft")
    assert seen(still) != before
    still.keyboard.press("0")
    assert seen(still) == before
    still.keyboard.press("]")
    assert still.locator("#speed").evaluate("e => e.selectedOptions[0].textContent") == "2×"
    still.keyboard.press("d")
    assert still.evaluate("document.documentElement.dataset.theme") == "light"
    still.keyboard.press("d")
    still.keyboard.press(" ")
    assert not still.evaluate(STOPPED)
    played_to(still, 5)
    still.keyboard.press(" ")
    assert still.evaluate(STOPPED)


@pytest.mark.slow
@pytest.mark.parametrize("theme", ["dark", "light"])
def test_the_accessibility_checker_finds_nothing(still, theme):
    for details in still.locator("details").all():
        details.evaluate("e => { e.open = true; }")
    if still.evaluate("document.documentElement.dataset.theme") != theme:
        still.locator("#theme").click()
    found = axe.Axe().run(still).response["violations"]
    assert [(v["id"], v["nodes"][0]["html"]) for v in found] == []
    assert said(still) == [still.url]
