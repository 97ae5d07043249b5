"""A picture as lines alone: SVG for pages, and LaTeX's own ``picture``, which needs no package.

One panel in space, without perspective, as `eom.views.draw.viewpoint` sees it. Of a surface the sharp edges
and the outline are drawn, those of faces turned away are left out.
"""

from __future__ import annotations

import html
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from eom.views.draw.formulas import as_runs, as_text
from eom.views.draw.picture import (
    COLOURS,
    Arrow,
    Curve,
    Floats,
    Marks,
    Panel,
    Picture,
    Surface,
    Words,
    check,
)
from eom.views.draw.viewpoint import USUAL, line_of_sight, paper

SIZE = 72.0
"""Millimetres that the longer side of a drawing has."""
PIXELS = 5.0
"""Pixels of SVG in a millimetre."""
SHARP = 0.9
"""Cosine between neighbouring faces below which their edge is seen."""
HEAD = 2.2
"""Length of an arrow's head, mm."""
SHORT = 0.5
"""The shortest line that LaTeX draws, mm."""
AWAY = 3.0
"""How far from the tip of an arrow its name is, mm."""
LETTER, RAISED, HIGH = 1.7, 1.2, 4.0
"""Width of a letter and of one of an index, and height of a name, mm."""
ROUND = np.array(
    [(0.0, 0.0)]
    + [
        (r * np.cos(a), r * np.sin(a))
        for r in np.arange(1.0, 11.0)
        for a in np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    ]
)
"""Places round that of a name that are tried, mm, the nearest first."""
COVERED, CROWDED = 0.7, 100.0
"""Weights of a millimetre of line under a name and of a name under it, against one of distance."""


@dataclass(frozen=True, eq=False)
class Stroke:
    """A line on paper through ``points``, shape (N, 2), mm; ``head``: whether it is an arrow."""

    points: Floats
    colour: str
    width: float
    head: bool = False


@dataclass(frozen=True, eq=False)
class Name:
    """Words in TeX at a ``place`` on paper, shape (2,), in mm."""

    place: Floats
    text: str
    colour: str


def drawing(picture: Picture) -> tuple[list[Stroke], list[Name], Floats]:
    """Return the lines and names of a picture's first panel, and the size of the paper, in mm.

    Raises `InputError` for a ``picture`` that cannot be drawn (`eom.views.draw.picture.check`).
    """
    (panel, *_), *_ = check(picture).rows
    flat = np.stack(paper(panel.view or USUAL))
    raw = list(_lines(panel))
    lines = [(flat @ s.points.T).T for s in raw]
    names = [
        (flat @ np.asarray(i.place), i.text, i.colour) for i in panel.items if isinstance(i, Words)
    ]
    low = np.min([*(p.min(axis=0) for p in lines), *(n[0] for n in names)], axis=0)
    high = np.max([*(p.max(axis=0) for p in lines), *(n[0] for n in names)], axis=0)
    scale = SIZE / float((high - low).max())
    margin = 2 * AWAY

    def placed(points: Floats) -> Floats:
        return np.asarray((points - low) * scale + margin)

    strokes = [
        Stroke(placed(p), s.colour, s.width, s.head) for p, s in zip(lines, raw, strict=True)
    ]
    called = [Name(placed(place), text, colour) for place, text, colour in names]
    size = np.asarray((high - low) * scale + 2 * margin)
    return strokes, apart([*_tips(panel, strokes, raw), *called], strokes, size), size


def _tips(panel: Panel, strokes: list[Stroke], raw: list[Stroke]) -> Iterator[Name]:
    """Yield the names of arrows, beyond their tips."""
    arrows = [i for i in panel.items if isinstance(i, Arrow)]
    ends = [s for s, r in zip(strokes, raw, strict=True) if r.head]
    for item, stroke in zip(arrows, ends, strict=True):
        if item.words:
            way = stroke.points[-1] - stroke.points[0]
            size = float(np.hypot(*way)) or 1.0
            yield Name(stroke.points[-1] + AWAY * way / size, item.words, item.colour)


def half(name: Name) -> Floats:
    """Return half the width and height of a name, mm."""
    wide = sum(len(w) * (RAISED if level else LETTER) for w, _, level in as_runs(name.text))
    return np.array([wide, HIGH]) / 2.0


def apart(names: list[Name], strokes: list[Stroke], size: Floats) -> list[Name]:
    """Return names, each at the place near its own where it covers no earlier one and little that is drawn.

    ``size``: of the paper, mm, within which names stay.
    """
    drawn = np.concatenate([_sampled(s.points) for s in strokes])
    placed: list[Name] = []
    for name in names:
        room, places = half(name), name.place + ROUND
        under = np.abs(drawn[None] - places[:, None]) < room
        costs = np.hypot(*ROUND.T) + COVERED * np.all(under, axis=2).sum(axis=1)
        for other in placed:
            costs += CROWDED * np.all(np.abs(other.place - places) < room + half(other), axis=1)
        costs += CROWDED * np.any((places < room) | (places > size - room), axis=1)
        placed.append(Name(places[int(np.argmin(costs))], name.text, name.colour))
    return placed


def _sampled(points: Floats) -> Floats:
    """Return points along a line, one a millimetre."""
    way = np.diff(points, axis=0)
    counts = [int(np.hypot(*w)) + 1 for w in way]
    between = [
        p + np.linspace(0, 1, n)[:, None] * w for p, w, n in zip(points, way, counts, strict=False)
    ]
    return np.concatenate([*between, points[-1:]])


def _lines(panel: Panel) -> Iterator[Stroke]:
    """Yield what is drawn as lines in space, in the order of the items."""
    sight = line_of_sight(panel.view or USUAL)
    for item in panel.items:
        if isinstance(item, Curve):
            yield Stroke(item.points, item.colour, item.width)
        elif isinstance(item, Arrow):
            yield Stroke(np.stack([item.start, item.end]), item.colour, item.width, True)
        elif isinstance(item, Marks):
            for point in item.points:
                yield Stroke(np.stack([point, point]), item.colour, item.size)
        elif isinstance(item, Surface):
            for edge in outline(item, sight):
                yield Stroke(edge, item.colour, 1.0)


def outline(surface: Surface, sight: Floats) -> Iterator[Floats]:
    """Yield the edges of a surface that are seen, shape (2, 3): sharp ones, and where it turns away."""
    vertices, faces = surface.vertices, surface.faces
    _, same = np.unique(np.round(vertices, 9), axis=0, return_inverse=True)
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(normals, axis=1)
    around: dict[tuple[int, int], list[tuple[int, int, int]]] = defaultdict(list)
    for k in np.flatnonzero(sizes > 1e-12):
        face = faces[k]
        for a, b in zip(face, np.roll(face, -1), strict=True):
            i, j = sorted((int(same[a]), int(same[b])))
            if i != j:
                around[i, j].append((int(k), int(a), int(b)))
    facing = normals @ sight > 0
    for found in around.values():
        seen = [facing[k] for k, _, _ in found]
        (first, a, b), last = found[0], found[-1][0]
        bend = float(normals[first] @ normals[last]) / float(sizes[first] * sizes[last])
        if len(found) == 1 or (any(seen) and (not all(seen) or bend < SHARP)):
            yield vertices[[a, b]]


# -- SVG -------------------------------------------------------------------------------------


def svg(picture: Picture) -> str:
    """Return a picture as one element of SVG, its caption as the words for those who cannot see it."""
    strokes, names, (across, up) = drawing(picture)
    width, height = (f"{PIXELS * s:.0f}" for s in (across, up))
    parts = [_path(s, up) for s in strokes] + [_text(n, up) for n in names]
    words = html.escape(as_text(picture.caption or picture.title))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{words}" width="{width}" '
        f'height="{height}" viewBox="0 0 {width} {height}" style="max-width:100%;background:#fff">'
        f"{''.join(parts)}</svg>"
    )


def _pairs(points: Floats, up: float) -> list[str]:
    return [f"{PIXELS * x:.1f} {PIXELS * (up - y):.1f}" for x, y in points]


def _path(stroke: Stroke, up: float) -> str:
    colour = COLOURS[stroke.colour]
    points = stroke.points
    way = f"M{' L'.join(_pairs(points, up))}"
    look = f'stroke="{colour}" stroke-width="{stroke.width:.1f}" stroke-linecap="round" fill="none"'
    head = ""
    if stroke.head:
        sides = _head(points)
        head = f'<path d="M{" L".join(_pairs(sides, up))} Z" fill="{colour}"/>'
    return f'<path d="{way}" {look}/>{head}'


def _head(points: Floats) -> Floats:
    """Return the corners of an arrow's head, its tip in the middle."""
    way = points[-1] - points[0]
    size = float(np.hypot(*way))
    if size < 1e-9:
        return np.repeat(points[-1:], 3, axis=0)
    along = HEAD * way / size
    across = 0.36 * np.array([-along[1], along[0]])
    tip = points[-1]
    return np.stack([tip - along + across, tip, tip - along - across])


_LEVELS = {"": 0.0, "sub": 4.0, "sup": -6.0}
"""How far below the line words are, pixels."""
_STYLES = {"": "", "i": ' font-style="italic"', "b": ' font-weight="bold"'}


def _text(name: Name, up: float) -> str:
    x, y = PIXELS * name.place[0], PIXELS * (up - name.place[1])
    runs = as_runs(name.text.replace(r"\mathcal", r"\mathrm"))
    below, spans = 0.0, []
    for words, style, level in runs:
        move, below = _LEVELS[level] - below, _LEVELS[level]
        size = ' font-size="11"' if level else ""
        spans.append(f'<tspan dy="{move:g}"{size}{_STYLES[style]}>{html.escape(words)}</tspan>')
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" fill="{COLOURS[name.colour]}" font-family="Georgia, serif" '
        f'font-size="16" text-anchor="middle" dominant-baseline="central">{"".join(spans)}</text>'
    )


# -- LaTeX -----------------------------------------------------------------------------------


def latex(picture: Picture) -> str:
    """Return a picture as an environment of LaTeX, in black."""
    strokes, names, (across, up) = drawing(picture)
    lines = [line for s in strokes for line in _segments(s)]
    lines += [
        rf"\put({n.place[0]:.2f},{n.place[1]:.2f}){{\makebox(0,0){{\small {n.text}}}}}"
        for n in names
    ]
    body = "\n".join(lines)
    return (
        f"\\begingroup\\setlength{{\\unitlength}}{{1mm}}\n"
        f"\\begin{{picture}}({across:.2f},{up:.2f})\n{body}\n\\end{{picture}}\\endgroup"
    )


def _segments(stroke: Stroke) -> Iterator[str]:
    points = stroke.points
    if np.array_equal(points[0], points[-1]) and len(points) == 2:
        yield rf"\put({points[0][0]:.2f},{points[0][1]:.2f}){{\circle*{{1}}}}"
        return
    command = r"\thicklines" if stroke.width > 1.4 else r"\thinlines"
    yield command
    kept = [points[0]]
    for point in points[1:]:
        if float(np.hypot(*(point - kept[-1]))) >= SHORT:
            kept.append(point)
    yield from map(_segment, kept[:-1], kept[1:])
    if stroke.head:
        left, tip, right = _head(points)
        yield from (_segment(left, tip), _segment(tip, right))


def _segment(start: Floats, end: Floats) -> str:
    a, b, c = (f"({x:.2f},{y:.2f})" for x, y in (start, (start + end) / 2, end))
    return rf"\qbezier{a}{b}{c}"
