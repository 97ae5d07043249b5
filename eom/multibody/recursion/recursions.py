"""Inverse dynamics by recursive Newton-Euler, and the mass matrix by composite bodies.

Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 5, table 5.1, and ch. 6, table 6.2. Conventions
and scalars: see `eom.multibody.recursion.motion`.

Forward dynamics by articulated bodies.

Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 7, table 7.1; prescribed joints, sec. 9.2.
Different from the book: joints of several speeds are eliminated one speed after the other, so that no
matrix is inverted; along a free axis an inertia is zero by structure. Conventions and scalars: see
`eom.multibody.recursion.motion`.

Springs and dampers between points of two bodies, or of a body and the ground.

The force acts along the line between the points: tension k (l - l0) + c l', with the distance l. Where l0
and c are zero by structure no root is taken, and the points may coincide.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eom.errors import InputError
from eom.multibody.algebra.scalars import Scalar, Work, add, is_zero, mul, negative, reciprocal, sub
from eom.multibody.algebra.spatial import (
    ZERO,
    Inertia,
    Matrix,
    SpatialVector,
    Vector,
    cross,
    dot,
    forward,
    joined,
    keep_vector,
    minus,
    negative_vector,
    plus,
    scaled,
    symmetric,
    times,
    transposed,
)
from eom.multibody.recursion.lumped_tree import LumpedTree, Part, SpringDamper
from eom.multibody.recursion.motion import (
    STILL,
    Moving,
    Place,
    Scalars,
    attracted,
    biases,
    carrier_of,
    combined,
    flowing,
    handed,
    inward,
    keep_inertia,
    keep_pair,
    loads,
    motion,
    places,
    poses,
    velocities,
    zeta,
)


@dataclass(frozen=True)
class End:
    """A point in motion: position and velocity in the ground's axes; the rotation to its part's."""

    position: Vector
    velocity: Vector
    rotation: Matrix | None


def applied(
    tree: LumpedTree, placed: Sequence[Place], moved: Sequence[Moving], work: Work
) -> list[SpatialVector]:
    """Return moment about its origin and force, by loads, jets, links and uneven gravity, on each part."""
    found = flowing(loads(placed, work), placed, moved, work)
    if not tree.links and tree.gradient is None:
        return found
    posed, speeds = poses(placed, work), velocities(placed, moved, work)
    if tree.gradient is not None:
        pulled = attracted(tree.gradient, placed, posed, work)
        found = [
            SpatialVector(plus(one.angular, two.angular), plus(one.linear, two.linear))
            for one, two in zip(found, pulled, strict=True)
        ]
    for link in tree.links:
        first, second = (end(link, n, posed, speeds, work) for n in (0, 1))
        tension = keep_vector(work, "f", link.name, pull(link, first, second, work))
        for n, (own, force) in enumerate(((first, tension), (second, negative_vector(tension)))):
            part, point = link.parts[n], link.points[n]
            if own.rotation is not None:
                here = times(own.rotation, force)
                n_old, f_old = found[part]
                found[part] = SpatialVector(plus(n_old, cross(point, here)), plus(f_old, here))
    return found


def end(
    link: SpringDamper,
    n: int,
    posed: Sequence[tuple[Matrix, Vector]],
    speeds: Sequence[SpatialVector],
    work: Work,
) -> End:
    """Return the first (0) or second (1) end of a link."""
    part, point = link.parts[n], link.points[n]
    name = f"{link.name}_{n + 1}"
    if part < 0:
        return End(point, ZERO, None)
    (R, x), (w, v) = posed[part], speeds[part]
    back = transposed(R)
    position = keep_vector(work, "position", name, plus(x, times(back, point)))
    return End(position, times(back, plus(v, cross(w, point))), R)


def distance(link: SpringDamper, first: End, second: End, work: Work) -> Scalar:
    """Return the distance of the points."""
    d = _line(link, first, second, work)
    return work.keep("distance", link.name, "", work.sqrt(dot(d, d)))


def _line(link: SpringDamper, first: End, second: End, work: Work) -> Vector:
    return keep_vector(work, "line", link.name, minus(second.position, first.position))


def pull(link: SpringDamper, first: End, second: End, work: Work) -> Vector:
    """Return the force on the first point, in the ground's axes."""
    d = _line(link, first, second, work)
    if link.plain:
        return scaled(link.stiffness, d)
    length = distance(link, first, second, work)
    inverse = work.keep("inverse", link.name, "", reciprocal(length))
    tension = mul(link.stiffness, sub(length, link.length))
    if not is_zero(link.damping):
        rate = mul(inverse, dot(d, minus(second.velocity, first.velocity)))
        tension = add(tension, mul(link.damping, rate))
    return scaled(work.keep("tension", link.name, "", mul(inverse, tension)), d)


def twice_potential(link: SpringDamper, first: End, second: End, work: Work) -> Scalar:
    """Return twice the energy of the spring, zero where it is slack."""
    if link.plain:
        d = _line(link, first, second, work)
        return mul(link.stiffness, dot(d, d))
    length = distance(link, first, second, work)
    stretch = work.keep("stretch", link.name, "", add(length, negative(link.length)))
    return mul(link.stiffness, mul(stretch, stretch))


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
        made = SpatialVector(angular, linear)
        found.append(keep_pair(work, ("alpha", "a"), place.part.name, made))
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
