"""The frames of a tree at its start: the ground's and those of the bodies, with labelled axes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from eom.multibody.files.scene import TreeScene
from eom.multibody.model.model import GROUND
from eom.views.body.frame_sketches import SPACE
from eom.views.draw.labels import names
from eom.views.draw.lettering import name, plain
from eom.views.draw.picture import Arrow, Curve, Item, Marks, Panel, Picture, check
from eom.views.draw.viewpoint import CROWDED, best_view
from eom.views.tree.tree_sketch import TreeSketch, upright

COLOURS = ("blue", "red", "green", "purple", "orange", "sky", "grey")
MOST_INDEXED = 6
"""Bodies whose axes have the body's name as an index; of more, the names stand at the origins alone."""


def tree_frames(scene: TreeScene) -> Picture:
    """Return the axes x, y, z of the ground (black) and of all bodies at the start, at their origins.

    ``scene``: its tree, numbers and start. Grey lines lead along the bodies from joint to joint. What is up
    by gravity is drawn upwards; lengths of axes say nothing. Raises `InputError` as the scene does.

    >>> import eom
    >>> tree_frames(eom.load_scene("double-pendulum")).caption
    'The frames of the ground and of 2 bodies at the start.'
    """
    s = TreeSketch.of(scene)
    items: list[Item] = [*_bones(s), *_axes(s, GROUND, "black", "")]
    for k, body in enumerate(s.tree.bodies):
        index = body.name if len(s.tree.bodies) <= MOST_INDEXED else ""
        items += _axes(s, body.name, COLOURS[k % len(COLOURS)], index)
    items = [upright(item, s.upright) for item in items]
    view = best_view((), items, CROWDED)
    if len(s.tree.bodies) > MOST_INDEXED:
        origins = {plain(b.name): s.upright @ s.bodies[b.name].origin for b in s.tree.bodies}
        items += names(origins, items, view, 0.15 * s.size)
    panel = Panel(tuple(items), SPACE, equal=True, bare=True, height=1.4, view=view)
    told = f"The frames of the ground and of {len(s.tree.bodies)} bodies at the start."
    return check(Picture(((panel,),), plain(scene.title or scene.name), told))


def _bones(s: TreeSketch) -> Iterator[Item]:
    for joint in s.tree.ordered:
        frame, _ = s.joints[joint.name]
        if joint.kind != "free":
            for body in (joint.parent, joint.child):
                yield Curve(np.stack([s.bodies[body].origin, frame.origin]), "grey", 1.5)
            yield Marks(frame.origin[None], "grey", 5.0)


def _axes(s: TreeSketch, body: str, colour: str, index: str) -> Iterator[Item]:
    """Yield the three axes of a body; a longer set is the ground's."""
    place, length = s.bodies[body], (0.55 if body == GROUND else 0.4) * s.size
    below = f"_{{{name(index).strip('$')}}}" if index else ""
    for axis, letter in zip(place.C, "xyz", strict=True):
        words = f"${letter}{below}$" if index or body == GROUND else ""
        yield Arrow(place.origin, place.origin + length * axis, colour, 1.8, words)
