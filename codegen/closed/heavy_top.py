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
`codegen.closed.heavy_top` times exp(i c t). Nothing is singular at the vertical. Where u = 0 the
turn about the vertical is chosen so that alpha and beta are positive; w1 + i w2 is then imaginary.

Sources: Whittaker, Analytical Dynamics (1937), sec. 71-73; Klein and Sommerfeld, Theorie des Kreisels
(1898), ch. 6 (alpha and beta as quotients of theta functions); Leimanis, The General Problem of the
Motion of Coupled Rigid Bodies about a Fixed Point (1965), ch. 2; Golubev, Lectures (1953), ch. 4.

Quotients of theta functions whose squares are linear in sn^2: complex functions of a real argument.

With v = pi u/(2 K) and y = pi eta/(2 K), 0 <= eta <= K',

    odd:   i conj(theta1(v + i y))/theta4(v),  |.|^2 a multiple of sn^2 u + tan^2 phi
    even:  conj(theta2(v + i y))/theta4(v),    |.|^2 a multiple of 1 - sn^2 u dn^2(eta | m1)

F(phi | m1) = eta in the first. Both are positive at u = 0 and turn forwards; at eta = 0 the odd one is
imaginary. After 2 K they change their sign. Any square root of a linear function of sn^2 whose phase
is an integral of the third kind of the circular case is one of these times exp(i c u).

Series in the nome q where m <= 1/2, in the complementary one where m > 1/2 (DLMF 20.2, 20.7 (viii)):
the latter leave out a factor exp(i pi eta u/(2 K K')).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from codegen.closed.elliptic import (
    NEVER,
    Modulus,
    Pair,
    carlson,
    clenshaw,
    doubles,
    first_kind,
    pair,
    parity,
    powers,
    reduced,
    scaled,
    steps,
)
from codegen.closed.polhode import context, number

Array = NDArray[np.float64]
Number = Any  # a mpmath real
Complex = tuple[Array, Array]
"""Real and imaginary part."""


@dataclass(frozen=True)
class Root:
    """A function asked for: odd or even, its offset, and its size: at K if odd, at 0 if even."""

    odd: bool
    eta: Number
    size: Number


class Quotients(Protocol):
    """Functions of one modulus, for arrays of arguments."""

    @property
    def period(self) -> Pair:
        """2 K."""

    def __call__(self, u: Array) -> list[Complex]:
        """Return the functions at -K <= u <= K."""


@dataclass(frozen=True)
class Prepared:
    """Functions, and for each the rate of its phase at 0 and what is left out from -K to K, rad."""

    functions: Quotients
    slopes: tuple[Number, ...]
    turns: tuple[Number, ...]


def quotients(modulus: Modulus, roots: Sequence[Root]) -> Prepared:
    """Return the series that converge faster; 0 < m <= 1."""
    return (circular if modulus.m <= modulus.m1 else hyperbolic)(modulus, roots)


@dataclass(frozen=True)
class Circular:
    """Coefficients of cos (2n+1)v in the real parts, sin (2n+1)v in the imaginary, cos 2nv below."""

    period: Pair
    scale: float
    below: tuple[float, ...]
    parts: tuple[tuple[tuple[float, ...], tuple[float, ...]], ...]

    def __call__(self, u: Array) -> list[Complex]:
        """See `Quotients`."""
        v = u * self.scale
        s, c = np.sin(v), np.cos(v)
        twice = 2 - 4 * s * s  # 2 cos 2v
        below = 1 / clenshaw(self.below, twice, np.ones_like(v), twice / 2)
        s, c = s * below, c * below
        s3, c3 = s * (twice + 1), c * (twice - 1)
        return [
            (clenshaw(real, twice, c, c3), clenshaw(imaginary, twice, s, s3))
            for real, imaginary in self.parts
        ]


def circular(modulus: Modulus, roots: Sequence[Root]) -> Prepared:
    """Return the series in the nome."""
    own = modulus.context
    q, scale = modulus.nome, own.pi / 2 / modulus.K
    squares, odd = powers(q, 0), powers(q, 1)
    below = [squares[0], *(2 * p * (-1) ** n for n, p in enumerate(squares[1:], 1))]
    at_end = 2 * sum(squares) - 1  # theta4 at v = pi/2; at 0 it is sum(below)
    parts, slopes = [], []
    for root in roots:
        y, sign = scale * root.eta, -1 if root.odd else 1
        waves = [sign**n * p / own.cosh(y) for n, p in enumerate(odd)]
        cosine = [w * own.cosh((2 * n + 1) * y) for n, w in enumerate(waves)]
        sine = [w * own.sinh((2 * n + 1) * y) for n, w in enumerate(waves)]
        real, imaginary = (sine, cosine) if root.odd else (cosine, sine)
        rate = sum((2 * n + 1) * b for n, b in enumerate(imaginary))
        slopes.append(scale * rate / sum(real) if sum(real) else own.zero)
        top = sum((-1) ** n * b for n, b in enumerate(imaginary)) if root.odd else sum(real)
        factor = root.size * (at_end if root.odd else sum(below)) / top
        parts.append((_kept([factor * a for a in real]), _kept([factor * a for a in imaginary])))
    functions = Circular(pair(2 * modulus.K), float(scale), doubles(below), tuple(parts))
    return Prepared(functions, tuple(slopes), tuple(own.zero for _ in roots))


@dataclass(frozen=True)
class Branch:
    """A function over exponentials: coefficients of its real and its imaginary part."""

    odd: bool
    real: tuple[float, ...]
    imaginary: tuple[float, ...]


@dataclass(frozen=True)
class Hyperbolic:
    """With w = ``scale`` |u|, E = exp(-2 w), X = q' exp(2 w) <= 1 and q' the complementary nome.

    ``squares``: q'^(n^2), of X^n (1 + E^(2n+1)) in the denominator. Odd functions have X^n (1 + E^(2n+1))
    and X^n (1 - E^(2n+1)), even ones X^n (1 + E^2n) and X^n (1 - E^2n) times exp(-w).
    """

    period: Pair
    scale: float
    log_root: float
    squares: tuple[float, ...]
    branches: tuple[Branch, ...]

    def __call__(self, u: Array) -> list[Complex]:
        """See `Quotients`."""
        w = np.abs(u) * self.scale
        less, f = -np.expm1(-w), np.exp(-w)
        root = np.exp(w + self.log_root)  # sqrt X
        X, E, short = root * root, f * f, less * (1 + f)  # short: 1 - E
        count = max(len(self.squares), *(len(b.real) for b in self.branches))
        odd, even = _powers_of(X, E, short, count)
        below = 1 / _sum(self.squares, [plus for plus, _ in odd])
        sign = np.where(u < 0, -1.0, 1.0)
        found = []
        for b in self.branches:
            terms, size = (odd, below) if b.odd else (even, f * below)
            real = _sum(b.real, [plus for plus, _ in terms])
            imaginary = _sum(b.imaginary, [minus for _, minus in terms])
            found.append((size * real, sign * size * imaginary))
        return found


def _powers_of(X: Array, E: Array, short: Array, count: int) -> tuple[list[Complex], list[Complex]]:
    """Return X^n (1 + E^(2n+1)), X^n (1 - E^(2n+1)), and the same with E^(2n), for n < ``count``."""
    one = np.ones_like(X)
    odd, even, power = [], [], one
    even_power, even_short, square = one, np.zeros_like(X), E * E
    for n, (E_n, less) in zip(range(count), steps(E, short), strict=False):
        if n:
            power = power * X
            even_short = even_short + even_power * short * (1 + E)
            even_power = even_power * square
        odd.append((power * (1 + E_n), power * less))
        even.append((power * (1 + even_power), power * even_short))
    return odd, even


def _sum(coefficients: Sequence[float], terms: Sequence[Array]) -> Array:
    """Add from the smallest term up."""
    pairs = list(zip(coefficients, terms, strict=False))
    total = pairs[-1][0] * pairs[-1][1]
    for a, term in pairs[-2::-1]:
        total = a * term + total
    return total


def hyperbolic(modulus: Modulus, roots: Sequence[Root]) -> Prepared:
    """Return the series in the complementary nome."""
    own, q = modulus.context, modulus.complement.nome
    scale = own.pi / 2 / modulus.K1
    squares = powers(q, 0)
    fade = powers(q, 1)  # X^n q'^(n^2) at u = 0
    at_end = [q ** (n * n - n) if n > 1 else own.one for n in range(len(squares))]
    branches, slopes, turns = [], [], []
    for root in roots:
        delta = scale * root.eta
        made = _odd_branch if root.odd else _even_branch
        branch, slope = made(own, q, root.size, delta, (squares, fade, at_end))
        branches.append(branch)
        slopes.append(scale * slope)
        turns.append(2 * delta)
    functions = Hyperbolic(
        period=pair(2 * modulus.K) if modulus.m1 else Pair(np.inf, 0.0),
        scale=float(scale),
        log_root=float(own.log(q) / 2) if q else NEVER,
        squares=doubles(squares),
        branches=tuple(branches),
    )
    return Prepared(functions, tuple(slopes), tuple(turns))


Powers = tuple[list[Number], list[Number], list[Number]]
"""Of the complementary nome: in the series, at u = 0, and at u = K with X = 1/q' set to 1."""


def _odd_branch(
    own: Any, q: Number, size: Number, delta: Number, powers_: Powers
) -> tuple[Branch, Number]:
    squares, fade, _ = powers_
    waves = [(-1) ** n * p for n, p in enumerate(squares)]
    sine = [own.sin((2 * n + 1) * delta) for n in range(len(waves))]
    cosine = [own.cos((2 * n + 1) * delta) for n in range(len(waves))]
    at_zero = [(-1) ** n * p for n, p in enumerate(fade)]
    below = sum(a * s for a, s in zip(at_zero, sine, strict=False))
    rate = sum((2 * n + 1) * a * c for n, (a, c) in enumerate(zip(at_zero, cosine, strict=False)))
    slope = rate / below if delta else own.zero
    # at u = K, where X = 1 and E = q': size of the function there
    real = sum(
        w * s * (1 + q ** (2 * n + 1)) for n, (w, s) in enumerate(zip(waves, sine, strict=True))
    )
    side = sum(
        w * c * (1 - q ** (2 * n + 1)) for n, (w, c) in enumerate(zip(waves, cosine, strict=True))
    )
    end = sum(p * (1 + q ** (2 * n + 1)) for n, p in enumerate(squares))
    factor = size * end / own.hypot(real, side)
    return Branch(
        True,
        _kept([factor * w * s for w, s in zip(waves, sine, strict=True)]),
        _kept([factor * w * c for w, c in zip(waves, cosine, strict=True)]),
    ), slope


def _even_branch(
    own: Any, q: Number, size: Number, delta: Number, powers_: Powers
) -> tuple[Branch, Number]:
    _, fade, gaps = powers_
    waves = [(-1) ** n * p for n, p in enumerate(gaps)]
    cosine = [w * own.cos(2 * n * delta) for n, w in enumerate(waves)]
    sine = [-w * own.sin(2 * n * delta) for n, w in enumerate(waves)]
    # at u = 0, where X = q'
    top = 2 * sum(c * q**n for n, c in enumerate(cosine)) - cosine[0]
    rate = sum(4 * n * s * q**n for n, s in enumerate(sine))
    factor = size * 2 * sum(fade) / top
    cosine[0] /= 2
    return Branch(
        False, _kept([factor * c for c in cosine]), _kept([factor * s for s in sine])
    ), rate / top


def _kept(values: Sequence[Number]) -> tuple[float, ...]:
    """Return as doubles those that are not negligible beside the greatest; at least one."""
    size = max(map(abs, values))
    last = max((n for n, v in enumerate(values) if abs(v) > size * 1e-19), default=0)
    return tuple(float(v) for v in values[: last + 1])


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
    """z1 <= z2 <= z3 of f, the zero zE of the transverse rates, and z at the start.

    They have as many digits as their differences need; these are computed with, in ``own``.
    """

    z1: Number
    z2: Number
    z3: Number
    zE: Number
    z: Number

    @cached_property
    def own(self) -> Any:
        """The numbers of `DIGITS` digits."""
        return context()

    def gap(self, low: Number, high: Number) -> Number:
        """Return a difference of two of them, or of one and a whole number."""
        return self.own.mpf(high - low)


def roots_of(top: Top) -> Roots:
    """Return the roots with `GUARD` digits in every difference that is not zero.

    Roots that are known are exact: -1, 1 or zE where f is zero there, the start where z rests, and a
    double root, which is rational. The others come from the cubic's three real roots by cosines, which
    keep half of the digits: there are as many as they need.
    """
    exact, digits = _known_roots(top), 4 * GUARD
    while digits <= MOST_DIGITS:
        own = context(digits)
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


def _phases(own: Any, top: Top, gaps: Sequence[Number]) -> tuple[Phase, Phase, Phase]:
    """Return those of 1 + z, 1 - z and zE - z, which are given where u = 0."""
    b, h, w3 = top.b, top.h, top.omega[2]
    half = own.mpf(1) / 2
    last = 2 * number(own, top.mu)
    return (
        Phase(gaps[0], half, (w3 - b) / 2, (h + b) / 2),
        Phase(gaps[1], half, (b - w3) / 2, (h - b) / 2),
        Phase(gaps[2], last, b / 2 - w3, (b * top.e / top.mu - h) / 2),
    )


def uniform(top: Top) -> Uniform:
    """Return the motion of a tilt that stays, for the turns that make alpha and beta positive at first."""
    own = context()
    z, zE = number(own, top.up[2]), number(own, top.e / top.mu)
    phases = _phases(own, top, (1 + z, 1 - z, zE - z))
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
    own, high, whole = r.own, r.z1.context, r.gap(r.z1, r.z3)
    modulus = Modulus(r.gap(r.z1, r.z2) / whole, r.gap(r.z2, r.z3) / whole)
    p = own.sqrt(number(own, top.mu) * whole / 2)
    phases = _phases(own, top, (r.gap(-1, r.z1), r.gap(r.z1, 1), r.gap(r.z1, r.zE)))
    sizes = [own.sqrt(phases[0].scale * r.gap(-1, r.z2))]
    sizes += [own.sqrt(q.scale * q.distance) for q in phases[1:]]
    etas = [_below(r, modulus), _above(r, 1, modulus), _above(r, r.zE, modulus)]
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
        quarter=1 if number(high, top.h) >= number(high, top.b) * r.z1 else -1,
    )


def _below(r: Roots, modulus: Modulus) -> Number:
    """Return eta of 1 + z: tan^2 = (1 + z1)/(z2 - z1)."""
    own, whole = r.own, r.gap(-1, r.z2)
    sine, cosine = r.gap(-1, r.z1) / whole, r.gap(r.z1, r.z2) / whole
    return first_kind(own.sqrt(sine), own.sqrt(cosine), modulus.m)


def _above(r: Roots, z: Number, modulus: Modulus) -> Number:
    """Return eta of z* - z: tan^2 = (z* - z2)(z3 - z1)/((z2 - z1)(z3 - z*)); any at z2 = z3."""
    own = r.own
    if r.z2 == r.z3:
        return own.zero
    whole = r.gap(r.z1, z) * r.gap(r.z2, r.z3)
    sine = r.gap(r.z2, z) * r.gap(r.z1, r.z3) / whole
    cosine = r.gap(r.z1, r.z2) * r.gap(z, r.z3) / whole
    return first_kind(own.sqrt(sine), own.sqrt(cosine), modulus.m)


def _start(top: Top, r: Roots) -> Number:
    """Return u at the start, from -K to K: it has the sign of dz/dt, and K or 0 where z rests."""
    own, whole = r.own, r.gap(r.z1, r.z2)
    sine, cosine = own.sqrt(r.gap(r.z1, r.z) / whole), own.sqrt(r.gap(r.z, r.z2) / whole)
    depth = r.gap(r.z, r.z3) / r.gap(r.z1, r.z3)
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
