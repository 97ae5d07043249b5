"""The map walks every displayed equation and claim of the lectures to steps that state them."""

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

LECTURED = [n for n in names() if not n.startswith("inertia-of-")]


def is_stated(entry):
    """Whether each step of an entry states it with evidence; what is no equation has a note alone."""
    if entry.identifier in NO_EQUATION:
        return entry.steps == () and bool(entry.note)
    steps = [derive(name)[label] for name, label in entry.steps]
    return bool(steps) and all(entry.identifier in s.states and s.evidence for s in steps)


def tags(made):
    """What the steps of derivations say that they state."""
    return {t for n in made for s in derive(n).steps for t in s.states}


def test_each_is_stated_by_a_verified_step_and_every_tag_is_in_the_map():
    found = equation_map()
    assert list(found) == identifiers()
    assert [i for i, entry in found.items() if not is_stated(entry)] == []
    assert tags(LECTURED) == set(identifiers()) - set(NO_EQUATION)
    assert found["001:E11"].note.startswith("row 2 lacks")


@pytest.mark.slow
def test_solids_state_nothing_of_the_lectures():
    assert tags(set(names()) - set(LECTURED)) == set()


def test_numbers_and_notes_belong_to_equations():
    assert sum(DISPLAYS.values()) == 92
    assert set(NUMBERS) | set(NOTES) | set(NO_EQUATION) | set(CLAIMS) <= set(identifiers())
    assert NUMBERS["002:E16"] == "(3.15)"
    assert NUMBERS["002:E39"] == "(3.36c)"
    assert len(NUMBERS) == 38
