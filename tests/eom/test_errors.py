"""The one error that users see."""

from __future__ import annotations

import math
import pickle

import numpy as np
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


def test_what_passes_by_its_type_alone_is_what_annotations_ask_for():
    """Of all annotations of public functions, with hostile values and right ones: never more."""
    import codegen
    import eom
    from eom import errors
    from tests.hostile_calls import HOSTILE

    functions = [getattr(m, n) for m in (eom, codegen) for n in m.__all__]
    functions = [f.__wrapped__ for f in functions if hasattr(f, "__wrapped__")]
    hints = {str(h): h for f in functions for h in errors._hints(f).values()}
    values = [*HOSTILE, 1.0, 2, 10**400, True, None, "a", "\ud800", math.nan, [1.0], (0, 1), (0, 1, 2),
              ["a"],
              {"a": 1.0}, {"a": 10**400}, {"a": "x"}, {1: 1.0}, {"\ud800": 1.0}, [None], (10**400, 1.0),
              np.float64(1.0), np.array([1.0]), np.array(1), [[1.0]], {"a": [1.0]}, range(3)]  # fmt: skip
    passed = 0
    for hint in hints.values():
        plain, test = errors._by_type(hint)
        for value in values:
            if type(value) in plain or test(value):
                held = errors._held(value, hint)
                assert held is value, (hint, type(value))
                assert errors._fits(value, hint), (hint, type(value))
                assert not errors._is_long(value), (hint, type(value))
                passed += 1
    assert len(hints) > 50
    assert passed > 3 * len(hints)
