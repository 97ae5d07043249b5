"""Forces of constraints as loads on the parts of a tree, for reactions in its joints.

A constraint's row of coefficients, taken for the six unit motions of each single part instead of the
speeds of the joints, is the wrench of a unit multiplier on that part: by the principle of virtual power.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from eom.multibody.algebra.scalars import Scalar, add, mul
from eom.multibody.algebra.spatial import IDENTITY, ZERO, Pair, Vector, cross, minus, times
from eom.multibody.constrained.binding import Binding
from eom.multibody.constrained.equations import components
from eom.multibody.constrained.spots import Scene, scene
from eom.multibody.model.constraints import Distance, Loop, Rolling, Skate
from eom.multibody.recursion.skeleton import Seat, Skeleton

BETWEEN_POINTS = (Loop, Distance, Rolling, Skate)
"""Constraints that act on bodies; the others act within joints, along their speeds."""


@dataclass(frozen=True)
class _Loose(Scene):
    """A tree whose parts all move by themselves: six unit motions each, in the ground's axes."""

    def _columns(self, seat: Seat, position: Vector) -> dict[int, Pair]:
        k = seat.part
        arm = minus(position, self.poses[k][1])
        turns = [Pair(e, cross(e, arm)) for e in IDENTITY]
        return dict(enumerate([*turns, *(Pair(ZERO, e) for e in IDENTITY)], 6 * k))


def constraint_loads(binding: Binding) -> Callable[[Skeleton], list[Pair]]:
    """Return what gives the loads on the parts of a skeleton: moments about origins, and forces."""
    values = binding.multipliers()

    def loads(bones: Skeleton) -> list[Pair]:
        still = scene(bones, binding.q, None, binding.arithmetic)
        loose = _Loose(bones, still.arithmetic, still.q, None, still.placed, still.poses, ())
        kinds = {c.name: type(c) for c in binding.tree.constraints}
        six: list[Scalar] = [0] * (6 * len(bones.parts))
        found = components(binding.tree, loose)
        for number, value in zip(binding.plan.kept, values, strict=True):
            if kinds[found[number].constraint] in BETWEEN_POINTS:
                for place, x in found[number].relation.row().items():
                    six[place] = add(six[place], mul(value, x))
        return [_turned(R, six[6 * k : 6 * k + 6]) for k, (R, _) in enumerate(loose.poses)]

    return loads


def _turned(R: Sequence[Sequence[Scalar]], six: Sequence[Scalar]) -> Pair:
    return Pair(times(R, six[:3]), times(R, six[3:]))
