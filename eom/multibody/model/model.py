"""The tree that bodies, joints and what is attached to them make, and what it must be.

Every number may be a SymPy expression instead; units are SI, angles are in radians.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from eom.errors import InputError, near_matches, typed_fields, unknown_name
from eom.multibody.algebra import values
from eom.multibody.algebra.scalars import is_zero
from eom.multibody.algebra.spatial import ZERO, ZEROS
from eom.multibody.algebra.values import is_number
from eom.multibody.model import checks, jets, measures
from eom.multibody.model.attachments import Load, Rotor, Spring
from eom.multibody.model.bodies import GROUND, Body, Joint
from eom.multibody.model.jets import Jet
from eom.multibody.model.parts import Part
from eom.quantities import TIME, Quantity


class Constraint(Part):
    """What all rows of `eom.multibody.model.constraints` have: a name, bodies, and multipliers.

    Units are SI. Multiplier number k of a constraint is ``lambda_<constraint>_<letter>``: a force (N) or
    torque (N m) on the second body, its opposite on the first; each row says along what.
    """

    noun = "constraint"

    name: str

    @property
    def bodies(self) -> tuple[str, ...]:
        """The bodies that it binds, or the ground."""
        held = (name for name, kind in self._kinds.items() if kind.shape == "body")
        return tuple(getattr(self, name) for name in held)

    def check(self, tree: Tree) -> None:
        """Refuse what does not fit into a tree.

        Parameters
        ----------
        tree : Tree
            In which the constraint shall be.

        Raises
        ------
        InputError
            For unknown bodies, one that is bound to itself, and sizes that change.
        """
        known = {GROUND, *(b.name for b in tree.bodies)}
        for name in self.bodies:
            if name not in known:
                raise unknown_name("body", name, known, self.where)
        if len(set(self.bodies)) < len(self.bodies):
            raise InputError("a body is bound to itself", where=self.where, got=self.bodies[0])
        moving = {q.symbol for j in tree.joints for q in (*j.coordinates, *j.speeds)} | {TIME}
        for given in self.values:
            found = set() if is_number(given) else given.free_symbols & moving
            if found:
                raise InputError("a length or direction of a constraint is not constant",
                                 where=self.where, got=", ".join(sorted(map(str, found))),
                                 hint="write an Equation over coordinates and time")  # fmt: skip


@typed_fields
@dataclass(frozen=True)
class Tree:
    """Bodies joined to the ground without loops, and constraints on them, which may close loops.

    Parameters
    ----------
    name : str
        What the tree is called, also in generated code.
    bodies : tuple of Body
        One joint leads to each.
    joints : tuple of Joint
        In any order.
    gravity : number, expression or several, optional
        Its acceleration in the ground's axes (m/s^2), (3,), at the ground's origin.
    loads : tuple of Load, optional
        Forces and torques.
    inputs : tuple of symbols or Quantity, optional
        Symbols, or quantities, that are inputs.
    parameters : tuple of Quantity, optional
        Quantities that describe parameters (every other symbol is one too).
    constraints : tuple of Constraint, optional
        Rows of `eom.multibody.model.constraints`, which may close loops.
    rotors : tuple of Rotor, optional
        What spins in bodies.
    springs : tuple of Spring, optional
        Between points.
    gravity_gradient : number, expression or several, optional
        By how much gravity grows with the position, symmetric, (3, 3) or its diagonal (1/s^2).
    jets : tuple of Jet, optional
        By which mass leaves.
    numbers : str, optional
        What numbers in the equations are, a row of `eom.system.NUMBERS`; nothing where that is to
        be seen from the values, whose dimensions are then checked.

    Raises
    ------
    InputError
        That names the body or joint at fault: repeated or unknown names, a body that hangs on
        nothing or on two joints, a loop, a joint that moves no mass, an expression of another
        dimension than its place has, where it is over parameters or inputs with units.

    Notes
    -----
    Every number may be a SymPy expression; SI units, angles in radians.

    Examples
    --------
    >>> bob = Body("bob", mass=2, centre=(0, 0, -1))
    >>> hinge = Joint("hinge", "revolute", GROUND, "bob", axis="x")
    >>> Tree("pendulum", (bob,), (hinge,), gravity=(0, 0, -9.81)).joint_of["bob"].name
    'hinge'
    """

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    gravity: Any = ZERO
    loads: tuple[Load, ...] = ()
    inputs: tuple[Any, ...] = ()
    parameters: tuple[Quantity, ...] = field(default=(), compare=False)
    constraints: tuple[Constraint, ...] = ()
    rotors: tuple[Rotor, ...] = ()
    springs: tuple[Spring, ...] = ()
    gravity_gradient: Any = ZEROS
    jets: tuple[Jet, ...] = ()
    numbers: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        keep = object.__setattr__
        for name in "bodies joints loads parameters constraints rotors springs jets".split():
            keep(self, name, tuple(getattr(self, name)))
        keep(self, "gravity", values.triple(self.gravity, f"tree {self.name!r}: gravity"))
        place = f"tree {self.name!r}: gravity_gradient"
        keep(self, "gravity_gradient", values.symmetric(self.gravity_gradient, place))
        described = (i if isinstance(i, Quantity) else Quantity(i) for i in self.inputs)
        keep(self, "inputs", tuple(described))
        _check_tree(self)
        keep(self, "numbers", measures.checked(self))

    @cached_property
    def ordered(self) -> tuple[Joint, ...]:
        """The joints, each after the joint of its parent. Raises `InputError` for a loop."""
        return ordered(self)

    @cached_property
    def body(self) -> dict[str, Body]:
        """Bodies by name."""
        return {b.name: b for b in self.bodies}

    @cached_property
    def joint_of(self) -> dict[str, Joint]:
        """The joint that leads to each body."""
        return {j.child: j for j in self.joints}


# -- what they must be --


def _check_tree(given: Tree) -> None:
    """Raise `InputError` for what is no tree, naming the body or joint."""
    where = f"tree {given.name!r}"
    checks.name(given.name, where)
    named = (given.bodies, given.joints, given.rotors, given.springs, given.constraints, given.jets)
    for parts in named:
        _once(parts, where)
    known = {b.name for b in given.bodies}
    if GROUND in known:
        raise InputError(
            "a body is called ground", where=where, hint="ground is what does not move"
        )
    for what, place, name, allowed in _held(given, known, where):
        if name not in allowed:
            hint = near_matches(name, allowed)
            raise InputError(f"{what} {name!r}", where=place, hint=hint)
    for s in given.springs:
        if s.bodies[0] == s.bodies[1]:
            raise InputError("both ends are on one body", where=s.where, got=s.bodies[0])
    _single_parents(given, where)
    ordered(given)
    moving = {q.symbol for j in given.joints for q in (*j.coordinates, *j.speeds)}
    moving |= {q.symbol for r in given.rotors for q in r.states}
    jets.check(given.bodies, given.jets, moving, {i.symbol for i in given.inputs})
    for constraint in given.constraints:
        constraint.check(given)
    _massless(given)


def _held(given: Tree, known: set[str], where: str) -> Iterator[tuple[str, str, str, set[str]]]:
    """Yield the bodies that parts name: what an unknown one is, where it is named, which there are."""
    for j in given.joints:
        yield "unknown parent", j.where, j.parent, known | {GROUND}
        yield "unknown child", j.where, j.child, known
    for load in given.loads:
        yield "load on unknown body", where, load.body, known
    for rotor in given.rotors:
        yield "rotor on unknown body", rotor.where, rotor.body, known
    for jet in given.jets:
        yield "jet of unknown body", jet.where, jet.body, known
    for s in given.springs:
        for name in s.bodies:
            yield "spring on unknown body", s.where, name, known | {GROUND}


def _once(parts: Sequence[Any], where: str) -> None:
    repeated = sorted(n for n, count in Counter(p.name for p in parts).items() if count > 1)
    if repeated:
        what = f"repeated name of a {parts[0].noun}"
        raise InputError(what, where=where, got=", ".join(repeated))


def _single_parents(given: Tree, where: str) -> None:
    """Every body hangs on one joint."""
    leading: dict[str, list[str]] = {b.name: [] for b in given.bodies}
    for j in given.joints:
        leading[j.child].append(j.name)
    for child, names in leading.items():
        if not names:
            raise InputError(f"body {child!r} hangs on nothing", where=where,
                             hint="a body that floats has a free joint to the ground")  # fmt: skip
        if len(names) > 1:
            raise InputError(
                f"two joints lead to body {child!r}",
                where=where,
                got=", ".join(names),
                hint="a tree has no loops: cut one of them, and close it by a constraint (Loop)",
            )


def ordered(given: Tree) -> tuple[Joint, ...]:
    """Return the joints, each after that of its parent; raise `InputError` for a loop."""
    children: dict[str, list[Joint]] = {}
    for j in given.joints:
        children.setdefault(j.parent, []).append(j)
    found: list[Joint] = []
    stack = children.get("ground", [])[::-1]
    while stack:
        j = stack.pop()
        found.append(j)
        stack += children.get(j.child, [])[::-1]
    if len(found) < len(given.joints):
        reached = {j.name for j in found}
        lost = [j.name for j in given.joints if j.name not in reached]
        raise InputError(
            "joints that the ground does not lead to: they form a loop",
            where=f"tree {given.name!r}",
            got=", ".join(lost),
        )
    return tuple(found)


def _massless(given: Tree) -> None:
    """Raise `InputError` for a joint that moves freely and moves no mass, and is not bound to any."""
    found = moves_nothing(given, {b for c in given.constraints for b in c.bodies})
    if found is not None:
        raise InputError(
            "the joint moves no mass",
            where=f"joint {found.name!r}",
            got=f"body {found.child!r} of mass 0, and nothing heavy on it",
            hint="give it mass, or fix the joint",
        )


def moves_nothing(given: Tree, bound: Collection[str]) -> Joint | None:
    """Return a free joint that moves neither mass nor a body of ``bound``, if there is one."""
    heavy: dict[str, bool] = {}
    bodies = {b.name: b for b in given.bodies}
    children: dict[str, list[Joint]] = {}
    for j in given.joints:
        children.setdefault(j.parent, []).append(j)
    for j in reversed(ordered(given)):
        own = j.child in bound or not is_zero(bodies[j.child].mass)
        below = any(heavy[k.child] or _armed(k) for k in children.get(j.child, ()))
        heavy[j.child] = own or below
        if not heavy[j.child] and j.speeds and j.motion is None and not _armed(j):
            return j
    return None


def _armed(j: Joint) -> bool:
    return any(not is_zero(x) for x in j.armature)
