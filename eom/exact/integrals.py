"""Exact integrals of polynomials times sines and cosines, by rules of known cost.

A product of sines and cosines becomes a sum of single ones (product-to-sum formulas), and
x**n cos(w x + c) is integrated by parts n times. Whatever lies outside these rules is left to
SymPy's integrator by `definite`, never by `antiderivative`.
"""

from __future__ import annotations

from math import perm
from typing import Any

import sympy as sp

from eom.errors import InputError

Expr = Any
Bound = tuple[Expr, Expr, Expr]
"""A variable, from, to."""
_Wave = tuple[Expr, Expr, bool]
"""w, c and whether a sine: cos(w x + c) or sin(w x + c)."""

MAX_DEGREE = 64
"""Products of more sines and cosines than this are outside the rules."""

_PRODUCT_TO_SUM = {
    (False, False): (1, 1, False),  # 2 cos P cos A = cos(P + A) + cos(P - A)
    (True, False): (1, 1, True),  # 2 sin P cos A = sin(P + A) + sin(P - A)
    (False, True): (1, -1, True),  # 2 cos P sin A = sin(P + A) - sin(P - A)
    (True, True): (-1, 1, False),  # 2 sin P sin A = -cos(P + A) + cos(P - A)
}
"""(P a sine, A a sine) to (sign at P + A, sign at P - A, a sine)."""

_CYCLE = ((sp.cos, 1), (sp.sin, 1), (sp.cos, -1), (sp.sin, -1))
"""Each entry integrates to the next one."""


def antiderivative(f: Expr, x: Expr) -> Expr | None:
    """Return an F with dF/dx = f, or None where the rules do not reach.

    The rules: sums of products of powers of ``x`` with exponents 0, 1, 2, ... and of sines and
    cosines of w x + c, where w is known to be zero or not. Coefficients are whatever is free of x.
    Source: Bronstein, Semendjajew, Handbook of Mathematics, 2.7.2 (products of sines and cosines).

    >>> x = sp.Symbol("x")
    >>> antiderivative(3 * x**2 + sp.cos(x), x)
    x**3 + sin(x)
    """
    total = []
    for kernel, coefficient in _coefficients(f, x).items():
        found = _kernel(kernel, x)
        if found is None:
            return None
        total.append(coefficient * found)
    return sp.Add(*total)


def definite(f: Expr, bound: Bound) -> Expr:
    """Return the integral of ``f`` over ``bound``; factors that are free of it stay as they are.

    Outside the rules of `antiderivative` this is SymPy's integral. Raises `InputError` where that
    finds none, or an infinite one.

    >>> x, a = sp.symbols("x a", positive=True)
    >>> definite(a * sp.sin(x) ** 2, (x, 0, 2 * sp.pi))
    pi*a
    """
    x, start, end = bound
    constant, moving = f.as_independent(x, as_Add=False)
    terms = []
    for kernel, coefficient in _coefficients(moving, x).items():
        found = _kernel(kernel, x)
        if found is None:
            terms.append(coefficient * _by_search(kernel, bound))
        else:
            terms.append(coefficient * (found.xreplace({x: end}) - found.xreplace({x: start})))
    return constant * sp.Add(*terms)


def _coefficients(f: Expr, x: Expr) -> dict[Expr, Expr]:
    """Split the expanded ``f`` into functions of ``x`` with their coefficients."""
    parts: dict[Expr, list[Expr]] = {}
    for term in sp.Add.make_args(sp.expand(f)):
        if term == 0:
            continue
        coefficient, kernel = term.as_independent(x, as_Add=False)
        parts.setdefault(kernel, []).append(coefficient)
    return {kernel: sp.Add(*coefficients) for kernel, coefficients in parts.items()}


def _kernel(kernel: Expr, x: Expr) -> Expr | None:
    """Integrate one product of a power of ``x``, sines and cosines."""
    degree = 0
    waves: list[_Wave] = []
    for factor in sp.Mul.make_args(kernel):
        base, exponent = factor.as_base_exp()
        if factor is sp.S.One:
            continue
        if not (exponent.is_Integer and exponent > 0):
            return None
        if base == x:
            degree += int(exponent)
            continue
        wave = _wave(base, x)
        if wave is None or len(waves) + exponent > MAX_DEGREE:
            return None
        waves += [wave] * int(exponent)
    parts = [
        (coefficient, _by_parts(degree, wave, x))
        for wave, coefficient in _single_waves(waves).items()
    ]
    if any(part is None for _, part in parts):
        return None
    return sp.Add(*(coefficient * part for coefficient, part in parts))


def _wave(base: Expr, x: Expr) -> _Wave | None:
    if not isinstance(base, sp.sin | sp.cos):
        return None
    phase, moving = base.args[0].as_independent(x, as_Add=True)
    frequency, variable = moving.as_independent(x, as_Add=False)
    return (frequency, phase, isinstance(base, sp.sin)) if variable == x else None


def _single_waves(waves: list[_Wave]) -> dict[_Wave, Expr]:
    """Write a product of sines and cosines as a sum; the empty product is cos(0)."""
    total: dict[_Wave, Expr] = {(sp.S.Zero, sp.S.Zero, False): sp.S.One}
    for w, c, sine in waves:
        after: dict[_Wave, Expr] = {}
        for (W, C, is_sine), coefficient in total.items():
            plus, minus, kind = _PRODUCT_TO_SUM[is_sine, sine]
            for wave, sign in (((W + w, C + c, kind), plus), ((W - w, C - c, kind), minus)):
                after[wave] = after.get(wave, sp.S.Zero) + coefficient * sp.Rational(sign, 2)
        total = after
    return total


def _by_parts(degree: int, wave: _Wave, x: Expr) -> Expr | None:
    """Integrate x**degree cos(w x + c), or the sine; None if w may be zero or not."""
    w, c, sine = wave
    if w.is_zero is None:
        return None
    if w.is_zero:
        return x ** (degree + 1) / (degree + 1) * (sp.sin(c) if sine else sp.cos(c))
    terms = []
    for k in range(degree + 1):
        function, sign = _CYCLE[(sine + k + 1) % 4]
        factor = sign * (-1) ** k * perm(degree, k)
        terms.append(factor * x ** (degree - k) * function(w * x + c) / w ** (k + 1))
    return sp.Add(*terms)


def _by_search(kernel: Expr, bound: Bound) -> Expr:
    """Ask SymPy for an integral outside the rules."""
    found = sp.integrate(kernel, bound)
    if found.has(sp.Integral):
        raise InputError(
            "no closed form of an integral was found",
            where=f"integral over {bound[0]} from {bound[1]} to {bound[2]}",
            got=kernel,
            expected="polynomials, sines and cosines of the parameters",
            hint="choose other parameters, or approximate the body by a triangle mesh",
        )
    if found.has(sp.oo, -sp.oo, sp.zoo, sp.nan):
        raise InputError(
            "an integral is not finite",
            where=f"integral over {bound[0]} from {bound[1]} to {bound[2]}",
            got=kernel,
        )
    return found
