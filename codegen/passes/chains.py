"""Maximal sums and products as lists of terms, and the parts that several of them share.

a + b in a + b + c and in a + b - d is computed once, and so is a * b in a * b * c and a * b * d.
"""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations
from typing import NamedTuple

from codegen.ir.program import Builder, Program, bindings

MAX_TERMS = 24
"""Of longer chains so many terms are looked at: the search takes all pairs of them."""

Term = tuple[int, int]
"""Number of a value, and its sign."""


@dataclass(frozen=True)
class Kind:
    """Sums or products: the operations that make them up, with the sign of the second operand."""

    signs: Mapping[str, int]
    repeats: bool
    """Whether a chain may hold a value twice."""


SUMS = Kind({"add": 1, "sub": -1}, repeats=False)
PRODUCTS = Kind({"mul": 1}, repeats=True)


class Pair(NamedTuple):
    """The value ``left + sign * right``, or ``left * right``."""

    left: int
    sign: int
    right: int


def share_sums(program: Program) -> Program:
    """Return the program with shared partial sums.

    Law: equal in exact arithmetic; values change by the rounding of another order of summation.
    The pair of terms that occurs in most sums, up to the sign of the whole, is taken out again and
    again (greedy; ties go to the earliest values).
    """
    return _share(program, SUMS)


def share_products(program: Program) -> Program:
    """Return the program with shared partial products.

    Law: equal in exact arithmetic; values change by the rounding of another order of products.
    """
    return _share(program, PRODUCTS)


def _share(program: Program, kind: Kind) -> Program:
    found = chains(program, kind)
    if not kind.repeats:
        found = {r: t for r, t in found.items() if len({k for k, _ in t}) == len(t)}
    search = _Search(found, len(program.instructions))
    search.run()
    return _rebuild(program, kind, search) if search.pairs else program


def uses(program: Program) -> list[int]:
    """Return how often each value is an operand or a result."""
    counts = [0] * len(program.instructions)
    for instruction in program.instructions:
        for a in instruction.args:
            counts[a] += 1
    for group in program.results.values():
        for k in group:
            counts[k] += 1
    return counts


def inner(program: Program, ops: Collection[str]) -> set[int]:
    """Return the values of ``ops`` that serve one further value of ``ops`` alone.

    What has a name stays whole, and so does what is known before the value that it serves: it is
    computed less often.
    """
    instructions, counts, known = program.instructions, uses(program), bindings(program)
    return {
        a
        for k, instruction in enumerate(instructions)
        if instruction.op in ops
        for a in instruction.args
        if instructions[a].op in ops
        and counts[a] == 1
        and a not in program.names
        and (known[a] > 1 or known[k] <= 1)
    }


def chains(program: Program, kind: Kind) -> dict[int, list[Term]]:
    """Return the terms of each maximal sum or product, by its number."""
    inside = inner(program, kind.signs)
    return {
        k: _terms(program, kind, k, inside)
        for k, instruction in enumerate(program.instructions)
        if instruction.op in kind.signs and k not in inside
    }


def _terms(program: Program, kind: Kind, root: int, inside: set[int]) -> list[Term]:
    terms: list[Term] = []
    stack: list[Term] = [(root, 1)]
    while stack:
        k, sign = stack.pop()
        if k == root or k in inside:
            op, (first, second), _ = program.instructions[k]
            stack += [(second, sign * kind.signs[op]), (first, sign)]
        else:
            terms.append((k, sign))
    return terms


class _Search:
    """Take out the most frequent pair until no pair occurs twice; holders are kept up to date."""

    def __init__(self, found: dict[int, list[Term]], first: int) -> None:
        occurrences = Counter(k for terms in found.values() for k in {k for k, _ in terms})
        self.shared = {k for k, count in occurrences.items() if count > 1}
        self.chains = found
        self.changed: set[int] = set()
        self.pairs: dict[int, Pair] = {}
        self.first = first
        self.holders: dict[Pair, set[int]] = {}
        self.heap: list[tuple[int, Pair]] = []

    def run(self) -> None:
        for root, terms in self.chains.items():
            for pair in self._pairs(terms):
                self.holders.setdefault(pair, set()).add(root)
        self.heap = [(-len(roots), p) for p, roots in self.holders.items() if len(roots) > 1]
        heapq.heapify(self.heap)
        while self.heap:
            count, pair = heapq.heappop(self.heap)
            now = len(self.holders[pair])
            if now == -count:
                self._take_out(pair)
            elif now > 1:
                heapq.heappush(self.heap, (-now, pair))

    def _take_out(self, pair: Pair) -> None:
        roots = sorted(self.holders[pair])
        new = self.first + len(self.pairs)
        oriented = self._oriented(pair, roots)
        self.pairs[new] = oriented
        self.shared.add(new)
        self.changed.update(roots)
        for root in roots:
            terms = self.chains[root]
            before = self._pairs(terms)
            sign = dict(terms)[oriented.left]
            for k in (pair.left, pair.right):
                terms.pop(next(n for n, t in enumerate(terms) if t[0] == k))
            terms.append((new, sign))
            self._update(root, before, self._pairs(terms))

    def _update(self, root: int, before: set[Pair], after: set[Pair]) -> None:
        for pair in before - after:
            self.holders[pair].discard(root)
        for pair in after - before:
            roots = self.holders.setdefault(pair, set())
            roots.add(root)
            if len(roots) > 1:
                heapq.heappush(self.heap, (-len(roots), pair))

    def _pairs(self, terms: Sequence[Term]) -> set[Pair]:
        """Return the pairs of terms that may occur elsewhere, too."""
        candidates = sorted(t for t in terms if t[0] in self.shared)[:MAX_TERMS]
        return {Pair(a, s * t, b) for (a, s), (b, t) in combinations(candidates, 2)}

    def _oriented(self, pair: Pair, roots: Sequence[int]) -> Pair:
        """Turn a difference around if most sums hold its negative: they add it then."""
        balance = sum(dict(self.chains[root])[pair.left] for root in roots)
        return Pair(pair.right, -1, pair.left) if pair.sign < 0 and balance < 0 else pair


def _rebuild(program: Program, kind: Kind, search: _Search) -> Program:
    join = add_terms if kind is SUMS else multiply
    chained = {root: search.chains[root] for root in search.changed}
    chained |= {new: [(p.left, 1), (p.right, p.sign)] for new, p in search.pairs.items()}
    return rebuild(program, {k: _recipe(terms, join) for k, terms in chained.items()})


def _recipe(terms: Sequence[Term], join: Callable[[Builder, Sequence[Term]], int]) -> Recipe:
    signs = [sign for _, sign in terms]
    return Recipe(
        tuple(k for k, _ in terms), lambda b, new: join(b, list(zip(new, signs, strict=True)))
    )


class Recipe(NamedTuple):
    """How a value is built otherwise: from the values ``operands``, by ``build``."""

    operands: tuple[int, ...]
    build: Callable[[Builder, Sequence[int]], int]


def rebuild(program: Program, recipes: Mapping[int, Recipe]) -> Program:
    """Build the program anew, with ``recipes`` for some of its values and for further ones.

    Further values are numbered from the length of the program and stand before their first use;
    what nothing needs any more is left out.
    """
    instructions = program.instructions

    def operands(k: int) -> tuple[int, ...]:
        return recipes[k].operands if k in recipes else instructions[k].args

    found = {k for group in program.results.values() for k in group}
    stack = list(found)
    while stack:
        fresh = [a for a in operands(stack.pop()) if a not in found]
        found.update(fresh)
        stack += fresh
    b = Builder(program.rules)
    new: dict[int, int] = {}

    def build(k: int) -> None:
        if k in recipes:
            new[k] = recipes[k].build(b, [new[a] for a in operands(k)])
        else:
            new[k] = b.again(instructions[k], new)

    for root in sorted(k for k in found if k < len(instructions)):
        stack = [a for a in operands(root) if a not in new]
        while stack:
            waiting = [a for a in operands(stack[-1]) if a not in new]
            stack += waiting
            if not waiting:
                build(stack.pop())
        build(root)
        if root in program.names:
            b.name(new[root], program.names[root])
    return b.program({g: [new[k] for k in r] for g, r in program.results.items()})


def add_terms(b: Builder, terms: Sequence[Term]) -> int:
    """Add the positive terms first; a sum of negative terms alone is negated as a whole."""
    positive = [k for k, sign in terms if sign > 0]
    negative = [k for k, sign in terms if sign < 0]
    if not positive:
        return b.add("neg", add_terms(b, [(k, 1) for k in negative]))
    total = reduce(lambda x, y: b.add("add", x, y), positive)
    return reduce(lambda x, y: b.add("sub", x, y), negative, total)


def multiply(b: Builder, factors: Sequence[Term]) -> int:
    """Multiply in order."""
    return reduce(lambda x, y: b.add("mul", x, y), (k for k, _ in factors))
