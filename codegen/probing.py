"""The rates of a compiled system as exact numbers at chosen points: what structure is read from.

Parameters and held inputs are the doubles that they are. Where sums, products and quotients are all
that a rate needs, its value is the exact fraction; elsewhere it has `DIGITS` digits. Two formulas that
agree in so many digits at random points are the same function, but for chances of one in 10^60.
"""

from __future__ import annotations

import operator
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache, wraps
from typing import Any, Concatenate, ParamSpec, TypeVar, cast

from codegen.compiled import Compiled
from codegen.identity import SameObject
from codegen.integrate.trajectory import Problem
from codegen.interpret import Point, interpret_exactly
from codegen.lower import RATES
from codegen.passes import prune
from codegen.program import Program

DIGITS = 80
SAME = Fraction(1, 10**60)
"""Numbers that differ by less of their size are equal."""
POINTS = 3

_EXACT: dict[str, Callable[..., Fraction]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "neg": operator.neg,
    "abs": abs,
    "lt": lambda a, b: Fraction(a < b),
    "le": lambda a, b: Fraction(a <= b),
    "eq": lambda a, b: Fraction(a == b),
}


class NotFinite(ArithmeticError):
    """A rate is no number at a point."""


@dataclass(frozen=True)
class Sample:
    """States and their rates at a point."""

    x: tuple[Fraction, ...]
    rates: tuple[Fraction, ...]


@dataclass(frozen=True, eq=False)
class Probe:
    """A compiled system with the values of a problem."""

    compiled: Compiled
    problem: Problem

    @cached_property
    def program(self) -> Program:
        """The rates alone."""
        return _rates_of(SameObject(self.compiled))

    @cached_property
    def memory(self) -> dict[Any, Any]:
        """What is known of the system with these parameters and inputs, whatever its initial state."""
        values = (self.problem.parameters, self.problem.inputs)
        return _memory(SameObject(self.compiled), *(v.tobytes() for v in values))

    @property
    def count(self) -> int:
        """Number of states."""
        return len(self.problem.x0)

    @property
    def start(self) -> tuple[Fraction, ...]:
        """The initial state, exactly."""
        return tuple(Fraction(float(v)) for v in self.problem.x0)

    @property
    def samples(self) -> tuple[Sample, ...]:
        """Rates at random points, each at a time of its own."""
        return _samples(self)

    def drawn(self) -> tuple[Sample, ...]:
        """Draw the points and compute the rates there."""
        draw = random.Random(self.count)  # noqa: S311 - reproducible points
        return tuple(self._drawn(draw) for _ in range(POINTS))

    def _drawn(self, draw: random.Random) -> Sample:
        x = [draw.choice((-1, 1)) * draw.uniform(0.5, 1.5) for _ in range(self.count)]
        return Sample(tuple(map(Fraction, x)), self.rates(x, draw.random()))

    def rates(self, x: Sequence[float], t: float = 0.0) -> tuple[Fraction, ...]:
        """Return all rates at a point. Raises `NotFinite` where one is no number."""
        point = Point(t, list(x), list(self.problem.parameters), list(self.problem.inputs))
        exact = _rational(self.program, point)
        results = self.program.results[RATES]
        if any(exact[k] is None for k in results):
            numbers = interpret_exactly(self.program, point, DIGITS)[RATES]
            return tuple(
                fraction(n) if exact[k] is None else known(exact[k])
                for k, n in zip(results, numbers, strict=True)
            )
        return tuple(known(exact[k]) for k in results)


@lru_cache(maxsize=64)
def _rates_of(key: SameObject[Compiled]) -> Program:
    return prune(key.value.program, [RATES])


@lru_cache(maxsize=64)
def _memory(key: SameObject[Compiled], parameters: bytes, inputs: bytes) -> dict[Any, Any]:  # noqa: ARG001
    return {}


P = ParamSpec("P")
T = TypeVar("T")


def structural(
    read: Callable[Concatenate[Probe, P], T],
) -> Callable[Concatenate[Probe, P], T]:
    """Compute what does not depend on the initial state once for a system with its parameters.

    Law: ``read`` is a function of the samples alone, and of arguments that can be compared.
    """

    @wraps(read)
    def known(probe: Probe, /, *args: P.args, **kwargs: P.kwargs) -> T:
        key = (read, args)
        if key not in probe.memory:
            probe.memory[key] = _outcome(lambda: read(probe, *args, **kwargs))
        found, error = probe.memory[key]
        if error is not None:
            raise error
        return cast("T", found)

    return known


def _outcome(read: Callable[[], T]) -> tuple[T | None, ArithmeticError | None]:
    try:
        return read(), None
    except ArithmeticError as error:
        return None, error


def known(value: Fraction | None) -> Fraction:
    """Return a value that is there."""
    assert value is not None
    return value


def fraction(value: Any) -> Fraction:
    """Return a mpmath real as the fraction that it is. Raises `NotFinite` for NaN and infinities."""
    if not value.context.isfinite(value):
        raise NotFinite
    mantissa, exponent = value.man_exp
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent) * (1 if value > 0 else -1)


def same(a: Fraction, b: Fraction, size: Fraction) -> bool:
    """Return whether two numbers that came from sums of the ``size`` are equal."""
    return abs(a - b) <= SAME * abs(size)


def _rational(program: Program, point: Point) -> list[Fraction | None]:
    """Return the values that are fractions of the data; None for others."""
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
    if op == "select":
        condition, a, b = operands
        return condition if condition is None else (a if condition else b)
    rule = _EXACT.get(op)
    if rule is None or any(v is None for v in operands) or (op == "div" and not operands[1]):
        return None
    return rule(*operands)


@structural
def _samples(probe: Probe) -> tuple[Sample, ...]:
    return probe.drawn()
