"""Live pages in Chromium: they draw and move, what is changed acts, and they can be used by key."""

import shutil

import pytest

from tests.eom.views.live_pages import BOUND, text_of

sync_api = pytest.importorskip("playwright.sync_api")
axe = pytest.importorskip("axe_playwright_python.sync_playwright")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")]

FLAGS = (
    "--no-sandbox --disable-gpu --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader "
    "--no-first-run --disable-background-networking --disable-component-update --disable-sync"
).split()
MOVE = """(frames) => {
  for (let k = 0; k < frames; k += 1) eomLive.move(1 / 60);
  eomLive.draw();
  eomLive.tellNumbers();
}"""
PIXELS = """(id) => {
  eomLive.draw();
  const from = document.getElementById(id), to = document.createElement("canvas");
  [to.width, to.height] = [60, 60];
  const pen = to.getContext("2d");
  pen.drawImage(from, 0, 0, 60, 60);
  return Array.from(pen.getImageData(0, 0, 60, 60).data);
}"""


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield found
        found.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("live")


def opened(browser, folder, name, **options):
    """A tab with a page, which stands still, and what it said and asked for."""
    file = folder / f"{name}.html"
    file.write_text(text_of(name), encoding="utf-8")
    tab = browser.new_page(reduced_motion="reduce", **options)
    tab.heard = []
    tab.on(
        "console",
        lambda m: (
            m.type in {"error", "warning"}
            and "GPU stall" not in m.text
            and tab.heard.append(m.text)
        ),
    )
    tab.on("pageerror", lambda e: tab.heard.append(str(e)))
    tab.on("request", lambda r: tab.heard.append(r.url))
    tab.goto(file.as_uri())
    assert tab.heard == [file.as_uri()]
    tab.heard.clear()
    return tab


@pytest.fixture(scope="module")
def handle(browser, folder):
    tab = opened(browser, folder, "t-handle", viewport={"width": 1000, "height": 700})
    yield tab
    assert tab.heard == []
    tab.close()


@pytest.fixture(autouse=True)
def fresh(request):
    """The page of the handle with the scene's numbers."""
    if "handle" in request.fixturenames:
        request.getfixturevalue("handle").click("#original")


def shown(tab, selector):
    return tab.locator(selector).inner_text()


def test_pictures_move_and_reduced_motion_waits_for_a_key(handle):
    assert shown(handle, "#play") == "Play"
    assert handle.evaluate("eomLive.motion.time") == 0
    before = {name: handle.evaluate(PIXELS, name) for name in ("body", "poinsot")}
    handle.evaluate(MOVE, 12)
    assert handle.evaluate("eomLive.motion.time") == pytest.approx(0.2)
    assert shown(handle, "#time") == "0.20 s"
    for name, pixels in before.items():
        assert len(set(pixels)) > 10, name
        assert handle.evaluate(PIXELS, name) != pixels, name
    handle.focus("#play")
    handle.keyboard.press("Enter")
    handle.wait_for_function("eomLive.motion.time > 0.2")
    handle.keyboard.press("Enter")
    assert shown(handle, "#play") == "Play"


def test_sliders_and_fields_act_and_say_what_cannot_be(handle):
    end = """() => {
      eomLive.motion.restart();
      eomLive.motion.advance(1);
      return Array.from(eomLive.motion.states);
    }"""
    before = handle.evaluate(end)
    slider = handle.locator("#knob-omega_3")
    slider.focus()
    handle.keyboard.press("ArrowRight")
    value = handle.evaluate("eomLive.motion.values.get('omega_3')")
    assert value > 0.05
    assert float(handle.locator("[type=number][data-knob=omega_3]").input_value()) == value
    after = handle.evaluate(end)
    assert max(abs(a - b) for a, b in zip(after, before, strict=True)) > 1e-3
    handle.locator("[type=number][data-knob=I3]").fill("0.001")
    assert "exceeds I1 + I2 = 0.00055 (triangle inequality)" in shown(handle, "#fault")
    handle.locator("[type=number][data-knob=I3]").fill("0.0005")
    assert not handle.locator("#fault").is_visible()
    assert handle.evaluate("eomLive.motion.value('I3')") == 0.0005


def test_switches_change_equations_numbers_and_pictures(handle):
    assert shown(handle, "#operations") == "18"
    rates = shown(handle, "#components")
    assert handle.locator("#poinsot-figure").is_visible()
    assert handle.locator("#knob-tau_1").is_disabled()
    handle.get_by_label("symmetric").check()
    assert shown(handle, "#operations") == "11"
    assert shown(handle, "#components") != rates
    assert handle.locator("#knob-I2").is_disabled()
    assert handle.evaluate("eomLive.motion.names.STATES.length") == 6
    handle.get_by_label("no torque").uncheck()
    assert not handle.locator("#poinsot-figure").is_visible()
    assert handle.locator("#knob-tau_1").is_enabled()
    assert shown(handle, "#operations") == "15"
    handle.click("#original")
    assert shown(handle, "#components") == rates
    assert handle.locator("#poinsot-figure").is_visible()


def test_the_law_of_motion_is_written_in_the_chosen_notation(handle):
    found = set()
    for name in ("arrow", "superscript", "underline", "kane"):
        handle.select_option("#notation", name)
        found.add(handle.locator("#statements").inner_html())
    assert len(found) == 4
    assert all("<math>" in text for text in found)


def test_drift_is_shown_as_numbers_and_as_a_curve(handle):
    handle.evaluate(MOVE, 60)
    rows = handle.locator("#invariants tr")
    assert rows.count() == 6
    drifts = [float(rows.nth(k).locator("td").nth(1).inner_text()) for k in range(6)]
    assert max(drifts) < 1e-10
    assert len(set(handle.evaluate(PIXELS, "drift"))) > 10


def test_the_picture_is_turned_by_keys(handle):
    before = handle.evaluate(PIXELS, "body")
    handle.focus("#body")
    for _ in range(6):
        handle.keyboard.press("ArrowLeft")
    assert handle.evaluate(PIXELS, "body") != before


@pytest.mark.parametrize(
    ("name", "scheme", "width"),
    [("lecture-wheel", "light", 1300), ("double-pendulum", "dark", 380)],
)
def test_other_pages_fit_the_screen_and_the_accessibility_checker_finds_nothing(
    browser, folder, name, scheme, width
):
    tab = opened(
        browser, folder, name, color_scheme=scheme, viewport={"width": width, "height": 800}
    )
    tab.evaluate(MOVE, 6)
    assert tab.evaluate("document.documentElement.scrollWidth") <= width
    found = axe.Axe().run(tab).response["violations"]
    assert [(v["id"], v["nodes"][0]["html"]) for v in found] == []
    assert len(set(tab.evaluate(PIXELS, "body"))) > 10
    assert tab.heard == []
    tab.close()


@pytest.mark.parametrize("name", BOUND)
def test_scenes_under_constraints_are_drawn_and_say_what_is_left(browser, folder, name):
    tab = opened(browser, folder, name, viewport={"width": 1200, "height": 800})
    before = tab.evaluate(PIXELS, "body")
    assert len(set(before)) > 10
    tab.evaluate(MOVE, 40)
    assert tab.evaluate(PIXELS, "body") != before
    rows = tab.locator("#constraints tr")
    assert rows.count() == tab.evaluate("eomLive.motion.variant.held.length") > 0
    left = [float(rows.nth(k).locator("td").inner_text()) for k in range(rows.count())]
    assert max(left) < 1e-12
    constants = tab.locator("#invariants tr").count()
    assert constants == tab.evaluate("eomLive.motion.names.INVARIANTS.length") - rows.count()
    found = axe.Axe().run(tab).response["violations"]
    assert [(v["id"], v["nodes"][0]["html"]) for v in found] == []
    assert tab.heard == []
    tab.close()


def test_sliders_of_a_linkage_move_together_and_say_where_it_cannot_be(browser, folder):
    tab = opened(browser, folder, "four-bar-linkage")
    rocker = "[type=number][data-knob=q_rocker]"
    before = tab.locator(rocker).input_value()
    tab.locator("[type=number][data-knob=q_crank]").fill("0.8")
    assert tab.locator(rocker).input_value() != before
    assert tab.evaluate("Math.abs(eomLive.motion.left()[0].left)") < 1e-13
    tab.locator("[type=number][data-knob=d]").fill("5")
    assert "No configuration near these numbers meets the constraints" in shown(tab, "#fault")
    tab.locator("[type=number][data-knob=d]").fill("1.1")
    assert not tab.locator("#fault").is_visible()
    tab.click("#original")
    assert tab.locator(rocker).input_value() == before
    assert tab.heard == []
    tab.close()


def test_the_accessibility_checker_finds_nothing_on_the_free_body(handle):
    found = axe.Axe().run(handle).response["violations"]
    assert [(v["id"], v["nodes"][0]["html"]) for v in found] == []
