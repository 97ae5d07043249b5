"""SymPy expressions to programs, with an explicit stack: no recursion, each distinct node once.

SymPy's functions as operations: one row a function, from the numbers of its arguments to its value.

Signs, ranges and values at special points are SymPy's: Mod has the sign of its divisor, acot is odd but
for acot(0) = pi/2, Heaviside(0) is 1/2 unless it is given.

Solve M x = f inside a program: blocks apart, small ones unrolled, larger ones by a factorisation.

The matrix is never inverted symbolically. States that no entry of M couples are solved apart. A small
block that is symmetric, as the mass matrices of mechanics are, becomes straight-line code, L D L^T
without exchanges, which is stable where it is positive definite; any other, and one with a zero on its
diagonal, becomes the operations of `codegen.ir.linsolve`, which exchange rows where a pivot is small.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

import sympy as sp
from sympy.codegen import cfunctions

from codegen.frontend import removable_singularities as removable
from codegen.ir import compile_progress, fold
from codegen.ir.linsolve import Shape
from codegen.ir.passes import prune
from codegen.ir.program import (
    INVARIANTS,
    OUTPUTS,
    RATES,
    SAMPLES,
    SINGULARITIES,
    Builder,
    Name,
    Program,
)
from codegen.ir.residues import vanishing
from eom.errors import InputError
from eom.limits import seldom_collected
from eom.quantities import Definition
from eom.system import System, as_expression
from eom.tables import TableFunction

Build = Callable[[Builder, Sequence[int]], int]


def _operation(op: str) -> Build:
    return lambda b, a: b.add(op, *a)


def _reciprocal(op: str) -> Build:
    return lambda b, a: b.add("div", b.const(1), b.add(op, *a))


def _of_reciprocal(op: str) -> Build:
    return lambda b, a: b.add(op, b.add("div", b.const(1), *a))


def _heaviside(b: Builder, args: Sequence[int]) -> int:
    """(1 + sign x)/2, which is NaN for NaN, but for the value at zero."""
    x, at_zero = args
    step = b.add("mul", b.const(Fraction(1, 2)), b.add("add", b.const(1), b.add("sign", x)))
    return b.add("select", b.add("eq", x, b.const(0)), at_zero, step)


def _acot(b: Builder, args: Sequence[int]) -> int:
    """atan2(s, s x) with s = -1 for negative x and 1 else: no division at zero."""
    (x,) = args
    side = b.add("select", b.add("lt", x, b.const(0)), b.const(-1), b.const(1))
    return b.add("atan2", side, b.add("mul", side, x))


def _power_of(base: int) -> Build:
    return lambda b, a: b.add("pow", b.const(base), *a)


def _logarithm(base: int) -> Build:
    return lambda b, a: b.add("div", b.add("log", *a), b.add("log", b.const(base)))


def _cube_root(b: Builder, args: Sequence[int]) -> int:
    """The real root, of the sign of its argument."""
    size = b.add("pow", b.add("abs", *args), b.const(Fraction(1, 3)))
    return b.add("mul", b.add("sign", *args), size)


FUNCTIONS: dict[Any, Build] = {
    **{
        f: _operation(op)
        for f, op in {
            sp.sin: "sin", sp.cos: "cos", sp.tan: "tan", sp.asin: "asin", sp.acos: "acos",
            sp.atan: "atan", sp.sinh: "sinh", sp.cosh: "cosh", sp.tanh: "tanh", sp.asinh: "asinh",
            sp.acosh: "acosh", sp.atanh: "atanh", sp.exp: "exp", sp.atan2: "atan2",
            sp.Abs: "abs", sp.sign: "sign", sp.floor: "floor", sp.Mod: "mod", sp.erf: "erf",
            sp.erfc: "erfc", cfunctions.expm1: "expm1", cfunctions.log1p: "log1p",
            cfunctions.hypot: "hypot", cfunctions.Sqrt: "sqrt",
        }.items()
    },
    **{
        f: _reciprocal(op)
        for f, op in {
            sp.sec: "cos", sp.csc: "sin", sp.cot: "tan",
            sp.sech: "cosh", sp.csch: "sinh", sp.coth: "tanh",
        }.items()
    },
    **{
        f: _of_reciprocal(op)
        for f, op in {
            sp.asec: "acos", sp.acsc: "asin", sp.asech: "acosh", sp.acsch: "asinh", sp.acoth: "atanh",
        }.items()
    },
    sp.acot: _acot,
    sp.Heaviside: _heaviside,
    sp.ceiling: lambda b, a: b.add("neg", b.add("floor", b.add("neg", *a))),
    sp.frac: lambda b, a: b.add("sub", *a, b.add("floor", *a)),
    cfunctions.exp2: _power_of(2),
    cfunctions.log2: _logarithm(2),
    cfunctions.log10: _logarithm(10),
    cfunctions.Cbrt: _cube_root,
    cfunctions.fma: lambda b, a: b.add("add", b.add("mul", a[0], a[1]), a[2]),
}  # fmt: skip
"""How each function is built from the numbers of its arguments, in order."""

BESSEL: dict[Any, str] = {sp.besselj: "besselj", sp.bessely: "bessely"}
"""Functions of an integer order and an argument."""


def bessel(kind: str, order: int) -> Build:
    """Return how a Bessel function of integer order is built; C_{-n} = (-1)^n C_n (DLMF 10.4.1)."""

    def build(b: Builder, args: Sequence[int]) -> int:
        value = b.add(kind, b.const(abs(order)), *args)
        return b.add("neg", value) if order < 0 and order % 2 else value

    return build


# -- the rest is refused ----------------------------------------------------------------------------------

_WORDS = {f.__name__ for f in (*FUNCTIONS, *BESSEL, sp.log, sp.Max, sp.Min)}
SUPPORTED = (
    "numbers, pi, sums, products, powers, Piecewise, conditions, sinc, eom.Table, "
    + ", ".join(sorted(_WORDS, key=lambda w: (w.lower(), w)))
    + "; besselj and bessely of integer order; everything real"
)
"""What can be lowered, for the error that refuses the rest."""

_HINTS: dict[Any, str] = {
    sp.core.function.AppliedUndef: "make it a state or an input symbol, or an eom.Table",
    sp.Derivative: "carry out the derivative with doit(), or make it a state symbol",
    sp.Integral: "carry out the integral with doit(), or make it a state whose rate is the integrand",
    sp.DiracDelta: "impulses change states between two simulations",
    sp.MatrixBase: "give one scalar expression a state",
    sp.core.numbers.ImaginaryUnit: "split the expression into its real and imaginary part",
}


def refusal(node: Any, where: str) -> InputError:
    """Return the error for an expression that no operation computes; ``where``: its place in a system."""
    return InputError(
        "no operation computes this expression",
        where=where,
        got=f"{type(node).__name__}: {node}"[:300],
        expected=SUPPORTED,
        hint=next((h for kind, h in _HINTS.items() if isinstance(node, kind)), ""),
    )


Expr = Any

MAX_SPLIT_BITS = 53
"""Larger numerators and denominators are rounded as one quotient: each alone would be rounded, too."""

FAR = 500
"""Binary exponent from which on a number is moved into the powers that it is multiplied by."""
_CHAINS: dict[Any, str] = {sp.Min: "min", sp.Max: "max", sp.And: "and", sp.Or: "or"}
_COMPARISONS: dict[Any, tuple[str, bool]] = {
    sp.StrictLessThan: ("lt", False),
    sp.StrictGreaterThan: ("lt", True),
    sp.LessThan: ("le", False),
    sp.GreaterThan: ("le", True),
    sp.Equality: ("eq", False),
}


_UNFOLDING = (sp.Function, sp.Subs, sp.UnevaluatedExpr)
"""What may stand for an expression that its ``doit`` writes out, as SymPy's curves of muscles do."""


def lowering_of(system: System, rules: fold.RuleSet = fold.ALGEBRAIC) -> Lowering:
    """Return a lowering over the slots of a system, in a builder of its own."""
    b = Builder(rules)
    slots = {system.time: b.leaf("time")}
    for op, group in (
        ("state", system.states),
        ("parameter", system.parameters),
        ("input", system.inputs),
    ):
        slots |= {q.symbol: b.leaf(op, k) for k, q in enumerate(group)}
    return Lowering(b, slots, f"system {system.name!r}", decimals=system.numbers == "decimals")


@seldom_collected()
def lower_system(system: System, rules: fold.RuleSet = fold.ALGEBRAIC) -> Program:
    """Return the program of a system, with its results in `GROUPS`.

    With a mass matrix the rates are the solution of a linear system (`codegen.frontend.lower`).
    Raises `InputError` for expressions without an operation.
    """
    lowering = lowering_of(system, rules)
    b = lowering.b
    for definition in system.definitions:
        lowering.define(definition)
    rows = [*(f"rate of {q.name}" for q in system.states)]
    rows += [f"right side of {d.name}" for d in system.multipliers]
    solved = [lowering.lower(r, row) for row, r in zip(rows, system.right_sides, strict=True)]
    if system.mass_matrix is not None:
        solved = solve(b, _lower_matrix(lowering, system.mass_matrix), solved)
    n = len(system.states)
    for definition, number in zip(system.multipliers, solved[n:], strict=True):
        lowering.stand(definition, number)
    results = {
        RATES: solved[:n],
        OUTPUTS: [lowering.result(d, "output") for d in system.outputs],
        INVARIANTS: [lowering.result(d, "invariant") for d in system.invariants],
        SINGULARITIES: [lowering.lower(s.expression, "singularity") for s in system.singularities],
    }
    if system.sampled:
        laws = [d for s in system.sampled for d in s.rows]
        results[SAMPLES] = [lowering.lower(d.expression, f"law of {d.name}") for d in laws]
    return b.program(results)


def nodes(system: System) -> int:
    """Return the number of different operations in the expressions of a system."""
    laws = (d for s in system.sampled for d in s.rows)
    named = (*system.definitions, *system.outputs, *system.invariants, *laws)
    stack = [*system.right_sides, *(d.expression for d in named), *(system.mass_matrix or ())]
    stack += [s.expression for s in system.singularities]
    seen: set[Expr] = set()
    while stack:
        node = stack.pop()
        if node.args and node not in seen:
            seen.add(node)
            stack.extend(node.args)
    return len(seen)


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
    return [
        [
            lowering.lower(mass[i, j], f"mass matrix, entry ({i + 1}, {j + 1})")
            for j in range(mass.cols)
        ]
        for i in range(mass.rows)
    ]


Exact = Fraction | int
"""An exact number, an integer where it is one: their arithmetic is faster."""

Factor = tuple[int, Exact, bool]
"""Number of a value, its exponent, and whether it was written as a sum."""


def _log2(number: Exact) -> int:
    """Return the binary exponent of a number, to one; 0 of zero."""
    return abs(number.numerator).bit_length() - number.denominator.bit_length() if number else 0


def _split(term: Expr) -> tuple[Expr, Expr]:
    """Return number and rest of a product; the sign alone where doubles may not hold the number."""
    coefficient, rest = term.as_coeff_Mul()
    if coefficient.is_Rational and abs(_log2(_exact(coefficient))) >= FAR:
        return sp.sign(coefficient), abs(coefficient) * rest
    return coefficient, rest


def _exact(coefficient: Expr) -> Exact:
    """Return a coefficient exactly."""
    if coefficient.is_Integer:
        return int(coefficient.p)
    exact = coefficient if coefficient.is_Rational else sp.Rational(coefficient)
    return _ratio(int(exact.p), int(exact.q))


@lru_cache(maxsize=4096)
def _ratio(p: int, q: int) -> Exact:
    return p if q == 1 else Fraction(p, q)


class Lowering:
    """Lower expressions over symbols that have numbers; a memo keeps each node's number.

    ``decimals``: whether fractions with an end are numbers that were given as decimals, and no quotients.
    """

    def __init__(
        self, b: Builder, slots: Mapping[Expr, int], system: str = "", *, decimals: bool = False
    ) -> None:
        self.b, self.decimals = b, decimals
        self.memo: dict[Expr, int] = dict(slots)
        self.system = self.where = system

    def define(self, definition: Definition) -> None:
        """Lower a definition; its symbol stands for the value from here on."""
        self.memo[definition.symbol] = self.result(definition, "definition")

    def stand(self, definition: Definition, number: int) -> None:
        """Let the symbol of a definition stand for a value that was computed otherwise."""
        self.b.name(number, _name(definition))
        self.memo[definition.symbol] = number

    def result(self, definition: Definition, kind: str) -> int:
        """Lower a named expression; its value has that name."""
        number = self.lower(definition.expression, f"{kind} {definition.name}")
        self.b.name(number, _name(definition))
        return number

    def lower(self, expression: Expr, part: str = "") -> int:
        """Return the number of the value of ``expression``; ``part`` names it in errors."""
        self.where = ": ".join(filter(None, (self.system, part)))
        terms = self._terms(expression) if type(expression) is sp.Add else None
        if terms:  # made again it has the same number: its hash would take longer
            compile_progress.done(1)
            return self._sum_of(terms)
        stack = [expression]
        memo = self.memo
        while stack:
            node = stack[-1]
            if node in memo:
                stack.pop()
                continue
            children, build = self._rule(node)
            missing = [c for c in children if c not in memo] if children else ()
            if missing:
                stack.extend(reversed(missing))
                continue
            memo[node] = build([memo[c] for c in children] if children else [])
            stack.pop()
            compile_progress.done(1)
        return memo[expression]

    def _rule(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Return the children of a node and how to build its value from theirs."""
        kind = type(node)
        if kind in _ARITHMETIC:
            return _ARITHMETIC[kind](self, node)
        if kind in FUNCTIONS:
            return node.args, lambda a: FUNCTIONS[kind](self.b, a)
        if kind in _CHAINS:
            return self._sorted(node.args), lambda a: self._chain(_CHAINS[kind], a)
        if kind in _COMPARISONS:
            op, swap = _COMPARISONS[kind]
            return node.args, lambda a: self.b.add(op, *(a[::-1] if swap else a))
        for test, rule in _RULES:
            if isinstance(node, test):
                return rule(self, node)
        if isinstance(node, _UNFOLDING) and (unfolded := node.doit(deep=False)) != node:
            return (unfolded,), lambda a: a[0]
        raise refusal(node, self.where)

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
        simple = self._terms(node)
        if simple:
            return (), lambda _: self._sum_of(simple)
        found = removable.difference(node)
        if found and found.name == "expm1":
            return (found.x,), lambda a: self._scaled(self.b.add("expm1", *a), _exact(found.factor))
        terms = [(_exact(c), rest) for c, rest in map(_split, node.args)]
        terms.sort(key=lambda term: term[0].numerator < 0)  # SymPy would deduce all facts
        return [rest for _, rest in terms], lambda a: self._added([c for c, _ in terms], a)

    def _terms(self, node: Expr) -> list[tuple[Exact, list[Factor]]] | None:
        """Return the terms of a sum of such products, those below zero last, else None."""
        found = []
        for term in node.args:
            simple = self._simple(term)
            if simple is None:
                return None
            found.append(simple)
        return sorted(found, key=lambda term: term[0].numerator < 0)

    def _sum_of(self, terms: Sequence[tuple[Exact, list[Factor]]]) -> int:
        factors = [f[0][0] if len(f) == 1 else self._multiplied(1, f) for _, f in terms]
        return self._added([c for c, _ in terms], factors)

    def _simple(self, node: Expr) -> tuple[Exact, list[Factor]] | None:
        """Return coefficient and factors of a product of symbols that have numbers, else None."""
        coefficient: Exact = 1
        factors: Sequence[Expr] = (node,)
        if node.is_Mul:
            factors = node.args
            if factors[0].is_Rational:
                coefficient = _exact(factors[0])
                factors = factors[1:]
        found: list[Factor] = []
        for factor in factors:
            number = self.memo.get(factor) if factor.is_Symbol else None
            if number is None:
                return None
            found.append((number, 1, False))
        return coefficient, found

    def _added(self, coefficients: Sequence[Exact], numbers: Sequence[int]) -> int:
        """Return the sum of coefficients times values, those below zero last."""
        negative = [c.numerator < 0 for c in coefficients]
        sizes = [-c if below else c for c, below in zip(coefficients, negative, strict=True)]
        shared = sizes[0]
        if shared != 1 and all(size == shared for size in sizes):
            sizes = [1] * len(sizes)
        else:
            shared = 1
        opposite = negative[0]
        total = self._scaled(numbers[0], sizes[0])
        for number, size, below in zip(numbers[1:], sizes[1:], negative[1:], strict=True):
            term = self._scaled(number, size)
            total = self.b.add("add" if below is opposite else "sub", total, term)
        return self._scaled(total, -shared if opposite else shared)

    def _scaled(self, number: int, coefficient: Exact) -> int:
        """Multiply by an exact number; a denominator other than a power of two divides, but of decimals."""
        p, q = coefficient.as_integer_ratio()
        if p == q:
            return number
        whole = q & (q - 1) == 0 or (self.decimals and 10**MAX_SPLIT_BITS % q == 0)
        if whole or max(p.bit_length(), q.bit_length()) > MAX_SPLIT_BITS:
            return self.b.add("mul", self.b.const(coefficient), number)
        return self.b.add("div", self.b.add("mul", self.b.const(p), number), self.b.const(q))

    def product(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower a product as one quotient: factors with negative exponents divide together.

        Quotients such as sin(x)/x become functions of their own before.
        """
        simple = self._simple(node)
        if simple:
            return (), lambda _: self._multiplied(*simple)
        regular = removable.rewrite(node)
        if regular is not node:
            return (regular,), lambda a: a[0]
        coefficient, rest = node.as_coeff_Mul()
        factors = [f.as_base_exp() for f in sp.Mul.make_args(rest)]
        plain = [
            (f, sp.Integer(1)) if e.is_Symbol or f is sp.I else (b, e)  # I, for SymPy, is a root
            for f, (b, e) in zip(sp.Mul.make_args(rest), factors, strict=True)
        ]
        split = [removable.norm(b, e) if e.is_Rational else (b**e, sp.Integer(1)) for b, e in plain]
        exponents = [Fraction(int(e.p), int(e.q)) for _, e in split]
        is_sum = [b.is_Add for b, _ in split]
        return [b for b, _ in split], lambda numbers: self._multiplied(
            _exact(coefficient), list(zip(numbers, exponents, is_sum, strict=True))
        )

    def _multiplied(self, coefficient: Exact, factors: Sequence[Factor]) -> int:
        """Return a number times the product of powers.

        Parameters come first, so that their products are shared, then the numerical coefficient,
        then sums of parameters; without parameters the coefficient comes last.
        """
        coefficient, factors = self._within_range(coefficient, factors)
        one, binding = self.b.const(1), self.b.binding
        groups: tuple[list[tuple[int, Exact]], ...] = ([], [], [], [])
        for n, e, is_sum in factors:
            if e:
                place = 0 if e < 0 else 3 if binding[n] > 1 else 2 if is_sum else 1
                groups[place].append((n, -e if e < 0 else e))
        under, early, sums, late = groups
        below = self._powers(under, one)
        if early or sums:
            above = self._scaled(self._powers(early, one), coefficient)
            above = self._powers(late, self._powers(sums, above))
        else:
            above = self._scaled(self._powers(late, one), coefficient)
        return above if below == one else self.b.add("div", above, below)

    def _within_range(
        self, coefficient: Exact, factors: Sequence[Factor]
    ) -> tuple[Exact, Sequence[Factor]]:
        """Return the same product with a number that doubles may not hold moved into the base of a power.

        As a power of two, so that nothing is rounded: x^401/7^401 is (8/7)^401 (x/8)^401.
        """
        far = _log2(coefficient)
        if abs(far) < FAR:
            return coefficient, factors
        sizes = [abs(int(e)) if e.denominator == 1 else 0 for _, e, _ in factors]
        highest = max(sizes, default=0)
        if highest < 2:
            return coefficient, factors
        place = sizes.index(highest)
        base, exponent, is_sum = factors[place]
        shift = Fraction(2) ** round(far / int(exponent))
        scaled = self.b.add("mul", base, self.b.const(shift))
        others = [f for k, f in enumerate(factors) if k != place]
        rest = Fraction(coefficient) / shift ** int(exponent)
        return rest, [*others, (scaled, exponent, is_sum)]

    def _powers(self, factors: Sequence[tuple[int, Exact]], product: int) -> int:
        """Return the product of powers, beginning with ``product``."""
        one = self.b.const(1) if factors else product
        for number, exponent in factors:
            power = self._power(number, exponent)
            product = power if product == one else self.b.add("mul", product, power)
        return product

    def power(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower a power: products for integers, a square root for halves, pow otherwise."""
        base, exponent = removable.norm(*node.as_base_exp())
        if not exponent.is_Rational:
            return (base, exponent), lambda a: self.b.add("pow", *a)
        exact = Fraction(int(exponent.p), int(exponent.q))
        if exact > 0:
            return (base,), lambda a: self._power(a[0], exact)
        return (base,), lambda a: self.b.add("div", self.b.const(1), self._power(a[0], -exact))

    def _power(self, base: int, exact: Exact) -> int:
        """Return a positive rational power."""
        if exact == 1:
            return base
        unrolled = fold.power(self.b, base, Fraction(exact))
        return self.b.add("pow", base, self.b.const(exact)) if unrolled is None else unrolled

    def logarithm(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower log(1 + x) without the sum, which would round x away."""
        rest = removable.after_one(node.args[0])
        op = "log" if rest is None else "log1p"
        return (node.args[0] if rest is None else rest,), lambda a: self.b.add(op, *a)

    def bessel(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower a Bessel function of integer order."""
        order, argument = node.args
        if not order.is_Integer:
            raise refusal(node, self.where)
        return (argument,), lambda a: bessel(BESSEL[type(node)], int(order))(self.b, a)

    def table(self, node: Any) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower the value of a table; one that was differentiated too often is zero."""
        table = node.table
        if table.degree < 0:
            return (), lambda _: self.b.const(0)
        return (node.args[1],), lambda a: self.b.add("table", *a, value=table)

    def piecewise(self, node: Expr) -> tuple[Sequence[Expr], Callable[[list[int]], int]]:
        """Lower to nested selections; the last condition must be true everywhere."""
        if node.args[-1].cond != sp.true:
            raise InputError("Piecewise does not cover every case", where=self.where, got=node,
                             hint="end it with (value, True)")  # fmt: skip
        children = [e for piece in node.args for e in (piece.expr, piece.cond)]

        def build(numbers: list[int]) -> int:
            result = numbers[-2]
            for value, condition in zip(numbers[-4::-2], numbers[-3::-2], strict=True):
                result = self.b.add("select", condition, value, result)
            return result

        return children, build


_ARITHMETIC: Mapping[
    Any, Callable[[Lowering, Any], tuple[Sequence[Expr], Callable[[list[int]], int]]]
] = {sp.Add: Lowering.sum, sp.Mul: Lowering.product}
"""What most nodes are, looked for first."""
_RULES: tuple[
    tuple[Any, Callable[[Lowering, Any], tuple[Sequence[Expr], Callable[[list[int]], int]]]], ...
] = (
    ((sp.Rational, sp.Float), Lowering.number),
    (sp.Add, Lowering.sum),
    (sp.Mul, Lowering.product),
    (sp.Pow, Lowering.power),
    (sp.Piecewise, Lowering.piecewise),
    (sp.log, Lowering.logarithm),
    (tuple(BESSEL), Lowering.bessel),
    (TableFunction, Lowering.table),
    (removable.Removable, lambda s, n: ((n.operand,), lambda a: n.build(s.b, *a))),
    (sp.sinc, lambda s, n: ((removable.sinc(n.args[0]),), lambda a: a[0])),
    (type(sp.pi), lambda s, _: ((), lambda _a: s.b.leaf("pi"))),
    (type(sp.E), lambda s, _: ((), lambda _a: s.b.add("exp", s.b.const(1)))),
    (sp.Not, lambda s, n: (n.args, lambda a: s.b.add("not", *a))),
    (sp.ITE, lambda s, n: (n.args, lambda a: s.b.add("select", *a))),
    (sp.Unequality, lambda s, n: (n.args, lambda a: s.b.add("not", s.b.add("eq", *a)))),
    (type(sp.true), lambda s, _: ((), lambda _a: s.b.const(1))),
    (type(sp.false), lambda s, _: ((), lambda _a: s.b.const(0))),
)


UNROLLED = 8
"""Largest block that becomes straight-line code."""

SINGULAR = Fraction(1, 2**50)
"""A pivot of straight-line code that is smaller, relative to its diagonal entry, has no right digit."""

Matrix = Sequence[Sequence[int]]


def solve(b: Builder, matrix: Matrix, right: Sequence[int]) -> list[int]:
    """Append the solution; ``matrix`` and ``right`` hold numbers of values.

    Law: matrix times solution is the right-hand side. Where straight-line code meets a matrix that is
    singular, or all but singular, to double precision, the solution is NaN.
    """
    x = list(right)
    for block in _blocks(b, matrix):
        part = [[matrix[i][j] for j in block] for i in block]
        loads = [right[i] for i in block]
        for i, number in zip(block, _solve_block(b, part, loads), strict=True):
            x[i] = number
    return x


def _blocks(b: Builder, matrix: Matrix) -> Iterator[list[int]]:
    """Yield the sets of rows that entries which are not zero connect."""
    n = len(matrix)
    left = dict.fromkeys(range(n))
    while left:
        block, stack = [], [next(iter(left))]
        del left[stack[0]]
        while stack:
            i = stack.pop()
            block.append(i)
            linked = [j for j in left if _is_entry(b, matrix[i][j]) or _is_entry(b, matrix[j][i])]
            for j in linked:
                del left[j]
            stack += linked
        yield sorted(block)


def _is_entry(b: Builder, number: int) -> bool:
    instruction = b.instructions[number]
    return instruction.op != "const" or instruction.value != 0


def _solve_block(b: Builder, matrix: Matrix, right: Sequence[int]) -> list[int]:
    n = len(right)
    symmetric = _symmetric(b, matrix)
    full = all(_is_entry(b, matrix[i][i]) for i in range(n))
    if n == 1 or (n <= UNROLLED and symmetric and full):
        return _unrolled(b, matrix, right)
    shape = Shape(n, symmetric)
    factor = b.add("factor", *(matrix[i][j] for i, j in shape.places), value=shape)
    solution = b.add("back", factor, *right)
    return [b.add("item", solution, value=k) for k in range(n)]


def _symmetric(b: Builder, matrix: Matrix) -> bool:
    """Return whether a matrix is proved to be symmetric, modulo a prime (`codegen.ir.residues`)."""
    n = len(matrix)
    pairs = [(matrix[i][j], matrix[j][i]) for i in range(n) for j in range(i)]
    pairs = [(one, other) for one, other in pairs if one != other]
    if not pairs:
        return True
    program = prune(b.program({"one": [p[0] for p in pairs], "other": [p[1] for p in pairs]}))
    return all(vanishing(program, "one", "other"))


def _unrolled(b: Builder, matrix: Matrix, right: Sequence[int]) -> list[int]:
    """Append the solution of a symmetric system, by L D L^T without square roots or exchanges.

    Golub and Van Loan, Matrix Computations, 4th ed., algorithm 4.1.2, rows in an order that fills in
    little. Zeros are folded away.
    """
    order = _order(b, matrix)
    a = [[matrix[i][j] for j in order] for i in order]
    n = len(order)
    lower = [[b.const(0)] * n for _ in range(n)]
    pivots: list[int] = []
    for j in range(n):
        scaled = [b.add("mul", lower[j][k], pivots[k]) for k in range(j)]
        for i in range(j, n):
            entry = a[i][j]
            for k in range(j):
                entry = b.add("sub", entry, b.add("mul", lower[i][k], scaled[k]))
            if i == j:
                pivots.append(_guarded(b, entry, a[j][j]))
            else:
                lower[i][j] = b.add("div", entry, pivots[j])
    x = [right[i] for i in order]
    for i in range(n):
        for k in range(i):
            x[i] = b.add("sub", x[i], b.add("mul", lower[i][k], x[k]))
    x = [b.add("div", xi, d) for xi, d in zip(x, pivots, strict=True)]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] = b.add("sub", x[i], b.add("mul", lower[k][i], x[k]))
    return [x[order.index(i)] for i in range(n)]


def _guarded(b: Builder, pivot: int, diagonal: int) -> int:
    """Return the pivot, NaN where it has no right digit; one that is the entry itself needs no test."""
    if pivot == diagonal:
        return pivot
    least = b.add("mul", b.const(SINGULAR), b.add("abs", diagonal))
    large = b.add("lt", least, b.add("abs", pivot))
    return b.add("select", large, pivot, b.add("div", b.const(0), b.const(0)))


def _order(b: Builder, matrix: Matrix) -> list[int]:
    """Return the rows in the order of least degree (Tinney and Walker, 1967), ties by number."""
    n = len(matrix)
    near: dict[int, set[int]] = {i: set() for i in range(n)}
    for i in range(n):
        for j in range(n):
            if i != j and _is_entry(b, matrix[i][j]):
                near[i].add(j)
                near[j].add(i)
    order: list[int] = []
    while near:
        i = min(near, key=lambda k: (len(near[k]), k))
        order.append(i)
        linked = near.pop(i)
        for j in linked:
            near[j] = (near[j] | linked) - {i, j}
    return order
