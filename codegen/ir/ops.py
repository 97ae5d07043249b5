"""The primitive operations: one row each, with everything that is known about it.

A row gives the operation's arity, its value in double precision (a NumPy function) and at any
precision (mpmath), its partial derivatives, the rounding error of a good library in units in the
last place, and its cost in units of an addition. Targets add one template a row in their own tables;
a test checks that each of them covers every row.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from codegen.ir import linsolve, special, stumpff
from codegen.ir.linsolve import Shape
from eom.tables import Table

Number = Any  # a mpmath real
Context = Any  # a mpmath context
Exact = Callable[..., Number]
Partials = Callable[..., tuple[Number, ...]]


@dataclass(frozen=True)
class Op:
    """A primitive operation.

    ``exact(m, *args)``: value in the mpmath context ``m``. ``partials(m, value, *args)``: one
    derivative an argument, 0 where the operation is flat or does not have one. ``ulps``: rounding
    error of the double-precision operation; 0.5 is correct rounding. ``scale(m, value, *args)``: what
    that error is relative to, where it is not the value: functions that are poor near their zeros.
    Functions of an operation with data (`WITH_DATA`) take the data before the arguments.
    """

    name: str
    arity: int
    double: Callable[..., Any]
    exact: Exact
    partials: Partials
    ulps: float = 0.5
    cost: int = 1
    commutative: bool = False
    scale: Callable[..., Number] | None = None


def _flat(count: int) -> Partials:
    return lambda m, v, *args: (m.mpf(0),) * count


def _sign(m: Context, x: Number) -> Number:
    return m.sign(x)


def _exact_min(m: Context, a: Number, b: Number) -> Number:
    return m.nan if m.isnan(a) or m.isnan(b) else min(a, b)


def _exact_max(m: Context, a: Number, b: Number) -> Number:
    return m.nan if m.isnan(a) or m.isnan(b) else max(a, b)


def _choose(_: Context, c: Number, a: Number, b: Number) -> Number:
    return a if c != 0 else b


def _truth(test: Callable[[Number, Number], bool]) -> Exact:
    return lambda m, a, b: m.mpf(int(test(a, b)))


def _elementary(
    name: str, double: Callable[..., Any], partial: Callable[..., Number], cost: int = 20
) -> Op:
    return Op(
        name,
        1,
        double,
        lambda m, x: getattr(m, name)(x),
        lambda m, v, x: (partial(m, v, x),),
        ulps=4.0,
        cost=cost,
    )


def _comparison(
    name: str, double: Callable[..., Any], test: Callable[[Number, Number], bool]
) -> Op:
    return Op(name, 2, lambda a, b: np.float64(double(a, b)), _truth(test), _flat(2), ulps=0.0)


def _pow_partials(m: Context, v: Number, x: Number, y: Number) -> tuple[Number, Number]:
    return (y * v / x if x != 0 else m.mpf(0), v * m.log(x) if x > 0 else m.mpf(0))


def _atan2_partials(m: Context, _: Number, y: Number, x: Number) -> tuple[Number, Number]:
    square = x * x + y * y
    return (x / square, -y / square) if square != 0 else (m.mpf(0), m.mpf(0))


def _hypot_partials(m: Context, v: Number, x: Number, y: Number) -> tuple[Number, Number]:
    return (x / v, y / v) if v != 0 else (m.mpf(0), m.mpf(0))


def _exact_mod(m: Context, a: Number, b: Number) -> Number:
    """Return a - b floor(a/b), as NumPy takes it to its limits; the digits of the quotient are kept."""
    if b == 0 or m.isnan(a) or m.isnan(b) or m.isinf(a):
        return m.nan
    if m.isinf(b):
        return b if a * b < 0 else a
    with m.extraprec(max(0, m.mag(a) - m.mag(b)) + 10 if a else 0):
        rest = a - b * m.floor(a / b)
    return +rest


def _mod_partials(m: Context, v: Number, a: Number, b: Number) -> tuple[Number, Number]:
    return (m.mpf(1), -m.nint((a - v) / b))


def _bessel(name: str, scipy_name: str, ulps: float) -> Op:
    return Op(
        name,
        2,
        special.scipy_function(scipy_name),
        lambda m, n, x: special.bessel(m, name, n, x),
        lambda m, v, n, x: (m.mpf(0), special.bessel_slope(m, name, n, x)),
        ulps=ulps,
        cost=100,
        scale=lambda m, v, n, x: special.bessel_scale(m, name, v, n, x),
    )


VARIADIC = -1
"""Arity of operations that take any number of arguments."""

_ROWS = (
    Op("add", 2, np.add, lambda m, a, b: a + b, lambda m, v, a, b: (m.mpf(1), m.mpf(1)), commutative=True),
    Op("sub", 2, np.subtract, lambda m, a, b: a - b, lambda m, v, a, b: (m.mpf(1), m.mpf(-1))),
    Op("mul", 2, np.multiply, lambda m, a, b: a * b, lambda m, v, a, b: (b, a), commutative=True),
    Op("div", 2, np.divide, lambda m, a, b: a / b, lambda m, v, a, b: (1 / b, -v / b), cost=4),
    Op("neg", 1, np.negative, lambda m, a: -a, lambda m, v, a: (m.mpf(-1),), ulps=0.0),
    Op("sqrt", 1, np.sqrt, lambda m, x: m.sqrt(x), lambda m, v, x: (1 / (2 * v) if v != 0 else m.mpf(0),), cost=5),
    Op("pow", 2, np.power, lambda m, x, y: m.power(x, y), _pow_partials, ulps=4.0, cost=40),
    _elementary("sin", np.sin, lambda m, v, x: m.cos(x)),
    _elementary("cos", np.cos, lambda m, v, x: -m.sin(x)),
    _elementary("tan", np.tan, lambda m, v, x: 1 + v * v, 30),
    _elementary("asin", np.arcsin, lambda m, v, x: 1 / m.sqrt(1 - x * x) if abs(x) < 1 else m.mpf(0)),
    _elementary("acos", np.arccos, lambda m, v, x: -1 / m.sqrt(1 - x * x) if abs(x) < 1 else m.mpf(0)),
    _elementary("atan", np.arctan, lambda m, v, x: 1 / (1 + x * x)),
    _elementary("sinh", np.sinh, lambda m, v, x: m.cosh(x)),
    _elementary("cosh", np.cosh, lambda m, v, x: m.sinh(x)),
    _elementary("tanh", np.tanh, lambda m, v, x: 1 - v * v),
    _elementary("asinh", np.arcsinh, lambda m, v, x: 1 / m.sqrt(1 + x * x)),
    _elementary("acosh", np.arccosh, lambda m, v, x: 1 / m.sqrt(x * x - 1) if x > 1 else m.mpf(0)),
    _elementary("atanh", np.arctanh, lambda m, v, x: 1 / (1 - x * x) if abs(x) < 1 else m.mpf(0)),
    _elementary("exp", np.exp, lambda m, v, x: v),
    _elementary("log", np.log, lambda m, v, x: 1 / x if x != 0 else m.mpf(0)),
    Op("atan2", 2, np.arctan2, lambda m, y, x: m.atan2(y, x), _atan2_partials, ulps=4.0, cost=30),
    Op("abs", 1, np.abs, lambda m, x: abs(x), lambda m, v, x: (_sign(m, x),), ulps=0.0),
    Op("sign", 1, np.sign, _sign, _flat(1), ulps=0.0, cost=2),
    Op("min", 2, np.minimum, _exact_min, lambda m, v, a, b: (m.mpf(a <= b), m.mpf(b < a)), ulps=0.0, commutative=True),
    Op("max", 2, np.maximum, _exact_max, lambda m, v, a, b: (m.mpf(a >= b), m.mpf(b > a)), ulps=0.0, commutative=True),
    _comparison("lt", np.less, lambda a, b: a < b),
    _comparison("le", np.less_equal, lambda a, b: a <= b),
    _comparison("eq", np.equal, lambda a, b: a == b),
    Op("and", 2, lambda a, b: np.float64(a != 0 and b != 0), lambda m, a, b: m.mpf(a != 0 and b != 0), _flat(2), ulps=0.0, commutative=True),
    Op("or", 2, lambda a, b: np.float64(a != 0 or b != 0), lambda m, a, b: m.mpf(a != 0 or b != 0), _flat(2), ulps=0.0, commutative=True),
    Op("not", 1, lambda a: np.float64(a == 0), lambda m, a: m.mpf(a == 0), _flat(1), ulps=0.0),
    Op("floor", 1, np.floor, lambda m, x: m.floor(x), _flat(1), ulps=0.0, cost=2),
    Op("mod", 2, np.mod, _exact_mod, _mod_partials, cost=20),
    Op("hypot", 2, np.hypot, lambda m, x, y: m.hypot(x, y), _hypot_partials, ulps=1.0, cost=15, commutative=True),
    Op("erf", 1, special.scipy_function("erf"), lambda m, x: m.erf(x), lambda m, v, x: (special.gauss(m, x),), ulps=4.0, cost=30),
    Op("erfc", 1, special.scipy_function("erfc"), special.erfc, lambda m, v, x: (-special.gauss(m, x),), ulps=8.0, cost=40, scale=special.erfc_scale),
    Op("expm1", 1, np.expm1, special.expm1, lambda m, v, x: (m.exp(x),), ulps=4.0, cost=20),
    _elementary("log1p", np.log1p, lambda m, v, x: 1 / (1 + x) if x > -1 else m.mpf(0)),
    _bessel("besselj", "jv", 16.0),
    _bessel("bessely", "yv", 16.0),
    Op("stumpff", 2, stumpff.double, stumpff.exact, lambda m, v, k, z: (m.mpf(0), stumpff.slope(m, k, z)), ulps=4.0, cost=50, scale=stumpff.scale),
    Op("table", 1, special.table_double, special.table_exact, lambda m, v, t, x: (special.table_slope(m, t, x),), ulps=6.0, cost=15, scale=special.table_scale),
    Op("factor", VARIADIC, linsolve.factor_double, linsolve.factor_exact, _flat(0), cost=0),
    Op("back", VARIADIC, linsolve.back_double, linsolve.back_exact, _flat(0), cost=0),
    Op("item", 1, lambda k, solution: solution[k], lambda m, k, solution: solution[k], _flat(0), ulps=0.0, cost=0),
    Op("select", 3, lambda c, a, b: a if c != 0 else b, _choose, lambda m, v, c, a, b: (m.mpf(0), m.mpf(c != 0), m.mpf(c == 0)), ulps=0.0),
)  # fmt: skip

OPS: dict[str, Op] = {row.name: row for row in _ROWS}

TRUTH_VALUES = frozenset({"lt", "le", "eq", "and", "or", "not"})
"""Operations whose value is 0 or 1 and serves as a condition."""

INTEGER_FIRST = frozenset({"besselj", "bessely", "stumpff"})
"""Operations whose first operand is an integer constant: order n >= 0, or k >= 1 of `stumpff`."""

WITH_DATA = frozenset({"table", "factor", "item"})
"""Operations whose instruction holds data, as its ``value``."""

SOLVE = frozenset({"factor", "back", "item"})
"""Operations of linear systems (see `codegen.ir.linsolve`)."""

BLOCKS = frozenset({"factor", "back"})
"""Operations whose value is no number: a factorisation, a solution."""

TURNED = "turned"
LEAVES = ("const", "pi", "time", "state", "parameter", "input", "constant", "clock", TURNED)
"""Instructions without operands: exact constants, and slots of the arrays of values."""


Data = Fraction | int | Table | Shape | None
"""What an instruction may hold."""


class Instruction(NamedTuple):
    """An operation on earlier instructions, or a leaf.

    ``value``: the exact number of a ``const``, the slot of a ``state``, ``parameter``, ``input``,
    ``constant`` or ``clock`` (see `codegen.passes.pipeline`) or ``turned`` (`codegen.targets.c_helpers`), the
    table of a ``table``, what `codegen.ir.linsolve` says; None otherwise.
    """

    op: str
    args: tuple[int, ...] = ()
    value: Data = None

    @property
    def slot(self) -> int:
        """The slot that a leaf reads; 0 for time."""
        return self.value if isinstance(self.value, int) else 0


instruction_of: Callable[[tuple[str, tuple[int, ...], Data]], Instruction] = partial(
    tuple.__new__, Instruction
)
"""The instruction of its three fields, for loops over programs: made in half the time of the class."""


def cost_of(instruction: Instruction) -> int:
    """Return the cost of an instruction in additions; leaves are free."""
    if isinstance(instruction.value, Shape):
        return instruction.value.cost
    if instruction.op == "back":
        return 2 * (len(instruction.args) - 1) ** 2
    return OPS[instruction.op].cost if instruction.op in OPS else 0


def row_of(instruction: Instruction) -> Op:
    """Return the row of an operation; data of the instruction is bound, so that operands are left."""
    row, data = OPS[instruction.op], instruction.value
    if instruction.op not in WITH_DATA:
        return row
    scale = row.scale
    return replace(
        row,
        double=partial(row.double, data),
        exact=lambda m, *args: row.exact(m, data, *args),
        partials=lambda m, v, *args: row.partials(m, v, data, *args),
        scale=(lambda m, v, *args: scale(m, v, data, *args)) if scale else None,
    )
