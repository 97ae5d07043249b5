"""A scene as a live page needs it: numbers to change, parts to leave out, one system a choice.

How far sliders go: from the value of a quantity, its unit, and others of the same unit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from eom.multibody.system.vectors import VectorOf
from eom.quantities import Quantity
from eom.system import System
from eom.terms.terms import Equation

Choice = tuple[bool, ...]
"""What is left out: one truth value a switch, in order."""

MOST_SWITCHES = 3
"""Every choice has a right-hand side of its own: eight at most."""
VECTORS, FRAMES = ("omega", "H", "torque"), ("trails", "body frames", "space frame")
"""What can be hidden, by the names of the viewer: of one body, and of all."""
ALL = "all "
"""How what is hidden together begins: all vectors of a group (`eom.views.animation.acting.STYLES`)."""
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
    with another. ``free``: no torque, so that Poinsot's construction holds. ``law``: the law of motion,
    with words, of one body. ``vectors``: those of a tree that are drawn, the last six outputs of each.
    """

    own: System
    drawn: System
    left_out: tuple[str, ...]
    general: int
    after: int
    equal: Mapping[str, str] = field(default_factory=dict)
    free: bool = False
    law: tuple[tuple[Equation, str], ...] = ()
    vectors: tuple[VectorOf, ...] = ()


@dataclass(frozen=True)
class Attitude:
    """A quaternion among the states, by the angles of a sequence at the start.

    ``states``: names of its parts, scalar first. ``sequence``: numbers of the axes. ``knobs``: names.
    """

    states: tuple[str, ...]
    sequence: tuple[int, ...]
    knobs: tuple[str, ...]


@dataclass(frozen=True)
class Fitting:
    """Something on the bodies of a tree: numbers of the bodies, -1 for the ground, and its values.

    ``kind``: a row of `eom.views.live.fittings.KINDS`, which says what the values are. ``name``: of the
    part of the scene.
    """

    kind: str
    name: str
    bodies: tuple[int, ...]
    values: tuple[Any, ...] = field(compare=False)


@dataclass(frozen=True)
class Subject:
    """A scene as a live page needs it.

    ``kind``: body, spinner or tree. ``attitudes``: quaternions whose knobs are angles. ``inertia``: names
    of the entries of the inertia matrix, of one body. ``centre``: names of the components of the centre of
    mass from the fixed point, or empty. ``bodies``: by the order of what is drawn. ``joints``: by body the
    number of joints that lead on. ``fittings``: what else is drawn of a tree. ``follow``: the number of a
    body that floats, with which the camera goes, or -1. ``up``: against gravity. ``speeds``: states that
    are rates of others, and ``keep``: those that are changed last, where constraints are met. ``caption``:
    below the picture; ``shown``: what can be hidden, and whether it is seen at first.
    """

    kind: str
    name: str
    title: str
    description: str
    knobs: tuple[Knob, ...]
    switches: tuple[Switch, ...]
    variants: Mapping[Choice, Variant]
    attitudes: tuple[Attitude, ...] = ()
    inertia: tuple[tuple[str, ...], ...] = ()
    centre: tuple[str, ...] = ()
    bodies: tuple[str, ...] = ()
    joints: tuple[int, ...] = ()
    fittings: tuple[Fitting, ...] = ()
    follow: int = -1
    speeds: tuple[str, ...] = ()
    keep: tuple[str, ...] = ()
    up: Sequence[float] = (0.0, 0.0, 1.0)
    notes: tuple[str, ...] = ()
    caption: str = ""
    shown: Mapping[str, bool] = field(default_factory=dict)

    @property
    def choice(self) -> Choice:
        """What the scene itself leaves out."""
        return tuple(s.on for s in self.switches)


POSITIVE_UNITS = frozenset({"kg", "kg m^2"})
"""Masses and moments of inertia are above zero."""
AT_ZERO = {"rad": math.pi, "rad/s": 5.0, "m": 1.0, "m/s": 2.0, "N m": 1.0, "N": 5.0}
"""How far a slider goes whose value, and all others of its unit, are zero."""
TIMES = 2.5


def knob(
    quantity: Quantity, value: float, group: str, around: float = 0.0, *, positive: bool = False
) -> Knob:
    """Return the knob of a quantity; ``around``: the largest of those it belongs with."""
    positive = positive or quantity.unit in POSITIVE_UNITS or bool(quantity.symbol.is_positive)
    low, high = _range(quantity.unit, value, max(abs(value), around), positive)
    words = quantity.meaning or quantity.name
    return Knob(quantity.name, words, quantity.unit, value, low, high, group, positive)


def _range(unit: str, value: float, size: float, positive: bool) -> tuple[float, float]:
    if positive and value > 0:
        return _round(value / 10), _round(TIMES * value)
    if unit == "rad" and size <= math.pi:
        return -math.pi, math.pi
    high = _round(TIMES * size) or AT_ZERO.get(unit, 1.0)
    return -high, high


def _round(value: float) -> float:
    """Return two digits of a number."""
    return float(f"{value:.2g}")


def of_states(states: Iterable[Quantity], values: Mapping[str, float]) -> list[Knob]:
    """Return the knobs of initial values; those of one unit go equally far."""
    known = [q for q in states if q.name in values]
    size = {
        unit: max(abs(values[q.name]) for q in known if q.unit == unit)
        for unit in dict.fromkeys(q.unit for q in known)
    }
    return [knob(q, values[q.name], "start", size[q.unit]) for q in known]


def of_inputs(system: System, values: Mapping[str, float]) -> Iterator[Knob]:
    """Yield the knobs of inputs, zero where no value is given; none of those that samples set at once."""
    stepped = {d.name for s in system.sampled for d in s.states}
    at_once = {d.name for s in system.sampled for d in s.laws if not s.delay}
    for q in system.inputs:
        if q.name not in at_once:
            group = "start" if q.name in stepped else "torque"
            yield knob(q, values.get(q.name, 0.0), group)


Off = Sequence[str]
"""Names of the switches that are on: of what is left out."""


def variants_of(
    switches: Sequence[Switch], make: Callable[[Off], Variant]
) -> dict[Choice, Variant]:
    """Return the equations of each choice."""
    choices = product((False, True), repeat=len(switches))
    return {c: make([s.name for s, on in zip(switches, c, strict=True) if on]) for c in choices}


SEQUENCE = "3-2-1"
"""In which attitudes are shown that a scene gives otherwise."""


def attitude_knobs(
    states: Sequence[str], sequence: str, degrees: Sequence[float], prefix: str = "", of: str = ""
) -> tuple[Attitude, list[Knob]]:
    """Return a quaternion among the states as angles, and their knobs; ``of``: whose it is, in words."""
    axes = tuple(int(a) for a in sequence.split("-"))
    knobs = [
        Knob(f"attitude_{prefix}{k}", f"{word} turn{of} at the start, about axis {axis}", "deg",
             float(angle), -180.0, 180.0, "start")
        for k, word, axis, angle in zip((1, 2, 3), ("first", "second", "third"), axes, degrees, strict=True)
    ]  # fmt: skip
    return Attitude(tuple(states), axes, tuple(k.name for k in knobs)), knobs
