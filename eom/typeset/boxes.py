"""Formulas as boxes: what a formula is made of, whatever language it will be written in.

Notation decides which boxes a term has (`eom.typeset.notation`), markup how they look
(`eom.typeset.markup`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

Expr = Any


@dataclass(frozen=True)
class Symbol:
    """A letter, name of a Greek letter, number or upright word, in a ``style``: one of `STYLES`."""

    name: str
    style: str = "italic"


@dataclass(frozen=True)
class Sign:
    """What is written as it stands: its ``latex``, its Unicode ``text``, its element ``tag`` of MathML.

    ``tag``: "mo" of an operator, "mi" of a letter, "normal" of an upright one, "mn", "mtext".
    """

    latex: str
    text: str
    tag: str = "mo"


@dataclass(frozen=True)
class Accent:
    """A ``mark``, a row of `eom.typeset.markup.ACCENTS`, on the box ``base``."""

    mark: str
    base: Box


@dataclass(frozen=True)
class Scripts:
    """The box ``base`` with what is below (``sub``), above (``sup``) and to the upper ``left`` of it.

    ``left_sub``: what is to its lower left; ``stacked``: right under and over it, as limits of a sum.
    """

    base: Box
    sub: Box | None = None
    sup: Box | None = None
    left: Box | None = None
    left_sub: Box | None = None
    stacked: bool = False


@dataclass(frozen=True)
class Row:
    """Boxes side by side, the ``items``, with a ``gap`` between those that are not empty."""

    items: tuple[Box, ...]
    gap: str = ""


@dataclass(frozen=True)
class Fence:
    """The box ``inner`` in brackets, rows of `eom.typeset.markup.DELIMITERS` or as they stand.

    Without ``closing`` in the bracket that belongs to ``opening``; "." is none. ``flat``: brackets as
    high as letters.
    """

    inner: Box
    opening: str = "("
    closing: str = ""
    flat: bool = False


@dataclass(frozen=True)
class Form:
    """What is built of its ``parts`` as a row of `eom.typeset.markup.FORMS` says: a root, a frame."""

    name: str
    parts: tuple[Box, ...]


@dataclass(frozen=True)
class Fraction:
    """One box over another, ``above`` and ``below`` the line.

    ``beside``: the same with what holds quotients itself beside the line, where letters in them would be
    small; LaTeX and MathML write it in the place of the quotient.
    """

    above: Box
    below: Box
    beside: Box | None = None


@dataclass(frozen=True)
class Grid:
    """A table of boxes, its ``rows`` from the top; ``columns`` as the ``environment`` of LaTeX takes them.

    Environments "" and "aligned": rows of a left side and the rest.
    """

    rows: tuple[tuple[Box, ...], ...]
    environment: str = "bmatrix"
    columns: str = ""


@dataclass(frozen=True)
class Operator:
    """An operation, a relation or a mark: a row of `eom.typeset.markup.OPERATORS`."""

    name: str


@dataclass(frozen=True)
class Formula:
    """A SymPy expression, ``value``; ``names``: LaTeX names that symbols bring along, or their boxes."""

    value: Expr
    names: Mapping[Expr, str | Box] = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class Words:
    """Plain words in a formula, ``text``."""

    text: str


@dataclass(frozen=True)
class Unseen:
    """The box ``inner``, which takes up its room and is not seen."""

    inner: Box


Box = (
    Symbol
    | Sign
    | Accent
    | Scripts
    | Row
    | Fence
    | Form
    | Fraction
    | Grid
    | Operator
    | Formula
    | Words
    | Unseen
)

GREEK = (
    *"alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu".split(),
    *"nu xi omicron pi rho sigma tau upsilon phi chi psi omega".split(),
)
GREEK_NAMES = frozenset({*GREEK, *(g.capitalize() for g in GREEK)})

STYLES = ("italic", "bold", "roman", "calligraphic", "blackboard")


def row(*items: Box | None) -> Box:
    """Return boxes side by side; None is left out and a single box stands alone."""
    kept = tuple(i for i in items if i is not None)
    return kept[0] if len(kept) == 1 else Row(kept)


def joined(boxes: Iterable[Box | None], operator: str = "comma") -> Box | None:
    """Return boxes with an operator between them, or None for no boxes."""
    kept = [b for b in boxes if b is not None]
    parts = [part for b in kept for part in (Operator(operator), b)][1:]
    return row(*parts) if parts else None


def accented(mark: str, box: Box) -> Box | None:
    """Return a symbol with a mark on its nucleus, within its scripts; None for compound boxes.

    A dot on a dot is two dots.
    """
    if isinstance(box, Scripts):
        base = None if box.sup is not None else accented(mark, box.base)
        return None if base is None else replace(box, base=base)
    if isinstance(box, Accent) and box.mark in {"dot", "ddot"} and mark in {"dot", "ddot"}:
        return Accent("ddot", box.base) if (box.mark, mark) == ("dot", "dot") else None
    return Accent(mark, box) if isinstance(box, Symbol | Accent) else None


def raised(box: Box, sup: Box) -> Box:
    """Return a box with a superscript; a fraction, and a box that already has one, is bracketed."""
    if isinstance(box, Scripts) and box.sup is None and box.left is None:
        return replace(box, sup=sup)
    if isinstance(box, Scripts | Fraction):
        return Scripts(Fence(box), sup=sup)
    return Scripts(box, sup=sup)


_NAME = re.compile(r"([A-Za-z_]+?)(\d*)")


def _is_word(part: str) -> bool:
    return len(part) > 1 and part.replace("_", "").isalpha() and part not in GREEK_NAMES


INDEXED = {"Js": ("J", "s"), "Jt": ("J", "t")}
"""Names of quantities that are a letter with an index: moments of rotors about their axis and across."""


def symbol(name: str) -> Box:
    """Return the box of a name: ``theta_dot``, ``omega_1``, ``I1``, ``h_G_2``, ``radial_2``."""
    parts = [p for p in name.split("_") if p]
    mark = parts.pop() if len(parts) > 1 and parts[-1] in {"dot", "ddot"} else ""
    while len(parts) > 1 and all(_is_word(p) for p in parts[:2]):
        parts[:2] = [f"{parts[0]}_{parts[1]}"]
    found = _NAME.fullmatch(parts[0]) if parts else None
    if found is None:
        return Symbol(name, "roman")
    letter, *index = INDEXED.get(found[1], (found[1],))
    base: Box = nucleus(letter)
    base = Accent(mark, base) if mark else base
    sub = joined([nucleus(p) for p in (*index, found[2], *parts[1:]) if p])
    return Scripts(base, sub) if sub is not None else base


def nucleus(word: str, style: str = "italic") -> Symbol:
    """Return a letter or Greek letter in a style; other words stand upright."""
    single = len(word) == 1 or word in GREEK_NAMES
    return Symbol(word, style if single else "roman")
