"""Solutions of a system near a random point, as power series in time modulo a prime.

States, parameters, inputs and what is derived from them become truncated series whose coefficients are
exact; a time derivative is one of series, so that statements with rates of any order are decided without
forming them symbolically. Sines and cosines of sums of angles with integer or half-integer factors come
from tangents drawn at random; roots are those of the field, and parameters are squares, so that the root
of the square of a parameter is the parameter. Other functions get a random value and the right derivative.

Solutions through a given point in real numbers, to many digits or in double precision.

Numbers to many digits, for roots and inverse functions, whose branches no finite field has: what differs
there differs for certain.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, ClassVar

import sympy as sp
from mpmath import fp

from eom.errors import InputError
from eom.exact import series
from eom.exact.numbers import MANY, Number, Reals, met
from eom.exact.rings import (
    ARITHMETIC,
    FLOATS,
    TRIGONOMETRY,
    Evaluation,
    Row,
    arguments,
    none,
    summands,
)
from eom.exact.series import Series
from eom.fields import PRIME, RESIDUES, Field, Singular, solve
from eom.rotations import cosines, quaternion_product
from eom.system import Expr, System

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


class since(sp.Function):  # type: ignore[misc] # noqa: N801 - named as it is printed
    """The integral of its argument over time, from the start until now."""

    nargs = 1


class start(sp.Function):  # type: ignore[misc] # noqa: N801 - named as it is printed
    """The value of its argument at the start."""

    nargs = 1


class instant(sp.Function):  # type: ignore[misc] # noqa: N801 - named as it is printed
    """The value of its first argument at an instant, which the second one names."""

    nargs = 2


class approached(sp.Function):  # type: ignore[misc] # noqa: N801 - named as it is printed
    """The limit of an expression where a symbol goes to a value, from above or below (1, -1)."""

    nargs = 4


class anything(sp.Function):  # type: ignore[misc] # noqa: N801 - named as it is printed
    """What the system knows nothing of, by its name: a number, or (1 behind it) any function of time."""

    nargs = 2

    def _sympystr(self, printer: Any) -> str:
        return str(printer._print(self.args[0]))


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

    ``equal``: pairs of parameters, the second takes the value of the first, or a number; ``zero``:
    parameters, inputs and states that are zero at all times; ``held``: what is constant, by the speeds,
    loads and parameters that it takes; ``now``: of which derivative this is so, and at the start alone,
    0 for all; ``rest``: whether states are zero that few motions keep so.
    """

    name: str
    equal: tuple[tuple[Expr, Expr], ...] = ()
    zero: tuple[Expr, ...] = ()
    held: tuple[Expr, ...] = ()
    now: int = 0
    rest: bool = False

    @property
    def values(self) -> dict[Expr, Expr]:
        """Symbols with the numbers that they get."""
        given = {b: a for a, b in self.equal if a.is_number}
        return given | dict.fromkeys(self.zero, sp.S.Zero)

    @property
    def symbols(self) -> frozenset[Expr]:
        """All symbols that are restricted."""
        return frozenset(
            {*self.zero, *self.held, *(s for p in self.equal for s in p if s.is_Symbol)}
        )


@dataclass
class Motion(Evaluation):
    """One solution: series of every quantity, ``length`` coefficients each, in the field ``numbers``."""

    numbers: ClassVar[Field] = RESIDUES

    system: System
    length: int
    seed: int
    restrictions: tuple[Restriction, ...] = ()
    given: dict[Expr, Series] = field(default_factory=dict)
    start: dict[Expr, int] = field(default_factory=dict)
    memo: dict[Expr, Series] = field(default_factory=dict)
    tangents: dict[Expr, int] = field(default_factory=dict)
    values: dict[Expr, int] = field(default_factory=dict)
    chosen: dict[tuple[Expr, int], int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.generator = random.Random(self.seed)  # noqa: S311 - reproducible points, no secrets
        self.named = _named(self.system)
        self.ring = series.Ring(self.numbers, self.length)
        self.begin()

    def begin(self) -> None:
        """Draw a point of a solution that keeps the restrictions."""
        _draw(self)
        self.solve()
        _hold(self)
        _keeps(self)

    def series(self, expression: Expr) -> Series:
        """Return the series of an expression over the system's quantities, `rate` among them.

        Raises `Singular` where it is undefined at this point, `InputError` where it has no value.
        """
        found: Series = self.value(expression)
        return found

    def meaning(self, symbol: Expr) -> Expr | None:
        """Return what definitions, outputs and constants stand for."""
        return None if symbol in self.given else self.named.get(symbol)

    def symbol(self, symbol: Expr) -> Series:
        """Return the series of a state, a parameter, an input or time."""
        return self.given[symbol] if symbol in self.given else self.other(symbol)

    def other(self, node: Expr) -> Series:
        """Refuse what has no series."""
        raise InputError("this has no value on solutions of the system", got=node)

    def constant(self, value: Any) -> Series:
        """Return a series that does not change."""
        return series.constant(self.numbers, self.numbers.reduce(value), self.length)

    def drawn(self, square: bool = False) -> int:
        """Return a random number that is not zero; the square of one if asked for."""
        value = self.generator.randrange(1, PRIME)
        return value * value % PRIME if square else value

    def value_of(self, key: Expr) -> Any:
        """Return the random value at t = 0 of a function without an exact one."""
        if key not in self.values:
            self.values[key] = self.drawn()
        return self.values[key]

    def circle(self, half: Expr) -> tuple[Any, Any]:
        """Return cosine and sine at t = 0 of half an angle, by a random tangent."""
        if half not in self.tangents:
            self.tangents[half] = self._tangent(half)
        return RESIDUES.circle(self.tangents[half])

    def _tangent(self, half: Expr) -> int:
        """Return a random tangent of a quarter of an angle, or that of the sum that it stands for."""
        if self._written_out(half) != half:
            with suppress(InputError):
                cosine, sine = (s.coefficients[0] for s in self.rotation(half / 2))
                return int(RESIDUES.reduce(sine * RESIDUES.inverse(1 + cosine)))
        return 0 if self.series(half).is_zero else self.drawn()

    def _written_out(self, angle: Expr) -> Expr:
        """Return an angle with the sums that symbols in it stand for."""
        named = {s: self.meaning(s) for s in angle.free_symbols}
        found = {s: e for s, e in named.items() if e is not None and not _inverse(e)}
        return self._written_out(sp.expand_mul(angle.xreplace(found))) if found else angle

    def anything(self, node: Expr) -> Series:
        """Return random coefficients, of a number but the first zeros."""
        generator = random.Random(f"{self.seed} {node}")  # noqa: S311 - reproducible, no secret
        drawn = (generator.randrange(1, PRIME) for _ in range(self.length))
        moving = int(node.args[1])
        found = (self.chosen.get((node, k), c) for k, c in enumerate(drawn))
        return Series(RESIDUES, tuple(c if moving or not k else 0 for k, c in enumerate(found)))

    def choose(self, node: Expr, order: int, value: int) -> None:
        """Give a coefficient of what the system knows nothing of a value of its own."""
        self.chosen[node, order] = value
        self.memo.clear()

    def turns(self, angle: Expr) -> Iterator[tuple[Series, Series, int]]:
        """Yield cosines and sines of half of each angle of a sum, and how often they are there."""
        for base, count in summands(self._written_out(angle)):
            twice = 2 * count
            if not twice.is_Integer or abs(twice) > MAX_POWER or base.is_number or _inverse(base):
                raise InputError("sine or cosine of what is no sum of angles", got=angle)
            yield *self._half(base), int(twice)

    def _half(self, base: Expr) -> tuple[Series, Series]:
        """Return cosine and sine of half an angle."""
        cosine, sine = self.circle(base)
        half = self.series(base).scaled(self.numbers.inverse(2))
        return series.sine_cosine(half, sine, cosine)[::-1]

    def power(self, node: Expr, base: Series) -> Series:
        """Return a whole power, up to `MAX_POWER`."""
        if abs(node.exp) > MAX_POWER:
            raise InputError("this power has no exact value", got=node)
        found: Series = self.ring.power(base, int(node.exp))
        return found

    def root(self, node: Expr) -> Series:
        """Return a power of the root that is a square itself."""
        base, exponent = node.as_base_exp()
        if not exponent.is_Rational or exponent.q != 2 or abs(exponent.p) > MAX_POWER:
            raise InputError("this power has no exact value", got=node)
        found: Series = self.ring.power(series.root(self.series(base)), int(exponent.p))
        return found

    def solve(self) -> None:
        """Find the coefficients of the states one after another: of t^n from the rates up to t^(n-1)."""
        s, field = self.system, self.numbers
        symbols = [q.symbol for q in s.states]
        self.given |= {symbol: Series(field, (value,)) for symbol, value in self.start.items()}
        for n in range(self.length - 1):
            self.memo.clear()
            right = [self.series(r).coefficients[n] for r in s.rates]
            if s.mass_matrix is not None:
                right = _divided(self, s.mass_matrix, right, symbols, n)
            step = field.inverse(n + 1)
            for symbol, value in zip(symbols, right, strict=True):
                known = self.given[symbol].coefficients
                self.given[symbol] = Series(field, (*known, field.reduce(value * step)))
        self.memo.clear()


class Placed(Motion):
    """A solution modulo a prime through a point, ``given`` and ``start``, with known ``tangents``."""

    def begin(self) -> None:
        """Find the solution through the point."""
        self.solve()


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
        m.given[q.symbol] = Series(RESIDUES, tuple(m.drawn() for _ in range(m.length)))
    m.given[s.time] = Series(RESIDUES, (m.drawn(), 1, *[0] * m.length)[: m.length])
    start = {q.symbol: m.drawn() for q in s.states}
    for assumption in s.assumptions:
        start |= _on_constraint(m, assumption.vanish, set(start))
    for r in m.restrictions:
        for first, second in r.equal:
            m.given[second] = m.series(first)
        for symbol in r.zero:
            if symbol in start:
                start[symbol] = 0
            else:
                m.given[symbol] = m.constant(0)
    m.start = start


def _on_constraint(m: Motion, vanish: Iterable[Expr], states: set[Expr]) -> dict[Expr, int]:
    """Return states on what attitude coordinates must satisfy: a unit quaternion, a rotation."""
    used = set().union(*(e.free_symbols for e in vanish))
    if not used or not used <= states:
        return {}
    ordered = [q.symbol for q in m.system.states if q.symbol in used]
    q = (1, *(m.drawn() for _ in range(3)))
    values = {4: quaternion_product(q, q), 9: [x for row in cosines(q) for x in row]}.get(
        len(ordered)
    )
    if values is None:
        raise InputError("states on an unknown constraint", got=", ".join(map(str, ordered)))
    scale = RESIDUES.inverse(sum(x * x for x in q))
    return dict(zip(ordered, RESIDUES.scaled(values, scale), strict=True))


def _hold(m: Motion) -> None:
    """Give speeds, loads and parameters values by which what is held is constant, order by order."""
    held = [(e, r.now) for r in m.restrictions for e in r.held]
    free = list(_slots(m)) if held else []
    m.generator.shuffle(free)  # others with each seed: there may be several such motions
    for e, now in held:
        for n in [now] if now else range(1, m.length):
            if m.series(e).coefficients[n]:
                slot = next((s for s in free if _balanced(m, e, n, *s, 1 if now else n)), None)
                if slot is None:
                    raise Inconsistent
                free.remove(slot)


def _slots(m: Motion) -> Iterator[tuple[Expr, int]]:
    """Yield what may be chosen: states at the start, coefficients of inputs, parameters but inertia."""
    zero = {s for r in m.restrictions for s in r.zero}
    fixed = {*zero, *(s for r in m.restrictions for s in r.held)}
    fixed |= {s for r in m.restrictions for pair in r.equal for s in pair}
    fixed |= {s for a in m.system.assumptions for e in a.vanish for s in e.free_symbols}
    yield from ((q.symbol, 0) for q in m.system.states if q.symbol not in fixed)
    inputs = [q.symbol for q in m.system.inputs if q.symbol not in fixed]
    yield from ((s, n) for n in range(m.length) for s in inputs)
    others = (q for q in m.system.parameters if q.unit != "kg m^2" and q.symbol not in fixed)
    yield from ((q.symbol, 0) for q in others)


def _balanced(m: Motion, e: Expr, n: int, symbol: Expr, place: int, before: int) -> bool:
    """Choose a number on which a coefficient depends linearly so that it is zero, as some before it."""
    old = m.start.get(symbol, m.given[symbol])

    def at(value: int) -> int:
        if isinstance(old, Series):
            c = old.coefficients
            m.given[symbol] = Series(RESIDUES, (*c[:place], value, *c[place + 1 :]))
        else:
            m.start[symbol] = value
        m.solve()
        return int(m.series(e).coefficients[n])

    whole, m.length = m.length, n + 1  # what comes behind does not count here
    try:
        found = _zeroed(at, before, lambda: m.series(e).coefficients)
    finally:
        m.length = whole
    if found:
        m.solve()
    elif isinstance(old, Series):
        m.given[symbol] = old
    else:
        m.start[symbol] = old
    return found


def _zeroed(
    at: Callable[[int], int], before: int, coefficients: Callable[[], tuple[Any, ...]]
) -> bool:
    """Choose the number at which a coefficient is zero that depends linearly on it, and some before it."""
    with suppress(Singular):
        nought, one = at(0), at(1)
        slope = (one - nought) % PRIME
        if slope and (at(2) - one - slope) % PRIME == 0:
            left = at(-nought * RESIDUES.inverse(slope) % PRIME)
            return not left and not any(coefficients()[1:before])
    return False


def _keeps(m: Motion) -> None:
    """Raise `Inconsistent` where the motion does not keep what is assumed of it."""
    zero = {s for r in m.restrictions for s in r.zero}
    held = [e for r in m.restrictions for e in r.held if not r.now]
    moved = any(not m.series(e).derivative().is_zero for e in held)
    if moved or any(not m.given[s].is_zero for s in m.start if s in zero):
        raise Inconsistent


def _divided(m: Motion, matrix: Expr, right: list[Any], symbols: list[Expr], n: int) -> list[Any]:
    """Solve M x' = f in the coefficients of t^n."""
    rows = [[m.series(e).coefficients for e in row] for row in matrix.tolist()]
    rates = [[(k + 1) * c for k, c in enumerate(m.given[s].coefficients[1:])] for s in symbols]
    known = [
        sum(e[k] * x[n - k] for e, x in zip(row, rates, strict=True) for k in range(1, n + 1))
        for row in rows
    ]
    rest = [m.numbers.reduce(f - k) for f, k in zip(right, known, strict=True)]
    return solve([[e[0] for e in row] for row in rows], rest, m.numbers)


# -- rules -----------------------------------------------------------------------------------------


def _rate(_: Motion, node: Expr, values: list[Series]) -> Series:
    found = values[0].derivative()
    if not found.coefficients:
        raise InputError("more derivatives than were asked for", got=node)
    return found


def integrated(m: Motion, node: Expr, values: list[Series]) -> Series:
    """Return a function by its value at t = 0 and the integral of its derivative."""
    arguments = [sp.Dummy(real=True) for _ in node.args]
    bare = node.func(*arguments)
    total = m.constant(0)
    m.given |= dict(zip(arguments, values, strict=True))
    for dummy, value in zip(arguments, values, strict=True):
        total = total + m.series(bare.diff(dummy)) * value.derivative()
    coefficients = total.coefficients
    field = m.numbers
    rest = (field.reduce(c * field.inverse(k + 1)) for k, c in enumerate(coefficients))
    return Series(field, (m.value_of(node), *rest))


INVERSES = (sp.atan, sp.asin, sp.acos, sp.atan2, sp.log)


def _inverse(expression: Expr) -> bool:
    return bool(expression.atoms(*INVERSES))


Motion.rows = (
    ARITHMETIC
    | FLOATS
    | TRIGONOMETRY
    | {sp.NumberSymbol: Row(none, lambda m, n, _: m.constant(m.value_of(n)))}
    | {rate: Row(arguments, _rate), since: Row(arguments, lambda _, __, v: v[0].primitive())}
    | {anything: Row(none, lambda m, n, _: m.anything(n))}
    | {start: Row(arguments, lambda m, _, v: m.constant(v[0].coefficients[0]))}
    | dict.fromkeys(INVERSES, Row(arguments, integrated))
)


# -- to many digits --------------------------------------------------------------------------------


DIGITS = 40
TRIALS = 4
MAX_ORDER = 2


def without_rates(system: System, expression: Expr) -> Expr:
    """Return an expression over states, parameters, inputs and time, rates written out.

    Raises `InputError` where the system has a mass matrix.
    """
    named = {d.symbol: d.expression for d in (*system.outputs, *system.invariants)}
    own = {q.symbol for q in (*system.states, *system.parameters, *system.inputs)}
    named = {s: e for s, e in named.items() if s not in own and s != e}

    def plain(e: Expr) -> Expr:
        if isinstance(e, anything):
            raise InputError("nothing ties this to the system", got=e)
        if isinstance(e, rate):
            return system.rate_of(plain(e.args[0]))
        if not e.args:
            return system.expand(named.get(e, e))
        return e.func(*(plain(a) for a in e.args))

    return plain(expression)


def inexact(system: System, expression: Expr) -> bool:
    """Return whether an expression has roots or inverse functions when its names are written out."""
    todo, seen = [expression], set[Expr]()
    named = {d.symbol: d.expression for d in (*system.definitions, *system.outputs)}
    while todo:
        e = todo.pop()
        seen.add(e)
        powers = (p.as_base_exp()[1] for p in e.atoms(sp.Pow))
        if e.has(*INVERSES) or any(not p.is_Integer for p in powers):
            return True
        todo += [named[s] for s in e.free_symbols if s in named and named[s] not in seen]
    return False


def differs(
    system: System, left: Expr, right: Expr, restrictions: Iterable[Restriction] = ()
) -> bool:
    """Return whether two expressions differ for real numbers: certain if True.

    States near 1/2 and positive parameters are drawn; states of an attitude lie on what they must satisfy.
    """
    if system.mass_matrix is not None or max(order(left), order(right)) > MAX_ORDER:
        return False
    full = without_rates(system, left - right)
    size = sp.Add(*(abs(without_rates(system, m)) for m in (left, right)))
    equal = {b: a for r in restrictions for a, b in r.equal}
    zero = {s: sp.Integer(0) for r in restrictions for s in r.zero}
    for seed in range(TRIALS):
        point = real_point(system, seed) | zero
        point |= {b: point[a] for b, a in equal.items()}
        value, scale = (e.evalf(DIGITS, subs=point) for e in (full, size))
        if value.is_number and value.is_real and abs(value) > 10**-20 * (1 + scale):
            return True
    return False


def real_point(system: System, seed: int) -> dict[Expr, Expr]:
    """Return small rationals: positive parameters, states of both signs, unit quaternions."""
    generator = random.Random(seed)  # noqa: S311 - reproducible points, no secrets

    def drawn(lowest: int) -> Expr:
        return sp.Rational(generator.randint(lowest, 60), 61)

    point = {q.symbol: 1 + 2 * drawn(1) for q in (*system.parameters, *system.inputs)}
    point |= {q.symbol: drawn(5) * generator.choice((-1, 1)) for q in system.states}
    point[system.time] = drawn(1)
    for assumption in system.assumptions:
        used = set().union(*(e.free_symbols for e in assumption.vanish))
        ordered = [q.symbol for q in system.states if q.symbol in used]
        if used and len(ordered) == len(used) == 4:
            point |= zip(ordered, unit_quaternion([drawn(5) for _ in range(3)]), strict=True)
    return point


def unit_quaternion(gibbs: list[Expr]) -> tuple[Expr, ...]:
    """Return a rational unit quaternion."""
    square = sum(g**2 for g in gibbs)
    return ((1 - square) / (1 + square), *(2 * g / (1 + square) for g in gibbs))


# -- in real numbers -------------------------------------------------------------------------------


_FUNCTIONS = (*INVERSES, sp.exp, sp.sinh, sp.cosh, sp.tanh)


@dataclass
class Real(Motion):
    """A solution through a point: states, parameters and inputs are ``start`` and ``given``.

    ``branches``: the cases that applied, by the expression that has them.
    """

    numbers: ClassVar[Reals] = Reals()

    branches: dict[Expr, int] = field(default_factory=dict)

    def begin(self) -> None:
        """Find the solution; inputs and parameters are constant."""
        number = self.numbers.context.convert
        self.given = {s: self.constant(number(v)) for s, v in self.given.items()}
        self.start = {s: number(v) for s, v in self.start.items()}
        time = self.given[self.system.time].coefficients[0]
        self.given[self.system.time] = Series(
            self.numbers, (time, 1, *[0] * self.length)[: self.length]
        )
        self.solve()

    def circle(self, half: Expr) -> tuple[Number, Number]:
        """Return cosine and sine at t = 0 of half an angle."""
        value = self.series(half).coefficients[0] / 2
        return self.numbers.context.cos(value), self.numbers.context.sin(value)

    def value_of(self, key: Expr) -> Number:
        """Return the value at t = 0 of a function or a constant."""
        if not key.args:
            return self.numbers.context.mpf(str(key.evalf(MANY)))
        function = getattr(self.numbers.context, type(key).__name__)
        return function(*(self.series(a).coefficients[0] for a in key.args))

    def first(self, node: Expr) -> Number:
        """Return the value at t = 0."""
        return self.series(sp.sympify(node, strict=True)).coefficients[0]

    def case(self, node: Expr) -> Series:
        """Return the first case whose condition is met; raises `Singular` where none is."""
        for k, (value, condition) in enumerate(node.args):
            if met(condition, self.first):
                self.branches[node] = k
                return self.series(value)
        raise Singular

    def root(self, node: Expr) -> Series:
        """Return any power of a positive number; the square root of any."""
        base, exponent = node.as_base_exp()
        if exponent.is_Rational and exponent.q == 2:
            return super().root(node)
        return self.series(sp.exp(exponent * sp.log(base)))


def _size(_: Motion, __: Expr, values: list[Series]) -> Series:
    return values[0] if values[0].coefficients[0] >= 0 else -values[0]


def _sign(m: Motion, _: Expr, values: list[Series]) -> Series:
    return m.constant(1 if values[0].coefficients[0] >= 0 else -1)


_ROWS = dict.fromkeys(_FUNCTIONS, Row(arguments, integrated)) | {
    sp.Abs: Row(arguments, _size),
    sp.sign: Row(arguments, _sign),
    sp.Piecewise: Row(none, lambda m, node, _: m.case(node)),
}
Real.rows = {**Motion.rows, **_ROWS}


class Double(Real):
    """A solution in double precision, for steps in time."""

    numbers: ClassVar[Reals] = Reals(context=fp)
