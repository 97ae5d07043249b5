"""Folding rules: identities of real arithmetic that leave fewer or cheaper operations.

Each rule of `RULES` takes the builder and the arguments of an operation and returns the number of
an equal value, or None. Rules hold for all finite arguments for which the left side has a value;
``0 * x = 0`` therefore forgets the NaN that an infinite x would give, and ``x / y * y = x`` that of a
y that is zero. Constants are exact fractions and stay exact; a result of more
than `MAX_BITS` bits is left to the target, which rounds it once from 50 digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any, Protocol

from codegen.ops import Instruction

MAX_BITS = 1024


class Numbers(Protocol):
    """What a rule needs of a builder: look at instructions, and append more."""

    instructions: list[Instruction]

    def add(self, op: str, *args: int) -> int:
        """Return the number of ``op`` on ``args``."""

    def find(self, instruction: Instruction) -> int | None:
        """Return the number of an instruction that exists already, or None."""

    def const(self, value: Fraction | int) -> int:
        """Return the number of an exact constant."""


Rule = Callable[[Numbers, tuple[int, ...]], int | None]


def fold(b: Numbers, op: str, args: tuple[int, ...]) -> int | None:
    """Return an equal, simpler value of ``op`` on ``args`` if a rule knows one."""
    evaluate = _EXACT.get(op)
    if evaluate is not None:
        constants = []
        for a in args:
            c = constant(b, a)
            if c is None:
                break
            constants.append(c)
        else:
            value = evaluate(*constants)
            if value is not None and _small(value):
                return b.const(value)
    rule = RULES.get(op)
    return rule(b, args) if rule else None


def constant(b: Numbers, number: int) -> Fraction | None:
    """Return the exact constant that ``number`` is, or None."""
    op, _, value = b.instructions[number]
    return value if op == "const" and isinstance(value, Fraction) else None


def _small(value: Fraction) -> bool:
    return max(abs(value.numerator).bit_length(), value.denominator.bit_length()) <= MAX_BITS


def _negated(b: Numbers, number: int) -> int | None:
    """Return x if ``number`` is -x."""
    op, args, _ = b.instructions[number]
    return args[0] if op == "neg" else None


def _add(b: Numbers, args: tuple[int, ...]) -> int | None:
    for x, y in (args, args[::-1]):
        op, inner, c = b.instructions[x]
        if op == "const" and not c:
            return y
        if op == "neg":
            return b.add("sub", y, inner[0])
    return None


def _sub(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = args
    if x == y:
        return b.const(0)
    op, inner, c = b.instructions[y]
    if op == "const" and not c:
        return x
    if op == "neg":
        return b.add("add", x, inner[0])
    op, inner, c = b.instructions[x]
    if op == "const" and not c:
        return b.add("neg", y)
    if op == "neg":
        return b.add("neg", b.add("add", inner[0], y))
    opposite = b.find(Instruction("sub", (y, x)))
    return None if opposite is None else b.add("neg", opposite)


def _mul(b: Numbers, args: tuple[int, ...]) -> int | None:
    for x, y in (args, args[::-1]):
        op, inner, c = b.instructions[x]
        if op == "const" and isinstance(c, Fraction) and c.denominator == 1:
            if c.numerator == 0:
                return x
            if c.numerator == 1:
                return y
            if c.numerator == -1:
                return b.add("neg", y)
        elif op == "neg":
            return b.add("neg", b.add("mul", inner[0], y))
        elif op == "div" and inner[1] == y:
            return inner[0]
    return None


def _div(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = args
    c = constant(b, y)
    if c == 1 or (constant(b, x) == 0 and c != 0):
        return x
    if c is not None and c < 0:
        return b.add("neg", b.add("div", x, b.const(-c)))
    if c and _power_of_two(c):
        return b.add("mul", x, b.const(1 / c))
    for k, number in enumerate(args):
        negative = _negated(b, number)
        if negative is not None:
            rest = (negative, y) if k == 0 else (x, negative)
            return b.add("neg", b.add("div", *rest))
    return None


def _power_of_two(value: Fraction) -> bool:
    return (value.numerator & (value.numerator - 1)) == 0 and (
        value.denominator & (value.denominator - 1)
    ) == 0


def _neg(b: Numbers, args: tuple[int, ...]) -> int | None:
    """Undo a negation, or take it into the constant of a product."""
    op, factors, _ = b.instructions[args[0]]
    if op == "mul":
        for x, y in (factors, factors[::-1]):
            c = constant(b, x)
            if c is not None:
                return b.add("mul", b.const(-c), y)
    return _negated(b, args[0])


def _odd(op: str) -> Rule:
    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        negative = _negated(b, args[0])
        return None if negative is None else b.add("neg", b.add(op, negative))

    return rule


def _even(op: str) -> Rule:
    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        negative = _negated(b, args[0])
        return None if negative is None else b.add(op, negative)

    return rule


def _select(b: Numbers, args: tuple[int, ...]) -> int | None:
    c, x, y = args
    known = constant(b, c)
    if known is not None:
        return x if known else y
    return x if x == y else None


def _same(b: Numbers, args: tuple[int, ...]) -> int | None:  # noqa: ARG001
    return args[0] if args[0] == args[1] else None


def _sqrt(value: Fraction) -> Fraction | None:
    if value < 0:
        return None
    root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
    return root if root * root == value else None


def _at(point: int, value: int) -> Callable[[Fraction], Fraction | None]:
    """The value of a function at the one rational point where it is rational."""
    return lambda x: Fraction(value) if x == point else None


RULES: dict[str, Rule] = {
    "add": _add,
    "sub": _sub,
    "mul": _mul,
    "div": _div,
    "neg": _neg,
    "select": _select,
    "min": _same,
    "max": _same,
    "and": _same,
    "or": _same,
    **{
        op: _odd(op)
        for op in ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh", "sign")
    },
    **{op: _even(op) for op in ("cos", "cosh", "abs")},
}

_EXACT: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b if b else None,
    "neg": lambda a: -a,
    "abs": abs,
    "sign": lambda a: Fraction((a > 0) - (a < 0)),
    "min": min,
    "max": max,
    "lt": lambda a, b: Fraction(a < b),
    "le": lambda a, b: Fraction(a <= b),
    "eq": lambda a, b: Fraction(a == b),
    "and": lambda a, b: Fraction(bool(a) and bool(b)),
    "or": lambda a, b: Fraction(bool(a) or bool(b)),
    "not": lambda a: Fraction(not a),
    "sqrt": _sqrt,
    **{op: _at(0, 0) for op in ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh")},
    **{op: _at(0, 1) for op in ("cos", "cosh", "exp")},
    "log": _at(1, 0),
    "acos": _at(1, 0),
    "acosh": _at(1, 0),
}
"""Operations that are evaluated exactly on exact constants."""
