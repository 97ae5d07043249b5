"""`eom plot` from the command line: files, defaults, lists, errors."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET

import pytest
from click.testing import CliRunner

from eom.__main__ import main
from eom.views.draw import printed as extras
from eom.views.gallery import PICTURES

pytest.importorskip("matplotlib")


@pytest.fixture
def plot(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(main, ["plot", *words])


def test_without_options_a_picture_that_suits_the_scene(plot, tmp_path):
    run = plot("t-handle", "--dpi", "30")
    assert run.exit_code == 0, run.output
    (file,) = tmp_path.iterdir()
    assert file.name == "t-handle-polhodes.png"
    assert f"wrote {file.name}" in run.output


def test_a_body_in_numbers_as_page_and_as_lines(plot, tmp_path):
    body = ("--moments", "1,2,5/2", "--omega", "0.1,2,0.1")
    assert plot(*body, "--what", "ellipsoids", "--out", "a/b.svg").exit_code == 0
    words = " ".join(ET.parse(tmp_path / "a/b.svg").getroot().itertext())
    assert "Torque-free body" in words
    assert plot(*body, "--what", "ellipsoids,cones", "--out", "c.html").exit_code == 0
    page = (tmp_path / "c.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])
    assert [len(panel["axes"]) for row in data["rows"] for panel in row] == [3, 3]
    library = page[page.index("<script>") : page.index("</script>", page.index("<script>"))]
    assert "https://" not in page.replace(library, "")
    assert len(page) < 2_000_000


def test_a_scene_with_a_hostile_title(plot, tmp_path):
    title = "</script><b>$x_{$ & 100 %"
    (tmp_path / "own.toml").write_text(
        f"title = '{title}'\n[body]\nmoments = [1, 2, 2.5]\n"
        "[initial]\nomega_1 = 0.1\nomega_2 = 1.0\nomega_3 = 0.3\n"
    )
    assert plot("own.toml", "--what", "ellipsoids", "--out", "a.html").exit_code == 0
    page = (tmp_path / "a.html").read_text(encoding="utf-8")
    assert "<title>&lt;/script&gt;&lt;b&gt;$x_{$ &amp; 100 %</title>" in page
    run = plot("own.toml", "--what", "ellipsoids", "--size", "3x2.5")
    assert run.exit_code == 0, run.output
    assert (tmp_path / "own-ellipsoids.png").exists()


def test_lists(plot):
    everything = plot("--list")
    assert everything.exit_code == 0
    assert [line.split()[0] for line in everything.output.splitlines()] == list(PICTURES)
    some = plot("heavy-top", "--list").output
    assert "sphere" in some
    assert "polhodes" not in some
    assert all(name in plot("--help").output for name in PICTURES)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "one body is needed"),
        (("t-handle", "--moments", "1,2,3"), "one body is needed"),
        (("--moments", "1,2", "--omega", "1,2,3"), "three numbers"),
        (("--moments", "1,2,2.5"), "three numbers"),
        (("--moments", "1,2,2.5", "--omega", "0,0,0"), "at rest"),
        (("--moments", "1,2,4", "--omega", "0,1,0"), "exceeds"),
        (("t-handle", "--out", "a.gif"), "unknown kind of picture"),
        (("t-handle", "--what", "polhode"), "did you mean polhodes"),
        (("heavy-top", "--what", "polhodes"), "a weight turns it"),
        (("t-handle", "--size", "4"), "as 6x4"),
        (("t-handle", "--size", "1000x4"), "size cannot be drawn"),
        (("t-handle", "--seconds", "-1"), "no time to draw"),
        (("t-handle", "--seconds", "nan"), "no time to draw"),
        (("t-handle", "--dpi", "1"), "pixels an inch"),
        (("nobody",), "nobody"),
    ],
)
def test_unusable_input(plot, tmp_path, words, message):
    run = plot(*words)
    assert run.exit_code == 2
    assert message in run.output
    assert not list(tmp_path.iterdir())


def test_a_missing_extra_is_named_before_any_work(plot, tmp_path, monkeypatch):
    monkeypatch.setattr(extras.importlib.util, "find_spec", lambda name: None)
    run = plot("t-handle")
    assert run.exit_code == 2
    assert "pip install 'eom-toolkit[plot]'" in run.output
    assert not list(tmp_path.iterdir())
    assert plot("t-handle", "--out", "a.html").exit_code == 0  # a page needs none
