"""Sums of products that become SymPy expressions when they are named: the scalars of large derivations.

SymPy sorts and compares what it adds and multiplies; a recursion over 100 bodies makes 40,000 sums and
products, which nobody asked to be put in order. A node holds terms (coefficient, factors) and makes one
unevaluated sum when it gets a name or becomes a factor. Coefficients are exact.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import lru_cache
from typing import Any

import sympy as sp

from eom.multibody.algebra.letters import LETTERS
from eom.multibody.algebra.values import value
from eom.system import Definition, Quantity, nodes

Expr = Any
Number = int | Fraction
Term = tuple[Number, tuple[Expr, ...]]
"""A coefficient, not zero, and SymPy factors."""


class Node:
    """A sum of terms. Operands are nodes and exact numbers; zero is the number 0, never a node."""

    __slots__ = ("_made", "terms")

    def __init__(self, terms: tuple[Term, ...]) -> None:
        self.terms = terms
        self._made: Expr = None

    def __repr__(self) -> str:
        return f"Node({self.expression})"

    @property
    def expression(self) -> Expr:
        """The SymPy expression, made once."""
        if self._made is None:
            self._made = _sum(self.terms)
        return self._made

    def __add__(self, other: Any) -> Node:
        if type(other) is Node:
            return Node(self.terms + other.terms)
        return Node((*self.terms, (other, ()))) if other else self

    __radd__ = __add__

    def __neg__(self) -> Node:
        return Node(tuple([(-c, f) for c, f in self.terms]))

    def __sub__(self, other: Any) -> Any:
        return self + -other

    def __rsub__(self, other: Any) -> Any:
        return -self + other

    def __mul__(self, other: Any) -> Any:
        if type(other) is Node:
            (c, f), (d, g) = self._one, other._one
            return Node(((c * d, f + g),))
        if not other:
            return 0
        c, f = self._one
        return Node(((c * other, f),))

    __rmul__ = __mul__

    @property
    def _one(self) -> Term:
        """The node as one term; a sum becomes a factor."""
        return self.terms[0] if len(self.terms) == 1 else (1, (self.expression,))

    def __rtruediv__(self, other: Any) -> Any:
        c, f = self._one
        below = f[0] if len(f) == 1 else _product(1, f)
        return other * Node(((Fraction(1) / c, (sp.Pow(below, -1, evaluate=False),)),))

    def __truediv__(self, other: Any) -> Any:
        return self * (1 / other if type(other) is Node else Fraction(1) / other)


@lru_cache(maxsize=4096)
def _number(c: Number) -> Expr:
    return sp.Rational(c.numerator, c.denominator)


def _product(c: Number, factors: tuple[Expr, ...]) -> Expr:
    if len(factors) == 2 and factors[0] is factors[1]:
        factors = (sp.Pow(factors[0], 2, evaluate=False),)
    if c == 1 and len(factors) == 1:
        return factors[0]
    if not factors:
        return _number(c)
    return sp.Mul._from_args(factors if c == 1 else (_number(c), *factors), True)


def _sum(terms: tuple[Term, ...]) -> Expr:
    constants = [c for c, f in terms if not f]
    if len(constants) > 1:
        terms = (*(t for t in terms if t[1]), (sum(constants), ()))
    made = tuple([_product(c, f) for c, f in terms])
    return made[0] if len(made) == 1 else sp.Add._from_args(made, True)


def lifted(given: Any) -> Any:
    """Return a number as it is, a SymPy expression as a node."""
    if isinstance(given, int | Fraction):
        return given
    coefficient, factors = given.as_coeff_mul()
    exact = value(coefficient, "coefficient")
    if isinstance(exact, int | Fraction):
        return Node(((exact, tuple(factors)),))
    return Node(((1, (given,)),))


def plain(x: Any) -> Expr:
    """Return a node or a number as a SymPy expression."""
    return x.expression if type(x) is Node else _number(x)


class Naming:
    """Names for what a recursion keeps: definitions in order, equal values under one name.

    ``taken``: names that are in use already.
    """

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self.taken = set(taken)
        self.definitions: list[Definition] = []
        self._known: dict[tuple[Term, ...], Node] = {}
        self._atoms: dict[Expr, Any] = {}

    def atom(self, given: Any) -> Any:
        """Return a value of a description as a scalar; equal ones are the same object."""
        known = self._atoms.get(given)
        if known is None:
            known = self._atoms[given] = lifted(given)
        return known

    def sin(self, x: Any) -> Any:
        """Return the sine."""
        return self.atom(value(sp.sin(plain(x)), "sine"))

    def cos(self, x: Any) -> Any:
        """Return the cosine."""
        return self.atom(value(sp.cos(plain(x)), "cosine"))

    def sqrt(self, x: Any) -> Any:
        """Return the square root."""
        return Node(((1, (sp.Pow(plain(x), sp.S.Half, evaluate=False),)),))

    def keep(self, letter: str, part: str, suffix: str, value: Any) -> Any:
        """Return the value under a name of its own, unless it is a number or has a name."""
        if type(value) is not Node:
            return value
        terms = value.terms
        if len(terms) == 1:
            c, f = terms[0]
            if len(f) == 1 and f[0].is_Symbol and c in {1, -1}:
                return self._atoms.get(f[0], value) if c == 1 else value
        known = self._known.get(terms)
        if known is None:
            row = LETTERS[letter]
            name = self._free(f"{row.letter}_{part}{'_' * bool(suffix)}{suffix}")
            quantity = Quantity(sp.Symbol(name, real=True), row.unit, row.meaning.format(part))
            known = self._known[terms] = self.define(quantity, value)
        return known

    def define(self, quantity: Quantity, value: Any) -> Node:
        """Return a value under the name of a quantity."""
        self.definitions.append(Definition(quantity, plain(value)))
        node = self._atoms[quantity.symbol] = Node(((1, (quantity.symbol,)),))
        return node

    def _free(self, name: str) -> str:
        """Return the name, with a number if it is taken."""
        found, count = name, 1
        while found in self.taken:
            count += 1
            found = f"{name}_n{count}"
        self.taken.add(found)
        return found


def used(definitions: Iterable[Definition], results: Iterable[Expr]) -> tuple[Definition, ...]:
    """Return the definitions that results need, in order."""
    needed = set(nodes(results))
    kept = []
    for definition in reversed(list(definitions)):
        if definition.symbol in needed:
            kept.append(definition)
            needed.update(nodes((definition.expression,)))
    return tuple(reversed(kept))
