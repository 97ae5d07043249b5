"""Identifiers and comments from whatever text there is."""

import keyword
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from codegen.ir.names import HELPERS, RESERVED, comment, identifier, identifiers

TEXTS = st.one_of(
    st.text(max_size=80),
    st.sampled_from([*sorted(RESERVED), *HELPERS, "θ'", "x''", "__x", "x__", "1", "", "*/", "/*"]),
)


@pytest.mark.slow
@given(TEXTS)
def test_every_name_becomes_an_identifier_that_no_language_reserves(name):
    spelt = identifier(name)
    assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,60}", spelt, re.ASCII)
    assert spelt not in RESERVED
    assert not keyword.iskeyword(spelt)
    assert "__" not in spelt


@pytest.mark.slow
@given(st.lists(TEXTS, max_size=30))
def test_identifiers_of_several_names_are_all_different(names):
    spelt = identifiers(names, HELPERS)
    assert len(set(spelt)) == len(names)
    assert not set(spelt) & {*RESERVED, *HELPERS}
    assert all(re.fullmatch(r"[A-Za-z]\w*", s, re.ASCII) for s in spelt)


@pytest.mark.parametrize(
    ("name", "spelt"),
    [
        ("omega_1", "omega_1"), ("ω_1", "omega_1"), ("Ω", "omega"), ("θ'", "theta_dot"),
        ("θ''", "theta_ddot"), ("ψ′", "psi_dot"), ("int", "int_"), ("sin", "sin_"), ("t", "t_"),
        ("lambda", "lambda_"), ("λ", "lambda_"), ("2x", "v2x"), ("", "v"), ("*/", "v"),
        ("a b", "a_b"), ("x\ny", "x_y"), ("é", "e"), ("r₁", "r1"), ("I_{12}", "I_12"), ("_a_", "a"),
        ("Λ", "lambda_"),
    ],
)  # fmt: skip
def test_known_spellings(name, spelt):
    assert identifier(name) == spelt


def test_long_names_that_begin_the_same_stay_different():
    first, second = identifiers(["a" * 100, "a" * 101])
    assert first != second


def test_order_decides_who_keeps_the_plain_spelling():
    assert identifiers(["θ", "theta"]) == ["theta", "theta_2"]
    assert identifiers(["theta_2", "θ", "theta"]) == ["theta_2", "theta", "theta_3"]


@given(st.text(max_size=300))
def test_comments_end_nowhere(text):
    plain = comment(text)
    assert plain.isascii()
    assert plain.isprintable() or plain == ""
    assert "*/" not in plain
    assert "/*" not in plain
    assert "\\" not in plain
    assert "?" not in plain
    assert "\n" not in plain
    assert len(plain) <= 200
    assert comment(plain) == plain


@pytest.mark.parametrize(
    "text", ["*/", "**//", "*\\/", "*?/", "*\n/", "/\\*", "//**//", "*" * 199 + "/" * 5]
)
def test_pieces_do_not_join_to_the_end_of_a_comment(text):
    assert "*/" not in comment(text)
    assert "/*" not in comment(text)
