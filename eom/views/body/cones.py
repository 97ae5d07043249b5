"""Body cone and space cone: the surfaces that the axis of rotation traces in the body and in space.

The body cone rolls on the space cone without slip along omega (Goldstein, Poole, Safko, Classical
Mechanics, 2002, sect. 5.6-5.7; Hughes, Spacecraft Attitude Dynamics, 1986, ch. 4). Both are drawn at
t = 0 with edges of unit length.
"""

from __future__ import annotations

import numpy as np

from eom.errors import InputError
from eom.views.body.free import CLASSES, FreeBody, class_of, moving, polhode_points
from eom.views.body.poinsot import clear_of, traced
from eom.views.body.polhodes import OWN
from eom.views.body.rotating import Turning
from eom.views.draw.formulas import plain
from eom.views.draw.meshes import grid_faces
from eom.views.draw.picture import Arrow, Axis, Curve, Floats, Item, Panel, Picture, Surface

BODY, SPACE = "blue", "green"
ACROSS = 240
"""Generators of a cone that are drawn."""
LENGTH = 1.25
"""Length of the arrows; the edges of the cones have length 1."""


def cones(motion: Turning, seconds: float | None = None) -> Picture:
    """Return the body cone and the space cone of a motion at t = 0.

    Parameters
    ----------
    motion : Turning
        Of `eom.views.body.rotating.turning`.
    seconds : float, optional
        How much of a free body's space cone (s), as of `free_cones`.

    Returns
    -------
    Picture
        Edges have length 1, without a unit. Cones of a free body are exact and have H upright; with
        a torque they are those of the integrated motion, in the frame in which attitude is
        measured.

    Raises
    ------
    InputError
        For attitude in a frame that turns, and for a body at rest.

    Examples
    --------
    >>> import eom
    >>> from eom.views.body.rotating import turning
    >>> made = cones(turning(eom.load_scene("heavy-top"), seconds=1.0))
    >>> [item.label for item in made.rows[0][0].items if item.label]
    ['body cone', 'space cone']
    """
    if motion.orbit:
        raise InputError(
            "no cones of this scene: its attitude is measured in a frame that turns with an orbit",
            where=motion.title,
            hint="--what sphere shows the body in that frame",
        )
    return _integrated(motion) if motion.free is None else free_cones(motion.free, seconds)


def free_cones(body: FreeBody, seconds: float | None = None) -> Picture:
    """Return the exact cones of a free body at t = 0, H upright, edges of length 1 without a unit.

    Parameters
    ----------
    body : FreeBody
        Moments, and where it starts.
    seconds : float, optional
        How much of the space cone (s), by default one period of the angular velocity, or what
        `eom.views.body.poinsot.herpolhode` takes of a motion without.

    Returns
    -------
    Picture
        H upright, edges of length 1 without a unit; the body cone rolls on the space cone along
        omega.

    Raises
    ------
    InputError
        For a body at rest and for moments that no body has.

    References
    ----------
    Goldstein, Classical Mechanics (2002), sect. 5.6.

    Examples
    --------
    >>> from eom.views.body.free import FreeBody
    >>> handle = FreeBody((1.5e-4, 4.0e-4, 5.2e-4), (0.05, 10.0, 0.05))
    >>> [item.label for item in free_cones(handle).rows[0][0].items if item.label]
    ['body cone', 'space cone', 'axis that is encircled']
    """
    body.turning("cone")
    path = traced(body, seconds, periods=1.0)
    exact = body.polhode
    items: list[Item] = []
    if moving(exact):
        items += _cone(polhode_points(exact) @ path.first, BODY, "body cone")
        items += _cone(path.space, SPACE, "space cone")
    longer = clear_of(np.array(body.omega), np.multiply(body.moments, body.omega))
    axis = exact.frame.axes[2]
    sign = exact.frame.signs[2]
    items += [
        Arrow(np.zeros(3), np.array([0.0, 0.0, LENGTH * longer]), "black", 1.8, r"$\mathbf{H}$"),
        Arrow(
            np.zeros(3),
            LENGTH * _unit(np.array(body.omega)) @ path.first,
            OWN,
            2.0,
            r"$\mathbf{\omega}$",
        ),
    ]
    if moving(exact):
        words = body.axis(axis + 1) if sign > 0 else f"$-${body.axis(axis + 1)}"
        items.append(
            Arrow(
                np.zeros(3),
                LENGTH * sign * path.first[axis],
                BODY,
                1.5,
                words,
                "axis that is encircled",
            )
        )
    kind = CLASSES[class_of(exact)].words if moving(exact) else "constant angular velocity"
    caption = (
        "The body cone is fixed in the body and rolls on the space cone, which is fixed in space; they "
        f"touch along the angular velocity. Here: {kind}, H upright, t = 0."
    )
    return _picture(items, body.title, caption)


def _integrated(motion: Turning) -> Picture:
    size = np.linalg.norm(motion.omega, axis=1)
    if not size.max() > 0:
        raise InputError("the body is at rest: it has no cone", where=motion.title)
    turning = motion.omega[size > 1e-9 * size.max()]
    C = motion.C[size > 1e-9 * size.max()]
    space = np.einsum("nki,nk->ni", C, turning)
    first = C[0]
    items: list[Item] = [
        *_cone(turning @ first, BODY, "body cone"),
        *_cone(space, SPACE, "space cone"),
        Arrow(np.zeros(3), LENGTH * _unit(space[0]), OWN, 2.0, r"$\mathbf{\omega}$"),
    ]
    items += [
        Arrow(np.zeros(3), LENGTH * np.eye(3)[k], "black", 1.0, rf"$\mathbf{{a}}_{k + 1}$")
        for k in range(3)
    ]
    caption = (
        "The axis of rotation traces the body cone in the body, drawn as it lies at t = 0, and the space "
        f"cone in space, up to t = {motion.t[-1]:.4g} s. {' '.join(motion.notes)}"
    )
    return _picture(items, motion.title, caption.strip())


def _picture(items: list[Item], title: str, caption: str) -> Picture:
    axes = (Axis("$x$"), Axis("$y$"), Axis("$z$"))
    panel = Panel(tuple(items), axes, equal=True, bare=True)
    return Picture(((panel,),), plain(title), caption)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def _cone(vectors: Floats, colour: str, label: str) -> list[Item]:
    """Return the cone through the directions of vectors (N, 3), with its edge."""
    edge = _unit(vectors)
    chosen = edge[
        np.unique(np.linspace(0, len(edge) - 1, min(len(edge), ACROSS * 4)).round().astype(int))
    ]
    rings = np.linspace(0.0, 1.0, 9)[:, None, None] * _spread(edge)[None]
    count = rings.shape[1]
    faces = grid_faces(9, count)
    return [
        Surface(rings.reshape(-1, 3), faces, colour, 0.3, label),
        Curve(chosen, colour, 1.6),
    ]


def _spread(edge: Floats) -> Floats:
    """Return at most `ACROSS` points of a line, equally far from each other along it."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(edge, axis=0), axis=1))])
    where = np.linspace(0.0, float(along[-1]), min(len(edge), ACROSS))
    return _unit(np.stack([np.interp(where, along, column) for column in edge.T], -1))
