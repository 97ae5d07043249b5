"""Values of expressions at one point, to many digits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy as sp
from mpmath import MPContext

from eom.errors import InputError
from eom.exact.rings import ARITHMETIC, Evaluation, Row, arguments, none
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


class _Digits:
    """Numbers of mpmath as a ring."""

    total, product, power = staticmethod(MP.fsum), staticmethod(MP.fprod), staticmethod(MP.power)

    def of(self, numerator: int, denominator: int = 1) -> Number:
        """Return a fraction."""
        return MP.mpf(numerator) / denominator

    def reduce(self, value: Number) -> Number:
        """Return the number itself."""
        return value

    def inverse(self, value: Number) -> Number:
        """Return the reciprocal."""
        return 1 / value


def _power(_: Numbers, node: Expr, values: list[Number]) -> Number:
    return MP.power(values[0], int(node.exp) if node.exp.is_Integer else values[1])


_CONSTANT = Row(none, lambda _, n, __: MP.mpf(str(n.evalf(DIGITS))))
_FUNCTION = Row(arguments, lambda _, n, v: FUNCTIONS[type(n)](*v))


@dataclass
class Numbers(Evaluation):
    """Values at a point, ``given`` by symbol; every subexpression is computed once."""

    given: Mapping[Expr, Number]
    memo: dict[Expr, Number] = field(default_factory=dict)

    ring = _Digits()

    def symbol(self, symbol: Expr) -> Number:
        """Return the given value of a symbol."""
        if symbol not in self.given:
            raise InputError("a symbol without a value", got=symbol)
        return self.given[symbol]

    def other(self, node: Expr) -> Number:
        """Refuse what has no value."""
        raise InputError("a function without a value", got=type(node).__name__)

    def size(self, expression: Expr) -> Number:
        """Return the sum of the magnitudes of terms: what rounding errors are measured by."""
        terms = sp.Add.make_args(sp.expand_mul(expression))
        return MP.fsum(abs(self.value(t)) for t in terms)


Numbers.rows = (
    ARITHMETIC
    | {sp.Pow: Row(arguments, _power), sp.Float: _CONSTANT, sp.NumberSymbol: _CONSTANT}
    | dict.fromkeys(FUNCTIONS, _FUNCTION)
)
