r"""Letters with a place behind them under integrals over a volume: quantities per volume.

``\iiint_V \vec f(\vec r)\,dV`` is a force, so ``\vec f(\vec r)`` is that on an element for its volume;
``\sigma(\vec r)`` without a mark is the density of mass.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

from eom.checker.infer.letters import DISPLAY, Draft
from eom.checker.infer.phrases import OF_ONE
from eom.checker.infer.sayings import Prose, said
from eom.checker.mean.lexicon import Lexicon
from eom.checker.read.statements import Formula
from eom.checker.read.symbol_shape import Look, seen
from eom.checker.read.syntax import Group, Integral, Node, Product, walk
from eom.checker.read.writing import latex, latex_of

_VOLUMES = frozenset({"V", "v", "tau"})
"""Letters of volumes below an integral."""
_OF_ELEMENTS = frozenset({"linear_momentum", "force", "external_force", "angular_momentum"})
"""Quantities of a body that those of its elements add up to."""


def densities(formulas: Iterable[Formula], lexicon: Lexicon, text: Prose) -> Iterator[Draft]:
    """Yield what symbols with a place behind them are under integrals over a volume."""
    told = {m.look: s for s in said(text) if "densit" in s.words for m in s.of}
    done: set[str] = set()
    for formula in formulas:
        for factor, place in _called(formula):
            look, pattern = seen(factor), f"{_plain(factor)}({latex(place)})"
            if look is None or pattern in done:
                continue
            done.add(pattern)
            means = _of_element(look.look, lexicon)
            if means:
                one = told.get(look.look)
                words = text.shown(one.words) if one is not None else DISPLAY
                line = one.of[0].line if one is not None else formula.piece.line
                yield Draft("symbols", pattern, f"{means} per volume", words, line)


def _plain(factor: Node) -> str:
    """Return a symbol without what is raised."""
    found = seen(factor)
    return latex_of(found.look) if found is not None else ""


def _called(formula: Formula) -> Iterator[tuple[Node, Node]]:
    """Yield letters with the letter in brackets behind them, under integrals over a volume."""
    members = (m for s in formula.statements for m in s.members)
    integrals = (n for m in members for n in walk(m) if isinstance(n, Integral))
    for integral in integrals:
        names = {look.look.name for v in integral.variables if (look := seen(v)) is not None}
        inside = integral.integrand if names <= _VOLUMES and names else None
        products = walk(inside) if inside is not None else ()
        for product in (p for p in products if isinstance(p, Product) and not p.operator):
            for factor, behind in pairwise(product.factors):
                if isinstance(behind, Group) and behind.open == "(" and seen(behind.body):
                    yield factor, behind.body


def _of_element(look: Look, lexicon: Lexicon) -> str:
    """Return what the element has of which a body's letter is the sum; mass of a letter without a mark."""
    if not look.accents and not look.style:
        return "mass dm" if lexicon.find(look) is None else ""
    entries = (e for layer in lexicon.layers for e in layer)
    same = (e for e in entries if (e.look.name, e.look.accents) == (look.name, look.accents))
    kinds = {OF_ONE.get(q, q) for e in same if (q := e.meaning.quantity) in _OF_ELEMENTS}
    if len(kinds) != 1:
        return ""
    (kind,) = kinds
    about = (
        f" {'O' if 'O' in lexicon.points.values() else 'C'}" if kind == "angular_momentum" else ""
    )
    return f"{kind} dm{about}"
