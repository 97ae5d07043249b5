r"""What sentences say of a system of bodies: its parts, how they hang together, what acts on them.

"The trolley rolls on a straight horizontal rail. A uniform beam of mass $m$ is hinged to it at one end."
Nouns become parts, verbs with their prepositions say what is joined to what (`Fact`), letters behind the
words for sizes belong to the part in front of them. The words are those of ``parts.toml``. A sentence that
says how parts are joined is to be understood to its last word: with one that is not known the system is not
read at all, or is as told before where that brings in no other part.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files
from itertools import pairwise

from eom.checker.infer.sayings import LIST, Prose
from eom.checker.infer.systems import Spoken
from eom.checker.read.documents import Document
from eom.checker.read.symbol_shape import Look

MOVING = frozenset({"point", "rod", "round", "pendulum"})
"""Kinds of parts that have a mass, but for light rods."""
MAX_SENTENCE = 1000
"""Characters of sentences that are read."""
GROUND = "ground"
"""What does not move, as the end of a joint or spring."""


@dataclass(frozen=True)
class Thing:
    """A part: its kind, its noun, which of several it is, and the adjectives that stand with it."""

    kind: str
    noun: str
    number: str = ""
    adjectives: frozenset[str] = frozenset()

    @property
    def key(self) -> str:
        """What tells parts apart."""
        return f"{self.noun}{'_' * bool(self.number)}{self.number}".replace(" ", "_")

    @property
    def light(self) -> bool:
        """Whether it has no mass."""
        return bool(self.adjectives & {"light", "massless", "weightless"})


@dataclass(frozen=True)
class Size:
    """A letter with the quantity of a part; no letter where the note writes a formula."""

    of: str
    quantity: str
    look: Look | None
    words: str
    line: int


@dataclass(frozen=True)
class Fact:
    """What parts do: a class of verbs, and their objects with the prepositions before them."""

    subjects: tuple[str, ...]
    verb: str
    objects: tuple[tuple[str, str], ...]
    words: str

    def to(self, *prepositions: str) -> tuple[str, ...]:
        """Return the objects behind some prepositions, of all without."""
        return tuple(o for p, o in self.objects if not prepositions or p in prepositions)


@dataclass(frozen=True)
class Setup:
    """The parts of a system with their sizes, and what is said of them.

    ``words``: the sentences that say so, ``lines``: where they stand; ``text``: all that was read;
    ``until``: the line from which on the system is another one, 0 for none.
    """

    things: Mapping[str, Thing]
    sizes: tuple[Size, ...]
    facts: tuple[Fact, ...]
    words: str
    text: str = ""
    lines: tuple[int, ...] = ()
    until: int = 0

    def size(self, key: str, quantity: str) -> Size | None:
        """Return the letter of a quantity of a part."""
        return next((s for s in self.sizes if (s.of, s.quantity) == (key, quantity)), None)


@cache
def vocabulary() -> Mapping[str, Mapping[str, str]]:
    """Return the words."""
    return tomllib.loads((files(__package__) / "parts.toml").read_text(encoding="utf-8"))


@cache
def _plain() -> frozenset[str]:
    words = vocabulary()
    return frozenset((*words["plain"]["words"].split(), *words["adjectives"]["words"].split("|")))


@cache
def _verbs() -> Mapping[str, str]:
    return {w: verb for verb, words in vocabulary()["verbs"].items() for w in words.split("|")}


@cache
def _noun() -> re.Pattern[str]:
    words = vocabulary()
    kinds = "|".join(f"(?P<{k}>{w})" for k, w in words["things"].items())
    adjectives = words["adjectives"]["words"]
    return re.compile(
        rf"\b(?:(?P<det>an?|the|two|both|each|its|one|another|this|that|every|"
        rf"three|four|five|six|several|many|some|all|n)\s+)?"
        rf"(?P<adj>(?:(?:{adjectives})(?:\s*,\s*|\s+(?:and\s+)?)){{0,5}})"
        rf"(?:(?P<ord>first|second|upper|lower|left|right|other)\s+)?"
        rf"(?P<adj2>(?:(?:{adjectives})\s+){{0,3}})"
        rf"(?:{kinds})(?P<plural>e?s)?\b(?:\s+(?P<num>[12])\b)?",
        re.IGNORECASE,
    )


_ORDINALS = {"first": "1", "upper": "1", "left": "1", "second": "2", "lower": "2", "right": "2",
             "other": "2"}  # fmt: skip
_MANY = frozenset({"three", "four", "five", "six", "several", "many", "some", "n"})
_NO_MASS = re.compile(
    r"(?:\b(?:of|with|has|have|whose|and|is|its|total|reduced)(?: an?| the)?|,|\()\s*$"
)
"""Words before "mass" where it is a quantity and no part."""
TOKEN = re.compile(r"«(\w+)»")


@dataclass
class Reading:
    """The parts of a text while it is read."""

    things: dict[str, Thing] = field(default_factory=dict)
    sizes: list[Size] = field(default_factory=list)
    many: bool = False

    def marked(self, sentence: str) -> str:
        """Return a sentence in which parts are marks with their keys."""
        return _noun().sub(lambda m: self._thing(m, sentence), sentence)

    def _thing(self, match: re.Match[str], sentence: str) -> str:
        kind = next(k for k in vocabulary()["things"] if match[k])
        noun = re.sub(r"\s+", " ", match[kind].lower())
        noun = {"disk": "disc", "masse": "mass"}.get(noun, noun)
        before, behind = sentence[: match.start()], sentence[match.end() :]
        if noun == "mass" and not _is_part(before, match["det"], behind):
            return match[0]
        if (
            noun == "plane"
            and "inclined" not in match["adj"].lower()
            and not re.match(r"\s+(?:inclined|of inclination|with the inclination)", behind)
        ):
            return match[0]
        if noun in {"point", "line"} and match["det"] is None:
            return match[0]
        if kind == "line" and re.match(r"\s+(?:angle|of\s+⟦)", behind):
            return match[0]
        adjectives = frozenset(re.findall(r"[\w-]+", f"{match['adj']} {match['adj2']}".lower())) - {
            "and"
        }
        self.many = self.many or (match["det"] or "").lower() in _MANY
        two = (match["det"] or "").lower() in {"two", "both"} and match["plural"]
        one = match["num"] or _ORDINALS.get((match["ord"] or "").lower(), "")
        letters = re.match(rf"\s+(?P<of>of mass(?:es)?\s+)?({LIST})", behind)
        several = letters[2].count("⟦") if letters and match["plural"] else 2 if two else 1
        known = [t.number for t in self.things.values() if t.noun == noun]
        if match["plural"] and len(known) > 1:
            numbers = known
        elif (match["det"] or "").lower() == "another" and known:
            numbers = ["2"]
        else:
            numbers = [str(k + 1) for k in range(several)] if several > 1 else [one]
        keys = [self._add(Thing(kind, noun, n, adjectives)) for n in numbers]
        mass = " of mass" if noun == "mass" and letters and not letters["of"] else ""
        return f" {' and '.join(f'«{k}»' for k in keys)}{mass} "

    def _add(self, thing: Thing) -> str:
        several = [t for t in self.things.values() if t.noun == thing.noun]
        first = next((t for t in several if t.number in {"", "1"}), None)
        if len(several) == 1 and not thing.number:
            first = several[0]
        if first is not None and thing.number in {"", "1"}:
            thing = replace(thing, number=first.number)
        known = self.things.get(thing.key)
        if known is not None:
            thing = replace(known, adjectives=known.adjectives | thing.adjectives)
        self.things[thing.key] = thing
        return thing.key


def _is_part(before: str, det: str | None, behind: str) -> bool:
    """Return whether "mass" is the noun of a part: "a mass m hangs", no "of mass m", "mass of the rod"."""
    if _NO_MASS.search(before) or re.match(r"\s*(?:of|centre|center|per|matrix)\b", behind):
        return False
    return det is not None or not before.strip() or before.rstrip()[-1] in ".;:"


# -- sizes ---------------------------------------------------------------------------------------


@cache
def _size() -> re.Pattern[str]:
    words = "|".join(f"(?P<{k}>{w[0]})" for k, w in vocabulary()["sizes"].items())
    return re.compile(
        rf"(?:\b(?:of|with|has|have|whose|and|its|by|under|at|the)\s+|,\s*|\(\s*){{0,4}}"
        rf"(?:an?\s+|the\s+|its\s+|equal\s+|horizontal\s+|constant\s+){{0,4}}\b"
        rf"(?:{words})(?:\s+(?:is|are|of|=))?\s+(?P<of>{LIST}|…)",
        re.IGNORECASE,
    )


_NUMBERED = re.compile(r"[\s,]*\)")


_ON = re.compile(r"[^«;.]*?\b(?:on|to|upon|pushes|pulls|drives|turns)\s+«(\w+)»")
"""What stands behind a force up to the part on which it acts."""


def sized(sentence: str, text: Prose, reading: Reading, line: int, last: str) -> str:
    """Return a sentence without the letters of sizes, which are noted."""

    def found(match: re.Match[str]) -> str:
        quantity = next(k for k in vocabulary()["sizes"] if match[k])
        owners = TOKEN.findall(sentence[: match.start()])
        own = _owners(sentence[: match.start()], owners) or ([last] if last else [""])
        pushed = _ON.match(sentence[match.end() :])
        if quantity in {"force", "torque"} and pushed is not None:
            own = [pushed[1]]
        mentions = text.marked(match["of"])
        looks: list[Look | None] = [m.look for m in mentions] or [None]
        if len(looks) == 1 < len(own):
            looks *= len(own)
        own = own if len(own) == len(looks) else own[-1:] * len(looks)
        where = mentions[0].line if mentions else line
        words = text.shown(TOKEN.sub(r"\1", match[0]))
        reading.sizes += [
            Size(o, quantity, k, words, where) for o, k in zip(own, looks, strict=True)
        ]
        return " "

    def moved(match: re.Match[str]) -> str:
        (mention,) = text.marked(match["by"])
        way = (
            "upwards"
            if match["way"].lower() in {"vertically", "up and down", "upwards"}
            else "sideways"
        )
        words = text.shown(TOKEN.sub(r"\1", match[0]))
        reading.sizes.append(Size(match["of"], way, mention.look, words, mention.line))
        return f" «{match['of']}» "

    return _NUMBERED.sub(" ", _size().sub(found, _MOTION.sub(moved, sentence)))


_MOTION = re.compile(
    r"«(?P<of>\w+)»\s+(?:is\s+|can\s+be\s+)?(?:moves?|moved|driven|displaced|oscillates?)\s+"
    r"(?P<way>horizontally|vertically|up and down|upwards|sideways)\s+"
    r"(?:by|as|with|according to|through)\s+"
    r"(?:(?:the|a|given|displacement|amount|distance|height)\s+){0,4}(?P<by>⟦\d+⟧)",
    re.IGNORECASE,
)
"""A given motion of a support, with its letter."""


def _owners(before: str, owners: Sequence[str]) -> list[str]:
    """Return whose size it is: the part before, or both of two that stand together."""
    pair = re.search(r"«(\w+)» and «(\w+)»[^«»]*$", before)
    return [pair[1], pair[2]] if pair else list(owners[-1:])


def told(said: Iterable[Spoken], reading: Reading) -> Iterator[Size]:
    """Yield sizes that words give of letters: "$m$ is the mass of the beam"."""
    for one in said:
        if not one.told or len(one.words) > MAX_SENTENCE:
            continue
        match = _told().match(one.words)
        if match is not None and not _RATIO.match(match["behind"]):
            quantity = next(k for k in vocabulary()["sizes"] if match[k])
            seen = Reading(dict(reading.things))
            owners = TOKEN.findall(seen.marked(match["behind"]) + seen.marked(one.words))
            own = next((o for o in owners if o in reading.things), "")
            yield Size(own, quantity, one.look, one.words, one.line)


_RATIO = re.compile(r"\s*(?:ratio|centre|center|matrix|per|density|flow|of gyration|arm)\b")
"""Words behind the noun of a size that make it another one."""


@cache
def _told() -> re.Pattern[str]:
    words = "|".join(f"(?P<{k}>{w[0]})" for k, w in vocabulary()["sizes"].items())
    return re.compile(
        rf"(?:(?:is|are|the|an?|its|their|horizontal|vertical|external|constant|\w+’s|\w+'s|[a-z]+)\s+){{0,3}}?"
        rf"(?:{words})\b(?P<behind>.*)",
        re.IGNORECASE | re.DOTALL,
    )


# -- facts ---------------------------------------------------------------------------------------

_PREPOSITIONS = frozenset(
    "on along upon over down up in inside from to at about by with between around of onto through against "
    "under and into".split()
)
_WORD = re.compile(r"«\w+»|⟦\d+⟧|…|[a-z][\w’'-]*|[.,;:()]", re.IGNORECASE)


@dataclass
class _Clause:
    """A sentence while its facts are found."""

    sentence: str
    things: Mapping[str, Thing]
    moving: list[str] = field(default_factory=list)
    subjects: list[str] = field(default_factory=list)
    verb: str = ""
    objects: list[tuple[str, str]] = field(default_factory=list)
    found: list[Fact] = field(default_factory=list)
    unknown: list[str] = field(default_factory=list)
    preposition: str = ""
    last: str = ""
    previous: str = ""

    def close(self) -> None:
        """End what a verb says."""
        if self.verb and self.verb != "is" and self.subjects:
            fact = Fact(tuple(self.subjects), self.verb, tuple(self.objects), self.sentence)
            self.found.append(fact)
        self.verb, self.objects, self.preposition = "", [], ""

    def thing(self, key: str) -> None:
        """Take a part: a subject before a verb, an object behind it."""
        if not self.verb and self.preposition in {"", "and"}:
            self.subjects = [*(self.subjects if self.preposition == "and" else ()), key]
        else:
            self.objects.append((self._preposition(), key))
        self.last, self.preposition = key, ""
        if self.things[key].kind in MOVING:
            self.moving.append(key)

    @property
    def it(self) -> str:
        """The part that "it" means: the subject, behind a verb the part with a mass named last besides."""
        others = [k for k in self.moving if not (self.verb and k in self.subjects)]
        return next(reversed(others), "")

    def _preposition(self) -> str:
        if self.preposition == "and" and self.objects:
            return self.objects[-1][0]
        return self.preposition


def facts(sentence: str, before: str, things: Mapping[str, Thing]) -> tuple[list[Fact], list[str]]:
    """Return what a sentence of marked parts says, and the words in it that are not known.

    ``before``: the part that "it" means at its beginning.
    """
    clause = _Clause(sentence, things, [before] * bool(before), [before] * bool(before))
    for word, behind in pairwise([*_WORD.findall(sentence), ""]):
        token = TOKEN.fullmatch(behind)
        if token is None or things[token[1]].kind != "place" or _known(word):
            _step(clause, word)
    clause.close()
    return clause.found, clause.unknown


def _known(word: str) -> bool:
    """Return whether a word is no mere attribute of a place: "the runway stop"."""
    return not word.isalpha() or word.lower() in {
        *_verbs(),
        *_PREPOSITIONS,
        *_plain(),
        "it",
        "which",
    }


def _step(c: _Clause, word: str) -> None:
    plain, token = word.lower(), TOKEN.fullmatch(word)
    verb = None if c.previous in _ARTICLES else _verbs().get(plain)
    if token is not None:
        c.thing(token[1])
    elif _structural(c, plain):
        pass
    elif verb is not None:
        _verb(c, verb)
    elif plain in {"end", "ends"}:
        c.objects.append((c.preposition, plain))
        c.preposition = ""
    elif plain in _PREPOSITIONS:
        c.preposition = plain
    elif word.startswith("⟦") or word == "…":
        c.preposition = ""
    elif plain not in _plain() and plain not in "().":
        c.unknown.append(plain)
    c.previous = plain


_ARTICLES = frozenset({"a", "an", "the", "its", "this", "that"})
"""Words behind which a participle is an adjective: "a fixed end"."""


def _structural(c: _Clause, plain: str) -> bool:
    """Take what parts a sentence, and what stands for parts; return whether a word is such."""
    if plain in {"which", "that", "who"} and c.last:
        c.close()
        c.subjects = [c.last]
    elif plain in {".", ";", ":"}:
        c.close()
        c.subjects = c.subjects[:1]
    elif plain == ",":
        c.preposition = ""
    elif c.it and (plain == "it" or (plain in {"centre", "center"} and c.previous == "its")):
        c.thing(c.it)
    else:
        return False
    return True


def _verb(c: _Clause, verb: str) -> None:
    if c.verb not in {"", "is"} and verb != "is":
        c.close()
    if verb != "is" or not c.verb:
        c.verb = verb
    c.preposition = ""


# -- setups --------------------------------------------------------------------------------------

_NOT = r"(?:no|without|free of|negligible|neglect\w*|ignor\w+|frictionless|absence of|zero)"


def foreign(words: str) -> str:
    """Return a word of what no composition knows, "" for none; what is absent is not said to be there."""
    table = vocabulary()
    match = re.search(table["foreign"]["words"], words, re.IGNORECASE)
    if match is not None:
        return match[0]
    for found in re.finditer(table["drag"]["words"], words, re.IGNORECASE):
        before, behind = words[: found.start()][-60:], words[found.end() :][:60]
        absent = re.search(rf"\b{_NOT}\b[^.;]*$", before, re.IGNORECASE)
        absent = absent or re.match(
            r"[^.;]*\b(?:neglect\w*|negligible|ignored|left out|absent|vanish\w*)", behind
        )
        known = re.search(r"\b(?:viscous|coefficient of(?: \w+)?)\s*$", before, re.IGNORECASE)
        known = known or re.match(r"\s*coefficient", behind)
        if not absent and not known and not re.search(r"\bviscous\b", words):
            return found[0]
    return ""


def setup(text: Prose, document: Document, said: Sequence[Spoken]) -> Setup | None:
    """Return the system that sentences describe, None where they describe none that is understood."""
    reading, every, used = Reading(), list[Fact](), list[str]()
    last, until, shown = "", 0, list[str]()
    for sentence in (s for s in text.sentences if len(s) <= MAX_SENTENCE):
        if every and re.search(vocabulary()["changes"]["words"], sentence, re.IGNORECASE):
            until = _line(sentence, text, document)
            break
        shown.append(sentence)
        known = dict(reading.things)
        marked = reading.marked(re.sub("[«»]", '"', sentence))
        line = next((m.line for m in text.marked(sentence)), 0)
        clean = sized(marked, text, reading, line, last)
        found, unknown = facts(clean, last, reading.things)
        if not _CASE.match(sentence) and any(_moved(f, reading.things) for f in found):
            return None
        found = [f for f in found if _joins(f, reading.things)]
        if _CASE.match(sentence) or "|" in sentence or not _joined(found, reading.things):
            found = []
        last = next(iter(TOKEN.findall(clean)), last)
        if found and (unknown or reading.many):
            if _new(reading, known) or not every:
                return None
            reading.things, until = known, _line(sentence, text, document)
            break
        if not found:
            reading.things = {
                k: t for k, t in reading.things.items() if k in known or _sized(k, reading)
            }
        last = last if last in reading.things else ""
        every += found
        used += [sentence] if found else []
    if not every or foreign(". ".join(map(text.shown, shown))):
        return None
    sizes = (*reading.sizes, *told(said, reading))
    lines = [n for n in (_line(s, text, document) for s in used) if n]
    words = ". ".join(map(text.shown, used))
    whole = ". ".join(map(text.shown, shown))
    return Setup(
        reading.things, tuple(sizes), tuple(every), words, whole, tuple(sorted(lines)), until
    )


def _new(reading: Reading, known: Mapping[str, Thing]) -> bool:
    """Return whether a sentence brings in parts, or more of them than are counted."""
    return reading.many or not reading.things.keys() <= known.keys()


_CASE = re.compile(
    rf"{LIST}\s+(?:is|are|denotes?|be)\b|[\W\d]*(?:if|when|where|for|as|in the case|suppose|imagine|at the|"
    r"right|after|until|because|compare)\b",
    re.IGNORECASE,
)
"""Beginnings of sentences about letters or cases, not about how parts of a system are joined."""


def _moved(fact: Fact, things: Mapping[str, Thing]) -> bool:
    """Return whether something moves that is fixed in all systems that are read."""
    kinds = {things[k].kind for k in fact.subjects if k in things}
    guides = fact.verb == "turn" and kinds == {"line"}
    return (
        kinds <= {"place", "line"} and fact.verb in {"slide", "roll", "turn", "hang"} and not guides
    )


def _joined(found: Sequence[Fact], things: Mapping[str, Thing]) -> bool:
    """Return whether sentences are about the parts of a system, not about forces of what is fixed alone."""
    fixed = (
        {"place", "line"} >= {things[s].kind for s in f.subjects if s in things} for f in found
    )
    return not all(f.verb == "act" and still for f, still in zip(found, fixed, strict=True))


def _sized(key: str, reading: Reading) -> bool:
    return any(s.of == key for s in reading.sizes)


def _joins(fact: Fact, things: Mapping[str, Thing]) -> bool:
    """Return whether a fact says how a part is joined or guided, or what acts on it."""
    kinds = {things[k].kind for k in (*fact.subjects, *fact.to()) if k in things}
    return bool(kinds - {"place"}) and bool(fact.to())


def _line(sentence: str, text: Prose, document: Document) -> int:
    """Return the line of a sentence."""
    marks = text.marked(sentence)
    plain = max(re.split(r"⟦\d+⟧|…|\W{2,}", sentence), key=len).strip()[:40]
    for piece in document.pieces:
        body = re.sub(r"\s", " ", piece.body)
        at = body.find(plain) if piece.kind == "prose" and plain else -1
        if at >= 0:
            return piece.source.line_column(piece.span.start + at)[0]
    return marks[0].line if marks else 0
