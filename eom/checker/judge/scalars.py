"""Claims between free scalars: models are numbers with many digits for letters.

What may be assumed is what is said of letters: by relations that the note states above, and by the claim
itself of one that it brings in, at an end of the chain. Wrong is what differs by a number alone, and an
integral whose value has no other letters and differs. What is neither an identity nor wrong is left open.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import sympy as sp

from eom.checker.judge.models import ENOUGH, Drawn, Models, Search
from eom.checker.mean.claims import Claim, Parameters, Relation
from eom.checker.mean.parameters import expressions
from eom.errors import InputError

Expr = Any
Pair = tuple[Expr, Expr]
Values = Mapping[Expr, Expr]

RELATIONS = frozenset({"relations"})
"""What may be assumed: all that is said of letters."""
DIGITS = 50
MAX_LEAVES = 400
_SMALL = sp.Float(10) ** -30


@dataclass
class AtNumbers(Drawn):
    """Random numbers for letters, but for those with a meaning in others."""

    meanings: Values

    def agrees(self, said: Pair) -> bool:
        """Return whether two sides are the same number."""
        ratio = self.ratio(said)
        return ratio is not None and bool(abs(ratio - 1) < _SMALL)

    def ratio(self, said: Pair) -> Expr:
        """Return the left side over the right one, None where that is no number; zeros go by their form."""
        sides = [e.xreplace(self.meanings) for e in said]
        if 0 in sides:
            return sp.Integer(1) if sp.expand(sides[0] - sides[1]) == 0 else None
        if sum(1 for e in sides for _ in sp.preorder_traversal(e)) > MAX_LEAVES:
            return None
        at = {s: self._drawn(s) for e in sides for s in e.free_symbols}
        a, b = (e.xreplace(at).evalf(DIGITS) for e in sides)
        return a / b if all(v.is_Float or v.is_Integer for v in (a, b)) and b != 0 else None

    def _drawn(self, letter: Expr) -> Expr:
        generator = random.Random(f"{self.seed} {letter}")  # noqa: S311 - reproducible, no secret
        return sp.Rational(generator.randrange(10**6, 3 * 10**6), 10**6 + 3)


@dataclass(frozen=True)
class Scalars(Models):
    """Numbers for letters; what is said of them may be assumed, all of it."""

    order: ClassVar[Iterable[str]] = ()

    @property
    def parts(self) -> Parameters:
        """What the claim may rest on, and what it is made of."""
        assert self.claim.parameters is not None
        return self.claim.parameters

    @cached_property
    def said(self) -> tuple[Pair, ...]:
        """The links of the chain."""
        return tuple(pairwise(expressions(self.claim)))

    @cached_property
    def links(self) -> tuple[int, ...]:
        """The numbers of links that are true or false: not of the one, at an end, that names a letter."""
        numbers = range(len(self.said))
        known = {r.symbol: r.value for r in self.parts.relations}
        new = [k for k in numbers if _is_new(self.said[k], known)]
        return tuple(k for k in numbers if new != [k] or 0 < k < numbers[-1])

    @property
    def named(self) -> tuple[Relation, ...]:
        """What the claim says of a letter that it names."""
        return tuple(_relation(p) for k, p in enumerate(self.said) if k not in self.links)

    @cached_property
    def meanings(self) -> Values:
        """What letters are in others, by all that is said of them."""
        return {r.symbol: r.value for r in solved((*self.parts.relations, *self.named))}

    @property
    def names_scalars(self) -> bool:  # type: ignore[override]
        """Whether the claim only names a letter, which the words around it or its label bring in."""
        fresh = self.parts.defining or _lone(self.said[0][0]) in self.parts.fresh
        return fresh and not self.links

    def draw(self, names: frozenset[str]) -> Iterator[AtNumbers]:
        """Yield numbers, for all letters or with what is said of some."""
        return _drawn(self.meanings if names else {})

    def smallest(self, search: Search, base: frozenset[str]) -> Iterator[frozenset[str]]:
        """Yield that all is assumed which is said of letters."""
        if self.links and search.holds(base | RELATIONS):
            yield base | RELATIONS

    def doubt(self) -> str:
        """Say that a link is neither an identity nor wrong."""
        decided = all(map(self.agrees, self.links)) if self.links else self.names_scalars
        return "" if decided or self.wrong is not None else "this is no identity, and may hold"

    def why(self, search: Search) -> str:  # noqa: ARG002
        """Say why the chain is wrong, or what it rests on."""
        if self.wrong is None:
            return _RESTS[bool(self.named)]
        factor = self.factor(self.wrong)
        return _VALUE if factor is None else f"the right side should be multiplied by {factor}"

    def agrees(self, k: int) -> bool:
        """Return whether a link is true, by what is said of letters if need be."""
        pair = self.said[k]
        return k in self.links and (_same(pair, {}) or _same(pair, self.meanings))

    @cached_property
    def wrong(self) -> int | None:
        """The number of the first link that is false whatever the letters are."""
        return next(filter(self._is_wrong, self.links), None)

    def _is_wrong(self, k: int) -> bool:
        integral = any(m.span in self.parts.integrals for m in self.claim.members[k : k + 2])
        if self.agrees(k) or (integral and self.parts.constant):
            return False
        return self.factor(k) is not None or (integral and self._evaluates(k))

    def factor(self, k: int) -> Expr | None:
        """Return the number by which the right side of a link has to be multiplied, None for none."""
        found = [point.ratio(self.said[k]) for point in _drawn(self.meanings)]
        if None in found or any(abs(r - found[0]) > _SMALL * abs(r) for r in found):
            return None
        return sp.nsimplify(found[0].evalf(30), rational=True, tolerance=sp.Float(10) ** -20)

    def _evaluates(self, k: int) -> bool:
        """Return whether a link gives the value of an integral in the letters of the integral itself.

        What a relation makes to depend on the variable was no constant below the integral.
        """
        varying = {str(s) for r in self.parts.relations for s in r.written.free_symbols}
        a, b = (e.xreplace(self.meanings).free_symbols for e in self.said[k])
        return (a <= b or b <= a) and len(a | b) > 1 and varying.isdisjoint(self.parts.variables)


_VALUE = "the integral has another value"
_RESTS = ("by relations that the note states above", "what stands alone is what the note calls so")


def _drawn(values: Values) -> Iterator[AtNumbers]:
    return (AtNumbers(RELATIONS if values else frozenset(), k, values) for k in range(ENOUGH))


def _same(pair: Pair, values: Values) -> bool:
    return all(point.agrees(pair) for point in _drawn(values))


def _is_new(pair: Pair, known: Values) -> bool:
    """Return whether a link says of a letter alone what neither it nor the note says otherwise."""
    lone = next((s for s in map(_lone, pair) if s is not None), None)
    if lone is None or lone in known or all(lone in e.free_symbols for e in pair):
        return False
    return not _same(pair, {}) and not _same(pair, known)


def _lone(side: Expr) -> Expr:
    """Return the symbol of which a side is a multiple, None for all else."""
    _, rest = side.as_coeff_Mul()
    return rest if rest.is_Symbol else None


# -- proportions ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Proportion:
    """Two sides in letters that take any values; ``names``: how these are written."""

    above: Expr
    below: Expr
    points: tuple[Mapping[Expr, Expr], ...]
    names: Callable[[Expr], str] = str

    def constant(self) -> bool:
        """Return whether the quotient is the same for other values of the letters below."""
        first, *others = self.points
        found = [
            self._at({**first, **{s: p[s] for s in self.below.free_symbols}})
            for p in (first, *others)
        ]
        return all(abs(q - found[0]) < _NEAR * abs(found[0]) for q in found)

    def _at(self, point: Mapping[Expr, Expr]) -> Expr:
        sides = (side.xreplace(point).evalf(DIGITS) for side in (self.above, self.below))
        above, below = sides
        known = above.is_number and below.is_number and below != 0 and (above / below).is_finite
        if not known or abs(above) < _NEAR:
            raise InputError("in this proportion a side has no value")
        return above / below

    @property
    def words(self) -> str:
        """What varies, and what is held."""
        varied = self.below.free_symbols
        held = (self.above / self.below).free_symbols - varied
        shown = [", ".join(sorted(map(self.names, found))) for found in (varied, held)]
        return f"{shown[0]} may vary" + (f"; held constant: {shown[1]}" if shown[1] else "")


_NEAR = sp.Float(10) ** -40


def numbers(letters: Iterable[Expr]) -> tuple[Mapping[Expr, Expr], ...]:
    """Return three lots of positive numbers for letters."""
    generator = random.Random("proportions")  # noqa: S311 - reproducible, no secret
    ordered = sorted(letters, key=str)
    return tuple({s: sp.Rational(generator.randint(20, 90), 61) for s in ordered} for _ in range(3))


# -- relations of a note -----------------------------------------------------------------------------


@dataclass
class Known:
    """Relations that a note has stated so far, each within its heading."""

    found: list[tuple[tuple[str, ...], Relation]] = field(default_factory=list)

    def at(self, headings: tuple[str, ...]) -> tuple[Relation, ...]:
        """Return the relations that hold under some headings, each in scalars that have none."""
        return solved(r for place, r in self.found if headings[: len(place)] == place)

    def add(self, headings: tuple[str, ...], new: Iterable[Claim]) -> None:
        """Take in what claims say of single letters."""
        claims = (c for c in new if c.parameters is not None and not c.role)
        for models in (Scalars(c, c.scalars) for c in claims):
            if models.wrong is None:
                self.found += [(headings, r) for r in models.named]


def solved(relations: Iterable[Relation]) -> tuple[Relation, ...]:
    """Return relations in letters of which none says anything; what would go in circles is left out."""
    chosen: dict[Expr, Relation] = {}
    for r in relations:
        values = {s: k.value for s, k in chosen.items()}
        value = r.value.xreplace(values)
        if r.symbol in values or r.symbol in value.free_symbols:
            continue
        own = {r.symbol: value}
        chosen = {s: replace(k, value=k.value.xreplace(own)) for s, k in chosen.items()}
        chosen[r.symbol] = replace(r, value=value)
    return tuple(chosen.values())


def _relation(pair: Pair) -> Relation:
    """Return what a link says of a letter."""
    alone, other = pair if _lone(pair[0]) is not None else pair[::-1]
    coefficient, symbol = alone.as_coeff_Mul()
    return Relation(symbol, other / coefficient, other)
