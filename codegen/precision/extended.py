"""Solutions with many digits: Taylor series over whole numbers, by the rules for generated code.

It is the oracle of integrators: slow, without a compiler, and free of rounding in double precision.
Numbers are fixed-point, in units of 2^-bits: `BITS`, and as many more as the numbers of the system take,
those that are small and those that multiply what is small. Coefficients are those of time over the step
before, so that none of them leaves the range. The system is the one that every target computes: constants
of its expressions are rounded to doubles once (see `interpret.constants`), all else is exact. A constant
that no double holds with all its digits, such as 7^-401, is taken as it is.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from operator import mul
from typing import Any

import mpmath
from mpmath.libmp import to_rational

from codegen.derivatives.taylor import RULES, STEPS, Order, Prepared, Series, prepare, residuals
from codegen.frontend.layout import Layout
from codegen.ir.interpret import Point, constants, constants_exactly, interpret, interpret_exactly
from codegen.ir.ops import BLOCKS, Instruction, row_of
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Program
from codegen.watch.trust import BOUNDS, Limit, again, bounds, gains
from eom.errors import InputError

BITS = 192
MOST_BITS = 16 * 1024
CONSTANT_DIGITS = 64
"""Of constants that doubles do not hold: more than `BITS` bits."""
LARGEST_GROWTH = 4
"""A step is at most so many times as long as the one before."""
LEAST_STEP = Fraction(1, 10**15)
"""Steps that are a smaller part of the interval end the run: the solution ends there."""
LOOK = 100
_GAINS = "gains"
HOPELESS = Fraction(1, 5)
"""The run is given up where the first `LOOK` steps make less than this share of their part."""


@dataclass(frozen=True)
class Solution:
    """States at the end, the largest size of each on the way, and the number of steps.

    ``stops``: states at the times that were asked for, the end left out.
    """

    end: tuple[Fraction, ...]
    largest: tuple[float, ...]
    steps: int
    stops: tuple[tuple[Fraction, ...], ...] = ()


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
    stops: Sequence[float] = (),
) -> Solution:
    """Return the end of a run whose steps each have an error of about 10^-digits of the largest state.

    ``stops``: times on the way, in order, at which states are wanted, too.
    Raises `InputError` for values without a Taylor series, for rates with branches (a step would have
    to end at each kink), and where the run cannot be completed in ``max_steps``; the first `LOOK`
    steps show if it is hopeless. ``progress(fraction)`` is called after each step.
    """
    prepared = prepare(program, RATES, layout)
    if prepared.has_branches:
        raise InputError(
            "rates with branches have no Taylor series across these", where=layout.name
        )
    first, end = (Fraction(s) for s in span)
    run = _Run(_Jet(prepared, values, abs(end - first)), values.start, first, (end - first) / 1000)
    ahead = [*map(Fraction, stops), end]
    for step in range(max_steps):
        try:
            run.step(ahead[len(run.stops)], digits)
        except ZeroDivisionError:
            break
        done = (run.t - first) / (end - first)
        if progress is not None:
            progress(float(done))
        if run.t == end:
            return run.solution(step + 1)
        if run.t == ahead[len(run.stops)]:
            run.stop()
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
        self.jet, self.t, self.unit, self.one = jet, t, unit, 1 << jet.bits
        self.state = [jet.whole(Fraction(float(x))) for x in start]
        self.largest = [abs(x) for x in self.state]
        self.stops: list[tuple[Fraction, ...]] = []

    def stop(self) -> None:
        """Keep the state; the next step is tried as long as before."""
        self.stops.append(tuple(Fraction(x, self.one) for x in self.state))

    def step(self, end: Fraction, digits: int) -> None:
        """Make one step, not beyond ``end``."""
        terms = self.jet.series(self.t, self.state, self.unit, math.ceil(1.3 * digits))
        size = _fitting(terms, self.unit, end - self.t, digits)
        size *= self.jet.trusted(size / self.unit, self.t, self.state)
        share = self.jet.whole(size / self.unit)
        self.state = [_summed(row, share, self.jet.bits) for row in terms]
        self.largest = [max(a, abs(b)) for a, b in zip(self.largest, self.state, strict=True)]
        self.t, self.unit = self.t + size, size

    def solution(self, steps: int) -> Solution:
        """Return what was found."""
        end = tuple(Fraction(x, self.one) for x in self.state)
        return Solution(end, tuple(x / self.one for x in self.largest), steps, tuple(self.stops))


def _fitting(
    terms: Sequence[Sequence[int]], unit: Fraction, rest: Fraction, digits: int
) -> Fraction:
    """Return the step at which the last terms are 10^-digits of the largest state."""
    size = math.log(max(1, *(abs(row[0]) for row in terms))) - digits * math.log(10)
    order = len(terms[0]) - 1
    shares = [Fraction(LARGEST_GROWTH)]
    for k in (order - 1, order):
        last = max(abs(row[k]) for row in terms)
        if last:
            logarithm = (size - math.log(last)) / k
            shares.append(Fraction(math.exp(min(logarithm, 2.0))))
    found = Fraction(float(unit * min(shares)))
    return rest if abs(found) >= abs(rest) else found


def _moved(terms: Sequence[int], one: int, at: float) -> float:
    """Return how far a value moves at most; the last two terms, for those behind them, count twice."""
    sizes = [abs(term) / one * at**k for k, term in enumerate(terms)][1:]
    return math.fsum((*sizes, *sizes[-2:]))


def _summed(terms: Sequence[int], at: int, bits: int) -> int:
    """Return a polynomial, highest term first (Horner)."""
    total = 0
    for term in reversed(terms):
        total = term + (total * at >> bits)
    return total


def _known(prepared: Prepared) -> dict[int, Fraction]:
    """Return the constants of a program: as doubles, but for those of which a double loses digits.

    Raises `InputError` for those that have no value.
    """
    program = prepared.program
    exact = constants_exactly(program, CONSTANT_DIGITS)
    found = {}
    for k, value in constants(program).items():
        if not mpmath.isfinite(exact[k]):
            raise InputError("a constant is not finite, or beyond use", got=str(exact[k]))
        double = math.isfinite(value) and (abs(value) >= sys.float_info.min or not exact[k])
        found[k] = Fraction(value) if double else Fraction(*to_rational(exact[k]._mpf_))
    return found


def _working_bits(
    prepared: Prepared, values: Values, known: Mapping[int, Fraction], length: Fraction
) -> int:
    """Return how fine fixed-point numbers are, so that all numbers of a run have `BITS` bits.

    The smallest one adds what it is below 1; what values are multiplied by on their way to the states, with
    the ``length`` of the run, adds as much. Raises `InputError` where that is more than `MOST_BITS`.
    """
    given = [*values.start, *values.parameters, *values.inputs]
    sizes = [abs(n) for n in (*known.values(), *(Fraction(float(x)) for x in given)) if n]
    small = max((-_log2(n) for n in sizes), default=0)
    b, new = again(prepared)
    every = range(len(new))
    found = gains(b, new, prepared, every)
    program = prune(b.program({_GAINS: [found[k].number for k in every]}))
    point = Point(p=values.parameters, u=values.inputs)
    largest = max(interpret_exactly(program, point)[_GAINS])
    gain = mpmath.mag(largest) if mpmath.isfinite(largest) else MOST_BITS
    bits = BITS + max(0, small) + max(0, int(gain) - 1) + max(0, _log2(length))
    if bits > MOST_BITS:
        raise InputError(
            "numbers of the system are too far apart for many digits",
            got=f"{bits} bits from the largest to the smallest",
            expected=f"at most {MOST_BITS}",
            hint="choose units in which they are closer to 1",
        )
    return bits


def _log2(number: Fraction) -> int:
    return number.numerator.bit_length() - number.denominator.bit_length()


@dataclass(frozen=True)
class _Fixed:
    """A number in units of 2^-``bits``, with the operators that the rules use."""

    units: int
    bits: int

    def __neg__(self) -> _Fixed:
        return _Fixed(-self.units, self.bits)

    def __add__(self, other: _Fixed) -> _Fixed:
        return _Fixed(self.units + other.units, self.bits)

    def __sub__(self, other: _Fixed) -> _Fixed:
        return _Fixed(self.units - other.units, self.bits)

    def __rsub__(self, other: Fraction) -> _Fixed:
        return _Fixed(_whole(other, self.bits) - self.units, self.bits)

    def __mul__(self, other: _Fixed | Fraction) -> _Fixed:
        if isinstance(other, Fraction):
            return _Fixed(self.units * other.numerator // other.denominator, self.bits)
        return _Fixed(self.units * other.units >> self.bits, self.bits)


def _whole(number: Fraction, bits: int) -> int:
    return round(number * (1 << bits))


class _Jet(Order):
    """Coefficients of all values of a program, order after order; times ``unit``^k."""

    def __init__(self, prepared: Prepared, values: Values, length: Fraction) -> None:
        self.prepared = prepared
        self.instructions = prepared.program.instructions
        self.rates = prepared.program.results[RATES]
        known = _known(prepared)
        self.bits = _working_bits(prepared, values, known, length)
        self.known = {k: self.whole(n) for k, n in known.items()}
        self.slots = {"parameter": values.parameters, "input": values.inputs}
        self.context: Any = mpmath.mp.clone()
        self.context.prec = self.bits
        self.rows: list[list[int]] = []
        self.bounds: tuple[tuple[Limit, ...], Program] | None = None
        self.blocks: dict[int, Any] = {}
        """Factorisations, and solutions of the order that is made, by mpmath."""
        self.k = 0

    def whole(self, number: Fraction) -> int:
        """Return a number in the units of the run."""
        return _whole(number, self.bits)

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

    def trusted(self, step: Fraction, t: Fraction, state: Sequence[int]) -> Fraction:
        """Return the part of a step, in units of time, in which every argument stays within its limit.

        See `codegen.watch.trust`; ``state``: where the series were made.
        """
        order = len(self.rows[0])
        if self.bounds is None:
            self.bounds = bounds(self.prepared, order)
        found, program = self.bounds
        one = 1 << self.bits
        x = [units / one for units in state]
        point = Point(float(t), x, self.slots["parameter"], self.slots["input"])
        part = Fraction(1)
        for limit, bound in zip(found, interpret(program, point)[BOUNDS], strict=True):
            terms = self.rows[limit.series]
            while part > LEAST_STEP and not _moved(terms, one, abs(float(step * part))) <= bound:
                part *= Fraction(3, 4)
        return part

    def _first(
        self, n: int, instruction: Instruction, t: Fraction, states: Sequence[Sequence[int]]
    ) -> int:
        op, args, _ = instruction
        if n in self.known:
            return self.known[n]
        if op == "state":
            return states[instruction.slot][0]
        if op == "time":
            return self.whole(t)
        if op in self.slots:
            return self.whole(Fraction(float(self.slots[op][instruction.slot])))
        if op == "mul":
            return self.rows[args[0]][0] * self.rows[args[1]][0] >> self.bits
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
        return int(m.nint(m.ldexp(found, self.bits)))

    def _real(self, units: int) -> Any:
        return self.context.ldexp(self.context.mpf(units), -self.bits)

    def _advance(self, states: Sequence[Sequence[int]], unit: Fraction) -> None:
        """Append the coefficient of order ``k`` of every value."""
        for n, instruction in enumerate(self.instructions):
            op, args, _ = instruction
            row = self.rows[n]
            if op == "state":
                row.append(states[instruction.slot][self.k])
            elif op == "time":
                row.append(self.whole(unit) if self.k == 1 else 0)
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
        return _Fixed(self.rows[a][self.k], self.bits)

    def first(self, a: Series) -> _Fixed:
        return _Fixed(self.rows[a][0], self.bits)

    def inverse(self, a: Series) -> _Fixed:
        return _Fixed((1 << 2 * self.bits) // self.rows[a][0], self.bits)

    def dot(self, a: Series, b: Series, low: int = 0, high: int = 0) -> _Fixed:
        last = self.k - high + 1
        other = self.rows[b][high : self.k - low + 1]
        total = sum(map(mul, self.rows[a][low:last], reversed(other)))
        return _Fixed(total >> self.bits, self.bits)

    def moment(self, a: Series, b: Series, high: int = 0) -> _Fixed:
        last = self.k - high + 1
        weighted = map(mul, self.rows[a][1:last], range(1, last))
        other = self.rows[b][high : self.k]
        total = sum(map(mul, weighted, reversed(other))) >> self.bits
        return _Fixed(total // self.k, self.bits)

    def choose(self, negative: _Fixed, a: _Fixed, b: _Fixed) -> _Fixed:
        return a if negative.units < 0 else b
