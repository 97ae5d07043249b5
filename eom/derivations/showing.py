"""A derivation as text, LaTeX, Markdown or HTML, in any notation: symbols, steps, reasons, result.

Steps that transform one left side stand as one chain. Each step says why it holds, which equations
of the lectures it states, and how it was verified; assumptions are named where they are made.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import Any, Protocol

import sympy as sp

from eom.derivations import standing
from eom.derivations.corrections import CLAIMS, NOTES
from eom.derivations.standing import Stands
from eom.derivations.steps import Step
from eom.derivations.verification import Scalars
from eom.derivations.wording import (
    factors,
    frames_of,
    letters_in_words,
    notation_of,
    spelt,
    spoken,
    terms_of,
)
from eom.errors import unknown_name
from eom.system import System
from eom.terms.terms import (
    DYADIC,
    SCALAR,
    VECTOR,
    Equation,
    Term,
    add,
    entries,
    mul,
    nodes,
    zero,
)
from eom.terms.vocabulary import QUANTITIES, words
from eom.typeset import pages, printing
from eom.typeset.blocks import (
    EQUALS,
    Block,
    Bullets,
    Display,
    Drawing,
    Heading,
    Line,
    Note,
    Paragraph,
    Steps,
    is_wide,
)
from eom.typeset.boxes import (
    GREEK,
    Box,
    Fence,
    Formula,
    Operator,
    Row,
    Scripts,
    Symbol,
    Words,
    joined,
    nucleus,
    row,
    symbol,
)
from eom.typeset.letters import Notation
from eom.typeset.markup import render, symbol_latex, width
from eom.typeset.notation import equation_parts, notation_named, term_box, write
from eom.typeset.sentences import Prose, phrases
from eom.typeset.writing import expression_pieces
from eom.worlds.worlds import ASSUMPTIONS, closure


class Shown(Protocol):
    """What is shown of a derivation, as of `eom.derivations.derived.Derived`."""

    @property
    def title(self) -> str:
        """Its heading."""

    @property
    def group(self) -> str:
        """The chapter that it belongs to."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """Its steps, in order."""

    @property
    def scalars(self) -> Scalars:
        """What its own scalars are, as terms."""

    @property
    def result(self) -> Mapping[str, Any]:
        """What it gives, by name."""

    @property
    def letters(self) -> Mapping[Any, str]:
        """What other symbols are, in words."""

    @property
    def stands(self) -> Stands:
        """What results, and quantities of systems, are, by name."""

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Every assumption that some step makes."""


def assumption_in_words(assumption: str, letters: Mapping[str, int]) -> str:
    """Return an assumption in words, with those it includes by their numbers: ``letters`` of a page.

    One that another included one includes is not told.
    """
    needed = [a for a in letters if a in closure([assumption]) - {assumption}]
    told = [a for a in needed if not any(a in closure([b]) for b in needed if b != a)]
    others = ", ".join(f"A{letters[a]}" for a in told)
    return meaning_of(assumption) + (f" (includes {others})" if others else "")


def meaning_of(assumption: str) -> str:
    """Return an assumption in words."""
    return ASSUMPTIONS[assumption].meaning


Item = tuple[Box | str | None, Prose]


def show_steps(
    derivation: Shown, labels: Collection[str], style: str = "text", notation: str = "arrow"
) -> str:
    """Return some steps of a derivation, numbered as in the whole.

    All else as `eom.derivations.forms.show_derivation`.
    """
    check_choices(style, notation)
    chosen = notation_of(derivation, notation_named(notation))
    derivation = spelt(derivation, chosen)
    return FORMATS[style](list(_derived(derivation, chosen, labels)))


def check_choices(style: str, notation: str) -> None:
    """Raise `InputError` for unknown formats and notations."""
    if style not in FORMATS:
        raise unknown_name("format", style, FORMATS)
    notation_named(notation)


@dataclass(frozen=True)
class Drawn:
    """A picture of a derivation, and the ``things`` in it: frames, terms, labels of steps, assumptions."""

    things: frozenset[Any]
    drawing: Drawing


def blocks(
    derivation: Shown,
    notation: Notation,
    steps: bool = True,
    drawn: Sequence[Drawn] = (),
) -> Iterator[Block]:
    """Yield what there is to show, in reading order; ``drawn``: pictures, where they are introduced."""
    yield Heading(derivation.title, 1)
    yield Paragraph(_summary(derivation, notation))
    yield from _listed("Assumptions", tuple(_assumed(derivation, notation)))
    yield from _listed("Symbols", tuple(symbols(derivation, notation)))
    yield Heading("Derivation" if steps else "Statements")
    if steps:
        yield from _derived(derivation, notation, drawn=drawn)
    else:
        yield from (one.drawing for one in drawn)
        yield _statements(derivation, notation)
    yield from results(derivation, notation)


def _assumed(derivation: Shown, notation: Notation) -> Iterator[Item]:
    """Yield assumptions by the letters they are called by."""
    known = letters_in_words(derivation, notation)
    letters = letters_of(derivation)
    for a, k in letters.items():
        yield f"A{k}", phrases(assumption_in_words(a, letters), known)


def _summary(derivation: Shown, notation: Notation) -> str:
    count = len(numbers(derivation, notation))
    return (
        f"{derivation.group}; {count} step{'s' * (count != 1)}, each verified when it was made. "
        f"Notation: {notation.title}."
    )


def _listed(heading: str, items: tuple[Item, ...]) -> list[Block]:
    return [Heading(heading), Bullets(items)] if items else []


# -- symbols ---------------------------------------------------------------------------------


def symbols(derivation: Shown, notation: Notation) -> Iterator[tuple[Box, Prose]]:
    """Yield symbols with their meanings: quantities, SymPy symbols, then signs of operations."""
    found = terms_of(derivation)
    seen: set[str] = set()
    own = {t for t in derivation.scalars.values() if t.data and t.data[0] in _ANY}
    items = [_quantity(n, notation) for n in found if n.head == "atom" and n not in own]
    items += [_scalar(s, t, derivation, notation) for s, t in derivation.scalars.items()]
    shown = {render(box, "text") for box, _ in items}
    letters = ((symbol(s.name), meaning) for s, meaning in _letters_of(derivation, found))
    items += [(box, meaning) for box, meaning in letters if render(box, "text") not in shown]
    items += [_named_in_words(one, derivation, notation) for one in _spoken(derivation, notation)]
    items += _of_systems(derivation, notation)
    items += list(_operations(found, notation))
    known = letters_in_words(derivation, notation)
    for box, meaning in items:
        called = render(box, "text").partition(" := ")[0]
        if called not in seen:
            seen.add(called)
            yield box, phrases(meaning, known)


_ANY = frozenset({"scalar", "coordinate", "angle"})
"""Quantities that are any: of those with a symbol it is said what this is."""


def _letters_of(derivation: Shown, found: Iterable[Term]) -> Iterator[tuple[Any, str]]:
    """Yield the symbols that stand for no term, with what they are in words."""
    systems = [r for r in derivation.result.values() if isinstance(r, System)]
    told = {q.symbol: q.meaning for s in systems for q in (*s.parameters, *s.states, *s.inputs)}
    told |= derivation.letters
    used = {s for n in found if n.head == "expr" for s in n.data[0].free_symbols}
    formulas = (v for v in derivation.result.values() if isinstance(v, sp.MatrixBase | sp.Expr))
    used |= {s for v in formulas for s in v.free_symbols}
    for s in sorted(used - set(derivation.scalars), key=sp.default_sort_key):
        if s in told:
            yield s, told[s]


def _spoken(derivation: Shown, notation: Notation) -> Iterator[Any]:
    """Yield the quantities and symbols that reasons, assumptions and meanings of letters name."""
    said = [_SAID.get(tag, "") for s in derivation.steps for tag in s.states]
    reasons = [s.reason for s in derivation.steps]
    texts = [
        *map(meaning_of, derivation.assumptions),
        *reasons,
        *said,
        *derivation.letters.values(),
    ]
    return spoken(derivation, texts, notation)


def _named_in_words(one: Any, derivation: Shown, notation: Notation) -> tuple[Box, str]:
    if not isinstance(one, Term):
        return symbol(one.name), derivation.letters[one]
    box, meaning = _quantity(one, notation)
    return box, derivation.letters.get(one, meaning)


def _of_systems(derivation: Shown, notation: Notation) -> Iterator[tuple[Box, str]]:
    """Yield the letters of systems among the results with their meanings."""
    for letter, term, q in standing.listed(derivation, notation):
        shown = letter or Formula(q.symbol, {q.symbol: q.latex} if q.latex else {})
        if term is not None:
            shown = Row((shown, Operator(":="), term_box(term, notation)))
        yield shown, q.meaning


def _quantity(term: Term, notation: Notation) -> tuple[Box, str]:
    name, *labels = term.data
    if name in _OF_FRAMES:  # a frame may be called C like the centre of mass
        return term_box(term, notation), QUANTITIES[name].words.format(*labels)
    return term_box(term, notation), words(term)


_OF_FRAMES = frozenset({"angular_velocity", "rotation", "unit"})


def _scalar(name: Any, meaning: Term, derivation: Shown, notation: Notation) -> tuple[Box, str]:
    """Return a SymPy symbol, what it stands for, and the reason of the step that names it."""
    reasons = [
        s.reason
        for s in derivation.steps
        if s.kind == "definition" and s.statement.left == Term("expr", (), (name,))
    ]
    box = term_box(meaning, notation)
    same = render(box, "latex") == symbol_latex(name.name)
    shown = symbol(name.name) if same or is_wide(box) else Row((Formula(name), Operator(":="), box))
    rate = _RATE if meaning.head == "der" and same else ""
    return shown, reasons[0] if reasons else rate


_RATE = "rate of change in time"
"""What is said of a dotted scalar, as the scalar itself is listed."""

_OPERATIONS: dict[str, Callable[[str, str], str]] = {
    "der": lambda frame, of: f"rate of change of the {of} as seen from frame {frame}",
    "column": lambda frame, of: f"components of the {of} in frame {frame}",
    "tilde": lambda *_: "skew matrix of a column: that of the cross product with it",
}


def _operations(found: Iterable[Term], notation: Notation) -> Iterator[tuple[Box, str]]:
    """Yield one example of each kind of derivative, column and tilde that occurs."""
    seen = set()
    for node in found:
        key = (node.head, node.data, node.kind)
        if node.head not in _OPERATIONS or key in seen or not _is_example(node):
            continue
        seen.add(key)
        kind = node.args[0].kind
        if node.head != "der" or kind in {VECTOR, DYADIC}:
            frame = str(node.data[0]) if node.data else ""
            yield term_box(node, notation), _OPERATIONS[node.head](frame, kind)


def _is_example(node: Term) -> bool:
    (inside,) = node.args
    return inside.head == "atom" or (inside.head == "column" and inside.args[0].head == "atom")


# -- steps -----------------------------------------------------------------------------------


def _derived(
    derivation: Shown,
    notation: Notation,
    chosen: Collection[str] | None = None,
    drawn: Sequence[Drawn] = (),
) -> Iterator[Block]:
    """Yield one block a chain, of the chosen steps, or of all; pictures stand before it."""
    left = list(drawn)
    notes_of = _Notes(derivation, notation, numbers(derivation, notation))
    spoken = (s for s in derivation.steps if not only_names(s, notation))
    for chain in chains(spoken):
        for one in [one for one in left if one.things & _things(chain)]:
            left.remove(one)
            yield one.drawing
        lines: list[tuple[Line, ...]] = []
        notes: list[Note] = []
        for step in chain:
            if chosen is not None and step.label not in chosen:
                continue
            lines.append(lines_of(step.statement, notation, first=not lines))
            notes.append(notes_of(step))
        if lines:
            yield Steps(tuple(notes), tuple(lines))


def _things(chain: Iterable[Step]) -> set[Any]:
    """Return what some steps speak of, as in `Drawn`."""
    found: set[Any] = set()
    for step in chain:
        terms = [n for t in (step.statement.left, step.statement.right) for n in nodes(t)]
        found |= {step.label, *step.assumptions, *terms}
        found |= {("frame", f) for f in frames_of(terms)}
    return found


def numbers(derivation: Shown, notation: Notation) -> dict[str, int]:
    """Return the number of each step that is shown, by its label; what only names has none."""
    spoken = (s for s in derivation.steps if not only_names(s, notation))
    return {step.label: k for k, step in enumerate(spoken, 1)}


def separate(derivation: Shown, notation: Notation) -> Iterator[Steps]:
    """Yield one block a step, each an equation of its own with its whole left side on one line."""
    numbered = {s.label: k for k, s in enumerate(derivation.steps, 1)}
    notes_of = _Notes(derivation, notation, numbered)
    for step in derivation.steps:
        left, relation, right = equation_parts(step.statement, notation)
        lines = lines_of(step.statement, notation)
        if len(lines) == 1 and not is_wide(row(*left)):
            lines = (Line(row(*left), relation, right),)
        yield Steps((notes_of(step),), (lines,))


def only_names(step: Step, notation: Notation) -> bool:
    """Return whether a definition has the same letter on both sides; the symbols list it."""
    sides = [write(t, notation) for t in (step.statement.left, step.statement.right)]
    return step.statement.relation == ":=" and sides[0] == sides[1]


def chains(steps: Iterable[Step]) -> list[list[Step]]:
    """Group neighbouring steps that state the same left side by equations or definitions."""

    def key(step: Step) -> tuple[Term, bool]:
        return step.statement.left, step.statement.relation in {"=", ":="}

    return [list(group) for _, group in groupby(steps, key)]


def lines_of(equation: Equation, notation: Notation, first: bool = True) -> tuple[Line, ...]:
    """Return the lines of an equation; a matrix that is too wide is stated entry by entry."""
    left, relation, right = equation_parts(equation, notation)
    if width(Row((*left, *right))) > WIDEST and _parts(equation.right):
        shown = tuple(_entry_lines(equation, notation, first))
        if shown:
            return shown
    return (Line(row(*left) if first else None, relation, right, broken_left=left),)


WIDEST = 84
"""Letters up to which a matrix stands on one line."""


def _parts(term: Term) -> list[Term]:
    """Return the entries of an explicit matrix or column, of a multiple or a sum of them, or none."""
    if term.head == "entries":
        return list(term.args)
    if term.head == "mul":
        return [mul(*term.args[:-1], p) for p in _parts(term.args[-1])]
    if term.head == "add":
        found = [_parts(a) for a in term.args]
        return [add(*parts) for parts in zip(*found, strict=True)] if all(found) else []
    return []


def _entry_lines(equation: Equation, notation: Notation, first: bool) -> Iterator[Line]:
    """Yield a line for each entry that is not trivial; of equal ones, for the first."""
    right, known = _parts(equation.right), _parts(equation.left)
    matrix: Box = Fence(term_box(equation.left, notation))
    if not known and is_wide(matrix):
        if first:
            left, _, _ = equation_parts(equation, notation)
            yield Line(row(*left), EQUALS, (_DOTS,), broken_left=left)
        matrix = _DOTS
    seen = set()
    for k, entry in enumerate(right):
        old = known[k] if known else zero(SCALAR)
        if (old, entry) in seen or old == entry:
            continue
        seen.add((old, entry))
        left, relation, pieces = equation_parts(replace(equation, left=old, right=entry), notation)
        shown = left if known else (Scripts(matrix, _place(k, len(right))),)
        yield Line(row(*shown), relation, pieces, broken_left=shown)


_DOTS = Fence(Words("..."))


def _place(k: int, count: int) -> Symbol:
    """Return row and column of an entry."""
    size = count // 3
    return Symbol(f"{k // size + 1}{k % size + 1}" if size > 1 else str(k + 1))


_SAID = {**NOTES, **CLAIMS}
"""What is said beside the tag of a display or claim."""

MUNDANE = frozenset(
    {
        "the same on both sides",
        "linearity",
        "like terms",
        "order of factors",
        "algebra",
        "substitution",
    }
)
"""Rules that are named where no other one is applied."""


@dataclass
class _Notes:
    """What stands beside each step; an assumption is put into words where it first counts.

    ``numbers``: of the steps by label; ``told``: the assumptions, and the displays and claims of the
    lectures, that stand in words already.
    """

    derivation: Shown
    notation: Notation
    numbers: Mapping[str, int]
    told: set[str] = field(default_factory=set)
    known: Mapping[str, Box] = field(init=False)

    def __post_init__(self) -> None:
        self.known = letters_in_words(self.derivation, self.notation)

    def __call__(self, step: Step) -> Note:
        kind = step.kind if step.kind not in {"result", step.evidence} else ""
        letters = letters_of(self.derivation)
        new = [a for a in letters if a in step.assumptions and a not in self.told]
        self.told.update(new)
        under = ", ".join(f"A{letters[a]}" for a in letters if a in step.assumptions)
        evidence = "" if step.by and step.evidence.startswith("held") else step.evidence
        states = map(self._stated, step.states)
        parts = [kind, *states, self._origin(step), f"under {under}" if under else "", evidence]
        remarks = "; ".join(p for p in parts if p)
        assumed = "; ".join(f"(A{letters[a]}) {meaning_of(a)}" for a in new)
        told = f"Assumed: {assumed}." if assumed else ""
        words = capitalised(step.reason, self.known)
        said, before = (phrases(w, self.known) for w in (words, told))
        beside = phrases(remarks, {**self.known, **factors(self.notation)}, apart=True)
        return Note(self.numbers[step.label], said, beside, before)

    def _stated(self, label: str) -> str:
        """Return the label of a display or claim, at its first mention with what was corrected in it."""
        said = _SAID.get(label, "") if label not in self.told else ""
        self.told.add(label)
        return f"{label} ({said})" if said else label

    def _origin(self, step: Step) -> str:
        """Say from which lines a step follows, and by which rules."""
        lines = ", ".join(str(self.numbers[f]) for f in step.follows if f in self.numbers)
        telling = [b for b in step.by if b not in MUNDANE]
        by = ", ".join(telling or step.by[:1])
        return " ".join(
            p for p in (f"from {lines}" if lines else "", f"by {by}" if by else "") if p
        )


def letters_of(derivation: Shown) -> dict[str, int]:
    """Return the numbers by which assumptions are called."""
    return {a: k for k, a in enumerate(derivation.assumptions, 1)}


_FIRST_WORD = re.compile(r"(a )?([a-z]{2,})(?![\w/.(])")


def capitalised(reason: str, known: Mapping[str, Box]) -> str:
    """Begin with a capital letter unless the first word is a symbol."""
    found = _FIRST_WORD.match(reason)
    starts = found is not None and found[2] not in {*GREEK, *known}
    return reason[:1].upper() + reason[1:] if starts else reason or "Statement"


def _statements(derivation: Shown, notation: Notation) -> Block:
    """Return the last statement of every chain, with its equations of the lectures."""
    spoken = (s for s in derivation.steps if not only_names(s, notation))
    finals = [chain[-1] for chain in chains(spoken)]
    return Display(tuple(line for s in finals for line in lines_of(s.statement, notation)))


# -- results ---------------------------------------------------------------------------------


def results(derivation: Shown, notation: Notation) -> Iterator[Block]:
    """Yield the results of a derivation under their heading, systems last."""
    if derivation.result:
        yield Heading("Result")
    known = letters_in_words(derivation, notation) | standing.spoken(derivation, notation)
    named = _Results(derivation, notation, known)
    rows = sorted(derivation.result.items(), key=lambda row: isinstance(row[1], System))
    for name, value in rows:  # a system has headings of its own
        yield from named.blocks(name, value)


@dataclass(frozen=True)
class _Results:
    """The results of a derivation in a notation; ``known``: the letters in their words."""

    derivation: Shown
    notation: Notation
    known: Mapping[str, Box]

    def blocks(self, name: str, value: Any) -> Iterator[Block]:
        """Yield a system, a statement, an expression, a collection of them, or any other value."""
        if isinstance(value, System):
            yield from self._system(value)
        elif parts := _parts_of(name, value):
            for key, part in parts:
                yield from self.blocks(key, part)
        elif isinstance(value, Equation):
            yield Display(lines_of(value, self.notation))
        elif isinstance(value, sp.MatrixBase) and value.shape in {(3, 1), (3, 3)}:
            yield Display(self._matrix(name, entries(value)))
        elif _is_formula(value):
            yield Display((Line(self._left(name), EQUALS, _pieces(value, self.notation)),))
        else:
            yield Paragraph(f"{name.replace('_', ' ')}: {value}")

    def _system(self, system: System) -> Iterator[Block]:
        yield Heading(system.title or system.name, 3)
        shown = standing.shown_part(self.derivation, system)
        letters = standing.letters_of(self.derivation, shown, self.notation)
        for block in printing.blocks(
            shown, letters=letters, worded=lambda w: phrases(w, self.known), codes=False
        ):
            yield Heading(block.words, 4) if isinstance(block, Heading) else block

    def _matrix(self, name: str, value: Term) -> tuple[Line, ...]:
        """Return a matrix with its name, entry by entry if it is wide."""
        term = self.derivation.stands.get(name)
        if isinstance(term, Term):
            return lines_of(Equation(term, value), self.notation)
        lines = lines_of(Equation(Term("expr", (), (sp.Symbol(name),)), value), self.notation)
        left = self._left(name)
        return (replace(lines[0], left=left, broken_left=()),) if len(lines) == 1 else lines

    def _left(self, name: str) -> Box:
        """Return what a result stands for, its letter with indices, or words."""
        term = self.derivation.stands.get(name)
        if isinstance(term, Term):
            return standing.box_of(term, self.notation)
        letter = name.partition("_")[0].rstrip("0123456789")
        if term is None and nucleus(letter).style == "italic":
            return symbol(name)
        words = phrases(term or name.replace("_", " "), self.known)
        return row(*(Words(w) if isinstance(w, str) else w for w in words))


def _parts_of(name: str, value: Any) -> list[tuple[str, Any]]:
    """Return the parts of a collection by name, or none for other values."""
    if isinstance(value, Mapping):
        return [(f"{name}: {key}", part) for key, part in value.items()]
    found = value if isinstance(value, tuple | list) else ()
    parts = [
        sp.Tuple(*v) if isinstance(v, tuple) and any(map(_is_formula, v)) else v for v in found
    ]
    if not any(map(_is_formula, parts)):
        return []
    return [(f"{name}_{k}", part) for k, part in enumerate(parts, 1)]


def _is_formula(value: Any) -> bool:
    return isinstance(value, Equation | Term | sp.Basic | sp.MatrixBase)


def _pieces(value: Any, notation: Notation) -> tuple[Box, ...]:
    if isinstance(value, Term):
        return (term_box(value, notation),)
    if isinstance(value, sp.Tuple):
        parts = [row(*_pieces(part, notation)) for part in value]
        return (Fence(joined(parts) or Row(())),)
    return expression_pieces(value) if isinstance(value, sp.Expr) else (Formula(value),)


def _latex(shown: list[Block]) -> str:
    return pages.LATEX_DOCUMENT % pages.latex_page(shown)


def _html(shown: list[Block]) -> str:
    title = next((b.words for b in shown if isinstance(b, Heading)), "Derivation")
    return pages.html_page(shown, title)


FORMATS: dict[str, Callable[[list[Block]], str]] = {
    "text": pages.text_page,
    "latex": _latex,
    "markdown": pages.markdown_page,
    "html": _html,
}
"""How a derivation can be shown."""
