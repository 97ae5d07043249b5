"""The reference evaluator of programs: in double precision, or with 50 digits and error bounds.

It is slow and simple on purpose; every target is tested against it.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, partial
from itertools import product
from math import inf
from typing import Any

import mpmath
import numpy as np

from codegen.ir import linsolve
from codegen.ir.ops import BLOCKS, OPS, SOLVE, Instruction, Op, row_of
from codegen.ir.program import Program

UNIT_ROUNDOFF = 2.0**-53
SMALLEST = 5e-324
LARGEST_MAGNITUDE = 1_000_000
"""Binary exponent beyond which a value counts as infinite: doubles end at 1024."""
_EDGED = frozenset({"sqrt", "asin", "acos", "acosh", "atanh", "log", "log1p", "floor", "table"})
"""Functions whose derivative is infinite, or that end, at the edge of their domain; or with jumps."""


@dataclass(frozen=True)
class Point:
    """Where a program is evaluated: time, states, parameters, inputs, and the arrays of stages."""

    t: float = 0.0
    x: Sequence[float] = ()
    p: Sequence[float] = ()
    u: Sequence[float] = ()
    constants: Sequence[float] = ()
    clock: Sequence[float] = ()
    turned: Sequence[float] = ()

    def slot(self, instruction: Instruction) -> float:
        """Return the number that a leaf reads."""
        if instruction.op == "time":
            return self.t
        arrays = {
            "state": self.x,
            "parameter": self.p,
            "input": self.u,
            "constant": self.constants,
            "clock": self.clock,
            "turned": self.turned,
        }
        assert isinstance(instruction.value, int)
        return float(arrays[instruction.op][instruction.value])


def random_point(program: Program, seed: int) -> Point:
    """Return a point with time in (0, 1) and each slot of the program in (1/2, 3/2)."""
    draw = random.Random(seed)  # noqa: S311 - reproducible points
    sizes = dict.fromkeys(("state", "parameter", "input"), 0)
    for op, _, value in program.instructions:
        if op in sizes and isinstance(value, int):
            sizes[op] = max(sizes[op], value + 1)
    x, p, u = ([draw.uniform(0.5, 1.5) for _ in range(size)] for size in sizes.values())
    return Point(draw.random(), x, p, u)


@dataclass(frozen=True)
class Bounded:
    """A value at high precision and a bound of the error that double precision makes in it.

    Factorisations and solutions have an error for each entry.
    """

    value: Any
    error: Any


def interpret(program: Program, point: Point) -> dict[str, list[float]]:
    """Evaluate each group of results in IEEE double precision, one operation after the other.

    What depends on constants alone is rounded once, as in every target: see `constants`.
    """
    known = {k: np.float64(value) for k, value in constants(program).items()}
    with np.errstate(all="ignore"):
        values = evaluated(
            program,
            lambda i: np.float64(point.slot(i)),
            lambda i, a: row_of(i).double(*a),
            known,
        )
    blocks = {k for k, i in enumerate(program.instructions) if i.op in BLOCKS}
    return {
        g: [values[k] if k in blocks else float(values[k]) for k in r]
        for g, r in program.results.items()
    }


def evaluated(
    program: Program,
    leaf: Callable[[Instruction], Any],
    operation: Callable[[Instruction, list[Any]], Any],
    known: Mapping[int, Any] | None = None,
    numbers: Iterable[int] | None = None,
) -> dict[int, Any]:
    """Return values of any kind by the number of the instruction, one operation after the other.

    ``leaf``, ``operation``: the value of a leaf, and that of an operation on values. ``known``: values that
    are not computed. ``numbers``: which are wanted, in order, with all that they need; all if left out.
    """
    values = dict(known or {})
    for k in range(len(program.instructions)) if numbers is None else numbers:
        instruction = program.instructions[k]
        if k in values:
            continue
        if instruction.op in OPS:
            values[k] = operation(instruction, [values[a] for a in instruction.args])
        else:
            values[k] = leaf(instruction)
    return values


@lru_cache(maxsize=256)
def constants(program: Program) -> dict[int, float]:
    """Return the double nearest to each value that depends on constants alone.

    Such values are computed with 50 digits and rounded once; no target computes them.
    """
    instructions = program.instructions
    return {
        k: _double(instructions[k].value) if instructions[k].op == "const" else float(value)
        for k, value in constants_exactly(program, 50).items()
    }


@lru_cache(maxsize=16)
def constants_exactly(program: Program, digits: int) -> dict[int, Any]:
    """Return each value that depends on constants alone with ``digits`` digits, as numbers of mpmath."""
    context = _context(digits)
    exact: dict[int, Any] = {}
    for k, instruction in enumerate(program.instructions):
        op, args, _ = instruction
        if op in {"const", "pi"}:
            exact[k] = _leaf_exact(instruction, Point(), context)
            continue
        for a in args:
            if a not in exact:
                break
        else:
            if op in OPS and op not in SOLVE:
                operands = [exact[a] for a in args]
                exact[k] = _real(context, partial(row_of(instruction).exact, context, *operands))
    return exact


def interpret_exactly(program: Program, point: Point, digits: int = 50) -> dict[str, list[Any]]:
    """Evaluate each group of results with ``digits`` digits; arguments are taken as exact.

    Where a result is not a real number, it is NaN.
    """
    context = _context(digits)
    values = evaluated(
        program,
        lambda i: _leaf_exact(i, point, context),
        lambda i, a: _real(context, lambda: row_of(i).exact(context, *a)),
    )
    return {g: [values[k] for k in r] for g, r in program.results.items()}


def interpret_with_bound(
    program: Program, point: Point, digits: int = 50
) -> dict[str, list[Bounded]]:
    """Evaluate with ``digits`` digits, and bound what double precision loses on the way.

    Running error analysis to first order (Higham, Accuracy and Stability of Numerical Algorithms,
    2nd ed., sect. 3.3): each operation adds its own rounding error, from the table of operations,
    to those of its arguments times its partial derivatives. The bound is doubled to cover the
    terms of second order; it says nothing at jumps of ``sign`` and of conditions, and is infinite
    where an argument may leave the domain.
    """
    m = _context(digits)

    def leaf(instruction: Instruction) -> Bounded:
        value = _leaf_exact(instruction, point, m)
        exact = instruction.op not in {"const", "pi"}
        return Bounded(value, 0.0 if exact else float(abs(value)) * UNIT_ROUNDOFF + SMALLEST)

    def operation(instruction: Instruction, args: list[Bounded]) -> Bounded:
        row = row_of(instruction)
        if row.name in SOLVE:
            return _solve_with_bound(m, row, args)
        operands = [a.value for a in args]
        value = _real(m, lambda: row.exact(m, *operands))
        if not m.isfinite(value):
            return Bounded(value, inf)
        carried = _carried(m, row, value, args)
        size = row.scale(m, value, *operands) if row.scale else abs(value)
        rounding = 2 * row.ulps * UNIT_ROUNDOFF * float(size) + (SMALLEST if row.ulps else 0.0)
        return Bounded(value, carried + rounding)

    values = evaluated(program, leaf, operation)
    return {
        g: [Bounded(values[k].value, 2 * values[k].error) for k in r]
        for g, r in program.results.items()
    }


def _solve_with_bound(m: Any, row: Op, args: list[Bounded]) -> Bounded:
    """Bound the errors of a factorisation, a solution or an entry of it; see `linsolve.bound`."""
    values, errors = [a.value for a in args], [a.error for a in args]
    if row.name == "item":
        return Bounded(row.exact(m, values[0]), row.exact(m, errors[0]))
    if row.name == "factor":
        return Bounded(row.exact(m, *values), row.double(*errors))
    solution = row.exact(m, *values)
    if not all(m.isfinite(x) for x in solution):
        return Bounded(solution, [inf] * len(solution))
    return Bounded(solution, linsolve.bound(m, values[0], errors[0], values[1:], errors[1:]))


def _carried(m: Any, row: Op, value: Any, args: list[Bounded]) -> float:
    """Bound what the errors of the arguments make of the value of an operation.

    To first order by the partial derivatives, but where these fail: the larger error for min and
    max, the sum for a norm, the worst corner for functions with an edge, a kink or a jump, infinite at
    the cut of atan2 (zeros have a sign).
    """
    op = row.name
    errors = [a.error for a in args]
    operands = [a.value for a in args]
    if op == "atan2" and operands[1] <= errors[1] and abs(operands[0]) <= errors[0]:
        return inf
    if not any(errors):
        return 0.0
    if op in {"min", "max", "abs"}:
        return float(max(errors))
    if op == "hypot":
        return float(sum(errors))
    if op == "mod":
        return _carried_by_mod(m, value, operands, errors)
    if op in _EDGED:
        shifts = product(*((e, -e) for e in errors))
        ends = [
            _real(m, partial(row.exact, m, *(o + d for o, d in zip(operands, shift, strict=True))))
            for shift in shifts
        ]
        return max(float(abs(e - value)) if m.isfinite(e) else inf for e in ends)
    slopes = row.partials(m, value, *operands)
    return sum(abs(float(s)) * e if s and e else 0.0 for s, e in zip(slopes, errors, strict=True))


def _carried_by_mod(m: Any, value: Any, operands: list[Any], errors: list[float]) -> float:
    """To first order inside a period; the whole period where the errors may reach its ends."""
    a, b = operands
    if abs(b) <= errors[1]:
        return inf
    inside = errors[0] + float(abs(m.floor(a / b))) * errors[1]
    is_safe = inside < min(abs(value), abs(b) - abs(value))
    return inside if is_safe else float(abs(b)) + errors[1]


@lru_cache(maxsize=16)
def _context(digits: int) -> Any:
    """Return a context of our own with so many digits; to make one takes longer than many values."""
    context = mpmath.mp.clone()
    context.dps = digits
    return context


def _leaf_exact(instruction: Instruction, point: Point, m: Any) -> Any:
    if instruction.op == "const":
        assert isinstance(instruction.value, Fraction)
        return _quotient(m, *instruction.value.as_integer_ratio())
    return +m.pi if instruction.op == "pi" else m.mpf(point.slot(instruction))


def _double(value: Any) -> float:
    return _rounded(*value.as_integer_ratio())  # whole numbers are found at once, fractions are not


@lru_cache(maxsize=4096)
def _rounded(above: int, below: int) -> float:
    return float(_quotient(_context(50), above, below))


@lru_cache(maxsize=4096)
def _quotient(m: Any, above: int, below: int) -> Any:
    return m.mpf(above) / below


def _real(m: Any, evaluate: Callable[[], Any]) -> Any:
    """Evaluate; whatever is not a real number is NaN, and whatever is huge beyond use infinite."""
    try:
        value = evaluate()
    except (ValueError, ZeroDivisionError, OverflowError):
        return m.nan
    if isinstance(value, list | m.matrix):
        return value
    if isinstance(value, m.mpc):
        return m.nan
    huge = m.isfinite(value) and value != 0 and m.mag(value) > LARGEST_MAGNITUDE
    return m.sign(value) * m.inf if huge else value
