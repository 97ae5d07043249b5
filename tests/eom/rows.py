"""Which rows of a table the default suite takes; all others are slow."""

import pytest

from eom.derivations import names

DERIVED = ("point-mass", "transport-theorem", "euler-equations", "inertia-of-rod")
"""Derivations that are quickly made: of each kind one."""


def derivations():
    """Parameters of a test of every derivation: those of `DERIVED`, and the others as slow ones."""
    return only(names(), *DERIVED)


def only(rows, *kept):
    """Parameters of a test: the rows ``kept``, all among ``rows``, and the others as slow ones."""
    rows = _known(rows, kept)
    return [row if row in kept else _slow(row) for row in rows]


def but(rows, *slow):
    """Parameters of a test: all rows, those in ``slow``, which are among them, as slow ones."""
    rows = _known(rows, slow)
    return [_slow(row) if row in slow else row for row in rows]


def every(step, rows):
    """Parameters of a test: every ``step``-th row from the first, and the others as slow ones."""
    return [_slow(row) if k % step else row for k, row in enumerate(rows)]


def long_too(rows, *long):
    """Parameters of a test, those in ``long``, which are slow ones, with the mark `long` besides."""
    marked = {r.values[0]: r for r in rows if hasattr(r, "values")}
    _known(marked, long)
    return [
        pytest.param(*r.values, marks=(*r.marks, pytest.mark.long))
        if r in [marked[name] for name in long]
        else r
        for r in rows
    ]


def _known(rows, named):
    rows = list(rows)
    missing = [row for row in named if row not in rows]
    assert not missing, f"no such rows: {missing}"
    return rows


def _slow(row):
    values = row if isinstance(row, tuple) else (row,)
    return pytest.param(*values, marks=pytest.mark.slow)
