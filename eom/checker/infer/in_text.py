r"""What formulas in the text say of symbols: ``$p = m v$`` of p, ``$r = R + s$`` of each of three."""

from __future__ import annotations

import re
from dataclasses import replace

from eom.checker.infer.books import looks_in
from eom.checker.infer.letters import FORMULA, Draft, solved
from eom.checker.infer.sayings import Prose, look_of
from eom.checker.mean.lexicon import Lexicon
from eom.checker.read.grammar import read_formula
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import Node, Number, Sequence, Words
from eom.checker.read.writing import latex, latex_of
from eom.terms.terms import INDICES


def by_formulas(text: Prose, lexicon: Lexicon) -> dict[Look, Draft]:
    """Return what formulas in the text say of symbols that stand alone on their left."""
    found: dict[Look, Draft] = {}
    for statement, line in zip(text.formulas, text.lines, strict=True):
        left, right = statement.members[:2]
        if look_of(left) is None and look_of(right) is not None:
            left, right = right, left
        look = look_of(left)
        usual = {g.name for g in statement.signs[:1]} <= {"=", "triangleq", ":=", "equiv"}
        if (
            look is None
            or not usual
            or look.name in INDICES
            or isinstance(right, Number | Sequence | Words)
        ):
            continue
        found.setdefault(look, _indexed(look, _written(left, look), latex(right), line, lexicon))
        for term, rest in solved(left, right):
            other = look_of(term)
            if other is not None:
                found.setdefault(other, _indexed(other, _written(term, other), rest, line, lexicon))
    return found


def _written(node: Node, look: Look) -> str:
    """Return the LaTeX of a symbol that reads as it looks."""
    powers = seen(node)
    own = latex_of(look)
    plain = powers is None or not powers.raised
    return own if plain and look_of(read_formula(own).tree) == look else latex(node)


def _indexed(look: Look, left: str, right: str, line: int, lexicon: Lexicon) -> Draft:
    """Return the entry by a formula, for any particle, or axis, where the symbol carries an index."""
    index = look.sub[0] if len(look.sub) == 1 and look.sub[0] in {*INDICES, "r", "s"} else ""
    axes = bool(index) and _counts_axes(right, index, lexicon)
    if axes or index in INDICES:
        below = rf"_(?:{index}|\{{{index}\}})(?![A-Za-z])"
        slot = "<k>" if axes else "<i>"
        left, right = (re.sub(below, f"_{{{slot}}}", t) for t in (left, right))
    return Draft("symbols", left, f"= {right}", FORMULA, line)


def _counts_axes(formula: str, index: str, lexicon: Lexicon) -> bool:
    """Return whether an index in a formula is that of a unit vector."""
    looks = looks_in(read_formula(formula).tree)
    units = (lexicon.find(replace(k, sub=("1",))) for k in looks if k.sub == (index,))
    return any(u is not None and u.meaning.quantity == "unit" for u in units)
