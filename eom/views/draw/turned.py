"""A picture as one HTML page to turn by hand, which needs no network.

Panels in space are drawn by the viewer of animations (three.js), those in a plane as SVG: `eom/views/web`.
The page holds the same picture that is printed, as data: numbers in columns, each once, words in runs of
one style.
"""

from __future__ import annotations

import base64
import html
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eom.views.draw import formulas, pages
from eom.views.draw.depth import bounds
from eom.views.draw.picture import (
    Arrow,
    Axis,
    Curve,
    Item,
    Marks,
    Panel,
    Picture,
    Surface,
    Words,
    check,
    placed,
)
from eom.views.draw.printed import height_of, width_of
from eom.views.draw.viewpoint import USUAL

Data = dict[str, Any]
INCH = 96.0
POINT = 4 / 3
"""Pixels of a printer's point."""
EXACT = 1e-6
"""Share of a number, and of how far a column's numbers lie apart, that 32 bits may leave out."""
TURN = "In space: drag or arrow keys turn, wheel or + and - zoom, 0 puts back. "
ZOOM = (
    "In a plane: drag a box to zoom, arrow keys move, + and - zoom, a double click or 0 puts back. "
)
LEGEND = "A click on a name in a legend hides or shows it."


def page(picture: Picture, size: tuple[float, float] | None = None) -> str:
    """Return a picture as one HTML page, whose panels in space are turned by hand.

    Parameters
    ----------
    picture : Picture
        What is drawn.
    size : tuple of float, float, optional
        Width and height in inches, of 96 pixels; without, as large as the window.

    Returns
    -------
    str
        Text is escaped; the same picture gives the same page.

    Raises
    ------
    InputError
        For a ``picture`` that cannot be drawn (`eom.views.draw.picture.check`).

    Examples
    --------
    >>> from eom.views.body.frame_sketches import frame_sketch
    >>> made = page(frame_sketch("3-1-2"))
    >>> made[:15], len(made) < 2_000_000
    ('<!DOCTYPE html>', True)
    """
    data = described(picture, size)
    kinds = {len(panel.axes) for row in picture.rows for panel in row}
    title = formulas.as_text(picture.title) or "Picture"
    caption = formulas.as_text(picture.caption)
    parts = {
        "title": html.escape(title),
        "heading": formulas.as_html(picture.title) or title,
        "words": html.escape(caption or title),
        "caption": f"<p>{html.escape(caption)}</p>\n" if caption else "",
        "keys": TURN * (3 in kinds) + ZOOM * (2 in kinds) + LEGEND * bool(data["labels"]),
    }
    solid = ("three.js", "viewer.js") if 3 in kinds else ()
    names = (*solid, "packed.js", "words.js", "plane.js", "picture.js")
    return pages.page("picture", parts, data, [pages.web(name) for name in names])


def described(picture: Picture, size: tuple[float, float] | None = None) -> Data:
    """Return what the page's script reads: ``rows`` of panels, ``columns``, ``labels``, ``size``.

    Sizes are in pixels. Raises as `page`.
    """
    check(picture)
    inches = size or picture.size
    columns = Columns()
    labels: dict[str, int] = {}
    rows = [[_panel(panel, columns, labels) for panel in row] for row in picture.rows if row]
    return {
        "size": [INCH * s for s in inches] if inches else None,
        "rows": rows,
        "columns": columns.listed,
        "labels": [formulas.as_runs(label) for label in labels],
    }


class Columns:
    """Arrays by their bytes: each is listed once, as its kind and base64."""

    def __init__(self) -> None:
        self.listed: list[tuple[str, str]] = []
        self._known: dict[tuple[str, bytes], int] = {}

    def number(self, values: NDArray[Any]) -> int:
        """Return the number of an array."""
        kind = _kind(values)
        key = kind, np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()
        if key not in self._known:
            self._known[key] = len(self.listed)
            self.listed.append((kind, base64.b64encode(key[1]).decode("ascii")))
        return self._known[key]


def _kind(values: NDArray[Any]) -> str:
    """Return the shortest type of numbers that holds an array as exactly as can be seen."""
    if values.dtype.kind in "iu":
        return "u2" if values.max(initial=0) < 2**16 else "u4"
    known = values[np.isfinite(values)]
    with np.errstate(over="ignore", under="ignore"):
        lost = np.abs(known.astype(np.float32) - known)
    far = EXACT * float(np.ptp(known)) if len(known) else 0.0
    return "f4" if np.all(lost <= np.minimum(EXACT * np.abs(known), far or np.inf)) else "f8"


def _panel(panel: Panel, columns: Columns, labels: dict[str, int]) -> Data:
    low, high = bounds(panel)
    return {
        "title": formulas.as_runs(panel.title),
        "width": INCH * width_of(panel),
        "height": INCH * height_of(panel),
        "equal": panel.equal,
        "bare": panel.bare,
        "view": panel.view or USUAL,
        "axes": [
            _axis(a, *ends)
            for a, *ends in zip(panel.axes, low.tolist(), high.tolist(), strict=True)
        ],
        "items": [_item(item, columns, labels) for item in panel.items],
    }


def _axis(axis: Axis, low: float, high: float) -> Data:
    """Return an axis with its ends, powers of ten where it is logarithmic."""
    words = formulas.as_runs(axis.words)
    fixed = axis.limits is not None
    return {"words": words, "scale": axis.scale, "low": low, "high": high, "fixed": fixed}


def _item(item: Item, columns: Columns, labels: dict[str, int]) -> Data:
    places = np.concatenate([np.atleast_2d(p) for p in placed(item)])
    label = "" if isinstance(item, Words) else item.label
    return {
        "colour": item.colour,
        "label": labels.setdefault(label, len(labels)) if label else None,
        "at": [columns.number(column) for column in places.T],
        **_look(item, columns),
    }


def _look(item: Item, columns: Columns) -> Data:
    """Return the kind of an item and what it alone has."""
    if isinstance(item, Curve):
        return {"kind": "curve", "width": POINT * item.width, "dash": item.dash}
    if isinstance(item, Marks):
        return {"kind": "marks", "size": POINT * item.size}
    if isinstance(item, Surface):
        return {
            "kind": "surface",
            "faces": columns.number(item.faces.ravel()),
            "opacity": item.opacity,
        }
    if isinstance(item, Arrow):
        words = formulas.as_runs(item.words)
        return {"kind": "arrow", "width": POINT * item.width, "words": words}
    return {"kind": "words", "words": formulas.as_runs(item.text)}
