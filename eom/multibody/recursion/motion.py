"""The motion of the parts of a tree by their coordinates and speeds, and what is handed from part to part.

Accelerations are those of points, not spatial ones, so that velocities of origins are not needed; gravity
accelerates the ground upwards. Conventions: vectors of a part are in its axes, at its origin. ``q``,
``u``: coordinates and speeds of the whole tree, in the order of its parts. Scalars are of any kind: see
`eom.multibody.algebra.scalars`. Source: Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 3 to 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from eom.multibody.algebra.scalars import Scalar, Work, add, is_zero, mul, sub
from eom.multibody.algebra.spatial import (
    IDENTITY,
    ZERO,
    Inertia,
    Matrix,
    Rotation,
    SpatialVector,
    Vector,
    back,
    cross,
    dot,
    forward,
    keep_matrix,
    keep_symmetric,
    keep_vector,
    matrix_of,
    minus,
    negative_vector,
    plus,
    product,
    scaled,
    shifted,
    times,
    transposed,
    turned_back,
)
from eom.multibody.recursion.lumped_tree import LumpedTree, Part, last_turn_left_out

Scalars = Sequence[Scalar]
STILL = SpatialVector(ZERO, ZERO)


@dataclass(frozen=True)
class Place:
    """Where a part is on its parent, for given coordinates.

    ``position``: of its origin, in the parent's axes. ``rotation``: to its axes. ``subspace``: what
    each of its speeds adds to its motion.
    """

    part: Part
    position: Vector
    rotation: Rotation
    subspace: tuple[SpatialVector, ...]


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
    relative: SpatialVector
    omega: Vector
    square: Square
    centripetal: Vector
    drift: SpatialVector


def places(tree: LumpedTree, q: Scalars, work: Work) -> list[Place]:
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


def coordinate_rates(tree: LumpedTree, q: Scalars, u: Scalars, work: Work) -> list[Scalar]:
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
                squared(work, part.name, omega),
                keep_vector(work, "zeta", part.name, centripetal),
                part.kind.drift(place.subspace, own),
            )
        )
    return found


def combined(subspace: Sequence[SpatialVector], u: Scalars) -> SpatialVector:
    """Return S u."""
    result = STILL
    for column, speed in zip(subspace, u, strict=True):
        result = SpatialVector(
            plus(result.angular, scaled(speed, column.angular)),
            plus(result.linear, scaled(speed, column.linear)),
        )
    return result


def squared(work: Work, name: str, w: Vector) -> Square:
    """Return the square of an angular velocity, its entries named."""
    squares = [work.keep("square", name, f"{k + 1}{k + 1}", mul(x, x)) for k, x in enumerate(w)]
    pairs = ((1, 2), (2, 0), (0, 1))
    return Square(
        [work.keep("square", name, f"{i + 1}{j + 1}", mul(w[i], w[j])) for i, j in pairs],
        [work.keep("square", name, str(k + 1), add(squares[i], squares[j]))
         for k, (i, j) in enumerate(pairs)],
    )  # fmt: skip


def zeta(place: Place, moving: Moving, turned: Vector | None = None) -> SpatialVector:
    """Return the acceleration by velocities: angular, and linear beside ``turned``.

    Angular: before x relative + drift. Linear: centripetal + (before + omega) x relative velocity +
    drift; ``turned`` is the centripetal one in the part's axes, by default computed here.
    """
    if turned is None:
        turned = forward(place.rotation, moving.centripetal)
    w, v = moving.relative
    angular = plus(cross(moving.before, w), moving.drift.angular)
    sideways = ZERO if all(map(is_zero, v)) else cross(plus(moving.before, moving.omega), v)
    return SpatialVector(angular, plus(plus(turned, sideways), moving.drift.linear))


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


def velocities(placed: Sequence[Place], moved: Sequence[Moving], work: Work) -> list[SpatialVector]:
    """Return angular velocities, and velocities of origins, in the axes of the parts."""
    found: list[SpatialVector] = []
    for place, moving in zip(placed, moved, strict=True):
        w, v = found[place.part.parent] if place.part.parent >= 0 else SpatialVector(ZERO, ZERO)
        carried = forward(place.rotation, plus(v, cross(w, place.position)))
        here = plus(carried, moving.relative.linear)
        found.append(SpatialVector(moving.omega, keep_vector(work, "v", place.part.name, here)))
    return found


def loads(placed: Sequence[Place], work: Work) -> list[SpatialVector]:
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
        found.append(SpatialVector(n, f))
    return found


def flowing(
    found: list[SpatialVector], placed: Sequence[Place], moved: Sequence[Moving], work: Work
) -> list[SpatialVector]:
    """Return moments and forces on the parts less what they take for what flows in them."""
    done = list(found)
    for k, (place, moving) in enumerate(zip(placed, moved, strict=True)):
        for stream in place.part.streams:
            moment, force = stream.needed(moving.omega)
            n, f = (minus(a, b) for a, b in zip(done[k], (moment, force), strict=True))
            done[k] = keep_pair(work, ("n", "f"), f"{place.part.name}", SpatialVector(n, f))
    return done


def attracted(
    gradient: Matrix,
    placed: Sequence[Place],
    posed: Sequence[tuple[Matrix, Vector]],
    work: Work,
) -> list[SpatialVector]:
    """Return moment about its origin and force on each part by the gradient of gravity, in its axes.

    With the gradient G in the part's axes, the field a = G x at its origin, first moment h and inertia J
    about that: force m a + G h, moment h x a + the integral of r x G r dm, whose components are those of
    G J less its transpose.
    """
    found = []
    for place, (R, position) in zip(placed, posed, strict=True):
        part = place.part
        G = keep_symmetric(
            work, "gradient", part.name, product(R, product(gradient, transposed(R)))
        )
        a = keep_vector(work, "field", part.name, times(R, times(gradient, position)))
        A = product(G, part.whole_inertia)
        spread = [sub(A[i][j], A[j][i]) for i, j in ((1, 2), (2, 0), (0, 1))]
        h = part.first_moment
        force = plus(scaled(part.mass, a), times(G, h))
        found.append(SpatialVector(plus(cross(h, a), spread), force))
    return found


def biases(
    placed: Sequence[Place], moved: Sequence[Moving], applied: Sequence[SpatialVector], work: Work
) -> list[SpatialVector]:
    """Return moments and forces that each part alone takes by velocities, less the loads on it."""
    found = []
    for place, moving, load in zip(placed, moved, applied, strict=True):
        n = moving.square.gyroscopic(work, place.part)
        for spin in place.part.rotors:
            n = plus(n, spin.moment(moving.omega))
        f = moving.square.times(place.part.first_moment)
        found.append(
            SpatialVector(
                plus(n, negative_vector(load.angular)), plus(f, negative_vector(load.linear))
            )
        )
    return found


def carrier_of(
    tree: LumpedTree, place: Place, accelerations: Sequence[SpatialVector]
) -> SpatialVector:
    """Return the acceleration of the parent; the ground's is gravity's, upwards."""
    if place.part.parent >= 0:
        return accelerations[place.part.parent]
    return SpatialVector(ZERO, negative_vector(tree.gravity))


def keep_pair(
    work: Work, letters: tuple[str, str], name: str, pair: SpatialVector
) -> SpatialVector:
    """Name the components of both vectors."""
    return SpatialVector(
        *(keep_vector(work, a, name, v) for a, v in zip(letters, pair, strict=True))
    )


def handed(work: Work, place: Place, force: SpatialVector, onto: SpatialVector) -> SpatialVector:
    """Return a force on the parent with that of a part added, turned and shifted to the parent."""
    name = place.part.name
    f = keep_vector(work, "turned_f", name, back(place.rotation, force.linear))
    n = plus(back(place.rotation, force.angular), cross(place.position, f))
    return SpatialVector(plus(onto.angular, n), plus(onto.linear, f))


def keep_inertia(work: Work, letters: str, name: str, A: Inertia) -> Inertia:
    """Name the entries of an inertia; rows of letters are ``letters`` and I, H, M."""
    return Inertia(
        keep_symmetric(work, f"{letters}I", name, A.I),
        keep_matrix(work, f"{letters}H", name, A.H),
        keep_symmetric(work, f"{letters}M", name, A.M),
    )


def inward(work: Work, place: Place, A: Inertia) -> Inertia:
    """Return an inertia at the parent's origin, in its axes."""
    A = turned_back(work, place.part.name, place.rotation, A)
    return shifted(work, place.part.name, place.position, A)
