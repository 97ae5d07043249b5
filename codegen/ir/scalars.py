"""Scalars with operators over a `Builder`: algorithms that are written for numbers build programs.

A recursion over bodies that uses ``+ - * /``, integer powers and the functions of this module runs on
these scalars as on floats, and leaves a straight-line program behind; SymPy has no part in it. Plain
numbers may stand beside scalars and are exact: a float is the dyadic fraction that it is.

>>> b = Builder()
>>> x, y = scalars(b, "state", 2)
>>> print(program(b, {"f": [x * sin(y) + x, 1]}))
0 = state 0
1 = state 1
2 = sin 1
3 = mul 0 2
4 = add 0 3
5 = const 1
f: 4 5
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from numbers import Rational, Real
from typing import Any

from codegen.ir import fold
from codegen.ir.ops import LEAVES, OPS
from codegen.ir.program import Builder, Program
from eom.errors import InputError, unknown_name
from eom.fields import Operators

Plain = int | float | Fraction
"""Numbers that may stand beside scalars."""

MAX_UNROLLED_POWER = 64


class Scalar(Operators):
    """A value of a program that is being built.

    ``==`` compares what is built, not values: equal scalars are one instruction, and a scalar equals a
    number if it is that constant. `equal` and ``<``, ``<=`` give conditions, for `where`; a
    condition that depends on values is neither true nor false while a program is being built.
    """

    __slots__ = ("builder", "number")

    def __init__(self, builder: Builder, number: int) -> None:
        self.builder = builder
        self.number = number

    def __repr__(self) -> str:
        """Return the instruction."""
        op, args, value = self.builder.instructions[self.number]
        parts = (op, *args) if value is None else (op, value)
        return f"Scalar({self.number}: {' '.join(map(str, parts))})"

    def operated(self, op: str, *operands: Any) -> Any:
        """Append an operation; plain numbers among the operands become constants."""
        b = self.builder
        if not all(isinstance(x, _OPERANDS) for x in operands):
            return NotImplemented
        return type(self)(b, b.add(op, *[_number(b, x) for x in operands]))

    def __pos__(self) -> Scalar:
        return self

    def __abs__(self) -> Any:
        return self.operated("abs", self)

    def __pow__(self, other: Any) -> Any:
        if isinstance(other, int) and abs(other) <= MAX_UNROLLED_POWER:
            return _whole_power(self, other)
        return self.operated("pow", self, other)

    def __rpow__(self, other: Any) -> Any:
        return self.operated("pow", other, self)

    def __lt__(self, other: Any) -> Any:
        return self.operated("lt", self, other)

    def __le__(self, other: Any) -> Any:
        return self.operated("le", self, other)

    def __gt__(self, other: Any) -> Any:
        return self.operated("lt", other, self)

    def __ge__(self, other: Any) -> Any:
        return self.operated("le", other, self)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Scalar):
            return self.builder is other.builder and self.number == other.number
        instruction = self.builder.instructions[self.number]
        return instruction.op == "const" and bool(instruction.value == other)

    def __hash__(self) -> int:
        return hash((id(self.builder), self.number))

    def __bool__(self) -> bool:
        """Return the truth of a constant. Raises `InputError` for everything else."""
        op, _, value = self.builder.instructions[self.number]
        if op == "const":
            return bool(value)
        raise InputError(
            "a scalar is neither true nor false while its program is being built",
            got=repr(self),
            hint="choose between values by where(condition, a, b)",
        )


def scalars(b: Builder, kind: str, count: int) -> list[Scalar]:
    """Return the first ``count`` slots of a kind: ``state``, ``parameter`` or ``input``.

    Raises `InputError` for another kind.
    """
    kinds = [k for k in LEAVES if k in {"state", "parameter", "input"}]
    if kind not in kinds:
        raise unknown_name("kind of slot", kind, kinds)
    return [Scalar(b, b.leaf(kind, k)) for k in range(count)]


def time(b: Builder) -> Scalar:
    """Return time."""
    return Scalar(b, b.leaf("time"))


def constant(b: Builder, value: Plain) -> Scalar:
    """Return an exact constant. Raises `InputError` for what is not a finite number."""
    return Scalar(b, _number(b, value))


def program(b: Builder, results: Mapping[str, Iterable[Scalar | Plain]]) -> Program:
    """Freeze what was built, with ``results`` by group; plain numbers are constants.

    Raises `InputError` for scalars of another builder and for what is not a finite number.
    """
    return b.program({g: [_number(b, v) for v in values] for g, values in results.items()})


def apply(op: str, *args: Any) -> Scalar:
    """Return the value of an operation of `codegen.ir.ops`; one argument at least is a scalar.

    Raises `InputError` for an unknown operation, a wrong number of arguments, and numbers alone.
    """
    if op not in OPS:
        raise unknown_name("operation", op, OPS)
    if len(args) != OPS[op].arity:
        raise InputError(f"{op} takes {OPS[op].arity} arguments", got=len(args))
    b = next((a.builder for a in args if isinstance(a, Scalar)), None)
    if b is None:
        raise InputError(
            f"{op} of plain numbers",
            got=", ".join(map(str, args)),
            expected="at least one Scalar",
            hint="make an exact number a Scalar by constant(builder, value)",
        )
    return Scalar(b, b.add(op, *[_number(b, a) for a in args]))


def _number(b: Builder, value: Any) -> int:
    """Return the instruction of a scalar of ``b`` or of a plain number."""
    if isinstance(value, Scalar):
        if value.builder is not b:
            raise InputError("scalars of two builders do not mix", got=repr(value))
        return value.number
    try:
        if isinstance(value, float | int):
            return b.const(value)
        if isinstance(value, Rational):
            return b.const(Fraction(int(value.numerator), int(value.denominator)))
        return b.const(Fraction(*value.as_integer_ratio()))
    except (AttributeError, OverflowError, ValueError):
        raise InputError("not a finite number", got=repr(value)[:200]) from None


_OPERANDS = (Scalar, float, int, Real)
"""What an operator takes; the usual kinds first, since `Real` is slow to test."""


def _whole_power(base: Scalar, exponent: int) -> Scalar:
    """Return a power by repeated squaring."""
    b = base.builder
    result, square, n = b.const(1), base.number, abs(exponent)
    while n:
        if n & 1:
            result = b.add("mul", result, square)
        n >>= 1
        if n:
            square = b.add("mul", square, square)
    return type(base)(b, b.add("div", b.const(1), result) if exponent < 0 else result)


def _unary(op: str) -> Callable[[Scalar], Scalar]:
    def function(x: Scalar) -> Scalar:
        return Scalar(x.builder, x.builder.add(op, x.number))

    function.__name__ = op
    function.__doc__ = f"Return {op} of a scalar."
    return function


sqrt = _unary("sqrt")
sin, cos, tan = map(_unary, ("sin", "cos", "tan"))
asin, acos, atan = map(_unary, ("asin", "acos", "atan"))
sinh, cosh, tanh = map(_unary, ("sinh", "cosh", "tanh"))
asinh, acosh, atanh = map(_unary, ("asinh", "acosh", "atanh"))
exp, log = _unary("exp"), _unary("log")
sign = _unary("sign")


def atan2(y: Any, x: Any) -> Scalar:
    """Return the angle of the point (x, y)."""
    return apply("atan2", y, x)


def minimum(x: Any, y: Any) -> Scalar:
    """Return the smaller of two values."""
    return apply("min", x, y)


def maximum(x: Any, y: Any) -> Scalar:
    """Return the larger of two values."""
    return apply("max", x, y)


def equal(x: Any, y: Any) -> Scalar:
    """Return the condition that two values are equal."""
    return apply("eq", x, y)


def where(condition: Any, x: Any, y: Any) -> Scalar:
    """Return ``x`` where the condition holds, else ``y``."""
    return apply("select", condition, x, y)


ROUNDER = 3.0 * 2.0**51
"""Added and taken away again, it rounds numbers below 2^51 to whole ones, halves to even."""
LARGEST_POWER = 1000
"""Powers of two beyond it are multiplied in parts."""


class Traced(Scalar):
    """A scalar in the place of an array: functions of NumPy that are called on it become operations.

    NumPy hands its functions to values that ask for them. What no operation gives is refused.
    """

    __slots__ = ()

    def __array_ufunc__(self, function: Any, method: str, *inputs: Any) -> Any:
        """Append the instruction of an elementwise function."""
        name = function.__name__
        if method != "__call__" or name not in {**_COMPOSED, **_UFUNCS}:
            return NotImplemented
        if name in _COMPOSED:
            return _COMPOSED[name](*inputs)
        return self.operated(_UFUNCS[name], *inputs)

    def __array_function__(self, function: Any, types: Any, args: Sequence[Any], named: Any) -> Any:
        """Append what a function of arrays stands for."""
        if named or function.__name__ not in _FUNCTIONS:
            return NotImplemented
        return _FUNCTIONS[function.__name__](*args)

    def __eq__(self, other: object) -> Any:
        return self.operated("eq", self, other)

    __hash__ = Scalar.__hash__


_UFUNCS = {
    "add": "add",
    "subtract": "sub",
    "multiply": "mul",
    "divide": "div",
    "negative": "neg",
    "absolute": "abs",
    "arctan2": "atan2",
    "less": "lt",
    "less_equal": "le",
    "minimum": "min",
    "maximum": "max",
    **{name: name for name in ("sqrt", "sin", "cos", "exp", "expm1", "hypot")},
}


def _rint(x: Traced) -> Any:
    """Round; sums of constants are exact and would not."""
    value = fold.constant(x.builder, x.number)
    if value is not None:
        return _full_like(x, float(round(value)))
    return (x + ROUNDER) - ROUNDER


def _ldexp(x: Any, exponent: int) -> Any:
    while abs(exponent) > LARGEST_POWER:
        step = LARGEST_POWER if exponent > 0 else -LARGEST_POWER
        x, exponent = x * 2.0**step, exponent - step
    return x * 2.0**exponent


def _full_like(x: Traced, value: float) -> Traced:
    return Traced(x.builder, _number(x.builder, value))


_COMPOSED: dict[str, Callable[..., Any]] = {"rint": _rint, "ldexp": _ldexp}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "where": lambda condition, a, b: condition.operated("select", condition, a, b),
    "stack": list,
    "full_like": _full_like,
    "zeros_like": lambda x: _full_like(x, 0.0),
    "ones_like": lambda x: _full_like(x, 1.0),
}


def traced(function: Callable[[Any], Sequence[Any]], group: str) -> Program:
    """Return the program of a function of one NumPy array; its results are the rows that it returns.

    The function runs once, on a `Traced` value, and its operations are folded by exact laws alone, so
    that error-free products stay what they are. Raises `TypeError` where it uses what no operation gives.

    >>> import numpy as np
    >>> print(traced(lambda t: [np.sin(2 * t), np.where(t < 0, -1.0, 1.0)], "y"))
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
    b = Builder(fold.RULE_SETS["exact"])
    return program(b, {group: function(Traced(b, b.leaf("state", 0)))})
