"""Common factors: the same values in exact arithmetic, at a lower cost."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.frontend.lower import lower_expressions
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.passes import prune
from codegen.ir.program import Builder, Name
from codegen.passes.pipeline import factor_sums
from tests.clock import growth_in_calls

a, b, c, d, e, f = SYMBOLS = sp.symbols("a b c d e f", real=True)
VALUES = [1.5, -2.25, 4.0, 0.625, -7.0, 0.25]


def program_of(*expressions):
    """Lowered as written: SymPy's own factoring is kept out."""
    return lower_expressions({"f": expressions}, SYMBOLS)


def factored(program):
    return prune(factor_sums(program))


def values(program, at=VALUES):
    return interpret_exactly(program, Point(x=at))["f"]


def close(left, right):
    return all(abs(u - v) <= 1e-45 * (1 + abs(u)) for u, v in zip(left, right, strict=True))


CASES = [
    ([a * b + a * c], {"add": 1, "mul": 1}),
    ([a * b - a * c], {"sub": 1, "mul": 1}),
    ([-a * b - a * c], {"add": 1, "mul": 1, "neg": 1}),
    ([a * b + a * c - a * d + e], {"add": 2, "sub": 1, "mul": 1}),
    ([a * a * b + a * c], {"add": 1, "mul": 2}),
    ([a * a * b + a * a * c], {"add": 1, "mul": 2}),
    ([a * b * c + a * b * d], {"add": 1, "mul": 2}),
    ([a * b + a * c + d * b + d * c], {"add": 2, "mul": 2}),
    ([a / d + b / d], {"add": 1, "div": 1}),
    ([a / d - b * c / d + e / d], {"add": 1, "sub": 1, "mul": 1, "div": 1}),
    ([1 / d + b / d], {"add": 1, "div": 1}),
    ([3 * a * b + 3 * c * d + e], {"add": 2, "mul": 3}),
    ([3 * a * b - 3 * c * d + e], {"add": 1, "sub": 1, "mul": 3}),
    ([a * sp.sin(b) + c * sp.sin(b)], {"add": 1, "mul": 1, "sin": 1}),
]


@pytest.mark.parametrize(("expressions", "expected"), CASES)
def test_each_form(expressions, expected):
    before = program_of(*expressions)
    after = factored(before)
    assert after.counts() == expected
    assert after.cost() < before.cost()
    assert close(values(after), values(before))


@pytest.mark.parametrize(
    "expressions",
    [
        [a + a * b],  # as many operations either way
        [a * b + c * d],
        [a * b + a * c, a * b, a * c],  # both products are needed anyhow
        [(a * b + a * c) * d, (a * b) ** 2 + a * c],
        [a / d + b / c],
        [d / a + d / b],
    ],
)
def test_what_would_save_nothing_is_left_alone(expressions):
    before = program_of(*expressions)
    assert factor_sums(before) is before


def test_a_product_with_a_name_stays_whole():
    build = Builder()
    x, y, z = (build.leaf("state", k) for k in range(3))
    first = build.add("mul", x, y)
    build.name(first, Name("moment"))
    program = build.program({"f": [build.add("add", first, build.add("mul", x, z))]})
    assert factor_sums(program) is program


def test_the_factor_that_is_known_last_is_taken_out():
    """p x + q x + p y = (p + q) x + p y: the first sum is known with the parameters."""
    p, q = sp.symbols("p q", real=True)
    program = lower_expressions({"f": [p * a + q * a + p * b]}, [a, b], [p, q])
    after = factored(program)
    pairs = [{after.instructions[k].op for k in i.args} for i in after.instructions]
    assert {"parameter"} in pairs
    assert after.counts() == {"add": 2, "mul": 2}


def test_parameters_that_are_multiplied_stay_together():
    p, q, r = sp.symbols("p q r", real=True)
    program = lower_expressions({"f": [p * q * a + p * r * b]}, [a, b], [p, q, r])
    assert factor_sums(program) is program
    alone = lower_expressions({"f": [p * q + p * r]}, [], [p, q, r])
    assert factored(alone).counts() == {"add": 1, "mul": 1}


factors = st.tuples(st.sampled_from([0, 1, 2, 3, 4, 5]), st.sampled_from([1, 1, 1, -1]))
products = st.lists(factors, min_size=1, max_size=4)
sums = st.lists(st.tuples(products, st.booleans(), st.integers(1, 3)), min_size=1, max_size=6)


@given(st.lists(sums, min_size=1, max_size=4))
def test_values_stay_and_cost_never_rises(groups):
    build = Builder()
    leaves = [build.leaf("state", k) for k in range(len(SYMBOLS))]
    results = []
    for group in groups:
        total = build.const(0)
        for parts, negative, coefficient in group:
            term = build.const(coefficient)
            for slot, exponent in parts:
                term = build.add("mul" if exponent > 0 else "div", term, leaves[slot])
            total = build.add("sub" if negative else "add", total, term)
        results.append(total)
    before = prune(build.program({"f": results}))
    after = factored(before)
    assert close(values(after), values(before))
    assert after.cost() <= before.cost()
    assert str(factored(before)) == str(after)


def many(count):
    """A sum of as many products, each factor in three of them."""
    build = Builder()
    leaves = [build.leaf("state", k) for k in range(count)]
    total = build.const(0)
    for k in range(count):
        term = build.add("mul", leaves[k // 3], leaves[(7 * k + 1) % count])
        total = build.add("add", total, term)
    return build.program({"f": [total]})


@pytest.mark.slow
def test_work_is_nearly_linear_even_in_one_sum():
    assert growth_in_calls(9, factor_sums, many(600), many(4800))


def test_values_of_a_long_sum_stay():
    program = many(300)
    at = [float(Fraction(k % 17 - 8, 4)) for k in range(300)]
    assert close(values(factored(program), at), values(program, at))
    assert factored(program).cost() < program.cost()
