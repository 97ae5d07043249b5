"""Torque-free rotation in its own frame: axes by moment, and constants in 50 digits.

Frame P has its axes along the principal axes, turned so that p3 is the axis about which the angular
velocity circles (that of greatest or least moment), p2 the intermediate one, and the angular
velocity at t = 0 has components >= 0 along p1 and p3. With moments I1, I2, I3 in P and dij = |Ii - Ij|

    A = |H^2 - 2 T I2| = I3 d32 w3^2 - I1 d21 w1^2
    B = |H^2 - 2 T I3| = I1 d31 w1^2 + I2 d32 w2^2
    C = |H^2 - 2 T I1| = I2 d21 w2^2 + I3 d31 w3^2

    m = d21 B/(d32 C),  1 - m = d31 A/(d32 C),  p^2 = d32 C/(I1 I2 I3)

(Whittaker, Analytical Dynamics, 4th ed. (1937), sec. 69; Lawden, Elliptic Functions and Applications
(1989), ch. 5). The data are doubles, so that all of these are computed as fractions: A, the one
that is a difference, is zero exactly where the motion is on the separatrix, and has all its digits
beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from threading import get_ident
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Number = Any  # a mpmath real
Triple = tuple[Fraction, Fraction, Fraction]
Rational = float | Fraction

DIGITS = 50


@dataclass(frozen=True)
class Frame:
    """P in the body: ``axes`` lists the body axes along p1, p2, p3, ``signs`` their senses."""

    axes: tuple[int, int, int]
    signs: tuple[int, int, int]

    def to_body(self, components: Array) -> Array:
        """Return components in the body of vectors given in P; shape (3, ...)."""
        return np.stack(self.listed(list(components)))

    def listed(self, components: Sequence[Any]) -> list[Any]:
        """Return the same as a list of components, of any numbers."""
        signed = zip(components, self.signs, strict=True)
        rows = [row if sign > 0 else -row for row, sign in signed]
        return [rows[self.axes.index(k)] for k in range(3)]


@dataclass(frozen=True)
class Polhode:
    """Moments and angular velocity in P, exactly, and the differences that decide the motion."""

    frame: Frame
    moments: Triple
    omega: Triple

    @property
    def sense(self) -> int:
        """1 where p3 is the axis of greatest moment, -1 where of least."""
        return 1 if self.moments[2] > self.moments[0] else -1

    @property
    def differences(self) -> Triple:
        """d21, d32, d31."""
        a, b, c = self.moments
        return abs(b - a), abs(c - b), abs(c - a)

    @property
    def A(self) -> Fraction:
        """|H^2 - 2 T I2|: zero on the separatrix."""
        (a, _, c), (x, _, z), (d21, d32, _) = self.moments, self.omega, self.differences
        return c * d32 * z * z - a * d21 * x * x

    @property
    def B(self) -> Fraction:
        """|H^2 - 2 T I3|: zero where the spin is about p3."""
        (a, b, _), (x, y, _), (_, d32, d31) = self.moments, self.omega, self.differences
        return a * d31 * x * x + b * d32 * y * y

    @property
    def C(self) -> Fraction:
        """|H^2 - 2 T I1|."""
        (_, b, c), (_, y, z), (d21, _, d31) = self.moments, self.omega, self.differences
        return b * d21 * y * y + c * d31 * z * z

    @property
    def H2(self) -> Fraction:
        """The square of the angular momentum."""
        pairs = zip(self.moments, self.omega, strict=True)
        return sum(((I * w) ** 2 for I, w in pairs), Fraction(0))

    @property
    def steady(self) -> bool:
        """Whether omega x (J omega) is zero exactly."""
        (x, y, z), (d21, d32, d31) = self.omega, self.differences
        return not (d21 * x * y or d32 * y * z or d31 * x * z)


def polhode(moments: Sequence[Rational], omega: Sequence[Rational]) -> Polhode:
    """Return the motion of these principal moments and this angular velocity, in P.

    They are numbers that are fractions: doubles, or fractions themselves.
    """
    I, w = [Fraction(v) for v in moments], [Fraction(v) for v in omega]
    least, middle, greatest = sorted(range(3), key=lambda k: I[k])
    excess = I[greatest] * (I[greatest] - I[middle]) * w[greatest] ** 2
    excess -= I[least] * (I[middle] - I[least]) * w[least] ** 2
    axes = (least, middle, greatest) if excess >= 0 else (greatest, middle, least)
    first, third = (1 if w[k] >= 0 else -1 for k in (axes[0], axes[2]))
    even = axes in {(0, 1, 2), (1, 2, 0), (2, 0, 1)}
    signs = (first, first * third * (1 if even else -1), third)
    a, b, c = (w[k] * sign for k, sign in zip(axes, signs, strict=True))
    i, j, k = axes
    return Polhode(Frame(axes, signs), (I[i], I[j], I[k]), (a, b, c))


def context(digits: int = DIGITS) -> Any:
    """Return the mpmath context of so many digits of this thread, which nobody else changes.

    Some functions of mpmath raise the precision of their context while they compute.
    """
    return _context(digits, get_ident())


@lru_cache(maxsize=64)
def _context(digits: int, _thread: int) -> Any:
    own = mpmath.mp.clone()
    own.dps = digits
    return own


def number(own: Any, value: Fraction) -> Number:
    """Return a fraction in a mpmath context."""
    return own.mpf(value.numerator) / own.mpf(value.denominator)


def root(own: Any, value: Fraction) -> Number:
    """Return the square root of a fraction in a mpmath context."""
    return own.sqrt(number(own, value))
