"""SymPy expressions to programs, with an explicit stack: no recursion, each distinct node once."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from codegen import fold
from codegen.interpret import Point, interpret_exactly
from codegen.passes import prune
from codegen.program import Builder, Name, Program
from eom.errors import InputError
from eom.system import Definition, System, as_expression

Expr = Any

RATES, OUTPUTS, INVARIANTS, SINGULARITIES = "rates", "outputs", "invariants", "singularities"
GROUPS = (RATES, OUTPUTS, INVARIANTS, SINGULARITIES)
"""Groups of results of a lowered system."""

SAME = 1e-40
"""Values in 50 digits that differ by less, relatively, are the same."""

MAX_SPLIT_BITS = 512
"""Larger numerators and denominators are rounded as one quotient: they may overflow alone."""

_FUNCTIONS: dict[Any, str] = {
    sp.sin: "sin", sp.cos: "cos", sp.tan: "tan", sp.asin: "asin", sp.acos: "acos", sp.atan: "atan",
    sp.sinh: "sinh", sp.cosh: "cosh", sp.tanh: "tanh", sp.asinh: "asinh", sp.acosh: "acosh",
    sp.atanh: "atanh", sp.exp: "exp", sp.log: "log", sp.atan2: "atan2", sp.Abs: "abs", sp.sign: "sign",
}  # fmt: skip
_RECIPROCALS: dict[Any, str] = {
    sp.sec: "cos",
    sp.csc: "sin",
    sp.cot: "tan",
    sp.sech: "cosh",
    sp.csch: "sinh",
    sp.coth: "tanh",
}
_CHAINS: dict[Any, str] = {sp.Min: "min", sp.Max: "max", sp.And: "and", sp.Or: "or"}
_COMPARISONS: dict[Any, tuple[str, bool]] = {
    sp.StrictLessThan: ("lt", False),
    sp.StrictGreaterThan: ("lt", True),
    sp.LessThan: ("le", False),
    sp.GreaterThan: ("le", True),
    sp.Equality: ("eq", False),
}


def lower_system(system: System, rules: fold.RuleSet = fold.ALGEBRAIC) -> Program:
    """Return the program of a system, with its results in `GROUPS`.

    A mass matrix must be symmetric in value; the accelerations come from an unrolled LDL^T factorisation
    of it, never from a symbolic inverse. Raises `InputError` for expressions without an operation.
    """
    b = Builder(rules)
    slots = {system.time: b.leaf("time")}
    for op, group in (
        ("state", system.states),
        ("parameter", system.parameters),
        ("input", system.inputs),
    ):
        slots |= {q.symbol: b.leaf(op, k) for k, q in enumerate(group)}
    lowering = Lowering(b, slots, system.name)
    for definition in system.definitions:
        lowering.define(definition)
    rates = [lowering.lower(r) for r in system.rates]
    if system.mass_matrix is not None:
        rates = solve_symmetric(b, _lower_matrix(lowering, system.mass_matrix), rates)
    for definition in (*system.outputs, *system.invariants):
        number = lowering.lower(definition.expression)
        b.name(number, _name(definition))
    results = {
        RATES: rates,
        OUTPUTS: [lowering.lower(d.expression) for d in system.outputs],
        INVARIANTS: [lowering.lower(d.expression) for d in system.invariants],
        SINGULARITIES: [lowering.lower(s.expression) for s in system.singularities],
    }
    return b.program(results)


def lower_expressions(
    expressions: Mapping[str, Sequence[Expr]],
    states: Sequence[Expr],
    parameters: Sequence[Expr] = (),
) -> Program:
    """Return the program of groups of expressions over ``states`` and ``parameters``."""
    b = Builder()
    slots = {s: b.leaf("state", k) for k, s in enumerate(states)}
    slots |= {s: b.leaf("parameter", k) for k, s in enumerate(parameters)}
    lowering = Lowering(b, slots)
    return b.program(
        {g: [lowering.lower(as_expression(e)) for e in group] for g, group in expressions.items()}
    )


def _name(definition: Definition) -> Name:
    return Name(definition.name, definition.quantity.description)


def _lower_matrix(lowering: Lowering, mass: Expr) -> list[list[int]]:
    """Lower a symmetric matrix; entries that are written differently are compared by value."""
    n = mass.rows
    matrix = [[lowering.lower(mass[i, j]) for j in range(n)] for i in range(n)]
    skew = [(i, j) for i in range(n) for j in range(i) if matrix[i][j] != matrix[j][i]]
    different = _different(lowering.b, [(matrix[i][j], matrix[j][i]) for i, j in skew])
    if different is not None:
        i, j = skew[different]
        raise InputError(
            "mass matrix is not symmetric",
            where=f"system {lowering.where!r}, entries ({j + 1}, {i + 1}) and ({i + 1}, {j + 1})",
            got=f"{mass[j, i]} and {mass[i, j]}",
            hint="only symmetric mass matrices are solved",
        )
    return matrix


def _different(b: Builder, pairs: Sequence[tuple[int, int]]) -> int | None:
    """Return the first pair of values that differ, in 50 digits, at some random point; or None."""
    if not pairs:
        return None
    groups = {"left": [a for a, _ in pairs], "right": [c for _, c in pairs]}
    program = prune(b.program(groups))
    sizes = {
        kind: max((int(i.value or 0) + 1 for i in program.instructions if i.op == kind), default=0)
        for kind in ("state", "parameter", "input")
    }
    for seed in range(3):
        generator = random.Random(seed)  # noqa: S311 - reproducible points
        x, p, u = ([generator.uniform(0.5, 1.5) for _ in range(k)] for k in sizes.values())
        values = interpret_exactly(program, Point(generator.random(), x, p, u))
        for k, (left, right) in enumerate(zip(values["left"], values["right"], strict=True)):
            if not abs(left - right) <= SAME * (1 + abs(left)):
                return k
    return None


def solve_symmetric(b: Builder, matrix: list[list[int]], right: list[int]) -> list[int]:
    """Append the solution of a symmetric positive definite system, by LDL^T without square roots.

    Golub and Van Loan, Matrix Computations, 4th ed., algorithm 4.1.2. Zeros are folded away.
    """
    n = len(right)
    diagonal: list[int] = []
    lower = [[b.const(0)] * n for _ in range(n)]
    for j in range(n):
        scaled = [b.add("mul", lower[j][k], diagonal[k]) for k in range(j)]
        for i in range(j, n):
            entry = matrix[i][j]
            for k in range(j):
                entry = b.add("sub", entry, b.add("mul", lower[i][k], scaled[k]))
            if i == j:
                diagonal.append(entry)
            else:
                lower[i][j] = b.add("div", entry, diagonal[j])
    x = list(right)
    for i in range(n):
        for k in range(i):
            x[i] = b.add("sub", x[i], b.add("mul", lower[i][k], x[k]))
    x = [b.add("div", xi, d) for xi, d in zip(x, diagonal, strict=True)]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] = b.add("sub", x[i], b.add("mul", lower[k][i], x[k]))
    return x


class Lowering:
    """Lower expressions over symbols that have numbers; a memo keeps each node's number."""

    def __init__(self, b: Builder, slots: Mapping[Expr, int], where: str = "") -> None:
        self.b = b
        self.memo: dict[Expr, int] = dict(slots)
        self.where = where

    def define(self, definition: Definition) -> None:
        """Lower a definition; its symbol stands for the value from here on."""
        number = self.lower(definition.expression)
        self.b.name(number, _name(definition))
        self.memo[definition.symbol] = number

    def lower(self, expression: Expr) -> int:
        """Return the number of the value of ``expression``."""
        stack = [expression]
        while stack:
            node = stack[-1]
            if node in self.memo:
                stack.pop()
                continue
            children, build = self._rule(node)
            missing = [c for c in children if c not in self.memo]
            if missing:
                stack.extend(reversed(missing))
                continue
            self.memo[node] = build([self.memo[c] for c in children])
            stack.pop()
        return self.memo[expression]

    def _rule(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Return the children of a node and how to build its value from theirs."""
        kind = type(node)
        if kind in _FUNCTIONS:
            return node.args, lambda a: self.b.add(_FUNCTIONS[kind], *a)
        if kind in _RECIPROCALS:
            return node.args, lambda a: self.b.add(
                "div", self.b.const(1), self.b.add(_RECIPROCALS[kind], *a)
            )
        if kind in _CHAINS:
            return self._sorted(node.args), lambda a: self._chain(_CHAINS[kind], a)
        if kind in _COMPARISONS:
            op, swap = _COMPARISONS[kind]
            return node.args, lambda a: self.b.add(op, *(a[::-1] if swap else a))
        for test, rule in _RULES:
            if isinstance(node, test):
                return rule(self, node)
        raise InputError(
            "no operation computes this expression",
            where=self.where,
            got=f"{kind.__name__}: {node}"[:300],
            expected="sums, products, powers, elementary functions, min, max, abs, sign, Piecewise",
        )

    @staticmethod
    def _sorted(args: Iterable[Expr]) -> list[Expr]:
        """Arguments of Min, Max, And, Or come as a set; a fixed order keeps the output the same."""
        return sorted(args, key=lambda e: e.sort_key())

    def _chain(self, op: str, numbers: list[int]) -> int:
        result = numbers[0]
        for number in numbers[1:]:
            result = self.b.add(op, result, number)
        return result

    def number(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower a rational or floating-point number exactly."""
        exact = sp.Rational(node) if node.is_finite else None
        if exact is None:
            raise InputError("not a finite number", where=self.where, got=node)
        return (), lambda _: self.b.const(Fraction(int(exact.p), int(exact.q)))

    def sum(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower a sum, positive terms first; a factor or sign that all terms share is taken out."""
        terms = sorted((t.as_coeff_Mul() for t in node.args), key=lambda term: bool(term[0] < 0))
        sizes = {abs(c) for c, _ in terms}
        shared = sizes.pop() if len(sizes) == 1 else sp.Integer(1)
        shared = -shared if terms[0][0] < 0 else shared
        coefficients = [c / shared for c, _ in terms]

        def build(numbers: list[int]) -> int:
            total = self._scaled(numbers[0], abs(coefficients[0]))
            total = total if coefficients[0] > 0 else self.b.add("neg", total)
            for coefficient, number in zip(coefficients[1:], numbers[1:], strict=True):
                term = self._scaled(number, abs(coefficient))
                total = self.b.add("sub" if coefficient < 0 else "add", total, term)
            return self._scaled(total, shared)

        return [rest for _, rest in terms], build

    def _scaled(self, number: int, coefficient: Expr) -> int:
        """Multiply by an exact number; a denominator other than a power of two divides."""
        exact = sp.Rational(coefficient)
        p, q = int(exact.p), int(exact.q)
        if q & (q - 1) == 0 or max(p.bit_length(), q.bit_length()) > MAX_SPLIT_BITS:
            return self.b.add("mul", self.b.const(Fraction(p, q)), number)
        return self.b.add("div", self.b.add("mul", self.b.const(p), number), self.b.const(q))

    def product(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower a product as one quotient: factors with negative exponents divide together.

        Parameters come first, so that their products are shared, then the numerical coefficient,
        then sums of parameters; without parameters the coefficient comes last.
        """
        coefficient, rest = node.as_coeff_Mul()
        factors = [f.as_base_exp() for f in sp.Mul.make_args(rest)]
        plain = [
            (f, sp.Integer(1)) if e.is_Symbol or f is sp.I else (b, e)  # I, for SymPy, is a root
            for f, (b, e) in zip(sp.Mul.make_args(rest), factors, strict=True)
        ]
        split = [(b, e) if e.is_Rational else (b**e, sp.Integer(1)) for b, e in plain]

        def build(numbers: list[int]) -> int:
            factors = [(n, e, b.is_Add) for n, (b, e) in zip(numbers, split, strict=True)]
            below = self._powers((n, -e) for n, e, _ in factors if e < 0)
            early = [(n, e, s) for n, e, s in factors if e > 0 and self.b.binding[n] <= 1]
            late = [(n, e) for n, e, _ in factors if e > 0 and self.b.binding[n] > 1]
            above = self._powers((n, e) for n, e, is_sum in early if not is_sum)
            if early:
                above = self._scaled(above, coefficient)
                above = self._powers(((n, e) for n, e, is_sum in early if is_sum), above)
                above = self._powers(late, above)
            else:
                above = self._scaled(self._powers(late), coefficient)
            return self.b.add("div", above, below)

        return [b for b, _ in split], build

    def _powers(self, factors: Iterable[tuple[int, Expr]], first: int | None = None) -> int:
        """Return the product of powers, beginning with ``first``."""
        product = self.b.const(1) if first is None else first
        for number, exponent in factors:
            product = self.b.add("mul", product, self._power(number, exponent))
        return product

    def power(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower a power: products for integers, a square root for halves, pow otherwise."""
        base, exponent = node.as_base_exp()
        if not exponent.is_Rational:
            return (base, exponent), lambda a: self.b.add("pow", *a)
        if exponent > 0:
            return (base,), lambda a: self._power(a[0], exponent)
        return (base,), lambda a: self.b.add("div", self.b.const(1), self._power(a[0], -exponent))

    def _power(self, base: int, exponent: Expr) -> int:
        """Return a positive rational power."""
        exact = Fraction(int(exponent.p), int(exponent.q))
        unrolled = fold.power(self.b, base, exact)
        return self.b.add("pow", base, self.b.const(exact)) if unrolled is None else unrolled

    def piecewise(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower to nested selections; the last condition must be true everywhere."""
        if node.args[-1].cond != sp.true:
            raise InputError(
                "Piecewise does not cover every case",
                where=self.where,
                got=node,
                hint="end it with (value, True)",
            )
        children = [e for piece in node.args for e in (piece.expr, piece.cond)]

        def build(numbers: list[int]) -> int:
            result = numbers[-2]
            for value, condition in zip(numbers[-4::-2], numbers[-3::-2], strict=True):
                result = self.b.add("select", condition, value, result)
            return result

        return children, build


_RULES: tuple[
    tuple[Any, Callable[[Lowering, Any], tuple[Sequence[Expr], Callable[[list[int]], int]]]], ...
] = (
    ((sp.Rational, sp.Float), Lowering.number),
    (sp.Add, Lowering.sum),
    (sp.Mul, Lowering.product),
    (sp.Pow, Lowering.power),
    (sp.Piecewise, Lowering.piecewise),
    (type(sp.pi), lambda s, _: ((), lambda _a: s.b.leaf("pi"))),
    (type(sp.E), lambda s, _: ((), lambda _a: s.b.add("exp", s.b.const(1)))),
    (sp.Not, lambda s, n: (n.args, lambda a: s.b.add("not", *a))),
    (sp.ITE, lambda s, n: (n.args, lambda a: s.b.add("select", *a))),
    (sp.Unequality, lambda s, n: (n.args, lambda a: s.b.add("not", s.b.add("eq", *a)))),
    (type(sp.true), lambda s, _: ((), lambda _a: s.b.const(1))),
    (type(sp.false), lambda s, _: ((), lambda _a: s.b.const(0))),
)
