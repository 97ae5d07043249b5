"""Distributions in words: what they mean, and how others are refused."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from codegen import Grid, Normal, Sampler, Uniform, UniformQuaternion
from codegen.ensembles.sampler import KINDS, distribution, names, sampler_of
from eom.errors import InputError

NUMBERS = st.floats(-1e9, 1e9)


@given(NUMBERS, NUMBERS)
def test_words_are_the_distributions_that_they_name(a, b):
    low, high = sorted((a, b))
    assert distribution(f"uniform({low!r}, {high!r})", "x") == Uniform(low, high)
    assert distribution(f" normal( {a!r},{abs(b)!r} ) ", "x") == Normal(a, abs(b))
    assert distribution(repr(a), "x") == distribution(a, "x") == a


def test_grids_and_attitudes_are_read():
    assert distribution("grid(0, 1, 11)", "x") == Grid(0.0, 1.0, 11)
    assert distribution("attitude()", "q") == distribution("attitude", "q") == UniformQuaternion()
    assert {kind.name: kind.numbers for kind in KINDS} == {
        "uniform": 2, "normal": 2, "grid": 3, "attitude": 0,
    }  # fmt: skip


def test_a_sampler_in_words_draws_what_one_of_objects_draws():
    words = {"a": "normal(1, 2)", "q0, q1,q2,q3": "attitude()", "b": "grid(0, 1, 3)", "c": 4}
    values = {
        "a": Normal(1, 2), ("q0", "q1", "q2", "q3"): UniformQuaternion(), "b": Grid(0, 1, 3), "c": 4.0,
    }  # fmt: skip
    one, other = sampler_of(words, 12, 3), Sampler(values, 12, 3)
    assert one == other
    for name, found in one.sample(2, 9).items():
        np.testing.assert_array_equal(found, other.sample(2, 9)[name])


BAD = {
    "no distribution": ("about 3", "not a distribution", "uniform(LOW, HIGH)"),
    "a formula": ("normal(0, sqrt(2))", "not a distribution", "normal(MEAN, DEVIATION)"),
    "unknown": ("gauss(0, 1)", "unknown distribution 'gauss'", "normal"),
    "too few": ("normal(1)", "not the numbers", "normal(MEAN, DEVIATION)"),
    "too many": ("attitude(1)", "not the numbers", "attitude()"),
    "no number": ("uniform(0, one)", "not the numbers", "uniform(LOW, HIGH)"),
    "empty": ("uniform(0, )", "not the numbers", "uniform(LOW, HIGH)"),
    "order": ("uniform(2, 1)", "limits do not fit", "low <= high"),
    "deviation": ("normal(0, -1)", "wrong mean or deviation", "deviation >= 0"),
    "part of a grid": ("grid(0, 1, 2.5)", "wrong grid", "one value or more"),
    "endless grid": ("grid(0, 1, inf)", "wrong grid", "one value or more"),
    "nan": ("uniform(nan, 1)", "limits do not fit", "low <= high"),
    "truth": (True, "not a distribution", "a number"),
    "list": ([1, 2], "not a distribution", "a number"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_what_is_no_distribution_is_refused_with_its_place(case):
    text, what, expected = BAD[case]
    with pytest.raises(InputError, match="in the file") as error:
        distribution(text, "in the file")
    assert what in str(error.value)
    assert expected in str(error.value)


@pytest.mark.parametrize("text", ["", "a,", ",", "a,,b"])
def test_names_must_be_there(text):
    with pytest.raises(InputError, match="a name is missing"):
        names(text, "x")
