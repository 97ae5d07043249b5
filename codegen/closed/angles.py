"""Rotation angles of a motion in closed form: continuous, at any time, by themselves.

Any sequence is the sequence 3-1-3 between constant turns: q' = E q E^-1, followed by a turn of -90
degrees about the first axis where the three axes of the sequence differ (the second angle is then 90
degrees smaller). With alpha = q0' + i q3' and beta = q1' + i q2'

    psi = arg alpha + arg beta,  phi = arg alpha - arg beta,  tan(theta/2) = |beta|/|alpha|

An angle grows without limit, an argument is known but for whole turns. alpha and beta are sums of four
terms, multiples of the form's own alpha, beta and their conjugates, whose continuous phases
the form says. Where one term is larger than the others together, the argument of the sum stays
within a right angle of that term's: this fixes the turns. Where none is, there is no closed form here.
Source: Klein and Sommerfeld, Theorie des Kreisels (1897), ch. 1 (alpha, beta); the rest is Rouche's.

How alpha and beta of each closed form wind about zero: bounds of their moduli, continuous phases.

alpha = q0 + i q3 and beta = q1 + i q2 are those of the quaternion of a form,
in its own axes.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from codegen.closed.elliptic import Pair, grown, reduced
from codegen.closed.exact import Periodic, Steady
from codegen.closed.heavy_top import Nutating, TopForm, Uniform
from eom.rotations import quaternion_product as product

Array = NDArray[np.float64]
Quaternion = Sequence[Any]
TURN = 2 * math.pi
CLEAR = 1e-6
"""By which part of the largest term it must exceed the others together."""


class Winding(Protocol):
    """alpha and beta of a form over time: moduli between bounds, and continuous phases."""

    @property
    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and greatest |alpha|, and |beta|."""

    def phases(self, t: Any) -> tuple[Any, Any]:
        """Return the phases, rad, to a small part of a turn."""


@dataclass(frozen=True)
class Sequence3:
    """A sequence of turns about body axes 1, 2, 3, by numbers 0, 1, 2, as 3-1-3 between turns."""

    axes: tuple[int, int, int]

    @property
    def is_proper(self) -> bool:
        """Whether the first and the last axis are one."""
        return self.axes[0] == self.axes[2]

    @property
    def sense(self) -> int:
        """Sign of the third angle in 3-1-3."""
        i, j, k = self.axes
        return 1 if i == k or (j - i) % 3 == 1 else -1

    @property
    def before(self) -> tuple[float, float, float, float]:
        """E: takes the first axis to the third, and the second axis to the first."""
        i, j, _ = self.axes
        if (j - i) % 3 == 1:
            return _cyclic((2 - i) % 3)
        turn = (math.sqrt(0.5), 0.0, 0.0, -math.sqrt(0.5))  # takes axis 2 to 1
        return product(turn, _cyclic((2 - i) % 3))

    @property
    def after(self) -> tuple[float, float, float, float]:
        """E^-1, followed by the quarter turn of an improper sequence."""
        a, b, c, d = self.before
        back = (a, -b, -c, -d)
        return (
            back if self.is_proper else product(back, (math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0))
        )


def _cyclic(steps: int) -> tuple[float, float, float, float]:
    """Return the turn that takes axis k to axis k + steps."""
    return ((1.0, 0.0, 0.0, 0.0), (0.5, 0.5, 0.5, 0.5), (0.5, -0.5, -0.5, -0.5))[steps]


def upright(axis: Sequence[float]) -> tuple[float, float, float, float]:
    """Return a turn that takes the third axis to ``axis``: the least one, from below after half a turn."""
    x, y, z = axis
    size = math.sqrt(2 * (1 + abs(z)))
    return (size / 2, -y / size, x / size, 0.0) if z >= 0 else (-y / size, size / 2, 0.0, x / size)


@dataclass(frozen=True)
class Lift:
    """The continuous argument of alpha or beta: it follows ``sign`` times a phase of the form."""

    which: int
    sign: int
    shift: float

    def __call__(self, phases: Sequence[Any], real: Any, imaginary: Any) -> tuple[Any, Any]:
        """Return the argument, and the turns that bring it nearest to the phase that it follows."""
        argument = np.arctan2(imaginary, real)
        near = self.sign * phases[self.which] + self.shift
        return argument, np.rint((near - argument) / TURN)


@dataclass(frozen=True)
class Angles:
    """Three angles over time, from those at the start."""

    sequence: Sequence3
    winding: Winding
    lifts: tuple[Lift, Lift]
    start: tuple[float, float, float]
    first: tuple[float, float]
    """Arguments of alpha and beta at the start, and their turns."""
    turns: tuple[float, float]

    def __call__(self, t: Any, q: Quaternion) -> list[Any]:
        """Return the angles of the quaternions ``q`` at the times."""
        q0, q1, q2, q3 = product(product(self.sequence.before, q), self.sequence.after)
        phases = self.winding.phases(t)
        a, m = self.lifts[0](phases, q0, q3)
        b, n = self.lifts[1](phases, q1, q2)
        a, b, m, n = a - self.first[0], b - self.first[1], m - self.turns[0], n - self.turns[1]
        tilt = 2 * np.arctan2(np.hypot(q1, q2), np.hypot(q0, q3))
        quarter = 0.0 if self.sequence.is_proper else math.pi / 2
        half = math.floor((self.start[1] - quarter) / math.pi)
        theta = half * math.pi + tilt if half % 2 == 0 else (half + 1) * math.pi - tilt
        return [
            self.start[0] + (a + b) + TURN * (m + n),
            theta + quarter,
            self.start[2] + self.sequence.sense * ((a - b) + TURN * (m - n)),
        ]


def angles(
    sequence: Sequence3,
    winding: Winding,
    turns: tuple[Quaternion, Quaternion],
    start: tuple[float, float, float],
    first: Quaternion,
) -> Angles | None:
    """Return the angles of the motion turns[0] q turns[1], where q is the form's; None if unclear.

    ``start``: angles at first; ``first``: the motion's quaternion at first.
    """
    left, right = (
        product(sequence.before, turns[0]),
        product(turns[1], sequence.after),
    )
    lifts = [_lift(terms, winding) for terms in _terms(left, right)]
    one, two = lifts
    if one is None or two is None:
        return None
    q0, q1, q2, q3 = (
        np.array([float(v)]) for v in product(product(sequence.before, first), sequence.after)
    )
    phases = winding.phases(np.zeros(1))
    (a, m), (b, n) = one(phases, q0, q3), two(phases, q1, q2)
    first_two, turns_two = (float(a[0]), float(b[0])), (float(m[0]), float(n[0]))
    return Angles(sequence, winding, (one, two), start, first_two, turns_two)


Terms = tuple[complex, complex, complex, complex]
"""Multiples of alpha, beta, and their conjugates."""


def _terms(left: Quaternion, right: Quaternion) -> tuple[Terms, Terms]:
    """Return alpha and beta of left q right in terms of those of q."""
    a, b = complex(left[0], left[3]), complex(left[1], left[2])
    c, d = complex(right[0], right[3]), complex(right[1], right[2])
    return (
        (a * c, -a * d.conjugate(), -b * d.conjugate(), -b * c),
        (a * d, a * c.conjugate(), b * c.conjugate(), -b * d),
    )


def _lift(terms: Terms, winding: Winding) -> Lift | None:
    bounds = winding.bounds * 2
    for k, term in enumerate(terms):
        least = abs(term) * bounds[k][0]
        others = sum(abs(c) * bounds[j][1] for j, c in enumerate(terms) if j != k)
        if least * (1 - CLEAR) > others:
            return Lift(k % 2, 1 if k < 2 else -1, cmath.phase(term))
    return None


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
    """The heavy top, whose forms give their phases by themselves."""

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
    """Return how a form winds, in its `own_axes`; None where it does not say."""
    if isinstance(form, Steady):
        return Spinning(form)
    if isinstance(form, Periodic):
        return FreeWinding(form)
    return TopWinding(form.motion) if isinstance(form, TopForm) else None
