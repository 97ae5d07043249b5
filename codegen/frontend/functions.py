"""SymPy's functions as operations: one row a function, from the numbers of its arguments to its value.

Signs, ranges and values at special points are SymPy's: Mod has the sign of its divisor, acot is odd but
for acot(0) = pi/2, Heaviside(0) is 1/2 unless it is given.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import sympy as sp
from sympy.codegen import cfunctions

from codegen.ir.program import Builder
from eom.errors import InputError

Build = Callable[[Builder, Sequence[int]], int]


def _operation(op: str) -> Build:
    return lambda b, a: b.add(op, *a)


def _reciprocal(op: str) -> Build:
    return lambda b, a: b.add("div", b.const(1), b.add(op, *a))


def _of_reciprocal(op: str) -> Build:
    return lambda b, a: b.add(op, b.add("div", b.const(1), *a))


def _heaviside(b: Builder, args: Sequence[int]) -> int:
    """(1 + sign x)/2, which is NaN for NaN, but for the value at zero."""
    x, at_zero = args
    step = b.add("mul", b.const(Fraction(1, 2)), b.add("add", b.const(1), b.add("sign", x)))
    return b.add("select", b.add("eq", x, b.const(0)), at_zero, step)


def _acot(b: Builder, args: Sequence[int]) -> int:
    """atan2(s, s x) with s = -1 for negative x and 1 else: no division at zero."""
    (x,) = args
    side = b.add("select", b.add("lt", x, b.const(0)), b.const(-1), b.const(1))
    return b.add("atan2", side, b.add("mul", side, x))


def _power_of(base: int) -> Build:
    return lambda b, a: b.add("pow", b.const(base), *a)


def _logarithm(base: int) -> Build:
    return lambda b, a: b.add("div", b.add("log", *a), b.add("log", b.const(base)))


def _cube_root(b: Builder, args: Sequence[int]) -> int:
    """The real root, of the sign of its argument."""
    size = b.add("pow", b.add("abs", *args), b.const(Fraction(1, 3)))
    return b.add("mul", b.add("sign", *args), size)


FUNCTIONS: dict[Any, Build] = {
    **{
        f: _operation(op)
        for f, op in {
            sp.sin: "sin", sp.cos: "cos", sp.tan: "tan", sp.asin: "asin", sp.acos: "acos",
            sp.atan: "atan", sp.sinh: "sinh", sp.cosh: "cosh", sp.tanh: "tanh", sp.asinh: "asinh",
            sp.acosh: "acosh", sp.atanh: "atanh", sp.exp: "exp", sp.atan2: "atan2",
            sp.Abs: "abs", sp.sign: "sign", sp.floor: "floor", sp.Mod: "mod", sp.erf: "erf",
            sp.erfc: "erfc", cfunctions.expm1: "expm1", cfunctions.log1p: "log1p",
            cfunctions.hypot: "hypot", cfunctions.Sqrt: "sqrt",
        }.items()
    },
    **{
        f: _reciprocal(op)
        for f, op in {
            sp.sec: "cos", sp.csc: "sin", sp.cot: "tan",
            sp.sech: "cosh", sp.csch: "sinh", sp.coth: "tanh",
        }.items()
    },
    **{
        f: _of_reciprocal(op)
        for f, op in {
            sp.asec: "acos", sp.acsc: "asin", sp.asech: "acosh", sp.acsch: "asinh", sp.acoth: "atanh",
        }.items()
    },
    sp.acot: _acot,
    sp.Heaviside: _heaviside,
    sp.ceiling: lambda b, a: b.add("neg", b.add("floor", b.add("neg", *a))),
    sp.frac: lambda b, a: b.add("sub", *a, b.add("floor", *a)),
    cfunctions.exp2: _power_of(2),
    cfunctions.log2: _logarithm(2),
    cfunctions.log10: _logarithm(10),
    cfunctions.Cbrt: _cube_root,
    cfunctions.fma: lambda b, a: b.add("add", b.add("mul", a[0], a[1]), a[2]),
}  # fmt: skip
"""How each function is built from the numbers of its arguments, in order."""

BESSEL: dict[Any, str] = {sp.besselj: "besselj", sp.bessely: "bessely"}
"""Functions of an integer order and an argument."""


def bessel(kind: str, order: int) -> Build:
    """Return how a Bessel function of integer order is built; C_{-n} = (-1)^n C_n (DLMF 10.4.1)."""

    def build(b: Builder, args: Sequence[int]) -> int:
        value = b.add(kind, b.const(abs(order)), *args)
        return b.add("neg", value) if order < 0 and order % 2 else value

    return build


# -- the rest is refused ----------------------------------------------------------------------------------

_WORDS = {f.__name__ for f in (*FUNCTIONS, *BESSEL, sp.log, sp.Max, sp.Min)}
SUPPORTED = (
    "numbers, pi, sums, products, powers, Piecewise, conditions, sinc, eom.Table, "
    + ", ".join(sorted(_WORDS, key=lambda w: (w.lower(), w)))
    + "; besselj and bessely of integer order; everything real"
)
"""What can be lowered, for the error that refuses the rest."""

_HINTS: dict[Any, str] = {
    sp.core.function.AppliedUndef: "make it a state or an input symbol, or an eom.Table",
    sp.Derivative: "carry out the derivative with doit(), or make it a state symbol",
    sp.Integral: "carry out the integral with doit(), or make it a state whose rate is the integrand",
    sp.DiracDelta: "impulses change states between two simulations",
    sp.MatrixBase: "give one scalar expression a state",
    sp.core.numbers.ImaginaryUnit: "split the expression into its real and imaginary part",
}


def refusal(node: Any, where: str) -> InputError:
    """Return the error for an expression that no operation computes; ``where``: its place in a system."""
    return InputError(
        "no operation computes this expression",
        where=where,
        got=f"{type(node).__name__}: {node}"[:300],
        expected=SUPPORTED,
        hint=next((h for kind, h in _HINTS.items() if isinstance(node, kind)), ""),
    )
