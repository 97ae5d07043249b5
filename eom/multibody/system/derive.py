"""A tree of bodies as a `System`, by articulated bodies with every intermediate named.

What is computed of a motion beside its rates: outputs, points, reactions, constants.
Functions of a tree as systems to compile: mass matrix, dynamics, Jacobians, centre of mass, energies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError, typed, unknown_name
from eom.limits import seldom_collected
from eom.multibody.algebra.lazy_sums import Naming, plain, used
from eom.multibody.algebra.scalars import add, is_zero, mul, reciprocal, sub
from eom.multibody.algebra.spatial import cross, forward, plus
from eom.multibody.algebra.values import is_number, triple
from eom.multibody.constrained.constraint_plan import (
    Binding,
    Plan,
    bind,
    constraint_loads,
    inner,
    lossless,
    plan,
)
from eom.multibody.model.bodies import GROUND
from eom.multibody.model.joints import QUATERNION
from eom.multibody.model.model import Tree
from eom.multibody.model.names import (
    assumptions,
    attitudes_of,
    inputs_of,
    named_of,
    parameters_of,
    singularities_of,
    states_of,
    symbols_in,
    values_of,
)
from eom.multibody.recursion import quantities, recursions
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.motion import coordinate_rates, motion, places
from eom.multibody.recursion.quantities import (
    HALF,
    QUANTITIES,
    Flow,
    Point,
    first_moments,
    flow,
    gravity_potential,
    joint_forces,
    kinetic_energy,
    mass,
    momentum,
    point,
)
from eom.multibody.recursion.recursions import applied, end, twice_potential
from eom.multibody.system import reactions
from eom.multibody.system.reactions import Reaction, joint_named, of_all
from eom.multibody.system.vectors import Drawn, Moment
from eom.quantities import TIME, Definition, Quantity
from eom.system import BodyAttitude, Expr, System


@dataclass(frozen=True)
class Variables:
    """Coordinates, speeds, their prescribed accelerations and generalised forces, as scalars."""

    q: list[Any]
    u: list[Any]
    prescribed: dict[int, Any]
    tau: list[Any]
    binding: Binding


class Derived:
    """What outputs are made of, each made when it is first asked for."""

    def __init__(
        self,
        tree: Tree,
        lumped: LumpedTree,
        variables: Variables,
        work: Naming,
        accelerations: Sequence[Any],
        asked: frozenset[str],
    ) -> None:
        self.tree, self.lumped, self.variables, self.work = tree, lumped, variables, work
        self.accelerations, self.asked = accelerations, asked

    @cached_property
    def flow(self) -> Flow:
        """The motion of all parts."""
        return flow(self.lumped, self.variables.q, self.variables.u, self.work)

    @cached_property
    def wrenches(self) -> reactions.Wrenches:
        """What goes through the joints; fixed ones are parts of their own where they are asked for."""
        motion = (self.variables.q, self.variables.u, self.accelerations)
        held = self.variables.binding
        further = constraint_loads(held) if self.tree.constraints else None
        return reactions.Wrenches(self.tree, self.work.atom, self.work, motion, self.asked, further)

    @cached_property
    def moment(self) -> Moment:
        """The tree with all that acts on it."""
        given, held = self.variables, self.variables.binding
        multipliers = (
            dict(zip(held.held.names, held.multipliers(), strict=True)) if held.held.names else {}
        )
        return Moment(self.tree, held.arithmetic, given.q, given.u, given.tau, multipliers)

    def potential(self) -> Any:
        """Return the potential energy of gravity and springs."""
        found = gravity_potential(self.lumped, self.flow)
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
        for link in self.lumped.links:
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


def _energy(derived: Derived) -> list[Definition]:
    return [_definition("energy", "J", "kinetic and potential energy",
                        add(derived.kinetic(), derived.potential()))]  # fmt: skip


def _energies(derived: Derived) -> list[Definition]:
    kinetic, potential = derived.kinetic(), derived.potential()
    return [
        _definition("kinetic_energy", "J", "kinetic energy", kinetic),
        _definition("potential_energy", "J", "potential energy of gravity and springs", potential),
    ]


def _momentum(derived: Derived) -> list[Definition]:
    L, p = momentum(derived.flow)
    return [
        *_vector("p", "kg m/s", "momentum", p),
        *_vector("L", "kg m^2/s", "angular momentum about the ground's origin", L),
    ]


def _centre(derived: Derived) -> list[Definition]:
    inverse = derived.work.keep("inverse", derived.tree.name, "", reciprocal(mass(derived.flow)))
    return _vector(
        "centre", "m", "centre of mass", [mul(inverse, x) for x in first_moments(derived.flow)]
    )


def _constraint_forces(derived: Derived) -> list[Definition]:
    return derived.variables.binding.forces() if derived.tree.constraints else []


def _reactions(derived: Derived) -> list[Definition]:
    return [d for r in of_all(derived.tree) for d in reactions.definitions(derived.wrenches, r)]


def _drives(derived: Derived) -> list[Definition]:
    return reactions.drives(derived.wrenches, derived.variables.tau)


def _point(derived: Derived, given: Point) -> list[Definition]:
    """Return the outputs of a point."""
    moved = (derived.variables.u, derived.accelerations)
    found = point(given, derived.lumped, derived.flow, moved, derived.work.atom, derived.work)
    rows = [(QUANTITIES[name], name, value) for name, value in found.items()]
    return [
        d
        for (letter, unit), name, value in rows
        for d in _vector(f"{letter}_{given.name}", unit, f"{name} of {given.name}", value)
    ]


OUTPUTS: dict[str, Callable[[Derived], list[Definition]]] = {
    "energies": _energies,
    "momentum": _momentum,
    "centre_of_mass": _centre,
    "constraint_forces": _constraint_forces,
    "reactions": _reactions,
    "drives": _drives,
}
"""What can be asked for beside the motion, and single reactions."""


Wanted = str | Reaction | Point | Drawn
"""What can be asked for: rows of `OUTPUTS`, a reaction, a point, all vectors to draw."""


def check(tree: Tree, wanted: Wanted) -> None:
    """Raise `InputError` for outputs that are not known."""
    if isinstance(wanted, Reaction):
        joint_named(tree, wanted.joint, f"tree {tree.name!r}: reaction")
    elif not isinstance(wanted, Point | Drawn) and wanted not in OUTPUTS:
        raise unknown_name("output", wanted, OUTPUTS, f"tree {tree.name!r}")


def output_of(derived: Derived, wanted: Wanted) -> list[Definition]:
    """Return the definitions of an output, a reaction, a point or all vectors."""
    if isinstance(wanted, Reaction):
        return reactions.definitions(derived.wrenches, wanted)
    if isinstance(wanted, Drawn):
        return list(wanted.definitions(derived.tree, derived.moment))
    return _point(derived, wanted) if isinstance(wanted, Point) else OUTPUTS[wanted](derived)


def invariants_of(derived: Derived) -> list[Definition]:
    """Return norms of quaternions; energy if nothing drives or brakes; momentum if it floats alone."""
    tree = derived.tree
    found = [*derived.variables.binding.sums()]
    for joint in tree.ordered:
        if joint.row.attitude and joint.attitude == QUATERNION and joint.motion is None:
            square = sp.Add(*(c.symbol**2 for c in joint.coordinates[-4:]))
            meaning = f"norm of the quaternion of {joint.name}"
            symbol = sp.Symbol(f"norm_{joint.name}", real=True)
            found.append(Definition(Quantity(symbol, "1", meaning), sp.sqrt(square)))
    if conservative(tree):
        found += _energy(derived)
    if afloat(tree):
        found += _momentum(derived)
    return found


def afloat(tree: Tree) -> bool:
    """Return whether nothing acts from outside on a tree of one free root: what joints do is internal."""
    roots = [j for j in tree.joints if j.parent == GROUND]
    held = any(GROUND in s.bodies for s in tree.springs) or any(
        j.kind != "free" or j.motor or not all(map(is_zero, (*j.damping, *j.force, *j.armature)))
        for j in roots
    )
    alone = not (held or len(roots) > 1 or tree.loads or tree.jets) and inner(tree)
    field = (*tree.gravity, *(x for row in tree.gravity_gradient for x in row))
    return alone and all(map(is_zero, field)) and _unchanging(tree)


def _unchanging(tree: Tree) -> bool:
    """Return whether masses and their places in bodies and rotors are free of time, state and inputs."""
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
    """Return whether nothing but gravity and springs acts, so that the energy is constant."""
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
    return joints and coasting and fixed and not (tree.loads or tree.jets) and lossless(tree)


@typed
def derive(
    tree: Tree,
    outputs: Iterable[str | Reaction | Point | Drawn] = (),
    *,
    invariants: bool = True,
    start: Mapping[str, float] | None = None,
    independent: Sequence[str] | None = None,
    multipliers: bool | None = None,
) -> System:
    """Return the equations of motion of a tree: states are coordinates, then speeds.

    Parameters
    ----------
    tree : Tree
        Bodies, joints, what acts on them, and constraints.
    outputs : iterable, optional
        Rows of `OUTPUTS`, reactions, points, and all vectors that are to be drawn.
    invariants : bool, default True
        Whether constants of this motion are given too.
    start : mapping, optional
        Numbers by name of parameters and coordinates at which constraints are tested for dependence,
        random ones where left out.
    independent : sequence of str, optional
        Under constraints, the speeds to stay; the others are eliminated.
    multipliers : bool, optional
        Under constraints, whether all speeds are states and multipliers are solved for. Unless given,
        speeds are eliminated where all constraints are between speeds, where a joint alone moves no
        mass, and where ``independent`` is given.

    Returns
    -------
    System
        What is left of each constraint is an invariant that integration maintains.

    Raises
    ------
    InputError
        For an unknown output, repeated names, joints that accelerate no inertia, and constraints that
        contradict each other or leave no motion.

    Notes
    -----
    SI units, angles in radians; frames and signs are those of `Joint`. Quaternions are scalar first.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 7, the articulated-body algorithm.

    Examples
    --------
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
    with seldom_collected():
        return _derived(tree, wanted, invariants, (start, independent, multipliers))


def _derived(
    tree: Tree, wanted: Sequence[Wanted], invariants: bool, treatment: tuple[Any, Any, Any]
) -> System:
    """Return the equations; ``treatment``: how that of constraints is chosen, see `plan`."""
    work = Naming(q.name for q in named_of(tree))
    lumped = lumped_tree(tree, work.atom, work, [w.body for w in wanted if isinstance(w, Point)])
    treated = plan(tree, *treatment)
    variables = variables_of(tree, lumped, treated, work)
    rates = coordinate_rates(lumped, variables.q, variables.u, work)
    accelerations = _accelerations(lumped, variables, work)
    free = [j.motion is None for j in tree.ordered]
    left_out = {*lumped.driven, *(treated.dependent or ())}
    kept = [
        *_of_free(rates, [len(j.coordinates) for j in tree.ordered], free),
        *(x for k, x in enumerate(accelerations) if k not in left_out),
    ]
    kept += _of_rotors(tree, lumped, variables, work)
    derived = Derived(tree, lumped, variables, work, accelerations, _asked(tree, wanted))
    named = [d for w in wanted for d in output_of(derived, w)]
    constant = invariants_of(derived) if invariants else []
    return _system(derived, [plain(r) for r in kept], named, constant)


def _accelerations(lumped: LumpedTree, given: Variables, work: Naming) -> list[Any]:
    if given.binding.tree.constraints:
        return given.binding.accelerations(given.tau, given.prescribed)
    forward = recursions.forward_dynamics
    return forward(lumped, given.q, given.u, given.tau, work, given.prescribed)


def _asked(tree: Tree, wanted: Iterable[Wanted]) -> frozenset[str]:
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


def _of_rotors(tree: Tree, lumped: LumpedTree, variables: Variables, work: Naming) -> list[Any]:
    """Return the rates of the rotors' states."""
    if not tree.rotors:
        return []
    moved = motion(places(lumped, variables.q, work), variables.u, work)
    found = []
    for rotor, (part, spin) in zip(tree.rotors, lumped.rotors, strict=True):
        omega = moved[part].omega
        found += [spin.relative(omega)] if rotor.angle else []
        found += [spin.rate(omega)] if spin.free else []
    return found


def variables_of(tree: Tree, lumped: LumpedTree, treated: Plan, work: Naming) -> Variables:
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
    binding = bind(treated, tree, lumped, q, u, work)
    return Variables(q, binding.u, prescribed, _applied(tree, q, binding.u, work), binding)


def _applied(tree: Tree, q: Sequence[Any], u: Sequence[Any], work: Naming) -> list[Any]:
    tau: list[Any] = []
    first = 0
    for joint in tree.ordered:
        own = slice(first, first + len(joint.coordinates))
        speeds = u[len(tau) : len(tau) + len(joint.speeds)]
        tau += joint_forces(joint, q[own], speeds, work.atom, work)
        first = own.stop
    return tau


def _prescribed(work: Naming, quantities: Sequence[Quantity], given: Sequence[Any]) -> list[Any]:
    """Return numbers as they are, expressions under the names of the quantities."""
    pairs = zip(quantities, given, strict=True)
    return [v if is_number(v) else work.define(q, work.atom(v)) for q, v in pairs]


def _system(
    derived: Derived, rates: list[Expr], outputs: list[Definition], invariants: list[Definition]
) -> System:
    tree, work, binding = derived.tree, derived.work, derived.variables.binding
    found = singularities_of(tree)
    outputs = [*outputs, *binding.followers()]
    held = binding.invariants()
    invariants = [*held, *invariants]
    if tree.constraints:
        found = (*found, *binding.singularities())
    states = states_of(tree, binding.plan.dependent or ())
    attitudes = tuple(_with_inertia(a, derived) for a in attitudes_of(tree, states))
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
        numbers=tree.numbers,
    )


def _with_inertia(stated: BodyAttitude, derived: Derived) -> BodyAttitude:
    """Return the attitude with inertia and torque about the joint, of a body that alone turns about it."""
    part, given, work = derived.lumped.parts[0], derived.variables, derived.work
    alone = len(derived.lumped.parts) == 1 and len(given.u) == 3 and not derived.tree.constraints
    more = part.spins or part.rotors or part.streams or not all(map(is_zero, part.armature))
    if more or not alone:
        return stated
    placed = places(derived.lumped, given.q, work)
    load, *_ = applied(derived.lumped, placed, motion(placed, given.u, work), work)
    weight = cross(part.first_moment, forward(placed[0].rotation, derived.lumped.gravity))
    torque = plus(plus(list(given.tau), load.angular), weight)
    x, y, z = (plain(t) for t in torque)
    inertia = sp.Matrix([[plain(e) for e in row] for row in part.inertia.I])
    return replace(stated, inertia=inertia, torque=(x, y, z))


@dataclass(frozen=True)
class TreeFunction:
    """An array over the coordinates and speeds of a tree, as a ``system`` to compile for any target.

    Parameters
    ----------
    system : System
        Its states are those of the tree, its outputs the entries that are not zero by structure, in
        SI units and the frames of `Joint`; its rates move the coordinates at constant speeds, or as
        the inputs say.
    shape : tuple of ints
        Of the array, (n,) or (n, m).
    places : tuple of tuple of ints
        The index of each output.
    symmetric : bool, default False
        Whether an output stands at its mirror image, too.
    """

    system: System
    shape: tuple[int, ...]
    places: tuple[tuple[int, ...], ...]
    symmetric: bool = False

    def array(self, values: Sequence[Any]) -> list[Any]:
        """Return the array as nested lists: ``values`` of the outputs in their order, others 0.

        Parameters
        ----------
        values : sequence
            Of the outputs, in their order.

        Returns
        -------
        list
            Of the function's shape; 0 where no output stands.
        """
        found = dict(zip(self.places, values, strict=True))
        if self.symmetric:
            found |= {place[::-1]: x for place, x in found.items()}
        if len(self.shape) == 1:
            return [found.get((k,), 0) for k in range(self.shape[0])]
        rows, columns = self.shape
        return [[found.get((r, c), 0) for c in range(columns)] for r in range(rows)]

    @property
    def expressions(self) -> Expr:
        """The array as a SymPy matrix, every intermediate put in; of one dimension, a column."""
        return sp.Matrix(
            self.array([self.system.expand(o.expression) for o in self.system.outputs])
        )


class _Function:
    """A tree without motors and constraints, over named scalars, and what a function of it is made of."""

    def __init__(self, tree: Tree, word: str, inputs: str = "") -> None:
        for joint in tree.joints:
            if joint.motion is not None:
                raise InputError(
                    "a function of a tree takes all coordinates and speeds",
                    where=f"joint {joint.name!r}: motion", hint="leave out the prescribed motion",
                )  # fmt: skip
        self.word = word
        self.tree = replace(
            tree, joints=tuple(replace(j, motor=False) for j in tree.joints), constraints=()
        )
        speeds = [s for j in tree.ordered for s in j.speeds]
        self.inputs = tuple(_per_speed(inputs, s) for s in speeds) if inputs else ()
        self.work = Naming(q.name for q in (*named_of(self.tree), *self.inputs))
        self.lumped = lumped_tree(
            self.tree, self.work.atom, self.work, [b.name for b in tree.bodies]
        )
        self.variables = variables_of(self.tree, self.lumped, Plan(), self.work)
        self.given = [self.work.atom(i.symbol) for i in self.inputs]
        self.derived = Derived(self.tree, self.lumped, self.variables, self.work, (), frozenset())

    def made(
        self,
        entries: Mapping[tuple[int, ...], Any],
        shape: tuple[int, ...],
        rates: Sequence[Any] = (),
        *,
        unit: str = "",
        symmetric: bool = False,
    ) -> TreeFunction:
        """Return the function of these entries; ``rates``: of the speeds, which else are constant."""
        tree, given, work = self.tree, self.variables, self.work
        kept = {place: x for place, x in entries.items() if not is_zero(x)}
        names = {place: "_".join([self.word, *(str(k + 1) for k in place)]) for place in kept}
        outputs = tuple(
            _definition(names[place], unit, f"{self.word.replace('_', ' ')}, entry {place}", x)
            for place, x in kept.items()
        )
        moved = [*coordinate_rates(self.lumped, given.q, given.u, work)]
        moved += [*(rates or [0] * len(given.u)), *_of_rotors(tree, self.lumped, given, work)]
        expressions = tuple(plain(x) for x in moved)
        system = System(
            name=f"{tree.name}_{self.word}",
            states=states_of(tree),
            rates=expressions,
            parameters=parameters_of(tree),
            inputs=(*inputs_of(tree), *self.inputs),
            definitions=used(work.definitions, [*expressions, *(o.expression for o in outputs)]),
            outputs=outputs,
            numbers=tree.numbers,
        )
        return TreeFunction(system, shape, tuple(kept), symmetric)


def _per_speed(letter: str, speed: Quantity) -> Quantity:
    if letter == "dot":
        unit, meaning = speed.unit.replace("/s", "/s^2"), f"rate of {speed.name}"
    else:
        unit = "N m" if speed.unit == "rad/s" else "N"
        meaning = f"generalised force at {speed.name}"
    return Quantity(sp.Symbol(f"{letter}_{speed.name}", real=True), unit, meaning)


def _listed(values: Sequence[Any]) -> dict[tuple[int, ...], Any]:
    return {(k,): x for k, x in enumerate(values)}


@typed
def mass_matrix(tree: Tree) -> TreeFunction:
    """Return M(q), symmetric, (n, n), over the speeds of a tree in the order of its joints.

    Parameters
    ----------
    tree : Tree
        Without prescribed motions; constraints are left out.

    Returns
    -------
    TreeFunction
        M(q), symmetric, (n, n), over the speeds of the tree in the order of its joints. Units are
        kg m^2, kg m or kg as the speeds are rad/s or m/s.

    Raises
    ------
    InputError
        For prescribed motions.

    Notes
    -----
    Signs and axes of speeds are those of `Joint`.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), table 6.2, composite bodies.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> bob, hinge = Body("bob", 2, (0, 0, -3)), Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> mass_matrix(Tree("pendulum", (bob,), (hinge,))).expressions
    Matrix([[18]])
    """
    made = _Function(tree, "mass_matrix")
    M = recursions.mass_matrix(made.lumped, made.variables.q, made.work)
    lower: dict[tuple[int, ...], Any] = {
        (r, c): M[r][c] for r in range(len(M)) for c in range(r + 1)
    }
    return made.made(lower, (len(M), len(M)), symmetric=True)


@typed
def inverse_dynamics(tree: Tree) -> TreeFunction:
    """Return the generalised forces (N m or N), (n,), that the rates of all speeds take.

    Parameters
    ----------
    tree : Tree
        Without prescribed motions; constraints are left out.

    Returns
    -------
    TreeFunction
        The generalised forces (N m or N), (n,), that motors must give beside gravity, loads, and
        springs, dampers and forces in the joints. Inputs: ``dot_<speed>`` (rad/s^2 or m/s^2).

    Raises
    ------
    InputError
        For prescribed motions.

    Notes
    -----
    The forces of constraints are part of what is returned. Signs and axes are those of `Joint`.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), table 5.1, recursive Newton-Euler.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> bob, hinge = Body("bob", 2, (0, 0, -3)), Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> inverse_dynamics(Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -10))).expressions
    Matrix([[18*dot_u_hinge + 60*sin(q_hinge)]])
    """
    made = _Function(tree, "inverse_dynamics", "dot")
    given = made.variables
    needed = recursions.inverse_dynamics(made.lumped, given.q, given.u, made.given, made.work)
    forces = [sub(f, held) for f, held in zip(needed, given.tau, strict=True)]
    return made.made(_listed(forces), (len(forces),), made.given)


@typed
def forward_dynamics(tree: Tree) -> TreeFunction:
    """Return the rates of all speeds (rad/s^2 or m/s^2), (n,), under generalised forces at them.

    Parameters
    ----------
    tree : Tree
        Without prescribed motions and constraints.

    Returns
    -------
    TreeFunction
        The rates of all speeds (rad/s^2 or m/s^2), (n,). Inputs: ``tau_<speed>`` (N m or N),
        generalised forces beside gravity, loads, and springs, dampers and forces in the joints.

    Raises
    ------
    InputError
        For prescribed motions, and for constraints, whose forces it lacks (`derive` has them).

    Notes
    -----
    The inverse of `inverse_dynamics`. Signs and axes are those of `Joint`.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), table 7.1, articulated bodies.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> bob, hinge = Body("bob", 2, (0, 0, -3)), Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> forward_dynamics(Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -10))).expressions
    Matrix([[tau_u_hinge/18 - 10*sin(q_hinge)/3]])
    """
    if tree.constraints:
        raise InputError(
            "forward dynamics of a tree with constraints", where=f"tree {tree.name!r}",
            hint="eom.multibody.derive has their forces; or leave the constraints out",
        )  # fmt: skip
    made = _Function(tree, "forward_dynamics", "tau")
    given = made.variables
    tau = [add(t, held) for t, held in zip(made.given, given.tau, strict=True)]
    rates = recursions.forward_dynamics(made.lumped, given.q, given.u, tau, made.work)
    return made.made(_listed(rates), (len(rates),), rates)


@typed
def jacobian(tree: Tree, body: str, point: Sequence[Any] = (0, 0, 0)) -> TreeFunction:
    """Return the angular velocity of a ``body`` and the velocity of a ``point`` by the speeds, (6, n).

    Parameters
    ----------
    tree : Tree
        Without prescribed motions.
    body : str
        A name of one of its bodies.
    point : sequence, optional
        From the body's origin, in its axes (m).

    Returns
    -------
    TreeFunction
        (6, n). Rows 1 to 3: angular velocity (rad/s); 4 to 6: velocity of the point (m/s); both by
        speed, in the ground's axes.

    Raises
    ------
    InputError
        For unknown bodies and prescribed motions.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), section 4.4.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> bob, hinge = Body("bob", 2, (0, 0, -3)), Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> jacobian(Tree("pendulum", (bob,), (hinge,)), "bob", (0, 0, -3)).expressions[:, 0].T
    Matrix([[1, 0, 0, 0, 3*cos(q_hinge), 3*sin(q_hinge)]])
    """
    made = _Function(tree, "jacobian")
    if body not in made.lumped.seats:
        raise unknown_name("body", body, made.lumped.seats, f"tree {tree.name!r}")
    place = [made.work.atom(x) for x in triple(point, "point")]
    parts = quantities.jacobian(made.lumped, made.variables.q, body, place, made.work)
    entries: dict[tuple[int, ...], Any] = {
        (3 * half + row, column): vector[row]
        for half, columns in enumerate(parts)
        for column, vector in enumerate(columns)
        for row in range(3)
    }
    return made.made(entries, (6, made.lumped.speeds))


@typed
def centre_of_mass(tree: Tree) -> TreeFunction:
    """Return the centre of mass (m), (3,), from the ground's origin, in the ground's axes.

    Parameters
    ----------
    tree : Tree
        Without prescribed motions.

    Returns
    -------
    TreeFunction
        The centre of mass of all that moves (m), (3,), from the ground's origin, in the ground's
        axes; what is fixed to the ground is none of it.

    Raises
    ------
    InputError
        For prescribed motions.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), section 2.13.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> bob, hinge = Body("bob", 2, (0, 0, -3)), Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> centre_of_mass(Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -10))).expressions.T
    Matrix([[0, 3*sin(q_hinge), -3*cos(q_hinge)]])
    """
    made = _Function(tree, "centre_of_mass")
    values = [made.work.atom(d.expression) for d in _centre(made.derived)]
    return made.made(_listed(values), (3,), unit="m")


@typed
def energies(tree: Tree) -> TreeFunction:
    """Return kinetic and potential energy (J), (2,): of gravity and springs, zero at the ground's origin.

    Parameters
    ----------
    tree : Tree
        Without prescribed motions.

    Returns
    -------
    TreeFunction
        Kinetic and potential energy (J), (2,): of gravity and springs, zero at the ground's origin.

    Raises
    ------
    InputError
        For prescribed motions.

    Notes
    -----
    The axes and signs are those of `Joint`.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), section 2.14.

    Examples
    --------
    >>> from eom.multibody import Body, Joint
    >>> bob, hinge = Body("bob", 2, (0, 0, -3)), Joint("hinge", "revolute", "ground", "bob", axis="x")
    >>> energies(Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -10))).expressions.T
    Matrix([[9*u_hinge**2, -60*cos(q_hinge)]])
    """
    made = _Function(tree, "energies")
    return made.made(_listed([made.derived.kinetic(), made.derived.potential()]), (2,), unit="J")
