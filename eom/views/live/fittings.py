"""What is drawn on the bodies of a tree beside their shapes: supports, springs, what constraints hold.

Values stay expressions over the parameters, so that they follow the numbers of a page.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from eom.multibody.algebra.spatial import IDENTITY, ZERO, times, transposed
from eom.multibody.algebra.values import is_number
from eom.multibody.model.bodies import GROUND
from eom.multibody.model.constraints import Distance, KnifeEdge, Loop, Rolling
from eom.multibody.model.model import Tree
from eom.views.live.subject import Fitting

KINDS: Mapping[str, str] = {
    "roll": "radius, half of the axis, centre, axis (zero of a ball), normal and origin of the plane",
    "line": "a point of the first body, a point of the second: a spring, or a rod without mass",
    "pin": "where a loop is closed, on its first body; then pairs of directions, on the first body and on "
    "the second, that coincide where the joint is not turned round",
    "edge": "the point of a knife edge, the direction across it",
    "ball": "where a joint is on the ground",
    "rail": "where a sliding joint is on the ground, the direction of its axis",
}
"""What a fitting's values are, by its kind; three of each point and direction, in the axes of the body."""
TURNING, LOCKED = (
    frozenset({"revolute", "cylindrical", "planar"}),
    frozenset({"prismatic", "fixed"}),
)
"""Kinds of joints that close a loop and keep one axis, or all; their equations hold turned round, too."""
WITHOUT_SUPPORT = frozenset({"free", "fixed", "planar"})
"""Kinds of joints that nothing on the ground holds."""


def fittings_of(tree: Tree) -> tuple[Fitting, ...]:
    """Return the fittings of a tree, in the order in which they are drawn."""
    number = {GROUND: -1, **{b.name: k for k, b in enumerate(tree.bodies)}}
    return (*_supports(tree), *_springs(tree, number), *_held(tree, number))


def _supports(tree: Tree) -> Iterator[Fitting]:
    for joint in (j for j in tree.joints if j.parent == GROUND):
        place = tuple(joint.on_parent.position)
        if joint.kind == "prismatic":
            axis = times(transposed(joint.on_parent.rotation), joint.axis)
            yield Fitting("rail", joint.name, (-1,), (*place, *axis))
        elif joint.kind not in WITHOUT_SUPPORT and joint.motion is None:
            yield Fitting("ball", joint.name, (-1,), place)


def _springs(tree: Tree, number: Mapping[str, int]) -> Iterator[Fitting]:
    for k, spring in enumerate(tree.springs):
        bodies = tuple(number[b] for b in spring.bodies)
        yield Fitting("line", f"spring {k + 1}", bodies, tuple(x for p in spring.points for x in p))


def _held(tree: Tree, number: Mapping[str, int]) -> Iterator[Fitting]:
    for c in tree.constraints:
        if isinstance(c, Rolling):
            axis: Sequence[Any] = ZERO if c.axis is None else c.axis
            values = (c.radius, c.half_axis, *c.centre, *axis, *c.normal, *c.origin)
            yield Fitting("roll", c.name, (number[c.body],), values)
        elif isinstance(c, Distance):
            ends = (number[c.first], number[c.second])
            yield Fitting("line", c.name, ends, (*c.first_point, *c.second_point))
        elif isinstance(c, Loop):
            yield Fitting("pin", c.name, (number[c.first], number[c.second]), tuple(_closed(c)))
        elif isinstance(c, KnifeEdge):
            yield Fitting("edge", c.name, (number[c.body],), (*c.point, *c.direction))


def _closed(loop: Loop) -> Iterator[Any]:
    """Yield where a loop is closed, and directions of the joint's frames that must coincide."""
    yield from loop.on_first.position
    alike: Sequence[Any] = ()
    if loop.kind in LOCKED:
        alike = IDENTITY
    elif loop.kind in TURNING:
        alike = (loop.axis,)
    for axis in alike:
        for frame in (loop.on_first, loop.on_second):
            yield from times(transposed(frame.rotation), axis)


def sizes_of(tree: Tree) -> set[str]:
    """Return the names of parameters that are a radius or a length, and so above zero."""
    given = [c.radius for c in tree.constraints if isinstance(c, Rolling)]
    given += [c.half_axis for c in tree.constraints if isinstance(c, Rolling)]
    given += [c.length for c in tree.constraints if isinstance(c, Distance)]
    return {x.name for x in given if not is_number(x) and x.is_Symbol}
