"""Derivatives of programs by a complex step with 50 digits: a check of those by rules.

Im f(x + i h) / h = f'(x) + O(h^2): nothing is subtracted, so that h may be so small that the error is
that of the arithmetic (Squire and Trapp, SIAM Review 40, 1998, p. 110). Operations that are no analytic
functions are extended by f(a + i b) = f(a) + i (f(a + b) - f(a - b))/2, which with so many digits
leaves more than double precision has; at a corner, where the three values do not lie on a line, there is
none. No rule of `codegen.derivatives.derivative` is used.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

from codegen.ir.interpret import Point
from codegen.ir.ops import OPS, SOLVE, Instruction, Op, row_of
from codegen.ir.passes import needed
from codegen.ir.program import Program

Array = NDArray[np.float64]

DIGITS = 50
STEP_DIGITS = 20
"""The step is 10 to minus this: its square, and what differences lose, are below 1e-29."""
_ANALYTIC = frozenset({
    "add", "sub", "mul", "div", "neg", "sqrt", "pow", "sin", "cos", "tan", "atan", "sinh", "cosh",
    "tanh", "asinh", "exp", "log", "log1p", "expm1", *SOLVE,
})  # fmt: skip
"""Operations whose row at any precision holds for complex numbers as it is."""


def complex_step(
    program: Program, groups: Sequence[str], by: Sequence[Instruction], point: Point
) -> Array:
    """Return the derivatives of groups of results, one after the other, by leaves: (results, leaves).

    ``by``: instructions of states, inputs, parameters or time, without operands. NaN where an operation
    has no value or a corner.
    """
    m = mpmath.mp.clone()
    m.dps = DIGITS
    step = m.mpf(10) ** -STEP_DIGITS
    order = sorted(needed(program, list(groups)))
    places = [k for group in groups for k in program.results[group]]
    columns = [_values(m, program, order, point, leaf, step) for leaf in by]
    found = np.array(
        [[float(m.im(column[k]) / step) for column in columns] for k in places], dtype=np.float64
    )
    return found.reshape(len(places), len(by))


def _values(
    m: Any,
    program: Program,
    order: Sequence[int],
    point: Point,
    seed: Instruction,
    step: Any,
) -> Mapping[int, Any]:
    values: dict[int, Any] = {}
    for k in order:
        instruction = program.instructions[k]
        if instruction.op in OPS:
            args = [values[a] for a in instruction.args]
            values[k] = _operation(m, row_of(instruction), args)
        else:
            values[k] = _leaf(m, instruction, point)
            if instruction == seed:
                values[k] = m.mpc(values[k], step)
    return values


def _leaf(m: Any, instruction: Instruction, point: Point) -> Any:
    if instruction.op == "const":
        number: Any = instruction.value
        return m.mpf(number.numerator) / number.denominator
    return +m.pi if instruction.op == "pi" else m.mpf(point.slot(instruction))


def _operation(m: Any, row: Op, args: list[Any]) -> Any:
    """Return a value; real where all operands are, so that what does not vary stays exact."""
    varies = row.name in SOLVE or any(isinstance(a, m.mpc) for a in args)
    try:
        if row.name in _ANALYTIC or not varies:
            return row.exact(m, *args)
        if row.name == "select":
            return row.exact(m, m.re(args[0]), *args[1:])
        return _extended(m, row, args)
    except (ValueError, ZeroDivisionError, OverflowError):
        return m.nan


def _extended(m: Any, row: Op, args: list[Any]) -> Any:
    here = [m.re(a) for a in args]
    value = row.exact(m, *here)
    above, below = (
        row.exact(m, *(a + sign * m.im(b) if isinstance(b, m.mpc) else a
                       for a, b in zip(here, args, strict=True)))
        for sign in (1, -1)
    )  # fmt: skip
    most = max(abs(m.im(a)) for a in args)
    if abs(above + below - 2 * value) > most * m.sqrt(most):  # in proportion to the step: a corner
        return m.nan
    return m.mpc(value, (above - below) / 2)
