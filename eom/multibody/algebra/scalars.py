"""Arithmetic on scalars of any kind that leaves out what is zero or one by structure.

A scalar is a number, a fraction, a node of an expression graph, a CasADi symbol: whatever has ``+``,
``-``, ``*``, ``/`` among its kind and with numbers. A plain ``0`` or ``1`` (`int` or `Fraction`) is
structure, not a value: `add`, `sub` and `mul` skip it, whatever the other operand is, so that no kind
of scalar needs to fold by itself. Zeros of floating point are values.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

Scalar = Any
"""Anything with the operators; see above."""

_EXACT = frozenset({int, Fraction})


def is_zero(x: Scalar) -> bool:
    """Tell whether ``x`` is zero by structure."""
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
