"""Differences of two values as polynomials, so that what both have in common cancels exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce
from typing import Any

from codegen.ir.fold import Numbers, constant

MAX_TERMS = 24
"""Longer sums stay as they are."""
MAX_INSIDE = 64
"""Values that are looked at; those further down stay letters."""

Monomial = tuple[int, ...]
"""Numbers of the factors, in order; none for a constant."""
Polynomial = dict[Monomial, Any]
"""Coefficients; whole ones are integers, whose arithmetic is ten times as fast."""

_LINEAR = frozenset({"add", "sub", "neg", "mul"})


def linear(b: Numbers, number: int) -> Polynomial:
    """Return a value as a sum of multiples of other values; products of two are not multiplied out."""
    return _expanded(b, number, products=False)


def polynomial(b: Numbers, number: int) -> Polynomial:
    """Return a value multiplied out over its sums and products; other operations are letters."""
    return _expanded(b, number, products=True)


def _expanded(b: Numbers, number: int, *, products: bool) -> Polynomial:
    known: dict[int, Polynomial] = {}
    for k in _inside(b, number):
        op, args, _ = b.instructions[k]
        value = constant(b, k)
        if value is not None:
            whole = value.numerator if value.denominator == 1 else value
            known[k] = {(): whole} if value else {}
            continue
        inside = op in _LINEAR and all(a in known for a in args)
        made = _combined(op, [known[a] for a in args], products) if inside else None
        known[k] = {(k,): 1} if made is None else made
    return known[number]


def _inside(b: Numbers, number: int) -> list[int]:
    """Return the values reached through sums and products alone, in order; not too many."""
    found, stack = {number}, [number]
    while stack and len(found) < MAX_INSIDE:
        op, args, _ = b.instructions[stack.pop()]
        new = set(args) - found if op in _LINEAR else set()
        found |= new
        stack += sorted(new)
    return sorted(found)


def _combined(op: str, parts: Sequence[Polynomial], products: bool) -> Polynomial | None:
    """Return the polynomial of an operation on polynomials; None if it is to stay a letter."""
    if op == "neg":
        return {m: -c for m, c in parts[0].items()}
    if op != "mul":
        total = _sum(parts[0], parts[1], 1 if op == "add" else -1)
        return total if len(total) <= MAX_TERMS else None
    if not products and not any(_is_number(p) for p in parts):
        return None
    if len(parts[0]) * len(parts[1]) > MAX_TERMS:
        return None
    total = {}
    for m, c in parts[0].items():
        for other, d in parts[1].items():
            both = tuple(sorted(m + other))
            total[both] = total.get(both, 0) + c * d
    return {m: c for m, c in total.items() if c}


def _is_number(terms: Polynomial) -> bool:
    return all(not m for m in terms)


def _sum(left: Polynomial, right: Polynomial, factor: int) -> Polynomial:
    return added(dict(left), right if factor > 0 else {m: -c for m, c in right.items()})


def added(into: Polynomial, terms: Mapping[Monomial, Any]) -> Polynomial:
    """Add ``terms`` in place; those that cancel vanish."""
    for monomial, coefficient in terms.items():
        total = into.get(monomial, 0) + coefficient
        if total:
            into[monomial] = total
        else:
            del into[monomial]
    return into


def built(b: Numbers, terms: Polynomial) -> int:
    """Append a polynomial, positive terms first."""
    total = b.const(0)
    for m, c in sorted(terms.items(), key=lambda term: (term[1] < 0, term[0])):
        product = reduce(lambda p, k: b.add("mul", p, k), m, b.const(1))
        scaled = b.add("mul", b.const(c if c > 0 else -c), product)
        total = b.add("add" if c > 0 else "sub", total, scaled)
    return total


def simpler_difference(b: Numbers, x: int, y: int) -> int | None:
    """Return x - y if terms of both cancel, else None; products are multiplied out if need be."""
    for expanded in (linear, polynomial):
        left, right = expanded(b, x), expanded(b, y)
        rest = _sum(left, right, -1)
        if len(rest) < max(len(left), len(right)):
            return built(b, rest)
    return None


def cancelled(left: Polynomial, right: Polynomial, sign: int) -> Polynomial | None:
    """Return left + sign * right if terms of both cancel and at most one is left, else None.

    With more than one left, multiplying out could make a new cancellation: x (x - w) taken from
    (x - y) (x - z) leaves x w - x y - x z + y z, which is worse where y and w are close to x.
    """
    rest = _sum(left, right, sign)
    return rest if len(rest) <= 1 and len(rest) < max(len(left), len(right)) else None


def difference(b: Numbers, x: int, y: int) -> int:
    """Return x - y, what both have in common cancelled."""
    simpler = simpler_difference(b, x, y)
    return b.add("sub", x, y) if simpler is None else simpler
