"""Forward dynamics of a chain of revolute joints by the articulated-body algorithm.

Featherstone, Rigid Body Dynamics Algorithms (2008), ch. 7, table 7.1, over scalars of any kind: floats,
CasADi's, or those of `codegen.scalars`. A spatial vector is a pair of triples (angular, linear), at
the joint of its body; a spatial inertia is three blocks ((I, H), (H^T, M)), I and M symmetric.
What is zero or one in the model, the scalars' own arithmetic leaves out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

Scalar = Any
Vector = list[Scalar]
Matrix = list[Vector]
Function = Callable[[Scalar], Scalar]

GRAVITY = 9.81


@dataclass(frozen=True)
class Body:
    """A link: where its joint is on the link before, and its mass properties.

    ``turn``: fixed rotation, components before the joint from those on the link before. ``offset``: of
    the joint, on the link before (m). ``centre``: of mass, from the joint (m). ``inertia``: about the
    centre of mass (kg m^2). The joint turns about the third axis.
    """

    turn: tuple[tuple[float, ...], ...]
    offset: tuple[float, ...]
    mass: float
    centre: tuple[float, ...]
    inertia: tuple[tuple[float, ...], ...]


def chain(count: int) -> tuple[Body, ...]:
    """Return an arm of ``count`` links whose joint axes are at right angles to their neighbours'.

    All other numbers are of no special value, so that nothing of them is folded away.
    """
    turns = (((1, 0, 0), (0, 0, 1), (0, -1, 0)), ((1, 0, 0), (0, 0, -1), (0, 1, 0)))

    def body(k: int) -> Body:
        a, b = 0.03 * (k % 5), 0.02 * (k % 7)
        inertia = ((0.5 + a, 0.01 + b, 0.02), (0.01 + b, 0.6 - a, 0.03), (0.02, 0.03, 0.7 + b))
        return Body(
            turns[k % 2],
            (0.05 + a, -0.04 - b, 0.3 + a * b),
            1.5 + a - b,
            (0.04 - b, 0.03 + a, 0.15 + b),
            inertia,
        )

    return tuple(body(k) for k in range(count))


def dot(a: Sequence[Scalar], b: Sequence[Scalar]) -> Scalar:
    """Return the sum of products."""
    total = a[0] * b[0]
    for x, y in zip(a[1:], b[1:], strict=True):
        total = total + x * y
    return total


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def plus(a: Vector, b: Vector) -> Vector:
    """Return the sum of vectors."""
    return [x + y for x, y in zip(a, b, strict=True)]


def minus(a: Vector, b: Vector) -> Vector:
    """Return the difference of vectors."""
    return [x - y for x, y in zip(a, b, strict=True)]


def transposed(A: Sequence[Sequence[Scalar]]) -> Matrix:
    """Return the transpose."""
    return [list(column) for column in zip(*A, strict=True)]


def times(A: Sequence[Sequence[Scalar]], b: Sequence[Scalar]) -> Vector:
    """Return matrix times vector."""
    return [dot(row, b) for row in A]


def product(A: Sequence[Sequence[Scalar]], B: Sequence[Sequence[Scalar]]) -> Matrix:
    """Return matrix times matrix."""
    columns = transposed(B)
    return [[dot(row, column) for column in columns] for row in A]


def conjugated(E: Matrix, A: Matrix) -> Matrix:
    """Return E^T A E of a symmetric A; each entry is computed once."""
    AE, columns = product(A, E), transposed(E)
    upper = {(i, j): dot(columns[i], [row[j] for row in AE]) for i in range(3) for j in range(i, 3)}
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def across(r: Sequence[Scalar], A: Matrix) -> Matrix:
    """Return the vector product of ``r`` with each column."""
    return transposed([cross(list(r), column) for column in transposed(A)])


@dataclass
class Link:
    """What the passes know of one body, in its own axes."""

    E: Matrix
    w: Vector
    v: Vector
    bias: tuple[Vector, Vector]
    I: Matrix
    H: Matrix
    M: Matrix
    force: tuple[Vector, Vector]


def accelerations(
    bodies: Sequence[Body],
    q: Sequence[Scalar],
    rates: Sequence[Scalar],
    torques: Sequence[Scalar],
    sin: Function,
    cos: Function,
) -> list[Scalar]:
    """Return the joint accelerations (rad/s^2) of angles, rates and torques; gravity is along -3."""
    links: list[Link] = []
    for body, angle, rate in zip(bodies, q, rates, strict=True):
        before = links[-1] if links else None
        links.append(_outward(body, before, sin(angle), cos(angle), rate))
    solved = _inward(bodies, links, torques)
    a: tuple[Vector, Vector] = ([0, 0, 0], [0, 0, GRAVITY])
    result = []
    for body, link, (U, inverse, u) in zip(bodies, links, solved, strict=True):
        angular, linear = _moved(link.E, body.offset, a)
        angular, linear = plus(angular, link.bias[0]), plus(linear, link.bias[1])
        acceleration = inverse * (u - dot(U, [*angular, *linear]))
        result.append(acceleration)
        a = ([*angular[:2], angular[2] + acceleration], linear)
    return result


def _outward(body: Body, before: Link | None, s: Scalar, c: Scalar, rate: Scalar) -> Link:
    E = product([[c, s, 0], [-s, c, 0], [0, 0, 1]], body.turn)
    w, v = ([0, 0, 0], [0, 0, 0]) if before is None else (before.w, before.v)
    w, v = _moved(E, body.offset, (w, v))
    w = [w[0], w[1], w[2] + rate]
    bias = ([w[1] * rate, -w[0] * rate, 0], [v[1] * rate, -v[0] * rate, 0])
    I, H, M = _inertia(body)
    momentum = plus(times(I, w), times(H, v)), plus(times(transposed(H), w), times(M, v))
    force = plus(cross(w, momentum[0]), cross(v, momentum[1])), cross(w, momentum[1])
    return Link(E, w, v, bias, I, H, M, force)


def _moved(E: Matrix, r: Sequence[Scalar], motion: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
    """Return a motion vector of the link before at the joint and in the axes of this one."""
    w, v = motion
    return times(E, w), times(E, plus(v, cross(w, list(r))))


def _inertia(body: Body) -> tuple[Matrix, Matrix, Matrix]:
    """Return the blocks of the spatial inertia at the joint; plain numbers."""
    m, c = body.mass, body.centre
    moment = [m * x for x in c]
    H = [[0, -moment[2], moment[1]], [moment[2], 0, -moment[0]], [-moment[1], moment[0], 0]]
    square = dot(c, c)
    I = [
        [body.inertia[i][j] + m * ((square if i == j else 0) - c[i] * c[j]) for j in range(3)]
        for i in range(3)
    ]
    return I, H, [[m, 0, 0], [0, m, 0], [0, 0, m]]


def _inward(
    bodies: Sequence[Body], links: list[Link], torques: Sequence[Scalar]
) -> list[tuple[Vector, Scalar, Scalar]]:
    """Return U = I^A s, 1 / D and u = torque - s p^A of each joint; inertias grow on the way."""
    solved = []
    for k in range(len(links) - 1, -1, -1):
        link = links[k]
        U = [*(row[2] for row in link.I), *link.H[2]]
        inverse = 1 / U[2]
        u = torques[k] - link.force[0][2]
        solved.append((U, inverse, u))
        if k:
            _hand_over(links[k - 1], link, bodies[k].offset, U, inverse, u)
    return solved[::-1]


def _hand_over(
    before: Link, link: Link, r: Sequence[Scalar], U: Vector, inverse: Scalar, u: Scalar
) -> None:
    """Add a link's inertia and bias force, free of its joint, to those of the link before."""
    scaled = [inverse * x for x in U]
    # the third axis carries no torque of its own: I_i3 = H_3i = 0
    I = _less(link.I, U[:3], scaled[:3], 2)
    H = [[link.H[i][j] - U[i] * scaled[3 + j] if i < 2 else 0 for j in range(3)] for i in range(3)]
    M = _less(link.M, U[3:], scaled[3:], 3)
    angular, linear = link.bias
    n = plus(times(I, angular), times(H, linear))
    f = plus(times(transposed(H), angular), times(M, linear))
    n = [link.force[0][k] + n[k] + scaled[k] * u for k in range(3)]
    f = [link.force[1][k] + f[k] + scaled[3 + k] * u for k in range(3)]
    back = transposed(link.E)
    n, f = times(back, n), times(back, f)
    before.force = (plus(before.force[0], plus(n, cross(list(r), f))), plus(before.force[1], f))
    _add_inertia(before, link.E, r, I, H, M)


def _less(A: Matrix, u: Vector, scaled: Vector, size: int) -> Matrix:
    """Return A - u scaled^T, symmetric, of which only ``size`` rows and columns are not zero."""
    upper = {
        (i, j): A[i][j] - u[i] * scaled[j] if j < size else 0 for i in range(3) for j in range(i, 3)
    }
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def _add_inertia(
    before: Link, E: Matrix, r: Sequence[Scalar], I: Matrix, H: Matrix, M: Matrix
) -> None:
    """Turn and shift an inertia to the axes of the link before, and add it there."""
    I, M = conjugated(E, I), conjugated(E, M)
    H = product(transposed(E), product(H, E))
    shifted = [plus(a, b) for a, b in zip(H, across(r, M), strict=True)]
    first = across(r, transposed(H))
    second = across(r, transposed(shifted))
    I = [[I[i][j] + first[i][j] + second[j][i] for j in range(3)] for i in range(3)]
    for i in range(3):
        for j in range(i):
            I[i][j] = I[j][i]
    before.I = [plus(a, b) for a, b in zip(before.I, I, strict=True)]
    before.H = [plus(a, b) for a, b in zip(before.H, shifted, strict=True)]
    before.M = [plus(a, b) for a, b in zip(before.M, M, strict=True)]
