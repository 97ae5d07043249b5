"""A constrained tree as a differential-algebraic system of index 1, for solvers of F(t, y, y') = 0.

y holds coordinates q, speeds u, impulses p of the constraints and slacks s, with the multipliers as p' :

    q' = N (u + J^T s'),   M u' + h - tau = J^T p',   J u + b = 0,   phi = 0

s' is zero but for errors: both levels of the constraints are met at once. Gear, Leimkuhler and Gupta,
"Automatic integration of Euler-Lagrange equations with constraints", J. Comput. Appl. Math. 12-13 (1985)
77-90; that integrals of multipliers as unknowns lower the index by one: Gear, "Differential-algebraic
equation index transformations", SIAM J. Sci. Stat. Comput. 9 (1988) 39-47.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.multibody.algebra.light import Naming, plain, used
from eom.multibody.algebra.scalars import Scalar, add, mul, sub, total
from eom.multibody.constrained.binding import Binding, Plan
from eom.multibody.constrained.dependence import examine
from eom.multibody.constrained.multipliers import applied
from eom.multibody.model.model import Tree
from eom.multibody.model.names import inputs_of, named_of, parameters_of
from eom.multibody.recursion.motion import coordinate_rates
from eom.multibody.recursion.recursions import inverse_dynamics
from eom.multibody.recursion.skeleton import Skeleton, skeleton
from eom.multibody.system.derive import derive, variables_of
from eom.multibody.system.told import Variables
from eom.quantities import Definition, Quantity
from eom.system import System


@dataclass(frozen=True)
class Implicit:
    """Two systems with the same states y and parameters.

    ``residual``: its outputs are F, one a state; the last of its inputs are y', one a state, and they
    are its rates. ``explicit``: its rates are y' at consistent states.
    """

    residual: System
    explicit: System


def implicit(tree: Tree, *, start: Mapping[str, float] | None = None) -> Implicit:
    """Return a constrained tree in residual form, index 1; ``start``: see `derive`.

    Raises `InputError` as `derive` does, and for a tree without constraints.
    """
    if not tree.constraints:
        raise InputError("a tree without constraints needs no multipliers", where=tree.name)
    found = examine(tree, start)
    solved = derive(tree, ["constraint_forces"], start=start, multipliers=True)
    names = {c.name: c for c in solved.outputs}
    unknowns = _unknowns(solved)
    states = (*solved.states, *unknowns)
    rates = tuple(
        Quantity(sp.Symbol(f"rate_of_{q.name}", real=True), "", f"rate of {q.name}") for q in states
    )
    residual = _residual(tree, Plan(found.kept, None, found.remarks), states, rates)
    forces = [d.expression for d in names.values()]
    explicit = replace(
        solved,
        states=states,
        rates=(*solved.rates, *forces, *[sp.Integer(0)] * (len(unknowns) - len(forces))),
        outputs=(),
        singularities=(),
        maintained=(),
    )
    return Implicit(residual, explicit)


def _unknowns(solved: System) -> list[Quantity]:
    """Return impulses, one a multiplier, and slacks, one a constraint that has a value."""
    forces = [d.name.removeprefix("lambda_") for d in solved.outputs]
    values = [n.removeprefix("closure_") for n in solved.maintained if "closure_rate_" not in n]
    return [
        *(Quantity(sp.Symbol(f"impulse_{n}", real=True), "", f"integral of the multiplier of {n}")
          for n in forces),
        *(Quantity(sp.Symbol(f"slack_{n}", real=True), "", f"what brings {n} back") for n in values),
    ]  # fmt: skip


def _residual(
    tree: Tree, treated: Plan, states: Sequence[Quantity], rates: Sequence[Quantity]
) -> System:
    work = Naming(q.name for q in (*named_of(tree), *states, *rates))
    bones = skeleton(tree, work.atom, work)
    given = variables_of(tree, bones, treated, work)
    slopes = {q.symbol: work.atom(r.symbol) for q, r in zip(states, rates, strict=True)}
    left = _equations(tree, bones, given, slopes, work)
    outputs = tuple(
        Definition(
            Quantity(sp.Symbol(f"residual_{k}", real=True), "", "what is left of an equation"),
            plain(x),
        )
        for k, x in enumerate(left, 1)
    )
    return System(
        name=f"{tree.name}_residual",
        states=tuple(states),
        rates=tuple(r.symbol for r in rates),
        parameters=parameters_of(tree),
        inputs=(*inputs_of(tree), *rates),
        definitions=used(work.definitions, [d.expression for d in outputs]),
        outputs=outputs,
    )


def _equations(
    tree: Tree, bones: Skeleton, given: Variables, slopes: Mapping[Any, Scalar], work: Naming
) -> list[Scalar]:
    """Return what is left of all equations, in the order of the states."""
    binding = given.binding
    speeds = [s.symbol for j in tree.ordered for s in j.speeds]
    coordinates = [c.symbol for j in tree.ordered for c in j.coordinates]
    udot = [
        given.prescribed[k] if k in given.prescribed else slopes[u] for k, u in enumerate(speeds)
    ]
    needed = inverse_dynamics(bones, given.q, given.u, udot, work)
    impulses, slacks = _slopes_of(binding, slopes)
    moved = _moved(binding, given.u, slacks, bones)
    qdot = coordinate_rates(bones, given.q, moved, work)
    forces = [
        sub(sub(needed[k], given.tau[k]), _pushed(binding, impulses, k))
        for k in range(bones.speeds)
    ]
    held = binding.held
    values = [c.relation.value() for c in held.components]
    return [
        *(sub(slopes[c], x) for c, x in zip(coordinates, qdot, strict=True) if c in slopes),
        *(x for u, x in zip(speeds, forces, strict=True) if u in slopes),
        *(add(applied(row, given.u), b) for row, b in zip(held.rows, held.offsets, strict=True)),
        *(v for v in values if v is not None),
    ]


def _slopes_of(binding: Binding, slopes: Mapping[Any, Scalar]) -> tuple[list[Scalar], list[Scalar]]:
    """Return the multipliers, and the rates of slacks; 0 for constraints between speeds alone."""

    def of(kind: str, name: str) -> Scalar:
        return slopes.get(sp.Symbol(f"{kind}_{name}", real=True), 0)

    names = binding.held.names
    return [of("impulse", n) for n in names], [of("slack", n) for n in names]


def _pushed(binding: Binding, weights: Sequence[Scalar], speed: int) -> Scalar:
    """Return a component of J^T times weights."""
    return total(
        mul(row.get(speed, 0), w) for row, w in zip(binding.held.rows, weights, strict=True)
    )


def _moved(
    binding: Binding, u: Sequence[Scalar], slacks: Sequence[Scalar], bones: Skeleton
) -> list[Scalar]:
    """Return u + J^T s'; what is driven stays."""
    return [
        x if k in bones.driven else add(x, _pushed(binding, slacks, k)) for k, x in enumerate(u)
    ]
