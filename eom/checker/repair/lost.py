"""Terms that a line has lost: its residual fitted by products of its own factors, whole or by entries."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from eom.checker.mean.values import Value
from eom.checker.read.paths import NOTHING, Path, at, operands, places, put
from eom.checker.read.syntax import Addition, Matrix, Node, Number
from eom.checker.read.writing import latex
from eom.checker.repair.lines import (
    Addend,
    Line,
    Member,
    Place,
    Signature,
    agrees,
    signature,
    valued,
    worth,
)
from eom.checker.repair.options import Option
from eom.checker.repair.residual import Item, Piece, fits, items, scaled, total
from eom.checker.repair.slips import LOST
from eom.fields import PRIME


@dataclass
class Pools:
    """Products of the factors of a line by signature, made once.

    ``near``: symbols that stand around the line, factors as well where ``wide``; ``known``:
    gives what is left over where that is known without a search.
    """

    line: Line
    values: Mapping[Addend, Value | None]
    near: tuple[Node, ...] = ()
    known: Callable[[], Sequence[Node]] = tuple
    wide: bool = False
    made: dict[tuple[tuple[Node, ...], Signature], list[Item]] = field(default_factory=dict)

    def pool(self, roots: Sequence[Node], kind: Signature) -> list[Item]:
        """Return products of the factors below some nodes, but for what stands in the line as a term."""
        key = (tuple(roots), kind)
        if key not in self.made:
            standing = {i.term for i in self.own(kind)}
            made = list(self._known(kind)) if self.left else items(self.line, roots, kind)
            self.made[key] = [i for i in made if i.term not in standing]
        return self.made[key]

    def widened(self) -> Pools:
        """Return pools with the symbols around the line as factors as well."""
        return replace(self, wide=True, made={})

    @cached_property
    def left(self) -> Sequence[Node]:
        """What is known to be left over, whole and term by term; none where it must be looked for."""
        return self.known()

    def _known(self, kind: Signature) -> Iterator[Item]:
        for node in self.left:
            value = valued(self.line.elaborator, node)
            if value is not None and not value.is_zero and agrees(signature(value), kind):
                yield Item(node, value.term, kind)

    def own(self, kind: Signature) -> list[Item]:
        """Return the terms of the line."""
        return [
            Item(a.node, v.term, kind)
            for a, v in self.values.items()
            if v is not None and not v.is_zero and agrees(signature(v), kind)
        ]

    @property
    def roots(self) -> list[Node]:
        """The members that stand in the line."""
        own = [at(self.line.tree, m.path) for m in self.line.members if m.path is not None]
        return [*own, *self.near] if self.wide else own


def weight(pieces: Sequence[Piece]) -> float:
    """Return how implausible it is that these terms were lost together."""
    found = LOST.weight + 0.7 * (len(pieces) - 1)
    for piece in pieces:
        factors = sum(1 for _ in places(piece.item.node))
        found += 0.05 * factors + (0.2 if abs(piece.coefficient) != 1 else 0.0)
    return found


def lost_terms(
    pools: Pools, place: Place, member: Member, kind: Signature, need: int
) -> Iterator[Option]:
    """Yield terms that a member needs so that its number grows by ``need``."""
    if member.path is None or not member.addends:
        return
    for pieces in fits(place, pools.pool(pools.roots, kind), need):
        parts = [scaled(p) for p in pieces]
        sign = -1 if parts[0][0] == "-" else 1
        node = total([replace(p, coefficient=p.coefficient * sign) for p in pieces])
        value = worth(pools.line, node)
        if value is not None:
            addend = replace(member.addends[-1], sign=sign, node=NOTHING)
            kept = (LOST, weight(pieces), NOTHING, node, node, sign, value.term, signature(value))
            yield Option(addend, *kept)


# -- by entries ------------------------------------------------------------------------------------


def entry_terms(
    pools: Pools, place: Place, addend: Addend, need: Sequence[int]
) -> Iterator[Option]:
    """Yield a table of entries with terms added where its entries need some.

    ``need``: by how much its components must grow, one for each entry.
    """
    found = _table(addend.node)
    if found is None:
        return
    path, table = found
    cells = [(r, c) for r, row in enumerate(table.rows) for c in range(len(row))]
    if len(cells) != len(need):
        return
    tree: Node = table
    cost, changed = 0.0, dict[tuple[int, int], str]()
    for cell, wanted in zip(cells, need, strict=True):
        if wanted % PRIME == 0:
            continue
        pieces = _entry(pools, place, table, cell, wanted)
        if pieces is None:
            return
        tree = put(tree, (("rows", cell),), _added(table.rows[cell[0]][cell[1]], pieces))
        changed[cell] = " ".join(f"{s} {latex(n)}" for s, n in map(scaled, pieces))
        cost += weight(pieces)
    node = put(addend.node, path, tree)
    value = worth(pools.line, node)
    if value is not None and changed:
        inside: Path = (("rows", next(iter(changed))),) if len(changed) == 1 else ()
        old, new = at(table, inside), at(tree, inside)
        kept = (LOST, cost, old, new, node, addend.sign, value.term, signature(value))
        yield Option(addend, *kept, paths=((*path, *inside),), added=tuple(changed.items()))


def entry_residual(pools: Pools, place: Place, node: Node, numbers: Sequence[int]) -> Node | None:
    """Return a table of what entries have too much, by factors of the same entries; None for none."""
    found = _table(node)
    if found is None:
        return None
    _, table = found
    cells = [(r, c) for r, row in enumerate(table.rows) for c in range(len(row))]
    if len(cells) != len(numbers):
        return None
    tree: Node = table
    for cell, number in zip(cells, numbers, strict=True):
        pieces = _entry(pools, place, table, cell, number) if number % PRIME else ()
        if pieces is None:
            return None
        tree = put(tree, (("rows", cell),), total(pieces) if pieces else Number("0"))
    return tree


def _table(node: Node) -> tuple[Path, Matrix] | None:
    for path, here in places(node):
        if isinstance(here, Matrix) and sum(map(len, here.rows)) in {3, 9}:
            return path, here
    return None


def _entry(
    pools: Pools, place: Place, table: Matrix, cell: tuple[int, int], wanted: int
) -> tuple[Piece, ...] | None:
    """Return what an entry lacks, by its own factors, then by those of all entries."""
    kinds = [signature(v) for _, n in operands(table) for v in [_value(pools, n)] if v is not None]
    own = _value(pools, table.rows[cell[0]][cell[1]])
    kind = (signature(own) if own is not None else None) or next((k for k in kinds if k), None)
    if kind is None:
        return None
    for roots in ([table.rows[cell[0]][cell[1]]], [table]):
        for pieces in fits(_Single(place), pools.pool(roots, kind), wanted):  # type: ignore[arg-type]
            return pieces
    return None


def _value(pools: Pools, node: Node) -> Value | None:
    return worth(pools.line, node)


@dataclass(frozen=True)
class _Single:
    """A world in which a scalar is its own number, without weight."""

    place: Place

    def number(self, term: object) -> int | None:
        """Return the value of a scalar."""
        values = self.place.values(term)  # type: ignore[arg-type]
        return values[0] if values and len(values) == 1 else None


def _added(cell: Node, pieces: Sequence[Piece]) -> Node:
    parts = [scaled(p) for p in pieces]
    own = (cell.terms, cell.signs) if isinstance(cell, Addition) else ((cell,), ("",))
    if cell == Number("0"):
        own = ((), ())
    return Addition(
        (*own[0], *(n for _, n in parts)), (*own[1], *(s for s, _ in parts)), span=cell.span
    )
