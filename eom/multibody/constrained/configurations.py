"""Configurations of a constrained tree in numbers: found by Levenberg's and Marquardt's iteration.

Only the geometry counts: masses, rotors, loads and springs are left out. A change of a configuration
is a vector over the speeds, q' = N(q) u for a unit of time, so that attitudes stay attitudes. Damping as
the size of what is left keeps convergence quadratic where constraints are redundant: Yamashita and
Fukushima, "On the rate of convergence of the Levenberg-Marquardt method", Computing Suppl. 15 (2001)
239-249.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.algebra.values import is_number
from eom.multibody.constrained.equations import Component, components
from eom.multibody.constrained.point_kinematics import Arithmetic, scene
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Body, Joint, Tree
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.motion import coordinate_rates
from eom.quantities import TIME

TURNS = 200
SLOW, BARELY = 8, 1e-4
"""Turns that reduce what is left by no more than this share, after which the iteration ends."""
CLOSE = 1e-11
"""What may be left of a constraint, relative to the lengths of the tree (1 m at least)."""
FLOATS = Numbers(math.sin, math.cos)
Row = list[float]


@dataclass(frozen=True)
class Linear:
    """The constraints at a configuration: values (None between speeds alone), rows, offsets."""

    components: tuple[Component, ...]
    values: tuple[float | None, ...]
    rows: tuple[Row, ...]
    offsets: tuple[float, ...]

    @property
    def left(self) -> float:
        """The largest value."""
        return max((abs(v) for v in self.values if v is not None), default=0.0)


@dataclass
class Geometry:
    """A tree without masses, and the values of its symbols."""

    tree: Tree
    known: dict[Any, float]
    _fixed: dict[Any, float] = field(default_factory=dict)

    @classmethod
    def of(cls, tree: Tree, known: Mapping[Any, float]) -> Geometry:
        """Return the geometry of a tree, given values of parameters, inputs and time by symbol."""
        bare = replace(
            tree,
            bodies=tuple(Body(b.name, 1) for b in tree.bodies),
            joints=tuple(replace(j, armature=0, force=0, stiffness=0, damping=0, rest=0)
                         for j in tree.joints),
            loads=(),
            rotors=(),
            springs=(),
            gravity=(0, 0, 0),
        )  # fmt: skip
        return cls(bare, {TIME: 0.0, **known})

    @cached_property
    def bones(self) -> LumpedTree:
        """The parts in numbers."""
        return lumped_tree(self.tree, self.lift, FLOATS)

    @cached_property
    def coordinates(self) -> list[Any]:
        """The symbols of all coordinates."""
        return [c.symbol for j in self.tree.ordered for c in j.coordinates]

    @cached_property
    def free(self) -> list[int]:
        """The numbers of the speeds whose motion is not prescribed."""
        driven = set(self.bones.driven)
        return [k for k in range(self.bones.speeds) if k not in driven]

    def lift(self, given: Any) -> Any:
        """Return the number that a value of the description has."""
        if is_number(given):
            return given if given in (0, 1, -1) else float(given)
        if given in self.known:
            return self.known[given]
        missing = given.free_symbols - set(self.known)
        if missing:
            raise InputError(
                "no value", where=f"tree {self.tree.name!r}",
                got=", ".join(sorted(map(str, missing))),
                hint="give numbers for what the constraints depend on",
            )  # fmt: skip
        return float(given.xreplace({s: sp.Float(self.known[s]) for s in given.free_symbols}))

    def completed(self, q: Sequence[float]) -> list[float]:
        """Return coordinates with the prescribed ones in place, and quaternions of norm 1."""
        found, k = list(q), 0
        for joint in self.tree.ordered:
            size = len(joint.coordinates)
            if joint.motion is not None:
                found[k : k + size] = [float(self.lift(x)) for x in joint.motion.position]
            elif has_quaternion(joint):
                norm = math.sqrt(sum(x * x for x in found[k + size - 4 : k + size]))
                for n in range(k + size - 4, k + size):
                    found[n] = found[n] / norm if norm else float(n == k + size - 4)
            k += size
        return found

    def linear(self, q: Sequence[float]) -> Linear:
        """Return the constraints at a configuration; rows are over all speeds."""
        self.known.update(zip(self.coordinates, q, strict=True))
        arithmetic = Arithmetic(self.lift, FLOATS, math.sqrt)
        found = tuple(components(self.tree, scene(self.bones, q, None, arithmetic)))
        values = (c.relation.value() for c in found)
        return Linear(
            found,
            tuple(None if v is None else float(v) for v in values),
            tuple(_full(c.relation.row(), self.bones.speeds) for c in found),
            tuple(float(c.relation.offset()) for c in found),
        )

    def moved(self, q: Sequence[float], change: Sequence[float]) -> list[float]:
        """Return a configuration after a change, given over the speeds."""
        rates = coordinate_rates(self.bones, q, change, FLOATS)
        return self.completed([a + float(b) for a, b in zip(q, rates, strict=True)])

    def driven_speeds(self) -> dict[int, float]:
        """Return the speeds of joints whose motion is prescribed."""
        found: dict[int, float] = {}
        k = 0
        for joint in self.tree.ordered:
            if joint.motion is not None:
                found |= {k + n: float(self.lift(x)) for n, x in enumerate(joint.motion.rate)}
            k += len(joint.speeds)
        return found


def has_quaternion(joint: Joint) -> bool:
    """Tell whether the last four coordinates of a joint are a quaternion."""
    return joint.row.attitude and joint.attitude == QUATERNION


def _full(row: Mapping[int, Any], size: int) -> Row:
    return [float(row.get(k, 0)) for k in range(size)]


@dataclass(frozen=True)
class Closed:
    """Where the iteration ended: configuration, constraints there, and how many turns it took."""

    q: list[float]
    at: Linear
    turns: int

    @property
    def met(self) -> bool:
        """Whether all constraints hold."""
        return self.at.left <= CLOSE * max(1.0, *map(abs, self.q), 1.0)


def closed(geometry: Geometry, q: Sequence[float], mobility: Sequence[float]) -> Closed:
    """Return the configuration near ``q`` that meets the constraints best.

    ``mobility``: how freely each speed's coordinate changes; each turn makes the least change, in
    which squares are divided by the squares of these; 0 for what stays.

    Raises `InputError` where the constraints have no derivative at ``q``.
    """
    q = geometry.completed(q)
    here = _tried(geometry, q)
    if here is None:
        raise InputError(
            "the constraints have no derivative at the start values",
            where=f"tree {geometry.tree.name!r}",
            hint="a wheel must not lie flat",
        )
    damping, slow = 1.0, 0
    for turn in range(TURNS):
        size = _norm(here)
        if size == 0.0 or slow > SLOW:
            return Closed(q, here, turn)
        trial_q = geometry.moved(
            q, _step(geometry, here, mobility, damping * min(size * size, size))
        )
        trial = _tried(geometry, trial_q)
        if trial is not None and _norm(trial) < size:
            slow = slow + 1 if _norm(trial) > size * (1 - BARELY) else 0
            q, here, damping = trial_q, trial, damping / 4
        elif damping > 1e12 or size < 1e-15:
            return Closed(q, here, turn)
        else:
            damping *= 8
    return Closed(q, here, TURNS)


def _tried(geometry: Geometry, q: Sequence[float]) -> Linear | None:
    """Return the constraints at a configuration, None where they have no derivative: a flat wheel."""
    try:
        found = geometry.linear(q)
    except InputError:
        raise
    except (ZeroDivisionError, ValueError):
        return None
    sizes = [x for row in found.rows for x in row]
    return found if all(map(math.isfinite, sizes)) else None


def _norm(at: Linear) -> float:
    found = math.sqrt(sum(v * v for v in at.values if v is not None))
    return found if math.isfinite(found) else math.inf


def _step(geometry: Geometry, at: Linear, mobility: Sequence[float], damping: float) -> Row:
    """Return the damped least change over the speeds."""
    wanted = [(row, v) for row, v in zip(at.rows, at.values, strict=True) if v is not None]
    free = [k for k in geometry.free if mobility[k]]
    rows = [[row[k] * mobility[k] for k in free] for row, _ in wanted]
    gram = [[_dot(a, b) for b in rows] for a in rows]
    largest = max((gram[i][i] for i in range(len(gram))), default=0.0)
    for i in range(len(gram)):
        gram[i][i] += damping + 1e-15 * largest + 1e-300
    y = solved(gram, [-v for _, v in wanted])
    change = [0.0] * geometry.bones.speeds
    for n, k in enumerate(free):
        change[k] = mobility[k] * sum(row[n] * x for row, x in zip(rows, y, strict=True))
    return change


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def solved(A: Sequence[Sequence[float]], b: Sequence[float]) -> list[float]:
    """Return x with A x = b, by Gaussian elimination with partial pivoting."""
    rows = [[*map(float, row), float(y)] for row, y in zip(A, b, strict=True)]
    n = len(rows)
    for k in range(n):
        best = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[best] = rows[best], rows[k]
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            for j in range(k, n + 1):
                rows[i][j] -= factor * rows[k][j]
    x = [0.0] * n
    for k in range(n - 1, -1, -1):
        x[k] = (rows[k][n] - sum(rows[k][j] * x[j] for j in range(k + 1, n))) / rows[k][k]
    return x


def random_values(symbols: Iterable[Any], draw: random.Random) -> dict[Any, float]:
    """Return a number between 1/2 and 3/2 for each symbol."""
    return {s: draw.uniform(0.5, 1.5) for s in symbols}
