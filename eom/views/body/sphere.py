"""Attitude on the sphere: the paths of the tips of the three body axes, seen in space."""

from __future__ import annotations

import numpy as np

from eom.views.body.rotating import Turning
from eom.views.draw.formulas import plain
from eom.views.draw.meshes import ellipsoid
from eom.views.draw.picture import Arrow, Axis, Curve, Item, Marks, Panel, Picture

COLOURS = ("red", "green", "blue")
"""Of the first, second and third body axis."""


def sphere(motion: Turning) -> Picture:
    """Return the paths of the tips of the body axes on the unit sphere, with the axes at the start.

    ``motion``: of `eom.views.body.rotating.turning`. Components are along the axes of the frame in which
    attitude is measured (rows of C_BI); a dot is where a path starts. With a free body, the direction of
    its angular momentum is drawn, too.

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
