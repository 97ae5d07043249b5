"""Whether what is stated of a system's structure holds: proved as identities modulo a prime.

Each statement is an equation between rates of the system and expressions; both sides are evaluated at
random points as `eom.exact.identity` says, modulo `LARGE_PRIME`: a false statement of total degree d
survives both points with a chance of at most (d / 2**529)**2. Quaternions are of unit length there, since
that is what is stated of them.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import sympy as sp

from eom.errors import InputError, near_matches
from eom.exact.identity import RandomPoint
from eom.fields import LARGE_PRIME, LARGE_RESIDUES, Singular, solve
from eom.kinematics.coordinates import SEQUENCES
from eom.kinematics.coordinates import attitude as coordinates_of
from eom.kinematics.frames import vector
from eom.rotations import quaternion_product
from eom.structure import COUNTS, QUATERNION, BodyAttitude

Expr = Any
Equation = tuple[str, Expr, int | None]
"""What is stated in words, an expression, and the state whose rate it is; None for one that is zero."""

POINTS, TRIES = 2, 20
KINDS = (*COUNTS, *SEQUENCES)


@dataclass(frozen=True)
class Motion:
    """What of a system its attitudes are about: passes that leave it alone prove nothing again.

    ``rates``: with the right sides of multipliers behind them, where the mass matrix has rows for some.
    """

    name: str
    states: tuple[Expr, ...]
    rates: tuple[Expr, ...]
    mass_matrix: Expr | None
    definitions: tuple[tuple[Expr, Expr], ...]
    time: Expr
    attitudes: tuple[BodyAttitude, ...]

    @cached_property
    def known(self) -> dict[Expr, Expr]:
        """The definitions by symbol."""
        return dict(self.definitions)

    @cached_property
    def number(self) -> dict[Expr, int]:
        """The places of the states."""
        return {s: k for k, s in enumerate(self.states)}

    def full(self, expression: Expr) -> Expr:
        """Return an expression over states, parameters, inputs and time."""
        known: dict[Expr, Expr] = {}
        if any(symbol in self.known for symbol in expression.free_symbols):
            for symbol, value in self.definitions:
                known[symbol] = value.xreplace(known)
        return expression.xreplace(known)


@lru_cache(maxsize=32)
def check(system: Motion) -> None:
    """Prove every attitude that is stated. Raises `InputError` that says which equation fails."""
    for k, stated in enumerate(system.attitudes):
        where = f"system {system.name!r}, attitude {stated.body or k + 1}"
        _check_shape(system, stated, where)
        _prove(system, stated, where)


def _check_shape(system: Motion, stated: BodyAttitude, where: str) -> None:
    if stated.kind not in KINDS:
        raise InputError(
            f"unknown kind of attitude {stated.kind!r}",
            where=where,
            expected="one of " + ", ".join(KINDS),
            hint=near_matches(stated.kind, KINDS),
        )
    count = COUNTS.get(stated.kind, 3)
    if len(stated.coordinates) != count:
        raise InputError(
            "wrong number of coordinates",
            where=where,
            got=f"{len(stated.coordinates)} for {stated.kind}",
            expected=count,
        )
    moving = [c for c in stated.coordinates if c is not None]
    moving += [v for d in stated.directions for v in d]
    strangers = [str(c) for c in moving if c not in system.number]
    if strangers:
        raise InputError("coordinates are no states", where=where, got=", ".join(strangers))
    if not stated.determined:
        raise InputError(
            "coordinates are missing that the rates of the others need",
            where=where,
            got=stated.kind,
        )
    if (stated.inertia is None) != (stated.torque is None):
        raise InputError("inertia and torque belong together", where=where)
    if stated.inertia is not None and stated.inertia.shape != (3, 3):
        raise InputError("inertia of the wrong shape", where=where, got=stated.inertia.shape)
    if stated.inertia is not None and stated.inertia != stated.inertia.T:
        raise InputError("inertia is not symmetric", where=where, got=stated.inertia)


def _prove(system: Motion, stated: BodyAttitude, where: str) -> None:
    equations = tuple(_equations(system, stated))
    for seed in range(POINTS):
        for words, off in zip(
            (e[0] for e in equations), _residuals(system, stated, equations, seed), strict=True
        ):
            if off:
                raise InputError(
                    f"stated, but not so: {words}",
                    where=where,
                    expected="an identity in states, parameters, inputs and time",
                    hint="correct the statement or the rates, or leave the statement out",
                )


def _residuals(
    system: Motion, stated: BodyAttitude, equations: Sequence[Equation], seed: int
) -> list[int]:
    """Return by how much each equation fails at a random point; others are tried where one divides by 0."""
    generator = random.Random(seed)  # noqa: S311 - reproducible points, no secrets
    for _ in range(TRIES):
        try:
            point = _point(system, stated, generator)
            rates = _Rates(system, point)
            found = []
            for _, expression, state in equations:
                rate = 0 if state is None else rates.of(state)
                found.append((_value(point, rates, expression) - rate) % LARGE_PRIME)
        except Singular:
            continue
        return found
    return [1] * len(equations)


def _value(point: RandomPoint, rates: _Rates, expression: Expr) -> int:
    """Return the value of an expression over symbols and `_Rate` of states."""
    for symbol in expression.atoms(_Rate):
        point.memo[symbol] = rates.of(int(symbol.args[0]))
    return int(point.value(expression))


class _Rate(sp.Function):  # type: ignore[misc]
    """The rate of a state, by its number."""


def _point(system: Motion, stated: BodyAttitude, generator: random.Random) -> RandomPoint:
    """Return a random point of the system, with the stated quaternion of unit length."""
    point = RandomPoint(generator, system.known, LARGE_RESIDUES)
    if stated.kind == QUATERNION:
        q = [generator.randrange(1, LARGE_PRIME) for _ in range(4)]
        size = LARGE_RESIDUES.inverse(sum(x * x for x in q))
        for symbol, v in zip(stated.coordinates, quaternion_product(q, q), strict=True):
            point.memo[symbol] = v * size % LARGE_PRIME
    return point


class _Rates:
    """The rates of a system at a point, each computed when it is asked for."""

    def __init__(self, system: Motion, point: RandomPoint) -> None:
        self.system, self.point = system, point
        self.known: dict[int, int] = {}

    def of(self, k: int) -> int:
        if k not in self.known:
            block = coupled(self.system.mass_matrix, k)
            right = [self.point.value(self.system.rates[i]) for i in block]
            mass = self.system.mass_matrix
            if mass is not None:
                rows = [[self.point.value(mass[i, j]) for j in block] for i in block]
                right = solve(rows, right, LARGE_RESIDUES)
            self.known |= dict(zip(block, right, strict=True))
        return self.known[k]


def coupled(mass: Expr | None, k: int) -> list[int]:
    """Return the states whose rates come from one solve with that of state ``k``, in order."""
    if mass is None:
        return [k]
    found, stack = {k}, [k]
    while stack:
        row = stack.pop()
        for j in range(mass.rows):
            if j not in found and (mass[row, j] != 0 or mass[j, row] != 0):
                found.add(j)
                stack.append(j)
    return sorted(found)


def _equations(system: Motion, stated: BodyAttitude) -> Iterator[Equation]:
    number = system.number
    rates = kinematics(stated)
    for c, rate in zip(stated.coordinates, rates, strict=True):
        if c is not None:
            yield f"d({c})/dt by the kinematics of {stated.kind} {_listed(stated)}", rate, number[c]
    omega = vector("B", stated.omega)
    for direction in stated.directions:
        turned = vector("B", direction).cross(omega).components
        for v, rate in zip(direction, turned, strict=True):
            yield f"d({v})/dt of a direction fixed in space, v x omega", rate, number[v]
    if stated.inertia is not None:
        for k, off in enumerate(_balance(system, stated, rates, number), 1):
            yield f"J d(omega)/dt + omega x J omega = torque, component {k}", off, None


def _listed(stated: BodyAttitude) -> str:
    return "(" + ", ".join("-" if c is None else str(c) for c in stated.coordinates) + ")"


def kinematics(stated: BodyAttitude) -> tuple[Expr, ...]:
    """Return the rates of the coordinates that follow from omega; those left out are dummies."""
    if not stated.coordinates:
        return ()
    symbols, omega, n, plain, turning = _formulas(stated.kind, stated.unspun)
    given = [sp.Dummy() if c is None else c for c in stated.coordinates]
    values = dict(zip(symbols, given, strict=True)) | dict(zip(omega, stated.omega, strict=True))
    values |= dict(zip(n, stated.frame_rate, strict=True))
    return tuple(r.xreplace(values) for r in (turning if stated.turns else plain))


@lru_cache
def _formulas(kind: str, unspun: bool) -> tuple[tuple[Expr, ...], ...]:
    """Return coordinates, omega, n, and rates over them in a frame A that stands still or turns."""
    chosen = coordinates_of(kind)
    symbols = tuple(q.symbol for q in chosen.coordinates)
    omega, n = (tuple(sp.Dummy(f"{x}{k}") for k in (1, 2, 3)) for x in "wn")
    carried = chosen.matrix * sp.Matrix(n)
    rates = [chosen.rates(vector("B", v)) for v in (omega, tuple(sp.Matrix(omega) - carried))]
    zero = {symbols[-1]: sp.Integer(0)} if unspun else {}
    plain, turning = (tuple(r.subs(zero) for r in group) for group in rates)
    return symbols, omega, n, plain, turning


def _balance(
    system: Motion, stated: BodyAttitude, rates: Sequence[Expr], number: dict[Expr, int]
) -> tuple[Expr, ...]:
    """Return J d(omega)/dt + W x J omega - torque, W the angular velocity of the axes."""
    omega, J = sp.Matrix(stated.omega), stated.inertia
    slope = sp.Matrix([_slope(system, w, number) for w in stated.omega])
    axes = omega
    if stated.unspun:
        spin = sp.zeros(3, 1)
        spin[stated.sequence[-1] - 1] = rates[-1]
        axes = omega - spin
    return tuple(J * slope + axes.cross(J * omega) - sp.Matrix(stated.torque))


def _slope(system: Motion, value: Expr, number: dict[Expr, int]) -> Expr:
    """Return the time derivative of an expression, over `_Rate` of the states in it."""
    if value in number:
        return _Rate(sp.Integer(number[value]))
    if not value.free_symbols:
        return sp.Integer(0)
    full = system.full(value)
    moving = sorted((s for s in full.free_symbols if s in number), key=str)
    terms = [full.diff(s) * _Rate(sp.Integer(number[s])) for s in moving]
    return sp.Add(*terms, full.diff(system.time))
