"""Where a compiled system is measured: ranges by name, and the points that are drawn from them.

The accuracy report: what was measured of each result, as frozen data.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from codegen.frontend.layout import Layout
from codegen.ir.interpret import UNIT_ROUNDOFF, Point, interpret_exactly
from codegen.ir.passes import prune
from codegen.ir.program import INVARIANTS, RATES, SINGULARITIES, Program
from eom.displays import display
from eom.errors import InputError, unknown_name
from eom.quantities import Quantity

Range = tuple[float, float]

TIME = "t"
TYPICAL, ZERO, SINGULAR, EXTREME = "domain", "zero", "singular", "extreme"
REGIONS = (TYPICAL, ZERO, SINGULAR, EXTREME)
"""In the ranges; at and near zero; near singular configurations; at extreme magnitudes."""

NEAR_ZERO = (0.0, 1e-12, 1e-8, 1e-4)
"""Of the size of its range: what one state is set to at and near zero."""
DISTANCES = tuple(10.0**-k for k in range(1, 16))
EXPONENTS = (-300, -200, -150, -100, -50, -20, -10, -6, -3, 3, 6, 10, 20, 50, 100, 150, 200, 300)
"""Decimal exponents by which states and inputs are scaled."""
DRAWS = 2
GRID = 64
"""Intervals in which a singular value of a state is looked for."""


class Place(NamedTuple):
    """A point, which region it belongs to, and how it was made."""

    region: str
    point: Point
    how: str


@dataclass(frozen=True)
class Domain:
    """A range for time and for each state, parameter and input, in their order.

    ``unit``: groups of states, by slot, whose sum of squares is kept at ``radius``: quaternions.
    ``angles``: slots of the states that are angles; large ones are left alone.
    """

    names: tuple[str, ...]
    time: Range
    states: tuple[Range, ...]
    parameters: tuple[Range, ...]
    inputs: tuple[Range, ...]
    unit: tuple[tuple[int, ...], ...] = ()
    radius: tuple[float, ...] = ()
    angles: frozenset[int] = frozenset()

    def ranges(self) -> dict[str, Range]:
        """Return the range of each quantity by name; time is ``t``."""
        return dict(
            zip(
                self.names,
                (self.time, *self.states, *self.parameters, *self.inputs),
                strict=True,
            )
        )

    def draw(self, generator: random.Random) -> Point:
        """Return a random point: uniform in the ranges, unit groups in a random direction."""
        time = generator.uniform(*self.time)
        groups = [
            [generator.uniform(*r) for r in ranges]
            for ranges in (self.states, self.parameters, self.inputs)
        ]
        for slots, radius in zip(self.unit, self.radius, strict=True):
            direction = [generator.gauss(0.0, 1.0) for _ in slots]
            norm = math.hypot(*direction)
            for slot, part in zip(slots, direction, strict=True):
                groups[0][slot] = radius * part / norm
        return Point(time, *groups)


def domain_of(
    program: Program,
    layout: Layout,
    stated: Mapping[str, Range | float],
    around: Mapping[str, float],
) -> Domain:
    """Return the ranges of a system: those that are stated, and for the rest what is usual.

    Angles (unit rad) go from -pi to pi; other states to twice the largest of ``around`` among
    states of the same unit, or 1, either way; states whose sum of squares is an invariant have the
    norm that they have in ``around``, or 1; parameters lie within 10 % of ``around``, otherwise
    between 0.5 and 2; inputs within their size, or 1, of ``around``; time between 0 and 10.
    Raises `InputError` for unknown names and for ranges that are empty, reversed or not finite.
    """
    quantities = (*layout.states, *layout.parameters, *layout.inputs)
    names = (TIME, *(q.name for q in quantities))
    for name in (*stated, *around):
        if name not in names:
            raise unknown_name("name", name, names, f"domain of {layout.name!r}")
    positive = {q.name for q in layout.parameters if q.symbol.is_positive}
    given = {n: checked_range(n, r, n in positive) for n, r in stated.items()}
    unit = [
        slots
        for slots in _unit_groups(program)
        if not any(layout.states[k].name in given for k in slots)
    ]

    def chosen(q: Quantity, usual: Callable[[Quantity], Range]) -> Range:
        return given[q.name] if q.name in given else usual(q)

    angles = frozenset(k for k, q in enumerate(layout.states) if q.unit == "rad")
    values = [[around.get(layout.states[k].name, 0.0) for k in slots] for slots in unit]
    return Domain(
        names,
        given.get(TIME, (0.0, around.get(TIME, 10.0))),
        tuple(chosen(q, lambda q: _state_range(q, layout, around)) for q in layout.states),
        tuple(chosen(q, lambda q: _parameter_range(q, around)) for q in layout.parameters),
        tuple(chosen(q, lambda q: _input_range(q, around)) for q in layout.inputs),
        tuple(unit),
        tuple(math.hypot(*v) or 1.0 for v in values),
        angles,
    )


def checked_range(name: str, value: Range | float, positive: bool = False) -> Range:
    """Return a range of finite numbers; a number alone is held. Raises `InputError` otherwise."""
    where = f"range of {name}"
    try:
        low, high = (value, value) if isinstance(value, int | float) else value
        low, high = float(low), float(high)
    except (TypeError, ValueError):
        raise InputError(
            "not a range", where=where, got=str(value)[:200], expected="(low, high), or a number"
        ) from None
    got = f"{low!r} to {high!r}"
    if not (math.isfinite(low) and math.isfinite(high) and math.isfinite(high - low)):
        raise InputError("range is not finite", where=where, got=got, expected="finite numbers")
    if low > high:
        raise InputError("range is reversed", where=where, got=got, expected=f"{high!r} to {low!r}")
    if low == high and not isinstance(value, int | float):
        raise InputError(
            "range is empty", where=where, got=got, hint=f"give {low!r} alone to hold the value"
        )
    if positive and not low > 0:
        raise InputError(
            f"parameter {name} is not positive", where=where, got=got, expected="above zero"
        )
    return low, high


def _state_range(q: Quantity, layout: Layout, around: Mapping[str, float]) -> Range:
    if q.unit == "rad":
        return -math.pi, math.pi
    alike = [abs(around.get(o.name, 0.0)) for o in layout.states if o.unit == q.unit]
    size = 2 * max(alike) or 1.0
    return -size, size


def _parameter_range(q: Quantity, around: Mapping[str, float]) -> Range:
    value = around.get(q.name)
    if value:
        near = (0.9 * value, 1.1 * value)
        return min(near), max(near)
    return (0.5, 2.0) if q.symbol.is_positive else (-2.0, 2.0)


def _input_range(q: Quantity, around: Mapping[str, float]) -> Range:
    value = around.get(q.name, 0.0)
    size = abs(value) or 1.0
    return value - size, value + size


def _unit_groups(program: Program) -> list[tuple[int, ...]]:
    """Return the groups of states whose sum of squares, or its root, is an invariant."""
    found: list[tuple[int, ...]] = []
    for k in program.results.get(INVARIANTS, ()):
        op, args, _ = program.instructions[k]
        slots = _squares(program, args[0] if op == "sqrt" else k)
        if len(slots) > 1 and not any(set(slots) & set(other) for other in found):
            found.append(slots)
    return found


def _squares(program: Program, root: int) -> tuple[int, ...]:
    """Return the slots of states if ``root`` is the sum of their squares, else nothing."""
    slots, stack = [], [root]
    while stack:
        op, args, _ = program.instructions[stack.pop()]
        if op == "add":
            stack += args
            continue
        leaf = program.instructions[args[0]] if op == "mul" and args[0] == args[1] else None
        if leaf is None or leaf.op != "state":
            return ()
        slots.append(leaf.slot)
    return tuple(sorted(set(slots)))


def places(
    program: Program, layout: Layout, domain: Domain, samples: int, seed: int
) -> Iterator[Place]:
    """Draw the points of all regions; the same seed gives the same points."""
    generator = random.Random(seed)  # noqa: S311 - reproducible points
    for _ in range(samples):
        yield Place(TYPICAL, domain.draw(generator), "")
    yield from _zero(layout, domain, generator)
    for number, text in enumerate(layout.results.get(SINGULARITIES, ())):
        yield from _singular(program, layout, domain, generator, number, text)
    for exponent in EXPONENTS:
        for _ in range(DRAWS):
            yield _scaled(domain, generator, 10.0**exponent)


def _with_states(point: Point, changed: Mapping[int, float]) -> Point:
    states = [changed.get(k, v) for k, v in enumerate(point.x)]
    return Point(point.t, states, point.p, point.u)


def _zero(layout: Layout, domain: Domain, generator: random.Random) -> Iterator[Place]:
    point = domain.draw(generator)
    if layout.states:
        rest = _with_states(point, dict.fromkeys(range(len(layout.states)), 0.0))
        yield Place(ZERO, rest, "all states zero")
    for slot, q in enumerate(layout.states):
        size = max(map(abs, domain.states[slot])) or 1.0
        for part in NEAR_ZERO:
            how = f"{q.name} = {part * size:.3g}"
            yield Place(ZERO, _with_states(domain.draw(generator), {slot: part * size}), how)


def _scaled(domain: Domain, generator: random.Random, scale: float) -> Place:
    """Scale all states, angles only down, and all inputs."""
    point = domain.draw(generator)
    left = domain.angles if scale > 1 else frozenset()
    states = [v if k in left else v * scale for k, v in enumerate(point.x)]
    scaled = Point(point.t, states, point.p, [v * scale for v in point.u])
    return Place(EXTREME, scaled, f"states of size {scale:.0e}")


def _singular(
    program: Program,
    layout: Layout,
    domain: Domain,
    generator: random.Random,
    number: int,
    text: str,
) -> Iterator[Place]:
    """Approach every singular value that the coordinate has in its range, from both sides."""
    slot = layout.coordinates[number] if layout.coordinates else -1
    if slot < 0:
        return
    point = domain.draw(generator)
    small = prune(program, [SINGULARITIES])

    def value(x: float) -> float:
        found = interpret_exactly(small, _with_states(point, {slot: x}), 20)
        return float(found[SINGULARITIES][number])

    name, (low, high) = layout.states[slot].name, domain.states[slot]
    for root in _roots(value, (low, high)):
        for distance in DISTANCES:
            for x in (root - distance, root + distance):
                if low <= x <= high:
                    how = f"{text} = 0 at {name} = {root:.6g}, {distance:.0e} away"
                    yield Place(SINGULAR, _with_states(point, {slot: x}), how)


def _roots(value: Callable[[float], float], span: Range) -> Sequence[float]:
    """Return the zeros at which ``value`` changes sign over a grid, by bisection."""
    low, high = span
    grid = [low + (high - low) * k / GRID for k in range(GRID + 1)]
    found: list[float] = []
    known = [value(x) for x in grid]
    for k in range(GRID):
        left, right = known[k], known[k + 1]
        if left == 0.0:
            found.append(grid[k])
        elif left * right < 0:
            found.append(_bisected(value, grid[k], grid[k + 1], left))
    if known[-1] == 0.0 and high > low:
        found.append(high)
    return found


def _bisected(value: Callable[[float], float], low: float, high: float, left: float) -> float:
    while True:
        middle = low + (high - low) / 2
        if not low < middle < high:
            return low
        there = value(middle)
        if there == 0.0:
            return middle
        low, high = (middle, high) if there * left > 0 else (low, middle)


ALL_DIGITS = 1 / UNIT_ROUNDOFF
"""Ulps from which on no digit is right."""

EXACT, ACCURATE, ILL, UNSTABLE = "exact", "accurate", "ill-conditioned", "unstable"
UNDERFLOWS, OVERFLOWS, NOT_A_NUMBER = "underflows", "overflows", "not a number"
VERDICTS = (EXACT, ACCURATE, ILL, UNDERFLOWS, OVERFLOWS, NOT_A_NUMBER, UNSTABLE)
"""From the best to the worst."""


@dataclass(frozen=True)
class Cause:
    """What a result owes its error to.

    ``formula``: where digits are lost, as text; ``digits``: how many; ``share``: of the error that comes
    from there. ``operands``, ``value``: the numbers that meet there, and what they give.
    """

    formula: str
    digits: float
    share: float
    operands: tuple[float, ...]
    value: float


@dataclass(frozen=True)
class Finding:
    """One result at one point.

    ``at``: values by name; ``how`` the point was made. ``value``: what was computed, ``exact``: the same
    with 50 digits, rounded. ``ulps``: the error, in units in the last place of the exact value;
    ``bound``: that which running error analysis allows, in ulps. ``condition``: the condition number.
    ``verdict``: one of `VERDICTS`. ``cause``: of the error, where it was looked for.
    """

    at: Mapping[str, float]
    how: str
    value: float
    exact: float
    ulps: float
    bound: float
    condition: float
    verdict: str
    cause: Cause | None


@dataclass(frozen=True)
class Row:
    """One result in one region.

    ``group``, ``result``, ``region``: their names. ``operations``: of the result. ``points``: how many
    were compared; ``typical``: the median error in ulps; ``worst``: where the error is largest;
    ``judged``: where it is largest against what condition and operations allow; ``failed``: the first
    point with an infinity or NaN for a finite value.
    """

    group: str
    result: str
    region: str
    points: int
    operations: int
    typical: float
    worst: Finding | None
    judged: Finding | None
    failed: Finding | None

    @property
    def verdict(self) -> str:
        """The worst verdict of the points that are kept."""
        kept = [f.verdict for f in (self.worst, self.judged, self.failed) if f is not None]
        return max(kept, key=VERDICTS.index, default=EXACT)


@dataclass(frozen=True)
class Gain:
    """Where a rewriting makes most difference to a result.

    ``group``, ``result``, ``region``: their names. ``at``: values by name. ``before``, ``after``: the
    error in ulps without and with it.
    """

    group: str
    result: str
    region: str
    at: Mapping[str, float]
    before: float
    after: float


@dataclass(frozen=True)
class Change:
    """A rewriting of formulas.

    ``identities``: (identity, formula that it replaces), in order. ``gains``: what results gain by it.
    """

    identities: tuple[tuple[str, str], ...]
    gains: tuple[Gain, ...]


@dataclass(frozen=True)
class AccuracyReport:
    """What was measured of a compiled system: the error of each result against 50 digits.

    Parameters
    ----------
    system : str
        The name of what was measured.
    target : str
        For which it was compiled.
    stable : bool
        Whether every identity against cancellation was applied.
    samples : int
        As of `codegen.accuracy`.
    seed : int
        As of `codegen.accuracy`.
    domain : mapping of str to Range
        (low, high) by name, in the units of the system.
    unit : tuple of tuple of str
        Names of states that are one unit quaternion.
    rows : tuple of three numbers
        One a result and region; errors are in units in the last place (ulps).
    made : Change
        A rewriting of this code.
    possible : Change
        One that ``stable=True`` would add.

    References
    ----------
    Higham, Accuracy and Stability of Numerical Algorithms (2002), sect. 1.6.
    """

    system: str
    target: str
    stable: bool
    samples: int
    seed: int
    domain: Mapping[str, Range]
    unit: tuple[tuple[str, ...], ...]
    rows: tuple[Row, ...] = field(repr=False)
    made: Change
    possible: Change

    def __repr__(self) -> str:
        """Say what was measured, the worst result, and how many lose digits by their formula."""
        own = [(f.ulps, r.result) for r in self.rows if r.region == TYPICAL for f in [r.worst] if f]
        worst = "".join(f"; {name} to {ulps:.2g} ulps" for ulps, name in [max(own)]) if own else ""
        told = f"; unstable: {len(self.unstable)}" if self.unstable else ""
        return (
            f"AccuracyReport({self.system} for {self.target}, {self.samples} samples{worst}{told})"
        )

    def _repr_html_(self) -> str:
        """Return what a notebook displays: the errors of each result, and what to do about them."""
        return str(display("accuracy as page", self))

    def row(self, result: str, region: str = REGIONS[0], group: str = RATES) -> Row:
        """Return the row of a result.

        Parameters
        ----------
        result : str
            Its name.
        region : str, default "domain"
            ``domain``, ``zero``, ``singular`` or ``extreme``.
        group : str, default "rates"
            ``rates``, ``outputs`` or ``invariants``.

        Returns
        -------
        Row
            Errors in ulps, and where the worst was found.

        Raises
        ------
        InputError
            Where there is none.
        """
        for row in self.rows:
            if (row.group, row.result, row.region) == (group, result, region):
                return row
        raise InputError(
            "no such row on the accuracy report",
            got=f"{group}, {result}, {region}",
            expected="; ".join(sorted({f"{r.group}, {r.result}" for r in self.rows})),
        )

    @property
    def unstable(self) -> tuple[Row, ...]:
        """Rows whose formula loses digits that the arguments do not."""
        return tuple(r for r in self.rows if r.verdict == UNSTABLE)
