"""Quotients with a removable singularity, such as sin(x)/x: right at zero, and so are their derivatives.

In a product such as a sin(x) / (x y) the function is written as sin(x) = x F(x), after which the powers
of x cancel. F is a row of `ROWS`. Near zero it is composed of functions that are smooth there, without
any quotient of small numbers: Stumpff's functions (`codegen.ir.stumpff`), of the value of an inverse
function where there is one (asin(x)/x = w/sin w with w = asin x). Its derivatives of any order then
have no small divisor either. Beyond a cutoff of its own F is the quotient as it is written, which keeps
all digits of x. Each side gets an argument of its own that is never outside its range, so that nothing
that is not finite can leak from the side that is not taken into a derivative.

The quotient magnifies rounding in its second derivative by the sum of the moduli of the terms of
F'' over the larger of |F''| and |F''(0)|; a cutoff is where this has fallen to about 30 or less. Measured
from 1e-300 to three times the cutoff: errors of at most 2 units in the last place in F, 6 in F' and 12
in F'' (of the largest value nearby where F' or F'' is zero); the tests hold these.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import sympy as sp
from sympy.codegen import cfunctions
from sympy.core.symbol import Str

from codegen.ir.program import Builder

Expr = Any
Rule = Callable[[Builder, int], int]


@dataclass(frozen=True)
class Row:
    """A function f of order ``order`` at zero, and F(x) = f(x) / x**order.

    ``near``: F below the cutoff, from x, or from z = x^2 for even F (``even``). ``f``: f from x.
    """

    order: int
    cutoff: Fraction
    even: bool
    near: Rule
    f: Rule


class Removable(sp.Expr):  # type: ignore[misc]
    """F(x) of the row ``args[0]`` at the expression ``args[1]``; it lives while a system is lowered."""

    is_commutative = True
    is_extended_real = True

    @property
    def row(self) -> Row:
        """The row of the table."""
        return ROWS[str(self.args[0].name)]

    @property
    def root(self) -> bool:
        """Whether the argument is a square root, and F a function of what stands under it."""
        argument = self.args[1]
        return self.row.even and argument.is_Pow and argument.exp == sp.S.Half

    @property
    def operand(self) -> Expr:
        """What `build` takes: x, or x^2 where x is a root."""
        return self.args[1].base if self.root else self.args[1]

    def build(self, b: Builder, number: int) -> int:
        """Return the number of F from that of `operand`."""
        row = self.row
        cutoff = row.cutoff**2 if self.root else row.cutoff
        size = number if self.root else b.add("abs", number)
        is_near = b.add("lt", size, b.const(cutoff))
        inner = b.add("select", is_near, number, b.const(0))
        outer = b.add("select", is_near, b.const(cutoff), number)
        x = b.add("sqrt", outer) if self.root else outer
        below = x
        for _ in range(row.order - 1):
            below = b.add("mul", below, x)
        near = row.near(b, inner if self.root or not row.even else b.add("mul", inner, inner))
        return b.add("select", is_near, near, b.add("div", row.f(b, x), below))


# -- the table --------------------------------------------------------------------------------------------


def _c(b: Builder, k: int, z: int) -> int:
    return b.add("stumpff", b.const(k), z)


def _minus(b: Builder, z: int) -> int:
    return b.add("neg", z)


def _one_over(b: Builder, *factors: int) -> int:
    product = factors[0]
    for f in factors[1:]:
        product = b.add("mul", product, f)
    return b.add("div", b.const(1), product)


def _square(b: Builder, x: int) -> int:
    return b.add("mul", x, x)


def _cosine(b: Builder, z: int) -> int:
    """cos(sqrt z) = 1 - z c_2(z), smooth at zero; cosh for negative z."""
    return b.add("sub", b.const(1), b.add("mul", z, _c(b, 2, z)))


def _root_of_one_plus(b: Builder, x: int) -> int:
    return b.add("sqrt", b.add("add", b.const(1), x))


def _asin(b: Builder, x: int) -> int:
    """W / sin w with w = asin x."""
    return _one_over(b, _c(b, 1, _square(b, b.add("asin", x))))


def _asinh(b: Builder, x: int) -> int:
    return _one_over(b, _c(b, 1, _minus(b, _square(b, b.add("asinh", x)))))


def _atan(b: Builder, x: int) -> int:
    """W cos w / sin w with w = atan x, cos w = 1 / sqrt(1 + x^2)."""
    root = _root_of_one_plus(b, _square(b, x))
    return _one_over(b, root, _c(b, 1, _square(b, b.add("atan", x))))


def _atanh(b: Builder, x: int) -> int:
    root = _root_of_one_plus(b, _minus(b, _square(b, x)))
    return _one_over(b, root, _c(b, 1, _minus(b, _square(b, b.add("atanh", x)))))


def _quarter_square(b: Builder, x: int) -> int:
    """-x^2/4."""
    return _minus(b, b.add("mul", b.const(Fraction(1, 4)), _square(b, x)))


def _expm1(b: Builder, x: int) -> int:
    """Exp(x/2) sinh(x/2)/(x/2)."""
    half = b.add("exp", b.add("mul", b.const(Fraction(1, 2)), x))
    return b.add("mul", half, _c(b, 1, _quarter_square(b, x)))


def _log1p(b: Builder, x: int) -> int:
    """W / expm1(w) with w = log(1 + x), exp(w/2) = sqrt(1 + x)."""
    root = _root_of_one_plus(b, x)
    return _one_over(b, root, _c(b, 1, _quarter_square(b, b.add("log1p", x))))


def _call(op: str) -> Rule:
    return lambda b, x: b.add(op, x)


def _less(left: str, right: str) -> Rule:
    """The difference of two functions of x, ``x`` itself among them."""

    def term(b: Builder, name: str, x: int) -> int:
        return x if name == "x" else b.add(name, x)

    return lambda b, x: b.add("sub", term(b, left, x), term(b, right, x))


def _half_angle(op: str) -> Rule:
    """1 - cos x = 2 sin(x/2)^2 keeps its digits near the other zeros, too; cosh x - 1 likewise."""

    def rule(b: Builder, x: int) -> int:
        half = b.add("mul", b.const(Fraction(1, 2)), x)
        return b.add("mul", b.const(2), _square(b, b.add(op, half)))

    return rule


ROWS: dict[str, Row] = {
    "sin": Row(1, Fraction(2), True, lambda b, z: _c(b, 1, z), _call("sin")),
    "1 - cos": Row(2, Fraction(3), True, lambda b, z: _c(b, 2, z), _half_angle("sin")),
    "x - sin": Row(3, Fraction(4), True, lambda b, z: _c(b, 3, z), _less("x", "sin")),
    "sinh": Row(1, Fraction(2), True, lambda b, z: _c(b, 1, _minus(b, z)), _call("sinh")),
    "cosh - 1": Row(2, Fraction(3), True, lambda b, z: _c(b, 2, _minus(b, z)), _half_angle("sinh")),
    "sinh - x": Row(3, Fraction(4), True, lambda b, z: _c(b, 3, _minus(b, z)), _less("sinh", "x")),
    "tan": Row(1, Fraction(1), True, lambda b, z: b.add("div", _c(b, 1, z), _cosine(b, z)), _call("tan")),
    "tanh": Row(1, Fraction(1), True,
                lambda b, z: b.add("div", _c(b, 1, _minus(b, z)), _cosine(b, _minus(b, z))), _call("tanh")),
    "asin": Row(1, Fraction(3, 4), False, _asin, _call("asin")),
    "atan": Row(1, Fraction(1), False, _atan, _call("atan")),
    "asinh": Row(1, Fraction(1), False, _asinh, _call("asinh")),
    "atanh": Row(1, Fraction(3, 4), False, _atanh, _call("atanh")),
    "expm1": Row(1, Fraction(2), False, _expm1, _call("expm1")),
    "log1p": Row(1, Fraction(7, 8), False, _log1p, _call("log1p")),
}  # fmt: skip

_FUNCTIONS: dict[Any, tuple[str, int]] = {
    sp.sin: ("sin", 1), sp.tan: ("tan", 1), sp.sinh: ("sinh", 1), sp.tanh: ("tanh", 1),
    sp.asin: ("asin", 1), sp.atan: ("atan", 1), sp.asinh: ("asinh", 1), sp.atanh: ("atanh", 1),
    sp.csc: ("sin", -1), sp.cot: ("tan", -1), sp.csch: ("sinh", -1), sp.coth: ("tanh", -1),
}  # fmt: skip
"""Functions that are zero at zero, by row; reciprocals with the power -1."""
_RECIPROCALS = frozenset(f for f, (_, power) in _FUNCTIONS.items() if power < 0)
_DIFFERENCES: dict[Any, tuple[str, int, bool]] = {
    sp.cos: ("1 - cos", -1, False), sp.cosh: ("cosh - 1", 1, False), sp.exp: ("expm1", 1, False),
    sp.sin: ("x - sin", -1, True), sp.sinh: ("sinh - x", 1, True),
}  # fmt: skip
"""Functions that lose what they have at zero: the row, its sign, whether x or 1 is taken away."""


# -- where they stand -------------------------------------------------------------------------------------


class Found(NamedTuple):
    """An expression that equals (factor * x**order * F(x))**power for a row of the table."""

    name: str
    factor: Expr
    x: Expr
    power: int = 1


def sinc(x: Expr) -> Expr:
    """Return sin(x)/x."""
    return Removable(Str("sin"), x)


def rewrite(product: Expr) -> Expr:
    """Return a product with every F that cancels a divisor taken out, or the product itself.

    Law: the value does not change where the product is defined; where it is 0/0 it is the limit.
    """
    factors = [f.as_base_exp() for f in sp.Mul.make_args(product)]
    powers = {base: e for base, e in factors if e.is_Rational}
    if all(e.p > 0 and b.func not in _RECIPROCALS for b, e in powers.items()):
        return product  # nothing is divided by
    parts: list[Expr] = []
    changed = False
    for base, e in factors:
        found = _found(base) if e.is_Integer else None
        if found is None or not _cancels(found, e, powers):
            parts.append(base**e)
            continue
        changed = True
        order = ROWS[found.name].order
        n = e * found.power
        parts += [found.factor**n, Removable(Str(found.name), found.x) ** n]
        parts += [b ** (p * order * n) for b, p in _factors(found.x)]
    return sp.Mul(*parts) if changed else product


def _cancels(found: Found, e: Expr, powers: dict[Expr, Expr]) -> bool:
    """Return whether a factor of x stands on the other side of the fraction bar."""
    side = e * found.power
    return any(powers.get(b, 0) * p * side < 0 for b, p in _factors(found.x) if not b.is_Number)


def _factors(x: Expr) -> list[tuple[Expr, Expr]]:
    """Return bases and powers of a product, the common number of a sum apart."""
    number, rest = x.primitive() if x.is_Add else (sp.S.One, x)
    return [f.as_base_exp() for f in (number, *sp.Mul.make_args(rest)) if f is not sp.S.One]


def _found(base: Expr) -> Found | None:
    if base.func in _FUNCTIONS:
        name, power = _FUNCTIONS[base.func]
        return Found(name, sp.S.One, base.args[0], power)
    if base.func is sp.log:
        rest = after_one(base.args[0])
        return None if rest is None else Found("log1p", sp.S.One, rest)
    return difference(base) if base.is_Add else None


def norm(base: Expr, exponent: Expr) -> tuple[Expr, Expr]:
    """Return (norm, 2 * exponent) for a root of two squares: no over- or underflow on the way."""
    if not (exponent.is_Rational and exponent.q == 2 and base.is_Add and len(base.args) == 2):
        return base, exponent
    legs = [_leg(term) for term in base.args]
    if any(leg is None for leg in legs):
        return base, exponent
    return cfunctions.hypot(*legs), 2 * exponent


def _leg(term: Expr) -> Expr | None:
    """Return x of a term x^2, or None; a number counts as none."""
    coefficient, rest = term.as_coeff_Mul()
    root = sp.sqrt(coefficient)
    pairs = [f.as_base_exp() for f in sp.Mul.make_args(rest)]
    even = all(e.is_Integer and e % 2 == 0 for _, e in pairs)
    if rest is sp.S.One or not even or not root.is_Rational:
        return None
    return sp.Mul(root, *(b ** (e / 2) for b, e in pairs))


def after_one(e: Expr) -> Expr | None:
    """Return x of 1 + x, or None."""
    return e - 1 if e.is_Add and e.args[0] is sp.S.One else None


def difference(e: Expr) -> Found | None:
    """Recognise c (1 - cos x), c (x - sin x) and their kin, c (exp(x) - 1).

    Each term is looked at once: what is left of the sum is compared term by term, not built.
    """
    terms = frozenset(e.args)
    for term in e.args:
        c, f = term.as_coeff_Mul()
        if f.func not in _DIFFERENCES:
            continue
        name, sign, is_x = _DIFFERENCES[f.func]
        x = f.args[0] if is_x else sp.S.One
        if len(sp.Add.make_args(x)) != len(e.args) - 1:
            continue
        if terms == {term, *sp.Add.make_args(-c * x)}:
            return Found(name, sign * c, f.args[0])
    return None
