"""Rotation matrices, quaternions, and the angles of the 12 sequences.

C takes components in the reference axes to components in the body's. Quaternions have the scalar
first, angles are in radians. Small matrices are rows of tuples. Products of quaternions, and the way
between them and matrices, are over any scalars: numbers, symbols, series, arrays; both packages take them
from here, so that nothing else is imported. Angles are floats.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

Row = tuple[float, float, float]
Matrix = tuple[Row, Row, Row]
Quaternion = tuple[float, float, float, float]

ALMOST = 1e-9
"""How far from orthonormal a rotation may be, how far from 1 a quaternion's norm."""


def matrix_of(rows: Sequence[Sequence[float]]) -> Matrix:
    """Return rows of numbers as a matrix."""
    a, b, c = ((float(x), float(y), float(z)) for x, y, z in rows)
    return a, b, c


def product(a: Matrix, b: Matrix) -> Matrix:
    """Return the product of two matrices."""
    return matrix_of([[dot(row, column) for column in zip(*b, strict=True)] for row in a])


def transpose(a: Matrix) -> Matrix:
    """Return the transpose."""
    return matrix_of(list(zip(*a, strict=True)))


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    """Return the scalar product."""
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def cross(a: Sequence[float], b: Sequence[float]) -> Row:
    """Return the vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def determinant(rows: Sequence[Sequence[float]]) -> float:
    """Return the determinant."""
    return dot(rows[0], cross(rows[1], rows[2]))


def _unit(axis: int) -> Row:
    x, y, z = (float(axis == k) for k in (1, 2, 3))
    return x, y, z


def quaternion_product(p: Iterable[Any], q: Iterable[Any]) -> tuple[Any, Any, Any, Any]:
    """Return the product p q (Hamilton's), scalar first; the turn p is followed by the turn q."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y + c * w + d * x - b * z,
        a * z + d * w + b * y - c * x,
    )


def unit_quaternion(gibbs: Iterable[Any]) -> tuple[Any, Any, Any, Any]:
    """Return a quaternion of norm 1 from any three numbers, by stereographic projection."""
    x, y, z = gibbs
    square = x * x + y * y + z * z
    below = 1 + square
    return (1 - square) / below, 2 * x / below, 2 * y / below, 2 * z / below


def cosines(q: Iterable[Any]) -> list[list[Any]]:
    """Return C of a quaternion, times its squared norm (Hughes, 1986, sect. 2.2)."""
    a, b, c, d = q
    return [
        [a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)],
        [2 * (b * c - a * d), a * a - b * b + c * c - d * d, 2 * (c * d + a * b)],
        [2 * (b * d + a * c), 2 * (c * d - a * b), a * a - b * b - c * c + d * d],
    ]


def parameters(C: Sequence[Sequence[Any]]) -> list[Any]:
    """Return a quaternion of C, of any norm, whose largest component is positive.

    The products of its components are linear in C; those with the largest are taken (Shepperd, J. Guid.
    Control 1 (1978) 223).
    """
    trace = C[0][0] + C[1][1] + C[2][2]
    products: list[list[Any]] = [[0] * 4 for _ in range(4)]
    products[0][0] = 1 + trace
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        products[i + 1][i + 1] = 1 + 2 * C[i][i] - trace
        products[0][k + 1] = products[k + 1][0] = C[i][j] - C[j][i]
        products[i + 1][j + 1] = products[j + 1][i + 1] = C[i][j] + C[j][i]
    return products[max(range(4), key=lambda n: products[n][n])]


def matrix_of_quaternion(q: Sequence[float]) -> Matrix:
    """Return C of a unit quaternion ``q``, scalar first.

    Parameters
    ----------
    q : sequence of floats
        A unit quaternion, scalar first. The norm is not tested.

    Returns
    -------
    list of list of floats
        C, (3, 3) as rows; it takes components in the reference axes to components in the body's.

    References
    ----------
    Hughes, Spacecraft Attitude Dynamics (1986), sect. 2.2.

    Examples
    --------
    >>> matrix_of_quaternion((0, 0, 0, 1))  # half a turn about axis 3
    ((-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0))
    """
    return matrix_of(cosines(q))


def quaternion_of_matrix(C: Matrix) -> Quaternion:
    """Return the unit quaternion of C, scalar first and not negative."""
    found = parameters(C)
    size = math.sqrt(dot(found, found))
    a, b, c, d = (x / (-size if found[0] < 0 else size) for x in found)
    return a, b, c, d


def angles_of_matrix(C: Matrix, sequence: str) -> Row:
    """Return the angles of a sequence about body axes; the second one in its principal range.

    The row of the third axis is that axis, turned back by the second and the first angle; the first one
    is seen about the first axis. The others follow from what is left. Where the first and third axes
    are parallel, the third angle is zero.
    """
    i, j, k = (_unit(int(n)) for n in sequence.split("-"))
    third = _row(C, k)
    towards = k if k != i else cross(j, i)
    if math.hypot(dot(towards, third), dot(cross(i, towards), third)) > ALMOST:
        first = _angle(towards, third, i)
    else:
        first = _angle(j, _row(C, j), i)
    rest = product(C, transpose(_elementary(i, first)))
    return first, _angle(k, _row(rest, k), j), _angle(_column(rest, j), j, k)


def _row(C: Matrix, axis: Row) -> Row:
    return C[axis.index(1)]


def _column(C: Matrix, axis: Row) -> Row:
    return _row(transpose(C), axis)


def _angle(start: Row, end: Row, axis: Row) -> float:
    """Return the angle by which a vector turns about an axis to which the first is perpendicular."""
    return math.atan2(dot(axis, cross(start, end)), dot(start, end))


def _elementary(axis: Row, angle: float) -> Matrix:
    turned = (math.cos(angle / 2), *(math.sin(angle / 2) * x for x in axis))
    return matrix_of_quaternion(turned)
