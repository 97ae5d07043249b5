"""How the kinds of joints of SymPy's mechanics are read: a row a class.

A row takes the reader (which keeps the names of coordinates and speeds), the joint, and its name, bodies
and placements as they are in a tree.
"""

from __future__ import annotations

from typing import Any

import sympy as sp
from sympy.physics import mechanics as me

from eom.errors import InputError
from eom.kinematics.coordinates import SEQUENCES, rotation_sequence
from eom.kinematics.frames import vector
from eom.multibody.model.model import Joint, Placement

Expr = Any


def _axis(joint: Any, v: Any) -> tuple[Expr, ...]:
    return tuple(v.normalize().to_matrix(joint.parent_interframe))


def _turning(kind: str) -> Any:
    """Return how joints along or about one axis are read."""

    def read(reader: Any, joint: Any, placed: dict[str, Any]) -> Joint:
        made = Joint(kind=kind, axis=_axis(joint, joint.joint_axis), **placed)
        reader.name_states(joint, made, [u.symbol for u in made.speeds])
        return made

    return read


def _welded(reader: Any, joint: Any, placed: dict[str, Any]) -> Joint:  # noqa: ARG001
    return Joint(kind="fixed", **placed)


def _planar(reader: Any, joint: Any, placed: dict[str, Any]) -> Joint:
    """SymPy turns about the first axis and moves along the second and third; a tree z, x and y."""
    cyclic = ((0, 1, 0), (0, 0, 1), (1, 0, 0))
    for side in ("on_parent", "on_child"):
        C = sp.Matrix(cyclic) * sp.Matrix(placed[side].rotation)
        placed[side] = Placement(placed[side].position, C.tolist())
    made = Joint(kind="planar", **placed)
    x, y, q = (c.symbol for c in made.coordinates)
    v1, v2, u = (s.symbol for s in made.speeds)
    s, c = sp.sin(q), sp.cos(q)
    rates = (u, c * v1 - s * v2, s * v1 + c * v2)
    for theirs, speed, ours, rate in zip(
        joint.coordinates, joint.speeds, (q, x, y), rates, strict=True
    ):
        reader.names[theirs] = ours
        reader.names[speed] = reader.names[theirs.diff(me.dynamicsymbols._t)] = rate
    return made


def _spherical(reader: Any, joint: Any, placed: dict[str, Any]) -> Joint:
    """Turns about fixed axes are turns about body axes in the opposite order."""
    order = [_DIGITS.get(c, c) for c in str(joint._rot_order).upper()]
    amounts = list(joint.coordinates if joint._amounts is None else joint._amounts)
    if joint._rot_type.upper() == "SPACE":
        order, amounts = order[::-1], amounts[::-1]
    attitude = "-".join(order)
    if attitude not in SEQUENCES or sorted(map(str, amounts)) != sorted(
        map(str, joint.coordinates)
    ):
        raise InputError(
            "rotation that trees do not have", where=f"joint {joint.name!r}",
            got=f"{joint._rot_type} {joint._rot_order} {amounts}",
            expected="a sequence of the three coordinates",
        )  # fmt: skip
    made = Joint(kind="spherical", attitude=attitude, **placed)
    angles = [c.symbol for c in made.coordinates]
    omega = vector("B", [s.symbol for s in made.speeds])
    rates = dict(zip(angles, rotation_sequence(attitude, angles).rates(omega), strict=True))
    ours = dict(zip(amounts, angles, strict=True))
    for q, u in zip(joint.coordinates, joint.speeds, strict=True):
        reader.names[q] = ours[q]
        reader.names[u] = reader.names[q.diff(me.dynamicsymbols._t)] = rates[ours[q]]
    return made


_DIGITS = {"X": "1", "Y": "2", "Z": "3"}

KINDS: dict[str, Any] = {
    "PinJoint": _turning("revolute"),
    "PrismaticJoint": _turning("prismatic"),
    "CylindricalJoint": _turning("cylindrical"),
    "PlanarJoint": _planar,
    "SphericalJoint": _spherical,
    "WeldJoint": _welded,
}
"""SymPy's joints by the names of their classes."""
