"""A note in, a report out: every formula is understood, judged, and reported with its place."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice, product
from pathlib import Path
from typing import TYPE_CHECKING

from eom.checker.infer.asking import Open, as_entry, questions, with_said
from eom.checker.infer.draft import Meanings, Proposal, meanings
from eom.checker.infer.evidence import (
    DECISIVE,
    UNFIT,
    Doubt,
    Evidence,
    entries_in,
    evidence,
    is_amiss,
    is_turned,
    misfit,
    readings,
    uncounted,
    with_meaning,
)
from eom.checker.infer.letters import ANY
from eom.checker.infer.lists import PRODUCT
from eom.checker.infer.sayings import look_of
from eom.checker.infer.shown import operands_of
from eom.checker.infer.slots import guessed_labels, labels_of
from eom.checker.infer.systems import is_claimed, led
from eom.checker.judge.coordinates import covered
from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER, WRONG, judge
from eom.checker.judge.models import equations
from eom.checker.judge.notes import Understood, reread, understand
from eom.checker.judge.special import Name, excused
from eom.checker.judge.special import named as named_in
from eom.checker.judge.verdicts import GRAVE, NONE, Judged, Verdict, verdict
from eom.checker.mean.claims import DEFINITION, STATEMENT, Claim
from eom.checker.mean.examples import ANOTHER
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import about
from eom.checker.mean.values import ILL_FORMED
from eom.checker.note.following import decided
from eom.checker.note.review import Reviewed, review
from eom.checker.note.told import doubt_in_words, passage, sliced, system_in_words, taken
from eom.checker.prose_claims.in_words import in_words
from eom.checker.read.documents import Document, Note, document_of, name_of, note_of
from eom.checker.read.spans import NOWHERE, ReadingError, Span, printable
from eom.checker.read.writing import latex_of
from eom.checker.repair.explaining import explain
from eom.checker.report.findings import (
    FORMULA_SECONDS,
    GIVEN,
    UNSURE,
    Finding,
    Graded,
    Remark,
    Report,
    Settings,
    decided_by,
)
from eom.checker.report.questions import Candidate, Question
from eom.derivations.refuted import disagreement
from eom.errors import InputError, typed
from eom.limits import Overdue, deadline, seldom_collected
from eom.terms.terms import SCALAR
from eom.worlds.worlds import ASSUMPTIONS, SPECIAL, closure

if TYPE_CHECKING:
    from eom.opening import AnyScene
    from eom.system import System

_PLACED = re.compile("centre of mass|origin|^[A-Z] = [A-Z]$")
"""A special case that makes points coincide, which a draft may have taken for each other."""
MAX_OTHERS = 3
"""Lines that hold which are tried with another meaning of a symbol."""
MAX_READINGS = 12
"""Other meanings under which a wrong line of a draft is judged again."""
FIRM = 2
"""Lines that hold under a condition which count as much as one that holds without."""
CREDIBLE = 2
"""Lines that hold with a system of the draft, by which it is sure."""
SHOWN = 3
"""Meanings that a verdict rests on and that are told."""
MAX_SETS = 24
"""Sets of assumptions that are listed at most of one formula."""


@dataclass(frozen=True)
class Found:
    """A formula of a note with its verdict, its finding so far, and what has been assumed there."""

    understood: Understood
    verdict: Verdict
    finding: Finding
    stated: frozenset[str] = frozenset()


@typed
def check(
    note: str | Path,
    *,
    notation: str = "",
    lexicon: str | Path = "",
    given: Iterable[str] = GIVEN,
    kind: str = "",
    system: str | System | AnyScene | None = None,
    seconds: float = FORMULA_SECONDS,
    strict: bool = False,
    answers: Mapping[str, str | Candidate] | None = None,
) -> Report:
    r"""Return what is found in a note: a file, a text, or one formula.

    Parameters
    ----------
    note : str or Path
        A `Path`, the name of a file (see `eom.checker.read.documents.is_file`), else a text.
    notation : str, optional
        A preset of letters, such as ``kane``. Without notation and lexicon those of the note are taken,
        and if it has none a draft from its words, as ``Report.lexicon`` says.
    lexicon : str or Path, optional
        A TOML file that says what the symbols mean.
    given : iterable of str, default ("constant_mass",)
        Assumptions that are made without being said.
    kind : str, optional
        Of texts that are no files, such as ``markdown`` or ``latex``; what they look like unless given.
    system : str, System or scene, optional
        What scalar lines are about: the name of a scene, a scene file or an object; what the note says
        unless given.
    seconds : float, default 10
        Processor time (s) for the meaning of a formula, and again for its judgement.
    strict : bool, default False
        Whether a line counts as wrong, and not as unsure, that is so by a meaning which neither words
        nor another line make sure.
    answers : mapping, optional
        What symbols mean, by their LaTeX: one of the candidates of `Report.questions`, or a meaning as a
        lexicon spells it, such as ``"scalar q"``. They go before the draft; a lexicon takes none.

    Returns
    -------
    Report
        A finding for each formula and each claim in words: verdict, reason, repair.

    Raises
    ------
    InputError
        For a note that cannot be read, and for settings that cannot be used.

    Notes
    -----
    Verdicts on equations come from exact values in random worlds of rigid bodies
    (`eom.derivations.verification`): one that fails at such values is false; one that holds at all of
    them is true but for a negligible probability. Units, frames and signs are those that the lexicon
    gives to the symbols; numbers with units are compared in SI.

    References
    ----------
    Schwartz, J. ACM 27, 1980, of the probability.

    Examples
    --------
    >>> check(r"\vec H_C = I_C \vec\omega", notation="arrow-tilde").findings[0].verdict
    'holds under'
    """
    said = tuple(map(as_entry, (answers or {}).items()))
    settings = Settings(
        notation, str(lexicon), tuple(given), kind, system, seconds, strict=strict, answers=said
    )
    return check_note(note_of(note), settings)


@dataclass(frozen=True)
class Whole:
    """A note with the meanings of its symbols, its formulas with verdicts, what its words claim.

    ``open``: lines that meanings of the draft leave undecided or unsure; ``held``: lines that hold, by the
    patterns of the entries of their symbols; ``questions``: what may be asked so that more are decided.
    """

    document: Document
    known: Meanings
    found: tuple[Found, ...]
    words: tuple[Finding, ...]
    open: tuple[Open, ...] = ()
    held: Mapping[str, Sequence[int]] = field(default_factory=dict)
    questions: tuple[Question, ...] = ()


def check_note(note: Note, settings: Settings) -> Report:
    """Return the report on a file, a text or a formula."""
    path = note if isinstance(note, Path) else None
    return check_document(document_of(note, settings.kind), settings, path)


def check_document(document: Document, settings: Settings, path: Path | None = None) -> Report:
    """Return the report on a document; ``path``: where it stands, if it is a file."""
    whole = judged_document(document, settings, path)
    found = [*(f.finding for f in whole.found), *whole.words]
    report = _report(whole.document, whole.known, settings, found, whole.held)
    return replace(report, questions=whole.questions)


def judged_note(note: Note, settings: Settings) -> Whole:
    """Return what is found of the formulas and the words of a file, a text or a formula."""
    path = note if isinstance(note, Path) else None
    return judged_document(document_of(note, settings.kind), settings, path)


def judged_document(document: Document, settings: Settings, path: Path | None = None) -> Whole:
    """Return what is found of the formulas and the words of a document."""
    closure(settings.given)
    with seldom_collected(), deadline(settings.note_seconds, "this note"):
        known = meanings(document, path, settings.notation, settings.lexicon)
        known = with_said(known, settings.answers)
        if settings.system is not None:
            drafted = known.draft is not None
            known = replace(known, lexicon=about(known.lexicon, settings.system, first=drafted))
        understood = understand(document, known.lexicon, settings.seconds)
        reviewed = _reviewed(document, understood, settings)
        found = tuple(_explained(f, settings) for f in _found(reviewed))
        found = tuple(_claimed(_doubted(found, known, settings), document, known, settings))
        found = _following(found, document, known)
        words = _in_words(document, reviewed, settings, known.draft is not None)
        known = _confirmed(known, found, settings)
        if known.draft is None:
            return Whole(document, known, found, words)
        left, held = tuple(_open(found)), _held(found)
        asked = questions(left, known.draft, held)
    return Whole(document, known, found, words, left, held, asked)


def _following(found: tuple[Found, ...], document: Document, known: Meanings) -> tuple[Found, ...]:
    """Return the formulas, those that were left open as other lines decide them."""
    understood, findings = [f.understood for f in found], [f.finding for f in found]
    try:
        new = tuple(decided(document, understood, findings, known.lexicon))
    except (Overdue, RecursionError):
        return found
    return tuple(replace(f, finding=n) for f, n in zip(found, new, strict=True))


def _open(found: Sequence[Found]) -> Iterator[Open]:
    """Yield the displays that are undecided or unsure."""
    for one in found:
        if one.finding.verdict in {UNDECIDED, UNSURE} and one.finding.kind == "display":
            here, unsure = one.understood, one.finding.verdict == UNSURE
            yield Open(here.formula, here.lexicon, unsure)


def _confirmed(known: Meanings, found: Sequence[Found], settings: Settings) -> Meanings:
    """Return the meanings without their draft where the system that was named gives all of them."""
    claims = [[j.claim for j in f.verdict.claims] for f in found]
    model = known.lexicon.system
    if settings.system is None or known.draft is None or model is None or not claims:
        return known
    if all(some and all(covered(c) for c in some) for some in claims):
        return Meanings(known.lexicon, f"letters of {model.name or model.system.name}")
    return known


def _in_words(
    document: Document, reviewed: Sequence[Reviewed], settings: Settings, drafted: bool
) -> tuple[Finding, ...]:
    """Return what is found of the claims in words; nothing where it takes too long."""
    understood, stated = [r.understood for r in reviewed], [r.stated for r in reviewed]
    try:
        return in_words(document, understood, stated, settings.given, settings.seconds, drafted)
    except (Overdue, RecursionError):
        return ()


def grade(note: Note, settings: Settings) -> Graded:
    """Return the report on a note, or the error that leaves none: no note ends the checking of others."""
    name = printable(name_of(note))
    try:
        return Graded(name, check_note(note, settings))
    except InputError as error:
        return Graded(name, None, str(error))
    except MemoryError:
        return Graded(name, None, "not enough memory")
    except Exception as error:  # a defect of ours on one note is reported as that
        why = f"this note could not be checked: {type(error).__name__}: {error}; please report it"
        return Graded(name, None, why)


def _explained(found: Found, settings: Settings) -> Found:
    """Return a formula with why it is wrong, as it is where finding that takes too long."""
    reported = found.finding
    judged = next((j for j in found.verdict.claims if j.verdict == reported.verdict), None)
    if judged is None or judged.verdict not in GRAVE:
        return found
    if judged.claim.moving is not None:
        return _disagreeing(found, judged, settings)
    try:
        with deadline(settings.seconds, "what is said of this formula"):
            given = (*settings.given, *found.understood.lexicon.assume)
            explanation = explain(found.understood, judged, given, found.stated)
    except (Overdue, RecursionError):
        return found
    known = "" if judged.claim.findings else explanation.reason
    more = [p for p in reported.reason.split("; ") if p.startswith("it holds if")] if known else []
    reason = "; ".join([known, *more]) if known else reported.reason
    return replace(found, finding=replace(reported, explanation=explanation, reason=reason))


def _disagreeing(found: Found, judged: Judged, settings: Settings) -> Found:
    """Return a wrong formula on motions of the note's own with what is left over, and where it fails."""
    claim = judged.claim
    if claim.moving is None or claim.findings or judged.verdict != WRONG:
        return found
    given = (*settings.given, *found.understood.lexicon.assume)
    drawn = claim.moving.worlds_with(claim.scalars)
    said = (claim.moving.spelt(q, claim.scalars) for q in equations(claim))
    why = next(filter(None, (disagreement(q, drawn, given) for q in said)), "")
    return replace(found, finding=replace(found.finding, reason=why or found.finding.reason))


# -- findings ------------------------------------------------------------------------------------


def _found(reviewed: Sequence[Reviewed]) -> Iterator[Found]:
    """Yield the formulas of a note that claim something, and all displays."""
    numbers: Counter[str] = Counter()
    for one in reviewed:
        formula = one.understood.formula
        numbers[formula.piece.kind] += 1
        if formula.piece.kind == "display" or formula.relational or one.verdict.verdict != NONE:
            reported = finding(one.understood, one.verdict, numbers[formula.piece.kind])
            reported = replace(reported, remarks=one.remarks, carried=one.carried)
            yield Found(one.understood, one.verdict, reported, one.stated)


def _reviewed(
    document: Document, understood: Sequence[Understood], settings: Settings
) -> Sequence[Reviewed]:
    """Return verdicts in the light of the whole note; each by itself if that takes too long."""
    verdicts = [_verdict(one, settings) for one in understood]
    try:
        return review(document, understood, settings.given, verdicts)
    except (Overdue, RecursionError):
        return [Reviewed(u, v) for u, v in zip(understood, verdicts, strict=True)]


def _doubted(found: Sequence[Found], known: Meanings, settings: Settings) -> Iterator[Found]:
    """Yield the formulas; a wrong one is unsure where a meaning is a guess, or another one saves it."""
    if known.draft is None:
        yield from found
        return
    hold = [f.finding.verdict in {HOLDS, UNDER} for f in found]
    about = [any(covered(j.claim) for j in f.verdict.claims) for f in found]
    known_by = _evidence(found, known, known.draft)
    guessed = guessed_labels(known.draft.drafts)
    of = [passage(f.understood.lexicon, known.draft) for f in found]
    lines = Counter(k for k, h, a in zip(of, hold, about, strict=True) if h and a)
    named = settings.system is not None
    names = named_in(j.claim for f in found for j in f.verdict.claims)
    for number, (one, system) in enumerate(zip(found, about, strict=True)):
        if one.finding.verdict == ILL_FORMED and not (
            (one.finding.reason.startswith(DECISIVE) and known_by.is_proved(number))
            or (one.finding.reason.startswith(UNFIT) and _is_amiss(one, known, known_by, number))
        ):
            yield replace(one, finding=_unconfirmed(one.finding))
        elif _only_in_cases(one, known_by, number, guessed):
            yield replace(one, finding=replace(one.finding, verdict=UNSURE, reason=IN_CASES))
        elif (
            one.finding.verdict not in GRAVE
            or settings.strict
            or all(_apart(j, named) for j in one.verdict.claims)
        ):
            yield one
        else:
            amiss = is_amiss(one.understood, known.lexicon, known_by.doubted(number))
            doubts = () if amiss else known_by.doubts(number)
            placed = bool(guessed & labels_of(one.understood.formula))
            own, held = system and not named, lines[of[number]]
            taken = _taken(one, known.draft, doubts, own, held, labelled=placed)
            others = [f for f, h in zip(found, hold, strict=True) if h and f is not one]
            why = ", ".join(taken) or _excused(one, others, known.draft, settings, names)
            reason = f"if {why}, then: {one.finding.reason}"
            unsure = replace(one.finding, verdict=UNSURE, reason=reason)
            yield replace(one, finding=unsure) if why else one


def _evidence(found: Sequence[Found], known: Meanings, draft: Proposal) -> Evidence:
    """Return what speaks for the meanings of the draft in formulas."""
    return evidence(
        [f.understood.formula for f in found],
        [_supports(f.finding, words=draft.words) for f in found],
        known.lexicon,
        draft,
        [misfit(f.understood, known.lexicon) for f in found],
        [f.understood.lexicon for f in found],
    )


def _supports(finding: Finding, *, words: bool) -> bool:
    """Return whether a formula speaks for the meanings in it: it holds, by no special case left unsaid."""
    if finding.verdict != UNDER:
        return finding.verdict == HOLDS
    special = {n for n, row in ASSUMPTIONS.items() if row.kind == SPECIAL}
    general = any(special.isdisjoint(s) for s in finding.sets)
    return words and (general or all(r.kind != "not stated" for r in finding.remarks))


IN_CASES = "with meanings that nothing confirms it holds in special cases alone"


def _only_in_cases(one: Found, known_by: Evidence, number: int, guessed: frozenset[str]) -> bool:
    """Return whether a line on any vector, or on guessed frames and points, holds in special cases alone.

    What is meant for any vector holds without such conditions: perhaps a slip made it true there.
    """
    sets = one.finding.sets if one.finding.verdict == UNDER else ()
    anyhow = any(known_by.guessed.get(p) == ANY for p in known_by.used[number])
    special = all(
        any(a not in ASSUMPTIONS or ASSUMPTIONS[a].kind == SPECIAL for a in s) for s in sets
    )
    return bool(sets) and special and (anyhow or bool(guessed & labels_of(one.understood.formula)))


def _is_amiss(one: Found, known: Meanings, known_by: Evidence, number: int) -> bool:
    """Return whether kinds do not fit by meanings alone that are sure and hold elsewhere."""
    unproved = known_by.unproved(number)
    return bool(unproved < known_by.used[number].keys()) and is_amiss(
        one.understood, known.lexicon, unproved
    )


def _claimed(
    found: Iterable[Found], document: Document, known: Meanings, settings: Settings
) -> Iterator[Found]:
    """Yield the formulas; what words claim of a letter alone is no definition of it.

    Where a note speaks of small motions, matrices of its system may be meant to first order.
    """
    if known.draft is None:
        yield from found
        return
    said = {(s.line, s.look) for s in led(document) if is_claimed(s.words)}
    drafts = known.draft.drafts
    small = any(_SMALL.search(p.body) for p in document.pieces if p.kind == "prose")
    products = frozenset(d.latex for d in drafts if d.words == PRODUCT)
    for one in found:
        formula = one.understood.formula
        looks = [look_of(s.members[0]) for s in formula.statements if s.relational]
        signs = {g.name for s in formula.statements for g in s.signs}
        claimed = any((formula.piece.line, k) in said for k in looks)
        why = ""
        if one.finding.verdict == DEFINITION and claimed and not signs & {":=", "equiv"}:
            why = CLAIMED
        elif one.finding.verdict == UNDER and _empties(one, products):
            why = EMPTY
        undecided = replace(one.finding, verdict=UNDECIDED, reason=why)
        if small and not settings.strict and _tabled(one):
            why = "only first order is meant"
            undecided = replace(
                undecided, verdict=UNSURE, reason=f"if not {why}: {one.finding.reason}"
            )
        yield replace(one, finding=undecided) if why else one


_SMALL = re.compile(r"\bsmall\b|\bfirst[- ]order\b|\blineari[sz]", re.IGNORECASE)


def _tabled(one: Found) -> bool:
    """Return whether a wrong line ties matrices or columns of a system, which are not compared nearly."""
    wrong = [j.claim for j in one.verdict.claims if j.verdict in GRAVE and not j.claim.findings]
    shapes = {m.shape for c in wrong if covered(c) for m in c.members}
    return one.finding.verdict == WRONG and bool(shapes - {SCALAR})


def _empties(one: Found, products: frozenset[str]) -> bool:
    """Return whether a formula holds only where products of inertia that it writes vanish."""
    sets = one.finding.sets
    principal = bool(sets) and all(any(n.startswith("principal") for n in s) for s in sets)
    looks = operands_of(one.understood.formula) if principal and products else ()
    return any(latex_of(k) in products for k in looks)


CLAIMED = "the words say what this is, and nothing that is known here determines it"
EMPTY = "it holds where a product of inertia that stands in it is zero"


def _taken(
    one: Found,
    draft: Proposal,
    guessed: Sequence[Doubt],
    system: bool,
    lines: int,
    *,
    labelled: bool = False,
) -> list[str]:
    """Return what a wrong line rests on that nothing makes sure.

    ``system``: whether it is about the system of the draft, with which so many ``lines`` hold;
    ``labelled``: whether it has frames or points that only the places of their labels suggest.
    """
    taken = [doubt_in_words(d, draft) for d in guessed[:SHOWN]]
    if system and (lines < CREDIBLE or guessed):
        here = [s for s in draft.systems if s.holds_in(one.understood.lexicon)]
        taken = [system_in_words(s) for s in (here or draft.systems)[:1]] + taken
    if system:
        free = dict.fromkeys(n for j in one.verdict.claims for n in uncounted(j.claim))
        taken += [f"{n} is counted from where the line needs it" for n in free]
        taken += _changed(one, draft)
    taken += [] if one.finding.reason.startswith(DECISIVE) else sliced(one.understood)
    if any(map(is_turned, (j.claim for j in one.verdict.claims))):
        taken += ["the axis of the wheel may be any"]
    if _PLACED.search(one.finding.special) or labelled:
        taken += ["points and frames are as drafted"]
    return taken


def _changed(one: Found, draft: Proposal) -> list[str]:
    """Return that the system is as before the words that change it, where a line stands behind these."""
    line = one.understood.formula.piece.line
    own = [s for s in draft.systems if set(s.headings) <= set(one.understood.headings)]
    return [f"the system is as before line {s.until}" for s in own[-1:] if 0 < s.until <= line]


def _apart(judged: Judged, named: bool) -> bool:
    """Return whether a verdict rests on no draft: on a system that is named, or on numbers alone."""
    own = named and covered(judged.claim)
    return own or any(f.what == ANOTHER for f in judged.claim.findings)


def _excused(
    one: Found,
    others: Sequence[Found],
    draft: Proposal,
    settings: Settings,
    names: frozenset[Name],
) -> str:
    """Return which meaning a symbol must not have for a line to be wrong; "" where none saves it.

    ``others``: lines that hold; none of them may fail with that meaning. ``names``: what the note names, no
    two of which may have to coincide.
    """
    here = one.understood.lexicon
    given = (*settings.given, *here.assume)
    try:
        with deadline(settings.seconds, "other meanings of this formula"):
            for doubt, lexicon in islice(
                readings(one.understood.formula, here, draft), MAX_READINGS
            ):
                if _saved(one, lexicon, given, names) and not _broken(
                    doubt, others, settings, names
                ):
                    return doubt_in_words(doubt, draft, " not")
            rivals = (
                r.added(here)
                for s in draft.systems
                if here.system is not None and set(s.headings) <= set(one.understood.headings)
                for r in s.rivals[:SHOWN]
            )
            if any(_saved(one, lexicon, given, names) for lexicon in rivals):
                return "the system is as it was taken"
    except (Overdue, RecursionError, InputError):
        return ""
    return ""


def _saved(one: Found, lexicon: Lexicon, given: tuple[str, ...], names: frozenset[Name]) -> bool:
    """Return whether a formula holds under another lexicon."""
    reading = one.understood.formula.reading
    claims = reread(replace(one.understood, lexicon=lexicon), reading.tree) if reading else ()
    return bool(claims) and all(_holds(c, given, names) for c in claims)


def _broken(
    doubt: Doubt, others: Sequence[Found], settings: Settings, names: frozenset[Name]
) -> bool:
    """Return whether lines that hold and have a symbol hold no more with another meaning of it."""
    tried = against = 0
    for other in others:
        here = other.understood.lexicon
        whole = with_meaning(here, other.understood.formula, doubt)
        if whole is not None and tried < MAX_OTHERS:
            tried += 1
            if not _saved(other, whole, (*settings.given, *here.assume), names):
                against += FIRM if other.finding.verdict == HOLDS else 1
    return against >= FIRM


def _holds(claim: Claim, given: tuple[str, ...], names: frozenset[Name]) -> bool:
    """Return whether a claim holds that says something, without a coincidence of what the note names."""
    if claim.verdict or claim.kind != STATEMENT:
        return False
    found = judge(claim, given)
    plain = found.verdict in {HOLDS, UNDER} and not found.special
    return plain and not excused(found, claim, names, frozenset(), anyhow=False)


def _unconfirmed(found: Finding) -> Finding:
    """Return a finding under meanings that nobody confirmed.

    Where kinds or frames do not fit together the draft is the likelier culprit.
    """
    if found.verdict != ILL_FORMED:
        return found
    return replace(
        found, verdict=UNDECIDED, reason=f"ill-formed if the draft is right: {found.reason}"
    )


def _verdict(one: Understood, settings: Settings) -> Verdict:
    """Return the verdict on a formula; undecided if there is none in time."""
    try:
        with deadline(settings.seconds, "the judgement of this formula"):
            return verdict(one, settings.given)
    except Overdue as error:
        return Verdict(UNDECIDED, str(error))
    except RecursionError:
        return Verdict(UNDECIDED, "the formula is too long a chain of operations")


def finding(one: Understood, judged: Verdict, number: int = 1) -> Finding:
    """Return what is reported of a formula with its verdict."""
    piece = one.formula.piece
    gravest = [j for j in judged.claims if j.verdict == judged.verdict]
    error = one.formula.error
    reason = _unreadable(error) if error is not None else _line(judged.reason)
    if judged.verdict == WRONG and not reason:
        reason = "it fails under all assumptions that are known"
    return Finding(
        number,
        piece.kind,
        piece.source,
        piece.span,
        piece.body.strip(),
        judged.verdict,
        _sets(gravest) if judged.verdict == UNDER else (),
        reason,
        _place(one, gravest),
        (*(r.text for r in one.repairs), *([one.solid.words] if one.solid else [])),
        special=" and ".join(dict.fromkeys(filter(None, (j.judgement.special for j in gravest)))),
    )


def _unreadable(error: ReadingError) -> str:
    """Return why a formula cannot be read; the place stands beside it."""
    expected = f"expected {error.expected}" if error.expected else ""
    return "; ".join(p for p in (f"not read: {error.what}", expected, error.hint) if p)


def _line(text: str) -> str:
    """Return a message of several lines as one."""
    return "; ".join(" ".join(line.split()) for line in text.splitlines())


def _sets(judged: Sequence[Judged]) -> tuple[tuple[str, ...], ...]:
    """Return the smallest sets of assumptions under which all of several claims hold."""
    found = {frozenset[str]()}
    for one in judged:
        sets = [frozenset(s) for s in one.judgement.sets]
        found = {a | b for a, b in product(found, sets)}
        found = {a for a in found if not any(b < a for b in found)}
    order = [n for one in judged for s in one.judgement.sets for n in s]
    shown = [tuple(sorted(s, key=order.index)) for s in found]
    return tuple(sorted(shown, key=lambda s: (len(s), s))[:MAX_SETS])


def _place(one: Understood, gravest: Sequence[Judged]) -> Span:
    """Return the place that is at fault: of the error, the finding, the member of a chain."""
    error = one.formula.error
    if error is not None:
        return error.span
    for judged in gravest:
        findings = [f.span for f in judged.claim.findings if f.verdict == judged.verdict]
        blamed = list(judged.chain.blamed) if judged.chain is not None else []
        places = [s for s in (*findings, *blamed) if s != NOWHERE]
        if places:
            return places[0]
    return NOWHERE


def _held(found: Iterable[Found]) -> dict[str, list[int]]:
    """Return the displays that hold, by the patterns of the entries that their symbols have."""
    lines: dict[str, list[int]] = {}
    for one in found:
        if one.finding.verdict in {HOLDS, UNDER} and one.finding.kind == "display":
            for pattern in dict(entries_in(one.understood.formula, one.understood.lexicon)):
                lines.setdefault(pattern, []).append(one.finding.line)
    return lines


def _report(
    document: Document,
    known: Meanings,
    settings: Settings,
    found: Sequence[Finding],
    held: Mapping[str, Sequence[int]],
) -> Report:
    draft = known.draft
    sources = list(dict.fromkeys(p.source for p in document.pieces))
    found = [
        replace(f, reason=decided_by(f.reason)) if f.verdict == UNDECIDED else f for f in found
    ]
    return Report(
        document.name,
        tuple(sorted(found, key=lambda f: (sources.index(f.source), f.span.start))),
        known.origin,
        tuple(taken(draft, held)) if draft else (),
        tuple(latex for latex, _ in draft.unplaced) if draft else (),
        settings.given,
        tuple(Remark("not read", f.what, f.line) for f in document.findings),
    )
