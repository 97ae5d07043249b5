"""Exact numbers from input and the signs of numbers that hide a zero."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
import sympy as sp

from eom import InputError
from eom.exact.numbers import TOLERANCE, number, sign, tolerance


def test_floats_become_the_fractions_that_they_are():
    assert number(0.1) == sp.Rational(3602879701896397, 2**55)
    assert number(5e-324) == sp.Rational(1, 2**1074)
    assert number(Fraction(1, 3)) == sp.Rational(1, 3)
    assert number(sp.sqrt(2)) == sp.sqrt(2)
    assert number(-7) == -7


BAD = {
    "nan": (math.nan, "not a finite real"),
    "infinite": (-math.inf, "not a finite real"),
    "zoo": (sp.zoo, "not a finite real"),
    "complex": (1j, "not a finite real"),
    "symbol": (sp.Symbol("x", real=True), "not a finite real"),
    "text": ("1", "not a number"),
    "truth": (True, "not a finite real"),
    "none": (None, "not a"),
    "huge": (sp.Integer(10) ** 400, "out of range"),
    "large": (1e100, "out of range"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_number_is_refused(name):
    value, message = BAD[name]
    with pytest.raises(InputError, match=message):
        number(value)


def test_refusal_says_where():
    with pytest.raises(InputError) as caught:
        number(math.nan, "inertia matrix")
    assert caught.value.where == "inertia matrix"


def test_one_float_brings_the_tolerance():
    assert tolerance([1, Fraction(1, 3), sp.pi]) == 0
    assert tolerance([1, 0.5]) == tolerance([2 * sp.Float(1) * sp.pi]) == TOLERANCE


def test_signs_of_hidden_zeros_and_of_small_numbers():
    root = sp.sqrt(2 + sp.sqrt(3)) - (sp.sqrt(6) + sp.sqrt(2)) / 2
    assert sign(root) == 0
    assert sign(sp.sin(1) ** 2 + sp.cos(1) ** 2 - 1) == 0
    for size in (sp.sqrt(2), sp.pi, sp.Rational(1, 3), sp.Integer(1)):
        for small in (1, sp.Rational(1, 10**300)):
            assert sign(size * small) == 1
            assert sign(-size * small) == -1
            assert sign(size * small, small * 4) == 0
    near = sp.sqrt(2) - sp.Rational(math.isqrt(2 * 10**400), 10**200)
    assert sign(near) == 1
    assert sign(-near) == -1
