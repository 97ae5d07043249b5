"""Random motions of a rigid body; those that need no torque about an axis are solved for.

The condition alone is used, evaluated on the masses, coefficient by coefficient of the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from eom.exact import series
from eom.exact.series import LENGTH, Matrix, Series, Vector
from eom.fields import Field, solve
from eom.worlds.shapes import Draw, Point, Weighted, along
from eom.worlds.turning import Angle, Build, Turned, about_axis, angle, composed, turned

Turns = dict[str, Turned]
Angles = dict[str, Angle]


@dataclass(frozen=True)
class Body:
    """Weighted points that are fixed in a frame, with the frame's rotation C_BI."""

    points: tuple[Weighted, ...]
    attitude: Matrix

    def centre(self, field: Field) -> Point:
        """Return the centre of mass, in the frame."""
        scale = field.inverse(sum(m for m, _ in self.points))
        x, y, z = (field.reduce(scale * sum(m * p[k] for m, p in self.points)) for k in range(3))
        return (x, y, z)

    def carried(self, draw: Draw, point: Point) -> Vector:
        """Return a point of the frame from the frame's origin, in I."""
        return series.apply(series.transpose(self.attitude), draw.fixed(point))

    def torque_about_centre(self, draw: Draw) -> Vector:
        """Return the sum of r x m r'' about the centre of mass, from the masses alone."""
        centre = self.centre(draw.field)
        total: list[Vector] = []
        for m, p in self.points:
            r = self.carried(draw, along(draw.field, p, centre, -1))
            second = tuple(s.derivative().derivative().scaled(m) for s in r)
            total.append(series.cross(r, (second[0], second[1], second[2])))
        return tuple(series.total([t[k] for t in total]) for k in range(3))  # type: ignore[return-value]


def _solve_motion(
    draw: Draw,
    unknown: Sequence[Series],
    residual: Callable[[Sequence[Series]], Sequence[Series]],
) -> list[Series]:
    """Find the coefficients from the third on that make ``residual`` vanish, order by order.

    Coefficient n of a residual is affine in the coefficients n + 2 of the unknowns, because forces
    are linear in accelerations.
    """
    current = list(unknown)
    for n in range(LENGTH - 2):
        current = _next_coefficients(draw.field, current, residual, n)
    return current


def _next_coefficients(
    field: Field,
    current: list[Series],
    residual: Callable[[Sequence[Series]], Sequence[Series]],
    order: int,
) -> list[Series]:
    """Solve for the coefficients ``order + 2`` by trying zero and each unit."""

    def trial(values: Sequence[Any]) -> list[Series]:
        return [_with(s, order + 2, v) for s, v in zip(current, values, strict=True)]

    def at(values: Sequence[Any]) -> list[Any]:
        return [r.coefficients[order] for r in residual(trial(values))]

    n = len(current)
    base = at([0] * n)
    columns = [at([int(k == j) for k in range(n)]) for j in range(n)]
    matrix = [[field.reduce(columns[j][i] - base[i]) for j in range(n)] for i in range(n)]
    return trial(solve(matrix, [field.reduce(-b) for b in base], field))


def _with(s: Series, place: int, value: Any) -> Series:
    c = s.coefficients
    return Series(s.field, (*c[:place], value, *c[place + 1 :]))


def any_turn(draw: Draw, build: Build = about_axis) -> Turned:
    """Return a rotation from three random angles."""
    return build([angle(draw.series(), draw.number()) for _ in range(3)])


def fixed_turn(draw: Draw) -> Turned:
    """Return a constant rotation."""
    return about_axis([angle(draw.fixed(draw.point())[0], draw.number()) for _ in range(3)])


def free_attitude(draw: Draw, points: tuple[Weighted, ...], build: Build = about_axis) -> Turned:
    """Return a rotation under which the masses need no torque."""
    quarters = [draw.number() for _ in range(3)]

    def attitude(motion: Sequence[Series]) -> Turned:
        return build([angle(m, q) for m, q in zip(motion, quarters, strict=True)])

    def residual(motion: Sequence[Series]) -> Sequence[Series]:
        return Body(points, attitude(motion).matrix).torque_about_centre(draw)

    return attitude(_solve_motion(draw, draw.vector(), residual))


def viscous_pair(
    draw: Draw, body: Sequence[Weighted], slug: Sequence[Weighted], damping: Any
) -> tuple[Turned, Turned]:
    """Return the rotations of a body and of its slug under the viscous torque between them.

    The conditions: the momentum of both together is constant, and that of the slug changes by
    minus ``damping`` times its angular velocity relative to the body.
    """
    quarters = [draw.number() for _ in range(6)]

    def both(motion: Sequence[Series]) -> tuple[Turned, Turned]:
        angles = [angle(m, q) for m, q in zip(motion, quarters, strict=True)]
        return about_axis(angles[:3]), about_axis(angles[3:])

    def residual(motion: Sequence[Series]) -> Sequence[Series]:
        B, S = (turn.matrix for turn in both(motion))
        h_body, h_slug = (_momentum(draw, p, C) for p, C in ((body, B), (slug, S)))
        relative = series.angular_velocity(series.product(S, series.transpose(B)))
        torque = series.apply(series.transpose(S), relative)
        rates = [h_slug[k].derivative() for k in range(3)]
        balance = [rates[k] + torque[k].scaled(damping) for k in range(3)]
        return [*balance, *(h_body[k].derivative() + rates[k] for k in range(3))]

    return both(_solve_motion(draw, (*draw.vector(), *draw.vector()), residual))


def _momentum(draw: Draw, points: Sequence[Weighted], C: Matrix) -> Vector:
    """Return the angular momentum of points in a frame about their centre of mass."""
    masses = [series.constant(draw.field, m, LENGTH) for m, _ in points]
    back = series.transpose(C)
    return series.spin_momentum(masses, [series.apply(back, draw.fixed(p)) for _, p in points])


_TURNS_312 = (("A", "I", 2, "psi"), ("B", "A", 0, "theta"), ("C", "B", 1, "phi"))
"""Frame, the one before, axis (from 0), angle."""


def _spun(motion: Sequence[Series], start: Sequence[Any]) -> tuple[Turns, Angles]:
    """Return the frames and angles of the 3-1-2 sequence; ``start``: tangents of their quarters."""
    frames: Turns = {}
    angles: Angles = {}
    for (frame, before, axis, name), value, quarter in zip(_TURNS_312, motion, start, strict=True):
        angles[name] = angle(value, quarter)
        turn = turned(axis, angles[name])
        frames[frame] = composed(frames[before], turn) if before in frames else turn
    return frames, angles


def spin_312(
    draw: Draw, points: tuple[Weighted, ...], assumed: frozenset[str]
) -> tuple[Turns, Angles]:
    """Return frames and angles; those that a missing torque determines are solved for."""
    motion = [draw.series() for _ in _TURNS_312]
    start = [draw.number() for _ in _TURNS_312]
    wanted = [(2, 1)] * ("no_torque_2" in assumed) + [(0, 2)] * ("no_torque_3" in assumed)

    def residual(values: Sequence[Series]) -> Sequence[Series]:
        trial = list(motion)
        for (place, _), value in zip(wanted, values, strict=True):
            trial[place] = value
        frames, _ = _spun(trial, start)
        torque = Body(points, frames["C"].matrix).torque_about_centre(draw)
        in_B = series.apply(frames["B"].matrix, torque)
        return [in_B[axis] for _, axis in wanted]

    solved = _solve_motion(draw, [motion[place] for place, _ in wanted], residual)
    for (place, _), value in zip(wanted, solved, strict=True):
        motion[place] = value
    return _spun(motion, start)
