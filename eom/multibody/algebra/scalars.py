"""Arithmetic on scalars of any kind that leaves out what is zero or one by structure.

A scalar is a number, a fraction, a node of an expression graph, a CasADi symbol: whatever has ``+``,
``-``, ``*``, ``/`` among its kind and with numbers. A plain ``0`` or ``1`` (`int` or `Fraction`) is
structure, not a value: `add`, `sub` and `mul` skip it, whatever the other operand is, so that no kind
of scalar needs to fold by itself. Zeros of floating point are values.

Scalars with a rate: what is computed of them comes with its derivative by time.

Griewank and Walther, Evaluating Derivatives, 2nd ed. (2008), ch. 3: forward propagation of a tangent.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

from eom.fields import Operators

Scalar = Any
"""Anything with the operators; see above."""

_EXACT = frozenset({int, Fraction})


def is_zero(x: Scalar) -> bool:
    """Return whether ``x`` is zero by structure."""
    return type(x) in _EXACT and x == 0


def add(x: Scalar, y: Scalar) -> Scalar:
    """Return x + y."""
    if type(x) in _EXACT and x == 0:
        return y
    if type(y) in _EXACT and y == 0:
        return x
    return x + y


def sub(x: Scalar, y: Scalar) -> Scalar:
    """Return x - y; what is less itself is zero by structure."""
    if type(y) in _EXACT and y == 0:
        return x
    if x is y:
        return 0
    if type(x) in _EXACT and x == 0:
        return -y
    return x - y


def mul(x: Scalar, y: Scalar) -> Scalar:
    """Return x y."""
    if type(x) in _EXACT:
        if x == 0:
            return 0
        if x == 1:
            return y
        if x == -1:
            return -y
    if type(y) in _EXACT:
        if y == 0:
            return 0
        if y == 1:
            return x
        if y == -1:
            return -x
    return x * y


def total(values: Iterable[Scalar]) -> Scalar:
    """Return the sum."""
    result: Scalar = 0
    for value in values:
        result = add(result, value)
    return result


def negative(x: Scalar) -> Scalar:
    """Return -x."""
    return 0 if is_zero(x) else -x


def reciprocal(x: Scalar) -> Scalar:
    """Return 1 / x; of a whole number, a fraction."""
    return Fraction(1, x) if type(x) is int else 1 / x


class Work(Protocol):
    """What a recursion needs beside the operators: functions, and names for what is used again."""

    def sin(self, x: Scalar) -> Scalar:
        """Return the sine."""

    def cos(self, x: Scalar) -> Scalar:
        """Return the cosine."""

    def sqrt(self, x: Scalar) -> Scalar:
        """Return the square root."""

    def keep(self, letter: str, part: str, suffix: str, value: Scalar) -> Scalar:
        """Return a value that is used several times, under a name if this kind of scalar has names.

        ``letter``: a row of `eom.multibody.algebra.lazy_sums.LETTERS`. ``part``: the body or joint.
        """


@dataclass(frozen=True)
class Numbers:
    """Scalars without names: numbers, or scalars that share equal values by themselves."""

    sin: Callable[[Scalar], Scalar]
    cos: Callable[[Scalar], Scalar]
    sqrt: Callable[[Scalar], Scalar] = math.sqrt

    def keep(self, letter: str, part: str, suffix: str, value: Scalar) -> Scalar:  # noqa: ARG002
        """Return the value."""
        return value


@dataclass(frozen=True)
class Dual(Operators):
    """A value and its rate. Operands are of its kind, or constant."""

    value: Scalar
    rate: Scalar

    def operated(self, op: str, *operands: Any) -> Dual:
        """Return the result of an operation, with its rate."""
        return Dual(*_RULES[op](*map(parts, operands)))


def parts(x: Any) -> tuple[Scalar, Scalar]:
    """Return value and rate; a constant's is zero."""
    return (x.value, x.rate) if isinstance(x, Dual) else (x, 0)


Parts = tuple[Scalar, Scalar]


def _negative(x: Parts) -> Parts:
    return negative(x[0]), negative(x[1])


def _product(x: Parts, y: Parts) -> Parts:
    return mul(x[0], y[0]), add(mul(x[1], y[0]), mul(x[0], y[1]))


def _quotient(x: Parts, y: Parts) -> Parts:
    """(x/y)' = x'/y - x/y y'/y."""
    inverse = reciprocal(y[0])
    found = mul(x[0], inverse)
    return found, sub(mul(x[1], inverse), mul(mul(found, inverse), y[1]))


_RULES: dict[str, Callable[..., Parts]] = {
    "add": lambda x, y: (add(x[0], y[0]), add(x[1], y[1])),
    "sub": lambda x, y: (sub(x[0], y[0]), sub(x[1], y[1])),
    "neg": _negative,
    "mul": _product,
    "div": _quotient,
}


@dataclass(frozen=True)
class DualWork:
    """Functions of duals over those of their values; values get names, rates none."""

    work: Work

    def sin(self, x: Any) -> Any:
        """Return the sine."""
        value, rate = parts(x)
        return self._with(self.work.sin(value), mul(self.work.cos(value), rate))

    def cos(self, x: Any) -> Any:
        """Return the cosine."""
        value, rate = parts(x)
        return self._with(self.work.cos(value), negative(mul(self.work.sin(value), rate)))

    def sqrt(self, x: Any) -> Any:
        """Return the square root."""
        value, rate = parts(x)
        root = self.work.sqrt(value)
        return self._with(root, mul(rate, reciprocal(mul(2, root))))

    def keep(self, letter: str, part: str, suffix: str, value: Any) -> Any:
        """Return the value under a name, with its rate."""
        x, dx = parts(value)
        return self._with(self.work.keep(letter, part, suffix, x), dx)

    def _with(self, value: Scalar, rate: Scalar) -> Any:
        return value if is_zero(rate) else Dual(value, rate)
