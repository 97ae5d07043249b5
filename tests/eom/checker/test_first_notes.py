"""Notes as newcomers write them, with nothing but the note: and nothing true called wrong."""

from pathlib import Path

import pytest

import eom

FOLDER = Path(__file__).parent / "first"
WRONG = {"wrong"}
OPEN = {"undecided", "unsure", "unsure in general"}
NOTES = {
    "pendulum.md": ({9}, 0),
    "rotating.md": ({14}, 1),
    "particles.tex": (set(), 1),
    "top.md": (set(), 5),
    "cylinder.md": (set(), 3),
    "attitude.tex": (set(), 0),
    "wheel.md": (set(), 5),
}
"""The lines that are false, and how many lines at most are left open."""


@pytest.mark.parametrize("name", NOTES)
def test_a_note_by_itself(name):
    false, most = NOTES[name]
    found = eom.check(FOLDER / name).findings
    assert {f.line for f in found if f.verdict in WRONG} == false
    assert sum(f.verdict in OPEN for f in found) <= most


def test_a_line_that_needs_a_special_case_left_unsaid_makes_no_meaning_sure(tmp_path):
    note = tmp_path / "note.tex"
    lines = (FOLDER / "particles.tex").read_text(encoding="utf-8")
    note.write_text(lines.replace("about $O$ is\n", "is\n"), encoding="utf-8")
    found = eom.check(note).findings
    assert not [f.line for f in found if f.verdict in WRONG]
