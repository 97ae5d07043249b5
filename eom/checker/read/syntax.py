r"""The syntax tree of a formula: what stands on the paper, without any meaning.

Every node carries its span in the source, which comparisons ignore. Nothing is interpreted: ``f(x)``
is a product of a symbol and a group, ``\omega^{BN}`` a symbol with scripts, ``[a]`` a group; which
of them is a call, an angular velocity or a matrix is for the lexicon. What LaTeX writes in several
ways has one form here: fonts go to the symbols, ``\frac{d}{dt}`` is a `Derivative`, ``\triangleq``
and ``:=`` are the sign ``:=``.

The layers, from the outside: `Rows` of an alignment; `Implication`; `Sequence` of items beside each
other; `Relation`, a chain; `Addition`; `Product` with a dot, then with a cross, then juxtaposed;
prefix forms (`BigOperator`, `Integral`, `Derivative`, `Call`); `Scripts` and atoms.

Walking over syntax trees, without recursion: children, all nodes, changes, depth.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields, replace
from functools import wraps
from typing import Any, TypeVar

from eom.checker.read.spans import NOWHERE, Span


@dataclass(frozen=True)
class Node:
    """The root of all nodes; ``span`` is the place in the source of the formula."""

    span: Span = field(default=NOWHERE, compare=False, kw_only=True, repr=False)


# -- leaves --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Number(Node):
    """A decimal number as it is written."""

    text: str


@dataclass(frozen=True)
class Symbol(Node):
    """A letter, the name of a Greek letter or sign (``omega``, ``infty``), or an upright word.

    ``style``: "" (italic), "bold", "roman", "calligraphic", "blackboard", "sans", "fraktur",
    "typewriter". Bold digits such as the zero vector are symbols too.
    """

    name: str
    style: str = ""


@dataclass(frozen=True)
class Words(Node):
    r"""Text within a formula; ``\forall`` and ``\exists`` are ``sign`` "forall", "exists"."""

    text: str
    sign: str = ""


@dataclass(frozen=True)
class Dots(Node):
    """An ellipsis: "cdots", "vdots" or "ddots"."""

    name: str = "cdots"


@dataclass(frozen=True)
class Blank(Node):
    r"""A place holder for any operand: the ``\cdot`` of ``(\cdot)^\bullet``."""


@dataclass(frozen=True)
class Missing(Node):
    """What is left out: before a leading ``=`` or arrow, after a trailing one, an empty cell."""


@dataclass(frozen=True)
class Marks(Node):
    """A script of signs alone: ("bullet", "bullet"), ("times",), ("prime",), ("+",), ("ast",)."""

    names: tuple[str, ...]


@dataclass(frozen=True)
class Sign(Node):
    """A relation or arrow, a name of `RELATIONS` or `ARROWS`; ``above`` is what stands over it."""

    name: str
    above: Node | None = None


# -- decorated -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Accent(Node):
    """A mark on a base: a name of `MARKS`."""

    mark: str
    base: Node


@dataclass(frozen=True)
class Scripts(Node):
    r"""A base with scripts on its right (``sub``, ``sup``) and left (``presub``, ``presup``).

    A prime is a `Marks` above; what stands above a prime or beside a second script is nested.
    """

    base: Node
    sub: Node | None = None
    sup: Node | None = None
    presub: Node | None = None
    presup: Node | None = None


@dataclass(frozen=True)
class Over(Node):
    r"""A base with something above or below that is no accent: ``\overset{0}{\cdot}``."""

    base: Node
    above: Node | None = None
    below: Node | None = None


@dataclass(frozen=True)
class Operation(Node):
    """An operator that stands alone, a name of `PRODUCTS`."""

    name: str


@dataclass(frozen=True)
class Group(Node):
    """A body in brackets: "(", "[", "{", "|", "||", "<", "." (none seen), "" (braces of LaTeX)."""

    body: Node
    open: str = "("
    close: str = ")"


@dataclass(frozen=True)
class Evaluated(Node):
    """A base before a bar with scripts; below the bar of a derivative stands its frame."""

    base: Node
    sub: Node | None = None
    sup: Node | None = None


@dataclass(frozen=True)
class Braced(Node):
    """A body with a brace and a label: ``mark`` "underbrace" or "overbrace"."""

    body: Node
    label: Node | None = None
    mark: str = "underbrace"


@dataclass(frozen=True)
class Boxed(Node):
    """A body in a frame."""

    body: Node


@dataclass(frozen=True)
class Struck(Node):
    """A body that is struck through, ``to`` what it becomes."""

    body: Node
    to: Node | None = None


# -- operations ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Addition(Node):
    """Terms with signs "+", "-", "±", "∓"; the first sign is "" where none is written."""

    terms: tuple[Node, ...]
    signs: tuple[str, ...]


@dataclass(frozen=True)
class Product(Node):
    """Two or more factors in order, all joined by one operator: "" is juxtaposition.

    The others are names of `PRODUCTS`. More than two factors of a cross product without brackets
    are left as they stand, and noted.
    """

    factors: tuple[Node, ...]
    operator: str = ""


@dataclass(frozen=True)
class Quotient(Node):
    """A quotient on the line, by a slash."""

    left: Node
    right: Node


@dataclass(frozen=True)
class Fraction(Node):
    """A quotient with a bar."""

    above: Node
    below: Node


@dataclass(frozen=True)
class Root(Node):
    """A root; without ``degree`` the square root."""

    body: Node
    degree: Node | None = None


@dataclass(frozen=True)
class Call(Node):
    """A named function of `FUNCTIONS`, with its argument: a group, or what follows without brackets."""

    function: str
    argument: Node
    sub: Node | None = None
    sup: Node | None = None


@dataclass(frozen=True)
class Section(Node):
    r"""An operator with one operand missing: ``[\omega \times]``; ``left``: the operand is before it."""

    operand: Node
    operator: str
    left: bool = True


@dataclass(frozen=True)
class BigOperator(Node):
    """A sum or product ("sum", "prod", ...) over a term, with what stands below and above."""

    sign: str
    body: Node
    lower: Node | None = None
    upper: Node | None = None


@dataclass(frozen=True)
class Differential(Node):
    r"""``dm``, ``\mathrm{d}^3 r``, ``\partial q``: ``sign`` is "d", "partial" or "delta"."""

    variable: Node
    order: Node | None = None
    sign: str = "d"


@dataclass(frozen=True)
class Integral(Node):
    r"""An integral: ``integrand`` (None for ``\int dm``), its differentials from inside out, bounds.

    ``sign``: "int", "iint", "iiint", "oint". Without a differential ``variables`` is empty.
    Of ``\int F \cdot dr`` the integrand is a `Section`: its other operand is the differential.
    """

    integrand: Node | None
    variables: tuple[Node, ...]
    lower: Node | None = None
    upper: Node | None = None
    sign: str = "int"


@dataclass(frozen=True)
class Derivative(Node):
    r"""A derivative by a fraction; ``operand`` is None for a bare operator ``\frac{d}{dt}``.

    ``variables`` are what it is taken by (of ``dt`` below: t), ``order`` the power of d (None is 1);
    ``frame`` the superscript on its left, wherever it stood, or the name below brackets or a bar
    around it; ``sign`` "d" or "partial". The layout is not compared: ``form``
    "over" (operand in the numerator), "before" (operator in front), "slash"; ``outside`` says
    whether the frame stands before the whole fraction.
    """

    operand: Node | None
    variables: tuple[Node, ...]
    order: Node | None = None
    frame: Node | None = None
    sign: str = "d"
    form: str = field(default="over", compare=False)
    outside: bool = field(default=False, compare=False)


# -- tables --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Matrix(Node):
    """Rows of cells; ``environment``: "bmatrix", "pmatrix", "array", ...; ``columns`` of an array."""

    rows: tuple[tuple[Node, ...], ...]
    environment: str = "bmatrix"
    columns: str = field(default="", compare=False)


@dataclass(frozen=True)
class Cases(Node):
    """Rows of cells behind a brace; ``side``: where the brace stands."""

    rows: tuple[tuple[Node, ...], ...]
    side: str = "left"


# -- statements ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Relation(Node):
    """A chain: n + 1 members and n signs of `RELATIONS`."""

    members: tuple[Node, ...]
    signs: tuple[Sign, ...]


@dataclass(frozen=True)
class Sequence(Node):
    """Items beside each other; separators: ",", ";", ":", "|", "quad", "" (before or after words)."""

    items: tuple[Node, ...]
    separators: tuple[str, ...]


@dataclass(frozen=True)
class Implication(Node):
    """Items joined by signs of `ARROWS`; the first is `Missing` behind a leading arrow."""

    items: tuple[Node, ...]
    signs: tuple[Sign, ...]


@dataclass(frozen=True)
class Rows(Node):
    """The rows of an alignment; what continues a row above has been joined to it."""

    rows: tuple[Node, ...]


# -- names ---------------------------------------------------------------------------------------

RELATIONS: dict[str, str] = {
    "=": "=",
    ":=": r"\triangleq",
    "=:": "=:",
    "!=": r"\neq",
    "<": "<",
    ">": ">",
    "<=": r"\le",
    ">=": r"\ge",
    "<<": r"\ll",
    ">>": r"\gg",
    "from": r"\leftarrow",
    "between": r"\leftrightarrow",
    **{
        name: rf"\{name}"
        for name in "equiv approx simeq cong sim propto in notin subset parallel perp to mapsto".split()
    },
}
"""Relations with their LaTeX; ``:=`` defines its left side, ``=:`` its right side."""

ARROWS: dict[str, str] = {
    "implies": r"\Rightarrow",
    "implied by": r"\Leftarrow",
    "equivalent": r"\Leftrightarrow",
    "therefore": r"\therefore",
    "because": r"\because",
    "leads to": r"\hookrightarrow",
}
"""Arrows between statements with their LaTeX."""

PRODUCTS: dict[str, str] = {
    "dot": r"\cdot",
    "double dot": ":",
    "cross": r"\times",
    "wedge": r"\wedge",
    "tensor": r"\otimes",
    "circledot": r"\odot",
    "circle": r"\circ",
    "asterisk": "*",
    "star": r"\star",
    "divided": r"\div",
    "circledplus": r"\oplus",
    "circledminus": r"\ominus",
    "direct cross": r"\boxtimes",
}
"""Operators of products with their LaTeX; "dot" and "double dot" bind less than all others."""

MARKS = frozenset(
    "vec hat bar tilde dot ddot dddot ddddot underline ring check breve acute grave "
    "harpoon bullet circle double_bar undertilde underarrow prime_over".split()
)
"""Names of accents; wide forms are the same as narrow ones."""


T = TypeVar("T")

_NAMES: dict[str, tuple[str, ...]] = {}


def _names(node: Node) -> tuple[str, ...]:
    """Return the fields of a kind of node; they are asked for often."""
    kind = type(node).__name__
    if kind not in _NAMES:
        _NAMES[kind] = tuple(f.name for f in fields(node) if f.name != "span")
    return _NAMES[kind]


def kept(rule: Callable[[Node], T]) -> Callable[[Node], T]:
    """Return a function of a node that is worked out once, and kept with it: a node never changes."""
    name = f"{rule.__name__}()"

    @wraps(rule)
    def found(node: Node) -> T:
        own = node.__dict__
        if name not in own:
            own[name] = rule(node)
        value: T = own[name]
        return value

    return found


@kept
def children(node: Node) -> tuple[Node, ...]:
    """Return the nodes directly below, in the order of the fields."""
    found: list[Node] = []
    for name in _names(node):
        _gather(getattr(node, name), found)
    return tuple(found)


def _gather(value: Any, found: list[Node]) -> None:
    if isinstance(value, Node):
        found.append(value)
    elif isinstance(value, tuple) and not isinstance(value, Span):
        for v in value:
            _gather(v, found)


def walk(node: Node) -> Iterator[Node]:
    """Yield every node, parents first."""
    stack = [node]
    while stack:
        node = stack.pop()
        yield node
        stack += reversed(children(node))


def depth(node: Node) -> int:
    """Return the number of nodes on the longest way down."""
    deepest, level = 0, [node]
    while level:
        deepest += 1
        level = [c for n in level for c in children(n)]
    return deepest


def transform(node: Node, rule: Callable[[Node], Node]) -> Node:
    """Apply ``rule`` to every node, children first; spans stay, and so does what does not change."""
    order = list(walk(node))
    done: dict[int, Node] = {}
    for n in reversed(order):
        done[id(n)] = rule(_rebuilt(n, done))
    return done[id(node)]


def _rebuilt(node: Node, done: dict[int, Node]) -> Node:
    """Return a node over its changed children."""
    old = {name: getattr(node, name) for name in _names(node)}
    new = {name: _changed(value, done) for name, value in old.items()}
    changed = {name: value for name, value in new.items() if value is not old[name]}
    return replace(node, **changed) if changed else node


def _changed(value: Any, done: dict[int, Node]) -> Any:
    """Return the same object where nothing changes."""
    if isinstance(value, Node):
        return done[id(value)]
    if isinstance(value, tuple):
        new = tuple(_changed(v, done) for v in value)
        return value if all(a is b for a, b in zip(new, value, strict=True)) else new
    return value
