"""Products in two parts: what is known early goes together, so that one factor a product is left.

(a x) (b y) / c becomes ((a b / c)) x y where a, b, c are numbers or depend on parameters alone: what
stands in the inner brackets is computed once (see `codegen.passes.pipeline`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from fractions import Fraction
from typing import NamedTuple

from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import BINDING, Builder, Program

EARLY = BINDING["constant"]


class Scaled(NamedTuple):
    """The value ``factor * rest``, the factor known early; ``alone``: it is used in one place."""

    factor: int
    rest: int
    alone: bool = True


class Sum(NamedTuple):
    """The terms of a sum or difference: ``op`` is add or sub."""

    op: str
    left: Scaled
    right: Scaled


def gather(program: Program) -> Program:
    """Bring together the factors of products that are known before a call.

    Law: equal in exact arithmetic; products are rounded in another order. Factors leave values that
    are used once, and others where the product that they enter has an early factor anyway; one that
    both terms of a sum have is taken out; a factor goes into a sum that is used once if each of its
    terms has one already. No step adds an operation to a call.
    """
    return _Gatherer(program).program()


class _Gatherer:
    def __init__(self, program: Program) -> None:
        self.old = program
        self.b = Builder(program.rules)
        self.one = self.b.const(1)
        self.uses = Counter(a for i in program.instructions for a in i.args)
        self.uses.update(k for r in program.results.values() for k in r)
        self.forms: list[Scaled] = []
        self.sums: dict[int, Sum] = {}

    def program(self) -> Program:
        for k, instruction in enumerate(self.old.instructions):
            op, args, _ = instruction
            rule = _RULES.get(op)
            if rule is None or all(self.forms[a].rest == self.one for a in args):
                form = self._other(instruction)
            else:
                form = rule(self, op, args)
            self.forms.append(form._replace(alone=self.uses[k] == 1))
            if k in self.old.names:
                self.b.name(self._value(self.forms[k]), self.old.names[k])
        results = {g: [self._value(self.forms[k]) for k in r] for g, r in self.old.results.items()}
        return prune(self.b.program(results))

    def _plain(self, number: int) -> Scaled:
        """A value that is known early is all factor."""
        early = self.b.binding[number] <= EARLY
        return Scaled(number, self.one) if early else Scaled(self.one, number)

    def _value(self, form: Scaled) -> int:
        """Return the number of a value."""
        factor, rest, alone = form
        if alone and self._has_factor(form) and self._absorbs(Scaled(self.one, rest)):
            return self._spread(factor, rest)
        if self._is(factor, -1):
            return self._negated(form)
        return self.b.add("mul", factor, rest)

    def _negated(self, form: Scaled) -> int:
        """Return minus the rest; a difference, or a sum with one, is turned round."""
        inner = self.sums.get(form.rest)
        if form.alone and inner is not None and inner.op == "add":
            for term, other in (inner[1:], inner[:0:-1]):
                flipped = self._flipped(term)
                if flipped is not None:
                    return self.b.add("sub", self._value(flipped), self._value(other))
        flipped = self._flipped(form._replace(factor=self.one))
        return self.b.add("neg", form.rest) if flipped is None else flipped.rest

    def _absorbs(self, form: Scaled) -> bool:
        """Return whether a factor enters the value without a further operation in the call."""
        if self._has_factor(form):
            return True
        inner = self.sums.get(form.rest)
        return (
            form.alone
            and inner is not None
            and self._absorbs(inner.left)
            and self._absorbs(inner.right)
        )

    def _spread(self, factor: int, rest: int) -> int:
        """Return ``factor * rest`` for a sum that absorbs the factor."""
        op, left, right = self.sums[rest]
        left, right = (
            t._replace(factor=self.b.add("mul", factor, t.factor)) for t in (left, right)
        )
        return self._value(self._sum(op, left, right, self.one))

    def _is(self, number: int, value: int) -> bool:
        op, _, known = self.b.instructions[number]
        return op == "const" and known == value

    def _has_factor(self, form: Scaled) -> bool:
        return not (self._is(form.factor, 1) or self._is(form.factor, -1))

    def _opened(self, k: int, welcome: bool = False) -> Scaled:
        """Return a value in two parts if that costs nothing, else as one."""
        form = self.forms[k]
        if form.alone or welcome or form.rest == self.one:
            return form
        return self._plain(self._value(form))._replace(alone=False)

    def _brings(self, k: int) -> bool:
        """Return whether a value brings an early factor into a product for certain."""
        form = self.forms[k]
        return self._has_factor(form) and (form.alone or form.rest == self.one)

    def _other(self, instruction: Instruction) -> Scaled:
        values = {a: self._value(self.forms[a]) for a in instruction.args}
        return self._plain(self.b.again(instruction, values))

    def _product(self, _: str, args: tuple[int, ...]) -> Scaled:
        a = self._opened(args[0], self._brings(args[1]))
        c = self._opened(args[1], self._brings(args[0]))
        return Scaled(self.b.add("mul", a.factor, c.factor), self.b.add("mul", a.rest, c.rest))

    def _quotient(self, _: str, args: tuple[int, ...]) -> Scaled:
        above, below = self._opened(args[0]), self.forms[args[1]]
        factor, divisor = above.factor, below.rest
        if below.alone and self._has_factor(above) and self._has_factor(below):
            factor = self.b.add("div", above.factor, below.factor)
        else:
            divisor = self._value(below)
        if above.rest == self.one:
            return Scaled(self.one, self.b.add("div", factor, divisor))
        return Scaled(factor, self.b.add("div", above.rest, divisor))

    def _negative(self, _: str, args: tuple[int, ...]) -> Scaled:
        form = self._opened(args[0])
        return Scaled(self.b.add("neg", form.factor), form.rest)

    def _addition(self, op: str, args: tuple[int, ...]) -> Scaled:
        left, right = (self._opened(a) for a in args)
        if self.one in (left.rest, right.rest) or not self._has_factor(left):
            return self._sum(op, left, right, self.one)
        shared = left.factor
        if shared == right.factor or shared == self.b.add("neg", right.factor):
            kind = op if shared == right.factor else _OPPOSITE[op]
            bare = [t._replace(factor=self.one) for t in (left, right)]
            return self._sum(kind, bare[0], bare[1], shared)
        return self._sum(op, left, right, self.one)

    def _sum(self, op: str, left: Scaled, right: Scaled, whole: int) -> Scaled:
        """Return ``whole`` times the sum; minus signs of terms go into the operation."""
        minus_left, left = self._signed(left)
        minus_right, right = self._signed(right)
        op = _OPPOSITE[op] if minus_right else op
        if minus_left and op == "add":
            op, left, right = "sub", right, left
        elif minus_left:
            flipped = [self._flipped(t) for t in (left, right)]
            if flipped[0] is not None:
                left = flipped[0]
            elif flipped[1] is not None:
                left, right = flipped[1], left
            else:
                op, whole = "add", self.b.add("neg", whole)
        number = self.b.add(op, self._value(left), self._value(right))
        if self.b.binding[number] <= EARLY:
            return self._plain(self.b.add("mul", whole, number))
        self.sums.setdefault(number, Sum(op, left, right))
        return Scaled(whole, number)

    def _signed(self, form: Scaled) -> tuple[bool, Scaled]:
        """Return whether the factor has a minus sign, and the value without it."""
        op, args, value = self.b.instructions[form.factor]
        if op == "neg":
            return True, form._replace(factor=args[0])
        if op == "const" and isinstance(value, Fraction) and value < 0:
            return True, form._replace(factor=self.b.const(-value))
        return False, form

    def _flipped(self, form: Scaled) -> Scaled | None:
        """Return the negative of a product with a difference by turning this round, or None."""
        inner = self.sums.get(form.rest)
        if not form.alone or inner is None or inner.op != "sub":
            return None
        number = self.b.unfolded("sub", self._value(inner.right), self._value(inner.left))
        self.sums.setdefault(number, Sum("sub", inner.right, inner.left))
        return form._replace(rest=number)


_OPPOSITE = {"add": "sub", "sub": "add"}
_RULES: dict[str, Callable[[_Gatherer, str, tuple[int, ...]], Scaled]] = {
    "mul": _Gatherer._product,
    "div": _Gatherer._quotient,
    "neg": _Gatherer._negative,
    "add": _Gatherer._addition,
    "sub": _Gatherer._addition,
}
