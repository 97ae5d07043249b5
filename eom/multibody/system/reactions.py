"""Reactions: what a joint's parent exerts on its child, by Newton and Euler from the accelerations.

No auxiliary speeds are needed: once the accelerations are known, force and moment of a joint are what
its child, and all that hangs on it, take beyond loads and gravity (Featherstone, Rigid Body Dynamics
Algorithms, 2008, sec. 5.3). Everything that goes through the joint is in them: the constraint, motors,
springs, dampers, applied forces and the drive of a prescribed motion, less what accelerates the rotors.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import sympy as sp

from eom.errors import InputError, near_matches, typed, typed_fields, unknown_name
from eom.multibody.algebra import values
from eom.multibody.algebra.lazy_sums import plain
from eom.multibody.algebra.scalars import Work, sub
from eom.multibody.algebra.spatial import (
    ZERO,
    Matrix,
    SpatialVector,
    Vector,
    back,
    cross,
    minus,
    plus,
    times,
    transposed,
)
from eom.multibody.model import checks
from eom.multibody.model.bodies import GROUND, Joint
from eom.multibody.model.model import Tree
from eom.multibody.model.parts import CENTRE, ORIGIN
from eom.multibody.recursion.lumped_tree import BodyPlacement, Lift, LumpedTree, lumped_tree
from eom.multibody.recursion.motion import Scalars, places, poses
from eom.multibody.recursion.recursions import along_joints, transmitted
from eom.quantities import Definition, Quantity

JOINT = "joint"


@typed_fields
@dataclass(frozen=True)
class Reaction:
    """The force (N) and the torque (N m) that the parent of a joint exerts on its child.

    Parameters
    ----------
    joint : str
        Its name.
    point : number, expression or several, default "joint"
        What the torque is about: ``joint``, the origin of its frame on the child; or a point of the
        body: its ``centre`` of mass, its ``origin``, or three components in its axes (m).
    body : str, optional
        Of which that is a point, the child if left out.
    axes : str, default "ground"
        ``ground``, ``parent``, ``child`` (of the bodies), or ``joint`` (its frame on the child).
    name : str, optional
        Of the outputs, ``F_<name>_1`` to ``T_<name>_3``; the joint's if left out.

    Raises
    ------
    InputError
        For unknown axes and points, and a body without a point of it.

    Notes
    -----
    Everything that goes through the joint is in them, motors and springs at it too.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), sec. 5.3.
    """

    joint: str
    point: Any = JOINT
    body: str = ""
    axes: str = GROUND
    name: str = ""

    def __post_init__(self) -> None:
        where = f"reaction in {self.joint!r}"
        if self.axes not in AXES:
            raise unknown_name("axes", self.axes, AXES, where)
        if not isinstance(self.point, str):
            object.__setattr__(self, "point", values.triple(self.point, f"{where}: point"))
        elif self.point not in _POINTS:
            raise InputError(
                "unknown point", where=where, got=self.point,
                expected=f"{', '.join(_POINTS)} or three components",
                hint=near_matches(self.point, _POINTS),
            )  # fmt: skip
        if self.body and self.point == JOINT:
            raise InputError(
                "a body, but no point of it", where=where, got=self.body,
                expected=f"point={CENTRE!r}, {ORIGIN!r} or three components",
            )  # fmt: skip
        if self.name:
            checks.name(self.name, where)

    @property
    def label(self) -> str:
        """What the outputs are named by."""
        return self.name or self.joint

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the outputs: forces, then torques."""
        return tuple(f"{letter}_{self.label}_{k}" for letter in "FT" for k in (1, 2, 3))


_POINTS = (JOINT, CENTRE, ORIGIN)


@typed
def reaction(
    joint: Joint | str, point: Any = JOINT, *, body: str = "", axes: str = GROUND, name: str = ""
) -> Reaction:
    """Return a reaction to ask `eom.multibody.derive` for, of a joint or its name; see `Reaction`.

    Parameters
    ----------
    joint : Joint or str
        A joint or its name.
    point : point, default "joint"
        About which torques are, see `Reaction`; the joint's own by default.
    body : str, optional
        Of which ``point`` is a point, see `Reaction`; the child by default.
    axes : str, default "ground"
        In which components are, see `Reaction`.
    name : str, optional
        By which outputs are called, that of the joint by default.

    Returns
    -------
    Reaction
        To ask `eom.multibody.derive` for; forces in N, torques in N m.

    Raises
    ------
    InputError
        As `Reaction` raises it.

    Examples
    --------
    >>> reaction("hinge", axes="child").names[:3]
    ('F_hinge_1', 'F_hinge_2', 'F_hinge_3')
    """
    return Reaction(joint.name if isinstance(joint, Joint) else joint, point, body, axes, name)


class Wrenches:
    """What goes through the joints of a tree in motion, over any scalars.

    ``udot``: all accelerations, those of prescribed motions among them. ``apart``: joints that may
    be asked for beside those that move. ``further``: see `eom.multibody.recursion.recursions.transmitted`;
    its parts are those of ``lumped_tree``.
    """

    def __init__(
        self,
        tree: Tree,
        lift: Lift,
        work: Work,
        motion: tuple[Scalars, Scalars, Scalars],
        apart: Iterable[str] = (),
        further: Callable[[LumpedTree], Sequence[SpatialVector]] | None = None,
    ) -> None:
        q, u, udot = motion
        self.tree, self.lift, self.work = tree, lift, work
        self.lumped_tree = lumped_tree(
            tree, lift, work, [b.name for b in tree.bodies], apart=frozenset(apart)
        )
        self.placed = places(self.lumped_tree, q, work)
        loads = None if further is None else further(self.lumped_tree)
        self.through = transmitted(self.lumped_tree, self.placed, u, udot, work, loads)
        self.number = {p.joint: k for k, p in enumerate(self.lumped_tree.parts)}
        self._udot = udot

    @cached_property
    def poses(self) -> list[tuple[Matrix, Vector]]:
        """Rotations from the ground, and positions of origins in its axes."""
        return poses(self.placed, self.work)

    def along(self) -> list[Any]:
        """Return the generalised forces, one a speed, that the motion takes."""
        return along_joints(self.placed, self.through, self._udot)

    def of(self, wanted: Reaction) -> SpatialVector:
        """Return torque about the point, and force, in the axes that are asked for.

        Raises `InputError` for an unknown joint or body.
        """
        where = f"tree {self.tree.name!r}: reaction in {wanted.joint!r}"
        joint = joint_named(self.tree, wanted.joint, where)
        k = self.number[joint.name]
        torque, force = self.through[k]
        torque = plus(torque, cross(self._arm(wanted, joint, k, where), force))
        turn = AXES[wanted.axes]
        return SpatialVector(turn(self, joint, k, torque), turn(self, joint, k, force))

    def _arm(self, wanted: Reaction, joint: Joint, k: int, where: str) -> Vector:
        """Return the joint's origin from the point, in the axes of the part."""
        if wanted.point == JOINT:
            return ZERO
        name = wanted.body or joint.child
        if name not in self.lumped_tree.seats:
            raise unknown_name("body", name, self.lumped_tree.seats, where)
        seat = self.lumped_tree.seats[name]
        point = seat.point([self.lift(x) for x in self._on_body(wanted, name, where)])
        if seat.part == k:
            return minus(ZERO, point)
        R, x = self.poses[k]
        return times(R, minus(x, self._in_ground(seat, point)))

    def _in_ground(self, seat: BodyPlacement, point: Vector) -> Vector:
        if seat.part < 0:
            return point
        R, x = self.poses[seat.part]
        return plus(x, times(transposed(R), point))

    def _on_body(self, wanted: Reaction, name: str, where: str) -> Vector:
        if not isinstance(wanted.point, str):
            return tuple(wanted.point)
        if wanted.point == ORIGIN:
            return ZERO
        if name == GROUND:
            raise InputError("the ground has no centre of mass", where=where)
        centre: Vector = self.tree.body[name].centre
        return centre


def _ground(forces: Wrenches, joint: Joint, k: int, v: Vector) -> Vector:  # noqa: ARG001
    return times(transposed(forces.poses[k][0]), v)


def _parent(forces: Wrenches, joint: Joint, k: int, v: Vector) -> Vector:
    seat: BodyPlacement = forces.lumped_tree.seats[joint.parent]
    return times(seat.rotation, back(forces.placed[k].rotation, v))


def _child(forces: Wrenches, joint: Joint, k: int, v: Vector) -> Vector:  # noqa: ARG001
    seat: BodyPlacement = forces.lumped_tree.seats[joint.child]
    return times(seat.rotation, v)


def _joint(forces: Wrenches, joint: Joint, k: int, v: Vector) -> Vector:  # noqa: ARG001
    return v


AXES: dict[str, Callable[[Wrenches, Joint, int, Vector], Vector]] = {
    GROUND: _ground,
    "parent": _parent,
    "child": _child,
    JOINT: _joint,
}
"""How components in the axes of a part get into others."""


def joint_named(tree: Tree, name: str, where: str) -> Joint:
    """Return a joint. Raises `InputError` for an unknown one."""
    known = {j.name: j for j in tree.joints}
    if name not in known:
        raise unknown_name("joint", name, known, where)
    return known[name]


def of_all(tree: Tree) -> list[Reaction]:
    """Return the reactions of all joints, about their origins, in the ground's axes."""
    return [Reaction(j.name) for j in tree.ordered]


def definitions(forces: Wrenches, wanted: Reaction) -> list[Definition]:
    """Return a reaction's components: force, then torque."""
    found = forces.of(wanted)
    label = wanted.label
    parts = (("force", "F", "N", found.linear), ("torque", "T", "N m", found.angular))
    return [
        Definition(
            Quantity(
                sp.Symbol(f"{letter}_{label}_{k}", real=True), unit,
                f"{what} by the parent on the child of {wanted.joint}{_about(wanted, what)}, "
                f"along axis {k} of {_of_axes(wanted.axes)}",
            ),
            plain(x),
        )
        for what, letter, unit, components in parts
        for k, x in enumerate(components, 1)
    ]  # fmt: skip


def _of_axes(axes: str) -> str:
    return {JOINT: "the joint's frame on the child"}.get(axes, f"the {axes}")


def _about(wanted: Reaction, what: str) -> str:
    """Return what a torque is about."""
    if what == "force":
        return ""
    if wanted.point == JOINT:
        return " about the joint's origin"
    of = wanted.body or "the child"
    if isinstance(wanted.point, str):
        return f" about the {wanted.point} of {of}"
    return f" about ({', '.join(map(str, wanted.point))}) on {of}"


def drives(forces: Wrenches, acting: Scalars) -> list[Definition]:
    """Return what drives prescribed motions: generalised forces beside those that act in the joints.

    ``acting``: forces of springs, dampers and the like, one a speed.
    """
    found = []
    taken = forces.along()
    for joint in forces.tree.ordered:
        if joint.motion is None:
            continue
        part = forces.lumped_tree.parts[forces.number[joint.name]]
        speeds = range(part.speeds.start, part.speeds.stop)
        for s, drive in zip(speeds, drives_of(joint), strict=True):
            found.append(Definition(drive, plain(sub(taken[s], acting[s]))))
    return found


def drives_of(joint: Joint) -> tuple[Quantity, ...]:
    """Return what drives a prescribed motion, one a speed; nothing of a free joint."""
    if joint.motion is None:
        return ()
    motors = replace(joint, motor=True, motion=None).motors
    return tuple(replace(m, meaning=m.meaning.replace("motor", "drive", 1)) for m in motors)
