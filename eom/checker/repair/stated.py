"""Counterexamples to lines about a system: a state at which both sides are computed and differ."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from fractions import Fraction

from eom.checker.read.writing import latex
from eom.checker.repair.candidates import Candidate, Workshop
from eom.checker.repair.counterexample import (
    BEST,
    Shown,
    fraction,
    head_of,
    rank_of,
    shown_nodes,
    terms_of,
    too_large,
)
from eom.checker.repair.lines import Place
from eom.checker.repair.remainder import pair
from eom.checker.repair.state_examples import StatePoint, points
from eom.checker.report.findings import Counterexample
from eom.errors import InputError
from eom.system import Expr
from eom.terms.terms import Term


def stated(shop: Workshop, candidate: Candidate | None, place: Place) -> Counterexample | None:
    """Return small numbers for the quantities of a system at which a line fails, or None.

    They keep what is given of the system, and what is assumed at ``place``.
    """
    members, model = pair(shop, candidate), shop.line.claim.model
    terms = terms_of(shop, members) if members is not None else None
    if members is None or model is None or terms is None:
        return None
    shown = shown_nodes(shop, members, candidate)
    heads = [head_of(shop, m) for m in members]
    least: Counterexample | None = None
    for point in points(model, shop.line.elaborator.scalars, place.names):
        found = _told(point, terms, shown, heads, tuple(sorted(place.names)))
        if found is not None and (least is None or rank_of(found) < rank_of(least)):
            least = found
        if least is not None and rank_of(least) <= BEST:
            break
    return least


def _told(
    point: StatePoint,
    terms: tuple[Term, Term],
    shown: Sequence[Shown],
    heads: Sequence[str],
    names: tuple[str, ...],
) -> Counterexample | None:
    """Return the numbers of a state; None where the sides agree, or some are large or have no value."""
    try:
        sides = [point.value(t) for t in terms]
    except InputError:
        return None
    if sides[0] == sides[1]:
        return None
    values = dict(_values(point, shown))
    members = tuple((h, _told_as(s)) for h, s in zip(heads, sides, strict=True))
    if any(too_large(t) for t in (*values.values(), *(t for _, t in members))):
        return None
    return Counterexample(tuple(values.items()), members, names)


def _values(point: StatePoint, shown: Sequence[Shown]) -> Iterator[tuple[str, str]]:
    for node, value in shown:
        with suppress(InputError):
            yield latex(node), _told_as(point.value(value.term))


def _told_as(value: Expr) -> str:
    return fraction(Fraction(int(value.p), int(value.q)))
