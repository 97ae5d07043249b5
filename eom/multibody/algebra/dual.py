"""Scalars with a rate: what is computed of them comes with its derivative by time.

Griewank and Walther, Evaluating Derivatives, 2nd ed. (2008), ch. 3: forward propagation of a tangent.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from eom.fields import Operators
from eom.multibody.algebra.scalars import Scalar, Work, add, is_zero, mul, negative, reciprocal, sub


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
