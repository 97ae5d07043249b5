"""Scalars with a rate: what is computed of them comes with its derivative by time.

Griewank and Walther, Evaluating Derivatives, 2nd ed. (2008), ch. 3: forward propagation of a tangent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from eom.multibody.algebra.scalars import Scalar, Work, add, is_zero, mul, negative, reciprocal, sub


@dataclass(frozen=True)
class Dual:
    """A value and its rate. Operands are of its kind, or constant."""

    value: Scalar
    rate: Scalar

    def __add__(self, other: Any) -> Dual:
        x, dx = parts(other)
        return Dual(add(self.value, x), add(self.rate, dx))

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(negative(self.value), negative(self.rate))

    def __sub__(self, other: Any) -> Dual:
        x, dx = parts(other)
        return Dual(sub(self.value, x), sub(self.rate, dx))

    def __rsub__(self, other: Any) -> Dual:
        return Dual(sub(other, self.value), negative(self.rate))

    def __mul__(self, other: Any) -> Dual:
        x, dx = parts(other)
        return Dual(mul(self.value, x), add(mul(self.rate, x), mul(self.value, dx)))

    __rmul__ = __mul__

    def __rtruediv__(self, other: Any) -> Dual:
        inverse = reciprocal(self.value)
        found = mul(other, inverse)
        return Dual(found, negative(mul(mul(found, inverse), self.rate)))


def parts(x: Any) -> tuple[Scalar, Scalar]:
    """Return value and rate; a constant's is zero."""
    return (x.value, x.rate) if isinstance(x, Dual) else (x, 0)


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
