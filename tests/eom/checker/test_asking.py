"""Questions to the writer of a note, as data and at a terminal: nothing that was said or held is lost."""

import json
from dataclasses import replace

import click
import pytest
from click.testing import CliRunner

import eom
from eom.checker.infer import asking
from eom.checker.note.checking import judged_document
from eom.checker.read.documents import read_document
from eom.checker.report.findings import Settings
from eom.commands import asking as command
from eom.commands.checking import check
from eom.errors import InputError

NOTE = r"""A pendulum of length $l$ and mass $m$ swings by the angle $\theta$ from the vertical:

$$ \ddot\theta = -\frac{g}{l}\sin\theta $$

Its period for small angles is

$$ T = 2\pi\sqrt{\frac{l}{g}} $$

$$ q = l\dot\theta $$

$$ Y = q^2 m $$

$$ A = \frac12 Y - m g l\cos\theta $$
"""


@pytest.fixture
def note(tmp_path):
    path = tmp_path / "note.md"
    path.write_text(NOTE, encoding="utf-8")
    return path


def ask(path, text, *options):
    return CliRunner().invoke(check, [str(path), "--ask", *options], input=text)


def displays(path):
    return {f.line: f.verdict for f in eom.check(path).findings if f.kind == "display"}


def test_what_makes_open_lines_hold_comes_first_and_what_fits_none_is_left_out():
    asked = {q.latex: q for q in eom.check(NOTE).questions}
    assert next(iter(asked)) == "q"
    first = asked["q"].candidates[0]
    assert (first.meaning, first.words) == ("system v", "speed")
    assert "line 9 then holds" in first.why
    assert {c.meaning for c in asked["q"].candidates} == {"system v", "defined"}
    assert "g" not in asked, "lines hold with it"


def test_later_questions_know_earlier_answers():
    whole = judged_document(read_document(NOTE), Settings())
    draft = asking.answered(whole.known.draft, "q", "system v")
    again = {q.latex: q for q in asking.questions(whole.open, draft, whole.held)}
    assert "q" not in again
    of_energy = {"system T", "system V", "system L", "system E", "system H"}
    of_energy |= {"system tau"}
    meanings = {c.meaning for c in again["Y"].candidates}
    assert meanings == {*of_energy, "defined"}, "others have another dimension"
    assert "q" not in [latex for latex, _ in draft.unplaced]


def test_a_letter_with_dots_is_not_defined_by_its_line():
    asked = {
        q.latex: q for q in eom.check(r"$$ \ddot\chi = 3\psi + \chi $$" + "\n\nWords.").questions
    }
    assert "defined" not in [c.meaning for c in asked[r"\chi"].candidates]


def test_an_answer_decides_more_and_loses_nothing(note):
    before = displays(note)
    shown = ask(note, "1\n1\nq\n")
    assert shown.exit_code == 1, "Y = q^2 m is wrong for the kinetic energy"
    after = displays(note)
    assert all(after[k] == "holds" for k, v in before.items() if v == "holds")
    assert (after[9], after[11]) == ("holds", "wrong")


def test_questions_leave_standard_output_to_the_report(note):
    shown = ask(note, "1\n", "--json")
    (report,) = json.loads(shown.stdout)["notes"]
    assert report["drafts"] == []
    assert "what is q?" in shown.stderr


def test_what_was_said_is_kept_when_interrupted(note, monkeypatch):
    answers = iter(["1"])

    def prompt(*_, **__):
        try:
            return next(answers)
        except StopIteration:
            pass
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt:
            raise click.Abort from None

    monkeypatch.setattr(click, "prompt", prompt)
    with pytest.raises(KeyboardInterrupt):
        command.lexicon_asked([note], Settings())
    written = note.with_name("note.lexicon.toml").read_text(encoding="utf-8")
    assert "'q' = \"v\"  # as the writer says" in written


def test_a_folder_that_cannot_be_written_to_is_told_before_any_question(note, monkeypatch):
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(InputError, match="no lexicon can be written"):
        command.lexicon_asked([note], Settings())


def test_what_cannot_be_written_is_shown(note, monkeypatch):
    def refuse(*_):
        raise OSError("disk full")

    monkeypatch.setattr("codegen.compiling.compiled.write_files", refuse)
    shown = ask(note, "1\nq\n")
    assert isinstance(shown.exception, OSError)
    assert "'q' = \"v\"  # as the writer says" in shown.stderr


@pytest.mark.parametrize("text", ["", "Nothing but words.\n", "$$ F = m a $$\n"])
def test_without_open_lines_nothing_is_asked(tmp_path, text):
    path = tmp_path / "note.md"
    path.write_text(text, encoding="utf-8")
    shown = ask(path, "1\n")
    assert "nothing is open" in shown.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["note.md"]


def test_a_guess_that_nobody_confirms_stays_only_where_lines_hold_with_it():
    whole = judged_document(read_document(NOTE), Settings())
    (asked,) = [q for q in whole.questions if q.latex == "A"]
    draft = whole.known.draft
    assert "'A' = " not in asking.left_open(draft, asked).toml
    held = replace(asked, holds=(3, 7))
    assert asking.left_open(draft, held) is draft


def test_answers_in_python_decide_more_lines():
    first, *_ = eom.check(NOTE).questions
    report = eom.check(NOTE, answers={first.latex: first.candidates[0], "A": "system E"})
    verdicts = {f.line: f.verdict for f in report.findings if f.kind == "display"}
    assert (verdicts[3], verdicts[7], verdicts[9]) == ("holds", "holds", "holds")
    assert report.lexicon.endswith("and answers")
    assert not {"q", "A"} & {q.latex for q in report.questions}


@pytest.mark.parametrize(
    ("answers", "settings", "match"),
    [
        ({"q": "speedy"}, {}, "unknown quantity"),
        ({"q": "system nothing"}, {}, "unknown quantity"),
        ({"q q": "scalar q"}, {}, "."),
        ({"q": "scalar q"}, {"notation": "kane"}, "answers go before a draft"),
        ({"q": 3}, {}, "answers"),
    ],
)
def test_answers_that_are_none(answers, settings, match):
    with pytest.raises(InputError, match=match):
        eom.check(NOTE, answers=answers, **settings)
