"""Vectors of Taylor coefficients: which sums of products share one, and the operands of each.

A group is up to four sums side by side. Its terms with j from 1 to k - 1 need earlier orders alone.
A whole group holds whole values (`codegen.loops.products`), its terms with j = 0 and j = k are
added in the vector too; in other groups they are left to the reader, who may want some of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest
from typing import TypeVar

from codegen.derivatives.taylor import Prepared, Series
from codegen.loops.products import Coefficient, Form, Lanes, Term, inner, levels, tree

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
