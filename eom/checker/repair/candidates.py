"""Repairs of a wrong line that hold in a world: one slip undone, or a few in different terms.

What a slip in one term does to the residual does not depend on the other terms, so that pairs of slips
are found by looking up numbers (meet in the middle), and three or four of one kind as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from eom.checker.mean.values import GEOMETRIC, Value, components
from eom.checker.read.paths import Path, at, put, set_down
from eom.checker.read.syntax import Addition, Node
from eom.checker.repair.lines import Addend, Line, Member, Place, Signature, agrees, signature
from eom.checker.repair.lost import Pools, entry_terms, lost_terms
from eom.checker.repair.options import Option
from eom.checker.repair.slips import ALL_OVER, LOST
from eom.fields import PRIME
from eom.terms.terms import COLUMN, MATRIX

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


@dataclass
class Workshop:
    """A line with its options; ``values``: of its terms as they stand, None where there is none."""

    line: Line
    offers: Mapping[Addend, list[Option]]
    values: Mapping[Addend, Value | None]
    pools: Pools

    def candidates(self, place: Place) -> list[Candidate]:
        """Return repairs after which all members agree in a world."""
        members = self.line.members
        if len(members) == 2:
            return self._both(place)
        found: list[Candidate] = []
        for reference in members:
            found += self._against(place, reference)
        return _best(found)

    def _both(self, place: Place) -> list[Candidate]:
        left, right = self.line.members
        found: list[Candidate] = []
        for a, b in ((left, right), (right, left)):
            found += self._entries(place, a, b)
        for kind in self._kinds(self.line.members):
            target = 0
            groups: list[_Group] = []
            for member, side in ((left, 1), (right, -1)):
                if member.value is not None:
                    target -= side * (place.number(member.value.term) or 0)
                groups += self._groups(place, member, kind, side)
            found += _combined(groups, target % PRIME)
            if all(g.value is not None for g in groups):
                need = (target - sum(g.value or 0 for g in groups)) % PRIME
                found += self._lost(place, kind, need)
        return _best(found)

    def _lost(self, place: Place, kind: Signature, need: int) -> Iterator[Candidate]:
        """Yield lost terms of one of two members; ``need``: of the left less the right side."""
        left, right = self.line.members
        member, side = (right, -1) if right.path is not None else (left, 1)
        if self.is_zero(right) and left.path is not None:
            member, side = left, 1
        yield from self._lost_in(place, member, kind, side * need % PRIME)

    def _lost_in(
        self, place: Place, member: Member, kind: Signature, need: int
    ) -> Iterator[Candidate]:
        if need:
            for option in lost_terms(self.pools, place, member, kind, need):
                yield Candidate((option,), option.weight)

    def _entries(self, place: Place, reference: Member, member: Member) -> Iterator[Candidate]:
        """Yield a table that has lost terms in some entries, against what it should be."""
        if len(member.addends) != 1 or member.path is None:
            return
        own = self.values[member.addends[0]]
        if own is None or own.shape not in {COLUMN, MATRIX}:
            return
        wanted = self._components(place, reference, own.frames[0])
        standing = self._components(place, member, own.frames[0])
        if wanted is None or standing is None or len(wanted) != len(standing):
            return
        sign = member.addends[0].sign
        need = [sign * (a - b) % PRIME for a, b in zip(wanted, standing, strict=True)]
        for option in entry_terms(self.pools, place, member.addends[0], need):
            yield Candidate((option,), option.weight)

    def difference(
        self, place: Place, left: Member, right: Member
    ) -> tuple[Node, list[int]] | None:
        """Return a member that is one table of entries, and the left less the right side by entries."""
        for member in (right, left):
            own = self.values.get(member.addends[0]) if len(member.addends) == 1 else None
            if own is not None and own.shape in {COLUMN, MATRIX} and member.path is not None:
                both = [self._components(place, m, own.frames[0]) for m in (left, right)]
                if both[0] is not None and both[1] is not None and len(both[0]) == len(both[1]):
                    pairs = zip(both[0], both[1], strict=True)
                    return member.addends[0].node, [(a - b) % PRIME for a, b in pairs]
        return None

    def _components(self, place: Place, member: Member, frame: str) -> list[int] | None:
        """Return the components of a member in a frame."""
        found: list[int] = []
        parts: list[tuple[int, Value | None]] = []
        if member.value is not None:
            parts.append((1, member.value))
        parts += [(a.sign, self.values[a]) for a in member.addends]
        for sign, value in parts:
            if value is None:
                return None
            turned = components(value, frame) if value.shape in GEOMETRIC and frame else value
            numbers = place.values(turned.term)
            if numbers is None:
                return None
            signed = [sign * n for n in numbers]
            found = [a + b for a, b in zip(found, signed, strict=False)] if found else signed
        return found

    def _kinds(self, members: Iterable[Member]) -> list[Signature]:
        """Return the signatures of terms, in order, those with a dimension alone if there are any."""
        kinds: dict[Signature, None] = {}
        for member in members:
            values = [self.values[a] for a in member.addends]
            for value in [member.value, *values]:
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

    def _groups(self, place: Place, member: Member, kind: Signature, side: int) -> list[_Group]:
        groups = []
        for addend in member.addends:
            value = self.values[addend]
            own = None
            if value is not None and agrees(signature(value), kind):
                number = place.number(value.term)
                own = None if number is None else side * addend.sign * number
            groups.append(_Group(own, tuple(self._offers(place, addend, kind, side))))
        return groups

    def _offers(
        self, place: Place, addend: Addend, kind: Signature, side: int
    ) -> Iterator[tuple[int, Option]]:
        for option in self.offers[addend]:
            if option.term is None:
                yield 0, option
            elif agrees(option.signature, kind):
                number = place.number(option.term)
                if number is not None:
                    yield side * option.sign * number, option

    def _against(self, place: Place, reference: Member) -> list[Candidate]:
        """Return repairs of the members that differ from one that is taken for right."""
        total = self.total(place, reference)
        if total is None:
            return []
        kind, target = total
        others = [m for m in self.line.members if self.total(place, m) != total]
        zero = [m for m in others if self.is_zero(m)]
        if target == 0 and kind is not None:
            others = [m for m in others if m not in zero]
        found: list[Candidate] = [Candidate((), 0.0)]
        for member in others:
            if member.path is None or not found:
                return []
            kinds = [kind] if kind is not None else self._kinds([member])
            repairs = [
                c for k in kinds for c in _combined(self._groups(place, member, k, 1), target)
            ]
            own = self.total(place, member)
            if own is not None and kind is not None and own[0] == kind:
                repairs += self._lost_in(place, member, kind, (target - own[1]) % PRIME)
            repairs += self._entries(place, reference, member)
            found = [_together(a, b) for a in found[:6] for b in _best(repairs)[:8]]
        return [c for c in found if c.options]

    def is_zero(self, member: Member) -> bool:
        """Tell whether a member is written as zero."""
        values = [member.value, *(self.values[a] for a in member.addends)]
        return all(v.is_zero for v in values if v is not None)

    def total(self, place: Place, member: Member) -> tuple[Signature | None, int] | None:
        """Return signature and number of a member as it stands, None where it has none."""
        values: list[tuple[int, Value | None]] = []
        if member.value is not None:
            values.append((1, member.value))
        values += [(a.sign, self.values[a]) for a in member.addends]
        kind: Signature | None = None
        total = 0
        for sign, value in values:
            if value is None:
                return None
            own = signature(value)
            if own is not None:
                if kind is not None and not agrees(own, kind):
                    return None
                kind = own
            number = place.number(value.term)
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
        for total, first in pairs.items():
            for second in pairs.get((need - total) % PRIME, ())[:3]:
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
        key = (name, option.old, option.new) if name in LETTERS else (name,)
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
    if option.slip is LOST and option.node is option.new:
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
