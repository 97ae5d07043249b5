"""A tree at its start in numbers: where its bodies and the frames of its joints are."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from eom.multibody.algebra.scalars import Numbers
from eom.multibody.algebra.values import is_number
from eom.multibody.files.scene import TreeScene
from eom.multibody.files.sections import Reading
from eom.multibody.files.starting import start_values
from eom.multibody.model.model import GROUND, Joint, Tree
from eom.multibody.recursion.motion import places, poses
from eom.multibody.recursion.skeleton import Skeleton, skeleton
from eom.views.animation.tree_tracks import STRUCTURE, without_forces
from eom.views.body.load_arrows import number, numbers
from eom.views.draw.picture import Floats

FLOATS = Numbers(math.sin, math.cos)


@dataclass(frozen=True, eq=False)
class Place:
    """Where a frame is: C of shape (3, 3) from the ground's axes to its own; its origin (m), shape (3,)."""

    C: Floats
    origin: Floats

    def point(self, position: Floats) -> Floats:
        """Return a point of the body, given in its axes, in the ground's."""
        return np.asarray(self.origin + position @ self.C)


@dataclass(frozen=True)
class Posture:
    """A tree and the value of every symbol at the start, by name."""

    tree: Tree
    known: Mapping[str, float]

    @classmethod
    def of(cls, scene: TreeScene) -> Self:
        """Return the posture of a scene at its start. Raises `InputError` as the scene does."""
        states = start_values(scene.tree, Reading(scene))
        inputs = {n: v.value for n, v in scene.inputs.items()}
        return cls(scene.tree, {**scene.numbers, **inputs, **states, "t": 0.0})

    def lift(self, given: Any) -> Any:
        """Return a number; 0, 1 and -1 stay what they are."""
        if is_number(given) and given in STRUCTURE:
            return int(given)
        return number(given, self.known)

    @cached_property
    def bones(self) -> Skeleton:
        """The parts, whose frames all turn with them; every joint leads to one."""
        bare, names = without_forces(self.tree), [b.name for b in self.tree.bodies]
        fixed = [j.name for j in self.tree.joints if j.kind == "fixed"]
        return skeleton(bare, self.lift, FLOATS, names, apart=fixed)

    @cached_property
    def joints(self) -> dict[str, tuple[Place, tuple[Floats, ...]]]:
        """For each joint its frame on the child, and what each speed adds to the child's motion.

        Of shape (2, 3) in the ground's axes: angular velocity, velocity of the frame's origin.
        """
        q: list[Any] = []
        for joint in self.tree.ordered:
            given = joint.motion.position if joint.motion else [c.symbol for c in joint.coordinates]
            q += [self.lift(x) for x in given]
        placed = places(self.bones, q, FLOATS)
        found = {}
        for place, (C, origin) in zip(placed, poses(placed, FLOATS), strict=True):
            here = Place(np.array(C, dtype=np.float64), np.array(origin, dtype=np.float64))
            columns = tuple(
                np.array([list(column.angular), list(column.linear)], dtype=np.float64) @ here.C
                for column in place.subspace
            )
            found[place.part.joint] = here, columns
        return found

    @cached_property
    def bodies(self) -> dict[str, Place]:
        """The frame of each body, and that of the ground."""
        found = {GROUND: Place(np.eye(3), np.zeros(3))}
        for joint in self.tree.ordered:
            found[joint.child] = self._body(joint)
        return found

    def _body(self, joint: Joint) -> Place:
        frame, _ = self.joints[joint.name]
        F = numbers(joint.on_child.rotation, self.known)
        C = F.T @ frame.C
        return Place(C, frame.origin - numbers(joint.on_child.position, self.known) @ C)

    def centre(self, body: str) -> Floats:
        """Return the centre of mass of a body in the ground's axes (m)."""
        own = numbers(self.tree.body[body].centre, self.known)
        return self.bodies[body].point(own)

    def on_body(self, body: str, position: Any) -> Floats:
        """Return a point of a body, given as the tree gives it, in the ground's axes (m)."""
        return self.bodies[body].point(numbers(position, self.known))
