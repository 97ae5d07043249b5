"""Notes that the checker was not made with, each judged by explicit motions in SymPy beforehand.

``unseen/NAME.md`` (``.tex``, ``.ipynb``) with ``NAME.lexicon.toml`` or front matter; ``truth.json`` as in
`benchmarks.checking`; ``oracle_NAME.py``: both sides of every equation as written, and as corrected.
"""

import importlib
import json
from pathlib import Path

import pytest

from benchmarks.checking import of_note
from tests.eom.checker.unseen.motions import FALSE, TRUE, distance
from tests.eom.rows import only

FOLDER = Path(__file__).with_name("unseen")
TRUTH = {row["id"]: row for row in json.loads((FOLDER / "truth.json").read_text(encoding="utf-8"))}
NOTES = sorted({name.split(":")[0] for name in TRUTH})
SHORT = ("arm", "euler_rates", "quaternions", "solids")
"""Notes that take little time, of different subjects."""


def oracle(name):
    return importlib.import_module(f"tests.eom.checker.unseen.oracle_{name}").CASES


@pytest.mark.sparse(only=("solids",), slow=SHORT)
@pytest.mark.parametrize("name", NOTES)
def test_the_truth_is_that_of_explicit_motions(name):
    rows = {k.split(":")[1]: row for k, row in TRUTH.items() if k.startswith(f"{name}:")}
    claims = {k for k, row in rows.items() if row["verdict"] != "not_an_equation"}
    cases = oracle(name)
    assert set(cases) == claims
    for key, case in cases.items():
        as_written = distance(case.written)
        if rows[key]["verdict"] == "wrong":
            assert as_written > FALSE, key
            assert distance(case.corrected) < TRUE, key
            assert rows[key]["correction"] != rows[key]["latex"]
        else:
            assert as_written < TRUE, key


REACHED = {
    "arm": 25,
    "control": 21,
    "euler_rates": 22,
    "gravity_gradient": 18,
    "gyrostat": 16,
    "heavy_top": 21,
    "kane": 25,
    "moving_point": 21,
    "particles": 23,
    "quaternions": 22,
    "rodrigues": 19,
    "solids": 13,
    "transport": 20,
    "wheel": 22,
}
"""How many equations of each note have been judged rightly; no change may make them fewer."""


@pytest.mark.parametrize("name", only(NOTES, "quaternions", "solids"))
def test_no_line_is_judged_falsely_and_no_fewer_are_decided(name):
    """No true line is called wrong, and no wrong one said to hold always."""
    rows = list(of_note(FOLDER, name))
    assert [r.entry.name for r in rows if r.false_alarm] == []
    wrong = [r for r in rows if r.entry.verdict == "wrong"]
    assert [r.entry.name for r in wrong if r.ours in {"holds", "definition"}] == []
    undecided = [
        f"{r.entry.name}: {r.ours}: {r.reason.splitlines()[:1]}" for r in rows if not r.right
    ]
    assert sum(r.right for r in rows) >= REACHED[name], "\n".join(undecided)


def test_half_of_the_displays_carry_a_slip():
    wrong = {name: [] for name in NOTES}
    for name, row in TRUTH.items():
        if ":E" in name:
            wrong[name.split(":")[0]].append(row["verdict"] == "wrong")
    shares = {name: sum(w) / len(w) for name, w in wrong.items()}
    assert all(0.4 < share < 0.6 for share in shares.values()), shares
    total = [w for found in wrong.values() for w in found]
    assert sum(total) >= len(total) / 2


CORRECTED = {"arm": 10, "moving_point": 6, "particles": 11}
"""How many wrong lines of some notes have the stored correction first; all: `benchmarks.checking`."""


@pytest.mark.slow
@pytest.mark.parametrize("name", CORRECTED)
def test_no_fewer_corrections_come_first(name):
    rows = [r for r in of_note(FOLDER, name, corrections=True) if r.caught and r.kind == "display"]
    other = [r.entry.name for r in rows if r.rank != 1]
    assert sum(r.rank == 1 for r in rows) >= CORRECTED[name], other
