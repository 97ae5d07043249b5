"""What is found of the claims that a note makes in words: sentences with their verdicts and places.

Sentences run over inline formulas and end at displays, headings and paragraphs; what stands in brackets
is left out. A claim is called wrong only where nothing in its section hints at an assumption that is not
understood.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from eom.checker.assume.context import implied
from eom.checker.assume.phrases import Limits, Said, said
from eom.checker.explanation import Explanation
from eom.checker.judge.judge import UNDECIDED, WRONG, equations
from eom.checker.judge.notes import Understood
from eom.checker.mean.claims import Claim
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.values import Refusal
from eom.checker.prose_claims.at_points import at_points, number_in
from eom.checker.prose_claims.marked import Sentence, sentences
from eom.checker.prose_claims.pointing import TERMS, Displays, pointed
from eom.checker.prose_claims.proposition_words import Formulas, Subject
from eom.checker.prose_claims.propositions import All, Plain, Proposition, Reading, Test
from eom.checker.prose_claims.quantified import Decision, decide, quantified
from eom.checker.prose_claims.shown import HINTS, numbers_in, shown
from eom.checker.prose_claims.stability import stability
from eom.checker.prose_claims.theorems import theorem
from eom.checker.read.documents import Document, Piece
from eom.checker.read.looks import labels
from eom.checker.reports import PROSE, Finding
from eom.errors import InputError
from eom.limits import Overdue, deadline
from eom.terms.terms import add


def in_words(
    document: Document,
    understood: Sequence[Understood],
    stated: Sequence[frozenset[str]],
    given: tuple[str, ...],
    seconds: float,
    drafted: bool = False,
) -> tuple[Finding, ...]:
    """Return what is found of the claims in words; ``stated``: what the note has stated at each formula.

    ``seconds``: for one sentence; what takes longer is left out. ``drafted``: nobody has confirmed the
    meanings of symbols, so that no sentence with formulas is called wrong.
    """
    numbers = [k for k, p in enumerate(document.pieces) if p.is_formula]
    by_piece = {k: (u, s) for k, u, s in zip(numbers, understood, stated, strict=True)}
    phrases = said(document.pieces)
    limits = Limits(document.pieces)
    found: list[Finding] = []
    for sentence in sentences(document.pieces):
        try:
            with deadline(seconds, "the judgement of this sentence"):
                decision = _decided(sentence, document.pieces, by_piece, phrases, limits, given)
        except (Overdue, RecursionError):
            continue
        if decision is not None:
            decision = _softened(decision) if drafted and sentence.formulas else decision
            found.append(_finding(sentence, decision, len(found) + 1))
    return tuple(found)


def _finding(sentence: Sentence, decision: Decision, number: int) -> Finding:
    example = decision.counterexample
    return Finding(
        number,
        PROSE,
        sentence.source,
        sentence.span,
        sentence.source.text[sentence.span.start : sentence.span.stop],
        decision.verdict,
        decision.sets,
        decision.reason,
        explanation=Explanation(counterexample=example),
    )


# -- formulas -------------------------------------------------------------------------------------

ByPiece = Mapping[int, tuple[Understood, frozenset[str]]]


def _formulas(
    sentence: Sentence, by_piece: ByPiece, text: str, terms: Mapping[int, Subject]
) -> Formulas:
    """Return what the formulas of a sentence say or stand for; ``text``: with marks of displays.

    ``terms``: what other marks stand for.
    """
    propositions: dict[int, Proposition] = {}
    subjects: dict[int, Subject] = dict(terms)
    points: dict[int, str] = {}
    marks = {int(n) for n in re.findall("\x02(\\d+)\x03", text)}
    for k in sorted({*sentence.formulas, *(marks & set(by_piece))}):
        one = by_piece[k][0]
        name = _point(one)
        said_there = _said(one)
        subject = _subject(one)
        propositions |= {} if said_there is None else {k: said_there}
        subjects |= {} if subject is None else {k: subject}
        points |= {} if name is None else {k: name}
    return Formulas(propositions, subjects, points)


_BETWEEN = re.compile(
    r"(?:the )?(?:distinction|difference) between \x02(\d+)\x03 and \x02(\d+)\x03"
)


def _parted(text: str, formulas: Formulas) -> tuple[str, Formulas]:
    """Return a sentence with a mark for the difference between two quantities of one kind."""
    match = _BETWEEN.search(text)
    pair = [formulas.subjects.get(int(n)) for n in match.groups()] if match else []
    a, b = (p.terms[0][0] if p is not None else None for p in pair) if pair else (None, None)
    if match is None or a is None or b is None or a.kind != b.kind:
        return text, formulas
    (first, second), number = pair, 2 * TERMS * TERMS + int(match[1])
    scalars = {**first.scalars, **second.scalars} if first and second else {}
    name = " - ".join(p.text for p in pair if p is not None)
    subjects = {**formulas.subjects, number: Subject(name, ((add(a, -b), ""),), scalars)}
    whole = f"{text[: match.start()]}\x02{number}\x03{text[match.end() :]}"
    return whole, replace(formulas, subjects=subjects)


def _said(one: Understood) -> Proposition | None:
    """Return what an inline formula says: equations that are understood without a flaw."""
    found = []
    for claim in one.claims:
        if claim.findings or claim.role or claim.model is not None or not claim.members:
            return None
        made = _proposition(claim, one.formula.piece.body.strip())
        if made is None:
            return None
        found.append(made)
    return found[0] if len(found) == 1 else All(tuple(found)) if found else None


def _proposition(claim: Claim, latex: str) -> Plain | None:
    try:
        tests = tuple(Test(add(q.left, -q.right)) for q in equations(claim))
    except InputError:
        return None
    return Plain(latex, (Reading((tests,)),), claim.scalars) if tests else None


def _subject(one: Understood) -> Subject | None:
    """Return what an inline formula without a relation stands for."""
    if one.formula.reading is None or one.formula.relational or one.lexicon.system is not None:
        return None
    e = elaborator(one.lexicon, dict(one.around.definitions))
    try:
        value = e.value(one.formula.reading.tree)
    except Refusal:
        return None
    return Subject(one.formula.piece.body.strip(), ((value.term, ""),), dict(e.scalars))


def _point(one: Understood) -> str | None:
    if one.formula.reading is None:
        return None
    return one.lexicon.points.get(labels(one.formula.reading.tree))


# -- judging --------------------------------------------------------------------------------------

_LEADS = re.compile(
    r"\b(?:consider|suppose|assum\w+|let|restrict\w*|special case|in (?:the|this|that) case|for an?|take|"
    r"now|here)\b",
    re.IGNORECASE,
)
_CONDITIONS = re.compile(r"\b(?:if|when|while|where)\b")
"""Words that do so for their paragraph."""
_MOTIFS = re.compile(
    r"\b(?:spher\w+|cub\w+|spin\w*|rotat\w+ about|plan(?:e|ar) |tops?\b|dis[ck]s?\b|rods?\b|at rest|"
    r"constant (?:rate|speed|angular)|fixed ax\w+|hinge\w*|pivot\w*|gyro\w*|wheel\w*|rotor\w*|orbit\w*|"
    r"steady|uniform\w*|pendul\w+|damp\w+|dissipat\w+|pure|roll\w+|particle|point mass|deform\w+|"
    r"flexib\w+|elastic|fluid|variable mass|rocket)",
    re.IGNORECASE,
)
"""Words that may narrow down what is talked about in ways that are not understood here."""


_OTHERS = re.compile(
    r"\b(?:dissipat|damp|flexib|slosh|fluid|sink|dual|rotor|wheel|orbit|gravity|elastic)"
)
"""Words after which stability is that of some other body."""


def _before(sentence: Sentence, pieces: Sequence[Piece], limits: Limits) -> Iterator[Sentence]:
    """Yield the sentences of the section that stand in front of one."""
    begin = sentence.first
    while begin > 0 and not limits.levels[begin]:
        begin -= 1
    run = pieces[begin : sentence.first + 1]
    for one in sentences([p for p in run if p.source is sentence.source]):
        if one.span.start < sentence.span.start:
            yield one


def _of_others(sentence: Sentence, pieces: Sequence[Piece], limits: Limits) -> bool:
    """Tell whether the section speaks of other bodies than free ones, rigid or with losses."""
    return any(_OTHERS.search(one.text) for one in _before(sentence, pieces, limits))


def _hinted(sentence: Sentence, pieces: Sequence[Piece], limits: Limits) -> bool:
    """Tell whether a sentence before this one in its section may assume what is not understood."""
    for one in _before(sentence, pieces, limits):
        if _MOTIFS.search(one.text):
            between = one.source.text[one.span.stop : sentence.span.start]
            near = not re.search(r"\n[ \t]*\n", between) and _CONDITIONS.search(one.text)
            if _LEADS.search(one.text) or near:
                return True
    return False


def _decided(
    sentence: Sentence,
    pieces: Sequence[Piece],
    by_piece: ByPiece,
    phrases: Sequence[Said],
    limits: Limits,
    given: tuple[str, ...],
) -> Decision | None:
    """Return the verdict on a sentence, None where it claims nothing that is understood."""
    found = stability(sentence.text) or theorem(sentence.text, given)
    displays = Displays(pieces, {k: u for k, (u, _) in by_piece.items()})
    text, terms = pointed(sentence.text, sentence.first, displays)
    formulas = _formulas(sentence, by_piece, text, terms)
    text, formulas = _parted(text, formulas)
    names = _stated(sentence, by_piece, phrases)
    found = found or _of_equation(text, sentence, pieces, by_piece, formulas, names, limits, given)
    one = None if found is not None else quantified(text, formulas)
    if found is None and one is None:
        return None
    if found is not None:
        return _softened(found) if _of_others(sentence, pieces, limits) else found
    assert one is not None
    hinted = _hinted(sentence, pieces, limits)
    decision = decide(one, names, given, hinted)
    if decision.verdict == UNDECIDED and one.kind == "" and decision.counterexample is None:
        return None
    return decision


def _of_equation(
    text: str,
    sentence: Sentence,
    pieces: Sequence[Piece],
    by_piece: ByPiece,
    formulas: Formulas,
    names: frozenset[str],
    limits: Limits,
    given: tuple[str, ...],
) -> Decision | None:
    """Return the verdict on what is said of a display: where it holds, and what it shows."""
    number = number_in(text)
    if number is not None and number in by_piece:
        return at_points(text, by_piece[number][0], names, given)
    numbers = numbers_in(text)
    if numbers is None or numbers[0] not in by_piece:
        return None
    found = shown(text, by_piece[numbers[0]][0], formulas.subjects, given)
    hinted = any(HINTS.search(one.text) for one in _before(sentence, pieces, limits))
    return _softened(found) if found is not None and hinted else found


def _softened(found: Decision) -> Decision:
    """Return a verdict where the note may assume more than is understood."""
    return replace(found, verdict=UNDECIDED) if found.verdict == WRONG else found


def _stated(sentence: Sentence, by_piece: ByPiece, phrases: Sequence[Said]) -> frozenset[str]:
    """Return what has been stated before a sentence: what it says itself is left out."""
    start = (sentence.first, sentence.span.start)
    before = implied(
        n for s in phrases if s.start < start and sentence.first < s.stop for n in s.names
    )
    own = implied(
        n
        for s in phrases
        if s.source is sentence.source and sentence.span.start <= s.start[1] < sentence.span.stop
        for n in s.names
    )
    inside = [by_piece[k][1] for k in sentence.formulas[:1]]
    earlier = [by_piece[k][1] for k in sorted(by_piece) if k < sentence.first][-1:]
    there = (inside or earlier or [frozenset[str]()])[0]
    kept = before | (earlier[0] if earlier else frozenset[str]())
    return before | (there - (own - kept))
