"""Functions that NumPy lacks: Bessel functions, error functions, and tables; values and derivatives."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from eom.tables import Table

Number = Any
Context = Any

FAR = 10**6
"""Where Hankel's expansion has more than 50 digits, over n^2 + 1: its terms fall by 10^-6 at least."""
WITHOUT_DIGITS = 10**15
HUGE = 10**9


def scipy_function(name: str) -> Any:
    """Return a function of `scipy.special`, imported when it is called: most systems need none."""

    def call(*args: Any) -> Any:
        return np.float64(getattr(importlib.import_module("scipy.special"), name)(*args))

    return call


def bessel(m: Context, kind: str, n: Number, x: Number) -> Number:
    """Return J_n(x) (``kind`` besselj) or Y_n(x) (bessely) of integer order, NaN where not real."""
    n = int(n)
    if m.isnan(x) or (kind == "bessely" and x < 0):
        return m.nan
    if kind == "bessely" and x == 0:
        return -m.inf
    if m.isinf(x):
        return m.mpf(0)
    if abs(x) <= FAR * (n * n + 1):
        return getattr(m, kind)(n, x)
    return (-1) ** (n * int(x < 0)) * _bessel_far(m, kind, n, abs(x))


def _bessel_far(m: Context, kind: str, n: int, x: Number) -> Number:
    """Hankel's expansion for large x (DLMF 10.17.3, 10.17.4); mpmath's functions take too long there."""
    sums, term, k = [m.mpf(0), m.mpf(0)], m.mpf(1), 0
    while abs(term) > m.eps**2:
        sums[k % 2] += term * (-1) ** (k // 2)
        k += 1
        term *= (4 * n * n - (2 * k - 1) ** 2) / (8 * k * x)
    turn = (n % 4) * m.pi / 2 + m.pi / 4
    sine = m.sin(x) * m.cos(turn) - m.cos(x) * m.sin(turn)
    cosine = m.cos(x) * m.cos(turn) + m.sin(x) * m.sin(turn)
    first, second = (cosine, -sine) if kind == "besselj" else (sine, cosine)
    return m.sqrt(2 / (m.pi * x)) * (first * sums[0] + second * sums[1])


def bessel_slope(m: Context, kind: str, n: Number, x: Number) -> Number:
    """Return the derivative by x: (C_{n-1} - C_{n+1})/2 for C = J or Y (DLMF 10.6.1)."""
    n = int(n)
    before = bessel(m, kind, n - 1, x) if n > 0 else -bessel(m, kind, 1, x)
    return (before - bessel(m, kind, n + 1, x)) / 2


def bessel_scale(m: Context, kind: str, value: Number, n: Number, x: Number) -> Number:
    """Return what the rounding error is relative to.

    It is the size of the wave, as libraries are poor near its zeros; for J_n times the logarithm in
    the leading term (x/2)^n, which SciPy computes as a power, where x is small against n. Beyond
    `WITHOUT_DIGITS` SciPy's functions are of the right size, but have no right digit.
    """
    n = int(n)
    if x == 0:
        return abs(value)
    wave = abs(value) + min(abs(x) / max(1, n), 1) * abs(bessel_slope(m, kind, n, x))
    if abs(x) > WITHOUT_DIGITS:
        return wave * 2**53
    return wave * (1 + n * max(m.log(2 * n / abs(x)), 0)) if n and kind == "besselj" else wave


def gauss(m: Context, x: Number) -> Number:
    """Return the derivative of erf, 2 exp(-x^2)/sqrt(pi)."""
    return m.mpf(0) if abs(x) > HUGE else 2 * m.exp(-x * x) / m.sqrt(m.pi)


def erfc(m: Context, x: Number) -> Number:
    """Return 1 - erf(x); zero where the exponent of its value is beyond use."""
    return m.mpf(0) if x > HUGE else m.erfc(x)


def expm1(m: Context, x: Number) -> Number:
    """Return exp(x) - 1; mpmath's own takes long for huge arguments."""
    return m.exp(x) - 1 if abs(x) > HUGE else m.expm1(x)


def erfc_scale(m: Context, value: Number, x: Number) -> Number:
    """Return what the rounding error is relative to: SciPy rounds x^2 before it takes exp(-x^2)."""
    return abs(value) * (1 + max(x, m.mpf(0)) ** 2)


# -- tables: the table stands before the argument -----------------------------------------------------


def table_double(table: Table, x: Any) -> Any:
    """Evaluate in double precision, as the targets do."""
    row, start = (0, table.breakpoints[0]) if np.isnan(x) else table.anchor(x)
    if table.flat_outside:
        x = np.clip(x, table.breakpoints[0], table.breakpoints[-1])
    h = np.float64(x) - start
    *lower, value = table.rows[row]
    for c in reversed(lower):
        value = c + h * value
    return value if lower else value + 0.0 * h


def table_exact(m: Context, table: Table, x: Number) -> Number:
    """Evaluate in a mpmath context."""
    if m.isnan(x):
        return m.nan
    row, start = table.anchor(x)
    if table.flat_outside and (x < table.breakpoints[0] or x > table.breakpoints[-1]):
        x = m.mpf(start)
    h, value = x - start, m.mpf(0)
    for c in reversed(table.exact_rows[row]):
        value = value * h + m.mpf(c.numerator) / c.denominator
    return value


def table_slope(m: Context, table: Table, x: Number) -> Number:
    """Return the derivative, from the right at a breakpoint."""
    return table_exact(m, table.derivative, x)


def table_scale(m: Context, _: Number, table: Table, x: Number) -> Number:
    """Return the sum of the moduli of the terms, which the rounding error is relative to."""
    row, start = table.anchor(x)
    outside = x < table.breakpoints[0] or x > table.breakpoints[-1]
    h = m.mpf(0) if outside and table.flat_outside else abs(x - start)
    return sum(abs(m.mpf(c.numerator) / c.denominator) * h**k
               for k, c in enumerate(table.exact_rows[row]))  # fmt: skip
