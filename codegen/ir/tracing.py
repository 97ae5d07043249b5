"""Programs from functions that are written for NumPy arrays: the function runs once, on a `Traced` value.

NumPy hands its functions to values that ask for them (`__array_ufunc__`, `__array_function__`); a traced
value answers with an instruction. What is left behind is the straight-line program of the same
operations in the same order, folded by exact laws alone, so that error-free products stay what
they are. A function that branches on values, or uses what no operation gives, is refused.

>>> program = traced(lambda t: [np.sin(2 * t), np.where(t < 0, -1.0, 1.0)], "y")
>>> print(program)
0 = state 0
1 = const 2
2 = mul 0 1
3 = sin 2
4 = const 0
5 = lt 0 4
6 = const -1
7 = const 1
8 = select 5 6 7
y: 3 8
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from codegen.ir.fold import RULE_SETS, constant
from codegen.ir.program import Builder, Program

ROUNDER = 3.0 * 2.0**51
"""Added and taken away again, it rounds numbers below 2^51 to whole ones, halves to even."""
LARGEST_POWER = 1000
"""Powers of two beyond it are multiplied in parts."""

_UFUNCS: dict[Any, str] = {
    np.add: "add",
    np.subtract: "sub",
    np.multiply: "mul",
    np.true_divide: "div",
    np.negative: "neg",
    np.absolute: "abs",
    np.sqrt: "sqrt",
    np.sin: "sin",
    np.cos: "cos",
    np.exp: "exp",
    np.expm1: "expm1",
    np.arctan2: "atan2",
    np.hypot: "hypot",
    np.less: "lt",
    np.less_equal: "le",
    np.minimum: "min",
    np.maximum: "max",
}


class Traced(NDArrayOperatorsMixin):
    """A value of a program that is being built, in the place of an array."""

    def __init__(self, builder: Builder, number: int) -> None:
        self.builder = builder
        self.number = number

    def __array_ufunc__(self, function: Any, method: str, *inputs: Any) -> Any:
        """Append the instruction of an elementwise function."""
        if method != "__call__":
            return NotImplemented
        if function in _COMPOSED:
            return _COMPOSED[function](*inputs)
        if function not in _UFUNCS:
            return NotImplemented
        numbers = [_number(self.builder, v) for v in inputs]
        return Traced(self.builder, self.builder.add(_UFUNCS[function], *numbers))

    def __array_function__(self, function: Any, types: Any, args: Sequence[Any], named: Any) -> Any:
        """Append what a function of arrays stands for."""
        if named or function not in _FUNCTIONS:
            return NotImplemented
        return _FUNCTIONS[function](*args)


def _number(b: Builder, value: Any) -> int:
    return value.number if isinstance(value, Traced) else b.const(Fraction(float(value)))


def _rint(x: Traced) -> Any:
    """Round; sums of constants are exact and would not."""
    value = constant(x.builder, x.number)
    if value is not None:
        return _full_like(x, float(round(value)))
    return (x + ROUNDER) - ROUNDER


def _ldexp(x: Any, exponent: int) -> Any:
    while abs(exponent) > LARGEST_POWER:
        step = LARGEST_POWER if exponent > 0 else -LARGEST_POWER
        x, exponent = x * 2.0**step, exponent - step
    return x * 2.0**exponent


def _where(condition: Traced, a: Any, b: Any) -> Traced:
    builder = condition.builder
    numbers = [_number(builder, v) for v in (condition, a, b)]
    return Traced(builder, builder.add("select", *numbers))


def _full_like(x: Traced, value: float) -> Traced:
    return Traced(x.builder, _number(x.builder, value))


_COMPOSED: dict[Any, Callable[..., Any]] = {np.rint: _rint, np.ldexp: _ldexp}
_FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.where: _where,
    np.stack: list,
    np.full_like: _full_like,
    np.zeros_like: lambda x: _full_like(x, 0.0),
    np.ones_like: lambda x: _full_like(x, 1.0),
}


def traced(function: Callable[[Any], Sequence[Any]], group: str) -> Program:
    """Return the program of a function of one array; its results are the rows that it returns.

    Raises `TypeError` where the function uses what no operation gives.
    """
    b = Builder(RULE_SETS["exact"])
    results = function(Traced(b, b.leaf("state", 0)))
    return b.program({group: [_number(b, r) for r in results]})
