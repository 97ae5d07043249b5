r"""Questions to the writer: the symbols on which most open lines hang, with what they may mean.

An answer is an entry of the draft like any other, with the writer as its source. What a symbol may be of
the note's system is tried on the open lines: what makes them hold comes first, what does not fit them is
left out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from eom.checker.infer.books import candidates as by_books
from eom.checker.infer.draft import DRAFT, Meanings, Proposal
from eom.checker.infer.letters import GUESSED, Draft
from eom.checker.infer.plain import SYSTEM, Names, in_words, names_of, source_in_words
from eom.checker.infer.sayings import look_of
from eom.checker.infer.shown import operands_of
from eom.checker.infer.systems import USUAL, Guess, Tie
from eom.checker.infer.trials import judged_rows
from eom.checker.judge.verdicts import GRAVE
from eom.checker.mean.claims import STATEMENT, claims
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import lexicon_of, parse_lexicon, slotted
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import Formula
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.writing import latex_of
from eom.checker.report.questions import CONFIRMED, Candidate, Question
from eom.errors import InputError

ANSWERED = "as the writer says"
MAX_CANDIDATES = 9
MAX_TRIED = 3
"""Open lines on which candidates of a symbol are tried."""
_SILENT = frozenset({"d", "t", "pi", "infty"})


@dataclass(frozen=True)
class Open:
    """A formula that is open, with the lexicon that holds there; ``unsure``: whether because of guesses."""

    formula: Formula
    lexicon: Lexicon
    unsure: bool


def questions(
    lines: Sequence[Open], draft: Proposal, held: Mapping[str, Sequence[int]]
) -> tuple[Question, ...]:
    """Return what is open, most useful first: the symbol on which most ``lines`` hang.

    ``held``: lines that hold, by the symbols in them; a guess is not asked for where one does, for lines
    that are unsure where so many do that it counts as confirmed.
    """
    found: dict[Look, list[Open]] = {}
    said = {d.latex for d in draft.drafts if d.words == ANSWERED}
    said |= {t.latex for s in draft.systems for t in s.ties if t.words == ANSWERED}
    for one in lines:
        for look in dict.fromkeys(operands_of(one.formula, one.lexicon)):
            guess = _guess(look, [one], draft)
            entry = one.lexicon.find(look)
            enough = CONFIRMED if one.unsure else 1
            doubted = bool(guess) and len(held.get(latex_of(look), ())) < enough
            is_open = doubted or (entry is None and not one.unsure)
            if is_open and look.name not in _SILENT and latex_of(look) not in said:
                found.setdefault(look, []).append(one)
    order = sorted(found, key=lambda k: -len(found[k]))
    return tuple(_question(k, found[k], draft, held.get(latex_of(k), ())) for k in order)


def _names(draft: Proposal) -> Names:
    return names_of(draft.systems, draft.drafts)


def _here(lines: Sequence[Open], draft: Proposal) -> tuple[Guess, ...]:
    """Return the systems that some lines are about."""
    return tuple(s for s in draft.systems if any(s.holds_in(line.lexicon) for line in lines))


def _guess(look: Look, lines: Sequence[Open], draft: Proposal) -> str:
    """Return what a symbol was taken for in some lines, by its letter or custom alone."""
    for one in _here(lines, draft):
        for tie in one.ties:
            if tie.look == look and tie.words == USUAL:
                return f"{SYSTEM}{tie.means}"
    latex = latex_of(look)
    own = (d for d in draft.drafts if d.latex == latex and d.words in GUESSED)
    return next((d.meaning for d in own), "")


def _question(look: Look, lines: Sequence[Open], draft: Proposal, held: Sequence[int]) -> Question:
    guess = _guess(look, lines, draft)
    return Question(
        latex_of(look),
        tuple(one.formula.piece.line for one in lines),
        tuple(_candidates(look, lines, draft))[:MAX_CANDIDATES],
        guess,
        in_words(guess, _names(draft)) if guess else "",
        tuple(held) if guess else (),
    )


def _candidates(look: Look, lines: Sequence[Open], draft: Proposal) -> Iterator[Candidate]:
    """Yield what a symbol may mean: as it was taken, by words elsewhere, of the system, by the books."""
    latex, names = latex_of(look), _names(draft)
    done: set[str] = set()
    for pattern, means, why in (
        *_said(look, lines, draft),
        *_of_systems(look, lines, draft),
        *_by_note(look, lines),
        *_of_books(look, lines, draft),
    ):
        if means not in done:
            done.add(means)
            yield Candidate(pattern or latex, means, why, in_words(means, names))


_Row = tuple[str, str, str]
"""Pattern, "" for the symbol itself; meaning; what speaks for it."""


def _said(look: Look, lines: Sequence[Open], draft: Proposal) -> Iterator[_Row]:
    """Yield what a symbol was taken for, and what words say of it elsewhere."""
    guess = _guess(look, lines, draft)
    if guess:
        yield "", guess, "as it was taken"
    for other in draft.others:
        if other.latex == latex_of(look):
            yield "", other.meaning, source_in_words(other.words, other.line)


def _by_note(look: Look, lines: Sequence[Open]) -> Iterator[_Row]:
    """Yield that the note itself says what a symbol is, where it stands alone on the left."""
    for one in lines:
        left = [s.members[0] for s in one.formula.statements if s.relational]
        plain = [m for m in left if (found := seen(m)) is not None and not found.dots]
        if any(look_of(m) == look for m in plain):
            yield "", "defined", f"line {one.formula.piece.line} then is its definition"
            return


def _of_books(look: Look, lines: Sequence[Open], draft: Proposal) -> Iterator[_Row]:
    plain = replace(lines[0].lexicon, layers=())
    for pattern, means in by_books(look, draft.body, plain):
        said = answered(draft, pattern, means)
        tried = [_trial(one, with_answers(one.lexicon, said)) for one in lines[:MAX_TRIED]]
        if not all(trial.misfits for trial in tried):
            yield pattern, means, "as in the usual books"


def _of_systems(look: Look, lines: Sequence[Open], draft: Proposal) -> Iterator[_Row]:
    """Yield the quantities of systems that a symbol may be, those first with which lines hold."""
    here = _here(lines, draft)
    rows = [(one, m) for one in here for m in _free(one, look)]
    tried = [(_tried(one, means, look, lines, draft), one, means) for one, means in rows]
    least = min((row[0].misfits for row in tried), default=0)
    some = least < len(lines[:MAX_TRIED])
    fits = [row for row in tried if row[0].misfits == least and some]
    for trial, one, means in sorted(fits, key=lambda row: (-len(row[0].hold), row[0].failed)):
        numbers = " and ".join(map(str, trial.hold))
        lead = (
            f"line{'s' * (len(trial.hold) > 1)} {numbers} then hold{'s' * (len(trial.hold) == 1)}"
        )
        of = f"of {one.name}" if len(here) > 1 else "of the system"
        yield "", f"{SYSTEM}{means}", f"{of}; {lead}" if trial.hold else of


def _free(one: Guess, look: Look) -> Iterator[str]:
    """Yield the quantities of a system that no symbol stands for so far, those first whose letter it is."""
    taken = {t.means for t in one.ties}
    free = [x for x in one.letters if x.means not in taken and _known(one, x.means)]
    for letter in sorted(free, key=lambda x: look not in x.usual):
        if letter.marked == bool(look.accents or look.style):
            yield letter.means


def _known(one: Guess, means: str) -> bool:
    """Return whether a system has a quantity."""
    try:
        one.model().meaning(means)
    except InputError:
        return False
    return True


@dataclass(frozen=True)
class _Trial:
    """Which open lines hold with a meaning, how many fail, and how many by kinds or dimensions."""

    hold: tuple[int, ...] = ()
    failed: int = 0
    misfits: int = 0


def _tried(one: Guess, means: str, look: Look, lines: Sequence[Open], draft: Proposal) -> _Trial:
    """Return what becomes of open lines where a symbol is a quantity of a system."""
    kept = tuple(t for t in one.ties if t.look != look)
    guess = replace(one, ties=(*kept, Tie(look, means, ANSWERED, 0)))
    some = lines[:MAX_TRIED]
    tried = [_trial(line, guess.added(with_answers(line.lexicon, draft))) for line in some]
    hold = tuple(n for trial in tried for n in trial.hold)
    return _Trial(hold, sum(t.failed for t in tried), sum(t.misfits for t in tried))


def _trial(line: Open, lexicon: Lexicon) -> _Trial:
    """Return what becomes of an open line under a lexicon."""
    new = [c for s in line.formula.statements if s.relational for c in claims(s, lexicon)]
    misfits = any(c.findings and c.verdict in GRAVE for c in new)
    verdict = judged_rows([c for c in new if c.kind == STATEMENT])
    hold = (line.formula.piece.line,) if verdict == "held" else ()
    return _Trial(hold, int(verdict == "failed"), int(misfits))


def with_answers(lexicon: Lexicon, draft: Proposal) -> Lexicon:
    """Return a lexicon with what the writer said so far of symbols, in front of what it says itself."""
    said = {d.latex: d.meaning for d in draft.drafts if d.words == ANSWERED}
    if not said:
        return lexicon
    own, _ = lexicon_of({"symbols": said}, DRAFT)
    return replace(lexicon, layers=(*own.layers[:1], *lexicon.layers))


# -- answers -------------------------------------------------------------------------------------


def answered(draft: Proposal, latex: str, meaning: str) -> Proposal:
    """Return a draft in which a symbol has the meaning that the writer gives.

    Raises `InputError` where no lexicon takes it.
    """
    meaning = meaning.strip()
    unplaced = tuple(u for u in draft.unplaced if u[0] != latex)
    if meaning.startswith(SYSTEM):
        tied = tuple(_tied(draft.systems, latex, meaning))
        return replace(draft, systems=tied, unplaced=unplaced)
    look = look_of(read_formula(slotted(latex, latex)).tree)
    systems = tuple(
        replace(s, ties=tuple(t for t in s.ties if t.look != look)) for s in draft.systems
    )
    new = Draft("symbols", latex, meaning, ANSWERED, 0)
    kept = tuple(d for d in draft.drafts if (d.table, d.latex) != (new.table, new.latex))
    return replace(draft, drafts=(*kept, new), systems=systems, unplaced=unplaced)


def as_entry(answer: tuple[str, str | Candidate]) -> tuple[str, str]:
    """Return an answer to a question as an entry of a lexicon: pattern and meaning."""
    latex, said = answer
    return (said.latex, said.meaning) if isinstance(said, Candidate) else (latex, said)


def with_said(known: Meanings, answers: Sequence[tuple[str, str]]) -> Meanings:
    """Return meanings with what the writer says of symbols in front of a draft.

    Raises `InputError` where there is no draft, and for what no lexicon takes.
    """
    if not answers:
        return known
    if known.draft is None:
        raise InputError(
            "answers go before a draft, and here is a lexicon", where="answers", got=known.origin,
            hint="add them to the lexicon",
        )  # fmt: skip
    draft = known.draft
    for latex, meaning in answers:
        draft = answered(draft, latex, meaning)
    return Meanings(parse_lexicon(draft.toml, "answers"), f"{known.origin}, and answers", draft)


def left_open(draft: Proposal, question: Question) -> Proposal:
    """Return a draft without the guess of a question that nobody answered; its symbol is unplaced.

    A guess with which lines hold stays.
    """
    if not question.guess or question.confirmed:
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
    """Yield the systems; the first with the quantity has a letter more. Raises `InputError` for none."""
    look, means = look_of(read_formula(latex).tree), meaning.removeprefix(SYSTEM)
    if not systems or look is None:
        raise InputError("the note's system is not known", got=meaning)
    chosen = next((s for s in systems if _known(s, means)), systems[0])
    chosen.model().meaning(means)
    for one in systems:
        kept = tuple(t for t in one.ties if t.look != look and t.means != means)
        tie = Tie(look, means, ANSWERED, 0)
        yield replace(one, ties=(*kept, tie)) if one is chosen else one
