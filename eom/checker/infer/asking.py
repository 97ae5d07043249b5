r"""Questions to the writer: the symbols on which most open lines hang, with what they may mean.

An answer is an entry of the draft like any other, with the writer as its source.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from eom.checker.infer.books import candidates as by_books
from eom.checker.infer.draft import Proposal
from eom.checker.infer.letters import GUESSED, Draft
from eom.checker.infer.sayings import look_of
from eom.checker.infer.shown import operands_of
from eom.checker.infer.systems import USUAL, Guess, Tie
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import slotted
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import Formula
from eom.checker.read.symbol_shape import Look
from eom.checker.read.writing import latex_of
from eom.checker.report.questions import Candidate, Question
from eom.errors import InputError

ANSWERED = "as the writer says"
SYSTEM = "system "
"""How the meaning begins of a symbol that is a quantity of the note's system."""
MAX_CANDIDATES = 9
_SILENT = frozenset({"d", "t", "pi", "infty"})


def questions(
    lines: Sequence[tuple[Formula, Lexicon, bool]], draft: Proposal
) -> tuple[Question, ...]:
    """Return what is open, most useful first.

    ``lines``: formulas that are open, the lexicon that holds there, and whether that is because of guesses.
    """
    found: dict[Look, list[int]] = {}
    for formula, lexicon, unsure in lines:
        for look in dict.fromkeys(operands_of(formula, lexicon)):
            guess = _guess(look, draft)
            entry = lexicon.find(look)
            is_open = bool(guess) if unsure else entry is None or bool(guess)
            if is_open and look.name not in _SILENT:
                found.setdefault(look, []).append(formula.piece.line)
    lexicon = lines[0][1] if lines else Lexicon()
    order = sorted(found, key=lambda k: -len(found[k]))
    return tuple(_question(k, tuple(found[k]), draft, lexicon) for k in order)


def _guess(look: Look, draft: Proposal) -> str:
    """Return what a symbol was taken for by its letter or custom alone."""
    for one in draft.systems:
        for tie in one.ties:
            if tie.look == look and tie.words == USUAL:
                return f"{SYSTEM}{tie.means}"
    latex = latex_of(look)
    own = (d for d in draft.drafts if d.latex == latex and d.words in GUESSED)
    return next((d.meaning for d in own), "")


def _question(look: Look, lines: tuple[int, ...], draft: Proposal, lexicon: Lexicon) -> Question:
    found = dict.fromkeys(_candidates(look, draft, lexicon))
    return Question(latex_of(look), lines, tuple(found)[:MAX_CANDIDATES], _guess(look, draft))


def _candidates(look: Look, draft: Proposal, lexicon: Lexicon) -> Iterator[Candidate]:
    """Yield what a symbol may mean: as it was taken, by words elsewhere, of the system, by books."""
    latex = latex_of(look)
    guess = _guess(look, draft)
    if guess:
        yield Candidate(latex, guess, "as it was taken")
    for other in draft.others:
        if other.latex == latex:
            yield Candidate(latex, other.meaning, f"line {other.line}: {other.words}")
    for one in draft.systems:
        taken = {t.means for t in one.ties}
        free = [x for x in one.letters if x.means not in taken and _known(one, x.means)]
        for letter in sorted(free, key=lambda x: look not in x.usual):
            if letter.marked == bool(look.accents or look.style):
                yield Candidate(latex, f"{SYSTEM}{letter.means}", f"of {one.name}")
    plain = replace(lexicon, layers=())
    for pattern, means in by_books(look, draft.body, plain):
        yield Candidate(pattern, means, "as in the usual books")


def _known(one: Guess, means: str) -> bool:
    """Return whether a system has a quantity."""
    try:
        one.model().meaning(means)
    except InputError:
        return False
    return True


def answered(draft: Proposal, latex: str, meaning: str) -> Proposal:
    """Return a draft in which a symbol has the meaning that the writer gives.

    Raises `InputError` where no lexicon takes it.
    """
    meaning = meaning.strip()
    if meaning.startswith(SYSTEM):
        return replace(draft, systems=tuple(_tied(draft.systems, latex, meaning)))
    look = look_of(read_formula(slotted(latex, latex)).tree)
    systems = tuple(
        replace(s, ties=tuple(t for t in s.ties if t.look != look)) for s in draft.systems
    )
    new = Draft("symbols", latex, meaning, ANSWERED, 0)
    kept = tuple(d for d in draft.drafts if (d.table, d.latex) != (new.table, new.latex))
    unplaced = tuple(u for u in draft.unplaced if u[0] != latex)
    return replace(draft, drafts=(*kept, new), systems=systems, unplaced=unplaced)


def left_open(draft: Proposal, question: Question) -> Proposal:
    """Return a draft without the guess of a question that nobody answered; its symbol is unplaced."""
    if not question.guess:
        return draft
    latex = question.latex
    look = look_of(read_formula(slotted(latex, latex)).tree)
    systems = tuple(
        replace(s, ties=tuple(t for t in s.ties if t.look != look)) for s in draft.systems
    )
    kept = tuple(d for d in draft.drafts if d.latex != latex or d.words not in GUESSED)
    unplaced = (*draft.unplaced, (latex, question.lines[0]))
    return replace(draft, drafts=kept, systems=systems, unplaced=unplaced)


def _tied(systems: Sequence[Guess], latex: str, meaning: str) -> Iterator[Guess]:
    """Yield the systems; the first has a letter more. Raises `InputError` where there is none."""
    look, means = look_of(read_formula(latex).tree), meaning.removeprefix(SYSTEM)
    if not systems or look is None:
        raise InputError("the note's system is not known", got=meaning)
    first = systems[0]
    first.model().meaning(means)
    kept = tuple(t for t in first.ties if t.look != look and t.means != means)
    yield replace(first, ties=(*kept, Tie(look, means, ANSWERED, 0)))
    yield from systems[1:]
