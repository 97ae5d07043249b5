r"""How a symbol looks: letter, style, accents and labels at its four corners, as plain text.

Labels are rows of words: ``\omega_{B/N}`` has the labels ("B", "/", "N") below, ``I_{12}`` has
("1", "2"). Bold, upright and slanted labels are the same; calligraphic ones are not. Dots, and what
is raised and no label, act on the symbol: they are kept apart (`Seen`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from eom.checker.read.syntax import (
    Accent,
    Addition,
    Blank,
    Group,
    Marks,
    Missing,
    Node,
    Number,
    Product,
    Quotient,
    Scripts,
    Sequence,
    Symbol,
    Words,
    kept,
)

Labels = tuple[str, ...]

DOTS = {"dot": 1, "ddot": 2, "dddot": 3, "ddddot": 4}
"""Accents that are derivatives, with their order."""

_SHAPED = {"calligraphic": "cal", "blackboard": "bb", "fraktur": "frak"}
"""Styles that make another label of a letter."""


@dataclass(frozen=True)
class Look:
    """Letter and style, accents in order of their names, labels at the corners."""

    name: str
    style: str = ""
    accents: tuple[str, ...] = ()
    sub: Labels = ()
    sup: Labels = ()
    presub: Labels = ()
    presup: Labels = ()
    called: bool = False
    """Whether an argument in brackets follows."""

    @property
    def corners(self) -> tuple[Labels, Labels, Labels, Labels]:
        """The labels: below, above, below on the left, above on the left."""
        return self.sub, self.sup, self.presub, self.presup

    def numbered(self, indices: Mapping[str, str]) -> Look:
        """Return the look with what bound indices stand for in the place of them."""
        if not indices:
            return self
        corners = (tuple(indices.get(w, w) for w in c) for c in self.corners)
        sub, sup, presub, presup = corners
        return replace(self, sub=sub, sup=sup, presub=presub, presup=presup)

    @property
    def text(self) -> str:
        """The look as a name: ``omega_1``, ``vec-R_C``, ``H^B``."""
        before = "".join(self.presup) + "-" if self.presup else ""
        accents = "".join(f"{a}-" for a in self.accents)
        below = "_" + "".join(self.sub) if self.sub else ""
        return before + accents + self.name + below + ("^" + "".join(self.sup) if self.sup else "")


@dataclass(frozen=True)
class Seen:
    """A symbol as it stands: its look without what is raised, dots, raised nodes from inside out."""

    look: Look
    dots: int = 0
    raised: tuple[Node, ...] = ()

    def with_label(self) -> Look | None:
        """Return the look that takes the first raised node as a label."""
        return replace(self.look, sup=labels(self.raised[0])) if self.raised else None


def grown(given: Seen) -> Look:
    r"""Return the look of a change that has a name of its own: of E in \Delta E."""
    return replace(given.look, accents=tuple(sorted((*given.look.accents, "Delta"))))


@kept
def seen(node: Node) -> Seen | None:
    """Return what a node looks like if it is one symbol with accents and scripts, else None."""
    if isinstance(node, Symbol):
        return Seen(Look(node.name, "" if node.style == "roman" else node.style))
    if isinstance(node, Group):
        return seen(node.body) if node.open == "" else None
    if isinstance(node, Accent):
        return _accented(node)
    return _scripted(node) if isinstance(node, Scripts) else None


def _accented(node: Accent) -> Seen | None:
    inside = seen(node.base)
    if inside is None and isinstance(node.base, Number):
        inside = Seen(Look(node.base.text))
    if inside is None and _is_pair(node.base):
        inside = Seen(Look("", sub=labels(node.base)))
    if inside is None:
        return None
    if node.mark in DOTS:
        return Seen(inside.look, inside.dots + DOTS[node.mark], inside.raised)
    look = inside.look
    marks = tuple(sorted((*look.accents, node.mark)))
    made = Look(look.name, look.style, marks, *look.corners, look.called)
    return Seen(made, inside.dots, inside.raised)


def _is_pair(node: Node) -> bool:
    """Whether this is the names of two points side by side, as below the arrow from one to the other."""
    while isinstance(node, Group) and node.open == "":
        node = node.body
    if not isinstance(node, Product) or node.operator or len(node.factors) != 2:
        return False
    return all(isinstance(f, Symbol | Scripts) and seen(f) is not None for f in node.factors)


def _scripted(node: Scripts) -> Seen | None:
    inside = seen(node.base)
    if inside is None:
        return None
    look = inside.look
    look = replace(
        look,
        sub=look.sub + labels(node.sub),
        presub=labels(node.presub) + look.presub,
        presup=labels(node.presup) + look.presup,
    )
    empty = node.sup is None or isinstance(node.sup, Missing)
    raised = inside.raised if empty or node.sup is None else (*inside.raised, node.sup)
    return Seen(look, inside.dots, raised)


def labels(node: Node | None) -> Labels:
    """Return a script as a row of words."""
    if node is None:
        return ()
    for kind, rule in _LABELS:
        if isinstance(node, kind):
            found: Labels = rule(node)
            return found
    return (f"?{type(node).__name__}",)


def _letter(node: Symbol) -> Labels:
    shaped = _SHAPED.get(node.style)
    if shaped is not None:
        return (f"{shaped} {node.name}",)
    if node.style == "typewriter":
        return (f"<{node.name}>",)
    word = node.style == "roman" and len(node.name) > 1
    return tuple(node.name) if word else (node.name,)


def _with_scripts(node: Scripts) -> Labels:
    base = labels(node.base)
    below, above = "".join(labels(node.sub)), "".join(labels(node.sup))
    tail = (f"_{below}" if below else "") + (f"^{above}" if above else "")
    return (*base[:-1], base[-1] + tail) if base else (tail,)


def _terms(node: Addition) -> Labels:
    pairs = zip(node.signs, node.terms, strict=True)
    return tuple(w for sign, term in pairs for w in ((sign,) if sign else ()) + labels(term))


def _factors(node: Product) -> Labels:
    """Return the words of factors; a cross between them is one, as in 3 x 3."""
    words: Labels = labels(node.factors[0])
    for factor in node.factors[1:]:
        words += (("times",) if node.operator == "cross" else ()) + labels(factor)
    return words


_LABELS: tuple[tuple[type, Callable[[Any], Labels]], ...] = (
    (Symbol, _letter),
    (Number, lambda n: tuple(n.text)),
    (Words, lambda n: tuple(n.text.replace(" ", ""))),
    (Marks, lambda n: n.names),
    (Group, lambda n: labels(n.body) if n.open == "" else (n.open, *labels(n.body), n.close)),
    (Product, _factors),
    (Quotient, lambda n: (*labels(n.left), "/", *labels(n.right))),
    (Sequence, lambda n: tuple(w for i in n.items for w in labels(i))),
    (Scripts, _with_scripts),
    (Accent, lambda n: (f"{n.mark}({''.join(labels(n.base))})",)),
    (Addition, _terms),
    (Missing, lambda _: ()),
    (Blank, lambda _: ("blank",)),
)
"""One rule a kind of node."""


def named_in(node: Node) -> Labels:
    r"""Return what brackets behind a symbol name, brackets included; nothing for an argument.

    Frames and points with a stroke between them, as in \vec\Omega(B/A), are labels, and so are slots.
    """
    words = labels(node)
    return words if "/" in words or any(w.startswith("<") for w in words) else ()


def called_symbol(node: Node) -> Node:
    """Return a symbol without the letters behind it in brackets that it is a function of."""
    symbol, inside = (
        node.factors if isinstance(node, Product) and len(node.factors) == 2 else (node, None)
    )
    body = inside.body if isinstance(inside, Group) and inside.open == "(" else None
    of = isinstance(body, Sequence) and all(map(seen, body.items)) and seen(symbol) is not None
    return symbol if of else node


def bracket_of(node: Node) -> Look | None:
    """Return by what a definition of brackets of two letters is known; None for anything else."""
    items = node.body.items if isinstance(node, Group) and isinstance(node.body, Sequence) else ()
    found = [seen(item) for item in items]
    if (
        len(found) != 2
        or None in found
        or not isinstance(node, Group)
        or node.open not in {"{", "["}
    ):
        return None
    return Look(node.open, sub=tuple(f.look.text for f in found if f is not None))


def approached_from(node: Node) -> tuple[Node, int]:
    """Return a value that is approached, and from which side."""
    if not isinstance(node, Scripts) or node.sub is not None or node.sup is None:
        return node, 1
    names = node.sup.names if isinstance(node.sup, Marks) else labels(node.sup)
    sides = {("+",): 1, ("-",): -1}
    return (node.base, sides[names]) if names in sides else (node, 1)
