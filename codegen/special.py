"""Functions that NumPy lacks: Bessel functions, error functions, and tables; values and derivatives."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from eom.tables import Table

Number = Any
Context = Any


def scipy_function(name: str) -> Any:
    """Return a function of `scipy.special`, imported when it is called: most systems need none."""

    def call(*args: Any) -> Any:
        return np.float64(getattr(importlib.import_module("scipy.special"), name)(*args))

    return call


def bessel(m: Context, kind: str, n: Number, x: Number) -> Number:
    """Return J_n(x) (``kind`` besselj) or Y_n(x) (bessely) of integer order, NaN where not real."""
    if m.isnan(x) or (kind == "bessely" and x < 0):
        return m.nan
    if kind == "bessely" and x == 0:
        return -m.inf
    return m.mpf(0) if m.isinf(x) else getattr(m, kind)(int(n), x)


def bessel_slope(m: Context, kind: str, n: Number, x: Number) -> Number:
    """Return the derivative by x: (C_{n-1} - C_{n+1})/2 for C = J or Y (DLMF 10.6.1)."""
    n = int(n)
    before = bessel(m, kind, n - 1, x) if n > 0 else -bessel(m, kind, 1, x)
    return (before - bessel(m, kind, n + 1, x)) / 2


def bessel_scale(m: Context, kind: str, value: Number, n: Number, x: Number) -> Number:
    """Return what the rounding error is relative to.

    It is the size of the wave, as libraries are poor near its zeros; for J_n times the logarithm in
    the leading term (x/2)^n, which SciPy computes as a power, where x is small against n.
    """
    n = int(n)
    if x == 0:
        return abs(value)
    wave = abs(value) + min(abs(x) / max(1, n), 1) * abs(bessel_slope(m, kind, n, x))
    return wave * (1 + n * max(m.log(2 * n / abs(x)), 0)) if n and kind == "besselj" else wave


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
