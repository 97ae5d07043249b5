"""Quaternions among the states of a system, found by what its rates compute.

Four states q are a unit quaternion, scalar first, if dq/dt = q (0, w)/2 with w = omega - C(q) n and
C(q) v = q* v q, where omega and n do not depend on q. All tests are made at random points modulo a
prime (`codegen.residues`), with q of unit length: no name is looked at.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import combinations, permutations
from typing import TypeVar

from codegen.columns import Numbers, copied_at
from codegen.lower import RATES
from codegen.passes import Slot, prune
from codegen.program import Builder, Program, bindings
from codegen.residues import PRIME, RandomPoint, Unlucky, inverse

T = TypeVar("T")
TRIES = 20
"""Random points that are drawn where a divisor vanishes by chance."""
Four = tuple[int, int, int, int]
UNITS: tuple[Four, ...] = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
FRAME = "frame"


def candidates(program: Program, count: int) -> list[list[Four]]:
    """Return the orders in which four states are a quaternion, for each such four.

    Several orders of the same four are: up to signs of omega the axes can be named in other ways.
    """

    def sums(point: RandomPoint) -> list[tuple[int, int]]:
        values = results(program, point, {})
        return [(point.leaf("state", k), values[k]) for k in range(count)]

    pairs = somewhere(sums)
    work = [x * f % PRIME for x, f in pairs]
    moving = [k for k in range(count) if work[k]]
    fours = (c for c in combinations(moving, 4) if sum(work[k] for k in c) % PRIME == 0)
    orders = [[o for o in map(_four, permutations(f)) if _kinematic(program, o)] for f in fours]
    return [found for found in orders if found]


def _four(values: Sequence[int]) -> Four:
    a, b, c, d = values
    return a, b, c, d


def _kinematic(program: Program, q: Four) -> bool:
    """Tell whether w = omega - C(q) n with omega and n that do not depend on q."""

    def test(point: RandomPoint) -> bool:
        omega, n = omega_and_frame(lambda unit: turn_rate(program, point, q, unit, {}))
        if not any(omega):
            return False
        units = [*(unit_quaternion(point, k) for k in range(2)), *UNITS]
        return all(
            turn_rate(program, point, q, unit, {})
            == [(a - b) % PRIME for a, b in zip(omega, turned(unit, n), strict=True)]
            for unit in units
        )

    return somewhere(test)


def omega_and_frame(rate: Callable[[Four], list[int]]) -> tuple[list[int], list[int]]:
    """Return omega and n from w at the unit quaternions 1, i, j."""
    here, about1, about2 = (rate(unit) for unit in UNITS[:3])
    half = inverse(2)
    n = [
        (b - a) * half % PRIME for a, b in zip(here, (about2[0], about1[1], about1[2]), strict=True)
    ]
    return [(a + b) % PRIME for a, b in zip(here, n, strict=True)], n


def turn_rate(
    program: Program, point: RandomPoint, q: Four, unit: Four, given: Mapping[Slot, int]
) -> list[int]:
    """Return w, the vector part of 2 q* dq/dt, at a unit quaternion."""
    at = {("state", s): v for s, v in zip(q, unit, strict=True)}
    values = results(program, point, {**given, **at})
    return [2 * v % PRIME for v in product(conjugate(unit), [values[s] for s in q])[1:]]


def product(p: Numbers, q: Numbers) -> list[int]:
    """Return the quaternion product p q of residues, scalar first."""
    a, b, c, d = p
    w, x, y, z = q
    return [
        (a * w - b * x - c * y - d * z) % PRIME,
        (a * x + b * w + c * z - d * y) % PRIME,
        (a * y + c * w + d * x - b * z) % PRIME,
        (a * z + d * w + b * y - c * x) % PRIME,
    ]


def conjugate(q: Numbers) -> list[int]:
    """Return q*."""
    return [q[0], *(-v for v in q[1:])]


def turned(q: Numbers, vector: Numbers) -> list[int]:
    """Return q* v q, which takes components in A to the body."""
    return product(product(conjugate(q), [0, *vector]), q)[1:]


def unit_quaternion(point: RandomPoint, number: int) -> Four:
    """Return a random unit quaternion: a square over its norm."""
    p = [point.leaf("unit", 4 * number + k) for k in range(4)]
    scale = inverse(sum(v * v for v in p))
    return _four([v * scale % PRIME for v in product(p, p)])


def frame_rate(program: Program, q: Four, count: int) -> Program | None:
    """Return n as a program of the parameters, group `FRAME`; None if it depends on more.

    As it then does not matter where the other slots stand, they are put to zero.
    """
    slots = [("state", k) for k in range(count) if k not in q]
    slots += [("input", i.slot) for i in program.instructions if i.op == "input"]
    zeros: dict[Slot, int] = dict.fromkeys([*slots, ("time", 0)], 0)

    def compare(point: RandomPoint) -> tuple[list[int], list[int]]:
        def frame(given: Mapping[Slot, int]) -> list[int]:
            return omega_and_frame(lambda unit: turn_rate(program, point, q, unit, given))[1]

        return frame(zeros), frame({})

    try:
        still, anywhere = somewhere(compare)
    except Unlucky:
        return None
    if still != anywhere:
        return None
    b = Builder(program.rules)
    rates = [_rate_at(b, program, q, zeros, unit) for unit in UNITS[:3]]
    n = [
        b.add("mul", b.const(Fraction(1, 2)), b.add("sub", rates[other][k], rates[0][k]))
        if still[k]
        else b.const(0)
        for k, other in enumerate((2, 1, 1))
    ]
    made = prune(b.program({FRAME: n}))
    return made if max(bindings(made), default=0) <= 1 else None


def _rate_at(
    b: Builder, program: Program, q: Four, given: Mapping[Slot, int], unit: Four
) -> list[int]:
    """Append w at one of the unit quaternions 1, i, j, k: the vector part of 2 q* dq/dt."""
    at = {("state", s): v for s, v in zip(q, unit, strict=True)}
    new = copied_at(b, program, {**given, **at})
    slopes = [new[program.results[RATES][s]] for s in q]
    back = conjugate(unit)
    total = [b.const(0)] * 3
    for j, slope in enumerate(slopes):
        for k, sign in enumerate(product(back, UNITS[j])[1:]):
            if sign:
                twice = b.add("mul", b.const(2), slope)
                total[k] = b.add("add" if sign == 1 else "sub", total[k], twice)
    return total


def results(
    program: Program, point: RandomPoint, given: Mapping[Slot, int], group: str = RATES
) -> list[int]:
    """Return the residues of a group of results. Raises `Unlucky` where one is 0/0."""
    values = point.values(program, given)
    found = [values[k] for k in program.results[group]]
    if any(v is None for v in found):
        raise Unlucky
    return [v or 0 for v in found]


def somewhere(test: Callable[[RandomPoint], T]) -> T:
    """Return what a test finds at the first random point where it can be made."""
    for seed in range(TRIES):
        try:
            return test(RandomPoint(seed))
        except Unlucky:
            continue
    return test(RandomPoint(TRIES))
