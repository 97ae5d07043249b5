"""What notebooks display of results: small tables in HTML, and lines over time as inline SVG."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
WIDE, HIGH = 120, 22
"""Size of a line over time, in pixels."""
COLUMNS = 60
"""Stretches of time, of each of which the least and the largest value are drawn."""
MOST = 16
"""Rows of a table."""
FEW = 8
"""Names that a short text lists."""


class Markup(str):
    """A piece of HTML; other texts are quoted."""

    __slots__ = ()


def number(value: float) -> str:
    """Return a number in six digits."""
    return f"{float(value) + 0.0:.6g}"


def listed(names: Sequence[str], most: int = FEW) -> str:
    """Return names as a text: the first few, and how many more there are.

    >>> listed(["a", "b", "c"], 2)
    'a, b and 1 more'
    """
    rest = len(names) - most
    return ", ".join(names[:most]) + (f" and {rest} more" if rest > 0 else "")


def table(rows: Iterable[Sequence[str]], header: Sequence[str] = (), caption: str = "") -> Markup:
    """Return a table of texts, which are quoted, and of `Markup`; of many rows the first."""
    found = list(rows)
    head = _row("th", header) if header else ""
    body = "".join(_row("td", row) for row in found[:MOST])
    if len(found) > MOST:
        body += f'<tr><td colspan="{len(found[0])}">and {len(found) - MOST} more</td></tr>'
    title = f"<caption>{_text(caption)}</caption>" if caption else ""
    return Markup(f"<table>{title}<thead>{head}</thead><tbody>{body}</tbody></table>")


def _row(kind: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{kind}>{_text(c)}</{kind}>" for c in cells) + "</tr>"


def _text(value: str) -> str:
    return value if isinstance(value, Markup) else escape(value)


def sparkline(t: Array, y: Array) -> Markup:
    """Return values (N,) over times (N,) as a small picture; what is no number leaves a gap."""
    good = np.isfinite(y) & np.isfinite(t)
    if good.sum() < 2 or t[good].min() == t[good].max():  # a line has two ends
        return Markup("")
    x, values = t[good], y[good]
    least, span = float(values.min()), float(np.ptp(values))
    first, length = float(t[good].min()), float(np.ptp(t[good]))
    column = np.minimum(((x - first) / length * COLUMNS).astype(int), COLUMNS - 1)
    paths: list[str] = []
    before = -2
    for k in np.unique(column):
        own = column == k
        ends = np.flatnonzero(own)[[0, -1]]
        marks = sorted({int(ends[0]), int(ends[1]), *_extremes(values, own)})
        points = [_place(x[m], values[m], (first, length), (least, span)) for m in marks]
        gap = k - before > max(1, COLUMNS // len(x) + 1) and bool(np.any(~good))
        paths.append(("M" if gap or not paths else "L") + " L".join(points))
        before = int(k)
    line = " ".join(paths)
    words = f"from {number(values[0])} to {number(values[-1])}, {number(least)} to {number(least + span)}"
    return Markup(
        f'<svg role="img" aria-label="{words}" width="{WIDE}" height="{HIGH}" viewBox="0 0 {WIDE} {HIGH}">'
        f'<path d="{line}" fill="none" stroke="currentColor" stroke-width="1"/></svg>'
    )


def _extremes(values: Array, own: NDArray[np.bool_]) -> tuple[int, int]:
    places = np.flatnonzero(own)
    return int(places[np.argmin(values[places])]), int(places[np.argmax(values[places])])


def _place(x: float, y: float, time: tuple[float, float], size: tuple[float, float]) -> str:
    (first, length), (least, span) = time, size
    across = 1 + (WIDE - 2) * (x - first) / length
    up = 0.5 if not (span > 0 and math.isfinite(span)) else (y - least) / span
    return f"{across:.1f} {1 + (HIGH - 2) * (1 - up):.1f}"


def matrix(values: Array, rows: Sequence[str], columns: Sequence[str], caption: str) -> Markup:
    """Return a matrix (n, m) with the names of its rows and columns; nothing of an empty one."""
    if not values.size or values.ndim != 2:  # one a point
        return Markup("")
    few = slice(None, MOST)
    lines = [(name, *map(number, row[few])) for name, row in zip(rows, values, strict=True)]
    return table(lines, (caption, *columns[few]))
