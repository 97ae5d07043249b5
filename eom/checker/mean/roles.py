r"""The part that a formula plays in its sentence, from the words around it.

"If", "assume", "let", "consider the case with" make it an assumption; "where", "we call" a definition;
"since", "noting that" recall what is known; "is given by" brings in a quantity; what follows "then" or
"we have" is a claim, and so is everything else. Words are English, and knowledge is the tables here.

New symbols by their first equation, where the words say so, within its heading; and an index that a
formula lets run over the three axes: (r = 1, 2, 3), for i = 1, 2, 3, i = x, y, z.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from eom.checker.mean.claims import Claim, defined
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.values import Value
from eom.checker.read.documents import Piece
from eom.checker.read.statements import Statement
from eom.checker.read.symbol_shape import Look, labels, seen
from eom.checker.read.syntax import (
    Dots,
    Group,
    Node,
    Number,
    Relation,
    Sign,
    Symbol,
    walk,
)
from eom.checker.read.syntax import Sequence as Items
from eom.terms.terms import nodes

CLAIM, ASSUMPTION, DEFINITION, RECALLED = "claim", "assumption", "definition", "recalled"
INTRODUCED = "introduced"
"""Given to the reader: a definition where it holds by what the words mean, else judged as it is."""
LAW = "law"
"""A law of the writer's own, see `eom.checker.judge.laws`: an assumption where it does not hold by
itself."""


@dataclass(frozen=True)
class Lead:
    """What words in front of a formula make of it.

    ``far``: nouns may stand between ("if the torque $M = 0$"); ``listed``: a comma alone goes on with
    the next formula ("let $a = 1$, $b = 2$"), not only "and", "or".
    """

    role: str
    far: bool = False
    listed: bool = False


_IF, _LET = Lead(ASSUMPTION, far=True), Lead(ASSUMPTION, far=True, listed=True)
_AT_ONCE, _WHERE = Lead(ASSUMPTION), Lead(DEFINITION, far=True, listed=True)
_NAMED, _SO = Lead(DEFINITION), Lead(CLAIM, far=True)
_SINCE = Lead(RECALLED, far=True, listed=True)
NO_LEAD = Lead(CLAIM)

LEADS: dict[str, Lead] = {
    **dict.fromkeys(("if", "iff", "when", "whenever", "unless", "once", "provided", "while"), _IF),
    **dict.fromkeys(("given that", "provided that", "as long as", "in case", "in the case"), _IF),
    **dict.fromkeys(("case with", "case of", "case where", "case that"), _IF),
    **dict.fromkeys(("assume", "assumes", "assumed", "assuming", "assumption", "suppose"), _LET),
    **dict.fromkeys(("let", "supposing", "hypothesis", "require", "impose", "demand"), _LET),
    **dict.fromkeys(("invoke", "evoke", "postulate", "approximation", "condition"), _LET),
    **dict.fromkeys(("for", "for all", "for any", "for every", "for each", "for some"), _AT_ONCE),
    **dict.fromkeys(("subject to", "under", "at", "setting"), _AT_ONCE),
    **dict.fromkeys(("valid for", "true for", "holds for", "case", "taking"), _AT_ONCE),
    **dict.fromkeys(("where", "define", "defining", "defined", "denote"), _WHERE),
    **dict.fromkeys(("denoting", "call", "calling", "label", "labelling", "labeling"), _WHERE),
    **dict.fromkeys(("write", "writing", "introduce", "introducing", "notation"), _WHERE),
    **dict.fromkeys(("abbreviate", "abbreviation", "shorthand", "definition"), _WHERE),
    **dict.fromkeys(("such that", "with"), _NAMED),
    **dict.fromkeys(("since", "because", "b/c", "as", "using", "noting", "noting that"), _SINCE),
    **dict.fromkeys(("note that", "recall", "recalling", "recall that", "knowing", "by"), _SINCE),
    **dict.fromkeys(("given by", "provided by", "defined by"), Lead(INTRODUCED)),
    **dict.fromkeys(("then", "so", "thus", "hence", "therefore", "have", "has", "get"), _SO),
    **dict.fromkeys(("obtain", "find", "gives", "yields", "implies", "follows", "becomes"), _SO),
    **dict.fromkeys(("reduces", "satisfy", "satisfies", "must", "show", "shows", "prove"), _SO),
    **dict.fromkeys(("for which", "whence", "which", "means", "conclude", "but", "that is"), _SO),
    **dict.fromkeys(("look at", "looking at", "arrive at", "arrives at", "arriving at"), _SO),
    **dict.fromkeys(("holds", "vanishes", "leads", "results", "equals", "follow", "need"), _SO),
}
"""The words that settle the role; those closest to the formula count, the longest of them."""

TRAILS: dict[str, str] = {
    **dict.fromkeys(("is assumed", "are assumed", "by assumption", "by hypothesis"), ASSUMPTION),
    **dict.fromkeys(("is used", "was used", "has been used"), RECALLED),
    **dict.fromkeys(("by definition", "is defined"), DEFINITION),
}
"""Words right behind a formula that settle its role where nothing in front does."""

CONDITIONS: dict[str, str] = {
    **dict.fromkeys(("if", "iff", "only if", "unless", "for", "exists"), ASSUMPTION),
    "where": DEFINITION,
    "because": RECALLED,
}
"""Roles of the parts of a formula, by the words inside it."""

_VERBS = frozenset("is are was were be does do can may acts moves rotates turns".split())
"""Words that make a clause of their own, unless the formula completes them ("the torque is $0$")."""
_FILLERS = frozenset("also now again just both either simply further that we the".split())
"""Words that put no distance between a lead and a formula."""
_NOUN, _RELATION = "\x00", "\x01"
"""What stands in a text for a formula without and with a relation."""
_JOINT = re.compile(
    rf"{_RELATION}\s*,?\s*(?:and also|and that|as well as|and|or|&)$", re.IGNORECASE
)
_COMMA = re.compile(rf"{_RELATION}\s*,$")
_EXAMPLE = re.compile(r"\(\s*(?:e\.?\s?g|i\.?\s?e|that is|for example|say)\b[.,]*$", re.IGNORECASE)
_RESTATED = re.compile(r"[(,]\s*in (?:which|this|that) case$", re.IGNORECASE)
_SENTENCE = re.compile(r"[.!?]\s+(?=[A-Z])|:\s")
_WORD = re.compile(r"[A-Za-z/&][A-Za-z/’'-]*|[^\s:A-Za-z]")
_RELATIONS = re.compile(
    r"[=<>≤≥≠≡≈]|\\(?:leq?|geq?|neq?|ll|gg|equiv|triangleq|approx|simeq|coloneqq|doteq)(?![A-Za-z])"
)
_REACH = 600
"""Characters in front of a formula that are looked at."""
_MOST = 6
"""Words that may stand between the lead and the formula."""


def roles(pieces: Sequence[Piece]) -> tuple[str, ...]:
    """Return the role of every piece: of formulas by the words around them, else "claim".

    A display is an assumption where the words right in front of it say so, and a claim otherwise.
    """
    found: list[str] = []
    text, above, lead, shown = "", "", NO_LEAD, NO_LEAD
    for k, piece in enumerate(pieces):
        found.append(CLAIM)
        if k and piece.source is not pieces[k - 1].source:
            text, above, shown = "", "", NO_LEAD
        if piece.kind == "prose":
            parts = re.split(r"\n[ \t]*\n", text + _plain(piece.body))
            text, above = parts[-1][-_REACH:], [above, *parts][-2][-_REACH:]
        elif piece.kind == "display":
            shown = _display((text.strip() or above.strip()), shown)
            found[-1], text, above = shown.role, "", ""
        elif piece.kind != "inline":
            text, above, shown = "", "", NO_LEAD
        elif _RELATIONS.search(piece.body):
            lead = _lead(text.strip(), lead)
            after = _plain(pieces[k + 1].body[:_REACH]) if k + 1 < len(pieces) else ""
            found[-1] = _trail(after) if lead is NO_LEAD else lead.role
            text = f"{text} {_RELATION} "[-_REACH:]
        else:
            text = f"{text} {_NOUN} "[-_REACH:]
    return tuple(found)


_AND = re.compile(r"(?:and(?: also| that)?|as well as|or|&)\s*:?$", re.IGNORECASE)
_ORDERED = frozenset("suppose assume let impose require postulate demand".split())
"""Verbs that a display may complete from afar: "suppose that the torque is"."""


def _display(text: str, last: Lead) -> Lead:
    """Return what the words in front of a display make of it; ``last``: of the display before.

    The lead has to be the last word but for fillers and nouns: what stands behind a colon, a comma or
    a verb is what follows from the words ("assuming principal axes, we have").
    """
    if _AND.fullmatch(text):
        return last
    words = [w.lower() for w in _WORD.findall(text.rstrip(" :"))]
    closed = text.endswith(":")
    distance = 0
    for end in range(len(words), 0, -1):
        lead = _ending(words[:end])
        if lead is not None:
            near = not distance or (lead.far and not closed and words[end - 1] in _ORDERED)
            return lead if near and lead.role == ASSUMPTION else NO_LEAD
        word = words[end - 1]
        clause = word in _VERBS and end < len(words)
        if clause or distance == _MOST or not (word[0].isalpha() or word == _NOUN):
            break
        distance += word not in _FILLERS
    return NO_LEAD


def _plain(text: str) -> str:
    """Return prose without marks of Markdown and delimiters of formulas."""
    return re.sub(r"<[^<>]*>|[*_$`{}\\]", " ", text)


def _lead(text: str, last: Lead) -> Lead:
    """Return what the words in front of a formula make of it; ``last``: of the formula before."""
    if _JOINT.search(text) or (last.listed and _COMMA.search(text)):
        return last
    for bracket in (_EXAMPLE, _RESTATED):
        match = bracket.search(text)
        if match:
            return _bracketed(text[: match.start()].rstrip(), bracket is _RESTATED)
    words = [w.lower() for w in _WORD.findall(text)]
    distance = 0
    for end in range(len(words), 0, -1):
        lead = _ending(words[:end])
        if lead is not None:
            return lead if lead.far or not distance else _SO
        word = words[end - 1]
        clause = word in _VERBS and end < len(words)
        if clause or distance == _MOST or not (word[0].isalpha() or word == _NOUN):
            break
        distance += word not in _FILLERS
    return NO_LEAD


def _ending(words: Sequence[str]) -> Lead | None:
    """Return the lead that words end with, the longest."""
    phrases = (" ".join(words[-n:]) for n in (3, 2, 1))
    return next((LEADS[p] for p in phrases if p in LEADS), None)


def _bracketed(before: str, restated: bool) -> Lead:
    """Return what a formula in brackets is, that gives an example or says again what stands before.

    It spells out a condition in words; behind a condition that is a formula "in which case" brings
    what follows from it.
    """
    if restated and before.endswith(_RELATION):
        return _SO
    sentence = _SENTENCE.split(before)[-1]
    if restated:
        sentence = re.split(r"[,;]", sentence)[-1]
    words = [w.lower() for w in _WORD.findall(sentence)]
    return _IF if any(_ending([w]) in {_IF, _LET} for w in words) else _SO


def _trail(after: str) -> str:
    """Return what the words behind a formula make of it."""
    start = " ".join(after.split()).lower()
    return next((role for words, role in TRAILS.items() if start.startswith(words)), CLAIM)


SETS = (("1", "2", "3"), ("x", "y", "z"))


def running(statements: Iterable[Statement]) -> str:
    """Return the letter that one of the statements of a formula lets run over the axes, or ""."""
    for statement in statements:
        for part in (statement, *(condition for _, condition in statement.conditions)):
            letter = listed(part)
            if letter:
                return letter
    return ""


def listed(part: Statement) -> str:
    """Return the letter that a statement lets run over the axes, or ""."""
    if len(part.members) == 2 and part.signs[0].name in {"=", "in"}:
        left, right = part.members
        inside = right.body if isinstance(right, Group) else right
        items = inside.items if isinstance(inside, Items) else ()
        return _over(left, items)
    if len(part.members) != 1 or not isinstance(part.members[0], Group):
        return ""
    body = part.members[0].body
    items = body.items if isinstance(body, Items) else ()
    first = items[0] if items else None
    if not isinstance(first, Relation) or [g.name for g in first.signs] != ["="]:
        return ""
    return _over(first.members[0], (first.members[1], *items[1:]))


def _over(left: Node, items: tuple[Node, ...]) -> str:
    """Return a letter that takes the values 1, 2, 3; dots may stand for what lies between."""
    if not isinstance(left, Symbol) or not all(
        isinstance(n, Number | Symbol | Dots) for n in items
    ):
        return ""
    words = tuple("".join(labels(n)) for n in items if not isinstance(n, Dots))
    dotted = any(isinstance(n, Dots) for n in items)
    shown = any(words == s or (dotted and words in {(s[0], s[2]), s}) for s in SETS)
    return left.name if shown else ""


def labelled(statement: Statement, letter: str) -> bool:
    """Return whether a letter is a label of a symbol in a statement."""
    looks = (seen(n) for m in statement.members for n in walk(m))
    return any(
        g is not None and (letter,) in {c[-1:] for c in (*g.look.corners, *map(labels, g.raised))}
        for g in looks
    )


_BRINGS = re.compile(r"\b(?:let|with (?:the|an?) [A-Za-z -]{2,40})\s*\$*$", re.IGNORECASE)
_GOES_ON = re.compile(r"^\s*\$*\s*,?\s*(?:and)?\s*\$*\s*$")


def brings(pieces: tuple[Piece, ...], number: int, role: str, last: bool) -> bool:
    """Return whether words bring in the left side of a formula: where, let, with the mass m = ...

    ``last``: whether they do so for the formula before, which "and" goes on with.
    """
    before = pieces[number - 1] if number else None
    if role == DEFINITION or before is None or before.kind != "prose":
        return role == DEFINITION
    text = " ".join(before.body.split())
    return bool(_BRINGS.search(text)) or (last and bool(_GOES_ON.match(text)))


_CASE = re.compile(r"\bin which case\W*$", re.IGNORECASE)


def in_a_case(pieces: tuple[Piece, ...], number: int) -> bool:
    """Return whether words say that a formula of the text holds in a special case: it defines nothing."""
    before = pieces[number - 1] if number else None
    inline = pieces[number].kind == "inline" and before is not None and before.kind == "prose"
    return inline and before is not None and _CASE.search(before.body) is not None


def first(statement: Statement, lexicon: Lexicon) -> Statement | None:
    """Return an equation as a definition of its left side; None if the lexicon knows that."""
    if not statement.members or [s.name for s in statement.signs] != ["="]:
        return None
    given = seen(statement.members[0])
    if given is None or given.raised or given.dots or lexicon.find(given.look) is not None:
        return None
    sign: Sign = replace(statement.signs[0], name=":=")
    return replace(statement, signs=(sign,))


def says(found: Iterable[Claim]) -> bool:
    """Return whether claims define something by quantities, not by numbers alone."""
    new = [c for c in found if c.defines is not None and c.members]
    atoms = (n for c in new for t in (c.members[0].term, *c.scalars.values()) for n in nodes(t))
    return any(n.head == "atom" for n in atoms)


@dataclass
class Named:
    """What words have brought in, each within its heading."""

    found: list[tuple[tuple[str, ...], Look, Value]] = field(default_factory=list)

    def at(self, headings: tuple[str, ...]) -> dict[Look, Value]:
        """Return what holds under some headings."""
        return {k: v for place, k, v in self.found if headings[: len(place)] == place}

    def add(self, headings: tuple[str, ...], claims: Iterable[Claim]) -> None:
        """Take in what claims define."""
        self.found += [(headings, look, value) for look, value in defined(claims).items()]


ENERGIES = {"T": "kinetic", "V": "potential", "L": "lagrang", "E": "energy"}
"""Letters that a system has for its energies, and how the words for these begin."""
_OTHERS = (
    "tension|period|torque|temperature|thrust|time|pull|force|couple|moment|momentum|length|speed|velocity"
    "|volume|voltage|inductance|modulus|duration|field"
)
_OF_IT = r"(?: (?:in|of|on|for|at|about)(?: \S+){1,3}?)?"
_BEFORE = re.compile(
    rf"\b(?:{_OTHERS}){_OF_IT}(?:,? (?:is|be|equals|reads|becomes|then))*\s*:?$", re.IGNORECASE
)
_BEHIND = re.compile(
    rf"(?:is |denotes |be |,)? ?(?:the|an?|its) (?:\w+ )?(?:{_OTHERS})\b", re.IGNORECASE
)


def otherwise_named(pieces: Sequence[Piece], number: int) -> bool:
    """Return whether the words beside a formula that begins with the letter of an energy name no energy."""
    letter = pieces[number].body.strip()[:1]
    before, behind = (
        " ".join(_plain(pieces[k].body).split()) if 0 <= k < len(pieces) else ""
        for k in (number - 1, number + 1)
    )
    near = before[-_REACH // 8 :]
    if letter not in ENERGIES or ENERGIES[letter] in near.lower():
        return False
    alone = len(pieces[number].body.strip()) == 1
    return bool(_BEFORE.search(near)) or (alone and bool(_BEHIND.match(behind)))


def unnamed(pieces: Iterable[Piece]) -> frozenset[str]:
    """Return the letters of energies that the words of a note name nowhere; none where it has no words."""
    words = " ".join(p.body for p in pieces if p.kind in {"prose", "heading"}).lower()
    return frozenset(k for k, begins in ENERGIES.items() if begins not in words)
