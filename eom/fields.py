"""Exact fields: residues modulo a prime, or fractions; linear equations; fractions back from residues.

Operators of scalars that are no numbers, all by one method.

Elements are plain numbers, whole ones modulo the prime or `fractions.Fraction`; both packages compute with
them, so nothing else is imported here. A false identity of total degree d holds at a random point with a
chance of at most d over the prime (Schwartz and Zippel).
"""

from __future__ import annotations

import operator
import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt
from typing import Any

PRIME = 2**61 - 1
LARGE_PRIME = int(
    "31415926535897932384626433832795028841971693993751058209749445923078164062862089"
    "98628034825342117067982148086513282306647093844609550582231725359408128481118759"
)
"""The first prime after digits of pi: no number that people write is zero modulo it by its form."""


ARITHMETIC: dict[str, Callable[..., Any]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "neg": operator.neg,
}
"""Operations that need no division, by the names of `Operators`."""


class Singular(ArithmeticError):
    """A divisor happens to be zero; another point is drawn."""


class Operators:
    """Operators of scalars that are no numbers: each gives its name and its operands to `operated`.

    Names are ``add``, ``sub``, ``mul``, ``div`` and ``neg``. One operand at least is of the class. A number
    on the left of a sum or a product comes second, as if it stood on the right.
    """

    __slots__ = ()

    def operated(self, op: str, *operands: Any) -> Any:
        """Return the result of an operation; `NotImplemented` for operands of another kind."""
        raise NotImplementedError

    def __add__(self, other: Any) -> Any:
        return self.operated("add", self, other)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return self.operated("sub", self, other)

    def __rsub__(self, other: Any) -> Any:
        return self.operated("sub", other, self)

    def __mul__(self, other: Any) -> Any:
        return self.operated("mul", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return self.operated("div", self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return self.operated("div", other, self)

    def __neg__(self) -> Any:
        return self.operated("neg", self)


@dataclass(frozen=True)
class Field:
    """The integers modulo ``prime``, or the rationals where it is zero."""

    prime: int = PRIME

    @property
    def is_rational(self) -> bool:
        """Whether elements are fractions."""
        return not self.prime

    def reduce(self, value: Any) -> Any:
        """Return the representative of ``value``."""
        return value % self.prime if self.prime else value

    def of(self, numerator: Fraction | int, denominator: int = 1) -> Any:
        """Return the element that a fraction is; raises `Singular` where the prime divides below."""
        below = numerator.denominator * denominator
        if below == 1 and self.prime:
            return numerator.numerator % self.prime
        return self.reduce(numerator.numerator * self.inverse(below))

    def inverse(self, value: Any) -> Any:
        """Return the reciprocal; raises `Singular` for zero."""
        if self.reduce(value) == 0:
            raise Singular
        return pow(value, -1, self.prime) if self.prime else 1 / Fraction(value)

    def operated(self, op: str, *operands: Any) -> Any:
        """Return the result of an operation of `Operators`; raises `Singular` for a divisor zero."""
        if op == "div":
            return self.reduce(operands[0] * self.inverse(operands[1]))
        return self.reduce(ARITHMETIC[op](*operands))

    def total(self, values: Sequence[Any]) -> Any:
        """Return the sum of elements."""
        return self.reduce(sum(values))

    def product(self, values: Sequence[Any]) -> Any:
        """Return the product of elements."""
        result: Any = 1
        for value in values:
            result = self.reduce(result * value)
        return result

    def power(self, value: Any, exponent: int) -> Any:
        """Return a whole power; raises `Singular` for a negative one of zero."""
        value = value if exponent >= 0 else self.inverse(value)
        exponent = abs(exponent)
        return pow(value, exponent, self.prime) if self.prime else value**exponent

    def root(self, value: Any) -> Any:
        """Return the square root that is a square itself, or positive; raises `Singular` for none.

        The prime is 3 modulo 4, so that one root of every square is a square.
        """
        if self.prime:
            found: Any = pow(value, (self.prime + 1) // 4, self.prime)
        else:
            above, below = (isqrt(abs(n)) for n in Fraction(value).as_integer_ratio())
            found = Fraction(above, below)
        if found * found != value if not self.prime else (found * found - value) % self.prime:
            raise Singular
        return found

    def circle(self, tangent: Any) -> tuple[Any, Any]:
        """Return cosine and sine of the angle whose half has a tangent; raises `Singular`."""
        square = tangent * tangent
        scale = self.inverse(1 + square)
        return self.reduce((1 - square) * scale), self.reduce(2 * tangent * scale)

    def vanish(self, values: Iterable[Any]) -> bool:
        """Return whether all elements are zero."""
        return not any(values)

    def quarter(self, angle: Any, drawn: Any) -> Any:  # noqa: ARG002 - nothing algebraic ties it to that
        """Return the tangent of a quarter of an angle: the one that was ``drawn``."""
        return drawn

    def draw(self, generator: random.Random) -> Any:
        """Return a random element that is not zero: any, or a small fraction."""
        if self.prime:
            return generator.randrange(1, self.prime)
        sign = generator.choice((-1, 1))
        return sign * Fraction(generator.randint(1, 30), generator.randint(1, 7))

    def scaled(self, row: Iterable[Any], factor: Any) -> list[Any]:
        """Return ``factor`` ``row``, entry by entry."""
        p = self.prime
        return [factor * x % p for x in row] if p else [factor * x for x in row]

    def less(self, row: Sequence[Any], factor: Any, other: Sequence[Any]) -> list[Any]:
        """Return ``row`` - ``factor`` ``other``, entry by entry."""
        p = self.prime
        pairs = zip(row, other, strict=True)
        return [(x - factor * y) % p for x, y in pairs] if p else [x - factor * y for x, y in pairs]

    def fraction(self, value: int, largest: int = 0) -> Fraction | None:
        """Return the one fraction with a residue and a denominator up to ``largest``; None without one.

        Its numerator is below the prime over twice ``largest``; without it both have the same room.
        Source: Wang, SYMSAC 1981, p. 212; von zur Gathen and Gerhard, Modern Computer Algebra, sec. 5.10.

        >>> Field(101).fraction(Field(101).of(-3, 7))
        Fraction(-3, 7)
        """
        largest = largest or isqrt(self.prime // 2)
        above, below, s, t = self.prime, value % self.prime, 0, 1
        while 2 * below * largest >= self.prime:
            quotient = above // below
            above, below = below, above - quotient * below
            s, t = t, s - quotient * t
        return Fraction(below, t) if abs(t) <= largest else None


RESIDUES, LARGE_RESIDUES, RATIONALS = Field(PRIME), Field(LARGE_PRIME), Field(0)


class Echelon:
    """Rows in echelon form, taken in one by one; their pivots are 1 and in the first ``width`` columns."""

    def __init__(self, field: Field, width: int) -> None:
        self.field, self.width = field, width
        self.rows: dict[int, list[Any]] = {}

    def add(self, row: Iterable[Any]) -> bool:
        """Take in a row; return False for a contradiction: what is left of it stands behind ``width``."""
        field = self.field
        rest = field.scaled(row, 1)
        for place in range(self.width):
            if not rest[place]:
                continue
            if place not in self.rows:
                self.rows[place] = field.scaled(rest, field.inverse(rest[place]))
                return True
            rest = field.less(rest, rest[place], self.rows[place])
        return not any(rest)

    def column(self, number: int) -> dict[int, Any]:
        """Return a column of the reduced form by pivot; its own may not be one.

        Of a column behind ``width`` it solves the equations, unknowns without a pivot being zero.
        """
        known: dict[int, Any] = {}
        for place in sorted(self.rows, reverse=True):
            row = self.rows[place]
            rest = sum(row[k] * c for k, c in known.items())
            known[place] = self.field.reduce(row[number] - rest)
        return known


def reduced(rows: Sequence[Sequence[Any]], field: Field) -> tuple[list[list[Any]], list[int]]:
    """Return the reduced row echelon form without rows of zeros, and the pivot columns.

    >>> reduced([[2, 4, 2], [1, 2, 3]], RATIONALS)[1]
    [0, 2]
    """
    width = len(rows[0]) if rows else 0
    form = Echelon(field, width)
    for row in rows:
        form.add(row)
    pivots = sorted(form.rows)
    columns = [{c: 1} if c in form.rows else form.column(c) for c in range(width)]
    return [[column.get(p, 0) for column in columns] for p in pivots], pivots


def solve(matrix: Sequence[Sequence[Any]], right: Sequence[Any], field: Field) -> list[Any]:
    """Solve a square linear system in the field; raises `Singular`."""
    return [row[0] for row in solved(matrix, [[b] for b in right], field)]


def solved(
    matrix: Sequence[Sequence[Any]], right: Sequence[Sequence[Any]], field: Field
) -> list[list[Any]]:
    """Solve a square linear system for every column of ``right``; raises `Singular`."""
    n = len(matrix)
    form = Echelon(field, n)
    for row, sides in zip(matrix, right, strict=True):
        form.add([*row, *sides])
    if len(form.rows) < n:
        raise Singular
    columns = [form.column(n + k) for k in range(len(right[0]) if right else 0)]
    return [[column[i] for column in columns] for i in range(n)]


def sum_of_angles(
    turns: Iterable[tuple[Any, Any, int]], reduce: Callable[[Any], Any] = lambda x: x
) -> tuple[Any, Any]:
    """Return cosine and sine of a sum of angles, by the theorems of addition, in any ring.

    ``turns``: cosine and sine of each angle, and how often it is added; ``reduce``: brings results of
    operators to elements.
    """
    cosine, sine, started = 1, 0, False
    for c, s, count in turns:
        signed = s if count > 0 else reduce(-s)
        for _ in range(abs(count)):
            cosine, sine = (
                (reduce(cosine * c - sine * signed), reduce(sine * c + cosine * signed))
                if started
                else (c, signed)
            )
            started = True
    return cosine, sine
