"""Frames and turns in space: axes of frames after each turn of a sequence, arcs between axes, triads.

C takes components in the reference frame to those in a frame, so that its rows are the frame's axes in
the reference frame. Angles are in radians; an arc runs by the right-hand rule about its axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from eom.errors import InputError, unknown_name
from eom.kinematics.coordinates import SEQUENCES
from eom.views.draw.meshes import Faces
from eom.views.draw.picture import Arrow, Curve, Floats, Item, Surface, Words

STEP = math.radians(3)
"""Angle between the points of an arc, at most."""
PARALLEL = 1e-6
"""Axes whose directions differ by less are one line, with one label."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame: the letter of its axes, C of shape (3, 3), colour, and length of its arrows.

    ``letter`` is TeX, ``a`` or ``a′``.
    """

    letter: str
    C: Floats
    colour: str
    length: float = 1.0

    def axis(self, number: int) -> Floats:
        """Return axis 1, 2 or 3 in the reference frame, shape (3,)."""
        axis: Floats = self.C[number - 1]
        return axis

    def label(self, number: int) -> str:
        """Return the name of an axis in TeX, without dollar signs."""
        return rf"\mathbf{{{self.letter[0]}}}{self.letter[1:]}_{number}"


def elementary(axis: int, angle: float) -> Floats:
    """Return C of a turn by ``angle`` (rad) about axis 1, 2 or 3."""
    i, j = axis % 3, (axis + 1) % 3
    C = np.eye(3)
    C[i, i] = C[j, j] = math.cos(angle)
    C[i, j], C[j, i] = math.sin(angle), -math.sin(angle)
    return C


def axes_of(sequence: str, angles: Sequence[float]) -> tuple[int, ...]:
    """Return the three axes of a sequence of turns.

    Raises `InputError` for an unknown sequence, and for other than three angles that are numbers.
    """
    if sequence not in SEQUENCES:
        raise unknown_name("rotation sequence", sequence, SEQUENCES)
    if len(angles) != 3 or not all(map(math.isfinite, angles)):
        got = ", ".join(map(str, angles))
        raise InputError("not three angles", where=f"turns {sequence}", got=got, expected="radians")
    return tuple(map(int, sequence.split("-")))


def after_turns(sequence: str, angles: Sequence[float]) -> list[Floats]:
    """Return C of the reference frame and after each turn of a sequence about body axes.

    Raises as `axes_of`.
    """
    found = [np.eye(3)]
    for axis, angle in zip(axes_of(sequence, angles), angles, strict=True):
        found.append(elementary(axis, angle) @ found[-1])
    return found


def arc_points(axis: Floats, start: Floats, angle: float) -> Floats:
    """Return points of the arc on which ``start`` turns by ``angle`` about a unit vector, (N, 3).

    The part of ``start`` along the axis is left out: the arc lies in the plane across the axis.
    """
    first = start - axis * (axis @ start)
    second = np.cross(axis, first)
    t = np.linspace(0.0, angle, 2 + math.ceil(abs(angle) / STEP))[:, None]
    return np.cos(t) * first + np.sin(t) * second


def arc(
    axis: Floats, start: Floats, angle: float, words: str, colour: str, tip: float = 0.06
) -> Iterator[Item]:
    """Yield the arc of a turn about the origin, the sector within it, an arrow's tip, and its letter.

    ``tip``: least length of the last piece, which has the arrow's tip; an arc that is shorter has none.
    """
    line = arc_points(axis, start, angle)
    radius = float(np.linalg.norm(line[0]))
    yield Curve(line, colour, 1.6)
    yield Surface(np.concatenate([np.zeros((1, 3)), line]), _fan(len(line)), colour, 0.15)
    if radius * abs(angle) > tip:
        before = arc_points(axis, start, angle * (1 - tip / (radius * abs(angle))))[-1]
        yield Arrow(before, line[-1], colour, 1.6)
    middle = arc_points(axis, start, angle / 2)[-1]
    yield Words(middle * (1 + 0.13 / radius), words, colour)


def _fan(count: int) -> Faces:
    k = np.arange(1, count)
    return np.stack([np.zeros_like(k), k, k + 1], axis=1)


def triads(frames: Sequence[Frame], origin: Floats | None = None) -> Iterator[Item]:
    """Yield the axes of frames at one origin; axes that are one line get one arrow and label.

    The arrow is that of the first frame that has the axis; the label joins all names by signs of equality.
    """
    start = np.zeros(3) if origin is None else origin
    lines: list[tuple[Frame, int, list[str]]] = []
    for frame in frames:
        for number in (1, 2, 3):
            same = next((row for row in lines if _together(row, frame, number)), None)
            if same is None:
                lines.append((frame, number, [frame.label(number)]))
            else:
                same[2].append(frame.label(number))
    for frame, number, labels in lines:
        end = start + frame.length * frame.axis(number)
        yield Arrow(start, end, frame.colour, 1.8, f"${' = '.join(labels)}$")


def _together(row: tuple[Frame, int, list[str]], frame: Frame, number: int) -> bool:
    return bool(np.linalg.norm(row[0].axis(row[1]) - frame.axis(number)) < PARALLEL)
