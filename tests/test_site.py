"""The documentation site: it builds without a warning, its links lead somewhere, it fetches nothing."""

import os
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

import codegen
import eom
import eom.exercises
import eom.multibody
from eom.__main__ import COMMANDS
from eom.scenes.conventions import BOOKS
from tests.public import public

for needed in ("sphinx", "myst_nb", "furo"):
    pytest.importorskip(needed)

ROOT = Path(__file__).parents[1]
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
QUIET = (
    "--no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync"
).split()
TABLES = {"eom.views.gallery.PICTURES", "eom.views.draw.picture.COLOURS"}
"""Constants that pages speak of, and need not list."""
pytestmark = pytest.mark.xdist_group("site")  # one worker builds it


def _build(site):
    """Build from a copy of the sources: what is generated beside them stays out of the checkout."""
    sources = site.with_name("checkout")
    for name in ("docs", "notebooks"):
        shutil.copytree(ROOT / name, sources / name, ignore=shutil.ignore_patterns("_build"))
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-n", "-q"]
    done = subprocess.run(
        [*command, str(sources / "docs"), str(site)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT), "MPLBACKEND": "agg"},
    )
    assert done.stderr == ""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The built site."""
    site = tmp_path_factory.mktemp("documentation") / "site"
    _build(site)
    return site


class _Page(HTMLParser):
    """What a page links to, loads, and offers as places."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loads, self.places = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.places |= {given[name] for name in ("id", "name") if given.get(name)}
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        if tag in {"script", "img", "iframe", "source"} and given.get("src"):
            self.loads.append(given["src"])
        if tag == "link" and given.get("rel") not in {
            "next",
            "prev",
            "index",
            "search",
            "canonical",
        }:
            self.loads.append(given["href"])


@pytest.fixture(scope="module")
def pages(site):
    found = (path for path in sorted(site.rglob("*.html")) if path.parent.name != "made")
    return {path: _Page(path.read_text(encoding="utf-8")) for path in found}


def test_every_link_inside_the_site_leads_to_a_page_and_a_place(pages):
    broken, followed = [], 0
    for path, page in pages.items():
        for link in page.links + page.loads:
            parts = urlsplit(link)
            if parts.scheme:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            known = pages.get(target)
            followed += 1
            if not target.is_file() or (
                known and parts.fragment and unquote(parts.fragment) not in known.places
            ):
                broken.append(f"{path.name}: {link}")
    assert not broken
    assert followed > 1000


def test_pages_load_nothing_from_elsewhere(site, pages):
    assert not [
        load
        for page in pages.values()
        for load in page.loads
        if urlsplit(load).scheme or load.startswith("//")
    ]
    styles = "".join(path.read_text(encoding="utf-8") for path in site.rglob("*.css"))
    assert not re.findall(r"(?:url\(|@import)\s*['\"]?(?:https?:)?//[^)]*", styles)


def test_every_public_name_every_command_and_every_book_is_there(pages):
    places = {place for page in pages.values() for place in page.places}
    modules = (eom, codegen, eom.exercises, eom.multibody)
    names = {f"{m.__name__}.{name}" for m in modules for name in m.__all__}
    names |= {name for name in public() if name.startswith("eom.views.")}
    constants = {"eom.__version__", "eom.multibody.GROUND", *TABLES}
    assert sorted(names - constants - places) == []
    assert [c.name for c in COMMANDS if f"eom-{c.name}" not in places] == []
    (conventions,) = (
        path for path in pages if path.parts[-2:] == ("explanation", "conventions.html")
    )
    text = conventions.read_text(encoding="utf-8")
    assert [
        name for name in BOOKS if f">{name}</span>" not in text and f">{name}<" not in text
    ] == []


def test_formulas_are_drawn_without_a_script(pages):
    text = "".join(path.read_text(encoding="utf-8") for path in pages)
    assert text.count("<math") > 100
    assert not [load for page in pages.values() for load in page.loads if "jax" in load.lower()]


@pytest.fixture(scope="module")
def browser():
    if CHROMIUM is None:
        pytest.skip("no Chromium")
    driver = pytest.importorskip("playwright.sync_api")
    with driver.sync_playwright() as running:
        found = running.chromium.launch(executable_path=CHROMIUM, args=QUIET)
        yield found
        found.close()


@pytest.fixture(
    params=[
        ("explanation/conventions", "light", 1280),
        ("howto/methods", "dark", 360),
        ("reference/integrating", "light", 360),
        ("notebooks/lecture-001-spinning-body", "dark", 1280),
    ],
    ids=lambda p: f"{Path(p[0]).name} {p[1]} {p[2]}",
)
def shown(request, browser, site):
    name, scheme, width = request.param
    tab = browser.new_page(color_scheme=scheme, viewport={"width": width, "height": 800})
    tab.heard = []
    tab.on("console", lambda m: tab.heard.append(m.text))
    tab.on("pageerror", lambda e: tab.heard.append(str(e)))
    tab.on("request", lambda r: None if r.url.startswith("file:") else tab.heard.append(r.url))
    tab.goto((site / f"{name}.html").as_uri())
    yield tab
    tab.close()


def test_pages_ask_for_nothing_say_nothing_and_fit_the_screen(shown):
    assert shown.heard == []
    assert shown.evaluate("document.documentElement.scrollWidth") <= shown.viewport_size["width"]
    assert shown.evaluate("document.querySelector('h1').getBoundingClientRect().height") > 0


def test_the_accessibility_checker_finds_nothing(shown):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    found = axe.Axe().run(shown).response["violations"]
    assert [(v["id"], v["impact"], v["nodes"][0]["html"][:200]) for v in found] == []
