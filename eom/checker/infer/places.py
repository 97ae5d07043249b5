r"""Frames and points of a note by its words: which is inertial, which turns with the body, which is what.

Labels go to names of the house: frames ``I`` and ``B``, then ``A``, ``C``, ``D``, ``E`` for others; points
``C`` (centre of mass), ``O`` (reference), ``OI`` (inertial origin), ``OA``, ``OB`` (in the body), ``P``.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

from eom.checker.infer.sayings import CASE, MARKED, Mention, Prose, Said
from eom.checker.read.symbol_shape import Labels, Look

OTHERS = {
    "I": ("E",),
    "B": ("A", "C", "D"),
    "OA": ("OB",),
    "O": ("OA", "OB"),
    "OI": ("O",),
    "C": (),
    "P": (),
}
"""What a second frame or point is called of which words say what they say of a first."""
_FRAME = re.compile(r"\bframes?\b|\btriad|\baxes\b|observer|\breference\b|vectri", re.IGNORECASE)
_POINT = re.compile(
    r"\bpoints?\b|\borigin\b|\bcent(?:re|er)(?: of (?:mass|gravity))?\b|\bpivot\b|\bparticle\b|\bc\.m\.",
    re.IGNORECASE,
)


@cache
def tables() -> Mapping[str, Any]:
    """Return the tables of phrases and places."""
    return tomllib.loads((files(__package__) / "phrases.toml").read_text(encoding="utf-8"))


@dataclass
class Places:
    """Names of the house by labels of the note, with the words that say so."""

    frames: dict[Labels, str] = field(default_factory=dict)
    points: dict[Labels, str] = field(default_factory=dict)
    words: dict[tuple[str, Labels], tuple[str, int]] = field(default_factory=dict)

    def add(self, table: str, mention: Mention, name: str, words: str) -> None:
        """Give a label a name, or the next one of the kind if that is taken; the first words count."""
        names: dict[Labels, str] = getattr(self, table)
        label = as_label(mention.look)
        if label in names:
            return
        taken = set(names.values())
        free = next((n for n in (name, *OTHERS.get(name, ())) if n not in taken), None)
        if free is not None:
            below = mention.look.sub if mention.look.style == "calligraphic" else ()
            for one in (label, *((below,) if len(below) == 1 and below not in names else ())):
                names[one] = free
                self.words[table, one] = (words, mention.line)


def as_label(look: Look) -> Labels:
    """Return the words by which labels name what looks like this."""
    shaped = {"calligraphic": "cal ", "blackboard": "bb ", "fraktur": "frak "}
    below, above = "".join(look.sub), "".join(look.sup)
    tail = (f"_{below}" if below else "") + (f"^{above}" if above else "")
    return (shaped.get(look.style, "") + look.name + tail,)


def places(text: Prose, sayings: Iterable[Said], looks: Iterable[Look] = ()) -> Places:
    """Return the frames and points that the words of a note name.

    What is called a frame or a point anywhere is one; all that is said of it counts, the plainest first.
    ``looks``: the symbols of its displays; a point that no label of them names only stands for any
    ("for points $X$ and $Y$").
    """
    named = {name for look in looks for c in look.corners for name in c}
    found = Places()
    every = [
        (m, s)
        for s in sayings
        for m in (s.of if not s.before or _SEVERAL.search(s.words) else s.of[:1])
        if _plain(m.look) and (_CENTRE.search(s.words[-40:]) or not CASE.search(s.sentence))
    ]
    for table, kind in (("frames", _FRAME), ("points", _POINT)):
        called = dict.fromkeys(as_label(m.look) for m, s in every if _is(s, kind))
        rows = tables()["places"][table]
        chosen = []
        for label in called:
            if table == "points" and named and _placeholder(label, named):
                continue
            here = [(m, s) for m, s in every if as_label(m.look) == label]
            said = [(k, m, s) for m, s in here if (k := _first(rows, _near(s, table))) is not None]
            drawn = table == "points" and here[0][0].look.style
            if said and label not in found.frames and not drawn:
                chosen.append(said[0])
        for k, mention, one in sorted(chosen, key=lambda c: c[0]):
            name = rows[k][1]
            pair = (
                table == "points" and name == "O" and len(one.of) > 1 and _WELDED.search(one.words)
            )
            found.add(table, mention, "OA" if pair else name, text.shown(one.words))
        for mention, one in every:
            default = _usual(table, mention.look)
            if table == "frames" and default in named and not _called(mention.look, default):
                default = next(iter(OTHERS.get(default, ())), default)
            drawn = table == "points" and mention.look.style
            label = as_label(mention.look)
            if table == "points" and named and _placeholder(label, named):
                continue
            if _is(one, kind) and label not in found.frames and not drawn:
                found.add(table, mention, default, f"{text.shown(one.words)}; {WHICH}")
    return found


_CENTRE = re.compile(r"\b(?:mass cent(?:re|er)|cent(?:re|er) of (?:mass|gravity))(?: of \w+ \w+)?$")
"""Words of a point that is what they say in every case."""
_SEVERAL = re.compile(r"(?:(?<!mas)s|vertices)(?: \w+)?$")
_WELDED = re.compile(r"fixed (?:both )?(?:in|to)|welded|attached|of the body")
"""Words of points of a body: of two neither is the one about which things are taken."""


def _placeholder(label: Labels, named: set[str]) -> bool:
    """Return whether a capital letter names no point in any symbol of the displays."""
    return label[0] in "UVWXYZ" and label[0] not in named


USUAL = {
    "frames": {"b": "B", "B": "B", "body": "B", "i": "I", "I": "I", "N": "I", "n": "I", "0": "I"},
    "points": {"C": "C", "G": "C", "S": "C", "O": "O", "bullet": "C"},
}
"""What labels name by custom, where nothing else says so."""


WHICH = "which one it is, by custom"
"""What is told of a frame or point of which words say no more than that it is one."""


def _called(look: Look, name: str) -> bool:
    """Return whether a label has a letter in it: what has another one is not what that stands for."""
    return name in re.split(r"[ _^]", as_label(look)[0])


def _usual(table: str, look: Look) -> str:
    """Return what a frame or point is by its letter, of which words say no more than that it is one."""
    name = look.name if table == "frames" else ""
    return USUAL[table].get(name, {"frames": "B", "points": "O"}[table])


_BEHIND = re.compile(
    r"(?:that is |which is |is |both )*(?:fixed|attached|held|moving|which moves|that moves)"
)


def _is(one: Said, kind: re.Pattern[str]) -> bool:
    """Return whether words call what they are said of a frame, or a point."""
    if one.before:
        return re.search(rf"(?:{kind.pattern})(?: is| be)?$", one.words, re.IGNORECASE) is not None
    return kind.search(_near(one, "")) is not None and _QUANTITY.match(one.words) is None


_NAME = re.compile(r"[A-Z](?:\^(?:\W|ast|star|prime)+|_\w)?|[A-Z]_[A-Za-z]+|\d")
"""What frames and points are called: capitals, with a mark or a letter below."""


def _plain(look: Look) -> bool:
    shaped = look.style in {"calligraphic", "fraktur", "blackboard"}
    name = as_label(look)[0].split(" ")[-1]
    called = _NAME.fullmatch(name) is not None and (shaped or look.name not in "IJ" or not look.sub)
    return not look.accents and (shaped or not look.style) and called


_QUANTITY = re.compile(
    r"(?:the |an? |its )*(?:\w+ )?(?:angular|velocity|position|momentum|moment|torque|force|inertia|"
    r"acceleration|vector|mass of|unit|kinetic|rate|matrix|components?|distance|rotation|time)\b",
    re.IGNORECASE,
)


def _near(one: Said, table: str) -> str:
    """Return the words that are about the symbol itself: the last ones before it, the first behind it."""
    if one.before:
        behind = one.behind if _BEHIND.match(one.behind) else ""
        return " ".join(one.words.split()[-(5 if table == "frames" else 3) :]) + " " + behind
    ends = r"[,;(]| whose | with | and " + (r"" if table == "points" else "| that | which ")
    return re.split(ends, one.words)[0]


def _first(rows: Sequence[Sequence[str]], words: str) -> int | None:
    """Return the number of the first row that fits words."""
    fits = (k for k, (p, _) in enumerate(rows) if re.search(p, words, re.IGNORECASE))
    return next(fits, None)


_CALLED_MARK = re.compile(
    r"\b(?:an?|the|small|open|over|raised)\s+(?P<mark>prime|circle|ring|bullet|star|asterisk)\b[^.;]*?"
    r"(?:derivative|rate of change|the one|differentiat)(?P<what>[^.;]*)",
    re.IGNORECASE,
)
"""A mark in words, and what is said of the derivative that it is."""
DOT = "dot"
"""The mark that the notation of a lexicon explains."""
_CALLED_DOT = re.compile(
    r"\b(?:over)?dots?\b(?! product)[^.;,]*?(?:derivative|rate of change|differentiat)(?P<what>[^.;,]*)",
    re.IGNORECASE,
)
_SIGNS = {
    "prime": ("prime",),
    "circle": ("circ", "ring"),
    "ring": ("circ", "ring"),
    "bullet": ("bullet",),
}
_SEEN = re.compile(
    r"(?:relative to|with respect to|\bin|\bfrom|\bby)\s+(?:the |frame |an? |[a-z]+ (?=frame))*"
    r"(⟦\d+⟧|body|moving|rotating|inertial|space|fixed)"
)


def marks(text: Prose, found: Places) -> Iterator[tuple[str, str, str, int]]:
    """Yield the dot and raised marks that words call derivatives: mark, frame, words, line."""
    for sentence in text.sentences:
        match = _CALLED_MARK.search(sentence)
        frames = _seen(text, found, match["what"]) if match is not None else []
        for mark in _SIGNS.get(match["mark"].lower(), ()) if match is not None and frames else ():
            yield mark, frames[0], text.shown(sentence)[-70:], 0
        dotted = _CALLED_DOT.search(sentence)
        frames = _seen(text, found, dotted["what"]) if dotted is not None else []
        if frames:
            yield DOT, frames[0], text.shown(sentence)[-70:], 0
        of = [m for m in text.marked(sentence) if m.look.name == MARKED]
        frames = _seen(text, found, sentence) if of and "derivative" in sentence else []
        for mention, frame in zip(of, frames, strict=False):
            yield mention.look.sup[0], frame, text.shown(sentence)[-70:], mention.line


def _seen(text: Prose, found: Places, words: str) -> list[str]:
    """Return the frames in which derivatives are seen, in order."""
    named = []
    for match in _SEEN.finditer(words):
        if match[1].startswith("⟦"):
            label = as_label(text.marked(match[1])[0].look)
            bare = USUAL["frames"].get(label[0].removeprefix("cal "), "")
            named.append(found.frames.get(label, bare))
        else:
            named.append("B" if match[1] in {"body", "moving", "rotating"} else "I")
    return [n for n in named if n]
