"""Where the rounding errors of a program come from, and how well-conditioned its results are.

All values and derivatives are taken with 50 digits by the reverse mode (Griewank and Walther,
Evaluating Derivatives, 2nd ed., sect. 3.2). To first order the error of a result is the sum over all
operations of adjoint times own rounding error (Higham, Accuracy and Stability of Numerical
Algorithms, 2nd ed. 2002, sect. 3.3); the condition number is componentwise and relative (ibid.,
sect. 1.6): the sum of |x_k df/dx_k| over |f|.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import mpmath

from codegen.ir import linsolve
from codegen.ir.interpret import Point, constants, interpret, interpret_exactly
from codegen.ir.linsolve import Shape
from codegen.ir.ops import BLOCKS, OPS, row_of
from codegen.ir.passes import needed
from codegen.ir.program import Program

Number = Any  # a mpmath real

DIGITS = 50
ALL = "all"
MAX_LOST = -math.log10(2.0**-53)
"""Digits that a double has; no operation loses more."""
SMALLEST_NORMAL = 2.0**-1022
MATTERS = 0.1
"""Share of a result's error below which an operation is not named."""
_ARGUMENTS = frozenset({"time", "state", "parameter", "input"})


class Cause(NamedTuple):
    """The operation that a result owes most of its error to.

    ``number``: of the instruction. ``digits``: decimal digits that the operation loses by making
    inherited relative errors larger; 0 where the error is its own rounding. ``share``: of the
    result's error that passes through it, 0 to 1.
    """

    number: int
    digits: float
    share: float


def everything(program: Program) -> Program:
    """Return the program with every value as a result of the one group `ALL`."""
    return replace(program, results={ALL: tuple(range(len(program.instructions)))})


@dataclass(frozen=True, eq=False)
class Trace:
    """Every value of a program at one point, with 50 digits; ``every`` is from `everything`."""

    every: Program
    point: Point

    @cached_property
    def values(self) -> list[Number]:
        """Every value, with 50 digits."""
        return interpret_exactly(self.every, self.point, DIGITS)[ALL]

    @cached_property
    def doubles(self) -> list[float]:
        """Every value as double precision computes it, errors inherited."""
        return interpret(self.every, self.point)[ALL]

    @cached_property
    def _context(self) -> Any:
        context = mpmath.mp.clone()
        context.dps = DIGITS
        return context

    @cached_property
    def _partials(self) -> dict[int, tuple[Number, ...]]:
        return {}

    def arguments(self, k: int) -> tuple[int, ...]:
        """Return the values that value ``k`` is computed from.

        An entry of the solution of a linear system is computed from the right-hand side and the
        entries of the matrix.
        """
        op, args, _ = self.every.instructions[k]
        if op != "item":
            return args if op in OPS and op not in BLOCKS else ()
        factor, *right = self.every.instructions[args[0]].args
        return (*right, *self.every.instructions[factor].args)

    def partials(self, k: int) -> tuple[Number, ...]:
        """Return the partial derivatives of value ``k`` by its `arguments`; NaN where infinite."""
        if k not in self._partials:
            args = self.arguments(k)
            try:
                found = self._derived(k, args) if args else ()
            except (ValueError, ZeroDivisionError, OverflowError):
                found = (self._context.nan,) * len(args)
            self._partials[k] = found
        return self._partials[k]

    def _derived(self, k: int, args: tuple[int, ...]) -> tuple[Number, ...]:
        instruction = self.every.instructions[k]
        if instruction.op != "item":
            row = row_of(instruction)
            return row.partials(self._context, self.values[k], *(self.values[a] for a in args))
        solution = instruction.args[0]
        factor = self.every.instructions[solution].args[0]
        shape = self.every.instructions[factor].value
        assert isinstance(shape, Shape)
        unit = [self._context.mpf(int(i == instruction.slot)) for i in range(shape.size)]
        row_of_inverse = linsolve.back_exact(self._context, self.values[factor].T, *unit)
        x = self.values[solution]
        by_entries = [
            -row_of_inverse[i] * x[j]
            - (row_of_inverse[j] * x[i] if shape.symmetric and i != j else 0)
            for i, j in shape.places
        ]
        return (*row_of_inverse, *by_entries)

    def adjoint(self, result: int) -> dict[int, Number]:
        """Return the derivative of value ``result`` by every value that it depends on."""
        bars: dict[int, Number] = {result: self._context.mpf(1)}
        for k in range(result, -1, -1):
            bar = bars.get(k)
            if not bar or self.every.instructions[k].op not in OPS:
                continue
            for a, slope in zip(self.arguments(k), self.partials(k), strict=True):
                if slope:
                    bars[a] = bars.get(a, 0) + bar * slope
        return bars

    def sensitivity(self, result: int) -> Number:
        """Return the sum of |x_k df/dx_k| over time, states, parameters and inputs."""
        bars = self.adjoint(result)
        leaves = [k for k in bars if self.every.instructions[k].op in _ARGUMENTS]
        return sum((abs(self.values[k] * bars[k]) for k in leaves), self._context.mpf(0))

    def condition(self, result: int) -> float:
        """Return the condition number; 0 if the result does not vary, infinite at its zeros."""
        value, sensitivity = self.values[result], self.sensitivity(result)
        if not sensitivity:
            return 0.0
        return float(sensitivity / abs(value)) if value else math.inf

    def own_error(self, k: int) -> Number:
        """Return the rounding error that operation ``k`` adds, for the doubles that it is given."""
        known = constants(self.every)
        op = self.every.instructions[k].op
        m = self._context
        if k in known:
            return m.mpf(known[k]) - self.values[k]
        if op not in OPS or op in BLOCKS:
            return m.mpf(0)
        try:
            exact = self._exactly(k, [m.mpf(self.doubles[a]) for a in self.arguments(k)])
        except (ValueError, ZeroDivisionError, OverflowError):
            return m.nan
        return m.mpf(self.doubles[k]) - exact if isinstance(exact, m.mpf) else m.nan

    def _exactly(self, k: int, operands: Sequence[Number]) -> Number:
        """Return value ``k`` for given values of its `arguments`."""
        instruction, m = self.every.instructions[k], self._context
        if instruction.op != "item":
            return row_of(instruction).exact(m, *operands)
        factor = self.every.instructions[instruction.args[0]].args[0]
        shape = self.every.instructions[factor].value
        assert isinstance(shape, Shape)
        matrix = linsolve.factor_exact(m, shape, *operands[shape.size :])
        return linsolve.back_exact(m, matrix, *operands[: shape.size])[instruction.slot]

    def cause(self, result: int) -> Cause | None:
        """Return where the error of ``result`` comes from; None if there is none, or no bound.

        First choice is the operation that loses most digits, weighed by the share of the error that
        it inherits and passes on; where none loses a digit, the one whose own rounding counts most.
        """
        bars = self.adjoint(result)
        own = {k: abs(self.own_error(k)) for k in sorted(bars)}
        inherited = self._inherited(own)
        total = inherited[result] + own[result]
        if not total or not self._context.isfinite(total):
            return None

        def share(k: int, error: Number) -> float:
            return min(1.0, float(abs(bars[k]) * error / total))

        found = [Cause(k, self._digits_lost(k), share(k, inherited[k])) for k in own]
        losing = [c for c in found if c.digits >= 1 and c.share >= MATTERS]
        if losing:
            return max(losing, key=lambda c: c.digits * c.share)
        return max((Cause(k, 0.0, share(k, own[k])) for k in own), key=lambda c: c.share)

    def _inherited(self, own: Mapping[int, Number]) -> dict[int, Number]:
        """Return what the errors of the arguments make of each value, added without regard to sign.

        Arguments that the result does not depend on, as its derivative is zero, are left out.
        """
        found: dict[int, Number] = {}
        for k in own:
            pairs = zip(self.arguments(k), self.partials(k), strict=True)
            errors = [
                abs(slope) * (found[a] + own[a]) for a, slope in pairs if slope and a in found
            ]
            found[k] = sum(errors, self._context.mpf(0))
        return found

    def _digits_lost(self, k: int) -> float:
        """Return the decimal logarithm of the condition number of one operation, within a double."""
        args = self.arguments(k)
        if not args:
            return 0.0
        pairs = zip(args, self.partials(k), strict=True)
        reach = sum(abs(self.values[a] * slope) for a, slope in pairs if slope)
        size = abs(self.values[k])
        if not reach or not self._context.isfinite(reach):
            return 0.0
        if size * 10**MAX_LOST <= reach:
            return MAX_LOST
        return max(0.0, float(self._context.log10(reach / size)))

    def _inside(self, result: int) -> list[int]:
        """Return the numbers that ``result`` depends on."""
        inside = needed(replace(self.every, results={ALL: (result,)}), [ALL])
        return [k for k in inside if self.every.instructions[k].op not in BLOCKS]

    def underflows(self, result: int) -> bool:
        """Tell whether a value that ``result`` depends on is too small for a normal double."""
        inside = self._inside(result)
        return any(self.values[k] != 0 and abs(self.values[k]) < SMALLEST_NORMAL for k in inside)

    def overflows(self, result: int) -> bool:
        """Tell whether double precision meets an infinity on the way to ``result``."""
        inside = self._inside(result)
        return any(math.isinf(self.doubles[k]) for k in inside)


def operations(program: Program, result: int) -> int:
    """Return the number of operations that value ``result`` depends on, constants left out."""
    inside = needed(replace(program, results={ALL: (result,)}), [ALL])
    known = constants(program)
    return sum(program.instructions[k].op in OPS and k not in known for k in inside)
