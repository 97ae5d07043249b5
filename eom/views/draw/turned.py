"""A picture to turn by hand, by Plotly: for notebooks, and as one HTML page that needs no network.

The page holds plotly.js itself (some 4.8 MB); the data of the picture are small beside it. Its two scripts
are allowed by their hashes alone; the library writes its own styles and images. The page follows the
reader's choice of a light or dark theme.
"""

from __future__ import annotations

import html
import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from eom.views.draw import formulas, pages
from eom.views.draw.depth import TIP, bounds, diagonal
from eom.views.draw.meshes import Faces, tip
from eom.views.draw.picture import (
    COLOURS,
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
    placed,
)
from eom.views.draw.printed import height_of, require
from eom.views.draw.viewpoint import line_of_sight

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


def page(picture: Picture, size: tuple[float, float] | None = None) -> str:
    """Return a picture as one HTML page with plotly.js in it; ``size`` in inches of 96 pixels.

    Text is escaped; the same picture gives the same page. Raises as `figure`.
    """
    made = described(picture, size)
    usual = INCH * sum(max(map(height_of, row)) for row in picture.rows if row)
    title = formulas.as_text(picture.title) or "Picture"
    words = formulas.as_text(picture.caption)
    parts = {
        "title": html.escape(title),
        "words": html.escape(words or title),
        "caption": f"<p>{html.escape(words)}</p>\n" if words else "",
        "height": f"{made['layout'].get('height', usual) / INCH:g}",
    }
    return pages.page(
        "picture", parts, made, [library(), pages.web("picture.js")], "data: blob:", pages.INLINE
    )


@lru_cache(maxsize=1)
def library() -> str:
    """Return plotly.js. Raises `InputError` where Plotly is missing."""
    require("plotly")
    from plotly.offline import get_plotlyjs

    return str(get_plotlyjs())


Data = dict[str, Any]
DASHES = {"solid": "solid", "dashed": "dash", "dotted": "dot"}
TITLE = 80
"""Letters in a line of the title."""
GAP = 0.07
"""Room between panels, as a part of the picture."""
POINT = 4 / 3
"""Pixels of a printer's point."""
INCH = 96.0
EYE = {"x": 1.5, "y": 1.05, "z": 0.8}
DOT, ROD = 0.45, 1.8
"""What makes marks and lines in space look as large as those in a plane."""
AWAY = 0.03
"""How far words stand from the tip of their arrow in space, as a part of the diagonal."""
GRID, LINE = "#dddddd", "#777777"
LIGHTING = {"ambient": 0.75, "diffuse": 0.35, "specular": 0.05, "roughness": 0.9}


def figure(picture: Picture, size: tuple[float, float] | None = None) -> Figure:
    """Return a picture as a Plotly figure; ``size``: width and height in inches, of 96 pixels.

    Without a size the figure is as wide as where it is shown. Raises `InputError` for a ``picture`` that
    cannot be drawn (`eom.views.draw.picture.check`), and where Plotly is not installed.

    >>> from eom.views.body.frame_sketches import frame_sketch
    >>> figure(frame_sketch("3-1-2"), size=(6, 5)).layout.width
    576.0
    """
    require("plotly")
    import plotly.graph_objects as go

    return go.Figure(described(picture, size), skip_invalid=False)


def described(picture: Picture, size: tuple[float, float] | None = None) -> Data:
    """Return the same figure as Plotly's JSON: ``data`` and ``layout``, lists and numbers alone."""
    check(picture)
    rows = [row for row in picture.rows if row]
    layout: Data = {
        "title": {
            "text": formulas.as_html(formulas.wrapped(picture.title, TITLE)),
            "x": 0.5,
            "font": {"size": 17},
        },
        "font": {"family": "system-ui, sans-serif", "size": 13, "color": "#222222"},
        "paper_bgcolor": "#ffffff",
        "plot_bgcolor": "#ffffff",
        "margin": {"l": 60, "r": 20, "t": 70 if picture.title else 30, "b": 100},
        "hovermode": "closest",
        "annotations": [],
        "showlegend": True,
    }
    if pixels := _pixels(picture, size, layout["margin"]):
        layout |= dict(zip(("width", "height"), pixels, strict=True))
    data: list[Data] = []
    counts = {"scene": 0, "x": 0}
    for number, (panel, domain, row) in enumerate(_placed(rows), 1):
        kind = "scene" if len(panel.axes) == 3 else "x"
        counts[kind] += 1
        shared = _has_space(rows[row])
        legend = f"legend{2 + row}" if shared else f"legend{100 + number}"
        layout[legend] = _below(domain, rows[row]) if shared else _inside(domain)
        draw = _space if kind == "scene" else _plane
        data += draw(panel, domain, legend, counts[kind], layout)
        if panel.title:
            layout["annotations"].append(_title(panel.title, domain))
    _list_once(data)
    return {"data": data, "layout": layout}


def _pixels(
    picture: Picture, size: tuple[float, float] | None, margin: Mapping[str, int]
) -> tuple[float, float] | None:
    """Return the size that was asked for, or the one that the words of a picture need, without margins."""
    if size is not None:
        return size[0] * INCH, size[1] * INCH
    if picture.size is None:
        return None
    across, up = (margin[a] + margin[b] for a, b in ("lr", "tb"))
    return picture.size[0] * INCH + across, picture.size[1] * INCH + up


def _has_space(row: tuple[Panel, ...]) -> bool:
    return any(len(panel.axes) == 3 for panel in row)


def _list_once(data: list[Data]) -> None:
    """List in each legend only the first trace of a name."""
    shown = set[str]()
    for trace in data:
        group = trace.get("legendgroup", "")
        trace["showlegend"] = bool(group) and group not in shown
        shown.add(group)


def _nth(word: str, number: int) -> str:
    """Return Plotly's name of a numbered part: legend, legend2, ..."""
    return word if number == 1 else f"{word}{number}"


def _placed(rows: list[tuple[Panel, ...]]) -> Iterator[tuple[Panel, Data, int]]:
    """Yield each panel, the ranges of its place in parts of the picture from the bottom left, its row."""
    heights = np.array([max(height_of(panel) for panel in row) for row in rows])
    gaps = (2.4 if any(_has_space(row) for row in rows[:-1]) else 1.4) * GAP
    heights = heights / heights.sum() * (1 - gaps * (len(rows) - 1))
    top = 1.0
    for number, (row, height) in enumerate(zip(rows, heights, strict=True)):
        width = (1 - GAP * (len(row) - 1)) / len(row)
        for k, panel in enumerate(row):
            left = k * (width + GAP)
            y = [max(0.0, float(top - height)), float(top)]
            yield panel, {"x": [left, min(1.0, left + width)], "y": y}, number
        top -= float(height) + gaps


def _inside(domain: Data) -> Data:
    """Return the place of a legend of one panel: to its right where there is room."""
    if domain["x"][1] > 1 - GAP:
        return {"x": 1.01, "y": domain["y"][1], "xanchor": "left", "yanchor": "top"}
    place = {"x": domain["x"][1], "y": domain["y"][1], "xanchor": "right", "yanchor": "top"}
    return {**place, "bgcolor": "rgba(128,128,128,0.08)"}


def _below(domain: Data, row: tuple[Panel, ...]) -> Data:
    """Return the place of a legend below a whole row, and below the ticks of its planes."""
    ticks = any(len(panel.axes) == 2 and not panel.bare for panel in row)
    y = domain["y"][0] - (1.6 * GAP if ticks else 0.0)
    place = {"x": 0.5, "y": y, "xanchor": "center", "yanchor": "top"}
    return {**place, "orientation": "h", "bgcolor": "rgba(0,0,0,0)"}


def _title(text: str, domain: Data) -> Data:
    return {
        "text": formulas.as_html(text),
        "x": sum(domain["x"]) / 2,
        "y": domain["y"][1],
        "xref": "paper",
        "yref": "paper",
        "xanchor": "center",
        "yanchor": "bottom",
        "showarrow": False,
        "font": {"size": 14},
    }


def _space(panel: Panel, domain: Data, legend: str, number: int, layout: Data) -> list[Data]:
    scene = _nth("scene", number)
    low, high = _with_words(panel, *bounds(panel))
    extent = high - low if panel.equal else np.ones(3)
    ratio = extent / np.linalg.norm(extent) * 1.6
    ranges = zip("xyz", panel.axes, low, high, strict=True)
    axes = {f"{letter}axis": _space_axis(axis, a, b, panel.bare) for letter, axis, a, b in ranges}
    layout[scene] = {
        "domain": domain,
        "aspectmode": "manual",
        "aspectratio": dict(zip("xyz", ratio.tolist(), strict=True)),
        "camera": {"eye": _eye(panel), "center": {"x": 0, "y": 0, "z": -0.17}},
        "annotations": [note for item in panel.items for note in _notes(item, diagonal(low, high))],
        **axes,
    }
    size = diagonal(low, high)
    return [
        {**trace, "scene": scene, **_named(item, legend)}
        for item in panel.items
        for trace in _in_space(item, size)
    ]


def _with_words(panel: Panel, low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Return limits that leave room for the words of arrows, which Plotly hides outside of them."""
    if not any(isinstance(item, Arrow) and item.words for item in panel.items):
        return low, high
    room = 1.1 * AWAY * diagonal(low, high)
    free = np.array([axis.limits is None for axis in panel.axes])
    return low - room * free, high + room * free


def _eye(panel: Panel) -> Data:
    """Return where space is seen from: from the side that the panel asks for, as far off as others."""
    if panel.view is None:
        return EYE
    eye = math.hypot(*EYE.values()) * line_of_sight(panel.view)
    return dict(zip("xyz", eye.tolist(), strict=True))


def _space_axis(axis: Axis, low: float, high: float, bare: bool) -> Data:
    return {
        "title": {"text": formulas.as_html(axis.words)},
        "type": axis.scale,
        "range": [float(low), float(high)],
        "visible": not bare,
        "showbackground": False,
        "gridcolor": GRID,
        "zerolinecolor": GRID,
        "linecolor": LINE,
        "showspikes": False,
        "nticks": 6,
    }


def _notes(item: Item, size: float) -> list[Data]:
    if isinstance(item, Words):
        place, text = item.place, item.text
    elif isinstance(item, Arrow) and item.words:
        way = np.subtract(item.end, item.start)
        place = item.end + AWAY * size * way / max(float(np.linalg.norm(way)), 1e-300)
        text = item.words
    else:
        return []
    at = dict(zip("xyz", map(float, place), strict=True))
    font = {"color": COLOURS[item.colour], "size": 15}
    return [{**at, "text": formulas.as_html(text), "showarrow": False, "font": font}]


def _in_space(item: Item, size: float) -> list[Data]:
    colour = COLOURS[item.colour]
    if isinstance(item, Surface):
        return [_mesh(item.vertices, item.faces, colour, item.opacity)]
    if isinstance(item, Arrow):
        line = {"color": colour, "width": ROD * POINT * item.width}
        vertices, faces = tip(item.start, item.end, TIP * size)
        shaft = {"type": "scatter3d", "mode": "lines", "line": line, "hoverinfo": "skip"}
        ends = np.stack([item.start, item.end])
        return [{**shaft, **_columns(ends, "xyz")}, _mesh(vertices, faces, colour, 1.0)]
    if isinstance(item, Words):
        return []
    return [{"type": "scatter3d", **_style(item), **_columns(item.points, "xyz")}]


def _mesh(vertices: Floats, faces: Faces, colour: str, opacity: float) -> Data:
    corners = {letter: faces[:, k].tolist() for k, letter in enumerate("ijk")}
    return {
        "type": "mesh3d",
        **_columns(vertices, "xyz"),
        **corners,
        "color": colour,
        "opacity": opacity,
        "lighting": LIGHTING,
        "hoverinfo": "skip",
    }


def _columns(points: Floats, letters: str) -> Data:
    """Return the coordinates as lists in seven digits, None where a number is missing."""
    columns = zip(letters, np.asarray(points, float).T, strict=True)
    return {
        letter: [float(f"{v:.7g}") if np.isfinite(v) else None for v in column.tolist()]
        for letter, column in columns
    }


def _style(item: Curve | Marks) -> Data:
    space = item.points.shape[-1] == 3
    if isinstance(item, Marks):
        size = POINT * item.size * (DOT if space else 1.0)
        return {"mode": "markers", "marker": {"color": COLOURS[item.colour], "size": size}}
    width = POINT * item.width * (ROD if space else 1.0)
    line = {"color": COLOURS[item.colour], "width": width, "dash": DASHES[item.dash]}
    return {"mode": "lines", "line": line, "connectgaps": False}


def _named(item: Item, legend: str) -> Data:
    """Return name and legend of a trace; traces of one label are shown and hidden together."""
    label = "" if isinstance(item, Words) else item.label
    own: Data = {"legend": legend, "name": formulas.as_html(label)}
    return {**own, "legendgroup": f"{legend} {label}"} if label else own


def _plane(panel: Panel, domain: Data, legend: str, number: int, layout: Data) -> list[Data]:
    x, y = _nth("x", number), _nth("y", number)
    across, up = (
        _plane_axis(axis, panel.bare, _decades(panel, k)) for k, axis in enumerate(panel.axes)
    )
    layout[_nth("xaxis", number)] = {**across, "domain": domain["x"], "anchor": y}
    layout[_nth("yaxis", number)] = {**up, "domain": domain["y"], "anchor": x}
    if panel.equal:
        layout[_nth("yaxis", number)] |= {"scaleanchor": x, "scaleratio": 1}
    layout["annotations"] += [n for item in panel.items for n in _plane_notes(item, x, y)]
    return [
        {**trace, "xaxis": x, "yaxis": y, **_named(item, legend)}
        for item in panel.items
        for trace in _in_plane(item)
    ]


def _decades(panel: Panel, k: int) -> float:
    """Return how many powers of ten a coordinate of a panel runs through."""
    values = np.concatenate([np.reshape(a, (-1, 2))[:, k] for i in panel.items for a in placed(i)])
    values = values[np.isfinite(values) & (values > 0)]
    return float(np.log10(values.max() / values.min())) if len(values) else 0.0


def _plane_axis(axis: Axis, bare: bool, decades: float) -> Data:
    made: Data = {
        "title": {"text": formulas.as_html(axis.words)},
        "type": axis.scale,
        "visible": not bare,
        "gridcolor": GRID,
        "linecolor": LINE,
        "showline": True,
        "ticks": "outside",
        "zeroline": False,
        "automargin": True,
        "exponentformat": "power" if axis.scale == "log" else "e",
    }
    if axis.scale == "log" and decades > 1:
        made["dtick"] = max(1, round(decades / 8))
    if axis.limits is not None:
        ends = np.log10(axis.limits) if axis.scale == "log" else np.asarray(axis.limits, float)
        made["range"] = ends.tolist()
    return made


def _in_plane(item: Item) -> list[Data]:
    if isinstance(item, Curve | Marks):
        return [{"type": "scatter", **_style(item), **_columns(item.points, "xy")}]
    if isinstance(item, Arrow):  # its shaft, so that it takes part in ranges and legend
        line = {"color": COLOURS[item.colour], "width": POINT * item.width}
        ends = _columns(np.stack([item.start, item.end]), "xy")
        return [{"type": "scatter", "mode": "lines", "line": line, "hoverinfo": "skip", **ends}]
    return []


def _plane_notes(item: Item, x: str, y: str) -> list[Data]:
    if isinstance(item, Words):
        return [_note(item.place, item.text, item.colour, x, y)]
    if not isinstance(item, Arrow):
        return []
    (a, b), (c, d) = item.start.tolist(), item.end.tolist()
    arrow: Data = {"x": c, "y": d, "ax": a, "ay": b, "xref": x, "yref": y, "axref": x, "ayref": y}
    arrow |= {"text": "", "showarrow": True, "arrowhead": 2, "arrowcolor": COLOURS[item.colour]}
    arrow |= {"arrowwidth": POINT * item.width, "arrowsize": 1}
    if not item.words:
        return [arrow]
    way = np.sign(np.round([c - a, d - b], 12))
    words = _note(item.end, item.words, item.colour, x, y)
    words |= {"xanchor": ("right", "center", "left")[int(way[0]) + 1], "xshift": 5 * way[0]}
    words |= {"yanchor": ("top", "middle", "bottom")[int(way[1]) + 1], "yshift": 5 * way[1]}
    return [arrow, words]


def _note(place: Floats, text: str, colour: str, x: str, y: str) -> Data:
    a, b = map(float, place)
    font = {"color": COLOURS[colour], "size": 14}
    words = formulas.as_html(text)
    return {"x": a, "y": b, "xref": x, "yref": y, "text": words, "showarrow": False, "font": font}
