"""Phases that grow with time, reduced by a period without losing digits.

A rate and a period are held as sums of two doubles, 106 bits; the product with a time, which is exact
as given, is formed by Dekker's error-free product (Numer. Math. 18 (1971) 224). What is left after
whole periods are taken away is right to its own rounding, whatever the number of periods, as long
as that number is below 2^53.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Number = Any  # a mpmath real

HALVES = 134217729.0
"""2^27 + 1: cuts the 53 bits of a double into two halves (Dekker)."""


@dataclass(frozen=True)
class Pair:
    """A number as ``(high + low) 2^exponent``."""

    high: float
    low: float
    exponent: int = 0


def pair(value: Number) -> Pair:
    """Return a mpmath real as a plain sum of two doubles; it must lie within their range."""
    high = float(value)
    return Pair(high, float(value - high))


def scaled(value: Number) -> Pair:
    """Return a mpmath real of any size as two doubles and a power of two.

    >>> import mpmath
    >>> scaled(mpmath.mpf(3) * 2**2000)
    Pair(high=0.75, low=0.0, exponent=2002)
    """
    mantissa, exponent = value.context.frexp(value)
    high = float(mantissa)
    return Pair(high, float(mantissa - high), int(exponent))


def product(a: Array, b: float) -> tuple[Array, Array]:
    """Return ``a b`` rounded, and what the rounding took away; exact between 1e-290 and 1e290."""
    cut = HALVES * a
    a_high = cut - (cut - a)
    a_low = a - a_high
    b_high = HALVES * b - (HALVES * b - b)
    b_low = b - b_high
    rounded = a * b
    rest = ((a_high * b_high - rounded) + a_high * b_low + a_low * b_high) + a_low * b_low
    return rounded, rest


def reduced(t: Array, rate: Pair, offset: Pair, period: Pair) -> tuple[Array, Array]:
    """Return what is left of ``offset + rate t`` after whole periods, and how many were taken.

    The remainder is the least in size. ``period.high`` may be infinite: then none is taken.
    ``offset`` and ``period`` have no exponent.
    """
    time = np.ldexp(t, rate.exponent) if rate.high else np.zeros_like(t)
    high, low = product(time, rate.high)
    low = low + time * rate.low
    total = high + offset.high
    added = total - high
    low = low + ((high - (total - added)) + (offset.high - added)) + offset.low
    if np.isinf(period.high):
        return total + low, np.zeros_like(total)
    count = np.rint(total / period.high)
    taken, rest = product(count, period.high)
    return (total - taken) + ((low - rest) - count * period.low), count


def grown(t: Array, rate: Pair, offset: Pair) -> Array:
    """Return ``offset + rate t`` itself, in one double."""
    total: Array = np.ldexp(t, rate.exponent) * rate.high + offset.high
    return total


def parity(count: Array) -> Array:
    """Return 1 where a whole number is even, -1 where it is odd."""
    sign: Array = 1 - 2 * np.abs(count - 2 * np.rint(count / 2))
    return sign
