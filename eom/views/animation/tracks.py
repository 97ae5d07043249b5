"""Where the bodies of a simulated scene are: positions, quaternions and vectors at the stored times.

A is the frame of the ground, or the one that attitude is measured in; B that of a body. Quaternions have
the scalar first; of the two that are one attitude, that nearer to the one before is taken, so that they can
be interpolated.

Where the bodies of a tree are: its recursions over arrays of all stored times at once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eom.errors import InputError
from eom.kinematics.coordinates import quaternion_of_sequence
from eom.multibody.algebra.scalars import Numbers
from eom.multibody.algebra.values import is_number
from eom.multibody.files.scene import TreeScene
from eom.multibody.model.model import Tree
from eom.multibody.recursion.lumped_tree import LumpedTree, lumped_tree
from eom.multibody.recursion.quantities import (
    Flow,
    about_centre,
    first_moments,
    flow,
    mass,
    momentum,
)
from eom.opening import AnyScene
from eom.quantities import TIME
from eom.rotations import cosines, quaternion_of_matrix, quaternion_product
from eom.scenes.description import principal_values
from eom.scenes.scene import Scene
from eom.structure import DCM, QUATERNION, BodyAttitude

if TYPE_CHECKING:
    from codegen import Result

Floats = NDArray[np.float64]

LEAST_POINTS = 2


@dataclass(frozen=True, eq=False)
class Track:
    """The motion of one body over N instants.

    ``positions``: of its origin, components in A (m), shape (N, 3). ``quaternions``: of C_BA, shape
    (N, 4). ``omega``: its angular velocity in inertial space, components in A (rad/s), shape (N, 3).
    """

    name: str
    positions: Floats
    quaternions: Floats
    omega: Floats


@dataclass(frozen=True, eq=False)
class Tracks:
    """The motion of all ``bodies`` at ``times`` (s), shape (N,), equally far apart.

    ``momentum``: angular momentum of all bodies (N m s), about the point of ``centre`` (m), and ``torque``
    (N m) on one body, or None of several; components in A, shape (N, 3).
    """

    times: Floats
    bodies: tuple[Track, ...]
    momentum: Floats
    centre: Floats
    torque: Floats | None = None


def with_attitude(scene: AnyScene, points: int, t_end: float | None = None) -> AnyScene:
    """Return a scene whose simulation says where its bodies are, at ``points`` equally spaced times.

    All states are asked for, and momentum and torque of one body. A body without attitude coordinates gets
    a quaternion, with B on A at the start; a spinner without its angle of spin starts at zero.
    """
    data = scene.model_dump(exclude_unset=True)
    plan = {**data.get("integration", {}), "points": max(points, LEAST_POINTS)}
    data["integration"] = plan if t_end is None else {**plan, "t_end": t_end}
    data["outputs"] = ()
    if not isinstance(scene, Scene):
        return type(scene)(**_with_angles(data))
    if scene.model == "spinner":
        data["initial"] = {"phi": 0.0, "psi": 0.0, **data.get("initial", {})}
        if "initial_attitude" in data:
            data["initial"] = {n: v for n, v in data["initial"].items() if n not in {"phi", "psi"}}
    elif scene.attitude == "none":
        data["attitude"] = "quaternion"
        data["initial_attitude"] = {"quaternion": (1.0, 0.0, 0.0, 0.0)}
    full = Scene(**data).full_system
    told = [f"{letter}_{k}" for letter in ("h", "torque") for k in (1, 2, 3)]
    wanted = dict.fromkeys([*full.state_names, *told, *scene.outputs])
    return Scene(**{**data, "outputs": tuple(wanted)})


def _with_angles(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data of a tree with the angles of rotors among the states, where their speed is one."""
    rotors = {
        name: {**part, "angle": True} if part.get("speed") is None else part
        for name, part in data.get("rotors", {}).items()
    }
    return {**data, "rotors": rotors} if rotors else data


def tracks_of(scene: AnyScene, result: Result) -> Tracks:
    """Return the motion of the bodies of a scene of `with_attitude` from its simulation."""
    if len(result.t) < LEAST_POINTS:
        raise InputError("the motion has no duration", where=scene.name, got=result.message)
    if isinstance(scene, Scene):
        return _of_body(scene, result)

    return tracks_of_tree(scene, result)


def _of_body(scene: Scene, result: Result) -> Tracks:
    """Return the motion of one body; a spinner's momentum and torque are in the frame before the spin."""
    held = {**scene.parameter_values(), **scene.input_values()}

    def series(name: str) -> Floats:
        known = name in result.names or name in result.outputs
        return np.asarray(result[name]) if known else np.full(len(result.t), held.get(name, 0.0))

    def triple(letter: str) -> Floats:
        return np.stack([series(f"{letter}_{k}") for k in (1, 2, 3)], axis=-1)

    (stated,) = scene.full_system.attitudes
    quaternions, still = _quaternions(stated, series), np.zeros((len(result.t), 3))
    frame, omega = quaternions, None
    if stated.unspun:
        names = [c.name for c in stated.coordinates if c is not None]
        frame = _sequence(stated.kind, series, [*names[:-1], None])
        omega = triple("h") / np.array(principal_values(scene))
    h, torque = (turned(frame, triple(letter)) for letter in ("h", "torque"))
    omega = turned(frame, triple("omega") if omega is None else omega)
    body = Track(scene.title or scene.name, still, quaternions, omega)
    return Tracks(result.t, (body,), h, still, torque)


def _quaternions(stated: BodyAttitude, series: Any) -> Floats:
    names = [c.name for c in stated.coordinates if c is not None]
    if stated.kind == QUATERNION:
        return continuous(np.stack([series(n) for n in names], axis=-1))
    if stated.kind == DCM:
        return of_matrices(np.stack([series(n) for n in names], axis=-1).reshape(-1, 3, 3))
    return _sequence(stated.kind, series, names)


def _sequence(sequence: str, series: Any, names: Sequence[str | None]) -> Floats:
    """Return quaternions of angles; one without a name is zero."""
    still = np.zeros_like(series(str(names[0])))
    angles = [series(n) if n else still for n in names]
    rows = zip(*(a.tolist() for a in angles), strict=True)
    return continuous(np.array([quaternion_of_sequence(sequence, row) for row in rows]))


def continuous(quaternions: ArrayLike) -> Floats:
    """Return quaternions of unit norm, shape (N, 4), each of the sign that is nearer to the one before."""
    q = np.array(quaternions, dtype=np.float64)
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    turns = np.einsum("ij,ij->i", q[1:], q[:-1]) < 0
    q[1:][np.cumsum(turns) % 2 == 1] *= -1
    return q


def of_matrices(C: ArrayLike) -> Floats:
    """Return the quaternions of rotations C_BA, shape (N, 3, 3), continuous."""
    return continuous([quaternion_of_matrix(matrix) for matrix in np.asarray(C).tolist()])


def matrices(quaternions: ArrayLike) -> Floats:
    """Return C_BA of unit quaternions, shape (..., 4), as shape (..., 3, 3)."""
    rows = cosines(np.moveaxis(np.asarray(quaternions, dtype=np.float64), -1, 0))
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def turned(quaternions: ArrayLike, components: ArrayLike) -> Floats:
    """Return components in A of vectors with components in B: C_AB times them, shapes (N, 4), (N, 3)."""
    return np.asarray(np.einsum("nij,ni->nj", matrices(quaternions), np.asarray(components)))


def sequence_matrices(sequence: str, angles: Floats) -> Floats:
    """Return C_BI, (N, 3, 3), of angles (3, N) in radians about body axes, the first angle first."""
    made = np.broadcast_to(np.eye(3), (angles.shape[1], 3, 3))
    for axis, angle in zip(sequence.split("-"), angles, strict=True):
        k = int(axis) - 1
        i, j = (k + 1) % 3, (k + 2) % 3
        turn = np.zeros((len(angle), 3, 3))
        turn[:, k, k] = 1.0
        turn[:, i, i] = turn[:, j, j] = np.cos(angle)
        turn[:, i, j], turn[:, j, i] = np.sin(angle), -np.sin(angle)
        made = turn @ made
    return np.asarray(made)


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
    def bones(self) -> LumpedTree:
        """The parts, whose frames all turn with them."""
        tree = without_forces(self.scene.tree)
        return lumped_tree(tree, self.lift, ARRAYS, [b.name for b in tree.bodies])

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
