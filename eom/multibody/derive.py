"""A tree of bodies as a `System`, by articulated bodies with every intermediate named."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import unknown_name
from eom.kinematics import rotation_sequence
from eom.multibody import reactions
from eom.multibody.articulated import forward_dynamics
from eom.multibody.binding import Binding, Plan, bind, inner, lossless, plan
from eom.multibody.bound_loads import constraint_loads
from eom.multibody.joints import QUATERNION
from eom.multibody.light import Naming, plain, used
from eom.multibody.model import GROUND, Joint, Tree
from eom.multibody.motion import coordinate_rates
from eom.multibody.quantities import (
    HALF,
    Flow,
    first_moments,
    flow,
    gravity_potential,
    kinetic_energy,
    mass,
    momentum,
)
from eom.multibody.reactions import Reaction, joint_named, of_all
from eom.multibody.scalars import add, is_zero, mul, reciprocal, sub
from eom.multibody.skeleton import Skeleton, skeleton
from eom.multibody.values import is_number
from eom.system import TIME, Definition, Expr, Quantity, Singularity, System


@dataclass(frozen=True)
class Variables:
    """Coordinates, speeds, their prescribed accelerations and generalised forces, as scalars."""

    q: list[Any]
    u: list[Any]
    prescribed: dict[int, Any]
    tau: list[Any]
    binding: Binding


def derive(
    tree: Tree,
    outputs: Iterable[str | Reaction] = (),
    *,
    invariants: bool = True,
    start: Mapping[str, float] | None = None,
    independent: Sequence[str] | None = None,
    multipliers: bool | None = None,
) -> System:
    """Return the equations of motion of a tree: states are coordinates, then speeds.

    ``outputs``: rows of `OUTPUTS`, and reactions. ``invariants``: whether constants of this motion are
    given too.

    Under constraints, speeds that depend on others are eliminated where all constraints are between
    speeds, where a joint alone moves no mass, and where ``independent`` names the speeds to stay;
    elsewhere, or with ``multipliers``, all speeds are states and multipliers are solved for.
    ``start``: numbers by name of parameters and coordinates at which constraints are tested for
    dependence, random ones where left out. What is left of each constraint is an invariant that
    integration maintains.

    Raises `InputError` for an unknown output, repeated names, joints that accelerate no inertia, and
    constraints that contradict each other or leave no motion.
    """
    wanted = tuple(outputs)
    for name in wanted:
        if isinstance(name, Reaction):
            joint_named(tree, name.joint, f"tree {tree.name!r}: reaction")
        elif name not in OUTPUTS:
            raise unknown_name("output", name, OUTPUTS, f"tree {tree.name!r}")
    work = Naming(q.name for q in named_of(tree))
    bones = skeleton(tree, work.atom, work)
    treated = plan(tree, start, independent, multipliers)
    variables = variables_of(tree, bones, treated, work)
    rates = coordinate_rates(bones, variables.q, variables.u, work)
    accelerations = _accelerations(bones, variables, work)
    free = [j.motion is None for j in tree.ordered]
    left_out = {*bones.driven, *(treated.dependent or ())}
    kept = [
        *_of_free(rates, [len(j.coordinates) for j in tree.ordered], free),
        *(x for k, x in enumerate(accelerations) if k not in left_out),
    ]
    told = _Told(tree, bones, variables, work, accelerations, _asked(tree, wanted))
    named = [d for w in wanted for d in _told(told, w)]
    constant = _invariants(told) if invariants else []
    return _system(told, [plain(r) for r in kept], named, constant)


def _accelerations(bones: Skeleton, given: Variables, work: Naming) -> list[Any]:
    if given.binding.tree.constraints:
        return given.binding.accelerations(given.tau, given.prescribed)
    return forward_dynamics(bones, given.q, given.u, given.tau, work, given.prescribed)


def _asked(tree: Tree, wanted: Iterable[str | Reaction]) -> frozenset[str]:
    """Return the joints of which reactions are wanted."""
    every = of_all(tree) if "reactions" in wanted else ()
    return frozenset(w.joint for w in (*wanted, *every) if isinstance(w, Reaction))


def _of_free(values: Sequence[Any], sizes: Sequence[int], free: Sequence[bool]) -> list[Any]:
    """Return the values of joints whose motion is not prescribed."""
    found: list[Any] = []
    start = 0
    for size, mine in zip(sizes, free, strict=True):
        found += values[start : start + size] if mine else []
        start += size
    return found


def states_of(tree: Tree, dependent: Iterable[int] = ()) -> tuple[Quantity, ...]:
    """Return coordinates and speeds that are free, without those that follow."""
    free = [j for j in tree.ordered if j.motion is None]
    speeds = [s for j in tree.ordered for s in j.speeds]
    followed = {speeds[k] for k in dependent}
    kept = (s for j in free for s in j.speeds if s not in followed)
    return (*(c for j in free for c in j.coordinates), *kept)


def inputs_of(tree: Tree) -> tuple[Quantity, ...]:
    """Return motors and given inputs."""
    return (*(m for j in tree.ordered for m in j.motors if j.motion is None), *tree.inputs)


def named_of(tree: Tree) -> list[Quantity]:
    """Return everything that has a name before the derivation."""
    symbols = [Quantity(s) for s in symbols_of(tree)]
    driven = [q for j in tree.ordered if j.motion is not None for q in (*j.coordinates, *j.speeds)]
    return [*states_of(tree), *inputs_of(tree), *driven, *symbols, Quantity(TIME)]


def symbols_of(tree: Tree) -> list[Expr]:
    """Return the free symbols of a description, by name."""
    return _symbols_in([*_values(tree), *(x for c in tree.constraints for x in c.values)])


def _symbols_in(values: Iterable[Any]) -> list[Expr]:
    found: set[Expr] = set()
    for given in values:
        if not is_number(given):
            found |= given.free_symbols
    return sorted(found, key=lambda s: str(s.name))


def _values(tree: Tree) -> Iterable[Any]:
    yield from tree.gravity
    for b in tree.bodies:
        yield from (b.mass, *b.centre, *(x for row in b.central_inertia for x in row))
    for j in tree.joints:
        yield from (*(x for a in j.axes for x in a), j.pitch)
        for place in (j.on_parent, j.on_child):
            yield from (*place.position, *(x for row in place.rotation for x in row))
        yield from (*j.stiffness, *j.rest, *j.damping, *j.armature, *j.force)
        if j.motion is not None:
            yield from (*j.motion.position, *j.motion.rate, *j.motion.acceleration)
    for load in tree.loads:
        yield from (*load.force, *load.torque, *load.point)


def parameters_of(tree: Tree) -> tuple[Quantity, ...]:
    """Return the symbols that are nothing else, as they are described."""
    moving = [q for j in tree.ordered for q in (*j.coordinates, *j.speeds)]
    other = {q.symbol for q in (*moving, *inputs_of(tree))} | {TIME}
    described = {p.symbol: p for p in tree.parameters}
    return tuple(described.get(s, Quantity(s)) for s in symbols_of(tree) if s not in other)


def variables_of(tree: Tree, bones: Skeleton, treated: Plan, work: Naming) -> Variables:
    """Return coordinates, speeds (those that follow from others among them) and applied forces."""
    q: list[Any] = []
    u: list[Any] = []
    prescribed: dict[int, Any] = {}
    for joint in tree.ordered:
        if joint.motion is None:
            q += [work.atom(c.symbol) for c in joint.coordinates]
            u += [work.atom(s.symbol) for s in joint.speeds]
        else:
            for k, given in enumerate(joint.motion.acceleration):
                prescribed[len(u) + k] = work.atom(given)
            q += _prescribed(work, joint.coordinates, joint.motion.position)
            u += _prescribed(work, joint.speeds, joint.motion.rate)
    binding = bind(treated, tree, bones, q, u, work)
    return Variables(q, binding.u, prescribed, _applied(tree, q, binding.u, work), binding)


def _applied(tree: Tree, q: Sequence[Any], u: Sequence[Any], work: Naming) -> list[Any]:
    tau: list[Any] = []
    first = 0
    for joint in tree.ordered:
        own = slice(first, first + len(joint.coordinates))
        tau += _forces(joint, q[own], u[len(tau) : len(tau) + len(joint.speeds)], work)
        first = own.stop
    return tau


def _prescribed(work: Naming, quantities: Sequence[Quantity], given: Sequence[Any]) -> list[Any]:
    """Return numbers as they are, expressions under the names of the quantities."""
    pairs = zip(quantities, given, strict=True)
    return [v if is_number(v) else work.define(q, work.atom(v)) for q, v in pairs]


def _forces(joint: Joint, q: Sequence[Any], u: Sequence[Any], work: Naming) -> list[Any]:
    """Return the generalised forces of a joint: motor, applied force, damper, spring."""
    motors = [work.atom(m.symbol) for m in joint.motors if joint.motion is None] or [0] * len(u)
    found = []
    for k, coordinate in enumerate(joint.row.paired(joint.attitude)):
        force = add(motors[k], work.atom(joint.force[k]))
        force = sub(force, mul(work.atom(joint.damping[k]), u[k]))
        if coordinate is not None:
            stretch = sub(q[coordinate], work.atom(joint.rest[k]))
            force = sub(force, mul(work.atom(joint.stiffness[k]), stretch))
        suffix = joint.row.speeds(joint.attitude)[k].suffix
        found.append(work.keep("tau", joint.name, suffix, force))
    return found


def _system(
    told: _Told, rates: list[Expr], outputs: list[Definition], invariants: list[Definition]
) -> System:
    tree, work, binding = told.tree, told.work, told.variables.binding
    found = _singularities(tree)
    outputs = [*outputs, *binding.followers()]
    held = binding.invariants()
    invariants = [*held, *invariants]
    if tree.constraints:
        found = (*found, *binding.singularities())
    results = [
        *rates,
        *(d.expression for d in (*outputs, *invariants)),
        *(s.expression for s in found),
    ]
    return System(
        name=tree.name,
        states=states_of(tree, binding.plan.dependent or ()),
        rates=tuple(rates),
        parameters=parameters_of(tree),
        inputs=inputs_of(tree),
        definitions=used(work.definitions, results),
        outputs=tuple(outputs),
        invariants=tuple(invariants),
        singularities=found,
        assumptions=binding.assumptions(held),
        maintained=tuple(d.name for d in held),
    )


def _singularities(tree: Tree) -> tuple[Singularity, ...]:
    """Return where angles of sequences fail."""
    found: list[Singularity] = []
    for joint in tree.ordered:
        if joint.row.attitude and joint.attitude != QUATERNION and joint.motion is None:
            angles = [c.symbol for c in joint.coordinates[-3:]]
            found += rotation_sequence(joint.attitude, angles).singularities
    return tuple(found)


class _Told:
    """What outputs are made of, each made when it is first asked for."""

    def __init__(
        self,
        tree: Tree,
        bones: Skeleton,
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


def _energy(told: _Told) -> list[Definition]:
    return [_definition("energy", "J", "kinetic and potential energy",
                        add(told.kinetic(), told.potential()))]  # fmt: skip


def _energies(told: _Told) -> list[Definition]:
    kinetic, potential = told.kinetic(), told.potential()
    return [
        _definition("kinetic_energy", "J", "kinetic energy", kinetic),
        _definition("potential_energy", "J", "potential energy of gravity and springs", potential),
    ]


def _momentum(told: _Told) -> list[Definition]:
    L, p = momentum(told.flow)
    return [
        *_vector("p", "kg m/s", "momentum", p),
        *_vector("L", "kg m^2/s", "angular momentum about the ground's origin", L),
    ]


def _centre(told: _Told) -> list[Definition]:
    whole = mass(told.flow)
    inverse = told.work.keep("inverse", told.tree.name, "", reciprocal(whole))
    return _vector(
        "centre", "m", "centre of mass", [mul(inverse, x) for x in first_moments(told.flow)]
    )


def _constraint_forces(told: _Told) -> list[Definition]:
    return told.variables.binding.forces() if told.tree.constraints else []


def _reactions(told: _Told) -> list[Definition]:
    return [d for r in of_all(told.tree) for d in reactions.definitions(told.wrenches, r)]


def _drives(told: _Told) -> list[Definition]:
    return reactions.drives(told.wrenches, told.variables.tau)


OUTPUTS: dict[str, Callable[[_Told], list[Definition]]] = {
    "energies": _energies,
    "momentum": _momentum,
    "centre_of_mass": _centre,
    "constraint_forces": _constraint_forces,
    "reactions": _reactions,
    "drives": _drives,
}
"""What can be asked for beside the motion, and single reactions."""


def _told(told: _Told, wanted: str | Reaction) -> list[Definition]:
    if isinstance(wanted, Reaction):
        return reactions.definitions(told.wrenches, wanted)
    return OUTPUTS[wanted](told)


def _invariants(told: _Told) -> list[Definition]:
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
    held = any(
        j.kind != "free" or j.motor or not all(map(is_zero, (*j.damping, *j.force, *j.armature)))
        for j in roots
    )
    alone = not (held or len(roots) > 1 or tree.loads) and inner(tree)
    return alone and all(map(is_zero, tree.gravity))


def conservative(tree: Tree) -> bool:
    """Tell whether nothing but gravity and springs acts, so that the energy is constant."""
    joints = all(
        j.motion is None and not j.motor and all(map(is_zero, (*j.damping, *j.force)))
        for j in tree.joints
    )
    moving = {q.symbol for j in tree.joints for q in (*j.coordinates, *j.speeds)}
    given = set(_symbols_in(_values(tree)))
    fixed = not ({TIME, *moving, *(i.symbol for i in tree.inputs)} & given)
    return joints and fixed and not tree.loads and lossless(tree)
