"""Slips in letters and labels: indices, points, frames, letters that look alike."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from eom.checker.read.looks import seen
from eom.checker.read.syntax import Accent, Marks, Node, Number, Product, Quotient, Scripts
from eom.checker.repair.offers import Offer, Palette
from eom.checker.repair.slips import dotted

# -- labels and letters ----------------------------------------------------------------------------


def labels(node: Node, palette: Palette) -> Iterator[Offer]:
    """Exchange one label of a symbol by another of its kind."""
    if not isinstance(node, Scripts | Accent) or seen(node) is None:
        return
    if isinstance(node, Accent):
        for base, extra in labels(node.base, palette):
            yield replace(node, base=base), extra
        return
    for base, extra in labels(node.base, palette):
        yield replace(node, base=base), extra
    for corner in ("sub", "sup", "presub", "presup"):
        script = getattr(node, corner)
        power = corner == "sup" and isinstance(script, Number)
        if script is not None and not power and not isinstance(script, Marks):
            for new in _relabelled(script, palette):
                yield _cornered(node, corner, new), 0.0


def _cornered(node: Scripts, corner: str, new: Node) -> Scripts:
    corners = {"sub": node.sub, "sup": node.sup, "presub": node.presub, "presup": node.presup}
    corners[corner] = new
    return Scripts(node.base, **corners, span=node.span)


def _relabelled(script: Node, palette: Palette) -> Iterator[Node]:
    """Yield scripts with one label exchanged."""
    if isinstance(script, Number) and script.text.isdigit():
        yield from (replace(script, text=text) for text in _digits(script.text))
    for row in palette.labels:
        if script in row:
            yield from (other for other in row if other != script)
    if isinstance(script, Product | Quotient):
        parts = script.factors if isinstance(script, Product) else (script.left, script.right)
        for k, part in enumerate(parts):
            others = (n for n in _relabelled(part, palette) if n not in parts)
            yield from (_reparted(script, (*parts[:k], n, *parts[k + 1 :])) for n in others)
        if len(parts) == 2:
            yield _reparted(script, (parts[1], parts[0]))


def _digits(text: str) -> Iterator[str]:
    """Yield numbers of axes with one digit exchanged, and two digits the other way round."""
    for k, digit in enumerate(text):
        others = (o for o in "123" if digit in "123" and o != digit)
        yield from (text[:k] + o + text[k + 1 :] for o in others)
    if len(text) == 2:
        yield text[::-1]


def _reparted(script: Node, parts: tuple[Node, ...]) -> Node:
    if isinstance(script, Quotient):
        return replace(script, left=parts[0], right=parts[1])
    return Product(parts, span=script.span)


NEIGHBOURS: tuple[frozenset[str], ...] = tuple(
    frozenset(row.split())
    for row in (
        "phi varphi psi theta vartheta Phi",
        "omega Omega w",
        "rho r p",
        "tau T t",
        "alpha a",
        "v nu u",
        "sigma delta",
        "epsilon varepsilon e",
        "h H n",
        "I l L J",
        "M m",
        "C G c",
    )
)
"""Letters that are taken for each other."""


def letters(node: Node, palette: Palette) -> Iterator[Offer]:
    """Put another symbol of the note in place of one."""
    given = seen(node)
    if given is None or not given.look.name.isalpha():
        return
    for rank, other in enumerate(palette.symbols):
        if other == node:
            continue
        new = seen(other)
        if new is not None:
            extra = _distance(given.look.name, new.look.name) + min(0.4, 0.01 * rank)
            yield other, extra
            more = dotted(other)
            if more is not None and not new.dots:
                yield more, extra + (0.1 if given.dots else 0.4)


def _distance(old: str, new: str) -> float:
    if old == new:
        return -0.3
    near = any({old, new} <= row for row in NEIGHBOURS) or old.casefold() == new.casefold()
    return -0.3 if near else 0.2
