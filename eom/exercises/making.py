"""An exercise: a few lines of a derivation, of which one is false, and the proof that it is that one.

A line and a slip are drawn by the seed; the slip counts if the checker finds fault with that line and
with no other. Lines after it stay as they were: each of them is right by itself, whatever the line
before it, so that exactly one line of the page is false.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import eom.checker.note.checking as checker
from eom.checker.report.findings import FAULTS, Finding
from eom.derivations.derived import Derived
from eom.derivations.steps import Step
from eom.derivations.verification import verify
from eom.errors import InputError, typed, unknown_name
from eom.exercises import lessons, slips
from eom.exercises.lessons import LINES, Asked, Exercise, Lesson, Sheet, lesson, line_latex
from eom.exercises.slips import Planted
from eom.terms.terms import Equation
from eom.typeset.notation import notation_named

LEAST_LINES, MOST_LINES = 2, 40
TRIES = 40
"""Slips that are shown to the checker at most."""
OTHERS = 4
"""False versions of the false line that stand beside the right one."""
DOUBTFUL = frozenset({*FAULTS, "ambiguous"})


@typed
def exercise(
    topic: str, seed: int = 0, *, notation: str = "arrow", lines: int = LINES, slip: str = ""
) -> Exercise:
    """Return the exercise of a topic and seed; the same arguments give the same exercise.

    ``topic``: one of `eom.exercises.topics`; all others: see `planted_in`. Raises `InputError` for unknown
    names, and where no slip can be planted that the checker finds.

    >>> exercise("point-mass", seed=1).counterexample.values[0]
    ('m', '1')
    """
    return planted_in(lesson(topic), seed, notation=notation, lines=lines, slip=slip)


@typed
def planted_in(
    about: Lesson, seed: int = 0, *, notation: str = "arrow", lines: int = LINES, slip: str = ""
) -> Exercise:
    """Return an exercise made from a lesson, ``about``.

    ``seed``: of what is drawn; ``notation``: one of `eom.typeset.notation.NOTATIONS`; ``lines``: at most
    so many, 2 to 40; ``slip``: a kind of slip, "" for any. Raises `InputError` for unknown names, for
    other numbers of lines, and where no slip can be planted that the checker finds.

    >>> from eom.exercises import lesson
    >>> len(planted_in(lesson("point-mass"), lines=4).right.steps)
    4
    """
    notation = notation_named(notation).name
    if slip and slip not in slips.names():
        raise unknown_name("kind of slip", slip, slips.names())
    if not LEAST_LINES <= lines <= MOST_LINES:
        raise InputError(
            "wrong number of lines", got=lines, expected=f"{LEAST_LINES} to {MOST_LINES}"
        )
    asked = Asked(about, seed, notation, lines, slip)
    for sheet in islice(_drawn(asked), TRIES):
        found = judged(sheet)
        if found is not None:
            return Exercise(asked, sheet.right, sheet.number, sheet.planted, found)
    raise _nothing(about, slip)


def _nothing(about: Lesson, slip: str) -> InputError:
    """Return the error for a topic in which no slip could be planted."""
    kinds = dict.fromkeys(name for name, _, _ in _candidates(about, ""))
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


# -- drawing ------------------------------------------------------------------------------------------


def _drawn(asked: Asked) -> Iterator[Sheet]:
    """Yield lines with a slip in one of them that makes it false, kinds of slips in turn."""
    derivation, lines = asked.lesson.derivation, asked.lines
    rng = _random(asked, "lines")
    kinds: dict[str, list[tuple[int, Planted]]] = {}
    for name, k, planted in _candidates(asked.lesson, asked.slip):
        kinds.setdefault(name, []).append((k, planted))
    order = list(kinds)
    rng.shuffle(order)
    while order:
        name = order.pop(0)
        k, planted = kinds[name].pop(rng.randrange(len(kinds[name])))
        if kinds[name]:
            order.append(name)
        if _is_false(derivation, derivation.steps[k], planted):
            first = _first(rng, k, len(derivation.steps), lines)
            window = derivation.steps[first : first + lines]
            yield Sheet(asked, replace(derivation, steps=window), k - first + 1, planted)


def _random(asked: Asked, what: str) -> random.Random:
    """Return random numbers that are the same for the same request, on every machine."""
    words = f"{asked.lesson.topic} {asked.seed} {asked.lines} {asked.slip} {what}"
    return random.Random(words)  # noqa: S311 - reproducible


def _candidates(about: Lesson, slip: str) -> Iterator[tuple[str, int, Planted]]:
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


def _is_false(derivation: Derived, step: Step, planted: Planted) -> bool:
    """Return whether an equation is not true; what cannot be decided may be false."""
    claimed = replace(planted.equation, relation="=")
    try:
        verify(claimed, step.assumptions, derivation.scalars)
    except InputError:
        return True
    return False


@typed
def with_others(made: Exercise, count: int = OTHERS) -> Exercise:
    """Return an exercise with other false versions of its false line, each proved like the first one.

    ``made``: of `exercise`. At most ``count``, the planted one among them; lines differ by how they
    are written.

    >>> len(with_others(exercise("point-mass", seed=1), count=2).others)
    2
    """
    candidates = list(slips.planted(made.step.statement, _around(made.asked.lesson)))
    _random(made.asked, "others").shuffle(candidates)
    alone = replace(made.right, steps=(made.step,))
    seen = {_written(made, made.step.statement)}
    found: list[Equation] = []
    for planted in (made.planted, *candidates[:TRIES]):
        latex = _written(made, planted.equation)
        if latex in seen or not _is_false(made.right, made.step, planted):
            continue
        seen.add(latex)
        if planted is made.planted or judged(Sheet(made.asked, alone, 1, planted)):
            found.append(planted.equation)
        if len(found) == count:
            break
    return replace(made, others=tuple(found))


def _written(made: Exercise, equation: Equation) -> str:
    step = replace(made.step, statement=equation)
    return line_latex(made.right, step, notation_named(made.asked.notation))


# -- the proof --------------------------------------------------------------------------------------


def judged(sheet: Sheet) -> Finding | None:
    """Return what the checker says of the false line; None unless it blames that one alone.

    It reads the page as the student gets it.
    """
    report = checker.check(lessons.student(sheet))
    displays = [f for f in report.findings if f.kind == "display"]
    blamed = [f for f in report.findings if f.verdict in DOUBTFUL]
    if len(displays) != len(sheet.right.steps):
        return None
    found = displays[sheet.number - 1]
    return found if blamed == [found] and found.verdict in FAULTS and _is_shown(found) else None


def _is_shown(found: Finding) -> bool:
    """Return whether there are small numbers for what stands on both sides."""
    example = found.explanation.counterexample
    return example is not None and all(value for _, value in example.members)
