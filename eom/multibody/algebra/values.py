"""Values of a description of bodies: exact numbers, or SymPy expressions; checked when they are given."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from numbers import Rational, Real
from typing import Any

import sympy as sp

from eom.errors import InputError, entries
from eom.exact.identity import vanishes
from eom.system import as_expression

Value = Any
"""An `int`, a `Fraction` or a SymPy expression that is no number."""


class Decimal(Fraction):
    """A fraction that was given as a decimal number; results of arithmetic are fractions as any others."""

    __slots__ = ()


def decimal(number: float) -> Value:
    """Return a float exactly as the shortest decimal number that it is read from, a whole one as `int`.

    >>> decimal(0.05), decimal(2.0)
    (Decimal(1, 20), 2)
    """
    found = Decimal(repr(number))
    return found.numerator if found.denominator == 1 else found


def is_decimal(x: Value) -> bool:
    """Return whether a value is a decimal number, or an expression with one."""
    return isinstance(x, Decimal) or (isinstance(x, sp.Basic) and x.has(sp.Float))


TOLERANCE = 1e-9
"""How far from a rotation or a unit vector given numbers may be."""

NAMED_AXES = {
    sign + name: tuple(number * int(name == n) for n in "xyz")
    for sign, number in (("", 1), ("-", -1))
    for name in "xyz"
}


def value(given: Any, where: str) -> Value:
    """Return a number exactly, a float as the decimal number that it is written as; or an expression.

    Raises `InputError` for text, complex numbers, infinities and NaN.
    """
    if isinstance(given, bool):
        raise InputError("not a number", where=where, got=given)
    if isinstance(given, int):
        return given
    if isinstance(given, Rational):
        return _exact(Fraction(int(given.numerator), int(given.denominator)))
    if isinstance(given, Real):
        if not math.isfinite(given):
            raise InputError("not a finite number", where=where, got=given)
        return decimal(float(given))
    try:
        expression = as_expression(given)
    except InputError as error:
        raise InputError(error.what, where=where, got=error.got, hint=error.hint) from None
    if expression.is_number and expression.is_finite is False:
        raise InputError("not a finite number", where=where, got=given)
    if isinstance(expression, sp.Rational | sp.Float):
        return _of_sympy(expression)
    if not isinstance(expression, sp.Expr) or expression.is_real is False:
        raise InputError("not a real number or expression", where=where, got=given)
    return expression


def _exact(number: Fraction) -> Value:
    return number.numerator if number.denominator == 1 else number


def _of_sympy(number: Any) -> Value:
    """Return a number of SymPy exactly, a double as `decimal`."""
    exact = sp.Rational(number)
    if number.is_Float and sp.Rational(float(number)) == exact:
        return decimal(float(number))
    return _exact(Fraction(int(exact.p), int(exact.q)))


def is_number(x: Value) -> bool:
    """Return whether a value is a plain number."""
    return isinstance(x, int | Fraction)


def triple(given: Any, where: str) -> tuple[Value, Value, Value]:
    """Return three values. Raises `InputError` for anything else."""
    parts = _items(given, where)
    if len(parts) != 3:
        raise InputError("not three components", where=where, got=given)
    a, b, c = (value(p, where) for p in parts)
    return a, b, c


def matrix(given: Any, where: str) -> tuple[tuple[Value, ...], ...]:
    """Return three rows of three values. Raises `InputError` for anything else."""
    if isinstance(given, sp.MatrixBase):
        given = given.tolist()
    rows = _items(given, where)
    if len(rows) != 3:
        raise InputError("not a matrix of three rows", where=where, got=given)
    return tuple(triple(row, where) for row in rows)


def _items(given: Any, where: str) -> list[Any]:
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise InputError("not a list of numbers", where=where, got=given)
    return entries(given, where)


def symmetric(given: Any, where: str) -> tuple[tuple[Value, ...], ...]:
    """Return a symmetric matrix, given whole or by its three diagonal entries."""
    if isinstance(given, sp.MatrixBase):
        given = given.tolist()
    parts = _items(given, where)
    if len(parts) == 3 and not isinstance(parts[0], Iterable):
        a, b, c = triple(parts, where)
        return ((a, 0, 0), (0, b, 0), (0, 0, c))
    J = matrix(parts, where)
    if any(not same(J[i][j], J[j][i]) for i in range(3) for j in range(i)):
        raise InputError("the matrix is not symmetric", where=where, got=given)
    return tuple(tuple(J[min(i, j)][max(i, j)] for j in range(3)) for i in range(3))


def same(a: Value, b: Value) -> bool:
    """Return whether two values are equal; numbers to within rounding."""
    if is_number(a) and is_number(b):
        return bool(abs(a - b) <= TOLERANCE * (abs(a) + abs(b)))
    return bool(a == b or vanishes(as_expression(a) - as_expression(b)))


def rotation(given: Any, where: str) -> tuple[tuple[Value, ...], ...]:
    """Return a rotation matrix. Raises `InputError` for one of numbers that is none."""
    C = matrix(given, where)
    if not all(is_number(x) for row in C for x in row):
        return C
    for i in range(3):
        for j in range(3):
            product = sum(C[i][k] * C[j][k] for k in range(3))
            if abs(product - int(i == j)) > TOLERANCE:
                raise InputError(
                    "not a rotation matrix: its rows are not orthonormal", where=where, got=given
                )
    if (
        C[0][0] * (C[1][1] * C[2][2] - C[1][2] * C[2][1])
        - C[0][1] * (C[1][0] * C[2][2] - C[1][2] * C[2][0])
        + C[0][2] * (C[1][0] * C[2][1] - C[1][1] * C[2][0])
        < 0
    ):
        raise InputError("a reflection, not a rotation", where=where, got=given)
    return C


def unit(given: Any, where: str) -> tuple[Value, Value, Value]:
    """Return the unit vector along an axis: ``x``, ``-z``, or three components of any length.

    Raises `InputError` for a zero axis, and for symbolic components whose squares do not add to 1.
    """
    if isinstance(given, str):
        if given not in NAMED_AXES:
            raise InputError("unknown axis", where=where, got=given,
                             expected="x, y, z, -x, -y or -z")  # fmt: skip
        return triple(NAMED_AXES[given], where)
    a = triple(given, where)
    if all(map(is_number, a)):
        return _normalised(a, where)
    if not vanishes(sp.Add(*(as_expression(x) ** 2 for x in a)) - 1):
        raise InputError("the components of a symbolic axis must have squares that add to 1",
                         where=where, got=given,
                         hint="tilt the joint by the rotation of its placement instead")  # fmt: skip
    return a


def _normalised(a: Sequence[Any], where: str) -> tuple[Value, Value, Value]:
    square = Fraction(sum(x * x for x in a))
    if square == 0:
        raise InputError("the axis is zero", where=where, got=tuple(map(str, a)))
    largest = max(abs(x) for x in a)
    a = [Fraction(x) / largest for x in a]
    square = sum((x * x for x in a), Fraction(0))
    p, q = math.isqrt(square.numerator), math.isqrt(square.denominator)
    exact = p * p == square.numerator and q * q == square.denominator
    length = Fraction(p, q) if exact else Fraction(math.sqrt(square))
    x, y, z = (_exact(c / length) if exact else decimal(float(c / length)) for c in a)
    return x, y, z
