r"""What a verdict rests on: a meaning that words give, or one that books, letters and custom only suggest.

A meaning is sure where words or a formula of the text give it, or where two other formulas hold with it:
most lines of a note are right, and a meaning that is not meant makes them fail.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from eom.checker.infer.books import candidates, looks_in
from eom.checker.infer.draft import Proposal
from eom.checker.infer.letters import ANY, BOOKS, DISPLAY, GUESSED, LETTER
from eom.checker.infer.sayings import look_of
from eom.checker.infer.sections import TITLE
from eom.checker.infer.shown import bare, operands_of, symbols_in
from eom.checker.infer.systems import IN_A_MOTION, USUAL, Guess
from eom.checker.judge.notes import Understood, reread
from eom.checker.judge.verdicts import GRAVE
from eom.checker.mean.claims import Claim
from eom.checker.mean.lexicon import AXES, Found, Lexicon
from eom.checker.mean.lexicon_files import lexicon_of
from eom.checker.mean.values import atoms_in
from eom.checker.read.grammar import read_formula
from eom.checker.read.statements import Formula
from eom.checker.read.symbol_shape import Look, Seen, labels, seen
from eom.checker.read.syntax import Marks, Number
from eom.checker.read.writing import latex_of
from eom.terms.terms import Term
from eom.worlds.solutions import rate

PLACED = frozenset({"position", "velocity", "acceleration"})
"""Quantities of a point, seen from another."""
DECISIVE = (
    "components in different frames meet",
    "these are of different kinds",
    "this has no skew matrix",
)
"""What may be said of kinds that is false whatever the line is meant to say, if its symbols are known."""
UNFIT = (
    "these do not multiply side by side; got column",
    "these do not multiply side by side; got matrix",
)
"""What is false whatever else stands in the line, if the symbols that it is about are known."""
MARK = "mark "
"""How the entry of a raised mark is told from those of symbols."""
CENTRE = "_centre"
"""How names of what is said of the centre of a system's part end."""
LINES = 2
"""Other formulas that hold with a meaning, by which it is sure."""
MISREAD = 2
"""Formulas whose kinds do not fit what words say of a symbol while none holds: words may be misread."""
TURNS = frozenset({"turn_angle", "angle"})
"""Quantities of sequences, which differ from book to book: words or lines alone make them sure."""
TRUSTED, WHOLE = 3, 0.4
"""Lines that hold, and the share of symbols that it names, by which a preset beside words is sure."""


@dataclass(frozen=True)
class Doubt:
    """A symbol with the meaning that it was taken to have, and why that was taken.

    ``pattern``: of the entry that gives it another one.
    """

    latex: str
    meaning: str
    why: str
    pattern: str = ""


@dataclass(frozen=True)
class Evidence:
    """What speaks for the meanings of a note's symbols, by the patterns of their entries.

    ``firm``: those that words give, or a preset as a whole; ``spoken``: words alone; ``guessed``: why some
    were taken; ``meant``: what quantities of a system are; ``families``: symbols that speak for each other;
    ``bases``: symbols by which others are defined that stand for their norms, directions and components;
    ``fails``: on which meanings it rests that a formula does not fit; ``agreed``: those that words and
    preset give.
    """

    used: tuple[Mapping[str, tuple[str, str]], ...]
    hold: tuple[bool, ...]
    families: Mapping[str, str]
    firm: frozenset[str]
    guessed: Mapping[str, str]
    meant: Mapping[str, str]
    bases: Mapping[str, frozenset[str]]
    preset: str
    fails: tuple[frozenset[str], ...] = ()
    spoken: frozenset[str] = frozenset()
    agreed: frozenset[str] = frozenset()

    @cached_property
    def certain(self) -> frozenset[str]:
        """The families of which words give one, and so all; none with which lines fail and none holds."""
        said = {f for p, f in self.families.items() if p in self.firm}
        agreed = {f for p, f in self.families.items() if p in self.agreed}
        failed = Counter(
            f
            for rests in self.fails
            for f in {self.families[p] for p in rests & self.families.keys()}
        )
        return frozenset(f for f in said if self.count[f] or f in agreed or failed[f] < MISREAD)

    @cached_property
    def count(self) -> Counter[str]:
        """Formulas that hold, by the families that stand in them."""
        pairs = zip(self.used, self.hold, strict=True)
        return Counter(
            f for u, held in pairs if held for f in {self.families[p] for p in self._all(u)}
        )

    def _all(self, used: Iterable[str]) -> Iterator[str]:
        """Yield entries with those that they stand for norms or components of."""
        for pattern in used:
            yield from (pattern, *self.bases.get(pattern, ()))

    def others(self, pattern: str, number: int) -> int:
        """Return how many formulas hold with a meaning beside one formula."""
        family = self.families[pattern]
        here = any(self.families[p] == family for p in self._all(self.used[number]))
        return self.count[family] - (self.hold[number] and here)

    def is_sure(self, pattern: str, number: int) -> bool:
        """Return whether words, two other formulas, or what makes its base sure, speak for a meaning."""
        if self.guessed.get(pattern) == ANY:
            return False
        if self.families[pattern] in self.certain or self.others(pattern, number) >= LINES:
            return True
        bases = self.bases.get(pattern, frozenset())
        if self._misfits(pattern, number):
            return False
        return bool(bases) and all(self._is_base(b, number) for b in bases)

    def _misfits(self, pattern: str, number: int) -> bool:
        """Return whether a formula does not fit by what a letter says with which no other one holds."""
        here = number < len(self.fails) and pattern in self.fails[number]
        return here and self.guessed.get(pattern) == LETTER and not self.others(pattern, number)

    def _is_base(self, pattern: str, number: int) -> bool:
        """Return whether words or two other formulas speak for a symbol of which others are norms."""
        spoken = {self.families[p] for p in self.spoken & self.families.keys()} & self.certain
        deeper = self.bases.get(pattern, frozenset()) - {pattern}
        return (
            self.families[pattern] in spoken
            or self.others(pattern, number) >= LINES
            or (bool(deeper) and all(self.others(b, number) >= LINES for b in deeper))
        )

    def doubts(self, number: int) -> tuple[Doubt, ...]:
        """Return the meanings in a formula that nothing makes sure."""
        return tuple(
            Doubt(f[0], self.meant.get(p, f[1]), self.guessed.get(p, f"preset {self.preset}"))
            for p, f in self.used[number].items()
            if p in self.doubted(number)
        )

    def doubted(self, number: int) -> frozenset[str]:
        """Return the entries in a formula that nothing makes sure."""
        return frozenset(p for p in self.used[number] if not self.is_sure(p, number))

    def is_proved(self, number: int) -> bool:
        """Return whether each meaning in a formula is sure and holds in another."""
        return bool(self.used[number]) and not self.unproved(number)

    def unproved(self, number: int) -> frozenset[str]:
        """Return the entries in a formula that are not sure, or hold in no other."""
        return self.doubted(number) | {
            p
            for p, f in self.used[number].items()
            if not f[1].startswith("vector ") and not self.held[p] - self.hold[number]
        }

    @cached_property
    def held(self) -> Counter[str]:
        """Formulas that hold, by the entries that stand in them."""
        return Counter(p for u, held in zip(self.used, self.hold, strict=True) if held for p in u)


def evidence(
    formulas: Sequence[Formula],
    hold: Sequence[bool],
    lexicon: Lexicon,
    draft: Proposal,
    fails: Sequence[frozenset[str]] = (),
    here: Sequence[Lexicon] = (),
) -> Evidence:
    """Return what speaks for the meanings in formulas; ``hold``: which do, ``fails``: see `Evidence`.

    ``here``: the lexica that hold where the formulas stand, which parts of the note may have their own.
    """
    places = here or [lexicon] * len(formulas)
    said = {
        (MARK if d.table == "marks" else "") + d.latex: d
        for d in (*draft.drafts, *(d for _, rows in draft.parts for d in rows))
        if d.words not in GUESSED and d.words != TITLE
    }
    guessed = {d.latex: d.words for d in draft.drafts if d.words in GUESSED}
    ties = [t for one in draft.systems for t in one.ties]
    told = _told(formulas, draft)
    guessed |= {t.latex: USUAL for t in ties if t.latex not in told}
    entries = [dict(entries_in(f, x)) for f, x in zip(formulas, places, strict=True)]
    used = tuple(_whole(entries, formulas, lexicon))
    every = {p: f for u in used for p, f in u.items()}
    families = {p: p for p in every} | dict(_families(formulas, places))
    own = {p for p in every if p not in said and p not in guessed and not p.startswith(MARK)}
    whole = draft.words and sum(hold) >= TRUSTED and len(own) >= WHOLE * len(every)
    firm = {*said, *told, *draft.confirmed, *(_placed(own, every, draft) if whole else ())}
    return Evidence(
        used,
        tuple(hold),
        families,
        frozenset(firm),
        guessed,
        {t.latex: f"the {s.noun(t.means)} of the system" for s in draft.systems for t in s.ties},
        dict(_bases(draft, lexicon, every)),
        draft.preset,
        tuple(fails),
        frozenset({*said, *told, *draft.confirmed}),
        draft.confirmed,
    )


def _told(formulas: Sequence[Formula], draft: Proposal) -> set[str]:
    """Return the symbols of which words say what they are of a system."""
    ties = [t for one in draft.systems for t in one.ties]
    less = any(_simplified(formulas, one) for one in draft.systems)
    told = {t.latex for t in ties if t.words != USUAL}
    return told - {t.latex for t in ties if less and IN_A_MOTION.search(t.means)}


def _families(formulas: Sequence[Formula], places: Sequence[Lexicon]) -> Iterator[tuple[str, str]]:
    """Yield entries of formulas with their families."""
    for formula, lexicon in zip(formulas, places, strict=True):
        for look in operands_of(formula, lexicon):
            if (found := _entry(look, lexicon)) is not None:
                yield found.entry.latex, _family(found)


def _placed(own: set[str], every: Mapping[str, tuple[str, str]], draft: Proposal) -> Iterator[str]:
    """Yield entries of a preset, but for angles and those from its origin where the note has another."""
    points = {d.meaning for d in draft.drafts if d.table == "points"}
    elsewhere = "O" in points and "OI" not in points
    from_there = (p for p in own if not (elsewhere and "OI" in every[p][1].split()))
    return (p for p in from_there if every[p][1].split()[0] not in TURNS)


def _family(found: Found) -> str:
    """Return what symbols have in common that speak for each other.

    They are of one letter and one quantity: a vector, its components, and the same with other labels, where
    labels say which point or frame is meant; all that is said of the centre of a part by its label.
    """
    meaning, look = found.meaning, found.look
    if meaning.quantity == "system" and meaning.labels[0].endswith(CENTRE) and look.sub:
        return f"{' '.join(look.sub)} {CENTRE}"
    if meaning.formula or meaning.quantity in {"system", "defined", "vector"}:
        return found.entry.latex
    labelled = any(w not in AXES for corner in look.corners for w in corner)
    labels = [str(len(meaning.labels))] if labelled else list(meaning.labels)
    if meaning.quantity in PLACED and sum(len(c) for c in look.corners) < 2:
        labels = list(meaning.labels[1:])
    return " ".join((look.name, meaning.quantity, *labels))


def _whole(
    used: Sequence[dict[str, tuple[str, str]]], formulas: Sequence[Formula], lexicon: Lexicon
) -> Iterator[dict[str, tuple[str, str]]]:
    """Yield the entries that formulas use, with those by which the note defines other symbols in them."""
    defined: dict[Look, tuple[int, dict[str, tuple[str, str]]]] = {}
    for number, formula in enumerate(formulas):
        for statement in formula.statements if formula.relational else ():
            look = bare(statement.members[0], lexicon)
            found = None if look is None else lexicon.find(look)
            if look is not None and (found is None or found.meaning.quantity == "defined"):
                defined.setdefault(look, (number, used[number]))
    for number, formula in enumerate(formulas):
        whole = dict(used[number])
        for look in dict.fromkeys(operands_of(formula, lexicon)):
            first, own = defined.get(look, (number, {}))
            whole |= own if first < number else {}
        yield whole


def _bases(
    draft: Proposal, lexicon: Lexicon, every: Container[str]
) -> Iterator[tuple[str, frozenset[str]]]:
    """Yield entries by the letter of another symbol, with the entries of that in the note's formulas."""
    for one in draft.drafts:
        if one.words in {LETTER, BOOKS, DISPLAY} and one.meaning.startswith("="):
            formula = one.meaning.removeprefix("=").replace("<i>", "i")
            found = [lexicon.find(k) for k in looks_in(read_formula(formula).tree)]
            patterns = frozenset(f.entry.latex for f in found if f is not None)
            if patterns and all(p in every for p in patterns):
                yield one.latex, patterns


def _simplified(formulas: Sequence[Formula], guess: Guess) -> bool:
    """Return whether a note says somewhere that a parameter of its system is zero ("I neglect $b=0$").

    Values in motions of the system are then perhaps those of a simpler one.
    """
    own = {t.look for t in guess.ties if t.means in guess.table.get("parameters", {})}
    pairs = (s.members for f in formulas for s in f.statements if len(s.members) == 2)
    return any(
        look_of(left) in own and isinstance(right, Number) and float(right.text) == 0
        for left, right in pairs
    )


def misfits(claim: Claim) -> bool:
    """Return whether dimensions or kinds of a claim do not fit together."""
    return bool(claim.findings) and claim.verdict in GRAVE


def misfit(one: Understood, lexicon: Lexicon) -> frozenset[str]:
    """Return the entries of a lexicon without which dimensions or kinds of a formula would fit together."""
    reading = one.formula.reading
    if reading is None or not any(map(misfits, one.claims)):
        return frozenset()
    found: set[str] = set()
    for look in dict.fromkeys(operands_of(one.formula, lexicon)):
        entry = _entry(look, lexicon)
        if entry is not None and entry.entry.latex not in found:
            other = replace(one, lexicon=_without(one.lexicon, look))
            rests = not any(map(misfits, reread(other, reading.tree)))
            found |= {entry.entry.latex} if rests else set()
    return frozenset(found)


def is_amiss(one: Understood, lexicon: Lexicon, doubted: Container[str]) -> bool:
    """Return whether dimensions or kinds do not fit, whatever the symbols of some entries mean."""
    reading, here = one.formula.reading, one.lexicon
    if reading is None or not any(map(misfits, one.claims)):
        return False
    for look in dict.fromkeys(operands_of(one.formula, lexicon)):
        entry = _entry(look, lexicon)
        here = _without(here, look) if entry and entry.entry.latex in doubted else here
    return any(map(misfits, reread(replace(one, lexicon=here), reading.tree)))


def _without(lexicon: Lexicon, look: Look) -> Lexicon:
    """Return a lexicon in which a symbol has no meaning."""
    while (found := _entry(look, lexicon)) is not None:
        kept = tuple(tuple(e for e in y if e is not found.entry) for y in lexicon.layers)
        if kept == lexicon.layers:
            break
        lexicon = replace(lexicon, layers=kept)
    return lexicon


def uncounted(claim: Claim) -> Iterator[str]:
    """Yield coordinates that stand in a claim while no law of their system says where they are zero."""
    model = claim.model
    if model is None:
        return
    laws = frozenset[Any]().union(*(r.free_symbols for r in model.system.rates))
    bare = {a.data[1] for m in claim.members for a in _bare(m.term, claim.scalars)}
    for name in model.free_coordinates:
        if name in bare and model.symbol(name) not in laws:
            yield name


def is_turned(claim: Claim) -> bool:
    """Return whether a claim has a wheel whose axis it does not name beside other things."""
    names = {str(a.data[0]) for m in claim.members for a in atoms_in(m.term, claim.scalars)}
    wheels = {n for n in names if n.startswith("rotor_")}
    return "rotor_axis" not in wheels and set() < wheels < names


def _bare(term: Term, scalars: Mapping[Any, Term]) -> Iterator[Term]:
    """Yield the quantities of a system in a term that stand there themselves, not their rates."""
    if term.head == "atom" and term.data[0] == "system":
        yield term
    elif term.head == "expr":
        for symbol in _outside_rates(term.data[0]):
            yield from _bare(scalars[symbol], scalars) if symbol in scalars else ()
    elif term.head != "der":
        for inside in term.args:
            yield from _bare(inside, scalars)


def _outside_rates(expression: Any) -> Iterator[Any]:
    if expression.is_Symbol:
        yield expression
    elif not isinstance(expression, rate):
        for inside in expression.args:
            yield from _outside_rates(inside)


def readings(
    formula: Formula, lexicon: Lexicon, draft: Proposal
) -> Iterator[tuple[Doubt, Lexicon]]:
    """Yield other meanings that words or books give a symbol, each with the lexicon in which it has it.

    Books are asked only where it was they that gave the meaning.
    """
    guessed = {d.latex for d in draft.drafts if d.words == BOOKS}
    particle = any(d.table == "points" and d.meaning == "P" for d in draft.drafts)
    particle = particle or draft.body == "P"
    for look in dict.fromkeys(operands_of(formula, lexicon)):
        found = lexicon.find(look)
        if found is None:
            continue
        pattern = found.entry.latex
        spelt = [(d.latex, d.meaning, d.words) for d in draft.others if d.latex == pattern]
        books = candidates(found.look, draft.body, lexicon) if pattern in guessed else ()
        for latex, means, why in (*spelt, *((p, m, BOOKS) for p, m in books)):
            one, _ = lexicon_of({"symbols": {latex: means}}, "reading")
            whole = replace(lexicon, layers=(*one.layers[:1], *lexicon.layers))
            again = whole.find(found.look)
            other = again is not None and again.meaning != found.meaning
            if other and (particle or "P" not in means.split()):
                yield Doubt(latex_of(found.look), means, why, latex), whole


def with_meaning(lexicon: Lexicon, formula: Formula, doubt: Doubt) -> Lexicon | None:
    """Return a lexicon with another meaning, None where no symbol of a formula has it otherwise."""
    one, _ = lexicon_of({"symbols": {doubt.pattern or doubt.latex: doubt.meaning}}, "reading")
    whole = replace(lexicon, layers=(*one.layers[:1], *lexicon.layers))
    for look in dict.fromkeys(operands_of(formula, lexicon)):
        before, again = lexicon.find(look), whole.find(look)
        if before is not None and again is not None and before.meaning != again.meaning:
            return whole
    return None


def _entry(look: Look, lexicon: Lexicon) -> Found | None:
    """Return the entry of a symbol, also below the mark of a skew matrix or with a frame of components."""
    found, notation = lexicon.find(look), lexicon.notation
    if found is None and {*look.accents} & {*notation.skew}:
        kept = tuple(a for a in look.accents if a not in notation.skew)
        found = lexicon.find(replace(look, accents=kept))
    if found is None and notation.resolved and look.sub[-1:] in lexicon.frames:
        found = lexicon.find(replace(look, sub=look.sub[:-1]))
    return found


def entries_in(formula: Formula, lexicon: Lexicon) -> Iterator[tuple[str, tuple[str, str]]]:
    """Yield the entries that symbols of a formula have, by pattern: symbol and meaning; marks as well."""
    for node in symbols_in(formula):
        found_whole = seen(node) or Seen(Look(""))
        whole = found_whole.with_label()
        acts = found_whole.raised[1 if whole and lexicon.find(whole) is not None else 0 :]
        for one in acts:
            for name in labels(one) if isinstance(one, Marks) else ():
                if name in lexicon.notation.marks:
                    yield MARK + name, (name, f"derivative in {lexicon.notation.marks[name]}")
    for look in operands_of(formula, lexicon):
        found = _entry(look, lexicon)
        if found is not None and found.meaning.quantity not in {
            "time",
            "identity_matrix",
            "identity",
            "defined",
        }:
            yield found.entry.latex, (latex_of(found.look), found.meaning.words)
