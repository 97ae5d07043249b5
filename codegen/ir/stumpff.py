r"""Stumpff's functions: c_k(z) = sum over j of (-z)^j / (2 j + k)!, for k >= 1 and z of either sign.

c_1(x^2) = sin(x)/x, c_2(x^2) = (1 - cos x)/x^2, c_3(x^2) = (x - sin x)/x^3; sinh and cosh stand in for
sin and cos where z is negative. All are smooth at zero, and so are their derivatives,
d c_k/dz = (k c_{k+2} - c_{k+1})/2, at any order. Stiefel and Scheifele, Linear and Regular Celestial
Mechanics, 1971, sect. 11; Danby, Fundamentals of Celestial Mechanics, 2nd ed., 1988, sect. 6.9.

Evaluation: below a cutoff by the series, above it from sine or sinh by the recurrence
c_{k+2} = (1/k! - c_k)/z. The cutoff (k + 1)(k + 2)/2 makes both safe. Below it each term of the series is
less than half of the one before, so that the sum of moduli is at most three times the sum, and rounding
is not magnified more than that. Above it, a step of the recurrence to c_k magnifies the rounding of 1/k!
by k (k - 1)/|z| < 2 and that of the step before by less than 3; the steps before it do less. The terms
are as many as leave a remainder of 2^-55. Measured, in units in the last place: at most 1.3 below the
cutoff; above it 1.1 for k <= 3, 3.1 for k = 8, 40 for k = 23, where z is negative and near the cutoff.
"""

from __future__ import annotations

from math import factorial
from typing import Any

import numpy as np

Number = Any
Context = Any

SERIES: dict[int, tuple[float, int]] = {
    1: (3.0, 10),
    2: (6.0, 11),
    3: (10.0, 12),
    4: (15.0, 13),
    5: (21.0, 14),
    6: (28.0, 14),
    7: (36.0, 15),
    8: (45.0, 16),
    9: (55.0, 16),
    10: (66.0, 16),
    11: (78.0, 17),
    12: (91.0, 17),
    13: (105.0, 18),
    14: (120.0, 18),
    15: (136.0, 18),
    16: (153.0, 19),
    17: (171.0, 19),
    18: (190.0, 19),
    19: (210.0, 20),
    20: (231.0, 20),
    21: (253.0, 20),
    22: (276.0, 21),
    23: (300.0, 21),
    24: (325.0, 21),
}
"""By k: where the series ends, and how many terms after the first it has."""
LARGEST = max(SERIES)
"""24 is enough for ten derivatives of c_3."""


def double(k: float, z: Any) -> Any:
    """Evaluate in double precision, as the targets do."""
    k, z = int(k), np.float64(z)
    cutoff, terms = SERIES[k]
    if abs(z) < cutoff:
        c = np.float64(1.0)
        for j in range(terms, 0, -1):
            c = 1.0 - z * c / ((2.0 * j + k - 1.0) * (2.0 * j + k))
        return c / float(factorial(k))
    s = np.sqrt(abs(z))
    if k % 2:
        c = (np.sin(s) if z > 0 else np.sinh(s)) / s
    else:
        q = (np.sin(0.5 * s) if z > 0 else np.sinh(0.5 * s)) / s
        c = 2.0 * q * q
    for n in range(2 - k % 2, k, 2):
        c = (1.0 / float(factorial(n)) - c) / z
    return c


def exact(m: Context, k: Number, z: Number) -> Number:
    """Evaluate in a mpmath context, with digits to spare for what cancels."""
    k = int(k)
    if not m.isfinite(z):
        return m.nan
    with m.extraprec(200):
        if abs(z) < 1:
            total = term = 1 / m.factorial(k)
            j = 0
            while term != 0 and m.mag(term) > m.mag(total) - 2 * 200 - 200:
                j += 1
                term = -term * z / ((2 * j + k - 1) * (2 * j + k))
                total += term
        else:
            s = m.sqrt(abs(z))
            start = (m.sin if z > 0 else m.sinh)(s) / s
            half = (m.sin if z > 0 else m.sinh)(s / 2) / s
            total = start if k % 2 else 2 * half * half
            for n in range(2 - k % 2, k, 2):
                total = (1 / m.factorial(n) - total) / z
    return +total


def slope(m: Context, k: Number, z: Number) -> Number:
    """Return d c_k/dz."""
    return (k * exact(m, k + 2, z) - exact(m, k + 1, z)) / 2


def scale(m: Context, value: Number, k: Number, z: Number) -> Number:
    """Return what the rounding error is relative to: |c_k| + |z d c_k/dz|, times 1 + (k/7)^2.

    The second term is what rounding of the root of z makes; it decides near the zeros of c_1 and c_2.
    The factor stands for the steps of the recurrence.
    """
    return (abs(value) + abs(z * slope(m, k, z))) * (1 + (k / 7) ** 2)
