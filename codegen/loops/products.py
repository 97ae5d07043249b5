"""Which values of a program are sums of products, and what can be computed beside each other.

For Taylor coefficients a sum of products is one thing: each coefficient is a sum over the orders and
over the terms. `forms` collects such sums, `levels` says what must come before what within an order.

Vectors of Taylor coefficients: which sums of products share one, and the operands of each.

A group is up to four sums side by side. Its terms with j from 1 to k - 1 need earlier orders alone.
A whole group holds whole values (`codegen.loops.products`), its terms with j = 0 and j = k are
added in the vector too; in other groups they are left to the reader, who may want some of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest
from typing import TypeVar

from codegen.derivatives.taylor import Prepared, Series
from codegen.ir.program import RATES

_SUMS = frozenset({"add", "sub", "neg"})
Still = tuple[Series, bool]
"""A value that does not change with time, or the inverse of one (True)."""


@dataclass(frozen=True)
class Coefficient:
    """A number times values that do not change with time."""

    number: Fraction = Fraction(1)
    factors: tuple[Still, ...] = ()

    def times(self, factor: Still) -> Coefficient:
        """Return this times a factor."""
        return Coefficient(self.number, (*self.factors, factor))

    def negative(self) -> Coefficient:
        """Return minus this."""
        return Coefficient(-self.number, self.factors)


@dataclass(frozen=True)
class Term:
    """A coefficient times one or two values that change with time."""

    coefficient: Coefficient
    left: Series
    right: Series | None


Form = tuple[Term, ...]
Lanes = tuple[Series, ...]
"""Values beside each other in a vector."""


def forms(prepared: Prepared) -> dict[Series, Form]:
    """Return every sum of products that other operations or results need, by its number.

    Law: the value is the sum of its terms. What only one sum reads is part of that sum.
    """
    absorbed = inner(prepared)
    roots = [n for n in range(len(prepared.varies)) if _belongs(prepared, n) and n not in absorbed]
    return {n: _terms(prepared, absorbed, n) for n in roots}


def inner(prepared: Prepared) -> frozenset[Series]:
    """Return the values that are read once, by a sum or by a product with what does not change."""
    instructions = prepared.program.instructions
    uses = Counter(a for i in instructions for a in i.args)
    uses.update(prepared.program.results[RATES])
    uses.update(prepared.partners.values())
    uses.update(prepared.switches)
    readers = (n for n in range(len(instructions)) if _is_linear(prepared, n))
    read = {a for n in readers for a in instructions[n].args}
    return frozenset(a for a in read if uses[a] == 1 and _belongs(prepared, a))


def levels(prepared: Prepared) -> list[int]:
    """Return for every value after how many others, one upon the other, its coefficient comes.

    A sum of products is one step, whatever its length.
    """
    absorbed = inner(prepared)
    found: list[int] = []
    for n, instruction in enumerate(prepared.program.instructions):
        linear = _is_linear(prepared, n)
        before = [
            a for a in (*instruction.args, prepared.partner(n)) if a < n and prepared.varies[a]
        ]
        within = [found[a] for a in before if linear and a in absorbed]
        outside = (a for a in before if not (linear and a in absorbed))
        bare = (_bare(prepared, absorbed, a, Coefficient())[0] for a in outside)
        found.append(max([*within, *(found[a] + 1 for a in bare)], default=0))
    return found


def tree(prepared: Prepared, absorbed: frozenset[Series], root: Series) -> list[Series]:
    """Return a sum of products and all values that are part of it alone."""
    found, stack = [], [root]
    while stack:
        n = stack.pop()
        found.append(n)
        if _is_linear(prepared, n):
            stack += [a for a in prepared.program.instructions[n].args if a in absorbed]
    return found


def _belongs(prepared: Prepared, n: Series) -> bool:
    """Return whether a value is a sum, or a product, of values that change with time."""
    op = prepared.program.instructions[n].op
    return prepared.varies[n] and (op == "mul" or _is_linear(prepared, n))


def _is_linear(prepared: Prepared, n: Series) -> bool:
    """Return whether a value is linear in those of its arguments that change with time."""
    op, args, _ = prepared.program.instructions[n]
    if not prepared.varies[n]:
        return False
    scaled = op == "mul" and sum(prepared.varies[a] for a in args) == 1
    return op in _SUMS or scaled or (op == "div" and not prepared.varies[args[1]])


def _terms(prepared: Prepared, absorbed: frozenset[Series], root: Series) -> Form:
    found: list[Term] = []
    stack = [(root, Coefficient())]
    while stack:
        n, coefficient = stack.pop()
        op, args, _ = prepared.program.instructions[n]
        if n != root and n not in absorbed:
            bare, factor = _bare(prepared, absorbed, n, coefficient)
            found.append(Term(factor, bare, None))
        elif op == "mul" and all(prepared.varies[a] for a in args):
            left, factor = _bare(prepared, absorbed, args[0], coefficient)
            right, factor = _bare(prepared, absorbed, args[1], factor)
            found.append(Term(factor, left, right))
        else:
            stack += reversed(_parts(prepared, op, args, coefficient))
    return tuple(found)


def _bare(
    prepared: Prepared, absorbed: frozenset[Series], n: Series, coefficient: Coefficient
) -> tuple[Series, Coefficient]:
    """Return a value without its constant factors, and the coefficient times these."""
    op, args, _ = prepared.program.instructions[n]
    while op in {"mul", "div", "neg"} and _is_linear(prepared, n):
        ((inside, times),) = _parts(prepared, op, args, coefficient)
        if inside in absorbed:
            break
        n, coefficient = inside, times
        op, args, _ = prepared.program.instructions[n]
    return n, coefficient


def _parts(
    prepared: Prepared, op: str, args: tuple[int, ...], coefficient: Coefficient
) -> list[tuple[Series, Coefficient]]:
    """Return what a linear operation adds up, with coefficients; what stands still is left out."""
    if op in {"mul", "div"}:
        moving, still = args if prepared.varies[args[0]] else args[::-1]
        return [(moving, _scaled(prepared, coefficient, still, op == "div"))]
    signs = {"add": (1, 1), "sub": (1, -1), "neg": (-1,)}[op]
    pairs = zip(args, signs, strict=True)
    return [(a, coefficient if s > 0 else coefficient.negative())
            for a, s in pairs if prepared.varies[a]]  # fmt: skip


def _scaled(
    prepared: Prepared, coefficient: Coefficient, still: Series, inverted: bool
) -> Coefficient:
    op, _, value = prepared.program.instructions[still]
    if op == "const" and isinstance(value, Fraction) and value:
        number = 1 / value if inverted else value
        return Coefficient(coefficient.number * number, coefficient.factors)
    return coefficient.times((still, inverted))


def wide(prepared: Prepared, width: int, fewest: int) -> list[Lanes]:
    """Return the forms that go into one vector each: of one level, ``width`` at most.

    Forms with as many products stand together; what is left over of these shares a vector. Fewer than
    ``fewest`` forms, and forms without a product, stay alone.
    """
    height, found = levels(prepared), []
    products = {n: sum(t.right is not None for t in f) for n, f in forms(prepared).items()}
    kinds = sorted({(height[n], -products[n]) for n in products if products[n]})
    left: dict[int, list[Lanes]] = {}
    for level, count in kinds:
        here = [n for n in products if (height[n], -products[n]) == (level, count)]
        rest = len(here) % width
        found += [tuple(here[k : k + width]) for k in range(rest, len(here), width)]
        others = left.setdefault(level, [])
        if others and len(others[-1]) + rest <= width:
            others[-1] += tuple(here[:rest])
        else:
            others.append(tuple(here[:rest]))
    found += [lanes for some in left.values() for lanes in some if len(lanes) >= fewest]
    return found


def linear_in_time(prepared: Prepared) -> frozenset[Series]:
    """Return the values of which only two coefficients are not zero."""
    found: set[Series] = set()
    for n, (op, args, _) in enumerate(prepared.program.instructions):
        moving = [a for a in args if prepared.varies[a]]
        if op == "time" or (_is_linear(prepared, n) and found.issuperset(moving)):
            found.add(n)
    return frozenset(found)


T = TypeVar("T")

WIDTH = 4
"""Places of a vector. A processor without so wide registers takes two steps."""
ONE, ZERO = Coefficient(), Coefficient(Fraction(0))

Places = tuple[Series | None, ...]
Factors = tuple[Coefficient | None, ...]


@dataclass(frozen=True)
class Sum:
    """The terms from j = 1 to k - 1 of the sum of w_j a_j b_(k-j), where w is 1, or j."""

    left: Series
    right: Series
    weighted: bool


@dataclass(frozen=True)
class Pack:
    """A value in each place, or nothing; each times a coefficient, and times the order if weighted."""

    places: Places
    factors: Factors
    weighted: tuple[bool, ...] = (False,) * WIDTH

    @property
    def is_plain(self) -> bool:
        """Whether nothing is to be multiplied: what stands in a blank place must then not matter."""
        return all(f in {None, ONE} for f in self.factors)


@dataclass(frozen=True)
class Group:
    """Products of packs, and packs that are added as they are, in whole groups alone.

    ``values``: what a whole group is, by place; empty in other groups.
    """

    products: tuple[tuple[Pack, Pack], ...]
    added: tuple[Pack, ...] = ()
    values: Lanes = ()


def whole_group(lanes: Lanes, forms: Sequence[Form]) -> Group:
    """Return the group whose places are the values ``lanes``, with the forms that they have."""
    products = [[t for t in form if t.right is not None] for form in forms]
    added = [[t for t in form if t.right is None] for form in forms]
    pairs = (
        (_left(row), _pack([t.right if t else None for t in row])) for row in zip_longest(*products)
    )
    return Group(tuple(pairs), tuple(_left(row) for row in zip_longest(*added)), lanes)


def _left(row: Sequence[Term | None]) -> Pack:
    """Return first operands with the coefficients; a blank place has the coefficient zero."""
    return _pack([t.left if t else None for t in row], [t.coefficient if t else ZERO for t in row])


def part_groups(sums: Sequence[Sum]) -> list[Group]:
    """Return groups of the sums, four in each, in their order."""
    found = []
    for first in range(0, len(sums), WIDTH):
        some = sums[first : first + WIDTH]
        left = _pack([s.left for s in some], weighted=[s.weighted for s in some])
        found.append(Group(((left, _pack([s.right for s in some])),)))
    return found


def _pack(
    places: Sequence[Series | None],
    factors: Sequence[Coefficient | None] = (),
    weighted: Sequence[bool] = (),
) -> Pack:
    return Pack(_filled(places, None), _filled(factors, None), _filled(weighted, blank=False))


def _filled(values: Sequence[T], blank: T) -> tuple[T, ...]:
    return (*values, *[blank] * (WIDTH - len(values)))


def steps(prepared: Prepared, groups: Sequence[Group]) -> list[Series | Group]:
    """Return groups, and the values that are in none of them, each after what it needs."""
    height, absorbed = levels(prepared), inner(prepared)
    inside = {m for group in groups for n in group.values for m in tree(prepared, absorbed, n)}
    found: list[tuple[int, int, Series | Group]]
    found = [(height[group.values[0]], -1, group) for group in groups]
    rest = (n for n, varies in enumerate(prepared.varies) if varies and n not in inside)
    found += [(height[n], n, n) for n in rest]
    return [step for *_, step in sorted(found, key=lambda s: s[:2])]
