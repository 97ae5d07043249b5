"""Which states of a system are an attitude quaternion and which are body rates, read off its rates.

No name is looked at: what a program computes is tested at random points modulo a prime
(`codegen.residues`). Four states q are a unit quaternion, scalar first, if

    dq/dt = q (0, w)/2,   w = omega - C(q) n,   C(q) v = q* v q,

where omega does not depend on q, and n, the angular velocity of the frame A that attitude is measured
from, depends on parameters alone. If omega is three states (or values of parameters, where a state with
a first integral was left out) whose rates are

    J d omega/dt = -omega x J omega + tau,

with entries of J among the values that depend on parameters alone, the system is a rigid body. J is
found up to a factor, with which the torque tau goes: no motion depends on it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from codegen.columns import PAIRS, Numbers, copied_at, cross, symmetric, times
from codegen.lower import RATES
from codegen.passes import Slot, prune
from codegen.program import Builder, Program, bindings
from codegen.quaternions import (
    FRAME,
    TRIES,
    Four,
    candidates,
    frame_rate,
    omega_and_frame,
    results,
    somewhere,
    turn_rate,
    unit_quaternion,
)
from codegen.residues import (
    PRIME,
    RandomPoint,
    Residue,
    Unlucky,
    inverse,
    null_vector,
    rational,
    residue,
)

NUMBER_BITS = 200
"""Of a random residue, numerator and denominator are that short with a chance of 2**-120."""
INERTIA, CONSTANT_RATES, TORQUE = "inertia", "constant rates", "torque"


@dataclass(frozen=True)
class Body:
    """A rigid body among the rates of a system.

    ``rates``: the state of each body rate, -1 where it is constant. ``values``: a program of the
    parameters alone, with groups `INERTIA` (J11, J12, J13, J22, J23, J33, in any unit),
    `CONSTANT_RATES` (of the rates that are constant, 0 for others) and `FRAME` (n, components in A).
    ``torque``: a program of the slots of the system, group `TORQUE`, components in the body frame,
    in the unit of J. ``of_rates``: components that depend on the body rates. ``zero``: those that
    vanish.
    """

    rates: tuple[int, int, int]
    values: Program
    torque: Program
    of_rates: tuple[bool, bool, bool]
    zero: tuple[bool, bool, bool]

    @property
    def is_principal(self) -> bool:
        """Whether all products of inertia are zero."""
        entries = [self.values.instructions[k] for k in self.values.results[INERTIA]]
        return all(
            e.op == "const" and not e.value
            for e, (i, j) in zip(entries, PAIRS, strict=True)
            if i != j
        )


@dataclass(frozen=True)
class Attitude:
    """The quaternion among the states, scalar first, and the body that has this attitude, if any.

    ``others``: the states that are neither.
    """

    quaternion: Four
    body: Body | None
    others: tuple[int, ...]


@lru_cache(maxsize=32)
def attitude_of(program: Program, count: int) -> Attitude | None:
    """Return the attitude among ``count`` states, or None unless there is one quaternion.

    Of the orders in which the four states are a quaternion, one with a body is taken, or the first.
    """
    rates = prune(program, [RATES])
    found = candidates(rates, count)
    if len(found) != 1:
        return None
    bodies = ((q, body) for q in found[0] if (body := _body(rates, q, count)) is not None)
    quaternion, body = next(bodies, (found[0][0], None))
    taken = {*quaternion, *(body.rates if body else ())}
    return Attitude(quaternion, body, tuple(k for k in range(count) if k not in taken))


@dataclass(frozen=True)
class _Rates:
    """Body rates: the state, the parameter (of a constant one) or the number of each; -1, -1, None."""

    states: tuple[int, int, int]
    parameters: tuple[int, int, int]
    numbers: tuple[Fraction | None, ...]

    def given(self, omega: Numbers) -> dict[Slot, int]:
        """Return the leaves that give the body rates these values, as far as they can be given."""
        slots = {("state", s): w for s, w in zip(self.states, omega, strict=True) if s >= 0}
        return slots | {
            ("parameter", s): w for s, w in zip(self.parameters, omega, strict=True) if s >= 0
        }

    def possible(self, omega: Numbers) -> list[int]:
        """Return residues of body rates with those that are numbers put right."""
        return [w if n is None else residue(n) for w, n in zip(omega, self.numbers, strict=True)]


def _body(program: Program, q: Four, count: int) -> Body | None:
    frame = frame_rate(program, q, count)
    rates = _rates_of(program, q, count)
    if frame is None or rates is None:
        return None
    entries = _inertia(program, rates)
    if entries is None:
        return None
    values = _values(program, rates, entries, frame)
    of_rates, zero = _dependence(program, q, rates, values)
    torque = _torque(program, rates, values, of_rates, zero)
    return Body(rates.states, values, torque, of_rates, zero)


def _rates_of(program: Program, q: Four, count: int) -> _Rates | None:
    """Return where omega stands; None unless its components are states, parameters or numbers."""

    def search(point: RandomPoint) -> _Rates | None:
        omega, _ = omega_and_frame(lambda unit: turn_rate(program, point, q, unit, {}))
        free = [k for k in range(count) if k not in q]
        states = {point.leaf("state", k): k for k in free}
        slots = [i.slot for i in program.instructions if i.op == "parameter"]
        parameters = {point.leaf("parameter", k): k for k in slots}
        numbers = [None if w in states or w in parameters else _number(w) for w in omega]
        known = zip(omega, numbers, strict=True)
        if not all(n is not None or w in states or w in parameters for w, n in known):
            return None
        a, b, c = (states.get(w, -1) for w in omega)
        d, e, f = (-1 if w in states else parameters.get(w, -1) for w in omega)
        return _Rates((a, b, c), (d, e, f), tuple(numbers)) if max(a, b, c) >= 0 else None

    return somewhere(search)


def _number(value: int) -> Fraction | None:
    """Return the number that a residue stands for; those of expressions have long numerators."""
    number = rational(value)
    if number is None or max(abs(number.numerator), number.denominator) > 2**NUMBER_BITS:
        return None
    return number


def _cross(a: Numbers, b: Numbers) -> list[int]:
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def _times(J: Numbers, v: Numbers) -> list[int]:
    a, b, c, d, e, f = J
    x, y, z = v
    return [a * x + b * y + c * z, b * x + d * y + e * z, c * x + e * y + f * z]


def _gyroscopic(rates: _Rates, J: Numbers, omega: Numbers) -> list[int]:
    w = rates.possible(omega)
    return _cross(w, _times(J, w))


def _accelerations(
    program: Program, point: RandomPoint, rates: _Rates, omega: Numbers
) -> list[int]:
    values = results(program, point, rates.given(omega))
    return [values[s] if s >= 0 else 0 for s in rates.states]


def _first_difference(f: Callable[[Numbers], list[int]], omega: Numbers) -> list[int]:
    return [a - b for a, b in zip(f(omega), f((0, 0, 0)), strict=True)]


def _second_difference(f: Callable[[Numbers], list[int]], omega: Numbers) -> list[int]:
    far, near, none = f([2 * w for w in omega]), f(omega), f((0, 0, 0))
    return [a - 2 * b + c for a, b, c in zip(far, near, none, strict=True)]


DIFFERENCES = (_first_difference, _second_difference)
"""What leaves J d omega/dt + omega x J omega = 0: for a torque without rates, or linear in them."""


def _moments(
    program: Program, rates: _Rates, difference: Callable[..., list[int]], point: RandomPoint
) -> list[int] | None:
    """Return the six entries of J up to a factor at a random point, or None."""
    rows = []
    for sample in range(5):
        omega = [point.leaf("rate", 3 * sample + k) for k in range(3)]
        slope = difference(lambda w: _accelerations(program, point, rates, w), omega)
        columns = []
        for k in range(6):
            J = [int(k == e) for e in range(6)]
            turning = difference(lambda w, J=J: _gyroscopic(rates, J, w), omega)
            columns.append([a + b for a, b in zip(_times(J, slope), turning, strict=True)])
        rows += [list(row) for row in zip(*columns, strict=True)]
    return null_vector(rows)


Entry = tuple[int, Fraction]
"""A multiple of an instruction's value; the instruction -1 stands for one."""


def _inertia(program: Program, rates: _Rates) -> list[Entry] | None:
    """Return the entries of J among multiples of what depends on parameters alone, or None."""
    for difference in DIFFERENCES:
        for seed in range(TRIES):
            try:
                points = [RandomPoint(2 * seed + k) for k in range(2)]
                found = [_moments(program, rates, difference, point) for point in points]
                first, second = found
                if first is None or second is None:
                    break
                return _matched(program, points, [first, second])
            except Unlucky:
                continue
    return None


def _matched(
    program: Program, points: Sequence[RandomPoint], found: Sequence[Numbers]
) -> list[Entry] | None:
    known = bindings(program)
    early = [k for k, when in enumerate(known) if when == 1]
    early.sort(key=lambda k: program.instructions[k].op != "parameter")
    tables = [point.values(program, {}) for point in points]
    where: dict[tuple[Residue, ...], int] = {}
    for k in early:
        where.setdefault(tuple(table[k] for table in tables), k)
    for lead in (0, 3, 5):
        if not (found[0][lead] and found[1][lead]):
            continue
        ratios = [[v * inverse(own[lead]) % PRIME for v in own] for own in found]
        for scale in [*where, (1, 1)]:
            entries = _entries(ratios, scale, where)
            if entries is not None:
                return entries
    return None


def _entries(
    ratios: Sequence[Numbers],
    scale: tuple[Residue, ...],
    where: Mapping[tuple[Residue, ...], int],
) -> list[Entry] | None:
    entries = []
    for k in range(6):
        pair = tuple(r[k] * (s or 0) % PRIME for r, s in zip(ratios, scale, strict=True))
        entry = _entry(pair, where)
        if entry is None:
            return None
        entries.append(entry)
    return entries


def _entry(pair: tuple[int, ...], where: Mapping[tuple[Residue, ...], int]) -> Entry | None:
    for sign in (1, -1):
        k = where.get(tuple(sign * v % PRIME for v in pair))
        if k is not None:
            return k, Fraction(sign)
    if len(set(pair)) > 1:
        return None
    number = rational(pair[0])
    return None if number is None else (-1, number)


def _values(program: Program, rates: _Rates, entries: Sequence[Entry], frame: Program) -> Program:
    """Return the program of what depends on parameters alone: see `Body`."""
    b = Builder(program.rules)
    new = copied_at(b, program, {}) if any(k >= 0 for k, _ in entries) else []
    inertia = [
        b.add("mul", b.const(factor), new[k]) if k >= 0 else b.const(factor)
        for k, factor in entries
    ]
    constant = [
        b.leaf("parameter", k) if k >= 0 else b.const(number or 0)
        for k, number in zip(rates.parameters, rates.numbers, strict=True)
    ]
    turning = copied_at(b, frame, {})
    n = [turning[k] for k in frame.results[FRAME]]
    return prune(b.program({INERTIA: inertia, CONSTANT_RATES: constant, FRAME: n}))


def _dependence(
    program: Program, q: Four, rates: _Rates, values: Program
) -> tuple[tuple[bool, bool, bool], tuple[bool, bool, bool]]:
    """Tell which components of the torque depend on the rates, and which vanish."""

    def at(point: RandomPoint, omega: Numbers) -> list[int]:
        unit = {("state", s): v for s, v in zip(q, unit_quaternion(point, 0), strict=True)}
        J = results(values, point, {}, INERTIA)
        slopes = results(program, point, {**rates.given(omega), **unit})
        slope = [slopes[s] if s >= 0 else 0 for s in rates.states]
        turning = _gyroscopic(rates, J, omega)
        return [(a + c) % PRIME for a, c in zip(_times(J, slope), turning, strict=True)]

    def test(point: RandomPoint) -> tuple[list[int], list[int]]:
        return at(point, [point.leaf("rate", k) for k in range(3)]), at(point, (0, 0, 0))

    moving, still = somewhere(test)
    a, b, c = (m != s for m, s in zip(moving, still, strict=True))
    d, e, f = (m == 0 and s == 0 for m, s in zip(moving, still, strict=True))
    return (a, b, c), (d, e, f)


def _torque(
    program: Program,
    rates: _Rates,
    values: Program,
    of_rates: Sequence[bool],
    zero: Sequence[bool],
) -> Program:
    """Return tau = J d omega/dt + omega x J omega; where it is free of rates, at omega = 0."""
    b = Builder(program.rules)
    made = copied_at(b, values, {})
    J = symmetric([made[k] for k in values.results[INERTIA]])
    moving = _slopes(b, program, rates, {})
    still = _slopes(b, program, rates, rates.given((0, 0, 0)))
    omega = body_rates(b, rates.states, [made[k] for k in values.results[CONSTANT_RATES]])
    resting = [b.const(number or 0) for number in rates.numbers]
    whole, free = (
        [
            b.add("add", x, y)
            for x, y in zip(times(b, J, a), cross(b, w, times(b, J, w)), strict=True)
        ]
        for a, w in ((moving, omega), (still, resting))
    )
    torque = [
        b.const(0) if nothing else whole[k] if mixed else free[k]
        for k, (mixed, nothing) in enumerate(zip(of_rates, zero, strict=True))
    ]
    return prune(b.program({TORQUE: torque}))


def _slopes(b: Builder, program: Program, rates: _Rates, given: Mapping[Slot, int]) -> list[int]:
    new = copied_at(b, program, given)
    results = [new[k] for k in program.results[RATES]]
    return [results[s] if s >= 0 else b.const(0) for s in rates.states]


def body_rates(b: Builder, states: Numbers, constants: Numbers) -> list[int]:
    """Return the body rates over the slots of the system."""
    return [b.leaf("state", s) if s >= 0 else c for s, c in zip(states, constants, strict=True)]
