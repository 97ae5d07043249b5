"""Repairs of a wrong line that hold in a world: one slip undone, or a few in different terms.

What a slip in one term does to the residual does not depend on the other terms, so that pairs of slips
are found by looking up numbers (meet in the middle), and three or four of one kind as well.

What may stand for a term of a line, with its value; what is left over of two members that disagree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from heapq import nsmallest
from itertools import combinations, count, islice
from typing import Generic, TypeVar

from eom.checker.judge.models import Drawn
from eom.checker.mean.claims import CONSTANT, STATEMENT
from eom.checker.mean.values import GEOMETRIC, Value, components
from eom.checker.read.paths import NOTHING, Path, at, disjoint, put, set_down
from eom.checker.read.syntax import Addition, Missing, Node, walk
from eom.checker.read.writing import latex
from eom.checker.repair.lines import (
    Addend,
    Line,
    Member,
    Palette,
    Signature,
    agrees,
    alike,
    signature,
    valued,
    worth,
)
from eom.checker.repair.residual import (
    Piece,
    Pools,
    fits,
    lost_terms,
    numbered,
    remains,
    rescaled,
    times,
    total,
)
from eom.checker.repair.slips import (
    ALL_OVER,
    DROPPED,
    FACTOR,
    FORGOTTEN,
    TERM,
    Change,
    Edit,
    Option,
    Slip,
    dotted,
    edits,
)
from eom.checker.repair.tables import Suspects, entry_residual, mended, table_in
from eom.fields import PRIME, RESIDUES
from eom.terms.terms import COLUMN, MATRIX, SCALAR, Term

SUBJECT = 0.15
"""What it weighs more to change what a line is about: the slip is rather on the other side."""
MOST = 200
"""Numerator and denominator of another number before a term at most."""


def options(
    line: Line, addend: Addend, palette: Palette, spared: Callable[[Path], bool] = lambda _: False
) -> list[Option]:
    """Return what may stand for a term and has a value, the most plausible first.

    Other symbols of the note are not tried in it. ``spared``: whether a place lies in a cell of a table
    that is not at fault.
    """
    found = []
    value = worth(line, addend.node)
    member = next(m for m in line.members if m.number == addend.member)
    if value is not None:
        own = (value.term, signature(value))
        found.append(_option(addend, TERM, addend.node, -addend.sign, *own))
    if len(member.addends) > 1:
        found.append(_option(addend, DROPPED, NOTHING, addend.sign))
    found += _valued(line, addend, value, edits(addend.node, palette, spared, (False,)))
    subject = len(member.addends) == 1 and member is line.members[0]
    more = SUBJECT if subject else 0.0
    return sorted((replace(o, weight=o.weight + more) for o in found), key=lambda o: o.weight)


def symbol_options(
    line: Line, addend: Addend, palette: Palette, spared: Callable[[Path], bool]
) -> list[Option]:
    """Return what may stand for a term if symbols of the note were lost in it or exchanged."""
    found = edits(addend.node, palette, spared, (True,))
    return list(_valued(line, addend, worth(line, addend.node), found))


def double_options(line: Line, addend: Addend, palette: Palette) -> list[Option]:
    """Return what may stand for a term if there are two slips in it, neither of which changes nothing."""
    value = worth(line, addend.node)
    alone = edits(addend.node, palette, kinds=(False,))
    single = [e for e in alone if not alike(value, worth(line, e.tree))]
    return list(_valued(line, addend, value, doubles(addend.node, single)))


def _valued(
    line: Line, addend: Addend, value: Value | None, found: Iterable[Edit]
) -> Iterator[Option]:
    """Yield those edits of a term that have a value other than its own."""
    for edit in found:
        new = worth(line, edit.tree)
        if new is not None and not alike(value, new):
            yield _edited(addend, edit, new)


def _option(
    addend: Addend,
    slip: Slip,
    new: Node,
    sign: int,
    term: Term | None = None,
    kind: Signature | None = None,
) -> Option:
    return Option(addend, slip.weight, new, sign, (Change(slip, addend.node, new),), term, kind)


def _edited(addend: Addend, edit: Edit, value: Value) -> Option:
    own = (value.term, signature(value))
    return Option(addend, edit.weight, edit.tree, addend.sign, edit.changes, *own)


Row = TypeVar("Row")

LETTERS = frozenset({"symbol", "index"})
MANY = 40
"""Repairs of one line that are kept at most in one world."""


@dataclass(frozen=True)
class Candidate:
    """Options for some terms of a line, and how implausible they are together."""

    options: tuple[Option, ...]
    weight: float


@dataclass(frozen=True)
class _Group:
    """A term with what may stand for it; ``value`` None where the term itself does not fit."""

    value: int | None
    offers: tuple[tuple[int, Option], ...]


# -- the search ----------------------------------------------------------------------------------


class Remembered(Generic[Row]):
    """Rows that are made when they are asked for, once."""

    def __init__(self, rows: Iterable[Row]) -> None:
        """Take the rows."""
        self._rest, self._known = iter(rows), list[Row]()

    def __iter__(self) -> Iterator[Row]:
        """Yield all rows, from the first one."""
        for k in count():
            if k == len(self._known):
                self._known += islice(self._rest, 1)
            if k == len(self._known):
                return
            yield self._known[k]


@dataclass
class Workshop:
    """A line with its options; ``values``: of its terms as they stand, None where there is none.

    ``suspects``: the cells of tables that may be at fault; ``levels``: models without more than is given,
    and one of each level.
    """

    line: Line
    offers: Mapping[Addend, Sequence[Option]]
    values: Mapping[Addend, Value | None]
    pools: Pools
    palette: Palette = field(default_factory=Palette)
    suspects: Mapping[Addend, Suspects] = field(default_factory=dict)
    levels: Iterable[tuple[Drawn, Drawn]] = ()

    def candidates(self, model: Drawn) -> list[Candidate]:
        """Return repairs after which all members agree in a world."""
        members = self.line.members
        if len(members) == 2:
            return self._both(model)
        found: list[Candidate] = []
        for reference in members:
            found += self._against(model, reference)
        return _best(found)

    def _both(self, model: Drawn) -> list[Candidate]:
        left, right = self.line.members
        found: list[Candidate] = []
        for a, b in ((left, right), (right, left)):
            found += self._entries(model, a, b)
        for kind in self._kinds(self.line.members):
            target = 0
            groups: list[_Group] = []
            for member, side in ((left, 1), (right, -1)):
                if member.value is not None:
                    target -= side * (model.number(member.value.term) or 0)
                groups += self._groups(model, member, kind, side)
            found += _combined(groups, target % PRIME)
            need = (target - sum(g.value or 0 for g in groups)) % PRIME
            if all(g.value is not None for g in groups):
                found += self._lost(model, kind, need)
            found += self._grown(model, groups, need)
        return _best(found)

    def _grown(self, model: Drawn, groups: Sequence[_Group], need: int) -> Iterator[Candidate]:
        """Yield terms times another factor; one that does not fit the others has to be that."""
        left, right = self.line.members
        rows = [(side, a) for m, side in ((left, 1), (right, -1)) for a in m.addends]
        must = [k for k, g in enumerate(groups) if g.value is None]
        for k in must if len(must) == 1 else [] if must else range(len(groups)):
            side, addend = rows[k]
            wanted = side * addend.sign * ((groups[k].value or 0) + need)
            yield from self._rescaled(model, addend, wanted)

    def _lost(self, model: Drawn, kind: Signature, need: int) -> Iterator[Candidate]:
        """Yield lost terms of one of two members; ``need``: of the left less the right side."""
        left, right = self.line.members
        member, side = (right, -1) if right.path is not None else (left, 1)
        if self.is_zero(right) and left.path is not None:
            member, side = left, 1
        yield from self._lost_in(model, member, kind, side * need % PRIME)

    def _lost_in(
        self, model: Drawn, member: Member, kind: Signature, need: int
    ) -> Iterator[Candidate]:
        if need:
            for option in lost_terms(self.pools, model, member, kind, need):
                yield Candidate((option,), option.weight)

    def _rescaled(self, model: Drawn, addend: Addend, wanted: int) -> Iterator[Candidate]:
        """Yield a term times another number or a symbol, so that it has the number that is wanted."""
        value = self.values[addend]
        number = None if value is None else model.number(value.term)
        ratio = wanted * RESIDUES.inverse(number) % PRIME if number else 0
        if ratio > 1:
            for slip, node, more in self._times(model, addend, ratio):
                yield from self._offered(addend, slip, node, more)

    def _times(
        self, model: Drawn, addend: Addend, ratio: int
    ) -> Iterator[tuple[Slip, Node, float]]:
        """Yield a term times a number or a symbol that has a value, with what it weighs more."""
        small = RESIDUES.fraction(ratio, MOST)
        if small and small > 0 and small.numerator <= MOST:
            node = rescaled(addend.node, small)
            before = numbered(node)
            yield FACTOR, node, 0.01 * (before.numerator + before.denominator)
            return
        for rank, (symbol, number) in enumerate(self._numbers(model)):
            if number == ratio:
                yield FORGOTTEN, times(addend.node, symbol), 0.01 * rank

    def _numbers(self, model: Drawn) -> Iterator[tuple[Node, int]]:
        """Yield the scalars of the note with their values."""
        more = (d for n in self.palette.symbols for d in [dotted(n)] if d is not None)
        for node in (*self.palette.symbols, *more):
            value = valued(self.line.elaborator, node)
            number = model.scalar(value.term) if value is not None and value.shape == SCALAR else 0
            if number:
                yield node, number % PRIME

    def _number(self, model: Drawn, addend: Addend) -> int:
        value = self.values[addend]
        return (0 if value is None else model.number(value.term)) or 0

    def _offered(self, addend: Addend, slip: Slip, node: Node, more: float) -> Iterator[Candidate]:
        new = worth(self.line, node)
        if new is not None and (slip is FORGOTTEN or addend.member != self.line.members[0].number):
            change = Change(slip, addend.node, node)
            own = (new.term, signature(new))
            weight = slip.weight + more
            yield Candidate((Option(addend, weight, node, addend.sign, (change,), *own),), weight)

    def _entries(self, model: Drawn, reference: Member, member: Member) -> Iterator[Candidate]:
        """Yield a table with its cells mended, against what it should be."""
        for addend in member.addends:
            found = self._gap(model, reference, member, member, addend)
            if found is not None:
                need = [addend.sign * n % PRIME for n in found]
                for option in mended(self.pools, model, addend, need, self.palette):
                    yield Candidate((option,), option.weight)

    def difference(
        self, model: Drawn, left: Member, right: Member
    ) -> tuple[Node, list[int]] | None:
        """Return a term that is one table of entries, and the left less the right side by entries."""
        for member in (right, left):
            for addend in member.addends:
                found = self._gap(model, left, right, member, addend)
                if found is not None:
                    return addend.node, found
        return None

    def _gap(
        self, model: Drawn, left: Member, right: Member, member: Member, addend: Addend
    ) -> list[int] | None:
        """Return the components of the left less the right side, if a term of one of them is a table."""
        own = self.values.get(addend)
        table = own is not None and table_in(self.line, addend.node) is not None
        if own is None or not table or own.shape not in {COLUMN, MATRIX} or member.path is None:
            return None
        a, b = (self._components(model, m, own.frames[0]) for m in (left, right))
        if a is None or b is None or len(a) != len(b):
            return None
        return [(x - y) % PRIME for x, y in zip(a, b, strict=True)]

    def _components(self, model: Drawn, member: Member, frame: str) -> list[int] | None:
        """Return the components of a member in a frame."""
        found: list[int] = []
        for sign, value in self.parts(member):
            if value is None:
                return None
            turned = components(value, frame) if value.shape in GEOMETRIC and frame else value
            numbers = model.values(turned.term)
            if numbers is None:
                return None
            signed = [sign * n for n in numbers]
            found = [a + b for a, b in zip(found, signed, strict=False)] if found else signed
        return found

    def parts(self, member: Member) -> list[tuple[int, Value | None]]:
        """Return the terms of a member as they stand, with their signs; None for no value."""
        own: list[tuple[int, Value | None]] = [] if member.value is None else [(1, member.value)]
        return [*own, *((a.sign, self.values[a]) for a in member.addends)]

    def _kinds(self, members: Iterable[Member]) -> list[Signature]:
        """Return the signatures of terms, in order, those with a dimension alone if there are any."""
        kinds: dict[Signature, None] = {}
        for member in members:
            for _, value in self.parts(member):
                kind = signature(value) if value is not None else None
                if kind is not None:
                    kinds[kind] = None
        return [*list(kinds)[:4], *self._beside_zero(kinds)]

    def _beside_zero(self, kinds: Mapping[Signature, None]) -> list[Signature]:
        """Return what else a single term may be that is said to be zero: anything."""
        terms = [m for m in self.line.members if not self.is_zero(m)]
        if len(terms) == len(self.line.members) or len(terms) != 1 or len(terms[0].addends) != 1:
            return []
        offered = (o.signature for o in self.offers[terms[0].addends[0]])
        return list(dict.fromkeys(k for k in offered if k is not None and k not in kinds))[:8]

    def _groups(self, model: Drawn, member: Member, kind: Signature, side: int) -> list[_Group]:
        groups = []
        for addend in member.addends:
            value = self.values[addend]
            own = None
            if value is not None and agrees(signature(value), kind):
                number = model.number(value.term)
                own = None if number is None else side * addend.sign * number
            groups.append(_Group(own, tuple(self._offers(model, addend, kind, side))))
        return groups

    def _offers(
        self, model: Drawn, addend: Addend, kind: Signature, side: int
    ) -> Iterator[tuple[int, Option]]:
        for option in self.offers[addend]:
            if option.term is None:
                yield 0, option
            elif agrees(option.signature, kind):
                number = model.number(option.term)
                if number is not None:
                    yield side * option.sign * number, option

    def _against(self, model: Drawn, reference: Member) -> list[Candidate]:
        """Return repairs of the members that differ from one that is taken for right."""
        total = self.total(model, reference)
        if total is None:
            return []
        kind, target = total
        others = [m for m in self.line.members if self.total(model, m) != total]
        zero = [m for m in others if self.is_zero(m)]
        if target == 0 and kind is not None:
            others = [m for m in others if m not in zero]
        found: list[Candidate] = [Candidate((), 0.0)]
        for member in others:
            if member.path is None or not found:
                return []
            kinds = [kind] if kind is not None else self._kinds([member])
            repairs = [
                c for k in kinds for c in _combined(self._groups(model, member, k, 1), target)
            ]
            own = self.total(model, member)
            if own is not None and kind is not None and own[0] == kind:
                repairs += self._lost_in(model, member, kind, (target - own[1]) % PRIME)
                for addend in member.addends:
                    parts = [a.sign * self._number(model, a) for a in member.addends if a != addend]
                    wanted = addend.sign * (target - sum(parts))
                    repairs += self._rescaled(model, addend, wanted)
            repairs += self._entries(model, reference, member)
            found = [_together(a, b) for a in found[:6] for b in _best(repairs)[:8]]
        return [c for c in found if c.options]

    def is_zero(self, member: Member) -> bool:
        """Return whether a member is written as zero."""
        return all(v.is_zero for _, v in self.parts(member) if v is not None)

    def total(self, model: Drawn, member: Member) -> tuple[Signature | None, int] | None:
        """Return signature and number of a member as it stands, None where it has none."""
        kind: Signature | None = None
        total = 0
        for sign, value in self.parts(member):
            if value is None:
                return None
            own = signature(value)
            if own is not None:
                if kind is not None and not agrees(own, kind):
                    return None
                kind = own
            number = model.number(value.term)
            if number is None:
                return None
            total += sign * number
        return kind, total % PRIME


def _combined(groups: Sequence[_Group], target: int) -> list[Candidate]:
    """Return choices of other values for some groups so that all add up to the target."""
    must = frozenset(k for k, g in enumerate(groups) if g.value is None)
    need = (target - sum(g.value or 0 for g in groups)) % PRIME
    if len(must) > 4 or (need == 0 and not must):
        return []
    flat = [
        (k, (number - (g.value or 0)) % PRIME, option)
        for k, g in enumerate(groups)
        for number, option in g.offers
    ]
    flat.sort(key=lambda f: f[2].weight)
    found = [
        Candidate((option,), option.weight)
        for k, delta, option in flat
        if delta == need and must <= {k}
    ]
    found += _pairs(flat, need, must)
    if not found:
        found += _more(flat, need, must)
    return _best(found)


_Flat = tuple[int, int, Option]


def _pairs(flat: Sequence[_Flat], need: int, must: frozenset[int]) -> Iterator[Candidate]:
    by_delta: dict[int, list[_Flat]] = {}
    for entry in flat:
        if len(must) < 2 or entry[0] in must:
            by_delta.setdefault(entry[1], []).append(entry)
    for k, delta, option in flat:
        for j, other_delta, other in by_delta.get((need - delta) % PRIME, ())[:4]:
            if k < j and must <= {k, j} and other_delta and delta:
                yield Candidate((option, other), weight((option, other)))


def _more(flat: Sequence[_Flat], need: int, must: frozenset[int]) -> Iterator[Candidate]:
    """Yield three or four slips of one kind."""
    for name in dict.fromkeys(option.slip.name for _, _, option in flat if option.slip.uniform):
        same = [f for f in flat if f[2].slip.name == name and f[2].term is not None][:60]
        pairs: dict[int, list[tuple[_Flat, _Flat]]] = {}
        for a, b in combinations(same, 2):
            if a[0] != b[0]:
                pairs.setdefault((a[1] + b[1]) % PRIME, []).append((a, b))
        chosen: list[tuple[_Flat, ...]] = [
            (a, *pair) for a in same for pair in pairs.get((need - a[1]) % PRIME, ())[:3]
        ]
        for both, first in pairs.items():
            for second in pairs.get((need - both) % PRIME, ())[:3]:
                chosen += [(*one, *second) for one in first[:3]]
        for entries in chosen:
            ordered = sorted(entries, key=lambda e: e[0])
            numbers = [e[0] for e in ordered]
            if len(set(numbers)) == len(numbers) and must <= set(numbers):
                found = tuple(e[2] for e in ordered)
                yield Candidate(found, weight(found))


def weight(chosen: Iterable[Option]) -> float:
    """Return how implausible slips are together; the same slip again weighs less.

    Another letter or label is the same slip where it takes the place of the same.
    """
    total = 0.0
    seen: set[tuple[object, ...]] = set()
    for option in sorted(chosen, key=lambda o: -o.weight):
        name = option.slip.name
        key = (name, option.first.old, option.first.new) if name in LETTERS else (name,)
        again = option.slip.uniform and key in seen
        total += option.weight * (ALL_OVER if again else 1.0)
        seen.add(key)
    return total


def _together(a: Candidate, b: Candidate) -> Candidate:
    chosen = (*a.options, *b.options)
    return Candidate(chosen, weight(chosen))


def _best(found: Iterable[Candidate]) -> list[Candidate]:
    unique: dict[tuple[Node, ...], Candidate] = {}
    for candidate in sorted(found, key=lambda c: c.weight):
        key = tuple(o.node for o in candidate.options) + tuple(
            o.addend.node for o in candidate.options
        )
        unique.setdefault((*key, *(_signed(o) for o in candidate.options)), candidate)
        if len(unique) == MANY:
            break
    return list(unique.values())


def _signed(option: Option) -> Node:
    return Addition((option.addend.node,), (str(option.sign * option.addend.sign),))


# -- the repaired tree ---------------------------------------------------------------------------


def repaired(line: Line, candidate: Candidate) -> Node:
    """Return the tree of the whole formula with the options put in."""
    tree = line.tree
    paths = {m.number: m.path for m in line.members}
    whole = [(o, (*(paths[o.addend.member] or ()), *o.addend.path)) for o in candidate.options]
    for option, path in whole:
        tree = _apply(tree, path, option)
    for path in {p[:-1] for o, p in whole if o.addend.summed}:
        tree = put(tree, path, at(tree, path))
    return tree


def _apply(tree: Node, path: Path, option: Option) -> Node:
    if option.appended:
        return _appended(tree, path, option)
    flipped = option.sign != option.addend.sign
    if not flipped:
        return set_down(tree, path, option.node)
    if not option.addend.summed:
        return set_down(tree, path, Addition((option.node,), ("-",), span=option.addend.node.span))
    parent, k = at(tree, path[:-1]), path[-1][1][0]
    assert isinstance(parent, Addition)
    sign = "-" if option.sign < 0 else "+" if k else ""
    signs = (*parent.signs[:k], sign, *parent.signs[k + 1 :])
    terms = (*parent.terms[:k], option.node, *parent.terms[k + 1 :])
    return set_down(tree, path[:-1], replace(parent, signs=signs, terms=terms))


def _appended(tree: Node, path: Path, option: Option) -> Node:
    """Put a lost term behind the last one of a sum, or of a single term."""
    sign = "-" if option.sign < 0 else "+"
    if option.addend.summed:
        parent = at(tree, path[:-1])
        assert isinstance(parent, Addition)
        terms, signs = (*parent.terms, option.node), (*parent.signs, sign)
        return set_down(tree, path[:-1], replace(parent, terms=terms, signs=signs))
    here = at(tree, path)
    return set_down(tree, path, Addition((here, option.node), ("", sign), span=here.span))


# -- what is left over -----------------------------------------------------------------------------


def pair(shop: Workshop, candidate: Candidate | None) -> tuple[Member, Member] | None:
    """Return the two members that disagree: those of an equation, or one to blame and one that is not."""
    members = shop.line.members
    if len(members) == 2:
        return members[0], members[1]
    if candidate is None:
        return None
    edited = {o.addend.member for o in candidate.options}
    wrong = next((m for m in members if m.number in edited), None)
    right = next((m for m in members if m.number not in edited), None)
    if wrong is None or right is None:
        return None
    return (wrong, right) if wrong.number < right.number else (right, wrong)


def _of_rate(shop: Workshop) -> Workshop:
    """Return the workshop of the equation that the rate of what should be constant is zero."""
    line = shop.line
    first, naught = line.members
    whole = replace(first, addends=(), value=line.claim.members[0])
    plain = replace(line, members=(whole, naught), claim=replace(line.claim, kind=STATEMENT))
    known = partial(remains, line, shop.pools.near, (), long=True)
    return replace(
        shop, line=plain, offers={}, values={}, pools=Pools(plain, {}, shop.pools.near, known)
    )


def leftover(shop: Workshop, candidate: Candidate | None, model: Drawn) -> str:
    """Return the left less the right side as LaTeX, "" where no short sum of products is that.

    It is what is left over under the assumptions of ``model``.
    """
    if shop.line.claim.kind == CONSTANT:
        shop, candidate = _of_rate(shop), None
    found = pair(shop, candidate)
    return "" if found is None else _entries(shop, model, found) or _sum(shop, model, found)


def _entries(shop: Workshop, model: Drawn, found: tuple[Member, Member]) -> str:
    """Return what is left over in a table, entry by entry."""
    tables = shop.difference(model, *found)
    if tables is None:
        return ""
    node = entry_residual(shop.pools, model, *tables)
    return "" if node is None else latex(node)


def _sum(shop: Workshop, model: Drawn, found: tuple[Member, Member]) -> str:
    """Return what is left over as a short sum of products."""
    left, right = (shop.total(model, m) for m in found)
    if left is None or right is None:
        return ""
    kind = left[0] or right[0]
    if kind is None or (left[0] and right[0] and left[0] != right[0]):
        return ""
    number = (left[1] - right[1]) % PRIME
    if not number:  # sides that differ later alone
        return ""
    least: Node | None = None
    for pieces in _told(shop, model, kind, number):
        node = total(pieces)
        if least is None or _sums(node) < _sums(least):
            least = node
        if not _sums(least):
            break
    return "" if least is None else latex(least)


def _told(
    shop: Workshop, model: Drawn, kind: Signature, number: int
) -> Iterator[tuple[Piece, ...]]:
    """Yield sums of products that are a number: of the line, of what is near, of what is known."""
    own = shop.pools.own(kind)
    known = partial(remains, shop.line, shop.palette.symbols, (), long=True)
    yield from (p for p in fits(model.number, own, number) if len(p) == 1)
    more = (shop.pools.widened(), shop.pools.knowing(known)) if shop.values else ()
    for pools in (shop.pools, *more):
        items = [*pools.pool(pools.roots, kind), *own]
        found = fits(model.number, items, number)
        yield from (p for p in found if not all(piece.item in own for piece in p))


def _sums(node: Node) -> int:
    """Return how many terms the sums of a tree have."""
    return sum(len(n.terms) for n in walk(node) if isinstance(n, Addition) and len(n.terms) > 1)


# -- two slips in one term ---------------------------------------------------------------------------

MILD = 1.3
"""What a slip weighs at most of which there may be two in one term."""
NUMBERS = frozenset({"factor", "number", "superfluous factor"})
"""Slips of which two in one product are one."""
PAIRS = 300
"""Pairs of slips in one term that are tried at most."""


def doubles(node: Node, single: Iterable[Edit]) -> list[Edit]:
    """Return the likeliest pairs of slips at two places of a tree, both undone."""
    mild = [e for e in single if e.weight <= MILD and _alone(e)]
    pairs = (
        (_joint(a, b), k, a, b)
        for k, (a, b) in enumerate(combinations(mild, 2))
        if disjoint(a.first.paths[0], b.first.paths[0])
        and not {a.slip.name, b.slip.name} <= NUMBERS
    )
    found = []
    for weight, _, a, b in nsmallest(PAIRS, pairs):
        tree = node
        for path, new in ((e.first.paths[0], e.first.new) for e in (a, b)):
            tree = set_down(tree, path, new)
        found.append(Edit(weight, tree, (*a.changes, *b.changes)))
    return found


def _alone(edit: Edit) -> bool:
    paths = edit.first.paths
    return len(paths) == 1 and paths[0] != () and not isinstance(edit.first.new, Missing)


def _joint(a: Edit, b: Edit) -> float:
    """Return how implausible two slips are together; the same one again weighs less."""
    again = a.slip.uniform and a.slip.name == b.slip.name
    return max(a.weight, b.weight) + min(a.weight, b.weight) * (ALL_OVER if again else 1.0)
