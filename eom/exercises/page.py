"""An exercise as a page: its lines as blocks, and words with formulas in them for tasks and keys."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from eom.derivations.derivation import meaning_of
from eom.errors import typed
from eom.exercises.lessons import line_latex, steps
from eom.terms.terms import Term
from eom.typeset import pages
from eom.typeset.blocks import Block, Bullets, Heading, Paragraph
from eom.typeset.letters import Notation
from eom.typeset.notation import notation_named, write

if TYPE_CHECKING:
    from eom.exercises.lessons import Exercise, Sheet

WORDS, INLINE, DISPLAY = "words", "inline", "display"


@dataclass(frozen=True)
class Part:
    """A piece of a paragraph: words, a formula among them, or one on a line of its own, as LaTeX."""

    kind: str
    text: str


Said = tuple[Part, ...]
"""A paragraph."""


def said(*texts: str | Part) -> Said:
    """Return a paragraph; plain texts are words."""
    return tuple(t if isinstance(t, Part) else Part(WORDS, t) for t in texts)


def inline(latex: str) -> Part:
    """Return a formula among words."""
    return Part(INLINE, latex)


def display(latex: str) -> Part:
    """Return a formula on a line of its own."""
    return Part(DISPLAY, latex)


# -- lines -------------------------------------------------------------------------------------------


# -- what is said -------------------------------------------------------------------------------------


def task(exercise: Sheet) -> Said:
    """Return what the student is asked."""
    count = len(exercise.right.steps)
    return said(
        f"Exactly one of the lines (1) to ({count}) is false; each of the others is right, whatever "
        "stands in the line before it. Which line is it, which term of it, and what should stand there?"
    )


def key(exercise: Exercise) -> Iterator[Said]:
    """Yield the key: the line, the term, what is right, small numbers, and what of the lines behind."""
    notation = notation_named(exercise.asked.notation)
    slip = exercise.planted.slip
    wrong = exercise.wrong.steps[exercise.number - 1]
    yield said(f"Line ({exercise.number}) is false: {slip.words}. It says")
    yield said(display(line_latex(exercise.wrong, wrong, notation)))
    yield said("and should say")
    yield said(display(line_latex(exercise.right, exercise.step, notation)))
    yield _exchanged(exercise.planted.right, exercise.planted.wrong, notation)
    if exercise.finding.explanation.residual:
        residual = exercise.finding.explanation.residual
        yield said("Left side minus right side of the false line is ", inline(residual), ".")
    yield from _numbers(exercise)
    yield said(
        "The slip is not carried on: every other line is what it would be without it, and is right by "
        "itself, so that one line alone is to be blamed."
    )


def _exchanged(right: Term, wrong: Term, notation: Notation) -> Said:
    was = inline(write(right, notation, "latex"))
    if wrong.is_zero:
        return said("The term ", was, " is missing.")
    return said(inline(write(wrong, notation, "latex")), " stands where ", was, " should stand.")


def _numbers(exercise: Exercise) -> Iterator[Said]:
    """Yield a state in small numbers at which both sides of the false line differ."""
    found = exercise.counterexample
    if found is None:
        return
    under = "; ".join(meaning_of(a) for a in found.assumptions)
    yield said("A state in small numbers that shows it", f", where {under}" if under else "", ":")
    values = [p for latex, value in found.values for p in (", ", inline(f"{latex} = {value}"))]
    yield said(*values[1:], ".")
    (left, a), (right, b) = ((inline(x), inline(y)) for x, y in found.members)
    yield said("There ", left, " is ", a, " and ", right, " is ", b, "; they should be equal.")


# -- Markdown -----------------------------------------------------------------------------------------


@typed
def student(exercise: Sheet, lexicon: bool = True) -> str:
    """Return the page of an ``exercise`` for the student as Markdown.

    ``lexicon``: whether it begins with the front matter with which `eom check` can judge it.

    >>> from eom.exercises import exercise
    >>> student(exercise("point-mass", seed=1), lexicon=False).splitlines()[0]
    '# Which line is false? Dynamics of a point mass'
    """
    front = exercise.asked.lesson.front(exercise.asked.notation) if lexicon else ""
    return front + pages.markdown_page(_student(exercise))


def _student(exercise: Sheet) -> Iterator[Block]:
    notation = notation_named(exercise.asked.notation)
    yield Heading(f"Which line is false? {_line(exercise.right.title)}", 1)
    yield Paragraph(markdown(task(exercise)))
    yield Heading("Symbols")
    yield Bullets(exercise.legend)
    yield Heading("Lines")
    yield from steps(exercise.wrong, notation)


@typed
def marker(exercise: Exercise) -> str:
    """Return the key of an exercise as Markdown: which line, what should stand there, and numbers.

    >>> from eom.exercises import exercise
    >>> marker(exercise("point-mass", seed=1)).splitlines()[4]
    'Line (3) is false: a term was dropped. It says'
    """
    lines = [f"# Key: {_line(exercise.right.title)}", ""]
    lines += [f"`{command(exercise)}`", ""]
    for paragraph in key(exercise):
        lines += [markdown(paragraph), ""]
    return "\n".join(lines[:-1]) + "\n"


def command(exercise: Exercise) -> str:
    """Return the command that makes the exercise."""
    words = [
        exercise.asked.lesson.topic,
        f"--seed {exercise.asked.seed}",
        f"--notation {exercise.asked.notation}",
    ]
    words += [f"--lines {exercise.asked.lines}"]
    words += [f"--slip {exercise.asked.slip}"] if exercise.asked.slip else []
    return " ".join(["eom exercise", *words])


def _line(words: str) -> str:
    """Return words on one line."""
    return " ".join(words.split())


_MARKDOWN = {WORDS: "{}", INLINE: "${}$", DISPLAY: "$${}$$"}


def markdown(paragraph: Iterable[Part]) -> str:
    """Return a paragraph as Markdown."""
    return "".join(_MARKDOWN[p.kind].format(p.text) for p in paragraph)
