"""Three quantities, the rate of each a multiple of the product of the others, by sn, cn, dn.

    y1' = c1 y2 y3,  y2' = c2 y3 y1,  y3' = c3 y1 y2

Euler's equations without torque are of this form, with or without a body that has such moments of
inertia; so are two quantities that turn with a constant rate (c3 = 0). One c must have a sign of its
own: call it c2, and let |c1| y3^2 >= |c3| y1^2. Then, with E = |c2| y1^2 + |c1| y2^2 and
F = |c3| y2^2 + |c2| y3^2, which are constant,

    y1 = a1 cn u,  y2 = -sign(c1) a2 sn u,  y3 = a3 dn u,  u = u0 + p t
    a1^2 = E/|c2|,  a2^2 = E/|c1|,  a3^2 = F/|c2|,  p^2 = |c1| F
    m = |c3| E/(|c1| F),  1 - m = |c2| (|c1| y3^2 - |c3| y1^2)/(|c1| F)

All of these are computed as fractions of the data. Source: DLMF 22.13 (i).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from codegen.closed.elliptic import Modulus, Series, carlson, series
from codegen.closed.phases import Pair, pair, parity, reduced, scaled
from codegen.closed.polhode import context, number, root

Array = NDArray[np.float64]
Triple = tuple[Fraction, Fraction, Fraction]


@dataclass(frozen=True)
class Constant:
    """Quantities that do not change."""

    values: tuple[float, ...]
    fastest: float = 0.0

    def __call__(self, t: Array) -> Array:
        """Return the values at each time, (3, N)."""
        return np.stack([np.full_like(t, v) for v in self.values])


@dataclass(frozen=True)
class Triad:
    """The elliptic functions; ``places``: of y1, y2, y3 among the three; ``fastest`` phase, rad/s."""

    functions: Series
    rate: Pair
    start: Pair
    amplitudes: tuple[float, float, float]
    places: tuple[int, int, int]
    fastest: float

    def __call__(self, t: Array) -> Array:
        """Return the three quantities at the times, (3, N)."""
        u, count = reduced(t, self.rate, self.start, self.functions.period)
        sn, cn, dn, _, _ = self.functions(u)
        sign = parity(count)
        shapes = (sign * cn, sign * sn, dn)
        rows = [a * f for a, f in zip(self.amplitudes, shapes, strict=True)]
        return np.stack([rows[self.places.index(k)] for k in range(3)])


def triad(coefficients: Triple, start: Triple) -> Constant | Triad | None:
    """Return the motion from ``start``; None where it is not of this kind.

    None: no sign stands alone (the motion may grow without bounds), or c has a single entry that is
    not zero.
    """
    if not any(_rates(coefficients, start)):
        x, y, z = map(float, start)
        return Constant((x, y, z))
    order = next((o for o in permutations(range(3)) if _fits(coefficients, start, o)), None)
    return None if order is None else _triad(coefficients, start, order)


def _rates(c: Triple, y: Triple) -> list[Fraction]:
    return [c[k] * y[k - 2] * y[k - 1] for k in range(3)]


def _fits(c: Triple, y: Triple, order: Sequence[int]) -> bool:
    first, odd, last = (c[k] for k in order)
    alone = first * odd < 0 and first * last >= 0
    return alone and abs(first) * y[order[2]] ** 2 >= abs(last) * y[order[0]] ** 2


def _triad(c: Triple, y: Triple, order: tuple[int, ...]) -> Triad:
    own = context()
    first, odd, last = (abs(c[k]) for k in order)
    x1, x2, x3 = (y[k] for k in order)
    E, F = odd * x1**2 + first * x2**2, last * x2**2 + odd * x3**2
    excess = first * x3**2 - last * x1**2
    modulus = Modulus(number(own, last * E / (first * F)), number(own, odd * excess / (first * F)))
    s1, s3 = (1 if v >= 0 else -1 for v in (x1, x3))
    sense = -1 if c[order[0]] > 0 else 1
    a1, a2, a3 = (root(own, v) for v in (E / odd, E / first, F / odd))
    sine = number(own, s1 * s3 * sense * x2) / a2
    cosine = number(own, abs(x1)) / a1
    u0 = sine * carlson(cosine**2, (number(own, x3) / a3) ** 2, own.one)
    p = root(own, first * F)
    i, j, k = order
    return Triad(
        functions=series(modulus, own.zero).functions,
        rate=scaled(p),
        start=pair(u0),
        amplitudes=(float(s1 * a1), float(s1 * s3 * sense * a2), float(s3 * a3)),
        places=(i, j, k),
        fastest=float(p),
    )
