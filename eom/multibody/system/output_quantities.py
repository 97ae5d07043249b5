"""What is told of a motion beside its rates: outputs, points, reactions, constants."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import unknown_name
from eom.multibody.algebra.lazy_sums import Naming, plain
from eom.multibody.algebra.scalars import add, is_zero, mul, reciprocal, sub
from eom.multibody.constrained.constraint_plan import Binding, constraint_loads, inner, lossless
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import GROUND, Tree
from eom.multibody.model.names import symbols_in, values_of
from eom.multibody.recursion.lumped_tree import LumpedTree
from eom.multibody.recursion.quantities import (
    HALF,
    QUANTITIES,
    Flow,
    Point,
    first_moments,
    flow,
    gravity_potential,
    kinetic_energy,
    mass,
    momentum,
    point,
)
from eom.multibody.recursion.springs import end, twice_potential
from eom.multibody.system import reactions
from eom.multibody.system.reactions import Reaction, joint_named, of_all
from eom.quantities import TIME, Definition, Quantity


@dataclass(frozen=True)
class Variables:
    """Coordinates, speeds, their prescribed accelerations and generalised forces, as scalars."""

    q: list[Any]
    u: list[Any]
    prescribed: dict[int, Any]
    tau: list[Any]
    binding: Binding


class Told:
    """What outputs are made of, each made when it is first asked for."""

    def __init__(
        self,
        tree: Tree,
        bones: LumpedTree,
        variables: Variables,
        work: Naming,
        accelerations: Sequence[Any],
        asked: frozenset[str],
    ) -> None:
        self.tree, self.bones, self.variables, self.work = tree, bones, variables, work
        self.accelerations, self.asked = accelerations, asked

    @cached_property
    def flow(self) -> Flow:
        """The motion of all parts."""
        return flow(self.bones, self.variables.q, self.variables.u, self.work)

    @cached_property
    def wrenches(self) -> reactions.Wrenches:
        """What goes through the joints; fixed ones are parts of their own where they are asked for."""
        motion = (self.variables.q, self.variables.u, self.accelerations)
        held = self.variables.binding
        further = constraint_loads(held) if self.tree.constraints else None
        return reactions.Wrenches(self.tree, self.work.atom, self.work, motion, self.asked, further)

    def potential(self) -> Any:
        """Return the potential energy of gravity and springs."""
        found = gravity_potential(self.bones, self.flow)
        start = 0
        for joint in self.tree.ordered:
            for k, c in enumerate(joint.row.paired(joint.attitude)):
                if c is not None and not is_zero(joint.stiffness[k]):
                    x = sub(self.variables.q[start + c], self.work.atom(joint.rest[k]))
                    x = self.work.keep("stretch", joint.name, str(k + 1), x)
                    stiffness = self.work.atom(joint.stiffness[k])
                    found = add(found, mul(HALF, mul(stiffness, mul(x, x))))
            start += len(joint.coordinates)
        flow, work = self.flow, self.work
        for link in self.bones.links:
            first, second = (end(link, n, flow.poses, flow.velocities, work) for n in (0, 1))
            found = add(found, mul(HALF, twice_potential(link, first, second, work)))
        return found

    def kinetic(self) -> Any:
        """Return the kinetic energy."""
        return kinetic_energy(self.flow, self.variables.u)


def _definition(name: str, unit: str, meaning: str, value: Any) -> Definition:
    return Definition(Quantity(sp.Symbol(name, real=True), unit, meaning), plain(value))


def _vector(name: str, unit: str, meaning: str, values: Sequence[Any]) -> list[Definition]:
    return [
        _definition(f"{name}_{k}", unit, f"{meaning}, along axis {k} of the ground", x)
        for k, x in enumerate(values, 1)
    ]


def _energy(told: Told) -> list[Definition]:
    return [_definition("energy", "J", "kinetic and potential energy",
                        add(told.kinetic(), told.potential()))]  # fmt: skip


def _energies(told: Told) -> list[Definition]:
    kinetic, potential = told.kinetic(), told.potential()
    return [
        _definition("kinetic_energy", "J", "kinetic energy", kinetic),
        _definition("potential_energy", "J", "potential energy of gravity and springs", potential),
    ]


def _momentum(told: Told) -> list[Definition]:
    L, p = momentum(told.flow)
    return [
        *_vector("p", "kg m/s", "momentum", p),
        *_vector("L", "kg m^2/s", "angular momentum about the ground's origin", L),
    ]


def _centre(told: Told) -> list[Definition]:
    whole = mass(told.flow)
    inverse = told.work.keep("inverse", told.tree.name, "", reciprocal(whole))
    return _vector(
        "centre", "m", "centre of mass", [mul(inverse, x) for x in first_moments(told.flow)]
    )


def _constraint_forces(told: Told) -> list[Definition]:
    return told.variables.binding.forces() if told.tree.constraints else []


def _reactions(told: Told) -> list[Definition]:
    return [d for r in of_all(told.tree) for d in reactions.definitions(told.wrenches, r)]


def _drives(told: Told) -> list[Definition]:
    return reactions.drives(told.wrenches, told.variables.tau)


def _point(told: Told, given: Point) -> list[Definition]:
    """Return what is told of a point."""
    moved = (told.variables.u, told.accelerations)
    found = point(given, told.bones, told.flow, moved, told.work.atom, told.work)
    rows = [(QUANTITIES[name], name, value) for name, value in found.items()]
    return [
        d
        for (letter, unit), name, value in rows
        for d in _vector(f"{letter}_{given.name}", unit, f"{name} of {given.name}", value)
    ]


OUTPUTS: dict[str, Callable[[Told], list[Definition]]] = {
    "energies": _energies,
    "momentum": _momentum,
    "centre_of_mass": _centre,
    "constraint_forces": _constraint_forces,
    "reactions": _reactions,
    "drives": _drives,
}
"""What can be asked for beside the motion, and single reactions."""


def check(tree: Tree, wanted: str | Reaction | Point) -> None:
    """Raise `InputError` for outputs that are not known."""
    if isinstance(wanted, Reaction):
        joint_named(tree, wanted.joint, f"tree {tree.name!r}: reaction")
    elif not isinstance(wanted, Point) and wanted not in OUTPUTS:
        raise unknown_name("output", wanted, OUTPUTS, f"tree {tree.name!r}")


def told_of(told: Told, wanted: str | Reaction | Point) -> list[Definition]:
    """Return the definitions of an output, a reaction or a point."""
    if isinstance(wanted, Reaction):
        return reactions.definitions(told.wrenches, wanted)
    return _point(told, wanted) if isinstance(wanted, Point) else OUTPUTS[wanted](told)


def invariants_of(told: Told) -> list[Definition]:
    """Return norms of quaternions; energy if nothing drives or brakes; momentum if it floats alone."""
    tree = told.tree
    found = [*told.variables.binding.sums()]
    for joint in tree.ordered:
        if joint.row.attitude and joint.attitude == QUATERNION and joint.motion is None:
            square = sp.Add(*(c.symbol**2 for c in joint.coordinates[-4:]))
            meaning = f"norm of the quaternion of {joint.name}"
            symbol = sp.Symbol(f"norm_{joint.name}", real=True)
            found.append(Definition(Quantity(symbol, "1", meaning), sp.sqrt(square)))
    if conservative(tree):
        found += _energy(told)
    if afloat(tree):
        found += _momentum(told)
    return found


def afloat(tree: Tree) -> bool:
    """Tell whether nothing acts from outside on a tree of one free root: what joints do is internal."""
    roots = [j for j in tree.joints if j.parent == GROUND]
    held = any(GROUND in s.bodies for s in tree.springs) or any(
        j.kind != "free" or j.motor or not all(map(is_zero, (*j.damping, *j.force, *j.armature)))
        for j in roots
    )
    alone = not (held or len(roots) > 1 or tree.loads) and inner(tree)
    return alone and all(map(is_zero, tree.gravity)) and _unchanging(tree)


def _unchanging(tree: Tree) -> bool:
    """Tell whether masses and their places in bodies and rotors are free of time, state and inputs."""
    quiet = replace(
        tree,
        joints=tuple(replace(j, motion=None, damping=0, force=0, stiffness=0) for j in tree.joints),
        rotors=tuple(replace(r, speed=None, torque=0, damping=0) for r in tree.rotors),
        springs=(),
    )
    return not _varying(tree) & set(symbols_in(values_of(quiet)))


def _varying(tree: Tree) -> set[sp.Symbol]:
    moving = {q.symbol for j in tree.joints for q in (*j.coordinates, *j.speeds)}
    moving |= {s.symbol for r in tree.rotors for s in r.states}
    return {TIME, *moving, *(i.symbol for i in tree.inputs)}


def conservative(tree: Tree) -> bool:
    """Tell whether nothing but gravity and springs acts, so that the energy is constant."""
    joints = all(
        j.motion is None and not j.motor and all(map(is_zero, (*j.damping, *j.force)))
        for j in tree.joints
    )
    coasting = all(
        r.speed is None and not r.motor and is_zero(r.torque) and is_zero(r.damping)
        for r in tree.rotors
    )
    fixed = not _varying(tree) & set(symbols_in(values_of(tree)))
    coasting = coasting and all(is_zero(s.damping) for s in tree.springs)
    return joints and coasting and fixed and not tree.loads and lossless(tree)
