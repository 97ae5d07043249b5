"""The value of a SymPy expression in a ring: what the ring computes with is data, as is what it knows.

An `Evaluation` has a ring, and one row a kind of expression: what has to be known first, and the value.
Numbers, sums, products and whole powers are the same in all rings, `ARITHMETIC`; `TRIGONOMETRY` takes the
functions of an angle from its cosine and sine, and these of a sum from those of its terms. What else a ring
knows, and what it draws or refuses, is said by who derives from `Evaluation`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from typing import Any, ClassVar, NamedTuple, Protocol

import sympy as sp

from eom.fields import sum_of_angles

Expr = Any
Element = Any


class Ring(Protocol):
    """Elements with + and - and *, and what else is computed with them."""

    def of(self, numerator: int, denominator: int = 1) -> Element:
        """Return the element that a fraction is."""

    def reduce(self, value: Element) -> Element:
        """Return the element that a result of operators stands for."""

    def total(self, values: Sequence[Element]) -> Element:
        """Return the sum of elements."""

    def product(self, values: Sequence[Element]) -> Element:
        """Return the product of elements."""

    def power(self, value: Element, exponent: int) -> Element:
        """Return a whole power, not the power 0."""

    def inverse(self, value: Element) -> Element:
        """Return the reciprocal."""


class Row(NamedTuple):
    """A kind of expression: the ``operands`` that have values first, and its ``value`` by theirs."""

    operands: Callable[[Any, Expr], Sequence[Expr]]
    value: Callable[[Any, Expr, list[Element]], Element]


class Evaluation:
    """Values of expressions in a ring; every distinct node is computed once, however deep it stands.

    ``rows``: by class, for which the most special one counts. ``memo``: what is known.
    """

    rows: ClassVar[Mapping[Any, Row]]
    ring: Ring
    memo: dict[Expr, Element]

    def value(self, expression: Expr) -> Element:
        """Return the value of an expression."""
        memo, kind = self.memo, type(self)
        known = memo.get(expression)
        stack = [expression] if known is None else []
        while stack:
            node = stack[-1]
            operands, value = _row(kind, type(node))  # type: ignore[arg-type] # are hashable
            values: list[Element] = []
            missing: list[Expr] = []
            for a in operands(self, node):
                found = memo.get(a)
                (missing if found is None else values).append(a if found is None else found)
            if missing:
                stack += missing[::-1]
                continue
            stack.pop()
            known = memo.get(node)
            if known is None:
                known = memo[node] = value(self, node, values)
        return known

    def meaning(self, symbol: Expr) -> Expr | None:  # noqa: ARG002
        """Return the expression that a symbol stands for, None for one with a value of its own."""
        return None

    def symbol(self, symbol: Expr) -> Element:
        """Return the value of a symbol."""
        return self.other(symbol)

    def power(self, node: Expr, base: Element) -> Element:
        """Return a whole power."""
        return self.ring.power(base, int(node.exp))

    def root(self, node: Expr) -> Element:
        """Return a power that is no whole one."""
        return self.other(node)

    def turns(self, angle: Expr) -> Iterable[tuple[Element, Element, int]]:
        """Return cosines and sines of angles, and how often each stands in a sum of angles."""
        raise NotImplementedError

    def other(self, node: Expr) -> Element:
        """Return the value of what has no row."""
        raise NotImplementedError

    def rotation(self, angle: Expr) -> tuple[Element, Element]:
        """Return cosine and sine of a sum of angles."""
        return sum_of_angles(self.turns(angle), self.ring.reduce)


@cache
def _row(owner: type[Evaluation], kind: type) -> Row:
    return next(owner.rows[k] for k in kind.__mro__ if k in owner.rows)


def summands(angle: Expr) -> Iterator[tuple[Expr, Expr]]:
    """Yield the terms of a sum of angles, each with its number in front."""
    for term in sp.Add.make_args(angle):
        count, base = term.as_coeff_Mul()
        yield base, count


def none(_: Evaluation, __: Expr) -> Sequence[Expr]:
    """Return no operands."""
    return ()


def arguments(_: Evaluation, node: Expr) -> Sequence[Expr]:
    """Return the arguments of a node as its operands."""
    return node.args  # type: ignore[no-any-return]


def _meaning(e: Evaluation, node: Expr) -> Sequence[Expr]:
    found = e.meaning(node)
    return () if found is None else (found,)


def _base(_: Evaluation, node: Expr) -> Sequence[Expr]:
    return (node.base,) if node.exp.is_Integer else ()


ARITHMETIC: dict[Any, Row] = {
    sp.Rational: Row(none, lambda e, n, _: e.ring.of(int(n.p), int(n.q))),
    sp.Symbol: Row(_meaning, lambda e, n, v: v[0] if v else e.symbol(n)),
    sp.Add: Row(arguments, lambda e, _, v: e.ring.total(v)),
    sp.Mul: Row(arguments, lambda e, _, v: e.ring.product(v)),
    sp.Pow: Row(_base, lambda e, n, v: e.power(n, v[0]) if v else e.root(n)),
    sp.Basic: Row(none, lambda e, n, _: e.other(n)),
}
"""Numbers, symbols, sums, products and powers; and all else."""

FLOATS: dict[Any, Row] = {
    sp.Float: Row(lambda _, n: (sp.Rational(n),), lambda _, __, v: v[0]),
}
"""Floats as the fractions that they are."""


def _of_angle(rule: Callable[[Ring, Element, Element], Element]) -> Row:
    return Row(none, lambda e, n, _: rule(e.ring, *e.rotation(n.args[0])))


TRIGONOMETRY: dict[Any, Row] = {
    sp.sin: _of_angle(lambda _, __, s: s),
    sp.cos: _of_angle(lambda _, c, __: c),
    sp.tan: _of_angle(lambda r, c, s: r.reduce(s * r.inverse(c))),
    sp.cot: _of_angle(lambda r, c, s: r.reduce(c * r.inverse(s))),
    sp.sec: _of_angle(lambda r, c, _: r.inverse(c)),
    sp.csc: _of_angle(lambda r, _, s: r.inverse(s)),
}
"""Functions of an angle by its cosine and sine."""
