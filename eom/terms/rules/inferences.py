"""Inferences: from one or more equations to one that follows from them.

Where a rule rewrites one side, an inference concludes from whole equations: what is solved for,
what is cancelled, what holds for every vector, what a general statement says of a special case.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eom.errors import InputError
from eom.exact.identity import vanishes
from eom.terms.rules.basic import apply
from eom.terms.rules.calculus import combine, distribute
from eom.terms.rules.tracing import Rule
from eom.terms.terms import (
    Equation,
    Term,
    add,
    dot,
    expr,
    mul,
    nodes,
    number,
    relabel,
    replace,
    zero,
)
from eom.terms.vocabulary import unit


@dataclass(frozen=True)
class Inference:
    """A way to conclude: its name in ``words``, and ``conclude`` from equations to one."""

    words: str
    conclude: Callable[..., Equation]


def _refused(words: str, why: str) -> InputError:
    return InputError(f"{words} does not apply", got=why)


# -- one equation ----------------------------------------------------------------------------


def solved(unknown: Term, *applied: Rule) -> Inference:
    """Return the inference that solves an equation, linear in ``unknown``, for it; tidied by rules."""
    words = "solving"

    def conclude(equation: Equation) -> Equation:
        if unknown.head == "expr" and equation.left.head == equation.right.head == "expr":
            return _solved_plainly(equation, unknown, applied)
        parts = combine(distribute(equation.left - equation.right))
        factors, rest = [], []
        for part in parts.args if parts.head == "add" else (parts,):
            factor = _factor_of(part, unknown)
            rest.append(part) if factor is None else factors.append(factor)
        if len(factors) != 1:
            raise _refused(words, "it is not linear in what is sought")
        found = distribute(mul(expr(-1 / factors[0]), add(zero(unknown.kind), *rest)))
        return Equation(unknown, apply(applied, found))

    return Inference(words, conclude)


def _solved_plainly(equation: Equation, unknown: Term, applied: Sequence[Rule]) -> Equation:
    symbol = unknown.data[0]
    balance = sp.expand(equation.left.data[0] - equation.right.data[0])
    slope = balance.diff(symbol)
    if slope == 0 or slope.has(symbol):
        raise _refused("solving", "it is not linear in what is sought")
    found = expr(sp.factor_terms(-balance.xreplace({symbol: 0}) / slope))
    return Equation(unknown, apply(applied, found))


def _factor_of(part: Term, unknown: Term) -> Any:
    """Return the SymPy factor at which ``unknown`` stands, None where it does not stand alone."""
    if part == unknown:
        return sp.Integer(1)
    if part.head == "mul" and part.args[0].head == "expr" and mul(*part.args[1:]) == unknown:
        return part.args[0].data[0]
    return None


def entry(place: int, *applied: Rule) -> Inference:
    """Return the inference that takes one entry, counted from one, of explicit columns or matrices.

    ``applied``: rules that tidy both sides.
    """

    def conclude(equation: Equation) -> Equation:
        left, right = (_entries(s)[place - 1] for s in (equation.left, equation.right))
        return Equation(apply(applied, left), apply(applied, right))

    return Inference("one row", conclude)


def _entries(term: Term) -> tuple[Term, ...]:
    if term.head == "zero":
        return (number(0),) * (9 if term.kind == "matrix" else 3)
    if term.head != "entries":
        raise _refused("one row", f"{term.head} has no explicit entries")
    return term.args


def cancelled(anything: Term) -> Inference:
    """Return the inference from A x v = B x v to A = B, where ``anything`` v is any vector.

    So for dots, and for matrices times its column.
    """
    words = "cancelling"
    bare = anything.args[0] if anything.head == "column" else anything

    def conclude(equation: Equation) -> Equation:
        left, right = equation.left, equation.right
        behind = [s.args[1] if len(s.args) == 2 else None for s in (left, right)]
        if left.head != right.head or behind != [anything, anything]:
            raise _refused(words, "the sides do not end in the same product with it")
        first, second = left.args[0], right.args[0]
        if bare.data[0] != "vector" or any(bare in nodes(o) for o in (first, second)):
            raise _refused(words, "what stands there is not any vector")
        return Equation(first, second)

    return Inference(words, conclude)


_ANY = frozenset({"vector", "dyadic", "scalar"})
"""Quantities that stand for any of their kind."""


def instance(meanings: Mapping[Term, Term], words: str = "specialisation") -> Inference:
    """Return the inference that puts a special one for any vector, dyadic or number."""

    def conclude(equation: Equation) -> Equation:
        for old in meanings:
            if old.head != "atom" or old.data[0] not in _ANY:
                raise _refused(words, "only what stands for anything can be replaced")
        left, right = (
            replace(s, lambda n: meanings.get(n, n)) for s in (equation.left, equation.right)
        )
        return Equation(left, right)

    return Inference(words, conclude)


def renamed(labels: Mapping[str, str], *applied: Rule, words: str = "specialisation") -> Inference:
    """Return the inference from any point or frame to a special one, by its label; tidied by rules."""

    def conclude(equation: Equation) -> Equation:
        left, right = (apply(applied, relabel(s, labels)) for s in (equation.left, equation.right))
        return Equation(left, right)

    return Inference(words, conclude)


def axes_of_components(frame: str) -> Inference:
    """Return the inference from [v] = (x, y, z) to v = x b_1 + y b_2 + z b_3."""

    def conclude(equation: Equation) -> Equation:
        left, right = equation.left, equation.right
        if left.head != "column" or left.data != (frame,) or right.head != "entries":
            raise _refused("components along the axes", "this is no column of a vector")
        along = (mul(e, unit(frame, k)) for k, e in enumerate(right.args, 1))
        return Equation(left.args[0], add(*along))

    return Inference("components along the axes", conclude)


squares = Inference("sum of squares", lambda equation: Equation(equation.left, number(0), ">="))
"""The inference that a left side which is a sum of squares by its form is not negative."""

squares_right = Inference(
    "sum of squares", lambda equation: Equation(equation.right, number(0), ">=")
)
"""The same of the right side."""


def along_axis(frame: str, k: int) -> Inference:
    """Return the inference from [v] = (x, y, z) in ``frame`` to b_k.v, its entry ``k``."""

    def conclude(equation: Equation) -> Equation:
        left, right = equation.left, equation.right
        if left.head != "column" or left.data != (frame,) or left.kind != "column":
            raise _refused("one row", "this is no column of a vector")
        return Equation(dot(unit(frame, k), left.args[0]), _entries(right)[k - 1])

    return Inference("one row", conclude)


# -- several equations -------------------------------------------------------------------------


def equal(*applied: Rule, words: str = "both are equal to the same") -> Inference:
    """Return the inference from a = b and a = c to b = c, sides tidied by rules."""

    def conclude(first: Equation, second: Equation) -> Equation:
        if first.left != second.left:
            raise _refused(words, "the left sides differ")
        return Equation(apply(applied, first.right), apply(applied, second.right))

    return Inference(words, conclude)


def summed(
    *factors: Term, applied: Sequence[Rule] = (), words: str = "a sum of lines"
) -> Inference:
    """Return the inference from lines to the sum of their multiples by ``factors``, tidied by rules."""

    def conclude(*lines: Equation) -> Equation:
        if len(lines) != len(factors):
            raise _refused(words, f"{len(lines)} lines, {len(factors)} factors")
        left, right = (
            add(*(mul(f, side) for f, side in zip(factors, sides, strict=True)))
            for sides in ([e.left for e in lines], [e.right for e in lines])
        )
        return Equation(apply(applied, left), apply(applied, right))

    return Inference(words, conclude)


# -- linear motion -----------------------------------------------------------------------------


def characteristic(
    variables: Sequence[Any], steady: Mapping[Any, Any], root: Any, cleared: bool = False
) -> Inference:
    """Return the inference from rates, der(x_k) = f_k(x), to their characteristic polynomial.

    ``variables``: the symbols x_k, in the order of the lines; ``steady``: their values in a motion in
    which all rates vanish; ``root``: the symbol of the polynomial; ``cleared``: times the common
    denominator. States det(root 1 - A) over the slopes A of f there. Source: Hughes, Spacecraft
    Attitude Dynamics (1986), ch. 4.
    """
    words = "linearisation"

    def conclude(*lines: Equation) -> Equation:
        rates = sp.Matrix([e.right.data[0] for e in lines])
        if any(not vanishes(r) for r in rates.xreplace(dict(steady))):
            raise _refused(words, "the motion is not steady")
        slopes = rates.jacobian(list(variables)).xreplace(dict(steady))
        lead = sp.ImmutableMatrix(root * sp.eye(len(variables)) - slopes)
        whole = sp.cancel(lead.det(method="berkowitz"))
        scale = sp.denom(whole) if cleared else sp.Integer(1)
        polynomial = sp.Poly(sp.cancel(whole * scale), root)
        terms = (sp.factor(c) * root**n for (n,), c in polynomial.terms())
        return Equation(expr(scale * sp.Determinant(lead)), expr(sp.Add(*terms)))

    return Inference(words, conclude)
