"""The lines of a note in order: which follow from those before, which would but for a slip.

A line that brings a letter in says what that is; one that follows from nothing is taken for what it says,
and what comes behind may rest on it. What a sentence says holds for the displays around it. Where a
Lagrangian is known, lines may rest on its equations.

A line that fails but for a slip is wrong where each line that it rests on is confirmed by as many others
as contradict it, two at least; else it or one of these is.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

import sympy as sp

from eom.checker.consequence.letters import (
    Equal,
    Expr,
    Letters,
    is_component,
    jet,
    letter,
    partial,
    timed,
)
from eom.checker.consequence.rules import (
    Point,
    Rules,
    agrees,
    agrees_but_for_signs,
    lone,
    points,
    solved,
)
from eom.checker.consequence.slips import Slip, slip
from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.judge.notes import Understood
from eom.checker.judge.verdicts import GRAVE
from eom.checker.mean.claims import DEFINITION
from eom.checker.mean.roles import ASSUMPTION
from eom.errors import InputError

FAILS = (InputError, ZeroDivisionError, ValueError, TypeError, OverflowError)
SETTLED = frozenset({HOLDS, UNDER, DEFINITION, ASSUMPTION})
LAGRANGIANS = ("L",)
FIRM = 2
"""Lines that follow from one by which it is likelier to be right than a line that does not."""


@dataclass(frozen=True)
class Followed:
    """What is found of a line: the formulas that it follows from, and its slip, if it has one.

    ``sure``: whether no line that it rests on is likelier to have the slip; ``under``: those of the
    formulas that nothing decides.
    """

    sources: frozenset[int]
    slip: Slip | None = None
    sure: bool = True
    under: frozenset[int] = frozenset()


@dataclass
class _Note:
    """What is known so far: of lines what was found of each of their equations, None for nothing.

    ``rules``: what lines say that bring a letter in; ``aside``: what sentences say; ``weak``: what lines
    say of letters that stand before, which may be meant of a special case.
    """

    letters: Letters
    rules: Rules = field(default_factory=Rules)
    seen: set[str] = field(default_factory=set)
    aside: list[tuple[int, Equal]] = field(default_factory=list)
    found: dict[int, list[Followed | None]] = field(default_factory=dict)
    brought: set[int] = field(default_factory=set)
    used: set[int] = field(default_factory=set)
    of_line: dict[int, frozenset[Expr]] = field(default_factory=dict)
    weak: list[list[tuple[int, Equal]]] = field(default_factory=list)
    lagrangian: tuple[Expr, int] | None = None
    key: tuple[object, ...] = ()
    sets: list[Rules] = field(default_factory=list)
    more: Iterator[Rules] = field(default_factory=lambda: iter(()))


def followed(
    letters: Letters,
    understood: Sequence[Understood],
    verdicts: Sequence[str],
    open_: Iterable[int],
) -> Mapping[int, Followed]:
    """Return what follows from earlier lines, of those that are ``open_``, by number."""
    note = _Note(letters)
    wanted, whole = frozenset(open_), set()
    displays = [k for k, u in enumerate(understood) if u.formula.piece.kind == "display"]
    for number, (one, verdict) in enumerate(zip(understood, verdicts, strict=True)):
        if verdict in GRAVE:
            continue
        read = note.letters.read(one.formula)
        whole |= {number} if read.whole else set()
        display = number in displays
        if display:
            note.used &= {n for n in note.used if understood[n].headings == one.headings}
            last = max((d for d in displays if d < number), default=-1)
            note.aside = [(n, q) for n, q in note.aside if n > last or n in note.used]
        for q in read.equations:
            _take(note, number, q, display=display, judged=number in wanted)
    return _settled(note, wanted, whole, verdicts)


def _settled(
    note: _Note, wanted: frozenset[int], whole: set[int], verdicts: Sequence[str]
) -> dict[int, Followed]:
    """Return what counts of what was found."""
    joined = {n: _joined(found) for n, found in note.found.items()}
    wrong = {n: f for n, f in joined.items() if f is not None and f.slip is not None}
    right = {n: f for n, f in joined.items() if f is not None and f.slip is None}
    supports = Counter(s for n, f in right.items() for s in f.sources - {n})
    against = Counter(s for n, f in wrong.items() for s in f.sources - {n})
    kept: dict[int, Followed] = {}
    for n, f in {**right, **wrong}.items():
        others = f.sources - {n}
        if n not in wanted:
            continue
        if f.slip is not None:
            firm = all(
                verdicts[s] == DEFINITION or supports[s] >= max(FIRM, against[s]) for s in others
            )
            kept[n] = Followed(f.sources, f.slip, sure=firm)
        elif n in whole:
            open_ = (s for s in others if verdicts[s] not in SETTLED and s not in note.brought)
            kept[n] = Followed(f.sources, under=frozenset(open_))
    return kept


def _joined(found: Sequence[Followed | None]) -> Followed | None:
    """Return what is found of a line with several equations: none may be open, unless one is wrong."""
    wrong = [f for f in found if f is not None and f.slip is not None]
    if wrong:
        return wrong[0]
    known = [f for f in found if f is not None]
    if len(known) < len(found) or not found:
        return None
    return Followed(frozenset().union(*(f.sources for f in known)))


def _take(note: _Note, number: int, q: Equal, *, display: bool, judged: bool) -> None:
    """Judge an equation by what is known, or take it in."""
    names = {known.name for s in q.letters if (known := letter(s)) is not None}
    new = frozenset(names - note.seen)
    note.seen |= names
    note.of_line[number] = note.of_line.get(number, frozenset()) | q.letters
    brings = bool(new & set(lone(q)))
    if brings:
        note.brought.add(number)
    if not display and not brings:
        note.aside.append((number, q))
        return
    if not brings:
        found = _found(note, q, judged=judged)
        note.found.setdefault(number, []).append(found)
        if found is not None:
            return
    elif not _is_slope(q):
        note.found.setdefault(number, []).append(None)
    _learn(note, number, q, new)


def _is_slope(q: Equal) -> bool:
    """Return whether a letter is brought in as a derivative of another."""
    return bool(q.left.has(partial) or q.right.has(partial))


def _learn(note: _Note, number: int, q: Equal, new: frozenset[str]) -> None:
    try:
        rule = solved(q, note.rules, number, new)
    except FAILS:
        return
    if rule is None:
        return
    if rule.name not in new:
        _weakly(note, number, q)
        return
    note.rules.add(rule)
    if rule.name in LAGRANGIANS and any(
        k and k.order for k in map(letter, rule.value.free_symbols)
    ):
        note.lagrangian = (jet(rule.name), number)


def _weakly(note: _Note, number: int, q: Equal) -> None:
    """Keep an equation as a premise that may be meant of a special case; with components, their others."""
    last = note.weak[-1][-1][1].whole if note.weak else None
    if q.whole is None or last is None or last.statement is not q.whole.statement:
        note.weak.append([])
    note.weak[-1].append((number, q))


def _found(note: _Note, q: Equal, *, judged: bool) -> Followed | None:
    """Return that an equation follows, or would but for a slip; None for neither."""
    tried = []
    for rules in _sets(note):
        try:
            at = points(rules)
            exact = agrees(q, at)
            if (exact or agrees_but_for_signs(q, at)) and not _empties(note, q, at):
                note.used |= {n for n, _ in note.aside} & _sources(rules, q)
                note.rules.signs += [] if exact else [q]
                return Followed(_sources(rules, q))
            tried.append(rules)
        except FAILS:
            continue
    for rules in tried if judged else ():
        try:
            found = slip(q, rules, _around(note, rules, q))
            sources = frozenset() if found is None else _sources(rules, found.mended)
        except FAILS:
            continue
        if sources:
            return Followed(sources, found)
    return None


def _empties(note: _Note, q: Equal, at: Sequence[Point]) -> bool:
    """Return whether a term vanishes at points of a special case that does not elsewhere.

    Of an equation with vectors this has to be so in all components.
    """
    if q.whole is not None:
        return all(_empties(note, replace(e, whole=None), at) for e in q.whole.equations)
    terms = [t for side in (q.left, q.right) for t in sp.Add.make_args(side) if t != 0]
    general = points(note.rules)
    return any(
        all(abs(p.of(t)) < SMALL for p in at) and any(abs(p.of(t)) > SMALL for p in general)
        for t in terms
    )


SMALL = 1e-25


def _around(note: _Note, rules: Rules, q: Equal) -> frozenset[Expr]:
    """Return the letters of the formulas that an equation may rest on."""
    own = note.of_line
    found = frozenset().union(*(own.get(n, frozenset()) for n in _sources(rules, q)))
    return frozenset(s for s in found if not is_component(s))


def _sets(note: _Note) -> Iterator[Rules]:
    """Yield rules: of lines that bring letters in, and with what else is said, the nearest first.

    They are kept as long as nothing else is known.
    """
    premises = (*note.aside, *(w for one in note.weak for w in one))
    known = tuple(note.rules.known.values()), tuple(note.rules.signs)
    key = known, premises, note.lagrangian
    if key != note.key:
        note.key, note.sets, note.more = key, [], _made_sets(note)
    k = 0
    while k < len(note.sets) or (found := next(note.more, None)) is not None:
        if k == len(note.sets):
            note.sets.append(found)
        yield note.sets[k]
        k += 1


def _made_sets(note: _Note) -> Iterator[Rules]:
    yield note.rules
    laws = [] if note.lagrangian is None else list(_lagrange(note, *note.lagrangian))
    last = note.weak[: -MAX_WEAK - 1 : -1]
    more = [
        note.aside,
        *last,
        laws,
        [*note.aside, *(w for one in last[::-1] for w in one)],
        [*note.aside, *laws],
    ]
    for added in {tuple(id(q) for _, q in m): m for m in more if m}.values():
        rules = note.rules.copy()
        for n, q in added:
            with suppress(*FAILS):
                rule = solved(q, rules, n, frozenset())
                if rule is not None:
                    rules.add(rule)
        yield rules


MAX_WEAK = 3
"""Lines on letters that stand before which are tried as premises, the last ones first."""


def _lagrange(note: _Note, function: Expr, number: int) -> Iterator[tuple[int, Equal]]:
    """Yield Lagrange's equations."""
    try:
        full, _ = note.rules.normal(function)
    except FAILS:
        return
    known = [k for k in map(letter, full.free_symbols) if k is not None]
    for name in sorted({k.name for k in known if k.order == 1}):
        q, v = jet(name), jet(name, 1)
        yield number, Equal(timed(partial(function, v)), partial(function, q))


def _sources(rules: Rules, q: Equal) -> frozenset[int]:
    return frozenset().union(*(rules.normal(e)[1] for e in (q.left, q.right)))
