"""The lines of a note in order: which follow from those before, which would but for a slip.

A line that brings a letter in says what that is; one that follows from nothing is taken for what it says,
and what comes behind may rest on it. What a sentence says holds for the displays around it. Where a
Lagrangian is known, lines may rest on its equations.

A line that fails but for a slip is wrong where each line that it rests on is confirmed by as many others
as contradict it, two at least; else it or one of these is.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import groupby, product

import sympy as sp

from eom.checker.consequence.letters import (
    CHANGES,
    MAY,
    TIME,
    Equal,
    Expr,
    Letters,
    derived,
    is_component,
    jet,
    letter,
    partial,
    rate,
    timed,
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
    solved,
)
from eom.checker.consequence.slips import Slip, View, slip
from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.judge.notes import Understood
from eom.checker.judge.verdicts import GRAVE
from eom.checker.mean.claims import DEFINITION
from eom.checker.mean.roles import ASSUMPTION
from eom.errors import InputError
from eom.limits import check

FAILS = (InputError, ZeroDivisionError, ValueError, TypeError, OverflowError)
SETTLED = frozenset({HOLDS, UNDER, DEFINITION, ASSUMPTION})
LAGRANGIANS = ("L", "cal L", "calligraphic L", "script L")
KINETIC = ("T", "K", "E_kin", "E_k", "E_K", "T_kin", "E_c", "W_kin")
POTENTIAL = ("V", "U", "P", "E_pot", "E_p", "E_P", "V_pot", "W_pot", "Pi")
FIRM = 1
"""Equations that follow from one by which it is likelier to be right than one that does not."""


@dataclass(frozen=True)
class Followed:
    """What is found of a line: the formulas that it follows from, and its slip, if it has one.

    ``sure``: whether no line that it rests on is likelier to have the slip; ``under``: those of the
    formulas that nothing decides; ``held``: letters that are taken not to change.
    """

    sources: frozenset[int]
    slip: Slip | None = None
    sure: bool = True
    under: frozenset[int] = frozenset()
    how: str = ""
    held: frozenset[Expr] = frozenset()


FIRST_ORDER = "first order"
RATE = "rate"
"""How a line follows of which only the derivative does: but for what it is at one time."""


@dataclass
class _Note:
    """What is known so far: of lines what was found of each of their equations, None for nothing.

    ``rules``: what lines say that bring a letter in; ``aside``: what sentences say; ``weak``: what lines
    say of letters that stand before, which may be meant of a special case. ``words``: what stands before
    each formula.
    """

    letters: Letters
    words: Sequence[str] = ()
    rules: Rules = field(default_factory=Rules)
    seen: set[str] = field(default_factory=set)
    aside: list[tuple[int, Equal]] = field(default_factory=list)
    found: dict[int, list[Followed | None]] = field(default_factory=dict)
    brought: set[int] = field(default_factory=set)
    vectors: set[int] = field(default_factory=set)
    used: set[int] = field(default_factory=set)
    all_letters: frozenset[Expr] = frozenset()
    weak: list[tuple[int, Equal]] = field(default_factory=list)
    lagrangian: tuple[Expr, int] | None = None
    sets: tuple[tuple[object, ...], list[Rules]] | None = None


def followed(
    letters: Letters,
    understood: Sequence[Understood],
    verdicts: Sequence[str],
    open_: Iterable[int],
    words: Sequence[str],
) -> Mapping[int, Followed]:
    """Return what follows from earlier lines, of those that are ``open_``, by number.

    ``words``: what stands before each formula.
    """
    reads = [letters.read(u.formula) for u in understood]
    all_letters = frozenset(s for r in reads for q in r.equations for s in q.letters if not is_component(s))
    note = _Note(letters, words, all_letters=all_letters)
    wanted, whole = frozenset(open_), set()
    displays = [k for k, u in enumerate(understood) if u.formula.piece.kind == "display"]
    for number, (one, verdict) in enumerate(zip(understood, verdicts, strict=True)):
        if verdict in GRAVE:
            continue
        read = reads[number]
        whole |= {number} if read.whole else set()
        display = number in displays
        if number and understood[number - 1].headings != one.headings:
            _begin_part(note)
        if display:
            note.used &= {n for n in note.used if understood[n].headings == one.headings}
            last = max((d for d in displays if d < number), default=-1)
            note.aside = [(n, q) for n, q in note.aside if n > last or n in note.used]
        for q in read.equations:
            _take(note, number, q, display=display, judged=number in wanted)
    return _settled(note, wanted, whole, verdicts)


def _begin_part(note: _Note) -> None:
    """Forget how what the last part was about moves; what letters were said to be is kept."""
    for name in [n for n, r in note.rules.known.items() if r.order or not r.given]:
        del note.rules.known[name]
    note.rules = note.rules.copy()
    note.weak = []


def _settled(
    note: _Note, wanted: frozenset[int], whole: set[int], verdicts: Sequence[str]
) -> dict[int, Followed]:
    """Return what counts of what was found."""
    joined = {n: _joined(found) for n, found in note.found.items()}
    wrong = {n: f for n, f in joined.items() if f is not None and f.slip is not None}
    right = {n: f for n, f in joined.items() if f is not None and f.slip is None}
    each = [f for n, found in note.found.items() for f in _counted(found, n in note.vectors)]
    supports = Counter(s for f in each if f.slip is None for s in f.sources)
    supports.update(n for n in note.brought for f in note.found.get(n, ()) if f and f.slip is None)
    against = Counter(s for f in each if f.slip is not None for s in f.sources)
    kept: dict[int, Followed] = {}
    for n, f in {**right, **wrong}.items():
        others = f.sources - {n}
        if n not in wanted:
            continue
        if f.slip is not None:
            firm = all(
                verdicts[s] == DEFINITION or supports[s] >= max(FIRM, against[s]) for s in others
            )
            kept[n] = replace(f, sure=firm)
        elif n in whole:
            open_ = (s for s in others if verdicts[s] not in SETTLED and s not in note.brought)
            kept[n] = replace(f, under=frozenset(open_))
    return kept


def _counted(found: Sequence[Followed | None], vectors: bool) -> list[Followed]:
    """Return what counts for or against other lines: of a line with vectors no component by itself."""
    known = [f for f in found if f is not None]
    slips = [f for f in known if f.slip is not None]
    return list(dict.fromkeys(slips or known)) if vectors else known


def _joined(found: Sequence[Followed | None]) -> Followed | None:
    """Return what is found of a line with several equations: none may be open, unless one is wrong."""
    wrong = [f for f in found if f is not None and f.slip is not None]
    if wrong:
        return wrong[0]
    known = [f for f in found if f is not None]
    if len(known) < len(found) or not found:
        return None
    how = max((f.how for f in known), key=len)
    sources, held = (
        frozenset().union(*sets)
        for sets in ([f.sources for f in known], [f.held for f in known])
    )
    return Followed(sources, how=how, held=held)


def _take(note: _Note, number: int, q: Equal, *, display: bool, judged: bool) -> None:
    """Judge an equation by what is known, or take it in."""
    check()
    names = {known.name for s in q.letters if (known := letter(s)) is not None}
    new = frozenset(names - note.seen)
    note.seen |= names
    note.vectors |= {number} if q.whole is not None else set()
    for rule in (*_alike(note, q), *_speeds(note, q)):
        note.rules.add(rule)
    brings = bool(new & set(lone(q))) and (display or not _is_value(q))
    if brings:
        note.brought.add(number)
    if not display and not brings and _begins(q, note.words[number]):
        return
    if not display and not brings:
        note.aside = [(n, o) for n, o in note.aside if n == number or o.letters != q.letters]
        note.aside.append((number, q))
        return
    found = _as_mode(note, number, q, new)
    if not brings:
        found = found or _found(note, number, q, new, judged=judged)
    if found or not brings or not _is_slope(q):
        note.found.setdefault(number, []).append(found)
    if found is None and not q.near:
        _learn(note, number, q, new)
    elif found is not None and found.slip is None and found.how == RATE:
        _learn(note, number, q, frozenset(lone(q)))
    elif found is not None and found.how == FIRST_ORDER:
        note.weak.append((number, q))


def _alike(note: _Note, q: Equal) -> list[Rule]:
    r"""Return what letters stand for by the pattern of others: c_{12}, where c_1 = \cos q_1."""
    known = [r for r in note.rules.known.values() if isinstance(r.value, sp.sin | sp.cos)]
    patterns = {}
    for rule in known:
        one = _NUMBERED.fullmatch(rule.name)
        angles = [_NUMBERED.fullmatch(k.name) for k in map(letter, rule.value.free_symbols) if k]
        if one and all(angles) and {a[2] for a in angles if a} == set(one[2]):
            patterns[one[1]] = rule
    found = []
    for s in q.letters:
        own = _NUMBERED.fullmatch(letter(s).name)
        like = patterns.get(own[1]) if own and own[0] not in note.rules.known else None
        if own and like:
            (angle, *_) = like.value.free_symbols
            base = letter(angle).name[: -len(_NUMBERED.fullmatch(letter(angle).name)[2])]
            terms = [jet(base + n, 0, letter(angle).kind) for n in own[2]]
            found.append(Rule(own[0], 0, like.value.func(sp.Add(*terms)), like.sources))
    return found


_NUMBERED = re.compile(r"(.+_)(\d+|[ijk])")


def _speeds(note: _Note, q: Equal) -> list[Rule]:
    """Return that a new v_2 is the speed of what has the coordinates x_2, y_2."""
    found = []
    for s in q.letters:
        known = letter(s)
        label = known.name[1:] if known and known.name[0] == "v" and known.kind == MAY else None
        names = [n + label for n in "xyz" if n + label in note.rules.known] if label else []
        if len(names) > 1 and known.name not in note.rules.known:
            rates = [jet(n, 1) for n in names]
            sources = frozenset().union(*(note.rules.normal(r)[1] for r in rates))
            squares = sp.Add(*(r**2 for r in rates))
            found.append(Rule(known.name, 0, sp.sqrt(squares), sources, squared=True))
    return found


def _is_value(q: Equal) -> bool:
    """Return whether an equation gives a number: in a sentence that is a case, nothing that a letter means."""
    return bool(q.left.is_number or q.right.is_number)


def _begins(q: Equal, words: str) -> bool:
    """Return whether an equation in a sentence says what a letter is at the start alone."""
    plain = all(e.is_Symbol or e.is_number for e in (q.left, q.right))
    return plain and bool(INITIAL.search(words))


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
        note.weak.append((number, q))
        return
    note.rules.add(replace(rule, given=rule.name in set(lone(q))))
    if rule.name in LAGRANGIANS and _is_moving(rule):
        own = next(s for s in q.letters if letter(s).name == rule.name)
        note.lagrangian = (own, number)


def _found(
    note: _Note, number: int, q: Equal, new: frozenset[str], *, judged: bool
) -> Followed | None:
    """Return that an equation follows, or would but for a slip; None for neither."""
    sets = _sets(note)
    for rules in sets:
        with suppress(*FAILS):
            at = points(rules)
            exact = agrees(q, at)
            if (exact or agrees_but_for_signs(q, at)) and not _empties(note, q, at):
                note.used |= {n for n, _ in note.aside} & _sources(rules, q)
                note.rules.signs += [] if exact else [q]
                return Followed(_sources(rules, q), held=_held(rules, q))
    views = [_itself, *_rates(q, note.rules)]
    small = q.near or SMALLNESS.search(note.words[number])
    for rules in sets if small and any(letter(s).order > 1 for s in q.letters) else ():
        with suppress(*FAILS):
            if agrees_nearly(q, rules):
                return Followed(_sources(rules, q), how=FIRST_ORDER)
    if q.near:
        return None
    for k, (view, rules) in enumerate(product(views, sets)):
        with suppress(*FAILS):
            asked = view(q)
            at = points(rules)
            if k >= len(sets) and agrees(asked, at) and not _empties(note, asked, at):
                if not _says_when(q, new):
                    return None
                return Followed(_sources(rules, asked), how=RATE, held=_held(rules, asked))
    for rules in sets:
        with suppress(*FAILS):
            sources = _solves(note, rules, q)
            if sources:
                return Followed(sources, how=RATE)
    for view, rules in product([*views, *_squares(q)], sets) if judged else ():
        with suppress(*FAILS):
            found = slip(q, points(rules), note.all_letters, view)
            sources = frozenset() if found is None else _sources(rules, view(found.mended))
            if sources:
                return Followed(sources, found)
    return None


def _rates(q: Equal, rules: Rules) -> list[View]:
    """Return the derivatives of an equation by the time that may follow where it does not."""
    if q.whole is not None:
        return []
    known = {k.name for k in map(letter, q.letters) if k is not None and k.moving}
    orders = [rules.known[n].order for n in known if n in rules.known]
    return [_rate, lambda q: _rate(_rate(q))][: min(filter(None, orders), default=0)]


def _itself(q: Equal) -> Equal:
    return q


def _squares(q: Equal) -> list[View]:
    """Return the squares of both sides where one has a root: what is below it is linear there."""
    rooted = any(p.exp == sp.S.Half for e in (q.left, q.right) for p in e.atoms(sp.Pow))
    return [lambda q: Equal(q.left**2, q.right**2)] if rooted else []


def _solves(note: _Note, rules: Rules, q: Equal) -> frozenset[int]:
    """Return the formulas of the equation of motion that a motion in closed form solves; none if none."""
    for name in lone(q):
        old = rules.known.get(name)
        sides = (q.left, q.right) if getattr(letter(q.left), "name", "") == name else (q.right, q.left)
        if old is None or not old.order or not sides[1].has(TIME):
            continue
        put_in = rules.copy()
        put_in.add(Rule(name, 0, sides[1], frozenset()))
        asked = Equal(derived(sides[0], old.order), old.value)
        at = points(put_in)
        if agrees(asked, at) and not _empties(note, asked, at):
            return old.sources | _sources(put_in, asked)
    return frozenset()


def _rate(q: Equal) -> Equal:
    return Equal(rate(q.left), rate(q.right))


def _says_when(q: Equal, new: frozenset[str]) -> bool:
    """Return whether an equation has a constant of its own, or a time: what its derivative leaves open."""
    known = [k for k in map(letter, q.letters) if k is not None and not k.moving]
    return (q.left - q.right).has(TIME) or any(k.name in new for k in known)


def _as_mode(note: _Note, number: int, q: Equal, new: frozenset[str]) -> Followed | None:
    """Return that a letter is a frequency of what moves by the rules, or would be but for a slip."""
    unknown = [s for s in q.letters if letter(s).name in new]
    changing = any(letter(s).kind == CHANGES for s in q.letters - {*unknown})
    if len(unknown) != 1 or letter(unknown[0]).order or changing or q.whole is not None:
        return None
    sets = _sets(note)
    for rules in sets:
        with suppress(*FAILS):
            found = mode(q, rules, unknown[0])
            if found is not None:
                return Followed(found.sources | _sources(rules, q), how=found.form)
    for rules in sets if FREQUENCY.search(note.words[number]) else ():
        for one in modes(rules, unknown[0]):
            with suppress(*FAILS):
                views = [_itself, *_squares(q)]
                found = next(filter(None, (slip(q, one.points, view=v) for v in views)), None)
                if found is not None:
                    return Followed(one.sources | _sources(rules, q), found, how=one.form)
    return None


SMALLNESS = re.compile(r"\bsmall|lineari[sz]|to first order|approximat", re.IGNORECASE)
"""Words before equations of motion that hold for small motions."""
INITIAL = re.compile(r"release|initial|\brest\b|\bstart|\bbeg[ia]n|at time|at the time", re.IGNORECASE)
"""Words before equations that hold at one time alone."""
FREQUENCY = re.compile(r"frequenc|period|eigen|oscillat|mode\b|modes\b|nutation|libration", re.IGNORECASE)
"""Words before a line that says how fast something oscillates."""


def _empties(note: _Note, q: Equal, at: Sequence[Point]) -> bool:
    """Return whether all terms vanish, or one at points of a special case that does not elsewhere.

    Of an equation with vectors this has to be so in all components.
    """
    if q.whole is not None:
        return all(_empties(note, replace(e, whole=None), at) for e in q.whole.equations)
    terms = [t for side in (q.left, q.right) for t in sp.Add.make_args(side) if t != 0]
    general = points(note.rules)
    empty = [all(abs(p.of(t)) < SMALL for p in at) for t in terms]
    return all(empty) or any(
        e and any(abs(p.of(t)) > SMALL for p in general) for e, t in zip(empty, terms, strict=True)
    )


SMALL = 1e-25


def _sets(note: _Note) -> list[Rules]:
    """Return rules: of lines that bring letters in, and with what else is said, the nearest first."""
    key = (id(note.rules), len(note.rules.signs), *map(id, note.rules.known.values()))
    key += (*(id(q) for _, q in (*note.aside, *note.weak)), note.lagrangian)
    if note.sets is None or note.sets[0] != key:
        note.sets = key, list(_made(note))
    return note.sets[1]


def _made(note: _Note) -> Iterator[Rules]:
    yield note.rules
    function = note.lagrangian or _energies(note)
    laws = [] if function is None else list(_lagrange(note, *function))
    weak = [list(ws) for _, ws in groupby(note.weak, lambda w: w[0])][-MAX_WEAK:]
    last = [w for ws in weak[::-1] for w in ws[::-1]]
    more = [
        note.aside,
        *weak[::-1],
        laws,
        [*note.aside, *last[::-1]],
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


def _energies(note: _Note) -> tuple[Expr, int] | None:
    """Return the kinetic less the potential energy, where a note gives both and no Lagrangian."""
    known = note.rules.known
    kinetic = next((n for n in KINETIC if n in known and _is_moving(known[n])), None)
    potential = next((n for n in POTENTIAL if n in known), None)
    if kinetic is None or potential is None:
        return None
    of = {letter(s).name: derived(s, 0) for s in note.all_letters}
    return of[kinetic] - of[potential], max(known[kinetic].sources)


def _is_moving(rule: Rule) -> bool:
    return any(k and k.order for k in map(letter, rule.value.free_symbols))


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


def _held(rules: Rules, q: Equal) -> frozenset[Expr]:
    """Return the letters without dots of which an equation has derivatives once rules are put in."""
    full = [rules.normal(e)[0] for e in (q.left, q.right)]
    known = [(s, letter(s)) for e in full for s in e.free_symbols]
    return frozenset(derived(s, 0) for s, k in known if k and k.kind == MAY and k.order)


def _sources(rules: Rules, q: Equal) -> frozenset[int]:
    return frozenset().union(*(rules.normal(e)[1] for e in (q.left, q.right)))
