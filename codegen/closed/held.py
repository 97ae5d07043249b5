"""A compiled system with the values of its parameters and inputs: what its rates are, proved.

Parameters and held inputs are the exact fractions that the doubles are. Whether rates are a formula is
decided modulo a prime (`codegen.ir.residues`): without a threshold, whatever the size of the numbers. The
coefficients of a formula that was proved are then computed as numbers, by the same operations at the
same points: exact fractions where these are short, else `DIGITS` digits. They are constants: rates that
depend on time (`Held.autonomous`) have none, and what else is one is proved to be (`Held.constants`).
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any, TypeVar

from codegen.compiling.compiled import Compiled
from codegen.frontend.attitude import Stated
from codegen.ir.identity import SameObject
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.passes import prune
from codegen.ir.program import RATES, Program
from codegen.ir.residues import FIELD, LARGEST, POINTS, PRIME, TRIES, RandomPoint, degree
from codegen.native.trajectory import Problem
from eom.fields import Singular

T = TypeVar("T")
DIGITS = 80
SHORT = 4096
"""Bits of exact fractions; longer ones are numbers of `DIGITS` digits."""
FARTHEST = 2048
"""Powers of two beyond which a coefficient is no double."""


class NotFinite(ArithmeticError):
    """A coefficient is no constant number, or none that a double can be near."""


@dataclass(frozen=True, eq=False)
class Held:
    """The rates with these parameters and inputs, whatever the initial state."""

    rates: Program
    count: int
    """Number of states."""
    parameters: tuple[float, ...]
    inputs: tuple[float, ...]
    attitudes: tuple[Stated, ...]
    memory: dict[Any, Any] = field(default_factory=dict)

    def read(self, reader: Callable[[Held], T | None]) -> T | None:
        """Return what a function finds in it, computed once; None where a coefficient is no constant."""
        if reader not in self.memory:
            try:
                read = reader(self)
                self.memory[reader] = read if read is not None and self.autonomous else None
            except ArithmeticError:
                self.memory[reader] = None
        found: T | None = self.memory[reader]
        return found

    @cached_property
    def _given(self) -> dict[tuple[str, int], int]:
        numbers = {"parameter": self.parameters, "input": self.inputs}
        return {
            (kind, k): FIELD.of(Fraction(v))
            for kind, values in numbers.items()
            for k, v in enumerate(values)
        }

    @cached_property
    def _parts(self) -> dict[tuple[int, ...], Program]:
        return {}

    def part(self, states: Sequence[int]) -> Program:
        """Return the program of the rates of some states."""
        key = tuple(states)
        if key not in self._parts:
            rows = tuple(self.rates.results[RATES][k] for k in key)
            whole = Program(self.rates.instructions, {RATES: rows}, {}, self.rates.rules)
            self._parts[key] = prune(whole, [RATES])
        return self._parts[key]

    @cached_property
    def autonomous(self) -> bool:
        """Whether the rates are the same at all times: time is not there, or it is proved."""
        if all(i.op != "time" for i in self.rates.instructions):
            return True

        def changes(point: RandomPoint) -> list[int]:
            x = states_of(point, self.count)
            there = self.values(point, self.rates, RATES, x, point.draw())
            return [(a - b) % PRIME for a, b in zip(self.residues(point, x), there, strict=True)]

        return self.proved(changes)

    def residues(
        self, point: RandomPoint, x: Sequence[int], states: Sequence[int] | None = None
    ) -> list[int]:
        """Return the rates of ``states``, of all if None, where the states have the residues ``x``."""
        return self.values(point, self.rates if states is None else self.part(states), RATES, x)

    def values(
        self,
        point: RandomPoint,
        program: Program,
        group: str,
        x: Sequence[int],
        time: int | None = None,
    ) -> list[int]:
        """Return the residues of a group of results, at the point's own time or another.

        Raises `Singular` where one is 0/0.
        """
        given = self._given | {("state", k): v for k, v in enumerate(x)}
        given |= {} if time is None else {("time", 0): time}
        values = point.values(program, given)
        found = [values[k] for k in program.results[group]]
        if any(v is None for v in found):
            raise Singular
        return [v or 0 for v in found]

    def proved(self, residuals: Callable[[RandomPoint], Iterable[int]]) -> bool:
        """Tell whether residuals are zero at `POINTS` random points: then they are identically.

        But for a chance of at most `degree` of the rates over `PRIME`, to the power of the number of
        points; of rates of a degree above `LARGEST` nothing is proved.
        """
        if self._degree > LARGEST:
            return False
        found = 0
        for seed in range(TRIES):
            try:
                if any(residuals(RandomPoint(seed))):
                    return False
            except Singular:
                continue
            found += 1
            if found == POINTS:
                return True
        return False

    @cached_property
    def _degree(self) -> int:
        return degree(self.rates)

    def numbers(
        self, program: Program, group: str, x: Sequence[float] | None = None
    ) -> tuple[Fraction, ...]:
        """Return values at states, zero if None, and t = 0. Raises `NotFinite`."""
        at = [0.0] * self.count if x is None else list(x)
        point = Point(0.0, at, list(self.parameters), list(self.inputs))
        only = prune(program, [group])
        exact = _rational(only, point)
        found = [exact[k] for k in only.results[group]]
        if any(v is None for v in found):
            digits = interpret_exactly(only, point, DIGITS)[group]
            found = [fraction(d) if v is None else v for v, d in zip(found, digits, strict=True)]
        return tuple(v for v in found if v is not None)

    def constants(self, program: Program, group: str) -> tuple[Fraction, ...]:
        """Return values that are proved not to depend on states and time, but for a factor that all have.

        Raises `NotFinite` where they do, or where they are no numbers.
        """
        first = next((k for k, v in enumerate(self.numbers(program, group)) if v), None)

        def changes(point: RandomPoint) -> list[int]:
            x = states_of(point, self.count)
            here = self.values(point, program, group, x)
            elsewhere = [point.draw() for _ in x]
            there = self.values(point, program, group, elsewhere, point.draw())
            if first is None:
                return [*here, *there]
            return [
                (a * there[first] - b * here[first]) % PRIME
                for a, b in zip(here, there, strict=True)
            ]

        if not self.proved(changes):
            raise NotFinite
        return self.numbers(program, group)

    def rate_numbers(self, x: Sequence[float], states: Sequence[int]) -> tuple[Fraction, ...]:
        """Return the rates of some states at states and t = 0. Raises `NotFinite`."""
        return self.numbers(self.part(states), RATES, x)


def held(compiled: Compiled, problem: Problem) -> Held:
    """Return a compiled system with the values of a problem, one object for the same values."""
    values = (tuple(problem.parameters.tolist()), tuple(problem.inputs.tolist()))
    return _held(SameObject(compiled), *values)


@lru_cache(maxsize=64)
def _held(
    key: SameObject[Compiled], parameters: tuple[float, ...], inputs: tuple[float, ...]
) -> Held:
    layout = key.value.layout
    rates = _rates_of(key)
    return Held(rates, len(layout.states), parameters, inputs, layout.attitudes)


@lru_cache(maxsize=64)
def _rates_of(key: SameObject[Compiled]) -> Program:
    return prune(key.value.program, [RATES])


def states_of(point: RandomPoint, count: int) -> list[int]:
    """Return random residues of all states."""
    return [point.leaf("state", k) for k in range(count)]


def fraction(value: Any) -> Fraction:
    """Return a mpmath real as the fraction that it is.

    Raises `NotFinite` for NaN and infinities, and for numbers that no double is near.
    """
    if not value.context.isfinite(value):
        raise NotFinite
    mantissa, exponent = value.man_exp
    if value and abs(value.context.mag(value)) > FARTHEST:
        raise NotFinite
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent) * (1 if value >= 0 else -1)


_EXACT: Mapping[str, Callable[..., Fraction]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "neg": operator.neg,
    "abs": abs,
}


def _rational(program: Program, point: Point) -> list[Fraction | None]:
    """Return the values that are short fractions of the data; None for others."""
    values: list[Fraction | None] = []
    for instruction in program.instructions:
        op, args, value = instruction
        if op == "const":
            values.append(value if isinstance(value, Fraction) else None)
        elif op in {"time", "state", "parameter", "input"}:
            values.append(Fraction(point.slot(instruction)))
        else:
            values.append(_applied(op, [values[a] for a in args]))
    return values


def _applied(op: str, operands: Sequence[Fraction | None]) -> Fraction | None:
    rule = _EXACT.get(op)
    if rule is None or any(v is None for v in operands) or (op == "div" and not operands[1]):
        return None
    value = rule(*operands)
    size = value.numerator.bit_length() + value.denominator.bit_length()
    return value if size <= SHORT else None
