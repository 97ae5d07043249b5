"""Fields by their axioms, linear equations against SymPy's, and fractions that come back from residues."""

from __future__ import annotations

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from eom.fields import LARGE_PRIME, PRIME, RATIONALS, Echelon, Field, Singular, reduced, solve

FIELDS = (RATIONALS, Field(), Field(1009), Field(LARGE_PRIME), Field(2**1279 - 1))
fields = st.sampled_from(FIELDS)
residues = st.sampled_from(FIELDS[1:])
small = st.fractions(-1000, 1000, max_denominator=1000)
tables = st.integers(1, 5).flatmap(
    lambda n: st.lists(st.lists(st.integers(-3, 3), min_size=n, max_size=n), min_size=1, max_size=6)
)


@given(fields, st.lists(small, min_size=3, max_size=3), st.randoms())
def test_axioms(field, numbers, generator):
    a, b, c = map(field.of, numbers)
    d = field.draw(generator)
    same = field.reduce
    assert same(a * (b + c)) == same(a * b + a * c)
    assert same((a * b) * c) == same(a * (b * c))
    assert same(a + field.of(-numbers[0])) == 0
    assert same(d * field.inverse(d)) == 1
    assert field.of(numbers[0] * numbers[1]) == same(a * b)
    assert field.of(numbers[0] + numbers[1]) == same(a + b)
    assert field.of(7, 3) == field.of(Fraction(7, 3)) == same(7 * field.inverse(3))
    assert field.scaled([b, c], a) == field.less([0, 0], -a, [b, c]) == [same(a * b), same(a * c)]


@given(fields)
def test_zero_has_no_reciprocal(field):
    for zero in (0, field.prime, field.reduce(Fraction(0) if field.is_rational else -field.prime)):
        with pytest.raises(Singular):
            field.inverse(zero)


@pytest.mark.parametrize("prime", [f.prime for f in FIELDS[1:]])
def test_primes_are_prime(prime):
    assert sp.isprime(prime)


def test_the_prime_of_the_worlds():
    assert PRIME == 2305843009213693951


@given(residues, tables, small.filter(bool))
def test_the_reduced_form_is_that_of_sympy(field, rows, factor):
    """A field of 1009 elements is too small: other entries vanish there than over the rationals."""
    expected, columns = sp.Matrix(rows).rref()
    wanted = [[Fraction(int(x.p), int(x.q)) for x in expected.row(k)] for k in range(len(columns))]
    assert reduced([[factor * x for x in row] for row in rows], RATIONALS) == (
        wanted,
        list(columns),
    )
    if field.prime > PRIME // 2:
        form, pivots = reduced([[field.of(factor * x) for x in row] for row in rows], field)
        assert tuple(pivots) == columns
        assert form == [[field.of(x) for x in row] for row in wanted]


@given(fields, st.integers(1, 4), st.randoms())
def test_solve(field, n, generator):
    matrix = [[field.of(generator.randint(-3, 3)) for _ in range(n)] for _ in range(n)]
    x = [field.of(generator.randint(-9, 9), 2) for _ in range(n)]
    right = [field.reduce(sum(a * b for a, b in zip(row, x, strict=True))) for row in matrix]
    try:
        found = solve(matrix, right, field)
    except Singular:
        assert field.reduce(int(sp.Matrix(matrix).det())) == 0
        return
    assert found == x


def test_solve_refuses_a_singular_matrix_and_pivots():
    with pytest.raises(Singular):
        solve([[1, 2], [2, 4]], [1, 2], RATIONALS)
    assert solve([[0, 1], [1, 0]], [5, 7], RATIONALS) == [7, 5]


def test_equations_taken_in_one_by_one_contradict_or_not():
    form = Echelon(RATIONALS, 3)
    assert form.add([1, 2, 0, 5])
    assert form.add([2, 4, 2, 4])
    assert form.add([3, 6, 2, 9])
    assert form.column(3) == {0: 5, 2: -3}
    assert not form.add([0, 0, 1, 3])


@given(st.fractions(max_denominator=10**60))
def test_fractions_come_back_from_residues(x):
    field = FIELDS[-1]
    assert field.fraction(field.of(x)) == x
    assert field.fraction(field.of(-x)) == -x


@given(st.fractions(-(10**4), 10**4, max_denominator=100))
def test_small_fractions_come_back_where_their_denominators_are_bounded(x):
    field = Field()
    assert field.fraction(field.of(x), 100) == x
    assert field.fraction(field.of(x + Fraction(1, 101)), 100) != x


@given(st.integers(0, PRIME - 1), st.integers(1, 10**6))
def test_what_comes_back_is_within_its_bounds_and_has_the_residue(value, largest):
    field = Field()
    found = field.fraction(value, largest)
    if found is not None:
        assert field.of(found) == value
        assert found.denominator <= largest
        assert 2 * abs(found.numerator) * largest < PRIME
