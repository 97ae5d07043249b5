"""An animation as one HTML page: data, three.js and the player in it, nothing asked for from elsewhere.

Arrays are 32-bit floats, little-endian, in base64. What a scene brings along is escaped. The same animation
gives the same bytes.
"""

from __future__ import annotations

import base64
import html
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from eom.views.animation.acting import STYLES, is_seen
from eom.views.animation.animation import Animation, scales_of
from eom.views.animation.figures import Figure, Shape
from eom.views.animation.tracks import Track
from eom.views.draw import pages
from eom.views.draw.formulas import as_runs, name, unit
from eom.views.draw.meshes import Mesh

FRAME = 1.15
"""Length of b1, b2, b3 as a share of the extent of one body; of many, of what is seen."""
FRAME_OF_MANY = 0.16
SCRIPTS = ("three.js", "packed.js", "words.js", "viewer.js", "animation.js")
PALETTE = ("blue", "orange", "green", "sky", "red", "purple", "yellow", "grey")


def page(animation: Animation) -> str:
    """Return the page of an animation: one file of HTML that asks for nothing; the same bytes each time.

    Parameters
    ----------
    animation : Animation
        Of `eom.views.animation.animation.animation_of` and its like.

    Returns
    -------
    str
        One file of HTML that asks for nothing; the same bytes each time.

    Examples
    --------
    >>> import eom
    >>> from eom.views.animation.animation import animation_of
    >>> from eom.views.time.histories import run
    >>> made = page(animation_of(eom.load_scene("t-handle"), lambda scene: run(scene)[0]))
    >>> made[:15], "<title>Tumbling T-handle" in made
    ('<!DOCTYPE html>', True)
    """
    words = animation.words
    parts = {
        "title": html.escape(animation.title),
        "words": f"<p>{html.escape(words)}</p>" if words else "",
        "notes": "".join(f"<li>{html.escape(n)}</li>" for n in animation.notes),
    }
    scripts = [pages.web(name) for name in SCRIPTS]
    return pages.page("animation", parts, data(animation), scripts)


def floats(values: ArrayLike) -> str:
    """Return an array as 32-bit floats, little-endian, in base64."""
    return base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")


def data(animation: Animation) -> dict[str, Any]:
    """Return what the page's script reads."""
    view, times, meshes = animation.view, animation.times, Meshes()
    figures = animation.figures
    bodies = list(_bodies(animation, meshes))
    return {
        "title": animation.title,
        "start": float(times[0]),
        "end": float(times[-1]),
        "count": len(times),
        "speed": animation.speed,
        "centre": [_number(x) for x in view.centre],
        "radius": _number(view.radius),
        "up": [_number(x) for x in view.up],
        "view": [_number(x) for x in view.camera],
        "ground": None if view.ground is None else _number(view.ground),
        "follow": view.follow,
        "axes": [as_runs(a) for a in animation.axes],
        "scales": {unit: _number(x) for unit, x in scales_of(animation).items()},
        "kinds": {
            kind: {"words": as_runs(STYLES[kind].words), "few": is_seen(kind, count)}
            for kind, count in Counter(a.kind for a in animation.arrows).items()
        },
        "bodies": bodies,
        "stand": [meshes.shape(s) for s in figures.ground],
        "meshes": meshes.listed,
        "links": [
            {"bodies": list(link.bodies), "points": [[_number(x) for x in p] for p in link.points]}
            for link in figures.links
        ],
        "arrows": list(_arrows(animation)),
        "readouts": [
            {"name": as_runs(name(t.name)), "unit": unit(t.unit), "values": floats(t.values)}
            for t in animation.readouts
        ],
    }


def _bodies(animation: Animation, meshes: Meshes) -> Iterator[dict[str, Any]]:
    """Yield the data of each body; one that stays in place has no positions."""
    pairs = zip(animation.figures.bodies, animation.tracks.bodies, strict=True)
    for k, (figure, track) in enumerate(pairs):
        yield {
            "name": figure.name,
            "colour": PALETTE[k % len(PALETTE)],
            "axes": [as_runs(a) for a in figure.axes],
            "frame": _number(_frame(animation, figure)),
            "tip": _tip(figure, track),
            "shapes": [meshes.shape(s) for s in figure.shapes],
            "positions": floats(track.positions) if np.any(track.positions) else None,
            "quaternions": floats(track.quaternions),
        }


def _number(x: float) -> float:
    """Return a number with the digits that a picture needs."""
    return float(f"{float(x):.7g}") + 0.0


def _tip(figure: Figure, track: Track) -> list[float] | None:
    """Return the point whose path is drawn; none where it stays in place."""
    moves = np.any(figure.tip) or np.any(track.positions != track.positions[0])
    return [_number(x) for x in figure.tip] if moves else None


def _frame(animation: Animation, figure: Figure) -> float:
    if len(animation.figures.bodies) == 1:
        return FRAME * figure.extent
    return FRAME_OF_MANY * animation.view.radius


def _arrows(animation: Animation) -> Iterator[dict[str, Any]]:
    """Yield the vectors; those that start at the origin of a body have no places of their own."""
    for arrow in animation.arrows:
        apart = arrow.body < 0 and np.any(arrow.places)
        yield {
            "kind": arrow.kind,
            "text": as_runs(arrow.text),
            "words": arrow.words,
            "unit": arrow.unit,
            "colour": arrow.colour,
            "body": arrow.body,
            "values": floats(arrow.values),
            "places": floats(arrow.places) if apart else None,
        }


class Meshes:
    """Meshes by their bytes: each is listed once."""

    def __init__(self) -> None:
        self.listed: list[dict[str, Any]] = []
        self._known: dict[tuple[bytes, bytes], int] = {}

    def shape(self, shape: Shape) -> dict[str, Any]:
        """Return a shape that names its mesh by number."""
        return {
            "mesh": self.number(shape.mesh),
            "colour": shape.colour or None,
            "opacity": shape.opacity,
        }

    def number(self, mesh: Mesh) -> int:
        """Return the number of a mesh."""
        vertices = np.asarray(mesh.vertices, dtype="<f4")
        faces = np.asarray(mesh.faces, dtype="<u4" if len(vertices) > 65535 else "<u2")
        key = vertices.tobytes(), faces.tobytes()
        if key not in self._known:
            self._known[key] = len(self.listed)
            self.listed.append(
                {
                    "vertices": base64.b64encode(key[0]).decode("ascii"),
                    "faces": base64.b64encode(key[1]).decode("ascii"),
                    "wide": faces.dtype.itemsize == 4,
                    "round": mesh.round,
                    "flat": mesh.flat,
                }
            )
        return self._known[key]
