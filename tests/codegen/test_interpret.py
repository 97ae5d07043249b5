"""The oracle itself: against mpmath, and its bound against doubles."""

import math

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from codegen.frontend.lower import lower_expressions
from codegen.ir.interpret import (
    Point,
    constants,
    interpret,
    interpret_exactly,
    interpret_with_bound,
)
from codegen.ir.ops import OPS

x, y = sp.symbols("x y", real=True)


def program_of(*expressions):
    return lower_expressions({"f": expressions}, (x, y))


def test_leaves_read_their_slots():
    a, t = sp.symbols("a t", real=True)
    program = lower_expressions({"f": [x + 10 * y + 100 * a]}, (x, y), (a, t))
    assert interpret(program, Point(0.0, [1, 2], [3, 4]))["f"] == [321.0]
    assert interpret_exactly(program, Point(0.0, [1, 2], [3, 4]))["f"] == [321]


def test_fifty_digits_are_fifty_digits():
    program = program_of(sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1, sp.exp(sp.pi) / 7)
    zero, quotient = interpret_exactly(program, Point(x=[1.1, 0.0]))["f"]
    assert abs(zero) < mpmath.mpf(10) ** -49
    with mpmath.workdps(60):
        assert abs(quotient - mpmath.exp(mpmath.pi) / 7) < mpmath.mpf(10) ** -48
    long = interpret_exactly(program, Point(x=[1.1, 0.0]), 200)["f"][1]
    with mpmath.workdps(210):
        assert abs(long - mpmath.exp(mpmath.pi) / 7) < mpmath.mpf(10) ** -198


def test_digits_of_other_code_are_left_alone():
    before = mpmath.mp.dps
    interpret_exactly(program_of(sp.sin(x)), Point(x=[1.0, 0.0]), 300)
    assert mpmath.mp.dps == before


@pytest.mark.parametrize(
    ("e", "at"),
    [(sp.sqrt(x), -1.0), (sp.log(x), -1.0), (1 / x, 0.0), (sp.asin(x), 2.0), (sp.acosh(x), 0.5),
     (x**y, -2.0), (sp.atanh(x), 2.0), (sp.sin(x), math.inf), (sp.log(x) + y, -1.0)],
    ids=str,
)  # fmt: skip
def test_what_is_not_real_is_nan_and_has_no_bound(e, at):
    (exact,) = interpret_exactly(program_of(e), Point(x=[at, 0.5]))["f"]
    (bounded,) = interpret_with_bound(program_of(e), Point(x=[at, 0.5]))["f"]
    assert mpmath.isnan(exact) or mpmath.isinf(exact)
    assert bounded.error == math.inf
    assert not np.isfinite(interpret(program_of(e), Point(x=[at, 0.5]))["f"][0])


def test_a_branch_that_is_not_taken_does_not_spoil_the_bound():
    e = sp.Piecewise((1 / x, x > 0), (y, True))
    (found,) = interpret_with_bound(program_of(e), Point(x=[0.0, 2.5]))["f"]
    assert found.value == 2.5
    assert found.error < 1e-15


def test_doubles_overflow_and_fifty_digits_do_not():
    program = program_of(x * x, x * x / (y * y))
    point = Point(x=[1e200, 1e200])
    assert interpret(program, point)["f"][0] == math.inf
    assert math.isnan(interpret(program, point)["f"][1])
    assert interpret_exactly(program, point)["f"][1] == 1


@settings(max_examples=100)
@given(st.floats(-50, 50), st.floats(0.1, 50))
def test_doubles_stay_within_the_bound(a, b):
    e = [sp.sin(x) * y - x / y, sp.exp(-y) * (x + y) ** 3, sp.sqrt(y) - sp.log(y) * x, sp.atan2(y, x),
         sp.tanh(x) - sp.tanh(x * y), (x + 1) - x, y**x]  # fmt: skip
    program = program_of(*e)
    point = Point(x=[a, b])
    bounds = interpret_with_bound(program, point)["f"]
    for got, found in zip(interpret(program, point)["f"], bounds, strict=True):
        assert abs(mpmath.mpf(got) - found.value) <= found.error


def test_the_bound_is_not_generous():
    """Cancellation of 1e8 against 1e8 loses eight digits, and the bound says so, not more."""
    difference = program_of((x + sp.sin(y)) - x * sp.cos(y))
    (found,) = interpret_with_bound(difference, Point(x=[1e8, 1e-3]))["f"]
    assert 1e-9 < found.error < 1e-6
    (simple,) = interpret_with_bound(program_of(x * y), Point(x=[3.0, 5.0]))["f"]
    assert simple.error <= 4 * math.ulp(15.0)
    (exact,) = interpret_with_bound(program_of(-x), Point(x=[3.0, 5.0]))["f"]
    assert exact.error < 1e-300


def test_constants_are_the_nearest_doubles():
    program = lower_expressions({"f": [sp.sqrt(2) * sp.pi + x, sp.exp(1) / 3]}, (x, y))
    known = constants(program)
    values = set(known.values())
    assert float(sp.N(sp.sqrt(2) * sp.pi, 40)) in values
    assert float(sp.N(sp.E / 3, 40)) in values
    for k in known:
        op, args, _ = program.instructions[k]
        assert op in {"const", "pi", *OPS}
        assert all(a in known for a in args)
    assert not any(program.instructions[k].op == "state" for k in known)


z, w = sp.symbols("z w", real=True)
TINY = sp.Rational(1, 3 * 10**310)
HARD = {
    "underflow before a division": (x * y / z, (1e-170, 1e-150, 1e-300, 0.0)),
    "underflow under a root": (sp.sqrt(x**2 + y**2), (1e-170, 1e-170, 0.0, 0.0)),
    "kink of a modulus": (sp.Abs(x + y - z - w), (1e16, 1.0, 1e16, 1.0)),
    "edge of asin": (sp.asin(x + y - z), (1e16, 1.0, 1e16, 0.0)),
    "near tie": (sp.Max(x + y - z, w), (1e16, 1.0, 1e16, 0.5)),
    "cut of atan2": (sp.atan2(-y, x), (-1.0, 0.0, 0.0, 0.0)),
    "constant below the doubles": (sp.Rational(1, 10**320) * x, (1.0, 0.0, 0.0, 0.0)),
    "constant of long parts": (sp.Rational(10**400 + 1, 10**400) * x, (1.0, 0.0, 0.0, 0.0)),
    "period smaller than the error": (sp.Mod(sp.pi, x), (7.5e-83, 0.0, 0.0, 0.0)),
    "end of a period": (sp.Mod(x + y - z, w), (1e16, 3.0, 1e16, 2.0)),
    "step of floor": (sp.floor(x + y - z), (1e16, 1.0, 1e16, 0.0)),
    "squares that overflow": (sp.sqrt((x + y) ** 2 + z**2), (1e200, -1e200, 1e-200, 0.0)),
    "zero of a Bessel function": (sp.besselj(0, x), (5.520078110286311, 0.0, 0.0, 0.0)),
    "tail of erfc": (sp.erfc(x), (26.3, 0.0, 0.0, 0.0)),
    "quotient near zero": (sp.sin(x - y) / (x - y), (1.0, 1.0 + 2e-16, 0.0, 0.0)),
    "tiny constant, large variable": (TINY * x, (1e5, 0.0, 0.0, 0.0)),
}


@pytest.mark.parametrize("name", HARD)
def test_the_bound_holds_where_doubles_are_hard(name):
    expression, values = HARD[name]
    program = lower_expressions({"f": [expression]}, (x, y, z, w))
    point = Point(x=values)
    (bounded,) = interpret_with_bound(program, point)["f"]
    (double,) = interpret(program, point)["f"]
    assert not math.isnan(bounded.error)
    assert abs(double - bounded.value) <= bounded.error
