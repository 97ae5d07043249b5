"""Springs and dampers between points of two bodies, or of a body and the ground.

The force acts along the line between the points: tension k (l - l0) + c l', with the distance l. Where l0
and c are zero by structure no root is taken, and the points may coincide.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from eom.multibody.algebra.scalars import Scalar, Work, add, is_zero, mul, negative, reciprocal, sub
from eom.multibody.algebra.spatial import (
    ZERO,
    Matrix,
    SpatialVector,
    Vector,
    cross,
    dot,
    keep_vector,
    minus,
    negative_vector,
    plus,
    scaled,
    times,
    transposed,
)
from eom.multibody.recursion.lumped_tree import LumpedTree, SpringDamper
from eom.multibody.recursion.motion import Moving, Place, loads, poses, velocities


@dataclass(frozen=True)
class End:
    """A point in motion: position and velocity in the ground's axes; the rotation to its part's."""

    position: Vector
    velocity: Vector
    rotation: Matrix | None


def applied(
    tree: LumpedTree, placed: Sequence[Place], moved: Sequence[Moving], work: Work
) -> list[SpatialVector]:
    """Return moment about its origin and force, by loads and links, on each part."""
    found = loads(placed, work)
    if not tree.links:
        return found
    posed, speeds = poses(placed, work), velocities(placed, moved, work)
    for link in tree.links:
        first, second = (end(link, n, posed, speeds, work) for n in (0, 1))
        pull = keep_vector(work, "f", link.name, _pull(link, first, second, work))
        for n, (own, force) in enumerate(((first, pull), (second, negative_vector(pull)))):
            part, point = link.parts[n], link.points[n]
            if own.rotation is not None:
                here = times(own.rotation, force)
                n_old, f_old = found[part]
                found[part] = SpatialVector(plus(n_old, cross(point, here)), plus(f_old, here))
    return found


def end(
    link: SpringDamper,
    n: int,
    posed: Sequence[tuple[Matrix, Vector]],
    speeds: Sequence[SpatialVector],
    work: Work,
) -> End:
    """Return the first (0) or second (1) end of a link."""
    part, point = link.parts[n], link.points[n]
    name = f"{link.name}_{n + 1}"
    if part < 0:
        return End(point, ZERO, None)
    (R, x), (w, v) = posed[part], speeds[part]
    back = transposed(R)
    position = keep_vector(work, "position", name, plus(x, times(back, point)))
    return End(position, times(back, plus(v, cross(w, point))), R)


def distance(link: SpringDamper, first: End, second: End, work: Work) -> Scalar:
    """Return the distance of the points."""
    d = _line(link, first, second, work)
    return work.keep("distance", link.name, "", work.sqrt(dot(d, d)))


def _line(link: SpringDamper, first: End, second: End, work: Work) -> Vector:
    return keep_vector(work, "line", link.name, minus(second.position, first.position))


def _pull(link: SpringDamper, first: End, second: End, work: Work) -> Vector:
    """Return the force on the first point, in the ground's axes."""
    d = _line(link, first, second, work)
    if link.plain:
        return scaled(link.stiffness, d)
    length = distance(link, first, second, work)
    inverse = work.keep("inverse", link.name, "", reciprocal(length))
    tension = mul(link.stiffness, sub(length, link.length))
    if not is_zero(link.damping):
        rate = mul(inverse, dot(d, minus(second.velocity, first.velocity)))
        tension = add(tension, mul(link.damping, rate))
    return scaled(work.keep("tension", link.name, "", mul(inverse, tension)), d)


def twice_potential(link: SpringDamper, first: End, second: End, work: Work) -> Scalar:
    """Return twice the energy of the spring, zero where it is slack."""
    if link.plain:
        d = _line(link, first, second, work)
        return mul(link.stiffness, dot(d, d))
    length = distance(link, first, second, work)
    stretch = work.keep("stretch", link.name, "", add(length, negative(link.length)))
    return mul(link.stiffness, mul(stretch, stretch))
