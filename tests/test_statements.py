"""Sentences of mechanics in prose stand as they are quoted, and what they say is computed."""

import pytest

from tests.statements import ROWS, stands

ENOUGH = 100
TESTS = {row.test: row for row in ROWS}
"""Each test once; one may compute several sentences."""


@pytest.mark.parametrize(
    "test",
    [
        pytest.param(test, id=row.name, marks=[pytest.mark.slow] if row.slow else [])
        for test, row in TESTS.items()
    ],
)
def test_what_a_sentence_says_is_so(test):
    test()


def gone(derived):
    """Return the sentences that do not stand where they are said to, in reasons of derivations or not."""
    rows = (row for row in ROWS if row.where.startswith("derive ") is derived)
    return "\n".join(f"{row.where}: {row.sentence}" for row in rows if not stands(row))


def test_every_sentence_stands_where_its_row_says():
    assert gone(derived=False) == ""


@pytest.mark.slow
def test_every_reason_of_a_derivation_stands_where_its_row_says():
    assert gone(derived=True) == ""


def test_there_are_more_than_a_hundred_and_each_is_entered_once():
    assert len({row.sentence for row in ROWS}) > ENOUGH
    assert len({(row.where, row.sentence) for row in ROWS}) == len(ROWS)
    assert {row.where.split("/")[0].split(" ")[0].split(".")[0] for row in ROWS} >= {
        "docs", "notebooks", "derive", "eom", "README"
    }  # fmt: skip


def test_a_sentence_that_was_changed_is_missed():
    row = next(r for r in ROWS if r.where.endswith(".md"))
    assert not stands(type(row)(row.where, row.sentence + " and more", row.test))
