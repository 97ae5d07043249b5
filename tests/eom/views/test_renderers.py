"""Pictures in both renderers: the same bytes, hostile words, what is hidden, errors."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from eom import InputError
from eom.views.draw import formulas, printed, saving, turned
from eom.views.draw import printed as extras
from eom.views.draw.depth import cut, in_space, runs
from eom.views.draw.meshes import ellipsoid, tip
from eom.views.draw.picture import Arrow, Axis, Curve, Marks, Panel, Picture, Surface, Words, points
from eom.views.draw.saving import save
from tests.draws import examples

pytest.importorskip("matplotlib")

HOSTILE = [
    "</script><script>alert(1)</script>",
    "<img src=x onerror=alert(1)> & \"quotes\" 'single'",
    r"$ \frac{1}{$ 100 % \alpha {",
    r"$\notacommand{x}$ and $\frac$",
    r"\$5 and \\$6",
    "control \x00\x07 characters, lone \ud800 surrogate",
    "{0} %s {title} \\u003c",
    "日本語 \U0001f600",
]
ZERO3 = np.zeros(3)


def sample(title="Title", label="path"):
    """Two panels with every kind of item, in space and in a plane."""
    s = np.linspace(0, 2 * np.pi, 30)
    ring = points(np.cos(s), np.sin(s), 0 * s)
    broken = points(s, np.where(s > 3, np.nan, s))
    space = Panel(
        (
            Surface(*tip(ZERO3, np.array([0.0, 0.0, 1.0]), 1.0), "grey", 0.3, "body"),
            Curve(ring, "blue", label=label),
            Curve(ring * 1.2, "green", dash="dotted"),
            Curve(ring * 1.3, "green", dash="dashed"),
            Marks(ring[:2], "red", label="marks"),
            Arrow(ZERO3, np.array([0, 0, 1.0]), words="$b_3$"),
            Arrow(ZERO3, ZERO3, words=label),
            Words(np.array([1.0, 1, 1]), label),
        ),
        (Axis("x"), Axis("y"), Axis(label)),
        equal=True,
    )
    plane = Panel(
        (
            Curve(broken, "red", label=r"$\omega_1$"),
            Marks(points([1, 10], [1, 2])),
            Arrow(np.array([1.0, 1]), np.array([2.0, 3]), words=label),
            Words(np.array([1.0, 1]), label),
        ),
        (Axis("$t$ [s]"), Axis(label)),
        label,
    )
    return Picture(((space,), (plane,)), title, label)


@pytest.mark.sparse(2)
@pytest.mark.parametrize("ending", [".png", ".svg", ".pdf", ".html"])
def test_the_same_picture_has_the_same_bytes(tmp_path, ending):
    whole = sample()
    picture = Picture(whole.rows[:1], whole.title, whole.caption)
    first = save(picture, tmp_path / f"a{ending}", size=(3, 3), dpi=30)
    second = save(picture, tmp_path / "new" / f"b{ending}", size=(3, 3), dpi=30)
    assert first.read_bytes() == second.read_bytes()
    assert not re.search(rb"20\d\d-\d\d-\d\d", first.read_bytes()[:2000])
    assert sorted(p.name for p in tmp_path.iterdir()) == [f"a{ending}", "new"]


def test_hostile_words_in_svg(tmp_path):
    line = points([0, 1], [0, 1])
    for escape in (formulas.plain, str):
        lines = tuple(Curve(line, label=escape(text)) for text in HOSTILE)
        words = tuple(Words(line[0], escape(text)) for text in HOSTILE)
        picture = Picture(((Panel((*lines, *words), (Axis(), Axis())),),), escape(HOSTILE[0]))
        svg = save(picture, tmp_path / "a.svg").read_text(encoding="utf-8")
        ET.fromstring(svg)
        assert "<script" not in svg


@pytest.mark.parametrize("text", HOSTILE)
def test_hostile_words_on_pages(monkeypatch, text):
    whole = turned.pages.web
    monkeypatch.setattr(
        turned.pages, "web", lambda name: "" if name.endswith("js") else whole(name)
    )
    body = turned.page(sample(formulas.plain(text), text))
    assert formulas.as_text(formulas.plain(text)) == formulas.clean(text)
    assert f"<title>{html.escape(formulas.clean(text))}</title>" in body
    assert len(re.findall("<script", body)) == 7  # the data, and six of our own
    assert "<img" not in body
    data = json.loads(re.search(r'id="data">(.*?)</script>', body, re.DOTALL)[1])
    panels = [panel for row in data["rows"] for panel in row]
    said = [i["words"] for p in panels for i in p["items"] if i["kind"] == "words"]
    said += [panel["title"] for panel in panels]
    for words in said:  # words stay words: pieces of text with a style, never marked up
        assert {style for _, style, _ in words} <= {"", "i", "b"}
        assert {level for *_, level in words} <= {"", "sub", "sup"}


@examples(50)
@given(st.text(max_size=30))
def test_any_text_can_be_words(text):
    """Plain text reads as it is; as a formula it is written without tags that others could make."""
    assert formulas.as_text(formulas.plain(text)) == formulas.clean(text)
    made = formulas.as_html(text)
    assert set(re.findall(r"<[^>]*>", made)) <= {
        "<b>", "</b>", "<i>", "</i>", "<sub>", "</sub>", "<sup>", "</sup>", "<br>"
    }  # fmt: skip


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (r"$\omega_1$ [rad/s]", "<i>ω</i><sub><i></i>1</sub> [rad/s]".replace("<i></i>", "")),
        (r"$\mathbf{b}_{12}^2$", "<b>b</b><sub>12</sub><sup>2</sup>"),
        (r"$\dot{\theta} - 1$", "<i>θ\u0307</i>\u22121"),
        (r"$q_\mathrm{norm}$", "<i>q</i><sub>norm</sub>"),
        (r"a $ b", "a $ b"),
        (r"a \$ b", "a $ b"),
        ("a < b\nc", "a &lt; b<br>c"),
        (r"$x_{$", "<i>x</i><sub></sub>"),
        (r"$x_$", "<i>x</i>_"),
    ],
)
def test_formulas_as_html(text, expected):
    assert formulas.as_html(text) == expected


def test_lines_of_a_title_keep_formulas_whole():
    text = r"The $\frac{a b}{c d}$ of a body \$ and more words than a line has"
    lines = formulas.wrapped(text, 20).split("\n")
    assert " ".join(lines) == text
    assert len(lines) > 2
    assert any(r"$\frac{a b}{c d}$" in line for line in lines)


def test_a_formula_that_matplotlib_cannot_read_is_shown_as_written():
    made = printed.figure(Picture(sample().rows, r"$\notacommand{x}$"))
    assert made.get_suptitle() == r"\$\notacommand{x}\$"


def test_the_readers_settings_have_no_effect_and_are_left_alone(tmp_path):
    import matplotlib as mpl

    line = Curve(points([0, 1], [0, 1]), label="$x$")
    small = Picture(((Panel((line,), (Axis("$t$"), Axis())),),))
    usual = save(small, tmp_path / "a.svg").read_bytes()
    with mpl.rc_context({"font.size": 30, "svg.hashsalt": "other", "axes.grid": False}):
        assert save(small, tmp_path / "b.svg").read_bytes() == usual
        assert mpl.rcParams["font.size"] == 30


def test_no_window_is_made():
    from matplotlib import _pylab_helpers

    printed.figure(sample())
    assert not _pylab_helpers.Gcf.figs


def test_a_line_behind_a_body_is_painted_before_it(tmp_path):
    """A horizontal ring about a sphere: its far half lies under the near faces, its near half over all."""
    s = np.linspace(0, 2 * np.pi, 60)
    ring = 1.02 * points(np.cos(s), np.sin(s), 0 * s)
    panel = Panel(
        (ellipsoid((1, 1, 1), "grey", 0.5), Curve(ring, "blue")), (Axis(),) * 3, equal=True
    )
    figure = printed.figure(Picture(((panel,),)))
    axes = figure.subfigs[0].axes[0]
    (painted,) = axes.collections
    lines = np.flatnonzero(np.array(painted.get_linewidths()) > 1)
    size = len(painted.get_paths())
    first, last = lines[0], lines[-1]
    assert first < 0.5 * size
    assert last == size - 1
    heights = [painted.get_paths()[k].vertices[:, 1].mean() for k in (first, last)]
    assert heights[0] > heights[1]  # seen from above, the far half is higher on paper


def test_axes_in_space_have_equal_scales():
    panel = Panel((Curve(points([0, 3], [0, 1], [0, 0.5])),), (Axis(),) * 3, equal=True)
    ((made,),) = turned.described(Picture(((panel,),)))["rows"]
    assert made["equal"]
    for axis, end in zip(made["axes"], (3, 1, 0.5), strict=True):
        assert axis["low"] < 0 < end < axis["high"] == pytest.approx(end - axis["low"])


@given(st.integers(2, 40), st.sampled_from(["solid", "dashed", "dotted"]), st.integers(0, 39))
def test_pieces_of_a_line_lie_on_it(count, dash, gap):
    s = np.linspace(0, 4, count)
    line = points(s, s**2 / 4, -s)
    line[gap % count] = np.nan
    pieces = cut(line, dash, 5.0)
    whole = sum(np.linalg.norm(np.diff(r, axis=0), axis=1).sum() for r in runs(line))
    drawn = sum(np.linalg.norm(np.diff(p, axis=0), axis=1).sum() for p in pieces)
    assert all(np.isfinite(p).all() for p in pieces)
    if dash == "solid":
        assert drawn == pytest.approx(whole)
    else:
        assert drawn <= whole
    for piece in pieces:
        assert np.abs(piece[:, 0] + piece[:, 2]).max() < 1e-12


def test_the_tip_of_an_arrow_is_a_closed_cone():
    vertices, faces = tip(ZERO3, np.array([1.0, 2.0, 2.0]), 0.5)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, shared = np.unique(edges, axis=0, return_counts=True)
    assert set(shared) == {2}
    assert np.linalg.norm(vertices - [1, 2, 2], axis=1).min() == 0
    assert len(tip(ZERO3, ZERO3, 0.5)[0]) == 0
    assert in_space(Panel((Arrow(ZERO3, ZERO3),), (Axis(),) * 3), np.ones(3), 1.0) == []


def test_logarithmic_axes_and_broken_lines():
    panel = Panel(
        (Curve(points([1, 10, 100], [1e-9, np.nan, 1e-3]), label="error"),),
        (Axis("t", "log"), Axis("e", "log", (1e-12, 1.0))),
    )
    picture = Picture(((panel,),))
    axes = printed.figure(picture).axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert axes.get_ylim() == (1e-12, 1.0)
    made = turned.described(picture)
    ((drawn,),) = made["rows"]
    assert [a["scale"] for a in drawn["axes"]] == ["log", "log"]
    assert (drawn["axes"][1]["low"], drawn["axes"][1]["high"]) == (-12.0, 0.0)
    kind, text = made["columns"][drawn["items"][0]["at"][1]]
    column = np.frombuffer(base64.b64decode(text), f"<{kind}")
    np.testing.assert_allclose(column, [1e-9, np.nan, 1e-3], rtol=1e-6)
    assert axes.get_legend() is not None
    bare = Panel((Curve(points([1, 2], [1, 2])),), (Axis(), Axis()))
    assert printed.figure(Picture(((bare,),))).axes[0].get_legend() is None


def test_a_label_of_several_items_is_listed_once():
    line = points([0, 1], [0, 1])
    panel = Panel((Curve(line, label="a"), Curve(line, label="a"), Curve(line)), (Axis(), Axis()))
    made = turned.described(Picture(((panel,),)))
    assert made["labels"] == [[("a", "", "")]]
    assert [item["label"] for item in made["rows"][0][0]["items"]] == [0, 0, None]
    legend = printed.figure(Picture(((panel,),))).axes[0].get_legend()
    assert [t.get_text() for t in legend.get_texts()] == ["a"]


@pytest.mark.parametrize("name", ["a.gif", "a", "a.png.txt", ".svg"])
def test_other_endings_are_refused(tmp_path, name):
    with pytest.raises(InputError, match="unknown kind of picture") as caught:
        save(sample(), tmp_path / name)
    assert ".html" in caught.value.expected
    assert not list(tmp_path.iterdir())


def test_a_missing_package_names_its_extra(tmp_path, monkeypatch):
    monkeypatch.setattr(extras.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match="not installed") as caught:
        save(sample(), tmp_path / "a.png")
    assert "eom-toolkit[plot]" in caught.value.hint
    with pytest.raises(InputError, match="not installed"):
        printed.figure(sample())
    assert not list(tmp_path.iterdir())
    assert save(sample(), tmp_path / "a.html").exists()  # a page needs none


def test_what_cannot_be_written_leaves_nothing(tmp_path, monkeypatch):
    file = tmp_path / "file"
    file.write_text("kept")
    with pytest.raises(InputError, match="cannot be written"):
        save(sample(), file / "a.svg")
    assert file.read_text() == "kept"
    old = tmp_path / "old.svg"
    old.write_text("old")

    def failing(picture, part, size, dpi):
        Path(part).write_text("half")
        raise OSError("disk full")

    kind = saving.KINDS[".svg"]
    monkeypatch.setitem(saving.KINDS, ".svg", saving.Kind(kind.meaning, kind.printed, failing))
    with pytest.raises(InputError, match="cannot be written"):
        save(sample(), old)
    assert old.read_text() == "old"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file", "old.svg"]


@pytest.mark.parametrize(
    ("size", "dpi"), [((0, 4), 100), ((4, np.nan), 100), ((1e9, 4), 100), (None, 0), (None, 1e9)]
)
def test_sizes_that_no_paper_has(tmp_path, size, dpi):
    with pytest.raises(InputError, match=r"size|pixels an inch"):
        save(sample(), tmp_path / "a.png", size=size, dpi=dpi)
    assert not list(tmp_path.iterdir())


def test_pictures_that_cannot_be_drawn(tmp_path):
    wrong = Picture(((Panel((Curve(points([0, 1], [0, 1]), "pink"),), (Axis(), Axis())),),))
    for draw in (printed.figure, turned.described):
        with pytest.raises(InputError, match="unknown colour"):
            draw(wrong)
        with pytest.raises(InputError, match="no panel"):
            draw(Picture(()))
    empty = Panel((), (Axis(), Axis(), Axis()))
    assert save(Picture(((empty,),)), tmp_path / "a.svg").stat().st_size > 0


class _Page(HTMLParser):
    """The policy of a page, and what its scripts hold as a browser reads them: lines end with LF."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.policy, self.scripts, self._inside = "", [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        if named.get("http-equiv") == "Content-Security-Policy":
            assert self.scripts == []  # what stands before it is not held by it
            self.policy = named["content"]
        self._inside = tag == "script" and "type" not in named
        assert not [name for name in named if name.startswith("on") or name in {"src", "href"}]

    def handle_endtag(self, tag):
        self._inside = False

    def handle_data(self, data):
        if self._inside:
            self.scripts.append(data.replace("\r\n", "\n").replace("\r", "\n"))


def test_a_page_to_turn_may_run_its_own_scripts_and_ask_for_nothing(tmp_path):
    file = save(sample("some words", "a title"), tmp_path / "page.html")
    page = _Page(file.read_bytes().decode("utf-8"))
    allowed = dict(part.partition(" ")[::2] for part in page.policy.split("; "))
    assert allowed["default-src"] == allowed["base-uri"] == allowed["form-action"] == "'none'"
    digests = [hashlib.sha256(s.encode()).digest() for s in page.scripts]
    assert allowed["script-src"].split() == [
        f"'sha256-{base64.b64encode(d).decode()}'" for d in digests
    ]
    assert len(digests) == 6
    assert "connect-src" not in allowed  # as default-src: nothing
    assert "unsafe" not in allowed["script-src"]
