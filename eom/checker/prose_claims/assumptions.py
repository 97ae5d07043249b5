"""What a note has assumed where a formula stands: by words, and by formulas.

Words: `PHRASES` are the assumptions that a note states in English. One in a heading holds in its section;
after "if" or "when" in its paragraph with the displays that belong to it; after "suppose", "consider", "in
this case" in its section; else from there on. A phrase that is denied ("not rigid") states nothing.

Formulas: one that plays the part of an assumption, or from which an arrow leads on, is matched with the
assumptions of `eom.worlds.worlds`: the smallest set under which it holds is what it amounts to, if its own
equation follows back from it. What matches none is a premise that claims may rest on.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from eom.checker.judge.consequences import follows
from eom.checker.judge.coordinates import on_solutions
from eom.checker.judge.judge import HOLDS, UNDER
from eom.checker.judge.notes import Understood
from eom.checker.judge.verdicts import LAWS, Judged, Verdict
from eom.checker.mean.claims import CONSTANT, SAME_POINT, Claim
from eom.checker.mean.elaborate import elaborator
from eom.checker.mean.roles import ASSUMPTION, RECALLED
from eom.checker.mean.values import ANY, Refusal, Value, overdot
from eom.checker.read.documents import Document, Piece
from eom.checker.read.spans import Source
from eom.errors import InputError
from eom.terms.terms import Term, der, dot, zero
from eom.terms.vocabulary import omega, position, quantity, unit
from eom.worlds.worlds import ASSUMPTIONS, closure

# -- words ----------------------------------------------------------------------------------------

_CENTRE = r"(?:cent(?:re|er) of (?:mass|gravity)|mass cent(?:re|er)|c\.?m\.?|com|c\.?g\.?|centroid)"
_POINT = r"(?:point |origin |reference point )*\b(?-i:[A-Z•](?:_[A-Z])?)(?![\w'’])"
_LIES = r"(?:is|be|lies|coincides with|is (?:placed|located|chosen|taken) (?:at|as|to be)|at|≡)"

PHRASES: tuple[tuple[str, tuple[str, ...]], ...] = (
    (r"rigid(?:ity|ly)?\b", ("rigid",)),
    (r"body[- ]fixed (?:reference )?(?:frame|axes|basis|coordinate)", ("body_frame",)),
    (r"(?:body axes|body frame|body coordinates|body basis)\b", ("body_frame",)),
    (
        (r"(?:frame|axes|basis|coordinates?|vectors)(?: system)? (?:\w+ ){0,3}(?:fixed|attached) "
        r"(?:in|to) (?:it\b|(?:the|a|its) (?:rigid )?body)"),
        ("body_frame",),
    ),
    (rf"about (?:the|its|their)(?: common| own)? {_CENTRE}\b", ("about_centre",)),
    (rf"(?:from|relative to|with respect to) the {_CENTRE}\b", ("about_centre",)),
    (rf"{_POINT},? {_LIES} (?:the |its )?(?:body['’]s )?{_CENTRE}\b", ("about_centre",)),
    (rf"origin (?:\w+ ){{0,3}}at (?:the|its) {_CENTRE}\b", ("about_centre",)),
    (rf"{_POINT},? (?:is |be |which is )?(?:an? )?(?:inertially )?fixed in (?:inertial )?space",
     ("O_fixed_in_space",)),
    (rf"{_POINT},? (?:is |be |which is )(?:an? )?(?:inertially )?fixed(?! (?:in|to|at|with)\b)",
     ("O_fixed_in_space",)),
    (rf"{_POINT},? (?:is |be |which is )?fixed (?:in|to) (?:it\b|the body)", ("O_fixed_in_body",)),
    (r"inertially fixed point|(?:fixed|arbitrary) inertial point", ("O_fixed_in_space",)),
    (r"\ba fixed (?:reference )?(?:point|origin) (?-i:O)\b(?! (?:of|in|on|to)\b)", ("O_fixed_in_space",)),
    (r"\bfixed point (?-i:O )?(?:of|in|on) (?:the|a|its) (?:rigid )?body\b", ("O_fixed_in_body",)),
    (r"\bbody (?:\w+ ){0,6}(?:rotat\w+|turn\w+|spin\w+)\b[^.;]{0,60}? about (?:point )?(?-i:O)\b",
     ("O_fixed_in_body",)),
    (r"(?:rotat\w+|turn\w*|spin\w*|motion|mov\w+|pivot\w*) about a fixed (?:point|pivot)",
     ("O_fixed_in_body", "O_fixed_in_space")),
    (rf"{_CENTRE} (?:is|remains|stays|be) (?:at rest|fixed|stationary)", ("C_at_rest",)),
    (r"principal (?:body[- ]fixed |body |inertia )?(?:axis|axes|frame|basis|coordinates|moments?\b)",
     ("principal_axes",)),
    (r"\b(?:ax[ie]s|frame|basis|coordinates?) (?:are|is|be|being|to be) (?:the )?principal\b",
     ("principal_axes",)),
    (r"axi[- ]?symmetric|axial(?:ly)?[- ]symmetr\w+|axis of (?:inertial )?symmetry|symmetry axis",
     ("symmetric",)),
    (r"symmetric(?:al)? (?:rigid |spinning |heavy )?(?:body|top|rotor|spacecraft|satellite)",
     ("symmetric",)),
    (r"torque[- ]free|free of (?:external )?torques?", ("torque_free",)),
    ((r"(?:no|zero|vanishing|without(?: any)?)(?: net| external| applied| resultant| total)* "
     r"(?:torques?|moments?)\b(?! of inertia)"), ("torque_free",)),
    ((r"(?:torque|moment)s?(?: \w+){0,4}? (?:is|are|be|being) (?:zero|absent)|"
     r"(?:torque|moment)s?(?: \w+){0,3} vanish(?:es)?"), ("torque_free",)),
    (r"newton['’]?s (?:second|2\s?nd|ii)|second law of newton|newton['’]?s laws?\b(?! of grav)",
     ("newton_2",)),
    (r"newton['’]?s (?:third|3\s?rd|iii)|actio et reactio|action and reaction|newton['’]?s laws\b",
     ("third_law_weak",)),
    ((r"strong (?:form|version|law)(?: of newton['’]?s (?:third|3\s?rd) law)?|"
     r"(?:internal )?forces (?:are|being) central|central internal forces|"
     r"act(?:s|ing)? along (?:the line|.{1,12}\br?ho_?i)"), ("third_law_strong",)),
    (r"(?:constant|fixed|invariable) mass\b|mass(?:es)? (?:is|are|remains?|stays?) constant",
     ("constant_mass",)),
    (r"(?:single|one) (?:particle|point mass|mass point)|(?:a|the) point mass\b", ("one_particle",)),
    (r"(?:thin|slender) (?:rod|bar)", ("thin_rod",)),
    (r"\blamina\b|plane (?:body|figure|plate)|(?:thin|flat) plate", ("plane_body",)),
    (r"(?:rotat\w+|turn\w*|spin\w*) about (?:a|one|the same) fixed axis", ("fixed_axis",)),
    (r"(?:constant|uniform|steady) angular velocity|(?:turns|rotates|spins) uniformly",
     ("steady_turn",)),
    ((r"(?:constant|steady) (?:wheel|rotor|spin)[- ]speeds?|"
      r"(?:wheel|rotor)s? (?:runs?|spins?) at (?:a )?constant"),
     ("steady_rotors",)),
    (r"(?:reaction|momentum) wheels?|gyrostat|flywheels?|spinning rotors?", ("rotors",)),
    (r"energy sink|viscous (?:slug|ring|damper)", ("viscous_slug",)),
    (r"3-1-2\b", ("spin_312",)),
    (r"(?:fog|mist|clouds?|dust|sand|snow|rain|drop(?:let)?s|links?|gas) (?:\w+ ){0,4}at rest",
     ("exhaust_at_rest",)),
    (r"(?:without|with no|zero|vanishing) relative velocity", ("exhaust_with_body",)),
    *((f"(?i:{re.escape(row.meaning)})", (name,)) for name, row in ASSUMPTIONS.items()),
)  # fmt: skip
"""Patterns in small letters, but for names of points, and the assumptions that they state."""

NOTE, SECTION, PARAGRAPH = "note", "section", "paragraph"

APPROXIMATE: tuple[tuple[str, str], ...] = (
    ((r"small[- ](?:angle|displacement|deviation|oscillation|perturbation|motion|vibration)s?|"
      r"small(?=\s*[).,;:])|lineari[sz]"), SECTION),
    ((r"(?:is|are|remains?|stays?|for) (?:sufficiently |very )?small\b|"
      r"to (?:the )?first order|first[- ]order (?:in|approx)|"
      r"\bapproximat(?:ely|ion|ed?)\b|negligib|neglect|higher[- ]order terms"), PARAGRAPH),
)  # fmt: skip
"""Words after which an equation need not hold exactly, and how far they reach."""

ANY_MOTION: tuple[tuple[str, str], ...] = (
    ((r"\barbitrar(?:y|ily)\b|\bchanging\b|\bvar(?:y|ies|ying)\b|\bspeeds? up\b|\bslows? down\b|"
      r"\bgeneral (?:\w+ )?motion|\btime[- ]varying\b|\bnon-?uniform\w*|\bunsteady\b|"
      r"\b(?:may|can|will) (?:change|vary|accelerate)|\bnot constant\b"), PARAGRAPH),
)  # fmt: skip
"""Words after which a motion is any, so that no special one is meant, and how far they reach."""

SCOPES: tuple[tuple[str, str], ...] = (
    (r"\b(?:from now on|henceforth|throughout|always|in (?:this|these) (?:note|lecture|chapter)s?)\b",
     NOTE),
    ((r"\b(?:if|when|whenever|unless|provided|in (?:the|this|that) case|in case|for an?|as long as|"
     r"where|whether|iff|eg|e\.g|case (?:of|with|where))\b|\b(?:for|at|under|setting|putting)(?=\s*$)"),
     PARAGRAPH),
    (r"\b(?:suppose|assum\w+|consider|let|restrict|special case|take|taking|choos\w+|focus\w*)\b",
     SECTION),
)  # fmt: skip
"""Words in front of a phrase in its sentence, and how far what they introduce reaches; else the note."""

_DENIED = re.compile(
    r"(?:\bnot|\bnon|\bno longer|n['’]t|\bneed not be|\bnever|\bneither|\bnor|\binstead of|\bother than|"
    r"\brather than|\bwithout|\bnecessarily|\barbitrary)(?:[- ]+(?:\w+[- ]+){0,2})?$",
    re.IGNORECASE,
)
_GOING_ON = re.compile(
    r"(?:then|hence|thus|so|therefore|it follows|in (?:this|that|which) case|where|and|with|which)\b",
    re.IGNORECASE,
)
_OF_QUANTITY = re.compile(r"(?:about|from|relative to|with respect to) ", re.IGNORECASE)
"""Phrases that say of which quantity it is, rather than what is assumed."""
_SAID_OF = re.compile(r"\b(?:is|are|be|since|because|as)(?: \w+)?\s*$", re.IGNORECASE)
_COMPILED = tuple((re.compile(p, re.IGNORECASE), names) for p, names in PHRASES)
_LEADS = tuple((re.compile(p, re.IGNORECASE), scope) for p, scope in SCOPES)
_END = re.compile(
    r"[.!?;](?=\s+\S)(?<!\be\.g\.)(?<!\beg\.)(?<!\bi\.e\.)(?<!\bEq\.)|\n[ \t]*\n|:(?=\s*$)"
)

MAX_RUN = 20_000
"""Characters of prose that are looked at together; longer runs are cut."""
MAX_BEFORE = 400
"""Characters in front of a phrase or formula that are looked at."""
MAX_SAID = 1000
"""Phrases that are kept, the first ones."""

Place = tuple[int, int]
"""Number of a piece, and an offset in its source."""


@dataclass(frozen=True)
class Said:
    """An assumption in words: names of assumptions, words, where it holds from and up to which piece.

    ``pointed``: a condition, or said of something, not only mentioned.
    """

    names: tuple[str, ...]
    text: str
    source: Source
    start: Place
    stop: int
    scope: str
    pointed: bool = False

    @property
    def line(self) -> int:
        """Line of the words, from 1."""
        return self.source.line_column(self.start[1])[0]


@dataclass(frozen=True)
class _Sentence:
    """Text of a sentence, formulas by their letters, and where each character comes from."""

    text: str
    places: tuple[Place, ...]
    heading: bool = False


def said(pieces: Sequence[Piece]) -> tuple[Said, ...]:
    """Return the assumptions that words state, in order; what holds already is not said again."""
    limits = Limits(pieces)
    found: list[Said] = []
    known: set[tuple[tuple[str, ...], int]] = set()
    for sentence in sentences(pieces):
        for names, start, stop in _matches(sentence.text):
            one = _said(pieces, sentence, names, (start, stop), limits)
            if one.pointed or (names, one.stop) not in known:
                known.add((names, one.stop))
                found.append(one)
        if len(found) >= MAX_SAID:
            break
    return tuple(sorted(found, key=lambda s: s.start))


def _said(
    pieces: Sequence[Piece],
    sentence: _Sentence,
    names: tuple[str, ...],
    span: tuple[int, int],
    limits: Limits,
) -> Said:
    before = sentence.text[: span[0]]
    scope = SECTION if sentence.heading else scope_of(before)
    place = sentence.places[span[0]]
    quantity = _OF_QUANTITY.match(sentence.text, span[0]) is not None
    of_something = _SAID_OF.search(before[-60:]) is not None
    return Said(
        names,
        sentence.text[slice(*span)].strip(),
        pieces[place[0]].source,
        place,
        limits.stop(place[0], scope),
        scope,
        not sentence.heading and not quantity and (scope != NOTE or of_something),
    )


def spoken(pieces: Sequence[Piece], table: Iterable[tuple[str, str]]) -> tuple[Said, ...]:
    """Return the places where words of a table stand, patterns with how far they reach."""
    limits = Limits(pieces)
    found = []
    for sentence in sentences(pieces):
        for pattern, scope in table:
            for match in re.finditer(pattern, sentence.text, re.IGNORECASE):
                place = sentence.places[match.start()]
                until = limits.stop(place[0], scope)
                found.append(Said((), match[0], pieces[place[0]].source, place, until, scope))
    return tuple(found)


def _matches(text: str) -> Iterator[tuple[tuple[str, ...], int, int]]:
    """Yield the first place of every pattern in a sentence where it is not denied."""
    for pattern, names in _COMPILED:
        for match in pattern.finditer(text):
            if not _DENIED.search(text[max(0, match.start() - 60) : match.start()]):
                yield names, match.start(), match.end()
                break


def scope_of(before: str) -> str:
    """Return how far what stands behind some words reaches: the last lead counts."""
    before = before[-MAX_BEFORE:]
    ends = [(m.end(), scope) for p, scope in _LEADS for m in p.finditer(before)]
    return max(ends)[1] if ends else NOTE


# -- sentences and paragraphs -----------------------------------------------------------------------


def runs(pieces: Sequence[Piece]) -> Iterator[list[int]]:
    """Yield numbers of pieces: of prose and inline formulas that stand together, of all others alone."""
    run: list[int] = []
    inner = ("prose", "inline")
    for k, piece in enumerate(pieces):
        before = pieces[k - 1] if k else None
        joined = before is not None and before.source is piece.source and before.kind in inner
        if not (joined and piece.kind in inner):
            yield from [run] if run else []
            run = []
        run.append(k)
    yield from [run] if run else []


def written(
    pieces: Sequence[Piece],
    run: Sequence[int],
    prose: Callable[[str], str],
    inline: Callable[[int], str],
) -> tuple[str, list[Place]]:
    """Return the text of a run and where each character comes from.

    ``prose``: what is read of prose, character by character; ``inline``: what stands for a formula.
    """
    text, places = "", list[Place]()
    for k in run:
        start, wide = pieces[k].span.start, int(pieces[k].kind == "prose")
        body = prose(pieces[k].body) if wide else f" {inline(k)} "
        text += body
        places += [(k, start + wide * n) for n in range(len(body))]
    return text, places


def sentences(pieces: Sequence[Piece]) -> Iterator[_Sentence]:
    """Yield sentences of prose with the inline formulas in them, and headings."""
    for run in runs(pieces):
        first = pieces[run[0]]
        if first.kind == "display":
            yield from _texts(run[0], first)
        elif first.kind == "heading":
            body, start = _plain(first.body), first.span.start
            places = tuple((run[0], start + n) for n in range(len(body)))
            yield _Sentence(body, places, True)
        else:
            text, found = written(pieces, run, _plain, lambda k: letters(pieces[k].body))
            for cut in range(0, len(text), MAX_RUN):
                yield from _split(text[cut : cut + MAX_RUN], found[cut : cut + MAX_RUN])


_TEXT = re.compile(r"\\(?:text|textrm|textit|mbox|mathrm)\s*\{([^{}]*\s[^{}]*)\}")


def _texts(number: int, piece: Piece) -> Iterator[_Sentence]:
    """Yield the words inside a display, part by part."""
    for match in _TEXT.finditer(piece.body):
        places = tuple(
            (number, piece.span.start + match.start(1) + n) for n in range(len(match[1]))
        )
        yield from _squeezed(re.sub(r"\s", " ", match[1]), places)


def _plain(text: str) -> str:
    """Return prose without marks, every character where it was."""
    return re.sub(r"<[^<>\n]*>|[*_`{}\\~#]|\n(?![ \t]*\n)", lambda m: " " * len(m[0]), text)


def letters(body: str) -> str:
    r"""Return the letters of a formula: ``\mathcal{F}_B`` is F_B, ``\bullet`` and ``\cdot`` go.

    >>> letters(r"\vec{M}_{O} = 0"), letters(r"O \equiv \bullet")
    ('M_O = 0', 'O ≡ •')
    """
    body = body.replace(r"\equiv", "≡").replace(r"\bullet", "•")
    return re.sub(r"\s+", " ", re.sub(r"\\[A-Za-z]+|[{}$\\]", "", body)).strip()


def _split(text: str, places: Sequence[Place]) -> Iterator[_Sentence]:
    start = 0
    for end in [*(m.end() for m in _END.finditer(text)), len(text)]:
        part = re.sub(r"\s", " ", text[start:end])
        if part.strip():
            yield from _squeezed(part, places[start:end])
        start = end


def _squeezed(text: str, places: Sequence[Place]) -> Iterator[_Sentence]:
    """Yield a sentence with one blank for many."""
    kept = [n for n, c in enumerate(text) if c != " " or (n and text[n - 1] != " ")]
    yield _Sentence("".join(text[n] for n in kept), tuple(places[n] for n in kept))


class Limits:
    """Up to which piece a section or a paragraph around a piece goes."""

    def __init__(self, pieces: Sequence[Piece]) -> None:
        self.pieces = pieces
        self.levels = [p.level if p.kind == "heading" else 0 for p in pieces]

    def stop(self, number: int, scope: str) -> int:
        """Return the number of the first piece behind a scope."""
        if scope == PARAGRAPH:
            return self._paragraph(number)
        heading = next((k for k in range(number, -1, -1) if self.levels[k]), None)
        if scope == NOTE or heading is None:
            return len(self.pieces)
        level = self.levels[heading]
        later = range(heading + 1, len(self.pieces))
        return next((k for k in later if 0 < self.levels[k] <= level), len(self.pieces))

    def _paragraph(self, number: int) -> int:
        """Return where a new paragraph begins that does not go on with this one."""
        for k in range(number + 1, len(self.pieces)):
            piece = self.pieces[k]
            if piece.kind == "heading":
                return k
            if piece.kind != "prose":
                continue
            parts = re.split(r"\n[ \t]*\n", piece.body)
            begun = [p.strip() for p in parts[1:]]
            if self.pieces[k - 1].kind == "display":
                begun = [p.strip() for p in parts if p.strip()][:1]
            if any(p and not _goes_on(p) for p in begun):
                return k
        return len(self.pieces)


def _goes_on(paragraph: str) -> bool:
    """Whether a paragraph goes on with the one before: by a small letter, or its first word."""
    bare = paragraph.lstrip("*_[(<>~# ")
    return not bare[:1].isupper() or _GOING_ON.match(bare) is not None


# -- what is stated where -------------------------------------------------------------------------


@dataclass(frozen=True)
class Stated:
    """An assumption that a note states.

    ``names``: rows of the table of assumptions that it amounts to, none where it matches none;
    ``text``: as it stands; ``start``: where it holds from; ``stop``: the number of the first piece
    where it holds no more; ``scope``: how far it reaches, in a word; ``premises``: what a formula says;
    ``pointed``: a condition, or said of something, not only mentioned.
    """

    names: tuple[str, ...]
    text: str
    source: Source
    start: Place
    stop: int
    scope: str = NOTE
    premises: tuple[Claim, ...] = ()
    pointed: bool = True

    @property
    def line(self) -> int:
        """Line of the assumption, from 1."""
        return self.source.line_column(self.start[1])[0]

    def holds_at(self, place: Place) -> bool:
        """Whether this has been stated where a place is, and still holds there."""
        return self.start <= place and place[0] < self.stop


@dataclass(frozen=True)
class Context:
    """What a note states, and where each of its formulas stands: place and source."""

    stated: tuple[Stated, ...]
    places: tuple[Place, ...]
    sources: tuple[Source, ...]

    def at(self, number: int) -> tuple[Stated, ...]:
        """Return what has been stated where a formula stands, in order; itself left out."""
        place = self.places[number]
        return tuple(s for s in self.stated if s.holds_at(place) and s.start != place)

    def later(self, number: int) -> tuple[Stated, ...]:
        """Return what is stated behind a formula."""
        return tuple(s for s in self.stated if s.start > self.places[number])

    def names(self, number: int) -> frozenset[str]:
        """Return the assumptions that have been stated where a formula stands, and what they need."""
        return implied(n for s in self.at(number) for n in s.names)

    def premises(self, number: int) -> tuple[Stated, ...]:
        """Return the formulas among what has been stated that match no assumption of the table."""
        return tuple(s for s in self.at(number) if s.premises and not s.names)


def implied(names: Iterable[str]) -> frozenset[str]:
    """Return assumptions with what each of them needs; they need not stand together."""
    return frozenset().union(*(_closed(n) for n in set(names)))


@cache
def _closed(name: str) -> frozenset[str]:
    return closure([name])


def assumed(
    document: Document, understood: Sequence[Understood], verdicts: Sequence[Verdict]
) -> Context:
    """Return what a note states; ``verdicts``: of all its formulas, in order."""
    limits = Limits(document.pieces)
    numbers = [k for k, p in enumerate(document.pieces) if p.is_formula]
    places = tuple((k, document.pieces[k].span.start) for k in numbers)
    leads = _leads(document.pieces)
    found = [
        Stated(s.names, s.text, s.source, s.start, s.stop, s.scope, (), s.pointed)
        for s in said(document.pieces)
    ]
    for place, one, verdict in zip(places, understood, verdicts, strict=True):
        found += _formulas(place, one, verdict, leads.get(place[0], ""), limits)
        found += _steady(document.pieces, place, one, leads.get(place[0], ""), limits)
    sources = tuple(document.pieces[k].source for k in numbers)
    return Context(tuple(sorted(found, key=lambda s: s.start)), places, sources)


def _leads(pieces: Sequence[Piece]) -> Mapping[int, str]:
    """Return the words of the sentence in front of every formula, by its number."""
    found: dict[int, str] = {}
    for sentence in sentences(pieces):
        for n, (k, _) in enumerate(sentence.places):
            if n and k != sentence.places[n - 1][0]:
                found[k] = sentence.text[max(0, n - MAX_BEFORE) : n]
        behind = sentence.places[-1][0] + 1
        if behind < len(pieces) and pieces[behind].kind == "display":
            found[behind] = sentence.text[-MAX_BEFORE:]
    return found


def _formulas(
    place: Place, one: Understood, verdict: Verdict, lead: str, limits: Limits
) -> Iterator[Stated]:
    """Yield what a formula states: conditions of its own hold for it alone."""
    piece = one.formula.piece
    arrow = [j.claim.joined == "implies" for j in verdict.claims[1:]]
    for k, judged in enumerate(verdict.claims):
        if not (_assumes(judged, one.role) or (any(arrow[k:]) and _antecedent(judged))):
            continue
        scope = scope_of(lead)
        scope = PARAGRAPH if scope == NOTE and judged.verdict != ASSUMPTION else scope
        stop = place[0] + 1 if judged.claim.role else limits.stop(place[0], scope)
        start = (place[0], piece.span.start - 1) if judged.claim.role else place
        names = amounts(judged)
        premises = (judged.claim,) if judged.judgement.verdict != HOLDS else ()
        text = letters(piece.body)
        yield Stated(names, text, piece.source, start, stop, scope, premises)


def of_systems(
    document: Document, understood: Sequence[Understood], verdicts: Sequence[Verdict]
) -> tuple[Stated, ...]:
    """Return conditions on quantities of systems: of a line for it, others within their paragraph."""
    limits, leads = Limits(document.pieces), _leads(document.pieces)
    numbers = [k for k, p in enumerate(document.pieces) if p.is_formula]
    found = []
    for k, one, verdict in zip(numbers, understood, verdicts, strict=True):
        piece, before = one.formula.piece, scope_of(leads.get(k, "")) == PARAGRAPH
        for claim in (j.claim for j in verdict.claims if j.verdict == ASSUMPTION):
            if on_solutions(claim) and (claim.role or before):
                stop = k + 1 if claim.role else limits.stop(k, PARAGRAPH)
                start = (k, piece.span.start - 1)
                text = letters(piece.body)
                found.append(Stated((), text, piece.source, start, stop, PARAGRAPH, (claim,)))
    return tuple(found)


_STEADY = re.compile(r"\s*,?\s*(?:is|are|remains?|stays?|being|is held|is kept) constant\b")


def _steady(
    pieces: Sequence[Piece], place: Place, one: Understood, lead: str, limits: Limits
) -> Iterator[Stated]:
    """Yield what "when x is constant" states: that the rate of x is zero."""
    behind = pieces[place[0] + 1] if place[0] + 1 < len(pieces) else None
    reading, scope = one.formula.reading, scope_of(lead)
    said = behind is not None and behind.kind == "prose" and _STEADY.match(behind.body)
    if not said or scope == NOTE or reading is None or one.formula.relational:
        return
    e = elaborator(one.lexicon, dict(one.around.definitions))
    piece = one.formula.piece
    try:
        rate = overdot(one.lexicon.notation, e.value(reading.tree), 1, piece.span)
    except Refusal:
        return
    claim = Claim((rate,), (), CONSTANT, scalars=e.scalars, span=piece.span)
    text = f"{letters(piece.body)} is constant"
    yield Stated((), text, piece.source, place, limits.stop(place[0], scope), scope, (claim,))


def _assumes(judged: Judged, role: str) -> bool:
    """Whether a claim is assumed: by the words around it, or recalled with what it needs."""
    if judged.verdict == ASSUMPTION or judged.claim.kind == SAME_POINT:
        return True
    return role == RECALLED and judged.verdict == UNDER


def _antecedent(judged: Judged) -> bool:
    """Whether an arrow leads on from a claim that needs more than laws."""
    sets = judged.judgement.sets
    return judged.verdict == UNDER and not any(set(s) <= {n for w in LAWS for n in w} for s in sets)


# -- what a formula amounts to ------------------------------------------------------------------------


def amounts(judged: Judged) -> tuple[str, ...]:
    """Return the assumptions that a formula amounts to, of a smallest set under which it holds.

    Those follow back from it, in worlds where the others of the set hold; one that is known by no
    equation has to stand alone in its set.
    """
    for names in sorted(judged.judgement.sets, key=len):
        found = tuple(n for n in names if _back(judged.claim, n, [m for m in names if m != n]))
        if found:
            return found
    return ()


def _back(claim: Claim, name: str, others: Sequence[str]) -> bool:
    """Whether the equation of an assumption follows from a claim; one without equations does."""
    if name not in EQUATIONS:
        return not others and name not in MODELLED
    try:
        base = closure([*_BASES.get(name, ()), *others])
    except InputError:
        return False
    if name in base:
        return False
    return all(
        follows(vanishing(t, claim.scalars), (claim,), base, _SIMPLE) for t in EQUATIONS[name]
    )


_SIMPLE = 24
"""Multiples of a formula among which the equation of an assumption is looked for."""


def vanishing(term: Term, scalars: Mapping[Any, Term]) -> Claim:
    """Return the claim that a term is zero; its dimension is open."""
    values = (Value(term, term.kind, None, ANY), Value(zero(term.kind), term.kind, None, ANY))
    return Claim(values, ("=",), scalars=scalars)


_I = quantity("inertia", "C")
_M = quantity("torque", "body", "C")


def inertia_entry(a: int, b: int) -> Term:
    """Return an entry of the inertia matrix about C in the body frame (kg m^2)."""
    return dot(unit("B", a), dot(_I, unit("B", b)))


EQUATIONS: Mapping[str, tuple[Term, ...]] = {
    "about_centre": (position("C", "O"),),
    "OA_at_centre": (position("C", "OA"),),
    "O_at_origin": (position("O", "OI"),),
    "O_fixed_in_space": (der(position("O", "OI")),),
    "OA_fixed_in_space": (der(position("OA", "OI")),),
    "OB_fixed_in_space": (der(position("OB", "OI")),),
    "C_at_rest": (der(position("C", "OI")),),
    "principal_axes": (inertia_entry(1, 2), inertia_entry(1, 3), inertia_entry(2, 3)),
    "symmetric": (inertia_entry(1, 1) - inertia_entry(2, 2),),
    "symmetric_1": (inertia_entry(2, 2) - inertia_entry(3, 3),),
    "symmetric_2": (inertia_entry(3, 3) - inertia_entry(1, 1),),
    "torque_free": (_M,),
    "no_torque_2": (dot(unit("B", 2), _M),),
    "no_torque_3": (dot(unit("B", 3), _M),),
    "A_fixed_in_body": (omega("A", "B"),),
}
"""What is zero by an assumption, where that is one equation."""
_BASES: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("OA_at_centre", "OA_fixed_in_space", "OB_fixed_in_space"), ("rigid",)),
    "torque_free": ("body_frame",),
    **dict.fromkeys(("symmetric", "symmetric_1", "symmetric_2"), ("principal_axes",)),
    "principal_axes": ("body_frame",),
    "no_torque_2": ("spin_312",),
    "no_torque_3": ("spin_312",),
    "A_fixed_in_body": ("body_frame",),
}
"""Worlds in which the equations have a meaning."""
MODELLED = frozenset(
    "spin_312 rotors viscous_slug one_particle thin_rod principal_at_O plane_body fixed_axis one_rotor "
    "steady_rotors steady_turn first_turn O_uniform exhaust_at_rest exhaust_with_body".split()
)
"""Models and motions that no formula amounts to."""
