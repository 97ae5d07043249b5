"""Geometry of trees that is exactly orthonormal, where floats hold it to rounding."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from eom.multibody.algebra.spatial import IDENTITY, Matrix, Vector, cross, dot, product, transposed
from eom.multibody.algebra.values import Value, is_number
from eom.multibody.model.model import Joint, Placement, Tree

LARGEST = 10**6
"""Largest denominator of the half-angle tangents of a rotation that takes the place of a rounded one."""


def orthonormal(tree: Tree) -> Tree:
    """Return a tree whose rotations and axes in numbers are exactly orthonormal.

    Those that are, quarter turns above all, stay; others are replaced by rational ones within 1e-6,
    the same for the same numbers: angles that are no multiples of a right angle may change by that.
    """
    return replace(tree, joints=tuple(_joint(j) for j in tree.joints))


def symbols_of(tree: Tree) -> list[Any]:
    """Return the symbols of geometry and gravity, by name."""
    found: set[Any] = set()
    for x in [*tree.gravity, *(x for j in tree.joints for x in _given(j))]:
        if not is_number(x):
            found |= x.free_symbols
    return sorted(found, key=lambda s: str(s.name))


def _given(j: Joint) -> list[Value]:
    found = [*(x for a in j.axes for x in a), j.pitch]
    for place in (j.on_parent, j.on_child):
        found += [*place.position, *(x for row in place.rotation for x in row)]
    return found


def _joint(joint: Joint) -> Joint:
    return replace(
        joint,
        axis=unit(joint.axis),
        second_axis=unit(joint.second_axis),
        on_parent=_placement(joint.on_parent),
        on_child=_placement(joint.on_child),
    )


def _placement(place: Placement) -> Placement:
    return replace(place, rotation=rotation(place.rotation))


def unit(a: Vector) -> Vector:
    """Return a rational unit vector near one of numbers, by its projection from the far pole."""
    if not all(map(is_number, a)) or dot(a, a) == 1:
        return a
    k = max(range(3), key=lambda n: abs(a[n]))
    sign = 1 if a[k] > 0 else -1
    flat = [Fraction(Fraction(x) / (1 + abs(a[k]))).limit_denominator(LARGEST) for x in a]
    square = sum(x * x for n, x in enumerate(flat) if n != k)
    found: list[Any] = [2 * x / (1 + square) for x in flat]
    found[k] = sign * (1 - square) / (1 + square)
    return found


def rotation(C: Matrix) -> Matrix:
    """Return a rational rotation near one of numbers."""
    if not all(is_number(x) for row in C for x in row):
        return C
    if all(x == e for a, b in zip(product(C, transposed(C)), IDENTITY, strict=True)
           for x, e in zip(a, b, strict=True)):  # fmt: skip
        return C
    return _of_quaternion(_quaternion(C))


def _quaternion(C: Matrix) -> Sequence[Fraction]:
    """Return a quaternion of a rotation, its largest part 1, the others rounded (Shepperd, 1978)."""
    trace = C[0][0] + C[1][1] + C[2][2]
    squares = [trace, C[0][0], C[1][1], C[2][2]]
    largest = max(range(4), key=lambda n: squares[n])
    if largest == 0:
        parts: list[Any] = [1 + trace, C[1][2] - C[2][1], C[2][0] - C[0][2], C[0][1] - C[1][0]]
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        parts = [C[j][k] - C[k][j], 0, 0, 0]
        parts[1 + i] = 1 + 2 * C[i][i] - trace
        parts[1 + j], parts[1 + k] = C[i][j] + C[j][i], C[i][k] + C[k][i]
    return [Fraction(p / Fraction(parts[largest])).limit_denominator(LARGEST) for p in parts]


def _of_quaternion(q: Sequence[Fraction]) -> Matrix:
    """Return the rotation of a quaternion of any length, scalar first."""
    a, v = q[0], q[1:]
    n = a * a + dot(v, v)

    def column(e: Vector) -> Vector:
        along, across = dot(v, e), cross(e, v)
        return [((a * a - dot(v, v)) * x + 2 * along * y + 2 * a * z) / n
                for x, y, z in zip(e, v, across, strict=True)]  # fmt: skip

    return transposed([column(e) for e in IDENTITY])
