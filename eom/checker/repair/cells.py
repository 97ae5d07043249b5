"""Which cells of a table may be at fault: those whose components differ, or do not fit the others.

A slip in one cell of a matrix changes that component alone. So edits elsewhere in the table need not be
tried; a table of nine sums has thousands.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from eom.checker.mean.values import Value
from eom.checker.read.paths import Path, at
from eom.checker.read.syntax import Boxed, Braced, Group, Integral, Matrix, Node, Product, Scripts
from eom.checker.repair.lines import Addend, Line, Member, Place, signature, valued
from eom.fields import PRIME
from eom.terms.terms import MATRIX, SCALAR

Cell = tuple[int, int]
_Difference = Callable[[Place, Member, Member], "tuple[Node, list[int]] | None"]

_BODIES: Mapping[type[Node], str] = {
    Boxed: "body",
    Braced: "body",
    Group: "body",
    Integral: "integrand",
    Scripts: "base",
}
"""What may stand around a table without moving its cells, and the field that holds the table."""


@dataclass(frozen=True)
class Suspects:
    """Where a table stands in a term, and its cells that may be at fault."""

    path: Path
    cells: frozenset[Cell]

    def spares(self, path: Path) -> bool:
        """Tell whether a place lies in a cell that is not at fault."""
        n = len(self.path)
        if path[:n] != self.path or len(path) <= n:
            return False
        name, numbers = path[n]
        return name == "rows" and numbers not in self.cells


@dataclass(frozen=True)
class _Table:
    """A table within a term; ``whole``: whether its cells are the components, not its rows alone."""

    path: Path
    node: Matrix
    whole: bool

    @property
    def cells(self) -> list[Cell]:
        return [(r, c) for r, row in enumerate(self.node.rows) for c in range(len(row))]


def _table(line: Line, root: Node) -> _Table | None:
    """Return the table on which the components of a term depend cell by cell, or row by row."""
    path: Path = ()
    whole = True
    while True:
        here = at(root, path)
        if isinstance(here, Matrix):
            return _Table(path, here, whole)
        if isinstance(here, Product) and not here.operator:
            tables = [k for k, f in enumerate(here.factors) if not _is_scalar(line, f)]
            if not tables:
                return None
            whole = whole and len(tables) == 1
            path = (*path, ("factors", (tables[0],)))
        elif type(here) in _BODIES and not (isinstance(here, Scripts) and here.sup is not None):
            path = (*path, (_BODIES[type(here)], ()))
        else:
            return None


def _is_scalar(line: Line, node: Node) -> bool:
    value = valued(line.elaborator, node)
    return value is not None and value.shape == SCALAR


def suspects(
    line: Line,
    values: Mapping[Addend, Value | None],
    differences: Iterable[Mapping[tuple[int, int], list[int]]],
) -> dict[Addend, Suspects]:
    """Return the cells that may be at fault, by terms that have a table.

    ``differences``: in several worlds, what members differ by, by components, for pairs of members.
    """
    differing = list(differences)
    found = {}
    for member in line.members:
        for addend in member.addends:
            table = _table(line, addend.node)
            if table is None:
                continue
            own = values.get(addend)
            size = 9 if own is not None and own.shape == MATRIX else 3
            wrong = _unlike(line, table) if own is None else _least(table, size, member, differing)
            if wrong and len(wrong) < len(table.cells):
                found[addend] = Suspects(table.path, wrong)
    return found


def _unlike(line: Line, table: _Table) -> frozenset[Cell]:
    """Return the cells that have no value, or another dimension than most."""
    kinds = {}
    for r, c in table.cells:
        value = valued(line.elaborator, table.node.rows[r][c])
        kinds[(r, c)] = (value is not None, None if value is None else signature(value))
    counted = Counter(k for k in kinds.values() if k[0] and k[1] is not None)
    if not counted:
        return frozenset()
    usual = counted.most_common(1)[0][0]
    return frozenset(c for c, k in kinds.items() if k not in (usual, (True, None)))


def _least(
    table: _Table, size: int, member: Member, differing: list[Mapping[tuple[int, int], list[int]]]
) -> frozenset[Cell]:
    """Return the fewest cells that differ from another member in a world where any do."""
    sets = [
        frozenset(_at_fault(table, size, numbers))
        for world in differing
        for pair, numbers in world.items()
        if member.number in pair
    ]
    return min((s for s in sets if s), key=len, default=frozenset())


def _at_fault(table: _Table, size: int, numbers: list[int]) -> Iterator[Cell]:
    """Yield the cells whose components differ; there are ``size`` of them for each numbering."""
    wrong = {k % size for k, n in enumerate(numbers) if n % PRIME}
    cells, rows = table.cells, len(table.node.rows)
    if table.whole and size == len(cells):
        yield from (cells[k] for k in sorted(wrong))
    elif size % rows == 0 and not table.whole:
        width = size // rows
        bad = {k // width for k in wrong}
        yield from (c for c in cells if c[0] in bad)


def by_components(
    place: Place, members: Iterable[Member], difference: _Difference
) -> dict[tuple[int, int], list[int]]:
    """Return what members differ by in a world, component by component, for pairs of them."""
    found = {}
    listed = list(members)
    for k, a in enumerate(listed):
        for b in listed[k + 1 :]:
            both = difference(place, a, b)
            if both is not None:
                found[(a.number, b.number)] = both[1]
    return found
