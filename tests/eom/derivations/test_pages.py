"""Pages of all chapters: lengths of lines, one meaning a letter, the list of symbols, handouts."""

import html
import re
import shutil
from xml.etree import ElementTree

import pytest

from benchmarks.pages import formula_lines, longest_line, pdf_pages
from eom.derivations import derive, names
from eom.derivations.forms import FORMS
from eom.derivations.handout import behind, key_steps
from eom.derivations.showing import FORMATS, numbers, symbols
from eom.derivations.wording import letters_in_words, named, notation_of
from eom.errors import InputError
from eom.terms.terms import nodes
from eom.typeset.boxes import symbol
from eom.typeset.markup import render
from eom.typeset.notation import NOTATIONS, notation_named
from tests.eom.rows import derivations, only

SAME = {"identity_matrix": "identity"}
"""The unit dyadic and the matrix of its components have one letter."""


@pytest.mark.parametrize("name", derivations())
def test_no_line_of_a_formula_has_200_letters_of_latex(name):
    for notation in NOTATIONS:
        for line in formula_lines(derive(name), notation):
            assert len(line) < 200 or "matrix}" in line


@pytest.mark.parametrize("name", derivations())
def test_no_line_of_text_is_longer_than_100_letters(name):
    for notation in NOTATIONS:
        assert longest_line(derive(name).page("text", notation, steps=False)) <= 100
        assert longest_line(derive(name).page("text", notation)) <= 100
        assert longest_line(derive(name).page("text", notation, form="handout")) <= 100


@pytest.mark.parametrize("name", derivations())
def test_a_letter_names_one_thing(name):
    for notation in NOTATIONS:
        found = {}
        for one in named(derive(name), notation_of(derive(name), notation_named(notation))):
            thing = (SAME.get(one.thing[0], one.thing[0]), *one.thing[1:])
            letter = render(one.box, "latex")
            assert found.setdefault(letter, thing) == thing, f"{letter} in {notation}"


@pytest.mark.parametrize("name", derivations())
def test_every_symbol_is_listed_once(name):
    d = derive(name)
    sides = [t for s in d.steps for t in (s.statement.left, s.statement.right)]
    used = {s for t in sides for n in nodes(t) if n.head == "expr" for s in n.data[0].free_symbols}
    for notation in NOTATIONS:
        boxes = [render(box, "text") for box, _ in symbols(d, notation_named(notation))]
        listed = [b.partition(" := ")[0] for b in boxes]
        assert len(listed) == len(set(listed))
        assert {render(symbol(s.name), "text") for s in used} <= set(listed)


@pytest.mark.parametrize("name", derivations())
def test_as_many_steps_are_announced_as_are_numbered(name):
    shown = derive(name).page("text")
    (announced,) = re.findall(r"(\d+) steps?, each verified", shown)
    assert list(map(int, re.findall(r"^ {0,2}(\d+)\. ", shown, re.MULTILINE))) == [
        *range(1, int(announced) + 1)
    ]


def test_words_have_the_letters_of_the_notation():
    shown = derive("euler-equations").page("text", "kane")
    assert "Newton's second law holds in the inertial frame N" in shown
    assert "angular velocity of frame B with respect to N" in shown
    assert "frame I" not in shown
    known = letters_in_words(derive("euler-equations"), notation_named("superscript"))
    assert render(known["C"], "text") == "G"


@pytest.mark.parametrize(
    ("name", "letter", "wanted"),
    [
        ("euler-equations", "J_C", "\U0001d540\u0332"),
        ("inertia-properties", "J_O", "\U0001d541\u0332"),
        ("inertia-properties", "C_AB", "C_AB"),
        ("particle-system", "M", "m"),
        ("point-mass", "m", "m"),
        ("virtual-work", "n", "n"),
    ],
)
def test_words_have_the_letters_of_the_formulas(name, letter, wanted):
    known = letters_in_words(derive(name), notation_named("underline"))
    assert render(known[letter], "text") == wanted


def test_no_frame_has_the_letter_of_a_number():
    page = derive("spinning-symmetric-body").page("text", "underline")
    assert "W is fixed in the body" in page
    assert "w\u0332\u2082 = b\u0332\u2082" in page
    assert "C := " in page
    assert "frame C" not in page


def test_words_have_the_inertia_of_the_formulas():
    assert "\U0001d540\u0332 is constant" in derive("energy-dissipation").page("text", "underline")


def test_sizes_and_angles_are_told_apart():
    axes = "along axis 1", "along axis 2"
    for name, words in (("box", " size "), ("ellipsoid", " half the size ")):
        page = derive(f"inertia-of-{name}").page("text", steps=False)
        assert all(re.search(rf"^ +[ab] +{words.strip()} {a}$", page, re.MULTILINE) for a in axes)
    assert "from 0 to 1 \u2212 s\u2082 \u2212 s\u2083" in derive("inertia-of-tetrahedron").page()


def test_terms_of_euler_stand_in_cyclic_order():
    shown = derive("euler-equations").page("latex")
    for row in (
        r"(I_{3} - I_{2}) \, \omega_{2} \omega_{3}",
        r"(I_{1} - I_{3}) \, \omega_{3} \omega_{1}",
    ):
        assert row in shown
    assert "(R + s \\cos t) \\, s &=" in derive("inertia-of-torus").page("latex")


# -- handouts --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", derivations())
def test_a_handout_holds_results_and_what_they_hang_on(name):
    d, notation = derive(name), notation_named("arrow")
    steps = key_steps(d, notation)
    used = {f for s in d.steps for f in s.follows}
    results = [s for s in steps if s.label not in used]
    rests = behind(d)
    assert 0 < len(results) <= len(steps) < len(numbers(d, notation))
    assert all(s in results or any(s.label in rests[r.label] for r in results) for s in steps)
    for style in FORMATS:
        assert d.title in html.unescape(d.page(style, form="handout"))


def test_of_results_that_say_the_same_of_other_axes_one_is_kept():
    d = derive("torque-free-motion")
    chosen = {s.label for s in key_steps(d, notation_named("arrow"))}
    reasons = [d[label].reason for label in chosen]
    assert sum("roots" in r for r in reasons) <= 1
    assert any("invariable plane" in r for r in reasons)


def test_other_forms_are_refused():
    with pytest.raises(InputError, match="full, handout"):
        derive("point-mass").page(form="half")
    with pytest.raises(InputError, match="has steps"):
        derive("point-mass").page(form="handout", steps=False)
    assert FORMS == ("full", "handout")


needs_latex = pytest.mark.skipif(shutil.which("pdflatex") is None, reason="LaTeX is not installed")


@needs_latex
def test_a_handout_is_one_page_of_pdf():
    assert pdf_pages(derive("energy-dissipation").page("latex", form="handout")) == 1


@needs_latex
@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_every_page_is_compiled_and_each_handout_is_one_page(name):
    for notation in ("arrow", "kane"):
        assert pdf_pages(derive(name).page("latex", notation, form="handout")) == 1
        assert pdf_pages(derive(name).page("latex", notation)) >= 1


def test_symbols_of_a_result_alone_are_listed():
    shown = derive("rigid-body-momentum").page("text", steps=False)
    assert "integral of r\u2081 r\u2082 dm over the body" in shown


def test_assumptions_say_which_others_they_include():
    page = derive("torque-free-motion").page("text")
    assert "is zero (includes A3, A4, A5)" in page
    assert "A5  the frame B is fixed in the body (includes A2)" in page
    short = derive("torque-free-motion").page("text", form="handout")
    told = set(re.findall(r"\(A(\d)\)", short))
    included = re.findall(r"\(includes ([^)]*)\)", short)
    assert included
    assert {k for words in included for k in re.findall(r"A(\d)", words)} <= told


def test_a_matrix_that_stands_alone_does_not_move_its_relation():
    page = derive("energy-dissipation").page("text")
    matrices = [line for line in page.splitlines() if line.strip().startswith(("[[", "= [["))]
    assert matrices
    assert max(len(line) - len(line.lstrip()) for line in matrices) < 16


def test_rotors_have_one_notation():
    page = derive("gyrostat").page("latex")
    assert "I_{s,k}" in page
    assert "I_{s,1}" in page
    assert "I_{sk}" not in page


@pytest.mark.parametrize("name", only(names(), "energy-dissipation", "heavy-symmetric-top"))
def test_no_quotient_stands_in_a_quotient(name):
    for formula in re.findall("<math.*?</math>", derive(name).page("html"), re.DOTALL):
        quotients = ElementTree.fromstring(formula).iter("mfrac")
        assert not any(inner is not outer for outer in quotients for inner in outer.iter("mfrac"))
