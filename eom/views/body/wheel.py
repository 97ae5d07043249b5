"""The 3-1-2 spinning symmetric body: a wheel with its axle, and the angles psi, theta, phi as arcs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eom.errors import InputError
from eom.views.body.frame_sketches import SPACE
from eom.views.body.turns import Frame, after_turns, arc, arc_points, triads
from eom.views.draw.lettering import plain
from eom.views.draw.meshes import grid_faces
from eom.views.draw.picture import Curve, Floats, Item, Panel, Picture, Surface, check
from eom.views.draw.viewpoint import best_view

if TYPE_CHECKING:
    from eom.opening import AnyScene

SEQUENCE = "3-1-2"
FRAMES = (("i", "black", 1.75), ("a", "blue", 1.6), ("b", "green", 1.6), ("c", "red", 1.25))
"""Letters, colours and lengths of the inertial frame, those after psi and theta, and the body's."""
ANGLES = tuple(math.radians(x) for x in (40.0, 25.0, 50.0))
RIM, SPOKES = 1.0, 8


def wheel(angles: Sequence[float] = ANGLES, title: str = "") -> Picture:
    r"""Return the wheel at the ``angles`` psi, theta, phi (rad): turns about axes 3, 1 and 2.

    The axle is along b2 = c2, and c1 along the red spoke. psi leads from i1 to the node line a1 about
    the vertical i3, theta from the level a2 to the axle b2 about a1, phi, the spin, from b1 to c1 about the
    axle. Lengths are without a unit; the body is that of lecture 001. Raises `InputError` for angles that
    are no numbers.

    >>> wheel((0.0, 0.0, 0.0)).caption.split(",")[0]
    'A wheel after turns of psi = 0 degrees about the vertical'
    """
    rows = zip(FRAMES, after_turns(SEQUENCE, angles), strict=True)
    i, a, b, c = (Frame(letter, C, colour, size) for (letter, colour, size), C in rows)
    items: list[Item] = [
        *_body(c),
        *arc(i.axis(3), 1.3 * i.axis(1), angles[0], r"$\psi$", "blue"),
        *arc(a.axis(1), 1.3 * a.axis(2), angles[1], r"$\theta$", "green"),
        *arc(b.axis(2), 0.75 * b.axis(1), angles[2], r"$\phi$", "red"),
        *triads((i, a, b, c)),
    ]
    view = best_view([i.axis(3), a.axis(1), b.axis(2)], items)
    panel = Panel(tuple(items), SPACE, equal=True, bare=True, height=1.3, view=view)
    psi, theta, phi = (f"{math.degrees(x):.4g}" for x in angles)
    told = (
        f"A wheel after turns of psi = {psi} degrees about the vertical, theta = {theta} degrees about the "
        f"node line and phi = {phi} degrees about its axle."
    )
    words = title or "The 3-1-2 spinning symmetric body"
    return check(Picture(((panel,),), words, told))


def wheel_of(scene: AnyScene, seconds: float | None = None) -> Picture:
    """Return the wheel of a spinner's scene at a time; without a time at angles that are seen well.

    ``scene``: of the model "spinner"; ``seconds``: the time (s) up to which it is integrated. Angles and
    axes as of `wheel`. Raises `InputError` as `codegen.simulate` does, and for a scene that is none of a
    spinner.

    >>> import eom
    >>> wheel_of(eom.load_scene("bicycle-wheel")).title
    'Bicycle wheel spinning on its axle, held by one end'
    """
    from eom.scenes.scene import Scene
    from eom.views.animation.tracks import with_attitude
    from eom.views.time.histories import run

    if not isinstance(scene, Scene) or scene.model != "spinner":
        raise InputError("not the scene of a spinner", where=scene.title or scene.name)
    title = plain(scene.title or scene.name)
    if seconds is None:
        return wheel(title=title)
    result, _ = run(with_attitude(scene, 2, seconds))
    if not result.t_stop == seconds:
        raise InputError("the run stopped before", where=title, got=result.message)
    return wheel([float(result[n][-1]) for n in ("psi", "theta", "phi")], title)


def _body(frame: Frame) -> Iterator[Item]:
    """Yield rim, axle and spokes of a wheel whose axle is axis 2 of a frame."""
    yield Surface(_tube(RIM, 0.05) @ frame.C, grid_faces(73, 13), "grey", 1.0)
    yield Surface(_cylinder(0.045, -0.55, 1.3) @ frame.C, grid_faces(2, 17), "grey", 0.6)
    for k in range(SPOKES):
        way = arc_points(frame.axis(2), frame.axis(1), 2 * math.pi * k / SPOKES)[-1]
        colour, width = ("red", 2.2) if k == 0 else ("grey", 1.0)
        yield Curve(np.stack([0 * way, RIM * way]), colour, width)


def _tube(radius: float, thickness: float) -> Floats:
    """Return a ring about axis 2, shape (73 * 13, 3)."""
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 73), np.linspace(0, 2 * np.pi, 13), indexing="ij")
    r = radius + thickness * np.cos(v)
    return np.stack([r * np.cos(u), thickness * np.sin(v), r * np.sin(u)], axis=-1).reshape(-1, 3)


def _cylinder(radius: float, start: float, end: float) -> Floats:
    """Return the side of a cylinder along axis 2, shape (2 * 17, 3)."""
    u, y = np.meshgrid(np.linspace(0, 2 * np.pi, 17), [start, end])
    return np.stack([radius * np.cos(u), y, radius * np.sin(u)], axis=-1).reshape(-1, 3)
