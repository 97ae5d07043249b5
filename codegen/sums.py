"""Share partial sums: a + b in a + b + c and in a + b - d is computed once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from itertools import combinations
from typing import NamedTuple

from codegen.ops import OPS
from codegen.passes import needed
from codegen.program import Builder, Program

MAX_TERMS = 24
"""Longer sums are left alone: the search looks at all pairs of a sum."""

Term = tuple[int, int]
"""Number of a value, and its sign."""


class Pair(NamedTuple):
    """The value ``left + sign * right``."""

    left: int
    sign: int
    right: int


def share_sums(program: Program, group: str, apart: Iterable[str] = ()) -> Program:
    """Return the program with the partial sums of one group of results shared.

    What the groups ``apart`` need as well stays as it is.

    Values change by the rounding of another order of summation only. Sums are found through
    additions that serve one sum alone and have no name; the pair of terms that occurs in most
    sums, up to the sign of the whole, is taken out again and again (greedy; ties go to the
    earliest values, so that the same program gives the same result).
    """
    sums = _sums(program, needed(program, [group]) - needed(program, apart))
    pairs = _take_out(sums, len(program.instructions))
    return _rebuild(program, sums, pairs) if pairs else program


def _sums(program: Program, inside: set[int]) -> dict[int, list[Term]]:
    """Return the terms of each maximal sum of at least two terms among the values ``inside``."""
    instructions = program.instructions
    uses = Counter(a for k in inside for a in instructions[k].args)
    uses.update(k for result in program.results.values() for k in result)
    inner = {
        a
        for k in inside
        if instructions[k].op in {"add", "sub"}
        for a in instructions[k].args
        if instructions[a].op in {"add", "sub"}
        and uses[a] == 1
        and a in inside
        and a not in program.names
    }
    roots = [k for k in sorted(inside) if instructions[k].op in {"add", "sub"} and k not in inner]
    found = {root: _terms(program, root, inner) for root in roots}
    return {r: t for r, t in found.items() if len({k for k, _ in t}) == len(t) <= MAX_TERMS}


def _terms(program: Program, root: int, inner: set[int]) -> list[Term]:
    terms: list[Term] = []
    stack: list[Term] = [(root, 1)]
    while stack:
        k, sign = stack.pop()
        op, args, _ = program.instructions[k]
        if k == root or k in inner:
            stack += [(args[1], -sign if op == "sub" else sign), (args[0], sign)]
        else:
            terms.append((k, sign))
    return terms


def _take_out(sums: dict[int, list[Term]], first: int) -> dict[int, Pair]:
    """Replace shared pairs in ``sums`` by new values, numbered from ``first``; return these."""
    pairs: dict[int, Pair] = {}
    while True:
        counts = Counter(p for terms in sums.values() for p in _pairs(terms))
        best = min(counts, key=lambda p: (-counts[p], p), default=None)
        if best is None or counts[best] < 2:
            return pairs
        holders = [terms for terms in sums.values() if best in _pairs(terms)]
        pair = _oriented(best, holders)
        new = first + len(pairs)
        pairs[new] = pair
        for terms in holders:
            sign = dict(terms)[pair.left]
            terms[:] = [t for t in terms if t[0] not in {pair.left, pair.right}]
            terms.append((new, sign))


def _oriented(pair: Pair, holders: list[list[Term]]) -> Pair:
    """Turn a difference around if most sums hold its negative: they add it then."""
    balance = sum(dict(terms)[pair.left] for terms in holders)
    return Pair(pair.right, -1, pair.left) if pair.sign < 0 and balance < 0 else pair


def _pairs(terms: Iterable[Term]) -> list[Pair]:
    return [Pair(a, s * t, b) for (a, s), (b, t) in combinations(sorted(terms), 2)]


def _rebuild(program: Program, sums: dict[int, list[Term]], pairs: dict[int, Pair]) -> Program:
    b = Builder()
    new: dict[int, int] = {}

    def value(k: int) -> int:
        if k not in new:
            left, sign, right = pairs[k]
            new[k] = b.add("add" if sign > 0 else "sub", value(left), value(right))
        return new[k]

    for k, (op, args, leaf) in enumerate(program.instructions):
        if k in sums:
            new[k] = _sum(b, [(value(t), sign) for t, sign in sums[k]])
        else:
            new[k] = b.add(op, *(new[a] for a in args)) if op in OPS else b.leaf(op, leaf)
        if k in program.names:
            b.name(new[k], program.names[k])
    return b.program({g: [new[k] for k in r] for g, r in program.results.items()})


def _sum(b: Builder, terms: list[Term]) -> int:
    """Add the positive terms first; a sum of negative terms alone is negated as a whole."""
    positive = [k for k, sign in terms if sign > 0]
    negative = [k for k, sign in terms if sign < 0]
    if not positive:
        return b.add("neg", _sum(b, [(k, 1) for k in negative]))
    total = positive[0]
    for k in positive[1:]:
        total = b.add("add", total, k)
    for k in negative:
        total = b.add("sub", total, k)
    return total
