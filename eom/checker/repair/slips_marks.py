"""Slips in what stands on symbols: dots and other derivatives, tildes, crosses, transposes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from eom.checker.read.looks import DOTS, seen
from eom.checker.read.paths import Path, at, places, put
from eom.checker.read.syntax import (
    Accent,
    Addition,
    Derivative,
    Group,
    Marks,
    Node,
    Number,
    Product,
    Scripts,
    Symbol,
)
from eom.checker.repair.offers import Offer, Palette

# -- dots and other derivatives --------------------------------------------------------------------

_MORE = {"dot": "ddot", "ddot": "dddot"}
_LESS = {more: less for less, more in _MORE.items()}


def dotted(node: Node) -> Node | None:
    """Return a symbol with one overdot more, or a sum with one on each of its terms."""
    if isinstance(node, Accent) and node.mark in DOTS:
        return replace(node, mark=_MORE[node.mark]) if node.mark in _MORE else None
    if isinstance(node, Group) and isinstance(node.body, Addition):
        terms = [dotted(t) for t in node.body.terms]
        if any(t is None for t in terms):
            return None
        kept = tuple(t for t in terms if t is not None)
        return replace(node, body=replace(node.body, terms=kept))
    if isinstance(node, Scripts) and seen(node) is not None:
        base = dotted(node.base)
        return None if base is None else replace(node, base=base)
    given = seen(node)
    if given is None or not given.look.name.isalpha():
        return None
    return Accent("dot", node, span=node.span)


def more_dots(node: Node, palette: Palette) -> Iterator[Offer]:
    """Offer a dot more, or a raised mark."""
    new = dotted(node)
    if new is not None:
        yield new, 0.0
    given = seen(node)
    if given is not None and not given.raised:
        bare = node if isinstance(node, Scripts) else Scripts(node, span=node.span)
        for mark in palette.marks:
            if mark != "prime" or given.look.name.isalpha():
                yield replace(bare, sup=Marks((mark,), span=node.span)), 0.3
    names = node.sup.names if isinstance(node, Scripts) and isinstance(node.sup, Marks) else ()
    if names and set(names) <= set(palette.marks) and isinstance(node, Scripts):
        yield replace(node, sup=Marks((*names, names[-1]), span=node.span)), 0.1


def fewer_dots(node: Node, palette: Palette) -> Iterator[Offer]:
    """Offer a dot or a raised mark less, or no derivative."""
    if isinstance(node, Accent) and node.mark in DOTS:
        yield (replace(node, mark=_LESS[node.mark]) if node.mark in _LESS else node.base), 0.0
    if isinstance(node, Scripts) and seen(node) is not None:
        for base, extra in fewer_dots(node.base, palette):
            yield replace(node, base=base), extra
        if isinstance(node.sup, Marks) and set(node.sup.names) <= set(palette.marks):
            left = node.sup.names[:-1]
            new = replace(node, sup=replace(node.sup, names=left) if left else None)
            yield (new if left or new.sub or new.presup or new.presub else new.base), 0.0
    if isinstance(node, Derivative) and node.operand is not None:
        yield node.operand, 0.2


def derived(node: Node, palette: Palette) -> Iterator[Offer]:
    """Put a derivative in a frame before a symbol: the frame cannot be told by a dot."""
    given = seen(node)
    if given is not None and given.look.name.isalpha() and not given.dots:
        for frame in palette.frames[:3]:
            time = (Symbol("t"),)
            yield Derivative(node, time, frame=frame, form="before", span=node.span), 0.0


def frame_of_derivative(node: Node, palette: Palette) -> Iterator[Offer]:
    """Offer other frames of a derivative."""
    if isinstance(node, Derivative):
        for frame in palette.frames:
            if frame != node.frame:
                yield replace(node, frame=frame), 0.0
        if node.frame is not None:
            yield replace(node, frame=None), 0.2


def other_mark(node: Node, palette: Palette) -> Iterator[Offer]:
    """Exchange raised marks, and overdots for them."""
    if not isinstance(node, Scripts) or not isinstance(node.sup, Marks):
        given = seen(node)
        if given is not None and given.dots and not given.raised:
            for bare, extra in fewer_dots(node, palette):
                body = bare if isinstance(bare, Scripts) else Scripts(bare, span=node.span)
                for mark in palette.marks:
                    yield replace(body, sup=Marks((mark,), span=node.span)), extra
        return
    names = node.sup.names
    for k, name in enumerate(names):
        if name in palette.marks:
            for other in palette.marks:
                if other != name:
                    new = (*names[:k], other, *names[k + 1 :])
                    yield replace(node, sup=replace(node.sup, names=new)), 0.0


def raised_dot(node: Node, palette: Palette) -> Iterator[Offer]:
    """Read a dot on the line as a mark that was raised: of a x b . c make a x b^bullet c."""
    if not isinstance(node, Product) or node.operator != "dot" or len(node.factors) != 2:
        return
    left, right = node.factors
    last = _last_symbol(left)
    if last is None:
        return
    for new, _ in more_dots(at(left, last), replace(palette, skew=())):
        yield Product((Group(put(left, last, new)), right), span=node.span), 0.0


def _last_symbol(node: Node) -> Path | None:
    symbols = [path for path, here in places(node) if seen(here) is not None]
    return symbols[-1] if symbols else None


# -- accents, transposes, brackets -----------------------------------------------------------------


def more_skew(node: Node, palette: Palette) -> Iterator[Offer]:
    """Offer a tilde or a cross more, also in the place of a dot."""
    given = seen(node)
    if given is None or not given.look.name.isalpha():
        return
    for mark in palette.skew:
        if mark not in given.look.accents:
            yield _accented(node, mark), 0.0
        if given.dots:
            for bare, _ in fewer_dots(node, palette):
                yield _accented(bare, mark), 0.2
    if not given.raised:
        bare = node if isinstance(node, Scripts) else Scripts(node, span=node.span)
        yield replace(bare, sup=Marks(("times",), span=node.span)), 0.0 if not palette.skew else 0.6


def _accented(node: Node, mark: str) -> Node:
    if isinstance(node, Scripts):
        return replace(node, base=_accented(node.base, mark))
    return Accent(mark, node, span=node.span)


def fewer_skew(node: Node, palette: Palette) -> Iterator[Offer]:
    """Offer a tilde or a cross less."""
    if isinstance(node, Accent) and node.mark in palette.skew:
        yield node.base, 0.0
        yield replace(node, mark="dot"), 0.2
    if isinstance(node, Scripts):
        if seen(node) is not None:
            for base, extra in fewer_skew(node.base, palette):
                yield replace(node, base=base), extra
        if node.sup == Marks(("times",)):
            yield without_sup(node), 0.0


def without_sup(node: Scripts) -> Node:
    """Return a symbol without what is raised."""
    left = replace(node, sup=None)
    return left if left.sub or left.presub or left.presup else left.base


_T = Symbol("T")
_TRANSPOSES = frozenset({"T", "top", "intercal"})


def transpose(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a transpose more or less."""
    if isinstance(node, Scripts) and isinstance(node.sup, Symbol) and node.sup.name in _TRANSPOSES:
        yield without_sup(node), 0.0
        return
    given = seen(node)
    if isinstance(node, Scripts) and node.sup is not None:
        return
    if (given is not None and not given.dots) or (isinstance(node, Group) and node.open in "(["):
        if isinstance(node, Scripts):
            yield replace(node, sup=_T), 0.0
        elif not isinstance(node, Number):
            yield Scripts(node, None, _T, span=node.span), 0.0
