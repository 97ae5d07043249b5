"""Geometry of trees that is exactly orthonormal, where floats hold it to rounding."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

from eom.multibody.algebra.spatial import IDENTITY, Matrix, Vector, dot, product, transposed
from eom.multibody.algebra.values import Value, is_number
from eom.multibody.model.model import Joint, Placement, Tree
from eom.rotations import cosines, parameters

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
    found = parameters(C)
    largest = Fraction(max(found, key=abs))
    q = [Fraction(p / largest).limit_denominator(LARGEST) for p in found]
    square = dot(q, q)
    return [[x / square for x in row] for row in cosines(q)]
