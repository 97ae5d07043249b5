"""A tree of bodies as a `System`, by articulated bodies with every intermediate named."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from eom.errors import typed
from eom.multibody.algebra.lazy_sums import Naming, plain, used
from eom.multibody.algebra.scalars import add, is_zero, mul, sub
from eom.multibody.algebra.spatial import cross, forward, plus
from eom.multibody.algebra.values import is_number
from eom.multibody.constrained.constraint_plan import Plan, bind, plan
from eom.multibody.model.model import Joint, Tree
from eom.multibody.model.names import (
    assumptions,
    attitudes_of,
    inputs_of,
    named_of,
    parameters_of,
    singularities_of,
    states_of,
)
from eom.multibody.recursion.articulated import forward_dynamics
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.motion import coordinate_rates, motion, places
from eom.multibody.recursion.quantities import Point
from eom.multibody.recursion.springs import applied
from eom.multibody.system.output_quantities import Told, Variables, check, invariants_of, told_of
from eom.multibody.system.reactions import Reaction, of_all
from eom.quantities import Definition, Quantity
from eom.system import BodyAttitude, Expr, System


@typed
def derive(
    tree: Tree,
    outputs: Iterable[str | Reaction | Point] = (),
    *,
    invariants: bool = True,
    start: Mapping[str, float] | None = None,
    independent: Sequence[str] | None = None,
    multipliers: bool | None = None,
) -> System:
    """Return the equations of motion of a tree: states are coordinates, then speeds.

    ``outputs``: rows of `OUTPUTS`, reactions and points. ``invariants``: whether constants of this
    motion are given too.

    Under constraints, speeds that depend on others are eliminated where all constraints are between
    speeds, where a joint alone moves no mass, and where ``independent`` names the speeds to stay;
    elsewhere, or with ``multipliers``, all speeds are states and multipliers are solved for.
    ``start``: numbers by name of parameters and coordinates at which constraints are tested for
    dependence, random ones where left out. What is left of each constraint is an invariant that
    integration maintains.

    SI units, angles in radians; frames and signs are those of `Joint`. Quaternions are scalar first.
    Raises `InputError` for an unknown output, repeated names, joints that accelerate no inertia, and
    constraints that contradict each other or leave no motion.
    Source: Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 7, the articulated-body algorithm.

    >>> from eom.multibody import Body, Joint
    >>> bob = Body("bob", mass=2, centre=(0, 0, -1))
    >>> hinge = Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> system = derive(Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -10)))
    >>> system.state_names, [system.expand(rate) for rate in system.rates]
    (('q_hinge', 'u_hinge'), [u_hinge, -10*sin(q_hinge)])
    """
    wanted = tuple(outputs)
    for one in wanted:
        check(tree, one)
    work = Naming(q.name for q in named_of(tree))
    bones = lumped_tree(tree, work.atom, work, [w.body for w in wanted if isinstance(w, Point)])
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
    kept += _of_rotors(tree, bones, variables, work)
    told = Told(tree, bones, variables, work, accelerations, _asked(tree, wanted))
    named = [d for w in wanted for d in told_of(told, w)]
    constant = invariants_of(told) if invariants else []
    return _system(told, [plain(r) for r in kept], named, constant)


def _accelerations(bones: LumpedTree, given: Variables, work: Naming) -> list[Any]:
    if given.binding.tree.constraints:
        return given.binding.accelerations(given.tau, given.prescribed)
    return forward_dynamics(bones, given.q, given.u, given.tau, work, given.prescribed)


def _asked(tree: Tree, wanted: Iterable[str | Reaction | Point]) -> frozenset[str]:
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


def _of_rotors(tree: Tree, bones: LumpedTree, variables: Variables, work: Naming) -> list[Any]:
    """Return the rates of the rotors' states."""
    if not tree.rotors:
        return []
    moved = motion(places(bones, variables.q, work), variables.u, work)
    found = []
    for rotor, (part, spin) in zip(tree.rotors, bones.rotors, strict=True):
        omega = moved[part].omega
        found += [spin.relative(omega)] if rotor.angle else []
        found += [spin.rate(omega)] if spin.free else []
    return found


def variables_of(tree: Tree, bones: LumpedTree, treated: Plan, work: Naming) -> Variables:
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
    told: Told, rates: list[Expr], outputs: list[Definition], invariants: list[Definition]
) -> System:
    tree, work, binding = told.tree, told.work, told.variables.binding
    found = singularities_of(tree)
    outputs = [*outputs, *binding.followers()]
    held = binding.invariants()
    invariants = [*held, *invariants]
    if tree.constraints:
        found = (*found, *binding.singularities())
    states = states_of(tree, binding.plan.dependent or ())
    attitudes = tuple(_with_inertia(a, told) for a in attitudes_of(tree, states))
    results = [
        *rates,
        *(d.expression for d in (*outputs, *invariants)),
        *(s.expression for s in found),
        *(e for a in attitudes for e in a.expressions),
    ]
    return System(
        name=tree.name,
        states=states,
        rates=tuple(rates),
        parameters=parameters_of(tree),
        inputs=inputs_of(tree),
        definitions=used(work.definitions, results),
        outputs=tuple(outputs),
        invariants=tuple(invariants),
        singularities=found,
        assumptions=(*assumptions(tree), *binding.assumptions(held)),
        maintained=tuple(d.name for d in held),
        attitudes=attitudes,
    )


def _with_inertia(stated: BodyAttitude, told: Told) -> BodyAttitude:
    """Return the attitude with inertia and torque about the joint, of a body that alone turns about it."""
    part, given, work = told.bones.parts[0], told.variables, told.work
    alone = len(told.bones.parts) == 1 and len(given.u) == 3 and not told.tree.constraints
    if not alone or part.spins or part.rotors or not all(map(is_zero, part.armature)):
        return stated
    placed = places(told.bones, given.q, work)
    load, *_ = applied(told.bones, placed, motion(placed, given.u, work), work)
    weight = cross(part.first_moment, forward(placed[0].rotation, told.bones.gravity))
    torque = plus(plus(list(given.tau), load.angular), weight)
    x, y, z = (plain(t) for t in torque)
    inertia = sp.Matrix([[plain(e) for e in row] for row in part.inertia.I])
    return replace(stated, inertia=inertia, torque=(x, y, z))
