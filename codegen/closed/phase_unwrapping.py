"""How alpha and beta of each closed form wind about zero: bounds of their moduli, continuous phases.

See `codegen.closed.angles`. alpha = q0 + i q3 and beta = q1 + i q2 are those of the quaternion of a form,
in its own axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from codegen.closed.angles import Winding, upright
from codegen.closed.exact import Periodic, Steady
from codegen.closed.heavy_top import Nutating, TopForm, Uniform
from codegen.closed.phases import Pair, grown, reduced

Bounds = tuple[tuple[float, float], tuple[float, float]]
NOTHING = Pair(0.0, 0.0)


@dataclass(frozen=True)
class Spinning:
    """A turn about the third axis: alpha = exp(i w t/2), beta = 0."""

    form: Steady

    @property
    def bounds(self) -> Bounds:
        """See `Winding`."""
        return (1.0, 1.0), (0.0, 0.0)

    def phases(self, t: Any) -> tuple[Any, Any]:
        """See `Winding`."""
        return grown(t, self.form.half_rate, NOTHING), np.zeros_like(t)


@dataclass(frozen=True)
class FreeWinding:
    """The free body: alpha is positive but for the turn chi/2, beta goes round with sn and cn."""

    form: Periodic

    @property
    def bounds(self) -> Bounds:
        """See `Winding`."""
        low, high = self.form.least, self.form.cosines[2]
        ends = (math.sqrt((1 + low) / 2), math.sqrt((1 + high) / 2))
        return ends, (math.sqrt(max(0.0, 1 - high) / 2), math.sqrt((1 - low) / 2))

    def phases(self, t: Any) -> tuple[Any, Any]:
        """See `Winding`."""
        form = self.form
        u, count = reduced(t, form.rate, form.start, form.functions.period)
        sn, cn, _, real, imaginary = form.functions(u)
        drop = form.half_drop.high * 2.0**form.half_drop.exponent
        alpha = grown(t, form.half_rate, NOTHING) + drop * count
        alpha = alpha - form.sense * np.arctan2(imaginary, real)
        c1, c2, _ = form.cosines
        around = np.arctan2(abs(c2) * sn, c1 * cn) + math.pi * count
        return alpha, alpha - math.pi / 2 + math.copysign(1.0, c2) * around


@dataclass(frozen=True)
class TopWinding:
    """The heavy top, whose forms tell their phases by themselves."""

    form: Nutating | Uniform

    @property
    def bounds(self) -> Bounds:
        """See `Winding`."""
        low, high = self.form.heights
        a, b = (math.sqrt(max(0.0, 1 + z) / 2) for z in (low, high))
        c, d = (math.sqrt(max(0.0, 1 - z) / 2) for z in (high, low))
        return (a, b), (c, d)

    def phases(self, t: Any) -> tuple[Any, Any]:
        """See `Winding`."""
        form, found = self.form, []
        parts: list[Any] = [None, None]
        count = np.zeros_like(t)
        if isinstance(form, Nutating):
            u, count = reduced(t, form.rate, form.start, form.functions.period)
            parts = form.functions(u)[:2]
        for turning, part in zip(form.turnings[:2], parts, strict=True):
            phase = grown(t, turning.rate, turning.start)
            if part is not None:
                drop = turning.drop.high * 2.0**turning.drop.exponent
                around = np.arctan2(part[1], part[0]) + math.pi * count
                phase = phase + drop * count + turning.sense * around
            found.append(phase)
        return found[0], found[1]


def own_axes(form: Any) -> tuple[float, float, float, float]:
    """Return the turn that takes the axes in which a form winds to those of its quaternion."""
    if isinstance(form, Steady) and any(form.axis):
        return upright(form.axis)
    return 1.0, 0.0, 0.0, 0.0


def winding(form: Any) -> Winding | None:
    """Return how a form winds, in its `own_axes`; None where it does not tell."""
    if isinstance(form, Steady):
        return Spinning(form)
    if isinstance(form, Periodic):
        return FreeWinding(form)
    return TopWinding(form.motion) if isinstance(form, TopForm) else None
