"""Inverse dynamics by recursive Newton-Euler, and the mass matrix by composite bodies.

Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 5, table 5.1, and ch. 6, table 6.2. Conventions
and scalars: see `eom.multibody.recursion.motion`.
"""

from __future__ import annotations

from collections.abc import Sequence

from eom.multibody.algebra.scalars import Scalar, Work, add, mul
from eom.multibody.algebra.spatial import Inertia, SpatialVector, cross, dot, forward, joined, plus
from eom.multibody.recursion.lumped_tree import LumpedTree
from eom.multibody.recursion.motion import (
    STILL,
    Moving,
    Place,
    Scalars,
    biases,
    carrier_of,
    combined,
    handed,
    inward,
    keep_inertia,
    keep_pair,
    motion,
    places,
    zeta,
)
from eom.multibody.recursion.springs import applied


def inverse_dynamics(
    tree: LumpedTree, q: Scalars, u: Scalars, udot: Scalars, work: Work
) -> list[Scalar]:
    """Return the generalised forces that accelerations take, loads and gravity acting.

    Recursive Newton-Euler: Featherstone 2008, table 5.1.
    """
    placed = places(tree, q, work)
    return along_joints(placed, transmitted(tree, placed, u, udot, work), udot)


def along_joints(
    placed: Sequence[Place], forces: Sequence[SpatialVector], udot: Scalars
) -> list[Scalar]:
    """Return S^T f of each joint, and what accelerates the rotors in it."""
    tau: list[Scalar] = [0] * len(udot)
    for place, force in zip(placed, forces, strict=True):
        for n, column in enumerate(place.subspace):
            s = place.part.speeds.start + n
            tau[s] = add(dot(column.six, force.six), mul(place.part.armature[n], udot[s]))
    return tau


def transmitted(
    tree: LumpedTree,
    placed: Sequence[Place],
    u: Scalars,
    udot: Scalars,
    work: Work,
    further: Sequence[SpatialVector] | None = None,
) -> list[SpatialVector]:
    """Return what each part takes through its joint: moment about its origin, and force.

    In the axes of the part; whatever acts in the joint, and what its constraint takes. ``further``: loads
    on the parts beside those of the tree, such as those of closed loops, in the same form.
    Recursive Newton-Euler: Featherstone 2008, table 5.1.
    """
    moved = motion(placed, u, work)
    acting = applied(tree, placed, moved, work)
    if further is not None:
        acting = [SpatialVector(plus(a.angular, b.angular), plus(a.linear, b.linear))
                  for a, b in zip(acting, further, strict=True)]  # fmt: skip
    forces = biases(placed, moved, acting, work)
    for k, here in enumerate(accelerated(tree, placed, moved, udot, work)):
        needed = placed[k].part.inertia.times(here)
        forces[k] = SpatialVector(
            plus(forces[k].angular, needed.angular), plus(forces[k].linear, needed.linear)
        )
    for k in range(len(placed) - 1, -1, -1):
        part = placed[k].part
        forces[k] = keep_pair(work, ("n", "f"), part.name, forces[k])
        if part.parent >= 0:
            forces[part.parent] = handed(work, placed[k], forces[k], forces[part.parent])
    return forces


def accelerated(
    tree: LumpedTree, placed: Sequence[Place], moved: Sequence[Moving], udot: Scalars, work: Work
) -> list[SpatialVector]:
    """Return angular accelerations, and accelerations of origins less gravity's, of the parts."""
    found: list[SpatialVector] = []
    for place, moving in zip(placed, moved, strict=True):
        carrier = carrier_of(tree, place, found)
        carried = plus(
            plus(carrier.linear, cross(carrier.angular, place.position)), moving.centripetal
        )
        known = zeta(place, moving, forward(place.rotation, carried))
        joint = combined(place.subspace, udot[place.part.speeds])
        angular = plus(plus(forward(place.rotation, carrier.angular), known.angular), joint.angular)
        linear = plus(known.linear, joint.linear)
        found.append(
            keep_pair(work, ("alpha", "a"), place.part.name, SpatialVector(angular, linear))
        )
    return found


def composites(placed: Sequence[Place], work: Work) -> list[Inertia]:
    """Return the inertia of each part with all that hangs on it, as if it were rigid."""
    whole = [place.part.inertia for place in placed]
    for k in range(len(placed) - 1, -1, -1):
        part = placed[k].part
        whole[k] = keep_inertia(work, "composite_", part.name, whole[k])
        if part.parent >= 0:
            whole[part.parent] = joined(whole[part.parent], inward(work, placed[k], whole[k]))
    return whole


def mass_matrix(tree: LumpedTree, q: Scalars, work: Work) -> list[list[Scalar]]:
    """Return the symmetric mass matrix over the speeds; composite bodies, Featherstone 2008, table 6.2.

    Entries of speeds that do not share a path to the ground are zero by structure.
    """
    placed = places(tree, q, work)
    whole = composites(placed, work)
    size = tree.speeds
    M: list[list[Scalar]] = [[0] * size for _ in range(size)]
    for k, place in enumerate(placed):
        for n, column in enumerate(place.subspace):
            s = place.part.speeds.start + n
            force = keep_pair(work, ("column", "column"), place.part.name, whole[k].times(column))
            M[s][s] = place.part.armature[n]
            _fill(placed, k, s, force, M, work)
    return M


def _fill(
    placed: Sequence[Place], k: int, s: int, force: SpatialVector, M: list[list[Scalar]], work: Work
) -> None:
    """Fill row and column ``s``: what each speed from part ``k`` to the ground feels of a force."""
    first = True
    while True:
        place = placed[k]
        for n, column in enumerate(place.subspace):
            row = place.part.speeds.start + n
            if first and row > s:
                continue
            entry = dot(column.six, force.six)
            M[row][s] = M[s][row] = add(M[s][s], entry) if row == s else entry
        if place.part.parent < 0:
            return
        force = keep_pair(
            work, ("column", "column"), place.part.name, handed(work, place, force, STILL)
        )
        k, first = place.part.parent, False
