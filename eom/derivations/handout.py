"""One page of a derivation: its results, and the key steps that they hang on, with their reasons.

A result is a line that no later one follows from. Results are chosen that together rest on as much of the
derivation as can be. A key step is a line that results hang on, the more the better. Both are read off
what each step follows from; as many as a page holds are shown, in their order, numbered as in the whole.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial

from eom.derivations.showing import (
    Shown,
    assumption_in_words,
    capitalised,
    letters_of,
    lines_of,
    numbers,
    only_names,
)
from eom.derivations.steps import Step
from eom.derivations.wording import letters_in_words
from eom.terms.terms import Term
from eom.typeset.blocks import Block, Heading, Line, Note, Paragraph, Steps
from eom.typeset.breaking import height
from eom.typeset.letters import Notation
from eom.typeset.pages import handout_lines
from eom.typeset.sentences import phrases

PAGE = 62.0
"""Lines that a page holds below its title."""
SHARE = 0.85
"""The part of them that results may take."""
_WORDS, _GAP = 108, 1.0
"""Letters of a line of words; the room around a formula, in lines."""


def handout(derivation: Shown, notation: Notation) -> Iterator[Block]:
    """Yield the blocks of one page: title, assumptions, results and key steps."""
    known = letters_in_words(derivation, notation)
    numbered = numbers(derivation, notation)
    steps = key_steps(derivation, notation)
    letters = {
        a: k for a, k in letters_of(derivation).items() if any(a in s.assumptions for s in steps)
    }
    yield Heading(derivation.title, 1)
    yield Paragraph(
        f"{len(steps)} of {len(numbered)} verified steps, numbered as in the whole: the results, and what "
        f"most of them hang on. Notation: {notation.title}."
    )
    if letters:
        said = "; ".join(f"(A{k}) {assumption_in_words(a, letters)}" for a, k in letters.items())
        yield Paragraph(phrases(f"Assumed: {said}.", known))
    for step in steps:
        under = ", ".join(f"A{letters[a]}" for a in letters if a in step.assumptions)
        words = phrases(capitalised(step.reason, known), known)
        note = Note(numbered[step.label], words, under)
        yield Steps((note,), (lines_of(step.statement, notation),))


def key_steps(derivation: Shown, notation: Notation) -> list[Step]:
    """Return the results and key steps that fit on a page, in their order."""
    spoken = [s for s in derivation.steps if not only_names(s, notation)]
    size = partial(_height, notation=notation)
    results = list(_results(derivation, spoken))
    chosen = _covering(results, SHARE * _room(derivation), behind(derivation), size)
    room = _room(derivation) - sum(map(size, chosen))
    chosen += _fitting(_bearing(derivation, spoken, chosen), room, size)
    return [s for s in spoken if s in chosen]


def _covering(
    results: list[Step],
    room: float,
    rests: Mapping[str, frozenset[str]],
    size: Callable[[Step], float],
) -> list[Step]:
    """Return results that together rest on as many lines as can be, for the room that they take.

    Of two that say the same of other axes the second adds little, and gives way.
    """
    sizes = {s.label: size(s) for s in results}
    chosen: list[Step] = []
    covered: frozenset[str] = frozenset()
    left = list(results)
    while left := [s for s in left if sizes[s.label] <= room]:
        gains = [len((rests[s.label] | {s.label}) - covered) / sizes[s.label] for s in left]
        best = left.pop(gains.index(max(gains)))
        chosen.append(best)
        covered |= rests[best.label] | {best.label}
        room -= sizes[best.label]
    return chosen


def _room(derivation: Shown) -> float:
    """Return the lines of a page that assumptions leave."""
    letters = letters_of(derivation)
    words = sum(len(assumption_in_words(a, letters)) + 8 for a in letters)
    return PAGE - words / _WORDS


def behind(derivation: Shown) -> Mapping[str, frozenset[str]]:
    """Return the labels of all lines that each step follows from, directly or not."""
    found: dict[str, frozenset[str]] = {}
    for step in derivation.steps:
        sources = [f for f in step.follows if f in found]
        found[step.label] = frozenset(sources).union(*(found[f] for f in sources))
    return found


def _results(derivation: Shown, spoken: Iterable[Step]) -> Iterator[Step]:
    """Yield the lines that nothing follows from; of a chain with one left side, the last."""
    used = {f for s in derivation.steps for f in s.follows}
    last: dict[Term, str] = {s.statement.left: s.label for s in derivation.steps}
    for s in spoken:
        if s.kind == "result" and s.label not in used and last[s.statement.left] == s.label:
            yield s


def _bearing(derivation: Shown, spoken: Iterable[Step], results: list[Step]) -> list[Step]:
    """Return the lines that results hang on, those first on which most do; then the later ones."""
    rests = behind(derivation)
    order = {s.label: k for k, s in enumerate(derivation.steps)}
    counted = {
        s.label: sum(s.label in rests[r.label] for r in results)
        for s in spoken
        if s not in results and s.kind != "definition"
    }
    found = [s for s in spoken if counted.get(s.label)]
    return sorted(found, key=lambda s: (-counted[s.label], -order[s.label]))


def _fitting(steps: Iterable[Step], room: float, size: Callable[[Step], float]) -> Iterator[Step]:
    """Yield steps as long as there is room for them."""
    for step in steps:
        needed = size(step)
        if needed <= room:
            room -= needed
            yield step


def _height(step: Step, notation: Notation) -> float:
    """Return about how many lines a step takes on paper."""
    words = 1 + (len(step.reason) + 12) // _WORDS
    lines = (p for line in lines_of(step.statement, notation) for p in handout_lines(line))
    return words + _GAP + sum(map(_line_height, lines))


def _line_height(line: Line) -> float:
    return max(map(height, (*line.right, *(() if line.left is None else (line.left,)))))
