"""Shared partial sums: the same values in exact arithmetic, never more operations."""

from fractions import Fraction

import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen import passes
from codegen.interpret import Point, interpret_exactly
from codegen.lower import lower_expressions
from codegen.program import Builder, Name
from codegen.sums import share_sums

a, b, c, d, e = SYMBOLS = sp.symbols("a b c d e", real=True)
VALUES = [1.5, -2.25, 4.0, 0.625, -7.0]


def program_of(*expressions, group="rates"):
    return lower_expressions({group: expressions}, SYMBOLS)


def shared(program, group="rates"):
    return passes.prune(share_sums(program, group))


def results(program):
    exact = interpret_exactly(program, Point(x=VALUES))
    return {g: [Fraction(str(v)) for v in values] for g, values in exact.items()}


def operations(program):
    return sum(passes.prune(program).counts().values())


def test_sum_and_difference_of_the_same_parts():
    """The two squares of a quaternion's matrix: 6 additions become 4."""
    before = program_of(a + b - c - d, a - b - c + d)
    after = shared(before)
    assert after.counts() == {"add": 1, "sub": 3}
    assert operations(before) == 6
    assert results(after) == results(before)


def test_pair_in_three_sums_up_to_sign():
    before = program_of(a - b + c, b - a + d, e + a - b)
    after = shared(before)
    assert operations(after) == 4
    assert results(after) == results(before)


def test_nothing_to_share_leaves_the_program_as_it_is():
    program = program_of(a + b, c * d + e)
    assert share_sums(program, "rates") is program


def test_other_groups_do_not_decide_but_keep_their_values():
    program = lower_expressions({"rates": [a + b + c], "outputs": [a + c + e, b + c + e]}, SYMBOLS)
    assert share_sums(program, "rates") is program
    after = share_sums(program, "outputs")
    assert results(after) == results(program)
    assert operations(after) == operations(program) - 1


def test_a_named_sum_stays_whole():
    build = Builder()
    x, y, z, w = (build.leaf("state", k) for k in range(4))
    inner = build.add("add", x, y)
    build.name(inner, Name("inner"))
    first = build.add("add", inner, z)
    second = build.add("add", build.add("add", y, z), w)
    program = build.program({"rates": [first, second]})
    after = share_sums(program, "rates")
    assert [n.name for n in after.names.values()] == ["inner"]
    assert results(after) == results(program)


sums = st.lists(
    st.tuples(st.sampled_from(SYMBOLS), st.sampled_from([1, -1])), min_size=1, max_size=5
)
terms = st.one_of(
    sums, st.lists(st.tuples(st.sampled_from([a * b, c**2, d]), st.just(-1)), max_size=3)
)


@given(st.lists(terms, min_size=1, max_size=6))
def test_values_stay_and_operations_do_not_grow(groups):
    expressions = [sp.Add(*(s * t for t, s in group)) for group in groups]
    before = program_of(*expressions)
    after = shared(before)
    assert results(after) == results(before)
    assert operations(after) <= operations(before)
    assert str(shared(program_of(*expressions))) == str(after)
