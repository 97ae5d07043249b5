"""Polynomials as formulas that can be read: sums of angles, shared factors; bounded, and verified.

A polynomial in sines and cosines is written in several ways (as it is, with other squares replaced, over
sums of angles, as a Fourier sum) and the shortest is taken; then coefficients of equal functions are
gathered and shared factors taken out. That the result equals the polynomial is tested by
`eom.exact.identity`, which knows nothing of these ways.

The parts of an equation of motion by kind, and which factor each goes with.

On the left: inertial terms (entries of the mass matrix times accelerations), centrifugal (u_i^2) and
Coriolis (u_i u_j); see Craig, Introduction to Robotics (2005), sec. 6.8. Gyroscopic: of the terms that
are linear in the free speeds and stem from prescribed ones, the skew-symmetric part of their matrix,
which does no work; so Jeans, Astronomy and Cosmogony (1928). What else prescribed motion
brings is of a kind of its own. Then gravity, springs and dampers; applied forces on the right.

What a method finds: parts of the equations, each with where it comes from.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any, NamedTuple

import sympy as sp

from eom.derivations.verification import DerivationError
from eom.exact.identity import equal
from eom.multibody.algebra.scalars import is_zero
from eom.multibody.closed.mechanism import Mechanism
from eom.multibody.closed.polynomials import (
    Algebra,
    Monomial,
    Number,
    Polynomial,
    Scalar,
    Terms,
    terms_of,
)

Expr = Any
HALF = Fraction(1, 2)


class Kind(NamedTuple):
    """A kind of term: heading, and whether it stands on the left."""

    title: str
    left: bool = True


KINDS: dict[str, Kind] = {
    "inertial": Kind("Inertial"),
    "centrifugal": Kind("Centrifugal"),
    "coriolis": Kind("Coriolis"),
    "gyroscopic": Kind("Gyroscopic"),
    "prescribed": Kind("Prescribed motion"),
    "gravity": Kind("Gravity"),
    "spring": Kind("Springs"),
    "damper": Kind("Dampers"),
    "applied": Kind("Applied", left=False),
}
"""The kinds in the order in which they are shown."""


class Key(NamedTuple):
    """Which term: equation, kind, and the product of speeds or the acceleration that it goes with."""

    row: int
    kind: str
    factor: Monomial


@dataclass(frozen=True)
class Part:
    """A term of an equation as a method finds it: its coefficient, and what each step gives to it."""

    key: Key
    coefficient: Scalar
    origins: tuple[tuple[str, Scalar], ...]


def parts(mechanism: Mechanism, found: Iterable[Contribution]) -> dict[Key, Part]:
    """Return the terms of the equations, those of each row in the order of `KINDS`; zeros left out."""
    sorter = _Sorter(mechanism)
    for contribution in found:
        sorter.add(contribution)
    sorter.divide()
    made = {}
    for key in sorted(sorter.found, key=lambda k: _order(mechanism, k)):
        origins = {label: x for label, x in sorter.found[key].items() if not is_zero(x)}
        total: Scalar = 0
        for x in origins.values():
            total = total + x
        if not is_zero(total):
            made[key] = Part(key, total, tuple(origins.items()))
    return made


def factor(mechanism: Mechanism, monomial: Monomial) -> Expr:
    """Return the product that a coefficient goes with, as an expression."""
    return sp.Mul(*(mechanism.algebra.generators[g] ** p for g, p in monomial))


def _order(mechanism: Mechanism, key: Key) -> tuple[Any, ...]:
    numbers = {g: k for k, g in enumerate(_moving(mechanism))}
    kinds = list(KINDS)
    return key.row, kinds.index(key.kind), [(numbers[g], -p) for g, p in _sorted(numbers, key)]


def _sorted(numbers: dict[int, int], key: Key) -> list[tuple[int, int]]:
    return sorted(key.factor, key=lambda x: numbers[x[0]])


def _moving(mechanism: Mechanism) -> list[int]:
    """Return the generators that are accelerations and speeds."""
    index = mechanism.algebra.index
    names = [*mechanism.accelerations, *(u.symbol for u in mechanism.speeds)]
    return [index(s) for s in names]


class _Sorter:
    """Puts contributions where they belong."""

    def __init__(self, mechanism: Mechanism) -> None:
        index = mechanism.algebra.index
        speeds = [index(u.symbol) for u in mechanism.speeds]
        rates = [index(a) for a in mechanism.accelerations]
        self.free = {speeds[k] for k in mechanism.free}
        self.forced = {speeds[k] for k in mechanism.forced}
        self.free_rates = {rates[k] for k in mechanism.free}
        self.forced_rates = {rates[k] for k in mechanism.forced}
        self.rows = {speeds[k]: row for row, k in enumerate(mechanism.free)}
        self.mechanism = mechanism
        self.found: dict[Key, dict[str, Scalar]] = {}
        self.linear: dict[str, dict[tuple[int, int], Scalar]] = {}

    def add(self, c: Contribution) -> None:
        """Add a contribution."""
        if c.source == "motion":
            self._motion(c)
        elif c.source == "damper":
            for m, x in _by(c.value, self.free | self.forced).items():
                self._put(Key(c.row, c.source, m), c.label, x)
        else:
            self._put(Key(c.row, c.source, ()), c.label, c.value)

    def _put(self, key: Key, label: str, x: Scalar) -> None:
        labelled = self.found.setdefault(key, {})
        labelled[label] = labelled.get(label, 0) + x

    def _motion(self, c: Contribution) -> None:
        moving = self.free | self.forced | self.free_rates | self.forced_rates
        for m, x in _by(c.value, moving).items():
            kind = self._kind(m)
            if kind == "linear":
                self._linear(c, m, x)
            else:
                self._put(Key(c.row, kind, m), c.label, x)

    def _kind(self, m: Monomial) -> str:
        used = {g for g, _ in m}
        if used & self.free_rates:
            return "inertial"
        if used & (self.forced | self.forced_rates):
            count = sum(p for g, p in m if g in self.free)
            return "linear" if count == 1 else "prescribed"
        return "centrifugal" if len(used) == 1 else "coriolis"

    def _linear(self, c: Contribution, m: Monomial, x: Scalar) -> None:
        """Keep an entry of the matrix of terms that are linear in the free speeds."""
        (speed,) = (g for g, _ in m if g in self.free)
        rest = tuple(p for p in m if p[0] != speed)
        matrix = self.linear.setdefault(c.label, {})
        value = x * Polynomial(self.mechanism.algebra, {rest: 1})
        key = (c.row, speed)
        matrix[key] = matrix.get(key, 0) + value

    def divide(self) -> None:
        """Divide the matrices of linear terms into skew-symmetric and symmetric parts."""
        for label, matrix in self.linear.items():
            for row, own in ((r, g) for r in self.rows.values() for g in self.rows):
                mine = matrix.get((row, own), 0)
                mirrored = matrix.get((self.rows[own], self._speed(row)), 0)
                for kind, x in (
                    ("gyroscopic", mine - mirrored),
                    ("prescribed", mine + mirrored),
                ):
                    if not is_zero(x):
                        self._put(Key(row, kind, ((own, 1),)), label, x * HALF)
        self.linear = {}

    def _speed(self, row: int) -> int:
        return next(g for g, r in self.rows.items() if r == row)


def _by(x: Scalar, wanted: set[int]) -> dict[Monomial, Scalar]:
    if not isinstance(x, Polynomial):
        return {} if is_zero(x) else {(): x}
    return x.by(lambda g: g in wanted)


@dataclass(frozen=True)
class Contribution:
    """A part of one equation.

    ``row``: number of the equation. ``source``: motion (mass times acceleration), gravity, spring,
    damper, which stand on the left, or applied, on the right. ``label``: the step that it comes from.
    """

    row: int
    source: str
    label: str
    value: Scalar


Sum = list[tuple[Number, Expr]]
"""A sum of rational numbers times products of sines and cosines."""

MOST_TERMS, MOST_POWER, MOST_SQUARES = 60, 8, 3
"""Beyond these a polynomial in sines and cosines is left as it is."""


class Writer:
    """Writes polynomials of one algebra; ``runs``: angles about parallel axes, from the ground out."""

    def __init__(self, algebra: Algebra, runs: tuple[tuple[Expr, ...], ...] = ()) -> None:
        self.algebra, self.runs = algebra, runs
        self._known: dict[Any, Expr] = {}
        self._ways: dict[Any, Sum] = {}

    def __call__(self, x: Scalar) -> Expr:
        """Return a scalar as a formula. Raises `DerivationError` if the two were not equal."""
        key = frozenset(terms_of(x).items())
        if key not in self._known:
            self._known[key] = self._written(x)
        return self._known[key]

    def _written(self, x: Scalar) -> Expr:
        written = sp.Add(*self._terms(x))
        if not equal(written, self.algebra.expression(x)):
            raise DerivationError("a rearranged formula has another value", got=written)
        return written

    def _terms(self, x: Scalar) -> list[Expr]:
        """Return the terms of a formula: products of sines and cosines with their coefficients."""
        gathered: dict[Expr, Terms] = {}
        for rest, trigonometric in self._split(x).items():
            for number, function in self.shortest(trigonometric):
                terms = gathered.setdefault(function, {})
                terms[rest] = terms.get(rest, 0) + number
        kept = {f: {m: n for m, n in terms.items() if n} for f, terms in gathered.items()}
        return [sp.Mul(*_factors(self.algebra, t), f) for f, t in kept.items() if t]

    def _split(self, x: Scalar) -> dict[Monomial, Terms]:
        """Return the trigonometric factor of every product of other generators."""
        found: dict[Monomial, Terms] = {}
        for m, n in terms_of(x).items():
            rest = tuple(p for p in m if not self._is_function(p[0]))
            found.setdefault(rest, {})[tuple(p for p in m if self._is_function(p[0]))] = n
        return found

    def _is_function(self, g: int) -> bool:
        return isinstance(self.algebra.generators[g], sp.sin | sp.cos)

    # -- sines and cosines ---------------------------------------------------------------------

    def shortest(self, terms: Terms) -> Sum:
        """Return the shortest way to write a polynomial in sines and cosines, the first of equal ones."""
        shared = content(list(terms.values()))
        terms = {m: n / shared for m, n in terms.items()}
        key = frozenset(terms.items())
        if key not in self._ways:
            self._ways[key] = self._shortest(terms)
        return [(shared * n, f) for n, f in self._ways[key]]

    def _shortest(self, terms: Terms) -> Sum:
        ways = [_plain(self.algebra, terms)]
        simple = not any(m for m in terms) or len(terms) > MOST_TERMS
        if not simple and all(p > 0 for m in terms for _, p in m):
            ways += [_plain(a, t) for a, t in self._rewritten(terms)]
            ways += [w for w in (fourier(self.algebra, terms),) if w is not None]
        return min(ways, key=_length)

    def _rewritten(self, terms: Terms) -> Iterator[tuple[Algebra, Terms]]:
        """Yield a polynomial over other angles, and with the squares of others replaced."""
        used = {self.algebra.generators[g].args[0] for m in terms for g, _ in m}
        for angles in _bases(used, self.runs):
            free = sorted({b for sums in angles.values() for b, _ in sums}, key=str)
            squared = free if len(free) <= MOST_SQUARES else []
            for kept in product((False, True), repeat=len(squared)):
                algebra = Algebra(self.algebra.where)
                for base, sine in zip(squared, kept, strict=True):
                    algebra.angle(base, keep_sine=sine)
                yield algebra, terms_of(self._over(algebra, terms, angles))

    def _over(
        self, algebra: Algebra, terms: Terms, angles: dict[Expr, list[tuple[Expr, int]]]
    ) -> Scalar:
        known: dict[int, Scalar] = {}
        total: Scalar = 0
        for m, n in terms.items():
            factor: Scalar = n
            for g, p in m:
                if g not in known:
                    function = self.algebra.generators[g]
                    pair = _turned(algebra, angles[function.args[0]])
                    known[g] = pair[int(isinstance(function, sp.cos))]
                for _ in range(p):
                    factor = factor * known[g]
            total = total + factor
        return total


def by_motion(mechanism: Mechanism, write: Callable[[Scalar], Expr]) -> Callable[[Scalar], Expr]:
    """Return what writes a scalar by the products of speeds and accelerations in it."""
    moving = set(_moving(mechanism))
    generators = mechanism.algebra.generators

    def product_of(m: Monomial, x: Scalar) -> Expr:
        """Return a product of speeds with its coefficient, the number in it kept in front."""
        number = content(list(terms_of(x).values()))
        front = sp.Rational(number.numerator, number.denominator)
        return sp.Mul(front, write(x * (1 / number)), *(generators[g] ** p for g, p in m))

    def written(x: Scalar) -> Expr:
        if not isinstance(x, Polynomial):
            return write(x)
        return sp.Add(*(product_of(m, c) for m, c in x.by(lambda g: g in moving).items()))

    return written


def _plain(algebra: Algebra, terms: Terms) -> Sum:
    return [(n, sp.Mul(*(algebra.generators[g] ** p for g, p in m))) for m, n in terms.items()]


def _length(way: Sum) -> tuple[int, int]:
    operations = sum(int(sp.count_ops(f)) + (n not in {1, -1}) for n, f in way)
    return len(way), operations


def _turned(algebra: Algebra, angles: list[tuple[Expr, int]]) -> tuple[Scalar, Scalar]:
    """Return sine and cosine of a sum of angles, each of which is one of the algebra."""
    s, c = 0, 1
    for base, sign in angles:
        sine, cosine = algebra.angle(base)
        sine = sine if sign > 0 else -sine
        s, c = s * cosine + c * sine, c * cosine - s * sine
    return s, c


def _bases(
    used: set[Expr], runs: Iterable[Sequence[Expr]]
) -> Iterator[dict[Expr, list[tuple[Expr, int]]]]:
    """Yield angles over other angles: themselves, and sums along a run from each of its angles on."""
    same = {a: [(a, 1)] for a in used}
    yield same
    for run in runs:
        for start in range(len(run) - 1):
            if not used & set(run[start + 1 :]):
                continue
            found, total = dict(same), run[start]
            for angle in run[start + 1 :]:
                before, total = total, total + angle
                found[angle] = [(total, 1), (before, -1)]
            yield {a: sums for a, sums in found.items() if a in used}


def fourier(algebra: Algebra, terms: Terms) -> Sum | None:
    """Return a polynomial in sines and cosines as a sum of them; None if its degree is too high.

    >>> a = Algebra()
    >>> x, y = sp.symbols("x y")
    >>> s, c = a.turned(a.lift(x + y))
    >>> [(str(number), wave) for number, wave in fourier(a, c.terms)]
    [('1', cos(x + y))]
    """
    if any(sum(p for _, p in m) > MOST_POWER for m in terms):
        return None
    angles = list(dict.fromkeys(algebra.generators[g].args[0] for m in terms for g, _ in m))
    waves: dict[tuple[int, ...], list[Fraction]] = {}
    for m, n in terms.items():
        for key, (real, imaginary) in _waves(algebra, angles, m).items():
            entry = waves.setdefault(key, [Fraction(0), Fraction(0)])
            entry[0] += real * n
            entry[1] += imaginary * n
    return list(_real(angles, waves))


def _waves(
    algebra: Algebra, angles: Sequence[Expr], monomial: Monomial
) -> dict[tuple[int, ...], tuple[Fraction, Fraction]]:
    """Return a product over exp(i k . angles): complex coefficients by k."""
    half = Fraction(1, 2)
    found = {(0,) * len(angles): (Fraction(1), Fraction(0))}
    for g, power in monomial:
        function = algebra.generators[g]
        place = angles.index(function.args[0])
        is_cosine = isinstance(function, sp.cos)
        for _ in range(power):
            after: dict[tuple[int, ...], tuple[Fraction, Fraction]] = {}
            for key, (a, b) in found.items():
                for step in (1, -1):
                    near = (*key[:place], key[place] + step, *key[place + 1 :])
                    a1, b1 = (a, b) if is_cosine else (step * b, -step * a)
                    x, y = after.get(near, (Fraction(0), Fraction(0)))
                    after[near] = (x + half * a1, y + half * b1)
            found = after
    return found


def _real(angles: Sequence[Expr], waves: dict[tuple[int, ...], list[Fraction]]) -> Iterator[Any]:
    """Yield cosines and sines of pairs of opposite waves."""
    for key, (real, imaginary) in waves.items():
        first = next((k for k in key if k), 0)
        angle = sp.Add(*(k * a for k, a in zip(key, angles, strict=True)))
        if first == 0 and real:
            yield real, sp.S.One
        if first > 0:
            for number, function in ((2 * real, sp.cos(angle)), (-2 * imaginary, sp.sin(angle))):
                if number:
                    sign, bare = function.as_coeff_Mul()
                    yield number * int(sign), bare


# -- shared factors ----------------------------------------------------------------------------


def _factors(algebra: Algebra, terms: Terms) -> list[Expr]:
    """Return the factors of a sum: what all its terms share, then the rest, in it what several share."""
    outer = _common(list(terms))
    inner = {_divided(m, outer): n for m, n in terms.items()}
    shared = content(list(inner.values()))
    inner = {m: n / shared for m, n in inner.items()}
    groups: list[Expr] = []
    while inner:
        best = _best(list(inner))
        if best is None:
            groups += [_product(algebra, m, n) for m, n in inner.items()]
            break
        mine = {m: n for m, n in inner.items() if _contains(m, best)}
        groups.append(sp.Mul(*_factors(algebra, mine)))
        inner = {m: n for m, n in inner.items() if m not in mine}
    return [_product(algebra, outer, shared), sp.Add(*groups)]


def _best(monomials: list[Monomial]) -> Monomial | None:
    """Return the power of a generator that saves most factors if taken out; None if none does."""
    counts: dict[tuple[int, int], int] = {}
    for m in monomials:
        for power in m:
            counts[power] = counts.get(power, 0) + 1
    savings = {k: (n - 1) * abs(k[1]) for k, n in counts.items() if n > 1}
    if not savings or len(monomials) < 2:
        return None
    best = max(savings, key=lambda k: (savings[k], -k[0]))
    return (best,)


def _contains(m: Monomial, part: Monomial) -> bool:
    return all(p in m for p in part)


def _common(monomials: list[Monomial]) -> Monomial:
    shared = dict(monomials[0])
    for m in monomials[1:]:
        powers = dict(m)
        shared = {
            g: min(p, powers[g]) if p > 0 else max(p, powers[g])
            for g, p in shared.items()
            if g in powers and (powers[g] > 0) == (p > 0)
        }
    return tuple(shared.items())


def _divided(m: Monomial, by: Monomial) -> Monomial:
    powers = dict(m)
    for g, p in by:
        powers[g] -= p
    return tuple((g, p) for g, p in powers.items() if p)


def content(numbers: list[Number]) -> Fraction:
    """Return what coefficients share, negative if most of them are."""
    found = Fraction(0)
    for n in numbers:
        found = _gcd(found, abs(Fraction(n)))
    minus = sum(n < 0 for n in numbers)
    return -found if 2 * minus > len(numbers) else found


def _gcd(a: Fraction, b: Fraction) -> Fraction:
    while b:
        a, b = b, a % b
    return a


def _product(algebra: Algebra, m: Monomial, n: Number) -> Expr:
    return sp.Mul(
        sp.Rational(n.numerator, n.denominator), *(algebra.generators[g] ** p for g, p in m)
    )
