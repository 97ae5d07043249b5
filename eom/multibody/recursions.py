"""Inverse dynamics by recursive Newton-Euler, and the mass matrix by composite bodies.

Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 5, table 5.1, and ch. 6, table 6.2. Conventions
and scalars: see `eom.multibody.motion`.
"""

from __future__ import annotations

from collections.abc import Sequence

from eom.multibody.links import applied
from eom.multibody.motion import (
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
from eom.multibody.scalars import Scalar, Work, add, mul
from eom.multibody.skeleton import Skeleton
from eom.multibody.spatial import (
    Inertia,
    Pair,
    cross,
    dot,
    forward,
    joined,
    plus,
)


def inverse_dynamics(
    tree: Skeleton, q: Scalars, u: Scalars, udot: Scalars, work: Work
) -> list[Scalar]:
    """Return the generalised forces that accelerations take, loads and gravity acting.

    Recursive Newton-Euler: Featherstone 2008, table 5.1.
    """
    placed = places(tree, q, work)
    moved = motion(placed, u, work)
    forces = biases(placed, moved, applied(tree, placed, moved, work), work)
    for k, (place, here) in enumerate(
        zip(placed, accelerations(tree, placed, moved, udot, work), strict=True)
    ):
        needed = place.part.inertia.times(here)
        forces[k] = Pair(
            plus(forces[k].angular, needed.angular), plus(forces[k].linear, needed.linear)
        )
    return _gathered(placed, forces, udot, work)


def accelerations(
    tree: Skeleton, placed: Sequence[Place], moved: Sequence[Moving], udot: Scalars, work: Work
) -> list[Pair]:
    """Return angular accelerations, and accelerations of origins less gravity's, in the parts' axes."""
    found: list[Pair] = []
    for place, moving in zip(placed, moved, strict=True):
        own = udot[place.part.speeds]
        carrier = carrier_of(tree, place, found)
        carried = plus(
            plus(carrier.linear, cross(carrier.angular, place.position)), moving.centripetal
        )
        known = zeta(place, moving, forward(place.rotation, carried))
        joint = combined(place.subspace, own)
        angular = plus(plus(forward(place.rotation, carrier.angular), known.angular), joint.angular)
        linear = plus(known.linear, joint.linear)
        found.append(keep_pair(work, ("alpha", "a"), place.part.name, Pair(angular, linear)))
    return found


def _gathered(
    placed: Sequence[Place], forces: list[Pair], udot: Scalars, work: Work
) -> list[Scalar]:
    """Return S^T f of each joint, forces handed inwards; ``forces`` are those of single parts."""
    tau: list[Scalar] = [0] * len(udot)
    for k in range(len(placed) - 1, -1, -1):
        place = placed[k]
        part = place.part
        force = keep_pair(work, ("n", "f"), part.name, forces[k])
        for n, column in enumerate(place.subspace):
            s = part.speeds.start + n
            tau[s] = add(dot(column.six, force.six), mul(part.armature[n], udot[s]))
        if part.parent >= 0:
            forces[part.parent] = handed(work, place, force, forces[part.parent])
    return tau


def composites(placed: Sequence[Place], work: Work) -> list[Inertia]:
    """Return the inertia of each part with all that hangs on it, as if it were rigid."""
    whole = [place.part.inertia for place in placed]
    for k in range(len(placed) - 1, -1, -1):
        part = placed[k].part
        whole[k] = keep_inertia(work, "composite_", part.name, whole[k])
        if part.parent >= 0:
            whole[part.parent] = joined(whole[part.parent], inward(work, placed[k], whole[k]))
    return whole


def mass_matrix(tree: Skeleton, q: Scalars, work: Work) -> list[list[Scalar]]:
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
    placed: Sequence[Place], k: int, s: int, force: Pair, M: list[list[Scalar]], work: Work
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
