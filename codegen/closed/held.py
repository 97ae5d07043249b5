"""A compiled system with the values of its parameters and inputs: what its rates are, proved.

Parameters and held inputs are the exact fractions that the doubles are. Whether rates are a formula is
decided modulo a prime (`codegen.ir.residues`): without a threshold, whatever the size of the numbers. The
coefficients of a formula that was proved are then computed as numbers, by the same operations at the
same points: exact fractions where these are short, else `DIGITS` digits. They are constants: rates that
depend on time (`Held.autonomous`) have none, and what else is one is proved to be (`Held.constants`).

A body that a system states, with the values of a problem: that it moves as is stated, and its numbers.

What is proved here is proved of the program that is run, with the parameters and inputs of the run.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any, TypeVar

from codegen.closed.polhode import context, number
from codegen.compiling.compiled import Compiled
from codegen.frontend.attitude import FRAME, INERTIA, OMEGA, QUATERNION, Stated
from codegen.ir.interpret import Point, interpret_exactly
from codegen.ir.passes import needed, prune, symmetric
from codegen.ir.program import RATES, Program, SameObject
from codegen.ir.residues import FIELD, LARGEST, POINTS, PRIME, TRIES, RandomPoint, degree
from codegen.native.trajectory import Problem
from eom.fields import RATIONALS, Singular
from eom.rotations import quaternion_product

Matrix = tuple[tuple[Fraction, ...], ...]
Vector = Sequence[int]
ZERO, ONE = Fraction(0), Fraction(1)
Torque = Callable[[RandomPoint, Sequence[int], Sequence[int]], Sequence[int]]
"""From a point, residues of the states, and omega, to the torque over the same J."""


@dataclass(frozen=True)
class Spinning:
    """A stated body that all states belong to: to omega, of states and constants, attitude, directions."""

    stated: Stated
    omega: tuple[int, ...]
    """For each component the number of its state, -1 for a constant."""
    constants: tuple[Fraction, ...]
    """The components that are constant; zero for others."""

    @property
    def quaternion(self) -> tuple[int, ...]:
        """Its states, if the attitude is one."""
        return self.stated.coordinates if self.stated.kind == QUATERNION else ()

    @property
    def angles(self) -> tuple[int, ...]:
        """The states that are angles, if the attitude is a sequence of them."""
        return self.stated.coordinates if self.stated.sequence else ()

    def omega_at(self, x: Sequence[Fraction]) -> list[Fraction]:
        """Return the angular velocity at states."""
        return [x[k] if k >= 0 else v for k, v in zip(self.omega, self.constants, strict=True)]


def bodies(held: Held) -> tuple[Spinning, ...]:
    """Return the stated bodies that all states belong to, with axes that are the body's own."""
    whole = set(range(held.count))
    found = (a for a in held.attitudes if a.states == whole and not a.unspun)
    return tuple(body for a in found if (body := _spinning(held, a)) is not None)


def _spinning(held: Held, a: Stated) -> Spinning | None:
    values, omega = a.values, a.omega
    steady = [k for k, s in zip(values.results[OMEGA], omega, strict=True) if s < 0]
    if moving(values, steady) or (a.sequence and min(a.coordinates) < 0):
        return None
    known = held.numbers(values, OMEGA)
    constants = tuple(ZERO if s >= 0 else v for s, v in zip(omega, known, strict=True))
    return Spinning(a, omega, constants)


def moving(values: Program, results: Sequence[int]) -> bool:
    """Return whether instructions depend on states or time."""
    part = replace(values, results={OMEGA: tuple(results)})
    return not {"state", "time"}.isdisjoint(
        values.instructions[k].op for k in needed(part, [OMEGA])
    )


def inertia(held: Held, a: Stated) -> Matrix:
    """Return J, one if none is stated, as numbers."""
    if not a.values.results[INERTIA]:
        return ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))
    entries = held.constants(a.values, INERTIA)
    return tuple(tuple(entries[k] for k in row) for row in symmetric(range(6)))


def moves(held: Held, body: Spinning, torque: Torque | None = None) -> bool:
    """Return whether all rates are those of the body under a torque, none if None; J is the stated one."""
    return held.proved(lambda point: residuals(held, body, point, torque))


def residuals(held: Held, body: Spinning, point: RandomPoint, torque: Torque | None) -> list[int]:
    """Return what is zero at a point if all rates are those of the body."""
    x = states_at(held, body, point)
    rates = held.residues(point, x)
    w = held.values(point, body.stated.values, OMEGA, x)
    slope = [rates[k] if k >= 0 else 0 for k in body.omega]
    J = residues_of_inertia(held, body.stated, point, x)
    turning = cross(w, times(J, w))
    load = [0, 0, 0] if torque is None else torque(point, x, w)
    found = [a + b - c for a, b, c in zip(times(J, slope), turning, load, strict=True)]
    found += [
        *held.values(point, body.stated.values, FRAME, x),
        *_kinematics(body, point, x, rates, w),
    ]
    for direction in body.stated.directions:
        v = [x[k] for k in direction]
        found += [rates[k] - c for k, c in zip(direction, cross(v, w), strict=True)]
    return [v % PRIME for v in found]


def states_at(held: Held, body: Spinning, point: RandomPoint) -> list[int]:
    """Return random states, a quaternion among them of unit length: a square over its norm."""
    x = states_of(point, held.count)
    if body.quaternion:
        p = [x[k] for k in body.quaternion]
        below = FIELD.inverse(sum(v * v for v in p))
        for k, v in zip(body.quaternion, quaternion_product(p, p), strict=True):
            x[k] = v * below % PRIME
    return x


def residues_of_inertia(
    held: Held, a: Stated, point: RandomPoint, x: Sequence[int]
) -> list[list[int]]:
    """Return J, one if none is stated, modulo the prime."""
    entries = held.values(point, a.values, INERTIA, x) or [1, 0, 0, 1, 0, 1]
    return symmetric(entries)


def _kinematics(
    body: Spinning, point: RandomPoint, x: Sequence[int], rates: Sequence[int], w: Sequence[int]
) -> list[int]:
    if body.quaternion:
        turned = quaternion_product([x[k] for k in body.quaternion], [0, *w])
        return [2 * rates[k] - v for k, v in zip(body.quaternion, turned, strict=True)]
    if body.angles:
        waves = [point.circle(x[k])[::-1] for k in body.angles]
        turns = [rates[k] for k in body.angles]
        found = angular_velocity(body.stated.sequence, waves, turns)
        return [a - b for a, b in zip(found, w, strict=True)]
    return []


def angular_velocity(
    axes: Sequence[int], waves: Sequence[tuple[Any, Any]], rates: Sequence[Any]
) -> list[Any]:
    """Return the angular velocity in the body: each turn's, seen after those that follow.

    ``waves``: sine and cosine of each angle.
    """
    w: list[Any] = [0, 0, 0]
    for axis, (s, c), rate in zip(axes, waves, rates, strict=True):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        w[i], w[j] = c * w[i] + s * w[j], c * w[j] - s * w[i]
        w[axis] += rate
    return w


def matrix_of_turns(axes: Sequence[int], waves: Sequence[tuple[Any, Any]]) -> list[list[Any]]:
    """Return the rows of C, which takes components in A to the body, of sines and cosines of turns."""
    C: list[list[Any]] = [[int(i == j) for j in range(3)] for i in range(3)]
    for axis, (s, c) in zip(axes, waves, strict=True):
        i, j = (axis + 1) % 3, (axis + 2) % 3
        C[i], C[j] = (
            [c * a + s * b for a, b in zip(C[i], C[j], strict=True)],
            [c * b - s * a for a, b in zip(C[i], C[j], strict=True)],
        )
    return C


def attitude_at(body: Spinning, x: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """Return the quaternion at states: its own states, or of angles, then a unit to the last digit."""
    if not body.angles:
        return tuple(x[k] for k in body.quaternion)
    q: Sequence[Fraction] = (ONE, ZERO, ZERO, ZERO)
    for k, axis in zip(body.angles, body.stated.sequence, strict=True):
        own = context(DIGITS)
        quarter = fraction(own.tan(number(own, x[k]) / 4)) if x[k] else ZERO
        turn = [ZERO] * 4
        turn[0], turn[1 + axis] = RATIONALS.circle(quarter)
        q = quaternion_product(q, turn)
    return tuple(q)


def cross(x: Sequence[Any], y: Sequence[Any]) -> list[Any]:
    """Return the cross product."""
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def times(matrix: Sequence[Sequence[Any]], vector: Sequence[Any]) -> list[Any]:
    """Return a matrix times a column."""
    return [sum(a * b for a, b in zip(row, vector, strict=True)) for row in matrix]


def sine_and_cosine(x: Fraction) -> tuple[Fraction, Fraction]:
    """Return both to `DIGITS` digits."""
    own = context(DIGITS)
    angle = number(own, x)
    return fraction(own.sin(angle)), fraction(own.cos(angle))


def positive_definite(J: Matrix) -> bool:
    """Return whether the leading minors are positive."""
    (a, b, c), (_, d, e), (_, _, f) = J
    two = a * d - b * b
    return a > 0 and two > 0 and a * (d * f - e * e) - b * (b * f - e * c) + c * (b * e - d * c) > 0


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
        """Return whether residuals are zero at `POINTS` random points: then they are identically.

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
