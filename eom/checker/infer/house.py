r"""Which preset goes with what the words of a note say: the one under which most lines can be read.

Lines are read as claims, none is judged: what is ill-formed, of unlike dimensions or without a meaning
counts. A meaning that words give goes before one of a preset.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from eom.checker.infer.shown import bare, symbols_of
from eom.checker.mean.claims import claims, defined
from eom.checker.mean.lexicon import FREE, Lexicon
from eom.checker.mean.lexicon_files import PRESETS, lexicon_of, preset
from eom.checker.mean.values import UNDECIDED, Value
from eom.checker.read.statements import Formula, Statement
from eom.checker.read.symbol_shape import Look
from eom.worlds.worlds import ANGLES

Tables = Mapping[str, Mapping[str, str]]
"""Frames, points and symbols of a draft: meanings by their LaTeX."""


@dataclass(frozen=True)
class Fit:
    """How much of a note a lexicon leaves: ill-formed lines, lines and places without a meaning."""

    ill: int
    open: int
    left: int

    @property
    def cost(self) -> int:
        """What the choice of a lexicon makes small."""
        return self.ill + self.open


def drafted(name: str, tables: Tables, parts: Sequence[Mapping[str, object]] = ()) -> Lexicon:
    """Return a lexicon on a preset, or none; ``parts``: its scopes. Raises `InputError` for bad entries."""
    own = {"scope": list(parts)} if parts else {}
    return lexicon_of({**({"preset": name} if name else {}), **tables, **own}, "draft")[0]


def fit(formulas: Iterable[Formula], lexicon: Lexicon) -> Fit:
    """Return what a lexicon leaves of the displays of a note."""
    known: dict[Look, Value] = {}
    ill = left = places = 0
    read = _Letters(lexicon, _KEPT.get())
    for formula in formulas:
        for statement in formula.statements if formula.piece.kind == "display" else ():
            verdicts, new, unknown = read.said(statement, known)
            ill += any(v != UNDECIDED for v in verdicts)
            left += UNDECIDED in verdicts
            places += verdicts.count(UNDECIDED) + (unknown if UNDECIDED in verdicts else 0)
            known |= new
    return Fit(ill, left, places)


Spoken = tuple[tuple[str, ...], Mapping[Look, Value], int]
"""The verdicts of all that is found in a statement by its kinds, what it defines, its unknown symbols."""


@dataclass
class _Kept:
    """What statements say, by the entries and definitions that their letters have; the letters of texts."""

    found: dict[tuple[Any, ...], tuple[Statement, Spoken]] = field(default_factory=dict)
    letters: dict[int | str, frozenset[str]] = field(default_factory=dict)
    numbers: dict[Any, int] = field(default_factory=dict)

    def of(self, key: int | str, what: Any) -> frozenset[str]:
        """Return the letters and names in a text, or in what is written out."""
        if key not in self.letters:
            self.letters[key] = frozenset(re.findall("[A-Za-z]+|[0-9]+", repr(what)))
        return self.letters[key]

    def number(self, what: Any) -> int:
        """Return the same number for the same thing."""
        return self.numbers.setdefault(what, len(self.numbers))


_KEPT: ContextVar[_Kept | None] = ContextVar("kept", default=None)


@contextmanager
def kept() -> Iterator[None]:
    """Read each statement inside once for all lexica that say the same of its letters."""
    token = _KEPT.set(_Kept())
    try:
        yield
    finally:
        _KEPT.reset(token)


_EVERYWHERE = frozenset({"position", *ANGLES, *FREE})
"""Quantities whose entries are looked for without their letters."""


@dataclass
class _Letters:
    """A lexicon that reads statements; with ``kept`` none again that it says nothing new of."""

    lexicon: Lexicon
    kept: _Kept | None

    def said(self, statement: Statement, known: Mapping[Look, Value]) -> Spoken:
        """Return what a statement says beside what is defined before it."""
        if not statement.relational:
            return (), {}, 0
        if self.kept is None or self.lexicon.system is not None or self.lexicon.moving is not None:
            return self._read(statement, known)
        key = self._key(statement, known, self.kept)
        if key not in self.kept.found:
            self.kept.found[key] = (statement, self._read(statement, known))
        return self.kept.found[key][1]

    def _read(self, statement: Statement, known: Mapping[Look, Value]) -> Spoken:
        found = claims(statement, self.lexicon, known)
        verdicts = tuple(f.verdict for c in found for f in c.findings)
        return verdicts, defined(found), self._unknown(statement, known)

    def _unknown(self, statement: Statement, known: Mapping[Look, Value]) -> int:
        """Return how many symbols of a statement have no meaning."""
        looks = {
            k for n in symbols_of(statement.members) if (k := bare(n, self.lexicon)) is not None
        }
        return sum(k not in known and self.lexicon.find(k) is None for k in looks)

    def _key(
        self, statement: Statement, known: Mapping[Look, Value], kept: _Kept
    ) -> tuple[Any, ...]:
        """Return all that the reading of a statement rests on."""
        letters = kept.of(id(statement), statement)
        every = self._reached(letters, kept)
        rows = tuple(n for name, n, _ in self._entries if name in every or not name)
        values = tuple((k, id(v)) for k, v in known.items() if every & kept.of(k.name, k.name))
        return id(statement), self._frame, rows, values

    def _reached(self, letters: frozenset[str], kept: _Kept) -> frozenset[str]:
        """Return letters with those of the formulas that they stand for."""
        while True:
            formulas = (f for name, _, f in self._entries if f and name in letters)
            more = letters.union(*(kept.of(f, f) for f in formulas))
            if more == letters:
                return letters
            letters = more

    @cached_property
    def _frame(self) -> int:
        """The number of what is the same for all statements."""
        one, kept = self.lexicon, self.kept or _Kept()
        tables = (tuple(one.frames.items()), tuple(one.points.items()))
        return kept.number((repr(one.notation), *tables, one.assume, one.laws))

    @cached_property
    def _entries(self) -> tuple[tuple[str, int, str], ...]:
        """Its entries: the letter, "" for those that are looked for without it; a number; the formula."""
        kept = self.kept or _Kept()
        return tuple(
            (
                "" if e.meaning.quantity in _EVERYWHERE else e.look.name,
                kept.number((k, e.latex, e.meaning)),
                e.meaning.formula,
            )
            for k, layer in enumerate(self.lexicon.layers)
            for e in layer
        )


def houses(
    formulas: tuple[Formula, ...],
    tables: Tables,
    looks: Iterable[Look],
    added: Callable[[Lexicon], Lexicon],
    names: Iterable[str] = PRESETS,
) -> tuple[tuple[str, Lexicon], ...]:
    """Return presets with their lexica, those under which a draft leaves fewest lines and symbols in front.

    ``added``: puts the note's system into a lexicon; ``names``: what is tried; no preset is ``""``, which
    goes before one that says no more.
    """
    looks = tuple(looks)
    tried = []
    for number, name in enumerate(names):
        lexicon = added(drafted(name, tables))
        unknown = sum(lexicon.find(k) is None for k in looks)
        own = sum(preset(name).find(k) is not None for k in looks) if name else len(looks)
        tried.append((fit(formulas, lexicon).cost + unknown, -own, number, name, lexicon))
    return tuple((name, best) for *_, name, best in sorted(tried, key=lambda t: t[:3]))
