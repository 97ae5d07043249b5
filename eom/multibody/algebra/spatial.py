"""Vectors, rotations and inertias of bodies over scalars of any kind, as plain lists.

A pair of vectors (angular, linear) at the origin of a frame, in its axes, stands for a motion (angular
acceleration, acceleration of the origin) or a force (moment about the origin, force). An inertia is three
blocks: moment = I alpha + H a, force = H^T alpha + M a, with I and M symmetric.
Source: Featherstone, Rigid Body Dynamics Algorithms (2008), sec. 2.7 to 2.13, but with accelerations of
points instead of spatial ones: velocities of origins are then not needed (see `recursions`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from eom.multibody.algebra.scalars import Scalar, Work, add, is_zero, mul, negative, sub, total

Vector = Sequence[Scalar]
Matrix = Sequence[Sequence[Scalar]]

ZERO: Vector = (0, 0, 0)
IDENTITY: Matrix = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
ZEROS: Matrix = (ZERO, ZERO, ZERO)
_UPPER = tuple((i, j) for i in range(3) for j in range(i, 3))


class SpatialVector(NamedTuple):
    """A motion or a force: (angular, linear)."""

    angular: Vector
    linear: Vector

    @property
    def six(self) -> list[Scalar]:
        """The six components, angular first."""
        return [*self.angular, *self.linear]


class Inertia(NamedTuple):
    """The blocks ((I, H), (H^T, M)) of the inertia of a body, or of all that hangs on it."""

    I: Matrix
    H: Matrix
    M: Matrix

    def row(self, k: int) -> list[Scalar]:
        """Return row ``k`` of the six by six matrix."""
        if k < 3:
            return [*self.I[k], *self.H[k]]
        return [*(row[k - 3] for row in self.H), *self.M[k - 3]]

    def times(self, motion: SpatialVector) -> SpatialVector:
        """Return the force that a motion takes."""
        w, v = motion
        return SpatialVector(
            plus(times(self.I, w), times(self.H, v)),
            plus(times(transposed(self.H), w), times(self.M, v)),
        )


NOTHING = Inertia((ZERO,) * 3, (ZERO,) * 3, (ZERO,) * 3)


def dot(a: Vector, b: Vector) -> Scalar:
    """Return the sum of products."""
    return total(mul(x, y) for x, y in zip(a, b, strict=True))


def plus(a: Vector, b: Vector) -> Vector:
    """Return the sum of vectors."""
    return [add(x, y) for x, y in zip(a, b, strict=True)]


def minus(a: Vector, b: Vector) -> Vector:
    """Return the difference of vectors."""
    return [sub(x, y) for x, y in zip(a, b, strict=True)]


def scaled(factor: Scalar, a: Vector) -> Vector:
    """Return a number times a vector."""
    return [mul(factor, x) for x in a]


def negative_vector(a: Vector) -> Vector:
    """Return the opposite vector."""
    return [negative(x) for x in a]


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return [sub(mul(a[i], b[j]), mul(a[j], b[i])) for i, j in ((1, 2), (2, 0), (0, 1))]


def transposed(A: Matrix) -> Matrix:
    """Return the transpose."""
    return [list(column) for column in zip(*A, strict=True)]


def times(A: Matrix, b: Vector) -> Vector:
    """Return matrix times vector."""
    return [dot(row, b) for row in A]


def product(A: Matrix, B: Matrix) -> Matrix:
    """Return matrix times matrix."""
    columns = transposed(B)
    return [[dot(row, column) for column in columns] for row in A]


def trace(A: Matrix) -> Scalar:
    """Return the sum of the diagonal."""
    return add(add(A[0][0], A[1][1]), A[2][2])


def matrix_sum(A: Matrix, B: Matrix) -> Matrix:
    """Return the sum of matrices."""
    return [plus(a, b) for a, b in zip(A, B, strict=True)]


def skew(a: Vector) -> Matrix:
    """Return the matrix of the vector product by ``a`` from the left."""
    x, y, z = a
    return [[0, negative(z), y], [z, 0, negative(x)], [negative(y), x, 0]]


def symmetric(upper: dict[tuple[int, int], Scalar]) -> Matrix:
    """Return the symmetric matrix with the given entries on and above the diagonal."""
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def keep_vector(work: Work, letter: str, part: str, v: Vector) -> Vector:
    """Name the components of a vector: suffixes 1 to 3."""
    return [work.keep(letter, part, str(k + 1), x) for k, x in enumerate(v)]


def keep_symmetric(work: Work, letter: str, part: str, A: Matrix) -> Matrix:
    """Name the entries of a symmetric matrix."""
    return symmetric(
        {(i, j): work.keep(letter, part, f"{i + 1}{j + 1}", A[i][j]) for i, j in _UPPER}
    )


def keep_matrix(work: Work, letter: str, part: str, A: Matrix) -> Matrix:
    """Name the entries of a matrix."""
    return [
        [work.keep(letter, part, f"{i + 1}{j + 1}", x) for j, x in enumerate(row)]
        for i, row in enumerate(A)
    ]


@dataclass(frozen=True)
class Turn:
    """A turn about a coordinate axis (0, 1, 2) by an angle with that sine and cosine.

    ``forward`` takes components before the turn to components after it, as ``C_BA`` takes those in A
    to those in B; ``back`` is its inverse.
    """

    axis: int
    sine: Scalar
    cosine: Scalar

    @property
    def plane(self) -> tuple[int, int]:
        """The two axes that turn, the second a right angle after the first."""
        return (self.axis + 1) % 3, (self.axis + 2) % 3

    @property
    def matrix(self) -> Matrix:
        """``C_BA``."""
        return transposed([self.forward(e) for e in IDENTITY])

    def forward(self, v: Vector) -> Vector:
        """Return C v."""
        i, j = self.plane
        w = list(v)
        w[i] = add(mul(self.cosine, v[i]), mul(self.sine, v[j]))
        w[j] = sub(mul(self.cosine, v[j]), mul(self.sine, v[i]))
        return w

    def back(self, v: Vector) -> Vector:
        """Return C^T v."""
        i, j = self.plane
        w = list(v)
        w[i] = sub(mul(self.cosine, v[i]), mul(self.sine, v[j]))
        w[j] = add(mul(self.sine, v[i]), mul(self.cosine, v[j]))
        return w

    def back_block(self, work: Work, part: str, letter: str, H: Matrix) -> Matrix:
        """Return C^T H C.

        In the plane of the turn the trace and the antisymmetric part of H stay as they are; with
        t = s (H_ii - H_jj) + c (H_ij + H_ji) the rest changes by s t and c t. A block that is the same
        in all directions of the plane costs nothing. So do McMillan and Orin, Efficient computation of
        articulated-body inertias using successive axial screws, IEEE Trans. Robotics Autom. 11 (1995).
        """
        i, j = self.plane
        k = self.axis
        B = [list(row) for row in H]
        B[i][k], B[j][k] = (self.back([H[0][k], H[1][k], H[2][k]])[n] for n in (i, j))
        B[k][i], B[k][j] = (self.back(H[k])[n] for n in (i, j))
        change = self._change(work, part, letter, H)
        if change is None:
            return B
        st, ct = change
        B[i][i], B[j][j] = sub(H[i][i], st), add(H[j][j], st)
        B[i][j], B[j][i] = sub(ct, H[j][i]), sub(ct, H[i][j])
        return B

    def back_symmetric(self, work: Work, part: str, letter: str, S: Matrix) -> Matrix:
        """Return C^T S C of a symmetric S, of which each entry is computed once."""
        i, j = self.plane
        k = self.axis
        B = [list(row) for row in S]
        column = self.back(S[k])
        for n in (i, j):
            B[k][n] = B[n][k] = column[n]
        change = self._change(work, part, letter, S)
        if change is None:
            return B
        st, ct = change
        B[i][i], B[j][j] = sub(S[i][i], st), add(S[j][j], st)
        B[i][j] = B[j][i] = sub(ct, S[i][j])
        return B

    def _change(
        self, work: Work, part: str, letter: str, H: Matrix
    ) -> tuple[Scalar, Scalar] | None:
        """Return s t and c t; None if H is the same in all directions of the plane by structure."""
        i, j = self.plane
        both = mul(2, H[i][j]) if H[i][j] is H[j][i] else add(H[i][j], H[j][i])
        difference = sub(H[i][i], H[j][j])
        if is_zero(both) and is_zero(difference):
            return None
        t = add(mul(self.sine, difference), mul(self.cosine, both))
        name = f"turned_{letter}"
        t = work.keep(name, part, "", t)
        return (
            work.keep(name, part, "s", mul(self.sine, t)),
            work.keep(name, part, "c", mul(self.cosine, t)),
        )


@dataclass(frozen=True)
class General:
    """A rotation by its matrix ``C_BA``."""

    matrix: Matrix

    def forward(self, v: Vector) -> Vector:
        """Return C v."""
        return times(self.matrix, v)

    def back(self, v: Vector) -> Vector:
        """Return C^T v."""
        return times(transposed(self.matrix), v)

    def back_block(self, work: Work, part: str, letter: str, H: Matrix) -> Matrix:
        """Return C^T H C."""
        HC = keep_matrix(work, f"turned_{letter}", part, product(H, self.matrix))
        return product(transposed(self.matrix), HC)

    def back_symmetric(self, work: Work, part: str, letter: str, S: Matrix) -> Matrix:
        """Return C^T S C of a symmetric S, of which each entry is computed once."""
        SC = keep_matrix(work, f"turned_{letter}", part, product(S, self.matrix))
        columns, right = transposed(self.matrix), transposed(SC)
        return symmetric({(i, j): dot(columns[i], right[j]) for i, j in _UPPER})


Rotation = Sequence[Turn | General]
"""Rotations one after the other, the first of them first."""


def forward(rotation: Rotation, v: Vector) -> Vector:
    """Return components after the rotations, of those before."""
    for step in rotation:
        v = step.forward(v)
    return v


def back(rotation: Rotation, v: Vector) -> Vector:
    """Return components before the rotations, of those after."""
    for step in reversed(rotation):
        v = step.back(v)
    return v


def matrix_of(rotation: Rotation) -> Matrix:
    """Return the matrix that `forward` multiplies by."""
    C: Matrix = IDENTITY
    for step in rotation:
        C = transposed([step.forward(column) for column in transposed(C)])
    return C


def turned_back(work: Work, part: str, rotation: Rotation, A: Inertia) -> Inertia:
    """Return an inertia in the axes before the rotations, about the same point."""
    for step in reversed(rotation):
        A = Inertia(
            keep_symmetric(work, "turned_I", part, step.back_symmetric(work, part, "I", A.I)),
            keep_matrix(work, "turned_H", part, step.back_block(work, part, "H", A.H)),
            keep_symmetric(work, "turned_M", part, step.back_symmetric(work, part, "M", A.M)),
        )
    return A


def shifted(work: Work, part: str, r: Vector, A: Inertia) -> Inertia:
    """Return an inertia about the point from which its present one is at ``r``.

    H' = H + r x M, I' = I + r x H^T + (r x H'^T)^T (Featherstone 2008, ch. 2, in blocks).
    """
    if all(map(is_zero, r)):
        return A
    R = skew(r)
    H = keep_matrix(work, "shifted_H", part, matrix_sum(A.H, product(R, A.M)))
    both = matrix_sum(A.H, H)

    def entry(i: int, j: int) -> Scalar:
        if i == j:
            return add(A.I[i][i], dot(R[i], both[i]))
        return add(A.I[i][j], add(dot(R[i], A.H[j]), dot(R[j], H[i])))

    return Inertia(symmetric({ij: entry(*ij) for ij in _UPPER}), H, A.M)


def joined(A: Inertia, B: Inertia) -> Inertia:
    """Return the sum of two inertias about the same point, in the same axes."""
    upper = [
        symmetric({(i, j): add(a[i][j], b[i][j]) for i, j in _UPPER})
        for a, b in ((A.I, B.I), (A.M, B.M))
    ]
    return Inertia(upper[0], matrix_sum(A.H, B.H), upper[1])
