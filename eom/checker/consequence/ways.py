"""The ways in which a line follows from what is known, or would but for a slip.

They are tried in order: as it stands; to the first order; but for a constant, by its derivative; as a
motion in closed form; as a frequency; with one slip.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import product

import sympy as sp

from eom.checker.consequence.jets import CHANGES, TIME, Equal, Expr, Letter, derived, lettered, rate
from eom.checker.consequence.known import (
    FAILS,
    FIRST_ORDER,
    RATE,
    Followed,
    Known,
    held,
    sources,
)
from eom.checker.consequence.modes import mode, modes
from eom.checker.consequence.rules import (
    Point,
    Rule,
    Rules,
    agrees,
    agrees_but_for_signs,
    agrees_nearly,
    lone,
    points,
)
from eom.checker.consequence.slips import View, slip

SMALL_MOTIONS = re.compile(r"\bsmall|lineari[sz]|to first order|approximat", re.IGNORECASE)
"""Words before equations of motion that hold for small motions."""
FREQUENCY = re.compile(
    r"frequenc|period|eigen|oscillat|mode\b|modes\b|nutation|libration", re.IGNORECASE
)
"""Words before a line that says how fast something oscillates."""
NOTHING = 1e-25


def found(
    known: Known, number: int, q: Equal, new: frozenset[str], *, judged: bool
) -> Followed | None:
    """Return that an equation follows, or, where it is judged, would but for a slip; None for neither."""
    first = _as_it_stands(known, q) or _to_first_order(known, number, q)
    if first or q.near:
        return first
    for view, rules in product(_rates(q, known.rules), known.sets):
        with suppress(*FAILS):
            asked, at = view(q), points(rules)
            if agrees(asked, at) and not _empties(known, asked, at):
                if not _says_when(q, new):
                    return None
                return Followed(sources(rules, asked), how=RATE, held=held(rules, asked))
    return _in_closed_form(known, q) or (_with_a_slip(known, q) if judged else None)


def _as_it_stands(known: Known, q: Equal) -> Followed | None:
    for rules in known.sets:
        with suppress(*FAILS):
            at = points(rules)
            exact = agrees(q, at)
            if (exact or agrees_but_for_signs(q, at)) and not _empties(known, q, at):
                what = Followed(sources(rules, q), held=held(rules, q))
                known.used |= {n for n, _ in known.aside} & what.sources
                if not exact:
                    known.sign(q)
                return what
    return None


def _to_first_order(known: Known, number: int, q: Equal) -> Followed | None:
    small = q.near or SMALL_MOTIONS.search(known.words[number])
    if not small or all(k.order < 2 for k in lettered(q.letters).values()):
        return None
    for rules in known.sets:
        with suppress(*FAILS):
            if agrees_nearly(q, rules):
                return Followed(sources(rules, q), how=FIRST_ORDER)
    return None


def _with_a_slip(known: Known, q: Equal) -> Followed | None:
    views = [_itself, *_rates(q, known.rules), *_squares(q)]
    for view, rules in product(views, known.sets):
        with suppress(*FAILS):
            one = slip(q, points(rules), known.letters, view)
            rests = frozenset[int]() if one is None else sources(rules, view(one.mended))
            if rests:
                return Followed(rests, one)
    return None


def _in_closed_form(known: Known, q: Equal) -> Followed | None:
    for rules in known.sets:
        with suppress(*FAILS):
            rests = _solves(known, rules, q)
            if rests:
                return Followed(rests, how=RATE)
    return None


def _solves(known: Known, rules: Rules, q: Equal) -> frozenset[int]:
    """Return the formulas of the equation of motion that a motion in closed form solves; none if none."""
    for moving, value in ((q.left, q.right), (q.right, q.left)):
        name = getattr(lettered([moving]).get(moving), "name", "")
        old = rules.known.get(name) if name in lone(q) else None
        if old is None or not old.order or not value.has(TIME):
            continue
        put_in = rules.copy()
        put_in.add(Rule(name, 0, value, frozenset()))
        asked = Equal(derived(moving, old.order), old.value)
        at = points(put_in)
        if agrees(asked, at) and not _empties(known, asked, at):
            return old.sources | sources(put_in, asked)
    return frozenset()


def _says_when(q: Equal, new: frozenset[str]) -> bool:
    """Return whether an equation has a constant of its own, or a time: what its derivative leaves open."""
    constants = [k.name for k in lettered(q.letters).values() if not k.moving]
    return (q.left - q.right).has(TIME) or not new.isdisjoint(constants)


# -- views of an equation ------------------------------------------------------------------------------


def _itself(q: Equal) -> Equal:
    return q


def _rate(q: Equal) -> Equal:
    return Equal(rate(q.left), rate(q.right))


def _rates(q: Equal, rules: Rules) -> list[View]:
    """Return the derivatives of an equation by the time that may follow where it does not."""
    if q.whole is not None:
        return []
    names = {k.name for k in lettered(q.letters).values() if k.moving} & rules.known.keys()
    orders = [rules.known[n].order for n in names]
    return [_rate, lambda q: _rate(_rate(q))][: min(filter(None, orders), default=0)]


def _squares(q: Equal) -> list[View]:
    """Return the squares of both sides where one has a root: what is below it is linear there."""
    rooted = any(p.exp == sp.S.Half for e in (q.left, q.right) for p in e.atoms(sp.Pow))
    return [lambda q: Equal(q.left**2, q.right**2)] if rooted else []


# -- frequencies ---------------------------------------------------------------------------------------


def frequency(known: Known, number: int, q: Equal, new: frozenset[str]) -> Followed | None:
    """Return that a new letter is a frequency of what moves by the rules, or would be but for a slip."""
    letters = lettered(q.letters)
    unknown = [s for s, k in letters.items() if k.name in new]
    if len(unknown) != 1 or q.whole is not None or _changing(letters, unknown[0]):
        return None
    for rules in known.sets:
        with suppress(*FAILS):
            one = mode(q, rules, unknown[0])
            if one is not None:
                return Followed(one.sources | sources(rules, q), how=one.form)
    if not FREQUENCY.search(known.words[number]):
        return None
    return next(_slips_of_frequencies(known, q, unknown[0]), None)


def _changing(letters: dict[Expr, Letter], unknown: Expr) -> bool:
    """Return whether an equation has a rate of the unknown, or others that change."""
    return letters[unknown].order > 0 or any(
        k.kind == CHANGES for s, k in letters.items() if s != unknown
    )


def _slips_of_frequencies(known: Known, q: Equal, unknown: Expr) -> Iterator[Followed]:
    for rules in known.sets:
        for one in modes(rules, unknown):
            for view in (_itself, *_squares(q)):
                with suppress(*FAILS):
                    what = slip(q, one.points, view=view)
                    if what is not None:
                        yield Followed(one.sources | sources(rules, q), what, how=one.form)


def _empties(known: Known, q: Equal, at: Sequence[Point]) -> bool:
    """Return whether all terms vanish, or one at points of a special case that does not elsewhere.

    Of an equation with vectors this has to be so in all components.
    """
    if q.whole is not None:
        return all(_empties(known, replace(e, whole=None), at) for e in q.whole.equations)
    terms = [t for side in (q.left, q.right) for t in sp.Add.make_args(side) if t != 0]
    general = points(known.rules)
    empty = [all(abs(p.of(t)) < NOTHING for p in at) for t in terms]
    return all(empty) or any(
        e and any(abs(p.of(t)) > NOTHING for p in general)
        for e, t in zip(empty, terms, strict=True)
    )
