"""What exercises are made from: the steps of a topic as lines, and what their symbols mean.

A topic is a derivation. Those of the solids go as a marker would: integrals over the mass, their
values, and the theorem of parallel axes; all others are the verified steps themselves. Moments of a uniform
solid are written in the letters of books; values are those of the catalogue of solids, which integrates
over the solid's own coordinates. A page has the lines as blocks, words with formulas for task and key.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from eom import derivations
from eom.checker.mean.solid_models import COORDINATES, SPELLINGS
from eom.checker.note.derived import front_matter
from eom.checker.report.findings import Counterexample, Finding
from eom.derivations import SOLIDS
from eom.derivations.derived import Derived
from eom.derivations.showing import Item, meaning_of, only_names, separate, symbols
from eom.derivations.small_numbers import Judge
from eom.derivations.steps import Step
from eom.derivations.wording import notation_of
from eom.errors import InputError, typed, unknown_name
from eom.exercises.slips import Planted
from eom.mass.properties import MassProperties
from eom.mass.solids import MASS, mass_properties
from eom.mass.solids import SOLIDS as CATALOGUE
from eom.terms.terms import Equation, Term, expr, integral, nodes
from eom.typeset import pages
from eom.typeset.blocks import Block, Bullets, Heading, Paragraph, Steps
from eom.typeset.boxes import Formula
from eom.typeset.letters import Notation
from eom.typeset.markup import render, symbol_latex
from eom.typeset.notation import NOTATIONS, notation_named, write
from eom.typeset.sentences import Prose

RELATIONS = ("=", ":=")


@dataclass(frozen=True)
class Lesson:
    """A ``topic``: its ``derivation``, with the steps that can be lines of an exercise, and its lexicon.

    Parameters
    ----------
    topic : str
        Its name, that of the derivation.
    derivation : Derived
        With the steps that can be lines of an exercise.
    front : callable
        From the name of a notation to front matter that `eom check` reads, "" where no note can say it.
    legend : callable, optional
        From lines and a notation to symbols with their meanings.
    judge : callable, optional
        What proves a line false in a derivation with frames, bodies or laws of its own; none where
        notes are checked.
    """

    topic: str
    derivation: Derived
    front: Callable[[str], str]
    legend: Callable[[Derived, Notation], Iterable[Item]] = symbols
    judge: Judge | None = field(default=None, compare=False)


def topics() -> dict[str, dict[str, str]]:
    """Return the title of each topic, by group and name: those of the derivations.

    >>> topics()["Particles"]["point-mass"]
    'Dynamics of a point mass'
    """
    return derivations.titles()


@typed
def lesson(topic: str) -> Lesson:
    """Return a ``topic`` by its name, one of `topics`. Raises `InputError` for others.

    Parameters
    ----------
    topic : str
        One of `topics`.

    Returns
    -------
    Lesson
        The derivation that exercises are made from, and the symbols that stand at its beginning.

    Raises
    ------
    InputError
        For other names.

    Examples
    --------
    >>> len(lesson("point-mass").derivation.steps)
    29
    """
    known = [name for made in topics().values() for name in made]
    if topic not in known:
        raise unknown_name("topic", topic, known)
    solid = solid_of(topic)
    if solid:
        made = of_solid(topic, solid)
        return Lesson(topic, made, lambda _: front_matter_of(solid), lambda *_: legend(solid))
    made = derivations.derive(topic)
    lines = tuple(s for s in made.steps if _is_line(s))
    judge = Judge(made.scalars, made.own) if made.own else None
    return Lesson(topic, _with(made, lines), lambda notation: _front(made, notation), judge=judge)


def _front(made: Derived, notation: str) -> str:
    """Return front matter for a note of a derivation, none where no note can say what it is about."""
    return "" if made.own.configured else front_matter(made, notation)


def _is_line(step: Step) -> bool:
    """Return whether a step claims something in every notation: no inequality, no mere name."""
    if step.statement.relation not in RELATIONS or step.statement.left == step.statement.right:
        return False
    return not any(only_names(step, n) for n in NOTATIONS.values())


def _with(made: Derived, steps: tuple[Step, ...]) -> Derived:
    return replace(made, steps=steps, result={})


Expr = Any
PREFIX = "inertia-of-"
GROUP = "Inertia of solids"
X, Y, Z = COORDINATES
SQUARES = (Y**2 + Z**2, X**2 + Z**2, X**2 + Y**2)
PAIRS = ((0, 1), (0, 2), (1, 2))


def solid_of(topic: str) -> str:
    """Return the solid that a topic is about, "" for other topics."""
    return next((s for s in SOLIDS if topic == PREFIX + s.replace(" ", "-")), "")


def of_solid(topic: str, solid: str) -> Derived:
    """Return the derivation of a solid's moments of inertia. Raises `InputError` for other solids."""
    title = derivations.titles()[GROUP][topic]
    return Derived(topic, title, GROUP, tuple(_steps(solid)), {}, {})


def front_matter_of(solid: str) -> str:
    """Return front matter that names the solid, so that `eom check` knows mass, sizes and moments."""
    names = [(s, old.name) for old, s in _letters(solid).items()]
    names += [
        (_moment(k, point), f"I{k}{_tail(point)}") for k in (1, 2, 3) for point in _points(solid)
    ]
    names += [
        (_product(i, j, point), f"J{i + 1}{j + 1}{_tail(point)}")
        for i, j in PAIRS
        for point in _points(solid)
    ]
    rows = [f"'{symbol_latex(s.name)}' = '{name}'" for s, name in names]
    return "\n".join(
        ["+++", "[check.system]", f'is = "{solid}"', "[check.system.symbols]", *rows, "+++", "", ""]
    )


def legend(solid: str) -> Iterator[Item]:
    """Yield mass, sizes, axes and moments with their meanings."""
    for old, letter in _letters(solid).items():
        yield (
            Formula(letter),
            old.name.replace("_", " ") if len(old.name) > 1 else "an edge or axis",
        )
    for point in _points(solid):
        where = f"the {point}" if point else "the centre of mass"
        yield (
            Formula(_moment(1, point)),
            f"moment of inertia about axis 1 through {where}; 2, 3 likewise",
        )
    yield Formula(X), "coordinate along axis 1 from the centre of mass; y, z along axes 2, 3"


def _points(solid: str) -> tuple[str, ...]:
    return ("", *CATALOGUE[solid].points)


def _tail(point: str) -> str:
    return f"_{point.replace(' ', '_')}" if point else ""


def _letters(solid: str) -> dict[Expr, Expr]:
    """Return mass and sizes of a solid with the letters that stand for them in books."""
    names = (MASS.name, *CATALOGUE[solid].sizes)
    return {
        sp.Symbol(n, positive=True): sp.Symbol(SPELLINGS.get(n, (n,))[0], positive=True)
        for n in names
    }


def _moment(k: int, point: str) -> Expr:
    return sp.Symbol(f"I_{k}{_tail(point)}")


def _product(i: int, j: int, point: str) -> Expr:
    return sp.Symbol(f"J_{i + 1}{j + 1}{_tail(point)}")


def _steps(solid: str) -> Iterator[Step]:
    letters = _letters(solid)
    body = mass_properties(solid)
    m = letters[MASS]
    for point in _points(solid):
        moved = mass_properties(solid, point) if point else body
        where = f"the {point}" if point else "the centre of mass"
        for k in (1, 2, 3):
            value = sp.expand(moved.inertia[k - 1, k - 1].xreplace(letters))
            symbol, label = _moment(k, point), f"I{k}{_tail(point)}"
            if point:
                central = expr(_moment(k, "") + m * _distance(body, moved, k - 1, letters))
                yield _step(
                    f"{label}-moved", symbol, central, f"parallel axes: axis {k} through {where}"
                )
            else:
                about = integral(expr(SQUARES[k - 1]))
                yield _step(
                    f"{label}-integral", symbol, about, f"moment about axis {k} through {where}"
                )
            yield _step(label, symbol, expr(value), "carried out")
        yield from _products(moved, point, where, letters)


def _products(body: MassProperties, point: str, where: str, letters: Any) -> Iterator[Step]:
    """Yield products of inertia that are not zero."""
    for i, j in PAIRS:
        value = sp.expand(body.inertia[i, j].xreplace(letters))
        if value != 0:
            words = f"entry {i + 1}{j + 1} of the inertia matrix about {where}"
            yield _step(f"J{i}{j}{_tail(point)}", _product(i, j, point), expr(value), words)


def _distance(body: MassProperties, moved: MassProperties, k: int, letters: Any) -> Expr:
    """Return the square of the distance of an axis from that through the centre of mass."""
    r = [sp.factor(a - b) for a, b in zip(body.centre, moved.centre, strict=True)]
    return sp.Add(*(r[j] ** 2 for j in range(3) if j != k)).xreplace(letters)


def _step(label: str, left: Expr, right: Any, reason: str) -> Step:
    return Step(label, Equation(expr(left), right), reason)


def steps(derivation: Derived, notation: Notation) -> tuple[Steps, ...]:
    """Return the lines of a derivation as blocks, without what would show how they were verified."""
    plain = tuple(
        replace(s, states=(), evidence=s.kind if s.kind != "result" else "")
        for s in derivation.steps
    )
    return tuple(separate(replace(derivation, steps=plain), notation))


def lines(derivation: Derived, notation: Notation) -> str:
    """Return the lines of a derivation in Markdown, numbered, each a display with its reason."""
    return pages.markdown_page(steps(derivation, notation))


def line_latex(derivation: Derived, step: Step, notation: Notation) -> str:
    """Return one line as LaTeX."""
    (block,) = steps(replace(derivation, steps=(step,)), notation)
    return pages.display_latex((line, "") for line in block.lines[0])


LINES = 6
"""Lines of an exercise where nobody says how many."""


@dataclass(frozen=True)
class Asked:
    """What makes an exercise; all but ``lesson`` as of `planted_in`."""

    lesson: Lesson
    seed: int = 0
    notation: str = "arrow"
    lines: int = LINES
    slip: str = ""
    difficulty: str = ""
    carried: int = 0


@dataclass(frozen=True)
class Sheet:
    """Lines of which one is false, and those that carry its slip on.

    Parameters
    ----------
    asked : Asked
        Topic, seed and the rest that made it.
    right : Derived
        The lines as they are derived.
    number : int
        Of the false one, from 1.
    planted : Planted
        The slip in it.
    carried : tuple of tuple of int, Planted, optional
        Lines that carry it on, as the checker finds them.
    """

    asked: Asked
    right: Derived
    number: int
    planted: Planted
    carried: tuple[tuple[int, Planted], ...] = field(default=(), kw_only=True)

    @property
    def wrong(self) -> Derived:
        """The lines that the student sees."""
        steps = list(self.right.steps)
        for number, planted in ((self.number, self.planted), *self.carried):
            steps[number - 1] = replace(steps[number - 1], statement=planted.equation)
        return replace(self.right, steps=tuple(steps))

    @property
    def step(self) -> Step:
        """The line as it is right."""
        return self.right.steps[self.number - 1]

    @property
    def letters(self) -> Notation:
        """The notation, as its lines take it. Raises `InputError` for an unknown one."""
        return notation_of(self.right, notation_named(self.asked.notation))

    @property
    def legend(self) -> tuple[Item, ...]:
        """Symbols of the lines with their meanings, of both versions of the false one: none is told.

        Raises `InputError` for an unknown notation.
        """
        both = (*self.right.steps, *self.wrong.steps)
        shown = only_scalars_of(replace(self.right, steps=both))
        return tuple(self.asked.lesson.legend(shown, self.letters))


@dataclass(frozen=True)
class Exercise(Sheet):
    """Lines of which the checker proves that one is false and no other.

    Parameters
    ----------
    finding : Finding
        What the checker says of the false line.
    others : tuple of Equation, optional
        Other false versions of that line, where they were asked for, the planted one first.
    """

    finding: Finding
    others: tuple[Equation, ...] = ()

    @property
    def counterexample(self) -> Counterexample | None:
        """A state in small numbers at which the line fails."""
        return self.finding.explanation.counterexample


def only_scalars_of(lines: Derived) -> Derived:
    """Return lines with the scalars alone that stand in them, and in what these stand for."""
    sides = [t for s in lines.steps for t in (s.statement.left, s.statement.right)]
    used: set[Any] = set()
    while sides:
        found = {x for n in nodes(sides.pop()) if n.head == "expr" for x in n.data[0].free_symbols}
        sides += [lines.scalars[x] for x in found - used if x in lines.scalars]
        used |= found
    return replace(lines, scalars={x: t for x, t in lines.scalars.items() if x in used})


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


def spoken(words: Prose) -> Said:
    """Return words with formulas among them."""
    parts = (words,) if isinstance(words, str) else words
    return said(*(p if isinstance(p, str) else inline(render(p, "latex")) for p in parts))


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
    if exercise.carried:
        return said(
            f"One slip was made in the lines (1) to ({count}), and some lines behind it carry it on: they "
            "follow from it without another mistake. All others are right, whatever stands in the line "
            "before. In which line was it made, which term of it, what should stand there, and which "
            "lines carry it on?"
        )
    return said(
        f"Exactly one of the lines (1) to ({count}) is false; each of the others is right, whatever "
        "stands in the line before it. Which line is it, which term of it, and what should stand there?"
    )


def key(exercise: Exercise) -> Iterator[Said]:
    """Yield the key: the line, the term, what is right, small numbers, and what of the lines behind."""
    notation = exercise.letters
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
    yield said(slip.kind.sentence)
    yield from _carried(exercise)


def _carried(exercise: Exercise) -> Iterator[Said]:
    """Yield what became of the lines behind the false one."""
    if not exercise.carried:
        yield said(
            "The slip is not carried on: every other line is what it would be without it, and is right by "
            "itself, so that one line alone is to be blamed."
        )
        return
    notation = exercise.letters
    *most, last = (f"({number})" for number, _ in exercise.carried)
    places = f"{', '.join(most)} and {last}" if most else last
    yield said(
        f"Lines that carry it on: {places}. They follow from line ({exercise.number}) as it stands, and "
        "no mark is to be taken off for them. Without the slip they say"
    )
    for number, _ in exercise.carried:
        step = exercise.right.steps[number - 1]
        yield said(f"({number}) ", display(line_latex(exercise.right, step, notation)))


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

    Parameters
    ----------
    exercise : Sheet
        What is asked; of an `Exercise` the answer is not told.
    lexicon : bool, default True
        Whether the page begins with the front matter with which `eom check` can judge it.

    Returns
    -------
    str
        Markdown: the heading, what the symbols mean, and the numbered lines.

    Examples
    --------
    >>> from eom.exercises import exercise
    >>> student(exercise("point-mass", seed=1), lexicon=False).splitlines()[0]
    '# Which line is false? Dynamics of a point mass'
    """
    front = exercise.asked.lesson.front(exercise.asked.notation) if lexicon else ""
    return front + pages.markdown_page(_student(exercise))


def _student(exercise: Sheet) -> Iterator[Block]:
    notation = exercise.letters
    yield Heading(f"Which line is false? {_line(exercise.right.title)}", 1)
    yield Paragraph(markdown(task(exercise)))
    yield Heading("Symbols")
    yield Bullets(exercise.legend)
    yield Heading("Lines")
    yield from steps(exercise.wrong, notation)


@typed
def marker(exercise: Exercise) -> str:
    """Return the key of an exercise as Markdown: which line, what should stand there, and numbers.

    Parameters
    ----------
    exercise : Exercise
        As `eom.exercises.exercise` makes it.

    Returns
    -------
    str
        Markdown for whoever marks: which line, what should stand there, and the numbers for which
        it is false.

    Examples
    --------
    >>> from eom.exercises import exercise
    >>> marker(exercise("point-mass", seed=1)).splitlines()[4]
    'Line (3) is false: what changes is taken for constant. It says'
    """
    lines = [f"# Key: {_line(exercise.right.title)}", ""]
    lines += [f"`{command(exercise)}`", ""]
    for paragraph in key(exercise):
        lines += [markdown(paragraph), ""]
    return "\n".join(lines[:-1]) + "\n"


@typed
def solutions(exercises: Sequence[Exercise]) -> str:
    """Return a sheet with the solutions of some ``exercises`` as Markdown, one a section.

    Parameters
    ----------
    exercises : sequence of Exercise
        At least one, in the order of the sheet.

    Returns
    -------
    str
        Of each exercise: the line and what was done in it, as it stands and as it should, the
        teacher's sentence, and which lines carry the slip on.

    Raises
    ------
    InputError
        Where there are none.

    Examples
    --------
    >>> from eom.exercises import exercise
    >>> solutions([exercise("point-mass", seed=1)]).splitlines()[4]
    'Line (3): what changes is taken for constant.'
    """
    if not exercises:
        raise InputError("no exercises", expected="one at least")
    made = [line for one in exercises for line in _solution(one)]
    return "\n".join(["# Solutions", "", *made[:-1]]) + "\n"


def _solution(exercise: Exercise) -> Iterator[str]:
    notation = exercise.letters
    slip, wrong = exercise.planted.slip, exercise.wrong
    yield from (f"## {_line(exercise.right.title)}, {exercise.asked.seed}", "")
    yield from (f"Line ({exercise.number}): {slip.words}.", "")
    for lines, word in ((wrong, "stands"), (exercise.right, "right")):
        yield f"* {word}: ${line_latex(lines, lines.steps[exercise.number - 1], notation)}$"
    yield from ("", slip.kind.sentence, "")
    if exercise.carried:
        places = ", ".join(f"({number})" for number, _ in exercise.carried)
        yield from (f"Carried on, without another mistake: {places}.", "")


def command(exercise: Exercise) -> str:
    """Return the command that makes the exercise."""
    words = [
        exercise.asked.lesson.topic,
        f"--seed {exercise.asked.seed}",
        f"--notation {exercise.asked.notation}",
    ]
    words += [f"--lines {exercise.asked.lines}"]
    words += [f"--slip {exercise.asked.slip}"] if exercise.asked.slip else []
    words += [f"--difficulty {exercise.asked.difficulty}"] if exercise.asked.difficulty else []
    words += [f"--carried {exercise.asked.carried}"] if exercise.asked.carried else []
    return " ".join(["eom exercise", *words])


def _line(words: str) -> str:
    """Return words on one line."""
    return " ".join(words.split())


_MARKDOWN = {WORDS: "{}", INLINE: "${}$", DISPLAY: "$${}$$"}


def markdown(paragraph: Iterable[Part]) -> str:
    """Return a paragraph as Markdown."""
    return "".join(_MARKDOWN[p.kind].format(p.text) for p in paragraph)
