"""Forces and torques as arrows, with the numbers and formulas that they come from.

A torque's arrow is along the torque, by the right-hand rule; a ring round it turns the way that the torque
turns. Lengths of arrows say nothing of sizes: a sketch shows what acts, where, and which way.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import sympy as sp

from eom.errors import InputError
from eom.multibody.algebra.values import is_number
from eom.views.body.turns import arc_points
from eom.views.draw.picture import Arrow, Curve, Floats, Item, Marks, Words

FORCE, TORQUE, REACTION = "red", "purple", "green"
LEGEND = {FORCE: "force", TORQUE: "torque", REACTION: "reaction"}
RING = 1.6 * math.pi
"""Angle of the ring round a torque."""


def number(value: Any, known: Mapping[str, float]) -> float:
    """Return the number that a value of a description has; symbols without one count as zero.

    Raises `InputError` where it is none.
    """
    if is_number(value):
        return float(value)
    at = {s: sp.Float(known.get(s.name, 0.0)) for s in value.free_symbols}
    found = sp.sympify(value, strict=True).xreplace(at).evalf()
    if not found.is_real or not math.isfinite(found):
        raise InputError("not a number at the start", where="sketch", got=f"{value} = {found}")
    return float(found)


def numbers(values: Any, known: Mapping[str, float]) -> Floats:
    """Return numbers of a vector or a matrix."""
    if isinstance(values, list | tuple):
        return np.array([numbers(v, known) for v in values])
    return np.asarray(number(values, known))


def unit(way: Floats) -> Floats | None:
    """Return the unit vector along a vector, None if it is zero."""
    size = float(np.linalg.norm(way))
    return way / size if size > 0 else None


def force(
    point: Floats, way: Floats, length: float, words: str, colour: str = FORCE
) -> Iterator[Item]:
    """Yield the arrow of a force that acts at a point, along a vector of any length."""
    along = unit(way)
    if along is not None:
        yield Arrow(point, point + length * along, colour, 2.4, words, LEGEND[colour])


def push(point: Floats, way: Floats, length: float, words: str) -> Iterator[Item]:
    """Yield the arrow of a reaction whose tip is at the point that it acts on."""
    along = unit(way)
    if along is not None:
        yield Arrow(point - length * along, point, REACTION, 2.4, label=LEGEND[REACTION])
        yield Words(point - 1.12 * length * along, words, REACTION)


def hang(point: Floats, way: Floats, length: float, words: str) -> Iterator[Item]:
    """Yield the arrow of a reaction that starts at the point that it acts on."""
    yield from force(point, way, length, words, REACTION)


def torque(point: Floats, way: Floats, length: float, words: str) -> Iterator[Item]:
    """Yield the arrow of a torque along a vector of any length, and its ring."""
    along = unit(way)
    if along is None:
        return
    yield Arrow(point, point + length * along, TORQUE, 2.4, words, LEGEND[TORQUE])
    across = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    radius = 0.16 * length / float(np.linalg.norm(across))
    ring = point + 0.6 * length * along + arc_points(along, radius * across, RING)
    yield Curve(ring, TORQUE, 1.8)
    yield Arrow(ring[-5], ring[-1], TORQUE, 1.8)


def marked(point: Floats, words: str, away: Floats, colour: str = "black") -> Iterator[Item]:
    """Yield a dot and its name, which stands ``away`` from it."""
    yield Marks(point[None], colour, 6.0)
    yield Words(point + away, words, colour)
