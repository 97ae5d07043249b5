"""Sketches of derivations: the frames, points and bodies that their lines speak of, in their notation.

What is drawn is read off the terms of the lines: each frame by its axes, each position as an arrow between
its points, the body where something is summed up over it, angular velocity and momentum from its centre.
Places are those of a sketch, without units; a solid has its own shape.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from eom.derivations.derived import Derived
from eom.derivations.showing import Drawn
from eom.derivations.wording import frames_of, letters_in_words, notation_of, terms_of
from eom.terms.terms import Term
from eom.terms.vocabulary import unit, words
from eom.typeset.blocks import Drawing
from eom.typeset.boxes import Box, Operator
from eom.typeset.letters import Notation
from eom.typeset.markup import render
from eom.typeset.notation import notation_named, term_box
from eom.typeset.sentences import Prose, phrases
from eom.views.body.frame_sketches import SPACE, WHEEL_ANGLES, after_turns, wheel
from eom.views.draw import lined
from eom.views.draw.meshes import ellipsoid, of_solid
from eom.views.draw.picture import Arrow, Floats, Item, Marks, Panel, Picture, Surface, Words
from eom.views.draw.viewpoint import best_view

PLACES: dict[str, tuple[float, float, float]] = {
    "OI": (0.0, 0.0, 0.0),
    "C": (1.0, 2.4, 0.6),
    "O": (0.2, 1.3, 1.9),
    "P": (0.8, 3.2, 1.3),
    "dm": (0.9, 3.2, 1.1),
    "i": (1.4, 2.6, 1.7),
    "j": (0.3, 3.5, 0.3),
    "OA": (0.2, 1.7, 1.2),
    "OB": (1.9, 2.9, 0.1),
}
"""Where points are in a sketch."""
COLOURS = {"I": "black", "A": "blue", "B": "green", "S": "purple", "C": "red"}
ANGLES = {"A": (0.5, 0.2, 0.1), "B": (0.9, 0.35, 0.3), "S": (1.5, 0.5, -0.4), "C": (0.9, 0.35, 1.2)}
"""Angles of the turns 3-1-2 by which frames are drawn, rad."""
SEMI_AXES = (0.75, 1.0, 0.6)
SPUN = "spin_312"


def drawn(derivation: Derived, notation: str = "arrow") -> tuple[Drawn, ...]:
    """Return the sketches of a derivation, each with what it shows, for pages of it.

    ``notation``: one of `eom.typeset.notation.NOTATIONS` or its aliases. No sketch for a derivation
    that speaks of one frame and of no place. Raises `InputError` for other notations.

    >>> from eom import derive
    >>> len(drawn(derive("euler-equations")))
    1
    """
    chosen = notation_of(derivation, notation_named(notation))
    if derivation.name.startswith("inertia-of-"):
        return (_solid(derivation),)
    if SPUN in derivation.assumptions:
        return (_wheel(derivation, chosen),)
    made = _sketch(derivation, chosen)
    return () if made is None else (made,)


def _figure(picture: Picture, said: Prose, things: Any) -> Drawn:
    return Drawn(frozenset(things), Drawing(lined.svg(picture), lined.latex(picture), said))


def _panel(items: list[Item], arcs: list[Floats]) -> Picture:
    view = best_view(arcs, items)
    return Picture(((Panel(tuple(items), SPACE, equal=True, bare=True, view=view),),))


# -- a solid, a wheel ------------------------------------------------------------------------


def _solid(derivation: Derived) -> Drawn:
    """Draw a solid by its own surface, at sizes that show it, with its axes."""
    from eom.mass.solids import SOLIDS

    name = derivation.name.removeprefix("inertia-of-").replace("-", " ")
    sizes = {s: _SIZES.get(s, 1.0) for s in SOLIDS[name].sizes}
    mesh = of_solid(name, sizes)
    items: list[Item] = [Surface(mesh.vertices, mesh.faces, "sky")]
    reach = 1.5 * float(np.abs(mesh.vertices).max())
    items += [
        Arrow(np.zeros(3), reach * axis, "black", 1.2, f"${letter}$")
        for axis, letter in zip(np.eye(3), "xyz", strict=True)
    ]
    said = f"The {name}, and axes along its own through the centre of mass."
    return _figure(_panel(items, []), said, {"coordinates"})


_SIZES = {
    "a": 1.6, "b": 1.2, "c": 0.8, "radius": 1.0, "inner_radius": 0.6, "outer_radius": 1.0,
    "base_radius": 1.0, "top_radius": 0.5, "ring_radius": 1.0, "tube_radius": 0.35, "height": 1.6,
    "length": 1.8,
}  # fmt: skip


def _wheel(derivation: Derived, notation: Notation) -> Drawn:
    """Draw the wheel of `eom.views.body.frame_sketches` with the axes as the notation calls them."""
    picture = wheel(WHEEL_ANGLES)
    ((panel,),) = picture.rows
    frames = dict(zip("iabc", "IABC", strict=True))
    items = tuple(
        Arrow(i.start, i.end, i.colour, i.width, _renamed(i.words, frames, notation))
        if isinstance(i, Arrow)
        else i
        for i in panel.items
    )
    said = phrases(
        "the wheel: A, B, C follow from I by turns about axes 3, 1, 2 through psi, theta, phi",
        letters_in_words(derivation, notation),
    )
    shown = Panel(items, panel.axes, equal=True, bare=True, view=panel.view)
    return _figure(Picture(((shown,),)), said, {("frame", "A"), ("frame", "B"), SPUN})


def _renamed(name: str, frames: dict[str, str], notation: Notation) -> str:
    r"""Return the names of axes, ``$\mathbf{a}_1 = \mathbf{i}_1$``, in a notation."""
    parts = [p for p in name.strip("$").split(" = ") if p]
    boxes = [unit(frames[p[8]], int(p[-1])) for p in parts]
    return f"${' = '.join(render(term_box(b, notation), 'latex') for b in boxes)}$" if boxes else ""


# -- any chapter -----------------------------------------------------------------------------


def _sketch(derivation: Derived, notation: Notation) -> Drawn | None:
    """Draw frames, positions, body and its vectors, as far as the lines speak of them."""
    found = terms_of(derivation)
    frames = [f for f in frames_of(found) if f in COLOURS]
    atoms = list(dict.fromkeys(n for n in found if n.head == "atom"))
    places = [a for a in atoms if a.data[0] == "position" and {*a.data[1:]} <= {*PLACES}]
    if not places and len(frames) < 2:
        return None
    body = any("body" in a.data or "dm" in a.data for a in atoms)
    items: list[Item] = []
    if body:
        items.append(_body())
    for frame in frames:
        items += _triad(frame, frame != "I" and body, notation)
    items += _positions(places, notation)
    vectors = _vectors(atoms, notation) if body else []
    items += vectors
    named = [a for a in (*places, *(_VECTORS if vectors else ())) if a in atoms]
    things = {("frame", f) for f in frames if f != "I"} | set(places)
    return _figure(_panel(items, []), _said(derivation, frames, named, notation), things)


def _attitude(frame: str) -> Floats:
    return after_turns("3-1-2", ANGLES[frame])[-1] if frame in ANGLES else np.eye(3)


def _body() -> Surface:
    round_ = ellipsoid(SEMI_AXES, "sky", 0.3)
    place = np.array(PLACES["C"])
    return Surface(round_.vertices @ _attitude("B") + place, round_.faces, "sky")


def _triad(frame: str, moved: bool, notation: Notation) -> Iterator[Item]:
    start = np.array(PLACES["C" if moved else "OI"])
    C, size = _attitude(frame), 1.3 if frame == "I" else 1.15
    for k in (1, 2, 3):
        label = f"${render(term_box(unit(frame, k), notation), 'latex')}$"
        yield Arrow(start, start + size * C[k - 1], COLOURS[frame], 1.2, label)


def _positions(places: list[Term], notation: Notation) -> Iterator[Item]:
    """Yield an arrow for each position, with its letter beside its middle, and its points.

    A point that the notation calls by a bullet is its own name.
    """
    points = dict.fromkeys(p for a in places for p in a.data[1:])
    for a in places:
        end, start = (np.array(PLACES[p]) for p in a.data[1:])
        if math.dist(start, end) > 0:
            yield Arrow(start, end, "orange", 1.5)
            beside = 0.5 * (start + end) + np.array([0.0, 0.0, 0.14])
            yield Words(beside, f"${render(term_box(a, notation), 'latex')}$", "orange")
    for p in points:
        yield Marks(np.array([PLACES[p]]))
        if notation.point(p) != Operator("bullet"):
            label = render(notation.point(p), "latex")
            yield Words(np.array(PLACES[p]) + np.array([0.0, 0.0, -0.17]), f"${label}$")


_VECTORS = (
    Term("atom", (), ("angular_velocity", "B", "I"), "vector"),
    Term("atom", (), ("angular_momentum", "body", "C"), "vector"),
)


def _vectors(atoms: list[Term], notation: Notation) -> list[Item]:
    """Return the angular velocity and momentum of the body, from its centre of mass."""
    start = np.array(PLACES["C"])
    ways = (np.array([-0.15, 0.45, 1.35]), np.array([-0.5, 0.1, 1.5]))
    return [
        Arrow(start, start + way, "red", 1.8, f"${render(term_box(a, notation), 'latex')}$")
        for a, way in zip(_VECTORS, ways, strict=True)
        if a in atoms
    ]


def _said(derivation: Derived, frames: list[str], named: list[Term], notation: Notation) -> Prose:
    """Return what a sketch shows, in words with the letters of the notation."""
    known = letters_in_words(derivation, notation)
    parts: list[str | Box] = ["Frames " if len(frames) > 1 else "Frame "]
    for k, frame in enumerate(frames):
        parts += [*([", "] if k else []), notation.frame(frame)]
    for term in named:
        parts += ["; ", term_box(term, notation), ": ", *phrases(words(term), known)]
    return (*parts, ".")
