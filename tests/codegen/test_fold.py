"""Folding rules: each law by its text, and all of them against unfolded arithmetic."""

import inspect
from fractions import Fraction

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen.fold import MAX_BITS, RULES
from codegen.interpret import Point, interpret_exactly
from codegen.ops import OPS
from codegen.program import Builder


def folded(make):
    """The last instructions of what ``make`` builds over x = 0, y = 1."""
    b = Builder()
    x, y = b.leaf("state", 0), b.leaf("state", 1)
    arguments = {"b": b, "x": x, "y": y}
    number = make(*(arguments[n] for n in inspect.signature(make).parameters if n in arguments))
    return b, number


def text(b, number):
    """The value as a nested text; x and y are the states."""
    op, args, value = b.instructions[number]
    if op == "state":
        return "xy"[value]
    if op == "const":
        return str(value)
    return f"{op}({', '.join(text(b, a) for a in args)})" if args else op


LAWS = [
    (lambda b, x: b.add("add", x, b.const(0)), "x"),
    (lambda b, x, y: b.add("add", x, b.add("neg", y)), "sub(x, y)"),
    (lambda b, x, y: b.add("add", b.add("neg", x), y), "sub(y, x)"),
    (lambda b, x: b.add("sub", x, x), "0"),
    (lambda b, x: b.add("sub", x, b.const(0)), "x"),
    (lambda b, x: b.add("sub", b.const(0), x), "neg(x)"),
    (lambda b, x, y: b.add("sub", x, b.add("neg", y)), "add(x, y)"),
    (lambda b, x, y: b.add("sub", b.add("neg", x), y), "neg(add(x, y))"),
    (lambda b, x, y: b.add("sub", b.add("neg", x), b.add("neg", y)), "sub(y, x)"),
    (lambda b, x, y: b.add("add", b.add("neg", x), b.add("neg", y)), "neg(add(x, y))"),
    (lambda b, x: b.add("sub", b.add("neg", x), b.const(0)), "neg(x)"),
    (lambda b, x, y: b.add("mul", b.add("div", x, y), y), "x"),
    (lambda b, x, y: b.add("mul", y, b.add("div", b.const(1), y)), "1"),
    (lambda b, x: b.add("mul", x, b.const(0)), "0"),
    (lambda b, x: b.add("mul", b.const(1), x), "x"),
    (lambda b, x: b.add("mul", b.const(-1), x), "neg(x)"),
    (lambda b, x: b.add("mul", x, b.const(-3)), "mul(x, -3)"),
    (lambda b, x: b.add("neg", b.add("mul", b.const(3), x)), "mul(x, -3)"),
    (lambda b, x, y: b.add("add", b.add("sub", x, y), b.add("sub", y, x)), "0"),
    (lambda b, x, y: b.add("mul", b.add("neg", x), y), "neg(mul(x, y))"),
    (lambda b, x, y: b.add("mul", b.add("neg", x), b.add("neg", y)), "mul(x, y)"),
    (lambda b, x: b.add("div", x, b.const(1)), "x"),
    (lambda b, x: b.add("div", b.const(0), x), "0"),
    (lambda b, x: b.add("div", x, b.const(8)), "mul(x, 1/8)"),
    (lambda b, x: b.add("div", x, b.const(Fraction(1, 4))), "mul(x, 4)"),
    (lambda b, x: b.add("div", x, b.const(-2)), "mul(x, -1/2)"),
    (lambda b, x: b.add("div", x, b.const(3)), "div(x, 3)"),
    (lambda b, x: b.add("div", x, b.const(0)), "div(x, 0)"),
    (lambda b: b.add("div", b.const(0), b.const(0)), "div(0, 0)"),
    (lambda b, x, y: b.add("div", b.add("neg", x), y), "neg(div(x, y))"),
    (lambda b, x, y: b.add("div", x, b.add("neg", y)), "neg(div(x, y))"),
    (lambda b, x: b.add("neg", b.add("neg", x)), "x"),
    *[(lambda b, x, f=f: b.add(f, b.add("neg", x)), f"neg({f}(x))")
      for f in ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh", "sign")],
    *[(lambda b, x, f=f: b.add(f, b.add("neg", x)), f"{f}(x)") for f in ("cos", "cosh", "abs")],
    *[(lambda b, x, f=f: b.add(f, b.add("neg", x)), f"{f}(neg(x))") for f in ("exp", "acos", "sqrt")],
    (lambda b, x, y: b.add("select", b.const(1), x, y), "x"),
    (lambda b, x, y: b.add("select", b.const(0), x, y), "y"),
    (lambda b, x, y: b.add("select", b.add("lt", x, y), y, y), "y"),
    *[(lambda b, x, f=f: b.add(f, x, x), "x") for f in ("min", "max", "and", "or")],
    *[(lambda b, f=f: b.add(f, b.const(0)), "0")
      for f in ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh", "sqrt", "abs", "sign")],
    *[(lambda b, f=f: b.add(f, b.const(0)), "1") for f in ("cos", "cosh", "exp", "not")],
    *[(lambda b, f=f: b.add(f, b.const(1)), "0") for f in ("log", "acos", "acosh", "not")],
    (lambda b: b.add("sqrt", b.const(Fraction(9, 4))), "3/2"),
    (lambda b: b.add("sqrt", b.const(2)), "sqrt(2)"),
    (lambda b: b.add("sqrt", b.const(-4)), "sqrt(-4)"),
    (lambda b: b.add("div", b.const(1), b.const(3)), "1/3"),
    (lambda b: b.add("lt", b.const(1), b.const(2)), "1"),
    (lambda b: b.add("le", b.const(2), b.const(2)), "1"),
    (lambda b: b.add("eq", b.const(1), b.const(2)), "0"),
    (lambda b: b.add("and", b.const(1), b.const(0)), "0"),
    (lambda b: b.add("or", b.const(1), b.const(0)), "1"),
    (lambda b: b.add("max", b.const(1), b.const(-2)), "1"),
    (lambda b: b.add("sign", b.const(-7)), "-1"),
    (lambda b: b.add("abs", b.const(-7)), "7"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "expected"), LAWS)
def test_each_law(make, expected):
    assert text(*folded(make)) == expected


def test_every_rule_has_a_law_here():
    for op in RULES:
        assert any(
            op in make.__code__.co_consts or op in (make.__defaults__ or ()) for make, _ in LAWS
        )


def test_constants_that_grow_too_large_are_left_alone():
    b = Builder()
    large = b.const(Fraction(2) ** (MAX_BITS - 10))
    assert b.instructions[b.add("mul", large, b.const(3))].op == "const"
    product = b.add("mul", large, large)
    assert b.instructions[product].op == "mul"


OPERATIONS = sorted(set(OPS) - {"pow", "atan2"})
SMALL = st.fractions(-3, 3, max_denominator=4)


@settings(max_examples=300)
@given(st.data())
def test_folded_programs_have_the_value_of_unfolded_arithmetic(data):
    """Build at random, with many zeros, ones and negatives, and evaluate beside it."""
    m = mpmath.mp.clone()
    m.dps = 60
    b = Builder()
    state = st.sampled_from([-1.5, -0.5, 0.25, 0.75, 2.5])
    point = Point(x=[data.draw(state), data.draw(state)])
    values = {}
    for _ in range(data.draw(st.integers(1, 4))):
        c = data.draw(SMALL)
        values[b.const(c)] = m.mpf(c.numerator) / c.denominator
    numbers = [b.leaf("state", 0), b.leaf("state", 1), *values]
    exact = [m.mpf(point.x[0]), m.mpf(point.x[1]), *values.values()]
    for _ in range(data.draw(st.integers(1, 10))):
        op = data.draw(st.sampled_from(["neg", "mul", "add", "sub", "div", *OPERATIONS]))
        chosen = [data.draw(st.integers(0, len(numbers) - 1)) for _ in range(OPS[op].arity)]
        if op in {"and", "or", "not", "select"} and exact[chosen[0]] not in {0, 1}:
            continue
        if op in {"and", "or"} and exact[chosen[1]] not in {0, 1}:
            continue
        try:
            value = OPS[op].exact(m, *(exact[k] for k in chosen))
        except (ValueError, ZeroDivisionError):
            continue
        if isinstance(value, m.mpc) or not m.isfinite(value) or abs(value) > 1e20:
            continue
        numbers.append(b.add(op, *(numbers[k] for k in chosen)))
        exact.append(value)
    program = b.program({"f": numbers})
    for got, expected in zip(interpret_exactly(program, point, 60)["f"], exact, strict=True):
        assert abs(got - expected) <= m.mpf(10) ** -25 * (1 + abs(expected))
