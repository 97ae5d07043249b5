"""An exercise: a few lines of a derivation, of which one is false, and the proof that it is that one.

A line and a slip are drawn by the seed; the slip counts if the checker finds fault with that line and
with no other. In a derivation with frames, bodies or laws of its own, of which a note can tell little, the
line is proved false in the derivation's own worlds; there all others were verified. Lines after it stay as
they were: each of them is right by itself, whatever the line before it, so that exactly one line of the
page is false.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice
from typing import Any

import sympy as sp

import eom.checker.note.checking as checker
from eom.checker.read.spans import NOWHERE, Source
from eom.checker.report.findings import FAULTS, Counterexample, Explanation, Finding
from eom.derivations.derived import Derived
from eom.derivations.reached import same
from eom.derivations.small_numbers import Judge
from eom.derivations.steps import Step
from eom.derivations.verification import verify
from eom.errors import InputError, typed, unknown_name
from eom.exercises import lessons, slips
from eom.exercises.lessons import LINES, Asked, Exercise, Lesson, Sheet, lesson, line_latex
from eom.exercises.slips import Planted
from eom.terms.terms import COLUMN, INERTIAL, SCALAR, VECTOR, Equation, Term, column, nodes
from eom.typeset.boxes import Formula
from eom.typeset.letters import Notation
from eom.typeset.markup import render
from eom.typeset.notation import notation_named, write

LEAST_LINES, MOST_LINES = 2, 40
MOST_CARRIED = 3
TRIES = 40
"""Slips that are shown to the checker at most."""
ALIKE = 4
"""Slips of one kind that are tried in a line which may carry one on."""
SMALL = 99
"""Numerators and denominators of small fractions are at most so large."""
OTHERS = 4
"""False versions of the false line that stand beside the right one."""
DOUBTFUL = frozenset({*FAULTS, "ambiguous"})


@typed
def exercise(
    topic: str,
    seed: int = 0,
    *,
    notation: str = "arrow",
    lines: int = LINES,
    slip: str = "",
    difficulty: str = "",
    carried: int = 0,
) -> Exercise:
    """Return the exercise of a topic and seed; the same arguments give the same exercise.

    Parameters
    ----------
    topic : str
        One of `eom.exercises.topics`.
    seed : int, default 0
        Of what is drawn: the lines, the slip and where it is planted.
    notation : str, default "arrow"
        One of `eom.typeset.notation.NOTATIONS`, how frames and vectors are written.
    lines : int, default 6
        At most so many lines, 2 to 40.
    slip : str, optional
        A kind of slip, any unless given.
    difficulty : str, optional
        ``easy`` (the line itself shows it), ``medium`` or ``hard`` (it takes mechanics), any unless
        given.
    carried : int, default 0
        In so many further lines, 0 to 3, the slip is carried on.

    Returns
    -------
    Exercise
        The same arguments give the same exercise.

    Raises
    ------
    InputError
        For unknown names, for other numbers, and where no slip can be planted that the checker
        finds.

    Examples
    --------
    >>> exercise("point-mass", seed=1).counterexample.values[0]
    ('m', '1')
    """
    given = {"notation": notation, "lines": lines, "slip": slip, "difficulty": difficulty}
    return planted_in(lesson(topic), seed, carried=carried, **given)  # type: ignore[arg-type]


@typed
def planted_in(
    about: Lesson,
    seed: int = 0,
    *,
    notation: str = "arrow",
    lines: int = LINES,
    slip: str = "",
    difficulty: str = "",
    carried: int = 0,
) -> Exercise:
    """Return an exercise made from a lesson, ``about``.

    Parameters
    ----------
    about : Lesson
        The derivation that lines are taken from, see `lesson`.
    seed : int, default 0
        Of what is drawn: the lines, the slip and where it is planted.
    notation : str, default "arrow"
        One of `eom.typeset.notation.NOTATIONS`, how frames and vectors are written.
    lines : int, default 6
        At most so many lines, 2 to 40.
    slip : str, optional
        A kind of slip, any unless given.
    difficulty : str, optional
        ``easy`` (the line itself shows it), ``medium`` or ``hard`` (it takes mechanics), any unless
        given.
    carried : int, default 0
        In so many further lines, 0 to 3, the slip is carried on.

    Returns
    -------
    Exercise
        The same arguments give the same exercise.

    Raises
    ------
    InputError
        For unknown names, for other numbers, and where no slip can be planted that the checker
        finds.

    Examples
    --------
    >>> from eom.exercises import lesson
    >>> len(planted_in(lesson("point-mass"), lines=4).right.steps)
    4
    """
    asked = Asked(about, seed, notation_named(notation).name, lines, slip, difficulty, carried)
    _check(asked)
    spare = None
    for sheet in islice(_drawn(asked), TRIES):
        whole = _carrying(sheet) if carried else sheet
        found = judged(whole) if whole else None
        if whole is None or found is None:
            continue
        made = Exercise(
            asked, whole.right, whole.number, whole.planted, found, carried=whole.carried
        )
        if _is_small(found):
            return made
        spare = spare or made
    if spare is not None:
        return spare
    raise _nothing(asked)


def _check(asked: Asked) -> None:
    """Raise `InputError` for what cannot be asked."""
    if asked.slip and asked.slip not in slips.names():
        raise unknown_name("kind of slip", asked.slip, slips.names())
    if asked.difficulty and asked.difficulty not in slips.DIFFICULTIES:
        raise unknown_name("difficulty", asked.difficulty, slips.DIFFICULTIES)
    if asked.slip and asked.slip not in slips.named(asked.difficulty):
        raise InputError(
            f"a slip of the kind {asked.slip} is {slips.KINDS[asked.slip].difficulty}",
            where="difficulty",
            got=asked.difficulty,
        )
    if not LEAST_LINES <= asked.lines <= MOST_LINES:
        raise InputError(
            "wrong number of lines", got=asked.lines, expected=f"{LEAST_LINES} to {MOST_LINES}"
        )
    if not 0 <= asked.carried <= min(MOST_CARRIED, asked.lines - 1):
        raise InputError(
            "wrong number of lines that carry a slip on",
            got=asked.carried,
            expected=f"0 to {min(MOST_CARRIED, asked.lines - 1)}, of {asked.lines} lines",
        )
    if asked.carried and asked.lesson.judge:
        raise InputError(
            "lines that carry a slip on are found by the checker of notes, which cannot tell here",
            where=asked.lesson.topic,
            got=asked.carried,
            expected="0, or another topic",
        )


def _nothing(asked: Asked) -> InputError:
    """Return the error for a topic in which no slip could be planted."""
    about, slip = asked.lesson, asked.slip
    kinds = dict.fromkeys(
        name for name, _, _ in _candidates(replace(asked, slip="", difficulty=""))
    )
    if slip and slip not in kinds:
        return InputError(
            f"no line of this topic can have the slip {slip}",
            where=about.topic,
            expected=", ".join(kinds) or "another topic",
        )
    return InputError(
        "no slip was found in this topic that the checker proves",
        where=about.topic,
        got=", ".join(
            f"{name} {value}"
            for name, value in (
                ("slip", slip),
                ("difficulty", asked.difficulty),
                ("carried", asked.carried),
            )
            if value
        ),
        hint="another seed, another slip, or another topic (eom exercise --list)",
    )


# -- drawing ------------------------------------------------------------------------------------------


def _drawn(asked: Asked) -> Iterator[Sheet]:
    """Yield lines with a slip in one of them that makes it false, kinds of slips in turn."""
    derivation, lines = asked.lesson.derivation, asked.lines
    rng = _random(asked, "lines")
    kinds: dict[str, list[tuple[int, Planted]]] = {}
    for name, k, planted in _candidates(asked):
        kinds.setdefault(name, []).append((k, planted))
    order = list(kinds)
    rng.shuffle(order)
    while order:
        name = order.pop(0)
        k, planted = kinds[name].pop(rng.randrange(len(kinds[name])))
        if kinds[name]:
            order.append(name)
        if _is_false(derivation, derivation.steps[k], planted):
            first = k if asked.carried else _first(rng, k, len(derivation.steps), lines)
            window = derivation.steps[first : first + lines]
            if len(_following(window[k - first :])) >= asked.carried:
                yield Sheet(asked, replace(derivation, steps=window), k - first + 1, planted)


def _following(steps: Sequence[Step]) -> tuple[int, ...]:
    """Return the places of the steps that follow from the first one, by way of others or not."""
    reached, found = {steps[0].label}, []
    for k, step in enumerate(steps[1:], 1):
        if reached & set(step.follows):
            reached.add(step.label)
            found.append(k)
    return tuple(found)


def _random(asked: Asked, what: str) -> random.Random:
    """Return random numbers that are the same for the same request, on every machine."""
    words = f"{asked.lesson.topic} {asked.seed} {asked.lines} {asked.slip} {what}"
    words += f" {asked.difficulty} {asked.carried}" if asked.difficulty or asked.carried else ""
    return random.Random(words)  # noqa: S311 - reproducible


def _candidates(asked: Asked) -> Iterator[tuple[str, int, Planted]]:
    """Yield what slips may be made: the kind, the place of the line, the slip.

    None in a line that is true by algebra alone, whatever its symbols mean.
    """
    around, kinds = _around(asked.lesson), slips.named(asked.difficulty)
    for k, step in enumerate(asked.lesson.derivation.steps):
        if is_tautology(step):
            continue
        for planted in slips.planted(step.statement, around):
            if planted.slip.name in kinds and asked.slip in {"", planted.slip.name}:
                yield planted.slip.name, k, planted


def is_tautology(step: Step) -> bool:
    """Return whether both sides of a line are the same by algebra alone; derivatives are no algebra."""
    sides = (step.statement.left, step.statement.right)
    return not any(n.head == "der" for side in sides for n in nodes(side)) and same(*sides)


def _around(about: Lesson) -> slips.Around:
    steps = about.derivation.steps
    return slips.around(t for s in steps for t in (s.statement.left, s.statement.right))


def _first(rng: random.Random, k: int, count: int, lines: int) -> int:
    """Return where the lines begin, so that line k is among them and as many as asked for."""
    least, most = max(0, k - lines + 1), min(k, max(0, count - lines))
    return rng.randint(min(least, most), most)


def _is_false(derivation: Derived, step: Step, planted: Planted) -> bool:
    """Return whether an equation is not true; what cannot be decided may be false."""
    if derivation.own:
        return True  # its judge is asked
    claimed = replace(planted.equation, relation="=")
    try:
        verify(claimed, step.assumptions, derivation.scalars)
    except InputError:
        return True
    return False


@typed
def with_others(made: Exercise, count: int = OTHERS) -> Exercise:
    """Return an exercise with other false versions of its false line, each proved like the first one.

    Parameters
    ----------
    made : Exercise
        Of `exercise`.
    count : int, default 4
        So many false versions at most, the planted one among them.

    Returns
    -------
    Exercise
        The same exercise with its ``others``; these differ by how they are written.

    Examples
    --------
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
    return line_latex(made.right, step, made.letters)


# -- lines that carry it on ---------------------------------------------------------------------------


def _carrying(sheet: Sheet) -> Sheet | None:
    """Return lines that carry the slip on as often as asked for; None if there are not so many.

    A line behind that follows from the false one gets a slip of the same kind; it counts if the checker
    says that it follows from the false line, without another mistake.
    """
    if not judged(sheet):
        return None
    around, behind = _around(sheet.asked.lesson), sheet.right.steps[sheet.number - 1 :]
    for place in _following(behind):
        number, step = sheet.number + place, behind[place]
        alike = (p for p in slips.planted(step.statement, around) if p.slip == sheet.planted.slip)
        for planted in islice(alike, ALIKE):
            longer = replace(sheet, carried=(*sheet.carried, (number, planted)))
            if judged(longer):
                sheet = longer
                break
        if len(sheet.carried) == sheet.asked.carried:
            return sheet
    return None


# -- the proof --------------------------------------------------------------------------------------


def judged(sheet: Sheet) -> Finding | None:
    """Return what the checker says of the false line; None unless it blames that one alone.

    It reads the page as the student gets it. Lines that carry the slip on have to be found to do so.
    Where the lesson has a judge of its own, this is asked about the false line.
    """
    if sheet.asked.lesson.judge is not None:
        return _by_judge(sheet, sheet.asked.lesson.judge)
    report = checker.check(lessons.student(sheet))
    displays = [f for f in report.findings if f.kind == "display"]
    if len(displays) != len(sheet.right.steps):
        return None
    found = displays[sheet.number - 1]
    after = [displays[number - 1] for number, _ in sheet.carried]
    blamed = [f for f in report.findings if f.verdict in DOUBTFUL]
    if blamed != [found, *after] or found.verdict not in FAULTS or not _is_shown(found):
        return None
    return found if all(f.carried == found.line for f in after) else None


def _by_judge(sheet: Sheet, judge: Judge) -> Finding | None:
    """Return the finding on a line that is false where all laws hold, with the numbers that show it."""
    claimed = replace(sheet.planted.equation, relation="=")
    assumed = sheet.step.assumptions
    numbers = judge.numbers(claimed, sheet.step.statement, assumed)
    heads = [_head(t, sheet.letters) for t in (claimed.left, claimed.right)]
    if numbers is None or None in heads or not judge.refutes(claimed, assumed):
        return None
    values = [(render(Formula(s), "latex"), sp.latex(v)) for s, v in numbers.values.items()]
    members = zip((h or "" for h in heads), map(_row, numbers.sides), strict=True)
    example = Counterexample(tuple(values), tuple(members), assumed)
    latex = line_latex(sheet.wrong, sheet.wrong.steps[sheet.number - 1], sheet.letters)
    explanation = Explanation(counterexample=example)
    return Finding(
        sheet.number, "display", Source(latex), NOWHERE, latex, "wrong", explanation=explanation
    )


def _head(term: Term, notation: Notation) -> str | None:
    """Return a side as its numbers are about it: a vector by its components in I; None for matrices."""
    shown = column(term, INERTIAL) if term.kind == VECTOR else term
    return write(shown, notation, "latex") if shown.kind in {SCALAR, COLUMN} else None


def _row(side: Sequence[Any]) -> str:
    """Return a number, or three in brackets."""
    texts = [sp.latex(x) for x in side]
    return texts[0] if len(texts) == 1 else rf"\left( {', '.join(texts)} \right)"


def _is_shown(found: Finding) -> bool:
    """Return whether there are small numbers for what stands on both sides."""
    example = found.explanation.counterexample
    return example is not None and all(value for _, value in example.members)


def _is_small(found: Finding) -> bool:
    """Return whether the numbers that show it are small fractions, to be put in with a pencil."""
    example = found.explanation.counterexample
    if example is None:
        return False
    texts = [value for pairs in (example.values, example.members) for _, value in pairs]
    return all(int(n) <= SMALL for text in texts for n in re.findall(r"\d+", text))
