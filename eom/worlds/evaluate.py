"""The value of a term in a world, and whether an equation holds there.

Nothing of mechanics is known here but the definitions of `eom.terms.vocabulary` and Newton's meaning of the
primitive quantities, which the world supplies.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property, reduce
from itertools import combinations, product
from typing import Any

import sympy as sp

from eom import limits
from eom.errors import InputError
from eom.exact import series
from eom.exact.numbers import MANY, SIGNED, TINY, Number, met
from eom.exact.rings import ARITHMETIC, TRIGONOMETRY, Evaluation, Row, arguments, none, summands
from eom.exact.series import LENGTH, Series
from eom.fields import Singular
from eom.terms.terms import INDICES, Equation, Term, nodes
from eom.terms.vocabulary import ORIGIN, definition
from eom.worlds.varied import lifted, slope, varied
from eom.worlds.worlds import CONFIGURED, TURNING, World, slope_of_place

Value = Any
"""A series, a vector (three of them, in I), a dyadic (in I), a column or a matrix."""
Env = Mapping[str, int]


MAX_POWER = 64


class NoSlope(InputError):
    """Refuse a partial derivative of which a world knows no value: an `InputError` with its parts."""


@dataclass(frozen=True)
class Evaluator:
    """Values of terms in one world; ``scalars`` says what each SymPy symbol stands for."""

    world: World
    scalars: Mapping[Any, Term]
    memo: dict[Any, Value] = field(default_factory=dict)
    beside: Evaluator | None = None
    """Where nothing is varied, if something is here."""

    def holds(self, equation: Equation) -> bool:
        """Return whether both sides agree in every known coefficient, for all free indices."""
        both = self.labels(equation.left) | self.labels(equation.right)
        return all(self._agree(equation, env) for env in self.numberings(both))

    def lowest(self, term: Term) -> Any:
        """Return the least value at t = 0 of a scalar, over all free indices; for rational worlds."""
        numberings = self.numberings(self.labels(term))
        return min(self.value(term, env).coefficients[0] for env in numberings)

    def numberings(self, labels: frozenset[str]) -> Iterator[Env]:
        """Yield every way to number the free indices among ``labels``."""
        free = sorted(labels & INDICES)
        ranges = [range(self.world.count("rotors" if i == "k" else "particles")) for i in free]
        return (dict(zip(free, numbers, strict=True)) for numbers in product(*ranges))

    def labels(self, term: Term) -> frozenset[str]:
        """Return the free labels of a term and of what its symbols stand for."""
        symbols = {s for n in nodes(term) if n.head == "expr" for s in n.data[0].free_symbols}
        meanings = (self.scalars[s] for s in symbols if s in self.scalars)
        return term.labels.union(*(self.labels(m) for m in meanings))

    def _agree(self, equation: Equation, env: Env) -> bool:
        left, right = self.value(equation.left, env), self.value(equation.right, env)
        parts = flat(left), flat(right)
        if len(parts[0]) != len(parts[1]):
            raise InputError("two sides have different numbers of components")
        return all((a - b).is_zero for a, b in zip(*parts, strict=True))

    def value(self, term: Term, env: Env | None = None) -> Value:
        """Return the value of ``term``; ``env`` numbers the particles that indices stand for."""
        env = env or {}
        memo, key = self._place(term, env)
        if key not in memo:
            limits.check()
            memo[key] = _RULES[term.head](self, term, env)
        return memo[key]

    def _place(self, term: Term, env: Env) -> tuple[dict[Any, Value], Any]:
        """Return where the value is kept: without symbols it is the world's, for any evaluator."""
        if not term.is_plain:
            return self.memo, (term, tuple(sorted(env.items())))
        return self.world.memo, (term, tuple((i, env[i]) for i in term.indices if i in env))

    def scalar(self, expression: Any, env: Env) -> Series:
        """Return the value of a SymPy expression over known symbols."""
        memo = self.memo.setdefault(("scalars", *sorted(env.items())), {})
        known = memo.get(expression)
        kind = _InNumbers if self.world.field == SIGNED else _Scalars
        result: Series = kind(self, env, memo).value(expression) if known is None else known
        return result

    @property
    def branches(self) -> dict[Any, int]:
        """Which case of those with conditions was the one that applies, as far as was looked at."""
        found: dict[Any, int] = self.memo.setdefault("branches", {})
        return found

    def named(self, symbol: Any, env: Env) -> Value:
        """Return the value of what a SymPy symbol stands for; a momentum is a variable by itself."""
        meaning = self.meaning(symbol)
        if self.beside is not None and meaning.head == "partial":
            return lifted(self.beside.value(meaning, env), self.world.field)
        return self.value(meaning, env)

    def varied(self, name: str, power: int) -> Evaluator:
        """Return the values where a coordinate is varied: see `eom.worlds.varied`."""
        key = ("varied", name, power)
        if key not in self.world.memo:
            self.world.memo[key] = varied(self.world, name, power)
        if key not in self.memo:
            self.memo[key] = Evaluator(self.world.memo[key], self.scalars, beside=self)
        found: Evaluator = self.memo[key]
        return found

    def meaning(self, symbol: Any) -> Term:
        """Return what a SymPy symbol stands for. Raises `InputError` for unknown ones."""
        if symbol not in self.scalars:
            raise InputError("symbol without a meaning in this statement", got=symbol)
        return self.scalars[symbol]


@dataclass(frozen=True)
class _Scalars(Evaluation):
    """Values of SymPy expressions over known symbols."""

    evaluator: Evaluator
    env: Env
    memo: dict[Any, Series]

    @cached_property
    def ring(self) -> series.Ring:  # type: ignore[override]
        """The series of the world."""
        return series.Ring(self.evaluator.world.field, LENGTH)

    def symbol(self, symbol: Any) -> Series:
        """Return the value of what a symbol stands for."""
        found: Series = self.evaluator.named(symbol, self.env)
        return found

    def root(self, node: Any) -> Series:
        """Return a power of a square root; raises `Singular` in a world that has none."""
        base, exponent = node.as_base_exp()
        if not exponent.is_Rational or exponent.q != 2 or abs(exponent.p) > MAX_POWER:
            raise InputError("this power has no exact value", got=node)
        found: Series = self.ring.power(series.root(self.value(base)), int(exponent.p))
        return found

    def transcendental(self, node: Any) -> Series:
        """Return a number such as pi, of which nothing rational is known, as a random one."""
        world = self.evaluator.world
        return world.constant(world.field.draw(world.free("number", str(node))))

    def other(self, node: Any) -> Series:
        """Refuse what has no value."""
        raise InputError("no value is known of this function", got=node)

    def turns(self, angle: Any) -> Iterator[tuple[Series, Series, int]]:
        """Yield cosine and sine of angles, each an integer or half as often in a sum."""
        for symbol, count in summands(sp.expand(angle)):
            meaning = self.evaluator.scalars.get(symbol)
            known = meaning is not None and meaning.head == "atom" and meaning.data[0] in TURNING
            if meaning is None or not known or count.q not in {1, 2}:
                raise InputError("sine or cosine of what is no sum of angles", got=angle)
            found = self.evaluator.world.angle(*meaning.data)
            sine, cosine = found[1:3] if count.q == 1 else found[3:]
            yield cosine, sine, int(count.p)

    def tangent(self, angle: Any) -> Series:
        """Return sin 2a / (1 + cos 2a), which needs no sine of a itself."""
        cosine, sine = self.rotation(2 * angle)
        found: Series = sine * (self.ring.of(1) + cosine).reciprocal()
        return found


_Scalars.rows = (
    ARITHMETIC
    | TRIGONOMETRY
    | {
        sp.NumberSymbol: Row(none, lambda e, n, _: e.transcendental(n)),
        sp.tan: Row(none, lambda e, n, _: e.tangent(n.args[0])),
        sp.cot: Row(none, lambda e, n, _: e.tangent(n.args[0]).reciprocal()),
    }
)


# -- numbers with a sign -----------------------------------------------------------------------------


@dataclass(frozen=True)
class _InNumbers(_Scalars):
    """Values where numbers have a sign and all functions their own values."""

    def first(self, node: Any) -> Number:
        """Return the value at t = 0."""
        return SIGNED.context.convert(self.value(node).coefficients[0])

    def transcendental(self, node: Any) -> Series:
        """Return the number itself."""
        return self.evaluator.world.constant(SIGNED.context.mpf(str(node.evalf(MANY))))

    def root(self, node: Any) -> Series:
        """Return any power of what is positive."""
        base, exponent = node.as_base_exp()
        if exponent.is_Rational and exponent.q == 2:
            return super().root(node)
        found: Series = self.value(sp.exp(exponent * sp.log(base)))
        return found

    def rotation(self, angle: Any) -> tuple[Series, Series]:
        """Return cosine and sine of any angle."""
        value, context = self.value(angle), SIGNED.context
        start = context.convert(value.coefficients[0])
        sine, cosine = series.sine_cosine(value, context.sin(start), context.cos(start))
        return cosine, sine

    def function(self, node: Any, values: list[Series]) -> Series:
        """Return a function by its value at t = 0 and the integral of its derivative along the motion."""
        try:
            start = getattr(SIGNED.context, type(node).__name__)(*map(self.first, node.args))
        except (ValueError, ZeroDivisionError):
            raise Singular from None
        if not isinstance(start, type(TINY)):
            raise Singular
        slopes = (self.value(s) for s in _slopes(node))
        parts = (s * v.derivative() for s, v in zip(slopes, values, strict=True))
        rate = reduce(lambda a, b: a + b, parts)
        return Series(SIGNED, (start, *rate.primitive().coefficients[1:]))

    def exponential(self, value: Series) -> Series:
        """Return the exponential: its rate is the value's rate times itself."""
        rate = value.derivative().coefficients
        found = [SIGNED.context.exp(SIGNED.context.convert(value.coefficients[0]))]
        for n in range(len(rate)):
            found.append(sum(rate[k] * found[n - k] for k in range(n + 1)) / (n + 1))
        return Series(SIGNED, tuple(found))

    def signed(self, node: Any) -> int:
        """Return the sign of a value at t = 0; raises `Singular` for zero."""
        value = self.first(node)
        if abs(value) < TINY:
            raise Singular
        return 1 if value > 0 else -1

    def case(self, node: Any) -> Series:
        """Return the first case whose condition is met; raises `Singular` where none is."""
        for k, (value, condition) in enumerate(node.args):
            if met(condition, self.first):
                self.evaluator.branches[node] = k
                found: Series = self.value(value)
                return found
        raise Singular


@cache
def _slopes(node: Any) -> tuple[Any, ...]:
    """Return the slopes of a function along its arguments."""
    letters = [sp.Dummy(real=True) for _ in node.args]
    bare = node.func(*letters)
    own = dict(zip(letters, node.args, strict=True))
    return tuple(bare.diff(x).xreplace(own) for x in letters)


_OWN = (sp.log, sp.atan, sp.asin, sp.acos, sp.atan2)
_HYPERBOLIC = (sp.sinh, sp.cosh, sp.tanh)
_InNumbers.rows = {
    **_Scalars.rows,
    **TRIGONOMETRY,
    **dict.fromkeys(_OWN, Row(arguments, lambda e, n, v: e.function(n, v))),
    **dict.fromkeys(_HYPERBOLIC, Row(lambda _, n: (n.rewrite(sp.exp),), lambda _, __, v: v[0])),
    sp.exp: Row(arguments, lambda e, n, v: e.exponential(v[0])),
    sp.Abs: Row(arguments, lambda e, n, v: v[0].scaled(e.signed(n.args[0]))),
    sp.sign: Row(arguments, lambda e, n, _: e.ring.of(e.signed(n.args[0]))),
    sp.Piecewise: Row(none, lambda e, n, _: e.case(n)),
}


def variable(scalars: Mapping[Any, Term], by: Term) -> tuple[str, int]:
    """Return the coordinate that a symbol stands for, or of which it is a rate, and of which order.

    Raises `InputError` for what is neither.
    """
    meaning = scalars.get(by.data[0], by) if by.head == "expr" else by
    if meaning.data[:1] == ("coordinate",):
        return str(meaning.data[1]), 0
    if meaning.head != "der" or by == meaning.args[0]:
        raise NoSlope("only a system says how this depends on a coordinate", got=by.head)
    name, order = variable(scalars, meaning.args[0])
    return name, order + 1


def is_signed(expression: Any, scalars: Mapping[Any, Term]) -> bool:
    """Return whether an expression has a value where numbers have a sign alone, and in no other field."""
    for part in sp.preorder_traversal(expression):
        if isinstance(part, (*_OWN, *_HYPERBOLIC, sp.exp, sp.Abs, sp.sign, sp.Piecewise)):
            return True
        if part.is_Pow and not (part.exp.is_Rational and part.exp.q in {1, 2}):
            return True
        angles = part.args if isinstance(part, sp.sin | sp.cos) else ()
        doubled = [2 * part.args[0]] if isinstance(part, sp.tan | sp.cot) else angles
        if not all(_turns(angle, scalars) for angle in doubled):
            return True
    return False


def _turns(angle: Any, scalars: Mapping[Any, Term]) -> bool:
    """Return whether all terms of an angle are multiples of what is drawn as one."""
    meanings = [(scalars.get(s), count) for s, count in summands(sp.expand(angle))]
    return all(
        m is not None and m.head == "atom" and m.data[0] in TURNING and count.q in {1, 2}
        for m, count in meanings
    )


def half_powers(expression: Any) -> Iterator[Any]:
    """Yield the powers of square roots in an expression."""
    for part in sp.preorder_traversal(expression):
        if part.is_Pow and part.exp.is_Rational and part.exp.q == 2:
            yield part


def subsets(found: frozenset[Any]) -> Iterator[frozenset[Any]]:
    """Yield every set of members but the empty one."""
    ordered = sorted(found, key=sp.default_sort_key)
    for k in range(1, len(ordered) + 1):
        yield from map(frozenset, combinations(ordered, k))


def flat(value: Value) -> list[Series]:
    """Return the components of a value in order, row by row."""
    return [value] if isinstance(value, Series) else [s for part in value for s in flat(part)]


def _sum_of(values: list[Value]) -> Value:
    result = values[0]
    for value in values[1:]:
        result = series.entrywise(operator.add, result, value)
    return result


def _add(e: Evaluator, term: Term, env: Env) -> Value:
    return _sum_of([e.value(a, env) for a in term.args])


def _mul(e: Evaluator, term: Term, env: Env) -> Value:
    result = e.value(term.args[-1], env)
    for a in term.args[:-1]:
        factor = e.value(a, env)
        result = series.each(lambda x, f=factor: f * x, result)  # type: ignore[misc]
    return result


def _dot(e: Evaluator, term: Term, env: Env) -> Value:
    a, b = (e.value(x, env) for x in term.args)
    kinds = tuple(x.kind for x in term.args)
    if kinds == ("vector", "vector"):
        return series.dot(a, b)
    if kinds == ("dyadic", "vector"):
        return series.apply(a, b)
    return series.apply(series.transpose(b), a) if kinds[0] == "vector" else series.product(a, b)


def _cross(e: Evaluator, term: Term, env: Env) -> Value:
    return series.cross(*(e.value(x, env) for x in term.args))


def _outer(e: Evaluator, term: Term, env: Env) -> Value:
    a, b = (e.value(x, env) for x in term.args)
    return tuple(tuple(x * y for y in b) for x in a)


def _der(e: Evaluator, term: Term, env: Env) -> Value:
    """Differentiate the components in the frame, and come back."""
    (inside,) = term.args
    value = e.value(inside, env)
    frame = term.data[0]
    if inside.kind in {"vector", "dyadic"} and frame != "I":
        local = series.each(Series.derivative, _turned(e.world.rotation(frame, "I"), value))
        return _turned(e.world.rotation("I", frame), local)
    return series.each(Series.derivative, value)


def _turned(C: series.Matrix, value: Value) -> Value:
    """Components of a vector or dyadic after a change of frame."""
    if isinstance(value[0], Series):
        return series.apply(C, value)
    return series.product(series.product(C, value), series.transpose(C))


def _since(e: Evaluator, term: Term, env: Env) -> Value:
    return series.each(Series.primitive, e.value(term.args[0], env))


def _start(e: Evaluator, term: Term, env: Env) -> Value:
    return series.each(lambda x: e.world.constant(x.coefficients[0]), e.value(term.args[0], env))


def _at(_: Evaluator, term: Term, __: Env) -> Value:
    raise InputError("only a system says when this is", got=term.data[0])


def _partial(e: Evaluator, term: Term, env: Env) -> Value:
    """Return the slope by a coordinate or one of its rates, of what stands on them."""
    inside, by = term.args
    name, order = variable(e.scalars, by)
    if e.world.field == SIGNED:
        raise NoSlope("no slope is known where numbers have a sign", got=f"one by {name}")
    if order == 0 and name in e.world.memo.get(CONFIGURED, ()) and _is_place(inside, env):
        return slope_of_place(e.world, env[inside.data[1]], name)
    if e.beside is not None:
        raise NoSlope("no slope is known of a slope", got=f"one by {name}")
    if any(n.head in _AT_A_TIME for n in nodes(inside)):
        raise NoSlope("no slope is known of a value at one instant", got=inside.head)
    return slope(order, lambda power: e.varied(name, power).value(inside, env))


def _is_place(term: Term, env: Env) -> bool:
    """Return whether this is the place of one of the particles."""
    return term.data[:1] == ("position",) and term.data[1] in env and term.data[2] == ORIGIN


_AT_A_TIME = frozenset({"start", "since", "at"})


def _sum(e: Evaluator, term: Term, env: Env) -> Value:
    index = term.data[0]
    over = term.data[1] if term.head == "sum" else "mass"
    values = []
    for n in range(e.world.count(over)):
        value = e.value(term.args[0], {**env, index: n})
        if over == "mass":
            weight = e.world.masses[n]
            value = series.each(lambda x, w=weight: w * x, value)  # type: ignore[misc]
        values.append(value)
    return _sum_of(values)


def _column(e: Evaluator, term: Term, env: Env) -> Value:
    return _turned(e.world.rotation(term.data[0], "I"), e.value(term.args[0], env))


def _matmul(e: Evaluator, term: Term, env: Env) -> Value:
    a, b = (e.value(x, env) for x in term.args)
    return series.product(a, b) if term.kind == "matrix" else series.apply(a, b)


def _entries(e: Evaluator, term: Term, env: Env) -> Value:
    values = [e.value(a, env) for a in term.args]
    return (
        tuple(values) if len(values) == 3 else (*map(tuple, (values[:3], values[3:6], values[6:])),)
    )


def _table(e: Evaluator, term: Term, env: Env) -> Value:
    values, columns = [e.value(a, env) for a in term.args], term.data[1]
    return tuple(tuple(values[k : k + columns]) for k in range(0, len(values), columns))


def _zero(e: Evaluator, term: Term, _: Env) -> Value:
    nought = e.world.constant(0)
    vector = (nought,) * 3
    return {"vector": vector, "column": vector}.get(term.kind, (vector,) * 3)


def _atom(e: Evaluator, term: Term, env: Env) -> Value:
    """Return the value of a quantity, which is that of every statement about the world."""
    name, *labels = term.data
    defined = definition(term)
    if defined is None:
        return e.world.primitive(name, tuple(env.get(label, label) for label in labels))
    return e.value(defined, {label: env[label] for label in labels if label in env})


def _inner(e: Evaluator, term: Term, env: Env) -> Value:
    return series.dot(*(e.value(x, env) for x in term.args))


_RULES: dict[str, Callable[[Evaluator, Term, Env], Value]] = {
    "expr": lambda e, t, env: e.scalar(t.data[0], env),
    "zero": _zero,
    "atom": _atom,
    "add": _add,
    "mul": _mul,
    "dot": _dot,
    "cross": _cross,
    "outer": _outer,
    "der": _der,
    "start": _start,
    "since": _since,
    "at": _at,
    "partial": _partial,
    "sum": _sum,
    "integral": _sum,
    "column": _column,
    "matmul": _matmul,
    "transpose": lambda e, t, env: series.transpose(e.value(t.args[0], env)),
    "inverse": lambda e, t, env: series.inverse(e.value(t.args[0], env)),
    "tilde": lambda e, t, env: series.skew(e.value(t.args[0], env)),
    "inner": _inner,
    "outer_column": _outer,
    "entries": _entries,
    "table": _table,
    "rows": lambda e, t, env: tuple(e.value(a, env) for a in t.args),
}
"""One rule a head."""
