"""Values of expressions at one point, to many digits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy as sp
from mpmath import MPContext

from eom.errors import InputError
from eom.system import Expr

DIGITS = 30
MP = MPContext()
MP.dps = DIGITS

Number = Any
"""A number of mpmath."""

FUNCTIONS: dict[Any, Callable[..., Number]] = {
    sp.sin: MP.sin,
    sp.cos: MP.cos,
    sp.tan: MP.tan,
    sp.cot: MP.cot,
    sp.sec: MP.sec,
    sp.csc: MP.csc,
    sp.asin: MP.asin,
    sp.acos: MP.acos,
    sp.atan: MP.atan,
    sp.atan2: MP.atan2,
    sp.exp: MP.exp,
    sp.log: MP.log,
    sp.sinh: MP.sinh,
    sp.cosh: MP.cosh,
    sp.tanh: MP.tanh,
    sp.Abs: MP.fabs,
    sp.sign: MP.sign,
}
"""Functions that have values."""


@dataclass
class Numbers:
    """Values at a point, ``given`` by symbol; every subexpression is computed once."""

    given: Mapping[Expr, Number]
    memo: dict[Expr, Number] = field(default_factory=dict)

    def value(self, expression: Expr) -> Number:
        """Return the value of an expression. Raises `InputError` for functions without one."""
        known = self.memo.get(expression)
        if known is None:
            known = self.memo[expression] = self._evaluated(expression)
        return known

    def _evaluated(self, e: Expr) -> Number:
        if e.is_Symbol:
            if e not in self.given:
                raise InputError("a symbol without a value", got=e)
            return self.given[e]
        if e.is_number and e.is_Atom:
            return MP.mpf(int(e.p)) / int(e.q) if e.is_Rational else MP.mpf(str(e.evalf(DIGITS)))
        values = [self.value(a) for a in e.args]
        if e.is_Add:
            return MP.fsum(values)
        if e.is_Mul:
            return MP.fprod(values)
        if e.is_Pow:
            exponent = int(e.exp) if e.exp.is_Integer else values[1]
            return MP.power(values[0], exponent)
        if type(e) not in FUNCTIONS:
            raise InputError("a function without a value", got=type(e).__name__)
        return FUNCTIONS[type(e)](*values)

    def size(self, expression: Expr) -> Number:
        """Return the sum of the magnitudes of terms: what rounding errors are measured by."""
        terms = sp.Add.make_args(sp.expand_mul(expression))
        return MP.fsum(abs(self.value(t)) for t in terms)
