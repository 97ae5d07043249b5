"""The map walks every displayed equation and claim of the lectures to steps that state them."""

from functools import cache

import pytest

from eom.derivations import derive, names
from eom.derivations.lectures import (
    CLAIMS,
    DISPLAYS,
    NO_EQUATION,
    NOTES,
    NUMBERS,
    equation_map,
    identifiers,
)


@cache
def mapped():
    """The map, which makes all derivations, once for all tests."""
    return equation_map()


def is_stated(identifier):
    """Whether each step of an entry states it with evidence; what is no equation has a note alone."""
    entry = mapped()[identifier]
    if identifier in NO_EQUATION:
        return entry.steps == () and bool(entry.note)
    steps = [derive(name)[label] for name, label in entry.steps]
    return bool(steps) and all(identifier in s.states and s.evidence for s in steps)


def test_each_is_stated_by_a_verified_step():
    assert [i for i in identifiers() if not is_stated(i)] == []


LECTURED = [n for n in names() if not n.startswith("inertia-of-")]


@pytest.mark.parametrize("made", [LECTURED, pytest.param(names(), marks=pytest.mark.slow)])
def test_every_tag_of_a_step_is_in_the_map(made):
    tags = {t for n in made for s in derive(n).steps for t in s.states}
    assert tags == set(identifiers()) - set(NO_EQUATION)


def test_numbers_and_notes_belong_to_equations():
    assert sum(DISPLAYS.values()) == 92
    assert set(NUMBERS) | set(NOTES) | set(NO_EQUATION) | set(CLAIMS) <= set(mapped())
    assert NUMBERS["002:E16"] == "(3.15)"
    assert NUMBERS["002:E39"] == "(3.36c)"
    assert len(NUMBERS) == 38
    assert mapped()["001:E11"].note.startswith("row 2 lacks")
