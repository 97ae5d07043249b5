"""The heavy symmetric top in closed form: Lagrange's case, by theta functions.

A body of moments A, A, C about a fixed point, its centre of mass on the axis b3, under its weight. All
is divided by A: mu = m g l/A, b = C w3/A, h = H_vertical/A, e = energy/A less that of the spin. With
z = cos(tilt), the vertical's component along b3,

    (dz/dt)^2 = f(z) = 2 (e - mu z)(1 - z^2) - (h - b z)^2 = 2 mu (z - z1)(z - z2)(z - z3)
    z = z1 + (z2 - z1) sn^2 u,  u = u0 + p t,  p^2 = mu (z3 - z1)/2,  m = (z2 - z1)/(z3 - z1)

Three complex numbers hold the motion: those of the quaternion, and the transverse angular velocity,

    alpha = q0 + i q3,  |alpha|^2 = (1 + z)/2,    phase' = (w3 - b + (h + b)/(1 + z))/2
    beta = q1 + i q2,   |beta|^2 = (1 - z)/2,     phase' = (b - w3 + (h - b)/(1 - z))/2
    w1 + i w2,          |.|^2 = 2 mu (zE - z),    phase' = b/2 - w3 - (h - b zE)/(zE - z)/2,  zE = e/mu

Each square is linear in z, and f(z*) = -(...)^2 where it is zero: each number is one of
`codegen.closed.theta_quotients` times exp(i c t). Nothing is singular at the vertical. Where u = 0 the
turn about the vertical is chosen so that alpha and beta are positive; w1 + i w2 is then imaginary.

Sources: Whittaker, Analytical Dynamics (1937), sec. 71-73; Klein and Sommerfeld, Theorie des Kreisels
(1898), ch. 6 (alpha and beta as quotients of theta functions); Leimanis, The General Problem of the
Motion of Coupled Rigid Bodies about a Fixed Point (1965), ch. 2; Golubev, Lectures (1953), ch. 4.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from codegen.closed.elliptic import Modulus, carlson, first_kind
from codegen.closed.phases import Pair, pair, parity, reduced, scaled
from codegen.closed.polhode import context, number
from codegen.closed.theta_quotients import Complex, Quotients, Root, quotients

Array = NDArray[np.float64]
Number = Any  # a mpmath real
ZERO, ONE = Fraction(0), Fraction(1)
GUARD = 50
"""Digits that differences of roots keep."""
MOST_DIGITS = 8000
NOTHING = Pair(0.0, 0.0)


@dataclass(frozen=True)
class Top:
    """Exact data. ``mu`` > 0; ``ratio``: C/A; ``omega``: in the body; ``up``: the vertical."""

    mu: Fraction
    ratio: Fraction
    omega: tuple[Fraction, Fraction, Fraction]
    up: tuple[Fraction, Fraction, Fraction]

    @property
    def b(self) -> Fraction:
        """Angular momentum along the axis, over A."""
        return self.ratio * self.omega[2]

    @property
    def h(self) -> Fraction:
        """Angular momentum along the vertical, over A."""
        return self.omega[0] * self.up[0] + self.omega[1] * self.up[1] + self.b * self.up[2]

    @property
    def e(self) -> Fraction:
        """Energy without that of the spin about the axis, over A."""
        return (self.omega[0] ** 2 + self.omega[1] ** 2) / 2 + self.mu * self.up[2]

    @property
    def rise(self) -> Fraction:
        """Rate of z."""
        return self.up[0] * self.omega[1] - self.up[1] * self.omega[0]

    @property
    def cubic(self) -> tuple[Fraction, Fraction, Fraction, Fraction]:
        """Coefficients of f, the highest first."""
        mu, b, h, e = self.mu, self.b, self.h, self.e
        return 2 * mu, -2 * e - b * b, 2 * b * h - 2 * mu, 2 * e - h * h

    @property
    def steady(self) -> bool:
        """Whether the tilt stays: f and its derivative are zero."""
        a, b, c, _ = self.cubic
        z = self.up[2]
        return not self.rise and not (3 * a * z + 2 * b) * z + c


@dataclass(frozen=True)
class Roots:
    """z1 <= z2 <= z3 of f, the zero zE of the transverse rates, and z at the start."""

    z1: Number
    z2: Number
    z3: Number
    zE: Number
    z: Number


def roots_of(top: Top) -> Roots:
    """Return the roots with `GUARD` digits in every difference that is not zero.

    Roots that are known are exact: -1, 1 or zE where f is zero there, the start where z rests, and a
    double root, which is rational. The others come from the cubic's three real roots by cosines, which
    keep half of the digits: there are as many as they need.
    """
    exact, digits = _known_roots(top), 4 * GUARD
    while digits <= MOST_DIGITS:
        own = context()
        own.dps = digits
        z = _snapped(own, _cosines(own, top.cubic), exact)
        marks = [number(own, v) for v in (top.e / top.mu, top.up[2])]
        found = Roots(*z, *marks)
        if _are_apart(own, found):
            return found
        digits *= 2
    raise ArithmeticError


def _f(top: Top, z: Fraction) -> Fraction:
    a, b, c, d = top.cubic
    return ((a * z + b) * z + c) * z + d


def _known_roots(top: Top) -> list[Fraction]:
    """Return rational roots, a double one twice."""
    a, b, c, d = top.cubic
    p, q = b * b - 3 * a * c, b * c - 9 * a * d
    r = c * c - 3 * b * d
    if p and q * q == 4 * p * r:
        double = -q / (2 * p)
        return [double, double, -b / a - 2 * double]
    candidates = dict.fromkeys((-ONE, ONE, top.e / top.mu, top.up[2]))
    return [z for z in candidates if not _f(top, z)]


def _cosines(own: Any, cubic: Sequence[Fraction]) -> list[Number]:
    """Return the three real roots of a cubic in order (Vieta)."""
    a, b, c, d = cubic
    shift = b / (3 * a)
    p, q = (
        (3 * a * c - b * b) / (9 * a * a),
        (2 * b**3 - 9 * a * b * c + 27 * a * a * d) / (54 * a**3),
    )
    if p >= 0:
        return [number(own, -shift)] * 3
    size = own.sqrt(number(own, -p))
    cosine = max(-own.one, min(own.one, number(own, -q) / size**3))
    angle = own.acos(cosine) / 3
    return sorted(
        2 * size * own.cos(angle - 2 * own.pi * k / 3) - number(own, shift) for k in range(3)
    )


def _snapped(own: Any, roots: list[Number], exact: Sequence[Fraction]) -> list[Number]:
    """Put exact roots in the places of the nearest ones."""
    left = list(range(3))
    for value in exact:
        z = number(own, value)
        k = min(left, key=lambda j: abs(roots[j] - z))
        roots[k] = z
        left.remove(k)
    return sorted(roots)


def _are_apart(own: Any, r: Roots) -> bool:
    least = own.mpf(10) ** (GUARD - own.dps // 2) * max(map(abs, (r.z1, r.z2, r.z3, own.one)))
    ordered = (-1, r.z1), (r.z1, r.z), (r.z, r.z2), (r.z2, 1), (1, r.z3), (r.z2, r.zE), (r.zE, r.z3)
    gaps = [b - a for a, b in ordered]
    return r.z1 < r.z2 and all(gap == 0 or gap > least for gap in gaps)


@dataclass(frozen=True)
class Turning:
    """A phase: rate, and what it loses each time that u passes 2 K; ``sense`` of its quotient."""

    rate: Pair
    drop: Pair
    sense: int
    start: Pair


@dataclass(frozen=True)
class Nutating:
    """alpha, beta and w1 + i w2 over time, for the turn that is chosen where u = 0."""

    functions: Quotients
    rate: Pair
    start: Pair
    turnings: tuple[Turning, ...]
    fastest: float
    turn: Pair
    heights: tuple[float, float]
    """z1 and z2."""
    quarter: int
    """By how many right angles w1 + i w2 is ahead of its quotient: 1 or -1."""

    def __call__(self, t: Array) -> list[Complex]:
        """Return the three complex numbers."""
        u, count = reduced(t, self.rate, self.start, self.functions.period)
        sign = parity(count)
        found = []
        for (real, imaginary), turning in zip(self.functions(u), self.turnings, strict=True):
            angle, _ = reduced(t, turning.rate, turning.start, self.turn)
            if turning.drop.high:
                drop, _ = reduced(count, turning.drop, NOTHING, self.turn)
                angle = angle + drop
            c, s = sign * np.cos(angle), sign * np.sin(angle)
            side = turning.sense * imaginary
            found.append((c * real - s * side, c * side + s * real))
        x, y = found[2]
        found[2] = (-self.quarter * y, self.quarter * x)
        return found


@dataclass(frozen=True)
class Uniform:
    """alpha, beta and w1 + i w2 where the tilt stays: values at first, and rates of phases."""

    sizes: tuple[float, ...]
    turnings: tuple[Turning, ...]
    fastest: float
    turn: Pair
    heights: tuple[float, float]
    quarter: int

    def __call__(self, t: Array) -> list[Complex]:
        """Return the three complex numbers."""
        found = []
        for size, turning in zip(self.sizes, self.turnings, strict=True):
            angle, _ = reduced(t, turning.rate, turning.start, self.turn)
            found.append((size * np.cos(angle), size * np.sin(angle)))
        x, y = found[2]
        found[2] = (-self.quarter * y, self.quarter * x)
        return found


@dataclass(frozen=True)
class Phase:
    """A square s |z* - z|, and the rate of the phase: ``steady`` + ``residue``/|z* - z|."""

    distance: Number
    """|z* - z| where u = 0."""
    scale: Number
    steady: Fraction
    residue: Fraction

    def rate(self, own: Any) -> Number:
        """Rate where u = 0; the residue is zero where the distance is."""
        steady = number(own, self.steady)
        return steady + number(own, self.residue) / self.distance if self.distance else steady


def _phases(own: Any, top: Top, z: Number, zE: Number) -> tuple[Phase, Phase, Phase]:
    b, h, w3 = top.b, top.h, top.omega[2]
    half = own.mpf(1) / 2
    last = 2 * number(own, top.mu)
    return (
        Phase(1 + z, half, (w3 - b) / 2, (h + b) / 2),
        Phase(1 - z, half, (b - w3) / 2, (h - b) / 2),
        Phase(zE - z, last, b / 2 - w3, (b * top.e / top.mu - h) / 2),
    )


def uniform(top: Top) -> Uniform:
    """Return the motion of a tilt that stays, for the turns that make alpha and beta positive at first."""
    own = context()
    z, zE = number(own, top.up[2]), number(own, top.e / top.mu)
    phases = _phases(own, top, z, zE)
    rates = [p.rate(own) for p in phases]
    return Uniform(
        sizes=tuple(float(own.sqrt(p.scale * p.distance)) for p in phases),
        turnings=tuple(Turning(scaled(r), NOTHING, 1, NOTHING) for r in rates),
        fastest=max(float(abs(r)) for r in rates),
        turn=pair(2 * own.pi),
        heights=(float(z), float(z)),
        quarter=1 if top.h >= top.b * top.up[2] else -1,
    )


def nutating(top: Top) -> Nutating:
    """Return the motion of a tilt that changes."""
    r = roots_of(top)
    own = r.z1.context
    modulus = Modulus((r.z2 - r.z1) / (r.z3 - r.z1), (r.z3 - r.z2) / (r.z3 - r.z1))
    p = own.sqrt(number(own, top.mu) * (r.z3 - r.z1) / 2)
    phases = _phases(own, top, r.z1, r.zE)
    sizes = [own.sqrt(phases[0].scale * (1 + r.z2))]
    sizes += [own.sqrt(q.scale * q.distance) for q in phases[1:]]
    etas = [_below(r, modulus), _above(r, own.one, modulus), _above(r, r.zE, modulus)]
    shapes = [
        Root(k == 0, eta, size) for k, (eta, size) in enumerate(zip(etas, sizes, strict=True))
    ]
    prepared = quotients(modulus, shapes)
    senses = [1 if q.residue >= 0 else -1 for q in phases]
    rates = [
        q.rate(own) - s * p * slope
        for q, s, slope in zip(phases, senses, prepared.slopes, strict=True)
    ]
    u0 = _start(top, r)
    starts = [pair(own.fmod(rate * u0 / p, 2 * own.pi)) for rate in rates]
    drops = [scaled(-s * turn) for s, turn in zip(senses, prepared.turns, strict=True)]
    return Nutating(
        functions=prepared.functions,
        rate=scaled(p),
        start=pair(u0),
        turnings=tuple(map(Turning, map(scaled, rates), drops, senses, starts)),
        fastest=float(max(p, *map(abs, rates))),
        turn=pair(2 * own.pi),
        heights=(float(r.z1), float(r.z2)),
        quarter=1 if number(own, top.h) >= number(own, top.b) * r.z1 else -1,
    )


def _below(r: Roots, modulus: Modulus) -> Number:
    """Return eta of 1 + z: tan^2 = (1 + z1)/(z2 - z1)."""
    own, whole = r.z1.context, 1 + r.z2
    return first_kind(own.sqrt((1 + r.z1) / whole), own.sqrt((r.z2 - r.z1) / whole), modulus.m)


def _above(r: Roots, z: Number, modulus: Modulus) -> Number:
    """Return eta of z* - z: tan^2 = (z* - z2)(z3 - z1)/((z2 - z1)(z3 - z*)); any at z2 = z3."""
    own = r.z1.context
    if r.z2 == r.z3:
        return own.zero
    whole = (z - r.z1) * (r.z3 - r.z2)
    sine, cosine = (z - r.z2) * (r.z3 - r.z1) / whole, (r.z2 - r.z1) * (r.z3 - z) / whole
    return first_kind(own.sqrt(sine), own.sqrt(cosine), modulus.m)


def _start(top: Top, r: Roots) -> Number:
    """Return u at the start, from -K to K: it has the sign of dz/dt, and K or 0 where z rests."""
    own = r.z1.context
    sine, cosine = own.sqrt((r.z - r.z1) / (r.z2 - r.z1)), own.sqrt((r.z2 - r.z) / (r.z2 - r.z1))
    depth = (r.z3 - r.z) / (r.z3 - r.z1)
    sign = 1 if top.rise >= 0 else -1
    return sign * sine * carlson(cosine**2, depth, own.one)


@dataclass(frozen=True)
class TopForm:
    """Angular velocity (3, N) and a quaternion (4, N), but for a constant turn about the vertical."""

    motion: Nutating | Uniform
    spin: float

    @property
    def fastest(self) -> float:
        """The greatest of the rates of its phases, rad/s."""
        return self.motion.fastest

    def __call__(self, t: Array) -> tuple[list[Array], list[Array]]:
        """Return both at the times."""
        (q0, q3), (q1, q2), (w1, w2) = self.motion(t)
        return [w1, w2, np.full_like(t, self.spin)], [q0, q1, q2, q3]


def top_form(top: Top) -> TopForm:
    """Return the closed form of a top, in the axes of its body. Raises `ArithmeticError` beyond range."""
    motion: Nutating | Uniform = uniform(top) if top.steady else nutating(top)
    angle = _spin_angle(top, motion)
    offsets = (angle / 2, -angle / 2, -angle)
    turnings = tuple(
        replace(turning, start=Pair(turning.start.high + offset, turning.start.low))
        for turning, offset in zip(motion.turnings, offsets, strict=True)
    )
    return TopForm(replace(motion, turnings=turnings), float(top.omega[2]))


def _spin_angle(top: Top, motion: Nutating | Uniform) -> float:
    """Return the angle about b3 from the axes of ``motion`` to those of the body.

    From the transverse angular velocity or from the vertical, whichever is farther from zero.
    """
    alpha, beta, rate = (complex(float(x[0]), float(y[0])) for x, y in motion(np.zeros(1)))
    up = 2j * beta * alpha.conjugate()
    w1, w2, _ = map(float, top.omega)
    g1, g2, _ = map(float, top.up)
    fast = abs(rate) / math.sqrt(2 * float(top.mu) + abs(rate) ** 2)
    ours, theirs = (rate, complex(w1, w2)) if fast > abs(up) else (up, complex(g1, g2))
    return cmath.phase(ours * theirs.conjugate()) if ours and theirs else 0.0
