"""Corrections of a wrong line: looked for in models, read again as a whole, judged, ranked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, permutations

from eom.checker.judge.judge import HOLDS, UNDER, Judgement, judge_within, row_of
from eom.checker.judge.models import Drawn
from eom.checker.judge.notes import Understood, reread
from eom.checker.judge.systems import Solutions
from eom.checker.mean.claims import CONSTANT, Claim
from eom.checker.read.paths import Path, at
from eom.checker.read.syntax import (
    Matrix,
    Node,
    walk,
)
from eom.checker.repair.candidates import (
    Candidate,
    Remembered,
    Workshop,
    double_options,
    options,
    repaired,
    symbol_options,
)
from eom.checker.repair.lines import (
    UNUSUAL,
    Addend,
    Line,
    palette,
    penalty,
    valued,
    worth,
)
from eom.checker.repair.residual import Pools, remains
from eom.checker.repair.tables import Suspects, by_cells, suspects
from eom.fields import PRIME, RESIDUES
from eom.terms.terms import Term

SHOWN = 3
"""Corrections that are shown at most."""
JUDGED = 6
"""Repairs of a line that are judged in full at most."""
NEAR = 12
"""Symbols around a line that are tried in lost terms, if its own do not help."""
FAR = 1.3
"""What a repair weighs more at most than the best one, if it is offered beside that."""
ASSUMED, SPECIAL = 0.6, 0.3
"""What a repair weighs more that needs assumptions, and with each level at which it is found."""
ENOUGH = 1.0
"""A repair found is enough if a special level could only add some that weigh this much more."""


@dataclass(frozen=True)
class Ranked:
    """A repair with its tree, what it weighs so far as is known, and where it was found to hold."""

    candidate: Candidate
    tree: Node
    extra: float
    model: Drawn

    @property
    def cost(self) -> float:
        """What it weighs, with what has to be assumed."""
        return self.candidate.weight + self.extra

    @property
    def far(self) -> float:
        """What it weighs if the usual assumptions are none."""
        return self.candidate.weight + max(self.extra - ASSUMED, 0.0)


@dataclass(frozen=True)
class Verified:
    """A repair that was read again and judged: its claim and judgement.

    ``special``: it needs a special case that the note has not stated.
    """

    ranked: Ranked
    claim: Claim
    judgement: Judgement
    cost: float
    special: bool


def corrections(
    understood: Understood, shop: Workshop, given: Iterable[str] = (), stated: Iterable[str] = ()
) -> list[Verified]:
    """Return verified repairs of a wrong line, the most plausible first.

    Where none holds in general, those of one slip that hold in a special case.
    """
    given, stated = tuple(given), frozenset(stated) | frozenset(given)
    ranked: list[Ranked] = []
    for more, least in STAGES:
        if not ranked or ranked[0].far > least:
            ranked = sorted([*ranked, *_ranked(more(shop))], key=lambda r: r.cost)
    found: list[Verified] = []
    special: list[Verified] = []
    unique: dict[Node, Ranked] = {}
    for one in ranked:
        unique.setdefault(one.tree, one)
    near = [r for r in unique.values() if r.cost <= ranked[0].cost + FAR]
    for one in near[:JUDGED]:
        made = verified(understood, shop.line, one, given, stated)
        if made is not None:
            (special if made.special else found).append(made)
        if len(found) == SHOWN:
            break
    simple = [v for v in special if sum(len(o.changes) for o in v.ranked.candidate.options) == 1]
    return sorted(found or simple, key=lambda v: v.cost)


def _spares(shop: Workshop, addend: Addend) -> Callable[[Path], bool]:
    suspects = shop.suspects.get(addend)
    return (lambda _: False) if suspects is None else suspects.spares


def _with_symbols(shop: Workshop) -> Workshop:
    """Return the workshop in which symbols of the note may have been lost or exchanged as well."""
    line, have = shop.line, shop.palette
    more = {a: symbol_options(line, a, have, _spares(shop, a)) for a in shop.offers}
    offers = {a: sorted([*o, *more[a]], key=lambda o: o.weight) for a, o in shop.offers.items()}
    return replace(shop, offers=offers)


def _doubled(shop: Workshop) -> Workshop:
    """Return the workshop for two slips in one term."""
    offers = {a: double_options(shop.line, a, shop.palette) for a in shop.offers}
    return replace(shop, offers=offers)


def _widened(shop: Workshop) -> Workshop:
    """Return the workshop in which terms of symbols around the line may be lost."""
    return shop if shop.pools.left else replace(shop, pools=shop.pools.widened())


def _by_lexicon(shop: Workshop) -> Workshop:
    """Return the workshop in which what is left over is written with all symbols of the lexicon."""
    known = partial(remains, shop.line, shop.palette.symbols)
    return replace(shop, offers=dict.fromkeys(shop.offers, ()), pools=shop.pools.knowing(known))


STAGES: tuple[tuple[Callable[[Workshop], Workshop], float], ...] = (
    (lambda shop: shop, 0.0),
    (_with_symbols, 1.3),
    (_doubled, 1.4),
    (_widened, 2.0),
    (_by_lexicon, 2.0),
)
"""Where repairs are looked for, and what the best one weighs at least if the next is tried as well."""


def _ranked(shop: Workshop) -> list[Ranked]:
    """Return what holds in some world, by weight and by whether it holds without assumptions."""
    found: dict[object, Ranked] = {}
    wrong = shop.line
    for number, (free, there) in enumerate(shop.levels):
        if found and min(r.cost for r in found.values()) < 1.0 + number * ENOUGH:
            break
        for candidate in shop.candidates(there):
            tree = repaired(wrong, candidate)
            extra = 0.0 if _holds_in(shop, free, candidate) else ASSUMED + SPECIAL * number
            key = _alike(shop, free, candidate) or tree
            better = key not in found or found[key].cost > candidate.weight + extra
            if better and not trivial(shop, tree, (free, there), candidate):
                found[key] = Ranked(candidate, tree, extra, there)
    return sorted(found.values(), key=lambda r: r.cost)


def workshop(understood: Understood, wrong: Line, given: Iterable[str] = ()) -> Workshop:
    """Return a line with what may stand for each of its terms."""
    have = palette(understood, wrong)
    addends = [a for m in wrong.members for a in m.addends if m.path is not None]
    values = {a: worth(wrong, a.node) for a in addends}
    equal = wrong.claim.kind != CONSTANT
    own = [n for n in have.symbols if n in have.written]
    known = partial(remains, wrong, own, tuple(given)) if equal else tuple
    shop = Workshop(wrong, {}, values, Pools(wrong, values, have.symbols[:NEAR], known), have)
    terms = [v.term for v in values.values() if v is not None]
    terms += [m.value.term for m in wrong.members if m.value is not None]
    shop = replace(shop, levels=Remembered(wrong.models(given).levels(terms)))
    shop = replace(shop, suspects=_suspects(shop))
    return replace(shop, offers={a: options(wrong, a, have, _spares(shop, a)) for a in addends})


def _suspects(shop: Workshop) -> dict[Addend, Suspects]:
    """Return the cells of tables that may be at fault, by the terms of a line."""
    if not any(isinstance(n, Matrix) for a in shop.values for n in walk(a.node)):
        return {}
    models = [m for both in shop.levels for m in both]
    apart = [
        a for a, v in shop.values.items() if any(by_cells(shop.line, m, a, v) for m in models[:1])
    ]
    return suspects(shop.line, shop.values, [_differences(shop, m) for m in models], apart)


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
    replaced = any(o.slip.name in REPLACING for o in candidate.options) and len(members) == 2
    if replaced and (
        _cancels(_parts(shop, there[0], candidate)) or len(set(_terms(shop, candidate))) == 1
    ):
        return True
    says = any(shop.is_zero(m) for m in members)
    return any(
        all(t == 0 for t in _totals(shop, model, candidate)) for model in there[: 1 if says else 2]
    )


def _terms(shop: Workshop, candidate: Candidate) -> Iterator[tuple[tuple[int, Term | None], ...]]:
    """Yield the terms of each member with a repair put in, with their signs."""
    chosen = {o.addend: (o.sign, o.term) for o in candidate.options}
    for member in shop.line.members:
        own = () if member.value is None else ((1, member.value.term),)
        values = ((a, shop.values.get(a)) for a in member.addends)
        yield (*own, *(chosen.get(a, (a.sign, v.term if v else None)) for a, v in values))


def _cancels(parts: Sequence[Sequence[int | None]]) -> bool:
    """Return whether a member is what another one adds nothing but zero to."""
    return any(
        len(alone) == 1
        and len(other) > 1
        and alone[0]
        and (alone[0] or 0) % PRIME in _residues(other)
        for alone, other in permutations(parts, 2)
    )


def _residues(numbers: Iterable[int | None]) -> set[int]:
    return {n % PRIME for n in numbers if n is not None}


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
    if _tautology(claim, ranked.candidate) or row_of(claim) is not row_of(wrong.claim):
        return None
    found = judge_within(claim, ranked.model.names, given)
    cells = (c for c in claims if c.indices and c.span == claim.span and c is not claim)
    others = (judge_within(c, ranked.model.names, given) for c in cells)
    if any(j.verdict not in {HOLDS, UNDER} for j in (found, *others)):
        return None
    needed = min((penalty(s, stated) for s in found.sets), default=0.0)
    cost = ranked.candidate.weight + needed + (0.5 if needed else 0.0)
    return Verified(ranked, claim, found, cost, needed >= UNUSUAL)


REPLACING = frozenset(
    {
        *("symbol", "index", "superfluous term", "superfluous factor"),
        *("frame of the derivative", "mark of the derivative"),
    }
)
"""Slips by which a line can be made to say that something is itself."""


def _tautology(claim: Claim, candidate: Candidate) -> bool:
    """Return whether an equation has become one of a thing with itself, by other letters."""
    same = len(claim.members) == 2 and claim.members[0].term == claim.members[1].term
    return same and any(o.slip.name in REPLACING for o in candidate.options)
