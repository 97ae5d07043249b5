"""Where the bodies of a tree are: its recursions over arrays of all stored times at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eom.kinematics.rotations import quaternion_product
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.algebra.values import is_number
from eom.multibody.files.scene import TreeScene
from eom.multibody.model.model import Tree
from eom.multibody.recursion.quantities import (
    Flow,
    about_centre,
    first_moments,
    flow,
    mass,
    momentum,
)
from eom.multibody.recursion.skeleton import Skeleton, skeleton
from eom.system import TIME
from eom.views.animation.tracks import Track, Tracks, continuous, of_matrices, turned

if TYPE_CHECKING:
    from codegen import Result

Floats = NDArray[np.float64]

ARRAYS = Numbers(np.sin, np.cos, np.sqrt)
"""Scalars that are arrays over time."""
STRUCTURE = (0, 1, -1)
"""Numbers that recursions leave out."""


def tracks_of_tree(scene: TreeScene, result: Result) -> Tracks:
    """Return the motion of all bodies, and of rotors with a name of their own, after their bodies."""
    moving = Moving(scene, result)
    bodies = tuple(moving.track(b.name) for b in scene.tree.bodies)
    rotors = tuple(moving.rotor(k) for k in range(len(scene.tree.rotors)))
    whole, N = moving.flow, len(result.t)
    heavy = mass(whole)
    centre = [x / heavy for x in first_moments(whole)]
    H = about_centre(whole, momentum(whole))
    return Tracks(result.t, (*bodies, *rotors), filled(H, N), filled(centre, N))


def filled(entries: Any, count: int) -> Floats:
    """Return a vector or matrix of numbers and arrays (N,) as one array, N first."""
    if isinstance(entries, list | tuple):
        return np.stack([filled(e, count) for e in entries], axis=1)
    return np.broadcast_to(np.asarray(entries, dtype=np.float64), (count,))


@dataclass(frozen=True)
class Moving:
    """A tree whose coordinates and speeds are arrays over the times of a simulation."""

    scene: TreeScene
    result: Result

    @cached_property
    def known(self) -> Mapping[Any, Any]:
        """The values of all symbols; speeds that constraints eliminate are outputs."""
        values = {**self.scene.numbers, **self.scene.input_values()}
        told = (*self.result.names, *self.result.outputs)
        states = {n: np.asarray(self.result[n]) for n in told}
        symbols = {q.name: q.symbol for q in self._quantities}
        return {TIME: self.result.t} | {
            symbols[n]: v for n, v in {**values, **states}.items() if n in symbols
        }

    @property
    def _quantities(self) -> list[Any]:
        tree, system = self.scene.tree, self.scene.derive()
        speeds = [s for joint in tree.ordered for s in joint.speeds]
        return [*tree.parameters, *system.parameters, *system.inputs, *system.states, *speeds]

    def lift(self, given: Any) -> Any:
        """Return the number or array that a value of the description has."""
        if is_number(given):
            return int(given) if given in STRUCTURE else float(given)
        if given in self.known:
            return self.known[given]
        at = {s: self.known[s] for s in given.free_symbols}
        if all(isinstance(v, float) for v in at.values()):
            return float(given.subs(at))
        rows = [{s: v if isinstance(v, float) else v[k] for s, v in at.items()}
                for k in range(len(self.result.t))]  # fmt: skip
        return np.array([float(given.subs(row)) for row in rows])

    @cached_property
    def bones(self) -> Skeleton:
        """The parts, whose frames all turn with them."""
        tree = without_forces(self.scene.tree)
        return skeleton(tree, self.lift, ARRAYS, [b.name for b in tree.bodies])

    @cached_property
    def flow(self) -> Flow:
        """The motion of all parts."""
        q, u = [], []
        for joint in self.bones_joints:
            driven = joint.motion
            values = driven.position if driven else [c.symbol for c in joint.coordinates]
            q += [self.lift(v) for v in values]
            rates = driven.rate if driven else [s.symbol for s in joint.speeds]
            u += [self.lift(v) for v in rates or ()]
        return flow(self.bones, q, u, ARRAYS)

    @property
    def bones_joints(self) -> tuple[Any, ...]:
        """The joints that lead to parts, in order."""
        leading = {part.joint for part in self.bones.parts}
        return tuple(j for j in self.scene.tree.ordered if j.name in leading)

    def track(self, name: str) -> Track:
        """Return the motion of a body."""
        seat, N = self.bones.seats[name], len(self.result.t)
        own, origin = (filled(x, N) for x in (_lists(seat.rotation), list(seat.origin)))
        if seat.part < 0:
            return Track(name, origin, of_matrices(own), np.zeros((N, 3)))
        R, x = self.flow.poses[seat.part]
        C, position = filled(_lists(R), N), filled(list(x), N)
        omega = filled(list(self.flow.velocities[seat.part].angular), N)
        return Track(
            name,
            position + np.einsum("nij,ni->nj", C, origin),
            of_matrices(own @ C),
            np.einsum("nij,ni->nj", C, omega),
        )

    def rotor(self, number: int) -> Track:
        """Return the motion of a rotor about its axis, which is the third one of its own."""
        rotor = self.scene.tree.rotors[number]
        body, N = self.track(rotor.body), len(self.result.t)
        axis = np.array([float(self.lift(a)) for a in rotor.axis])
        centre = filled([self.lift(c) for c in self.scene.tree.body[rotor.body].centre], N)
        if rotor.speed is None:
            angle = self.result[rotor.states[0].name]
            along = filled(self.lift(rotor.states[-1].symbol), N)
        else:
            speed, t = filled(self.lift(rotor.speed), N), self.result.t
            angle = np.concatenate([[0.0], np.cumsum(np.diff(t) * (speed[1:] + speed[:-1]) / 2)])
            along = None
        space = turned(body.quaternions, np.broadcast_to(axis, (N, 3)))
        within = speed if along is None else along - np.einsum("ni,ni->n", body.omega, space)
        spin = np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * np.eye(3)[2][:, None]]).T
        tilt = np.broadcast_to(from_third(axis), (N, 4))
        return Track(
            rotor.name,
            body.positions + turned(body.quaternions, centre),
            continuous(multiplied(multiplied(body.quaternions, tilt), spin)),
            body.omega + within[:, None] * space,
        )


def without_forces(tree: Tree) -> Tree:
    """Return a tree with what its motion is read from alone: no forces, springs and constraints."""
    return replace(
        tree,
        joints=tuple(
            replace(j, force=0, stiffness=0, damping=0, rest=0, motor=False) for j in tree.joints
        ),
        rotors=tuple(replace(r, torque=0, damping=0, motor=False) for r in tree.rotors),
        loads=(),
        springs=(),
        constraints=(),
        inputs=(),
    )


def _lists(rows: Any) -> list[list[Any]]:
    return [list(row) for row in rows]


def multiplied(p: Floats, q: Floats) -> Floats:
    """Return the quaternion products p q, shape (N, 4)."""
    return np.stack(quaternion_product(p.T, q.T), axis=-1)


def from_third(axis: Floats) -> Floats:
    """Return the quaternion of axes whose third is a unit vector, by the shortest turn."""
    if axis[2] < -1 + 1e-12:
        return np.array([0.0, 1.0, 0.0, 0.0])
    q = np.array([1 + axis[2], -axis[1], axis[0], 0.0])
    return np.asarray(q / np.linalg.norm(q))
