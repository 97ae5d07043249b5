"""Forward dynamics by articulated bodies.

Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 7, table 7.1; prescribed joints, sec. 9.2.
Different from the book: joints of several speeds are eliminated one speed after the other, so that no
matrix is inverted; along a free axis an inertia is zero by structure. Conventions and scalars: see
`eom.multibody.recursion.motion`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eom.errors import InputError
from eom.multibody.algebra.scalars import Scalar, Work, add, is_zero, mul, reciprocal, sub
from eom.multibody.algebra.spatial import (
    Inertia,
    Matrix,
    SpatialVector,
    cross,
    dot,
    forward,
    joined,
    plus,
    scaled,
    symmetric,
)
from eom.multibody.recursion.lumped_tree import LumpedTree, Part
from eom.multibody.recursion.motion import (
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


@dataclass(frozen=True)
class Step:
    """One speed eliminated: number, column of S, U = I s, the reciprocal of s^T I s, what drives it."""

    speed: int
    column: SpatialVector
    U: list[Scalar]
    inverse: Scalar
    drive: Scalar


def forward_dynamics(
    tree: LumpedTree,
    q: Scalars,
    u: Scalars,
    tau: Scalars,
    work: Work,
    prescribed: Mapping[int, Scalar] | None = None,
) -> list[Scalar]:
    """Return the accelerations of the speeds, loads and gravity acting; articulated bodies, table 7.1.

    ``tau``: generalised forces. ``prescribed``: accelerations of the speeds of driven joints.
    Raises `InputError` for a joint that accelerates no inertia, by structure.
    """
    placed = places(tree, q, work)
    moved = motion(placed, u, work)
    forces = biases(placed, moved, applied(tree, placed, moved, work), work)
    known = [keep_pair(work, ("zeta", "zeta"), p.part.name, zeta(p, m))
             for p, m in zip(placed, moved, strict=True)]  # fmt: skip
    given = dict(prescribed or {})
    steps = _inwards(placed, known, forces, tau, given, work)
    return _outwards(tree, placed, known, steps, given, work)


def _inwards(
    placed: Sequence[Place],
    known: list[SpatialVector],
    forces: list[SpatialVector],
    tau: Scalars,
    given: Mapping[int, Scalar],
    work: Work,
) -> list[list[Step]]:
    """Eliminate the speeds from the ends of the tree to the ground."""
    inertias = [place.part.inertia for place in placed]
    steps: list[list[Step]] = [[] for _ in placed]
    for k in range(len(placed) - 1, -1, -1):
        place = placed[k]
        part = place.part
        A = keep_inertia(work, "", part.name, inertias[k])
        force = keep_pair(work, ("n_bias", "f_bias"), part.name, forces[k])
        if part.driven:
            known[k] = _driven(place, known[k], given)
        else:
            A, force = _eliminated(place, A, force, tau, steps[k], work)
        if part.parent >= 0:
            carried = A.times(known[k])
            force = SpatialVector(
                plus(force.angular, carried.angular), plus(force.linear, carried.linear)
            )
            force = keep_pair(work, ("n_free", "f_free"), part.name, force)
            forces[part.parent] = handed(work, place, force, forces[part.parent])
            inertias[part.parent] = joined(inertias[part.parent], inward(work, place, A))
    return steps


def _driven(place: Place, known: SpatialVector, given: Mapping[int, Scalar]) -> SpatialVector:
    first = place.part.speeds.start
    joint = combined(place.subspace, [given[first + n] for n in range(len(place.subspace))])
    return SpatialVector(plus(known.angular, joint.angular), plus(known.linear, joint.linear))


def _eliminated(
    place: Place, A: Inertia, force: SpatialVector, tau: Scalars, steps: list[Step], work: Work
) -> tuple[Inertia, SpatialVector]:
    """Free an inertia and a force of a joint, one speed after the other, the last of them first."""
    part = place.part
    for n in range(len(place.subspace) - 1, -1, -1):
        column = place.subspace[n]
        s = part.speeds.start + n
        U = A.times(column)
        U = keep_pair(work, ("U", "U"), part.name, U)
        moved = add(dot(column.six, U.six), part.armature[n])
        if is_zero(moved):
            raise InputError("the joint accelerates no inertia", where=f"joint {part.joint!r}")
        inverse = work.keep("inverse", part.name, "", reciprocal(moved))
        drive = work.keep("drive", part.name, "", sub(tau[s], dot(column.six, force.six)))
        steps.append(Step(s, column, U.six, inverse, drive))
        if part.parent < 0 and n == 0:
            return A, force
        A, force = _freed(work, part, A, force, steps[-1], tau[s])
    return A, force


def _freed(
    work: Work, part: Part, A: Inertia, force: SpatialVector, step: Step, tau: Scalar
) -> tuple[Inertia, SpatialVector]:
    """Return A - U U^T / D and p + U drive / D: along a free axis, zero and the applied force."""
    armed = not is_zero(part.armature[step.speed - part.speeds.start])
    unit = None if armed else _unit(step.column)
    K = [0 if k == unit else x for k, x in enumerate(scaled(step.inverse, step.U))]
    K = [work.keep("ratio", part.name, str(k + 1), x) for k, x in enumerate(K)]
    freed = [add(x, mul(step.drive, k)) for x, k in zip(force.six, K, strict=True)]
    if unit is not None:
        freed[unit] = mul(step.column.six[unit], tau)
    force = keep_pair(work, ("n_bias", "f_bias"), part.name, SpatialVector(freed[:3], freed[3:]))
    return keep_inertia(work, "", part.name, _less(A, step.U, K, unit)), force


def _unit(column: SpatialVector) -> int | None:
    """Return the number of the component of a column along one axis, if it is that."""
    rest = [k for k, x in enumerate(column.six) if not is_zero(x)]
    return rest[0] if len(rest) == 1 and column.six[rest[0]] in {1, -1} else None


def _less(A: Inertia, U: list[Scalar], K: list[Scalar], unit: int | None) -> Inertia:
    """Return A - U K^T; the row and column along a free axis are zero by structure."""

    def entry(B: Matrix, i: int, j: int, row: int, column: int) -> Scalar:
        if unit in {row, column}:
            return 0
        return sub(B[i][j], mul(U[row], K[column]))

    upper = [(i, j) for i in range(3) for j in range(i, 3)]
    return Inertia(
        symmetric({(i, j): entry(A.I, i, j, i, j) for i, j in upper}),
        [[entry(A.H, i, j, i, j + 3) for j in range(3)] for i in range(3)],
        symmetric({(i, j): entry(A.M, i, j, i + 3, j + 3) for i, j in upper}),
    )


def _outwards(
    tree: LumpedTree,
    placed: Sequence[Place],
    known: Sequence[SpatialVector],
    steps: Sequence[Sequence[Step]],
    given: Mapping[int, Scalar],
    work: Work,
) -> list[Scalar]:
    """Return the accelerations, from the ground to the ends."""
    found: list[Scalar] = [0] * tree.speeds
    for s, value in given.items():
        found[s] = value
    accelerations: list[SpatialVector] = []
    for place, velocity, eliminated in zip(placed, known, steps, strict=True):
        name = place.part.name
        carrier = carrier_of(tree, place, accelerations)
        linear = plus(carrier.linear, cross(carrier.angular, place.position))
        here = SpatialVector(
            plus(forward(place.rotation, carrier.angular), velocity.angular),
            plus(forward(place.rotation, linear), velocity.linear),
        )
        here = keep_pair(work, ("alpha_in", "a_in"), name, here)
        for step in reversed(eliminated):
            free = sub(step.drive, dot(step.U, here.six))
            value = work.keep("acceleration", name, "", mul(step.inverse, free))
            found[step.speed] = value
            joint = combined((step.column,), (value,))
            here = SpatialVector(plus(here.angular, joint.angular), plus(here.linear, joint.linear))
            here = keep_pair(work, ("alpha", "a"), name, here)
        accelerations.append(here)
    return found
