"""The heavy symmetric top in the rates of a system: axis, ratio of moments and weight.

Euler's equations of moments A, A, C, their axes in cyclic order, with a weight on the last axis:

    w1' = (1 - C/A) w2 w3 + mu up2,  w2' = -(1 - C/A) w3 w1 - mu up1,  w3' = 0

The vertical is a direction fixed in space: of the attitude's frame, or one among the states. The
coefficients are what the rates are at a few states; that they are so at all states is proved.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from codegen.closed.heavy_top import Top
from codegen.closed.held import (
    Held,
    Spinning,
    attitude_at,
    bodies,
    cross,
    fraction,
    matrix_of_turns,
    residuals,
    sine_and_cosine,
)
from codegen.closed.polhode import context, number
from codegen.frontend.attitude import INERTIA
from codegen.ir.residues import FIELD, PRIME, RandomPoint
from eom.rotations import cosines

ZERO = Fraction(0)
Vector = tuple[Fraction, Fraction, Fraction]
MOST_DIRECTIONS = 3
ANGLES = (0.5, 0.75, 1.25)
"""Of one attitude at which rates are looked at; the other is not turned."""
TURNED = (0.5, 0.5, 0.5, 0.5)


@dataclass(frozen=True)
class Numbers:
    """Arithmetic modulo the prime, or with fractions.

    ``rates``: from states, and the numbers of some of them, to their rates; ``waves``: sine and cosine;
    ``over``: the quotient.
    """

    rates: Callable[[Sequence[float], Sequence[int]], Sequence[Any]]
    waves: Callable[[Any], tuple[Any, Any]]
    over: Callable[[Any, Any], Any]


@dataclass(frozen=True)
class Reading:
    """A body that is a top: its axes in cyclic order, that of symmetry last, C/A and weights.

    ``weights``: multiples of the fixed directions whose sum is mu times the vertical.
    """

    body: Spinning
    axes: tuple[int, int, int]
    ratio: Fraction
    weights: tuple[Fraction, ...]


def reading(held: Held) -> Reading | None:
    """Return how the system is a heavy symmetric top; None if it is none."""
    for body in bodies(held):
        for k in range(3):
            found = _about(held, body, ((k + 1) % 3, (k + 2) % 3, k))
            if found is not None:
                return found
    return None


def _about(held: Held, body: Spinning, axes: tuple[int, int, int]) -> Reading | None:
    i, j = (body.omega[k] for k in axes[:2])
    directions = bool(body.quaternion or body.angles or body.stated.directions)
    if i < 0 or j < 0 or not directions or not _proved(held, body, axes):
        return None
    numbers = Numbers(held.rate_numbers, sine_and_cosine, operator.truediv)
    spun, weights = _coefficients(held, body, axes, numbers)
    _, residues = _modulo(held, body, axes, RandomPoint(0))
    shown = tuple(w if r else ZERO for w, r in zip(weights, residues, strict=True))
    if not any(shown) or spun >= 1:
        return None
    return Reading(body, axes, 1 - spun, shown)


def _modulo(
    held: Held, body: Spinning, axes: Sequence[int], point: RandomPoint
) -> tuple[Any, list[Any]]:
    """Return the coefficients modulo the prime."""

    def rates(x: Sequence[float], states: Sequence[int]) -> list[int]:
        return held.residues(point, [FIELD.of(Fraction(v)) for v in x], states)

    def waves(angle: Fraction) -> tuple[int, int]:
        c, s = point.circle(FIELD.of(angle))
        return s, c

    def over(value: int, by: Any) -> int:
        return value * int(FIELD.inverse(FIELD.of(by) if isinstance(by, Fraction) else by))

    spun, weights = _coefficients(held, body, axes, Numbers(rates, waves, over))
    return spun % PRIME, [w % PRIME for w in weights]


def _proved(held: Held, body: Spinning, axes: tuple[int, int, int]) -> bool:
    """Return whether all rates are those of a top about the last axis, with the coefficients they have."""
    whole = _as_top(body)

    def test(point: RandomPoint) -> list[int]:
        spun, weights = _modulo(held, body, axes, point)

        def torque(point: RandomPoint, x: Sequence[int], w: Sequence[int]) -> list[int]:
            columns = _columns(body, x, lambda v: point.circle(v)[::-1])[: len(weights)]
            up = [sum(m * c[k] for m, c in zip(weights, columns, strict=True)) for k in range(3)]
            axis = [int(k == axes[2]) for k in range(3)]
            gyroscopic = [spun * w[axes[2]] * v for v in cross(w, axis)]
            return [g - v for g, v in zip(gyroscopic, cross(axis, up), strict=True)]

        return residuals(held, whole, point, torque)

    return held.proved(test)


def _as_top(body: Spinning) -> Spinning:
    """Return the body with the inertia one, whose torque is then d(omega)/dt."""
    values = body.stated.values
    bare = replace(values, results={**values.results, INERTIA: ()})
    return replace(body, stated=replace(body.stated, values=bare))


def _coefficients(
    held: Held, body: Spinning, axes: Sequence[int], own: Numbers
) -> tuple[Any, list[Any]]:
    """Return 1 - C/A and the weights of the directions, from rates at a few states."""
    i, j, k = (body.omega[n] for n in axes)
    spin = body.constants[axes[2]]
    still = [0.0] * held.count

    def at(attitude: int, w2: float = 0.0, w3: float = 0.0) -> Sequence[Any]:
        x = _placed(body, still, attitude)
        for state, value in ((j, w2), (k, w3)):
            if state >= 0:
                x[state] = value
        return own.rates(x, (i, j))

    if body.quaternion or body.angles:
        weights = _of_frame(body, axes, (at(0), at(1)), own)
    else:
        weights = _of_directions(body, axes, still, lambda x: own.rates(x, (i, j))[0])
    if k < 0 and not spin:
        return 0, weights
    faster = at(0, 1.0, 1.0)[0] - at(0, 0.0, 1.0)[0]
    return (faster if k >= 0 else own.over(faster, spin)), weights


def _placed(body: Spinning, x: Sequence[float], attitude: int) -> list[float]:
    """Return states at one of two attitudes: not turned, or turned."""
    placed = list(x)
    turned = ((0.0, 0.0, 0.0), ANGLES) if body.angles else ((1.0, 0.0, 0.0, 0.0), TURNED)
    for k, v in zip(body.quaternion or body.angles, turned[attitude], strict=False):
        placed[k] = v
    return placed


def _of_frame(
    body: Spinning, axes: Sequence[int], rates: Sequence[Sequence[Any]], own: Numbers
) -> list[Any]:
    """Return the weights of the three axes of the frame, from the rates at the two attitudes.

    Where B lies on A, w1' = W2 and w2' = -W1; the third is left in w1' elsewhere.
    """
    a, b, c = axes
    level, turned = rates
    weights: list[Any] = [0, 0, 0]
    weights[b], weights[a] = level[0], -level[1]
    if not body.angles:
        weights[c] = turned[0]  # C takes each axis to the one before it
        return weights
    C = matrix_of_turns(body.stated.sequence, [own.waves(Fraction(v)) for v in ANGLES])
    rest = turned[0] - weights[a] * C[b][a] - weights[b] * C[b][b]
    weights[c] = own.over(rest, C[b][c])
    return weights


def _of_directions(
    body: Spinning, axes: Sequence[int], still: Sequence[float], rate: Callable[[list[float]], Any]
) -> list[Any]:
    """Return the weight of each direction: w1' where it alone is there, along the second axis."""
    found = []
    for direction in body.stated.directions[:MOST_DIRECTIONS]:
        x = list(still)
        x[direction[axes[1]]] = 1.0
        found.append(rate(x))
    return found


def _columns(
    body: Spinning, x: Sequence[Any], waves: Callable[[Any], tuple[Any, Any]]
) -> list[list[Any]]:
    """Return fixed directions in the body: the axes of the attitude's frame, or states."""
    if body.quaternion:
        rows = cosines([x[k] for k in body.quaternion])
    elif body.angles:
        rows = matrix_of_turns(body.stated.sequence, [waves(x[k]) for k in body.angles])
    else:
        return [[x[k] for k in d] for d in body.stated.directions[:MOST_DIRECTIONS]]
    return [[row[n] for row in rows] for n in range(3)]


def top(found: Reading, x: Sequence[Fraction]) -> Top | None:
    """Return the top at its initial state; None where the vertical has no direction."""
    body, axes = found.body, found.axes
    q = attitude_at(body, x)
    if q:
        rows = cosines(q)
        columns = [[row[n] for row in rows] for n in range(3)]
    else:
        columns = _columns(body, x, sine_and_cosine)
    torque = [
        sum((w * c[n] for w, c in zip(found.weights, columns, strict=True)), ZERO) for n in axes
    ]
    upright = _unit(torque, _size_of(found.weights, q))
    if upright is None:
        return None
    w = body.omega_at(x)
    a, b, c = (w[n] for n in axes)
    return Top(upright[0], found.ratio, (a, b, c), upright[1])


def _size_of(weights: Sequence[Fraction], q: Sequence[Fraction]) -> Fraction | None:
    """Return mu where it is rational: one axis of the quaternion's frame is vertical."""
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
    own = context(100)
    size = abs(c) if not (a or b) else fraction(own.sqrt(number(own, square)))
    sign = 1 if c >= 0 else -1
    x, y = a / (size + abs(c)), b / (size + abs(c))
    below = 1 + x * x + y * y
    return size, (2 * x / below, 2 * y / below, sign * (2 - below) / below)
