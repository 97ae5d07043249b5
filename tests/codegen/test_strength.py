"""Each reduction: what it finds, its law at 50 digits, and what it costs in doubles."""

import math

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.frontend.lower import lower_expressions
from codegen.ir.interpret import Point, interpret, interpret_exactly
from codegen.ir.passes import prune
from codegen.ir.program import Builder
from codegen.passes.strength import REDUCTIONS, reduce_strength
from tests.draws import nonzero

pytestmark = pytest.mark.shipped_flags

x, y, z, d = SYMBOLS = sp.symbols("x y z d", real=True)
ULP = 2.0**-53

EXAMPLES = {
    "reciprocal": ([x / d, y / d, z / d], {"mul": 3, "div": 1}),
    "tangent": ([sp.sin(x), sp.cos(x), sp.tan(x)], {"div": 1, "sin": 1, "cos": 1}),
    "sine of the double": ([sp.sin(x), sp.cos(x), sp.sin(2 * x)], {"mul": 2, "sin": 1, "cos": 1}),
    "cosine of the double": (
        [sp.sin(x), sp.cos(x), sp.cos(2 * x)],
        {"add": 1, "sub": 1, "mul": 1, "sin": 1, "cos": 1},
    ),
    "exponentials": ([sp.exp(x, evaluate=False) * sp.exp(y) * z], {"add": 1, "mul": 1, "exp": 1}),
}
DEFAULT = [name for name, row in REDUCTIONS.items() if row.default]


def program_of(name):
    if name == "exponentials":  # SymPy would add the exponents itself
        b = Builder()
        leaves = [b.leaf("state", k) for k in range(4)]
        product = b.add("mul", b.add("exp", leaves[0]), b.add("exp", leaves[1]))
        return b.program({"f": [b.add("mul", product, leaves[2])]})
    return lower_expressions({"f": EXAMPLES[name][0]}, SYMBOLS)


def test_every_reduction_has_an_example():
    assert set(EXAMPLES) == set(REDUCTIONS)


@pytest.mark.parametrize("name", REDUCTIONS)
def test_each_reduction_finds_its_example(name):
    before = program_of(name)
    after = prune(reduce_strength(before, [name]))
    assert after.counts() == EXAMPLES[name][1]
    assert after.cost() < before.cost()
    untouched = reduce_strength(before, [n for n in REDUCTIONS if n != name])
    assert untouched is before
    assert (reduce_strength(before) is before) == (not REDUCTIONS[name].default)


@given(st.sampled_from(sorted(REDUCTIONS)), st.tuples(*[nonzero(1e-3, 20)] * 4))
def test_laws_hold_at_50_digits(name, at):
    before = program_of(name)
    after = reduce_strength(before, [name])
    left, right = (interpret_exactly(p, Point(x=at))["f"] for p in (before, after))
    assert all(abs(u - v) <= 1e-40 * (1 + abs(u)) for u, v in zip(left, right, strict=True))


@given(st.sampled_from(DEFAULT), st.tuples(*[nonzero(1e-3, 20)] * 4))
def test_what_is_on_by_default_loses_a_few_ulps_of_the_value(name, at):
    after = reduce_strength(program_of(name), [name])
    exact, found = (f(after, Point(x=at))["f"] for f in (interpret_exactly, interpret))
    ulps = 1.5 if name == "reciprocal" else 4
    assert all(abs(u - v) <= 2 * ulps * ULP * abs(u) for u, v in zip(exact, found, strict=True))


def test_the_cosine_of_the_double_is_off_because_it_loses_more_near_its_zeros():
    at = [math.pi / 4 * (1 + 1e-9), 0.0, 0.0, 0.0]
    after = reduce_strength(program_of("cosine of the double"), ["cosine of the double"])
    exact, found = (f(after, Point(x=at))["f"][2] for f in (interpret_exactly, interpret))
    assert abs(exact - found) <= 4 * ULP
    assert abs(exact - found) > 1000 * ULP * abs(exact)


def test_two_divisions_stay():
    before = lower_expressions({"f": [x / d, y / d]}, SYMBOLS)
    assert reduce_strength(before) is before


def test_divisions_by_a_number():
    before = lower_expressions({"f": [x / 3, y / 3, z / 3]}, SYMBOLS)
    assert prune(reduce_strength(before)).counts() == {"mul": 3}


def test_half_angles():
    """Quaternion of an angle next to its sine: x / 2 and x, x and 2 x, 3 x and 6 x."""
    for half, whole in ((x / 2, x), (x, 2 * x), (3 * x, 6 * x), (x * sp.Rational(1, 3), x / 3 * 2)):
        before = lower_expressions({"f": [sp.sin(half), sp.cos(half), sp.sin(whole)]}, SYMBOLS)
        assert prune(reduce_strength(before)).counts()["sin"] == 1


def test_a_sine_without_its_cosine_stays():
    before = lower_expressions({"f": [sp.sin(x), sp.sin(2 * x)]}, SYMBOLS)
    assert reduce_strength(before) is before
