"""The map walks every displayed equation and claim of the lectures to steps that state them."""

import pytest

from eom.derivations import derive
from eom.derivations.lectures import (
    CLAIMS,
    DISPLAYS,
    NO_EQUATION,
    NOTES,
    NUMBERS,
    equation_map,
    identifiers,
)

MAP = equation_map()


@pytest.mark.parametrize("identifier", identifiers())
def test_each_is_stated_by_a_verified_step(identifier):
    entry = MAP[identifier]
    if identifier in NO_EQUATION:
        assert entry.steps == ()
        assert entry.note
        return
    assert entry.steps
    for name, label in entry.steps:
        step = derive(name)[label]
        assert identifier in step.states
        assert step.evidence


def test_every_tag_of_a_step_is_in_the_map():
    from eom.derivations import names

    tags = {t for n in names() for s in derive(n).steps for t in s.states}
    assert tags == set(identifiers()) - set(NO_EQUATION)


def test_numbers_and_notes_belong_to_equations():
    assert sum(DISPLAYS.values()) == 92
    assert set(NUMBERS) | set(NOTES) | set(NO_EQUATION) | set(CLAIMS) <= set(MAP)
    assert NUMBERS["002:E16"] == "(3.15)"
    assert NUMBERS["002:E39"] == "(3.36c)"
    assert len(NUMBERS) == 38
    assert MAP["001:E11"].note.startswith("row 2 lacks")
