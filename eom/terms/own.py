"""What a derivation defines of its own: frames, points and laws, beside the vocabulary."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from eom.terms.terms import Equation, Term, add, der, expr, mul, zero
from eom.terms.vocabulary import ORIGIN, unit


@dataclass(frozen=True)
class OwnFrame:
    """A frame that is turned from ``base`` about its axis ``axis`` (1, 2, 3) through ``angle`` (rad)."""

    base: str
    axis: int
    angle: Any


@dataclass(frozen=True)
class Law:
    """An ``equation`` that motions are to obey, and the ``unknowns``: coordinates by which they do."""

    equation: Equation
    unknowns: tuple[Any, ...]


@dataclass
class Own:
    """What a derivation has of its own.

    ``frames`` by name; ``points`` by name, with their positions from the inertial origin; ``laws``.
    """

    frames: dict[str, OwnFrame] = field(default_factory=dict)
    points: dict[str, Term] = field(default_factory=dict)
    laws: list[Law] = field(default_factory=list)

    def turns(self, frame: str) -> Iterator[tuple[Any, Term]]:
        """Return, one by one, angle and axis of the turns by which ``frame`` is reached from its ground."""
        while frame in self.frames:
            row = self.frames[frame]
            yield row.angle, unit(row.base, row.axis)
            frame = row.base

    def ground(self, frame: str) -> str:
        """Return the frame, not of these, from which ``frame`` is turned."""
        while frame in self.frames:
            frame = self.frames[frame].base
        return frame

    def turning(self, frame: str) -> Term:
        """Return the angular velocity of ``frame`` against its ground: one term a turn."""
        parts = [mul(der(expr(angle)), axis) for angle, axis in self.turns(frame)]
        return add(*parts) if parts else zero("vector")

    def place(self, point: str) -> Term | None:
        """Return the position of ``point`` from the inertial origin, None for one that is none of these."""
        return zero("vector") if point == ORIGIN else self.points.get(point)
