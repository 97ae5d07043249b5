"""Taylor coefficients of programs: one recurrence a primitive operation, as data.

The normalised coefficient of order k of a value v is v_k = v^(k) / k!. Each row of `RULES` says how
it follows from those of the arguments and from lower ones of the value (Jorba and Zou, A software
package for the numerical integration of ODEs by means of high-order Taylor methods, Experimental
Mathematics 14 (2005), sect. 2; Griewank and Walther, Evaluating Derivatives, 2nd ed. (2008), table
13.2). Some rules need a further value, their partner: the cosine for a sine, 1 + v^2 for a tangent.

Rules are written over an `Order`, which gives coefficients and sums of products of them;
the rules as instructions make a program of all orders, `codegen.loops.jets` a loop.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from codegen.frontend.layout import Layout, excerpt
from codegen.ir.fold import constant
from codegen.ir.linsolve import Shape, whole
from codegen.ir.ops import OPS, TRUTH_VALUES, Instruction
from codegen.ir.passes import prune
from codegen.ir.program import Builder, Program, switches
from codegen.ir.scalars import Scalar
from eom.errors import InputError

JET = "jet"
"""Group of results of an unrolled program: x_1 of each state, then x_2, and so on."""

SWITCHES = "switches"
"""Group of results likewise: coefficients of switching functions, of order 0 of each, then of order 1."""

Series = int
"""A value as the number of its instruction; its coefficients are found by it."""
Term = Any
"""One coefficient: numbers of a program that is built, or text; both have operators."""


class Order(ABC):
    """Coefficients of lower orders, and sums over them, for the order that is made."""

    prepared: Prepared

    def moves(self, a: Series) -> bool:
        """Return whether a value has coefficients beyond order 0."""
        return self.prepared.varies[a]

    @abstractmethod
    def now(self, a: Series) -> Term:
        """Return a_k."""

    @abstractmethod
    def first(self, a: Series) -> Term:
        """Return a_0."""

    @abstractmethod
    def inverse(self, a: Series) -> Term:
        """Return 1 / a_0, which all orders share."""

    @abstractmethod
    def dot(self, a: Series, b: Series, low: int = 0, high: int = 0) -> Term:
        """Return the sum of a_j b_(k-j) over j from ``low`` to k - ``high``."""

    @abstractmethod
    def moment(self, a: Series, b: Series, high: int = 0) -> Term:
        """Return the sum of (j/k) a_j b_(k-j) over j from 1 to k - ``high``."""

    @abstractmethod
    def choose(self, negative: Term, a: Term, b: Term) -> Term:
        """Return ``a`` where a value of order 0 is less than zero, and ``b`` elsewhere."""


Partner = Callable[[Builder, int, Sequence[int]], int]
Coefficient = Callable[[Order, Series, Sequence[Series], Series], Term]


@dataclass(frozen=True)
class Rule:
    """``coefficient(order, value, arguments, partner)`` is v_k for k > 0; ``partner`` builds that."""

    coefficient: Coefficient
    partner: Partner | None = None


def _integral(partner: Partner, sign: int = 1) -> Rule:
    """V' = sign w a' with the partner w."""
    return Rule(lambda o, v, a, w: o.moment(a[0], w) if sign > 0 else -o.moment(a[0], w), partner)


def _quotient(partner: Partner, sign: int = 1) -> Rule:
    """V' w = sign a' with the partner w."""

    def coefficient(o: Order, v: Series, a: Sequence[Series], w: Series) -> Term:
        slope = o.now(a[0]) if sign > 0 else -o.now(a[0])
        return (slope - o.moment(v, w, high=1)) * o.inverse(w)

    return Rule(coefficient, partner)


def _branch(condition: Callable[[Order, Sequence[Series]], Term], first: int, other: int) -> Rule:
    """The coefficient of the argument that the values of order 0 choose."""
    return Rule(lambda o, v, a, w: o.choose(condition(o, a), o.now(a[first]), o.now(a[other])))


def _square(b: Builder, a: int) -> int:
    return b.add("mul", a, a)


def _less(b: Builder, x: int) -> int:
    """1 - x."""
    return b.add("sub", b.const(1), x)


def _more(b: Builder, x: int) -> int:
    """1 + x."""
    return b.add("add", b.const(1), x)


def _sum_of_squares(b: Builder, a: Sequence[int]) -> int:
    return b.add("add", _square(b, a[0]), _square(b, a[1]))


def _gauss(b: Builder, _: int, a: Sequence[int]) -> int:
    """2 exp(-a^2) / sqrt(pi)."""
    scale = b.add("div", b.const(2), b.add("sqrt", b.leaf("pi")))
    return b.add("mul", scale, b.add("exp", b.add("neg", _square(b, a[0]))))


def _root_of_less(b: Builder, _: int, a: Sequence[int]) -> int:
    """sqrt(1 - a^2), without loss near one."""
    return b.add("sqrt", b.add("mul", _less(b, a[0]), _more(b, a[0])))


def _power(o: Order, v: Series, a: Sequence[Series], w: Series) -> Term:
    """V' a = y v a' for a constant exponent y; the partner is y log(a), and v' = v w', if y changes.

    The partner of a whole power is that of products, which has a series at zero, too.
    """
    if o.moves(a[1]):
        return o.moment(w, v)
    if w != v:
        return o.now(w)
    total = o.first(a[1]) * o.moment(a[0], v) - o.moment(v, a[0], high=1)
    return total * o.inverse(a[0])


def _atan2(o: Order, v: Series, a: Sequence[Series], w: Series) -> Term:
    """V' (x^2 + y^2) = y' x - x' y."""
    y, x = a
    return (o.moment(y, x) - o.moment(x, y) - o.moment(v, w, high=1)) * o.inverse(w)


def _root(o: Order, v: Series, squared: Term) -> Term:
    return (squared - o.dot(v, v, 1, 1)) * (o.inverse(v) * Fraction(1, 2))


RULES: Mapping[str, Rule] = {
    "add": Rule(lambda o, v, a, w: o.now(a[0]) + o.now(a[1])),
    "sub": Rule(lambda o, v, a, w: o.now(a[0]) - o.now(a[1])),
    "neg": Rule(lambda o, v, a, w: -o.now(a[0])),
    "mul": Rule(lambda o, v, a, w: o.dot(a[0], a[1])),
    "div": Rule(lambda o, v, a, w: (o.now(a[0]) - o.dot(a[1], v, low=1)) * o.inverse(a[1])),
    "sqrt": Rule(lambda o, v, a, w: _root(o, v, o.now(a[0]))),
    "hypot": Rule(lambda o, v, a, w: _root(o, v, o.now(w))),
    "pow": Rule(_power),
    "exp": _integral(lambda b, v, a: v),
    "expm1": _integral(lambda b, v, a: b.add("exp", a[0])),
    "sin": _integral(lambda b, v, a: b.add("cos", a[0])),
    "cos": _integral(lambda b, v, a: b.add("sin", a[0]), -1),
    "tan": _integral(lambda b, v, a: _more(b, _square(b, v))),
    "sinh": _integral(lambda b, v, a: b.add("cosh", a[0])),
    "cosh": _integral(lambda b, v, a: b.add("sinh", a[0])),
    "tanh": _integral(lambda b, v, a: _less(b, _square(b, v))),
    "erf": _integral(_gauss),
    "erfc": _integral(_gauss, -1),
    "log": _quotient(lambda b, v, a: a[0]),
    "log1p": _quotient(lambda b, v, a: _more(b, a[0])),
    "asin": _quotient(_root_of_less),
    "acos": _quotient(_root_of_less, -1),
    "atan": _quotient(lambda b, v, a: _more(b, _square(b, a[0]))),
    "asinh": _quotient(lambda b, v, a: b.add("sqrt", _more(b, _square(b, a[0])))),
    "acosh": _quotient(
        lambda b, v, a: b.add("sqrt", b.add("mul", b.add("sub", a[0], b.const(1)), _more(b, a[0])))
    ),
    "atanh": _quotient(lambda b, v, a: b.add("mul", _less(b, a[0]), _more(b, a[0]))),
    "atan2": Rule(_atan2, lambda b, v, a: _sum_of_squares(b, a)),
    "abs": Rule(lambda o, v, a, w: o.choose(o.first(a[0]), -o.now(a[0]), o.now(a[0]))),
    "min": _branch(lambda o, a: o.first(a[0]) - o.first(a[1]), 0, 1),
    "max": _branch(lambda o, a: o.first(a[0]) - o.first(a[1]), 1, 0),
    "select": _branch(lambda o, a: Fraction(1, 2) - o.first(a[0]), 1, 2),
}
"""A condition is 0 or 1: it is true where one half less it is negative."""

STEPS = frozenset({*TRUTH_VALUES, "sign"})
"""Operations whose value stays where it is while no branch changes."""
BRANCHES = frozenset({"abs", "min", "max", "select", "sign"})
"""Operations after which a solution may have a kink."""
_STILL = frozenset({"const", "pi", "parameter", "constant", "input"})
"""Leaves that do not change with time."""
_SOLVE = frozenset({"factor", "back", "item"})


@dataclass(frozen=True)
class Prepared:
    """A program of the rates with all partners of its rules: what `unrolled` and loops start from.

    ``varies``: whether a value has coefficients other than that of order 0. ``partners``: of each
    value that has one. ``items``: by the number of a ``back`` those of its entries. ``switches``:
    the switching functions, values by whose signs branches choose.
    """

    program: Program
    varies: tuple[bool, ...]
    partners: Mapping[int, int] = field(default_factory=dict)
    items: Mapping[int, tuple[int, ...]] = field(default_factory=dict)
    switches: tuple[int, ...] = ()

    def partner(self, k: int) -> int:
        """Return the partner of a value, the value itself if there is none."""
        return self.partners.get(k, k)

    @property
    def has_branches(self) -> bool:
        """Whether the solution may have kinks."""
        pairs = zip(self.program.instructions, self.varies, strict=True)
        return any(i.op in BRANCHES and (v or i.op == "sign") for i, v in pairs)


def prepare(program: Program, group: str, layout: Layout | None = None) -> Prepared:
    """Return one group of results with the partners that its rules need; values do not change.

    Raises `InputError` for a value that changes with time and has no rule; ``layout`` names it.
    """
    program = prune(program, [group])
    b = Builder(program.rules)
    new: list[int] = []
    varies: list[bool] = []
    partners: dict[int, int] = {}
    for k, instruction in enumerate(program.instructions):
        before = _early_partner(b, instruction, new, varies)
        new.append(b.again(instruction, new))
        _extend(varies, b.instructions)
        if before is not None:
            partners[new[k]] = before
        if k in program.names:
            b.name(new[k], program.names[k])
        refused = instruction.op in OPS and instruction.op not in {*RULES, *STEPS, *_SOLVE}
        if refused and any(varies[new[a]] for a in instruction.args):
            raise _refusal(program, layout, group, k)
    items = {k: _entries(b, k) for k, i in enumerate(b.instructions) if i.op == "back"}
    _extend(varies, b.instructions)
    found = switches(b, varies)
    done = 0
    while done < len(b.instructions):
        _extend(varies, b.instructions)
        op, args, _ = b.instructions[done]
        build = RULES[op].partner if op in RULES and varies[done] else None
        if build and done not in partners:
            partners[done] = build(b, done, args)
        done += 1
    results = {group: [new[k] for k in program.results[group]]}
    moving = tuple(k for k in found if varies[k])
    return Prepared(b.program(results), tuple(varies), partners, items, moving)


def _entries(b: Builder, back: int) -> tuple[int, ...]:
    size = len(b.instructions[back].args) - 1
    return tuple(b.add("item", back, value=k) for k in range(size))


def _early_partner(
    b: Builder, instruction: Instruction, new: Sequence[int], varies: list[bool]
) -> int | None:
    """Return the partner of a norm or a power, whose own order k is needed: it comes before them."""
    args = [new[a] for a in instruction.args]
    exponent = constant(b, args[1]) if instruction.op == "pow" else None
    partner = None
    if instruction.op == "hypot" and any(varies[a] for a in args):
        partner = _sum_of_squares(b, args)
    elif instruction.op == "pow" and varies[args[1]]:
        partner = b.add("mul", args[1], b.add("log", args[0]))
    elif exponent is not None and exponent.denominator == 1 and exponent > 1 and varies[args[0]]:
        partner = _whole_power(b, args[0], int(exponent))
    _extend(varies, b.instructions)
    return partner


def _whole_power(b: Builder, base: int, exponent: int) -> int:
    """Return a power as products, by squares: about twice the logarithm of the exponent."""
    power = base
    for digit in bin(exponent)[3:]:
        power = b.add("mul", power, power)
        if digit == "1":
            power = b.add("mul", power, base)
    return power


def _extend(varies: list[bool], instructions: Sequence[Instruction]) -> None:
    """Return of all instructions whether they have coefficients beyond order 0."""
    for op, args, _ in instructions[len(varies) :]:
        moving = op not in _STILL if op not in OPS else any(varies[a] for a in args)
        varies.append(moving and op not in STEPS)


def _refusal(program: Program, layout: Layout | None, group: str, k: int) -> InputError:
    op = program.instructions[k].op
    names = layout or Layout("", "", (), (), (), {})
    return InputError(
        f"there is no Taylor series of {op}",
        where=f"method taylor, system {names.name!r}, {group}",
        got=excerpt(program, layout, k) if layout else op,
        expected="smooth functions, or values that do not change with time",
        hint="choose the method DOP853",
    )


def residuals(o: Order, prepared: Prepared, back: int) -> list[Term]:
    """Return f_k less the sum of A_j x_(k-j) over j > 0, for each row of a linear system."""
    instructions = prepared.program.instructions
    _, (factor, *right), _ = instructions[back]
    shape = instructions[factor].value
    assert isinstance(shape, Shape)
    rows = whole(shape, instructions[factor].args)
    items = prepared.items[back]
    found = []
    for i, f in enumerate(right):
        rest = o.now(f)
        for a, x in zip(rows[i], items, strict=True):
            if prepared.varies[a]:
                rest = rest - o.dot(a, x, low=1)
        found.append(rest)
    return found


_FEW = frozenset({"add", "sub", "neg", "abs", "min", "max", "select", "item"})
"""Operations of which each coefficient is one operation, whatever the order."""


def operations(prepared: Prepared, order: int) -> int:
    """Return about how many operations all coefficients up to an order take."""
    pairs = zip(prepared.program.instructions, prepared.varies, strict=True)
    total = 0
    for (op, args, _), varies in pairs:
        if op in OPS and varies:
            is_product = op not in _FEW and sum(prepared.varies[a] for a in args) > (op == "mul")
            total += order * order * max(1, len(args) - 1) if is_product else order
    return total


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
