"""What is found of the claims that a note makes in words: sentences with their verdicts and places.

Sentences run over inline formulas and end at displays, headings and paragraphs; what stands in brackets
is left out. A claim is called wrong only where nothing in its section hints at an assumption that is not
understood.

Claims on the points about which an equation is valid: "(5) holds if taken about the centre of mass".

The quantities of the equation that are about a point are taken about O, and judged in worlds where O is
the point that the words name. An equation with a slip stands for its most plausible repair.

Claims that an equation shows of what kind a quantity is: "(5) shows that E is a rotation matrix".

It does not where the equation holds as well with twice the quantity in its place, as twice a rotation
matrix is none; nothing else is decided here.

Sentences of a note that may claim something, with marks for their formulas.

Sentences run over inline formulas and end at displays, headings and paragraphs; what stands in brackets
is left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from eom.checker.assume.context import implied
from eom.checker.assume.phrases import Limits, Said, said
from eom.checker.judge.judge import HOLDS, UNDECIDED, UNDER, WRONG, judge, judge_within
from eom.checker.judge.models import equations
from eom.checker.judge.notes import Understood
from eom.checker.judge.verdicts import GRAVE, verdict
from eom.checker.mean.claims import EQUALITIES, STATEMENT, Claim
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.values import Refusal
from eom.checker.prose_claims.pointing import TERMS, Displays, opened, pointed
from eom.checker.prose_claims.proposition_words import Formulas, Subject
from eom.checker.prose_claims.propositions import All, Plain, Proposition, Reading, Test
from eom.checker.prose_claims.quantified import Decision, decide, quantified
from eom.checker.prose_claims.stability import stability, theorem
from eom.checker.read.documents import Document, Piece
from eom.checker.read.places import Source, Span
from eom.checker.read.symbol_shape import labels
from eom.checker.repair.corrections import corrections, workshop
from eom.checker.repair.lines import line
from eom.checker.report.findings import PROSE, Explanation, Finding
from eom.errors import InputError
from eom.limits import Overdue, deadline
from eom.terms.terms import MATRIX, VECTOR, Term, add, atom, mul, nodes, number
from eom.terms.terms import replace as rewritten
from eom.worlds.worlds import closure


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


_CENTRE = (
    r"(?:the |its )?(?:cent(?:re|er) of (?:mass|gravity)|mass cent(?:re|er)|c\.?m\.?|c\.?g\.?)"
)
_A = r"(?:an? |any |the |some |every )?(?:arbitrary |any )?"
POINTS: tuple[tuple[str, tuple[str, ...]], ...] = (
    (_CENTRE, ("about_centre",)),
    (rf"{_A}(?:inertial|inertially fixed|fixed|fixed inertial|stationary)(?: reference)? point",
     ("O_fixed_in_space",)),
    (rf"{_A}point (?:that is |which is )?(?:inertially fixed|fixed in (?:inertial )?space)",
     ("O_fixed_in_space",)),
    (rf"{_A}(?:body[- ]fixed point|point (?:that is |which is )?(?:fixed in|of) the body)",
     ("O_fixed_in_body",)),
    ((rf"{_A}point (?:that is |which is )?fixed (?:both )?in (?:both )?the body and (?:in )?"
     r"(?:inertial )?space"), ("O_fixed_in_body", "O_fixed_in_space")),
    (r"(?:any|an arbitrary|every) point", ()),
)  # fmt: skip
"""Words for a point, and what they say of O."""

_ABOUT = re.compile(
    r"\x02(?P<number>\d+)\x03 holds (?:(?:if|when|provided) )?(?:it is |they are |both are )?"
    r"(?:(?:calculated|taken|computed|evaluated|written|expressed|formed|derived) )?"
    r"(?:about|with respect to|relative to) (?P<points>.+)"
)
_QUANTITIES = frozenset({"torque", "inertia", "angular_momentum", "absolute_angular_momentum"})
_LAWS = ("body_frame", "newton_2", "third_law_strong")
_PLACES = frozenset({"about_centre", "O_fixed_in_space", "O_at_origin", "C_at_rest"})
"""What a note may state of the points, and the words of the claim say otherwise."""


def number_in(text: str) -> int | None:
    """Return the number of the display that a sentence of this kind is about, else None."""
    match = _ABOUT.fullmatch(text)
    return int(match["number"]) if match and _points(match["points"]) is not None else None


def at_points(
    text: str, one: Understood, stated: Iterable[str], given: tuple[str, ...]
) -> Decision | None:
    """Return the verdict on "this holds about such points"; ``one``: what the sentence is about."""
    match = _ABOUT.fullmatch(text)
    points = _points(match["points"]) if match else None
    claim = _claim(one, given, frozenset(stated))
    if points is None or claim is None:
        return None
    known = [n for n in stated if n not in _PLACES]
    decided = [_at(claim, words, names, known, given) for words, names in points]
    if any(d is None for d in decided):
        return None
    found = [d for d in decided if d is not None]
    return next((d for d in found if d.verdict == WRONG), found[0])


def _points(words: str) -> list[tuple[str, tuple[str, ...]]] | None:
    """Return what each of the points says, None if one of them is not known here."""
    found = []
    for part in re.split(r",? or (?:about |with respect to |relative to )?", words):
        names = next((n for p, n in POINTS if re.fullmatch(p, part.strip())), None)
        if names is None:
            return None
        found.append((part.strip(), names))
    return found


def _claim(one: Understood, given: tuple[str, ...], stated: frozenset[str]) -> Claim | None:
    """Return what a display says with all its points called O; of one with a slip, what was meant."""
    judged = verdict(one, given).claims
    if len(judged) != 1:
        return None
    claim = judged[0].claim
    if judged[0].verdict in GRAVE:
        wrong = line(one, claim)
        found = corrections(one, workshop(one, wrong, given), given, stated) if wrong else []
        if not found:
            return None
        claim = found[0].claim
    plain = claim.kind == STATEMENT and EQUALITIES.issuperset(claim.relations) and claim.members
    if claim.findings or claim.model is not None or not plain:
        return None
    terms = [*(m.term for m in claim.members), *claim.scalars.values()]
    names = {n.data[0] for t in terms for n in nodes(t) if n.head == "atom"}
    return _about_o(claim) if names & _QUANTITIES and "position" not in names else None


def _about_o(claim: Claim) -> Claim:
    def rule(term: Term) -> Term:
        about = term.head == "atom" and term.data[0] in _QUANTITIES and term.data[-1] == "C"
        return atom(*term.data[:-1], "O", kind=term.kind) if about else term

    members = tuple(replace(m, term=rewritten(m.term, rule)) for m in claim.members)
    scalars = {s: rewritten(t, rule) for s, t in claim.scalars.items()}
    return replace(claim, members=members, scalars=scalars)


def _at(
    claim: Claim, words: str, names: tuple[str, ...], known: list[str], given: tuple[str, ...]
) -> Decision | None:
    """Return whether a claim holds about one point, None where no world tells."""
    for assumed in _largest([*_LAWS, *names], known):
        found = judge_within(claim, assumed, given)
        if found.verdict == WRONG:
            return Decision(WRONG, (), _failing(claim, words, assumed, given))
        if found.sets:
            return Decision(UNDER, found.sets)
        return Decision(found.verdict, (), found.reason)
    return None


def _largest(names: list[str], known: list[str]) -> Iterator[frozenset[str]]:
    """Yield what is assumed: with all that is known if that can stand together, else without."""
    for more in (known, []):
        try:
            yield closure([*names, *more])
        except InputError:
            continue


def _failing(claim: Claim, words: str, assumed: frozenset[str], given: tuple[str, ...]) -> str:
    """Return that a claim fails about a point, and what else that needs to be."""
    for more, told in (
        ("O_fixed_in_body", "fixed in the body"),
        ("O_fixed_in_space", "fixed in space"),
    ):
        try:
            wider = closure([*assumed, more])
        except InputError:
            continue
        if more not in assumed and judge_within(claim, wider, given).verdict != WRONG:
            return f"about {words} it fails, unless that is {told} as well"
    return f"about {words} it fails"


KINDS: tuple[tuple[str, str, str], ...] = (
    ((r"(?:an? )?(?:proper )?rotation(?: matrix)?|(?:an? )?direction cosine matrix|"
     r"(?:an? )?(?:proper )?(?:orthogonal|orthonormal)(?: matrix)?"), MATRIX, "rotation matrix"),
    (r"(?:an? )?unit vector|normali[sz]ed|of unit (?:length|magnitude|norm)", VECTOR, "unit vector"),
)  # fmt: skip
"""Properties that twice a quantity does not have, its kind, and the property in a word."""

FREE = frozenset({"eigenvectors", "vector"})
"""Quantities that have no such property by what they mean."""

_SHOWS = re.compile(
    r"\x02(?P<number>\d+)\x03 (?:shows|proves|demonstrates|implies|means)(?: that)? "
    r"(?:the (?:matrix|vector) )?\x02(?P<subject>\d+)\x03 (?:is|must be|has to be) (?P<kind>.+)"
)
_INSERTED = re.compile(r",? (?:in fact|indeed|therefore|thus|itself|necessarily|actually)\b,?")
HINTS = re.compile(
    r"normali[sz]|orthonormal|unit (?:vector|length|norm)|right[- ]handed|orthogonal"
)
"""Words that may say elsewhere what the equation does not show."""


def numbers_in(text: str) -> tuple[int, int] | None:
    """Return the numbers of the display and the quantity that a sentence of this kind is about."""
    match = _SHOWS.fullmatch(_INSERTED.sub("", text))
    return (int(match["number"]), int(match["subject"])) if match else None


def shown(
    text: str, one: Understood, subjects: Mapping[int, Subject], given: tuple[str, ...]
) -> Decision | None:
    """Return that an equation does not show what is said, None where nothing is known."""
    match = _SHOWS.fullmatch(_INSERTED.sub("", text))
    subject = subjects.get(int(match["subject"])) if match else None
    if match is None or subject is None:
        return None
    term = subject.terms[0][0]
    kind = next((k for k in KINDS if term.kind == k[1] and re.fullmatch(k[0], match["kind"])), None)
    free = term.head == "atom" and term.data[0] in FREE
    if kind is None or not free or not one.claims or not _unmoved(one, term, given):
        return None
    name, line = subject.text, one.formula.piece.line
    reason = f"line {line} holds with 2 {name} in place of {name} as well, which is no {kind[2]}"
    return Decision(WRONG, (), reason)


def _unmoved(one: Understood, term: Term, given: tuple[str, ...]) -> bool:
    """Tell whether all claims that have a term hold, and hold no less with twice the term."""
    claims = [c for c in one.claims if _twice(c, term) != c]
    if not claims or any(c.findings or c.model is not None for c in claims):
        return False
    for claim in claims:
        before, behind = judge(claim, given), judge(_twice(claim, term), given)
        good = {before.verdict, behind.verdict} <= {HOLDS, UNDER}
        if not good or not set(before.sets) <= set(behind.sets or before.sets):
            return False
    return True


def _twice(claim: Claim, term: Term) -> Claim:
    def rule(node: Term) -> Term:
        return mul(number(2), node) if node == term else node

    members = tuple(replace(m, term=rewritten(m.term, rule)) for m in claim.members)
    return replace(claim, members=members)


MAX_SENTENCE = 600
MAX_SENTENCES = 5000


@dataclass(frozen=True)
class Sentence:
    """Small letters with marks for formulas, its place, and the numbers of its pieces and formulas.

    ``first``: number of the piece where it begins; ``formulas``: numbers of the pieces of its marks.
    """

    text: str
    source: Source
    span: Span
    first: int
    formulas: tuple[int, ...]


_END = re.compile(
    r"[.!?;:](?=\s|\Z)(?<!\be\.g\.)(?<!\bi\.e\.)(?<!\beg\.)(?<!\bie\.)(?<!\bc\.m\.)|"
    r"\n[ \t]*\n|\n[ \t]*[-*+] "
)
_MARKUP = re.compile(r"<[^<>\n]*>|[*_`{}\\~#$←→↑↓—–]|^[ \t]*(?:[-*+]|\d+\.) ", re.MULTILINE)
_BRACKETS = re.compile(r"\([^()]*\)")
_MARK = "\x02{}\x03"


def sentences(pieces: Sequence[Piece]) -> Iterator[Sentence]:
    """Yield the sentences of a note that may claim something.

    One that begins with a small letter goes on with the one before: its full stop is a slip.
    """
    count = 0
    for run in _runs(pieces):
        parts = [p for p in _parts(pieces, run) if p.text]
        for one in _joined(parts):
            count += 1
            if len(one.text) <= MAX_SENTENCE and count <= MAX_SENTENCES:
                yield one
    for k, piece in enumerate(pieces):
        if piece.kind == "display":
            yield from _beside(piece, k)


_VALID = re.compile(
    r"\\text\s*\{\s*\(?((?:this )?(?:is )?(?:only )?(?:valid|true|holds|correct)\b[^{}$()]*)\)?\.?\s*\}",
    re.IGNORECASE,
)


def _beside(piece: Piece, number: int) -> Iterator[Sentence]:
    """Yield what words beside a display say of where it holds."""
    match = _VALID.search(piece.body)
    if match is not None:
        start = piece.span.start + match.start(1)
        text = f"{_MARK.format(number)} {_plain(match[1]).lower()}"
        yield Sentence(text, piece.source, Span(start, start + len(match[1])), number, (number,))


def _runs(pieces: Sequence[Piece]) -> Iterator[list[int]]:
    """Yield the numbers of pieces of prose and inline formulas that stand together."""
    run: list[int] = []
    for k, piece in enumerate(pieces):
        apart = bool(run) and piece.source is not pieces[run[-1]].source
        if apart or piece.kind not in {"prose", "inline"}:
            yield from [run] if run else []
            run = []
        if piece.kind in {"prose", "inline"}:
            run.append(k)
    yield from [run] if run else []


def _parts(pieces: Sequence[Piece], run: Sequence[int]) -> Iterator[Sentence]:
    """Yield the sentences of a run, cut at every full stop."""
    text, places, owners = "", list[int](), list[int]()
    for k in run:
        piece = pieces[k]
        inline = piece.kind == "inline"
        body = f" {_MARK.format(k)} " if inline else _MARKUP.sub(_blank, opened(piece.body))
        text += body
        wide = 0 if inline else 1
        places += [piece.span.start + wide * n for n in range(len(body))]
        owners += [k] * len(body)
    cuts = [0, *(m.end() for m in _END.finditer(text)), len(text)]
    for start, stop in pairwise(cuts):
        inside = text[start:stop]
        lead = len(inside) - len(inside.lstrip())
        tail = len(inside.rstrip()) - 1
        if tail >= lead:
            first, last = start + lead, start + tail
            end = pieces[owners[last]].span.stop if text[last] == "\x03" else places[last] + 1
            yield Sentence(
                _plain(inside),
                pieces[run[0]].source,
                Span(places[first], end),
                owners[first],
                tuple(int(n) for n in re.findall("\x02(\\d+)\x03", inside)),
            )


def _blank(match: re.Match[str]) -> str:
    return " " * len(match[0])


def _plain(text: str) -> str:
    """Return a sentence without what stands in brackets and without its full stop."""
    bare = _BRACKETS.sub(" ", text)
    return re.sub(r"\s+", " ", bare).strip(" .!?;:,\n\t")


def _joined(parts: Sequence[Sentence]) -> Iterator[Sentence]:
    """Yield sentences; what begins with a small letter behind a full stop is a part of the one before.

    The first letter alone is made small here; others stay, as they may name points.
    """
    kept: Sentence | None = None
    for one in parts:
        goes_on = kept is not None and one.text[0].islower() and _stopped(kept, one)
        goes_on = goes_on or (kept is not None and _listing(kept, one))
        if kept is not None and goes_on:
            span = Span(kept.span.start, one.span.stop)
            formulas = (*kept.formulas, *one.formulas)
            kept = replace(kept, text=f"{kept.text} {one.text}", span=span, formulas=formulas)
            continue
        if kept is not None:
            yield replace(kept, text=kept.text.lower())
        kept = one
    if kept is not None:
        yield replace(kept, text=kept.text.lower())


_CONDITION = re.compile(r"(?:if|when|whenever) ")


def _listing(before: Sentence, behind: Sentence) -> bool:
    """Tell whether a colon parts a claim from its conditions: "it vanishes in two cases: if ..."."""
    colon = before.source.text[before.span.stop - 1] == ":"
    return colon and _CONDITION.match(behind.text) is not None


def _stopped(before: Sentence, behind: Sentence) -> bool:
    """Tell whether nothing but a full stop stands between two sentences."""
    text = before.source.text
    between = text[before.span.stop - 1 : behind.span.start]
    return (
        re.fullmatch(r".?\s*\.?[ \t]*\n?[ \t]*", between) is not None
        and text[before.span.stop - 1] in ".,"
    )
