"""The parts of an equation of motion by kind, and which factor each goes with.

On the left: inertial terms (entries of the mass matrix times accelerations), centrifugal (u_i^2) and
Coriolis (u_i u_j); see Craig, Introduction to Robotics (2005), sec. 6.8. Gyroscopic: of the terms that
are linear in the free speeds and stem from prescribed ones, the skew-symmetric part of their matrix,
which does no work; so Jeans, Astronomy and Cosmogony (1928), eq. (177.2). What else prescribed motion
brings is of a kind of its own. Then gravity, springs and dampers; applied forces on the right.

What a method finds: parts of the equations, each with where it comes from.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import sympy as sp

from eom.multibody.algebra.scalars import is_zero
from eom.multibody.closed.mechanism import Mechanism
from eom.multibody.closed.polynomials import Monomial, Polynomial, Scalar

Expr = Any
HALF = Fraction(1, 2)


class Kind(NamedTuple):
    """A kind of term: heading, and whether it stands on the left."""

    title: str
    left: bool = True


KINDS: dict[str, Kind] = {
    "inertial": Kind("Inertial"),
    "centrifugal": Kind("Centrifugal"),
    "coriolis": Kind("Coriolis"),
    "gyroscopic": Kind("Gyroscopic"),
    "prescribed": Kind("Prescribed motion"),
    "gravity": Kind("Gravity"),
    "spring": Kind("Springs"),
    "damper": Kind("Dampers"),
    "applied": Kind("Applied", left=False),
}
"""The kinds in the order in which they are shown."""


class Key(NamedTuple):
    """Which term: equation, kind, and the product of speeds or the acceleration that it goes with."""

    row: int
    kind: str
    factor: Monomial


@dataclass(frozen=True)
class Part:
    """A term of an equation as a method finds it: its coefficient, and what each step gives to it."""

    key: Key
    coefficient: Scalar
    origins: tuple[tuple[str, Scalar], ...]


def parts(mechanism: Mechanism, found: Iterable[Contribution]) -> dict[Key, Part]:
    """Return the terms of the equations, those of each row in the order of `KINDS`; zeros left out."""
    sorter = _Sorter(mechanism)
    for contribution in found:
        sorter.add(contribution)
    sorter.divide()
    made = {}
    for key in sorted(sorter.found, key=lambda k: _order(mechanism, k)):
        origins = {label: x for label, x in sorter.found[key].items() if not is_zero(x)}
        total: Scalar = 0
        for x in origins.values():
            total = total + x
        if not is_zero(total):
            made[key] = Part(key, total, tuple(origins.items()))
    return made


def factor(mechanism: Mechanism, monomial: Monomial) -> Expr:
    """Return the product that a coefficient goes with, as an expression."""
    return sp.Mul(*(mechanism.algebra.generators[g] ** p for g, p in monomial))


def _order(mechanism: Mechanism, key: Key) -> tuple[Any, ...]:
    numbers = {g: k for k, g in enumerate(_moving(mechanism))}
    kinds = list(KINDS)
    return key.row, kinds.index(key.kind), [(numbers[g], -p) for g, p in _sorted(numbers, key)]


def _sorted(numbers: dict[int, int], key: Key) -> list[tuple[int, int]]:
    return sorted(key.factor, key=lambda x: numbers[x[0]])


def _moving(mechanism: Mechanism) -> list[int]:
    """Return the generators that are accelerations and speeds."""
    index = mechanism.algebra.index
    names = [*mechanism.accelerations, *(u.symbol for u in mechanism.speeds)]
    return [index(s) for s in names]


class _Sorter:
    """Puts contributions where they belong."""

    def __init__(self, mechanism: Mechanism) -> None:
        index = mechanism.algebra.index
        speeds = [index(u.symbol) for u in mechanism.speeds]
        rates = [index(a) for a in mechanism.accelerations]
        self.free = {speeds[k] for k in mechanism.free}
        self.forced = {speeds[k] for k in mechanism.forced}
        self.free_rates = {rates[k] for k in mechanism.free}
        self.forced_rates = {rates[k] for k in mechanism.forced}
        self.rows = {speeds[k]: row for row, k in enumerate(mechanism.free)}
        self.mechanism = mechanism
        self.found: dict[Key, dict[str, Scalar]] = {}
        self.linear: dict[str, dict[tuple[int, int], Scalar]] = {}

    def add(self, c: Contribution) -> None:
        """Add a contribution."""
        if c.source == "motion":
            self._motion(c)
        elif c.source == "damper":
            for m, x in _by(c.value, self.free | self.forced).items():
                self._put(Key(c.row, c.source, m), c.label, x)
        else:
            self._put(Key(c.row, c.source, ()), c.label, c.value)

    def _put(self, key: Key, label: str, x: Scalar) -> None:
        labelled = self.found.setdefault(key, {})
        labelled[label] = labelled.get(label, 0) + x

    def _motion(self, c: Contribution) -> None:
        moving = self.free | self.forced | self.free_rates | self.forced_rates
        for m, x in _by(c.value, moving).items():
            kind = self._kind(m)
            if kind == "linear":
                self._linear(c, m, x)
            else:
                self._put(Key(c.row, kind, m), c.label, x)

    def _kind(self, m: Monomial) -> str:
        used = {g for g, _ in m}
        if used & self.free_rates:
            return "inertial"
        if used & (self.forced | self.forced_rates):
            count = sum(p for g, p in m if g in self.free)
            return "linear" if count == 1 else "prescribed"
        return "centrifugal" if len(used) == 1 else "coriolis"

    def _linear(self, c: Contribution, m: Monomial, x: Scalar) -> None:
        """Keep an entry of the matrix of terms that are linear in the free speeds."""
        (speed,) = (g for g, _ in m if g in self.free)
        rest = tuple(p for p in m if p[0] != speed)
        matrix = self.linear.setdefault(c.label, {})
        value = x * Polynomial(self.mechanism.algebra, {rest: 1})
        key = (c.row, speed)
        matrix[key] = matrix.get(key, 0) + value

    def divide(self) -> None:
        """Divide the matrices of linear terms into skew-symmetric and symmetric parts."""
        for label, matrix in self.linear.items():
            for row, own in ((r, g) for r in self.rows.values() for g in self.rows):
                mine = matrix.get((row, own), 0)
                mirrored = matrix.get((self.rows[own], self._speed(row)), 0)
                for kind, x in (
                    ("gyroscopic", mine - mirrored),
                    ("prescribed", mine + mirrored),
                ):
                    if not is_zero(x):
                        self._put(Key(row, kind, ((own, 1),)), label, x * HALF)
        self.linear = {}

    def _speed(self, row: int) -> int:
        return next(g for g, r in self.rows.items() if r == row)


def _by(x: Scalar, wanted: set[int]) -> dict[Monomial, Scalar]:
    if not isinstance(x, Polynomial):
        return {} if is_zero(x) else {(): x}
    return x.by(lambda g: g in wanted)


@dataclass(frozen=True)
class Contribution:
    """A part of one equation.

    ``row``: number of the equation. ``source``: motion (mass times acceleration), gravity, spring,
    damper, which stand on the left, or applied, on the right. ``label``: the step that it comes from.
    """

    row: int
    source: str
    label: str
    value: Scalar
