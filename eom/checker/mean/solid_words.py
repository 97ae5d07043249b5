r"""Solids that a note names in its words: "a solid cone of height $h$ and base radius $R$".

The words beside a formula say which solid it is about, the letters of its sizes, how it lies in the axes
x, y, z, and which points and axes its moments of inertia are about. What they leave open has several
readings, the likeliest first. Each is a lexicon whose system is the solid, as if a scope had named it;
what a lexicon says of a system goes before all words.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache
from itertools import islice, product
from typing import NamedTuple

import sympy as sp

from eom.checker.mean.lexicon import Entry, Lexicon, Meaning
from eom.checker.mean.model import Model
from eom.checker.mean.solid_models import SPELLINGS, Pose, solid_system, tail
from eom.checker.read.documents import Piece
from eom.checker.read.grammar import read_formula
from eom.checker.read.symbol_shape import Labels, Look, Seen, labels, seen
from eom.checker.read.syntax import Node, walk
from eom.checker.read.syntax import Sequence as Items
from eom.mass.solids import CENTRE, SOLIDS, mass_properties
from eom.quantities import Quantity
from eom.system import Expr

MAX_READINGS = 24


@dataclass(frozen=True)
class Noun:
    """Words for solids of the catalogue, the likeliest first; ``equal``: sizes that are the first one."""

    pattern: re.Pattern[str]
    solids: tuple[str, ...]
    equal: tuple[str, ...] = ()


def _noun(pattern: str, *solids: str, equal: tuple[str, ...] = ()) -> Noun:
    return Noun(re.compile(rf"\b(?:{pattern})\b", re.IGNORECASE), solids, equal)


_FLAT = r"(?: \w+){0,2} (?:plate|lamina|sheet|dis[ck])"
NOUNS: tuple[Noun, ...] = (
    _noun(r"ellipsoid|spheroid", "ellipsoid"),
    _noun(r"hemispherical (?:shell|bowl)|hollow hemisphere", "hemispherical shell"),
    _noun(r"hemisphere|half[- ](?:sphere|ball)", "hemisphere"),
    _noun(r"spherical(?: \w+)? shell|hollow (?:sphere|ball)", "spherical shell", "hollow sphere"),
    _noun(r"sphere|ball", "sphere"),
    _noun(r"elliptic(?:al)?(?: \w+)? cylinder", "elliptical cylinder"),
    _noun(r"cylindrical shell|thin[- ]walled(?: \w+){0,2} cylinder", "cylindrical shell"),
    _noun(r"(?:hollow|thick[- ]walled)(?: \w+){0,2} cylinder|tube|pipe", "hollow cylinder",
          "cylindrical shell"),
    _noun(r"cylinder", "cylinder"),
    _noun(r"truncated cone|frustum", "frustum"),
    _noun(r"conical shell|hollow cone", "conical shell"),
    _noun(r"cone", "cone"),
    _noun(r"torus|doughnut|donut", "torus"),
    _noun(r"annulus|washer|annular" + _FLAT, "annulus"),
    _noun(r"semi-?circular" + _FLAT, "semicircular disc"),
    _noun(r"elliptic(?:al)?" + _FLAT, "elliptical disc"),
    _noun(r"triangular prism", "triangular prism"),
    _noun(r"triangular" + _FLAT, "triangular plate"),
    _noun(r"square" + _FLAT, "rectangular plate", equal=("b",)),
    _noun(r"circular" + _FLAT + "|dis[ck]", "disc", "cylinder"),
    _noun(r"plate|lamina|rectangle", "rectangular plate", "box"),
    _noun(r"hoop|ring", "ring"),
    _noun(r"rod|bar|stick|needle", "rod"),
    _noun(r"cube", "box", equal=("b", "c")),
    _noun(r"box|block|cuboid|brick|parallelepiped", "box"),
    _noun(r"pyramid", "pyramid"),
    _noun(r"tetrahedron", "tetrahedron"),
)  # fmt: skip
"""Words for solids; of those that end at one place the first in the table counts."""

_EDGES = (
    r"semi-?ax[ei]s|sides?\b|edges?\b|dimensions?\b|legs?\b|length|width|depth|height|thickness"
)
SIZES: dict[str, str] = {
    "inner_radius": r"\b(?:inner|inside|internal)\b.*radi",
    "outer_radius": r"\b(?:outer|outside|external)\b.*radi",
    "base_radius": r"\b(?:base|bottom|lower|larger)\b.*radi",
    "top_radius": r"\b(?:top|upper|smaller)\b.*radi",
    "tube_radius": r"\b(?:tube|cross[- ]section(?:al)?|minor)\b.*radi|radius of (?:the|its) (?:tube|cross)",
    "ring_radius": r"\b(?:major|ring|mean|large)\b.*radi|distance",
    "radius": r"radi(?:us|i)",
    "length": r"length|height|thickness|altitude",
    "height": r"height|altitude|length",
    **dict.fromkeys("abc", _EDGES),
}  # fmt: skip
"""Words in front of the letter of a size, by the name that it has in the catalogue."""

POINTS: tuple[tuple[str, tuple[str, ...]], ...] = (
    (r"cent(?:re|er) of (?:mass|gravity)|(?:mass|gravity) cent(?:re|er)|centroid", (CENTRE,)),
    (r"\bapex|\btip\b|\bvertex", ("apex", "corner")),
    (r"\bcorner", ("corner",)),
    (r"\bends?\b", ("end", "base")),
    (r"\bbase\b(?! radi)|flat face", ("base",)),
    (r"\brim\b|circumference|\btangent", ("rim", "pole")),
    (r"\bpole\b", ("pole",)),
    (r"\bcent(?:re|er)\b(?! of (?:the tube|mass|gravity))|centred|centered|diameter|midpoint|middle",
     ("base", CENTRE)),
)  # fmt: skip
"""Words for points, and the names that they may have among those of a solid."""

_ROUND_CENTRES = frozenset({"hemisphere", "hemispherical shell", "semicircular disc"})
"""Solids whose centre, in words, is that of their base."""
_AXES: tuple[tuple[str, tuple[int, ...]], ...] = (
    (r"perpendicular to (?:its|the) (?:plane|face|plate|dis[ck])", (2,)),
    (r"transverse|diameter|in (?:its|the) plane|(?:perpendicular|normal) to (?:its|the) (?:axis|rod)",
     (0, 1)),
    (r"(?:its|own|symmetry|long|longitudinal|polar) axis|axis of (?:symmetry|revolution)", (2,)),
)  # fmt: skip
"""Words for the axis of a moment of inertia that has no label, and that axis of the solid."""
_CENTRAL = ("C", "G", "S", "cm", "CM", "com", "COM", "c", "centre", "center")
"""Usual labels of the centre of mass."""
_UNTURNED = frozenset("box ellipsoid sphere tetrahedron".split()) | {
    "hollow sphere", "spherical shell", "triangular prism"
}  # fmt: skip
"""Solids of which no axis is to be laid along one of the note's."""


# -- what stands beside a formula ------------------------------------------------------------------


@dataclass(frozen=True)
class Beside:
    """The words about the solid of a formula: all of them, those near it, of the whole note.

    ``named``: whether those near it name the solid.
    """

    noun: Noun
    words: str
    near: str
    note: str
    named: bool

    @cached_property
    def sizes(self) -> tuple[str, Mapping[str, tuple[str, Expr]]]:
        """The solid, and letters of its sizes, each with the name of a parameter and what it is."""
        tried = [(name, _sizes(name, self.words)) for name in self.noun.solids]
        return max(tried, key=lambda t: len(t[1]))

    @property
    def edges(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The edges or semi-axes that have letters, and those that have none and equal no other."""
        name, letters = self.sizes
        own = [s for s in SOLIDS[name].sizes if s in "abc"]
        with_letter = {s for s, _ in letters.values()}
        missing = (s for s in own if s not in with_letter and s not in self.noun.equal)
        return tuple(s for s in own if s in with_letter), tuple(missing)

    def concerns(self, tree: Node) -> bool:
        """Tell whether a formula is about the solid: words near it say so, or it has a size of it."""
        if self.named:
            return True
        found = (seen(n) for n in walk(tree))
        return any(g is not None and g.look.text in self.sizes[1] for g in found)


_BREAK = re.compile(r"\n[ \t]*\n|\n(?=\s*(?:\||[-*+]\s|\d+\.\s|\\item))")
_WHERE = re.compile(r"\s*,?\s*(?:where|with|here)\b", re.IGNORECASE)


def beside(pieces: Sequence[Piece]) -> dict[int, tuple[Beside, ...]]:
    """Return what the words say of the solid of each formula, by the number of its piece.

    Where they name several, each of them is there.
    """
    found: dict[int, tuple[Beside, ...]] = {}
    parts, whole = _paragraphs(pieces), "".join(map(_text, pieces))
    current: _Current = ()
    near = ""
    for k, (kind, text, numbers) in enumerate(parts):
        if kind == "display":
            after = parts[k + 1].text if k + 1 < len(parts) else ""
            more = after if _WHERE.match(after) else ""
            found[numbers[0]] = _beside(current, f"{near}\n{more}", whole)
            near = ""
            continue
        near, current = (text, ()) if kind == "heading" else (f"{near}\n{text}", current)
        current = _named(text, current)
        found |= dict.fromkeys(numbers, _beside(current, text, whole))
    return found


class _Part(NamedTuple):
    """A heading, a display, or a paragraph, item or row with the numbers of its formulas."""

    kind: str
    text: str
    numbers: tuple[int, ...] = ()


_Current = tuple[tuple[Noun, str], ...]
"""Solids that are named, each with the words about it."""
_SMALL = "the|its|this|has|have|of|is|are|with|and|in|on|at|to|by|from|about"
_ARTICLE = re.compile(
    rf"\b(?:an?|every|each)(?:\s+(?!(?:{_SMALL})\b)[\w-]+){{0,4}}\s*$", re.IGNORECASE
)


def _named(text: str, current: _Current) -> _Current:
    """Return the solids that a paragraph is about: others, or what is known of one with these words."""
    named = _mentions(text)
    again = [(n, f"{words}\n{text}") for n, words in current if named and n == named[0][0]]
    if again and not _letters(text):
        return tuple(again)
    return named or current


def _beside(current: _Current, near: str, whole: str) -> tuple[Beside, ...]:
    named = {noun for noun, _ in _mentions(near)}
    if len(current) == 1:
        ((noun, words),) = current
        return (Beside(noun, f"{words}\n{near}", near, whole, noun in named),)
    return tuple(Beside(noun, words, words, whole, noun in named) for noun, words in current)


def _mentions(text: str) -> _Current:
    """Return the solids that a text brings in by an article, each with the words up to the next; else one.

    Without an article it is the first that is named, with all words.
    """
    found: dict[int, tuple[int, int]] = {}
    for k, noun in enumerate(NOUNS):
        for match in noun.pattern.finditer(text):
            found.setdefault(match.end(), (match.start(), k))
    places = [found[end] for end in sorted(found)]
    brought = [p for p in places if _ARTICLE.search(text[max(0, p[0] - 60) : p[0]])]
    if len({k for _, k in brought}) < 2:
        return tuple((NOUNS[k], text) for _, k in (brought or places)[:1])
    stops = [start for start, _ in brought[1:]] + [len(text)]
    return tuple((NOUNS[k], text[a:b]) for (a, k), b in zip(brought, stops, strict=True))


def _paragraphs(pieces: Sequence[Piece]) -> list[_Part]:
    """Return the parts of a note in order."""
    parts = [_Part("prose", "")]
    for k, piece in enumerate(pieces):
        kind, text, numbers = parts[-1]
        if piece.kind in {"display", "heading"}:
            parts += [_Part(piece.kind, _text(piece), (k,)), _Part("prose", "")]
        elif piece.kind == "inline":
            parts[-1] = _Part(kind, text + _text(piece), (*numbers, k))
        else:
            first, *rest = _BREAK.split(piece.body)
            parts[-1] = _Part(kind, text + first, numbers)
            parts += [_Part("prose", r) for r in rest]
    return [p for p in parts if p.kind == "display" or p.text.strip()]


def _text(piece: Piece) -> str:
    """Return words as they are, formulas of the text between marks."""
    if piece.kind == "inline":
        return f"«{piece.body.strip()}»"
    return (
        piece.body if piece.kind == "prose" else f"\n\n{piece.body}\n\n" * (piece.kind == "heading")
    )


# -- sizes -----------------------------------------------------------------------------------------

_FORMULA = re.compile(r"«([^»]*)»")
_LIST = re.compile(r"[\s,;]*(?:and|&|by|\\times)?[\s,]*$")
_STOP = re.compile(r"[.;:](?:\s|$)|\n\s*\n")


@lru_cache(maxsize=4096)
def _looks(latex: str) -> tuple[Look, ...]:
    """Return the symbols of a formula that is one, or a list of them."""
    try:
        tree = read_formula(latex).tree
    except ValueError:
        return ()
    nodes = tree.items if isinstance(tree, Items) else (tree,)
    found = [seen(n) for n in nodes]
    plain = [g.look for g in found if g is not None and not g.dots and not g.raised]
    return tuple(plain) if len(plain) == len(nodes) else ()


@lru_cache(maxsize=4096)
def _multiple(latex: str) -> tuple[Expr, Look] | None:
    """Return the number and the symbol of a formula such as 2 l or d/2; None for others."""
    match = re.fullmatch(r"\s*(\d*)\s*(.+?)\s*(?:/\s*(\d+))?\s*", latex.replace(r"\,", ""))
    fraction = re.fullmatch(r"\s*\\t?frac\s*\{?(.+?)\}?\s*\{?(\d+)\}?\s*", latex)
    above, letter, below = (
        ("", *fraction.groups()) if fraction else match.groups() if match else ("",) * 3
    )
    looks = _looks(letter) if letter and (above or below) else ()
    return (sp.Rational(int(above or 1), int(below or 1)), looks[0]) if len(looks) == 1 else None


def _letters(text: str) -> list[tuple[str, list[Look], str]]:
    """Return symbols in the text, with the words in front of them and behind; a list has the same."""
    found: list[tuple[str, list[Look], str]] = []
    matches = list(_FORMULA.finditer(text))
    for k, match in enumerate(matches):
        multiple = _multiple(match[1])
        looks = (
            [multiple[1]]
            if multiple
            else [
                g
                for g in _looks(match[1].partition("=")[0])
                if (g.name, g.sub) not in {(c, ()) for c in "xyz"}
            ]
        )
        start = matches[k - 1].end() if k else 0
        before = text[start : match.start()]
        stop = matches[k + 1].start() if k + 1 < len(matches) else len(text)
        after = text[match.end() : stop]
        if found and k and looks and _LIST.match(before) and found[-1][1]:
            words, others, _ = found[-1]
            found[-1] = (words, [*others, *looks], after)
        else:
            found.append((_STOP.split(before)[-1], looks, after))
    return [f for f in found if f[1]]


_IS = re.compile(r"\s*(?:is|are|denotes?|being|stands? for|=|:|,)?\s*(?:the|its|a)\b")


def _sizes(name: str, text: str) -> dict[str, tuple[str, Expr]]:
    """Return letters with the sizes that words say they are."""
    found: dict[str, tuple[str, Expr]] = {}
    multiples = [m for f in _FORMULA.finditer(text) if (m := _multiple(f[1])) is not None]
    factors = {look.text: factor for factor, look in multiples}
    for before, given, after in _letters(text):
        behind = after if _IS.match(after) else ""
        looks = [g for g in given if g.text not in found]
        for words in (before, re.split(r"[,.;]|\band\b", behind)[0]):
            sizes = _sized(name, words, {s for s, _ in found.values()})
            if sizes:
                pairs = _paired([g.text for g in looks], sizes)
                found |= {t: (s, f * factors.get(t, 1)) for t, (s, f) in pairs}
                break
    return found


def _paired(
    letters: Sequence[str], sizes: Sequence[tuple[str, Expr]]
) -> Iterator[tuple[str, tuple[str, Expr]]]:
    """Yield letters with sizes: edges with letters of their own names, all others in their order."""
    own = {size: (size, factor) for size, factor in sizes if size in letters}
    rest = iter([s for s in sizes if s[0] not in own])
    for letter in letters:
        size = own.get(letter) or next(rest, None)
        if size is not None:
            yield letter, size


def _sized(name: str, words: str, taken: Iterable[str]) -> list[tuple[str, Expr]]:
    """Return the sizes of a solid that words name, in their order."""
    own = [s for s in SOLIDS[name].sizes if s not in taken]
    matches = [(m.start(), s) for s in own if (m := re.search(SIZES[s], words, re.IGNORECASE))]
    exact = [(p, s) for p, s in matches if s not in "abc"] or matches
    found = [s for _, s in sorted(exact, key=lambda e: (e[0], own.index(e[1])))]
    if not found and "radius" in own and re.search("diameter", words, re.IGNORECASE):
        return [("radius", sp.Rational(1, 2))]
    return [(s, sp.Integer(1)) for s in found]


def _said(words: str, text: str) -> list[Look]:
    """Return the letters that stand behind a word, or of which it is said behind them."""
    found = []
    for before, looks, after in _letters(text):
        behind = rf"{_IS.pattern}\s+(?:(?!cent)\w+\s+){{0,2}}{words}\b"
        if re.search(rf"\b{words}\W*$", before, re.IGNORECASE) or re.match(behind, after):
            found += looks
    return list(dict.fromkeys(found))


# -- how it lies -----------------------------------------------------------------------------------

_TURNED = re.compile(
    r"(?:angle|inclined|tilted|at|by)\s+(?:at |by |of )?«(?P<angle>[^»]*)»[^«».]{0,40}«(?P<start>[xyz])»"
    r"(?:[^«».]{0,30}\bto(?:wards?)?\b[^«».]{0,25}«(?P<end>[xyz])»)?",
    re.IGNORECASE,
)
_PLANE = re.compile(
    r"«(?P<pair>[xyz]{2})»[- ]plane|plane «(?P<same>[xyz]{2})»|(?:plane )?«(?P<normal>[xyz]) ?= ?0»",
    re.IGNORECASE,
)
_ALONG = re.compile(
    r"«(?P<first>[xyz])»(?: axis)? (?:is |being |along |as )+(?:its|the|an)\b[^«».,]{0,20}\baxis"
    r"|\baxis\b[^«».,;]{0,30}«(?P<second>[xyz])»|\b(?:along|on) (?:the )?(?:positive )?«(?P<third>[xyz])»",
    re.IGNORECASE,
)
_BASIS = sp.eye(3)


@dataclass(frozen=True)
class Lying:
    """Where the axis of a solid points: columns of the turn, and the angle of a tilt."""

    turn: tuple[tuple[Expr, ...], ...]
    angle: Look | None = None


def _lying(name: str, text: str) -> Iterator[Lying]:
    """Yield how a solid may lie in the axes of the note, the likeliest first."""
    plane = next((_normal(m) for m in _PLANE.finditer(text)), None)
    tilt = _TURNED.search(text)
    if tilt is not None and _looks(tilt["angle"]):
        yield from _tilted(tilt, plane)
    elif name in _UNTURNED:
        yield Lying(Pose().turn)
    else:
        along = _ALONG.search(text)
        flat = SOLIDS[name].region.position[2] == 0
        said = plane if flat else None
        if said is None and along is not None and not (flat and along["third"]):
            said = "xyz".index(next(g for g in along.groups() if g))
        yield from (_upright(k, flat) for k in ((2, 0, 1) if said is None else (said,)))


def _normal(match: re.Match[str]) -> int:
    """Return the axis that a plane is perpendicular to."""
    pair = match["pair"] or match["same"]
    return (
        next(k for k in range(3) if "xyz"[k] not in pair) if pair else "xyz".index(match["normal"])
    )


def _upright(axis: int, flat: bool) -> Lying:
    """Return a solid with its axis along one of the note's; sides of plates keep the order of axes."""
    others = sorted({0, 1, 2} - {axis}) if flat else [(axis + 1) % 3, (axis + 2) % 3]
    first, second = (_BASIS.col(k) for k in others)
    return Lying(_rows(first, second, first.cross(second)))


def _tilted(match: re.Match[str], plane: int | None) -> Iterator[Lying]:
    angle = _looks(match["angle"])[0]
    b = sp.Symbol("angle", real=True)
    start = "xyz".index(match["start"])
    ends = ["xyz".index(match["end"])] if match["end"] else [k for k in range(3) if k != start]
    for end, sign in product(ends, (1,) if match["end"] else (1, -1)):
        if end == start or (plane in {start, end} and not match["end"]):
            continue
        axis = sp.cos(b) * _BASIS.col(start) + sign * sp.sin(b) * _BASIS.col(end)
        side = _BASIS.col(start).cross(_BASIS.col(end))
        yield Lying(_rows(side.cross(axis), side, axis), angle)


def _rows(*columns: Expr) -> tuple[tuple[Expr, ...], ...]:
    return tuple(map(tuple, sp.Matrix.hstack(*columns).tolist()))


# -- points and axes -------------------------------------------------------------------------------


def _points(name: str, text: str) -> list[str]:
    """Return the points of a solid that words name, in their order."""
    found: dict[str, int] = {}
    for words, names in POINTS:
        for match in re.finditer(words, text, re.IGNORECASE):
            known = [n for n in names if n == CENTRE or n in SOLIDS[name].points]
            if names == ("base", CENTRE) and name not in _ROUND_CENTRES:
                known = [CENTRE]
            for one in known[:1]:
                found[one] = min(found.get(one, match.start()), match.start())
    return sorted(found, key=found.__getitem__)


def _labels(name: str, lexicon: Lexicon, text: str) -> dict[Labels, str]:
    """Return labels of points: those that the note explains, its words for points, the usual ones."""
    found: dict[Labels, str] = {tuple(c): CENTRE for c in _CENTRAL}
    found |= {k: CENTRE for k, point in lexicon.points.items() if point == "C"}
    for point in SOLIDS[name].points:
        found[tuple(point)] = point
    for match in _FORMULA.finditer(text):
        look = _looks(match[1])
        if len(look) == 1 and look[0] == Look(look[0].name) and look[0].name.isupper():
            after = re.split(r"[«.;\n]", text[match.end() : match.end() + 60])[0]
            before = re.split(r"[».;,\n]", text[max(0, match.start() - 25) : match.start()])[-1]
            points = _points(name, after)[:1] or _points(name, before)[-1:]
            if points:
                found[(look[0].name,)] = points[0]
    return found


def _called(name: str) -> dict[Labels, str]:
    """Return labels that name the solid: the beginnings of its words, "cyl" for a cylinder."""
    return {tuple(w[:n]): "" for w in name.split() for n in range(3, len(w) + 1)}


def _about(text: str) -> tuple[int, ...]:
    """Return the axes of the solid about which a moment without a label may be."""
    return next((axes for words, axes in _AXES if re.search(words, text, re.IGNORECASE)), (0, 1, 2))


# -- readings --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Taken:
    """What a reading takes words to mean: a solid, how it lies, edges that are equal, point and axis.

    Point and axis are None where the words beside the line name them, so that other lines may have others.
    """

    solid: str
    lying: Lying
    equal: tuple[tuple[str, str], ...]
    point: str | None
    axis: int | None

    def fits(self, other: Taken) -> bool:
        """Return whether lines of one section may be read in both ways."""
        pairs = ((getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
        return all(a == b or a is None or b is None for a, b in pairs)

    @property
    def words(self) -> str:
        """The reading in words."""
        axis = [row[2] for row in self.lying.turn]
        along = next((c for c, part in zip("xyz", axis, strict=True) if part == 1), "")
        pairs = ", ".join(f"{a} = {b}" for a, b in self.equal)
        parts = (
            f"its axis along {along}" if along else "",
            f"about its {self.point}" if self.point else "",
            f"with edges {pairs}" if pairs else "",
        )
        return ", ".join(filter(None, (f"read as: of a {self.solid}", *parts)))


def readings(lexicon: Lexicon, said: Beside, tree: Node) -> Iterator[tuple[Lexicon, bool, Taken]]:
    """Yield a lexicon of the solid for each reading of the words; what the lexicon says stays behind it.

    ``tree``: the formula, whose letters and labels are the ones that get a meaning. With each whether the
    words leave so little open that what holds in no reading is wrong, and what it takes them to mean.
    """
    name, sizes = said.sizes
    here = tuple(g for n in walk(tree) if (g := seen(n)) is not None)
    named = _points(name, said.near)
    points = named or [CENTRE, *SOLIDS[name].points]
    axes = _about(said.near)
    text = f"{said.note}\n{said.words}\n{said.near}"
    labelled = _present({**_called(name), **_labels(name, lexicon, text)}, here)
    bodies = {g.sub[-1] for _, looks, _ in _letters(said.words) for g in looks if g.sub}
    unknown = _unexplained(here, labelled, bodies)
    letters = sorted({g.look.name for g in here} & _INERTIAS)
    ways = product(_equalities(said), _lying(name, said.words), points, axes)
    for equal, lying, point, axis in islice(ways, MAX_READINGS):
        model = _model(name, _pose(equal, sizes, lying), point)
        known = {label: about or point for label, about in {**unknown, **labelled}.items()}
        entries = {
            **_of_lexicon(lexicon, point),
            **_coordinates(),
            **_spelt(letters, known, point, _turned(lying, axis)),
            **_letters_of(said, equal, name, sizes, lying, {g.look for g in here}),
        }
        rows = tuple(_entry(look, what, model) for look, what in entries.items())
        plain = lexicon.without_system()
        own = {e.meaning.labels[0]: e.look.text for e in reversed(rows) if e.meaning.labels}
        here_alone = replace(plain, layers=(rows, *plain.layers))
        yield (
            replace(here_alone, system=replace(model, letters=own)),
            not (unknown or said.edges[1]),
            Taken(
                name,
                lying,
                tuple(equal.items()),
                None if named else point,
                axis if len(axes) == len(_BASIS.row(0)) else None,
            ),
        )


_INERTIAS = frozenset("IJ")
"""Letters of moments of inertia that need no entry."""


def _present(known: Mapping[Labels, str], here: Iterable[Seen]) -> dict[Labels, str]:
    """Return the labels of points that some symbol of a formula has, above or as part of those below."""
    corners = {c for g in here for c in (*g.look.corners, *map(labels, g.raised))}
    return {k: p for k, p in known.items() if any(_within(k, c) for c in corners)}


_KINDS: dict[Labels, tuple[int, ...]] = {
    **dict.fromkeys((("s",), ("a",), ("p",)), (2,)),
    **dict.fromkeys((("t",), ("d",)), (0, 1)),
}
"""Labels of moments about axes along and across that of the solid: spin, axial, polar; transverse."""


def _unexplained(
    here: Iterable[Seen], known: Container[Labels], bodies: Container[str]
) -> dict[Labels, str]:
    """Return labels of moments that no words explain: a letter of any point or axis, numbers of bodies.

    ``bodies``: labels of masses and sizes, which number bodies and not axes.
    """
    moments = [g for g in here if g.look.name in _INERTIAS]
    found = [c for g in moments for c in (g.look.sub, *map(labels, g.raised)) if len(c) == 1]
    return {
        c: "" for c in found if c not in known and (c[0].isupper() or c in _KINDS or c[0] in bodies)
    }


def _within(part: Labels, whole: Labels) -> bool:
    return any(whole[n : n + len(part)] == part for n in range(len(whole)))


def _turned(lying: Lying, axis: int) -> int:
    """Return the axis of the note along which one of the solid lies, or nearly so."""
    column = [row[axis] for row in lying.turn]
    return next((k for k, c in enumerate(column) if c != 0), axis)


@lru_cache(maxsize=64)
def _model(name: str, pose: Pose, point: str) -> Model:
    return Model(solid_system(name, pose), name=name, body=pose.of(mass_properties(name, point)))


def _equalities(said: Beside) -> Iterator[dict[str, str]]:
    """Yield edges that equal others: as the noun says, or those without letters some that have one."""
    named, missing = said.edges
    plain = {s: "a" for s in said.noun.equal if s in SOLIDS[said.sizes[0]].sizes}
    yield plain
    for others in product(named, repeat=len(missing)):
        if missing:
            yield {**plain, **dict(zip(missing, others, strict=True))}


def _pose(equal: Mapping[str, str], sizes: Mapping[str, tuple[str, Expr]], lying: Lying) -> Pose:
    """Return how the solid lies, with sizes that are measured by others."""
    parts = {s: (f, sp.Symbol(_part(s), positive=True)) for s, f in sizes.values() if f != 1}
    changed = [(s, f * part) for s, (f, part) in parts.items()]
    changed += [(s, sp.Symbol(other, positive=True)) for s, other in equal.items()]
    more = [Quantity(part, "m", "measure of a size") for _, part in parts.values()]
    if lying.angle is not None:
        more.append(Quantity(sp.Symbol("angle", real=True), "rad", "angle"))
    return Pose(lying.turn, tuple(changed), tuple(more))


def _part(size: str) -> str:
    """Return the name of the parameter that a size is a multiple of: a diameter, half a length."""
    return f"{size}_measure"


_AMOUNTS = (("mass", ("m", "M")), ("density", ("rho", "varrho", "sigma", "lambda")))


def _letters_of(
    said: Beside,
    equal: Container[str],
    name: str,
    sizes: Mapping[str, tuple[str, Expr]],
    lying: Lying,
    here: Container[Look],
) -> dict[Look, str]:
    """Return the letters of sizes, mass, density and angle; usual ones where the words have none.

    ``here``: the symbols of the formula; of several that may be the mass none is.
    """
    looks = {g.text: g for _, gs, _ in _letters(said.words) for g in gs}
    found = {looks[t]: s if f == 1 else _part(s) for t, (s, f) in sizes.items()}
    for size in SOLIDS[name].sizes:
        if size not in {s for s, _ in sizes.values()} and size not in equal:
            usual = (Look(w.lstrip("\\").partition("_")[0], sub=tuple(w.partition("_")[2]))
                     for w in SPELLINGS.get(size, (size,)))  # fmt: skip
            found |= {g: size for g in usual if g not in found}
    for word, usual_ones in _AMOUNTS:
        own = [g for g in _said(word, said.words) if g not in found]
        named = [*_said(word, said.note), *map(Look, usual_ones)]
        shown = dict.fromkeys(g for g in named if g in here and g not in found)
        found |= dict.fromkeys(own[:1] or (shown if len(shown) == 1 else ()), word)
    if lying.angle is not None:
        found[lying.angle] = "angle"
    return found


def _coordinates() -> dict[Look, str]:
    return {Look(c): c for c in "xyz"}


def _of_lexicon(lexicon: Lexicon, point: str) -> dict[Look, str]:
    """Return what the lexicon calls an element of an inertia matrix, as one of the solid's."""
    found: dict[Look, str] = {}
    for entry in (e for layer in lexicon.layers for e in layer):
        m = entry.meaning
        if m.quantity == "inertia" and set(m.component) <= {"1", "2", "3"} and not entry.slots:
            about = CENTRE if m.labels == ("C",) else point
            for i, j in [m.component] if len(m.component) == 2 else []:
                found.setdefault(entry.look, _element(int(i) - 1, int(j) - 1, about))
    return found


def _spelt(
    letters: Iterable[str], known: Mapping[Labels, str], point: str, axis: int
) -> dict[Look, str]:
    """Return letters of moments and products about the points that have labels, and about ``point``."""
    found: dict[Look, str] = {}
    words = {tuple(_word(p)): p for p in {point, *known.values()}}
    for letter, (label, about) in product(letters, [*known.items(), ((), point), *words.items()]):
        for i, j in product(range(3), repeat=2):
            for axes in ("xyz", "123"):
                pairs = [(axes[i], axes[j]), *([(axes[i],)] if i == j else [])]
                for pair, (sub, sup) in product(pairs, _placed(label)):
                    look = Look(letter, sub=(*sub[0], *pair, *sub[1]), sup=sup)
                    found.setdefault(look, _element(i, j, about))
        for sub, sup in _placed(label)[:2]:
            plain = Look(letter, sub=sub[0], sup=sup)
            possible = _KINDS.get(label, (axis,))
            along = axis if axis in possible else possible[0]
            found.setdefault(plain, _element(along, along, about))
            found.setdefault(replace(plain, style="bold"), _matrix(letter, about))
    return found


def _placed(label: Labels) -> list[tuple[tuple[Labels, Labels], Labels]]:
    """Return where a label may stand: below, before other labels or behind them, or above."""
    return [((label, ()), ()), (((), ()), label), (((), label), ())]


def _element(i: int, j: int, about: str) -> str:
    i, j = sorted((i, j))
    return f"I{i + 1}{tail(about)}" if i == j else f"J{i + 1}{j + 1}{tail(about)}"


def _word(about: str) -> str:
    """Return the label that words make of a point."""
    return "centre" if about == CENTRE else about


def _matrix(letter: str, about: str) -> str:
    """Return a formula for the inertia matrix, over the elements as they are labelled by words."""
    label = _word(about)
    rows = (" & ".join(rf"{letter}_{{\text{{{label}}}{a}{b}}}" for b in "xyz") for a in "xyz")
    return r"= \begin{pmatrix} " + r" \\ ".join(rows) + r" \end{pmatrix}"


def _entry(look: Look, what: str, model: Model) -> Entry:
    """Return what a letter means: a quantity of the solid, or a formula."""
    if what.startswith("="):
        return Entry(look, Meaning("equals", formula=what[1:].strip()), look.text)
    return Entry(look, Meaning("system", (what,), unit=model.quantities[what].unit), look.text)
