"""Bounded rearrangements and the count of operations."""

from __future__ import annotations

import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.exact.algebra import explicit_rates, gather, operations
from tests.draws import examples

a, b, x, y = sp.symbols("a b x y")


def test_gather_collects_the_constants_of_each_product():
    assert gather(a * x * y - b * x * y + x, (x, y)) == x * y * (a - b) + x
    assert gather(a * (x + y), (x, y)) == a * x + a * y
    assert gather(a + b, (x,)) == a + b
    assert gather(sp.Integer(0), (x,)) == 0
    found = gather(a * sp.sin(x) + b * sp.sin(x) + a, (x,))
    assert operations([found]) == operations([(a + b) * sp.sin(x) + a])


terms = st.lists(
    st.tuples(
        st.integers(-3, 3), st.sampled_from([a, b, a * b, 1]), st.sampled_from([x, y, x * y, x**2])
    ),
    max_size=6,
)


@examples(60)
@given(parts=terms)
def test_gather_changes_no_value(parts):
    expression = sp.Add(*(n * c * v for n, c, v in parts))
    gathered = gather(expression, (x, y))
    assert sp.expand(gathered - expression) == 0
    assert operations([gathered]) <= operations([sp.expand(expression)])


def test_diagonal_mass_is_divided_and_any_other_is_kept():
    mass, rates = explicit_rates(sp.diag(a, b), (x, y))
    assert mass is None
    assert rates == (x / a, y / b)
    full = sp.Matrix([[a, 1], [1, b]])
    mass, rates = explicit_rates(full, (x, y))
    assert sp.Matrix(mass) == full
    assert rates == (x, y)


def test_operations_are_counted_by_hand():
    assert operations([]) == 0
    assert operations([x]) == 0
    assert operations([x + y]) == 1
    assert operations([x + y + a]) == 2
    assert operations([x * y * a + b]) == 3
    assert operations([sp.sin(x)]) == 1
    assert operations([x**2]) == 1
    assert operations([sp.sin(x) + y, sp.sin(x) * y]) == 3
    assert operations([x + y, x + y]) == 1
