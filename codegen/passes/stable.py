"""Rewrite sums and functions that cancel to stable forms, by the table of `codegen.passes.identities`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations
from typing import NamedTuple

from codegen.ir import telling
from codegen.ir.fold import constant
from codegen.ir.ops import OPS
from codegen.ir.passes import prune
from codegen.ir.polynomials import Polynomial, built, cancelled, polynomial
from codegen.ir.program import Builder, Program
from codegen.passes.identities import IDENTITIES, LIKE_TERMS, RANGE, Identity

MAX_TERMS = 24
"""Longer sums are left alone: all pairs of terms are looked at."""
MAX_FACTORS = 12
"""Longer products are not searched for common factors."""


class Applied(NamedTuple):
    """An identity that was used, and the number of the value in the program before."""

    identity: str
    number: int


@dataclass(frozen=True)
class Rewriting:
    """A program in stable form, and what was rewritten to get there."""

    program: Program
    applied: tuple[Applied, ...]


class _Term(NamedTuple):
    """A term of a sum: number of the new value, its sign, and the value in the program before."""

    number: int
    sign: int
    old: int


EVERY = (*IDENTITIES, *RANGE)


def rewritten(program: Program, identities: Sequence[Identity] = EVERY) -> Rewriting:
    """Apply every identity wherever it fits, whatever it costs.

    Law: values are equal in exact arithmetic, wherever those of ``program`` are defined.
    """
    return _Rewriter(program, identities, free=False).run()


def rewritten_freely(program: Program, identities: Sequence[Identity] = IDENTITIES) -> Rewriting:
    """Apply identities where they do not make the program more expensive.

    Laws: as for `rewritten`; and the cost of the program does not rise.
    """
    found = _Rewriter(program, identities, free=True).run()
    return found if found.program.cost() <= program.cost() else Rewriting(program, ())


class _Rewriter:
    """Builds a program anew; ``free``: only what costs nothing."""

    def __init__(self, program: Program, identities: Sequence[Identity], *, free: bool) -> None:
        self.program = program
        self.free = free
        self.b = Builder(program.rules)
        self.new: dict[int, int] = {}
        self.applied: list[Applied] = []
        self.fitting: dict[tuple[str, tuple[str, ...], bool], list[Identity]] = {}
        self.factors: dict[int, tuple[int, ...]] = {}
        self.polynomials: dict[int, Polynomial] = {}
        self.rules: dict[str, list[Identity]] = {}
        for identity in identities:
            self.rules.setdefault(identity.op, []).append(identity)
        self.uses = Counter(a for i in program.instructions for a in i.args)
        self.uses.update(k for r in program.results.values() for k in r)
        self.inner = self._inner_sums()

    def run(self) -> Rewriting:
        for k, (op, args, value) in enumerate(self.program.instructions):
            telling.done(1)
            if op not in OPS:
                self.new[k] = self.b.leaf(op, value)
            elif op in {"add", "sub"}:
                self.new[k] = self._sum(k)
            else:
                self.new[k] = self._function(k, op, tuple(self.new[a] for a in args))
            if k in self.program.names:
                self.b.name(self.new[k], self.program.names[k])
        if not self.applied:
            return Rewriting(self.program, ())
        results = {g: [self.new[k] for k in r] for g, r in self.program.results.items()}
        return Rewriting(prune(self.b.program(results)), tuple(self.applied))

    def _inner_sums(self) -> frozenset[int]:
        """Return the sums that serve one other sum alone and have no name."""
        instructions = self.program.instructions
        return frozenset(
            a
            for i in instructions
            if i.op in {"add", "sub"}
            for a in i.args
            if instructions[a].op in {"add", "sub"}
            and self.uses[a] == 1
            and a not in self.program.names
        )

    def _function(self, k: int, op: str, args: tuple[int, ...]) -> int:
        start = len(self.b.instructions)
        for identity in self.rules.get(op, ()):
            found = identity.rule(self.b, args)
            if found is not None and self._pays(found, start, [k]):
                self.applied.append(Applied(identity.text, k))
                return found
        return self.b.again(self.program.instructions[k], self.new)

    def _sum(self, k: int) -> int:
        """Rebuild a sum; an inner one as it is, a whole one with its pairs of terms rewritten."""
        op, args, _ = self.program.instructions[k]
        if k not in self.inner:
            terms = self._terms(k)
            if len(terms) <= MAX_TERMS:
                cancelled = self._cancel(k, terms)
                if self._rewrite_pairs(k, terms) or cancelled:
                    return self._total(terms)
        return self.b.add(op, *(self.new[a] for a in args))

    def _terms(self, root: int) -> list[_Term]:
        terms: list[_Term] = []
        stack = [(root, 1)]
        while stack:
            k, sign = stack.pop()
            op, args, _ = self.program.instructions[k]
            if k == root or k in self.inner:
                stack += [(args[1], -sign if op == "sub" else sign), (args[0], sign)]
            else:
                terms.append(self._signed(_Term(self.new[k], sign, k)))
        return terms

    def _signed(self, term: _Term) -> _Term:
        """Turn a negative constant, or a product with one, into its opposite."""
        op, args, _ = self.b.instructions[term.number]
        values = [constant(self.b, a) for a in ((term.number,) if op == "const" else args)]
        if op in {"const", "mul"} and any(v is not None and v < 0 for v in values):
            return _Term(self.b.add("neg", term.number), -term.sign, term.old)
        return term

    def _cancel(self, k: int, terms: list[_Term]) -> bool:
        """Replace pairs of terms that cancel when multiplied out; tell whether there were any."""
        changed = False
        while True:
            found = next(self._cancelling(k, terms), None)
            if found is None:
                return changed
            first, second, term = found
            terms[:] = [t for t in terms if t is not first and t is not second]
            terms.append(self._signed(term))
            self.applied.append(Applied(LIKE_TERMS, k))
            changed = True

    def _cancelling(self, k: int, terms: Sequence[_Term]) -> Iterator[tuple[_Term, _Term, _Term]]:
        products = [t for t in terms if self.b.instructions[t.number].op in {"mul", "neg"}]
        for first, second in combinations(products, 2):
            left, right = self._polynomial(first.number), self._polynomial(second.number)
            rest = cancelled(left, right, first.sign * second.sign)
            if rest is not None:
                start = len(self.b.instructions)
                value = built(self.b, rest)
                if self._pays(value, start, [first.old, second.old]):
                    yield first, second, _Term(value, first.sign, k)

    def _polynomial(self, number: int) -> Polynomial:
        if number not in self.polynomials:
            self.polynomials[number] = polynomial(self.b, number)
        return self.polynomials[number]

    def _rewrite_pairs(self, k: int, terms: list[_Term]) -> bool:
        """Replace pairs of terms until no identity fits; tell whether one did."""
        changed = False
        while True:
            found = next(self._matches(k, terms), None)
            if found is None:
                return changed
            identity, first, second, term = found
            terms[:] = [t for t in terms if t is not first and t is not second]
            terms.append(term)
            self.applied.append(Applied(identity.text, k))
            changed = True

    def _matches(
        self, k: int, terms: Sequence[_Term]
    ) -> Iterator[tuple[Identity, _Term, _Term, _Term]]:
        for first, second in combinations(terms, 2):
            orders = [(first, second)]
            orders += [(second, first)] if first.sign != second.sign else []
            for x, y in orders:
                for identity, value, start in self._values(x, y, alone=len(terms) == 2):
                    if self._pays(value, start, [x.old, y.old]):
                        yield identity, first, second, _Term(value, x.sign, k)

    def _values(self, x: _Term, y: _Term, *, alone: bool) -> Iterator[tuple[Identity, int, int]]:
        """Return x - y or x + y by each identity that fits, also to z and w in f z and f w."""
        op = "add" if x.sign == y.sign else "sub"
        plain = (self.b.instructions[x.number].op, self.b.instructions[y.number].op)
        for identity in self._fitting(op, plain, alone):
            start = len(self.b.instructions)
            value = identity.rule(self.b, (x.number, y.number))
            if value is not None:
                yield identity, value, start
        left, right = Counter(self._factors(x.number)), Counter(self._factors(y.number))
        common = left & right
        if not common:
            return
        rest = [sorted((side - common).elements()) for side in (left, right)]
        for identity in self._fitting(op, (self._head(rest[0]), self._head(rest[1])), alone):
            start = len(self.b.instructions)
            value = identity.rule(self.b, (self._product(rest[0]), self._product(rest[1])))
            if value is not None:
                factor = self._product(sorted(common.elements()))
                yield identity, self.b.add("mul", factor, value), start

    def _fitting(self, op: str, operations: tuple[str, ...], alone: bool) -> list[Identity]:
        key = (op, operations, alone)
        if key not in self.fitting:
            rules = [i for i in self.rules.get(op, ()) if alone or not i.alone]
            self.fitting[key] = [i for i in rules if i.fits(operations)]
        return self.fitting[key]

    def _factors(self, number: int) -> tuple[int, ...]:
        """Return what a value is the product of, ones left out; a long product is one factor."""
        if number not in self.factors:
            found: list[int] = []
            stack = [number]
            while stack:
                if len(found) + len(stack) > MAX_FACTORS:
                    found = [number]
                    break
                k = stack.pop()
                op, args, _ = self.b.instructions[k]
                if op == "mul":
                    stack += args
                elif constant(self.b, k) != 1:
                    found.append(k)
            self.factors[number] = tuple(found)
        return self.factors[number]

    def _head(self, factors: Sequence[int]) -> str:
        """Return the operation that the product of ``factors`` is."""
        if not factors:
            return "const"
        return self.b.instructions[factors[0]].op if len(factors) == 1 else "mul"

    def _product(self, factors: Iterable[int]) -> int:
        return reduce(lambda p, k: self.b.add("mul", p, k), factors, self.b.const(1))

    def _total(self, terms: Sequence[_Term]) -> int:
        """Add the positive terms first."""
        total = self.b.const(0)
        for term in sorted(terms, key=lambda t: t.sign < 0):
            total = self.b.add("add" if term.sign > 0 else "sub", total, term.number)
        return total

    def _pays(self, value: int, start: int, before: Sequence[int]) -> bool:
        """Tell whether a value costs no more than what it makes superfluous, where that matters."""
        if not self.free:
            return True
        made, used = self._made(value, start)
        spent = sum(self._cost(self.b.instructions[k].op) for k in made)
        return spent <= self._saved(before, used)

    def _made(self, value: int, start: int) -> tuple[set[int], set[int]]:
        """Return what was appended from ``start`` on for a value, and what that uses of before."""
        made, used, stack = set(), set(), [value]
        while stack:
            k = stack.pop()
            if k < start:
                used.add(k)
            elif k not in made:
                made.add(k)
                stack += self.b.instructions[k].args
        return made, used

    def _saved(self, before: Sequence[int], used: set[int]) -> int:
        """Return the cost of what ``before`` alone needs; several terms save additions, too."""
        total = len(before) - 1
        stack = [k for k in before if len(before) == 1 or self.uses[k] == 1]
        while stack:
            k = stack.pop()
            if self.new.get(k, -1) in used:
                continue
            total += self._cost(self.program.instructions[k].op)
            stack += [a for a in set(self.program.instructions[k].args) if self._only_there(a, k)]
        return total

    def _only_there(self, a: int, k: int) -> bool:
        return self.uses[a] == Counter(self.program.instructions[k].args)[a]

    @staticmethod
    def _cost(op: str) -> int:
        return OPS[op].cost if op in OPS else 0
