"""What reports say of meanings: plain words, the note's own labels, lines that hold with a guess."""

import re

import pytest

import eom
from eom.checker.infer.letters import Draft
from eom.checker.infer.plain import Names, in_words, names_of, pattern_in_words, row_in_words
from eom.checker.infer.systems import rows
from eom.checker.mean.lexicon_files import PRESETS, preset

SIGNS = re.compile(r"[\\|?*()\[\]_<>]")
"""What stands in patterns and names, and in no plain words."""


@pytest.mark.parametrize("row", rows(), ids=lambda r: r.name)
def test_every_quantity_of_a_system_has_a_noun(row):
    for letter in row.letters:
        assert letter.noun, letter.means
        assert not SIGNS.search(letter.noun), (letter.means, letter.noun)


@pytest.mark.parametrize("name", PRESETS)
def test_every_meaning_of_a_preset_has_words(name):
    for layer in preset(name).layers:
        for entry in layer:
            said = in_words(entry.meaning.words)
            assert said
            assert entry.meaning.formula or "<" not in said


@pytest.mark.parametrize(
    ("meaning", "words"),
    [
        ("angular_momentum body C", "angular momentum of the body about the centre of mass"),
        (
            "angular_velocity B I",
            "angular velocity of the frame of the body with respect to the inertial frame",
        ),
        ("position <P> OI", "position of P from the inertial origin, for any point P"),
        ("unit I <k>", "unit vector along axis k of the inertial frame, for any axis k"),
        (
            "torque body C in B component 2",
            (
                "component 2, in the frame of the body, of the external torque on the body about "
                "the centre of mass"
            ),
        ),
        (r"= \dot{\vec r}", r"the same as $\dot{\vec r}$"),
        ("no meaning", "no meaning"),
    ],
)
def test_meanings_in_words(meaning, words):
    assert in_words(meaning) == words


def test_frames_and_points_have_the_names_that_the_note_gives_them():
    drafts = [
        Draft("frames", r"\mathcal{D}", "A", "", 1),
        Draft("points", "P", "O", "", 1),
        Draft("frames", r"\mathcal{N}", "I", "", 1),
    ]
    names = names_of((), drafts)
    assert names == Names((), {"A": r"$\mathcal{D}$", "O": "P"})
    said = in_words("angular_velocity A I", names)
    assert said == r"angular velocity of frame $\mathcal{D}$ with respect to the inertial frame"
    assert in_words("inertia O", names).endswith("about P")
    assert [row_in_words(d, names) for d in drafts] == [
        "label of a frame",
        "label of the reference point",
        "label of the inertial frame",
    ]
    assert pattern_in_words(r"\hat{n}_{<k>}") == r"\hat{n}_{k}"


NOTE = r"""A pendulum of length $l$ and mass $m$ swings by the angle $\theta$ from the vertical:

$$ \ddot\theta = -\frac{g}{l}\sin\theta $$

$$ q = l\dot\theta $$
"""


def test_what_was_taken_is_told_with_its_evidence():
    said = {d.latex: str(d) for d in eom.check(NOTE).drafts}
    assert said["l"].startswith("l: length (line 1: '")
    assert said["g"] == "g: acceleration of gravity (by its usual letter; line 3 holds with it)"
    assert said[""] == "the note is about a simple pendulum (the note says 'pendulum')"


def test_a_doubt_is_told_in_words():
    (found,) = eom.check("F = 2 m a").findings
    assert found.verdict == "unsure"
    assert "$m$ is the mass of the system (by its usual letter)" in found.reason
