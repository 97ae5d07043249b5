r"""What parts of a note say of its symbols otherwise than the whole: "here $r$ is the position of $dm$".

A part is a heading with what stands below it. What it says of a symbol goes before what the note says
elsewhere, there and in the parts behind it, until one says something else. A heading that names whose
mechanics follows ("a point mass", "a system of particles", "the rigid body") makes the quantities of the
note those of that.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from eom.checker.infer.letters import FORMULA, solved
from eom.checker.infer.phrases import OF_ONE, Phrases, fitting, slotted
from eom.checker.infer.places import places
from eom.checker.infer.sayings import look_of, said
from eom.checker.infer.trials import Part, parts
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import lexicon_of
from eom.checker.read.documents import Document
from eom.checker.read.grammar import read_formula
from eom.checker.read.symbol_shape import Look
from eom.checker.read.writing import latex_of

_TITLES = (
    (
        r"\b(?:systems?|collections?|sets?) of (?:\w+ )?(?:particles|point masses|masses)|\bparticles\b",
        "system",
    ),
    (r"\bparticle\b|\bpoint mass\b|\bmass point\b", "P"),
    (r"\brigid bod(?:y|ies)\b", "body"),
)
"""Words of a heading, and whose mechanics stands below it."""
TITLE = "as the heading says whose it is"


@dataclass(frozen=True)
class Own:
    """A meaning that a part gives a symbol: pattern, meaning, the words that say so, their line."""

    latex: str
    means: str
    words: str
    line: int


def sections(
    document: Document, body: str, lexicon: Lexicon, reads: Callable[[str, str], bool]
) -> Iterator[tuple[str, tuple[Own, ...]]]:
    """Yield headings with what symbols mean below them, where that is not what they mean elsewhere.

    ``body``: whose mechanics the note is about; ``lexicon``: what the whole note says; ``reads``: whether
    a lexicon takes a pattern with a meaning.
    """
    found = [p for p in parts(document) if len(p.document.pieces) < len(document.pieces) - 1]
    titles = [p.headings[0] for p in found]
    earlier: dict[str, Own] = {}
    whose = body
    for part in found:
        if titles.count(part.headings[0]) > 1:
            continue
        new = _whose(part.headings[0]) or whose
        if new != whose:
            earlier = {k: o for k, o in earlier.items() if whose not in o.means.split()}
        whose = new
        spoken = {o.latex: o for o in _said(part, whose, lexicon) if reads(o.latex, o.means)}
        turned = {
            o.latex: o for o in _turned(part, body, whose, lexicon) if reads(o.latex, o.means)
        }
        shifted = {o.latex: o for o in _shifted(part, lexicon) if reads(o.latex, o.means)}
        every = {**turned, **earlier, **spoken, **shifted}
        earlier = {k: o for k, o in every.items() if _differs(o, _known(lexicon, k))}
        own = tuple(o for o in earlier.values() if _stands(o, part))
        if own:
            yield part.headings[0], own


def _differs(own: Own, known: str) -> bool:
    """Return whether a part says something else; a quantity of the note's system stays what it is.

    Words that leave open in which frame a vector has components say no less.
    """
    same = own.means in {known, known.split(" in ", maxsplit=1)[0]}
    return not same and not known.startswith("system ")


def _whose(title: str) -> str:
    """Return whose mechanics a heading names, nothing if it names none."""
    return next((b for words, b in _TITLES if re.search(words, title, re.IGNORECASE)), "")


def _said(part: Part, whose: str, lexicon: Lexicon) -> Iterator[Own]:
    """Yield what the words of a part give its symbols, what they say first in front.

    Its frames are called as in the whole note.
    """
    sayings = tuple(said(part.text))
    found = places(part.text, sayings, part.looks[0])
    found.frames.update({k: n for k, n in lexicon.frames.items() if k in found.frames})
    phrases, done = Phrases(part.text, found, whose), set[str]()
    for one in sayings:
        for meant in fitting(phrases, one):
            pointless = _MOMENT.match(meant.means) and "about" not in meant.words
            for pattern, means in () if pointless else slotted(meant, found):
                if pattern not in done:
                    done.add(pattern)
                    yield Own(pattern, means, meant.words, meant.line)


_MOMENT = re.compile(r"inertia \S+ in \S+ component")
"""A principal moment, whose point is that of the whole note unless words name one."""


def _turned(part: Part, body: str, whose: str, lexicon: Lexicon) -> Iterator[Own]:
    """Yield the quantities of the note's body as those of whose mechanics a part is about."""
    for look in part.looks[0] if whose != body else ():
        found = lexicon.find(look)
        if found is None or body not in found.entry.meaning.labels:
            continue
        means = found.entry.meaning
        labels = tuple(whose if n == body else n for n in means.labels)
        name = OF_ONE.get(means.quantity, means.quantity) if whose == "P" else means.quantity
        words = replace(means, quantity=name, labels=labels).words
        yield Own(found.entry.latex, words, TITLE, 0)


_PARALLEL = re.compile(
    r"\b(?:frames|axes|triads|bases)\b.*\bparallel\b|\bparallel\b.*\b(?:frames|axes|triads)\b",
    re.IGNORECASE,
)
"""Words by which two frames differ in their origins alone."""


def _shifted(part: Part, lexicon: Lexicon) -> Iterator[Own]:
    """Yield what has a frame below it where frames are parallel: it is about the origin of that frame.

    All components are the same in both frames.
    """
    inner = sum(p.kind == "heading" for p in part.document.pieces) == 1
    said_so = next((s for s in part.text.sentences if inner and _PARALLEL.search(s)), "")
    if not said_so:
        return
    words = part.text.shown(said_so)[:70]
    yield from _differences(part, lexicon)
    for look in _shown(part):
        label = "".join(look.sub).removeprefix("O_").removeprefix("O")
        origin = lexicon.points.get((f"O_{label}",), "")
        base = replace(look, sub=())
        found = lexicon.find(look) or lexicon.find(base)
        means = found.entry.meaning if found is not None and origin else None
        about = {
            "position": f"position dm {origin}",
            "inertia": f"inertia {origin}",
            "first_moment": f"first_moment body {origin}",
        }.get(means.quantity if means is not None else "", "")
        if about and (label,) in lexicon.frames:
            yield Own(latex_of(look), f"{about} in B", words, 0)


def _differences(part: Part, lexicon: Lexicon) -> Iterator[Own]:
    """Yield what sums and differences in a part's text say of a symbol that has no meaning."""
    for statement, line in zip(part.text.formulas, part.text.lines, strict=True):
        left, right = statement.members[:2]
        for term, rest in solved(left, right) if look_of(left) is not None else ():
            look = look_of(term)
            if look is not None and lexicon.find(look) is None and len(look.sub) == 2:
                yield Own(latex_of(look), f"= {rest}", FORMULA, line)


def _known(lexicon: Lexicon, pattern: str) -> str:
    """Return what a lexicon says of a pattern, or of the symbol that it is."""
    rows = (e for layer in lexicon.layers for e in layer if e.latex == pattern)
    entry = next(rows, None)
    if entry is not None:
        return entry.meaning.words
    look = look_of(read_formula(pattern).tree) if "<" not in pattern else None
    found = lexicon.find(look) if look is not None else None
    return "" if found is None else found.meaning.words


def _stands(own: Own, part: Part) -> bool:
    """Return whether a symbol of a part's formulas is meant."""
    one, _ = lexicon_of({"symbols": {own.latex: own.means}}, "part")
    return any(one.find(look) is not None for look in _shown(part))


def _shown(part: Part) -> Iterator[Look]:
    """Yield the symbols of a part's displays; a raised cross is no label."""
    yield from (replace(k, sup=()) if k.sup == ("times",) else k for k in part.looks[0])
