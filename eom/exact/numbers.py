"""Real numbers taken exactly from input, and compared exactly; real numbers to many digits as a field.

Integers, fractions and SymPy numbers stay what they are; floats become the fractions that they
are, and carry the relative tolerance `TOLERANCE` in comparisons.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import sympy as sp
from mpmath import MPContext
from sympy.core.evalf import PrecisionExhausted

from eom.errors import InputError
from eom.expressions import as_expression
from eom.fields import Field, Singular

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


# -- to many digits --------------------------------------------------------------------------------

MANY = 120
MP = MPContext()
MP.dps = MANY

Number = Any
"""A number of mpmath."""


@dataclass(frozen=True)
class Reals(Field):
    """Numbers of mpmath to the digits of a context, as a field."""

    prime: int = 0
    context: Any = MP

    @property
    def is_rational(self) -> bool:
        """Whether elements are fractions."""
        return False

    def of(self, numerator: Any, denominator: int = 1) -> Number:
        """Return a fraction."""
        return self.context.mpf(numerator) / denominator

    def inverse(self, value: Number) -> Number:
        """Return the reciprocal; raises `Singular` for zero."""
        if not value:
            raise Singular
        return 1 / self.context.convert(value)

    def root(self, value: Number) -> Number:
        """Return the square root, imaginary of what is negative; raises `Singular` for zero."""
        if not value:
            raise Singular
        return self.context.sqrt(value)


TINY = MP.mpf(10) ** (-MANY // 2)
"""What is smaller is zero in a comparison, among numbers of the size of one."""
_MET = {"==": {0}, "!=": {-1, 1}, "<": {-1}, ">": {1}, "<=": {-1, 0}, ">=": {0, 1}}
"""Which signs of a difference the relations of SymPy mean."""


def met(condition: Any, value: Callable[[Any], Number]) -> bool:
    """Return whether a condition of SymPy is met; ``value``: of its sides, to `MANY` digits."""
    if condition in {sp.true, sp.false}:
        return bool(condition)
    if isinstance(condition, sp.And | sp.Or):
        join = all if isinstance(condition, sp.And) else any
        return join(met(a, value) for a in condition.args)
    if isinstance(condition, sp.Not):
        return not met(condition.args[0], value)
    apart = value(condition.lhs) - value(condition.rhs)
    sign = 0 if abs(apart) < TINY else 1 if apart > 0 else -1
    return sign in _MET[condition.rel_op]


class Signed(Reals):
    """Numbers with a sign: none is imaginary, angles have their own sines, zeros are nearly so."""

    def root(self, value: Number) -> Number:
        """Return the square root that is positive; raises `Singular` for what is not."""
        if value < TINY:
            raise Singular
        return self.context.sqrt(value)

    def vanish(self, values: Iterable[Number]) -> bool:
        """Return whether all numbers are nearly zero."""
        return all(abs(v) < TINY for v in values)

    def quarter(self, angle: Number, drawn: Number) -> Number:  # noqa: ARG002 - the angle has its own
        """Return the tangent of a quarter of an angle."""
        return self.context.tan(self.context.convert(angle) / 4)

    def draw(self, generator: random.Random) -> Number:
        """Return a random number between 1/3 and 3 in size, positive three times in four."""
        sign = generator.choice((-1, 1, 1, 1))
        above = generator.randrange(10**6, 3 * 10**6)
        value = self.context.mpf(above) / (10**6 + 3)
        return sign * (value if generator.random() < HALF else 1 / value)


HALF = 0.5
SIGNED = Signed()
