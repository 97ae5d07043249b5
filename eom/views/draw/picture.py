"""A picture as data: panels and what is drawn in them, for any renderer.

Coordinates are in the units that the axes name; arrays are never changed after they are given.
A colour is a name of `COLOURS`, so that every renderer uses the same, distinct to colour-blind
readers too (Okabe and Ito, "Color universal design", 2008).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eom.displays import display
from eom.errors import InputError
from eom.typeset.blocks import shown

Floats = NDArray[np.float64]

COLOURS = {
    "black": "#000000",
    "grey": "#666666",
    "orange": "#e69f00",
    "sky": "#56b4e9",
    "green": "#009e73",
    "yellow": "#ebdc20",
    "blue": "#0072b2",
    "red": "#d55e00",
    "purple": "#cc79a7",
}
"""Colours of all pictures by name, as #rrggbb; source: Okabe and Ito, Color universal design (2008).

Grey is darker and yellow less pale than others take them: each two differ as dichromats see them, too.
"""
Dash = Literal["solid", "dashed", "dotted"]
Scale = Literal["linear", "log"]


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through ``points``, shape (N, 2) or (N, 3); a point that is not a number breaks it.

    Parameters
    ----------
    points : array
        Shape (N, 2) or (N, 3), in the units of the panel's axes.
    colour : str, default "blue"
        A name of `COLOURS`.
    width : float, default 1.5
        In printer's points.
    dash : Dash, default "solid"
        How the line is broken.
    label : str, optional
        Words of the legend.
    """

    points: Floats
    colour: str = "blue"
    width: float = 1.5
    dash: Dash = "solid"
    label: str = ""


@dataclass(frozen=True, eq=False)
class Marks:
    """Dots at ``points``, shape (N, 2) or (N, 3).

    Parameters
    ----------
    points : array
        Shape (N, 2) or (N, 3), in the units of the panel's axes.
    colour : str, default "black"
        A name of `COLOURS`.
    size : float, default 5.0
        Their diameter in printer's points.
    label : str, optional
        Words of the legend.
    """

    points: Floats
    colour: str = "black"
    size: float = 5.0
    label: str = ""


@dataclass(frozen=True, eq=False)
class Arrow:
    """An arrow from ``start`` to ``end``, shape (2,) or (3,), with ``words`` at its tip.

    Parameters
    ----------
    start, end : array
        Shape (2,) or (3,), in the units of the panel's axes.
    colour : str, default "black"
        A name of `COLOURS`.
    width : float, default 2.0
        In printer's points.
    words : str, optional
        At its tip.
    label : str, optional
        Words of the legend.
    """

    start: Floats
    end: Floats
    colour: str = "black"
    width: float = 2.0
    words: str = ""
    label: str = ""


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles: ``vertices`` of shape (N, 3), ``faces`` of shape (M, 3) with indices of vertices.

    Parameters
    ----------
    vertices : array
        ``vertices`` of shape (N, 3), in the units of the panel's axes.
    faces : NDArray
        Of shape (M, 3), with indices of vertices.
    colour : str, default "grey"
        A name of `COLOURS`.
    opacity : float, default 0.3
        From 0, not seen, to 1.
    label : str, optional
        Words of the legend.
    """

    vertices: Floats
    faces: NDArray[np.int64]
    colour: str = "grey"
    opacity: float = 0.3
    label: str = ""


@dataclass(frozen=True, eq=False)
class Words:
    """Text at a ``place``, shape (2,) or (3,), in a ``colour`` of `COLOURS`.

    Parameters
    ----------
    place : array
        Shape (2,) or (3,), in the units of the panel's axes.
    text : str
        Words, with formulas between dollar signs, in TeX.
    colour : str, default "black"
        A name of `COLOURS`.
    """

    place: Floats
    text: str
    colour: str = "black"


Item = Curve | Marks | Arrow | Surface | Words


@dataclass(frozen=True)
class Axis:
    """An axis: its ``words`` with the unit, its scale, its ``limits`` (in that unit) if they are fixed.

    Parameters
    ----------
    words : str, optional
        With the unit.
    scale : Scale, default "linear"
        ``linear`` or ``log``.
    limits : tuple of float, float, optional
        In that unit, if they are fixed.
    """

    words: str = ""
    scale: Scale = "linear"
    limits: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Panel:
    """One drawing: ``items`` in the units of its ``axes``, two for a plane or three for space.

    Parameters
    ----------
    items : tuple of Item
        In the units of its ``axes``.
    axes : tuple of str or vector
        Two for a plane or three for space.
    title : str, optional
        Above it.
    equal : bool, default False
        Whether all axes have the same scale.
    """

    items: tuple[Item, ...]
    axes: tuple[Axis, ...]
    title: str = ""
    equal: bool = False
    bare: bool = False
    """Whether axes, ticks and grid are left out, as in a sketch."""
    height: float = 1.0
    """Height relative to the other panels of its column."""
    view: tuple[float, float] | None = None
    """Elevation and azimuth (degrees) that space is seen from; None: as in other pictures."""


@dataclass(frozen=True, eq=False)
class Picture:
    """Panels in ``rows`` from the top, with a title above and words below that say what is seen.

    A notebook displays it; `save` writes it, and `figure` makes a figure of Matplotlib of it.

    Parameters
    ----------
    rows : tuple of tuple of Panel
        Panels from the top, each row from the left.
    title : str, optional
        Above all.
    """

    rows: tuple[tuple[Panel, ...], ...]
    title: str = ""
    caption: str = ""
    """One or two sentences for those who cannot see it, and for the caption of a figure."""
    size: tuple[float, float] | None = None
    """Width and height in inches that its words need, where they need more than panels do."""
    notice: str = ""
    """What whoever asked for it should know, as that lines lack points."""

    def save(
        self, path: str | Path, size: tuple[float, float] | None = None, dpi: float = 150.0
    ) -> Path:
        """Write the picture to a file .png, .svg, .pdf or .html, and return its path.

        Parameters
        ----------
        path : path
            The file; what it is, its ending says.
        size : (float, float), optional
            Width and height in inches, by default as the panels need.
        dpi : float, default 150
            Pixels an inch, of PNG.

        Returns
        -------
        path
            Of the file.

        Raises
        ------
        InputError
            For other endings, where Matplotlib is needed and not installed (extra ``plot``), for a size
            that no paper has, and where the file cannot be written.
        """
        found: Path = display("picture as file", self, path, size, dpi)
        return found

    def figure(self, size: tuple[float, float] | None = None) -> Any:
        """Return a figure of Matplotlib, to go on with: its axes are those of the panels, in order.

        Parameters
        ----------
        size : (float, float), optional
            Width and height in inches, by default as the panels need.

        Returns
        -------
        Figure
            Of Matplotlib, which no window and no global state knows.

        Raises
        ------
        InputError
            Where Matplotlib is not installed.
        """
        return display("picture as figure", self, size)

    def _repr_mimebundle_(self, **_: object) -> tuple[dict[str, str], dict[str, dict[str, str]]]:
        """Show the picture in a notebook."""
        data, metadata = shown(self, "notebook")
        return data, metadata


def points(*coordinates: ArrayLike) -> Floats:
    """Return arrays of ``coordinates``, each of shape (N,), as points of shape (N, 2) or (N, 3).

    Parameters
    ----------
    coordinates : array
        Two or three, each of shape (N,).

    Returns
    -------
    array
        Shape (N, 2) or (N, 3). Units stay as they are.

    Examples
    --------
    >>> points([0, 1, 2], [0, 1, 4]).tolist()
    [[0.0, 0.0], [1.0, 1.0], [2.0, 4.0]]
    """
    return np.stack([np.asarray(c, dtype=np.float64) for c in coordinates], axis=-1)


def check(picture: Picture) -> Picture:
    """Return a picture if it can be drawn.

    Parameters
    ----------
    picture : Picture
        What shall be drawn.

    Returns
    -------
    Picture
        The picture itself, if it can be drawn.

    Raises
    ------
    InputError
        That names the panel: a colour that is not known, points of the wrong dimension, no panel at
        all.

    Examples
    --------
    >>> check(Picture((), "Nothing"))
    Traceback (most recent call last):
    ...
    eom.errors.InputError: the picture has no panel
      where:    Nothing
    """
    if not any(picture.rows):
        raise InputError("the picture has no panel", where=picture.title or "picture")
    for panel in (panel for row in picture.rows for panel in row):
        for item in panel.items:
            _check_item(item, panel, picture.title)
    return picture


def _check_item(item: Item, panel: Panel, title: str) -> None:
    where = f"picture {title!r}, panel {panel.title!r}, {type(item).__name__}"
    if item.colour not in COLOURS:
        known = ", ".join(COLOURS)
        raise InputError("unknown colour", where=where, got=item.colour, expected=known)
    for array in placed(item):
        if array.shape[-1] != len(panel.axes):
            got = f"points of {array.shape[-1]} coordinates"
            raise InputError(
                "points do not fit the panel",
                where=where,
                got=got,
                expected=f"{len(panel.axes)}, one an axis",
            )


def placed(item: Item) -> Sequence[Floats]:
    """Return the arrays of places of an item."""
    if isinstance(item, Curve | Marks):
        return (item.points,)
    if isinstance(item, Arrow):
        return (item.start, item.end)
    return (item.vertices,) if isinstance(item, Surface) else (item.place,)
