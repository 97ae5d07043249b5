r"""Which system a note, or a part of it, is about: the one under which most of its lines hold.

Rows that words name are tried with the letters of the note, and angles counted either way; a system is
taken only where lines of the note hold with it. No line that fails counts against it: notes have slips.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice, pairwise

from eom.checker.infer.composed import rows as composed
from eom.checker.infer.sayings import Prose, look_of, prose, said
from eom.checker.infer.setups import setup
from eom.checker.infer.systems import (
    MAX_ROWS,
    Guess,
    Row,
    Spoken,
    Tie,
    candidates,
    choices,
    guesses,
    led,
    rows,
    spoken,
    ties,
)
from eom.checker.judge.coordinates import covered
from eom.checker.judge.judge import is_nearly, models_of
from eom.checker.judge.members import of_members
from eom.checker.judge.models import Search
from eom.checker.judge.systems import LEVELS, agreeing, levelled
from eom.checker.judge.verdicts import GRAVE
from eom.checker.mean.claims import EQUALITIES, STATEMENT, Claim, claims, defined
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.values import Value, atoms_in
from eom.checker.read.documents import Document, Piece
from eom.checker.read.statements import Statement, read
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import Node, Number, children, walk
from eom.errors import InputError

ENOUGH = 2
"""Lines that have to hold for a system to be taken; one, where fewer fail."""
FEW = 4
"""Lines of a passage of which also those count that are about what is derived of a system."""
UNNAMED = 3
"""Lines that have to hold for a system that no words name."""
SILENT = frozenset({"t", "pi", "infty"})
"""Letters that mean the same everywhere."""


@dataclass(frozen=True)
class Part:
    """A heading with all that stands below it up to the next of its level, or a whole note."""

    headings: tuple[str, ...]
    document: Document

    @cached_property
    def text(self) -> Prose:
        """Its sentences."""
        return prose(self.document)

    @cached_property
    def words(self) -> str:
        """Its words, with those of its headings."""
        titles = (p.body for p in self.document.pieces if p.kind == "heading")
        return " ".join((*titles, *map(self.text.shown, self.text.sentences)))

    @cached_property
    def said(self) -> tuple[Spoken, ...]:
        """What its words say of letters."""
        return (*spoken(self.text, said(self.text)), *led(self.document))

    @cached_property
    def lines(self) -> tuple[tuple[Statement, ...], ...]:
        """Its displays, each as statements."""
        displays = (f for f in read(self.document) if f.piece.kind == "display" and f.relational)
        return tuple(tuple(s for s in f.statements if s.relational) for f in displays)

    @cached_property
    def dotted(self) -> frozenset[Look]:
        """Its symbols that stand with a dot."""
        members = (m for line in self.lines for s in line for m in s.members)
        found = (seen(n) for m in members for n in walk(m))
        return frozenset(s.look for s in found if s is not None and s.dots)

    @cached_property
    def looks(self) -> tuple[Counter[Look], Mapping[Look, int]]:
        """The symbols of its displays with how often they stand there, and their first lines."""
        count: Counter[Look] = Counter()
        lines: dict[Look, int] = {}
        for formula in read(self.document):
            if formula.piece.kind != "display":
                continue
            members = [m for s in formula.statements for m in s.members]
            for look in (*_looks(members), *_instants(members)):
                count[look] += 1
                lines.setdefault(look, formula.piece.line)
        return count, lines


def _looks(nodes: Iterable[Node]) -> Iterator[Look]:
    """Yield the symbols of formulas, with their labels."""
    for node in nodes:
        look = None if isinstance(node, Number) else look_of(node)
        if look is not None and seen(node) is not None:
            if look.name not in SILENT:
                yield look
            continue
        yield from _looks(children(node))


def _instants(members: Sequence[Node]) -> Iterator[Look]:
    """Yield the letter of time where it stands for an instant: alone on one side, and nowhere else."""
    alone = [m for m in members if look_of(m) == _TIME]
    if len(alone) == 1 and all(
        look_of(n) != _TIME for m in members if m is not alone[0] for n in walk(m)
    ):
        yield _TIME


_TIME = Look("t")


def parts(document: Document) -> tuple[Part, ...]:
    """Return the parts of a note by its headings, each down to the next of the same level or above."""
    pieces = document.pieces
    places = [k for k, p in enumerate(pieces) if p.kind == "heading"]
    found = []
    for k in places:
        ends = (j for j in places if j > k and pieces[j].level <= pieces[k].level)
        own = pieces[k : next(ends, len(pieces))]
        found.append(Part((_title(pieces[k]),), replace(document, pieces=own)))
    return tuple(found)


def _title(piece: Piece) -> str:
    return piece.body.strip("# \n\t")


# -- trials --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Trial:
    """A system with how many lines hold under it, which fail, and of how many it says nothing.

    ``lines``: which were tried, None for all; ``misfits``: how many fail by their kinds or dimensions.
    """

    guess: Guess
    held: int
    failed: frozenset[int]
    open: int
    lines: frozenset[int] | None = None
    misfits: int = 0

    @property
    def cost(self) -> tuple[int, int, int]:
        """What makes one trial worse than another."""
        return -self.held, self.misfits, self.open


@dataclass
class Trials:
    """The systems that are tried in a part, under the lexicon of its words; each line read once.

    ``deep``: whether lines on what is derived of a system count, which takes longer.
    """

    part: Part
    lexicon: Lexicon
    deep: bool = False
    done: dict[str, Trial] = field(default_factory=dict)

    def best(self, *, named: bool = True) -> Trial | None:
        """Return the trial in which most lines hold; None where none holds in any.

        ``named``: of the systems that words name, else of those that have most letters of the part. Once
        most lines hold under a system no other is tried.
        """
        part, (count, lines) = self.part, self.part.looks
        words = part.words if named else ""
        found = (
            candidates(words, part.said, count, lines, part.dotted, several=not named)
            if count and (words.strip() or not named)
            else []
        )
        composed = self._composed() if named and count else []
        best: Trial | None = None
        for row, tied, name in (*composed, *found[:MAX_ROWS]):
            new = self._of_row(row, tied, name)
            best = min(
                (t for t in (best, new) if t is not None), key=lambda t: t.cost, default=None
            )
            if best is not None and 2 * best.held > len(self.part.lines):
                break
        if best is None or not best.held:
            return None
        whole = (t for t in self.done.values() if t.lines is None and t.guess != best.guess)
        rivals = tuple(t.guess for t in whole if t.held >= best.held)
        return replace(best, guess=replace(best.guess, rivals=rivals))

    def _composed(self) -> list[tuple[Row, tuple[Tie, ...], str]]:
        """Return the systems that sentences of the part compose of parts, with letters."""
        part = self.part
        read = setup(part.text, part.document, part.said)
        found = () if read is None else composed(read)
        lines = part.looks[1]
        return [(r, ties(r, part.said, lines, part.dotted), read.words) for r in found if read]

    def alone(self) -> Trial | None:
        """Return the system under which lines without words hold, by letters that are usual for it.

        Where they hold under none: the first under which nothing but that can be said of them.
        """
        count, lines = self.part.looks
        failed: Trial | None = None
        for row, tied, _ in candidates("", (), count, lines, self.part.dotted):
            for letters in choices(row, tied):
                for guess in guesses(row, letters, "", "", turned=False):
                    new = self.trial(guess, deep=True)
                    if new is not None and new.held == len(self.part.lines):
                        return new
                    if new is not None and (new.failed or new.misfits):
                        failed = min((t for t in (failed, new) if t), key=lambda t: t.misfits)
        return failed

    def _of_row(self, row: Row, tied: tuple[Tie, ...], name: str) -> Trial | None:
        """Return the best trial of a row: first its letters, then its sizes and how angles are counted.

        What else may be meant is tried on the lines that fail.
        """
        first = next(guesses(row, tied, self.part.words, name), None)
        if first is None:
            return None
        letters = [self.trial(replace(first, ties=t)) for t in islice(choices(row, tied), 4)]
        best = min((t for t in letters if t is not None), key=lambda t: t.cost, default=None)
        if best is None:
            return None
        for guess in guesses(row, best.guess.ties, self.part.words, name):
            if not best.failed:
                break
            again = self.trial(guess, best.failed)
            other = self.trial(guess) if again is not None and again.held else None
            best = best if other is None else min(best, other, key=lambda t: t.cost)
        return best

    def trial(
        self, guess: Guess, lines: frozenset[int] | None = None, *, deep: bool = False
    ) -> Trial | None:
        """Return what holds under a system, of some lines or all; None where it cannot be used.

        ``deep``: whether lines on what is derived of the system are judged, too.
        """
        key = repr((guess.table, guess.ties, lines and sorted(lines)))
        if key not in self.done:
            try:
                lexicon = guess.added(self.lexicon)
            except InputError:
                return None
            self.done[key] = trial(guess, self.part, lexicon, lines, deep=deep or self.deep)
        return self.done[key]


def trial(
    guess: Guess,
    part: Part,
    lexicon: Lexicon,
    lines: frozenset[int] | None = None,
    *,
    deep: bool = False,
) -> Trial:
    """Return how many lines hold, which fail, how many are left under a system."""
    found: dict[str, set[int]] = {v: set() for v in ("held", "failed", "open")}
    known: dict[Look, Value] = {}
    misfits = 0
    for number, statements in enumerate(part.lines):
        if lines is not None and number not in lines:
            continue
        rows: list[Claim] = []
        for statement in statements:
            new = claims(statement, lexicon, known)
            known |= defined(new)
            rows += [c for c in new if c.kind == STATEMENT]
        found[judged_rows(rows, deep)].add(number)
        misfits += any(c.findings and c.verdict in GRAVE for c in rows)
    held, failed = len(found["held"]), frozenset(found["failed"])
    return Trial(guess, held, failed, len(found["open"]), lines, misfits)


def judged_rows(rows: Sequence[Claim], deep: bool = False) -> str:
    """Return what is to be said of the claims of a line about a system: held, failed or open."""
    about = [c for c in rows if covered(c)]
    if not about:
        return "open"
    verdicts = {_held(c, deep) for c in about}
    return next(v for v in ("failed", "open", "held") if v in verdicts)


def _held(claim: Claim, deep: bool = False) -> str:
    """Return whether a claim holds at a random point of the system's motion, or with another zero of V."""
    if claim.findings:
        return "failed" if claim.verdict in GRAVE else "open"
    if of_members(claim) or is_nearly(claim) or not EQUALITIES.issuperset(claim.relations):
        return _at_once(claim) if deep else "open"
    if agreeing(claim) == len(claim.members) - 1:
        return "held"
    other = levelled(claim) if _of_energy(claim) else None
    moved = other is not None and agreeing(replace(claim, model=other)) == len(claim.members) - 1
    return "held" if moved else "failed"


def _at_once(claim: Claim) -> str:
    """Return whether a claim holds without any condition."""
    try:
        search = Search(models_of(claim))
        _, base = search.base
        said = bool(search.models.said) and not is_nearly(claim)
        return "held" if said and search.holds(base) else "failed" if said else "open"
    except InputError:
        return "open"


def _of_energy(claim: Claim) -> bool:
    """Return whether a claim is about a quantity that depends on where potential energy is zero."""
    atoms = (a for m in claim.members for a in atoms_in(m.term, claim.scalars))
    return any(a.data[0] == "system" and a.data[1] in LEVELS for a in atoms)


def systems(document: Document, lexicon: Lexicon) -> tuple[Guess, ...]:
    """Return the systems that a note is about: of the whole, then of parts that are about another."""
    whole = Trials(Part((), document), lexicon)
    if not whole.part.words.strip() and len(whole.part.lines) < ENOUGH:
        alone = whole.alone()
        return (alone.guess,) if alone is not None else ()
    best = whole.best()
    if best is None or not _enough(best):
        by_letters = whole.best(named=False)
        best = by_letters if by_letters and by_letters.held >= UNNAMED else None
    found = [best.guess] if best is not None else []
    for part in parts(document):
        if len(part.document.pieces) < len(document.pieces) - 1:
            own = Trials(part, lexicon)
            of_part = own.best()
            known = own.trial(found[0]) if found else None
            if of_part and _enough(of_part) and (known is None or of_part.cost < known.cost):
                found.append(replace(of_part.guess, headings=part.headings))
    return _divided(whole, best, found)


def _divided(whole: Trials, best: Trial | None, found: Sequence[Guess]) -> tuple[Guess, ...]:
    """Return the systems, with those of passages where none is known, or where more lines hold with them.

    ``best``: the trial of the whole note, whose system is the first of those ``found``, if there is one.
    """
    lines = len(whole.part.lines)
    if best is not None and lines - best.held < ENOUGH:
        return tuple(found)
    of_parts = [one for one in found if not one.whole_note]
    several = list(_passages(whole.part.document, whole.lexicon, of_parts))
    if best is None:
        return (*found, *(t.guess for t in several))
    better = len(several) > 1 and sum(t.held for t in several) > best.held
    return (*of_parts, *(t.guess for t in several)) if better else tuple(found)


def _passages(document: Document, lexicon: Lexicon, found: Sequence[Guess]) -> Iterator[Trial]:
    """Yield what holds with systems of single passages, in sections that are about none as a whole.

    One line that holds is enough beside one that fails: what fails in a passage is a question as long as
    not two hold.
    """
    for titles, pieces in _regions(document.pieces):
        if any({*titles} & {*one.headings} for one in found):
            continue
        for phrase, line, own in passages(pieces):
            part = Part((), replace(document, pieces=own))
            best = Trials(part, lexicon, deep=len(part.lines) <= FEW).best()
            if best is not None and best.held >= max(1, len(best.failed)):
                guess = replace(best.guess, headings=titles[-1:], after=phrase, begins=line)
                yield replace(best, guess=guess)


def _regions(pieces: Sequence[Piece]) -> Iterator[tuple[tuple[str, ...], tuple[Piece, ...]]]:
    """Yield what stands below each heading down to the next, with the headings above.

    Only where nothing else stands below the heading, and no other is called so: a part of a lexicon is
    found by its heading.
    """
    places = [k for k, p in enumerate(pieces) if p.kind == "heading"]
    titles = [_title(pieces[k]) for k in places]
    if not places or (len(places) == 1 and places[0] == 0):
        yield tuple(titles), tuple(pieces[len(places) :])
        return
    for n, (k, end) in enumerate(pairwise([*places, len(pieces)])):
        leaf = end == len(pieces) or pieces[end].level <= pieces[k].level
        above = [t for m, t in enumerate(titles[:n]) if pieces[places[m]].level < pieces[k].level]
        if leaf and titles.count(titles[n]) == 1:
            yield (*above, titles[n]), tuple(pieces[k + 1 : end])


def passages(pieces: Sequence[Piece]) -> Iterator[tuple[str, int, tuple[Piece, ...]]]:
    """Yield pieces from words that name a system to the next that do, with the phrase that begins them.

    Its line stands between.
    """
    runs: list[list[Piece]] = []
    for piece, before in zip(pieces, (None, *pieces), strict=False):
        begins = before is None or (before.kind == "display" and piece.kind != "display")
        runs += [[]] if begins else []
        runs[-1].append(piece)
    joined: list[list[Piece]] = []
    for run in runs:
        words = " ".join(p.body for p in run if p.kind == "prose")
        named = any(row.named(words) for row in rows())
        if named or not joined:
            joined.append(run)
        else:
            joined[-1] += run
    for run in joined:
        phrase = _phrase(run)
        if phrase:
            yield phrase, run[0].line, tuple(run)


PHRASE = 60
"""Characters of a phrase that begins a passage."""


def _phrase(run: Sequence[Piece]) -> str:
    """Return the first words of a passage, as they stand; "" where the same stand before."""
    shown = next((p for p in run if p.kind == "display"), None)
    if shown is None or run[0] is shown:
        return ""
    text, start = shown.source.text, run[0].span.start
    words = text[start : min(start + PHRASE, shown.span.start)].split()
    words = words if start + PHRASE > shown.span.start else words[:-1]
    words = [w for w in words if w not in {"$$", r"\[", r"\begin{equation}", r"\begin{align}"}]
    pattern = r"\s+".join(map(re.escape, words))
    match = re.search(pattern, text, re.IGNORECASE) if len(words) > 1 else None
    begins = match is not None and start <= match.start() and match.end() <= shown.span.start
    return " ".join(words) if begins else ""


def _enough(one: Trial) -> bool:
    """Return whether lines hold that make a system credible; one is enough where sentences describe it."""
    few = one.held >= len(one.failed) if one.guess.lines else one.held > len(one.failed)
    return one.held >= (1 if few else ENOUGH)
