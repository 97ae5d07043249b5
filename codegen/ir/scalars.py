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

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from numbers import Rational, Real
from typing import Any

from codegen.ir.ops import LEAVES, OPS
from codegen.ir.program import Builder, Program
from eom.errors import InputError, unknown_name

Plain = int | float | Fraction
"""Numbers that may stand beside scalars."""

MAX_UNROLLED_POWER = 64


class Scalar:
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
        """Tell the instruction."""
        op, args, value = self.builder.instructions[self.number]
        parts = (op, *args) if value is None else (op, value)
        return f"Scalar({self.number}: {' '.join(map(str, parts))})"

    def __add__(self, other: Any) -> Any:
        return _binary("add", self, other)

    def __radd__(self, other: Any) -> Any:
        return _binary("add", self, other)

    def __sub__(self, other: Any) -> Any:
        return _binary("sub", self, other)

    def __rsub__(self, other: Any) -> Any:
        return _reflected("sub", self, other)

    def __mul__(self, other: Any) -> Any:
        return _binary("mul", self, other)

    def __rmul__(self, other: Any) -> Any:
        return _binary("mul", self, other)

    def __truediv__(self, other: Any) -> Any:
        return _binary("div", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return _reflected("div", self, other)

    def __neg__(self) -> Scalar:
        return Scalar(self.builder, self.builder.add("neg", self.number))

    def __pos__(self) -> Scalar:
        return self

    def __abs__(self) -> Scalar:
        return Scalar(self.builder, self.builder.add("abs", self.number))

    def __pow__(self, other: Any) -> Any:
        if isinstance(other, int) and abs(other) <= MAX_UNROLLED_POWER:
            return _whole_power(self, other)
        return _binary("pow", self, other)

    def __rpow__(self, other: Any) -> Any:
        return _reflected("pow", self, other)

    def __lt__(self, other: Any) -> Any:
        return _binary("lt", self, other)

    def __le__(self, other: Any) -> Any:
        return _binary("le", self, other)

    def __gt__(self, other: Any) -> Any:
        return _reflected("lt", self, other)

    def __ge__(self, other: Any) -> Any:
        return _reflected("le", self, other)

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


_OPERANDS = (float, int, Scalar, Real)
"""What an operator takes; the usual kinds first, since `Real` is slow to test."""


def _binary(op: str, left: Scalar, right: Any) -> Any:
    b = left.builder
    if type(right) is Scalar and right.builder is b:
        return Scalar(b, b.add(op, left.number, right.number))
    if not isinstance(right, _OPERANDS):
        return NotImplemented
    return Scalar(b, b.add(op, left.number, _number(b, right)))


def _reflected(op: str, right: Scalar, left: Any) -> Any:
    if not isinstance(left, _OPERANDS):
        return NotImplemented
    b = right.builder
    return Scalar(b, b.add(op, _number(b, left), right.number))


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
    return Scalar(b, b.add("div", b.const(1), result) if exponent < 0 else result)


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
