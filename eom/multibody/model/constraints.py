"""What binds the motion of a tree beyond its joints, as frozen values.

Each constraint gives some scalar equations; that of number k acts by one multiplier, the force or torque
``lambda_<constraint>_<letter>`` on the second body, its opposite on the first. Units are SI, angles are in
radians; every number may be a SymPy expression over parameters. How the equations come about: see
`eom.multibody.constrained.equations`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import sympy as sp

from eom.errors import InputError, entries, is_text, near_matches, shown, typed_fields, unknown_name
from eom.multibody.algebra import values
from eom.multibody.algebra.scalars import is_zero
from eom.multibody.algebra.spatial import ZERO
from eom.multibody.algebra.values import Value, is_number
from eom.multibody.model import checks
from eom.multibody.model.bodies import HERE, Placement
from eom.multibody.model.joints import KINDS
from eom.multibody.model.joints import Kind as JointKind
from eom.multibody.model.model import Constraint, Tree
from eom.multibody.model.parts import ACTING, Axis, BodyName, Kind, Length, Position

CLOSING = tuple(k for k in KINDS if k not in {"free", "helical"})
"""Kinds of joints that close loops."""


@typed_fields
@dataclass(frozen=True)
class Loop(Constraint):
    """A loop closed by a joint from ``first`` to ``second`` (bodies, or the ground), which was cut.

    Parameters
    ----------
    kind : str
        As that of a `Joint` whose parent is ``first`` and whose child is ``second``.
    first, second : str
        Bodies, or the ground.
    axis, second_axis : str or vector, default "z"
        As those of a `Joint`.
    on_first, on_second : Placement, optional
        Placements, as its on_parent and on_child (m).

    Raises
    ------
    InputError
        For a kind that closes no loop, a zero axis, and two axes along one line.

    Notes
    -----
    Multipliers: force (N) at the origin of the joint's frame on ``second``, torque (N m) on it.

    References
    ----------
    Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 8.
    """

    name: str
    kind: Annotated[str, Kind("word", keys=("joint",))]
    first: BodyName
    second: BodyName
    axis: Axis = "z"
    second_axis: Axis = "x"
    on_first: Annotated[Placement, Kind(Placement)] = HERE
    on_second: Annotated[Placement, Kind(Placement)] = HERE

    def complete(self) -> None:
        """Raise `InputError` for a kind that closes no loop, and for two axes along one line."""
        if self.kind not in CLOSING:
            raise InputError(
                f"no joint of kind {self.kind!r} closes a loop",
                where=self.where,
                expected=", ".join(CLOSING),
                hint=near_matches(self.kind, CLOSING),
            )
        if self.row.axes == 2:
            checks.not_parallel(self.axis, self.second_axis, self.where)

    @property
    def row(self) -> JointKind:
        """The row of the table of joints."""
        return KINDS[self.kind]


@typed_fields
@dataclass(frozen=True)
class Distance(Constraint):
    """Two points at a constant distance (m): a rod without mass between two balls.

    Parameters
    ----------
    first, second : str
        The bodies, or the ground.
    length : number or expression
        The distance (m).
    first_point, second_point : vector, optional
        On them, from their origins, in their axes (m).

    Raises
    ------
    InputError
        For a distance that is not positive.

    Notes
    -----
    Multiplier: force (N) along the rod, from the first point to the second; a pull is negative.
    """

    name: str
    first: BodyName
    second: BodyName
    length: Length
    first_point: Position = ZERO
    second_point: Position = ZERO

    def complete(self) -> None:
        """Raise `InputError` for a distance that is not positive."""
        if is_number(self.length) and self.length <= 0:
            raise InputError(
                "the distance is not positive",
                where=self.where,
                got=self.length,
                hint="points that coincide are a Loop of kind spherical",
            )


@dataclass(frozen=True)
class _Expressed(Constraint):
    """An expression that is zero."""

    name: str
    expression: Annotated[Value, Kind("number", ACTING)]


@typed_fields
@dataclass(frozen=True)
class Equation(_Expressed):
    """An equation between coordinates: ``expression`` = 0, over coordinates, parameters and time.

    Parameters
    ----------
    expression : number or expression
        Over coordinates, parameters and time, in any consistent units; it is zero.

    Raises
    ------
    InputError
        For text in place of an expression.

    Notes
    -----
    Angles are in radians. Multiplier: generalised force by the gradient of the expression.
    """

    def check(self, tree: Tree) -> None:
        """Refuse what does not fit into a tree.

        Parameters
        ----------
        tree : Tree
            In which the equation shall hold.

        Raises
        ------
        InputError
            For an expression without coordinates, or with speeds or inputs.
        """
        _over(self, [q.symbol for j in tree.joints for q in j.coordinates], "coordinate")
        speeds = {q.symbol for j in tree.joints for q in j.speeds}
        _none_of(self, speeds, "speeds", "write a SpeedEquation")
        _none_of(self, {i.symbol for i in tree.inputs}, "inputs", "prescribe the motion of a joint")


@typed_fields
@dataclass(frozen=True)
class SpeedEquation(_Expressed):
    """An equation between speeds: ``expression`` = 0, linear in them, over all else that moves.

    Parameters
    ----------
    expression : number or expression
        Linear in speeds, over all else that moves, in any consistent units; it is zero.

    Raises
    ------
    InputError
        For text in place of an expression.

    Notes
    -----
    Multiplier: generalised force by the coefficients of the speeds.
    """

    def check(self, tree: Tree) -> None:
        """Refuse what does not fit into a tree.

        Parameters
        ----------
        tree : Tree
            In which the equation shall hold.

        Raises
        ------
        InputError
            For an expression without speeds, with inputs, or not linear in speeds.
        """
        speeds = [q.symbol for j in tree.joints for q in j.speeds]
        _over(self, speeds, "speed")
        _none_of(self, {i.symbol for i in tree.inputs}, "inputs", "prescribe the motion of a joint")
        for u in speeds:
            slope = sp.diff(self.expression, u)
            if any(not values.same(sp.diff(slope, v), 0) for v in speeds if slope.has(v)):
                raise InputError(
                    "the equation is not linear in the speeds", where=self.where, got=u
                )


@typed_fields
@dataclass(frozen=True)
class Coupling(Constraint):
    """Gears: the sum of ratio times rate is zero over some joints of one speed each.

    Parameters
    ----------
    ratios : numbers or expressions
        A number a joint, by its name. The sum of ratio times coordinate keeps its start value.
    follower : str, optional
        The joint whose speed is no state where speeds are eliminated; by default numbers decide.

    Raises
    ------
    InputError
        For fewer than two joints, a ratio of zero, and a follower that is none of them.

    Notes
    -----
    Multiplier: generalised force (N m or N) on a joint of ratio 1.
    """

    name: str
    ratios: Annotated[Any, Kind("ratios")]
    follower: str = ""

    def complete(self) -> None:
        """Raise `InputError` for fewer than two joints, and for a ratio of zero."""
        pairs = self.ratios.items() if isinstance(self.ratios, Mapping) else self.ratios
        given = entries(pairs, f"{self.where}: ratios")
        if not all(isinstance(g, tuple | list) and len(g) == 2 and is_text(g[0]) for g in given):
            raise InputError(
                "ratios are a number a joint", where=self.where, got=shown(self.ratios),
                expected='for example {"first": 1, "second": -2}',
            )  # fmt: skip
        rows = tuple((j, values.value(x, f"{self.where}: ratio of {j}")) for j, x in given)
        if len({j for j, _ in rows}) < max(2, len(rows)) or any(is_zero(x) for _, x in rows):
            raise InputError(
                "a coupling needs at least two joints, each once, with ratios that are not zero",
                where=self.where,
                got=", ".join(f"{j}: {x}" for j, x in rows),
            )
        if self.follower and self.follower not in {j for j, _ in rows}:
            names = ", ".join(j for j, _ in rows)
            raise InputError("the follower is not coupled", where=self.where, got=self.follower,
                             expected=names)  # fmt: skip
        self._keep("ratios", rows)

    def check(self, tree: Tree) -> None:
        """Refuse what does not fit into a tree.

        Parameters
        ----------
        tree : Tree
            In which the coupling shall be.

        Raises
        ------
        InputError
            For joints that are unknown or have several speeds.
        """
        known = {j.name: j for j in tree.joints}
        for name, _ in self.ratios:
            if name not in known:
                raise unknown_name("joint", name, known, self.where)
            if known[name].row.paired(known[name].attitude) != (0,):
                raise InputError(
                    "a coupling needs joints of one speed, the rate of their coordinate",
                    where=self.where,
                    got=f"{name}, {known[name].kind}",
                    hint="write a SpeedEquation",
                )
        super().check(tree)


@typed_fields
@dataclass(frozen=True)
class Rolling(Constraint):
    """A wheel, ball or ellipsoid of revolution rolls on a plane of the ground without slip.

    Parameters
    ----------
    body : str
        Its name.
    radius : number or expression
        In m, of an ellipsoid that of its equator.
    axis : numbers or expressions, default "z"
        Of a wheel with a thin edge or an ellipsoid, in the body's axes; None for a ball.
    centre : vector, optional
        Of the circle or ball, from the body's origin, in its axes (m).
    normal : str or vector, default "z"
        Of the plane, towards the wheel, in the ground's axes.
    origin : vector, optional
        A point of the plane (m), in the ground's axes.
    half_axis : number or expression, default 0
        How far an ellipsoid reaches along its axis (m), 0 for a thin edge.

    Raises
    ------
    InputError
        For a radius that is not positive, a half axis below zero or of a ball, a zero axis or
        normal, and a symbolic normal that is in no plane of two of the ground's axes.

    Notes
    -----
    The point of contact wanders over the body. Multipliers: force (N) of the plane on the body at
    that point, along two directions of the plane, which are x and y where the normal is z, and
    along the normal.
    """

    name: str
    body: BodyName
    radius: Length
    axis: Annotated[Any, Kind("axis", optional=True, unit="1")] = "z"
    centre: Position = ZERO
    normal: Axis = "z"
    origin: Position = ZERO
    half_axis: Length = 0

    def complete(self) -> None:
        """Raise `InputError` for a radius that is not positive, and a normal in no plane of two axes."""
        if is_number(self.radius) and self.radius <= 0:
            raise InputError("the radius is not positive", where=self.where, got=self.radius)
        if is_number(self.half_axis) and self.half_axis < 0:
            raise InputError("the half axis is below zero", where=self.where, got=self.half_axis)
        if self.axis is None and not is_zero(self.half_axis):
            raise InputError(
                "a ball has no half axis", where=self.where, got=self.half_axis,
                hint="give the axis of the ellipsoid, or leave half_axis out",
            )  # fmt: skip
        if not any(map(is_zero, self.normal)) and not all(map(is_number, self.normal)):
            raise InputError(
                "a symbolic normal must be in a plane of two of the ground's axes",
                where=self.where, got=self.normal,
                hint="keep the plane horizontal, and tilt gravity instead",
            )  # fmt: skip


@typed_fields
@dataclass(frozen=True)
class KnifeEdge(Constraint):
    """A knife edge: a point of a body has no velocity along a direction of the body.

    Parameters
    ----------
    body : str
        Its name.
    direction : str or vector, default "y"
        Across the edge, in the body's axes.
    point : vector, optional
        From the origin of the body, in its axes (m).

    Raises
    ------
    InputError
        For a zero direction.

    Notes
    -----
    Multiplier: force (N) on the body at that point, along the direction.
    """

    name: str
    body: BodyName
    direction: Axis = "y"
    point: Position = ZERO


def _over(constraint: Equation | SpeedEquation, symbols: Any, kind: str) -> None:
    given = constraint.expression
    if is_number(given) or not given.free_symbols & set(symbols):
        known = ", ".join(map(str, symbols))
        raise InputError(
            f"the equation has no {kind}", where=constraint.where, got=given, expected=known
        )


def _none_of(constraint: Equation | SpeedEquation, symbols: set[Any], kind: str, hint: str) -> None:
    found = constraint.expression.free_symbols & symbols
    if found:
        raise InputError(
            f"the equation has {kind}",
            where=constraint.where,
            got=", ".join(sorted(map(str, found))),
            hint=hint,
        )
