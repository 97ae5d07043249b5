"""Quotients of theta functions whose squares are linear in sn^2: complex functions of a real argument.

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

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from codegen.closed.elliptic import NEVER, Modulus, clenshaw, doubles, powers, steps
from codegen.closed.phases import Pair, pair

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
