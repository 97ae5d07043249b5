r"""The lexicon of a note: what its symbols, frames and points stand for, and in which part of it.

A TOML file beside the note, or front matter between lines of ``+++`` (there in a table ``check``):

    preset = "arrow-tilde"        # what follows is added to it, and goes before it
    [notation]                    # see `Notation`
    [frames]                      # '\mathcal{B}' = "B"
    [points]                      # 'G' = "C"
    [marks]                       # raised marks that are derivatives: bullet = "I"; prime = "" is none
    [symbols]                     # '\vec{H}_{<P>}' = "angular_momentum body <P>"
    [system]                      # what scalar lines are about, or: system = "heavy-top"
    is = "heavy-top"              # a ready scene, a scene file beside the note, a system by name
    attitude = "3-1-3"            # other attitude coordinates than the scene's
    assume = ["I1 = I2"]          # of what may be assumed of it
    [system.symbols]              # 'A' = "I1"; what is spelt as the system prints it needs no entry
    [[scope]]                     # from here on, and within this part alone
    heading = "Rigid bodies"      # a heading of the note, or: after = "a phrase of the note"
    assume = ["rigid"]            # what this part takes for granted; at the top: the whole note
    laws = ['v_2 = -e v_1']       # what ties scalars of the lexicon together, or a vector to others
    [scope.symbols]               # a scope may also have frames, points, and a system of its own
    [scope.system]                # in the place of any other: a solid, a scene, a tree (below)
    is = "cone"

Slots of patterns: ``<F>``, ``<G>`` any frame, ``<P>``, ``<Q>`` any point, ``<i>``, ``<j>`` the index
of a particle, ``<k>``, ``<l>`` an axis, ``<c>`` a letter that runs over the coordinates of a system.

What a symbol of a note stands for: a quantity with its labels, in words of a lexicon.

``position dm C``, ``angular_velocity <F> <G>``, ``inertia C in B``, ``torque body C in B component 1``,
``force dm per volume``, ``= \dot{\vec r}`` (another formula of the note), ``defined`` (by the note
itself). A word in angle brackets is what stood in that place of the pattern.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from eom.checker.mean.dimensions import dimension
from eom.checker.read.symbol_shape import Labels, Look
from eom.errors import InputError, unknown_name
from eom.terms.terms import DYADIC, INDICES, INERTIAL, MATRIX, SCALAR, VECTOR
from eom.terms.vocabulary import QUANTITIES
from eom.worlds.worlds import SEQUENCES, sequence_of

if TYPE_CHECKING:
    from eom.checker.mean.model import Model

OWN: dict[str, int] = {
    "defined": 0,
    "equals": 0,
    "vectrix": 1,
    "time": 0,
    "skew": 0,
    "system": 1,
    "turn": 1,
    "active_turn": 1,
    "quaternion": 2,
    "quaternion_last": 2,
    "velocity": 3,
    "acceleration": 3,
    "quaternion_left": 0,
    "quaternion_right": 0,
    "omega_matrix": 0,
    "xi_matrix": 0,
    "spatial_cross": 0,
    "spatial_cross_dual": 0,
}
"""Meanings of the checker alone, with their number of labels; see `TABLED` for matrices.

``defined``: by the first equation of the note that has it alone on one side; ``equals``: what a
formula says; ``vectrix``: the column of the unit vectors of a frame; ``skew``: a function, S(a);
``system``: a quantity of the system that the note is about, by its name;
``turn``: a function, the rotation of components that turning the frame about an axis brings,
``active_turn``: its inverse; ``quaternion``, ``quaternion_last``: the column of the Euler parameters of
a frame in another one, the scalar first or last; ``velocity``, ``acceleration``: of a point relative to
another one, as seen in a frame; functions, where the notation says what a product of
quaternions is: ``quaternion_left``, ``quaternion_right``, the matrices by which L(p) q = R(q) p is that,
``omega_matrix``, ``xi_matrix``, those of 2 q' = Omega(w) q = Xi(q) w; the matrices of the cross products of
spatial vectors: ``spatial_cross``, ``spatial_cross_dual``.
"""
RATES: dict[str, int] = {"velocity": 1, "acceleration": 2}
"""Meanings that are derivatives of a position, with their order."""

MATRICES: dict[str, tuple[int, ...]] = {
    "coordinates": (),
    "mass_matrix": (),
    "coriolis_matrix": (),
    "gravity_column": (),
    "force_column": (),
    "place": (1,),
    "jacobian": (1,),
}
"""Columns and matrices of the note's system, with their number of labels.

Its coordinates q; M(q) of its kinetic energy; C(q, q') by Christoffel's symbols; the slopes of its
potential energy; its generalised forces; the place of a body by components, and the slopes of that
(``jacobian tip component 1 2``).
"""

FREE: dict[str, tuple[int, ...]] = {"function": (1,), "column": (2,), "matrix": (3,)}
"""What is any: name and size, ``column q 2``, ``matrix K 2 2 constant``.

With ``of q`` functions of the entries of a column, or of coordinates by their names: ``function V of q``.
"""
TRAITS = frozenset({"constant", "symmetric", "skew", "diagonal", "identity"})
"""What may be said of them behind their size."""
TABLED = frozenset({*MATRICES, *FREE})
MAX_ROWS = 6

MAX_FORMULA = 1000
SLOT = re.compile(r"<([A-Za-z])>")
_KEYWORDS = ("in", "component", "per", "unit", "of")


@dataclass(frozen=True)
class Meaning:
    """A quantity (a row of `QUANTITIES` or `OWN`) with its labels, and how it is taken.

    ``frame``: components in it; ``component``: their numbers; ``density``: for each unit of volume;
    ``formula``: the LaTeX of ``equals``; ``function``: an argument in brackets may follow; ``unit``:
    of what has none of its own; ``of``: what a matrix is a function of.
    """

    quantity: str
    labels: tuple[str, ...] = ()
    frame: str = ""
    component: tuple[str, ...] = ()
    density: bool = False
    formula: str = ""
    function: bool = False
    unit: str = ""
    of: tuple[str, ...] = ()

    def filled(self, bound: Mapping[str, str], written: Mapping[str, str] | None = None) -> Meaning:
        """Return the meaning with every slot replaced by what is bound to it.

        ``written``: what stands for it in a formula, where frames and points have the note's labels.
        """
        if not bound:
            return self

        def fill(text: str, names: Mapping[str, str] = bound) -> str:
            return SLOT.sub(lambda m: names.get(m[1], m[0]), text)

        return replace(
            self,
            labels=tuple(map(fill, self.labels)),
            frame=fill(self.frame),
            component=tuple(map(fill, self.component)),
            formula=fill(self.formula, {**bound, **(written or {})}),
        )

    @property
    def words(self) -> str:
        """The meaning as a lexicon spells it."""
        if self.quantity == "equals":
            return f"= {self.formula}"
        parts = [self.quantity, *self.labels]
        for word, of in (("in", (self.frame,)), ("component", self.component)):
            parts += [word, *of] if any(of) else []
        return " ".join([*parts, *(["per", "volume"] if self.density else [])])

    @property
    def kind(self) -> str:
        """What the quantity is, before components are taken; a scalar where that is not known."""
        known = QUANTITIES.get(self.quantity)
        return known.kind if known is not None else VECTOR if self.quantity in RATES else SCALAR

    @property
    def slots(self) -> frozenset[str]:
        """Letters of the slots that are used."""
        texts = (*self.labels, self.frame, *self.component, self.formula)
        return frozenset(letter for t in texts for letter in SLOT.findall(t))


_KEYS = {"is": str, "equals": str, "unit": str, "function": bool}


def meaning(value: Any, where: str) -> Meaning:
    """Return the meaning that an entry spells: a text, or a table with ``is`` or ``equals``.

    Raises `InputError` for everything else.

    >>> meaning("inertia C in B", "").frame
    'B'
    """
    if isinstance(value, str):
        return _worded(value, where)
    if not isinstance(value, Mapping):
        raise InputError("not a meaning", where=where, got=value, expected="a text or a table")
    for key, given in value.items():
        if key not in _KEYS:
            raise unknown_name("key", str(key), _KEYS, where)
        if not isinstance(given, _KEYS[key]):
            raise InputError(
                f"{key} is of the wrong type", where=where, got=given, expected=_KEYS[key].__name__
            )
    if ("is" in value) == ("equals" in value):
        raise InputError("a meaning takes one of is and equals", where=where, got=dict(value))
    unit = value.get("unit", "")
    dimension(unit, where)
    found = _worded(value["is"], where) if "is" in value else _formula(value["equals"], where)
    return replace(found, unit=unit or found.unit, function=value.get("function", found.function))


def _formula(text: str, where: str) -> Meaning:
    if not text.strip():
        raise InputError("an empty formula", where=where)
    if len(text) > MAX_FORMULA:
        raise InputError("a formula is too long", where=where, expected=f"at most {MAX_FORMULA}")
    return Meaning("equals", formula=text.strip())


def _worded(text: str, where: str) -> Meaning:
    if text.lstrip().startswith("="):
        return _formula(text.lstrip()[1:], where)
    words = text.split()
    if not words:
        raise InputError("an empty meaning", where=where, expected="such as position dm C")
    parts = _parted(words[1:], where)
    found = Meaning(
        words[0],
        tuple(parts[""]),
        frame=" ".join(parts["in"]),
        component=tuple(parts["component"]),
        density=parts["per"] == ["volume"],
        unit=" ".join(parts["unit"]),
        of=tuple(parts["of"]),
    )
    _check(found, parts, where)
    return found


def _parted(words: list[str], where: str) -> dict[str, list[str]]:
    """Divide words at the keywords."""
    parts: dict[str, list[str]] = {"": [], **{k: [] for k in _KEYWORDS}}
    current = ""
    for word in words:
        if word in _KEYWORDS:
            if parts[word]:
                raise InputError(f"{word} stands twice", where=where, got=" ".join(words))
            current = word
        else:
            parts[current].append(word)
    if parts["per"] not in ([], ["volume"]):
        raise InputError("per what?", where=where, got=" ".join(words), expected="per volume")
    return parts


def _check(found: Meaning, parts: Mapping[str, list[str]], where: str) -> None:
    name = found.quantity
    if name in TABLED:
        _check_table(found, where)
        return
    if name not in QUANTITIES and name not in OWN:
        raise unknown_name("quantity", name, [*QUANTITIES, *OWN, *sorted(TABLED)], where)
    wanted = QUANTITIES[name].words.count("{") if name in QUANTITIES else OWN[name]
    if len(found.labels) != wanted:
        says = (
            QUANTITIES[name].words.format("(1)", "(2)", "(3)", "(4)")
            if name in QUANTITIES
            else name
        )
        raise InputError(
            f"wrong number of labels of {name}",
            where=where,
            got=" ".join(found.labels) or "none",
            expected=f"{wanted}, for: {says}",
        )
    if name == "turn_angle" and sequence_of(found.labels[1]) not in SEQUENCES:
        known = ", ".join(SEQUENCES.values())
        raise InputError("unknown axes of turns", where=where, got=found.labels[1], expected=known)
    if len(parts["in"]) > 1:
        raise InputError("components are in one frame", where=where, got=" ".join(parts["in"]))
    _check_components(found, found.kind, where)
    if found.unit:
        dimension(found.unit, where)


def _check_table(found: Meaning, where: str) -> None:
    """Raise `InputError` for a matrix without a size, with other traits, or more components than three."""
    wanted = {**MATRICES, **FREE}[found.quantity] or (0,)
    count, traits = wanted[0], found.labels[wanted[0] :]
    sizes = found.labels[1:count]
    named = len(found.labels) >= count and (found.quantity in FREE or not traits)
    sized = all(n.isdecimal() and 0 < int(n) <= MAX_ROWS for n in sizes)
    numbered = set(found.component) <= set(AXES) and not found.frame
    if not (named and sized and numbered and TRAITS.issuperset(traits)):
        got = " ".join((*found.labels, *found.component))
        raise InputError(
            f"not a {found.quantity}", where=where, got=got, expected=_SHOWN[found.quantity]
        )
    if found.unit:
        dimension(found.unit, where)


_SHOWN = {
    **{name: name for name in MATRICES},
    **{name: f"{name} BODY component 1 2" for name in ("place", "jacobian")},
    "function": "function V of q",
    "column": "column q 2, or column a 2 constant",
    "matrix": "matrix M 2 2, and some of constant, symmetric, skew, diagonal, identity",
}


def _check_components(found: Meaning, kind: str, where: str) -> None:
    count = {VECTOR: 1, DYADIC: 2}.get(kind, 0)
    bare = kind == MATRIX and len(found.component) == 2
    if found.frame and not count:
        raise InputError(f"{found.quantity} has no components in a frame", where=where, got=kind)
    if found.component and not bare and (len(found.component) != count or not found.frame):
        raise InputError(
            f"wrong components of {found.quantity}",
            where=where,
            got=" ".join(found.component),
            expected=f"in FRAME component and {count} number(s)" if count else "none",
        )
    bad = [c for c in found.component if c not in {"1", "2", "3"} and not SLOT.fullmatch(c)]
    if bad:
        raise InputError("components are 1, 2, 3", where=where, got=bad[0])


PLACED = "placed"
"""How a label in fraktur begins that is the name of a frame or point itself, whatever the note calls so."""

AXES = {"1": "1", "2": "2", "3": "3", "x": "1", "y": "2", "z": "3"}


QUATERNION_PRODUCTS = ("hamilton first", "hamilton last", "shuster first", "shuster last")
"""Products of quaternions: Hamilton's, i j = k, or the one in the other order; with the scalar's place."""
BRACKETS = {"q p": 1, "p q": -1}
"""Poisson brackets by the pair of a coordinate and its momentum whose bracket is 1, with their sign."""
SPATIAL_ORDERS = ("angular first", "linear first")
"""Halves of spatial vectors: of motions, with the moment of forces in the place of the angular one."""


@dataclass(frozen=True)
class Notation:
    """How a note writes operations.

    ``dot``: frame of overdots on vectors, and of derivatives that name none; ``mixed``: frame in
    whose components vectors may stand beside columns and matrices ("": nowhere); ``skew``: accents
    that make a skew matrix; ``dyads``: vectors side by side are a dyadic; ``juxtaposed``: a dyadic
    acts on a vector beside it without a dot; ``resolved``: a frame as last label below a vector is
    that of its components; ``bracketed``: two frames in square brackets are the rotation of components
    from the second to the first; ``marks``: raised marks that are derivatives, with their frames;
    ``alike``: (style, accents) that mean the same, the first stands for all; ``quaternions``: how they
    are multiplied, and where the scalar stands ("hamilton first"), see `QUATERNION_PRODUCTS`;
    ``spatial``: which half of spatial vectors stands on top, see `SPATIAL_ORDERS`; ``brackets``: which
    sign Poisson brackets have, see `BRACKETS`.
    """

    dot: str = INERTIAL
    mixed: str = ""
    skew: tuple[str, ...] = ()
    dyads: bool = False
    juxtaposed: bool = True
    resolved: bool = False
    bracketed: bool = False
    quaternions: str = ""
    spatial: str = ""
    brackets: str = ""
    marks: Mapping[str, str] = field(default_factory=dict)
    alike: tuple[tuple[tuple[str, tuple[str, ...]], ...], ...] = ()

    def plain(self, look: Look) -> Look:
        """Return the look in the first of the nuclei that mean the same."""
        for nuclei in self.alike:
            if (look.style, look.accents) in nuclei:
                style, accents = nuclei[0]
                return replace(look, style=style, accents=accents)
        return look


@dataclass(frozen=True)
class Entry:
    """A pattern, its meaning, the LaTeX it was read from, and where it stands."""

    look: Look
    meaning: Meaning
    latex: str
    where: str = ""

    @property
    def slots(self) -> int:
        """How many slots the pattern has; the fewer, the more it says."""
        return sum(bool(SLOT.fullmatch(w)) for corner in self.look.corners for w in corner)


@dataclass(frozen=True)
class Scope:
    """A part of the note, under a heading or after a phrase, with entries of its own.

    ``system``: what its scalar lines are about, in the place of the note's; ``spelt``: entries for its
    quantities, in layers; ``assume``: names of assumptions that hold there; ``laws``: equations that do.
    """

    heading: str
    after: str
    entries: tuple[Entry, ...]
    frames: Mapping[Labels, str]
    points: Mapping[Labels, str]
    system: Model | None = field(default=None, compare=False)
    spelt: tuple[tuple[Entry, ...], ...] = ()
    assume: tuple[str, ...] = ()
    laws: tuple[str, ...] = ()

    def holds(self, headings: Iterable[str], passed: Container[str]) -> bool:
        """Return whether a place is in this part; ``passed``: phrases that stand before it."""
        inside = not self.heading or any(_same(self.heading, h) for h in headings)
        return inside and (not self.after or self.after in passed)


@dataclass(frozen=True)
class Lexicon:
    """Notation, frames and points by labels, entries in layers: what comes first goes first.

    ``system``: what scalar lines are about, if the note says so; ``assume``: names of assumptions that
    hold; ``laws``: equations that do; ``own_laws``: those of all parts that hold in a place, each with
    the lexicon that it is written in; ``tied``: what they make of free quantities, see
    `eom.checker.mean.parameters.tied`; ``moving_data``: what it declares to move, ``moving``: its meaning,
    see `eom.checker.mean.moving`.
    """

    notation: Notation = field(default_factory=Notation)
    frames: Mapping[Labels, str] = field(default_factory=dict)
    points: Mapping[Labels, str] = field(default_factory=dict)
    layers: tuple[tuple[Entry, ...], ...] = ()
    scopes: tuple[Scope, ...] = ()
    system: Model | None = field(default=None, compare=False)
    assume: tuple[str, ...] = ()
    laws: tuple[str, ...] = ()
    own_laws: tuple[tuple[Lexicon, tuple[str, ...]], ...] = ()
    tied: Mapping[tuple[str, ...], Any] = field(default_factory=dict, compare=False)
    moving_data: Mapping[str, Any] = field(default_factory=dict, compare=False)
    moving: Any = field(default=None, compare=False)

    def at(self, headings: Sequence[str] = (), passed: Container[str] = ()) -> Lexicon:
        """Return what holds under some headings, after some of the phrases that begin scopes."""
        here = replace(self, scopes=(), own_laws=((self, self.laws),))
        for scope in self.scopes:
            if scope.holds(headings, passed):
                here = here.within(scope)
        return here

    def within(self, scope: Scope) -> Lexicon:
        """Return the lexicon with what a part of the note adds; its system takes the place of another."""
        other = self if scope.system is None else self.without_system()
        found = replace(
            other,
            frames={**self.frames, **scope.frames},
            points={**self.points, **scope.points},
            layers=(scope.entries, *scope.spelt, *other.layers),
            system=scope.system or self.system,
            assume=(*self.assume, *scope.assume),
        )
        return replace(found, own_laws=(*self.own_laws, (found, scope.laws)))

    def without_system(self) -> Lexicon:
        """Return the lexicon in which no symbol is a quantity of the note's system."""

        def others(entries: tuple[Entry, ...]) -> tuple[Entry, ...]:
            return tuple(e for e in entries if e.meaning.quantity != "system")

        return replace(self, layers=tuple(map(others, self.layers)), system=None)

    @cached_property
    def _entries(self) -> Mapping[tuple[Any, ...], list[Entry]]:
        """Entries by letter, style and accents, in the order in which they are looked at."""
        found: dict[tuple[Any, ...], list[Entry]] = {}
        for entry in (e for layer in self.layers for e in sorted(layer, key=lambda e: e.slots)):
            found.setdefault(_nucleus(entry.look), []).append(entry)
        return found

    def find(self, look: Look, indices: Mapping[str, str] | None = None) -> Found | None:
        """Return the meaning of a look; ``indices`` says what bound indices stand for."""
        look = self.notation.plain(look)
        for entry in self._entries.get(_nucleus(look), ()):
            bound = self._match(entry.look, look, indices or {})
            if bound is not None:
                meaning = entry.meaning.filled(bound, self._written(bound))
                return Found(look, meaning, entry, bound)
        other = look.numbered(indices or {})
        return None if other == look else self.find(other)

    def names_behind(self, look: Look) -> bool:
        """Return whether symbols that look like this have names in brackets behind them."""
        return any("(" in e.look.sub for e in self._entries.get(_nucleus(look), ()))

    def frame(self, given: Labels) -> str | None:
        """Return the frame that labels name, or None."""
        return _named(self.frames, given)

    def point(self, given: Labels) -> str | None:
        """Return the point that labels name, or None."""
        return _named(self.points, given)

    def has_vector(self, look: Look) -> bool:
        """Return whether a vector is written in the style and with the accents of a look."""
        vectors = (e.look for layer in self.layers for e in layer if e.meaning.kind == VECTOR)
        return any((v.style, v.accents) == (look.style, look.accents) for v in vectors)

    def known(self, name: str) -> tuple[str, ...]:
        """Return the patterns with a letter, for messages."""
        entries = (e for layer in self.layers for e in layer)
        return tuple(dict.fromkeys(e.latex for e in entries if e.look.name == name))

    def renamed(self, old: Mapping[str, str], new: Mapping[str, str]) -> dict[str, str]:
        """Return by what frames and points are exchanged where slots stand for others.

        A label of the note that names a frame and a point, as its origin, takes both along.
        """
        names = {old[s]: new[s] for s in old if s in "FGPQ"}
        both = (self.frames, self.points)
        called = {v: k for table in both for k, v in table.items()}
        for a, b in tuple(names.items()):
            for table in both:
                first, second = (table.get(called.get(w, ())) for w in (a, b))
                if first and second:
                    names.setdefault(first, second)
        return names

    def _written(self, bound: Mapping[str, str]) -> dict[str, str]:
        """Return frames and points as they stand in formulas: marked where the note calls another so."""
        placed = {s: name for s, name in bound.items() if s in "FGPQ"}
        other = {s: n for s, n in placed.items() if self.resolved(s, tuple(n), {}) != n}
        return {s: rf"\mathfrak{{{PLACED}{name}}}" for s, name in other.items()}

    def _match(
        self, pattern: Look, look: Look, indices: Mapping[str, str]
    ) -> dict[str, str] | None:
        bound: dict[str, str] | None = {}
        for wanted, given in zip(pattern.corners, look.corners, strict=True):
            if bound is not None:
                bound = self._corner(wanted, given, bound, indices)
        return bound

    def _corner(
        self, pattern: Labels, given: Labels, bound: dict[str, str], indices: Mapping[str, str]
    ) -> dict[str, str] | None:
        """Match a corner; a slot takes as many words as make one name."""
        if not pattern:
            return None if given else bound
        slot = SLOT.fullmatch(pattern[0])
        if slot is None:
            same = bool(given) and pattern[0] in {given[0], indices.get(given[0])}
            return self._corner(pattern[1:], given[1:], bound, indices) if same else None
        for n in range(1, min(len(given), 8) + 1):
            name = self.resolved(slot[1], given[:n], indices)
            if name is not None and bound.get(slot[1], name) == name:
                found = self._corner(pattern[1:], given[n:], {**bound, slot[1]: name}, indices)
                if found is not None:
                    return found
        return None

    def resolved(self, slot: str, given: Labels, indices: Mapping[str, str]) -> str | None:
        """Return the frame, point, index or axis that labels name, or None."""
        if slot in "FGPQ":
            return _named(self.frames if slot in "FG" else self.points, given)
        word = indices.get(given[0], given[0]) if len(given) == 1 else ""
        if slot == "c":
            count = 0 if self.system is None else len(self.system.coordinates)
            known = given[0] in indices and word.isdigit() and int(word) <= count
            return word if known else None
        if slot in "ij":
            return word if word in INDICES - {"dm"} else None
        return AXES.get(word)


@dataclass(frozen=True)
class Found:
    """What a look means, the entry that says so, and what stands in the places of its slots."""

    look: Look
    meaning: Meaning
    entry: Entry
    bound: Mapping[str, str] = field(default_factory=dict)


def _named(names: Mapping[Labels, str], given: Labels) -> str | None:
    """Return the name of labels; a name of the house stands for itself if nothing else does."""
    own = "".join(given)
    placed = f"frak {PLACED}"
    if own.startswith(placed):
        return own.replace(placed, "")
    return names.get(given, own if own in names.values() else None)


def _nucleus(look: Look) -> tuple[str, str, tuple[str, ...], bool]:
    return look.name, look.style, look.accents, look.called


def _folded(text: str) -> str:
    return " ".join(text.split()).casefold()


def _same(wanted: str, heading: str) -> bool:
    return _folded(wanted).strip("# ") == _folded(heading).strip("# ")


_PLACES = frozenset("rR")
"""Letters of vectors that lead to the first of two points from the second, with a stroke between them."""
_ARROWS = frozenset({"vec", "underline", "bar", "harpoon"})
"""Accents over the letters of two points."""


def between_points(lexicon: Lexicon, look: Look) -> tuple[str, str] | None:
    r"""Return the points that a vector leads to and from: ``\overrightarrow{AB}``, ``\mathbf{r}_{B/A}``.

    What is no arrow is the sign of a vector where the lexicon has one that carries it.
    """
    notation, pair = lexicon.notation, look.style != "" and len(look.name) > 1
    words = tuple(look.name) if pair else look.sub or look.sup
    beside = bool(look.accents) and not look.name and not look.sup
    if beside and not _ARROWS.issuperset(look.accents):
        return None
    if look.presub or look.presup or (look.sub and (look.sup or pair)):
        return None
    if not pair and not beside and not (look.name in _PLACES and "/" in words):
        return None
    dressed = replace(Look("", look.style, look.accents))
    if "vec" not in look.accents and not lexicon.has_vector(notation.plain(dressed)):
        return None
    found = [(words[:k], words[k:]) for k in range(1, len(words))]
    if not pair and not beside:
        place = words.index("/")
        found = [(words[place + 1 :], words[:place])]
    for start, end in found:
        origin, of = lexicon.point(start), lexicon.point(end)
        if origin is not None and of is not None:
            return of, origin
    return None
