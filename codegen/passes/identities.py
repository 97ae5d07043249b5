"""Identities that replace a form that cancels by one that does not: a table of rules.

Sources: Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed. 2002, sect. 1.7, 1.8 and
problems 1.1 to 1.5; Hamming, Numerical Methods for Scientists and Engineers, 2nd ed. 1973, ch. 4;
Goldberg, What Every Computer Scientist Should Know About Floating-Point Arithmetic, 1991, sect. 1.4.
A rule takes the builder and the numbers of the operands and returns the number of a value that is equal
in exact arithmetic, or None where the pattern is another one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from codegen.ir.fold import Numbers, constant
from codegen.ir.ops import OPS
from codegen.ir.polynomials import built, difference, linear, simpler_difference

Rule = Callable[[Numbers, tuple[int, ...]], int | None]
"""From the operands of an operation to the number of an equal value, or None."""


@dataclass(frozen=True)
class Identity:
    """A rule: its text, the operation that it replaces, and operations that it may need.

    ``op``: ``sub`` and ``add`` are tried on any two terms of a sum, or, with ``alone``, where the
    two are the whole sum. A difference is tried in both directions. ``heads``: which operations the
    two operands of a difference may be, so that others are passed over quickly; empty is any.
    """

    text: str
    op: str
    rule: Rule
    heads: tuple[str, str] = ("", "")
    needs: tuple[str, ...] = ()
    alone: bool = False

    def fits(self, operations: tuple[str, ...]) -> bool:
        """Tell whether the rule may fit operands that are these operations."""
        pairs = zip(self.heads, operations, strict=False)
        return all(not head or op in head.split() for head, op in pairs)


def _is(b: Numbers, number: int, op: str) -> int | None:
    """Return the operand if ``number`` is the unary operation ``op``."""
    instruction = b.instructions[number]
    return instruction.args[0] if instruction.op == op else None


def _square_of(b: Numbers, number: int) -> int | None:
    """Return x if ``number`` is x * x."""
    op, args, _ = b.instructions[number]
    return args[0] if op == "mul" and args[0] == args[1] else None


def _half(b: Numbers, number: int) -> int:
    return b.add("mul", b.const(Fraction(1, 2)), number)


def _squared(b: Numbers, number: int) -> int:
    return b.add("mul", number, number)


def _twice(b: Numbers, number: int) -> int:
    return b.add("mul", b.const(2), number)


def _one_less(outer: str, inner: str) -> Rule:
    """1 - cos x or cosh x - 1: twice the square of ``inner`` at half the argument."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        one, function = args if outer == "cos" else args[::-1]
        x = _is(b, function, outer)
        if x is None or constant(b, one) != 1:
            return None
        return _twice(b, _squared(b, b.add(inner, _half(b, x))))

    return rule


def _product(outer: str, of_sum: str, of_difference: str, sign: int) -> Rule:
    """A difference of two values of one function as twice a product over sum and difference."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        x, y = (_is(b, a, outer) for a in args)
        if x is None or y is None:
            return None
        mean = b.add(of_sum, _half(b, b.add("add", x, y)))
        apart = b.add(of_difference, _half(b, difference(b, x, y)))
        return b.add("mul", b.const(2 * sign), b.add("mul", mean, apart))

    return rule


def _atan_difference(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = (_is(b, a, "atan") for a in args)
    if x is None or y is None:
        return None
    across = b.add("add", b.const(1), b.add("mul", x, y))
    return b.add("atan2", difference(b, x, y), across)


def _squares(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = (_square_of(b, a) for a in args)
    if x is None or y is None or {b.instructions[k].op for k in (x, y)} & {"sin", "cos"}:
        return None
    return b.add("mul", difference(b, x, y), b.add("add", x, y))


def _complement(outer: str, inner: str) -> Rule:
    """1 - sin^2 or 1 - cos^2: the square of the other one."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        square = _square_of(b, args[1])
        x = None if square is None else _is(b, square, outer)
        if x is None or constant(b, args[0]) != 1:
            return None
        return _squared(b, b.add(inner, x))

    return rule


def _cosh_square_less_one(b: Numbers, args: tuple[int, ...]) -> int | None:
    square = _square_of(b, args[0])
    x = None if square is None else _is(b, square, "cosh")
    return None if x is None or constant(b, args[1]) != 1 else _squared(b, b.add("sinh", x))


def _double_angle(b: Numbers, args: tuple[int, ...]) -> int | None:
    squares = [_square_of(b, a) for a in args]
    if squares[0] is None or squares[1] is None:
        return None
    x, y = _is(b, squares[0], "cos"), _is(b, squares[1], "sin")
    return b.add("cos", _twice(b, x)) if x is not None and x == y else None


def _one_less_tanh_square(b: Numbers, args: tuple[int, ...]) -> int | None:
    square = _square_of(b, args[1])
    x = None if square is None else _is(b, square, "tanh")
    if x is None or constant(b, args[0]) != 1:
        return None
    return _squared(b, b.add("div", b.const(1), b.add("cosh", x)))


def _exp_less_one(b: Numbers, args: tuple[int, ...]) -> int | None:
    x = _is(b, args[0], "exp")
    return None if x is None or constant(b, args[1]) != 1 else b.add("expm1", x)


def _log_of_one_more(b: Numbers, args: tuple[int, ...]) -> int | None:
    terms = linear(b, args[0])
    if terms.get(()) != 1 or len(terms) < 2:
        return None
    return b.add("log1p", built(b, {m: c for m, c in terms.items() if m}))


def _root_difference(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = (_is(b, a, "sqrt") for a in args)
    above = None if x is None or y is None else simpler_difference(b, x, y)
    return None if above is None else b.add("div", above, b.add("add", *args))


def _beside_root(sign: int) -> Rule:
    """Sqrt(d) + sign*v over the conjugate, where sign*v is negative: it is chosen at run time."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        for root, v in (args,) if sign < 0 else (args, args[::-1]):
            d = _is(b, root, "sqrt")
            above = None if d is None else simpler_difference(b, d, _squared(b, v))
            if above is None or _is(b, v, "sqrt") is not None:
                continue
            if _nonnegative(b, v):
                return None if sign > 0 else b.add("div", above, b.add("add", root, v))
            below = b.add("add", root, b.add("abs", v))
            order = (b.const(0), v) if sign < 0 else (v, b.const(0))
            return b.add("select", b.add("lt", *order), b.add("div", above, below), below)
        return None

    return rule


_NEVER_NEGATIVE = frozenset({"sqrt", "abs", "exp", "cosh"})


def _nonnegative(b: Numbers, number: int) -> bool:
    value = constant(b, number)
    return (
        (value is not None and value >= 0)
        or b.instructions[number].op in _NEVER_NEGATIVE
        or _square_of(b, number) is not None
    )


def _reciprocal(b: Numbers, number: int) -> int | None:
    """Return x if ``number`` is 1 / x; 1 is 1 / 1."""
    if constant(b, number) == 1:
        return number
    op, args, _ = b.instructions[number]
    return args[1] if op == "div" and constant(b, args[0]) == 1 else None


def _reciprocals(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = (_reciprocal(b, a) for a in args)
    if x is None or y is None:
        return None
    above = simpler_difference(b, y, x)
    return None if above is None else b.add("div", above, b.add("mul", x, y))


def _reciprocal_roots(b: Numbers, args: tuple[int, ...]) -> int | None:
    """One of the roots may be 1."""
    x, y = (_reciprocal(b, a) for a in args)
    if x is None or y is None:
        return None
    insides = [k if constant(b, k) == 1 else _is(b, k, "sqrt") for k in (x, y)]
    if insides[0] is None or insides[1] is None:
        return None
    above = simpler_difference(b, insides[1], insides[0])
    below = b.add("mul", b.add("mul", x, y), b.add("add", x, y))
    return None if above is None else b.add("div", above, below)


def _arc_of_one_and(sign: int, inverse: str) -> Rule:
    """Acos(1 - y) or acosh(1 + y): twice the inverse sine of sqrt(y/2)."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        terms = linear(b, args[0])
        if terms.get(()) != 1 or len(terms) < 2:
            return None
        y = built(b, {m: sign * c for m, c in terms.items() if m})
        return _twice(b, b.add(inverse, b.add("sqrt", _half(b, y))))

    return rule


def _less_sine(b: Numbers, args: tuple[int, ...]) -> int | None:
    if _is(b, args[1], "sin") != args[0]:
        return None
    square = _squared(b, args[0])
    return b.add("mul", b.add("mul", args[0], square), b.add("stumpff", b.const(3), square))


def _norm(b: Numbers, args: tuple[int, ...]) -> int | None:
    op, terms, _ = b.instructions[args[0]]
    x, y = (_square_of(b, k) for k in terms) if op == "add" else (None, None)
    return None if x is None or y is None else b.add("hypot", x, y)


_COSINES = _product("cos", "sin", "sin", -1)
_SINES = _product("sin", "cos", "sin", 1)
_HYPERBOLIC_COSINES = _product("cosh", "sinh", "sinh", 1)
_HYPERBOLIC_SINES = _product("sinh", "cosh", "sinh", 1)

_ONE = "const"

_ROWS = (
    Identity("1 - cos x = 2 sin^2(x/2)", "sub", _one_less("cos", "sin"), (_ONE, "cos")),
    Identity("cosh x - 1 = 2 sinh^2(x/2)", "sub", _one_less("cosh", "sinh"), ("cosh", _ONE)),
    Identity("cos^2 x - sin^2 x = cos 2x", "sub", _double_angle, ("mul", "mul")),
    Identity("1 - sin^2 x = cos^2 x", "sub", _complement("sin", "cos"), (_ONE, "mul")),
    Identity("1 - cos^2 x = sin^2 x", "sub", _complement("cos", "sin"), (_ONE, "mul")),
    Identity("cosh^2 x - 1 = sinh^2 x", "sub", _cosh_square_less_one, ("mul", _ONE)),
    Identity("1 - tanh^2 x = 1/cosh^2 x", "sub", _one_less_tanh_square, (_ONE, "mul")),
    Identity("cos x - cos y = -2 sin((x + y)/2) sin((x - y)/2)", "sub", _COSINES, ("cos", "cos")),
    Identity("sin x - sin y = 2 cos((x + y)/2) sin((x - y)/2)", "sub", _SINES, ("sin", "sin")),
    Identity("cosh x - cosh y = 2 sinh((x + y)/2) sinh((x - y)/2)", "sub", _HYPERBOLIC_COSINES, ("cosh", "cosh")),
    Identity("sinh x - sinh y = 2 cosh((x + y)/2) sinh((x - y)/2)", "sub", _HYPERBOLIC_SINES, ("sinh", "sinh")),
    Identity("atan x - atan y = atan2(x - y, 1 + x y)", "sub", _atan_difference, ("atan", "atan")),
    Identity("x - sin x = x^3 c_3(x^2), c_3 of Stumpff", "sub", _less_sine, ("", "sin"), ("stumpff",)),
    Identity("exp x - 1 = expm1 x", "sub", _exp_less_one, ("exp", _ONE), ("expm1",)),
    Identity("sqrt x - sqrt y = (x - y)/(sqrt x + sqrt y)", "sub", _root_difference, ("sqrt", "sqrt")),
    Identity("sqrt x - y = (x - y^2)/(sqrt x + y) for y > 0", "sub", _beside_root(-1), ("sqrt", "")),
    Identity("sqrt x + y = (x - y^2)/(sqrt x - y) for y < 0", "add", _beside_root(1)),
    Identity("1/sqrt x - 1/sqrt y = (y - x)/(sqrt x sqrt y (sqrt x + sqrt y))", "sub", _reciprocal_roots, ("div const", "div const")),
    Identity("1/x - 1/y = (y - x)/(x y)", "sub", _reciprocals, ("div const", "div const")),
    Identity("x^2 - y^2 = (x - y)(x + y)", "sub", _squares, ("mul", "mul"), alone=True),
    Identity("acos(1 - x) = 2 asin sqrt(x/2)", "acos", _arc_of_one_and(-1, "asin")),
    Identity("acosh(1 + x) = 2 asinh sqrt(x/2)", "acosh", _arc_of_one_and(1, "asinh")),
    Identity("log(1 + x) = log1p x", "log", _log_of_one_more, needs=("log1p",)),
)  # fmt: skip


LIKE_TERMS = "x y - y x = 0"
"""Terms of a sum that cancel when all products are multiplied out; `codegen.passes.stable` looks for them."""


def _known(rows: tuple[Identity, ...]) -> tuple[Identity, ...]:
    return tuple(row for row in rows if all(op in OPS for op in row.needs))


IDENTITIES: tuple[Identity, ...] = _known(_ROWS)
"""Identities against cancellation; those whose operations are not in `ops` are left out."""

RANGE: tuple[Identity, ...] = _known(
    (Identity("sqrt(x^2 + y^2) = hypot(x, y)", "sqrt", _norm, needs=("hypot",)),)
)
"""Identities against overflow and underflow; they cost time and cure no cancellation."""
