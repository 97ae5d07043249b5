"""The measure of the checker, on a small folder with a truth of its own."""

import json

import pytest
from click.testing import CliRunner

from benchmarks.checking import corrected, counted, main, results

LEXICON = r"""
preset = "arrow-tilde"
[symbols]
'\vec a' = 'vector a'
'\vec b' = 'vector b'
"""
NOTE = r"""
The vector $\vec a$ and $\vec a\cdot\vec b = \vec b\cdot\vec a$.

$$\vec a\times\vec b = \vec b\times\vec a$$
$$\vec a\times\vec b = -\vec b\times\vec a$$
$$\vec a = \vec a\cdot\vec b$$
$$\vec a = \vec q$$
"""
TRUTH = [
    ("n:i1", r"\vec a", "not_an_equation"),
    ("n:i2", r"\vec a\cdot\vec b = \vec b\cdot\vec a", "holds"),
    ("n:E1", r"\vec a\times\vec b = \vec b\times\vec a", "wrong"),
    ("n:E2", r"\vec a\times\vec b = -\vec b\times\vec a", "holds"),
    ("n:E3", r"\vec a = \vec a\cdot\vec b", "wrong"),
    ("n:E4", r"\vec a = \vec q", "holds"),
]


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "n.md").write_text(NOTE)
    (tmp_path / "n.toml").write_text(LEXICON)
    return tmp_path


def put(folder, **others):
    """Write the truth, with some verdicts replaced."""
    rows = [
        {"id": i, "latex": t, "verdict": others.get(i[2:], v), "accept": [others.get(i[2:], v)]}
        for i, t, v in TRUTH
    ]
    (folder / "truth.json").write_text(
        json.dumps([*rows, {**rows[0], "id": "n:C1", "latex": None}])
    )


def run(folder):
    return CliRunner().invoke(main, [str(folder), "--lexica", str(folder)])


def test_what_is_decided_missed_and_ill_formed(folder):
    put(folder)
    rows = {r.entry.name: r for r in results(folder, folder)}
    assert set(rows) == {"n:i2", "n:E1", "n:E2", "n:E3", "n:E4"}
    assert (rows["n:E3"].ours, rows["n:E3"].counted) == ("ill-formed", "wrong")
    assert [name for name, r in rows.items() if not r.right] == ["n:E4"]
    output = run(folder)
    assert output.exit_code == 0
    for line in (
        "display: 3 of 4 within",
        "inline: 1 of 1 within",
        "called wrong: 0",
        "otherwise: 1",
    ):
        assert line in output.output
    assert "symbol without a meaning" in output.output


def test_a_true_equation_that_is_called_wrong_is_counted_apart(folder):
    put(folder, E1="holds")
    output = run(folder)
    assert output.exit_code == 1
    assert "true, but called wrong: 1\n  n:E1: wrong, not holds" in output.output


def test_ill_formed_is_a_verdict_of_its_own_where_the_truth_knows_it():
    assert counted("ill-formed", {"wrong", "holds"}) == "wrong"
    assert counted("ill-formed", {"wrong", "ill_formed"}) == "ill_formed"
    assert counted("assumption", {"wrong"}) == "definition"


def test_a_note_that_is_not_that_of_the_truth_is_refused(folder):
    put(folder)
    (folder / "n.md").write_text(NOTE.replace(r"\vec q", r"\vec b"))
    assert "the note is not that of the truth" in str(run(folder).exception)
    (folder / "truth.json").write_text("{")
    assert "cannot be read" in str(run(folder).exception)


def test_entries_by_note_and_index_with_corrections(folder):
    """What is found, passed and repaired, and the notes with the corrections in place of wrong lines."""
    (folder / "n.toml").rename(folder / "n.lexicon.toml")
    row = {"note": "n.md", "also_accept": ["undecided"]}
    right = r"\vec a\times\vec b = -\vec b\times\vec a"
    rows = [
        {**row, "index": k, "latex": t, "verdict": v, "correction": right if k == 1 else None}
        for k, (_, t, v) in enumerate((r for r in TRUTH if ":E" in r[0]), 1)
    ]
    rows[0]["wrong_term"] = r"\vec b\times\vec a"
    (folder / "truth.json").write_text(json.dumps(rows))
    assert {r.kind for r in results(folder, folder)} == {"display"}
    output = run(folder)
    assert output.exit_code == 0
    for line in (
        "decided: 3 of 4",
        "wrong ones found: 2 of 2; for the right reason: 1",
        "wrong ones passed: 0",
        "the correction among the first 3: 1 of 2",
        "with the corrections put in, true but called wrong: 0",
    ):
        assert line in output.output
    again = {r.entry.name: r for r in corrected(folder, folder)}
    assert (again["n:E1"].ours, again["n:E1"].entry.latex) == ("holds", right)
