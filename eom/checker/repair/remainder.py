"""The residual of a wrong line in the writer's symbols: what is too much on its left side."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from eom.checker.mean.claims import CONSTANT, STATEMENT
from eom.checker.read.writing import latex
from eom.checker.repair.candidates import Candidate, Workshop
from eom.checker.repair.lines import Member, Place
from eom.checker.repair.lost import Pools, entry_residual
from eom.checker.repair.residual import fits, total
from eom.checker.repair.solution_places import remains
from eom.fields import PRIME


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
    near = shop.pools.near
    known = partial(remains, line, near, ())
    return replace(shop, line=plain, offers={}, values={}, pools=Pools(plain, {}, near, known))


def leftover(shop: Workshop, candidate: Candidate | None, place: Place) -> str:
    """Return the left less the right side as LaTeX, "" where no short sum of products is that.

    It is what is left over under the assumptions of ``place``.
    """
    if shop.line.claim.kind == CONSTANT:
        shop, candidate = _of_rate(shop), None
    found = pair(shop, candidate)
    return "" if found is None else _entries(shop, place, found) or _sum(shop, place, found)


def _entries(shop: Workshop, place: Place, found: tuple[Member, Member]) -> str:
    """Return what is left over in a table, entry by entry."""
    tables = shop.difference(place, *found)
    if tables is None:
        return ""
    node = entry_residual(shop.pools, place, *tables)
    return "" if node is None else latex(node)


def _sum(shop: Workshop, place: Place, found: tuple[Member, Member]) -> str:
    """Return what is left over as a short sum of products."""
    left, right = (shop.total(place, m) for m in found)
    if left is None or right is None:
        return ""
    kind = left[0] or right[0]
    if kind is None or (left[0] and right[0] and left[0] != right[0]):
        return ""
    number = (left[1] - right[1]) % PRIME
    for pieces in fits(place, shop.pools.own(kind), number):
        if len(pieces) == 1:
            return latex(total(pieces))
    for pools in (shop.pools, shop.pools.widened()):
        for pieces in fits(place, pools.pool(pools.roots, kind), number):
            return latex(total(pieces))
    return ""
