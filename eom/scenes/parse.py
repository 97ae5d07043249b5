"""A restricted parser for formulas in scene files: text to SymPy without evaluating any text.

Grammar: numbers, known names, ``+ - * / ^ **``, parentheses and the functions of `FUNCTIONS`.
Decimal numbers are exact. Length, depth and the size of numbers are limited; every error shows its
place with a caret.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from operator import add, mul, sub, truediv
from typing import Any

import sympy as sp

from eom.errors import InputError, near_matches
from eom.expressions import saturate
from eom.units import in_unit, measure

Expr = Any

MAX_LENGTH = 4000
MAX_DEPTH = 60
MAX_BITS = 512
MAX_EXPONENT = 64
MAX_GROWTH = 700  # exp(700) is close to the largest double

_OF_ONE = "sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp log sqrt sign"
FUNCTIONS: dict[str, tuple[int, Callable[..., Expr]]] = {
    **{name: (1, getattr(sp, name)) for name in _OF_ONE.split()},
    "abs": (1, sp.Abs),
    "atan2": (2, sp.atan2),
    "min": (2, sp.Min),
    "max": (2, sp.Max),
    "saturate": (3, saturate),
}
CONSTANTS: dict[str, Expr] = {"pi": sp.pi}

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)"
    r"|(?P<name>[A-Za-z][A-Za-z0-9_]*)|(?P<operator>\*\*|[-+*/^(),]))"
)
_INFINITE = frozenset({sp.zoo, sp.nan, sp.oo, -sp.oo})
_BINARY: dict[str, int] = {"+": 10, "-": 10, "*": 20, "/": 20, "^": 40, "**": 40}
_ARITHMETIC: dict[str, Callable[..., Expr]] = {"+": add, "-": sub, "*": mul, "/": truediv}
_UNARY_POWER = 30


@dataclass(frozen=True)
class Token:
    """A piece of the text with its place."""

    kind: str
    text: str
    start: int


def parse(
    text: str,
    names: Mapping[str, Expr],
    where: str = "",
    *,
    unit: str = "",
    number: Callable[[str], Expr] | None = None,
) -> Expr:
    """Return the expression that ``text`` spells over ``names``; or a value with its unit, in SI, exactly.

    ``unit``: that a value with a unit is to have, where it is known. ``number``: what makes numbers of
    their texts, else exact ones. Raises `InputError` with the place for anything outside the grammar and
    its limits, for unknown units, and for a value of another dimension than ``unit``.

    >>> x = sp.Symbol("x")
    >>> parse("-2*x^2 + sin(x)/4", {"x": x})
    -2*x**2 + sin(x)/4
    >>> parse("90 deg", {}), parse("5 km/h", {})
    (pi/2, 25/18)
    """
    measured = in_unit(text, unit, where)
    if measured is not None:
        return measured
    if len(text) > MAX_LENGTH:
        raise InputError(
            "formula is too long",
            where=where,
            got=f"{len(text)} characters",
            expected=f"at most {MAX_LENGTH}",
        )
    parser = _Parser(text, names, where, number or _exact)
    try:
        expression = parser.expression(0, 0)
    except InputError:
        raise
    except _SYMPY_FAILURES as error:
        raise parser.error("SymPy cannot evaluate this") from error
    if parser.token.kind != "end":
        raise parser.error("unexpected text after the formula")
    return expression


def _exact(text: str) -> Expr:
    value = Fraction(text)
    return sp.Rational(value.numerator, value.denominator)


def dimensional(text: str) -> Expr:
    """Return a number for a check of dimensions: one with a decimal point, a float, may have a unit."""
    return sp.Float(text) if has_decimals(text) else _exact(text)


def has_decimals(given: Any) -> bool:
    """Return whether formulas, in lists or parts of scenes, have decimals, or are values with units."""
    if isinstance(given, str):
        return "." in given or measure(given) is not None
    if isinstance(given, Iterable):  # a part of a scene yields names with values
        return any(map(has_decimals, given.values() if isinstance(given, Mapping) else given))
    return isinstance(given, float) and not given.is_integer()


def words(text: str) -> set[str]:
    """Return the names of quantities that a formula speaks of, whatever else is in it."""
    found = {m["name"] for m in _TOKEN.finditer(text) if m["name"]}
    return found - {*FUNCTIONS, *CONSTANTS}


_SYMPY_FAILURES = (ArithmeticError, AttributeError, RecursionError, TypeError, ValueError)
"""What SymPy raises for some constants, such as acos(sin(exp(700)))."""


class _Parser:
    """Precedence climbing over a token list (Pratt, 1973)."""

    def __init__(
        self, text: str, names: Mapping[str, Expr], where: str, exact: Callable[[str], Expr]
    ) -> None:
        self.text, self.exact = text, exact
        self.names = names
        self.where = where
        self.tokens = self._tokens()
        self.place = 0

    @property
    def token(self) -> Token:
        return self.tokens[self.place]

    def error(self, what: str, hint: str = "", start: int | None = None) -> InputError:
        at = self.token.start if start is None else start
        left = max(0, at - 40)
        caret = f"{self.text[left : at + 40]!r}, character {at + 1}"
        return InputError(what, where=self.where, got=caret, hint=hint)

    def _tokens(self) -> list[Token]:
        tokens, place = [], 0
        end = len(self.text.rstrip())
        while place < end:
            match = _TOKEN.match(self.text, place)
            if match is None:
                start = place + len(self.text[place:]) - len(self.text[place:].lstrip())
                raise self._bad_character(start)
            kind = str(match.lastgroup)
            tokens.append(Token(kind, match[kind], match.start(kind)))
            place = match.end()
        return [*tokens, Token("end", "", end)]

    def _bad_character(self, start: int) -> InputError:
        shown = f"{self.text[max(0, start - 20) : start + 20]!r}, character {start + 1}"
        return InputError(
            f"character {self.text[start]!r} cannot be read",
            where=self.where,
            got=shown,
            expected="numbers, names, + - * / ^ and parentheses",
            hint="write Greek letters and primes in words: theta, psi_dot",
        )

    def take(self) -> Token:
        token = self.token
        self.place += 1
        return token

    def expect(self, text: str) -> None:
        if self.token.text != text or self.token.kind != "operator":
            raise self.error(f"{text!r} expected")
        self.place += 1

    def expression(self, power: int, depth: int) -> Expr:
        if depth > MAX_DEPTH:
            raise self.error(f"formula is nested more than {MAX_DEPTH} deep")
        left = self.operand(depth)
        while self.token.kind == "operator" and _BINARY.get(self.token.text, -1) > power:
            operator = self.take()
            binding = _BINARY[operator.text]
            right_first = operator.text in {"^", "**"}
            right = self.expression(binding - 1 if right_first else binding, depth + 1)
            left = self.combine(operator, left, right)
        return left

    def operand(self, depth: int) -> Expr:
        token = self.take()
        if token.kind == "number":
            return self.number(token)
        if token.kind == "name":
            return self.name(token, depth)
        if token.text in {"+", "-"}:
            value = self.expression(_UNARY_POWER, depth + 1)
            return value if token.text == "+" else -value
        if token.text == "(":
            value = self.expression(0, depth + 1)
            self.expect(")")
            return value
        self.place -= 1
        raise self.error("a number, a name or '(' expected")

    def number(self, token: Token) -> Expr:
        return self.checked(self.exact(token.text), token)

    def name(self, token: Token, depth: int) -> Expr:
        if token.text in FUNCTIONS:
            return self.call(token, depth)
        if token.text in self.names:
            return self.names[token.text]
        if token.text in CONSTANTS:
            return CONSTANTS[token.text]
        known = [*self.names, *FUNCTIONS, *CONSTANTS]
        raise self.error(
            f"unknown name {token.text!r}", near_matches(token.text, known), token.start
        )

    def call(self, token: Token, depth: int) -> Expr:
        count, function = FUNCTIONS[token.text]
        self.expect("(")
        arguments = [self.expression(0, depth + 1)]
        while self.token.text == ",":
            self.place += 1
            arguments.append(self.expression(0, depth + 1))
        self.expect(")")
        if len(arguments) != count:
            raise self.error(f"{token.text} takes {count} argument{'s'[: count - 1]}, got {len(arguments)}",
                             start=token.start)  # fmt: skip
        if token.text in {"exp", "sinh", "cosh"} and _beyond(arguments[0], MAX_GROWTH):
            raise self.error("number is too large or too small", start=token.start)
        as_written = count == 1 and not arguments[0].is_number
        value = function(*arguments, evaluate=False) if as_written else function(*arguments)
        return self.checked(value, token)

    def combine(self, operator: Token, left: Expr, right: Expr) -> Expr:
        applied = _ARITHMETIC.get(operator.text)
        value = applied(left, right) if applied else self.raise_to(operator, left, right)
        return self.checked(value, operator)

    def raise_to(self, operator: Token, base: Expr, exponent: Expr) -> Expr:
        if exponent.is_number and not (exponent.is_Rational and abs(exponent) <= MAX_EXPONENT):
            raise self.error(
                f"constant exponent beyond {MAX_EXPONENT}, or not a fraction", start=operator.start
            )
        if base.is_number and exponent.is_number and exponent.q > MAX_EXPONENT:
            raise self.error(
                f"root of a constant beyond the {MAX_EXPONENT}th", start=operator.start
            )
        if _bits(base) * (abs(exponent) if exponent.is_number else 1) > MAX_BITS:
            raise self.error("number is too large", start=operator.start)
        return base**exponent

    def checked(self, value: Expr, token: Token) -> Expr:
        if _bits(value) > MAX_BITS:
            raise self.error("number is too large or too small", start=token.start)
        if any(part in _INFINITE for part in (value, *value.args)):
            raise self.error("division by zero", start=token.start)
        if value.is_number and (value.is_real is False or value.has(sp.I)):
            raise self.error("the value is not real", start=token.start)
        return value


def _bits(value: Expr) -> int:
    """Bits of the rational factor of ``value``; powers of products multiply it out."""
    factor = value.as_coeff_Mul(rational=True)[0]
    return int(max(abs(factor.p), factor.q).bit_length())


def _beyond(value: Expr, limit: int) -> bool:
    """Whether a constant is larger than ``limit``: towers of exponentials cannot be evaluated."""
    return bool(value.is_number and abs(value.evalf(5)) > limit)
