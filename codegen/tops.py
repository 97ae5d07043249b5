"""The heavy symmetric top in the rates of a system: axis, ratio of moments and weight.

Euler's equations of moments A, A, C, their axes in cyclic order, with a weight on the last axis:

    w1' = (1 - C/A) w2 w3 + mu up2,  w2' = -(1 - C/A) w3 w1 - mu up1,  w3' = 0

The vertical is a direction fixed in space: of the quaternion's frame, or one among the states.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from codegen.bodies import Attitude, attitude_at, value
from codegen.exactlinear import nullspace
from codegen.heavy_top import Top
from codegen.polhode import context, number
from codegen.probing import SAME, Probe, fraction, same, structural

ZERO, ONE = Fraction(0), Fraction(1)
Vector = tuple[Fraction, Fraction, Fraction]
MOST_DIRECTIONS = 3


def read(probe: Probe, attitude: Attitude, axis: int) -> Top | None:
    """Return the top whose axis of symmetry is component ``axis``; None if there is none."""
    axes = ((axis + 1) % 3, (axis + 2) % 3, axis)
    places = [attitude.omega[k] for k in axes]
    i, j, k = places
    if not isinstance(i, int) or not isinstance(j, int):
        return None
    if isinstance(k, int) and any(s.rates[k] for s in probe.samples):
        return None
    found = _solved(probe, attitude, axes, (i, j))
    if found is None:
        return None
    ratio, weights = found
    columns = _columns(attitude, probe.start, axes)
    torque = [_combined(weights, [c[n] for c in columns]) for n in range(3)]
    upright = _unit(torque, _size_of(weights, attitude, probe.start))
    if upright is None or ratio <= 0:
        return None
    x, y, z = (value(c, probe.start) for c in places)
    return Top(upright[0], ratio, (x, y, z), upright[1])


def _columns(attitude: Attitude, x: Sequence[Fraction], axes: Sequence[int]) -> list[Vector]:
    """Return fixed directions in the body, in the order of ``axes``: of the quaternion, or states."""
    if attitude.quaternion or attitude.angles:
        a, b, c, d = attitude_at(attitude, x)
        seen = [
            (a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)),
            (2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)),
            (2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d),
        ]
    else:
        seen = [(x[p], x[q], x[r]) for p, q, r in attitude.directions[:MOST_DIRECTIONS]]
    i, j, k = axes
    return [(v[i], v[j], v[k]) for v in seen]


def _combined(weights: Sequence[Fraction], components: Sequence[Fraction]) -> Fraction:
    return sum((w * c for w, c in zip(weights, components, strict=True)), ZERO)


@structural
def _solved(
    probe: Probe, attitude: Attitude, axes: tuple[int, ...], states: tuple[int, int]
) -> tuple[Fraction, list[Fraction]] | None:
    """Return C/A, and the multiples of the directions whose sum is mu times the vertical."""
    i, j = states
    rows = []
    for s in probe.samples:
        w3 = value(attitude.omega[axes[2]], s.x)
        columns = _columns(attitude, s.x, axes)
        rows.append([s.x[j] * w3, *(c[1] for c in columns), -s.rates[i]])
        rows.append([-s.x[i] * w3, *(-c[0] for c in columns), -s.rates[j]])
    spins = any(row[0] for row in rows)
    basis = nullspace(rows if spins else [row[1:] for row in rows], SAME)
    if len(basis) != 1 or not basis[0][-1]:
        return None
    solution = [v / basis[0][-1] for v in basis[0][:-1]]
    difference = solution.pop(0) if spins else ZERO
    largest = max(map(abs, solution))
    weights = [ZERO if same(v, ZERO, largest) else v for v in solution]
    return (1 - difference, weights) if largest else None


def _size_of(
    weights: Sequence[Fraction], attitude: Attitude, x: Sequence[Fraction]
) -> Fraction | None:
    """Return mu where it is rational: one axis of the quaternion's frame is vertical."""
    q = attitude_at(attitude, x)
    if not q or sum(map(bool, weights)) != 1:
        return None
    length = sum((v * v for v in q), ZERO)
    return length * sum(map(abs, weights), ZERO)


def _unit(torque: Sequence[Fraction], size: Fraction | None) -> tuple[Fraction, Vector] | None:
    """Return size and direction of a vector: a rational unit vector, within 90 digits of it."""
    a, b, c = torque
    square = a * a + b * b + c * c
    if size is not None:
        return size, (a / size, b / size, c / size)
    if not square:
        return None
    own = context()
    own.dps = 100
    size = abs(c) if not (a or b) else fraction(own.sqrt(number(own, square)))
    sign = 1 if c >= 0 else -1
    x, y = a / (size + abs(c)), b / (size + abs(c))
    below = 1 + x * x + y * y
    return size, (2 * x / below, 2 * y / below, sign * (2 - below) / below)
