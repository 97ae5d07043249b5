"""Exact polynomials over sines, cosines and symbols, in a normal form: equal ones have equal terms.

A generator is a SymPy expression: a symbol, the sine or cosine of one angle, a function that nothing is
known of. Of the sine and cosine of an angle one is kept, and the square of the other is 1 less the
square of the kept; the square of the scalar part of a unit quaternion is 1 less those of the others. Kept
generators may have negative powers. The operators are those that `eom.multibody.algebra.scalars` asks for;
zero and other constants are plain numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.fields import Operators, sum_of_angles
from eom.multibody.algebra.values import value

Expr = Any
Number = int | Fraction
Monomial = tuple[tuple[int, int], ...]
"""(generator, power) in the order of the generators; no power is zero."""
Terms = dict[Monomial, Number]
Scalar = Any
"""A `Polynomial` or an exact number."""

LIMIT = 150_000
"""Products of terms after which a closed form is given up."""


class Algebra:
    """The generators that occur, in the order of their first use, and what their squares are.

    ``names``: symbols in place of others, wherever these occur. Raises `InputError` when `LIMIT` products
    of terms have been formed.
    """

    def __init__(self, where: str = "", names: Mapping[Expr, Expr] | None = None) -> None:
        self.where, self.names = where, dict(names or {})
        self.generators: list[Expr] = []
        self.spent = 0
        self._index: dict[Expr, int] = {}
        self._squares: dict[int, Terms] = {}
        self._sines: dict[Expr, bool] = {}
        self._gradients: dict[tuple[int, Expr], Scalar] = {}

    def index(self, generator: Expr) -> int:
        """Return the number of a generator."""
        generator = self.named(generator)
        known = self._index.get(generator)
        if known is None:
            known = self._index[generator] = len(self.generators)
            self.generators.append(generator)
        return known

    def named(self, e: Expr) -> Expr:
        """Return an expression with the names that were chosen."""
        return e.xreplace(self.names) if self.names else e

    def atom(self, generator: Expr) -> Polynomial:
        """Return a generator as a polynomial."""
        return Polynomial(self, {((self.index(generator), 1),): 1})

    def angle(self, base: Expr, *, keep_sine: bool = False) -> tuple[Polynomial, Polynomial]:
        """Return sine and cosine of one angle; the first call decides which of them is kept."""
        base = self.named(base)
        sine, cosine = sp.sin(base), sp.cos(base)
        pair = self.index(sine), self.index(cosine)
        if base not in self._sines:
            self._sines[base] = keep_sine
            left, kept = pair[::-1] if keep_sine else pair
            self._squares[left] = _less({kept})
        return self.atom(sine), self.atom(cosine)

    def sphere(self, parts: Iterable[Expr]) -> None:
        """Let the squares of these generators add to one."""
        first, *others = (self.index(p) for p in parts)
        self._squares[first] = _less(others)

    # -- SymPy expressions -------------------------------------------------------------------

    def lift(self, given: Any) -> Scalar:
        """Return a number or a SymPy expression as a scalar; what is no polynomial is a generator."""
        exact = value(given, self.where)
        if isinstance(exact, int | Fraction):
            return exact
        return self._lifted(exact)

    def _lifted(self, e: Expr) -> Scalar:
        if e.is_Rational:
            return value(e, self.where)
        if e.is_Add or e.is_Mul:
            result: Scalar = int(e.is_Mul)
            for part in map(self._lifted, e.args):
                result = result + part if e.is_Add else result * part
            return result
        if e.is_Pow and e.exp.is_Integer:
            return self._power(e)
        if isinstance(e, sp.sin | sp.cos):
            return self.turned(self.lift(e.args[0]))[int(isinstance(e, sp.cos))]
        if e.is_Float:
            return value(e, self.where)
        return self._root(e) if e.is_Pow and e.is_number else self.atom(e)

    def _root(self, e: Expr) -> Scalar:
        """Return a number that is a power; the square of a square root is known."""
        if e.exp == sp.Rational(1, 2) and e.base.is_Rational and e.base > 0:
            self._squares[self.index(e)] = {(): value(e.base, self.where)}
        return self.atom(e)

    def _power(self, e: Expr) -> Scalar:
        base, count = self._lifted(e.base), int(e.exp)
        if count < 0:
            return self.inverse(base, e.base) ** -count
        return base**count

    def squared(self, x: Scalar) -> Scalar | None:
        """Return what a scalar is the square of, of either sign: a product, a sine or a cosine; or None."""
        products = [Polynomial(self, {m: 1}) for m in terms_of(x) if m]
        halves = [h for h in map(_half, products) if h is not None]
        for g in [g for h in halves for g, _ in next(iter(h.terms))]:
            angle = (
                self.generators[g].args[0]
                if isinstance(self.generators[g], sp.sin | sp.cos)
                else None
            )
            halves += [] if angle is None else list(self.angle(angle))
        ways = (h for h in halves if not isinstance(x - h * h, Polynomial) and x - h * h == 0)
        return next(ways, None)

    def replaced(self, x: Scalar, known: Mapping[int, Scalar]) -> Scalar:
        """Return a scalar with scalars in place of generators."""
        if not isinstance(x, Polynomial) or known.keys().isdisjoint(x.used):
            return x
        result: Scalar = 0
        for rest, coefficient in x.by(lambda g: g in known).items():
            product = coefficient
            for g, power in rest:
                product = product * (known[g] ** power if power > 0 else 1 / known[g] ** -power)
            result = result + product
        return result

    def inverse(self, base: Scalar, written: Expr) -> Scalar:
        """Return 1/x; ``written``: how a sum stands in a generator of its own."""
        if not isinstance(base, Polynomial):
            return Fraction(1) / base
        single = base.inverse()
        return self.atom(1 / written) if single is None else single

    def turned(self, angle: Scalar) -> tuple[Scalar, Scalar]:
        """Return sine and cosine of an angle, by addition theorems where it is a sum."""
        turns = ((*self.angle(base)[::-1], count) for base, count in self._angles(angle))
        cosine, sine = sum_of_angles(turns)
        return sine, cosine

    def _angles(self, angle: Scalar) -> list[tuple[Expr, int]]:
        """Return an angle as whole multiples of expressions."""
        found: list[tuple[Expr, int]] = []
        for monomial, number in terms_of(angle).items():
            whole = isinstance(number, int) and monomial and abs(number) <= 64
            count = number if whole else 1
            rest = {monomial: 1 if whole else number}
            base = self.expression(Polynomial(self, rest))
            if base.could_extract_minus_sign():
                base, count = -base, -count
            found.append((base, int(count)))
        return found

    def expression(self, x: Scalar) -> Expr:
        """Return a scalar as a SymPy expression, expanded."""
        return sp.Add(
            *(
                sp.Mul(_rational(n), *(self.generators[g] ** p for g, p in monomial))
                for monomial, n in terms_of(x).items()
            )
        )

    # -- calculus ----------------------------------------------------------------------------

    def along(self, x: Scalar, rates: Mapping[Expr, Scalar]) -> Scalar:
        """Return the derivative of ``x`` if symbols change at ``rates``: the sum of dx/ds times rate."""
        result: Scalar = 0
        for g in x.used if isinstance(x, Polynomial) else ():
            change: Scalar = 0
            for symbol in self.generators[g].free_symbols & rates.keys():
                change = change + self._gradient(g, symbol) * rates[symbol]
            result = result + x.partial(g) * change
        return result

    def _gradient(self, g: int, symbol: Expr) -> Scalar:
        key = (g, symbol)
        if key not in self._gradients:
            self._gradients[key] = self.lift(sp.diff(self.generators[g], symbol))
        return self._gradients[key]

    # -- normal form -------------------------------------------------------------------------

    def scalar(self, terms: Terms) -> Scalar:
        """Return terms in normal form, as a number if there is nothing else."""
        kept = {m: n for m, n in terms.items() if n}
        waiting = [m for m in kept if self._high(m) is not None]
        while waiting:
            monomial = waiting.pop()
            number = kept.pop(monomial, 0)
            for m, n in self._replaced(monomial, number).items() if number else ():
                total = kept.get(m, 0) + n
                if total:
                    kept[m] = total
                    if self._high(m) is not None:
                        waiting.append(m)
                else:
                    kept.pop(m, None)
        if not kept:
            return 0
        if len(kept) == 1 and () in kept:
            number = Fraction(kept[()])
            return number.numerator if number.denominator == 1 else number
        return Polynomial(self, kept)

    def _high(self, monomial: Monomial) -> int | None:
        """Return a generator whose square is to be replaced."""
        return next((g for g, p in monomial if p >= 2 and g in self._squares), None)

    def _replaced(self, monomial: Monomial, number: Number) -> Terms:
        high = self._high(monomial)
        assert high is not None
        rest = tuple((g, p - 2 * (g == high)) for g, p in monomial if (g, p) != (high, 2))
        self.spend(len(self._squares[high]))
        return {joined(rest, m): number * n for m, n in self._squares[high].items()}

    def spend(self, count: int) -> None:
        """Count products of terms."""
        self.spent += count
        if self.spent > LIMIT:
            raise InputError(
                "the closed form is too large to be read",
                where=self.where,
                got=f"more than {LIMIT} products of terms",
                expected="a small system",
                hint="derive(tree) names intermediates and has no such limit",
            )


class Polynomial(Operators):
    """A sum of monomials that is no number. Made by an `Algebra`."""

    __slots__ = ("algebra", "terms")

    def __init__(self, algebra: Algebra, terms: Terms) -> None:
        self.algebra, self.terms = algebra, terms

    def __repr__(self) -> str:
        return str(self.algebra.expression(self))

    def operated(self, op: str, *operands: Scalar) -> Scalar:
        """Return the result of an operation, in normal form."""
        return _OPERATIONS[op](*operands)

    def __pow__(self, count: int) -> Scalar:
        result: Scalar = 1
        for _ in range(count):
            result = self * result
        return result

    def inverse(self) -> Scalar | None:
        """Return 1/x of a single term over kept generators, else None."""
        if len(self.terms) > 1:
            return None
        ((monomial, number),) = self.terms.items()
        if any(g in self.algebra._squares for g, _ in monomial):
            return None
        return Polynomial(self.algebra, {tuple((g, -p) for g, p in monomial): Fraction(1) / number})

    @property
    def used(self) -> list[int]:
        """The generators that occur."""
        return sorted({g for m in self.terms for g, _ in m})

    def partial(self, g: int) -> Scalar:
        """Return the derivative by one generator, the others held fixed."""
        terms: Terms = {}
        for m, n in self.terms.items():
            power = dict(m).get(g, 0)
            if power:
                terms[joined(m, ((g, -1),))] = n * power
        return self.algebra.scalar(terms)

    def by(self, wanted: Callable[[int], bool]) -> dict[Monomial, Scalar]:
        """Return the coefficients of the monomials in the wanted generators."""
        found: dict[Monomial, Terms] = {}
        for m, n in self.terms.items():
            key = tuple(x for x in m if wanted(x[0]))
            found.setdefault(key, {})[tuple(x for x in m if not wanted(x[0]))] = n
        return {m: self.algebra.scalar(terms) for m, terms in found.items()}


def _half(x: Polynomial) -> Polynomial | None:
    """Return a single product with half its powers, without its number; None where one is odd."""
    ((monomial, _),) = x.terms.items()
    if any(p % 2 for _, p in monomial):
        return None
    return Polynomial(x.algebra, {tuple((g, p // 2) for g, p in monomial): 1})


def _added(x: Scalar, y: Scalar) -> Scalar:
    terms = dict(terms_of(x))
    for m, n in terms_of(y).items():
        terms[m] = terms.get(m, 0) + n
    return x.algebra.scalar(terms)


def _multiplied(x: Polynomial, y: Scalar) -> Scalar:
    right = terms_of(y)
    x.algebra.spend(len(x.terms) * len(right))
    terms: Terms = {}
    for m, a in x.terms.items():
        for n, b in right.items():
            key = joined(m, n)
            terms[key] = terms.get(key, 0) + a * b
    return x.algebra.scalar(terms)


def _divided(x: Scalar, y: Scalar) -> Scalar:
    algebra = (x if isinstance(x, Polynomial) else y).algebra
    return x * algebra.inverse(y, algebra.expression(y))


_OPERATIONS: dict[str, Callable[..., Scalar]] = {
    "add": _added,
    "sub": lambda x, y: x + -y if isinstance(x, Polynomial) else -y + x,
    "mul": _multiplied,
    "div": _divided,
    "neg": lambda x: Polynomial(x.algebra, {m: -n for m, n in x.terms.items()}),
}


def _less(generators: Iterable[int]) -> Terms:
    """Return one less the squares of generators."""
    found: Terms = {(): 1}
    for g in generators:
        found[((g, 2),)] = -1
    return found


def terms_of(x: Scalar) -> Terms:
    """Return the terms of a polynomial or number."""
    if isinstance(x, Polynomial):
        return x.terms
    return {(): x} if x else {}


def joined(m: Monomial, n: Monomial) -> Monomial:
    """Return the product of two monomials."""
    if not m or not n:
        return m or n
    powers = dict(m)
    for g, p in n:
        powers[g] = powers.get(g, 0) + p
    return tuple(sorted((g, p) for g, p in powers.items() if p))


def _rational(n: Number) -> Expr:
    return sp.Rational(n.numerator, n.denominator)
