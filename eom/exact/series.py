"""Truncated power series in time over an exact field, and vectors and matrices of them.

A series is the tuple of its coefficients c0 + c1 t + c2 t^2 ...; an operation keeps as many as are
known for certain, so a derivative is one shorter.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import lcm
from operator import add as plus
from operator import mul
from operator import sub as minus
from typing import Any

from eom.errors import InputError
from eom.fields import RATIONALS, Field

LENGTH = 5
"""Coefficients of a motion: up to four derivatives."""


@dataclass(frozen=True)
class Series:
    """Coefficients in ascending powers of time."""

    field: Field
    coefficients: tuple[Any, ...]

    def __add__(self, other: Series) -> Series:
        return _series(self.field, list(map(plus, self.coefficients, other.coefficients)))

    def __neg__(self) -> Series:
        return _series(self.field, [-a for a in self.coefficients])

    def __sub__(self, other: Series) -> Series:
        return _series(self.field, list(map(minus, self.coefficients, other.coefficients)))

    def __mul__(self, other: Series) -> Series:
        if self.field.is_rational:
            return _rational_dot(((self, other),))
        return _series(self.field, _convolved(self.coefficients, other.coefficients))

    def scaled(self, factor: Any) -> Series:
        """Return ``factor``, an element of the field, times this series."""
        return _series(self.field, [factor * a for a in self.coefficients])

    def reciprocal(self) -> Series:
        """Return 1 / series; raises `Singular` where its first coefficient is zero."""
        a = self.coefficients
        first = self.field.inverse(a[0])
        result = [first]
        for k in range(1, len(a)):
            known = sum(a[j] * result[k - j] for j in range(1, k + 1))
            result.append(self.field.reduce(-known * first))
        return Series(self.field, tuple(result))

    def derivative(self) -> Series:
        """Return d/dt; one coefficient is lost."""
        return _series(self.field, [k * a for k, a in enumerate(self.coefficients) if k])

    def primitive(self) -> Series:
        """Return the integral from t = 0; one coefficient is won."""
        steps = (self.field.inverse(k) for k in range(1, len(self.coefficients) + 1))
        rest = [a * step for a, step in zip(self.coefficients, steps, strict=True)]
        return _series(self.field, [0, *rest])

    @property
    def is_zero(self) -> bool:
        """Whether every known coefficient is zero; there must be one."""
        if not self.coefficients:
            raise InputError(
                "more derivatives than a world holds", expected=f"at most {LENGTH - 1} in all"
            )
        return self.field.vanish(self.coefficients)


def _series(field: Field, values: Sequence[Any]) -> Series:
    """Return the series whose coefficients these values represent."""
    prime = field.prime
    return Series(field, tuple([v % prime for v in values] if prime else values))


def _convolved(a: Sequence[Any], b: Sequence[Any]) -> Sequence[Any]:
    """Return the coefficients of the product of two series, not reduced; the longer one is cut."""
    n = min(len(a), len(b))
    if n in _CONVOLUTIONS:
        return _CONVOLUTIONS[n](*a[:n], *b[:n])
    backwards = b[:n][::-1]
    return [sum(map(mul, a, backwards[n - 1 - k :])) for k in range(n)]


def _rational_dot(pairs: Iterable[tuple[Series, Series]]) -> Series:
    """Return the sum of products over the rationals: whole numbers over one denominator a product."""
    parts = []
    for one, other in pairs:
        (a, below), (b, beneath) = _whole(one.coefficients), _whole(other.coefficients)
        parts.append((_convolved(a, b), below * beneath))
    under = lcm(*(d for _, d in parts))
    rows = [[v * (under // d) for v in values] for values, d in parts]
    return Series(
        RATIONALS, tuple(Fraction(sum(column), under) for column in zip(*rows, strict=False))
    )


def _whole(values: Sequence[Any]) -> tuple[list[int], int]:
    """Return whole numbers and what they are divided by."""
    under = lcm(*(v.denominator for v in values))
    return [v.numerator * (under // v.denominator) for v in values], under


_CONVOLUTIONS: dict[int, Callable[..., Sequence[Any]]] = {
    3: lambda a, b, c, x, y, z: (a * x, a * y + b * x, a * z + b * y + c * x),
    4: lambda a, b, c, d, w, x, y, z: (
        a * w,
        a * x + b * w,
        a * y + b * x + c * w,
        a * z + b * y + c * x + d * w,
    ),
    5: lambda a, b, c, d, e, v, w, x, y, z: (
        a * v,
        a * w + b * v,
        a * x + b * w + c * v,
        a * y + b * x + c * w + d * v,
        a * z + b * y + c * x + d * w + e * v,
    ),
}
"""The lengths of a motion and of its first two derivatives, written out: they take most of the time."""

Vector = tuple[Series, Series, Series]
Matrix = tuple[tuple[Series, ...], ...]


def root(square: Series) -> Series:
    """Return the square root whose first coefficient is a square itself, or positive among fractions.

    So the root of a product is the product of the roots. Raises `Singular` where there is none.
    """
    a, field = square.coefficients, square.field
    first = field.root(a[0])
    half = field.inverse(2 * first)
    found = [first]
    for n in range(1, len(a)):
        known = sum(found[k] * found[n - k] for k in range(1, n))
        found.append(field.reduce((a[n] - known) * half))
    return Series(field, tuple(found))


def constant(field: Field, value: Any, length: int) -> Series:
    """Return a series that does not change."""
    return Series(field, (value,) + (0,) * (length - 1))


@dataclass(frozen=True)
class Ring:
    """The series over a field, constants with ``length`` coefficients: see `eom.exact.rings`."""

    field: Field
    length: int

    def of(self, numerator: int, denominator: int = 1) -> Series:
        """Return a fraction as a series that does not change."""
        return constant(self.field, self.field.of(numerator, denominator), self.length)

    def reduce(self, value: Series) -> Series:
        """Return the series itself."""
        return value

    def total(self, values: Sequence[Series]) -> Series:
        """Return the sum of series."""
        return total(values)

    def product(self, values: Sequence[Series]) -> Series:
        """Return the product of series."""
        return reduce(mul, values)

    def power(self, value: Series, exponent: int) -> Series:
        """Return a whole power, not the power 0."""
        return reduce(mul, [value if exponent > 0 else value.reciprocal()] * abs(exponent))

    def inverse(self, value: Series) -> Series:
        """Return the reciprocal; raises `Singular`."""
        return value.reciprocal()


def sine_cosine(angle: Series, sine: Any, cosine: Any) -> tuple[Series, Series]:
    """Return sin and cos of ``angle`` from their values at t = 0: s' = c angle', c' = -s angle'."""
    s, c = [sine], [cosine]
    rate = angle.derivative().coefficients
    field = angle.field
    for n in range(len(rate)):
        step = field.inverse(n + 1)
        s_next = sum(rate[k] * c[n - k] for k in range(n + 1))
        c_next = -sum(rate[k] * s[n - k] for k in range(n + 1))
        s.append(field.reduce(s_next * step))
        c.append(field.reduce(c_next * step))
    return Series(field, tuple(s)), Series(field, tuple(c))


def total(terms: Sequence[Series]) -> Series:
    """Return the sum of one series or more."""
    columns = zip(*(t.coefficients for t in terms), strict=False)
    return _series(terms[0].field, [sum(c) for c in columns])


def each(rule: Callable[[Series], Series], a: Any) -> Any:
    """Apply ``rule`` to a series, or to every component of a vector or a matrix."""
    return rule(a) if isinstance(a, Series) else tuple(each(rule, x) for x in a)


def entrywise(rule: Callable[[Series, Series], Series], a: Any, b: Any) -> Any:
    """Combine two series, vectors or matrices of one shape component by component."""
    if isinstance(a, Series):
        return rule(a, b)
    return tuple(entrywise(rule, x, y) for x, y in zip(a, b, strict=True))


def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def subtract(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(factor: Series, a: Vector) -> Vector:
    """Return factor a."""
    return (factor * a[0], factor * a[1], factor * a[2])


def cross(a: Vector, b: Vector) -> Vector:
    """Return a x b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def dot(a: Sequence[Series], b: Sequence[Series]) -> Series:
    """Return the sum of the products of the components."""
    pairs = zip(a, b, strict=True)
    if a[0].field.is_rational:
        return _rational_dot(pairs)
    products = [_convolved(x.coefficients, y.coefficients) for x, y in pairs]
    return _series(a[0].field, [sum(c) for c in zip(*products, strict=False)])


def centre(masses: Sequence[Series], places: Sequence[Vector]) -> Vector:
    """Return the mean of ``places`` with weights ``masses``."""
    scale_by = total(masses).reciprocal()
    x, y, z = (
        total([m * p[k] for m, p in zip(masses, places, strict=True)]) * scale_by for k in range(3)
    )
    return (x, y, z)


def spin_momentum(masses: Sequence[Series], places: Sequence[Vector]) -> Vector:
    """Return the angular momentum of particles about their centre of mass."""
    middle = centre(masses, places)
    parts = []
    for mass, place in zip(masses, places, strict=True):
        r = subtract(place, middle)
        rate = (r[0].derivative(), r[1].derivative(), r[2].derivative())
        parts.append(scale(mass, cross(r, rate)))
    x, y, z = (total([p[axis] for p in parts]) for axis in range(3))
    return (x, y, z)


def skew(a: Vector) -> Matrix:
    """Return the matrix of ``a x``."""
    zero = a[0] - a[0]
    return ((zero, -a[2], a[1]), (a[2], zero, -a[0]), (-a[1], a[0], zero))


def transpose(m: Matrix) -> Matrix:
    """Return rows as columns."""
    return tuple(zip(*m, strict=True))


def product(a: Matrix, b: Matrix) -> Matrix:
    """Return the product of two matrices."""
    columns = transpose(b)
    return tuple(tuple(dot(row, column) for column in columns) for row in a)


def apply(m: Matrix, a: Vector) -> Vector:
    """Return m a."""
    x, y, z = (dot(row, a) for row in m)
    return (x, y, z)


def inverse(m: Matrix) -> Matrix:
    """Return the inverse of a 3 x 3 matrix by its adjugate."""
    a, b, c = ((row[0], row[1], row[2]) for row in m)
    adjugate = transpose((cross(b, c), cross(c, a), cross(a, b)))
    scale_by = dot(a, cross(b, c)).reciprocal()
    found: Matrix = each(lambda e: e * scale_by, adjugate)
    return found


def cayley(s: Vector) -> Matrix:
    """Return the rotation with Gibbs vector ``s``, the axis times tan(angle / 2).

    C = ((1 - s.s) 1 + 2 s s^T - 2 skew(s)) / (1 + s.s) (Hughes, 1986, sect. 2.2).
    """
    one = constant(s[0].field, 1, len(s[0].coefficients))
    square = dot(s, s)
    scale_by = (one + square).reciprocal()
    skewed = skew(s)

    def entry(i: int, j: int) -> Series:
        value = (s[i] * s[j] - skewed[i][j]).scaled(2)
        return (value + one - square if i == j else value) * scale_by

    return tuple(tuple(entry(i, j) for j in range(3)) for i in range(3))


def angular_velocity(C: Matrix) -> Vector:
    """Read omega off a rotation: skew(omega) = -dC/dt C^T, components in the turning frame."""
    w = product(each(Series.derivative, C), transpose(C))
    return (w[1][2], w[2][0], w[0][1])
