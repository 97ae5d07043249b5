r"""Which preset goes with what the words of a note say: the one under which most lines can be read.

Lines are read as claims, none is judged: what is ill-formed, of unlike dimensions or without a meaning
counts. A meaning that words give goes before one of a preset.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from eom.checker.mean.claims import claims, defined
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import PRESETS, lexicon_of, preset
from eom.checker.mean.values import UNDECIDED, Value
from eom.checker.read.statements import Formula
from eom.checker.read.symbol_shape import Look

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
    for formula in formulas:
        for statement in formula.statements:
            found = claims(statement, lexicon, known) if statement.relational else ()
            if formula.piece.kind == "display":
                verdicts = {f.verdict for c in found for f in c.findings}
                ill += bool(verdicts - {UNDECIDED})
                left += UNDECIDED in verdicts
                places += sum(f.verdict == UNDECIDED for c in found for f in c.findings)
                known |= defined(found)
    return Fit(ill, left, places)


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
