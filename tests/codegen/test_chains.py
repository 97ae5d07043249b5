"""Shared partial sums: the same values in exact arithmetic, never more operations."""

from fractions import Fraction

import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.frontend.lower import lower_expressions
from codegen.ir import passes
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.program import Builder, Name
from codegen.passes.chains import MAX_TERMS, PRODUCTS, chains, share_products, share_sums
from tests.clock import growth_in_calls

a, b, c, d, e = SYMBOLS = sp.symbols("a b c d e", real=True)
VALUES = [1.5, -2.25, 4.0, 0.625, -7.0]


def program_of(*expressions, group="rates"):
    return lower_expressions({group: expressions}, SYMBOLS)


def shared(program):
    return passes.prune(share_sums(program))


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
    assert share_sums(program) is program
    assert share_products(program) is program


def test_a_named_sum_stays_whole():
    build = Builder()
    x, y, z, w = (build.leaf("state", k) for k in range(4))
    inner = build.add("add", x, y)
    build.name(inner, Name("inner"))
    first = build.add("add", inner, z)
    second = build.add("add", build.add("add", y, z), w)
    program = build.program({"rates": [first, second]})
    after = share_sums(program)
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


def test_products_share_their_factors():
    """a c is a factor of all three."""
    before = program_of(a * b * c, a * c * d, a * c * e)
    after = passes.prune(share_products(before))
    assert operations(before) == 5
    assert operations(after) == 4
    assert results(after) == results(before)


def test_what_parameters_give_stays_together():
    """p q is known before the states; x p in both products would not be."""
    p, q, r = sp.symbols("p q r", real=True)
    program = lower_expressions({"f": [a * (p * q), a * (p * r), p * q + a]}, [a], [p, q, r])
    assert share_products(program) is program
    sizes = [len(t) for t in chains(program, PRODUCTS).values()]
    assert max(sizes) == 2


@given(st.lists(st.lists(st.sampled_from(SYMBOLS), min_size=2, max_size=6), min_size=1, max_size=6))
def test_values_of_products_stay_and_operations_do_not_grow(groups):
    b = Builder()
    leaf = {s: b.leaf("state", k) for k, s in enumerate(SYMBOLS)}
    numbers = []
    for group in groups:
        number = leaf[group[0]]
        for s in group[1:]:
            number = b.add("mul", number, leaf[s])
        numbers.append(number)
    before = b.program({"f": numbers})
    after = passes.prune(share_products(before))
    assert results(after) == results(before)
    assert operations(after) <= operations(before)


def many(count, terms=5):
    """Sums over pairs of slots that recur in many sums."""
    b = Builder()
    leaves = [b.leaf("state", k) for k in range(count)]
    sums = []
    for k in range(count):
        number = leaves[k]
        for j in range(1, terms):
            number = b.add("add" if (k + j) % 3 else "sub", number, leaves[(k + j * j) % count])
        sums.append(number)
    return b.program({"f": sums})


def test_work_is_nearly_linear():
    assert growth_in_calls(9, share_sums, many(500), many(4000))


def test_long_sums_that_share_all_their_terms():
    """Nothing recurses as deep as a sum is long."""
    b = Builder()
    leaves = [b.leaf("state", k) for k in range(700)]
    total = leaves[0]
    for k in leaves[1:-2]:
        total = b.add("add", total, k)
    other = leaves[-3]
    for k in leaves[-4::-1]:
        other = b.add("add", other, k)
    sums = [b.add("add", total, leaves[-1]), b.add("add", other, leaves[-2])]
    before = b.program({"f": sums})
    after = passes.prune(share_sums(before))
    point = Point(x=[float(k % 97) for k in range(700)])
    assert interpret_exactly(after, point) == interpret_exactly(before, point)
    assert operations(after) == 697 + 2
    assert MAX_TERMS < 700
