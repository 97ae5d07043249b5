"""Sketches of frames: the axes before, between and after the turns of a sequence, each turn as an arc.

C takes components in the reference frame to those in a frame, so that its rows are the frame's axes in
the reference frame. Angles are in radians; an arc runs by the right-hand rule about its axis. The wheel is
the 3-1-2 spinning symmetric body, with its angles psi, theta, phi as arcs.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eom.errors import InputError, unknown_name
from eom.kinematics.coordinates import GREEK_ANGLES, SEQUENCES
from eom.views.animation.bodies import single, with_attitude
from eom.views.draw.formulas import short
from eom.views.draw.meshes import Faces, of_solid
from eom.views.draw.picture import (
    Arrow,
    Axis,
    Curve,
    Floats,
    Item,
    Marks,
    Panel,
    Picture,
    Surface,
    Words,
    check,
)
from eom.views.draw.viewpoint import best_view
from eom.views.time.histories import run

if TYPE_CHECKING:
    from eom.opening import AnyScene
    from eom.scenes.scene import Scene

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

    Parameters
    ----------
    sequence : str
        As "3-2-1", each turn about an axis of the frame before it.
    angles : sequence of floats, optional
        Of ``angles`` (rad) psi, theta and phi are those of the first, second and third turn; 40, 30
        and 35 degrees by default.
    title : str, optional
        Above the picture, the sequence unless given.

    Returns
    -------
    Picture
        Four frames in space: an arc leads from the axis that the next turn is about (of the last:
        the turn before) to where the turn takes it. Below, each turn seen along its axis, which
        points at the reader, so that a positive turn is anticlockwise.

    Raises
    ------
    InputError
        For an unknown sequence and for angles that are no numbers.

    Examples
    --------
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
    return check(Picture(((space,), plane), words, _caption(sequence, angles)))


def sequence_of(scene: AnyScene) -> str:
    """Return the sequence of turns that a scene's attitude is in, empty if it is in none."""
    one = single(scene)
    if one is None:
        return ""
    if one.model == "spinner":
        return SPUN
    return one.attitude if one.attitude in SEQUENCES else ""


def _caption(sequence: str, angles: Sequence[float]) -> str:
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


SPUN = "3-1-2"
FRAMES = (("i", "black", 1.75), ("a", "blue", 1.6), ("b", "green", 1.6), ("c", "red", 1.25))
"""Letters, colours and lengths of the inertial frame, those after psi and theta, and the body's."""
WHEEL_ANGLES = tuple(math.radians(x) for x in (40.0, 25.0, 50.0))
RIM, SPOKES = 1.0, 8


def wheel(
    angles: Sequence[float] = WHEEL_ANGLES, title: str = "", *, held: float | None = None
) -> Picture:
    r"""Return the wheel at the ``angles`` psi, theta, phi (rad): turns about axes 3, 1 and 2.

    Parameters
    ----------
    angles : sequence of floats, optional
        psi, theta, phi (rad): turns about axes 3, 1 and 2.
    title : str, optional
        Above the picture.
    held : float, optional
        How far from the middle of the wheel, along -b2, the fixed point O of the axle is, on its
        stand; none unless given.

    Returns
    -------
    Picture
        Lengths are in radii of the rim; the body is that of lecture 001.

    Raises
    ------
    InputError
        For angles that are no numbers.

    Notes
    -----
    The axle is along b2 = c2, and c1 along the red spoke. psi leads from i1 to the node line a1
    about the vertical i3, theta from the level a2 to the axle b2 about a1, phi, the spin, from b1
    to c1 about the axle.

    Examples
    --------
    >>> wheel((0.0, 0.0, 0.0)).caption.split(",")[0]
    'A wheel after turns of psi = 0 degrees about the vertical'
    """
    rows = zip(FRAMES, after_turns(SPUN, angles), strict=True)
    i, a, b, c = (Frame(letter, C, colour, size) for (letter, colour, size), C in rows)
    items: list[Item] = [
        *_body(c),
        *(() if held is None else _stand(-held * c.axis(2))),
        *arc(i.axis(3), 1.3 * i.axis(1), angles[0], r"$\psi$", "blue"),
        *arc(a.axis(1), 1.3 * a.axis(2), angles[1], r"$\theta$", "green"),
        *arc(b.axis(2), 0.75 * b.axis(1), angles[2], r"$\phi$", "red"),
        *triads((i, a, b, c)),
    ]
    view = best_view([i.axis(3), a.axis(1), b.axis(2)], items)
    panel = Panel(tuple(items), SPACE, equal=True, bare=True, height=1.3, view=view)
    psi, theta, phi = (f"{math.degrees(x):.4g}" for x in angles)
    caption = (
        f"A wheel after turns of psi = {psi} degrees about the vertical, theta = {theta} degrees about the "
        f"node line and phi = {phi} degrees about its axle."
    )
    caption += "" if held is None else " The point O of the axle is fixed."
    words = title or "The 3-1-2 spinning symmetric body"
    return check(Picture(((panel,),), words, caption))


def wheel_of(scene: AnyScene, seconds: float | None = None) -> Picture:
    """Return the wheel of a spinner's scene at a time; without a time at angles that are seen well.

    Parameters
    ----------
    scene : Scene or TreeScene
        Of the model "spinner".
    seconds : float, optional
        The time (s) up to which it is integrated; without it angles are taken that are seen well.

    Returns
    -------
    Picture
        Angles and axes as of `wheel`.

    Raises
    ------
    InputError
        As `codegen.simulate` does, and for a scene that is none of a spinner.

    Examples
    --------
    >>> import eom
    >>> wheel_of(eom.load_scene("bicycle-wheel")).title
    'Bicycle wheel spinning on its axle, held by one end'
    """
    one = single(scene)
    if one is None or one.model != "spinner":
        raise InputError("not the scene of a spinner", where=scene.title or scene.name)
    title = short(scene.title or scene.name)
    held = _held(one)
    if seconds is None:
        return wheel(title=title, held=held)
    result, _ = run(with_attitude(scene, 2, seconds))
    if not result.t_stop == seconds:
        raise InputError("the run stopped before", where=title, got=result.message)
    return wheel([float(result[n][-1]) for n in ("psi", "theta", "phi")], title, held=held)


def _held(scene: Scene) -> float | None:
    """Return where the fixed point is, from the wheel's middle along -b2, in radii of the rim."""
    weight, size = scene.torque.weight, scene.body.size
    if weight is None:
        return None
    arm = float(weight.centre_of_mass[1])
    return arm / size["ring_radius"] if "ring_radius" in size else math.copysign(RIM, arm)


def _stand(point: Floats) -> Iterator[Item]:
    """Yield the end of the axle as a point, its name, and a post below it."""
    foot = np.array([0.0, 0.0, -1.1 * RIM])
    yield Curve(np.stack([0 * point, point]), "grey", 3.0)
    yield Curve(np.stack([point, point + foot]), "black", 2.2)
    ring = arc_points(np.eye(3)[2], 0.28 * np.eye(3)[0], 2 * math.pi)
    yield Curve(point + foot + ring, "black", 1.6)
    yield Marks(point[None], size=6.0)
    yield Words(point + np.array([0.0, 0.0, 0.16]), "$O$")


def _body(frame: Frame) -> Iterator[Item]:
    """Yield rim, axle and spokes of a wheel whose axle is axis 2 of a frame."""
    across = np.roll(np.eye(3), -1, axis=0)  # from the solids' axis 3
    rim = of_solid("torus", {"ring_radius": RIM, "tube_radius": 0.05}).moved((0, 0, 0), across)
    axle = of_solid("cylinder", {"radius": 0.045, "length": 1.85}).moved((0, 0.375, 0), across)
    for mesh, opacity in ((rim, 1.0), (axle, 0.6)):
        yield Surface(mesh.vertices @ frame.C, mesh.faces, "grey", opacity)
    for k in range(SPOKES):
        way = arc_points(frame.axis(2), frame.axis(1), 2 * math.pi * k / SPOKES)[-1]
        colour, width = ("red", 2.2) if k == 0 else ("grey", 1.0)
        yield Curve(np.stack([0 * way, RIM * way]), colour, width)
