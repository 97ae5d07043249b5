"""Labels that are frames or points by where they stand, densities under integrals, any vectors."""

import pytest

import eom
from eom.checker.infer.densities import densities
from eom.checker.infer.draft import propose
from eom.checker.infer.sayings import prose
from eom.checker.infer.slots import by_places
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document
from eom.checker.read.statements import read
from eom.checker.read.symbol_shape import Look

VEC = ("vec",)


def named(*looks):
    return {(d.table, d.latex): d.meaning for d in by_places(Lexicon(), looks, ())}


def test_sides_of_an_angular_velocity_are_frames_and_the_one_that_never_turns_is_inertial():
    first = Look("omega", accents=VEC, presup=("A",), sup=("B",))
    second = Look("omega", accents=VEC, presup=("B",), sup=("D",))
    assert named(first, second) == {
        ("frames", "A"): "I", ("frames", "B"): "B", ("frames", "D"): "D",
    }  # fmt: skip


def test_labels_of_places_are_points_and_the_star_is_the_mass_centre():
    place = Look("r", accents=VEC, sup=("Q", "/", "P"))
    inertia = Look("I", accents=("bar", "bar"), sup=("B", "/", "B^ast"))
    found = named(place, inertia)
    assert found["points", "P"] == "P"
    assert found["points", r"B^{\ast}"] == "C"
    assert found["points", "Q"] not in {"P", "C"}


def test_a_point_about_which_a_body_has_inertia_is_one_of_the_body():
    inertia = Look("I", accents=("bar", "bar"), sup=("B", "/", "P"))
    assert named(inertia)["points", "P"] == "OA"


def test_labels_that_stand_for_any_point_or_for_one_that_is_passed_name_nothing():
    assert named(Look("v", accents=VEC, presup=("A",), sup=("B_R",))) == {("frames", "A"): "I"}
    assert named(Look("I", accents=("bar", "bar"), sup=("B", "/", "X"))) == {}


VOLUME = r"""
$$\vec F = \iiint_V \vec F(\vec r)\, dV, \qquad \vec p = \iiint_V \dot{\vec r}\,\sigma(\vec r)\, dV$$
"""


def test_what_stands_with_a_place_under_an_integral_over_a_volume_is_per_volume():
    document = read_document(VOLUME)
    lexicon = parse_lexicon("[symbols]\n'\\vec F' = \"external_force body\"\n")
    found = {d.latex: d.meaning for d in densities(read(document), lexicon, prose(document))}
    assert found == {
        r"\vec{F}(\vec{r})": "force dm per volume",
        r"\sigma(\vec{r})": "mass dm per volume",
    }


IDENTITY = r"""
$$\frac{{}^{A}d\vec u}{dt} = \frac{{}^{B}d\vec u}{dt} + {}^{A}\vec\omega^{B}\times\vec u$$

$$\frac{{}^{A}d\vec u}{dt} = \frac{{}^{B}d\vec u}{dt} %s$$
"""


@pytest.mark.slow
def test_an_identity_holds_for_any_vector_and_none_makes_a_line_wrong():
    """A vector of which nothing is said may be any: what fails for it may be a law of that vector."""
    slip = r"- {}^{A}\vec\omega^{B}\times\vec u"
    assert [f.verdict for f in eom.check(IDENTITY % slip).findings] == ["holds", "unsure"]


SENTENCES = {
    r"$O$ is a point fixed in the body. We define the angular momentum about $O$ and turn to it later, as"
    " follows:\n\n$$\\vec q_O \\triangleq \\int \\vec r\\times\\dot{\\vec r}\\,dm$$\n": {
        r"\vec{q}_{O}": "angular_momentum body O"
    },
    r"$O$ is a point fixed in the body. This yields a relation for the torque about $O$, $\vec g_O$:"
    "\n\n$$\\vec g_O = 0$$\n": {r"\vec{g}_{O}": "torque body O"},
    r"The angular momentum about the mass centre is $\vec H_C$, and $|\vec H_C|$ is constant,"
    " $|\\vec H_C| = h_0$.\n\n$$H^2 = h_0^2$$\n": {"H": r"= \left|\vec{H}_{C}\right|"},
}


@pytest.mark.parametrize("text", SENTENCES)
def test_words_that_lead_to_a_display_and_norms_of_the_text(text):
    found = {d.latex: d.meaning for d in propose(read_document(text)).drafts}
    assert SENTENCES[text].items() <= found.items()
