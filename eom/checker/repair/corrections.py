"""Corrections of a wrong line: looked for in models, read again as a whole, judged, ranked.

Which cells of a table may be at fault: those whose components differ, or do not fit the others. A slip in
one cell of a matrix changes that component alone, so edits elsewhere in the table need not be tried; a
table of nine sums has thousands.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations

from eom.checker.judge.judge import HOLDS, UNDER, Judgement, judge_within
from eom.checker.judge.models import Drawn
from eom.checker.judge.notes import Understood, reread
from eom.checker.judge.systems import Solutions
from eom.checker.mean.claims import CONSTANT, Claim
from eom.checker.mean.values import Value
from eom.checker.read.paths import Path, at
from eom.checker.read.syntax import (
    Boxed,
    Braced,
    Group,
    Integral,
    Matrix,
    Node,
    Product,
    Scripts,
    walk,
)
from eom.checker.repair.candidates import Candidate, Workshop, options, repaired
from eom.checker.repair.lines import (
    Addend,
    Line,
    Member,
    palette,
    penalty,
    signature,
    valued,
    worth,
)
from eom.checker.repair.residual import Pools, remains
from eom.fields import PRIME, RESIDUES
from eom.terms.terms import MATRIX, SCALAR, Term

SHOWN = 3
"""Corrections that are shown at most."""
JUDGED = 6
"""Repairs of a line that are judged in full at most."""
WEAK = 2.0
"""What the best repair weighs at least if terms of symbols around the line are tried as well."""
NEAR = 12
"""Symbols around a line that are tried in lost terms, if its own do not help."""
ENOUGH = 1.0
"""A repair found is enough if a special level could only add some that weigh this much more."""


@dataclass(frozen=True)
class Ranked:
    """A repair with its tree, what it weighs so far as is known, and where it was found to hold."""

    candidate: Candidate
    tree: Node
    cost: float
    model: Drawn


@dataclass(frozen=True)
class Verified:
    """A repair that was read again and judged: its claim and judgement."""

    ranked: Ranked
    claim: Claim
    judgement: Judgement
    cost: float


def corrections(
    understood: Understood, shop: Workshop, given: Iterable[str] = (), stated: Iterable[str] = ()
) -> list[Verified]:
    """Return verified repairs of a wrong line, the most plausible first."""
    given, stated = tuple(given), frozenset(stated) | frozenset(given)
    ranked = _ranked(shop, given)
    if (not ranked or ranked[0].cost > WEAK) and not shop.pools.left:
        more = _ranked(_widened(shop), given)
        ranked = sorted([*ranked, *more], key=lambda r: r.cost)
    found: list[Verified] = []
    unique: dict[Node, Ranked] = {}
    for one in ranked:
        unique.setdefault(one.tree, one)
    for one in list(unique.values())[:JUDGED]:
        made = verified(understood, shop.line, one, given, stated)
        if made is not None:
            found.append(made)
        if len(found) == SHOWN:
            break
    return sorted(found, key=lambda v: v.cost)


def _widened(shop: Workshop) -> Workshop:
    return replace(shop, pools=shop.pools.widened())


def levels(shop: Workshop, given: tuple[str, ...]) -> Iterator[tuple[Drawn, Drawn]]:
    """Yield models for a line: without more than is given, and one of each level."""
    terms = [v.term for v in shop.values.values() if v is not None]
    terms += [m.value.term for m in shop.line.members if m.value is not None]
    return shop.line.models(given).levels(terms)


def _ranked(shop: Workshop, given: tuple[str, ...]) -> list[Ranked]:
    """Return what holds in some world, by weight and by whether it holds without assumptions."""
    found: dict[object, Ranked] = {}
    wrong = shop.line
    for number, (free, there) in enumerate(levels(shop, given)):
        if found and min(r.cost for r in found.values()) < 1.0 + number * ENOUGH:
            break
        for candidate in shop.candidates(there):
            tree = repaired(wrong, candidate)
            extra = 0.0 if _holds_in(shop, free, candidate) else 0.6 + 0.5 * number
            key = _alike(shop, free, candidate) or tree
            better = key not in found or found[key].cost > candidate.weight + extra
            if better and not trivial(shop, tree, (free, there), candidate):
                found[key] = Ranked(candidate, tree, candidate.weight + extra, there)
    return sorted(found.values(), key=lambda r: r.cost)


def workshop(understood: Understood, wrong: Line, given: Iterable[str] = ()) -> Workshop:
    """Return a line with what may stand for each of its terms."""
    have = palette(understood, wrong)
    addends = [a for m in wrong.members for a in m.addends if m.path is not None]
    values = {a: worth(wrong, a.node) for a in addends}
    equal = wrong.claim.kind != CONSTANT
    known = partial(remains, wrong, have.symbols, tuple(given)) if equal else tuple
    shop = Workshop(wrong, {}, values, Pools(wrong, values, have.symbols[:NEAR], known))
    at_fault = _suspects(shop, tuple(given))
    spared = {a: (at_fault[a].spares,) if a in at_fault else () for a in addends}
    return replace(shop, offers={a: options(wrong, a, have, *spared[a]) for a in addends})


def _suspects(shop: Workshop, given: tuple[str, ...]) -> dict[Addend, Suspects]:
    """Return the cells of tables that may be at fault, by the terms of a line."""
    if not any(isinstance(n, Matrix) for a in shop.values for n in walk(a.node)):
        return {}
    models = (m for both in levels(shop, given) for m in both)
    return suspects(shop.line, shop.values, [_differences(shop, m) for m in models])


def _differences(shop: Workshop, model: Drawn) -> dict[tuple[int, int], list[int]]:
    """Return what members differ by in a model, component by component, for pairs of them."""
    pairs = combinations(shop.line.members, 2)
    found = {(a.number, b.number): shop.difference(model, a, b) for a, b in pairs}
    return {numbers: both[1] for numbers, both in found.items() if both is not None}


def _parts(shop: Workshop, model: Drawn, candidate: Candidate) -> list[list[int | None]]:
    """Return the numbers of the terms of all members with a repair put in; None where one has none."""
    chosen = {o.addend: o for o in candidate.options}
    own = {a for m in shop.line.members for a in m.addends}
    found = []
    for member in shop.line.members:
        parts = [] if member.value is None else [model.number(member.value.term)]
        for addend in member.addends:
            option, value = chosen.get(addend), shop.values.get(addend)
            if option is not None:
                parts.append(_number(model, option.sign, option.term, 0))
            else:
                parts.append(_number(model, addend.sign, value.term if value else None, None))
        lost = [o for a, o in chosen.items() if a not in own and a.member == member.number]
        found.append([*parts, *(_number(model, o.sign, o.term, None) for o in lost)])
    return found


def _number(model: Drawn, sign: int, term: Term | None, otherwise: int | None) -> int | None:
    number = otherwise if term is None else model.number(term)
    return None if number is None else sign * number


def _totals(shop: Workshop, model: Drawn, candidate: Candidate) -> list[int | None]:
    """Return the numbers of all members with a repair put in; None where one has none."""
    rows = _parts(shop, model, candidate)
    return [None if None in r else sum(p for p in r if p is not None) % PRIME for r in rows]


def _alike(shop: Workshop, model: Drawn, candidate: Candidate) -> tuple[int, ...] | None:
    """Return the terms after a repair as numbers up to a factor: the same for repairs that say the same."""
    numbers: list[int] = []
    for parts in _parts(shop, model, candidate):
        if None in parts:
            return None
        numbers += [p % PRIME for p in parts if p is not None]
    first = next((n for n in numbers if n), 0)
    if not first:
        return None
    return tuple(RESIDUES.scaled(numbers, RESIDUES.inverse(first)))


def _holds_in(shop: Workshop, model: Drawn, candidate: Candidate) -> bool:
    totals = _totals(shop, model, candidate)
    return None not in totals and len(set(totals)) == 1


def trivial(shop: Workshop, tree: Node, there: tuple[Drawn, Drawn], candidate: Candidate) -> bool:
    """Return whether a repair says nothing: two members alike, or all of them zero anyway.

    ``there``: the worlds where least and where most is assumed; a line that says itself that something
    is zero may do so where much is assumed.
    """
    members = shop.line.members
    if shop.line.claim.kind == CONSTANT:
        return _never_changes(shop, tree, there, candidate)
    nodes = [at(tree, m.path) for m in members if m.path is not None]
    if len(set(nodes)) < len(nodes):
        return True
    says = any(shop.is_zero(m) for m in members)
    return any(
        all(t == 0 for t in _totals(shop, model, candidate)) for model in there[: 1 if says else 2]
    )


def _never_changes(
    shop: Workshop, tree: Node, there: tuple[Drawn, Drawn], candidate: Candidate
) -> bool:
    """Return whether what is said to be constant is so anyway: a zero, parameters, what never changes."""
    (path,) = (m.path for m in shop.line.members if m.path is not None)
    value = valued(shop.line.elaborator, at(tree, path))
    if value is None or there[1].number(value.term) == 0:
        return True
    models = shop.line.models()
    if isinstance(models, Solutions):
        return not models.moves(value.term)
    return all(t == 0 for t in _totals(shop, there[0], candidate))


def verified(
    understood: Understood,
    wrong: Line,
    ranked: Ranked,
    given: tuple[str, ...],
    stated: frozenset[str],
) -> Verified | None:
    """Return a repair that holds when it is read again as a whole, or None."""
    claims = reread(understood, ranked.tree)
    if len(claims) != len(understood.claims):
        return None
    claim = claims[wrong.number]
    if claim.verdict or claim.kind != wrong.claim.kind:
        return None
    if _tautology(claim, ranked.candidate):
        return None
    found = judge_within(claim, ranked.model.names, given)
    if found.verdict not in {HOLDS, UNDER}:
        return None
    needed = min((penalty(s, stated) for s in found.sets), default=0.0)
    cost = ranked.candidate.weight + needed + (0.5 if needed else 0.0)
    return Verified(ranked, claim, found, cost)


REPLACING = frozenset({"symbol", "index", "superfluous term", "superfluous factor"})
"""Slips by which a line can be made to say that something is itself."""


def _tautology(claim: Claim, candidate: Candidate) -> bool:
    """Return whether an equation has become one of a thing with itself, by other letters."""
    same = len(claim.members) == 2 and claim.members[0].term == claim.members[1].term
    return same and any(o.slip.name in REPLACING for o in candidate.options)


# -- cells of tables that may be at fault ----------------------------------------------------------


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
