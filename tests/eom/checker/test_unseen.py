"""Notes that the checker was not made with, each judged by explicit motions in SymPy beforehand.

``unseen/NAME.md`` (``.tex``, ``.ipynb``) with ``NAME.lexicon.toml`` or front matter; ``truth.json`` as in
`benchmarks.checking`; ``oracle_NAME.py``: both sides of every equation as written, and as corrected.
"""

import importlib
import json
from pathlib import Path

import pytest

from tests.eom.checker.unseen.motions import FALSE, TRUE, distance

FOLDER = Path(__file__).with_name("unseen")
TRUTH = {row["id"]: row for row in json.loads((FOLDER / "truth.json").read_text(encoding="utf-8"))}
NOTES = sorted({name.split(":")[0] for name in TRUTH})


def oracle(name):
    return importlib.import_module(f"tests.eom.checker.unseen.oracle_{name}").CASES


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
