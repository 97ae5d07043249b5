"""Assumptions that a note states in English words, and how far they reach.

An assumption in a heading holds in its section; after "if" or "when" in its paragraph with the displays
that belong to it; after "suppose", "consider", "in this case" in its section; else from there on.
Knowledge is the tables here; a phrase that is denied ("not rigid") states nothing.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from eom.checker.read.documents import Piece
from eom.checker.read.places import Source
from eom.worlds.worlds import ASSUMPTIONS

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
    (r"(?:reaction|momentum) wheels?|gyrostat|flywheels?|spinning rotors?", ("rotors",)),
    (r"energy sink|viscous (?:slug|ring|damper)", ("viscous_slug",)),
    (r"3-1-2\b", ("spin_312",)),
    *((f"(?i:{re.escape(row.meaning)})", (name,)) for name, row in ASSUMPTIONS.items()),
)  # fmt: skip
"""Patterns in small letters, but for names of points, and the assumptions that they state."""

NOTE, SECTION, PARAGRAPH = "note", "section", "paragraph"

APPROXIMATE: tuple[tuple[str, str], ...] = (
    (r"small[- ](?:angle|displacement|deviation|oscillation|perturbation)s?|lineari[sz]", SECTION),
    (
        (
            r"(?:is|are|remains?) small\b|to (?:the )?first order|first[- ]order (?:in|approx)|"
            r"\bapproximat(?:ely|ion|ed?)\b|negligib|neglect|higher[- ]order terms"
        ),
        PARAGRAPH,
    ),
)
"""Words after which an equation need not hold exactly, and how far they reach."""

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


def approximate(pieces: Sequence[Piece]) -> tuple[Said, ...]:
    """Return the places where words say that what follows is no exact equation."""
    limits = Limits(pieces)
    found = []
    for sentence in sentences(pieces):
        for pattern, scope in APPROXIMATE:
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


def sentences(pieces: Sequence[Piece]) -> Iterator[_Sentence]:
    """Yield sentences of prose with the inline formulas in them, and headings."""
    text, places = "", list[Place]()
    for k, piece in enumerate(pieces):
        apart = piece.kind in {"display", "heading"} or (
            k > 0 and piece.source is not pieces[k - 1].source
        )
        if apart:
            yield from _split(text, places)
            text, places = "", []
        if piece.kind == "display":
            yield from _texts(k, piece)
        elif piece.kind == "heading":
            body = _plain(piece.body)
            yield _Sentence(body, tuple((k, piece.span.start + n) for n in range(len(body))), True)
        else:
            body = _plain(piece.body) if piece.kind == "prose" else f" {letters(piece.body)} "
            wide = int(piece.kind == "prose")
            for first in range(0, len(body), MAX_RUN):
                if len(text) >= MAX_RUN:
                    yield from _split(text, places)
                    text, places = "", []
                part = body[first : first + MAX_RUN]
                text += part
                places += [(k, piece.span.start + wide * (first + n)) for n in range(len(part))]
    yield from _split(text, places)


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
