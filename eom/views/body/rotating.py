"""The turning of one body over time for pictures: in closed form where it is free, else integrated.

Attitude on the sphere: the paths of the tips of the three body axes, seen in space.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from eom.errors import InputError
from eom.kinematics.coordinates import SEQUENCES
from eom.views.animation.bodies import single, tracks_of, with_attitude
from eom.views.animation.tracks import matrices
from eom.views.body.free import FreeBody, free_body, not_free
from eom.views.draw.formulas import plain
from eom.views.draw.meshes import ellipsoid
from eom.views.draw.picture import Arrow, Axis, Curve, Floats, Item, Marks, Panel, Picture
from eom.views.time.histories import run

if TYPE_CHECKING:
    from codegen import Result
    from eom.opening import AnyScene
    from eom.scenes.scene import Scene

POINTS = 2000
UNSTATED = "The scene states no attitude: the body axes start along those of space."
PERIODS = 1.0
"""Periods of the angular velocity of a free body that are drawn where no time is asked for."""


@dataclass(frozen=True, eq=False)
class Turning:
    """How a body turns over time.

    Parameters
    ----------
    t : array
        (N,), in s.
    omega : array
        (N, 3), in rad/s, along the body axes.
    C : array
        (N, 3, 3), C_BI, whose rows are the body axes in the frame in which attitude is measured.
    title : str
        Of the scene.
    free : FreeBody, optional
        The free body that it is.
    orbit : bool, default False
        Whether that frame is the turning one of an orbit.
    symmetry : int, optional
        Index of the body axis about which the body is symmetric, the two other moments being equal.
    notes : tuple of str, optional
        For a caption.
    """

    t: Floats
    omega: Floats
    C: Floats
    title: str
    free: FreeBody | None = None
    orbit: bool = False
    symmetry: int | None = None
    notes: tuple[str, ...] = ()


def turning(scene: AnyScene, seconds: float | None = None, points: int | None = None) -> Turning:
    """Return how the body of a scene turns, from t = 0 on.

    Parameters
    ----------
    scene : Scene or TreeScene
        Of one body.
    seconds : float, optional
        For how long (s), by default one period of a free body, and the scene's own time of others.
    points : int, optional
        Number of times.

    Returns
    -------
    Turning
        Times, angular velocities and rotations, and what is known of the motion.

    Raises
    ------
    InputError
        For trees, and as `codegen.simulate` does.

    Examples
    --------
    >>> import eom
    >>> turning(eom.load_scene("t-handle"), seconds=2.0, points=201).C.shape
    (201, 3, 3)
    """
    one = single(scene)
    if one is None:
        raise InputError(
            "a tree has many bodies, and this picture is about one",
            where=scene.title or scene.name,
            hint="eom animate shows all bodies",
        )
    if not_free(one):
        return _integrated(one, seconds, points or POINTS)
    body = free_body(one, "attitude")
    found = of_free(body, _span(body, one.integration.t_end, seconds), points or POINTS)
    return replace(found, notes=_unstated(one))


def _span(body: FreeBody, own: float, seconds: float | None) -> float:
    period = body.motion.period
    return seconds or (PERIODS * period if 0 < period < np.inf else own)


def of_free(body: FreeBody, seconds: float, points: int) -> Turning:
    """Return the turning of a free body at ``points`` times up to ``seconds``, in closed form."""
    t = np.linspace(0.0, seconds, points)
    omega, q = body.motion(t)
    C = matrices(q.T)
    return Turning(t, omega.T, C, body.title, body, symmetry=symmetry_of(body.moments))


def symmetry_of(moments: Sequence[float]) -> int | None:
    """Return the index of the only axis about which the two other moments are equal.

    >>> symmetry_of((1.0, 2.0, 1.0)), symmetry_of((1.0, 2.0, 3.0))
    (1, None)
    """
    found = [k for k in range(3) if moments[(k + 1) % 3] == moments[(k + 2) % 3]]
    return found[0] if len(found) == 1 else None


def _integrated(scene: Scene, seconds: float | None, points: int) -> Turning:
    from eom.scenes.description import inertia_values, principal_values

    prepared = with_attitude(_in_quaternion(scene), points, seconds)
    result, _ = run(prepared)
    (track,) = tracks_of(prepared, result).bodies
    C = matrices(track.quaternions)
    return Turning(
        result.t,
        np.einsum("nij,nj->ni", C, track.omega),
        C,
        scene.title or scene.name,
        orbit=scene.torque.gravity_gradient is not None,
        symmetry=symmetry_of(principal_values(scene)) if inertia_values(scene) is None else None,
        notes=(*_stopped(result, prepared.integration.t_end), *_unstated(scene)),
    )


def _unstated(scene: Scene) -> tuple[str, ...]:
    """Return what is to be said of a scene that states no attitude."""
    return (UNSTATED,) if scene.attitude == "none" and scene.model != "spinner" else ()


def _in_quaternion(scene: Scene) -> Scene:
    """Return a scene whose angles are integrated in a quaternion, which no attitude is singular in.

    One whose torque is a formula of its angles is left as it is.
    """
    if scene.attitude not in SEQUENCES or scene.model == "spinner":
        return scene
    try:
        made = type(scene)(**{**scene.model_dump(exclude_unset=True), "integrate": "quaternion"})
        made.derive()
    except InputError:
        return scene
    return made


def _stopped(result: Result, end: float) -> tuple[str, ...]:
    if result.t_stop == end:
        return ()
    return (f"The run stopped at t = {result.t_stop:.4g} s: {result.message}.",)


COLOURS = ("red", "green", "blue")
"""Of the first, second and third body axis."""


def sphere(motion: Turning) -> Picture:
    """Return the paths of the tips of the body axes on the unit sphere, with the axes at the start.

    Parameters
    ----------
    motion : Turning
        Of `eom.views.body.rotating.turning`.

    Returns
    -------
    Picture
        Components are along the axes of the frame in which attitude is measured (rows of C_BI); a
        dot is where a path starts. With a free body, the direction of its angular momentum is
        drawn, too.

    Examples
    --------
    >>> import eom
    >>> from eom.views.body.rotating import turning
    >>> sphere(turning(eom.load_scene("heavy-top"), seconds=2.0)).caption
    'Paths of the body axes in space, from t = 0 (dots) to t = 2 s.'
    """
    letter = motion.free.letter if motion.free else "b"
    items: list[Item] = [ellipsoid((1.0, 1.0, 1.0), "grey", 0.22)]
    for k, colour in enumerate(COLOURS):
        path = motion.C[:, k, :]
        words = rf"$\mathbf{{{letter}}}_{k + 1}$"
        items += [Arrow(np.zeros(3), path[0], colour, 1.8, words), Marks(path[:1], colour, 5.0)]
        if motion.symmetry in {None, k}:
            items.append(Curve(path, colour, 1.2, label=f"path of {words}"))
    if motion.free and motion.free.momentum:
        momentum = motion.C[0].T @ np.multiply(motion.free.moments, motion.free.omega)
        items.append(
            Arrow(
                np.zeros(3),
                1.3 * momentum / np.linalg.norm(momentum),
                "black",
                1.8,
                r"$\mathbf{H}$",
            )
        )
    frame = "the frame of the orbit" if motion.orbit else "space"
    axes = tuple(Axis(rf"along $\mathbf{{a}}_{k}$", limits=(-1.35, 1.35)) for k in (1, 2, 3))
    caption = (
        f"Paths of the body axes in {frame}, from t = 0 (dots) to t = {motion.t[-1]:.4g} s. "
        f"{' '.join(motion.notes)}"
    )
    panel = Panel(tuple(items), axes, equal=True)
    return Picture(((panel,),), plain(motion.title), caption.strip())
