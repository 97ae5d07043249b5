"""What a live page is about, as data: numbers to change, parts to leave out, one system a choice."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from eom.system import System

Choice = tuple[bool, ...]
"""What is left out: one truth value a switch, in order."""

MOST_SWITCHES = 3
"""Every choice has a right-hand side of its own: eight at most."""
VIEW = "view_"
"""How the names of outputs begin that are there to be drawn."""


@dataclass(frozen=True)
class Knob:
    """A number that the reader can change, between ``low`` and ``high`` by the slider (SI units).

    ``group``: inertia, parameters, torque, start. ``positive``: whether it must be above zero.
    """

    name: str
    meaning: str
    unit: str
    value: float
    low: float
    high: float
    group: str
    positive: bool = False


@dataclass(frozen=True)
class Switch:
    """Something that can be left out: its words, and whether the scene leaves it out."""

    name: str
    words: str
    on: bool


@dataclass(frozen=True)
class Variant:
    """The equations of one choice.

    ``own``: the scene's equations; ``drawn``: those that the page integrates, with attitude and with the
    outputs that are drawn. ``left_out``: what the passes left out, a line each. ``general``: operations
    of the right-hand side before them, ``after`` behind them. ``equal``: parameters that have become one
    with another. ``free``: no torque, so that Poinsot's construction holds.
    """

    own: System
    drawn: System
    left_out: tuple[str, ...]
    general: int
    after: int
    equal: Mapping[str, str] = field(default_factory=dict)
    free: bool = False


@dataclass(frozen=True)
class Subject:
    """A scene as a live page needs it.

    ``kind``: body, spinner or tree. ``fixed``: numbers that cannot be changed, by name. ``sequence``: of
    the turns that the knobs attitude_1 to 3 are the angles of, or empty. ``inertia``: names of the
    entries of the inertia matrix, of one body. ``centre``: names of the components of the centre of mass
    from the fixed point, or empty. ``bodies``: by the order of what is drawn. ``joints``: by body the
    number of joints that lead on. ``up``: against gravity.
    """

    kind: str
    name: str
    title: str
    description: str
    knobs: tuple[Knob, ...]
    switches: tuple[Switch, ...]
    variants: Mapping[Choice, Variant]
    fixed: Mapping[str, float] = field(default_factory=dict)
    sequence: tuple[int, ...] = ()
    inertia: tuple[tuple[str, ...], ...] = ()
    centre: tuple[str, ...] = ()
    bodies: tuple[str, ...] = ()
    joints: tuple[int, ...] = ()
    up: Sequence[float] = (0.0, 0.0, 1.0)
    notes: tuple[str, ...] = ()

    @property
    def choice(self) -> Choice:
        """What the scene itself leaves out."""
        return tuple(s.on for s in self.switches)


Data = dict[str, Any]
"""What a scene file says, as Python values."""
