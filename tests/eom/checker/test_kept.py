"""Notes that are judged true become derivations and come back; what is not true stays a note."""

import pytest

import eom
from eom.checker.note.kept import TRUE, from_note, to_note
from eom.derivations import names
from eom.errors import InputError
from tests.eom.own_derivations import OWN

CHAPTERS = [n for n in names() if not n.startswith("inertia-of-")]
OPEN = {
    "rigid-body-momentum": "not an integral over a body",  # of dF
    "spinning-symmetric-body": "unknown frame",  # its frame C of a sequence
}
"""Chapters with a line that the reader of notes leaves undecided, and why."""
UNSEEN = {"inertia-properties": "the sign cannot be decided"}
"""Chapters whose page is judged true, of which a line cannot be verified without its page."""


def faults(text):
    return [
        (f.line, f.verdict, f.reason)
        for f in eom.check(text).findings
        if f.kind == "display" and f.verdict not in {*TRUE, "no claim"}
    ]


@pytest.mark.sparse(only=["gyrostat", "tilde-identities", "transport-theorem"])
@pytest.mark.parametrize("name", [n for n in CHAPTERS if n not in OPEN])
def test_a_derivation_becomes_a_note_of_true_lines_and_comes_back(name):
    d = eom.derive(name)
    note = to_note(d)
    assert faults(note) == []
    if name in UNSEEN:
        with pytest.raises(InputError, match=UNSEEN[name]):
            from_note(note)
        return
    back = from_note(note)
    assert back.title == d.title
    assert len(back.steps) >= len(d.steps)
    assert all(s.evidence for s in back.steps)
    assert faults(to_note(back)) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", OPEN)
def test_what_the_reader_cannot_decide_is_said(name):
    found = faults(to_note(eom.derive(name)))
    assert found
    assert all(verdict == "undecided" for _, verdict, _ in found)
    assert any(OPEN[name] in reason for *_, reason in found)


NOTE = r"""+++
[check]
preset = "arrow-tilde"
[check.symbols]
'\vec F' = "force P"
'm' = "mass P"
'\vec R' = "position P OI"
'\vec\rho' = "position P O"
'\vec H_O' = "angular_momentum P O"
'\vec u' = "vector u"
'\vec v' = "vector v"
'\vec w' = "vector w"
+++

# A particle

Newton's second law holds.

The momentum changes by the force, as the mass is constant:

$$ \vec F = m \ddot{\vec R} $$

$$ \vec H_O = m \vec\rho \times \dot{\vec\rho} $$
"""


def test_steps_have_reasons_lines_and_assumptions():
    d = from_note(NOTE)
    assert (d.name, d.title, d.group) == ("a-particle", "A particle", "Notes")
    first = d.steps[0]
    assert first.reason == "The momentum changes by the force, as the mass is constant"
    assert {"newton_2", "constant_mass"} <= set(first.assumptions)
    assert first.evidence == "held in 3 random worlds"
    assert "A particle" in d.page("html")
    assert d.steps[1].reason == "line 23 of the note"


CHAIN = r"""$$\begin{aligned}
\vec u \times (\vec v \times \vec w) &= \vec v (\vec u \cdot \vec w) - \vec w (\vec u \cdot \vec v) \\
 &= (\vec u \cdot \vec w) \vec v - (\vec u \cdot \vec v) \vec w \\
 &= -(\vec v \times \vec w) \times \vec u
\end{aligned}$$"""


def test_a_chain_comes_back_as_a_chain():
    steps = from_note(NOTE + CHAIN).steps[2:]
    assert len({s.statement.left for s in steps}) == 1
    assert len({s.statement.right for s in steps}) == len(steps) == 2


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        (r"m \ddot", r"2 m \ddot", "not judged true.*wrong"),
        (r"\vec F = m \ddot{\vec R}", r"\vec F = m \ddot{\vec Z}", "not judged true.*undecided"),
        (
            r"$$ \vec H_O = m \vec\rho \times \dot{\vec\rho} $$",
            r"$$ \vec F + m = 0 $$",
            "ill-formed",
        ),
        ("$$", "$", "no line of this note"),
    ],
)
def test_a_note_that_is_not_true_is_refused_with_its_line(old, new, what):
    with pytest.raises(InputError, match=rf"(?s){what}"):
        from_note(NOTE.replace(old, new))


def test_what_no_lexicon_says_stays_a_program():
    with pytest.raises(InputError, match="frames and laws of one's own"):
        to_note(OWN["bead_by_kane"]().finish())
