"""Forces and torques on the bodies of a tree over time: loads, what joints drive and brake, weights.

Components are in the ground's axes. What a joint does is drawn as it acts on the child, along the joint's
axis, by springs, dampers, applied forces and motors; constraints and reactions are not drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np

from eom.multibody.model.model import GROUND, Joint, Tree
from eom.views.animation.tracks import Acting, Floats, Track, turned

MOST = 24
"""Arrows at most: loads come first, then joints, then weights."""
AXIAL = {"revolute": "torque", "prismatic": "force"}
"""Kinds of joints with one axis along which they act."""
LETTERS = {"force": "F", "torque": "τ"}

Lift = Callable[[Any], Any]
"""From a value of the tree to a number, or one for each time."""


def acting(tree: Tree, lift: Lift, tracks: Sequence[Track]) -> tuple[Acting, ...]:
    """Return what acts on the bodies of a tree, whose motions are the first of ``tracks``.

    ``lift``: see `Lift`. What is zero at all times is left out.
    """
    by_name = {b.name: t for b, t in zip(tree.bodies, tracks, strict=False)}
    found = (
        *_loads(tree, lift, by_name),
        *_joints(tree, lift, by_name),
        *_weights(tree, lift, by_name),
    )
    return tuple(islice((a for a in found if np.any(a.values)), MOST))


def _rows(values: Sequence[Any], lift: Lift, count: int) -> Floats:
    """Return a vector over time, shape (N, 3)."""
    columns = (np.broadcast_to(np.asarray(lift(v), dtype=np.float64), (count,)) for v in values)
    return np.stack([*columns], axis=-1)


def _at(track: Track | None, point: Floats) -> Floats:
    """Return where a point of a body is, or of the ground."""
    return point if track is None else track.positions + turned(track.quaternions, point)


def _loads(tree: Tree, lift: Lift, tracks: Mapping[str, Track]) -> Iterator[Acting]:
    for load in tree.loads:
        track = tracks[load.body]
        count = len(track.positions)
        place = _at(track, _rows(load.point, lift, count))
        for kind, given in (("force", load.force), ("torque", load.torque)):
            own = _rows(given, lift, count)
            inside = turned(track.quaternions, own) if load.axes == "body" else own
            yield Acting(kind, LETTERS[kind], load.body, inside, place)


def _joints(tree: Tree, lift: Lift, tracks: Mapping[str, Track]) -> Iterator[Acting]:
    for joint in tree.ordered:
        if joint.kind in AXIAL and joint.motion is None and joint.child != GROUND:
            track = tracks[joint.child]
            count = len(track.positions)
            turn = np.array(
                [[float(np.ravel(lift(x))[0]) for x in row] for row in joint.on_child.rotation]
            )
            axis = _rows(joint.axis, lift, count) @ turn
            size = np.broadcast_to(_law(joint, lift), (count,))
            place = _at(track, _rows(joint.on_child.position, lift, count))
            values = size[:, None] * turned(track.quaternions, axis)
            kind = AXIAL[joint.kind]
            yield Acting(kind, LETTERS[kind], joint.name, values, place)


def _law(joint: Joint, lift: Lift) -> Floats:
    """Return what acts along the axis of a joint, on the child."""
    x, u = lift(joint.coordinates[0].symbol), lift(joint.speeds[0].symbol)
    spring = lift(joint.stiffness[0]) * (x - lift(joint.rest[0]))
    motor = lift(joint.motors[0].symbol) if joint.motors else 0.0
    return np.asarray(
        lift(joint.force[0]) + motor - spring - lift(joint.damping[0]) * u, dtype=float
    )


def _weights(tree: Tree, lift: Lift, tracks: Mapping[str, Track]) -> Iterator[Acting]:
    for body in tree.bodies:
        track = tracks[body.name]
        count = len(track.positions)
        mass = np.broadcast_to(np.asarray(lift(body.mass), dtype=np.float64), (count,))
        centre = _at(track, _rows(body.centre, lift, count))
        yield Acting(
            "force", "mg", body.name, mass[:, None] * _rows(tree.gravity, lift, count), centre
        )
