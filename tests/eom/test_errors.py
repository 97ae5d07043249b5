"""The one error that users see."""

from __future__ import annotations

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eom.errors import AssumptionError, InputError, near_matches, unknown_name
from tests.draws import examples


def test_message_names_all_parts_in_order():
    error = InputError("what", where="place", got=3, expected=[4], hint="try")
    assert str(error).splitlines() == [
        "what",
        "  where:    place",
        "  got:      3",
        "  expected: [4]",
        "  hint:     try",
    ]
    assert (error.what, error.where, error.got, error.expected, error.hint) == (
        "what",
        "place",
        "3",
        "[4]",
        "try",
    )


def test_empty_parts_are_left_out():
    assert str(InputError("only this")) == "only this"
    assert "got" not in str(InputError("what", hint="try"))


def test_zero_and_false_are_no_empty_parts():
    assert "got:      0" in str(InputError("what", got=0))
    assert "expected: False" in str(InputError("what", expected=False))


@pytest.mark.parametrize("kind", [InputError, AssumptionError])
@examples(20)
@given(parts=st.tuples(*[st.text(max_size=8)] * 5))
def test_errors_cross_processes_whole(kind, parts):
    what, where, got, expected, hint = parts
    error = kind(what, where=where, got=got, expected=expected, hint=hint)
    back = pickle.loads(pickle.dumps(error))
    assert type(back) is kind
    assert str(back) == str(error)
    assert (back.what, back.where, back.got, back.expected, back.hint) == parts


def test_an_input_error_is_a_value_error():
    assert issubclass(InputError, ValueError)
    assert issubclass(AssumptionError, InputError)


@pytest.mark.parametrize(
    ("name", "known", "hint"),
    [
        ("omeg_1", ["omega_1", "omega_2", "psi"], "did you mean omega_1 or omega_2?"),
        ("Psi", ["psi", "theta"], "did you mean psi?"),
        ("zzz", ["psi", "theta"], "known names: psi, theta"),
        ("zzz", [], ""),
        ("zzz", [f"n{k}" for k in range(41)], ""),
    ],
)
def test_near_matches(name, known, hint):
    assert near_matches(name, known) == hint


def test_unknown_name_says_kind_place_and_neighbours():
    error = unknown_name("state", "thta", ["theta", "psi"], "[initial]")
    assert "unknown state 'thta'" in str(error)
    assert error.where == "[initial]"
    assert "theta" in error.hint
