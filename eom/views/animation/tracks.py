"""Where the bodies of a simulated scene are: positions, quaternions and vectors at the stored times.

A is the frame of the ground, or the one that attitude is measured in; B that of a body. Quaternions have
the scalar first; of the two that are one attitude, that nearer to the one before is taken, so that they can
be interpolated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eom.errors import InputError
from eom.kinematics.coordinates import quaternion_of_sequence
from eom.kinematics.rotations import cosines, quaternion_of_matrix
from eom.opening import AnyScene
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
    from eom.views.animation.tree_tracks import tracks_of_tree

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
