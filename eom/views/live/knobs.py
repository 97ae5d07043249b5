"""How far sliders go: from the value of a quantity, its unit, and others of the same unit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from eom.quantities import Quantity
from eom.views.live.subject import Knob

POSITIVE_UNITS = frozenset({"kg", "kg m^2"})
"""Masses and moments of inertia are above zero."""
AT_ZERO = {"rad": math.pi, "rad/s": 5.0, "m": 1.0, "m/s": 2.0, "N m": 1.0, "N": 5.0}
"""How far a slider goes whose value, and all others of its unit, are zero."""
TIMES = 2.5


def knob(quantity: Quantity, value: float, group: str, around: float = 0.0) -> Knob:
    """Return the knob of a quantity; ``around``: the largest of those it belongs with."""
    positive = quantity.unit in POSITIVE_UNITS or bool(quantity.symbol.is_positive)
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
