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
from eom.terms.rules.tracing import Rule, certified
from eom.terms.terms import (
    INERTIAL,
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
    since,
    start,
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
    factor, right = equation.left.data[0].as_independent(symbol)[0], equation.right.data[0]
    if equation.left.data[0] == factor * symbol and factor != 0 and not right.has(symbol):
        return Equation(unknown, apply(applied, expr(right / factor)))
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


def divided(unknown: Term) -> Inference:
    """Return the inference from s x = y, and what names s by a symbol, ``m := s``, to x = y/m."""
    words = "division"

    def conclude(equation: Equation, named: Equation) -> Equation:
        if equation.left != mul(named.right, unknown) or named.relation != ":=":
            raise _refused(words, "it is no product with what is named")
        return Equation(unknown, mul(expr(1 / named.left.expression), equation.right))

    return Inference(words, conclude)


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


def special(values: Mapping[Any, Any], *applied: Rule) -> Inference:
    """Return the inference from any motion to a special one: ``values`` of symbols; tidied by rules."""

    def of_motion(node: Term) -> Term:
        return expr(node.data[0].xreplace(dict(values))) if node.head == "expr" else node

    def conclude(equation: Equation) -> Equation:
        left, right = (
            apply(applied, replace(s, of_motion)) for s in (equation.left, equation.right)
        )
        return Equation(left, right, equation.relation)

    return Inference("special case", conclude)


def integrated(*applied: Rule) -> Inference:
    """Return the inference from x' = f to x = x_0 + the integral of f over time; tidied by rules."""
    words = "integration over time"

    def conclude(equation: Equation) -> Equation:
        rate, right = equation.left, equation.right
        if rate.head != "der" or (rate.kind == "vector" and rate.data[0] != INERTIAL):
            raise _refused(words, "the left side is no rate")
        (inside,) = rate.args
        return Equation(inside, apply(applied, add(start(inside), since(right))))

    return Inference(words, conclude)


def factor_zero(factor: Any) -> Inference:
    """Return the inference from factor * x = 0 to x = 0, where ``factor``, a SymPy expression, is not zero.

    The sides are SymPy expressions.
    """
    words = "a factor that is not zero"

    def conclude(equation: Equation) -> Equation:
        whole = sp.factor(equation.right.expression - equation.left.expression)
        rest = sp.cancel(whole / factor)
        if rest.has(factor) or not vanishes(rest * factor - whole):
            raise _refused(words, "this is no factor of all of it")
        return Equation(expr(rest), number(0))

    return Inference(words, conclude)


# -- signs -------------------------------------------------------------------------------------


def signs(left: Term, *products: tuple[Term, ...]) -> Inference:
    """Return the inference that ``left`` is not negative: a sum of products of what is not.

    ``products``: their factors: left sides of lines ``a >= 0`` from which it follows, powers of these,
    squares. Whoever states the line checks the factors, and that the sum is ``left``.
    """

    def conclude(*lines: Equation) -> Equation:
        if any(e.relation not in {">=", "="} for e in lines):
            raise _refused("signs", "it follows from equations and inequalities alone")
        certified(products)
        return Equation(left, number(0), ">=")

    return Inference("product of signs", conclude)


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


def linearised(
    equal_zero: Callable[[Sequence[Equation]], Any],
    deviations: Mapping[Any, Any],
    steady: Mapping[Any, Any],
) -> Inference:
    """Return the inference from exact equations to the linear one of small deviations.

    ``equal_zero``: from the lines to the SymPy expression that is zero in any motion; ``deviations``: the
    symbol of the deviation for each symbol of the motion, rates among them; ``steady``: their values in
    the steady motion. States the terms of first order. Source: Hughes, Spacecraft Attitude Dynamics
    (1986), ch. 9.
    """
    words = "linearisation"

    def conclude(*lines: Equation) -> Equation:
        whole = equal_zero(lines)
        if not vanishes(whole.xreplace(dict(steady))):
            raise _refused(words, "the motion is not steady")
        slopes = {x: whole.diff(s).xreplace(dict(steady)) for s, x in deviations.items()}
        terms = (sp.factor(sp.trigsimp(slope)) * x for x, slope in slopes.items())
        return Equation(expr(sp.Add(*terms)), number(0))

    return Inference(words, conclude)


def exponential(motions: Sequence[Mapping[Any, int]], root: Any) -> Inference:
    """Return the inference from linear equations to their characteristic polynomial.

    ``motions``: of each unknown the symbols of itself and its rates, with the number of the rate; ``root``:
    the symbol of the polynomial, as all unknowns go like exp(root t). The lines say that expressions are
    zero. States the determinant of the factors of the unknowns.
    """
    words = "exponential motion put in"

    def factor(line: Equation, rates: Mapping[Any, int]) -> Any:
        whole = line.left.data[0] - line.right.data[0]
        return sp.Add(*(whole.diff(s) * root**n for s, n in rates.items()))

    def conclude(*lines: Equation) -> Equation:
        lead = sp.ImmutableMatrix([[factor(line, rates) for rates in motions] for line in lines])
        if lead.free_symbols & {s for rates in motions for s in rates}:
            raise _refused(words, "the equations are not linear")
        polynomial = sp.Poly(lead.det(method="berkowitz"), root)
        terms = (sp.factor(c) * root**n for (n,), c in polynomial.terms())
        return Equation(expr(sp.Determinant(lead)), expr(sp.Add(*terms)))

    return Inference(words, conclude)
