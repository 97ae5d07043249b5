"""Sketches of derivations: what their lines speak of is drawn, in the letters of the notation."""

import itertools
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from eom.derivations import derive
from eom.typeset.notation import NOTATIONS
from eom.views.body.chapters import drawn
from eom.views.draw import lined
from eom.views.draw.meshes import ellipsoid
from eom.views.draw.picture import Arrow, Axis, Panel, Picture, Surface
from tests.eom.rows import only

SOME = ["euler-equations", "particle-system", "spinning-symmetric-body", "inertia-of-torus"]


@pytest.mark.parametrize("name", only(SOME, "euler-equations", "inertia-of-torus"))
def test_sketches_are_sound_in_each_notation(name):
    for notation in NOTATIONS:
        (one,) = drawn(derive(name), notation)
        ElementTree.fromstring(one.drawing.svg)
        assert one.drawing.latex.count("\\begin{picture}") == 1
        assert not re.search(r"\bnan\b", one.drawing.svg + one.drawing.latex)


def test_axes_have_the_letters_of_the_notation():
    latex = {n: drawn(derive("euler-equations"), n)[0].drawing.latex for n in ("arrow", "kane")}
    assert "\\hat{i}_{1}" in latex["arrow"]
    assert "\\hat{\\mathbf{n}}_{1}" in latex["kane"]
    assert "\\hat{i}_{1}" not in latex["kane"]


def test_a_figure_stands_before_the_first_line_that_speaks_of_it():
    d = derive("rigid-body-momentum")
    page = d.page("html")
    assert "<svg" not in page
    from eom.derivations.forms import show_derivation

    shown = show_derivation(d, "html", drawn=drawn(d))
    before = shown[: shown.index("<svg")]
    assert "<b>1.</b>" in before
    assert "<b>9.</b>" not in before


def test_what_speaks_of_one_frame_and_no_place_has_no_figure():
    assert drawn(derive("variable-mass")) == ()


def test_the_outline_of_a_ball_is_a_circle_and_a_cube_has_its_edges():
    round_ = ellipsoid((1.0, 1.0, 1.0), "sky", 0.3)
    seen = np.concatenate(list(lined.outline(round_, np.array([0.0, 0.0, 1.0]))))
    assert np.linalg.norm(seen[:, :2], axis=1) == pytest.approx(1.0, abs=0.01)
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))])
    cube = Surface(corners, faces)
    assert len(list(lined.outline(cube, np.array([1.0, 2.0, 3.0])))) == 9


def test_an_arrow_has_its_name_beyond_its_tip():
    arrow = Arrow(np.zeros(3), np.array([0.0, 0.0, 1.0]), words="$b_3$")
    picture = Picture(((Panel((arrow,), (Axis(), Axis(), Axis())),),), caption="one < two")
    (stroke,), (name,), _ = lined.drawing(picture)
    assert name.place[1] > stroke.points[-1][1]
    assert 'aria-label="one &lt; two"' in lined.svg(picture)
    assert "\\put" in lined.latex(picture)


@pytest.mark.parametrize("notation", NOTATIONS)
def test_no_name_in_a_sketch_covers_another(notation):
    for name in ("particle-system", "rigid-body-momentum", "inertia-properties"):
        picture = _picture(derive(name), notation)
        _, names, size = lined.drawing(picture)
        for a, b in itertools.combinations(names, 2):
            assert np.any(np.abs(a.place - b.place) >= lined.half(a) + lined.half(b)), (
                a.text,
                b.text,
            )
        assert all(np.all((n.place >= 0) & (n.place <= size)) for n in names)


def _picture(derivation, notation):
    """The picture that is drawn, as it goes to the page."""
    seen = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lined, "svg", lambda p: seen.append(p) or "")
        drawn(derivation, notation)
    return seen[0]


def test_a_name_that_covers_nothing_stays():
    name = lined.Name(np.array([10.0, 10.0]), "$a$", "black")
    far = lined.Stroke(np.array([[0.0, 0.0], [30.0, 0.0]]), "black", 1.0)
    first, second = lined.apart([name, name], [far], np.array([30.0, 30.0]))
    assert first.place == pytest.approx(name.place)
    assert second.place != pytest.approx(name.place)


def test_the_centre_that_is_a_bullet_is_one():
    svg = drawn(derive("particle-system"), "underline")[0].drawing.svg
    assert "bullet" not in svg
    assert "\u2022" in svg
