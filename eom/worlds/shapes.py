"""Random bodies as weighted points, with principal axes or symmetry where they are asked for.

Several generators serve each demand, so that no accidental symmetry of one of them passes for a law.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from eom.exact import series
from eom.exact.series import LENGTH, Matrix, Series, Vector
from eom.fields import Field

Point = tuple[Any, Any, Any]
Weighted = tuple[Any, Point]
"""A mass with its place in a frame that is fixed in the body."""


@dataclass(frozen=True)
class Draw:
    """Random numbers of one world."""

    field: Field
    generator: random.Random
    turn: int = 0

    def number(self) -> Any:
        """Return a number that is not zero."""
        return self.field.draw(self.generator)

    def mass(self) -> Any:
        """Return a mass; its sign matters where numbers have one."""
        return abs(self.number()) if not self.field.prime else self.number()

    def point(self) -> Point:
        """Return three numbers."""
        return (self.number(), self.number(), self.number())

    def changing_mass(self) -> Series:
        """Return a mass that changes with time."""
        return Series(self.field, (self.mass(), *self.series().coefficients[1:]))

    def series(self) -> Series:
        """Return a random series."""
        return Series(self.field, tuple(self.number() for _ in range(LENGTH)))

    def vector(self) -> Vector:
        """Return a random vector that changes with time."""
        return (self.series(), self.series(), self.series())

    def fixed(self, point: Point) -> Vector:
        """Return three numbers as series that do not change."""
        x, y, z = (series.constant(self.field, c, LENGTH) for c in point)
        return (x, y, z)

    def rotation(self) -> Matrix:
        """Return a rotation that changes with time."""
        return series.cayley(self.vector())

    def fixed_rotation(self) -> Matrix:
        """Return a constant rotation."""
        return series.cayley(self.fixed(self.point()))

    def choose(self, *options: Callable[[Draw], list[Weighted]]) -> list[Weighted]:
        """Return what one of several generators draws: they take turns, the first begins."""
        return options[self.turn % len(options)](self)


def any_body(draw: Draw) -> list[Weighted]:
    """Return four to six points at random."""
    return [(draw.mass(), draw.point()) for _ in range(draw.generator.randint(4, 6))]


def _thin_rod(draw: Draw) -> list[Weighted]:
    direction, start = draw.point(), draw.point()
    return [
        (draw.mass(), along(draw.field, start, direction, draw.number()))
        for _ in range(draw.generator.randint(2, 4))
    ]


def along(field: Field, start: Point, direction: Point, length: Any) -> Point:
    """Return start + length direction."""
    x, y, z = (field.reduce(a + length * b) for a, b in zip(start, direction, strict=True))
    return (x, y, z)


def _moved(field: Field, bodies: Sequence[Weighted], shift: Point) -> list[Weighted]:
    return [(m, along(field, p, shift, 1)) for m, p in bodies]


def mirrored(field: Field, bodies: Sequence[Weighted]) -> list[Weighted]:
    """Add the point opposite each point: the centre of mass is then at the origin."""
    x = [(m, (field.reduce(-p[0]), field.reduce(-p[1]), field.reduce(-p[2]))) for m, p in bodies]
    return [*bodies, *x]


def _principal(draw: Draw, central: bool = True) -> list[Weighted]:
    """Return a body without any symmetry whose principal axes at the origin are those of its coordinates.

    The columns of its coordinates, weighted by mass, are made orthogonal to each other and, where the
    centre of mass is to be the origin, to that of ones (Gram and Schmidt, without roots).
    """
    field = draw.field
    masses = [draw.mass() for _ in range(6)]
    columns: list[list[Any]] = [[1] * len(masses)] if central else []
    for _ in range(3):
        column = [draw.number() for _ in masses]
        for other in columns:
            above = sum(m * a * b for m, a, b in zip(masses, column, other, strict=True))
            below = sum(m * b * b for m, b in zip(masses, other, strict=True))
            factor = above * field.inverse(below)
            column = [field.reduce(a - factor * b) for a, b in zip(column, other, strict=True)]
        columns.append(column)
    return [(m, p) for m, p in zip(masses, zip(*columns[-3:], strict=True), strict=True)]


def _axis_pairs(draw: Draw) -> list[Weighted]:
    pairs = []
    for axis in range(3):
        a = draw.number()
        pairs.append((draw.mass(), tuple(a if k == axis else 0 for k in range(3))))
    return mirrored(draw.field, pairs)  # type: ignore[arg-type]


def _quarter_turns(draw: Draw, axis: int) -> list[Weighted]:
    """Four copies of random points, a quarter turn apart about ``axis`` (0, 1, 2)."""
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    bodies = []
    for _ in range(2):
        mass, point = draw.mass(), draw.point()
        for _ in range(4):
            turned = list(point)
            turned[i], turned[j] = draw.field.reduce(-point[j]), point[i]
            point = (turned[0], turned[1], turned[2])
            bodies.append((mass, point))
    return bodies


def _equal_moments(draw: Draw, axis: int) -> list[Weighted]:
    """Return a body without symmetry, and a pair of masses that makes two moments equal."""
    field = draw.field
    bodies = _principal(draw)
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    excess = sum(m * (p[i] ** 2 - p[j] ** 2) for m, p in bodies)
    if not field.prime and excess < 0:
        i, j, excess = j, i, -excess
    a = draw.number()
    mass = field.reduce(excess * field.inverse(2 * a * a))
    point = tuple(a if k == j else 0 for k in range(3))
    return [*bodies, *mirrored(field, [(mass, point)])]  # type: ignore[list-item]


def central(draw: Draw) -> list[Weighted]:
    """Return random points with the centre of mass at the origin."""
    bodies = any_body(draw)
    scale = draw.field.inverse(sum(m for m, _ in bodies))
    x, y, z = (scale * sum(m * p[k] for m, p in bodies) for k in range(3))
    return _moved(draw.field, bodies, (-x, -y, -z))


SYMMETRIES = {"spin_312": 1, "symmetric": 2, "symmetric_1": 0, "symmetric_2": 1}
"""Assumptions by which two principal moments are equal, and the axis of symmetry, from 0."""


def shape(draw: Draw, assumed: frozenset[str]) -> list[Weighted]:
    """Return a body for the assumptions on its inertia, its centre of mass anywhere."""
    axis = next((k for name, k in SYMMETRIES.items() if name in assumed), None)
    if axis is not None:
        body = draw.choose(lambda d: _equal_moments(d, axis), lambda d: _quarter_turns(d, axis))
    elif "principal_axes" in assumed or {"principal_at_O", "about_centre"} <= assumed:
        body = draw.choose(_principal, _axis_pairs)
    elif "principal_at_O" in assumed:
        return _flat(_principal(draw, central=False), assumed)
    else:
        return _thin_rod(draw) if "thin_rod" in assumed else _flat(any_body(draw), assumed)
    return _moved(draw.field, _flat(body, assumed), draw.point())


def _flat(bodies: list[Weighted], assumed: frozenset[str]) -> list[Weighted]:
    """Return a body, or what remains of a plane one in its plane."""
    return [(m, (p[0], p[1], 0)) for m, p in bodies] if "plane_body" in assumed else bodies
