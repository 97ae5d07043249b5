"""An exercise: a few lines of a derivation, of which one is false, and the proof that it is that one.

A line and a slip are drawn by the seed; the slip counts if the checker finds fault with that line and
with no other. Lines after it stay as they were: each of them is right by itself, whatever the line
before it, so that exactly one line of the page is false.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, replace

import eom.checker.checking as checker
from eom.checker.explanation import Counterexample
from eom.checker.report import FAULTS, Finding
from eom.derivation import Derivation, Step
from eom.errors import InputError, unknown_name
from eom.exercises import page, slips
from eom.exercises.lessons import Lesson, lesson
from eom.exercises.slips import Planted
from eom.notation import notation_named
from eom.verification import verify

LINES = 6
"""Lines of an exercise where nobody says how many."""
MOST_LINES = 40
TRIES = 40
"""Slips that are shown to the checker at most."""
DOUBTFUL = frozenset({*FAULTS, "ambiguous"})


@dataclass(frozen=True)
class Exercise:
    """Lines of which one is false, and its key.

    ``right``: the lines as they are derived; ``number``: of the false one, from 1; ``planted``: the slip
    in it; ``counterexample``: a state in small numbers at which the line fails, if one was found.
    """

    lesson: Lesson
    seed: int
    notation: str
    right: Derivation
    number: int
    planted: Planted
    finding: Finding

    @property
    def wrong(self) -> Derivation:
        """The lines that the student sees."""
        return _with_slip(self.right, self.number, self.planted)

    @property
    def step(self) -> Step:
        """The line as it is right."""
        return self.right.steps[self.number - 1]

    @property
    def counterexample(self) -> Counterexample | None:
        """A state in small numbers at which the line fails."""
        return self.finding.explanation.counterexample


def exercise(
    topic: str, seed: int = 0, *, notation: str = "arrow", lines: int = LINES, slip: str = ""
) -> Exercise:
    """Return the exercise of a topic and seed; the same arguments give the same exercise.

    notation: one of `eom.notation.NOTATIONS`; lines: at most so many; slip: a kind of slip, "" for any.
    Raises `InputError` for unknown names, and where no slip can be planted that the checker finds.
    """
    notation = notation_named(notation).name
    if slip and slip not in slips.names():
        raise unknown_name("kind of slip", slip, slips.names())
    if not 2 <= lines <= MOST_LINES:
        raise InputError("wrong number of lines", got=lines, expected=f"2 to {MOST_LINES}")
    about = lesson(topic)
    rng = random.Random(f"{topic} {seed} {lines} {slip}")  # noqa: S311 - the same for ever
    for tried, (right, number, planted) in enumerate(_drawn(about, rng, lines, slip)):
        if tried == TRIES:
            break
        found = judged(about, right, number, planted, notation)
        if found is not None:
            return Exercise(about, seed, notation, right, number, planted, found)
    raise InputError(
        "no slip was found that the checker proves",
        where=topic,
        got=f"kind {slip}" if slip else "",
        hint="another seed, another kind of slip, or another topic (eom exercise --list)",
    )


def _with_slip(right: Derivation, number: int, planted: Planted) -> Derivation:
    steps = list(right.steps)
    steps[number - 1] = replace(steps[number - 1], statement=planted.equation)
    return replace(right, steps=tuple(steps))


# -- drawing ------------------------------------------------------------------------------------------


def _drawn(
    about: Lesson, rng: random.Random, lines: int, slip: str
) -> Iterator[tuple[Derivation, int, Planted]]:
    """Yield lines, the number of one of them, and a false equation for it; kinds of slips in turn."""
    steps = about.derivation.steps
    given = slips.around(t for s in steps for t in (s.statement.left, s.statement.right))
    kinds: dict[str, list[tuple[int, Planted]]] = {}
    for k, step in enumerate(steps):
        for planted in slips.planted(step.statement, given):
            if slip in {"", planted.slip.name}:
                kinds.setdefault(planted.slip.name, []).append((k, planted))
    order = list(kinds)
    rng.shuffle(order)
    while order:
        name = order.pop(0)
        k, planted = kinds[name].pop(rng.randrange(len(kinds[name])))
        if kinds[name]:
            order.append(name)
        if _is_false(about.derivation, steps[k], planted):
            first = _first(rng, k, len(steps), lines)
            window = steps[first : first + lines]
            yield replace(about.derivation, steps=tuple(window)), k - first + 1, planted


def _first(rng: random.Random, k: int, count: int, lines: int) -> int:
    """Return where the lines begin, so that line k is among them and as many as asked for."""
    least, most = max(0, k - lines + 1), min(k, max(0, count - lines))
    return rng.randint(min(least, most), most)


def _is_false(derivation: Derivation, step: Step, planted: Planted) -> bool:
    """Tell whether an equation is not true; what cannot be decided may be false."""
    claimed = replace(planted.equation, relation="=")
    try:
        verify(claimed, step.assumptions, derivation.scalars)
    except InputError:
        return True
    return False


# -- the proof ----------------------------------------------------------------------------------------


def judged(
    about: Lesson, right: Derivation, number: int, planted: Planted, notation: str
) -> Finding | None:
    """Return what the checker says of the line with the slip; None unless it blames that one alone."""
    shown = page.lines(_with_slip(right, number, planted), notation_named(notation))
    report = checker.check(about.front(notation) + shown)
    displays = [f for f in report.findings if f.kind == "display"]
    blamed = [f for f in report.findings if f.verdict in DOUBTFUL]
    if len(displays) != len(right.steps) or len(blamed) != 1:
        return None
    found = displays[number - 1]
    told = found.verdict in FAULTS and found.explanation.counterexample is not None
    return found if blamed == [found] and told else None
