"""Where the rounding errors of a program come from, and how well-conditioned its results are.

All values and derivatives are taken with 50 digits by the reverse mode (Griewank and Walther,
Evaluating Derivatives, 2nd ed., sect. 3.2). To first order the error of a result is the sum over all
operations of adjoint times own rounding error (Higham, Accuracy and Stability of Numerical
Algorithms, 2nd ed. 2002, sect. 3.3); the condition number is componentwise and relative (ibid.,
sect. 1.6): the sum of |x_k df/dx_k| over |f|.

Sizes of the terms that results are made of: what a small result is small beside.

The size of a sum is the sum of the sizes of its terms; that of a product is what the terms of one factor
make with the other as it is, the larger of both; and so on through nested sums and products. Of what is
neither it is the size of the value. Sizes of two factors are not multiplied: where both cancel, as in the
square of a difference, that would be a size which no term has. A closure of a linkage that is 4e-16 m of
terms of 1 m has the size 2 m or so, and a kinetic energy, whose terms are all positive, its own. Source:
the condition number of a sum, sum |x_i| / |sum x_i| (Higham, Accuracy and Stability of Numerical
Algorithms, 2nd ed., sect. 4.2), taken through a program.

A constant of the motion that is zero because the states in it are, but for rounding, has terms of the size
of that rounding alone. It is measured by what it would be if these states had the size of others of their
unit (`Sizes.reach`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import mpmath
import numpy as np
from numpy.typing import NDArray

from codegen.compiling.compiled import TARGETS, Compiled
from codegen.frontend.layout import Layout
from codegen.ir import linsolve
from codegen.ir.interpret import Point, constants, interpret, interpret_exactly
from codegen.ir.linsolve import Shape
from codegen.ir.ops import BLOCKS, OPS, Instruction, row_of
from codegen.ir.passes import needed, prune
from codegen.ir.program import INVARIANTS, OUTPUTS, Builder, Program

Array = NDArray[np.float64]
SMALL = 1e-8
"""Part of the size of their unit by which states are moved, to see how far a constant reaches."""
GENEROUS = 1 + 2.0**-45
"""A change is taken away with what its own rounding may be."""
POINTS = 64
"""Stored points of a run at most at which terms are looked at, evenly, both ends among them."""

_Rule = Callable[[Builder, Sequence[int], Sequence[int]], int]
"""``(builder, values of arguments, sizes of arguments)`` to the size."""


def _same(op: str) -> _Rule:
    return lambda b, args, sizes: b.add(op, *sizes)


def _of_product(b: Builder, args: Sequence[int], sizes: Sequence[int]) -> int:
    """Return the larger of what the terms of one factor make, the other as it is."""
    first, second = (b.add("abs", k) for k in args)
    return b.add("max", b.add("mul", sizes[0], second), b.add("mul", first, sizes[1]))


_RULES: dict[str, _Rule] = {
    "add": _same("add"),
    "sub": _same("add"),
    "mul": _of_product,
    "hypot": _same("hypot"),
    "sqrt": _same("sqrt"),
    "neg": lambda b, args, sizes: sizes[0],
    "abs": lambda b, args, sizes: sizes[0],
    "div": lambda b, args, sizes: b.add("div", sizes[0], b.add("abs", args[1])),
    "select": lambda b, args, sizes: b.add("select", args[0], *sizes[1:]),
}
"""Sizes of what is made of terms; of every other operation the size is that of its value."""


def sizes_program(program: Program, group: str) -> Program:
    """Return the program of the sizes of a group of results. Law: each is at least the result's."""
    source = prune(program, [group])
    b = Builder(program.rules)
    values: list[int] = []
    sizes: list[int] = []
    for instruction in source.instructions:
        value = b.again(instruction, values)
        args = [values[a] for a in instruction.args]
        below = [sizes[a] for a in instruction.args]
        rule = _RULES.get(instruction.op)
        values.append(value)
        sizes.append(rule(b, args, below) if rule else _own(b, instruction, value))
    return prune(b.program({group: [sizes[k] for k in source.results[group]]}))


def _own(b: Builder, instruction: Instruction, value: int) -> int:
    """Return the size of a value by itself; factorisations and solutions are no numbers and have none."""
    return value if instruction.op in {"factor", "back"} else b.add("abs", value)


@dataclass(frozen=True)
class Sizes:
    """Sizes of the terms of a group of results of a system, by default the constants of the motion.

    They are found by functions in NumPy, which ``compiled`` keeps.
    """

    compiled: Compiled
    group: str = INVARIANTS

    def terms(self, t: Array | float, x: Array, p: Array, u: Array) -> Array:
        """Return the sizes (k, N) at N points; shapes as of the functions of ``compiled``."""
        return np.asarray(_function(self.compiled, self.group)(t, x, p, u))

    def reach(self, t: Array | float, x: Array, p: Array, u: Array) -> Array:
        """Return by how much each constant would change, to first order, by states of full size, (k, N).

        ``x`` (n, N). States of one unit have one size at a point, the largest of them.
        """
        size = of_unit(self.compiled.layout, np.abs(x))
        function = self.compiled.functions[self.group]
        start = function(t, x, p, u)
        total = np.zeros_like(start)
        for k in range(len(x)):
            moved = x.copy()
            moved[k] += SMALL * size[k]
            total += np.abs(function(t, moved, p, u) - start)
        return np.asarray(total / SMALL)


def of_unit(layout: Layout, sizes: Array) -> Array:
    """Return for each state (n, ...) the largest of the sizes of the states of its unit."""
    found = np.empty_like(sizes)
    units = [q.unit for q in layout.states]
    for unit in dict.fromkeys(units):
        rows = [k for k, own in enumerate(units) if own == unit]
        found[rows] = np.max(sizes[rows], axis=0)
    return found


def scale_of(terms: Array, change: Array, reach: Array) -> Array:
    """Return what changes of constants are compared with, (k,).

    ``terms``, ``change``, ``reach`` (k, N): sizes, changes and reaches at N points. The largest size on the
    way counts less the change there: terms that are wrong do not hide that they are. Constants whose
    terms are a part of `SMALL` of their reach are made of rounding; they are compared with that.
    """
    with np.errstate(invalid="ignore"):
        right = np.where(np.isfinite(terms), terms - GENEROUS * np.abs(change), -np.inf)
    at = np.argmax(right, axis=1)[:, None]
    size, full = (np.take_along_axis(a, at, axis=1)[:, 0] for a in (right, reach))
    return measured(size, full)


def measured(size: Array, reach: Array) -> Array:
    """Return the size, or the reach of what is made of rounding."""
    return np.asarray(np.where(size > SMALL * reach, size, reach))


def _function(compiled: Compiled, group: str) -> Callable[..., Array]:
    """Return the sizes as a function of NumPy; ``compiled`` keeps it."""
    key = ("sizes", group)
    if key not in compiled.derived:
        layout = compiled.layout
        own = replace(
            layout,
            results={OUTPUTS: (), INVARIANTS: (), group: layout.results[group]},
            coordinates=(),
            name=f"{layout.name}_sizes",
        )
        program = sizes_program(compiled.program, group)
        _, functions, _ = TARGETS["numpy"](program, own)
        compiled.derived[key] = functions[group]
    found = compiled.derived[key]
    assert callable(found)
    return found


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
        """Return whether a value that ``result`` depends on is too small for a normal double."""
        inside = self._inside(result)
        return any(self.values[k] != 0 and abs(self.values[k]) < SMALLEST_NORMAL for k in inside)

    def overflows(self, result: int) -> bool:
        """Return whether double precision meets an infinity on the way to ``result``."""
        inside = self._inside(result)
        return any(math.isinf(self.doubles[k]) for k in inside)


def operations(program: Program, result: int) -> int:
    """Return the number of operations that value ``result`` depends on, constants left out."""
    inside = needed(replace(program, results={ALL: (result,)}), [ALL])
    known = constants(program)
    return sum(program.instructions[k].op in OPS and k not in known for k in inside)
