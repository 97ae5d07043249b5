"""Drafts of lexica: what a note says of its symbols goes before what a preset says of them."""

import tomllib
from time import process_time

import pytest

import eom
from eom.checker.infer.draft import propose
from eom.checker.infer.sayings import MAX_SENTENCE, prose
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document

NOTE = r"""
The direction cosine matrix $[C]$ maps components in $\mathcal{N}$ to components in $\mathcal{B}$,
and $\boldsymbol{\omega}_{\mathcal{B}/\mathcal{N}}$ is not used here.
The angular velocity of the body is $\mathbf{q}$.

$$[\dot{C}] = -[\tilde{\mathbf{q}}][C]$$

$$[\dot{C}] = [\tilde{\mathbf{q}}][C]$$
"""


def test_words_of_the_note_go_before_the_preset():
    found = propose(read_document(NOTE))
    assert found.preset == "schaub-junkins"
    assert [(d.latex, d.meaning) for d in found.drafts] == [(r"\mathbf{q}", "angular_velocity B I")]
    assert [f.verdict for f in eom.check(NOTE).faults] == ["wrong"]


def test_what_a_preset_says_more_closely_stays():
    text = NOTE.replace(
        "angular velocity of the body is $\\mathbf{q}$", "angular velocity is $\\omega_1$"
    )
    text += r" The angular momentum is $\mathbf{H}_{O}$, the kinetic energy $T_{rot}$,"
    text += " the mass of the body is $m$."
    drafts = {d.latex for d in propose(read_document(text)).drafts}
    assert not drafts & {r"\mathbf{H}_{O}", "T_{rot}", "m"}


@pytest.mark.parametrize(
    "sign", ["\U0001f680", '"', "\\", "\x7f", "é", "'", "#", "\t", "$a$", "]]"]
)
def test_a_draft_is_toml_whatever_its_headings_hold(sign):
    text = (
        "# Notes\n\nWords.\n\n"
        f"## A pendulum {sign} of mine\n\nA pendulum of length $l$ hangs; $\\theta$ is its angle from the "
        "vertical.\n\n$$ \\ddot\\theta = -\\frac gl\\sin\\theta $$\n\n"
        "$$ T = 2\\pi\\sqrt{\\frac lg} $$\n\n"
        f"## A block {sign}\n\nA force $F$ acts on a block of mass $m$, which gets the acceleration "
        "$a$.\n\n"
        "$$ F = m a $$\n"
    )
    draft = propose(read_document(text))
    assert tomllib.loads(draft.toml)
    own = [one for one in draft.systems if not one.whole_note]
    assert len(parse_lexicon(draft.toml).scopes) == len(own) + len(draft.parts) > 0


def test_words_without_an_end_take_no_longer_than_sentences():
    words = (
        "the pendulum hangs from a string of length and turns about an axis with angle through "
        * 500
    )
    start = process_time()
    propose(read_document(words + "\n\n$$ F = m a $$\n"))
    assert process_time() - start < 6
    longest = max(map(len, prose(read_document(words)).sentences))
    assert longest <= MAX_SENTENCE
