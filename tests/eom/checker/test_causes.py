"""Every undecided line says what would decide it, in words of mechanics."""

import ast
from pathlib import Path

import pytest

import eom
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.note.checking import check_note
from eom.checker.read.documents import note_of
from eom.checker.report.findings import DECIDES, SAME, Settings, decided_by
from eom.terms.terms import HEADS, column, der
from eom.terms.vocabulary import described, omega, quantity, unit

ROOT = Path(eom.__file__).parent
FILES = [
    *(ROOT / "checker/judge").glob("*.py"),
    *(ROOT / "checker/note").glob("*.py"),
    *(ROOT / "checker/mean" / f"{n}.py" for n in ("calculus", "claims", "elaborate", "elaborator")),
    *(ROOT / "checker/mean" / f"{n}.py" for n in ("instants", "numbers", "values", "dimensions")),
    *(ROOT / "worlds" / f"{n}.py" for n in ("evaluate", "solutions")),
]
ELSEWHERE = (
    *("no process for checking", "unusable number of workers", "no line of this note can be kept"),
    "no note can say this",
    *("a line that is not judged true", "this line cannot be verified without the note"),
)
"""Errors that are no reasons of a line."""
INTERNAL = {"atom", "world", "worlds", "head", "expr", "der", "term", "node"}


def _texts(node):
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [node.value]
    if isinstance(node, ast.JoinedStr):
        parts = (v.value if isinstance(v, ast.Constant) else "{}" for v in node.values)
        return ["".join(parts)]
    return _texts(node.body) + _texts(node.orelse) if isinstance(node, ast.IfExp) else []


def _raised(call):
    """Yield the reasons in a call that leaves something undecided."""
    name = getattr(call.func, "id", getattr(call.func, "attr", ""))
    first = getattr(call.args[0], "id", "") if call.args else ""
    if name in {"refuse", "Finding"} and first == "UNDECIDED":
        yield from _texts(call.args[1])
    elif name == "Judgement" and first == "UNDECIDED":
        yield from (t for k in call.keywords if k.arg == "reason" for t in _texts(k.value))
    elif name == "InputError" and call.args:
        yield from _texts(call.args[0])


CAUSES = sorted(
    {
        text
        for file in FILES
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.Call)
        for text in _raised(node)
        if not text.startswith(ELSEWHERE)
    }
)


def test_causes_are_found():
    assert len(CAUSES) > 80


@pytest.mark.parametrize("cause", CAUSES)
def test_each_cause_says_what_would_decide_it(cause):
    assert not decided_by(cause).endswith(SAME)
    assert not INTERNAL & set(cause.replace(";", " ").split())


def test_a_beginning_stands_once():
    begins = [b for row in DECIDES.values() for b in row]
    assert len(begins) == len(set(begins))


def test_terms_are_described_in_words():
    for term in (
        omega(),
        der(omega()),
        column(omega(), "B"),
        quantity("inertia", "C"),
        unit("B", 1),
    ):
        assert described(term) not in {*HEADS, "atom", "expr"}


NOTES = {
    r"$$S = 2 m \dot x$$": "a line of the lexicon: 'S'",
    r"$$\lim_{m \to 0} m = 0$$": "to decide it: ",
    r"$$m = \sum_{i=1}^{7} i$$": "to decide it: ",
}


@pytest.mark.parametrize("note", NOTES)
def test_reports_say_it(note, tmp_path):
    lexicon = tmp_path / "note.toml"
    lexicon.write_text("[symbols]\n'm' = 'mass body'\n'x' = 'coordinate x'\n")
    assert parse_lexicon(lexicon.read_text())
    (found,) = check_note(note_of(note), Settings(lexicon=str(lexicon))).findings
    assert found.verdict == "undecided"
    assert NOTES[note] in found.reason
