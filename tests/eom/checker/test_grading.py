"""Many notes in processes: order, isolation, tables; JSON by its schema."""

import csv
import io
import json
import multiprocessing as mp
import os
import signal
from importlib import resources
from pathlib import Path

import pytest

import eom
from eom.checker.note import grading
from eom.checker.note.checking import grade
from eom.checker.read.documents import Text, notes_of
from eom.checker.read.spans import Source, Span
from eom.checker.report.findings import (
    COLUMNS,
    ORDER,
    Correction,
    Counterexample,
    Explanation,
    Finding,
    Graded,
    Remark,
    Report,
    Settings,
    report_lines,
    shown,
    text,
    to_csv,
    to_json,
    to_table_json,
    total,
)
from eom.errors import InputError
from tests.eom.rows import only

ARROWS = Settings("arrow-tilde")
RIGHT, WRONG = r"$\vec H_C = I_C\vec\omega$", r"$\vec H_C = I_C\vec\omega + I_C\vec\omega$"


@pytest.fixture
def folder(tmp_path):
    for k, note in enumerate([RIGHT, WRONG, RIGHT, "no formula"]):
        (tmp_path / f"{k}.md").write_text(note)
    (tmp_path / "4.md").write_bytes(b"\0")
    (tmp_path / "5.ipynb").write_text("{}")
    return tmp_path


def statuses(graded):
    return [g.status for g in graded]


ALL = ["nothing wrong", "wrong", "nothing wrong", "nothing wrong", "unusable", "unusable"]


@pytest.mark.parametrize("workers", only([1, 2, 3], 2))
def test_notes_come_in_order_whatever_the_number_of_workers(folder, workers):
    done = []
    graded = eom.check_files([folder, WRONG], ARROWS, workers=workers, progress=done.append)
    assert statuses(graded) == [*ALL, "wrong"]
    assert [Path(g.name).name for g in graded[:-1]] == sorted(p.name for p in folder.iterdir())
    assert done == [k / 7 for k in range(1, 8)]
    assert graded == tuple(grade(note, ARROWS) for note in notes_of([folder, Text(WRONG)]))
    assert "binary" in graded[4].error
    assert mp.active_children() == []


@pytest.mark.parametrize("sent", only([signal.SIGKILL, signal.SIGSTOP], signal.SIGKILL))
def test_a_worker_that_dies_or_hangs_loses_one_note(folder, monkeypatch, sent):
    monkeypatch.setattr(grading, "GRACE_SECONDS", 0.0)
    hurried = Settings("arrow-tilde", note_seconds=2.5)

    def strike(fraction):
        if fraction == 1 / 4:
            (worker,) = mp.active_children()
            os.kill(worker.pid, sent)

    notes = [folder / f"{k}.md" for k in range(4)]
    graded = eom.check_files(notes, hurried, workers=1, progress=strike)
    assert statuses(graded) == ["nothing wrong", "unusable", "nothing wrong", "nothing wrong"]
    assert graded[1].name == str(notes[1])
    words = "died" if sent == signal.SIGKILL else "no answer within 5 s"
    assert words in graded[1].error
    assert mp.active_children() == []


def test_what_cannot_be_used_is_refused_before_a_process_starts(monkeypatch):
    monkeypatch.setattr(grading, "_started", None)
    with pytest.raises(InputError, match="unknown assumption"):
        eom.check_files([RIGHT], Settings(given=("nothing",)))
    assert eom.check_files([], ARROWS) == ()


def test_no_note_ends_the_checking_of_others(monkeypatch):
    from eom.checker.note import checking

    def broken(*_):
        raise KeyError("seed")

    monkeypatch.setattr(checking, "verdict", broken)
    graded = checking.grade(Text(RIGHT), ARROWS)
    assert graded.error == "this note could not be checked: KeyError: 'seed'; please report it"


# -- data ------------------------------------------------------------------------------------------

SOURCE = Source("so\n$$a = \x1b[31mb$$\n", "n.md, cell 2")
FULL = Finding(
    1,
    "display",
    SOURCE,
    Span(5, 16),
    "a = b",
    "wrong",
    reason="it fails",
    place=Span(9, 16),
    read_as=("read as: b",),
    remarks=(Remark("needs", "what stands four lines later", 9),),
    explanation=Explanation(
        "a - b",
        (Span(9, 10),),
        (Correction("a = -b", "sign of b", "sign", Span(9, 10), "-b", (("rigid",),)),),
        Counterexample((("a", "1"), ("b", "2")), (("a", "1"), ("b", "2")), ("rigid",)),
        "the other order of rotations",
    ),
    carried=3,
)
REPORT = Report(
    "n.md",
    (FULL,),
    "draft on preset kane",
    ("q: angle q (line 1: x)",),
    ("z",),
    ("constant_mass",),
    (Remark("not read", "commands", 2),),
)
NOTES = (Graded("n.md", REPORT), Graded("=cmd|x.md", None, "the file is binary"))


def validate(data):
    jsonschema = pytest.importorskip("jsonschema")
    file = resources.files("eom.checker.report") / "report.schema.json"
    schema = json.loads(file.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.Draft202012Validator(schema).validate(data)


def test_json_follows_its_schema_to_the_last_part():
    data = json.loads(to_json(NOTES))
    validate(data)
    found = data["notes"][0]["findings"][0]
    assert found["place"] == {"line": 2, "column": 3, "last_line": 2, "last_column": 13}
    assert found["at"]["column"] == 7
    assert found["explanation"]["corrections"][0]["sets"] == [["rigid"]]
    assert found["explanation"]["counterexample"]["members"] == [["a", "1"], ["b", "2"]]
    assert "findings" not in data["notes"][1]


@pytest.mark.parametrize(
    "change",
    [
        {"version": 3},
        {"more": 1},
        {"notes": [{"name": "n", "status": "unusable", "error": ""}]},
        {"notes": [{"name": "n", "status": "wrong", "error": ""}]},
    ],
)
def test_the_schema_refuses_what_is_not_a_report(change):
    jsonschema = pytest.importorskip("jsonschema")
    with pytest.raises(jsonschema.ValidationError):
        validate(json.loads(to_json(NOTES)) | change)


def test_tables_have_a_row_for_each_note_and_no_formulas_for_spreadsheets():
    first, second = csv.DictReader(io.StringIO(to_csv(NOTES)))
    assert tuple(first) == COLUMNS
    assert (first["note"], first["wrong"], first["equations"]) == ("n.md", "1", "1")
    assert first["first_fault"] == "2"
    assert (second["note"], second["status"]) == ("'=cmd|x.md", "unusable")
    rows = json.loads(to_table_json(NOTES))
    assert [r["note"] for r in rows] == ["n.md", "=cmd|x.md"]
    assert set(ORDER) < set(rows[0])


# -- text ------------------------------------------------------------------------------------------


def test_text_shows_everything_and_nothing_that_a_terminal_acts_on():
    lines = [text(line) for line in report_lines(NOTES[0])]
    assert all(line.isprintable() for line in lines)
    shown = "\n".join(lines)
    for part in (
        "draft on preset kane",
        "Nobody has confirmed",
        "q: angle q",
        "without a meaning: z",
        "given: constant_mass",
        "line 2, not read: commands",
        "cell 2, line 2: wrong",
        "why: it fails",
        "carries forward the slip of line 3",
        "read as: b",
        "left side minus right side: a - b",
        "the other order of rotations",
        "repair: sign of b, under {rigid}",
        "it fails for a = 1, b = 2, under {rigid}",
        "needs: what stands four lines later",
        "rigid  the distance of any two points",
        "1 equation: 1 wrong",
    ):
        assert part in shown, part
    at = lines.index(next(line for line in lines if "^" in line))
    assert lines[at - 1] == "    $$a =  [31mb$$"
    assert lines[at] == "          ^^^^^^^"


def carets(source, span, *places):
    return [text(line) for line in shown(source, span, places)]


def test_carets_stand_under_every_place_of_a_formula():
    source = Source("$$a = b\n + c$$ x")
    span = Span(2, 12)
    assert carets(source, span) == ["    $$a = b", "     + c$$ x"]
    assert carets(source, span, Span(2, 3), Span(6, 7), Span(11, 12)) == [
        "    $$a = b",
        "      ^   ^",
        "     + c$$ x",
        "       ^",
    ]
    assert carets(source, span, Span(7, 7))[1] == "           ^"
    assert carets(source, span, Span(2, 12))[1] == "      ^^^^^"


def test_of_a_long_line_or_formula_what_is_near_the_place_is_shown():
    source = Source("a" * 500 + "=b")
    line, marks = carets(source, Span(0, 502), Span(501, 502))
    assert len(line) < 80
    assert line[marks.index("^")] == "b"
    many = Source("\n".join(f"+ a_{{{k}}}" for k in range(400)))
    place = Span(many.text.index("a_{300}"), many.text.index("a_{300}") + 7)
    lines = carets(many, Span(0, len(many.text)), place)
    assert len(lines) < 40
    assert lines[lines.index("    + a_{300}") + 1] == "      ^^^^^^^"


def test_a_wrong_formula_in_a_line_of_prose_is_marked():
    graded = grade(Text("So $\\vec H_C = 2 I_C\\vec\\omega$ holds."), ARROWS)
    lines = [text(line) for line in report_lines(graded)]
    at = next(k for k, line in enumerate(lines) if "^" in line)
    start, stop = (lines[at - 1].index(part) for part in ("\\vec H_C", "$ holds"))
    assert set(lines[at][:start]) | set(lines[at][stop:]) <= {" "}
    assert lines[at][start:stop].strip(" ^") == ""


def test_only_and_quiet_leave_out():
    assert not any("why" in text(line) for line in report_lines(NOTES[0], only=["holds"]))
    assert any("why" in text(line) for line in report_lines(NOTES[0], quiet=True))
    assert "binary" in [text(line) for line in report_lines(NOTES[1])][1]
    assert text(total(NOTES)) == (
        "2 notes: 0 with nothing wrong, 1 with something wrong, 1 unusable"
    )
