"""Recursions over the parts of a tree: motion, inverse dynamics, mass matrix, forward dynamics.

Featherstone, Rigid Body Dynamics Algorithms (2008): recursive Newton-Euler (ch. 5, table 5.1),
composite bodies (ch. 6, table 6.2), articulated bodies (ch. 7, table 7.1), prescribed joints (sec. 9.2).
Different from the book: accelerations are those of points, not spatial ones, so that velocities of
origins are not needed; joints of several speeds are eliminated one speed after the other, and no matrix is
inverted; inertias are turned about one axis after the other. Gravity accelerates the ground upwards.

Conventions: vectors of a part are in its axes, at its origin. ``q``, ``u``: coordinates and speeds of
the whole tree, in the order of its parts. Scalars are of any kind: see `eom.multibody.scalars`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from eom.errors import InputError
from eom.multibody.scalars import Scalar, Work, add, is_zero, mul, reciprocal, sub
from eom.multibody.skeleton import Part, Skeleton, last_turn_left_out
from eom.multibody.spatial import (
    IDENTITY,
    ZERO,
    Inertia,
    Matrix,
    Pair,
    Rotation,
    Vector,
    back,
    cross,
    dot,
    forward,
    joined,
    keep_matrix,
    keep_symmetric,
    keep_vector,
    matrix_of,
    negative_vector,
    plus,
    product,
    scaled,
    shifted,
    symmetric,
    times,
    turned_back,
)

Scalars = Sequence[Scalar]
STILL = Pair(ZERO, ZERO)


@dataclass(frozen=True)
class Place:
    """Where a part is on its parent, for given coordinates.

    ``position``: of its origin, in the parent's axes. ``rotation``: to its axes. ``subspace``: what
    each of its speeds adds to its motion.
    """

    part: Part
    position: Vector
    rotation: Rotation
    subspace: tuple[Pair, ...]


@dataclass(frozen=True)
class Square:
    """The matrix omega omega^T - omega^2 1: products w2 w3, w3 w1, w1 w2, and sums of two squares."""

    products: Vector
    sums: Vector

    def times(self, r: Vector) -> Vector:
        """Return omega x (omega x r)."""
        x, y, z = r
        a, b, c = self.products
        rows = ((add(mul(c, y), mul(b, z)), x), (add(mul(c, x), mul(a, z)), y),
                (add(mul(b, x), mul(a, y)), z))  # fmt: skip
        return [sub(off, mul(s, n)) for (off, n), s in zip(rows, self.sums, strict=True)]

    def gyroscopic(self, work: Work, part: Part) -> Vector:
        """Return omega x J omega for the part's J, over the same products."""
        J, w, sums = part.inertia.I, self.products, self.sums
        found = []
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            moment = work.keep("dJ", part.name, str(i + 1), sub(J[k][k], J[j][j]))
            even = add(mul(moment, w[i]), mul(J[j][k], sub(sums[k], sums[j])))
            found.append(add(even, sub(mul(J[i][k], w[k]), mul(J[i][j], w[j]))))
        return found


@dataclass(frozen=True)
class Moving:
    """The motion of a part by velocities alone.

    ``before``: the parent's angular velocity in the part's axes; ``relative``: what the joint adds;
    ``omega``: their sum. ``zeta``: acceleration that velocities alone give it, beyond what is carried
    over from the parent; its part ``centripetal`` is the parent's, in the parent's axes.
    """

    before: Vector
    relative: Pair
    omega: Vector
    square: Square
    centripetal: Vector
    drift: Pair


def places(tree: Skeleton, q: Scalars, work: Work) -> list[Place]:
    """Return where the parts are for given coordinates."""
    found = []
    for part in tree.parts:
        local = part.kind.place(part.setting, q[part.coordinates], work)
        position = plus(part.position, back(part.rotation, local.position))
        turns = last_turn_left_out(local.rotation) if part.spins else local.rotation
        found.append(
            Place(
                part,
                keep_vector(work, "r", part.name, position),
                (*part.rotation, *turns),
                local.subspace,
            )
        )
    return found


def coordinate_rates(tree: Skeleton, q: Scalars, u: Scalars, work: Work) -> list[Scalar]:
    """Return q' = N(q) u of all joints."""
    rates: list[Scalar] = []
    for part in tree.parts:
        own = q[part.coordinates]
        local = part.kind.place(part.setting, own, work)
        rates += part.kind.rates(part.setting, own, u[part.speeds], local)
    return rates


def motion(placed: Sequence[Place], u: Scalars, work: Work) -> list[Moving]:
    """Return angular velocities and accelerations by velocities, from the ground outwards."""
    found: list[Moving] = []
    for place in placed:
        part = place.part
        carrier = found[part.parent] if part.parent >= 0 else None
        before: Vector = ZERO if carrier is None else forward(place.rotation, carrier.omega)
        before = keep_vector(work, "omega_before", part.name, before)
        own = u[part.speeds]
        relative = combined(place.subspace, own)
        omega = keep_vector(work, "omega", part.name, plus(before, relative.angular))
        centripetal = ZERO if carrier is None else carrier.square.times(place.position)
        found.append(
            Moving(
                before,
                relative,
                omega,
                _square(work, part.name, omega),
                keep_vector(work, "zeta", part.name, centripetal),
                part.kind.drift(place.subspace, own),
            )
        )
    return found


def combined(subspace: Sequence[Pair], u: Scalars) -> Pair:
    """Return S u."""
    result = STILL
    for column, speed in zip(subspace, u, strict=True):
        result = Pair(
            plus(result.angular, scaled(speed, column.angular)),
            plus(result.linear, scaled(speed, column.linear)),
        )
    return result


def _square(work: Work, name: str, w: Vector) -> Square:
    squares = [work.keep("square", name, f"{k + 1}{k + 1}", mul(x, x)) for k, x in enumerate(w)]
    pairs = ((1, 2), (2, 0), (0, 1))
    return Square(
        [work.keep("square", name, f"{i + 1}{j + 1}", mul(w[i], w[j])) for i, j in pairs],
        [work.keep("square", name, str(k + 1), add(squares[i], squares[j]))
         for k, (i, j) in enumerate(pairs)],
    )  # fmt: skip


def zeta(place: Place, moving: Moving, turned: Vector | None = None) -> Pair:
    """Return the acceleration by velocities: angular, and linear beside ``turned``.

    Angular: before x relative + drift. Linear: centripetal + (before + omega) x relative velocity +
    drift; ``turned`` is the centripetal one in the part's axes, by default computed here.
    """
    if turned is None:
        turned = forward(place.rotation, moving.centripetal)
    w, v = moving.relative
    angular = plus(cross(moving.before, w), moving.drift.angular)
    sideways = ZERO if all(map(is_zero, v)) else cross(plus(moving.before, moving.omega), v)
    return Pair(angular, plus(plus(turned, sideways), moving.drift.linear))


def poses(placed: Sequence[Place], work: Work) -> list[tuple[Matrix, Vector]]:
    """Return rotations from the ground to each part, and positions of origins in the ground's axes."""
    found: list[tuple[Matrix, Vector]] = []
    for place in placed:
        C, x = found[place.part.parent] if place.part.parent >= 0 else (IDENTITY, ZERO)
        name = place.part.name
        R = keep_matrix(work, "pose", name, product(matrix_of(place.rotation), C))
        step = [dot([row[k] for row in C], place.position) for k in range(3)]
        found.append((R, keep_vector(work, "position", name, plus(x, step))))
    return found


def loads(placed: Sequence[Place], work: Work) -> list[Pair]:
    """Return moment about its origin and force, by applied loads, on each part."""
    pulled = [place.part.pulls for place in placed]
    turned = any(pull.grounded for pulls in pulled for pull in pulls)
    rotations = [R for R, _ in poses(placed, work)] if turned else []
    found = []
    for k, pulls in enumerate(pulled):
        n, f = ZERO, ZERO
        for pull in pulls:
            force, torque = pull.force, pull.torque
            if pull.grounded:
                force, torque = times(rotations[k], force), times(rotations[k], torque)
            force = keep_vector(work, "f", placed[k].part.name, force)
            n, f = plus(n, plus(torque, cross(pull.point, force))), plus(f, force)
        found.append(Pair(n, f))
    return found


def biases(
    placed: Sequence[Place], moved: Sequence[Moving], applied: Sequence[Pair], work: Work
) -> list[Pair]:
    """Return moments and forces that each part alone takes by velocities, less the loads on it."""
    found = []
    for place, moving, load in zip(placed, moved, applied, strict=True):
        n = moving.square.gyroscopic(work, place.part)
        f = moving.square.times(place.part.first_moment)
        found.append(
            Pair(plus(n, negative_vector(load.angular)), plus(f, negative_vector(load.linear)))
        )
    return found


def inverse_dynamics(
    tree: Skeleton, q: Scalars, u: Scalars, udot: Scalars, work: Work
) -> list[Scalar]:
    """Return the generalised forces that accelerations take, loads and gravity acting.

    Recursive Newton-Euler: Featherstone 2008, table 5.1.
    """
    placed = places(tree, q, work)
    moved = motion(placed, u, work)
    forces = biases(placed, moved, loads(placed, work), work)
    accelerations: list[Pair] = []
    for k, (place, moving) in enumerate(zip(placed, moved, strict=True)):
        own = udot[place.part.speeds]
        carrier = _carrier(tree, place, accelerations)
        carried = plus(
            plus(carrier.linear, cross(carrier.angular, place.position)), moving.centripetal
        )
        known = zeta(place, moving, forward(place.rotation, carried))
        joint = combined(place.subspace, own)
        angular = plus(plus(forward(place.rotation, carrier.angular), known.angular), joint.angular)
        linear = plus(known.linear, joint.linear)
        here = _kept_pair(work, ("alpha", "a"), place.part.name, Pair(angular, linear))
        accelerations.append(here)
        needed = place.part.inertia.times(here)
        forces[k] = Pair(
            plus(forces[k].angular, needed.angular), plus(forces[k].linear, needed.linear)
        )
    return _gathered(placed, forces, udot, work)


def _carrier(tree: Skeleton, place: Place, accelerations: Sequence[Pair]) -> Pair:
    if place.part.parent >= 0:
        return accelerations[place.part.parent]
    return Pair(ZERO, negative_vector(tree.gravity))


def _kept_pair(work: Work, letters: tuple[str, str], name: str, pair: Pair) -> Pair:
    return Pair(*(keep_vector(work, a, name, v) for a, v in zip(letters, pair, strict=True)))


def _gathered(
    placed: Sequence[Place], forces: list[Pair], udot: Scalars, work: Work
) -> list[Scalar]:
    """Return S^T f of each joint, forces handed inwards; ``forces`` are those of single parts."""
    tau: list[Scalar] = [0] * len(udot)
    for k in range(len(placed) - 1, -1, -1):
        place = placed[k]
        part = place.part
        force = _kept_pair(work, ("n", "f"), part.name, forces[k])
        for n, column in enumerate(place.subspace):
            s = part.speeds.start + n
            tau[s] = add(dot(column.six, force.six), mul(part.armature[n], udot[s]))
        if part.parent >= 0:
            forces[part.parent] = _handed(work, place, force, forces[part.parent])
    return tau


def _handed(work: Work, place: Place, force: Pair, onto: Pair) -> Pair:
    """Return a force on the parent with that of a part added, turned and shifted to the parent."""
    name = place.part.name
    f = keep_vector(work, "turned_f", name, back(place.rotation, force.linear))
    n = plus(back(place.rotation, force.angular), cross(place.position, f))
    return Pair(plus(onto.angular, n), plus(onto.linear, f))


def composites(placed: Sequence[Place], work: Work) -> list[Inertia]:
    """Return the inertia of each part with all that hangs on it, as if it were rigid."""
    whole = [place.part.inertia for place in placed]
    for k in range(len(placed) - 1, -1, -1):
        part = placed[k].part
        whole[k] = _kept_inertia(work, "composite_", part.name, whole[k])
        if part.parent >= 0:
            whole[part.parent] = joined(whole[part.parent], _inward(work, placed[k], whole[k]))
    return whole


def _kept_inertia(work: Work, letters: str, name: str, A: Inertia) -> Inertia:
    return Inertia(
        keep_symmetric(work, f"{letters}I", name, A.I),
        keep_matrix(work, f"{letters}H", name, A.H),
        keep_symmetric(work, f"{letters}M", name, A.M),
    )


def _inward(work: Work, place: Place, A: Inertia) -> Inertia:
    """Return an inertia at the parent's origin, in its axes."""
    A = turned_back(work, place.part.name, place.rotation, A)
    return shifted(work, place.part.name, place.position, A)


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
            force = _kept_pair(work, ("column", "column"), place.part.name, whole[k].times(column))
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
        force = _kept_pair(
            work, ("column", "column"), place.part.name, _handed(work, place, force, STILL)
        )
        k, first = place.part.parent, False


@dataclass(frozen=True)
class Step:
    """One speed eliminated: number, column of S, U = I s, the reciprocal of s^T I s, what drives it."""

    speed: int
    column: Pair
    U: list[Scalar]
    inverse: Scalar
    drive: Scalar


def forward_dynamics(
    tree: Skeleton,
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
    forces = biases(placed, moved, loads(placed, work), work)
    known = [_kept_pair(work, ("zeta", "zeta"), p.part.name, zeta(p, m))
             for p, m in zip(placed, moved, strict=True)]  # fmt: skip
    given = dict(prescribed or {})
    steps = _inwards(placed, known, forces, tau, given, work)
    return _outwards(tree, placed, known, steps, given, work)


def _inwards(
    placed: Sequence[Place],
    known: list[Pair],
    forces: list[Pair],
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
        A = _kept_inertia(work, "", part.name, inertias[k])
        force = _kept_pair(work, ("n_bias", "f_bias"), part.name, forces[k])
        if part.driven:
            known[k] = _driven(place, known[k], given)
        else:
            A, force = _eliminated(place, A, force, tau, steps[k], work)
        if part.parent >= 0:
            carried = A.times(known[k])
            force = Pair(plus(force.angular, carried.angular), plus(force.linear, carried.linear))
            force = _kept_pair(work, ("n_free", "f_free"), part.name, force)
            forces[part.parent] = _handed(work, place, force, forces[part.parent])
            inertias[part.parent] = joined(inertias[part.parent], _inward(work, place, A))
    return steps


def _driven(place: Place, known: Pair, given: Mapping[int, Scalar]) -> Pair:
    first = place.part.speeds.start
    joint = combined(place.subspace, [given[first + n] for n in range(len(place.subspace))])
    return Pair(plus(known.angular, joint.angular), plus(known.linear, joint.linear))


def _eliminated(
    place: Place, A: Inertia, force: Pair, tau: Scalars, steps: list[Step], work: Work
) -> tuple[Inertia, Pair]:
    """Free an inertia and a force of a joint, one speed after the other, the last of them first."""
    part = place.part
    for n in range(len(place.subspace) - 1, -1, -1):
        column = place.subspace[n]
        s = part.speeds.start + n
        U = A.times(column)
        U = _kept_pair(work, ("U", "U"), part.name, U)
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
    work: Work, part: Part, A: Inertia, force: Pair, step: Step, tau: Scalar
) -> tuple[Inertia, Pair]:
    """Return A - U U^T / D and p + U drive / D: along a free axis, zero and the applied force."""
    armed = not is_zero(part.armature[step.speed - part.speeds.start])
    unit = None if armed else _unit(step.column)
    K = [0 if k == unit else x for k, x in enumerate(scaled(step.inverse, step.U))]
    K = [work.keep("ratio", part.name, str(k + 1), x) for k, x in enumerate(K)]
    freed = [add(x, mul(step.drive, k)) for x, k in zip(force.six, K, strict=True)]
    if unit is not None:
        freed[unit] = mul(step.column.six[unit], tau)
    force = _kept_pair(work, ("n_bias", "f_bias"), part.name, Pair(freed[:3], freed[3:]))
    return _kept_inertia(work, "", part.name, _less(A, step.U, K, unit)), force


def _unit(column: Pair) -> int | None:
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
    tree: Skeleton,
    placed: Sequence[Place],
    known: Sequence[Pair],
    steps: Sequence[Sequence[Step]],
    given: Mapping[int, Scalar],
    work: Work,
) -> list[Scalar]:
    """Return the accelerations, from the ground to the ends."""
    found: list[Scalar] = [0] * tree.speeds
    for s, value in given.items():
        found[s] = value
    accelerations: list[Pair] = []
    for place, velocity, eliminated in zip(placed, known, steps, strict=True):
        name = place.part.name
        carrier = _carrier(tree, place, accelerations)
        linear = plus(carrier.linear, cross(carrier.angular, place.position))
        here = Pair(
            plus(forward(place.rotation, carrier.angular), velocity.angular),
            plus(forward(place.rotation, linear), velocity.linear),
        )
        here = _kept_pair(work, ("alpha_in", "a_in"), name, here)
        for step in reversed(eliminated):
            free = sub(step.drive, dot(step.U, here.six))
            value = work.keep("acceleration", name, "", mul(step.inverse, free))
            found[step.speed] = value
            joint = combined((step.column,), (value,))
            here = Pair(plus(here.angular, joint.angular), plus(here.linear, joint.linear))
            here = _kept_pair(work, ("alpha", "a"), name, here)
        accelerations.append(here)
    return found
