"""A tree of bodies as a `System`, by articulated bodies with every intermediate named."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.errors import unknown_name
from eom.kinematics import rotation_sequence
from eom.multibody.articulated import forward_dynamics
from eom.multibody.joints import QUATERNION
from eom.multibody.light import Naming, plain, used
from eom.multibody.links import end, twice_potential
from eom.multibody.model import Joint, Tree
from eom.multibody.motion import coordinate_rates, motion, places
from eom.multibody.points import QUANTITIES, Point, point
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
from eom.multibody.scalars import add, is_zero, mul, sub
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


def derive(tree: Tree, outputs: Iterable[str | Point] = (), *, invariants: bool = True) -> System:
    """Return the equations of motion of a tree: states are coordinates, then speeds.

    ``outputs``: rows of `OUTPUTS`, and points. ``invariants``: whether constants of this motion are
    given too.
    Raises `InputError` for an unknown output, repeated names, and joints that accelerate no inertia.
    """
    wanted = tuple(outputs)
    for name in wanted:
        if isinstance(name, str) and name not in OUTPUTS:
            raise unknown_name("output", name, OUTPUTS, f"tree {tree.name!r}")
    work = Naming(q.name for q in _named(tree))
    told_of = [w.body for w in wanted if isinstance(w, Point)]
    bones = skeleton(tree, work.atom, work, told_of)
    variables = _variables(tree, work)
    q, u = variables.q, variables.u
    rates = coordinate_rates(bones, q, u, work)
    accelerations = forward_dynamics(bones, q, u, variables.tau, work, variables.prescribed)
    free = [j.motion is None for j in tree.ordered]
    kept = [
        *_of_free(rates, [len(j.coordinates) for j in tree.ordered], free),
        *_of_free(accelerations, [len(j.speeds) for j in tree.ordered], free),
    ]
    kept += _of_rotors(tree, bones, variables, work)
    told = _Told(tree, bones, variables, work, accelerations)
    named = [
        d for w in wanted for d in (OUTPUTS[w](told) if isinstance(w, str) else _point(told, w))
    ]
    constant = _invariants(told) if invariants else []
    return _system(tree, [plain(r) for r in kept], work, named, constant)


def _of_free(values: Sequence[Any], sizes: Sequence[int], free: Sequence[bool]) -> list[Any]:
    """Return the values of joints whose motion is not prescribed."""
    found: list[Any] = []
    start = 0
    for size, mine in zip(sizes, free, strict=True):
        found += values[start : start + size] if mine else []
        start += size
    return found


def _of_rotors(tree: Tree, bones: Skeleton, variables: Variables, work: Naming) -> list[Any]:
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


def _states(tree: Tree) -> tuple[Quantity, ...]:
    free = [j for j in tree.ordered if j.motion is None]
    moving = (*(c for j in free for c in j.coordinates), *(s for j in free for s in j.speeds))
    return (*moving, *(s for r in tree.rotors for s in r.states))


def _inputs(tree: Tree) -> tuple[Quantity, ...]:
    motors = [m for j in tree.ordered for m in j.motors if j.motion is None]
    return (*motors, *(m for r in tree.rotors for m in r.motors), *tree.inputs)


def _named(tree: Tree) -> list[Quantity]:
    """Return everything that has a name before the derivation."""
    symbols = [Quantity(s) for s in _symbols(tree)]
    driven = [q for j in tree.ordered if j.motion is not None for q in (*j.coordinates, *j.speeds)]
    return [*_states(tree), *_inputs(tree), *driven, *symbols, Quantity(TIME)]


def _symbols(tree: Tree) -> list[Expr]:
    """Return the free symbols of a description, by name."""
    found: set[Expr] = set()
    for given in _values(tree):
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
    for spring in tree.springs:
        yield from (*spring.points[0], *spring.points[1])
        yield from (spring.stiffness, spring.length, spring.damping)
    for rotor in tree.rotors:
        yield from (*rotor.axis, rotor.inertia, rotor.damping, rotor.torque)
        yield from () if rotor.speed is None else (rotor.speed, rotor.acceleration)


def _parameters(tree: Tree) -> tuple[Quantity, ...]:
    """Return the symbols that are nothing else, as they are described."""
    moving = [q for j in tree.ordered for q in (*j.coordinates, *j.speeds)]
    moving += [s for r in tree.rotors for s in r.states]
    other = {q.symbol for q in (*moving, *_inputs(tree))} | {TIME}
    described = {p.symbol: p for p in tree.parameters}
    return tuple(described.get(s, Quantity(s)) for s in _symbols(tree) if s not in other)


def _variables(tree: Tree, work: Naming) -> Variables:
    found = Variables([], [], {}, [])
    for joint in tree.ordered:
        if joint.motion is None:
            q = [work.atom(c.symbol) for c in joint.coordinates]
            u = [work.atom(s.symbol) for s in joint.speeds]
        else:
            q = _prescribed(work, joint.coordinates, joint.motion.position)
            u = _prescribed(work, joint.speeds, joint.motion.rate)
            for k, given in enumerate(joint.motion.acceleration):
                found.prescribed[len(found.u) + k] = work.atom(given)
        found.tau.extend(_forces(joint, q, u, work))
        found.q.extend(q)
        found.u.extend(u)
    return found


def _prescribed(work: Naming, quantities: Sequence[Quantity], given: Sequence[Any]) -> list[Any]:
    """Return numbers as they are, expressions under the names of the quantities."""
    pairs = zip(quantities, given, strict=True)
    return [v if is_number(v) else work.define(q, work.atom(v)) for q, v in pairs]


def _forces(joint: Joint, q: Sequence[Any], u: Sequence[Any], work: Naming) -> list[Any]:
    """Return the generalised forces of a joint: motor, applied force, damper, spring."""
    motors = [work.atom(m.symbol) for m in joint.motors] or [0] * len(u)
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
    tree: Tree,
    rates: list[Expr],
    work: Naming,
    outputs: list[Definition],
    invariants: list[Definition],
) -> System:
    found = _singularities(tree)
    results = [*rates, *(d.expression for d in (*outputs, *invariants))]
    return System(
        name=tree.name,
        states=_states(tree),
        rates=tuple(rates),
        parameters=_parameters(tree),
        inputs=_inputs(tree),
        definitions=used(work.definitions, results),
        outputs=tuple(outputs),
        invariants=tuple(invariants),
        singularities=found,
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
        accelerations: Sequence[Any] = (),
    ) -> None:
        self.tree, self.bones, self.variables, self.work = tree, bones, variables, work
        self.accelerations = accelerations
        self._flow: Flow | None = None

    @property
    def flow(self) -> Flow:
        """The motion of all parts."""
        if self._flow is None:
            self._flow = flow(self.bones, self.variables.q, self.variables.u, self.work)
        return self._flow

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
    inverse = told.work.keep("inverse", told.tree.name, "", 1 / whole)
    return _vector(
        "centre", "m", "centre of mass", [mul(inverse, x) for x in first_moments(told.flow)]
    )


def _point(told: _Told, given: Point) -> list[Definition]:
    """Return what is told of a point."""
    accelerated = (told.variables.u, told.accelerations)
    found = point(given, told.bones, told.flow, accelerated, told.work.atom, told.work)
    rows = [(QUANTITIES[name], name, value) for name, value in found.items()]
    return [
        d
        for (letter, unit), name, value in rows
        for d in _vector(f"{letter}_{given.name}", unit, f"{name} of {given.name}", value)
    ]


OUTPUTS: dict[str, Callable[[_Told], list[Definition]]] = {
    "energies": _energies,
    "momentum": _momentum,
    "centre_of_mass": _centre,
}
"""What can be asked for beside the motion."""


def _invariants(told: _Told) -> list[Definition]:
    """Return norms of quaternions; energy if nothing drives or brakes; momentum if nothing holds."""
    tree = told.tree
    found = []
    for joint in tree.ordered:
        if joint.row.attitude and joint.attitude == QUATERNION and joint.motion is None:
            square = sp.Add(*(c.symbol**2 for c in joint.coordinates[-4:]))
            meaning = f"norm of the quaternion of {joint.name}"
            symbol = sp.Symbol(f"norm_{joint.name}", real=True)
            found.append(Definition(Quantity(symbol, "1", meaning), sp.sqrt(square)))
    if conservative(tree):
        found += _energy(told)
        roots = [p for p in told.bones.parts if p.parent < 0]
        held = any(part < 0 for link in told.bones.links for part in link.parts)
        floats = len(roots) == 1 and roots[0].kind.name == "free" and not held
        if floats and all(map(is_zero, tree.gravity)):
            found += _momentum(told)
    return found


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
    moving = {q.symbol for j in tree.joints for q in (*j.coordinates, *j.speeds)}
    moving |= {s.symbol for r in tree.rotors for s in r.states}
    fixed = not ({TIME, *moving, *(i.symbol for i in tree.inputs)} & set(_symbols(tree)))
    coasting = coasting and all(is_zero(s.damping) for s in tree.springs)
    return joints and coasting and fixed and not tree.loads
