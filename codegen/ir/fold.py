"""Folding rules: identities that leave fewer or cheaper operations, as a table of laws.

A law is ``exact`` if it holds bit for bit in IEEE arithmetic, for NaN, infinities and signed zeros
too (the sign and payload of NaN aside); else it is a law of real arithmetic, for finite arguments:
``0 x = 0`` forgets the NaN that an infinite x would give. The rule set ``algebraic`` holds all laws,
``exact`` the exact ones alone. In either, constants are exact fractions and stay exact, and what
they give alone is rounded once, to +0 where it is zero; a result of more than `MAX_BITS` bits is
left to the target, which rounds it from 50 digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple, Protocol

from codegen.ir.ops import TRUTH_VALUES, Instruction

MAX_BITS = 1024
MAX_UNROLLED_POWER = 64
_NONE: list[Any] = [None, None, None]
MAX_EXPONENT = 1022
"""Powers of two up to it and their reciprocals are doubles without loss."""


class Instructions(Protocol):
    """Whatever has instructions: a builder, or a program."""

    @property
    def instructions(self) -> Sequence[Instruction]:
        """The instructions in order."""


class Numbers(Instructions, Protocol):
    """What a rule needs of a builder: look at instructions, and append more."""

    def add(self, op: str, *args: int) -> int:
        """Return the number of ``op`` on ``args``."""

    def find(self, instruction: Instruction) -> int | None:
        """Return the number of an instruction that exists already, or None."""

    def const(self, value: Fraction | int) -> int:
        """Return the number of an exact constant."""


Constants = Sequence[Fraction | None]
"""The exact value of each argument that is a constant."""
Rule = Callable[[Numbers, tuple[int, ...], Constants], int | None]


class Law(NamedTuple):
    """``rule`` returns the number of the right side where an operation has the form of the left.

    ``among``: the operation that an operand must be, any if empty; the rule is not asked otherwise.
    """

    ops: tuple[str, ...]
    text: str
    exact: bool
    rule: Rule
    among: str = ""


@dataclass(frozen=True, eq=False)
class RuleSet:
    """The laws of each operation, in the order in which their rules are asked."""

    name: str
    laws: Mapping[str, tuple[Law, ...]] = field(repr=False)
    _asked: dict[tuple[str, ...], tuple[Rule, ...]] = field(
        default_factory=dict, init=False, repr=False
    )

    def asked(self, form: tuple[str, ...]) -> tuple[Rule, ...]:
        """Return the rules of an operation on operands of some operations, ``form`` in this order."""
        known = self._asked.get(form)
        if known is None:
            op, *operands = form
            laws = self.laws.get(op, ())
            known = tuple(law.rule for law in laws if not law.among or law.among in operands)
            self._asked[form] = known
        return known


def fold(b: Numbers, op: str, args: tuple[int, ...], rules: RuleSet) -> int | None:
    """Return an equal, simpler value of ``op`` on ``args`` if a rule knows one."""
    if op not in _FOLDED:
        return None
    instructions, constants = b.instructions, _NONE
    if len(args) == 2:  # most operations; a comprehension takes longer than all the rest
        x, y = args
        form: tuple[str, ...] = (op, instructions[x][0], instructions[y][0])
    else:
        form = (op, *[instructions[a][0] for a in args])
    if "const" in form:
        constants = [constant(b, a) for a in args]
        if op in _EXACT and None not in constants:
            value = _EXACT[op](*constants)
            if value is not None and _small(value):
                return b.const(value)
    for rule in rules.asked(form):
        found = rule(b, args, constants)
        if found is not None:
            return found
    return None


def constant(b: Instructions, number: int) -> Fraction | None:
    """Return the exact constant that ``number`` is, or None."""
    op, _, value = b.instructions[number]
    return value if op == "const" and isinstance(value, Fraction) else None


def bits(value: Fraction) -> int:
    """Return the bits of numerator or denominator, of the longer one."""
    return max(value.numerator.bit_length(), value.denominator.bit_length())


def _small(value: Fraction) -> bool:
    return bits(value) <= MAX_BITS


def _negated(b: Numbers, number: int) -> int | None:
    """Return x if ``number`` is -x."""
    op, args, _ = b.instructions[number]
    return args[0] if op == "neg" else None


def _neutral(neutral: int) -> Rule:
    """The other operand where one is ``neutral``."""

    def rule(_: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
        x, y = constants
        if x is not None and x == neutral:
            return args[1]
        return args[0] if y is not None and y == neutral else None

    return rule


def _right_neutral(neutral: int) -> Rule:
    def rule(_: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
        y = constants[1]
        return args[0] if y is not None and y == neutral else None

    return rule


def _add_negative(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    x, y = args
    negative = _negated(b, x)
    if negative is not None:
        return b.add("sub", y, negative)
    negative = _negated(b, y)
    return None if negative is None else b.add("sub", x, negative)


def _sub_same(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    return b.const(0) if args[0] == args[1] else None


def _sub_from_zero(b: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    return b.add("neg", args[1]) if constants[0] is not None and constants[0] == 0 else None


def _sub_negative(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    negative = _negated(b, args[1])
    return None if negative is None else b.add("add", args[0], negative)


def _sub_both_negative(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    negative = _negated(b, args[0])
    return None if negative is None else b.add("neg", b.add("add", negative, args[1]))


def _sub_opposite(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    opposite = b.find(Instruction("sub", (args[1], args[0])))
    return None if opposite is None else b.add("neg", opposite)


def _mul_zero(_: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    x, y = constants
    if x is not None and not x:
        return args[0]
    return args[1] if y is not None and not y else None


def _mul_quotient(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    for x, y in (args, args[::-1]):
        op, inner, _value = b.instructions[x]
        if op == "div" and inner[1] == y:
            return inner[0]
    return None


def _mul_minus_one(b: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    for y, c in zip(args[::-1], constants, strict=True):
        if c is not None and c == -1:
            return b.add("neg", y)
    return None


def _negative_operand(op: str) -> Rule:
    """Take a negation of either operand out of a product or quotient."""

    def rule(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
        x, y = args
        negative = _negated(b, x)
        if negative is not None:
            return b.add("neg", b.add(op, negative, y))
        negative = _negated(b, y)
        return None if negative is None else b.add("neg", b.add(op, x, negative))

    return rule


def _div_zero(_: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    x, y = constants
    return args[0] if x is not None and x == 0 and (y is None or y != 0) else None


def _div_negative_constant(b: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    c = constants[1]
    if c is None or c >= 0:
        return None
    return b.add("neg", b.add("div", args[0], b.const(-c)))


def _div_power_of_two(b: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    c = constants[1]
    if c is None or not _power_of_two(c):
        return None
    return b.add("mul", args[0], b.const(1 / c))


def _power_of_two(value: Fraction) -> bool:
    p, q = value.numerator, value.denominator
    within = max(p.bit_length(), q.bit_length()) <= MAX_EXPONENT
    return p > 0 and within and (p & (p - 1)) == 0 and (q & (q - 1)) == 0


def _neg_of_neg(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    return _negated(b, args[0])


def _neg_of_multiple(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    op, factors, _value = b.instructions[args[0]]
    if op == "mul":
        for x, y in (factors, factors[::-1]):
            first = b.instructions[x]
            if first.op == "const" and isinstance(first.value, Fraction):
                return b.add("mul", b.const(-first.value), y)
    return None


def _odd(op: str) -> Law:
    def rule(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
        negative = _negated(b, args[0])
        return None if negative is None else b.add("neg", b.add(op, negative))

    return Law((op,), f"{op}(-x) = -{op}(x)", False, rule, "neg")


def _even(op: str, exact: bool) -> Law:
    def rule(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
        negative = _negated(b, args[0])
        return None if negative is None else b.add(op, negative)

    return Law((op,), f"{op}(-x) = {op}(x)", exact, rule, "neg")


def _select_known(_: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    c = constants[0]
    return None if c is None else args[1] if c else args[2]


def _select_same(_: Numbers, args: tuple[int, ...], __: Constants) -> int | None:
    return args[1] if args[1] == args[2] else None


def _same(_: Numbers, args: tuple[int, ...], __: Constants) -> int | None:
    return args[0] if args[0] == args[1] else None


def _pow_zero(b: Numbers, _: tuple[int, ...], constants: Constants) -> int | None:
    return b.const(1) if constants[1] is not None and constants[1] == 0 else None


def _pow_unrolled(b: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    exponent = constants[1]
    return None if exponent is None else power(b, args[0], exponent)


def power(b: Numbers, base: int, exponent: Fraction) -> int | None:
    """Return a power by products, for whole exponents and halves that are not too large, or None."""
    size = abs(exponent)
    if size == 0 or size.denominator > 2 or size > MAX_UNROLLED_POWER:
        return None
    if exponent < 0:
        below = power(b, base, size)
        assert below is not None
        return b.add("div", b.const(1), below)
    n = size.numerator // size.denominator
    result = None if size.denominator == 1 else b.add("sqrt", base)
    square = base
    while n:
        if n & 1:
            result = square if result is None else b.add("mul", result, square)
        n >>= 1
        if n:
            square = b.add("mul", square, square)
    return result


def _hypot_signs(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    plain = [n if (n := _negated(b, a)) is not None else a for a in args]
    return b.add("hypot", *plain) if plain != list(args) else None


def _hypot_zero(b: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    for y, c in zip(args[::-1], constants, strict=True):
        if c is not None and c == 0:
            return b.add("abs", y)
    return None


def _not_not(b: Numbers, args: tuple[int, ...], _: Constants) -> int | None:
    op, inner, _value = b.instructions[args[0]]
    return inner[0] if op == "not" and b.instructions[inner[0]].op in TRUTH_VALUES else None


def _eq_zero(b: Numbers, args: tuple[int, ...], constants: Constants) -> int | None:
    for x, c in zip(args[::-1], constants, strict=True):
        if c is not None and c == 0 and b.instructions[x].op in TRUTH_VALUES:
            return b.add("not", x)
    return None


LAWS: tuple[Law, ...] = (
    Law(("add",), "x + 0 = x", False, _neutral(0), "const"),
    Law(("add",), "x + (-y) = x - y", True, _add_negative, "neg"),
    Law(("sub",), "x - x = 0", False, _sub_same),
    Law(("sub",), "x - 0 = x", True, _right_neutral(0), "const"),
    Law(("sub",), "0 - x = -x", False, _sub_from_zero, "const"),
    Law(("sub",), "x - (-y) = x + y", True, _sub_negative, "neg"),
    Law(("sub",), "-x - y = -(x + y)", False, _sub_both_negative, "neg"),
    Law(("sub",), "x - y = -(y - x) where y - x exists", False, _sub_opposite),
    Law(("mul",), "0 x = 0", False, _mul_zero, "const"),
    Law(("mul",), "1 x = x", True, _neutral(1), "const"),
    Law(("mul",), "(-1) x = -x", True, _mul_minus_one, "const"),
    Law(("mul",), "(-x) y = -(x y)", True, _negative_operand("mul"), "neg"),
    Law(("mul",), "x / y y = x", False, _mul_quotient, "div"),
    Law(("div",), "x / 1 = x", True, _right_neutral(1), "const"),
    Law(("div",), "0 / x = 0", False, _div_zero, "const"),
    Law(("div",), "x / (-c) = -(x / c)", True, _div_negative_constant, "const"),
    Law(("div",), "x / 2^k = 2^-k x", True, _div_power_of_two, "const"),
    Law(("div",), "(-x) / y = -(x / y)", True, _negative_operand("div"), "neg"),
    Law(("neg",), "-(c x) = (-c) x", True, _neg_of_multiple, "mul"),
    Law(("neg",), "-(-x) = x", True, _neg_of_neg, "neg"),
    Law(("pow",), "x^0 = 1", True, _pow_zero, "const"),
    Law(("pow",), "x^1 = x", True, _right_neutral(1), "const"),
    Law(("pow",), "x^n, x^(n/2): products, and a root", False, _pow_unrolled, "const"),
    Law(("select",), "select(c, x, y) = x or y for a constant c", True, _select_known, "const"),
    Law(("select",), "select(c, x, x) = x", True, _select_same),
    Law(("min", "max"), "min(x, x) = max(x, x) = x", True, _same),
    Law(("and", "or"), "and(x, x) = or(x, x) = x for truth values", False, _same),
    *map(_odd, ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh", "erf", "sign")),
    _even("cos", False),
    _even("cosh", False),
    _even("abs", True),
    Law(("hypot",), "hypot(-x, y) = hypot(x, y)", True, _hypot_signs, "neg"),
    Law(("hypot",), "hypot(0, x) = |x|", False, _hypot_zero, "const"),
    Law(("not",), "not(not(x)) = x for truth values", True, _not_not, "not"),
    Law(("eq",), "(x = 0) = not(x) for truth values", True, _eq_zero, "const"),
)


def _sqrt(value: Fraction) -> Fraction | None:
    if value < 0:
        return None
    root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
    return root if root * root == value else None


def _hypot(x: Fraction, y: Fraction) -> Fraction | None:
    return _sqrt(x * x + y * y)


def _at_zero(value: Callable[[int], Fraction]) -> Callable[[Fraction, Fraction], Fraction | None]:
    """The value at zero of a family of functions, by order."""
    return lambda order, x: value(int(order)) if x == 0 else None


def _at(point: int, value: int) -> Callable[[Fraction], Fraction | None]:
    """The value of a function at the one rational point where it is rational."""
    return lambda x: Fraction(value) if x == point else None


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
    "floor": lambda a: Fraction(math.floor(a)),
    "mod": lambda a, b: a - b * math.floor(a / b) if b else None,
    "hypot": _hypot,
    **{op: _at(0, 0) for op in ("sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh")},
    **{op: _at(0, 0) for op in ("erf", "expm1", "log1p")},
    **{op: _at(0, 1) for op in ("cos", "cosh", "exp", "erfc")},
    "besselj": _at_zero(lambda n: Fraction(n == 0)),
    "stumpff": _at_zero(lambda k: Fraction(1, math.factorial(k))),
    "log": _at(1, 0),
    "acos": _at(1, 0),
    "acosh": _at(1, 0),
}
"""Operations that are evaluated exactly on exact constants."""


_FOLDED = frozenset({*_EXACT, *(op for law in LAWS for op in law.ops)})
"""Operations that may fold: the others, of any number of operands, are not looked at."""


def _rule_set(name: str, laws: Sequence[Law]) -> RuleSet:
    ops = dict.fromkeys(op for law in laws for op in law.ops)
    return RuleSet(name, {op: tuple(law for law in laws if op in law.ops) for op in ops})


ALGEBRAIC = _rule_set("algebraic", LAWS)
RULE_SETS: dict[str, RuleSet] = {
    "algebraic": ALGEBRAIC,
    "exact": _rule_set("exact", [law for law in LAWS if law.exact]),
}
