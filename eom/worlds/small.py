"""Worlds of small whole numbers, whose quantities can be followed with a pencil."""

from __future__ import annotations

import random
from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from eom.fields import Field
from eom.worlds.generators import built
from eom.worlds.shapes import Draw
from eom.worlds.worlds import World, closure

FULL, SPARSE = (0, 1, 1, 2, 3), (0, 0, 1, 1, 2, 3)
"""Numbers that worlds are drawn from: where nothing shown should vanish, and where it may."""


@dataclass(frozen=True)
class Chosen(Field):
    """A field whose random numbers are those of a list, then more that are small and not negative."""

    choices: list[int] = field(default_factory=list, compare=False)
    place: list[int] = field(default_factory=lambda: [0], compare=False)
    more: random.Random | None = field(default=None, compare=False)
    drawn: tuple[int, ...] = field(default=SPARSE, compare=False)

    def draw(self, generator: random.Random) -> Any:  # noqa: ARG002 - the list decides
        """Return the next number of the list."""
        k = self.place[0]
        self.place[0] += 1
        if k == len(self.choices):
            self.choices.append(self.more.choice(self.drawn) if self.more else 1)
        value = self.choices[k]
        return value if self.prime else Fraction(value)


def small_world(assumptions: Iterable[str], seed: int) -> World:
    """Return a world of small numbers under assumptions. Raises `Singular` where these allow none."""
    names = frozenset(closure(assumptions))
    more = random.Random(f"small {seed}")  # noqa: S311 - reproducible
    chosen = Chosen(0, [], more=more, drawn=FULL)
    return built(names, Draw(chosen, random.Random(f"{sorted(names)}"), 0))  # noqa: S311
