"""What is left over in a wrong line, in the writer's own symbols: short sums of products of its factors.

Of a line about a system it is known without a search. Terms that a line has lost: its residual fitted by
products of its own factors, whole or by entries.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction as Ratio
from functools import cached_property
from itertools import combinations_with_replacement, pairwise, product

import sympy as sp

from eom.checker.judge.models import Drawn
from eom.checker.judge.systems import Solutions, residual
from eom.checker.mean.claims import CONSTANT
from eom.checker.mean.dimensions import RATE, Dimension
from eom.checker.mean.elaborate import abbreviated
from eom.checker.mean.model import printed
from eom.checker.mean.values import ROW, Value
from eom.checker.read.grammar import read_formula
from eom.checker.read.paths import NOTHING, at, operands, places
from eom.checker.read.symbol_shape import seen
from eom.checker.read.syntax import (
    Addition,
    Call,
    Derivative,
    Fraction,
    Group,
    Node,
    Number,
    Product,
    Scripts,
    children,
)
from eom.checker.read.writing import latex
from eom.checker.repair.lines import (
    Addend,
    Line,
    Member,
    Signature,
    agrees,
    signature,
    valued,
    worth,
)
from eom.checker.repair.slips import LOST, Change, Option, dotted
from eom.errors import InputError
from eom.fields import PRIME, RESIDUES, Singular
from eom.system import Expr
from eom.terms.terms import COLUMN, DYADIC, MATRIX, SCALAR, VECTOR, Term

COEFFICIENTS: tuple[Ratio, ...] = tuple(
    sign * Ratio(c) for c in ("1", "2", "1/2", "3", "3/2", "1/3", "4", "1/4") for sign in (1, -1)
)
"""Numbers before a product that are tried."""
ATOMS = 14
DEGREE = 4
MOST = 900
"""Products that are tried at most."""
SHORT = 3
"""Terms that are left over at most, if they are added to a line."""
ALTERNATIVES = 3
"""Products that are offered at most where several are the same in a world."""


@dataclass(frozen=True)
class Item:
    """A product of factors of a line: tree, term, signature."""

    node: Node
    term: Term
    signature: Signature


@dataclass(frozen=True)
class Piece:
    """A product with its number before it."""

    coefficient: Ratio
    item: Item


def items(line: Line, roots: Iterable[Node], kind: Signature) -> list[Item]:
    """Return products of the factors below some nodes that have a signature, the simplest first."""
    atoms = _atoms(line, roots)
    found: dict[Term, Item] = {}
    for k, node in enumerate(_products(atoms, _before(line, kind))):
        if k == MOST:
            break
        value = worth(line, node)
        if value is not None and not value.is_zero and agrees(signature(value), kind):
            found.setdefault(value.term, Item(node, value.term, kind))
    return list(found.values())


def _before(line: Line, kind: Signature) -> Signature:
    """Return the signature of what counts by its rate in a line that says what is constant."""
    dimension = kind[2]
    if line.claim.kind != CONSTANT or dimension is None:
        return kind
    return (*kind[:2], dimension.times(RATE.power(-1)))


_Atom = tuple[Node, Value]


def _atoms(line: Line, roots: Iterable[Node]) -> list[_Atom]:
    """Return factors with values: as they stand, then with a dot more; the outermost symbols alone."""
    standing = list(dict.fromkeys(n for r in roots for n in _factors(line, r)))[:ATOMS]
    more = [d for n in standing for d in [dotted(n)] if d is not None]
    less = [b for n in standing for b in _bare(n)]
    found: dict[Node, _Atom] = {}
    for node in (*standing, *less, *more):
        value = valued(line.elaborator, node)
        if value is not None and not value.is_zero:
            found.setdefault(node, (node, value))
    return list(found.values())


def _bare(node: Node) -> Iterator[Node]:
    given = seen(node)
    base = getattr(node, "base", None)
    if given is not None and given.dots and isinstance(base, Node):
        yield base


def _factors(line: Line, root: Node) -> Iterator[Node]:
    stack = [root]
    while stack:
        node = stack.pop()
        short = list(_abbreviated(line, node))
        if short:
            yield from short
            left = [f for f in children(node) if not any(f in children(p) for p in short)]
            stack += reversed(left)
            continue
        given = seen(node)
        bracket = isinstance(node, Group) and (
            isinstance(node.body, Addition) or (node.open == "[" and seen(node.body) is not None)
        )
        if bracket or isinstance(node, Call) or (given is not None and given.look.name.isalpha()):
            yield node
            if not isinstance(node, Group) or not isinstance(node.body, Addition):
                continue
        if isinstance(node, Derivative) and node.operand is not None and seen(node.operand):
            yield node
        below = children(node) if isinstance(node, Product) else tuple(n for _, n in operands(node))
        stack += reversed(below)


def _abbreviated(line: Line, node: Node) -> Iterator[Node]:
    r"""Yield functions that are written with a letter and an angle, like ``s\theta``."""
    if isinstance(node, Product) and not node.operator:
        for letter, angle in pairwise(node.factors):
            if abbreviated(line.elaborator, letter, angle) is not None:
                yield Product((letter, angle), span=letter.span.join(angle.span))


# -- products ------------------------------------------------------------------------------------

_VECTORS, _DYADICS = frozenset({VECTOR, COLUMN}), frozenset({DYADIC, MATRIX})


def _products(atoms: list[_Atom], kind: Signature) -> Iterator[Node]:
    """Yield products with the right dimension; shapes are sorted out by elaboration."""
    rows = {
        "scalar": _row(atoms, frozenset({SCALAR})),
        "vector": _row(atoms, frozenset({VECTOR, COLUMN})),
        "dyadic": _row(atoms, frozenset({DYADIC, MATRIX})),
    }
    wanted = _exponents(kind[2])
    for scalars in range(DEGREE + 1):
        for shape, join in _SHAPES.get(kind[0], ()):
            if not 0 < len(shape) + scalars <= DEGREE:
                continue
            for numbers in combinations_with_replacement(rows["scalar"], scalars):
                for rest in product(*(rows[s] for s in shape)):
                    if _fitting((*numbers, *rest), wanted):
                        yield _joined([n for n, _ in numbers], join([n for n, _ in rest]))


_Sized = tuple[Node, int | None]
_BITS = 16
"""Between the twelfths of one base unit and the next: more than those of a product take."""


def _row(atoms: list[_Atom], shapes: frozenset[str]) -> list[_Sized]:
    """Return the atoms of some shapes with their dimensions."""
    return [(n, _exponents(v.dimension)) for n, v in atoms if v.shape in shapes]


def _exponents(dimension: Dimension | None) -> int | None:
    """Return the twelfths of a dimension in one number, of a product their sum; None where not known."""
    if dimension is None:
        return None
    return sum(int(12 * e) << (_BITS * k) for k, e in enumerate(dimension))


def _fitting(parts: Iterable[_Sized], wanted: int | None) -> bool:
    """Return whether a product may have a dimension: what has none that is known fits every one."""
    found = 0
    for _, exponents in parts:
        if exponents is None:
            return True
        found += exponents
    return wanted is None or found == wanted


def _joined(numbers: list[Node], rest: Node | None) -> Node:
    parts = list(numbers)
    if rest is None:
        return parts[0] if len(parts) == 1 else Product(_powers(parts))
    if not parts:
        return rest
    if isinstance(rest, Product) and rest.operator == "cross":
        return Product((*_powers(parts), Group(rest)))
    return Product((*_powers(parts), rest))


def _powers(parts: list[Node]) -> tuple[Node, ...]:
    """Return equal factors as powers."""
    found: list[Node] = []
    for node in dict.fromkeys(parts):
        count = parts.count(node)
        plain = not isinstance(node, Call | Scripts | Product) or (
            isinstance(node, Scripts) and node.sup is None
        )
        if count > 1 and plain and not isinstance(node, Call):
            base = node if isinstance(node, Scripts) else Scripts(node)
            found.append(replace(base, sup=Number(str(count))))
        elif count > 1 and isinstance(node, Call) and node.sup is None:
            found.append(replace(node, sup=Number(str(count))))
        else:
            found += [node] * count
    return tuple(found)


def _cross(parts: list[Node]) -> Node:
    return Product(tuple(parts), "cross")


_Join = Callable[[list[Node]], Node | None]
_SHAPES: dict[str, tuple[tuple[tuple[str, ...], _Join], ...]] = {
    SCALAR: (
        ((), lambda _: None),
        (("vector", "vector"), lambda p: Product(tuple(p), "dot")),
        (("vector", "dyadic", "vector"), lambda p: Product(tuple(p), "dot")),
    ),
    VECTOR: (
        (("vector",), lambda p: p[0]),
        (("vector", "vector"), _cross),
        (("dyadic", "vector"), lambda p: Product(tuple(p), "dot")),
        (
            ("vector", "dyadic", "vector"),
            lambda p: _cross([p[0], Group(Product((p[1], p[2]), "dot"))]),
        ),
        (("vector", "vector", "vector"), lambda p: _cross([p[0], Group(_cross(p[1:]))])),
    ),
    COLUMN: (
        (("vector",), lambda p: p[0]),
        (("vector", "vector"), _cross),
        (("dyadic", "vector"), lambda p: Product(tuple(p))),
        (("vector", "dyadic", "vector"), lambda p: _cross([p[0], Product((p[1], p[2]))])),
        (("vector", "vector", "vector"), lambda p: _cross([p[0], Group(_cross(p[1:]))])),
        (("dyadic", "dyadic", "vector"), lambda p: Product(tuple(p))),
    ),
    MATRIX: (
        (("dyadic",), lambda p: p[0]),
        (("dyadic", "dyadic"), lambda p: Product(tuple(p))),
    ),
    DYADIC: ((("dyadic",), lambda p: p[0]),),
    ROW: (),
}
"""Products of each shape: of what, and how they are joined."""


# -- fits ----------------------------------------------------------------------------------------


def fits(
    number_of: Callable[[Term], int | None], pool: Sequence[Item], wanted: int
) -> Iterator[tuple[Piece, ...]]:
    """Yield single products that have a number in a model; without any, a sum of two."""
    numbers = [(number_of(i.term), i) for i in pool]
    known = [(n, i) for n, i in numbers if n]
    scaled: dict[int, list[Piece]] = {}
    for coefficient in COEFFICIENTS:
        factor = _modulo(coefficient)
        for number, item in known:
            scaled.setdefault(factor * number % PRIME, []).append(Piece(coefficient, item))
    single = scaled.get(wanted % PRIME, [])[:ALTERNATIVES]
    yield from ((piece,) for piece in single)
    if single:
        return
    for number, item in known[:300]:
        for sign in (1, -1):
            others = scaled.get((wanted - sign * number) % PRIME, [])
            if others and others[0].item.term != item.term:
                yield Piece(Ratio(sign), item), others[0]
                return


def _modulo(ratio: Ratio) -> int:
    return int(RESIDUES.of(ratio))


def scaled(piece: Piece) -> tuple[str, Node]:
    """Return a product with its number as a sign and a tree."""
    size = abs(piece.coefficient)
    node, minus = _unsigned(piece.item.node)
    sign = "-" if (piece.coefficient < 0) != minus else "+"
    if size == 1:
        return sign, node
    return sign, rescaled(node, size)


def rescaled(node: Node, ratio: Ratio) -> Node:
    """Return a term times a positive number, which is put together with the number it has."""
    if isinstance(node, Product):
        first, rest = node.factors[0], node.factors[1:]
        own = _number(first)
        if node.operator:
            return replace(node, factors=(rescaled(first, ratio), *rest))
        whole = ratio if own is None else ratio * own
        kept = rest if own is not None else node.factors
        return _times(whole, kept)
    own = _number(node)
    if own is not None:
        return _written(ratio * own)
    if isinstance(node, Fraction):
        above, below = (_parted(n) for n in (node.above, node.below))
        whole = ratio * above[0] / below[0]
        over, under = Ratio(whole.numerator), Ratio(whole.denominator)
        return replace(node, above=_times(over, above[1]), below=_times(under, below[1]))
    return _times(ratio, (Group(node) if isinstance(node, Addition) else node,))


def times(node: Node, symbol: Node) -> Node:
    """Return a term times a symbol, behind the number it begins with."""
    if isinstance(node, Product) and node.operator:
        return replace(node, factors=(times(node.factors[0], symbol), *node.factors[1:]))
    factors = node.factors if isinstance(node, Product) else (node,)
    if _number(factors[0]) is not None:
        return Product((factors[0], symbol, *factors[1:]))
    return Product((symbol, *(Group(f) if isinstance(f, Addition) else f for f in factors)))


def numbered(node: Node) -> Ratio:
    """Return the number that a term begins with."""
    if isinstance(node, Fraction) and _number(node) is None:
        return _parted(node.above)[0] / _parted(node.below)[0]
    return _parted(node)[0]


def _parted(node: Node) -> tuple[Ratio, tuple[Node, ...]]:
    """Return the number that a product begins with, and its other factors."""
    factors = node.factors if isinstance(node, Product) and not node.operator else (node,)
    own = _number(factors[0])
    return (Ratio(1), factors) if own is None else (own, factors[1:])


def _number(node: Node) -> Ratio | None:
    """Return the value of a number or of a fraction of two."""
    if isinstance(node, Fraction):
        above, below = _number(node.above), _number(node.below)
        return None if above is None or not below else above / below
    return Ratio(node.text) if isinstance(node, Number) and node.text.isdigit() else None


def _written(ratio: Ratio) -> Node:
    above: Node = Number(str(ratio.numerator))
    return above if ratio.denominator == 1 else Fraction(above, Number(str(ratio.denominator)))


def _times(ratio: Ratio, factors: Sequence[Node]) -> Node:
    """Return a product with a number before it, unless that is one."""
    parts = (*((_written(ratio),) if ratio != 1 or not factors else ()), *factors)
    return parts[0] if len(parts) == 1 else Product(parts)


def _unsigned(node: Node) -> tuple[Node, bool]:
    """Return a term without the minus in front of it, and whether there is one."""
    if isinstance(node, Addition) and len(node.terms) == 1:
        return node.terms[0], node.signs[0] == "-"
    return node, False


def total(pieces: Iterable[Piece]) -> Node:
    """Return a sum of products as a tree."""
    pairs = [scaled(p) for p in pieces]
    signs = ["" if k == 0 and s == "+" else s for k, (s, _) in enumerate(pairs)]
    if len(pairs) == 1 and not signs[0]:
        return pairs[0][1]
    return Addition(tuple(n for _, n in pairs), tuple(signs))


# -- what is left over ---------------------------------------------------------------------------


def remains(
    line: Line, near: Sequence[Node], given: Iterable[str] = (), long: bool = False
) -> tuple[Node, ...]:
    """Return what is left over of an equation on the solutions, whole and term by term.

    ``near``: symbols of the writer, which it is written with. Nothing is where that would need others
    or more than a few terms, unless it may be ``long``.
    """
    models = line.models(given)
    if not isinstance(models, Solutions):
        return ()
    letters = _letters(line, near, models)
    printable = {q.symbol: printed(q) for q in models.model.quantities.values()} if long else {}
    letters = printable | letters
    found: dict[Node, None] = {}
    try:
        for pair in models.said:
            whole = residual(models.model.system, pair, models.held)
            parts = () if whole is None else (whole, *sp.Add.make_args(sp.expand(whole)))
            short = parts if long or len(parts) <= SHORT + 1 else ()
            own = (p for p in short if p.free_symbols <= letters.keys())
            found |= {read_formula(_latex(part, letters)).tree: None for part in own}
    except (InputError, Singular):
        return ()
    return tuple(found)


def _letters(line: Line, near: Sequence[Node], models: Solutions) -> dict[Expr, str]:
    """Return the LaTeX of those quantities of a system that the writer has a symbol for."""
    found: dict[Expr, str] = {}
    for node in near:
        value = valued(line.elaborator, node)
        with suppress(InputError):
            if value is not None:
                meant = models.written(value.term)
                if meant.is_Symbol:
                    found.setdefault(meant, latex(node))
    quantities = models.model.quantities
    for name, q in quantities.items():
        base = quantities.get(name.removesuffix("_dot"), q)
        if base is not q and base.symbol in found:
            found.setdefault(q.symbol, rf"\dot{{{found[base.symbol]}}}")
    return found


def _latex(expression: Expr, letters: dict[Expr, str]) -> str:
    return str(sp.latex(expression, symbol_names=letters, fold_short_frac=False))


# -- lost terms ------------------------------------------------------------------------------------


@dataclass
class Pools:
    """Products of the factors of a line by signature, made once.

    ``near``: symbols that stand around the line, factors as well where ``wide``; ``known``:
    gives what is left over where that is known without a search.
    """

    line: Line
    values: Mapping[Addend, Value | None]
    near: tuple[Node, ...] = ()
    known: Callable[[], Sequence[Node]] = tuple
    wide: bool = False
    made: dict[tuple[tuple[Node, ...], Signature], list[Item]] = field(default_factory=dict)

    def pool(self, roots: Sequence[Node], kind: Signature) -> list[Item]:
        """Return products of the factors below some nodes, but for what stands in the line as a term."""
        key = (tuple(roots), kind)
        if key not in self.made:
            standing = {i.term for i in self.own(kind)}
            made = list(self._known(kind)) if self.left else items(self.line, roots, kind)
            self.made[key] = [i for i in made if i.term not in standing]
        return self.made[key]

    def widened(self) -> Pools:
        """Return pools with the symbols around the line as factors as well."""
        return replace(self, wide=True, made={})

    def knowing(self, known: Callable[[], Sequence[Node]]) -> Pools:
        """Return pools that know what is left over in another way."""
        return replace(self, known=known, made={})

    @cached_property
    def left(self) -> Sequence[Node]:
        """What is known to be left over, whole and term by term; none where it must be looked for."""
        return self.known()

    def _known(self, kind: Signature) -> Iterator[Item]:
        for node in self.left:
            value = valued(self.line.elaborator, node)
            if value is not None and not value.is_zero and agrees(signature(value), kind):
                yield Item(node, value.term, kind)

    def own(self, kind: Signature) -> list[Item]:
        """Return the terms of the line."""
        return [
            Item(a.node, v.term, kind)
            for a, v in self.values.items()
            if v is not None and not v.is_zero and agrees(signature(v), kind)
        ]

    @property
    def roots(self) -> list[Node]:
        """The members that stand in the line."""
        own = [at(self.line.tree, m.path) for m in self.line.members if m.path is not None]
        return [*own, *self.near] if self.wide else own


def weight(pieces: Sequence[Piece]) -> float:
    """Return how implausible it is that these terms were lost together."""
    found = LOST.weight + 0.7 * (len(pieces) - 1)
    for piece in pieces:
        factors = sum(1 for _ in places(piece.item.node))
        found += 0.05 * factors + (0.2 if abs(piece.coefficient) != 1 else 0.0)
    return found


def lost_terms(
    pools: Pools, model: Drawn, member: Member, kind: Signature, need: int
) -> Iterator[Option]:
    """Yield terms that a member needs so that its number grows by ``need``."""
    if member.path is None or not member.addends:
        return
    standing = {model.number(i.term) for i in pools.own(kind)}
    for pieces in fits(model.number, pools.pool(pools.roots, kind), need):
        if len(pieces) > 1 and any(model.number(p.item.term) in standing for p in pieces):
            continue
        parts = [scaled(p) for p in pieces]
        sign = -1 if parts[0][0] == "-" else 1
        node = total([replace(p, coefficient=p.coefficient * sign) for p in pieces])
        value = worth(pools.line, node)
        if value is not None:
            addend = replace(member.addends[-1], sign=sign, node=NOTHING)
            lost = (Change(LOST, NOTHING, node),)
            yield Option(addend, weight(pieces), node, sign, lost, value.term, signature(value))
