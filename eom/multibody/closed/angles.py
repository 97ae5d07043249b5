"""Angles about parallel axes: their sums are the angles against the ground."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from eom.errors import typed
from eom.multibody.algebra.scalars import is_zero, sub
from eom.multibody.algebra.spatial import Vector, times, transposed
from eom.multibody.closed.mechanism import Link, Mechanism, mechanism
from eom.multibody.closed.polynomials import Scalar
from eom.multibody.model.model import Tree

Expr = Any


@typed
def absolute_angles(tree: Tree) -> dict[Expr, Expr]:
    """Return coordinates that measure revolute joints with parallel axes against the ground.

    For `closed_form(tree, coordinates=...)`: each angle ``q_<joint>`` that hangs on another about the
    same direction, and that other, over new symbols ``theta_<joint>`` (rad). Empty if there is none.

    >>> from eom.multibody import Body, Joint
    >>> upper = Joint("upper", "revolute", "ground", "a", axis="x")
    >>> lower = Joint("lower", "revolute", "a", "b", axis="x")
    >>> absolute_angles(Tree("double", (Body("a", 1), Body("b", 1)), (upper, lower)))
    {q_upper: theta_upper, q_lower: theta_lower - theta_upper}
    """
    given = mechanism(tree)
    found: dict[Expr, Expr] = {}
    for chain in _chains(given):
        total = sp.S.Zero
        for k in chain:
            joint = given.links[k].joint
            if joint.kind != "revolute" or joint.motion is not None:
                break
            q = joint.coordinates[0].symbol
            if q in found:  # on the way to another end
                total = sp.Symbol(f"theta_{joint.name}", real=True)
                continue
            theta = sp.Symbol(f"theta_{joint.name}", real=True)
            found[q] = theta - total
            total = theta
    return found


def runs(given: Mechanism) -> tuple[tuple[Expr, ...], ...]:
    """Return the angles about parallel axes along each path, from the ground out."""
    starts = _starts(given)
    found = []
    for chain in _chains(given):
        angles = [given.algebra.expression(given.coordinates[starts[k]]) for k in chain]
        if all(a.is_Symbol for a in angles):
            found.append(tuple(angles))
    return tuple(found)


def _starts(given: Mechanism) -> list[int]:
    starts, count = [], 0
    for link in given.links:
        starts.append(count)
        count += len(link.joint.coordinates)
    return starts


def _chains(given: Mechanism) -> Iterator[list[int]]:
    """Yield the longest chains of links that turn about parallel axes, each after its carrier."""
    before: dict[int, int] = {}
    for k, link in enumerate(given.links):
        if link.joint.row.spins:
            carrier = _carrier(given, k)
            if carrier is not None:
                before[k] = carrier
    ends = [k for k in before if k not in before.values()]
    for end in ends:
        chain = [end]
        while chain[-1] in before:
            chain.append(before[chain[-1]])
        yield chain[::-1]


def _carrier(given: Mechanism, k: int) -> int | None:
    """Return the next link towards the ground that turns, if it does so about a parallel axis."""
    link = given.links[k]
    axis = _back(link, _axis(link))
    k = link.parent
    while k >= 0:
        link = given.links[k]
        if link.joint.row.spins:
            return k if _same(axis, _axis(link)) else None
        if any(any(not is_zero(x) for x in column.angular) for column in link.subspace):
            return None
        axis = _back(link, axis)
        k = link.parent
    return None


def _axis(link: Link) -> Vector:
    return link.subspace[0].angular


def _back(link: Link, v: Vector) -> Vector:
    """Return components in the parent's axes; the joint's turn leaves its axis where it is."""
    return times(transposed(link.rotation), v)


def _same(a: Vector, b: Vector) -> bool:
    differences: list[Scalar] = [sub(x, y) for x, y in zip(a, b, strict=True)]
    return all(map(is_zero, differences))
