"""Places of the bodies of a tree in a diagram: columns by distance from the ground, bands below each other.

A body's children are one column to its right, in rows of their own; where the columns are used up, the
tree goes on in a band below. No two bodies share a place, and lines in the gaps between columns cross
no body.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

CROWD, MOST_TURNS = 12, 3
"""Leaves on one node that stand below each other in one column; columns in which more take turns."""


@dataclass(frozen=True)
class Cell:
    """Where a node is: its row from the top, its column from the left, and its band."""

    row: int
    column: int
    band: int


def cells(root: str, children: Mapping[str, Sequence[str]], columns: int) -> dict[str, Cell]:
    """Return the cell of every node of a tree, at most ``columns`` (at least 2) beside each other.

    Every leaf takes a row; a parent stands in the row of its middle child.
    """
    found: dict[str, Cell] = {}
    waiting = deque([root])
    band = first = 0
    while waiting:
        start = waiting.popleft()
        block = _block(start, children, columns, bool(band))
        for node, (row, column) in block.items():
            found[node] = Cell(first + row, column, band)
            if column == columns - 1:
                waiting.extend(children.get(node, ()))
        first += 1 + max(row for row, _ in block.values())
        band += 1
    return found


def _block(
    start: str, children: Mapping[str, Sequence[str]], columns: int, indented: bool
) -> dict[str, tuple[int, int]]:
    """Return row and column of a node and of those below it that the columns have room for."""
    levels = {start: int(indented)}
    order = [start]
    stack = [start]
    while stack:
        node = stack.pop()
        if levels[node] < columns - 1:
            below = list(children.get(node, ()))
            levels |= _levels(below, levels[node] + 1, children, columns - 1)
            stack += reversed(below)
        if node != start:
            order.append(node)
    rows: dict[str, int] = {}
    leaves = 0
    for node in order:
        if not any(c in levels for c in children.get(node, ())):
            rows[node] = leaves
            leaves += 1
    for node in reversed(order):
        if node not in rows:
            rows[node] = rows[children[node][(len(children[node]) - 1) // 2]]
    return {node: (rows[node], levels[node]) for node in order}


def _levels(
    below: Sequence[str], first: int, children: Mapping[str, Sequence[str]], last: int
) -> dict[str, int]:
    """Return the columns of the children of one node: many leaves take turns in several columns."""
    leaves = [node for node in below if not children.get(node)]
    turns = max(1, min(MOST_TURNS, 1 + last - first, -(-len(leaves) // CROWD)))
    return dict.fromkeys(below, first) | {n: first + k % turns for k, n in enumerate(leaves)}
