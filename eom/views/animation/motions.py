"""Motions that are no scenes, as animations: closed forms, a gyrostat, another program's attitude."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from eom.errors import InputError
from eom.views.animation.animation import (
    BUDGET,
    BYTES_OF_BODY,
    BYTES_OF_VECTOR,
    LARGEST_STEP,
    Animation,
    arrows_of,
    speed_of,
    view_of,
)
from eom.views.animation.equivalents import Shape, equivalent
from eom.views.animation.figures import Figure, Figures
from eom.views.animation.tracks import Floats, Track, Tracks, continuous, turned


def animation_of_motion(
    title: str,
    times: ArrayLike,
    quaternions: ArrayLike,
    omega: ArrayLike,
    inertia: ArrayLike,
    *,
    mass: float | None = None,
    momentum: ArrayLike | None = None,
    torque: ArrayLike | None = None,
    speed: float | None = None,
) -> Animation:
    """Return the animation of one body about a point that stays.

    ``times`` (s), shape (N,), equally far apart. ``quaternions`` of C_BA, scalar first, shape (N, 4).
    ``omega`` (rad/s), ``momentum`` (N m s, by default J omega) and ``torque`` (N m, by default none):
    components in the body frame B, shape (N, 3). ``inertia`` J (kg m^2): three principal moments or a
    matrix, and ``mass`` (kg), if known, give the uniform body that is drawn. ``speed``: seconds of the
    motion that are shown in one.

    Raises `InputError` for arrays that do not fit, quaternions that are none, times that are not equally
    far apart or so far that the body turns by more than 2 radians between two.

    >>> import numpy as np
    >>> t = np.linspace(0.0, 4.0, 41)
    >>> q = np.stack([np.cos(t / 2), 0 * t, 0 * t, np.sin(t / 2)], axis=1)  # 1 rad/s about b3
    >>> omega = np.broadcast_to((0.0, 0.0, 1.0), (41, 3))
    >>> made = animation_of_motion("A steady turn", t, q, omega, (1.0, 2.0, 3.0), mass=4.0)
    >>> made.figures.bodies[0].words
    'box of equal inertia (a 2.45 m, b 1.73 m, c 0.122 m, thickened)'
    """
    t = np.asarray(times, dtype=np.float64)
    rows = {"quaternions": (quaternions, 4), "omega": (omega, 3),
            "momentum": (momentum, 3), "torque": (torque, 3)}  # fmt: skip
    given = {n: _rows(n, v, (len(t), width)) for n, (v, width) in rows.items() if v is not None}
    w, q = given["omega"], _unit(given["quaternions"])
    _check_times(t, w)
    J = np.asarray(inertia, dtype=np.float64)
    J = np.diag(J) if J.ndim == 1 else J
    h = given.get("momentum", w @ J.T)
    still = np.zeros((len(t), 3))
    track = Track(title, still, q, turned(q, w))
    m = turned(q, given["torque"]) if "torque" in given else None
    tracks = Tracks(t, (track,), turned(q, h), still, m)
    body = equivalent(J, mass)
    unknown = "" if mass else "; its size is not known"
    tip = 1.15 * body.mesh.extent * np.eye(3)[2]
    figures = Figures((Figure(title, (Shape(body.mesh),), body.words + unknown, tip=tip),))
    return Animation(
        title=title,
        words="",
        tracks=tracks,
        figures=figures,
        arrows=tuple(arrows_of(tracks)),
        told=(),
        view=view_of(tracks, figures),
        speed=speed or speed_of(float(t[-1] - t[0])),
        notes=(f"Drawn: {figures.bodies[0].words}",),
    )


def _rows(name: str, values: ArrayLike, shape: tuple[int, int]) -> Floats:
    found = np.asarray(values, dtype=np.float64)
    if found.shape != shape or not np.isfinite(found).all():
        got = f"shape {found.shape}" if found.shape != shape else "numbers that are not finite"
        raise InputError("an array does not fit", where=name, got=got, expected=f"shape {shape}")
    return found


def _unit(q: Floats) -> Floats:
    norms = np.linalg.norm(q, axis=1)
    if np.abs(norms - 1).max() > 1e-3:
        got = f"norms from {norms.min():.6g} to {norms.max():.6g}"
        raise InputError("quaternions do not have unit norm", where="quaternions", got=got)
    return continuous(q)


def _check_times(t: Floats, omega: Floats) -> None:
    steps = np.diff(t)
    if t.ndim != 1 or len(t) < 2 or not (steps > 0).all() or np.ptp(steps) > 1e-6 * steps[0]:
        raise InputError(
            "times are not equally far apart", where="times", expected="shape (N,), N > 1"
        )
    turn = float(np.linalg.norm(omega, axis=1).max() * steps[0])
    if turn > LARGEST_STEP:
        got, expected = f"{turn:.3g} radians", f"at most {LARGEST_STEP:g}"
        raise InputError(
            "too large a turn between two times", where="times", got=got, expected=expected
        )
    most = int(BUDGET / (BYTES_OF_BODY + 3 * BYTES_OF_VECTOR))
    if len(t) > most:
        raise InputError(
            "too many times for one page", where="times", got=len(t), expected=f"at most {most}"
        )


def quaternions_of_rodrigues(parameters: ArrayLike) -> Floats:
    """Return unit quaternions (N, 4) of Rodrigues parameters, axis tan(angle/2), shape (N, 3)."""
    p = np.asarray(parameters, dtype=np.float64)
    q = np.concatenate([np.ones((len(p), 1)), p], axis=1)
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True))


def quaternions_of_modified_rodrigues(parameters: ArrayLike) -> Floats:
    """Return unit quaternions (N, 4) of modified Rodrigues parameters, axis tan(angle/4), shape (N, 3)."""
    p = np.asarray(parameters, dtype=np.float64)
    square = np.einsum("ni,ni->n", p, p)[:, None]
    return np.asarray(np.concatenate([1 - square, 2 * p], axis=1) / (1 + square))
