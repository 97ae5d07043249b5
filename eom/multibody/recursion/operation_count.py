"""What the structure of a tree saves: operations of forward dynamics with and without it.

The recursion runs on scalars that only count. Once numbers are what they are, so that zeros and ones are
skipped and equal values cancel as in the derivation; once they are values like any others, every rotation
is a matrix, and every body turns with its joint.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from eom.fields import Operators
from eom.multibody.algebra.scalars import Scalar, Work
from eom.multibody.algebra.spatial import General, Matrix, SpatialVector, Vector, matrix_of
from eom.multibody.algebra.values import is_number
from eom.multibody.model.joints import Kind, Relative, Setting
from eom.multibody.model.model import Tree, moves_nothing
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.recursions import forward_dynamics


@dataclass(frozen=True)
class Savings:
    """Operations of forward dynamics with and without the use of structure.

    ``done``: with it; ``without``: as if there were none; ``reasons``: what of it is used, in words.
    """

    done: int
    without: int
    reasons: tuple[str, ...]

    @property
    def skipped(self) -> int:
        """The operations that were skipped."""
        return self.without - self.done

    def __str__(self) -> str:
        return f"{self.done} operations, {self.skipped} skipped: {'; '.join(self.reasons)}"


@dataclass
class _Counter:
    operations: int = 0


class _Tally(Operators):
    """A scalar that counts what is done with it; operations on numbers of the model are not counted."""

    __slots__ = ("counter", "known")

    def __init__(self, counter: _Counter, *, known: bool) -> None:
        self.counter = counter
        self.known = known

    def operated(self, op: str, *operands: Any) -> _Tally:
        """Count; a sign goes into the sum that takes it."""
        if op == "neg":
            return self
        known = all(getattr(x, "known", True) for x in operands)
        self.counter.operations += not known
        return _Tally(self.counter, known=known)


@dataclass
class _Counting:
    """Functions for `_Tally`; sines and cosines count one each."""

    counter: _Counter

    def sin(self, x: Scalar) -> Scalar:
        return x.operated("sin", x) if isinstance(x, _Tally) else _Tally(self.counter, known=True)

    cos = sqrt = sin

    def keep(self, letter: str, part: str, suffix: str, value: Scalar) -> Scalar:  # noqa: ARG002
        return value


def savings(tree: Tree) -> Savings:
    """Return what forward dynamics of a tree costs, and what its structure saves.

    Operations are additions, multiplications, divisions, sines and cosines that depend on the state;
    sharing of equal values by the code generator comes on top, on both sides.
    """
    light = moves_nothing(tree, frozenset())
    if light is not None:
        reason = (
            f"not counted: joint {light.name} moves no mass, its motion follows from constraints"
        )
        return Savings(0, 0, (reason,))
    counter = _Counter()
    work = _Counting(counter)

    @cache
    def atom(value: Any) -> Scalar:
        return value if is_number(value) else _Tally(counter, known=True)

    lumped = lumped_tree(tree, atom, work)
    done = _count(lumped, counter, work)
    counter.operations = 0
    generic = _generic(lumped, counter)
    return Savings(done, _count(generic, counter, work), tuple(_reasons(tree, lumped)))


def _count(lumped: LumpedTree, counter: _Counter, work: Work) -> int:
    counter.operations = 0

    def values(count: int) -> list[Scalar]:
        return [_Tally(counter, known=False) for _ in range(count)]

    given = dict.fromkeys(lumped.driven, _Tally(counter, known=False))
    q, u, tau = values(lumped.coordinates), values(lumped.speeds), values(lumped.speeds)
    forward_dynamics(lumped, q, u, tau, work, given)
    return counter.operations


def _generic(lumped: LumpedTree, counter: _Counter) -> LumpedTree:
    """Return a lumped_tree in which no zero or one is known to be one."""

    def scalar(x: Scalar) -> Scalar:
        return x if isinstance(x, _Tally) else _Tally(counter, known=True)

    def vector(v: Vector) -> Vector:
        return [scalar(x) for x in v]

    def matrix(A: Matrix) -> Matrix:
        return [vector(row) for row in A]

    def placed(kind: Kind) -> Callable[[Setting, Any, Work], Relative]:
        def place(setting: Setting, q: Any, work: Work) -> Relative:
            found = kind.place(setting, q, work)
            columns = tuple(SpatialVector(vector(a), vector(b)) for a, b in found.subspace)
            rotation = (General(matrix(matrix_of(found.rotation))),)
            return Relative(vector(found.position), rotation, columns, found.trigonometry)

        return place

    parts = tuple(
        replace(
            p,
            kind=replace(p.kind, place=placed(p.kind)),
            position=vector(p.position),
            rotation=(General(matrix(matrix_of(p.rotation))),),
            inertia=type(p.inertia)(*map(matrix, p.inertia)),
            armature=vector(p.armature),
            spins=False,
        )
        for p in lumped.parts
    )
    gradient = None if lumped.gradient is None else matrix(lumped.gradient)
    return replace(lumped, parts=parts, gravity=vector(lumped.gravity), gradient=gradient)


def _reasons(tree: Tree, lumped: LumpedTree) -> list[str]:
    """Name what of the structure is used beyond zeros and ones."""
    found = ["zeros and ones of placements, axes and inertias"]
    fixed = [j.name for j in tree.joints if j.kind == "fixed"]
    spinning = [p.name for p in lumped.parts if p.spins]
    driven = [p.joint for p in lumped.parts if p.driven]
    light = [b.name for b in tree.bodies if b.mass == 0]
    for text, names in (
        ("joined to their parents", fixed),
        ("bodies of revolution, whose turn is left out", spinning),
        ("joints with prescribed motion", driven),
        ("bodies without mass", light),
    ):
        if names:
            found.append(f"{text}: {', '.join(names)}")
    return found
