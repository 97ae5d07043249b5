r"""Known slips of the pen and of scans, each as a small edit that undoes it.

A row of `SLIPS` looks at one node and offers what may have been meant instead. ``weight``: the larger,
the less plausible; an offer may add to it. Rules are blind to meaning: an edit that gives no value, or
a false line, is dropped by those who apply them.

Slips in what stands on symbols: dots and other derivatives, tildes, crosses, transposes.

Slips in signs, numbers and powers, in terms, factors and their order.

Slips in letters and labels: indices, points, frames, letters that look alike.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

from eom.checker.read.paths import NOTHING, Path, at, places, put, tidy
from eom.checker.read.symbol_shape import DOTS, seen
from eom.checker.read.syntax import (
    Accent,
    Addition,
    Braced,
    Call,
    Derivative,
    Fraction,
    Group,
    Integral,
    Marks,
    Matrix,
    Node,
    Number,
    Product,
    Quotient,
    Root,
    Scripts,
    Section,
    Symbol,
)
from eom.checker.repair.lines import Addend, Offer, Palette, Signature, relabelled
from eom.terms.terms import Term

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
            for new in relabelled(script, palette):
                yield _cornered(node, corner, new), 0.0


def _cornered(node: Scripts, corner: str, new: Node) -> Scripts:
    corners = {"sub": node.sub, "sup": node.sup, "presub": node.presub, "presup": node.presup}
    corners[corner] = new
    return Scripts(node.base, **corners, span=node.span)


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
            kinds = [palette.quantities.get(n, "") for n in (node, other)]
            extra = _distance(given.look.name, new.look.name) + min(0.4, 0.01 * rank)
            extra = min(extra, SAME_KIND) if kinds[0] and kinds[0] == kinds[1] else extra
            yield other, extra
            more = dotted(other)
            if more is not None and not new.dots:
                yield more, extra + (0.1 if given.dots else 0.4)


SAME_KIND = -0.4
"""What it weighs less at least to put another quantity of the same kind in place of one."""


def _distance(old: str, new: str) -> float:
    if old == new:
        return -0.3
    near = any({old, new} <= row for row in NEIGHBOURS) or old.casefold() == new.casefold()
    return -0.3 if near else 0.2


# -- signs, numbers, powers ------------------------------------------------------------------------


def signs(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer another sign of a term or of an entry."""
    if isinstance(node, Addition):
        for k, sign in enumerate(node.signs):
            new = "-" if sign in {"", "+"} else "+" if k else ""
            yield replace(node, signs=(*node.signs[:k], new, *node.signs[k + 1 :])), 0.0
    if isinstance(node, Matrix):
        for r, row in enumerate(node.rows):
            for c, cell in enumerate(row):
                if not isinstance(cell, Addition) and cell != Number("0"):
                    minus = Addition((cell,), ("-",), span=cell.span)
                    new_row = (*row[:c], minus, *row[c + 1 :])
                    yield replace(node, rows=(*node.rows[:r], new_row, *node.rows[r + 1 :])), 0.0


ONE = Number("1")
HALF = Fraction(Number("1"), Number("2"))
_FACTORS: tuple[tuple[Node, float], ...] = ((HALF, 0.0), (Number("2"), 0.0), (Number("3"), 0.5))


def missing_number(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a half, two or three as a factor."""
    plain = isinstance(node, Product) and not isinstance(node.factors[0], Number | Fraction)
    other = isinstance(node, Integral | Derivative) or seen(node) is not None
    if plain or (other and not isinstance(node, Number)):
        for factor, extra in _FACTORS:
            loose = isinstance(node, Product) and node.operator
            body = (factor, node) if not loose else (factor, *_first_of(node))
            if loose and isinstance(node, Product):
                yield replace(node, factors=(Product(body[:2]), *node.factors[1:])), extra
            else:
                yield Product(body, span=node.span), extra


def _first_of(node: Node) -> tuple[Node, ...]:
    return node.factors[:1] if isinstance(node, Product) else (node,)


_SWAPPED = {"1": ("2", "0"), "2": ("1", "3"), "3": ("1", "2"), "4": ("2",), "0": ("1",)}


def other_number(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer another number."""
    if isinstance(node, Number):
        for text in _SWAPPED.get(node.text, ()):
            yield replace(node, text=text), 0.2
    below = node.below if isinstance(node, Fraction) and isinstance(node.above, Number) else None
    if isinstance(below, Number):
        yield Number(below.text, span=node.span), 0.1


_POWERS = {"2": ("3", "4"), "3": ("2", "4", "5"), "4": ("2", "3"), "5": ("3", "4")}


def exponent(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer another exponent, one more or none."""
    if isinstance(node, Scripts) and isinstance(node.sup, Number):
        for text in _POWERS.get(node.sup.text, ()):
            yield replace(node, sup=Number(text, span=node.sup.span)), 0.0
        yield without_sup(node), 0.0
        return
    bare = seen(node) is not None and not (isinstance(node, Scripts) and node.sup is not None)
    if (bare or (isinstance(node, Group) and node.open == "(")) and not isinstance(node, Number):
        base = node if isinstance(node, Scripts) else Scripts(node, span=node.span)
        yield replace(base, sup=Number("2")), 0.0
    if isinstance(node, Call):
        if node.sup is None:
            yield replace(node, sup=Number("2")), 0.0
        elif node.sup == Number("2"):
            yield replace(node, sup=None), 0.0
    if isinstance(node, Root):
        yield node.body, 0.2


def power_of_sum(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a power of a sum taken of each of its terms, and one of all terms taken of the sum."""
    whole, inside = isinstance(node, Scripts), node.base if isinstance(node, Scripts) else node
    if not (isinstance(inside, Group) and isinstance(inside.body, Addition)):
        return
    terms = inside.body.terms
    if isinstance(node, Scripts) and isinstance(node.sup, Number):
        found = [t if t == ONE else Scripts(_bracketed(t), None, node.sup) for t in terms]
        yield replace(inside, body=replace(inside.body, terms=tuple(found))), 0.0
    powers = {t.sup for t in terms if isinstance(t, Scripts)}
    if not whole and len(powers) == 1 and all(isinstance(t, Scripts) or t == ONE for t in terms):
        bare = tuple(without_sup(t) if isinstance(t, Scripts) else t for t in terms)
        yield Scripts(replace(inside, body=replace(inside.body, terms=bare)), None, *powers), 0.0


def _bracketed(node: Node) -> Node:
    return node if seen(node) is not None or isinstance(node, Number | Group) else Group(node)


_TRIG = {"sin": ("cos",), "cos": ("sin",), "tan": ("sin", "cos", "cot"), "s": ("c",), "c": ("s",)}


def functions(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer sine for cosine, and so on, also where one letter with an angle below stands for them."""
    if isinstance(node, Call):
        yield from ((replace(node, function=n), 0.0) for n in _TRIG.get(node.function, ()))
    if isinstance(node, Scripts) and isinstance(node.base, Symbol):
        short = (replace(node.base, name=n) for n in _TRIG.get(node.base.name, ()))
        yield from ((replace(node, base=b), 0.0) for b in short)


# -- terms and factors -----------------------------------------------------------------------------


def superfluous_term(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a sum without one of its terms."""
    if isinstance(node, Addition) and len(node.terms) > 1:
        for k in range(len(node.terms)):
            yield replace(node, terms=(*node.terms[:k], NOTHING, *node.terms[k + 1 :])), 0.0
    inside = node.body if isinstance(node, Group) and node.open == "(" else None
    if isinstance(inside, Addition) and len(inside.terms) == 2:
        for sign, term in zip(inside.signs, inside.terms, strict=True):
            if sign != "-" and (seen(term) is not None or isinstance(term, Group)):
                yield term, -0.1


_PLAIN = -0.35
"""What it weighs less to leave out a number than any other factor."""


def _is_number(node: Node) -> bool:
    if isinstance(node, Fraction):
        return isinstance(node.above, Number) and isinstance(node.below, Number)
    return isinstance(node, Number)


def superfluous_factor(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a product without one of its factors."""
    if isinstance(node, Product):
        for k, factor in enumerate(node.factors):
            extra = _PLAIN if _is_number(factor) else 0.0
            rest = (*node.factors[:k], NOTHING, *node.factors[k + 1 :])
            yield replace(node, factors=rest), extra
    if isinstance(node, Fraction):
        yield node.above, 0.3
    if isinstance(node, Call) and isinstance(node.argument, Node):
        yield NOTHING, 0.4


def missing_factor(node: Node, palette: Palette) -> Iterator[Offer]:
    """Put a factor of the line before, between or behind those of a product."""
    if isinstance(node, Number | Addition | Matrix):
        return
    juxtaposed = isinstance(node, Product) and not node.operator
    if not juxtaposed and (isinstance(node, Product) or not _factor_like(node)):
        return
    factors = node.factors if isinstance(node, Product) else (node,)
    for new in palette.factors:
        for k in range(len(factors) + 1):
            yield Product((*factors[:k], new, *factors[k:]), span=node.span), 0.0
    for new in palette.near:
        for k in sorted({0, len(factors)}):
            yield Product((*factors[:k], new, *factors[k:]), span=node.span), 0.3


def missing_term(node: Node, palette: Palette) -> Iterator[Offer]:
    """Put another symbol of the note into a bracket, as a term of its sum."""
    if isinstance(node, Group) and node.open == "(" and not isinstance(node.body, Section):
        body = node.body
        whole = isinstance(body, Addition)
        terms, signs = (body.terms, body.signs) if isinstance(body, Addition) else ((body,), ("",))
        for rank, new in enumerate(n for n in palette.symbols if n not in terms):
            more = 0.01 * rank
            yield replace(node, body=Addition((*terms, new), (*signs, "-"))), more
            first = whole and signs[0] == "-"
            both = ((new, *terms), ("", *signs)) if first else ((*terms, new), (*signs, "+"))
            yield replace(node, body=Addition(*both)), more


def _factor_like(node: Node) -> bool:
    return seen(node) is not None or isinstance(node, Group | Call | Derivative | Integral)


def missing_cross(node: Node, palette: Palette) -> Iterator[Offer]:
    """Put ``omega x`` of the line before a vector."""
    whole = isinstance(node, Product) and not node.operator
    if seen(node) is not None or isinstance(node, Group) or whole:
        for new in palette.omegas:
            if new != node:
                yield Product((new, node), "cross", span=node.span), 0.0
                yield Group(Product((new, node), "cross"), span=node.span), 0.1


_VECTOR_LIKE = (Group, Derivative, Integral, Braced)


def missing_vector(node: Node, palette: Palette) -> Iterator[Offer]:
    """Put a vector of the line before another one or behind it, with a cross or a dot between."""
    whole = isinstance(node, Product) and node.operator in {"", "cross"}
    if not whole and not (seen(node) is not None or isinstance(node, _VECTOR_LIKE)):
        return
    body = Group(node, span=node.span) if isinstance(node, Product) and node.operator else node
    alone = seen(node) is not None or isinstance(node, Group)
    for rank, new in enumerate(n for n in palette.vectors if n != node):
        for pair in ((new, body), (body, new)):
            crossed = Product(pair, "cross", span=node.span)
            yield Group(crossed) if alone else crossed, 0.01 * rank
            yield Product(pair, "dot", span=node.span), 0.1 + 0.01 * rank
        yield Product((Product((HALF, new)), body), "dot", span=node.span), 0.3 + 0.01 * rank


def order(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer two neighbours of a product exchanged, or all of it the other way round."""
    if isinstance(node, Product) and node.operator in {"", "cross", "tensor"}:
        for k in range(len(node.factors) - 1):
            a, b = node.factors[k : k + 2]
            yield replace(node, factors=(*node.factors[:k], b, a, *node.factors[k + 2 :])), 0.0
        called = [k for k, n in enumerate(node.factors) if not (k and isinstance(n, Group))]
        parts = [node.factors[i:j] for i, j in pairwise([*called, len(node.factors)])]
        if len(parts) > 2:
            yield replace(node, factors=tuple(n for p in reversed(parts) for n in p)), 0.0


def operator(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer another product."""
    swapped = {"dot": ("cross", ""), "cross": ("dot", ""), "": ()}
    if isinstance(node, Product):
        for other in swapped.get(node.operator, ()):
            yield replace(node, operator=other), 0.2 if not other else 0.0
        if not node.operator and len(node.factors) >= 2:
            for k in range(1, len(node.factors)):
                left, right = (_joined(p) for p in (node.factors[:k], node.factors[k:]))
                for operator in ("cross", "dot"):
                    yield Product((left, right), operator, span=node.span), 0.1
    if isinstance(node, Section):
        yield node.operand, 0.0
    if isinstance(node, Group) and node.open == "[" and not isinstance(node.body, Section):
        yield replace(node, body=Section(node.body, "cross", span=node.body.span)), 0.0


def _joined(factors: tuple[Node, ...]) -> Node:
    return factors[0] if len(factors) == 1 else Product(factors)


def upside_down(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a fraction upside down."""
    if isinstance(node, Fraction):
        yield replace(node, above=node.below, below=node.above), 0.0
    if isinstance(node, Quotient):
        yield replace(node, left=node.right, right=node.left), 0.0


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
    """Put a derivative in a frame before a symbol: the frame cannot be seen by a dot."""
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


def transposed(node: Node, _: Palette) -> Iterator[Offer]:
    """Offer a square table with rows and columns exchanged."""
    if isinstance(node, Matrix) and 1 < len(node.rows) == len(node.rows[0]):
        yield replace(node, rows=tuple(zip(*node.rows, strict=True))), 0.0


Rule = Callable[[Node, Palette], Iterable[Offer]]


@dataclass(frozen=True)
class Slip:
    """A row: name, what was done in words, weight, rule; ``uniform``: often done all over a line."""

    name: str
    words: str
    weight: float
    rule: Rule
    uniform: bool = False


@dataclass(frozen=True)
class Change:
    """A slip undone: what stood at some places of a tree, and what stands there now.

    ``added``: what is added there, with its sign, "" for nothing.
    """

    slip: Slip
    old: Node
    new: Node
    paths: tuple[Path, ...] = ((),)
    added: str = ""


class _Changed:
    """Slips that are undone together."""

    changes: tuple[Change, ...]

    @property
    def first(self) -> Change:
        """The first of the slips."""
        return self.changes[0]

    @property
    def slip(self) -> Slip:
        """The kind of the first slip."""
        return self.first.slip


@dataclass(frozen=True)
class Edit(_Changed):
    """Slips undone in a tree: how implausible they are, and the new tree."""

    weight: float
    tree: Node
    changes: tuple[Change, ...]


# -- the table -------------------------------------------------------------------------------------

SLIPS: tuple[Slip, ...] = (
    Slip("lost dot", "a dot was lost", 1.0, more_dots, uniform=True),
    Slip("superfluous dot", "a dot is too much", 1.0, fewer_dots, uniform=True),
    Slip("lost tilde", "a tilde or cross was lost", 1.0, more_skew, uniform=True),
    Slip("superfluous tilde", "a tilde or cross is too much", 1.1, fewer_skew, uniform=True),
    Slip("transpose", "a transpose was lost or is too much", 1.0, transpose, uniform=True),
    Slip("transposed table", "rows and columns of a table exchanged", 1.0, transposed),
    Slip("sign", "a sign", 1.0, signs),
    Slip("sine or cosine", "sine and cosine exchanged", 1.0, functions, uniform=True),
    Slip("index", "another label: index, point or frame", 1.05, labels, uniform=True),
    Slip("factor", "a number as a factor was lost", 1.1, missing_number),
    Slip("number", "another number", 1.1, other_number),
    Slip("exponent", "another exponent", 1.15, exponent, uniform=True),
    Slip("power of a sum", "a power of a sum is not that of its terms", 1.15, power_of_sum),
    Slip("frame of the derivative", "the frame of a derivative", 1.05, frame_of_derivative),
    Slip("mark of the derivative", "the mark of a derivative", 1.1, other_mark, uniform=True),
    Slip("order", "factors in another order", 1.1, order),
    Slip("operator", "another product", 1.2, operator),
    Slip("superfluous term", "a term is too much", 1.6, superfluous_term),
    Slip("superfluous factor", "a factor is too much", 1.4, superfluous_factor),
    Slip("lost factor", "a factor was lost", 1.4, missing_factor),
    Slip("lost part", "a term in a bracket was lost", 1.4, missing_term),
    Slip("lost cross product", "omega times was lost", 1.4, missing_cross),
    Slip("lost vector", "a vector with its product was lost", 1.5, missing_vector),
    Slip("lost derivative", "a derivative was lost", 1.4, derived),
    Slip("raised dot", "a dot on the line that was raised", 1.5, raised_dot),
    Slip("upside down", "a fraction upside down", 1.3, upside_down),
    Slip("symbol", "another symbol", 1.6, letters, uniform=True),
)
"""Every slip, with its weight."""

TERM = Slip("sign", "a sign", 1.0, lambda _, __: ())
FORGOTTEN = Slip("lost factor", "a factor was lost", 1.4, lambda _, __: ())
FACTOR = Slip("number", "another number", 1.04, lambda _, __: ())
DROPPED = Slip("superfluous term", "a term is too much", 1.6, lambda _, __: ())
LOST = Slip("lost term", "a term was lost", 1.5, lambda _, __: ())
"""Slips of a whole term of a line."""

MANY = frozenset({"lost factor", "lost part", "lost vector", "symbol"})
"""Slips that offer something for every symbol of the note."""
ALL_OVER = 0.35
"""What the same slip weighs at each place beyond the first."""
MAX_EDITS = 1200
"""Edits of one term that are tried at most."""


def _everywhere_tried(_: Path) -> bool:
    return False


def edits(
    node: Node,
    palette: Palette,
    spared: Callable[[Path], bool] = _everywhere_tried,
    kinds: tuple[bool, ...] = (False, True),
) -> list[Edit]:
    """Return the slips undone in a tree, one each, and those of one kind at all equal places.

    ``spared``: says at which places nothing need be tried; ``kinds``: whether slips are undone that offer
    something for every symbol of the note, and others.
    """
    found: dict[Node, Edit] = {}
    for edit in _single(node, palette, spared, kinds):
        _keep(found, edit, node)
        if len(found) >= MAX_EDITS:
            return _sorted(found)
    for edit in _everywhere(node, list(found.values()), spared):
        _keep(found, edit, node)
    return _sorted(found)


def _single(
    node: Node, palette: Palette, spared: Callable[[Path], bool], kinds: tuple[bool, ...]
) -> Iterator[Edit]:
    """Yield edits of one place each; the slips that offer much come last, at all places."""
    here_and_below = [(p, n) for p, n in places(node) if not spared(p)]
    for many in kinds:
        chosen = [s for s in SLIPS if (s.name in MANY) == many]
        for path, here in here_and_below:
            for slip in chosen:
                for new, extra in slip.rule(here, palette):
                    tree = put(node, path, new)
                    yield Edit(slip.weight + extra, tree, (Change(slip, here, tidy(new), (path,)),))


def _sorted(found: dict[Node, Edit]) -> list[Edit]:
    return sorted(found.values(), key=lambda e: e.weight)


def _keep(found: dict[Node, Edit], edit: Edit, before: Node) -> None:
    known = found.get(edit.tree)
    if edit.tree != before and (known is None or edit.weight < known.weight):
        found[edit.tree] = edit


def _everywhere(node: Node, single: list[Edit], spared: Callable[[Path], bool]) -> Iterator[Edit]:
    """Yield what was done at one place done at all places where the same stands."""
    done: set[tuple[str, Node, Node]] = set()
    standing: dict[Node, list[Path]] = {}
    for path, here in places(node):
        if not spared(path):
            standing.setdefault(here, []).append(path)
    for edit in single:
        change = edit.first
        paths = standing.get(change.old, [])
        key = (edit.slip.name, change.old, change.new)
        if not edit.slip.uniform or len(paths) < 2 or key in done:
            continue
        done.add(key)
        tree = node
        for path in paths:
            tree = put(tree, path, change.new)
        weight = edit.weight + ALL_OVER * (len(paths) - 1)
        yield Edit(weight, tree, (replace(change, paths=tuple(paths)),))


@dataclass(frozen=True)
class Option(_Changed):
    """What may stand for a term: another node, the other sign, or nothing; with its value.

    ``changes``: what is undone within the term.
    """

    addend: Addend
    weight: float
    node: Node
    sign: int
    changes: tuple[Change, ...]
    term: Term | None = None
    signature: Signature | None = None

    @property
    def appended(self) -> bool:
        """Whether a term is added behind the others."""
        return self.slip is LOST and self.node is self.first.new
