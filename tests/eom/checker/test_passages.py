"""Notes that speak of one system after the other, without a heading for each."""

import tomllib

import pytest

import eom
from eom.checker.infer.draft import meanings, propose
from eom.checker.infer.trials import passages
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document

NOTE = r"""# Three small things

A force $F$ acts on a block of mass $m$, which gets the acceleration $a$:

$$ F = m a $$

A pendulum of length $l$ hangs from the ceiling; $\theta$ is its angle from the vertical. Then

$$ \ddot\theta + \frac{g}{l}\sin\theta = 0 $$

A uniform rod of length $L$ and mass $M$ turns about its end:

$$ I = \frac13 M L^2 $$

$$ \ddot\phi = -\frac{3 g}{2 L}\cos\phi $$

$$ K = %s I\dot\phi^2 $$
"""


def verdicts(text, **settings):
    return [f.verdict for f in eom.check(text, **settings).findings if f.kind == "display"]


@pytest.mark.parametrize("head", ["# Three small things\n", ""])
def test_each_passage_is_judged_by_its_own_system(head):
    text = NOTE.replace("# Three small things\n", head) % r"\frac12"
    assert verdicts(text) == ["holds"] * 5
    systems = propose(read_document(text)).systems
    line = 3 - (not head)
    assert [s.begins for s in systems] == [line, line + 4, line + 8]
    assert len({s.after for s in systems}) == 3


def test_a_slip_is_a_question_where_letters_are_guesses():
    slip = NOTE % ""
    assert verdicts(slip)[:4] == ["holds"] * 4
    assert verdicts(slip)[4] in {"unsure", "wrong"}
    assert verdicts(slip, strict=True)[4] == "wrong"


def test_the_draft_reads_back_and_gives_the_same_verdicts(tmp_path):
    text = NOTE % r"\frac12"
    draft = propose(read_document(text)).toml
    assert len(tomllib.loads(draft)["scope"]) == 3
    lexicon = tmp_path / "lexicon.toml"
    lexicon.write_text(draft, encoding="utf-8")
    assert verdicts(text, lexicon=lexicon) == ["holds"] * 5
    here = meanings(read_document(text)).lexicon.scopes
    assert [(s.heading, s.after) for s in here] == [
        (s.heading, s.after) for s in parse_lexicon(draft).scopes
    ]


def test_a_passage_ends_with_its_section():
    text = NOTE % r"\frac12" + "\n# Another thing\n\nHere is a line.\n\n$$ P = 2 L $$\n"
    (last,) = [f for f in eom.check(text).findings if "P = 2" in f.latex]
    assert last.verdict == "undecided"


def test_words_that_stand_twice_begin_no_passage():
    text = "The pendulum swings\n\n$$ a = b $$\n\nThe pendulum swings\n\n$$ c = d $$\n"
    found = list(passages(read_document(text).pieces))
    assert [line for _, line, _ in found] == [1]


def test_a_system_of_the_whole_note_is_not_divided():
    text = r"""A pendulum of length $l$ and mass $m$; $\theta$ is its angle from the vertical.

$$ \ddot\theta = -\frac{g}{l}\sin\theta $$

The string of the pendulum pulls with

$$ S = m g\cos\theta + m l\dot\theta^2 $$
"""
    (system,) = propose(read_document(text)).systems
    assert system.whole_note


def test_a_line_of_a_passage_is_wrong_by_two_others_of_it_alone():
    """Lines that hold with the rod do not make the pendulum sure."""
    slip = r"\ddot\theta + \frac{g}{l}\sin\theta = 0"
    text = NOTE.replace(
        slip, f"{slip} $$\n\n$$ " + r"\frac{d}{dt}\dot\theta = \frac{2 g}{l}\sin\theta"
    )
    assert verdicts(text % r"\frac12") == ["holds", "holds", "unsure", *["holds"] * 3]


SHEET = r"""# Week 3

A block of mass $m$ slides down an incline of angle $\alpha$ with friction coefficient $\mu$. Its
acceleration is

$$ a = g(\sin\alpha - \mu\cos\alpha) $$

A ball is thrown with the speed $v_0$ at the angle $\beta$. It reaches the height

$$ H = \frac{v_0^2\sin^2\beta}{2 g} $$

and flies as far as

$$ R = \frac{v_0^2\sin\beta}{g} $$

Two masses $m_1$ and $m_2$ hang on a string over a pulley:

$$ a = \frac{m_1 - m_2}{m_1 + m_2} g $$

A satellite of mass $m$ moves on a circular orbit of radius $r$ about the earth of mass $M$ with the speed

$$ v = \sqrt{\frac{G M}{r}} $$
"""


def test_a_sheet_of_exercises_on_what_is_derived_of_systems():
    report = eom.check(SHEET)
    found = [f.verdict for f in report.findings if f.kind == "display"]
    assert found == ["holds", "holds", "unsure", "holds", "holds"]
    assert any("(the note says 'incline')" in str(d) for d in report.drafts)
