"""An exercise: a few lines of a derivation, of which one is false, and the proof that it is that one.

A line and a slip are drawn by the seed; the slip counts if the checker finds fault with that line and
with no other. Lines after it stay as they were: each of them is right by itself, whatever the line
before it, so that exactly one line of the page is false.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice

import eom.checker.checking as checker
from eom.checker.explanation import Counterexample
from eom.checker.report import FAULTS, Finding
from eom.derivation import Derivation, Step
from eom.errors import InputError, unknown_name
from eom.exercises import page, slips
from eom.exercises.lessons import Lesson, lesson
from eom.exercises.slips import Planted
from eom.notation import notation_named
from eom.showing import Item
from eom.terms import Equation
from eom.verification import verify

LINES = 6
"""Lines of an exercise where nobody says how many."""
LEAST_LINES, MOST_LINES = 2, 40
TRIES = 40
"""Slips that are shown to the checker at most."""
OTHERS = 4
"""False versions of the false line that are offered beside the right one."""
DOUBTFUL = frozenset({*FAULTS, "ambiguous"})


@dataclass(frozen=True)
class Exercise:
    """Lines of which one is false, and its key.

    ``right``: the lines as they are derived; ``number``: of the false one, from 1; ``planted``: the slip
    in it; ``finding``: what the checker says of the false line; ``others``: other false versions of it,
    where they were asked for, the planted one first; ``lines``, ``slip``: what was asked for.
    """

    lesson: Lesson
    seed: int
    notation: str
    right: Derivation
    number: int
    planted: Planted
    finding: Finding
    others: tuple[Equation, ...] = ()
    lines: int = LINES
    slip: str = ""

    @property
    def wrong(self) -> Derivation:
        """The lines that the student sees."""
        return _with_slip(self.right, self.number, self.planted)

    @property
    def step(self) -> Step:
        """The line as it is right."""
        return self.right.steps[self.number - 1]

    @property
    def legend(self) -> tuple[Item, ...]:
        """Symbols with their meanings, of both versions of the false line: none tells by its absence."""
        both = (*self.right.steps, self.wrong.steps[self.number - 1])
        return tuple(
            self.lesson.legend(replace(self.right, steps=both), notation_named(self.notation))
        )

    @property
    def counterexample(self) -> Counterexample | None:
        """A state in small numbers at which the line fails."""
        return self.finding.explanation.counterexample


def exercise(
    topic: str, seed: int = 0, *, notation: str = "arrow", lines: int = LINES, slip: str = ""
) -> Exercise:
    """Return the exercise of a topic and seed; the same arguments give the same exercise.

    topic: one of `eom.exercises.topics`; all others: see `planted_in`. Raises `InputError` for unknown
    names, and where no slip can be planted that the checker finds.
    """
    return planted_in(lesson(topic), seed, notation=notation, lines=lines, slip=slip)


def planted_in(
    about: Lesson, seed: int = 0, *, notation: str = "arrow", lines: int = LINES, slip: str = ""
) -> Exercise:
    """Return an exercise made from a lesson.

    notation: one of `eom.notation.NOTATIONS`; lines: at most so many; slip: a kind of slip, "" for any.
    Raises `InputError` for unknown names, and where no slip can be planted that the checker finds.
    """
    notation = notation_named(notation).name
    if slip and slip not in slips.names():
        raise unknown_name("kind of slip", slip, slips.names())
    if not LEAST_LINES <= lines <= MOST_LINES:
        raise InputError(
            "wrong number of lines", got=lines, expected=f"{LEAST_LINES} to {MOST_LINES}"
        )
    rng = random.Random(f"{about.topic} {seed} {lines} {slip}")  # noqa: S311 - the same for ever
    for right, number, planted in islice(_drawn(about, rng, lines, slip), TRIES):
        found = judged(about, right, number, planted, notation)
        if found is not None:
            return Exercise(
                about, seed, notation, right, number, planted, found, lines=lines, slip=slip
            )
    raise _nothing(about, slip)


def _nothing(about: Lesson, slip: str) -> InputError:
    """Return the error for a topic in which no slip could be planted."""
    kinds = dict.fromkeys(name for name, _, _ in _offers(about, ""))
    if slip and slip not in kinds:
        return InputError(
            f"no line of this topic can have the slip {slip}",
            where=about.topic,
            expected=", ".join(kinds) or "another topic",
        )
    return InputError(
        "no slip was found in this topic that the checker proves",
        where=about.topic,
        got=f"slip {slip}" if slip else "",
        hint="another seed, another slip, or another topic (eom exercise --list)",
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
    kinds: dict[str, list[tuple[int, Planted]]] = {}
    for name, k, planted in _offers(about, slip):
        kinds.setdefault(name, []).append((k, planted))
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


def _offers(about: Lesson, slip: str) -> Iterator[tuple[str, int, Planted]]:
    """Yield the slips of a kind, "" for all, in every line: the kind, the place of the line, the slip."""
    around = _around(about)
    for k, step in enumerate(about.derivation.steps):
        for planted in slips.planted(step.statement, around):
            if slip in {"", planted.slip.name}:
                yield planted.slip.name, k, planted


def _around(about: Lesson) -> slips.Around:
    steps = about.derivation.steps
    return slips.around(t for s in steps for t in (s.statement.left, s.statement.right))


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


def with_others(made: Exercise, count: int = OTHERS) -> Exercise:
    """Return an exercise with other false versions of its false line, each proved like the first one.

    At most ``count``, the planted one among them; lines are told apart by how they are written.
    """
    lesson, notation = made.lesson, notation_named(made.notation)
    rng = random.Random(f"{lesson.topic} {made.seed} others")  # noqa: S311 - the same for ever
    offered = list(slips.planted(made.step.statement, _around(lesson)))
    rng.shuffle(offered)
    alone = replace(made.right, steps=(made.step,))
    seen = {page.line_latex(alone, made.step, notation)}
    found: list[Equation] = []
    for planted in (made.planted, *offered[:TRIES]):
        latex = page.line_latex(alone, replace(made.step, statement=planted.equation), notation)
        if latex in seen or not _is_false(made.right, made.step, planted):
            continue
        seen.add(latex)
        if planted is made.planted or judged(lesson, alone, 1, planted, made.notation):
            found.append(planted.equation)
        if len(found) == count:
            break
    return replace(made, others=tuple(found))


# -- the proof ----------------------------------------------------------------------------------------


def judged(
    about: Lesson, right: Derivation, number: int, planted: Planted, notation: str
) -> Finding | None:
    """Return what the checker says of the line with the slip; None unless it blames that one alone."""
    shown = page.lines(_with_slip(right, number, planted), notation_named(notation))
    report = checker.check(about.front(notation) + shown)
    displays = [f for f in report.findings if f.kind == "display"]
    blamed = [f for f in report.findings if f.verdict in DOUBTFUL]
    if len(displays) != len(right.steps) or blamed != displays[number - 1 : number]:
        return None
    found = displays[number - 1]
    return found if found.verdict in FAULTS and _is_shown(found) else None


def _is_shown(found: Finding) -> bool:
    """Tell whether there are small numbers for what stands on both sides."""
    example = found.explanation.counterexample
    return example is not None and all(value for _, value in example.members)
