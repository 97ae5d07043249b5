"""Worlds in which the motion of one coordinate is varied to first order, and slopes by coordinates there.

A partial derivative is that of a value along a family of motions, in which one coordinate is moved by
e t^k / k! and all others are not. With F(q, q') the variation for k = 0 is dF/dq, the one for k = 1 is
t dF/dq + dF/dq', and so on. Numbers are a + b e with e e = 0 over the field of the world, so that nothing
is rounded and no rule of differentiation is used but those of sums and products.
"""

from __future__ import annotations

import dataclasses
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial, reduce
from math import factorial
from typing import Any

from eom.exact import series
from eom.exact.series import LENGTH, Series, Vector
from eom.fields import RESIDUES, Field
from eom.worlds.worlds import CONFIGURED, HELD, World, constraint_forces, slope_of_place


@dataclass(frozen=True, slots=True)
class Dual:
    """The number ``value`` + ``slope`` e, with e e = 0."""

    value: Any
    slope: Any

    def __add__(self, other: Any) -> Dual:
        value, slope = parts(other)
        return Dual(self.value + value, self.slope + slope)

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.slope)

    def __sub__(self, other: Any) -> Dual:
        value, slope = parts(other)
        return Dual(self.value - value, self.slope - slope)

    def __rsub__(self, other: Any) -> Dual:
        value, slope = parts(other)
        return Dual(value - self.value, slope - self.slope)

    def __mul__(self, other: Any) -> Dual:
        value, slope = parts(other)
        return Dual(self.value * value, self.value * slope + self.slope * value)

    __rmul__ = __mul__

    def __mod__(self, prime: int) -> Dual:
        return Dual(self.value % prime, self.slope % prime)

    def __bool__(self) -> bool:
        return bool(self.value or self.slope)


def parts(number: Any) -> tuple[Any, Any]:
    """Return the value and the slope of a number, which may be a plain one."""
    return (number.value, number.slope) if isinstance(number, Dual) else (number, 0)


@dataclass(frozen=True)
class Duals(Field):
    """The numbers a + b e over a field ``below``, in which e e = 0."""

    below: Field = RESIDUES

    @property
    def is_rational(self) -> bool:
        """Whether elements are fractions."""
        return False

    def of(self, numerator: Any, denominator: int = 1) -> Any:
        """Return the element that a fraction is."""
        return self.below.of(numerator, denominator)

    def inverse(self, value: Any) -> Any:
        """Return the reciprocal; raises `Singular` where that of the value is."""
        a, b = parts(value)
        inverse = self.below.inverse(a)
        return self.reduce(Dual(inverse, -b * inverse * inverse))

    def root(self, value: Any) -> Any:
        """Return the square root; raises `Singular` where the value has none, or is zero."""
        a, b = parts(value)
        root = self.below.root(a)
        return self.reduce(Dual(root, b * self.below.inverse(2 * root)))

    def quarter(self, angle: Any, drawn: Any) -> Any:
        """Return the tangent of a quarter of an angle: it changes by a quarter of the secant squared."""
        a, b = parts(angle)
        tangent = self.below.quarter(a, drawn)
        return self.reduce(Dual(tangent, b * self.below.of(1, 4) * (1 + tangent * tangent)))

    def draw(self, generator: Any) -> Any:
        """Return the number that is drawn below: it does not depend on what is varied."""
        return self.below.draw(generator)


def lifted(value: Any, field: Field) -> Any:
    """Return data with every series in them over another field."""
    if isinstance(value, Series):
        return Series(field, value.coefficients)
    if isinstance(value, Mapping):
        return {k: lifted(v, field) for k, v in value.items()}
    if isinstance(value, tuple):
        inside = [lifted(v, field) for v in value]
        return type(value)(*inside) if hasattr(value, "_fields") else tuple(inside)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        rows = ((f.name, getattr(value, f.name)) for f in dataclasses.fields(value))
        return dataclasses.replace(value, **{name: lifted(v, field) for name, v in rows})
    return value


def varied(world: World, name: str, power: int) -> World:
    """Return a world where one coordinate moves by e t^``power`` / ``power``! more."""
    field = Duals(world.field.prime, world.field)
    step = _step(field, power)
    own = {k: m for k, m in world.memo.items() if k[0] == "coordinate" and len(k) == 2}
    own["coordinate", name] = world.primitive("coordinate", (name,))
    memo = lifted(own, field)
    memo["coordinate", name] += step
    bare = dataclasses.replace(world, memo={}, rebuild=None)
    new = dataclasses.replace(lifted(bare, field), field=field, memo=memo)
    new = _moved(new, world, name, step)
    return new if world.rebuild is None else world.rebuild(new)


def _step(field: Field, power: int) -> Series:
    """Return e t^n / n!."""
    coefficients: list[Any] = [0] * LENGTH
    coefficients[power] = Dual(0, field.of(1, factorial(power)))
    return Series(field, tuple(coefficients))


def _moved(new: World, world: World, name: str, step: Series) -> World:
    """Return a world whose masses, and their centre, have moved along their slopes by a coordinate.

    Slopes change, too; forces are functions of no coordinate.
    """
    names = world.memo.get(CONFIGURED, ())
    if name not in names:
        return new
    count = range(len(world.masses))
    shifts = [_along(new, step, slope_of_place(world, n, name)) for n in count]
    points, memo = dict(new.points), dict(new.memo)
    for point in {"C", "O"} if "about_centre" in world.assumed else {"C"}:
        points[point] = series.add(points[point], series.centre(new.masses, shifts))
    for n in count:
        for other in names:
            before = lifted(slope_of_place(world, n, other), new.field)
            twice = _along(new, step, slope_of_place(world, n, other, name))
            memo["place_slope", n, other] = series.add(before, twice)
    memo[HELD] = lifted(tuple(constraint_forces(world)), new.field)
    places = tuple(series.add(p, s) for p, s in zip(new.places, shifts, strict=True))
    return dataclasses.replace(new, points=points, places=places, memo=memo)


def _along(new: World, step: Series, slope: Vector) -> Vector:
    return series.scale(step, lifted(slope, new.field))


def slope(order: int, variation: Callable[[int], Any]) -> Any:
    """Return the slope by the rate of an order, from the values where a coordinate moves by powers.

    ``variation``: of the power. With D_k that of t^k / k!: the sum of (-t)^j / j! D_(order - j).
    """
    found = [
        series.each(lambda s, j=j: _less_time(_slope_of(s), j), variation(order - j))  # type: ignore[misc]
        for j in range(order + 1)
    ]
    return reduce(partial(series.entrywise, operator.add), found)


def _slope_of(value: Series) -> Series:
    below: Field = value.field.below  # type: ignore[attr-defined]
    return Series(below, tuple(parts(c)[1] for c in value.coefficients))


def _less_time(value: Series, power: int) -> Series:
    """Return a series times (-t)^n / n!."""
    kept = len(value.coefficients)
    factor = value.field.of(Fraction((-1) ** power, factorial(power)))
    moved = (*(0,) * power, *value.coefficients)[:kept]
    return Series(value.field, moved).scaled(factor)
