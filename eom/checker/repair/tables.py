"""Tables: which cells may be at fault, and each of them mended by itself.

Cells whose components differ, or do not fit the others, may be at fault. A slip in one cell of a matrix
changes that component alone: what each cell should be is known from the other member, and slips are
undone in each of them apart, however many there are; a table of nine sums has thousands.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from eom.checker.judge.models import Drawn
from eom.checker.mean.values import Value
from eom.checker.read.paths import Path, at, operands, put, set_down
from eom.checker.read.syntax import (
    Addition,
    Boxed,
    Braced,
    Group,
    Integral,
    Matrix,
    Node,
    Number,
    Product,
    Scripts,
)
from eom.checker.read.writing import latex
from eom.checker.repair.lines import Addend, Line, Member, Palette, signature, valued, worth
from eom.checker.repair.residual import Piece, Pools, fits, scaled, total, weight
from eom.checker.repair.slips import ALL_OVER, LOST, Change, Option, Slip, edits
from eom.fields import PRIME, RESIDUES
from eom.terms.terms import MATRIX, SCALAR

Cell = tuple[int, int]

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
        """Return whether a place lies in a cell that is not at fault."""
        n = len(self.path)
        if path[:n] != self.path or len(path) <= n:
            return False
        name, numbers = path[n]
        return name == "rows" and numbers not in self.cells


@dataclass(frozen=True)
class Table:
    """A table within a term; ``whole``: whether its cells are the components, not its rows alone."""

    path: Path
    node: Matrix
    whole: bool

    @property
    def cells(self) -> list[Cell]:
        """Its cells, row by row."""
        return [(r, c) for r, row in enumerate(self.node.rows) for c in range(len(row))]


def table_in(line: Line, root: Node) -> Table | None:
    """Return the table on which the components of a term depend cell by cell, or row by row."""
    path: Path = ()
    whole = True
    while True:
        here = at(root, path)
        if isinstance(here, Matrix):
            return Table(path, here, whole)
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
    apart: Collection[Addend] = (),
) -> dict[Addend, Suspects]:
    """Return the cells that may be at fault, by terms that have a table.

    ``differences``: in several worlds, what members differ by, by components, for pairs of members;
    ``apart``: terms whose cells are mended by themselves.
    """
    differing = list(differences)
    found = {}
    for member in line.members:
        for addend in member.addends:
            table = table_in(line, addend.node)
            if table is None:
                continue
            own = values.get(addend)
            size = 9 if own is not None and own.shape == MATRIX else 3
            wrong = _unlike(line, table) if own is None else _least(table, size, member, differing)
            cells = frozenset[Cell]() if addend in apart else wrong
            if wrong and len(cells) < len(table.cells):
                found[addend] = Suspects(table.path, cells)
    return found


def _unlike(line: Line, table: Table) -> frozenset[Cell]:
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
    table: Table, size: int, member: Member, differing: list[Mapping[tuple[int, int], list[int]]]
) -> frozenset[Cell]:
    """Return the fewest cells that differ from another member in a world where any do."""
    sets = [
        frozenset(_at_fault(table, size, numbers))
        for world in differing
        for pair, numbers in world.items()
        if member.number in pair
    ]
    return min((s for s in sets if s), key=len, default=frozenset())


def _at_fault(table: Table, size: int, numbers: list[int]) -> Iterator[Cell]:
    """Yield the cells whose components differ; there are ``size`` of them for each numbering."""
    wrong = {k % size for k, n in enumerate(numbers) if n % PRIME}
    cells, rows = table.cells, len(table.node.rows)
    if table.whole and size == len(cells):
        yield from (cells[k] for k in sorted(wrong))
    elif size % rows == 0 and not table.whole:
        width = size // rows
        bad = {k // width for k in wrong}
        yield from (c for c in cells if c[0] in bad)


# -- by cells --------------------------------------------------------------------------------------

CELL = Slip("entry", "entries of a table exchanged", 1.0, lambda _, __: (), uniform=True)
TURNED = Slip("sign", "a sign", 1.0, lambda _, __: (), uniform=True)
FEW = 4
"""Cells at fault at most in which more is tried than a sign and what other cells hold."""

Offer = tuple[float, Change, Node]
"""What a cell may have been meant to be: its weight, the slip, the cell."""


@dataclass(frozen=True)
class Cells:
    """A table whose cells are components of a term but for a factor, with their numbers in a model."""

    table: Table
    numbers: Mapping[Cell, int]
    factor: int


def by_cells(line: Line, model: Drawn, addend: Addend, value: Value | None) -> Cells | None:
    """Return the table of a term whose components are its cells times one number; None for none."""
    table = table_in(line, addend.node) if value is not None else None
    if table is None or value is None or not table.whole:
        return None
    components = model.values(value.term)
    numbers = {}
    for row, column in table.cells:
        cell = worth(line, table.node.rows[row][column])
        numbers[row, column] = None if cell is None else model.scalar(cell.term)
    known = {c: n for c, n in numbers.items() if n is not None}
    if components is None or len(components) != len(known) or len(known) != len(numbers):
        return None
    pairs = list(zip(known.values(), components, strict=True))
    factor = next((k * RESIDUES.inverse(n) for n, k in pairs if n % PRIME and k % PRIME), 1)
    if any((n * factor - k) % PRIME for n, k in pairs):
        return None
    return Cells(table, known, factor % PRIME)


def mended(
    pools: Pools, model: Drawn, addend: Addend, need: Sequence[int], have: Palette
) -> Iterator[Option]:
    """Yield a term with its table mended, cell by cell.

    ``need``: by how much its components must grow, one for each cell.
    """
    found = by_cells(pools.line, model, addend, pools.values.get(addend))
    if found is None or len(found.numbers) != len(need):
        return
    inverse = RESIDUES.inverse(found.factor)
    pairs = zip(found.numbers.items(), need, strict=True)
    wanted = {c: (n + more * inverse) % PRIME for (c, n), more in pairs if more % PRIME}
    offers = [_offers(pools, model, found, cell, wanted, have) for cell in wanted]
    if all(offers) and offers:
        for chosen in _together(offers):
            yield from _option(pools, addend, found.table, dict(zip(wanted, chosen, strict=True)))


def _offers(
    pools: Pools,
    model: Drawn,
    found: Cells,
    cell: Cell,
    wanted: Mapping[Cell, int],
    have: Palette,
) -> list[Offer]:
    """Return what a cell may have been meant to be, one of each kind of slip, the likeliest first."""
    number = wanted[cell]
    kinds: dict[str, Offer] = {}
    for weight_, change, new in _cheap(found, cell, number):
        kinds.setdefault(change.slip.name, (weight_, change, new))
    for way in (_undone((False,)), _lost, _undone((True,))):
        if not kinds and (len(wanted) <= FEW or way is _lost):
            for offer in way(pools, model, found, cell, number, have):
                kinds.setdefault(offer[1].slip.name, offer)
    return sorted(kinds.values(), key=lambda o: o[0])


_Try = Callable[[Pools, Drawn, Cells, Cell, int, Palette], Iterator[Offer]]


def _undone(kinds: tuple[bool, ...]) -> _Try:
    """Return what yields a cell with a slip undone."""

    def offers(
        pools: Pools, model: Drawn, found: Cells, cell: Cell, number: int, have: Palette
    ) -> Iterator[Offer]:
        for edit in edits(at(found.table.node, (("rows", cell),)), have, kinds=kinds):
            value = worth(pools.line, edit.tree)
            if value is not None and model.scalar(value.term) == number:
                yield edit.weight, edit.first, edit.tree

    return offers


def _lost(
    pools: Pools, model: Drawn, found: Cells, cell: Cell, number: int, _: Palette
) -> Iterator[Offer]:
    """Yield a cell with the terms added that it lacks."""
    pieces = _entry(pools, model, found.table.node, cell, number - found.numbers[cell])
    if pieces is not None:
        old = at(found.table.node, (("rows", cell),))
        new = _added(old, pieces)
        text = " ".join(f"{s} {latex(n)}" for s, n in map(scaled, pieces))
        yield weight(pieces), Change(LOST, old, new, added=text), new


def _cheap(found: Cells, cell: Cell, number: int) -> Iterator[Offer]:
    """Yield the cell with its sign turned, and what other cells hold."""
    old = at(found.table.node, (("rows", cell),))
    if (found.numbers[cell] + number) % PRIME == 0:
        new = _negative(old)
        yield TURNED.weight, Change(TURNED, old, new), new
    for other, held in found.numbers.items():
        if held % PRIME == number and other != cell:
            new = at(found.table.node, (("rows", other),))
            yield CELL.weight, Change(CELL, old, new), new


def _negative(node: Node) -> Node:
    if isinstance(node, Addition):
        if len(node.terms) == 1 and node.signs == ("-",):
            return node.terms[0]
        turned = ["-" if s in {"", "+"} else "+" if k else "" for k, s in enumerate(node.signs)]
        return replace(node, signs=tuple(turned))
    return Addition((node,), ("-",), span=node.span)


def _together(offers: Sequence[Sequence[Offer]]) -> Iterator[tuple[Offer, ...]]:
    """Yield the likeliest slips of all cells, then, for each kind, as many as can be of that."""
    yield tuple(row[0] for row in offers)
    names = dict.fromkeys(o[1].slip.name for row in offers for o in row)
    for name in names:
        yield tuple(next((o for o in row if o[1].slip.name == name), row[0]) for row in offers)


def _option(
    pools: Pools, addend: Addend, table: Table, chosen: Mapping[Cell, Offer]
) -> Iterator[Option]:
    tree: Node = table.node
    cost, seen = 0.0, set[str]()
    changes = []
    for cell, (weight_, change, new) in chosen.items():
        base = (*table.path, ("rows", cell))
        tree = set_down(tree, (("rows", cell),), new)
        changes.append(replace(change, paths=tuple((*base, *p) for p in change.paths)))
        cost += weight_ * (ALL_OVER if change.slip.name in seen else 1.0)
        seen.add(change.slip.name)
    node = put(addend.node, table.path, tree)
    value = worth(pools.line, node)
    if value is not None:
        own = (value.term, signature(value))
        yield Option(addend, cost, node, addend.sign, tuple(changes), *own)


def entry_residual(pools: Pools, model: Drawn, node: Node, numbers: Sequence[int]) -> Node | None:
    """Return a table of what entries have too much, by factors of the same entries; None for none."""
    table = table_in(pools.line, node)
    if table is None or len(table.cells) != len(numbers):
        return None
    tree: Node = table.node
    for cell, number in zip(table.cells, numbers, strict=True):
        pieces = _entry(pools, model, table.node, cell, number) if number % PRIME else ()
        if pieces is None:
            return None
        tree = put(tree, (("rows", cell),), total(pieces) if pieces else Number("0"))
    return tree


def _entry(
    pools: Pools, model: Drawn, table: Matrix, cell: Cell, wanted: int
) -> tuple[Piece, ...] | None:
    """Return what an entry lacks, by its own factors, then by those of all entries."""
    values = (worth(pools.line, n) for _, n in operands(table))
    kinds = [signature(v) for v in values if v is not None]
    own = worth(pools.line, table.rows[cell[0]][cell[1]])
    kind = (signature(own) if own is not None else None) or next((k for k in kinds if k), None)
    if kind is None:
        return None
    for roots in ([table.rows[cell[0]][cell[1]]], [table]):
        for pieces in fits(model.scalar, pools.pool(roots, kind), wanted):
            return pieces
    return None


def _added(cell: Node, pieces: Sequence[Piece]) -> Node:
    parts = [scaled(p) for p in pieces]
    own = (cell.terms, cell.signs) if isinstance(cell, Addition) else ((cell,), ("",))
    if cell == Number("0"):
        own = ((), ())
    terms, signs = (*own[0], *(n for _, n in parts)), (*own[1], *(s for s, _ in parts))
    return Addition(terms, signs, span=cell.span)
