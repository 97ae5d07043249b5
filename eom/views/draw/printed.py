"""A picture for print, by Matplotlib: PNG, SVG, PDF, with the same bytes each time.

The settings of whoever uses Matplotlib are left alone and have no effect. Space is drawn without
perspective; see `eom.views.draw.depth` for what hides what.

Of a long curve fewer points are drawn, none of its extremes lost; a solid is a translucent surface with
its sharp edges. In a notebook a picture is an image with the words for those who do not see it.
"""

from __future__ import annotations

import base64
import contextlib
import importlib.util
import io
import itertools
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eom.errors import InputError
from eom.views.draw import formulas
from eom.views.draw.depth import Drawn, View, bounds, diagonal, in_space
from eom.views.draw.formulas import as_text
from eom.views.draw.meshes import Faces, Mesh
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
)
from eom.views.draw.placing import place
from eom.views.draw.viewpoint import USUAL

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLE: Any = {
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": "#777777",
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "xtick.color": "#555555",
    "ytick.color": "#555555",
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "lines.solid_capstyle": "round",
    "figure.constrained_layout.h_pad": 0.06,
    "figure.constrained_layout.w_pad": 0.06,
    "svg.hashsalt": "eom",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
    "path.simplify": True,
}
DASHES: dict[str, Any] = {"solid": "-", "dashed": (0, (5, 2.5)), "dotted": (0, (1, 2))}
FLAT = (3.0, 2.2)
"""Least width of a column, and height of a row, of panels that show quantities over others; inches."""
WIDE = 6.5
"""Least width of a picture without equal scales; inches."""
SQUARE = (4.2, 3.6)
"""Width of a column and height of a row of panels in space or with equal scales; inches."""
LEGEND = 1.5
"""Width of a legend beside a panel; inches."""
LETTERS, ROOM = 15.0, 7
"""Letters of a legend below panels that an inch holds; the room that a line takes, in letters."""
TITLE = 11.0
"""Letters of a title that an inch holds."""
FULL, BARE = 0.98, 1.3
"""How large space is drawn with and without axes; at 1 a cube with its ticks fills the panel."""
BROAD = 1.1
"""How much more room space has across than a cube with its ticks needs."""
SEAM = 0.3
"""Width of the edges that close the seams between the triangles of an opaque surface; points."""
SIDEWAYS = 0.5
"""Words at the tip of an arrow in space whose way across the paper is more stand beside the tip."""


@contextlib.contextmanager
def _settings() -> Iterator[None]:
    import matplotlib as mpl

    with mpl.rc_context(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing", category=UserWarning)
        mpl.rcdefaults()
        mpl.rcParams.update(STYLE)
        yield


def figure(picture: Picture, size: tuple[float, float] | None = None) -> Figure:
    """Return a picture as a Matplotlib figure that no window and no global state knows.

    Parameters
    ----------
    picture : Picture
        What is drawn.
    size : tuple of float, float, optional
        Width and height in inches; by default so that all panels are read easily.

    Returns
    -------
    matplotlib.figure.Figure
        No window and no global state knows of it.

    Raises
    ------
    InputError
        For a ``picture`` that cannot be drawn (`eom.views.draw.picture.check`), and where
        Matplotlib is not installed.

    Examples
    --------
    >>> from eom.views.body.frame_sketches import frame_sketch
    >>> figure(frame_sketch("3-1-2"), size=(6, 5)).get_size_inches().tolist()
    [6.0, 5.0]
    """
    require()
    check(picture)
    with _settings():
        return _figure(picture, size)


def write(
    picture: Picture,
    file: Path | io.BytesIO,
    kind: str,
    size: tuple[float, float] | None,
    dpi: float,
) -> None:
    """Write a picture to a file of a ``kind`` (png, svg, pdf); ``dpi``: pixels an inch, of PNG.

    Raises as `figure`, and `OSError` where the file cannot be written. No date is written, so that the
    bytes depend on the picture and the version of Matplotlib alone.
    """
    check(picture)
    title, words = formulas.as_text(picture.title), formulas.as_text(picture.caption)
    metadata = {
        "png": {"Software": None, "Title": title, "Description": words},
        "svg": {"Date": None, "Creator": "eom", "Title": title, "Description": words},
        "pdf": {"CreationDate": None, "Creator": "eom", "Title": title, "Subject": words},
    }
    with _settings():
        _figure(picture, size).savefig(file, format=kind, dpi=dpi, metadata=metadata[kind])


def _figure(picture: Picture, size: tuple[float, float] | None) -> Figure:
    """Return the figure, with its labels where they overlap no other text."""
    made = _laid_out(picture, size)
    place(made)
    return made


def _laid_out(picture: Picture, size: tuple[float, float] | None) -> Figure:
    from matplotlib.figure import Figure

    rows = [row for row in picture.rows if row]
    heights = [max(height_of(panel) for panel in row) for row in rows]
    inches = size or size_of(picture)
    made = Figure(figsize=inches, layout="constrained")
    if picture.title:
        lines = formulas.wrapped(picture.title, TITLE * made.get_figwidth())
        made.suptitle("\n".join(map(typeset, lines.split("\n"))), fontsize=11)
    if any(_square(panel) for row in rows for panel in row):
        parts = made.subfigures(len(rows), 1, height_ratios=heights, squeeze=False)
        for part, row in zip(parts[:, 0], rows, strict=True):
            _row(part, row)
        return made
    grid = made.add_gridspec(len(rows), 1, height_ratios=heights)
    for k, row in enumerate(rows):
        if len(row) == 1:  # panels below each other have their sides in line
            _beside(_panel(made, grid[k, 0], row[0]), row[0])
            continue
        columns = grid[k, 0].subgridspec(1, len(row), width_ratios=[width_of(p) for p in row])
        for column, panel in enumerate(row):
            _beside(_panel(made, columns[0, column], panel), panel)
    return made


def _row(part: Any, row: tuple[Panel, ...]) -> None:
    """Draw a row of panels; one legend below them lists what is drawn in all."""
    columns = part.add_gridspec(1, len(row), width_ratios=[width_of(panel) for panel in row])
    drawn = [_panel(part, columns[0, k], panel) for k, panel in enumerate(row)]
    if not any(_square(panel) for panel in row):
        for axes, panel in zip(drawn, row, strict=True):
            _beside(axes, panel)
        return
    handles = {label: handle for panel in row for label, handle in _handles(panel).items()}
    if handles:
        longest = max(len(formulas.as_text(label)) for label in handles) + ROOM
        fitting = int(LETTERS * sum(map(width_of, row)) / longest)
        part.legend(
            list(handles.values()),
            [typeset(label) for label in handles],
            loc="outside lower center",
            ncols=max(1, min(fitting, len(handles))),
        )


def _square(panel: Panel) -> bool:
    return panel.equal or len(panel.axes) == 3


def height_of(panel: Panel) -> float:
    """Return the height in inches that a panel has if no size is asked for."""
    return panel.height * (SQUARE if _square(panel) else FLAT)[1]


def width_of(panel: Panel) -> float:
    """Return the width in inches that a panel and its legend have if no size is asked for."""
    if _square(panel):
        return panel.height * SQUARE[0]
    return FLAT[0] + (LEGEND if _handles(panel) else 0.0)


def size_of(picture: Picture) -> tuple[float, float]:
    """Return width and height in inches that a picture has if no size is asked for."""
    rows = [row for row in picture.rows if row]
    heights = (max(height_of(panel) for panel in row) for row in rows)
    return picture.size or _size(rows, sum(heights))


def _size(rows: list[tuple[Panel, ...]], height: float) -> tuple[float, float]:
    square = all(_square(panel) for row in rows for panel in row)
    widths = [sum(width_of(panel) for panel in row) for row in rows]
    return max(*widths, 0.0 if square else WIDE), height + 0.5


def _panel(made: Any, place: Any, panel: Panel) -> Any:
    if len(panel.axes) == 3:
        axes = made.add_subplot(place, projection="3d", proj_type="ortho", computed_zorder=False)
        _space(axes, panel)
    else:
        axes = made.add_subplot(place)
        _plane(axes, panel)
    if panel.title:
        axes.set_title(typeset(panel.title))
    return axes


def typeset(text: str) -> str:
    """Return words for Matplotlib; a formula that it cannot read is shown as it is written."""
    from matplotlib.mathtext import MathTextParser

    found = formulas.spans(text)
    marked = "".join(f"${s.text}$" if s.formula else s.text.replace("$", r"\$") for s in found)
    if not any(s.formula for s in found):
        return marked
    try:
        MathTextParser("path").parse(marked)
    except ValueError:
        return formulas.plain(text)
    return marked


def _handles(panel: Panel) -> dict[str, Any]:
    """Return what stands for each label in a legend; of equal labels the last."""
    named = {i.label: i for i in panel.items if not isinstance(i, Words) and i.label}
    return {label: _handle(item) for label, item in named.items()}


def _handle(item: Curve | Marks | Arrow | Surface) -> Any:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    colour = COLOURS[item.colour]
    if isinstance(item, Marks):
        return Line2D([], [], color=colour, linestyle="", marker="o", markersize=item.size)
    if isinstance(item, Surface):
        return Patch(color=colour, alpha=max(item.opacity, 0.3), linewidth=0)
    dash: Any = DASHES[item.dash] if isinstance(item, Curve) else "-"
    return Line2D([], [], color=colour, linewidth=item.width, linestyle=dash)


def _beside(axes: Any, panel: Panel) -> None:
    """Set the legend of a panel to its right."""
    if handles := _handles(panel):
        labels = [typeset(label) for label in handles]
        axes.legend(list(handles.values()), labels, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _plane(axes: Any, panel: Panel) -> None:
    for order, item in enumerate(panel.items, 3):
        colour = COLOURS[item.colour]
        if isinstance(item, Curve):
            x, y = item.points[:, 0], item.points[:, 1]
            axes.plot(
                x, y, color=colour, linewidth=item.width, linestyle=DASHES[item.dash], zorder=order
            )
        elif isinstance(item, Marks):
            x, y = item.points[:, 0], item.points[:, 1]
            axes.plot(
                x, y, "o", color=colour, markersize=item.size, markeredgewidth=0, zorder=order
            )
        elif isinstance(item, Arrow):
            _arrow(axes, item, order)
        elif isinstance(item, Words):
            at = {"ha": "center", "va": "center", "zorder": order, "annotation_clip": False}
            _note(axes, item.place, typeset(item.text), (0, 0), color=colour, **at)
    _axes(axes, panel, "xy")
    if panel.equal:
        axes.set_aspect("equal", adjustable="box")


def _arrow(axes: Any, item: Arrow, order: int) -> None:
    colour = COLOURS[item.colour]
    axes.annotate(
        "",
        item.end,
        item.start,
        zorder=order,
        arrowprops={
            "arrowstyle": "-|>,head_length=0.5,head_width=0.2",
            "color": colour,
            "linewidth": item.width,
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 8 + 2 * item.width,
        },
    )
    axes.plot(*np.transpose([item.start, item.end]), linestyle="")  # takes part in the limits
    if item.words:
        way = np.sign(np.round(np.subtract(item.end, item.start), 12))
        _note(
            axes,
            item.end,
            typeset(item.words),
            (6 * way[0], 6 * way[1]),
            color=colour,
            ha=("right", "center", "left")[int(way[0]) + 1],
            va=("top", "center", "bottom")[int(way[1]) + 1],
            zorder=order,
        )


def _note(axes: Any, at: Any, words: str, shift: tuple[float, float], **look: Any) -> None:
    """Write a label that may be moved, from a place on by some of a printer's points."""
    axes.annotate(words, tuple(at), xytext=shift, textcoords="offset points", **look)


def _axes(axes: Any, panel: Panel, letters: str) -> None:
    """Set words, scales and limits; hide all of them where the panel is bare."""
    for letter, axis in zip(letters, panel.axes, strict=True):
        _axis(axes, letter, axis)
    if panel.bare:
        axes.set_axis_off()


def _axis(axes: Any, letter: str, axis: Axis) -> None:
    axes.set(**{f"{letter}label": typeset(axis.words)})
    if axis.scale == "log":
        axes.set(**{f"{letter}scale": "log"})
    if axis.limits is not None:
        axes.set(**{f"{letter}lim": axis.limits})


def _space(axes: Any, panel: Panel) -> None:
    """Draw all items of a panel in space as one collection, sorted by depth as one."""
    low, high = bounds(panel)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    elevation, azimuth = panel.view or USUAL
    axes.view_init(elev=elevation, azim=azimuth)
    axes.set_box_aspect((1, 1, 1))
    cube = _extent(axes, low, high)
    axes.set_box_aspect(high - low if panel.equal else (1, 1, 1))
    zoom = float((cube * (BROAD, 1.0) / _extent(axes, low, high)).min())
    axes.set_box_aspect(
        high - low if panel.equal else (1, 1, 1), zoom=zoom * (BARE if panel.bare else FULL)
    )
    _axes(axes, panel, "xyz")
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.pane.set_facecolor("none")
        axis.pane.set_edgecolor("#dddddd")
        axis.line.set_color("#777777")
        axis.set_tick_params(pad=-1)
        axis.labelpad = 2
        axis.set_major_locator(_few())
    view = View.of(axes.get_proj(), low, high)
    if drawn := view.sorted(in_space(panel, view.towards, diagonal(low, high))):
        axes.add_collection(_collection(view, drawn), autolim=False)
    _labels(axes, panel, view)


def _extent(axes: Any, low: Floats, high: Floats) -> Floats:
    """Return width and height of a box as it is seen."""
    corners = np.array(np.meshgrid(*np.stack([low, high], 1))).reshape(3, -1).T
    seen = View.of(axes.get_proj(), low, high).flat(corners)
    return np.asarray(np.ptp(seen, axis=0))


def _few() -> Any:
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(5, steps=[1, 2, 5, 10])


def _collection(view: View, drawn: list[Drawn]) -> Any:
    from matplotlib.collections import PolyCollection

    none = (0.0, 0.0, 0.0, 0.0)
    made: Any = PolyCollection(
        [view.flat(d.points) for d in drawn],
        closed=False,
        facecolors=[none if d.width else d.colour for d in drawn],
        edgecolors=[d.colour if d.width or d.colour[3] == 1 else none for d in drawn],
        linewidths=[d.width or SEAM for d in drawn],
        capstyle="round",
        joinstyle="round",
        clip_on=False,
        zorder=3,
    )
    made.set_in_layout(False)
    made.do_3d_projection = lambda: 0.0  # axes in space ask each collection for its depth
    return made


def _labels(axes: Any, panel: Panel, view: View) -> None:
    for item in panel.items:
        if isinstance(item, Words):
            _label(axes, view.flat(item.place), item.text, item.colour, (0.0, 0.0))
        elif isinstance(item, Arrow) and item.words:
            end = view.flat(item.end)
            way = end - view.flat(item.start)
            size = float(np.hypot(*way))
            shift = way / size if size > 0 else way
            _label(axes, end, item.words, item.colour, (float(shift[0]), float(shift[1])))


def _label(axes: Any, at: Any, text: str, colour: str, shift: tuple[float, float]) -> None:
    """Write words at a place of the projection, or beside it on the side of a unit vector."""
    from matplotlib.patheffects import withStroke

    side = int(np.sign(shift[0])) if abs(shift[0]) > SIDEWAYS else 0
    _note(
        axes,
        at,
        typeset(text),
        (6 * shift[0], 9 * shift[1]),
        color=COLOURS[colour],
        ha=("right", "center", "left")[side + 1],
        va="center",
        zorder=5,
        annotation_clip=False,
        path_effects=[withStroke(linewidth=2.0, foreground="white")],
    )


MOST = 4000
"""Points of one curve that are drawn: more than a picture has columns of dots."""


def thinned(x: Floats, y: Floats, most: int = MOST) -> tuple[Floats, Floats]:
    """Return a curve with at most ``most`` points: the least and largest y of each stretch of it.

    ``x``, ``y``: shape (N,). The points are some of those given, in their order, the first and the last
    among them; a stretch without numbers keeps one that is none, so that gaps stay gaps.
    """
    size = len(x)
    if size <= most:
        return x, y
    edges = np.linspace(0, size, most // 2).astype(np.int64)
    kept = {0, size - 1}
    for first, last in itertools.pairwise(edges):
        kept |= _extremes(y[first:last], int(first))
    chosen = np.array(sorted(kept))
    return x[chosen], y[chosen]


def _extremes(y: Floats, first: int) -> set[int]:
    """Return the places of the least and the largest number, or of one that is none."""
    known = np.flatnonzero(np.isfinite(y))
    if len(known) == 0:
        return {first}
    return {first + int(known[np.argmin(y[known])]), first + int(known[np.argmax(y[known])])}


OPACITY = 0.3


def solid(mesh: Mesh, C: Floats, origin: Floats, colour: str = "sky") -> Iterator[Item]:
    """Yield the surface of a mesh in its body's axes, and its edges; C from space to the body."""
    vertices = mesh.vertices @ C + origin
    yield Surface(vertices, mesh.faces, colour, OPACITY)
    edges = sharp_edges(mesh)
    if len(edges):
        gaps = np.full((len(edges), 1, 3), np.nan)
        lines = np.concatenate([vertices[edges], gaps], axis=1)
        yield Curve(lines.reshape(-1, 3), colour, 0.8)


def sharp_edges(mesh: Mesh) -> Faces:
    """Return the edges that one triangle alone has, pairs of vertices of shape (N, 2).

    A mesh shares vertices within its smooth pieces, so that these bound them.
    """
    pairs = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, counts = np.unique(pairs, axis=0, return_counts=True)
    return np.asarray(edges[counts == 1])


def installed() -> bool:
    """Return whether Matplotlib is there."""
    return importlib.util.find_spec("matplotlib") is not None


def require(where: str = "") -> None:
    """Raise `InputError` that says which extra to install where Matplotlib is missing."""
    if not installed():
        hint = "pip install 'eom-toolkit[plot]', or write a page, .html"
        raise InputError("Matplotlib is not installed", where=where, hint=hint)


DPI = 96.0

Bundle = tuple[dict[str, str], dict[str, dict[str, str]]]


def bundle(picture: Picture) -> Bundle:
    """Return what IPython's display takes: data and metadata by kind.

    PNG, and as text the title with the caption, which is also the image's text for screen readers. Raises
    `InputError` for a picture that cannot be drawn.
    """
    drawn = io.BytesIO()
    write(picture, drawn, "png", None, DPI)
    image = base64.b64encode(_smaller(drawn)).decode("ascii")
    words = ". ".join(as_text(part) for part in (picture.title, picture.caption) if part)
    return {"image/png": image, "text/plain": words}, {"image/png": {"alt": words}}


def _smaller(file: io.BytesIO) -> bytes:
    """Return an image with a palette: a third of the bytes, and the same to the eye."""
    from PIL import Image

    made = io.BytesIO()
    with Image.open(file) as image:
        image.convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
            made, "PNG", optimize=True
        )
    return made.getvalue()
