"""Common factors of sums: a * b + a * c becomes a * (b + c), and a / d + b / d becomes (a + b) / d."""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from fractions import Fraction
from functools import reduce
from typing import NamedTuple

from codegen.ir.ops import OPS
from codegen.ir.program import Builder, Program, bindings
from codegen.passes.chains import SUMS, Recipe, add_terms, chains, inner, multiply, rebuild

Factor = tuple[int, int]
"""Number of a value, and its exponent: 1 or -1."""


class Product(NamedTuple):
    """A term of a sum: ``sign`` times the product of ``factors``; ``number`` if that exists."""

    sign: int
    factors: tuple[Factor, ...]
    number: int | None = None


def factor_sums(program: Program) -> Program:
    """Return the program with common factors taken out of sums.

    Law: equal in exact arithmetic; values change by rounding, relative to the largest term of a
    sum. In each sum the factor that saves most is taken out again and again, from the products
    and quotients that serve this sum alone (greedy; ties go to what is known last, so that the
    rest is known early, then to the earliest value).
    """
    search = _Search(program)
    for root, terms in chains(program, SUMS).items():
        products = [search.product(k, sign) for k, sign in terms]
        reduced = search.reduce(products)
        if reduced is not None:
            search.sums[root] = reduced
    if not search.sums:
        return program
    return rebuild(program, {k: _recipe(terms) for k, terms in search.sums.items()})


class _Search:
    """Sums with their terms taken apart; those that came out of brackets are numbered on."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.inside = inner(program, ("mul", "div", "add", "sub"))
        self.binding = bindings(program)
        self.sums: dict[int, list[Product]] = {}
        self.next = len(program.instructions)

    def product(self, root: int, sign: int) -> Product:
        """Take a term apart, through products and quotients that serve it alone."""
        factors: list[Factor] = []
        stack: list[Factor] = [(root, 1)]
        while stack:
            k, exponent = stack.pop()
            op, args, value = self.program.instructions[k]
            if op in {"mul", "div"} and exponent == 1 and k in self.inside:
                stack += [(args[1], -1 if op == "div" else 1), (args[0], 1)]
            elif op == "const" and isinstance(value, Fraction) and value == 1 and exponent == 1:
                continue
            else:
                factors.append((k, exponent))
        return Product(sign, tuple(factors), root)

    def reduce(self, products: list[Product]) -> list[Product] | None:
        """Take common factors out of a sum; None if there are none."""
        terms: dict[int, Product] = dict(enumerate(products))
        holders: dict[Factor, set[int]] = {}
        for n, product in terms.items():
            for f in self._saving(product):
                holders.setdefault(f, set()).add(n)
        heap = [self._rank(f, n) for f, n in holders.items() if len(n) > 1]
        heapq.heapify(heap)
        changed = False
        while heap:
            rank = heapq.heappop(heap)
            factor = rank[2:]
            now = holders[factor]
            if len(now) > 1 and rank != self._rank(factor, now):
                heapq.heappush(heap, self._rank(factor, now))
            elif len(now) > 1:
                self._take_out(factor, sorted(now), terms, holders)
                changed = True
        return list(terms.values()) if changed else None

    @staticmethod
    def _saving(product: Product) -> set[Factor]:
        """Return the factors without which a term needs an operation less: not d of d / a."""
        above = sum(exponent > 0 for _, exponent in product.factors)
        return {f for f in product.factors if f[1] < 0 or above > 1}

    def _rank(self, factor: Factor, holders: set[int]) -> tuple[int, int, int, int]:
        number, exponent = factor
        saved = (len(holders) - 1) * OPS["mul" if exponent > 0 else "div"].cost
        known = self.binding[number] if number < len(self.binding) else 3
        return (-saved, -known, number, exponent)

    def _take_out(
        self,
        factor: Factor,
        group: Sequence[int],
        terms: dict[int, Product],
        holders: dict[Factor, set[int]],
    ) -> None:
        rest = []
        for n in group:
            sign, factors, _ = terms[n]
            for f in factors:
                holders.get(f, set()).discard(n)
            at = factors.index(factor)
            rest.append(Product(sign, factors[:at] + factors[at + 1 :]))
            if n != group[0]:
                del terms[n]
        bracket = self.next
        self.next += 1
        self.sums[bracket] = self.reduce(rest) or rest
        terms[group[0]] = Product(1, (factor, (bracket, 1)))


def _recipe(terms: Sequence[Product]) -> Recipe:
    """Build the sum of ``terms`` from all their factors, or from the terms that exist."""
    parts = [((t.number, 1),) if t.number is not None else t.factors for t in terms]

    def build(b: Builder, new: Sequence[int]) -> int:
        numbers = iter(new)
        built = [
            (_product(b, [(next(numbers), e) for _, e in part]), t.sign)
            for t, part in zip(terms, parts, strict=True)
        ]
        return add_terms(b, built)

    return Recipe(tuple(k for part in parts for k, _ in part), build)


def _product(b: Builder, factors: Sequence[Factor]) -> int:
    above = [f for f in factors if f[1] > 0] or [(b.const(1), 1)]
    below = [k for k, exponent in factors if exponent < 0]
    return reduce(lambda x, y: b.add("div", x, y), below, multiply(b, above))
