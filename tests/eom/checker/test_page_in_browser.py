"""The report page in Chromium: it draws, asks for nothing, and can be used by key and screen reader."""

import shutil

import pytest

from eom.checker.read.documents import read_document
from eom.checker.report.findings import Correction, Explanation
from eom.checker.report.page import page
from tests.eom.checker.test_page import NOTE, report_on, term

sync_api = pytest.importorskip("playwright.sync_api")
axe = pytest.importorskip("axe_playwright_python.sync_playwright")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")]

WIDE = r"$$ " + " + ".join(rf"\ddot\theta_{{{k}}}\sin\theta_{{{k}}}" for k in range(40)) + " = 0 $$"


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    document = read_document(f"{NOTE}\n\n{WIDE}\n")
    blamed = (term(document, r"\vec c"),)
    wide = WIDE.strip("$ ")
    words = f"dropped: ${wide}$"
    explanation = Explanation(wide, blamed, (Correction(r"\vec H = I\vec\omega", words, "x"),))
    file = tmp_path_factory.mktemp("page") / "note.html"
    file.write_text(page(document, report_on(document, explanation=explanation)), encoding="utf-8")
    return file


@pytest.fixture(params=[("light", 1000), ("dark", 360)], ids=["light desk", "dark phone"])
def shown(request, browser, path):
    scheme, width = request.param
    tab = browser.new_page(color_scheme=scheme, viewport={"width": width, "height": 800})
    tab.heard = []
    tab.on("console", lambda m: tab.heard.append(m.text))
    tab.on("pageerror", lambda e: tab.heard.append(str(e)))
    tab.on("request", lambda r: tab.heard.append(r.url))
    tab.goto(path.as_uri())
    yield tab
    tab.close()


def test_it_asks_for_nothing_says_nothing_and_fits_the_screen(shown, path):
    assert shown.heard == [path.as_uri()]
    assert shown.evaluate("document.documentElement.scrollWidth") <= shown.viewport_size["width"]


def test_the_accessibility_checker_finds_nothing(shown):
    found = axe.Axe().run(shown).response["violations"]
    assert [(v["id"], v["nodes"][0]["html"]) for v in found] == []


def test_the_term_at_fault_has_another_colour(shown):
    colour = "e => getComputedStyle(e).color"
    blamed = shown.locator("main .display mrow.blamed").first
    assert blamed.evaluate(colour) != shown.locator("main math").first.evaluate(colour)
    assert blamed.bounding_box()["width"] > 0


def test_details_open_by_key_and_cards_can_be_filtered(shown):
    summary = shown.locator(".card.bad summary").first
    opened = "e => e.parentElement.open"
    before = summary.evaluate(opened)
    summary.focus()
    shown.keyboard.press("Enter")
    assert summary.evaluate(opened) != before
    good = shown.locator(".card.good").first
    assert good.is_visible()
    shown.locator("#only-bad").check()
    assert not good.is_visible()
    assert shown.locator(".card.bad").first.is_visible()


def test_the_list_on_top_leads_to_the_line(shown):
    shown.locator("nav a").first.press("Enter")
    top = shown.locator(".card.bad").first.bounding_box()["y"]
    assert -1 < top < shown.viewport_size["height"]
