"""Jacobi's elliptic functions and theta functions of one modulus, vectorised over the argument.

Constants of the modulus come from the arithmetic-geometric mean and from Carlson's duplication, in
the digits of a mpmath context, from the parameter m and its complement m1 = 1 - m, both given: no
digit is lost by a difference as either goes to zero. Over arrays, theta series in the nome are
summed: of q where m <= 1/2, with circular functions, and of the complementary nome where m > 1/2,
with hyperbolic functions (Jacobi's imaginary transformation). Nomes are at most exp(-pi), so three
terms suffice; at m = 0 and m = 1 none is left, and what remains are sin, cos, tanh, sech.

Sources: NIST Handbook of Mathematical Functions (DLMF) 19.8, 19.36, 20.2, 20.7, 22.2, 22.20; Lawden,
Elliptic Functions and Applications (1989), ch. 1, 2.

Phases that grow with time, reduced by a period without losing digits.

A rate and a period are held as sums of two doubles, 106 bits; the product with a time, which is exact
as given, is formed by Dekker's error-free product (Numer. Math. 18 (1971) 224). What is left after
whole periods are taken away is right to its own rounding, whatever the number of periods, as long
as that number is below 2^53.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from math import isinf, isqrt
from operator import mul
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Number = Any  # a mpmath real

HALVES = 134217729.0
"""2^27 + 1: cuts the 53 bits of a double into two halves (Dekker)."""


@dataclass(frozen=True)
class Pair:
    """A number as ``(high + low) 2^exponent``."""

    high: float
    low: float
    exponent: int = 0


def pair(value: Number) -> Pair:
    """Return a mpmath real as a plain sum of two doubles; it must lie within their range."""
    high = float(value)
    return Pair(high, float(value - high))


def scaled(value: Number) -> Pair:
    """Return a mpmath real of any size as two doubles and a power of two.

    >>> import mpmath
    >>> scaled(mpmath.mpf(3) * 2**2000)
    Pair(high=0.75, low=0.0, exponent=2002)
    """
    mantissa, exponent = value.context.frexp(value)
    high = float(mantissa)
    return Pair(high, float(mantissa - high), int(exponent))


def exact_product(a: Array, b: float) -> tuple[Array, Array]:
    """Return ``a b`` rounded, and what the rounding took away; exact between 1e-290 and 1e290."""
    cut = HALVES * a
    a_high = cut - (cut - a)
    a_low = a - a_high
    b_high = HALVES * b - (HALVES * b - b)
    b_low = b - b_high
    rounded = a * b
    rest = ((a_high * b_high - rounded) + a_high * b_low + a_low * b_high) + a_low * b_low
    return rounded, rest


def reduced(t: Array, rate: Pair, offset: Pair, period: Pair) -> tuple[Array, Array]:
    """Return what is left of ``offset + rate t`` after whole periods, and how many were taken.

    The remainder is the least in size. ``period.high`` may be infinite: then none is taken.
    ``offset`` and ``period`` have no exponent.
    """
    time = np.ldexp(t, rate.exponent) if rate.high else np.zeros_like(t)
    high, low = exact_product(time, rate.high)
    low = low + time * rate.low
    total = high + offset.high
    added = total - high
    low = low + ((high - (total - added)) + (offset.high - added)) + offset.low
    if isinf(period.high):
        return total + low, np.zeros_like(total)
    count = np.rint(total / period.high)
    taken, rest = exact_product(count, period.high)
    return (total - taken) + ((low - rest) - count * period.low), count


def grown(t: Array, rate: Pair, offset: Pair) -> Array:
    """Return ``offset + rate t`` itself, in one double."""
    total: Array = np.ldexp(t, rate.exponent) * rate.high + offset.high
    return total


def parity(count: Array) -> Array:
    """Return 1 where a whole number is even, -1 where it is odd."""
    sign: Array = 1 - 2 * np.abs(count - 2 * np.rint(count / 2))
    return sign


Context = Any  # a mpmath context

NEGLIGIBLE = 1e-19
"""Terms of a series that are smaller beside 1 are left out over arrays."""
NEVER = -1e300
"""Logarithm of a nome that is zero: finite, and its exponential is zero beside any argument."""


GUARD = 32
"""Bits of whole numbers beyond those of their context: what a hundred operations round away."""


def _whole(m: Context, values: Sequence[Number]) -> tuple[list[int], int, int]:
    """Return numbers >= 0 as n 2^(2k - bits), ``bits`` and k: the smallest has all digits as well.

    Python's whole numbers take a tenth of the time of mpmath's real ones.
    """
    sizes = [m.mag(v) for v in values if v]
    half = max(sizes) // 2
    bits = m.prec + GUARD + max(sizes) - min(sizes)
    return [int(m.ldexp(v, bits - 2 * half)) for v in values], bits, half


def agm(a: Number, b: Number) -> Number:
    """Return the arithmetic-geometric mean of two numbers >= 0 (DLMF 19.8.1); 0 if one is zero."""
    m = a.context
    if not (a and b):
        return m.zero
    (x, y), bits, half = _whole(m, (a, b))
    close = (m.prec + GUARD) // 2
    while abs(x - y) > x >> close:
        x, y = (x + y) >> 1, isqrt(x * y)
    return m.ldexp(m.mpf(x + y), 2 * half - bits - 1)


def carlson(x: Number, y: Number, z: Number) -> Number:
    """Return Carlson's R_F(x, y, z), at most one of the arguments zero, by duplication.

    DLMF 19.26.18; the series of 19.36.1 ends it where its next term, of order 8, is negligible.
    """
    m = x.context
    (a, b, c), bits, half = _whole(m, (x, y, z))
    least = 1 << (bits - (m.prec + GUARD) // 8)
    while True:
        mean = (a + b + c) // 3
        X, Y = ((mean - a) << bits) // mean, ((mean - b) << bits) // mean
        if abs(X) < least and abs(Y) < least and abs(X + Y) < least:
            break
        roots = [isqrt(n << bits) for n in (a, b, c)]
        step = (roots[0] * roots[1] + roots[1] * roots[2] + roots[2] * roots[0]) >> bits
        a, b, c = (a + step) >> 2, (b + step) >> 2, (c + step) >> 2
    Z = -X - Y
    E2, E3 = (X * Y - Z * Z) >> bits, (X * Y * Z) >> 2 * bits
    square = E2 * E2 >> bits
    series = (1 << bits) - E2 // 10 + E3 // 14 + square // 24 - (3 * E2 * E3 >> bits) // 44
    series += (square * E3 >> bits) // 16 + (3 * E3 * E3 >> bits) // 104
    series -= (5 * square * E2 >> bits) // 208
    return m.ldexp(m.mpf((series << bits) // isqrt(mean << bits)), -bits - half)


def first_kind(sine: Number, cosine: Number, m1: Number) -> Number:
    """Return F(phi | 1 - m1) for -pi/2 <= phi <= pi/2 (DLMF 19.25.5).

    >>> import mpmath
    >>> print(mpmath.nstr(first_kind(mpmath.mpf(0.6), mpmath.mpf(0.8), mpmath.mpf(0)), 10))
    0.6931471806
    """
    m = sine.context
    return sine * carlson(cosine**2, cosine**2 + m1 * sine**2, m.one)


@dataclass(frozen=True)
class Modulus:
    """The parameter ``m``, its complement ``m1``, and the quarter periods K and K' they give."""

    m: Number
    m1: Number

    @property
    def context(self) -> Context:
        """Where its numbers live."""
        return self.m.context

    @cached_property
    def K(self) -> Number:
        """The real quarter period, infinite at m = 1 (DLMF 19.8.5)."""
        return self._quarter(self.m1)

    @cached_property
    def K1(self) -> Number:
        """The imaginary quarter period, infinite at m = 0."""
        return self._quarter(self.m)

    def _quarter(self, parameter: Number) -> Number:
        c = self.context
        return c.pi / 2 / agm(c.one, c.sqrt(parameter)) if parameter else c.inf

    @property
    def nome(self) -> Number:
        """exp(-pi K'/K)."""
        return self.context.exp(-self.context.pi * self.K1 / self.K) if self.m else self.m

    @property
    def complement(self) -> Modulus:
        """The modulus with m and m1 exchanged."""
        return Modulus(self.m1, self.m)


class Series(Protocol):
    """Theta series of one modulus and one offset eta, ready for arrays of arguments u.

    Called with u it returns sn u, cn u, dn u, and the real and imaginary part of a positive multiple
    of theta4(pi (u + i eta) / (2 K)), of the lattice 2 K, 4 i K', but for a factor exp(i c u).
    """

    @property
    def period(self) -> Pair:
        """2 K: sn and cn change their sign after it, dn and the theta function do not."""

    def __call__(self, u: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Return the five arrays, for -K <= u <= K."""


@dataclass(frozen=True)
class Prepared:
    """Series, and two constants of their theta function that rates are made of, with all digits.

    ``slope``: rate of its argument at u = 0, as it is returned. ``turn``: by how much that
    argument grows from u = -K to K, in radians.
    """

    functions: Series
    slope: Number
    turn: Number


def series(modulus: Modulus, eta: Number) -> Prepared:
    """Return the series that converges faster. ``eta``: from 0 to K'."""
    if modulus.m <= modulus.m1:
        return circular(modulus, eta)
    return hyperbolic(modulus, eta)


def powers(q: Number, excess: int) -> list[Number]:
    """Return q^(n^2 + excess n) for n = 0, 1, ... down to the precision of the context."""
    powers, least = [q.context.one], q.context.eps**2
    step, square = q ** (1 + excess), q * q  # q^(2n + 1 + excess)
    while powers[-1] > least:
        powers.append(powers[-1] * step)
        step *= square
    return powers


def _alternating(values: Sequence[Number]) -> list[Number]:
    return [-v if n % 2 else v for n, v in enumerate(values)]


def _null(powers: Sequence[Number]) -> tuple[Number, Number]:
    """Return theta3(0) and theta4(0) from q^(n^2)."""
    return 2 * sum(powers) - 1, 2 * sum(_alternating(powers)) - 1


def doubles(values: Sequence[Number]) -> tuple[float, ...]:
    """Return those that are not negligible, up to the last of them."""
    rounded = [float(v) for v in values]
    last = max((n for n, v in enumerate(rounded) if abs(v) > NEGLIGIBLE), default=0)
    return tuple(rounded[: last + 1])


@dataclass(frozen=True)
class Circular:
    """Fourier series, for m <= 1/2; coefficients of n = 0, 1, ... in each.

    ``sn``, ``cn``, ``dn``: numerators, of sin (2n+1)v, cos (2n+1)v, cos 2nv; ``below``: their common
    denominator, of cos 2nv; ``real``, ``imaginary``: of cos 2nv and sin 2nv.
    """

    period: Pair
    scale: float
    sn: tuple[float, ...]
    cn: tuple[float, ...]
    dn: tuple[float, ...]
    below: tuple[float, ...]
    real: tuple[float, ...]
    imaginary: tuple[float, ...]

    def __call__(self, u: Array) -> tuple[Array, Array, Array, Array, Array]:
        """See `Series`."""
        v = u * self.scale
        s, c = np.sin(v), np.cos(v)
        twice = 2 - 4 * s * s  # 2 cos 2v
        one, zero = np.ones_like(v), np.zeros_like(v)
        below = clenshaw(self.below, twice, one, twice / 2)
        return (
            clenshaw(self.sn, twice, s, s * (twice + 1)) / below,
            clenshaw(self.cn, twice, c, c * (twice - 1)) / below,
            clenshaw(self.dn, twice, one, twice / 2) / below,
            clenshaw(self.real, twice, one, twice / 2),
            clenshaw(self.imaginary, twice, zero, 2 * s * c),
        )


def clenshaw(a: Sequence[float], twice: Array, f0: Array, f1: Array) -> Array:
    """Return sum a_n f_n, where f_(n+1) = 2 cos(2v) f_n - f_(n-1), from the last term down."""
    if len(a) == 1:
        return a[0] * f0
    later: Array | float = 0.0
    now: Array | float = a[-1]
    for n in range(len(a) - 2, 0, -1):
        now, later = a[n] + twice * now - later, now
    return f0 * (a[0] - later) + f1 * now


def circular(modulus: Modulus, eta: Number) -> Prepared:
    """Return the series in the nome q (DLMF 20.2.1 to 20.2.4, 22.2.4 to 22.2.6).

    The offset function is theta4(v + i pi eta/(2K) | q^2): real part with cosh, imaginary with sinh.
    """
    c = modulus.context
    q, scale = modulus.nome, c.pi / 2 / modulus.K
    squares, odd = powers(q, 0), powers(q, 1)
    three, four = _null(squares)
    base, further = c.exp(2 * scale * eta) if q else c.one, len(squares) - 1
    lift, fall = (list(accumulate([b] * further, mul)) for b in (base, 1 / base))
    wave = _alternating([p * p for p in squares])[1:]
    real = [c.one, *(w * (e + f) for w, e, f in zip(wave, lift, fall, strict=True))]
    imaginary = [c.zero, *(w * (f - e) for w, e, f in zip(wave, lift, fall, strict=True))]
    double = [squares[0], *(2 * p for p in squares[1:])]
    slope = scale * sum(2 * n * b for n, b in enumerate(imaginary)) / sum(real)
    both, ratio = sum(odd), four / three
    of_sn, of_cn = three / both, four / both
    functions = Circular(
        period=pair(2 * modulus.K),
        scale=float(scale),
        sn=doubles([of_sn * p for p in _alternating(odd)]),
        cn=doubles([of_cn * p for p in odd]),
        dn=doubles([ratio * p for p in double]),
        below=doubles(_alternating(double)),
        real=doubles(real),
        imaginary=doubles(imaginary),
    )
    return Prepared(functions, slope, c.zero)


@dataclass(frozen=True)
class Hyperbolic:
    """Series in the complementary nome, for m > 1/2, divided by the greatest exponential.

    With w = ``scale`` |u| = pi |u|/(2 K'), f = exp(-w) and X = q' exp(2w) <= 1, where q' is the
    complementary nome: ``squares`` q'^(n^2) and ``gaps`` q'^(n^2 - n) (1 at n = 0) go with X^n,
    ``real`` and ``imaginary`` with X^(n/2): q'^(n^2/2) times cosine and sine of (2n+1) delta, delta =
    pi eta/(4 K'). ``factors``: of sn, cn, dn. ``log_root``: log(q')/2, finite long after q' underflows.
    """

    period: Pair
    scale: float
    log_root: float
    factors: tuple[float, float, float]
    squares: tuple[float, ...]
    gaps: tuple[float, ...]
    real: tuple[float, ...]
    imaginary: tuple[float, ...]

    def __call__(self, u: Array) -> tuple[Array, Array, Array, Array, Array]:
        """See `Series`."""
        w = np.abs(u) * self.scale
        less, f = -np.expm1(-w), np.exp(-w)
        root = np.exp(w + self.log_root)  # sqrt X
        X, E, short = root * root, f * f, less * (1 + f)  # short: 1 - E
        above, below = _odd(self.squares, X, E, short)
        minus, plus = _even(self.gaps, X, E)
        imaginary, real = _phase(self.real, self.imaginary, root, f, less)
        sign, (a, b, c) = np.where(u < 0, -1.0, 1.0), self.factors
        return (
            sign * (a * above / below),
            b * f * minus / below,
            c * f * plus / below,
            real,
            sign * imaginary,
        )


def steps(f: Array, less: Array) -> Iterator[tuple[Array, Array]]:
    """Yield f^(2n+1) and 1 - f^(2n+1) for n = 0, 1, ...; ``less`` is 1 - f."""
    square, rest = f * f, less * (1 + f)
    while True:
        yield f, less
        less = less + f * rest
        f = f * square


def _odd(squares: Sequence[float], X: Array, E: Array, short: Array) -> tuple[Array, Array]:
    """Return the sums of (-1)^n q^(n^2) X^n (1 - E^(2n+1)) and of q^(n^2) X^n (1 + E^(2n+1))."""
    above, below, power = short, 1 + E, np.ones_like(X)
    for n, (a, (E_n, less)) in enumerate(zip(squares, steps(E, short), strict=False)):
        if n:
            power = power * X
            above = above + (-1) ** n * a * power * less
            below = below + a * power * (1 + E_n)
    return above, below


def _even(gaps: Sequence[float], X: Array, E: Array) -> tuple[Array, Array]:
    """Return 1 + sum of (-1)^n q^(n^2-n) X^n (1 + E^(2n)), and the same without signs."""
    minus, plus, power, E_n = np.ones_like(X), np.ones_like(X), np.ones_like(X), np.ones_like(X)
    square = E * E
    for n, a in enumerate(gaps[1:], 1):
        power, E_n = power * X, E_n * square
        term = a * power * (1 + E_n)
        minus, plus = minus + (-1) ** n * term, plus + term
    return minus, plus


def _phase(
    cosines: Sequence[float], sines: Sequence[float], root: Array, f: Array, less: Array
) -> tuple[Array, Array]:
    """Return imaginary and real part of theta2 over exp(w/2), divided by its nome's leading power."""
    real, imaginary, power = cosines[0] * (1 + f), sines[0] * less, np.ones_like(f)
    for n, (c, s, (f_n, less_n)) in enumerate(zip(cosines, sines, steps(f, less), strict=False)):
        if n:
            power = power * root
            real = real + c * power * (1 + f_n)
            imaginary = imaginary + s * power * less_n
    return imaginary, real


def hyperbolic(modulus: Modulus, eta: Number) -> Prepared:
    """Return the series in the complementary nome (DLMF 20.7.30 to 20.7.33, 22.6 (iv)).

    theta4(v + i e | tau) is a multiple of exp(i c v) theta2(delta - i w/2 | -1/tau), tau = 2 i K'/K.
    """
    c = modulus.context
    other = modulus.complement
    q, delta = other.nome, c.pi * eta / 4 / modulus.K1
    squares, odd, roots = powers(q, 0), powers(q, 1), powers(c.sqrt(q), 0)
    three, four = _null(squares)
    # X^n q^(n^2 - n) at X = 1; theta2 likewise, where its own nome is the root of q
    gaps = [q ** (n * n - n) if n > 1 else c.one for n in range(len(squares))]
    angles = [(2 * n + 1) * delta for n in range(len(roots))]
    real = [r * c.cos(a) for r, a in zip(roots, angles, strict=True)]
    imaginary = [r * c.sin(a) for r, a in zip(roots, angles, strict=True)]
    fade = [c.sqrt(q) ** n for n in range(len(roots))]
    scale = c.pi / 2 / modulus.K1
    rate = sum((2 * n + 1) * b * x for n, (b, x) in enumerate(zip(imaginary, fade, strict=True)))
    length, both = len(doubles(roots)), 2 * sum(odd)
    slope = scale / 2 * rate / sum(a * x for a, x in zip(real, fade, strict=True))
    functions = Hyperbolic(
        period=pair(2 * modulus.K) if modulus.m1 else Pair(np.inf, 0.0),
        scale=float(scale),
        log_root=float(c.log(q) / 2) if q else NEVER,
        factors=(float(three / four), float(both / four), float(both / three)),
        squares=doubles(squares),
        gaps=doubles(gaps),
        real=tuple(map(float, real[:length])),
        imaginary=tuple(map(float, imaginary[:length])),
    )
    return Prepared(functions, slope, 2 * delta)
