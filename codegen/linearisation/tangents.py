"""Derivatives of a program at one point, by carrying them along with the values; nothing is generated.

For a single point this is sooner done than deriving and compiling a Jacobian (`codegen.compiling.linear`),
which pays from some hundreds of points on. Partial derivatives are those of the table of operations.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import mpmath
import numpy as np
from numpy.typing import NDArray

from codegen.ir.interpret import Point, constants
from codegen.ir.linsolve import Shape, whole
from codegen.ir.ops import OPS, Instruction, row_of
from codegen.ir.passes import needed
from codegen.ir.program import Program

Array = NDArray[np.float64]

_LONGER = frozenset({"besselj", "bessely", "stumpff", "table", "erf", "erfc", "mod"})
"""Operations whose derivatives are computed with some digits more than doubles have."""


class Carried(NamedTuple):
    """A value and its derivatives: numbers and vectors; of linear systems, arrays and one axis more."""

    value: Any
    slope: Any


def tangents(
    program: Program, groups: Iterable[str], by: Sequence[Instruction], point: Point
) -> tuple[Array, Array]:
    """Return the results of groups, one after the other, and their derivatives: (results, leaves).

    ``by``: leaves to differentiate by. Where an operation has no value, NaN.
    """
    names = list(groups)
    units = dict(zip(by, np.eye(len(by)), strict=True))
    known = constants(program)
    carried: dict[int, Carried] = {}
    with np.errstate(all="ignore"):
        for k in sorted(needed(program, names)):
            instruction = program.instructions[k]
            if k in known:
                carried[k] = Carried(np.float64(known[k]), 0.0)
            elif instruction.op in OPS:
                carried[k] = _operation(instruction, [carried[a] for a in instruction.args])
            else:
                carried[k] = Carried(
                    np.float64(point.slot(instruction)), units.get(instruction, 0.0)
                )
    found = [carried[k] for name in names for k in program.results[name]]
    slopes = [np.broadcast_to(c.slope, len(by)) for c in found]
    values = np.array([c.value for c in found], dtype=np.float64)
    return values, np.array(slopes, dtype=np.float64).reshape(len(found), len(by))


def _operation(instruction: Instruction, args: Sequence[Carried]) -> Carried:
    if instruction.op in _SOLVING:
        return _SOLVING[instruction.op](instruction, args)
    row = row_of(instruction)
    value = row.double(*(a.value for a in args))
    varying = [k for k, a in enumerate(args) if isinstance(a.slope, np.ndarray)]
    if not varying:
        return Carried(value, 0.0)
    m = _digits() if instruction.op in _LONGER else mpmath.fp
    try:
        partials = row.partials(m, m.mpf(value), *(m.mpf(a.value) for a in args))
        slope = sum(float(partials[k]) * args[k].slope for k in varying)
    except (ValueError, ZeroDivisionError, OverflowError, TypeError):
        slope = np.nan * args[varying[0]].slope
    return Carried(value, slope)


@lru_cache(maxsize=1)
def _digits() -> Any:
    context = mpmath.mp.clone()
    context.dps = 20
    return context


def _factor(instruction: Instruction, args: Sequence[Carried]) -> Carried:
    shape = instruction.value
    assert isinstance(shape, Shape)
    values = np.array(whole(shape, [a.value for a in args]), dtype=np.float64)
    return Carried(
        values, _stacked([c.slope for row in whole(shape, args) for c in row], values.shape)
    )


def _back(instruction: Instruction, args: Sequence[Carried]) -> Carried:  # noqa: ARG001
    """Return x = A^-1 b and dx = A^-1 (db - dA x)."""
    matrix, *right = args
    b = np.array([r.value for r in right], dtype=np.float64)
    db = _stacked([r.slope for r in right], b.shape)
    try:
        x = np.linalg.solve(matrix.value, b)
        slopes = np.broadcast_to(
            np.einsum("ijk,j->ik", matrix.slope, x), _wider(matrix.slope, db, b)
        )
        return Carried(x, np.linalg.solve(matrix.value, db - slopes))
    except np.linalg.LinAlgError:
        return Carried(np.nan * b, np.nan * db)


def _wider(dA: Array, db: Array, b: Array) -> tuple[int, int]:
    return (len(b), max(dA.shape[-1], db.shape[-1]))


def _item(instruction: Instruction, args: Sequence[Carried]) -> Carried:
    (solution,) = args
    place = instruction.slot
    return Carried(solution.value[place], solution.slope[place])


def _stacked(slopes: Sequence[Any], shape: tuple[int, ...]) -> Array:
    """Return derivatives of entries as one array, the leaves last; one zero where nothing varies."""
    count = max((len(s) for s in slopes if isinstance(s, np.ndarray)), default=1)
    return np.array([np.broadcast_to(s, count) for s in slopes]).reshape(*shape, count)


_Rule = Callable[[Instruction, Sequence[Carried]], Carried]
_SOLVING: Mapping[str, _Rule] = {
    "factor": _factor,
    "back": _back,
    "item": _item,
}
