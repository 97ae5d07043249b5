"""The system of a note from its words and letters; questions to the writer."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

import eom
from benchmarks.checking import alone, read_truth
from eom.checker.infer.asking import SYSTEM, answered
from eom.checker.infer.draft import meanings, propose
from eom.checker.infer.systems import Tie, descriptions, guesses, rows
from eom.checker.mean.lexicon import MATRICES
from eom.checker.mean.lexicon_files import parse_lexicon
from eom.checker.read.documents import read_document
from eom.checker.read.symbol_shape import Look
from eom.commands.checking import check
from eom.errors import InputError
from tests.eom.rows import only

ELEMENTARY = Path("benchmarks/notes/elementary")
STUDENTS = Path("benchmarks/notes/students")
LEFT = {"line:12", "line:25", "slip:4", "slip:8"}
"""Lines of students that are undecided."""

PENDULUM = r"""
# A pendulum

A bob of mass $\mu$ hangs on a string of length $\ell$. $\chi$ is the angle from the vertical, $g$ the
acceleration of gravity. $E$ is the energy.

$$ V = -\mu g \ell \cos\chi $$

$$ \ddot\chi = -\frac{g}{\ell}\sin\chi $$

$$ Z = \mu g\cos\chi + \mu\ell\dot\chi^2 $$

$$ E = \frac12\mu\ell^2\dot\chi^2 %s \mu g\ell\cos\chi $$

$$ q = \ell\dot\chi $$
"""


def verdicts(text):
    return [f.verdict for f in eom.check(text).findings if f.kind == "display"]


def test_a_pendulum_is_found_from_words_whatever_its_letters():
    report = eom.check(PENDULUM % "-")
    assert [f.verdict for f in report.findings][-5:] == [*["holds"] * 4, "undecided"]
    assert "the bob swings about a fixed pivot on a string" in report.lexicon
    assert any(str(d).startswith(r"\chi: angle (line 4: 'the angle") for d in report.drafts)
    assert verdicts(PENDULUM % "+")[3] == "wrong"


UPSIDE_DOWN = r"""
A pendulum of mass $m$ and length $l$ stands upside down: $\theta$ is its angle from the upward vertical.

$$ V = m g l \cos\theta $$

$$ \ddot\theta = \frac{g}{l}\sin\theta $$
"""


def test_an_angle_is_counted_as_the_lines_of_the_note_need_it():
    assert verdicts(UPSIDE_DOWN) == ["holds", "holds"]


LADEN = r"""
A mass $m$ hangs on a spring of stiffness $k$%s; $x$ is its displacement.

$$ m\ddot x%s + k x = 0 $$

$$ E = \frac12 m\dot x^2 + \frac12 k x^2 $$
"""


def test_what_has_no_letter_in_the_note_is_absent():
    assert verdicts(LADEN % ("", "")) == ["holds", "holds"]
    damped = LADEN % (r" with a damper of the damping constant $c$", r" + c\dot x")
    assert verdicts(damped) == ["holds", "holds"]


def test_a_line_that_fails_is_unsure_while_nothing_else_speaks_for_the_system():
    (found,) = eom.check("F = 2 m a").findings
    assert found.verdict == "unsure"
    assert found.reason.startswith("if the note is about a force on a body")
    assert [f.verdict for f in eom.check("F = 2 m a", strict=True).findings] == ["wrong"]


KEPLER = r"""
A planet of mass $m$ moves about a fixed star; $\mu$ is the gravitational constant times its mass. $r$ is
the distance and $\varphi$ the angle, $h$ the angular momentum per unit of mass.

$$ h = r^2\dot\varphi $$

$$ \ddot r = \frac{h^2}{r^3} - \frac{\mu}{r^2} $$

$$ r\dot\varphi\varphi = \frac{h}{r}\varphi^2 $$
"""


def test_a_line_with_an_angle_that_no_law_counts_is_unsure():
    """The zero of a cyclic coordinate is the writer's."""
    assert verdicts(KEPLER) == ["holds", "holds", "unsure"]


SEVERAL = r"""
## A pendulum

A pendulum has the mass $m$ and the length $l$. $\theta$ is its angle.

$$ \ddot\theta = -\frac{g}{l}\sin\theta $$

$$ T = \frac12 m l^2\dot\theta^2 $$

## Atwood's machine

Two masses $m_1$ and $m_2$ hang on a string over a light pulley; $a$ is the acceleration of the first.

$$ a = \frac{m_1 - m_2}{m_1 + m_2}\,g $$
"""


def test_every_part_has_its_own_system():
    draft = propose(read_document(SEVERAL))
    names = {s.name: s.headings for s in draft.systems}
    assert names["two masses on a string over a pulley"] == ("Atwood's machine",)
    assert verdicts(SEVERAL) == ["holds", "holds", "holds"]


@pytest.mark.parametrize("row", only(list(rows()), rows()[0]), ids=lambda r: r.name)
def test_every_system_of_the_table_is_one_and_has_its_quantities(row):
    look = Look("x")
    ties = tuple(Tie(look, x.means, "", 0) for x in row.letters)
    (guess, *_) = guesses(row, ties, "", "", turned=False)
    for letter in row.letters:
        if letter.means not in {*MATRICES, *row.sizes[:1]}:
            assert guess.model().meaning(letter.means)[0]


def test_ways_to_count_an_angle_are_other_systems():
    row = next(r for r in rows() if r.name == "a simple pendulum")
    tables = [repr(t) for t in descriptions(row, (), "")]
    assert len(tables) == len(set(tables)) == 8


@pytest.mark.parametrize("strict", [True, False])
def test_elementary_lines_need_no_setup(strict):
    """Forty lines and slips in them, as formulas; the whole table is the benchmark's."""
    entries = list(read_truth(ELEMENTARY / "truth.json").values())
    kept = entries[:: 6 if strict else 9]
    for entry in kept:
        (found,) = eom.check(entry.latex, kind="formula", strict=strict).findings
        wrong = "wrong" if strict else "unsure"
        assert found.verdict == (wrong if entry.verdict == "wrong" else "holds"), entry.latex


@pytest.mark.parametrize("strict", [True, False])
def test_lines_of_students(strict):
    entries = [e for e in read_truth(STUDENTS / "truth.json").values() if e.name not in LEFT]
    for entry in entries[:: 5 if strict else 11]:
        (found,) = eom.check(entry.latex, kind="formula", strict=strict).findings
        wrong = "wrong" if strict else "unsure"
        assert found.verdict == (wrong if entry.verdict == "wrong" else "holds"), entry.latex


@pytest.mark.slow
def test_all_lines_of_students():
    found = [r for r in alone(STUDENTS, strict=True) if not r.right]
    assert {r.entry.name for r in found} <= LEFT
    assert not [r for r in found if r.false_alarm]


def test_time_alone_on_a_side_is_an_instant():
    for latex, verdict in (
        (r"t = \frac{2 v_0\sin\alpha}{g}", "holds"),
        (r"t = \sqrt{\frac{2 h}{g}}", "holds"),
        (r"t = \frac{v_0\sin\alpha}{3 g}", "unsure"),
    ):
        (found,) = eom.check(latex).findings
        assert found.verdict == verdict, latex


@pytest.mark.slow
def test_all_elementary_lines():
    found = list(alone(ELEMENTARY, strict=True))
    assert not [r.entry.latex for r in found if not r.right]


# -- the draft, and asking -----------------------------------------------------------------------


@pytest.mark.parametrize("text", [PENDULUM % "-", UPSIDE_DOWN, SEVERAL, KEPLER])
def test_the_draft_reads_back_to_the_same_meanings(text):
    document = read_document(text)
    drafted, draft = meanings(document).lexicon, propose(document)
    again = parse_lexicon(draft.toml)
    for one in draft.systems:
        here, there = drafted.at(one.headings), again.at(one.headings)
        for tie in one.ties:
            assert here.find(tie.look).meaning == there.find(tie.look).meaning
    for entry in draft.drafts:
        assert entry.latex in draft.toml


def test_open_meanings_are_data():
    (question,) = eom.check(PENDULUM % "-").questions
    assert question.latex == "q"
    assert question.lines == (15,)
    assert f"{SYSTEM}v" in [c.meaning for c in question.candidates]
    assert str(question).startswith("what is q?")


def test_an_answer_is_an_entry_of_the_draft():
    draft = propose(read_document(PENDULUM % "-"))
    assert "'q' = \"v\"" in answered(draft, "q", f"{SYSTEM}v").toml
    assert "'q' = \"scalar q\"" in answered(draft, "q", "scalar q").toml
    with pytest.raises(InputError, match="unknown quantity"):
        answered(draft, "q", f"{SYSTEM}nothing")


def asked(note, text):
    return CliRunner().invoke(check, [str(note), "--ask"], input=text)


def test_the_command_asks_and_writes_a_lexicon(tmp_path):
    note = tmp_path / "note.md"
    note.write_text(PENDULUM % "-", encoding="utf-8")
    shown = asked(note, "99\nsystem v\n")
    assert shown.exit_code == 0, shown.output
    assert "no such number" in shown.output
    lexicon = tmp_path / "note.lexicon.toml"
    assert "'q' = \"v\"  # as the writer says" in lexicon.read_text(encoding="utf-8")
    assert [f.verdict for f in eom.check(note).findings if f.kind == "display"] == ["holds"] * 5
    again = asked(note, "")
    assert isinstance(again.exception, InputError)
    assert "this note has a lexicon" in str(again.exception)


def test_questions_end_where_the_writer_says_so(tmp_path):
    note = tmp_path / "note.md"
    note.write_text(PENDULUM % "-", encoding="utf-8")
    for said in ("q\n", "", "\n"):
        shown = asked(note, said)
        assert shown.exit_code == 0
        assert "nothing was said" in shown.output
        assert not (tmp_path / "note.lexicon.toml").exists()


GUESSED_PERIOD = r"""A thin uniform rod of mass $M$ and length $L$ hangs from a pin at its upper end.
$\alpha$ is its angle from the downward vertical and $g$ the acceleration of gravity.

$$ \ddot\alpha = -\frac{3 g}{2 L}\sin\alpha $$

$$ \tau = 2\pi\sqrt{\frac{3 L}{2 g}} $$

$$ q = \alpha $$
"""


def test_what_the_writer_leaves_open_stays_a_guess(tmp_path):
    note = tmp_path / "note.md"
    note.write_text(GUESSED_PERIOD, encoding="utf-8")
    guessed = [f.verdict for f in eom.check(note).findings if f.kind == "display"]
    assert guessed[1] == "unsure"
    answers = {r"what is \tau": "", "what is q": "scalar q"}
    order = sorted(answers, key=asked(note, "\n\n").output.index)
    shown = asked(note, "".join(f"{answers[a]}\n" for a in order))
    assert shown.exit_code == 0, shown.output
    text = (tmp_path / "note.lexicon.toml").read_text(encoding="utf-8")
    assert "'q' = \"scalar q\"" in text
    assert r"'\tau'" not in text
    assert r"#   \tau  (line 6)" in text
    verdicts = [f.verdict for f in eom.check(note).findings if f.kind == "display"]
    assert verdicts[:2] == ["holds", "undecided"]


def test_the_report_as_json_has_the_questions():
    note = CliRunner().invoke(check, ["--json", "F = 2 m a"])
    (report,) = json.loads(note.output)["notes"]
    assert {q["latex"] for q in report["questions"]} == {"F", "m", "a"}
