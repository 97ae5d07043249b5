"""Large expressions: work in proportion to size, counted in calls; depth without limit."""

import cProfile
import math
import pstats
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
import sympy as sp

from codegen import compile as compile_system
from codegen import simulate
from codegen.compiling.compiled import generate
from codegen.derivatives.derivative import jacobian
from codegen.frontend.lower import lower_expressions
from codegen.ir.program import RATES
from codegen.passes.strength import rescale
from eom.errors import InputError
from eom.quantities import TIME, Definition, Quantity
from eom.system import System, free_symbols, nodes, replaced

x, v = sp.symbols("x v", real=True)
TWICE = 2.3
"""Twice the size may cost so many times as much: n log n, and what is fixed."""


def _pieces(n):
    return sp.Piecewise(*[(k * x, x < k) for k in range(n)], (0, True))


def _nested_pieces(n):
    value = v
    for k in range(n):
        value = sp.Piecewise((value, x < k), (x * k, True))
    return value


def _squares(n):
    value = x
    for _ in range(n):
        value = sp.Add(sp.Mul(value, value, evaluate=False), v, evaluate=False)
    return value


KINDS: dict[str, tuple[int, Callable[[int], sp.Expr]]] = {
    "sines": (24, lambda n: sp.Add(*[sp.sin(k * x) / k for k in range(1, n + 1)])),
    "sines and parameters": (24, lambda n: sp.Add(*[sp.Symbol(f"a{k}") * sp.sin(k * x) for k in range(n)])),
    "exponentials": (24, lambda n: sp.Add(*[sp.exp(k * x) for k in range(1, n + 1)])),
    "cosines less": (24, lambda n: sp.Add(1, *[-sp.cos(k * x) for k in range(1, n + 1)])),
    "polynomial": (60, lambda n: sp.Add(*[x ** (k % 20) * v ** (k // 20) / (k + 1) for k in range(n)])),
    "factors": (40, lambda n: sp.Mul(*[x + k for k in range(1, n + 1)])),
    "sines multiplied": (32, lambda n: sp.Mul(*[sp.sin(k * x) for k in range(1, n + 1)])),
    "powers of two": (24, lambda n: sp.Add(*[2 ** (k % 9) * sp.sin(v + k) for k in range(1, n + 1)])),
    "squares of squares": (32, _squares),
    "pieces": (24, _pieces),
    "nested pieces": (24, _nested_pieces),
}  # fmt: skip


def calls(work):
    """Return how many functions ``work`` calls."""
    profile = cProfile.Profile()
    profile.runcall(work)
    return pstats.Stats(profile).total_calls


def doubled(make, work, n):
    """Return the calls for twice the size over those for the size; what is made is not counted."""
    small, large = make(n), make(2 * n)
    work(make(n // 4))  # what is done once is done before
    return calls(lambda: work(large)) / calls(lambda: work(small))


@pytest.mark.sparse(1)
@pytest.mark.parametrize("kind", KINDS)
def test_compiling_twice_as_much_costs_twice_as_much(kind):
    n, rate = KINDS[kind]

    def work(system):
        compiled = compile_system(system, "numpy")
        generate(compiled.program, compiled.layout, "c")

    ratio = doubled(lambda m: System.from_rates("large", {x: v, v: rate(m)}), work, n)
    assert 1.3 < ratio < TWICE


def _chain(n):
    q = sp.symbols(f"q:{n}", real=True)
    rates = {a: -2 * a for a in q}
    for a, b in pairwise(q):
        rates[a], rates[b] = rates[a] + b, rates[b] + a
    return System.from_rates("chain", rates)


def test_many_states_cost_in_proportion_to_their_number():
    assert 1.5 < doubled(_chain, lambda s: compile_system(s, "numpy"), 30) < TWICE


@pytest.mark.parametrize("kind", ["sines", "sines and parameters", "factors"])
def test_jacobians_cost_in_proportion_to_the_rates(kind):
    n, rate = KINDS[kind]

    def program(m):
        expression = rate(m)
        rest = sorted(free_symbols((expression,)) - {x, v}, key=str)
        return lower_expressions({RATES: [expression]}, (x, v), rest)

    ratio = doubled(program, lambda p: jacobian(p, RATES, modes=("forward",)), n)
    assert 1.3 < ratio < TWICE


def test_powers_of_two_are_followed_to_where_they_lead_and_no_further():
    def program(n):
        q = sp.symbols(f"q:{n}", real=True)
        return lower_expressions({RATES: [2 * sp.sin(a) for a in q]}, q)

    assert 1.5 < doubled(program, rescale, 40) < TWICE


# --- depth ------------------------------------------------------------------------------------------

DEEP = 10_000


def _nested(depth, inner=x):
    value = inner
    for _ in range(depth):
        value = sp.sin(value, evaluate=False)
    return value


@pytest.mark.slow
def test_a_sine_nested_ten_thousand_deep_is_compiled():
    compiled = compile_system(System.from_rates("deep", {x: v, v: _nested(DEEP)}), "numpy")
    expected = 0.7
    for _ in range(DEEP):
        expected = math.sin(expected)
    assert compiled.rhs(0, [0.7, 0.0])[1] == pytest.approx(expected, rel=1e-12)


def test_what_nests_deep_is_integrated():
    compiled = compile_system(System.from_rates("deep", {x: v, v: _nested(1500)}), "numpy")
    result = simulate(compiled, (0.5, 0.0), (0, 1), method="scipy:RK45")
    assert result.success
    assert np.isfinite(result.y).all()


def test_deep_expressions_are_checked_for_symbols_without_a_meaning():
    quantities = Quantity(x), Quantity(v)
    stranger = sp.Symbol("stranger")
    with pytest.raises(InputError, match="without a meaning") as error:
        System("deep", quantities, (v, _nested(3000, x + stranger)))
    assert error.value.got == "stranger"


def test_free_symbols_are_those_of_sympy():
    k = sp.Symbol("k")
    expressions = [
        x * sp.sin(v) + 1,
        sp.Sum(x * k, (k, 1, 3)),
        sp.Integral(sp.sin(k * v), (k, 0, x)),
        sp.Piecewise((x, v > 0), (TIME, True)),
        sp.Function("f")(x),
        sp.Derivative(sp.Function("f")(x), x),
        sp.Integer(3),
    ]
    for expression in expressions:
        assert free_symbols([expression]) == expression.free_symbols
    assert free_symbols(expressions) == {x, v, TIME}


# --- replacing ----------------------------------------------------------------------------------------


def test_parts_are_replaced_as_sympy_does_it():
    y, z = sp.symbols("y z")
    expression = sp.sin(x + y) ** 2 + sp.exp(x + y) + sp.Piecewise((x, y > 0), (y, True))
    for rule in ({}, {x: y}, {x: y, y: x}, {x + y: z}, {y: sp.Integer(2)}, {sp.exp(x + y): x}):
        assert replaced(expression, rule) == expression.xreplace(rule)
    assert replaced(expression, {z: x}) is expression


def test_definitions_that_are_used_twice_are_expanded_once():
    defined = [Quantity(sp.Symbol(f"d{k}", real=True)) for k in range(80)]
    before = x
    definitions = []
    for quantity in defined:
        definitions.append(Definition(quantity, sp.sin(before) + sp.cos(before)))
        before = quantity.symbol
    system = System("swelling", (Quantity(x),), (before,), definitions=tuple(definitions))
    assert sum(1 for _ in nodes([system.expand(before)])) == 1 + 3 * 80
