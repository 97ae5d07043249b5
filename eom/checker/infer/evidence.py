r"""What a verdict rests on: a meaning that words give, or one that books, letters and custom only suggest.

A meaning is sure where words or a formula of the text give it, or where two other lines with it hold: most
lines of a note are right, and a meaning that is not meant makes them fail.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eom.checker.infer.books import candidates
from eom.checker.infer.draft import Proposal
from eom.checker.infer.letters import BOOKS, GUESSED
from eom.checker.infer.sayings import look_of
from eom.checker.infer.sections import TITLE
from eom.checker.infer.shown import operands_of, symbols_in
from eom.checker.infer.systems import IN_A_MOTION, USUAL, Guess
from eom.checker.mean.claims import Claim
from eom.checker.mean.lexicon import Lexicon
from eom.checker.mean.lexicon_files import lexicon_of
from eom.checker.read.statements import Formula
from eom.checker.read.symbol_shape import Look, Seen, labels, seen
from eom.checker.read.syntax import Marks, Number
from eom.checker.read.writing import latex_of
from eom.terms.terms import Term
from eom.worlds.solutions import rate

MARK = "mark "
"""How the entry of a raised mark is told from those of symbols."""
LINES = 1
"""Other lines that hold with a meaning, by which it is sure."""
TRUSTED, WHOLE = 3, 0.4
"""Lines that hold, and the share of a note's symbols that its preset names, by which the preset is sure."""


@dataclass(frozen=True)
class Doubt:
    """A symbol with the meaning that it was taken to have, and why that was taken."""

    latex: str
    meaning: str
    why: str


def doubts(
    formulas: Sequence[Formula], hold: Sequence[bool], lexicon: Lexicon, draft: Proposal
) -> Iterator[tuple[Doubt, ...]]:
    """Yield for each formula the meanings in it that nothing makes sure; ``hold``: which formulas do."""
    said = {
        (MARK if d.table == "marks" else "") + d.latex: d
        for d in (*draft.drafts, *(d for _, rows in draft.parts for d in rows))
        if d.words not in GUESSED and d.words != TITLE
    }
    guessed = {d.latex: d.words for d in draft.drafts if d.words in GUESSED}
    ties = [t for one in draft.systems for t in one.ties]
    less = any(_simplified(formulas, one) for one in draft.systems)
    told = {t.latex for t in ties if t.words != USUAL}
    told -= {t.latex for t in ties if less and IN_A_MOTION.search(t.means)}
    guessed |= {t.latex: USUAL for t in ties if t.latex not in told}
    meant = {t.latex: f"the {t.means} of the system" for t in ties}
    used = [dict(_used(f, lexicon)) for f in formulas]
    count = Counter(p for u, held in zip(used, hold, strict=True) if held for p in u)
    every = {p for u in used for p in u}
    own = {p for p in every if p not in said and p not in guessed and not p.startswith(MARK)}
    firm = {
        *said,
        *told,
        *draft.confirmed,
        *(own if sum(hold) >= TRUSTED and len(own) >= WHOLE * len(every) else ()),
    }
    for found, held in zip(used, hold, strict=True):
        unsure = [(p, f) for p, f in found.items() if p not in firm and count[p] - held < LINES]
        yield tuple(
            Doubt(f[0], meant.get(p, f[1]), guessed.get(p, f"preset {draft.preset}"))
            for p, f in unsure
        )


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
            if again is not None and again.meaning != found.meaning:
                yield Doubt(latex_of(found.look), means, why), whole


def _used(formula: Formula, lexicon: Lexicon) -> Iterator[tuple[str, tuple[str, str]]]:
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
        found = lexicon.find(look)
        if found is not None and found.meaning.quantity not in {
            "time",
            "identity_matrix",
            "identity",
        }:
            yield found.entry.latex, (latex_of(found.look), found.meaning.words)
