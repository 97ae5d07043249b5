"""Meanings from the note itself: what sentences say, what letters stand for, what is only a guess."""

from pathlib import Path

import pytest

import eom
from benchmarks.checking import OPEN, read_truth, without_lexicon
from eom.checker.infer.draft import propose
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document
from tests.eom.rows import only

UNSEEN = Path(__file__).parent / "unseen"

SENTENCES = {
    r"$\vec H_O$ is the angular momentum about $O$, a point fixed in the body.": {
        r"\vec{H}_{O}": "angular_momentum body O",
        r"\vec{H}_{<P>}": "angular_momentum body <P>",
        "O": "O",
    },
    r"A rigid body of mass $\mu$ turns in the inertial frame $F$.": {
        "\\mu": "total_mass body",
        "F": "I",
    },
    r"$\mathbf f$ is the external force, $\mathbf g$ the external torque about the mass centre.": {
        r"\mathbf{f}": "external_force body",
        r"\mathbf{g}": "torque body C",
    },
    r"$\mathbf a$ and $\mathbf b$ are the angular momenta about $G$ and about $Q$, built with inertial"
    r" velocities. $G$ is the mass centre, $Q$ any point.": {
        r"\mathbf{a}": "absolute_angular_momentum body C",
        r"\mathbf{b}": "absolute_angular_momentum body O",
        "G": "C",
        "Q": "O",
    },
    r"$\bar r^{Q/P}$ is the position vector from $P$ to $Q$. $P$ and $Q$ are points fixed in the body.": {
        r"\bar{r}^{<P> / <Q>}": "position <P> <Q>"
    },
    r"The matrix $\mathbf K$ takes inertial components into body components.": {
        r"\mathbf{K}": "rotation B I"
    },
    r"Particle $i$ has the mass $m_i$; $\vec F_i$ is the external force on particle $i$.": {
        "m_{<i>}": "mass <i>",
        r"\vec{F}_{<i>}": "force <i>",
    },
    r"A particle of mass $m$ is pulled by $\vec F$. $\vec r$ is its position from a fixed origin $O$.": {
        "m": "mass P",
        r"\vec{r}": "position P OI",
        "O": "OI",
    },
    r"The 3-1-3 angles are applied in the order $\alpha$, $\beta$, $\gamma$.": {
        r"\alpha": "turn_angle 1 313 B I",
        r"\gamma": "turn_angle 3 313 B I",
    },
    r"$\mathbf w$ is the angular velocity; $p$, $q$, $r$ are its body components.": {
        r"\mathbf{w}": "angular_velocity B I",
        "q": "angular_velocity B I in B component 2",
    },
}


@pytest.mark.parametrize("text", SENTENCES)
def test_a_sentence_says_what_symbols_mean(text):
    found = {d.latex: d.meaning for d in propose(read_document(text)).drafts}
    assert SENTENCES[text].items() <= found.items()


SILENT = [
    r"If $\vec H_O$ is constant, $O$ may be the mass centre.",
    r"We differentiate $\vec x$ with respect to $y$.",
    r"The momentum of the wheel about that axis is not needed for $\zeta$.",
]


@pytest.mark.parametrize("text", SILENT)
def test_words_that_name_no_meaning_give_none(text):
    assert [d for d in propose(read_document(text)).drafts if d.table == "symbols"] == []


def test_the_draft_is_a_lexicon_with_its_evidence():
    text = (
        r"$\mathbf h$ is the angular momentum about the mass centre."
        "\n\n$$\\mathbf h = \\mathbf J_1$$"
    )
    found = propose(read_document(text))
    assert "# line 1: the angular momentum about the mass centre" in found.toml
    assert parse_lexicon(found.toml).layers[0] != ()


NOTE = r"""
$\vec p$ is the linear momentum of a body, $\vec F$ the external force.

$$\dot{\vec p} = %s$$
"""


def test_a_meaning_in_words_makes_a_wrong_line_wrong():
    assert [f.verdict for f in eom.check(NOTE % r"\vec F").findings] == ["holds under"]
    assert [f.verdict for f in eom.check(NOTE % r"2\vec F").findings] == ["wrong"]


def test_a_guess_makes_a_wrong_line_unsure_and_strict_makes_it_wrong():
    text = "A note without a word on its letters.\n\n$$\\dot{\\mathbf p} = 2\\mathbf F$$\n"
    (found,) = eom.check(text).findings
    assert found.verdict == "unsure"
    assert found.reason.startswith(r"if $")
    assert "then:" in found.reason
    assert not eom.check(text).faults
    assert [f.verdict for f in eom.check(text, strict=True).findings] == ["wrong"]


NOTES = {"gyrostat": (15, 9), "quaternions": (19, 9), "rodrigues": (15, 8), "moving_point": (15, 5)}
"""Displays of notes that are decided at least with nothing but the note, and slips that are found."""


@pytest.mark.parametrize("name", only(list(NOTES), "gyrostat"))
def test_notes_are_judged_with_nothing_but_themselves(name):
    rows = [r for r in without_lexicon(UNSEEN, name) if r.kind == "display"]
    assert not [r.entry.name for r in rows if r.false_alarm]
    decided, found = NOTES[name]
    assert sum(r.ours not in OPEN for r in rows) >= decided
    assert sum(r.caught for r in rows) >= found


def test_every_note_is_its_own_truth():
    assert {e.split(":")[0] for e in read_truth(UNSEEN / "truth.json")} >= set(NOTES)
