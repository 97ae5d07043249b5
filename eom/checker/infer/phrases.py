r"""Phrases to meanings: "the angular momentum about $O$" is ``angular_momentum body O``.

The table ``phrases.toml`` has the words with places; here the places are filled from what stands behind
prepositions: points and frames by their labels or in words, particles by their index.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from itertools import pairwise

from eom.checker.infer.places import USUAL, WHICH, Places, as_label, tables
from eom.checker.infer.sayings import MARK, Mention, Prose, Said
from eom.checker.mean.lexicon import AXES
from eom.checker.read.symbol_shape import Labels, Look
from eom.checker.read.writing import latex_of
from eom.terms.terms import INDICES

UNKNOWN = "?"
"""What stands in a place that words do not fill."""


OF_INERTIA = frozenset({"I", "J", "Theta"})
"""Letters of which "the moment about" is that of inertia."""
OF_ONE = {"total_mass": "mass", "external_force": "force"}
"""Quantities of many that are called otherwise of a single particle."""


@dataclass(frozen=True)
class Row:
    """A row of the table: its words, how the symbol looks, the meaning with places."""

    words: re.Pattern[str]
    mark: str
    means: str


@dataclass(frozen=True)
class Meant:
    """A symbol with a meaning that words give it, and the words."""

    look: Look
    means: str
    mark: str
    words: str
    line: int


@cache
def rows() -> tuple[Row, ...]:
    """Return the rows of the table."""
    return tuple(
        Row(re.compile(rf"\b(?:{r['words']})", re.IGNORECASE), r["mark"], r["means"])
        for r in tables()["phrase"]
    )


@dataclass
class Phrases:
    """What fills places: the text, its frames and points, and whose mechanics it is.

    ``vectors``: the vectors that were given a meaning so far, the last one last, to which "its components"
    and "its magnitude" refer; ``about``: the points about which things were taken, to which "the same
    point" refers.
    """

    text: Prose
    places: Places
    body: str = "body"
    vectors: dict[Look, str] = field(default_factory=dict)
    about: list[str] = field(default_factory=list)

    def meant(self, one: Said) -> Iterator[Meant]:
        """Yield the meanings that words give symbols: one for all, or one for each in order."""
        words = one.words if not one.before else self._last(one.words)
        found = self._rows(words, one.before)
        if not found:
            return
        if one.before and not _PLURAL.search(words):
            one = replace(one, of=one.of[:1])
        several = len(one.of) > 1 and len(found) == len(one.of)
        for k, mention in enumerate(one.of):
            look = mention.look
            if look.name in INDICES and not (look.sub or look.style or look.accents):
                continue
            row, start = found[k] if several else found[0]
            own = words if several else words[start:]
            seen_from = one.before and row.means.startswith("position") and _FROM.match(one.behind)
            means = self._filled(row, f"{own} {one.behind}" if seen_from else own, one, k)
            if means:
                marked = bool(mention.look.accents or mention.look.style)
                if (row.mark == "vector" and marked) or means.startswith("inertia "):
                    self.vectors[mention.look] = means
                yield Meant(
                    mention.look, means, row.mark, self.text.shown(words)[:70], mention.line
                )

    def _last(self, words: str) -> str:
        """Return the last noun with what belongs to it."""
        return re.split(r"\b(?:with|of a|whose|has|have|and|at|by|under|let|for)\s+", words)[-1]

    def _rows(self, words: str, before: bool) -> list[tuple[Row, int]]:
        """Return the rows whose words begin a phrase, in order, none within another."""
        found: list[tuple[Row, int]] = []
        place, stop = 0, len(words)
        while place < stop:
            hits = [
                (m.start(), -m.end(), k)
                for k, r in enumerate(rows())
                if (m := r.words.search(words, place))
            ]
            if not hits:
                break
            start, end, k = min(hits)
            lead = words[place:start]
            if not found and not before and not _LEAD.fullmatch(lead):
                break
            if before and not _REST.fullmatch(words[-end:]):
                place = -end
                continue
            if found and not re.fullmatch(
                r"\s*(?:,|and|, and)\s+(?:the |its )?(?:external |total )?", lead
            ):
                break
            found.append((rows()[k], start))
            place = -end
        return found

    def _filled(self, row: Row, words: str, one: Said, k: int) -> str:
        """Return a meaning with its places filled; nothing where one is unknown."""
        points, frames = list(self._points(words)), self._frames(words)
        of, start = self._position(words, one)
        of = of or self._labelled(one.of[k].look, one.sentence)
        frames = {**frames, **self._taken(words)}
        turning = frames["of"]
        both = [self.places.frames[(n,)] for n in one.of[k].look.sub if (n,) in self.places.frames]
        if len(both) == 2 and not (frames["into"] or frames["of"] or frames["in"]):
            frames = {**frames, "into": both[:1], "in": both[1:]}
        values = {
            "body": "P" if one.sentence in self.single else self.body,
            "particle": self._particle(one.of[k], one.sentence),
            "about": self._about(points, k, len(one.of)),
            "of": of,
            "from": start,
            "frame": self._turning(row, one, k, turning) or self._owner(one, words),
            "to": (frames["into"] or turning or ["B"])[0],
            "base": (frames["in"] or ["I"])[0],
            "derivative": self._derivative(words, frames["in"]),
            "component": self._component(one, words, k),
            "magnitude": self._magnitude(words),
            "moment": self._moment(one, points, k),
            "name": one.of[k].look.name,
        }
        filled = re.sub(r"\{(\w+)\}", lambda m: values[m[1]] or UNKNOWN, row.means)
        if filled.startswith("unit ") and len(one.of) == 3 and not any(m.look.sub for m in one.of):
            filled = filled.replace("<k>", str(k + 1))
        if filled.startswith("quaternion ") and re.search(r"scalar (?:part )?last", one.sentence):
            filled = filled.replace("quaternion", "quaternion_last")
        quantity, _, rest = filled.partition(" ")
        filled = f"{OF_ONE.get(quantity, quantity)} {rest}" if rest == "P" else filled
        return "" if UNKNOWN in filled or _is_refused(filled, one.sentence) else filled

    def _about(self, points: Sequence[str], k: int, count: int) -> str:
        """Return the point about which is meant: each its own where as many are named."""
        named = points[k : k + 1] if 1 < count == len(points) else points[:1]
        return named[0] if named else self._centre()

    def _turning(self, row: Row, one: Said, k: int, named: Sequence[str]) -> str:
        """Return the frame that is meant, in order; a vectrix is that of its label, where that is usual."""
        label = one.of[k].look.sub[:1]
        if row.means.startswith("vectrix") and label in _USUAL:
            return USUAL["frames"][label[0]]
        several = len(one.of) > 1 and len(named) == len(one.of)
        return named[k] if several else next(iter(named), "")

    def _owner(self, one: Said, words: str) -> str:
        """Return the frame that unit vectors belong to: the last one that the sentence names before."""
        if _OF_SPACE.search(words.split(" vectors", maxsplit=1)[0]):
            return "I"
        before = self.text.marked(one.sentence[: one.start + len(one.words)]) if one.before else ()
        named = [self.places.frames.get(as_label(m.look)) for m in before]
        return next((n for n in reversed(named) if n), "B")

    def _referent(self, words: str) -> Look | None:
        """Return the vector that words name, or the last one."""
        named = [m.look for m in self.text.marked(words) if m.look in self.vectors]
        return named[0] if named else next(reversed(self.vectors), None)

    def _component(self, one: Said, words: str, k: int) -> str:
        """Return a component where three symbols are those of what is meant, all where one symbol is it."""
        if len(one.of) == 3 and (match := _OF_WHAT.search(words)) is not None:
            return self._whose(match, words, k)
        look = self._referent(words)
        if look is None or len(one.of) not in {1, 3} or (one.of[0].look == look):
            return ""
        frame = (
            "I"
            if re.search(r"\b(?:space|inertial)\b", words)
            else (self._frames(words)["in"] or ["B"])[0]
        )
        means = self.vectors[look].split(" in ")[0]
        if len(one.of) == 1:
            table = bool(one.of[0].look.accents or one.of[0].look.style)
            return f"{means} in {frame}" if table and not means.startswith("=") else ""
        vector = not means.startswith(("=", "inertia "))
        return f"{means} in {frame} component {k + 1}" if vector else ""

    def _whose(self, match: re.Match[str], words: str, k: int) -> str:
        """Return a component of a vector that words name without its letter."""
        if match["torque"]:
            about = next(iter(self._points(words[match.start() :])), self._centre())
            return f"torque {self.body} {about} in B component {k + 1}"
        return f"angular_velocity B I in B component {k + 1}" if match["rate"] else ""

    def _moment(self, one: Said, points: Sequence[str], k: int) -> str:
        """Return a principal moment of inertia where three letters are those of the axes."""
        axes = [m.look.sub[-1:] for m in one.of]
        counted = [AXES.get("".join(a), "") for a in axes]
        if len(one.of) != 3 or (any(axes) and sorted(counted) != ["1", "2", "3"]):
            return ""
        about = points[0] if points else self._of_matrix(one.of[0].look)
        axis = counted[k] or str(k + 1)
        return f"inertia {about} in B component {axis} {axis}" if about else ""

    def _of_matrix(self, look: Look) -> str:
        """Return the point of the inertia matrix with a letter, else that of all that words name."""
        for other, means in self.vectors.items():
            if other.name == look.name and means.startswith("inertia "):
                return means.split()[1]
        named = [k for k, n in self.places.points.items() if n == self._centre()]
        customary = all(WHICH in self.places.words["points", k][0] for k in named)
        return "" if named and customary else self._centre()

    def _magnitude(self, words: str) -> str:
        look = self._referent(words)
        if look is None or self.vectors[look].startswith("inertia ") or _LENGTH.match(words):
            return ""
        return rf"= \left|{latex_of(look)}\right|"

    def _derivative(self, words: str, frames: list[str]) -> str:
        """Return the formula of the derivative of a symbol in a frame."""
        of = re.search(rf"\bof\s+({MARK})", words)
        label = next((k for k, v in self.places.frames.items() if frames and v == frames[0]), None)
        if of is None or label is None:
            return ""
        operand = latex_of(self.text.marked(of[1])[0].look)
        return rf"= \left(\frac{{d}}{{dt}} {operand}\right)_{{{spelt(label)}}}"

    def _centre(self) -> str:
        """Return the point about which is meant where none is named."""
        points = set(self.places.points.values())
        return "O" if "O" in points and "C" not in points else "C"

    def _points(self, words: str) -> list[str]:
        """Return the points about which something is taken."""
        found = re.search(r"\b(?:about|for|around|with respect to|at)\s+(?P<what>[^.;]*)", words)
        if found is None:
            return []
        if found["what"].startswith("the same point"):
            return self.about[-1:]
        named = list(self._pointed(found["what"]))
        self.about += named[:1]
        unknown = re.match(rf"(?:the )?(?:point )?({MARK})", found["what"])
        return named or (
            ["<P>"]
            if unknown and _NAME.fullmatch(self.text.marked(unknown[1])[0].look.name)
            else []
        )

    def _pointed(self, words: str) -> Iterator[str]:
        for match in re.finditer(
            rf"{MARK}|{_WORDS}|support", re.split(r"\b(?:built|which)\b", words)[0]
        ):
            name = self._point(match[0])
            if name:
                yield name

    def _point(self, words: str) -> str:
        if words.startswith("⟦"):
            look = self.text.marked(words)[0].look
            free = "<P>" if look == Look(look.name) and _NAME.fullmatch(look.name) else ""
            known = as_label(look) in self.places.frames
            return self.places.points.get(as_label(look), "" if known else free)
        if "mass" in words or "gravity" in words:
            return "C"
        values = self.places.points.values()
        if words == "origin" and not values:
            return "OI"
        if "inertial" in words or words == "fixed origin":
            return "OI"
        return "O" if "O" in values or "OI" not in values else "OI"

    def _position(self, words: str, one: Said) -> tuple[str, str]:
        """Return which point a vector leads to, nothing where words do not say, and from which."""
        thing = rf"(?:{MARK}|particle\s+{MARK}|{_THINGS}|{_WORDS})"
        led = re.search(
            rf"from\s+(?:the |an? )*(?:\w+\s+)*?({thing})\s+to\s+(?:the |an? )*(?:\w+\s+)*?({thing})",
            words,
        )
        if led is not None:
            return self._thing(led[2]), self._thing(led[1])
        of = re.search(rf"\bof\s+(?:the |an? |each )*(?:\w+\s+)*?({thing})", words)
        start = re.search(
            rf"\b(?:from|relative to|with respect to)\s+(?:the |an? )*(?:\w+\s+)*?({thing})", words
        )
        given = self._thing(start[1]) if start is not None else "OI"
        own = "P" if _ITS.match(one.words) and one.sentence in self.single else ""
        return (self._thing(of[1]) if of is not None else own), given or "OI"

    @cached_property
    def single(self) -> frozenset[str]:
        """The sentences about one particle, and those behind a colon of such."""
        found: list[str] = []
        for before, here in pairwise(("", *self.text.sentences)):
            behind = before.endswith(":") and before in found
            found += [here] if behind or _ONE.search(here) else []
        return frozenset(found)

    def _labelled(self, look: Look, sentence: str) -> str:
        """Return the point or particle that a label names."""
        counted = {*INDICES, *(COUNTERS if _MANY.search(sentence) else ())}
        for label in (look.sub, look.sup):
            if label in self.places.points:
                return self.places.points[label]
            if len(label) == 1 and label[0] in counted:
                return "<i>"
        return "P" if self.body == "P" else ""

    def _thing(self, words: str) -> str:
        marks = self.text.marked(words)
        if words.startswith("particle") or (
            marks and marks[0].look.name in INDICES and not words.startswith("⟦")
        ):
            return "<i>"
        if "element" in words:
            return "dm"
        if words.startswith(("each", "ith")):
            return "<i>"
        if words == "point mass":
            return "P"
        return self._point(words)

    def _frames(self, words: str) -> dict[str, list[str]]:
        """Return the frames behind prepositions, in order."""
        named = rf"{_ARTICLES}(?P<what>{MARK}|{_BODY}(?: frame)?|{_SPACE})"
        return {
            key: [
                n for m in re.finditer(rf"{lead}\s+{named}", words) if (n := self._frame(m["what"]))
            ]
            for key, lead in _LEADS.items()
        }

    def _taken(self, words: str) -> dict[str, list[str]]:
        """Return the frames of components that something takes into others, in this order.

        They are unknown, and so is the rotation, where words do not name the two of them.
        """
        match = _TAKES.search(words)
        if match is None:
            return {}
        named = [
            n
            for m in re.finditer(rf"{MARK}|{_BODY}|{_SPACE}", match["what"])
            if (n := self._frame(m[0]))
        ]
        both = list(dict.fromkeys(named))
        if len(both) != 2:
            both = ["", ""] if _COMPONENTS.search(match["what"]) else []
        return {"in": both[:1], "into": both[1:], "of": []} if both else {}

    def _frame(self, words: str) -> str:
        if words.startswith("⟦"):
            return self.places.frames.get(as_label(self.text.marked(words)[0].look), "")
        return "B" if re.match(_BODY, words) else "I"

    def _particle(self, mention: Mention, sentence: str) -> str:
        labels = mention.look.sub
        if sentence in self.single:
            return "P"
        many = _MANY.search(sentence) is not None and labels not in self.places.points
        counted = {*INDICES, *(COUNTERS if many else ())}
        return "<i>" if len(labels) == 1 and labels[0] in counted else "P"


def _is_refused(means: str, sentence: str) -> bool:
    """Return whether a meaning is from a point to itself, or of a part, or of a wheel that is not there."""
    labels = means.split()[1:3]
    same = len(set(labels)) < len(labels) and means.startswith(_BETWEEN)
    partly = means.startswith("external_force") and _PARTLY.search(sentence) is not None
    return same or partly or (means == "rotor_inertia k" and _WHEEL.search(sentence) is None)


def fits(look: Look, mark: str) -> bool:
    """Return whether a symbol is marked as what it would stand for: vectors are, scalars are not."""
    marked = bool(look.accents) or bool(look.style)
    return {"vector": marked, "scalar": not marked}.get(mark, True)


def fitting(phrases: Phrases, one: Said) -> Iterator[Meant]:
    """Yield the meanings that words give symbols which look like that."""
    for meant in phrases.meant(one):
        label, plain = as_label(meant.look), not meant.look.accents and not meant.look.style
        if plain and (label in phrases.places.frames or label in phrases.places.points):
            continue
        if plain and meant.means.startswith("torque") and meant.look.name in OF_INERTIA:
            continue
        vectors = meant.mark == "vector" and meant.look.sub[-1:] not in {("1",), ("2",), ("3",)}
        if vectors or fits(meant.look, meant.mark):
            yield meant


_ARTICLES = r"(?:the |frame |body |an? |columns? of |components of )*"
_ONE = re.compile(r"\bone (?:particle|point mass|of (?:them|the particles))\b")
"""Words of a sentence that is about a particle by itself, beside others."""
_OF_SPACE = re.compile(r"\b(?:inertial|space)\b(?! angular)")
"""Words of vectors that do not turn; what is seen from there may turn."""
_OF_WHAT = re.compile(
    r"\bof\s+(?:(?:the|all|these|its|external|total|resultant|applied)\s+)*"
    r"(?:(?P<torque>moments?|torques?)\b(?! of inertia| of momentum)|(?P<rate>angular velocity)|"
    r"(?P<other>forces?|velocity|acceleration|momentum|angular momentum|position|moment of momentum))"
)
"""Of which vector components are, in words."""
_BODY = r"\b(?:body|vehicle|airframe|spacecraft|aircraft)\b"
_SPACE = r"\b(?:inertial|space|world|global|ground|lab(?:oratory)?|earth|navigation)\b"
"""How frames are called that turn with the body, and that do not turn."""
_COMPONENTS = re.compile(r"\b(?:components|coordinates|columns?)\b")
_TAKES = re.compile(r"\b(?:takes|maps|turns|brings|carries|transforms|converts)\b(?P<what>[^.;]*)")
"""What a rotation does with components of one frame: it takes them into those of another."""
COUNTERS = frozenset({"a", "s", "p", "alpha", "mu", "nu"})
"""Labels by which some count particles, where words speak of several."""
_MANY = re.compile(r"\b(?:particles|point masses|mass points)\b")
_LENGTH = re.compile(r"length(?! of ⟦)")
"""A length that may be that of a thing."""
_ITS = re.compile(r"its\b")
_USUAL = frozenset((n,) for n in USUAL["frames"])
_BETWEEN = ("position", "velocity", "acc", "rotation ", "angular_velocity")
"""Beginnings of meanings that are about two points or frames."""
_PLURAL = re.compile(r"(?:(?<!mas)s|momenta|matrices)\b(?: [a-z]+| of [a-z]+)?$")
_REST = re.compile(
    r"(?:\s+(?:vectors?|matrix|column))?"
    r"(?:\s+of\s+[a-z]+|\s+(?:of )?(?:the|a|this|each)\s+(?:point\s+)?[a-z]+)?"
    r"(?:\s+about\s+the (?:cent(?:re|er) of (?:mass|gravity)|mass cent(?:re|er)|origin|same point|pivot))?"
    r"(?:\s+(?:is|are|be|by|at|(?:one|we) (?:finds?|gets?|has|have|obtains?|writes?)))?\s*"
)
"""What may stand between a noun and the symbol behind it."""
_FROM = re.compile(r"(?:measured )?(?:from|relative to|with respect to)\b")
"""Words behind a position that say from where it is seen."""
_PARTLY = re.compile(
    r"\b(?:but|except|besides|without|other than) (?:for )?(?:the )?(?:weight|gravity)"
)
"""Words by which a force is not all of what acts."""
_WHEEL = re.compile(r"\b(?:wheel|rotor|flywheel)s?\b", re.IGNORECASE)
_NAME = re.compile(r"[A-Z]")
_LEADS = {
    "of": r"\b(?:of|fixed in|along)",
    "in": r"(?:relative to|with respect to|\bin|\bfrom)",
    "into": r"\b(?:into|to)",
}


def spelt(label: Labels) -> str:
    """Return a label in LaTeX."""
    word = label[0]
    for shaped, command in (("cal ", "mathcal"), ("bb ", "mathbb"), ("frak ", "mathfrak")):
        if word.startswith(shaped):
            name, _, below = word.removeprefix(shaped).partition("_")
            return rf"\{command}{{{name}}}" + (f"_{below}" if below else "")
    return re.sub(r"\^([a-z]{2,})", r"^{\\\1}", word)


_THINGS = r"point mass|(?:each|ith) (?:mass|particle)|(?:mass )?element"
_WORDS = (
    r"fixed origin|inertial\w* (?:fixed )?origin|mass cent(?:re|er)|cent(?:re|er) of (?:mass|gravity)|"
    r"origin|reference point|fixed point|pivot"
)
_LEAD = re.compile(
    r"(?:the|an?|its|their|again|total|relative|whole|with|column|vector|of|corresponding|inertial|external|"
    r"right-handed|respectively|so|called|constant|complete|full|resulting|instantaneous|absolute|principal|"
    r"symmetric|given|usual|same|net|resultant|entire|\W)*",
    re.IGNORECASE,
)


def slotted(meant: Meant, places: Places) -> Iterator[tuple[str, str]]:
    """Yield patterns with meanings: of the symbol as it stands, and with slots for what labels name."""
    look, means = meant.look, meant.means
    quantity, _, whose = means.partition(" ")
    if len(look.sub) == 1 and look.sub[0] in INDICES and quantity in OF_ONE and " " not in whose:
        means = f"{OF_ONE[quantity]} <i>"
    if "<i>" in means and len(look.sub) == 1 and look.sub[0] in {*INDICES, *COUNTERS}:
        yield f"{latex_of(replace(look, sub=()))}_{{<i>}}", means
        return
    if "<k>" in means:
        if look.sub and look.sub[-1] in {"1", "2", "3", "k"}:
            base = latex_of(replace(look, sub=look.sub[:-1]))
            yield f"{base}_{{<k>}}" if len(look.sub) == 1 else f"{base[:-1]}<k>}}", means
        return
    if means == "internal_force i j" and len(look.sub) == 2:
        yield f"{latex_of(replace(look, sub=()))}_{{<i><j>}}", "internal_force <i> <j>"
        return
    if means.startswith("rotor_") and means.endswith(" k") and look.sub in {("k",), ("i",), ("j",)}:
        yield latex_of(look), means.removesuffix("k") + look.sub[0]
        return
    if means.startswith("inertia ") and look.sub in places.frames and look.sub not in places.points:
        yield latex_of(replace(look, sub=("<F>",))), f"{means} in <F>"
        return
    if "<P>" in means:
        yield from ((latex_of(g), means) for g in _open(look, places))
        return
    yield latex_of(look), means
    yield from _general(look, means, places)


def _open(look: Look, places: Places) -> Iterator[Look]:
    """Yield the pattern in which the last label that is a capital, and no frame, is any point."""
    for corner in ("sub", "sup"):
        labels: Labels = getattr(look, corner)
        if labels and _NAME.fullmatch(labels[-1]) and labels[-1:] not in places.frames:
            new = (*labels[:-1], "<P>")
            yield replace(look, sub=new) if corner == "sub" else replace(look, sup=new)
            return


def _general(look: Look, means: str, places: Places) -> Iterator[tuple[str, str]]:
    """Yield a pattern with slots for the labels that name frames and points of the meaning."""
    words, free = means.split(), {"F": iter("FG"), "P": iter("PQ")}
    tables = {"F": places.frames, "P": places.points}

    def slotted_label(label: str) -> str:
        kind = next((k for k, t in tables.items() if t.get((label,)) in words[1:]), "")
        slot = next(free[kind], "") if kind else ""
        if slot:
            name = tables[kind][label,]
            words[1:] = [f"<{slot}>" if w == name else w for w in words[1:]]
        return f"<{slot}>" if slot else label

    sub, sup, presub, presup = (tuple(map(slotted_label, c)) for c in look.corners)
    general = replace(look, sub=sub, sup=sup, presub=presub, presup=presup)
    if general != look and not means.startswith("="):
        yield latex_of(general), " ".join(words)
    elif means.startswith("=") and look.presup and look.sup:
        yield from _between(look, means, places)


def _between(look: Look, means: str, places: Places) -> Iterator[tuple[str, str]]:
    """Yield the pattern of a formula for any two frames, where labels on the left and above name two."""
    frame, other = look.presup, look.sup
    if frame in places.frames and other in places.frames:
        formula = means.replace(f"{{}}^{{{frame[0]}}}", "{}^{<F>}").replace(
            f"^{{{other[0]}}}", "^{<G>}"
        )
        formula = formula.replace(rf"\right)_{{{frame[0]}}}", r"\right)_{<F>}")
        yield latex_of(replace(look, presup=("<F>",), sup=("<G>",))), formula
