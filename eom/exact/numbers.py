"""Real numbers taken exactly from input, and compared exactly.

Integers, fractions and SymPy numbers stay what they are; floats become the fractions that they
are, and carry the relative tolerance `TOLERANCE` in comparisons.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sympy as sp
from sympy.core.evalf import PrecisionExhausted

from eom.errors import InputError
from eom.expressions import as_expression

Expr = Any

TOLERANCE = sp.Rational(1, 10**12)
"""Where a float is among the numbers, what is smaller than this part of its scale is zero."""


def tolerance(values: Iterable[Any]) -> Expr:
    """Return `TOLERANCE` where a float is among the given ``values``, otherwise zero.

    >>> tolerance([1, sp.sqrt(2)]), tolerance([1, 0.5])
    (0, 1/1000000000000)
    """
    rounded = any(as_expression(v).has(sp.Float) for v in values)
    return TOLERANCE if rounded else sp.Integer(0)


def number(value: Any, where: str = "torque-free body") -> Expr:
    """Return a real number exactly, floats as fractions; raise `InputError` for what is none."""
    given = as_expression(value)
    if not (isinstance(given, sp.Expr) and given.is_number and given.is_finite and given.is_real):
        raise InputError("not a finite real number", where=where, got=value)
    exact = sp.Rational(given.evalf()) if given.has(sp.Float) else given
    if not abs(exact.evalf(20)) < sp.Integer(10) ** 100:
        raise InputError("number out of range", got=value, expected="below 1e100 in size")
    return exact


def sign(value: Expr, slack: Expr = 0) -> int:
    """Return the sign of an exact number; zero where its size is at most ``slack``.

    An algebraic number is zero where its minimal polynomial says so, any other to 100 digits.
    """
    value, x = sp.expand(value), sp.Dummy("x")
    if value == 0 or (slack != 0 and abs(value.evalf(40)) <= slack):
        return 0
    try:
        return 1 if value.evalf(40, strict=True) > 0 else -1
    except PrecisionExhausted:
        zero = not value.is_algebraic or sp.minimal_polynomial(value, x) == x
        return 0 if zero else int(sp.sign(value.evalf(40, maxn=100000)))
