"""Sketches of frames: the axes before, between and after the turns of a sequence, each turn as an arc."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eom.kinematics.coordinates import GREEK_ANGLES, SEQUENCES
from eom.views.body.turns import Frame, after_turns, arc, arc_points, axes_of, triads
from eom.views.draw.picture import (
    Arrow,
    Axis,
    Curve,
    Floats,
    Item,
    Marks,
    Panel,
    Picture,
    Words,
    check,
)
from eom.views.draw.viewpoint import best_view

if TYPE_CHECKING:
    from eom.opening import AnyScene

COLOURS = ("black", "blue", "green", "red")
LETTERS = ("a", "a′", "a″", "b")
SPACE = (Axis(), Axis(), Axis())
ANGLES = tuple(math.radians(x) for x in (40.0, 30.0, 35.0))
"""Angles that show well, where none are asked for."""


def frames_of(sequence: str, angles: Sequence[float]) -> list[Frame]:
    """Return the reference frame, those after the first and the second turn, and the body's."""
    rows = zip(LETTERS, after_turns(sequence, angles), COLOURS, strict=True)
    return [Frame(letter, C, colour) for letter, C, colour in rows]


def frame_sketch(sequence: str, angles: Sequence[float] = ANGLES, title: str = "") -> Picture:
    """Return the four frames of a sequence of turns in space, and below each turn seen along its axis.

    ``sequence``: as "3-2-1", each turn about an axis of the frame before it; ``angles`` (rad): psi, theta,
    phi, of the first, second and third turn. In space an arc leads from the axis that the next turn is
    about (of the last: the turn before) to where the turn takes it. Seen along its axis, which points at
    the reader, a positive turn is anticlockwise.

    Raises `InputError` for an unknown sequence and for angles that are no numbers.

    >>> [len(row) for row in frame_sketch("3-2-1", (0.3, 0.2, 0.1)).rows]
    [1, 3]
    """
    frames, axes = frames_of(sequence, angles), axes_of(sequence, angles)
    items: list[Item] = [*triads(frames)]
    carried = (axes[1], axes[0], axes[1])
    for k, (axis, angle, moved) in enumerate(zip(axes, angles, carried, strict=True)):
        old, new = frames[k], frames[k + 1]
        start = (0.5 + 0.1 * k) * old.axis(moved)
        items += arc(old.axis(axis), start, angle, f"$\\{GREEK_ANGLES[k]}$", new.colour)
    view = best_view([frames[k].axis(axis) for k, axis in enumerate(axes)], items)
    space = Panel(tuple(items), SPACE, equal=True, bare=True, height=1.1, view=view)
    plane = tuple(_seen_along(axes[k], frames[k], frames[k + 1], k, angles[k]) for k in range(3))
    words = title or f"Turns {sequence} from the axes a to the axes b of the body"
    return check(Picture(((space,), plane), words, _told(sequence, angles)))


def sequence_of(scene: AnyScene) -> str:
    """Return the sequence of turns that a scene's attitude is in, empty if it is in none."""
    from eom.scenes.scene import Scene

    if not isinstance(scene, Scene):
        return ""
    if scene.model == "spinner":
        return "3-1-2"
    return scene.attitude if scene.attitude in SEQUENCES else ""


def _told(sequence: str, angles: Sequence[float]) -> str:
    turns = ", ".join(
        f"{math.degrees(angle):.4g} degrees ({name}) about axis {axis}"
        for axis, angle, name in zip(sequence.split("-"), angles, GREEK_ANGLES, strict=True)
    )
    return f"The frame a turns by {turns}, each axis as the turns before have left it."


def _seen_along(axis: int, old: Frame, new: Frame, number: int, angle: float) -> Panel:
    """Return one turn in the plane across its axis."""
    i, j = axis % 3 + 1, (axis + 1) % 3 + 1
    across, up = old.axis(i), old.axis(j)
    items: list[Item] = []
    for frame in (old, new):
        for k in (i, j):
            end = np.array([frame.axis(k) @ across, frame.axis(k) @ up])
            items.append(Arrow(np.zeros(2), end, frame.colour, 1.8, f"${frame.label(k)}$"))
    letter = f"$\\{GREEK_ANGLES[number]}$"
    for start in (np.eye(3)[0], np.eye(3)[1]):
        items += _flat_arc(0.55 * start, angle, letter, new.colour)
    items += _towards_reader(rf"${old.label(axis)} = {new.label(axis)}$", angle)
    axes = (Axis(limits=(-1.35, 1.35)), Axis(limits=(-1.35, 1.35)))
    title = f"{letter} = {math.degrees(angle):.4g}°"
    return Panel(tuple(items), axes, title, equal=True, bare=True, height=0.55)


def _flat_arc(start: Floats, angle: float, words: str, colour: str) -> Iterator[Item]:
    line = arc_points(np.eye(3)[2], start, angle)[:, :2]
    yield Curve(line, colour, 1.4)
    if 0.55 * abs(angle) > 0.15:
        yield Arrow(line[-2], line[-1], colour, 1.4)
    yield Words(arc_points(np.eye(3)[2], start * 1.3, angle / 2)[-1][:2], words, colour)


def _towards_reader(words: str, angle: float) -> Iterator[Item]:
    """Yield the mark of an axis that points at the reader: a dot in a circle, and its name."""
    yield Curve(0.09 * arc_points(np.eye(3)[2], np.eye(3)[0], 2 * math.pi)[:, :2], "black", 1.2)
    yield Marks(np.zeros((1, 2)), size=3.0)
    away = angle / 2 + math.pi * 1.25
    yield Words(0.42 * np.array([math.cos(away), math.sin(away)]), words)
