"""How a tree is bound: what is kept of its constraints, which speeds follow, what a system reports.

Forces of constraints as loads on the parts of a tree, for reactions in its joints.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.multibody.algebra.lazy_sums import Naming, plain, used
from eom.multibody.algebra.scalars import Scalar, add, mul, total
from eom.multibody.algebra.spatial import SpatialVector, times
from eom.multibody.algebra.values import is_number, same, value
from eom.multibody.constrained.dependence import dependents, examine
from eom.multibody.constrained.equations import Component, components, sine_square
from eom.multibody.constrained.multipliers import (
    Bound,
    Dynamics,
    Follow,
    Solved,
    applied,
    bound,
    by_elimination,
    by_multipliers,
    constraint_forces,
    drifts,
    follow,
    followed,
)
from eom.multibody.constrained.relations import Arithmetic, Scene, loose, scene
from eom.multibody.model.bodies import GROUND
from eom.multibody.model.constraints import (
    Coupling,
    Distance,
    KnifeEdge,
    Loop,
    Rolling,
    SpeedEquation,
)
from eom.multibody.model.model import Tree, moves_nothing
from eom.multibody.recursion.lumped_tree import LumpedTree
from eom.quantities import TIME, Assumption, Definition, Quantity, Singularity

OF_SPEEDS = (Coupling, Rolling, KnifeEdge, SpeedEquation)
"""Constraints whose dependent speeds are eliminated unless one asks for multipliers."""
LONGEST = 20_000
"""Size up to which constraints are written out, so that start values are tested against them."""
ASSEMBLED = 1e-6
"""How far from meeting the constraints start values may be, relative to the largest of them."""


@dataclass(frozen=True)
class Plan:
    """What numbers decide before anything is derived.

    ``kept``: numbers of independent components. ``dependent``: speeds that are eliminated, or None
    for multipliers. ``remarks``: on components that were dropped.
    """

    kept: tuple[int, ...] = ()
    dependent: tuple[int, ...] | None = None
    remarks: tuple[str, ...] = ()


def plan(
    tree: Tree,
    start: Mapping[str, float] | None = None,
    independent: Sequence[str] | None = None,
    multipliers: bool | None = None,
) -> Plan:
    """Return how a tree is to be treated; see `eom.multibody.system.derive.derive`."""
    if not tree.constraints:
        if independent is not None:
            raise InputError("independent speeds of a tree without constraints", where=tree.name)
        return Plan()
    if independent is not None and multipliers:
        raise InputError("independent speeds belong to elimination", where=f"tree {tree.name!r}")
    found = examine(tree, start)
    if multipliers is None:
        light = moves_nothing(tree, frozenset()) is not None
        alone = all(isinstance(c, OF_SPEEDS) for c in tree.constraints)
        multipliers = not (independent is not None or alone or light)
    chosen = None if multipliers else dependents(tree, found, independent)
    return Plan(found.kept, chosen, found.remarks)


@dataclass
class Binding:
    """A plan carried out over named scalars; ``u`` are all speeds, those that follow under names."""

    tree: Tree
    plan: Plan
    lumped: LumpedTree
    q: Sequence[Any]
    u: list[Any]
    work: Naming
    still: list[Component] = field(default_factory=list)
    held: Bound = field(default_factory=lambda: Bound((), (), ()))
    way: Follow | None = None
    solved: Solved | None = None
    dynamics: Dynamics | None = None

    @property
    def arithmetic(self) -> Arithmetic:
        """Named scalars."""
        return Arithmetic(self.work.atom, self.work, self._sqrt)

    def _sqrt(self, x: Any) -> Any:
        root = sp.Pow(plain(x), sp.Rational(1, 2), evaluate=False)
        return self.work.atom(value(root, "square root"))

    def scene(self, u: Sequence[Any] | None) -> Scene:
        """Return the places of all points, and their motion where speeds are given."""
        return scene(self.lumped, self.q, u, self.arithmetic)

    def accelerations(self, tau: Sequence[Any], prescribed: Mapping[int, Any]) -> list[Any]:
        """Return u' of all speeds under the constraints."""
        given = Dynamics(self.lumped, self.q, self.u, tau, prescribed, self.work)
        moving = components(self.tree, self.scene(self.u))
        gamma = drifts(self.held, [moving[k] for k in self.plan.kept], self.work)
        if self.way is None:
            found = by_multipliers(given, self.held, gamma)
        else:
            found = by_elimination(given, self.way, gamma)
        self.solved, self.dynamics = found, given
        return found.udot

    def multipliers(self) -> Sequence[Any]:
        """Return the multipliers of the components that are held."""
        assert self.solved is not None
        assert self.dynamics is not None
        if self.solved.multipliers is not None:
            return self.solved.multipliers
        assert self.way is not None
        return constraint_forces(self.dynamics, self.way, self.solved.udot)

    def forces(self) -> list[Definition]:
        """Return the multipliers as definitions."""
        values = self.multipliers()
        return [
            _definition(f"lambda_{name}", c.unit, c.meaning, x)
            for name, c, x in zip(self.held.names, self.held.components, values, strict=True)
        ]

    def followers(self) -> list[Definition]:
        """Return the speeds that were eliminated."""
        if self.way is None:
            return []
        speeds = [s for j in self.tree.ordered for s in j.speeds]
        return [Definition(speeds[k], plain(self.u[k])) for k in self.way.dependent]

    def invariants(self) -> list[Definition]:
        """Return what the constraints keep at zero: values, and rates where speeds are not eliminated."""
        found = []
        for name, c in zip(self.held.names, self.held.components, strict=True):
            left = c.relation.value()
            if left is not None:
                meaning = f"what is left of the constraint {c.name}"
                found.append(_definition(f"closure_{name}", "", meaning, left))
        if self.way is None:
            rows = zip(self.held.names, self.held.components, self.held.rows,
                       self.held.offsets, strict=True)  # fmt: skip
            for name, c, row, offset in rows:
                rate = add(applied(row, self.u), offset)
                meaning = f"what is left of the rate of the constraint {c.name}"
                found.append(_definition(f"closure_rate_{name}", "", meaning, rate))
        return found

    def sums(self) -> list[Definition]:
        """Return what gears keep: sums of ratio times coordinate."""
        coordinates = {j.name: j.coordinates[0].symbol for j in self.tree.joints if j.coordinates}
        return [
            _definition(f"sum_{c.name}", "", f"sum of ratio times coordinate of {c.name}",
                        total(mul(self.work.atom(x), self.work.atom(coordinates[j]))
                              for j, x in c.ratios))
            for c in self.tree.constraints
            if isinstance(c, Coupling)
        ]  # fmt: skip

    def singularities(self) -> list[Singularity]:
        """Return where the equations fail: dependent constraints, a wheel that lies flat."""
        assert self.solved is not None
        meaning = (
            "the constraints become dependent on each other"
            if self.way is None
            else "the independent speeds no longer determine the others; choose others"
        )
        found = [
            Singularity(plain(x), sp.Symbol(f"constraint_{name}", real=True), meaning)
            for name, x in self.solved.pivots
        ]
        view = self.scene(None)
        for c in self.tree.constraints:
            if isinstance(c, Rolling) and c.axis is not None and not _thick(c):
                flat = plain(sine_square(c, view))
                symbol = sp.Symbol(f"constraint_{c.name}", real=True)
                found.append(Singularity(flat, symbol, f"the wheel of {c.name} lies flat"))
        return found

    def assumptions(self, invariants: Sequence[Definition]) -> tuple[Assumption, ...]:
        """Return that start values meet the constraints, and what was dropped, as assumptions."""
        results = [d.expression for d in invariants]
        needed = used(self.work.definitions, results)
        found: tuple[Any, ...] = ()
        if _written_out(needed, results) <= LONGEST:
            known: dict[Any, Any] = {}
            for d in needed:
                known[d.symbol] = d.expression.xreplace(known)
            found = tuple(e.xreplace(known) for e in results)
        met = Assumption(
            "assembled", "start values meet the constraints; eom.multibody.assemble finds such",
            vanish=found, tolerance=ASSEMBLED,
        )  # fmt: skip
        dropped = [Assumption("redundant", f"dropped: {text}") for text in self.plan.remarks]
        return (met, *dropped) if found else tuple(dropped)


def bind(
    given: Plan, tree: Tree, lumped: LumpedTree, q: Sequence[Any], u: list[Any], work: Naming
) -> Binding:
    """Carry a plan out: speeds that follow are defined by the others."""
    found = Binding(tree, given, lumped, q, list(u), work)
    if not tree.constraints:
        return found
    found.still = components(tree, found.scene(None))
    found.held = bound([found.still[k] for k in given.kept], work)
    if given.dependent is not None:
        found.way = follow(lumped, given.dependent, found.held, work)
        speeds = [s for j in tree.ordered for s in j.speeds]
        known = {s: u[s] for s in range(lumped.speeds) if s not in given.dependent}
        for k, x in followed(found.way, known, work).items():
            found.u[k] = x if is_number(x) else work.define(speeds[k], x)
    return found


def _definition(name: str, unit: str, meaning: str, x: Scalar) -> Definition:
    return Definition(Quantity(sp.Symbol(name, real=True), unit, meaning), plain(x))


def _written_out(definitions: Sequence[Definition], results: Sequence[Any]) -> int:
    """Return how many symbols and numbers stand in results in which definitions are written out."""
    sizes: dict[Any, int] = {}

    def size(expression: Any) -> int:
        if not expression.args:
            return sizes.get(expression, 1)
        return sum(map(size, expression.args))

    for d in definitions:
        sizes[d.symbol] = size(d.expression)
    return sum(map(size, results))


def lossless(tree: Tree) -> bool:
    """Return whether no constraint moves the tree, so that none does work."""
    speeds = {q.symbol: sp.Integer(0) for j in tree.joints for q in j.speeds}
    for c in tree.constraints:
        given = [x for x in c.values if not is_number(x)]
        if any(x.has(TIME) for x in given):
            return False
        if isinstance(c, SpeedEquation) and not same(given[0].xreplace(speeds), 0):
            return False
    return True


def inner(tree: Tree) -> bool:
    """Return whether the constraints hold bodies to each other alone, not to the ground."""
    return all(c.bodies and GROUND not in c.bodies and not isinstance(c, OF_SPEEDS)
               for c in tree.constraints)  # fmt: skip


def _thick(wheel: Rolling) -> bool:
    """Return whether a wheel is known to reach along its axis, so that it never lies flat."""
    half = wheel.half_axis
    return half > 0 if is_number(half) else bool(half.is_positive)


BETWEEN_POINTS = (Loop, Distance, Rolling, KnifeEdge)
"""Constraints that act on bodies; the others act within joints, along their speeds."""


def constraint_loads(binding: Binding) -> Callable[[LumpedTree], list[SpatialVector]]:
    """Return what gives the loads on the parts of a lumped_tree: moments about origins, and forces."""
    values = binding.multipliers()

    def loads(lumped: LumpedTree) -> list[SpatialVector]:
        still = scene(lumped, binding.q, None, binding.arithmetic)
        kinds = {c.name: type(c) for c in binding.tree.constraints}
        six: list[Scalar] = [0] * (6 * len(lumped.parts))
        found = components(binding.tree, loose(still))
        for number, multiplier in zip(binding.plan.kept, values, strict=True):
            if kinds[found[number].constraint] in BETWEEN_POINTS:
                for place, x in found[number].relation.row().items():
                    six[place] = add(six[place], mul(multiplier, x))
        return [_turned(R, six[6 * k : 6 * k + 6]) for k, (R, _) in enumerate(still.poses)]

    return loads


def _turned(R: Sequence[Sequence[Scalar]], six: Sequence[Scalar]) -> SpatialVector:
    return SpatialVector(times(R, six[:3]), times(R, six[3:]))
