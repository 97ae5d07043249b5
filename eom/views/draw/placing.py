"""Labels of a printed picture where they cover no other text: boxes of all text, and where labels go.

A label stays where it is drawn unless its box overlaps another's, or in space covers much. Then it goes to
the nearest place round its point where it overlaps none, covers little of what is drawn and leaves the
picture nowhere; a thin line leads from there to its point. Numbers at the axes are no labels: of two that
overlap one is left out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eom.views.draw.picture import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GAP = 1.5
"""Room between boxes, in pixels."""
WAYS, RINGS = 24, 40
"""Directions round a point in which places are tried, and distances in each."""
STEP = 7.0
"""Distance of the rings, in pixels."""
LEADING = 12.0
"""How far a box is from its point, in pixels, where a line leads to it."""
COVERED = 0.25
"""Weight of what a label covers, in cells of what is drawn, against the distance of one ring."""
TURNED = 0.8
"""Weight of a half turn away from where a label would stand, against the distance of one ring."""
CELL = 4
"""Pixels of a cell of what is drawn."""
THIN = {"arrowstyle": "-", "linewidth": 0.5, "color": "#777777", "shrinkA": 0.0, "shrinkB": 0.0}


@dataclass(frozen=True, eq=False)
class Box:
    """The box of a text as it is drawn: its ``middle``, half its ``size``, in pixels, and its ``angle``."""

    text: str
    middle: Floats
    size: Floats
    angle: float = 0.0

    @property
    def axes(self) -> Floats:
        """Unit vectors along its sides, as rows."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        return np.array([[c, s], [-s, c]])

    @property
    def corners(self) -> Floats:
        """Its corners, (4, 2)."""
        signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        return np.asarray(self.middle + (signs * self.size) @ self.axes)


def overlap(a: Box, b: Box, gap: float = 0.0) -> bool:
    """Return whether two boxes come nearer than a ``gap``: no side of either parts them."""
    if math.hypot(*(a.middle - b.middle)) > math.hypot(*a.size) + math.hypot(*b.size) + gap:
        return False
    for axis in (*a.axes, *b.axes):
        first, second = a.corners @ axis, b.corners @ axis
        if first.max() + gap <= second.min() or second.max() + gap <= first.min():
            return False
    return True


def boxes(figure: Figure) -> list[Box]:
    """Return the boxes of all texts of a figure that are seen, as they are drawn at its resolution."""
    figure.draw_without_rendering()
    return [_box(t) for t in _texts(figure)]


def overlaps(figure: Figure) -> list[tuple[str, str]]:
    """Return the pairs of texts of a figure whose boxes overlap by more than rounding."""
    found = boxes(figure)
    pairs = itertools.combinations(found, 2)
    return [(a.text, b.text) for a, b in pairs if overlap(a, b, -0.5)]


Way = tuple[int, int]
"""Where a label has been moved to: number of a ring round its point, and of a direction."""
STAY = 2.0
"""What it is worth that a label stays where it was in the picture before, against one ring."""


def place(figure: Figure, *, covering: bool = False, before: dict[str, Way] | None = None) -> None:
    """Move the labels of a figure where they overlap no text; the layout of its panels is then fixed.

    Labels are annotations with words, in the order in which they are drawn: the first ones stay.
    ``covering``: whether they may cover what is drawn, so that they move as little as can be.
    ``before``: where labels were moved to in the picture before, by their words; those of this one are
    written there, so that labels stay steady in a film.
    """
    from matplotlib.text import Annotation

    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    texts = [*_texts(figure)]
    labels = [t for t in texts if isinstance(t, Annotation)]
    taken = _fixed(figure, [t for t in texts if not isinstance(t, Annotation)])
    if not labels:
        return
    clear = _Ink.of(figure, ())
    ink = clear if covering else _Ink.of(figure, _drawn(figure))
    known = {} if before is None else before
    ways: dict[str, Way] = {}
    for label in labels:
        in_space = hasattr(label.axes, "zaxis")  # in a plane words stand where they are put
        box, way = _moved(label, _box(label), taken, ink if in_space else clear, known)
        taken.append(box)
        if way is not None:
            ways[label.get_text()] = way
    known.clear()
    known.update(ways)


def _fixed(figure: Any, texts: Sequence[Any]) -> list[Box]:
    """Return the boxes of texts that stay; of overlapping numbers at axes the later ones are left out."""
    numbers = {t for axes in figure.axes for axis in _axes_of(axes) for t in _numbers(axis)}
    taken = [_box(t) for t in texts if t not in numbers]
    for text in texts:
        if text in numbers:
            box = _box(text)
            if any(overlap(box, other) for other in taken):
                text.set_visible(False)
            else:
                taken.append(box)
    return taken


@dataclass(frozen=True, eq=False)
class _Ink:
    """How much is drawn left of and below the corners of cells, and the figure's ``size`` in pixels."""

    sums: Floats
    size: Floats

    @classmethod
    def of(cls, figure: Any, drawn: Iterable[Floats]) -> _Ink:
        size = np.array([figure.bbox.width, figure.bbox.height])
        cells = np.zeros(tuple(int(n) // CELL + 2 for n in size))
        for points in drawn:
            known = points[np.all(np.isfinite(points), axis=1)]
            inside = known[np.all((known >= 0) & (known < size), axis=1)]
            at = (inside // CELL).astype(np.int64)
            cells[at[:, 0], at[:, 1]] = 1.0
        sums = np.zeros((cells.shape[0] + 1, cells.shape[1] + 1))
        sums[1:, 1:] = cells.cumsum(axis=0).cumsum(axis=1)
        return cls(sums, size)

    def under(self, box: Box) -> float:
        """Return the cells under a box in which something is drawn."""
        edges = np.stack([box.middle - box.size, box.middle + box.size]) / CELL
        (a, b), (c, d) = np.clip(edges, 0, np.array(self.sums.shape) - 1).astype(np.int64)
        return float(self.sums[c, d] - self.sums[a, d] - self.sums[c, b] + self.sums[a, b])


def _drawn(figure: Any) -> Iterator[Floats]:
    """Yield points along what is drawn, in pixels, near enough to each other to fill the cells between."""
    for axes in figure.axes:
        to_pixels = axes.transData
        for line in axes.lines:
            yield _filled(to_pixels.transform(line.get_xydata()))
        for collection in axes.collections:
            for path in collection.get_paths():
                yield _filled(to_pixels.transform(path.vertices))
        for text in axes.texts:
            arrow = getattr(text, "arrow_patch", None)
            if arrow is not None:
                yield _filled(to_pixels.transform([text.xy, text.xyann]))


def _filled(points: Floats) -> Floats:
    """Return the points of a line with points between them."""
    if len(points) < 2:
        return points
    longest = float(np.nanmax(np.hypot(*np.diff(points, axis=0).T), initial=0.0))
    count = int(min(longest // CELL + 1, 400))
    shares = np.linspace(0.0, 1.0, count, endpoint=False)[:, None, None]
    between = points[:-1] + shares * np.diff(points, axis=0)
    return np.concatenate([between.reshape(-1, 2), points[-1:]])


def _is_free(box: Box, taken: Sequence[Box], size: Floats) -> bool:
    inside = np.all(box.middle - box.size >= 0) and np.all(box.middle + box.size <= size)
    return bool(inside) and not any(overlap(box, other, GAP) for other in taken)


def _moved(
    label: Any, box: Box, taken: Sequence[Box], ink: _Ink, before: Mapping[str, Way]
) -> tuple[Box, Way | None]:
    """Move a label to the best free place round its point, with a line to there; return box and place."""
    anchor = np.asarray(label.axes.transData.transform(label.xy))
    found, way = _best(anchor, box, taken, ink, before.get(box.text))
    if way is None:
        return box, None
    scale = 72.0 / label.get_figure(root=True).dpi
    label.set(ha="center", va="center")
    label.xyann = tuple(scale * (found.middle - anchor))
    end = np.clip(anchor, found.middle - found.size, found.middle + found.size)
    if np.hypot(*(end - anchor)) > LEADING:
        line = label.axes.annotate(
            "", label.xy, tuple(scale * (end - anchor)), textcoords="offset points",
            arrowprops=THIN, annotation_clip=False, zorder=4.5,
        )  # fmt: skip
        line.set_in_layout(False)
    return found, way


def _best(
    anchor: Floats, box: Box, taken: Sequence[Box], ink: _Ink, before: Way | None
) -> tuple[Box, Way | None]:
    """Return the best free box and where it is; the given one where it is that, or no other is free."""
    away = box.middle - anchor
    start = math.atan2(away[1], away[0]) if math.hypot(*away) > 1.0 else math.pi / 2
    best, found = box, None
    least = COVERED * ink.under(box) if _is_free(box, taken, ink.size) else math.inf
    for ring in range(1, RINGS):
        if ring - (STAY if before else 0.0) >= least:
            break
        for k in range(WAYS):
            turn = 2 * math.pi * k / WAYS
            way = np.array([math.cos(start + turn), math.sin(start + turn)])
            tried = Box(box.text, anchor + way * (STEP * ring + box.size), box.size, box.angle)
            cost = ring + COVERED * ink.under(tried) + TURNED * (1 - math.cos(turn)) / 2
            cost -= STAY if before == (ring, k) else 0.0
            if cost < least and _is_free(tried, taken, ink.size):
                best, least, found = tried, cost, (ring, k)
    return best, found


def _texts(figure: Any) -> Iterator[Any]:
    """Yield the texts of a figure that are drawn: titles, legends, labels, names and numbers of axes."""
    from matplotlib.text import Text

    parts = [figure, *figure.subfigs]
    legends = [g for part in parts for g in part.legends]
    legends += [a.get_legend() for a in figure.axes if a.get_legend() is not None]
    found = [*figure.texts, *(t for g in legends for t in g.findobj(Text))]
    for axes in figure.axes:
        found += [axes.title, *axes.texts]
        if getattr(axes, "_axis3don", axes.axison):
            for axis in _axes_of(axes):
                found += [axis.label, axis.offsetText, *_numbers(axis)]
    suptitle = [figure._suptitle] if figure._suptitle is not None else []
    for text in dict.fromkeys((*found, *suptitle)):
        if text.get_visible() and text.get_text().strip():
            yield text


def _axes_of(axes: Any) -> tuple[Any, ...]:
    return (axes.xaxis, axes.yaxis, *([axes.zaxis] if hasattr(axes, "zaxis") else []))


def _numbers(axis: Any) -> list[Any]:
    """Return the numbers at an axis that are drawn: some are held ready and are not."""
    low, high = sorted(axis.get_view_interval())
    room = 1e-9 * (high - low)
    drawn = [t for t in axis._update_ticks() if low - room <= t.get_loc() <= high + room]
    return [t.label1 for t in drawn] + [t.label2 for t in drawn if t.label2.get_visible()]


def _box(text: Any) -> Box:
    turn = text.get_rotation() % 360
    drawn = text.get_window_extent()
    middle = np.array([(drawn.x0 + drawn.x1) / 2, (drawn.y0 + drawn.y1) / 2])
    if turn % 180:
        text.set_rotation(0)
        own = text.get_window_extent()
        text.set_rotation(turn)
    else:
        own, turn = drawn, 0
    size = 0.5 * np.array([own.width, own.height])
    return Box(text.get_text(), middle, size, math.radians(turn))
