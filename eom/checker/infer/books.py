r"""What letters stand for in the usual books, where neither words nor the preset say.

A meaning of a book is taken only if no fewer lines of the note make sense with it: of several the one that
leaves least, in the order of custom.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from importlib.resources import files

from eom.checker.infer.house import Tables, drafted, fit
from eom.checker.infer.letters import indexed, rate, turning
from eom.checker.infer.sayings import look_of
from eom.checker.infer.shown import operands, operands_of
from eom.checker.mean.lexicon import AXES, Lexicon
from eom.checker.mean.lexicon_files import lexicon_of
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import Formula
from eom.checker.read.symbol_shape import Look
from eom.checker.read.syntax import Node
from eom.checker.read.writing import latex_of
from eom.terms.terms import VECTOR


@dataclass(frozen=True)
class Row:
    """Letters with a mark and labels, and what they stand for in order of custom."""

    letters: frozenset[str]
    mark: str
    labels: str
    means: tuple[str, ...]


@cache
def rows() -> tuple[Row, ...]:
    """Return the table."""
    data = tomllib.loads((files(__package__) / "books.toml").read_text(encoding="utf-8"))["rows"]
    return tuple(
        Row(frozenset(w.lstrip("\\") for w in r[0].split()), r[1], r[2], tuple(r[3:])) for r in data
    )


TOPICS: Mapping[str, tuple[re.Pattern[str], tuple[str, ...]]] = {
    "wheels": (
        re.compile(r"\b(?:rotors?|wheels?|flywheels?|gyrostats?|momentum device)\b", re.IGNORECASE),
        ("rotor_",),
    ),
    "orbits": (
        re.compile(
            r"\b(?:orbit\w*|planets?|gravitation\w*|gravity|primary|attract\w+|satellites?|earth)\b",
            re.IGNORECASE,
        ),
        ("orbit_", "gravity_parameter"),
    ),
}
"""Words by which a note is about something, with the beginnings of quantities that others do not have."""


def candidates(
    look: Look, body: str, lexicon: Lexicon, *, absent: frozenset[str] = frozenset()
) -> Iterator[tuple[str, str]]:
    """Yield patterns with meanings that books give a symbol; ``absent``: topics that the note has not."""
    marked = bool(look.accents or look.style)
    for row in rows():
        fits = row.mark == "table" or (row.mark == "vector") == marked
        if look.name not in row.letters or not fits:
            continue
        left, _, right = row.labels.rpartition("|")
        pattern = left + latex_of(Look(look.name, look.style, look.accents)) + right
        for means in row.means:
            if any(means.startswith(TOPICS[topic][1]) for topic in absent):
                continue
            words = means.replace("{body}", body)
            one, _ = lexicon_of({"symbols": {pattern: words}}, "book")
            whole = replace(lexicon, layers=one.layers)
            if whole.find(look) is not None:
                yield pattern, words


def component(look: Look, lexicon: Lexicon, looks: Iterable[Look]) -> Iterator[tuple[str, str]]:
    """Yield a component of a vector about a point, where the note has its letter with that point alone."""
    if look.accents or look.style or len(look.sub) != 1 or look.sub[0] not in AXES:
        return
    marked = (k for k in looks if k.name == look.name and (k.accents or k.style))
    same = [k for k in marked if len(k.sub) < 2]
    found = [f for k in same if (f := lexicon.find(k)) is not None and f.meaning.kind == VECTOR]
    means = {(f.meaning.quantity, *f.meaning.labels) for f in found if not f.meaning.component}
    if len(means) == 1:
        pattern = f"{latex_of(Look(look.name))}_{{<k>}}"
        yield pattern, f"{' '.join(*means)} in B component <k>"


SWEEPS = 2
MAX_ORDER = 1000
"""A number behind those of all meanings that books give a symbol."""
MAX_DEPTH = 6


def resolved(means: str, lexicon: Lexicon, of: Look, depth: int = MAX_DEPTH) -> bool:
    """Return whether all symbols of a formula have a meaning that does not rest on one of them."""
    formula = means.removeprefix("=").strip().replace("<i>", "i").replace("<k>", "1")
    tree = read_formula(formula).tree
    for look in looks_in(tree):
        found = lexicon.find(look)
        if look == of or found is None or depth == 0:
            return False
        formula = found.meaning.formula
        if formula and not resolved(formula, lexicon, of, depth - 1):
            return False
    return True


def looks_in(node: Node) -> Iterator[Look]:
    """Yield what the symbols of a formula look like."""
    look = look_of(node)
    if look is not None:
        if look.name not in {"d", "t"}:
            yield look
        return
    for child in operands(node):
        yield from looks_in(child)


@dataclass
class _Search:
    """The symbols that are looked for, what each has so far, and what may be said of it."""

    formulas: tuple[Formula, ...]
    preset: str
    tables: Tables
    body: str
    own: Mapping[Look, tuple[str, str]]
    added: Callable[[Lexicon], Lexicon]
    absent: frozenset[str] = frozenset()
    chosen: dict[Look, tuple[str, str]] = field(default_factory=dict)

    @cached_property
    def looks(self) -> frozenset[Look]:
        """The symbols of the note's displays."""
        return frozenset(
            k for f in self.formulas if f.piece.kind == "display" for k in operands_of(f)
        )

    @cached_property
    def about(self) -> str:
        """The one point about which words take all momenta and torques; "" for none or several."""
        words = (w.split() for w in self.given.values())
        found = {w[2] for w in words if w[0] in {"angular_momentum", "torque"} and len(w) > 2}
        return found.pop() if len(found) == 1 else ""

    @property
    def given(self) -> Mapping[str, str]:
        """What words say of symbols."""
        return self.tables.get("symbols", {})

    def lexicon(self, more: Mapping[str, str]) -> Lexicon:
        """Return the lexicon of preset, words and more entries."""
        tables = {**self.tables, "symbols": {**self.given, **more}}
        return self.added(drafted(self.preset, tables))

    def decide(self, look: Look) -> None:
        """Choose the meaning of a symbol that leaves least with those that the others have.

        A line may become ill-formed if more lines than that can be read: notes have slips.
        """
        others = {p: m for k, (p, m) in self.chosen.items() if k != look}
        self.chosen.pop(look, None)
        lexicon = self.lexicon(others)
        known = lexicon.find(look) is not None
        if known and look not in self.own:
            return
        here = fit(self.formulas, lexicon)
        order = -1 if known or "prime" in look.sup else MAX_ORDER
        tried = [(here.cost, here.ill, here.left, order, "", "")]
        for number, (pattern, means) in enumerate(self._candidates(look, lexicon, known)):
            new = fit(self.formulas, self.lexicon({**others, pattern: means}))
            tried.append((new.cost, new.ill, new.left, number, pattern, means))
        if min(tried)[4]:
            self.chosen[look] = min(tried)[4:]

    def _candidates(self, look: Look, lexicon: Lexicon, known: bool) -> Iterator[tuple[str, str]]:
        """Yield what the text defines a symbol by, then what books say of its letter.

        Books say nothing of a letter that words name, whatever its labels.
        """
        if look in self.own and resolved(self.own[look][1], lexicon, look):
            yield self.own[look]
        bare = lexicon.find(replace(look, sub=(), sup=(), presub=(), presup=()))
        primed = "prime" in look.sup
        if not known and (primed or bare is None or bare.entry.latex not in self.given):
            formula = rate(lexicon, look)
            if formula:
                yield indexed(look, formula)
            pattern, formula = turning(lexicon, look)
            if formula:
                yield pattern, formula
            yield from component(look, lexicon, self.looks)
            found = dict.fromkeys(candidates(look, self.body, lexicon, absent=self.absent))
            yield from sorted(found, key=lambda c: self.about not in ("", *c[1].split()[1:]))


def taken(
    formulas: tuple[Formula, ...],
    preset: str,
    tables: Tables,
    unknown: Iterable[Look],
    body: str,
    own: Mapping[Look, tuple[str, str]],
    added: Callable[[Lexicon], Lexicon],
    *,
    absent: frozenset[str] = frozenset(),
) -> Mapping[str, tuple[str, Look]]:
    """Return meanings by their patterns, each with the symbol that it was taken for.

    ``unknown``: symbols, those first that stand in most places; ``own``: what formulas of the text say;
    ``added``: puts the note's system into a lexicon; ``absent``: topics that the note is not about.
    In a second sweep each is decided again, with all others known.
    """
    search = _Search(formulas, preset, tables, body, own, added, absent)
    unknown = tuple(unknown)
    for _ in range(SWEEPS):
        for look in unknown:
            search.decide(look)
    return {pattern: (means, look) for look, (pattern, means) in search.chosen.items()}
