"""Gravity of a distant centre on a body, from the law of inverse squares, to second order in its size.

With R the distance of the centre of mass C, u the unit vector from the attracting centre to C and p a
place from C, powers of the distance are R^2 + 2 R u.p + p.p raised to a half, expanded by the binomial
series in p / R. Nothing is known here of moments of inertia.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from eom.exact import series
from eom.exact.series import LENGTH, Series, Vector
from eom.worlds.turning import angle, in_turn, turned

if TYPE_CHECKING:
    from eom.worlds.worlds import World


def _any_series(world: World, name: str) -> Series:
    generator = world.free("gravity", name)
    draws = tuple(world.field.draw(generator) for _ in range(LENGTH))
    first = draws[0] if world.field.prime else abs(draws[0])
    return Series(world.field, (first, *draws[1:]))


def _direction(world: World) -> Vector:
    """Return a unit vector that turns at will: the third axis of a frame after two turns."""
    generator = world.free("gravity", "quarters")
    angles = [
        angle(_any_series(world, f"angle {k}"), world.field.draw(generator)) for k in range(2)
    ]
    row = in_turn(turned(k, a) for k, a in enumerate(angles)).matrix[2]
    return (row[0], row[1], row[2])


def _parameter(world: World) -> Series:
    return world.constant(_any_series(world, "parameter").coefficients[0])


def _radius(world: World) -> Series:
    return _any_series(world, "radius")


def _parts(world: World) -> list[tuple[Series, Vector, Series, Series]]:
    """Return of each mass: itself, its place p from C, 2 u.p / R and p.p / R^2."""
    direction = world.primitive("orbit_direction", ())
    nearness = world.primitive("orbit_radius", ()).reciprocal()
    found = []
    for mass, place in zip(world.masses, world.places, strict=True):
        p = series.subtract(place, world.place("C"))
        first = (series.dot(direction, p) * nearness).scaled(2)
        found.append((mass, p, first, series.dot(p, p) * nearness * nearness))
    return found


def _power(exponent: Fraction, first: Series, second: Series) -> tuple[Series, Series]:
    """Return the terms of first and second order of (1 + first + second) to a power."""
    field = first.field
    once = field.of(exponent.numerator, exponent.denominator)
    half = exponent * (exponent - 1) / 2
    twice = field.of(half.numerator, half.denominator)
    return first.scaled(once), second.scaled(once) + (first * first).scaled(twice)


def _torque(world: World) -> Vector:
    """Return the sum of p x f about C: f is -mu m (R u + p) / |R u + p|^3, and p x p vanishes."""
    direction = world.primitive("orbit_direction", ())
    parts = []
    for mass, p, first, second in _parts(world):
        change, _ = _power(Fraction(-3, 2), first, second)
        parts.append(series.scale(mass * (world.constant(1) + change), series.cross(p, direction)))
    near = world.primitive("orbit_radius", ()).reciprocal()
    factor = -(world.primitive("gravity_parameter", ()) * near * near)
    x, y, z = (series.total([p[k] for p in parts]) for k in range(3))
    return series.scale(factor, (x, y, z))


def _energy(world: World) -> Series:
    """Return the sum of -mu m / |R u + p|."""
    parts = []
    for mass, _, first, second in _parts(world):
        one, two = _power(Fraction(-1, 2), first, second)
        parts.append(mass * (world.constant(1) + one + two))
    near = world.primitive("orbit_radius", ()).reciprocal()
    whole: Series = world.primitive("gravity_parameter", ()) * near * series.total(parts)
    return -whole


PRIMITIVES: Mapping[str, Callable[..., Any]] = {
    "gravity_parameter": _parameter,
    "orbit_radius": _radius,
    "orbit_direction": _direction,
    "gravity_torque": _torque,
    "gravity_energy": _energy,
}
"""Quantities of a body near a distant attracting centre."""
