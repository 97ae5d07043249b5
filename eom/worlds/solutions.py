"""Solutions of a system near a random point, as power series in time modulo a prime.

States, parameters, inputs and what is derived from them become truncated series whose coefficients are
exact; a time derivative is one of series, so that statements with rates of any order are decided without
forming them symbolically. Sines and cosines of sums of angles with integer or half-integer factors come
from tangents drawn at random; roots are those of the field, and parameters are squares, so that the root
of the square of a parameter is the parameter. Other functions get a random value and the right derivative.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact import series
from eom.exact.series import PRIME, Field, Series, Singular
from eom.system import Expr, System

FIELD = Field(PRIME)
ROOT = (PRIME + 1) // 4
"""x**ROOT is the root of a square x that is itself a square: the prime is 3 modulo 4."""
MAX_POWER = 64
ENDLESS = 10**9


class Inconsistent(Exception):
    """Restrictions that no solution of the system keeps."""


class rate(sp.Function):  # type: ignore[misc] # noqa: N801 - named as it is printed
    """The time derivative of its argument along the motion."""

    nargs = 1

    def _sympystr(self, printer: Any) -> str:
        inside = printer._print(self.args[0])
        return f"{inside}'" if self.args[0].is_Symbol else f"d/dt({inside})"


def order(expression: Expr) -> int:
    """Return how often time derivatives are nested."""
    below = max((order(a) for a in expression.args), default=0)
    return below + int(isinstance(expression, rate))


def spread(expression: Expr) -> int:
    """Return about how many terms an expression has when it is multiplied out; at most `ENDLESS`."""
    counts = [spread(a) for a in expression.args]
    if expression.is_Add:
        return min(sum(counts), ENDLESS)
    if expression.is_Mul:
        return min(math.prod(counts), ENDLESS)
    if expression.is_Pow and expression.exp.is_Integer:
        return int(min(counts[0] ** min(abs(int(expression.exp)), 64), ENDLESS))
    return max(counts, default=1)


@dataclass(frozen=True)
class Restriction:
    """What is assumed of parameters and solutions: ``name``, symbols made equal or zero.

    ``equal``: pairs of parameters, the second takes the value of the first; ``zero``: parameters,
    inputs and states that are zero at all times; ``balanced``: parameters of which one takes the value
    that keeps the states of ``zero`` at zero; ``rest``: whether states are zero that few motions keep so.
    """

    name: str
    equal: tuple[tuple[Expr, Expr], ...] = ()
    zero: tuple[Expr, ...] = ()
    balanced: tuple[Expr, ...] = ()
    rest: bool = False


@dataclass
class Motion:
    """One solution: series of every quantity, ``length`` coefficients each."""

    system: System
    length: int
    seed: int
    restrictions: tuple[Restriction, ...] = ()
    given: dict[Expr, Series] = field(default_factory=dict)
    memo: dict[Expr, Series] = field(default_factory=dict)
    tangents: dict[Expr, int] = field(default_factory=dict)
    values: dict[Expr, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.generator = random.Random(self.seed)  # noqa: S311 - reproducible points, no secrets
        self.named = _named(self.system)
        _draw(self)
        _solve(self)

    def series(self, expression: Expr) -> Series:
        """Return the series of an expression over the system's quantities, `rate` among them.

        Raises `Singular` where it is undefined at this point, `InputError` where it has no value.
        """
        known = self.memo.get(expression)
        if known is None:
            known = self.memo[expression] = self._evaluated(expression)
        return known

    def _evaluated(self, expression: Expr) -> Series:
        if expression in self.given:
            return self.given[expression]
        if expression in self.named:
            return self.series(self.named[expression])
        for kind, rule in _RULES:
            if isinstance(expression, kind):
                return rule(self, expression)
        raise InputError("this has no value on solutions of the system", got=expression)

    def constant(self, value: int) -> Series:
        """Return a series that does not change."""
        return series.constant(FIELD, value % PRIME, self.length)

    def drawn(self, square: bool = False) -> int:
        """Return a random number that is not zero; the square of one if asked for."""
        value = self.generator.randrange(1, PRIME)
        return value * value % PRIME if square else value

    def value_of(self, key: Expr) -> int:
        """Return the random value at t = 0 of a function without an exact one."""
        if key not in self.values:
            self.values[key] = self.drawn()
        return self.values[key]

    def rotation(self, angle: Expr) -> tuple[Series, Series]:
        """Return sine and cosine of a sum of angles with integer or half-integer factors."""
        sine, cosine = self.constant(0), self.constant(1)
        for part in sp.Add.make_args(angle):
            count, base = part.as_coeff_Mul()
            twice = 2 * count
            if not twice.is_Integer or abs(twice) > MAX_POWER or base.is_number or _inverse(base):
                raise InputError("sine or cosine of what is no sum of angles", got=angle)
            s, c = self._half(base)
            s = s if twice > 0 else -s
            for _ in range(abs(int(twice))):
                sine, cosine = sine * c + cosine * s, cosine * c - sine * s
        return sine, cosine

    def _half(self, base: Expr) -> tuple[Series, Series]:
        """Return sine and cosine of half an angle."""
        if base not in self.tangents:
            self.tangents[base] = 0 if self.series(base).is_zero else self.drawn()
        tau = self.tangents[base]
        scale = FIELD.inverse(1 + tau * tau)
        half = self.series(base).scaled(FIELD.inverse(2))
        sine, cosine = 2 * tau * scale % PRIME, (1 - tau * tau) * scale % PRIME
        return series.sine_cosine(half, sine, cosine)


def _named(system: System) -> dict[Expr, Expr]:
    """Return what definitions, outputs and constants stand for."""
    found: dict[Expr, Expr] = {}
    for d in (*system.definitions, *system.outputs, *system.invariants):
        if d.expression != d.symbol:
            found.setdefault(d.symbol, d.expression)
    for q in (*system.states, *system.parameters, *system.inputs):
        found.pop(q.symbol, None)
    return found


# -- drawing and solving ---------------------------------------------------------------------------


def _draw(m: Motion) -> None:
    """Draw parameters, inputs, time and the states at t = 0."""
    s = m.system
    for q in s.parameters:
        m.given[q.symbol] = m.constant(m.drawn(square=True))
    for q in s.inputs:
        m.given[q.symbol] = Series(FIELD, tuple(m.drawn() for _ in range(m.length)))
    m.given[s.time] = Series(FIELD, (m.drawn(), 1, *[0] * m.length)[: m.length])
    start = {q.symbol: m.drawn() for q in s.states}
    for assumption in s.assumptions:
        start |= _on_constraint(m, assumption.vanish, set(start))
    for r in m.restrictions:
        for first, second in r.equal:
            m.given[second] = m.given[first]
        for symbol in r.zero:
            if symbol in start:
                start[symbol] = 0
            else:
                m.given[symbol] = m.constant(0)
    m.given |= {symbol: Series(FIELD, (value,)) for symbol, value in start.items()}
    if any(r.balanced for r in m.restrictions):
        _balance(m)


def _on_constraint(m: Motion, vanish: Iterable[Expr], states: set[Expr]) -> dict[Expr, int]:
    """Return states on what attitude coordinates must satisfy: a unit quaternion, a rotation."""
    used = set().union(*(e.free_symbols for e in vanish))
    if not used or not used <= states:
        return {}
    ordered = [q.symbol for q in m.system.states if q.symbol in used]
    gibbs = [m.drawn() for _ in range(3)]
    square = sum(g * g for g in gibbs)
    scale = FIELD.inverse(1 + square)
    if len(ordered) == 4:
        values = [(1 - square) * scale, *(2 * g * scale for g in gibbs)]
    elif len(ordered) == 9:
        x, y, z = (Series(FIELD, (g,)) for g in gibbs)
        values = [e.coefficients[0] for row in series.cayley((x, y, z)) for e in row]
    else:
        raise InputError("states on an unknown constraint", got=", ".join(map(str, ordered)))
    return {s: v % PRIME for s, v in zip(ordered, values, strict=True)}


def _balance(m: Motion) -> None:
    """Give a parameter the value that keeps states at zero, where their rates are linear in it."""
    states = [q.symbol for q in m.system.states]
    held = [(r, s) for r in m.restrictions if r.balanced for s in r.zero if s in states]
    for r, symbol in held:
        expression = m.system.expand(m.system.rates[states.index(symbol)])
        if not any(_balanced(m, expression, p) for p in r.balanced):
            raise Inconsistent


def _balanced(m: Motion, expression: Expr, parameter: Expr) -> bool:
    if parameter not in expression.free_symbols:
        return False

    def at(value: int) -> int:
        m.memo.clear()
        m.given[parameter] = m.constant(value)
        return int(m.series(expression).coefficients[0])

    old = m.given[parameter]
    nought, one, two = at(0), at(1), at(2)
    slope = (one - nought) % PRIME
    if slope and (two - one - slope) % PRIME == 0:
        return at(-nought * FIELD.inverse(slope) % PRIME) == 0
    m.memo.clear()
    m.given[parameter] = old
    return False


def _solve(m: Motion) -> None:
    """Find the coefficients of the states one after another: of t^n from the rates up to t^(n-1)."""
    s = m.system
    symbols = [q.symbol for q in s.states]
    for n in range(m.length - 1):
        m.memo.clear()
        right = [m.series(r).coefficients[n] for r in s.rates]
        if s.mass_matrix is not None:
            right = _divided(m, s.mass_matrix, right, symbols, n)
        step = FIELD.inverse(n + 1)
        for symbol, value in zip(symbols, right, strict=True):
            known = m.given[symbol].coefficients
            m.given[symbol] = Series(FIELD, (*known, value * step % PRIME))
    m.memo.clear()
    zero = {symbol for r in m.restrictions for symbol in r.zero}
    if any(s in zero and not m.given[s].is_zero for s in symbols):
        raise Inconsistent


def _divided(m: Motion, matrix: Expr, right: list[int], symbols: list[Expr], n: int) -> list[int]:
    """Solve M x' = f in the coefficients of t^n."""
    rows = [[m.series(e).coefficients for e in row] for row in matrix.tolist()]
    rates = [[(k + 1) * c for k, c in enumerate(m.given[s].coefficients[1:])] for s in symbols]
    known = [
        sum(e[k] * x[n - k] for e, x in zip(row, rates, strict=True) for k in range(1, n + 1))
        for row in rows
    ]
    rest = [(f - k) % PRIME for f, k in zip(right, known, strict=True)]
    return [int(v) for v in series.solve([[e[0] for e in row] for row in rows], rest, FIELD)]


# -- rules -----------------------------------------------------------------------------------------


def _power(m: Motion, node: Expr) -> Series:
    base, exponent = node.as_base_exp()
    if exponent.is_Rational and exponent.q == 2 and abs(exponent.p) <= MAX_POWER:
        return _integer_power(m, _root(m, base), int(exponent.p))
    if not exponent.is_Integer or abs(exponent) > MAX_POWER:
        raise InputError("this power has no exact value", got=node)
    return _integer_power(m, m.series(base), int(exponent))


def _integer_power(m: Motion, base: Series, exponent: int) -> Series:
    base = base if exponent > 0 else base.reciprocal()
    result = m.constant(1)
    for _ in range(abs(exponent)):
        result = result * base
    return result


def _root(m: Motion, base: Expr) -> Series:
    """Return the root that is a square itself; raises `Singular` where there is none."""
    a = m.series(base).coefficients
    first = pow(a[0], ROOT, PRIME)
    if first * first % PRIME != a[0] or first == 0:
        raise Singular
    found = [first]
    half = FIELD.inverse(2 * first)
    for n in range(1, len(a)):
        known = sum(found[k] * found[n - k] for k in range(1, n))
        found.append((a[n] - known) * half % PRIME)
    return Series(FIELD, tuple(found))


def _product(m: Motion, node: Expr) -> Series:
    result = m.series(node.args[0])
    for a in node.args[1:]:
        result = result * m.series(a)
    return result


def _tangent(m: Motion, node: Expr, turned: bool = False) -> Series:
    sine, cosine = m.rotation(node.args[0])
    return cosine * sine.reciprocal() if turned else sine * cosine.reciprocal()


def _rate(m: Motion, node: Expr) -> Series:
    found = m.series(node.args[0]).derivative()
    if not found.coefficients:
        raise InputError("more derivatives than were asked for", got=node)
    return found


def _transcendental(m: Motion, node: Expr) -> Series:
    """Integrate the derivative of a function; its value at t = 0 is random."""
    arguments = [sp.Dummy(real=True) for _ in node.args]
    bare = node.func(*arguments)
    total = m.constant(0)
    for dummy, argument in zip(arguments, node.args, strict=True):
        m.given[dummy] = m.series(argument)
    for dummy, argument in zip(arguments, node.args, strict=True):
        slope = m.series(bare.diff(dummy))
        total = total + slope * m.series(argument).derivative()
    coefficients = total.coefficients
    integrated = (c * FIELD.inverse(k + 1) % PRIME for k, c in enumerate(coefficients))
    return Series(FIELD, (m.value_of(node), *integrated))


INVERSES = (sp.atan, sp.asin, sp.acos, sp.atan2, sp.log)


def _inverse(expression: Expr) -> bool:
    return bool(expression.atoms(*INVERSES))


_RULES: tuple[tuple[Any, Callable[[Motion, Any], Series]], ...] = (
    (sp.Rational, lambda m, n: m.constant(FIELD.of(int(n.p), int(n.q)))),
    (sp.Float, lambda m, n: m.series(sp.Rational(n))),
    (sp.NumberSymbol, lambda m, n: m.constant(m.value_of(n))),
    (sp.Add, lambda m, n: series.total([m.series(a) for a in n.args])),
    (sp.Mul, _product),
    (sp.Pow, _power),
    (sp.sin, lambda m, n: m.rotation(n.args[0])[0]),
    (sp.cos, lambda m, n: m.rotation(n.args[0])[1]),
    (sp.tan, _tangent),
    (sp.cot, lambda m, n: _tangent(m, n, turned=True)),
    (sp.sec, lambda m, n: m.rotation(n.args[0])[1].reciprocal()),
    (sp.csc, lambda m, n: m.rotation(n.args[0])[0].reciprocal()),
    (rate, _rate),
    (INVERSES, _transcendental),
)
"""One rule a kind of SymPy expression."""
