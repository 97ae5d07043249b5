"""The lines of a note in order: which follow from those before, which would but for a slip.

A line that brings a letter in says what that is; one that follows from nothing is taken for what it says,
and what comes behind may rest on it. What a sentence says holds for the displays around it.

A line that fails but for a slip is wrong where each line that it rests on is confirmed by as many others
as contradict it, one at least; else it or one of these is.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from eom.checker.consequence.jets import Equal, is_component, partial
from eom.checker.consequence.known import FIRST_ORDER, RATE, Followed, Known
from eom.checker.consequence.letters import Letters
from eom.checker.consequence.rules import lone
from eom.checker.consequence.ways import found, frequency
from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.judge.notes import Understood
from eom.checker.judge.verdicts import GRAVE
from eom.checker.mean.claims import DEFINITION
from eom.checker.mean.roles import ASSUMPTION
from eom.limits import check

SETTLED = frozenset({HOLDS, UNDER, DEFINITION, ASSUMPTION})
INITIAL = re.compile(
    r"release|initial|\brest\b|\bstart|\bbeg[ia]n|at time|at the time", re.IGNORECASE
)
"""Words before equations that hold at one time alone."""


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
    all_letters = (s for r in reads for q in r.equations for s in q.letters)
    known = Known(words, frozenset(s for s in all_letters if not is_component(s)))
    wanted, last = frozenset(open_), -1
    for number, (one, verdict) in enumerate(zip(understood, verdicts, strict=True)):
        if number and understood[number - 1].headings != one.headings:
            known.begin_part()
        display = one.formula.piece.kind == "display"
        if display:
            here = {n for n, u in enumerate(understood) if u.headings == one.headings}
            known.begin_display(last, here)
            last = number
        for q in reads[number].equations if verdict not in GRAVE else ():
            _take(known, number, q, display=display, judged=number in wanted)
    whole = {n for n, r in enumerate(reads) if r.whole}
    return _settled(known, wanted, whole, verdicts)


def _take(known: Known, number: int, q: Equal, *, display: bool, judged: bool) -> None:
    """Judge an equation by what is known, or take it in."""
    check()
    new = known.new_in(q)
    known.vectors |= {number} if q.whole is not None else set()
    brings = bool(new & set(lone(q))) and (display or not _is_value(q))
    if not display and not brings:
        if not _begins(q, known.words[number]):
            known.put_aside(number, q)
        return
    known.brought |= {number} if brings else set()
    what = frequency(known, number, q, new)
    if what is None and not brings:
        anew = not known.earlier.isdisjoint(lone(q))
        what = found(known, number, q, new, judged=judged and not anew)
    if what is not None or not brings or not _is_slope(q):
        known.found.setdefault(number, []).append(what)
    _keep(known, number, q, new, what)


def _keep(known: Known, number: int, q: Equal, new: frozenset[str], what: Followed | None) -> None:
    """Take in what a line says that does not follow from what is known already."""
    if what is None:
        if not q.near:
            known.learn(number, q, new)
    elif what.slip is None and what.how == RATE:
        known.learn(number, q, frozenset(lone(q)))
    elif what.how == FIRST_ORDER:
        known.weaken(number, q)


def _is_value(q: Equal) -> bool:
    """Return whether an equation gives a number: in a sentence that is a case, and means no letter."""
    return bool(q.left.is_number or q.right.is_number)


def _begins(q: Equal, words: str) -> bool:
    """Return whether an equation in a sentence says what a letter is at the start alone."""
    plain = all(e.is_Symbol or e.is_number for e in (q.left, q.right))
    return plain and bool(INITIAL.search(words))


def _is_slope(q: Equal) -> bool:
    """Return whether a letter is brought in as a derivative of another."""
    return bool(q.left.has(partial) or q.right.has(partial))


# -- what counts ---------------------------------------------------------------------------------------


def _settled(
    known: Known, wanted: frozenset[int], whole: set[int], verdicts: Sequence[str]
) -> dict[int, Followed]:
    """Return what counts of what was found."""
    kept: dict[int, Followed] = {}
    supports, against = _balance(known)
    for n in wanted & known.found.keys():
        what = _joined(known.found[n])
        if what is None:
            continue
        others = what.sources - {n}
        if what.slip is not None:
            firm = (
                (s >= 0 and verdicts[s] == DEFINITION) or supports[s] >= max(1, against[s])
                for s in others
            )
            kept[n] = replace(what, sure=all(firm))
        elif n in whole:
            open_ = (s for s in others if s < 0 or _is_open(known, s, verdicts))
            kept[n] = replace(what, under=frozenset(open_))
    return kept


def _is_open(known: Known, number: int, verdicts: Sequence[str]) -> bool:
    """Return whether nothing decides a line, which does not say what a letter is either."""
    return verdicts[number] not in SETTLED and number not in known.brought


def _balance(known: Known) -> tuple[Counter[int], Counter[int]]:
    """Return how many equations confirm each line, and how many contradict it."""
    each = [f for n, fs in known.found.items() for f in _counted(fs, vectors=n in known.vectors)]
    supports = Counter(s for f in each if f.slip is None for s in f.sources)
    right = (n for n in known.brought for f in known.found.get(n, ()) if f and f.slip is None)
    supports.update(right)
    return supports, Counter(s for f in each if f.slip is not None for s in f.sources)


def _counted(found: Sequence[Followed | None], *, vectors: bool) -> list[Followed]:
    """Return what counts for or against other lines: of a line with vectors no component by itself."""
    known = [f for f in found if f is not None]
    slips = [f for f in known if f.slip is not None]
    return list(dict.fromkeys(slips or known)) if vectors else known


def _joined(found: Sequence[Followed | None]) -> Followed | None:
    """Return what is found of a line with several equations: none may be open, unless one is wrong."""
    known = [f for f in found if f is not None]
    slips = [f for f in known if f.slip is not None]
    if slips or len(known) < len(found) or not found:
        return slips[0] if slips else None
    how = max((f.how for f in known), key=len)
    rests = frozenset[int]().union(*(f.sources for f in known))
    return Followed(rests, how=how, held=frozenset().union(*(f.held for f in known)))
