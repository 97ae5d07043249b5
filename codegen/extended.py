"""Solutions with many digits: Taylor series over whole numbers, by the rules of `codegen.taylor`.

It is the oracle of integrators: slow, without a compiler, and free of rounding in double precision.
Numbers are fixed-point, in units of 2^-BITS. Coefficients are those of time over the step before, so
that none of them leaves the range. The system is the one that every target computes: constants of
its expressions are rounded to doubles once (see `interpret.constants`), all else is exact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from operator import mul
from typing import Any

import mpmath

from codegen.interpret import constants
from codegen.layout import Layout
from codegen.lower import RATES
from codegen.ops import BLOCKS, Instruction, row_of
from codegen.program import Program
from codegen.taylor import RULES, STEPS, Order, Prepared, Series, prepare, residuals
from eom.errors import InputError

BITS = 192
ONE = 1 << BITS
LARGEST_GROWTH = 4
"""A step is at most so many times as long as the one before."""
LEAST_STEP = Fraction(1, 10**15)
"""Steps that are a smaller part of the interval end the run: the solution ends there."""
LOOK = 100
HOPELESS = Fraction(1, 5)
"""The run is given up where the first `LOOK` steps make less than this share of their part."""


@dataclass(frozen=True)
class Solution:
    """States at the end, the largest size of each on the way, and the number of steps."""

    end: tuple[Fraction, ...]
    largest: tuple[float, ...]
    steps: int


@dataclass(frozen=True)
class Values:
    """Numbers that a run starts from, all taken as exact."""

    start: Sequence[float]
    parameters: Sequence[float]
    inputs: Sequence[float]


def integrate(
    program: Program,
    layout: Layout,
    values: Values,
    span: tuple[float, float],
    digits: int,
    max_steps: int,
    progress: Callable[[float], None] | None = None,
) -> Solution:
    """Return the end of a run whose steps each have an error of about 10^-digits of the largest state.

    Raises `InputError` for values without a Taylor series, for rates with branches (a step would have
    to end at each kink), and where the run cannot be completed in ``max_steps``; the first `LOOK`
    steps tell if it is hopeless. ``progress(fraction)`` is called after each step.
    """
    prepared = prepare(program, RATES, layout)
    if prepared.has_branches:
        raise InputError(
            "rates with branches have no Taylor series across these", where=layout.name
        )
    first, end = (Fraction(s) for s in span)
    run = _Run(_Jet(prepared, values), values.start, first, (end - first) / 1000)
    for step in range(max_steps):
        try:
            run.step(end, digits)
        except ZeroDivisionError:
            break
        done = (run.t - first) / (end - first)
        if progress is not None:
            progress(float(done))
        if run.t == end:
            return run.solution(step + 1)
        hopeless = step == LOOK and done * max_steps < HOPELESS * LOOK
        if hopeless or abs(run.unit) < LEAST_STEP * abs(end - first):
            break
    raise InputError(
        "no solution with many digits",
        where=layout.name,
        got=f"{step + 1} steps, to t = {float(run.t)}",
        expected=f"at most {max_steps} steps to the end",
    )


class _Run:
    """Where a run has come to; ``unit``: the last step, and the time in which coefficients are."""

    def __init__(self, jet: _Jet, start: Sequence[float], t: Fraction, unit: Fraction) -> None:
        self.jet, self.t, self.unit = jet, t, unit
        self.state = [_whole(Fraction(float(x))) for x in start]
        self.largest = [abs(x) for x in self.state]

    def step(self, end: Fraction, digits: int) -> None:
        """Make one step, not beyond ``end``."""
        terms = self.jet.series(self.t, self.state, self.unit, math.ceil(1.3 * digits))
        size = _fitting(terms, self.unit, end - self.t, digits)
        self.state = [_summed(row, _whole(size / self.unit)) for row in terms]
        self.largest = [max(a, abs(b)) for a, b in zip(self.largest, self.state, strict=True)]
        self.t, self.unit = self.t + size, size

    def solution(self, steps: int) -> Solution:
        """Return what was found."""
        end = tuple(Fraction(x, ONE) for x in self.state)
        return Solution(end, tuple(x / ONE for x in self.largest), steps)


def _fitting(
    terms: Sequence[Sequence[int]], unit: Fraction, rest: Fraction, digits: int
) -> Fraction:
    """Return the step at which the last terms are 10^-digits of the largest state."""
    size = max(1, *(abs(row[0]) for row in terms)) * Fraction(1, 10**digits)
    order = len(terms[0]) - 1
    shares = [Fraction(LARGEST_GROWTH)]
    for k in (order - 1, order):
        last = max(abs(row[k]) for row in terms)
        if last:
            logarithm = (math.log(size) - math.log(last)) / k
            shares.append(Fraction(math.exp(min(logarithm, 2.0))))
    found = Fraction(float(unit * min(shares)))
    return rest if abs(found) >= abs(rest) else found


def _summed(terms: Sequence[int], at: int) -> int:
    """Return a polynomial, highest term first (Horner)."""
    total = 0
    for term in reversed(terms):
        total = term + (total * at >> BITS)
    return total


def _whole(number: Fraction) -> int:
    return round(number * ONE)


@dataclass(frozen=True)
class _Fixed:
    """A number in units of 2^-BITS, with the operators that the rules use."""

    units: int

    def __neg__(self) -> _Fixed:
        return _Fixed(-self.units)

    def __add__(self, other: _Fixed) -> _Fixed:
        return _Fixed(self.units + other.units)

    def __sub__(self, other: _Fixed) -> _Fixed:
        return _Fixed(self.units - other.units)

    def __rsub__(self, other: Fraction) -> _Fixed:
        return _Fixed(_whole(other) - self.units)

    def __mul__(self, other: _Fixed | Fraction) -> _Fixed:
        if isinstance(other, Fraction):
            return _Fixed(self.units * other.numerator // other.denominator)
        return _Fixed(self.units * other.units >> BITS)


class _Jet(Order):
    """Coefficients of all values of a program, order after order; times ``unit``^k."""

    def __init__(self, prepared: Prepared, values: Values) -> None:
        self.prepared = prepared
        self.instructions = prepared.program.instructions
        self.rates = prepared.program.results[RATES]
        self.known = constants(prepared.program)
        self.slots = {"parameter": values.parameters, "input": values.inputs}
        self.context: Any = mpmath.mp.clone()
        self.context.prec = BITS
        self.rows: list[list[int]] = []
        self.blocks: dict[int, Any] = {}
        """Factorisations, and solutions of the order that is made, by mpmath."""
        self.k = 0

    def series(
        self, t: Fraction, state: Sequence[int], unit: Fraction, order: int
    ) -> list[list[int]]:
        """Return x_0, x_1 unit, x_2 unit^2, ... up to ``order`` of each state."""
        self.rows = [[] for _ in self.instructions]
        states = [[x] for x in state]
        self.k = 0
        for n, instruction in enumerate(self.instructions):
            self.rows[n].append(self._first(n, instruction, t, states))
        for self.k in range(1, order + 1):
            scale = unit / self.k
            for row, rate in zip(states, self.rates, strict=True):
                value = self.rows[rate][self.k - 1]
                row.append(value * scale.numerator // scale.denominator)
            if self.k < order:
                self._advance(states, unit)
        return states

    def _first(
        self, n: int, instruction: Instruction, t: Fraction, states: Sequence[Sequence[int]]
    ) -> int:
        op, args, _ = instruction
        if n in self.known:
            return _whole(Fraction(self.known[n]))
        if op == "state":
            return states[instruction.slot][0]
        if op == "time":
            return _whole(t)
        if op in self.slots:
            return _whole(Fraction(float(self.slots[op][instruction.slot])))
        if op == "mul":
            return self.rows[args[0]][0] * self.rows[args[1]][0] >> BITS
        return self._by_mpmath(n, instruction)

    def _by_mpmath(self, n: int, instruction: Instruction) -> int:
        m = self.context
        operands = [self.blocks.get(a, self._real(self.rows[a][0])) for a in instruction.args]
        found = row_of(instruction).exact(m, *operands)
        if instruction.op in BLOCKS:
            self.blocks[n] = found
            return 0
        if not m.isfinite(found) or isinstance(found, m.mpc):
            raise InputError(f"{instruction.op} is not finite on the way")
        return int(m.nint(m.ldexp(found, BITS)))

    def _real(self, units: int) -> Any:
        return self.context.ldexp(self.context.mpf(units), -BITS)

    def _advance(self, states: Sequence[Sequence[int]], unit: Fraction) -> None:
        """Append the coefficient of order ``k`` of every value."""
        for n, instruction in enumerate(self.instructions):
            op, args, _ = instruction
            row = self.rows[n]
            if op == "state":
                row.append(states[instruction.slot][self.k])
            elif op == "time":
                row.append(_whole(unit) if self.k == 1 else 0)
            elif not self.prepared.varies[n] or op in {*STEPS, "factor"}:
                row.append(0)
            elif op == "back":
                self.blocks[n] = self._solution(n, instruction)
                row.append(0)
            elif op == "item":
                row.append(self._by_mpmath(n, instruction))
            else:
                term = RULES[op].coefficient(self, n, args, self.prepared.partner(n))
                row.append(term.units)

    def _solution(self, n: int, instruction: Instruction) -> Any:
        """Solve for order ``k``: one factorisation serves all orders."""
        right = [self._real(r.units) for r in residuals(self, self.prepared, n)]
        return row_of(instruction).exact(self.context, self.blocks[instruction.args[0]], *right)

    def now(self, a: Series) -> _Fixed:
        return _Fixed(self.rows[a][self.k])

    def first(self, a: Series) -> _Fixed:
        return _Fixed(self.rows[a][0])

    def inverse(self, a: Series) -> _Fixed:
        return _Fixed(ONE * ONE // self.rows[a][0])

    def dot(self, a: Series, b: Series, low: int = 0, high: int = 0) -> _Fixed:
        last = self.k - high + 1
        other = self.rows[b][high : self.k - low + 1]
        return _Fixed(sum(map(mul, self.rows[a][low:last], reversed(other))) >> BITS)

    def moment(self, a: Series, b: Series, high: int = 0) -> _Fixed:
        last = self.k - high + 1
        weighted = map(mul, self.rows[a][1:last], range(1, last))
        other = self.rows[b][high : self.k]
        return _Fixed((sum(map(mul, weighted, reversed(other))) >> BITS) // self.k)

    def choose(self, negative: _Fixed, a: _Fixed, b: _Fixed) -> _Fixed:
        return a if negative.units < 0 else b
