"""Letters in terms of others: equations are solved one by one, each for a letter that it is linear in."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import sympy as sp
from mpmath import MPContext

from eom.checker.consequence.jets import (
    CHANGES,
    MAY,
    Equal,
    Expr,
    is_component,
    letter,
    partial,
    rate,
    timed,
)
from eom.errors import InputError

Number = Any
DIGITS = 40
MP = MPContext()
MP.dps = DIGITS
POINTS, MAX_SEEDS = 3, 24
MAX_OPERATIONS = 8000
MAX_ROUNDS = 60
MAX_SOLVED, MAX_TOGETHER = 1200, 300
"""Parts of equations that are solved, and of those that are brought to one denominator."""


@dataclass(frozen=True)
class Rule:
    """What a letter, or a derivative of it, is equal to, by which formulas."""

    name: str
    order: int
    value: Expr
    sources: frozenset[int]
    squared: bool = False
    """Whether it is a root that was taken."""
    given: bool = False
    """Whether the letter stands alone on a side of its equation."""


@dataclass
class Rules:
    """Letters in terms of others, in which none of them stands again."""

    known: dict[str, Rule] = field(default_factory=dict)
    signs: list[Equal] = field(default_factory=list)
    """Equations that say which root of a square is meant."""
    memo: dict[Expr, tuple[Expr, frozenset[int]]] = field(default_factory=dict)
    drawn: dict[int, list[Point]] = field(default_factory=dict)
    """Points, by how many equations say which root is meant there."""

    kept: dict[Any, Any] = field(default_factory=dict)
    """What else was found of these rules."""

    def copy(self) -> Rules:
        """Return the same rules, to which others may be added."""
        return Rules(dict(self.known), list(self.signs))

    def add(self, rule: Rule) -> None:
        """Take in a rule for a letter that has none."""
        self.known[rule.name] = rule
        self.memo, self.drawn, self.kept = {}, {}, {}

    def normal(self, e: Expr) -> tuple[Expr, frozenset[int]]:
        """Return an expression in letters that are free, and the formulas that this rests on.

        Raises `InputError` where it gets too long.
        """
        used: frozenset[int] = frozenset()
        for _ in range(MAX_ROUNDS):
            e, more = _worked_out(e, self)
            used |= more
            found = {s: self._value(s) for s in e.free_symbols if self._is_known(s)}
            if not found:
                return e, used
            e = e.xreplace({s: v for s, (v, _) in found.items()})
            used = used.union(*(u for _, u in found.values()))
            if size(e, MAX_OPERATIONS) > MAX_OPERATIONS:
                break
        raise InputError("too long a formula")

    def full(self, s: Expr) -> Expr:
        """Return a letter in letters that are free. Raises `InputError` where it gets too long."""
        if s not in self.kept:
            self.kept[s] = self.normal(s)[0]
        return self.kept[s]

    def _is_known(self, s: Expr) -> bool:
        known = letter(s)
        rule = None if known is None else self.known.get(known.name)
        return known is not None and rule is not None and known.order >= rule.order

    def _value(self, s: Expr) -> tuple[Expr, frozenset[int]]:
        if s not in self.memo:
            known = letter(s)
            assert known is not None
            rule = self.known[known.name]
            value = rule.value
            for _ in range(known.order - rule.order):
                value = rate(value)
            self.memo[s] = value, rule.sources
        return self.memo[s]


def _worked_out(e: Expr, rules: Rules) -> tuple[Expr, frozenset[int]]:
    """Return an expression with its partial derivatives, each of what is written in free letters."""
    used: frozenset[int] = frozenset()
    while e.has(partial, timed):
        node = next(n for n in sp.postorder_traversal(e) if isinstance(n, partial | timed))
        f, more = rules.normal(node.args[0])
        used |= more
        if isinstance(node, timed):
            e = e.xreplace({node: rate(f)})
        elif node.args[1].is_Symbol:
            e = e.xreplace({node: f.diff(node.args[1])})
        else:
            raise InputError("a derivative by what is no letter")
    return e, used


def size(e: Expr, most: int) -> int:
    """Return how many parts an expression has, counted up to a number."""
    todo, found = [e], 0
    while todo and found <= most:
        found += 1
        todo += todo.pop().args
    return found


# -- values ------------------------------------------------------------------------------------------


@dataclass
class Point:
    """Numbers for all letters that are free, and what the others are then."""

    rules: Rules
    seed: int
    values: dict[Expr, Number] = field(default_factory=dict)
    scale: Number = 1
    """By how much letters with dots are smaller than others."""

    def sides(self, q: Equal) -> tuple[Number, Number]:
        """Return the values of both sides."""
        return self.of(q.left), self.of(q.right)

    def of(self, e: Expr) -> Number:
        """Return the value of an expression. Raises `InputError`, `ZeroDivisionError`."""
        e = _worked_out(e, self.rules)[0]
        return evaluated(e, {s: self._letter(s) for s in e.free_symbols})

    def _letter(self, s: Expr) -> Number:
        if s not in self.values:
            full = self.rules.full(s)
            self.values[s] = self._drawn(s) if full == s else self.of_free(full)
        return self.values[s]

    def of_free(self, e: Expr) -> Number:
        """Return the value of an expression in free letters."""
        return evaluated(
            e, {s: self._letter(s) if s == e else self._any(s) for s in e.free_symbols}
        )

    def _any(self, s: Expr) -> Number:
        if s not in self.values:
            self.values[s] = self._drawn(s)
        return self.values[s]

    def _drawn(self, s: Expr) -> Number:
        known = letter(s)
        if known is not None and known.kind == MAY and known.order:
            return MP.zero
        name = (
            f"{self.seed} {known.name} {known.order}" if known is not None else f"{self.seed} {s}"
        )
        generator = random.Random(name)  # noqa: S311 - reproducible, no secret
        value = MP.mpf(generator.randrange(10**6, 10**7)) / (7 * 10**6 + 3)
        return value * self.scale if known is not None and known.kind == CHANGES else value


_FUNCTIONS: Mapping[Any, Callable[..., Number]] = {
    sp.Add: lambda *a: MP.fsum(a),
    sp.Mul: lambda *a: MP.fprod(a),
    sp.Pow: MP.power,
    **{f: getattr(MP, f.__name__) for f in (sp.sin, sp.cos, sp.tan, sp.cot, sp.exp, sp.log, sp.atan,
                                           sp.asin, sp.acos, sp.sinh, sp.cosh, sp.tanh)},
    sp.Abs: abs,
}  # fmt: skip


def evaluated(e: Expr, values: Mapping[Expr, Number]) -> Number:
    """Return the value of an expression to many digits. Raises `InputError` for what has none."""
    if e in values:
        return values[e]
    if e.is_Rational:
        return MP.mpf(e.p) / e.q
    if e is sp.I:
        return MP.mpc(0, 1)
    if e.is_number and not e.args and e.is_finite:
        return MP.mpf(str(e.evalf(DIGITS)))
    rule = _FUNCTIONS.get(e.func)
    if rule is None or not e.args:
        raise InputError("this has no value", got=e)
    return rule(*(evaluated(a, values) for a in e.args))


def points(rules: Rules) -> list[Point]:
    """Return points in general position, at which roots of squares have their signs."""
    key = len(rules.signs)
    if key not in rules.drawn:
        all_ = (Point(rules, seed) for seed in range(MAX_SEEDS))
        fit = (p for p in all_ if all(_equal(q, p) for q in rules.signs))
        rules.drawn[key] = list(islice(fit, POINTS))
    return rules.drawn[key]


def agrees(q: Equal, at: Sequence[Point]) -> bool:
    """Return whether two sides are equal at all points. Raises `InputError` where they have no values."""
    return len(at) == POINTS and all(_equal(q, p) for p in at)


def _equal(q: Equal, at: Point) -> bool:
    terms = [at.of(t) for e in (q.left, -q.right) for t in sp.Add.make_args(e)]
    return bool(abs(MP.fsum(terms)) <= MP.mpf(10) ** -25 * (sum(map(abs, terms)) + FLOOR))


FLOOR = 1e-6
"""What counts as nothing beside values that are of the order of one."""


def agrees_nearly(q: Equal, rules: Rules) -> bool:
    """Return whether two sides differ by less than the first order of small motions, and not in all."""
    at = [Point(rules, seed, scale=LITTLE) for seed in range(POINTS)]
    for p in at:
        terms = [p.of(t) for e in (q.left, -q.right) for t in sp.Add.make_args(e)]
        largest = max(map(abs, terms))
        if largest == 0 or abs(MP.fsum(terms)) > ROUGH * min(LITTLE, largest):
            return False
    return True


LITTLE, ROUGH = MP.mpf(10) ** -8, 1e-4
"""How small motions are, and which part of them is nothing."""


def agrees_but_for_signs(q: Equal, at: Sequence[Point]) -> bool:
    """Return whether a side that is a letter, known by its square, is equal to the other up to its sign."""
    known = letter(q.left) or letter(q.right)
    rule = at[0].rules.known.get(known.name) if known and at else None
    if rule is None or not rule.squared or len(at) < POINTS:
        return False
    return all(_same(a * a, b * b) for a, b in (p.sides(q) for p in at))


def _same(a: Number, b: Number) -> bool:
    return bool(abs(a - b) <= MP.mpf(10) ** -25 * (abs(a) + abs(b)))


# -- solving -----------------------------------------------------------------------------------------


def solved(q: Equal, rules: Rules, number: int, new: frozenset[str]) -> Rule | None:
    """Return the rule that an equation makes, for the letter that it says most of; None for none.

    A letter that stands alone and is ``new`` goes first, then other new ones, highest derivatives, others.
    None where it would have to vanish and the equation does not say so: what is known contradicts it.
    """
    whole, used = rules.normal(q.left - q.right)
    if q.whole is not None and is_component(q.left) and q.left not in q.right.free_symbols:
        known = letter(q.left)
        value, sources = rules.normal(q.right)
        names = {k.name for k in map(letter, value.free_symbols) if k is not None}
        if known is not None and known.name not in names | rules.known.keys():
            return Rule(known.name, known.order, value, sources | {number})
    most = MAX_SOLVED if q.whole is None else MAX_TOGETHER
    length = size(whole, most)
    if length > most:
        return None
    zero = sp.numer(sp.together(whole)) if length <= MAX_TOGETHER else whole
    for s in sorted(filter(letter, whole.free_symbols), key=lambda s: _rank(s, q, new)):
        known = letter(s)
        assert known is not None
        others = {letter(o) for o in whole.free_symbols - {s}}
        if any(o and o.name == known.name and o.order >= known.order for o in others):
            continue
        found = _alone(zero, s)
        if found is not None:
            value, squared = found
            if not (q.left == 0 or q.right == 0) and abs(Point(Rules(), 0).of(value)) < FLOOR**2:
                return None
            return Rule(known.name, known.order, value, used | {number}, squared=squared)
    return None


def _rank(s: Expr, q: Equal, new: frozenset[str]) -> tuple[bool, bool, bool, bool, int, str]:
    known = letter(s)
    assert known is not None
    alone = s in {q.left, q.right}
    return (
        not (q.whole is not None and s == q.left and is_component(s)),
        not (alone and known.name in new),
        known.name not in new,
        not known.moving,
        -known.order,
        known.name,
    )


def _alone(zero: Expr, s: Expr) -> tuple[Expr, bool] | None:
    """Return what a symbol is where an expression vanishes that is linear in it, or in its square: which.

    Whether it is, is asked at a point.
    """
    if sp.S.Zero in (zero.diff(s), zero):
        return None
    others = Point(Rules(), 0)
    try:
        low, zeroth, one, two = (
            others.of(zero.xreplace({s: sp.Integer(k)})) for k in (-1, 0, 1, 2)
        )
    except (InputError, ZeroDivisionError):
        return None
    slope = one - zeroth
    linear = _same(two - zeroth, 2 * slope) and _same(low - zeroth, -slope)
    squared = _same(two - zeroth, 4 * slope) and _same(low, one)
    if slope == 0 or not (linear or squared):
        return None
    first = zero.xreplace({s: sp.S.Zero})
    value = -first / (zero.xreplace({s: sp.S.One}) - first)
    return (sp.sqrt(value) if squared else value), squared


def lone(q: Equal) -> Iterator[str]:
    """Yield the letters that stand alone on a side and not on the other."""
    for side, other in ((q.left, q.right), (q.right, q.left)):
        known = letter(side)
        if known is not None and not known.order and side not in other.free_symbols:
            yield known.name
