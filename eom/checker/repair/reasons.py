"""Why a line is wrong in one sentence, as a teacher would say it: from the slip that was undone.

Each slip has a sentence, and some a better one for what stands at its place: which factor it is, whether
a label is that of a point, of a frame or of an axis, which term of a derivative in a turning frame is lost.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from eom.checker.mean.lexicon import Lexicon
from eom.checker.read.paths import at
from eom.checker.read.symbol_shape import labels
from eom.checker.read.syntax import (
    Addition,
    Derivative,
    Fraction,
    Group,
    Node,
    Number,
    Product,
    walk,
)
from eom.checker.read.writing import latex
from eom.checker.repair.candidates import Candidate
from eom.checker.repair.lines import Line, is_omega, leaves, meant
from eom.checker.repair.slips import Change, Option


@dataclass(frozen=True)
class Place:
    """A slip undone in a term of a line."""

    line: Line
    option: Option
    change: Change

    @property
    def lexicon(self) -> Lexicon:
        """What the symbols of the line mean."""
        return self.line.elaborator.lexicon

    @property
    def written(self) -> Iterator[Node]:
        """Every node of the line."""
        return (n for m in self.line.members if m.path for n in walk(at(self.line.tree, m.path)))


SENTENCES: Mapping[str, str] = {
    "lost dot": "a time derivative is missing: {new}, not {old}",
    "superfluous dot": "a time derivative is too much: {new}, not {old}",
    "lost tilde": "a cross is missing: the skew matrix {new} is meant, not {old}",
    "superfluous tilde": "a cross is too much: {new}, not {old}",
    "transpose": "a matrix is transposed: {new}, not {old}",
    "transposed table": "the table is transposed: its rows should be its columns",
    "entry": "entries of the table stand in each other's places",
    "sign": "the sign of {term} is wrong",
    "sine or cosine": "sine and cosine are exchanged: {new}, not {old}",
    "index": "the wrong label: {new}, not {old}",
    "factor": "the factor {gained} is missing in {old}",
    "number": "the number is wrong: {new}, not {old}",
    "exponent": "the power is wrong: {new}, not {old}",
    "power of a sum": "the power of a sum is not the sum of the powers: {new}, not {old}",
    "frame of the derivative": "the derivative is taken in the wrong frame: {new}, not {old}",
    "mark of the derivative": "the derivative is taken in the wrong frame: {new}, not {old}",
    "order": "the factors stand in the wrong order, and do not commute: {new}, not {old}",
    "operator": "the wrong product: {new}, not {old}",
    "superfluous term": "the term {lost} does not belong here",
    "superfluous factor": "the factor {lost} is too much in {old}",
    "lost factor": "the factor {gained} was forgotten in {old}",
    "lost part": "the term {gained} is missing in {old}",
    "lost cross product": "a cross product with the angular velocity is missing: {new}, not {old}",
    "lost vector": "a product with a vector is missing: {new}, not {old}",
    "lost derivative": "a derivative is missing: {new}, not {old}",
    "raised dot": "a dot on the line was meant as a derivative: {new}",
    "upside down": "a fraction is upside down: {new}, not {old}",
    "symbol": "the wrong symbol: {new} is meant, not {old}",
    "lost term": "the term {term} is missing",
}
"""Why a line is wrong, by the slip that was undone."""


def sentence(line: Line, candidate: Candidate) -> str:
    """Return why a line is wrong that a repair makes right; formulas stand between dollars."""
    places = [Place(line, o, c) for o in candidate.options for c in o.changes]
    exchanged = _exchanged(places)
    words = [exchanged] if exchanged else [_said(p) for p in places]
    return "; ".join(dict.fromkeys(words))


def _said(place: Place) -> str:
    name = place.change.slip.name
    words = (BETTER[name](place) if name in BETTER else "") or SENTENCES[name]
    return words.format_map(_Parts(place))


@dataclass(frozen=True)
class _Parts:
    """The formulas of a sentence, written when they are asked for."""

    place: Place

    def __getitem__(self, name: str) -> str:
        node = PARTS[name](self.place)
        return f"${node if isinstance(node, str) else latex(node)}$"


def _term(place: Place) -> Node | str:
    option, change = place.option, place.change
    if change.added:
        return change.added
    if option.appended:
        text = latex(option.node)
        inside = rf"\left( {text} \right)" if isinstance(option.node, Addition) else text
        return f"- {inside}" if option.sign < 0 else inside
    return _turned(change) or option.addend.node


def _turned(change: Change) -> Node | None:
    """Return the term of a sum whose sign was turned."""
    old, new = change.old, change.new
    if isinstance(old, Addition) and isinstance(new, Addition) and len(old.terms) == len(new.terms):
        signs = zip(old.terms, old.signs, new.signs, strict=True)
        return next((t for t, a, b in signs if (a == "-") != (b == "-")), None)
    return old if change.paths != ((),) else None


def _gained(place: Place) -> Node:
    return _besides(place.change.new, place.change.old)


def _lost(place: Place) -> Node:
    """Return the term or factor that is too much."""
    return _besides(place.change.old, place.change.new)


def _besides(more: Node, less: Node) -> Node:
    """Return what the one sum or product holds that the other does not."""
    inside = more.body if isinstance(more, Group) else more
    other = less.body if isinstance(less, Group) else less
    parts = inside.terms if isinstance(inside, Addition) else ()
    parts = inside.factors if isinstance(inside, Product) else parts
    kept = (other, *getattr(other, "factors", getattr(other, "terms", ())))
    return next((p for p in parts if p != less and p not in kept), more)


PARTS: Mapping[str, Callable[[Place], Node | str]] = {
    "old": lambda p: p.change.old,
    "new": lambda p: p.change.new,
    "term": _term,
    "gained": _gained,
    "lost": _lost,
}


# -- better words -----------------------------------------------------------------------------------


def _label(place: Place) -> str:
    """Name the label that was exchanged: of a point, of a frame, of an axis."""
    old, new = (list(leaves(n)) for n in (place.change.old, place.change.new))
    other = [labels(n) for n in old if n not in new]
    if any(o in place.lexicon.points for o in other):
        return "the wrong point: {new}, not {old}"
    if any(o in place.lexicon.frames for o in other):
        return "the wrong body or frame: {new}, not {old}"
    return "the wrong index: {new}, not {old}"


def _named(place: Place) -> str:
    """Say which quantity is the wrong one of its kind."""
    old, new = (meant(place.lexicon, n) for n in (place.change.old, place.change.new))
    alike = old and old.split("_")[-2:] == new.split("_")[-2:]
    kind = "quantity" if old == "system" else old.replace("_", " ")
    return f"the wrong {kind}: {{new}}, not {{old}}" if alike else ""


def _ordered(place: Place) -> str:
    crossed = isinstance(place.change.old, Product) and place.change.old.operator == "cross"
    return (
        "a cross product in the wrong order has the wrong sign: {new}, not {old}" if crossed else ""
    )


def _transported(place: Place) -> str:
    """Name the term of a derivative in a turning frame that is missing."""
    node = place.option.node if place.option.appended else place.change.new
    if isinstance(node, Addition) or not place.option.appended:
        return ""
    factors = node.factors if isinstance(node, Product) else ()
    twice = bool(factors) and factors[0] == Number("2")
    crossed = next(
        (n for n in walk(node) if isinstance(n, Product) and n.operator == "cross"), None
    )
    if crossed is None or not any(is_omega(place.lexicon, n) for n in walk(crossed.factors[0])):
        return ""
    if twice:
        return "the Coriolis term {term} is missing"
    inner = [
        n for n in walk(crossed.factors[-1]) if isinstance(n, Product) and n.operator == "cross"
    ]
    if any(is_omega(place.lexicon, n.factors[0]) for n in inner):
        return "the centripetal term {term} is missing"
    frames = [n.frame for n in place.written if isinstance(n, Derivative) and n.frame is not None]
    if frames:
        return f"the derivative was taken in ${latex(frames[-1])}$: {{term}} is missing"
    return "the derivative was taken in the turning frame: {term} is missing"


def _doubled(place: Place) -> str:
    """Name the factor two of a Coriolis term."""
    gained = _gained(place)
    crossed = any(isinstance(n, Product) and n.operator == "cross" for n in walk(place.change.new))
    turning = any(is_omega(place.lexicon, n) for n in walk(place.change.new))
    if gained == Number("2") and crossed and turning:
        return "the Coriolis term counts twice: {new}, not {old}"
    return "" if isinstance(gained, Number | Fraction) else "a number as a factor is missing: {new}"


def _dropped(place: Place) -> str:
    """Say that a whole term is too much."""
    whole = place.change.paths == ((),) and place.change.old is place.option.addend.node
    return "the term {old} does not belong here" if whole else ""


BETTER: Mapping[str, Callable[[Place], str]] = {
    "index": _label,
    "symbol": _named,
    "order": _ordered,
    "lost term": _transported,
    "factor": _doubled,
    "superfluous term": _dropped,
}
"""Better sentences for what stands at the place of a slip, "" for none."""


def _exchanged(places: list[Place]) -> str:
    """Say that two things stand in each other's places, "" if these slips are others."""
    if len(places) != 2:
        return ""
    a, b = (p.change for p in places)
    both = a.old == b.new and a.new == b.old and a.old != a.new
    return f"${latex(a.old)}$ and ${latex(a.new)}$ are exchanged" if both else ""
