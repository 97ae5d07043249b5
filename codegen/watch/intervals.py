"""Bounds of the values of a program while its leaves move between bounds, as further instructions.

One row an operation: from the bounds of the arguments to those of the value (Moore, Interval Analysis,
1966). What depends on parameters alone has equal bounds, which are one instruction, so that only what
moves costs anything. Rounding is not added to the bounds: they serve to find places, to within rounding.
A condition has the bounds 0 and 1 where it may be either; an operation without a row has no bounds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from codegen.ir import scalars
from codegen.ir.ops import OPS, Instruction
from codegen.ir.program import Builder, Program
from codegen.ir.scalars import Scalar, apply, maximum, minimum, where
from eom.tables import Table

HUGE = Fraction(2) ** 1000
"""Stands for a bound that is infinite."""


@dataclass(frozen=True)
class Interval:
    """The least and the largest value; equal scalars for what does not move."""

    low: Scalar
    high: Scalar

    @property
    def is_point(self) -> bool:
        """Whether it does not move."""
        return self.low == self.high


def pieces_of(table: Table) -> Table:
    """Return a table with one value for each polynomial of another one: its number, from 1 on.

    It is the derivative of a polygon over the same breakpoints, whose slopes are the numbers.
    """
    known = table.breakpoints
    apart = max(known[-1] - known[0], abs(known[0]), abs(known[-1]))
    places = (known[0] - apart, *known, known[-1] + apart)
    values = [Fraction(0)]
    for k in range(1, len(places)):
        values.append(values[-1] + k * (Fraction(places[k]) - Fraction(places[k - 1])))
    polygon = Table(
        f"pieces of {table.name}", places, tuple(map(float, values)), "linear", "linear"
    )
    return replace(polygon, order=1)


def number_of_piece(table: Table, x: Scalar) -> Scalar:
    """Return the number of the polynomial of a table that holds at ``x``."""
    b = x.builder
    return Scalar(b, b.add("table", x.number, value=pieces_of(table)))


Rule = Callable[..., Interval | None]


def _rising(op: str) -> Rule:
    return lambda a: Interval(apply(op, a.low), apply(op, a.high))


def _falling(op: str) -> Rule:
    return lambda a: Interval(apply(op, a.high), apply(op, a.low))


def _of(*candidates: Scalar) -> Interval:
    low = high = candidates[0]
    for c in candidates[1:]:
        low, high = minimum(low, c), maximum(high, c)
    return Interval(low, high)


def _within(least: int | None, most: int | None, rule: Rule) -> Rule:
    """Of a function with a domain: arguments beyond it have no value, and no part in the bounds."""

    def cut(x: Scalar) -> Scalar:
        x = x if least is None else maximum(x, least)
        return x if most is None else minimum(x, most)

    return lambda a: rule(Interval(cut(a.low), cut(a.high)))


def _straddles(a: Interval, place: Scalar | int = 0) -> Scalar:
    return apply("and", a.low <= place, place <= a.high)


def _even(op: str) -> Rule:
    """Of a function that is least at zero and even."""

    def rule(a: Interval) -> Interval:
        ends = _of(apply(op, a.low), apply(op, a.high))
        return Interval(where(_straddles(a), apply(op, a.low * 0), ends.low), ends.high)

    return rule


def _square(a: Interval) -> Interval:
    ends = _of(a.low * a.low, a.high * a.high)
    return Interval(where(_straddles(a), 0, ends.low), ends.high)


def _mul(a: Interval, b: Interval) -> Interval:
    if a == b:
        return _square(a)
    if a.is_point or b.is_point:
        one, other = (a, b) if a.is_point else (b, a)
        return _of(one.low * other.low, one.low * other.high)
    return _of(a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high)


def _div(a: Interval, b: Interval) -> Interval:
    inverse = _of(1 / b.low, 1 / b.high)
    pole = _straddles(b)
    return _mul(a, Interval(where(pole, -HUGE, inverse.low), where(pole, HUGE, inverse.high)))


def _pow(a: Interval, y: Interval) -> Interval | None:
    """Monotone on each side of zero; the exponent must not move."""
    if not y.is_point:
        return None
    ends = _of(a.low**y.low, a.high**y.low)
    inside = _straddles(a)
    return Interval(
        where(inside, where(y.low < 0, -HUGE, minimum(ends.low, 0)), ends.low),
        where(inside, where(y.low < 0, HUGE, maximum(ends.high, 0)), ends.high),
    )


def _wave(op: str, top: Fraction) -> Rule:
    """Of sine and cosine: 1 where a multiple of 2 pi beside ``top`` pi lies within, -1 likewise."""

    def reached(a: Interval, place: Fraction) -> Scalar:
        turn = 2 * Scalar(a.low.builder, a.low.builder.leaf("pi"))
        turns = [apply("floor", x / turn - place / 2) for x in (a.low, a.high)]
        passed: Scalar = turns[0] < turns[1]
        return passed

    def rule(a: Interval) -> Interval:
        ends = _of(apply(op, a.low), apply(op, a.high))
        return Interval(
            where(reached(a, top + 1), -1, ends.low), where(reached(a, top), 1, ends.high)
        )

    return rule


def _tan(a: Interval) -> Interval:
    pi = Scalar(a.low.builder, a.low.builder.leaf("pi"))
    turns = [apply("floor", x / pi + Fraction(1, 2)) for x in (a.low, a.high)]
    pole = turns[0] < turns[1]
    low, high = apply("tan", a.low), apply("tan", a.high)
    return Interval(where(pole, -HUGE, low), where(pole, HUGE, high))


def _hypot(a: Interval, b: Interval) -> Interval:
    one, other = _square(a), _square(b)
    return Interval(scalars.sqrt(one.low + other.low), scalars.sqrt(one.high + other.high))


def _atan2(y: Interval, x: Interval) -> Interval:
    """By the four corners, but where the half line of the jump is within reach."""
    corners = _of(*(scalars.atan2(v, w) for v in (y.low, y.high) for w in (x.low, x.high)))
    jumps = apply("and", _straddles(y), x.low <= 0)
    pi = Scalar(y.low.builder, y.low.builder.leaf("pi"))
    return Interval(where(jumps, -pi, corners.low), where(jumps, pi, corners.high))


def _lt(a: Interval, b: Interval) -> Interval:
    return Interval(a.high < b.low, a.low < b.high)


def _le(a: Interval, b: Interval) -> Interval:
    return Interval(a.high <= b.low, a.low <= b.high)


def _eq(a: Interval, b: Interval) -> Interval:
    still = apply("and", scalars.equal(a.low, a.high), scalars.equal(b.low, b.high))
    return Interval(
        apply("and", still, scalars.equal(a.low, b.low)),
        apply("and", a.low <= b.high, b.low <= a.high),
    )


def _both(op: str) -> Rule:
    return lambda a, b: Interval(apply(op, a.low, b.low), apply(op, a.high, b.high))


def _select(c: Interval, a: Interval, b: Interval) -> Interval:
    either = _of(a.low, a.high, b.low, b.high)
    return Interval(
        where(c.low, a.low, where(c.high, either.low, b.low)),
        where(c.low, a.high, where(c.high, either.high, b.high)),
    )


def _mod(a: Interval, b: Interval) -> Interval | None:
    if not b.is_point:
        return None
    turns = [apply("floor", x / b.low) for x in (a.low, a.high)]
    jumps = turns[0] < turns[1]
    ends = _of(apply("mod", a.low, b.low), apply("mod", a.high, b.low))
    return Interval(
        where(jumps, minimum(b.low, 0), ends.low), where(jumps, maximum(b.low, 0), ends.high)
    )


RULES: Mapping[str, Rule] = {
    "add": lambda a, b: Interval(a.low + b.low, a.high + b.high),
    "sub": lambda a, b: Interval(a.low - b.high, a.high - b.low),
    "neg": lambda a: Interval(-a.high, -a.low),
    "mul": _mul,
    "div": _div,
    "pow": _pow,
    "sqrt": _within(0, None, _rising("sqrt")),
    "log": _within(0, None, _rising("log")),
    "log1p": _within(-1, None, _rising("log1p")),
    "acosh": _within(1, None, _rising("acosh")),
    "asin": _within(-1, 1, _rising("asin")),
    "acos": _within(-1, 1, _falling("acos")),
    "atanh": _within(-1, 1, _rising("atanh")),
    "erfc": _falling("erfc"),
    "sin": _wave("sin", Fraction(1, 2)),
    "cos": _wave("cos", Fraction(0)),
    "tan": _tan,
    **{op: _rising(op) for op in ("exp", "expm1", "tanh", "sinh", "atan", "asinh", "erf", "floor", "sign")},
    **{op: _even(op) for op in ("cosh", "abs")},
    "hypot": _hypot,
    "atan2": _atan2,
    "min": _both("min"),
    "max": _both("max"),
    "lt": _lt,
    "le": _le,
    "eq": _eq,
    "and": _both("and"),
    "or": _both("or"),
    "not": _falling("not"),
    "select": _select,
    "mod": _mod,
}  # fmt: skip
"""From the bounds of arguments to those of a value."""


def _table(table: Table, a: Interval) -> Interval | None:
    """A polygon lies between its corners; within one piece its ends are its bounds."""
    if table.kind != "linear" or table.order:
        return None
    b = a.low.builder
    ends = _of(*(Scalar(b, b.add("table", x.number, value=table)) for x in (a.low, a.high)))
    pieces = [number_of_piece(table, x) for x in (a.low, a.high)]
    one = scalars.equal(*pieces)
    low, high = (Fraction(f(table.values)) for f in (min, max))
    return Interval(
        where(one, ends.low, minimum(ends.low, low)),
        where(one, ends.high, maximum(ends.high, high)),
    )


def bounds(
    program: Program,
    b: Builder,
    leaves: Callable[[Instruction], Interval | None],
    wanted: Sequence[int],
) -> dict[int, Interval | None]:
    """Return the bounds of the values ``wanted`` of a program, built in ``b``.

    ``leaves``: the bounds of a leaf, None where there are none. A value that has none is None. Law: while
    every leaf is within its bounds, every value is within its own, up to rounding.
    """
    found: dict[int, Interval | None] = {}
    for k in wanted:
        instruction = program.instructions[k]
        if instruction.op not in OPS:
            found[k] = leaves(instruction)
            continue
        args = [found[a] for a in instruction.args]
        found[k] = _bounds_of(b, instruction, args)
    return found


def _bounds_of(
    b: Builder, instruction: Instruction, args: Sequence[Interval | None]
) -> Interval | None:
    known = [a for a in args if a is not None]
    if len(known) < len(args) or not known:
        return None
    op, table = instruction.op, instruction.value
    if all(a.is_point for a in known):
        value = Scalar(b, b.add(op, *(a.low.number for a in known), value=table))
        return Interval(value, value)
    if isinstance(table, Table):
        return _table(table, known[0])
    return RULES[op](*known) if op in RULES else None
