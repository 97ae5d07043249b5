"""A diagram of a tree of joints: bodies as boxes, joints as lines with their kind, constraints dashed.

Bodies stand in columns by distance from the ground. A body's children are one column to its right, in
rows of their own; where the columns are used up, the tree goes on in a band below. No two bodies share a
place, and lines in the gaps between columns cross no body.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eom.errors import InputError
from eom.multibody.model.bodies import GROUND, Joint
from eom.multibody.model.constraints import Coupling
from eom.multibody.model.model import Constraint, Tree
from eom.views.draw.formulas import name, short
from eom.views.draw.picture import Axis, Curve, Item, Panel, Picture, Words, check

LETTERS = {
    "fixed": "0",
    "revolute": "R",
    "prismatic": "P",
    "cylindrical": "C",
    "helical": "H",
    "universal": "U",
    "planar": "E",
    "spherical": "S",
    "free": "6",
}
"""Letters of kinds of joints, as mechanisms have them: 0 and 6 count degrees of freedom."""
WIDEST = 180.0
"""Width of a diagram beyond which the tree goes on in a band below, in letters."""
LONGEST = 18
"""Letters of a name that are shown."""
INCH = 0.073
"""Width of a letter in inches; all lengths here are in letters."""
BOX, ROW, HALF, LANE = 3.2, 7.0, 4.0, 2.6
"""Height of a box, distance of rows, of rows whose boxes are in other columns, and of dashed lines."""
USUAL_HEIGHT = 3.6
"""Inches of a panel of height 1: what the height of a diagram is given in."""
ROUND = 1.5
"""Radius of the circle round the letter of a joint."""
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


def _cut(given: str) -> str:
    return given if len(given) <= LONGEST else given[: LONGEST - 1] + "…"


def _shown(given: str) -> str:
    """Return a name of a body or joint as it is spelt."""
    return short(_cut(given))


def _coordinates(joint: Joint) -> tuple[str, int]:
    """Return the names of a joint's coordinates, of many the first and the last; and their width."""
    if joint.motion is not None:
        return "given motion", 12
    names = [c.name for c in joint.coordinates]
    if len(names) > 3:
        return f"{name(names[0])}, …, {name(names[-1])}", sum(
            map(_width, (names[0], names[-1]))
        ) + 4
    return ", ".join(map(name, names)), sum(_width(n) + 2 for n in names)


def _width(given: str) -> int:
    """Return the width of a name with indices, which are smaller."""
    return len(given.replace("_", "")) * 4 // 5 + 1


@dataclass(frozen=True)
class _Bond:
    """A constraint or spring as a dashed line between two bodies."""

    words: str
    ends: tuple[str, str]


@dataclass(frozen=True)
class _Diagram:
    """Where everything is: a unit is the width of a letter, y grows upwards."""

    tree: Tree
    most: int
    """Columns at most."""

    @cached_property
    def children(self) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        for joint in self.tree.ordered:
            found.setdefault(joint.parent, []).append(joint.child)
        return found

    @cached_property
    def bonds(self) -> list[_Bond]:
        found = [b for c in self.tree.constraints if (b := _bond(c, self.tree)) is not None]
        return found + [_Bond(f"{_shown(s.name)}: spring", s.bodies) for s in self.tree.springs]

    @cached_property
    def cells(self) -> dict[str, Cell]:
        return cells(GROUND, self.children, self.most)

    @property
    def names(self) -> list[str]:
        return [GROUND, *(b.name for b in self.tree.bodies)]

    @staticmethod
    def _box_width(body: str) -> float:
        return len(_cut(body)) + 3.0

    @cached_property
    def columns(self) -> list[tuple[float, float, float]]:
        """Left ends of the gaps before the columns, left ends of the columns, and their widths."""
        count = 1 + max(c.column for c in self.cells.values())
        widths = [0.0] * count
        gaps = [0.0] * count
        for body, cell in self.cells.items():
            widths[cell.column] = max(widths[cell.column], self._box_width(body))
        for joint in self.tree.joints:
            column = self.cells[joint.child].column
            gaps[column] = max(gaps[column], _gap_of(joint))
        found, x = [], 0.0
        for width, gap in zip(widths, gaps, strict=True):
            found.append((x, x + gap, width))
            x += gap + width
        return found

    @property
    def right(self) -> float:
        _, x, width = self.columns[-1]
        return x + width

    @cached_property
    def lanes(self) -> list[int]:
        """For each bond the row below which it runs: the lower one of its ends."""
        return [max(self.cells[b].row for b in bond.ends) for bond in self.bonds]

    @cached_property
    def heights(self) -> list[float]:
        """The height of the middle of each row: lower where dashed lines run above it."""
        columns: dict[int, set[int]] = {}
        for cell in self.cells.values():
            columns.setdefault(cell.row, set()).add(cell.column)
        found, y = [], 0.0
        for row in range(len(columns)):
            found.append(y)
            apart = columns[row].isdisjoint(columns.get(row + 1, ())) and row not in self.ends
            y -= (HALF if apart else ROW) + LANE * self.lanes.count(row)
        return found

    @cached_property
    def ends(self) -> set[int]:
        """The last rows of bands: a line runs below them."""
        last: dict[int, int] = {}
        for cell in self.cells.values():
            last[cell.band] = max(cell.row, last.get(cell.band, 0))
        return set(last.values())

    def box(self, body: str) -> tuple[float, float, float, float]:
        """Return left, right, bottom and top of a body's box."""
        cell = self.cells[body]
        x, y = self.columns[cell.column][1], self.heights[cell.row]
        return x, x + self._box_width(body), y - BOX / 2, y + BOX / 2


def _gap_of(joint: Joint) -> float:
    """Return the width that a joint's line needs: to the letter's circle, and along the words."""
    return 7.5 + max(len(_cut(joint.name)), _coordinates(joint)[1])


def _bond(constraint: Constraint, tree: Tree) -> _Bond | None:
    """Return the two bodies that a constraint binds, or a body and the ground; None for equations."""
    bodies = constraint.bodies
    if isinstance(constraint, Coupling):
        child = {j.name: j.child for j in tree.joints}
        bodies = tuple(child[j] for j, _ in constraint.ratios)[:2]
    if not bodies:
        return None
    kind = getattr(constraint, "kind", type(constraint).__name__.lower())
    other = bodies[1] if len(bodies) > 1 else GROUND
    return _Bond(f"{_shown(constraint.name)}: {kind}", (bodies[0], other))


def joint_tree(tree: Tree, title: str = "") -> Picture:
    """Return the diagram of a tree: bodies as boxes, the ground hatched, joints as lines.

    Parameters
    ----------
    tree : Tree
        Of any kind; nothing is to scale, and there are no units.
    title : str, optional
        Above the picture.

    Returns
    -------
    Picture
        A joint has the letter of its kind in a circle, its name above and its coordinates below its
        line. Dashed lines are constraints, and springs between points. Long trees go on in bands
        below each other.

    Raises
    ------
    InputError
        For a tree without bodies.

    Examples
    --------
    >>> from eom.multibody import Body, Joint, Tree
    >>> rod = Body("rod", 2.0, centre=(0, 0, -0.5), inertia=(0.2, 0.2, 0))
    >>> pin = Joint("pin", "revolute", "ground", "rod", axis="y")
    >>> joint_tree(Tree("pendulum", bodies=[rod], joints=[pin])).caption
    'Joints: rod on ground by pin (revolute).'
    """
    if not tree.bodies:
        raise InputError("a tree without bodies", where=short(title) or tree.name)
    d = _widest(tree)
    words = short(title or tree.name)
    items = [
        *(item for body in d.names for item in _body(d, body)),
        *(item for joint in tree.ordered for item in _joint(d, joint)),
        *_bonds(d),
    ]
    low = d.heights[-1] - ROW / 2 - LANE * (d.lanes.count(len(d.heights) - 1) + 1)
    sides = 3.0 + 2.0 * len(_bands(d))
    least = 1.35 * max(len(words), len(_legend(d)))  # titles have larger letters
    room = max(sides, (least - d.right) / 2)
    limits = ((-room, d.right + room), (low, ROW / 2))
    axes = (Axis(limits=limits[0]), Axis(limits=limits[1]))
    size = (INCH * (limits[0][1] - limits[0][0]), INCH * (limits[1][1] - limits[1][0]) + 0.6)
    height = size[1] / USUAL_HEIGHT
    panel = Panel(tuple(items), axes, short(_legend(d)), equal=True, bare=True, height=height)
    return check(Picture(((panel,),), words, _caption(tree), size))


def _widest(tree: Tree) -> _Diagram:
    """Return the diagram with as many columns as there is room for; whole if few branches fit in bands."""
    whole = _Diagram(tree, len(tree.bodies) + 2)
    deepest = 1 + max(c.column for c in whole.cells.values())
    narrower = (_Diagram(tree, k) for k in range(deepest, 2, -1))
    found = next((d for d in narrower if d.right <= WIDEST), _Diagram(tree, 2))
    fewest = math.ceil(deepest / (found.most - 1))
    bands = 1 + max(c.band for c in found.cells.values())
    return found if bands <= max(2, fewest) else whole


def _legend(d: _Diagram) -> str:
    kinds = dict.fromkeys(j.kind for j in d.tree.ordered)
    words = [f"{LETTERS[k]} {k}" for k in kinds] + ["dashed: constraint or spring"] * bool(d.bonds)
    return ",  ".join(words)


def _caption(tree: Tree) -> str:
    joints = "; ".join(f"{j.child} on {j.parent} by {j.name} ({j.kind})" for j in tree.ordered[:40])
    more = f"; {len(tree.joints) - 40} more" if len(tree.joints) > 40 else ""
    held = ", ".join(c.name for c in tree.constraints)
    return f"Joints: {joints}{more}." + (f" Constraints: {held}." if held else "")


def _line(*corners: tuple[float, float], dashed: bool = False, width: float = 1.0) -> Curve:
    dash, colour = ("dashed", "red") if dashed else ("solid", "black")
    return Curve(np.array(corners, dtype=np.float64), colour, width, dash)  # type: ignore[arg-type]


def _words(x: float, y: float, text: str, colour: str = "black") -> Words:
    return Words(np.array([x, y]), text, colour)


def _body(d: _Diagram, body: str) -> Iterator[Item]:
    x1, x2, y1, y2 = d.box(body)
    yield _line((x1, y1), (x2, y1), (x2, y2), (x1, y2), (x1, y1), width=1.4)
    yield _words((x1 + x2) / 2, (y1 + y2) / 2, _shown(body))
    rotors = [r.name for r in d.tree.rotors if r.body == body]
    if rotors:
        yield _words((x1 + x2) / 2, y2 + 1.2, "rotors " + ", ".join(map(_shown, rotors)), "green")
    if body == GROUND:
        for x in np.arange(x1 + 0.8, x2 + 0.1, 1.2):
            yield _line((x, y1), (x - 0.8, y1 - 1.0), width=0.8)


def _joint(d: _Diagram, joint: Joint) -> Iterator[Item]:
    _, x1, low, high = d.box(joint.parent)
    x2, _, bottom, top = d.box(joint.child)
    y1, y2 = (low + high) / 2, (bottom + top) / 2
    parent, child = d.cells[joint.parent], d.cells[joint.child]
    circle = d.columns[child.column][0] + 2.2 + ROUND
    if parent.band == child.band:
        turn = d.columns[parent.column + 1][0] + 1.0
        corners = [(x1, y1), (turn, y1), (turn, y2)]
    else:
        corners = _around(d, joint, (x1, y1), y2)
    yield _line(*corners, (circle - ROUND, y2))
    yield _line((circle + ROUND, y2), (x2, y2))
    around = np.linspace(0, 2 * np.pi, 33)
    ring = np.stack([circle + ROUND * np.cos(around), y2 + ROUND * np.sin(around)], axis=-1)
    yield Curve(ring, "blue", 1.2)
    yield _words(circle, y2, f"$\\mathbf{{{LETTERS[joint.kind]}}}$", "blue")
    middle = (circle + ROUND + x2) / 2
    yield _words(middle, y2 + 1.4, _shown(joint.name))
    if joint.coordinates:
        yield _words(middle, y2 - 1.4, _coordinates(joint)[0], "grey")


def _bands(d: _Diagram) -> list[str]:
    """Return the bodies that begin a band."""
    return [j.child for j in d.tree.ordered if d.cells[j.child].band != d.cells[j.parent].band]


def _around(
    d: _Diagram, joint: Joint, start: tuple[float, float], y: float
) -> list[tuple[float, float]]:
    """Return the way from the right end of a band to the left end of another."""
    k = _bands(d).index(joint.child) + 1
    right, left = d.right + 2.0 * k, -2.0 * k
    first = min(c.row for c in d.cells.values() if c.band == d.cells[joint.child].band)
    above = d.heights[first] + ROW / 2 + 0.3
    return [start, (right, start[1]), (right, above), (left, above), (left, y)]


def _bonds(d: _Diagram) -> Iterator[Item]:
    """Yield dashed lines: down from a box, along below its row, beside columns, up to the other box."""
    used: dict[int, int] = {}
    for k, (bond, row) in enumerate(zip(d.bonds, d.lanes, strict=True)):
        used[row] = used.get(row, 0) + 1
        y = d.heights[row] - ROW / 2 - LANE * (used[row] - 0.5)
        ends = sorted(bond.ends, key=lambda b: d.box(b)[0])
        ways = [_down(d, body, row, y, k, side) for body, side in zip(ends, (1, -1), strict=True)]
        yield _line(*ways[0], *reversed(ways[1]), dashed=True, width=1.3)
        x = (ways[0][-1][0] + ways[1][-1][0]) / 2
        yield _words(x, y - 1.3, short(bond.words), "red")


def _down(
    d: _Diagram, body: str, row: int, y: float, number: int, side: int
) -> Sequence[tuple[float, float]]:
    """Return the way from a box down to a height: from its bottom, or beside what is below it."""
    x1, x2, low, high = d.box(body)
    if d.cells[body].row == row:
        x = (x1 + x2) / 2 + side * (1.0 + 0.8 * number % 3)
        return [(x, low), (x, y)]
    _, x, width = d.columns[d.cells[body].column]
    beside = x + width + 0.6 + 0.5 * (number % 3)
    middle = (low + high) / 2 - 0.8
    return [(x2, middle), (beside, middle), (beside, y)]
