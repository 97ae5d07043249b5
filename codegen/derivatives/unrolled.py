"""Programs of all Taylor coefficients up to an order: the rules of `taylor` as instructions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from codegen.derivatives.taylor import JET, RULES, SWITCHES, Order, Prepared, Series, residuals
from codegen.ir.ops import Instruction
from codegen.ir.passes import prune
from codegen.ir.program import Builder, Program
from codegen.ir.scalars import Scalar

Also = Callable[[Builder, Sequence[Sequence[Scalar]]], Mapping[str, Sequence[int]]]
"""What makes further groups of results, from the coefficients of all values."""


def unrolled(prepared: Prepared, group: str, order: int, also: Also | None = None) -> Program:
    """Return a program of all coefficients x_1 to x_order of the states, in the group `JET`.

    ``group`` are the rates of the states, in order. Law: the results are the coefficients of the
    solution through the states at the time t, which the program reads. Where there are switching
    functions, the group `SWITCHES` has their coefficients of orders 0 to ``order`` - 1 likewise. ``also``
    adds groups.
    """
    b = Builder(prepared.program.rules)
    jet = _Unrolled(b, prepared)
    rates = prepared.program.results[group]
    states: list[list[Scalar]] = [[Scalar(b, b.leaf("state", i))] for i in range(len(rates))]
    for k in range(order):
        jet.advance(k, states)
        for state, rate in zip(states, rates, strict=True):
            state.append(_scaled(jet.series[rate][k], Fraction(1, k + 1)))
    results = [states[i][k].number for k in range(1, order + 1) for i in range(len(rates))]
    groups = {JET: results}
    if prepared.switches:
        groups[SWITCHES] = [
            jet.series[m][k].number for k in range(order) for m in prepared.switches
        ]
    further = also(b, jet.series) if also else {}
    return prune(b.program({**groups, **further}))


def _scaled(a: Scalar, factor: Fraction) -> Any:
    """Return a * factor; a constant factor of ``a`` is multiplied beforehand."""
    op, args, _ = a.builder.instructions[a.number]
    for k, other in (args, args[::-1]) if op == "mul" else ():
        value = a.builder.instructions[k].value
        if a.builder.instructions[k].op == "const" and isinstance(value, Fraction):
            return Scalar(a.builder, other) * (value * factor)
    return a * factor


class _Unrolled(Order):
    """All orders as instructions; what is zero is folded away by the builder."""

    def __init__(self, b: Builder, prepared: Prepared) -> None:
        self.b, self.prepared, self.k = b, prepared, 0
        self.series: list[list[Scalar]] = [[] for _ in prepared.program.instructions]
        self.zero = Scalar(b, b.const(0))

    def advance(self, k: int, states: Sequence[Sequence[Scalar]]) -> None:
        """Append the coefficient of order ``k`` of every value."""
        self.k = k
        for n, instruction in enumerate(self.prepared.program.instructions):
            if instruction.op == "state":
                term = states[instruction.slot][k]
            elif k == 0:
                args = {a: self.series[a][0].number for a in instruction.args}
                term = Scalar(self.b, self.b.again(instruction, args))
            elif instruction.op == "time":
                term = Scalar(self.b, self.b.const(int(k == 1)))
            elif not self.prepared.varies[n] or instruction.op == "factor":
                term = self.zero
            else:
                term = self._coefficient(n, instruction)
            self.series[n].append(term)

    def _coefficient(self, n: int, instruction: Instruction) -> Scalar:
        op, args, value = instruction
        if op == "back":
            return self._solve(n, args)
        if op == "item":
            return Scalar(
                self.b, self.b.add("item", self.series[args[0]][self.k].number, value=value)
            )
        term: Scalar = RULES[op].coefficient(self, n, args, self.prepared.partner(n))
        return term

    def _solve(self, n: int, args: Sequence[int]) -> Scalar:
        """A_0 x_k = f_k - sum of A_j x_(k-j): one factorisation serves all orders."""
        right = residuals(self, self.prepared, n)
        factor = self.series[args[0]][0].number
        return Scalar(self.b, self.b.add("back", factor, *(r.number for r in right)))

    def now(self, a: Series) -> Scalar:
        return self.series[a][self.k]

    def first(self, a: Series) -> Scalar:
        return self.series[a][0]

    def inverse(self, a: Series) -> Any:
        return 1 / self.series[a][0]

    def dot(self, a: Series, b: Series, low: int = 0, high: int = 0) -> Scalar:
        k, one, other = self.k, self.series[a], self.series[b]
        if a == b and low == high:
            pairs = [(one[j] * (1 if 2 * j == k else 2), one[k - j], k - j)
                     for j in range(low, k // 2 + 1)]  # fmt: skip
        else:
            pairs = [(one[j], other[k - j], max(j, k - j)) for j in range(low, k - high + 1)]
        return self._total(pairs)

    def moment(self, a: Series, b: Series, high: int = 0) -> Any:
        k = self.k
        pairs = [(self.series[a][j] * j, self.series[b][k - j], max(j, k - j))
                 for j in range(1, k - high + 1)]  # fmt: skip
        return self._total(pairs) * Fraction(1, k)

    def _total(self, pairs: Sequence[tuple[Scalar, Scalar, int]]) -> Scalar:
        """Add products, those with the latest coefficients last, so that little waits for these."""
        total = self.zero
        for one, other, _ in sorted(pairs, key=lambda pair: pair[2]):
            total = total + one * other
        return total

    def choose(self, negative: Any, a: Any, b: Any) -> Scalar:
        condition = negative < 0
        return Scalar(self.b, self.b.add("select", condition.number, a.number, b.number))
