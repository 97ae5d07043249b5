"""Each row of the table of operations against mpmath: value, rounding error, partial derivatives."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from codegen.ir.ops import (
    INTEGER_FIRST,
    LEAVES,
    OPS,
    SOLVE,
    TRUTH_VALUES,
    WITH_DATA,
    Instruction,
    row_of,
)
from eom.tables import Table

DOMAINS = {
    "sqrt": (0.01, 9), "log": (0.01, 9), "asin": (-0.99, 0.99), "acos": (-0.99, 0.99),
    "acosh": (1.01, 9), "atanh": (-0.99, 0.99), "tan": (-1.5, 1.5), "log1p": (-0.99, 9),
    "besselj": (-30, 30), "bessely": (0.01, 30), "stumpff": (-60, 60), "erfc": (-3, 25),
}  # fmt: skip
MEANING = {
    "add": mpmath.fadd, "sub": mpmath.fsub, "mul": mpmath.fmul, "div": mpmath.fdiv,
    "neg": lambda a: -a, "sqrt": mpmath.sqrt, "pow": lambda a, b: mpmath.exp(b * mpmath.log(a)),
    "atan2": lambda b, a: mpmath.arg(mpmath.mpc(a, b)), "abs": lambda a: mpmath.sqrt(a * a),
    "sign": lambda a: a / mpmath.sqrt(a * a) if a else a,
    "min": lambda a, b: (a + b - mpmath.fabs(a - b)) / 2,
    "max": lambda a, b: (a + b + mpmath.fabs(a - b)) / 2,
    "lt": lambda a, b: (b - a) > 0, "le": lambda a, b: (b - a) >= 0, "eq": lambda a, b: a - b == 0,
    "and": lambda a, b: a * b != 0, "or": lambda a, b: abs(a) + abs(b) != 0,
    "not": lambda a: 1 - bool(a), "select": lambda c, a, b: (a, b)[c == 0],
    "floor": lambda a: a - mpmath.frac(a), "mod": lambda a, b: b * mpmath.frac(a / b),
    "hypot": lambda a, b: mpmath.sqrt(a * a + b * b), "erf": lambda a: 1 - mpmath.erfc(a),
    "erfc": lambda a: mpmath.gammainc(0.5, a * a) / mpmath.sqrt(mpmath.pi) if a > 0 else 1 + mpmath.erf(-a),
    "expm1": mpmath.expm1, "log1p": mpmath.log1p,
    "besselj": lambda n, a: (a / 2) ** int(n) / mpmath.factorial(n) * mpmath.hyp0f1(n + 1, -a * a / 4),
    "bessely": lambda n, a: -2 / mpmath.pi * mpmath.re(
        mpmath.exp(-n * mpmath.pi * mpmath.j / 2) * mpmath.besselk(n, -mpmath.j * a)
    ),  # DLMF 10.27.10
    "stumpff": lambda k, z: mpmath.hyp1f2(1, (k + 1) / 2, (k + 2) / 2, -z / 4) / mpmath.factorial(k),
    "table": lambda a: mpmath.mpf(2) * a if 0 < a < 1 else mpmath.mpf(0 if a < 1 else 2),
    **{f: getattr(mpmath, f) for f in ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh",
       "tanh", "asinh", "acosh", "atanh", "exp", "log")},
}  # fmt: skip


RAMP = Table("ramp", [0, 1], [0, 2])


@pytest.fixture(params=[op for op in OPS if op not in SOLVE])
def op(request):
    """Each row but those of linear systems (see test_linsolve); the one with data bound to a ramp."""
    name = request.param
    return row_of(Instruction(name, (), RAMP if name in WITH_DATA else None))


def arguments(op, rng):
    low, high = DOMAINS.get(op.name, (-3, 3))
    values = [float(v) for v in rng.uniform(low, high, op.arity)]
    if op.name == "pow":
        values[0] = abs(values[0]) + 0.01
    if op.name in INTEGER_FIRST:
        values[0] = float(rng.integers(1, 7))
    if op.name in TRUTH_VALUES or op.name == "select":
        values[0] = float(rng.integers(0, 2)) if op.name not in {"lt", "le", "eq"} else values[0]
        if op.name in {"and", "or"}:
            values[1] = float(rng.integers(0, 2))
        if op.name in {"le", "eq"} and rng.integers(0, 2):
            values[1] = values[0]
    return values


def test_rows_are_filed_under_their_names():
    assert all(name == row.name for name, row in OPS.items())
    assert set(MEANING) | SOLVE == set(OPS)
    assert not set(MEANING) & SOLVE
    assert not set(LEAVES) & set(OPS)
    assert set(OPS) >= TRUTH_VALUES
    assert all(0 <= row.ulps <= 16 for row in OPS.values())
    assert all((row.cost > 0) == (name not in SOLVE) for name, row in OPS.items())
    assert all(row.scale is not None for row in OPS.values() if row.ulps > 4)


def test_exact_value_and_double_value_are_those_of_the_definition(op):
    rng = np.random.default_rng(1)
    with mpmath.workdps(50):
        for _ in range(40):
            values = arguments(op, rng)
            exact = op.exact(mpmath.mp, *map(mpmath.mpf, values))
            expected = mpmath.mpf(MEANING[op.name](*map(mpmath.mpf, values)))
            assert abs(exact - expected) <= mpmath.mpf(10) ** -45 * (1 + abs(expected))
            double = float(op.double(*map(np.float64, values)))
            size = op.scale(mpmath.mp, exact, *map(mpmath.mpf, values)) if op.scale else expected
            assert abs(double - expected) <= op.ulps * math.ulp(float(size))


def test_partial_derivatives_are_those_of_difference_quotients(op):
    rng = np.random.default_rng(2)
    flat = TRUTH_VALUES | {"sign", "select", "floor"}
    with mpmath.workdps(60):
        h = mpmath.mpf(10) ** -25
        for _ in range(20):
            values = [mpmath.mpf(v) for v in arguments(op, rng)]
            value = op.exact(mpmath.mp, *values)
            slopes = op.partials(mpmath.mp, value, *values)
            assert len(slopes) == op.arity
            for k, slope in enumerate(slopes):
                if (op.name in flat and (op.name != "select" or k == 0)) or (
                    op.name in INTEGER_FIRST and k == 0
                ):
                    assert slope == 0
                    continue
                up, down = list(values), list(values)
                up[k], down[k] = values[k] + h, values[k] - h
                quotient = (op.exact(mpmath.mp, *up) - op.exact(mpmath.mp, *down)) / (2 * h)
                assert abs(slope - quotient) < mpmath.mpf(10) ** -20 * (1 + abs(quotient))


@given(st.floats(), st.floats())
def test_commutative_operations_commute(a, b):
    with np.errstate(all="ignore"):
        for row in OPS.values():
            if row.commutative:
                first, second = np.float64(a), np.float64(b)
                one, other = row.double(first, second), row.double(second, first)
                np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("name", ["min", "max"])
def test_the_least_and_the_greatest_of_nan_are_nan_in_every_precision(name):
    row = OPS[name]
    for a, b in ((math.nan, 1.0), (1.0, math.nan)):
        assert np.isnan(row.double(a, b))
        assert mpmath.isnan(row.exact(mpmath.mp, mpmath.mpf(a), mpmath.mpf(b)))
