"""Rewrite sums and functions that cancel to stable forms, by a table of identities.

Sources: Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed. 2002, sect. 1.7, 1.8 and
problems 1.1 to 1.5; Hamming, Numerical Methods for Scientists and Engineers, 2nd ed. 1973, ch. 4;
Goldberg, What Every Computer Scientist Should Know About Floating-Point Arithmetic, 1991, sect. 1.4.
A rule takes the builder and the numbers of the operands and returns the number of a value that is equal
in exact arithmetic, or None where the pattern is another one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import combinations
from typing import NamedTuple

from codegen.ir import compile_progress
from codegen.ir.fold import Numbers, constant
from codegen.ir.ops import OPS
from codegen.ir.passes import prune
from codegen.ir.polynomials import (
    Polynomial,
    built,
    cancelled,
    difference,
    linear,
    polynomial,
    simpler_difference,
)
from codegen.ir.program import Builder, Program

Rule = Callable[[Numbers, tuple[int, ...]], int | None]
"""From the operands of an operation to the number of an equal value, or None."""


@dataclass(frozen=True)
class Identity:
    """A rule: its text, the operation that it replaces, and operations that it may need.

    ``op``: ``sub`` and ``add`` are tried on any two terms of a sum, or, with ``alone``, where the
    two are the whole sum. A difference is tried in both directions. ``heads``: which operations the
    two operands of a difference may be, so that others are passed over quickly; empty is any.
    """

    text: str
    op: str
    rule: Rule
    heads: tuple[str, str] = ("", "")
    needs: tuple[str, ...] = ()
    alone: bool = False

    def fits(self, operations: tuple[str, ...]) -> bool:
        """Return whether the rule may fit operands that are these operations."""
        pairs = zip(self.heads, operations, strict=False)
        return all(not head or op in head.split() for head, op in pairs)


def _is(b: Numbers, number: int, op: str) -> int | None:
    """Return the operand if ``number`` is the unary operation ``op``."""
    instruction = b.instructions[number]
    return instruction.args[0] if instruction.op == op else None


def _square_of(b: Numbers, number: int) -> int | None:
    """Return x if ``number`` is x * x."""
    op, args, _ = b.instructions[number]
    return args[0] if op == "mul" and args[0] == args[1] else None


def _half(b: Numbers, number: int) -> int:
    return b.add("mul", b.const(Fraction(1, 2)), number)


def _squared(b: Numbers, number: int) -> int:
    return b.add("mul", number, number)


def _twice(b: Numbers, number: int) -> int:
    return b.add("mul", b.const(2), number)


def _one_less(outer: str, inner: str) -> Rule:
    """1 - cos x or cosh x - 1: twice the square of ``inner`` at half the argument."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        one, function = args if outer == "cos" else args[::-1]
        x = _is(b, function, outer)
        if x is None or constant(b, one) != 1:
            return None
        return _twice(b, _squared(b, b.add(inner, _half(b, x))))

    return rule


def _product(outer: str, of_sum: str, of_difference: str, sign: int) -> Rule:
    """A difference of two values of one function as twice a product over sum and difference."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        x, y = (_is(b, a, outer) for a in args)
        if x is None or y is None:
            return None
        mean = b.add(of_sum, _half(b, b.add("add", x, y)))
        apart = b.add(of_difference, _half(b, difference(b, x, y)))
        return b.add("mul", b.const(2 * sign), b.add("mul", mean, apart))

    return rule


def _atan_difference(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = (_is(b, a, "atan") for a in args)
    if x is None or y is None:
        return None
    across = b.add("add", b.const(1), b.add("mul", x, y))
    return b.add("atan2", difference(b, x, y), across)


def _squares(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = (_square_of(b, a) for a in args)
    if x is None or y is None or {b.instructions[k].op for k in (x, y)} & {"sin", "cos"}:
        return None
    return b.add("mul", difference(b, x, y), b.add("add", x, y))


def _complement(outer: str, inner: str) -> Rule:
    """1 - sin^2 or 1 - cos^2: the square of the other one."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        square = _square_of(b, args[1])
        x = None if square is None else _is(b, square, outer)
        if x is None or constant(b, args[0]) != 1:
            return None
        return _squared(b, b.add(inner, x))

    return rule


def _cosh_square_less_one(b: Numbers, args: tuple[int, ...]) -> int | None:
    square = _square_of(b, args[0])
    x = None if square is None else _is(b, square, "cosh")
    return None if x is None or constant(b, args[1]) != 1 else _squared(b, b.add("sinh", x))


def _double_angle(b: Numbers, args: tuple[int, ...]) -> int | None:
    squares = [_square_of(b, a) for a in args]
    if squares[0] is None or squares[1] is None:
        return None
    x, y = _is(b, squares[0], "cos"), _is(b, squares[1], "sin")
    return b.add("cos", _twice(b, x)) if x is not None and x == y else None


def _one_less_tanh_square(b: Numbers, args: tuple[int, ...]) -> int | None:
    square = _square_of(b, args[1])
    x = None if square is None else _is(b, square, "tanh")
    if x is None or constant(b, args[0]) != 1:
        return None
    return _squared(b, b.add("div", b.const(1), b.add("cosh", x)))


def _exp_less_one(b: Numbers, args: tuple[int, ...]) -> int | None:
    x = _is(b, args[0], "exp")
    return None if x is None or constant(b, args[1]) != 1 else b.add("expm1", x)


def _log_of_one_more(b: Numbers, args: tuple[int, ...]) -> int | None:
    terms = linear(b, args[0])
    if terms.get(()) != 1 or len(terms) < 2:
        return None
    return b.add("log1p", built(b, {m: c for m, c in terms.items() if m}))


def _root_difference(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = (_is(b, a, "sqrt") for a in args)
    above = None if x is None or y is None else simpler_difference(b, x, y)
    return None if above is None else b.add("div", above, b.add("add", *args))


def _beside_root(sign: int) -> Rule:
    """Sqrt(d) + sign*v over the conjugate, where sign*v is negative: it is chosen at run time."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        for root, v in (args,) if sign < 0 else (args, args[::-1]):
            d = _is(b, root, "sqrt")
            above = None if d is None else simpler_difference(b, d, _squared(b, v))
            if above is None or _is(b, v, "sqrt") is not None:
                continue
            if _nonnegative(b, v):
                return None if sign > 0 else b.add("div", above, b.add("add", root, v))
            below = b.add("add", root, b.add("abs", v))
            order = (b.const(0), v) if sign < 0 else (v, b.const(0))
            return b.add("select", b.add("lt", *order), b.add("div", above, below), below)
        return None

    return rule


_NEVER_NEGATIVE = frozenset({"sqrt", "abs", "exp", "cosh"})


def _nonnegative(b: Numbers, number: int) -> bool:
    value = constant(b, number)
    return (
        (value is not None and value >= 0)
        or b.instructions[number].op in _NEVER_NEGATIVE
        or _square_of(b, number) is not None
    )


def _reciprocal(b: Numbers, number: int) -> int | None:
    """Return x if ``number`` is 1 / x; 1 is 1 / 1."""
    if constant(b, number) == 1:
        return number
    op, args, _ = b.instructions[number]
    return args[1] if op == "div" and constant(b, args[0]) == 1 else None


def _reciprocals(b: Numbers, args: tuple[int, ...]) -> int | None:
    x, y = (_reciprocal(b, a) for a in args)
    if x is None or y is None:
        return None
    above = simpler_difference(b, y, x)
    return None if above is None else b.add("div", above, b.add("mul", x, y))


def _reciprocal_roots(b: Numbers, args: tuple[int, ...]) -> int | None:
    """One of the roots may be 1."""
    x, y = (_reciprocal(b, a) for a in args)
    if x is None or y is None:
        return None
    insides = [k if constant(b, k) == 1 else _is(b, k, "sqrt") for k in (x, y)]
    if insides[0] is None or insides[1] is None:
        return None
    above = simpler_difference(b, insides[1], insides[0])
    below = b.add("mul", b.add("mul", x, y), b.add("add", x, y))
    return None if above is None else b.add("div", above, below)


def _arc_of_one_and(sign: int, inverse: str) -> Rule:
    """Acos(1 - y) or acosh(1 + y): twice the inverse sine of sqrt(y/2)."""

    def rule(b: Numbers, args: tuple[int, ...]) -> int | None:
        terms = linear(b, args[0])
        if terms.get(()) != 1 or len(terms) < 2:
            return None
        y = built(b, {m: sign * c for m, c in terms.items() if m})
        return _twice(b, b.add(inverse, b.add("sqrt", _half(b, y))))

    return rule


def _less_sine(b: Numbers, args: tuple[int, ...]) -> int | None:
    if _is(b, args[1], "sin") != args[0]:
        return None
    square = _squared(b, args[0])
    return b.add("mul", b.add("mul", args[0], square), b.add("stumpff", b.const(3), square))


def _norm(b: Numbers, args: tuple[int, ...]) -> int | None:
    op, terms, _ = b.instructions[args[0]]
    x, y = (_square_of(b, k) for k in terms) if op == "add" else (None, None)
    return None if x is None or y is None else b.add("hypot", x, y)


_COSINES = _product("cos", "sin", "sin", -1)
_SINES = _product("sin", "cos", "sin", 1)
_HYPERBOLIC_COSINES = _product("cosh", "sinh", "sinh", 1)
_HYPERBOLIC_SINES = _product("sinh", "cosh", "sinh", 1)

_ONE = "const"

_ROWS = (
    Identity("1 - cos x = 2 sin^2(x/2)", "sub", _one_less("cos", "sin"), (_ONE, "cos")),
    Identity("cosh x - 1 = 2 sinh^2(x/2)", "sub", _one_less("cosh", "sinh"), ("cosh", _ONE)),
    Identity("cos^2 x - sin^2 x = cos 2x", "sub", _double_angle, ("mul", "mul")),
    Identity("1 - sin^2 x = cos^2 x", "sub", _complement("sin", "cos"), (_ONE, "mul")),
    Identity("1 - cos^2 x = sin^2 x", "sub", _complement("cos", "sin"), (_ONE, "mul")),
    Identity("cosh^2 x - 1 = sinh^2 x", "sub", _cosh_square_less_one, ("mul", _ONE)),
    Identity("1 - tanh^2 x = 1/cosh^2 x", "sub", _one_less_tanh_square, (_ONE, "mul")),
    Identity("cos x - cos y = -2 sin((x + y)/2) sin((x - y)/2)", "sub", _COSINES, ("cos", "cos")),
    Identity("sin x - sin y = 2 cos((x + y)/2) sin((x - y)/2)", "sub", _SINES, ("sin", "sin")),
    Identity("cosh x - cosh y = 2 sinh((x + y)/2) sinh((x - y)/2)", "sub", _HYPERBOLIC_COSINES, ("cosh", "cosh")),
    Identity("sinh x - sinh y = 2 cosh((x + y)/2) sinh((x - y)/2)", "sub", _HYPERBOLIC_SINES, ("sinh", "sinh")),
    Identity("atan x - atan y = atan2(x - y, 1 + x y)", "sub", _atan_difference, ("atan", "atan")),
    Identity("x - sin x = x^3 c_3(x^2), c_3 of Stumpff", "sub", _less_sine, ("", "sin"), ("stumpff",)),
    Identity("exp x - 1 = expm1 x", "sub", _exp_less_one, ("exp", _ONE), ("expm1",)),
    Identity("sqrt x - sqrt y = (x - y)/(sqrt x + sqrt y)", "sub", _root_difference, ("sqrt", "sqrt")),
    Identity("sqrt x - y = (x - y^2)/(sqrt x + y) for y > 0", "sub", _beside_root(-1), ("sqrt", "")),
    Identity("sqrt x + y = (x - y^2)/(sqrt x - y) for y < 0", "add", _beside_root(1)),
    Identity("1/sqrt x - 1/sqrt y = (y - x)/(sqrt x sqrt y (sqrt x + sqrt y))", "sub", _reciprocal_roots, ("div const", "div const")),
    Identity("1/x - 1/y = (y - x)/(x y)", "sub", _reciprocals, ("div const", "div const")),
    Identity("x^2 - y^2 = (x - y)(x + y)", "sub", _squares, ("mul", "mul"), alone=True),
    Identity("acos(1 - x) = 2 asin sqrt(x/2)", "acos", _arc_of_one_and(-1, "asin")),
    Identity("acosh(1 + x) = 2 asinh sqrt(x/2)", "acosh", _arc_of_one_and(1, "asinh")),
    Identity("log(1 + x) = log1p x", "log", _log_of_one_more, needs=("log1p",)),
)  # fmt: skip


LIKE_TERMS = "x y - y x = 0"
"""Terms of a sum that cancel when all products are multiplied out; `codegen.passes.stable` looks for them."""


def _known(rows: tuple[Identity, ...]) -> tuple[Identity, ...]:
    return tuple(row for row in rows if all(op in OPS for op in row.needs))


IDENTITIES: tuple[Identity, ...] = _known(_ROWS)
"""Identities against cancellation; those whose operations are not in `ops` are left out."""

RANGE: tuple[Identity, ...] = _known(
    (Identity("sqrt(x^2 + y^2) = hypot(x, y)", "sqrt", _norm, needs=("hypot",)),)
)
"""Identities against overflow and underflow; they cost time and cure no cancellation."""


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
            compile_progress.done(1)
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
        """Replace pairs of terms that cancel when multiplied out; return whether there were any."""
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
        """Replace pairs of terms until no identity fits; return whether one did."""
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
        """Return whether a value costs no more than what it makes superfluous, where that matters."""
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
