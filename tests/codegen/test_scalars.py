"""Scalars with operators: what they build has the value that the same code has on exact numbers."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from codegen.ir import scalars
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.ops import OPS
from codegen.ir.program import Builder
from codegen.ir.scalars import apply, constant, equal, sin, where
from eom.errors import InputError
from tests.draws import nonzero


def two(kind="state"):
    b = Builder()
    return b, *scalars.scalars(b, kind, 2)


def value(b, scalar, x=(0.75, -1.5)):
    return interpret_exactly(scalars.program(b, {"f": [scalar]}), Point(x=x))["f"][0]


ARITHMETIC = [
    lambda x, y: x + y - 2 * x,
    lambda x, y: (x - y) / (y * y + 1) - 3,
    lambda x, y: 1 - x / 7 + 2 / y,
    lambda x, y: -(+x) * abs(y) + Fraction(1, 3) * y,
    lambda x, y: x**3 + y**-2 + x**0 + y**1,
    lambda x, y: 0 * x + 1 * y + x / 1 - 0,
    lambda x, y: sum([x, y, x * y]) * 0.1,
]


@pytest.mark.sparse(3)
@pytest.mark.parametrize("number", range(len(ARITHMETIC)))
@given(st.tuples(nonzero(0.01, 10), nonzero(0.01, 10)))
def test_arithmetic_is_that_of_exact_fractions(number, at):
    """0.1 is the dyadic fraction that the float is, in both."""
    f = ARITHMETIC[number]
    b, x, y = two()
    exact = f(*map(Exact, at))
    found = value(b, f(x, y), at)
    with mpmath.workdps(50):
        wanted = mpmath.mpf(exact.value.numerator) / exact.value.denominator
        assert abs(found - wanted) <= mpmath.mpf(10) ** -40 * (1 + abs(wanted))


class Exact:
    """Fractions beside which floats stay exact."""

    def __init__(self, value):
        self.value = Fraction(value)

    def __pow__(self, n):
        return Exact(self.value**n)

    def __neg__(self):
        return Exact(-self.value)

    def __pos__(self):
        return self

    def __abs__(self):
        return Exact(abs(self.value))


def exact_operation(name):
    def run(self, other):
        other = other.value if isinstance(other, Exact) else Fraction(other)
        return Exact(getattr(self.value, name)(other))

    return run


for word in ("add", "sub", "mul", "truediv"):
    for spelt in (f"__{word}__", f"__r{word}__"):
        setattr(Exact, spelt, exact_operation(spelt))


NAMES = {"min": "minimum", "max": "maximum", "eq": "equal", "select": "where"}
FUNCTIONS = (
    "sqrt sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp log atan2 sign min max eq select"
).split()


@pytest.mark.parametrize("op", FUNCTIONS)
def test_functions_are_the_operations(op):
    function = getattr(scalars, NAMES.get(op, op))
    b = Builder()
    leaves = scalars.scalars(b, "parameter", OPS[op].arity)
    made = function(*leaves)
    assert b.instructions[made.number].op == op
    assert b.instructions[made.number].args == tuple(s.number for s in leaves)
    assert made == apply(op, *leaves)


def test_conditions():
    for at in [(1.0, 2.0), (2.0, 1.0), (1.0, 1.0)]:
        for test in (
            lambda x, y: x < y,
            lambda x, y: x <= y,
            lambda x, y: x > y,
            lambda x, y: x >= y,
            lambda x, y: x < 2,
            lambda x, y: 2 < x,  # noqa: SIM300
        ):
            b, x, y = two()
            assert value(b, where(test(x, y), 5, x), at) == (5 if test(*at) else at[0])
        b, x, y = two()
        assert value(b, where(equal(x, y), 5, x), at) == (5 if at[0] == at[1] else at[0])


def test_equal_scalars_are_one_instruction():
    b, x, y = two()
    assert x * y + 1 == 1 + y * x
    assert x != y
    assert x - x == 0
    assert constant(b, 0.5) == Fraction(1, 2)
    assert x != 0
    assert x != "x"
    assert len({x + y, y + x, x}) == 2
    assert bool(constant(b, 3))
    assert not (x - x)


def test_a_loop_of_numbers_of_other_packages():
    b, x, _ = two()
    made = [np.float64(0.5) * x, x * np.int64(2), x + sp.Rational(1, 3), x / np.float32(0.25)]
    got = [float(value(b, m, (0.75, 0))) for m in made]
    assert got == [0.375, 1.5, 0.75 + 1 / 3, 3.0]
    assert list(np.array([1, 2]) * x) == [x, 2 * x]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda b, x, y: x + float("nan"), "not a finite number"),
        (lambda b, x, y: float("inf") * x, "not a finite number"),
        (lambda b, x, y: constant(b, "1"), "not a finite number"),
        (lambda b, x, y: x + two()[1], "two builders"),
        (lambda b, x, y: scalars.program(Builder(), {"f": [x]}), "two builders"),
        (lambda b, x, y: 1 if x < y else 2, "neither true nor false"),
        (lambda b, x, y: max(x, y), "neither true nor false"),
        (lambda b, x, y: apply("sine", x), "operation"),
        (lambda b, x, y: apply("sin", x, y), "takes 1"),
        (lambda b, x, y: apply("sin", 0.5), "plain numbers"),
        (lambda b, x, y: scalars.scalars(b, "const", 1), "kind of slot"),
    ],
)
def test_what_is_refused(make, words):
    with pytest.raises(InputError, match=words):
        make(*two())


@pytest.mark.parametrize("other", ["a", None, [1], 1j, sp.Symbol("x")])
def test_other_things_are_no_numbers(other):
    _, x, _ = two()
    with pytest.raises(TypeError):
        x + other
    with pytest.raises(TypeError):
        x**other


def test_large_powers_are_not_unrolled():
    b, x, _ = two()
    assert b.instructions[(x**65).number].op == "pow"
    assert b.instructions[(x**-64).number].op == "div"
    assert b.instructions[(2**x).number].op == "pow"


def test_time_and_results():
    b, x, _ = two()
    program = scalars.program(b, {"f": [sin(scalars.time(b)) * x, 2]})
    values = interpret_exactly(program, Point(0.5, (2.0, 0.0)))["f"]
    assert values[1] == 2
    assert float(values[0]) == pytest.approx(2 * np.sin(0.5), rel=1e-15)


def test_a_scalar_shows_its_instruction():
    _, x, y = two()
    assert repr(x * y) == "Scalar(2: mul 0 1)"
    assert repr(constant(x.builder, 0.5)) == "Scalar(3: const 1/2)"
