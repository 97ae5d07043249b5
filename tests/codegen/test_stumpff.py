"""Stumpff's functions: against mpmath's hypergeometric series, differences, and in every target."""

import math
from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.compiling.compiled import TARGETS
from codegen.derivatives.derivative import PARTIALS
from codegen.frontend.layout import Layout
from codegen.ir import stumpff
from codegen.ir.program import Builder
from eom.errors import InputError
from eom.system import System

pytestmark = pytest.mark.shipped_flags

UNIT = 2.0**-52
ORDERS = sorted(stumpff.SERIES)


def points(k):
    cutoff, _ = stumpff.SERIES[k]
    sizes = np.concatenate([
        [0.0, 5e-324], 10.0 ** np.arange(-300, 0, 30), np.linspace(0.01, 1, 20) * cutoff,
        np.linspace(0.98, 1.02, 15) * cutoff, np.geomspace(cutoff, 3000, 25),
    ])  # fmt: skip
    return np.concatenate([sizes, -sizes[sizes < 500]])


@pytest.mark.parametrize("k", ORDERS)
def test_cutoffs_and_terms_are_those_of_the_analysis(k):
    cutoff, terms = stumpff.SERIES[k]
    assert cutoff == (k + 1) * (k + 2) / 2
    size, remainder = Fraction(1), Fraction(1, 2**55)
    sizes = []
    for j in range(1, terms + 2):
        size *= Fraction(cutoff) / ((2 * j + k - 1) * (2 * j + k))
        sizes.append(size)
    least = 1 - sizes[0]  # the sum of the series where its terms alternate
    assert sizes[0] <= Fraction(1, 2)
    assert sizes[-1] < remainder * least <= sizes[-2]
    for step in range(k, 2, -2):
        assert step * (step - 1) < 2 * cutoff


@pytest.mark.parametrize("k", [1, 2, 3, 4, 7, 24])
def test_the_exact_value_is_that_of_the_hypergeometric_series(k):
    with mpmath.workdps(60):
        for z in (*points(k)[::7], 1e5, -1e4):
            expected = mpmath.hyp1f2(
                1, mpmath.mpf(k + 1) / 2, mpmath.mpf(k + 2) / 2, -mpmath.mpf(z) / 4
            )
            expected /= mpmath.factorial(k)
            assert abs(stumpff.exact(mpmath.mp, k, mpmath.mpf(z)) / expected - 1) < 1e-45


@pytest.mark.sparse(8)
@pytest.mark.parametrize("k", ORDERS)
def test_doubles_are_within_the_units_that_the_text_states(k):
    cutoff, _ = stumpff.SERIES[k]
    with mpmath.workdps(40):
        for z in points(k):
            exact = stumpff.exact(mpmath.mp, k, mpmath.mpf(z))
            error = abs(mpmath.mpf(float(stumpff.double(k, z))) - exact)
            if abs(z) < cutoff:
                assert error <= 1.3 * UNIT * abs(exact)
            size = stumpff.scale(mpmath.mp, exact, k, mpmath.mpf(z))
            assert error <= 4 * UNIT * size


@given(st.integers(1, 8), st.floats(-200, 200))
def test_the_derivative_is_that_of_differences(k, z):
    with mpmath.workdps(60):
        h, z = mpmath.mpf(10) ** -20, mpmath.mpf(z)
        f = lambda z: stumpff.exact(mpmath.mp, k, z)  # noqa: E731
        difference = (f(z + h) - f(z - h)) / (2 * h)
        assert abs(stumpff.slope(mpmath.mp, k, z) - difference) < 1e-30 * (1 + abs(difference))


@pytest.mark.sparse(only=("numpy",))
def test_each_target_has_the_double_of_the_table(target):
    """All orders, both signs, as a batch and point by point."""
    b = Builder()
    z = b.leaf("state", 0)
    program = b.program({"rates": [b.add("stumpff", b.const(k), z) for k in ORDERS]})
    layout = Layout.of(System.from_rates("stumpffs", {sp.Symbol("z"): sp.Integer(0)}))
    names = tuple(f"c{k}" for k in ORDERS)
    layout = replace(layout, results={"rates": names, "outputs": (), "invariants": ()})
    _, functions, _ = TARGETS[target](program, layout)
    for k, batch in ((k, points(k)) for k in ORDERS):
        got = functions["rates"](0.0, batch[None, :])[k - 1]
        expected = np.array([stumpff.double(k, v) for v in batch])
        for at, value, wanted in zip(batch, got, expected, strict=True):
            size = stumpff.scale(mpmath.mp, wanted, k, mpmath.mpf(at))
            assert abs(value - wanted) <= 8 * UNIT * size
        one = functions["rates"](0.0, batch[-1:])[k - 1]
        assert one == pytest.approx(got[-1], rel=1e-14)


def test_beyond_the_largest_order_a_derivative_is_refused():
    b = Builder()
    k = b.const(stumpff.LARGEST - 1)
    value = b.add("stumpff", k, b.leaf("state", 0))
    with pytest.raises(InputError, match="too high an order"):
        PARTIALS["stumpff"](b, value, b.instructions[value].args)


def test_what_is_not_finite_is_not_made_finite():
    assert math.isnan(stumpff.double(1, math.nan))
    assert mpmath.isnan(stumpff.exact(mpmath.mp, 2, mpmath.nan))
    with np.errstate(all="ignore"):
        assert stumpff.double(3, -1e7) == math.inf
